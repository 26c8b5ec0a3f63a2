// Geometry: skinning against the processor, instancing against single draws, culling, depth.
#include "support/gfx_fixture.h"

#include "core/rng.h"
#include "gfx/gfx_cull.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

// A bent strip: quads along y, each vertex weighted to up to four of five bones.
enum { STEPS = 24, BONES = 5, VERTICES = (STEPS + 1) * 2 };
typedef struct strip {
    float position[VERTICES * 3], normal[VERTICES * 3], weight[VERTICES * 4];
    uint16_t joint[VERTICES * 4];
    uint32_t index[STEPS * 6];
} strip;

static void strip_make(strip *s) {
    memset(s, 0, sizeof *s);
    for (int k = 0; k <= STEPS; ++k) {
        for (int side = 0; side < 2; ++side) {
            int v = 2 * k + side;
            float y = 4.0f * (float)k / STEPS;
            s->position[3 * v] = side ? 0.4f : -0.4f;
            s->position[3 * v + 1] = y;
            s->normal[3 * v + 2] = 1.0f;
            float at = y; // bones stand at y = 0 .. 4
            int bone = (int)at < BONES - 1 ? (int)at : BONES - 2;
            s->joint[4 * v] = (uint16_t)bone;
            s->joint[4 * v + 1] = (uint16_t)(bone + 1);
            s->joint[4 * v + 2] = 0;
            s->weight[4 * v + 2] = 0.125f;
            s->weight[4 * v + 1] = 0.875f * (at - (float)bone);
            s->weight[4 * v] = 0.875f - s->weight[4 * v + 1];
        }
    }
    for (uint32_t k = 0; k < STEPS; ++k) {
        uint32_t *i = s->index + 6 * k, v = 2 * k;
        const uint32_t quad[6] = {v, v + 1, v + 2, v + 2, v + 1, v + 3};
        memcpy(i, quad, sizeof quad);
    }
}

static void bone_rows(float rows[BONES][12]) {
    for (int b = 0; b < BONES; ++b) {
        float angle = 0.25f * (float)b, c = cosf(angle), s = sinf(angle);
        const float m[12] = {c,    -s,   0.0f, 0.2f * (float)b, s, c, 0.0f, -0.1f * (float)b,
                             0.0f, 0.0f, 1.0f, 0.3f * (float)b};
        memcpy(rows[b], m, sizeof m);
    }
}

static void skin_on_processor(const strip *s, float rows[BONES][12], float *position) {
    for (int v = 0; v < VERTICES; ++v) {
        double p[4] = {s->position[3 * v], s->position[3 * v + 1], s->position[3 * v + 2], 1.0};
        for (int r = 0; r < 3; ++r) {
            double sum = 0.0;
            for (int k = 0; k < 4; ++k) {
                for (int c = 0; c < 4; ++c) {
                    sum += (double)s->weight[4 * v + k] *
                           (double)rows[s->joint[4 * v + k]][4 * r + c] * p[c];
                }
            }
            position[3 * v + r] = (float)sum;
        }
    }
}

static float *depth_of(gfx_fixture *f) {
    float *depth = core_alloc((size_t)f->width * f->height * sizeof *depth);
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f->device, f->world), core_last_error());
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_read_depth(f->device, depth), core_last_error());
    return depth;
}

