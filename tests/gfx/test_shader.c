// Shader files: includes, defines, error places, reload; the device's answers to bad input.
#include "support/gfx_fixture.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static char folder[64];
static core_vfs *vfs;
static gfx_device *device;
static gfx_world *world;

static void put(const char *name, const char *text) {
    char path[256];
    snprintf(path, sizeof path, "%s/shaders/%s", folder, name);
    FILE *f = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(f);
    fputs(text, f);
    fclose(f);
}

static void drop(const char *name) {
    char path[256];
    snprintf(path, sizeof path, "%s/shaders/%s", folder, name);
    remove(path);
}

void setUp(void) {
    strcpy(folder, "build/shader-test-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    char path[128];
    snprintf(path, sizeof path, "%s/shaders", folder);
    TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0700));
    vfs = core_vfs_create();
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, "assets", "", false));
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, folder, "", false)); // hides files of the tree
    gfx_device_desc desc = gfx_device_desc_default();
    desc.width = desc.height = 16;
    desc.vfs = vfs;
    device = gfx_device_create(&desc);
    TEST_ASSERT_NOT_NULL_MESSAGE(device, core_last_error());
    gfx_world_desc wd = gfx_world_desc_default();
    world = gfx_world_create(&wd);
    gfx_add(world, "sphere", core_v3(0, 0, 0), core_v3(1, 1, 1), 1, 1, 1);
    core_clear_error();
}

void tearDown(void) {
    gfx_device_destroy(device);
    gfx_world_destroy(world);
    core_vfs_destroy(vfs);
    const char *const names[] = {"scene.frag", "part.glsl", "color.glsl"};
    for (size_t i = 0; i < CORE_COUNT_OF(names); ++i) {
        drop(names[i]);
    }
    char path[128];
    snprintf(path, sizeof path, "%s/shaders", folder);
    rmdir(path);
    rmdir(folder);
}

static void expect_failure(const char *place) {
    TEST_ASSERT_FALSE(gfx_device_render(device, world));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), place), core_last_error());
}

static void test_error_names_file_and_line(void) {
    put("scene.frag", "// first\nout vec4 o;\nvoid main() { o = nothing; }\n");
    expect_failure("shaders/scene.frag:3:");
}

static void test_error_in_an_included_file(void) {
    put("part.glsl", "\n\n\nfloat f() { return missing; }\n");
    put("scene.frag", "#include \"part.glsl\"\nout vec4 o;\nvoid main() { o = vec4(f()); }\n");
    expect_failure("shaders/part.glsl:4:");
}

static void test_lines_after_an_include_keep_their_numbers(void) {
    put("part.glsl", "float f() { return 1.0; }\n");
    put("scene.frag", "#include \"part.glsl\"\nout vec4 o;\nvoid main() { o = wrong; }\n");
    expect_failure("shaders/scene.frag:3:");
}

static void test_missing_include_is_named(void) {
    put("scene.frag", "out vec4 o;\n#include \"absent.glsl\"\nvoid main() {}\n");
    expect_failure("absent.glsl");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), "scene.frag:2"), core_last_error());
}

static void test_include_cycle_ends(void) {
    put("part.glsl", "#include \"scene.frag\"\nconst float half_ = 0.5;\n");
    put("scene.frag", "#include \"part.glsl\"\nlayout(location = 0) out vec4 o;\n"
                      "void main() { o = vec4(half_); }\n");
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(device, world), core_last_error());
}

// A changed file takes effect; a broken one keeps the old program; a mended one takes effect.
static void test_reload(void) {
    float rgba[16 * 16 * 4];
    const float *middle = rgba + 4 * (8 * 16 + 8);
    const struct timespec tick = {0, 20000000}; // file times must differ
    put("scene.frag", "layout(location = 0) out vec4 o;\nvoid main() { o = vec4(0.25); }\n");
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(device, world), core_last_error());
    gfx_device_read_float(device, rgba);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, middle[0]);
    nanosleep(&tick, NULL);
    put("scene.frag", "layout(location = 0) out vec4 o;\nvoid main() { o = bad; }\n");
    TEST_ASSERT_FALSE(gfx_device_reload(device));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), "scene.frag:2:"), core_last_error());
    TEST_ASSERT_TRUE(gfx_device_render(device, world));
    gfx_device_read_float(device, rgba);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, middle[0]);
    nanosleep(&tick, NULL);
    put("scene.frag", "layout(location = 0) out vec4 o;\nvoid main() { o = vec4(0.75); }\n");
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_reload(device), core_last_error());
    TEST_ASSERT_TRUE(gfx_device_render(device, world));
    gfx_device_read_float(device, rgba);
    TEST_ASSERT_EQUAL_FLOAT(0.75f, middle[0]);
}

static void test_bad_sizes_are_refused(void) {
    TEST_ASSERT_FALSE(gfx_device_resize(device, 0, 16));
    TEST_ASSERT_FALSE(gfx_device_resize(device, 16, 100000));
    TEST_ASSERT_TRUE(gfx_device_resize(device, 1, 1));
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(device, world), core_last_error());
}

static void test_many_resizes(void) {
    for (uint32_t i = 1; i < 200; ++i) {
        TEST_ASSERT_TRUE(gfx_device_resize(device, i, 200 - i));
    }
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(device, world), core_last_error());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_error_names_file_and_line);
    RUN_TEST(test_error_in_an_included_file);
    RUN_TEST(test_lines_after_an_include_keep_their_numbers);
    RUN_TEST(test_missing_include_is_named);
    RUN_TEST(test_include_cycle_ends);
    RUN_TEST(test_reload);
    RUN_TEST(test_bad_sizes_are_refused);
    RUN_TEST(test_many_resizes);
    return UNITY_END();
}
