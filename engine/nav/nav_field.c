// From triangles to places to stand, first half: every triangle is clipped to the columns of cells
// it crosses, and what a column holds is merged into solid intervals of height. Heights stay exact;
// only sideways is the world cut into cells.
#include "nav/nav_field.h"

#include <string.h>

#define MOST_CELLS     (1u << 26)
#define MOST_FRAGMENTS (1u << 28)
#define SAME_TOP       0.01f // m: tops so near to each other are one surface

// ---- clipping ----

typedef struct outline { // a convex polygon: a triangle cut by four lines has at most 7 corners
    int count;
    float p[8][3]; // x, y, z
} outline;

// Cuts an outline at `at` along an axis: `low` gets what lies below, `high` what lies above.
static void cut(const outline *in, int axis, float at, outline *low, outline *high) {
    low->count = high->count = 0;
    for (int i = 0; i < in->count; i++) {
        const float *a = in->p[i], *b = in->p[(i + 1) % in->count];
        float da = a[axis] - at, db = b[axis] - at;
        if (da <= 0.0f) {
            memcpy(low->p[low->count++], a, sizeof in->p[0]);
        }
        if (da >= 0.0f) {
            memcpy(high->p[high->count++], a, sizeof in->p[0]);
        }
        if ((da < 0.0f && db > 0.0f) || (da > 0.0f && db < 0.0f)) {
            float t = da / (da - db), m[3];
            for (int k = 0; k < 3; k++) {
                m[k] = a[k] + (b[k] - a[k]) * t;
            }
            m[axis] = at;
            memcpy(low->p[low->count++], m, sizeof m);
            memcpy(high->p[high->count++], m, sizeof m);
        }
    }
}

static void bounds(const outline *o, int axis, float *low, float *high) {
    *low = __FLT_MAX__, *high = -__FLT_MAX__;
    for (int i = 0; i < o->count; i++) {
        *low = CORE_MIN(*low, o->p[i][axis]);
        *high = CORE_MAX(*high, o->p[i][axis]);
    }
}

typedef struct fragment { // what one triangle leaves in one column
    uint32_t cell;
    float low, high, stand; // m; `stand`: height over the middle of the cell
    bool walkable;
} fragment;

typedef struct raster {
    nav_field *field;
    fragment *item;
    uint32_t count, room;
} raster;

static bool emit(raster *r, fragment f) {
    if (r->count == r->room) {
        if (r->room >= MOST_FRAGMENTS) {
            return core_fail("nav_mesh_build: the triangles cross more than %u cells; use larger "
                             "cells",
                             MOST_FRAGMENTS);
        }
        uint32_t wanted = CORE_MAX(r->room * 2, 4096u);
        r->item = core_realloc(r->item, r->room * sizeof *r->item, wanted * sizeof *r->item);
        r->room = wanted;
    }
    r->item[r->count++] = f;
    return true;
}

typedef struct face {
    core_vec3 a, normal; // not unit
    bool walkable;
} face;

static uint32_t cell_index(float at, float origin, float size, uint32_t most) {
    float cell = (at - origin) / size;
    return cell <= 0.0f ? 0 : CORE_MIN((uint32_t)cell, most - 1);
}

// One row of cells: `strip` is the triangle's part in it.
static bool raster_row(raster *r, const face *f, outline *strip, uint32_t z) {
    const nav_field *field = r->field;
    float low, high, size = field->cell_size;
    bounds(strip, 0, &low, &high);
    uint32_t x0 = cell_index(low, field->origin.x, size, field->width);
    uint32_t x1 = cell_index(high, field->origin.x, size, field->width);
    for (uint32_t x = x0; x <= x1; x++) {
        outline piece, rest;
        cut(strip, 0, field->origin.x + (float)(x + 1) * size, &piece, &rest);
        *strip = rest;
        outline *part = x == x1 && piece.count < 3 ? &rest : &piece;
        if (part->count >= 3) {
            fragment out = {.cell = z * field->width + x, .walkable = f->walkable};
            bounds(part, 1, &out.low, &out.high);
            out.stand = out.high;
            if (f->walkable) {
                float dx = field->origin.x + ((float)x + 0.5f) * size - f->a.x;
                float dz = field->origin.z + ((float)z + 0.5f) * size - f->a.z;
                float y = f->a.y - (f->normal.x * dx + f->normal.z * dz) / f->normal.y;
                out.stand = CORE_CLAMP(y, out.low, out.high);
            }
            if (!emit(r, out)) {
                return false;
            }
        }
    }
    return true;
}

static bool raster_triangle(raster *r, const core_vec3 *corner, float least_normal_y) {
    face f = {.a = corner[0]};
    f.normal = core_v3_cross(core_v3_sub(corner[1], corner[0]), core_v3_sub(corner[2], corner[0]));
    float length = core_v3_length(f.normal);
    if (!(length > 0.0f)) {
        return true; // no area
    }
    f.walkable = f.normal.y >= least_normal_y * length && f.normal.y > 0.0f;
    outline left = {.count = 3};
    for (int i = 0; i < 3; i++) {
        memcpy(left.p[i], &corner[i], sizeof left.p[i]);
    }
    const nav_field *field = r->field;
    float low, high;
    bounds(&left, 2, &low, &high);
    uint32_t z0 = cell_index(low, field->origin.z, field->cell_size, field->depth);
    uint32_t z1 = cell_index(high, field->origin.z, field->cell_size, field->depth);
    for (uint32_t z = z0; z <= z1; z++) {
        outline strip, rest;
        cut(&left, 2, field->origin.z + (float)(z + 1) * field->cell_size, &strip, &rest);
        left = rest;
        outline *part = z == z1 && strip.count < 3 ? &rest : &strip;
        if (part->count >= 3 && !raster_row(r, &f, part, z)) {
            return false;
        }
    }
    return true;
}

