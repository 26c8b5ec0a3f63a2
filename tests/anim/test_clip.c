// Sampling against closed form and a double evaluator, and the sampling defects of the report's
// engine (keys outside the clip, equal times, short clips, single keys) each as a case.
#include "anim/fixture.h"

static fixture f;

void setUp(void) { f = fix_make(); }
void tearDown(void) { anim_world_destroy(f.world); }

static double sampled_angle(anim_clip clip, float time, uint32_t bone) {
    fix_pose p;
    TEST_ASSERT_TRUE(anim_clip_sample(f.world, clip, time, fix_view(&p)));
    return 2 * atan2((double)p.r[bone].z, (double)p.r[bone].w);
}

static void test_linear_between_keys(void) {
    anim_clip clip = fix_clip(
        &f, (fix_clip_desc){
                .name = "turn", .duration = 2, .from = -1, .to = 1.5f, .move = 3, .bone = 1});
    for (int i = 0; i <= 1000; i++) {
        float t = 2.0f * (float)i / 1000.0f;
        fix_pose p;
        anim_clip_sample(f.world, clip, t, fix_view(&p));
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, -1 + 2.5 * t / 2, sampled_angle(clip, t, 1));
        TEST_ASSERT_FLOAT_WITHIN(2e-6f, 3 * t / 2, p.t[1].x);
        double n = (double)p.r[1].z * p.r[1].z + (double)p.r[1].w * p.r[1].w;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, n);
    }
}

static void test_key_times_hit_exactly(void) {
    anim_clip clip =
        fix_clip(&f, (fix_clip_desc){.name = "turn", .duration = 1, .to = 1, .move = 1, .bone = 2});
    uint32_t count;
    const core_key *key = anim_clip_keys(f.world, clip, 2, &count);
    TEST_ASSERT_EQUAL_UINT32(FIX_KEYS, count);
    for (uint32_t k = 0; k < count; k++) {
        fix_pose p;
        anim_clip_sample(f.world, clip, key[k].time, fix_view(&p));
        TEST_ASSERT_EQUAL_MEMORY(&key[k].translation, &p.t[2], sizeof p.t[2]);
        TEST_ASSERT_FLOAT_WITHIN(1e-7f, key[k].rotation.z, p.r[2].z);
    }
}

