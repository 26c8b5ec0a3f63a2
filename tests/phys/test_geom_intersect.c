// Intersections, SAT, GJK, EPA: moving the second set by depth along the normal leaves it touching;
// swapping the sets flips the normal; the methods agree with one another and with brute force.
#include "phys/geom.h"

#include "geom_random.h"
#include "unity.h"

#define TRIALS 3000

void setUp(void) { random_seed(2024); }
void tearDown(void) {}

static core_vec3 unit_half(void) {
    return core_v3(0.2f + random_unit(), 0.2f + random_unit(), 0.2f + random_unit());
}

// Distance between convex sets given as triangles, by all vertex-face and edge-edge pairs
// (Ericson 9.3).
static float brute_distance(const phys_geom_hull *a, const phys_geom_hull *b) {
    uint32_t ta[256], tb[256], na = phys_geom_hull_triangles(a, ta);
    uint32_t nb = phys_geom_hull_triangles(b, tb);
    float best = 1e9f;
    for (uint32_t i = 0; i < na; i += 3) {
        const core_vec3 p[3] = {a->vertex[ta[i]], a->vertex[ta[i + 1]], a->vertex[ta[i + 2]]};
        for (uint32_t j = 0; j < nb; j += 3) {
            const core_vec3 q[3] = {b->vertex[tb[j]], b->vertex[tb[j + 1]], b->vertex[tb[j + 2]]};
            for (int e = 0; e < 3; e++) {
                float d =
                    phys_geom_closest_points_line_triangle(p[e], p[(e + 1) % 3], true, q).distance;
                float f =
                    phys_geom_closest_points_line_triangle(q[e], q[(e + 1) % 3], true, p).distance;
                best = CORE_MIN(best, CORE_MIN(d, f));
            }
        }
    }
    return best;
}

static uint32_t random_hull(core_vec3 *points, core_vec3 at) {
    uint32_t n = 6 + (uint32_t)(random_unit() * 18);
    for (uint32_t i = 0; i < n; i++) {
        points[i] = core_v3_add(at, random_vec(0.7f));
    }
    return n;
}

static phys_geom_convex convex_of(const core_vec3 *points, uint32_t count) {
    return (phys_geom_convex){.point = points, .count = count, .rotation = {0, 0, 0, 1}};
}

static void test_gjk_distance_equals_brute_force(void) {
    int apart = 0, overlap = 0;
    for (int i = 0; i < TRIALS / 4; i++) {
        core_vec3 p[24], q[24];
        uint32_t np = random_hull(p, core_v3(0, 0, 0)), nq = random_hull(q, random_vec(1.5f));
        phys_geom_hull a, b;
        TEST_ASSERT_TRUE(phys_geom_hull_build(&a, p, np) && phys_geom_hull_build(&b, q, nq));
        phys_geom_convex ca = convex_of(p, np), cb = convex_of(q, nq);
        phys_geom_gjk_result r = phys_geom_gjk(&ca, &cb);
        TEST_ASSERT_TRUE(r.iterations <= 32);
        phys_geom_overlap s = phys_geom_sat(&a, core_v3(0, 0, 0), core_quat_identity(), &b,
                                            core_v3(0, 0, 0), core_quat_identity());
        if (r.overlap.hit) {
            overlap++;
            TEST_ASSERT_TRUE(s.hit);
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, s.depth, r.overlap.depth);
        } else {
            apart++;
            TEST_ASSERT_TRUE(!s.hit || s.depth < 1e-5f);
            TEST_ASSERT_FLOAT_WITHIN(1e-5f, brute_distance(&a, &b), r.closest.distance);
            TEST_ASSERT_FLOAT_WITHIN(1e-5f, r.closest.distance, distance(r.closest.a, r.closest.b));
        }
        phys_geom_hull_release(&a);
        phys_geom_hull_release(&b);
    }
    TEST_ASSERT_TRUE(apart > 100 && overlap > 100);
}

// Pushing b out along the normal leaves the pair touching.
static void check_separates(const phys_geom_convex *a, const phys_geom_convex *b,
                            phys_geom_overlap o) {
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1, core_v3_length(o.normal));
    phys_geom_convex moved = *b;
    moved.position = core_v3_mad(b->position, o.normal, o.depth + 1e-4f);
    phys_geom_gjk_result r = phys_geom_gjk(a, &moved);
    TEST_ASSERT_FALSE(r.overlap.hit && r.overlap.depth > 1e-4f);
    TEST_ASSERT_TRUE(r.overlap.hit || r.closest.distance < 4e-4f);
}

static void check_swapped(phys_geom_overlap ab, phys_geom_overlap ba) {
    TEST_ASSERT_EQUAL(ab.hit, ba.hit);
    if (ab.hit) {
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, ab.depth, ba.depth);
    }
}

