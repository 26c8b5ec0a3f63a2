// Terrain without GL: a quadtree of tiles over a field of heights, and which of them a view shows.
// Continuous distance-dependent levels of detail (Strugar, "Continuous Distance-Dependent Level of
// Detail for Rendering Heightmaps", JGT 2009) with bounds chosen by the measured error of each
// level instead of by hand.
#ifndef GFX_TERRAIN_H
#define GFX_TERRAIN_H

#include "gfx/gfx_internal.h"

// A tile of level L is GFX_TERRAIN_TILE x GFX_TERRAIN_TILE squares of 2^L x 2^L cells.
typedef struct gfx_tile_bounds {
    float low, high; // m
} gfx_tile_bounds;

typedef struct gfx_terrain_store {
    gfx_terrain_desc desc; // heights.height: ours
    char image[CORE_NAME_MAX];
    float *height;
    uint32_t levels;
    gfx_tile_bounds *bounds[GFX_TERRAIN_LEVELS]; // [tiles_z * tiles_x]
    uint32_t tiles[GFX_TERRAIN_LEVELS][2];
    float error[GFX_TERRAIN_LEVELS];    // m: farthest that a level's surface is off the finest
    float diagonal[GFX_TERRAIN_LEVELS]; // m: of a level's largest tile
    size_t bytes;
} gfx_terrain_store;

#define GFX_TERRAIN_COLUMNS(X) X(gfx_terrain_store, store, 0)
CORE_COLUMNS_DECLARE(gfx_terrain_rows, GFX_TERRAIN_COLUMNS)

typedef struct gfx_terrains { // of a world; made with its first terrain
    gfx_terrain_rows rows;
    uint64_t version;
} gfx_terrains;
void gfx_terrains_destroy(gfx_terrains *t);
// Widens an interval along a direction by all terrains.
void gfx_terrains_extent(const gfx_world *world, core_vec3 along, float *low, float *high);

// Level L is drawn as it is up to start[L] from the eye, turns into the next one until end[L], and
// is not needed beyond.
typedef struct gfx_terrain_levels {
    core_vec3 eye;
    float start[GFX_TERRAIN_LEVELS], end[GFX_TERRAIN_LEVELS]; // m
} gfx_terrain_levels;
// tolerance: pixels that the surface may be off; pixels: height of the picture.
void gfx_terrain_choose(const gfx_terrain_store *t, const gfx_view *view, float pixels,
                        float tolerance, gfx_terrain_levels *out);
// Appends x, z (cells), level, 0 of the tiles in the view: gfx_tile. Returns how many.
typedef struct gfx_tile {
    uint32_t x, z, level, unused;
} gfx_tile;
uint32_t gfx_terrain_select(const gfx_terrain_store *t, const gfx_terrain_levels *levels,
                            const gfx_view *view, gfx_growing *tiles);

#endif
