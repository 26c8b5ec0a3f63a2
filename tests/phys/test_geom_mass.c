// Bounds, volumes, inertia: closed forms against integration on a grid, rules (parallel axes, R I
// R^T).
#include "phys/geom.h"

#include "geom_random.h"
#include "unity.h"

void setUp(void) { random_seed(31); }
void tearDown(void) {}

#define GRID 100

typedef bool inside_fn(core_vec3 p, float h, float r);
static bool in_sphere(core_vec3 p, float h, float r) { return (void)h, core_v3_dot(p, p) <= r * r; }
static bool in_box(core_vec3 p, float h, float r) {
    return core_absf(p.x) <= r && core_absf(p.y) <= h && core_absf(p.z) <= 0.7f * r;
}
static bool in_cylinder(core_vec3 p, float h, float r) {
    return core_absf(p.y) <= h && p.x * p.x + p.z * p.z <= r * r;
}
static bool in_capsule(core_vec3 p, float h, float r) {
    p.y -= CORE_CLAMP(p.y, -h, h);
    return core_v3_dot(p, p) <= r * r;
}

// Over the box +-r, +-y, +-r in GRID^3 cells.
static double integrate(inside_fn *in, float h, float r, float y, phys_geom_inertia *out) {
    double n = 0, xx = 0, yy = 0, zz = 0;
    for (int i = 0; i < GRID * GRID * GRID; i++) {
        core_vec3 p = {((float)(i % GRID) + 0.5f) * (2 * r / GRID) - r,
                       ((float)(i / GRID % GRID) + 0.5f) * (2 * y / GRID) - y,
                       ((float)(i / GRID / GRID) + 0.5f) * (2 * r / GRID) - r};
        if (in(p, h, r)) {
            double px = (double)p.x, py = (double)p.y, pz = (double)p.z;
            n++, xx += py * py + pz * pz, yy += px * px + pz * pz, zz += px * px + py * py;
        }
    }
    *out = (phys_geom_inertia){(float)(xx / n), (float)(yy / n), (float)(zz / n), 0, 0, 0};
    return n * 8 * (double)r * (double)y * (double)r / ((double)GRID * GRID * GRID);
}

static void near_diagonal(phys_geom_inertia want, phys_geom_inertia got, float rel) {
    TEST_ASSERT_FLOAT_WITHIN(rel * want.xx, want.xx, got.xx);
    TEST_ASSERT_FLOAT_WITHIN(rel * want.yy, want.yy, got.yy);
    TEST_ASSERT_FLOAT_WITHIN(rel * want.zz, want.zz, got.zz);
}

static void test_against_integration(void) {
    phys_geom_inertia i;
    float h = 1.0f, r = 0.5f;
    double v = integrate(in_sphere, 0, r, r, &i);
    TEST_ASSERT_FLOAT_WITHIN(5e-3f * (float)v, (float)v, phys_geom_volume_sphere(r));
    near_diagonal(i, phys_geom_inertia_sphere(r), 5e-3f);
    core_vec3 half = {r, h, 0.7f * r};
    v = integrate(in_box, h, r, h, &i);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f * (float)v, (float)v, phys_geom_volume_box(half));
    near_diagonal(i, phys_geom_inertia_box(half), 1e-3f);
    v = integrate(in_cylinder, h, r, h, &i);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f * (float)v, (float)v, phys_geom_volume_cylinder(h, r));
    near_diagonal(i, phys_geom_inertia_cylinder(h, r), 2e-3f);
    v = integrate(in_capsule, h, r, h + r, &i);
    TEST_ASSERT_FLOAT_WITHIN(5e-3f * (float)v, (float)v, phys_geom_volume_capsule(h, r));
    near_diagonal(i, phys_geom_inertia_capsule(h, r), 5e-3f);
    // The report's unreadable row, checked by Monte-Carlo there: r 0.5, segment 2 m.
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.6656f, phys_geom_inertia_capsule(h, r).xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.1187f, phys_geom_inertia_capsule(h, r).yy);
}

static void test_convex_equals_box(void) {
    for (int k = 0; k < 50; k++) {
        core_vec3 half = {0.2f + random_unit(), 0.2f + random_unit(), 0.2f + random_unit()}, v[8];
        core_vec3 at = random_vec(20), center;
        core_quat q = random_quat();
        phys_geom_box_vertices(half, v);
        phys_geom_transform_points(v, 8, at, q);
        float volume = phys_geom_volume_box(half);
        TEST_ASSERT_FLOAT_WITHIN(2e-4f * volume, volume, phys_geom_volume_convex(v, 8));
        phys_geom_inertia got, want = phys_geom_inertia_rotate(phys_geom_inertia_box(half), q);
        TEST_ASSERT_TRUE(phys_geom_inertia_convex(v, 8, &got, &center));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0, distance(center, at));
        near_diagonal(want, got, 1e-3f);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, want.xy, got.xy);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, want.xz, got.xz);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, want.yz, got.yz);
    }
}

