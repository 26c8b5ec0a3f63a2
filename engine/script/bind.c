// Calls from Lua into the declared functions, the objects they give, and how both come into a
// state.
#include "script/bind_check.h"
#include "script/internal.h"
#include "script/mod.h"

#include "core/nearest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BIND_ARGS_BYTES = 2048 };

static int run_noting(script *s, lua_State *L, const bind_fn *fn, void *args) {
    int returns = fn->run(s, L, args);
    if (s->as_mod) {
        script_mod_made(s, L, fn);
    }
    return returns;
}

// Upvalues: the declaration, the script, the owner's name, and the Lua half when it has one.
static int call_function(lua_State *L) {
    const bind_fn *fn = lua_touserdata(L, lua_upvalueindex(1));
    script *s = lua_touserdata(L, lua_upvalueindex(2));
    bind_path path = {.L = L, .s = s, .owner = lua_tostring(L, lua_upvalueindex(3))};
    _Alignas(16) unsigned char args[BIND_ARGS_BYTES];
    memset(args, 0, fn->size);
    int top = lua_gettop(L);
    bind_check_phase(s, L, fn, path.owner);
    bind_check_args(&path, fn, 1, args);
    if (s->as_mod) {
        script_mod_charge(s, L, fn);
        if (fn->run && script_mod_defer(s, L, fn, NULL, CORE_NULL_HANDLE, args, fn->size)) {
            return 0;
        }
    }
    if (fn->run) {
        return run_noting(s, L, fn, args);
    }
    lua_settop(L, top);
    lua_pushvalue(L, lua_upvalueindex(4));
    lua_insert(L, 1);
    lua_call(L, top, LUA_MULTRET);
    return lua_gettop(L);
}

static int call_module(lua_State *L) { // corsac.expect(...): drop the module itself
    lua_remove(L, 1);
    return call_function(L);
}

static int call_numbers(bind_path *path, const bind_fn *fn, core_handle self) {
    lua_State *L = path->L;
    double v[BIND_NUMBERS_MAX] = {0};
    bind_arg args[BIND_NUMBERS_MAX + 1] = {{0}};
    bind_fn located = *fn; // the same declaration, its members placed in v
    for (int i = 0; fn->args && fn->args[i].name; i++) {
        args[i] = fn->args[i];
        args[i].at = (size_t)i * sizeof v[0];
    }
    located.args = fn->args ? args : NULL;
    bind_check_args(path, &located, 2, (unsigned char *)v);
    const bind_type *type = lua_touserdata(L, lua_upvalueindex(4));
    if (path->s->as_mod && script_mod_defer(path->s, L, fn, type, self, v, sizeof v)) {
        return 0;
    }
    if (!fn->numbers(path->s, self, v)) {
        bind_fail(L);
    }
    int returns = 0;
    for (; fn->returns && fn->returns[returns].name; returns++) {
        lua_pushnumber(L, v[returns]);
    }
    return returns;
}

static int call_method(lua_State *L) {
    const bind_fn *fn = lua_touserdata(L, lua_upvalueindex(1));
    script *s = lua_touserdata(L, lua_upvalueindex(2));
    const bind_type *type = lua_touserdata(L, lua_upvalueindex(4));
    bind_path path = {.L = L, .s = s, .owner = lua_tostring(L, lua_upvalueindex(3))};
    if (bind_type_at(s, L, 1) != type) {
        char got[96];
        bind_describe_value(s, L, 1, got, sizeof got);
        bind_error(L, "%s: expected %s %s before the colon, got %s; write object:%s(...)",
                   path.owner, bind_article(type->name), type->name, got, fn->name);
    }
    const bind_object *object = lua_touserdata(L, 1);
    if (!type->alive(s, object->handle)) {
        if (strcmp(fn->name, "isDestroyed") == 0) {
            lua_pushboolean(L, 1);
            return 1;
        }
        bind_error(L, "%s: this %s was destroyed", path.owner, type->name);
    }
    _Alignas(16) unsigned char args[BIND_ARGS_BYTES];
    memset(args, 0, fn->size);
    memcpy(args, &object->handle, sizeof object->handle);
    bind_check_phase(s, L, fn, path.owner);
    if (s->as_mod) {
        script_mod_charge(s, L, fn);
    }
    if (fn->numbers) {
        return call_numbers(&path, fn, object->handle);
    }
    bind_check_args(&path, fn, 2, args);
    if (s->as_mod && script_mod_defer(s, L, fn, type, object->handle, args, fn->size)) {
        return 0;
    }
    return run_noting(s, L, fn, args);
}

bool bind_call_numbers(script *s, const bind_fn *fn, const bind_type *type, uint32_t index,
                       uint32_t generation, double *v) {
    core_handle self = {index, generation};
    return (fn->phases & s->phase) && type->alive(s, self) && fn->numbers(s, self, v);
}

// ---- names that do not exist ----

