// Sound in numbers: what a captured run holds is compared with the models that audio.h states.
#include "audio/audio.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/log.h"
#include "unity.h"

#define RATE  48000
#define FRAME (RATE / 60)
#define STEPS 30

static audio_world *w;
static audio_device *device;
static audio_sound tone; // 1 s of 440 Hz, half of full scale, whole periods
static float pcm[STEPS * FRAME * 2];

static void assert_above(double bound, double value) {
    char text[96];
    snprintf(text, sizeof text, "%g is not above %g", value, bound);
    TEST_ASSERT_TRUE_MESSAGE(value > bound, text);
}

static void assert_below(double bound, double value) {
    char text[96];
    snprintf(text, sizeof text, "%g is not below %g", value, bound);
    TEST_ASSERT_TRUE_MESSAGE(value < bound, text);
}

static audio_sound make_tone(double hz, uint32_t frames, uint32_t channels) {
    int16_t *sample = core_alloc(frames * channels * sizeof *sample);
    for (uint32_t i = 0; i < frames; i++) {
        for (uint32_t c = 0; c < channels; c++) {
            sample[i * channels + c] =
                (int16_t)lrint(16384.0 * sin(2.0 * CORE_PI * hz * (double)i / RATE));
        }
    }
    core_sound_data data = {
        .channels = channels, .rate = RATE, .frame_count = frames, .sample = sample};
    audio_sound sound = audio_sound_create(w, &data);
    core_free(sample);
    return sound;
}

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    audio_world_desc desc = audio_world_desc_default();
    w = audio_world_create(&desc);
    audio_device_desc d = audio_device_desc_default();
    d.capture = true;
    device = audio_device_create(&d);
    tone = make_tone(440.0, RATE, 1);
}

void tearDown(void) {
    audio_device_destroy(device);
    audio_world_destroy(w);
}

static void need_device(void) {
    if (!device) {
        TEST_IGNORE_MESSAGE(core_last_error());
    }
}

static audio_source play_at(float x, float y, float z) {
    audio_source_desc d = audio_source_desc_default();
    d.sound = tone;
    d.position = core_v3(x, y, z);
    d.loop = true;
    return audio_source_create(w, &d);
}

// Steps and renders into pcm[0, steps).
static void capture(int steps) {
    for (int i = 0; i < steps; i++) {
        audio_world_step(w, 1.0f / 60.0f);
        audio_device_update(device, w);
        audio_device_render(device, pcm + (size_t)i * FRAME * 2, FRAME);
    }
}

static double level(int channel, int from, int to) { // root mean square over steps [from, to)
    double sum = 0;
    for (int i = from * FRAME; i < to * FRAME; i++) {
        sum += (double)pcm[2 * i + channel] * (double)pcm[2 * i + channel];
    }
    return sqrt(sum / ((to - from) * FRAME));
}

static double both(int from, int to) {
    double l = level(0, from, to), r = level(1, from, to);
    return sqrt(l * l + r * r);
}

static double decibels(double ratio) { return 20.0 * log10(ratio); }

static double frequency(int from, int to) { // by rising zero crossings of the sum
    double first = -1, last = -1;
    int count = 0;
    for (int i = from * FRAME + 1; i < to * FRAME; i++) {
        double a = (double)pcm[2 * i - 2] + (double)pcm[2 * i - 1];
        double b = (double)pcm[2 * i] + (double)pcm[2 * i + 1];
        if (a < 0 && b >= 0) {
            last = i - 1 + a / (a - b);
            first = first < 0 ? last : first;
            count++;
        }
    }
    return (count - 1) * RATE / (last - first);
}

static double biggest_jump(int steps) {
    double jump = 0;
    for (int i = 2; i < steps * FRAME * 2; i++) {
        jump = fmax(jump, fabs((double)pcm[i] - (double)pcm[i - 2]));
    }
    return jump;
}

