// Closest points: the answer lies in the set, and no sampled point of the set is nearer.
#include "phys/geom.h"

#include "geom_random.h"
#include "unity.h"

#define TRIALS  2000
#define SAMPLES 40

void setUp(void) { random_seed(77); }
void tearDown(void) {}

static core_vec3 lerp(core_vec3 a, core_vec3 b, float t) {
    return core_v3_mad(a, core_v3_sub(b, a), t);
}

static void test_point_on_line(void) {
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 p = random_vec(3), a = random_vec(2), b = random_vec(2);
        for (int segment = 0; segment < 2; segment++) {
            core_vec3 c = phys_geom_closest_point_line(p, a, b, segment);
            TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0,
                                     distance(c, phys_geom_closest_point_line(c, a, b, segment)));
            for (int k = 0; k <= SAMPLES; k++) {
                float t = (float)k / SAMPLES * (segment ? 1 : 20) - (segment ? 0 : 10);
                TEST_ASSERT_TRUE(distance(p, c) <= distance(p, lerp(a, b, t)) + 1e-5f);
            }
        }
    }
    core_vec3 one = {1, 2, 3};
    TEST_ASSERT_EQUAL_FLOAT(2, phys_geom_closest_point_line(core_v3(9, 9, 9), one, one, true).y);
}

static void test_lines(void) {
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 a0 = random_vec(2), a1 = random_vec(2), b0 = random_vec(2), b1 = random_vec(2);
        if (i % 5 == 0) { // parallel
            b1 = core_v3_mad(b0, core_v3_sub(a1, a0), random_sym(2));
        }
        if (i % 7 == 0) { // a point
            b1 = b0;
        }
        phys_geom_closest c = phys_geom_closest_points_lines(a0, a1, true, b0, b1, true);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, c.distance, distance(c.a, c.b));
        float best = 1e9f;
        for (int k = 0; k <= SAMPLES; k++) {
            core_vec3 q = lerp(a0, a1, (float)k / SAMPLES);
            core_vec3 r = phys_geom_closest_point_line(q, b0, b1, true);
            best = CORE_MIN(best, distance(q, r));
        }
        TEST_ASSERT_TRUE(c.distance <= best + 1e-5f);
        TEST_ASSERT_FLOAT_WITHIN(0.12f, best, c.distance);
        phys_geom_closest l = phys_geom_closest_points_lines(a0, a1, false, b0, b1, false);
        TEST_ASSERT_TRUE(l.distance <= c.distance + 1e-4f);
    }
    phys_geom_closest skew = phys_geom_closest_points_lines(
        core_v3(0, 0, 0), core_v3(1, 0, 0), false, core_v3(5, 3, -4), core_v3(5, 3, 4), false);
    TEST_ASSERT_EQUAL_FLOAT(3, skew.distance);
    TEST_ASSERT_EQUAL_FLOAT(5, skew.a.x);
}

static core_vec3 sample_triangle(const core_vec3 t[3], int i, int j) {
    float u = (float)i / SAMPLES, v = (1 - u) * (float)j / SAMPLES;
    return core_v3_mad(core_v3_mad(t[0], core_v3_sub(t[1], t[0]), u), core_v3_sub(t[2], t[0]), v);
}

static void test_point_on_triangle(void) {
    for (int i = 0; i < TRIALS / 4; i++) {
        core_vec3 t[3] = {random_vec(1), random_vec(1), random_vec(1)}, p = random_vec(2);
        core_vec3 c = phys_geom_closest_point_triangle(p, t[0], t[1], t[2]);
        float w[3];
        if (phys_geom_barycentric(c, t, w)) {
            TEST_ASSERT_TRUE(w[0] > -1e-3f && w[1] > -1e-3f && w[2] > -1e-3f);
            TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, w[0] + w[1] + w[2]);
        }
        for (int a = 0; a <= SAMPLES; a++) {
            for (int b = 0; b <= SAMPLES; b += 4) {
                TEST_ASSERT_TRUE(distance(p, c) <= distance(p, sample_triangle(t, a, b)) + 1e-5f);
            }
        }
    }
    core_vec3 d = {1, 1, 1}; // no area: still the point
    TEST_ASSERT_EQUAL_FLOAT(1, phys_geom_closest_point_triangle(core_v3(0, 0, 0), d, d, d).x);
}

