// Lab kernels of error: keys against the motion they are taken from, level of detail against
// pixels, fades against the step.
#include "anim/lab.h"
#include "anim/lab_character.h"

#include <math.h>
#include <string.h>

#define POINTS (2 * LAB_BONES) // each joint, and a point of the skin ANIM_SHELL_M beside it

typedef struct points {
    core_vec3 at[POINTS];
} points;
typedef struct pose_block {
    core_vec3 translation[LAB_BONES], scale[LAB_BONES];
    core_quat rotation[LAB_BONES];
} pose_block;

static anim_pose view_of(pose_block *p) {
    return (anim_pose){.translation = p->translation, .rotation = p->rotation, .scale = p->scale};
}

static void to_points(const lab_character *c, const pose_block *p, points *out) {
    core_mat4 model[LAB_BONES];
    for (uint32_t b = 0; b < LAB_BONES; b++) {
        core_mat4 local = core_mat4_trs(p->translation[b], p->rotation[b], p->scale[b]);
        model[b] = c->parent[b] < 0 ? local : core_mat4_mul(&model[c->parent[b]], &local);
        const float *m = model[b].m;
        out->at[2 * b] = core_v3(m[12], m[13], m[14]);
        out->at[2 * b + 1] = core_v3_mad(out->at[2 * b], core_v3(m[0], m[1], m[2]), ANIM_SHELL_M);
    }
}

static void exact_points(const lab_character *c, double u, points *out) {
    pose_block p;
    for (uint32_t b = 0; b < LAB_BONES; b++) {
        core_key k = lab_character_key(c, b, u);
        p.translation[b] = k.translation;
        p.rotation[b] = k.rotation;
        p.scale[b] = k.scale;
    }
    to_points(c, &p, out);
}

static double farthest(const points *a, const points *b) {
    double worst = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        worst = CORE_MAX(worst, (double)core_v3_length(core_v3_sub(a->at[i], b->at[i])));
    }
    return worst;
}

// How much farther a point jumps from frame to frame than it should.
static double jump(const points *was, const points *now, const points *was_exact,
                   const points *now_exact) {
    double worst = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        core_vec3 shown = core_v3_sub(now->at[i], was->at[i]);
        core_vec3 exact = core_v3_sub(now_exact->at[i], was_exact->at[i]);
        worst = CORE_MAX(worst, (double)core_v3_length(core_v3_sub(shown, exact)));
    }
    return worst;
}

typedef struct stage {
    lab_character *who;
    anim_world *world;
    anim_skeleton skeleton;
    anim_clip clip;
} stage;

static bool open_stage(stage *s, double rate, core_key_mode mode) {
    anim_world_desc desc = anim_world_desc_default();
    s->who = lab_character_create(1);
    s->world = anim_world_create(&desc);
    lab_character_clip(s->who, rate, mode);
    s->skeleton = anim_skeleton_create(s->world, &s->who->skeleton);
    s->clip = lab_character_add(s->world, s->skeleton, s->who);
    return !core_handle_is_null(s->clip);
}

static void close_stage(stage *s) {
    anim_world_destroy(s->world);
    lab_character_destroy(s->who);
}

// ---- anim_keys ----

static bool mode_of(const char *name, core_key_mode *out) {
    static const char *const names[] = {"linear", "step", "cubic"}; // as core_key_mode
    for (size_t i = 0; i < CORE_COUNT_OF(names); i++) {
        if (strcmp(name, names[i]) == 0) {
            *out = (core_key_mode)i;
            return true;
        }
    }
    return core_fail("lab kernel anim_keys: mode linear, step or cubic expected, got '%s'", name);
}

static bool run_keys(const core_lab_case *c, core_json *out) {
    double rate = core_lab_number(c, "rate", 30), speed = core_lab_number(c, "speed", 1);
    core_key_mode mode = CORE_KEY_LINEAR;
    if (!mode_of(core_lab_text(c, "mode", "linear"), &mode)) {
        return false;
    }
    if (!(rate >= 1 && rate <= 480) || !(speed > 0 && speed <= 100)) {
        return core_fail("lab kernel anim_keys: rate 1..480 and speed 0..100 expected");
    }
    stage s;
    bool good = open_stage(&s, rate, mode);
    double error = 0, pop = 0, step = speed / 60 / LAB_DURATION;
    points now, was = {0}, now_exact, was_exact = {0};
    int frames = (int)CORE_CLAMP(1 / step, 40.0, 2000.0);
    for (int i = 0; good && i < frames; i++) {
        pose_block p;
        double u = fmod(0.0037 + i * step, 1);
        good = anim_clip_sample(s.world, s.clip, (float)(u * LAB_DURATION), view_of(&p));
        to_points(s.who, &p, &now);
        exact_points(s.who, u, &now_exact);
        error = CORE_MAX(error, farthest(&now, &now_exact));
        pop = i == 0 ? 0 : CORE_MAX(pop, jump(&was, &now, &was_exact, &now_exact));
        was = now;
        was_exact = now_exact;
    }
    core_json_number(out, "error_mm", error * 1000);
    core_json_number(out, "pop_mm", pop * 1000);
    core_json_number(out, "bytes", 44.0 * s.who->track[0].key_count / LAB_DURATION);
    close_stage(&s);
    return good;
}

