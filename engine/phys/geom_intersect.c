// The table of intersections: analytic for spheres, capsules and boxes, separating axes for hulls,
// GJK and EPA for the rest.
#include "phys/geom.h"
#include "phys/geom_d.h"

phys_geom_overlap phys_geom_overlap_miss(void) {
    return (phys_geom_overlap){false, {0, 0, 0}, {0, 1, 0}, 0};
}

static phys_geom_overlap flipped(phys_geom_overlap o) {
    o.normal = core_v3_scale(o.normal, -1);
    return o;
}

phys_geom_overlap phys_geom_intersect_aabb_aabb(core_aabb a, core_aabb b) {
    const float alo[3] = {a.min.x, a.min.y, a.min.z}, ahi[3] = {a.max.x, a.max.y, a.max.z};
    const float blo[3] = {b.min.x, b.min.y, b.min.z}, bhi[3] = {b.max.x, b.max.y, b.max.z};
    float best = 0, sign = 1, mid[3];
    int axis = -1;
    for (int i = 0; i < 3; i++) {
        float forward = ahi[i] - blo[i], back = bhi[i] - alo[i];
        float depth = CORE_MIN(forward, back);
        if (!(depth >= 0)) {
            return phys_geom_overlap_miss();
        }
        if (axis < 0 || depth < best) {
            best = depth, axis = i, sign = forward <= back ? 1.0f : -1.0f;
        }
        mid[i] = 0.5f * (CORE_MAX(alo[i], blo[i]) + CORE_MIN(ahi[i], bhi[i]));
    }
    core_vec3 n = {axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0};
    return (phys_geom_overlap){true, core_v3(mid[0], mid[1], mid[2]), n, best};
}

// Two points at distance d apart with radii: the base of every sphere and capsule pair.
static phys_geom_overlap rounded(dvec a, double ra, dvec b, double rb) {
    dvec d = d_sub(b, a);
    double gap = d_length(d), depth = ra + rb - gap;
    if (!(depth >= 0)) {
        return phys_geom_overlap_miss();
    }
    dvec n = d_normalize(d, (dvec){0, 1, 0});
    dvec point = d_mad(a, n, ra - depth / 2);
    return (phys_geom_overlap){true, d_to(point), d_to(n), (float)depth};
}

phys_geom_overlap phys_geom_intersect_point_sphere(core_vec3 p, core_vec3 center, float radius) {
    return rounded(d_of(p), 0, d_of(center), (double)radius);
}

phys_geom_overlap phys_geom_intersect_sphere_sphere(core_vec3 pa, float ra, core_vec3 pb,
                                                    float rb) {
    return rounded(d_of(pa), (double)ra, d_of(pb), (double)rb);
}

phys_geom_overlap phys_geom_intersect_sphere_capsule(core_vec3 p, float r, core_vec3 a, core_vec3 b,
                                                     float radius) {
    dvec da = d_of(a), db = d_of(b), dp = d_of(p);
    dvec q = d_mad(da, d_sub(db, da), d_line_parameter(dp, da, db, true));
    return rounded(dp, (double)r, q, (double)radius);
}

phys_geom_overlap phys_geom_intersect_capsule_capsule(core_vec3 a0, core_vec3 a1, float ra,
                                                      core_vec3 b0, core_vec3 b1, float rb) {
    phys_geom_closest c = phys_geom_closest_points_lines(a0, a1, true, b0, b1, true);
    if (c.distance > 1e-6f * (ra + rb)) {
        return rounded(d_of(c.a), (double)ra, d_of(c.b), (double)rb);
    }
    // The segments cross: leave across both of them.
    dvec n = d_cross(d_sub(d_of(a1), d_of(a0)), d_sub(d_of(b1), d_of(b0)));
    dvec across = d_of(phys_geom_orthogonal(core_v3_sub(a1, a0)));
    return (phys_geom_overlap){true, c.a, d_to(d_normalize(n, across)), ra + rb};
}

