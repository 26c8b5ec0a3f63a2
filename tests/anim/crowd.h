// A crowd made by formula: a 67-bone skeleton of chains and clips in which every bone turns, for
// tests of batches and compression.
#ifndef TESTS_ANIM_CROWD_H
#define TESTS_ANIM_CROWD_H

#include "anim/anim.h"
#include "core/rng.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CROWD_BONES 67u
#define CROWD_KEYS  41u // 30 a second

typedef struct crowd {
    char name[CROWD_BONES][CORE_NAME_MAX];
    int32_t parent[CROWD_BONES];
    core_vec3 translation[CROWD_BONES], scale[CROWD_BONES];
    core_quat rotation[CROWD_BONES];
    core_mat4 inverse_bind[CROWD_BONES];
    core_skeleton_data skeleton;
    core_key key[CROWD_BONES][CROWD_KEYS];
    core_clip_track track[CROWD_BONES];
    core_clip_data clip;
} crowd;

static inline void crowd_skeleton(crowd *c) {
    core_mat4 model[CROWD_BONES];
    for (uint32_t b = 0; b < CROWD_BONES; b++) {
        snprintf(c->name[b], CORE_NAME_MAX, "bone%u", b);
        c->parent[b] = b == 0 ? -1 : b % 6 == 1 ? (int32_t)(b / 12) : (int32_t)b - 1;
        c->translation[b] = core_v3(0.05f * (float)(b % 3), 0.12f, 0.02f * (float)(b % 5));
        c->rotation[b] = core_quat_axis_angle(core_v3(0, 0, 1), 0.1f * (float)(b % 7));
        c->scale[b] = core_v3(1, 1, 1);
        core_mat4 local = core_mat4_trs(c->translation[b], c->rotation[b], c->scale[b]);
        model[b] = b == 0 ? local : core_mat4_mul(&model[c->parent[b]], &local);
        core_mat4_inverse(&model[b], &c->inverse_bind[b]);
    }
    c->skeleton = (core_skeleton_data){CROWD_BONES,    (const char(*)[CORE_NAME_MAX])c->name,
                                       c->parent,      c->translation,
                                       c->rotation,    c->scale,
                                       c->inverse_bind};
}

// Turns of up to `swing` radians, two thirds of the bones small ones; bone 0 walks along x.
static inline void crowd_clip(crowd *c, const char *name, float duration, float swing) {
    uint32_t tracks = 0;
    for (uint32_t b = 0; b < CROWD_BONES; b++) {
        if (b % 9 == 8) {
            continue; // some bones stay in the bind pose
        }
        for (uint32_t k = 0; k < CROWD_KEYS; k++) {
            float u = (float)k / (CROWD_KEYS - 1), s = b % 3 ? 0.25f * swing : swing;
            float angle = s * (float)sin(6.2831853 * (u + 0.13 * b));
            core_vec3 axis = core_v3_normalize(
                core_v3((float)cos(b), (float)sin(b * 2.0), (float)cos(b * 3.0)), core_v3(1, 0, 0));
            core_vec3 t = c->translation[b];
            t.x += b == 0 ? u : 0;
            c->key[b][k] =
                (core_key){duration * u,
                           t,
                           core_quat_mul(c->rotation[b], core_quat_axis_angle(axis, angle)),
                           {1, b == 4 ? 1 + 0.1f * u : 1, 1}};
        }
        c->track[tracks++] =
            (core_clip_track){.bone = b, .key_count = CROWD_KEYS, .key = c->key[b]};
    }
    c->clip = (core_clip_data){
        .duration = duration, .bone_count = CROWD_BONES, .track_count = tracks, .track = c->track};
    snprintf(c->clip.name, CORE_NAME_MAX, "%s", name);
}

static inline anim_clip crowd_clip_create(anim_world *w, anim_skeleton skeleton, const crowd *c) {
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = &c->clip;
    desc.skeleton = skeleton;
    anim_clip clip = anim_clip_create(w, &desc);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(clip), core_last_error());
    return clip;
}

#endif
