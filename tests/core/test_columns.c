#include "core/columns.h"

#include <stdlib.h>
#include <string.h>

#include "core/hash.h"
#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

typedef struct vec3 {
    float x, y, z;
} vec3;

#define THING_COLUMNS(X)                                                                           \
    X(float, mass, CORE_COLUMN_STATE)                                                              \
    X(vec3, place, CORE_COLUMN_STATE)                                                              \
    X(uint8_t, kind, CORE_COLUMN_STATE)                                                            \
    X(float, scratch, 0)                                                                           \
    X(uint64_t, id, CORE_COLUMN_STATE)
enum { MASS, PLACE, KIND, SCRATCH, ID, COLUMNS };

CORE_COLUMNS_DECLARE(things, THING_COLUMNS)
CORE_COLUMNS_DEFINE(things, THING_COLUMNS)

static things t;

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    TEST_ASSERT_TRUE(things_init(&t, "test.things", 1000));
}
void tearDown(void) { core_columns_release(&t.set); }

static core_handle add_thing(uint64_t id) {
    core_handle h = core_columns_add(&t.set);
    uint32_t row = core_columns_count(&t.set) - 1;
    t.mass[row] = (float)id * 0.5f;
    t.place[row] = (vec3){(float)id, 2, 3};
    t.kind[row] = (uint8_t)id;
    t.scratch[row] = -1;
    t.id[row] = id;
    return h;
}

static void expect_thing(uint32_t row, uint64_t id) {
    TEST_ASSERT_EQUAL_UINT64(id, t.id[row]);
    TEST_ASSERT_EQUAL_FLOAT((float)id * 0.5f, t.mass[row]);
    TEST_ASSERT_EQUAL_FLOAT((float)id, t.place[row].x);
    TEST_ASSERT_EQUAL_UINT8((uint8_t)id, t.kind[row]);
}

static void rows_are_aligned_zero_and_stay_put(void) {
    const void *before[] = {t.mass, t.place, t.kind, t.scratch, t.id};
    for (int c = 0; c < COLUMNS; ++c) {
        TEST_ASSERT_EQUAL_UINT64(0, (uintptr_t)before[c] % 64);
    }
    for (uint32_t i = 0; i < 1000; ++i) {
        core_handle h = core_columns_add(&t.set);
        TEST_ASSERT_EQUAL_UINT32(i, core_columns_row(&t.set, h));
        TEST_ASSERT_EQUAL_FLOAT(0, t.mass[i]);
        TEST_ASSERT_EQUAL_UINT64(0, t.id[i]);
        t.mass[i] = t.place[i].z = t.scratch[i] = 7;
        t.id[i] = i;
    }
    TEST_ASSERT_TRUE(core_handle_is_null(core_columns_add(&t.set)));
    TEST_ASSERT_EQUAL_STRING("test.things: full (1000), raise the capacity", core_last_error());
    const void *after[] = {t.mass, t.place, t.kind, t.scratch, t.id};
    TEST_ASSERT_EQUAL_MEMORY(before, after, sizeof before);
    // 1000 rows in lane blocks of 16: 1008 rows of 4 + 12 + 1 + 4 + 8 bytes, and 1000 handles.
    TEST_ASSERT_EQUAL_UINT64(1008 * 29 + 1000 * 12, core_columns_bytes(&t.set));
}

// Kernels read and may write up to the end of the last lane block.
static void padding_is_usable_and_never_leaks(void) {
    for (uint32_t count = 1; count <= 100; ++count) {
        core_columns_add(&t.set);
        uint32_t end = (count + CORE_LANES - 1) / CORE_LANES * CORE_LANES;
        for (uint32_t row = count; row < end; ++row) {
            TEST_ASSERT_EQUAL_FLOAT(0, t.mass[row]);
            TEST_ASSERT_EQUAL_FLOAT(0, t.place[row].y);
            TEST_ASSERT_EQUAL_UINT64(0, t.id[row]);
        }
    }
    uint64_t before[COLUMNS], after[COLUMNS];
    core_columns_hash(&t.set, before);
    for (uint32_t row = 100; row < 112; ++row) {
        t.mass[row] = 99;
        t.id[row] = 99;
    }
    core_columns_hash(&t.set, after);
    TEST_ASSERT_EQUAL_MEMORY(before, after, sizeof before);
    core_columns_add(&t.set);
    TEST_ASSERT_EQUAL_FLOAT(0, t.mass[100]);
    TEST_ASSERT_EQUAL_UINT64(0, t.id[100]);
}