phys_geom_overlap phys_geom_intersect_box_sphere(core_vec3 half, core_vec3 p, core_quat q,
                                                 core_vec3 center, float radius) {
    dvec c = d_unrotate(q, d_sub(d_of(center), d_of(p)));
    const double h[3] = {(double)half.x, (double)half.y, (double)half.z};
    const double v[3] = {c.x, c.y, c.z};
    double near[3], inside = 0, out2 = 0;
    int axis = -1;
    for (int i = 0; i < 3; i++) {
        near[i] = CORE_CLAMP(v[i], -h[i], h[i]);
        out2 += (v[i] - near[i]) * (v[i] - near[i]);
        double depth = h[i] - (v[i] < 0 ? -v[i] : v[i]);
        if (axis < 0 || depth < inside) {
            inside = depth, axis = i;
        }
    }
    dvec n, on;
    double depth;
    if (out2 > 0) {
        dvec gap = {v[0] - near[0], v[1] - near[1], v[2] - near[2]};
        depth = (double)radius - d_length(gap);
        n = d_normalize(gap, (dvec){0, 1, 0});
        on = (dvec){near[0], near[1], near[2]};
    } else { // the centre is inside: leave by the nearest face
        double sign = v[axis] < 0 ? -1 : 1;
        n = (dvec){axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0};
        depth = (double)radius + inside;
        on = d_mad(c, n, inside);
    }
    if (!(depth >= 0)) {
        return phys_geom_overlap_miss();
    }
    dvec point = d_mad(on, n, -depth / 2);
    return (phys_geom_overlap){true, d_to(d_add(d_of(p), d_rotate(q, point))), d_to(d_rotate(q, n)),
                               (float)depth};
}

static phys_geom_overlap by_gjk(const phys_geom_convex *a, const phys_geom_convex *b) {
    phys_geom_gjk_result r = phys_geom_gjk(a, b);
    return r.overlap.hit ? r.overlap : phys_geom_overlap_miss();
}

phys_geom_overlap phys_geom_intersect_sphere_convex(core_vec3 p, float r,
                                                    const phys_geom_convex *convex) {
    const core_vec3 zero = {0, 0, 0};
    phys_geom_convex s = {&zero, 1, r, 0, p, {0, 0, 0, 1}};
    return by_gjk(&s, convex);
}

phys_geom_overlap phys_geom_intersect_capsule_convex(core_vec3 a, core_vec3 b, float radius,
                                                     const phys_geom_convex *convex) {
    const core_vec3 ends[2] = {{0, 0, 0}, core_v3_sub(b, a)};
    phys_geom_convex s = {ends, 2, radius, 0, a, {0, 0, 0, 1}};
    return by_gjk(&s, convex);
}

phys_geom_overlap phys_geom_intersect_box_capsule(core_vec3 half, core_vec3 p, core_quat q,
                                                  core_vec3 a, core_vec3 b, float radius) {
    core_vec3 corner[8];
    phys_geom_box_vertices(half, corner);
    phys_geom_convex box = {corner, 8, 0, 0, p, q};
    return flipped(phys_geom_intersect_capsule_convex(a, b, radius, &box));
}

phys_geom_overlap phys_geom_intersect_convex_convex(const phys_geom_convex *a,
                                                    const phys_geom_convex *b) {
    return by_gjk(a, b);
}

// ---- separating axes ----

typedef struct axis_test {
    bool apart;
    double depth;
    dvec normal;
} axis_test;

// Overlap of the projections on `axis` (any length): the smaller way out decides depth and side.
static void test_axis(axis_test *t, dvec axis, double ra_lo, double ra_hi, double rb_lo,
                      double rb_hi, double favour) {
    double n = d_length(axis);
    if (t->apart || !(n > 0)) {
        return;
    }
    double forward = (ra_hi - rb_lo) / n, back = (rb_hi - ra_lo) / n;
    double depth = CORE_MIN(forward, back);
    if (depth < 0) {
        t->apart = true;
    } else if (depth + favour < t->depth) {
        t->depth = depth;
        t->normal = d_scale(axis, (forward <= back ? 1 : -1) / n);
    }
}

static void project(const core_vec3 *points, uint32_t count, dvec at, core_quat q, dvec axis,
                    double *lo, double *hi) {
    dvec l = d_unrotate(q, axis);
    *lo = *hi = count ? d_dot(d_of(points[0]), l) : 0;
    for (uint32_t i = 1; i < count; i++) {
        double x = d_dot(d_of(points[i]), l);
        *lo = x < *lo ? x : *lo;
        *hi = x > *hi ? x : *hi;
    }
    double base = d_dot(at, axis);
    *lo += base, *hi += base;
}

typedef struct posed {
    const core_vec3 *point;
    uint32_t count;
    dvec at;
    core_quat q;
} posed;

static void test_posed(axis_test *t, const posed *a, const posed *b, dvec axis, double favour) {
    double alo, ahi, blo, bhi;
    project(a->point, a->count, a->at, a->q, axis, &alo, &ahi);
    project(b->point, b->count, b->at, b->q, axis, &blo, &bhi);
    test_axis(t, axis, alo, ahi, blo, bhi, favour);
}

