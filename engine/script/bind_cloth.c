// corsac.phys.newCloth, newRope and the methods of both.
#include "script/bind_cloth.h"

#include "script/bind_body.h"
#include "script/bind_region.h"
#include "script/internal.h"
#include "script/mod.h"

typedef struct cloth_options { // a rope has count, from and to
    int64_t columns, rows, substeps;
    core_vec3 position, across, down;
    float mass, radius, stretch, shear, bend, friction, damping, drag, gravity_scale, tear_force;
    const char *layer;
} cloth_options;
typedef struct cloth_call {
    cloth_options options;
} cloth_call;

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

static int make(script *s, lua_State *L, const cloth_options *o, int64_t columns, int64_t rows,
                core_vec3 down) {
    phys_cloth_desc d = phys_cloth_desc_default();
    d.columns = (uint32_t)columns;
    d.rows = (uint32_t)rows;
    d.origin = o->position;
    d.across = o->across;
    d.down = down;
    d.mass = o->mass;
    d.radius = o->radius;
    d.stretch = o->stretch;
    d.shear = o->shear;
    d.bend = o->bend;
    d.friction = o->friction;
    d.damping = o->damping;
    d.drag = o->drag;
    d.gravity_scale = o->gravity_scale;
    d.tear_force = o->tear_force;
    d.substeps = (uint32_t)o->substeps;
    d.layer = o->layer ? bind_layer(s, L, o->layer) : 0;
    script_mod_size(s, L, "particles of cloth", (double)columns * (double)rows, 1024);
    phys_cloth cloth = phys_cloth_create(scene_phys(s->scene), &d);
    if (core_handle_is_null(cloth)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_cloth_type, cloth);
    return 1;
}

static int new_cloth(script *s, lua_State *L, void *args) {
    const cloth_options *o = &((cloth_call *)args)->options;
    return make(s, L, o, o->columns, o->rows, o->down);
}
static int new_rope(script *s, lua_State *L, void *args) {
    cloth_options o = ((cloth_call *)args)->options;
    core_vec3 to = o.across;
    o.across = core_v3(0, 0, 0);
    return make(s, L, &o, 1, o.rows, core_v3_sub(to, o.position));
}

static bool cloth_alive(script *s, core_handle h) {
    phys_world *world = scene_phys_if(s->scene);
    return world && phys_cloth_alive(world, h);
}

// Lua counts columns and rows from 1; what is beyond becomes a number that the room refuses.
static uint32_t from_one(int64_t n) {
    return n > 0 && n < UINT32_MAX ? (uint32_t)n - 1 : UINT32_MAX;
}

typedef struct hold_args {
    core_handle self, body;
    int64_t column, row;
} hold_args;
static int hold(script *s, lua_State *L, void *args) {
    const hold_args *a = args;
    phys_world *w = scene_phys(s->scene);
    phys_cloth_view v;
    uint32_t c = from_one(a->column), r = from_one(a->row);
    core_vec3 here = {0, 0, 0};
    if (phys_cloth_read(w, a->self, &v) && c < v.columns && r < v.rows) {
        uint32_t i = r * v.columns + c;
        here = core_v3(v.x[i], v.y[i], v.z[i]);
    }
    return done(L, phys_cloth_hold(w, a->self, c, r, a->body, here));
}

typedef struct place_args {
    core_handle self;
    int64_t column, row;
    double x, y, z;
} place_args;
static core_vec3 vector_of(const place_args *a) {
    return core_v3((float)a->x, (float)a->y, (float)a->z);
}
static int pin(script *s, lua_State *L, void *args) {
    const place_args *a = args;
    return done(L, phys_cloth_hold(scene_phys(s->scene), a->self, from_one(a->column),
                                   from_one(a->row), CORE_NULL_HANDLE, vector_of(a)));
}
static int push(script *s, lua_State *L, void *args) {
    const place_args *a = args;
    return done(L, phys_cloth_push(scene_phys(s->scene), a->self, from_one(a->column),
                                   from_one(a->row), vector_of(a)));
}
static int release(script *s, lua_State *L, void *args) {
    const place_args *a = args;
    return done(L, phys_cloth_release(scene_phys(s->scene), a->self, from_one(a->column),
                                      from_one(a->row)));
}