// The picture of the skinned strip is that of a strip skinned beforehand: same pixels, and depth
// within 1e-5 of the distance.
static void test_skinning(void) {
    enum { SIZE = 128 };
    gfx_fixture f = gfx_fixture_open(SIZE, SIZE, true);
    strip s;
    float rows[BONES][12], skinned[VERTICES * 3];
    strip_make(&s);
    bone_rows(rows);
    skin_on_processor(&s, rows, skinned);
    core_mesh_data data = {.vertex_count = VERTICES,
                           .index_count = STEPS * 6,
                           .position = s.position,
                           .normal = s.normal,
                           .index = s.index,
                           .joint = s.joint,
                           .weight = s.weight};
    gfx_instance_desc desc = {.mesh = gfx_mesh_create(f.world, &data)};
    gfx_instance i = gfx_instance_create(f.world, &desc);
    TEST_ASSERT_FALSE(gfx_instance_set_palette(f.world, i, rows[0], BONES - 1)); // too few
    TEST_ASSERT_TRUE_MESSAGE(gfx_instance_set_palette(f.world, i, rows[0], BONES),
                             core_last_error());
    gfx_look(f.world, core_v3(-1, 2, 7), core_v3(-1, 2, 0));
    float *a = depth_of(&f);
    gfx_instance_destroy(f.world, i);
    data.joint = NULL, data.weight = NULL;
    data.position = skinned;
    desc.mesh = gfx_mesh_create(f.world, &data);
    gfx_instance_create(f.world, &desc);
    float *b = depth_of(&f);
    uint32_t covered = 0, differ = 0;
    for (int p = 0; p < SIZE * SIZE; ++p) {
        covered += a[p] > 0.0f;
        if ((a[p] > 0.0f) != (b[p] > 0.0f)) {
            differ++; // an edge through a pixel's centre
        } else if (b[p] > 0.0f) {
            TEST_ASSERT_FLOAT_WITHIN(1e-5f * b[p], b[p], a[p]);
        }
    }
    TEST_ASSERT_GREATER_THAN(400, covered);
    TEST_ASSERT_LESS_THAN(4, differ);
    core_free(a);
    core_free(b);
    gfx_fixture_close(&f);
}

static void scatter(gfx_fixture *f, int n) {
    core_rng rng = core_rng_make(3, 1);
    const char *const meshes[] = {"box", "sphere", "capsule", "cylinder"};
    for (int i = 0; i < n; ++i) {
        core_vec3 p = {20.0f * (core_rng_float(&rng) - 0.5f), 20.0f * (core_rng_float(&rng) - 0.5f),
                       20.0f * (core_rng_float(&rng) - 0.5f)};
        gfx_add(f->world, meshes[i % 4], p, core_v3(1, 0.5f + core_rng_float(&rng), 1),
                core_rng_float(&rng), 0.5f, 0.5f);
    }
    gfx_add_sun(f->world, core_v3(-1, -1, -1), 3.0f);
}

static void test_instancing_equals_single_draws(void) {
    gfx_fixture f = gfx_fixture_open(96, 64, true);
    core_metrics *m = core_metrics_create();
    scatter(&f, 200);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "shadows", "off"));
    gfx_look(f.world, core_v3(0, 0, 30), core_v3(0, 0, 0));
    float *a = gfx_fixture_hdr(&f);
    gfx_world_counts(f.world, m);
    TEST_ASSERT_EQUAL_DOUBLE(8.0, core_metrics_get(m, CORE_COUNT_DRAWS)); // depth, then shading
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "instancing", "off"));
    float *b = gfx_fixture_hdr(&f);
    gfx_world_counts(f.world, m);
    TEST_ASSERT_EQUAL_DOUBLE(400.0, core_metrics_get(m, CORE_COUNT_DRAWS));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, gfx_max_difference(a, b, 96 * 64 * 4));
    core_free(a);
    core_free(b);
    core_metrics_destroy(m);
    gfx_fixture_close(&f);
}

// The same triangles give the same depth in both passes, so shading finds every fragment again.
static void test_prepass_changes_nothing(void) {
    gfx_fixture f = gfx_fixture_open(96, 64, true);
    scatter(&f, 200);
    gfx_look(f.world, core_v3(0, 0, 30), core_v3(0, 0, 0));
    float *a = gfx_fixture_hdr(&f);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "prepass", "off"));
    float *b = gfx_fixture_hdr(&f);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, gfx_max_difference(a, b, 96 * 64 * 4));
    core_free(a);
    core_free(b);
    gfx_fixture_close(&f);
}

