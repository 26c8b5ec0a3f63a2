// The clustered picture equals plain forward exactly, whatever the lights, grid, view and size.
#include "support/gfx_fixture.h"

#include "core/rng.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

static core_vec3 random_point(core_rng *rng, core_vec3 half) {
    float x = core_rng_float(rng), y = core_rng_float(rng), z = core_rng_float(rng);
    return core_v3((2.0f * x - 1.0f) * half.x, (2.0f * y - 1.0f) * half.y,
                   (2.0f * z - 1.0f) * half.z);
}

// Boxes on a floor under n lights, some of them spots.
static gfx_fixture open_scene(uint32_t width, uint32_t height, uint32_t lights, float radius) {
    gfx_fixture f = gfx_fixture_open(width, height, true);
    core_rng rng = core_rng_make(7, 1);
    gfx_add(f.world, "box", core_v3(0, -0.5f, 0), core_v3(60, 1, 60), 0.8f, 0.8f, 0.8f);
    for (int i = 0; i < 60; ++i) {
        core_vec3 p = random_point(&rng, core_v3(20, 0, 20));
        gfx_add(f.world, i % 2 ? "box" : "sphere", core_v3(p.x, 1.0f, p.z), core_v3(2, 2, 2), 0.9f,
                0.7f, 0.5f);
    }
    for (uint32_t i = 0; i < lights; ++i) {
        gfx_light_desc d = gfx_light_desc_default(i % 4 == 3 ? GFX_SPOT : GFX_POINT);
        d.position = core_v3_add(random_point(&rng, core_v3(25, 3, 25)), core_v3(0, 3, 0));
        d.direction = random_point(&rng, core_v3(1, 1, 1));
        d.radius = radius * (0.5f + core_rng_float(&rng));
        d.inner = 0.2f;
        d.outer = 0.3f + core_rng_float(&rng) * 1.2f;
        d.color[1] = core_rng_float(&rng);
        gfx_light_create(f.world, &d);
    }
    gfx_add_sun(f.world, core_v3(1, -2, 0.5f), 0.5f);
    gfx_look(f.world, core_v3(0, 4, 24), core_v3(0, 0, 0));
    return f;
}

static void set(gfx_fixture *f, const char *name, const char *value) {
    TEST_ASSERT_TRUE_MESSAGE(gfx_world_set(f->world, name, value), core_last_error());
}

static double largest_difference; // of all pictures

static void expect_equal(gfx_fixture *f, const char *what) {
    set(f, "render", "forward");
    float *forward = gfx_fixture_hdr(f);
    set(f, "render", "clustered");
    float *clustered = gfx_fixture_hdr(f);
    size_t n = (size_t)f->width * f->height * 4;
    float difference = gfx_max_difference(forward, clustered, n);
    largest_difference = fmax(largest_difference, (double)difference);
    TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0.0f, difference, what);
    core_free(forward);
    core_free(clustered);
}

static void test_light_counts(void) {
    const uint32_t counts[] = {0, 1, 7, 64, 300};
    for (size_t i = 0; i < CORE_COUNT_OF(counts); ++i) {
        gfx_fixture f = open_scene(64, 36, counts[i], 5.0f);
        expect_equal(&f, "light count");
        gfx_fixture_close(&f);
    }
}

static void test_methods_slices_and_grids(void) {
    gfx_fixture f = open_scene(80, 45, 100, 4.0f);
    const char *const methods[] = {"naive", "per_light", "simd", "gpu"};
    const char *const grids[] = {"16x9x24", "1x1x1", "7x5x3", "64x64x64"};
    for (size_t m = 0; m < CORE_COUNT_OF(methods); ++m) {
        for (size_t g = 0; g < CORE_COUNT_OF(grids); ++g) {
            set(&f, "assign", methods[m]);
            set(&f, "clusters", grids[g]);
            expect_equal(&f, grids[g]);
        }
    }
    set(&f, "clusters", "16x9x24");
    set(&f, "slices", "linear");
    expect_equal(&f, "linear slices");
    set(&f, "slices", "exponential");
    set(&f, "first_slice", "0");
    expect_equal(&f, "slices from the near plane");
    gfx_fixture_close(&f);
}

static void test_odd_sizes(void) {
    const uint32_t sizes[][2] = {{1, 1}, {3, 2}, {17, 31}, {101, 57}};
    for (size_t i = 0; i < CORE_COUNT_OF(sizes); ++i) {
        gfx_fixture f = open_scene(sizes[i][0], sizes[i][1], 80, 5.0f);
        expect_equal(&f, "odd size");
        gfx_fixture_close(&f);
    }
}

