#include "core/memory.h"

#include <string.h>

#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

void setUp(void) { core_log_set_level(CORE_LOG_ERROR + 1); }
void tearDown(void) {}

static void a_range_is_zero_and_never_moves(void) {
    size_t size = (size_t)1 << 30;
    uint8_t *base = core_reserve(size);
    TEST_ASSERT_NOT_NULL(base);
    for (size_t bytes = 1; bytes < 1 << 20; bytes *= 3) {
        TEST_ASSERT_TRUE(core_commit(base, bytes));
        TEST_ASSERT_TRUE(core_commit(base, bytes)); // idempotent
        TEST_ASSERT_EQUAL_UINT8(0, base[bytes - 1]);
        base[bytes - 1] = 7;
        TEST_ASSERT_EQUAL_UINT8(7, base[0]);
    }
    TEST_ASSERT_TRUE(core_commit(base + size - 1, 1));
    base[size - 1] = 1;
    TEST_ASSERT_TRUE(core_commit(base, 0));
    core_unreserve(base, size);
    core_unreserve(NULL, 0);
    TEST_ASSERT_NULL(core_reserve((size_t)1 << 62));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "cannot reserve 4611686018427387904 bytes"));
}

static void an_arena_bumps_aligned(void) {
    core_arena arena;
    TEST_ASSERT_TRUE(core_arena_init(&arena, "test", 1 << 20));
    uint64_t before = core_alloc_count();
    uint8_t *a = core_arena_alloc(&arena, 1, "a");
    uint8_t *b = core_arena_alloc(&arena, 65, "b");
    float *c = CORE_ARENA_ARRAY(&arena, float, 100);
    TEST_ASSERT_EQUAL_UINT64(0, (uintptr_t)a % 64);
    TEST_ASSERT_EQUAL_INT(64, b - a);
    TEST_ASSERT_EQUAL_INT(128, (uint8_t *)c - b);
    TEST_ASSERT_EQUAL_UINT64(64 + 128 + 448, arena.used);
    TEST_ASSERT_NOT_NULL(core_arena_alloc(&arena, 0, "nothing"));
    size_t mark = core_arena_mark(&arena);
    uint8_t *d = core_arena_alloc(&arena, 1000, "d");
    core_arena_rewind(&arena, mark);
    TEST_ASSERT_TRUE(core_arena_alloc(&arena, 1000, "again") == d);
    core_arena_reset(&arena);
    TEST_ASSERT_TRUE(core_arena_alloc(&arena, 1, "a") == a);
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
    TEST_ASSERT_EQUAL_UINT64(64 + 128 + 448 + 64 + 1024, arena.high_water);
    core_arena_release(&arena);
    TEST_ASSERT_NULL(arena.base);
}

static void a_full_arena_falls_to_the_heap_then_grows(void) {
    core_arena arena;
    TEST_ASSERT_TRUE(core_arena_init(&arena, "small", 4096));
    uint64_t before = core_alloc_count();
    memset(core_arena_alloc(&arena, 4096, "fits"), 1, 4096);
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
    uint8_t *big = core_arena_alloc(&arena, 10000, "big");
    TEST_ASSERT_EQUAL_UINT64(0, (uintptr_t)big % 64);
    memset(big, 2, 10000);
    TEST_ASSERT_EQUAL_UINT64(before + 1, core_alloc_count());
    TEST_ASSERT_EQUAL_UINT64(10048, arena.overflow);
    TEST_ASSERT_EQUAL_UINT64(14144, arena.high_water);
    size_t mark = core_arena_mark(&arena);
    core_arena_alloc(&arena, 100, "more");
    core_arena_rewind(&arena, mark);
    TEST_ASSERT_EQUAL_UINT64(10048, arena.overflow);
    core_arena_rewind(&arena, 64); // back into the range: all of the heap is given back
    TEST_ASSERT_EQUAL_UINT64(0, arena.overflow);
    TEST_ASSERT_EQUAL_UINT64(64, arena.used);
    core_arena_reset(&arena);
    before = core_alloc_count();
    for (int step = 0; step < 10; ++step) { // the step that overflowed now fits
        memset(core_arena_alloc(&arena, 4096, "fits"), 1, 4096);
        memset(core_arena_alloc(&arena, 10000, "big"), 2, 10000);
        core_arena_reset(&arena);
    }
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
    core_arena_release(&arena);
}

// A random walk of allocations, marks and rewinds: blocks never overlap and keep their content.
static void a_random_walk_keeps_every_block(void) {
    enum { DEPTH = 200 };
    struct {
        uint8_t *at;
        size_t bytes, mark;
    } block[DEPTH];
    core_arena arena;
    TEST_ASSERT_TRUE(core_arena_init(&arena, "walk", 64 * 1024));
    core_rng rng = core_rng_make(11, 0);
    int count = 0;
    for (int step = 0; step < 20000; ++step) {
        if (count < DEPTH && core_rng_below(&rng, 100) < 97) {
            size_t mark = core_arena_mark(&arena);
            size_t bytes = 1 + core_rng_below(&rng, 2000);
            block[count].mark = mark;
            block[count].bytes = bytes;
            block[count].at = core_arena_alloc(&arena, bytes, "block");
            memset(block[count].at, count + 1, bytes);
            ++count;
        } else if (count) {
            count = (int)core_rng_below(&rng, (uint32_t)count);
            core_arena_rewind(&arena, block[count].mark);
            TEST_ASSERT_EQUAL_UINT64(block[count].mark, core_arena_mark(&arena));
        }
        if (count) {
            int i = (int)core_rng_below(&rng, (uint32_t)count);
            TEST_ASSERT_EACH_EQUAL_UINT8(i + 1, block[i].at, block[i].bytes);
        }
    }
    TEST_ASSERT_TRUE(arena.high_water > arena.reserved); // the heap took part
    core_arena_release(&arena);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_range_is_zero_and_never_moves);
    RUN_TEST(an_arena_bumps_aligned);
    RUN_TEST(a_full_arena_falls_to_the_heap_then_grows);
    RUN_TEST(a_random_walk_keeps_every_block);
    return UNITY_END();
}