// The middle of the overlap: EPA's witnesses, which agree with SAT on depth and side.
static dvec contact_point(const posed *a, const posed *b) {
    phys_geom_convex ca = {a->point, a->count, 0, 0, d_to(a->at), a->q};
    phys_geom_convex cb = {b->point, b->count, 0, 0, d_to(b->at), b->q};
    phys_geom_gjk_result r = phys_geom_gjk(&ca, &cb);
    dvec apart = d_scale(d_add(d_of(r.closest.a), d_of(r.closest.b)), 0.5);
    return r.overlap.hit ? d_of(r.overlap.point) : apart;
}

static phys_geom_overlap sat_result(const axis_test *t, const posed *a, const posed *b, dvec base) {
    if (t->apart) {
        return phys_geom_overlap_miss();
    }
    return (phys_geom_overlap){true, d_to(d_add(base, contact_point(a, b))), d_to(t->normal),
                               (float)t->depth};
}

// Face axes are preferred over edge axes by a hair: a face gives a manifold, an edge one point.
#define EDGE_FAVOUR 1e-9

phys_geom_overlap phys_geom_intersect_box_box(core_vec3 half_a, core_vec3 pa, core_quat qa,
                                              core_vec3 half_b, core_vec3 pb, core_quat qb) {
    core_vec3 ca[8], cb[8];
    phys_geom_box_vertices(half_a, ca);
    phys_geom_box_vertices(half_b, cb);
    posed a = {ca, 8, {0, 0, 0}, qa}, b = {cb, 8, d_sub(d_of(pb), d_of(pa)), qb};
    dvec ax[3], bx[3];
    axis_test t = {false, 1e300, {0, 1, 0}};
    for (int i = 0; i < 3; i++) {
        dvec unit = {i == 0, i == 1, i == 2};
        ax[i] = d_rotate(qa, unit), bx[i] = d_rotate(qb, unit);
        test_posed(&t, &a, &b, ax[i], 0);
        test_posed(&t, &a, &b, bx[i], 0);
    }
    for (int i = 0; i < 9; i++) {
        dvec axis = d_cross(ax[i / 3], bx[i % 3]);
        if (d_dot(axis, axis) > 1e-8) { // parallel edges add nothing
            test_posed(&t, &a, &b, axis, EDGE_FAVOUR);
        }
    }
    return sat_result(&t, &a, &b, d_of(pa));
}

static dvec hull_edge(const phys_geom_hull *h, core_quat q, uint32_t f, uint32_t i, bool *first) {
    uint32_t begin = h->face_begin[f], n = h->face_begin[f + 1] - begin;
    uint32_t from = h->loop[begin + i], to = h->loop[begin + (i + 1) % n];
    *first = from < to; // each edge stands in two loops, once each way
    return d_rotate(q, d_sub(d_of(h->vertex[to]), d_of(h->vertex[from])));
}

static void test_edges(axis_test *t, const posed *a, const phys_geom_hull *hb, const posed *b,
                       dvec edge_a) {
    for (uint32_t f = 0; f < hb->face_count && !t->apart; f++) {
        uint32_t n = hb->face_begin[f + 1] - hb->face_begin[f];
        for (uint32_t i = 0; i < n && !t->apart; i++) {
            bool first;
            dvec edge_b = hull_edge(hb, b->q, f, i, &first);
            dvec axis = d_cross(edge_a, edge_b);
            double scale = d_dot(edge_a, edge_a) * d_dot(edge_b, edge_b);
            if (first && d_dot(axis, axis) > 1e-8 * scale) {
                test_posed(t, a, b, axis, EDGE_FAVOUR);
            }
        }
    }
}

phys_geom_overlap phys_geom_sat(const phys_geom_hull *ha, core_vec3 pa, core_quat qa,
                                const phys_geom_hull *hb, core_vec3 pb, core_quat qb) {
    posed a = {ha->vertex, ha->vertex_count, {0, 0, 0}, qa};
    posed b = {hb->vertex, hb->vertex_count, d_sub(d_of(pb), d_of(pa)), qb};
    axis_test t = {false, 1e300, {0, 1, 0}};
    for (uint32_t f = 0; f < ha->face_count && !t.apart; f++) {
        test_posed(&t, &a, &b, d_rotate(qa, d_of(ha->normal[f])), 0);
    }
    for (uint32_t f = 0; f < hb->face_count && !t.apart; f++) {
        test_posed(&t, &a, &b, d_rotate(qb, d_of(hb->normal[f])), 0);
    }
    for (uint32_t f = 0; f < ha->face_count && !t.apart; f++) {
        uint32_t n = ha->face_begin[f + 1] - ha->face_begin[f];
        for (uint32_t i = 0; i < n && !t.apart; i++) {
            bool first;
            dvec edge = hull_edge(ha, qa, f, i, &first);
            if (first) {
                test_edges(&t, &a, hb, &b, edge);
            }
        }
    }
    return sat_result(&t, &a, &b, d_of(pa));
}
