// Lines in the world: where they are drawn, how wide, what hides them, and that none cost nothing.
#include "support/gfx_fixture.h"

#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

enum { W = 64, H = 64 };
static const core_vec3 one = {1, 1, 1};

// Looks along -Z from (0, 0, 5); at z = 0 the frame is 5.77 m high.
static gfx_fixture open_dark(void) {
    gfx_fixture f = gfx_fixture_open(W, H, true);
    gfx_world_set_background(f.world, 0, 0, 0);
    gfx_world_set_ambient(f.world, 0, 0, 0);
    gfx_look(f.world, core_v3(0, 0, 5), core_v3(0, 0, 0));
    return f;
}

static double sum(const float *rgba, int channel, int y0, int y1) {
    double total = 0;
    for (int i = y0 * W; i < y1 * W; ++i) {
        total += (double)rgba[4 * i + channel];
    }
    return total;
}

static void test_a_line_has_its_width_anywhere(void) {
    gfx_fixture f = open_dark();
    for (int k = 0; k < 3; ++k) { // 1 m and 50 m away, and through the eye's plane
        float z = k == 0 ? 4.0f : -45.0f, end = k == 2 ? 10.0f : z;
        gfx_pen pen = gfx_pen_default();
        pen.width = 4.0f;
        gfx_world_begin_frame(f.world);
        gfx_draw_line(f.world, core_v3(0, -100, z), core_v3(0, k == 2 ? -90.0f : 100.0f, end),
                      &pen);
        float *rgba = gfx_fixture_hdr(&f);
        if (k < 2) {
            TEST_ASSERT_DOUBLE_WITHIN(0.02, 4.0, sum(rgba, 0, 32, 33));
            TEST_ASSERT_EQUAL_FLOAT(1.0f, rgba[4 * (32 * W + 32)]);
            TEST_ASSERT_EQUAL_UINT32(1, gfx_world_stats(f.world).draws);
        } else { // runs below the frame and past the eye: no flash across the picture
            TEST_ASSERT_TRUE(sum(rgba, 0, 0, 30) < 1.0);
        }
        core_free(rgba);
    }
    gfx_fixture_close(&f);
}

static void test_what_hides_a_line(void) {
    gfx_fixture f = open_dark();
    gfx_add(f.world, "box", core_v3(0, 0, 0), one, 0, 0, 0);
    gfx_pen pen = gfx_pen_default();
    for (int on_top = 0; on_top < 2; ++on_top) {
        pen.on_top = on_top;
        gfx_world_begin_frame(f.world);
        gfx_draw_line(f.world, core_v3(-9, 0, -2), core_v3(9, 0, -2), &pen);
        float *rgba = gfx_fixture_hdr(&f);
        TEST_ASSERT_TRUE((rgba[4 * (32 * W + 32)] > 0.5f) == (on_top == 1));
        TEST_ASSERT_TRUE(rgba[4 * (32 * W + 4)] > 0.5f); // beside the box it shows
        core_free(rgba);
    }
    // A line in the face of the box is not lost in it.
    pen.on_top = false;
    gfx_world_begin_frame(f.world);
    gfx_draw_line(f.world, core_v3(-0.5f, 0, 0.5f), core_v3(0.5f, 0, 0.5f), &pen);
    float *rgba = gfx_fixture_hdr(&f);
    TEST_ASSERT_TRUE(rgba[4 * (32 * W + 32)] > 0.5f);
    core_free(rgba);
    gfx_fixture_close(&f);
}

static void test_shapes_reach_their_size(void) {
    gfx_fixture f = open_dark();
    gfx_camera c = gfx_world_camera(f.world);
    c.ortho_height = 8.0f; // 8 pixels a metre
    gfx_world_set_camera(f.world, &c);
    gfx_pen pen = gfx_pen_default();
    pen.width = 1.0f;
    for (int k = 0; k < 4; ++k) {
        gfx_world_begin_frame(f.world);
        switch (k) {
        case 0:
            gfx_draw_sphere(f.world, core_v3(0, 0, 0), 2.0f, &pen);
            break;
        case 1:
            gfx_draw_box(f.world, core_v3(0, 0, 0), (core_quat){0}, core_v3(1, 2, 1), &pen);
            break;
        case 2:
            gfx_draw_capsule(f.world, core_v3(0, -1, 0), core_v3(0, 1, 0), 1.0f, &pen);
            break;
        default:
            gfx_draw_arrow(f.world, core_v3(0, -2, 0), core_v3(0, 2, 0), &pen);
            break;
        }
        float *rgba = gfx_fixture_hdr(&f);
        // 2 m up and down: rows 16 and 48; the pixels next to the outside are dark.
        TEST_ASSERT_TRUE(sum(rgba, 0, 15, 17) > 0.9);
        TEST_ASSERT_TRUE(sum(rgba, 0, 47, 49) > 0.9);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, sum(rgba, 0, 0, 14));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, sum(rgba, 0, 50, H));
        core_free(rgba);
    }
    gfx_fixture_close(&f);
}

static void test_no_lines_no_pass(void) {
    gfx_fixture f = open_dark();
    gfx_pen pen = gfx_pen_default();
    core_free(gfx_fixture_hdr(&f));
    gfx_device_use before = gfx_device_used(f.device);
    gfx_draw_line(f.world, core_v3(0, 0, 0), core_v3(0, INFINITY, 0), &pen);
    core_free(gfx_fixture_hdr(&f)); // not finite: no line
    gfx_device_use none = gfx_device_used(f.device);
    TEST_ASSERT_EQUAL_UINT32(before.passes, none.passes);
    TEST_ASSERT_EQUAL_UINT32(before.shader_variants, none.shader_variants);
    gfx_draw_grid(f.world, core_v3(0, 0, 0), 4.0f, 4, &pen);
    core_free(gfx_fixture_hdr(&f));
    gfx_device_use some = gfx_device_used(f.device);
    TEST_ASSERT_EQUAL_UINT32(before.passes + 1, some.passes);
    TEST_ASSERT_EQUAL_UINT32(before.shader_variants + 1, some.shader_variants);
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_line_has_its_width_anywhere);
    RUN_TEST(test_what_hides_a_line);
    RUN_TEST(test_shapes_reach_their_size);
    RUN_TEST(test_no_lines_no_pass);
    return UNITY_END();
}
