// Draws a world's screen-space calls: text, rectangles, images, in call order.
#include "gfx/gfx_device_internal.h"

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

static void add_rect(gfx_quads *q, const gfx_command *c, float w, float h) {
    struct gfx_quad_block *b = gfx_grow(&q->quads, sizeof *b, 1);
    *b = (struct gfx_quad_block){.rect = {c->x, c->y, w, h}, .uv = {0.0f, 0.0f, 1.0f, 1.0f}};
    memcpy(b->color, &c->color, sizeof b->color);
}

static void add_command(gfx_device *d, const gfx_world *world, const gfx_command *c) {
    gfx_quads *q = &d->quads;
    size_t before = q->quads.count;
    const char *text = (const char *)world->text.data + c->text;
    if (c->type == GFX_CMD_RECT) {
        add_rect(q, c, c->w, c->h);
        extend_run(q, 0, 0, before);
    } else if (c->type == GFX_CMD_TEXT) {
        if (!q->font_tried) {
            q->font = gfx_font_create(d->vfs);
            q->font_tried = true;
        }
        if (q->font) {
            gfx_font_layout(q->font, text, c->text_length, c->x, c->y, c->h, &c->color, &q->quads);
            extend_run(q, gfx_font_texture(q->font), GFX_FEATURE_TEXT, before);
        }
    } else {
        const gfx_texture *t = gfx_texture_get(d, text, false);
        if (t) {
            add_rect(q, c, c->w > 0.0f ? c->w : (float)t->width,
                     c->h > 0.0f ? c->h : (float)t->height);
            extend_run(q, t->name, GFX_FEATURE_IMAGE, before);
        }
    }
}

bool gfx_quads_draw(gfx_device *d, const gfx_world *world) {
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
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glBindVertexArray(d->empty_vao);
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
    glDisable(GL_BLEND);
    return ok;
}
