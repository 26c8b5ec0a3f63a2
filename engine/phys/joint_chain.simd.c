// Chains of ball joints: everything by slot in wide lanes but the elimination, which runs from both
// ends to the middle in double precision.
#include "phys/joint_wide.h"

// Part of a joint's own answer added to it: joints that say the same twice stay solvable.
#define REGULAR 1e-7

typedef struct span { // columns of one chain
    float *data;
    size_t stride;
    const int32_t *place, *to;
    joint_factor *factor;
    int nodes;
} span;

ROWS_INLINE rows3 get(const span *s, int column, int i) {
    const float *p = s->data + (size_t)column * s->stride + i;
    return (rows3){vf_loadu(p), vf_loadu(p + s->stride), vf_loadu(p + 2 * s->stride)};
}
ROWS_INLINE vf get1(const span *s, int column, int i) {
    return vf_loadu(s->data + (size_t)column * s->stride + i);
}
ROWS_INLINE void set(const span *s, int column, int i, rows3 v) {
    float *p = s->data + (size_t)column * s->stride + i;
    rows_store(p, p + s->stride, p + 2 * s->stride, v);
}

ROWS_INLINE wide_inertia inertia_of(const span *s, int i) {
    return (wide_inertia){get(s, CHAIN_I, i), get(s, CHAIN_I + 3, i)};
}
ROWS_INLINE rows3 rotate(const span *s, int i, rows3 v) {
    rows3 u = get(s, CHAIN_Q, i);
    rows3 t = rows_cross(u, v);
    t = rows_add(t, t);
    return rows_add(rows_mad(v, t, get1(s, CHAIN_Q + 3, i)), rows_cross(u, t));
}

// Turns nodes by rotation vectors: q = (t tan(a/2) / a, 1) q, of unit length by construction.
ROWS_INLINE void turn(const span *s, int i, rows3 t) {
    vf a = rows_dot(t, t), one = vf_set1(1.0f);
    vf f = vf_mad(a, vf_mad(a, vf_set1(1.0f / 240.0f), vf_set1(1.0f / 24.0f)), vf_set1(0.5f));
    rows3 u = rows_mul(t, f), v = get(s, CHAIN_Q, i);
    vf w = get1(s, CHAIN_Q + 3, i);
    vf inv = vf_div(one, vf_sqrt(vf_add(one, rows_dot(u, u))));
    rows3 next = rows_add(rows_mad(v, u, w), rows_cross(u, v));
    vf real = vf_sub(w, rows_dot(u, v));
    set(s, CHAIN_Q, i, rows_mul(next, inv));
    vf_store(s->data + (CHAIN_Q + 3) * s->stride + i, vf_mul(real, inv));
}

// r x (I (s x e)) for e = x, y, z: columns of [r] I [s].
typedef struct matrix {
    rows3 x, y, z;
} matrix;
ROWS_INLINE matrix turning(const wide_inertia *i, rows3 r, rows3 s) {
    vf o = vf_zero();
    return (matrix){rows_cross(r, wide_turn(i, (rows3){o, s.z, vf_neg(s.y)})),
                    rows_cross(r, wide_turn(i, (rows3){vf_neg(s.z), o, s.x})),
                    rows_cross(r, wide_turn(i, (rows3){s.y, vf_neg(s.x), o}))};
}

ROWS_INLINE void make_arms(const span *s) {
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        set(s, CHAIN_RA, i, rotate(s, i, get(s, CHAIN_LA, i)));
        set(s, CHAIN_RB, i, rotate(s, i + 1, get(s, CHAIN_LB, i)));
    }
}

ROWS_INLINE void make_blocks(const span *s) {
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        rows3 ra = get(s, CHAIN_RA, i), rb = get(s, CHAIN_RB, i), rn = get(s, CHAIN_RA, i + 1);
        wide_inertia ia = inertia_of(s, i), ib = inertia_of(s, i + 1);
        vf im = get1(s, CHAIN_IM, i + 1), mass = vf_add(get1(s, CHAIN_IM, i), im);
        matrix a = turning(&ia, ra, ra), b = turning(&ib, rb, rb), e = turning(&ib, rb, rn);
        set(s, CHAIN_D, i,
            (rows3){vf_sub(vf_sub(mass, a.x.x), b.x.x), vf_sub(vf_sub(mass, a.y.y), b.y.y),
                    vf_sub(vf_sub(mass, a.z.z), b.z.z)});
        set(s, CHAIN_D + 3, i,
            (rows3){vf_neg(vf_add(a.y.x, b.y.x)), vf_neg(vf_add(a.z.x, b.z.x)),
                    vf_neg(vf_add(a.z.y, b.z.y))});
        e.x.x = vf_sub(e.x.x, im);
        e.y.y = vf_sub(e.y.y, im);
        e.z.z = vf_sub(e.z.z, im);
        set(s, CHAIN_E, i, e.x);
        set(s, CHAIN_E + 3, i, e.y);
        set(s, CHAIN_E + 6, i, e.z);
    }
}

