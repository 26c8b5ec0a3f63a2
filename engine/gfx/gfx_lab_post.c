// Lab kernel: passes over the picture against closed forms, and what a frame with them costs.
#include "gfx/gfx_lab.h"

#include "core/clock.h"
#include "gfx/gfx_device_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 240 };

typedef struct bench {
    core_vfs *vfs;
    gfx_device *device;
    gfx_world *world;
    bool ok;
} bench;

static void close_bench(bench *b) {
    gfx_world_destroy(b->world);
    gfx_device_destroy(b->device);
    core_vfs_destroy(b->vfs);
}

// Settings that a case may give, as text or number.
static bool apply(const core_lab_case *c, gfx_world *world) {
    static const char *const names[] = {"ao",           "ao_radius", "ao_slices",
                                        "ao_steps",     "bloom",     "bloom_levels",
                                        "bloom_spread", "msaa",      "fxaa"};
    bool ok = true;
    for (size_t i = 0; i < CORE_COUNT_OF(names) && ok; ++i) {
        char number[32];
        const char *text = core_lab_text(c, names[i], NULL);
        double value = core_lab_number(c, names[i], -1.0);
        if (!text && value >= 0.0) {
            snprintf(number, sizeof number, "%.9g", value);
            text = number;
        }
        ok = !text || gfx_world_set(world, names[i], text);
    }
    return ok;
}

static bench open_bench(const core_lab_case *c) {
    bench b = {.vfs = core_vfs_create()};
    gfx_device_desc desc = gfx_device_desc_default();
    desc.width = WIDTH, desc.height = HEIGHT;
    desc.vfs = b.vfs;
    desc.float_target = true;
    if (core_vfs_mount(b.vfs, core_lab_text(c, "assets", "assets"), "", false)) {
        gfx_world_desc world = gfx_world_desc_default();
        b.device = gfx_device_create(&desc);
        b.world = b.device ? gfx_world_create(&world) : NULL;
    }
    b.ok = b.world && apply(c, b.world);
    if (b.ok) {
        gfx_world_set_background(b.world, 0.0f, 0.0f, 0.0f);
        gfx_world_set_ambient(b.world, 0.0f, 0.0f, 0.0f);
    }
    return b;
}

static void add_box(gfx_world *world, core_vec3 at, core_quat turn, core_vec3 size, float glow) {
    gfx_material_desc m = gfx_material_desc_default();
    m.data.roughness = 1.0f;
    for (int i = 0; i < 3 && glow > 0.0f; ++i) {
        m.data.base_color[i] = 0.0f;
        m.data.emissive[i] = glow;
    }
    gfx_instance_desc d = {.mesh = gfx_mesh_builtin(world, "box"),
                           .material = gfx_material_create(world, &m)};
    gfx_instance_set_transform(world, gfx_instance_create(world, &d), at, turn, size);
}

// A pixel a metre, from the front.
static void look_flat(gfx_world *world) {
    gfx_camera c = {
        .position = {0, 0, 50}, .rotation = core_quat_identity(), .ortho_height = HEIGHT};
    gfx_world_set_camera(world, &c);
}

static float *read_pass(bench *b, const char *pass) {
    uint32_t w, h;
    float *rgba = NULL;
    b->ok = b->ok && gfx_device_render(b->device, b->world) &&
            gfx_device_read_pass(b->device, pass, NULL, &w, &h);
    if (b->ok) {
        rgba = core_alloc((size_t)w * h * 16);
        b->ok = gfx_device_read_pass(b->device, pass, rgba, &w, &h);
    }
    return rgba;
}

// ---- ambient occlusion ----

// A floor before a wall that has no end, from above. A floor point at distance d sees the wall in
// directions with cosine s = d / radius or more to its normal: a segment of Nusselt's disc.
static double corner_error(const core_lab_case *c, bench *b) {
    double radius = core_lab_number(c, "ao_radius", 0.5), sum = 0.0;
    const core_quat flat = core_quat_identity();
    add_box(b->world, core_v3(0, -0.5f, 0), flat, core_v3(60, 1, 60), 0);
    add_box(b->world, core_v3(0, 0, -10.5f), flat, core_v3(60, 60, 1), 0);
    gfx_camera camera = {.position = {0, 3, -6},
                         .rotation = core_quat_axis_angle(core_v3(1, 0, 0), -0.6f)};
    gfx_world_set_camera(b->world, &camera);
    float *ao = read_pass(b, "ao");
    int count = 0;
    for (int y = 0; y < HEIGHT && b->ok; ++y) {
        float up = (1.0f - 2.0f * ((float)y + 0.5f) / HEIGHT) * 0.57735027f;
        core_vec3 d = core_quat_rotate(camera.rotation, core_v3(0, up, -1));
        double from_wall = d.y < 0 ? (double)(4.0f - 3.0f * d.z / d.y) : -1.0;
        if (from_wall > 0.02 && from_wall < 2.0 * radius) {
            double s = fmin(from_wall / radius, 1.0);
            double want = 1.0 - (acos(s) - s * sqrt(1.0 - s * s)) / 3.14159265358979;
            double off = (double)ao[4 * (y * WIDTH + WIDTH / 2)] - want;
            sum += off * off, count++;
        }
    }
    core_free(ao);
    return sqrt(sum / CORE_MAX(count, 1));
}

