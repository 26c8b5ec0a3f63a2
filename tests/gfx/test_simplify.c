// Levels of detail of meshes: how far they are off, by brute force; that surfaces stay closed and
// seams whole; what is seen of them.
#include "gfx/gfx_simplify.h"
#include "support/gfx_fixture.h"

#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

// A knobbly ball: rings of longitude u with a seam of texture coordinates where they close.
enum { RINGS = 48, SEGMENTS = 64, VERTICES = (RINGS + 1) * (SEGMENTS + 1) };
static float position[VERTICES * 3], uv[VERTICES * 2];
static uint32_t index_of[RINGS * SEGMENTS * 6];

static core_mesh_data ball(void) {
    uint32_t n = 0;
    for (int k = 0; k <= RINGS; ++k) {
        for (int i = 0; i <= SEGMENTS; ++i) {
            int v = k * (SEGMENTS + 1) + i;
            float phi = 2 * CORE_PI_F * (float)(i % SEGMENTS) / SEGMENTS;
            float theta = CORE_PI_F * (float)k / RINGS;
            float r = 1.0f + 0.12f * sinf(3 * phi) * sinf(2 * theta) * sinf(theta);
            bool pole = k == 0 || k == RINGS;
            position[3 * v] = pole ? 0.0f : r * sinf(theta) * cosf(phi);
            position[3 * v + 1] = r * cosf(theta);
            position[3 * v + 2] = pole ? 0.0f : -r * sinf(theta) * sinf(phi);
            uv[2 * v] = (float)i / SEGMENTS, uv[2 * v + 1] = (float)k / RINGS;
        }
    }
    for (uint32_t k = 0; k < RINGS; ++k) {
        for (uint32_t i = 0; i < SEGMENTS; ++i) {
            uint32_t a = k * (SEGMENTS + 1) + i, b = a + SEGMENTS + 1;
            const uint32_t two[6] = {a, b, a + 1, a + 1, b, b + 1};
            memcpy(index_of + n, two, sizeof two);
            n += 6;
        }
    }
    return (core_mesh_data){.vertex_count = VERTICES,
                            .index_count = n,
                            .position = position,
                            .uv = uv,
                            .index = index_of};
}

static core_vec3 at(uint32_t v) {
    return core_v3(position[3 * v], position[3 * v + 1], position[3 * v + 2]);
}

// Distance of a point from a triangle (Ericson, "Real-Time Collision Detection", 5.1.5).
static float distance(core_vec3 p, core_vec3 a, core_vec3 b, core_vec3 c) {
    core_vec3 ab = core_v3_sub(b, a), ac = core_v3_sub(c, a), ap = core_v3_sub(p, a);
    float d1 = core_v3_dot(ab, ap), d2 = core_v3_dot(ac, ap);
    core_vec3 bp = core_v3_sub(p, b), cp = core_v3_sub(p, c), q;
    float d3 = core_v3_dot(ab, bp), d4 = core_v3_dot(ac, bp);
    float d5 = core_v3_dot(ab, cp), d6 = core_v3_dot(ac, cp);
    float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (d1 <= 0 && d2 <= 0) {
        q = a;
    } else if (d3 >= 0 && d4 <= d3) {
        q = b;
    } else if (d6 >= 0 && d5 <= d6) {
        q = c;
    } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        q = core_v3_mad(a, ab, d1 / (d1 - d3));
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        q = core_v3_mad(a, ac, d2 / (d2 - d6));
    } else if (va <= 0 && d4 >= d3 && d5 >= d6) {
        q = core_v3_mad(b, core_v3_sub(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    } else {
        float w = 1 / (va + vb + vc);
        q = core_v3_mad(core_v3_mad(a, ab, vb * w), ac, vc * w);
    }
    return core_v3_length(core_v3_sub(p, q));
}

// Farthest that any vertex or face centre of the ball lies from a simplified surface.
static float farthest(const core_mesh_data *m, const uint32_t *index, uint32_t triangles) {
    float worst = 0;
    for (uint32_t i = 0; i < m->index_count; i += 3) {
        core_vec3 p = at(m->index[i]);
        if (i & 1) {
            p = core_v3_add(p, core_v3_add(at(m->index[i + 1]), at(m->index[i + 2])));
            p = core_v3_scale(p, 1.0f / 3.0f);
        }
        float least = 1e9f;
        for (uint32_t t = 0; t < triangles; ++t) {
            const uint32_t *v = index + 3 * t;
            least = CORE_MIN(least, distance(p, at(v[0]), at(v[1]), at(v[2])));
        }
        worst = CORE_MAX(worst, least);
    }
    return worst;
}

static void test_error_bounds_the_distance(void) {
    core_mesh_data m = ball();
    gfx_simplifier *s = gfx_simplifier_create(&m);
    float last = 0;
    uint32_t triangles = m.index_count / 3 - 2 * SEGMENTS; // the poles' are flat
    for (int level = 0; level < 5; ++level) {
        uint32_t want = triangles / 2;
        triangles = gfx_simplify(s, want, 1.0f);
        TEST_ASSERT_UINT32_WITHIN(2, want, triangles);
        float error = gfx_simplifier_error(s);
        float truth = farthest(&m, gfx_simplifier_index(s), triangles);
        TEST_ASSERT_TRUE(error > last && truth <= error * 1.0001f);
        TEST_ASSERT_TRUE(truth > 0.7f * error);
        last = error;
    }
    accuracy_at_most("mesh of a thirty-second of its triangles", (double)last, 0.12,
                     "of its radius");
    gfx_simplifier_destroy(s);
}

// Every edge has two faces, by positions, and texture coordinates stay on their side of the seam.
static void test_surfaces_stay_closed_and_seams_whole(void) {
    core_mesh_data m = ball();
    gfx_simplifier *s = gfx_simplifier_create(&m);
    uint32_t triangles = gfx_simplify(s, 400, 1.0f);
    const uint32_t *index = gfx_simplifier_index(s);
    for (uint32_t t = 0; t < triangles; ++t) {
        const uint32_t *v = index + 3 * t;
        for (int k = 0; k < 3; ++k) {
            core_vec3 a = at(v[k]), b = at(v[(k + 1) % 3]);
            int back = 0;
            for (uint32_t o = 0; o < triangles * 3; ++o) {
                core_vec3 c = at(index[o]), d = at(index[o - o % 3 + (o + 1) % 3]);
                back += memcmp(&a, &d, sizeof a) == 0 && memcmp(&b, &c, sizeof b) == 0;
            }
            TEST_ASSERT_EQUAL_INT(1, back);
            bool pole = (a.x == 0 && a.z == 0) || (b.x == 0 && b.z == 0);
            float du = fabsf(uv[2 * v[k]] - uv[2 * v[(k + 1) % 3]]);
            TEST_ASSERT_TRUE(pole || du < 0.5f); // no face spans the picture
        }
    }
    gfx_simplifier_destroy(s);
}

// A flat sheet needs two triangles, whatever it was made of, and keeps its outline.
static void test_flat_sheets_and_borders(void) {
    enum { N = 20 };
    float p[N * N * 3];
    uint32_t index[(N - 1) * (N - 1) * 6], n = 0;
    for (int i = 0; i < N * N; ++i) {
        p[3 * i] = (float)(i % N), p[3 * i + 1] = 0, p[3 * i + 2] = (float)(i / N);
    }
    for (uint32_t z = 0; z + 1 < N; ++z) {
        for (uint32_t x = 0; x + 1 < N; ++x) {
            uint32_t a = z * N + x;
            const uint32_t two[6] = {a, a + N, a + 1, a + 1, a + N, a + N + 1};
            memcpy(index + n, two, sizeof two);
            n += 6;
        }
    }
    core_mesh_data m = {.vertex_count = N * N, .index_count = n, .position = p, .index = index};
    gfx_simplifier *s = gfx_simplifier_create(&m);
    uint32_t triangles = gfx_simplify(s, 0, 1e-3f);
    const uint32_t *out = gfx_simplifier_index(s);
    float area = 0;
    for (uint32_t t = 0; t < triangles; ++t) {
        const float *a = p + 3 * out[3 * t], *b = p + 3 * out[3 * t + 1],
                    *c = p + 3 * out[3 * t + 2];
        area += 0.5f * ((b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]));
    }
    TEST_ASSERT_LESS_THAN(9, triangles);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 361.0f, area);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.0f, gfx_simplifier_error(s));
    gfx_simplifier_destroy(s);
}

