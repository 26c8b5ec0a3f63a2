// Draws a world's screen-space calls: text, rectangles, images, in call order.
#include "gfx/gfx_device_internal.h"
#include "gfx/gfx_text.h"

#include <string.h>

void gfx_quads_release(gfx_quads *q) {
    gfx_stream_release(&q->stream);
    gfx_growing_release(&q->quads);
    gfx_growing_release(&q->runs);
    gfx_font_release(q->font);
    *q = (gfx_quads){0};
}

// Quads that follow one another with one texture are one draw.
static void extend_run(gfx_quads *q, GLuint texture, uint32_t features, size_t before) {
    uint32_t added = (uint32_t)(q->quads.count - before);
    gfx_quad_run *last = q->runs.count ? (gfx_quad_run *)q->runs.data + q->runs.count - 1 : NULL;
    if (last && last->texture == texture && last->features == features) {
        last->count += added;
    } else if (added) {
        *(gfx_quad_run *)gfx_grow(&q->runs, sizeof *last, 1) =
            (gfx_quad_run){(uint32_t)before, added, texture, features};
    }
}

// The rectangle of a command, turned about its pivot; w and h where it names none.
static void add_rect(gfx_quads *q, const gfx_command *c, float w, float h, const float uv[4]) {
    struct gfx_quad_block *b = gfx_grow(&q->quads, sizeof *b, 1);
    float sine = 0.0f, cosine = 1.0f, px = c->pivot[0] * w, py = c->pivot[1] * h;
    if (c->angle != 0.0f) {
        core_sincosf(c->angle, &sine, &cosine);
    }
    *b = (struct gfx_quad_block){
        .place = {c->x - px * cosine + py * sine, c->y - px * sine - py * cosine, c->radius,
                  c->border},
        .axes = {w * cosine, w * sine, -h * sine, h * cosine},
    };
    memcpy(b->uv, uv, sizeof b->uv);
    memcpy(b->color, &c->color, sizeof b->color);
    memcpy(b->clip, c->clip, sizeof b->clip);
}

static void add_image(gfx_quads *q, const gfx_command *c, const gfx_texture *t) {
    const float w = (float)t->width, h = (float)t->height, *s = c->source;
    float uv[4] = {0.0f, 0.0f, 1.0f, 1.0f}, size[2] = {w, h};
    if (s[2] > 0.0f) {
        uv[0] = s[0] / w, uv[1] = s[1] / h;
        uv[2] = (s[0] + s[2]) / w, uv[3] = (s[1] + s[3]) / h;
        size[0] = s[2], size[1] = s[3];
    }
    add_rect(q, c, c->w > 0.0f ? c->w : size[0], c->h > 0.0f ? c->h : size[1], uv);
}

static void add_text(gfx_device *d, gfx_world *world, const gfx_command *c) {
    gfx_quads *q = &d->quads;
    const char *text = world->text.data;
    const gfx_face *face = gfx_face_get(world, c->font == GFX_NO_TEXT ? NULL : text + c->font);
    if (face) {
        q->font = q->font ? q->font : gfx_font_create();
        gfx_font_quads(q->font, face, text + c->text, c, &q->quads);
    }
}

static void add_command(gfx_device *d, gfx_world *world, const gfx_command *c) {
    const float whole[4] = {0.0f, 0.0f, 1.0f, 1.0f};
    gfx_quads *q = &d->quads;
    size_t before = q->quads.count;
    if (c->type == GFX_CMD_RECT) {
        add_rect(q, c, c->w, c->h, whole);
        extend_run(q, 0, c->smooth ? GFX_FEATURE_SMOOTH : 0, before);
    } else if (c->type == GFX_CMD_TEXT) {
        add_text(d, world, c);
        extend_run(q, q->font ? gfx_font_texture(q->font) : 0, GFX_FEATURE_TEXT, before);
    } else {
        const gfx_texture *t = gfx_texture_get(d, (const char *)world->text.data + c->text, false);
        add_image(q, c, t);
        extend_run(q, t->name, GFX_FEATURE_IMAGE, before);
    }
}

static void set_clipping(bool on) {
    for (GLenum i = 0; i < 4; ++i) {
        (on ? glEnable : glDisable)(GL_CLIP_DISTANCE0 + i);
    }
}

bool gfx_quads_draw(gfx_device *d, gfx_world *world) {
    gfx_quads *q = &d->quads;
    if (world->commands.count == 0) {
        return true;
    }
    d->passes++;
    q->quads.count = q->runs.count = 0;
    if (q->font) {
        gfx_font_begin_frame(q->font);
    }
    for (size_t i = 0; i < world->commands.count; ++i) {
        add_command(d, world, (const gfx_command *)world->commands.data + i);
    }
    size_t bytes = q->quads.count * sizeof(struct gfx_quad_block);
    if (bytes == 0) {
        return true;
    }
    memcpy(gfx_stream_begin(&q->stream, bytes, d->frame), q->quads.data, bytes);
    gfx_stream_bind(&q->stream, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_QUADS, bytes, d->frame);
    glEnable(GL_BLEND);
    // The alpha of the frame stays 1: a picture filed with less would show what is behind it.
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glBindVertexArray(d->empty_vao);
    set_clipping(true);
    bool ok = true;
    for (size_t i = 0; i < q->runs.count && ok; ++i) {
        const gfx_quad_run *run = (const gfx_quad_run *)q->runs.data + i;
        GLuint program = gfx_shaders_get(&d->shaders, "quad.vert", "quad.frag", run->features);
        ok = program != 0;
        if (ok) {
            glUseProgram(program);
            glBindTextureUnit(GFX_TEX_IMAGE, run->texture);
            glDrawArrays(GL_TRIANGLES, (GLint)run->first * 6, (GLsizei)run->count * 6);
        }
    }
    set_clipping(false);
    glDisable(GL_BLEND);
    return ok;
}
