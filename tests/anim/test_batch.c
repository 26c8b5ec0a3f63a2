// The kernels give the bits of the plain path: mixed clips, fades, frozen poses, odd counts, every
// instruction set, any number of threads.
#include "anim/crowd.h"
#include "core/simd.h"

static crowd c;

void setUp(void) { crowd_skeleton(&c); }
void tearDown(void) { core_simd_use(core_simd_best()); }

#define COUNT 53u

// A world in which instance i plays clip i % 4 (the last one raw), some are fading, some were
// interrupted, one is hidden; the palettes after a few steps.
static float *palettes(const char *batch, int threads, core_simd_set set, const char *pack) {
    TEST_ASSERT_TRUE(core_simd_use(set));
    anim_world_desc desc = anim_world_desc_default();
    desc.jobs = core_jobs_create(threads);
    anim_world *w = anim_world_create(&desc);
    anim_world_set(w, "batch", batch);
    anim_skeleton skeleton = anim_skeleton_create(w, &c.skeleton);
    anim_clip clip[4];
    for (int i = 0; i < 4; i++) {
        anim_world_set(w, "pack", i < 3 ? pack : "0");
        crowd_clip(&c, "clip", 0.8f + 0.3f * (float)i, 0.3f + 0.2f * (float)i);
        clip[i] = crowd_clip_create(w, skeleton, &c);
    }
    anim_instance instance[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        anim_instance_desc d = anim_instance_desc_default();
        d.skeleton = skeleton;
        d.clip = i == 7 ? CORE_NULL_HANDLE : clip[i % 4];
        d.time = 0.037f * (float)i;
        instance[i] = anim_instance_create(w, &d);
    }
    anim_instance_set_visible(w, instance[11], false);
    for (int step = 0; step < 12; step++) {
        for (uint32_t i = 0; i < COUNT; i++) {
            if ((i + (uint32_t)step) % 9 == 0) {
                anim_instance_play(w, instance[i], clip[(i + (uint32_t)step) % 4], ANIM_LOOP, 0.11f,
                                   i % 2 ? ANIM_FADE_SMOOTH : ANIM_FADE_LINEAR);
            }
        }
        anim_world_update(w, 1.0f / 60);
        anim_world_pose(w);
    }
    TEST_ASSERT_TRUE(anim_world_error_max(w, 0) < 2e-5);
    float *out = calloc(COUNT * CROWD_BONES * 12, sizeof *out);
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t bones;
        const float *p = anim_instance_palette(w, instance[i], &bones);
        TEST_ASSERT_EQUAL(i != 11, p != NULL);
        if (p) {
            memcpy(out + i * CROWD_BONES * 12, p, CROWD_BONES * 12 * sizeof *out);
        }
    }
    anim_world_destroy(w);
    core_jobs_destroy(desc.jobs);
    return out;
}

static void check_same(const char *batch, int threads, core_simd_set set, const char *pack,
                       const float *expected) {
    float *got = palettes(batch, threads, set, pack);
    for (uint32_t i = 0; i < COUNT * CROWD_BONES * 12; i++) {
        if (memcmp(&got[i], &expected[i], sizeof(float)) != 0) {
            char text[160];
            snprintf(text, sizeof text,
                     "%s, %d threads, %s: instance %u bone %u element %u: %.9g, "
                     "expected %.9g",
                     batch, threads, core_simd_name(set), i / (CROWD_BONES * 12),
                     i / 12 % CROWD_BONES, i % 12, (double)got[i], (double)expected[i]);
            TEST_FAIL_MESSAGE(text);
        }
    }
    free(got);
}

static void test_same_bits_everywhere(void) {
    static const char *const packs[] = {"0.0005", "0"};
    for (size_t p = 0; p < CORE_COUNT_OF(packs); p++) {
        float *plain = palettes("off", 1, CORE_SIMD_SSE2, packs[p]);
        for (core_simd_set set = CORE_SIMD_SSE2; set <= core_simd_best(); set++) {
            check_same("on", 1, set, packs[p], plain);
        }
        check_same("on", 3, core_simd_best(), packs[p], plain);
        check_same("off", 2, core_simd_best(), packs[p], plain);
        free(plain);
    }
}

// At rate n each instance is posed every n-th time, in turns, and its lag is what the error shows.
static void test_rates(void) {
    anim_world_desc desc = anim_world_desc_default();
    anim_world *w = anim_world_create(&desc);
    crowd_clip(&c, "clip", 1, 0.5f);
    anim_skeleton skeleton = anim_skeleton_create(w, &c.skeleton);
    anim_clip clip = crowd_clip_create(w, skeleton, &c);
    anim_instance instance[8];
    for (uint32_t i = 0; i < 8; i++) {
        anim_instance_desc d = anim_instance_desc_default();
        d.skeleton = skeleton;
        d.clip = clip;
        instance[i] = anim_instance_create(w, &d);
        TEST_ASSERT_TRUE(anim_instance_set_rate(w, instance[i], 4));
    }
    TEST_ASSERT_FALSE(anim_instance_set_rate(w, instance[0], 65));
    float last[8] = {0};
    for (int step = 0; step < 16; step++) {
        anim_world_update(w, 1.0f / 60);
        anim_world_pose(w);
        uint32_t bones, posed = 0;
        for (uint32_t i = 0; i < 8; i++) {
            float now = anim_instance_palette(w, instance[i], &bones)[66 * 12 + 3];
            posed += now != last[i];
            last[i] = now;
        }
        TEST_ASSERT_EQUAL_UINT32(step == 0 ? 8 : 2, posed);
    }
    double lag = anim_world_error_max(w, 0);
    TEST_ASSERT_TRUE(lag > 1e-3); // up to three steps behind
    for (uint32_t i = 0; i < 8; i++) {
        anim_instance_set_rate(w, instance[i], 1);
    }
    anim_world_pose(w);
    TEST_ASSERT_TRUE(anim_world_error_max(w, 0) < 2e-5);
    anim_world_destroy(w);
}

static void test_settings(void) {
    anim_world_desc desc = anim_world_desc_default();
    anim_world *w = anim_world_create(&desc);
    TEST_ASSERT_FALSE(anim_world_set(w, "pack", "-1"));
    TEST_ASSERT_FALSE(anim_world_set(w, "batch", "yes"));
    TEST_ASSERT_FALSE(anim_world_set(w, "batsh", "on"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "anim.batch"));
    TEST_ASSERT_TRUE(anim_world_set(w, "batch", "on"));
    anim_world_destroy(w);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_same_bits_everywhere);
    RUN_TEST(test_rates);
    RUN_TEST(test_settings);
    return UNITY_END();
}
