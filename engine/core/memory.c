#include "core/memory.h"
#include "core/log.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

// Commits happen in these steps, so that a growing arena makes few system calls.
#define COMMIT_STEP ((size_t)64 * 1024)

#if defined(__SANITIZE_ADDRESS__)
#define CORE_HAS_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CORE_HAS_ASAN 1
#endif
#endif
#if defined(CORE_HAS_ASAN)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(address, bytes)   ((void)(address), (void)(bytes))
#define ASAN_UNPOISON_MEMORY_REGION(address, bytes) ((void)(address), (void)(bytes))
#endif

static size_t round_up(size_t bytes, size_t unit) { return (bytes + unit - 1) / unit * unit; }
static size_t page_size(void) { return (size_t)sysconf(_SC_PAGESIZE); }

void *core_reserve(size_t bytes) {
    void *base = mmap(NULL, round_up(bytes ? bytes : 1, page_size()), PROT_NONE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (base == MAP_FAILED) {
        core_fail("cannot reserve %zu bytes of address space: %s; raise the limit (ulimit -v) or "
                  "ask for less",
                  bytes, strerror(errno));
        return NULL;
    }
    return base;
}

bool core_commit(void *base, size_t bytes) {
    if (bytes == 0) {
        return true;
    }
    uintptr_t page = page_size();
    uintptr_t first = (uintptr_t)base / page * page;
    uintptr_t end = round_up((uintptr_t)base + bytes, page);
    if (mprotect((void *)first, end - first, PROT_READ | PROT_WRITE) != 0) {
        return core_fail("cannot commit %zu bytes of memory: %s", bytes, strerror(errno));
    }
    return true;
}

void core_unreserve(void *base, size_t bytes) {
    if (base) {
        munmap(base, round_up(bytes ? bytes : 1, page_size()));
    }
}

// Heap block of an arena whose range is full. `start` is the arena's position before it, so that
// marks order range and overflow alike.
typedef struct arena_overflow {
    struct arena_overflow *next;
    size_t start, bytes;
} arena_overflow;

bool core_arena_init(core_arena *arena, const char *name, size_t reserve_bytes) {
    *arena = (core_arena){.name = name};
    size_t reserved = round_up(reserve_bytes ? reserve_bytes : 1, page_size());
    arena->base = core_reserve(reserved);
    if (!arena->base) {
        return false;
    }
    arena->reserved = reserved;
    return true;
}

void core_arena_release(core_arena *arena) {
    core_arena_rewind(arena, 0);
    // The sanitizer's shadow outlives the mapping: the next owner of these addresses would inherit
    // it. Only what was committed was ever poisoned; the whole range would touch gigabytes of
    // shadow.
    ASAN_UNPOISON_MEMORY_REGION(arena->base, arena->committed);
    core_unreserve(arena->base, arena->reserved);
    *arena = (core_arena){0};
}

static void *alloc_overflow(core_arena *arena, size_t bytes, const char *what) {
    if (!arena->overflow_list) {
        core_log(CORE_LOG_DEBUG,
                 "arena '%s' is full (%zu bytes): '%s' of %zu bytes goes to the heap", arena->name,
                 arena->reserved, what, bytes);
    }
    arena_overflow *block = core_alloc(sizeof *block + CORE_ALIGN + bytes);
    block->next = arena->overflow_list;
    block->start = core_arena_mark(arena);
    block->bytes = bytes;
    arena->overflow_list = block;
    arena->overflow += bytes;
    return (void *)round_up((uintptr_t)(block + 1), CORE_ALIGN);
}

static bool commit_to(core_arena *arena, size_t end) {
    if (end <= arena->committed) {
        return true;
    }
    size_t wanted = CORE_MIN(round_up(end, COMMIT_STEP), arena->reserved);
    if (!core_commit(arena->base + arena->committed, wanted - arena->committed)) {
        return false;
    }
    ASAN_POISON_MEMORY_REGION(arena->base + arena->committed, wanted - arena->committed);
    arena->committed = wanted;
    return true;
}

void *core_arena_alloc(core_arena *arena, size_t bytes, const char *what) {
    size_t rounded = round_up(bytes ? bytes : 1, CORE_ALIGN);
    void *result;
    // Once something lies on the heap, all that follows does too: marks stay in stack order.
    if (arena->overflow_list || rounded > arena->reserved - arena->used ||
        !commit_to(arena, arena->used + rounded)) {
        result = alloc_overflow(arena, rounded, what);
    } else {
        result = arena->base + arena->used;
        arena->used += rounded;
        ASAN_UNPOISON_MEMORY_REGION(result, bytes);
    }
    arena->high_water = CORE_MAX(arena->high_water, core_arena_mark(arena));
    return result;
}

size_t core_arena_mark(const core_arena *arena) { return arena->used + arena->overflow; }

void core_arena_rewind(core_arena *arena, size_t mark) {
    CORE_ASSERT(mark <= core_arena_mark(arena));
    arena_overflow *block = arena->overflow_list;
    while (block && block->start >= mark) {
        arena_overflow *next = block->next;
        arena->overflow -= block->bytes;
        core_free(block);
        block = next;
    }
    arena->overflow_list = block;
    if (mark < arena->used) {
        ASAN_POISON_MEMORY_REGION(arena->base + mark, arena->used - mark);
        arena->used = mark;
    }
}

// An arena that overflowed gets a range that fits, now that nothing points into the old one: the
// next step like the last one allocates nothing.
static void grow_range(core_arena *arena) {
    size_t reserved = round_up(arena->high_water * 2, page_size());
    uint8_t *base = core_reserve(reserved);
    if (base) {
        core_unreserve(arena->base, arena->reserved);
        arena->base = base;
        arena->reserved = reserved;
        arena->committed = 0;
    }
}

void core_arena_reset(core_arena *arena) {
    core_arena_rewind(arena, 0);
    if (arena->high_water > arena->reserved) {
        grow_range(arena);
    }
}
