// Agents: they arrive, keep their limits, follow a changing graph, and never move by themselves
// when something else drives them.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "unity.h"

#define DT (1.0f / 60.0f)

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

// A field of n by n nodes 2 m apart, linked along the axes; node (x, z) is number x + n z.
static void field(uint32_t n) {
    for (uint32_t i = 0; i < n * n; i++) {
        nav_graph_add_node(world, graph,
                           (core_vec3){2.0f * (float)(i % n), 0, 2.0f * (float)(i / n)});
    }
    for (uint32_t i = 0; i < n * n; i++) {
        if (i % n + 1 < n) {
            nav_graph_connect(world, graph, i, i + 1);
        }
        if (i + n < n * n) {
            nav_graph_connect(world, graph, i, i + n);
        }
    }
}

static float heading(nav_agent agent) {
    float h = 0.0f;
    nav_agent_heading(world, agent, &h);
    return h;
}
static core_vec3 position(nav_agent agent) {
    core_vec3 p = {0, 0, 0};
    nav_agent_position(world, agent, &p);
    return p;
}
static core_vec3 velocity(nav_agent agent) {
    core_vec3 v = {0, 0, 0};
    nav_agent_velocity(world, agent, &v);
    return v;
}

typedef struct walk {
    float time, speed, turn, push; // taken; largest speed, turn rate and acceleration
} walk;

static walk until_arrived(nav_agent agent, float most_seconds) {
    walk w = {0};
    core_vec3 last_v = velocity(agent);
    float last_h = heading(agent);
    while (nav_agent_status(world, agent) == NAV_AGENT_WALKING && w.time < most_seconds) {
        TEST_ASSERT_TRUE(nav_world_step(world, DT));
        core_vec3 v = velocity(agent);
        float turn = fabsf(remainderf(heading(agent) - last_h, 2 * CORE_PI_F));
        w.speed = fmaxf(w.speed, core_v3_length(v));
        w.push = fmaxf(w.push, core_v3_length(core_v3_sub(v, last_v)) / DT);
        w.turn = fmaxf(w.turn, turn / DT);
        last_v = v;
        last_h = heading(agent);
        w.time += DT;
    }
    return w;
}

static void arrives_within_its_limits(void) {
    field(8);
    core_rng rng = core_rng_make(51, 1);
    for (int round = 0; round < 40; round++) {
        nav_agent_desc desc = nav_agent_desc_default();
        desc.position = (core_vec3){14 * core_rng_float(&rng), 0, 14 * core_rng_float(&rng)};
        desc.max_speed = 0.5f + 3.0f * core_rng_float(&rng);
        desc.acceleration = 4.0f + 8.0f * core_rng_float(&rng);
        desc.turn_rate = round % 2 ? 2.0f + 4.0f * core_rng_float(&rng) : 0.0f;
        nav_agent agent = nav_agent_create(world, &desc);
        core_vec3 goal = {14 * core_rng_float(&rng), 0, 14 * core_rng_float(&rng)};
        TEST_ASSERT_TRUE(nav_agent_go(world, agent, graph, goal));
        double length = nav_path_cost(world, nav_agent_path(world, agent));
        walk w = until_arrived(agent, 60.0f);
        TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
        TEST_ASSERT_TRUE(core_v3_length(core_v3_sub(position(agent), goal)) <= desc.arrive);
        TEST_ASSERT_TRUE(w.speed <= desc.max_speed * 1.0001f);
        if (desc.turn_rate > 0.0f) {
            TEST_ASSERT_TRUE(w.turn <= desc.turn_rate * 1.001f);
        } else {
            TEST_ASSERT_TRUE(w.push <= desc.acceleration * 1.001f);
        }
        // Start, goal and turns on the way cost time beside the way itself.
        float way = (float)length + 4.0f, slack = 4.0f + desc.max_speed / desc.acceleration * 4.0f;
        TEST_ASSERT_TRUE(w.time <= 1.3f * way / desc.max_speed + slack);
        nav_agent_destroy(world, agent);
    }
}

