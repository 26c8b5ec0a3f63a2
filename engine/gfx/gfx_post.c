// Passes over the whole picture: ambient occlusion, bloom, exposure, tone map, anti-aliasing.
#include "gfx/gfx_device_internal.h"

bool gfx_post_fill(gfx_device *d, const char *fragment, uint32_t features) {
    GLuint program = gfx_shaders_get(&d->shaders, "fullscreen.vert", fragment, features);
    if (!program) {
        return false;
    }
    d->passes++;
    glUseProgram(program);
    glBindVertexArray(d->empty_vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return true;
}

void gfx_post_begin(gfx_device *d, const gfx_target *target) {
    (void)d;
    glBindFramebuffer(GL_FRAMEBUFFER, target->name);
    glViewport(0, 0, (GLsizei)target->width, (GLsizei)target->height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
}

bool gfx_post_ambient(gfx_device *d, const gfx_world *world, gfx_targets *t) {
    (void)world;
    glBindTextureUnit(GFX_TEX_DEPTH, t->depth);
    gfx_post_begin(d, &t->ao);
    if (!gfx_post_fill(d, "ao.frag", 0)) {
        return false;
    }
    glBindTextureUnit(GFX_TEX_AO, t->ao.texture);
    gfx_post_begin(d, &t->ao_smooth);
    if (!gfx_post_fill(d, "ao_smooth.frag", 0)) {
        return false;
    }
    glBindTextureUnit(GFX_TEX_AO, t->ao_smooth.texture);
    return true;
}

// Down: each level is half the one before. Up again: each takes its share of the wider one below,
// mixed in place; shares of a mix sum to one.
static bool bloom(gfx_device *d, const gfx_world *world, gfx_targets *t) {
    uint32_t levels = 0;
    bool ok = true;
    gfx_pass_begin(d, "bloom");
    for (; levels < GFX_BLOOM_LEVELS && t->bloom[levels].name && ok; ++levels) {
        const gfx_target *from = levels ? &t->bloom[levels - 1] : &t->hdr;
        gfx_post_begin(d, &t->bloom[levels]);
        glBindTextureUnit(GFX_TEX_HDR, from->texture);
        ok = gfx_post_fill(d, "bloom_down.frag", levels ? 0 : GFX_FEATURE_BLOOM);
    }
    for (uint32_t i = levels; i-- > 1 && ok;) {
        gfx_post_begin(d, &t->bloom[i - 1]);
        glEnable(GL_BLEND);
        glBlendColor(0.0f, 0.0f, 0.0f, world->settings.bloom_spread);
        glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
        glBindTextureUnit(GFX_TEX_HDR, t->bloom[i].texture);
        ok = gfx_post_fill(d, "bloom_up.frag", 0);
    }
    glDisable(GL_BLEND);
    glBindTextureUnit(GFX_TEX_BLOOM, t->bloom[0].texture);
    return ok;
}

static bool expose(gfx_device *d, gfx_targets *t) {
    enum { WORDS = 1 + 2 * GFX_EXPOSURE_BINS, TILE = 16 };
    GLuint count = gfx_shaders_compute(&d->shaders, "exposure.comp", GFX_FEATURE_COUNT_LISTS);
    GLuint sum = gfx_shaders_compute(&d->shaders, "exposure.comp", GFX_FEATURE_SUM_LISTS);
    if (!count || !sum) {
        return false;
    }
    if (!t->exposure) {
        glCreateBuffers(1, &t->exposure);
        glNamedBufferStorage(t->exposure, WORDS * sizeof(uint32_t), NULL, 0);
        glClearNamedBufferData(t->exposure, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
    }
    d->passes++;
    gfx_pass_begin(d, "exposure");
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GFX_SSBO_EXPOSURE, t->exposure);
    glBindTextureUnit(GFX_TEX_HDR, t->hdr.texture);
    glUseProgram(count);
    glDispatchCompute((t->width + TILE - 1) / TILE, (t->height + TILE - 1) / TILE, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glUseProgram(sum);
    glDispatchCompute(1, 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return true;
}

static bool neutral(const gfx_settings *s) {
    bool same = s->contrast == 1.0f && s->saturation == 1.0f;
    for (int i = 0; i < 3; ++i) {
        same &= s->lift[i] == 0.0f && s->gain[i] == 1.0f;
    }
    return same;
}

// The effect that was made next after `order`, NULL: none.
static const gfx_hook *next_effect(const gfx_world *world, uint64_t order) {
    const gfx_hook *next = NULL;
    for (uint32_t i = 0; i < gfx_effect_count(world); ++i) {
        const gfx_hook *hook = &world->effects.hook[i];
        next = hook->order > order && (!next || hook->order < next->order) ? hook : next;
    }
    return next;
}

// Passes that scripts wrote: each from `from` to `spare`, and back. One that does not build is left
// out.
static void run_effects(gfx_device *d, const gfx_world *world, const gfx_targets *t, bool encoded) {
    const gfx_target *from = encoded ? &t->picture : &t->hdr;
    const gfx_target *to = encoded ? &t->spare : &t->spare_hdr;
    const gfx_hook *hook = NULL;
    while (to->name && (hook = next_effect(world, hook ? hook->order : 0)) != NULL) {
        GLuint program = hook->encoded == encoded
                             ? gfx_shaders_get_hooked(&d->shaders, "fullscreen.vert", "effect.frag",
                                                      0, hook->path)
                             : 0;
        if (!program) {
            continue;
        }
        d->passes++;
        gfx_pass_begin(d, "effects");
        gfx_post_begin(d, to);
        glBindTextureUnit(GFX_TEX_HDR, from->texture);
        glBindTextureUnit(GFX_TEX_DEPTH, t->depth);
        glUseProgram(program);
        glUniform4fv(GFX_U_PARAMETERS, GFX_PARAMETERS / 4, hook->parameters);
        glBindVertexArray(d->empty_vao);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glCopyImageSubData(to->texture, GL_TEXTURE_2D, 0, 0, 0, 0, from->texture, GL_TEXTURE_2D, 0,
                           0, 0, 0, (GLsizei)t->width, (GLsizei)t->height, 1);
    }
}

bool gfx_post_finish(gfx_device *d, const gfx_world *world, gfx_targets *t) {
    const gfx_settings *s = &world->settings;
    uint32_t features = 0;
    if (!s->debug) {
        features |= t->bloom[0].name ? GFX_FEATURE_BLOOM : 0;
        features |= s->auto_exposure ? GFX_FEATURE_AUTO_EXPOSURE : 0;
        features |= neutral(s) ? 0 : GFX_FEATURE_GRADE;
    }
    run_effects(d, world, t, false);
    if (features & GFX_FEATURE_AUTO_EXPOSURE) {
        if (!expose(d, t)) {
            return false;
        }
    } else if (t->exposure) {
        glDeleteBuffers(1, &t->exposure);
        t->exposure = 0;
    }
    if (features & GFX_FEATURE_BLOOM && !bloom(d, world, t)) {
        return false;
    }
    bool fxaa = t->encoded.name != 0;
    gfx_pass_begin(d, "tone map");
    gfx_post_begin(d, fxaa ? &t->encoded : &t->picture);
    glBindTextureUnit(GFX_TEX_HDR, t->hdr.texture);
    if (!gfx_post_fill(d, "tonemap.frag", features)) {
        return false;
    }
    if (fxaa) {
        gfx_pass_begin(d, "fxaa");
        gfx_post_begin(d, &t->picture);
        glBindTextureUnit(GFX_TEX_HDR, t->encoded.texture);
        if (!gfx_post_fill(d, "fxaa.frag", 0)) {
            return false;
        }
    }
    run_effects(d, world, t, true);
    return true;
}
