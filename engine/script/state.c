// Makes Lua states: LuaJIT's libraries cut down and remade by scripts/corsac/base.lua, with the C
// half of it here.
#include "core/log.h"
#include "script/bind_body.h"
#include "script/embedded.h"
#include "script/fast.h"
#include "script/files.h"
#include "script/internal.h"
#include "script/libc.h"
#include "script/mod.h"
#include "script/order.h"

#include <lualib.h>
#include <stdio.h>
#include <string.h>

static script *self(lua_State *L) { return lua_touserdata(L, lua_upvalueindex(1)); }

const char *script_embedded(const char *name, size_t *size) {
    for (const script_embedded_file *file = script_embedded_files; file->name; file++) {
        if (strcmp(file->name, name) == 0) {
            *size = file->size;
            return file->text;
        }
    }
    return NULL;
}

static bool load_text(lua_State *L, const char *text, size_t size, const char *chunk) {
    return luaL_loadbufferx(L, text, size, chunk, "t") == 0;
}

bool script_load_chunk(script *s, lua_State *L, const char *path) {
    char chunk[300];
    bool internal = strncmp(path, "corsac/", 7) == 0;
    core_vfs *vfs = s->scene ? scene_vfs(s->scene) : NULL;
    snprintf(chunk, sizeof chunk, "%s%s", internal ? "=" : "@", path);
    size_t size;
    if (vfs && (!internal || core_vfs_exists(vfs, path))) {
        char *text = core_vfs_read(vfs, path, &size);
        if (!text) {
            lua_pushstring(L, core_last_error());
            return false;
        }
        bool good = load_text(L, text, size, chunk);
        core_free(text);
        if (s->watched && !internal) {
            script_watch_file(s, path);
        }
        return good;
    }
    const char *text = internal ? script_embedded(path + 7, &size) : NULL;
    if (!text) {
        lua_pushfstring(L, "no file \"%s\"", path);
        return false;
    }
    return load_text(L, text, size, chunk);
}

// ---- the functions base.lua builds on ----

static int engine_simulating(lua_State *L) {
    lua_pushboolean(L, (self(L)->phase & (BIND_SIM | BIND_TOP | BIND_CONF)) != 0);
    return 1;
}

core_rng *script_stream(script *s) {
    if (s->as_mod) {
        return script_mod_stream(s->as_mod);
    }
    bool view = (s->phase & BIND_VIEW) != 0;
    return scene_rng(s->scene, view ? CORE_RNG_VIEW : CORE_RNG_SIM);
}

static int engine_random(lua_State *L) {
    lua_pushnumber(L, core_rng_double(script_stream(self(L))));
    return 1;
}

static int engine_reseed(lua_State *L) {
    core_rng *rng = script_stream(self(L));
    double seed = lua_tonumber(L, 1);
    uint64_t bits;
    memcpy(&bits, &seed, sizeof bits);
    *rng = core_rng_make(bits, rng->stream);
    return 0;
}

// bodyAt(row) -> Body
static int engine_body_at(lua_State *L) {
    script *s = self(L);
    phys_world *world = scene_phys_if(s->scene);
    double row = lua_tonumber(L, 1);
    if (!world || lua_type(L, 1) != LUA_TNUMBER || row < 0 || row >= phys_body_count(world)) {
        bind_error(L, "columns: handle(row) expects a row from 0 to n - 1");
    }
    bind_push(s, L, &bind_body_type, phys_body_at(world, (uint32_t)row));
    return 1;
}

static int engine_callback_count(lua_State *L) {
    lua_pushnumber(L, (double)self(L)->callback_count);
    return 1;
}

static int engine_dt(lua_State *L) {
    lua_pushnumber(L, (double)scene_dt(self(L)->scene));
    return 1;
}

static int engine_wake(lua_State *L) {
    self(L)->awake = true;
    return 0;
}

static int engine_set_task(lua_State *L) {
    self(L)->task = lua_tothread(L, 1);
    return 0;
}

static int engine_get_task(lua_State *L) {
    lua_State *task = self(L)->task;
    if (!task) {
        return 0;
    }
    lua_pushthread(task);
    lua_xmove(task, L, 1);
    return 1;
}

// report(thread, message): an error that ended a coroutine.
static int engine_report(lua_State *L) {
    lua_State *thread = lua_tothread(L, 1);
    lua_settop(L, 2);
    lua_xmove(L, thread, 1);
    script_push_report(self(L), thread);
    lua_xmove(thread, L, 1);
    script_record_error(self(L), L);
    return 0;
}