// Coarser meshes far away: fewer triangles, and a picture that differs at few silhouettes.
// Mirrored boxes and spheres look as they do unmirrored, shadows included; a mirrored plane shows
// its upper side, and one turned over by its scale does not.
static void test_mirrored_instances(void) {
    gfx_fixture f = gfx_fixture_open(96, 64, true);
    gfx_add_sun(f.world, core_v3(-0.4f, -1.0f, -0.7f), 3.0f);
    gfx_add(f.world, "plane", core_v3(0, -1, 0), core_v3(20, 1, 20), 0.8f, 0.8f, 0.8f);
    gfx_look(f.world, core_v3(1, 3, 7), core_v3(0, 0, 0));
    gfx_instance box = gfx_add(f.world, "box", core_v3(-1, 0, 0), core_v3(1, 2, 1), 0.9f, 0.5f, 0);
    gfx_instance ball =
        gfx_add(f.world, "sphere", core_v3(1, 0, 0), core_v3(1, 1, 1), 0.1f, 0.5f, 0.9f);
    float *plain = gfx_fixture_hdr(&f);
    core_quat still = core_quat_identity();
    gfx_instance_set_transform(f.world, box, core_v3(-1, 0, 0), still, core_v3(-1, 2, 1));
    gfx_instance_set_transform(f.world, ball, core_v3(1, 0, 0), still, core_v3(-1, -1, -1));
    float *mirrored = gfx_fixture_hdr(&f);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.0f, gfx_max_difference(plain, mirrored, 96 * 64 * 4));
    gfx_world_set(f.world, "instancing", "off");
    float *single = gfx_fixture_hdr(&f);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, gfx_max_difference(single, mirrored, 96 * 64 * 4));
    core_free(plain);
    core_free(mirrored);
    core_free(single);
    gfx_instance_destroy(f.world, box);
    gfx_instance_destroy(f.world, ball);
    for (int turned = 0; turned < 2; ++turned) {
        gfx_fixture g = gfx_fixture_open(96, 64, true);
        gfx_instance plane = gfx_add(g.world, "plane", core_v3(0, 0, 0), core_v3(9, 1, 9), 1, 1, 1);
        gfx_look(g.world, core_v3(0, 3, 7), core_v3(0, 0, 0));
        gfx_instance_set_transform(g.world, plane, core_v3(0, 0, 0), still,
                                   turned ? core_v3(9, -1, 9) : core_v3(-9, 1, 9));
        float *depth = depth_of(&g);
        TEST_ASSERT_TRUE((depth[96 * 32 + 48] > 0.0f) == !turned);
        core_free(depth);
        gfx_fixture_close(&g);
    }
    gfx_fixture_close(&f);
}

static void test_levels_of_detail(void) {
    gfx_fixture f = gfx_fixture_open(192, 128, true);
    scatter(&f, 200);
    gfx_look(f.world, core_v3(0, 0, 34), core_v3(0, 0, 0));
    uint8_t *a = gfx_fixture_ldr(&f);
    uint32_t coarse = gfx_world_stats(f.world).triangles;
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "levels", "off"));
    uint8_t *b = gfx_fixture_ldr(&f);
    uint32_t fine = gfx_world_stats(f.world).triangles;
    uint32_t differ = 0;
    for (int i = 0; i < 192 * 128; ++i) {
        int d = a[4 * i] - b[4 * i];
        differ += d > 12 || d < -12;
    }
    printf("levels: %u triangles of %u, %u pixels of %d differ by more than 12 of 255\n", coarse,
           fine, differ, 192 * 128);
    TEST_ASSERT_TRUE(coarse * 4 < fine);
    TEST_ASSERT_LESS_THAN(192 * 128 / 100, differ);
    core_free(a);
    core_free(b);
    gfx_fixture_close(&f);
}

