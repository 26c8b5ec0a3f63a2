// Glyphs drawn at the size asked for into one atlas when first used.
#include "gfx/gfx_device_internal.h"
#include "gfx/gfx_text.h"

#include <string.h>

enum { ATLAS = 1024, SLOTS = 4096 };

typedef struct glyph {
    uint64_t face;
    uint32_t codepoint, size; // size 0: slot is free
    int16_t x, y, w, h;       // in the atlas
    int16_t left, top;        // from the pen on the baseline
} glyph;

struct gfx_font {
    GLuint texture;
    glyph slot[SLOTS];
    uint32_t glyphs;
    int shelf_x, shelf_y, shelf_h;
    gfx_growing layout; // gfx_glyph_at of the text at hand
};

static void clear_atlas(gfx_font *font) {
    const uint8_t zero = 0;
    memset(font->slot, 0, sizeof font->slot);
    font->glyphs = 0;
    font->shelf_x = font->shelf_y = font->shelf_h = 0;
    glClearTexImage(font->texture, 0, GL_RED, GL_UNSIGNED_BYTE, &zero);
}

gfx_font *gfx_font_create(void) {
    gfx_font *font = core_alloc(sizeof *font);
    glCreateTextures(GL_TEXTURE_2D, 1, &font->texture);
    glTextureStorage2D(font->texture, 1, GL_R8, ATLAS, ATLAS);
    glTextureParameteri(font->texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(font->texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    clear_atlas(font);
    return font;
}

void gfx_font_release(gfx_font *font) {
    if (font) {
        glDeleteTextures(1, &font->texture);
        gfx_growing_release(&font->layout);
        core_free(font);
    }
}

GLuint gfx_font_texture(const gfx_font *font) { return font->texture; }

void gfx_font_begin_frame(gfx_font *font) {
    // Glyphs already placed in this frame must stay, so a full atlas starts anew between frames.
    if (font->glyphs > SLOTS / 2 || font->shelf_y > ATLAS * 3 / 4) {
        clear_atlas(font);
    }
}

// Place for a bitmap in the atlas, by shelves; false when full.
static bool place_glyph(gfx_font *font, glyph *g) {
    if (font->shelf_x + g->w + 1 > ATLAS) {
        font->shelf_y += font->shelf_h + 1;
        font->shelf_x = font->shelf_h = 0;
    }
    if (font->shelf_y + g->h > ATLAS || g->w > ATLAS) {
        return false;
    }
    g->x = (int16_t)font->shelf_x, g->y = (int16_t)font->shelf_y;
    font->shelf_x += g->w + 1;
    font->shelf_h = CORE_MAX(font->shelf_h, g->h);
    return true;
}

static void draw_glyph(gfx_font *font, glyph *g, const stbtt_fontinfo *info) {
    int x0, y0, x1, y1, c = (int)g->codepoint;
    float scale = stbtt_ScaleForPixelHeight(info, (float)g->size);
    stbtt_GetCodepointBitmapBox(info, c, scale, scale, &x0, &y0, &x1, &y1);
    g->left = (int16_t)x0, g->top = (int16_t)y0;
    g->w = (int16_t)(x1 - x0), g->h = (int16_t)(y1 - y0);
    if (g->w <= 0 || g->h <= 0 || !place_glyph(font, g)) {
        g->w = g->h = 0;
        return;
    }
    uint8_t *bitmap = core_alloc((size_t)g->w * (size_t)g->h);
    stbtt_MakeCodepointBitmap(info, bitmap, g->w, g->h, g->w, scale, scale, c);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(font->texture, 0, g->x, g->y, g->w, g->h, GL_RED, GL_UNSIGNED_BYTE, bitmap);
    core_free(bitmap);
}

static const glyph *find_glyph(gfx_font *font, const gfx_face *face, uint32_t codepoint,
                               uint32_t size) {
    uint32_t mixed = codepoint * 2654435761u ^ size * 40503u ^ (uint32_t)face->id * 97u;
    uint32_t at = mixed % SLOTS;
    glyph *g = &font->slot[at];
    while (g->size && (g->codepoint != codepoint || g->size != size || g->face != face->id)) {
        at = (at + 1) % SLOTS;
        g = &font->slot[at];
    }
    if (g->size == 0) {
        if (font->glyphs >= SLOTS - 1) {
            return NULL;
        }
        *g = (glyph){.face = face->id, .codepoint = codepoint, .size = size};
        font->glyphs++;
        draw_glyph(font, g, &face->info);
    }
    return g;
}

static float round_pixel(float x) { return (float)core_floor((double)x + 0.5); }

void gfx_font_quads(gfx_font *font, const gfx_face *face, const char *text,
                    const gfx_command *command, gfx_growing *quads) {
    const gfx_command *c = command;
    const float texel = 1.0f / ATLAS;
    font->layout.count = 0;
    gfx_text_layout(face, text, c->text_length, c->h, c->w, c->align, &font->layout);
    const gfx_glyph_at *at = font->layout.data;
    for (size_t i = 0; i < font->layout.count; ++i) {
        const glyph *g = find_glyph(font, face, at[i].codepoint, (uint32_t)c->h);
        if (!g || !g->w) {
            continue;
        }
        // Whole pixels keep the glyphs as they were drawn.
        float x = round_pixel(round_pixel(c->x) + at[i].x), y = round_pixel(c->y + at[i].y);
        struct gfx_quad_block *q = gfx_grow(quads, sizeof *q, 1);
        *q = (struct gfx_quad_block){
            .place = {x + g->left, y + g->top},
            .axes = {g->w, 0.0f, 0.0f, g->h},
            .uv = {g->x * texel, g->y * texel, (g->x + g->w) * texel, (g->y + g->h) * texel},
        };
        memcpy(q->color, &c->color, sizeof q->color);
        memcpy(q->clip, c->clip, sizeof q->clip);
    }
}
