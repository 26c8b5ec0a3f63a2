#include "core/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "unity.h"

static core_json j;

void setUp(void) { core_json_init(&j, false); }
void tearDown(void) { core_json_release(&j); }

static void structure_and_commas(void) {
    core_json_object(&j, NULL);
    core_json_int(&j, "steps", 600);
    core_json_array(&j, "list");
    core_json_number(&j, NULL, 1);
    core_json_bool(&j, NULL, true);
    core_json_null(&j, NULL);
    core_json_object(&j, NULL);
    core_json_end_object(&j);
    core_json_array(&j, NULL);
    core_json_end_array(&j);
    core_json_end_array(&j);
    core_json_string(&j, "scene", "hello");
    core_json_end_object(&j);
    TEST_ASSERT_EQUAL_STRING("{\"steps\":600,\"list\":[1,true,null,{},[]],\"scene\":\"hello\"}",
                             j.text);
    TEST_ASSERT_EQUAL_UINT64(strlen(j.text), j.length);
}

static void pretty_text_is_indented(void) {
    core_json_release(&j);
    core_json_init(&j, true);
    core_json_object(&j, NULL);
    core_json_number(&j, "a", 1.5);
    core_json_array(&j, "b");
    core_json_int(&j, NULL, -1);
    core_json_int(&j, NULL, INT64_MIN);
    core_json_end_array(&j);
    core_json_object(&j, "c");
    core_json_end_object(&j);
    core_json_end_object(&j);
    TEST_ASSERT_EQUAL_STRING(
        "{\n  \"a\": 1.5,\n  \"b\": [\n    -1,\n    -9223372036854775808\n  ],\n"
        "  \"c\": {}\n}",
        j.text);
}

static void strings_are_escaped(void) {
    core_json_string(&j, NULL, "q\" b\\ n\n t\t r\r \b\f \x01\x0b\x1f /\x7f");
    TEST_ASSERT_EQUAL_STRING("\"q\\\" b\\\\ n\\n t\\t r\\r \\b\\f \\u0001\\u000b\\u001f /\x7f\"",
                             j.text);
}

static void expect_string(const char *in, const char *out) {
    core_json_release(&j);
    core_json_init(&j, false);
    core_json_string(&j, NULL, in);
    char expected[128];
    snprintf(expected, sizeof expected, "\"%s\"", out);
    TEST_ASSERT_EQUAL_STRING(expected, j.text);
}

#define BAD "\xef\xbf\xbd"

static void only_utf8_comes_out(void) {
    expect_string("h\xc3\xa9 \xe2\x82\xac \xf0\x9f\xa6\x8a",
                  "h\xc3\xa9 \xe2\x82\xac \xf0\x9f\xa6\x8a");
    expect_string("\x80", BAD);
    expect_string("a\xff"
                  "b",
                  "a" BAD "b");
    expect_string("\xc0\xaf", BAD BAD);                 // overlong
    expect_string("\xe0\x9f\xbf", BAD BAD BAD);         // overlong
    expect_string("\xed\xa0\x80", BAD BAD BAD);         // surrogate
    expect_string("\xf4\x90\x80\x80", BAD BAD BAD BAD); // above U+10FFFF
    expect_string("\xe2\x82", BAD BAD);                 // cut short
    expect_string("\xf0\x9f\xa6", BAD BAD BAD);
    expect_string("\xf4\x8f\xbf\xbf", "\xf4\x8f\xbf\xbf");
}

static void expect_number(double value, const char *text) {
    char out[CORE_JSON_NUMBER_MAX];
    TEST_ASSERT_EQUAL_UINT64(strlen(text), core_json_format(value, out));
    TEST_ASSERT_EQUAL_STRING(text, out);
}

static void numbers_are_short(void) {
    expect_number(0, "0");
    expect_number(-0.0, "-0");
    expect_number(1, "1");
    expect_number(0.1, "0.1");
    expect_number(0.1 + 0.2, "0.30000000000000004");
    expect_number(1.0 / 3, "0.3333333333333333");
    expect_number(100, "100");
    expect_number(1e300, "1e+300");
    expect_number(9007199254740993.0, "9007199254740992");
    expect_number(5e-324, "5e-324");
    expect_number(2.2250738585072014e-308, "2.2250738585072014e-308");
    expect_number(1.7976931348623157e308, "1.7976931348623157e+308");
    expect_number(0.0166666675, "0.0166666675");
    expect_number(NAN, "null");
    expect_number(INFINITY, "null");
    expect_number(-INFINITY, "null");
}

// Any bits read back as the same double, and no text with a digit less does.
static void any_double_comes_back_shortest(void) {
    core_rng rng = core_rng_make(1, 0);
    int tried = 0;
    for (int i = 0; i < 200000; ++i) {
        uint64_t bits = core_rng_u64(&rng);
        if (i % 4 == 1) {
            bits &= 0x800fffffffffffffu; // denormal
        }
        double value;
        memcpy(&value, &bits, sizeof value);
        if (i % 4 == 2) {
            value = (double)core_rng_below(&rng, 1000000) / 1000; // a measured figure
        }
        if (!isfinite(value)) {
            continue;
        }
        char out[CORE_JSON_NUMBER_MAX], shorter[64];
        core_json_format(value, out);
        double back = strtod(out, NULL);
        TEST_ASSERT_EQUAL_MEMORY(&value, &back, sizeof value);
        int digits = 0;
        bool leading = true;
        for (const char *c = out; *c && *c != 'e'; ++c) {
            leading = leading && (*c == '0' || *c == '.' || *c == '-');
            digits += !leading && *c != '.';
        }
        const char *end = strchr(out, 'e') ? strchr(out, 'e') : out + strlen(out);
        while (digits && !strchr(out, '.') && end > out && end[-1] == '0') { // 1200 has two
            --end, --digits;
        }
        if (digits > 1 && i % 5 == 0) {
            snprintf(shorter, sizeof shorter, "%.*e", digits - 2, value);
            TEST_ASSERT_TRUE(strtod(shorter, NULL) != value);
            ++tried;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(30000, tried);
}

static void a_large_document_grows(void) {
    core_json_array(&j, NULL);
    for (int i = 0; i < 20000; ++i) {
        core_json_int(&j, NULL, i % 10);
    }
    core_json_end_array(&j);
    TEST_ASSERT_EQUAL_UINT64(20000 * 2 + 1, j.length);
    TEST_ASSERT_EQUAL_UINT64(j.length, strlen(j.text));
    TEST_ASSERT_EQUAL_STRING(",7,8,9]", j.text + j.length - 7);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(structure_and_commas);
    RUN_TEST(pretty_text_is_indented);
    RUN_TEST(strings_are_escaped);
    RUN_TEST(only_utf8_comes_out);
    RUN_TEST(numbers_are_short);
    RUN_TEST(any_double_comes_back_shortest);
    RUN_TEST(a_large_document_grows);
    return UNITY_END();
}
