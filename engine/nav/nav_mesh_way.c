// Ways across walkable surfaces: which search a query needs, and the points it gives.
#include <math.h>
#include <string.h>

#include "nav/nav_internal.h"

#define NAV_MESH_QUERY_COOKIE 0x4e415610u
#define REACH                 2.0 // cells by which ends may be off the surface
#define ANYWHERE              1e6

nav_mesh_query nav_mesh_query_default(void) {
    return (nav_mesh_query){.cookie = NAV_MESH_QUERY_COOKIE};
}

static bool same(nav_point a, nav_point b) { return a.x == b.x && a.z == b.z; }

void nav_way_add(nav_way *way, core_vec3 point, uint32_t link) {
    if (way->count == way->room) {
        uint32_t wanted = CORE_MAX(way->room * 2, 64u);
        way->point =
            core_realloc(way->point, way->room * sizeof *way->point, wanted * sizeof *way->point);
        way->link =
            core_realloc(way->link, way->room * sizeof *way->link, wanted * sizeof *way->link);
        way->room = wanted;
    }
    way->point[way->count] = point;
    way->link[way->count++] = link;
}

nav_point nav_mesh_clear_of(const nav_mesh_data *m, nav_point corner, uint32_t turn, double cells) {
    static const double dir_x[4] = {1, 0, -1, 0}, dir_z[4] = {0, 1, 0, -1};
    int a = m->turn_closed[turn], b = (a + 1) % 4;
    return (nav_point){corner.x - cells * (dir_x[a] + dir_x[b]),
                       corner.z - cells * (dir_z[a] + dir_z[b])};
}

// The bends of a chain of views, which is read from its end.
static void add_bends(nav_world *w, const nav_mesh_data *m, const nav_view *view, uint32_t last,
                      nav_point start, double clearance) {
    uint32_t first = w->way.count;
    nav_point bend = start;
    for (uint32_t v = last; v != NAV_NONE; v = view[v].parent) {
        if (!same(view[v].root, bend) && view[v].root_turn != NAV_NONE) {
            nav_point at = nav_mesh_clear_of(m, view[v].root, view[v].root_turn, clearance);
            nav_way_add(&w->way, nav_mesh_world_point(m, at, m->turn_y[view[v].root_turn]),
                        NAV_NO_LINK);
        }
        bend = view[v].root;
    }
    for (uint32_t i = first, k = w->way.count; i + 1 < k; i++) {
        core_vec3 swap = w->way.point[i];
        w->way.point[i] = w->way.point[--k];
        w->way.point[k] = swap;
    }
}

static void add_place(nav_world *w, const nav_mesh_data *m, nav_point at, uint32_t span,
                      uint32_t link) {
    nav_way_add(&w->way, nav_mesh_world_point(m, at, m->span.y[span]), link);
}

// The shortest way over the ground, without its first point. Gives its length in cells, < 0: none.
static double add_leg(nav_world *w, const nav_mesh_data *m, nav_point from, uint32_t from_span,
                      nav_point to, uint32_t to_span, uint32_t link, double clearance,
                      nav_result *result) {
    uint32_t expanded = 0;
    uint32_t last = nav_mesh_any_angle(m, &w->views, from, m->span.polygon[from_span], to,
                                       m->span.polygon[to_span], &expanded);
    result->expanded += expanded;
    if (last == NAV_NONE) {
        return -1.0;
    }
    add_bends(w, m, w->views.view, last, from, clearance);
    add_place(w, m, to, to_span, link);
    const nav_view *v = &w->views.view[last];
    double dx = to.x - v->root.x, dz = to.z - v->root.z;
    return v->g + core_sqrt(dx * dx + dz * dz);
}

