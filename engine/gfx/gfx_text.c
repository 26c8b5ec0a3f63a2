#include "gfx/gfx_text.h"

#include "core/log.h"

#include <stdio.h>
#include <string.h>

// ---- faces ----

// Faces that a system has under a name of ours; a game's own file takes the place of "mono".
static const struct {
    const char *name, *path;
} system_faces[] = {{"mono", "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf"},
                    {"sans", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"}};
static const char own_face[] = "fonts/default.ttf";

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

static void *read_face(core_vfs *vfs, const char *name) {
    if (strcmp(name, system_faces[0].name) == 0 && vfs && core_vfs_exists(vfs, own_face)) {
        return core_vfs_read(vfs, own_face, NULL);
    }
    for (size_t i = 0; i < CORE_COUNT_OF(system_faces); ++i) {
        if (strcmp(name, system_faces[i].name) == 0) {
            return read_system_file(system_faces[i].path);
        }
    }
    return vfs ? core_vfs_read(vfs, name, NULL) : NULL;
}

const gfx_face *gfx_face_get(gfx_world *world, const char *name) {
    name = name ? name : system_faces[0].name;
    gfx_face *face = world->faces.data;
    for (size_t i = 0; i < world->faces.count; ++i) {
        if (strcmp(face[i].name, name) == 0) {
            return face[i].file ? &face[i] : NULL;
        }
    }
    face = gfx_grow(&world->faces, sizeof *face, 1);
    *face = (gfx_face){.id = world->id << 16 | world->faces.count};
    snprintf(face->name, sizeof face->name, "%s", name);
    face->file = read_face(world->vfs, name);
    if (face->file &&
        stbtt_InitFont(&face->info, face->file, stbtt_GetFontOffsetForIndex(face->file, 0))) {
        return face;
    }
    core_log(CORE_LOG_WARN,
             "text in the font \"%s\" is not drawn: no such TrueType file; \"mono\" and \"sans\" "
             "are those of fonts-dejavu-core",
             name);
    core_free(face->file);
    face->file = NULL;
    return NULL;
}

void gfx_faces_release(gfx_growing *faces) {
    gfx_face *face = faces->data;
    for (size_t i = 0; i < faces->count; ++i) {
        core_free(face[i].file);
    }
    gfx_growing_release(faces);
}

// ---- layout ----

uint32_t gfx_next_codepoint(const uint8_t **at, const uint8_t *end) {
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

typedef struct pen {
    const stbtt_fontinfo *info;
    float scale, x;
    int previous; // glyph, 0: none
} pen;

// Moves the pen past a character; returns where the character itself stands.
static float pen_move(pen *p, uint32_t codepoint) {
    int advance, bearing, glyph = stbtt_FindGlyphIndex(p->info, (int)codepoint);
    stbtt_GetGlyphHMetrics(p->info, glyph, &advance, &bearing);
    int kern = p->previous ? stbtt_GetGlyphKernAdvance(p->info, p->previous, glyph) : 0;
    float at = p->x + (float)kern * p->scale;
    p->x = at + (float)advance * p->scale;
    p->previous = glyph;
    return at;
}

typedef struct text_line {
    const uint8_t *end, *next;
    float width;
} text_line;

// Ends at '\n', or where the next character would pass the width: at the last space, else between
// letters.
static text_line find_line(pen p, const uint8_t *at, const uint8_t *end, float width) {
    text_line space = {0};
    for (const uint8_t *next = at; next < end;) {
        const uint8_t *here = next;
        float before = p.x;
        uint32_t c = gfx_next_codepoint(&next, end);
        if (c == '\n') {
            return (text_line){here, next, before};
        }
        if (c == ' ') {
            space = (text_line){here, next, before};
        }
        pen_move(&p, c);
        if (width > 0.0f && p.x > width && here > at && c != ' ') {
            return space.end ? space : (text_line){here, here, before};
        }
    }
    return (text_line){end, end, p.x};
}

gfx_text_box gfx_text_layout(const gfx_face *face, const char *text, size_t length, float size,
                             float width, float align, gfx_growing *glyphs) {
    int ascent, descent, gap;
    stbtt_GetFontVMetrics(&face->info, &ascent, &descent, &gap);
    pen start = {.info = &face->info, .scale = stbtt_ScaleForPixelHeight(&face->info, size)};
    const uint8_t *at = (const uint8_t *)text, *end = at + length;
    gfx_text_box box = {0};
    do {
        text_line line = find_line(start, at, end, width);
        float y = (float)box.lines++ * size + (float)ascent * start.scale;
        float left = align * (width - line.width); // a width of 0: about the given place
        pen p = start;
        while (glyphs && at < line.end) {
            uint32_t c = gfx_next_codepoint(&at, end);
            float x = pen_move(&p, c);
            *(gfx_glyph_at *)gfx_grow(glyphs, sizeof(gfx_glyph_at), 1) =
                (gfx_glyph_at){c, left + x, y};
        }
        box.width = CORE_MAX(box.width, line.width);
        at = line.next;
    } while (at < end);
    box.height = (float)box.lines * size;
    return box;
}

// ---- public ----

gfx_text_desc gfx_text_desc_default(void) {
    return (gfx_text_desc){.size = 18.0f, .color = {1, 1, 1, 1}, .cookie = GFX_COOKIE};
}

bool gfx_text_measure(gfx_world *world, const gfx_text_desc *desc, gfx_text_box *out) {
    *out = (gfx_text_box){0};
    if (!desc || desc->cookie != GFX_COOKIE) {
        return core_fail("gfx_text_measure: start from gfx_text_desc_default()");
    }
    if (!desc->text) {
        return core_fail("gfx_text_measure: the text is NULL");
    }
    const gfx_face *face = gfx_face_get(world, desc->font);
    if (!face) {
        return core_fail("gfx_text_measure: the font \"%s\" cannot be read",
                         desc->font ? desc->font : "mono");
    }
    *out = gfx_text_layout(face, desc->text, strlen(desc->text), gfx_text_size(desc->size),
                           desc->width, desc->align, NULL);
    return true;
}
