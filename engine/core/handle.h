// Handles: index + generation, 8 bytes, zero is null. A pool maps handles to dense rows, so that
// storage can be swap-removed while handles stay valid and stale ones are caught.
#ifndef CORE_HANDLE_H
#define CORE_HANDLE_H

#include "core/base.h"

// index is 1-based (0 = null). generation counts the uses of a slot, starting at 1. A slot that has
// been used 2^32 - 1 times is retired, so a stale handle never comes alive again.
typedef struct core_handle {
    uint32_t index;
    uint32_t generation;
} core_handle;

#define CORE_NULL_HANDLE ((core_handle){0, 0})
#define CORE_NO_ROW      UINT32_MAX

static inline bool core_handle_is_null(core_handle h) { return h.index == 0; }
static inline bool core_handle_equal(core_handle a, core_handle b) {
    return a.index == b.index && a.generation == b.generation;
}
static inline uint64_t core_handle_bits(core_handle h) {
    return (uint64_t)h.generation << 32 | h.index;
}

// Slots live in reserved address ranges (see memory.h) and never move.
typedef struct core_pool {
    uint32_t *generation;  // [slot] generation of the live or next handle, 0 = retired
    uint32_t *row;         // [slot] dense row, or the next free slot's index + 1 when free
    uint32_t *slot_of_row; // [row] slot that owns the row
    uint32_t count;        // live handles = dense rows
    uint32_t slots;        // slots ever used
    uint32_t free_head;    // index + 1 of the first free slot, 0 = none (LIFO order: deterministic)
    uint32_t capacity;
    uint32_t committed; // slots backed by memory
} core_pool;

// capacity: most handles that can be alive at once, 1 to 2^32 - 17. False (core_fail) when out of
// range or when the range cannot be reserved.
bool core_pool_init(core_pool *pool, uint32_t capacity);
void core_pool_release(core_pool *pool);

// Gives a handle for the new last row (row = old count). Null when full.
core_handle core_pool_add(core_pool *pool);
// Row of a live handle, CORE_NO_ROW for null, stale or foreign ones.
uint32_t core_pool_row(const core_pool *pool, core_handle h);
// Handle that owns a row < count.
core_handle core_pool_handle(const core_pool *pool, uint32_t row);
// Frees h. The last row moves into its place: *hole = the freed row, *last = the row that moved
// there (equal when none moved). False for stale handles.
bool core_pool_remove(core_pool *pool, core_handle h, uint32_t *hole, uint32_t *last);

// Makes every handle stale; slots come back in the order of their rows.
void core_pool_clear(core_pool *pool);
// Hash of index, generation, rows and free list: equal pools give equal handles for ever after.
uint64_t core_pool_hash(const core_pool *pool);

// Exact save and restore: index, generation, rows and free list. save_size gives the size for the
// pool's present state; restore refuses data of another size, with a wrong checksum or with links
// that do not fit, whole: the pool is then unchanged. `data` needs no alignment.
size_t core_pool_save_size(const core_pool *pool);
void core_pool_save(const core_pool *pool, void *out);
bool core_pool_restore(core_pool *pool, const void *data, size_t size);
// Live handles that a save claims to hold, unchecked; 0 when it is too short to say.
uint32_t core_pool_saved_count(const void *data, size_t size);

#endif
