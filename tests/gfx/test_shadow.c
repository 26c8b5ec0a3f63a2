// Shadows against rays: no acne, little peter-panning, edges within a texel, penumbrae near those
// of an area light; maps are drawn again only when something changed.
#include "support/gfx_fixture.h"

#include "core/rng.h"
#include "gfx/gfx_device_internal.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

enum { SIZE = 192 };
static const float span = 8.0f; // metres of floor across the picture

void setUp(void) {}
void tearDown(void) {}

// Floor seen from straight above, without perspective: pixel (x, y) is the floor's (px, pz).
static gfx_fixture open_floor(void) {
    gfx_fixture f = gfx_fixture_open(SIZE, SIZE, true);
    gfx_world_set_ambient(f.world, 0, 0, 0);
    gfx_world_set_background(f.world, 0, 0, 0);
    gfx_add(f.world, "plane", core_v3(0, 0, 0), core_v3(20, 1, 20), 1, 1, 1);
    gfx_camera c = {.position = {0, 20, 0},
                    .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                    .near_plane = 0.1f,
                    .virtual_far = 40.0f,
                    .ortho_height = span};
    gfx_world_set_camera(f.world, &c);
    return f;
}

static float floor_x(int x) { return ((float)x + 0.5f) / SIZE * span - 0.5f * span; }

// Share of the light that reaches each pixel: with shadows over without. -1 where nothing is lit.
static float *visibility(gfx_fixture *f, const char *method) {
    TEST_ASSERT_TRUE(gfx_world_set(f->world, "shadows", "off"));
    float *open = gfx_fixture_hdr(f);
    TEST_ASSERT_TRUE(gfx_world_set(f->world, "shadows", method));
    float *cast = gfx_fixture_hdr(f);
    for (int i = 0; i < SIZE * SIZE; ++i) {
        cast[i] = open[4 * i] > 1e-6f ? cast[4 * i] / open[4 * i] : -1.0f;
    }
    core_free(open);
    return cast;
}

static void test_no_acne(void) {
    gfx_fixture f = open_floor();
    gfx_light sun = gfx_add_sun(f.world, core_v3(0, -1, 0), 3.0f);
    uint32_t dark = 0;
    for (int degrees = 5; degrees <= 85; degrees += 8) {
        for (int turn = 0; turn < 3; ++turn) {
            float e = (float)degrees * CORE_PI_F / 180.0f, a = 0.7f * (float)turn;
            gfx_light_set_direction(f.world, sun,
                                    core_v3(cosf(e) * cosf(a), -sinf(e), cosf(e) * sinf(a)));
            for (int soft = 0; soft < 2; ++soft) {
                float *v = visibility(&f, soft ? "soft" : "pcf");
                for (int i = 0; i < SIZE * SIZE; ++i) {
                    dark += !(fabsf(v[i] - 1.0f) <= 1e-6f);
                }
                core_free(v);
            }
        }
    }
    accuracy_at_most("gfx: pixels of a plane in their own shadow, sun at 5 to 85 degrees", dark,
                     0.0, "pixels");
    gfx_fixture_close(&f);
}

// Where visibility falls below a half, going left along the row at z = 0 from the lit side.
static float shadow_end(const float *v) {
    const float *row = v + SIZE * (SIZE / 2);
    for (int x = SIZE - 2; x > 0; --x) {
        if (row[x] < 0.5f && row[x] >= 0.0f) {
            float t = (row[x + 1] - 0.5f) / (row[x + 1] - row[x]);
            return floor_x(x + 1) - t * span / SIZE;
        }
    }
    return NAN;
}

// Metres a texel of the cascade that the floor, 20 m from the camera, lies in.
static float floor_texel(const gfx_fixture *f) {
    const gfx_shadow_view *v = f->device->shadows.view;
    while (v->block.depth[2] < 20.0f) {
        ++v;
    }
    return v->block.texel[0];
}

