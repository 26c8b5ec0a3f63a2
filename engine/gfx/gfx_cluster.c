// The grid, the storage of lists, and the two scalar methods of assignment.
#include "gfx/gfx_cluster.h"
#include "gfx/gfx_cluster_wide.h"

#include <string.h>

void gfx_cluster_grid_make(gfx_cluster_grid *g, const uint32_t size[3], bool linear,
                           float first_slice, bool orthographic, float tan_x, float tan_y,
                           float near_plane, float far) {
    *g = (gfx_cluster_grid){.columns = size[0],
                            .rows = size[1],
                            .slices = size[2],
                            .linear = linear,
                            .orthographic = orthographic,
                            .tan_x = tan_x,
                            .tan_y = tan_y,
                            .near_plane = near_plane,
                            .far = far};
    uint32_t n = size[2];
    bool near_slice = !linear && n > 1 && first_slice > near_plane && first_slice < far;
    if (linear) {
        g->scale = (float)n / (far - near_plane);
        g->bias = -near_plane * g->scale;
    } else { // slice `skip` starts at `start`
        double start = near_slice ? first_slice : near_plane, skip = near_slice;
        double scale = (n - skip) / (core_log2(far) - core_log2(start));
        g->scale = (float)scale;
        g->bias = (float)(skip - core_log2(start) * scale);
    }
    for (uint32_t k = 0; k <= n; ++k) {
        double at = ((double)k - (double)g->bias) / (double)g->scale;
        g->depth[k] = (float)(linear ? at : core_pow(2.0, at));
    }
    g->depth[0] = near_plane;
    g->depth[n] = far;
    for (uint32_t i = 0; i <= g->columns; ++i) {
        g->x[i] = tan_x * (2.0f * (float)i / (float)g->columns - 1.0f);
    }
    for (uint32_t j = 0; j <= g->rows; ++j) {
        g->y[j] = tan_y * (2.0f * (float)j / (float)g->rows - 1.0f);
    }
}

static float slice_of(const gfx_cluster_grid *g, float depth) {
    float along = g->linear ? depth : (float)core_log2((double)depth);
    return along * g->scale + g->bias;
}

static uint32_t clamp_cell(float x, uint32_t count) {
    float last = (float)(count - 1);
    return (uint32_t)CORE_CLAMP(x, 0.0f, last);
}

uint32_t gfx_cluster_cell(const gfx_cluster_grid *g, float u, float v, float depth) {
    uint32_t i = clamp_cell(u * (float)g->columns, g->columns);
    uint32_t j = clamp_cell(v * (float)g->rows, g->rows);
    uint32_t k = clamp_cell(slice_of(g, depth), g->slices);
    return (k * g->rows + j) * g->columns + i;
}

const char *gfx_cluster_method_name(gfx_cluster_method method) {
    static const char *const names[GFX_CLUSTER_METHODS] = {"naive", "per_light", "simd"};
    return names[method];
}

// ---- storage ----

static void *room(void **block, size_t *bytes, size_t need) {
    if (need > *bytes) {
        core_free(*block);
        *bytes = need + need / 2;
        *block = core_alloc(*bytes);
    }
    return *block;
}

void gfx_cluster_lights_release(gfx_cluster_lights *lights) {
    core_free(lights->block);
    core_free(lights->cone);
    *lights = (gfx_cluster_lights){0};
}

void gfx_cluster_lights_reserve(gfx_cluster_lights *lights, uint32_t count) {
    if (count > lights->capacity) {
        gfx_cluster_lights_release(lights);
        size_t n = ((size_t)count + count / 2 + CORE_LANES - 1) / CORE_LANES * CORE_LANES;
        lights->block = core_alloc(4 * n * sizeof(float) + CORE_ALIGN);
        lights->x = gfx_cluster_align(lights->block);
        lights->y = lights->x + n;
        lights->depth = lights->y + n;
        lights->radius = lights->depth + n;
        lights->cone = core_alloc(n * sizeof *lights->cone);
        lights->capacity = n;
    }
    lights->count = count;
    lights->spots = 0;
}

void gfx_clusters_release(gfx_clusters *c) {
    core_free(c->offset);
    core_free(c->light);
    core_free(c->scratch);
    gfx_clusters_wide_release(c);
    *c = (gfx_clusters){0};
}

