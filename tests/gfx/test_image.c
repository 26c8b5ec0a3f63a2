// Images: files of every kind, their levels, broken ones, changed ones, many at once.
#include "support/gfx_fixture.h"

#include "core/log.h"
#include "core/rng.h"
#include "gfx/gfx_mips.h"
#include "unity.h"

#include <stb_image_write.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[64];
static core_vfs *vfs;

static void path_of(const char *name, char out[128]) { snprintf(out, 128, "%s/%s", folder, name); }

void setUp(void) {
    strcpy(folder, "build/image-test-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    vfs = core_vfs_create();
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, folder, "", true));
}

void tearDown(void) {
    char *names = core_vfs_list(vfs, ""), path[128];
    for (char *name = strtok(names, "\n"); name; name = strtok(NULL, "\n")) {
        path_of(name, path);
        remove(path);
    }
    core_free(names);
    core_vfs_destroy(vfs);
    rmdir(folder);
}

static void put_png(const char *name, const uint8_t *rgba, int width, int height) {
    char path[128];
    path_of(name, path);
    TEST_ASSERT_NOT_EQUAL(0, stbi_write_png(path, width, height, 4, rgba, 4 * width));
}

static void put_plain(const char *name, int side, uint8_t r, uint8_t g, uint8_t b) {
    uint8_t *rgba = core_alloc((size_t)side * (size_t)side * 4);
    for (int i = 0; i < side * side; ++i) {
        const uint8_t texel[4] = {r, g, b, 255};
        memcpy(rgba + 4 * i, texel, 4);
    }
    put_png(name, rgba, side, side);
    core_free(rgba);
}

// ---- levels ----

static const uint8_t *level(const gfx_mips *m, uint32_t number) {
    return m->texels + m->first[number];
}

static void test_levels_are_means_of_light(void) {
    static const uint8_t halves[16] = {0,   0,   0,   0,   255, 255, 255, 255,
                                       255, 255, 255, 255, 0,   0,   0,   0};
    gfx_mips m;
    gfx_mips_from_bytes(halves, 2, 2, true, &m);
    TEST_ASSERT_EQUAL_UINT32(2, m.levels);
    TEST_ASSERT_EQUAL_UINT8(188, level(&m, 1)[0]); // sRGB of a linear half
    TEST_ASSERT_EQUAL_UINT8(128, level(&m, 1)[3]); // coverage is linear
    gfx_mips_release(&m);
    gfx_mips_from_bytes(halves, 2, 2, false, &m);
    TEST_ASSERT_EQUAL_UINT8(128, level(&m, 1)[0]);
    gfx_mips_release(&m);
}

// Sizes of no power of two: every texel counts the same in the last level.
static void test_odd_sizes_keep_the_mean(void) {
    enum { W = 37, H = 21 };
    uint8_t rgba[W * H * 4];
    core_rng rng = core_rng_make(3, 0);
    double sum = 0.0;
    for (int i = 0; i < W * H * 4; ++i) {
        rgba[i] = (uint8_t)core_rng_below(&rng, 256);
        sum += i % 4 == 1 ? rgba[i] : 0;
    }
    gfx_mips m;
    gfx_mips_from_bytes(rgba, W, H, false, &m);
    TEST_ASSERT_EQUAL_UINT32(6, m.levels);
    TEST_ASSERT_FLOAT_WITHIN(1.5f, (float)(sum / (W * H)), (float)level(&m, 5)[1]);
    TEST_ASSERT_EQUAL_UINT64(m.first[5] + 4, gfx_mips_bytes(&m));
    gfx_mips_release(&m);
}

// ---- files ----

