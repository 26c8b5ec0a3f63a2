// Clustered light assignment: which point and spot lights reach which cell of a grid over the view.
// Pure data, no GL. Olsson, Billeter, Assarsson, "Clustered Deferred and Forward Shading" (2012).
//
// The grid is columns x rows x slices over the view volume. Cell (i, j, k) has the number
// (k * rows + j) * columns + i; row 0 is at the bottom, slice 0 at the camera. Every method gives
// each cell an ascending list that holds each light whose sphere, and cone if it has one, touches
// it.
#ifndef GFX_CLUSTER_H
#define GFX_CLUSTER_H

#include "core/jobs.h"
#include "core/math.h"
#include "gfx/gfx_cluster_cone.h"

enum { GFX_CLUSTER_SIDE = 64 }; // most columns, rows, slices

typedef struct gfx_cluster_grid {
    uint32_t columns, rows, slices;
    bool linear;       // slices of equal depth, else exponential
    bool orthographic; // tan_x, tan_y are then half extents in metres
    float tan_x, tan_y;
    float near_plane, far; // m: the slices' first and last bound
    // slice of a depth = floor(along(depth) * scale + bias), along = depth or log2(depth), clamped
    float scale, bias;
    float depth[GFX_CLUSTER_SIDE + 1]; // bounds of the slices
    float x[GFX_CLUSTER_SIDE + 1];     // bounds of the columns: x/depth, or x (orthographic)
    float y[GFX_CLUSTER_SIDE + 1];
} gfx_cluster_grid;

// first_slice: depth (m) of the first slice's end, so that the rest are spent where lights are; 0
// takes all slices from near_plane, z_k = near (far/near)^(k/slices). Ignored for linear slices.
void gfx_cluster_grid_make(gfx_cluster_grid *grid, const uint32_t size[3], bool linear,
                           float first_slice, bool orthographic, float tan_x, float tan_y,
                           float near_plane, float far);
static inline uint32_t gfx_cluster_cells(const gfx_cluster_grid *g) {
    return g->columns * g->rows * g->slices;
}
// Cell of a point of the view (depth > 0) as the shader finds it: u, v in [0, 1) across the
// picture.
uint32_t gfx_cluster_cell(const gfx_cluster_grid *grid, float u, float v, float depth);

// Bounding spheres of point and spot lights in view space: x right, y up, depth ahead. Radii carry
// the margin for the rounding of everything that follows. Columns are 64-byte aligned and may be
// read and written up to a multiple of CORE_LANES.
typedef struct gfx_cluster_lights {
    uint32_t count, spots; // spots: how many have a cone
    float *x, *y, *depth, *radius;
    gfx_cluster_cone *cone; // [count], read when spots > 0
    void *block;            // private
    size_t capacity;        // of each column, in lights; private
} gfx_cluster_lights;
// Makes room for `count` spheres without cones. Contents are lost.
void gfx_cluster_lights_reserve(gfx_cluster_lights *lights, uint32_t count);
void gfx_cluster_lights_release(gfx_cluster_lights *lights);

typedef enum gfx_cluster_method {
    GFX_CLUSTER_NAIVE,     // every cell's box against every light: the reference
    GFX_CLUSTER_PER_LIGHT, // exact bounds of each light in each slice, scalar
    GFX_CLUSTER_SIMD,      // the same, refined by row, in vectors and threads
    GFX_CLUSTER_METHODS,
    GFX_CLUSTER_GPU =
        GFX_CLUSTER_METHODS // naive in a compute shader: the device's, not of this file
} gfx_cluster_method;
const char *gfx_cluster_method_name(gfx_cluster_method method);

typedef struct gfx_clusters { // zero-initialise; keeps its memory between calls
    uint32_t *offset;         // [cells + 1]: list of cell c is light[offset[c] .. offset[c + 1])
    uint32_t *light;          // [total]
    uint32_t total;
    size_t offset_bytes, light_bytes;
    void *scratch; // per_light: rectangles
    size_t scratch_bytes;
    void *wide; // simd: packed lights and records
} gfx_clusters;

void gfx_clusters_assign(gfx_clusters *c, const gfx_cluster_grid *grid,
                         const gfx_cluster_lights *lights, gfx_cluster_method method,
                         core_jobs *jobs);
// Empties lists of more than `cap` lights and marks their cells by `mark` in the offset, for the
// shader to take all lights there; returns how many.
uint32_t gfx_clusters_cap(gfx_clusters *c, uint32_t cells, uint32_t cap, uint32_t mark);
void gfx_clusters_release(gfx_clusters *c);

// First 64-byte boundary in a block that was made CORE_ALIGN bytes too large.
static inline void *gfx_cluster_align(void *block) {
    return (void *)(((uintptr_t)block + CORE_ALIGN - 1) / CORE_ALIGN * CORE_ALIGN);
}

// For the methods: the results' storage, offsets zeroed; and a slice's bounds, widened for
// rounding.
void gfx_clusters_reserve_offsets(gfx_clusters *c, uint32_t cells);
void gfx_clusters_reserve_lights(gfx_clusters *c, size_t total);
void gfx_cluster_slice_bounds(const gfx_cluster_grid *g, uint32_t k, float *lo, float *hi);
// Corners of a cell, widened too.
void gfx_cluster_cell_bounds_of(const gfx_cluster_grid *g, uint32_t column, uint32_t row,
                                uint32_t slice, gfx_cluster_cell_bounds *out);
// Whether a light's cone, if it has one, may touch a cell.
static inline bool gfx_cluster_cone_reaches(const gfx_cluster_lights *l, uint32_t light,
                                            const gfx_cluster_cell_bounds *b) {
    return l->spots == 0 || l->cone[light].cosine == 0.0f ||
           !gfx_cluster_cone_misses(&l->cone[light], b);
}
// The shader finds a fragment's cell from rounded coordinates; bounds are widened by these parts of
// a column or row, and of a slice.
#define GFX_CLUSTER_TILE_MARGIN  1e-3f
#define GFX_CLUSTER_SLICE_MARGIN 2e-3f

#endif
