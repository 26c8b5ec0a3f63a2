// Poses of jointed bodies during a step, wide: where they were at its start and how they moved.
#include "phys/joint_wide.h"

// Rotation of a turn t, as half_turn of integrate.c has it: sine and cosine by their series, of
// unit length by division.
void CORE_SIMD_NAME(phys_joint_poses)(joint_poses *p, uint32_t begin, uint32_t end,
                                      const soft_bodies *bodies) {
    for (uint32_t i = begin; i < end; i += CORE_SIMD_WIDTH) {
        int32_t self[CORE_SIMD_WIDTH];
        for (int k = 0; k < CORE_SIMD_WIDTH; k++) {
            self[k] = (int32_t)i + k;
        }
        rows3 way = rows_gather(bodies->moved, p->place + i, 0);
        rows3 t = rows_mul(rows_gather(bodies->moved, p->place + i, 4), vf_set1(0.5f));
        vf x = rows_dot(t, t), one = vf_set1(1.0f);
        vf s = vf_mad(x, vf_mad(x, vf_set1(1.0f / 120.0f), vf_set1(-1.0f / 6.0f)), one);
        vf c = vf_mad(x, vf_set1(-1.0f / 720.0f), vf_set1(1.0f / 24.0f));
        c = vf_mad(x, vf_mad(x, c, vf_set1(-0.5f)), one);
        rows3 u = rows_mul(t, s);
        vf inv = vf_div(one, vf_sqrt(vf_mad(c, c, rows_dot(u, u))));
        u = rows_mul(u, inv);
        c = vf_mul(c, inv);
        rows3 q = rows_gather(p->start, self, 4), w = rows_gather(p->start_real, self, 0);
        rows3 next = rows_add(rows_mad(rows_mul(q, c), u, w.x), rows_cross(u, q));
        rows3 real = {vf_sub(vf_mul(c, w.x), rows_dot(u, q)), vf_zero(), vf_zero()};
        rows_scatter(p->pose, self, 0, rows_add(rows_gather(p->start, self, 0), way));
        rows_scatter(p->pose, self, 4, next);
        rows_scatter(p->real, self, 0, real);
    }
}
