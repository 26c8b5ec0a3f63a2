// Lab kernel: the shadow of a cube on the ground under a sun, against rays to the sun's disk.
#include "gfx/gfx_lab.h"
#include "gfx/gfx_lab_picture.h"

#include "core/math.h"
#include "core/memory.h"

#include <stdio.h>

enum { SIDE = 160, RAYS = 128, STEP = 2 };
static const float span = 8.0f; // m of ground across the picture, seen from above
static const core_vec3 cube = {-0.6f, 0.5f, 0.1f};

typedef struct sun {
    core_vec3 to, ray[RAYS]; // to its centre, to points of its disk
    float source;            // tangent of the disk's angular radius
} sun;

static float ground(int pixel) { return ((float)pixel + 0.5f) / SIDE * span - 0.5f * span; }

static bool meets_cube(core_vec3 p, core_vec3 d) {
    const float o[3] = {p.x - cube.x, p.y - cube.y, p.z - cube.z}, v[3] = {d.x, d.y, d.z};
    float from = 0.0f, to = 1e30f;
    for (int i = 0; i < 3; ++i) {
        float inv = 1.0f / (core_absf(v[i]) > 1e-9f ? v[i] : 1e-9f);
        float a = (-0.5f - o[i]) * inv, b = (0.5f - o[i]) * inv;
        from = CORE_MAX(from, CORE_MIN(a, b));
        to = CORE_MIN(to, CORE_MAX(a, b));
    }
    return from <= to;
}

// Part of the sun's disk that a point of the ground sees.
static float visible(const sun *s, float x, float z) {
    int lit = 0;
    for (int i = 0; i < RAYS; ++i) {
        lit += !meets_cube(core_v3(x, 0.0f, z), s->ray[i]);
    }
    return (float)lit / RAYS;
}

static sun sun_of(const core_lab_case *c) {
    float e = (float)core_lab_number(c, "elevation", 55) * CORE_PI_F / 180.0f, a = 0.3f;
    sun s = {.to = {-core_cosf(e) * core_cosf(a), core_sinf(e), -core_cosf(e) * core_sinf(a)},
             .source = (float)core_lab_number(c, "source", 0.00465)};
    core_vec3 side = core_v3_normalize(core_v3_cross(s.to, core_v3(0, 0, 1)), core_v3(1, 0, 0));
    core_vec3 up = core_v3_cross(side, s.to);
    for (int i = 0; i < RAYS; ++i) {
        float r = s.source * core_sqrtf(((float)i + 0.5f) / RAYS), turn = 2.39996323f * (float)i;
        core_vec3 off =
            core_v3_mad(core_v3_scale(side, r * core_cosf(turn)), up, r * core_sinf(turn));
        s.ray[i] = core_v3_add(s.to, off);
    }
    return s;
}

// What is all lit or all dark: there and 0.2 m round.
static bool is_all(const sun *s, float x, float z, float what) {
    return visible(s, x + 0.2f, z) == what && visible(s, x - 0.2f, z) == what &&
           visible(s, x, z + 0.2f) == what && visible(s, x, z - 0.2f) == what;
}

// Values 0..1 as a text of two hexadecimal digits each.
static void put(char *text, int at, float value) {
    static const char digits[] = "0123456789abcdef";
    int byte = (int)(CORE_CLAMP(value, 0.0f, 1.0f) * 255.0f + 0.5f);
    text[2 * at] = digits[byte >> 4];
    text[2 * at + 1] = digits[byte & 15];
}

static bool set_number(gfx_world *world, const char *name, double value) {
    char text[32];
    snprintf(text, sizeof text, "%g", value);
    return gfx_world_set(world, name, text);
}

