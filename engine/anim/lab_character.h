// The character of this room's lab kernels: 67 bones made by formula; a quarter of them swing
// widely, half a little, a quarter not at all, as hands and faces do in walks.
#ifndef ANIM_LAB_CHARACTER_H
#define ANIM_LAB_CHARACTER_H

#include "anim/anim_internal.h"

#define LAB_BONES    67u
#define LAB_DURATION (4.0 / 3) // s

typedef struct lab_character {
    char name[LAB_BONES][CORE_NAME_MAX];
    int32_t parent[LAB_BONES];
    core_vec3 translation[LAB_BONES], scale[LAB_BONES];
    core_quat rotation[LAB_BONES];
    core_mat4 inverse_bind[LAB_BONES];
    core_skeleton_data skeleton;
    core_clip_track track[LAB_BONES];
    core_clip_data clip;
    core_key *key; // [LAB_BONES * keys]
} lab_character;

// With its skeleton; the clip follows. destroy takes NULL.
lab_character *lab_character_create(float size); // 1: as large as a person
void lab_character_destroy(lab_character *c);
// `rate` keys a second of every bone.
void lab_character_clip(lab_character *c, double rate, core_key_mode mode);
// Where a bone is at u in [0, 1) of the clip, by the formula that the keys are taken from.
core_key lab_character_key(const lab_character *c, uint32_t bone, double u);
anim_clip lab_character_add(anim_world *w, anim_skeleton skeleton, const lab_character *c);

#endif
