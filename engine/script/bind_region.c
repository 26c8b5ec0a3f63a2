// corsac.phys: layers, triggers, force fields.
#include "script/bind_region.h"
#include "script/bind_body.h"
#include "script/events.h"
#include "script/internal.h"

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// ---- layers ----

uint32_t bind_layer(script *s, lua_State *L, const char *name) {
    int layer = scene_layer(s->scene, name);
    if (layer < 0) {
        bind_fail(L);
    }
    return (uint32_t)layer;
}

typedef struct rule_args {
    const char *a, *b;
    bool collide;
} rule_args;
static int set_collision_rule(script *s, lua_State *L, void *args) {
    const rule_args *a = args;
    return done(L, phys_world_set_rule(scene_phys(s->scene), bind_layer(s, L, a->a),
                                       bind_layer(s, L, a->b), a->collide));
}

static int get_collision_rule(script *s, lua_State *L, void *args) {
    const rule_args *a = args;
    lua_pushboolean(
        L, phys_world_rule(scene_phys(s->scene), bind_layer(s, L, a->a), bind_layer(s, L, a->b)));
    return 1;
}

// ---- regions ----

#define REGION_SHAPES "sphere|box|capsule|cylinder"
static const phys_shape_type region_types[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER};

typedef struct region_options {
    int shape;
    core_vec3 size, position;
    core_quat rotation;
    float radius, height;
    const char *layer;
    bool has_shape;
} region_options;

// Half extents of a box; half the height of what stands upright.
static core_vec3 region_half(const region_options *o) {
    bool tall = region_types[o->shape] == PHYS_CAPSULE || region_types[o->shape] == PHYS_CYLINDER;
    return core_v3_scale(tall ? core_v3(0, o->height, 0) : o->size, 0.5f);
}

static uint32_t layer_mask(script *s, lua_State *L, const char *layer) {
    return layer ? 1u << bind_layer(s, L, layer) : 0;
}

uint32_t bind_layer_bits(script *s, lua_State *L, int list) {
    uint32_t bits = 0;
    for (int i = 1; list; i++) {
        lua_rawgeti(L, list, i);
        if (lua_isnil(L, -1)) {
            lua_pop(L, 1);
            break;
        }
        if (lua_type(L, -1) != LUA_TSTRING) {
            bind_error(L, "layers must be names in an array: {\"default\"}");
        }
        bits |= 1u << bind_layer(s, L, lua_tostring(L, -1));
        lua_pop(L, 1);
    }
    return bits;
}

// ---- triggers ----

typedef struct trigger_options {
    region_options region;
    int on_enter, on_stay, on_exit;
} trigger_options;
typedef struct trigger_call {
    trigger_options options;
} trigger_call;

static int new_trigger(script *s, lua_State *L, void *args) {
    const trigger_options *o = &((trigger_call *)args)->options;
    phys_trigger_desc desc = phys_trigger_desc_default(region_types[o->region.shape]);
    desc.half = region_half(&o->region);
    desc.radius = o->region.radius;
    desc.position = o->region.position;
    desc.rotation = o->region.rotation;
    desc.layers = layer_mask(s, L, o->region.layer);
    phys_trigger trigger = phys_trigger_create(scene_phys(s->scene), &desc);
    if (core_handle_is_null(trigger)) {
        bind_fail(L);
    }
    script_keep_callbacks(s, L, SCRIPT_ON_TRIGGER, trigger,
                          (const int[]){o->on_enter, o->on_stay, o->on_exit});
    bind_push(s, L, &bind_trigger_type, trigger);
    return 1;
}

static bool trigger_alive(script *s, core_handle h) {
    phys_world *world = scene_phys_if(s->scene);
    return world && phys_trigger_alive(world, h);
}

typedef struct vector_args {
    core_handle self;
    double x, y, z;
} vector_args;
static int trigger_set_position(script *s, lua_State *L, void *args) {
    const vector_args *a = args;
    return done(L, phys_trigger_set_position(scene_phys(s->scene), a->self,
                                             core_v3((float)a->x, (float)a->y, (float)a->z)));
}