// protect(fn, ...): an error is recorded, and what follows goes on.
static int engine_protect(lua_State *L) {
    script_protected(self(L), L, lua_gettop(L) - 1, 0);
    return 0;
}

// near(name, table) -> '; did you mean "x"?' or ""
// where(): "file:line: " of the innermost frame of a script, for errors of the API's own half.
static int engine_where(lua_State *L) {
    bind_push_where(L);
    return 1;
}

static int engine_near(lua_State *L) {
    bind_names names = {.count = 0};
    if (lua_type(L, 1) != LUA_TSTRING) {
        lua_pushliteral(L, "");
        return 1;
    }
    lua_pushnil(L);
    while (lua_next(L, 2)) {
        lua_pop(L, 1);
        if (lua_type(L, -1) == LUA_TSTRING) {
            bind_names_add(&names, lua_tostring(L, -1));
        }
    }
    const char *near = bind_nearest(lua_tostring(L, 1), &names);
    if (near) {
        lua_pushfstring(L, "; did you mean \"%s\"?", near);
    } else {
        lua_pushliteral(L, "");
    }
    return 1;
}

static int engine_rawmeta(lua_State *L) { return lua_getmetatable(L, 1); }

// modEvent(before, name, ...): tells the mods of an event of the game.
static int engine_mod_event(lua_State *L) {
    script *s = self(L);
    if (s->mod_count == 0) {
        return 0;
    }
    int last = lua_gettop(L);
    script_pack *args = script_pack_new(L);
    for (int i = 3; i <= last; i++) {
        script_pack_value(s, L, i, args);
    }
    script_mods_event(s, lua_tostring(L, 2), lua_toboolean(L, 1), args);
    return 0;
}

static int engine_at_top(lua_State *L) {
    lua_pushboolean(L, self(L)->phase == BIND_TOP);
    return 1;
}

static int engine_has_mods(lua_State *L) {
    lua_pushboolean(L, self(L)->mod_count > 0);
    return 1;
}

static int engine_print(lua_State *L) {
    core_log(CORE_LOG_INFO, "%s", luaL_checkstring(L, 1));
    return 0;
}

static int engine_describe(lua_State *L) {
    if (lua_type(L, 1) == LUA_TSTRING) {
        lua_pushfstring(L, "the string \"%s\"", lua_tostring(L, 1));
    } else if (lua_type(L, 1) == LUA_TNUMBER) {
        lua_pushfstring(L, "the number %s", lua_tostring(L, 1));
    } else if (lua_isnoneornil(L, 1)) {
        lua_pushliteral(L, "nothing (nil)");
    } else {
        lua_pushfstring(L, "a %s", luaL_typename(L, 1));
    }
    return 1;
}

static int engine_load_file(lua_State *L) {
    if (script_load_chunk(self(L), L, luaL_checkstring(L, 1))) {
        return 1;
    }
    lua_pushnil(L);
    lua_insert(L, -2);
    return 2;
}

// findModule("a.b") -> chunk, path or nil, reason.
static int engine_find_module(lua_State *L) {
    script *s = self(L);
    static const char *const endings[] = {".lua", "/init.lua"};
    char name[200], path[420];
    snprintf(name, sizeof name, "%s", luaL_checkstring(L, 1));
    for (char *c = name; *c; c++) {
        *c = *c == '.' ? '/' : *c;
    }
    core_vfs *vfs = scene_vfs(s->scene);
    for (size_t i = 0; i < CORE_COUNT_OF(endings); i++) {
        snprintf(path, sizeof path, "%s%s%s", s->root, name, endings[i]);
        if (!vfs || !core_vfs_exists(vfs, path)) {
            continue;
        }
        if (!script_load_chunk(s, L, path)) {
            return lua_error(L);
        }
        lua_pushstring(L, path);
        return 2;
    }
    lua_pushnil(L);
    lua_pushfstring(L, "no file \"%s%s.lua\" or \"%s%s/init.lua\" in the game's folder", s->root,
                    name, s->root, name);
    return 2;
}

// What mods have too.
static const luaL_Reg shared_functions[] = {{"keys", script_order_keys},
                                            {"next", script_order_next},
                                            {"simulating", engine_simulating},
                                            {"random", engine_random},
                                            {"print", engine_print},
                                            {"describe", engine_describe},
                                            {"dt", engine_dt},
                                            {"wake", engine_wake},
                                            {"setTask", engine_set_task},
                                            {"getTask", engine_get_task},
                                            {"report", engine_report},
                                            {"protect", engine_protect},
                                            {"near", engine_near},
                                            {"where", engine_where},
                                            {"rawmeta", engine_rawmeta},
                                            {NULL, NULL}};

