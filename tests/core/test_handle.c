#include "core/handle.h"

#include <stdlib.h>
#include <string.h>

#include "core/hash.h"
#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

static core_pool pool;

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    TEST_ASSERT_TRUE(core_pool_init(&pool, 100000));
}
void tearDown(void) { core_pool_release(&pool); }

static void null_and_foreign_handles_have_no_row(void) {
    TEST_ASSERT_TRUE(core_handle_is_null(CORE_NULL_HANDLE));
    TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, CORE_NULL_HANDLE));
    core_handle h = core_pool_add(&pool);
    TEST_ASSERT_EQUAL_UINT32(1, h.index);
    TEST_ASSERT_EQUAL_UINT32(1, h.generation);
    TEST_ASSERT_EQUAL_UINT32(0, core_pool_row(&pool, h));
    TEST_ASSERT_EQUAL_UINT64(0x100000001u, core_handle_bits(h));
    core_handle foreign[] = {{0, 1}, {1, 0}, {1, 2}, {2, 1}, {100001, 1}, {UINT32_MAX, 1}};
    for (size_t i = 0; i < CORE_COUNT_OF(foreign); ++i) {
        TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, foreign[i]));
        TEST_ASSERT_FALSE(core_pool_remove(&pool, foreign[i], NULL, NULL));
    }
    TEST_ASSERT_TRUE(core_handle_is_null(core_pool_handle(&pool, 1)));
}

// A handle forged with the generation that a free slot will get next is no live handle.
static void the_next_generation_is_not_live_yet(void) {
    core_handle h[3];
    for (int i = 0; i < 3; ++i) {
        h[i] = core_pool_add(&pool);
    }
    for (int i = 0; i < 2; ++i) {
        TEST_ASSERT_TRUE(core_pool_remove(&pool, h[i], NULL, NULL));
        core_handle next = {h[i].index, h[i].generation + 1};
        TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, next));
    }
    TEST_ASSERT_EQUAL_UINT32(0, core_pool_row(&pool, h[2]));
}

static void removal_swaps_the_last_row_in(void) {
    core_handle h[4];
    for (int i = 0; i < 4; ++i) {
        h[i] = core_pool_add(&pool);
    }
    uint32_t hole = 99, last = 99;
    TEST_ASSERT_TRUE(core_pool_remove(&pool, h[1], &hole, &last));
    TEST_ASSERT_EQUAL_UINT32(1, hole);
    TEST_ASSERT_EQUAL_UINT32(3, last);
    TEST_ASSERT_EQUAL_UINT32(1, core_pool_row(&pool, h[3]));
    TEST_ASSERT_TRUE(core_handle_equal(h[3], core_pool_handle(&pool, 1)));
    TEST_ASSERT_FALSE(core_pool_remove(&pool, h[1], &hole, &last));
    TEST_ASSERT_TRUE(core_pool_remove(&pool, h[2], &hole, &last)); // the last row itself
    TEST_ASSERT_EQUAL_UINT32(2, hole);
    TEST_ASSERT_EQUAL_UINT32(2, last);
    core_handle reused = core_pool_add(&pool); // last in, first out
    TEST_ASSERT_EQUAL_UINT32(3, reused.index);
    TEST_ASSERT_EQUAL_UINT32(2, reused.generation);
    TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, h[2]));
}

static void a_full_pool_gives_null(void) {
    core_pool small;
    TEST_ASSERT_TRUE(core_pool_init(&small, 3));
    core_handle h = CORE_NULL_HANDLE;
    for (int i = 0; i < 3; ++i) {
        h = core_pool_add(&small);
        TEST_ASSERT_FALSE(core_handle_is_null(h));
    }
    TEST_ASSERT_TRUE(core_handle_is_null(core_pool_add(&small)));
    TEST_ASSERT_TRUE(core_pool_remove(&small, h, NULL, NULL));
    TEST_ASSERT_FALSE(core_handle_is_null(core_pool_add(&small)));
    core_pool_release(&small);
    TEST_ASSERT_FALSE(core_pool_init(&small, 0));
    TEST_ASSERT_FALSE(core_pool_init(&small, UINT32_MAX));
    core_pool_release(&small);
}

