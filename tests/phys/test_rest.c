// Rest and its opposite: stacks and heavy loads stand without sagging, what rests sleeps and wakes
// when touched, and what moves slowly is not frozen.
#include "core/log.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
    phys_body_desc b = phys_body_desc_default();
    b.type = PHYS_STATIC;
    b.position = core_v3(0, -1, 0);
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = core_v3(50, 1, 50);
    phys_body_create(world, &b, &s, 1);
}
void tearDown(void) { phys_world_destroy(world); }

static void below(double limit, double value) {
    char text[64];
    snprintf(text, sizeof text, "%g is not below %g", value, limit);
    TEST_ASSERT_TRUE_MESSAGE(value < limit, text);
}
static phys_body add_cube(float x, float y, float z, float density) {
    phys_body_desc d = phys_body_desc_default();
    d.position = core_v3(x, y, z);
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = core_v3(0.5f, 0.5f, 0.5f);
    s.density = density;
    return phys_body_create(world, &d, &s, 1);
}
static phys_body add_ball(core_vec3 at, core_vec3 v) {
    phys_body_desc d = phys_body_desc_default();
    d.position = at;
    d.velocity = v;
    phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
    s.radius = 0.5f;
    return phys_body_create(world, &d, &s, 1);
}
static core_vec3 at(phys_body b) {
    core_vec3 p = {0, 0, 0};
    phys_body_position(world, b, &p);
    return p;
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, 1.0f / 60.0f));
    }
}
static int awake(void) {
    core_metrics *m = core_metrics_create();
    phys_world_counts(world, m);
    int n = (int)core_metrics_get(m, CORE_COUNT_AWAKE);
    core_metrics_destroy(m);
    return n;
}

// Scene S3: 40 cubes with 1 cm offsets.
static void test_tower_of_forty_stands(void) {
    phys_world_set(world, "sleep", "off");
    uint64_t seed = 5;
    phys_body top = CORE_NULL_HANDLE;
    core_vec3 start = {0, 0, 0};
    for (int i = 0; i < 40; i++) {
        float o[2];
        for (int k = 0; k < 2; k++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            o[k] = (2.0f * (float)(seed >> 40) / 16777216.0f - 1.0f) * 0.01f;
        }
        start = core_v3(o[0], 0.5f + (float)i, o[1]);
        top = add_cube(start.x, start.y, start.z, 1000);
    }
    run(600);
    below(0.04, fabs(at(top).y - start.y));
    below(0.02, hypot(at(top).x - start.x, at(top).z - start.z));
}

// Scene S4: the heavy one on top weighs a hundred and a thousand times as much.
static void heavy(int light, float ratio, double sag_limit) {
    phys_world_set(world, "sleep", "off");
    for (int i = 0; i < light; i++) {
        add_cube(0, 0.5f + (float)i, 0, 1000);
    }
    phys_body top = add_cube(0, 0.5f + (float)light, 0, 1000 * ratio);
    run(600);
    double sag = 0.5 + light - at(top).y;
    below(sag_limit, sag);
    below(0.001, -sag); // and does not float
    core_vec3 v;
    phys_body_velocity(world, top, &v);
    below(0.002, core_v3_length(v));
}
static void test_one_under_a_hundred(void) { heavy(1, 100, 0.003); }
static void test_one_under_a_thousand(void) { heavy(1, 1000, 0.025); }
static void test_five_under_a_thousand(void) { heavy(5, 1000, 0.1); }

static void test_rest_sleeps_and_a_touch_wakes(void) {
    phys_body low = add_cube(0, 0.5f, 0, 1000), high = add_cube(0, 1.5f, 0, 1000);
    phys_body far = add_cube(20, 0.5f, 0, 1000);
    run(120);
    TEST_ASSERT_EQUAL_INT(0, awake());
    core_vec3 before = at(far);
    add_ball(core_v3(0, 6, 0), core_v3(0, 0, 0));
    run(20);
    TEST_ASSERT_EQUAL_INT(1, awake()); // the ball alone is falling
    run(70);
    TEST_ASSERT_TRUE(awake() >= 3);
    TEST_ASSERT_EQUAL_FLOAT(before.y, at(far).y);
    run(600);
    phys_body_destroy(world, low);
    run(60);
    below(0.6, at(high).y); // what lost its support falls
}

static void test_slow_ball_is_not_frozen(void) {
    phys_body b = add_ball(core_v3(0, 0.5f, 0), core_v3(0.01f, 0, 0));
    phys_body_set_angular_velocity(world, b, core_v3(0, 0, -0.02f)); // rolls
    run(1200);
    TEST_ASSERT_FLOAT_WITHIN(0.004f, 0.2f, at(b).x);
}

static void test_deep_overlap_parts_without_gaining_energy(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_body a = add_cube(0, 5, 0, 1000), b = add_cube(0.3f, 5.2f, 0.1f, 1000);
    phys_body c = add_ball(core_v3(10, 5, 0), core_v3(0, 0, 0));
    phys_body d = add_ball(core_v3(10, 5, 0), core_v3(0, 0, 0)); // the same place
    run(120);
    phys_accuracy acc;
    phys_world_accuracy(world, &acc);
    below(0.005, acc.penetration_max_m);
    const phys_body all[4] = {a, b, c, d};
    for (int i = 0; i < 4; i++) {
        core_vec3 v;
        phys_body_velocity(world, all[i], &v);
        below(0.1, core_v3_length(v)); // from 0.7 m deep; pushed out at up to 3 m/s
    }
}

int main(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    UNITY_BEGIN();
    RUN_TEST(test_tower_of_forty_stands);
    RUN_TEST(test_one_under_a_hundred);
    RUN_TEST(test_one_under_a_thousand);
    RUN_TEST(test_five_under_a_thousand);
    RUN_TEST(test_rest_sleeps_and_a_touch_wakes);
    RUN_TEST(test_slow_ball_is_not_frozen);
    RUN_TEST(test_deep_overlap_parts_without_gaining_energy);
    return UNITY_END();
}
