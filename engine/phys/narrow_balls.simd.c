// Ball against ball, wide: rows [begin, end) of the ball contacts, begin a multiple of 16.
#include "phys/rows.h"
#include "phys/world.h"

static vf gather_dot(const float *x, vi a, vi b, vf n) {
    return vf_mul(vf_sub(vf_gather(x, a), vf_gather(x, b)), n);
}

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
        // Far pairs count only when the gap can close within this step.
        vf speed = vf_add(vf_add(gather_dot(b->vx, ia, ib, nx), gather_dot(b->vy, ia, ib, ny)),
                          gather_dot(b->vz, ia, ib, nz));
        vf reach = vf_add(margin, vf_mul(vf_max(speed, zero), vf_set1(dt)));
        vm near = vf_le(gap, reach);
        vf_store(c->nx + i, nx);
        vf_store(c->ny + i, ny);
        vf_store(c->nz + i, nz);
        vf_store(c->separation + i, vf_select(near, gap, vf_set1(PHYS_APART)));
        vf_store(c->jn + i, vf_keep(near, vf_load(c->jn + i)));
        vf_store(c->jx + i, vf_keep(near, vf_load(c->jx + i)));
        vf_store(c->jy + i, vf_keep(near, vf_load(c->jy + i)));
        vf_store(c->jz + i, vf_keep(near, vf_load(c->jz + i)));
    }
}