static void test_views(void) {
    gfx_fixture f = open_scene(64, 36, 120, 6.0f);
    const core_vec3 eyes[][2] = {
        {{0, 1, 0}, {5, 1, 0}},      {{0, 30, 0.01f}, {0, 0, 0}}, {{25, 0.5f, 25}, {0, 2, 0}},
        {{-3, 2, 4}, {-3, 9, 4.1f}}, {{0, 3, 80}, {0, 0, 0}},     {{0, 3, 140}, {0, 0, 0}},
    };
    for (size_t i = 0; i < CORE_COUNT_OF(eyes); ++i) {
        gfx_look(f.world, eyes[i][0], eyes[i][1]);
        expect_equal(&f, "view");
    }
    gfx_camera c = gfx_world_camera(f.world);
    c.ortho_height = 30.0f;
    gfx_world_set_camera(f.world, &c);
    expect_equal(&f, "orthographic");
    c.virtual_far = 20.0f;
    c.ortho_height = 0.0f;
    gfx_world_set_camera(f.world, &c);
    gfx_look(f.world, core_v3(0, 4, 24), core_v3(0, 0, 0));
    expect_equal(&f, "virtual far plane in the picture");
    gfx_fixture_close(&f);
}

// Four views share a frame, each with lists of its own: byte for byte the same picture.
static void test_several_views_of_a_frame(void) {
    gfx_fixture f = open_scene(97, 61, 150, 6.0f);
    const core_vec3 eyes[4] = {{0, 4, 24}, {20, 2, 0}, {0, 30, 0.01f}, {-3, 1, 4}};
    for (int i = 0; i < 4; ++i) {
        gfx_viewport_desc d = gfx_viewport_desc_default();
        gfx_look(f.world, eyes[i], core_v3(0, 0, 0));
        d.camera = gfx_world_camera(f.world);
        d.camera.ortho_height = i == 2 ? 40.0f : 0.0f;
        d.rect[0] = 0.5f * (float)(i % 2), d.rect[1] = 0.5f * (float)(i / 2);
        d.rect[2] = d.rect[3] = 0.5f;
        TEST_ASSERT_FALSE(core_handle_is_null(gfx_viewport_create(f.world, &d)));
    }
    set(&f, "render", "forward");
    uint8_t *forward = gfx_fixture_ldr(&f);
    const char *const methods[] = {"naive", "per_light", "simd", "gpu"};
    set(&f, "render", "clustered");
    for (size_t m = 0; m < CORE_COUNT_OF(methods); ++m) {
        set(&f, "assign", methods[m]);
        uint8_t *clustered = gfx_fixture_ldr(&f);
        TEST_ASSERT_EQUAL_UINT8_ARRAY(forward, clustered, (size_t)97 * 61 * 4);
        core_free(clustered);
    }
    core_free(forward);
    gfx_fixture_close(&f);
}

// The camera stands inside several lights.
static void test_camera_inside_lights(void) {
    gfx_fixture f = open_scene(64, 36, 40, 5.0f);
    for (int i = 0; i < 6; ++i) {
        gfx_add_point(f.world, core_v3(0.3f * (float)i, 4.0f, 24.0f - (float)i), 10.0f, 5.0f);
    }
    gfx_add_point(f.world, core_v3(0, 4, 24), 500.0f, 50.0f);
    gfx_add_point(f.world, core_v3(0, 4, 26), 3.0f, 5.0f); // behind, reaching forward
    expect_equal(&f, "inside");
    gfx_fixture_close(&f);
}

// Cells with more lights than the cap are lit by all lights: the same picture, counted.
static void test_overflow_falls_back(void) {
    gfx_fixture f = open_scene(64, 36, 100, 6.0f);
    for (int i = 0; i < 200; ++i) {
        gfx_add_point(f.world, core_v3(0, 1, 10), 1.0f, 0.1f); // all in one cell
    }
    set(&f, "cell_cap", "40");
    expect_equal(&f, "cap");
    gfx_stats some = gfx_world_stats(f.world);
    TEST_ASSERT_GREATER_THAN(0, some.capped);
    set(&f, "cell_cap", "1");
    expect_equal(&f, "cap of one");
    TEST_ASSERT_GREATER_THAN(some.capped, gfx_world_stats(f.world).capped);
    set(&f, "cell_cap", "0");
    expect_equal(&f, "no cap");
    TEST_ASSERT_EQUAL_UINT32(0, gfx_world_stats(f.world).capped);
    gfx_fixture_close(&f);
}