// The checklist's N4: time at most 1.3 of path / speed, where the path is long.
static void long_walk_in_time(void) {
    for (uint32_t i = 0; i <= 40; i++) {
        float bend = 3.0f * sinf((float)i * 0.4f);
        nav_graph_add_node(world, graph, (core_vec3){(float)i, 0, bend});
        if (i > 0) {
            nav_graph_connect(world, graph, i - 1, i);
        }
    }
    nav_agent_desc desc = nav_agent_desc_default();
    desc.turn_rate = 6.0f;
    desc.heading = 1.5f; // looks back
    nav_agent agent = nav_agent_create(world, &desc);
    nav_agent_go(world, agent, graph, (core_vec3){40, 0, 3.0f * sinf(16.0f)});
    float length = (float)nav_path_cost(world, nav_agent_path(world, agent));
    walk w = until_arrived(agent, 100.0f);
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(w.time <= 1.3f * length / desc.max_speed);
    TEST_ASSERT_TRUE(w.time >= length / desc.max_speed * 0.9f);
}

static void stays_near_the_links(void) {
    field(6);
    nav_agent_desc desc = nav_agent_desc_default();
    desc.turn_rate = 4.0f;
    nav_agent agent = nav_agent_create(world, &desc);
    nav_agent_go(world, agent, graph, (core_vec3){10, 0, 10});
    float worst = 0.0f;
    for (int i = 0; i < 2000 && nav_agent_status(world, agent) == NAV_AGENT_WALKING; i++) {
        nav_world_step(world, DT);
        core_vec3 p = position(agent); // links run along lines 2 m apart
        float off_x = fabsf(p.x - 2.0f * roundf(p.x / 2)),
              off_z = fabsf(p.z - 2.0f * roundf(p.z / 2));
        worst = fmaxf(worst, fminf(off_x, off_z));
    }
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(worst <= 0.3f); // its radius
}

static void climbs(void) {
    nav_graph_add_node(world, graph, (core_vec3){0, 0, 0});
    nav_graph_add_node(world, graph, (core_vec3){4, 3, 0});
    nav_graph_add_node(world, graph, (core_vec3){4, 6, 0}); // a ladder
    nav_graph_connect(world, graph, 0, 1);
    nav_graph_connect(world, graph, 1, 2);
    nav_agent_desc desc = nav_agent_desc_default();
    nav_agent agent = nav_agent_create(world, &desc);
    nav_agent_go(world, agent, graph, (core_vec3){4, 6, 0});
    walk w = until_arrived(agent, 30.0f);
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 6.0f, position(agent).y);
    TEST_ASSERT_TRUE(w.speed <= desc.max_speed * 1.001f);
}

static void walks_around_a_closed_door(void) {
    field(3);
    nav_agent_desc desc = nav_agent_desc_default();
    nav_agent agent = nav_agent_create(world, &desc);
    nav_agent_go(world, agent, graph, (core_vec3){4, 0, 0});
    for (int i = 0; i < 30; i++) {
        nav_world_step(world, DT);
    }
    nav_graph_set_open(world, graph, 1, 2, false); // straight ahead
    until_arrived(agent, 30.0f);
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(nav_path_cost(world, nav_agent_path(world, agent)) > 3.9);
    // All doors shut: stuck, until one opens.
    nav_agent_go(world, agent, graph, (core_vec3){0, 0, 0});
    for (uint32_t to = 0; to < 9; to++) {
        for (uint32_t n = 0; n < nav_graph_link_count(world, graph, to); n++) {
            nav_link link;
            nav_graph_link_at(world, graph, to, n, &link);
            if (link.to == 0) {
                nav_graph_set_open(world, graph, to, 0, false);
            }
        }
    }
    until_arrived(agent, 30.0f);
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_STUCK, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(core_v3_length(position(agent)) >= 1.5f);
    nav_graph_set_open(world, graph, 1, 0, true);
    for (int i = 0; i < 600; i++) {
        nav_world_step(world, DT);
    }
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(core_v3_length(position(agent)) <= 0.1f);
}

