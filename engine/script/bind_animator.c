// Methods of Animator: one animated skeleton.
#include "script/bind_anim.h"
#include "script/bind_body.h"
#include "script/bind_region.h"
#include "script/internal.h"

static anim_world *world_of(script *s) { return scene_anim(s->scene); }

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

#define LOOPS "loop|once|pingpong"
#define FADES "linear|smooth"

typedef struct play_args {
    core_handle self, clip;
    float length;
    int loop, fade;
} play_args;
static int play(script *s, lua_State *L, void *args) {
    const play_args *a = args;
    return done(L, anim_instance_play(world_of(s), a->self, a->clip, (anim_loop)a->loop, a->length,
                                      (anim_fade)a->fade));
}

typedef struct go_args {
    core_handle self;
    const char *state;
    float length;
    int fade;
} go_args;
static int go(script *s, lua_State *L, void *args) {
    const go_args *a = args;
    return done(L, anim_instance_go(world_of(s), a->self, a->state, a->length, (anim_fade)a->fade));
}

typedef struct layer_options {
    int64_t layer;
    core_handle machine, clip, mask;
    int loop;
    float weight;
    bool additive;
} layer_options;
typedef struct layer_args {
    core_handle self;
    layer_options options;
} layer_args;
static int set_layer(script *s, lua_State *L, void *args) {
    const layer_args *a = args;
    const layer_options *o = &a->options;
    anim_layer_desc d = anim_layer_desc_default();
    d.machine = o->machine;
    d.clip = o->clip;
    d.mask = o->mask;
    d.loop = (anim_loop)o->loop;
    d.weight = o->weight;
    d.additive = o->additive;
    return done(L, anim_instance_set_layer(world_of(s), a->self, (uint32_t)o->layer, &d));
}

#define GOALS "reach|look|shift|move"
typedef struct goal_options {
    int64_t goal;
    int kind;
    const char *bone;
    core_vec3 target, pole, axis;
    float limit, weight;
    bool keep_rotation;
} goal_options;
typedef struct goal_args {
    core_handle self;
    goal_options options;
} goal_args;
static int set_goal(script *s, lua_State *L, void *args) {
    const goal_args *a = args;
    const goal_options *o = &a->options;
    anim_world *w = world_of(s);
    int32_t bone = anim_skeleton_find(w, anim_instance_skeleton(w, a->self), o->bone);
    if (bone < 0) {
        bind_error(L, "Animator:setGoal: its skeleton has no bone \"%s\"", o->bone);
    }
    anim_goal_desc d = anim_goal_desc_default((anim_goal_kind)o->kind);
    d.bone = (uint32_t)bone;
    d.target = o->target;
    d.pole = o->pole;
    d.axis = o->axis;
    d.limit = o->limit;
    d.weight = o->weight;
    d.keep_rotation = o->keep_rotation;
    return done(L, anim_instance_set_goal(w, a->self, (uint32_t)o->goal - 1, &d));
}

typedef struct feet_options {
    int bones;
    const char *root, *layer;
    float up, down, speed;
} feet_options;
typedef struct feet_args {
    core_handle self;
    feet_options options;
} feet_args;

static uint32_t named_bone(script *s, lua_State *L, core_handle animator, const char *name) {
    anim_world *w = world_of(s);
    int32_t bone = anim_skeleton_find(w, anim_instance_skeleton(w, animator), name ? name : "");
    if (bone < 0) {
        bind_error(L, "Animator:setFeet: its skeleton has no bone \"%s\"", name ? name : "");
    }
    return (uint32_t)bone;
}

