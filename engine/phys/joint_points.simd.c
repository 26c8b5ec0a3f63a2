// Ball joints in loops, without limits: the commonest ones of nets. Arms, matrix and impulse are
// made in lanes from the bodies' poses, three rows at a time.
#include "phys/joint_wide.h"

// Adds -[r] I [r], the answer of a body's turning at the arm.
ROWS_INLINE void add_turning(rows3 *diagonal, rows3 *off, const wide_inertia *i, rows3 r) {
    vf o = vf_zero();
    rows3 x = rows_cross(wide_turn(i, (rows3){o, r.z, vf_neg(r.y)}), r);
    rows3 y = rows_cross(wide_turn(i, (rows3){vf_neg(r.z), o, r.x}), r);
    rows3 z = rows_cross(wide_turn(i, (rows3){r.y, vf_neg(r.x), o}), r);
    *diagonal = rows_add(*diagonal, (rows3){x.x, y.y, z.z});
    *off = rows_add(*off, (rows3){x.y, x.z, y.z});
}

// The same for a body with equal moments: ia (r r I - r r^T).
ROWS_INLINE void add_round(rows3 *diagonal, rows3 *off, vf ia, rows3 r) {
    rows3 p = rows_mul(r, ia);
    vf x = vf_mul(p.x, r.x), y = vf_mul(p.y, r.y), z = vf_mul(p.z, r.z);
    *diagonal = rows_add(*diagonal, (rows3){vf_add(y, z), vf_add(x, z), vf_add(x, y)});
    *off = rows_sub(*off, (rows3){vf_mul(p.x, r.y), vf_mul(p.x, r.z), vf_mul(p.y, r.z)});
}

ROWS_INLINE void prepare(joint_points *c, int k, const soft_bodies *s, const joint_poses *poses) {
    rows3 pa = wide_anchor(poses, c->head.pose_a + k, wide_get(c->la, k), k, c->ra);
    rows3 pb = wide_anchor(poses, c->head.pose_b + k, wide_get(c->lb, k), k, c->rb);
    wide_set(c->gap, k, rows_sub(pb, pa));
    vf mass = vf_add(vf_load(c->head.ima + k), vf_load(c->head.imb + k));
    rows3 d = {mass, mass, mass}, o = rows_zero();
    if (c->round) {
        add_round(&d, &o, vf_load(c->ia + k), wide_get(c->ra, k));
        add_round(&d, &o, vf_load(c->ib + k), wide_get(c->rb, k));
    } else {
        wide_inertia ia = wide_inertia_of(s, c->head.a + k);
        wide_inertia ib = wide_inertia_of(s, c->head.b + k);
        add_turning(&d, &o, &ia, wide_get(c->ra, k));
        add_turning(&d, &o, &ib, wide_get(c->rb, k));
    }
    // Inverse of the symmetric matrix by cofactors.
    vf xx = vf_sub(vf_mul(d.y, d.z), vf_mul(o.z, o.z));
    vf xy = vf_sub(vf_mul(o.y, o.z), vf_mul(o.x, d.z));
    vf xz = vf_sub(vf_mul(o.x, o.z), vf_mul(o.y, d.y));
    vf det = vf_add(vf_add(vf_mul(d.x, xx), vf_mul(o.x, xy)), vf_mul(o.y, xz));
    vf inv = rows_inverse(det);
    rows3 id = {xx, vf_sub(vf_mul(d.x, d.z), vf_mul(o.y, o.y)),
                vf_sub(vf_mul(d.x, d.y), vf_mul(o.x, o.x))};
    rows3 io = {xy, xz, vf_sub(vf_mul(o.x, o.y), vf_mul(d.x, o.z))};
    wide_set(c->diagonal, k, rows_mul(id, inv));
    wide_set(c->off, k, rows_mul(io, inv));
}

// Speed of b's anchor against a's; when it corrects, with the gap so far and the one that turning
// will leave, h/2 w x (w x r).
ROWS_INLINE rows3 miss(joint_points *c, int k, const wide_motion *m, rows3 ra, rows3 rb, float h,
                       bool correct) {
    rows3 ta = rows_cross(m->wa, ra), tb = rows_cross(m->wb, rb);
    rows3 v = rows_sub(rows_add(m->vb, tb), rows_add(m->va, ta));
    if (correct) {
        rows3 bend = rows_sub(rows_cross(m->wb, tb), rows_cross(m->wa, ta));
        v = rows_mad(v, bend, vf_set1(0.5f * h));
        v = rows_mad(v, wide_get(c->gap, k), vf_set1(JOINT_LOOP_RATE / h));
    }
    return v;
}

ROWS_INLINE void solve(joint_points *c, int k, const soft_bodies *s, soft_pass pass, float h) {
    const joint_head *e = &c->head;
    wide_motion m = {rows_gather(s->velocity, e->a + k, 0), rows_gather(s->velocity, e->a + k, 4),
                     rows_gather(s->velocity, e->b + k, 0), rows_gather(s->velocity, e->b + k, 4)};
    rows3 ra = wide_get(c->ra, k), rb = wide_get(c->rb, k), was = wide_get(c->impulse, k), j = was;
    if (pass != SOFT_WARM) {
        bool correct = pass == SOFT_SOLVE;
        rows3 v = miss(c, k, &m, ra, rb, h, correct);
        wide_inertia inverse = {wide_get(c->diagonal, k), wide_get(c->off, k)};
        j = rows_mul(wide_turn(&inverse, v), vf_set1(correct ? -JOINT_LOOP_MASS : -1.0f));
        j = correct ? rows_mad(j, was, vf_set1(-JOINT_LOOP_GIVE)) : j;
        was = rows_add(was, j);
        wide_set(c->impulse, k, was);
    }
    if (pass == SOFT_RELAX) {
        wide_set(c->load, k, rows_add(wide_get(c->load, k), was));
    }
    rows3 ta = rows_cross(j, ra), tb = rows_cross(rb, j);
    if (c->round) {
        ta = rows_mul(ta, vf_load(c->ia + k));
        tb = rows_mul(tb, vf_load(c->ib + k));
    } else {
        wide_inertia ia = wide_inertia_of(s, e->a + k), ib = wide_inertia_of(s, e->b + k);
        ta = wide_turn(&ia, ta);
        tb = wide_turn(&ib, tb);
    }
    vf ima = vf_load(e->ima + k), imb = vf_load(e->imb + k);
    wide_put(s->velocity, e->to_a + k, ima, 0, rows_msub(m.va, j, ima));
    wide_put(s->velocity, e->to_a + k, ima, 4, rows_add(m.wa, ta));
    wide_put(s->velocity, e->to_b + k, imb, 0, rows_mad(m.vb, j, imb));
    wide_put(s->velocity, e->to_b + k, imb, 4, rows_add(m.wb, tb));
}

void CORE_SIMD_NAME(phys_joint_points)(joint_points *block, uint32_t count, soft_bodies *bodies,
                                       const joint_poses *poses, soft_pass pass, float h) {
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < SOFT_LANES; k += CORE_SIMD_WIDTH) {
            if (poses != NULL) {
                prepare(&block[i], k, bodies, poses);
            }
            solve(&block[i], k, bodies, pass, h);
        }
    }
}
