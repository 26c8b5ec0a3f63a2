// Lab kernels on a 67-bone character made by formula: a quarter of its bones swing widely, half a
// little, a quarter not at all, as hands and faces do in walks.
#include "anim/lab.h"

#include "anim/anim_internal.h"
#include "core/rng.h"
#include "core/simd.h"

#include <stdio.h>
#include <string.h>

#define BONES    67u
#define RATE     30.0
#define DURATION (4.0 / 3)

typedef struct character {
    char name[BONES][CORE_NAME_MAX];
    int32_t parent[BONES];
    core_vec3 translation[BONES], scale[BONES];
    core_quat rotation[BONES];
    core_mat4 inverse_bind[BONES];
    core_skeleton_data skeleton;
    core_clip_track track[BONES];
    core_clip_data clip;
    core_key *key; // [BONES * keys]
} character;

static void make_skeleton(character *c) {
    core_mat4 model[BONES];
    for (uint32_t b = 0; b < BONES; b++) {
        snprintf(c->name[b], CORE_NAME_MAX, "bone%u", b);
        c->parent[b] = b == 0 ? -1 : b % 6 == 1 ? (int32_t)(b / 12) : (int32_t)b - 1;
        c->translation[b] = core_v3(0.05f * (float)(b % 3), 0.12f, 0.02f * (float)(b % 5));
        c->rotation[b] = core_quat_axis_angle(core_v3(0, 0, 1), 0.1f * (float)(b % 7));
        c->scale[b] = core_v3(1, 1, 1);
        core_mat4 local = core_mat4_trs(c->translation[b], c->rotation[b], c->scale[b]);
        model[b] = b == 0 ? local : core_mat4_mul(&model[c->parent[b]], &local);
        core_mat4_inverse(&model[b], &c->inverse_bind[b]);
    }
    c->skeleton = (core_skeleton_data){BONES,          (const char(*)[CORE_NAME_MAX])c->name,
                                       c->parent,      c->translation,
                                       c->rotation,    c->scale,
                                       c->inverse_bind};
}

// Two harmonics a bone: feet do not swing like pendulums.
static core_quat turn_at(const character *c, uint32_t b, double u) {
    double swing = b % 4 == 0 ? 0.5 : b % 4 < 3 ? 0.08 : 0;
    double phase = 2 * CORE_PI * (u + 0.13 * b);
    double angle = swing * (core_sin(phase) + 0.25 * core_sin(3 * phase));
    core_vec3 axis = core_v3_normalize(
        core_v3((float)core_cos(b), (float)core_sin(2.0 * b), (float)core_cos(3.0 * b)),
        core_v3(1, 0, 0));
    return core_quat_mul(c->rotation[b], core_quat_axis_angle(axis, (float)angle));
}

static void make_clip(character *c, double rate, const char *name) {
    uint32_t keys = (uint32_t)(DURATION * rate + 0.5) + 1;
    c->key = core_alloc((size_t)BONES * keys * sizeof *c->key);
    for (uint32_t b = 0; b < BONES; b++) {
        core_key *key = c->key + (size_t)b * keys;
        for (uint32_t k = 0; k < keys; k++) {
            double u = (double)k / (keys - 1);
            core_vec3 t = c->translation[b];
            t.y += b == 0 ? (float)(0.03 * core_sin(4 * CORE_PI * u)) : 0;
            key[k] = (core_key){(float)(DURATION * u), t, turn_at(c, b, u), {1, 1, 1}};
        }
        c->track[b] = (core_clip_track){.bone = b, .key_count = keys, .key = key};
    }
    c->clip = (core_clip_data){
        .duration = (float)DURATION, .bone_count = BONES, .track_count = BONES, .track = c->track};
    snprintf(c->clip.name, CORE_NAME_MAX, "%s", name);
}

// ---- anim_pose ----

static anim_clip add_clip(anim_world *w, anim_skeleton skeleton, const character *c) {
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = &c->clip;
    desc.skeleton = skeleton;
    return anim_clip_create(w, &desc);
}

static void fill_world(anim_world *w, const character *c, uint32_t n, bool fading, bool seeking) {
    anim_skeleton skeleton = anim_skeleton_create(w, &c->skeleton);
    anim_clip first = add_clip(w, skeleton, c), second = add_clip(w, skeleton, c);
    core_rng rng = core_rng_make(1, CORE_RNG_ENGINE);
    for (uint32_t i = 0; i < n; i++) {
        anim_instance_desc desc = anim_instance_desc_default();
        desc.skeleton = skeleton;
        desc.clip = first;
        desc.time = (float)DURATION * core_rng_float(&rng);
        desc.speed = seeking ? 61.7f : 1; // far from frame to frame
        anim_instance instance = anim_instance_create(w, &desc);
        if (fading) {
            anim_instance_play(w, instance, second, ANIM_LOOP, 1e6f, ANIM_FADE_LINEAR);
        }
    }
}

