// Cluster lists against the exact distance of spheres and cells: none missing, few too many, the
// same on every instruction set and number of threads. The grid against its own equations.
#include "gfx/gfx_cluster.h"

#include "core/rng.h"
#include "core/simd.h"
#include "ref/frustum.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) { core_simd_use(core_simd_best()); }

static const float near_plane = 0.1f, far = 100.0f;

static gfx_cluster_grid make_grid(uint32_t x, uint32_t y, uint32_t z, bool linear, bool ortho) {
    gfx_cluster_grid g;
    const uint32_t size[3] = {x, y, z};
    float tan_y = ortho ? 20.0f : 0.57735f;
    gfx_cluster_grid_make(&g, size, linear, 5.0f, ortho, tan_y * 16.0f / 9.0f, tan_y, near_plane,
                          far);
    return g;
}

// Lights of a flat scene seen from one edge of it, some behind the camera, some round it.
static void random_lights(gfx_cluster_lights *l, uint32_t n, float radius, uint64_t seed) {
    core_rng rng = core_rng_make(seed, 1);
    gfx_cluster_lights_reserve(l, n);
    for (uint32_t i = 0; i < n; ++i) {
        l->x[i] = 100.0f * core_rng_float(&rng) - 50.0f;
        l->y[i] = 10.0f * core_rng_float(&rng) - 4.0f;
        l->depth[i] = 120.0f * core_rng_float(&rng) - 12.0f;
        l->radius[i] = radius * (0.2f + 1.6f * core_rng_float(&rng));
    }
}

static void cell_corners(const gfx_cluster_grid *g, uint32_t cell, double out[8][3]) {
    uint32_t i = cell % g->columns, j = cell / g->columns % g->rows;
    uint32_t k = cell / (g->columns * g->rows);
    for (int c = 0; c < 8; ++c) {
        double depth = g->depth[k + (uint32_t)(c >> 2)], scale = g->orthographic ? 1.0 : depth;
        out[c][0] = g->x[i + (uint32_t)(c & 1)] * scale;
        out[c][1] = g->y[j + (uint32_t)(c >> 1 & 1)] * scale;
        out[c][2] = depth;
    }
}

static bool listed(const gfx_clusters *c, uint32_t cell, uint32_t light) {
    for (uint32_t i = c->offset[cell]; i < c->offset[cell + 1]; ++i) {
        if (c->light[i] == light) {
            return true;
        }
    }
    return false;
}

static void expect_ascending(const gfx_clusters *c, uint32_t cells) {
    TEST_ASSERT_EQUAL_UINT32(0, c->offset[0]);
    TEST_ASSERT_EQUAL_UINT32(c->total, c->offset[cells]);
    for (uint32_t cell = 0; cell < cells; ++cell) {
        TEST_ASSERT_TRUE(c->offset[cell] <= c->offset[cell + 1]);
        for (uint32_t i = c->offset[cell] + 1; i < c->offset[cell + 1]; ++i) {
            TEST_ASSERT_TRUE(c->light[i - 1] < c->light[i]);
        }
    }
}

// Pairs by the exact distance; every one must be in the lists.
static uint32_t expect_complete(const gfx_cluster_grid *g, const gfx_cluster_lights *l,
                                const gfx_clusters *c) {
    uint32_t exact = 0, missing = 0;
    for (uint32_t cell = 0; cell < gfx_cluster_cells(g); ++cell) {
        double corner[8][3];
        cell_corners(g, cell, corner);
        for (uint32_t n = 0; n < l->count; ++n) {
            const double p[3] = {l->x[n], l->y[n], l->depth[n]};
            if (ref_hexahedron_distance((const double(*)[3])corner, p) <= (double)l->radius[n]) {
                exact++;
                missing += !listed(c, cell, n);
            }
        }
    }
    accuracy_at_most("gfx: cells without a light that reaches them", missing, 0.0, "cells");
    return exact;
}

