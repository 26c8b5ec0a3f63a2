// The textures that a view is drawn to. What the settings do not ask for is not there.
#include "gfx/gfx_device_internal.h"

#include "core/log.h"

static bool make_target(gfx_target *t, GLenum format, uint32_t width, uint32_t height,
                        GLint filter) {
    t->width = width, t->height = height;
    glCreateTextures(GL_TEXTURE_2D, 1, &t->texture);
    glTextureStorage2D(t->texture, 1, format, (GLsizei)width, (GLsizei)height);
    glTextureParameteri(t->texture, GL_TEXTURE_MIN_FILTER, filter);
    glTextureParameteri(t->texture, GL_TEXTURE_MAG_FILTER, filter);
    glTextureParameteri(t->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(t->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glCreateFramebuffers(1, &t->name);
    glNamedFramebufferTexture(t->name, GL_COLOR_ATTACHMENT0, t->texture, 0);
    return true;
}

static void release_target(gfx_target *t) {
    glDeleteTextures(1, &t->texture);
    glDeleteFramebuffers(1, &t->name);
    *t = (gfx_target){0};
}

static bool check_target(const gfx_target *t) {
    GLenum status = glCheckNamedFramebufferStatus(t->name, GL_DRAW_FRAMEBUFFER);
    return status == GL_FRAMEBUFFER_COMPLETE ||
           core_fail("gfx_device: a %ux%u target is not complete (0x%x)", t->width, t->height,
                     (unsigned)status);
}

static GLenum hdr_format(const gfx_device *d) { return d->float_target ? GL_RGBA32F : GL_RGBA16F; }

static GLuint make_depth(uint32_t width, uint32_t height) {
    GLuint t;
    glCreateTextures(GL_TEXTURE_2D, 1, &t);
    glTextureStorage2D(t, 1, GL_DEPTH_COMPONENT32F, (GLsizei)width, (GLsizei)height);
    glTextureParameteri(t, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(t, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureParameteri(t, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(t, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return t;
}

// ---- several samples a pixel ----

static void release_samples(gfx_targets *t) {
    glDeleteRenderbuffers(1, &t->samples.texture);
    glDeleteRenderbuffers(1, &t->sample_depth);
    glDeleteFramebuffers(1, &t->samples.name);
    t->samples = (gfx_target){0};
    t->sample_depth = 0, t->sample_count = 0;
}

static bool make_samples(gfx_device *d, gfx_targets *t, GLint count) {
    GLsizei w = (GLsizei)t->width, h = (GLsizei)t->height;
    gfx_target *s = &t->samples;
    s->width = t->width, s->height = t->height;
    glCreateRenderbuffers(1, &s->texture);
    glCreateRenderbuffers(1, &t->sample_depth);
    glNamedRenderbufferStorageMultisample(s->texture, count, hdr_format(d), w, h);
    glNamedRenderbufferStorageMultisample(t->sample_depth, count, GL_DEPTH_COMPONENT32F, w, h);
    glCreateFramebuffers(1, &s->name);
    glNamedFramebufferRenderbuffer(s->name, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, s->texture);
    glNamedFramebufferRenderbuffer(s->name, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, t->sample_depth);
    t->sample_count = (GLuint)count;
    return check_target(s);
}

static bool fit_samples(gfx_device *d, const gfx_world *world, gfx_targets *t) {
    GLint wanted = 1 << world->settings.msaa;
    if (wanted > d->most_samples) {
        if (!d->samples_warned) {
            core_log(CORE_LOG_WARN, "gfx.msaa=%d: %s has %d samples at most, which are taken",
                     wanted, d->name, d->most_samples);
        }
        d->samples_warned = true;
        wanted = d->most_samples;
    }
    GLint now = t->sample_count ? (GLint)t->sample_count : 1;
    if (wanted == now) {
        return true;
    }
    release_samples(t);
    return wanted == 1 || make_samples(d, t, wanted);
}

// ---- what passes need ----

static bool fit(gfx_target *t, bool wanted, GLenum format, uint32_t width, uint32_t height,
                GLint filter) {
    if (wanted == (t->texture != 0)) {
        return true;
    }
    release_target(t);
    return !wanted || (make_target(t, format, width, height, filter) && check_target(t));
}

static bool fit_bloom(gfx_device *d, const gfx_settings *s, gfx_targets *t) {
    uint32_t levels = s->bloom > 0.0f && !s->debug ? (uint32_t)s->bloom_levels : 0;
    uint32_t w = t->width, h = t->height;
    bool ok = true;
    for (uint32_t i = 0; i < GFX_BLOOM_LEVELS && ok; ++i) {
        w = (w + 1) / 2, h = (h + 1) / 2;
        ok = fit(&t->bloom[i], i < levels, hdr_format(d), w, h, GL_LINEAR);
    }
    return ok;
}

static bool has_effect(const gfx_world *world, bool encoded) {
    bool found = false;
    for (uint32_t i = 0; i < gfx_effect_count(world) && !world->settings.debug; ++i) {
        found |= world->effects.hook[i].encoded == encoded;
    }
    return found;
}

bool gfx_targets_fit(gfx_device *d, const gfx_world *world, gfx_targets *t) {
    const gfx_settings *s = &world->settings;
    uint32_t w = t->width, h = t->height;
    bool ao = s->ao > 0.0f && !s->debug, fxaa = s->fxaa && !s->debug;
    return fit_samples(d, world, t) && fit(&t->ao, ao, GL_R16, w, h, GL_NEAREST) &&
           fit(&t->ao_smooth, ao, GL_R16, w, h, GL_NEAREST) && fit_bloom(d, s, t) &&
           fit(&t->encoded, fxaa, GL_RGBA8, w, h, GL_LINEAR) &&
           fit(&t->spare_hdr, has_effect(world, false), hdr_format(d), w, h, GL_LINEAR) &&
           fit(&t->spare, has_effect(world, true), GL_RGBA8, w, h, GL_LINEAR);
}

void gfx_targets_add_image(gfx_targets *t) {
    const float black[4] = {0.0f, 0.0f, 0.0f, 1.0f}; // until it is drawn: a screen may see itself
    make_target(&t->image, GL_RGBA8, t->width, t->height, GL_LINEAR);
    glClearNamedFramebufferfv(t->image.name, GL_COLOR, 0, black);
    glGenTextures(1, &t->light);
    glTextureView(t->light, GL_TEXTURE_2D, t->image.texture, GL_SRGB8_ALPHA8, 0, 1, 0, 1);
    glTextureParameteri(t->light, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
}

bool gfx_targets_resize(gfx_device *d, gfx_targets *t, uint32_t width, uint32_t height) {
    gfx_targets_release(t);
    t->width = width, t->height = height;
    make_target(&t->hdr, hdr_format(d), width, height, GL_LINEAR);
    make_target(&t->picture, GL_RGBA8, width, height, GL_LINEAR);
    t->depth = make_depth(width, height);
    glNamedFramebufferTexture(t->hdr.name, GL_DEPTH_ATTACHMENT, t->depth, 0);
    return check_target(&t->hdr) && check_target(&t->picture);
}

void gfx_targets_release(gfx_targets *t) {
    gfx_target *const all[] = {&t->hdr,     &t->picture, &t->ao,        &t->ao_smooth,
                               &t->encoded, &t->image,   &t->spare_hdr, &t->spare};
    for (size_t i = 0; i < CORE_COUNT_OF(all); ++i) {
        release_target(all[i]);
    }
    for (size_t i = 0; i < GFX_BLOOM_LEVELS; ++i) {
        release_target(&t->bloom[i]);
    }
    const GLuint textures[2] = {t->depth, t->light};
    glDeleteTextures(2, textures);
    glDeleteBuffers(1, &t->exposure);
    t->depth = t->light = t->exposure = 0;
    release_samples(t);
}

size_t gfx_targets_bytes(const gfx_device *d, const gfx_targets *t) {
    size_t pixels = (size_t)t->width * t->height, hdr = d->float_target ? 16 : 8, bytes = 0;
    bytes += pixels * (hdr + 4 + 4); // with depth and picture
    bytes += pixels * t->sample_count * (hdr + 4);
    bytes += t->ao.texture ? pixels * 4 : 0;
    bytes += t->encoded.texture ? pixels * 4 : 0;
    bytes += t->image.texture ? pixels * 4 : 0;
    bytes += t->spare.texture ? pixels * 4 : 0;
    bytes += t->spare_hdr.texture ? pixels * hdr : 0;
    for (size_t i = 0; i < GFX_BLOOM_LEVELS; ++i) {
        bytes += (size_t)t->bloom[i].width * t->bloom[i].height * hdr;
    }
    return bytes;
}
