// Material maps and alpha modes, each against a value known beforehand.
#include "support/gfx_fixture.h"

#include "unity.h"

#include <stb_image_write.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[64];
static gfx_fixture f;
enum { SIZE = 16 };

static void put(const char *name, const uint8_t *rgba, int width, int height) {
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    TEST_ASSERT_NOT_EQUAL(0, stbi_write_png(path, width, height, 4, rgba, 4 * width));
}

void setUp(void) {
    static const uint8_t grey[4] = {188, 188, 188, 255}; // sRGB for a linear half
    static const uint8_t halves[16] = {255, 0,   0, 255, 255, 0,   0, 255,
                                       0,   255, 0, 40,  0,   255, 0, 40};
    static const uint8_t tilted[4] = {217, 127, 217, 255}; // 45 degrees towards +u
    static const uint8_t packed[4] = {64, 128, 255, 255};  // occlusion, roughness, metalness
    strcpy(folder, "build/texture-test-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    f = gfx_fixture_open(SIZE, SIZE, true);
    TEST_ASSERT_TRUE(core_vfs_mount(f.vfs, folder, "maps", false));
    put("grey.png", grey, 1, 1);
    put("halves.png", halves, 4, 1);
    put("tilted.png", tilted, 1, 1);
    put("packed.png", packed, 1, 1);
    gfx_world_set_ambient(f.world, 0, 0, 0);
    gfx_world_set_background(f.world, 0, 0, 0);
    gfx_camera c = {.position = {0, 5, 0},
                    .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                    .ortho_height = 1.0f};
    gfx_world_set_camera(f.world, &c);
}

void tearDown(void) {
    static const char *const names[] = {"grey.png", "halves.png", "tilted.png", "packed.png"};
    gfx_fixture_close(&f);
    for (size_t i = 0; i < CORE_COUNT_OF(names); ++i) {
        char path[128];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        remove(path);
    }
    rmdir(folder);
}

static gfx_instance add_plane(const gfx_material_desc *m, float y) {
    gfx_instance_desc d = {.mesh = gfx_mesh_builtin(f.world, "plane"),
                           .material = gfx_material_create(f.world, m)};
    gfx_instance i = gfx_instance_create(f.world, &d);
    gfx_instance_set_transform(f.world, i, core_v3(0, y, 0), core_quat_identity(),
                               core_v3(1, 1, 1));
    return i;
}

static void pixel(int x, int y, float out[3]) {
    float *rgba = gfx_fixture_hdr(&f);
    memcpy(out, rgba + 4 * (y * SIZE + x), 3 * sizeof *out);
    core_free(rgba);
}

static void test_base_color_is_srgb(void) {
    gfx_material_desc m = gfx_material_desc_default();
    float plain[3], mapped[3];
    gfx_world_set_ambient(f.world, 1, 1, 1); // diffuse only: the specular part is taken out below
    gfx_instance i = add_plane(&m, 0);
    pixel(8, 8, plain);
    gfx_instance_destroy(f.world, i);
    strcpy(m.data.base_color_image, "maps/grey.png");
    i = add_plane(&m, 0);
    pixel(8, 8, mapped);
    // White: E + (1 - E) = 1; half: E + (1 - E)/2.
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 1.0f, plain[0]);
    m.data.base_color[0] = m.data.base_color[1] = m.data.base_color[2] = 0.5f;
    m.data.base_color_image[0] = '\0';
    gfx_instance_destroy(f.world, i);
    add_plane(&m, 0);
    pixel(8, 8, plain);
    // The grey of the map lies 0.0027 off 0.5, and chips decode sRGB to about a quarter of a step.
    TEST_ASSERT_FLOAT_WITHIN(4e-3f, plain[0], mapped[0]);
}

static void test_mask_cuts_and_blend_mixes(void) {
    gfx_material_desc back = gfx_material_desc_default(), front = back;
    back.data.base_color[0] = back.data.base_color[1] = back.data.base_color[2] = 0.0f;
    back.data.emissive[2] = 1.0f; // blue below
    add_plane(&back, -1);
    strcpy(front.data.base_color_image, "maps/halves.png");
    front.data.alpha_mode = 1;
    front.data.emissive[0] = 0.25f;
    gfx_instance i = add_plane(&front, 0);
    float left[3], right[3];
    pixel(3, 8, left);
    pixel(12, 8, right);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, left[0]); // opaque half
    TEST_ASSERT_EQUAL_FLOAT(0.0f, left[2]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, right[0]); // cut away: alpha 40/255 < 0.5
    TEST_ASSERT_EQUAL_FLOAT(1.0f, right[2]);
    gfx_instance_destroy(f.world, i);
    front.data.alpha_mode = 2;
    add_plane(&front, 0);
    pixel(12, 8, right);
    float alpha = 40.0f / 255.0f;
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.25f * alpha, right[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 1.0f - alpha, right[2]);
}

// Two panes of half alpha: the nearer one counts twice as much, in whichever order they were made.
static void test_blend_order(void) {
    for (int order = 0; order < 2; ++order) {
        gfx_instance made[2];
        for (int k = 0; k < 2; ++k) {
            bool near_one = k == order;
            gfx_material_desc m = gfx_material_desc_default();
            m.data.alpha_mode = 2;
            m.data.base_color[0] = m.data.base_color[1] = m.data.base_color[2] = 0.0f;
            m.data.base_color[3] = 0.5f;
            m.data.emissive[near_one ? 0 : 1] = 1.0f;
            made[k] = add_plane(&m, near_one ? 1.0f : 0.0f);
        }
        float p[3];
        pixel(8, 8, p);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.5f, p[0]);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.25f, p[1]);
        gfx_instance_destroy(f.world, made[0]);
        gfx_instance_destroy(f.world, made[1]);
    }
}

