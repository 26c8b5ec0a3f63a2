// Surfaces, graphs, paths, agents and searches as lines.
#include "nav/nav_internal.h"

typedef struct sink {
    nav_line_fn *fn;
    void *ctx;
} sink;

static void line(const sink *s, nav_line_kind kind, core_vec3 a, core_vec3 b) {
    s->fn(s->ctx, kind, a, b);
}

static core_vec3 corner_of(const nav_mesh_data *m, uint32_t polygon, uint32_t edge) {
    nav_point at = {m->edge[edge].x, m->edge[edge].z};
    return nav_mesh_world_point(m, at, m->span.y[nav_mesh_span_under(m, polygon, at)]);
}

// Each seam once: by the polygon with the smaller number.
bool nav_mesh_lines(const nav_world *w, nav_mesh mesh, nav_line_fn *fn, void *ctx) {
    uint32_t row;
    const nav_mesh_data *m = nav_mesh_find(w, mesh, &row);
    sink s = {fn, ctx};
    for (uint32_t t = 0; m && t < m->tiles_x * m->tiles_z; t++) {
        nav_block own = m->tile[t].polygon;
        for (uint32_t p = own.first; p < own.first + own.count; p++) {
            nav_range edges = m->polygon.edges[p];
            for (uint32_t e = edges.first; e < edges.end; e++) {
                uint32_t next = e + 1 == edges.end ? edges.first : e + 1;
                bool wall = m->edge[e].beyond == NAV_NONE;
                if (wall || p < m->edge[e].beyond) {
                    line(&s, wall ? NAV_LINE_WALL : NAV_LINE_SEAM, corner_of(m, p, e),
                         corner_of(m, p, next));
                }
            }
        }
    }
    for (uint32_t i = 0; m && i < m->links; i++) {
        const nav_mesh_link_desc *d = &m->link[i].desc;
        if (m->link[i].exists) {
            line(&s, d->closed ? NAV_LINE_SHUT : NAV_LINE_LINK, d->start, d->end);
        }
    }
    return m != NULL;
}

static core_vec3 node_at(const nav_graph_data *g, uint32_t node) {
    return (core_vec3){g->node.px[node], g->node.py[node], g->node.pz[node]};
}

bool nav_graph_lines(const nav_world *w, nav_graph graph, nav_line_fn *fn, void *ctx) {
    uint32_t row = nav_graph_row(w, graph);
    const nav_graph_data *g = row == CORE_NO_ROW ? NULL : w->graph.data[row];
    sink s = {fn, ctx};
    for (uint32_t node = 0; g && node < core_columns_count(&g->node.set); node++) {
        uint32_t first = g->node.first[node];
        for (uint32_t i = first; g->node.exists[node] && i < first + g->node.links[node]; i++) {
            line(&s, g->link.open[i] ? NAV_LINE_LINK : NAV_LINE_SHUT, node_at(g, node),
                 node_at(g, g->link.to[i]));
        }
    }
    return g != NULL;
}

void nav_path_lines(const nav_world *w, nav_line_fn *fn, void *ctx) {
    sink s = {fn, ctx};
    for (uint32_t row = 0; row < core_columns_count(&w->path.set); row++) {
        const core_vec3 *point = w->path.points[row].point;
        for (uint32_t i = 1; i < w->path.head[row].count; i++) {
            line(&s, NAV_LINE_PATH, point[i - 1], point[i]);
        }
    }
}

static void circle(const sink *s, core_vec3 at, float radius) {
    enum { PIECES = 12 };
    core_vec3 last = {at.x + radius, at.y, at.z};
    for (int i = 1; i <= PIECES; i++) {
        float sine, cosine;
        core_sincosf(2.0f * CORE_PI_F * (float)i / PIECES, &sine, &cosine);
        core_vec3 next = {at.x + radius * cosine, at.y, at.z + radius * sine};
        line(s, NAV_LINE_AGENT, last, next);
        last = next;
    }
}

void nav_agent_lines(const nav_world *w, nav_line_fn *fn, void *ctx) {
    const nav_agents *a = &w->agent;
    sink s = {fn, ctx};
    for (uint32_t row = 0; row < core_columns_count(&a->set); row++) {
        core_vec3 at = {a->px[row], a->py[row], a->pz[row]};
        circle(&s, at, a->radius[row]);
        line(&s, NAV_LINE_VELOCITY, at,
             core_v3(at.x + a->vx[row], at.y + a->vy[row], at.z + a->vz[row]));
        line(&s, NAV_LINE_WISH, at, core_v3(at.x + a->wx[row], at.y, at.z + a->wz[row]));
    }
}

// Where the numbers of the last search are those of another surface or graph, lines may be missing:
// nothing outside of this one is read.
bool nav_mesh_search_lines(const nav_world *w, nav_mesh mesh, nav_line_fn *fn, void *ctx) {
    uint32_t row;
    const nav_mesh_data *m = nav_mesh_find(w, mesh, &row);
    sink s = {fn, ctx};
    for (uint32_t i = 0; m && i < w->views.count; i++) {
        const nav_view *v = &w->views.view[i];
        if (v->polygon < m->polygon.blocks.end) {
            float y = m->span.y[m->polygon.shape[v->polygon].span];
            line(&s, NAV_LINE_SEARCHED, nav_mesh_world_point(m, v->left, y),
                 nav_mesh_world_point(m, v->right, y));
        }
    }
    return m != NULL;
}

bool nav_graph_search_lines(const nav_world *w, nav_graph graph, nav_line_fn *fn, void *ctx) {
    uint32_t row = nav_graph_row(w, graph);
    const nav_graph_data *g = row == CORE_NO_ROW ? NULL : w->graph.data[row];
    uint32_t nodes = g ? core_columns_count(&g->node.set) : 0;
    sink s = {fn, ctx};
    for (uint32_t node = 0; node < CORE_MIN(nodes, w->scratch.capacity); node++) {
        const nav_record *r = &w->scratch.record[node];
        if (g->node.exists[node] && r->stamp == w->scratch.stamp && r->parent < nodes &&
            r->parent != node) {
            line(&s, NAV_LINE_SEARCHED, node_at(g, r->parent), node_at(g, node));
        }
    }
    return g != NULL;
}
