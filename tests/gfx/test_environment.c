// Image-based light against integrals over the same sky, done slowly on the processor.
#include "support/gfx_fixture.h"

#include "gfx/gfx_device_internal.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

static double smoothstep(double a, double b, double x) {
    double t = fmin(fmax((x - a) / (b - a), 0.0), 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// The procedural sky once more, green channel.
static double sky(const gfx_environment *e, core_vec3 d) {
    double up = fmax((double)d.y, 0.0), t = 1.0 - pow(1.0 - up, 4.0);
    double above = (double)e->horizon[1] + t * (double)(e->zenith[1] - e->horizon[1]);
    double side = smoothstep(-0.03, 0.03, (double)d.y);
    core_vec3 sun = core_v3_normalize(e->sun, core_v3(0, 1, 0));
    double glow = pow(fmax((double)core_v3_dot(d, sun), 0.0), (double)e->glow_exponent);
    return ((1.0 - side) * (double)e->ground[1] + side * above + (double)e->glow[1] * glow) *
           (double)e->intensity;
}

static core_vec3 fibonacci(int i, int n) {
    float y = 1.0f - 2.0f * ((float)i + 0.5f) / (float)n, r = sqrtf(1.0f - y * y);
    float phi = 2.399963229728653f * (float)i;
    return core_v3(r * cosf(phi), y, r * sinf(phi));
}

static gfx_environment sunny(void) {
    gfx_environment e = gfx_environment_default();
    for (int c = 0; c < 3; ++c) {
        e.glow[c] = 4.0f;
    }
    e.glow_exponent = 20.0f;
    return e;
}

static void test_irradiance(void) {
    gfx_fixture f = gfx_fixture_open(4, 4, true);
    gfx_environment e = sunny();
    TEST_ASSERT_TRUE(gfx_world_set_environment(f.world, &e));
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    const float(*h)[4] = (const float(*)[4])f.device->environment.harmonics;
    double squares = 0.0, worst = 0.0;
    enum { NORMALS = 60, DIRECTIONS = 40000 };
    for (int i = 0; i < NORMALS; ++i) {
        core_vec3 n = fibonacci(i, NORMALS);
        double want = 0.0;
        for (int k = 0; k < DIRECTIONS; ++k) {
            core_vec3 d = fibonacci(k, DIRECTIONS);
            double cosine = (double)core_v3_dot(n, d);
            want += cosine > 0.0 ? sky(&e, d) * cosine * 4.0 / DIRECTIONS : 0.0; // over pi
        }
        double got =
            (double)(h[0][1] + h[1][1] * n.y + h[2][1] * n.z + h[3][1] * n.x + h[4][1] * n.x * n.y +
                     h[5][1] * n.y * n.z + h[6][1] * (3.0f * n.z * n.z - 1.0f) +
                     h[7][1] * n.x * n.z + h[8][1] * (n.x * n.x - n.y * n.y));
        double error = fabs(got / want - 1.0);
        squares += error * error;
        worst = fmax(worst, error);
    }
    double rms = sqrt(squares / NORMALS);
    printf("irradiance: rms %.2f %%, largest %.2f %%\n", 100.0 * rms, 100.0 * worst);
    accuracy_at_most("gfx: irradiance by harmonics, rms error", rms, 0.03, "1");
    accuracy_at_most("gfx: irradiance by harmonics, largest error", worst, 0.08, "1");
    gfx_fixture_close(&f);
}

// Mean radiance under the GGX lobe of a view, by visible normals: what a compensated white metal
// reflects.
static double reflect_sky(const gfx_environment *e, core_vec3 n, core_vec3 v, float roughness) {
    enum { SAMPLES = 16384 };
    float alpha = roughness * roughness, a2 = alpha * alpha;
    core_vec3 side = core_v3_normalize(
        core_v3_cross(fabsf(n.z) < 0.9f ? core_v3(0, 0, 1) : core_v3(1, 0, 0), n), n);
    core_vec3 up = core_v3_cross(n, side);
    core_vec3 w = {core_v3_dot(v, side), core_v3_dot(v, up), core_v3_dot(v, n)};
    core_vec3 s = core_v3_normalize(core_v3(alpha * w.x, alpha * w.y, w.z), w);
    double sum = 0.0, weight = 0.0;
    for (int i = 0; i < SAMPLES; ++i) {
        float u = ((float)i + 0.5f) / SAMPLES, phi = 2.399963229728653f * (float)i;
        float z = (1.0f - u) * (1.0f + s.z) - s.z, r = sqrtf(fmaxf(1.0f - z * z, 0.0f));
        core_vec3 h = {r * cosf(phi) + s.x, r * sinf(phi) + s.y, z + s.z};
        h = core_v3_normalize(core_v3(alpha * h.x, alpha * h.y, h.z), core_v3(0, 0, 1));
        float vh = core_v3_dot(w, h);
        core_vec3 l = {2.0f * vh * h.x - w.x, 2.0f * vh * h.y - w.y, 2.0f * vh * h.z - w.z};
        if (l.z > 0.0f) {
            float lv = sqrtf(a2 + (1.0f - a2) * w.z * w.z),
                  ll = sqrtf(a2 + (1.0f - a2) * l.z * l.z);
            double g = (double)(l.z * (w.z + lv) / (w.z * ll + l.z * lv));
            core_vec3 d = core_v3_add(core_v3_add(core_v3_scale(side, l.x), core_v3_scale(up, l.y)),
                                      core_v3_scale(n, l.z));
            sum += g * sky(e, d);
            weight += g;
        }
    }
    return sum / weight;
}

// A white metal disk with normal n seen at an angle: the middle pixel.
static float metal_pixel(gfx_fixture *f, gfx_material material, core_vec3 n, core_vec3 v) {
    gfx_instance_desc d = {.mesh = gfx_mesh_builtin(f->world, "plane"), .material = material};
    gfx_instance plane = gfx_instance_create(f->world, &d);
    core_vec3 axis = core_v3_cross(core_v3(0, 1, 0), n);
    core_quat q = core_quat_axis_angle(core_v3_normalize(axis, core_v3(1, 0, 0)), acosf(n.y));
    gfx_instance_set_transform(f->world, plane, core_v3(0, 0, 0), q, core_v3(9, 1, 9));
    gfx_look(f->world, core_v3_scale(v, 2.0f), core_v3(0, 0, 0));
    float *rgba = gfx_fixture_hdr(f);
    float value = rgba[4 * (f->width * (f->height / 2) + f->width / 2) + 1];
    core_free(rgba);
    gfx_instance_destroy(f->world, plane);
    return value;
}

static double reflection_error(gfx_fixture *f, const gfx_environment *e, float roughness,
                               float cosine) {
    enum { NORMALS = 24 };
    gfx_material_desc m = gfx_material_desc_default();
    m.data.metallic = 1.0f;
    m.data.roughness = roughness;
    gfx_material material = gfx_material_create(f->world, &m);
    double squares = 0.0;
    for (int i = 0; i < NORMALS; ++i) {
        core_vec3 n = fibonacci(i, NORMALS);
        core_vec3 side = core_v3_normalize(core_v3_cross(n, core_v3(0.3f, 0.5f, 0.8f)), n);
        core_vec3 v = core_v3_mad(core_v3_scale(n, cosine), side, sqrtf(1.0f - cosine * cosine));
        double error =
            (double)metal_pixel(f, material, n, v) / reflect_sky(e, n, v, roughness) - 1.0;
        squares += error * error;
    }
    gfx_material_destroy(f->world, material);
    return sqrt(squares / NORMALS);
}

static void test_reflections(void) {
    gfx_fixture f = gfx_fixture_open(3, 3, true);
    gfx_camera c = {.fovy = 0.002f, .near_plane = 0.1f};
    gfx_world_set_camera(f.world, &c);
    gfx_environment e = sunny();
    gfx_world_set_environment(f.world, &e);
    const float roughness[] = {0.25f, 0.5f, 0.75f, 1.0f};
    double most_straight = 0.0, most_slanting = 0.0;
    for (size_t i = 0; i < CORE_COUNT_OF(roughness); ++i) {
        double straight = reflection_error(&f, &e, roughness[i], 0.999f);
        double slanting = reflection_error(&f, &e, roughness[i], 0.3f);
        printf("reflections, roughness %.2f: rms %.1f %% head-on, %.1f %% at cosine 0.3\n",
               (double)roughness[i], 100.0 * straight, 100.0 * slanting);
        most_straight = straight > most_straight ? straight : most_straight;
        most_slanting = slanting > most_slanting ? slanting : most_slanting;
    }
    accuracy_at_most("gfx: reflections head-on, rms error", most_straight, 0.07, "1");
    accuracy_at_most("gfx: reflections at cosine 0.3, rms error", most_slanting, 0.20, "1");
    gfx_fixture_close(&f);
}

// Under a sky that is one everywhere, white stays white at any roughness and angle.
static void test_white_furnace(void) {
    gfx_fixture f = gfx_fixture_open(3, 3, true);
    gfx_camera c = {.fovy = 0.002f, .near_plane = 0.1f};
    gfx_world_set_camera(f.world, &c);
    gfx_environment e = gfx_environment_default();
    for (int i = 0; i < 3; ++i) {
        e.zenith[i] = e.horizon[i] = e.ground[i] = 1.0f;
        e.glow[i] = 0.0f;
    }
    gfx_world_set_environment(f.world, &e);
    float worst = 0.0f;
    for (int i = 0; i < 12; ++i) {
        gfx_material_desc m = gfx_material_desc_default();
        m.data.metallic = (float)(i % 2);
        m.data.roughness = 0.1f + 0.15f * (float)(i / 2);
        gfx_material material = gfx_material_create(f.world, &m);
        float cosine = 0.15f + 0.07f * (float)i;
        core_vec3 v = {sqrtf(1.0f - cosine * cosine), cosine, 0};
        worst = fmaxf(worst, fabsf(metal_pixel(&f, material, core_v3(0, 1, 0), v) - 1.0f));
    }
    printf("white furnace by environment: within %.4f\n", (double)worst);
    accuracy_at_most("gfx: white furnace by environment, largest error", (double)worst, 0.003, "1");
    gfx_fixture_close(&f);
}

// The sky behind everything has the radiance of its direction.
static void test_sky_is_seen(void) {
    gfx_fixture f = gfx_fixture_open(5, 5, true);
    gfx_environment e = sunny();
    gfx_world_set_environment(f.world, &e);
    for (int i = 0; i < 10; ++i) {
        core_vec3 d = fibonacci(i, 10);
        gfx_look(f.world, core_v3(0, 0, 0), d);
        float *rgba = gfx_fixture_hdr(&f);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)sky(&e, d), rgba[4 * 12 + 1]);
        core_free(rgba);
    }
    gfx_world_set_environment(f.world, NULL);
    gfx_world_set_background(f.world, 0.25f, 0.5f, 0.75f);
    float *rgba = gfx_fixture_hdr(&f);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, rgba[4 * 12 + 1]);
    core_free(rgba);
    e.panorama = "absent.hdr";
    TEST_ASSERT_TRUE(gfx_world_set_environment(f.world, &e));
    TEST_ASSERT_FALSE(gfx_device_render(f.device, f.world)); // and says which file
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_irradiance);
    RUN_TEST(test_reflections);
    RUN_TEST(test_white_furnace);
    RUN_TEST(test_sky_is_seen);
    return UNITY_END();
}
