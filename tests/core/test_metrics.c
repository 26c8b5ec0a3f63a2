#include "core/metrics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/clock.h"
#include "core/file.h"
#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

static core_metrics *m;

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    m = core_metrics_create();
    TEST_ASSERT_NOT_NULL(m);
}
void tearDown(void) { core_metrics_destroy(m); }

static void step_with(uint64_t gpu_ns) {
    core_metrics_step_begin(m);
    core_stage_add_ns(m, CORE_STAGE_GFX_GPU, gpu_ns);
    core_metrics_step_end(m);
}

static int compare_u64(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

// Against a full sort, nearest rank, for many counts and for values with many doubles.
static void percentiles_are_exact(void) {
    core_rng rng = core_rng_make(1, 0);
    static const uint32_t counts[] = {1, 2, 3, 20, 100, 101, 5000};
    for (size_t c = 0; c < CORE_COUNT_OF(counts); ++c) {
        for (uint32_t range = 3;
             range<4000000000u; range = range> 400000000u ? UINT32_MAX : range * 100) {
            uint64_t values[5000], total = 0;
            uint32_t n = counts[c];
            core_metrics_destroy(m);
            m = core_metrics_create();
            for (uint32_t i = 0; i < n; ++i) {
                values[i] = core_rng_below(&rng, range);
                total += values[i];
                step_with(values[i]);
            }
            qsort(values, n, sizeof *values, compare_u64);
            core_summary s = core_metrics_stage(m, CORE_STAGE_GFX_GPU);
            TEST_ASSERT_EQUAL_UINT64(n, s.samples);
            TEST_ASSERT_EQUAL_DOUBLE((double)values[(n * 50 + 99) / 100 - 1] / 1e6, s.p50);
            TEST_ASSERT_EQUAL_DOUBLE((double)values[(n * 95 + 99) / 100 - 1] / 1e6, s.p95);
            TEST_ASSERT_EQUAL_DOUBLE((double)values[(n * 99 + 99) / 100 - 1] / 1e6, s.p99);
            TEST_ASSERT_EQUAL_DOUBLE((double)values[n - 1] / 1e6, s.max);
            TEST_ASSERT_EQUAL_DOUBLE((double)total / 1e6, s.total);
            TEST_ASSERT_EQUAL_DOUBLE((double)total / 1e6 / n, s.mean);
        }
    }
}

// Orders in which a careless selection fails or becomes slow.
static void percentiles_of_sorted_and_equal_values(void) {
    for (int order = 0; order < 3; ++order) {
        core_metrics_destroy(m);
        m = core_metrics_create();
        for (uint64_t i = 0; i < 20000; ++i) {
            step_with(order == 0 ? i : order == 1 ? 20000 - i : 7);
        }
        core_summary s = core_metrics_stage(m, CORE_STAGE_GFX_GPU);
        double p50 = order == 0 ? 9999 : order == 1 ? 10000 : 7;
        TEST_ASSERT_EQUAL_DOUBLE(p50 / 1e6, s.p50);
    }
}

static void a_stage_is_summed_within_a_step(void) {
    core_metrics_step_begin(m);
    core_stage_add_ns(m, CORE_STAGE_NAV, 1000);
    core_stage_add_ns(m, CORE_STAGE_NAV, 500);
    core_metrics_step_end(m);
    step_with(0);
    core_summary s = core_metrics_stage(m, CORE_STAGE_NAV);
    TEST_ASSERT_EQUAL_UINT64(2, s.samples);
    TEST_ASSERT_EQUAL_DOUBLE(0.0015, s.max);
    TEST_ASSERT_EQUAL_DOUBLE(0.0015, s.total);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, s.p50);
    TEST_ASSERT_EQUAL_DOUBLE(0.0015, s.p95);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, core_metrics_stage_last(m, CORE_STAGE_NAV));
    // Work after the last step (its picture) is not lost.
    core_stage_add_ns(m, CORE_STAGE_NAV, 9000);
    s = core_metrics_stage(m, CORE_STAGE_NAV);
    TEST_ASSERT_EQUAL_DOUBLE(0.009, s.max);
    TEST_ASSERT_EQUAL_DOUBLE(0.0105, s.total);
}

static void stages_nest_and_include_what_they_hold(void) {
    core_metrics_step_begin(m);
    core_stage_begin(m, CORE_STAGE_PHYS);
    core_stage_begin(m, CORE_STAGE_PHYS_SOLVE);
    core_clock_sleep_ns(2000000);
    core_stage_end(m, CORE_STAGE_PHYS_SOLVE);
    core_stage_begin(m, CORE_STAGE_PHYS); // a stage inside itself counts once
    core_clock_sleep_ns(2000000);
    core_stage_end(m, CORE_STAGE_PHYS);
    core_stage_end(m, CORE_STAGE_PHYS);
    core_metrics_step_end(m);
    double step = core_metrics_step_last(m), phys = core_metrics_stage_last(m, CORE_STAGE_PHYS);
    double solve = core_metrics_stage_last(m, CORE_STAGE_PHYS_SOLVE);
    TEST_ASSERT_TRUE(solve >= 2.0 && phys >= solve + 2.0 && step >= phys);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, core_metrics_stage_last(m, CORE_STAGE_AUDIO));
    TEST_ASSERT_EQUAL_UINT64(1, core_metrics_steps(m));
    TEST_ASSERT_EQUAL_DOUBLE(step, core_metrics_step(m).p50);
}

