// Rays, casts, overlaps and closest points against closed forms and against a search of everything;
// snapshots that step on with the same bits; locks, kinematic bodies and the choice of integrators.
#include "core/hash.h"
#include "core/log.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static phys_body add(phys_shape_type type, phys_body_type body, core_vec3 at, float size,
                     uint32_t layer, uint32_t locks) {
    phys_body_desc d = phys_body_desc_default();
    d.type = body;
    d.position = at;
    d.layer = layer;
    d.locks = locks;
    phys_shape_desc s = phys_shape_desc_default(type);
    s.radius = s.half_height = size;
    s.half = core_v3(size, size, size);
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
static uint64_t state_hash(void) {
    const core_columns *set[16];
    uint64_t h = 0, column[CORE_COLUMNS_MAX];
    int n = phys_world_state(world, set, 16);
    for (int i = 0; i < n; i++) {
        core_columns_hash(set[i], column);
        for (uint32_t k = 0; k < set[i]->column_count; k++) {
            h = core_hash_mix(h, column[k]);
        }
    }
    return h;
}

static void test_ray_finds_the_nearest(void) {
    phys_body a = add(PHYS_SPHERE, PHYS_STATIC, core_v3(5, 0, 0), 1, 1, 0);
    phys_body b = add(PHYS_BOX, PHYS_STATIC, core_v3(9, 0, 0), 1, 2, 0);
    phys_hit h;
    TEST_ASSERT_TRUE(phys_world_ray(world, core_v3(0, 0, 0), core_v3(20, 0, 0), NULL, &h));
    TEST_ASSERT_TRUE(core_handle_equal(a, h.body));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.2f, h.fraction);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -1.0f, h.normal.x);
    phys_filter f = phys_filter_default();
    f.layers = 1u << 2;
    TEST_ASSERT_TRUE(phys_world_ray(world, core_v3(0, 0, 0), core_v3(20, 0, 0), &f, &h));
    TEST_ASSERT_TRUE(core_handle_equal(b, h.body));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 8.0f, h.point.x);
    f.skip = b;
    TEST_ASSERT_FALSE(phys_world_ray(world, core_v3(0, 0, 0), core_v3(20, 0, 0), &f, &h));
    TEST_ASSERT_FALSE(phys_world_ray(world, core_v3(NAN, 0, 0), core_v3(1, 0, 0), NULL, &h));
}

static void test_trees_answer_as_a_search_of_everything(void) {
    uint64_t seed = 7;
    float r[6];
    for (int i = 0; i < 300; i++) {
        for (int k = 0; k < 3; k++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            r[k] = (float)(seed >> 40) / 16777216.0f * 40 - 20;
        }
        add(i % 3 ? PHYS_SPHERE : PHYS_CAPSULE, i % 2 ? PHYS_STATIC : PHYS_DYNAMIC,
            core_v3(r[0], r[1], r[2]), 0.6f, 0, 0);
    }
    run(3);
    for (int i = 0; i < 200; i++) {
        for (int k = 0; k < 6; k++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            r[k] = (float)(seed >> 40) / 16777216.0f * 50 - 25;
        }
        phys_hit tree, all;
        core_vec3 from = {r[0], r[1], r[2]}, way = {r[3], r[4], r[5]};
        phys_shape_desc probe = phys_shape_desc_default(PHYS_SPHERE);
        probe.radius = 2.0f;
        phys_body in_tree[64], in_all[64];
        phys_world_set(world, "broad", "tree");
        run(1);
        phys_world_ray(world, from, way, NULL, &tree);
        uint32_t n =
            phys_world_overlap(world, &probe, from, core_quat_identity(), NULL, in_tree, 64);
        phys_world_set(world, "broad", "brute");
        phys_world_ray(world, from, way, NULL, &all);
        uint32_t m =
            phys_world_overlap(world, &probe, from, core_quat_identity(), NULL, in_all, 64);
        TEST_ASSERT_EQUAL_INT(all.hit, tree.hit);
        TEST_ASSERT_EQUAL_MEMORY(&all.body, &tree.body, sizeof all.body);
        TEST_ASSERT_EQUAL_UINT32(m, n);
        TEST_ASSERT_TRUE(n == 0 || memcmp(in_tree, in_all, n * sizeof *in_all) == 0);
    }
}

