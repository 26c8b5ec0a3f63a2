// Rotations and matrices against the same formulas in double, and the conventions that others
// build on: order of products, short way, reversed depth.
#include "core/math.h"

#include <math.h>

#include "core/rng.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static float spread(core_rng *rng) { return 2.0f * core_rng_float(rng) - 1.0f; }
static core_vec3 any_vec(core_rng *rng) {
    return (core_vec3){spread(rng), spread(rng), spread(rng)};
}
static core_quat any_quat(core_rng *rng) {
    core_quat q = {spread(rng), spread(rng), spread(rng), spread(rng)};
    return core_quat_normalize(q);
}
static void near_vec(core_vec3 expected, core_vec3 got, float tolerance) {
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected.x, got.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected.y, got.y);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected.z, got.z);
}
static void near_quat(core_quat expected, core_quat got, float tolerance) {
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected.x, got.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected.y, got.y);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected.z, got.z);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected.w, got.w);
}

static void normalize_vectors(void) {
    const core_vec3 fallback = {0, 1, 0};
    near_vec((core_vec3){0.6f, 0, 0.8f}, core_v3_normalize((core_vec3){3, 0, 4}, fallback), 1e-7f);
    near_vec((core_vec3){0.6f, 0, 0.8f},
             core_v3_normalize((core_vec3){1.5e38f, 0, 2e38f}, fallback), 1e-7f);
    near_vec((core_vec3){1, 0, 0}, core_v3_normalize((core_vec3){1e-44f, 0, 0}, fallback), 0.0f);
    near_vec((core_vec3){0, 0, -1}, core_v3_normalize((core_vec3){0, 0, -3e38f}, fallback), 0.0f);
    near_vec(fallback, core_v3_normalize((core_vec3){0, 0, 0}, fallback), 0.0f);
    near_vec(fallback, core_v3_normalize((core_vec3){NAN, 1, 0}, fallback), 0.0f);
    near_vec(fallback, core_v3_normalize((core_vec3){INFINITY, 1, 0}, fallback), 0.0f);
}

// Rodrigues' formula in double.
static void rotation_about_an_axis(void) {
    core_rng rng = core_rng_make(21, 1);
    for (int i = 0; i < 5000; i++) {
        core_vec3 axis = core_v3_normalize(any_vec(&rng), (core_vec3){1, 0, 0}), v = any_vec(&rng);
        float angle = 12.0f * spread(&rng);
        core_vec3 got = core_quat_rotate(core_quat_axis_angle(axis, angle), v);
        double c = cos((double)angle), s = sin((double)angle);
        double dot = (double)axis.x * v.x + (double)axis.y * v.y + (double)axis.z * v.z;
        core_vec3 cross = core_v3_cross(axis, v);
        core_vec3 expected = {(float)(v.x * c + cross.x * s + axis.x * dot * (1 - c)),
                              (float)(v.y * c + cross.y * s + axis.y * dot * (1 - c)),
                              (float)(v.z * c + cross.z * s + axis.z * dot * (1 - c))};
        near_vec(expected, got, 2e-6f);
        near_vec(v, core_quat_unrotate(core_quat_axis_angle(axis, angle), got), 2e-6f);
    }
}

static void products_rotate_right_first(void) {
    core_rng rng = core_rng_make(22, 1);
    for (int i = 0; i < 1000; i++) {
        core_quat a = any_quat(&rng), b = any_quat(&rng);
        core_vec3 v = any_vec(&rng);
        core_vec3 one_by_one = core_quat_rotate(a, core_quat_rotate(b, v));
        near_vec(one_by_one, core_quat_rotate(core_quat_mul(a, b), v), 1e-6f);
        near_quat(core_quat_identity(), core_quat_mul(a, core_quat_conjugate(a)), 1e-6f);
    }
    core_vec3 y = core_quat_rotate(core_quat_axis_angle((core_vec3){0, 0, 1}, CORE_PI_F / 2),
                                   (core_vec3){1, 0, 0});
    near_vec((core_vec3){0, 1, 0}, y, 1e-6f); // counter-clockwise about +Z
}

