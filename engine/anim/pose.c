// Poses: arrays of the caller's and columns of the room; blending and the way from local to model
// space to skinning palettes. Scalar and plain: the reference that the kernels are tested against.
#include "anim/anim_internal.h"

#include <string.h>

void anim_columns_from_pose(anim_pose in, uint32_t bones, uint32_t n, float *out) {
    for (uint32_t b = 0; b < n; b++) {
        bool real = b < bones;
        core_vec3 t = real ? in.translation[b] : core_v3(0, 0, 0);
        core_quat q = real ? in.rotation[b] : core_quat_identity();
        core_vec3 s = real ? in.scale[b] : core_v3(1, 1, 1);
        const float v[ANIM_COMPONENTS] = {t.x, t.y, t.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z};
        for (uint32_t c = 0; c < ANIM_COMPONENTS; c++) {
            out[c * n + b] = v[c];
        }
    }
}

void anim_columns_to_pose(const float *in, uint32_t bones, uint32_t n, anim_pose out) {
    for (uint32_t b = 0; b < bones; b++) {
        const float *v = in + b;
        out.translation[b] = core_v3(v[ANIM_TX * n], v[ANIM_TY * n], v[ANIM_TZ * n]);
        out.rotation[b] =
            (core_quat){v[ANIM_RX * n], v[ANIM_RY * n], v[ANIM_RZ * n], v[ANIM_RW * n]};
        out.scale[b] = core_v3(v[ANIM_SX * n], v[ANIM_SY * n], v[ANIM_SZ * n]);
    }
}

static core_vec3 lerp3(core_vec3 a, core_vec3 b, float left, float right) {
    return core_v3_mad(core_v3_scale(a, left), b, right);
}

void anim_pose_blend(anim_pose a, anim_pose b, float alpha, uint32_t bones, anim_pose out) {
    float right = CORE_CLAMP(alpha, 0.0f, 1.0f), left = 1 - right;
    for (uint32_t i = 0; i < bones; i++) {
        if (right == 0 || right == 1) {
            anim_pose end = right == 0 ? a : b;
            out.translation[i] = end.translation[i];
            out.rotation[i] = end.rotation[i];
            out.scale[i] = end.scale[i];
            continue;
        }
        out.translation[i] = lerp3(a.translation[i], b.translation[i], left, right);
        out.rotation[i] = core_quat_nlerp(a.rotation[i], b.rotation[i], right);
        out.scale[i] = lerp3(a.scale[i], b.scale[i], left, right);
    }
}

// nlerp the short way; both are unit, so that the sum is no shorter than sqrt(1/2).
static void mix_rotation(const float *a, const float *b, float left, float right, uint32_t n,
                         float *out) {
    float dot = ((a[0] * b[0] + a[n] * b[n]) + a[2 * n] * b[2 * n]) + a[3 * n] * b[3 * n], q[4];
    float side = dot < 0 ? -right : right;
    for (uint32_t k = 0; k < 4; k++) {
        q[k] = a[k * n] * left + b[k * n] * side;
    }
    float inverse = 1 / core_sqrtf(((q[0] * q[0] + q[1] * q[1]) + q[2] * q[2]) + q[3] * q[3]);
    for (uint32_t k = 0; k < 4; k++) {
        out[k * n] = q[k] * inverse;
    }
}

void anim_columns_blend(const float *a, const float *b, float alpha, uint32_t n, float *out) {
    float right = CORE_CLAMP(alpha, 0.0f, 1.0f), left = 1 - right;
    if (right == 0 || right == 1) {
        memmove(out, right == 0 ? a : b, ANIM_COMPONENTS * n * sizeof *out);
        return;
    }
    for (uint32_t i = 0; i < ANIM_COMPONENTS * n; i++) {
        if (i < ANIM_RX * n || i >= ANIM_SX * n) {
            out[i] = a[i] * left + b[i] * right;
        }
    }
    for (uint32_t i = ANIM_RX * n; i < ANIM_RY * n; i++) {
        mix_rotation(a + i, b + i, left, right, n, out + i);
    }
}

// Rows of the 3x4 matrix of translation * rotation * scale.
static void local_matrix(const float *pose, uint32_t n, uint32_t b, float m[12]) {
    const float *v = pose + b;
    float x = v[ANIM_RX * n], y = v[ANIM_RY * n], z = v[ANIM_RZ * n], w = v[ANIM_RW * n];
    float sx = v[ANIM_SX * n], sy = v[ANIM_SY * n], sz = v[ANIM_SZ * n];
    m[0] = (1 - 2 * (y * y + z * z)) * sx;
    m[1] = 2 * (x * y - w * z) * sy;
    m[2] = 2 * (x * z + w * y) * sz;
    m[3] = v[ANIM_TX * n];
    m[4] = 2 * (x * y + w * z) * sx;
    m[5] = (1 - 2 * (x * x + z * z)) * sy;
    m[6] = 2 * (y * z - w * x) * sz;
    m[7] = v[ANIM_TY * n];
    m[8] = 2 * (x * z - w * y) * sx;
    m[9] = 2 * (y * z + w * x) * sy;
    m[10] = (1 - 2 * (x * x + y * y)) * sz;
    m[11] = v[ANIM_TZ * n];
}

static inline void mul34_row(const float *restrict row, const float *restrict b,
                             float *restrict out) {
    float x = row[0], y = row[1], z = row[2], w = row[3];
    out[0] = x * b[0] + y * b[4] + z * b[8];
    out[1] = x * b[1] + y * b[5] + z * b[9];
    out[2] = x * b[2] + y * b[6] + z * b[10];
    out[3] = (x * b[3] + y * b[7] + z * b[11]) + w;
}

static inline void mul34(const float *restrict a, const float *restrict b, float *restrict out) {
    mul34_row(a, b, out);
    mul34_row(a + 4, b, out + 4);
    mul34_row(a + 8, b, out + 8);
}

void anim_columns_to_model(const anim_skeleton_res *s, const float *pose, float *model) {
    for (uint32_t b = 0; b < s->bones; b++) {
        float local[12];
        local_matrix(pose, s->stride, b, s->parent[b] < 0 ? model + 12 * b : local);
        if (s->parent[b] >= 0) {
            mul34(model + 12 * (uint32_t)s->parent[b], local, model + 12 * b);
        }
    }
}

void anim_model_palette(const anim_skeleton_res *s, const float *model, float *palette) {
    for (uint32_t b = 0; b < s->bones; b++) {
        mul34(model + 12 * b, s->inverse_bind + 12 * b, palette + 12 * b);
    }
}

bool anim_pose_to_model(const anim_world *w, anim_skeleton h, anim_pose pose, core_mat4 *model) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    if (!s) {
        return false;
    }
    for (uint32_t b = 0; b < s->bones; b++) {
        core_mat4 local = core_mat4_trs(pose.translation[b], pose.rotation[b], pose.scale[b]);
        model[b] = s->parent[b] < 0 ? local : core_mat4_mul(&model[s->parent[b]], &local);
    }
    return true;
}

bool anim_model_to_palette(const anim_world *w, anim_skeleton h, const core_mat4 *model,
                           float *palette) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    if (!s) {
        return false;
    }
    for (uint32_t b = 0; b < s->bones; b++) {
        float rows[12];
        for (uint32_t i = 0; i < 12; i++) {
            rows[i] = model[b].m[i % 4 * 4 + i / 4];
        }
        mul34(rows, s->inverse_bind + 12 * b, palette + 12 * b);
    }
    return true;
}