static void step_world(void *ctx) {
    anim_world_update(ctx, 1.0f / 60);
    anim_world_pose(ctx);
}

static bool use_set(const char *name) {
    for (core_simd_set set = CORE_SIMD_SSE2; set < CORE_SIMD_SETS; set++) {
        if (strcmp(core_simd_name(set), name) == 0) {
            return core_simd_use(set);
        }
    }
    return core_fail("lab kernel anim_pose: set sse2, avx2 or avx512 expected, got '%s'", name);
}

static bool run_pose(const core_lab_case *c, core_json *out) {
    const char *batch = core_lab_text(c, "batch", "on"), *pack = core_lab_text(c, "pack", "0.0005");
    double n = core_lab_number(c, "n", 1000);
    if (!(n >= 1 && n <= 20000) || !use_set(core_lab_text(c, "set", "avx2"))) {
        return n >= 1 && n <= 20000
                   ? false
                   : core_fail("lab kernel anim_pose: n 1..20000 expected, got %g", n);
    }
    anim_world_desc desc = anim_world_desc_default();
    anim_world *w = anim_world_create(&desc);
    if (!w || !anim_world_set(w, "batch", batch) || !anim_world_set(w, "pack", pack)) {
        anim_world_destroy(w);
        return false;
    }
    character *who = core_alloc(sizeof *who);
    make_skeleton(who);
    make_clip(who, RATE, "walk");
    fill_world(w, who, (uint32_t)n, core_lab_number(c, "fading", 0) > 0,
               core_lab_number(c, "seeking", 0) > 0);
    step_world(w);
    core_json_number(out, "error_m", anim_world_error_max(w, 16));
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ns", core_lab_time(step_world, w, 2e8) / (n * BONES));
    }
    core_free(who->key);
    core_free(who);
    anim_world_destroy(w);
    return true;
}

const core_lab_kernel anim_lab_pose = {
    "anim_pose", "state to skinning palettes of n characters of 67 bones against double precision",
    "batch: on|off; pack: metres, 0 = keys; set: sse2|avx2|avx512; n; fading: 0|1; seeking: 0|1",
    run_pose};

// ---- anim_pack ----

typedef struct sampling {
    const anim_pack *pack;
    float *columns;
    core_rng rng;
} sampling;

static void sample_once(void *ctx) {
    sampling *s = ctx;
    anim_pack_sample(s->pack, s->pack->duration * core_rng_float(&s->rng), BONES, s->columns);
}

static bool run_pack(const core_lab_case *c, core_json *out) {
    double bound = core_lab_number(c, "bound_mm", 0.5) / 1000,
           rate = core_lab_number(c, "rate", 30);
    if (!(bound > 0 && bound < 1) || !(rate >= 1 && rate <= 240)) {
        return core_fail("lab kernel anim_pack: bound_mm > 0 and rate 1..240 expected, got %g, %g",
                         bound * 1000, rate);
    }
    character *who = core_alloc(sizeof *who);
    make_skeleton(who);
    make_clip(who, rate, "walk");
    size_t size = 0;
    void *bytes =
        anim_pack_encode(&who->skeleton, &who->clip, (float)bound, ANIM_SHELL_M, 0, &size);
    anim_pack *pack = bytes ? anim_pack_decode(bytes, size, "lab") : NULL;
    if (pack) {
        double keys = 144 + (double)BONES * (8 + 44.0 * who->track[0].key_count);
        core_json_number(out, "error_mm", (double)pack->error * 1000);
        core_json_number(out, "bytes", (double)size / (BONES * DURATION));
        core_json_number(out, "raw_bytes", keys / (BONES * DURATION));
        sampling s = {pack, core_alloc(10u * BONES * sizeof(float)),
                      core_rng_make(1, CORE_RNG_ENGINE)};
        if (core_lab_number(c, "timed", 0) > 0) {
            core_json_number(out, "cost_ns", core_lab_time(sample_once, &s, 5e7) / BONES);
        }
        core_free(s.columns);
    }
    bool good = pack != NULL;
    core_free(pack);
    core_free(bytes);
    core_free(who->key);
    core_free(who);
    return good;
}

const core_lab_kernel anim_lab_pack = {
    "anim_pack", "bytes per bone and second of a compressed clip against its error at the shell",
    "bound_mm: asked for; rate: keys a second of the source", run_pack};