static int trigger_destroy(script *s, lua_State *L, void *args) {
    core_handle self = *(core_handle *)args;
    script_forget_trigger(L, self);
    return done(L, phys_trigger_destroy(scene_phys(s->scene), self));
}

// ---- fields ----

#define FIELD_TYPES "uniform|point|wind"
typedef struct field_options {
    region_options region;
    int type;
    core_vec3 acceleration, velocity, center;
    float strength, core;
} field_options;
typedef struct field_call {
    field_options options;
} field_call;

static int new_field(script *s, lua_State *L, void *args) {
    const field_options *o = &((field_call *)args)->options;
    phys_field_desc desc = phys_field_desc_default((phys_field_type)o->type);
    desc.acceleration = o->acceleration;
    desc.velocity = o->velocity;
    desc.center = o->center;
    desc.strength = o->strength;
    desc.core = o->core;
    desc.bounded = o->region.has_shape;
    desc.shape = region_types[o->region.shape];
    desc.position = o->region.position;
    desc.half = region_half(&o->region);
    desc.rotation = o->region.rotation;
    desc.radius = o->region.radius;
    desc.layers = layer_mask(s, L, o->region.layer);
    phys_field field = phys_field_create(scene_phys(s->scene), &desc);
    if (core_handle_is_null(field)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_field_type, field);
    return 1;
}

static bool field_alive(script *s, core_handle h) {
    phys_world *world = scene_phys_if(s->scene);
    return world && phys_field_alive(world, h);
}

static int field_destroy(script *s, lua_State *L, void *args) {
    return done(L, phys_field_destroy(scene_phys(s->scene), *(core_handle *)args));
}

// ---- declarations ----

static const bind_fn trigger_methods[] = {
    {"setPosition", "Moves it.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(vector_args, x), "", "m"},
               {"y", BIND_NUMBER, BIND_AT(vector_args, y), "", "m"},
               {"z", BIND_NUMBER, BIND_AT(vector_args, z), "", "m"}),
     NULL, sizeof(vector_args), BIND_SIM, .mod = true, .cost = 8, .run = trigger_set_position},
    {"destroy", "Removes it; bodies inside get their exit at the next step.", NULL, NULL,
     sizeof(core_handle), BIND_SIM, .mod = true, .cost = 20, .run = trigger_destroy},
    {0}};
const bind_type bind_trigger_type = {"Trigger", "A region that reports bodies and pushes nothing.",
                                     trigger_alive, trigger_methods};

static const bind_fn field_methods[] = {{"destroy", "Removes it.", NULL, NULL, sizeof(core_handle),
                                         BIND_SIM, .mod = true, .cost = 20, .run = field_destroy},
                                        {0}};
const bind_type bind_field_type = {"Field", "An acceleration that acts on bodies.", field_alive,
                                   field_methods};

#define FUNCTION(T, member, lua_name, what)                                                        \
    { lua_name, BIND_FUNCTION, BIND_AT(T, member), what, .optional = true, .def_text = "none" }
#define REGION(T, member) BIND_AT(T, region.member)

static const bind_arg trigger_fields[] = {
    {"shape", BIND_ENUM, REGION(trigger_options, shape), "form of the region", .optional = true,
     .def = 1, .values = REGION_SHAPES, BIND_GIVEN(trigger_options, region.has_shape)},
    {"size", BIND_VEC3, REGION(trigger_options, size), "box: lengths of its edges", "m",
     BIND_POSITIVE, .optional = true, .def_vec = {1, 1, 1}, .uniform = true},
    {"radius", BIND_FLOAT, REGION(trigger_options, radius), "sphere, capsule, cylinder", "m",
     BIND_POSITIVE, .optional = true, .def = 0.5},
    {"height", BIND_FLOAT, REGION(trigger_options, height),
     "cylinder: whole; capsule: its straight part", "m", BIND_POSITIVE, .optional = true, .def = 1},
    {"position", BIND_VEC3, REGION(trigger_options, position), "of its centre", "m",
     .optional = true},
    {"rotation", BIND_QUAT, REGION(trigger_options, rotation), "of the region", .optional = true,
     .def_text = "none"},
    {"layer", BIND_STRING, REGION(trigger_options, layer),
     "sees only bodies of this layer; without, all", .optional = true},
    FUNCTION(trigger_options, on_enter, "onEnter", "called with body and trigger, once a visit"),
    FUNCTION(trigger_options, on_stay, "onStay", "in every step between"),
    FUNCTION(trigger_options, on_exit, "onExit", "once a visit; body is nil when it was destroyed"),
    {0}};