// Defect 4: outside the keys the nearest key holds; nothing is extrapolated.
static void test_outside_the_keys(void) {
    anim_clip clip = fix_clip(&f, (fix_clip_desc){.name = "late",
                                                  .duration = 4,
                                                  .from = 0.25f,
                                                  .to = 1.25f,
                                                  .first = 1,
                                                  .last = 3,
                                                  .bone = 1});
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, sampled_angle(clip, 0, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, sampled_angle(clip, 0.99f, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.75, sampled_angle(clip, 2, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.25, sampled_angle(clip, 3.5f, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.25, sampled_angle(clip, 4, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, sampled_angle(clip, -3, 1));
}

static void test_single_key(void) {
    anim_clip clip = fix_clip(
        &f, (fix_clip_desc){.name = "held", .duration = 2, .from = 0.5f, .bone = 0, .keys = 1});
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sampled_angle(clip, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sampled_angle(clip, 1.5f, 0));
}

// Defect 6: bones without keys keep the bind pose, not the identity.
static void test_missing_tracks_keep_bind_pose(void) {
    anim_clip clip =
        fix_clip(&f, (fix_clip_desc){.name = "turn", .duration = 1, .to = 1, .bone = 1});
    fix_pose p;
    anim_clip_sample(f.world, clip, 0.5f, fix_view(&p));
    TEST_ASSERT_EQUAL_MEMORY(&fix_t[2], &p.t[2], sizeof fix_t[2]);
    TEST_ASSERT_EQUAL_MEMORY(&fix_t[0], &p.t[0], sizeof fix_t[0]);
}

static void test_shortest_path(void) {
    core_key a = {0, {0, 0, 0}, core_quat_axis_angle(core_v3(0, 0, 1), 1.4f), {1, 1, 1}};
    core_key b = {1, {0, 0, 0}, core_quat_axis_angle(core_v3(0, 0, 1), 1.6f), {1, 1, 1}};
    b.rotation = (core_quat){-b.rotation.x, -b.rotation.y, -b.rotation.z, -b.rotation.w};
    core_key m = anim_key_interpolate(&a, &b, 0.5f);
    double angle = 2 * atan2((double)m.rotation.z, (double)m.rotation.w);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.5, fabs(angle));
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-6, 1, sqrt((double)m.rotation.z * m.rotation.z + (double)m.rotation.w * m.rotation.w));
}

static void test_blend_ends_are_exact(void) {
    anim_clip one = fix_clip(&f, (fix_clip_desc){.name = "a", .duration = 1, .to = 1, .bone = 1});
    anim_clip two =
        fix_clip(&f, (fix_clip_desc){.name = "b", .duration = 1, .to = -2, .move = 1, .bone = 1});
    fix_pose a, b, out;
    anim_clip_sample(f.world, one, 0.77f, fix_view(&a));
    anim_clip_sample(f.world, two, 0.31f, fix_view(&b));
    anim_pose_blend(fix_view(&a), fix_view(&b), 0, FIX_BONES, fix_view(&out));
    TEST_ASSERT_EQUAL_MEMORY(&a, &out, sizeof out);
    anim_pose_blend(fix_view(&a), fix_view(&b), 1, FIX_BONES, fix_view(&out));
    TEST_ASSERT_EQUAL_MEMORY(&b, &out, sizeof out);
    // Defect 1: a factor beyond the end does not extrapolate.
    anim_pose_blend(fix_view(&a), fix_view(&b), 1.25f, FIX_BONES, fix_view(&out));
    TEST_ASSERT_EQUAL_MEMORY(&b, &out, sizeof out);
    anim_pose_blend(fix_view(&a), fix_view(&b), 0.5f, FIX_BONES, fix_view(&out));
    for (uint32_t i = 0; i < FIX_BONES; i++) {
        core_quat q = out.r[i];
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    }
}

static anim_clip three_keys(core_key_mode mode, const core_key *tangent) {
    core_key key[3] = {{0, {0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}},
                       {1, {1, 0, 0}, core_quat_axis_angle(core_v3(0, 0, 1), 0.5f), {1, 1, 1}},
                       {3, {5, 0, 0}, core_quat_axis_angle(core_v3(0, 0, 1), 1.0f), {1, 1, 1}}};
    core_clip_track track = {
        .bone = 1, .key_count = 3, .key = key, .mode = mode, .tangent = tangent};
    core_clip_data data = {
        .name = "three", .duration = 3, .bone_count = FIX_BONES, .track_count = 1, .track = &track};
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = &data;
    desc.skeleton = f.skeleton;
    return anim_clip_create(f.world, &desc);
}

static float x_at(anim_clip clip, float time) {
    fix_pose p;
    TEST_ASSERT_TRUE(anim_clip_sample(f.world, clip, time, fix_view(&p)));
    return p.t[1].x;
}

static void test_step_keys(void) {
    anim_clip clip = three_keys(CORE_KEY_STEP, NULL);
    TEST_ASSERT_FLOAT_WITHIN(0, 0, x_at(clip, 0.999f));
    TEST_ASSERT_FLOAT_WITHIN(0, 1, x_at(clip, 1));
    TEST_ASSERT_FLOAT_WITHIN(0, 1, x_at(clip, 2.999f));
    TEST_ASSERT_FLOAT_WITHIN(0, 5, x_at(clip, 3));
}

// Given tangents: the specification's formula by hand. Without: Catmull and Rom's, (5 - 0) / 3 at
// the middle key, whose value and slope are continuous there.
static void test_cubic_keys(void) {
    core_key zero[6] = {{0}};
    anim_clip flat = three_keys(CORE_KEY_CUBIC, zero);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.5f, x_at(flat, 0.5f));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.15625f, x_at(flat, 0.25f)); // 3u^2 - 2u^3
    anim_clip smooth = three_keys(CORE_KEY_CUBIC, NULL);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, x_at(smooth, 1));
    float before = (x_at(smooth, 1) - x_at(smooth, 0.999f)) / 0.001f;
    float after = (x_at(smooth, 1.001f) - x_at(smooth, 1)) / 0.001f;
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 5.0f / 3, before);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 5.0f / 3, after);
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = smooth;
    anim_instance i = anim_instance_create(f.world, &desc);
    for (int n = 0; n < 30; n++) {
        anim_instance_set_time(f.world, i, 0.11f * (float)n);
        anim_world_pose(f.world);
        TEST_ASSERT_TRUE(anim_world_error_max(f.world, 0) < 3e-6);
    }
    zero[3].translation.x = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(three_keys(CORE_KEY_CUBIC, zero)));
}

static anim_clip try_clip(const core_clip_data *data) {
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = data;
    desc.skeleton = f.skeleton;
    return anim_clip_create(f.world, &desc);
}

// Defects 5 and 8: what the report's loader divides by or writes to is refused with a reason.
static void test_bad_clips_are_refused(void) {
    core_key key[2] = {{0, {0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}},
                       {1, {0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}};
    core_clip_track track = {.bone = 0, .key_count = 2, .key = key};
    const core_clip_data good = {
        .name = "c", .duration = 1, .bone_count = FIX_BONES, .track_count = 1, .track = &track};
    TEST_ASSERT_FALSE(core_handle_is_null(try_clip(&good)));
    core_clip_data bad = good;
    bad.duration = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(try_clip(&bad)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "duration"));
    bad.duration = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(try_clip(&bad)));
    bad = good;
    bad.bone_count = 5;
    TEST_ASSERT_TRUE(core_handle_is_null(try_clip(&bad)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "5 bones"));
    key[1].time = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(try_clip(&good)));
    key[1].time = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(try_clip(&good)));
    key[1].time = 1;
    key[1].rotation.w = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(try_clip(&good)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "zero rotation"));
    key[1].rotation.w = 1;
    track.bone = 3;
    TEST_ASSERT_TRUE(core_handle_is_null(try_clip(&good)));
}

