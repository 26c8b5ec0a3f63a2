// Jobs under irregular load: uneven chunks, pauses that let workers sleep, changing sizes, nesting,
// systems that come and go.
#include <stdatomic.h>
#include <string.h>

#include "core/clock.h"
#include "core/hash.h"
#include "core/jobs.h"
#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

#define ITEMS 4096

typedef struct load {
    core_jobs *jobs;
    uint64_t seed;
    uint64_t item[ITEMS];
    uint64_t by_chunk[ITEMS];
} load;

static load work;

void setUp(void) { core_log_set_level(CORE_LOG_ERROR + 1); }
void tearDown(void) {}

static void nothing(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)ctx, (void)begin, (void)end, (void)chunk, (void)worker;
}

static void uneven(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)worker;
    load *l = ctx;
    uint64_t sum = 0;
    uint32_t rounds = (uint32_t)(core_hash_mix(l->seed, chunk) % 64);
    for (uint32_t i = begin; i < end; ++i) {
        uint64_t value = l->item[i];
        for (uint32_t k = 0; k <= rounds; ++k) {
            value = core_hash_mix(value, k);
        }
        l->item[i] = value;
        sum = core_hash_mix(sum, value);
    }
    l->by_chunk[chunk] = sum;
    if (rounds == 7) {
        core_jobs_for(l->jobs, 10, 3, nothing, l);
    }
}

// The same sequence of calls with any number of threads leaves the same bits.
static uint64_t run_sequence(int threads, uint64_t seed, int calls) {
    memset(&work, 0, sizeof work);
    work.jobs = threads ? core_jobs_create(threads) : NULL;
    core_rng rng = core_rng_make(seed, 1);
    uint64_t h = 0;
    for (int call = 0; call < calls; ++call) {
        uint32_t count = core_rng_below(&rng, ITEMS + 1), grain = 1 + core_rng_below(&rng, 200);
        work.seed = core_rng_u64(&rng);
        core_jobs_for(work.jobs, count, grain, uneven, &work);
        h = core_hash(work.by_chunk, core_jobs_chunks(count, grain) * sizeof(uint64_t), h);
        uint32_t pause = core_rng_below(&rng, 40);
        if (threads && pause < 3) {
            core_clock_sleep_ns(pause * 30000);
        }
    }
    core_jobs_destroy(work.jobs);
    return core_hash(work.item, sizeof work.item, h);
}

static void any_threads_same_bits(void) {
    static const int threads[] = {1, 2, 3, 4, 7, 16, 64};
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        uint64_t serial = run_sequence(0, seed, 400);
        for (size_t i = 0; i < CORE_COUNT_OF(threads); ++i) {
            TEST_ASSERT_EQUAL_HEX64(serial, run_sequence(threads[i], seed, 400));
        }
    }
}

static void systems_come_and_go(void) {
    uint64_t expected = run_sequence(0, 9, 2);
    for (int round = 0; round < 300; ++round) {
        TEST_ASSERT_EQUAL_HEX64(expected, run_sequence(1 + round % 8, 9, 2));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(any_threads_same_bits);
    RUN_TEST(systems_come_and_go);
    return UNITY_END();
}
