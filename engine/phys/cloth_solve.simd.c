// Sub-steps of a cloth, wide. Lines of the matrix run along lanes: each lane solves one line of
// edges exactly (one Newton step of all its constraints, a tridiagonal system: Thomas' algorithm in
// LDL^T form), or edge by edge in two colours. Diagonals go in four colours, bending in two.
#include "phys/cloth.h"

typedef struct vec {
    vf x, y, z;
} vec;

static inline vec load(float *const p[3], uint32_t i) {
    return (vec){vf_loadu(p[0] + i), vf_loadu(p[1] + i), vf_loadu(p[2] + i)};
}
static inline void store(float *const p[3], uint32_t i, vec a) {
    vf_storeu(p[0] + i, a.x);
    vf_storeu(p[1] + i, a.y);
    vf_storeu(p[2] + i, a.z);
}
static inline vec sub(vec a, vec b) {
    return (vec){vf_sub(a.x, b.x), vf_sub(a.y, b.y), vf_sub(a.z, b.z)};
}
static inline vec mad(vec a, vec b, vf s) { // a + b*s
    return (vec){vf_mad(b.x, s, a.x), vf_mad(b.y, s, a.y), vf_mad(b.z, s, a.z)};
}
static inline vf dot(vec a, vec b) { return vf_mad(a.z, b.z, vf_mad(a.y, b.y, vf_mul(a.x, b.x))); }
static inline vec scale(vec a, vf s) {
    return (vec){vf_mul(a.x, s), vf_mul(a.y, s), vf_mul(a.z, s)};
}

// Lines of `count` particles, `stride` apart; lanes are lines.
typedef struct lines {
    float *const *x;
    const float *w, *on;
    float *pull; // sums of multipliers
    uint32_t count, stride;
    float rest, compliance;
} lines;

// Factors from the first edge on; leaves normals, off-diagonals, inverse pivots and right sides.
static void factor(phys_cloth_work *k, const lines *l, uint32_t lane) {
    const vf one = vf_set1(1.0f), zero = vf_zero(), tiny = vf_set1(1e-12f);
    vec n_before = {zero, zero, zero}, a = load(l->x, lane);
    vf inv_before = zero, y_before = zero, wa = vf_loadu(l->w + lane);
    for (uint32_t r = 0; r + 1 < l->count; r++) {
        uint32_t i = r * l->stride + lane, j = i + l->stride;
        vec b = load(l->x, j), d = sub(b, a);
        vf wb = vf_loadu(l->w + j), length = vf_sqrt(dot(d, d)), both = vf_add(wa, wb);
        vm on = vm_and(vf_gt(vf_loadu(l->on + i), zero), vf_gt(both, zero));
        vec n = scale(d, vf_keep(on, vf_div(one, vf_max(length, tiny))));
        vf diagonal = vf_select(on, vf_add(both, vf_set1(l->compliance)), one);
        vf off = vf_neg(vf_mul(wa, dot(n_before, n)));
        vf ratio = vf_mul(off, inv_before);
        // Straight lines between two fixed ends leave pivots to rounding: a floor keeps them sane.
        vf pivot = vf_sub(diagonal, vf_mul(ratio, off));
        vf inv = vf_div(one, vf_max(pivot, vf_mul(diagonal, vf_set1(1e-5f))));
        vf error = vf_keep(on, vf_sub(length, vf_set1(l->rest)));
        vf y = vf_neg(vf_mad(ratio, y_before, error));
        store(k->n, i, n);
        vf_storeu(k->off + i, off);
        vf_storeu(k->inv + i, inv);
        vf_storeu(k->y + i, y);
        n_before = n;
        inv_before = inv;
        y_before = y;
        wa = wb;
        a = b;
    }
}

