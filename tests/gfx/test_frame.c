// One frame end to end on EGL surfaceless: light against closed forms, depth, text, errors.
#include "support/gfx_fixture.h"

#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const core_vec3 one = {1.0f, 1.0f, 1.0f};

static const float *pixel(const float *rgba, uint32_t width, uint32_t x, uint32_t y) {
    return rgba + 4 * ((size_t)y * width + x);
}

// A picture for people, and a few facts about it: lit, shaded, several colours.
static void test_spheres_in_a_box(void) {
    gfx_fixture f = gfx_fixture_open(320, 180, false);
    for (int i = 0; i < 60; ++i) {
        float x = (float)(i % 8) - 3.5f, z = (float)(i / 8) - 3.5f;
        gfx_add(f.world, "sphere", core_v3(x, 0.5f + 0.1f * (float)(i % 3), z), one,
                0.3f + 0.1f * (float)(i % 7), 0.5f, 0.9f - 0.1f * (float)(i % 5));
    }
    gfx_add(f.world, "box", core_v3(0.0f, -0.5f, 0.0f), core_v3(12.0f, 1.0f, 12.0f), .5f, .5f, .5f);
    gfx_add(f.world, "capsule", core_v3(0.0f, 2.0f, 0.0f), one, 0.9f, 0.2f, 0.2f);
    gfx_add(f.world, "cylinder", core_v3(2.0f, 2.0f, 0.0f), one, 0.2f, 0.9f, 0.2f);
    gfx_add_sun(f.world, core_v3(-0.5f, -1.0f, -0.3f), 3.0f);
    for (int i = 0; i < 8; ++i) {
        gfx_add_point(f.world, core_v3((float)i - 3.5f, 1.5f, 2.0f), 3.0f, 2.0f);
    }
    gfx_look(f.world, core_v3(5.0f, 5.0f, 8.0f), core_v3(0.0f, 0.5f, 0.0f));
    const float white[4] = {1.0f, 1.0f, 1.0f, 1.0f};
    gfx_print(f.world, 8.0f, 6.0f, 16.0f, white, "spheres \xe2\x80\x94 60");
    uint8_t *rgba = gfx_fixture_ldr(&f);
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_shot(f.device, "out/tests/gfx/spheres.png"),
                             core_last_error());
    bool seen[4096] = {false}; // 4 bits a channel
    uint32_t bright = 0, colors = 0;
    for (size_t i = 0; i < 320 * 180; ++i) {
        const uint8_t *p = rgba + 4 * i;
        uint32_t color = (uint32_t)(p[0] >> 4) << 8 | (uint32_t)(p[1] >> 4) << 4 | p[2] >> 4;
        colors += !seen[color];
        seen[color] = true;
        bright += p[0] > 128;
    }
    TEST_ASSERT_GREATER_THAN(500, bright);
    TEST_ASSERT_GREATER_THAN(80, colors); // shading gives many tones
    core_free(rgba);
    gfx_fixture_close(&f);
}

// Lambert: a white plane facing a sun of irradiance pi at 60 degrees has radiance cos 60 = 0.5.
static void test_lambert_under_a_sun(void) {
    gfx_fixture f = gfx_fixture_open(32, 32, true);
    gfx_world_set_ambient(f.world, 0.0f, 0.0f, 0.0f);
    gfx_instance i = gfx_add(f.world, "plane", core_v3(0, 0, 0), core_v3(50, 1, 50), 1, 1, 1);
    TEST_ASSERT_FALSE(core_handle_is_null(i));
    gfx_add_sun(f.world, core_v3(sinf(1.0471976f), -cosf(1.0471976f), 0.0f), CORE_PI_F);
    gfx_look(f.world, core_v3(0.0f, 5.0f, 0.001f), core_v3(0.0f, 0.0f, 0.0f));
    float *rgba = gfx_fixture_hdr(&f);
    float got = pixel(rgba, 32, 16, 16)[1];
    TEST_ASSERT_FLOAT_WITHIN(0.08f, 0.5f, got); // the specular lobe adds a little
    TEST_ASSERT_TRUE(got > 0.45f);
    core_free(rgba);
    gfx_fixture_close(&f);
}

// Debug views show what they are named for.
static void test_debug_views(void) {
    gfx_fixture f = gfx_fixture_open(16, 16, true);
    gfx_add(f.world, "plane", core_v3(0, 0, 0), core_v3(50, 1, 50), 1, 1, 1);
    gfx_add(f.world, "plane", core_v3(0, 1, 0), core_v3(50, 1, 50), 1, 1, 1);
    gfx_look(f.world, core_v3(0, 5.0f, 0.001f), core_v3(0, 0, 0));
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "debug", "normals"));
    float *rgba = gfx_fixture_hdr(&f);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, pixel(rgba, 16, 8, 8)[1]); // +Y is green
    core_free(rgba);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "debug", "overdraw"));
    gfx_world_set_background(f.world, 0, 0, 0);
    rgba = gfx_fixture_hdr(&f);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.2f, pixel(rgba, 16, 8, 8)[0]); // two layers
    core_free(rgba);
    for (int i = 0; i < 8; ++i) {
        gfx_add_point(f.world, core_v3(0, 1.5f, 0), 30.0f, 1.0f); // reach every cell in view
    }
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "debug", "lights"));
    rgba = gfx_fixture_hdr(&f);
    const float *p = pixel(rgba, 16, 8, 8); // heat of 8/32
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 1.0f, p[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 1.0f, p[2]);
    core_free(rgba);
    const char *const others[] = {"depth", "clusters", "off"};
    for (size_t i = 0; i < CORE_COUNT_OF(others); ++i) {
        TEST_ASSERT_TRUE(gfx_world_set(f.world, "debug", others[i]));
        TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    }
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_spheres_in_a_box);
    RUN_TEST(test_lambert_under_a_sun);
    RUN_TEST(test_debug_views);
    return UNITY_END();
}
