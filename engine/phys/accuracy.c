// How right the present state is, computed from poses in double precision. Shares no code with the
// narrow phase or the solver on purpose: it judges them.
#include "phys/world.h"

typedef struct v3 {
    double x, y, z;
} v3;
typedef struct solid {
    v3 p, axis[3], half;   // axis: unit, world
    double radius, lo, hi; // lo, hi: extent along x
    uint32_t body, type;
    bool fixed;
} solid;

static v3 sub(v3 a, v3 b) { return (v3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static v3 cross(v3 a, v3 b) {
    return (v3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static double dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static double len(v3 a) { return core_sqrt(dot(a, a)); }
static double mag(double x) { return x < 0 ? -x : x; }

static v3 turn(core_quat q, v3 v) {
    double n =
        core_sqrt((double)q.x * q.x + (double)q.y * q.y + (double)q.z * q.z + (double)q.w * q.w);
    v3 u = {q.x / n, q.y / n, q.z / n}, c = cross(u, v), cc = cross(u, c);
    double w = 2.0 * q.w / n;
    return (v3){v.x + w * c.x + 2 * cc.x, v.y + w * c.y + 2 * cc.y, v.z + w * c.z + 2 * cc.z};
}

static solid make_solid(const phys_world *w, uint32_t i) {
    const phys_shapes *s = &w->shapes;
    const phys_bodies *b = &w->bodies;
    uint32_t row = phys_slot_row(&b->set, s->body[i]);
    core_quat q = phys_body_quat(b, row), l = s->rotation[i];
    v3 at = turn(q, (v3){s->position[i].x, s->position[i].y, s->position[i].z});
    solid o = {.p = {b->px[row] + at.x, b->py[row] + at.y, b->pz[row] + at.z},
               .half = {s->half[i].x, s->half[i].y, s->half[i].z},
               .radius = s->radius[i],
               .body = row,
               .type = s->type[i],
               .fixed = b->type[row] != PHYS_DYNAMIC};
    o.axis[0] = turn(q, turn(l, (v3){1, 0, 0}));
    o.axis[1] = turn(q, turn(l, (v3){0, 1, 0}));
    o.axis[2] = turn(q, turn(l, (v3){0, 0, 1}));
    double e = o.radius;
    if (o.type == PHYS_BOX) {
        e = mag(o.axis[0].x) * o.half.x + mag(o.axis[1].x) * o.half.y + mag(o.axis[2].x) * o.half.z;
    } else if (o.type == PHYS_PLANE) {
        e = 1e30;
    }
    o.lo = o.p.x - e;
    o.hi = o.p.x + e;
    return o;
}

static v3 into(const solid *box, v3 p) {
    v3 d = sub(p, box->p);
    return (v3){dot(d, box->axis[0]), dot(d, box->axis[1]), dot(d, box->axis[2])};
}

static double depth_sphere_box(const solid *s, const solid *b) {
    v3 c = into(b, s->p), h = b->half;
    v3 q = {CORE_CLAMP(c.x, -h.x, h.x), CORE_CLAMP(c.y, -h.y, h.y), CORE_CLAMP(c.z, -h.z, h.z)};
    double d = len(sub(c, q));
    if (d > 0) {
        return s->radius - d;
    }
    double gx = h.x - mag(c.x), gy = h.y - mag(c.y), gz = h.z - mag(c.z);
    return s->radius + CORE_MIN(gx, CORE_MIN(gy, gz));
}

static double reach(const solid *b, v3 n) {
    return mag(dot(b->axis[0], n)) * b->half.x + mag(dot(b->axis[1], n)) * b->half.y +
           mag(dot(b->axis[2], n)) * b->half.z;
}

static double depth_box_box(const solid *a, const solid *b) {
    v3 d = sub(b->p, a->p);
    double least = 1e300;
    for (int k = 0; k < 15; k++) {
        v3 n = k < 3   ? a->axis[k]
               : k < 6 ? b->axis[k - 3]
                       : cross(a->axis[(k - 6) / 3], b->axis[k % 3]);
        double l = len(n);
        if (l < 1e-8) {
            continue;
        }
        n = (v3){n.x / l, n.y / l, n.z / l};
        double overlap = reach(a, n) + reach(b, n) - mag(dot(d, n));
        if (overlap <= 0) {
            return overlap;
        }
        least = CORE_MIN(least, overlap);
    }
    return least;
}

// > 0: the two overlap by so many metres.
static double depth(const solid *a, const solid *b) {
    if (a->type > b->type) {
        const solid *t = a;
        a = b;
        b = t;
    }
    if (b->type == PHYS_PLANE) {
        double extent = a->type == PHYS_BOX ? reach(a, b->axis[1]) : a->radius;
        return extent - dot(sub(a->p, b->p), b->axis[1]);
    }
    if (a->type == PHYS_SPHERE && b->type == PHYS_SPHERE) {
        return a->radius + b->radius - len(sub(a->p, b->p));
    }
    if (a->type == PHYS_SPHERE) {
        return depth_sphere_box(a, b);
    }
    return depth_box_box(a, b);
}

static void sort_by_low(solid **s, solid **tmp, uint32_t n) {
    for (uint32_t width = 1; width < n; width *= 2) {
        for (uint32_t lo = 0; lo < n; lo += 2 * width) {
            uint32_t mid = CORE_MIN(lo + width, n), hi = CORE_MIN(lo + 2 * width, n);
            uint32_t i = lo, j = mid;
            for (uint32_t k = lo; k < hi; k++) {
                tmp[k] = i < mid && (j >= hi || s[i]->lo <= s[j]->lo) ? s[i++] : s[j++];
            }
        }
        for (uint32_t k = 0; k < n; k++) {
            s[k] = tmp[k];
        }
    }
}

static void measure_overlap(phys_world *w, phys_accuracy *out) {
    uint32_t n = core_columns_count(&w->shapes.set), used = 0, pairs = 0;
    solid *all = CORE_ARENA_ARRAY(&w->scratch, solid, n + 1);
    solid **order = CORE_ARENA_ARRAY(&w->scratch, solid *, n + 1);
    solid **tmp = CORE_ARENA_ARRAY(&w->scratch, solid *, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        all[i] = make_solid(w, i);
        if (all[i].lo <= all[i].hi) { // not NaN
            order[used++] = &all[i];
        }
    }
    sort_by_low(order, tmp, used);
    double sum = 0, most = 0;
    for (uint32_t i = 0; i < used; i++) {
        const solid *a = order[i];
        for (uint32_t j = i + 1; j < used && order[j]->lo < a->hi; j++) {
            const solid *b = order[j];
            if (a->body == b->body || (a->fixed && b->fixed)) {
                continue;
            }
            double d = depth(a, b);
            if (d > 0) {
                sum += d;
                pairs++;
                most = CORE_MAX(most, d);
            }
        }
    }
    out->penetration_max_m = most;
    out->penetration_mean_m = pairs ? sum / pairs : 0;
}

// Kinetic and potential energy, momentum, and how many bodies are not finite.
static void measure_motion(const phys_world *w, phys_accuracy *out, v3 *momentum, double *mass,
                           bool *anchored) {
    const phys_bodies *b = &w->bodies;
    uint32_t n = core_columns_count(&b->set);
    for (uint32_t i = 0; i < n; i++) {
        double sum = (double)b->px[i] + b->py[i] + b->pz[i] + b->qx[i] + b->qy[i] + b->qz[i] +
                     b->qw[i] + b->vx[i] + b->vy[i] + b->vz[i] + b->wx[i] + b->wy[i] + b->wz[i];
        if (!(sum - sum == 0) || (b->flags[i] & PHYS_BODY_LOST)) {
            out->nan++;
            continue;
        }
        if (b->type[i] != PHYS_DYNAMIC) {
            *anchored = true;
            continue;
        }
        double m = 1.0 / b->im[i];
        v3 v = {b->vx[i], b->vy[i], b->vz[i]}, o = {b->wx[i], b->wy[i], b->wz[i]};
        core_quat q = phys_body_quat(b, i), f = b->iq[i];
        v3 ax = turn(q, turn(f, (v3){1, 0, 0})), ay = turn(q, turn(f, (v3){0, 1, 0}));
        v3 az = cross(ax, ay);
        double sx = dot(o, ax), sy = dot(o, ay), sz = dot(o, az);
        out->energy_j += 0.5 * m * dot(v, v) +
                         0.5 * (sx * sx / b->ix[i] + sy * sy / b->iy[i] + sz * sz / b->iz[i]);
        v3 g = {w->gravity.x, w->gravity.y, w->gravity.z}, c = {b->cx[i], b->cy[i], b->cz[i]};
        out->energy_j -= m * b->gravity_scale[i] * dot(g, c);
        *momentum = (v3){momentum->x + m * v.x, momentum->y + m * v.y, momentum->z + m * v.z};
        *mass += m * b->gravity_scale[i];
    }
}

// A body whose way since the last sample goes through a slab (a static box much thinner than wide)
// from face to face has tunnelled.
static bool crossed(const solid *slab, v3 from, v3 to, double size) {
    double h[3] = {slab->half.x, slab->half.y, slab->half.z};
    int thin = h[0] <= h[1] ? (h[0] <= h[2] ? 0 : 2) : (h[1] <= h[2] ? 1 : 2);
    int u = (thin + 1) % 3, v = (thin + 2) % 3;
    if (h[thin] * 4 > h[u] || h[thin] * 4 > h[v]) {
        return false;
    }
    v3 a = into(slab, from), b = into(slab, to);
    double fa[3] = {a.x, a.y, a.z}, fb[3] = {b.x, b.y, b.z};
    if (!((fa[thin] > h[thin] && fb[thin] < -h[thin]) ||
          (fa[thin] < -h[thin] && fb[thin] > h[thin]))) {
        return false;
    }
    double t = fa[thin] / (fa[thin] - fb[thin]);
    return mag(fa[u] + t * (fb[u] - fa[u])) < h[u] - size &&
           mag(fa[v] + t * (fb[v] - fa[v])) < h[v] - size;
}

static void measure_tunnelling(phys_world *w) {
    const phys_shapes *s = &w->shapes;
    phys_bodies *b = &w->bodies;
    for (uint32_t i = 0; i < core_columns_count(&s->set); i++) {
        uint32_t row = phys_slot_row(&b->set, s->body[i]);
        if (s->type[i] != PHYS_BOX || b->type[row] != PHYS_STATIC) {
            continue;
        }
        solid slab = make_solid(w, i);
        for (uint32_t k = 0; k < core_columns_count(&b->set); k++) {
            core_vec3 from = b->seen[k];
            if (b->type[k] == PHYS_DYNAMIC && !b->through[k] &&
                crossed(&slab, (v3){from.x, from.y, from.z}, (v3){b->cx[k], b->cy[k], b->cz[k]},
                        0.1)) {
                b->through[k] = 1;
                w->tunnelled++;
            }
        }
    }
    for (uint32_t k = 0; k < core_columns_count(&b->set); k++) {
        b->seen[k] = phys_get3(b->cx, b->cy, b->cz, k);
    }
}

void phys_world_accuracy(phys_world *w, phys_accuracy *out) {
    size_t mark = core_arena_mark(&w->scratch);
    *out = (phys_accuracy){0};
    v3 p = {0};
    double mass = 0;
    bool anchored = false;
    measure_motion(w, out, &p, &mass, &anchored);
    measure_overlap(w, out);
    measure_tunnelling(w);
    out->tunnelled = w->tunnelled;
    if (!w->measured) {
        w->measured = true;
        w->first_energy = out->energy_j;
        w->energy_scale = mag(out->energy_j);
        w->first_momentum[0] = p.x;
        w->first_momentum[1] = p.y;
        w->first_momentum[2] = p.z;
        w->first_time = w->time;
    }
    w->energy_scale = CORE_MAX(w->energy_scale, mag(out->energy_j));
    double gain = out->energy_j - w->first_energy - w->work;
    out->energy_drift = gain > 0 && w->energy_scale > 0 ? gain / w->energy_scale : 0;
    double t = w->time - w->first_time;
    v3 want = {w->first_momentum[0] + mass * w->gravity.x * t,
               w->first_momentum[1] + mass * w->gravity.y * t,
               w->first_momentum[2] + mass * w->gravity.z * t};
    double scale = CORE_MAX(len(p), len(want));
    out->momentum_drift = anchored || w->work != 0 ? __builtin_nan("")
                          : scale > 0              ? len(sub(p, want)) / scale
                                                   : 0;
    core_arena_rewind(&w->scratch, mark);
}