void gfx_clusters_reserve_offsets(gfx_clusters *c, uint32_t cells) {
    void *p = c->offset;
    c->offset = room(&p, &c->offset_bytes, (cells + 1) * sizeof *c->offset);
    memset(c->offset, 0, (cells + 1) * sizeof *c->offset);
}

void gfx_clusters_reserve_lights(gfx_clusters *c, size_t total) {
    void *p = c->light;
    c->light = room(&p, &c->light_bytes, total * sizeof *c->light);
    c->total = (uint32_t)total;
}

// Room for `more` behind the lists so far, which are kept.
static void extend_lights(gfx_clusters *c, size_t more) {
    size_t used = c->total * sizeof *c->light, need = used + more * sizeof *c->light;
    if (need > c->light_bytes) {
        c->light = core_realloc(c->light, c->light_bytes, 2 * need);
        c->light_bytes = 2 * need;
    }
}

// Turns counts in offset[cell + 1] into offsets.
static void sum_offsets(gfx_clusters *c, uint32_t cells) {
    for (uint32_t i = 0; i < cells; ++i) {
        c->offset[i + 1] += c->offset[i];
    }
}

// ---- naive: every cell's view-space box against every light's sphere ----

typedef struct box {
    float lo[3], hi[3];
} box;

// Columns and rows fan out with depth, so the box takes the wider of the near and the far corners.
static box cell_box(const gfx_cluster_grid *g, uint32_t i, uint32_t j, uint32_t k) {
    float a = g->depth[k], b = g->depth[k + 1];
    float sa = g->orthographic ? 1.0f : a, sb = g->orthographic ? 1.0f : b;
    return (box){
        {CORE_MIN(g->x[i] * sa, g->x[i] * sb), CORE_MIN(g->y[j] * sa, g->y[j] * sb), a},
        {CORE_MAX(g->x[i + 1] * sa, g->x[i + 1] * sb), CORE_MAX(g->y[j + 1] * sa, g->y[j + 1] * sb),
         b},
    };
}

static inline float outside(float lo, float hi, float p) {
    float below = lo - p, above = p - hi;
    float d = below > above ? below : above;
    return 0.5f * (d + core_absf(d)); // max(d, 0) without the branches that compilers make of it
}

// Appends the lights that touch a box; out has room for all.
static uint32_t box_lights(const box *b, const gfx_cluster_lights *l, uint32_t *out) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < l->count; ++i) {
        float dx = outside(b->lo[0], b->hi[0], l->x[i]), dy = outside(b->lo[1], b->hi[1], l->y[i]);
        float dz = outside(b->lo[2], b->hi[2], l->depth[i]), r = l->radius[i];
        out[n] = i;
        n += dx * dx + dy * dy + dz * dz <= r * r;
    }
    return n;
}

// Drops from a cell's list what its cone does not reach.
static uint32_t drop_missing(const gfx_cluster_lights *l, const gfx_cluster_cell_bounds *b,
                             uint32_t *list, uint32_t count) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        list[kept] = list[i];
        kept += gfx_cluster_cone_reaches(l, list[i], b);
    }
    return kept;
}

static void naive(gfx_clusters *c, const gfx_cluster_grid *g, const gfx_cluster_lights *l) {
    uint32_t cells = gfx_cluster_cells(g), cell = 0;
    gfx_clusters_reserve_offsets(c, cells);
    c->total = 0;
    for (uint32_t k = 0; k < g->slices; ++k) {
        for (uint32_t j = 0; j < g->rows; ++j) {
            for (uint32_t i = 0; i < g->columns; ++i, ++cell) {
                box b = cell_box(g, i, j, k);
                extend_lights(c, l->count);
                uint32_t *list = c->light + c->total, found = box_lights(&b, l, list);
                if (l->spots) {
                    gfx_cluster_cell_bounds bounds;
                    gfx_cluster_cell_bounds_of(g, i, j, k, &bounds);
                    found = drop_missing(l, &bounds, list, found);
                }
                c->total += found;
                c->offset[cell + 1] = c->total;
            }
        }
    }
}

// ---- per light: bounds of each light in each slice it reaches ----

typedef struct rect {
    uint32_t light;
    uint8_t slice, c0, c1, r0, r1; // inclusive
} rect;

typedef struct interval {
    float lo, hi;
} interval;

