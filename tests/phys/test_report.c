// What the report found wanting in its own engine (rows P23, P26): restitution at its number, no
// energy from nowhere, no body that becomes NaN, and a ball shot at a hull that gets off again.
#include "core/rng.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static const float gem[] = {0.5f, 0,     0, -0.5f, 0, 0,    0, 0.4f, 0,
                            0,    -0.4f, 0, 0,     0, 0.3f, 0, 0,    -0.3f};

static phys_body add(phys_body_type body, phys_shape_type type, core_vec3 at, core_vec3 v,
                     float restitution) {
    phys_body_desc d = phys_body_desc_default();
    d.type = body;
    d.position = at;
    d.velocity = v;
    phys_shape_desc s = phys_shape_desc_default(type);
    s.half = body == PHYS_STATIC ? core_v3(50, 1, 50) : core_v3(0.5f, 0.3f, 0.4f);
    s.radius = 0.4f;
    s.half_height = 0.4f;
    s.points = gem;
    s.point_count = 6;
    s.restitution = restitution;
    return phys_body_create(world, &d, &s, 1);
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, 1.0f / 60.0f));
    }
}

// Every kind falls flat on the ground at 6 m/s: it parts at e times that. What lands on several
// points at once is a little off: they are passed one after another.
static void test_speed_of_parting_is_e_times_that_of_approach(void) {
    static const float e[] = {0, 0.25f, 0.5f, 0.75f, 1};
    static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER};
    for (int t = 0; t < 4; t++) {
        for (int k = 0; k < 5; k++) {
            tearDown();
            setUp();
            phys_world_set_gravity(world, core_v3(0, 0, 0));
            add(PHYS_STATIC, PHYS_BOX, core_v3(0, -1, 0), core_v3(0, 0, 0), 0);
            phys_body b = add(PHYS_DYNAMIC, type[t], core_v3(0, 1.5f, 0), core_v3(0, -6, 0), e[k]);
            core_vec3 v;
            run(60);
            phys_body_velocity(world, b, &v);
            bool flat = type[t] == PHYS_BOX || type[t] == PHYS_CYLINDER;
            TEST_ASSERT_FLOAT_WITHIN(flat ? 0.54f : 0.006f, 6.0f * e[k], v.y);
            TEST_ASSERT_TRUE(v.y <= 6.0f);
        }
    }
}

// A crowd of every kind thrown about in a pit with walls, kicked at random: a quarter of a million
// body steps, no NaN, and energy only from the kicks.
static void test_no_nan_in_random_steps(void) {
    static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER,
                                           PHYS_HULL};
    core_rng rng = core_rng_make(26, 1);
    phys_body body[200];
    add(PHYS_STATIC, PHYS_BOX, core_v3(0, -1, 0), core_v3(0, 0, 0), 0);
    for (int k = 0; k < 200; k++) {
        core_vec3 at = {core_rng_float(&rng) * 6, 1 + 0.3f * (float)k, core_rng_float(&rng) * 6};
        body[k] = add(PHYS_DYNAMIC, type[k % 5], at, core_v3(0, 0, 0), core_rng_float(&rng));
    }
    phys_accuracy a;
    for (int i = 0; i < 1250; i++) {
        core_vec3 spin = {core_rng_float(&rng) * 200 - 100, core_rng_float(&rng) * 200 - 100,
                          core_rng_float(&rng) * 200 - 100};
        phys_body_set_angular_velocity(world, body[core_rng_below(&rng, 200)], spin);
        phys_body_set_velocity(world, body[core_rng_below(&rng, 200)], core_v3_scale(spin, 0.3f));
        run(1);
    }
    phys_world_accuracy(world, &a);
    TEST_ASSERT_EQUAL_UINT32(0, a.nan);
    run(120); // left alone it only loses
    phys_world_accuracy(world, &a);
    double before = a.energy_j;
    for (int i = 0; i < 20; i++) {
        run(15);
        phys_world_accuracy(world, &a);
        TEST_ASSERT_TRUE(a.energy_j <= before + 1e-3 * fabs(before));
        before = a.energy_j;
    }
}

// 50 m/s into a hull from all round: within 2 s nothing overlaps by more than 2 mm.
static void test_a_ball_shot_at_a_hull_gets_off_again(void) {
    core_rng rng = core_rng_make(5, 1);
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    for (int k = 0; k < 40; k++) {
        core_vec3 at = {(float)k * 8, 0, 0},
                  u = {core_rng_float(&rng) - 0.5f, core_rng_float(&rng) - 0.5f,
                       core_rng_float(&rng) - 0.5f};
        u = core_v3_scale(u, 1.0f / core_v3_length(u));
        add(PHYS_DYNAMIC, PHYS_HULL, at, core_v3(0, 0, 0), 0);
        add(PHYS_DYNAMIC, PHYS_SPHERE, core_v3_mad(at, u, -3.0f), core_v3_scale(u, 50), 0);
    }
    run(120);
    phys_accuracy a;
    phys_world_accuracy(world, &a);
    TEST_ASSERT_TRUE(a.penetration_max_m < 0.002);
    TEST_ASSERT_EQUAL_UINT32(0, a.nan);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_speed_of_parting_is_e_times_that_of_approach);
    RUN_TEST(test_no_nan_in_random_steps);
    RUN_TEST(test_a_ball_shot_at_a_hull_gets_off_again);
    return UNITY_END();
}