// A slot whose generations are used up is retired: its oldest handle stays stale for ever.
static void a_worn_out_slot_is_retired(void) {
    core_handle first = core_pool_add(&pool);
    pool.generation[0] = UINT32_MAX;
    core_handle last = {1, UINT32_MAX};
    TEST_ASSERT_TRUE(core_pool_remove(&pool, last, NULL, NULL));
    core_handle other = core_pool_add(&pool);
    TEST_ASSERT_EQUAL_UINT32(2, other.index);
    TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, first));
    TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, last));
    TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, (core_handle){1, 0}));
    uint8_t save[256];
    TEST_ASSERT_TRUE(core_pool_save_size(&pool) <= sizeof save);
    core_pool_save(&pool, save);
    TEST_ASSERT_TRUE(core_pool_restore(&pool, save, core_pool_save_size(&pool)));
    TEST_ASSERT_EQUAL_UINT32(0, core_pool_row(&pool, other));
}

static void clear_makes_all_stale(void) {
    core_handle h[100];
    for (int i = 0; i < 100; ++i) {
        h[i] = core_pool_add(&pool);
    }
    core_pool_clear(&pool);
    TEST_ASSERT_EQUAL_UINT32(0, pool.count);
    for (int i = 0; i < 100; ++i) {
        TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(&pool, h[i]));
    }
    for (uint32_t i = 0; i < 100; ++i) {
        core_handle again = core_pool_add(&pool);
        TEST_ASSERT_EQUAL_UINT32(i + 1, again.index);
        TEST_ASSERT_EQUAL_UINT32(2, again.generation);
    }
    TEST_ASSERT_EQUAL_UINT32(100, pool.slots);
}

// A model that is obviously right: a list of live handles with the rows they should have.
typedef struct model {
    core_handle live[4000];
    uint32_t count;
    core_handle stale[4000];
    uint32_t stale_count;
} model;

static void model_step(model *m, core_pool *p, core_rng *rng) {
    if (m->count < 4000 && core_rng_below(rng, 100) < 55) {
        core_handle h = core_pool_add(p);
        TEST_ASSERT_EQUAL_UINT32(m->count, core_pool_row(p, h));
        m->live[m->count++] = h;
    } else if (m->count) {
        uint32_t row = core_rng_below(rng, m->count), hole, last;
        TEST_ASSERT_TRUE(core_pool_remove(p, m->live[row], &hole, &last));
        TEST_ASSERT_EQUAL_UINT32(row, hole);
        TEST_ASSERT_EQUAL_UINT32(m->count - 1, last);
        m->stale[m->stale_count++ % 4000] = m->live[row];
        m->live[row] = m->live[--m->count];
    }
}

static void model_check(const model *m, const core_pool *p) {
    TEST_ASSERT_EQUAL_UINT32(m->count, p->count);
    for (uint32_t row = 0; row < m->count; ++row) {
        TEST_ASSERT_EQUAL_UINT32(row, core_pool_row(p, m->live[row]));
        TEST_ASSERT_TRUE(core_handle_equal(m->live[row], core_pool_handle(p, row)));
    }
    for (uint32_t i = 0; i < CORE_MIN(m->stale_count, 4000u); ++i) {
        TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_pool_row(p, m->stale[i]));
    }
}

static model live_model;

static void a_random_life_matches_the_model(void) {
    core_rng rng = core_rng_make(5, 0);
    memset(&live_model, 0, sizeof live_model);
    for (int step = 0; step < 50000; ++step) {
        model_step(&live_model, &pool, &rng);
        if (step % 5000 == 0) {
            model_check(&live_model, &pool);
        }
    }
    model_check(&live_model, &pool);
}

// Saved, restored into a used pool, and continued: every later handle is the same.
static void a_restored_pool_goes_on_alike(void) {
    core_rng rng = core_rng_make(6, 0);
    memset(&live_model, 0, sizeof live_model);
    for (int step = 0; step < 3000; ++step) {
        model_step(&live_model, &pool, &rng);
    }
    size_t size = core_pool_save_size(&pool);
    uint8_t *save = malloc(size + 1);
    core_pool_save(&pool, save + 1); // unaligned on purpose
    TEST_ASSERT_EQUAL_UINT32(pool.count, core_pool_saved_count(save + 1, size));
    TEST_ASSERT_EQUAL_UINT32(0, core_pool_saved_count(save + 1, 3));
    core_pool other;
    TEST_ASSERT_TRUE(core_pool_init(&other, 50000));
    for (int i = 0; i < 7000; ++i) {
        core_pool_add(&other);
    }
    core_pool_clear(&other);
    TEST_ASSERT_TRUE(core_pool_restore(&other, save + 1, size));
    TEST_ASSERT_EQUAL_UINT64(core_pool_hash(&pool), core_pool_hash(&other));
    model_check(&live_model, &other);
    for (int i = 0; i < 2000; ++i) {
        core_handle a = core_pool_add(&pool), b = core_pool_add(&other);
        TEST_ASSERT_TRUE(core_handle_equal(a, b));
    }
    TEST_ASSERT_EQUAL_UINT64(core_pool_hash(&pool), core_pool_hash(&other));
    core_pool_release(&other);
    free(save);
}

