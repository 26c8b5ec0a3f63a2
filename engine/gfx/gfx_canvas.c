// Screen-space calls: recorded in the world, drawn by the device.
#include "gfx/gfx_internal.h"

#include <stdio.h>
#include <string.h>

uint32_t gfx_keep_text(gfx_world *world, const char *text) {
    size_t length = strlen(text);
    uint32_t at = (uint32_t)world->text.count;
    memcpy(gfx_grow(&world->text, 1, length + 1), text, length + 1);
    return at;
}

static gfx_command *add_command(gfx_world *world, gfx_command_type type, const char *text) {
    gfx_command *c = gfx_grow(&world->commands, sizeof *c, 1);
    *c = (gfx_command){.type = type, .color = {1.0f, 1.0f, 1.0f, 1.0f}, .font = GFX_NO_TEXT};
    memcpy(c->clip, world->clip[world->clips], sizeof c->clip);
    if (text) {
        c->text_length = (uint32_t)strlen(text);
        c->text = gfx_keep_text(world, text);
    }
    return c;
}

static gfx_rgba rgba(const float color[4]) {
    return (gfx_rgba){color[0], color[1], color[2], color[3]};
}

void gfx_print(gfx_world *world, float x, float y, float size, const float color[4],
               const char *text) {
    if (!text) {
        return;
    }
    gfx_command *c = add_command(world, GFX_CMD_TEXT, text);
    c->x = x, c->y = y, c->h = gfx_text_size(size);
    c->color = rgba(color);
}

bool gfx_text(gfx_world *world, const gfx_text_desc *desc) {
    if (!desc || desc->cookie != GFX_COOKIE) {
        return core_fail("gfx_text: start from gfx_text_desc_default()");
    }
    if (!desc->text) {
        return core_fail("gfx_text: the text is NULL");
    }
    gfx_command *c = add_command(world, GFX_CMD_TEXT, desc->text);
    c->x = desc->x, c->y = desc->y;
    c->h = gfx_text_size(desc->size), c->w = desc->width;
    c->align = desc->align;
    c->color = rgba(desc->color);
    if (desc->font) {
        c->font = gfx_keep_text(world, desc->font);
    }
    return true;
}

void gfx_rect(gfx_world *world, float x, float y, float w, float h, const float color[4]) {
    gfx_command *c = add_command(world, GFX_CMD_RECT, NULL);
    c->x = x, c->y = y, c->w = w, c->h = h;
    c->color = rgba(color);
}

void gfx_round_rect(gfx_world *world, float x, float y, float w, float h, float radius,
                    float border, const float color[4]) {
    gfx_rect(world, x, y, w, h, color);
    gfx_command *c = (gfx_command *)world->commands.data + world->commands.count - 1;
    c->radius = CORE_MAX(radius, 0.0f), c->border = border;
    c->smooth = true;
}

void gfx_line(gfx_world *world, float x0, float y0, float x1, float y1, float width,
              const float color[4]) {
    float dx = x1 - x0, dy = y1 - y0;
    gfx_rect(world, x0, y0, core_sqrtf(dx * dx + dy * dy), width, color);
    gfx_command *c = (gfx_command *)world->commands.data + world->commands.count - 1;
    c->angle = core_atan2f(dy, dx);
    c->pivot[1] = 0.5f; // the line runs along the middle
    c->smooth = true;
}

void gfx_image(gfx_world *world, const char *path, float x, float y, float w, float h) {
    if (!path) {
        return;
    }
    gfx_command *c = add_command(world, GFX_CMD_IMAGE, path);
    c->x = x, c->y = y, c->w = w, c->h = h;
}

gfx_sprite_desc gfx_sprite_desc_default(void) { return (gfx_sprite_desc){.cookie = GFX_COOKIE}; }

bool gfx_sprite(gfx_world *world, const gfx_sprite_desc *desc) {
    if (!desc || desc->cookie != GFX_COOKIE) {
        return core_fail("gfx_sprite: start from gfx_sprite_desc_default()");
    }
    if (!desc->path) {
        return core_fail("gfx_sprite: no path of an image file");
    }
    gfx_image(world, desc->path, desc->x, desc->y, desc->w, desc->h);
    gfx_command *c = (gfx_command *)world->commands.data + world->commands.count - 1;
    memcpy(c->source, desc->source, sizeof c->source);
    memcpy(c->pivot, desc->pivot, sizeof c->pivot);
    c->angle = desc->angle;
    const float *k = desc->color;
    bool given = k[0] != 0.0f || k[1] != 0.0f || k[2] != 0.0f || k[3] != 0.0f;
    c->color = given ? rgba(k) : c->color;
    return true;
}

// ---- clipping ----

bool gfx_clip_push(gfx_world *world, float x, float y, float w, float h) {
    if (world->clips == GFX_CLIPS) {
        return core_fail("gfx_clip_push: more than %d rectangles deep; is a pop missing?",
                         GFX_CLIPS);
    }
    const float *outer = world->clip[world->clips];
    float *clip = world->clip[++world->clips];
    clip[0] = CORE_MAX(x, outer[0]), clip[1] = CORE_MAX(y, outer[1]);
    clip[2] = CORE_MIN(x + w, outer[2]), clip[3] = CORE_MIN(y + h, outer[3]);
    return true;
}

bool gfx_clip_pop(gfx_world *world) {
    if (world->clips == 0) {
        return core_fail("gfx_clip_pop: no rectangle was pushed");
    }
    world->clips--;
    return true;
}

void gfx_world_begin_frame(gfx_world *world) {
    const float all[4] = {-1e9f, -1e9f, 1e9f, 1e9f};
    world->commands.count = world->text.count = 0;
    world->lines.count = world->boards.count = 0;
    memcpy(world->clip[0], all, sizeof all);
    world->clips = 0;
}