static void test_line_and_triangle(void) {
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 t[3] = {random_vec(1), random_vec(1), random_vec(1)};
        core_vec3 a = random_vec(2), b = random_vec(2);
        phys_geom_closest c = phys_geom_closest_points_line_triangle(a, b, true, t);
        core_vec3 on_a = phys_geom_closest_point_line(c.a, a, b, true);
        core_vec3 on_t = phys_geom_closest_point_triangle(c.b, t[0], t[1], t[2]);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, distance(c.a, on_a));
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, distance(c.b, on_t));
        for (int k = 0; k <= SAMPLES; k++) {
            core_vec3 q = lerp(a, b, (float)k / SAMPLES);
            core_vec3 r = phys_geom_closest_point_triangle(q, t[0], t[1], t[2]);
            TEST_ASSERT_TRUE(c.distance <= distance(q, r) + 1e-5f);
        }
        phys_geom_closest l = phys_geom_closest_points_line_triangle(a, b, false, t);
        TEST_ASSERT_TRUE(l.distance <= c.distance + 1e-5f);
    }
}

static void test_polygon_and_plane(void) {
    core_vec3 hexagon[6];
    for (int i = 0; i < 6; i++) {
        hexagon[i] =
            core_v3(core_cosf((float)i * CORE_PI_F / 3), 0, core_sinf((float)i * CORE_PI_F / 3));
    }
    core_vec3 above = phys_geom_closest_point_polygon(core_v3(0.2f, 3, 0.1f), hexagon, 6);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, distance(above, core_v3(0.2f, 0, 0.1f)));
    core_vec3 corner = phys_geom_closest_point_polygon(core_v3(5, 1, 0), hexagon, 6);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, distance(corner, core_v3(1, 0, 0)));
    core_vec3 n = core_v3_normalize(core_v3(1, 2, -2), core_v3(0, 1, 0));
    for (int i = 0; i < 100; i++) {
        core_vec3 p = random_vec(10), c = phys_geom_closest_point_plane(p, n, 1.5f);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1.5f, core_v3_dot(n, c));
        TEST_ASSERT_FLOAT_WITHIN(2e-5f, core_v3_length(core_v3_sub(p, c)),
                                 core_absf(core_v3_dot(n, p) - 1.5f));
    }
}

static bool in_half_spaces(core_vec3 p, const core_vec3 t[4], float slack) {
    static const int f[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    for (int i = 0; i < 4; i++) {
        core_vec3 n =
            core_v3_cross(core_v3_sub(t[f[i][1]], t[f[i][0]]), core_v3_sub(t[f[i][2]], t[f[i][0]]));
        n = core_v3_normalize(n, core_v3(0, 1, 0));
        float inner = core_v3_dot(n, core_v3_sub(t[f[i][3]], t[f[i][0]]));
        float side = core_v3_dot(n, core_v3_sub(p, t[f[i][0]]));
        if (inner > 0 ? side < -slack : side > slack) {
            return false;
        }
    }
    return true;
}

static void test_tetrahedron(void) {
    int inside = 0;
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 t[4] = {random_vec(1), random_vec(1), random_vec(1), random_vec(1)};
        core_vec3 p = random_vec(0.6f), c = phys_geom_closest_point_tetrahedron(p, t);
        bool in = phys_geom_point_in_tetrahedron(p, t, 0);
        inside += in;
        if (in_half_spaces(p, t, -1e-5f)) {
            TEST_ASSERT_TRUE(in);
        }
        if (!in_half_spaces(p, t, 1e-5f)) {
            TEST_ASSERT_FALSE(in);
        }
        TEST_ASSERT_EQUAL(in, phys_geom_point_in_convex(p, t, 4, 0) && in);
        core_vec3 q = phys_geom_closest_point_convex(p, t, 4);
        TEST_ASSERT_FLOAT_WITHIN(2e-5f, distance(p, c), distance(p, q));
        core_vec3 a = random_vec(2), b = random_vec(2);
        phys_geom_closest lt = phys_geom_closest_points_line_tetrahedron(a, b, true, t);
        phys_geom_closest lc = phys_geom_closest_points_line_convex(a, b, true, t, 4);
        TEST_ASSERT_FLOAT_WITHIN(2e-5f, lt.distance, lc.distance);
        lt = phys_geom_closest_points_line_tetrahedron(a, b, false, t);
        lc = phys_geom_closest_points_line_convex(a, b, false, t, 4);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, lt.distance, lc.distance);
    }
    TEST_ASSERT_TRUE(inside > 50);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_point_on_line);
    RUN_TEST(test_lines);
    RUN_TEST(test_point_on_triangle);
    RUN_TEST(test_line_and_triangle);
    RUN_TEST(test_polygon_and_plane);
    RUN_TEST(test_tetrahedron);
    return UNITY_END();
}
