// What no picture can be made of: transforms, cameras, lights and bones that are flat, endless or
// no number. Frames are drawn all the same, in every renderer, without a GL error, and what is
// sound in the scene stays as it is.
#include "support/gfx_fixture.h"

#include "unity.h"

#include <math.h>

enum { WIDTH = 48, HEIGHT = 32 };
static gfx_fixture f;

void setUp(void) {
    f = gfx_fixture_open(WIDTH, HEIGHT, true);
    gfx_add(f.world, "box", core_v3(0, 0, 0), core_v3(1, 1, 1), 0.8f, 0.7f, 0.6f);
    gfx_add_sun(f.world, core_v3(-1, -2, -1), 2.0f);
    gfx_add_point(f.world, core_v3(1, 1, 2), 5, 2);
    gfx_add_point(f.world, core_v3(-1, 1, 2), 5, 2);
    gfx_look(f.world, core_v3(0, 1, 4), core_v3(0, 0, 0));
}
void tearDown(void) { gfx_fixture_close(&f); }

static void draw_in_every_way(void) {
    const char *const renders[] = {"forward", "clustered", "clustered", "clustered", "clustered"};
    const char *const methods[] = {"simd", "simd", "naive", "per_light", "gpu"};
    for (size_t i = 0; i < CORE_COUNT_OF(renders); ++i) {
        TEST_ASSERT_TRUE(gfx_world_set(f.world, "render", renders[i]));
        TEST_ASSERT_TRUE(gfx_world_set(f.world, "assign", methods[i]));
        TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    }
}

// How much the picture of the sound box changes.
static float change_of(void (*spoil)(void)) {
    float *before = gfx_fixture_hdr(&f);
    spoil();
    draw_in_every_way();
    float *after = gfx_fixture_hdr(&f);
    float change = gfx_max_difference(before, after, WIDTH * HEIGHT * 4);
    core_free(before);
    core_free(after);
    return change;
}

static void add_scaled(core_vec3 at, core_vec3 scale) {
    gfx_instance i = gfx_add(f.world, "sphere", core_v3(0, 0, 0), core_v3(1, 1, 1), 1, 1, 1);
    gfx_instance_set_transform(f.world, i, at, core_quat_identity(), scale);
}

static void spoil_transforms(void) {
    const core_vec3 away = {0, 0, 50}; // behind the camera
    add_scaled(away, core_v3(0, 0, 0));
    add_scaled(away, core_v3(1, 0, 1));
    add_scaled(away, core_v3(-1, 0, 0));
    add_scaled(away, core_v3(NAN, 1, 1));
    add_scaled(core_v3(NAN, NAN, NAN), core_v3(1, 1, 1));
    add_scaled(core_v3(INFINITY, 0, 0), core_v3(1, 1, 1));
    add_scaled(core_v3(3e38f, 3e38f, 3e38f), core_v3(1, 1, 1));
    gfx_instance i = gfx_add(f.world, "box", core_v3(0, 0, 0), core_v3(1, 1, 1), 1, 1, 1);
    gfx_instance_set_transform(f.world, i, away, (core_quat){0, 0, 0, 0}, core_v3(1, 1, 1));
    gfx_instance_set_transform(f.world, i, away, (core_quat){NAN, 0, 0, 1}, core_v3(1, 1, 1));
}
static void test_transforms(void) {
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.0f, change_of(spoil_transforms));
}

static void spoil_lights(void) {
    gfx_light good = gfx_add_point(f.world, core_v3(0, 50, 0), 1, 1);
    const core_vec3 wild[] = {{NAN, 0, 0}, {INFINITY, 0, 0}, {3e38f, 3e38f, -3e38f}};
    for (size_t i = 0; i < CORE_COUNT_OF(wild); ++i) {
        gfx_light_desc d = gfx_light_desc_default(i & 1 ? GFX_SPOT : GFX_POINT);
        d.position = wild[i];
        gfx_light_create(f.world, &d); // refused, or dark
        gfx_light_set_position(f.world, good, wild[i]);
        gfx_light_set_direction(f.world, good, wild[i]);
    }
    gfx_light_desc tiny = gfx_light_desc_default(GFX_POINT);
    tiny.position = core_v3(0, 50, 0);
    tiny.radius = 1e-30f; // its square is no number above zero
    gfx_light_create(f.world, &tiny);
}
static void test_lights(void) { TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.0f, change_of(spoil_lights)); }

// A light of endless reach is no sun: it lights by the distance.
static void test_endless_reach(void) {
    gfx_light_desc d = gfx_light_desc_default(GFX_POINT);
    d.position = core_v3(0, 3, 3);
    d.radius = 1e30f;
    gfx_light far_reaching = gfx_light_create(f.world, &d);
    float *endless = gfx_fixture_hdr(&f);
    gfx_light_destroy(f.world, far_reaching);
    d.radius = 1e4f;
    gfx_light_create(f.world, &d);
    float *wide = gfx_fixture_hdr(&f);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.0f, gfx_max_difference(endless, wide, WIDTH * HEIGHT * 4));
    core_free(endless);
    core_free(wide);
}

static void test_cameras(void) {
    const gfx_camera cameras[] = {
        {.position = {NAN, 0, 0}},
        {.position = {INFINITY, 0, 0}},
        {.rotation = {NAN, 0, 0, 1}},
        {.position = {0, 0, 4}, .fovy = 4.0f},
        {.position = {0, 0, 4}, .fovy = -1.0f},
        {.position = {0, 0, 4}, .fovy = 1e-20f},
        {.position = {0, 0, 4}, .near_plane = INFINITY},
        {.position = {0, 0, 4}, .near_plane = 10, .virtual_far = 1},
        {.position = {0, 0, 4}, .virtual_far = 1e38f},
        {.position = {0, 0, 4}, .ortho_height = 1e-30f},
        {.position = {0, 0, 4}, .ortho_height = 1e30f},
    };
    for (size_t i = 0; i < CORE_COUNT_OF(cameras); ++i) {
        gfx_world_set_camera(f.world, &cameras[i]);
        draw_in_every_way();
    }
    gfx_look(f.world, core_v3(0, 1, 4), core_v3(0, 0, 0));
    float *after = gfx_fixture_hdr(&f), lit = 0.0f;
    for (int i = 0; i < WIDTH * HEIGHT * 4; ++i) {
        TEST_ASSERT_TRUE(isfinite(after[i]));
        lit = fmaxf(lit, after[4 * (i / 4)]);
    }
    TEST_ASSERT_TRUE(lit > 0.1f);
    core_free(after);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_transforms);
    RUN_TEST(test_lights);
    RUN_TEST(test_endless_reach);
    RUN_TEST(test_cameras);
    return UNITY_END();
}
