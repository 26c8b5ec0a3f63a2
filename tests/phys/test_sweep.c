// Continuous collision: what is fast does not pass through, and what passes beside is left alone.
#include "core/log.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>

#define DT (1.0f / 60.0f)

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    d.zero_gravity = true;
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static phys_body add(phys_shape_type type, phys_body_type body, core_vec3 at, core_vec3 half,
                     core_vec3 v) {
    phys_body_desc d = phys_body_desc_default();
    d.type = body;
    d.position = at;
    d.velocity = v;
    phys_shape_desc s = phys_shape_desc_default(type);
    s.half = half;
    s.radius = half.x;
    s.half_height = half.y;
    return phys_body_create(world, &d, &s, 1);
}
static core_vec3 at(phys_body b) {
    core_vec3 p = {0, 0, 0};
    phys_body_position(world, b, &p);
    return p;
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, DT));
    }
}

// Scene S5, each kind of shot at each phase of the step.
static void shoot(phys_shape_type type, phys_body_type wall_type) {
    static const float speed[] = {10, 50, 100, 200, 500, 1000, 2000};
    static const float thick[] = {0.01f, 0.05f};
    for (size_t v = 0; v < CORE_COUNT_OF(speed); v++) {
        for (size_t t = 0; t < CORE_COUNT_OF(thick); t++) {
            tearDown();
            setUp();
            phys_body ball[8], wall[8];
            for (int k = 0; k < 8; k++) {
                float z = 4.0f * (float)k, start = 0.1f + speed[v] * DT * (1.0f + (float)k / 8.0f);
                wall[k] = add(PHYS_BOX, wall_type, core_v3(thick[t], 0, z), core_v3(thick[t], 1, 1),
                              core_v3(0, 0, 0));
                ball[k] = add(type, PHYS_DYNAMIC, core_v3(-start, 0, z),
                              core_v3(0.05f, 0.05f, 0.05f), core_v3(speed[v], 0, 0));
            }
            for (int i = 0; i < 10; i++) {
                run(1);
                for (int k = 0; k < 8; k++) {
                    TEST_ASSERT_TRUE(at(ball[k]).x < at(wall[k]).x);
                }
            }
        }
    }
}
static void test_no_ball_passes_a_static_wall(void) { shoot(PHYS_SPHERE, PHYS_STATIC); }
static void test_no_ball_passes_a_free_plate(void) { shoot(PHYS_SPHERE, PHYS_DYNAMIC); }
static void test_no_box_passes_a_static_wall(void) { shoot(PHYS_BOX, PHYS_STATIC); }
static void test_no_capsule_passes_a_static_wall(void) { shoot(PHYS_CAPSULE, PHYS_STATIC); }

static void test_bullets_meet_head_on(void) {
    for (int k = 0; k < 16; k++) {
        float offset = 3.0f + (float)k / 16.0f;
        phys_body a = add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(-offset, 0, 2.0f * (float)k),
                          core_v3(0.05f, 0, 0), core_v3(300, 0, 0));
        phys_body b = add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(3, 0, 2.0f * (float)k),
                          core_v3(0.05f, 0, 0), core_v3(-300, 0, 0));
        run(3);
        TEST_ASSERT_TRUE(at(a).x < at(b).x);
    }
}

static void test_a_near_miss_is_not_deflected(void) {
    static const float speed[] = {5, 20, 100, 500};
    static const phys_shape_type kind[] = {PHYS_BOX, PHYS_CYLINDER, PHYS_SPHERE};
    for (size_t i = 0; i < CORE_COUNT_OF(speed); i++) {
        for (size_t k = 0; k < CORE_COUNT_OF(kind); k++) {
            float z = 10.0f * (float)(i * 3 + k), r = 0.25f;
            add(kind[k], PHYS_STATIC, core_v3(0, 0, z), core_v3(r, r, r), core_v3(0, 0, 0));
            phys_body b = add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(-5.03f, 0, z + r + 0.251f),
                              core_v3(0.25f, 0, 0), core_v3(speed[i], 0, 0));
            run((int)(10.0f / (speed[i] * DT)) + 2);
            core_vec3 v;
            phys_body_velocity(world, b, &v);
            TEST_ASSERT_EQUAL_FLOAT(speed[i], v.x);
            TEST_ASSERT_EQUAL_FLOAT(0.0f, v.z);
        }
    }
}

static void test_a_spinning_rod_hits_what_it_sweeps_over(void) {
    phys_body rod = add(PHYS_BOX, PHYS_DYNAMIC, core_v3(0, 0, 0), core_v3(1.5f, 0.02f, 0.02f),
                        core_v3(0, 0, 0));
    phys_body_set_angular_velocity(world, rod, core_v3(0, 0, 40)); // 38 degrees a step
    phys_body ball =
        add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(1.2f * cosf(0.33f), 1.2f * sinf(0.33f), 0),
            core_v3(0.03f, 0, 0), core_v3(0, 0, 0));
    run(4);
    core_vec3 v;
    phys_body_velocity(world, ball, &v);
    TEST_ASSERT_TRUE(core_v3_length(v) > 5.0f);
}

int main(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    UNITY_BEGIN();
    RUN_TEST(test_no_ball_passes_a_static_wall);
    RUN_TEST(test_no_ball_passes_a_free_plate);
    RUN_TEST(test_no_box_passes_a_static_wall);
    RUN_TEST(test_no_capsule_passes_a_static_wall);
    RUN_TEST(test_bullets_meet_head_on);
    RUN_TEST(test_a_near_miss_is_not_deflected);
    RUN_TEST(test_a_spinning_rod_hits_what_it_sweeps_over);
    return UNITY_END();
}
