// .cmesh: one triangle mesh, see asset.h for the layout.
#include "asset/asset.h"
#include "asset/bytes.h"

#include <string.h>

enum { NORMAL = 1, TANGENT = 2, UV = 4, COLOR = 8, SKIN = 16, ALL_STREAMS = 31 };
#define MESH_MAGIC 0x31534d43u // "CMS1"
#define MESH_HEAD  (5 * 4 + 6 * 4)

typedef struct mesh_head {
    uint32_t vertices, indices, flags, bones;
    core_aabb bounds;
} mesh_head;

static size_t vertex_floats(uint32_t flags) {
    return 3u + (flags & NORMAL ? 3u : 0u) + (flags & TANGENT ? 4u : 0u) + (flags & UV ? 2u : 0u) +
           (flags & COLOR ? 4u : 0u) + (flags & SKIN ? 4u : 0u);
}

static size_t body_size(const mesh_head *h) {
    size_t vertex = vertex_floats(h->flags) * 4 + (h->flags & SKIN ? 8u : 0u);
    return vertex * h->vertices + 4 * (size_t)h->indices;
}

static bool read_head(asset_reader *r, mesh_head *h) {
    if (asset_read_u32(r) != MESH_MAGIC) {
        return core_fail("%s: not a mesh: expected it to begin with \"CMS1\"", r->path);
    }
    h->vertices = asset_read_u32(r);
    h->indices = asset_read_u32(r);
    h->flags = asset_read_u32(r);
    h->bones = asset_read_u32(r);
    asset_read_f32s(r, &h->bounds.min.x, 3);
    asset_read_f32s(r, &h->bounds.max.x, 3);
    if (r->failed) {
        return core_fail("%s: mesh: cut off inside the header of %d bytes", r->path, MESH_HEAD);
    }
    if (h->vertices == 0 || h->vertices > ASSET_MAX_VERTICES || h->indices > ASSET_MAX_INDICES ||
        h->indices % 3 != 0) {
        return core_fail("%s: mesh: %u vertices and %u indices; expected 1..%u and a multiple of 3",
                         r->path, h->vertices, h->indices, ASSET_MAX_VERTICES);
    }
    if (h->flags & ~(uint32_t)ALL_STREAMS || (h->bones > 0) != ((h->flags & SKIN) != 0) ||
        h->bones > ASSET_MAX_BONES) {
        return core_fail("%s: mesh: stream flags 0x%x with %u bones do not fit", r->path, h->flags,
                         h->bones);
    }
    if (asset_reader_left(r) != body_size(h)) {
        return core_fail("%s: mesh: %zu bytes of streams, expected %zu for %u vertices", r->path,
                         asset_reader_left(r), body_size(h), h->vertices);
    }
    return true;
}

static const float *read_stream(asset_reader *r, asset_block *block, bool present, size_t floats,
                                uint32_t vertices) {
    if (!present) {
        return NULL;
    }
    float *out = asset_block_take(block, floats * vertices * 4);
    asset_read_f32s(r, out, floats * vertices);
    return out;
}

static const uint16_t *read_joints(asset_reader *r, asset_block *block, uint32_t vertices) {
    uint16_t *out = asset_block_take(block, (size_t)vertices * 8);
    const uint8_t *p = asset_read_bytes(r, (size_t)vertices * 8);
    for (size_t i = 0; p && i < (size_t)vertices * 4; i++) {
        out[i] = (uint16_t)(p[2 * i] | p[2 * i + 1] << 8);
    }
    return out;
}

static core_mesh_data *read_streams(asset_reader *r, const mesh_head *h) {
    size_t v = h->vertices;
    size_t total = asset_round(sizeof(core_mesh_data)) + 8 * 16 +
                   v * (vertex_floats(h->flags) * 4 + 8) + 4 * (size_t)h->indices + 16;
    asset_block block = asset_block_make(total);
    core_mesh_data *m = asset_block_take(&block, sizeof *m);
    m->vertex_count = h->vertices;
    m->index_count = h->indices;
    m->bounds = h->bounds;
    m->position = read_stream(r, &block, true, 3, h->vertices);
    m->normal = read_stream(r, &block, h->flags & NORMAL, 3, h->vertices);
    m->tangent = read_stream(r, &block, h->flags & TANGENT, 4, h->vertices);
    m->uv = read_stream(r, &block, h->flags & UV, 2, h->vertices);
    m->color = read_stream(r, &block, h->flags & COLOR, 4, h->vertices);
    m->joint = h->flags & SKIN ? read_joints(r, &block, h->vertices) : NULL;
    m->weight = read_stream(r, &block, h->flags & SKIN, 4, h->vertices);
    uint32_t *index = asset_block_take(&block, 4 * (size_t)h->indices);
    for (uint32_t i = 0; i < h->indices; i++) {
        index[i] = asset_read_u32(r);
    }
    m->index = index;
    return m;
}

