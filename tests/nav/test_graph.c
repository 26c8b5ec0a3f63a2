// Waypoint graphs: what the report's Node and NavGraph do (4.4), and what they did wrong.
#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "unity.h"

static nav_world *world;
static nav_graph graph;

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
    nav_graph_desc graph_desc = nav_graph_desc_default();
    graph = nav_graph_create(world, &graph_desc);
}
void tearDown(void) {
    nav_world_destroy(world);
    core_clear_error();
}

static uint32_t add(float x, float y, float z) {
    return nav_graph_add_node(world, graph, (core_vec3){x, y, z});
}
static bool says(const char *part) { return strstr(core_last_error(), part) != NULL; }

static void ids_and_positions(void) {
    TEST_ASSERT_EQUAL_UINT32(0, add(1, 2, 3));
    TEST_ASSERT_EQUAL_UINT32(1, add(4, 5, 6));
    core_vec3 p;
    TEST_ASSERT_TRUE(nav_graph_position(world, graph, 1, &p));
    TEST_ASSERT_EQUAL_FLOAT(5, p.y);
    TEST_ASSERT_EQUAL_UINT32(2, nav_graph_node_count(world, graph));
    TEST_ASSERT_TRUE(nav_graph_remove_node(world, graph, 0));
    TEST_ASSERT_EQUAL_UINT32(1, nav_graph_node_count(world, graph));
    TEST_ASSERT_EQUAL_UINT32(2, add(0, 0, 0)); // ids are never given again
    TEST_ASSERT_FALSE(nav_graph_position(world, graph, 0, &p));
    TEST_ASSERT_TRUE(says("no node 0"));
    TEST_ASSERT_FALSE(nav_graph_remove_node(world, graph, 0));
    TEST_ASSERT_TRUE(nav_graph_node_exists(world, graph, 1));
    TEST_ASSERT_EQUAL_UINT32(3, nav_graph_id_end(world, graph));
}

static void connect_costs_the_distance_both_ways(void) {
    uint32_t a = add(0, 0, 0), b = add(3, 0, 4);
    TEST_ASSERT_TRUE(nav_graph_connect(world, graph, a, b));
    nav_link link;
    TEST_ASSERT_TRUE(nav_graph_link_at(world, graph, a, 0, &link));
    TEST_ASSERT_EQUAL_UINT32(b, link.to);
    TEST_ASSERT_EQUAL_FLOAT(5, link.cost);
    TEST_ASSERT_TRUE(nav_graph_link_at(world, graph, b, 0, &link));
    TEST_ASSERT_EQUAL_UINT32(a, link.to);
    TEST_ASSERT_TRUE(link.open);
    TEST_ASSERT_FALSE(nav_graph_connect(world, graph, b, a));
    TEST_ASSERT_TRUE(says("already"));
    TEST_ASSERT_FALSE(nav_graph_connect(world, graph, a, a));
    TEST_ASSERT_TRUE(says("itself"));
    TEST_ASSERT_FALSE(nav_graph_connect(world, graph, a, 7));
    TEST_ASSERT_TRUE(says("no node 7"));
    TEST_ASSERT_FALSE(nav_graph_link_at(world, graph, a, 1, &link));
    TEST_ASSERT_TRUE(says("which has 1"));
}

// The report's rearrangeNeighbors: neighbours stay contiguous and in order.
static void removing_a_link_keeps_the_order(void) {
    uint32_t hub = add(0, 0, 0);
    for (uint32_t i = 1; i <= 20; i++) {
        TEST_ASSERT_TRUE(nav_graph_connect(world, graph, hub, add((float)i, 0, 0)));
    }
    TEST_ASSERT_TRUE(nav_graph_disconnect(world, graph, 7, hub));
    TEST_ASSERT_EQUAL_UINT32(19, nav_graph_link_count(world, graph, hub));
    TEST_ASSERT_EQUAL_UINT32(0, nav_graph_link_count(world, graph, 7));
    for (uint32_t n = 0; n < 19; n++) {
        nav_link link;
        TEST_ASSERT_TRUE(nav_graph_link_at(world, graph, hub, n, &link));
        TEST_ASSERT_EQUAL_UINT32(n < 6 ? n + 1 : n + 2, link.to);
        TEST_ASSERT_EQUAL_FLOAT((float)link.to, link.cost);
    }
    TEST_ASSERT_FALSE(nav_graph_disconnect(world, graph, 7, hub));
    TEST_ASSERT_TRUE(says("no link"));
}

