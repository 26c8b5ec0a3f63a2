// Lab kernels of this room.
#ifndef ANIM_LAB_H
#define ANIM_LAB_H

#include "core/lab.h"

// "anim_pose": ns per bone from state to skinning palette, and the distance to the double
// evaluator. "anim_pack": bytes per bone and second against metres at the skin shell.
extern const core_lab_kernel anim_lab_pose, anim_lab_pack;
// "anim_keys": keys against the motion they are taken from. "anim_lod": palettes that are behind,
// in pixels. "anim_fade": jumps of a cross-fade.
extern const core_lab_kernel anim_lab_keys, anim_lab_lod, anim_lab_fade;

#endif