static const luaL_Reg engine_functions[] = {{"reseed", engine_reseed},
                                            {"loadFile", engine_load_file},
                                            {"findModule", engine_find_module},
                                            {"modEvent", engine_mod_event},
                                            {"hasMods", engine_has_mods},
                                            {"atTop", engine_at_top},
                                            {"bodyAt", engine_body_at},
                                            {"callbackCount", engine_callback_count},
                                            {"fastMethods", script_fast_methods},
                                            {"saveWrite", script_save_write},
                                            {"saveRead", script_save_read},
                                            {NULL, NULL}};

static void push_functions(script *s, lua_State *L, const luaL_Reg *functions) {
    for (const luaL_Reg *fn = functions; fn->name; fn++) {
        lua_pushlightuserdata(L, s);
        lua_pushcclosure(L, fn->func, 1);
        lua_setfield(L, -2, fn->name);
    }
}

void script_push_engine(script *s, lua_State *L) {
    lua_newtable(L);
    push_functions(s, L, shared_functions);
    lua_newtable(L); // Lua halves of bindings, by full name
    lua_pushvalue(L, -1);
    lua_setfield(L, LUA_REGISTRYINDEX, "corsac.lua");
    lua_setfield(L, -2, "lua");
}

static void push_engine(script *s, lua_State *L) {
    script_push_engine(s, L);
    push_functions(s, L, engine_functions);
    script_fast *fast = lua_newuserdata(L, sizeof *fast);
    *fast = script_fast_table(s);
    lua_setfield(L, LUA_REGISTRYINDEX, "corsac.fast"); // keeps it alive
    lua_pushlightuserdata(L, fast);
    lua_setfield(L, -2, "fast");
    lua_pushlightuserdata(L, (void *)(uintptr_t)&bind_body_type);
    lua_setfield(L, -2, "bodyType");
}

bool script_run_part(script *s, lua_State *L, const char *name) {
    char path[64];
    snprintf(path, sizeof path, "corsac/%s.lua", name);
    lua_getfield(L, LUA_REGISTRYINDEX, "corsac.engine");
    if (script_load_chunk(s, L, path)) {
        lua_insert(L, -2);
        if (lua_pcall(L, 1, 0, 0) == 0) {
            return true;
        }
    }
    core_fail("script: %s", lua_tostring(L, -1));
    return false;
}

lua_State *script_state_create(script *s) {
    script_libc_fixed_seed(true);
    lua_State *L = luaL_newstate();
    script_libc_fixed_seed(false);
    if (!L) {
        core_fail("script: no memory for a Lua state");
        return NULL;
    }
    luaL_openlibs(L);
    script_make_handler(s, L);
    push_engine(s, L);
    lua_setfield(L, LUA_REGISTRYINDEX, "corsac.engine");
    static const char *const parts[] = {"base",   "native",     "columns", "tasks",
                                        "events", "containers", "prefab",  "save",
                                        "mods",   "reload",     "inspect", "ui"};
    bool good = true;
    for (size_t i = 0; good && i < CORE_COUNT_OF(parts); i++) {
        good = script_run_part(s, L, parts[i]);
    }
    if (good) {
        bind_install(s, L, false);
        lua_getfield(L, LUA_GLOBALSINDEX, "corsac");
        s->corsac_ref = luaL_ref(L, LUA_REGISTRYINDEX);
        lua_pushnil(L);
        lua_setfield(L, LUA_REGISTRYINDEX, "corsac.lua");
        good = script_run_part(s, L, "fast") && script_run_part(s, L, "boot");
        lua_getfield(L, LUA_REGISTRYINDEX, "corsac.engine");
        lua_getfield(L, -1, "errorScreen");
        s->error_screen_ref = luaL_ref(L, LUA_REGISTRYINDEX);
        lua_getfield(L, -1, "reload");
        s->reload_ref = luaL_ref(L, LUA_REGISTRYINDEX);
        lua_getfield(L, -1, "kept");
        s->kept_ref = luaL_ref(L, LUA_REGISTRYINDEX);
        s->service = lua_newthread(L);
        lua_setfield(L, LUA_REGISTRYINDEX, "corsac.service");
        lua_getfield(L, -1, "serve");
        lua_setfield(L, LUA_REGISTRYINDEX, "corsac.serve");
        lua_getfield(L, -1, "tick");
        s->tick_ref = luaL_ref(L, LUA_REGISTRYINDEX);
        lua_pop(L, 1);
    }
    if (!good) {
        lua_close(L);
        return NULL;
    }
    return L;
}