static int set_feet(script *s, lua_State *L, void *args) {
    const feet_args *a = args;
    const feet_options *o = &a->options;
    scene_entity entity = scene_entity_of_anim(s->scene, a->self);
    scene_feet_desc d = {.up = o->up, .down = o->down, .speed = o->speed};
    for (uint32_t i = 0; i < lua_objlen(L, o->bones); i++) {
        if (i == CORE_COUNT_OF(d.bone)) {
            bind_error(L, "Animator:setFeet: bones: at most %zu", CORE_COUNT_OF(d.bone));
        }
        lua_rawgeti(L, o->bones, (int)i + 1);
        bool text = lua_type(L, -1) == LUA_TSTRING;
        d.bone[d.count++] = named_bone(s, L, a->self, text ? lua_tostring(L, -1) : NULL);
        lua_pop(L, 1);
    }
    d.root = named_bone(s, L, a->self, o->root);
    d.layers = o->layer ? 1u << bind_layer(s, L, o->layer) : 0;
    return done(L, scene_set_feet(s->scene, entity, d.count ? &d : NULL));
}

typedef struct ragdoll_options {
    float mass, least;
    const char *layer;
} ragdoll_options;
typedef struct ragdoll_args {
    core_handle self;
    ragdoll_options options;
} ragdoll_args;
static int start_ragdoll(script *s, lua_State *L, void *args) {
    const ragdoll_args *a = args;
    const ragdoll_options *o = &a->options;
    scene_ragdoll_desc d = {.mass = o->mass, .least = o->least};
    d.layer = o->layer ? bind_layer(s, L, o->layer) : 0;
    return done(L, scene_ragdoll_start(s->scene, scene_entity_of_anim(s->scene, a->self), &d));
}
typedef struct stop_args {
    core_handle self;
    float length;
} stop_args;
static int stop_ragdoll(script *s, lua_State *L, void *args) {
    const stop_args *a = args;
    return done(L,
                scene_ragdoll_stop(s->scene, scene_entity_of_anim(s->scene, a->self), a->length));
}
static int get_ragdoll(script *s, lua_State *L, void *args) {
    phys_body body[64];
    scene_entity e = scene_entity_of_anim(s->scene, *(core_handle *)args);
    uint32_t count = scene_ragdoll_bodies(s->scene, e, body, CORE_COUNT_OF(body));
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        bind_push(s, L, &bind_body_type, body[i]);
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}

typedef struct weight_args {
    core_handle self;
    int64_t layer;
    float weight;
} weight_args;
static int set_layer_weight(script *s, lua_State *L, void *args) {
    const weight_args *a = args;
    return done(
        L, anim_instance_set_layer_weight(world_of(s), a->self, (uint32_t)a->layer, a->weight));
}

typedef struct text_args {
    core_handle self;
    const char *text;
} text_args;
static int send(script *s, lua_State *L, void *args) {
    const text_args *a = args;
    return done(L, anim_instance_send(world_of(s), a->self, a->text));
}

typedef struct parameter_args {
    core_handle self;
    const char *name;
    float value;
} parameter_args;
static int set_parameter(script *s, lua_State *L, void *args) {
    const parameter_args *a = args;
    return done(L, anim_instance_set_parameter(world_of(s), a->self, a->name, a->value));
}
static int get_parameter(script *s, lua_State *L, void *args) {
    const text_args *a = args;
    float value = 0;
    done(L, anim_instance_parameter(world_of(s), a->self, a->text, &value));
    lua_pushnumber(L, (double)value);
    return 1;
}

typedef struct value_args {
    core_handle self;
    float value;
} value_args;
static int set_speed(script *s, lua_State *L, void *args) {
    const value_args *a = args;
    return done(L, anim_instance_set_speed(world_of(s), a->self, a->value));
}
static int set_time(script *s, lua_State *L, void *args) {
    const value_args *a = args;
    return done(L, anim_instance_set_time(world_of(s), a->self, a->value));
}
static int get_time(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, (double)anim_instance_time(world_of(s), *(core_handle *)args));
    return 1;
}