static void test_cast_and_closest(void) {
    phys_body wall = add(PHYS_BOX, PHYS_STATIC, core_v3(6, 0, 0), 1, 0, 0);
    phys_shape_desc ball = phys_shape_desc_default(PHYS_SPHERE);
    ball.radius = 0.5f;
    phys_hit h;
    TEST_ASSERT_TRUE(phys_world_cast(world, &ball, core_v3(0, 0, 0), core_quat_identity(),
                                     core_v3(10, 0, 0), NULL, &h));
    TEST_ASSERT_TRUE(core_handle_equal(wall, h.body));
    TEST_ASSERT_FLOAT_WITHIN(2e-4f, 0.45f, h.fraction); // 5 - 0.5 of 10 m
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -1.0f, h.normal.x);
    TEST_ASSERT_FALSE(phys_world_cast(world, &ball, core_v3(0, 1.51f, 0), core_quat_identity(),
                                      core_v3(10, 0, 0), NULL, &h));
    TEST_ASSERT_TRUE(phys_world_closest(world, core_v3(2, 0.5f, 0), 4, NULL, &h));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 3.0f, h.fraction);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 5.0f, h.point.x);
    TEST_ASSERT_FALSE(phys_world_closest(world, core_v3(2, 0, 0), 2.9f, NULL, &h));
}

static void test_snapshot_steps_on_with_the_same_bits(void) {
    add(PHYS_BOX, PHYS_STATIC, core_v3(0, -10, 0), 10, 0, 0);
    for (int i = 0; i < 40; i++) {
        add(i % 2 ? PHYS_BOX : PHYS_SPHERE, PHYS_DYNAMIC,
            core_v3(0.1f * (float)(i % 5), 1 + 0.9f * (float)i, 0.07f * (float)(i % 3)), 0.4f, 0,
            0);
    }
    run(60);
    size_t size = phys_world_save_size(world);
    void *data = malloc(size);
    phys_world_save(world, data);
    uint64_t before = state_hash();
    phys_body extra = add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(0, 3, 0), 0.3f, 0, 0);
    run(60);
    TEST_ASSERT_TRUE(phys_world_restore(world, data, size));
    TEST_ASSERT_FALSE(phys_body_alive(world, extra));
    TEST_ASSERT_EQUAL_HEX64(before, state_hash());
    run(60);
    uint64_t first = state_hash();
    TEST_ASSERT_TRUE(phys_world_restore(world, data, size));
    run(60);
    TEST_ASSERT_EQUAL_HEX64(first, state_hash());
    TEST_ASSERT_FALSE(phys_world_restore(world, data, size - 8));
    memset(data, 0, 4);
    TEST_ASSERT_FALSE(phys_world_restore(world, data, size));
    free(data);
}

static void test_locks_hold_exactly(void) {
    add(PHYS_BOX, PHYS_STATIC, core_v3(0, -10, 0), 10, 0, 0);
    phys_body slide =
        add(PHYS_BOX, PHYS_DYNAMIC, core_v3(0, 0.6f, 0), 0.5f, 0, PHYS_LOCK_Z | PHYS_LOCK_TURN);
    phys_body hung = add(PHYS_BOX, PHYS_DYNAMIC, core_v3(5, 3, 0), 0.5f, 0, PHYS_LOCK_Y);
    add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(0.3f, 3, 0.2f), 0.4f, 0, 0);
    add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(5.3f, 6, 0.2f), 0.4f, 0, 0);
    run(180);
    core_quat q;
    phys_body_rotation(world, slide, &q);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, at(slide).z);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, q.w);
    TEST_ASSERT_EQUAL_FLOAT(3.0f, at(hung).y);
}

