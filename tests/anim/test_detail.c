// Level of detail by tolerance: what is drawn stays within it, calm and far ones cost less, unseen
// ones nothing, and the simulation sees no difference.
#include "anim/crowd.h"

static crowd c;
static anim_world *w;
static anim_instance who[3]; // still, calm, wild
enum { STILL, CALM, WILD, STEPS = 240 };

void setUp(void) {
    crowd_skeleton(&c);
    anim_world_desc desc = anim_world_desc_default();
    w = anim_world_create(&desc);
    anim_skeleton skeleton = anim_skeleton_create(w, &c.skeleton);
    static const float swing[] = {0, 0.04f, 0.8f};
    for (int i = 0; i < 3; i++) {
        crowd_clip(&c, "clip", i == WILD ? 1.5f : 3, swing[i]);
        for (uint32_t k = 0; k < CROWD_KEYS; k++) {
            c.key[0][k].translation = c.translation[0]; // the end meets the beginning
            c.key[4][k].scale = core_v3(1, 1, 1);
        }
        anim_instance_desc d = anim_instance_desc_default();
        d.skeleton = skeleton;
        d.clip = i == STILL ? CORE_NULL_HANDLE : crowd_clip_create(w, skeleton, &c);
        who[i] = anim_instance_create(w, &d);
    }
}
void tearDown(void) { anim_world_destroy(w); }

// Poses of each instance over the steps, and the worst distance of what is shown from what is so.
static double play(const float tolerance[3], int posed[3]) {
    double worst = 0;
    memset(posed, 0, 3 * sizeof *posed);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_TRUE(anim_instance_set_tolerance(w, who[i], tolerance[i]));
    }
    for (int step = 0; step < STEPS; step++) {
        anim_world_update(w, 1.0f / 60);
        anim_world_pose(w);
        for (int i = 0; i < 3; i++) {
            posed[i] += anim_instance_behind(w, who[i]) == 0;
        }
        double error = anim_world_error_max(w, 0);
        worst = error > worst && step > 1 ? error : worst;
    }
    return worst;
}

static void test_error_stays_within_and_calm_ones_cost_less(void) {
    static const float tolerance[] = {0.002f, 0.01f, 0.05f, 0.2f};
    int before = STEPS * 3 + 1;
    for (size_t i = 0; i < CORE_COUNT_OF(tolerance); i++) {
        const float all[] = {tolerance[i], tolerance[i], tolerance[i]};
        int posed[3];
        double error = play(all, posed);
        char text[96];
        snprintf(text, sizeof text, "%g m: error %.4f m, posed %d %d %d of %d",
                 (double)tolerance[i], error, posed[STILL], posed[CALM], posed[WILD], STEPS);
        TEST_ASSERT_TRUE_MESSAGE(error <= 1.2 * (double)tolerance[i], text);
        TEST_ASSERT_LESS_OR_EQUAL_INT_MESSAGE(posed[WILD], posed[CALM], text);
        TEST_ASSERT_LESS_THAN_INT_MESSAGE(before, posed[CALM] + posed[WILD], text);
        before = posed[CALM] + posed[WILD];
    }
}

static void test_unseen_ones_are_not_posed(void) {
    const float seen[] = {0, 0, 0}, unseen[] = {INFINITY, INFINITY, INFINITY};
    int posed[3];
    play(seen, posed);
    TEST_ASSERT_EQUAL_INT(STEPS, posed[WILD]);
    for (int step = 0; step < 30; step++) {
        for (int i = 0; i < 3; i++) {
            anim_instance_set_tolerance(w, who[i], unseen[i]);
        }
        anim_world_update(w, 1.0f / 60);
        anim_world_pose(w);
        TEST_ASSERT_EQUAL_UINT32(0, anim_world_posed(w));
    }
    play(seen, posed); // seen again: at once
    TEST_ASSERT_EQUAL_INT(STEPS, posed[WILD]);
    TEST_ASSERT_FALSE(anim_instance_set_tolerance(w, who[0], -1));
    TEST_ASSERT_FALSE(anim_instance_set_tolerance(w, who[0], NAN));
}

static void test_bones_that_are_asked_for_are_never_behind(void) {
    core_mat4 exact[STEPS], got;
    for (int pass = 0; pass < 2; pass++) {
        anim_instance_set_time(w, who[WILD], 0);
        anim_instance_set_tolerance(w, who[WILD], pass ? INFINITY : 0);
        for (int step = 0; step < STEPS; step++) {
            anim_world_update(w, 1.0f / 60);
            anim_world_pose(w);
            TEST_ASSERT_TRUE(anim_instance_bone(w, who[WILD], 13, pass ? &got : &exact[step]));
            TEST_ASSERT_TRUE(!pass || memcmp(&got, &exact[step], sizeof got) == 0);
        }
    }
}

static void test_a_fade_is_never_behind(void) {
    int posed = 0;
    anim_instance_set_tolerance(w, who[STILL], 10);
    anim_instance_play(w, who[STILL], CORE_NULL_HANDLE, ANIM_LOOP, 0, ANIM_FADE_LINEAR);
    for (int step = 0; step < 20; step++) {
        anim_world_update(w, 1.0f / 60);
        anim_world_pose(w);
    }
    crowd_clip(&c, "late", 1, 0.3f);
    anim_clip clip = crowd_clip_create(w, anim_instance_skeleton(w, who[STILL]), &c);
    anim_instance_play(w, who[STILL], clip, ANIM_LOOP, 0.2f, ANIM_FADE_LINEAR);
    for (int step = 0; step < 10; step++) {
        anim_world_update(w, 1.0f / 60);
        anim_world_pose(w);
        posed += anim_instance_behind(w, who[STILL]) == 0;
    }
    TEST_ASSERT_EQUAL_INT(10, posed);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_error_stays_within_and_calm_ones_cost_less);
    RUN_TEST(test_unseen_ones_are_not_posed);
    RUN_TEST(test_bones_that_are_asked_for_are_never_behind);
    RUN_TEST(test_a_fade_is_never_behind);
    return UNITY_END();
}