static int unknown_name(lua_State *L) {
    const char *owner = lua_tostring(L, lua_upvalueindex(1));
    const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : luaL_typename(L, 2);
    bind_names names = {.count = 0};
    lua_pushnil(L);
    while (lua_next(L, lua_upvalueindex(2))) { // names of the module or the class
        lua_pop(L, 1);
        if (lua_type(L, -1) == LUA_TSTRING) {
            bind_names_add(&names, lua_tostring(L, -1));
        }
    }
    const char *near = bind_nearest(name, &names);
    if (near) {
        bind_error(L, "%s has no \"%.40s\"; did you mean \"%s\"?", owner, name, near);
    }
    bind_error(L, "%s has no \"%.40s\"", owner, name);
}

static int refuse_assignment(lua_State *L) {
    const char *owner = lua_tostring(L, lua_upvalueindex(1));
    const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : luaL_typename(L, 2);
    bind_error(L,
               "%s holds no fields of yours (\"%.40s\"); keep your data in a table of your own, "
               "with the object as key",
               owner, name);
}

static const char *const callbacks[] = {"load",  "fixed", "update", "draw",
                                        "event", "quit",  "conf",   "reload"};

static int assign_callback(lua_State *L) {
    const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
    for (size_t i = 0; i < CORE_COUNT_OF(callbacks); i++) {
        if (strcmp(callbacks[i], name) == 0) {
            if (!lua_isfunction(L, 3) && !lua_isnil(L, 3)) {
                bind_error(L, "corsac.%s must be a function, got a %s", name, luaL_typename(L, 3));
            }
            lua_rawset(L, 1);
            return 0;
        }
    }
    const char *near = core_nearest(name, callbacks, CORE_COUNT_OF(callbacks));
    if (near) {
        bind_error(L, "corsac has no callback \"%.40s\"; did you mean \"%s\"?", name, near);
    }
    bind_error(L,
               "corsac has no callback \"%.40s\"; callbacks are load, fixed, update, draw, event, "
               "quit, conf, reload",
               name);
}

static int callback_or_unknown(lua_State *L) {
    for (size_t i = 0; lua_type(L, 2) == LUA_TSTRING && i < CORE_COUNT_OF(callbacks); i++) {
        if (strcmp(callbacks[i], lua_tostring(L, 2)) == 0) {
            return 0; // not defined: nil
        }
    }
    return unknown_name(L);
}

// ---- objects ----

void bind_push_vec3(lua_State *L, core_vec3 v) {
    lua_pushnumber(L, (double)v.x);
    lua_pushnumber(L, (double)v.y);
    lua_pushnumber(L, (double)v.z);
}

void bind_push_quat(lua_State *L, core_quat q) {
    lua_pushnumber(L, (double)q.x);
    lua_pushnumber(L, (double)q.y);
    lua_pushnumber(L, (double)q.z);
    lua_pushnumber(L, (double)q.w);
}

static script_type_slot *slot_of(script *s, const bind_type *type) {
    for (int i = 0; i < s->type_count; i++) {
        if (s->type[i].type == type) {
            return &s->type[i];
        }
    }
    return NULL;
}

void bind_push(script *s, lua_State *L, const bind_type *type, core_handle h) {
    if (core_handle_is_null(h)) {
        lua_pushnil(L);
        return;
    }
    const script_type_slot *slot = slot_of(s, type);
    lua_rawgeti(L, LUA_REGISTRYINDEX, slot->cache_ref);
    lua_rawgeti(L, -1, (int)h.index);
    const bind_object *old = lua_touserdata(L, -1);
    if (old && core_handle_equal(old->handle, h)) {
        lua_remove(L, -2);
        return;
    }
    lua_pop(L, 1);
    bind_object *object = lua_newuserdata(L, sizeof *object);
    *object = (bind_object){.handle = h, .type = type};
    lua_rawgeti(L, LUA_REGISTRYINDEX, slot->metatable_ref);
    lua_setmetatable(L, -2);
    lua_pushvalue(L, -1);
    lua_rawseti(L, -3, (int)h.index);
    lua_remove(L, -2);
}

core_handle bind_object_handle(script *s, lua_State *L, int index, const bind_type *type) {
    if (bind_type_at(s, L, index) != type) {
        return CORE_NULL_HANDLE;
    }
    return ((const bind_object *)lua_touserdata(L, index))->handle;
}

static int object_text(lua_State *L) {
    const bind_object *object = lua_touserdata(L, 1);
    if (!object) {
        lua_pushliteral(L, "object");
        return 1;
    }
    lua_pushfstring(L, "%s %d", object->type->name, (int)object->handle.index);
    return 1;
}

// ---- installation ----

