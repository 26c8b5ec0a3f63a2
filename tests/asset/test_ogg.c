// Ogg Vorbis: what a tone decodes to, the seam of a loop, and files that were damaged or made to
// hurt: each is refused or decoded, and the program goes on.
#include "asset/asset.h"
#include "core/file.h"
#include "core/log.h"
#include "core/rng.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void setUp(void) { core_log_set_level(CORE_LOG_ERROR + 1); }
void tearDown(void) {}

// tests/asset/tone.ogg: one second of 440 Hz at half of the full level, 24 kHz, mono.
static void a_tone_comes_back(void) {
    size_t size;
    void *file = core_file_read("tests/asset/tone.ogg", &size);
    core_sound_data *s = asset_sound_decode(file, size, "tone.ogg");
    TEST_ASSERT_NOT_NULL_MESSAGE(s, core_last_error());
    TEST_ASSERT_EQUAL_UINT32(1, s->channels);
    TEST_ASSERT_EQUAL_UINT32(24000, s->rate);
    TEST_ASSERT_EQUAL_UINT32(24000, s->frame_count);
    double in = 0, across = 0, all = 0, turn = 6.283185307179586 * 440 / 24000;
    for (int i = 2000; i < 22000; i++) { // 20,000 frames are no whole number of periods: a mean
        double v = s->sample[i] / 32768.0;
        in += v * sin(turn * i);
        across += v * cos(turn * i);
        all += v * v;
    }
    double level = 2 * hypot(in, across) / 20000;
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.5, level);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.125, all / 20000); // and nothing else is in it
    core_free(s);
    core_free(file);
}

// The game's music goes on from its last frame to its first as from any frame to the next.
static void the_music_has_no_seam(void) {
    size_t size;
    void *file = core_file_read("scripts/game/sounds/music.ogg", &size);
    core_sound_data *s = asset_sound_decode(file, size, "music.ogg");
    TEST_ASSERT_NOT_NULL_MESSAGE(s, core_last_error());
    TEST_ASSERT_EQUAL_UINT32(921600, s->frame_count); // 16 bars of 2.4 s: no frame more or less
    uint32_t n = s->frame_count;
    for (uint32_t c = 0; c < 2; c++) {
        int most = 0;
        for (uint32_t i = 1; i < n; i++) {
            most = CORE_MAX(most, abs(s->sample[2 * i + c] - s->sample[2 * i - 2 + c]));
        }
        int seam = abs(s->sample[c] - s->sample[2 * n - 2 + c]);
        TEST_ASSERT_LESS_THAN_INT(most, seam);
        TEST_ASSERT_LESS_THAN_INT(1000, seam); // of 32,768
    }
    core_free(s);
    core_free(file);
}

static uint32_t checksum(const uint8_t *page, size_t size) {
    uint32_t crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= (uint32_t)page[i] << 24;
        for (int bit = 0; bit < 8; bit++) {
            crc = crc & 0x80000000u ? crc << 1 ^ 0x04c11db7u : crc << 1;
        }
    }
    return crc;
}

// Makes every page's checksum agree with its bytes again.
static void sign(uint8_t *p, size_t size) {
    for (size_t at = 0; at + 27 <= size;) {
        size_t page = 27u + p[at + 26];
        for (size_t i = 0; i < p[at + 26] && at + 27 + i < size; i++) {
            page += p[at + 27 + i];
        }
        if (at + page > size) {
            return;
        }
        memset(p + at + 22, 0, 4);
        uint32_t crc = checksum(p + at, page);
        memcpy(p + at + 22, &crc, 4);
        at += page;
    }
}

static void five_hundred_damaged_files(void) {
    size_t size;
    uint8_t *file = core_file_read("tests/asset/tone.ogg", &size), *copy = core_alloc(size);
    core_rng rng = core_rng_make(8, 1);
    int played = 0;
    for (int i = 0; i < 500; i++) {
        bool agree = i % 5 != 0; // most with checksums that agree: those reach the decoder
        memcpy(copy, file, size);
        for (uint32_t k = 0; k <= core_rng_below(&rng, 6); k++) {
            // The headers, with the codebooks that stream damage hides in, more often than not.
            uint32_t reach = core_rng_below(&rng, 3) ? 3000 : (uint32_t)size;
            copy[core_rng_below(&rng, CORE_MIN(reach, (uint32_t)size))] ^=
                (uint8_t)(1 + core_rng_below(&rng, 255));
        }
        if (agree) {
            sign(copy, size);
        }
        core_sound_data *s = asset_sound_decode(copy, size, "damaged.ogg");
        TEST_ASSERT_TRUE(agree || s == NULL);
        TEST_ASSERT_TRUE(s || strstr(core_last_error(), "damaged.ogg"));
        played += s != NULL;
        core_free(s);
    }
    TEST_ASSERT_GREATER_THAN_INT(10, played); // some damage is only heard
    core_free(copy);
    core_free(file);
}

static void refuse(const void *bytes, size_t size, const char *why) {
    TEST_ASSERT_NULL(asset_sound_decode(bytes, size, "bad.ogg"));
    TEST_ASSERT_EQUAL_STRING(why, core_last_error());
}

static void refusals_say_why(void) {
    size_t size;
    uint8_t *file = core_file_read("tests/asset/tone.ogg", &size);
    refuse(file, 40, "bad.ogg: OGG: page 0: 58 bytes, 40 are left");
    refuse(file, 58, "bad.ogg: OGG: the end of the stream is missing");
    file[40] ^= 1;
    refuse(file, size, "bad.ogg: OGG: page 0: the checksum is another; the file is damaged");
    sign(file, size);
    file[40] ^= 1;
    memcpy(file + 29, "opus", 4);
    sign(file, size);
    refuse(file, size, "bad.ogg: OGG: no Vorbis that can be decoded");
    core_free(file);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_tone_comes_back);
    RUN_TEST(the_music_has_no_seam);
    RUN_TEST(five_hundred_damaged_files);
    RUN_TEST(refusals_say_why);
    return UNITY_END();
}