static void test_boxes(void) {
    int hits = 0;
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 ha = unit_half(), hb = unit_half(), pb = random_vec(1.8f), va[8], vb[8];
        core_quat qa = random_quat(), qb = i % 4 ? random_quat() : qa; // parallel edges too
        core_vec3 pa = random_vec(1);
        phys_geom_box_vertices(ha, va);
        phys_geom_box_vertices(hb, vb);
        phys_geom_convex a = {va, 8, 0, 0, pa, qa}, b = {vb, 8, 0, 0, pb, qb};
        phys_geom_overlap o = phys_geom_intersect_box_box(ha, pa, qa, hb, pb, qb);
        phys_geom_overlap g = phys_geom_intersect_convex_convex(&a, &b);
        if (o.hit != g.hit) {
            TEST_ASSERT_TRUE((o.hit ? o.depth : g.depth) < 1e-5f);
            continue;
        }
        check_swapped(o, phys_geom_intersect_box_box(hb, pb, qb, ha, pa, qa));
        if (o.hit) {
            hits++;
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, o.depth, g.depth);
            check_separates(&a, &b, o);
            check_separates(&a, &b, g);
        }
    }
    TEST_ASSERT_TRUE(hits > TRIALS / 5);
}

static void test_round_shapes(void) {
    const core_vec3 zero = {0, 0, 0};
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 half = unit_half(), p = random_vec(0.5f), c = random_vec(1.6f), box[8];
        core_quat q = random_quat();
        float r = 0.1f + 0.6f * random_unit(), r2 = 0.1f + 0.6f * random_unit();
        core_vec3 e0 = random_vec(1), e1 = random_vec(1);
        phys_geom_box_vertices(half, box);
        core_vec3 ends[2] = {{0, 0, 0}, core_v3_sub(e1, e0)};
        phys_geom_convex cb = {box, 8, 0, 0, p, q}, cs = {&zero, 1, r, 0, c, {0, 0, 0, 1}};
        phys_geom_convex cc = {ends, 2, r2, 0, e0, {0, 0, 0, 1}};
        phys_geom_overlap pair[5] = {
            phys_geom_intersect_box_sphere(half, p, q, c, r),
            phys_geom_intersect_box_capsule(half, p, q, e0, e1, r2),
            phys_geom_intersect_sphere_capsule(c, r, e0, e1, r2),
            phys_geom_intersect_sphere_convex(c, r, &cb),
            phys_geom_intersect_capsule_convex(e0, e1, r2, &cb),
        };
        const phys_geom_convex *a[5] = {&cb, &cb, &cs, &cs, &cc}, *b[5] = {&cs, &cc, &cc, &cb, &cb};
        for (int k = 0; k < 5; k++) {
            phys_geom_overlap g = phys_geom_intersect_convex_convex(a[k], b[k]);
            if (pair[k].hit != g.hit) {
                TEST_ASSERT_TRUE((g.hit ? g.depth : pair[k].depth) < 1e-4f);
            } else if (g.hit) {
                TEST_ASSERT_FLOAT_WITHIN(2e-4f, g.depth, pair[k].depth);
                check_separates(a[k], b[k], pair[k]);
            }
        }
    }
}

static void test_capsule_pairs(void) {
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 a0 = random_vec(1), a1 = random_vec(1), b0 = random_vec(1), b1 = random_vec(1);
        phys_geom_overlap o = phys_geom_intersect_capsule_capsule(a0, a1, 0.3f, b0, b1, 0.4f);
        phys_geom_closest c = phys_geom_closest_points_lines(a0, a1, true, b0, b1, true);
        TEST_ASSERT_EQUAL(c.distance <= 0.7f, o.hit);
        if (o.hit) {
            TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.7f - c.distance, o.depth);
        }
    }
    core_vec3 x0 = {-1, 0, 0}, x1 = {1, 0, 0}, z0 = {0, 0, -1}, z1 = {0, 0, 1};
    phys_geom_overlap cross = phys_geom_intersect_capsule_capsule(x0, x1, 0.2f, z0, z1, 0.3f);
    TEST_ASSERT_TRUE(cross.hit); // crossing axes: out across both
    TEST_ASSERT_EQUAL_FLOAT(0.5f, cross.depth);
    TEST_ASSERT_EQUAL_FLOAT(1, core_absf(cross.normal.y));
}