static void push_closure(script *s, lua_State *L, const bind_fn *fn, const char *owner,
                         const bind_type *type) {
    lua_pushlightuserdata(L, (void *)(uintptr_t)fn);
    lua_pushlightuserdata(L, s);
    bool method = type != NULL, itself = fn->name[0] == 0;
    lua_pushfstring(L, "%s%s%s", owner, method ? ":" : itself ? "" : ".", fn->name);
    if (method) {
        lua_pushlightuserdata(L, (void *)(uintptr_t)type);
        lua_pushcclosure(L, call_method, 4);
        return;
    }
    if (!fn->run) { // its Lua half was left in the registry by the prelude
        lua_getfield(L, LUA_REGISTRYINDEX, "corsac.lua");
        lua_getfield(L, -1, lua_tostring(L, -2));
        lua_remove(L, -2);
    }
    lua_pushcclosure(L, itself ? call_module : call_function, fn->run ? 3 : 4);
}

static void install_type(script *s, lua_State *L, const bind_type *type, bool mod) {
    script_type_slot *slot = &s->type[s->type_count++];
    slot->type = type;
    lua_newtable(L); // methods
    for (const bind_fn *fn = type->methods; fn->name; fn++) {
        if (mod ? fn->mod : !fn->mod_only) {
            push_closure(s, L, fn, type->name, type);
            lua_setfield(L, -2, fn->name);
        }
    }
    lua_newtable(L); // unknown methods
    lua_pushstring(L, type->name);
    lua_pushvalue(L, -3);
    lua_pushcclosure(L, unknown_name, 2);
    lua_setfield(L, -2, "__index");
    lua_setmetatable(L, -2);

    lua_newtable(L); // metatable of the objects
    slot->metatable = lua_topointer(L, -1);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "__index");
    lua_pushstring(L, type->name);
    lua_pushcclosure(L, refuse_assignment, 1);
    lua_setfield(L, -2, "__newindex");
    lua_pushcfunction(L, object_text);
    lua_setfield(L, -2, "__tostring");
    lua_pushstring(L, type->name);
    lua_setfield(L, -2, "__metatable");
    slot->metatable_ref = luaL_ref(L, LUA_REGISTRYINDEX);
    lua_pop(L, 1);

    lua_newtable(L); // cache
    lua_newtable(L);
    lua_pushliteral(L, "v");
    lua_setfield(L, -2, "__mode");
    lua_setmetatable(L, -2);
    slot->cache_ref = luaL_ref(L, LUA_REGISTRYINDEX);
}

// Pushes the table at a dotted path under the globals, making what is missing.
static void push_module(lua_State *L, const char *path) {
    lua_pushvalue(L, LUA_GLOBALSINDEX);
    while (*path) {
        size_t length = strcspn(path, ".");
        lua_pushlstring(L, path, length);
        lua_rawget(L, -2);
        if (!lua_istable(L, -1)) {
            lua_pop(L, 1);
            lua_newtable(L);
            lua_pushlstring(L, path, length);
            lua_pushvalue(L, -2);
            lua_rawset(L, -4);
        }
        lua_remove(L, -2);
        path += length + (path[length] == '.');
    }
}

static bool has_functions(const bind_module *module, bool mod) {
    for (const bind_fn *fn = module->functions; fn->name; fn++) {
        if (mod ? fn->mod : !fn->mod_only) {
            return true;
        }
    }
    return false;
}

static void install_module(script *s, lua_State *L, const bind_module *module, bool mod) {
    if (!has_functions(module, mod)) {
        return;
    }
    push_module(L, module->path);
    if (!lua_getmetatable(L, -1)) {
        lua_newtable(L);
        bool root = strcmp(module->path, "corsac") == 0;
        lua_pushstring(L, module->path);
        lua_pushvalue(L, -3);
        lua_pushcclosure(L, root ? callback_or_unknown : unknown_name, 2);
        lua_setfield(L, -2, "__index");
        lua_pushstring(L, module->path);
        lua_pushcclosure(L, root ? assign_callback : refuse_assignment, 1);
        lua_setfield(L, -2, "__newindex");
        lua_pushliteral(L, "corsac");
        lua_setfield(L, -2, "__metatable");
        lua_pushvalue(L, -1);
        lua_setmetatable(L, -3);
    }
    for (const bind_fn *fn = module->functions; fn->name; fn++) {
        if (mod ? !fn->mod : fn->mod_only) {
            continue;
        }
        push_closure(s, L, fn, module->path, NULL);
        if (fn->name[0] == 0) {
            lua_setfield(L, -2, "__call");
        } else {
            lua_pushstring(L, fn->name);
            lua_insert(L, -2);
            lua_rawset(L, -4);
        }
    }
    lua_pop(L, 2);
}

void bind_install(script *s, lua_State *L, bool mod) {
    for (int r = 0; bind_rooms[r]; r++) {
        for (int t = 0; bind_rooms[r]->types && bind_rooms[r]->types[t]; t++) {
            install_type(s, L, bind_rooms[r]->types[t], mod);
        }
    }
    for (int r = 0; bind_rooms[r]; r++) {
        for (const bind_module *m = bind_rooms[r]->modules; m->path; m++) {
            install_module(s, L, m, mod);
        }
    }
}
