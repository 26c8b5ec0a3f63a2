// corsac.gfx: particles, and pictures and texts in the world.
#include "script/bind_body.h"
#include "script/bind_gfx.h"
#include "script/internal.h"
#include "script/mod.h"

#include <string.h>

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// ---- emitters ----

typedef struct emitter_options {
    core_vec3 position, extent, acceleration, wind;
    core_quat rotation;
    int shape;
    float rate, spread, drag, size_vary;
    int64_t burst, capacity, seed, columns, rows;
    bind_numbers life, speed, spin, size, colors;
    const char *image;
    bool additive;
} emitter_options;
typedef struct emitter_call {
    emitter_options options;
} emitter_call;

// One number stands for both ends.
static void copy_range(lua_State *L, const char *name, const bind_numbers *n, float out[2]) {
    if (n->count > 2) {
        bind_error(L, "corsac.gfx.newEmitter: options.%s: expected {least, most}, got %d numbers",
                   name, (int)n->count);
    }
    if (n->count) {
        out[0] = n->items[0];
        out[1] = n->items[n->count - 1];
    }
}

static uint32_t copy_keys(lua_State *L, const char *name, const bind_numbers *n, uint32_t width,
                          float *out, uint32_t keys) {
    if (n->count == 0) {
        return keys;
    }
    if (n->count % width != 0 || n->count / width > GFX_EMITTER_KEYS) {
        bind_error(L,
                   "corsac.gfx.newEmitter: options.%s: expected 1 to %d times %d numbers, got %d",
                   name, GFX_EMITTER_KEYS, (int)width, (int)n->count);
    }
    memcpy(out, n->items, n->count * sizeof *out);
    return n->count / width;
}

static int new_emitter(script *s, lua_State *L, void *args) {
    const emitter_options *o = &((emitter_call *)args)->options;
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.position = o->position, d.rotation = o->rotation;
    d.shape = (gfx_emit_shape)o->shape, d.extent = o->extent;
    d.rate = o->rate;
    d.burst = (uint32_t)o->burst, d.capacity = (uint32_t)o->capacity;
    d.seed = (uint64_t)o->seed;
    copy_range(L, "life", &o->life, d.life);
    double alive = (double)d.burst + (double)d.rate * (double)d.life[1];
    script_mod_size(s, L, "particles", alive > d.capacity ? alive : d.capacity, 4096);
    copy_range(L, "speed", &o->speed, d.speed);
    copy_range(L, "spin", &o->spin, d.spin);
    d.spread = o->spread, d.drag = o->drag;
    d.acceleration = o->acceleration, d.wind = o->wind;
    d.size_keys = copy_keys(L, "size", &o->size, 1, d.size, d.size_keys);
    d.color_keys = copy_keys(L, "colors", &o->colors, 4, d.color[0], d.color_keys);
    d.size_vary = o->size_vary;
    d.image = o->image;
    d.frames[0] = (uint32_t)o->columns, d.frames[1] = (uint32_t)o->rows;
    d.additive = o->additive;
    gfx_emitter emitter = gfx_emitter_create(scene_gfx(s->scene), &d);
    if (core_handle_is_null(emitter)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_emitter_type, emitter);
    return 1;
}

static bool emitter_alive(script *s, core_handle h) {
    return scene_gfx_if(s->scene) && gfx_emitter_alive(scene_gfx_if(s->scene), h);
}

typedef struct pose_args {
    core_handle self;
    double x, y, z;
    core_quat rotation;
} pose_args;
static int set_position(script *s, lua_State *L, void *args) {
    const pose_args *a = args;
    return done(L,
                gfx_emitter_set_pose(scene_gfx(s->scene), a->self,
                                     core_v3((float)a->x, (float)a->y, (float)a->z), a->rotation));
}
typedef struct rate_args {
    core_handle self;
    double rate;
} rate_args;
static int set_rate(script *s, lua_State *L, void *args) {
    const rate_args *a = args;
    return done(L, gfx_emitter_set_rate(scene_gfx(s->scene), a->self, (float)a->rate));
}
typedef struct burst_args {
    core_handle self;
    int64_t count;
} burst_args;
static int burst(script *s, lua_State *L, void *args) {
    const burst_args *a = args;
    return done(L, gfx_emitter_burst(scene_gfx(s->scene), a->self, (uint32_t)a->count));
}
typedef struct follow_args {
    core_handle self, entity;
} follow_args;
static int follow(script *s, lua_State *L, void *args) {
    const follow_args *a = args;
    return done(L, scene_set_emitter(s->scene, a->entity, a->self));
}
static int get_count(script *s, lua_State *L, void *args) {
    lua_pushnumber(L,
                   gfx_emitter_particles(scene_gfx(s->scene), *(const core_handle *)args, NULL, 0));
    return 1;
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, gfx_emitter_destroy(scene_gfx(s->scene), *(const core_handle *)args));
}

