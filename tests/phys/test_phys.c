// The world through its public header: free motion against closed forms, contacts against geometry,
// piles at rest, handles, bad input, and one hash for every broad phase and thread count.
#include "core/hash.h"
#include "core/log.h"
#include "core/simd.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DT (1.0f / 60.0f)

static phys_world *world;

// The Unity of some distributions has no float comparison: this one prints both numbers.
static void below(double limit, double value) {
    char text[64];
    snprintf(text, sizeof text, "%g is not below %g", value, limit);
    TEST_ASSERT_TRUE_MESSAGE(value < limit, text);
}

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
    TEST_ASSERT_NOT_NULL(world);
}
void tearDown(void) { phys_world_destroy(world); }

static phys_body add_sphere(phys_world *w, float x, float y, float z, float r) {
    phys_body_desc d = phys_body_desc_default();
    d.position = core_v3(x, y, z);
    phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
    s.radius = r;
    return phys_body_create(w, &d, &s, 1);
}
static phys_body add_box(phys_world *w, phys_body_type type, core_vec3 at, core_vec3 half) {
    phys_body_desc d = phys_body_desc_default();
    d.type = type;
    d.position = at;
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = half;
    return phys_body_create(w, &d, &s, 1);
}
static void add_floor(phys_world *w) {
    add_box(w, PHYS_STATIC, core_v3(0, -1, 0), core_v3(50, 1, 50));
}
static void run(phys_world *w, int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(w, DT));
    }
}
static core_vec3 at(phys_world *w, phys_body b) {
    core_vec3 p = {0, 0, 0};
    TEST_ASSERT_TRUE(phys_body_position(w, b, &p));
    return p;
}
static core_vec3 speed(phys_world *w, phys_body b) {
    core_vec3 p = {0, 0, 0};
    TEST_ASSERT_TRUE(phys_body_velocity(w, b, &p));
    return p;
}
static uint64_t state_hash(phys_world *w) {
    const core_columns *set[16];
    int n = phys_world_state(w, set, 16);
    uint64_t h = 0, column[CORE_COLUMNS_MAX];
    for (int i = 0; i < n; i++) {
        core_columns_hash(set[i], column);
        for (uint32_t k = 0; k < set[i]->column_count; k++) {
            h = core_hash_mix(h, column[k]);
        }
    }
    return h;
}

static void test_thrown_ball_follows_the_parabola(void) {
    phys_body b = add_sphere(world, 0, 0, 0, 0.1f);
    phys_body_set_velocity(world, b, core_v3(10, 20, 0));
    double worst = 0;
    for (int i = 1; i <= 300; i++) {
        run(world, 1);
        double t = i / 60.0, dx = at(world, b).x - 10 * t;
        double dy = at(world, b).y - (20 * t - 0.5 * 9.81 * t * t);
        worst = fmax(worst, sqrt(dx * dx + dy * dy));
    }
    below(0.001, worst);
}

static void test_spinning_brick_keeps_energy_and_momentum(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_body b = add_box(world, PHYS_DYNAMIC, core_v3(0, 0, 0), core_v3(0.5f, 0.3f, 0.1f));
    phys_body_set_angular_velocity(world, b, core_v3(0.01f, 5, 0.01f));
    phys_accuracy first, now;
    phys_world_accuracy(world, &first);
    int flips = 0;
    float sign = 1;
    for (int i = 0; i < 3600; i++) {
        run(world, 1);
        core_vec3 w;
        core_quat q;
        phys_body_angular_velocity(world, b, &w);
        phys_body_rotation(world, b, &q);
        if (core_quat_unrotate(q, w).y * sign < -0.5f) {
            flips++;
            sign = -sign;
        }
    }
    phys_world_accuracy(world, &now);
    TEST_ASSERT_DOUBLE_WITHIN(0.001 * first.energy_j, first.energy_j, now.energy_j);
    // The start lies 4e-6 from the separatrix, so that rounding decides each flip's time.
    TEST_ASSERT_INT_WITHIN(6, 12, flips);
}

