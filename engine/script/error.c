// Errors of scripts: their texts with reason, nearest name and traceback, and where they are kept.
#include "core/log.h"
#include "script/internal.h"
#include "script/mod.h"

#include <stdio.h>
#include <string.h>

enum { SCRIPT_TRACE_LEVELS = 24 };

char *script_copy_text(const char *text) {
    size_t size = strlen(text) + 1;
    return memcpy(core_alloc(size), text, size);
}

// "attempt to index global 'corsca' (a nil value)": names the nearest global.
static void push_global_hint(lua_State *L, const char *message) {
    const char *at = strstr(message, "global '");
    const char *end = at ? strchr(at + 8, '\'') : NULL;
    if (!end || !strstr(end, "(a nil value)")) {
        lua_pushliteral(L, "");
        return;
    }
    lua_pushlstring(L, at + 8, (size_t)(end - at - 8));
    const char *wrong = lua_tostring(L, -1);
    bind_names names = {.count = 0};
    lua_pushnil(L);
    while (lua_next(L, LUA_GLOBALSINDEX)) {
        lua_pop(L, 1);
        if (lua_type(L, -1) == LUA_TSTRING) {
            bind_names_add(&names, lua_tostring(L, -1));
        }
    }
    const char *near = bind_nearest(wrong, &names);
    if (near) {
        lua_pushfstring(L, "; did you mean '%s'?", near);
    } else {
        lua_pushliteral(L, "; no such global is defined");
    }
    lua_remove(L, -2);
}

static void push_traceback(lua_State *L, uint32_t phase) {
    lua_Debug frame;
    luaL_Buffer text;
    luaL_buffinit(L, &text);
    int lines = 0;
    for (int level = 0; lines < SCRIPT_TRACE_LEVELS && lua_getstack(L, level, &frame); level++) {
        char line[300];
        lua_getinfo(L, "Sln", &frame);
        if (frame.currentline <= 0 || strncmp(frame.source, "=corsac/", 8) == 0) {
            continue;
        }
        bool main = strcmp(frame.what, "main") == 0;
        if (frame.name && !main) {
            snprintf(line, sizeof line, "\n    %s:%d: in '%s'", frame.short_src, frame.currentline,
                     frame.name);
        } else {
            snprintf(line, sizeof line, "\n    %s:%d: in %s", frame.short_src, frame.currentline,
                     main ? "the file's own code" : "a function");
        }
        luaL_addstring(&text, line);
        lines++;
    }
    if (phase != BIND_TOP) {
        luaL_addstring(&text, "\n    called as ");
        luaL_addstring(&text, bind_phase_name(phase));
    }
    luaL_pushresult(&text);
}

void script_push_report(const script *s, lua_State *L) {
    int at = lua_gettop(L);
    if (lua_type(L, at) != LUA_TSTRING) {
        bool text = lua_type(L, at) == LUA_TNUMBER || luaL_callmeta(L, at, "__tostring");
        if (!text) {
            lua_pushfstring(L, "error raised with a %s instead of a text", luaL_typename(L, at));
        }
        lua_replace(L, at);
        lua_settop(L, at);
        lua_tostring(L, at);
    }
    push_global_hint(L, lua_tostring(L, at));
    push_traceback(L, s->phase);
    lua_concat(L, 3);
}

static int with_traceback(lua_State *L) {
    script_push_report(lua_touserdata(L, lua_upvalueindex(1)), L);
    return 1;
}

void script_make_handler(script *s, lua_State *L) {
    lua_pushlightuserdata(L, s);
    lua_pushcclosure(L, with_traceback, 1);
    s->handler_ref = luaL_ref(L, LUA_REGISTRYINDEX);
}

void script_record_error(script *s, lua_State *L) {
    if (s->as_mod) {
        script_mod_report(s, L);
        return;
    }
    const char *text = lua_tostring(L, -1);
    core_free(s->last_error);
    s->last_error = script_copy_text(text ? text : "error without a text");
    s->error_count++;
    core_log(CORE_LOG_ERROR, "%s", s->last_error);
    lua_pop(L, 1);
}

bool script_protected(script *s, lua_State *L, int argc, int results) {
    int base = lua_gettop(L) - argc;
    lua_rawgeti(L, LUA_REGISTRYINDEX, s->handler_ref);
    lua_insert(L, base);
    bool good = lua_pcall(L, argc, results, base) == 0;
    lua_remove(L, base);
    if (!good) {
        script_record_error(s, L);
    }
    return good;
}

bool script_call(script *s, uint32_t phase, int argc, int results) {
    if (s->as_mod) {
        return script_mod_callback(s->as_mod, phase, argc, results);
    }
    uint32_t before = s->phase;
    s->phase = phase;
    s->callback_count++;
    bool good = script_protected(s, s->L, argc, results);
    s->phase = before;
    return good;
}
