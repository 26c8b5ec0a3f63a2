#include "gfx/gfx_terrain.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

CORE_COLUMNS_DEFINE(gfx_terrain_rows, GFX_TERRAIN_COLUMNS)

enum { TILE = GFX_TERRAIN_TILE, MAX_TERRAINS = 64, MAX_POINTS = 8193 };
static const float MORPH = 1.25f; // end of a level's turn over its start
static const float FAR = 1e30f;

// ---- making ----

gfx_terrain_desc gfx_terrain_desc_default(void) {
    return (gfx_terrain_desc){.low = {0.18f, 0.27f, 0.08f},
                              .high = {0.75f, 0.77f, 0.8f},
                              .steep = {0.24f, 0.21f, 0.19f},
                              .heights_blend = {1e6f, 2e6f},
                              .slopes_blend = {0.5f, 0.9f},
                              .roughness = 0.9f,
                              .cookie = GFX_COOKIE};
}

static bool check(const gfx_terrain_desc *d) {
    if (!d || d->cookie != GFX_COOKIE) {
        return core_fail("gfx_terrain_create: start from gfx_terrain_desc_default()");
    }
    const core_heights_data *h = &d->heights;
    if (!h->height || h->columns < 2 || h->rows < 2 || h->columns > MAX_POINTS ||
        h->rows > MAX_POINTS) {
        return core_fail("gfx_terrain_create: %ux%u heights, expected 2 to %d a side", h->columns,
                         h->rows, MAX_POINTS);
    }
    if (!(h->step_x > 0.0f && h->step_z > 0.0f) || !isfinite(h->step_x + h->step_z) ||
        !isfinite(h->origin.x + h->origin.y + h->origin.z)) {
        return core_fail("gfx_terrain_create: steps must be > 0, they and the origin finite");
    }
    for (size_t i = 0; i < (size_t)h->columns * h->rows; ++i) {
        if (!isfinite(h->height[i])) {
            return core_fail("gfx_terrain_create: the height at column %zu, row %zu is not a "
                             "finite number",
                             i % h->columns, i / h->columns);
        }
    }
    return true;
}

static float point(const gfx_terrain_store *t, uint32_t x, uint32_t z) {
    const core_heights_data *h = &t->desc.heights;
    return t->height[(size_t)CORE_MIN(z, h->rows - 1) * h->columns + CORE_MIN(x, h->columns - 1)];
}

static gfx_tile_bounds bound(const gfx_terrain_store *t, uint32_t x0, uint32_t z0) {
    gfx_tile_bounds b = {FAR, -FAR};
    for (uint32_t z = z0; z <= z0 + TILE; ++z) {
        for (uint32_t x = x0; x <= x0 + TILE; ++x) {
            float y = point(t, x, z);
            b.low = CORE_MIN(b.low, y), b.high = CORE_MAX(b.high, y);
        }
    }
    return b;
}

static gfx_tile_bounds *tile_at(const gfx_terrain_store *t, uint32_t level, uint32_t x,
                                uint32_t z) {
    return &t->bounds[level][(size_t)z * t->tiles[level][0] + x];
}

static gfx_tile_bounds join(const gfx_terrain_store *t, uint32_t level, uint32_t x, uint32_t z) {
    gfx_tile_bounds all = {FAR, -FAR};
    for (uint32_t i = 0; i < 4; ++i) {
        uint32_t cx = 2 * x + (i & 1), cz = 2 * z + (i >> 1);
        if (cx < t->tiles[level - 1][0] && cz < t->tiles[level - 1][1]) {
            const gfx_tile_bounds *b = tile_at(t, level - 1, cx, cz);
            all.low = CORE_MIN(all.low, b->low), all.high = CORE_MAX(all.high, b->high);
        }
    }
    return all;
}

