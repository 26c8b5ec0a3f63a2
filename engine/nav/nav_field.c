// From triangles to places to stand, first half: every triangle is clipped to the columns of cells
// it crosses, and what a column holds is merged into solid intervals of height. Heights stay exact;
// only sideways is the world cut into cells.
//
// What a cell gets from a triangle does not depend on the window that is looked at: its part is cut
// from the triangle itself. So a tile made alone has the same bits as in a whole surface.
#include <string.h>

#include "nav/nav_internal.h"

#define MOST_FRAGMENTS (1u << 28)
#define SAME_TOP       0.01f // m: tops so near to each other are one surface

// ---- clipping ----

typedef struct outline { // a convex polygon: a triangle cut by four lines has at most 7 corners
    int count;
    float p[8][3]; // x, y, z
} outline;

// The part of an outline on one side of a line across an axis: beyond it (side 1) or before it
// (-1).
static void keep(const outline *in, int axis, float at, float side, outline *out) {
    out->count = 0;
    const float *a = in->p[in->count - 1];
    float da = side * (a[axis] - at);
    for (int i = 0; i < in->count; i++) {
        const float *b = in->p[i];
        float db = side * (b[axis] - at);
        if ((da < 0.0f && db > 0.0f) || (da > 0.0f && db < 0.0f)) {
            float t = da / (da - db), *m = out->p[out->count++];
            for (int k = 0; k < 3; k++) {
                m[k] = a[k] + (b[k] - a[k]) * t;
            }
            m[axis] = at;
        }
        if (db >= 0.0f) {
            memcpy(out->p[out->count++], b, sizeof in->p[0]);
        }
        a = b, da = db;
    }
}

static void bounds(const outline *o, int axis, float *low, float *high) {
    *low = __FLT_MAX__, *high = -__FLT_MAX__;
    for (int i = 0; i < o->count; i++) {
        *low = CORE_MIN(*low, o->p[i][axis]);
        *high = CORE_MAX(*high, o->p[i][axis]);
    }
}

typedef struct fragment {   // what one triangle leaves in one column
    uint32_t cell;          // of the window
    float low, high, stand; // m; `stand`: height over the middle of the cell
    float cover;            // m^2 of the cell, > 0 where it faces down, < 0 where it faces up
    uint32_t piece;
    bool walkable;
    uint8_t area;
} fragment;

static bool emit(nav_field *f, const fragment *item) {
    if (f->fragments >= MOST_FRAGMENTS) {
        return core_fail("nav_mesh_build: the triangles cross more than %u cells; use larger cells",
                         MOST_FRAGMENTS);
    }
    if ((f->fragments + 1) * sizeof *item > f->fragment.bytes) {
        nav_buffer_fit(&f->fragment, (f->fragments + 4096) * sizeof *item);
    }
    ((fragment *)f->fragment.data)[f->fragments++] = *item;
    return true;
}

typedef struct face {
    core_vec3 a, normal; // not unit
    bool walkable;
    uint8_t area;
} face;

typedef struct range { // of cells, both included
    int64_t low, high;
} range;
// Cells that an outline crosses along an axis. The first and the last take what rounding leaves
// beyond them.
static range cells_of(const outline *o, int axis, float origin, float size) {
    float low, high;
    bounds(o, axis, &low, &high);
    return (range){(int64_t)core_floor((double)((low - origin) / size)),
                   (int64_t)core_floor((double)((high - origin) / size))};
}

// The part of an outline in one of the rows or columns of cells that it crosses; in `room`, or the
// whole itself.
static const outline *slice(const outline *whole, int axis, range all, int64_t at, float origin,
                            float size, outline room[2]) {
    const outline *part = whole;
    if (at > all.low) {
        keep(part, axis, origin + (float)at * size, 1.0f, &room[0]);
        part = &room[0];
    }
    if (at < all.high && part->count) {
        keep(part, axis, origin + (float)(at + 1) * size, -1.0f, &room[1]);
        part = &room[1];
    }
    return part;
}