static void test_ball_rests_on_box_and_plane(void) {
    add_floor(world);
    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    d.position = core_v3(100, 0, 0);
    phys_shape_desc plane = phys_shape_desc_default(PHYS_PLANE);
    TEST_ASSERT_TRUE(phys_body_alive(world, phys_body_create(world, &d, &plane, 1)));
    phys_body a = add_sphere(world, 0, 2, 0, 0.5f), b = add_sphere(world, 100, 2, 0, 0.5f);
    phys_body c = add_box(world, PHYS_DYNAMIC, core_v3(103, 2, 0), core_v3(0.5f, 0.25f, 0.5f));
    run(world, 240);
    TEST_ASSERT_FLOAT_WITHIN(0.001f, 0.5f, at(world, a).y);
    TEST_ASSERT_FLOAT_WITHIN(0.001f, 0.5f, at(world, b).y);
    TEST_ASSERT_FLOAT_WITHIN(0.001f, 0.25f, at(world, c).y);
    below(0.001f, core_v3_length(speed(world, a)));
    below(0.001f, core_v3_length(speed(world, c)));
}

static void test_stack_of_ten_stands(void) {
    add_floor(world);
    phys_body top = CORE_NULL_HANDLE;
    for (int i = 0; i < 10; i++) {
        top =
            add_box(world, PHYS_DYNAMIC, core_v3(0, 0.5f + (float)i, 0), core_v3(0.5f, 0.5f, 0.5f));
    }
    run(world, 300);
    core_vec3 p = at(world, top);
    below(0.01f, core_v3_length(speed(world, top)));
    below(0.003f, core_absf(p.x) + core_absf(p.z));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 9.5f, p.y);
}

static void test_elastic_pair_exchanges_velocity(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_body_desc d = phys_body_desc_default();
    phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
    s.radius = 0.5f;
    s.restitution = 1.0f;
    s.friction = 0.0f;
    d.velocity = core_v3(4, 0, 0);
    phys_body a = phys_body_create(world, &d, &s, 1);
    d.velocity = core_v3(0, 0, 0);
    d.position = core_v3(3, 0, 0);
    phys_body b = phys_body_create(world, &d, &s, 1);
    run(world, 60);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.0f, speed(world, a).x);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 4.0f, speed(world, b).x);
}

static void slope(float degrees, float *moved) {
    phys_world_desc d = phys_world_desc_default();
    float s = sinf(degrees * CORE_PI_F / 180), c = cosf(degrees * CORE_PI_F / 180);
    d.gravity = core_v3(9.81f * s, -9.81f * c, 0);
    phys_world *w = phys_world_create(&d);
    add_box(w, PHYS_STATIC, core_v3(0, -1, 0), core_v3(400, 1, 400));
    phys_body b = add_box(w, PHYS_DYNAMIC, core_v3(0, 0.25f, 0), core_v3(0.5f, 0.25f, 0.5f));
    run(w, 300);
    *moved = at(w, b).x;
    phys_world_destroy(w);
}

static void test_block_slides_only_beyond_the_friction_angle(void) {
    float still, slid;
    slope(26.0f, &still); // the limit for 0.5 is 26.565 degrees
    slope(30.0f, &slid);
    double a = 9.81 * (sin(CORE_PI / 6) - 0.5 * cos(CORE_PI / 6));
    below(0.002f, still);
    TEST_ASSERT_FLOAT_WITHIN((float)(0.02 * 12.5 * a), (float)(12.5 * a), slid);
}

static float random_at(uint64_t *seed, float a) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (2.0f * (float)(*seed >> 40) / 16777216.0f - 1.0f) * a;
}

static phys_world *pile(const char *broad, core_jobs *jobs, int n) {
    phys_world_desc d = phys_world_desc_default();
    d.broad = broad;
    d.jobs = jobs;
    phys_world *w = phys_world_create(&d);
    add_floor(w);
    uint64_t seed = 3;
    for (int i = 0; i < n; i++) {
        float x = random_at(&seed, 2), z = random_at(&seed, 2), y = 1 + 0.6f * (float)i / 4;
        if (i & 1) {
            add_box(w, PHYS_DYNAMIC, core_v3(x, y, z), core_v3(0.3f, 0.4f, 0.25f));
        } else {
            add_sphere(w, x, y, z, 0.35f);
        }
    }
    return w;
}

static void compare(const char *solver, phys_world *a, phys_world *b) {
    phys_world_set(a, "solver", solver);
    phys_world_set(b, "solver", solver);
    for (int i = 0; i < 120; i++) {
        run(a, 1);
        run(b, 1);
        TEST_ASSERT_EQUAL_HEX64(state_hash(a), state_hash(b));
    }
    phys_accuracy acc;
    phys_world_accuracy(a, &acc);
    TEST_ASSERT_EQUAL_UINT32(0, acc.nan);
    below(strcmp(solver, "impulse") == 0 ? 0.6 : 0.1, acc.penetration_max_m); // still falling
    phys_world_destroy(a);
    phys_world_destroy(b);
}

