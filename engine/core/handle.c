#include "core/handle.h"

#include <string.h>

#include "core/hash.h"
#include "core/memory.h"

#define POOL_MAGIC  0x314c5043u // "CPL1"
#define POOL_FIRST  64u
#define POOL_ARRAYS 3
#define POOL_MAX    (UINT32_MAX - CORE_LANES)

// The three arrays lie one after the other in one reserved range.
static size_t range_bytes(const core_pool *pool) {
    return (size_t)pool->capacity * sizeof(uint32_t) * POOL_ARRAYS;
}

bool core_pool_init(core_pool *pool, uint32_t capacity) {
    *pool = (core_pool){0};
    if (capacity == 0 || capacity > POOL_MAX) {
        return core_fail("handle pool: capacity %u is out of range, expected 1 to %u", capacity,
                         POOL_MAX);
    }
    pool->capacity = capacity;
    uint32_t *base = core_reserve(range_bytes(pool));
    if (!base) {
        pool->capacity = 0;
        return false;
    }
    pool->generation = base;
    pool->row = base + capacity;
    pool->slot_of_row = base + (size_t)capacity * 2;
    return true;
}

void core_pool_release(core_pool *pool) {
    core_unreserve(pool->generation, range_bytes(pool));
    *pool = (core_pool){0};
}

static bool commit_slots(core_pool *pool, uint32_t slots) {
    if (slots <= pool->committed) {
        return true;
    }
    uint64_t grown = CORE_MAX((uint64_t)pool->committed / 8 * 9, POOL_FIRST);
    uint32_t wanted = (uint32_t)CORE_MIN(CORE_MAX(grown, slots), pool->capacity);
    size_t bytes = (size_t)wanted * sizeof(uint32_t);
    if (!core_commit(pool->generation, bytes) || !core_commit(pool->row, bytes) ||
        !core_commit(pool->slot_of_row, bytes)) {
        return false;
    }
    pool->committed = wanted;
    return true;
}

core_handle core_pool_add(core_pool *pool) {
    uint32_t slot;
    if (pool->free_head) {
        slot = pool->free_head - 1;
        pool->free_head = pool->row[slot];
    } else {
        if (pool->slots == pool->capacity || !commit_slots(pool, pool->slots + 1)) {
            return CORE_NULL_HANDLE;
        }
        slot = pool->slots++;
        pool->generation[slot] = 1;
    }
    pool->row[slot] = pool->count;
    pool->slot_of_row[pool->count++] = slot;
    return (core_handle){slot + 1, pool->generation[slot]};
}

uint32_t core_pool_row(const core_pool *pool, core_handle h) {
    if (h.index == 0 || h.index > pool->slots) {
        return CORE_NO_ROW;
    }
    uint32_t slot = h.index - 1;
    uint32_t row = pool->row[slot];
    // A free slot's `row` is a link; it may be a valid row, but one that another slot owns.
    bool live = row < pool->count && pool->slot_of_row[row] == slot;
    return live && pool->generation[slot] == h.generation ? row : CORE_NO_ROW;
}

core_handle core_pool_handle(const core_pool *pool, uint32_t row) {
    if (row >= pool->count) {
        return CORE_NULL_HANDLE;
    }
    uint32_t slot = pool->slot_of_row[row];
    return (core_handle){slot + 1, pool->generation[slot]};
}

// Ends the slot's present use. A slot whose generations are used up is never given out again, so a
// stale handle cannot come alive however old it is.
static void free_slot(core_pool *pool, uint32_t slot) {
    pool->generation[slot]++;
    if (pool->generation[slot] == 0) {
        pool->row[slot] = CORE_NO_ROW;
        return;
    }
    pool->row[slot] = pool->free_head;
    pool->free_head = slot + 1;
}

