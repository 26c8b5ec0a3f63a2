// The lab's character (lab_character.h).
#include "anim/lab_character.h"

#include <stdio.h>

lab_character *lab_character_create(float size) {
    lab_character *c = core_alloc(sizeof *c);
    core_mat4 model[LAB_BONES];
    for (uint32_t b = 0; b < LAB_BONES; b++) {
        snprintf(c->name[b], CORE_NAME_MAX, "bone%u", b);
        c->parent[b] = b == 0 ? -1 : b % 6 == 1 ? (int32_t)(b / 12) : (int32_t)b - 1;
        c->translation[b] =
            core_v3_scale(core_v3(0.05f * (float)(b % 3), 0.12f, 0.02f * (float)(b % 5)), size);
        c->rotation[b] = core_quat_axis_angle(core_v3(0, 0, 1), 0.1f * (float)(b % 7));
        c->scale[b] = core_v3(1, 1, 1);
        core_mat4 local = core_mat4_trs(c->translation[b], c->rotation[b], c->scale[b]);
        model[b] = b == 0 ? local : core_mat4_mul(&model[c->parent[b]], &local);
        core_mat4_inverse(&model[b], &c->inverse_bind[b]);
    }
    c->skeleton = (core_skeleton_data){LAB_BONES,      (const char(*)[CORE_NAME_MAX])c->name,
                                       c->parent,      c->translation,
                                       c->rotation,    c->scale,
                                       c->inverse_bind};
    return c;
}

void lab_character_destroy(lab_character *c) {
    if (c) {
        core_free(c->key);
        core_free(c);
    }
}

// Two harmonics a bone: feet do not swing like pendulums.
core_key lab_character_key(const lab_character *c, uint32_t b, double u) {
    double swing = b % 4 == 0 ? 0.5 : b % 4 < 3 ? 0.08 : 0;
    double phase = 2 * CORE_PI * (u + 0.13 * b);
    double angle = swing * (core_sin(phase) + 0.25 * core_sin(3 * phase));
    core_vec3 axis = core_v3_normalize(
        core_v3((float)core_cos(b), (float)core_sin(2.0 * b), (float)core_cos(3.0 * b)),
        core_v3(1, 0, 0));
    core_vec3 t = c->translation[b];
    t.y += b == 0 ? 0.25f * t.y * (float)core_sin(4 * CORE_PI * u) : 0;
    return (core_key){(float)(LAB_DURATION * u),
                      t,
                      core_quat_mul(c->rotation[b], core_quat_axis_angle(axis, (float)angle)),
                      {1, 1, 1}};
}

void lab_character_clip(lab_character *c, double rate, core_key_mode mode) {
    uint32_t keys = (uint32_t)(LAB_DURATION * rate + 0.5) + 1;
    keys = CORE_MAX(keys, 2u);
    core_free(c->key);
    c->key = core_alloc((size_t)LAB_BONES * keys * sizeof *c->key);
    for (uint32_t b = 0; b < LAB_BONES; b++) {
        core_key *key = c->key + (size_t)b * keys;
        for (uint32_t k = 0; k < keys; k++) {
            key[k] = lab_character_key(c, b, (double)k / (keys - 1));
        }
        c->track[b] = (core_clip_track){.bone = b, .key_count = keys, .key = key, .mode = mode};
    }
    c->clip = (core_clip_data){.name = "walk",
                               .duration = (float)LAB_DURATION,
                               .bone_count = LAB_BONES,
                               .track_count = LAB_BONES,
                               .track = c->track};
}

anim_clip lab_character_add(anim_world *w, anim_skeleton skeleton, const lab_character *c) {
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = &c->clip;
    desc.skeleton = skeleton;
    return anim_clip_create(w, &desc);
}
