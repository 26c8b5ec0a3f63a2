// Structure-of-arrays storage of record. A set is declared once by an X-macro and gets: one
// 64-byte-aligned array per field in a reserved range that never moves (padded to CORE_LANES),
// handles (core_pool), swap-removal, hashes per column and per row, save and restore.
//
// #define PHYS_BODY_COLUMNS(X) X(float, px, CORE_COLUMN_STATE) X(float, scratch, 0)
// CORE_COLUMNS_DECLARE(phys_bodies, PHYS_BODY_COLUMNS)   // header: struct and _init prototype
// CORE_COLUMNS_DEFINE(phys_bodies, PHYS_BODY_COLUMNS)    // one .c file
//
// gives `phys_bodies` with typed pointers `b.px[row]` and `b.set` (count, handles). Rows from count
// up to the next multiple of CORE_LANES are readable and writable padding: zero until a kernel
// writes there, never hashed or saved.
#ifndef CORE_COLUMNS_H
#define CORE_COLUMNS_H

#include "core/data.h"
#include "core/handle.h"

#define CORE_COLUMNS_MAX 64
// The column is simulation state: it is hashed, saved, restored. Without it: scratch or cache.
#define CORE_COLUMN_STATE 1u

typedef struct core_column {
    const char *name;
    uint32_t size; // bytes per element
    uint32_t flags;
    char kind; // how text shows it: 'f' floats, 'd' doubles, 'u' words, 'b' bytes, 'x' or 0 neither
} core_column;

typedef struct core_columns {
    const char *name; // "phys.bodies": names the objects in a replay's divergence report
    const core_column *column;
    uint32_t column_count;
    core_pool pool;     // rows [0, pool.count)
    uint32_t committed; // rows backed by memory, a multiple of CORE_LANES
    void *base;         // private: the reserved range
    void *data[CORE_COLUMNS_MAX];
} core_columns;

// name and column are borrowed. False + core_fail for bad counts or when no range can be reserved.
bool core_columns_init(core_columns *set, const char *name, const core_column *column,
                       uint32_t column_count, uint32_t capacity);
void core_columns_release(core_columns *set);
static inline uint32_t core_columns_count(const core_columns *set) { return set->pool.count; }

// Adds a row, zero in every column; its row number is count - 1 after the call. Null + core_fail
// when full.
core_handle core_columns_add(core_columns *set);
// Removes by swap with the last row, whose old place becomes zero. False + core_fail for stale
// handles. *hole and *last as in core_pool_remove (either may be NULL).
bool core_columns_remove(core_columns *set, core_handle h, uint32_t *hole, uint32_t *last);
uint32_t core_columns_row(const core_columns *set, core_handle h);
core_handle core_columns_handle(const core_columns *set, uint32_t row);
void core_columns_clear(core_columns *set);
// Bytes committed (for metrics `memory`).
size_t core_columns_bytes(const core_columns *set);

// out[column_count]: 64-bit hash of each STATE column over rows [0, count) (0 for others). Hashes
// bits, so -0 and 0 differ and NaN is stable.
void core_columns_hash(const core_columns *set, uint64_t *out);
// out[count]: 16-bit checksum of each row over all STATE columns: finds the diverged object.
void core_columns_row_hash(const core_columns *set, uint16_t *out);

// Exact save (STATE columns, handles, free list). restore refuses data that is truncated, corrupt
// or of other columns, whole: the set is then unchanged. Other columns become zero: their owner
// fills caches again. Little-endian; `data` needs no alignment.
size_t core_columns_save_size(const core_columns *set);
void core_columns_save(const core_columns *set, void *out);
bool core_columns_restore(core_columns *set, const void *data, size_t size);

// The parts of what core_columns_save gave: the STATE columns one after another (the result), then
// the handles. And a restore from such parts, checked in the same way.
typedef struct core_columns_part {
    uint32_t count;
    size_t handles_size;
} core_columns_part;
const uint8_t *core_columns_saved(const core_columns *set, const void *data,
                                  core_columns_part *out);
bool core_columns_restore_parts(core_columns *set, uint32_t count, const void *values,
                                const void *handles, size_t handles_size);

#define CORE_COLUMN_FIELD_(type, name, flags) type *name;
#define CORE_COLUMN_KIND(type)                                                                     \
    _Generic((type *)0, float *: 'f', core_vec3 *: 'f', core_quat *: 'f', double *: 'd',           \
        uint32_t *: 'u', core_handle *: 'u', uint8_t *: 'b', default: 'x')
#define CORE_COLUMN_DESC_(type, name, flags)                                                       \
    {#name, (uint32_t)sizeof(type), (flags), CORE_COLUMN_KIND(type)},
#define CORE_COLUMN_BIND_(type, name, flags) self->name = (type *)self->set.data[i++];

#define CORE_COLUMNS_DECLARE(T, LIST)                                                              \
    typedef struct T {                                                                             \
        core_columns set;                                                                          \
        LIST(CORE_COLUMN_FIELD_)                                                                   \
    } T;                                                                                           \
    bool T##_init(T *self, const char *name, uint32_t capacity);

#define CORE_COLUMNS_DEFINE(T, LIST)                                                               \
    bool T##_init(T *self, const char *name, uint32_t capacity) {                                  \
        static const core_column desc[] = {LIST(CORE_COLUMN_DESC_)};                               \
        if (!core_columns_init(&self->set, name, desc, CORE_COUNT_OF(desc), capacity)) {           \
            return false;                                                                          \
        }                                                                                          \
        uint32_t i = 0;                                                                            \
        LIST(CORE_COLUMN_BIND_)                                                                    \
        return true;                                                                               \
    }

#endif
