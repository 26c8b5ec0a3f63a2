// Plain data that rooms share: asset decodes files into these, rooms take pointers to them in their
// descriptions, scene carries them. A room copies what it keeps unless its header says otherwise.
#ifndef CORE_DATA_H
#define CORE_DATA_H

#include "core/math.h"

#define CORE_NAME_MAX 128 // bytes with the terminating zero

typedef struct core_mesh_data {
    uint32_t vertex_count, index_count;
    const float *position; // [vertex_count*3] metres
    const float *normal;   // [vertex_count*3] unit, or NULL
    const float *tangent;  // [vertex_count*4] xyz unit, w handedness, or NULL
    const float *uv;       // [vertex_count*2] or NULL
    const float *color;    // [vertex_count*4] linear, or NULL
    const uint16_t *joint; // [vertex_count*4] bone indices, or NULL
    const float *weight;   // [vertex_count*4] sums to 1, with joint
    const uint32_t *index; // [index_count] triangles, counter-clockwise seen from outside
    core_aabb bounds;
} core_mesh_data;

typedef enum core_image_format {
    CORE_IMAGE_RGBA8_SRGB,
    CORE_IMAGE_RGBA8_LINEAR,
    CORE_IMAGE_RGBA32F
} core_image_format;
typedef struct core_image_data {
    uint32_t width, height; // 1..16384
    core_image_format format;
    const void *pixels; // rows top to bottom, tightly packed
} core_image_data;

typedef struct core_skeleton_data { // parents come before children
    uint32_t bone_count;
    const char (*name)[CORE_NAME_MAX];
    const int32_t *parent;        // [bone_count] -1 for roots
    const core_vec3 *translation; // bind pose, local
    const core_quat *rotation;
    const core_vec3 *scale;
    const core_mat4 *inverse_bind; // [bone_count] model space of the mesh -> bone space
} core_skeleton_data;

typedef struct core_key { // as in the raw .canim: 44 bytes
    float time;           // seconds, ascending within a track
    core_vec3 translation;
    core_quat rotation; // x y z w
    core_vec3 scale;
} core_key;
typedef enum core_key_mode { CORE_KEY_LINEAR, CORE_KEY_STEP, CORE_KEY_CUBIC } core_key_mode;
typedef struct core_clip_track {
    uint32_t bone;
    uint32_t key_count; // >= 1
    const core_key *key;
    core_key_mode mode; // between keys
    // Cubic: [key_count * 2] in- and out-tangents per second (glTF 2.0, appendix C); NULL: those of
    // Catmull and Rom. Files of raw keys ("CAN1") are linear.
    const core_key *tangent;
} core_clip_track;
typedef struct core_clip_data {
    char name[CORE_NAME_MAX];
    float duration;      // seconds, > 0
    uint32_t bone_count; // of the skeleton it was made for
    uint32_t track_count;
    const core_clip_track *track; // ascending bone; bones without a track stay in bind pose
} core_clip_data;

typedef struct core_soup_data { // triangle soup for collision and navigation
    uint32_t vertex_count, triangle_count;
    const float *position; // [vertex_count*3]
    const uint32_t *index; // [triangle_count*3]
    const uint8_t *area;   // [triangle_count] or NULL
} core_soup_data;

// A field of heights over a level grid, for collision and for drawing: the same numbers give the
// same triangles. A cell's two triangles meet on the diagonal from its corner (x, z) to (x + 1, z +
// 1).
typedef struct core_heights_data {
    uint32_t columns, rows; // points along +X and +Z, >= 2 each
    float step_x, step_z;   // m from point to point, > 0
    core_vec3 origin;       // where the first point is when its height is 0
    const float *height;    // [rows*columns] m, row by row: height[z * columns + x]
} core_heights_data;

typedef struct core_sound_data { // interleaved
    uint32_t channels, rate;     // 1..2; Hz
    uint32_t frame_count;
    const int16_t *sample; // [frame_count*channels]
} core_sound_data;

typedef struct core_material_data { // metallic-roughness, glTF 2.0 semantics
    char name[CORE_NAME_MAX];
    float base_color[4], emissive[3]; // linear
    float metallic, roughness, normal_scale, occlusion_strength, alpha_cutoff;
    int alpha_mode; // 0 opaque, 1 mask, 2 blend
    bool double_sided;
    char base_color_image[CORE_NAME_MAX], normal_image[CORE_NAME_MAX],
        metallic_roughness_image[CORE_NAME_MAX], occlusion_image[CORE_NAME_MAX],
        emissive_image[CORE_NAME_MAX]; // virtual paths, "" = none
} core_material_data;

#endif