static void left_right_front_behind(void) {
    need_device();
    audio_source s = play_at(-2, 0, 0);
    capture(10);
    assert_above(20.0, decibels(level(0, 2, 10) / fmax(level(1, 2, 10), 1e-9)));
    audio_source_set_position(w, s, core_v3(2, 0, 0));
    capture(10);
    assert_above(20.0, decibels(level(1, 2, 10) / fmax(level(0, 2, 10), 1e-9)));
    audio_source_set_position(w, s, core_v3(0, 0, -2));
    capture(10);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, decibels(level(0, 2, 10) / level(1, 2, 10)));
    double ahead = both(2, 10);
    audio_source_set_position(w, s, core_v3(0, 0, 2));
    capture(10);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, decibels(level(0, 2, 10) / level(1, 2, 10)));
    assert_above(1.0, decibels(ahead / both(2, 10))); // duller from behind
}

static void the_listener_turns(void) {
    need_device();
    play_at(0, 0, -2);
    // A quarter turn to the left: what was ahead is on the right.
    audio_listener l = {.rotation = core_quat_axis_angle(core_v3(0, 1, 0), CORE_PI_F / 2)};
    audio_world_set_listener(w, &l);
    capture(10);
    assert_above(20.0, decibels(level(1, 2, 10) / fmax(level(0, 2, 10), 1e-9)));
}

static void distance_law_within_a_tenth_of_a_decibel(void) {
    need_device();
    audio_source s = play_at(0, 0, -1);
    capture(10);
    double at_one = both(2, 10);
    const float distance[] = {0.25f, 1.0f, 2.0f, 5.0f, 20.0f, 100.0f};
    for (size_t i = 0; i < CORE_COUNT_OF(distance); i++) {
        audio_source_set_position(w, s, core_v3(0, 0, -distance[i]));
        capture(10);
        double model = 1.0 / fmax(1.0, (double)distance[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, decibels(model), decibels(both(2, 10) / at_one));
    }
}

static void rolloff_reference_and_maximum(void) {
    need_device();
    audio_source_desc d = audio_source_desc_default();
    d.sound = tone;
    d.loop = true;
    d.reference = 2;
    d.rolloff = 0.5f;
    d.max_distance = 10;
    audio_source s = audio_source_create(w, &d);
    const float distance[] = {1.0f, 4.0f, 10.0f, 50.0f};
    double first = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(distance); i++) {
        audio_source_set_position(w, s, core_v3(0, 0, -distance[i]));
        capture(10);
        double at = fmin(10.0, fmax(2.0, (double)distance[i]));
        double model = 2.0 / (2.0 + 0.5 * (at - 2.0));
        first = i == 0 ? both(2, 10) / model : first;
        TEST_ASSERT_DOUBLE_WITHIN(0.1, decibels(model), decibels(both(2, 10) / first));
    }
}

static void cone(void) {
    need_device();
    audio_source_desc d = audio_source_desc_default();
    d.sound = tone;
    d.loop = true;
    d.position = core_v3(0, 0, -1);
    d.inner = CORE_PI_F / 3;
    d.outer = CORE_PI_F;
    d.cone_gain = 0.1f;
    d.direction = core_v3(0, 0, 1);
    audio_source s = audio_source_create(w, &d);
    capture(10);
    double full = both(2, 10);
    // 60 degrees off the axis: halfway between 30 (inner) and 90 (outer).
    const struct {
        double angle, gain;
    } at[] = {{0, 1}, {25, 1}, {60, 0.55}, {90, 0.1}, {180, 0.1}};
    for (size_t i = 0; i < CORE_COUNT_OF(at); i++) {
        double a = at[i].angle * CORE_PI / 180;
        audio_source_set_direction(w, s, core_v3((float)sin(a), 0, (float)cos(a)));
        capture(10);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, decibels(at[i].gain), decibels(both(2, 10) / full));
    }
}