static void make_level(gfx_terrain_store *t, uint32_t level) {
    const core_heights_data *h = &t->desc.heights;
    uint32_t cells = (uint32_t)TILE << level;
    uint32_t w = t->tiles[level][0] = (h->columns - 1 + cells - 1) / cells;
    uint32_t n = t->tiles[level][1] = (h->rows - 1 + cells - 1) / cells;
    t->bounds[level] = core_alloc((size_t)w * n * sizeof(gfx_tile_bounds));
    t->bytes += (size_t)w * n * sizeof(gfx_tile_bounds);
    float tallest = 0.0f;
    for (uint32_t z = 0; z < n; ++z) {
        for (uint32_t x = 0; x < w; ++x) {
            gfx_tile_bounds b = level ? join(t, level, x, z) : bound(t, x * TILE, z * TILE);
            *tile_at(t, level, x, z) = b;
            tallest = CORE_MAX(tallest, b.high - b.low);
        }
    }
    float dx = (float)cells * h->step_x, dz = (float)cells * h->step_z;
    t->diagonal[level] = core_sqrtf(dx * dx + dz * dz + tallest * tallest);
}

// Height over the triangle of a cell with corners x0..x1, z0..z1, u and v its shares.
static float on_cell(const gfx_terrain_store *t, uint32_t x0, uint32_t z0, uint32_t x1, uint32_t z1,
                     float u, float v) {
    float a = point(t, x0, z0), d = point(t, x1, z1);
    float corner = u >= v ? point(t, x1, z0) : point(t, x0, z1);
    float more = CORE_MAX(u, v), less = CORE_MIN(u, v);
    return a + (corner - a) * more + (d - corner) * less;
}

// Edges of coarse triangles run along edges and diagonals of the finest ones, so the two surfaces
// are farthest apart at a point of the grid.
static float error_of(const gfx_terrain_store *t, uint32_t level) {
    const core_heights_data *h = &t->desc.heights;
    uint32_t step = 1u << level;
    float worst = 0.0f;
    for (uint32_t z = 0; z < h->rows; ++z) {
        uint32_t z0 = z & ~(step - 1), z1 = CORE_MIN(z0 + step, h->rows - 1);
        for (uint32_t x = 0; x < h->columns; ++x) {
            uint32_t x0 = x & ~(step - 1), x1 = CORE_MIN(x0 + step, h->columns - 1);
            float u = x1 > x0 ? (float)(x - x0) / (float)(x1 - x0) : 0.0f;
            float v = z1 > z0 ? (float)(z - z0) / (float)(z1 - z0) : 0.0f;
            worst = CORE_MAX(worst, core_absf(on_cell(t, x0, z0, x1, z1, u, v) - point(t, x, z)));
        }
    }
    return worst;
}

static void make_store(gfx_terrain_store *t, const gfx_terrain_desc *desc) {
    const core_heights_data *h = &desc->heights;
    size_t bytes = (size_t)h->columns * h->rows * sizeof(float);
    *t = (gfx_terrain_store){.desc = *desc, .bytes = bytes};
    t->height = core_alloc(bytes);
    memcpy(t->height, h->height, bytes);
    t->desc.heights.height = t->height;
    t->desc.image = NULL;
    snprintf(t->image, sizeof t->image, "%s", desc->image ? desc->image : "");
    uint32_t cells = CORE_MAX(h->columns, h->rows) - 1;
    do {
        make_level(t, t->levels);
        t->error[t->levels] = t->levels ? error_of(t, t->levels) : 0.0f;
    } while ((uint32_t)TILE << t->levels++ < cells && t->levels < GFX_TERRAIN_LEVELS);
}

gfx_terrain gfx_terrain_create(gfx_world *world, const gfx_terrain_desc *desc) {
    if (!check(desc)) {
        return CORE_NULL_HANDLE;
    }
    if (!world->terrains) {
        gfx_terrains *all = core_alloc(sizeof *all);
        if (!gfx_terrain_rows_init(&all->rows, "gfx.terrains", MAX_TERRAINS)) {
            core_free(all);
            return CORE_NULL_HANDLE;
        }
        world->terrains = all;
    }
    gfx_terrain_rows *rows = &world->terrains->rows;
    gfx_terrain terrain = core_columns_add(&rows->set);
    uint32_t row = core_columns_row(&rows->set, terrain);
    if (row != CORE_NO_ROW) {
        make_store(&rows->store[row], desc);
        world->heap_bytes += rows->store[row].bytes;
        world->terrains->version++;
    }
    return terrain;
}

