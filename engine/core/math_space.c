// Vectors, rotations and matrices for interfaces: one value at a time. Hot kernels work on columns.
#include "core/math.h"

#include <float.h>

static bool finite_(float x) { return x - x == 0.0f; }

core_vec3 core_v3_normalize(core_vec3 a, core_vec3 fallback) {
    float ax = core_absf(a.x), ay = core_absf(a.y), az = core_absf(a.z);
    float size = CORE_MAX(ax, CORE_MAX(ay, az));
    if (!finite_(a.x) || !finite_(a.y) || !finite_(a.z) || size == 0.0f) {
        return fallback;
    }
    if (size < 1e-15f || size > 1e15f) { // squares would leave the range of float
        a.x /= size, a.y /= size, a.z /= size;
    }
    return core_v3_scale(a, 1.0f / core_v3_length(a));
}

static core_quat quat_or_identity(core_quat q) {
    bool zero = q.x == 0.0f && q.y == 0.0f && q.z == 0.0f && q.w == 0.0f;
    return zero ? core_quat_identity() : q;
}

core_quat core_quat_axis_angle(core_vec3 unit_axis, float radians) {
    float s, c;
    core_sincosf(0.5f * radians, &s, &c);
    return (core_quat){unit_axis.x * s, unit_axis.y * s, unit_axis.z * s, c};
}

core_quat core_quat_mul(core_quat a, core_quat b) {
    a = quat_or_identity(a), b = quat_or_identity(b);
    return (core_quat){
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
    };
}

core_quat core_quat_conjugate(core_quat q) { return (core_quat){-q.x, -q.y, -q.z, q.w}; }