// A thin strip of 0.2 m, `gap` metres before a wall: what the pass takes from the wall beside it
// beyond what the strip does, (sin b - sin a) / 2 between the angles at which it is seen. The depth
// buffer has no backs: the pass takes it for a block.
static double leak(const core_lab_case *c, bench *b) {
    float gap = (float)core_lab_number(c, "gap", 0.3);
    const core_quat flat = core_quat_identity();
    add_box(b->world, core_v3(0, 0, -10.5f), flat, core_v3(80, 80, 1), 0);
    add_box(b->world, core_v3(0, 0, -10 + gap), flat, core_v3(0.2f, 80, 0.01f), 0);
    gfx_camera camera = {.rotation = core_quat_identity()};
    gfx_world_set_camera(b->world, &camera);
    float *ao = read_pass(b, "ao"), *depth = read_pass(b, "depth");
    double worst = 0.0;
    for (int i = 0; i < WIDTH && b->ok; ++i) {
        int at = 4 * (HEIGHT / 2 * WIDTH + i);
        double x = (2.0 * (i + 0.5) / WIDTH - 1.0) * 0.57735027 * WIDTH / HEIGHT * 10.0;
        double near = fabs(x) - 0.1, far = fabs(x) + 0.1, g = (double)gap;
        double hidden = 0.5 * (far / sqrt(far * far + g * g) - near / sqrt(near * near + g * g));
        if (depth[at] < 0.1f / 9.999f) { // the wall: near plane over distance
            worst = fmax(worst, 1.0 - hidden - (double)ao[at]);
        }
    }
    core_free(ao);
    core_free(depth);
    return worst;
}

// ---- edges ----

// A square turned by `angle` degrees: its share of each pixel by 32 x 32 points.
static double edge_error(const core_lab_case *c, bench *b) {
    enum { POINTS = 32, SIDE = 130 };
    double angle = core_lab_number(c, "angle", 17) * 3.14159265358979 / 180.0, sum = 0.0;
    double cosine = cos(angle), sine = sin(angle);
    add_box(b->world, core_v3(0, 0, 0), core_quat_axis_angle(core_v3(0, 0, 1), (float)angle),
            core_v3(SIDE, SIDE, 1), 1.0f);
    look_flat(b->world);
    gfx_world_set(b->world, "tonemap", "linear");
    float *got = read_pass(b, "picture");
    int count = 0;
    for (int i = 0; i < WIDTH * HEIGHT && b->ok; ++i) {
        int in = 0;
        for (int k = 0; k < POINTS * POINTS; ++k) {
            double x = i % WIDTH + (k % POINTS + 0.5) / POINTS - WIDTH / 2.0;
            double y = HEIGHT / 2.0 - i / WIDTH - (k / POINTS + 0.5) / POINTS;
            in += fabs(cosine * x + sine * y) < SIDE / 2.0 &&
                  fabs(cosine * y - sine * x) < SIDE / 2.0;
        }
        if (in > 0 && in < POINTS * POINTS) {
            double e = (double)got[4 * i]; // encoded; a share of light is linear
            double light = e <= 0.04045 ? e / 12.92 : core_pow((e + 0.055) / 1.055, 2.4);
            double off = light - (double)in / (POINTS * POINTS);
            sum += off * off, count++;
        }
    }
    core_free(got);
    return sqrt(sum / CORE_MAX(count, 1));
}

// ---- bloom ----

// How far the light of a lamp of 6 pixels spreads: rms distance from it.
static double glow_reach(bench *b) {
    add_box(b->world, core_v3(0, 0, 0), core_quat_identity(), core_v3(6, 6, 1), 100.0f);
    look_flat(b->world);
    float *bloom = read_pass(b, "bloom");
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < WIDTH / 2 * (HEIGHT / 2) && b->ok; ++i) {
        double x = i % (WIDTH / 2) + 0.5 - WIDTH / 4.0, y = i / (WIDTH / 2) + 0.5 - HEIGHT / 4.0;
        sum += (double)bloom[4 * i];
        squares += (double)bloom[4 * i] * (x * x + y * y) * 4.0;
    }
    core_free(bloom);
    return sqrt(squares / (sum > 0.0 ? sum : 1.0));
}

// ---- the kernel ----

static void draw(void *ctx) {
    bench *b = ctx;
    b->ok = gfx_device_render(b->device, b->world) && b->ok;
    glFinish();
}

static bool run_post(const core_lab_case *c, core_json *out) {
    const char *what = core_lab_text(c, "what", "corner");
    bench b = open_bench(c);
    if (b.ok && strcmp(what, "corner") == 0) {
        core_json_number(out, "rms", corner_error(c, &b));
    } else if (b.ok && strcmp(what, "leak") == 0) {
        core_json_number(out, "leak", leak(c, &b));
    } else if (b.ok && strcmp(what, "edge") == 0) {
        core_json_number(out, "rms", edge_error(c, &b));
    } else if (b.ok && strcmp(what, "glow") == 0) {
        core_json_number(out, "reach_px", glow_reach(&b));
    } else if (b.ok) {
        b.ok = core_fail("lab kernel gfx.post: what is corner, leak, edge or glow");
    }
    if (b.ok && core_lab_number(c, "timed", 0) > 0) {
        double best = 1e30;
        for (int i = 0; i < 5; ++i) {
            uint64_t start = core_clock_cpu_ns();
            draw(&b);
            best = fmin(best, (double)(core_clock_cpu_ns() - start));
        }
        core_json_number(out, "cost_ns", best);
    }
    close_bench(&b);
    return b.ok;
}

const core_lab_kernel gfx_lab_post = {
    "gfx.post",
    "passes over the picture against closed forms: rms, leak, reach; CPU time of a frame",
    "what: corner|leak|edge|glow; gap, angle; settings ao.., bloom.., msaa, fxaa; assets, timed",
    run_post};
