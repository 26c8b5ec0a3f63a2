// corsac.gfx: terrain.
#include "asset/asset.h"
#include "script/bind_gfx.h"
#include "script/internal.h"

#include <string.h>

typedef struct terrain_options {
    bind_numbers heights, step, heights_blend, slopes_blend;
    int64_t columns;
    core_vec3 position;
    float low[4], high[4], steep[4], roughness;
    const char *image;
} terrain_options;
typedef struct terrain_call {
    terrain_options options;
} terrain_call;

static void copy_pair(lua_State *L, const char *name, const bind_numbers *n, float out[2]) {
    if (n->count > 2) {
        bind_error(L, "corsac.gfx.newTerrain: options.%s: expected one or two numbers, got %d",
                   name, (int)n->count);
    }
    if (n->count) {
        out[0] = n->items[0];
        out[1] = n->items[n->count - 1];
    }
}

static int new_terrain(script *s, lua_State *L, void *args) {
    const terrain_options *o = &((terrain_call *)args)->options;
    gfx_terrain_desc d = gfx_terrain_desc_default();
    float step[2] = {1.0f, 1.0f};
    if (o->heights.count % (uint32_t)o->columns != 0) {
        bind_error(L, "corsac.gfx.newTerrain: options.heights: %d numbers are no whole rows of %d",
                   (int)o->heights.count, (int)o->columns);
    }
    copy_pair(L, "step", &o->step, step);
    copy_pair(L, "heightsBlend", &o->heights_blend, d.heights_blend);
    copy_pair(L, "slopesBlend", &o->slopes_blend, d.slopes_blend);
    d.heights = (core_heights_data){.columns = (uint32_t)o->columns,
                                    .rows = o->heights.count / (uint32_t)o->columns,
                                    .step_x = step[0],
                                    .step_z = step[1],
                                    .origin = o->position,
                                    .height = o->heights.items};
    memcpy(d.low, o->low, sizeof d.low);
    memcpy(d.high, o->high, sizeof d.high);
    memcpy(d.steep, o->steep, sizeof d.steep);
    d.roughness = o->roughness;
    d.image = o->image;
    gfx_terrain terrain = gfx_terrain_create(scene_gfx(s->scene), &d);
    if (core_handle_is_null(terrain)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_terrain_type, terrain);
    return 1;
}

static bool terrain_alive(script *s, core_handle h) {
    return scene_gfx_if(s->scene) && gfx_terrain_alive(scene_gfx_if(s->scene), h);
}

typedef struct height_args {
    core_handle self;
    double x, z;
} height_args;
static int get_height(script *s, lua_State *L, void *args) {
    const height_args *a = args;
    float y;
    if (gfx_terrain_height(scene_gfx(s->scene), a->self, (float)a->x, (float)a->z, &y)) {
        lua_pushnumber(L, (double)y);
    } else {
        lua_pushnil(L);
    }
    return 1;
}

static int destroy(script *s, lua_State *L, void *args) {
    if (!gfx_terrain_destroy(scene_gfx(s->scene), *(const core_handle *)args)) {
        bind_fail(L);
    }
    return 0;
}

static const bind_fn terrain_methods[] = {
    {"getHeight", "Height of the surface above a place, nil beside it.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(height_args, x), "", "m"},
               {"z", BIND_NUMBER, BIND_AT(height_args, z), "", "m"}),
     BIND_RETURNS({"y", "number?", "m"}), sizeof(height_args), BIND_RUNNING, .mod = true,
     .cost = 20, .run = get_height},
    {"destroy", "Removes the terrain.", NULL, NULL, sizeof(core_handle), BIND_RUNNING,
     .run = destroy},
    {0}};

const bind_type bind_terrain_type = {"Terrain", "Ground drawn from a field of heights.",
                                     terrain_alive, terrain_methods};

#define COLOR(member, what, r, g, b)                                                               \
    BIND_COLOR, BIND_AT(terrain_options, member), what, .optional = true, .def_vec = {r, g, b}
#define PAIR(member, what, unit, text)                                                             \
    BIND_NUMBERS, BIND_AT(terrain_options, member), what, unit, .optional = true, .def_text = text

static const bind_arg terrain_fields[] = {
    {"heights", BIND_NUMBERS, BIND_AT(terrain_options, heights), "row by row along +Z", "m"},
    {"columns", BIND_INT, BIND_AT(terrain_options, columns), "heights in a row, along +X", NULL,
     BIND_BETWEEN, .min = 2, .max = 8193},
    {"step", PAIR(step, "from point to point along x and z", "m", "1")},
    {"position", BIND_VEC3, BIND_AT(terrain_options, position),
     "where the first point is when its height is 0", "m", .optional = true},
    {"low", COLOR(low, "base colour, linear", 0.18f, 0.27f, 0.08f)},
    {"high", COLOR(high, "base colour of what is high", 0.75f, 0.77f, 0.8f)},
    {"steep", COLOR(steep, "base colour of what is steep", 0.24f, 0.21f, 0.19f)},
    {"heightsBlend", PAIR(heights_blend, "{from, to}: low turns into high", "m", "never")},
    {"slopesBlend",
     PAIR(slopes_blend, "{from, to}, rise over run: flat turns into steep", NULL, "{0.5, 0.9}")},
    {"image", BIND_STRING, BIND_AT(terrain_options, image),
     "image file that multiplies the colours, stretched over the whole", .optional = true},
    {"roughness", BIND_FLOAT, BIND_AT(terrain_options, roughness), "0 is a mirror", NULL,
     BIND_BETWEEN, .max = 1, .optional = true, .def = 0.9},
    {0}};

typedef struct read_args {
    const char *path;
    double low, high;
} read_args;
static int read_heights(script *s, lua_State *L, void *args) {
    const read_args *a = args;
    core_heights_data *h =
        asset_heights_load(scene_vfs(s->scene), a->path, (float)a->low, (float)a->high);
    if (!h) {
        bind_fail(L);
    }
    uint32_t count = h->columns * h->rows, columns = h->columns;
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; ++i) {
        lua_pushnumber(L, (double)h->height[i]);
        lua_rawseti(L, -2, (int)i + 1);
    }
    core_free(h);
    lua_pushnumber(L, columns);
    return 2;
}

static const bind_fn functions[] = {
    {"readHeights",
     "Heights from the grey of an image, of 8 or 16 bits, for newTerrain and for bodies: their "
     "list "
     "and how many are in a row.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(read_args, path), "in the game's folder"},
               {"low", BIND_NUMBER, BIND_AT(read_args, low), "of black", "m"},
               {"high", BIND_NUMBER, BIND_AT(read_args, high), "of white", "m"}),
     BIND_RETURNS({"heights", "number[]", "m"}, {"columns", "integer", NULL}), sizeof(read_args),
     BIND_SIM, .run = read_heights},
    {"newTerrain",
     "Makes ground from a field of heights. It is drawn as finely as gfx.set(\"terrain_error\", "
     "pixels) asks for.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(terrain_call, options), "the terrain",
                .fields = terrain_fields}),
     BIND_RETURNS({"terrain", "corsac.Terrain", NULL}), sizeof(terrain_call), BIND_RUNNING,
     .run = new_terrain},
    {0}};

static const bind_module modules[] = {{"corsac.gfx", "Terrain.", functions}, {0}};
static const bind_type *const types[] = {&bind_terrain_type, NULL};

const bind_room bind_terrain_room = {"terrain", modules, types};