static void test_closed_forms(void) {
    phys_geom_overlap o =
        phys_geom_intersect_sphere_sphere(core_v3(0, 0, 0), 1, core_v3(0, 1.5f, 0), 1);
    TEST_ASSERT_TRUE(o.hit);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, o.depth);
    TEST_ASSERT_EQUAL_FLOAT(1, o.normal.y);
    TEST_ASSERT_EQUAL_FLOAT(0.75f, o.point.y);
    o = phys_geom_intersect_sphere_sphere(core_v3(0, 0, 0), 1, core_v3(0, 0, 0), 1); // same centre
    TEST_ASSERT_EQUAL_FLOAT(2, o.depth);
    TEST_ASSERT_EQUAL_FLOAT(1, core_v3_length(o.normal));
    TEST_ASSERT_TRUE(
        phys_geom_intersect_sphere_sphere(core_v3(0, 0, 0), 1, core_v3(2, 0, 0), 1).hit);
    TEST_ASSERT_TRUE(
        phys_geom_intersect_point_sphere(core_v3(0.5f, 0, 0), core_v3(0, 0, 0), 1).hit);
    TEST_ASSERT_FALSE(
        phys_geom_intersect_point_sphere(core_v3(1.5f, 0, 0), core_v3(0, 0, 0), 1).hit);
    core_aabb a = {{0, 0, 0}, {2, 2, 2}}, b = {{1.5f, 0.5f, 0.5f}, {3, 1, 1}};
    o = phys_geom_intersect_aabb_aabb(a, b);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, o.depth);
    TEST_ASSERT_EQUAL_FLOAT(1, o.normal.x);
    core_aabb c = {{5, 5, 5}, {6, 6, 6}};
    TEST_ASSERT_FALSE(phys_geom_intersect_aabb_aabb(a, c).hit);
    TEST_ASSERT_FALSE(phys_geom_overlap_miss().hit);
    core_vec3 one = {1, 1, 1};
    core_quat id = core_quat_identity();
    o = phys_geom_intersect_box_sphere(one, core_v3(0, 0, 0), id, core_v3(0.9f, 0, 0), 0.5f);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.6f, o.depth); // centre inside: 0.1 to the face + radius
    TEST_ASSERT_EQUAL_FLOAT(1, o.normal.x);
    o = phys_geom_intersect_box_box(one, core_v3(0, 0, 0), id, one, core_v3(0, 1.9f, 0), id);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.1f, o.depth);
    TEST_ASSERT_EQUAL_FLOAT(1, o.normal.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.95f, o.point.y);
}

static void test_cylinder_by_gjk(void) {
    const core_vec3 zero = {0, 0, 0};
    for (int i = 0; i < TRIALS / 3; i++) {
        core_quat q = random_quat();
        phys_geom_convex cylinder = {NULL, 0, 0.5f, 1.0f, random_vec(1), q};
        core_vec3 l = random_vec(2);
        phys_geom_convex ball = {&zero, 1, 0.3f, 0, zero, {0, 0, 0, 1}};
        ball.position = core_v3_add(cylinder.position, core_quat_rotate(q, l));
        float side = core_sqrtf(l.x * l.x + l.z * l.z) - 0.5f, up = core_absf(l.y) - 1;
        float gap = side > 0 && up > 0 ? core_sqrtf(side * side + up * up) : CORE_MAX(side, up);
        phys_geom_gjk_result r = phys_geom_gjk(&cylinder, &ball);
        float got = r.overlap.hit ? -r.overlap.depth : r.closest.distance;
        TEST_ASSERT_FLOAT_WITHIN(2e-4f, gap - 0.3f, got);
    }
}

static void test_extreme_shapes(void) { // flat, thin, tiny, far: an answer, never NaN
    for (int i = 0; i < TRIALS; i++) {
        core_vec3 va[8], vb[8], at = random_vec(i % 2 ? 1000 : 1);
        float thin = core_expf(-9 * random_unit());
        phys_geom_box_vertices(core_v3(1, thin, 1), va);
        phys_geom_box_vertices(core_v3(thin, 1, thin * 0.1f), vb);
        phys_geom_convex a = {va, 8, 0, 0, at, random_quat()};
        phys_geom_convex b = {vb, 8, 0, 0, core_v3_add(at, random_vec(1)), random_quat()};
        phys_geom_gjk_result r = phys_geom_gjk(&a, &b);
        float d = r.overlap.hit ? r.overlap.depth : r.closest.distance;
        TEST_ASSERT_TRUE(d >= 0 && d < 10);
        TEST_ASSERT_TRUE(core_v3_length(r.overlap.normal) < 1.01f);
    }
    core_vec3 tri[3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, p = {0.2f, 0, 0.2f};
    phys_geom_convex flat = convex_of(tri, 3), point = convex_of(&p, 1);
    TEST_ASSERT_TRUE(phys_geom_gjk(&flat, &point).overlap.hit);
    TEST_ASSERT_EQUAL_FLOAT(0, phys_geom_gjk(&flat, &flat).overlap.depth);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_gjk_distance_equals_brute_force);
    RUN_TEST(test_boxes);
    RUN_TEST(test_round_shapes);
    RUN_TEST(test_capsule_pairs);
    RUN_TEST(test_closed_forms);
    RUN_TEST(test_cylinder_by_gjk);
    RUN_TEST(test_extreme_shapes);
    return UNITY_END();
}
