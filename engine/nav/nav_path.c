// Paths between two points of a graph, planned anew when the graph has changed.
#include "core/hash.h"
#include "nav/nav_internal.h"

CORE_COLUMNS_DEFINE(nav_paths, NAV_PATH_COLUMNS)

static uint32_t path_row(const nav_world *w, nav_path path) {
    uint32_t row = core_columns_row(&w->path.set, path);
    if (row == CORE_NO_ROW) {
        core_fail("this nav path does not exist (index %u, generation %u): it is null or was "
                  "destroyed",
                  path.index, path.generation);
    }
    return row;
}

static bool finite_points(core_vec3 a, core_vec3 b) {
    float sum = (a.x - a.x) + (a.y - a.y) + (a.z - a.z) + (b.x - b.x) + (b.y - b.y) + (b.z - b.z);
    return sum == 0.0f ||
           core_fail("nav path: from (%g, %g, %g) to (%g, %g, %g), expected finite "
                     "numbers",
                     (double)a.x, (double)a.y, (double)a.z, (double)b.x, (double)b.y, (double)b.z);
}

nav_path nav_path_create(nav_world *w, nav_graph graph, core_vec3 start, core_vec3 goal) {
    if (nav_graph_row(w, graph) == CORE_NO_ROW || !finite_points(start, goal)) {
        return CORE_NULL_HANDLE;
    }
    nav_path path = core_columns_add(&w->path.set);
    uint32_t row = core_columns_row(&w->path.set, path);
    if (row != CORE_NO_ROW) {
        w->path.head[row] = (nav_path_head){.graph = graph, .start = start, .goal = goal};
        nav_path_update(w, path);
    }
    return path;
}

bool nav_path_destroy(nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    if (row == CORE_NO_ROW) {
        return false;
    }
    core_free(w->path.nodes[row].node);
    w->path.nodes[row] = (nav_path_nodes){0};
    return core_columns_remove(&w->path.set, path, NULL, NULL);
}

bool nav_path_alive(const nav_world *w, nav_path path) {
    return core_columns_row(&w->path.set, path) != CORE_NO_ROW;
}

bool nav_path_set(nav_world *w, nav_path path, core_vec3 start, core_vec3 goal) {
    uint32_t row = path_row(w, path);
    if (row == CORE_NO_ROW || !finite_points(start, goal)) {
        return false;
    }
    w->path.head[row].start = start;
    w->path.head[row].goal = goal;
    nav_path_update(w, path);
    return true;
}

static void fit(nav_path_nodes *nodes, uint32_t count) {
    if (count > nodes->capacity) {
        uint32_t wanted = CORE_MAX(count, CORE_MAX(nodes->capacity * 2, 32u));
        nodes->node = core_realloc(nodes->node, nodes->capacity * sizeof *nodes->node,
                                   wanted * sizeof *nodes->node);
        nodes->capacity = wanted;
    }
}

static void plan(nav_world *w, uint32_t row) {
    nav_path_head *p = &w->path.head[row];
    nav_path_nodes *nodes = &w->path.nodes[row];
    p->status = NAV_NO_PATH;
    p->count = 0;
    p->cost = 0.0;
    p->plans++;
    p->version = nav_graph_version(w, p->graph);
    nav_query query = nav_query_default();
    query.graph = p->graph;
    query.start = nav_graph_nearest(w, p->graph, p->start, 0.0f);
    query.goal = nav_graph_nearest(w, p->graph, p->goal, 0.0f);
    query.heuristic = w->heuristic;
    query.weight = w->weight;
    query.partial = true;
    nav_result result;
    if (query.start == NAV_NO_NODE || !nav_graph_search(w, &query, &result, NULL, 0)) {
        return; // an empty graph
    }
    fit(nodes, result.count);
    nav_last_path(w, &result, nodes->node, nodes->capacity);
    p->status = (uint32_t)result.status;
    p->count = result.count;
    p->cost = result.cost;
    p->nodes_hash = (uint32_t)core_hash(nodes->node, result.count * sizeof *nodes->node, 0);
}

void nav_path_refresh(nav_world *w, uint32_t row) {
    nav_path_head *p = &w->path.head[row];
    if (!nav_graph_alive(w, p->graph)) {
        p->plans += p->status != NAV_INVALID;
        p->status = NAV_INVALID;
        p->count = 0;
    } else if (p->version != nav_graph_version(w, p->graph)) {
        plan(w, row);
    }
}

nav_status nav_path_update(nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    if (row == CORE_NO_ROW) {
        return NAV_INVALID;
    }
    if (nav_graph_alive(w, w->path.head[row].graph)) {
        plan(w, row);
    } else {
        nav_path_refresh(w, row);
    }
    return (nav_status)w->path.head[row].status;
}

nav_status nav_path_status(const nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    return row == CORE_NO_ROW ? NAV_INVALID : (nav_status)w->path.head[row].status;
}
double nav_path_cost(const nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    return row == CORE_NO_ROW ? 0.0 : w->path.head[row].cost;
}
uint32_t nav_path_count(const nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    return row == CORE_NO_ROW ? 0 : w->path.head[row].count;
}
uint32_t nav_path_node(const nav_world *w, nav_path path, uint32_t i) {
    uint32_t row = path_row(w, path);
    return row == CORE_NO_ROW || i >= w->path.head[row].count ? NAV_NO_NODE
                                                              : w->path.nodes[row].node[i];
}
uint32_t nav_path_plans(const nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    return row == CORE_NO_ROW ? 0 : w->path.head[row].plans;
}
