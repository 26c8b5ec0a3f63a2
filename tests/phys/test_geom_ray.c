// Rays: the hit lies on the surface at o + t d, nothing before it is inside, misses are real
// misses.
#include "phys/geom.h"

#include "geom_random.h"
#include "unity.h"

#define TRIALS 4000

void setUp(void) { random_seed(5); }
void tearDown(void) {}

typedef struct solid {
    int kind; // 0 sphere, 1 box, 2 capsule, 3 cylinder, 4 tetrahedron, 5 convex
    core_vec3 p, half, t[4], corner[8];
    core_quat q;
    float radius;
} solid;

static solid random_solid(int kind) {
    solid s = {
        .kind = kind, .p = random_vec(1), .q = random_quat(), .radius = 0.2f + random_unit()};
    s.half = core_v3(0.2f + random_unit(), 0.2f + random_unit(), 0.2f + random_unit());
    for (int i = 0; i < 4; i++) {
        s.t[i] = random_vec(1.5f);
    }
    phys_geom_box_vertices(s.half, s.corner);
    phys_geom_transform_points(s.corner, 8, s.p, s.q);
    return s;
}

static core_vec3 capsule_end(const solid *s, float sign) {
    return core_v3_add(s->p, core_quat_rotate(s->q, core_v3(0, sign * s->half.y, 0)));
}

// Signed distance (cylinder, box: of the largest violated slab), negative inside.
static float outside(const solid *s, core_vec3 p) {
    core_vec3 l = core_quat_unrotate(s->q, core_v3_sub(p, s->p));
    float x = core_absf(l.x) - s->half.x, y = core_absf(l.y) - s->half.y,
          z = core_absf(l.z) - s->half.z;
    switch (s->kind) {
    case 0:
        return core_v3_length(core_v3_sub(p, s->p)) - s->radius;
    case 1:
    case 5:
        return CORE_MAX(CORE_MAX(x, y), z);
    case 2: {
        core_vec3 c = phys_geom_closest_point_line(p, capsule_end(s, -1), capsule_end(s, 1), true);
        return distance(p, c) - s->radius;
    }
    case 3:
        return CORE_MAX(y, core_sqrtf(l.x * l.x + l.z * l.z) - s->radius);
    default:
        return phys_geom_point_in_tetrahedron(p, s->t, 0) ? -1.0f : 1.0f;
    }
}

static phys_geom_ray_hit cast(const solid *s, core_vec3 o, core_vec3 d, float t_max) {
    switch (s->kind) {
    case 0:
        return phys_geom_ray_sphere(o, d, t_max, s->p, s->radius);
    case 1:
        return phys_geom_ray_box(o, d, t_max, s->half, s->p, s->q);
    case 2:
        return phys_geom_ray_capsule(o, d, t_max, capsule_end(s, -1), capsule_end(s, 1), s->radius);
    case 3:
        return phys_geom_ray_cylinder(o, d, t_max, s->half.y, s->radius, s->p, s->q);
    case 4:
        return phys_geom_ray_tetrahedron(o, d, t_max, s->t);
    default:
        return phys_geom_ray_convex(o, d, t_max, s->corner, 8);
    }
}

static void check_solid(int kind) {
    int hits = 0, misses = 0;
    for (int i = 0; i < TRIALS; i++) {
        solid s = random_solid(kind);
        core_vec3 o = random_vec(4);
        core_vec3 d = core_v3_scale(core_v3_sub(random_vec(2), o), 0.2f + random_unit());
        float t_max = 3;
        phys_geom_ray_hit h = cast(&s, o, d, t_max);
        float until = h.hit ? h.t : t_max;
        for (int k = 0; k < 50; k++) { // nothing inside before the hit
            core_vec3 p = core_v3_mad(o, d, until * (float)k / 50);
            TEST_ASSERT_TRUE(h.hit && h.t <= 0 ? true : outside(&s, p) > -1e-4f);
        }
        if (!h.hit) {
            misses++;
            continue;
        }
        hits++;
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, distance(h.point, core_v3_mad(o, d, h.t)));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1, core_v3_length(h.normal));
        TEST_ASSERT_TRUE(core_v3_dot(h.normal, d) <= 1e-3f);
        if (h.t <= 0) {
            TEST_ASSERT_TRUE(outside(&s, o) <= 1e-6f);
        } else if (kind != 4) {
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0, outside(&s, h.point));
        }
    }
    TEST_ASSERT_TRUE(hits > TRIALS / 20 && misses > TRIALS / 20);
}

