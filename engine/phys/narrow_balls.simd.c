// Ball against ball, wide: rows [begin, end) of the ball contacts, begin a multiple of 16.
#include "phys/rows.h"
#include "phys/world.h"

void CORE_SIMD_NAME(phys_narrow_balls)(phys_world *w, uint32_t begin, uint32_t end, float dt) {
    phys_balls *c = &w->balls;
    const phys_bodies *b = &w->bodies;
    const vf zero = vf_zero(), margin = vf_set1(PHYS_MARGIN);
    for (uint32_t i = begin; i < end; i += CORE_SIMD_WIDTH) {
        vm in = vm_first((int)(end - i)); // columns are padded: rows beyond the end hold row 0
        vi ia = vi_keep(in, vi_load((const int32_t *)c->a + i));
        vi ib = vi_keep(in, vi_load((const int32_t *)c->b + i));
        vf dx = vf_sub(vf_gather(b->cx, ib), vf_gather(b->cx, ia));
        vf dy = vf_sub(vf_gather(b->cy, ib), vf_gather(b->cy, ia));
        vf dz = vf_sub(vf_gather(b->cz, ib), vf_gather(b->cz, ia));
        vf length = vf_sqrt(rows_dot((rows3){dx, dy, dz}, (rows3){dx, dy, dz}));
        vm some = vf_gt(length, vf_set1(1e-9f));
        vf inv = vf_div(vf_set1(1.0f), vf_select(some, length, vf_set1(1.0f)));
        // Equal centres have no direction: any one serves, upwards parts a pile soonest.
        vf nx = vf_keep(some, vf_mul(dx, inv)), nz = vf_keep(some, vf_mul(dz, inv));
        vf ny = vf_select(some, vf_mul(dy, inv), vf_set1(1.0f));
        vf gap = vf_sub(length, vf_load(c->reach + i));
        // Slow pairs count within the margin and as far as they can close in this step. Fast ones
        // that do not touch yet count when they meet on their way, with the normal of that moment.
        vf ux = vf_sub(vf_gather(b->vx, ib), vf_gather(b->vx, ia));
        vf uy = vf_sub(vf_gather(b->vy, ib), vf_gather(b->vy, ia));
        vf uz = vf_sub(vf_gather(b->vz, ib), vf_gather(b->vz, ia));
        rows3 d = {dx, dy, dz}, u = {ux, uy, uz};
        vf speed2 = rows_dot(u, u), along = rows_dot(d, u), touch = vf_load(c->reach + i);
        vf closing = vf_neg(rows_dot((rows3){nx, ny, nz}, u));
        vm close = vf_le(gap, vf_add(margin, vf_mul(vf_max(closing, zero), vf_set1(dt))));
        vm fast = vm_and(vf_gt(speed2, vf_set1(PHYS_FAST * PHYS_FAST / (dt * dt))),
                         vf_gt(gap, vf_set1(PHYS_NEAR)));
        vf c2 = vf_sub(rows_dot(d, d), vf_mul(touch, touch));
        vf disc = vf_sub(vf_mul(along, along), vf_mul(speed2, c2));
        vf root = vf_sqrt(vf_max(disc, zero));
        vf t = vf_div(vf_sub(vf_neg(along), root), vf_select(fast, speed2, vf_set1(1.0f)));
        vm meets = vm_and(vm_and(vf_ge(disc, zero), vf_lt(along, zero)), vf_le(t, vf_set1(dt)));
        rows3 at = rows_mul(rows_mad(d, u, t), rows_inverse(touch));
        nx = vf_select(fast, at.x, nx);
        ny = vf_select(fast, at.y, ny);
        nz = vf_select(fast, at.z, nz);
        gap = vf_select(fast, vf_sub(rows_dot(d, (rows3){nx, ny, nz}), touch), gap);
        vm fixed = vf_ge(touch, vf_set1(PHYS_APART)); // done one by one afterwards
        vm near = vm_or(fixed, vm_or(vm_andnot(close, fast), vm_and(fast, meets)));
        vf_store(c->nx + i, nx);
        vf_store(c->ny + i, ny);
        vf_store(c->nz + i, nz);
        vf_store(c->separation + i, vf_select(near, gap, vf_set1(PHYS_APART)));
        vf_store(c->jn + i, vf_keep(near, vf_load(c->jn + i)));
        vf_store(c->jx + i, vf_keep(near, vf_load(c->jx + i)));
        vf_store(c->jy + i, vf_keep(near, vf_load(c->jy + i)));
        vf_store(c->jz + i, vf_keep(near, vf_load(c->jz + i)));
        vf_store(c->rx + i, vf_keep(near, vf_load(c->rx + i)));
        vf_store(c->ry + i, vf_keep(near, vf_load(c->ry + i)));
        vf_store(c->rz + i, vf_keep(near, vf_load(c->rz + i)));
    }
}
