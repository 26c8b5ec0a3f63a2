// corsac.gfx: lines and shapes of lines in the world, for one frame.
#include "script/internal.h"

#include <string.h>

typedef struct pen_options {
    float color[4], width;
    bool on_top;
} pen_options;

static gfx_pen pen_of(const pen_options *o) {
    gfx_pen pen = gfx_pen_default();
    memcpy(pen.color, o->color, sizeof pen.color);
    pen.width = o->width;
    pen.on_top = o->on_top;
    return pen;
}

typedef struct two_call {
    core_vec3 a, b;
    pen_options pen;
} two_call;

static int draw_line(script *s, lua_State *L, void *args) {
    const two_call *c = args;
    gfx_pen pen = pen_of(&c->pen);
    (void)L;
    gfx_draw_line(scene_gfx(s->scene), c->a, c->b, &pen);
    return 0;
}
static int draw_arrow(script *s, lua_State *L, void *args) {
    const two_call *c = args;
    gfx_pen pen = pen_of(&c->pen);
    (void)L;
    gfx_draw_arrow(scene_gfx(s->scene), c->a, c->b, &pen);
    return 0;
}

typedef struct path_call {
    bind_numbers points;
    pen_options pen;
} path_call;
static int draw_path(script *s, lua_State *L, void *args) {
    const path_call *c = args;
    gfx_pen pen = pen_of(&c->pen);
    if (c->points.count % 3 != 0) {
        bind_error(L, "corsac.gfx.drawPath: points: expected x, y, z of each, got %d numbers",
                   (int)c->points.count);
    }
    gfx_draw_path(scene_gfx(s->scene), (const core_vec3 *)c->points.items, c->points.count / 3,
                  &pen);
    return 0;
}

typedef struct box_call {
    core_vec3 center, size;
    pen_options pen;
    core_quat rotation;
} box_call;
static int draw_box(script *s, lua_State *L, void *args) {
    const box_call *c = args;
    gfx_pen pen = pen_of(&c->pen);
    (void)L;
    gfx_draw_box(scene_gfx(s->scene), c->center, c->rotation, core_v3_scale(c->size, 0.5f), &pen);
    return 0;
}

typedef struct sphere_call {
    core_vec3 center;
    double radius;
    pen_options pen;
} sphere_call;
static int draw_sphere(script *s, lua_State *L, void *args) {
    const sphere_call *c = args;
    gfx_pen pen = pen_of(&c->pen);
    (void)L;
    gfx_draw_sphere(scene_gfx(s->scene), c->center, (float)c->radius, &pen);
    return 0;
}

typedef struct capsule_call {
    core_vec3 a, b;
    double radius;
    pen_options pen;
} capsule_call;
static int draw_capsule(script *s, lua_State *L, void *args) {
    const capsule_call *c = args;
    gfx_pen pen = pen_of(&c->pen);
    (void)L;
    gfx_draw_capsule(scene_gfx(s->scene), c->a, c->b, (float)c->radius, &pen);
    return 0;
}

typedef struct grid_call {
    core_vec3 center;
    double size;
    int64_t cells;
    pen_options pen;
} grid_call;
static int draw_grid(script *s, lua_State *L, void *args) {
    const grid_call *c = args;
    gfx_pen pen = pen_of(&c->pen);
    (void)L;
    gfx_draw_grid(scene_gfx(s->scene), c->center, (float)c->size, (uint32_t)c->cells, &pen);
    return 0;
}

// ---- declarations ----

static const bind_arg pen_fields[] = {
    {"color", BIND_COLOR, BIND_AT(pen_options, color), "linear", .optional = true,
     .def_vec = {1, 1, 1}},
    {"width", BIND_FLOAT, BIND_AT(pen_options, width), "", "pixels", BIND_BETWEEN, .min = 0.5,
     .max = 64, .optional = true, .def = 1.5},
    {"onTop", BIND_BOOL, BIND_AT(pen_options, on_top), "seen through everything", .optional = true},
    {0}};
#define PEN(T)                                                                                     \
    {                                                                                              \
        "pen", BIND_OPTIONS, BIND_AT(T, pen), "how",                                               \
            .optional = true, .def_text = "thin and white", .fields = pen_fields                   \
    }
#define POINT(T, member, what)                                                                     \
    { #member, BIND_VEC3, BIND_AT(T, member), what, "m" }
#define RADIUS(T)                                                                                  \
    { "radius", BIND_NUMBER, BIND_AT(T, radius), "", "m", BIND_POSITIVE }
#define DRAWS(T, function) NULL, sizeof(T), BIND_DRAW, .mod = true, .cost = 100, .run = function

static const bind_fn functions[] = {
    {"drawLine", "Draws a line in the world, in this frame.",
     BIND_ARGS(POINT(two_call, a, "start"), POINT(two_call, b, "end"), PEN(two_call)),
     DRAWS(two_call, draw_line)},
    {"drawArrow", "Draws an arrow in the world, in this frame.",
     BIND_ARGS(POINT(two_call, a, "start"), POINT(two_call, b, "tip"), PEN(two_call)),
     DRAWS(two_call, draw_arrow)},
    {"drawPath", "Draws lines from point to point in the world, in this frame.",
     BIND_ARGS({"points", BIND_NUMBERS, BIND_AT(path_call, points), "x, y, z of each", "m"},
               PEN(path_call)),
     DRAWS(path_call, draw_path)},
    {"drawBox", "Draws the edges of a box in the world, in this frame.",
     BIND_ARGS(POINT(box_call, center, ""), POINT(box_call, size, "whole edges"), PEN(box_call),
               {"rotation", BIND_QUAT, BIND_AT(box_call, rotation), "", .optional = true}),
     DRAWS(box_call, draw_box)},
    {"drawSphere", "Draws three circles of a sphere in the world, in this frame.",
     BIND_ARGS(POINT(sphere_call, center, ""), RADIUS(sphere_call), PEN(sphere_call)),
     DRAWS(sphere_call, draw_sphere)},
    {"drawCapsule", "Draws the outline of a capsule in the world, in this frame.",
     BIND_ARGS(POINT(capsule_call, a, "centre of one end"),
               POINT(capsule_call, b, "centre of the other"), RADIUS(capsule_call),
               PEN(capsule_call)),
     DRAWS(capsule_call, draw_capsule)},
    {"drawGrid", "Draws a level grid in the world, in this frame.",
     BIND_ARGS(POINT(grid_call, center, ""),
               {"size", BIND_NUMBER, BIND_AT(grid_call, size), "whole edge", "m", BIND_POSITIVE},
               {"cells", BIND_INT, BIND_AT(grid_call, cells), "along an edge", NULL, BIND_BETWEEN,
                .min = 1, .max = 1000},
               PEN(grid_call)),
     DRAWS(grid_call, draw_grid)},
    {0}};

static const bind_module modules[] = {
    {"corsac.gfx", "Lines and shapes in the world, for one frame.", functions}, {0}};

const bind_room bind_marks_room = {"marks", modules, NULL};
