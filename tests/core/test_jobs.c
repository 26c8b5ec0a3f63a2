#include "core/jobs.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "core/clock.h"
#include "core/hash.h"
#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

#define COUNT_MAX 100000

void setUp(void) { core_log_set_level(CORE_LOG_ERROR + 1); }
void tearDown(void) {}

typedef struct visit {
    uint32_t grain, count, threads;
    uint32_t times[COUNT_MAX];       // written without atomics: chunks must not overlap
    uint64_t chunk_value[COUNT_MAX]; // by chunk
    _Atomic uint32_t wrong;
} visit;

static visit seen;

static void visit_chunk(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    visit *v = ctx;
    bool right = begin == chunk * v->grain && begin < end && end <= v->count &&
                 (end - begin == v->grain || end == v->count) && worker < v->threads;
    v->wrong += !right;
    uint64_t value = 0;
    for (uint32_t i = begin; i < end; ++i) {
        v->times[i]++;
        value = core_hash_mix(value, i);
    }
    v->chunk_value[chunk] = value;
}

static uint64_t run(core_jobs *jobs, uint32_t count, uint32_t grain) {
    memset(&seen, 0, sizeof seen);
    seen.count = count;
    seen.grain = grain;
    seen.threads = (uint32_t)core_jobs_threads(jobs);
    core_jobs_for(jobs, count, grain, visit_chunk, &seen);
    TEST_ASSERT_EQUAL_UINT32(0, seen.wrong);
    for (uint32_t i = 0; i < count; ++i) {
        TEST_ASSERT_EQUAL_UINT32(1, seen.times[i]);
    }
    return core_hash(seen.chunk_value, core_jobs_chunks(count, grain) * sizeof(uint64_t), 0);
}

static void chunks_divide_the_count(void) {
    TEST_ASSERT_EQUAL_UINT32(0, core_jobs_chunks(0, 16));
    TEST_ASSERT_EQUAL_UINT32(1, core_jobs_chunks(1, 16));
    TEST_ASSERT_EQUAL_UINT32(1, core_jobs_chunks(16, 16));
    TEST_ASSERT_EQUAL_UINT32(2, core_jobs_chunks(17, 16));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, core_jobs_chunks(UINT32_MAX, 1));
    TEST_ASSERT_EQUAL_UINT32(2, core_jobs_chunks(UINT32_MAX, UINT32_MAX - 1));
}

static void every_index_once_with_any_threads(void) {
    static const uint32_t counts[] = {0, 1, 15, 16, 17, 1000, COUNT_MAX};
    static const uint32_t grains[] = {1, 7, 64, 5000, UINT32_MAX};
    for (size_t c = 0; c < CORE_COUNT_OF(counts); ++c) {
        for (size_t g = 0; g < CORE_COUNT_OF(grains); ++g) {
            uint64_t serial = run(NULL, counts[c], grains[g]);
            for (int threads = 1; threads <= 8; threads *= 2) {
                core_jobs *jobs = core_jobs_create(threads);
                TEST_ASSERT_EQUAL_INT(threads, core_jobs_threads(jobs));
                TEST_ASSERT_EQUAL_UINT64(serial, run(jobs, counts[c], grains[g]));
                core_jobs_destroy(jobs);
            }
        }
    }
}

// The end of the range must not wrap.
static void end_of_range(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk, (void)worker;
    uint64_t *sum = ctx;
    TEST_ASSERT_TRUE(begin < end);
    *sum += end - begin;
}

static void huge_counts_do_not_wrap(void) {
    uint64_t sum = 0;
    core_jobs_for(NULL, UINT32_MAX, 1u << 30, end_of_range, &sum);
    TEST_ASSERT_EQUAL_UINT64(UINT32_MAX, sum);
}

// Calls in close succession with other sizes: a late worker must not touch the next call's chunks.
static void many_calls_in_a_row(void) {
    core_jobs *jobs = core_jobs_create(4);
    core_rng rng = core_rng_make(1, 0);
    uint64_t allocations = core_alloc_count();
    for (int call = 0; call < 3000; ++call) {
        uint32_t count = core_rng_below(&rng, 300), grain = 1 + core_rng_below(&rng, 20);
        run(jobs, count, grain);
        if (call % 500 == 0) {
            core_clock_sleep_ns(200000); // let the workers fall asleep
        }
    }
    TEST_ASSERT_EQUAL_UINT64(allocations, core_alloc_count());
    core_jobs_destroy(jobs);
}

typedef struct nest {
    core_jobs *jobs;
    _Atomic uint32_t total, other_worker;
} nest;

typedef struct inner {
    nest *nest;
    uint32_t worker, next_chunk;
} inner;

static void inner_chunk(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    inner *in = ctx;
    in->nest->total += end - begin;
    in->nest->other_worker += worker != in->worker || chunk != in->next_chunk++;
}