// At any distance the picture with levels is that without within a pixel of the outline, and far
// away it is made of far fewer triangles.
static void test_levels_do_not_show(void) {
    enum { W = 128 };
    gfx_fixture f = gfx_fixture_open(W, W, true);
    core_mesh_data m = ball();
    gfx_mesh mesh = gfx_mesh_create(f.world, &m);
    gfx_mesh_level level[8];
    uint32_t levels = gfx_mesh_levels(f.world, mesh, level, 8), least = UINT32_MAX;
    TEST_ASSERT_TRUE(levels >= 5);
    for (uint32_t i = 1; i < levels && i < 8; ++i) {
        TEST_ASSERT_TRUE(level[i].triangles <= level[i - 1].triangles * 3 / 4);
        TEST_ASSERT_TRUE(level[i].error >= level[i - 1].error);
    }
    gfx_instance_desc d = {.mesh = mesh};
    gfx_instance_create(f.world, &d);
    for (float z = 2.0f; z < 200.0f; z *= 1.3f) {
        float *depth[2];
        gfx_look(f.world, core_v3(0.3f * z, 0.2f * z, z), core_v3(0, 0, 0));
        for (int on = 0; on < 2; ++on) {
            TEST_ASSERT_TRUE(gfx_world_set(f.world, "levels", on ? "on" : "off"));
            TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
            depth[on] = core_alloc(W * W * sizeof(float));
            TEST_ASSERT_TRUE(gfx_device_read_depth(f.device, depth[on]));
        }
        least = CORE_MIN(least, gfx_world_stats(f.world).triangles);
        for (int y = 1; y < W - 1; ++y) {
            for (int x = 1; x < W - 1; ++x) {
                int around = 0;
                for (int k = 0; k < 9; ++k) {
                    around += depth[0][(y + k / 3 - 1) * W + x + k % 3 - 1] > 0;
                }
                bool covered = depth[1][y * W + x] > 0; // all or none around: no choice
                TEST_ASSERT_TRUE(around > 0 || !covered);
                TEST_ASSERT_TRUE(around < 9 || covered);
            }
        }
        core_free(depth[0]);
        core_free(depth[1]);
    }
    TEST_ASSERT_TRUE(least <= level[4].triangles);
    uint32_t stay = gfx_mesh_levels(f.world, gfx_mesh_builtin(f.world, "sphere"), NULL, 0);
    TEST_ASSERT_EQUAL_UINT32(3, stay);
    TEST_ASSERT_TRUE(gfx_mesh_destroy(f.world, mesh)); // with its levels
    TEST_ASSERT_EQUAL_UINT32(0, gfx_mesh_levels(f.world, mesh, NULL, 0));
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_error_bounds_the_distance);
    RUN_TEST(test_surfaces_stay_closed_and_seams_whole);
    RUN_TEST(test_flat_sheets_and_borders);
    RUN_TEST(test_levels_do_not_show);
    return UNITY_END();
}
