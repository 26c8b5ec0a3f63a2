// Paths between two points of a graph, planned anew when the graph has changed.
#include <string.h>

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

static nav_path create(nav_world *w, nav_path_head head) {
    nav_path path = core_columns_add(&w->path.set);
    uint32_t row = core_columns_row(&w->path.set, path);
    if (row != CORE_NO_ROW) {
        w->path.head[row] = head;
        nav_path_update(w, path);
    }
    return path;
}

nav_path nav_path_renew(nav_world *w, nav_path old, nav_path_head head) {
    uint32_t row = core_columns_row(&w->path.set, old);
    if (row == CORE_NO_ROW) {
        return create(w, head);
    }
    head.plans = w->path.head[row].plans;
    head.led = w->path.head[row].led;
    w->path.head[row] = head;
    nav_path_update(w, old);
    return old;
}

nav_path nav_path_create(nav_world *w, nav_graph graph, core_vec3 start, core_vec3 goal) {
    if (nav_graph_row(w, graph) == CORE_NO_ROW || !finite_points(start, goal)) {
        return CORE_NULL_HANDLE;
    }
    return create(w, (nav_path_head){.graph = graph, .start = start, .goal = goal});
}

nav_path nav_path_create_on_mesh(nav_world *w, nav_mesh mesh, core_vec3 start, core_vec3 goal) {
    if (!nav_mesh_alive(w, mesh)) {
        core_fail("nav path: the surface does not exist");
        return CORE_NULL_HANDLE;
    }
    if (!finite_points(start, goal)) {
        return CORE_NULL_HANDLE;
    }
    return create(w, (nav_path_head){.mesh = mesh, .start = start, .goal = goal});
}

bool nav_path_destroy(nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    if (row == CORE_NO_ROW) {
        return false;
    }
    core_free(w->path.points[row].point);
    core_free(w->path.points[row].node);
    w->path.points[row] = (nav_path_points){0};
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

static void fit(nav_path_points *p, uint32_t count) {
    if (count > p->capacity) {
        uint32_t wanted = CORE_MAX(count, CORE_MAX(p->capacity * 2, 32u));
        p->point =
            core_realloc(p->point, p->capacity * sizeof *p->point, wanted * sizeof *p->point);
        p->node = core_realloc(p->node, p->capacity * sizeof *p->node, wanted * sizeof *p->node);
        p->capacity = wanted;
    }
}

static void plan_on_graph(nav_world *w, const nav_path_head *p, nav_path_points *points,
                          nav_result *result) {
    nav_query query = nav_query_default();
    query.graph = p->graph;
    query.start = nav_graph_nearest(w, p->graph, p->start, 0.0f);
    query.goal = nav_graph_nearest(w, p->graph, p->goal, 0.0f);
    query.heuristic = w->heuristic;
    query.weight = w->weight;
    query.partial = true;
    if (query.start == NAV_NO_NODE || !nav_graph_search(w, &query, result, NULL, 0)) {
        return; // an empty graph
    }
    fit(points, result->count);
    nav_last_path(w, result, points->node, points->capacity);
    for (uint32_t i = 0; i < result->count; i++) {
        nav_graph_position(w, p->graph, points->node[i], &points->point[i]);
    }
}

// Bends half a cell off the corners: who walks exactly along a border is held up by every push.
#define CORNER_CLEARANCE 0.5

static void take_way(const nav_world *w, nav_path_points *points) {
    fit(points, w->way.count);
    if (w->way.count) {
        memcpy(points->point, w->way.point, w->way.count * sizeof *points->point);
        memcpy(points->node, w->way.link, w->way.count * sizeof *points->node);
    }
}

static void plan_on_mesh(nav_world *w, const nav_path_head *p, nav_path_points *points,
                         nav_result *result) {
    nav_mesh_query query = nav_mesh_query_default();
    query.mesh = p->mesh;
    query.start = p->start, query.goal = p->goal;
    query.partial = true;
    if (nav_flow_alive(w, p->flow)) {
        nav_flow_plan(w, p->flow, p->start, CORNER_CLEARANCE, result);
    } else {
        nav_mesh_plan(w, &query, CORNER_CLEARANCE, result);
    }
    take_way(w, points);
}

static bool on_mesh(const nav_path_head *p) { return !core_handle_is_null(p->mesh); }

static void store(nav_path_head *p, const nav_path_points *points, const nav_result *result) {
    p->status = (uint32_t)result->status;
    p->count = result->count;
    p->cost = result->cost;
    p->plans++;
    p->points_hash = (uint32_t)core_hash(points->point, result->count * sizeof *points->point, 0);
}

void nav_path_plan_now(nav_world *w, uint32_t row) {
    nav_path_head *p = &w->path.head[row];
    nav_path_points *points = &w->path.points[row];
    nav_result result = {.status = NAV_NO_PATH};
    if (on_mesh(p)) {
        p->version = w->mesh.head[core_columns_row(&w->mesh.set, p->mesh)].version;
        plan_on_mesh(w, p, points, &result);
    } else {
        p->version = nav_graph_version(w, p->graph);
        plan_on_graph(w, p, points, &result);
    }
    store(p, points, &result);
}

void nav_path_found(nav_world *w, uint32_t row, const nav_any_angle *search, const nav_ends *ends) {
    nav_path_head *p = &w->path.head[row];
    nav_path_points *points = &w->path.points[row];
    nav_result result = {.status = NAV_NO_PATH};
    p->version = w->slice.version;
    if (search) {
        result.cost = nav_mesh_write_found(w, search, ends, CORNER_CLEARANCE);
        result.status = NAV_FOUND;
        result.count = w->way.count;
        take_way(w, points);
    }
    store(p, points, &result);
}

// Where searches are sliced it waits for its turn; a way that it has stays until then.
static void plan(nav_world *w, uint32_t row) {
    nav_path_head *p = &w->path.head[row];
    if (w->slice_budget == 0 || !on_mesh(p) || nav_flow_alive(w, p->flow)) {
        nav_path_plan_now(w, row);
        return;
    }
    p->version = w->mesh.head[core_columns_row(&w->mesh.set, p->mesh)].version;
    p->status = NAV_PENDING;
}

static bool ground_alive(const nav_world *w, const nav_path_head *p) {
    return on_mesh(p) ? nav_mesh_alive(w, p->mesh) : nav_graph_alive(w, p->graph);
}

bool nav_path_outdated(const nav_world *w, uint32_t row) {
    const nav_path_head *p = &w->path.head[row];
    if (!ground_alive(w, p)) {
        return false;
    }
    return p->version != (on_mesh(p) ? w->mesh.head[core_columns_row(&w->mesh.set, p->mesh)].version
                                     : nav_graph_version(w, p->graph));
}

void nav_path_check(nav_world *w, uint32_t row) {
    nav_path_head *p = &w->path.head[row];
    if (!ground_alive(w, p)) {
        p->plans += p->status != NAV_INVALID;
        p->status = NAV_INVALID;
        p->count = 0;
    }
}

// From one path on and around, so that each gets its turn where something changes in every step.
void nav_paths_refresh(nav_world *w) {
    uint32_t count = core_columns_count(&w->path.set);
    uint32_t first = w->next_path < count ? w->next_path : 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t row = (first + i) % count;
        nav_path_check(w, row);
        if (!w->path.head[row].led && nav_path_outdated(w, row)) {
            w->next_path = row;
            if (w->plans_left == 0) {
                return;
            }
            w->plans_left--;
            plan(w, row);
        }
    }
}