static void doppler_within_one_percent(void) {
    need_device();
    audio_source s = play_at(0, 0, -5);
    const float speed[] = {0.0f, 30.0f, 102.9f, -60.0f};
    for (size_t i = 0; i < CORE_COUNT_OF(speed); i++) {
        audio_source_set_velocity(w, s, core_v3(0, 0, speed[i])); // towards the listener
        capture(STEPS);
        double model = 440.0 * 343.3 / (343.3 - (double)speed[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * model, model, frequency(3, STEPS));
    }
    audio_source_set_velocity(w, s, core_v3(0, 0, 0));
    audio_listener l = {.rotation = {0, 0, 0, 1}, .velocity = {0, 0, -34.33f}};
    audio_world_set_listener(w, &l);
    capture(STEPS);
    TEST_ASSERT_DOUBLE_WITHIN(4.84, 484.0, frequency(3, STEPS));
}

static void pitch_and_groups(void) {
    need_device();
    audio_source s = play_at(0, 0, -1);
    capture(10);
    double full = both(2, 10);
    audio_source_set_pitch(w, s, 1.5f);
    TEST_ASSERT_TRUE(audio_world_set_group(w, "effects", 0.25f));
    capture(STEPS);
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 660.0, frequency(3, STEPS));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, decibels(0.25), decibels(both(3, STEPS) / full));
    TEST_ASSERT_TRUE(audio_world_set(w, "volume", "0"));
    capture(10);
    TEST_ASSERT_TRUE(both(4, 10) == 0.0);
}

static void two_captures_are_the_same_bits(void) {
    need_device();
    static float first[STEPS * FRAME * 2];
    for (int run = 0; run < 2; run++) {
        tearDown();
        setUp();
        audio_source s = play_at(-3, 0, 1);
        for (int i = 0; i < STEPS; i++) {
            audio_source_set_position(w, s, core_v3(0.2f * (float)i - 3, 0, 1));
            audio_world_step(w, 1.0f / 60.0f);
            audio_device_update(device, w);
            audio_device_render(device, pcm + (size_t)i * FRAME * 2, FRAME);
        }
        if (run == 0) {
            memcpy(first, pcm, sizeof pcm);
        }
    }
    TEST_ASSERT_EQUAL_MEMORY(first, pcm, sizeof pcm);
    TEST_ASSERT_TRUE(both(0, STEPS) > 0.01);
}

// A 440 Hz tone of amplitude a moves at most 2 pi 440 / 48000 a from sample to sample. Starting in
// the middle, stopping, fading and jumping in level must stay near that.
static void no_clicks(void) {
    need_device();
    const double bound = 1.6 * 0.5 * 2.0 * CORE_PI * 440.0 / RATE;
    audio_source s = play_at(0, 0, -1);
    for (int i = 0; i < STEPS; i++) {
        if (i == 5) {
            audio_source_set_gain(w, s, 0.1f);
        } else if (i == 10) {
            audio_source_set_gain(w, s, 1.0f);
        } else if (i == 13) {
            audio_source_pause(w, s);
        } else if (i == 17) {
            audio_source_play(w, s);
        } else if (i == 22) {
            audio_source_fade(w, s, 0.0f, 0.05f, true);
        }
        audio_world_step(w, 1.0f / 60.0f);
        audio_device_update(device, w);
        audio_device_render(device, pcm + (size_t)i * FRAME * 2, FRAME);
    }
    assert_below(bound, biggest_jump(STEPS));
    TEST_ASSERT_TRUE(both(15, 17) < 1e-6);
    TEST_ASSERT_TRUE(both(18, 20) > 0.1);
    TEST_ASSERT_FALSE(audio_source_playing(w, s));
    TEST_ASSERT_TRUE(both(28, 30) < 1e-6);
}