core_quat core_quat_normalize(core_quat q) {
    float ax = core_absf(q.x), ay = core_absf(q.y), az = core_absf(q.z), aw = core_absf(q.w);
    float size = CORE_MAX(CORE_MAX(ax, ay), CORE_MAX(az, aw));
    bool finite = finite_(q.x) && finite_(q.y) && finite_(q.z) && finite_(q.w);
    if (!finite || size == 0.0f) {
        return core_quat_identity();
    }
    if (size < 1e-15f || size > 1e15f) { // squares would leave the range of float
        q.x /= size, q.y /= size, q.z /= size, q.w /= size;
    }
    float inv = 1.0f / core_sqrtf(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return (core_quat){q.x * inv, q.y * inv, q.z * inv, q.w * inv};
}

static core_quat quat_blend(core_quat a, float wa, core_quat b, float wb) {
    return (core_quat){a.x * wa + b.x * wb, a.y * wa + b.y * wb, a.z * wa + b.z * wb,
                       a.w * wa + b.w * wb};
}

static float quat_dot(core_quat a, core_quat b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

core_quat core_quat_nlerp(core_quat a, core_quat b, float t) {
    a = quat_or_identity(a), b = quat_or_identity(b);
    float side = quat_dot(a, b) < 0.0f ? -t : t; // q and -q are one rotation: take the near one
    return core_quat_normalize(quat_blend(a, 1.0f - t, b, side));
}

// Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985. The angle comes from
// atan2 of chord lengths (Kahan), which keeps its precision where acos of the dot loses half.
core_quat core_quat_slerp(core_quat a, core_quat b, float t) {
    a = quat_or_identity(a), b = quat_or_identity(b);
    if (quat_dot(a, b) < 0.0f) {
        b = (core_quat){-b.x, -b.y, -b.z, -b.w};
    }
    core_quat minus = quat_blend(a, 1.0f, b, -1.0f), plus = quat_blend(a, 1.0f, b, 1.0f);
    float half = core_atan2f(core_sqrtf(quat_dot(minus, minus)), core_sqrtf(quat_dot(plus, plus)));
    float angle = 2.0f * half;
    float s = core_sinf(angle);
    if (s < 1e-4f) { // the sines are proportional to their arguments here
        return core_quat_normalize(quat_blend(a, 1.0f - t, b, t));
    }
    float wa = core_sinf((1.0f - t) * angle) / s, wb = core_sinf(t * angle) / s;
    return core_quat_normalize(quat_blend(a, wa, b, wb));
}

core_vec3 core_quat_rotate(core_quat q, core_vec3 v) {
    core_vec3 u = {q.x, q.y, q.z};
    core_vec3 t = core_v3_scale(core_v3_cross(u, v), 2.0f);
    return core_v3_add(core_v3_mad(v, t, q.w), core_v3_cross(u, t));
}

core_vec3 core_quat_unrotate(core_quat q, core_vec3 v) {
    return core_quat_rotate(core_quat_conjugate(q), v);
}

core_mat4 core_mat4_identity(void) {
    return (core_mat4){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
}

core_mat4 core_mat4_mul(const core_mat4 *a, const core_mat4 *b) {
    core_mat4 out;
    for (int column = 0; column < 4; column++) {
        const float *b_col = &b->m[column * 4];
        for (int row = 0; row < 4; row++) {
            out.m[column * 4 + row] = a->m[row] * b_col[0] + a->m[4 + row] * b_col[1] +
                                      a->m[8 + row] * b_col[2] + a->m[12 + row] * b_col[3];
        }
    }
    return out;
}

core_mat4 core_mat4_trs(core_vec3 t, core_quat r, core_vec3 s) {
    float xx = r.x * r.x, yy = r.y * r.y, zz = r.z * r.z;
    float xy = r.x * r.y, xz = r.x * r.z, yz = r.y * r.z;
    float wx = r.w * r.x, wy = r.w * r.y, wz = r.w * r.z;
    return (core_mat4){{
        s.x * (1.0f - 2.0f * (yy + zz)),
        s.x * (2.0f * (xy + wz)),
        s.x * (2.0f * (xz - wy)),
        0.0f,
        s.y * (2.0f * (xy - wz)),
        s.y * (1.0f - 2.0f * (xx + zz)),
        s.y * (2.0f * (yz + wx)),
        0.0f,
        s.z * (2.0f * (xz + wy)),
        s.z * (2.0f * (yz - wx)),
        s.z * (1.0f - 2.0f * (xx + yy)),
        0.0f,
        t.x,
        t.y,
        t.z,
        1.0f,
    }};
}

// Adjugate over determinant by 2x2 minors of the upper and lower row pairs (Laplace expansion), in
// double: exact products, so a singular float matrix shows a determinant of rounding size only.
bool core_mat4_inverse(const core_mat4 *a, core_mat4 *out) {
    double m[16];
    double volume = 1.0; // Hadamard's bound on the determinant
    for (int column = 0; column < 4; column++) {
        double square = 0.0;
        for (int row = 0; row < 4; row++) {
            double e = a->m[column * 4 + row];
            m[column * 4 + row] = e;
            square += e * e;
        }
        volume *= core_sqrt(square);
    }
    double s0 = m[0] * m[5] - m[4] * m[1], s1 = m[0] * m[9] - m[8] * m[1];
    double s2 = m[0] * m[13] - m[12] * m[1], s3 = m[4] * m[9] - m[8] * m[5];
    double s4 = m[4] * m[13] - m[12] * m[5], s5 = m[8] * m[13] - m[12] * m[9];
    double c5 = m[10] * m[15] - m[14] * m[11], c4 = m[6] * m[15] - m[14] * m[7];
    double c3 = m[6] * m[11] - m[10] * m[7], c2 = m[2] * m[15] - m[14] * m[3];
    double c1 = m[2] * m[11] - m[10] * m[3], c0 = m[2] * m[7] - m[6] * m[3];
    double det = s0 * c5 - s1 * c4 + s2 * c3 + s3 * c2 - s4 * c1 + s5 * c0;
    double size = det < 0.0 ? -det : det;
    if (!(size > 1e-14 * volume) || !(size <= DBL_MAX)) {
        return false;
    }
    const double adjugate[16] = {
        m[5] * c5 - m[9] * c4 + m[13] * c3,   -m[1] * c5 + m[9] * c2 - m[13] * c1,
        m[1] * c4 - m[5] * c2 + m[13] * c0,   -m[1] * c3 + m[5] * c1 - m[9] * c0,
        -m[4] * c5 + m[8] * c4 - m[12] * c3,  m[0] * c5 - m[8] * c2 + m[12] * c1,
        -m[0] * c4 + m[4] * c2 - m[12] * c0,  m[0] * c3 - m[4] * c1 + m[8] * c0,
        m[7] * s5 - m[11] * s4 + m[15] * s3,  -m[3] * s5 + m[11] * s2 - m[15] * s1,
        m[3] * s4 - m[7] * s2 + m[15] * s0,   -m[3] * s3 + m[7] * s1 - m[11] * s0,
        -m[6] * s5 + m[10] * s4 - m[14] * s3, m[2] * s5 - m[10] * s2 + m[14] * s1,
        -m[2] * s4 + m[6] * s2 - m[14] * s0,  m[2] * s3 - m[6] * s1 + m[10] * s0,
    };
    for (int i = 0; i < 16; i++) {
        out->m[i] = (float)(adjugate[i] / det);
    }
    return true;
}

core_vec3 core_mat4_point(const core_mat4 *m, core_vec3 p) {
    const float *e = m->m;
    return (core_vec3){e[0] * p.x + e[4] * p.y + e[8] * p.z + e[12],
                       e[1] * p.x + e[5] * p.y + e[9] * p.z + e[13],
                       e[2] * p.x + e[6] * p.y + e[10] * p.z + e[14]};
}

core_mat4 core_mat4_look_at(core_vec3 eye, core_vec3 target, core_vec3 up) {
    core_vec3 back = core_v3_normalize(core_v3_sub(eye, target), (core_vec3){0, 0, 1});
    // An up direction along the view leaves the roll open: any perpendicular will do.
    core_vec3 spare = core_absf(back.y) < 0.9f ? (core_vec3){0, 1, 0} : (core_vec3){0, 0, -1};
    core_vec3 aside = core_v3_cross(core_v3_normalize(up, spare), back);
    if (!(core_v3_dot(aside, aside) > 1e-12f)) {
        aside = core_v3_cross(spare, back);
    }
    core_vec3 right = core_v3_normalize(aside, (core_vec3){1, 0, 0});
    core_vec3 top = core_v3_cross(back, right);
    return (core_mat4){{
        right.x,
        top.x,
        back.x,
        0.0f,
        right.y,
        top.y,
        back.y,
        0.0f,
        right.z,
        top.z,
        back.z,
        0.0f,
        -core_v3_dot(right, eye),
        -core_v3_dot(top, eye),
        -core_v3_dot(back, eye),
        1.0f,
    }};
}

core_mat4 core_mat4_perspective(float fovy, float aspect, float near_plane) {
    float focal = 1.0f / core_tanf(0.5f * fovy);
    core_mat4 out = {{0}};
    out.m[0] = focal / aspect;
    out.m[5] = focal;
    out.m[11] = -1.0f; // w = -z, so depth = near / -z
    out.m[14] = near_plane;
    return out;
}

core_mat4 core_mat4_ortho(float left, float right, float bottom, float top, float near_plane,
                          float far_plane) {
    core_mat4 out = {{0}};
    float depth = far_plane - near_plane;
    out.m[0] = 2.0f / (right - left);
    out.m[5] = 2.0f / (top - bottom);
    out.m[10] = 1.0f / depth;
    out.m[12] = -(right + left) / (right - left);
    out.m[13] = -(top + bottom) / (top - bottom);
    out.m[14] = far_plane / depth;
    out.m[15] = 1.0f;
    return out;
}
