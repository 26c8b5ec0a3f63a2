// Terrain: what is drawn against the field of heights itself, seen through the depth of the
// picture: no cracks, no more error than the pixels asked for, no jump between levels.
#include "support/gfx_fixture.h"

#include "core/rng.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { W = 160, H = 120, POINTS = 385 };
static const float STEP = 1.5f, NEAR = 0.5f;
static float heights[POINTS * POINTS];
static gfx_fixture f;
static gfx_terrain terrain;

void setUp(void) {}
void tearDown(void) {}

static float noise(int x, int z) {
    uint64_t bits = core_rng_at(9, 1, (uint64_t)(x & 1023) << 10 | (uint64_t)(z & 1023));
    return (float)(bits >> 40) * 0x1p-24f;
}

static float smooth_noise(float x, float z) {
    int i = (int)x, k = (int)z;
    float u = x - (float)i, v = z - (float)k;
    u = u * u * (3 - 2 * u), v = v * v * (3 - 2 * v);
    float a = noise(i, k) + (noise(i + 1, k) - noise(i, k)) * u;
    float b = noise(i, k + 1) + (noise(i + 1, k + 1) - noise(i, k + 1)) * u;
    return a + (b - a) * v;
}

// Hills with roughness down to the grid, so that every level is off by something.
static void make_heights(void) {
    for (int z = 0; z < POINTS; ++z) {
        for (int x = 0; x < POINTS; ++x) {
            float y = 0, size = 96, weight = 40;
            for (int octave = 0; octave < 7; ++octave, size /= 2, weight *= 0.42f) {
                y += weight * smooth_noise((float)x / size, (float)z / size);
            }
            heights[z * POINTS + x] = y;
        }
    }
}

static void open_terrain(float error) {
    f = gfx_fixture_open(W, H, true);
    make_heights();
    gfx_terrain_desc d = gfx_terrain_desc_default();
    float corner = -0.5f * STEP * (POINTS - 1);
    d.heights = (core_heights_data){.columns = POINTS,
                                    .rows = POINTS,
                                    .step_x = STEP,
                                    .step_z = STEP,
                                    .origin = {corner, 0, corner},
                                    .height = heights};
    terrain = gfx_terrain_create(f.world, &d);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(terrain), core_last_error());
    char text[32];
    snprintf(text, sizeof text, "%g", (double)error);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "terrain_error", text));
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "shadows", "off"));
}

// Above the ground at x, z, looking along a heading and down.
static gfx_camera look(float x, float z, float above, float heading, float down) {
    float y = 0;
    TEST_ASSERT_TRUE(gfx_terrain_height(f.world, terrain, x, z, &y));
    gfx_camera c = {.position = {x, y + above, z}, .near_plane = NEAR, .virtual_far = 2000.0f};
    c.rotation = core_quat_mul(core_quat_axis_angle(core_v3(0, 1, 0), heading),
                               core_quat_axis_angle(core_v3(1, 0, 0), -down));
    gfx_world_set_camera(f.world, &c);
    return c;
}

static float *render_depth(void) {
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    float *depth = core_alloc(W * H * sizeof *depth);
    TEST_ASSERT_TRUE(gfx_device_read_depth(f.device, depth));
    return depth;
}

// Where the surface is that a pixel shows.
static core_vec3 surface(const gfx_camera *c, const float *depth, int x, int y) {
    core_vec3 from, along;
    gfx_camera_ray(c, W, H, (float)x + 0.5f, (float)y + 0.5f, &from, &along);
    core_vec3 ahead = core_quat_rotate(c->rotation, core_v3(0, 0, -1));
    return core_v3_mad(from, along, NEAR / depth[y * W + x] / core_v3_dot(along, ahead));
}

// Pixels that a pixel's surface is off the true one, up or down.
static float off(const gfx_camera *c, const float *depth, int x, int y) {
    float truth;
    core_vec3 p = surface(c, depth, x, y);
    if (depth[y * W + x] == 0.0f || !gfx_terrain_height(f.world, terrain, p.x, p.z, &truth)) {
        return 0.0f;
    }
    core_vec3 on_screen = gfx_camera_project(c, W, H, p);
    core_vec3 should = gfx_camera_project(c, W, H, core_v3(p.x, truth, p.z));
    float dx = on_screen.x - should.x, dy = on_screen.y - should.y;
    return core_sqrtf(dx * dx + dy * dy);
}