// The report refused the ninth neighbour on one side and added it on the other.
static void cap_of_eight_neighbours(void) {
    nav_graph_desc desc = nav_graph_desc_default();
    desc.max_links = NAV_REPORT_LINKS;
    graph = nav_graph_create(world, &desc);
    uint32_t hub = add(0, 0, 0);
    for (uint32_t i = 1; i <= 9; i++) {
        TEST_ASSERT_EQUAL_INT(i <= 8, nav_graph_connect(world, graph, hub, add((float)i, 0, 0)));
    }
    TEST_ASSERT_TRUE(says("has 8 links"));
    TEST_ASSERT_FALSE(nav_graph_connect(world, graph, 9, hub));
    TEST_ASSERT_EQUAL_UINT32(8, nav_graph_link_count(world, graph, hub));
    TEST_ASSERT_EQUAL_UINT32(0, nav_graph_link_count(world, graph, 9));
    TEST_ASSERT_TRUE(nav_graph_disconnect(world, graph, hub, 1));
    TEST_ASSERT_TRUE(nav_graph_connect(world, graph, hub, 9));
}

static void one_way_links_and_costs(void) {
    uint32_t a = add(0, 0, 0), b = add(1, 0, 0);
    TEST_ASSERT_TRUE(nav_graph_link(world, graph, a, b, 0.25f));
    TEST_ASSERT_EQUAL_UINT32(0, nav_graph_link_count(world, graph, b));
    TEST_ASSERT_FALSE(nav_graph_connect(world, graph, a, b));
    const float bad[] = {-1.0f, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_FALSE(nav_graph_link(world, graph, b, a, bad[i]));
        TEST_ASSERT_TRUE(says("finite number >= 0"));
        TEST_ASSERT_FALSE(nav_graph_set_cost(world, graph, a, b, bad[i]));
    }
    uint64_t version = nav_graph_version(world, graph);
    TEST_ASSERT_TRUE(nav_graph_set_cost(world, graph, a, b, 2.0f));
    TEST_ASSERT_TRUE(nav_graph_version(world, graph) != version);
    version = nav_graph_version(world, graph);
    TEST_ASSERT_TRUE(nav_graph_set_open(world, graph, a, b, true));
    TEST_ASSERT_TRUE(nav_graph_version(world, graph) == version);
    TEST_ASSERT_TRUE(nav_graph_set_open(world, graph, a, b, false));
    nav_link link;
    TEST_ASSERT_TRUE(nav_graph_link_at(world, graph, a, 0, &link));
    TEST_ASSERT_FALSE(link.open);
    TEST_ASSERT_FALSE(nav_graph_set_open(world, graph, b, a, false));
    TEST_ASSERT_TRUE(nav_graph_unlink(world, graph, a, b));
    TEST_ASSERT_FALSE(nav_graph_unlink(world, graph, a, b));
}

static void removing_a_node_removes_its_links(void) {
    for (int i = 0; i < 30; i++) {
        add((float)i, 0, 0);
    }
    for (uint32_t i = 0; i < 30; i++) {
        for (uint32_t j = i + 1; j < 30; j++) {
            TEST_ASSERT_TRUE(nav_graph_connect(world, graph, i, j));
        }
    }
    TEST_ASSERT_TRUE(nav_graph_remove_node(world, graph, 11));
    for (uint32_t i = 0; i < 30; i++) {
        if (i != 11) {
            TEST_ASSERT_EQUAL_UINT32(28, nav_graph_link_count(world, graph, i));
            nav_link link;
            for (uint32_t n = 0; n < 28; n++) {
                nav_graph_link_at(world, graph, i, n, &link);
                TEST_ASSERT_TRUE(link.to != 11);
            }
        }
    }
}