// From the last edge back: multipliers, and the particles' ways.
static void substitute(phys_cloth_work *k, const lines *l, uint32_t lane) {
    const vf zero = vf_zero();
    vec after = {zero, zero, zero}; // of the edge behind: normal times multiplier
    vf lambda_after = zero, off_after = zero;
    for (uint32_t r = l->count - 1; r-- > 0;) {
        uint32_t i = r * l->stride + lane, j = i + l->stride;
        vf y = vf_sub(vf_loadu(k->y + i), vf_mul(off_after, lambda_after));
        vf lambda = vf_mul(y, vf_loadu(k->inv + i));
        vec force = scale(load(k->n, i), lambda);
        store(l->x, j, mad(load(l->x, j), sub(force, after), vf_loadu(l->w + j)));
        vf_storeu(l->pull + i, vf_sub(vf_loadu(l->pull + i), lambda));
        off_after = vf_loadu(k->off + i);
        lambda_after = lambda;
        after = force;
    }
    vec first = load(l->x, lane);
    store(l->x, lane, mad(first, after, vf_neg(vf_loadu(l->w + lane))));
}

// Edges between x[i] and x[j], both runs of lanes; `on` says which exist.
static inline vf edges(float *const x[3], const float *w, uint32_t i, uint32_t j, vf on, float rest,
                       float compliance) {
    const vf one = vf_set1(1.0f), zero = vf_zero();
    vec a = load(x, i), b = load(x, j), d = sub(b, a);
    vf wa = vf_loadu(w + i), wb = vf_loadu(w + j), length = vf_sqrt(dot(d, d));
    vf both = vf_add(vf_add(wa, wb), vf_set1(compliance));
    vm live = vm_and(vf_gt(on, zero), vf_gt(vf_mul(length, vf_add(wa, wb)), zero));
    vf size = vf_mul(vf_select(live, length, one), vf_select(live, both, one));
    vf s = vf_keep(live, vf_div(vf_sub(vf_set1(rest), length), size));
    store(x, i, mad(a, d, vf_neg(vf_mul(s, wa))));
    store(x, j, mad(load(x, j), d, vf_mul(s, wb)));
    return vf_neg(vf_mul(s, length));
}

static void solve_lines(phys_cloth_work *k, const lines *l) {
    for (uint32_t lane = 0; l->count > 1 && lane < l->stride; lane += CORE_SIMD_WIDTH) {
        if (k->direct) {
            factor(k, l, lane);
            substitute(k, l, lane);
            continue;
        }
        for (uint32_t odd = 0; odd < 2; odd++) {
            for (uint32_t r = odd; r + 1 < l->count; r += 2) {
                uint32_t i = r * l->stride + lane;
                vf pull = edges(l->x, l->w, i, i + l->stride, vf_loadu(l->on + i), l->rest,
                                l->compliance);
                vf_storeu(l->pull + i, vf_add(vf_loadu(l->pull + i), pull));
            }
        }
    }
}

static void solve_bending(phys_cloth_work *k, const lines *l) {
    for (uint32_t set = 0; set < 2; set++) {
        for (uint32_t r = 0; r + 2 < l->count; r++) {
            if ((r >> 1 & 1u) != set) {
                continue;
            }
            for (uint32_t lane = 0; lane < l->stride; lane += CORE_SIMD_WIDTH) {
                uint32_t i = r * l->stride + lane, j = i + l->stride;
                vf on = vf_mul(vf_loadu(l->on + i), vf_loadu(l->on + j));
                edges(l->x, l->w, i, j + l->stride, on, 2.0f * l->rest, k->bend);
            }
        }
    }
}

static void solve_shear(phys_cloth_work *k) {
    for (uint32_t pass = 0; pass < 4; pass++) {
        uint32_t left = pass & 1u, right = 1u - left;
        for (uint32_t r = pass >> 1; r + 1 < k->rows; r += 2) {
            for (uint32_t c = 0; c < k->stride; c += CORE_SIMD_WIDTH) {
                uint32_t i = r * k->stride + c;
                edges(k->x, k->w, i + left, i + k->stride + right, vf_loadu(k->cell + i),
                      k->rest_diagonal, k->shear);
            }
        }
    }
}

