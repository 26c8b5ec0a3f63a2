// Root motion: the part of the root bone's translation that moves the whole instance. It is taken
// out in model space, whatever frame the root's ancestors have (exporters often put a rotated or
// scaled armature node above the root).
//
// With A the linear part of the ancestors' bind transform and K = diag(1, vertical, 1), a local
// displacement d reports K A d and leaves d - A^-1 K A d in the pose.
#include "anim/anim_internal.h"

static void linear_part(const anim_skeleton_res *s, int32_t bone, float out[9]) {
    core_mat4 total = core_mat4_identity();
    for (int32_t b = bone; b >= 0; b = s->parent[b]) {
        const float *v = s->bind + b;
        uint32_t n = s->stride;
        core_mat4 local = core_mat4_trs(
            core_v3(0, 0, 0),
            (core_quat){v[ANIM_RX * n], v[ANIM_RY * n], v[ANIM_RZ * n], v[ANIM_RW * n]},
            core_v3(v[ANIM_SX * n], v[ANIM_SY * n], v[ANIM_SZ * n]));
        total = core_mat4_mul(&local, &total);
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            out[r * 3 + c] = total.m[c * 4 + r];
        }
    }
}

static bool invert3(const float m[9], float out[9]) {
    core_mat4 a = core_mat4_identity(), b;
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            a.m[c * 4 + r] = m[r * 3 + c];
        }
    }
    if (!core_mat4_inverse(&a, &b)) {
        return false;
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            out[r * 3 + c] = b.m[c * 4 + r];
        }
    }
    return true;
}

static core_vec3 mul3(const float m[9], core_vec3 v) {
    return (core_vec3){m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
                       m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

void anim_root_prepare(const anim_skeleton_res *s, anim_clip_res *c, bool vertical) {
    float a[9], inverse[9];
    linear_part(s, s->parent[c->root_bone], a);
    for (int i = 0; i < 9; i++) {
        c->root_report[i] = i / 3 == 1 && !vertical ? 0 : a[i];
    }
    // A flattened ancestor cannot be moved out of: report the motion, leave the pose.
    bool invertible = invert3(a, inverse);
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 3; k++) {
            float sum = 0;
            for (int i = 0; invertible && i < 3; i++) {
                sum += inverse[r * 3 + i] * c->root_report[i * 3 + k];
            }
            c->root_remove[r * 3 + k] = sum;
        }
    }
}

static core_vec3 packed_translation(const anim_clip_res *c, float time) {
    for (uint32_t i = 0; i < c->pack->group_count; i++) {
        const anim_pack_group *g = &c->pack->group[i];
        for (uint32_t t = 0; g->kind == ANIM_PACK_T && t < g->tracks; t++) {
            if (g->bone[t] == c->root_bone) {
                float fraction, v[4];
                uint32_t row = anim_pack_row(g, c->duration, time, &fraction);
                anim_pack_sample_track(g, t, row, fraction, v);
                return core_v3(v[0], v[1], v[2]);
            }
        }
    }
    return core_v3(0, 0, 0); // it stands still
}

core_vec3 anim_root_translation(const anim_clip_res *c, float time) {
    if (c->pack) {
        return packed_translation(c, time);
    }
    int32_t track = c->track_of_bone[c->root_bone];
    if (track < 0) {
        return (core_vec3){0, 0, 0};
    }
    return anim_track_sample(&c->track[track], time).translation;
}

static bool root_moves(const anim_clip_res *c) {
    return c->pack ? (c->moved[c->root_bone] & 1u << ANIM_PACK_T) != 0
                   : c->track_of_bone[c->root_bone] >= 0;
}

void anim_root_pin(const anim_clip_res *c, float *x, float *y, float *z) {
    if (root_moves(c)) {
        core_vec3 d = core_v3_sub(core_v3(*x, *y, *z), anim_root_translation(c, 0));
        core_vec3 removed = mul3(c->root_remove, d);
        *x -= removed.x;
        *y -= removed.y;
        *z -= removed.z;
    }
}

core_vec3 anim_root_between(const anim_clip_res *c, float t0, float t1) {
    return mul3(c->root_report,
                core_v3_sub(anim_root_translation(c, t1), anim_root_translation(c, t0)));
}
