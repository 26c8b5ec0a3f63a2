// Searches in pieces give the same ways some steps later; and how much longer paths are than the
// shortest is measured.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "unity.h"

enum { SIDE = 64, PATHS = 20 };
static nav_world *world;
static uint8_t blocked[SIDE * SIDE];

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
}
void tearDown(void) {
    nav_world_destroy(world);
    core_clear_error();
}

static nav_mesh scattered(core_rng *rng) {
    for (int i = 0; i < SIDE * SIDE; i++) {
        blocked[i] = core_rng_below(rng, 100) < 25;
    }
    return nav_mesh_from_cells(world, SIDE, SIDE, blocked, 1.0f);
}
static core_vec3 anywhere(core_rng *rng) {
    return (core_vec3){SIDE * core_rng_float(rng), 0, SIDE * core_rng_float(rng)};
}

static void slices_give_the_same_ways(void) {
    core_rng rng = core_rng_make(2, 1);
    nav_mesh mesh = scattered(&rng);
    nav_path path[PATHS];
    double cost[PATHS];
    nav_status status[PATHS];
    core_vec3 a[PATHS], b[PATHS];
    for (int i = 0; i < PATHS; i++) {
        a[i] = anywhere(&rng), b[i] = anywhere(&rng);
        nav_path p = nav_path_create_on_mesh(world, mesh, a[i], b[i]);
        cost[i] = nav_path_cost(world, p);
        status[i] = nav_path_status(world, p);
        nav_path_destroy(world, p);
    }
    TEST_ASSERT_TRUE(nav_world_set(world, "slice", "60"));
    for (int i = 0; i < PATHS; i++) {
        path[i] = nav_path_create_on_mesh(world, mesh, a[i], b[i]);
        TEST_ASSERT_EQUAL_INT(NAV_PENDING, nav_path_status(world, path[i]));
    }
    int steps = 0, waiting = PATHS, seen[PATHS + 1] = {0};
    while (waiting && steps < 2000) {
        nav_world_step(world, 1.0f / 60.0f);
        steps++;
        waiting = 0;
        for (int i = 0; i < PATHS; i++) {
            waiting += nav_path_status(world, path[i]) == NAV_PENDING;
        }
        seen[waiting]++;
    }
    TEST_ASSERT_EQUAL_INT(0, waiting);
    TEST_ASSERT_TRUE(steps > 10);
    TEST_ASSERT_TRUE(seen[PATHS / 2] + seen[PATHS / 2 - 1] + seen[PATHS / 2 + 1] > 0);
    for (int i = 0; i < PATHS; i++) {
        TEST_ASSERT_EQUAL_INT(status[i], nav_path_status(world, path[i]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 * (1 + cost[i]), cost[i], nav_path_cost(world, path[i]));
    }
    TEST_ASSERT_FALSE(nav_world_set(world, "slice", "-1"));
    TEST_ASSERT_FALSE(nav_world_set(world, "slice", "many"));
}

// The surface goes, another comes, paths come and go while searches are under way; agents wait.
static void slices_survive_changes(void) {
    core_rng rng = core_rng_make(6, 1);
    nav_world_set(world, "slice", "5");
    nav_mesh mesh = scattered(&rng), other = scattered(&rng);
    nav_agent_desc d = nav_agent_desc_default();
    d.position = anywhere(&rng);
    nav_agent agent = nav_agent_create(world, &d);
    nav_path path[4];
    for (int i = 0; i < 4; i++) {
        path[i] =
            nav_path_create_on_mesh(world, i % 2 ? mesh : other, anywhere(&rng), anywhere(&rng));
    }
    nav_agent_go_on_mesh(world, agent, other, anywhere(&rng));
    for (int step = 0; step < 300; step++) {
        nav_world_step(world, 1.0f / 60.0f);
        if (step == 3) {
            nav_path_destroy(world, path[0]);
        } else if (step == 5) {
            nav_mesh_destroy(world, mesh);
        } else if (step == 9) {
            nav_path_set(world, path[2], anywhere(&rng), anywhere(&rng));
        }
    }
    TEST_ASSERT_EQUAL_INT(NAV_INVALID, nav_path_status(world, path[1]));
    TEST_ASSERT_TRUE(nav_path_status(world, path[2]) != NAV_PENDING);
    TEST_ASSERT_TRUE(nav_agent_status(world, agent) != NAV_AGENT_IDLE);
}

static void ratios_are_measured(void) {
    core_rng rng = core_rng_make(4, 1);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, nav_world_path_ratio_max(world, 0));
    nav_mesh mesh = nav_mesh_from_cells(world, SIDE, SIDE, NULL, 1.0f);
    nav_path_create_on_mesh(world, mesh, core_v3(1, 0, 1), core_v3(60, 0, 50));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, nav_world_path_ratio_max(world, 0));
    nav_path_create_on_mesh(world, scattered(&rng), core_v3(1, 0, 1), core_v3(60, 0, 50));
    double with_bends = nav_world_path_ratio_max(world, 0); // bends keep off their corners
    TEST_ASSERT_TRUE(with_bends > 1.0 && with_bends < 1.1);
    nav_graph_desc gd = nav_graph_desc_default();
    nav_graph graph = nav_graph_create(world, &gd);
    // Straight on looks better, round is cheaper: a weight of 4 takes the wrong one.
    uint32_t s = nav_graph_add_node(world, graph, core_v3(0, 0, 0));
    uint32_t by = nav_graph_add_node(world, graph, core_v3(5, 0, 0));
    uint32_t round = nav_graph_add_node(world, graph, core_v3(0, 0, 6));
    uint32_t g = nav_graph_add_node(world, graph, core_v3(10, 0, 0));
    nav_graph_link(world, graph, s, by, 5), nav_graph_link(world, graph, by, g, 20);
    nav_graph_link(world, graph, s, round, 6), nav_graph_link(world, graph, round, g, 12);
    nav_world_set(world, "weight", "10");
    nav_path_create(world, graph, core_v3(0, 0, 0), core_v3(10, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 25.0 / 18.0, nav_world_path_ratio_max(world, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(slices_give_the_same_ways);
    RUN_TEST(slices_survive_changes);
    RUN_TEST(ratios_are_measured);
    return UNITY_END();
}