// Out of the body along the normal; along the surface by at most what friction holds.
static void solve_contacts(phys_cloth_work *k, phys_cloth_contact *c, float time) {
    const vf zero = vf_zero(), one = vf_set1(1.0f);
    for (uint32_t i = 0; i < k->rows * k->stride; i += CORE_SIMD_WIDTH) {
        vec n = load(c->n, i), x = load(k->x, i);
        vf limit = vf_mad(vf_loadu(c->dv + i), vf_set1(time), vf_loadu(c->d + i));
        vm free = vf_gt(vf_loadu(k->w + i), zero);
        vf depth = vf_keep(free, vf_max(vf_sub(limit, dot(n, x)), zero));
        if (!vm_any(vf_gt(depth, zero))) {
            continue;
        }
        x = mad(x, n, depth);
        vec way = mad(sub(x, load(k->q, i)), load(c->u, i), vf_set1(-k->h));
        way = mad(way, n, vf_neg(dot(way, n)));
        vf slide = vf_sqrt(dot(way, way)), hold = vf_mul(vf_loadu(c->grip + i), depth);
        vf part = vf_min(vf_div(hold, vf_max(slide, vf_set1(1e-12f))), one);
        vec back = scale(way, vf_neg(part));
        store(k->x, i, mad(x, back, one));
        store(c->push, i, mad(mad(load(c->push, i), n, depth), back, one));
    }
}

static void turn(float *const from[3], float *const to[3], uint32_t rows, uint32_t columns,
                 uint32_t from_stride, uint32_t to_stride) {
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t r = 0; r < rows; r++) {
            for (uint32_t c = 0; c < columns; c++) {
                to[axis][c * to_stride + r] = from[axis][r * from_stride + c];
            }
        }
    }
}

static void move(phys_cloth_work *k) {
    const vf h = vf_set1(k->h);
    for (uint32_t i = 0; i < k->rows * k->stride; i += CORE_SIMD_WIDTH) {
        vec x = load(k->x, i), v = mad(load(k->v, i), load(k->a, i), h);
        store(k->q, i, x);
        store(k->x, i, mad(x, v, h));
    }
}

static void find_velocities(phys_cloth_work *k) {
    const vf rate = vf_set1(k->keep / k->h), whole = vf_set1(1.0f / k->h), zero = vf_zero();
    for (uint32_t i = 0; i < k->rows * k->stride; i += CORE_SIMD_WIDTH) {
        vm free = vf_gt(vf_loadu(k->w + i), zero);
        vec way = sub(load(k->x, i), load(k->q, i));
        store(k->v, i, scale(way, vf_select(free, rate, whole)));
    }
}

void CORE_SIMD_NAME(phys_cloth_solve)(phys_cloth_work *k) {
    lines down = {k->x, k->w, k->down, k->pull_down, k->rows, k->stride, k->rest_down, k->stretch};
    lines across = {k->t,           k->tw,      k->across,
                    k->pull_across, k->columns, k->turned_stride,
                    k->rest_across, k->stretch};
    for (uint32_t s = 0; s < k->substeps; s++) {
        move(k);
        if (k->columns > 1) {
            if (k->rows > 1) {
                solve_shear(k);
            }
            turn(k->x, k->t, k->rows, k->columns, k->stride, k->turned_stride);
            if (k->bend >= 0.0f) {
                solve_bending(k, &across);
            }
            solve_lines(k, &across);
            turn(k->t, k->x, k->columns, k->rows, k->turned_stride, k->stride);
        }
        if (k->bend >= 0.0f) {
            solve_bending(k, &down);
        }
        solve_lines(k, &down);
        for (int c = 0; k->touches && c < PHYS_CLOTH_CONTACTS; c++) {
            solve_contacts(k, &k->contact[c], (float)(s + 1) * k->h);
        }
        find_velocities(k);
    }
}
