// GJK distance and EPA penetration between convex sets, and what follows from them: closest points,
// point inside, ray cast. Works on cores (points or a cylinder without their radius) in double;
// radii are added at the end.
#include "phys/geom.h"
#include "phys/geom_d.h"

#include <math.h>

#define GJK_MAX_ITERATIONS 64
#define EPA_MAX_VERTICES   96
#define EPA_MAX_FACES      192
#define SLIVER             1e-9 // relative height of a tetrahedron that counts as flat
#define EPA_TOLERANCE      1e-7 // metres: curved sets are approached, never reached

typedef struct support {
    dvec w, a, b; // w = b - a on the Minkowski difference B - A
} support;

// The core of a set relative to `base`, so that far-away pairs lose no digits.
typedef struct core_set {
    const phys_geom_convex *c;
    dvec at;
} core_set;

static dvec core_support(const core_set *s, dvec d) {
    const phys_geom_convex *c = s->c;
    dvec l = d_unrotate(c->rotation, d), p = {0, 0, 0};
    if (c->half_height > 0) {
        double side = __builtin_sqrt(l.x * l.x + l.z * l.z);
        double k = side > 0 ? (double)c->radius / side : 0;
        p = (dvec){l.x * k, l.y < 0 ? -(double)c->half_height : (double)c->half_height, l.z * k};
    } else {
        // Among corners that float cannot tell apart any serves; the distance is taken in double.
        const core_vec3 f = {(float)l.x, (float)l.y, (float)l.z};
        float best = -1e38f;
        uint32_t corner = 0;
        for (uint32_t i = 0; i < c->count; i++) {
            float along = core_v3_dot(c->point[i], f);
            corner = along > best ? i : corner;
            best = along > best ? along : best;
        }
        p = d_of(c->point[corner]);
    }
    return d_add(s->at, d_rotate(c->rotation, p));
}

static support difference(const core_set *a, const core_set *b, dvec d) {
    support s;
    s.b = core_support(b, d);
    s.a = core_support(a, d_scale(d, -1));
    s.w = d_sub(s.b, s.a);
    return s;
}

// ---- the simplex: closest point to the origin and the smallest face that holds it ----

typedef struct simplex {
    support s[4];
    double weight[4];
    int count;
} simplex;

static void keep(simplex *x, const double *w, const int *index, int n) {
    simplex old = *x;
    x->count = 0;
    for (int i = 0; i < n; i++) {
        if (w[i] > 0) {
            x->s[x->count] = old.s[index[i]];
            x->weight[x->count++] = w[i];
        }
    }
}

static dvec reduce_line(simplex *x) {
    static const int index[2] = {0, 1};
    double t = d_line_parameter((dvec){0, 0, 0}, x->s[0].w, x->s[1].w, true);
    const double w[2] = {1 - t, t};
    dvec v = d_mad(x->s[0].w, d_sub(x->s[1].w, x->s[0].w), t);
    keep(x, w, index, 2);
    return v;
}

static dvec reduce_triangle(simplex *x) {
    static const int index[3] = {0, 1, 2};
    double w[3];
    dvec v = d_closest_triangle((dvec){0, 0, 0}, x->s[0].w, x->s[1].w, x->s[2].w, w);
    keep(x, w, index, 3);
    return v;
}

