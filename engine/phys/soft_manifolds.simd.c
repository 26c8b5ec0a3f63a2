// Manifolds of up to four points, wide. Normal impulses point by point; friction in two directions
// and torsion once, at the centre of the points.
#include "phys/soft.h"

#include "phys/rows.h"

typedef struct motion { // of both bodies
    rows3 va, wa, vb, wb;
} motion;

ROWS_INLINE rows3 normal_of(const manifold_block *c, int k) {
    return rows_load(c->nx + k, c->ny + k, c->nz + k);
}
ROWS_INLINE rows3 arm_a(const soft_arm *r, int k) {
    return rows_load(r->ax + k, r->ay + k, r->az + k);
}
ROWS_INLINE rows3 arm_b(const soft_arm *r, int k) {
    return rows_load(r->bx + k, r->by + k, r->bz + k);
}

ROWS_INLINE motion gather(const manifold_block *c, int k, const float *from) {
    return (motion){rows_gather(from, c->a + k, 0), rows_gather(from, c->a + k, 4),
                    rows_gather(from, c->b + k, 0), rows_gather(from, c->b + k, 4)};
}
ROWS_INLINE void scatter(const manifold_block *c, int k, float *to, const motion *m, bool fixed) {
    rows_scatter(to, c->a + k, 0, m->va);
    rows_scatter(to, c->a + k, 4, m->wa);
    if (!fixed) {
        rows_scatter(to, c->b + k, 0, m->vb);
        rows_scatter(to, c->b + k, 4, m->wb);
    }
}

// Relative speed along an arm's direction, whose linear part is given.
ROWS_INLINE vf speed(const soft_arm *r, int k, const motion *m, vf linear) {
    vf turn = vf_sub(rows_dot(arm_b(r, k), m->wb), rows_dot(arm_a(r, k), m->wa));
    return vf_add(linear, turn);
}
ROWS_INLINE void spin(const soft_arm *r, int k, motion *m, vf d) {
    m->wa = rows_msub(m->wa, rows_load(r->iax + k, r->iay + k, r->iaz + k), d);
    m->wb = rows_mad(m->wb, rows_load(r->ibx + k, r->iby + k, r->ibz + k), d);
}
ROWS_INLINE void thrust(const manifold_block *c, int k, motion *m, rows3 axis, vf d) {
    m->va = rows_msub(m->va, axis, vf_mul(d, vf_load(c->ima + k)));
    m->vb = rows_mad(m->vb, axis, vf_mul(d, vf_load(c->imb + k)));
}

typedef struct inertia {
    rows3 diagonal, off; // xx yy zz, xy xz yz
} inertia;
ROWS_INLINE rows3 turn_by(const inertia *i, rows3 v) {
    return (rows3){
        vf_add(vf_add(vf_mul(i->diagonal.x, v.x), vf_mul(i->off.x, v.y)), vf_mul(i->off.y, v.z)),
        vf_add(vf_add(vf_mul(i->off.x, v.x), vf_mul(i->diagonal.y, v.y)), vf_mul(i->off.z, v.z)),
        vf_add(vf_add(vf_mul(i->off.y, v.x), vf_mul(i->off.z, v.y)), vf_mul(i->diagonal.z, v.z))};
}

// Fills an arm for the direction at anchors ra, rb. Returns its 1 / mass.
ROWS_INLINE vf make_arm(soft_arm *r, int k, rows3 axis, rows3 ra, rows3 rb, const inertia *ia,
                        const inertia *ib, vf mass) {
    rows3 a = rows_cross(ra, axis), b = rows_cross(rb, axis), ta = turn_by(ia, a),
          tb = turn_by(ib, b);
    rows_store(r->ax + k, r->ay + k, r->az + k, a);
    rows_store(r->bx + k, r->by + k, r->bz + k, b);
    rows_store(r->iax + k, r->iay + k, r->iaz + k, ta);
    rows_store(r->ibx + k, r->iby + k, r->ibz + k, tb);
    return vf_add(mass, vf_add(rows_dot(a, ta), rows_dot(b, tb)));
}

