// Searches on graphs against a Dijkstra without heap or heuristic, on thousands of random graphs.
#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "unity.h"

enum { MOST = 60 };

static nav_world *world;
static nav_graph graph;
static uint32_t nodes;
static double matrix[MOST][MOST]; // cost of the open link, < 0: none

static void new_graph(void) {
    nav_graph_desc desc = nav_graph_desc_default();
    desc.max_nodes = 4096;
    graph = nav_graph_create(world, &desc);
    nodes = 0;
}
void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
    new_graph();
}
void tearDown(void) {
    nav_world_destroy(world);
    core_clear_error();
}

// Kinds of graphs: distances as costs, both ways; one-way links of any cost above the distance;
// costs below it, zero too; closed links among them.
static void random_graph(core_rng *rng, int kind) {
    nav_graph_destroy(world, graph);
    new_graph();
    nodes = 2 + core_rng_below(rng, MOST - 2);
    for (uint32_t i = 0; i < nodes; i++) {
        core_vec3 p = {10 * core_rng_float(rng), core_rng_float(rng), 10 * core_rng_float(rng)};
        if (kind == 1) { // whole coordinates: many ties
            p = (core_vec3){floorf(p.x), 0, floorf(p.z)};
        }
        nav_graph_add_node(world, graph, p);
    }
    for (uint32_t i = 0; i < nodes * nodes; i++) {
        matrix[i / nodes][i % nodes] = -1.0;
    }
    for (uint32_t tries = core_rng_below(rng, nodes * 3); tries > 0; tries--) {
        uint32_t a = core_rng_below(rng, nodes), b = core_rng_below(rng, nodes);
        float cost = 20.0f * core_rng_float(rng) * (float)(kind == 2 || core_rng_below(rng, 9));
        bool taken = a == b || matrix[a][b] >= 0.0 || (kind < 2 && matrix[b][a] >= 0.0);
        if (taken) {
            continue;
        }
        matrix[a][b] = 0.0;
        if (kind < 2) {
            nav_graph_connect(world, graph, a, b);
        } else {
            nav_graph_link(world, graph, a, b, cost);
            if (core_rng_below(rng, 5) == 0) {
                nav_graph_set_open(world, graph, a, b, false);
            }
        }
    }
    for (uint32_t a = 0; a < nodes; a++) {
        for (uint32_t n = 0; n < nav_graph_link_count(world, graph, a); n++) {
            nav_link link;
            nav_graph_link_at(world, graph, a, n, &link);
            matrix[a][link.to] = link.open ? (double)link.cost : -1.0;
        }
    }
}

// Cost from start to all nodes, < 0 where there is no way.
static void dijkstra(uint32_t start, double *cost) {
    bool done[MOST] = {false};
    for (uint32_t i = 0; i < nodes; i++) {
        cost[i] = i == start ? 0.0 : -1.0;
    }
    for (;;) {
        uint32_t best = nodes;
        for (uint32_t i = 0; i < nodes; i++) {
            if (!done[i] && cost[i] >= 0.0 && (best == nodes || cost[i] < cost[best])) {
                best = i;
            }
        }
        if (best == nodes) {
            return;
        }
        done[best] = true;
        for (uint32_t i = 0; i < nodes; i++) {
            double c = cost[best] + matrix[best][i];
            if (matrix[best][i] >= 0.0 && (cost[i] < 0.0 || c < cost[i])) {
                cost[i] = c;
            }
        }
    }
}

static nav_query query_of(uint32_t start, uint32_t goal, nav_heuristic heuristic) {
    nav_query q = nav_query_default();
    q.graph = graph;
    q.start = start, q.goal = goal;
    q.heuristic = heuristic;
    return q;
}

