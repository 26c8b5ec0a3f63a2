// Radiance pictures are whole or refused: every cut of a packed and of a plain one.
#include "core/memory.h"
#include "core/radiance.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { WIDTH = 16, HEIGHT = 5 };
static const char head[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 5 +X 16\n";

// Rows of a run of 10 and 6 single bytes in each channel.
static size_t make_packed(uint8_t *out) {
    size_t at = sizeof head - 1;
    memcpy(out, head, at);
    for (int y = 0; y < HEIGHT; ++y) {
        const uint8_t mark[4] = {2, 2, 0, WIDTH};
        memcpy(out + at, mark, 4);
        at += 4;
        for (int channel = 0; channel < 4; ++channel) {
            out[at++] = 128 + 10;
            out[at++] = 7;
            out[at++] = 6;
            memset(out + at, 9, 6);
            at += 6;
        }
    }
    return at;
}

static void test_packed_rows(void) {
    uint8_t file[1024];
    size_t size = make_packed(file);
    TEST_ASSERT_TRUE(core_radiance_complete(file, size, WIDTH, HEIGHT));
    for (size_t cut = 0; cut < size; ++cut) {
        TEST_ASSERT_FALSE(core_radiance_complete(file, cut, WIDTH, HEIGHT));
    }
    file[sizeof head - 1 + 4] = 0; // a run of nothing
    TEST_ASSERT_FALSE(core_radiance_complete(file, size, WIDTH, HEIGHT));
    file[sizeof head - 1 + 4] = 128 + 17; // longer than the row
    TEST_ASSERT_FALSE(core_radiance_complete(file, size, WIDTH, HEIGHT));
}

static void test_plain_rows(void) {
    uint8_t file[1024];
    size_t size = sizeof head - 1 + WIDTH * HEIGHT * 4;
    memset(file, 200, sizeof file);
    memcpy(file, head, sizeof head - 1);
    TEST_ASSERT_TRUE(core_radiance_complete(file, size, WIDTH, HEIGHT));
    TEST_ASSERT_FALSE(core_radiance_complete(file, size - 1, WIDTH, HEIGHT));
    TEST_ASSERT_FALSE(core_radiance_complete("no picture", 10, WIDTH, HEIGHT));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_packed_rows);
    RUN_TEST(test_plain_rows);
    return UNITY_END();
}