static void test_sphere(void) { check_solid(0); }
static void test_box(void) { check_solid(1); }
static void test_capsule(void) { check_solid(2); }
static void test_cylinder(void) { check_solid(3); }
static void test_tetrahedron(void) { check_solid(4); }
static void test_convex(void) { check_solid(5); }

static void test_convex_equals_box(void) {
    for (int i = 0; i < TRIALS; i++) {
        solid s = random_solid(5);
        core_vec3 o = random_vec(4), d = random_vec(1);
        phys_geom_ray_hit a = phys_geom_ray_convex(o, d, 20, s.corner, 8);
        phys_geom_ray_hit b = phys_geom_ray_box(o, d, 20, s.half, s.p, s.q);
        if (a.hit && b.hit) {
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, b.t, a.t);
        } else if (a.hit != b.hit) { // a graze: the other one passes within rounding
            core_vec3 p = a.hit ? a.point : b.point;
            phys_geom_closest c =
                phys_geom_closest_points_line_convex(o, core_v3_add(o, d), false, s.corner, 8);
            TEST_ASSERT_TRUE(c.distance < 1e-4f && distance(p, c.b) < 10);
        }
    }
}

static void test_triangle(void) {
    const core_vec3 t[3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    phys_geom_ray_hit h = phys_geom_ray_triangle(core_v3(0.25f, 2, 0.25f), core_v3(0, -2, 0), 5, t);
    TEST_ASSERT_TRUE(h.hit);
    TEST_ASSERT_EQUAL_FLOAT(1, h.t);
    TEST_ASSERT_EQUAL_FLOAT(1, h.normal.y);
    h = phys_geom_ray_triangle(core_v3(0.25f, -2, 0.25f), core_v3(0, 2, 0), 5, t); // from behind
    TEST_ASSERT_TRUE(h.hit);
    TEST_ASSERT_EQUAL_FLOAT(-1, h.normal.y);
    TEST_ASSERT_FALSE(phys_geom_ray_triangle(core_v3(0.6f, 2, 0.6f), core_v3(0, -1, 0), 5, t).hit);
    TEST_ASSERT_FALSE(phys_geom_ray_triangle(core_v3(0.2f, 2, 0.2f), core_v3(0, -1, 0), 1, t).hit);
    TEST_ASSERT_FALSE(phys_geom_ray_triangle(core_v3(0, 2, 0), core_v3(1, 0, 0), 9, t).hit);
    for (int i = 0; i < TRIALS; i++) { // a ray aimed at a point of the triangle meets it there
        core_vec3 r[3] = {random_vec(1), random_vec(1), random_vec(1)}, o = random_vec(3);
        float u = random_unit() * 0.5f, v = random_unit() * 0.5f;
        core_vec3 p =
            core_v3_mad(core_v3_mad(r[0], core_v3_sub(r[1], r[0]), u), core_v3_sub(r[2], r[0]), v);
        phys_geom_ray_hit hit = phys_geom_ray_triangle(o, core_v3_sub(p, o), 2, r);
        core_vec3 n = core_v3_cross(core_v3_sub(r[1], r[0]), core_v3_sub(r[2], r[0]));
        if (core_absf(core_v3_dot(n, core_v3_sub(p, o))) > 1e-2f) {
            TEST_ASSERT_TRUE(hit.hit);
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1, hit.t);
        }
    }
}

static void test_degenerate_rays_miss(void) {
    core_vec3 o = {0, 5, 0}, zero = {0, 0, 0}, nan = {__builtin_nanf(""), 0, 0};
    TEST_ASSERT_FALSE(phys_geom_ray_sphere(o, zero, 10, zero, 1).hit);
    TEST_ASSERT_FALSE(phys_geom_ray_sphere(o, nan, 10, zero, 1).hit);
    TEST_ASSERT_FALSE(phys_geom_ray_sphere(o, core_v3(0, -1, 0), -1, zero, 1).hit);
    TEST_ASSERT_FALSE(phys_geom_ray_miss().hit);
    // Far away: a sphere of 1 m from 100 km is still hit within a centimetre.
    phys_geom_ray_hit h =
        phys_geom_ray_sphere(core_v3(1e5f, 0, 0), core_v3(-1, 0, 0), 2e5f, zero, 1);
    TEST_ASSERT_TRUE(h.hit);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 99999, h.t);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_sphere);
    RUN_TEST(test_box);
    RUN_TEST(test_capsule);
    RUN_TEST(test_cylinder);
    RUN_TEST(test_tetrahedron);
    RUN_TEST(test_convex);
    RUN_TEST(test_convex_equals_box);
    RUN_TEST(test_triangle);
    RUN_TEST(test_degenerate_rays_miss);
    return UNITY_END();
}