static const bind_fn emitter_methods[] = {
    {"setPosition", "Moves the emitter; births until the next step are spread over the way.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(pose_args, x), "", "m"},
               {"y", BIND_NUMBER, BIND_AT(pose_args, y), "", "m"},
               {"z", BIND_NUMBER, BIND_AT(pose_args, z), "", "m"},
               {"rotation", BIND_QUAT, BIND_AT(pose_args, rotation),
                "takes +Y to where particles fly", .optional = true}),
     NULL, sizeof(pose_args), BIND_RUNNING, .mod = true, .cost = 8, .run = set_position},
    {"setRate", "Changes how many are born.",
     BIND_ARGS({"rate", BIND_NUMBER, BIND_AT(rate_args, rate), "", "1/s", BIND_NOT_NEGATIVE}), NULL,
     sizeof(rate_args), BIND_RUNNING, .mod = true, .cost = 8, .run = set_rate},
    {"burst", "Gives birth to many at once.",
     BIND_ARGS(
         {"count", BIND_INT, BIND_AT(burst_args, count), "", NULL, BIND_BETWEEN, .max = 1048576}),
     NULL, sizeof(burst_args), BIND_RUNNING, .mod = true, .cost = 500, .run = burst},
    {"follow", "Goes with an entity from the next step on; without it nothing more is born.",
     BIND_ARGS(
         {"entity", BIND_OBJECT, BIND_AT(follow_args, entity), "", .type = &bind_entity_type}),
     NULL, sizeof(follow_args), BIND_RUNNING, .run = follow},
    {"getCount", "How many of its particles are alive.", NULL,
     BIND_RETURNS({"count", "integer", NULL}), sizeof(core_handle), BIND_VIEW, .run = get_count},
    {"destroy", "Removes the emitter and its particles.", NULL, NULL, sizeof(core_handle),
     BIND_RUNNING, .mod = true, .cost = 20, .run = destroy},
    {0}};

const bind_type bind_emitter_type = {"Emitter", "A source of particles.", emitter_alive,
                                     emitter_methods};

// ---- pictures and texts ----

typedef struct board_options {
    core_vec3 position;
    core_quat rotation;
    int facing;
    float width, height, color[4];
    const char *font;
    bind_numbers source;
    bool additive;
} board_options;
typedef struct board_call {
    const char *what;
    board_options options;
} board_call;

static gfx_board_desc board_desc(const board_options *o) {
    gfx_board_desc d = gfx_board_desc_default();
    d.position = o->position, d.rotation = o->rotation;
    d.facing = (gfx_facing)o->facing;
    d.width = o->width, d.height = o->height;
    d.font = o->font;
    d.additive = o->additive;
    memcpy(d.color, o->color, sizeof d.color);
    return d;
}

static int draw_sprite(script *s, lua_State *L, void *args) {
    const board_call *call = args;
    const bind_numbers *source = &call->options.source;
    gfx_board_desc d = board_desc(&call->options);
    d.image = call->what;
    if (source->count && source->count != 4) {
        bind_error(L,
                   "corsac.gfx.drawSprite: options.source: expected {x, y, width, height}, got "
                   "%d numbers",
                   (int)source->count);
    }
    if (source->count) {
        memcpy(d.source, source->items, sizeof d.source);
    }
    return done(L, gfx_draw_board(scene_gfx(s->scene), &d));
}

static int draw_text(script *s, lua_State *L, void *args) {
    const board_call *call = args;
    gfx_board_desc d = board_desc(&call->options);
    d.text = call->what;
    return done(L, gfx_draw_board(scene_gfx(s->scene), &d));
}

// ---- declarations ----

#define SHAPES  "point|sphere|box"
#define FACINGS "viewer|upright|fixed"
#define FIELD(T, member, what, unit)                                                               \
    BIND_FLOAT, BIND_AT(T, member), what, unit, BIND_NOT_NEGATIVE, .optional = true
#define NUMBERS(T, member, what, unit, text)                                                       \
    BIND_NUMBERS, BIND_AT(T, member), what, unit, .optional = true, .def_text = text
#define COUNT(T, member, what, most)                                                               \
    BIND_INT, BIND_AT(T, member), what, NULL, BIND_BETWEEN, .max = most, .optional = true

