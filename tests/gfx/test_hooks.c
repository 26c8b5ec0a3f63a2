// Shaders of scripts: passes over the picture and parts of materials, by numbers; broken ones.
#include "support/gfx_fixture.h"

#include "core/log.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SIZE = 16 };
static char folder[64];
static gfx_fixture f;

void setUp(void) {
    strcpy(folder, "build/hook-test-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    f = gfx_fixture_open(SIZE, SIZE, true);
    TEST_ASSERT_TRUE(core_vfs_mount(f.vfs, folder, "fx", true));
    gfx_world_set_ambient(f.world, 0, 0, 0);
    gfx_world_set_background(f.world, 0.25f, 0.5f, 0.75f);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "tonemap", "linear"));
}

void tearDown(void) {
    char *names = core_vfs_list(f.vfs, "fx"), path[160];
    for (char *name = strtok(names, "\n"); name; name = strtok(NULL, "\n")) {
        snprintf(path, sizeof path, "%s/%s", folder, name);
        remove(path);
    }
    core_free(names);
    gfx_fixture_close(&f);
    rmdir(folder);
}

static void put(const char *path, const char *text) {
    TEST_ASSERT_TRUE_MESSAGE(core_vfs_write(f.vfs, path, text, strlen(text)), core_last_error());
}

static gfx_effect add(const char *path, bool encoded, float parameter) {
    gfx_effect_desc d = gfx_effect_desc_default();
    d.fragment = path;
    d.encoded = encoded;
    d.parameters[5] = parameter;
    return gfx_effect_create(f.world, &d);
}

static void middle(float rgb[3]) {
    float *hdr = gfx_fixture_hdr(&f);
    memcpy(rgb, hdr + 4 * (SIZE / 2 * SIZE + SIZE / 2), 3 * sizeof *rgb);
    core_free(hdr);
}

static void test_effects_in_order_with_parameters(void) {
    float p[3];
    put("fx/times.glsl", "vec3 effect(vec2 uv) { return picture(uv) * parameter(5); }\n");
    put("fx/plus.glsl", "vec3 effect(vec2 uv) { return picture(uv) + vec3(0.125, uv); }\n");
    uint32_t passes = (middle(p), gfx_device_used(f.device).passes);
    gfx_effect times = add("fx/times.glsl", false, 0.5f);
    gfx_effect plus = add("fx/plus.glsl", false, 0);
    middle(p);
    TEST_ASSERT_EQUAL_UINT32(passes + 2, gfx_device_used(f.device).passes);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, p[0]); // 0.25 * 0.5 + 0.125
    TEST_ASSERT_EQUAL_FLOAT(0.25f + 8.5f / SIZE, p[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.375f + 7.5f / SIZE, p[2]); // rows from the top, uv from below
    float two[16] = {[5] = 2.0f};
    TEST_ASSERT_TRUE(gfx_effect_set_parameters(f.world, times, two));
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(0.625f, p[0]);
    gfx_effect last = add("fx/times.glsl", false, 4.0f);
    TEST_ASSERT_TRUE(gfx_effect_destroy(f.world, times));
    TEST_ASSERT_FALSE(gfx_effect_alive(f.world, times));
    middle(p); // the order stays: plus, then times 4
    TEST_ASSERT_EQUAL_FLOAT(1.5f, p[0]);
    TEST_ASSERT_TRUE(gfx_effect_destroy(f.world, plus) && gfx_effect_destroy(f.world, last));
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, p[0]);
    TEST_ASSERT_EQUAL_UINT32(passes, gfx_device_used(f.device).passes);
}

static void test_encoded_effects_and_depth(void) {
    put("fx/depth.glsl", "vec3 effect(vec2 uv) { return vec3(depth(uv) / 10.0, 0.0, 1.0); }\n");
    gfx_add(f.world, "box", core_v3(0, 0, -4.5f), core_v3(20, 20, 1), 1, 1, 1);
    gfx_look(f.world, core_v3(0, 0, 0), core_v3(0, 0, -1));
    TEST_ASSERT_FALSE(core_handle_is_null(add("fx/depth.glsl", true, 0)));
    uint8_t *rgba = gfx_fixture_ldr(&f);
    const uint8_t *p = rgba + 4 * (SIZE / 2 * SIZE + SIZE / 2);
    TEST_ASSERT_UINT8_WITHIN(1, 102, p[0]); // 4 m of 10
    TEST_ASSERT_EQUAL_UINT8(0, p[1]);
    TEST_ASSERT_EQUAL_UINT8(255, p[2]);
    core_free(rgba);
}

