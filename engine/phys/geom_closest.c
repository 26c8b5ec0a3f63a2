// Closest points on lines, triangles, polygons, planes and tetrahedra.
#include "phys/geom.h"
#include "phys/geom_d.h"

double d_line_parameter(dvec p, dvec a, dvec b, bool segment) {
    dvec ab = d_sub(b, a);
    double n = d_dot(ab, ab);
    if (!(n > 0)) {
        return 0;
    }
    double t = d_dot(d_sub(p, a), ab) / n;
    return segment ? CORE_CLAMP(t, 0.0, 1.0) : t;
}

core_vec3 phys_geom_closest_point_line(core_vec3 p, core_vec3 a, core_vec3 b, bool segment) {
    dvec da = d_of(a), db = d_of(b);
    return d_to(d_mad(da, d_sub(db, da), d_line_parameter(d_of(p), da, db, segment)));
}

// Minimises |a0 + s*u - b0 - t*v| over the rectangle of allowed (s, t): free minimum first, then
// clamp one parameter, re-project the other, clamp it and re-project the first.
static void line_parameters(dvec a0, dvec u, bool a_segment, dvec b0, dvec v, bool b_segment,
                            double *s, double *t) {
    dvec r = d_sub(a0, b0);
    double a = d_dot(u, u), e = d_dot(v, v), b = d_dot(u, v), c = d_dot(u, r), f = d_dot(v, r);
    double det = a * e - b * b;
    *s = det > 1e-14 * a * e ? (b * f - c * e) / det : 0;
    *s = e > 0 ? *s : (a > 0 ? -c / a : 0); // b is a point: project it
    *s = a_segment ? CORE_CLAMP(*s, 0.0, 1.0) : *s;
    *t = e > 0 ? (b * *s + f) / e : 0;
    if (b_segment && (*t < 0 || *t > 1)) {
        *t = CORE_CLAMP(*t, 0.0, 1.0);
        *s = a > 0 ? (b * *t - c) / a : 0;
        *s = a_segment ? CORE_CLAMP(*s, 0.0, 1.0) : *s;
    }
}

static phys_geom_closest closest_pair(dvec a, dvec b) {
    return (phys_geom_closest){d_to(a), d_to(b), (float)d_length(d_sub(b, a))};
}

phys_geom_closest phys_geom_closest_points_lines(core_vec3 a0, core_vec3 a1, bool a_segment,
                                                 core_vec3 b0, core_vec3 b1, bool b_segment) {
    dvec p = d_of(a0), q = d_of(b0), u = d_sub(d_of(a1), p), v = d_sub(d_of(b1), q);
    double s, t;
    line_parameters(p, u, a_segment, q, v, b_segment, &s, &t);
    return closest_pair(d_mad(p, u, s), d_mad(q, v, t));
}

// Ericson 5.1.5: Voronoi regions of vertices, edges, face.
dvec d_closest_triangle(dvec p, dvec a, dvec b, dvec c, double w[3]) {
    dvec ab = d_sub(b, a), ac = d_sub(c, a), ap = d_sub(p, a);
    double d1 = d_dot(ab, ap), d2 = d_dot(ac, ap);
    w[0] = w[1] = w[2] = 0;
    if (d1 <= 0 && d2 <= 0) {
        w[0] = 1;
        return a;
    }
    dvec bp = d_sub(p, b);
    double d3 = d_dot(ab, bp), d4 = d_dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) {
        w[1] = 1;
        return b;
    }
    double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) {
        w[1] = d1 / (d1 - d3);
        w[0] = 1 - w[1];
        return d_mad(a, ab, w[1]);
    }
    dvec cp = d_sub(p, c);
    double d5 = d_dot(ab, cp), d6 = d_dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) {
        w[2] = 1;
        return c;
    }
    double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) {
        w[2] = d2 / (d2 - d6);
        w[0] = 1 - w[2];
        return d_mad(a, ac, w[2]);
    }
    double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0) {
        w[2] = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        w[1] = 1 - w[2];
        return d_mad(b, d_sub(c, b), w[2]);
    }
    double sum = va + vb + vc;
    if (!(sum > 0)) { // no area and no edge chosen: all points coincide
        w[0] = 1;
        return a;
    }
    w[1] = vb / sum;
    w[2] = vc / sum;
    w[0] = 1 - w[1] - w[2];
    return d_mad(d_mad(a, ab, w[1]), ac, w[2]);
}

core_vec3 phys_geom_closest_point_triangle(core_vec3 p, core_vec3 a, core_vec3 b, core_vec3 c) {
    double w[3];
    return d_to(d_closest_triangle(d_of(p), d_of(a), d_of(b), d_of(c), w));
}

// Where the line a + s*u crosses the triangle's plane inside the triangle; false when it does not.
static bool line_through_triangle(dvec a, dvec u, bool segment, const dvec t[3], dvec *at) {
    dvec n = d_cross(d_sub(t[1], t[0]), d_sub(t[2], t[0]));
    double down = d_dot(n, u);
    if (!(down < 0 || down > 0)) {
        return false;
    }
    double s = d_dot(n, d_sub(t[0], a)) / down;
    if (segment && !(s >= 0 && s <= 1)) {
        return false;
    }
    *at = d_mad(a, u, s);
    for (int i = 0; i < 3; i++) {
        dvec edge = d_sub(t[(i + 1) % 3], t[i]);
        if (d_dot(d_cross(edge, d_sub(*at, t[i])), n) < 0) {
            return false;
        }
    }
    return true;
}