bool core_pool_remove(core_pool *pool, core_handle h, uint32_t *hole, uint32_t *last) {
    uint32_t row = core_pool_row(pool, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    uint32_t end = --pool->count;
    uint32_t moved = pool->slot_of_row[end];
    pool->slot_of_row[row] = moved;
    pool->row[moved] = row;
    free_slot(pool, h.index - 1);
    if (hole) {
        *hole = row;
    }
    if (last) {
        *last = end;
    }
    return true;
}

void core_pool_clear(core_pool *pool) {
    while (pool->count) {
        free_slot(pool, pool->slot_of_row[--pool->count]);
    }
}

uint64_t core_pool_hash(const core_pool *pool) {
    uint64_t h = core_hash(pool->generation, pool->slots * sizeof(uint32_t), pool->free_head);
    h = core_hash(pool->row, pool->slots * sizeof(uint32_t), h);
    return core_hash(pool->slot_of_row, pool->count * sizeof(uint32_t), h);
}

typedef struct pool_header {
    uint32_t magic, count, slots, free_head;
    uint64_t checksum; // of the arrays that follow: generation[slots] row[slots] slot_of_row[count]
} pool_header;

static size_t arrays_bytes(uint32_t slots, uint32_t count) {
    return ((size_t)slots * 2 + count) * sizeof(uint32_t);
}

// Covers the header's numbers too.
static uint64_t saved_checksum(const pool_header *header, const void *arrays, size_t bytes) {
    uint64_t seed = core_hash(header, offsetof(pool_header, checksum), 0);
    return core_hash(arrays, bytes, seed);
}

size_t core_pool_save_size(const core_pool *pool) {
    return sizeof(pool_header) + arrays_bytes(pool->slots, pool->count);
}

void core_pool_save(const core_pool *pool, void *out) {
    pool_header header = {POOL_MAGIC, pool->count, pool->slots, pool->free_head, 0};
    uint8_t *arrays = (uint8_t *)out + sizeof header;
    size_t slot_bytes = pool->slots * sizeof(uint32_t);
    if (pool->slots) {
        memcpy(arrays, pool->generation, slot_bytes);
        memcpy(arrays + slot_bytes, pool->row, slot_bytes);
        memcpy(arrays + 2 * slot_bytes, pool->slot_of_row, pool->count * sizeof(uint32_t));
    }
    header.checksum = saved_checksum(&header, arrays, arrays_bytes(pool->slots, pool->count));
    memcpy(out, &header, sizeof header);
}

static uint32_t word_at(const uint8_t *array, uint32_t i) {
    uint32_t word;
    memcpy(&word, array + (size_t)i * sizeof word, sizeof word);
    return word;
}

// Checks that the arrays describe a pool: rows and slots point at each other, and the free list
// visits each remaining slot once. Distinctness needs no marks: two rows that claim one slot cannot
// both be its row, and a list that ends has no cycle. A retired slot cannot hide in the list, as
// its row is no link.
static bool arrays_are_sound(const pool_header *header, const uint8_t *arrays) {
    const uint8_t *generation = arrays;
    const uint8_t *row = generation + (size_t)header->slots * sizeof(uint32_t);
    const uint8_t *slot_of_row = row + (size_t)header->slots * sizeof(uint32_t);
    for (uint32_t r = 0; r < header->count; ++r) {
        uint32_t slot = word_at(slot_of_row, r);
        if (slot >= header->slots || word_at(row, slot) != r || word_at(generation, slot) == 0) {
            return false;
        }
    }
    uint32_t retired = 0;
    for (uint32_t slot = 0; slot < header->slots; ++slot) {
        bool used_up = word_at(generation, slot) == 0;
        if (used_up && word_at(row, slot) != CORE_NO_ROW) {
            return false;
        }
        retired += used_up;
    }
    if (retired > header->slots - header->count) {
        return false;
    }
    uint32_t link = header->free_head;
    for (uint32_t left = header->slots - header->count - retired; left; --left) {
        if (link == 0 || link > header->slots) {
            return false;
        }
        uint32_t next = word_at(row, link - 1);
        if (next < header->count && word_at(slot_of_row, next) == link - 1) {
            return false; // live, so not free
        }
        link = next;
    }
    return link == 0;
}

uint32_t core_pool_saved_count(const void *data, size_t size) {
    pool_header header;
    if (size < sizeof header) {
        return 0;
    }
    memcpy(&header, data, sizeof header);
    return header.count;
}

bool core_pool_restore(core_pool *pool, const void *data, size_t size) {
    pool_header header;
    if (size < sizeof header) {
        return core_fail("saved handles: %zu bytes are too few, expected at least %zu", size,
                         sizeof header);
    }
    memcpy(&header, data, sizeof header);
    if (header.magic != POOL_MAGIC) {
        return core_fail("saved handles: no handle pool (magic %08x, expected %08x)", header.magic,
                         POOL_MAGIC);
    }
    if (header.slots > pool->capacity || header.count > header.slots) {
        return core_fail("saved handles: %u live of %u slots do not fit a capacity of %u",
                         header.count, header.slots, pool->capacity);
    }
    size_t expected = sizeof header + arrays_bytes(header.slots, header.count);
    if (size != expected) {
        return core_fail("saved handles: %zu bytes, expected %zu for %u slots", size, expected,
                         header.slots);
    }
    const uint8_t *arrays = (const uint8_t *)data + sizeof header;
    if (saved_checksum(&header, arrays, size - sizeof header) != header.checksum ||
        !arrays_are_sound(&header, arrays)) {
        return core_fail("saved handles: corrupt (checksum or links are wrong)");
    }
    if (!commit_slots(pool, header.slots)) {
        return false;
    }
    size_t slot_bytes = header.slots * sizeof(uint32_t);
    if (header.slots) {
        memcpy(pool->generation, arrays, slot_bytes);
        memcpy(pool->row, arrays + slot_bytes, slot_bytes);
        memcpy(pool->slot_of_row, arrays + 2 * slot_bytes, header.count * sizeof(uint32_t));
    }
    pool->count = header.count;
    pool->slots = header.slots;
    pool->free_head = header.free_head;
    return true;
}
