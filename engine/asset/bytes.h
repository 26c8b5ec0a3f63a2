// Reading and writing little-endian bytes with one rule: nothing is read that is not there. A
// reader that ran out stays failed and gives zeros, so that a decoder checks once a section.
#ifndef ASSET_BYTES_H
#define ASSET_BYTES_H

#include "core/data.h"

typedef struct asset_reader {
    const uint8_t *at, *end;
    const char *path;
    bool failed;
} asset_reader;

asset_reader asset_reader_make(const void *bytes, size_t size, const char *path);
size_t asset_reader_left(const asset_reader *r);
const void *asset_read_bytes(asset_reader *r, size_t size); // NULL when short
uint32_t asset_read_u32(asset_reader *r);
float asset_read_f32(asset_reader *r);
void asset_read_f32s(asset_reader *r, float *out, size_t count);
// Copies a fixed 128-byte name, always terminated. False when it has no end inside.
bool asset_read_name(asset_reader *r, char out[CORE_NAME_MAX]);

// True when all are finite. A NaN or infinity fails with the path, the field and its index.
bool asset_check_finite(const char *path, const char *field, const float *value, size_t count);
// A rotation must have a length that can be normalised.
bool asset_check_rotation(const char *path, const char *field, uint32_t index, core_quat q);

typedef struct asset_writer {
    uint8_t *data;
    size_t size, capacity;
} asset_writer;
void asset_write(asset_writer *w, const void *bytes, size_t size);
void asset_write_u32(asset_writer *w, uint32_t v);
void asset_write_f32(asset_writer *w, float v);
void asset_write_name(asset_writer *w, const char *name); // 128 bytes, zero-filled, cut at 127

// One zeroed block from which arrays are cut, 16-byte aligned.
typedef struct asset_block {
    uint8_t *base;
    size_t size, used;
} asset_block;
static inline size_t asset_round(size_t bytes) { return (bytes + 15u) & ~(size_t)15u; }
asset_block asset_block_make(size_t size); // size: sum of asset_round(parts)
void *asset_block_take(asset_block *block, size_t bytes);

// Reads a virtual file and hands it to `decode`-like code: NULL + core_fail when it cannot be read.
struct core_vfs;
typedef void *asset_decode_fn(const void *bytes, size_t size, const char *path);
void *asset_load(struct core_vfs *vfs, const char *path, asset_decode_fn *decode);

#endif