ROWS_INLINE void read_block(const span *s, int i, double d[6]) {
    for (int k = 0; k < 6; k++) {
        d[k] = (double)s->data[(size_t)(CHAIN_D + k) * s->stride + (size_t)i];
    }
    for (int k = 0; k < 3; k++) {
        d[k] *= 1.0 + REGULAR;
    }
}

// Block between the joint that goes and the one that stays: rows of the latter.
ROWS_INLINE void read_between(const span *s, int i, bool turned, double b[9]) {
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            int k = turned ? 3 * r + c : 3 * c + r;
            b[3 * r + c] = (double)s->data[(size_t)(CHAIN_E + k) * s->stride + (size_t)i];
        }
    }
}

ROWS_INLINE void invert(const double d[6], double out[6]) {
    double xx = d[1] * d[2] - d[5] * d[5], xy = d[4] * d[5] - d[3] * d[2];
    double xz = d[3] * d[5] - d[4] * d[1], det = d[0] * xx + d[3] * xy + d[4] * xz;
    double inv = det > 0.0 ? 1.0 / det : 0.0;
    out[0] = xx * inv;
    out[1] = (d[0] * d[2] - d[4] * d[4]) * inv;
    out[2] = (d[0] * d[1] - d[3] * d[3]) * inv;
    out[3] = xy * inv;
    out[4] = xz * inv;
    out[5] = (d[3] * d[4] - d[0] * d[5]) * inv;
}

// Eliminates a joint with block d; what is left of the next one's block goes to `next`.
ROWS_INLINE void eliminate(joint_factor *f, const double d[6], const double b[9], double next[6]) {
    invert(d, f->inverse);
    const double *v = f->inverse;
    double *g = f->spread;
    for (int r = 0; r < 3; r++) {
        const double *p = b + 3 * r;
        g[3 * r] = p[0] * v[0] + p[1] * v[3] + p[2] * v[4];
        g[3 * r + 1] = p[0] * v[3] + p[1] * v[1] + p[2] * v[5];
        g[3 * r + 2] = p[0] * v[4] + p[1] * v[5] + p[2] * v[2];
    }
    next[0] -= g[0] * b[0] + g[1] * b[1] + g[2] * b[2];
    next[1] -= g[3] * b[3] + g[4] * b[4] + g[5] * b[5];
    next[2] -= g[6] * b[6] + g[7] * b[7] + g[8] * b[8];
    next[3] -= g[0] * b[3] + g[1] * b[4] + g[2] * b[5];
    next[4] -= g[0] * b[6] + g[1] * b[7] + g[2] * b[8];
    next[5] -= g[3] * b[6] + g[4] * b[7] + g[5] * b[8];
}

// From both ends at once: the two halves do not wait for each other.
static void factor(const span *s) {
    int joints = s->nodes - 1, middle = joints / 2;
    double l[6], r[6], next[6], b[9];
    read_block(s, 0, l);
    read_block(s, joints - 1, r);
    for (int i = 0, j = joints - 1; i < middle; i++, j--) {
        read_block(s, i + 1, next);
        read_between(s, i, true, b);
        eliminate(&s->factor[i], l, b, next);
        for (int k = 0; k < 6; k++) {
            l[k] = next[k];
        }
        if (j > middle) {
            read_block(s, j - 1, next);
            read_between(s, j - 1, false, b);
            eliminate(&s->factor[j], r, b, next);
            for (int k = 0; k < 6; k++) {
                r[k] = next[k];
            }
        }
    }
    if (joints > 1 && joints - 1 > middle) { // both halves took their share of the middle's block
        read_block(s, middle, next);
        for (int k = 0; k < 6; k++) {
            l[k] += r[k] - next[k];
        }
    }
    invert(l, s->factor[middle].inverse);
}