// Whatever is culled was not in the picture: the same things as one mesh, which is never culled in
// part, leave the same depth.
static void test_culling_loses_nothing(void) {
    gfx_fixture f = gfx_fixture_open(96, 64, true);
    scatter(&f, 300);
    const core_vec3 eyes[][2] = {
        {{0, 0, 0}, {1, 0.2f, 0.3f}}, {{9, 9, 9}, {0, 0, 0}}, {{0, 0, 12}, {4, 0, 0}}};
    for (size_t i = 0; i < CORE_COUNT_OF(eyes); ++i) {
        gfx_look(f.world, eyes[i][0], eyes[i][1]);
        float *culled = depth_of(&f);
        gfx_world_set(f.world, "culling", "off");
        float *whole = depth_of(&f);
        gfx_world_set(f.world, "culling", "on");
        TEST_ASSERT_EQUAL_FLOAT(0.0f, gfx_max_difference(culled, whole, 96 * 64));
        core_free(culled);
        core_free(whole);
    }
    gfx_fixture_close(&f);
}

// Every instruction set keeps the same rows, and those that a plain loop in doubles keeps but for
// spheres within rounding of a plane.
static void test_culling_on_every_set(void) {
    gfx_fixture f = gfx_fixture_open(8, 8, true);
    scatter(&f, 1003);
    gfx_look(f.world, core_v3(2, 1, 6), core_v3(0, 3, 0));
    gfx_view view;
    gfx_camera camera = gfx_world_camera(f.world);
    gfx_view_make(&camera, 1.5f, &view);
    const gfx_instances *s = &f.world->instances;
    static uint32_t kept[2048], again[2048];
    uint32_t count = gfx_cull_sse2(s, &view, kept), at = 0;
    TEST_ASSERT_GREATER_THAN(50, count);
    TEST_ASSERT_LESS_THAN(900, count);
    for (uint32_t i = 0; i < 1003; ++i) {
        double least = INFINITY;
        for (int k = 0; k < GFX_PLANES; ++k) {
            const float *p = view.plane[k];
            double d = (double)p[0] * (double)s->cx[i] + (double)p[1] * (double)s->cy[i] +
                       (double)p[2] * (double)s->cz[i] + (double)p[3] + (double)s->cr[i];
            least = d < least ? d : least;
        }
        bool in = at < count && kept[at] == i;
        at += in;
        TEST_ASSERT_TRUE(fabs(least) < 1e-4 || in == (least >= 0.0));
    }
    if (core_simd_best() >= CORE_SIMD_AVX2) {
        TEST_ASSERT_EQUAL_UINT32(count, gfx_cull_avx2(s, &view, again));
        TEST_ASSERT_EQUAL_INT(0, memcmp(kept, again, count * sizeof *kept));
    }
    if (core_simd_best() >= CORE_SIMD_AVX512) {
        TEST_ASSERT_EQUAL_UINT32(count, gfx_cull_avx512(s, &view, again));
        TEST_ASSERT_EQUAL_INT(0, memcmp(kept, again, count * sizeof *kept));
    }
    gfx_fixture_close(&f);
}

// Reversed-Z without far plane: depth is near/distance within 1e-6 up to 1e6 m.
static void test_depth(void) {
    gfx_fixture f = gfx_fixture_open(9, 9, true);
    gfx_instance i = gfx_add(f.world, "plane", core_v3(0, 0, 0), core_v3(1, 1, 1), 1, 1, 1);
    core_quat up = core_quat_axis_angle(core_v3(1, 0, 0), 0.5f * CORE_PI_F); // faces +Z
    gfx_camera c = {.near_plane = 0.1f};
    gfx_world_set_camera(f.world, &c);
    double worst = 0.0;
    for (float d = 0.11f; d < 1.1e6f; d *= 3.7f) {
        gfx_instance_set_transform(f.world, i, core_v3(0, 0, -d), up, core_v3(4 * d, 1, 4 * d));
        float *depth = depth_of(&f);
        double want = 0.1f / (double)d;
        worst = fmax(worst, fabs((double)depth[4 * 9 + 4] / want - 1.0));
        core_free(depth);
    }
    accuracy_at_most("gfx: depth to 1e6 m, largest relative error", worst, 1e-6, "1");
    gfx_fixture_close(&f);
}