static void release(gfx_terrain_store *t) {
    core_free(t->height);
    for (uint32_t i = 0; i < t->levels; ++i) {
        core_free(t->bounds[i]);
    }
}

void gfx_terrains_destroy(gfx_terrains *t) {
    if (t) {
        for (uint32_t i = 0; i < core_columns_count(&t->rows.set); ++i) {
            release(&t->rows.store[i]);
        }
        core_columns_release(&t->rows.set);
        core_free(t);
    }
}

static gfx_terrain_store *store_of(const gfx_world *world, gfx_terrain terrain) {
    gfx_terrains *t = world->terrains;
    uint32_t row = t ? core_columns_row(&t->rows.set, terrain) : CORE_NO_ROW;
    return row == CORE_NO_ROW ? NULL : &t->rows.store[row];
}

bool gfx_terrain_alive(const gfx_world *world, gfx_terrain terrain) {
    return store_of(world, terrain) != NULL;
}

bool gfx_terrain_destroy(gfx_world *world, gfx_terrain terrain) {
    gfx_terrain_store *t = store_of(world, terrain);
    if (!t) {
        return core_fail("gfx_terrain_destroy: the handle is stale or null");
    }
    world->heap_bytes -= t->bytes;
    release(t);
    world->terrains->version++;
    return core_columns_remove(&world->terrains->rows.set, terrain, NULL, NULL);
}

bool gfx_terrain_height(const gfx_world *world, gfx_terrain terrain, float x, float z,
                        float *height) {
    const gfx_terrain_store *t = store_of(world, terrain);
    if (!t) {
        return core_fail("gfx_terrain_height: the handle is stale or null");
    }
    const core_heights_data *h = &t->desc.heights;
    float u = (x - h->origin.x) / h->step_x, v = (z - h->origin.z) / h->step_z;
    if (!(u >= 0.0f && v >= 0.0f && u <= (float)(h->columns - 1) && v <= (float)(h->rows - 1))) {
        return false; // beside it
    }
    uint32_t i = CORE_MIN((uint32_t)u, h->columns - 2), k = CORE_MIN((uint32_t)v, h->rows - 2);
    *height = h->origin.y + on_cell(t, i, k, i + 1, k + 1, u - (float)i, v - (float)k);
    return true;
}

// ---- what a view shows ----

void gfx_terrain_choose(const gfx_terrain_store *t, const gfx_view *view, float pixels,
                        float tolerance, gfx_terrain_levels *out) {
    // Pixels a metre across the view at a distance of 1 m: at the corners of the picture the depth
    // is less than the distance.
    float corner = 1.0f + view->tan_x * view->tan_x + view->tan_y * view->tan_y;
    float scale = 0.5f * pixels / view->tan_y / CORE_MAX(tolerance, 1e-4f);
    scale *= view->orthographic ? 1.0f : core_sqrtf(corner);
    *out = (gfx_terrain_levels){.eye = view->position};
    float before = 0.0f;
    for (uint32_t i = 0; i + 1 < t->levels; ++i) {
        if (view->orthographic) { // one level for everything
            bool coarser = t->error[i + 1] * scale <= 1.0f;
            out->start[i] = coarser ? -2.0f : FAR;
            out->end[i] = coarser ? -1.0f : 2.0f * FAR;
            continue;
        }
        // A tile next to a coarser one must have turned into it, and that one not yet begun to
        // turn: it lies at most one diagonal farther out.
        float start = CORE_MAX(before + t->diagonal[i], t->error[i + 1] * scale);
        out->start[i] = start;
        before = out->end[i] = start * MORPH;
    }
    out->start[t->levels - 1] = FAR;
    out->end[t->levels - 1] = 2.0f * FAR;
}