static gfx_material add_plane(const char *path) {
    gfx_material_desc m = gfx_material_desc_default();
    m.fragment = path;
    m.parameters[0] = 0.25f;
    gfx_instance_desc d = {.mesh = gfx_mesh_builtin(f.world, "plane"),
                           .material = gfx_material_create(f.world, &m)};
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(d.material), core_last_error());
    gfx_instance_create(f.world, &d);
    gfx_camera c = {.position = {0, 5, 0},
                    .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                    .ortho_height = 1.0f};
    gfx_world_set_camera(f.world, &c);
    gfx_world_set_ambient(f.world, 0, 0, 0);
    gfx_light_desc dark = gfx_light_desc_default(GFX_POINT); // and no sun of our own
    dark.position = core_v3(0, 90, 0);
    gfx_light_create(f.world, &dark);
    return d.material;
}

static void test_a_material_of_a_script(void) {
    float p[3];
    put("fx/look.glsl", "void surface(inout Look look) {\n"
                        "    look.baseColor = vec3(0.0);\n"
                        "    look.roughness = 1.0;\n"
                        "    look.emission = vec3(parameter(0), look.uv.x, look.normal.y);\n"
                        "}\n");
    gfx_material m = add_plane("fx/look.glsl");
    middle(p);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.25f, p[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 8.5f / SIZE, p[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f, p[2]);
    float other[16] = {0.75f};
    TEST_ASSERT_TRUE(gfx_material_set_parameters(f.world, m, other));
    middle(p);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.75f, p[0]);
}

static void test_parameters_of_every_frame_allocate_nothing(void) {
    float p[16] = {0};
    put("fx/times.glsl", "vec3 effect(vec2 uv) { return picture(uv) * parameter(5); }\n");
    put("fx/look.glsl", "void surface(inout Look look) { look.emission = vec3(parameter(0)); }\n");
    gfx_effect effect = add("fx/times.glsl", false, 1);
    gfx_material m = add_plane("fx/look.glsl");
    uint64_t before = 0;
    for (int i = 0; i < 12; ++i) {
        before = i == 5 ? core_alloc_count() : before;
        p[0] = p[5] = 0.1f * (float)i;
        gfx_material_set_parameters(f.world, m, p);
        gfx_effect_set_parameters(f.world, effect, p);
        TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
    }
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
}

static char seen[512];
static uint32_t lines;
static void keep_error(void *ctx, core_log_level level, const char *text) {
    (void)ctx;
    if (level >= CORE_LOG_ERROR) {
        snprintf(seen, sizeof seen, "%s", text);
        lines++;
    }
}

// A broken one is told once, by its own file and line; the picture goes on without it, and with it
// again once it is mended.
static void test_broken_shaders(void) {
    float p[3];
    put("fx/bad.glsl", "// fine\nvec3 effect(vec2 uv) {\n    return nothing(uv);\n}\n");
    put("fx/badlook.glsl", "void surface(inout Look look) {\n    look.colour = vec3(1.0);\n}\n");
    TEST_ASSERT_TRUE(core_log_add_sink(keep_error, NULL));
    lines = 0;
    TEST_ASSERT_FALSE(core_handle_is_null(add("fx/bad.glsl", false, 0)));
    middle(p);
    middle(p);
    TEST_ASSERT_EQUAL_UINT32(1, lines);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(seen, "fx/bad.glsl:3:"), seen);
    TEST_ASSERT_NULL(strstr(seen, "shaders/fx"));
    TEST_ASSERT_EQUAL_FLOAT(0.25f, p[0]);
    put("fx/bad.glsl", "vec3 effect(vec2 uv) { return vec3(1.0); }\n");
    TEST_ASSERT_TRUE(gfx_device_reload(f.device));
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p[0]);
    put("fx/bad.glsl", "vec3 effect(vec2 uv) { return vec4(1.0); }\n");
    TEST_ASSERT_FALSE(gfx_device_reload(f.device));
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p[0]); // the last good one stays
    lines = 0;
    add_plane("fx/badlook.glsl");
    middle(p);
    TEST_ASSERT_EQUAL_UINT32(1, lines);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(seen, "fx/badlook.glsl:2:"), seen);
    core_log_remove_sink(keep_error, NULL);
    TEST_ASSERT_TRUE(core_handle_is_null(add("fx/a-path-that-is-longer-than-sixty-three-bytes-"
                                             "can-not-be-kept-in-a-hook.glsl",
                                             false, 0)));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_effects_in_order_with_parameters);
    RUN_TEST(test_encoded_effects_and_depth);
    RUN_TEST(test_a_material_of_a_script);
    RUN_TEST(test_parameters_of_every_frame_allocate_nothing);
    RUN_TEST(test_broken_shaders);
    return UNITY_END();
}
