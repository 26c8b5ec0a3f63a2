// Lab kernel: a white metal ball under a procedural sky, against the integral of the sky over the
// lobe of every pixel.
#include "gfx/gfx_lab.h"
#include "gfx/gfx_lab_picture.h"

#include "core/math.h"

#include <stdio.h>

enum { SIDE = 40, SAMPLES = 4096 };

static float step(float from, float to, float x) {
    float t = CORE_CLAMP((x - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

// The green channel of sky.glsl.
static float sky(const gfx_environment *e, core_vec3 sun, core_vec3 d) {
    float up = 1.0f - CORE_MAX(d.y, 0.0f), t = 1.0f - up * up * up * up;
    float above = e->horizon[1] + t * (e->zenith[1] - e->horizon[1]);
    float side = step(-0.03f, 0.03f, d.y), to_sun = CORE_MAX(core_v3_dot(d, sun), 0.0f);
    float glow = to_sun > 0.0f ? (float)core_pow((double)to_sun, (double)e->glow_exponent) : 0.0f;
    return (1.0f - side) * e->ground[1] + side * above + e->glow[1] * glow;
}

// What a metal that reflects everything shows: the mean of the sky over the directions that visible
// facets of its GGX distribution mirror (Heitz, "Sampling the GGX distribution of visible normals",
// 2018; spherical caps, Dupuy, Benyoub 2023).
static float mirrored(const gfx_environment *e, core_vec3 n, core_vec3 v, float roughness) {
    float alpha = roughness * roughness, a2 = alpha * alpha;
    core_vec3 sun = core_v3_normalize(e->sun, core_v3(0, 1, 0));
    core_vec3 other = core_absf(n.z) < 0.9f ? core_v3(0, 0, 1) : core_v3(1, 0, 0);
    core_vec3 side = core_v3_normalize(core_v3_cross(other, n), n), up = core_v3_cross(n, side);
    core_vec3 w = {core_v3_dot(v, side), core_v3_dot(v, up), core_v3_dot(v, n)};
    core_vec3 s = core_v3_normalize(core_v3(alpha * w.x, alpha * w.y, w.z), w);
    double sum = 0.0, weight = 0.0;
    for (int i = 0; i < SAMPLES; ++i) {
        float turn = 2.39996323f * (float)i;
        float z = (1.0f - ((float)i + 0.5f) / SAMPLES) * (1.0f + s.z) - s.z;
        float r = core_sqrtf(CORE_MAX(1.0f - z * z, 0.0f));
        core_vec3 h = {alpha * (r * core_cosf(turn) + s.x), alpha * (r * core_sinf(turn) + s.y),
                       z + s.z};
        h = core_v3_normalize(h, core_v3(0, 0, 1));
        core_vec3 l = core_v3_sub(core_v3_scale(h, 2.0f * core_v3_dot(w, h)), w);
        if (l.z > 0.0f) {
            float lv = core_sqrtf(a2 + (1.0f - a2) * w.z * w.z);
            float ll = core_sqrtf(a2 + (1.0f - a2) * l.z * l.z);
            float seen = l.z * (w.z + lv) / (w.z * ll + l.z * lv);
            core_vec3 d = core_v3_mad(core_v3_mad(core_v3_scale(side, l.x), up, l.y), n, l.z);
            sum += (double)(seen * sky(e, sun, d));
            weight += (double)seen;
        }
    }
    return (float)(sum / weight);
}

static gfx_environment sunny(void) {
    gfx_environment e = gfx_environment_default();
    e.glow[0] = e.glow[1] = e.glow[2] = 4.0f;
    e.glow_exponent = 60.0f;
    return e;
}

static bool set_up(gfx_world *world, const core_lab_case *c, const gfx_environment *e) {
    gfx_material_desc m = gfx_material_desc_default();
    m.data.metallic = 1.0f;
    m.data.roughness = (float)core_lab_number(c, "roughness", 0.4);
    gfx_instance_desc ball = {.mesh = gfx_mesh_builtin(world, "sphere"),
                              .material = gfx_material_create(world, &m)};
    gfx_instance_create(world, &ball);
    gfx_camera camera = {.position = {0, 0, 3}, .virtual_far = 10.0f, .ortho_height = 1.0f};
    gfx_world_set_camera(world, &camera);
    char samples[16];
    snprintf(samples, sizeof samples, "%g", core_lab_number(c, "samples", 128));
    return gfx_world_set(world, "levels", "off") && gfx_world_set(world, "ibl_samples", samples) &&
           gfx_world_set_environment(world, e);
}

// Root mean square of the relative error inside nine tenths of the ball's radius: at its very edge
// the flat triangles of the ball would count.
static double error_of(const gfx_lab_picture *p, const core_lab_case *c, const gfx_environment *e) {
    float roughness = (float)core_lab_number(c, "roughness", 0.4);
    double squares = 0.0;
    int pixels = 0;
    for (int y = 0; y < SIDE; ++y) {
        for (int x = 0; x < SIDE; ++x) {
            float nx = (2.0f * (float)x + 1.0f) / SIDE - 1.0f;
            float ny = 1.0f - (2.0f * (float)y + 1.0f) / SIDE, r2 = nx * nx + ny * ny;
            if (r2 < 0.81f) {
                core_vec3 n = {nx, ny, core_sqrtf(1.0f - r2)};
                float want = mirrored(e, n, core_v3(0, 0, 1), roughness);
                double off = (double)(p->rgba[4 * (y * SIDE + x) + 1] / want - 1.0f);
                squares += off * off;
                pixels++;
            }
        }
    }
    return core_sqrt(squares / pixels);
}

static bool run_reflection(const core_lab_case *c, core_json *out) {
    gfx_lab_picture p;
    gfx_environment e = sunny();
    bool ok = gfx_lab_picture_open(&p, c, SIDE, SIDE) && set_up(p.world, c, &e) &&
              gfx_lab_picture_draw(&p);
    if (ok) {
        core_json_number(out, "rms", error_of(&p, c, &e));
    }
    if (ok && core_lab_number(c, "timed", 0) > 0) { // of frames that make the maps anew
        double best = 1e30;
        for (int i = 0; i < 3; ++i) {
            e.glow[0] += 0.01f;
            gfx_world_set_environment(p.world, &e);
            double ns = gfx_lab_picture_once(&p);
            best = CORE_MIN(best, ns);
        }
        core_json_number(out, "cost_ns", best);
    }
    gfx_lab_picture_close(&p);
    return ok;
}

const core_lab_kernel gfx_lab_reflection = {
    "gfx.reflection",
    "a metal ball under a sky: relative rms against integrals; CPU time of the maps",
    "samples, roughness, timed", run_reflection};