static phys_cloth_view read_view(script *s, lua_State *L, core_handle self) {
    phys_cloth_view v;
    if (!phys_cloth_read(scene_phys(s->scene), self, &v)) {
        bind_fail(L);
    }
    return v;
}
static int get_point(script *s, lua_State *L, void *args) {
    const place_args *a = args;
    phys_cloth_view v = read_view(s, L, a->self);
    uint32_t c = from_one(a->column), r = from_one(a->row);
    if (c >= v.columns || r >= v.rows) {
        bind_error(L, "corsac.Cloth:getPoint: (%d, %d), expected columns 1..%u and rows 1..%u",
                   (int)a->column, (int)a->row, v.columns, v.rows);
    }
    uint32_t i = r * v.columns + c;
    bind_push_vec3(L, core_v3(v.x[i], v.y[i], v.z[i]));
    return 3;
}
static int get_points(script *s, lua_State *L, void *args) {
    phys_cloth_view v = read_view(s, L, *(core_handle *)args);
    lua_createtable(L, (int)(3 * v.count), 0);
    for (uint32_t i = 0; i < v.count; i++) {
        const float p[3] = {v.x[i], v.y[i], v.z[i]};
        for (uint32_t k = 0; k < 3; k++) {
            lua_pushnumber(L, (double)p[k]);
            lua_rawseti(L, -2, (int)(3 * i + k) + 1);
        }
    }
    return 1;
}
static int get_torn(script *s, lua_State *L, void *args) {
    lua_pushinteger(L, (lua_Integer)read_view(s, L, *(core_handle *)args).torn_count);
    return 1;
}
static int is_asleep(script *s, lua_State *L, void *args) {
    lua_pushboolean(L, read_view(s, L, *(core_handle *)args).asleep);
    return 1;
}
static int get_stretch(script *s, lua_State *L, void *args) {
    double mean, most;
    if (!phys_cloth_stretch(scene_phys(s->scene), *(core_handle *)args, &mean, &most)) {
        bind_fail(L);
    }
    lua_pushnumber(L, mean);
    lua_pushnumber(L, most);
    return 2;
}

static int is_destroyed(script *s, lua_State *L, void *args) {
    lua_pushboolean(L, !cloth_alive(s, *(core_handle *)args));
    return 1;
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, phys_cloth_destroy(scene_phys(s->scene), *(core_handle *)args));
}

// ---- declarations ----

#define PARTICLE(T)                                                                                \
    {"column", BIND_INT, BIND_AT(T, column), "from 1"}, {                                          \
        "row", BIND_INT, BIND_AT(T, row), "from 1"                                                 \
    }
#define XYZ_ARGS(unit)                                                                             \
    BIND_ARGS(PARTICLE(place_args), {"x", BIND_NUMBER, BIND_AT(place_args, x), "", unit},          \
              {"y", BIND_NUMBER, BIND_AT(place_args, y), "", unit},                                \
              {"z", BIND_NUMBER, BIND_AT(place_args, z), "", unit})

