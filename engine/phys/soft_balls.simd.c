// Ball contacts, wide: one point, scalar inertia, friction as one vector in the tangent plane.
#include "phys/soft.h"

#include "phys/rows.h"

static void warm(ball_block *c, int k, soft_bodies *s, bool fixed) {
    rows3 n = rows_load(c->nx + k, c->ny + k, c->nz + k);
    rows3 j = rows_load(c->jx + k, c->jy + k, c->jz + k);
    vf ima = vf_load(c->ima + k), imb = vf_load(c->imb + k);
    vf jn = vf_load(c->jn + k);
    vf ka = vf_mul(vf_load(c->ra + k), vf_load(c->ia + k));
    vf kb = vf_mul(vf_load(c->rb + k), vf_load(c->ib + k));
    vf mass = vf_add(ima, imb);
    vf turn = vf_add(vf_mul(vf_load(c->ra + k), ka), vf_mul(vf_load(c->rb + k), kb));
    vf_store(c->mn + k, rows_inverse(mass));
    vf_store(c->mt + k, rows_inverse(vf_add(mass, turn)));
    vf_store(c->approach + k, vf_zero());
    j = rows_msub(j, n, rows_dot(j, n)); // the normal has turned since
    vf_store(c->jx + k, j.x);
    vf_store(c->jy + k, j.y);
    vf_store(c->jz + k, j.z);
    rows3 p = rows_mad(j, n, jn), turned = rows_cross(n, j);
    rows3 roll = rows_load(c->rx + k, c->ry + k, c->rz + k);
    rows3 va = rows_gather(s->velocity, c->a + k, 0), wa = rows_gather(s->velocity, c->a + k, 4);
    rows_scatter(s->velocity, c->a + k, 0, rows_msub(va, p, ima));
    wa = rows_msub(rows_msub(wa, turned, ka), roll, vf_load(c->ia + k));
    rows_scatter(s->velocity, c->a + k, 4, wa);
    if (!fixed) {
        rows3 vb = rows_gather(s->velocity, c->b + k, 0);
        rows3 wb = rows_gather(s->velocity, c->b + k, 4);
        rows_scatter(s->velocity, c->b + k, 0, rows_mad(vb, p, imb));
        wb = rows_mad(rows_msub(wb, turned, kb), roll, vf_load(c->ib + k));
        rows_scatter(s->velocity, c->b + k, 4, wb);
    }
}

ROWS_INLINE vf gap_now(const ball_block *c, int k, const soft_bodies *s, rows3 n, bool fixed) {
    rows3 d, pa = rows_gather(s->moved, c->a + k, 0);
    d = fixed ? rows_zero() : rows_gather(s->moved, c->b + k, 0);
    return vf_add(vf_load(c->gap + k), rows_dot(rows_sub(d, pa), n));
}

// Remembers the fastest approach that the contact had to stop: what restitution gives back.
ROWS_INLINE void note_approach(ball_block *c, int k, vf impulse, vf vn) {
    vf fast = vf_load(c->approach + k);
    vm hit = vf_gt(impulse, vf_zero());
    vf_store(c->approach + k, vf_select(hit, vf_min(fast, vn), fast));
}

