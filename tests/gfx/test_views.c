// Several views: parts of the picture, textures that materials show, each as if it were alone.
#include "support/gfx_fixture.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 64 };
static gfx_fixture f;

void setUp(void) {
    f = gfx_fixture_open(WIDTH, HEIGHT, false);
    for (int i = 0; i < 12; ++i) {
        gfx_add(f.world, i % 2 ? "box" : "sphere",
                core_v3((float)(i % 4) - 1.5f, 0.5f, (float)i / 4), core_v3(0.7f, 0.7f, 0.7f),
                0.2f + 0.05f * (float)i, 0.5f, 0.9f);
        gfx_add_point(f.world, core_v3((float)(i % 4) - 1.5f, 1.5f, (float)i / 3), 4.0f, 1.0f);
    }
    gfx_add(f.world, "plane", core_v3(0, 0, 0), core_v3(8, 1, 8), 0.7f, 0.7f, 0.7f);
    gfx_add_sun(f.world, core_v3(-0.4f, -1, -0.3f), 1.0f);
}
void tearDown(void) { gfx_fixture_close(&f); }

static gfx_camera look(core_vec3 eye, core_vec3 at) {
    gfx_look(f.world, eye, at);
    return gfx_world_camera(f.world);
}

static gfx_viewport add(const gfx_camera *c, float x, float y, float w, float h) {
    gfx_viewport_desc d = gfx_viewport_desc_default();
    d.camera = *c;
    d.rect[0] = x, d.rect[1] = y, d.rect[2] = w, d.rect[3] = h;
    gfx_viewport v = gfx_viewport_create(f.world, &d);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(v), core_last_error());
    return v;
}

static uint8_t *alone(const gfx_camera *c, uint32_t width, uint32_t height) {
    TEST_ASSERT_TRUE(gfx_device_resize(f.device, width, height));
    gfx_world_set_camera(f.world, c);
    f.width = width, f.height = height;
    uint8_t *rgba = gfx_fixture_ldr(&f);
    TEST_ASSERT_TRUE(gfx_device_resize(f.device, WIDTH, HEIGHT));
    f.width = WIDTH, f.height = HEIGHT;
    return rgba;
}

static void compare_part(const uint8_t *whole, int x, int y, const uint8_t *part, int w, int h) {
    for (int row = 0; row < h; ++row) {
        TEST_ASSERT_EQUAL_MEMORY(part + 4 * row * w, whole + 4 * ((y + row) * WIDTH + x),
                                 (size_t)w * 4);
    }
}

// Every part has the bytes of a picture of its size from its camera: lists, shadows, effects are
// each view's own.
static void test_parts_are_as_if_alone(void) {
    static const char *const set[][2] = {
        {"ao", "1"}, {"bloom", "0.3"}, {"fxaa", "on"}, {"shadows", "pcf"}, {"auto_exposure", "on"}};
    gfx_camera a = look(core_v3(2, 2, 5), core_v3(0, 0.5f, 1));
    gfx_camera b = look(core_v3(-3, 1, 3), core_v3(0, 0.5f, 1));
    gfx_camera top = {.position = {0, 9, 1},
                      .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                      .ortho_height = 6.0f};
    for (size_t i = 0; i < CORE_COUNT_OF(set); ++i) {
        TEST_ASSERT_TRUE_MESSAGE(gfx_world_set(f.world, set[i][0], set[i][1]), core_last_error());
    }
    uint8_t *want_a = alone(&a, 48, 64), *want_b = alone(&b, 48, 32),
            *want_top = alone(&top, 48, 32);
    add(&a, 0, 0, 0.5f, 1);
    add(&b, 0.5f, 0, 0.5f, 0.5f);
    gfx_viewport last = add(&top, 0.5f, 0.5f, 0.5f, 0.5f);
    for (int i = 0; i < 4; ++i) { // over all turns of the streams
        uint8_t *got = gfx_fixture_ldr(&f);
        compare_part(got, 0, 0, want_a, 48, 64);
        compare_part(got, 48, 0, want_b, 48, 32);
        compare_part(got, 48, 32, want_top, 48, 32);
        core_free(got);
    }
    size_t bytes = gfx_device_used(f.device).target_bytes;
    TEST_ASSERT_TRUE(gfx_viewport_destroy(f.world, last));
    TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
    TEST_ASSERT_TRUE(gfx_device_used(f.device).target_bytes < bytes);
    TEST_ASSERT_FALSE(gfx_viewport_alive(f.world, last));
    TEST_ASSERT_FALSE(gfx_viewport_destroy(f.world, last));
    core_free(want_a);
    core_free(want_b);
    core_free(want_top);
}

