// Convex hulls and supports: closed, oriented, convex, holding every point; bad input is an error.
#include "phys/geom.h"

#include "geom_random.h"
#include "unity.h"

#include <string.h>

void setUp(void) { random_seed(99); }
void tearDown(void) {}

static core_vec3 cloud[20000];

// Every edge stands once each way, V - E + F = 2, every point is below every face.
static void check_hull(const phys_geom_hull *h, const core_vec3 *points, uint32_t count,
                       float slack) {
    uint32_t twins = 0;
    for (uint32_t f = 0; f < h->face_count; f++) {
        uint32_t n = h->face_begin[f + 1] - h->face_begin[f];
        TEST_ASSERT_TRUE(n >= 3);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, core_v3_length(h->normal[f]));
        for (uint32_t i = 0; i < count; i++) {
            TEST_ASSERT_TRUE(core_v3_dot(h->normal[f], points[i]) <= h->offset[f] + slack);
        }
        for (uint32_t i = 0; i < n && h->loop_count < 2000; i++) {
            uint32_t a = h->loop[h->face_begin[f] + i], b = h->loop[h->face_begin[f] + (i + 1) % n];
            for (uint32_t g = 0; g < h->face_count; g++) {
                uint32_t m = h->face_begin[g + 1] - h->face_begin[g];
                for (uint32_t j = 0; j < m; j++) {
                    twins += h->loop[h->face_begin[g] + j] == b &&
                             h->loop[h->face_begin[g] + (j + 1) % m] == a;
                }
            }
        }
    }
    if (h->loop_count < 2000) {
        TEST_ASSERT_EQUAL_UINT32(h->loop_count, twins);
    }
    TEST_ASSERT_EQUAL_INT(2, (int)h->vertex_count - (int)h->loop_count / 2 + (int)h->face_count);
}

static void test_box_has_six_faces(void) {
    for (int k = 0; k < 200; k++) { // rotated corners are not exactly coplanar in floats
        core_vec3 v[8], half = {0.1f + random_unit(), 0.1f + random_unit(), 0.1f + random_unit()};
        phys_geom_box_vertices(half, v);
        phys_geom_transform_points(v, 8, random_vec(3), random_quat());
        phys_geom_hull h;
        TEST_ASSERT_TRUE(phys_geom_hull_build(&h, v, 8));
        TEST_ASSERT_EQUAL_UINT32(8, h.vertex_count);
        TEST_ASSERT_EQUAL_UINT32(6, h.face_count);
        TEST_ASSERT_EQUAL_UINT32(24, h.loop_count);
        check_hull(&h, v, 8, 2e-5f);
        uint32_t triangles[36];
        TEST_ASSERT_EQUAL_UINT32(36, phys_geom_hull_triangles(&h, triangles));
        phys_geom_hull_release(&h);
    }
}

static void test_random_clouds(void) {
    for (int k = 0; k < 300; k++) {
        uint32_t n = 4 + (uint32_t)(random_unit() * 60);
        for (uint32_t i = 0; i < n; i++) {
            cloud[i] = random_vec(1);
            if (k % 3 == 0) { // on a coarse lattice: many coplanar and equal points
                cloud[i] = core_v3((float)(int)(cloud[i].x * 3), (float)(int)(cloud[i].y * 3),
                                   (float)(int)(cloud[i].z * 3));
            }
            if (k % 5 == 0 && i % 2) {
                cloud[i] = cloud[i / 2];
            }
        }
        phys_geom_hull h;
        if (phys_geom_hull_build(&h, cloud, n)) {
            check_hull(&h, cloud, n, 1e-5f);
            core_vec3 d = random_vec(1); // supports of the hull are those of the cloud
            float far = core_v3_dot(cloud[phys_geom_support_point(cloud, n, d)], d);
            uint32_t s = phys_geom_support_point(h.vertex, h.vertex_count, d);
            TEST_ASSERT_FLOAT_WITHIN(1e-5f, far, core_v3_dot(h.vertex[s], d));
        } else {
            TEST_ASSERT_TRUE(k % 3 == 0 || k % 5 == 0 || n < 6);
        }
        phys_geom_hull_release(&h);
    }
}

static void test_sphere_of_many_points(void) {
    uint32_t n = 2000;
    for (uint32_t i = 0; i < n; i++) {
        cloud[i] = core_v3_normalize(random_vec(1), core_v3(1, 0, 0));
    }
    phys_geom_hull h;
    TEST_ASSERT_TRUE(phys_geom_hull_build(&h, cloud, n));
    check_hull(&h, cloud, n, 1e-5f);
    TEST_ASSERT_TRUE(h.vertex_count > 1950);
    float v = phys_geom_volume_convex(cloud, n), full = 4.18879f;
    TEST_ASSERT_TRUE(v < full && v > 0.99f * full);
    phys_geom_hull_release(&h);
}

static void test_cube_of_a_grid(void) { // interior, face and edge points vanish
    uint32_t n = 0;
    for (int i = 0; i < 6 * 6 * 6; i++) {
        cloud[n++] = core_v3((float)(i % 6), (float)(i / 6 % 6), (float)(i / 36));
    }
    phys_geom_hull h;
    TEST_ASSERT_TRUE(phys_geom_hull_build(&h, cloud, n));
    TEST_ASSERT_EQUAL_UINT32(8, h.vertex_count);
    TEST_ASSERT_EQUAL_UINT32(6, h.face_count);
    phys_geom_hull_release(&h);
}