// A hundred thousand lights, far more than a list of 16 bits could number.
static void test_very_many_lights(void) {
    gfx_fixture f = gfx_fixture_open(8, 8, true);
    gfx_add(f.world, "box", core_v3(0, -0.5f, 0), core_v3(60, 1, 60), 0.8f, 0.8f, 0.8f);
    core_rng rng = core_rng_make(3, 1);
    for (int i = 0; i < 100000; ++i) {
        gfx_add_point(f.world, random_point(&rng, core_v3(50, 3, 50)), 0.5f, 1.0f);
    }
    gfx_look(f.world, core_v3(0, 4, 24), core_v3(0, 0, 0));
    set(&f, "render", "clustered");
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    TEST_ASSERT_GREATER_THAN(10000, gfx_world_stats(f.world).light_refs);
    gfx_fixture_close(&f);
}

// Lights that move cost what lights at rest do: the same draws, programs and lists' storage, and no
// allocation once warm.
static void test_moving_lights_cost_no_more(void) {
    gfx_fixture f = open_scene(64, 36, 200, 5.0f);
    gfx_light light[32];
    for (int i = 0; i < 32; ++i) {
        light[i] = gfx_add_point(f.world, core_v3((float)i - 16.0f, 1, 0), 4, 2);
    }
    set(&f, "render", "clustered");
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
    }
    gfx_stats still = gfx_world_stats(f.world);
    uint64_t allocations = core_alloc_count();
    for (int k = 0; k < 8; ++k) {
        for (int i = 0; i < 32; ++i) {
            gfx_light_set_position(f.world, light[i],
                                   core_v3((float)i - 16.0f, 1, 0.1f * (float)k));
        }
        TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
        TEST_ASSERT_EQUAL_UINT32(still.draws, gfx_world_stats(f.world).draws);
        TEST_ASSERT_EQUAL_UINT32(still.programs, gfx_world_stats(f.world).programs);
    }
    TEST_ASSERT_EQUAL_UINT64(allocations, core_alloc_count());
    gfx_fixture_close(&f);
}

// The fixed threshold of `auto`.
static void test_auto(void) {
    gfx_fixture f = open_scene(32, 18, 0, 5.0f);
    for (uint32_t lights = 0; lights < 4; ++lights) {
        TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
        uint32_t cells = gfx_world_stats(f.world).clusters;
        TEST_ASSERT_EQUAL_UINT32(lights < 2 ? 0 : 16 * 9 * 24, cells);
        gfx_add_point(f.world, core_v3((float)lights, 1, 0), 4, 2);
    }
    gfx_fixture_close(&f);
}

static void test_largest_difference(void) {
    accuracy_at_most("gfx: clustered against plain forward, largest difference", largest_difference,
                     0.0, "radiance");
}

static void test_counts(void) {
    gfx_fixture f = open_scene(64, 36, 50, 5.0f);
    core_metrics *m = core_metrics_create();
    set(&f, "render", "auto");
    set(&f, "shadows", "off");
    TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
    gfx_world_counts(f.world, m);
    TEST_ASSERT_EQUAL_DOUBLE(51.0, core_metrics_get(m, CORE_COUNT_LIGHTS));
    TEST_ASSERT_EQUAL_DOUBLE(16.0 * 9 * 24, core_metrics_get(m, CORE_COUNT_CLUSTERS));
    TEST_ASSERT_GREATER_THAN(100, (int)core_metrics_get(m, CORE_COUNT_LIGHT_REFS));
    TEST_ASSERT_EQUAL_DOUBLE(4.0,
                             core_metrics_get(m, CORE_COUNT_DRAWS)); // boxes and spheres, twice
    TEST_ASSERT_GREATER_THAN(12, (int)core_metrics_get(m, CORE_COUNT_TRIANGLES));
    set(&f, "render", "forward");
    TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
    gfx_world_counts(f.world, m);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, core_metrics_get(m, CORE_COUNT_CLUSTERS));
    core_metrics_destroy(m);
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_light_counts);
    RUN_TEST(test_methods_slices_and_grids);
    RUN_TEST(test_odd_sizes);
    RUN_TEST(test_views);
    RUN_TEST(test_several_views_of_a_frame);
    RUN_TEST(test_camera_inside_lights);
    RUN_TEST(test_overflow_falls_back);
    RUN_TEST(test_auto);
    RUN_TEST(test_largest_difference);
    RUN_TEST(test_very_many_lights);
    RUN_TEST(test_moving_lights_cost_no_more);
    RUN_TEST(test_counts);
    return UNITY_END();
}