// A unit cube under a sun from the left: its shadow ends at 0.5 + 1 / tan(elevation) and begins at
// its foot.
static void test_sun_edges(void) {
    gfx_fixture f = open_floor();
    gfx_add(f.world, "box", core_v3(0, 0.5f, 0), core_v3(1, 1, 1), 1, 1, 1);
    gfx_light sun = gfx_add_sun(f.world, core_v3(1, -1, 0), 3.0f);
    float worst = 0.0f, pan = 0.0f;
    for (int degrees = 25; degrees <= 80; degrees += 5) {
        float e = (float)degrees * CORE_PI_F / 180.0f;
        gfx_light_set_direction(f.world, sun, core_v3(cosf(e), -sinf(e), 0));
        float *v = visibility(&f, "pcf");
        float texel = floor_texel(&f);
        float want = 0.5f + 1.0f / tanf(e), got = shadow_end(v);
        worst = fmaxf(worst, fabsf(got - want) / texel);
        for (int x = SIZE / 2; x < SIZE; ++x) { // behind the foot it must be dark
            float at = floor_x(x) - 0.5f;
            if (at > 0.0f && floor_x(x) < want - 3.0f * texel && v[SIZE * (SIZE / 2) + x] > 0.5f) {
                pan = fmaxf(pan, at / texel);
            }
        }
        core_free(v);
    }
    printf("sun: edge within %.2f texels, peter-panning %.2f texels\n", (double)worst, (double)pan);
    accuracy_at_most("gfx: shadow edge of a sun", (double)worst, 1.0, "texels");
    accuracy_at_most("gfx: peter-panning of a sun", (double)pan, 2.0, "texels");
    gfx_fixture_close(&f);
}

// A floor of a thousand kilometres, a thing of no size at all and a caster far above change
// nothing.
static void test_far_things_leave_shadows_alone(void) {
    gfx_fixture f = open_floor();
    gfx_add(f.world, "plane", core_v3(0, -0.01f, 0), core_v3(1e6f, 1, 1e6f), 1, 1, 1);
    gfx_add(f.world, "box", core_v3(0, 0.5f, 0), core_v3(1, 1, 1), 1, 1, 1);
    gfx_add(f.world, "box", core_v3(NAN, 0, 0), core_v3(1, 1, 1), 1, 1, 1);
    gfx_add_sun(f.world, core_v3(1, -1, 0), 3.0f);
    float *v = visibility(&f, "pcf");
    TEST_ASSERT_FLOAT_WITHIN(floor_texel(&f), 1.5f, shadow_end(v));
    for (int x = 0; x < SIZE / 4; ++x) {
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, v[SIZE * (SIZE / 2) + x]); // no acne
    }
    core_free(v);
    // 2 km towards the sun: its shadow falls on the whole picture.
    gfx_add(f.world, "box", core_v3(-2000, 2000, 0), core_v3(60, 1, 60), 1, 1, 1);
    v = visibility(&f, "pcf");
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0f, v[SIZE * (SIZE / 4) + SIZE / 4]);
    core_free(v);
    gfx_fixture_close(&f);
}

// The same cube under a point light or spot at (-1, 3): its shadow ends where the ray over its
// upper right edge meets the floor.
static void test_local_edges(void) {
    for (int type = GFX_POINT; type <= GFX_SPOT; ++type) {
        gfx_fixture f = open_floor();
        gfx_add(f.world, "box", core_v3(0, 0.5f, 0), core_v3(1, 1, 1), 1, 1, 1);
        gfx_light_desc d = gfx_light_desc_default((gfx_light_type)type);
        d.position = core_v3(-1, 3, 0);
        d.direction = core_v3(0.4f, -1, 0);
        d.inner = 1.1f;
        d.outer = 1.2f;
        d.radius = 30.0f;
        d.shadows = true;
        gfx_light_create(f.world, &d);
        float *v = visibility(&f, "pcf");
        float want = -1.0f + 1.5f * 3.0f / 2.0f, got = shadow_end(v);
        float texel = f.device->shadows.view[0].block.texel[0] * 3.9f;
        printf("%s: edge at %.4f m, by ray %.4f m, texel %.4f m\n",
               type == GFX_POINT ? "point" : "spot", (double)got, (double)want, (double)texel);
        accuracy_at_most(type == GFX_POINT ? "gfx: shadow edge of a point light"
                                           : "gfx: shadow edge of a spot",
                         fabs((double)got - (double)want) / (double)texel, 1.0, "texels");
        core_free(v);
        gfx_fixture_close(&f);
    }
}

// Slab test: does the ray from p along d meet the box [-h, h]^3 round c?
static bool ray_meets_box(core_vec3 p, core_vec3 d, core_vec3 c, float h) {
    const float o[3] = {p.x - c.x, p.y - c.y, p.z - c.z}, v[3] = {d.x, d.y, d.z};
    float from = 0.0f, to = INFINITY;
    for (int i = 0; i < 3; ++i) {
        float a = (-h - o[i]) / v[i], b = (h - o[i]) / v[i];
        from = fmaxf(from, fminf(a, b));
        to = fminf(to, fmaxf(a, b));
    }
    return from <= to;
}