// Two planes 0.1 mm apart at 1 km: the nearer one is seen, whichever is drawn first.
static void test_depth_order_far_away(void) {
    for (int first = 0; first < 2; ++first) {
        gfx_fixture f = gfx_fixture_open(9, 9, true);
        core_quat up = core_quat_axis_angle(core_v3(1, 0, 0), 0.5f * CORE_PI_F);
        gfx_camera c = {.near_plane = 0.1f};
        gfx_world_set_camera(f.world, &c);
        gfx_world_set_ambient(f.world, 1, 1, 1);
        for (int k = 0; k < 2; ++k) {
            bool near_one = k == first;
            gfx_instance i = gfx_add(f.world, "plane", core_v3(0, 0, 0), core_v3(1, 1, 1), near_one,
                                     !near_one, 0);
            float z = near_one ? -1000.0f : -1000.0001f; // the nearest floats: 61 um steps
            gfx_instance_set_transform(f.world, i, core_v3(0, 0, z), up, core_v3(4e3f, 1, 4e3f));
        }
        float *rgba = gfx_fixture_hdr(&f);
        TEST_ASSERT_TRUE(rgba[4 * 40] > 2.0f * rgba[4 * 40 + 1]); // red
        core_free(rgba);
        gfx_fixture_close(&f);
    }
}

static void test_bad_input(void) {
    gfx_fixture f = gfx_fixture_open(8, 8, true);
    const float position[9] = {0, 0, 0, 1, 0, 0, 0, 1, NAN};
    const uint32_t index[3] = {0, 1, 2}, wild[3] = {0, 1, 7};
    core_mesh_data d = {.vertex_count = 3, .index_count = 3, .position = position, .index = index};
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_mesh_create(f.world, &d))); // NaN
    d.index = wild;
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_mesh_create(f.world, &d))); // out of range
    d.index_count = 2;
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_mesh_create(f.world, &d)));
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_mesh_builtin(f.world, "spere")));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), "\"sphere\""), core_last_error());
    const float radii[] = {0.0f, -1.0f, NAN, INFINITY};
    for (size_t i = 0; i < CORE_COUNT_OF(radii); ++i) {
        gfx_light_desc l = gfx_light_desc_default(GFX_POINT);
        l.radius = radii[i];
        TEST_ASSERT_TRUE(core_handle_is_null(gfx_light_create(f.world, &l)));
    }
    gfx_instance i = gfx_add(f.world, "box", core_v3(0, 0, -5), core_v3(0, 0, 0), 1, 1, 1);
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error()); // flat
    gfx_instance_set_transform(f.world, i, core_v3(NAN, 0, 0), core_quat_identity(),
                               core_v3(1, 1, 1));
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    TEST_ASSERT_TRUE(gfx_instance_destroy(f.world, i));
    TEST_ASSERT_FALSE(gfx_instance_destroy(f.world, i)); // stale
    TEST_ASSERT_FALSE(gfx_world_set(f.world, "rendr", "forward"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), "render"), core_last_error());
    TEST_ASSERT_FALSE(gfx_world_set(f.world, "clusters", "16x9"));
    TEST_ASSERT_FALSE(gfx_world_set(f.world, "exposure", "-1"));
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_skinning);
    RUN_TEST(test_instancing_equals_single_draws);
    RUN_TEST(test_prepass_changes_nothing);
    RUN_TEST(test_mirrored_instances);
    RUN_TEST(test_levels_of_detail);
    RUN_TEST(test_culling_loses_nothing);
    RUN_TEST(test_culling_on_every_set);
    RUN_TEST(test_depth);
    RUN_TEST(test_depth_order_far_away);
    RUN_TEST(test_bad_input);
    return UNITY_END();
}