static void print_tells_all(void) {
    uint32_t a = add(0, 0, 0), b = add(0, 0, 2.5f);
    add(9, 0, 0);
    nav_graph_connect(world, graph, a, b);
    nav_graph_set_open(world, graph, b, a, false);
    nav_graph_remove_node(world, graph, 2);
    const char *expected = "graph 'graph': 2 nodes\n"
                           "node 0 (0, 0, 0): 1 (2.5)\n"
                           "node 1 (0, 0, 2.5): 0 (2.5, closed)\n";
    char text[200], small[10];
    TEST_ASSERT_EQUAL_UINT32(strlen(expected), nav_graph_print(world, graph, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(expected, text);
    TEST_ASSERT_EQUAL_UINT32(strlen(expected), nav_graph_print(world, graph, small, sizeof small));
    TEST_ASSERT_EQUAL_STRING("graph 'gr", small);
    TEST_ASSERT_EQUAL_UINT32(strlen(expected), nav_graph_print(world, graph, NULL, 0));
}

static uint32_t brute_nearest(core_vec3 p, float limit) {
    uint32_t best = NAV_NO_NODE;
    double least = limit > 0 ? (double)limit * (double)limit : 1e300;
    for (uint32_t i = 0; i < nav_graph_id_end(world, graph); i++) {
        core_vec3 q;
        if (!nav_graph_node_exists(world, graph, i)) {
            continue;
        }
        nav_graph_position(world, graph, i, &q);
        double dx = (double)q.x - p.x, dy = (double)q.y - p.y, dz = (double)q.z - p.z;
        double square = dx * dx + dy * dy + dz * dz;
        if (square < least || (square == least && best == NAV_NO_NODE)) {
            least = square;
            best = i;
        }
    }
    return best;
}

static void nearest_is_the_nearest(void) {
    core_rng rng = core_rng_make(31, 1);
    const float spreads[] = {1.0f, 100.0f, 1e6f};
    for (int round = 0; round < 12; round++) {
        nav_graph_desc desc = nav_graph_desc_default();
        graph = nav_graph_create(world, &desc);
        float spread = spreads[round % 3], height = round % 2 ? spread : 0.0f;
        for (int i = 0; i < 20 + round * 60; i++) {
            core_vec3 p = {spread * core_rng_float(&rng), height * core_rng_float(&rng),
                           round % 4 == 3 ? 0.0f : spread * core_rng_float(&rng)};
            add(p.x, p.y, p.z);
            if (i % 7 == 6) { // equal points: the smaller id wins
                add(p.x, p.y, p.z);
            }
            if (i % 11 == 10) {
                nav_graph_remove_node(world, graph, core_rng_below(&rng, (uint32_t)i));
            }
        }
        for (int i = 0; i < 300; i++) {
            float far = i % 5 ? 1.5f : 20.0f;
            core_vec3 p = {far * spread * (core_rng_float(&rng) - 0.2f),
                           height * core_rng_float(&rng),
                           far * spread * (core_rng_float(&rng) - 0.2f)};
            TEST_ASSERT_EQUAL_UINT32(brute_nearest(p, 0), nav_graph_nearest(world, graph, p, 0));
            float limit = 0.05f * spread;
            TEST_ASSERT_EQUAL_UINT32(brute_nearest(p, limit),
                                     nav_graph_nearest(world, graph, p, limit));
        }
        nav_graph_destroy(world, graph);
    }
}

static void moving_a_node(void) {
    uint32_t a = add(0, 0, 0), b = add(10, 0, 0);
    nav_graph_connect(world, graph, a, b);
    TEST_ASSERT_TRUE(nav_graph_move_node(world, graph, a, (core_vec3){100, 0, 0}));
    TEST_ASSERT_EQUAL_UINT32(b, nav_graph_nearest(world, graph, (core_vec3){0, 0, 0}, 0));
    TEST_ASSERT_EQUAL_UINT32(a, nav_graph_nearest(world, graph, (core_vec3){99, 0, 0}, 0));
    TEST_ASSERT_FALSE(nav_graph_move_node(world, graph, a, (core_vec3){NAN, 0, 0}));
}

static void bad_input(void) {
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_NODE, nav_graph_nearest(world, graph, (core_vec3){0, 0, 0}, 0));
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_NODE, add(NAN, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_NODE, add(0, INFINITY, 0));
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_NODE,
                             nav_graph_nearest(world, graph, (core_vec3){NAN, 0, 0}, 0));
    nav_graph_desc raw = {0};
    TEST_ASSERT_TRUE(core_handle_is_null(nav_graph_create(world, &raw)));
    TEST_ASSERT_TRUE(core_handle_is_null(nav_graph_create(world, NULL)));
    nav_graph_desc desc = nav_graph_desc_default();
    desc.max_nodes = 3;
    graph = nav_graph_create(world, &desc);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_UINT32(i < 3 ? (uint32_t)i : NAV_NO_NODE, add((float)i, 0, 0));
    }
    TEST_ASSERT_TRUE(nav_graph_destroy(world, graph));
    TEST_ASSERT_FALSE(nav_graph_destroy(world, graph));
    TEST_ASSERT_TRUE(says("does not exist"));
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_NODE, add(0, 0, 0));
    TEST_ASSERT_FALSE(nav_graph_connect(world, graph, 0, 1));
    TEST_ASSERT_EQUAL_UINT32(0, nav_graph_node_count(world, graph));
}

