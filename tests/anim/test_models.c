// Real models through converter, files, sampler and skinning, against an own evaluation of the glTF
// in double precision (tests/ref/gltf.c): every triangle corner within 1e-4 of the model's size.
#include "anim/anim.h"
#include "asset/asset.h"
#include "ref/gltf.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MODELS "../shared/data/models/"

void setUp(void) {}
void tearDown(void) {}

typedef struct loaded {
    asset_model *model;
    core_mesh_data *mesh[64];
    anim_world *world;
    anim_skeleton skeleton;
    anim_instance instance;
    core_vfs *vfs;
} loaded;

static bool convert(const char *file, const char *out) {
    char command[1024], program[512] = "build/corsac-convert";
    const char *corsac = getenv("CORSAC");
    if (corsac) {
        snprintf(program, sizeof program, "%s-convert", corsac);
    }
    snprintf(command, sizeof command, "'%s' '%s' '%s' --quiet", program, file, out);
    return system(command) == 0;
}

static loaded load(const char *folder, const char *name) {
    loaded l = {.vfs = core_vfs_create()};
    char path[256];
    TEST_ASSERT_TRUE(core_vfs_mount(l.vfs, folder, "", false));
    snprintf(path, sizeof path, "%s.cmodel", name);
    l.model = asset_model_load(l.vfs, path);
    TEST_ASSERT_NOT_NULL_MESSAGE(l.model, core_last_error());
    for (uint32_t i = 0; i < l.model->mesh_count; i++) {
        l.mesh[i] = asset_mesh_load(l.vfs, l.model->mesh[i].path);
        TEST_ASSERT_NOT_NULL_MESSAGE(l.mesh[i], core_last_error());
    }
    anim_world_desc desc = anim_world_desc_default();
    l.world = anim_world_create(&desc);
    core_skeleton_data *s = asset_skeleton_load(l.vfs, l.model->skeleton);
    TEST_ASSERT_NOT_NULL(s);
    l.skeleton = anim_skeleton_create(l.world, s);
    core_free(s);
    anim_instance_desc d = anim_instance_desc_default();
    d.skeleton = l.skeleton;
    l.instance = anim_instance_create(l.world, &d);
    return l;
}

static void unload(loaded *l) {
    anim_world_destroy(l->world);
    for (uint32_t i = 0; i < l->model->mesh_count; i++) {
        core_free(l->mesh[i]);
    }
    core_free(l->model);
    core_vfs_destroy(l->vfs);
}

static double distance(const float *a, const double *b) {
    return sqrt(pow((double)a[0] - b[0], 2) + pow((double)a[1] - b[1], 2) +
                pow((double)a[2] - b[2], 2));
}

// Worst distance of a corner at the instance's present pose.
static double worst_corner(loaded *l, const double *expected, size_t corners) {
    uint32_t bones;
    double worst = 0;
    size_t n = 0;
    anim_world_pose(l->world);
    const float *palette = anim_instance_palette(l->world, l->instance, &bones);
    for (uint32_t m = 0; m < l->model->mesh_count; m++) {
        const core_mesh_data *mesh = l->mesh[m];
        float *p = malloc(mesh->vertex_count * 12u);
        TEST_ASSERT_TRUE(anim_skin(mesh, palette, bones, p, NULL));
        for (uint32_t i = 0; i < mesh->index_count; i++, n++) {
            TEST_ASSERT_TRUE(n < corners);
            worst = fmax(worst, distance(p + 3 * mesh->index[i], expected + 3 * n));
        }
        free(p);
    }
    TEST_ASSERT_EQUAL_UINT64(corners, n);
    return worst;
}

static double size_of(const double *p, size_t corners) {
    double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30};
    for (size_t i = 0; i < corners * 3; i++) {
        low[i % 3] = fmin(low[i % 3], p[i]);
        high[i % 3] = fmax(high[i % 3], p[i]);
    }
    return sqrt(pow(high[0] - low[0], 2) + pow(high[1] - low[1], 2) + pow(high[2] - low[2], 2));
}

static void play(loaded *l, uint32_t clip, float time) {
    core_clip_data *data = asset_clip_load(l->vfs, l->model->clip[clip].path);
    TEST_ASSERT_NOT_NULL_MESSAGE(data, core_last_error());
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = data;
    desc.skeleton = l->skeleton;
    anim_clip c = anim_clip_create(l->world, &desc);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(c), core_last_error());
    core_free(data);
    anim_instance_play(l->world, l->instance, c, ANIM_ONCE, 0, ANIM_FADE_LINEAR);
    anim_instance_set_time(l->world, l->instance, time);
}

static void check_model(const char *name, const char *file, int clip_step) {
    char path[256], folder[256], text[256];
    snprintf(path, sizeof path, MODELS "%s", file);
    if (access(path, R_OK) != 0) {
        TEST_IGNORE_MESSAGE("../shared/data/models is not here");
    }
    snprintf(folder, sizeof folder, "build/test-models/%s", name);
    TEST_ASSERT_TRUE_MESSAGE(convert(path, folder), "corsac-convert failed");
    gltf *g = gltf_open(path);
    loaded l = load(folder, name);
    size_t corners = gltf_corners(g, -1, 0, NULL);
    double *expected = malloc(corners * 3 * sizeof *expected);
    gltf_corners(g, -1, 0, expected);
    double size = size_of(expected, corners), worst = worst_corner(&l, expected, corners);
    snprintf(text, sizeof text, "%s at rest: %g of its size %g", name, worst / size, size);
    TEST_ASSERT_TRUE_MESSAGE(worst <= 1e-4 * size, text);
    TEST_ASSERT_EQUAL(gltf_animation_count(g), l.model->clip_count);
    for (int a = 0; a < gltf_animation_count(g); a += clip_step) {
        double end = gltf_animation_end(g, a);
        for (int k = 0; k < 5; k++) {
            float time = (float)(end * (0.03 + 0.23 * k));
            play(&l, (uint32_t)a, time);
            gltf_corners(g, a, (double)time, expected);
            worst = worst_corner(&l, expected, corners);
            snprintf(text, sizeof text, "%s clip %s at %g s: %g of its size", name,
                     l.model->clip[a].name, (double)time, worst / size);
            TEST_ASSERT_TRUE_MESSAGE(worst <= 1e-4 * size, text);
        }
    }
    free(expected);
    unload(&l);
    gltf_close(g);
}

static void test_simple_skin(void) { check_model("simple_skin", "simple_skin.gltf", 1); }
static void test_rigged_simple(void) { check_model("rigged_simple", "rigged_simple.gltf", 1); }
static void test_box_animated(void) { check_model("box_animated", "box_animated.gltf", 1); }
static void test_interpolation(void) {
    check_model("interpolation_test", "interpolation_test.gltf", 1);
}
static void test_cesium_man(void) { check_model("cesium_man", "cesium_man.gltf", 1); }
static void test_fox(void) { check_model("fox", "fox.glb", 1); }
static void test_knight(void) { check_model("kaykit_knight", "kaykit_knight.glb", 9); }

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_simple_skin);
    RUN_TEST(test_rigged_simple);
    RUN_TEST(test_box_animated);
    RUN_TEST(test_interpolation);
    RUN_TEST(test_cesium_man);
    RUN_TEST(test_fox);
    RUN_TEST(test_knight);
    return UNITY_END();
}