static int get_state(script *s, lua_State *L, void *args) {
    lua_pushstring(L, anim_instance_state(world_of(s), *(core_handle *)args));
    return 1;
}
static int is_in(script *s, lua_State *L, void *args) {
    const text_args *a = args;
    lua_pushboolean(L, anim_instance_in(world_of(s), a->self, a->text));
    return 1;
}
static int get_fade(script *s, lua_State *L, void *args) {
    const char *from;
    lua_pushnumber(L, (double)anim_instance_fade(world_of(s), *(core_handle *)args, &from));
    lua_pushstring(L, from);
    return 2;
}
static int get_transitions(script *s, lua_State *L, void *args) {
    const char *to[ANIM_MAX_STATES];
    uint32_t count =
        anim_instance_transitions(world_of(s), *(core_handle *)args, to, ANIM_MAX_STATES);
    count = CORE_MIN(count, ANIM_MAX_STATES);
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        lua_pushstring(L, to[i]);
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}
static int is_finished(script *s, lua_State *L, void *args) {
    lua_pushboolean(L, anim_instance_finished(world_of(s), *(core_handle *)args));
    return 1;
}
static int get_root_motion(script *s, lua_State *L, void *args) {
    core_vec3 v = {0, 0, 0};
    done(L, anim_instance_root_motion(world_of(s), *(core_handle *)args, &v));
    bind_push_vec3(L, v);
    return 3;
}

static int get_bone_position(script *s, lua_State *L, void *args) {
    const text_args *a = args;
    anim_world *w = world_of(s);
    int32_t bone = anim_skeleton_find(w, anim_instance_skeleton(w, a->self), a->text);
    if (bone < 0) {
        bind_error(L, "Animator:getBonePosition: its skeleton has no bone \"%s\"", a->text);
    }
    core_mat4 m;
    done(L, anim_instance_bone(w, a->self, (uint32_t)bone, &m));
    bind_push_vec3(L, core_v3(m.m[12], m.m[13], m.m[14]));
    return 3;
}

typedef struct flag_args {
    core_handle self;
    bool value;
} flag_args;
static int set_visible(script *s, lua_State *L, void *args) {
    const flag_args *a = args;
    return done(L, anim_instance_set_visible(world_of(s), a->self, a->value));
}

typedef struct rate_args {
    core_handle self;
    int64_t every;
} rate_args;
static int set_rate(script *s, lua_State *L, void *args) {
    const rate_args *a = args;
    return done(L, anim_instance_set_rate(world_of(s), a->self, (uint32_t)a->every));
}

static int get_entity(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_entity_type, scene_entity_of_anim(s->scene, *(core_handle *)args));
    return 1;
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, anim_instance_destroy(world_of(s), *(core_handle *)args));
}
static int is_destroyed(script *s, lua_State *L, void *args) {
    (void)s;
    (void)args;
    lua_pushboolean(L, 0); // the caller answers for dead ones
    return 1;
}

// ---- declarations ----

#define SELF sizeof(core_handle)
#define FADE_ARGS(T)                                                                               \
    {"length", BIND_FLOAT,        BIND_AT(T, length), "of the cross-fade",                         \
     "s",      BIND_NOT_NEGATIVE, .optional = true},                                               \
    {                                                                                              \
        "fade", BIND_ENUM, BIND_AT(T, fade), "shape of the cross-fade", .optional = true,          \
                                                                        .values = FADES            \
    }
#define XYZ BIND_RETURNS({"x", "number", "m"}, {"y", "number", "m"}, {"z", "number", "m"})

static const bind_arg layer_fields[] = {
    {"layer", BIND_INT, BIND_AT(layer_options, layer), "1 is the lowest above the base", NULL,
     BIND_BETWEEN, .min = 1, .max = ANIM_MAX_LAYERS, .optional = true, .def = 1},
    {"machine", BIND_OBJECT, BIND_AT(layer_options, machine), "", .optional = true,
     .def_text = "nil", .type = &bind_machine_type},
    {"clip", BIND_OBJECT, BIND_AT(layer_options, clip), "without machine and clip it is removed",
     .optional = true, .def_text = "nil", .type = &bind_clip_type},
    {"loop", BIND_ENUM, BIND_AT(layer_options, loop), "what happens at the clip's end",
     .optional = true, .values = LOOPS},
    {"mask", BIND_OBJECT, BIND_AT(layer_options, mask), "bones it moves", .optional = true,
     .def_text = "all", .type = &bind_mask_type},
    {"weight", BIND_FLOAT, BIND_AT(layer_options, weight), "", NULL, BIND_BETWEEN, .max = 1,
     .optional = true, .def = 1},
    {"additive", BIND_BOOL, BIND_AT(layer_options, additive),
     "adds the clip's change since its first pose", .optional = true},
    {0}};

