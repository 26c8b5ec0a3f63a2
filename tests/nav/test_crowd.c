// Agents among each other: a circle whose members all cross its middle, two columns that meet, a
// crowd around some who stand; and the same result on any number of threads.
#include <math.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "unity.h"

#define DT (1.0f / 60.0f)
enum { MOST = 400 };

static nav_world *world;
static nav_graph graph;
static nav_agent agents[MOST];
static core_vec3 goals[MOST];
static int count;

static void start(core_jobs *jobs) {
    nav_world_desc desc = nav_world_desc_default();
    desc.jobs = jobs;
    world = nav_world_create(&desc);
    nav_graph_desc graph_desc = nav_graph_desc_default();
    graph = nav_graph_create(world, &graph_desc);
    count = 0;
}
void setUp(void) { start(NULL); }
void tearDown(void) { nav_world_destroy(world); }

static void send(core_vec3 from, core_vec3 to) {
    nav_graph_add_node(world, graph, from);
    nav_graph_add_node(world, graph, to);
    nav_agent_desc desc = nav_agent_desc_default();
    desc.position = from;
    goals[count] = to;
    agents[count++] = nav_agent_create(world, &desc);
}
static void connect_all(void) { // open ground: every node sees every other
    for (uint32_t a = 0; a < nav_graph_node_count(world, graph); a++) {
        for (uint32_t b = 0; b < a; b++) {
            nav_graph_connect(world, graph, a, b);
        }
    }
}
static void go(void) {
    connect_all();
    for (int i = 0; i < count; i++) {
        TEST_ASSERT_TRUE(nav_agent_go(world, agents[i], graph, goals[i]));
    }
}

typedef struct outcome {
    float overlap; // deepest, of the radius
    int arrived;
    float time; // until the last one arrived
    float speed;
} outcome;

static float deepest(void) {
    static core_vec3 p[MOST];
    float worst = 0.0f;
    for (int i = 0; i < count; i++) {
        nav_agent_position(world, agents[i], &p[i]);
        for (int k = 0; k < i; k++) {
            float dx = p[i].x - p[k].x, dz = p[i].z - p[k].z;
            worst = fmaxf(worst, (0.6f - sqrtf(dx * dx + dz * dz)) / 0.3f);
        }
    }
    return worst;
}

static outcome walk(float seconds) {
    outcome o = {0};
    for (int step = 0; step < (int)(seconds / DT) && o.arrived < count; step++) {
        nav_world_step(world, DT);
        o.overlap = fmaxf(o.overlap, deepest());
        o.arrived = 0;
        o.time += DT;
        for (int i = 0; i < count; i++) {
            core_vec3 v;
            nav_agent_velocity(world, agents[i], &v);
            o.speed = fmaxf(o.speed, core_v3_length(v));
            o.arrived += nav_agent_status(world, agents[i]) == NAV_AGENT_ARRIVED;
        }
    }
    return o;
}

static void circle(int n, float radius) {
    for (int i = 0; i < n; i++) {
        float angle = 2 * CORE_PI_F * (float)i / (float)n;
        core_vec3 from = {radius * cosf(angle), 0, radius * sinf(angle)};
        send(from, (core_vec3){-from.x, 0, -from.z});
    }
    go();
}

static void crossing_a_circle(void) {
    circle(80, 12.0f);
    outcome o = walk(120.0f);
    TEST_ASSERT_EQUAL_INT(80, o.arrived);
    TEST_ASSERT_TRUE(o.overlap <= 0.02f);
    TEST_ASSERT_TRUE(o.speed <= 1.5f * 1.001f);
    TEST_ASSERT_TRUE(o.time >= 24.0f / 1.5f && o.time <= 4.0f * 24.0f / 1.5f);
}

// Without avoidance the same circle collapses: the test can fail.
static void crossing_without_avoidance(void) {
    TEST_ASSERT_TRUE(nav_world_set(world, "avoidance", "none"));
    circle(40, 12.0f);
    outcome o = walk(30.0f);
    TEST_ASSERT_EQUAL_INT(40, o.arrived);
    TEST_ASSERT_TRUE(o.overlap > 0.5f);
}