static void steps_allocate_nothing(void) {
    uint64_t before = core_alloc_count();
    for (uint64_t i = 0; i < 20000; ++i) { // well past the first commit
        core_metrics_step_begin(m);
        core_stage_begin(m, CORE_STAGE_SCENE);
        core_stage_end(m, CORE_STAGE_SCENE);
        core_metrics_set(m, CORE_COUNT_BODIES, (double)i);
        core_metrics_step_end(m);
    }
    core_summary s = core_metrics_stage(m, CORE_STAGE_SCENE);
    TEST_ASSERT_EQUAL_UINT64(20000, s.samples);
    TEST_ASSERT_TRUE(s.p50 <= s.p95 && s.p95 <= s.p99 && s.p99 <= s.max && s.max <= s.total);
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
    TEST_ASSERT_EQUAL_DOUBLE(19999, core_metrics_get(m, CORE_COUNT_BODIES));
    TEST_ASSERT_EQUAL_DOUBLE(0, core_metrics_get(m, CORE_COUNT_AWAKE));
}

static void names_are_the_contract(void) {
    TEST_ASSERT_EQUAL_INT(17, CORE_STAGE_TOTAL);
    TEST_ASSERT_EQUAL_INT(24, CORE_COUNT_TOTAL);
    TEST_ASSERT_EQUAL_STRING("script", core_stage_name(CORE_STAGE_SCRIPT));
    TEST_ASSERT_EQUAL_STRING("phys.islands", core_stage_name(CORE_STAGE_PHYS_ISLANDS));
    TEST_ASSERT_EQUAL_STRING("gfx.gpu", core_stage_name(CORE_STAGE_GFX_GPU));
    TEST_ASSERT_EQUAL_STRING("bodies", core_count_name(CORE_COUNT_BODIES));
    TEST_ASSERT_EQUAL_STRING("lua_kb", core_count_name(CORE_COUNT_LUA_KB));
}

static void without_metrics_nothing_happens(void) {
    core_metrics_step_begin(NULL);
    core_stage_begin(NULL, CORE_STAGE_PHYS);
    core_stage_add_ns(NULL, CORE_STAGE_PHYS, 1);
    core_stage_end(NULL, CORE_STAGE_PHYS);
    core_metrics_set(NULL, CORE_COUNT_BODIES, 1);
    core_metrics_step_end(NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, core_metrics_get(NULL, CORE_COUNT_BODIES));
    core_summary s = core_metrics_step(m);
    TEST_ASSERT_EQUAL_UINT64(0, s.samples);
    TEST_ASSERT_EQUAL_DOUBLE(0, s.mean + s.p50 + s.p99 + s.max);
}

static size_t count_of(const char *text, const char *what) {
    size_t n = 0;
    for (; (text = strstr(text, what)) != NULL; ++text) {
        ++n;
    }
    return n;
}

static void the_trace_is_a_list_of_events(void) {
    const char *path = "build/test-trace/deep/trace.json";
    TEST_ASSERT_TRUE(core_metrics_trace(m, path));
    for (int i = 0; i < 3; ++i) {
        core_metrics_step_begin(m);
        core_stage_begin(m, CORE_STAGE_PHYS);
        core_stage_begin(m, CORE_STAGE_PHYS_BROAD);
        core_stage_end(m, CORE_STAGE_PHYS_BROAD);
        core_stage_end(m, CORE_STAGE_PHYS);
        core_metrics_step_end(m);
    }
    TEST_ASSERT_TRUE(core_metrics_trace(m, NULL));
    char *text = core_file_read(path, NULL);
    TEST_ASSERT_NOT_NULL(text);
    TEST_ASSERT_EQUAL_UINT64(9, count_of(text, "\"ph\":\"X\""));
    TEST_ASSERT_EQUAL_UINT64(3, count_of(text, "\"name\":\"step\""));
    TEST_ASSERT_EQUAL_UINT64(3, count_of(text, "\"name\":\"phys.broad\""));
    TEST_ASSERT_EQUAL_UINT64(11, count_of(text, "{\"name\"")); // one names the process
    TEST_ASSERT_EQUAL_UINT64(9, count_of(text, "},\n"));
    TEST_ASSERT_EQUAL_INT('[', text[0]);
    TEST_ASSERT_EQUAL_STRING("}\n]\n", text + strlen(text) - 4);
    core_free(text);
    unlink(path);
    TEST_ASSERT_FALSE(core_metrics_trace(m, "build/test-trace/deep"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "Is a directory"));
    rmdir("build/test-trace/deep");
    rmdir("build/test-trace");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(percentiles_are_exact);
    RUN_TEST(percentiles_of_sorted_and_equal_values);
    RUN_TEST(a_stage_is_summed_within_a_step);
    RUN_TEST(stages_nest_and_include_what_they_hold);
    RUN_TEST(steps_allocate_nothing);
    RUN_TEST(names_are_the_contract);
    RUN_TEST(without_metrics_nothing_happens);
    RUN_TEST(the_trace_is_a_list_of_events);
    return UNITY_END();
}
