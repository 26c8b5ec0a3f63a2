// .cskel: bones with bind pose and inverse bind, parents first; see asset.h for the layout.
#include "asset/asset.h"
#include "asset/bytes.h"

#include <string.h>

#define SKELETON_MAGIC 0x314b5343u // "CSK1"
#define BONE_BYTES     (CORE_NAME_MAX + 4 + 3 * 4 + 4 * 4 + 3 * 4 + 16 * 4)

typedef struct bone_arrays {
    char (*name)[CORE_NAME_MAX];
    int32_t *parent;
    core_vec3 *translation, *scale;
    core_quat *rotation;
    core_mat4 *inverse_bind;
} bone_arrays;

static core_skeleton_data *allocate(uint32_t bones, bone_arrays *a) {
    size_t n = bones;
    asset_block block =
        asset_block_make(asset_round(sizeof(core_skeleton_data)) + asset_round(n * CORE_NAME_MAX) +
                         asset_round(n * 4) + 2 * asset_round(n * sizeof(core_vec3)) +
                         asset_round(n * sizeof(core_quat)) + asset_round(n * sizeof(core_mat4)));
    core_skeleton_data *s = asset_block_take(&block, sizeof *s);
    a->name = asset_block_take(&block, n * CORE_NAME_MAX);
    a->parent = asset_block_take(&block, n * 4);
    a->translation = asset_block_take(&block, n * sizeof(core_vec3));
    a->rotation = asset_block_take(&block, n * sizeof(core_quat));
    a->scale = asset_block_take(&block, n * sizeof(core_vec3));
    a->inverse_bind = asset_block_take(&block, n * sizeof(core_mat4));
    *s = (core_skeleton_data){.bone_count = bones,
                              .name = (const char(*)[CORE_NAME_MAX])a->name,
                              .parent = a->parent,
                              .translation = a->translation,
                              .rotation = a->rotation,
                              .scale = a->scale,
                              .inverse_bind = a->inverse_bind};
    return s;
}

static bool check_bone(const core_skeleton_data *s, uint32_t b, const char *path) {
    if (s->parent[b] < -1 || s->parent[b] >= (int32_t)b) {
        return core_fail("%s: skeleton: bone %u (%s) has parent %d; expected -1 or a bone before "
                         "it, which also rules out cycles",
                         path, b, s->name[b], s->parent[b]);
    }
    return asset_check_finite(path, "bind translation", &s->translation[b].x, 3) &&
           asset_check_finite(path, "bind scale", &s->scale[b].x, 3) &&
           asset_check_finite(path, "inverse bind", s->inverse_bind[b].m, 16) &&
           asset_check_rotation(path, "bind rotation of bone", b, s->rotation[b]);
}

static bool read_bone(asset_reader *r, const bone_arrays *a, uint32_t b) {
    if (!asset_read_name(r, a->name[b])) {
        return core_fail("%s: skeleton: the name of bone %u has no end within %d bytes", r->path, b,
                         CORE_NAME_MAX);
    }
    a->parent[b] = (int32_t)asset_read_u32(r);
    asset_read_f32s(r, &a->translation[b].x, 3);
    asset_read_f32s(r, &a->rotation[b].x, 4);
    asset_read_f32s(r, &a->scale[b].x, 3);
    asset_read_f32s(r, a->inverse_bind[b].m, 16);
    return true;
}

core_skeleton_data *asset_skeleton_decode(const void *bytes, size_t size, const char *path) {
    asset_reader r = asset_reader_make(bytes, size, path);
    if (asset_read_u32(&r) != SKELETON_MAGIC) {
        core_fail("%s: not a skeleton: expected it to begin with \"CSK1\"", r.path);
        return NULL;
    }
    uint32_t bones = asset_read_u32(&r);
    if (r.failed || bones == 0 || bones > ASSET_MAX_BONES ||
        asset_reader_left(&r) != (size_t)bones * BONE_BYTES) {
        core_fail("%s: skeleton: %u bones in %zu bytes; expected 1..%u bones of %d bytes each",
                  r.path, bones, asset_reader_left(&r), ASSET_MAX_BONES, BONE_BYTES);
        return NULL;
    }
    bone_arrays a;
    core_skeleton_data *s = allocate(bones, &a);
    for (uint32_t b = 0; b < bones; b++) {
        if (!read_bone(&r, &a, b) || !check_bone(s, b, r.path)) {
            core_free(s);
            return NULL;
        }
    }
    return s;
}

static void *decode_any(const void *bytes, size_t size, const char *path) {
    return asset_skeleton_decode(bytes, size, path);
}

core_skeleton_data *asset_skeleton_load(core_vfs *vfs, const char *path) {
    return asset_load(vfs, path, decode_any);
}

static void write_floats(asset_writer *w, const float *v, int count) {
    for (int i = 0; i < count; i++) {
        asset_write_f32(w, v[i]);
    }
}

void *asset_skeleton_encode(const core_skeleton_data *s, size_t *size) {
    if (s->bone_count == 0 || s->bone_count > ASSET_MAX_BONES) {
        core_fail("skeleton to write: %u bones, expected 1..%u", s->bone_count, ASSET_MAX_BONES);
        return NULL;
    }
    asset_writer w = {0};
    asset_write_u32(&w, SKELETON_MAGIC);
    asset_write_u32(&w, s->bone_count);
    for (uint32_t b = 0; b < s->bone_count; b++) {
        if (!check_bone(s, b, "skeleton to write")) {
            core_free(w.data);
            return NULL;
        }
        asset_write_name(&w, s->name[b]);
        asset_write_u32(&w, (uint32_t)s->parent[b]);
        write_floats(&w, &s->translation[b].x, 3);
        write_floats(&w, &s->rotation[b].x, 4);
        write_floats(&w, &s->scale[b].x, 3);
        write_floats(&w, s->inverse_bind[b].m, 16);
    }
    *size = w.size;
    return w.data;
}
