// Column sets through long random lives: rows come and go, saves are taken, corrupted, forged and
// restored. The set must always equal a plain list that lives the same life.
#include <stdlib.h>
#include <string.h>

#include "core/columns.h"
#include "core/hash.h"
#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

#define CAPACITY 600
#define LIVES    800
#define STEPS    4000

#define CELL_COLUMNS(X)                                                                            \
    X(uint64_t, id, CORE_COLUMN_STATE)                                                             \
    X(float, value, CORE_COLUMN_STATE)                                                             \
    X(uint16_t, cache, 0)

CORE_COLUMNS_DECLARE(cells, CELL_COLUMNS)
CORE_COLUMNS_DEFINE(cells, CELL_COLUMNS)

typedef struct plain {
    uint32_t count;
    uint64_t id[CAPACITY];
    core_handle handle[CAPACITY];
} plain;

static cells set;
static plain list, saved_list;
static uint8_t *save, *bad;
static size_t save_size;

void setUp(void) { core_log_set_level(CORE_LOG_ERROR + 1); }
void tearDown(void) {}

static void add_row(uint64_t id) {
    core_handle h = core_columns_add(&set.set);
    if (list.count == CAPACITY) {
        TEST_ASSERT_TRUE(core_handle_is_null(h));
        return;
    }
    uint32_t row = core_columns_row(&set.set, h);
    TEST_ASSERT_EQUAL_UINT32(list.count, row);
    TEST_ASSERT_TRUE(set.id[row] == 0 && set.value[row] == 0 && set.cache[row] == 0);
    set.id[row] = id;
    set.value[row] = (float)(id % 1000);
    set.cache[row] = 1;
    list.id[row] = id;
    list.handle[list.count++] = h;
}

static void remove_row(core_rng *rng) {
    if (list.count == 0) {
        return;
    }
    uint32_t row = core_rng_below(rng, list.count);
    core_handle h = list.handle[row];
    TEST_ASSERT_TRUE(core_columns_remove(&set.set, h, NULL, NULL));
    TEST_ASSERT_FALSE(core_columns_remove(&set.set, h, NULL, NULL));
    list.count--;
    list.id[row] = list.id[list.count];
    list.handle[row] = list.handle[list.count];
}

static void expect_equal_list(void) {
    TEST_ASSERT_EQUAL_UINT32(list.count, core_columns_count(&set.set));
    for (uint32_t row = 0; row < list.count; ++row) {
        TEST_ASSERT_EQUAL_UINT64(list.id[row], set.id[row]);
        TEST_ASSERT_EQUAL_FLOAT((float)(list.id[row] % 1000), set.value[row]);
        TEST_ASSERT_EQUAL_UINT32(row, core_columns_row(&set.set, list.handle[row]));
    }
}

static void take_save(void) {
    save_size = core_columns_save_size(&set.set);
    save = realloc(save, save_size);
    bad = realloc(bad, save_size);
    core_columns_save(&set.set, save);
    saved_list = list;
}

// One to three flipped bits, a cut, or random bytes over a stretch.
static void try_corrupt_save(core_rng *rng) {
    if (!save) {
        return;
    }
    memcpy(bad, save, save_size);
    size_t size = save_size;
    uint32_t kind = core_rng_below(rng, 3);
    if (kind == 0) {
        for (uint32_t flips = 1 + core_rng_below(rng, 3); flips; --flips) {
            uint32_t bit = core_rng_below(rng, (uint32_t)size * 8);
            bad[bit / 8] ^= (uint8_t)(1u << bit % 8);
        }
    } else if (kind == 1) {
        size = core_rng_below(rng, (uint32_t)size);
    } else {
        uint32_t at = core_rng_below(rng, (uint32_t)size);
        for (uint32_t n = 1 + core_rng_below(rng, 16); n && at < size; --n) {
            bad[at++] = (uint8_t)core_rng_u64(rng);
        }
    }
    if (size == save_size && memcmp(bad, save, size) == 0) {
        return;
    }
    TEST_ASSERT_FALSE(core_columns_restore(&set.set, bad, size));
}

static void restore_save(void) {
    if (save) {
        TEST_ASSERT_TRUE(core_columns_restore(&set.set, save, save_size));
        list = saved_list;
        uint8_t *again = malloc(save_size);
        TEST_ASSERT_EQUAL_UINT64(save_size, core_columns_save_size(&set.set));
        core_columns_save(&set.set, again);
        TEST_ASSERT_EQUAL_MEMORY(save, again, save_size);
        free(again);
    }
}

static void live(uint64_t seed) {
    core_rng rng = core_rng_make(seed, 1);
    list.count = 0;
    save = bad = NULL;
    TEST_ASSERT_TRUE(cells_init(&set, "fuzz.cells", CAPACITY));
    uint32_t growth = 30 + core_rng_below(&rng, 40);
    for (int step = 0; step < STEPS; ++step) {
        uint32_t what = core_rng_below(&rng, 1000);
        if (what < 5) {
            take_save();
        } else if (what < 10) {
            restore_save();
        } else if (what < 12) {
            core_columns_clear(&set.set);
            list.count = 0;
        } else if (what < 60) {
            try_corrupt_save(&rng);
        } else if (core_rng_below(&rng, 100) < growth) {
            add_row(core_rng_u64(&rng));
        } else {
            remove_row(&rng);
        }
        if (step % 50 == 0) {
            expect_equal_list();
        }
    }
    expect_equal_list();
    core_columns_release(&set.set);
    free(save);
    free(bad);
}

static void random_lives_match_a_plain_list(void) {
    for (uint64_t seed = 0; seed < LIVES; ++seed) {
        live(seed);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(random_lives_match_a_plain_list);
    return UNITY_END();
}
