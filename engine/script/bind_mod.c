// Both ends of modding: what the game offers (data, services, filters, the list of mods) and what
// only mods have (hooks, calls, patches).
#include "core/log.h"
#include "script/internal.h"
#include "script/mod.h"

#include <stdio.h>
#include <string.h>

typedef struct hook_args {
    const char *name;
    int fn;
} hook_args;
typedef struct value_args {
    const char *name;
    int value;
} value_args;
typedef struct switch_args {
    const char *name;
    bool on;
} switch_args;

// ---- the mod's end ----

static int add_hook(lua_State *L, const char *when, const hook_args *a) {
    lua_getfield(L, LUA_REGISTRYINDEX, "corsac.hooks");
    lua_getfield(L, -1, when);
    lua_pushstring(L, a->name);
    lua_rawget(L, -2);
    if (!lua_istable(L, -1)) {
        lua_pop(L, 1);
        lua_newtable(L);
        lua_pushstring(L, a->name);
        lua_pushvalue(L, -2);
        lua_rawset(L, -4);
    }
    int count = (int)lua_objlen(L, -1);
    if (count >= 64) {
        bind_error(L, "a mod hooks one event at most 64 times");
    }
    lua_pushvalue(L, a->fn);
    lua_rawseti(L, -2, count + 1);
    return 0;
}
static int hook_before(script *s, lua_State *L, void *args) {
    (void)s;
    return add_hook(L, "before", args);
}
static int hook_after(script *s, lua_State *L, void *args) {
    (void)s;
    return add_hook(L, "after", args);
}
static int hook_filter(script *s, lua_State *L, void *args) {
    (void)s;
    return add_hook(L, "filter", args);
}

// One call that crosses into the game's state: values in, values out, errors as texts.
typedef struct crossing {
    script *game;
    const char *lua; // function of "corsac.lua" that serves it
    const script_pack *in;
    script_pack *out;
} crossing;

static int cross_protected(lua_State *L) {
    crossing *c = lua_touserdata(L, 1);
    lua_settop(L, 0);
    lua_getfield(L, LUA_REGISTRYINDEX, "corsac.serve");
    lua_getfield(L, -1, c->lua);
    lua_remove(L, 1);
    int argc = script_unpack(c->game, L, c->in);
    lua_call(L, argc, LUA_MULTRET);
    int count = lua_gettop(L);
    for (int i = 1; i <= count; i++) {
        script_pack_value(c->game, L, i, c->out);
    }
    return 0;
}

// Packs values [first, top] of the mod's L, calls the game, pushes what it gave.
static int cross(script *s, lua_State *L, const char *lua, int first) {
    script *game = s->as_mod->game;
    int last = lua_gettop(L);
    script_pack *in = script_pack_new(L), *out = script_pack_new(L);
    for (int i = first; i <= last; i++) {
        script_pack_value(s, L, i, in);
    }
    crossing c = {game, lua, in, out};
    lua_State *G = game->service; // the game itself may be inside a coroutine
    if (lua_cpcall(G, cross_protected, &c) != 0) {
        char why[512];
        const char *text = lua_tostring(G, -1);
        snprintf(why, sizeof why, "%s", text ? text : "the game's service failed");
        lua_pop(G, 1);
        bind_error(L, "%s", why);
    }
    return script_unpack(s, L, out);
}

typedef struct rest_args {
    const char *name;
    int first;
} rest_args;
static int call_service(script *s, lua_State *L, void *args) {
    (void)args;
    return cross(s, L, "call", 1);
}
static int patch(script *s, lua_State *L, void *args) {
    (void)args;
    lua_pushstring(L, s->as_mod->name);
    lua_insert(L, 1);
    return cross(s, L, "patch", 1);
}
static int get_data(script *s, lua_State *L, void *args) {
    (void)args;
    return cross(s, L, "data", 1);
}

// ---- the game's end ----

static script_mod *named(script *s, lua_State *L, const char *name) {
    bind_names names = {.count = 0};
    for (int i = 0; i < s->mod_count; i++) {
        if (strcmp(s->mods[i]->name, name) == 0) {
            return s->mods[i];
        }
        bind_names_add(&names, s->mods[i]->name);
    }
    const char *near = bind_nearest(name, &names);
    bind_error(L, "no mod \"%.48s\" is loaded%s%s%s", name, near ? "; did you mean \"" : "",
               near ? near : "", near ? "\"?" : "");
}

static int set_enabled(script *s, lua_State *L, void *args) {
    const switch_args *a = args;
    script_mod *m = named(s, L, a->name);
    m->enabled = a->on;
    m->strikes = 0;
    return 0;
}

static void set_number(lua_State *L, const char *name, double value) {
    lua_pushnumber(L, value);
    lua_setfield(L, -2, name);
}

