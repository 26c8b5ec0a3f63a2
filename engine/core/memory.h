// Reserved address ranges and arenas. A range is reserved once and committed as it grows: it never
// moves, untouched pages cost nothing.
#ifndef CORE_MEMORY_H
#define CORE_MEMORY_H

#include "core/base.h"

// Reserves `bytes` of address space (rounded up to pages), nothing committed. NULL + core_fail.
void *core_reserve(size_t bytes);
// Makes [base, base+bytes) usable and zero on first touch. Idempotent. False + core_fail.
bool core_commit(void *base, size_t bytes);
void core_unreserve(void *base, size_t bytes);

// A bump allocator over a reserved range. Persistent arenas live with their owner; frame arenas are
// reset each step. When the range is full, allocation falls to the heap (counted, freed at reset).
typedef struct core_arena {
    const char *name;
    uint8_t *base;
    size_t used, committed, reserved;
    size_t high_water;   // most bytes in use at once, heap overflow included
    size_t overflow;     // bytes now on the heap
    void *overflow_list; // private
} core_arena;

bool core_arena_init(core_arena *arena, const char *name, size_t reserve_bytes);
void core_arena_release(core_arena *arena);
// 64-byte aligned, not zeroed. Never NULL. `what` names the entry for reports.
void *core_arena_alloc(core_arena *arena, size_t bytes, const char *what);
// Stack discipline: everything allocated after mark is given back.
size_t core_arena_mark(const core_arena *arena);
void core_arena_rewind(core_arena *arena, size_t mark);
void core_arena_reset(core_arena *arena);

#define CORE_ARENA_ARRAY(arena, type, n)                                                           \
    ((type *)core_arena_alloc((arena), sizeof(type) * (size_t)(n), #type))

#endif