// Tangents of a unit normal (Duff et al., JCGT 2017), as phys_basis.
static void tangents(rows3 n, rows3 *t1, rows3 *t2) {
    vf one = vf_set1(1.0f);
    vf s = vf_select(vf_ge(n.z, vf_zero()), one, vf_set1(-1.0f));
    vf a = vf_div(vf_set1(-1.0f), vf_add(s, n.z)), b = vf_mul(vf_mul(n.x, n.y), a);
    *t1 = (rows3){vf_add(one, vf_mul(s, vf_mul(vf_mul(n.x, n.x), a))), vf_mul(s, b),
                  vf_neg(vf_mul(s, n.x))};
    *t2 = (rows3){b, vf_add(s, vf_mul(vf_mul(n.y, n.y), a)), vf_neg(n.y)};
}

static void prepare_points(manifold_block *c, int k, const inertia *ia, const inertia *ib,
                           rows3 center_a, vf mass) {
    rows3 n = normal_of(c, k);
    vf points = vf_load(c->count + k);
    for (int i = 0; i < 4; i++) {
        soft_arm *r = &c->point[i];
        rows3 ra = arm_a(r, k), rb = arm_b(r, k), off = rows_sub(ra, center_a);
        vf_store(c->lever[i] + k, vf_sqrt(rows_dot(off, off)));
        vf inv = rows_inverse(make_arm(r, k, n, ra, rb, ia, ib, mass));
        vf_store(r->mass + k, vf_keep(vf_gt(points, vf_set1((float)i)), inv));
        vf_store(c->approach[i] + k, vf_zero());
    }
}

static void prepare(manifold_block *c, int k, const soft_bodies *s) {
    rows3 n = normal_of(c, k), t1, t2;
    inertia ia = {rows_gather(s->inertia, c->a + k, 0), rows_gather(s->inertia, c->a + k, 4)};
    inertia ib = {rows_gather(s->inertia, c->b + k, 0), rows_gather(s->inertia, c->b + k, 4)};
    vf mass = vf_add(vf_load(c->ima + k), vf_load(c->imb + k));
    vf share = rows_inverse(vf_load(c->count + k));
    rows3 ca = arm_a(&c->point[0], k), cb = arm_b(&c->point[0], k);
    for (int i = 1; i < 4; i++) { // absent points hold zeros
        ca = rows_add(ca, arm_a(&c->point[i], k));
        cb = rows_add(cb, arm_b(&c->point[i], k));
    }
    ca = rows_mul(ca, share);
    cb = rows_mul(cb, share);
    prepare_points(c, k, &ia, &ib, ca, mass);
    tangents(n, &t1, &t2);
    rows_store(c->tx[0] + k, c->ty[0] + k, c->tz[0] + k, t1);
    rows_store(c->tx[1] + k, c->ty[1] + k, c->tz[1] + k, t2);
    vf k11 = make_arm(&c->tangent[0], k, t1, ca, cb, &ia, &ib, mass);
    vf k22 = make_arm(&c->tangent[1], k, t2, ca, cb, &ia, &ib, mass);
    soft_arm *t = &c->tangent[1];
    rows3 ta = rows_load(t->iax + k, t->iay + k, t->iaz + k);
    rows3 tb = rows_load(t->ibx + k, t->iby + k, t->ibz + k);
    vf k12 = vf_add(rows_dot(arm_a(&c->tangent[0], k), ta), rows_dot(arm_b(&c->tangent[0], k), tb));
    vf det = rows_inverse(vf_sub(vf_mul(k11, k22), vf_mul(k12, k12)));
    vf_store(c->tangent[0].mass + k, vf_mul(k22, det));
    vf_store(c->tangent[1].mass + k, vf_mul(k11, det));
    vf_store(c->cross + k, vf_neg(vf_mul(k12, det)));
    rows3 wa = turn_by(&ia, n), wb = turn_by(&ib, n);
    rows_store(c->wax + k, c->way + k, c->waz + k, wa);
    rows_store(c->wbx + k, c->wby + k, c->wbz + k, wb);
    vf_store(c->twist_mass + k, rows_inverse(vf_add(rows_dot(wa, n), rows_dot(wb, n))));
}