static void solve(ball_block *c, int k, soft_bodies *s, const soft_spring *spring, bool fixed) {
    rows3 n = rows_load(c->nx + k, c->ny + k, c->nz + k);
    vf gap = gap_now(c, k, s, n, fixed), jn = vf_load(c->jn + k);
    rows3 va = rows_gather(s->velocity, c->a + k, 0);
    rows3 vb = fixed ? rows_zero() : rows_gather(s->velocity, c->b + k, 0);
    vf vn = rows_dot(rows_sub(vb, va), n);
    vm open = vf_gt(gap, vf_zero());
    vf soft = vf_max(vf_mul(gap, vf_set1(spring->bias_rate)), vf_set1(-spring->push_max));
    vf bias = vf_select(open, vf_mul(gap, vf_set1(spring->inv_h)), soft);
    vf scale = vf_select(open, vf_set1(1.0f), vf_set1(spring->mass_scale));
    vf give = vf_select(open, vf_zero(), vf_set1(spring->impulse_scale));
    vf pull = vf_add(vf_mul(vf_mul(vf_load(c->mn + k), scale), vf_add(vn, bias)), vf_mul(give, jn));
    vf total = vf_max(vf_sub(jn, pull), vf_zero());
    vf d = vf_sub(total, jn);
    vf_store(c->jn + k, total);
    note_approach(c, k, total, vn);
    rows_scatter(s->velocity, c->a + k, 0, rows_msub(va, n, vf_mul(d, vf_load(c->ima + k))));
    if (!fixed) {
        rows_scatter(s->velocity, c->b + k, 0, rows_mad(vb, n, vf_mul(d, vf_load(c->imb + k))));
    }
}

// Holds the turn of one against the other by at most the resistance's torque, as friction holds
// their slip.
ROWS_INLINE void resist_rolling(ball_block *c, int k, vf push, rows3 *wa, rows3 *wb, vf ia, vf ib) {
    rows3 was = rows_load(c->rx + k, c->ry + k, c->rz + k);
    rows3 r = rows_mad(was, rows_sub(*wa, *wb), rows_inverse(vf_add(ia, ib)));
    vf length = vf_sqrt(rows_dot(r, r)), limit = vf_mul(vf_load(c->roll + k), push);
    vm over = vf_gt(length, limit);
    vf one = vf_set1(1.0f);
    r = rows_mul(r, vf_select(over, vf_div(limit, vf_select(over, length, one)), one));
    rows_store(c->rx + k, c->ry + k, c->rz + k, r);
    rows3 d = rows_sub(r, was);
    *wa = rows_msub(*wa, d, ia);
    *wb = rows_mad(*wb, d, ib);
}

static void relax(ball_block *c, int k, soft_bodies *s, const soft_spring *spring, bool fixed) {
    rows3 n = rows_load(c->nx + k, c->ny + k, c->nz + k);
    vf gap = gap_now(c, k, s, n, fixed), jn = vf_load(c->jn + k);
    vf ima = vf_load(c->ima + k), imb = vf_load(c->imb + k);
    vf ra = vf_load(c->ra + k), ia = vf_load(c->ia + k), ka = vf_mul(ra, ia);
    vf rb = vf_load(c->rb + k), ib = vf_load(c->ib + k), kb = vf_mul(rb, ib);
    rows3 va = rows_gather(s->velocity, c->a + k, 0), wa = rows_gather(s->velocity, c->a + k, 4);
    rows3 vb = fixed ? rows_zero() : rows_gather(s->velocity, c->b + k, 0);
    rows3 wb = fixed ? rows_zero() : rows_gather(s->velocity, c->b + k, 4);
    rows3 dv = rows_sub(vb, va);
    vf vn = rows_dot(dv, n), bias = vf_mul(vf_max(gap, vf_zero()), vf_set1(spring->inv_h));
    vf total = vf_sub(jn, vf_mul(vf_load(c->mn + k), vf_add(vn, bias)));
    total = vf_max(total, vf_zero());
    vf d = vf_sub(total, jn);
    vf_store(c->jn + k, total);
    note_approach(c, k, total, vn);

    rows3 spin = rows_mul(wa, ra);
    spin = fixed ? spin : rows_mad(spin, wb, rb);
    rows3 slip = rows_msub(dv, n, vn), turn = rows_cross(n, spin);
    slip = (rows3){vf_add(slip.x, turn.x), vf_add(slip.y, turn.y), vf_add(slip.z, turn.z)};
    rows3 was = rows_load(c->jx + k, c->jy + k, c->jz + k);
    rows3 j = rows_msub(was, slip, vf_load(c->mt + k));
    vf length = vf_sqrt(rows_dot(j, j)), limit = vf_mul(vf_load(c->friction + k), total);
    vm over = vf_gt(length, limit);
    vf cut = vf_select(over, vf_div(limit, vf_select(over, length, vf_set1(1.0f))), vf_set1(1.0f));
    j = (rows3){vf_mul(j.x, cut), vf_mul(j.y, cut), vf_mul(j.z, cut)};
    vf_store(c->jx + k, j.x);
    vf_store(c->jy + k, j.y);
    vf_store(c->jz + k, j.z);
    rows3 dj = rows_sub(j, was), turned = rows_cross(n, dj), p = rows_mad(dj, n, d);
    wa = rows_msub(wa, turned, ka);
    wb = rows_msub(wb, turned, kb);
    resist_rolling(c, k, total, &wa, &wb, ia, ib);
    rows_scatter(s->velocity, c->a + k, 0, rows_msub(va, p, ima));
    rows_scatter(s->velocity, c->a + k, 4, wa);
    if (!fixed) {
        rows_scatter(s->velocity, c->b + k, 0, rows_mad(vb, p, imb));
        rows_scatter(s->velocity, c->b + k, 4, wb);
    }
}