static float cover_of(const outline *o, float facing) {
    float twice = 0.0f;
    for (int i = 0; i < o->count; i++) {
        const float *a = o->p[i], *b = o->p[(i + 1) % o->count];
        twice +=
            (a[0] - o->p[0][0]) * (b[2] - o->p[0][2]) - (a[2] - o->p[0][2]) * (b[0] - o->p[0][0]);
    }
    twice = core_absf(twice);
    return facing > 0.0f ? -0.5f * twice : facing < 0.0f ? 0.5f * twice : 0.0f;
}

static fragment fragment_of(const nav_field *field, const face *f, const outline *part, int64_t x,
                            int64_t z) {
    const nav_window *w = &field->window;
    fragment out = {.cell = (uint32_t)(z - w->z) * w->width + (uint32_t)(x - w->x),
                    .cover = cover_of(part, f->normal.y),
                    .piece = field->piece,
                    .walkable = f->walkable,
                    .area = f->area};
    bounds(part, 1, &out.low, &out.high);
    out.stand = out.high;
    if (f->walkable) {
        float dx = field->origin.x + ((float)x + 0.5f) * field->cell_size - f->a.x;
        float dz = field->origin.z + ((float)z + 0.5f) * field->cell_size - f->a.z;
        float y = f->a.y - (f->normal.x * dx + f->normal.z * dz) / f->normal.y;
        out.stand = CORE_CLAMP(y, out.low, out.high);
    }
    return out;
}

static range within(range cells, uint32_t first, uint32_t count) {
    return (range){CORE_MAX(cells.low, (int64_t)first),
                   CORE_MIN(cells.high, (int64_t)first + count - 1)};
}

bool nav_field_add(nav_field *field, const nav_triangle *t) {
    face f = {.a = t->corner[0], .area = t->area};
    f.normal = core_v3_cross(core_v3_sub(t->corner[1], t->corner[0]),
                             core_v3_sub(t->corner[2], t->corner[0]));
    float length = core_v3_length(f.normal);
    if (!(length > 0.0f)) {
        return true; // no area
    }
    f.walkable = f.normal.y >= field->least_normal_y * length && f.normal.y > 0.0f;
    outline all = {.count = 3}, rows_room[2], cell_room[2];
    memcpy(all.p, t->corner, sizeof t->corner);
    float size = field->cell_size;
    range rows = cells_of(&all, 2, field->origin.z, size);
    range seen = within(rows, field->window.z, field->window.depth);
    for (int64_t z = seen.low; z <= seen.high; z++) {
        const outline *strip = slice(&all, 2, rows, z, field->origin.z, size, rows_room);
        if (strip->count < 3) {
            continue;
        }
        range columns = cells_of(strip, 0, field->origin.x, size);
        range here = within(columns, field->window.x, field->window.width);
        for (int64_t x = here.low; x <= here.high; x++) {
            const outline *part = slice(strip, 0, columns, x, field->origin.x, size, cell_room);
            if (part->count >= 3) {
                fragment out = fragment_of(field, &f, part, x, z);
                if (!emit(field, &out)) {
                    return false;
                }
            }
        }
    }
    return true;
}

void nav_field_begin(nav_field *field, const nav_mesh_data *m, nav_window window) {
    field->window = window;
    field->cell_size = m->cell_size;
    field->origin = m->origin;
    field->least_normal_y = core_cosf(m->desc.max_slope);
    field->fragments = 0;
}

// ---- columns ----

// Fragments sorted by cell: a counting sort keeps the order of triangles, so ties are broken alike
// on every machine.
static fragment *sort_by_cell(nav_field *f, uint32_t cells, uint32_t *start) {
    fragment *item = f->fragment.data;
    memset(start, 0, ((size_t)cells + 1) * sizeof *start);
    for (uint32_t i = 0; i < f->fragments; i++) {
        start[item[i].cell + 1]++;
    }
    for (uint32_t c = 0; c < cells; c++) {
        start[c + 1] += start[c];
    }
    fragment *sorted = nav_buffer_fit(&f->sorted, ((size_t)f->fragments + 1) * sizeof *sorted);
    for (uint32_t i = f->fragments; i-- > 0;) {
        sorted[--start[item[i].cell + 1]] = item[i];
    }
    // The decrements turned every end into its begin: move them back by one.
    for (uint32_t c = 0; c < cells; c++) {
        start[c] = start[c + 1];
    }
    start[cells] = f->fragments;
    return sorted;
}

