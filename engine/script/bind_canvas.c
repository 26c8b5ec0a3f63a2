// corsac.gfx: what is drawn over the frame beside plain text and rectangles, and where things are
// on the screen. corsac.ui: menus, written in Lua (scripts/corsac/ui.lua).
#include "script/internal.h"

#include <string.h>

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// ---- shapes ----

typedef struct round_args {
    double x, y, w, h, radius, border;
    float color[4];
} round_args;
static int round_rect(script *s, lua_State *L, void *args) {
    const round_args *a = args;
    (void)L;
    gfx_round_rect(scene_gfx(s->scene), (float)a->x, (float)a->y, (float)a->w, (float)a->h,
                   (float)a->radius, (float)a->border, a->color);
    return 0;
}

typedef struct line_args {
    double x0, y0, x1, y1, width;
    float color[4];
} line_args;
static int line(script *s, lua_State *L, void *args) {
    const line_args *a = args;
    (void)L;
    gfx_line(scene_gfx(s->scene), (float)a->x0, (float)a->y0, (float)a->x1, (float)a->y1,
             (float)a->width, a->color);
    return 0;
}

// ---- sprites ----

typedef struct sprite_options {
    float x, y, w, h, angle, pivot_x, pivot_y;
    bind_numbers source;
    float color[4];
} sprite_options;
typedef struct sprite_call {
    const char *path;
    sprite_options options;
} sprite_call;

static int sprite(script *s, lua_State *L, void *args) {
    const sprite_call *call = args;
    const sprite_options *o = &call->options;
    gfx_sprite_desc d = gfx_sprite_desc_default();
    d.path = call->path;
    d.x = o->x, d.y = o->y, d.w = o->w, d.h = o->h;
    d.angle = o->angle;
    d.pivot[0] = o->pivot_x, d.pivot[1] = o->pivot_y;
    memcpy(d.color, o->color, sizeof d.color);
    if (o->source.count && o->source.count != 4) {
        bind_error(L,
                   "corsac.gfx.sprite: options.source: expected {x, y, width, height}, got %d "
                   "numbers",
                   (int)o->source.count);
    }
    if (o->source.count) {
        memcpy(d.source, o->source.items, sizeof d.source);
    }
    return done(L, gfx_sprite(scene_gfx(s->scene), &d));
}

// ---- text ----

typedef struct text_options {
    float x, y, size, width, align, color[4];
    const char *font;
} text_options;
typedef struct text_call {
    const char *text;
    text_options options;
} text_call;

static gfx_text_desc text_desc(const text_call *call) {
    const text_options *o = &call->options;
    gfx_text_desc d = gfx_text_desc_default();
    d.text = call->text;
    d.font = o->font;
    d.x = o->x, d.y = o->y;
    d.size = o->size, d.width = o->width, d.align = o->align;
    memcpy(d.color, o->color, sizeof d.color);
    return d;
}

static int text(script *s, lua_State *L, void *args) {
    gfx_text_desc d = text_desc(args);
    return done(L, gfx_text(scene_gfx(s->scene), &d));
}

static int measure(script *s, lua_State *L, void *args) {
    gfx_text_desc d = text_desc(args);
    gfx_text_box box;
    if (!gfx_text_measure(scene_gfx(s->scene), &d, &box)) {
        bind_fail(L);
    }
    lua_pushnumber(L, (double)box.width);
    lua_pushnumber(L, (double)box.height);
    lua_pushnumber(L, box.lines);
    return 3;
}

// ---- clipping ----

typedef struct clip_args {
    double x, y, w, h;
} clip_args;
static int push_clip(script *s, lua_State *L, void *args) {
    const clip_args *a = args;
    return done(
        L, gfx_clip_push(scene_gfx(s->scene), (float)a->x, (float)a->y, (float)a->w, (float)a->h));
}
static int pop_clip(script *s, lua_State *L, void *args) {
    (void)args;
    return done(L, gfx_clip_pop(scene_gfx(s->scene)));
}

// ---- places on the screen ----

static void screen_size(const script *s, float *width, float *height) {
    uint32_t w = 1280, h = 720;
    if (s->host.size) {
        s->host.size(s->host.ctx, &w, &h);
    }
    *width = (float)w, *height = (float)h;
}

static int get_size(script *s, lua_State *L, void *args) {
    (void)args;
    float width, height;
    screen_size(s, &width, &height);
    lua_pushnumber(L, (double)width);
    lua_pushnumber(L, (double)height);
    return 2;
}