static void check_walk(const nav_query *q, const nav_result *r, const uint32_t *path) {
    double sum = 0.0;
    TEST_ASSERT_EQUAL_UINT32(q->start, path[0]);
    TEST_ASSERT_EQUAL_UINT32(r->reached, path[r->count - 1]);
    for (uint32_t i = 1; i < r->count; i++) {
        TEST_ASSERT_TRUE(matrix[path[i - 1]][path[i]] >= 0.0);
        sum += matrix[path[i - 1]][path[i]];
    }
    TEST_ASSERT_EQUAL_DOUBLE(sum, r->cost);
}

static void costs_are_dijkstras(void) {
    core_rng rng = core_rng_make(41, 1);
    uint64_t with = 0, without = 0;
    int found = 0, none = 0;
    for (int round = 0; round < 4000; round++) {
        random_graph(&rng, round % 4);
        uint32_t start = core_rng_below(&rng, nodes), goal = core_rng_below(&rng, nodes);
        double cost[MOST];
        dijkstra(start, cost);
        for (int h = NAV_EUCLID; h <= NAV_ZERO; h++) {
            nav_query q = query_of(start, goal, (nav_heuristic)h);
            nav_result r;
            uint32_t path[MOST];
            TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, path, MOST));
            if (cost[goal] < 0.0) {
                TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status);
                none++;
                continue;
            }
            found++;
            TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
            TEST_ASSERT_EQUAL_UINT32(goal, r.reached);
            TEST_ASSERT_TRUE(fabs(r.cost - cost[goal]) <= 1e-12 * (1.0 + cost[goal]));
            check_walk(&q, &r, path);
            with += h == NAV_EUCLID ? r.expanded : 0;
            without += h == NAV_ZERO ? r.expanded : 0;
        }
    }
    TEST_ASSERT_TRUE(found > 3000 && none > 1000); // both were tried
    TEST_ASSERT_TRUE(with < without);
}

static void weight_bounds_the_cost(void) {
    core_rng rng = core_rng_make(42, 1);
    const float weights[] = {1.1f, 1.5f, 2.0f, 5.0f};
    for (int round = 0; round < 2000; round++) {
        random_graph(&rng, round % 2);
        uint32_t start = core_rng_below(&rng, nodes), goal = core_rng_below(&rng, nodes);
        double cost[MOST];
        dijkstra(start, cost);
        nav_query q = query_of(start, goal, NAV_EUCLID);
        q.weight = weights[round % 4];
        nav_result r;
        TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, NULL, 0));
        TEST_ASSERT_EQUAL_INT(cost[goal] < 0.0 ? NAV_NO_PATH : NAV_FOUND, r.status);
        if (cost[goal] >= 0.0) {
            TEST_ASSERT_TRUE(r.cost <= (double)q.weight * cost[goal] * (1.0 + 1e-12));
        }
    }
}

// Without a way: the reachable node nearest to the goal.
static void partial_paths_end_nearest(void) {
    core_rng rng = core_rng_make(43, 1);
    int partial = 0;
    for (int round = 0; round < 2000; round++) {
        random_graph(&rng, round % 4);
        uint32_t start = core_rng_below(&rng, nodes), goal = core_rng_below(&rng, nodes);
        double cost[MOST];
        dijkstra(start, cost);
        if (cost[goal] >= 0.0) {
            continue;
        }
        core_vec3 g, p;
        nav_graph_position(world, graph, goal, &g);
        float least = INFINITY;
        for (uint32_t i = 0; i < nodes; i++) {
            nav_graph_position(world, graph, i, &p);
            float d = core_v3_length(core_v3_sub(p, g));
            least = cost[i] >= 0.0 && d < least ? d : least;
        }
        for (int h = NAV_EUCLID; h <= NAV_ZERO; h += 2) {
            nav_query q = query_of(start, goal, (nav_heuristic)h);
            q.partial = true;
            nav_result r;
            uint32_t path[MOST];
            TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, path, MOST));
            TEST_ASSERT_EQUAL_INT(NAV_PARTIAL, r.status);
            nav_graph_position(world, graph, r.reached, &p);
            TEST_ASSERT_FLOAT_WITHIN(1e-6f, least, core_v3_length(core_v3_sub(p, g)));
            check_walk(&q, &r, path);
            partial++;
        }
    }
    TEST_ASSERT_TRUE(partial > 300);
}

