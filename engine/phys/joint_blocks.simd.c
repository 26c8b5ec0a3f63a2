// Rows of joints, wide: soft rows one by one between their bounds, then the hard ones as a block.
#include "phys/joint_wide.h"

ROWS_INLINE rows3 part(const joint_lanes *r, int i, int k) {
    return rows_load(r->j[i] + k, r->j[i + 1] + k, r->j[i + 2] + k);
}

ROWS_INLINE vf speed(const joint_lanes *r, int k, const wide_motion *m) {
    vf a = vf_add(rows_dot(part(r, 0, k), m->va), rows_dot(part(r, 3, k), m->wa));
    vf b = vf_add(rows_dot(part(r, 6, k), m->vb), rows_dot(part(r, 9, k), m->wb));
    return vf_add(a, b);
}

ROWS_INLINE void give(const joint_block *c, const joint_lanes *r, int k, wide_motion *m, vf d) {
    m->va = rows_mad(m->va, part(r, 0, k), vf_mul(d, vf_load(c->head.ima + k)));
    m->wa = rows_mad(m->wa, rows_load(r->ia[0] + k, r->ia[1] + k, r->ia[2] + k), d);
    m->vb = rows_mad(m->vb, part(r, 6, k), vf_mul(d, vf_load(c->head.imb + k)));
    m->wb = rows_mad(m->wb, rows_load(r->ib[0] + k, r->ib[1] + k, r->ib[2] + k), d);
}

// Impulses of the last substep.
ROWS_INLINE void warm(const joint_block *c, int k, wide_motion *m) {
    for (uint32_t i = 0; i < c->soft_count; i++) {
        give(c, &c->soft[i], k, m, vf_load(c->soft[i].impulse + k));
    }
    for (uint32_t i = 0; i < c->hard_count; i++) {
        give(c, &c->hard[i], k, m, vf_load(c->hard[i].impulse + k));
    }
}

ROWS_INLINE void solve_soft(joint_block *c, int k, wide_motion *m, bool correct) {
    for (uint32_t i = 0; i < c->soft_count; i++) {
        joint_lanes *r = &c->soft[i];
        vf was = vf_load(r->impulse + k), bias = vf_load((correct ? r->bias : r->relax) + k);
        vf miss = vf_add(vf_add(speed(r, k, m), bias), vf_mul(vf_load(r->gamma + k), was));
        vf now = vf_sub(was, vf_mul(vf_load(r->mass + k), miss));
        now = vf_max(vf_min(now, vf_load(r->hi + k)), vf_load(r->lo + k));
        vf_store(r->impulse + k, now);
        give(c, r, k, m, vf_sub(now, was));
    }
}

ROWS_INLINE void solve_hard(joint_block *c, int k, wide_motion *m, bool correct) {
    vf miss[PHYS_JOINT_HARD];
    for (uint32_t i = 0; i < c->hard_count; i++) {
        const joint_lanes *r = &c->hard[i];
        miss[i] = vf_add(speed(r, k, m), vf_load((correct ? r->bias : r->relax) + k));
    }
    for (uint32_t i = 0; i < c->hard_count; i++) {
        joint_lanes *r = &c->hard[i];
        vf sum = vf_mul(vf_load(c->inverse[i][0] + k), miss[0]);
        for (uint32_t n = 1; n < c->hard_count; n++) {
            sum = vf_mad(vf_load(c->inverse[i][n] + k), miss[n], sum);
        }
        vf was = vf_load(r->impulse + k), d = vf_neg(sum);
        if (correct) {
            d = vf_mul(d, vf_set1(JOINT_LOOP_MASS));
            d = vf_sub(d, vf_mul(was, vf_set1(JOINT_LOOP_GIVE)));
        }
        vf_store(r->impulse + k, vf_add(was, d));
        give(c, r, k, m, d);
    }
}

void CORE_SIMD_NAME(phys_joint_blocks)(joint_block *block, uint32_t count, soft_bodies *bodies,
                                       soft_pass pass) {
    for (uint32_t i = 0; i < count; i++) {
        joint_block *c = &block[i];
        for (int k = 0; k < SOFT_LANES; k += CORE_SIMD_WIDTH) {
            wide_motion m = {rows_gather(bodies->velocity, c->head.a + k, 0),
                             rows_gather(bodies->velocity, c->head.a + k, 4),
                             rows_gather(bodies->velocity, c->head.b + k, 0),
                             rows_gather(bodies->velocity, c->head.b + k, 4)};
            if (pass == SOFT_WARM) {
                warm(c, k, &m);
            } else {
                solve_soft(c, k, &m, pass == SOFT_SOLVE);
                solve_hard(c, k, &m, pass == SOFT_SOLVE);
            }
            vf ima = vf_load(c->head.ima + k), imb = vf_load(c->head.imb + k);
            wide_put(bodies->velocity, c->head.to_a + k, ima, 0, m.va);
            wide_put(bodies->velocity, c->head.to_a + k, ima, 4, m.wa);
            wide_put(bodies->velocity, c->head.to_b + k, imb, 0, m.vb);
            wide_put(bodies->velocity, c->head.to_b + k, imb, 4, m.wb);
        }
    }
}