static void two_columns_meet(void) {
    for (int i = 0; i < 24; i++) {
        float along = 4.0f + 0.9f * (float)(i / 4), across = 0.9f * (float)(i % 4);
        // They come to rest with room to pass between them.
        float rest = 16.0f - 1.5f * (float)(i / 4), apart = 1.5f * (float)(i % 4);
        send((core_vec3){along, 0, across}, (core_vec3){-rest, 0, apart});
        send((core_vec3){-along, 0, across}, (core_vec3){rest, 0, apart});
    }
    go();
    outcome o = walk(90.0f);
    TEST_ASSERT_EQUAL_INT(48, o.arrived);
    TEST_ASSERT_TRUE(o.overlap <= 0.02f);
}

static void around_those_who_stand(void) {
    for (int i = 0; i < 5; i++) { // a row of posts that nobody may push
        nav_agent_desc desc = nav_agent_desc_default();
        desc.position = (core_vec3){0, 0, 1.5f * (float)(i - 2)};
        agents[count++] = nav_agent_create(world, &desc);
    }
    for (int i = 0; i < 6; i++) {
        float across = 0.8f * (float)(i - 3);
        send((core_vec3){-8, 0, across}, (core_vec3){8, 0, across});
    }
    connect_all();
    for (int i = 5; i < count; i++) {
        nav_agent_go(world, agents[i], graph, goals[i]);
    }
    outcome o = walk(40.0f);
    TEST_ASSERT_EQUAL_INT(6, o.arrived);
    TEST_ASSERT_TRUE(o.overlap <= 0.02f);
    for (int i = 0; i < 5; i++) {
        core_vec3 p;
        nav_agent_position(world, agents[i], &p);
        TEST_ASSERT_EQUAL_FLOAT(0, p.x);
    }
}

static void storeys_apart(void) {
    send((core_vec3){-3, 0, 0}, (core_vec3){3, 0, 0});
    send((core_vec3){3, 3, 0}, (core_vec3){-3, 3, 0});
    go();
    for (int i = 0; i < 240; i++) {
        nav_world_step(world, DT);
        core_vec3 p;
        nav_agent_position(world, agents[0], &p);
        TEST_ASSERT_EQUAL_FLOAT(0, p.z); // it does not step aside for who walks overhead
    }
}

static void same_place(void) { // two on one spot part
    send((core_vec3){0, 0, 0}, (core_vec3){5, 0, 0});
    send((core_vec3){0, 0, 0}, (core_vec3){5, 0, 1});
    go();
    outcome o = walk(20.0f);
    TEST_ASSERT_EQUAL_INT(2, o.arrived);
    TEST_ASSERT_TRUE(deepest() <= 0.0f);
}

static uint64_t agents_hash(void) {
    const core_columns *sets[16];
    int n = nav_world_state(world, sets, 16);
    uint64_t hash = 0;
    for (int i = 0; i < n && i < 16; i++) {
        uint64_t column[CORE_COLUMNS_MAX];
        core_columns_hash(sets[i], column);
        for (uint32_t c = 0; c < sets[i]->column_count; c++) {
            hash = hash * 31 + column[c];
        }
    }
    return hash;
}
static void same_on_any_number_of_threads(void) {
    uint64_t hash[3];
    for (int t = 0; t < 3; t++) {
        tearDown();
        core_jobs *jobs = core_jobs_create(t + 1);
        start(jobs);
        circle(200, 25.0f);
        for (int i = 0; i < 120; i++) {
            nav_world_step(world, DT);
        }
        hash[t] = agents_hash();
        tearDown();
        core_jobs_destroy(jobs);
        start(NULL);
    }
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[2]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(crossing_a_circle);
    RUN_TEST(crossing_without_avoidance);
    RUN_TEST(two_columns_meet);
    RUN_TEST(around_those_who_stand);
    RUN_TEST(storeys_apart);
    RUN_TEST(same_place);
    RUN_TEST(same_on_any_number_of_threads);
    return UNITY_END();
}