static uint8_t *small_save(size_t *size) {
    core_handle h[20];
    for (int i = 0; i < 20; ++i) {
        h[i] = core_pool_add(&pool);
    }
    for (int i = 0; i < 20; i += 3) {
        core_pool_remove(&pool, h[i], NULL, NULL);
    }
    *size = core_pool_save_size(&pool);
    uint8_t *save = malloc(*size + 64);
    core_pool_save(&pool, save);
    return save;
}

static void every_flip_and_every_cut_is_refused(void) {
    size_t size;
    uint8_t *save = small_save(&size);
    uint64_t before = core_pool_hash(&pool);
    for (size_t bit = 0; bit < size * 8; ++bit) {
        save[bit / 8] ^= (uint8_t)(1u << bit % 8);
        TEST_ASSERT_FALSE(core_pool_restore(&pool, save, size));
        save[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    for (size_t cut = 0; cut < size; ++cut) {
        TEST_ASSERT_FALSE(core_pool_restore(&pool, save, cut));
    }
    TEST_ASSERT_FALSE(core_pool_restore(&pool, save, size + 4));
    TEST_ASSERT_EQUAL_UINT64(before, core_pool_hash(&pool));
    TEST_ASSERT_TRUE(core_pool_restore(&pool, save, size));
    free(save);
}

// An adversary who can make checksums: what gets through must still be a sound pool.
static void seal(uint8_t *save, size_t size) {
    uint64_t sum = core_hash(save + 24, size - 24, core_hash(save, 16, 0));
    memcpy(save + 16, &sum, 8);
}

static void forged_links_are_refused_or_sound(void) {
    size_t size;
    uint8_t *save = small_save(&size), *forged = malloc(size);
    core_rng rng = core_rng_make(8, 0);
    int accepted = 0;
    for (int round = 0; round < 20000; ++round) {
        memcpy(forged, save, size);
        for (uint32_t n = 1 + core_rng_below(&rng, 3); n; --n) {
            size_t words = (size - 24) / 4, at = core_rng_below(&rng, (uint32_t)words);
            uint32_t word = core_rng_below(&rng, 24) - 2;
            memcpy(forged + 24 + at * 4, &word, 4);
        }
        seal(forged, size);
        if (!core_pool_restore(&pool, forged, size)) {
            continue;
        }
        ++accepted; // other generations, or the same links again
        TEST_ASSERT_EQUAL_UINT32(13, pool.count);
        for (uint32_t row = 0; row < pool.count; ++row) {
            TEST_ASSERT_EQUAL_UINT32(row, core_pool_row(&pool, core_pool_handle(&pool, row)));
        }
        bool given[64] = {false};
        for (uint32_t i = 0; i < 10; ++i) { // 7 free slots (fewer when retired), then new ones
            core_handle h = core_pool_add(&pool);
            TEST_ASSERT_TRUE(h.index < 64 && !given[h.index]);
            given[h.index] = true;
            TEST_ASSERT_EQUAL_UINT32(13 + i, core_pool_row(&pool, h));
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(100, accepted);
    TEST_ASSERT_LESS_THAN_INT(15000, accepted);
    free(forged);
    free(save);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(null_and_foreign_handles_have_no_row);
    RUN_TEST(the_next_generation_is_not_live_yet);
    RUN_TEST(removal_swaps_the_last_row_in);
    RUN_TEST(a_full_pool_gives_null);
    RUN_TEST(a_worn_out_slot_is_retired);
    RUN_TEST(clear_makes_all_stale);
    RUN_TEST(a_random_life_matches_the_model);
    RUN_TEST(a_restored_pool_goes_on_alike);
    RUN_TEST(every_flip_and_every_cut_is_refused);
    RUN_TEST(forged_links_are_refused_or_sound);
    return UNITY_END();
}