// A box cut into tetrahedra: shifted and summed, they give the box again.
static void test_tetrahedra_sum_to_the_box(void) {
    core_vec3 half = {0.3f, 0.5f, 0.9f}, v[8];
    phys_geom_box_vertices(half, v);
    phys_geom_hull hull;
    TEST_ASSERT_TRUE(phys_geom_hull_build(&hull, v, 8));
    uint32_t tetra[4 * 12], count = phys_geom_tetrahedralize(&hull, tetra);
    TEST_ASSERT_EQUAL_UINT32(6, count); // three far faces of two triangles
    phys_geom_inertia sum = {0};
    float volume = 0, whole = phys_geom_volume_box(half);
    for (uint32_t i = 0; i < count; i++) {
        core_vec3 t[4];
        for (int k = 0; k < 4; k++) {
            t[k] = hull.vertex[tetra[4 * i + (uint32_t)k]];
        }
        float one = phys_geom_volume_tetrahedron(t);
        TEST_ASSERT_TRUE(one > 0);
        volume += one;
        phys_geom_inertia c = phys_geom_inertia_tetrahedron(t);
        c = phys_geom_inertia_shift(c, 1, phys_geom_average(t, 4));
        float m = one / whole;
        sum.xx += m * c.xx, sum.yy += m * c.yy, sum.zz += m * c.zz;
        sum.xy += m * c.xy, sum.xz += m * c.xz, sum.yz += m * c.yz;
    }
    phys_geom_hull_release(&hull);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, whole, volume);
    near_diagonal(phys_geom_inertia_box(half), sum, 1e-5f);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, sum.xy);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, sum.yz);
}

static void test_rotation_is_r_i_rt(void) {
    phys_geom_inertia i = {1, 2, 3, 0, 0, 0};
    core_quat q = core_quat_axis_angle(core_v3(0, 0, 1), CORE_PI_F / 2); // x -> y
    phys_geom_inertia r = phys_geom_inertia_rotate(i, q);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 2, r.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, r.yy);
    for (int k = 0; k < 100; k++) { // L = I w turns with the body: R (I w) = I' (R w)
        q = random_quat();
        core_vec3 w = random_vec(1), l = {i.xx * w.x, i.yy * w.y, i.zz * w.z};
        core_vec3 rw = core_quat_rotate(q, w), rl = core_quat_rotate(q, l);
        r = phys_geom_inertia_rotate(i, q);
        core_vec3 got = {r.xx * rw.x + r.xy * rw.y + r.xz * rw.z,
                         r.xy * rw.x + r.yy * rw.y + r.yz * rw.z,
                         r.xz * rw.x + r.yz * rw.y + r.zz * rw.z};
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, distance(rl, got));
    }
}

static void test_bounds_contain_and_touch(void) {
    for (int k = 0; k < 2000; k++) {
        core_vec3 half = {0.1f + random_unit(), 0.1f + random_unit(), 0.1f + random_unit()}, v[8];
        core_vec3 at = random_vec(5);
        core_quat q = random_quat();
        phys_geom_box_vertices(half, v);
        core_aabb a = phys_geom_bounds_box(half, at, q);
        core_aabb b = phys_geom_bounds_convex(v, 8, at, q);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, distance(a.min, b.min));
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, distance(a.max, b.max));
    }
    core_aabb s = phys_geom_bounds_sphere(core_v3(1, 2, 3), 0.5f);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, s.min.x);
    TEST_ASSERT_EQUAL_FLOAT(3.5f, s.max.z);
    core_aabb c = phys_geom_bounds_capsule(core_v3(0, 0, 0), core_v3(1, -2, 0), 0.25f);
    TEST_ASSERT_EQUAL_FLOAT(-2.25f, c.min.y);
    TEST_ASSERT_EQUAL_FLOAT(1.25f, c.max.x);
}

static void test_small_utilities(void) {
    for (int k = 0; k < 1000; k++) {
        core_vec3 v = k < 3 ? core_v3(k == 0, k == 1, k == 2) : random_vec(100);
        core_vec3 o = phys_geom_orthogonal(v);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, core_v3_length(o));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0, core_v3_dot(o, v) / (1 + core_v3_length(v)));
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, core_v3_length(phys_geom_orthogonal(core_v3(0, 0, 0))));
    core_vec3 p[4] = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {0, 0, 6}}, kept[4];
    TEST_ASSERT_EQUAL_FLOAT(1.5f, phys_geom_average(p, 4).z);
    const float w[4] = {0, 1, 1, 0};
    TEST_ASSERT_EQUAL_FLOAT(2, phys_geom_weighted_average(p, w, 4).y);
    const core_vec3 t[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    float b[3];
    TEST_ASSERT_TRUE(phys_geom_barycentric(core_v3(0.2f, 0.3f, 7), t, b));
    TEST_ASSERT_EQUAL_FLOAT(0.5f, b[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.3f, b[2]);
    const core_vec3 line[3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    TEST_ASSERT_FALSE(phys_geom_barycentric(core_v3(0, 0, 0), line, b));
    TEST_ASSERT_TRUE(phys_geom_same_side(p[1], p[3], core_v3(0, -1, 0), core_v3(0, 1, 0)));
    TEST_ASSERT_FALSE(phys_geom_same_side(p[0], p[2], core_v3(0, 1, 0), core_v3(0, 1, 0)));
    core_vec3 hemi[2];
    phys_geom_capsule_hemispheres(1, 0.4f, hemi);
    TEST_ASSERT_EQUAL_FLOAT(1.15f, hemi[1].y); // centroid of a hemisphere: 3/8 r above its base
    for (int i = 0; i < 4; i++) {
        kept[i] = p[i];
    }
    core_quat q = random_quat();
    phys_geom_transform_points(p, 4, core_v3(1, 2, 3), q);
    phys_geom_translate_points(p, 4, core_v3(-1, -2, -3));
    phys_geom_transform_points(p, 4, core_v3(0, 0, 0), core_quat_conjugate(q));
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, distance(kept[i], p[i]));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_against_integration);
    RUN_TEST(test_convex_equals_box);
    RUN_TEST(test_tetrahedra_sum_to_the_box);
    RUN_TEST(test_rotation_is_r_i_rt);
    RUN_TEST(test_bounds_contain_and_touch);
    RUN_TEST(test_small_utilities);
    return UNITY_END();
}
