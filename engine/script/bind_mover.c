// corsac.phys.newMover and the methods of movers.
#include "script/bind_mover.h"

#include "script/bind_body.h"
#include "script/bind_region.h"
#include "script/internal.h"

typedef struct mover_options {
    core_vec3 position;
    float radius, height, slope_limit, step_height, push_force, mass, gravity_scale;
    int layers;
} mover_options;
typedef struct mover_call {
    mover_options options;
} mover_call;

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// Lua gives the whole height.
static float segment_half(lua_State *L, float height, float radius) {
    if (!(height > 2.0f * radius)) {
        bind_error(L, "mover: height is %g m, expected more than twice the radius of %g m",
                   (double)height, (double)radius);
    }
    return 0.5f * height - radius;
}

static int new_mover(script *s, lua_State *L, void *args) {
    const mover_options *o = &((mover_call *)args)->options;
    phys_mover_desc d = phys_mover_desc_default();
    d.position = o->position;
    d.radius = o->radius;
    d.half_height = segment_half(L, o->height, o->radius);
    d.slope_limit = o->slope_limit;
    d.step_height = o->step_height;
    d.push_force = o->push_force;
    d.mass = o->mass;
    d.gravity_scale = o->gravity_scale;
    d.layers = bind_layer_bits(s, L, o->layers);
    phys_mover mover = phys_mover_create(scene_phys(s->scene), &d);
    if (core_handle_is_null(mover)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_mover_type, mover);
    return 1;
}

static bool mover_alive(script *s, core_handle h) {
    phys_world *world = scene_phys_if(s->scene);
    return world && phys_mover_alive(world, h);
}

typedef struct vector_args {
    core_handle self;
    double x, y, z;
} vector_args;
static core_vec3 vector_of(const vector_args *a) {
    return core_v3((float)a->x, (float)a->y, (float)a->z);
}

static int walk(script *s, lua_State *L, void *args) {
    const vector_args *a = args;
    return done(L, phys_mover_walk(scene_phys(s->scene), a->self, vector_of(a)));
}
static int set_position(script *s, lua_State *L, void *args) {
    const vector_args *a = args;
    return done(L, phys_mover_set_position(scene_phys(s->scene), a->self, vector_of(a)));
}

typedef struct jump_args {
    core_handle self;
    float speed;
} jump_args;
static int jump(script *s, lua_State *L, void *args) {
    const jump_args *a = args;
    return done(L, phys_mover_jump(scene_phys(s->scene), a->self, a->speed));
}

typedef struct resize_args {
    core_handle self;
    float radius, height;
} resize_args;
static int resize(script *s, lua_State *L, void *args) {
    const resize_args *a = args;
    bool fits;
    done(L, phys_mover_resize(scene_phys(s->scene), a->self, a->radius,
                              segment_half(L, a->height, a->radius), &fits));
    lua_pushboolean(L, fits);
    return 1;
}

static phys_mover_state read_state(script *s, lua_State *L, void *args) {
    phys_mover_state state;
    if (!phys_mover_read(scene_phys(s->scene), *(core_handle *)args, &state)) {
        bind_fail(L);
    }
    return state;
}
static int get_position(script *s, lua_State *L, void *args) {
    bind_push_vec3(L, read_state(s, L, args).position);
    return 3;
}
static int get_velocity(script *s, lua_State *L, void *args) {
    bind_push_vec3(L, read_state(s, L, args).velocity);
    return 3;
}
static int get_turn(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, (double)read_state(s, L, args).turn);
    return 1;
}
static int get_ground(script *s, lua_State *L, void *args) {
    static const char *const names[] = {"air", "steep", "ground"};
    phys_mover_state state = read_state(s, L, args);
    lua_pushstring(L, names[state.ground]);
    if (phys_body_alive(scene_phys(s->scene), state.body)) {
        bind_push(s, L, &bind_body_type, state.body);
    } else {
        lua_pushnil(L);
    }
    bind_push_vec3(L, state.normal);
    return 5;
}

static int is_destroyed(script *s, lua_State *L, void *args) {
    lua_pushboolean(L, !mover_alive(s, *(core_handle *)args));
    return 1;
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, phys_mover_destroy(scene_phys(s->scene), *(core_handle *)args));
}

// ---- declarations ----

#define XYZ(unit) BIND_RETURNS({"x", "number", unit}, {"y", "number", unit}, {"z", "number", unit})
#define XYZ_ARGS(unit, text)                                                                       \
    BIND_ARGS({"x", BIND_NUMBER, BIND_AT(vector_args, x), text, unit},                             \
              {"y", BIND_NUMBER, BIND_AT(vector_args, y), "", unit},                               \
              {"z", BIND_NUMBER, BIND_AT(vector_args, z), "", unit})
