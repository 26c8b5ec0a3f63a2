// Spots in cluster lists: every cell that holds a point of the lit cone has the light, in every
// method; and few cells have it without need. The reference is brute force: points of the cone, and
// points of the cells.
#include "gfx/gfx_device_internal.h"

#include "core/rng.h"
#include "core/simd.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) { core_simd_use(core_simd_best()); }

enum { SPOTS = 48, CONE_POINTS = 30000, CELL_SIDE = 9 };

static gfx_world *spot_world(float least_angle, float most_angle, uint64_t seed) {
    gfx_world_desc desc = gfx_world_desc_default();
    gfx_world *world = gfx_world_create(&desc);
    core_rng rng = core_rng_make(seed, 1);
    for (int i = 0; i < SPOTS; ++i) {
        gfx_light_desc d = gfx_light_desc_default(GFX_SPOT);
        float x = core_rng_float(&rng), y = core_rng_float(&rng), z = core_rng_float(&rng);
        d.position = core_v3(60.0f * x - 30.0f, 12.0f * y - 4.0f, 70.0f * z - 60.0f);
        x = core_rng_float(&rng), y = core_rng_float(&rng), z = core_rng_float(&rng);
        d.direction = core_v3(2.0f * x - 1.0f, 2.0f * y - 1.0f, 2.0f * z - 1.0f);
        d.radius = 2.0f + 13.0f * core_rng_float(&rng);
        d.outer = least_angle + (most_angle - least_angle) * core_rng_float(&rng);
        d.inner = 0.5f * d.outer;
        gfx_light_create(world, &d);
    }
    return world;
}

// The camera stands among the lights and looks along -Z, so that view space is world space.
static gfx_view make_view(bool orthographic) {
    gfx_camera camera = {.ortho_height = orthographic ? 24.0f : 0.0f};
    gfx_view view;
    gfx_view_make(&camera, 16.0f / 9.0f, &view);
    return view;
}

static bool lit(const gfx_lights *l, uint32_t i, const double p[3]) {
    double d[3] = {p[0] - (double)l->px[i], p[1] - (double)l->py[i], p[2] - (double)l->pz[i]};
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    double along = d[0] * (double)l->dx[i] + d[1] * (double)l->dy[i] + d[2] * (double)l->dz[i];
    return length <= (double)l->radius[i] && along >= length * cos((double)l->outer[i]);
}

// Uniform on the part of the unit sphere round the axis, its rim included now and then.
static void cone_point(core_rng *rng, const gfx_lights *l, uint32_t i, double out[3]) {
    double least = cos((double)l->outer[i]), u = (double)core_rng_float(rng);
    double c = core_rng_below(rng, 4) ? least + (1.0 - least) * u : least, s = sqrt(1.0 - c * c);
    double turn = 6.283185307179586 * (double)core_rng_float(rng);
    double r = (double)l->radius[i] * cbrt((double)core_rng_float(rng));
    double a[3] = {(double)l->dx[i], (double)l->dy[i], (double)l->dz[i]};
    double h = fabs(a[1]) < 0.9 ? 1.0 / hypot(a[0], a[2]) : 1.0 / hypot(a[1], a[2]);
    double t[3] = {fabs(a[1]) < 0.9 ? a[2] * h : 0.0, fabs(a[1]) < 0.9 ? 0.0 : -a[2] * h,
                   fabs(a[1]) < 0.9 ? -a[0] * h : a[1] * h};
    double b[3] = {a[1] * t[2] - a[2] * t[1], a[2] * t[0] - a[0] * t[2], a[0] * t[1] - a[1] * t[0]};
    const double at[3] = {(double)l->px[i], (double)l->py[i], (double)l->pz[i]};
    for (int k = 0; k < 3; ++k) {
        out[k] = at[k] + r * (c * a[k] + s * (cos(turn) * t[k] + sin(turn) * b[k]));
    }
}