// Across a surface with a wall in the way: arrives, and keeps its distance from the wall.
static void walks_across_a_surface(void) {
    enum { SIDE = 40 };
    static uint8_t blocked[SIDE * SIDE];
    memset(blocked, 0, sizeof blocked);
    for (int z = 5; z < 35; z++) {
        blocked[z * SIDE + 20] = 1; // x from 5 to 5.25 m, z from 1.25 to 8.75 m
    }
    nav_mesh mesh = nav_mesh_from_cells(world, SIDE, SIDE, blocked, 0.25f);
    nav_agent_desc desc = nav_agent_desc_default();
    desc.position = (core_vec3){2, 0, 6};
    nav_agent agent = nav_agent_create(world, &desc);
    core_vec3 goal = {8, 0, 6};
    TEST_ASSERT_TRUE(nav_agent_go_on_mesh(world, agent, mesh, goal));
    double length = nav_path_cost(world, nav_agent_path(world, agent));
    // By the near end of the wall: bends at (5, 8.75) and (5.25, 8.75).
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, hypot(3, 2.75) + 0.25 + hypot(2.75, 2.75), length);
    core_vec3 p;
    TEST_ASSERT_TRUE(nav_path_point(world, nav_agent_path(world, agent), 1, &p));
    TEST_ASSERT_EQUAL_FLOAT(8.875f, p.z); // half a cell off the corner
    float time = 0.0f;
    while (nav_agent_status(world, agent) == NAV_AGENT_WALKING && time < 30.0f) {
        nav_world_step(world, DT);
        core_vec3 at = position(agent);
        TEST_ASSERT_FALSE(at.x > 5.05f && at.x < 5.2f && at.z > 1.3f && at.z < 8.7f);
        time += DT;
    }
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(core_v3_length(core_v3_sub(position(agent), goal)) <= desc.arrive);
    TEST_ASSERT_TRUE(time <= 1.3f * (float)length / desc.max_speed);
    nav_agent_go_on_mesh(world, agent, mesh, (core_vec3){2, 0, 6});
    nav_mesh_destroy(world, mesh);
    nav_world_step(world, DT);
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_STUCK, nav_agent_status(world, agent));
    TEST_ASSERT_FALSE(nav_agent_go_on_mesh(world, agent, mesh, (core_vec3){2, 0, 6}));
}

static void driven_agents_are_moved_by_others(void) {
    field(3);
    nav_agent_desc desc = nav_agent_desc_default();
    desc.driven = true;
    nav_agent agent = nav_agent_create(world, &desc);
    nav_agent_go(world, agent, graph, (core_vec3){4, 0, 0});
    nav_world_step(world, DT);
    TEST_ASSERT_EQUAL_FLOAT(0, position(agent).x);
    TEST_ASSERT_TRUE(velocity(agent).x > 0.0f);
    for (int i = 0; i < 120; i++) { // something holds it
        nav_world_step(world, DT);
    }
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_STUCK, nav_agent_status(world, agent));
    for (int i = 0; i < 300; i++) {
        core_vec3 p = position(agent), v = velocity(agent);
        nav_agent_set_position(world, agent, core_v3_mad(p, v, DT));
        nav_world_step(world, DT);
    }
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
}