static const bind_arg goal_fields[] = {
    {"goal", BIND_INT, BIND_AT(goal_options, goal), "its number; goals are applied in order", NULL,
     BIND_BETWEEN, .min = 1, .max = ANIM_MAX_GOALS, .optional = true, .def = 1},
    {"kind", BIND_ENUM, BIND_AT(goal_options, kind),
     "reach: the bone and two above it are a limb; look: the bone turns; shift: a limb whose tip "
     "goes "
     "by the target from where the animation has it; move: the bone moves by the target",
     .optional = true, .values = GOALS},
    {"bone", BIND_STRING, BIND_AT(goal_options, bone), "tip of the limb, or what looks"},
    {"target", BIND_VEC3, BIND_AT(goal_options, target), "in the model's frame", "m",
     .optional = true},
    {"pole", BIND_VEC3, BIND_AT(goal_options, pole), "reach: where the middle joint points",
     .optional = true, .def_text = "as in the pose"},
    {"axis", BIND_VEC3, BIND_AT(goal_options, axis), "look: the bone's own forward",
     .optional = true, .def_vec = {0, 0, 1}},
    {"limit", BIND_FLOAT, BIND_AT(goal_options, limit), "look: most it turns (0: any)", "rad",
     BIND_NOT_NEGATIVE, .optional = true},
    {"weight", BIND_FLOAT, BIND_AT(goal_options, weight), "0 removes the goal", NULL, BIND_BETWEEN,
     .max = 1, .optional = true, .def = 1},
    {"keepRotation", BIND_BOOL, BIND_AT(goal_options, keep_rotation),
     "reach: the tip stays turned as it was", .optional = true},
    {0}};

static const bind_arg ragdoll_fields[] = {
    {"mass", BIND_FLOAT, BIND_AT(ragdoll_options, mass), "in all, shared by volume", "kg",
     BIND_POSITIVE, .optional = true, .def = 70},
    {"least", BIND_FLOAT, BIND_AT(ragdoll_options, least), "shorter bones move with the one above",
     "m", BIND_POSITIVE, .optional = true, .def = 0.02},
    {"layer", BIND_STRING, BIND_AT(ragdoll_options, layer), "of the bodies", .optional = true,
     .def_text = "default"},
    {0}};

static const bind_arg feet_fields[] = {
    {"bones", BIND_TABLE, BIND_AT(feet_options, bones),
     "names of up to four ends of limbs; none: the animation has its feet to itself again"},
    {"root", BIND_STRING, BIND_AT(feet_options, root), "bone that carries the body: hips"},
    {"up", BIND_FLOAT, BIND_AT(feet_options, up), "above the entity, in which ground counts", "m",
     BIND_POSITIVE, .optional = true, .def = 0.5},
    {"down", BIND_FLOAT, BIND_AT(feet_options, down), "and below", "m", BIND_POSITIVE,
     .optional = true, .def = 0.5},
    {"speed", BIND_FLOAT, BIND_AT(feet_options, speed), "at which a foot follows the ground", "m/s",
     BIND_POSITIVE, .optional = true, .def = 2},
    {"layer", BIND_STRING, BIND_AT(feet_options, layer), "bodies that are ground", .optional = true,
     .def_text = "all"},
    {0}};

