#include "script/events.h"

#include "script/bind_body.h"
#include "script/bind_region.h"
#include "script/mod.h"

#define SWEEP_EVERY 256 // functions given to bodies between two searches for dead ones

// Registry tables by the addresses of these: handle's bits -> {function, function, function}; the
// third is the list of destroyed triggers.
static const char callback_keys[3], gone_key;

static void push_table(lua_State *L, const char *key) {
    lua_pushlightuserdata(L, (void *)(uintptr_t)key);
    lua_rawget(L, LUA_REGISTRYINDEX);
    if (lua_isnil(L, -1)) {
        lua_pop(L, 1);
        lua_newtable(L);
        lua_pushlightuserdata(L, (void *)(uintptr_t)key);
        lua_pushvalue(L, -2);
        lua_rawset(L, LUA_REGISTRYINDEX);
    }
}

static void push_bits(lua_State *L, core_handle h) {
    lua_pushnumber(L, (double)h.index + (double)h.generation * 4294967296.0);
}

static core_handle handle_of_bits(double bits) {
    double generation = core_floor(bits / 4294967296.0);
    return (core_handle){(uint32_t)(bits - generation * 4294967296.0), (uint32_t)generation};
}

// Bodies die without a word to their scripts: their functions are looked for now and then.
static void sweep(script *s, lua_State *L, int table) {
    phys_world *world = scene_phys(s->scene);
    lua_pushnil(L);
    while (lua_next(L, table)) {
        lua_pop(L, 1);
        if (!phys_body_alive(world, handle_of_bits(lua_tonumber(L, -1)))) {
            lua_pushvalue(L, -1);
            lua_pushnil(L);
            lua_rawset(L, table); // clearing a field during the walk is allowed
        }
    }
}

void script_keep_callbacks(script *s, lua_State *L, script_callbacks kind, core_handle h,
                           const int functions[3]) {
    push_table(L, &callback_keys[kind]);
    int table = lua_gettop(L);
    if (kind == SCRIPT_ON_CONTACT && ++s->contact_callbacks % SWEEP_EVERY == 0) {
        sweep(s, L, table);
    }
    push_bits(L, h);
    lua_createtable(L, 3, 0);
    for (int i = 0; i < 3; i++) {
        if (functions[i]) {
            lua_pushvalue(L, functions[i]);
            lua_rawseti(L, -2, i + 1);
        }
    }
    lua_rawset(L, table);
    lua_pop(L, 1);
}

void script_forget_trigger(lua_State *L, core_handle trigger) {
    push_table(L, &gone_key);
    push_bits(L, trigger);
    lua_rawseti(L, -2, (int)lua_objlen(L, -2) + 1);
    lua_pop(L, 1);
}

// The functions of the first `count` destroyed triggers go; the list keeps the later ones.
static void drop_gone(lua_State *L, int callbacks, int count) {
    push_table(L, &gone_key);
    int all = (int)lua_objlen(L, -1);
    for (int i = 1; i <= all; i++) {
        lua_rawgeti(L, -1, i);
        if (i <= count) {
            lua_pushnil(L);
            lua_rawset(L, callbacks);
        } else {
            lua_rawseti(L, -2, i - count);
        }
    }
    for (int i = all - count + 1; i <= all; i++) {
        lua_pushnil(L);
        lua_rawseti(L, -2, i);
    }
    lua_pop(L, 1);
}

// ---- the events of a step ----

static void push_body_or_nil(script *s, phys_body body) {
    bool alive = phys_body_alive(scene_phys(s->scene), body);
    bind_push(s, s->L, &bind_body_type, alive ? body : CORE_NULL_HANDLE);
}

// Pushes function `which` of an object when it has one.
static bool push_function(lua_State *L, script_callbacks kind, core_handle h, int which) {
    push_table(L, &callback_keys[kind]);
    push_bits(L, h);
    lua_rawget(L, -2);
    lua_remove(L, -2);
    if (lua_istable(L, -1)) {
        lua_rawgeti(L, -1, which);
        lua_remove(L, -2);
    }
    if (lua_isfunction(L, -1)) {
        return true;
    }
    lua_pop(L, 1);
    return false;
}

static bool call(script *s, int argc) {
    if (!script_call(s, BIND_STEP, argc, 0) && !s->keep_going) {
        s->stopped |= BIND_STEP;
    }
    return !(s->stopped & BIND_STEP);
}

static bool on_trigger(script *s, const phys_event *e) {
    phys_world *world = scene_phys(s->scene);
    if (!push_function(s->L, SCRIPT_ON_TRIGGER, e->trigger, (int)e->kind + 1)) {
        return true;
    }
    push_body_or_nil(s, e->a);
    bool alive = phys_trigger_alive(world, e->trigger);
    bind_push(s, s->L, &bind_trigger_type, alive ? e->trigger : CORE_NULL_HANDLE);
    return call(s, 2);
}

// `self` hears of `other`; the normal points from self to other.
static bool on_contact(script *s, const phys_event *e, phys_body self, phys_body other,
                       float side) {
    bool end = e->kind == PHYS_CONTACT_END;
    int which = end ? 2 : e->kind == PHYS_CONTACT_HIT ? 3 : 1;
    if (!phys_body_alive(scene_phys(s->scene), self) ||
        !push_function(s->L, SCRIPT_ON_CONTACT, self, which)) {
        return true;
    }
    push_body_or_nil(s, self);
    push_body_or_nil(s, other);
    if (end) {
        return call(s, 2);
    }
    lua_pushnumber(s->L, (double)e->speed);
    bind_push_vec3(s->L, core_v3_scale(e->normal, side));
    return call(s, 6);
}

static bool on_break(script *s, const phys_event *e) {
    if (!push_function(s->L, SCRIPT_ON_BREAK, e->joint, 1)) {
        return true;
    }
    push_table(s->L, &callback_keys[SCRIPT_ON_BREAK]);
    push_bits(s->L, e->joint);
    lua_pushnil(s->L);
    lua_rawset(s->L, -3);
    lua_pop(s->L, 1);
    push_body_or_nil(s, e->a);
    push_body_or_nil(s, e->b);
    return call(s, 2);
}

static void tell(script *s) {
    phys_world *world = scene_phys_if(s->scene);
    uint32_t count = 0;
    const phys_event *event = world ? phys_world_events(world, &count) : NULL;
    if (s->stopped & BIND_STEP || !count) {
        return;
    }
    lua_State *L = s->L;
    push_table(L, &gone_key);
    int gone = (int)lua_objlen(L, -1);
    lua_pop(L, 1);
    bool go = true;
    for (uint32_t i = 0; i < count && go; i++) {
        if (event[i].kind <= PHYS_TRIGGER_EXIT) {
            go = on_trigger(s, &event[i]);
        } else if (event[i].kind == PHYS_JOINT_BREAK) {
            go = on_break(s, &event[i]);
        } else {
            go = on_contact(s, &event[i], event[i].a, event[i].b, 1.0f) &&
                 on_contact(s, &event[i], event[i].b, event[i].a, -1.0f);
        }
    }
    if (gone) {
        push_table(L, &callback_keys[SCRIPT_ON_TRIGGER]);
        drop_gone(L, lua_gettop(L), gone);
        lua_pop(L, 1);
    }
}

void script_step_events(script *s) {
    tell(s);
    for (int i = 0; i < s->mod_count; i++) {
        if (s->mods[i]->started && s->mods[i]->enabled) {
            tell(s->mods[i]->view);
        }
    }
}