typedef struct ray_args {
    double x, y;
} ray_args;
static int get_ray(script *s, lua_State *L, void *args) {
    const ray_args *a = args;
    gfx_camera camera = gfx_world_camera(scene_gfx(s->scene));
    float width, height;
    core_vec3 origin, direction;
    screen_size(s, &width, &height);
    gfx_camera_ray(&camera, width, height, (float)a->x, (float)a->y, &origin, &direction);
    bind_push_vec3(L, origin);
    bind_push_vec3(L, direction);
    return 6;
}

typedef struct point_args {
    double x, y, z;
} point_args;
static int project(script *s, lua_State *L, void *args) {
    const point_args *a = args;
    gfx_camera camera = gfx_world_camera(scene_gfx(s->scene));
    float width, height;
    screen_size(s, &width, &height);
    bind_push_vec3(L, gfx_camera_project(&camera, width, height,
                                         core_v3((float)a->x, (float)a->y, (float)a->z)));
    return 3;
}

// ---- menus ----

typedef struct lua_args {
    int value;
} lua_args;

// ---- declarations ----

#define PIXELS(T, member, what)                                                                    \
    { #member, BIND_NUMBER, BIND_AT(T, member), what, "pixels" }
#define PIXELS_FIELD(T, member, what)                                                              \
#member, BIND_FLOAT, BIND_AT(T, member), what, "pixels", .optional = true
#define COLOR_LAST(T)                                                                              \
    {                                                                                              \
        "color", BIND_COLOR, BIND_AT(T, color), "sRGB", .optional = true, .def_vec = { 1, 1, 1 }   \
    }

static const bind_arg sprite_fields[] = {
    {PIXELS_FIELD(sprite_options, x, "where the pivot lies")},
    {PIXELS_FIELD(sprite_options, y, "where the pivot lies")},
    {PIXELS_FIELD(sprite_options, w, "width"), .def_text = "of the source"},
    {PIXELS_FIELD(sprite_options, h, "height"), .def_text = "of the source"},
    {"source", BIND_NUMBERS, BIND_AT(sprite_options, source),
     "{x, y, width, height} of the part of the image", "texels", .optional = true,
     .def_text = "all of it"},
    {"pivotX", BIND_FLOAT, BIND_AT(sprite_options, pivot_x), "share of the width",
     .optional = true},
    {"pivotY", BIND_FLOAT, BIND_AT(sprite_options, pivot_y), "share of the height",
     .optional = true},
    {"angle", BIND_FLOAT, BIND_AT(sprite_options, angle), "clockwise about the pivot", "rad",
     .optional = true},
    COLOR_LAST(sprite_options),
    {0}};

static const bind_arg text_fields[] = {
    {PIXELS_FIELD(text_options, x, "left")},
    {PIXELS_FIELD(text_options, y, "top")},
    {"size", BIND_FLOAT, BIND_AT(text_options, size), "height of a line", "pixels", BIND_BETWEEN,
     .min = 4, .max = 256, .optional = true, .def = 18},
    {"width", BIND_FLOAT, BIND_AT(text_options, width), "lines break to stay within", "pixels",
     BIND_NOT_NEGATIVE, .optional = true, .def_text = "no breaks"},
    {"align", BIND_FLOAT, BIND_AT(text_options, align),
     "of lines in the width, or about x without one: 0 left, 0.5 middle, 1 right", NULL,
     BIND_BETWEEN, .max = 1, .optional = true},
    {"font", BIND_STRING, BIND_AT(text_options, font),
     "\"mono\", \"sans\", or a TrueType file of the game", .optional = true, .def_text = "mono"},
    COLOR_LAST(text_options),
    {0}};
#define TEXT_ARGS                                                                                  \
    BIND_ARGS({"text", BIND_STRING, BIND_AT(text_call, text), "UTF-8"},                            \
              {"options", BIND_OPTIONS, BIND_AT(text_call, options), "where and how",              \
               .optional = true, .def_text = "all defaults", .fields = text_fields})

static const bind_fn functions[] = {
    {"roundRect", "Fills a rectangle with smooth, rounded corners over the frame, or frames it.",
     BIND_ARGS(PIXELS(round_args, x, "left"), PIXELS(round_args, y, "top"),
               PIXELS(round_args, w, "width"), PIXELS(round_args, h, "height"),
               {"radius", BIND_NUMBER, BIND_AT(round_args, radius), "of the corners", "pixels",
                BIND_NOT_NEGATIVE},
               COLOR_LAST(round_args),
               {"border", BIND_NUMBER, BIND_AT(round_args, border),
                "width of a frame on the inside; 0: filled", "pixels", BIND_NOT_NEGATIVE,
                .optional = true}),
     NULL, sizeof(round_args), BIND_DRAW, .mod = true, .cost = 50, .run = round_rect},
    {"line", "Draws a line over the frame.",
     BIND_ARGS(PIXELS(line_args, x0, "start"), PIXELS(line_args, y0, "start"),
               PIXELS(line_args, x1, "end"), PIXELS(line_args, y1, "end"),
               {"width", BIND_NUMBER, BIND_AT(line_args, width), "", "pixels", BIND_POSITIVE,
                .optional = true, .def = 1},
               COLOR_LAST(line_args)),
     NULL, sizeof(line_args), BIND_DRAW, .mod = true, .cost = 50, .run = line},
    {"sprite", "Draws an image file, or a part of it, turned and tinted, over the frame.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(sprite_call, path), "in the game's folder"},
               {"options", BIND_OPTIONS, BIND_AT(sprite_call, options), "where and how",
                .optional = true, .def_text = "all defaults", .fields = sprite_fields}),
     NULL, sizeof(sprite_call), BIND_DRAW, .mod = true, .cost = 200, .run = sprite},
    {"text", "Writes text over the frame, with a font, lines that break, and alignment.", TEXT_ARGS,
     NULL, sizeof(text_call), BIND_DRAW, .mod = true, .cost = 200, .run = text},
    {"measure", "What a text will take: width and height in pixels, and lines.", TEXT_ARGS,
     BIND_RETURNS({"width", "number", "pixels"}, {"height", "number", "pixels"},
                  {"lines", "integer", NULL}),
     sizeof(text_call), BIND_RUNNING, .mod = true, .cost = 200, .run = measure},
    {"pushClip", "What follows is drawn only inside a rectangle, and inside those pushed before.",
     BIND_ARGS(PIXELS(clip_args, x, "left"), PIXELS(clip_args, y, "top"),
               PIXELS(clip_args, w, "width"), PIXELS(clip_args, h, "height")),
     NULL, sizeof(clip_args), BIND_DRAW, .run = push_clip},
    {"popClip", "Ends what the last pushClip began.", NULL, NULL, 0, BIND_DRAW, .run = pop_clip},
    {"getSize", "Size of the frame.", NULL,
     BIND_RETURNS({"width", "number", "pixels"}, {"height", "number", "pixels"}), 0, BIND_RUNNING,
     .mod = true, .cost = 2, .run = get_size},
    {"getRay", "The ray through a point of the frame: its origin and unit direction.",
     BIND_ARGS(PIXELS(ray_args, x, "from the left"), PIXELS(ray_args, y, "from the top")),
     BIND_RETURNS({"x", "number", "m"}, {"y", "number", "m"}, {"z", "number", "m"},
                  {"dx", "number", NULL}, {"dy", "number", NULL}, {"dz", "number", NULL}),
     sizeof(ray_args), BIND_VIEW, .run = get_ray},
    {"project", "Where a point of the world is in the frame, and how far ahead of the camera.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(point_args, x), "", "m"},
               {"y", BIND_NUMBER, BIND_AT(point_args, y), "", "m"},
               {"z", BIND_NUMBER, BIND_AT(point_args, z), "", "m"}),
     BIND_RETURNS({"x", "number", "pixels"}, {"y", "number", "pixels"}, {"depth", "number", "m"}),
     sizeof(point_args), BIND_VIEW, .run = project},
    {0}};

static const bind_fn ui_functions[] = {
    {"newPanel",
     "Makes a menu: a column of widgets with focus by pointer, keys and gamepad. Give it events "
     "with panel:event(...) and draw it with panel:draw(); panel:get(name), panel:set(name, "
     "value), "
     "panel:focus(name), panel:show(on), panel:isShown().",
     BIND_ARGS({"options", BIND_TABLE, BIND_AT(lua_args, value),
                "x, y, width, height, title, theme, shown, and widgets as list items: {type = "
                "\"label|button|toggle|slider|list|field|gap\", name, text, value, ...}"}),
     BIND_RETURNS({"panel", "corsac.Panel", NULL}), sizeof(lua_args), BIND_RUNNING | BIND_TOP,
     .run = NULL},
    {0}};

static const bind_module modules[] = {
    {"corsac.gfx", "Shapes, sprites and text over the frame; places on the screen.", functions},
    {"corsac.ui", "Menus of buttons, sliders, lists and text fields.", ui_functions},
    {0}};

const bind_room bind_canvas_room = {"canvas", modules, NULL};