static void test_the_finest_level_is_the_field_itself(void) {
    open_terrain(0.0f);
    gfx_camera c = look(10, -20, 60, 0.3f, 1.2f);
    float *depth = render_depth(), worst = 0;
    for (int i = 0; i < W * H; ++i) {
        worst = CORE_MAX(worst, off(&c, depth, i % W, i / W));
    }
    TEST_ASSERT_TRUE(worst < 0.01f);
    core_free(depth);
    gfx_fixture_close(&f);
}

static void test_error_stays_within_the_pixels_asked_for(void) {
    const float errors[] = {0.5f, 0.7f, 1.0f};
    uint32_t triangles[3];
    for (int e = 0; e < 3; ++e) {
        open_terrain(errors[e]);
        float worst = 0;
        for (int k = 0; k < 6; ++k) {
            gfx_camera c = look(-200.0f + 70.0f * (float)k, 40.0f * (float)k - 90.0f,
                                4.0f + 12.0f * (float)k, (float)k, 0.15f * (float)k);
            float *depth = render_depth();
            for (int i = 0; i < W * H; ++i) {
                worst = CORE_MAX(worst, off(&c, depth, i % W, i / W));
            }
            core_free(depth);
        }
        triangles[e] = gfx_world_stats(f.world).triangles;
        char name[64];
        snprintf(name, sizeof name, "terrain off its field, %g pixels asked for",
                 (double)errors[e]);
        accuracy_at_most(name, (double)worst, (double)errors[e], "pixels");
        TEST_ASSERT_TRUE(worst > 0.2f * errors[e]); // and what was asked for is used
        gfx_fixture_close(&f);
    }
    TEST_ASSERT_TRUE(triangles[0] >= triangles[1] && triangles[1] > triangles[2]);
}

// Looking at the middle of the ground from everywhere, coarse, there is ground in every pixel.
static void test_no_cracks(void) {
    open_terrain(6.0f);
    for (int k = 0; k < 24; ++k) {
        look(-150.0f + 7.3f * (float)k, 130.0f - 6.1f * (float)k, 8.0f + 2.0f * (float)k,
             0.7f * (float)k, 1.15f);
        float *depth = render_depth();
        int holes = 0;
        for (int i = 0; i < W * H; ++i) {
            holes += depth[i] == 0.0f;
        }
        TEST_ASSERT_EQUAL_INT(0, holes);
        core_free(depth);
    }
    gfx_fixture_close(&f);
}

// From one frame to the next, 3 cm on, no part of the surface moves by a sixth of a pixel.
static void test_levels_do_not_jump(void) {
    open_terrain(3.0f);
    float *last = core_alloc(W * H * sizeof *last);
    float worst = 0, furthest = 0;
    for (int k = 0; k < 32; ++k) {
        gfx_camera c = look(0, 0, 30, 0.4f, 0.5f);
        c.position.x += 0.03f * (float)k, c.position.y = 75.0f;
        gfx_world_set_camera(f.world, &c);
        float *depth = render_depth();
        for (int i = 0; i < W * H; ++i) {
            float now = off(&c, depth, i % W, i / W);
            bool ridge = false; // a pixel that shows another slope than before tells nothing
            for (int n = 0; n < 4; ++n) {
                int j = i + (n == 0 ? 1 : n == 1 ? -1 : n == 2 ? W : -W);
                float other = j >= 0 && j < W * H ? depth[j] : 0.0f;
                ridge |= fabsf(other - depth[i]) > 0.1f * depth[i];
            }
            if (k && !ridge) {
                worst = CORE_MAX(worst, fabsf(now - last[i]));
            }
            furthest = CORE_MAX(furthest, now);
            last[i] = now;
        }
        core_free(depth);
    }
    TEST_ASSERT_TRUE(furthest > 0.3f); // levels are at work
    accuracy_at_most("terrain moves from frame to frame", (double)worst, 0.15, "pixels");
    core_free(last);
    gfx_fixture_close(&f);
}