ROWS_INLINE void read_rhs(const span *s, int i, double y[3]) {
    for (int k = 0; k < 3; k++) {
        y[k] = (double)s->data[(size_t)(CHAIN_RHS + k) * s->stride + (size_t)i];
    }
}
// y of a joint is kept times its inverse block.
ROWS_INLINE void sweep_in(joint_factor *f, const double y[3], double next[3]) {
    const double *g = f->spread, *v = f->inverse;
    f->y[0] = v[0] * y[0] + v[3] * y[1] + v[4] * y[2];
    f->y[1] = v[3] * y[0] + v[1] * y[1] + v[5] * y[2];
    f->y[2] = v[4] * y[0] + v[5] * y[1] + v[2] * y[2];
    for (int k = 0; k < 3; k++) {
        next[k] -= g[3 * k] * y[0] + g[3 * k + 1] * y[1] + g[3 * k + 2] * y[2];
    }
}
ROWS_INLINE void sweep_out(const span *s, int i, double x[3]) {
    const joint_factor *f = &s->factor[i];
    const double *g = f->spread, a = x[0], b = x[1], c = x[2];
    for (int k = 0; k < 3; k++) {
        x[k] = f->y[k] - (g[k] * a + g[3 + k] * b + g[6 + k] * c);
        s->data[(size_t)(CHAIN_X + k) * s->stride + (size_t)i] = (float)x[k];
    }
}

static void solve(const span *s) {
    int joints = s->nodes - 1, middle = joints / 2;
    double l[3], r[3], next[3], x[3];
    read_rhs(s, 0, l);
    read_rhs(s, joints - 1, r);
    for (int i = 0, j = joints - 1; i < middle; i++, j--) {
        read_rhs(s, i + 1, next);
        sweep_in(&s->factor[i], l, next);
        for (int k = 0; k < 3; k++) {
            l[k] = next[k];
        }
        if (j > middle) {
            read_rhs(s, j - 1, next);
            sweep_in(&s->factor[j], r, next);
            for (int k = 0; k < 3; k++) {
                r[k] = next[k];
            }
        }
    }
    if (joints > 1 && joints - 1 > middle) {
        read_rhs(s, middle, next);
        for (int k = 0; k < 3; k++) {
            l[k] += r[k] - next[k];
        }
    }
    const double *v = s->factor[middle].inverse;
    x[0] = v[0] * l[0] + v[3] * l[1] + v[4] * l[2];
    x[1] = v[3] * l[0] + v[1] * l[1] + v[5] * l[2];
    x[2] = v[4] * l[0] + v[5] * l[1] + v[2] * l[2];
    for (int k = 0; k < 3; k++) {
        s->data[(size_t)(CHAIN_X + k) * s->stride + (size_t)middle] = (float)x[k];
        r[k] = x[k];
    }
    for (int i = middle - 1, j = middle + 1; i >= 0; i--, j++) {
        sweep_out(s, i, x);
        if (j < joints) {
            sweep_out(s, j, r);
        }
    }
}

ROWS_INLINE void gather_velocity(const span *s, const soft_bodies *bodies) {
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        set(s, CHAIN_V, i, rows_gather(bodies->velocity, s->place + i, 0));
        set(s, CHAIN_V + 3, i, rows_gather(bodies->velocity, s->place + i, 4));
    }
}

// What is missing at each joint: of speed, with the gap closed at a rate (1/s); of the way.
ROWS_INLINE void miss_speed(const span *s, float rate) {
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        rows3 a =
            rows_add(get(s, CHAIN_V, i), rows_cross(get(s, CHAIN_V + 3, i), get(s, CHAIN_RA, i)));
        rows3 b = rows_add(get(s, CHAIN_V, i + 1),
                           rows_cross(get(s, CHAIN_V + 3, i + 1), get(s, CHAIN_RB, i)));
        rows3 pa = rows_add(get(s, CHAIN_P, i), get(s, CHAIN_RA, i));
        rows3 pb = rows_add(get(s, CHAIN_P, i + 1), get(s, CHAIN_RB, i));
        set(s, CHAIN_RHS, i, rows_mad(rows_sub(a, b), rows_sub(pa, pb), vf_set1(rate)));
    }
}
ROWS_INLINE void miss_way(const span *s, float scale) {
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        rows3 a = rows_add(get(s, CHAIN_P, i), rotate(s, i, get(s, CHAIN_LA, i)));
        rows3 b = rows_add(get(s, CHAIN_P, i + 1), rotate(s, i + 1, get(s, CHAIN_LB, i)));
        set(s, CHAIN_RHS, i, rows_mul(rows_sub(a, b), vf_set1(scale)));
    }
}