// Bounds of s/depth over the disk of radius r round (s, d), cut to depths [a, b], 0 < a <= b. The
// extreme ratio lies at the tangent from the eye (Mara, McGuire, "2D polyhedral bounds of a
// clipped, perspective-projected 3D sphere", 2013) or, where the tangent point is cut off, at the
// end of the chord at the nearer bound: along either side of the disk the ratio is monotone up to
// the tangent.
static interval slope_bounds(float s, float d, float r, float a, float b) {
    float q = s * s + d * d, l2 = q - r * r;
    float ca = CORE_MAX(r * r - (a - d) * (a - d), 0.0f),
          cb = CORE_MAX(r * r - (b - d) * (b - d), 0.0f);
    float ha = core_sqrtf(ca), hb = core_sqrtf(cb);
    interval out = {CORE_MIN((s - ha) / a, (s - hb) / b), CORE_MAX((s + ha) / a, (s + hb) / b)};
    if (l2 > 0.0f) {
        float l = core_sqrtf(l2);
        float hi_run = d * l - s * r, lo_run = d * l + s * r; // tangent depth * q / l
        float hi_depth = l * hi_run / q, lo_depth = l * lo_run / q;
        if (hi_depth > a && hi_depth < b) {
            out.hi = CORE_MAX(out.hi, (s * l + d * r) / hi_run);
        }
        if (lo_depth > a && lo_depth < b) {
            out.lo = CORE_MIN(out.lo, (s * l - d * r) / lo_run);
        }
    }
    return out;
}

// As above without perspective: the widest part of the disk, or the wider chord.
static interval span_bounds(float s, float d, float r, float a, float b) {
    float nearest = CORE_CLAMP(d, a, b);
    float h = core_sqrtf(CORE_MAX(r * r - (nearest - d) * (nearest - d), 0.0f));
    return (interval){s - h, s + h};
}

static bool tile_range(interval bounds, float half, uint32_t count, uint8_t *first, uint8_t *last) {
    float scale = 0.5f * (float)count / half, mid = 0.5f * (float)count;
    float lo = bounds.lo * scale + mid - GFX_CLUSTER_TILE_MARGIN,
          hi = bounds.hi * scale + mid + GFX_CLUSTER_TILE_MARGIN;
    if (!(hi >= 0.0f) || !(lo < (float)count)) {
        return false;
    }
    *first = (uint8_t)clamp_cell(lo, count);
    *last = (uint8_t)clamp_cell(hi, count);
    return true;
}

void gfx_cluster_slice_bounds(const gfx_cluster_grid *g, uint32_t k, float *lo, float *hi) {
    float margin = GFX_CLUSTER_SLICE_MARGIN * (g->depth[k + 1] - g->depth[k]);
    *lo = CORE_MAX(g->depth[k] - margin, 0.5f * g->near_plane);
    *hi = g->depth[k + 1] + margin;
}

void gfx_cluster_cell_bounds_of(const gfx_cluster_grid *g, uint32_t column, uint32_t row,
                                uint32_t slice, gfx_cluster_cell_bounds *out) {
    float mx = GFX_CLUSTER_TILE_MARGIN * 2.0f * g->tan_x / (float)g->columns,
          my = GFX_CLUSTER_TILE_MARGIN * 2.0f * g->tan_y / (float)g->rows;
    *out = (gfx_cluster_cell_bounds){.x = {g->x[column] - mx, g->x[column + 1] + mx},
                                     .y = {g->y[row] - my, g->y[row + 1] + my},
                                     .orthographic = g->orthographic};
    gfx_cluster_slice_bounds(g, slice, &out->depth[0], &out->depth[1]);
}

static bool slice_rect(const gfx_cluster_grid *g, const gfx_cluster_lights *l, uint32_t n,
                       uint32_t k, rect *out) {
    float a, b;
    gfx_cluster_slice_bounds(g, k, &a, &b);
    float d = l->depth[n], r = l->radius[n];
    a = CORE_MAX(a, d - r);
    b = CORE_MIN(b, d + r);
    if (a > b) {
        return false;
    }
    interval x, y;
    if (g->orthographic) {
        x = span_bounds(l->x[n], d, r, a, b);
        y = span_bounds(l->y[n], d, r, a, b);
    } else {
        x = slope_bounds(l->x[n], d, r, a, b);
        y = slope_bounds(l->y[n], d, r, a, b);
    }
    out->light = n;
    out->slice = (uint8_t)k;
    return tile_range(x, g->tan_x, g->columns, &out->c0, &out->c1) &&
           tile_range(y, g->tan_y, g->rows, &out->r0, &out->r1);
}