static void test_bad_skeletons_are_refused(void) {
    core_mat4 inverse_bind[FIX_BONES];
    core_skeleton_data data = fix_skeleton_data(inverse_bind);
    const int32_t cycle[FIX_BONES] = {-1, 2, 1};
    data.parent = cycle;
    TEST_ASSERT_TRUE(core_handle_is_null(anim_skeleton_create(f.world, &data)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "parent 2"));
    data.parent = fix_parent;
    core_quat zero[FIX_BONES] = {{0, 0, 0, 0}};
    data.rotation = zero;
    TEST_ASSERT_TRUE(core_handle_is_null(anim_skeleton_create(f.world, &data)));
}

// 1e-5 of the skeleton's size against the double evaluator, over forward, backward and random
// times.
static void test_palettes_match_double_evaluator(void) {
    anim_clip clip = fix_clip(
        &f, (fix_clip_desc){
                .name = "turn", .duration = 1.7f, .from = -2, .to = 2.5f, .move = 2, .bone = 1});
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = clip;
    anim_instance i = anim_instance_create(f.world, &desc);
    for (int n = 0; n < 200; n++) {
        anim_instance_set_time(f.world, i, (float)((n * 7919) % 1000) * 0.0031f - 0.4f);
        anim_world_update(f.world, 0.01f);
        anim_world_pose(f.world);
        double error = anim_world_error_max(f.world, 0);
        TEST_ASSERT_TRUE_MESSAGE(error <= 1e-5 * 2.35, "beyond 1e-5 of the skeleton's size");
        TEST_ASSERT_TRUE(error > 0); // float and double never agree to the last bit here
    }
}

static void test_bind_pose_palette_is_identity(void) {
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    anim_instance i = anim_instance_create(f.world, &desc);
    anim_world_pose(f.world);
    uint32_t bones;
    const float *palette = anim_instance_palette(f.world, i, &bones);
    TEST_ASSERT_EQUAL_UINT32(FIX_BONES, bones);
    for (uint32_t b = 0; b < bones; b++) {
        for (uint32_t e = 0; e < 12; e++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-6f, e % 5 == 0 ? 1 : 0, palette[12 * b + e]);
        }
    }
}

// One bone turned by 90 degrees carries its vertex to a place known by hand; half weights go half
// way along the line between the two results.
static void test_skinning_by_hand(void) {
    anim_clip clip = fix_clip(
        &f, (fix_clip_desc){
                .name = "quarter", .duration = 1, .from = CORE_PI_F / 2, .bone = 1, .keys = 1});
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = clip;
    anim_instance i = anim_instance_create(f.world, &desc);
    anim_world_pose(f.world);
    uint32_t bones;
    const float *palette = anim_instance_palette(f.world, i, &bones);
    const float position[6] = {0, 2.5f, 0, 0, 2.5f, 0}, normal[6] = {0, 1, 0, 0, 1, 0};
    const uint16_t joint[8] = {1, 0, 0, 0, 1, 0, 0, 0};
    const float weight[8] = {1, 0, 0, 0, 0.5f, 0.5f, 0, 0};
    core_mesh_data mesh = {.vertex_count = 2,
                           .position = position,
                           .normal = normal,
                           .joint = joint,
                           .weight = weight};
    float p[6], n[6];
    TEST_ASSERT_TRUE(anim_skin(&mesh, palette, bones, p, n));
    // The arm's joint is at y = 1.5; a point 1 m above turns to 1 m beside it (-x).
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -1, p[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.5f, p[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -0.5f, p[3]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2, p[4]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -1, n[0]);
    TEST_ASSERT_FALSE(anim_skin(&mesh, palette, 1, p, n));
}

static void test_attachment_point(void) {
    anim_clip clip = fix_clip(
        &f, (fix_clip_desc){
                .name = "quarter", .duration = 1, .from = CORE_PI_F / 2, .bone = 1, .keys = 1});
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = clip;
    anim_instance i = anim_instance_create(f.world, &desc);
    anim_world_pose(f.world);
    core_mat4 m;
    TEST_ASSERT_TRUE(anim_instance_bone(f.world, i, 2, &m));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -0.75f, m.m[12]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.5f, m.m[13]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.1f, m.m[14]);
    TEST_ASSERT_FALSE(anim_instance_bone(f.world, i, 3, &m));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_linear_between_keys);
    RUN_TEST(test_key_times_hit_exactly);
    RUN_TEST(test_outside_the_keys);
    RUN_TEST(test_single_key);
    RUN_TEST(test_missing_tracks_keep_bind_pose);
    RUN_TEST(test_shortest_path);
    RUN_TEST(test_blend_ends_are_exact);
    RUN_TEST(test_step_keys);
    RUN_TEST(test_cubic_keys);
    RUN_TEST(test_bad_clips_are_refused);
    RUN_TEST(test_bad_skeletons_are_refused);
    RUN_TEST(test_palettes_match_double_evaluator);
    RUN_TEST(test_bind_pose_palette_is_identity);
    RUN_TEST(test_skinning_by_hand);
    RUN_TEST(test_attachment_point);
    return UNITY_END();
}