static void music_is_flat_and_loops_without_a_gap(void) {
    need_device();
    tone = make_tone(480.0, 4800, 2); // 0.1 s, whole periods: the seam is invisible
    audio_source_desc d = audio_source_desc_default();
    d.sound = tone;
    d.loop = true;
    d.flat = true;
    d.group = "music";
    d.position = core_v3(500, 0, 0);
    TEST_ASSERT_FALSE(core_handle_is_null(audio_source_create(w, &d)));
    capture(STEPS);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, decibels(level(0, 1, STEPS) / level(1, 1, STEPS)));
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 480.0, frequency(1, STEPS));
    assert_below(1.05 * 0.5 * 2.0 * CORE_PI * 480.0 / RATE, biggest_jump(STEPS));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5 / sqrt(2.0), level(0, 1, STEPS));
}

static void what_is_in_the_way_takes_level(void) {
    need_device();
    audio_source s = play_at(0, 0, -1);
    capture(10);
    double open = both(2, 10);
    audio_source_set_clear(w, s, 0.25f);
    capture(10);
    assert_below(decibels(0.26), decibels(both(2, 10) / open));
    assert_above(decibels(0.1), decibels(both(2, 10) / open));
}

static void voices_are_the_loudest_and_the_rest_is_virtual(void) {
    TEST_ASSERT_TRUE(audio_world_set(w, "voices", "4"));
    audio_source s[3000];
    for (int i = 0; i < 3000; i++) {
        s[i] = play_at(0, 0, -2.0f - (float)((i * 7919) % 3000)); // 2..3001 m in a mixed order
    }
    audio_world_step(w, 1.0f / 60.0f);
    uint32_t count;
    const audio_voice *voice = audio_world_voices(w, &count);
    TEST_ASSERT_EQUAL_UINT32(4, count);
    for (uint32_t i = 0; i < count; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f / (2.0f + (float)i), voice[i].gain);
    }
    // A virtual source keeps its place in time and is heard from there when it comes near.
    for (int i = 0; i < 29; i++) {
        audio_world_step(w, 1.0f / 60.0f);
    }
    audio_source far = s[1];
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5, audio_source_time(w, far));
    audio_source_set_position(w, far, core_v3(0, 0, 0));
    audio_world_step(w, 1.0f / 60.0f);
    voice = audio_world_voices(w, &count);
    TEST_ASSERT_TRUE(core_handle_equal(far, voice[0].source));
    TEST_ASSERT_DOUBLE_WITHIN(5, 24000, voice[0].frame);
    // Beyond -72 dB nothing is mixed.
    for (int i = 0; i < 3000; i++) {
        audio_source_set_position(w, s[i], core_v3(0, 0, -5000));
    }
    audio_world_step(w, 1.0f / 60.0f);
    audio_world_voices(w, &count);
    TEST_ASSERT_EQUAL_UINT32(0, count);
}

static void sounds_end_at_their_length_in_step_time(void) {
    audio_source_desc d = audio_source_desc_default();
    d.sound = make_tone(100.0, RATE / 2, 1);
    audio_source s = audio_source_create(w, &d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, audio_sound_duration(w, d.sound));
    for (int i = 0; i < 29; i++) {
        audio_world_step(w, 1.0f / 60.0f);
    }
    TEST_ASSERT_TRUE(audio_source_playing(w, s));
    audio_world_step(w, 1.0f / 60.0f);
    audio_world_step(w, 1.0f / 60.0f);
    TEST_ASSERT_FALSE(audio_source_playing(w, s));
    TEST_ASSERT_TRUE(audio_source_play(w, s));
    TEST_ASSERT_TRUE(audio_source_seek(w, s, 0.25));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.25, audio_source_time(w, s));
    TEST_ASSERT_FALSE(audio_source_seek(w, s, 0.6));
}

