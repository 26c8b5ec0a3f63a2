// Ball joints in loops, without limits: the commonest ones of nets. Arms, matrix and impulse are
// made in lanes from the bodies' poses, three rows at a time.
#include "phys/joint_solve.h"

#include "phys/rows.h"

typedef struct inertia {
    rows3 diagonal, off; // xx yy zz, xy xz yz
} inertia;

ROWS_INLINE rows3 turn_by(const inertia *i, rows3 v) {
    return (rows3){
        vf_add(vf_add(vf_mul(i->diagonal.x, v.x), vf_mul(i->off.x, v.y)), vf_mul(i->off.y, v.z)),
        vf_add(vf_add(vf_mul(i->off.x, v.x), vf_mul(i->diagonal.y, v.y)), vf_mul(i->off.z, v.z)),
        vf_add(vf_add(vf_mul(i->off.y, v.x), vf_mul(i->off.z, v.y)), vf_mul(i->diagonal.z, v.z))};
}

ROWS_INLINE inertia inertia_of(const soft_bodies *s, const int32_t *at) {
    return (inertia){rows_gather(s->inertia, at, 0), rows_gather(s->inertia, at, 4)};
}

// Anchor in the world; its arm goes to out.
ROWS_INLINE rows3 anchor(const joint_poses *p, const int32_t *at, float local[3][SOFT_LANES], int k,
                         float out[3][SOFT_LANES]) {
    rows3 v = rows_load(local[0] + k, local[1] + k, local[2] + k);
    rows3 u = rows_gather(p->pose, at, 4), w = rows_gather(p->real, at, 0);
    rows3 t = rows_cross(u, v);
    t = rows_add(t, t);
    rows3 arm = rows_add(rows_mad(v, t, w.x), rows_cross(u, t));
    rows_store(out[0] + k, out[1] + k, out[2] + k, arm);
    return rows_add(rows_gather(p->pose, at, 0), arm);
}

// Adds -[r] I [r], the answer of a body's turning at the arm.
ROWS_INLINE void add_turning(rows3 *diagonal, rows3 *off, const inertia *i, rows3 r) {
    vf o = vf_zero();
    rows3 x = rows_cross(turn_by(i, (rows3){o, r.z, vf_neg(r.y)}), r);
    rows3 y = rows_cross(turn_by(i, (rows3){vf_neg(r.z), o, r.x}), r);
    rows3 z = rows_cross(turn_by(i, (rows3){r.y, vf_neg(r.x), o}), r);
    *diagonal = rows_add(*diagonal, (rows3){x.x, y.y, z.z});
    *off = rows_add(*off, (rows3){x.y, x.z, y.z});
}

ROWS_INLINE void prepare(joint_points *c, int k, const soft_bodies *s, const joint_poses *poses) {
    rows3 pa = anchor(poses, c->a + k, c->la, k, c->ra),
          pb = anchor(poses, c->b + k, c->lb, k, c->rb);
    rows3 gap = rows_sub(pb, pa);
    rows_store(c->gap[0] + k, c->gap[1] + k, c->gap[2] + k, gap);
    vf mass = vf_add(vf_load(c->ima + k), vf_load(c->imb + k));
    rows3 d = {mass, mass, mass}, o = rows_zero();
    inertia ia = inertia_of(s, c->a + k), ib = inertia_of(s, c->b + k);
    add_turning(&d, &o, &ia, rows_load(c->ra[0] + k, c->ra[1] + k, c->ra[2] + k));
    add_turning(&d, &o, &ib, rows_load(c->rb[0] + k, c->rb[1] + k, c->rb[2] + k));
    // Inverse of the symmetric matrix by cofactors.
    vf xx = vf_sub(vf_mul(d.y, d.z), vf_mul(o.z, o.z));
    vf xy = vf_sub(vf_mul(o.y, o.z), vf_mul(o.x, d.z));
    vf xz = vf_sub(vf_mul(o.x, o.z), vf_mul(o.y, d.y));
    vf det = vf_add(vf_add(vf_mul(d.x, xx), vf_mul(o.x, xy)), vf_mul(o.y, xz));
    vf inv = rows_inverse(det);
    rows3 id = {xx, vf_sub(vf_mul(d.x, d.z), vf_mul(o.y, o.y)),
                vf_sub(vf_mul(d.x, d.y), vf_mul(o.x, o.x))};
    rows3 io = {xy, xz, vf_sub(vf_mul(o.x, o.y), vf_mul(d.x, o.z))};
    rows_store(c->diagonal[0] + k, c->diagonal[1] + k, c->diagonal[2] + k, rows_mul(id, inv));
    rows_store(c->off[0] + k, c->off[1] + k, c->off[2] + k, rows_mul(io, inv));
}