ROWS_INLINE void twist_by(const manifold_block *c, int k, motion *m, vf d) {
    m->wa = rows_msub(m->wa, rows_load(c->wax + k, c->way + k, c->waz + k), d);
    m->wb = rows_mad(m->wb, rows_load(c->wbx + k, c->wby + k, c->wbz + k), d);
}

static void warm(manifold_block *c, int k, soft_bodies *s, bool fixed) {
    prepare(c, k, s);
    rows3 n = normal_of(c, k);
    motion m = gather(c, k, s->velocity);
    vf sum = vf_zero();
    for (int i = 0; i < 4; i++) {
        vf j = vf_load(c->point[i].impulse + k);
        sum = vf_add(sum, j);
        spin(&c->point[i], k, &m, j);
    }
    thrust(c, k, &m, n, sum);
    for (int i = 0; i < 2; i++) {
        vf j = vf_load(c->tangent[i].impulse + k);
        spin(&c->tangent[i], k, &m, j);
        thrust(c, k, &m, rows_load(c->tx[i] + k, c->ty[i] + k, c->tz[i] + k), j);
    }
    twist_by(c, k, &m, vf_load(c->twist + k));
    scatter(c, k, s->velocity, &m, fixed);
}

// One sweep over the four points. Returns the sum of the impulses.
ROWS_INLINE vf sweep(manifold_block *c, int k, const soft_bodies *s, const soft_spring *spring,
                     motion *m, bool correct) {
    rows3 n = normal_of(c, k);
    motion way = gather(c, k, s->moved);
    vf linear = rows_dot(rows_sub(m->vb, m->va), n), gained = vf_zero(), sum = vf_zero();
    vf drift = rows_dot(rows_sub(way.vb, way.va), n);
    vf mass = vf_add(vf_load(c->ima + k), vf_load(c->imb + k));
    for (int i = 0; i < 4; i++) {
        soft_arm *r = &c->point[i];
        vf gap = speed(r, k, &way, vf_add(vf_load(c->gap[i] + k), drift));
        vf j = vf_load(r->impulse + k), vn = speed(r, k, m, linear);
        vm open = vf_gt(gap, vf_zero());
        vf scale = vf_set1(1.0f), give = vf_zero();
        vf bias = vf_mul(vf_max(gap, vf_zero()), vf_set1(spring->inv_h));
        if (correct) {
            vf soft = vf_max(vf_mul(gap, vf_set1(spring->bias_rate)), vf_set1(-spring->push_max));
            bias = vf_select(open, bias, soft);
            scale = vf_select(open, scale, vf_set1(spring->mass_scale));
            give = vf_select(open, give, vf_set1(spring->impulse_scale));
        }
        vf pull = vf_mul(vf_mul(vf_load(r->mass + k), scale), vf_add(vn, bias));
        vf total = vf_max(vf_sub(j, vf_add(pull, vf_mul(give, j))), vf_zero());
        vf d = vf_sub(total, j);
        vf_store(r->impulse + k, total);
        vf fast = vf_load(c->approach[i] + k);
        vf_store(c->approach[i] + k, vf_select(vf_gt(total, vf_zero()), vf_min(fast, vn), fast));
        spin(r, k, m, d);
        linear = vf_add(linear, vf_mul(d, mass));
        gained = vf_add(gained, d);
        sum = vf_add(sum, total);
    }
    thrust(c, k, m, n, gained);
    return sum;
}

