// Energy: the white furnace by direct light and by ambient light, the DFG table, falloff,
// linearity, tone curve and encoding, against closed forms and finer integrals.
#include "support/gfx_fixture.h"

#include "gfx/gfx_device_internal.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

// GGX half vectors by their distribution, not by visible normals: another route to the integral.
static void reference_dfg(double nv, double roughness, int n, double *a, double *b) {
    double alpha = roughness * roughness, a2 = alpha * alpha;
    double vx = sqrt(1.0 - nv * nv);
    *a = *b = 0.0;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            double phi = 2.0 * CORE_PI * (i + 0.5) / n, t = (j + 0.5) / n;
            double u = 1.0 - t * t * t; // points gather where the weight is steep
            double hz = sqrt((1.0 - u) / (1.0 + (a2 - 1.0) * u)), hr = sqrt(1.0 - hz * hz);
            double vh = vx * hr * cos(phi) + nv * hz, nl = 2.0 * vh * hz - nv;
            if (nl > 0.0 && vh > 0.0) {
                double vis = 0.5 / (nl * sqrt(a2 + (1.0 - a2) * nv * nv) +
                                    nv * sqrt(a2 + (1.0 - a2) * nl * nl));
                double w = 3.0 * t * t * vis * nl * 4.0 * vh / hz, f = pow(1.0 - vh, 5.0);
                *a += w * (1.0 - f) / ((double)n * n);
                *b += w * f / ((double)n * n);
            }
        }
    }
}

static void test_dfg_table(void) {
    enum { SIZE = GFX_DFG_SIZE };
    gfx_fixture f = gfx_fixture_open(2, 2, true);
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    static float table[SIZE * SIZE * 2];
    glGetTextureImage(f.device->dfg_texture, 0, GL_RG, GL_FLOAT, sizeof table, table);
    double worst = 0.0;
    for (int j = 3; j < SIZE; j += 6) {
        for (int i = 1; i < SIZE; i += 6) {
            double a, b;
            reference_dfg((i + 0.5) / SIZE, j / (SIZE - 1.0), 400, &a, &b);
            const float *t = table + 2 * (j * SIZE + i);
            worst = fmax(worst, fmax(fabs(a - (double)t[0]), fabs(b - (double)t[1])));
        }
    }
    printf("DFG table: largest error %.5f\n", worst);
    accuracy_at_most("gfx: albedo table, largest error", worst, 0.004, "1");
    gfx_fixture_close(&f);
}

// Directions spread evenly over the sphere (Fibonacci), as suns of radiance one.
static void furnace_suns(gfx_world *world, int n) {
    for (int i = 0; i < n; ++i) {
        float y = 1.0f - 2.0f * ((float)i + 0.5f) / (float)n, r = sqrtf(1.0f - y * y);
        float phi = 2.399963229728653f * (float)i;
        gfx_add_sun(world, core_v3(r * cosf(phi), y, r * sinf(phi)), 4.0f * CORE_PI_F / (float)n);
    }
}

static float furnace(gfx_fixture *f, float metallic, float roughness, float cosine) {
    gfx_material_desc m = gfx_material_desc_default();
    m.data.metallic = metallic;
    m.data.roughness = roughness;
    gfx_instance_desc d = {.mesh = gfx_mesh_builtin(f->world, "plane"),
                           .material = gfx_material_create(f->world, &m)};
    gfx_instance plane = gfx_instance_create(f->world, &d);
    gfx_instance_set_transform(f->world, plane, core_v3(0, 0, 0), core_quat_identity(),
                               core_v3(100, 1, 100));
    float s = sqrtf(1.0f - cosine * cosine);
    gfx_look(f->world, core_v3(3.0f * s, 3.0f * cosine, 0.0f), core_v3(0, 0, 0));
    float *rgba = gfx_fixture_hdr(f);
    float value = rgba[4 * (f->width * (f->height / 2) + f->width / 2) + 1];
    core_free(rgba);
    gfx_instance_destroy(f->world, plane);
    return value;
}

// A surface that is white in every direction, under light of radiance one from every direction,
// sends one back.
static void test_white_furnace_by_direct_light(void) {
    gfx_fixture f = gfx_fixture_open(3, 3, true);
    gfx_camera c = {.fovy = 0.002f, .near_plane = 0.1f};
    gfx_world_set_camera(f.world, &c);
    gfx_world_set_ambient(f.world, 0, 0, 0);
    furnace_suns(f.world, 16384);
    const float roughness[] = {0.3f, 0.5f, 0.75f, 1.0f}, cosines[] = {0.999f, 0.7f, 0.4f, 0.2f};
    float worst_metal = 0.0f, most_dielectric = 0.0f;
    for (size_t i = 0; i < CORE_COUNT_OF(roughness); ++i) {
        for (size_t k = 0; k < CORE_COUNT_OF(cosines); ++k) {
            float metal = furnace(&f, 1.0f, roughness[i], cosines[k]);
            float plastic = furnace(&f, 0.0f, roughness[i], cosines[k]);
            worst_metal = fmaxf(worst_metal, fabsf(metal - 1.0f));
            most_dielectric = fmaxf(most_dielectric, plastic);
        }
    }
    printf("white furnace: metal within %.4f, dielectric at most %.4f\n", (double)worst_metal,
           (double)most_dielectric);
    accuracy_at_most("gfx: white furnace, metal, largest error", (double)worst_metal, 0.003, "1");
    accuracy_at_most("gfx: white furnace, dielectric, most", (double)most_dielectric, 1.005, "1");
    gfx_fixture_close(&f);
}