static void removal_moves_the_last_row_whole(void) {
    core_handle h[5];
    for (uint64_t i = 0; i < 5; ++i) {
        h[i] = add_thing(10 + i);
    }
    uint32_t hole, last;
    TEST_ASSERT_TRUE(core_columns_remove(&t.set, h[1], &hole, &last));
    TEST_ASSERT_EQUAL_UINT32(1, hole);
    TEST_ASSERT_EQUAL_UINT32(4, last);
    expect_thing(1, 14);
    TEST_ASSERT_EQUAL_FLOAT(-1, t.scratch[1]);
    TEST_ASSERT_EQUAL_UINT32(1, core_columns_row(&t.set, h[4]));
    TEST_ASSERT_EQUAL_UINT64(0, t.id[4]);
    TEST_ASSERT_EQUAL_FLOAT(0, t.place[4].x);
    TEST_ASSERT_FALSE(core_columns_remove(&t.set, h[1], NULL, NULL));
    TEST_ASSERT_EQUAL_STRING("test.things: handle 2 (generation 1) is stale or foreign",
                             core_last_error());
    TEST_ASSERT_TRUE(core_columns_remove(&t.set, h[3], NULL, NULL));
    TEST_ASSERT_EQUAL_UINT32(3, core_columns_count(&t.set));
    core_columns_clear(&t.set);
    TEST_ASSERT_EQUAL_UINT32(0, core_columns_count(&t.set));
    TEST_ASSERT_EQUAL_UINT64(0, t.id[0]);
    TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_columns_row(&t.set, h[0]));
}

static void hashes_see_bits_of_state_only(void) {
    for (uint64_t i = 0; i < 50; ++i) {
        add_thing(i);
    }
    uint64_t a[COLUMNS], b[COLUMNS];
    uint16_t rows_a[50], rows_b[50];
    core_columns_hash(&t.set, a);
    core_columns_row_hash(&t.set, rows_a);
    TEST_ASSERT_EQUAL_UINT64(0, a[SCRATCH]);
    t.scratch[3] = 5;
    core_columns_hash(&t.set, b);
    TEST_ASSERT_EQUAL_MEMORY(a, b, sizeof a);
    t.place[0].y = 0.0f;
    core_columns_hash(&t.set, a);
    core_columns_row_hash(&t.set, rows_a);
    t.place[0].y = -0.0f;
    core_columns_hash(&t.set, b);
    core_columns_row_hash(&t.set, rows_b);
    TEST_ASSERT_TRUE(a[PLACE] != b[PLACE]);
    TEST_ASSERT_TRUE(rows_a[0] != rows_b[0]);
    TEST_ASSERT_EQUAL_MEMORY(rows_a + 1, rows_b + 1, sizeof rows_a - sizeof rows_a[0]);
    b[PLACE] = a[PLACE];
    TEST_ASSERT_EQUAL_MEMORY(a, b, sizeof a);
}

static uint8_t *save_set(const core_columns *set, size_t *size) {
    *size = core_columns_save_size(set);
    uint8_t *save = malloc(*size + 1);
    core_columns_save(set, save + 1); // unaligned on purpose
    return save;
}