static gfx_viewport add_target(const char *name, const gfx_camera *c, uint32_t w, uint32_t h) {
    gfx_viewport_desc d = gfx_viewport_desc_default();
    d.camera = *c;
    d.target = name;
    d.width = w, d.height = h;
    return gfx_viewport_create(f.world, &d);
}

// A glowing plane that shows a target fills the view: it has the bytes of the target's own picture,
// within what encoding twice costs.
static void test_a_screen_shows_what_its_camera_sees(void) {
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "tonemap", "linear"));
    gfx_camera eye = look(core_v3(2, 2, 5), core_v3(0, 0.5f, 1));
    uint8_t *want = alone(&eye, WIDTH, HEIGHT);
    gfx_viewport view = add_target("screen", &eye, WIDTH, HEIGHT);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(view), core_last_error());
    gfx_material_desc m = gfx_material_desc_default();
    memset(m.data.base_color, 0, sizeof m.data.base_color);
    m.data.base_color[3] = 1.0f;
    m.data.roughness = 1.0f;
    m.data.emissive[0] = m.data.emissive[1] = m.data.emissive[2] = 1.0f;
    strcpy(m.data.emissive_image, "target:screen");
    gfx_instance_desc d = {.mesh = gfx_mesh_builtin(f.world, "plane"),
                           .material = gfx_material_create(f.world, &m)};
    gfx_instance plane = gfx_instance_create(f.world, &d);
    // Far away, where neither the lights nor the target's camera are.
    gfx_instance_set_transform(f.world, plane, core_v3(0, -500, 0), core_quat_identity(),
                               core_v3(1.5f, 1, 1));
    gfx_camera front = {.position = {0, -495, 0},
                        .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                        .ortho_height = 1.0f};
    gfx_world_set_camera(f.world, &front);
    uint8_t *got = gfx_fixture_ldr(&f);
    int worst = 0, sum = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 4; ++i) {
        int off = got[i] > want[i] ? got[i] - want[i] : want[i] - got[i];
        sum += off;
        worst = off > worst ? off : worst;
    }
    printf("a screen: %d of 255 off at most, %.2f in the mean\n", worst,
           (double)sum / (WIDTH * HEIGHT * 4));
    TEST_ASSERT_TRUE(sum <= WIDTH * HEIGHT * 4 * 3); // the sun adds its share to the black plane
    core_free(got);
    core_free(want);
    TEST_ASSERT_TRUE(gfx_viewport_destroy(f.world, view));
    got = gfx_fixture_ldr(&f); // a checker: magenta here and there
    bool magenta = false;
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        magenta |= got[4 * i] > 250 && got[4 * i + 1] < 60 && got[4 * i + 2] > 250;
    }
    TEST_ASSERT_TRUE(magenta);
    core_free(got);
}

static void test_bad_views_are_refused(void) {
    gfx_camera c = look(core_v3(2, 2, 5), core_v3(0, 0.5f, 1));
    gfx_viewport_desc d = gfx_viewport_desc_default();
    d.camera = c;
    d.rect[0] = 0.6f; // and 1 wide
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_viewport_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "shares of the picture"));
    TEST_ASSERT_TRUE(core_handle_is_null(add_target("x", &c, 0, 10)));
    TEST_ASSERT_FALSE(core_handle_is_null(add_target("x", &c, 8, 8)));
    TEST_ASSERT_TRUE(core_handle_is_null(add_target("x", &c, 8, 8)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "another view"));
    d.cookie = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_viewport_create(f.world, &d)));
    TEST_ASSERT_FALSE(gfx_viewport_set_camera(f.world, CORE_NULL_HANDLE, &c));
}

static void test_a_frame_of_many_views_allocates_nothing(void) {
    gfx_camera c = look(core_v3(2, 2, 5), core_v3(0, 0.5f, 1));
    for (int i = 0; i < 4; ++i) {
        add(&c, 0.25f * (float)i, 0, 0.25f, 1);
    }
    add_target("t", &c, 32, 32);
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    }
    uint64_t before = core_alloc_count();
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
    }
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_parts_are_as_if_alone);
    RUN_TEST(test_a_screen_shows_what_its_camera_sees);
    RUN_TEST(test_bad_views_are_refused);
    RUN_TEST(test_a_frame_of_many_views_allocates_nothing);
    return UNITY_END();
}