static void test_lists_against_exact_distance(void) {
    const struct {
        uint32_t size[3];
        bool linear, ortho;
        float radius;
    } cases[] = {{{16, 9, 24}, false, false, 5.0f},
                 {{16, 9, 24}, true, false, 5.0f},
                 {{20, 7, 12}, false, true, 5.0f},
                 {{5, 3, 8}, false, false, 30.0f},
                 {{40, 20, 4}, false, false, 1.0f}};
    double worst = 0.0;
    for (size_t i = 0; i < CORE_COUNT_OF(cases); ++i) {
        gfx_cluster_grid g = make_grid(cases[i].size[0], cases[i].size[1], cases[i].size[2],
                                       cases[i].linear, cases[i].ortho);
        gfx_cluster_lights l = {0};
        random_lights(&l, 130, cases[i].radius, 11 + i);
        for (int m = 0; m < GFX_CLUSTER_METHODS; ++m) {
            gfx_clusters c = {0};
            gfx_clusters_assign(&c, &g, &l, (gfx_cluster_method)m, NULL);
            expect_ascending(&c, gfx_cluster_cells(&g));
            uint32_t exact = expect_complete(&g, &l, &c);
            double ratio = (double)c.total / exact;
            printf("%ux%ux%u %s: %u entries, %.3f of the exact pairs\n", g.columns, g.rows,
                   g.slices, gfx_cluster_method_name((gfx_cluster_method)m), c.total, ratio);
            worst = m == GFX_CLUSTER_SIMD ? fmax(worst, ratio) : worst;
            gfx_clusters_release(&c);
        }
        gfx_cluster_lights_release(&l);
    }
    accuracy_at_most("gfx: entries of cluster lists, part of the exact ones", worst, 1.10, "1");
}

// Lights that hold the camera, cross the near plane, stand behind it, or are degenerate.
static void test_extreme_lights(void) {
    const float lights[][4] = {
        {0, 0, 0, 1},       {0, 0, -1, 1.05f},   {0.5f, 0.2f, 0.05f, 0.4f},
        {0, 0, 50, 500},    {0, 0, -5, 4.9f},    {0, 0, -5, 5.2f},
        {3, 0, 0, 3.2f},    {0, -2, 0.1f, 2.5f}, {1e6f, 0, 0, 10},
        {0, 0, 1e7f, 1e3f}, {0, 0, 104, 5},      {0, 0, 106, 5},
        {0, 0, 5, 1e-6f},   {57.7f, 0, 50, 20},  {-80, 30, 60, 25},
        {0, 0, 100, 1e5f},
    };
    gfx_cluster_lights l = {0};
    gfx_cluster_lights_reserve(&l, CORE_COUNT_OF(lights));
    for (uint32_t i = 0; i < l.count; ++i) {
        l.x[i] = lights[i][0], l.y[i] = lights[i][1];
        l.depth[i] = lights[i][2], l.radius[i] = lights[i][3];
    }
    for (int ortho = 0; ortho < 2; ++ortho) {
        gfx_cluster_grid g = make_grid(16, 9, 24, false, ortho);
        for (int m = 0; m < GFX_CLUSTER_METHODS; ++m) {
            gfx_clusters c = {0};
            gfx_clusters_assign(&c, &g, &l, (gfx_cluster_method)m, NULL);
            expect_ascending(&c, gfx_cluster_cells(&g));
            expect_complete(&g, &l, &c);
            for (uint32_t cell = 0; cell < gfx_cluster_cells(&g); ++cell) {
                TEST_ASSERT_FALSE(listed(&c, cell, 11)); // wholly beyond the virtual far plane
                TEST_ASSERT_FALSE(listed(&c, cell, 4));  // wholly behind the camera
            }
            gfx_clusters_release(&c);
        }
    }
    gfx_cluster_lights_release(&l);
}

static void test_same_lists_on_every_set_and_thread_count(void) {
    gfx_cluster_grid g = make_grid(16, 9, 24, false, false);
    gfx_cluster_lights l = {0};
    random_lights(&l, 3000, 5.0f, 5);
    gfx_clusters first = {0};
    core_simd_use(CORE_SIMD_SSE2);
    gfx_clusters_assign(&first, &g, &l, GFX_CLUSTER_SIMD, NULL);
    TEST_ASSERT_GREATER_THAN(10000, first.total);
    for (int set = CORE_SIMD_SSE2; set <= (int)core_simd_best(); ++set) {
        for (int threads = 1; threads <= 3; ++threads) {
            core_jobs *jobs = core_jobs_create(threads);
            gfx_clusters c = {0};
            core_simd_use((core_simd_set)set);
            gfx_clusters_assign(&c, &g, &l, GFX_CLUSTER_SIMD, jobs);
            TEST_ASSERT_EQUAL_UINT32(first.total, c.total);
            TEST_ASSERT_EQUAL_INT(0, memcmp(first.light, c.light, c.total * sizeof *c.light));
            TEST_ASSERT_EQUAL_INT(
                0, memcmp(first.offset, c.offset, (gfx_cluster_cells(&g) + 1) * sizeof *c.offset));
            gfx_clusters_release(&c);
            core_jobs_destroy(jobs);
        }
    }
    gfx_clusters_release(&first);
    gfx_cluster_lights_release(&l);
}