// At one height what faces up comes first.
static bool lower(const fragment *a, const fragment *b) {
    return a->low != b->low ? a->low < b->low : a->cover < b->cover;
}

static void sort_by_height(fragment *f, uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        fragment moved = f[i];
        uint32_t k = i;
        for (; k > 0 && lower(&moved, &f[k - 1]); k--) {
            f[k] = f[k - 1];
        }
        f[k] = moved;
    }
}

// Closed shapes are solid: upwards through one piece, what has been entered through faces that look
// down and not yet left through faces that look up is inside. Sheets (ground without a lower side)
// have no inside.
static void fill_piece(fragment *f, uint32_t count, float cell_area) {
    float inside = 0.0f, bottom = 0.0f;
    sort_by_height(f, count);
    for (uint32_t i = 0; i < count; i++) {
        if (f[i].cover > 0.0f && inside <= 1e-3f * cell_area) {
            bottom = f[i].low;
        }
        if (f[i].cover < 0.0f && inside > 1e-3f * cell_area) {
            f[i].low = CORE_MIN(f[i].low, bottom);
        }
        inside = CORE_MAX(inside + f[i].cover, 0.0f);
    }
}
static void fill_solids(fragment *f, uint32_t count, float cell_area) {
    for (uint32_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && f[end].piece == f[i].piece; end++) {
        }
        fill_piece(f + i, end - i, cell_area);
    }
}

// Merges what overlaps in height. The surface on top is the highest; where several end together it
// is walkable when any of them is. Returns how many intervals the column has.
static uint32_t merge_column(fragment *f, uint32_t count, nav_solid *out) {
    uint32_t n = 0;
    sort_by_height(f, count);
    for (uint32_t i = 0; i < count; i++) {
        nav_solid next = {f[i].low, f[i].high, f[i].stand, f[i].walkable, f[i].area};
        nav_solid *last = n ? &out[n - 1] : NULL;
        if (!last || next.low > last->high + SAME_TOP) {
            out[n++] = next;
            continue;
        }
        bool higher = next.high > last->high + SAME_TOP, level = next.high >= last->high - SAME_TOP;
        if (higher || (level && next.walkable && !last->walkable)) {
            last->stand = next.stand;
            last->walkable = next.walkable;
            last->area = next.area;
        }
        last->high = CORE_MAX(last->high, next.high);
    }
    return n;
}

void nav_field_finish(nav_field *f) {
    uint32_t cells = f->window.width * f->window.depth;
    uint32_t *start = nav_buffer_fit(&f->start, ((size_t)cells + 1) * sizeof *start);
    fragment *sorted = sort_by_cell(f, cells, start);
    f->first = nav_buffer_fit(&f->first_buffer, ((size_t)cells + 1) * sizeof *f->first);
    f->solid = nav_buffer_fit(&f->solid_buffer, ((size_t)f->fragments + 1) * sizeof *f->solid);
    uint32_t n = 0;
    for (uint32_t c = 0; c < cells; c++) {
        f->first[c] = n;
        uint32_t count = start[c + 1] - start[c];
        fill_solids(sorted + start[c], count, f->cell_size * f->cell_size);
        n += merge_column(sorted + start[c], count, f->solid + n);
    }
    f->first[cells] = n;
}

void nav_field_release(nav_field *f) {
    nav_buffer *own[] = {&f->fragment, &f->sorted, &f->start, &f->first_buffer, &f->solid_buffer};
    for (size_t i = 0; i < CORE_COUNT_OF(own); i++) {
        core_free(own[i]->data);
    }
    *f = (nav_field){0};
}
