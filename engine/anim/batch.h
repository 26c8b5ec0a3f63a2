// Kernels that pose up to CORE_SIMD_WIDTH instances of one skeleton at once. A block pose holds
// instances side by side: component c of bone b of instance i at [(b * ANIM_COMPONENTS + c) * W +
// i]. Sampling runs across tracks and turns W x W pieces round; everything after it runs across
// instances. The arithmetic is that of pack.c and pose.c, so results are the same to the bit.
#ifndef ANIM_BATCH_H
#define ANIM_BATCH_H

#include "anim/anim_internal.h"
#include "anim/pack.h"
#include "core/simd.h"

// Every lane samples the same clip at its own time.
typedef struct anim_sample_args {
    const anim_pack *pack;
    const float *rest;    // [ANIM_COMPONENTS * stride] values of what no group gives
    const uint8_t *moved; // [bones] bit per anim_pack_kind that a group gives
    uint32_t bones, stride;
    const float *time; // [W]
    float *pose;
} anim_sample_args;
// pose = from + (pose - from) * weight, lane by lane; weight 1 leaves the lane's bits alone.
typedef struct anim_mix_args {
    uint32_t bones;
    const float *weight; // [W] in [0, 1]
    const float *from;
    float *pose;
} anim_mix_args;
typedef struct anim_finish_args {
    const anim_skeleton_res *skeleton;
    const float *pose;
    float *model;    // scratch, [bones * 12 * W]
    float **palette; // [W], NULL: lane unused
} anim_finish_args;

CORE_SIMD_DECLARE(void, anim_kernel_sample, (const anim_sample_args *a))
CORE_SIMD_DECLARE(void, anim_kernel_mix, (const anim_mix_args *a))
CORE_SIMD_DECLARE(void, anim_kernel_finish, (const anim_finish_args *a))

#endif
