// The converter: any model that assimp reads to the engine's files. One pass through these stages:
// import (assimp) -> skeleton -> clips -> meshes -> materials -> files and report.
#ifndef CONVERT_H
#define CONVERT_H

#include "asset/asset.h"
#include "core/json.h"

#include <assimp/material.h>
#include <assimp/scene.h>

// ---- what a caller gives (also the interface of libcorsac-convert.so) ----
typedef struct convert_options {
    const char *in, *out_dir;
    double scale;            // factor on lengths; 0: by the file's own unit
    double ticks_per_second; // where the file says 0; default 25
    double compress;         // m at the skin shell: clips become "CAN2"; 0: raw keys
    bool dry_run;            // report only
    bool quiet;              // no report on stdout, no progress
} convert_options;

// Exit code: 0 converted, 1 the file cannot be converted, 2 missing or unwritable file.
__attribute__((visibility("default"))) int corsac_convert_file(const char *in, const char *out_dir);
__attribute__((visibility("default"))) int corsac_convert(const convert_options *options);

// ---- matrices, double, row-major, columns are the axes (v' = M v) ----
typedef struct cv_mat {
    double m[4][4];
} cv_mat;
typedef struct cv_trs {
    double t[3], r[4], s[3]; // r: x y z w
} cv_trs;
cv_mat cv_identity(void);
cv_mat cv_from_ai(const struct aiMatrix4x4 *a);
cv_mat cv_mul(const cv_mat *a, const cv_mat *b);
bool cv_inverse(const cv_mat *a, cv_mat *out); // affine; false when singular
double cv_determinant(const cv_mat *a);        // of the linear part
cv_mat cv_compose(const cv_trs *p);
// Shear is lost; *shear (may be NULL) is the largest cosine between two axes.
cv_trs cv_decompose(const cv_mat *a, double *shear);
double cv_distance(const cv_mat *a, const cv_mat *b); // largest difference of entries

// ---- curves ----
typedef enum cv_mode { CV_STEP, CV_LINEAR, CV_CUBIC } cv_mode;
typedef struct cv_curve {
    uint32_t count, width; // 3, or 4 for rotations
    cv_mode mode;
    double *time;  // [count] seconds
    double *value; // [count * width]; cubic: [count * 3 * width] in-tangent, value, out-tangent
} cv_curve;
typedef struct cv_channel {
    const struct aiNode *node;
    cv_curve curve[3]; // translation, rotation, scale; count 0: the node's own
} cv_channel;
typedef struct cv_clip {
    char name[CORE_NAME_MAX];
    double duration;
    uint32_t channel_count;
    cv_channel *channel;
} cv_clip;
void cv_curve_sample(const cv_curve *c, double time, double *out);

// ---- the skeleton ----
typedef struct cv_bone {
    char name[CORE_NAME_MAX];
    const struct aiNode *node; // NULL: an extra bone for a second inverse bind
    int parent;
    cv_trs local;
    cv_mat model, inverse_bind;
    bool bound; // inverse_bind was set by a mesh
} cv_bone;

typedef struct cv_note { // one line of the report: what was changed or dropped, and why
    char kind[16], text[256];
} cv_note;

typedef struct cv_texture {
    char source[512]; // as named by the material
    char file[CORE_NAME_MAX];
} cv_texture;

typedef struct cv_model {
    const convert_options *options;
    const struct aiScene *scene;
    char name[64]; // of the output files
    double scale;
    cv_bone *bone;
    uint32_t bone_count, bone_capacity;
    cv_clip *clip;
    uint32_t clip_count;
    cv_note *note;
    uint32_t note_count, note_capacity;
    asset_model out;
    cv_texture *texture;
    uint32_t texture_count;
    uint64_t triangles, vertices, bytes;
    core_aabb bounds;
    bool failed;
} cv_model;

// Adds a line to the report; kinds: "changed", "dropped", "warning".
void cv_note_add(cv_model *m, const char *kind, const char *fmt, ...) CORE_PRINTF(3, 4);
bool cv_fail(cv_model *m, const char *fmt, ...) CORE_PRINTF(2, 3); // returns false
void cv_progress(const cv_model *m, const char *what, uint32_t done, uint32_t total);
// Writes OUT_DIR/name unless this is a dry run.
bool cv_write(cv_model *m, const char *name, const void *data, size_t size);
void *cv_read_file(const char *path, size_t *size); // core_free; NULL when it cannot be read
// "Armature|Run!" -> "Armature_Run": letters, digits, '-', '_'.
void cv_clean_name(const char *in, char *out, size_t size);
// Gives `base` itself or base_2, base_3, ...: the first that `taken` has not.
void cv_unique_name(char *name, size_t size, bool (*taken)(const void *ctx, const char *name),
                    const void *ctx);

// ---- stages; false after cv_fail ----
bool cv_is_helper(const struct aiNode *node); // FBX pivot node that assimp made
bool cv_skeleton_make(cv_model *m);
int cv_bone_of_node(const cv_model *m, const struct aiNode *node); // -1
int cv_bone_above(const cv_model *m, const struct aiNode *node);   // itself or nearest ancestor
cv_mat cv_node_global(const cv_model *m, const struct aiNode *node);
bool cv_skeleton_write(cv_model *m);
// The bones as plain data: one block, core_free it.
core_skeleton_data *cv_skeleton_data(const cv_model *m);
bool cv_clips_read(cv_model *m); // curves by assimp, or by the glTF itself
bool cv_clips_write(cv_model *m);
// Replaces what assimp read: it drops STEP and CUBICSPLINE. False when the file is no glTF or uses
// something this reader lacks (then a note says so).
bool cv_gltf_clips(cv_model *m);
bool cv_meshes_write(cv_model *m);
bool cv_materials_read(cv_model *m);
bool cv_finish(cv_model *m); // model file, Lua scene, report

#endif