static void expect_refused(const core_vec3 *p, uint32_t n, const char *word) {
    phys_geom_hull h;
    TEST_ASSERT_FALSE(phys_geom_hull_build(&h, p, n));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), word), core_last_error());
    TEST_ASSERT_NULL(h.vertex);
    phys_geom_hull_release(&h);
}

static void test_bad_input(void) {
    core_vec3 p[64];
    for (int i = 0; i < 64; i++) {
        p[i] = core_v3(random_sym(1), 0, random_sym(1));
    }
    for (uint32_t n = 0; n < 4; n++) {
        expect_refused(p, n, "4 to 65536");
    }
    expect_refused(p, 64, "plane");
    for (int i = 0; i < 64; i++) {
        p[i] = core_v3((float)i, (float)(2 * i), (float)-i);
    }
    expect_refused(p, 64, "line");
    for (int i = 0; i < 64; i++) {
        p[i] = core_v3(3, 3, 3);
    }
    expect_refused(p, 64, "coincide");
    p[5].y = __builtin_nanf("");
    expect_refused(p, 64, "finite");
    p[5].y = __builtin_inff();
    expect_refused(p, 64, "finite");
    for (int k = 0; k < 200; k++) { // plates of every thinness: an error or a sound hull
        float thin = core_expf(-20.0f * random_unit());
        for (int i = 0; i < 64; i++) {
            p[i] = core_v3(random_sym(1), random_sym(thin), random_sym(1));
        }
        phys_geom_transform_points(p, 64, random_vec(1), random_quat());
        phys_geom_hull h;
        if (phys_geom_hull_build(&h, p, 64)) {
            check_hull(&h, p, 64, 2e-5f);
        } else {
            TEST_ASSERT_TRUE(thin < 1e-4f);
        }
        phys_geom_hull_release(&h);
    }
}

static void test_supports(void) {
    core_vec3 v[8];
    phys_geom_box_vertices(core_v3(1, 2, 3), v);
    uint32_t polygon[8], three[3], order[12];
    TEST_ASSERT_EQUAL_UINT32(4,
                             phys_geom_support_polygon(v, 8, core_v3(0, 1, 0), 1e-4f, polygon, 8));
    core_vec3 area = {0, 0, 0};
    for (int i = 1; i < 3; i++) {
        TEST_ASSERT_EQUAL_FLOAT(2, v[polygon[i]].y);
        area = core_v3_add(area, core_v3_cross(core_v3_sub(v[polygon[i]], v[polygon[0]]),
                                               core_v3_sub(v[polygon[i + 1]], v[polygon[0]])));
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 24, area.y); // twice the face of 2 x 6 m, turning about +y
    phys_geom_sweep_sort(v, 8, core_v3(1, 0, 0), order);
    for (int i = 1; i < 8; i++) {
        TEST_ASSERT_TRUE(v[order[i - 1]].x < v[order[i]].x ||
                         (v[order[i - 1]].x <= v[order[i]].x && order[i - 1] < order[i]));
    }
    for (int k = 0; k < 500; k++) {
        core_vec3 p[12], d = random_vec(1);
        for (int i = 0; i < 12; i++) {
            p[i] = random_vec(1);
        }
        phys_geom_support_triangle(p, 12, d, three);
        phys_geom_sweep_sort(p, 12, core_v3_scale(d, -1), order);
        for (int i = 0; i < 3; i++) {
            TEST_ASSERT_EQUAL_UINT32(order[i], three[i]);
        }
    }
}

static float polygon_area(const core_vec3 *p, uint32_t n) {
    core_vec3 sum = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < n; i++) {
        sum = core_v3_add(sum, core_v3_cross(core_v3_sub(p[i], p[0]), core_v3_sub(p[i + 1], p[0])));
    }
    return 0.5f * core_v3_length(sum);
}

static void test_contact_polygon(void) {
    const core_vec3 a[4] = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
    const core_vec3 b[4] = {{0, 0, 0}, {0, 0, 3}, {3, 0, 3}, {3, 0, 0}};
    const core_vec3 far[3] = {{5, 0, 5}, {6, 0, 5}, {5, 0, 6}};
    core_vec3 out[16];
    for (int flip = -1; flip <= 1; flip += 2) {
        uint32_t n = phys_geom_intersect_supports(a, 4, b, 4, core_v3(0, (float)flip, 0), out, 16);
        TEST_ASSERT_EQUAL_UINT32(4, n);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, polygon_area(out, n));
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.5f, phys_geom_average(out, n).x);
    }
    TEST_ASSERT_EQUAL_UINT32(0,
                             phys_geom_intersect_supports(a, 4, far, 3, core_v3(0, 1, 0), out, 16));
    uint32_t triangles[9];
    TEST_ASSERT_EQUAL_UINT32(9, phys_geom_triangulate_polygon(5, triangles));
    TEST_ASSERT_EQUAL_UINT32(4, triangles[8]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_box_has_six_faces);
    RUN_TEST(test_random_clouds);
    RUN_TEST(test_sphere_of_many_points);
    RUN_TEST(test_cube_of_a_grid);
    RUN_TEST(test_bad_input);
    RUN_TEST(test_supports);
    RUN_TEST(test_contact_polygon);
    return UNITY_END();
}