static void test_level_ground_is_cheap(void) {
    gfx_fixture flat = gfx_fixture_open(W, H, true);
    float *zero = core_alloc(1025 * 1025 * sizeof *zero);
    memset(zero, 0, 1025 * 1025 * sizeof *zero);
    gfx_terrain_desc d = gfx_terrain_desc_default();
    d.heights = (core_heights_data){.columns = 1025, .rows = 1025, .step_x = 1, .step_z = 1};
    d.heights.height = zero;
    gfx_terrain t = gfx_terrain_create(flat.world, &d);
    core_free(zero); // it was copied
    gfx_look(flat.world, core_v3(512, 40, 512), core_v3(700, 0, 700));
    TEST_ASSERT_TRUE(gfx_device_render(flat.device, flat.world));
    uint32_t triangles = gfx_world_stats(flat.world).triangles;
    TEST_ASSERT_TRUE(triangles > 0 && triangles < 60000); // of two million
    TEST_ASSERT_TRUE(gfx_terrain_destroy(flat.world, t));
    TEST_ASSERT_TRUE(gfx_device_render(flat.device, flat.world));
    TEST_ASSERT_EQUAL_UINT32(0, gfx_world_stats(flat.world).triangles);
    gfx_fixture_close(&flat);
}

// A box hovering over the ground shades it, and a hill shades the valley behind.
static void test_ground_takes_and_casts_shadows(void) {
    gfx_fixture g = gfx_fixture_open(64, 64, true);
    float ridge[65 * 65];
    for (int i = 0; i < 65 * 65; ++i) {
        int x = i % 65;
        ridge[i] = x > 28 && x < 36 ? 8.0f : 0.0f;
    }
    gfx_terrain_desc d = gfx_terrain_desc_default();
    d.heights = (core_heights_data){.columns = 65, .rows = 65, .step_x = 1, .step_z = 1};
    d.heights.origin = core_v3(-32, 0, -32);
    d.heights.height = ridge;
    gfx_terrain_create(g.world, &d);
    gfx_world_set_ambient(g.world, 0, 0, 0);
    gfx_add(g.world, "box", core_v3(-14, 6, 0), core_v3(6, 1, 6), 1, 1, 1);
    gfx_add_sun(g.world, core_v3(1.0f, -1.0f, 0.0f), CORE_PI_F);
    gfx_camera c = {.position = {0, 60, 0},
                    .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                    .ortho_height = 64.0f}; // a metre a pixel
    gfx_world_set_camera(g.world, &c);
    float *rgba = gfx_fixture_hdr(&g);
    const struct {
        int x, z;
        bool lit;
    } at[] = {{-26, 20, true}, {-8, 0, false}, {-8, 12, true}, {8, 10, false}, {20, 10, true}};
    for (size_t i = 0; i < CORE_COUNT_OF(at); ++i) {
        float green = rgba[4 * ((32 + at[i].z) * 64 + 32 + at[i].x) + 1];
        TEST_ASSERT_TRUE_MESSAGE((green > 0.02f) == at[i].lit, at[i].lit ? "not lit" : "not dark");
    }
    core_free(rgba);
    gfx_fixture_close(&g);
}

static void test_errors(void) {
    open_terrain(1.0f);
    gfx_terrain_desc d = gfx_terrain_desc_default();
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_terrain_create(f.world, &d)));
    float bad[4] = {0, 1, NAN, 2};
    d.heights =
        (core_heights_data){.columns = 2, .rows = 2, .step_x = 1, .step_z = 1, .height = bad};
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_terrain_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "column 0, row 1"));
    bad[2] = 5;
    d.heights.step_x = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_terrain_create(f.world, &d)));
    d.heights.step_x = 1;
    gfx_terrain small = gfx_terrain_create(f.world, &d);
    float y;
    TEST_ASSERT_TRUE(gfx_terrain_height(f.world, small, 0.25f, 0.75f, &y));
    TEST_ASSERT_EQUAL_FLOAT(0.25f * 2 + 0.5f * 5, y); // between corners 0, 5 and 2
    TEST_ASSERT_FALSE(gfx_terrain_height(f.world, small, 1.1f, 0, &y));
    TEST_ASSERT_TRUE(gfx_terrain_destroy(f.world, small));
    TEST_ASSERT_FALSE(gfx_terrain_destroy(f.world, small));
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_finest_level_is_the_field_itself);
    RUN_TEST(test_error_stays_within_the_pixels_asked_for);
    RUN_TEST(test_no_cracks);
    RUN_TEST(test_levels_do_not_jump);
    RUN_TEST(test_level_ground_is_cheap);
    RUN_TEST(test_ground_takes_and_casts_shadows);
    RUN_TEST(test_errors);
    return UNITY_END();
}
