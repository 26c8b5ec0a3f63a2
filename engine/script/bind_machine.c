// corsac.anim.newMachine: tables of states and transitions whose functions are Lua's.
#include "script/bind_anim.h"
#include "script/internal.h"
#include "script/mod.h"

#include <stdlib.h>
#include <string.h>

typedef struct point_options {
    core_handle clip;
    float value;
} point_options;
typedef struct state_options {
    const char *name, *within, *blend_parameter;
    core_handle clip;
    bind_list blend;
    int loop;
    float speed;
    int on_enter, on_exit, on_tick, get_speed; // checked here, fetched again from the table
    bool has_enter, has_exit, has_tick, has_get_speed;
} state_options;

typedef struct transition_options {
    const char *from, *to, *event, *parameter;
    int condition, compare, fade;
    bool has_condition, uninterruptible, sync;
    float value, length;
} transition_options;

// What a callback needs: a userdata of Lua's, kept alive by a reference for the state's life, as a
// machine may outlast the tables it was made from.
typedef struct lua_functions {
    script *s;
    int enter, leave, tick, speed, condition; // references, LUA_NOREF without
} lua_functions;

static bool push_call(lua_functions *f, int ref, anim_instance instance) {
    if (ref == LUA_NOREF) {
        return false;
    }
    lua_State *L = f->s->L;
    luaL_checkstack(L, 8, "animation callbacks");
    lua_rawgeti(L, LUA_REGISTRYINDEX, ref);
    bind_push(f->s, L, &bind_animator_type, instance);
    return true;
}

static void call_enter(void *ctx, anim_world *w, anim_instance instance) {
    lua_functions *f = ctx;
    (void)w;
    if (push_call(f, f->enter, instance)) {
        script_call(f->s, BIND_STEP, 1, 0);
    }
}
static void call_exit(void *ctx, anim_world *w, anim_instance instance) {
    lua_functions *f = ctx;
    (void)w;
    if (push_call(f, f->leave, instance)) {
        script_call(f->s, BIND_STEP, 1, 0);
    }
}
static void call_tick(void *ctx, anim_world *w, anim_instance instance, float dt) {
    lua_functions *f = ctx;
    (void)w;
    if (push_call(f, f->tick, instance)) {
        lua_pushnumber(f->s->L, (double)dt);
        script_call(f->s, BIND_STEP, 2, 0);
    }
}

static float get_speed(void *ctx, anim_world *w, anim_instance instance, float phase) {
    lua_functions *f = ctx;
    (void)w;
    float speed = 1;
    if (push_call(f, f->speed, instance)) {
        lua_State *L = f->s->L;
        lua_pushnumber(L, (double)phase);
        if (script_call(f->s, BIND_STEP, 2, 1)) {
            speed = lua_isnumber(L, -1) ? (float)lua_tonumber(L, -1) : 1;
            lua_pop(L, 1);
        }
    }
    return speed;
}

// A condition that raises an error counts as false: the machine stays where it is.
static bool condition(void *ctx, anim_world *w, anim_instance instance) {
    lua_functions *f = ctx;
    (void)w;
    bool go = false;
    if (push_call(f, f->condition, instance) && script_call(f->s, BIND_STEP, 1, 1)) {
        go = lua_toboolean(f->s->L, -1);
        lua_pop(f->s->L, 1);
    }
    return go;
}

// Reference to the function `field` of the table on top of the stack.
static int take(lua_State *L, const char *field) {
    lua_getfield(L, -1, field);
    if (!lua_isfunction(L, -1)) {
        lua_pop(L, 1);
        return LUA_NOREF;
    }
    return luaL_ref(L, LUA_REGISTRYINDEX);
}

// Functions of list[i] in the options table at a stack index.
static lua_functions *functions_of(script *s, lua_State *L, int table, const char *list,
                                   uint32_t i) {
    lua_functions *f = lua_newuserdata(L, sizeof *f);
    luaL_ref(L, LUA_REGISTRYINDEX);
    f->s = s;
    lua_getfield(L, table, list);
    lua_rawgeti(L, -1, (int)i + 1);
    f->enter = take(L, "onEnter");
    f->leave = take(L, "onExit");
    f->tick = take(L, "onTick");
    f->speed = take(L, "getSpeed");
    f->condition = take(L, "condition");
    lua_pop(L, 2);
    return f;
}

// Points of a blend tree, in memory of Lua's that lives as long as the call.
static const anim_blend_point *read_points(lua_State *L, const bind_list *list) {
    if (list->count == 0) {
        return NULL;
    }
    luaL_checkstack(L, 4, "blend trees");
    anim_blend_point *point = lua_newuserdata(L, list->count * sizeof *point);
    for (uint32_t i = 0; i < list->count; i++) {
        const point_options *o = (const point_options *)list->items + i;
        point[i] = (anim_blend_point){o->clip, o->value};
    }
    return point;
}

