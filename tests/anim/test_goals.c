// Limbs that reach and bones that look: the tip is where it should be by an own walk down the
// chain.
#include "anim/fixture.h"

static fixture f;
static anim_instance arm;

void setUp(void) {
    f = fix_make();
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = fix_clip(
        &f, (fix_clip_desc){.name = "bent", .duration = 1, .from = 0.4f, .bone = 1, .keys = 1});
    arm = anim_instance_create(f.world, &desc);
}
void tearDown(void) { anim_world_destroy(f.world); }

static core_vec3 place(uint32_t bone) {
    core_mat4 m;
    anim_world_pose(f.world);
    TEST_ASSERT_TRUE(anim_instance_bone(f.world, arm, bone, &m));
    return core_v3(m.m[12], m.m[13], m.m[14]);
}

static void set_reach(core_vec3 target, core_vec3 pole, float weight) {
    anim_goal_desc d = anim_goal_desc_default(ANIM_GOAL_REACH);
    d.bone = 2;
    d.target = target;
    d.pole = pole;
    d.weight = weight;
    TEST_ASSERT_TRUE_MESSAGE(anim_instance_set_goal(f.world, arm, 0, &d), core_last_error());
}

// The limb turns about (0, 0.5, 0); its bones are 1 and about 0.757 m.
static const core_vec3 limb_root = {0, 0.5f, 0};

static void test_reaches_what_it_can(void) {
    const float lower = sqrtf(0.75f * 0.75f + 0.1f * 0.1f), far = 1 + lower, near = 1 - lower;
    for (int n = 0; n < 400; n++) {
        core_vec3 d = {(float)sin(n * 1.7), (float)cos(n * 2.3), (float)sin(n * 0.9 + 1)};
        float r = 0.05f + 0.006f * (float)n;
        core_vec3 unit = core_v3_normalize(d, core_v3(1, 0, 0));
        core_vec3 target = core_v3_mad(limb_root, unit, r);
        set_reach(target, core_v3(0, 0, 0), 1);
        float expected = CORE_CLAMP(r, near, far), miss = fabsf(expected - r);
        float got = core_v3_length(core_v3_sub(place(2), target));
        TEST_ASSERT_FLOAT_WITHIN(6e-5f, miss, got);
        float upper = core_v3_length(core_v3_sub(place(1), limb_root));
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, upper); // bones keep their lengths
    }
}

static void test_weight_and_removal(void) {
    core_vec3 start = place(2), target = {0.7f, 1.2f, 0.3f};
    set_reach(target, core_v3(0, 0, 0), 0.5f);
    core_vec3 half = core_v3_scale(core_v3_add(start, target), 0.5f);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0, core_v3_length(core_v3_sub(place(2), half)));
    set_reach(target, core_v3(0, 0, 0), 0);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, core_v3_length(core_v3_sub(place(2), start)));
}

static void test_pole(void) {
    set_reach(core_v3(0, 1.7f, 0), core_v3(0, 0, 1), 1);
    core_vec3 elbow = place(1);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0, elbow.x);
    TEST_ASSERT_TRUE(elbow.z > 0.3f);
    set_reach(core_v3(0, 1.7f, 0), core_v3(-1, 0, 0), 1);
    elbow = place(1);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0, elbow.z);
    TEST_ASSERT_TRUE(elbow.x < -0.3f);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.7f, place(2).y);
}

static void test_tip_keeps_its_rotation(void) {
    core_mat4 before, after;
    anim_world_pose(f.world);
    anim_instance_bone(f.world, arm, 2, &before);
    anim_goal_desc d = anim_goal_desc_default(ANIM_GOAL_REACH);
    d.bone = 2;
    d.target = core_v3(0.9f, 1, 0.2f);
    d.keep_rotation = true;
    anim_instance_set_goal(f.world, arm, 0, &d);
    anim_world_pose(f.world);
    anim_instance_bone(f.world, arm, 2, &after);
    for (int i = 0; i < 12; i++) {
        if (i % 4 < 3) {
            TEST_ASSERT_FLOAT_WITHIN(1e-5f, before.m[i], after.m[i]);
        }
    }
}

static float look_angle(core_vec3 target, float limit, float weight) {
    anim_goal_desc d = anim_goal_desc_default(ANIM_GOAL_LOOK);
    d.bone = 2;
    d.target = target;
    d.limit = limit;
    d.weight = weight;
    TEST_ASSERT_TRUE(anim_instance_set_goal(f.world, arm, 1, &d));
    core_mat4 m;
    anim_world_pose(f.world);
    anim_instance_bone(f.world, arm, 2, &m);
    core_vec3 at = {m.m[12], m.m[13], m.m[14]}, forward = {m.m[8], m.m[9], m.m[10]};
    core_vec3 wanted = core_v3_normalize(core_v3_sub(target, at), core_v3(0, 0, 1));
    return acosf(CORE_MIN(1, core_v3_dot(forward, wanted)));
}

static void test_look(void) {
    core_vec3 side = core_v3_add(place(2), core_v3(2, 0, 0)); // 90 degrees to the right
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0, look_angle(side, 0, 1));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, CORE_PI_F / 2 - 0.5f, look_angle(side, 0.5f, 1));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, CORE_PI_F / 4, look_angle(side, 0, 0.5f));
    core_vec3 behind = core_v3_add(place(2), core_v3(0, 0, -3)); // half a turn: any axis will do
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0, look_angle(behind, 0, 1));
}

static void test_bad_goals(void) {
    anim_goal_desc d = anim_goal_desc_default(ANIM_GOAL_REACH);
    d.bone = 1; // only one bone above it
    TEST_ASSERT_FALSE(anim_instance_set_goal(f.world, arm, 0, &d));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "two bones above"));
    d.bone = 2;
    d.target.x = NAN;
    TEST_ASSERT_FALSE(anim_instance_set_goal(f.world, arm, 0, &d));
    TEST_ASSERT_FALSE(anim_instance_set_goal(f.world, arm, ANIM_MAX_GOALS, &d));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_reaches_what_it_can);
    RUN_TEST(test_weight_and_removal);
    RUN_TEST(test_pole);
    RUN_TEST(test_tip_keeps_its_rotation);
    RUN_TEST(test_look);
    RUN_TEST(test_bad_goals);
    return UNITY_END();
}