// Inverse square, windowed: E = I / d^2 (1 - (d/r)^4)^2 on a rough white plane below the light.
static void test_falloff(void) {
    gfx_fixture f = gfx_fixture_open(3, 3, true);
    gfx_camera c = {.fovy = 0.002f, .near_plane = 0.1f};
    gfx_world_set_camera(f.world, &c);
    gfx_world_set_ambient(f.world, 0, 0, 0);
    gfx_light light = gfx_add_point(f.world, core_v3(0, 1, 0), 10.0f, 1.0f);
    float unit = 0.0f, worst = 0.0f;
    for (float d = 0.5f; d < 10.0f; d *= 1.3f) {
        gfx_light_set_position(f.world, light, core_v3(0, d, 0));
        float got = furnace(&f, 0.0f, 1.0f, 0.5f), x = d / 10.0f, w = 1.0f - x * x * x * x;
        float want = w * w / (d * d);
        unit = unit > 0.0f ? unit : got / want; // one factor: the plane's reflectance
        worst = fmaxf(worst, fabsf(got / (unit * want) - 1.0f));
    }
    printf("falloff: relative error %.2e\n", (double)worst);
    accuracy_at_most("gfx: falloff, largest relative error", (double)worst, 1e-4, "1");
    gfx_light_set_position(f.world, light, core_v3(0, 10.001f, 0));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, furnace(&f, 0.0f, 1.0f, 0.5f)); // nothing beyond the radius
    gfx_fixture_close(&f);
}

// Light adds up: the picture of many lights is the sum of their pictures.
static void test_lights_add(void) {
    gfx_fixture f = gfx_fixture_open(24, 16, true);
    gfx_world_set_ambient(f.world, 0, 0, 0);
    gfx_world_set_background(f.world, 0, 0, 0);
    gfx_add(f.world, "sphere", core_v3(0, 0, 0), core_v3(2, 2, 2), 0.8f, 0.5f, 0.2f);
    gfx_look(f.world, core_v3(0, 0, 4), core_v3(0, 0, 0));
    const size_t n = 24 * 16 * 4;
    float *sum = core_alloc(n * sizeof *sum);
    for (int pass = 0; pass < 4; ++pass) {
        gfx_light l = gfx_add_point(f.world, core_v3((float)pass - 1.5f, 1, 2), 6, 3);
        float *one = gfx_fixture_hdr(&f);
        for (size_t i = 0; i < n; ++i) {
            sum[i] += one[i];
        }
        core_free(one);
        gfx_light_destroy(f.world, l);
    }
    for (int pass = 0; pass < 4; ++pass) {
        gfx_add_point(f.world, core_v3((float)pass - 1.5f, 1, 2), 6, 3);
    }
    float *all = gfx_fixture_hdr(&f);
    for (size_t i = 0; i < n; ++i) {
        all[i] += i % 4 == 3 ? 3.0f : 0.0f; // alpha was added four times
    }
    accuracy_at_most("gfx: sum of lights, largest difference",
                     (double)gfx_max_difference(all, sum, n), 1e-4, "radiance");
    core_free(all);
    core_free(sum);
    gfx_fixture_close(&f);
}

// Khronos PBR Neutral and plain, then sRGB: a grey background at seven luminances.
static void test_tone_curve(void) {
    const float in[] = {0.02f, 0.18f, 0.5f, 1.0f, 2.0f, 4.0f, 16.0f};
    const float neutral[] = {0.0025f, 0.14f, 0.46f, 0.8691f, 0.96f, 0.9833f, 0.9963f};
    gfx_fixture f = gfx_fixture_open(2, 2, true);
    double worst = 0.0;
    for (int linear = 0; linear < 2; ++linear) {
        gfx_world_set(f.world, "tonemap", linear ? "linear" : "neutral");
        for (size_t i = 0; i < CORE_COUNT_OF(in); ++i) {
            gfx_world_set_background(f.world, in[i], in[i], in[i]);
            float c = linear ? fminf(in[i], 1.0f) : neutral[i];
            float srgb = c <= 0.0031308f ? 12.92f * c : 1.055f * powf(c, 1.0f / 2.4f) - 0.055f;
            uint8_t *rgba = gfx_fixture_ldr(&f);
            worst = fmax(worst, fabs((double)srgb * 255.0 - (double)rgba[0]));
            core_free(rgba);
        }
    }
    accuracy_at_most("gfx: tone curve and sRGB, largest error", worst, 1.0, "of 255");
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_dfg_table);
    RUN_TEST(test_white_furnace_by_direct_light);
    RUN_TEST(test_falloff);
    RUN_TEST(test_lights_add);
    RUN_TEST(test_tone_curve);
    return UNITY_END();
}