static void read_state(script *s, lua_State *L, int table, const state_options *o, uint32_t i,
                       anim_state_desc *out) {
    *out = (anim_state_desc){.name = o->name,
                             .within = o->within,
                             .clip = o->clip,
                             .loop = (anim_loop)o->loop,
                             .speed = o->speed};
    out->blend = read_points(L, &o->blend);
    out->blend_count = o->blend.count;
    out->blend_parameter = o->blend_parameter;
    if (o->has_enter || o->has_exit || o->has_tick || o->has_get_speed) {
        out->ctx = functions_of(s, L, table, "states", i);
        out->on_enter = o->has_enter ? call_enter : NULL;
        out->on_exit = o->has_exit ? call_exit : NULL;
        out->on_tick = o->has_tick ? call_tick : NULL;
        out->speed_fn = o->has_get_speed ? get_speed : NULL;
    }
}

static void read_transition(script *s, lua_State *L, int table, const transition_options *o,
                            uint32_t i, anim_transition_desc *out) {
    int kinds = o->has_condition + (o->event != NULL) + (o->parameter != NULL);
    if (kinds > 1) {
        bind_error(L,
                   "corsac.anim.newMachine: transition %u to \"%s\": give one of condition, event "
                   "and parameter (none: when the clip is finished)",
                   i + 1, o->to);
    }
    *out = (anim_transition_desc){.from = o->from,
                                  .to = o->to,
                                  .event = o->event,
                                  .parameter = o->parameter,
                                  .compare = (anim_compare)o->compare,
                                  .value = o->value,
                                  .length = o->length,
                                  .fade = (anim_fade)o->fade,
                                  .uninterruptible = o->uninterruptible,
                                  .sync = o->sync};
    out->when = o->event       ? ANIM_WHEN_EVENT
                : o->parameter ? ANIM_WHEN_PARAMETER
                               : ANIM_WHEN_FINISHED;
    if (o->has_condition) {
        out->when = ANIM_WHEN_CONDITION;
        out->condition = condition;
        out->ctx = functions_of(s, L, table, "transitions", i);
    }
}

static int compare_parameters(const void *a, const void *b) {
    return strcmp(((const anim_parameter_desc *)a)->name, ((const anim_parameter_desc *)b)->name);
}