static void a_restored_set_is_the_same(void) {
    core_handle h[300];
    for (uint64_t i = 0; i < 300; ++i) {
        h[i] = add_thing(i);
    }
    for (int i = 0; i < 300; i += 7) {
        core_columns_remove(&t.set, h[i], NULL, NULL);
    }
    uint64_t before[COLUMNS], after[COLUMNS], pool = core_pool_hash(&t.set.pool);
    core_columns_hash(&t.set, before);
    size_t size;
    uint8_t *save = save_set(&t.set, &size);
    for (uint64_t i = 0; i < 500; ++i) {
        add_thing(1000 + i);
    }
    TEST_ASSERT_TRUE(core_columns_restore(&t.set, save + 1, size));
    core_columns_hash(&t.set, after);
    TEST_ASSERT_EQUAL_MEMORY(before, after, sizeof before);
    TEST_ASSERT_EQUAL_UINT64(pool, core_pool_hash(&t.set.pool));
    TEST_ASSERT_EQUAL_UINT32(257, core_columns_count(&t.set));
    for (int i = 0; i < 300; ++i) {
        uint32_t row = core_columns_row(&t.set, h[i]);
        TEST_ASSERT_TRUE((i % 7 == 0) == (row == CORE_NO_ROW));
        if (row != CORE_NO_ROW) {
            expect_thing(row, (uint64_t)i);
        }
    }
    TEST_ASSERT_EQUAL_FLOAT(0, t.scratch[0]);
    for (uint32_t row = 257; row < 800; ++row) {
        TEST_ASSERT_EQUAL_UINT64(0, t.id[row]);
        TEST_ASSERT_EQUAL_FLOAT(0, t.scratch[row]);
    }
    things fresh; // and into a set that never held a row
    TEST_ASSERT_TRUE(things_init(&fresh, "test.things", 300));
    TEST_ASSERT_TRUE(core_columns_restore(&fresh.set, save + 1, size));
    core_columns_hash(&fresh.set, after);
    TEST_ASSERT_EQUAL_MEMORY(before, after, sizeof before);
    core_columns_release(&fresh.set);
    free(save);
}

static void an_empty_set_saves_and_restores(void) {
    size_t size;
    uint8_t *save = save_set(&t.set, &size);
    add_thing(1);
    TEST_ASSERT_TRUE(core_columns_restore(&t.set, save + 1, size));
    TEST_ASSERT_EQUAL_UINT32(0, core_columns_count(&t.set));
    free(save);
}

