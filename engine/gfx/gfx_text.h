// Text without GL: faces, and where the glyphs of a text stand. Devices draw them (gfx_font.c).
#ifndef GFX_TEXT_H
#define GFX_TEXT_H

#include "gfx/gfx_internal.h"

#include <stb_truetype.h>

typedef struct gfx_face {
    char name[CORE_NAME_MAX]; // as given
    uint64_t id;              // no two faces of a process share it
    stbtt_fontinfo info;
    void *file; // NULL: it could not be read, which was logged
} gfx_face;

// The face of a name ("mono", "sans" or a virtual path), read once. NULL when it cannot be read.
// Valid until the next call.
const gfx_face *gfx_face_get(gfx_world *world, const char *name);
void gfx_faces_release(gfx_growing *faces);

typedef struct gfx_glyph_at { // the pen on the baseline; pixels from the top left of the block
    uint32_t codepoint;
    float x, y;
} gfx_glyph_at;
// Appends gfx_glyph_at unless `glyphs` is NULL. Advances and kerning are the face's own.
gfx_text_box gfx_text_layout(const gfx_face *face, const char *text, size_t length, float size,
                             float width, float align, gfx_growing *glyphs);

// Next code point of UTF-8 text; malformed bytes give U+FFFD, one each.
uint32_t gfx_next_codepoint(const uint8_t **at, const uint8_t *end);

#endif