#define OPTION(name, kind, member, ...)                                                            \
    { name, kind, BIND_AT(mover_options, member), __VA_ARGS__, .optional = true }

static const bind_fn methods[] = {
    {"walk",
     "Sets the velocity it wishes, seen from the ground, until it is changed; y counts without "
     "gravity only.",
     XYZ_ARGS("m/s", ""), NULL, sizeof(vector_args), BIND_SIM, .mod = true, .cost = 8, .run = walk},
    {"jump", "Leaves the ground, or jumps again in the air: when that is allowed is your rule.",
     BIND_ARGS({"speed", BIND_FLOAT, BIND_AT(jump_args, speed), "upwards", "m/s", BIND_POSITIVE}),
     NULL, sizeof(jump_args), BIND_SIM, .mod = true, .cost = 8, .run = jump},
    {"resize", "Changes its size, feet in place; false and unchanged where it would not fit.",
     BIND_ARGS({"radius", BIND_FLOAT, BIND_AT(resize_args, radius), "", "m", BIND_POSITIVE},
               {"height", BIND_FLOAT, BIND_AT(resize_args, height), "in all", "m", BIND_POSITIVE}),
     BIND_RETURNS({"fits", "boolean", NULL}), sizeof(resize_args), BIND_SIM, .mod = true,
     .cost = 100, .run = resize},
    {"getPosition", "Centre of the capsule.", NULL, XYZ("m"), sizeof(core_handle), BIND_RUNNING,
     .mod = true, .cost = 8, .run = get_position},
    {"getVelocity", "How it went in the last step, with the platform it rides on.", NULL,
     XYZ("m/s"), sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 8, .run = get_velocity},
    {"getGround",
     "\"ground\", \"steep\" (touches only what is too steep) or \"air\", the body it stands on "
     "(or nil) and the normal of its surface.",
     NULL,
     BIND_RETURNS({"ground", "string", NULL}, {"body", "corsac.Body?", NULL}, {"x", "number", NULL},
                  {"y", "number", NULL}, {"z", "number", NULL}),
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 10, .run = get_ground},
    {"getTurn", "By how much the ground turned about +y in the last step.", NULL,
     BIND_RETURNS({"turn", "number", "rad"}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 8, .run = get_turn},
    {"setPosition", "Puts it elsewhere, at rest.", XYZ_ARGS("m", ""), NULL, sizeof(vector_args),
     BIND_SIM, .mod = true, .cost = 8, .run = set_position},
    {"isDestroyed", "Whether it was destroyed; every other method then raises an error.", NULL,
     BIND_RETURNS({"destroyed", "boolean", NULL}), sizeof(core_handle), BIND_ANY, .mod = true,
     .cost = 2, .run = is_destroyed},
    {"destroy", "Removes it.", NULL, NULL, sizeof(core_handle), BIND_SIM, .mod = true, .cost = 20,
     .run = destroy},
    {0}};
const bind_type bind_mover_type = {
    "Mover", "An upright capsule that walks: slopes, steps, platforms, pushing.", mover_alive,
    methods};

static const bind_arg fields[] = {
    OPTION("position", BIND_VEC3, position, "centre of the capsule", "m"),
    OPTION("radius", BIND_FLOAT, radius, "", "m", BIND_POSITIVE, .def = 0.3),
    OPTION("height", BIND_FLOAT, height, "in all", "m", BIND_POSITIVE, .def = 1.8),
    OPTION("slopeLimit", BIND_FLOAT, slope_limit, "steepest ground it stands on", "rad",
           BIND_POSITIVE, .def = 0.8727),
    OPTION("stepHeight", BIND_FLOAT, step_height, "highest edge it walks over", "m",
           BIND_NOT_NEGATIVE, .def = 0.3),
    OPTION("pushForce", BIND_FLOAT, push_force, "most it gives against dynamic bodies", "N",
           BIND_NOT_NEGATIVE, .def = 200),
    OPTION("mass", BIND_FLOAT, mass, "weighs on what it stands on", "kg", BIND_POSITIVE, .def = 70),
    OPTION("gravityScale", BIND_FLOAT, gravity_scale, "0 flies", .def = 1),
    OPTION("layers", BIND_TABLE, layers, "names of the layers in its way", .def_text = "all"),
    {0}};

const bind_fn bind_mover_functions[] = {
    {"newMover", "Makes a character that walks by its own rules at the end of each step.",
     BIND_ARGS(
         {"options", BIND_OPTIONS, BIND_AT(mover_call, options), "the mover", .fields = fields}),
     BIND_RETURNS({"mover", "corsac.Mover", NULL}), sizeof(mover_call), BIND_SIM, .mod = true,
     .cost = 500, .run = new_mover},
    {0}};