typedef struct box {
    core_vec3 low, high;
} box;

static box tile_box(const gfx_terrain_store *t, uint32_t level, uint32_t x, uint32_t z) {
    const core_heights_data *h = &t->desc.heights;
    const gfx_tile_bounds *b = tile_at(t, level, x, z);
    uint32_t cells = (uint32_t)TILE << level;
    float x1 = (float)CORE_MIN((x + 1) * cells, h->columns - 1);
    float z1 = (float)CORE_MIN((z + 1) * cells, h->rows - 1);
    core_vec3 low = {(float)(x * cells) * h->step_x, b->low, (float)(z * cells) * h->step_z};
    core_vec3 high = {x1 * h->step_x, b->high, z1 * h->step_z};
    return (box){core_v3_add(h->origin, low), core_v3_add(h->origin, high)};
}

static bool box_outside(const box *b, const gfx_view *v) {
    for (int i = 0; i < GFX_PLANES; ++i) {
        const float *p = v->plane[i];
        float d = p[3] + p[0] * (p[0] > 0.0f ? b->high.x : b->low.x) +
                  p[1] * (p[1] > 0.0f ? b->high.y : b->low.y) +
                  p[2] * (p[2] > 0.0f ? b->high.z : b->low.z);
        if (d < 0.0f) {
            return true;
        }
    }
    return false;
}

static float box_distance(const box *b, core_vec3 p) {
    core_vec3 d = {CORE_MAX(CORE_MAX(b->low.x - p.x, p.x - b->high.x), 0.0f),
                   CORE_MAX(CORE_MAX(b->low.y - p.y, p.y - b->high.y), 0.0f),
                   CORE_MAX(CORE_MAX(b->low.z - p.z, p.z - b->high.z), 0.0f)};
    return core_v3_length(d);
}

// At most one path of the tree is open, four tiles a level.
typedef struct tile_at_level {
    uint32_t level, x, z;
} tile_at_level;

uint32_t gfx_terrain_select(const gfx_terrain_store *t, const gfx_terrain_levels *levels,
                            const gfx_view *view, gfx_growing *tiles) {
    tile_at_level open[4 * GFX_TERRAIN_LEVELS] = {{t->levels - 1, 0, 0}};
    uint32_t count = 1, before = (uint32_t)tiles->count;
    while (count) {
        tile_at_level at = open[--count];
        box b = tile_box(t, at.level, at.x, at.z);
        if (box_outside(&b, view)) {
            continue;
        }
        if (at.level == 0 || !(box_distance(&b, levels->eye) < levels->end[at.level - 1])) {
            uint32_t cells = (uint32_t)TILE << at.level;
            *(gfx_tile *)gfx_grow(tiles, sizeof(gfx_tile), 1) =
                (gfx_tile){at.x * cells, at.z * cells, at.level, 0};
            continue;
        }
        for (uint32_t i = 0; i < 4; ++i) {
            uint32_t x = 2 * at.x + (i & 1), z = 2 * at.z + (i >> 1);
            if (x < t->tiles[at.level - 1][0] && z < t->tiles[at.level - 1][1]) {
                open[count++] = (tile_at_level){at.level - 1, x, z};
            }
        }
    }
    return (uint32_t)tiles->count - before;
}

void gfx_terrains_extent(const gfx_world *world, core_vec3 along, float *low, float *high) {
    const gfx_terrains *all = world->terrains;
    for (uint32_t i = 0; all && i < core_columns_count(&all->rows.set); ++i) {
        const gfx_terrain_store *t = &all->rows.store[i];
        box b = tile_box(t, t->levels - 1, 0, 0);
        for (int corner = 0; corner < 8; ++corner) {
            float d = along.x * (corner & 1 ? b.high.x : b.low.x) +
                      along.y * (corner & 2 ? b.high.y : b.low.y) +
                      along.z * (corner & 4 ? b.high.z : b.low.z);
            *low = CORE_MIN(*low, d), *high = CORE_MAX(*high, d);
        }
    }
}
