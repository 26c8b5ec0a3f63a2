// Lab kernels of what is drawn: terrain by error and triangles, particles by number.
#include "core/clock.h"
#include "core/rng.h"
#include "gfx/gfx_device_internal.h"
#include "gfx/gfx_lab.h"
#include "gfx/gfx_particles.h"

#include <stdio.h>
#include <string.h>

typedef struct stage {
    core_vfs *vfs;
    gfx_device *device;
    gfx_world *world;
    bool ok;
} stage;

static stage open_stage(const core_lab_case *c, uint32_t width, uint32_t height) {
    stage s = {.vfs = core_vfs_create()};
    gfx_device_desc desc = gfx_device_desc_default();
    gfx_world_desc world = gfx_world_desc_default();
    desc.width = width, desc.height = height, desc.vfs = s.vfs;
    s.ok = core_vfs_mount(s.vfs, core_lab_text(c, "assets", "assets"), "", false);
    s.device = s.ok ? gfx_device_create(&desc) : NULL;
    s.world = s.device ? gfx_world_create(&world) : NULL;
    s.ok = s.world && gfx_world_set(s.world, "shadows", "off");
    return s;
}

static void close_stage(stage *s) {
    gfx_world_destroy(s->world);
    gfx_device_destroy(s->device);
    core_vfs_destroy(s->vfs);
}

static void draw(void *ctx) {
    stage *s = ctx;
    s->ok = gfx_device_render(s->device, s->world) && s->ok;
    glFinish();
}

static double best_cpu_ns(core_lab_body *body, void *ctx, int runs) {
    double best = 0;
    for (int i = 0; i < runs; ++i) {
        uint64_t start = core_clock_cpu_ns();
        body(ctx);
        double ns = (double)(core_clock_cpu_ns() - start);
        best = i == 0 || ns < best ? ns : best;
    }
    return best;
}

// ---- terrain ----

enum { POINTS = 513, WIDTH = 320, HEIGHT = 180 };
static const float STEP = 2.0f, NEAR = 0.5f;

static float lattice(int x, int z) {
    uint64_t at = (uint64_t)(x & 4095) << 12 | (uint64_t)(z & 4095);
    return (float)(core_rng_at(7, CORE_RNG_ENGINE, at) >> 40) * 0x1p-24f;
}

static float noise(float x, float z) {
    int i = (int)x, k = (int)z;
    float u = x - (float)i, v = z - (float)k;
    u = u * u * (3.0f - 2.0f * u), v = v * v * (3.0f - 2.0f * v);
    float a = lattice(i, k) + (lattice(i + 1, k) - lattice(i, k)) * u;
    float b = lattice(i, k + 1) + (lattice(i + 1, k + 1) - lattice(i, k + 1)) * u;
    return a + (b - a) * v;
}

static void fill_heights(float *out) {
    for (int z = 0; z < POINTS; ++z) {
        for (int x = 0; x < POINTS; ++x) {
            float y = 0.0f, size = 128.0f, weight = 70.0f;
            for (int octave = 0; octave < 7; ++octave, size *= 0.5f, weight *= 0.43f) {
                y += weight * noise((float)x / size, (float)z / size);
            }
            out[z * POINTS + x] = y;
        }
    }
}

// Every `skip`-th point of the field alone: what an engine without levels would draw to save.
static gfx_terrain add_ground(gfx_world *world, const float *height, uint32_t skip) {
    uint32_t n = (POINTS - 1) / skip + 1;
    float *some = core_alloc((size_t)n * n * sizeof *some), step = STEP * (float)skip;
    float corner = -0.5f * STEP * (POINTS - 1);
    for (uint32_t i = 0; i < n * n; ++i) {
        some[i] = height[(size_t)(i / n) * skip * POINTS + (size_t)(i % n) * skip];
    }
    gfx_terrain_desc d = gfx_terrain_desc_default();
    d.heights = (core_heights_data){n, n, step, step, {corner, 0.0f, corner}, some};
    gfx_terrain terrain = gfx_terrain_create(world, &d);
    core_free(some);
    return terrain;
}

