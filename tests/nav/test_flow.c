// Flows: from everywhere the exact way to one goal, on a surface that changes, for agents.
#include <math.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "support/nav_boxes.h"
#include "unity.h"

static nav_world *world;

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
}
void tearDown(void) {
    nav_world_destroy(world);
    core_clear_error();
}

enum { SIDE = 24 };

static void flows_are_exact(void) {
    core_rng rng = core_rng_make(3, 1);
    uint8_t blocked[SIDE * SIDE];
    int found = 0, none = 0, bends = 0;
    for (int round = 0; round < 40; round++) {
        for (int i = 0; i < SIDE * SIDE; i++) {
            blocked[i] = core_rng_below(&rng, 100) < (uint32_t)(round % 5) * 10 + 5;
        }
        nav_mesh mesh = nav_mesh_from_cells(world, SIDE, SIDE, blocked, 0.5f);
        core_vec3 goal = {0.5f * SIDE * core_rng_float(&rng), 0,
                          0.5f * SIDE * core_rng_float(&rng)};
        nav_flow flow = nav_flow_create(world, mesh, goal);
        core_vec3 start[40];
        nav_result many[40];
        for (int k = 0; k < 40; k++) {
            start[k] = (core_vec3){0.5f * SIDE * core_rng_float(&rng), 0,
                                   0.5f * SIDE * core_rng_float(&rng)};
        }
        TEST_ASSERT_TRUE(nav_mesh_search_many(world, mesh, start, 40, goal, many));
        for (int k = 0; k < 40; k++) {
            nav_result exact, r;
            core_vec3 point[64];
            nav_mesh_search(world, mesh, start[k], goal, &exact, NULL, 0);
            TEST_ASSERT_TRUE(nav_flow_way(world, flow, start[k], &r, point, 64));
            TEST_ASSERT_EQUAL_INT(exact.status, r.status);
            TEST_ASSERT_EQUAL_INT(exact.status, many[k].status);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6 * (1 + exact.cost), exact.cost, r.cost);
            TEST_ASSERT_EQUAL_DOUBLE(r.cost, many[k].cost);
            double sum = 0;
            for (uint32_t i = 1; i < r.count && i < 64; i++) {
                sum += (double)core_v3_length(core_v3_sub(point[i], point[i - 1]));
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-4 * (1 + r.cost), r.cost, sum);
            found += r.status == NAV_FOUND, none += r.status == NAV_NO_PATH;
            bends += r.count > 2;
        }
        nav_flow_destroy(world, flow);
        nav_mesh_destroy(world, mesh);
    }
    TEST_ASSERT_TRUE(found > 500 && none > 50 && bends > 300);
}

static void agents_walk_with_a_flow(void) {
    nav_mesh_desc d = nav_mesh_desc_default();
    d.tile_cells = 16;
    d.bounds = (core_aabb){{0, 0, 0}, {30, 0, 30}};
    nav_box b;
    nav_mesh mesh =
        nav_mesh_build(world, nav_box_soup(&b, core_v3(0, -1, 0), core_v3(30, 0, 30)), &d);
    nav_flow flow = nav_flow_create(world, mesh, core_v3(27, 0, 15));
    nav_agent agent[10];
    for (int i = 0; i < 10; i++) {
        nav_agent_desc a = nav_agent_desc_default();
        a.position = core_v3(3, 0, 3 + 2.4f * (float)i);
        a.arrive = 1.5f;
        agent[i] = nav_agent_create(world, &a);
        TEST_ASSERT_TRUE(nav_agent_go_with_flow(world, agent[i], flow));
    }
    for (int i = 0; i < 200; i++) {
        nav_world_step(world, 1.0f / 60.0f);
    }
    nav_mesh_put(world, mesh, 1, nav_box_soup(&b, core_v3(15, 0, 4), core_v3(16, 2, 30)));
    nav_result r;
    for (int i = 0; i < 60 * 40; i++) {
        nav_world_step(world, 1.0f / 60.0f);
    }
    TEST_ASSERT_TRUE(nav_flow_way(world, flow, core_v3(3, 0, 15), &r, NULL, 0));
    TEST_ASSERT_DOUBLE_WITHIN(0.8, hypot(11.7, 11.4) + 1.6 + hypot(10.7, 11.4), r.cost);
    for (int i = 0; i < 10; i++) {
        core_vec3 p;
        nav_agent_position(world, agent[i], &p);
        TEST_ASSERT_TRUE(p.x > 24); // round the wall to the goal, or beside those who are there
    }
    TEST_ASSERT_TRUE(nav_mesh_destroy(world, mesh));
    TEST_ASSERT_FALSE(nav_flow_way(world, flow, core_v3(3, 0, 15), &r, NULL, 0));
    TEST_ASSERT_FALSE(nav_agent_go_with_flow(world, agent[0], flow));
    TEST_ASSERT_TRUE(nav_flow_destroy(world, flow));
    TEST_ASSERT_FALSE(nav_flow_destroy(world, flow));
    TEST_ASSERT_TRUE(nav_world_step(world, 1.0f / 60.0f));
}

static void bad_flows(void) {
    nav_mesh mesh = nav_mesh_from_cells(world, 4, 4, NULL, 1);
    TEST_ASSERT_TRUE(core_handle_is_null(nav_flow_create(world, (nav_mesh){0}, core_v3(0, 0, 0))));
    TEST_ASSERT_TRUE(core_handle_is_null(nav_flow_create(world, mesh, core_v3(NAN, 0, 0))));
    nav_flow off = nav_flow_create(world, mesh, core_v3(50, 0, 0));
    nav_result r;
    TEST_ASSERT_TRUE(nav_flow_way(world, off, core_v3(1, 0, 1), &r, NULL, 0));
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status);
    nav_flow here = nav_flow_create(world, mesh, core_v3(1.5f, 0, 1.5f));
    TEST_ASSERT_TRUE(nav_flow_way(world, here, core_v3(1.5f, 0, 1.5f), &r, NULL, 0));
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, r.cost);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(flows_are_exact);
    RUN_TEST(agents_walk_with_a_flow);
    RUN_TEST(bad_flows);
    return UNITY_END();
}