double nav_mesh_write_found(nav_world *w, const nav_any_angle *q, const nav_ends *ends,
                            double clearance) {
    const nav_view *v = &q->scratch->view[q->last];
    w->way.count = 0;
    add_place(w, q->mesh, ends->start.at, ends->start.span, NAV_NO_LINK);
    add_bends(w, q->mesh, q->scratch->view, q->last, ends->start.at, clearance);
    add_place(w, q->mesh, ends->goal.at, ends->goal.span, NAV_NO_LINK);
    double dx = ends->goal.at.x - v->root.x, dz = ends->goal.at.z - v->root.z;
    return (v->g + core_sqrt(dx * dx + dz * dz)) * (double)q->mesh->cell_size;
}

static nav_status over_ground(nav_world *w, const nav_mesh_data *m, const nav_ends *ends,
                              double clearance, nav_result *result) {
    add_place(w, m, ends->start.at, ends->start.span, NAV_NO_LINK);
    double length = add_leg(w, m, ends->start.at, ends->start.span, ends->goal.at, ends->goal.span,
                            NAV_NO_LINK, clearance, result);
    if (length < 0.0) {
        w->way.count = 0;
        return NAV_NO_PATH;
    }
    result->cost = length * (double)m->cell_size;
    return NAV_FOUND;
}

// Without costs, what lies between two links is replaced by the shortest way.
static nav_status by_links(nav_world *w, const nav_mesh_data *m, double clearance,
                           nav_result *result) {
    const nav_waypoint *way = w->coarse.way.data;
    double cost = 0.0;
    add_place(w, m, way[0].at, way[0].span, way[0].link);
    for (uint32_t i = 0, k; i + 1 < w->coarse.count; i = k) {
        for (k = i + 1; k + 1 < w->coarse.count && way[k].edge != NAV_NONE; k++) {
        }
        if (way[i].link != NAV_NO_LINK) {
            cost += nav_mesh_link_cost(m, way[i].link);
            add_place(w, m, way[k].at, way[k].span, way[k].link);
            continue;
        }
        double length = add_leg(w, m, way[i].at, way[i].span, way[k].at, way[k].span, way[k].link,
                                clearance, result);
        if (length < 0.0) {
            w->way.count = 0;
            return NAV_NO_PATH;
        }
        cost += length * (double)m->cell_size;
    }
    result->cost = cost;
    return NAV_FOUND;
}

// With costs the coarse way is given as it is, but for points on straight lines.
static bool straight(const nav_waypoint *a, const nav_waypoint *b, const nav_waypoint *c) {
    double across =
        (b->at.x - a->at.x) * (c->at.z - a->at.z) - (b->at.z - a->at.z) * (c->at.x - a->at.x);
    double size = core_absf((float)(c->at.x - a->at.x)) + core_absf((float)(c->at.z - a->at.z));
    return b->edge != NAV_NONE && b->link == NAV_NO_LINK && across < 1e-3 * size &&
           across > -1e-3 * size;
}
static void by_costs(nav_world *w, const nav_mesh_data *m) {
    const nav_waypoint *way = w->coarse.way.data;
    uint32_t last = 0;
    for (uint32_t i = 0; i < w->coarse.count; i++) {
        bool inner = i > 0 && i + 1 < w->coarse.count;
        if (!inner || !straight(&way[last], &way[i], &way[i + 1])) {
            add_place(w, m, way[i].at, way[i].span, way[i].link);
            last = i;
        }
    }
}

bool nav_mesh_is_plain(const nav_mesh_data *m) {
    for (uint32_t i = 0; i < m->links; i++) {
        if (m->link[i].exists && !m->link[i].desc.closed) {
            return false;
        }
    }
    return true;
}

static bool read_costs(const nav_mesh_query *q, float cost[NAV_AREAS], bool *even) {
    *even = true;
    for (uint32_t i = 0; i < NAV_AREAS; i++) {
        float c = q->area_cost ? q->area_cost[i] : 1.0f;
        cost[i] = c == 0.0f ? 1.0f : c;
        if (!(cost[i] >= 1e-3f && (cost[i] <= 1e6f || cost[i] == INFINITY))) {
            return core_fail("nav_mesh_find_way: area %u costs %g, expected 0.001 to a million, or "
                             "infinite",
                             i, (double)cost[i]);
        }
        *even = *even && cost[i] == 1.0f;
    }
    return true;
}