// Pixels that each pixel of the picture is off the field.
static void pixels_off(stage *s, gfx_world *truth, gfx_terrain field, float *depth, float *off) {
    gfx_camera c = gfx_world_camera(s->world);
    core_vec3 ahead = core_quat_rotate(c.rotation, core_v3(0.0f, 0.0f, -1.0f));
    s->ok = s->ok && gfx_device_read_depth(s->device, depth);
    for (int i = 0; i < WIDTH * HEIGHT && s->ok; ++i) {
        core_vec3 from, along;
        float y;
        gfx_camera_ray(&c, WIDTH, HEIGHT, (float)(i % WIDTH) + 0.5f, (float)(i / WIDTH) + 0.5f,
                       &from, &along);
        core_vec3 p = core_v3_mad(from, along, NEAR / depth[i] / core_v3_dot(along, ahead));
        off[i] = 0.0f;
        if (depth[i] > 0.0f && gfx_terrain_height(truth, field, p.x, p.z, &y)) {
            core_vec3 a = gfx_camera_project(&c, WIDTH, HEIGHT, p);
            core_vec3 b = gfx_camera_project(&c, WIDTH, HEIGHT, core_v3(p.x, y, p.z));
            float dx = a.x - b.x, dy = a.y - b.y;
            off[i] = core_sqrtf(dx * dx + dy * dy);
        }
    }
}

// Whether the pixels around show one slope: those on an outline see another one in the next frame.
static bool on_slope(const float *depth, int i) {
    const int around[4] = {1, -1, WIDTH, -WIDTH};
    for (int k = 0; k < 4; ++k) {
        int j = i + around[k];
        float other = j >= 0 && j < WIDTH * HEIGHT ? depth[j] : 0.0f;
        if (core_absf(other - depth[i]) > 0.1f * depth[i]) {
            return false;
        }
    }
    return true;
}

typedef struct terrain_figures {
    double off, jump; // most pixels: off the field; from frame to frame
} terrain_figures;

// Some frames of an eye that goes ahead, so far above the ground.
static terrain_figures fly(stage *s, gfx_world *truth, gfx_terrain field, float above, int frames) {
    float *depth = core_alloc(WIDTH * HEIGHT * sizeof *depth), y = 0.0f;
    float *off[2] = {core_alloc(WIDTH * HEIGHT * sizeof(float)),
                     core_alloc(WIDTH * HEIGHT * sizeof(float))};
    terrain_figures worst = {0};
    gfx_terrain_height(truth, field, 0.0f, 320.0f, &y);
    for (int k = 0; k < frames && s->ok; ++k) {
        gfx_camera camera = {.position = {0.0f, y + above, 320.0f - 0.05f * (float)k},
                             .rotation = core_quat_axis_angle(core_v3(1.0f, 0.0f, 0.0f), -0.16f),
                             .near_plane = NEAR,
                             .virtual_far = 2000.0f};
        gfx_world_set_camera(s->world, &camera);
        draw(s);
        pixels_off(s, truth, field, depth, off[k & 1]);
        for (int i = 0; i < WIDTH * HEIGHT; ++i) {
            double jump = (double)core_absf(off[k & 1][i] - off[~k & 1][i]);
            worst.off = CORE_MAX(worst.off, (double)off[k & 1][i]);
            worst.jump = k && on_slope(depth, i) ? CORE_MAX(worst.jump, jump) : worst.jump;
        }
    }
    core_free(depth);
    core_free(off[0]);
    core_free(off[1]);
    return worst;
}