// {name = number, ...} in the order of names, whatever order Lua's table has.
static uint32_t read_parameters(lua_State *L, anim_parameter_desc out[ANIM_MAX_PARAMETERS]) {
    uint32_t count = 0;
    lua_getfield(L, 1, "parameters");
    lua_pushnil(L);
    while (lua_next(L, -2)) {
        if (lua_type(L, -2) != LUA_TSTRING || lua_type(L, -1) != LUA_TNUMBER ||
            count == ANIM_MAX_PARAMETERS) {
            bind_error(L,
                       "corsac.anim.newMachine: parameters: expected at most %u names with "
                       "numbers, {speed = 0}",
                       ANIM_MAX_PARAMETERS);
        }
        out[count++] = (anim_parameter_desc){lua_tostring(L, -2), (float)lua_tonumber(L, -1)};
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
    qsort(out, count, sizeof *out, compare_parameters);
    return count;
}

// States and transitions of the options at stack index `table`, in memory of Lua's.
static anim_machine_desc read_machine(script *s, lua_State *L, int table, const bind_list *states,
                                      const bind_list *transitions) {
    anim_machine_desc desc = anim_machine_desc_default();
    anim_state_desc *state = lua_newuserdata(L, (states->count + 1) * sizeof *state);
    anim_transition_desc *transition =
        lua_newuserdata(L, (transitions->count + 1) * sizeof *transition);
    for (uint32_t i = 0; i < states->count; i++) {
        read_state(s, L, table, (const state_options *)states->items + i, i, &state[i]);
    }
    for (uint32_t i = 0; i < transitions->count; i++) {
        read_transition(s, L, table, (const transition_options *)transitions->items + i, i,
                        &transition[i]);
    }
    desc.state = state;
    desc.state_count = states->count;
    desc.transition = transition;
    desc.transition_count = transitions->count;
    return desc;
}

int bind_machine_new(script *s, lua_State *L, void *args) {
    const bind_machine_options *o = &((bind_machine_call *)args)->options;
    anim_parameter_desc parameter[ANIM_MAX_PARAMETERS];
    anim_machine_desc desc = read_machine(s, L, 1, &o->states, &o->transitions);
    desc.initial = o->initial;
    desc.parameter = parameter;
    desc.parameter_count = o->has_parameters ? read_parameters(L, parameter) : 0;
    anim_machine machine = anim_machine_create(scene_anim(s->scene), &desc);
    if (core_handle_is_null(machine)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_machine_type, machine);
    return 1;
}

int bind_machine_extend(script *s, lua_State *L, void *args) {
    const bind_machine_extension *a = args;
    anim_world *w = scene_anim(s->scene);
    if (s->as_mod) {
        mod_extended before = {.machine = a->self};
        anim_machine_size(w, a->self, &before.states, &before.transitions);
        script_mod_extends(s, L, &before, a->more.states.count + a->more.transitions.count);
    }
    anim_machine_desc more = read_machine(s, L, 2, &a->more.states, &a->more.transitions);
    if (!anim_machine_extend(w, a->self, &more)) {
        bind_fail(L);
    }
    return 0;
}

// ---- declarations ----

#define CALLBACK(field, T, member, flag, what)                                                     \
    {                                                                                              \
        field, BIND_FUNCTION, BIND_AT(T, member), what, .optional = true, .def_text = "none",      \
                                                        BIND_GIVEN(T, flag)                        \
    }

static const bind_arg point_fields[] = {
    {"clip", BIND_OBJECT, BIND_AT(point_options, clip), "", .type = &bind_clip_type},
    {"value", BIND_FLOAT, BIND_AT(point_options, value),
     "of the parameter at which it plays alone"},
    {0}};

static const bind_arg state_fields[] = {
    {"name", BIND_STRING, BIND_AT(state_options, name), "unique in the machine"},
    {"within", BIND_STRING, BIND_AT(state_options, within),
     "a state listed before it, without clip and blend, that holds this one: a machine in a state; "
     "the "
     "first held is where it is entered",
     .optional = true, .def_text = NULL},
    {"clip", BIND_OBJECT, BIND_AT(state_options, clip), "what it plays", .optional = true,
     .def_text = "none", .type = &bind_clip_type},
    {"blend", BIND_LIST, BIND_AT(state_options, blend),
     "in place of clip: looping clips between which a parameter blends, values ascending",
     .optional = true, .fields = point_fields, .size = sizeof(point_options)},
    {"blendParameter", BIND_STRING, BIND_AT(state_options, blend_parameter),
     "a parameter of the machine", .optional = true, .def_text = NULL},
    {"loop", BIND_ENUM, BIND_AT(state_options, loop), "what happens at the clip's end",
     .optional = true, .values = "loop|once|pingpong"},
    {"speed", BIND_FLOAT, BIND_AT(state_options, speed), "factor on time; negative: backwards",
     .optional = true, .def = 1},
    CALLBACK("onEnter", state_options, on_enter, has_enter, "called with the animator"),
    CALLBACK("onExit", state_options, on_exit, has_exit, "called with the animator"),
    CALLBACK("onTick", state_options, on_tick, has_tick,
             "called each step with the animator and dt"),
    CALLBACK("getSpeed", state_options, get_speed, has_get_speed,
             "gives a factor on time; called with the animator and the phase from 0 to 1"),
    {0}};

static const bind_arg transition_fields[] = {
    {"from", BIND_STRING, BIND_AT(transition_options, from),
     "state it leaves, or any within it (nil: any other)", .optional = true, .def_text = NULL},
    {"to", BIND_STRING, BIND_AT(transition_options, to), "state it enters"},
    CALLBACK("condition", transition_options, condition, has_condition,
             "called each step with the animator; true starts it"),
    {"event", BIND_STRING, BIND_AT(transition_options, event), "starts when sent", .optional = true,
     .def_text = NULL},
    {"parameter", BIND_STRING, BIND_AT(transition_options, parameter),
     "starts when it compares so with value", .optional = true, .def_text = NULL},
    {"compare", BIND_ENUM, BIND_AT(transition_options, compare), "", .optional = true,
     .values = ">|<|>=|<=|==|~="},
    {"value", BIND_FLOAT, BIND_AT(transition_options, value), "", .optional = true},
    {"length", BIND_FLOAT, BIND_AT(transition_options, length), "of the cross-fade", "s",
     BIND_NOT_NEGATIVE, .optional = true},
    {"fade", BIND_ENUM, BIND_AT(transition_options, fade), "shape of the cross-fade",
     .optional = true, .values = "linear|smooth"},
    {"uninterruptible", BIND_BOOL, BIND_AT(transition_options, uninterruptible),
     "no other transition starts before its end", .optional = true},
    {"sync", BIND_BOOL, BIND_AT(transition_options, sync), "the target starts at the same phase",
     .optional = true},
    {0}};

const bind_arg bind_machine_fields[] = {
    {"initial", BIND_STRING, BIND_AT(bind_machine_options, initial), "state it starts in",
     .optional = true, .def_text = NULL},
    {"states", BIND_LIST, BIND_AT(bind_machine_options, states), "", .fields = state_fields,
     .size = sizeof(state_options)},
    {"transitions", BIND_LIST, BIND_AT(bind_machine_options, transitions),
     "the first that matches goes", .optional = true, .fields = transition_fields,
     .size = sizeof(transition_options)},
    {"parameters", BIND_TABLE, BIND_AT(bind_machine_options, parameters),
     "names with their first values", .optional = true, .def_text = "none",
     BIND_GIVEN(bind_machine_options, has_parameters)},
    {0}};

const bind_arg bind_machine_more_fields[] = {
    {"states", BIND_LIST, BIND_AT(bind_machine_more, states), "as in corsac.anim.newMachine",
     .optional = true, .fields = state_fields, .size = sizeof(state_options)},
    {"transitions", BIND_LIST, BIND_AT(bind_machine_more, transitions), "tried after those it has",
     .optional = true, .fields = transition_fields, .size = sizeof(transition_options)},
    {0}};
