// Lab kernel "nav_search": random queries on a made map by each method. The error is how much
// longer the way is than the shortest one across the free cells, which the any-angle search gives
// exactly (tests/nav/test_mesh.c holds it against visibility graphs).
#include "nav/lab.h"

#include <string.h>

#include "core/rng.h"
#include "nav/nav.h"

#define MOST_SIDE    1024u
#define MOST_QUERIES 1000u

typedef struct workload {
    nav_world *world;
    nav_grid grid;
    nav_mesh mesh;
    nav_graph graph;
    uint8_t *blocked; // [side*side]
    uint32_t *node;   // [side*side] of the graph
    uint32_t side, count;
    nav_cell start[MOST_QUERIES], goal[MOST_QUERIES];
    const char *method;
    float weight;
    double cost[MOST_QUERIES]; // < 0: no way
    uint64_t expanded;
} workload;

// ---- maps ----

static void block_out(workload *w, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1,
                      bool blocked) {
    for (uint32_t y = y0; y < CORE_MIN(y1, w->side); y++) {
        for (uint32_t x = x0; x < CORE_MIN(x1, w->side); x++) {
            w->blocked[y * w->side + x] = blocked;
        }
    }
}

static void draw_map(workload *w, const char *map, core_rng *rng) {
    uint32_t side = w->side;
    if (strcmp(map, "scatter") == 0) { // one cell in five
        for (uint32_t i = 0; i < side * side; i++) {
            w->blocked[i] = core_rng_below(rng, 5) == 0;
        }
    } else if (strcmp(map, "blocks") == 0) { // boxes of up to 8 cells, a tenth of the ground
        for (uint32_t i = 0; i < side * side / 200; i++) {
            uint32_t x = core_rng_below(rng, side), y = core_rng_below(rng, side);
            uint32_t deep = core_rng_below(rng, 8); // one by one: arguments have no order
            block_out(w, x, y, x + 1 + core_rng_below(rng, 8), y + 1 + deep, true);
        }
    } else { // rooms: walls every 16 cells with a door between neighbours
        for (uint32_t i = 15; i < side; i += 16) {
            block_out(w, i, 0, i + 1, side, true);
            block_out(w, 0, i, side, i + 1, true);
        }
        for (uint32_t y = 0; y < side; y += 16) {
            for (uint32_t x = 0; x < side; x += 16) {
                uint32_t door = 1 + core_rng_below(rng, 12), other = 1 + core_rng_below(rng, 12);
                block_out(w, x + 15, y + door, x + 16, y + door + 2, false);
                block_out(w, x + other, y + 15, x + other + 2, y + 16, false);
            }
        }
    }
}

static void build_graph(workload *w) {
    nav_graph_desc desc = nav_graph_desc_default();
    w->graph = nav_graph_create(w->world, &desc);
    for (uint32_t i = 0; i < w->side * w->side; i++) {
        core_vec3 p = {(float)(i % w->side), 0.0f, (float)(i / w->side)};
        w->node[i] = w->blocked[i] ? NAV_NO_NODE : nav_graph_add_node(w->world, w->graph, p);
    }
    for (uint32_t y = 0; y < w->side; y++) {
        for (uint32_t x = 0; x < w->side; x++) {
            for (uint32_t d = 1; d < 9; d++) {
                uint32_t to_x = x + d % 3 - 1, to_y = y + d / 3 - 1;
                if (d == 4 || to_x >= w->side || to_y >= w->side) {
                    continue;
                }
                uint32_t a = w->node[y * w->side + x], b = w->node[to_y * w->side + to_x];
                bool cuts = w->blocked[y * w->side + to_x] || w->blocked[to_y * w->side + x];
                if (a < b && a != NAV_NO_NODE && b != NAV_NO_NODE && !cuts) {
                    nav_graph_connect(w->world, w->graph, a, b);
                }
            }
        }
    }
}

// ---- queries ----

static bool search(workload *w, const char *method, uint32_t i, nav_result *r) {
    nav_cell s = w->start[i], g = w->goal[i];
    if (strcmp(method, "surface") == 0) {
        core_vec3 from = {(float)s.x + 0.5f, 0, (float)s.y + 0.5f};
        core_vec3 to = {(float)g.x + 0.5f, 0, (float)g.y + 0.5f};
        return nav_mesh_search(w->world, w->mesh, from, to, r, NULL, 0);
    }
    if (strcmp(method, "graph") == 0) {
        nav_query query = nav_query_default();
        query.graph = w->graph;
        query.start = w->node[s.y * w->side + s.x], query.goal = w->node[g.y * w->side + g.x];
        query.heuristic = NAV_OCTILE;
        query.weight = w->weight;
        return nav_graph_search(w->world, &query, r, NULL, 0);
    }
    nav_grid_method m = strcmp(method, "jump") == 0 ? NAV_GRID_JUMP : NAV_GRID_ASTAR;
    return nav_grid_search(w->world, w->grid, m, s, g, r, NULL, 0);
}

