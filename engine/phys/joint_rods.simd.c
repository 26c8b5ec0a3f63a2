// Rods in loops (distance joints that neither give nor move): cloth and nets. One row each; bodies
// held at their centres do not turn.
#include "phys/joint_wide.h"

ROWS_INLINE vf turning(const soft_bodies *s, const int32_t *at, rows3 arm, rows3 n) {
    wide_inertia in = wide_inertia_of(s, at);
    rows3 t = rows_cross(arm, n);
    return rows_dot(t, wide_turn(&in, t));
}

ROWS_INLINE void prepare(joint_rods *c, int k, const soft_bodies *s, const joint_poses *poses) {
    const joint_head *e = &c->head;
    rows3 pa, pb;
    if (c->arms) {
        pa = wide_anchor(poses, e->pose_a + k, wide_get(c->la, k), k, c->ra);
        pb = wide_anchor(poses, e->pose_b + k, wide_get(c->lb, k), k, c->rb);
    } else {
        pa = rows_gather(poses->pose, e->pose_a + k, 0);
        pb = rows_gather(poses->pose, e->pose_b + k, 0);
    }
    rows3 d = rows_sub(pb, pa);
    vf length = vf_sqrt(rows_dot(d, d)), inv = rows_inverse(length), one = vf_set1(1.0f);
    rows3 n = rows_mul(d, inv);
    n.y = vf_select(vf_gt(length, vf_zero()), n.y, one); // any direction parts what is in one place
    vf mass = vf_add(vf_load(e->ima + k), vf_load(e->imb + k));
    if (c->arms) {
        mass = vf_add(mass, turning(s, e->a + k, wide_get(c->ra, k), n));
        mass = vf_add(mass, turning(s, e->b + k, wide_get(c->rb, k), n));
    }
    wide_set(c->n, k, n);
    vf_store(c->gap + k, vf_sub(length, vf_load(c->rest + k)));
    vf_store(c->bend + k, vf_mul(vf_set1(0.5f), inv));
    vf_store(c->mass + k, rows_inverse(mass));
}

// Speed at which the rod lengthens; when it corrects, with the error so far and the one that
// turning will leave, h v^2 / (2 length) for the part v across.
ROWS_INLINE vf miss(joint_rods *c, int k, const wide_motion *m, rows3 n, float h, bool correct) {
    rows3 v = rows_sub(m->vb, m->va);
    if (c->arms) {
        v = rows_add(v, rows_sub(rows_cross(m->wb, wide_get(c->rb, k)),
                                 rows_cross(m->wa, wide_get(c->ra, k))));
    }
    vf along = rows_dot(v, n);
    if (!correct) {
        return along;
    }
    vf across = vf_sub(rows_dot(v, v), vf_mul(along, along));
    vf bend = vf_mul(vf_mul(across, vf_load(c->bend + k)), vf_set1(h));
    return vf_add(along, vf_mad(vf_load(c->gap + k), vf_set1(JOINT_LOOP_RATE / h), bend));
}

ROWS_INLINE void turn(soft_bodies *s, const int32_t *from, const int32_t *to, vf mass, rows3 w,
                      rows3 torque) {
    wide_inertia in = wide_inertia_of(s, from);
    wide_put(s->velocity, to, mass, 4, rows_add(w, wide_turn(&in, torque)));
}

ROWS_INLINE void solve(joint_rods *c, int k, soft_bodies *s, soft_pass pass, float h) {
    const joint_head *e = &c->head;
    wide_motion m = {.va = rows_gather(s->velocity, e->a + k, 0),
                     .vb = rows_gather(s->velocity, e->b + k, 0)};
    if (c->arms) {
        m.wa = rows_gather(s->velocity, e->a + k, 4);
        m.wb = rows_gather(s->velocity, e->b + k, 4);
    }
    rows3 n = wide_get(c->n, k);
    vf was = vf_load(c->impulse + k), j = was;
    if (pass != SOFT_WARM) {
        bool correct = pass == SOFT_SOLVE;
        j = vf_mul(vf_load(c->mass + k), miss(c, k, &m, n, h, correct));
        j = vf_mul(j, vf_set1(correct ? -JOINT_LOOP_MASS : -1.0f));
        j = correct ? vf_mad(was, vf_set1(-JOINT_LOOP_GIVE), j) : j;
        was = vf_add(was, j);
        vf_store(c->impulse + k, was);
    }
    if (pass == SOFT_RELAX) {
        wide_set(c->load, k, rows_mad(wide_get(c->load, k), n, was));
    }
    rows3 p = rows_mul(n, j);
    vf ima = vf_load(e->ima + k), imb = vf_load(e->imb + k);
    wide_put(s->velocity, e->to_a + k, ima, 0, rows_msub(m.va, p, ima));
    wide_put(s->velocity, e->to_b + k, imb, 0, rows_mad(m.vb, p, imb));
    if (c->arms) {
        turn(s, e->a + k, e->to_a + k, ima, m.wa, rows_cross(p, wide_get(c->ra, k)));
        turn(s, e->b + k, e->to_b + k, imb, m.wb, rows_cross(wide_get(c->rb, k), p));
    }
}

void CORE_SIMD_NAME(phys_joint_rods)(joint_rods *block, uint32_t count, soft_bodies *bodies,
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
