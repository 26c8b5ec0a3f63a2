// What kernels of joints share: velocities of two bodies in lanes, inertia, anchors. For *.simd.c.
#ifndef PHYS_JOINT_WIDE_H
#define PHYS_JOINT_WIDE_H

#include "phys/joint_solve.h"
#include "phys/rows.h"

typedef struct wide_motion { // of both bodies
    rows3 va, wa, vb, wb;
} wide_motion;

typedef struct wide_inertia {
    rows3 diagonal, off; // xx yy zz, xy xz yz
} wide_inertia;

ROWS_INLINE rows3 wide_turn(const wide_inertia *i, rows3 v) {
    return (rows3){
        vf_add(vf_add(vf_mul(i->diagonal.x, v.x), vf_mul(i->off.x, v.y)), vf_mul(i->off.y, v.z)),
        vf_add(vf_add(vf_mul(i->off.x, v.x), vf_mul(i->diagonal.y, v.y)), vf_mul(i->off.z, v.z)),
        vf_add(vf_add(vf_mul(i->off.y, v.x), vf_mul(i->off.z, v.y)), vf_mul(i->diagonal.z, v.z))};
}

ROWS_INLINE wide_inertia wide_inertia_of(const soft_bodies *s, const int32_t *at) {
    return (wide_inertia){rows_gather(s->inertia, at, 0), rows_gather(s->inertia, at, 4)};
}

ROWS_INLINE rows3 wide_get(float from[3][SOFT_LANES], int k) {
    return rows_load(from[0] + k, from[1] + k, from[2] + k);
}
ROWS_INLINE void wide_set(float to[3][SOFT_LANES], int k, rows3 v) {
    rows_store(to[0] + k, to[1] + k, to[2] + k, v);
}

// Anchor in the world; its arm goes to out.
ROWS_INLINE rows3 wide_anchor(const joint_poses *p, const int32_t *at, rows3 local, int k,
                              float out[3][SOFT_LANES]) {
    rows3 u = rows_gather(p->pose, at, 4), w = rows_gather(p->real, at, 0);
    rows3 t = rows_cross(u, local);
    t = rows_add(t, t);
    rows3 arm = rows_add(rows_mad(local, t, w.x), rows_cross(u, t));
    wide_set(out, k, arm);
    return rows_add(rows_gather(p->pose, at, 0), arm);
}

// Lanes whose body stays leave zeros at the row of empty lanes.
ROWS_INLINE void wide_put(float *to, const int32_t *at, vf mass, int offset, rows3 v) {
    vm moves = vf_gt(mass, vf_zero());
    rows_scatter(to, at, offset,
                 (rows3){vf_keep(moves, v.x), vf_keep(moves, v.y), vf_keep(moves, v.z)});
}

#endif
