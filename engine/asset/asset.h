// Files to plain data and back (design page 7): the engine's own little-endian formats, images and
// sounds. Every decoder takes untrusted bytes: sizes are checked before use, numbers must be
// finite, and a file is refused whole with one line that names it, the field and what was expected.
//
// Each result is one block (struct and arrays together): free it with core_free. `path` in the
// decoders is only the name that errors use.
#ifndef ASSET_ASSET_H
#define ASSET_ASSET_H

#include "core/data.h"
#include "core/vfs.h"

// Limits that no honest file reaches; they keep hostile counts from reserving memory.
#define ASSET_MAX_VERTICES (1u << 26)
#define ASSET_MAX_INDICES  (1u << 28)
#define ASSET_MAX_BONES    4096u
#define ASSET_MAX_KEYS     (1u << 24) // of one clip, all tracks together

// ---- meshes: .cmesh, "CMS1" ----
// u32 magic, vertices, indices, stream flags, bones (0 = not skinned); aabb 6 f32; then position,
// normal, tangent, uv, colour, joint (u16x4), weight (f32x4) as flagged, index u32.
core_mesh_data *asset_mesh_decode(const void *bytes, size_t size, const char *path);
core_mesh_data *asset_mesh_load(core_vfs *vfs, const char *path);
// bone_count: of the skeleton that `joint` indexes. Free the result with core_free; NULL +
// core_fail when the mesh itself breaks the rules that the decoder checks.
void *asset_mesh_encode(const core_mesh_data *mesh, uint32_t bone_count, size_t *size);

// ---- skeletons: .cskel, "CSK1" ----
// u32 magic, bones; per bone: name char[128], parent i32 (-1 root, else < own index), translation
// 3 f32, rotation xyzw 4 f32, scale 3 f32, inverse bind 16 f32 (column-major).
core_skeleton_data *asset_skeleton_decode(const void *bytes, size_t size, const char *path);
core_skeleton_data *asset_skeleton_load(core_vfs *vfs, const char *path);
void *asset_skeleton_encode(const core_skeleton_data *skeleton, size_t *size);

// ---- clips: .canim, "CAN1" (layout of the report's fig. 13, design page 7) ----
// Reads "CAN1" only; compressed clips are the anim room's own (anim_clip_pack).
core_clip_data *asset_clip_decode(const void *bytes, size_t size, const char *path);
core_clip_data *asset_clip_load(core_vfs *vfs, const char *path);
void *asset_clip_encode(const core_clip_data *clip, size_t *size);

// ---- models: .cmodel, JSON text that names the parts ----
typedef struct asset_model_mesh {
    char path[CORE_NAME_MAX]; // virtual, next to the model file
    int32_t material;         // index into materials, -1 none
    bool skinned;
} asset_model_mesh;
typedef struct asset_model_clip {
    char name[CORE_NAME_MAX], path[CORE_NAME_MAX];
} asset_model_clip;
typedef struct asset_model {
    uint32_t mesh_count, material_count, clip_count;
    asset_model_mesh *mesh;
    core_material_data *material;
    asset_model_clip *clip;
    char skeleton[CORE_NAME_MAX]; // "" none
} asset_model;
asset_model *asset_model_decode(const void *bytes, size_t size, const char *path);
asset_model *asset_model_load(core_vfs *vfs, const char *path);
char *asset_model_encode(const asset_model *model, size_t *size); // paths are written as file names

// Converts a model of any format (real path) into a folder of engine files named after it, through
// libcorsac-convert.so. False + core_fail when that is not installed or the file cannot be read.
bool asset_import(const char *source, const char *out_dir);

// ---- images and sounds ----
// PNG, JPEG, TGA, BMP, HDR through stb_image. CORE_IMAGE_RGBA32F decodes to linear floats.
core_image_data *asset_image_decode(const void *bytes, size_t size, const char *path,
                                    core_image_format format);
core_image_data *asset_image_load(core_vfs *vfs, const char *path, core_image_format format);
// Heights from the grey of an image, of 8 or 16 bits: black is `low`, white `high` (m), the first
// row of the image the first along Z. 2 to 8193 pixels a side; steps are 1 m, the origin 0.
core_heights_data *asset_heights_decode(const void *bytes, size_t size, const char *path, float low,
                                        float high);
core_heights_data *asset_heights_load(core_vfs *vfs, const char *path, float low, float high);
// WAV: PCM 8, 16, 24, 32 bit and 32-bit float; Ogg Vorbis, whose pages' checksums must agree and
// which a child process decodes, so that no file can end the program. 1 or 2 channels,
// 1000..192000 Hz.
core_sound_data *asset_sound_decode(const void *bytes, size_t size, const char *path);
core_sound_data *asset_sound_load(core_vfs *vfs, const char *path);
void *asset_sound_encode(const core_sound_data *sound, size_t *size); // 16-bit PCM WAV

#endif