nav_status nav_path_update(nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    if (row == CORE_NO_ROW) {
        return NAV_INVALID;
    }
    if (ground_alive(w, &w->path.head[row])) {
        plan(w, row);
    } else {
        nav_path_check(w, row);
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
bool nav_path_point(const nav_world *w, nav_path path, uint32_t i, core_vec3 *out) {
    uint32_t row = path_row(w, path);
    if (row == CORE_NO_ROW || i >= w->path.head[row].count) {
        return false;
    }
    *out = w->path.points[row].point[i];
    return true;
}
uint32_t nav_path_node(const nav_world *w, nav_path path, uint32_t i) {
    uint32_t row = path_row(w, path);
    bool none = row == CORE_NO_ROW || i >= w->path.head[row].count || on_mesh(&w->path.head[row]);
    return none ? NAV_NO_NODE : w->path.points[row].node[i];
}
uint32_t nav_path_link(const nav_world *w, nav_path path, uint32_t i) {
    uint32_t row = path_row(w, path);
    bool none = row == CORE_NO_ROW || i >= w->path.head[row].count || !on_mesh(&w->path.head[row]);
    return none ? NAV_NO_LINK : w->path.points[row].node[i];
}
uint32_t nav_path_plans(const nav_world *w, nav_path path) {
    uint32_t row = path_row(w, path);
    return row == CORE_NO_ROW ? 0 : w->path.head[row].plans;
}

// ---- accuracy ----

static double length_of(const core_vec3 *point, uint32_t count) { // on the ground plane
    double sum = 0.0;
    for (uint32_t i = 1; i < count; i++) {
        double dx = (double)point[i].x - point[i - 1].x, dz = (double)point[i].z - point[i - 1].z;
        sum += core_sqrt(dx * dx + dz * dz);
    }
    return sum;
}

// How much longer a path is than the shortest; 0 where that does not apply.
static double ratio_of(nav_world *w, uint32_t row) {
    const nav_path_head *p = &w->path.head[row];
    const nav_path_points *points = &w->path.points[row];
    nav_result best = {0};
    if (p->status != NAV_FOUND || p->count < 2 || nav_path_outdated(w, row)) {
        return 0.0;
    }
    if (on_mesh(p)) {
        uint32_t mesh = core_columns_row(&w->mesh.set, p->mesh);
        if (mesh == CORE_NO_ROW || !nav_mesh_is_plain(w->mesh.data[mesh])) {
            return 0.0;
        }
        nav_mesh_search(w, p->mesh, points->point[0], points->point[p->count - 1], &best, NULL, 0);
        return best.cost > 0.0 ? length_of(points->point, p->count) / best.cost : 0.0;
    }
    if (!nav_graph_alive(w, p->graph)) {
        return 0.0;
    }
    nav_query query = nav_query_default();
    query.graph = p->graph;
    query.start = points->node[0], query.goal = points->node[p->count - 1];
    query.heuristic = NAV_ZERO;
    nav_graph_search(w, &query, &best, NULL, 0);
    return best.cost > 0.0 ? p->cost / best.cost : 0.0;
}

double nav_world_path_ratio_max(nav_world *w, uint32_t most) {
    uint32_t count = core_columns_count(&w->path.set);
    uint32_t step = most && count > most ? (count + most - 1) / most : 1;
    double worst = 0.0;
    for (uint32_t row = 0; row < count; row += step) {
        double ratio = ratio_of(w, row);
        worst = CORE_MAX(worst, ratio);
    }
    return worst;
}