static void zero_means_identity(void) {
    core_rng rng = core_rng_make(23, 1);
    core_quat zero = {0, 0, 0, 0}, q = any_quat(&rng);
    core_vec3 v = {1, 2, 3};
    near_vec(v, core_quat_rotate(zero, v), 0.0f);
    near_quat(q, core_quat_mul(zero, q), 0.0f);
    near_quat(q, core_quat_mul(q, zero), 0.0f);
    near_quat(core_quat_identity(), core_quat_normalize(zero), 0.0f);
    near_quat(core_quat_identity(), core_quat_normalize((core_quat){NAN, 0, 0, 1}), 0.0f);
    near_quat(core_quat_identity(), core_quat_normalize((core_quat){0, INFINITY, 0, 1}), 0.0f);
    near_quat((core_quat){0, 0, 0, -1}, core_quat_normalize((core_quat){0, 0, 0, -1e-40f}), 0.0f);
    core_mat4 m = core_mat4_trs((core_vec3){0, 0, 0}, zero, (core_vec3){1, 1, 1});
    core_mat4 identity = core_mat4_identity();
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(identity.m, m.m, 16);
}

static void interpolation(void) {
    const core_vec3 z = {0, 0, 1};
    core_rng rng = core_rng_make(24, 1);
    for (int i = 0; i < 2000; i++) {
        float from = 3.0f * spread(&rng), turn = 3.1f * spread(&rng), t = core_rng_float(&rng);
        core_quat a = core_quat_axis_angle(z, from), b = core_quat_axis_angle(z, from + turn);
        core_quat expected = core_quat_axis_angle(z, from + t * turn);
        near_quat(expected, core_quat_slerp(a, b, t), 3e-6f);
        // -b is the same rotation: the way must stay the short one.
        core_quat minus = {-b.x, -b.y, -b.z, -b.w};
        near_quat(expected, core_quat_slerp(a, minus, t), 3e-6f);
        core_quat n = core_quat_nlerp(a, minus, t);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, n.x * n.x + n.y * n.y + n.z * n.z + n.w * n.w);
        near_quat(core_quat_slerp(a, b, 0.5f), core_quat_nlerp(a, b, 0.5f), 3e-6f);
    }
    core_quat q = any_quat(&rng);
    near_quat(q, core_quat_slerp(q, q, 0.3f), 1e-6f);
    near_quat(q, core_quat_nlerp(q, any_quat(&rng), 0.0f), 1e-6f);
}

static void matrix_of_a_transform(void) {
    core_rng rng = core_rng_make(25, 1);
    for (int i = 0; i < 1000; i++) {
        core_vec3 t = any_vec(&rng), s = any_vec(&rng), p = any_vec(&rng);
        core_quat r = any_quat(&rng);
        core_mat4 m = core_mat4_trs(t, r, s);
        core_vec3 scaled = {p.x * s.x, p.y * s.y, p.z * s.z};
        core_vec3 expected = core_v3_add(core_quat_rotate(r, scaled), t);
        near_vec(expected, core_mat4_point(&m, p), 2e-6f);
        core_mat4 other = core_mat4_trs(any_vec(&rng), any_quat(&rng), (core_vec3){1, 2, 0.5f});
        core_mat4 product = core_mat4_mul(&m, &other);
        near_vec(core_mat4_point(&m, core_mat4_point(&other, p)), core_mat4_point(&product, p),
                 1e-5f);
    }
}

static void inverse(void) {
    core_rng rng = core_rng_make(26, 1);
    for (int i = 0; i < 2000; i++) {
        core_mat4 m;
        for (int k = 0; k < 16; k++) {
            m.m[k] = spread(&rng) * (i & 1 ? 1.0f : 1e-9f);
        }
        core_mat4 inv;
        TEST_ASSERT_TRUE(core_mat4_inverse(&m, &inv));
        float size = 0.0f; // how much rounding of the inverse can matter
        for (int k = 0; k < 16; k++) {
            size = CORE_MAX(size, core_absf(inv.m[k] * (i & 1 ? 1.0f : 1e-9f)));
        }
        core_mat4 product = core_mat4_mul(&m, &inv), identity = core_mat4_identity();
        for (int k = 0; k < 16; k++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-6f * (1.0f + size), identity.m[k], product.m[k]);
        }
    }
    core_mat4 out = core_mat4_identity(),
              flat = core_mat4_trs((core_vec3){1, 2, 3}, any_quat(&rng), (core_vec3){1, 0, 1});
    TEST_ASSERT_FALSE(core_mat4_inverse(&flat, &out));
    core_mat4 twice = {{1, 2, 3, 4, 2, 4, 6, 8, 0, 1, 0, 5, 0.1f, 0.7f, 0.3f, 0.9f}};
    TEST_ASSERT_FALSE(core_mat4_inverse(&twice, &out));
    core_mat4 bad = core_mat4_identity();
    bad.m[5] = NAN;
    TEST_ASSERT_FALSE(core_mat4_inverse(&bad, &out));
    bad.m[5] = INFINITY;
    TEST_ASSERT_FALSE(core_mat4_inverse(&bad, &out));
}