static void test_kinematic_carries_and_is_not_pushed(void) {
    phys_body lift = add(PHYS_BOX, PHYS_KINEMATIC, core_v3(0, 0, 0), 1, 0, 0);
    phys_body box = add(PHYS_BOX, PHYS_DYNAMIC, core_v3(0, 1.5f, 0), 0.5f, 0, 0);
    run(30);
    phys_body_set_velocity(world, lift, core_v3(0.5f, 1, 0));
    run(120);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 2.0f, at(lift).y);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 3.5f, at(box).y);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 1.0f, at(box).x);
}

// Each method at its order: a ball thrown under constant gravity with drag.
static void test_integrators_are_chosen_by_name(void) {
    static const struct {
        const char *name;
        double least, most; // error in metres after 2 s, 8 substeps of 1/60 s
    } method[] = {{"euler", 1e-3, 0.1}, {"semi", 1e-3, 0.1}, {"verlet", 0, 1e-3}, {"rk4", 0, 1e-3}};
    for (size_t i = 0; i < CORE_COUNT_OF(method); i++) {
        tearDown();
        setUp();
        TEST_ASSERT_TRUE(phys_world_set(world, "integrator", method[i].name));
        phys_body_desc d = phys_body_desc_default();
        d.velocity = core_v3(10, 10, 0);
        d.linear_damping = 0.5f;
        phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
        s.radius = 0.1f;
        phys_body b = phys_body_create(world, &d, &s, 1);
        run(120);
        double c = 0.5, t = 2.0, e = 1 - exp(-c * t), x = 10 / c * e;
        double y = (10 + 9.81 / c) / c * e - 9.81 / c * t;
        double error = hypot(at(b).x - x, at(b).y - y);
        TEST_ASSERT_TRUE_MESSAGE(error >= method[i].least && error < method[i].most,
                                 method[i].name);
    }
    TEST_ASSERT_FALSE(phys_world_set(world, "integrator", "rk5"));
}

// A spring of 1 Hz to the origin that blows ever stronger: its own closed form.
static core_vec3 spring(void *ctx, core_vec3 p, core_vec3 v, float t) {
    (void)v;
    const float *push = ctx;
    return core_v3_add(core_v3_scale(p, -39.4784176f), core_v3(*push * t, 0, 0));
}

// auto: the exact term for a thrown ball, Runge-Kutta under a force of place and time; both at
// once, and a ball at rest on the ground is left to the solver.
static void test_auto_takes_what_the_body_needs(void) {
    TEST_ASSERT_TRUE(phys_world_set(world, "integrator", "auto"));
    phys_body thrown = add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(0, 0, 9), 0.1f, 0, 0);
    phys_body_set_velocity(world, thrown, core_v3(3, 8, 0));
    run(120);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 6.0f, at(thrown).x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 16.0f - 0.5f * 9.81f * 4.0f, at(thrown).y);

    tearDown();
    setUp();
    phys_world_set(world, "integrator", "auto");
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    float push = 3.0f;
    phys_world_set_force(world, spring, &push);
    phys_body swung = add(PHYS_SPHERE, PHYS_DYNAMIC, core_v3(0, 1, 0), 0.1f, 0, 0);
    run(90);
    // x'' = -k x + 3 t from rest: x = 3/k (t - sin(w t) / w); y = cos(w t). w = 2 pi, t = 1.5.
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 3.0f / 39.4784176f * 1.5f, at(swung).x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -1.0f, at(swung).y);
    phys_world_set_force(world, NULL, NULL);
    core_vec3 before = at(swung), v;
    phys_body_velocity(world, swung, &v);
    run(60);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, before.x + v.x, at(swung).x); // set free
}

int main(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    UNITY_BEGIN();
    RUN_TEST(test_ray_finds_the_nearest);
    RUN_TEST(test_trees_answer_as_a_search_of_everything);
    RUN_TEST(test_cast_and_closest);
    RUN_TEST(test_snapshot_steps_on_with_the_same_bits);
    RUN_TEST(test_locks_hold_exactly);
    RUN_TEST(test_kinematic_carries_and_is_not_pushed);
    RUN_TEST(test_integrators_are_chosen_by_name);
    RUN_TEST(test_auto_takes_what_the_body_needs);
    return UNITY_END();
}
