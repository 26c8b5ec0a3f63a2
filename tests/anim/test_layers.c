// Layers with masks and weights, additive clips, and 1D blend trees, against values by hand.
#include "anim/fixture.h"

static fixture f;

void setUp(void) { f = fix_make(); }
void tearDown(void) { anim_world_destroy(f.world); }

static anim_instance spawn(anim_clip clip) {
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = clip;
    return anim_instance_create(f.world, &desc);
}

static anim_clip held(const char *name, uint32_t bone, float angle) {
    return fix_clip(
        &f, (fix_clip_desc){.name = name, .duration = 1, .from = angle, .bone = bone, .keys = 1});
}

static void test_masked_layer(void) {
    anim_instance i = spawn(held("base", 1, 0.5f));
    const float arm_only[FIX_BONES] = {0, 0.5f, 0};
    anim_layer_desc d = anim_layer_desc_default();
    d.clip = held("wave", 1, 1.5f);
    d.mask = anim_mask_create(f.world, f.skeleton, arm_only);
    TEST_ASSERT_TRUE(anim_instance_set_layer(f.world, i, 1, &d));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, fix_angle(&f, i, 1)); // half way by nlerp
    d.clip = held("nod", 2, 1);
    TEST_ASSERT_TRUE(anim_instance_set_layer(f.world, i, 2, &d)); // the mask leaves the hand out
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, fix_angle(&f, i, 2));
    TEST_ASSERT_TRUE(anim_instance_set_layer_weight(f.world, i, 1, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, fix_angle(&f, i, 1)); // layer 2 holds the arm's bind pose
    TEST_ASSERT_FALSE(anim_mask_destroy(f.world, d.mask));
    anim_layer_desc none = anim_layer_desc_default();
    TEST_ASSERT_TRUE(anim_instance_set_layer(f.world, i, 1, &none));
    TEST_ASSERT_TRUE(anim_instance_set_layer(f.world, i, 2, &none));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, fix_angle(&f, i, 1));
    TEST_ASSERT_TRUE(anim_mask_destroy(f.world, d.mask));
    TEST_ASSERT_FALSE(anim_instance_set_layer(f.world, i, 4, &none));
}

// An additive clip from 0.2 to 0.8 rad adds what it has turned since its start, times its weight.
static void test_additive_layer(void) {
    anim_instance i = spawn(held("base", 1, 0.5f));
    anim_layer_desc d = anim_layer_desc_default();
    d.clip = fix_clip(
        &f, (fix_clip_desc){
                .name = "lean", .duration = 1, .from = 0.2f, .to = 0.8f, .move = 2, .bone = 1});
    d.loop = ANIM_ONCE;
    d.additive = true;
    TEST_ASSERT_TRUE(anim_instance_set_layer(f.world, i, 1, &d));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, fix_angle(&f, i, 1));
    anim_world_update(f.world, 0.5f);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0.8, fix_angle(&f, i, 1));
    fix_pose p;
    anim_instance_pose(f.world, i, fix_view(&p));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, p.t[1].x);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, p.s[1].x);
    anim_instance_set_layer_weight(f.world, i, 1, 0.5f);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0.65, fix_angle(&f, i, 1));
    anim_instance_pose(f.world, i, fix_view(&p));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.5f, p.t[1].x);
}

// The difference is the root's own: a clip equal to its first pose adds nothing anywhere.
static void test_additive_still_clip_changes_nothing(void) {
    anim_clip base = fix_clip(
        &f,
        (fix_clip_desc){.name = "base", .duration = 1, .from = -1, .to = 2, .move = 1, .bone = 2});
    anim_instance plain = spawn(base), layered = spawn(base);
    anim_layer_desc d = anim_layer_desc_default();
    d.clip = held("still", 0, 1.2f);
    d.additive = true;
    anim_instance_set_layer(f.world, layered, 1, &d);
    anim_world_update(f.world, 0.37f);
    fix_pose a, b;
    anim_instance_pose(f.world, plain, fix_view(&a));
    anim_instance_pose(f.world, layered, fix_view(&b));
    for (uint32_t k = 0; k < FIX_BONES; k++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, a.r[k].z, b.r[k].z);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, a.r[k].w, b.r[k].w);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, a.t[k].x, b.t[k].x);
    }
}