const core_lab_kernel anim_lab_keys = {
    "anim_keys",
    "keys of a motion against the motion itself: distance at the shell, jumps of frames",
    "rate: keys a second; mode: linear|step|cubic; speed: of playing", run_keys};

// ---- anim_lod ----

typedef struct crowd {
    anim_world *world;
} crowd;

static void step_crowd(void *ctx) {
    crowd *c = ctx;
    anim_world_update(c->world, 1.0f / 60);
    anim_world_pose(c->world);
}

static bool run_lod(const core_lab_case *c, core_json *out) {
    double distance = core_lab_number(c, "distance", 10), pixels = core_lab_number(c, "pixels", 0);
    double every = core_lab_number(c, "every", 1), speed = core_lab_number(c, "speed", 1);
    if (!(distance > 0.1) || !(pixels >= 0) || !(every >= 1 && every <= 64)) {
        return core_fail("lab kernel anim_lod: distance > 0.1, pixels >= 0, every 1..64 expected");
    }
    enum { COUNT = 64, STEPS = 120 };
    stage s;
    bool good = open_stage(&s, 30, CORE_KEY_LINEAR);
    double metre = 1080 / (2 * distance * core_tan(CORE_PI / 6)); // pixels, 60 degrees
    for (uint32_t i = 0; good && i < COUNT; i++) {
        anim_instance_desc desc = anim_instance_desc_default();
        desc.skeleton = s.skeleton;
        desc.clip = s.clip;
        desc.time = (float)(LAB_DURATION * i / COUNT);
        desc.speed = (float)speed;
        anim_instance h = anim_instance_create(s.world, &desc);
        good = anim_instance_set_rate(s.world, h, (uint32_t)every) &&
               anim_instance_set_tolerance(s.world, h, (float)(pixels / metre));
    }
    crowd all = {s.world};
    double worst = 0, posed = 0;
    for (int i = 0; good && i < STEPS; i++) {
        step_crowd(&all);
        posed += i >= STEPS / 2 ? anim_world_posed(s.world) : 0;
        double error = i >= STEPS / 2 ? anim_world_error_max(s.world, 16) : 0;
        worst = CORE_MAX(worst, error);
    }
    core_json_number(out, "error_px", worst * metre);
    core_json_number(out, "posed", posed / (COUNT * (STEPS - STEPS / 2)));
    if (good && core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ns",
                         core_lab_time(step_crowd, &all, 1e8) / (COUNT * LAB_BONES));
    }
    close_stage(&s);
    return good;
}

const core_lab_kernel anim_lab_lod = {
    "anim_lod", "palettes that are behind their pose: pixels of a picture 1,080 high, share posed",
    "distance: m; every: posed each n-th step; pixels: tolerance, 0 none; speed", run_lod};

// ---- anim_fade ----

static bool run_fade(const core_lab_case *c, core_json *out) {
    double dt = core_lab_number(c, "dt", 1.0 / 60), length = core_lab_number(c, "length", 0.2);
    if (!(dt > 0 && dt <= 1) || !(length >= 0 && length <= 60)) {
        return core_fail("lab kernel anim_fade: dt 0..1 and length 0..60 expected");
    }
    stage s;
    bool good = open_stage(&s, 60, CORE_KEY_LINEAR);
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = s.skeleton;
    desc.clip = s.clip;
    anim_instance h = anim_instance_create(s.world, &desc);
    anim_clip other = lab_character_add(s.world, s.skeleton, s.who);
    points now, was = {0}, still = {0};
    double pop = 0, own = 0; // most that a point moves in a frame before the fade
    int start = (int)CORE_CLAMP(1.4 * LAB_DURATION / dt, 4.0, 20000.0);
    int frames = start + (int)CORE_CLAMP((0.5 + length) / dt, 4.0, 20000.0);
    for (int i = 0; good && i < frames; i++) {
        pose_block p;
        if (i == start) { // to the same motion from its beginning
            anim_instance_play(s.world, h, other, ANIM_LOOP, (float)length, ANIM_FADE_SMOOTH);
        }
        good = anim_world_update(s.world, (float)dt) && anim_instance_pose(s.world, h, view_of(&p));
        to_points(s.who, &p, &now);
        double moved = i > 0 ? jump(&was, &now, &still, &still) : 0;
        own = i < start ? CORE_MAX(own, moved) : own;
        pop = i < start ? 0 : CORE_MAX(pop, moved - own);
        was = now;
    }
    core_json_number(out, "pop_mm", CORE_MAX(pop, 0.0) * 1000);
    close_stage(&s);
    return good;
}

const core_lab_kernel anim_lab_fade = {"anim_fade",
                                       "a cross-fade by steps: jumps beyond the motion's own",
                                       "dt: s; length: of the fade, s", run_fade};