static void test_png_jpeg_and_hdr(void) {
    static const uint8_t texel[4] = {200, 100, 50, 255};
    static const float bright[3] = {40.0f, 2.0f, 0.25f};
    char path[128];
    gfx_mips m;
    put_png("a.png", texel, 1, 1);
    TEST_ASSERT_TRUE(gfx_mips_load(vfs, "a.png", true, &m));
    TEST_ASSERT_EQUAL_MEMORY(texel, m.texels, 4);
    gfx_mips_release(&m);
    path_of("a.jpg", path);
    stbi_write_jpg(path, 1, 1, 4, texel, 100);
    TEST_ASSERT_TRUE(gfx_mips_load(vfs, "a.jpg", true, &m));
    TEST_ASSERT_UINT8_WITHIN(3, 200, m.texels[0]);
    gfx_mips_release(&m);
    path_of("a.hdr", path);
    stbi_write_hdr(path, 1, 1, 3, bright);
    TEST_ASSERT_TRUE(gfx_mips_load(vfs, "a.hdr", true, &m));
    TEST_ASSERT_TRUE(m.hdr && !m.srgb);
    float read[3];
    memcpy(read, m.texels, sizeof read);
    TEST_ASSERT_FLOAT_WITHIN(0.3f, 40.0f, read[0]);
    TEST_ASSERT_FLOAT_WITHIN(0.3f, 2.0f, read[1]); // one exponent for all: steps of 0.25
    gfx_mips_release(&m);
}

static void test_hostile_sizes_are_refused_before_memory_is_taken(void) {
    // The head of a PNG of 100,000 x 100,000 texels.
    static const uint8_t head[33] = {0x89, 'P',  'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a, 0,    0, 0,
                                     13,   'I',  'H', 'D', 'R',  0,    0x01, 0x86, 0xa0, 0, 0x01,
                                     0x86, 0xa0, 8,   6,   0,    0,    0,    0,    0,    0, 0};
    gfx_mips m;
    TEST_ASSERT_TRUE(core_vfs_write(vfs, "huge.png", head, sizeof head));
    TEST_ASSERT_FALSE(gfx_mips_load(vfs, "huge.png", true, &m));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "huge.png"));
    TEST_ASSERT_NULL(m.texels);
    TEST_ASSERT_TRUE(core_vfs_write(vfs, "empty.png", "", 0));
    TEST_ASSERT_FALSE(gfx_mips_load(vfs, "empty.png", true, &m));
    TEST_ASSERT_FALSE(gfx_mips_load(vfs, "absent.png", true, &m));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "absent.png"));
}

// Cut off anywhere, or with bits turned: an error or a picture of a sane size, never more.
static void test_broken_files(void) {
    enum { SIDE = 24, TRIES = 150 };
    uint8_t rgba[SIDE * SIDE * 4];
    float light[SIDE * SIDE * 3];
    core_rng rng = core_rng_make(11, 0);
    for (int i = 0; i < SIDE * SIDE * 4; ++i) {
        rgba[i] = (uint8_t)core_rng_below(&rng, 256);
    }
    for (int i = 0; i < SIDE * SIDE * 3; ++i) {
        light[i] = 10.0f * core_rng_float(&rng);
    }
    static const char *const names[] = {"b.png", "b.jpg", "b.hdr"};
    char path[128];
    put_png(names[0], rgba, SIDE, SIDE);
    path_of(names[1], path);
    stbi_write_jpg(path, SIDE, SIDE, 4, rgba, 90);
    path_of(names[2], path);
    stbi_write_hdr(path, SIDE, SIDE, 3, light);
    core_log_level before = core_log_set_level(CORE_LOG_ERROR + 1);
    uint32_t refused = 0;
    for (size_t k = 0; k < CORE_COUNT_OF(names); ++k) {
        size_t size;
        uint8_t *good = core_vfs_read(vfs, names[k], &size), *bad = core_alloc(size);
        for (int i = 0; i < TRIES; ++i) {
            gfx_mips m;
            size_t left = i % 2 ? size : core_rng_below(&rng, (uint32_t)size);
            memcpy(bad, good, size);
            for (int flips = i % 2 ? 1 + i % 7 : 0; flips; --flips) {
                bad[core_rng_below(&rng, (uint32_t)size)] ^=
                    (uint8_t)(1u << core_rng_below(&rng, 8));
            }
            TEST_ASSERT_TRUE(core_vfs_write(vfs, "bad", bad, left));
            if (gfx_mips_load(vfs, "bad", true, &m)) {
                TEST_ASSERT_TRUE(m.width <= GFX_MIPS_MAX_SIDE && m.height <= GFX_MIPS_MAX_SIDE);
                gfx_mips_release(&m);
            } else {
                refused++;
            }
        }
        core_free(good);
        core_free(bad);
    }
    core_log_set_level(before);
    printf("broken images: %u of %d refused\n", refused, 3 * TRIES);
    TEST_ASSERT_GREATER_THAN(60, refused);
}

