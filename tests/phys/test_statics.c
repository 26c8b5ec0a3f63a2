// The world as geometry: each shape's triangles enclose its volume, outward; static changes are
// told with their bounds, once.
#include "core/log.h"
#include "core/math.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static const float corner[] = {-1, -1, -1, 1, -1, -1, 0, 1, 0, 0, -1, 1.5f, 0.2f, 0.8f, 0.1f};

static phys_body add(phys_body_type body, phys_shape_type type, core_vec3 at) {
    phys_body_desc d = phys_body_desc_default();
    d.type = body;
    d.position = at;
    d.rotation = (core_quat){0.1825742f, 0.3651484f, 0.5477226f, 0.7302967f};
    phys_shape_desc s = phys_shape_desc_default(type);
    s.half = core_v3(0.5f, 1.0f, 1.5f);
    s.radius = 0.5f;
    s.half_height = 1.0f;
    s.points = corner;
    s.point_count = 5;
    return phys_body_create(world, &d, &s, 1);
}

// Divergence theorem; the closed surface's volume is the same about any point.
static double volume(const core_vec3 *t, uint32_t n, core_vec3 about) {
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) {
        core_vec3 a = core_v3_sub(t[3 * i], about), b = core_v3_sub(t[3 * i + 1], about);
        core_vec3 c = core_v3_sub(t[3 * i + 2], about);
        sum += (double)core_v3_dot(a, core_v3_cross(b, c)) / 6.0;
    }
    return sum;
}

static void test_triangles_enclose_the_shape(void) {
    static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER};
    static const double want[] = {0.5235988, 6.0, 2.0943951, 1.5707963};
    core_vec3 *t = malloc(3 * 40000 * sizeof *t);
    for (uint32_t k = 0; k < 4; k++) {
        add(PHYS_STATIC, type[k], core_v3(10, 5, -3));
        phys_shape_view v;
        TEST_ASSERT_TRUE(phys_world_shape(world, k, &v));
        TEST_ASSERT_EQUAL_INT(type[k], v.type);
        uint32_t n = phys_shape_triangles(&v, 1e-4f, 0, t, 40000);
        TEST_ASSERT_TRUE(n <= 40000 && n == phys_shape_triangles(&v, 1e-4f, 0, NULL, 0));
        double got = volume(t, n, v.position), moved = volume(t, n, core_v3(8, 8, 0));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * want[k], want[k], got);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, got, moved); // nothing missing: the surface is closed
        for (uint32_t i = 0; i < 3 * n; i++) {
            TEST_ASSERT_TRUE(t[i].x >= v.bounds.min.x - 1e-5f && t[i].x <= v.bounds.max.x + 1e-5f);
            TEST_ASSERT_TRUE(t[i].y >= v.bounds.min.y - 1e-5f && t[i].y <= v.bounds.max.y + 1e-5f);
        }
    }
    free(t);
    TEST_ASSERT_EQUAL_UINT32(4, phys_world_shape_count(world));
}

static void test_hull_and_plane(void) {
    core_vec3 t[64];
    phys_shape_view v;
    add(PHYS_STATIC, PHYS_HULL, core_v3(1, 2, 3));
    TEST_ASSERT_TRUE(phys_world_shape(world, 0, &v));
    uint32_t n = phys_shape_triangles(&v, 0, 0, t, 64);
    TEST_ASSERT_EQUAL_UINT32(2 * v.vertex_count - 4, n); // Euler
    TEST_ASSERT_TRUE(volume(t, n, v.position) > 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, volume(t, n, v.position), volume(t, n, core_v3(0, 0, 9)));

    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    phys_shape_desc s = phys_shape_desc_default(PHYS_PLANE);
    phys_body_create(world, &d, &s, 1);
    TEST_ASSERT_TRUE(phys_world_shape(world, 1, &v));
    TEST_ASSERT_EQUAL_UINT32(2, phys_shape_triangles(&v, 0.1f, 50, t, 64));
    core_vec3 up = core_v3_cross(core_v3_sub(t[1], t[0]), core_v3_sub(t[2], t[0]));
    TEST_ASSERT_EQUAL_FLOAT(10000.0f, up.y);
    TEST_ASSERT_FALSE(phys_world_shape(world, 2, &v));
    TEST_ASSERT_EQUAL_STRING("phys shape: row 2, expected less than 2", core_last_error());
}

static void test_static_changes_are_told_once(void) {
    core_aabb change[8];
    bool complete;
    uint64_t start = phys_world_static_version(world);
    phys_body ball = add(PHYS_DYNAMIC, PHYS_SPHERE, core_v3(0, 9, 0));
    TEST_ASSERT_EQUAL_UINT64(start, phys_world_static_version(world)); // dynamic: none of it
    phys_body door = add(PHYS_STATIC, PHYS_SPHERE, core_v3(0, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(1, phys_world_static_changes(world, start, change, 8, &complete));
    TEST_ASSERT_TRUE(complete);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, change[0].max.x);
    uint64_t made = phys_world_static_version(world);
    phys_body_set_position(world, door, core_v3(4, 0, 0));
    phys_body_set_position(world, ball, core_v3(5, 9, 0));
    TEST_ASSERT_EQUAL_UINT32(2, phys_world_static_changes(world, made, change, 8, &complete));
    TEST_ASSERT_EQUAL_FLOAT(-0.5f, change[0].min.x); // where it was, where it is
    TEST_ASSERT_EQUAL_FLOAT(4.5f, change[1].max.x);
    uint64_t moved = phys_world_static_version(world);
    phys_world_step(world, 1.0f / 60.0f);
    TEST_ASSERT_EQUAL_UINT32(0, phys_world_static_changes(world, moved, change, 8, &complete));
    phys_body_destroy(world, door);
    TEST_ASSERT_EQUAL_UINT32(1, phys_world_static_changes(world, moved, change, 8, &complete));
    TEST_ASSERT_EQUAL_FLOAT(3.5f, change[0].min.x);
}

static void test_long_ago_is_said(void) {
    core_aabb change[4];
    bool complete;
    phys_body door = add(PHYS_STATIC, PHYS_BOX, core_v3(0, 0, 0));
    uint64_t made = phys_world_static_version(world);
    for (int i = 0; i < 200; i++) { // two changes each, of which 256 are kept
        phys_body_set_position(world, door, core_v3((float)i, 0, 0));
    }
    TEST_ASSERT_EQUAL_UINT32(256, phys_world_static_changes(world, made, change, 4, &complete));
    TEST_ASSERT_FALSE(complete);
    uint64_t now = phys_world_static_version(world);
    size_t size = phys_world_save_size(world);
    void *saved = malloc(size);
    phys_world_save(world, saved);
    TEST_ASSERT_TRUE(phys_world_restore(world, saved, size));
    TEST_ASSERT_TRUE(phys_world_static_version(world) > now);
    TEST_ASSERT_EQUAL_UINT32(0, phys_world_static_changes(world, now, change, 4, &complete));
    TEST_ASSERT_FALSE(complete);
    free(saved);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_triangles_enclose_the_shape);
    RUN_TEST(test_hull_and_plane);
    RUN_TEST(test_static_changes_are_told_once);
    RUN_TEST(test_long_ago_is_said);
    return UNITY_END();
}
