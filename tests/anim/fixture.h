// A three-bone arm and clips made by formula, for the tests of this room.
#ifndef TESTS_ANIM_FIXTURE_H
#define TESTS_ANIM_FIXTURE_H

#include "anim/anim.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FIX_BONES 3u
#define FIX_KEYS  31u

typedef struct fixture {
    anim_world *world;
    anim_skeleton skeleton;
} fixture;

static char fix_name[FIX_BONES][CORE_NAME_MAX] = {"root", "arm", "hand"};
static const int32_t fix_parent[FIX_BONES] = {-1, 0, 1};
static core_vec3 fix_t[FIX_BONES] = {{0, 0.5f, 0}, {0, 1, 0}, {0, 0.75f, 0.1f}};
static core_quat fix_r[FIX_BONES] = {{0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}};
static core_vec3 fix_s[FIX_BONES] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};

static inline core_skeleton_data fix_skeleton_data(core_mat4 *inverse_bind) {
    core_mat4 model[FIX_BONES];
    for (uint32_t b = 0; b < FIX_BONES; b++) {
        core_mat4 local = core_mat4_trs(fix_t[b], fix_r[b], fix_s[b]);
        model[b] = fix_parent[b] < 0 ? local : core_mat4_mul(&model[fix_parent[b]], &local);
        core_mat4_inverse(&model[b], &inverse_bind[b]);
    }
    return (core_skeleton_data){
        FIX_BONES,   (const char(*)[CORE_NAME_MAX])fix_name, fix_parent, fix_t, fix_r, fix_s,
        inverse_bind};
}

static inline fixture fix_make(void) {
    fixture f;
    anim_world_desc desc = anim_world_desc_default();
    f.world = anim_world_create(&desc);
    core_mat4 inverse_bind[FIX_BONES];
    core_skeleton_data data = fix_skeleton_data(inverse_bind);
    f.skeleton = anim_skeleton_create(f.world, &data);
    TEST_ASSERT_FALSE(core_handle_is_null(f.skeleton));
    return f;
}

// Rotates bone `bone` about z by `from`..`to` radians and moves it along x by `move` metres over
// `duration`, with keys at 30 per second of a 1-second clip.
typedef struct fix_clip_desc {
    const char *name;
    float duration, from, to, move, first, last; // keys cover [first, last], 0 = whole clip
    uint32_t bone, keys;
} fix_clip_desc;

static inline anim_clip fix_clip_with(fixture *f, fix_clip_desc d, const anim_clip_desc *base) {
    core_key key[FIX_KEYS];
    uint32_t n = d.keys ? d.keys : FIX_KEYS;
    float last = d.last > 0 ? d.last : d.duration;
    for (uint32_t k = 0; k < n; k++) {
        float u = n > 1 ? (float)k / (float)(n - 1) : 0;
        key[k] = (core_key){d.first + (last - d.first) * u,
                            core_v3_add(fix_t[d.bone], core_v3(d.move * u, 0, 0)),
                            core_quat_axis_angle(core_v3(0, 0, 1), d.from + (d.to - d.from) * u),
                            {1, 1, 1}};
    }
    core_clip_track track = {.bone = d.bone, .key_count = n, .key = key};
    core_clip_data data = {
        .duration = d.duration, .bone_count = FIX_BONES, .track_count = 1, .track = &track};
    snprintf(data.name, sizeof data.name, "%s", d.name);
    anim_clip_desc desc = base ? *base : anim_clip_desc_default();
    desc.data = &data;
    desc.skeleton = f->skeleton;
    anim_clip clip = anim_clip_create(f->world, &desc);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(clip), core_last_error());
    return clip;
}
static inline anim_clip fix_clip(fixture *f, fix_clip_desc d) { return fix_clip_with(f, d, NULL); }

typedef struct fix_pose {
    core_vec3 t[FIX_BONES];
    core_quat r[FIX_BONES];
    core_vec3 s[FIX_BONES];
} fix_pose;
static inline anim_pose fix_view(fix_pose *p) { return (anim_pose){p->t, p->r, p->s}; }

// Angle about z of a bone in the pose of this moment.
static inline double fix_angle(fixture *f, anim_instance i, uint32_t bone) {
    fix_pose p;
    TEST_ASSERT_TRUE(anim_instance_pose(f->world, i, fix_view(&p)));
    return 2 * atan2((double)p.r[bone].z, (double)p.r[bone].w);
}

#endif
