// Lab kernels of this room.
#ifndef ANIM_LAB_H
#define ANIM_LAB_H

#include "core/lab.h"

// "anim_pose": ns per bone from state to skinning palette, and the distance to the double
// evaluator. "anim_pack": bytes per bone and second against metres at the skin shell.
extern const core_lab_kernel anim_lab_pose, anim_lab_pack;

#endif