phys_geom_closest phys_geom_closest_points_line_triangle(core_vec3 a, core_vec3 b, bool segment,
                                                         const core_vec3 t[3]) {
    dvec p = d_of(a), u = d_sub(d_of(b), p), tri[3] = {d_of(t[0]), d_of(t[1]), d_of(t[2])};
    dvec at;
    if (line_through_triangle(p, u, segment, tri, &at)) {
        return closest_pair(at, at);
    }
    dvec best_a = p, best_b = tri[0];
    double best = -1;
    for (int i = 0; i < 3; i++) { // against the edges
        dvec e = d_sub(tri[(i + 1) % 3], tri[i]);
        double s, r;
        line_parameters(p, u, segment, tri[i], e, true, &s, &r);
        dvec qa = d_mad(p, u, s), qb = d_mad(tri[i], e, r), gap = d_sub(qb, qa);
        if (best < 0 || d_dot(gap, gap) < best) {
            best = d_dot(gap, gap), best_a = qa, best_b = qb;
        }
    }
    for (int i = 0; segment && i < 2; i++) { // the segment's ends against the face
        dvec end = i ? d_add(p, u) : p;
        double w[3];
        dvec q = d_closest_triangle(end, tri[0], tri[1], tri[2], w), gap = d_sub(q, end);
        if (d_dot(gap, gap) < best) {
            best = d_dot(gap, gap), best_a = end, best_b = q;
        }
    }
    return closest_pair(best_a, best_b);
}

core_vec3 phys_geom_closest_point_polygon(core_vec3 p, const core_vec3 *polygon, uint32_t count) {
    if (count < 3) {
        return count == 2 ? phys_geom_closest_point_line(p, polygon[0], polygon[1], true)
                          : (count ? polygon[0] : p);
    }
    dvec dp = d_of(p), best_point = {0, 0, 0};
    double best = -1;
    for (uint32_t i = 1; i + 1 < count; i++) { // a convex polygon is the union of its fan
        double w[3];
        dvec q =
            d_closest_triangle(dp, d_of(polygon[0]), d_of(polygon[i]), d_of(polygon[i + 1]), w);
        dvec gap = d_sub(q, dp);
        if (best < 0 || d_dot(gap, gap) < best) {
            best = d_dot(gap, gap), best_point = q;
        }
    }
    return d_to(best_point);
}

core_vec3 phys_geom_closest_point_plane(core_vec3 p, core_vec3 normal, float offset) {
    dvec n = d_of(normal), dp = d_of(p);
    return d_to(d_mad(dp, n, (double)offset - d_dot(n, dp)));
}

static const int TETRA_FACE[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};

static bool outside_face(dvec p, const dvec t[4], const int f[4]) {
    dvec n = d_cross(d_sub(t[f[1]], t[f[0]]), d_sub(t[f[2]], t[f[0]]));
    double inner = d_dot(n, d_sub(t[f[3]], t[f[0]]));
    double side = d_dot(n, d_sub(p, t[f[0]]));
    return inner > 0 ? side < 0 : (inner < 0 ? side > 0 : true);
}

static dvec closest_tetrahedron(dvec p, const dvec t[4]) {
    dvec best_point = p;
    double best = -1;
    for (int i = 0; i < 4; i++) {
        const int *f = TETRA_FACE[i];
        if (!outside_face(p, t, f)) {
            continue;
        }
        double w[3];
        dvec q = d_closest_triangle(p, t[f[0]], t[f[1]], t[f[2]], w), gap = d_sub(q, p);
        if (best < 0 || d_dot(gap, gap) < best) {
            best = d_dot(gap, gap), best_point = q;
        }
    }
    return best_point;
}

static void load_tetrahedron(const core_vec3 t[4], dvec out[4]) {
    for (int i = 0; i < 4; i++) {
        out[i] = d_of(t[i]);
    }
}

core_vec3 phys_geom_closest_point_tetrahedron(core_vec3 p, const core_vec3 t[4]) {
    dvec d[4];
    load_tetrahedron(t, d);
    return d_to(closest_tetrahedron(d_of(p), d));
}

bool phys_geom_point_in_tetrahedron(core_vec3 p, const core_vec3 t[4], float tolerance) {
    dvec d[4], dp = d_of(p);
    load_tetrahedron(t, d);
    return d_length(d_sub(closest_tetrahedron(dp, d), dp)) <= (double)tolerance;
}

phys_geom_closest phys_geom_closest_points_line_tetrahedron(core_vec3 a, core_vec3 b, bool segment,
                                                            const core_vec3 t[4]) {
    dvec d[4], da = d_of(a);
    load_tetrahedron(t, d);
    if (segment && d_length(d_sub(closest_tetrahedron(da, d), da)) <= 0) {
        return closest_pair(da, da); // starts inside: no face need be crossed
    }
    phys_geom_closest best = {{0, 0, 0}, {0, 0, 0}, -1};
    for (int i = 0; i < 4; i++) {
        const int *f = TETRA_FACE[i];
        const core_vec3 face[3] = {t[f[0]], t[f[1]], t[f[2]]};
        phys_geom_closest c = phys_geom_closest_points_line_triangle(a, b, segment, face);
        if (best.distance < 0 || c.distance < best.distance) {
            best = c;
        }
    }
    return best;
}