// z_k = near (far/near)^(k/slices) without a first slice; cells of points are those of the bounds.
static void test_grid_equations(void) {
    gfx_cluster_grid g;
    const uint32_t size[3] = {16, 9, 24};
    gfx_cluster_grid_make(&g, size, false, 0.0f, false, 1.0f, 0.5625f, near_plane, far);
    for (uint32_t k = 0; k <= 24; ++k) {
        double want = near_plane * pow((double)far / near_plane, k / 24.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * want, want, g.depth[k]);
    }
    core_rng rng = core_rng_make(9, 1);
    bool used[24] = {false};
    for (int i = 0; i < 100000; ++i) {
        float u = core_rng_float(&rng), v = core_rng_float(&rng);
        float depth = near_plane * powf(far / near_plane, core_rng_float(&rng));
        uint32_t cell = gfx_cluster_cell(&g, u, v, depth);
        uint32_t x = cell % 16, y = cell / 16 % 9, z = cell / 144;
        used[z] = true;
        float sx = 2.0f * u - 1.0f, sy = (2.0f * v - 1.0f) * 0.5625f; // slopes
        TEST_ASSERT_TRUE(sx >= g.x[x] - 1e-6f && sx <= g.x[x + 1] + 1e-6f);
        TEST_ASSERT_TRUE(sy >= g.y[y] - 1e-6f && sy <= g.y[y + 1] + 1e-6f);
        TEST_ASSERT_TRUE(depth >= g.depth[z] * 0.99999f && depth <= g.depth[z + 1] * 1.00001f);
    }
    for (int k = 0; k < 24; ++k) {
        TEST_ASSERT_TRUE(used[k]);
    }
}

// A point inside a light's sphere finds the light in its cell's list.
static void test_points_find_their_lights(void) {
    gfx_cluster_grid g = make_grid(16, 9, 24, false, false);
    gfx_cluster_lights l = {0};
    gfx_clusters c = {0};
    random_lights(&l, 2000, 5.0f, 21);
    gfx_clusters_assign(&c, &g, &l, GFX_CLUSTER_SIMD, NULL);
    core_rng rng = core_rng_make(4, 1);
    uint32_t tested = 0;
    for (int i = 0; i < 200000; ++i) {
        uint32_t n = core_rng_below(&rng, l.count);
        float p[3], d2 = 0.0f;
        for (int k = 0; k < 3; ++k) {
            p[k] = (2.0f * core_rng_float(&rng) - 1.0f) * l.radius[n];
            d2 += p[k] * p[k];
        }
        p[0] += l.x[n], p[1] += l.y[n], p[2] += l.depth[n];
        float u = 0.5f + 0.5f * p[0] / (p[2] * g.tan_x), v = 0.5f + 0.5f * p[1] / (p[2] * g.tan_y);
        if (d2 <= l.radius[n] * l.radius[n] && p[2] >= near_plane && p[2] <= far && u >= 0.0f &&
            u < 1.0f && v >= 0.0f && v < 1.0f) {
            tested++;
            TEST_ASSERT_TRUE(listed(&c, gfx_cluster_cell(&g, u, v, p[2]), n));
        }
    }
    TEST_ASSERT_GREATER_THAN(20000, tested);
    gfx_clusters_release(&c);
    gfx_cluster_lights_release(&l);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_lists_against_exact_distance);
    RUN_TEST(test_extreme_lights);
    RUN_TEST(test_same_lists_on_every_set_and_thread_count);
    RUN_TEST(test_grid_equations);
    RUN_TEST(test_points_find_their_lights);
    return UNITY_END();
}