typedef struct motion { // of both bodies
    rows3 va, wa, vb, wb;
} motion;

ROWS_INLINE void put(float *to, const int32_t *at, const float *mass, rows3 v, rows3 w) {
    vm moves = vf_gt(vf_load(mass), vf_zero());
    rows_scatter(to, at, 0, (rows3){vf_keep(moves, v.x), vf_keep(moves, v.y), vf_keep(moves, v.z)});
    rows_scatter(to, at, 4, (rows3){vf_keep(moves, w.x), vf_keep(moves, w.y), vf_keep(moves, w.z)});
}

ROWS_INLINE void solve(joint_points *c, int k, const soft_bodies *s, soft_pass pass, float inv_h) {
    motion m = {rows_gather(s->velocity, c->a + k, 0), rows_gather(s->velocity, c->a + k, 4),
                rows_gather(s->velocity, c->b + k, 0), rows_gather(s->velocity, c->b + k, 4)};
    rows3 ra = rows_load(c->ra[0] + k, c->ra[1] + k, c->ra[2] + k);
    rows3 rb = rows_load(c->rb[0] + k, c->rb[1] + k, c->rb[2] + k);
    rows3 was = rows_load(c->impulse[0] + k, c->impulse[1] + k, c->impulse[2] + k), j = was;
    if (pass != SOFT_WARM) {
        rows3 v =
            rows_sub(rows_add(m.vb, rows_cross(m.wb, rb)), rows_add(m.va, rows_cross(m.wa, ra)));
        if (pass == SOFT_SOLVE) {
            v = rows_mad(v, rows_load(c->gap[0] + k, c->gap[1] + k, c->gap[2] + k),
                         vf_set1(JOINT_LOOP_RATE * inv_h));
        }
        bool gives = pass == SOFT_SOLVE;
        inertia inverse = {rows_load(c->diagonal[0] + k, c->diagonal[1] + k, c->diagonal[2] + k),
                           rows_load(c->off[0] + k, c->off[1] + k, c->off[2] + k)};
        j = rows_mul(turn_by(&inverse, v), vf_set1(gives ? -JOINT_LOOP_MASS : -1.0f));
        j = gives ? rows_mad(j, was, vf_set1(-JOINT_LOOP_GIVE)) : j;
        rows_store(c->impulse[0] + k, c->impulse[1] + k, c->impulse[2] + k, rows_add(was, j));
    }
    inertia ia = inertia_of(s, c->a + k), ib = inertia_of(s, c->b + k);
    m.va = rows_msub(m.va, j, vf_load(c->ima + k));
    m.wa = rows_sub(m.wa, turn_by(&ia, rows_cross(ra, j)));
    m.vb = rows_mad(m.vb, j, vf_load(c->imb + k));
    m.wb = rows_add(m.wb, turn_by(&ib, rows_cross(rb, j)));
    put(s->velocity, c->to_a + k, c->ima + k, m.va, m.wa);
    put(s->velocity, c->to_b + k, c->imb + k, m.vb, m.wb);
}

void CORE_SIMD_NAME(phys_joint_points)(joint_points *block, uint32_t count, soft_bodies *bodies,
                                       const joint_poses *poses, soft_pass pass, float inv_h) {
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < SOFT_LANES; k += CORE_SIMD_WIDTH) {
            if (poses != NULL) {
                prepare(&block[i], k, bodies, poses);
            } else {
                solve(&block[i], k, bodies, pass, inv_h);
            }
        }
    }
}