static const bind_arg emitter_fields[] = {
    {"position", BIND_VEC3, BIND_AT(emitter_options, position), "", "m", .optional = true},
    {"rotation", BIND_QUAT, BIND_AT(emitter_options, rotation), "takes +Y to where particles fly",
     .optional = true},
    {"shape", BIND_ENUM, BIND_AT(emitter_options, shape), "where they are born", .optional = true,
     .values = SHAPES},
    {"extent", BIND_VEC3, BIND_AT(emitter_options, extent), "half, of a sphere or box", "m",
     .optional = true},
    {"rate", FIELD(emitter_options, rate, "births", "1/s"), .def = 20},
    {"burst", COUNT(emitter_options, burst, "births at once", 1048576)},
    {"capacity", COUNT(emitter_options, capacity, "alive at once; the oldest make room", 1048576),
     .def_text = "what rate, life and burst need"},
    {"life", NUMBERS(emitter_options, life, "{least, most}", "s", "{1, 1}")},
    {"speed", NUMBERS(emitter_options, speed, "{least, most}", "m/s", "{1, 1}")},
    {"spread",
     FIELD(emitter_options, spread, "half angle round the direction; pi: everywhere", "rad")},
    {"acceleration", BIND_VEC3, BIND_AT(emitter_options, acceleration), "", "m/s^2",
     .optional = true},
    {"wind", BIND_VEC3, BIND_AT(emitter_options, wind), "speed that drag leads to", "m/s",
     .optional = true},
    {"drag", FIELD(emitter_options, drag, "", "1/s")},
    {"spin", NUMBERS(emitter_options, spin, "{least, most}; then the first angle is random",
                     "rad/s", "{0, 0}")},
    {"size",
     NUMBERS(emitter_options, size, "edge, over life: up to 8 evenly spaced", "m", "{0.1}")},
    {"sizeVary", BIND_FLOAT, BIND_AT(emitter_options, size_vary),
     "part by which sizes of particles differ", NULL, BIND_BETWEEN, .max = 1, .optional = true},
    {"colors", NUMBERS(emitter_options, colors,
                       "linear r, g, b, a over life: up to 8 times four numbers", NULL, "white")},
    {"image", BIND_STRING, BIND_AT(emitter_options, image), "image file; none: a soft disc",
     .optional = true},
    {"columns", COUNT(emitter_options, columns, "of frames in the image, shown over life", 64),
     .min = 1, .def = 1},
    {"rows", COUNT(emitter_options, rows, "of frames in the image", 64), .min = 1, .def = 1},
    {"additive", BIND_BOOL, BIND_AT(emitter_options, additive),
     "light that is added, as of fire; else it covers, as smoke", .optional = true},
    {"seed", COUNT(emitter_options, seed, "of its random numbers", 9007199254740991.0)},
    {0}};

static const bind_arg board_fields[] = {
    {"position", BIND_VEC3, BIND_AT(board_options, position), "of its middle", "m"},
    {"height", BIND_FLOAT, BIND_AT(board_options, height), "of a text: of a line", "m",
     BIND_POSITIVE, .optional = true, .def = 1},
    {"width", FIELD(board_options, width, "of a picture", "m"),
     .def_text = "as the picture has it"},
    {"facing", BIND_ENUM, BIND_AT(board_options, facing),
     "turns to the viewer, turns about +Y only, or stands as rotation says", .optional = true,
     .values = FACINGS},
    {"rotation", BIND_QUAT, BIND_AT(board_options, rotation), "fixed: from a front along +Z",
     .optional = true},
    {"color", BIND_COLOR, BIND_AT(board_options, color), "linear", .optional = true,
     .def_vec = {1, 1, 1}},
    {"font", BIND_STRING, BIND_AT(board_options, font), "as for text", .optional = true,
     .def_text = "mono"},
    {"source", NUMBERS(board_options, source, "{x, y, width, height} of the part of the image",
                       "texels", "all of it")},
    {"additive", BIND_BOOL, BIND_AT(board_options, additive), "light that is added",
     .optional = true},
    {0}};
#define BOARD_ARGS(title, doc)                                                                     \
    BIND_ARGS({title, BIND_STRING, BIND_AT(board_call, what), doc},                                \
              {"options", BIND_OPTIONS, BIND_AT(board_call, options), "where and how",             \
               .fields = board_fields}),                                                           \
        NULL, sizeof(board_call), BIND_DRAW, .mod = true, .cost = 200

static const bind_fn functions[] = {
    {"newEmitter",
     "Makes a source of particles. They change no simulation, and a particle's way depends on its "
     "birth and its age alone.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(emitter_call, options), "the emitter",
                .fields = emitter_fields}),
     BIND_RETURNS({"emitter", "corsac.Emitter", NULL}), sizeof(emitter_call), BIND_RUNNING,
     .mod = true, .cost = 1000, .run = new_emitter},
    {"drawSprite", "Draws an image file in the world, in this frame.",
     BOARD_ARGS("path", "in the game's folder"), .run = draw_sprite},
    {"drawText", "Writes a text in the world, in this frame.",
     BOARD_ARGS("text", "UTF-8; \\n starts a line"), .run = draw_text},
    {0}};

static const bind_module modules[] = {
    {"corsac.gfx", "Particles, and pictures and texts in the world.", functions}, {0}};
static const bind_type *const types[] = {&bind_emitter_type, NULL};

const bind_room bind_emitter_room = {"emitter", modules, types};