static void outer_chunk(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)begin, (void)end, (void)chunk;
    nest *n = ctx;
    inner in = {n, worker, 0};
    core_jobs_for(n->jobs, 100, 10, inner_chunk, &in);
}

static void nested_calls_run_serially_as_the_same_worker(void) {
    nest n = {.jobs = core_jobs_create(4)};
    for (int round = 0; round < 100; ++round) {
        n.total = 0;
        core_jobs_for(n.jobs, 40, 1, outer_chunk, &n);
        TEST_ASSERT_EQUAL_UINT32(4000, n.total);
    }
    TEST_ASSERT_EQUAL_UINT32(0, n.other_worker);
    core_jobs_destroy(n.jobs);
}

static void note_worker(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)begin, (void)end, (void)chunk;
    _Atomic uint32_t *calls = ctx;
    calls[worker]++;
    core_clock_sleep_ns(100000);
}

static void all_workers_take_part(void) {
    core_jobs *jobs = core_jobs_create(4);
    _Atomic uint32_t calls[4] = {0};
    for (int round = 0; round < 200 && !(calls[1] && calls[2] && calls[3]); ++round) {
        core_jobs_for(jobs, 16, 1, note_worker, calls);
    }
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_TRUE(calls[i] > 0);
    }
    core_jobs_destroy(jobs);
}

// Per-worker scratch without atomics is safe: no two chunks of one worker run at once.
static void count_in_scratch(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk,
                             uint32_t worker) {
    (void)chunk;
    uint64_t(*scratch)[8] = ctx;
    for (uint32_t i = begin; i < end; ++i) {
        scratch[worker][0] += i;
    }
}

static void workers_own_their_scratch(void) {
    core_jobs *jobs = core_jobs_create(4);
    uint64_t scratch[4][8] = {{0}};
    for (int round = 0; round < 200; ++round) {
        core_jobs_for(jobs, 10000, 100, count_in_scratch, scratch);
    }
    uint64_t sum = scratch[0][0] + scratch[1][0] + scratch[2][0] + scratch[3][0];
    TEST_ASSERT_EQUAL_UINT64(200ull * 49995000ull, sum);
    core_jobs_destroy(jobs);
}

// Two worlds on two threads, each with its own workers.
static void *own_jobs(void *arg) {
    uint64_t scratch[2][8] = {{0}};
    core_jobs *jobs = core_jobs_create(2);
    for (int round = 0; round < 300; ++round) {
        core_jobs_for(jobs, 1000, 50, count_in_scratch, scratch);
    }
    core_jobs_destroy(jobs);
    *(uint64_t *)arg = scratch[0][0] + scratch[1][0];
    return NULL;
}

static void several_job_systems_live_side_by_side(void) {
    pthread_t threads[3];
    uint64_t sums[3];
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_EQUAL_INT(0, pthread_create(&threads[i], NULL, own_jobs, &sums[i]));
    }
    for (int i = 0; i < 3; ++i) {
        pthread_join(threads[i], NULL);
        TEST_ASSERT_EQUAL_UINT64(300ull * 499500ull, sums[i]);
    }
}

static void bad_thread_counts_are_refused(void) {
    TEST_ASSERT_NULL(core_jobs_create(-1));
    TEST_ASSERT_NULL(core_jobs_create(65));
    TEST_ASSERT_EQUAL_STRING("jobs: 65 threads, expected 0 to 64", core_last_error());
    core_jobs *jobs = core_jobs_create(0);
    TEST_ASSERT_TRUE(core_jobs_threads(jobs) >= 1);
    core_jobs_destroy(jobs);
    jobs = core_jobs_create(64);
    TEST_ASSERT_EQUAL_INT(64, core_jobs_threads(jobs));
    core_jobs_destroy(jobs);
    core_jobs_destroy(NULL);
    TEST_ASSERT_EQUAL_INT(1, core_jobs_threads(NULL));
}

// Idle workers sleep: 50 ms of idling with 8 workers costs next to no processor time.
static void idle_workers_sleep(void) {
    core_jobs *jobs = core_jobs_create(8);
    run(jobs, 1000, 10);
    core_clock_sleep_ns(5000000);
    uint64_t before = core_clock_cpu_ns();
    core_clock_sleep_ns(50000000);
    TEST_ASSERT_TRUE(core_clock_cpu_ns() - before < 5000000);
    core_jobs_destroy(jobs);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(chunks_divide_the_count);
    RUN_TEST(every_index_once_with_any_threads);
    RUN_TEST(huge_counts_do_not_wrap);
    RUN_TEST(many_calls_in_a_row);
    RUN_TEST(nested_calls_run_serially_as_the_same_worker);
    RUN_TEST(all_workers_take_part);
    RUN_TEST(workers_own_their_scratch);
    RUN_TEST(several_job_systems_live_side_by_side);
    RUN_TEST(bad_thread_counts_are_refused);
    RUN_TEST(idle_workers_sleep);
    return UNITY_END();
}