// A box in the air under a sun with a disk of tangent 0.1: visibility against rays to the disk.
static void test_soft_shadow_against_an_area_light(void) {
    gfx_fixture f = open_floor();
    const core_vec3 center = {-1, 2.5f, 0.3f};
    gfx_add(f.world, "box", center, core_v3(1.6f, 1.6f, 1.6f), 1, 1, 1);
    gfx_light_desc d = gfx_light_desc_default(GFX_DIRECTIONAL);
    d.direction = core_v3(0.5f, -1, 0.1f);
    d.source = 0.1f;
    gfx_light_create(f.world, &d);
    float *v = visibility(&f, "soft");
    core_vec3 l = core_v3_normalize(core_v3(-0.5f, 1, -0.1f), core_v3(0, 1, 0));
    core_vec3 side = core_v3_normalize(core_v3_cross(l, core_v3(0, 0, 1)), core_v3(1, 0, 0));
    core_vec3 up = core_v3_cross(side, l);
    core_rng rng = core_rng_make(2, 1);
    double sum = 0.0;
    int n = 0, penumbra = 0;
    for (int y = 0; y < SIZE; y += 2) {
        for (int x = 0; x < SIZE; x += 2) {
            core_vec3 p = {floor_x(x), 0, floor_x(y)};
            if (fabsf(p.x - center.x) < 0.85f && fabsf(p.z - center.z) < 0.85f) {
                continue; // the box hides the floor
            }
            int lit = 0;
            for (int k = 0; k < 64; ++k) {
                float r = 0.1f * sqrtf(core_rng_float(&rng)), a = 6.2831853f * core_rng_float(&rng);
                core_vec3 to = core_v3_mad(core_v3_mad(l, side, r * cosf(a)), up, r * sinf(a));
                lit += !ray_meets_box(p, to, center, 0.8f);
            }
            double e = (double)v[y * SIZE + x] - lit / 64.0;
            if (lit > 0 && lit < 64) {
                penumbra++;
            }
            sum += e * e;
            n++;
        }
    }
    double rms = sqrt(sum / n);
    printf("soft shadow: rms %.4f over the floor, %d of %d points in penumbra\n", rms, penumbra, n);
    TEST_ASSERT_GREATER_THAN(200, penumbra);
    accuracy_at_most("gfx: soft shadow against an area light, rms", rms, 0.1, "visibility");
    core_free(v);
    gfx_fixture_close(&f);
}

static uint32_t passes(gfx_fixture *f) {
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f->device, f->world), core_last_error());
    return gfx_device_used(f->device).passes;
}

static void test_maps_are_kept(void) {
    gfx_fixture f = open_floor();
    gfx_instance box = gfx_add(f.world, "box", core_v3(0, 0.5f, 0), core_v3(1, 1, 1), 1, 1, 1);
    gfx_add_sun(f.world, core_v3(1, -1, 0), 3.0f);
    uint32_t first = passes(&f), again = passes(&f);
    TEST_ASSERT_EQUAL_UINT32(first - 3, again); // three cascades stay
    gfx_instance_set_transform(f.world, box, core_v3(0, 0.5f, 0), core_quat_identity(),
                               core_v3(1, 1, 1));
    TEST_ASSERT_EQUAL_UINT32(again, passes(&f)); // the same place is no change
    gfx_instance_set_transform(f.world, box, core_v3(0.1f, 0.5f, 0), core_quat_identity(),
                               core_v3(1, 1, 1));
    TEST_ASSERT_EQUAL_UINT32(first, passes(&f));
    gfx_fixture_close(&f);
}

// More lights than maps: those without are drawn without shadow, nothing fails.
static void test_more_lights_than_maps(void) {
    gfx_fixture f = open_floor();
    for (int i = 0; i < 30; ++i) {
        gfx_light_desc d = gfx_light_desc_default(GFX_POINT);
        d.position = core_v3((float)i * 0.2f - 3.0f, 2, 0);
        d.shadows = true;
        gfx_light_create(f.world, &d);
    }
    gfx_world_set(f.world, "shadow_size", "64");
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    TEST_ASSERT_EQUAL_UINT32(60, f.device->shadows.count);
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_no_acne);
    RUN_TEST(test_sun_edges);
    RUN_TEST(test_far_things_leave_shadows_alone);
    RUN_TEST(test_local_edges);
    RUN_TEST(test_soft_shadow_against_an_area_light);
    RUN_TEST(test_maps_are_kept);
    RUN_TEST(test_more_lights_than_maps);
    return UNITY_END();
}
