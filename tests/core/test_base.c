#include "core/base.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "core/clock.h"
#include "core/log.h"
#include "unity.h"

typedef struct heard {
    int lines;
    core_log_level level;
    char text[8][CORE_LOG_TEXT_MAX];
} heard;

static heard ears;

static void listen(void *ctx, core_log_level level, const char *text) {
    heard *h = ctx;
    h->level = level;
    snprintf(h->text[h->lines % 8], sizeof h->text[0], "%s", text);
    h->lines++;
}

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    memset(&ears, 0, sizeof ears);
    TEST_ASSERT_TRUE(core_log_add_sink(listen, &ears));
    core_clear_error();
}

void tearDown(void) { core_log_remove_sink(listen, &ears); }

static void a_failure_says_why_and_returns_false(void) {
    TEST_ASSERT_EQUAL_STRING("", core_last_error());
    TEST_ASSERT_FALSE(core_fail("body %d: mass is %.1f, expected > 0", 7, -1.5));
    TEST_ASSERT_EQUAL_STRING("body 7: mass is -1.5, expected > 0", core_last_error());
    TEST_ASSERT_EQUAL_INT(1, ears.lines);
    TEST_ASSERT_EQUAL_INT(CORE_LOG_ERROR, ears.level);
    TEST_ASSERT_EQUAL_STRING(core_last_error(), ears.text[0]);
    TEST_ASSERT_FALSE(core_fail_quiet("while loading: %s", core_last_error()));
    TEST_ASSERT_EQUAL_STRING("while loading: body 7: mass is -1.5, expected > 0",
                             core_last_error());
    TEST_ASSERT_EQUAL_INT(1, ears.lines);
}

static void *fail_elsewhere(void *arg) {
    (void)arg;
    core_fail_quiet("of another thread");
    return NULL;
}

static void the_last_error_is_per_thread(void) {
    core_fail_quiet("of this thread");
    pthread_t thread;
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&thread, NULL, fail_elsewhere, NULL));
    pthread_join(thread, NULL);
    TEST_ASSERT_EQUAL_STRING("of this thread", core_last_error());
}

static void endless_texts_are_cut(void) {
    static char endless[10000];
    memset(endless, 'x', sizeof endless - 1);
    core_fail_quiet("%s", endless);
    TEST_ASSERT_EQUAL_UINT64(2047, strlen(core_last_error()));
    core_log(CORE_LOG_INFO, "%s", endless);
    TEST_ASSERT_EQUAL_UINT64(CORE_LOG_TEXT_MAX - 1, strlen(ears.text[0]));
    TEST_ASSERT_EQUAL_STRING("x...", ears.text[0] + CORE_LOG_TEXT_MAX - 5);
}

static void a_text_becomes_clean_lines(void) {
    core_log(CORE_LOG_WARN, "first\nsec\tond\x1b[31m\n\nlast\n");
    TEST_ASSERT_EQUAL_INT(4, ears.lines);
    TEST_ASSERT_EQUAL_STRING("first", ears.text[0]);
    TEST_ASSERT_EQUAL_STRING("sec ond?[31m", ears.text[1]);
    TEST_ASSERT_EQUAL_STRING("", ears.text[2]);
    TEST_ASSERT_EQUAL_STRING("last", ears.text[3]);
}

static void log_from_inside(void *ctx, core_log_level level, const char *text) {
    (void)level, (void)text;
    ++*(int *)ctx;
    core_log(CORE_LOG_INFO, "from inside");
    TEST_ASSERT_FALSE(core_log_add_sink(log_from_inside, ctx));
}