static void destroyed_sounds_and_stale_handles(void) {
    audio_source s = play_at(0, 0, -1);
    TEST_ASSERT_TRUE(audio_sound_destroy(w, tone));
    TEST_ASSERT_FALSE(audio_sound_destroy(w, tone));
    audio_world_step(w, 1.0f / 60.0f);
    if (device) {
        audio_device_update(device, w);
    }
    TEST_ASSERT_FALSE(audio_source_playing(w, s));
    TEST_ASSERT_FALSE(audio_source_play(w, s));
    TEST_ASSERT_TRUE(audio_source_destroy(w, s));
    TEST_ASSERT_FALSE(audio_source_destroy(w, s));
    TEST_ASSERT_FALSE(audio_source_set_gain(w, s, 1));
}

static void bad_input_is_refused(void) {
    audio_source_desc d = {0};
    TEST_ASSERT_TRUE(core_handle_is_null(audio_source_create(w, &d)));
    d = audio_source_desc_default();
    TEST_ASSERT_TRUE(core_handle_is_null(audio_source_create(w, &d))); // no sound
    d.sound = tone;
    const struct {
        float *field;
        float bad;
    } wrong[] = {{&d.gain, -1},     {&d.gain, NAN},       {&d.pitch, 0},
                 {&d.reference, 0}, {&d.max_distance, 0}, {&d.rolloff, -1},
                 {&d.outer, 7},     {&d.cone_gain, 2},    {&d.position.x, INFINITY}};
    for (size_t i = 0; i < CORE_COUNT_OF(wrong); i++) {
        float good = *wrong[i].field;
        *wrong[i].field = wrong[i].bad;
        TEST_ASSERT_TRUE(core_handle_is_null(audio_source_create(w, &d)));
        *wrong[i].field = good;
    }
    TEST_ASSERT_FALSE(core_handle_is_null(audio_source_create(w, &d)));
    core_sound_data data = {
        .channels = 3, .rate = RATE, .frame_count = 1, .sample = (int16_t[3]){0}};
    TEST_ASSERT_TRUE(core_handle_is_null(audio_sound_create(w, &data)));
    TEST_ASSERT_FALSE(audio_world_set(w, "voice", "3"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "did you mean voices"));
    TEST_ASSERT_FALSE(audio_world_set(w, "voices", "0"));
    TEST_ASSERT_FALSE(audio_world_set(w, "hrtf", "yes"));
    TEST_ASSERT_FALSE(audio_world_set_group(w, "", 1));
    TEST_ASSERT_FALSE(audio_world_set_group(w, "effects", -1));
}

static void hrtf_is_a_switch(void) {
    need_device();
    TEST_ASSERT_FALSE(audio_device_hrtf(device));
    audio_world_set(w, "hrtf", "on");
    play_at(-2, 0, 0);
    capture(10);
    if (!audio_device_hrtf(device)) {
        TEST_IGNORE_MESSAGE("this OpenAL has no HRTF data");
    }
    // Binaural: the far ear hears it too, later and softer.
    double difference = decibels(level(0, 3, 10) / level(1, 3, 10));
    assert_above(2.0, difference);
    assert_below(20.0, difference);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(left_right_front_behind);
    RUN_TEST(the_listener_turns);
    RUN_TEST(distance_law_within_a_tenth_of_a_decibel);
    RUN_TEST(rolloff_reference_and_maximum);
    RUN_TEST(cone);
    RUN_TEST(doppler_within_one_percent);
    RUN_TEST(pitch_and_groups);
    RUN_TEST(two_captures_are_the_same_bits);
    RUN_TEST(no_clicks);
    RUN_TEST(music_is_flat_and_loops_without_a_gap);
    RUN_TEST(what_is_in_the_way_takes_level);
    RUN_TEST(voices_are_the_loudest_and_the_rest_is_virtual);
    RUN_TEST(sounds_end_at_their_length_in_step_time);
    RUN_TEST(destroyed_sounds_and_stale_handles);
    RUN_TEST(bad_input_is_refused);
    RUN_TEST(hrtf_is_a_switch);
    return UNITY_END();
}
