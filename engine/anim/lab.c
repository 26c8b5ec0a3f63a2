// Lab kernels of speed: time from state to palettes, bytes of a compressed clip.
#include "anim/lab.h"

#include "anim/lab_character.h"
#include "core/rng.h"
#include "core/simd.h"

#include <string.h>

#define RATE 30.0

// ---- anim_pose ----

static void fill_world(anim_world *w, const lab_character *c, uint32_t n, bool fading,
                       bool seeking) {
    anim_skeleton skeleton = anim_skeleton_create(w, &c->skeleton);
    anim_clip first = lab_character_add(w, skeleton, c), second = lab_character_add(w, skeleton, c);
    core_rng rng = core_rng_make(1, CORE_RNG_ENGINE);
    for (uint32_t i = 0; i < n; i++) {
        anim_instance_desc desc = anim_instance_desc_default();
        desc.skeleton = skeleton;
        desc.clip = first;
        desc.time = (float)LAB_DURATION * core_rng_float(&rng);
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
    lab_character *who = lab_character_create(1);
    lab_character_clip(who, RATE, CORE_KEY_LINEAR);
    fill_world(w, who, (uint32_t)n, core_lab_number(c, "fading", 0) > 0,
               core_lab_number(c, "seeking", 0) > 0);
    step_world(w);
    core_json_number(out, "error_m", anim_world_error_max(w, 16));
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ns", core_lab_time(step_world, w, 2e8) / (n * LAB_BONES));
    }
    lab_character_destroy(who);
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
    anim_pack_sample(s->pack, s->pack->duration * core_rng_float(&s->rng), LAB_BONES, s->columns);
}

static bool run_pack(const core_lab_case *c, core_json *out) {
    double bound = core_lab_number(c, "bound_mm", 0.5) / 1000,
           rate = core_lab_number(c, "rate", 30);
    if (!(bound > 0 && bound < 1) || !(rate >= 1 && rate <= 240)) {
        return core_fail("lab kernel anim_pack: bound_mm > 0 and rate 1..240 expected, got %g, %g",
                         bound * 1000, rate);
    }
    double scale = core_lab_number(c, "scale", 1);
    if (!(scale > 0 && scale <= 1000)) {
        return core_fail("lab kernel anim_pack: scale 0..1000 expected, got %g", scale);
    }
    lab_character *who = lab_character_create((float)scale);
    lab_character_clip(who, rate, CORE_KEY_LINEAR);
    size_t size = 0;
    void *bytes =
        anim_pack_encode(&who->skeleton, &who->clip, (float)bound, ANIM_SHELL_M, 0, &size);
    anim_pack *pack = bytes ? anim_pack_decode(bytes, size, "lab") : NULL;
    if (pack) {
        double keys = 144 + (double)LAB_BONES * (8 + 44.0 * who->track[0].key_count);
        core_json_number(out, "error_mm", (double)pack->error * 1000);
        // As large as a person in the picture, 1,080 pixels for 3 m of a person's world.
        core_json_number(out, "error_px", (double)pack->error / scale * 360);
        core_json_number(out, "bytes", (double)size / (LAB_BONES * LAB_DURATION));
        core_json_number(out, "raw_bytes", keys / (LAB_BONES * LAB_DURATION));
        sampling s = {pack, core_alloc(10u * LAB_BONES * sizeof(float)),
                      core_rng_make(1, CORE_RNG_ENGINE)};
        if (core_lab_number(c, "timed", 0) > 0) {
            core_json_number(out, "cost_ns", core_lab_time(sample_once, &s, 5e7) / LAB_BONES);
        }
        core_free(s.columns);
    }
    bool good = pack != NULL;
    core_free(pack);
    core_free(bytes);
    lab_character_destroy(who);
    return good;
}

const core_lab_kernel anim_lab_pack = {
    "anim_pack", "bytes per bone and second of a compressed clip against its error at the shell",
    "bound_mm: asked for; rate: keys a second of the source; scale: of the character", run_pack};