static void a_sink_may_log_and_sinks_are_few(void) {
    int calls = 0;
    TEST_ASSERT_TRUE(core_log_add_sink(log_from_inside, &calls));
    core_log(CORE_LOG_INFO, "hello");
    TEST_ASSERT_EQUAL_INT(1, calls);
    TEST_ASSERT_EQUAL_INT(1, ears.lines);
    core_log_remove_sink(log_from_inside, &calls);
    core_log(CORE_LOG_INFO, "again");
    TEST_ASSERT_EQUAL_INT(1, calls);
    for (int i = 0; i < 7; ++i) {
        TEST_ASSERT_TRUE(core_log_add_sink(log_from_inside, &calls));
    }
    TEST_ASSERT_FALSE(core_log_add_sink(log_from_inside, &calls));
    for (int i = 0; i < 7; ++i) {
        core_log_remove_sink(log_from_inside, &calls);
    }
}

static int asserted_line;
static void count_assert(const char *expr, const char *file, int line) {
    TEST_ASSERT_EQUAL_STRING("1 == 2", expr);
    TEST_ASSERT_NOT_NULL(strstr(file, "test_base.c"));
    asserted_line = line;
}

static void the_assert_hook_can_be_caught(void) {
    TEST_ASSERT_NULL(core_set_assert_hook(count_assert));
    core_assert_failed("1 == 2", __FILE__, 42);
    TEST_ASSERT_EQUAL_INT(42, asserted_line);
    TEST_ASSERT_TRUE(core_set_assert_hook(NULL) == count_assert);
    TEST_ASSERT_NULL(core_set_assert_hook(NULL));
}

static void memory_is_zeroed_and_counted(void) {
    uint64_t before = core_alloc_count();
    uint8_t *block = core_alloc(1000);
    for (int i = 0; i < 1000; ++i) {
        TEST_ASSERT_EQUAL_UINT8(0, block[i]);
        block[i] = (uint8_t)i;
    }
    block = core_realloc(block, 1000, 5000);
    for (int i = 0; i < 5000; ++i) {
        TEST_ASSERT_EQUAL_UINT8(i < 1000 ? (uint8_t)i : 0, block[i]);
    }
    block = core_realloc(block, 5000, 10);
    TEST_ASSERT_EQUAL_UINT8(9, block[9]);
    core_free(block);
    core_free(core_alloc(0));
    core_free(NULL);
    TEST_ASSERT_EQUAL_UINT64(before + 4, core_alloc_count());
}

static void min_and_max_have_a_stated_order(void) {
    float nan = __builtin_nanf("");
    TEST_ASSERT_EQUAL_FLOAT(2.0f, CORE_MIN(nan, 2.0f));
    TEST_ASSERT_TRUE(CORE_MIN(2.0f, nan) != CORE_MIN(2.0f, nan));
    TEST_ASSERT_TRUE(__builtin_signbit(CORE_MIN(0.0f, -0.0f)) != 0);
    TEST_ASSERT_TRUE(__builtin_signbit(CORE_MAX(-0.0f, 0.0f)) == 0);
    TEST_ASSERT_EQUAL_INT(5, CORE_CLAMP(9, 1, 5));
    TEST_ASSERT_EQUAL_INT(1, CORE_CLAMP(-9, 1, 5));
}

static void clocks_go_forward(void) {
    uint64_t wall = core_clock_ns(), cpu = core_clock_cpu_ns();
    core_clock_sleep_ns(5000000);
    uint64_t slept = core_clock_ns() - wall;
    TEST_ASSERT_TRUE(slept >= 5000000);
    TEST_ASSERT_TRUE(core_clock_cpu_ns() >= cpu);
    TEST_ASSERT_TRUE(core_peak_rss_kb() > 100);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_failure_says_why_and_returns_false);
    RUN_TEST(the_last_error_is_per_thread);
    RUN_TEST(endless_texts_are_cut);
    RUN_TEST(a_text_becomes_clean_lines);
    RUN_TEST(a_sink_may_log_and_sinks_are_few);
    RUN_TEST(the_assert_hook_can_be_caught);
    RUN_TEST(memory_is_zeroed_and_counted);
    RUN_TEST(min_and_max_have_a_stated_order);
    RUN_TEST(clocks_go_forward);
    return UNITY_END();
}
