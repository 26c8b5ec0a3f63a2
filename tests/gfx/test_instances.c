// Instances on the GPU: only what changed is written, what was not is not lost, and a crowd of
// skinned instances is one draw.
#include "support/gfx_fixture.h"

#include "core/rng.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { W = 64, H = 48, MANY = 300 };

static uint32_t render(gfx_fixture *f) {
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f->device, f->world), core_last_error());
    return gfx_world_stats(f->world).uploads;
}

static core_vec3 somewhere(core_rng *rng) {
    float x = core_rng_float(rng), y = core_rng_float(rng), z = core_rng_float(rng);
    return core_v3(12 * x - 6, 12 * y - 6, 12 * z - 6);
}

static void test_a_still_scene_uploads_nothing(void) {
    gfx_fixture f = gfx_fixture_open(W, H, true);
    core_rng rng = core_rng_make(1, 1);
    gfx_instance all[MANY];
    for (int i = 0; i < MANY; ++i) {
        all[i] = gfx_add(f.world, "box", somewhere(&rng), core_v3(1, 1, 1), 0.5f, 0.5f, 0.5f);
    }
    gfx_look(f.world, core_v3(0, 0, 20), core_v3(0, 0, 0));
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_EQUAL_UINT32(MANY, render(&f)); // each turn's buffer once
    }
    for (int i = 0; i < 5; ++i) { // the camera may move
        gfx_look(f.world, core_v3((float)i, 1, 20), core_v3(0, 0, 0));
        TEST_ASSERT_EQUAL_UINT32(0, render(&f));
    }
    gfx_instance_set_transform(f.world, all[7], core_v3(1, 2, 3), core_quat_identity(),
                               core_v3(1, 1, 1));
    gfx_instance_set_color(f.world, all[9], 1, 0, 0, 1);
    gfx_instance_set_color(f.world, all[11], 0.5f, 0.5f, 0.5f, 1); // as it is
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_EQUAL_UINT32(2, render(&f));
    }
    TEST_ASSERT_EQUAL_UINT32(0, render(&f));
    gfx_fixture_close(&f);
}

// After any changes in any order a device that saw them all shows what a new one does.
static void test_nothing_that_changed_is_missed(void) {
    gfx_fixture f = gfx_fixture_open(W, H, true);
    core_rng rng = core_rng_make(2, 1);
    gfx_instance all[MANY];
    uint32_t count = 0;
    gfx_look(f.world, core_v3(0, 0, 20), core_v3(0, 0, 0));
    gfx_add_sun(f.world, core_v3(-1, -1, -1), 3.0f);
    gfx_device_desc desc = gfx_device_desc_default();
    desc.width = W, desc.height = H, desc.vfs = f.vfs, desc.float_target = true;
    gfx_material_desc m = gfx_material_desc_default();
    gfx_material materials[4];
    for (int i = 0; i < 4; ++i) {
        m.data.base_color[i % 3] = 0.2f * (float)i;
        materials[i] = gfx_material_create(f.world, &m);
    }
    for (int round = 0; round < 40; ++round) {
        for (int k = 0; k < 12; ++k) {
            uint32_t i = count ? core_rng_below(&rng, count) : 0, what = core_rng_below(&rng, 4);
            if (count == 0 || (what == 0 && count < MANY)) {
                gfx_instance_desc d = {.mesh = gfx_mesh_builtin(f.world, k & 1 ? "box" : "sphere"),
                                       .material = materials[core_rng_below(&rng, 4)]};
                all[count] = gfx_instance_create(f.world, &d);
                gfx_instance_set_transform(f.world, all[count++], somewhere(&rng),
                                           core_quat_identity(), core_v3(1, 1, 1));
            } else if (what == 1) {
                gfx_instance_destroy(f.world, all[i]);
                all[i] = all[--count];
            } else if (what == 2) {
                gfx_instance_set_transform(f.world, all[i], somewhere(&rng), core_quat_identity(),
                                           core_v3(1, 2, 1));
            } else {
                gfx_instance_set_color(f.world, all[i], core_rng_float(&rng), 1, 0, 1);
            }
        }
        if (round == 20) { // rows of materials move
            gfx_material_destroy(f.world, materials[0]);
            materials[0] = materials[1];
        }
        render(&f);
        if (round % 8 == 7) {
            float *seen = gfx_fixture_hdr(&f), *fresh = core_alloc(W * H * 4 * sizeof *fresh);
            gfx_device *device = gfx_device_create(&desc);
            TEST_ASSERT_TRUE(gfx_device_render(device, f.world));
            TEST_ASSERT_TRUE(gfx_device_read_float(device, fresh));
            TEST_ASSERT_EQUAL_FLOAT(0.0f, gfx_max_difference(seen, fresh, W * H * 4));
            gfx_device_destroy(device);
            core_free(seen);
            core_free(fresh);
        }
    }
    gfx_fixture_close(&f);
}

// A square with one bone: its palette places it. Sixty of them, each with a palette of its own, are
// two draws (depth, shading), land where squares without skin do, and at rest are not sent again.
static void test_a_crowd_is_one_draw(void) {
    enum { CROWD = 60 };
    const float position[12] = {-0.3f, -0.3f, 0, 0.3f, -0.3f, 0, -0.3f, 0.3f, 0, 0.3f, 0.3f, 0};
    const uint16_t joint[16] = {0};
    const float weight[16] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    const uint32_t index[6] = {0, 1, 2, 2, 1, 3};
    gfx_fixture f = gfx_fixture_open(W, H, true);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "shadows", "off"));
    core_mesh_data data = {.vertex_count = 4,
                           .index_count = 6,
                           .position = position,
                           .index = index,
                           .joint = joint,
                           .weight = weight};
    gfx_look(f.world, core_v3(0, 0, 12), core_v3(0, 0, 0));
    float *picture[2];
    for (int skinned = 1; skinned >= 0; --skinned) {
        core_rng rng = core_rng_make(5, 1);
        gfx_instance crowd[CROWD];
        data.joint = skinned ? joint : NULL;
        gfx_instance_desc d = {.mesh = gfx_mesh_create(f.world, &data)};
        for (int i = 0; i < CROWD; ++i) {
            core_vec3 p = somewhere(&rng);
            const float rows[12] = {1, 0, 0, p.x, 0, 1, 0, p.y, 0, 0, 1, p.z};
            crowd[i] = gfx_instance_create(f.world, &d);
            if (skinned) {
                TEST_ASSERT_TRUE(gfx_instance_set_palette(f.world, crowd[i], rows, 1));
            } else {
                gfx_instance_set_transform(f.world, crowd[i], p, core_quat_identity(),
                                           core_v3(1, 1, 1));
            }
        }
        picture[skinned] = gfx_fixture_hdr(&f);
        TEST_ASSERT_EQUAL_UINT32(2, gfx_world_stats(f.world).draws);
        render(&f), render(&f);
        TEST_ASSERT_EQUAL_UINT32(0, render(&f));
        for (int i = 0; i < CROWD; ++i) {
            gfx_instance_destroy(f.world, crowd[i]);
        }
    }
    TEST_ASSERT_EQUAL_FLOAT(0.0f, gfx_max_difference(picture[0], picture[1], W * H * 4));
    core_free(picture[0]);
    core_free(picture[1]);
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_still_scene_uploads_nothing);
    RUN_TEST(test_nothing_that_changed_is_missed);
    RUN_TEST(test_a_crowd_is_one_draw);
    return UNITY_END();
}
