#include "asset/bytes.h"

#include "core/vfs.h"

#include <string.h>

asset_reader asset_reader_make(const void *bytes, size_t size, const char *path) {
    const uint8_t *at = bytes;
    return (asset_reader){at, at + size, path ? path : "(memory)", false};
}

size_t asset_reader_left(const asset_reader *r) { return (size_t)(r->end - r->at); }

const void *asset_read_bytes(asset_reader *r, size_t size) {
    if (r->failed || asset_reader_left(r) < size) {
        r->failed = true;
        return NULL;
    }
    const void *p = r->at;
    r->at += size;
    return p;
}

static uint32_t load_u32(const uint8_t *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

uint32_t asset_read_u32(asset_reader *r) {
    const uint8_t *p = asset_read_bytes(r, 4);
    return p ? load_u32(p) : 0;
}

float asset_read_f32(asset_reader *r) {
    uint32_t bits = asset_read_u32(r);
    float v;
    memcpy(&v, &bits, 4);
    return v;
}

void asset_read_f32s(asset_reader *r, float *out, size_t count) {
    for (size_t i = 0; i < count; i++) {
        out[i] = asset_read_f32(r);
    }
}

bool asset_read_name(asset_reader *r, char out[CORE_NAME_MAX]) {
    const char *p = asset_read_bytes(r, CORE_NAME_MAX);
    memset(out, 0, CORE_NAME_MAX);
    if (!p || !memchr(p, 0, CORE_NAME_MAX)) {
        return false;
    }
    memcpy(out, p, strlen(p));
    return true;
}

// By the exponent bits: stays true under any floating-point flags.
static bool is_finite(float v) {
    uint32_t bits;
    memcpy(&bits, &v, 4);
    return (bits & 0x7f800000u) != 0x7f800000u;
}

bool asset_check_finite(const char *path, const char *field, const float *value, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (!is_finite(value[i])) {
            return core_fail("%s: %s: number %zu is not finite; export the file again", path, field,
                             i);
        }
    }
    return true;
}

bool asset_check_rotation(const char *path, const char *field, uint32_t index, core_quat q) {
    float n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (!(n > 1e-12f) || !is_finite(n)) {
        return core_fail("%s: %s %u: the rotation (%g, %g, %g, %g) has no direction; expected a "
                         "unit quaternion",
                         path, field, index, q.x, q.y, q.z, q.w);
    }
    return true;
}

void asset_write(asset_writer *w, const void *bytes, size_t size) {
    if (w->size + size > w->capacity) {
        size_t capacity = w->capacity ? w->capacity : 256;
        while (capacity < w->size + size) {
            capacity *= 2;
        }
        w->data = core_realloc(w->data, w->capacity, capacity);
        w->capacity = capacity;
    }
    if (size) {
        memcpy(w->data + w->size, bytes, size);
    }
    w->size += size;
}

void asset_write_u32(asset_writer *w, uint32_t v) {
    uint8_t b[4] = {(uint8_t)v, (uint8_t)(v >> 8), (uint8_t)(v >> 16), (uint8_t)(v >> 24)};
    asset_write(w, b, 4);
}

void asset_write_f32(asset_writer *w, float v) {
    uint32_t bits;
    memcpy(&bits, &v, 4);
    asset_write_u32(w, bits);
}

void asset_write_name(asset_writer *w, const char *name) {
    char text[CORE_NAME_MAX] = {0};
    for (size_t i = 0; name && name[i] && i + 1 < CORE_NAME_MAX; i++) {
        text[i] = name[i];
    }
    asset_write(w, text, CORE_NAME_MAX);
}

asset_block asset_block_make(size_t size) { return (asset_block){core_alloc(size), size, 0}; }

void *asset_block_take(asset_block *block, size_t bytes) {
    void *p = block->base + block->used;
    block->used += asset_round(bytes);
    CORE_ASSERT(block->used <= block->size);
    return p;
}

void *asset_load(struct core_vfs *vfs, const char *path, asset_decode_fn *decode) {
    size_t size = 0;
    void *bytes = core_vfs_read(vfs, path, &size);
    if (!bytes) {
        return NULL;
    }
    void *result = decode(bytes, size, path);
    core_free(bytes);
    return result;
}
