// Text: glyphs of one TrueType face, drawn at the size asked for into an atlas when first used.
#include "gfx/gfx_device_internal.h"

#include "core/log.h"

#include <stb_truetype.h>

#include <stdio.h>
#include <string.h>

enum { ATLAS = 1024, SLOTS = 4096 };

typedef struct glyph {
    uint32_t codepoint, size; // size 0: slot is free
    int16_t x, y, w, h;       // in the atlas
    int16_t left, top;        // from the pen on the baseline
    float advance;
} glyph;

struct gfx_font {
    stbtt_fontinfo info;
    void *file;
    GLuint texture;
    glyph slot[SLOTS];
    uint32_t glyphs;
    int shelf_x, shelf_y, shelf_h;
};

static const char system_font[] = "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf";

static void *read_system_file(const char *path) {
    FILE *f = fopen(path, "rb");
    if (!f) {
        return NULL;
    }
    void *data = NULL;
    if (fseek(f, 0, SEEK_END) == 0) {
        long size = ftell(f);
        rewind(f);
        data = size > 0 ? core_alloc((size_t)size) : NULL;
        if (data && fread(data, 1, (size_t)size, f) != (size_t)size) {
            core_free(data);
            data = NULL;
        }
    }
    fclose(f);
    return data;
}

static void clear_atlas(gfx_font *font) {
    const uint8_t zero = 0;
    memset(font->slot, 0, sizeof font->slot);
    font->glyphs = 0;
    font->shelf_x = font->shelf_y = font->shelf_h = 0;
    glClearTexImage(font->texture, 0, GL_RED, GL_UNSIGNED_BYTE, &zero);
}

gfx_font *gfx_font_create(core_vfs *vfs) {
    bool own = vfs && core_vfs_exists(vfs, "fonts/default.ttf");
    void *file =
        own ? core_vfs_read(vfs, "fonts/default.ttf", NULL) : read_system_file(system_font);
    gfx_font *font = core_alloc(sizeof *font);
    font->file = file;
    if (!file || !stbtt_InitFont(&font->info, file, stbtt_GetFontOffsetForIndex(file, 0))) {
        core_log(CORE_LOG_WARN,
                 "gfx.print draws nothing: no font in %s; install "
                 "fonts-dejavu-core or add fonts/default.ttf",
                 own ? "fonts/default.ttf" : system_font);
        core_free(file);
        core_free(font);
        return NULL;
    }
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
        core_free(font->file);
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

static void draw_glyph(gfx_font *font, glyph *g, float scale) {
    int x0, y0, x1, y1, advance, bearing;
    int c = (int)g->codepoint;
    stbtt_GetCodepointBitmapBox(&font->info, c, scale, scale, &x0, &y0, &x1, &y1);
    stbtt_GetCodepointHMetrics(&font->info, c, &advance, &bearing);
    g->advance = (float)advance * scale;
    g->left = (int16_t)x0, g->top = (int16_t)y0;
    g->w = (int16_t)(x1 - x0), g->h = (int16_t)(y1 - y0);
    if (g->w <= 0 || g->h <= 0 || !place_glyph(font, g)) {
        g->w = g->h = 0;
        return;
    }
    uint8_t *bitmap = core_alloc((size_t)g->w * (size_t)g->h);
    stbtt_MakeCodepointBitmap(&font->info, bitmap, g->w, g->h, g->w, scale, scale, c);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(font->texture, 0, g->x, g->y, g->w, g->h, GL_RED, GL_UNSIGNED_BYTE, bitmap);
    core_free(bitmap);
}

static const glyph *find_glyph(gfx_font *font, uint32_t codepoint, uint32_t size, float scale) {
    uint32_t at = (codepoint * 2654435761u ^ size * 40503u) % SLOTS;
    while (font->slot[at].size &&
           (font->slot[at].codepoint != codepoint || font->slot[at].size != size)) {
        at = (at + 1) % SLOTS;
    }
    glyph *g = &font->slot[at];
    if (g->size == 0) {
        if (font->glyphs >= SLOTS - 1) {
            return NULL;
        }
        *g = (glyph){.codepoint = codepoint, .size = size};
        font->glyphs++;
        draw_glyph(font, g, scale);
    }
    return g;
}

// Next code point of UTF-8 text; malformed bytes give U+FFFD, one each.
static uint32_t next_codepoint(const uint8_t **at, const uint8_t *end) {
    uint32_t c = *(*at)++;
    int more = c < 0x80 ? 0 : c >= 0xf0 ? 3 : c >= 0xe0 ? 2 : c >= 0xc0 ? 1 : -1;
    if (more < 0 || end - *at < more) {
        return 0xfffd;
    }
    c &= more ? 0x3fu >> more : 0x7fu;
    for (int i = 0; i < more; ++i) {
        if ((*at)[i] >> 6 != 2) {
            return 0xfffd;
        }
        c = c << 6 | ((*at)[i] & 0x3fu);
    }
    *at += more;
    return c;
}

static void add_quad(const glyph *g, float x, float y, const gfx_rgba *color, gfx_growing *quads) {
    struct gfx_quad_block *q = gfx_grow(quads, sizeof *q, 1);
    const float texel = 1.0f / ATLAS;
    *q = (struct gfx_quad_block){
        .rect = {x + g->left, y + g->top, g->w, g->h},
        .uv = {g->x * texel, g->y * texel, (g->x + g->w) * texel, (g->y + g->h) * texel},
    };
    memcpy(q->color, color, sizeof q->color);
}

static float round_pixel(float x) { return (float)core_floor((double)x + 0.5); }

void gfx_font_layout(gfx_font *font, const char *text, size_t length, float x, float y, float size,
                     const gfx_rgba *color, gfx_growing *quads) {
    int ascent, descent, gap;
    uint32_t pixels = (uint32_t)(size + 0.5f);
    float scale = stbtt_ScaleForPixelHeight(&font->info, (float)pixels);
    stbtt_GetFontVMetrics(&font->info, &ascent, &descent, &gap);
    const uint8_t *at = (const uint8_t *)text, *end = at + length;
    // Whole pixels keep the glyphs as they were drawn.
    float left = round_pixel(x), pen = left, baseline = round_pixel(y + (float)ascent * scale);
    while (at < end) {
        uint32_t c = next_codepoint(&at, end);
        if (c == '\n') {
            pen = left;
            baseline += (float)pixels;
            continue;
        }
        const glyph *g = find_glyph(font, c, pixels, scale);
        if (g && g->w) {
            add_quad(g, round_pixel(pen), baseline, color, quads);
        }
        pen += g ? g->advance : 0.0f;
    }
}