static int list_mods(script *s, lua_State *L, void *args) {
    (void)args;
    lua_createtable(L, s->mod_count, 0);
    for (int i = 0; i < s->mod_count; i++) {
        const script_mod *m = s->mods[i];
        lua_newtable(L);
        lua_pushstring(L, m->name);
        lua_setfield(L, -2, "name");
        lua_pushstring(L, m->version);
        lua_setfield(L, -2, "version");
        lua_pushboolean(L, m->enabled);
        lua_setfield(L, -2, "enabled");
        set_number(L, "errors", m->errors);
        set_number(L, "calls", (double)m->calls);
        set_number(L, "instructions", (double)m->instructions);
        set_number(L, "bytes", (double)m->guard.bytes);
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

static int filter(script *s, lua_State *L, void *args) {
    const value_args *a = args;
    if (s->mod_count == 0) {
        lua_pushvalue(L, a->value);
        return 1;
    }
    script_pack *value = script_pack_new(L);
    script_pack_value(s, L, a->value, value);
    script_mods_filter(s, a->name, value);
    value->values = CORE_MIN(value->values, 1);
    return script_unpack(s, L, value);
}

// ---- declarations ----

#define NAME_ARG(what)                                                                             \
    { "name", BIND_STRING, BIND_AT(hook_args, name), what }
#define HOOK(fn_name, text, handler)                                                               \
    {                                                                                              \
        fn_name, text,                                                                             \
            BIND_ARGS(NAME_ARG("load, fixed, update, draw, quit, or an event of the game"),        \
                      {"fn", BIND_FUNCTION, BIND_AT(hook_args, fn), "called with plain data"}),    \
            NULL, sizeof(hook_args), BIND_ANY, .mod = true, .mod_only = true, .cost = 20,          \
                                               .run = handler                                      \
    }

static const bind_fn mod_functions[] = {
    HOOK("before", "In mods: calls a function before an event of the game.", hook_before),
    HOOK("after", "In mods: calls a function after an event of the game.", hook_after),
    HOOK("filter", "In mods: gives a function the value of a filter; what it returns replaces it.",
         hook_filter),
    {"call", "In mods: calls a function of a service that the game exports.",
     BIND_ARGS({"service", BIND_STRING, BIND_AT(rest_args, name), "\"service.function\""},
               {"...", BIND_REST, BIND_AT(rest_args, first), "plain data and objects"}),
     BIND_RETURNS({"...", "any", NULL}), sizeof(rest_args), BIND_RUNNING, .mod = true,
     .mod_only = true, .cost = 500, .run = call_service},
    {"patch", "In mods: merges a table into data that the game declares with corsac.mods.data.",
     BIND_ARGS(NAME_ARG("of the data"),
               {"changes", BIND_TABLE, BIND_AT(hook_args, fn), "fields to add or replace"}),
     NULL, sizeof(hook_args), BIND_TOP | BIND_LOAD, .mod = true, .mod_only = true, .cost = 500,
     .immediate = true, .run = patch},
    {"getData", "In mods: a copy of the game's data of that name, or nil.",
     BIND_ARGS(NAME_ARG("of the data")), BIND_RETURNS({"data", "table?", NULL}), sizeof(hook_args),
     BIND_RUNNING, .mod = true, .mod_only = true, .cost = 500, .run = get_data},
    {0}};

static const bind_fn mods_functions[] = {
    {"list", "The mods in order: name, version, enabled, errors, calls, instructions, bytes.", NULL,
     BIND_RETURNS({"mods", "table[]", NULL}), 0, BIND_VIEW | BIND_QUIT, .run = list_mods},
    {"setEnabled", "Switches a mod on or off from now on.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(switch_args, name), "of the mod"},
               {"on", BIND_BOOL, BIND_AT(switch_args, on), ""}),
     NULL, sizeof(switch_args), BIND_SIM, .run = set_enabled},
    {"filter",
     "Gives a value to the mods' filters of that name, in order, and returns what is left.",
     BIND_ARGS(NAME_ARG("of the filter"),
               {"value", BIND_VALUE, BIND_AT(value_args, value), "plain data or an object"}),
     BIND_RETURNS({"value", "any", NULL}), sizeof(value_args), BIND_SIM, .run = filter},
    {"export", "Offers functions to mods under a name; they get and give plain data and objects.",
     BIND_ARGS(NAME_ARG("of the service"),
               {"functions", BIND_TABLE, BIND_AT(hook_args, fn), "name = function"}),
     NULL, sizeof(hook_args), BIND_TOP | BIND_LOAD, .run = NULL},
    {"data", "Declares data that mods may patch, and returns it with their patches.",
     BIND_ARGS(NAME_ARG("of the data"), {"data", BIND_TABLE, BIND_AT(hook_args, fn), "plain data"}),
     BIND_RETURNS({"data", "table", NULL}), sizeof(hook_args), BIND_TOP | BIND_LOAD, .run = NULL},
    {0}};

static const bind_module modules[] = {
    {"corsac.mod", "What only mods have.", mod_functions},
    {"corsac.mods", "What a game offers to mods.", mods_functions},
    {0}};

const bind_room bind_mod_room = {"mod", modules, NULL};