// ---- columns ----

// Fragments sorted by cell: a counting sort keeps the order of triangles, so ties are broken alike
// on every machine.
static fragment *sort_by_cell(raster *r, uint32_t cells, uint32_t *start) {
    for (uint32_t i = 0; i < r->count; i++) {
        start[r->item[i].cell + 1]++;
    }
    for (uint32_t c = 0; c < cells; c++) {
        start[c + 1] += start[c];
    }
    fragment *sorted = core_alloc((r->count + 1) * sizeof *sorted);
    for (uint32_t i = r->count; i-- > 0;) {
        sorted[--start[r->item[i].cell + 1]] = r->item[i];
    }
    // The decrements turned every end into its begin: move them back by one.
    for (uint32_t c = 0; c < cells; c++) {
        start[c] = start[c + 1];
    }
    start[cells] = r->count;
    return sorted;
}

static void sort_by_height(fragment *f, uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        fragment moved = f[i];
        uint32_t k = i;
        for (; k > 0 && f[k - 1].low > moved.low; k--) {
            f[k] = f[k - 1];
        }
        f[k] = moved;
    }
}

// Merges what overlaps in height. The surface on top is the highest; where several end together it
// is walkable when any of them is. Returns how many intervals the column has.
static uint32_t merge_column(fragment *f, uint32_t count, nav_solid *out) {
    uint32_t n = 0;
    sort_by_height(f, count);
    for (uint32_t i = 0; i < count; i++) {
        nav_solid next = {f[i].low, f[i].high, f[i].stand, f[i].walkable};
        nav_solid *last = n ? &out[n - 1] : NULL;
        if (!last || next.low > last->high + SAME_TOP) {
            out[n++] = next;
            continue;
        }
        bool higher = next.high > last->high + SAME_TOP, level = next.high >= last->high - SAME_TOP;
        if (higher || (level && next.walkable && !last->walkable)) {
            last->stand = next.stand;
            last->walkable = next.walkable;
        }
        last->high = CORE_MAX(last->high, next.high);
    }
    return n;
}

static void fill_columns(nav_field *field, raster *r) {
    uint32_t cells = field->width * field->depth;
    uint32_t *start = core_alloc(((size_t)cells + 1) * sizeof *start);
    fragment *sorted = sort_by_cell(r, cells, start);
    field->first = core_alloc(((size_t)cells + 1) * sizeof *field->first);
    field->solid = core_alloc(((size_t)r->count + 1) * sizeof *field->solid);
    uint32_t n = 0;
    for (uint32_t c = 0; c < cells; c++) {
        field->first[c] = n;
        n += merge_column(sorted + start[c], start[c + 1] - start[c], field->solid + n);
    }
    field->first[cells] = n;
    core_free(sorted);
    core_free(start);
}

static bool measure(nav_field *field, const core_soup_data *soup) {
    core_vec3 low = {__FLT_MAX__, 0, __FLT_MAX__}, high = {-__FLT_MAX__, 0, -__FLT_MAX__};
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        const float *p = soup->position + 3 * (size_t)v;
        if (!(core_absf(p[0]) <= 1e6f && core_absf(p[1]) <= 1e6f && core_absf(p[2]) <= 1e6f)) {
            return core_fail("nav_mesh_build: vertex %u is (%g, %g, %g), expected numbers up to a "
                             "million",
                             v, (double)p[0], (double)p[1], (double)p[2]);
        }
        low.x = CORE_MIN(low.x, p[0]), high.x = CORE_MAX(high.x, p[0]);
        low.z = CORE_MIN(low.z, p[2]), high.z = CORE_MAX(high.z, p[2]);
    }
    if (soup->vertex_count == 0) {
        low = high = (core_vec3){0, 0, 0};
    }
    double width = ((double)high.x - low.x) / field->cell_size + 1.0;
    double depth = ((double)high.z - low.z) / field->cell_size + 1.0;
    if (width * depth > MOST_CELLS) {
        return core_fail("nav_mesh_build: %.0f by %.0f cells of %g m, expected at most %u in all; "
                         "use larger cells",
                         width, depth, (double)field->cell_size, MOST_CELLS);
    }
    field->origin = low;
    field->width = (uint32_t)width, field->depth = (uint32_t)depth;
    return true;
}

bool nav_field_make(nav_field *field, const core_soup_data *soup, float cell_size,
                    float max_slope) {
    *field = (nav_field){.cell_size = cell_size};
    if (!measure(field, soup)) {
        return false;
    }
    raster r = {.field = field};
    float least_normal_y = core_cosf(max_slope);
    bool good = true;
    for (uint32_t t = 0; good && t < soup->triangle_count; t++) {
        const uint32_t *index = soup->index + 3 * (size_t)t;
        core_vec3 corner[3];
        for (int i = 0; good && i < 3; i++) {
            good = index[i] < soup->vertex_count ||
                   core_fail("nav_mesh_build: triangle %u names vertex %u of %u", t, index[i],
                             soup->vertex_count);
            if (good) {
                memcpy(&corner[i], soup->position + 3 * (size_t)index[i], sizeof corner[i]);
            }
        }
        good = good && raster_triangle(&r, corner, least_normal_y);
    }
    if (good) {
        fill_columns(field, &r);
    }
    core_free(r.item);
    return good;
}

void nav_field_release(nav_field *field) {
    core_free(field->first);
    core_free(field->solid);
    *field = (nav_field){0};
}
