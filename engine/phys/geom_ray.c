// Ray casts against triangles, spheres, boxes, capsules, cylinders, tetrahedra.
#include "phys/geom.h"
#include "phys/geom_d.h"

phys_geom_ray_hit phys_geom_ray_miss(void) {
    return (phys_geom_ray_hit){false, {0, 0, 0}, {0, 0, 0}, 0};
}

typedef struct ray {
    dvec o, d;
    double t_max;
} ray;

static bool ray_of(core_vec3 o, core_vec3 d, float t_max, ray *r) {
    *r = (ray){d_of(o), d_of(d), (double)t_max};
    return d_dot(r->d, r->d) > 0 && t_max >= 0;
}

static phys_geom_ray_hit hit_at(const ray *r, double t, dvec normal) {
    dvec back = d_scale(r->d, -1);
    return (phys_geom_ray_hit){true, d_to(d_mad(r->o, r->d, t)),
                               d_to(d_normalize(normal, d_normalize(back, (dvec){0, 1, 0}))),
                               (float)t};
}

static phys_geom_ray_hit hit_inside(const ray *r) { return hit_at(r, 0, d_scale(r->d, -1)); }

// Moeller and Trumbore 1997.
phys_geom_ray_hit phys_geom_ray_triangle(core_vec3 o, core_vec3 d, float t_max,
                                         const core_vec3 tri[3]) {
    ray r;
    if (!ray_of(o, d, t_max, &r)) {
        return phys_geom_ray_miss();
    }
    dvec a = d_of(tri[0]), e1 = d_sub(d_of(tri[1]), a), e2 = d_sub(d_of(tri[2]), a);
    dvec p = d_cross(r.d, e2);
    double det = d_dot(e1, p);
    double scale = d_length(e1) * d_length(e2) * d_length(r.d);
    if (!(det > 1e-14 * scale || det < -1e-14 * scale)) {
        return phys_geom_ray_miss(); // parallel or degenerate
    }
    dvec s = d_sub(r.o, a), q = d_cross(s, e1);
    double u = d_dot(s, p) / det, v = d_dot(r.d, q) / det, t = d_dot(e2, q) / det;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= r.t_max)) {
        return phys_geom_ray_miss();
    }
    dvec n = d_cross(e1, e2);
    return hit_at(&r, t, d_dot(n, r.d) > 0 ? d_scale(n, -1) : n);
}

// First parameter at which o + t*d enters the sphere; negative when the origin is inside, NaN-free.
static bool enter_sphere(dvec o, dvec d, dvec center, double radius, double *t) {
    dvec m = d_sub(o, center);
    double a = d_dot(d, d), b = d_dot(m, d), c = d_dot(m, m) - radius * radius;
    // Distance of the line from the centre, taken at the closest point: no cancellation far away.
    dvec near = d_mad(m, d, -b / a);
    double disc = radius * radius - d_dot(near, near);
    if (disc < 0) {
        return false;
    }
    double reach = __builtin_sqrt(disc / a);
    *t = c <= 0 ? -1 : -b / a - reach;
    return c <= 0 || *t >= 0;
}

phys_geom_ray_hit phys_geom_ray_sphere(core_vec3 o, core_vec3 d, float t_max, core_vec3 center,
                                       float radius) {
    ray r;
    double t;
    dvec c = d_of(center);
    if (!ray_of(o, d, t_max, &r) || !enter_sphere(r.o, r.d, c, (double)radius, &t) || t > r.t_max) {
        return phys_geom_ray_miss();
    }
    return t < 0 ? hit_inside(&r) : hit_at(&r, t, d_sub(d_mad(r.o, r.d, t), c));
}

// Slabs (Kay and Kajiya 1986) in the box's frame.
phys_geom_ray_hit phys_geom_ray_box(core_vec3 o, core_vec3 d, float t_max, core_vec3 half,
                                    core_vec3 position, core_quat q) {
    ray r;
    if (!ray_of(o, d, t_max, &r)) {
        return phys_geom_ray_miss();
    }
    dvec lo = d_unrotate(q, d_sub(r.o, d_of(position))), ld = d_unrotate(q, r.d);
    const double po[3] = {lo.x, lo.y, lo.z}, pd[3] = {ld.x, ld.y, ld.z};
    const double h[3] = {(double)half.x, (double)half.y, (double)half.z};
    double enter = -1, leave = r.t_max;
    int axis = -1;
    for (int i = 0; i < 3; i++) {
        if (!(pd[i] < 0 || pd[i] > 0)) {
            if (po[i] < -h[i] || po[i] > h[i]) {
                return phys_geom_ray_miss();
            }
            continue;
        }
        double t0 = (-h[i] - po[i]) / pd[i], t1 = (h[i] - po[i]) / pd[i];
        double in = CORE_MIN(t0, t1), out = CORE_MAX(t0, t1);
        if (in > enter) {
            enter = in, axis = i;
        }
        leave = CORE_MIN(leave, out);
    }
    if (enter > leave || leave < 0) {
        return phys_geom_ray_miss();
    }
    if (enter < 0) {
        return hit_inside(&r);
    }
    double sign = pd[axis] > 0 ? -1 : 1;
    dvec n = {axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0};
    return hit_at(&r, enter, d_rotate(q, n));
}