static bool cell_of(const gfx_cluster_grid *g, const double p[3], uint32_t *cell) {
    double depth = -p[2], scale = g->orthographic ? 1.0 : depth;
    if (depth < (double)g->near_plane || depth > (double)g->far) {
        return false;
    }
    double u = 0.5 + 0.5 * p[0] / (scale * (double)g->tan_x),
           v = 0.5 + 0.5 * p[1] / (scale * (double)g->tan_y);
    if (u < 0.0 || u >= 1.0 || v < 0.0 || v >= 1.0) {
        return false;
    }
    *cell = gfx_cluster_cell(g, (float)u, (float)v, (float)depth);
    return true;
}

// Whether a grid of points over a cell has one in the cone.
static bool cell_touches(const gfx_cluster_grid *g, uint32_t cell, const gfx_lights *l,
                         uint32_t light) {
    uint32_t i = cell % g->columns, j = cell / g->columns % g->rows,
             k = cell / (g->columns * g->rows);
    const double last = CELL_SIDE - 1;
    for (int n = 0; n < CELL_SIDE * CELL_SIDE * CELL_SIDE; ++n) {
        double u = n % CELL_SIDE / last, v = n / CELL_SIDE % CELL_SIDE / last;
        double w = n / (CELL_SIDE * CELL_SIDE) / last;
        double depth = (1 - w) * (double)g->depth[k] + w * (double)g->depth[k + 1];
        double scale = g->orthographic ? 1.0 : depth;
        const double p[3] = {((1 - u) * (double)g->x[i] + u * (double)g->x[i + 1]) * scale,
                             ((1 - v) * (double)g->y[j] + v * (double)g->y[j + 1]) * scale, -depth};
        if (lit(l, light, p)) {
            return true;
        }
    }
    return false;
}

// touched[cell * SPOTS + light]
static uint8_t *reference(const gfx_cluster_grid *g, const gfx_lights *l) {
    uint32_t cells = gfx_cluster_cells(g);
    uint8_t *touched = core_alloc((size_t)cells * SPOTS);
    core_rng rng = core_rng_make(17, 1);
    for (uint32_t i = 0; i < SPOTS; ++i) {
        for (int n = 0; n < CONE_POINTS; ++n) {
            double p[3];
            uint32_t cell;
            cone_point(&rng, l, i, p);
            if (cell_of(g, p, &cell)) {
                touched[cell * SPOTS + i] = 1;
            }
        }
    }
    return touched;
}

typedef struct tally {
    uint32_t entries, missing, needed;
} tally;

static tally compare(const gfx_cluster_grid *g, const gfx_lights *l, const gfx_clusters *c,
                     const uint8_t *touched) {
    tally t = {.entries = c->total};
    for (uint32_t cell = 0; cell < gfx_cluster_cells(g); ++cell) {
        uint32_t at = c->offset[cell];
        for (uint32_t i = 0; i < SPOTS; ++i) {
            bool listed = at < c->offset[cell + 1] && c->light[at] == i;
            bool needed = touched[cell * SPOTS + i] || (listed && cell_touches(g, cell, l, i));
            at += listed;
            t.missing += needed && !listed;
            t.needed += needed;
        }
        TEST_ASSERT_EQUAL_UINT32(c->offset[cell + 1], at); // ascending, each light once
    }
    return t;
}