static bool set_up(gfx_world *world, const core_lab_case *c, const sun *s) {
    gfx_instance_desc plane = {.mesh = gfx_mesh_builtin(world, "plane")};
    gfx_instance_desc box = {.mesh = gfx_mesh_builtin(world, "box")};
    core_quat still = core_quat_identity();
    gfx_instance_set_transform(world, gfx_instance_create(world, &plane), core_v3(0, 0, 0), still,
                               core_v3(40, 1, 40));
    gfx_instance_set_transform(world, gfx_instance_create(world, &box), cube, still,
                               core_v3(1, 1, 1));
    gfx_light_desc light = gfx_light_desc_default(GFX_DIRECTIONAL);
    light.direction = core_v3_scale(s->to, -1.0f);
    light.source = s->source;
    gfx_light_create(world, &light);
    gfx_camera camera = {.position = {0, 20, 0},
                         .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.5f * CORE_PI_F),
                         .virtual_far = 40.0f,
                         .ortho_height = span};
    gfx_world_set_camera(world, &camera);
    gfx_world_set_ambient(world, 0, 0, 0);
    return gfx_world_set(world, "shadows", core_lab_text(c, "method", "pcf")) &&
           set_number(world, "shadow_taps", core_lab_number(c, "taps", 32)) &&
           set_number(world, "shadow_bias", core_lab_number(c, "bias", 0)) &&
           set_number(world, "shadow_size", core_lab_number(c, "size", 1024));
}

// rms: of the visibility, over the ground. acne: part of the fully lit ground that is dark. leaks:
// part of the ground in full shadow that is lit. got, want: every second pixel of every second row,
// for judges of pictures.
static void judge(const gfx_lab_picture *p, const sun *s, core_json *out) {
    enum { COLUMNS = SIDE / STEP };
    char *got_text = core_alloc(2 * COLUMNS * COLUMNS + 1);
    char *want_text = core_alloc(2 * COLUMNS * COLUMNS + 1);
    float open = 0.0f;
    for (int i = 0; i < SIDE * SIDE; ++i) {
        open = CORE_MAX(open, p->rgba[4 * i]);
    }
    double squares = 0.0;
    uint32_t all = 0, lit = 0, dark = 0, acne = 0, leaks = 0;
    for (int i = 0; i < COLUMNS * COLUMNS; ++i) {
        int x = i % COLUMNS * STEP, y = i / COLUMNS * STEP;
        float gx = ground(x), gz = ground(y);
        put(got_text, i, 0.0f);
        put(want_text, i, 0.0f);
        if (core_absf(gx - cube.x) < 0.55f && core_absf(gz - cube.z) < 0.55f) {
            continue; // the cube hides it
        }
        float want = visible(s, gx, gz), got = p->rgba[4 * (y * SIDE + x)] / open;
        put(got_text, i, got);
        put(want_text, i, want);
        squares += (double)((got - want) * (got - want));
        all++;
        bool is_lit = want == 1.0f && is_all(s, gx, gz, 1.0f);
        bool is_dark = want == 0.0f && is_all(s, gx, gz, 0.0f);
        lit += is_lit;
        acne += is_lit && got < 0.9f;
        dark += is_dark;
        leaks += is_dark && got > 0.1f;
    }
    core_json_number(out, "rms", core_sqrt(squares / all));
    core_json_number(out, "acne", (double)acne / CORE_MAX(lit, 1u));
    core_json_number(out, "leaks", (double)leaks / CORE_MAX(dark, 1u));
    core_json_string(out, "got", got_text);
    core_json_string(out, "want", want_text);
    core_free(got_text);
    core_free(want_text);
}

static bool run_shadow(const core_lab_case *c, core_json *out) {
    gfx_lab_picture p;
    sun s = sun_of(c);
    bool ok = gfx_lab_picture_open(&p, c, SIDE, SIDE) && set_up(p.world, c, &s) &&
              gfx_lab_picture_draw(&p);
    if (ok) {
        judge(&p, &s, out);
        if (core_lab_number(c, "timed", 0) > 0) {
            core_json_number(out, "cost_ns", gfx_lab_picture_time(&p));
        }
    }
    gfx_lab_picture_close(&p);
    return ok;
}

const core_lab_kernel gfx_lab_shadow = {
    "gfx.shadow", "a cube's shadow against rays: rms of visibility, acne, leaks; CPU time",
    "method: off|pcf|soft; elevation (degrees), source (tangent), taps, bias (texels), size, timed",
    run_shadow};
