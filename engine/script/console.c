// A line of Lua from a person, run between two steps.
#include "script/internal.h"

#include <stdio.h>
#include <string.h>

// An expression gives its values; what is none is compiled as it stands.
static bool compile(lua_State *L, const char *code) {
    lua_pushfstring(L, "return %s", code);
    const char *expression = lua_tostring(L, -1);
    bool fine = luaL_loadbuffer(L, expression, strlen(expression), "=console") == 0;
    if (!fine) {
        lua_pop(L, 1);
        fine = luaL_loadbuffer(L, code, strlen(code), "=console") == 0;
    }
    lua_remove(L, -2);
    return fine;
}

static void append_values(lua_State *L, int first, char *out, size_t size) {
    size_t used = 0;
    for (int i = first; i <= lua_gettop(L) && used < size; ++i) {
        lua_getglobal(L, "tostring");
        lua_pushvalue(L, i);
        bool fine = lua_pcall(L, 1, 1, 0) == 0;
        const char *text = fine ? lua_tostring(L, -1) : NULL;
        used += (size_t)snprintf(out + used, size - used, "%s%s", i > first ? ", " : "",
                                 text ? text : "?");
        lua_pop(L, 1);
    }
}

bool script_console(script *s, const char *code, char *out, size_t size) {
    lua_State *L = s->L;
    int top = lua_gettop(L);
    uint32_t before = s->phase;
    s->phase = BIND_FIXED;
    snprintf(out, size, "done");
    bool fine = compile(L, code) && lua_pcall(L, 0, LUA_MULTRET, 0) == 0;
    append_values(L, top + 1, out, size);
    s->phase = before;
    lua_settop(L, top);
    return fine;
}