static anim_instance spawn_tree(anim_clip slow, anim_clip fast) {
    const anim_blend_point points[] = {{slow, 1}, {fast, 3}};
    const anim_parameter_desc parameter = {"speed", 0};
    anim_state_desc s = {
        .name = "move", .blend = points, .blend_count = 2, .blend_parameter = "speed"};
    anim_machine_desc d = anim_machine_desc_default();
    d.state = &s;
    d.state_count = 1;
    d.parameter = &parameter;
    d.parameter_count = 1;
    anim_machine m = anim_machine_create(f.world, &d);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(m), core_last_error());
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.machine = m;
    return anim_instance_create(f.world, &desc);
}

// Clips of 2 s and 1 s: below the first point the first plays alone; half way between, the phase
// runs by 1.5 s and the pose lies half way.
static void test_blend_tree(void) {
    anim_clip slow =
        fix_clip(&f, (fix_clip_desc){.name = "slow", .duration = 2, .to = 1, .bone = 1});
    anim_clip fast = fix_clip(
        &f, (fix_clip_desc){.name = "fast", .duration = 1, .from = 0.5f, .to = 2.5f, .bone = 1});
    anim_instance i = spawn_tree(slow, fast);
    anim_world_update(f.world, 0.5f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, fix_angle(&f, i, 1)); // phase 0.25 of the slow clip
    anim_instance_set_parameter(f.world, i, "speed", 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (0.25 + 1.0) / 2, fix_angle(&f, i, 1));
    anim_world_update(f.world, 0.375f); // phase 0.25 + 0.375 / 1.5 = 0.5
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (0.5 + 1.5) / 2, fix_angle(&f, i, 1));
    anim_instance_set_parameter(f.world, i, "speed", 9);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.5, fix_angle(&f, i, 1));
    anim_world_update(f.world, 0.75f); // wraps to phase 0.25
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, fix_angle(&f, i, 1));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.25f, anim_instance_time(f.world, i)); // in the fast clip
}

static void test_tree_error_and_palette(void) {
    anim_clip slow =
        fix_clip(&f, (fix_clip_desc){.name = "slow", .duration = 2, .to = 1, .bone = 1});
    anim_clip fast = fix_clip(
        &f, (fix_clip_desc){.name = "fast", .duration = 1, .from = 0.5f, .to = 2.5f, .bone = 1});
    anim_instance i = spawn_tree(slow, fast);
    anim_instance_set_parameter(f.world, i, "speed", 1.7f);
    for (int n = 0; n < 50; n++) {
        anim_world_update(f.world, 0.031f);
        anim_world_pose(f.world);
        double error = anim_world_error_max(f.world, 0);
        TEST_ASSERT_TRUE(error > 0 && error < 2e-5);
    }
}

static void test_bad_trees(void) {
    anim_clip clip = held("c", 1, 0);
    const anim_blend_point points[] = {{clip, 1}, {clip, 1}};
    anim_state_desc s = {
        .name = "move", .blend = points, .blend_count = 2, .blend_parameter = "speed"};
    anim_machine_desc d = anim_machine_desc_default();
    d.state = &s;
    d.state_count = 1;
    TEST_ASSERT_TRUE(core_handle_is_null(anim_machine_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "values must grow"));
    s.blend_count = 1;
    TEST_ASSERT_TRUE(core_handle_is_null(anim_machine_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "no parameter \"speed\""));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_masked_layer);
    RUN_TEST(test_additive_layer);
    RUN_TEST(test_additive_still_clip_changes_nothing);
    RUN_TEST(test_blend_tree);
    RUN_TEST(test_tree_error_and_palette);
    RUN_TEST(test_bad_trees);
    return UNITY_END();
}