// ---- on the device ----

enum { SIZE = 32 };
static gfx_fixture f;

static gfx_fixture open_device(bool background) {
    gfx_fixture x = {.vfs = vfs, .width = SIZE, .height = SIZE};
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, "assets/shaders", "shaders", false));
    gfx_device_desc desc = gfx_device_desc_default();
    desc.width = desc.height = SIZE;
    desc.vfs = vfs;
    desc.float_target = true;
    desc.background = background;
    x.device = gfx_device_create(&desc);
    TEST_ASSERT_NOT_NULL_MESSAGE(x.device, core_last_error());
    gfx_world_desc world = gfx_world_desc_default();
    x.world = gfx_world_create(&world);
    gfx_world_set_ambient(x.world, 0, 0, 0);
    gfx_camera c = {.position = {0, 5, 0},
                    .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                    .ortho_height = 1.0f};
    gfx_world_set_camera(x.world, &c);
    return x;
}

static void close_device(void) {
    gfx_device_destroy(f.device);
    gfx_world_destroy(f.world);
}

static void add_picture(const char *path) { // on a plane that fills the view and glows with it
    gfx_material_desc m = gfx_material_desc_default();
    memset(m.data.base_color, 0, sizeof m.data.base_color);
    m.data.base_color[3] = 1.0f;
    m.data.emissive[0] = m.data.emissive[1] = m.data.emissive[2] = 1.0f;
    strcpy(m.data.emissive_image, path);
    gfx_instance_desc d = {.mesh = gfx_mesh_builtin(f.world, "plane"),
                           .material = gfx_material_create(f.world, &m)};
    TEST_ASSERT_FALSE(core_handle_is_null(gfx_instance_create(f.world, &d)));
}

static void middle(float rgb[3]) {
    float *hdr = gfx_fixture_hdr(&f);
    memcpy(rgb, hdr + 4 * (SIZE / 2 * SIZE + SIZE / 2), 3 * sizeof *rgb);
    core_free(hdr);
}

static void test_reload_and_broken_reload(void) {
    float p[3];
    put_plain("live.png", 4, 255, 0, 0);
    f = open_device(false);
    add_picture("live.png");
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p[0]);
    TEST_ASSERT_TRUE(gfx_device_reload(f.device)); // nothing changed
    put_plain("live.png", 8, 0, 255, 0);           // another size too
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_reload(f.device), core_last_error());
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, p[0]);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p[1]);
    TEST_ASSERT_TRUE(core_vfs_write(vfs, "live.png", "no picture", 10));
    TEST_ASSERT_FALSE(gfx_device_reload(f.device));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "live.png"));
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p[1]);
    put_plain("live.png", 4, 0, 0, 255);
    TEST_ASSERT_TRUE(gfx_device_reload(f.device));
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p[2]);
    close_device();
}

static uint32_t warnings;
static void count_warning(void *ctx, core_log_level at, const char *text) {
    (void)ctx;
    warnings += at >= CORE_LOG_WARN && strstr(text, "lost.png") != NULL;
}

static void test_a_missing_image_is_told_once_and_can_come(void) {
    float p[3];
    f = open_device(false);
    warnings = 0;
    TEST_ASSERT_TRUE(core_log_add_sink(count_warning, NULL));
    add_picture("lost.png");
    for (int i = 0; i < 3; ++i) {
        middle(p);
    }
    core_log_remove_sink(count_warning, NULL);
    TEST_ASSERT_EQUAL_UINT32(1, warnings);
    put_plain("lost.png", 2, 0, 0, 255);
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_reload(f.device), core_last_error());
    middle(p);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p[2]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, p[0]);
    close_device();
}