static void small_cases(void) {
    uint32_t a = nav_graph_add_node(world, graph, (core_vec3){0, 0, 0});
    uint32_t b = nav_graph_add_node(world, graph, (core_vec3){1, 0, 0});
    uint32_t c = nav_graph_add_node(world, graph, (core_vec3){2, 0, 0}), path[8] = {9, 9, 9};
    nav_query q = query_of(a, a, NAV_EUCLID);
    nav_result r;
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, path, 8)); // start is goal
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
    TEST_ASSERT_EQUAL_UINT32(1, r.count);
    TEST_ASSERT_EQUAL_UINT32(a, path[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0, r.cost);
    nav_graph_connect(world, graph, a, b);
    nav_graph_connect(world, graph, b, c);
    q = query_of(a, c, NAV_EUCLID);
    path[2] = 77;
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, path, 2)); // longer than the room for it
    TEST_ASSERT_EQUAL_UINT32(3, r.count);
    TEST_ASSERT_EQUAL_UINT32(b, path[1]);
    TEST_ASSERT_EQUAL_UINT32(77, path[2]);
    q.max_expansions = 1;
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, path, 8));
    TEST_ASSERT_EQUAL_INT(NAV_LIMIT, r.status);
    TEST_ASSERT_EQUAL_UINT32(0, r.count);
    q.partial = true;
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, path, 8));
    TEST_ASSERT_EQUAL_INT(NAV_LIMIT, r.status);
    TEST_ASSERT_EQUAL_UINT32(1, r.count);
    nav_graph_link(world, graph, a, c, 0.0f); // a portal: nothing is nearer
    q = query_of(a, c, NAV_EUCLID);
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, path, 8));
    TEST_ASSERT_EQUAL_UINT32(2, r.count);
    TEST_ASSERT_EQUAL_DOUBLE(0, r.cost);
}

static void bad_queries(void) {
    nav_graph_add_node(world, graph, (core_vec3){0, 0, 0});
    nav_query q = query_of(0, 5, NAV_EUCLID);
    nav_result r;
    TEST_ASSERT_FALSE(nav_graph_search(world, &q, &r, NULL, 0));
    TEST_ASSERT_EQUAL_INT(NAV_INVALID, r.status);
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "no node 5 to search to"));
    const float weights[] = {0.5f, -1.0f, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        q = query_of(0, 0, NAV_EUCLID);
        q.weight = weights[i];
        TEST_ASSERT_FALSE(nav_graph_search(world, &q, &r, NULL, 0));
    }
    q = query_of(0, 0, (nav_heuristic)9);
    TEST_ASSERT_FALSE(nav_graph_search(world, &q, &r, NULL, 0));
    nav_query raw = {0};
    TEST_ASSERT_FALSE(nav_graph_search(world, &raw, &r, NULL, 0));
    nav_graph_destroy(world, graph);
    q = query_of(0, 0, NAV_EUCLID);
    TEST_ASSERT_FALSE(nav_graph_search(world, &q, &r, NULL, 0));
    new_graph();
    TEST_ASSERT_FALSE(nav_graph_search(world, &q, &r, NULL, 0));
}

// A long chain: the way back is walked, not recursed.
static void long_chain(void) {
    nav_graph_desc desc = nav_graph_desc_default();
    graph = nav_graph_create(world, &desc);
    enum { LENGTH = 200000 };
    for (uint32_t i = 0; i < LENGTH; i++) {
        nav_graph_add_node(world, graph, (core_vec3){(float)i, 0, 0});
        if (i > 0) {
            nav_graph_connect(world, graph, i - 1, i);
        }
    }
    nav_query q = query_of(LENGTH - 1, 0, NAV_EUCLID);
    nav_result r;
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, NULL, 0));
    TEST_ASSERT_EQUAL_UINT32(LENGTH, r.count);
    TEST_ASSERT_EQUAL_DOUBLE(LENGTH - 1, r.cost);
    uint64_t before = core_alloc_count();
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &r, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
}