static const bind_arg field_fields[] = {
    {"type", BIND_ENUM, BIND_AT(field_options, type), "kind of field", .optional = true,
     .values = FIELD_TYPES},
    {"acceleration", BIND_VEC3, BIND_AT(field_options, acceleration), "uniform", "m/s^2",
     .optional = true},
    {"velocity", BIND_VEC3, BIND_AT(field_options, velocity),
     "wind: of the air, which drags cloth and ropes along", "m/s", .optional = true},
    {"center", BIND_VEC3, BIND_AT(field_options, center), "point: what it pulls towards", "m",
     .optional = true},
    {"strength", BIND_FLOAT, BIND_AT(field_options, strength),
     "point: acceleration times distance squared; negative repels", "m^3/s^2", .optional = true,
     .def = 10},
    {"core", BIND_FLOAT, BIND_AT(field_options, core),
     "point: inside this distance the pull falls to zero", "m", BIND_POSITIVE, .optional = true,
     .def = 0.5},
    {"shape", BIND_ENUM, REGION(field_options, shape), "acts only inside this region",
     .optional = true, .def_text = "everywhere", .values = REGION_SHAPES,
     BIND_GIVEN(field_options, region.has_shape)},
    {"size", BIND_VEC3, REGION(field_options, size), "box: lengths of its edges", "m",
     BIND_POSITIVE, .optional = true, .def_vec = {1, 1, 1}, .uniform = true},
    {"radius", BIND_FLOAT, REGION(field_options, radius), "sphere, capsule, cylinder", "m",
     BIND_POSITIVE, .optional = true, .def = 0.5},
    {"height", BIND_FLOAT, REGION(field_options, height),
     "cylinder: whole; capsule: its straight part", "m", BIND_POSITIVE, .optional = true, .def = 1},
    {"position", BIND_VEC3, REGION(field_options, position), "of the region's centre", "m",
     .optional = true},
    {"rotation", BIND_QUAT, REGION(field_options, rotation), "of the region", .optional = true,
     .def_text = "none"},
    {"layer", BIND_STRING, REGION(field_options, layer),
     "acts only on bodies of this layer; without, on all", .optional = true},
    {0}};

#define LAYERS                                                                                     \
    {"a", BIND_STRING, BIND_AT(rule_args, a), "layer; a new name makes one (at most 32)"}, {       \
        "b", BIND_STRING, BIND_AT(rule_args, b), "layer, also the same one"                        \
    }

const bind_fn bind_region_functions[] = {
    {"setCollisionRule", "Whether bodies of two layers collide; without a rule they do.",
     BIND_ARGS(LAYERS, {"collide", BIND_BOOL, BIND_AT(rule_args, collide), "from the next step"}),
     NULL, sizeof(rule_args), BIND_SIM, .mod = true, .cost = 20, .run = set_collision_rule},
    {"getCollisionRule", "Whether bodies of two layers collide.", BIND_ARGS(LAYERS),
     BIND_RETURNS({"collide", "boolean", NULL}), sizeof(rule_args), BIND_RUNNING, .mod = true,
     .cost = 8, .run = get_collision_rule},
    {"newTrigger", "Makes a region that calls back when bodies come and go.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(trigger_call, options), "the trigger",
                .fields = trigger_fields}),
     BIND_RETURNS({"trigger", "corsac.Trigger", NULL}), sizeof(trigger_call), BIND_SIM, .mod = true,
     .cost = 500, .run = new_trigger},
    {"newField", "Makes a force field.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(field_call, options), "the field",
                .fields = field_fields}),
     BIND_RETURNS({"field", "corsac.Field", NULL}), sizeof(field_call), BIND_SIM, .mod = true,
     .cost = 500, .run = new_field},
    {0}};