static void restitute(ball_block *c, int k, soft_bodies *s, bool fixed) {
    rows3 n = rows_load(c->nx + k, c->ny + k, c->nz + k);
    rows3 va = rows_gather(s->velocity, c->a + k, 0);
    rows3 vb = fixed ? rows_zero() : rows_gather(s->velocity, c->b + k, 0);
    vf vn = rows_dot(rows_sub(vb, va), n), approach = vf_load(c->approach + k);
    vf e = vf_load(c->restitution + k), jn = vf_load(c->jn + k);
    vm bounce = vm_and(vf_lt(approach, vf_set1(-PHYS_BOUNCE_MIN)), vf_gt(e, vf_zero()));
    vf d = vf_mul(vf_load(c->mn + k), vf_add(vn, vf_mul(e, approach)));
    d = vf_keep(bounce, vf_sub(vf_max(vf_sub(jn, d), vf_zero()), jn));
    rows_scatter(s->velocity, c->a + k, 0, rows_msub(va, n, vf_mul(d, vf_load(c->ima + k))));
    if (!fixed) {
        rows_scatter(s->velocity, c->b + k, 0, rows_mad(vb, n, vf_mul(d, vf_load(c->imb + k))));
    }
}

void CORE_SIMD_NAME(phys_soft_balls)(ball_block *block, uint32_t count, soft_bodies *bodies,
                                     const soft_spring *spring, soft_pass pass, bool fixed) {
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < SOFT_LANES; k += CORE_SIMD_WIDTH) {
            switch (pass) {
            case SOFT_WARM:
                warm(&block[i], k, bodies, fixed);
                break;
            case SOFT_SOLVE:
                solve(&block[i], k, bodies, spring, fixed);
                break;
            case SOFT_RELAX:
                relax(&block[i], k, bodies, spring, fixed);
                break;
            case SOFT_RESTITUTE:
                restitute(&block[i], k, bodies, fixed);
                break;
            }
        }
    }
}

void CORE_SIMD_NAME(phys_soft_push)(soft_bodies *s, uint32_t begin, uint32_t end, float h) {
    (void)h;
    for (uint32_t i = begin; i < end; i += CORE_SIMD_WIDTH) {
        vf v = vf_load(s->velocity + i), given = vf_sub(v, vf_load(s->mark + i));
        v = s->keep ? vf_mul(v, vf_load(s->keep + i)) : v;
        v = vf_add(v, vf_load(s->push + i));
        vf_store(s->mark + i, v);
        vf_store(s->velocity + i, vf_add(v, given));
    }
}

void CORE_SIMD_NAME(phys_soft_move)(soft_bodies *s, uint32_t begin, uint32_t end, float h) {
    for (uint32_t i = begin; i < end; i += CORE_SIMD_WIDTH) {
        vf way = vf_mul(vf_load(s->velocity + i), vf_set1(h));
        vf_store(s->moved + i, vf_add(vf_load(s->moved + i), way));
    }
}