static bool check_skin(const core_mesh_data *m, uint32_t bones, const char *path) {
    for (uint32_t v = 0; m->joint && v < m->vertex_count; v++) {
        float sum = 0;
        for (int k = 0; k < 4; k++) {
            float w = m->weight[4 * v + k];
            if (m->joint[4 * v + k] >= bones || !(w >= 0)) {
                return core_fail("%s: mesh: vertex %u: bone %u with weight %g; expected a bone "
                                 "below %u and a weight >= 0",
                                 path, v, m->joint[4 * v + k], w, bones);
            }
            sum += w;
        }
        if (!(sum > 0.999f && sum < 1.001f)) {
            return core_fail("%s: mesh: vertex %u: weights sum to %g, expected 1", path, v, sum);
        }
    }
    return true;
}

static bool check_mesh(const core_mesh_data *m, uint32_t bones, const char *path) {
    const struct {
        const char *name;
        const float *data;
        size_t floats;
    } stream[] = {{"position", m->position, 3}, {"normal", m->normal, 3},
                  {"tangent", m->tangent, 4},   {"uv", m->uv, 2},
                  {"colour", m->color, 4},      {"weight", m->weight, 4}};
    for (size_t i = 0; i < CORE_COUNT_OF(stream); i++) {
        if (stream[i].data && !asset_check_finite(path, stream[i].name, stream[i].data,
                                                  stream[i].floats * m->vertex_count)) {
            return false;
        }
    }
    if (!asset_check_finite(path, "bounds", &m->bounds.min.x, 3) ||
        !asset_check_finite(path, "bounds", &m->bounds.max.x, 3)) {
        return false;
    }
    for (uint32_t i = 0; i < m->index_count; i++) {
        if (m->index[i] >= m->vertex_count) {
            return core_fail("%s: mesh: index %u is %u, expected below %u vertices", path, i,
                             m->index[i], m->vertex_count);
        }
    }
    return check_skin(m, bones, path);
}

core_mesh_data *asset_mesh_decode(const void *bytes, size_t size, const char *path) {
    asset_reader r = asset_reader_make(bytes, size, path);
    mesh_head head;
    if (!read_head(&r, &head)) {
        return NULL;
    }
    core_mesh_data *m = read_streams(&r, &head);
    if (!check_mesh(m, head.bones, r.path)) {
        core_free(m);
        return NULL;
    }
    return m;
}

static void *decode_any(const void *bytes, size_t size, const char *path) {
    return asset_mesh_decode(bytes, size, path);
}

core_mesh_data *asset_mesh_load(core_vfs *vfs, const char *path) {
    return asset_load(vfs, path, decode_any);
}

static void write_floats(asset_writer *w, const float *data, size_t count) {
    for (size_t i = 0; data && i < count; i++) {
        asset_write_f32(w, data[i]);
    }
}

static void write_joints(asset_writer *w, const core_mesh_data *m) {
    for (size_t i = 0; m->joint && i < (size_t)m->vertex_count * 4; i++) {
        uint8_t b[2] = {(uint8_t)m->joint[i], (uint8_t)(m->joint[i] >> 8)};
        asset_write(w, b, 2);
    }
}

void *asset_mesh_encode(const core_mesh_data *m, uint32_t bone_count, size_t *size) {
    if (!check_mesh(m, bone_count, "mesh to write")) {
        return NULL;
    }
    asset_writer w = {0};
    uint32_t flags = (m->normal ? NORMAL : 0u) | (m->tangent ? TANGENT : 0u) | (m->uv ? UV : 0u) |
                     (m->color ? COLOR : 0u) | (m->joint ? SKIN : 0u);
    asset_write_u32(&w, MESH_MAGIC);
    asset_write_u32(&w, m->vertex_count);
    asset_write_u32(&w, m->index_count);
    asset_write_u32(&w, flags);
    asset_write_u32(&w, m->joint ? bone_count : 0);
    write_floats(&w, &m->bounds.min.x, 3);
    write_floats(&w, &m->bounds.max.x, 3);
    size_t v = m->vertex_count;
    write_floats(&w, m->position, 3 * v);
    write_floats(&w, m->normal, 3 * v);
    write_floats(&w, m->tangent, 4 * v);
    write_floats(&w, m->uv, 2 * v);
    write_floats(&w, m->color, 4 * v);
    write_joints(&w, m);
    write_floats(&w, m->joint ? m->weight : NULL, 4 * v);
    for (uint32_t i = 0; i < m->index_count; i++) {
        asset_write_u32(&w, m->index[i]);
    }
    *size = w.size;
    return w.data;
}