ROWS_INLINE void rub(manifold_block *c, int k, motion *m, vf normal_sum) {
    rows3 dv = rows_sub(m->vb, m->va), n = normal_of(c, k);
    rows3 t1 = rows_load(c->tx[0] + k, c->ty[0] + k, c->tz[0] + k);
    rows3 t2 = rows_load(c->tx[1] + k, c->ty[1] + k, c->tz[1] + k);
    soft_arm *r1 = &c->tangent[0], *r2 = &c->tangent[1];
    vf u1 = speed(r1, k, m, rows_dot(dv, t1)), u2 = speed(r2, k, m, rows_dot(dv, t2));
    vf cross = vf_load(c->cross + k), was1 = vf_load(r1->impulse + k);
    vf was2 = vf_load(r2->impulse + k);
    vf j1 = vf_sub(was1, vf_add(vf_mul(vf_load(r1->mass + k), u1), vf_mul(cross, u2)));
    vf j2 = vf_sub(was2, vf_add(vf_mul(cross, u1), vf_mul(vf_load(r2->mass + k), u2)));
    vf friction = vf_load(c->friction + k), limit = vf_mul(friction, normal_sum);
    vf length = vf_sqrt(vf_add(vf_mul(j1, j1), vf_mul(j2, j2)));
    vm over = vf_gt(length, limit);
    vf one = vf_set1(1.0f);
    vf cut = vf_select(over, vf_div(limit, vf_select(over, length, one)), one);
    j1 = vf_mul(j1, cut);
    j2 = vf_mul(j2, cut);
    vf_store(r1->impulse + k, j1);
    vf_store(r2->impulse + k, j2);
    spin(r1, k, m, vf_sub(j1, was1));
    spin(r2, k, m, vf_sub(j2, was2));
    thrust(c, k, m, t1, vf_sub(j1, was1));
    thrust(c, k, m, t2, vf_sub(j2, was2));
    // Torsion: each point resists turning with its lever from the centre.
    vf hold = vf_zero();
    for (int i = 0; i < 4; i++) {
        hold = vf_add(hold, vf_mul(vf_load(c->point[i].impulse + k), vf_load(c->lever[i] + k)));
    }
    hold = vf_mul(hold, friction);
    vf was = vf_load(c->twist + k), turn = rows_dot(rows_sub(m->wb, m->wa), n);
    vf j = vf_sub(was, vf_mul(vf_load(c->twist_mass + k), turn));
    j = vf_max(vf_min(j, hold), vf_neg(hold));
    vf_store(c->twist + k, j);
    twist_by(c, k, m, vf_sub(j, was));
}

static void restitute(manifold_block *c, int k, soft_bodies *s, bool fixed) {
    rows3 n = normal_of(c, k);
    motion m = gather(c, k, s->velocity);
    vf e = vf_load(c->restitution + k);
    for (int i = 0; i < 4; i++) {
        soft_arm *r = &c->point[i];
        vf approach = vf_load(c->approach[i] + k), j = vf_load(r->impulse + k);
        vf vn = speed(r, k, &m, rows_dot(rows_sub(m.vb, m.va), n));
        vm bounce = vm_and(vf_lt(approach, vf_set1(-PHYS_BOUNCE_MIN)), vf_gt(e, vf_zero()));
        vf d = vf_mul(vf_load(r->mass + k), vf_add(vn, vf_mul(e, approach)));
        d = vf_keep(bounce, vf_sub(vf_max(vf_sub(j, d), vf_zero()), j));
        spin(r, k, &m, d);
        thrust(c, k, &m, n, d);
    }
    scatter(c, k, s->velocity, &m, fixed);
}

void CORE_SIMD_NAME(phys_soft_manifolds)(manifold_block *block, uint32_t count, soft_bodies *bodies,
                                         const soft_spring *spring, soft_pass pass, bool fixed) {
    for (uint32_t i = 0; i < count; i++) {
        manifold_block *c = &block[i];
        for (int k = 0; k < SOFT_LANES; k += CORE_SIMD_WIDTH) {
            if (pass == SOFT_WARM) {
                warm(c, k, bodies, fixed);
            } else if (pass == SOFT_RESTITUTE) {
                restitute(c, k, bodies, fixed);
            } else {
                motion m = gather(c, k, bodies->velocity);
                vf sum = sweep(c, k, bodies, spring, &m, pass == SOFT_SOLVE);
                if (pass == SOFT_RELAX) {
                    rub(c, k, &m, sum);
                }
                scatter(c, k, bodies->velocity, &m, fixed);
            }
        }
    }
}