const bind_fn bind_animator_methods[] = {
    {"setGoal", "Bends the finished pose: a limb reaches a point, or a bone looks at one.",
     BIND_ARGS(
         {"options", BIND_OPTIONS, BIND_AT(goal_args, options), "the goal", .fields = goal_fields}),
     NULL, sizeof(goal_args), BIND_SIM, .mod = true, .cost = 20, .run = set_goal},
    {"setFeet",
     "Feet stand on the ground under them, found by rays, as high as the animation has them; the "
     "root sinks "
     "as far as the lowest needs. Takes a goal for each foot from 1 on, and one for the root.",
     BIND_ARGS(
         {"options", BIND_OPTIONS, BIND_AT(feet_args, options), "the feet", .fields = feet_fields}),
     NULL, sizeof(feet_args), BIND_SIM, .mod = true, .cost = 100, .run = set_feet},
    {"startRagdoll",
     "Hands its entity to physics: from the next step on each long bone is a body, with the place "
     "and speed "
     "that the animation gave it, and bodies give the pose.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(ragdoll_args, options), "", .optional = true,
                .def_text = "{}", .fields = ragdoll_fields}),
     NULL, sizeof(ragdoll_args), BIND_SIM, .mod = true, .cost = 10000, .run = start_ragdoll},
    {"stopRagdoll", "Ends it: the bodies go, and the pose it fell into turns into the animation's.",
     BIND_ARGS({"length", BIND_FLOAT, BIND_AT(stop_args, length), "how long it takes", "s",
                BIND_NOT_NEGATIVE, .optional = true, .def = 0.4}),
     NULL, sizeof(stop_args), BIND_SIM, .mod = true, .cost = 500, .run = stop_ragdoll},
    {"getRagdoll", "Its bodies while it is one, parents first.", NULL,
     BIND_RETURNS({"bodies", "corsac.Body[]", NULL}), SELF, BIND_RUNNING, .mod = true, .cost = 50,
     .run = get_ragdoll},
    {"setLayer", "Plays a clip or machine over the base, on all or some bones.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(layer_args, options), "the layer",
                .fields = layer_fields}),
     NULL, sizeof(layer_args), BIND_LOAD | BIND_FIXED, .mod = true, .cost = 100, .run = set_layer},
    {"setLayerWeight", "How much of a layer is seen.",
     BIND_ARGS(
         {"layer", BIND_INT, BIND_AT(weight_args, layer), "", NULL, BIND_BETWEEN, .min = 1,
          .max = ANIM_MAX_LAYERS},
         {"weight", BIND_FLOAT, BIND_AT(weight_args, weight), "", NULL, BIND_BETWEEN, .max = 1}),
     NULL, sizeof(weight_args), BIND_SIM, .mod = true, .cost = 8, .run = set_layer_weight},
    {"play", "Plays a clip, whatever its machine says, fading from the pose of this moment.",
     BIND_ARGS({"clip", BIND_OBJECT, BIND_AT(play_args, clip), "", .type = &bind_clip_type},
               FADE_ARGS(play_args),
               {"loop", BIND_ENUM, BIND_AT(play_args, loop), "what happens at its end",
                .optional = true, .values = LOOPS}),
     NULL, sizeof(play_args), BIND_SIM, .mod = true, .cost = 20, .run = play},
    {"go", "Changes to a state of its machine, as a transition would.",
     BIND_ARGS({"state", BIND_STRING, BIND_AT(go_args, state), "name"}, FADE_ARGS(go_args)), NULL,
     sizeof(go_args), BIND_SIM, .mod = true, .cost = 20, .run = go},
    {"send", "Sends an event to its machine; transitions of the next step hear it.",
     BIND_ARGS({"event", BIND_STRING, BIND_AT(text_args, text), "name"}), NULL, sizeof(text_args),
     BIND_SIM, .mod = true, .cost = 8, .run = send},
    {"setParameter", "Sets a parameter of its machine.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(parameter_args, name), ""},
               {"value", BIND_FLOAT, BIND_AT(parameter_args, value), ""}),
     NULL, sizeof(parameter_args), BIND_SIM, .mod = true, .cost = 8, .run = set_parameter},
    {"getParameter", "Value of a parameter of its machine.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(text_args, text), ""}),
     BIND_RETURNS({"value", "number", NULL}), sizeof(text_args), BIND_RUNNING, .mod = true,
     .cost = 8, .run = get_parameter},
    {"setSpeed", "Factor on its time; 0 stops, negative plays backwards.",
     BIND_ARGS({"speed", BIND_FLOAT, BIND_AT(value_args, value), ""}), NULL, sizeof(value_args),
     BIND_SIM, .mod = true, .cost = 4, .run = set_speed},
    {"setTime", "Goes to a place in the current clip.",
     BIND_ARGS({"time", BIND_FLOAT, BIND_AT(value_args, value), "", "s"}), NULL, sizeof(value_args),
     BIND_SIM, .mod = true, .cost = 4, .run = set_time},
    {"getTime", "Place in the current clip.", NULL, BIND_RETURNS({"time", "number", "s"}), SELF,
     BIND_RUNNING, .mod = true, .cost = 4, .run = get_time},
    {"getState", "Name of the machine's current state, \"\" without one.", NULL,
     BIND_RETURNS({"state", "string", NULL}), SELF, BIND_RUNNING, .mod = true, .cost = 4,
     .run = get_state},
    {"isIn", "Whether a state of its machine is the current one or holds it.",
     BIND_ARGS({"state", BIND_STRING, BIND_AT(text_args, text), "of its machine"}),
     BIND_RETURNS({"inside", "boolean", NULL}), sizeof(text_args), BIND_RUNNING, .mod = true,
     .cost = 4, .run = is_in},
    {"getFade", "Progress of the cross-fade (1: none runs) and the state it leaves.", NULL,
     BIND_RETURNS({"progress", "number", NULL}, {"from", "string", NULL}), SELF, BIND_RUNNING,
     .mod = true, .cost = 4, .run = get_fade},
    {"getTransitions", "Targets of the transitions from the current state, in order.", NULL,
     BIND_RETURNS({"states", "string[]", NULL}), SELF, BIND_RUNNING, .mod = true, .cost = 50,
     .run = get_transitions},
    {"isFinished", "Whether the current clip has come to its end.", NULL,
     BIND_RETURNS({"finished", "boolean", NULL}), SELF, BIND_RUNNING, .mod = true, .cost = 4,
     .run = is_finished},
    {"getRootMotion", "How far the root moved in the last step, in the animator's frame.", NULL,
     XYZ, SELF, BIND_RUNNING, .mod = true, .cost = 4, .run = get_root_motion},
    {"getBonePosition", "Where a bone is, in the model's frame, since the last step.",
     BIND_ARGS({"bone", BIND_STRING, BIND_AT(text_args, text), "name"}), XYZ, sizeof(text_args),
     BIND_RUNNING, .mod = true, .cost = 50, .run = get_bone_position},
    {"setVisible", "When false its pose is not computed; its machine still runs.",
     BIND_ARGS({"visible", BIND_BOOL, BIND_AT(flag_args, value), ""}), NULL, sizeof(flag_args),
     BIND_SIM, .mod = true, .cost = 4, .run = set_visible},
    {"setRate", "Level of detail: its pose is computed at every n-th step only.",
     BIND_ARGS({"every", BIND_INT, BIND_AT(rate_args, every), "steps", NULL, BIND_BETWEEN, .min = 1,
                .max = 64}),
     NULL, sizeof(rate_args), BIND_SIM, .mod = true, .cost = 4, .run = set_rate},
    {"getEntity", "The entity it moves, or nil.", NULL,
     BIND_RETURNS({"entity", "corsac.Entity?", NULL}), SELF, BIND_RUNNING, .mod = true, .cost = 4,
     .run = get_entity},
    {"isDestroyed", "Whether it was destroyed; every other method then raises an error.", NULL,
     BIND_RETURNS({"destroyed", "boolean", NULL}), SELF, BIND_ANY, .mod = true, .cost = 2,
     .run = is_destroyed},
    {"destroy", "Removes it; its entity then shows the bind pose.", NULL, NULL, SELF, BIND_SIM,
     .mod = true, .cost = 50, .run = destroy},
    {0}};