// ---- paths ----

static void paths_follow_the_graph(void) {
    for (int i = 0; i < 4; i++) { // a square
        nav_graph_add_node(world, graph, (core_vec3){(float)(i % 2) * 4, 0, (float)(i / 2) * 4});
    }
    nav_graph_connect(world, graph, 0, 1);
    nav_graph_connect(world, graph, 1, 3);
    nav_graph_connect(world, graph, 0, 2);
    nav_graph_link(world, graph, 2, 3, 5.0f);
    nav_path path = nav_path_create(world, graph, (core_vec3){0.3f, 0, 0}, (core_vec3){4, 1, 4});
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, nav_path_status(world, path));
    TEST_ASSERT_EQUAL_UINT32(3, nav_path_count(world, path));
    TEST_ASSERT_EQUAL_UINT32(1, nav_path_node(world, path, 1));
    TEST_ASSERT_EQUAL_DOUBLE(8, nav_path_cost(world, path));
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_NODE, nav_path_node(world, path, 3));
    uint32_t plans = nav_path_plans(world, path);
    nav_world_step(world, 0.1f);
    TEST_ASSERT_EQUAL_UINT32(plans, nav_path_plans(world, path)); // nothing changed
    nav_graph_set_open(world, graph, 1, 3, false);
    nav_world_step(world, 0.1f);
    TEST_ASSERT_EQUAL_UINT32(2, nav_path_node(world, path, 1));
    TEST_ASSERT_EQUAL_DOUBLE(9, nav_path_cost(world, path));
    nav_graph_unlink(world, graph, 2, 3);
    nav_world_step(world, 0.1f);
    TEST_ASSERT_EQUAL_INT(NAV_PARTIAL, nav_path_status(world, path));
    nav_graph_set_open(world, graph, 1, 3, true);
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, nav_path_update(world, path));
    TEST_ASSERT_TRUE(nav_path_set(world, path, (core_vec3){0, 0, 0}, (core_vec3){0, 0, 0}));
    TEST_ASSERT_EQUAL_UINT32(1, nav_path_count(world, path)); // start is goal
    nav_graph_destroy(world, graph);
    nav_world_step(world, 0.1f);
    TEST_ASSERT_EQUAL_INT(NAV_INVALID, nav_path_status(world, path));
    TEST_ASSERT_EQUAL_UINT32(0, nav_path_count(world, path));
    TEST_ASSERT_EQUAL_INT(NAV_INVALID, nav_path_update(world, path));
    TEST_ASSERT_TRUE(nav_path_destroy(world, path));
    TEST_ASSERT_FALSE(nav_path_destroy(world, path));
    TEST_ASSERT_EQUAL_INT(NAV_INVALID, nav_path_status(world, path));
}

static void paths_on_an_empty_graph(void) {
    nav_path path = nav_path_create(world, graph, (core_vec3){0, 0, 0}, (core_vec3){1, 0, 0});
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, nav_path_status(world, path));
    nav_graph_add_node(world, graph, (core_vec3){0, 0, 0});
    nav_world_step(world, 0.1f);
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, nav_path_status(world, path)); // one node is nearest to both
    TEST_ASSERT_TRUE(core_handle_is_null(
        nav_path_create(world, graph, (core_vec3){NAN, 0, 0}, (core_vec3){1, 0, 0})));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(costs_are_dijkstras);
    RUN_TEST(weight_bounds_the_cost);
    RUN_TEST(partial_paths_end_nearest);
    RUN_TEST(small_cases);
    RUN_TEST(bad_queries);
    RUN_TEST(long_chain);
    RUN_TEST(paths_follow_the_graph);
    RUN_TEST(paths_on_an_empty_graph);
    return UNITY_END();
}