static void test_one_hash_for_broad_phases_and_threads(void) {
    core_jobs *two = core_jobs_create(2);
    const char *const *solver = phys_method_names("solver");
    for (int i = 0; solver[i] != NULL; i++) {
        compare(solver[i], pile("tree", NULL, 60), pile("brute", NULL, 60));
        compare(solver[i], pile("sap", NULL, 60), pile("brute", NULL, 60));
        compare(solver[i], pile("tree", NULL, 60), pile("tree", two, 60));
    }
    core_jobs_destroy(two);
}

static void test_one_hash_for_instruction_sets(void) {
    uint64_t first = 0;
    core_simd_set active = core_simd_active();
    for (core_simd_set set = CORE_SIMD_SSE2; set <= core_simd_best(); set++) {
        TEST_ASSERT_TRUE(core_simd_use(set));
        phys_world *w = pile("auto", NULL, 150);
        run(w, 90);
        uint64_t h = state_hash(w);
        first = set == CORE_SIMD_SSE2 ? h : first;
        TEST_ASSERT_EQUAL_HEX64(first, h);
        phys_world_destroy(w);
    }
    core_simd_use(active);
}

static void test_no_allocation_after_warm_up(void) {
    phys_world *w = pile("auto", NULL, 120);
    run(w, 120);
    uint64_t before = core_alloc_count();
    run(w, 60);
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
    phys_world_destroy(w);
}

static void test_handles_and_removal(void) {
    phys_body a = add_sphere(world, 0, 5, 0, 0.5f), b = add_sphere(world, 0.2f, 6, 0, 0.5f);
    add_floor(world);
    run(world, 60);
    TEST_ASSERT_TRUE(phys_body_destroy(world, a));
    TEST_ASSERT_FALSE(phys_body_alive(world, a));
    core_vec3 p;
    TEST_ASSERT_FALSE(phys_body_position(world, a, &p));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "stale"));
    TEST_ASSERT_FALSE(phys_body_destroy(world, a));
    run(world, 120);
    TEST_ASSERT_FLOAT_WITHIN(0.001f, 0.5f, at(world, b).y);
    TEST_ASSERT_EQUAL_UINT32(2, phys_body_count(world));
}

static void refused(phys_shape_desc s, const char *word) {
    phys_body_desc d = phys_body_desc_default();
    TEST_ASSERT_TRUE(core_handle_is_null(phys_body_create(world, &d, &s, 1)));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), word), core_last_error());
    TEST_ASSERT_EQUAL_UINT32(0, phys_body_count(world));
}

static void test_bad_input_is_named(void) {
    const float bad[] = {0.0f, -1.0f, NAN, INFINITY};
    for (size_t i = 0; i < CORE_COUNT_OF(bad); i++) {
        phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
        s.radius = bad[i];
        refused(s, "radius");
        s = phys_shape_desc_default(PHYS_BOX);
        s.half = core_v3(1, bad[i], 1);
        refused(s, "half.y");
        TEST_ASSERT_FALSE(phys_world_step(world, bad[i]));
    }
    phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
    s.radius = 1;
    s.density = NAN;
    refused(s, "density");
    s.density = 0;
    s.cookie = 0;
    refused(s, "phys_shape_desc_default");
    TEST_ASSERT_FALSE(phys_world_set(world, "sover", "soft"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "solver"));
    TEST_ASSERT_FALSE(phys_world_set(world, "substeps", "two"));
}

int main(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    UNITY_BEGIN();
    RUN_TEST(test_thrown_ball_follows_the_parabola);
    RUN_TEST(test_spinning_brick_keeps_energy_and_momentum);
    RUN_TEST(test_ball_rests_on_box_and_plane);
    RUN_TEST(test_stack_of_ten_stands);
    RUN_TEST(test_elastic_pair_exchanges_velocity);
    RUN_TEST(test_block_slides_only_beyond_the_friction_angle);
    RUN_TEST(test_one_hash_for_broad_phases_and_threads);
    RUN_TEST(test_one_hash_for_instruction_sets);
    RUN_TEST(test_no_allocation_after_warm_up);
    RUN_TEST(test_handles_and_removal);
    RUN_TEST(test_bad_input_is_named);
    return UNITY_END();
}
