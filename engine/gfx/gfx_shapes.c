// Lines and shapes of lines in the world: recorded for one frame, drawn by gfx_marks.c.
#include "gfx/gfx_internal.h"

#include <math.h>

enum { CIRCLE = 32 }; // segments

static bool finite3(core_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

gfx_pen gfx_pen_default(void) {
    return (gfx_pen){.color = {1.0f, 1.0f, 1.0f, 1.0f}, .width = 1.5f};
}

// Lines that are not finite are no lines.
void gfx_draw_line(gfx_world *world, core_vec3 a, core_vec3 b, const gfx_pen *pen) {
    if (!finite3(a) || !finite3(b)) {
        return;
    }
    struct gfx_line_block *line = gfx_grow(&world->lines, sizeof *line, 1);
    *line = (struct gfx_line_block){
        .from = {a.x, a.y, a.z, CORE_CLAMP(pen->width, 0.5f, 64.0f)},
        .to = {b.x, b.y, b.z, pen->on_top ? 1.0f : 0.0f},
        .color = {pen->color[0], pen->color[1], pen->color[2], pen->color[3]},
    };
}

void gfx_draw_path(gfx_world *world, const core_vec3 *point, uint32_t count, const gfx_pen *pen) {
    for (uint32_t i = 0; i + 1 < count; ++i) {
        gfx_draw_line(world, point[i], point[i + 1], pen);
    }
}

// Part of an ellipse: center + u cos + v sin, from angle `from` over `turn`.
static void arc(gfx_world *world, core_vec3 center, core_vec3 u, core_vec3 v, float from,
                float turn, const gfx_pen *pen) {
    int n = (int)((float)CIRCLE * turn / (2.0f * CORE_PI_F) + 0.5f);
    core_vec3 last = {0};
    for (int i = 0; i <= n; ++i) {
        float sine, cosine;
        core_sincosf(from + turn * (float)i / (float)n, &sine, &cosine);
        core_vec3 p = core_v3_mad(core_v3_mad(center, u, cosine), v, sine);
        if (i) {
            gfx_draw_line(world, last, p, pen);
        }
        last = p;
    }
}

void gfx_draw_box(gfx_world *world, core_vec3 center, core_quat rotation, core_vec3 half,
                  const gfx_pen *pen) {
    core_vec3 corner[8];
    rotation = core_quat_normalize(rotation);
    for (int i = 0; i < 8; ++i) {
        core_vec3 p =
            core_v3(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
        corner[i] = core_v3_add(center, core_quat_rotate(rotation, p));
    }
    for (int i = 0; i < 8; ++i) {
        for (int bit = 1; bit < 8; bit *= 2) {
            if (!(i & bit)) {
                gfx_draw_line(world, corner[i], corner[i | bit], pen);
            }
        }
    }
}

void gfx_draw_sphere(gfx_world *world, core_vec3 center, float radius, const gfx_pen *pen) {
    const core_vec3 axis[3] = {{radius, 0, 0}, {0, radius, 0}, {0, 0, radius}};
    for (int i = 0; i < 3; ++i) {
        arc(world, center, axis[i], axis[(i + 1) % 3], 0.0f, 2.0f * CORE_PI_F, pen);
    }
}

// Two unit vectors across a unit one (Duff and others, "Building an Orthonormal Basis, Revisited",
// 2017).
static void across(core_vec3 n, core_vec3 *u, core_vec3 *v) {
    float sign = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    *u = core_v3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *v = core_v3(b, sign + n.y * n.y * a, -n.y);
}

void gfx_draw_capsule(gfx_world *world, core_vec3 a, core_vec3 b, float radius,
                      const gfx_pen *pen) {
    core_vec3 n = core_v3_normalize(core_v3_sub(b, a), core_v3(0.0f, 1.0f, 0.0f)), u, v;
    across(n, &u, &v);
    u = core_v3_scale(u, radius), v = core_v3_scale(v, radius), n = core_v3_scale(n, radius);
    const core_vec3 side[4] = {u, v, core_v3_scale(u, -1.0f), core_v3_scale(v, -1.0f)};
    arc(world, a, u, v, 0.0f, 2.0f * CORE_PI_F, pen);
    arc(world, b, u, v, 0.0f, 2.0f * CORE_PI_F, pen);
    for (int i = 0; i < 4; ++i) {
        gfx_draw_line(world, core_v3_add(a, side[i]), core_v3_add(b, side[i]), pen);
    }
    for (int i = 0; i < 2; ++i) {
        arc(world, b, side[i], n, 0.0f, CORE_PI_F, pen);
        arc(world, a, side[i], n, CORE_PI_F, CORE_PI_F, pen);
    }
}

void gfx_draw_arrow(gfx_world *world, core_vec3 a, core_vec3 b, const gfx_pen *pen) {
    core_vec3 way = core_v3_sub(b, a), u, v;
    float head = 0.2f * core_v3_length(way);
    core_vec3 n = core_v3_normalize(way, core_v3(0.0f, 1.0f, 0.0f));
    across(n, &u, &v);
    gfx_draw_line(world, a, b, pen);
    core_vec3 neck = core_v3_mad(b, n, -head);
    for (int i = 0; i < 4; ++i) {
        float reach = i & 1 ? 0.4f * head : -0.4f * head;
        gfx_draw_line(world, b, core_v3_mad(neck, i < 2 ? u : v, reach), pen);
    }
}

void gfx_draw_grid(gfx_world *world, core_vec3 center, float size, uint32_t cells,
                   const gfx_pen *pen) {
    cells = CORE_CLAMP(cells, 1u, 1000u);
    for (uint32_t i = 0; i <= cells; ++i) {
        float at = size * ((float)i / (float)cells - 0.5f), end = 0.5f * size;
        gfx_draw_line(world, core_v3(center.x + at, center.y, center.z - end),
                      core_v3(center.x + at, center.y, center.z + end), pen);
        gfx_draw_line(world, core_v3(center.x - end, center.y, center.z + at),
                      core_v3(center.x + end, center.y, center.z + at), pen);
    }
}

// ---- pictures and texts ----

gfx_board_desc gfx_board_desc_default(void) {
    return (gfx_board_desc){.height = 1.0f, .cookie = GFX_COOKIE};
}

bool gfx_draw_board(gfx_world *world, const gfx_board_desc *desc) {
    if (!desc || desc->cookie != GFX_COOKIE) {
        return core_fail("gfx_draw_board: start from gfx_board_desc_default()");
    }
    if (!desc->image == !desc->text) {
        return core_fail("gfx_draw_board: give an image or a text, one of them");
    }
    if (!finite3(desc->position) || !(desc->height > 0.0f) || !isfinite(desc->height) ||
        !(desc->width >= 0.0f) || !isfinite(desc->width)) {
        return core_fail("gfx_draw_board: position must be finite numbers, height > 0, width >= 0");
    }
    gfx_board *b = gfx_grow(&world->boards, sizeof *b, 1);
    *b = (gfx_board){.desc = *desc, GFX_NO_TEXT, GFX_NO_TEXT, GFX_NO_TEXT};
    b->image = desc->image ? gfx_keep_text(world, desc->image) : GFX_NO_TEXT;
    b->text = desc->text ? gfx_keep_text(world, desc->text) : GFX_NO_TEXT;
    b->font = desc->font ? gfx_keep_text(world, desc->font) : GFX_NO_TEXT;
    b->desc.image = b->desc.text = b->desc.font = NULL;
    b->desc.rotation = core_quat_normalize(desc->rotation);
    const float *c = desc->color;
    if (c[0] == 0.0f && c[1] == 0.0f && c[2] == 0.0f && c[3] == 0.0f) {
        b->desc.color[0] = b->desc.color[1] = b->desc.color[2] = b->desc.color[3] = 1.0f;
    }
    return true;
}