static void every_flip_and_every_cut_is_refused(void) {
    for (uint64_t i = 0; i < 20; ++i) {
        add_thing(i);
    }
    core_columns_remove(&t.set, core_columns_handle(&t.set, 4), NULL, NULL);
    uint64_t before[COLUMNS], after[COLUMNS], pool = core_pool_hash(&t.set.pool);
    core_columns_hash(&t.set, before);
    size_t size;
    uint8_t *save = save_set(&t.set, &size);
    for (size_t bit = 8; bit < (size + 1) * 8; ++bit) {
        save[bit / 8] ^= (uint8_t)(1u << bit % 8);
        TEST_ASSERT_FALSE(core_columns_restore(&t.set, save + 1, size));
        save[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    for (size_t cut = 0; cut < size; ++cut) {
        TEST_ASSERT_FALSE(core_columns_restore(&t.set, save + 1, cut));
    }
    core_columns_hash(&t.set, after);
    TEST_ASSERT_EQUAL_MEMORY(before, after, sizeof before);
    TEST_ASSERT_EQUAL_UINT64(pool, core_pool_hash(&t.set.pool));
    TEST_ASSERT_EQUAL_FLOAT(-1, t.scratch[0]); // a refusal leaves caches alone too
    free(save);
}

// A save put together from sound parts that do not belong together: fewer or more rows than
// handles, with right checksums everywhere.
static void rows_and_handles_must_agree(void) {
    for (uint64_t i = 0; i < 20; ++i) {
        add_thing(i);
    }
    size_t size, head = 24, row_bytes = 4 + 12 + 1 + 8;
    uint8_t *save = save_set(&t.set, &size), *at = save + 1;
    size_t pool_bytes = core_pool_save_size(&t.set.pool);
    TEST_ASSERT_EQUAL_UINT64(head + 20 * row_bytes + pool_bytes, size);
    uint8_t *forged = calloc(1, head + 100 * row_bytes + pool_bytes);
    for (uint32_t count = 0; count <= 100; ++count) {
        size_t bytes = count * row_bytes;
        uint64_t sum = core_hash(forged + head, bytes, count);
        memcpy(forged, at, head);
        memcpy(forged + 4, &count, sizeof count);
        memcpy(forged + 16, &sum, sizeof sum);
        memcpy(forged + head + bytes, at + size - pool_bytes, pool_bytes);
        bool restored = core_columns_restore(&t.set, forged, head + bytes + pool_bytes);
        TEST_ASSERT_EQUAL_INT(count == 20, restored);
        TEST_ASSERT_EQUAL_UINT32(20, core_columns_count(&t.set));
        memset(forged, 0, head + bytes + pool_bytes);
    }
    free(forged);
    free(save);
}

static void saves_of_other_columns_are_refused(void) {
    static const core_column other_columns[] = {{"mass", 4, CORE_COLUMN_STATE, 0},
                                                {"place", 12, CORE_COLUMN_STATE, 0},
                                                {"kind", 1, CORE_COLUMN_STATE, 0},
                                                {"key", 8, CORE_COLUMN_STATE, 0}};
    core_columns other;
    TEST_ASSERT_TRUE(core_columns_init(&other, "test.things", other_columns, 4, 100));
    core_columns_add(&other);
    size_t size;
    uint8_t *save = save_set(&other, &size);
    TEST_ASSERT_FALSE(core_columns_restore(&t.set, save + 1, size));
    TEST_ASSERT_EQUAL_STRING("test.things: saved by a build with other columns", core_last_error());
    core_columns_release(&other);
    free(save);
    add_thing(1);
    add_thing(2);
    save = save_set(&t.set, &size);
    things small;
    TEST_ASSERT_TRUE(things_init(&small, "test.things", 1));
    TEST_ASSERT_FALSE(core_columns_restore(&small.set, save + 1, size));
    TEST_ASSERT_EQUAL_STRING("test.things: 2 saved rows exceed the capacity of 1",
                             core_last_error());
    core_columns_release(&small.set);
    free(save);
}

static void a_million_rows(void) {
    core_columns_release(&t.set);
    TEST_ASSERT_TRUE(things_init(&t, "test.things", 1u << 20));
    uint64_t allocations = core_alloc_count();
    for (uint64_t i = 0; i < 1u << 20; ++i) {
        add_thing(i);
    }
    core_rng rng = core_rng_make(3, 0);
    for (int i = 0; i < 500000; ++i) {
        uint32_t row = core_rng_below(&rng, core_columns_count(&t.set));
        TEST_ASSERT_TRUE(core_columns_remove(&t.set, core_columns_handle(&t.set, row), NULL, NULL));
    }
    TEST_ASSERT_EQUAL_UINT64(allocations, core_alloc_count());
    TEST_ASSERT_EQUAL_UINT32((1u << 20) - 500000, core_columns_count(&t.set));
    for (uint32_t row = 0; row < core_columns_count(&t.set); ++row) {
        TEST_ASSERT_TRUE(t.mass[row] == (float)t.id[row] * 0.5f);
        TEST_ASSERT_TRUE(core_columns_handle(&t.set, row).index == t.id[row] + 1);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(rows_are_aligned_zero_and_stay_put);
    RUN_TEST(padding_is_usable_and_never_leaks);
    RUN_TEST(removal_moves_the_last_row_whole);
    RUN_TEST(hashes_see_bits_of_state_only);
    RUN_TEST(a_restored_set_is_the_same);
    RUN_TEST(an_empty_set_saves_and_restores);
    RUN_TEST(every_flip_and_every_cut_is_refused);
    RUN_TEST(rows_and_handles_must_agree);
    RUN_TEST(saves_of_other_columns_are_refused);
    RUN_TEST(a_million_rows);
    return UNITY_END();
}