static const bind_fn methods[] = {
    {"hold", "Holds a particle where it is, to a body that moves it along and feels its pull.",
     BIND_ARGS(PARTICLE(hold_args),
               {"body", BIND_OBJECT, BIND_AT(hold_args, body), "without, the world",
                .optional = true, .type = &bind_body_type}),
     NULL, sizeof(hold_args), BIND_SIM, .mod = true, .cost = 20, .run = hold},
    {"pin", "Holds a particle to a place of the world, to which it goes within the step.",
     XYZ_ARGS("m"), NULL, sizeof(place_args), BIND_SIM, .mod = true, .cost = 20, .run = pin},
    {"release", "Lets a particle go.", BIND_ARGS(PARTICLE(place_args)), NULL, sizeof(place_args),
     BIND_SIM, .mod = true, .cost = 20, .run = release},
    {"push", "Gives a particle an impulse.", XYZ_ARGS("N s"), NULL, sizeof(place_args), BIND_SIM,
     .mod = true, .cost = 8, .run = push},
    {"getPoint", "Where a particle is.", BIND_ARGS(PARTICLE(place_args)),
     BIND_RETURNS({"x", "number", "m"}, {"y", "number", "m"}, {"z", "number", "m"}),
     sizeof(place_args), BIND_RUNNING, .mod = true, .cost = 8, .run = get_point},
    {"getPoints", "Where all are: x, y, z of each, column by column, row after row.", NULL,
     BIND_RETURNS({"points", "number[]", "m"}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 2000, .run = get_points},
    {"getTorn", "How many edges are torn.", NULL, BIND_RETURNS({"count", "integer", NULL}),
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 8, .run = get_torn},
    {"getStretch", "How far edges are from their length, relative: mean and most.", NULL,
     BIND_RETURNS({"mean", "number", NULL}, {"most", "number", NULL}), sizeof(core_handle),
     BIND_RUNNING, .mod = true, .cost = 2000, .run = get_stretch},
    {"isAsleep", "Whether it lies still and costs nothing.", NULL,
     BIND_RETURNS({"asleep", "boolean", NULL}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 8, .run = is_asleep},
    {"isDestroyed", "Whether it was destroyed; every other method then raises an error.", NULL,
     BIND_RETURNS({"destroyed", "boolean", NULL}), sizeof(core_handle), BIND_ANY, .mod = true,
     .cost = 2, .run = is_destroyed},
    {"destroy", "Removes it.", NULL, NULL, sizeof(core_handle), BIND_SIM, .mod = true, .cost = 50,
     .run = destroy},
    {0}};
const bind_type bind_cloth_type = {
    "Cloth", "Particles that hold together: a sheet, or a rope with one column.", cloth_alive,
    methods};

#define OPTION(name, kind, member, ...)                                                            \
    { name, kind, BIND_AT(cloth_options, member), __VA_ARGS__ }
#define SHARED                                                                                     \
    OPTION("mass", BIND_FLOAT, mass, "in all", "kg", BIND_POSITIVE, .optional = true, .def = 1),   \
        OPTION("radius", BIND_FLOAT, radius, "half the thickness", "m", BIND_POSITIVE,             \
               .optional = true, .def = 0.01),                                                     \
        OPTION("stretch", BIND_FLOAT, stretch, "how far an edge gives; 0: not at all", "m/N",      \
               BIND_NOT_NEGATIVE, .optional = true),                                               \
        OPTION("bend", BIND_FLOAT, bend, "stiffness against bending; 0 for none", "N/m",           \
               BIND_NOT_NEGATIVE, .optional = true),                                               \
        OPTION("friction", BIND_FLOAT, friction, "Coulomb's coefficient", NULL, BIND_NOT_NEGATIVE, \
               .optional = true, .def = 0.5),                                                      \
        OPTION("damping", BIND_FLOAT, damping, "loss of velocity", "1/s", BIND_NOT_NEGATIVE,       \
               .optional = true, .def = 0.1),                                                      \
        OPTION("drag", BIND_FLOAT, drag, "of the air; 0 feels no wind", NULL, BIND_NOT_NEGATIVE,   \
               .optional = true, .def = 1),                                                        \
        OPTION("gravityScale", BIND_FLOAT, gravity_scale, "factor on gravity", .optional = true,   \
               .def = 1),                                                                          \
        OPTION("tearForce", BIND_FLOAT, tear_force, "tears an edge; 0 for never", "N",             \
               BIND_NOT_NEGATIVE, .optional = true),                                               \
        OPTION("substeps", BIND_INT, substeps, "more are stiffer and cost more", NULL,             \
               BIND_BETWEEN, .min = 1, .max = 64, .optional = true, .def = 8),                     \
        OPTION("layer", BIND_STRING, layer, "name of its collision layer", .optional = true,       \
               .def_text = "default")

static const bind_arg cloth_fields[] = {
    OPTION("columns", BIND_INT, columns, "particles across", NULL, BIND_BETWEEN, .min = 1,
           .max = 4096),
    OPTION("rows", BIND_INT, rows, "particles down", NULL, BIND_BETWEEN, .min = 1, .max = 4096),
    OPTION("position", BIND_VEC3, position, "of the particle (1, 1)", "m", .optional = true),
    OPTION("across", BIND_VEC3, across, "way from the first column to the last", "m"),
    OPTION("down", BIND_VEC3, down, "way from the first row to the last", "m"),
    OPTION("shear", BIND_FLOAT, shear, "how far a diagonal gives", "m/N", BIND_NOT_NEGATIVE,
           .optional = true, .def = 0.001),
    SHARED,
    {0}};
static const bind_arg rope_fields[] = {
    OPTION("count", BIND_INT, rows, "particles", NULL, BIND_BETWEEN, .min = 2, .max = 65536),
    OPTION("from", BIND_VEC3, position, "of the particle (1, 1)", "m"),
    OPTION("to", BIND_VEC3, across, "of the last one", "m"),
    SHARED,
    {0}};

const bind_fn bind_cloth_functions[] = {
    {"newCloth", "Makes a sheet of cloth.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(cloth_call, options), "the cloth",
                .fields = cloth_fields}),
     BIND_RETURNS({"cloth", "corsac.Cloth", NULL}), sizeof(cloth_call), BIND_SIM, .mod = true,
     .cost = 5000, .run = new_cloth},
    {"newRope", "Makes a rope: a cloth of one column, its particles (1, 1) to (1, count).",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(cloth_call, options), "the rope",
                .fields = rope_fields}),
     BIND_RETURNS({"rope", "corsac.Cloth", NULL}), sizeof(cloth_call), BIND_SIM, .mod = true,
     .cost = 2000, .run = new_rope},
    {0}};