static bool slice_range(const gfx_cluster_grid *g, float d, float r, uint32_t *first,
                        uint32_t *last) {
    if (!(d + r >= g->near_plane) || !(d - r <= g->far)) {
        return false;
    }
    float from = CORE_MAX(d - r, g->near_plane), to = CORE_MIN(d + r, g->far);
    *first = clamp_cell(slice_of(g, from) - GFX_CLUSTER_SLICE_MARGIN, g->slices);
    *last = clamp_cell(slice_of(g, to) + GFX_CLUSTER_SLICE_MARGIN, g->slices);
    return true;
}

static uint32_t light_rects(const gfx_cluster_grid *g, const gfx_cluster_lights *l, rect *out) {
    uint32_t count = 0, first, last;
    for (uint32_t n = 0; n < l->count; ++n) {
        if (slice_range(g, l->depth[n], l->radius[n], &first, &last)) {
            for (uint32_t k = first; k <= last; ++k) {
                count += slice_rect(g, l, n, k, &out[count]);
            }
        }
    }
    return count;
}

// Each cell of a rectangle that its light reaches is counted or, with a list, given the light.
static void visit_rect(const gfx_cluster_grid *g, const gfx_cluster_lights *l, const rect *t,
                       uint32_t *counts, uint32_t *list) {
    bool spot = l->spots && l->cone[t->light].cosine > 0.0f;
    for (uint32_t row = t->r0; row <= t->r1; ++row) {
        uint32_t first = (t->slice * g->rows + row) * g->columns;
        for (uint32_t column = t->c0; column <= t->c1; ++column) {
            gfx_cluster_cell_bounds b;
            if (spot) {
                gfx_cluster_cell_bounds_of(g, column, row, t->slice, &b);
                if (gfx_cluster_cone_misses(&l->cone[t->light], &b)) {
                    continue;
                }
            }
            uint32_t at = counts[first + column]++;
            if (list) {
                list[at] = t->light;
            }
        }
    }
}

// Rectangles come in the order of their lights, so every list ends up ascending.
static void per_light(gfx_clusters *c, const gfx_cluster_grid *g, const gfx_cluster_lights *l) {
    uint32_t cells = gfx_cluster_cells(g);
    rect *rects =
        room(&c->scratch, &c->scratch_bytes, (size_t)l->count * g->slices * sizeof *rects);
    uint32_t count = light_rects(g, l, rects);
    gfx_clusters_reserve_offsets(c, cells);
    // Offsets are kept one cell ahead while writing, so that they end up in place.
    uint32_t *counts = c->offset + 1;
    for (uint32_t i = 0; i < count; ++i) {
        visit_rect(g, l, &rects[i], counts, NULL);
    }
    sum_offsets(c, cells);
    gfx_clusters_reserve_lights(c, c->offset[cells]);
    memmove(counts, c->offset, cells * sizeof *counts);
    c->offset[0] = 0;
    for (uint32_t i = 0; i < count; ++i) {
        visit_rect(g, l, &rects[i], counts, c->light);
    }
}

void gfx_clusters_assign(gfx_clusters *c, const gfx_cluster_grid *grid,
                         const gfx_cluster_lights *lights, gfx_cluster_method method,
                         core_jobs *jobs) {
    switch (method) {
    case GFX_CLUSTER_NAIVE:
        naive(c, grid, lights);
        break;
    case GFX_CLUSTER_PER_LIGHT:
        per_light(c, grid, lights);
        break;
    default:
        gfx_clusters_assign_wide(c, grid, lights, jobs);
        break;
    }
}

uint32_t gfx_clusters_cap(gfx_clusters *c, uint32_t cells, uint32_t cap, uint32_t mark) {
    uint32_t from = 0, to = 0, capped = 0;
    for (uint32_t cell = 0; cell < cells; ++cell) {
        uint32_t end = c->offset[cell + 1], count = end - from;
        bool over = count > cap;
        if (!over && to != from) {
            memmove(c->light + to, c->light + from, count * sizeof *c->light);
        }
        c->offset[cell] = to | (over ? mark : 0);
        to += over ? 0 : count;
        capped += over;
        from = end;
    }
    c->offset[cells] = c->total = to;
    return capped;
}
