// What the wide method of cluster assignment and its kernels share. The kernels work on one slice
// at a time with one lane a light, then one lane a row, then one lane a column.
#ifndef GFX_CLUSTER_WIDE_H
#define GFX_CLUSTER_WIDE_H

#include "core/simd.h"
#include "gfx/gfx_cluster.h"

// Planes that bound columns or rows: n . (s, depth) + c, with unit n, rises with s.
typedef struct gfx_cluster_planes {
    float ns[GFX_CLUSTER_SIDE + CORE_LANES], nd[GFX_CLUSTER_SIDE + CORE_LANES],
        nc[GFX_CLUSTER_SIDE + CORE_LANES];
} gfx_cluster_planes;

// Bounds and middles of columns or rows, as gfx_cluster_cell_bounds_of gives them.
typedef struct gfx_cluster_strips {
    float lo[GFX_CLUSTER_SIDE + CORE_LANES], hi[GFX_CLUSTER_SIDE + CORE_LANES],
        mid[GFX_CLUSTER_SIDE + CORE_LANES];
} gfx_cluster_strips;

// Lights that may be in view, packed, with what does not depend on the slice.
typedef struct gfx_cluster_packed {
    uint32_t count; // columns are valid to the next multiple of CORE_LANES, with lo > hi there
    float *x, *y, *depth, *radius;
    float *lo, *hi;         // depth -+ radius
    float *inv_lo, *inv_hi; // 1/lo where lo > 0 (else huge), 1/hi
    // Slope and depth of the tangents from the eye on the four sides; depth < 0 where there is
    // none.
    float *slope[4], *at[4]; // left, right, bottom, top
    uint32_t *id;
} gfx_cluster_packed;
enum { GFX_CLUSTER_PACKED_COLUMNS = 17 };

typedef struct gfx_cluster_wide {
    const gfx_cluster_grid *grid;
    // For each mask of eight lanes, those that it keeps, packed: sets without a compressing store.
    uint8_t kept[256][8];
    gfx_cluster_planes column, row;
    float slice_lo[GFX_CLUSTER_SIDE], slice_hi[GFX_CLUSTER_SIDE]; // widened bounds
    float scale_x, scale_y, mid_x, mid_y;                         // slope to column, row
    float margin;                                                 // of a column or row
    gfx_cluster_strips columns, rows;
    const gfx_cluster_cone *cone; // by light; NULL when none has one
    gfx_cluster_packed packed;
} gfx_cluster_wide;

// One slice's lists: a growing block of lights, and where each of its cells ends in it.
typedef struct gfx_cluster_slice {
    uint32_t *light;
    size_t bytes;
    uint32_t total;
    uint32_t end[GFX_CLUSTER_SIDE * GFX_CLUSTER_SIDE];
} gfx_cluster_slice;

// Records of one slice by (row, group of 16 columns): light and the columns it touches.
typedef struct gfx_cluster_records {
    uint32_t *id;   // [lists][stride]
    uint16_t *mask; // [lists][stride]
    size_t stride;
    uint32_t count[GFX_CLUSTER_SIDE * GFX_CLUSTER_SIDE / 16];
} gfx_cluster_records;

// Packs lights [begin, end) that touch the view into columns from `out` on; returns how many.
CORE_SIMD_DECLARE(uint32_t, gfx_cluster_pack,
                  (const gfx_cluster_wide *w, const gfx_cluster_lights *l))
// Fills the records of slice k; returns the number of (light, cell) pairs.
CORE_SIMD_DECLARE(uint32_t, gfx_cluster_record,
                  (const gfx_cluster_wide *w, uint32_t k, gfx_cluster_records *out))
// Turns records into one ascending list a cell.
CORE_SIMD_DECLARE(void, gfx_cluster_compact,
                  (const gfx_cluster_wide *w, const gfx_cluster_records *r, gfx_cluster_slice *out))

void gfx_clusters_assign_wide(gfx_clusters *c, const gfx_cluster_grid *grid,
                              const gfx_cluster_lights *lights, core_jobs *jobs);
void gfx_clusters_wide_release(gfx_clusters *c);

#endif