static void check(const char *name, float least_angle, float most_angle, bool orthographic,
                  const uint32_t size[3], double most_ratio) {
    gfx_world *world = spot_world(least_angle, most_angle, 3);
    gfx_view view = make_view(orthographic);
    gfx_cluster_grid g;
    gfx_cluster_grid_make(&g, size, false, 5.0f, orthographic, view.tan_x, view.tan_y,
                          view.near_plane, view.virtual_far);
    gfx_cluster_lights lights = {0};
    gfx_cluster_lights_fill(&lights, &world->lights, &view);
    TEST_ASSERT_EQUAL_UINT32(SPOTS, lights.spots);
    uint8_t *touched = reference(&g, &world->lights);
    uint32_t spheres[GFX_CLUSTER_METHODS];
    for (int m = 0; m < GFX_CLUSTER_METHODS; ++m) {
        gfx_clusters c = {0};
        lights.spots = 0; // the spheres alone
        gfx_clusters_assign(&c, &g, &lights, (gfx_cluster_method)m, NULL);
        spheres[m] = c.total;
        lights.spots = SPOTS;
        gfx_clusters_assign(&c, &g, &lights, (gfx_cluster_method)m, NULL);
        tally t = compare(&g, &world->lights, &c, touched);
        printf("angles %.2f to %.2f, %ux%ux%u%s, %s: %u entries, %.3f of the needed, %.2f of the "
               "spheres'\n",
               (double)least_angle, (double)most_angle, size[0], size[1], size[2],
               orthographic ? " orthographic" : "", gfx_cluster_method_name((gfx_cluster_method)m),
               t.entries, (double)t.entries / t.needed, (double)t.entries / spheres[m]);
        accuracy_at_most("gfx: cells without a spot that reaches them", t.missing, 0.0, "cells");
        TEST_ASSERT_GREATER_THAN(100, t.needed);
        if (m == GFX_CLUSTER_SIMD) {
            accuracy_at_most(name, (double)t.entries / t.needed, most_ratio, "1");
        }
        gfx_clusters_release(&c);
    }
    core_free(touched);
    gfx_cluster_lights_release(&lights);
    gfx_world_destroy(world);
}

static const uint32_t usual[3] = {16, 9, 24};

static void test_common_spots(void) {
    check("gfx: entries of spots of 0.2 to 0.8 rad, part of the needed", 0.2f, 0.8f, false, usual,
          1.1);
}
static void test_narrow_spots(void) {
    check("gfx: entries of spots of 0.002 to 0.1 rad, part of the needed", 0.002f, 0.1f, false,
          usual, 1.4);
}
static void test_wide_spots(void) {
    check("gfx: entries of spots of 0.8 to 1.57 rad, part of the needed", 0.8f, 1.57f, false, usual,
          1.1);
}
static void test_orthographic(void) {
    check("gfx: entries of spots, orthographic, part of the needed", 0.2f, 1.2f, true, usual, 1.1);
}
static void test_coarse_grid(void) {
    const uint32_t size[3] = {5, 3, 4};
    check("gfx: entries of spots in large cells, part of the needed", 0.2f, 0.8f, false, size, 1.2);
}

// Vectors of any width and any number of threads give the same lists.
static void test_same_on_every_set(void) {
    gfx_world *world = spot_world(0.1f, 1.2f, 8);
    gfx_view view = make_view(false);
    gfx_cluster_grid g;
    const uint32_t size[3] = {21, 9, 24};
    gfx_cluster_grid_make(&g, size, false, 5.0f, false, view.tan_x, view.tan_y, view.near_plane,
                          view.virtual_far);
    gfx_cluster_lights lights = {0};
    gfx_cluster_lights_fill(&lights, &world->lights, &view);
    gfx_clusters first = {0}, c = {0};
    core_simd_use(CORE_SIMD_SSE2);
    gfx_clusters_assign(&first, &g, &lights, GFX_CLUSTER_SIMD, NULL);
    core_jobs *jobs = core_jobs_create(2);
    for (int set = CORE_SIMD_SSE2; set <= (int)core_simd_best(); ++set) {
        core_simd_use((core_simd_set)set);
        gfx_clusters_assign(&c, &g, &lights, GFX_CLUSTER_SIMD, jobs);
        TEST_ASSERT_EQUAL_UINT32(first.total, c.total);
        TEST_ASSERT_EQUAL_UINT32_ARRAY(first.light, c.light, c.total);
        TEST_ASSERT_EQUAL_UINT32_ARRAY(first.offset, c.offset, gfx_cluster_cells(&g) + 1);
    }
    core_jobs_destroy(jobs);
    gfx_clusters_release(&first);
    gfx_clusters_release(&c);
    gfx_cluster_lights_release(&lights);
    gfx_world_destroy(world);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_common_spots);
    RUN_TEST(test_narrow_spots);
    RUN_TEST(test_wide_spots);
    RUN_TEST(test_orthographic);
    RUN_TEST(test_coarse_grid);
    RUN_TEST(test_same_on_every_set);
    return UNITY_END();
}