static bool run_terrain(const core_lab_case *c, core_json *out) {
    stage s = open_stage(c, WIDTH, HEIGHT);
    gfx_world_desc plain = gfx_world_desc_default();
    gfx_world *truth = gfx_world_create(&plain);
    float *height = core_alloc((size_t)POINTS * POINTS * sizeof *height);
    char text[32];
    fill_heights(height);
    gfx_terrain field = add_ground(truth, height, 1);
    bool points = strcmp(core_lab_text(c, "method", "levels"), "points") == 0;
    uint32_t coarse = (uint32_t)CORE_CLAMP(core_lab_number(c, "coarse", 3), 0.0, 5.0);
    double pixels = points ? 0.0 : 0.125 * (double)(1u << coarse);
    snprintf(text, sizeof text, "%g", pixels);
    if (s.ok && gfx_world_set(s.world, "terrain_error", text)) {
        add_ground(s.world, height, points ? 2u << coarse : 1u);
        terrain_figures f = fly(&s, truth, field, (float)core_lab_number(c, "above", 25),
                                (int)core_lab_number(c, "frames", 1));
        core_json_number(out, "off_pixels", f.off);
        core_json_number(out, "jump_pixels", f.jump);
        core_json_number(out, "share", points ? 0.0 : f.off / pixels);
        core_json_int(out, "triangles", s.world->stats.triangles);
        if (core_lab_number(c, "timed", 0) > 0) {
            core_json_number(out, "cost_ns", best_cpu_ns(draw, &s, 7));
        }
    }
    core_free(height);
    gfx_world_destroy(truth);
    close_stage(&s);
    return s.ok;
}

const core_lab_kernel gfx_lab_terrain = {
    "gfx.terrain", "terrain: pixels off the field and from frame to frame, triangles, CPU time",
    "method: levels|points; coarse: 2^n eighths of a pixel asked for, or every 2^(n+1)-th point; "
    "above: "
    "the eye over the ground, m; frames, assets, timed",
    run_terrain};

// ---- particles ----

typedef struct swarm {
    gfx_world *world;
    gfx_emitter emitter;
    uint32_t alive;
} swarm;

static void step_swarm(void *ctx) {
    swarm *s = ctx;
    gfx_world_step(s->world, 1.0f / 60.0f);
}

static void evaluate_swarm(void *ctx) {
    swarm *s = ctx;
    s->alive = gfx_emitter_particles(s->world, s->emitter, NULL, 0);
}

static bool run_particles(const core_lab_case *c, core_json *out) {
    stage s = open_stage(c, WIDTH, HEIGHT);
    gfx_emitter_desc d = gfx_emitter_desc_default();
    float n = (float)core_lab_number(c, "n", 10000);
    d.life[0] = d.life[1] = 2.0f;
    d.rate = n / 2.0f;
    d.speed[0] = 2.0f, d.speed[1] = 6.0f;
    d.spread = 0.6f, d.drag = 0.5f;
    d.acceleration = core_v3(0.0f, -3.0f, 0.0f);
    d.size[0] = 0.04f;
    d.additive = strcmp(core_lab_text(c, "blend", "add"), "add") == 0;
    if (s.ok) {
        swarm all = {.world = s.world, .emitter = gfx_emitter_create(s.world, &d)};
        gfx_camera camera = {.position = {0.0f, 2.0f, 12.0f}};
        gfx_world_set_camera(s.world, &camera);
        for (int i = 0; i < 130; ++i) {
            step_swarm(&all);
        }
        evaluate_swarm(&all);
        draw(&s);
        core_json_int(out, "alive", all.alive);
        core_json_int(out, "draws", s.world->stats.draws);
        if (core_lab_number(c, "timed", 0) > 0) {
            core_json_number(out, "evaluate_ns", best_cpu_ns(evaluate_swarm, &all, 15));
            core_json_number(out, "frame_ns", best_cpu_ns(draw, &s, 7));
            core_json_number(out, "step_ns", best_cpu_ns(step_swarm, &all, 15));
        }
    }
    close_stage(&s);
    return s.ok;
}

const core_lab_kernel gfx_lab_particles = {
    "gfx.particles", "particles: CPU time of a step, of their places, of a frame; draws",
    "n: alive at once; blend: add|cover; assets, timed", run_particles};