// Four images of 5.6 MB with their levels: no frame uploads more than a quarter of a megabyte, and
// the last picture is that of a device that waits.
static void test_loading_in_the_background(void) {
    static const char *const names[] = {"1.png", "2.png", "3.png", "4.png"};
    float p[3], want[3];
    for (size_t i = 0; i < CORE_COUNT_OF(names); ++i) {
        put_plain(names[i], 512, (uint8_t)(60 * i), 200, 10);
    }
    f = open_device(false);
    add_picture("4.png");
    middle(want);
    close_device();
    f = open_device(true);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "upload_budget", "0.25"));
    for (size_t i = 0; i < CORE_COUNT_OF(names); ++i) {
        add_picture(names[i]); // the last one lies on top
    }
    size_t most = 0, total = 0;
    int frames = 0;
    do {
        middle(p);
        if (frames == 0) { // nothing is there yet: grey, not a checker
            TEST_ASSERT_EQUAL_FLOAT(p[0], p[1]);
        }
        gfx_device_use use = gfx_device_used(f.device);
        most = use.uploaded_bytes > most ? use.uploaded_bytes : most;
        total += use.uploaded_bytes;
    } while (gfx_device_used(f.device).loading > 0 && ++frames < 5000);
    middle(p);
    printf("in the background: %zu bytes in %d frames, %zu at most in one\n", total, frames, most);
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(want, p, 3);
    TEST_ASSERT_TRUE(most <= 262144 && total > 4 * 1398000 && frames >= 20);
    close_device();
}

// A device that ends while its thread still reads.
static void test_a_device_may_end_while_images_load(void) {
    put_plain("big.png", 1024, 1, 2, 3);
    f = open_device(true);
    add_picture("big.png");
    TEST_ASSERT_TRUE(gfx_device_render(f.device, f.world));
    close_device();
}

// Stripes that run away from the viewer stay apart at a grazing angle.
static void test_anisotropy(void) {
    uint8_t rgba[64 * 64 * 4];
    for (int i = 0; i < 64 * 64; ++i) {
        memset(rgba + 4 * i, i % 64 / 8 % 2 ? 255 : 0, 4);
        rgba[4 * i + 3] = 255;
    }
    put_png("stripes.png", rgba, 64, 64);
    f = open_device(false);
    add_picture("stripes.png");
    gfx_look(f.world, core_v3(0, 0.06f, 0.5f), core_v3(0, 0, 0));
    gfx_camera c = gfx_world_camera(f.world);
    c.ortho_height = 1.0f;
    gfx_world_set_camera(f.world, &c);
    float *hdr = gfx_fixture_hdr(&f), low = 1.0f, high = 0.0f;
    for (int x = 4; x < SIZE - 4; ++x) {
        float v = hdr[4 * (SIZE / 2 * SIZE + x)];
        low = fminf(low, v), high = fmaxf(high, v);
    }
    printf("stripes at 7 degrees: %.2f to %.2f\n", (double)low, (double)high);
    TEST_ASSERT_TRUE(high - low > 0.5f);
    core_free(hdr);
    close_device();
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_levels_are_means_of_light);
    RUN_TEST(test_odd_sizes_keep_the_mean);
    RUN_TEST(test_png_jpeg_and_hdr);
    RUN_TEST(test_hostile_sizes_are_refused_before_memory_is_taken);
    RUN_TEST(test_broken_files);
    RUN_TEST(test_reload_and_broken_reload);
    RUN_TEST(test_a_missing_image_is_told_once_and_can_come);
    RUN_TEST(test_loading_in_the_background);
    RUN_TEST(test_a_device_may_end_while_images_load);
    RUN_TEST(test_anisotropy);
    return UNITY_END();
}