static void run_all(void *ctx) {
    workload *w = ctx;
    w->expanded = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        nav_result r;
        search(w, w->method, i, &r);
        w->cost[i] = r.status == NAV_FOUND ? r.cost : -1.0;
        w->expanded += r.expanded;
    }
}

static void pick_queries(workload *w, core_rng *rng) {
    for (uint32_t i = 0; i < w->count;) {
        uint32_t a = core_rng_below(rng, w->side * w->side);
        uint32_t b = core_rng_below(rng, w->side * w->side);
        w->start[i] = (nav_cell){a % w->side, a / w->side};
        w->goal[i] = (nav_cell){b % w->side, b / w->side};
        i += !w->blocked[a] && !w->blocked[b];
    }
}

static bool known(const char *name, const char *const *list) {
    for (; *list; list++) {
        if (strcmp(name, *list) == 0) {
            return true;
        }
    }
    return false;
}

static void report(workload *w, const core_lab_case *c, core_json *out) {
    double sum = 0.0, worst = 0.0;
    uint32_t found = 0, missed = 0;
    run_all(w);
    for (uint32_t i = 0; i < w->count; i++) {
        nav_result exact;
        search(w, "surface", i, &exact);
        bool way = exact.status == NAV_FOUND;
        missed += way != (w->cost[i] >= 0.0);
        if (way && w->cost[i] >= 0.0 && exact.cost > 0.0) {
            double over = w->cost[i] / exact.cost - 1.0;
            sum += over;
            worst = CORE_MAX(worst, over);
            found++;
        }
    }
    core_json_number(out, "error_mean", found ? sum / found : 0.0);
    core_json_number(out, "error_max", worst);
    core_json_int(out, "missed", missed); // ways that one finds and the other does not
    core_json_int(out, "found", found);
    core_json_number(out, "expanded", (double)w->expanded / w->count);
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_us", core_lab_time(run_all, w, 5e7) / 1e3 / w->count);
    }
}

static bool run(const core_lab_case *c, core_json *out) {
    static const char *const methods[] = {"astar", "jump", "surface", "graph", NULL};
    static const char *const maps[] = {"scatter", "blocks", "rooms", NULL};
    const char *map = core_lab_text(c, "map", "blocks");
    const char *method = core_lab_text(c, "method", "jump");
    double side = core_lab_number(c, "n", 256), queries = core_lab_number(c, "queries", 100);
    double weight = core_lab_number(c, "weight", 1);
    if (!known(method, methods) || !known(map, maps) || !(side >= 16 && side <= MOST_SIDE) ||
        !(queries >= 1 && queries <= MOST_QUERIES) || !(weight >= 1 && weight <= 10)) {
        return core_fail(
            "lab kernel nav_search: method '%s', map '%s', n %g, queries %g, weight %g; "
            "expected astar, jump, surface or graph; scatter, blocks or rooms; 16 to "
            "%u; 1 to %u; 1 to 10",
            method, map, side, queries, weight, MOST_SIDE, MOST_QUERIES);
    }
    nav_world_desc world = nav_world_desc_default();
    workload *w = core_alloc(sizeof *w);
    w->world = nav_world_create(&world);
    w->side = (uint32_t)side, w->count = (uint32_t)queries;
    w->method = method, w->weight = (float)weight;
    w->blocked = core_alloc((size_t)w->side * w->side);
    w->node = core_alloc((size_t)w->side * w->side * sizeof *w->node);
    core_rng rng = core_rng_make((uint64_t)core_lab_number(c, "seed", 1), CORE_RNG_ENGINE);
    draw_map(w, map, &rng);
    pick_queries(w, &rng);
    nav_grid_desc grid = nav_grid_desc_default();
    grid.width = grid.height = w->side;
    grid.blocked = w->blocked;
    w->grid = nav_grid_create(w->world, &grid);
    w->mesh = nav_mesh_from_cells(w->world, w->side, w->side, w->blocked, 1.0f);
    if (strcmp(method, "graph") == 0) {
        build_graph(w);
    }
    report(w, c, out);
    nav_world_destroy(w->world);
    core_free(w->blocked);
    core_free(w->node);
    core_free(w);
    return true;
}

const core_lab_kernel nav_lab_search = {
    "nav_search", "length of a way over the exact Euclidean one, against the time of a query",
    "method: astar|jump|surface|graph; map: scatter|blocks|rooms; n: cells a side; queries; weight "
    "(graph); seed",
    run};