static float depth_of(const core_mat4 *m, float z) {
    float clip_z = m->m[10] * z + m->m[14], clip_w = m->m[11] * z + m->m[15];
    return clip_z / clip_w;
}

static void reversed_depth(void) {
    core_mat4 p = core_mat4_perspective(1.0f, 16.0f / 9.0f, 0.1f);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, depth_of(&p, -0.1f));
    TEST_ASSERT_EQUAL_FLOAT(0.5f, depth_of(&p, -0.2f));
    TEST_ASSERT_EQUAL_FLOAT(1e-31f, depth_of(&p, -1e30f));
    TEST_ASSERT_TRUE(p.m[10] == 0.0f); // so that depth at infinity is 0 and not merely small
    // The upper edge of the view reaches +1, as does the right one.
    float edge = tanf(0.5f);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, p.m[5] * edge);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, p.m[0] * edge * (16.0f / 9.0f));
    core_mat4 o = core_mat4_ortho(-2, 6, -1, 3, 0.5f, 100.0f);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, depth_of(&o, -0.5f));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0f, depth_of(&o, -100.0f));
    near_vec((core_vec3){-1, -1, 1}, core_mat4_point(&o, (core_vec3){-2, -1, -0.5f}), 1e-6f);
    near_vec((core_vec3){1, 1, 0}, core_mat4_point(&o, (core_vec3){6, 3, -100}), 1e-6f);
}

static void looking(void) {
    core_vec3 eye = {1, 2, 3}, target = {4, 2, 3};
    core_mat4 v = core_mat4_look_at(eye, target, (core_vec3){0, 1, 0});
    near_vec((core_vec3){0, 0, 0}, core_mat4_point(&v, eye), 1e-6f);
    near_vec((core_vec3){0, 0, -3}, core_mat4_point(&v, target), 1e-6f);
    near_vec((core_vec3){0, 1, 0}, core_mat4_point(&v, (core_vec3){1, 3, 3}), 1e-6f);
    near_vec((core_vec3){1, 0, 0}, core_mat4_point(&v, (core_vec3){1, 2, 4}), 1e-6f);
    const core_vec3 ups[] = {{0, 1, 0}, {0, 0, 0}, {NAN, 0, 0}, {0, -5, 0}};
    for (int i = 0; i < 4; i++) { // straight up or down, any up direction: still a rotation
        core_mat4 m = core_mat4_look_at(eye, (core_vec3){1, i & 1 ? 9.0f : -9.0f, 3}, ups[i]);
        for (int a = 0; a < 3; a++) {
            for (int b = 0; b < 3; b++) {
                float dot = m.m[a] * m.m[b] + m.m[4 + a] * m.m[4 + b] + m.m[8 + a] * m.m[8 + b];
                TEST_ASSERT_FLOAT_WITHIN(1e-6f, a == b ? 1.0f : 0.0f, dot);
            }
        }
    }
    core_mat4 same = core_mat4_look_at(eye, eye, (core_vec3){0, 1, 0});
    near_vec((core_vec3){0, 0, 0}, core_mat4_point(&same, eye), 1e-6f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(normalize_vectors);
    RUN_TEST(rotation_about_an_axis);
    RUN_TEST(products_rotate_right_first);
    RUN_TEST(zero_means_identity);
    RUN_TEST(interpolation);
    RUN_TEST(matrix_of_a_transform);
    RUN_TEST(inverse);
    RUN_TEST(reversed_depth);
    RUN_TEST(looking);
    return UNITY_END();
}
