// A world in a saved scene: agents, paths with their points, graphs with what was opened and closed
// in them. Surfaces and grids are the scene's own and must be the same.
#include "core/hash.h"

#include "nav/nav_internal.h"

static uint64_t ground_hash(const core_columns *set) {
    uint64_t column[CORE_COLUMNS_MAX], hash = core_pool_hash(&set->pool);
    core_columns_hash(set, column);
    for (uint32_t c = 0; c < set->column_count; c++) {
        hash = core_hash_mix(hash, column[c]);
    }
    return hash;
}

static bool check_graph(const nav_graph_data *g, const nav_graph_head *head, core_stream *s) {
    uint32_t nodes = core_columns_count(&g->node.set), links = core_columns_count(&g->link.set);
    uint32_t exist = 0;
    for (uint32_t i = 0; i < nodes; i++) {
        uint32_t first = g->node.first[i], room = g->node.room[i];
        exist += g->node.exists[i] != 0;
        bool good = g->node.links[i] <= room && room <= links && first <= links - room;
        for (uint32_t k = 0; good && k < g->node.links[i]; k++) {
            good = g->link.to[first + k] < nodes;
        }
        if (!good) {
            return core_stream_fail(s, "nav graph", "node %u has links that are not", i);
        }
    }
    return exist == head->nodes ||
           core_stream_fail(s, "nav graph", "%u nodes, its head says %u", exist, head->nodes);
}

static bool stream_graph(nav_graph_data *g, nav_graph_head *head, core_stream *s) {
    bool good = core_stream_open(s, "graph") &&
                core_stream_list(s, "head", 'x', head, sizeof *head) &&
                core_stream_columns(s, &g->node.set) && core_stream_columns(s, &g->link.set) &&
                core_stream_close(s);
    if (!good || s->writing) {
        return good;
    }
    nav_cells_release(&g->cells);
    if (core_columns_count(&g->node.set) != 0) {
        nav_cells_add(g, 0); // the first sorts in all that exist
    }
    uint32_t links = core_columns_count(&g->link.set);
    for (int i = 0; i < NAV_BLOCK_SIZES; i++) {
        if (head->free_block[i] > links) {
            return core_stream_fail(s, "nav graph head", "free block %u of %u links",
                                    head->free_block[i], links);
        }
    }
    return check_graph(g, head, s);
}

static void drop_points(nav_world *w) {
    for (uint32_t row = 0; row < core_columns_count(&w->path.set); row++) {
        core_free(w->path.points[row].point);
        core_free(w->path.points[row].node);
    }
    core_columns_clear(&w->path.set);
}

static bool path_stands(const nav_world *w, const nav_path_head *p) {
    bool graph = core_handle_is_null(p->graph) || p->status == NAV_INVALID ||
                 core_columns_row(&w->graph.set, p->graph) != CORE_NO_ROW;
    bool mesh = core_handle_is_null(p->mesh) || p->status == NAV_INVALID ||
                core_columns_row(&w->mesh.set, p->mesh) != CORE_NO_ROW;
    return graph && mesh && core_handle_is_null(p->graph) != core_handle_is_null(p->mesh);
}

static bool stream_points(nav_world *w, core_stream *s) {
    bool good = core_stream_open(s, "points");
    for (uint32_t row = 0; good && row < core_columns_count(&w->path.set); row++) {
        nav_path_points *p = &w->path.points[row];
        uint32_t count = w->path.head[row].count;
        if (!s->writing) {
            *p = (nav_path_points){0};
            if (!path_stands(w, &w->path.head[row]) || count > s->size - s->at) {
                return core_stream_fail(s, "nav.paths", "row %u leads over ground that is not",
                                        row);
            }
            p->capacity = count;
            p->point = core_alloc(count * sizeof *p->point);
            p->node = core_alloc(count * sizeof *p->node);
        }
        good = core_stream_list(s, "point", 'f', p->point, count * sizeof *p->point) &&
               core_stream_list(s, "node", 'u', p->node, count * sizeof *p->node);
    }
    return good && core_stream_close(s);
}

static bool check_agents(const nav_world *w, core_stream *s) {
    for (uint32_t i = 0; i < core_columns_count(&w->agent.set); i++) {
        uint32_t path = core_columns_row(&w->path.set, w->agent.path[i]);
        uint32_t points = path == CORE_NO_ROW ? 0 : w->path.head[path].count;
        bool known = path != CORE_NO_ROW || core_handle_is_null(w->agent.path[i]);
        bool replanned = path != CORE_NO_ROW && w->agent.plans[i] != w->path.head[path].plans;
        if (!known || w->agent.state[i] > NAV_AGENT_STUCK ||
            (!replanned && path != CORE_NO_ROW &&
             (w->agent.corners[i] > points || w->agent.corner[i] > points))) {
            return core_stream_fail(s, "nav.agents", "row %u walks a path that is not", i);
        }
    }
    return true;
}

static bool stream_graphs(nav_world *w, core_stream *s) {
    bool good = core_stream_same(s, "graphs", core_pool_hash(&w->graph.set.pool),
                                 "the scene has other graphs");
    for (uint32_t row = 0; good && row < core_columns_count(&w->graph.set); row++) {
        good = stream_graph(w->graph.data[row], &w->graph.head[row], s);
    }
    return good;
}

bool nav_world_stream(nav_world *w, core_stream *s) {
    if (!s->writing) {
        drop_points(w);
    }
    bool good = core_stream_open(s, "nav") &&
                core_stream_same(s, "surfaces", ground_hash(&w->mesh.set),
                                 "the scene has other surfaces, or they have changed since") &&
                core_stream_same(s, "grids", ground_hash(&w->grid.set),
                                 "the scene has other grids, or they have changed since") &&
                stream_graphs(w, s) && core_stream_columns(s, &w->path.set) &&
                stream_points(w, s) && core_stream_columns(s, &w->agent.set) &&
                core_stream_list(s, "turns", 'u', &w->next_path, sizeof w->next_path) &&
                core_stream_list(s, "turn", 'u', &w->next_agent, sizeof w->next_agent) &&
                core_stream_close(s) && (s->writing || check_agents(w, s));
    if (!good && !s->writing) {
        drop_points(w);
        core_columns_clear(&w->agent.set);
    }
    return good;
}