static nav_status plan_between(nav_world *w, uint32_t row, nav_ends *ends, const float *cost,
                               bool even, bool partial, double clearance, nav_result *result) {
    nav_mesh_data *m = w->mesh.data[row];
    if (!even || !nav_mesh_is_plain(m)) {
        nav_status status = nav_mesh_coarse(w, m, ends, cost, partial, result);
        if (status != NAV_FOUND && status != NAV_PARTIAL) {
            return status;
        }
        if (!even) {
            by_costs(w, m);
            return status;
        }
        return by_links(w, m, clearance, result) == NAV_FOUND ? status : NAV_NO_PATH;
    }
    nav_mesh_find_components(m, w->mesh.head[row].version);
    const uint32_t *component = m->polygon.component, *polygon = m->span.polygon;
    bool joined = component[polygon[ends->start.span]] == component[polygon[ends->goal.span]];
    if (!joined && !partial) {
        return NAV_NO_PATH;
    }
    if (!joined) {
        ends->goal = nav_mesh_nearest_joined(m, ends->start, ends->wanted);
    }
    nav_status status = over_ground(w, m, ends, clearance, result);
    return status == NAV_FOUND && !joined ? NAV_PARTIAL : status;
}

bool nav_mesh_ends(const nav_mesh_data *m, const nav_mesh_query *q, nav_ends *ends) {
    *ends = (nav_ends){.start = nav_mesh_locate(m, q->start, REACH),
                       .goal = nav_mesh_locate(m, q->goal, q->partial ? ANYWHERE : REACH),
                       .wanted = q->goal};
    return ends->start.span != NAV_NONE && ends->goal.span != NAV_NONE;
}

bool nav_mesh_plan(nav_world *w, const nav_mesh_query *q, double clearance, nav_result *result) {
    *result = (nav_result){.status = NAV_INVALID, .reached = NAV_NO_NODE};
    w->way.count = 0;
    if (!q || q->cookie != NAV_MESH_QUERY_COOKIE) {
        return core_fail("nav_mesh_find_way: the query was not made by nav_mesh_query_default()");
    }
    float cost[NAV_AREAS];
    bool even;
    uint32_t row;
    const nav_mesh_data *m = nav_mesh_find(w, q->mesh, &row);
    if (!m || !read_costs(q, cost, &even)) {
        return false;
    }
    nav_ends ends;
    result->status = NAV_NO_PATH;
    if (!nav_mesh_ends(m, q, &ends)) {
        return true;
    }
    bool off = ends.goal.square > (REACH + 2e-4) * (REACH + 2e-4);
    result->status = plan_between(w, row, &ends, cost, even, q->partial, clearance, result);
    if (result->status == NAV_FOUND && off) {
        result->status = NAV_PARTIAL;
    }
    result->count = w->way.count;
    result->reached = result->count ? m->span.polygon[ends.goal.span] : NAV_NO_NODE;
    return true;
}

void nav_mesh_last_way(const nav_world *w, core_vec3 *point, uint32_t *link, uint32_t capacity) {
    size_t count = CORE_MIN(w->way.count, capacity);
    if (point && count) {
        memcpy(point, w->way.point, count * sizeof *point);
    }
    if (link && count) {
        memcpy(link, w->way.link, count * sizeof *link);
    }
}

bool nav_mesh_find_way(nav_world *w, const nav_mesh_query *query, nav_result *result,
                       core_vec3 *point, uint32_t *link, uint32_t capacity) {
    if (!nav_mesh_plan(w, query, 0.0, result)) {
        return false;
    }
    nav_mesh_last_way(w, point, link, capacity);
    return true;
}

bool nav_mesh_search(nav_world *w, nav_mesh mesh, core_vec3 from, core_vec3 to, nav_result *result,
                     core_vec3 *out, uint32_t capacity) {
    nav_mesh_query query = nav_mesh_query_default();
    query.mesh = mesh;
    query.start = from;
    query.goal = to;
    return nav_mesh_find_way(w, &query, result, out, NULL, capacity);
}