static void bad_input(void) {
    field(2);
    nav_agent_desc raw = {0}, desc = nav_agent_desc_default();
    TEST_ASSERT_TRUE(core_handle_is_null(nav_agent_create(world, &raw)));
    desc.max_speed = -1.0f;
    TEST_ASSERT_TRUE(core_handle_is_null(nav_agent_create(world, &desc)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "max_speed (m/s) is -1"));
    desc = nav_agent_desc_default();
    desc.position.y = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(nav_agent_create(world, &desc)));
    desc = nav_agent_desc_default();
    nav_agent agent = nav_agent_create(world, &desc);
    TEST_ASSERT_FALSE(nav_agent_go(world, agent, graph, (core_vec3){NAN, 0, 0}));
    TEST_ASSERT_FALSE(nav_agent_go(world, agent, CORE_NULL_HANDLE, (core_vec3){0, 0, 0}));
    TEST_ASSERT_FALSE(nav_agent_set_position(world, agent, (core_vec3){INFINITY, 0, 0}));
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_IDLE, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(nav_agent_go(world, agent, graph, (core_vec3){2, 0, 2}));
    nav_graph_destroy(world, graph);
    TEST_ASSERT_TRUE(nav_world_step(world, DT));
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_STUCK, nav_agent_status(world, agent));
    const float steps[] = {0.0f, -1.0f, NAN, 2.0f};
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FALSE(nav_world_step(world, steps[i]));
    }
    TEST_ASSERT_TRUE(nav_agent_destroy(world, agent));
    TEST_ASSERT_FALSE(nav_agent_destroy(world, agent));
    TEST_ASSERT_FALSE(nav_world_set(world, "weigth", "2"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "did you mean weight"));
    TEST_ASSERT_FALSE(nav_world_set(world, "weight", "0.5"));
    TEST_ASSERT_FALSE(nav_world_set(world, "heuristic", "manhattan"));
    TEST_ASSERT_TRUE(nav_world_set(world, "heuristic", "octile"));
    TEST_ASSERT_TRUE(nav_world_set(world, "weight", "1.5"));
}

// The same calls give the same state, and a step allocates nothing once it is warm.
static uint64_t crowd_hash(bool *allocated) {
    field(10);
    core_rng rng = core_rng_make(52, 1);
    nav_agent agents[50];
    for (int i = 0; i < 50; i++) {
        nav_agent_desc desc = nav_agent_desc_default();
        desc.position = (core_vec3){18 * core_rng_float(&rng), 0, 18 * core_rng_float(&rng)};
        agents[i] = nav_agent_create(world, &desc);
        core_vec3 goal = {18 * core_rng_float(&rng), 0, 18 * core_rng_float(&rng)};
        nav_agent_go(world, agents[i], graph, goal);
    }
    for (int i = 0; i < 60; i++) {
        nav_world_step(world, DT);
    }
    uint64_t before = core_alloc_count();
    for (int i = 0; i < 120; i++) {
        nav_world_step(world, DT);
    }
    *allocated = core_alloc_count() != before;
    const core_columns *sets[16];
    int count = nav_world_state(world, sets, 16);
    TEST_ASSERT_EQUAL_INT(8, count);
    uint64_t hash = 0;
    for (int i = 0; i < count; i++) {
        uint64_t column[CORE_COLUMNS_MAX];
        core_columns_hash(sets[i], column);
        for (uint32_t c = 0; c < sets[i]->column_count; c++) {
            hash = hash * 31 + column[c];
        }
    }
    return hash;
}
static void same_calls_same_state(void) {
    bool allocated;
    uint64_t first = crowd_hash(&allocated);
    TEST_ASSERT_FALSE(allocated);
    tearDown();
    setUp();
    TEST_ASSERT_EQUAL_HEX64(first, crowd_hash(&allocated));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(arrives_within_its_limits);
    RUN_TEST(long_walk_in_time);
    RUN_TEST(stays_near_the_links);
    RUN_TEST(climbs);
    RUN_TEST(walks_around_a_closed_door);
    RUN_TEST(walks_across_a_surface);
    RUN_TEST(driven_agents_are_moved_by_others);
    RUN_TEST(bad_input);
    RUN_TEST(same_calls_same_state);
    return UNITY_END();
}