// Infinite cylinder about (a, axis): entry parameter and the hit's height along the axis (0..1).
static bool enter_tube(const ray *r, dvec a, dvec axis, double radius, double *t, double *height) {
    double aa = d_dot(axis, axis);
    dvec m = d_sub(r->o, a);
    dvec dp = d_mad(r->d, axis, -d_dot(r->d, axis) / aa);
    dvec mp = d_mad(m, axis, -d_dot(m, axis) / aa);
    double dd = d_dot(dp, dp), md = d_dot(mp, dp);
    if (!(dd > 1e-20 * d_dot(r->d, r->d))) {
        return false; // along the axis: only the ends can be hit
    }
    dvec near = d_mad(mp, dp, -md / dd);
    double disc = radius * radius - d_dot(near, near);
    if (disc < 0) {
        return false;
    }
    *t = -md / dd - __builtin_sqrt(disc / dd);
    *height = d_dot(d_mad(m, r->d, *t), axis) / aa;
    return true;
}

phys_geom_ray_hit phys_geom_ray_capsule(core_vec3 o, core_vec3 d, float t_max, core_vec3 a,
                                        core_vec3 b, float radius) {
    ray r;
    if (!ray_of(o, d, t_max, &r)) {
        return phys_geom_ray_miss();
    }
    dvec da = d_of(a), db = d_of(b), axis = d_sub(db, da);
    double rr = (double)radius, w = d_line_parameter(r.o, da, db, true);
    dvec off = d_sub(r.o, d_mad(da, axis, w));
    if (d_dot(off, off) <= rr * rr) {
        return hit_inside(&r);
    }
    double best = -1, t, height;
    dvec center = da;
    if (d_dot(axis, axis) > 0 && enter_tube(&r, da, axis, rr, &t, &height) && t >= 0 &&
        height >= 0 && height <= 1) {
        best = t, center = d_mad(da, axis, height);
    }
    for (int i = 0; i < 2; i++) {
        dvec end = i ? db : da;
        if (enter_sphere(r.o, r.d, end, rr, &t) && t >= 0 && (best < 0 || t < best)) {
            best = t, center = end;
        }
    }
    if (best < 0 || best > r.t_max) {
        return phys_geom_ray_miss();
    }
    return hit_at(&r, best, d_sub(d_mad(r.o, r.d, best), center));
}

phys_geom_ray_hit phys_geom_ray_cylinder(core_vec3 o, core_vec3 d, float t_max, float half_height,
                                         float radius, core_vec3 position, core_quat q) {
    ray r;
    if (!ray_of(o, d, t_max, &r)) {
        return phys_geom_ray_miss();
    }
    ray l = {d_unrotate(q, d_sub(r.o, d_of(position))), d_unrotate(q, r.d), r.t_max};
    double h = (double)half_height, rr = (double)radius, best = -1, t, height;
    if (l.o.y >= -h && l.o.y <= h && l.o.x * l.o.x + l.o.z * l.o.z <= rr * rr) {
        return hit_inside(&r);
    }
    dvec normal = {0, 1, 0};
    dvec base = {0, -h, 0}, axis = {0, 2 * h, 0};
    if (enter_tube(&l, base, axis, rr, &t, &height) && t >= 0 && height >= 0 && height <= 1) {
        dvec p = d_mad(l.o, l.d, t);
        best = t, normal = (dvec){p.x, 0, p.z};
    }
    for (int i = 0; i < 2; i++) { // the caps
        double y = i ? h : -h;
        t = l.d.y < 0 || l.d.y > 0 ? (y - l.o.y) / l.d.y : -1;
        dvec p = d_mad(l.o, l.d, t);
        if (t >= 0 && (best < 0 || t < best) && p.x * p.x + p.z * p.z <= rr * rr) {
            best = t, normal = (dvec){0, i ? 1 : -1, 0};
        }
    }
    if (best < 0 || best > r.t_max) {
        return phys_geom_ray_miss();
    }
    return hit_at(&r, best, d_rotate(q, normal));
}

phys_geom_ray_hit phys_geom_ray_tetrahedron(core_vec3 o, core_vec3 d, float t_max,
                                            const core_vec3 t[4]) {
    static const int face[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    ray r;
    if (!ray_of(o, d, t_max, &r)) {
        return phys_geom_ray_miss();
    }
    if (phys_geom_point_in_tetrahedron(o, t, 0)) {
        return hit_inside(&r);
    }
    phys_geom_ray_hit best = phys_geom_ray_miss();
    for (int i = 0; i < 4; i++) {
        const core_vec3 tri[3] = {t[face[i][0]], t[face[i][1]], t[face[i][2]]};
        phys_geom_ray_hit h = phys_geom_ray_triangle(o, d, t_max, tri);
        if (h.hit && (!best.hit || h.t < best.t)) {
            best = h;
        }
    }
    return best;
}
