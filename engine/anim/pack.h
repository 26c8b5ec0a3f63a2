// Compressed clips ("CAN2"): every track is uniformly spaced keys, quantised to 8 or 16 bits within
// the track's own range, at the clip's rate or a half or a quarter of it. Tracks of one kind, width
// and rate form a group, laid out for sampling many tracks at once: a sample reads two neighbouring
// rows, whatever the time, so seeking costs what playing does and instances keep no cursor.
//
// A rotation is base * d: d turns little, so its x, y, z are enough (w > 0 follows) and are well
// conditioned. Between rows it goes by nlerp, normalised by a series in 1 - |d|^2, which the small
// turns from row to row keep near 0. Widths and rates are chosen so that the worst distance between
// the clip and its source, at every joint and at points `shell` metres from it along each axis,
// stays within a bound that the file states (the metric of Frechette's ACL, 2017).
#ifndef ANIM_PACK_H
#define ANIM_PACK_H

#include "core/data.h"

typedef enum anim_pack_kind { ANIM_PACK_R, ANIM_PACK_T, ANIM_PACK_S } anim_pack_kind;

typedef struct anim_pack_group {
    uint32_t kind, bytes;    // bytes of one number: 1 or 2
    uint32_t tracks, stride; // stride: tracks padded to CORE_LANES
    uint32_t intervals;      // rows - 1
    const uint8_t *rows;     // [intervals + 1][3][stride] of `bytes`
    const float *low, *step; // [3][stride]
    const float *base;       // [4][stride], rotations only
    const uint16_t *bone;    // [tracks]
} anim_pack_group;

typedef struct anim_pack_fixed { // a component that never changes
    uint16_t bone, kind;
    float value[4];
} anim_pack_fixed;

typedef struct anim_pack {
    char name[CORE_NAME_MAX];
    float duration;
    uint32_t bones;
    float bound, shell, error; // m: asked for, distance of the shell, measured
    uint32_t group_count, fixed_count;
    anim_pack_group *group;
    anim_pack_fixed *fixed;
    size_t file_bytes;
} anim_pack;

// Encodes; core_free the result. rate: keys a second, 0 = that of the source. NULL + core_fail when
// the bound cannot be kept (or a bone turns too far from its mean rotation).
void *anim_pack_encode(const core_skeleton_data *skeleton, const core_clip_data *clip, float bound,
                       float shell, float rate, size_t *size);
// One block, core_free it. Refuses anything that does not fit together.
anim_pack *anim_pack_decode(const void *bytes, size_t size, const char *path);

// Row and fraction of a group at a time in [0, duration].
static inline uint32_t anim_pack_row(const anim_pack_group *g, float duration, float time,
                                     float *fraction) {
    float u = time * ((float)g->intervals / duration);
    u = u > 0 ? u : 0;
    uint32_t row = u < (float)g->intervals ? (uint32_t)u : g->intervals - 1;
    u -= (float)row;
    *fraction = u < 1 ? u : 1;
    return row;
}
// One track, plainly: the arithmetic that the kernels repeat in vectors. out[4]: x y z (w).
#define ANIM_PACK_SERIES_1 0.5f // (1 - x)^-1/2 = 1 + x/2 + 3/8 x^2 + 5/16 x^3 + 35/128 x^4 + ...
#define ANIM_PACK_SERIES_2 0.375f
#define ANIM_PACK_SERIES_3 0.3125f
#define ANIM_PACK_SERIES_4 0.2734375f
void anim_pack_sample_track(const anim_pack_group *g, uint32_t track, uint32_t row, float fraction,
                            float out[4]);
// A pose in columns (see anim_internal.h); bones that the clip does not mention are left alone.
void anim_pack_sample(const anim_pack *pack, float time, uint32_t stride, float *out);

#endif
