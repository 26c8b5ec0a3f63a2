// Double-precision vectors for the inside of the geometry functions.
#ifndef PHYS_GEOM_D_H
#define PHYS_GEOM_D_H

#include "core/math.h"

typedef struct dvec {
    double x, y, z;
} dvec;

static inline dvec d_of(core_vec3 v) { return (dvec){(double)v.x, (double)v.y, (double)v.z}; }
static inline core_vec3 d_to(dvec v) { return (core_vec3){(float)v.x, (float)v.y, (float)v.z}; }
static inline dvec d_add(dvec a, dvec b) { return (dvec){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline dvec d_sub(dvec a, dvec b) { return (dvec){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline dvec d_scale(dvec a, double s) { return (dvec){a.x * s, a.y * s, a.z * s}; }
static inline dvec d_mad(dvec a, dvec b, double s) {
    return (dvec){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static inline double d_dot(dvec a, dvec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline dvec d_cross(dvec a, dvec b) {
    return (dvec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double d_length(dvec a) { return __builtin_sqrt(d_dot(a, a)); }
static inline dvec d_normalize(dvec a, dvec fallback) {
    double n = d_length(a);
    return n > 0 && n <= 1e300 ? d_scale(a, 1 / n) : fallback;
}
static inline dvec d_rotate(core_quat q, dvec v) {
    dvec u = {(double)q.x, (double)q.y, (double)q.z};
    dvec t = d_scale(d_cross(u, v), 2);
    return d_add(d_mad(v, t, (double)q.w), d_cross(u, t));
}
static inline dvec d_unrotate(core_quat q, dvec v) {
    return d_rotate((core_quat){-q.x, -q.y, -q.z, q.w}, v);
}

// Closest points on simplices, shared by the public functions and GJK: barycentric weights of the
// point nearest to the origin (or to p) in `w`, result as the point itself.
double d_line_parameter(dvec p, dvec a, dvec b, bool segment);
dvec d_closest_triangle(dvec p, dvec a, dvec b, dvec c, double w[3]);

#endif
