// Inline vector helpers of the scalar physics code. Interfaces use core's types; these exist so
// that the compiler sees through rotations in loops.
#ifndef PHYS_VEC_H
#define PHYS_VEC_H

#include "core/math.h"

typedef struct phys_mat3 { // rows
    core_vec3 x, y, z;
} phys_mat3;

static inline core_vec3 phys_rotate(core_quat q, core_vec3 v) {
    core_vec3 u = {q.x, q.y, q.z};
    core_vec3 t = core_v3_scale(core_v3_cross(u, v), 2.0f);
    return core_v3_add(core_v3_mad(v, t, q.w), core_v3_cross(u, t));
}
static inline core_quat phys_conj(core_quat q) { return (core_quat){-q.x, -q.y, -q.z, q.w}; }
static inline core_vec3 phys_unrotate(core_quat q, core_vec3 v) {
    return phys_rotate(phys_conj(q), v);
}
static inline core_quat phys_quat_mul(core_quat a, core_quat b) { // rotate by b, then a
    return (core_quat){a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                       a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                       a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
                       a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
static inline core_quat phys_quat_unit(core_quat q) {
    float n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    float s = 1.0f / core_sqrtf(n);
    return (core_quat){q.x * s, q.y * s, q.z * s, q.w * s};
}
// Body to world: columns are the body's axes.
static inline phys_mat3 phys_quat_mat(core_quat q) {
    float x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
    float xx = q.x * x2, xy = q.x * y2, xz = q.x * z2, yy = q.y * y2, yz = q.y * z2;
    float zz = q.z * z2, wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
    return (phys_mat3){{1.0f - (yy + zz), xy - wz, xz + wy},
                       {xy + wz, 1.0f - (xx + zz), yz - wx},
                       {xz - wy, yz + wx, 1.0f - (xx + yy)}};
}
static inline core_vec3 phys_mat_mul(const phys_mat3 *m, core_vec3 v) {
    return core_v3(core_v3_dot(m->x, v), core_v3_dot(m->y, v), core_v3_dot(m->z, v));
}
static inline core_vec3 phys_mat_tmul(const phys_mat3 *m, core_vec3 v) { // transpose times v
    return core_v3(m->x.x * v.x + m->y.x * v.y + m->z.x * v.z,
                   m->x.y * v.x + m->y.y * v.y + m->z.y * v.z,
                   m->x.z * v.x + m->y.z * v.y + m->z.z * v.z);
}
static inline core_vec3 phys_mat_col(const phys_mat3 *m, int i) {
    return i == 0   ? core_v3(m->x.x, m->y.x, m->z.x)
           : i == 1 ? core_v3(m->x.y, m->y.y, m->z.y)
                    : core_v3(m->x.z, m->y.z, m->z.z);
}
static inline core_vec3 phys_abs3(core_vec3 v) {
    return core_v3(core_absf(v.x), core_absf(v.y), core_absf(v.z));
}
static inline float phys_comp(core_vec3 v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }
static inline bool phys_finite(float x) { return x - x == 0.0f; }
static inline bool phys_finite3(core_vec3 v) {
    return phys_finite(v.x) && phys_finite(v.y) && phys_finite(v.z);
}
static inline core_vec3 phys_unit(core_vec3 v, core_vec3 fallback) {
    float l2 = core_v3_dot(v, v);
    return l2 > 1e-20f ? core_v3_scale(v, 1.0f / core_sqrtf(l2)) : fallback;
}
// Two unit tangents of a unit normal, continuous but for n.z = 0 (Duff et al., "Building an
// orthonormal basis, revisited", JCGT 2017).
static inline void phys_basis(core_vec3 n, core_vec3 *t1, core_vec3 *t2) {
    float s = n.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / (s + n.z), b = n.x * n.y * a;
    *t1 = core_v3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    *t2 = core_v3(b, s + n.y * n.y * a, -n.y);
}

#endif
