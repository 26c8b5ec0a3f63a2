// Spots against cluster cells. What a spot lights is convex, and so is a cell: where they are
// apart, a plane lies between them. Two are tried, one tangent to the cone's side, one across the
// way from apex to cell; the cell is out of reach when all of its corners are beyond either. Any
// such plane is a valid one, so that no lit cell is ever dropped; where the cell's centre lies only
// makes the choice good.
#ifndef GFX_CLUSTER_CONE_H
#define GFX_CLUSTER_CONE_H

#include "core/math.h"

typedef struct gfx_cluster_cone { // view space: x right, y up, depth ahead
    float apex[3], sine;
    float axis[3], cosine; // unit; sine and cosine of the half angle, below a right angle. Cosine
                           // 0: no cone
    float range;           // m, from the apex
} gfx_cluster_cone;

// A cell's corners: x and y in metres, or for each metre of depth (perspective).
typedef struct gfx_cluster_cell_bounds {
    float x[2], y[2], depth[2];
    bool orthographic;
} gfx_cluster_cell_bounds;

static inline float gfx_cluster_least(float factor, const float bound[2]) {
    float a = factor * bound[0], b = factor * bound[1];
    return a < b ? a : b;
}

// How far a cell's nearest corner is ahead of a point, along n.
static inline float gfx_cluster_ahead(const gfx_cluster_cell_bounds *b, const float n[3],
                                      const float from[3]) {
    float side = gfx_cluster_least(n[0], b->x) + gfx_cluster_least(n[1], b->y);
    float least = b->orthographic ? side + gfx_cluster_least(n[2], b->depth)
                                  : gfx_cluster_least(side + n[2], b->depth);
    return least - (n[0] * from[0] + n[1] * from[1] + n[2] * from[2]);
}

// The vectors' form is cone_mask in gfx_cluster.simd.c, the GPU's coneMisses in cluster.comp.
static inline bool gfx_cluster_cone_misses(const gfx_cluster_cone *c,
                                           const gfx_cluster_cell_bounds *b) {
    float middle = 0.5f * (b->depth[0] + b->depth[1]), scale = b->orthographic ? 1.0f : middle;
    const float way[3] = {0.5f * (b->x[0] + b->x[1]) * scale - c->apex[0],
                          0.5f * (b->y[0] + b->y[1]) * scale - c->apex[1], middle - c->apex[2]};
    float along = way[0] * c->axis[0] + way[1] * c->axis[1] + way[2] * c->axis[2], off2 = 0.0f;
    float normal[3]; // of the side's plane, as long as the centre is off the axis
    for (int k = 0; k < 3; ++k) {
        normal[k] = way[k] - along * c->axis[k];
        off2 += normal[k] * normal[k];
    }
    float off = core_sqrtf(off2), length = core_sqrtf(off2 + along * along);
    for (int k = 0; k < 3; ++k) {
        normal[k] = c->cosine * normal[k] - c->sine * off * c->axis[k];
    }
    // How far the lit part reaches along the way: to its round end, or to the rim of it.
    float rim = along * c->cosine + off * c->sine;
    float reach = along >= length * c->cosine ? length : CORE_MAX(rim, 0.0f);
    return gfx_cluster_ahead(b, normal, c->apex) > 0.0f ||
           gfx_cluster_ahead(b, way, c->apex) > c->range * reach;
}

#endif