// The origin is inside when it is on the inner side of all four faces. *inside is set then. Of a
// tetrahedron without volume (the supports of a cylinder's rim lie close together) no side is sure:
// all its faces are asked.
static dvec reduce_tetrahedron(simplex *x, bool *inside) {
    static const int face[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
    dvec best_v = {0, 0, 0}, zero = {0, 0, 0};
    double best = -1, best_w[3] = {0, 0, 0};
    int best_face = -1;
    for (int f = 0; f < 4; f++) {
        dvec a = x->s[face[f][0]].w, b = x->s[face[f][1]].w, c = x->s[face[f][2]].w;
        dvec n = d_cross(d_sub(b, a), d_sub(c, a));
        dvec height = d_sub(x->s[face[f][3]].w, a);
        double inner = d_dot(n, height), side = -d_dot(n, a);
        bool flat = inner * inner <= SLIVER * SLIVER * d_dot(n, n) * d_dot(height, height);
        if (!flat && ((inner > 0 && side >= 0) || (inner < 0 && side <= 0))) {
            continue;
        }
        double w[3];
        dvec v = d_closest_triangle(zero, a, b, c, w);
        if (best < 0 || d_dot(v, v) < best) {
            best = d_dot(v, v), best_v = v, best_face = f;
            best_w[0] = w[0], best_w[1] = w[1], best_w[2] = w[2];
        }
    }
    *inside = best_face < 0;
    if (!*inside) {
        keep(x, best_w, face[best_face], 3);
    }
    return best_v;
}

static dvec reduce(simplex *x, bool *inside) {
    *inside = false;
    switch (x->count) {
    case 1:
        x->weight[0] = 1;
        return x->s[0].w;
    case 2:
        return reduce_line(x);
    case 3:
        return reduce_triangle(x);
    default:
        return reduce_tetrahedron(x, inside);
    }
}

static bool has_support(const simplex *x, dvec w) {
    for (int i = 0; i < x->count; i++) {
        dvec d = d_sub(x->s[i].w, w);
        if (!(d_dot(d, d) > 0)) {
            return true;
        }
    }
    return false;
}

typedef struct gjk_state {
    simplex x;
    dvec v;       // closest point of B - A to the origin
    bool overlap; // the origin is inside (or on the border within tolerance)
    uint32_t iterations;
} gjk_state;

static gjk_state run_gjk(const core_set *a, const core_set *b) {
    gjk_state g = {0};
    dvec start = d_sub(a->at, b->at);
    g.x.s[0] = difference(a, b, d_normalize(start, (dvec){1, 0, 0}));
    g.x.count = 1, g.x.weight[0] = 1;
    g.v = g.x.s[0].w;
    double size2 = d_dot(g.v, g.v);
    for (; g.iterations < GJK_MAX_ITERATIONS; g.iterations++) {
        double vv = d_dot(g.v, g.v);
        if (vv <= 1e-20 * size2 || !(vv > 0)) {
            g.overlap = true;
            break;
        }
        support s = difference(a, b, d_scale(g.v, -1));
        double gap = vv - d_dot(g.v, s.w);
        if (gap <= 1e-12 * vv || has_support(&g.x, s.w)) {
            break;
        }
        size2 = CORE_MAX(size2, d_dot(s.w, s.w));
        simplex before = g.x;
        g.x.s[g.x.count++] = s;
        dvec v = reduce(&g.x, &g.overlap);
        if (g.overlap) {
            break;
        }
        if (!(d_dot(v, v) < vv)) { // rounding: no progress left
            g.x = before;
            break;
        }
        g.v = v;
    }
    return g;
}

static void witness(const simplex *x, dvec *a, dvec *b) {
    *a = *b = (dvec){0, 0, 0};
    for (int i = 0; i < x->count; i++) {
        *a = d_mad(*a, x->s[i].a, x->weight[i]);
        *b = d_mad(*b, x->s[i].b, x->weight[i]);
    }
}

// ---- EPA ----

typedef struct epa_face {
    int v[3];
    dvec normal;
    double distance;
    bool alive;
} epa_face;

typedef struct epa {
    const core_set *a, *b;
    support s[EPA_MAX_VERTICES];
    int count, face_count;
    epa_face face[EPA_MAX_FACES];
} epa;

static bool epa_add_face(epa *e, int x, int y, int z) {
    int at = 0;
    while (at < e->face_count && e->face[at].alive) {
        at++;
    }
    if (at == EPA_MAX_FACES) {
        return false;
    }
    epa_face *f = &e->face[at];
    dvec o = e->s[x].w;
    dvec n = d_cross(d_sub(e->s[y].w, o), d_sub(e->s[z].w, o));
    double length = d_length(n);
    *f = (epa_face){{x, y, z}, {0, 0, 0}, INFINITY, true};
    if (length > 0) { // faces without area stay, but are never the nearest
        f->normal = d_scale(n, 1 / length);
        f->distance = d_dot(f->normal, o);
    }
    e->face_count = at == e->face_count ? at + 1 : e->face_count;
    return true;
}

static bool epa_try(epa *e, dvec d) {
    support s = difference(e->a, e->b, d);
    for (int i = 0; i < e->count; i++) {
        dvec gap = d_sub(e->s[i].w, s.w);
        if (d_dot(gap, gap) <= 1e-24) {
            return false;
        }
    }
    e->s[e->count++] = s;
    return true;
}

// Makes a tetrahedron around the origin from whatever simplex GJK ended with (van den Bergen 2001).
static bool epa_start(epa *e, const simplex *x) {
    static const dvec axis[6] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                 {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    e->count = 0;
    for (int i = 0; i < x->count; i++) {
        e->s[e->count++] = x->s[i];
    }
    for (int i = 0; e->count < 2 && i < 6; i++) {
        epa_try(e, axis[i]);
    }
    if (e->count == 2) { // three directions across the line
        dvec u = d_sub(e->s[1].w, e->s[0].w);
        for (int i = 0; e->count < 3 && i < 6; i++) {
            dvec d = d_cross(u, axis[i]);
            if (d_dot(d, d) > 1e-12 * d_dot(u, u)) {
                epa_try(e, d);
                dvec c = e->count == 3 ? d_cross(u, d_sub(e->s[2].w, e->s[0].w)) : u;
                if (e->count == 3 && !(d_dot(c, c) > 1e-24 * d_dot(u, u) * d_dot(u, u))) {
                    e->count = 2; // still on the line
                }
            }
        }
    }
    if (e->count == 3) {
        dvec n = d_cross(d_sub(e->s[1].w, e->s[0].w), d_sub(e->s[2].w, e->s[0].w));
        if (!epa_try(e, n)) {
            epa_try(e, d_scale(n, -1));
        }
        dvec up = e->count == 4 ? d_sub(e->s[3].w, e->s[0].w) : n;
        if (e->count == 4 && !(fabs(d_dot(up, n)) > 1e-12 * d_length(up) * d_length(n))) {
            e->count = 3;
            if (epa_try(e, d_scale(n, -1))) {
                up = d_sub(e->s[3].w, e->s[0].w);
                e->count = fabs(d_dot(up, n)) > 1e-12 * d_length(up) * d_length(n) ? 4 : 3;
            }
        }
    }
    if (e->count < 4) {
        return false; // B - A is flat: the overlap has no depth
    }
    dvec n = d_cross(d_sub(e->s[1].w, e->s[0].w), d_sub(e->s[2].w, e->s[0].w));
    if (d_dot(n, d_sub(e->s[3].w, e->s[0].w)) > 0) {
        support swap = e->s[1];
        e->s[1] = e->s[2], e->s[2] = swap;
    }
    e->face_count = 0;
    return epa_add_face(e, 0, 1, 2) && epa_add_face(e, 0, 3, 1) && epa_add_face(e, 1, 3, 2) &&
           epa_add_face(e, 2, 3, 0);
}

// Nearest face at `floor` or beyond. The nearest distance never falls while the polytope is sound,
// so a face below the floor is a sliver whose normal is rounding: it is passed over.
static int epa_nearest(const epa *e, double floor) {
    int best = -1;
    for (int i = 0; i < e->face_count; i++) {
        const epa_face *f = &e->face[i];
        if (f->alive && f->distance >= floor &&
            (best < 0 || f->distance < e->face[best].distance)) {
            best = i;
        }
    }
    return best;
}

// Removes the faces that see s[v] and closes the hole with faces to it. False when out of room.
static bool epa_insert(epa *e, int v) {
    int edge[EPA_MAX_FACES * 3][2], edges = 0;
    dvec w = e->s[v].w;
    for (int i = 0; i < e->face_count; i++) {
        epa_face *f = &e->face[i];
        if (!f->alive || (f->distance < INFINITY && d_dot(f->normal, w) <= f->distance)) {
            continue;
        }
        f->alive = false;
        for (int k = 0; k < 3; k++) { // an edge seen from both sides is inside the hole
            int from = f->v[k], to = f->v[(k + 1) % 3], twin = -1;
            for (int j = 0; j < edges; j++) {
                twin = edge[j][0] == to && edge[j][1] == from ? j : twin;
            }
            if (twin >= 0) {
                edges--;
                edge[twin][0] = edge[edges][0], edge[twin][1] = edge[edges][1];
            } else {
                edge[edges][0] = from, edge[edges][1] = to, edges++;
            }
        }
    }
    for (int i = 0; i < edges; i++) {
        if (!epa_add_face(e, edge[i][0], edge[i][1], v)) {
            return false;
        }
    }
    return edges > 0;
}

// The nearest face of B - A to the origin: its normal (from the origin outwards), distance,
// witnesses.
static double run_epa(const core_set *a, const core_set *b, const simplex *x, dvec *normal,
                      dvec *wa, dvec *wb) {
    epa e = {.a = a, .b = b};
    witness(x, wa, wb);
    *normal = (dvec){0, 0, 0};
    if (!epa_start(&e, x)) {
        return 0;
    }
    epa_face best = e.face[epa_nearest(&e, -INFINITY)];
    for (;;) {
        int near = epa_nearest(&e, best.distance - EPA_TOLERANCE);
        if (near < 0 || !(e.face[near].distance < INFINITY)) {
            break;
        }
        best = e.face[near];
        if (e.count == EPA_MAX_VERTICES) {
            break;
        }
        support s = difference(a, b, best.normal);
        double gain = d_dot(s.w, best.normal) - best.distance;
        double size = best.distance > 0 ? best.distance : -best.distance;
        if (gain <= EPA_TOLERANCE + 1e-6 * size) {
            break;
        }
        e.s[e.count++] = s;
        if (!epa_insert(&e, e.count - 1)) {
            break;
        }
    }
    double w[3];
    const support *p = &e.s[best.v[0]], *q = &e.s[best.v[1]], *r = &e.s[best.v[2]];
    d_closest_triangle((dvec){0, 0, 0}, p->w, q->w, r->w, w);
    *wa = d_mad(d_mad(d_scale(p->a, w[0]), q->a, w[1]), r->a, w[2]);
    *wb = d_mad(d_mad(d_scale(p->b, w[0]), q->b, w[1]), r->b, w[2]);
    *normal = best.normal;
    return best.distance > 0 ? best.distance : 0;
}

static double core_radius(const phys_geom_convex *c) {
    return c->half_height > 0 ? 0 : (double)c->radius;
}

// Normal when two cores touch in a point or cross without volume: across both centres, or up.
static dvec fallback_normal(const core_set *a, const core_set *b) {
    return d_normalize(d_sub(b->at, a->at), (dvec){0, 1, 0});
}

phys_geom_gjk_result phys_geom_gjk(const phys_geom_convex *a, const phys_geom_convex *b) {
    dvec base = d_of(a->position);
    core_set sa = {a, {0, 0, 0}}, sb = {b, d_sub(d_of(b->position), base)};
    gjk_state g = run_gjk(&sa, &sb);
    double ra = core_radius(a), rb = core_radius(b), depth;
    dvec n, wa, wb;
    phys_geom_gjk_result out = {.iterations = g.iterations};
    if (g.overlap) {
        // B - A holds the origin: leaving it along -n by the depth parts the cores.
        depth = run_epa(&sa, &sb, &g.x, &n, &wa, &wb) + ra + rb;
        n = d_dot(n, n) > 0 ? d_scale(n, -1) : fallback_normal(&sa, &sb);
    } else {
        witness(&g.x, &wa, &wb);
        double gap = d_length(g.v);
        n = d_scale(g.v, 1 / gap);
        depth = ra + rb - gap;
    }
    dvec pa = d_add(base, d_mad(wa, n, ra)), pb = d_add(base, d_mad(wb, n, -rb));
    if (depth < 0) {
        out.closest = (phys_geom_closest){d_to(pa), d_to(pb), (float)-depth};
    } else {
        out.overlap =
            (phys_geom_overlap){true, d_to(d_scale(d_add(pa, pb), 0.5)), d_to(n), (float)depth};
    }
    return out;
}

// ---- what follows from GJK ----

static phys_geom_convex loose(const core_vec3 *points, uint32_t count) {
    return (phys_geom_convex){.point = points, .count = count, .rotation = {0, 0, 0, 1}};
}

core_vec3 phys_geom_closest_point_convex(core_vec3 p, const core_vec3 *points, uint32_t count) {
    phys_geom_convex a = loose(&p, 1), b = loose(points, count);
    phys_geom_gjk_result r = phys_geom_gjk(&a, &b);
    return r.overlap.hit || !count ? p : r.closest.b;
}

bool phys_geom_point_in_convex(core_vec3 p, const core_vec3 *points, uint32_t count,
                               float tolerance) {
    phys_geom_convex a = loose(&p, 1), b = loose(points, count);
    phys_geom_gjk_result r = phys_geom_gjk(&a, &b);
    return count && (r.overlap.hit || r.closest.distance <= tolerance);
}

// An infinite line is a segment that reaches beyond the set on both sides.
phys_geom_closest phys_geom_closest_points_line_convex(core_vec3 a, core_vec3 b, bool segment,
                                                       const core_vec3 *points, uint32_t count) {
    core_vec3 ends[2] = {a, b};
    if (!segment && count) {
        dvec u = d_normalize(d_sub(d_of(b), d_of(a)), (dvec){0, 0, 0});
        double lo = 0, hi = 0;
        for (uint32_t i = 0; i < count; i++) {
            double along = d_dot(d_sub(d_of(points[i]), d_of(a)), u);
            lo = i && lo < along ? lo : along;
            hi = i && hi > along ? hi : along;
        }
        ends[0] = d_to(d_mad(d_of(a), u, lo));
        ends[1] = d_to(d_mad(d_of(a), u, hi));
    }
    phys_geom_convex s = loose(ends, 2), c = loose(points, count);
    phys_geom_gjk_result r = phys_geom_gjk(&s, &c);
    if (r.overlap.hit) {
        return (phys_geom_closest){r.overlap.point, r.overlap.point, 0};
    }
    return r.closest;
}

// Advances the ray's point by the separating planes that GJK finds until it touches the set.
phys_geom_ray_hit phys_geom_ray_convex(core_vec3 o, core_vec3 d, float t_max,
                                       const core_vec3 *points, uint32_t count) {
    dvec dd = d_of(d), start = d_of(o), normal = {0, 0, 0};
    if (!count || !(d_dot(dd, dd) > 0) || !(t_max >= 0)) {
        return phys_geom_ray_miss();
    }
    core_vec3 zero = {0, 0, 0};
    phys_geom_convex p = loose(&zero, 1), c = loose(points, count);
    double t = 0;
    for (int i = 0; i < 64; i++) {
        core_set sa = {&p, d_mad(start, dd, t)}, sb = {&c, {0, 0, 0}};
        gjk_state g = run_gjk(&sa, &sb);
        double gap = g.overlap ? 0 : d_length(g.v);
        if (gap <= 1e-7) {
            break;
        }
        normal = d_scale(g.v, -1 / gap); // from the set to the point
        double closing = -d_dot(normal, dd);
        if (!(closing > 0)) {
            return phys_geom_ray_miss();
        }
        t += gap / closing;
        if (t > (double)t_max) {
            return phys_geom_ray_miss();
        }
    }
    normal = d_normalize(normal, d_normalize(d_scale(dd, -1), (dvec){0, 1, 0}));
    return (phys_geom_ray_hit){true, d_to(d_mad(start, dd, t)), d_to(normal), (float)t};
}
