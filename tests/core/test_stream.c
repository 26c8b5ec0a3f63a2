// Streams: what is written is read, bit for bit, in both forms; what does not fit is refused.
#include "core/log.h"
#include "core/stream.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define COLUMNS(X)                                                                                 \
    X(float, height, CORE_COLUMN_STATE)                                                            \
    X(core_vec3, place, CORE_COLUMN_STATE)                                                         \
    X(uint8_t, kind, CORE_COLUMN_STATE)                                                            \
    X(uint64_t, user, CORE_COLUMN_STATE)                                                           \
    X(float, cache, 0)
CORE_COLUMNS_DECLARE(things, COLUMNS)
CORE_COLUMNS_DEFINE(things, COLUMNS)

typedef struct record {
    float f[5];
    double d[3];
    uint32_t u, n;
    uint64_t big;
    uint8_t b[3], x[2];
    char text[32];
} record;

void setUp(void) { core_log_set_level(CORE_LOG_ERROR + 1); }
void tearDown(void) {}

static bool stream_record(core_stream *s, record *r) {
    return core_stream_open(s, "Record.") && core_stream_list(s, "f", 'f', r->f, sizeof r->f) &&
           core_stream_open(s, "inner") && core_stream_list(s, "d", 'd', r->d, sizeof r->d) &&
           core_stream_u32(s, "u", &r->u) && core_stream_close(s) &&
           core_stream_u64(s, "big", &r->big) && core_stream_list(s, "b", 'b', r->b, sizeof r->b) &&
           core_stream_list(s, "x", 'x', r->x, sizeof r->x) &&
           core_stream_string(s, "odd name", r->text, sizeof r->text) &&
           core_stream_count(s, "n", &r->n, 10) &&
           core_stream_same(s, "version", 3, "another version") && core_stream_close(s);
}

static void numbers_and_texts_come_back_bit_for_bit(void) {
    static const record r = {{0.1f, -0.0f, INFINITY, NAN, 1e-42f},
                             {0.1, -INFINITY, 1e300},
                             4294967295u,
                             10,
                             0x0123456789abcdefu,
                             {0, 7, 255},
                             {0xab, 0x01},
                             "a \"b\"\n\\ \xc3\xa9"};
    for (int form = CORE_STREAM_BINARY; form <= CORE_STREAM_TEXT; form++) {
        record in = r, out = {0};
        core_stream w = core_stream_writer("test", (core_stream_form)form);
        TEST_ASSERT_TRUE(stream_record(&w, &in));
        core_stream s = core_stream_reader("test", (core_stream_form)form, w.data, w.size);
        TEST_ASSERT_TRUE_MESSAGE(stream_record(&s, &out), core_last_error());
        TEST_ASSERT_EQUAL_MEMORY(&r, &out, sizeof r);
        for (size_t cut = 0; cut + 1 < w.size; cut++) { // every shorter one is refused
            record none = {0};
            s = core_stream_reader("test", (core_stream_form)form, w.data, cut);
            TEST_ASSERT_FALSE(stream_record(&s, &none));
        }
        core_stream_release(&w);
    }
}

static void columns_come_back_with_their_handles(void) {
    for (int form = CORE_STREAM_BINARY; form <= CORE_STREAM_TEXT; form++) {
        things a, b;
        things_init(&a, "test.things", 100);
        things_init(&b, "test.things", 100);
        core_handle h[20];
        for (uint32_t i = 0; i < 20; i++) {
            h[i] = core_columns_add(&a.set);
            a.height[i] = 0.1f * (float)i;
            a.place[i] = core_v3((float)i, -1, 0.5f);
            a.kind[i] = (uint8_t)(i * 13);
            a.user[i] = (uint64_t)i << 40;
            a.cache[i] = 1;
        }
        core_columns_remove(&a.set, h[3], NULL, NULL);
        core_stream w = core_stream_writer("test", (core_stream_form)form);
        w.depth = 1; // inside a group
        TEST_ASSERT_TRUE(core_stream_columns(&w, &a.set));
        core_stream s = core_stream_reader("test", (core_stream_form)form, w.data, w.size);
        s.depth = 1;
        TEST_ASSERT_TRUE_MESSAGE(core_stream_columns(&s, &b.set), core_last_error());
        uint64_t ha[5], hb[5];
        core_columns_hash(&a.set, ha);
        core_columns_hash(&b.set, hb);
        TEST_ASSERT_EQUAL_HEX64_ARRAY(ha, hb, 5);
        TEST_ASSERT_EQUAL_HEX64(core_pool_hash(&a.set.pool), core_pool_hash(&b.set.pool));
        TEST_ASSERT_EQUAL_UINT32(CORE_NO_ROW, core_columns_row(&b.set, h[3]));
        TEST_ASSERT_EQUAL_FLOAT(0, b.cache[0]);
        core_stream_release(&w);
        core_columns_release(&a.set);
        core_columns_release(&b.set);
    }
}

static void refuse(const char *text, const char *why) {
    record r = {0};
    core_stream s = core_stream_reader("file.lua", CORE_STREAM_TEXT, text, strlen(text));
    TEST_ASSERT_FALSE(stream_record(&s, &r));
    TEST_ASSERT_EQUAL_STRING(why, core_last_error());
}

static void errors_name_file_and_field(void) {
    refuse("nonsense", "file.lua: Record.: \"return\" expected");
    refuse("-- a word before\nreturn { g = {} }", "file.lua: f: \"f\" expected");
    refuse("return { f = { 1, 2, 3, 4 },", "file.lua: f: \",\" expected");
    refuse("return { f = { 1, 2, 3, 4, 5x } }", "file.lua: f: \"5x\" is no number");
    refuse("return { f = { 1, 2, 3, 4, 5 }, inner = { d = { 1, 2, 3 }, u = -1, }, }",
           "file.lua: u: \"-1\" is no number of its kind");
    refuse("return { f = { 1, 2, 3, 4, 5 }, inner = { d = { 1, 2, 3 }, u = 9, }, big = \"12\",",
           "file.lua: big: 8 bytes in hexadecimal expected");
    uint32_t n = 11;
    core_stream w = core_stream_writer("file", CORE_STREAM_BINARY);
    core_stream_u32(&w, "n", &n);
    core_stream s = core_stream_reader("file", CORE_STREAM_BINARY, w.data, w.size);
    TEST_ASSERT_FALSE(core_stream_count(&s, "n", &n, 10));
    TEST_ASSERT_EQUAL_STRING("file: n: 11, expected at most 10", core_last_error());
    s = core_stream_reader("file", CORE_STREAM_BINARY, w.data, w.size);
    TEST_ASSERT_FALSE(core_stream_same(&s, "version", 3, "another version"));
    TEST_ASSERT_EQUAL_STRING("file: version: 8 bytes expected, 4 are left", core_last_error());
    TEST_ASSERT_FALSE(core_stream_u32(&s, "more", &n)); // a failed stream stays failed
    core_stream_release(&w);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(numbers_and_texts_come_back_bit_for_bit);
    RUN_TEST(columns_come_back_with_their_handles);
    RUN_TEST(errors_name_file_and_field);
    return UNITY_END();
}