// Thousands of random edits against a plain matrix of what is linked.
static void edits_against_a_matrix(void) {
    enum { N = 24 };
    static float cost[N][N];
    memset(cost, 0, sizeof cost);
    core_rng rng = core_rng_make(32, 1);
    for (int i = 0; i < N; i++) {
        add((float)i, 0, 0);
    }
    for (int step = 0; step < 20000; step++) {
        uint32_t a = core_rng_below(&rng, N), b = core_rng_below(&rng, N);
        float c = 1.0f + core_rng_float(&rng);
        bool linked = cost[a][b] != 0.0f, add_link = core_rng_below(&rng, 2) != 0;
        bool refused = a == b || linked == add_link;
        if (refused && step % 1000 != 0) {
            continue; // an error now and then is enough
        }
        if (add_link) {
            TEST_ASSERT_EQUAL_INT(a != b && cost[a][b] == 0.0f,
                                  nav_graph_link(world, graph, a, b, c));
            cost[a][b] = a != b && cost[a][b] == 0.0f ? c : cost[a][b];
        } else {
            TEST_ASSERT_EQUAL_INT(cost[a][b] != 0.0f, nav_graph_unlink(world, graph, a, b));
            cost[a][b] = 0.0f;
        }
    }
    for (uint32_t a = 0; a < N; a++) {
        uint32_t links = 0;
        for (uint32_t b = 0; b < N; b++) {
            links += cost[a][b] != 0.0f;
        }
        TEST_ASSERT_EQUAL_UINT32(links, nav_graph_link_count(world, graph, a));
        for (uint32_t n = 0; n < links; n++) {
            nav_link link;
            nav_graph_link_at(world, graph, a, n, &link);
            TEST_ASSERT_EQUAL_FLOAT(cost[a][link.to], link.cost);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(ids_and_positions);
    RUN_TEST(connect_costs_the_distance_both_ways);
    RUN_TEST(removing_a_link_keeps_the_order);
    RUN_TEST(cap_of_eight_neighbours);
    RUN_TEST(one_way_links_and_costs);
    RUN_TEST(removing_a_node_removes_its_links);
    RUN_TEST(print_tells_all);
    RUN_TEST(nearest_is_the_nearest);
    RUN_TEST(moving_a_node);
    RUN_TEST(bad_input);
    RUN_TEST(edits_against_a_matrix);
    return UNITY_END();
}
