// Deterministic mathematics: + - * / sqrt only, no FMA, no libm: the same bits on gcc and clang, on
// every instruction set. Float versions for kernels, double versions (within 1 ULP) for Lua and
// tools. The bounds stated here are those of core_math_table, against libm in long double. Values
// at the ends of the range follow C17 Annex F; nothing is written to errno or to the rounding mode.
#ifndef CORE_MATH_H
#define CORE_MATH_H

#include "core/base.h"

#define CORE_PI   3.14159265358979323846
#define CORE_PI_F 3.14159265358979323846f

// double. The comment is the largest error in ULP that any argument may show.
double core_sin(double x);             // 0.8, huge arguments too
double core_cos(double x);             // 0.8
double core_tan(double x);             // 0.9
double core_asin(double x);            // 0.75; NaN outside [-1, 1]
double core_acos(double x);            // 0.75; NaN outside [-1, 1]
double core_atan(double x);            // 0.75
double core_atan2(double y, double x); // 0.75
double core_exp(double x);             // 0.8
double core_ln(double x);              // 0.51; natural logarithm (core_log is the log, log.h)
double core_log2(double x);            // 0.51; exact for powers of two
double core_log10(double x);           // 0.51; exact for powers of ten
// 0.8. Exact wherever the result is a double; core_pow(x, 2) is x*x to the bit, as in compiled Lua
// traces, core_pow(x, -1) is 1/x and core_pow(x, 0.5) the square root.
double core_pow(double x, double y);
double core_sinh(double x);           // 0.85
double core_cosh(double x);           // 0.75
double core_tanh(double x);           // 0.8
double core_fmod(double x, double y); // exact
double core_floor(double x);          // exact
double core_ceil(double x);           // exact

// float: the same bits as vf_sin, vf_cos, ... of core/simd_math.h. Errors in ULP as above.
float core_sinf(float x); // 0.8
float core_cosf(float x); // 0.8
void core_sincosf(float x, float *s, float *c);
float core_tanf(float x);            // 2.3
float core_asinf(float x);           // 1.25
float core_acosf(float x);           // 1.15
float core_atan2f(float y, float x); // 1.75
float core_expf(float x);            // 0.8
float core_lnf(float x);             // 0.8
float core_powf(float x, float y);   // 0.51
static inline float core_sqrtf(float x) { return __builtin_sqrtf(x); }
static inline double core_sqrt(double x) { return __builtin_sqrt(x); }
static inline float core_absf(float x) { return x < 0.0f ? -x : x; }

// Small values for interfaces; hot kernels work on columns instead.
typedef struct core_vec3 {
    float x, y, z;
} core_vec3;
typedef struct core_quat { // rotation, x y z w; identity {0,0,0,1}; zero-initialised means identity
    float x, y, z, w;
} core_quat;
typedef struct core_mat4 { // column-major, m[column*4 + row]
    float m[16];
} core_mat4;
typedef struct core_aabb {
    core_vec3 min, max;
} core_aabb;

static inline core_vec3 core_v3(float x, float y, float z) { return (core_vec3){x, y, z}; }
static inline core_vec3 core_v3_add(core_vec3 a, core_vec3 b) {
    return (core_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline core_vec3 core_v3_sub(core_vec3 a, core_vec3 b) {
    return (core_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline core_vec3 core_v3_scale(core_vec3 a, float s) {
    return (core_vec3){a.x * s, a.y * s, a.z * s};
}
static inline core_vec3 core_v3_mad(core_vec3 a, core_vec3 b, float s) { // a + b*s
    return (core_vec3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static inline float core_v3_dot(core_vec3 a, core_vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline core_vec3 core_v3_cross(core_vec3 a, core_vec3 b) {
    return (core_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline float core_v3_length(core_vec3 a) { return core_sqrtf(core_v3_dot(a, a)); }
// Zero (or NaN) length gives `fallback`.
core_vec3 core_v3_normalize(core_vec3 a, core_vec3 fallback);

static inline core_quat core_quat_identity(void) { return (core_quat){0, 0, 0, 1}; }
core_quat core_quat_axis_angle(core_vec3 unit_axis, float radians);
core_quat core_quat_mul(core_quat a, core_quat b); // rotate by b, then a
core_quat core_quat_conjugate(core_quat q);
core_quat core_quat_normalize(core_quat q);                   // zero or non-finite: identity
core_quat core_quat_nlerp(core_quat a, core_quat b, float t); // short way
core_quat core_quat_slerp(core_quat a, core_quat b, float t); // short way
core_vec3 core_quat_rotate(core_quat q, core_vec3 v);
core_vec3 core_quat_unrotate(core_quat q, core_vec3 v);

core_mat4 core_mat4_identity(void);
core_mat4 core_mat4_mul(const core_mat4 *a, const core_mat4 *b);
core_mat4 core_mat4_trs(core_vec3 t, core_quat r, core_vec3 s);
bool core_mat4_inverse(const core_mat4 *a, core_mat4 *out); // false when singular
core_vec3 core_mat4_point(const core_mat4 *m, core_vec3 p); // w assumed 1, no divide
core_mat4 core_mat4_look_at(core_vec3 eye, core_vec3 target, core_vec3 up);
// Reversed-Z infinite projection, depth 1 at near and 0 at infinity (design page 8).
core_mat4 core_mat4_perspective(float fovy, float aspect, float near_plane);
// Orthographic with the same reversed depth: 1 at near, 0 at far.
core_mat4 core_mat4_ortho(float left, float right, float bottom, float top, float near_plane,
                          float far_plane);

#endif