// Velocity that a node gets from the impulses on both its sides.
typedef struct gain {
    rows3 v, w;
} gain;
ROWS_INLINE gain gain_of(const span *s, int i) {
    rows3 before = get(s, CHAIN_X, i - 1), after = get(s, CHAIN_X, i);
    wide_inertia in = inertia_of(s, i);
    rows3 t = rows_sub(rows_cross(get(s, CHAIN_RB, i - 1), before),
                       rows_cross(get(s, CHAIN_RA, i), after));
    return (gain){rows_mul(rows_sub(before, after), get1(s, CHAIN_IM, i)), wide_turn(&in, t)};
}

ROWS_INLINE void add_rows(float *to, const span *s, int i, const gain *g, vf scale) {
    rows_scatter(to, s->to + i, 0, rows_mad(rows_gather(to, s->to + i, 0), g->v, scale));
    rows_scatter(to, s->to + i, 4, rows_mad(rows_gather(to, s->to + i, 4), g->w, scale));
}

ROWS_INLINE void solve_speed(const span *s, soft_bodies *bodies, float rate) {
    gather_velocity(s, bodies);
    miss_speed(s, rate);
    solve(s);
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        gain g = gain_of(s, i);
        add_rows(bodies->velocity, s, i, &g, vf_set1(1.0f));
        add_rows(bodies->mark, s, i, &g, vf_set1(1.0f));
        set(s, CHAIN_LOAD, i, rows_add(get(s, CHAIN_LOAD, i), get(s, CHAIN_X, i)));
    }
}

ROWS_INLINE void shift(const span *s, int i, rows3 way, rows3 angle) {
    set(s, CHAIN_P, i, rows_add(get(s, CHAIN_P, i), way));
    turn(s, i, angle);
}

ROWS_INLINE void follow(const span *s, soft_bodies *bodies, float h) {
    gather_velocity(s, bodies);
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        shift(s, i, rows_mul(get(s, CHAIN_V, i), vf_set1(h)),
              rows_mul(get(s, CHAIN_V + 3, i), vf_set1(h)));
    }
}

ROWS_INLINE void take_back(const span *s, soft_bodies *bodies, float h) {
    miss_way(s, 1.0f / h);
    solve(s);
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        gain g = gain_of(s, i);
        add_rows(bodies->velocity, s, i, &g, vf_set1(1.0f));
        add_rows(bodies->mark, s, i, &g, vf_set1(1.0f));
        add_rows(bodies->moved, s, i, &g, vf_set1(h));
        shift(s, i, rows_mul(g.v, vf_set1(h)), rows_mul(g.w, vf_set1(h)));
        set(s, CHAIN_LOAD, i, rows_add(get(s, CHAIN_LOAD, i), get(s, CHAIN_X, i)));
    }
}

ROWS_INLINE void place_again(const span *s, soft_bodies *bodies) {
    miss_way(s, 1.0f);
    solve(s);
    for (int i = 0; i < s->nodes; i += CORE_SIMD_WIDTH) {
        gain g = gain_of(s, i);
        add_rows(bodies->moved, s, i, &g, vf_set1(1.0f));
        shift(s, i, g.v, g.w);
    }
}

void CORE_SIMD_NAME(phys_joint_chain)(joint_chains *chains, uint32_t index, soft_bodies *bodies,
                                      chain_pass pass, float h) {
    const joint_chain *chain = &chains->chain[index];
    span s = {.data = chains->data + chain->first,
              .stride = chains->slots,
              .place = chains->place + chain->first,
              .to = chains->to + chain->first,
              .factor = chains->factor + chain->first,
              .nodes = (int)chain->joints + 1};
    if (pass == CHAIN_SOLVE || pass == CHAIN_RELAX) {
        solve_speed(&s, bodies, pass == CHAIN_SOLVE ? 1.0f / h : 0.0f);
        return;
    }
    if (pass != CHAIN_BEGIN) {
        follow(&s, bodies, h);
    }
    if (pass == CHAIN_LAST) {
        take_back(&s, bodies, h);
    }
    make_arms(&s);
    make_blocks(&s);
    factor(&s);
    if (pass == CHAIN_LAST) {
        place_again(&s, bodies);
    }
}