// A map that tilts the normal 45 degrees to +x: light from there is seen in full, light from the
// other side not at all.
static void test_normal_map(void) {
    gfx_material_desc m = gfx_material_desc_default();
    m.data.roughness = 1.0f;
    strcpy(m.data.normal_image, "maps/tilted.png");
    add_plane(&m, 0);
    gfx_light sun = gfx_add_sun(f.world, core_v3(-1, -1, 0), CORE_PI_F);
    float p[3];
    pixel(8, 8, p);
    TEST_ASSERT_FLOAT_WITHIN(0.12f, 1.0f, p[0]);
    gfx_light_set_direction(f.world, sun, core_v3(1, -1, 0));
    pixel(8, 8, p);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 0.0f, p[0]);
}

static void test_occlusion_dims_ambient_light_only(void) {
    gfx_material_desc m = gfx_material_desc_default();
    add_plane(&m, 0);
    gfx_world_set_ambient(f.world, 1, 1, 1);
    float open[3], closed[3];
    pixel(8, 8, open);
    strcpy(m.data.occlusion_image, "maps/packed.png");
    add_plane(&m, 0.1f);
    pixel(8, 8, closed);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 64.0f / 255.0f, closed[0] / open[0]);
}

// Whichever map is missing, the surface shows squares of magenta and near black.
static void test_missing_map_is_a_checker(void) {
    gfx_world_set_ambient(f.world, 1, 1, 1);
    for (int i = 0; i < 2; ++i) {
        gfx_material_desc m = gfx_material_desc_default();
        strcpy(i ? m.data.normal_image : m.data.base_color_image, "maps/absent.png");
        add_plane(&m, 0.1f * (float)(i + 1));
        float a[3], b[3];
        pixel(8, 8, a); // the plane has 16 pixels and 8 squares a side
        pixel(10, 8, b);
        float most = fmaxf(a[0], b[0]), least = fminf(a[0], b[0]);
        TEST_ASSERT_TRUE(most > 0.6f && least < 0.4f); // filtered: a level of 16 texels
        TEST_ASSERT_TRUE(fmaxf(a[1], b[1]) < 0.1f);
    }
}

static void test_double_sided(void) {
    gfx_material_desc m = gfx_material_desc_default();
    m.data.emissive[0] = 1.0f;
    gfx_instance i = add_plane(&m, 0);
    core_quat over = core_quat_axis_angle(core_v3(1, 0, 0), CORE_PI_F); // shows its back
    gfx_instance_set_transform(f.world, i, core_v3(0, 0, 0), over, core_v3(1, 1, 1));
    float p[3];
    pixel(8, 8, p);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, p[0]);
    m.data.double_sided = true;
    i = add_plane(&m, 0);
    gfx_instance_set_transform(f.world, i, core_v3(0, 0, 0), over, core_v3(1, 1, 1));
    pixel(8, 8, p);
    TEST_ASSERT_TRUE(p[0] >= 1.0f);
}

// 10,000 things of 100 meshes and 20 materials: few draws, few program switches.
static void test_draws_are_merged(void) {
    gfx_mesh mesh[100];
    gfx_material material[20];
    const float position[9] = {0, 0, 0, 0.1f, 0, 0, 0, 0, -0.1f};
    const uint32_t index[3] = {0, 1, 2};
    core_mesh_data data = {
        .vertex_count = 3, .index_count = 3, .position = position, .index = index};
    for (int i = 0; i < 100; ++i) {
        mesh[i] = gfx_mesh_create(f.world, &data);
    }
    for (int i = 0; i < 20; ++i) {
        gfx_material_desc m = gfx_material_desc_default();
        m.data.double_sided = i % 2;
        if (i % 4 == 0) {
            strcpy(m.data.base_color_image, "maps/grey.png");
        }
        material[i] = gfx_material_create(f.world, &m);
    }
    for (int i = 0; i < 10000; ++i) {
        gfx_instance_desc d = {.mesh = mesh[i % 100], .material = material[i / 100 % 20]};
        gfx_instance_create(f.world, &d);
    }
    for (int prepass = 0; prepass < 2; ++prepass) {
        gfx_world_set(f.world, "prepass", prepass ? "on" : "off");
        TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
        gfx_stats s = gfx_world_stats(f.world);
        printf("10,000 things, prepass %s: %u draws, %u program switches\n", prepass ? "on" : "off",
               s.draws, s.programs);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(100, s.draws);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(2000, s.draws);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(20, s.programs);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_base_color_is_srgb);
    RUN_TEST(test_mask_cuts_and_blend_mixes);
    RUN_TEST(test_blend_order);
    RUN_TEST(test_normal_map);
    RUN_TEST(test_occlusion_dims_ambient_light_only);
    RUN_TEST(test_missing_map_is_a_checker);
    RUN_TEST(test_double_sided);
    RUN_TEST(test_draws_are_merged);
    return UNITY_END();
}
