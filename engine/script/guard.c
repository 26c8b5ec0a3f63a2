// The guard of mod states. Facts about LuaJIT that shape it: count hooks do not fire inside
// compiled traces, so mods are interpreted; pcall would swallow the hook's error, so mods get one
// that rethrows; C functions run between two hooks, so those that can take long are charged or
// refused.
#include "script/guard.h"

#include "core/clock.h"
#include "script/internal.h"
#include "script/libc.h"

#include <luajit.h>
#include <lualib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HOOK_EVERY = 1000, PCALL_DEPTH = 100 };

// ---- memory ----

static void *guard_alloc(void *ctx, void *block, size_t old_size, size_t size) {
    script_guard *g = ctx;
    if (size == 0) {
        g->bytes -= old_size;
        free(block);
        return NULL;
    }
    if (size > old_size && g->running) {
        if (g->bytes - old_size + size > GUARD_MEMORY || size > GUARD_BLOCK) {
            return NULL; // Lua raises "not enough memory"
        }
        script_guard_charge(g, (int64_t)((size - old_size) / GUARD_BYTES_PER_UNIT) + 1);
    }
    void *moved = realloc(block, size);
    if (moved) {
        g->bytes += size - old_size;
        g->peak = CORE_MAX(g->peak, g->bytes);
    }
    return moved;
}

// ---- instructions, C stack, clock ----

static script_guard *guard_of(lua_State *L) {
    void *ctx;
    lua_getallocf(L, &ctx);
    return ctx;
}

static void hook(lua_State *L, lua_Debug *event);

static void check(lua_State *L, script_guard *g) {
    // Not a local's address: sanitizers move locals to the heap.
    if (g->stack - (const char *)__builtin_frame_address(0) > GUARD_STACK) {
        luaL_error(L, "calls nest too deeply");
    }
    if (g->killed) {
        lua_sethook(L, hook, LUA_MASKCOUNT, 1); // until nothing of the call is left
        luaL_error(L, "%s", g->why);
    }
}

static void hook(lua_State *L, lua_Debug *event) {
    script_guard *g = guard_of(L);
    (void)event;
    if (!g->killed) {
        script_guard_charge(g, HOOK_EVERY);
        if (core_clock_ns() > g->deadline) {
            g->overtime = true;
            script_guard_kill(g, "this call took too long by the clock");
        }
    }
    check(L, g);
}

void script_guard_kill(script_guard *g, const char *why) {
    if (!g->killed) {
        g->killed = true;
        g->why = why;
        lua_sethook(g->L, hook, LUA_MASKCOUNT, 1);
    }
}

void script_guard_charge(script_guard *g, int64_t units) {
    if (!g->running) {
        return;
    }
    g->left -= units;
    if (g->left < 0) {
        script_guard_kill(g, "this call used up its budget of instructions");
    }
}

void script_guard_begin(script_guard *g, int64_t budget) {
    g->left = g->granted = budget;
    g->killed = g->overtime = false;
    g->why = "";
    g->stack = __builtin_frame_address(0);
    g->deadline = core_clock_ns() + GUARD_WALL_MS * UINT64_C(1000000);
    g->running = true;
    lua_sethook(g->L, hook, LUA_MASKCOUNT, HOOK_EVERY);
}

int64_t script_guard_end(script_guard *g) {
    g->running = false;
    lua_sethook(g->L, NULL, 0, 0);
    return g->granted - CORE_MAX(g->left, 0);
}

// ---- library functions that could take long ----

// pcall that cannot swallow a kill and does not nest without end.
static int guarded_pcall(lua_State *L) {
    script_guard *g = guard_of(L);
    luaL_checkany(L, 1);
    check(L, g);
    lua_getfield(L, LUA_REGISTRYINDEX, "corsac.depth");
    int depth = (int)lua_tonumber(L, -1);
    lua_pop(L, 1);
    if (depth >= PCALL_DEPTH) {
        return luaL_error(L, "pcall nests at most %d deep", PCALL_DEPTH);
    }
    lua_pushnumber(L, depth + 1);
    lua_setfield(L, LUA_REGISTRYINDEX, "corsac.depth");
    int rc = lua_pcall(L, lua_gettop(L) - 1, LUA_MULTRET, 0);
    lua_pushnumber(L, depth);
    lua_setfield(L, LUA_REGISTRYINDEX, "corsac.depth");
    if (rc != 0 && g->killed) {
        return lua_error(L);
    }
    lua_pushboolean(L, rc == 0);
    lua_insert(L, 1);
    return lua_gettop(L);
}

// Steps that matching could take at worst: every quantifier may try every place of the subject.
static void check_pattern(lua_State *L, size_t subject, const char *pattern, size_t length,
                          bool plain) {
    bool anchored = length > 0 && pattern[0] == '^' && !plain;
    int quantifiers = 0;
    for (size_t i = 0; i < length && !plain; i++) {
        if (pattern[i] == '%') {
            i++;
            quantifiers +=
                i < length && (pattern[i] == 'b' || (pattern[i] >= '0' && pattern[i] <= '9'));
        } else {
            quantifiers += strchr("*+-?", pattern[i]) != NULL;
        }
    }
    double n = (double)subject + 1, steps = anchored ? 1 : n;
    for (int i = 0; i < quantifiers && steps <= GUARD_PATTERN; i++) {
        steps *= n;
    }
    steps = CORE_MAX(steps, n * (double)(length + 1) * (quantifiers == 0));
    if (steps > GUARD_PATTERN || length > 1000) {
        luaL_error(L,
                   "this pattern could take too long on %d characters; use a simpler pattern or "
                   "a shorter text",
                   (int)subject);
    }
    script_guard_charge(guard_of(L), (int64_t)((double)(subject + length) / 4) + 4);
}

// Upvalue: the library's own function. Arguments 1 and 2 are subject and pattern.
static int guarded_match(lua_State *L) {
    size_t subject, length;
    luaL_checklstring(L, 1, &subject);
    const char *pattern = luaL_checklstring(L, 2, &length);
    check(L, guard_of(L));
    check_pattern(L, subject, pattern, length, false);
    int count = lua_gettop(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, count, LUA_MULTRET);
    return lua_gettop(L);
}

static int guarded_find(lua_State *L) {
    size_t subject, length;
    luaL_checklstring(L, 1, &subject);
    const char *pattern = luaL_checklstring(L, 2, &length);
    check_pattern(L, subject, pattern, length, lua_toboolean(L, 4));
    int count = lua_gettop(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, count, LUA_MULTRET);
    return lua_gettop(L);
}

static int guarded_rep(lua_State *L) {
    size_t length;
    luaL_checklstring(L, 1, &length);
    double times = luaL_checknumber(L, 2);
    if (length == 0 || !(times >= 1)) {
        lua_pushliteral(L, "");
        return 1;
    }
    if ((double)length * times > GUARD_BLOCK) {
        return luaL_error(L, "not enough memory");
    }
    lua_settop(L, 2);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, 2, 1);
    return 1;
}

// Functions that walk a whole table: charged by its length before they run.
static int guarded_walk(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    script_guard *g = guard_of(L);
    double n = (double)lua_objlen(L, 1) + 1, factor = lua_tonumber(L, lua_upvalueindex(2));
    check(L, g);
    script_guard_charge(g, (int64_t)(factor > 1 ? n * (log2(n) + 1) : n / 4) + 1);
    check(L, g);
    int count = lua_gettop(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, count, LUA_MULTRET);
    return lua_gettop(L);
}

// insert and remove with a place: LuaJIT would walk from any place, however far.
static int guarded_place(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    bool insert = lua_tonumber(L, lua_upvalueindex(2)) != 0;
    if (lua_gettop(L) >= (insert ? 3 : 2)) {
        double place = luaL_checknumber(L, 2), n = (double)lua_objlen(L, 1);
        if (!(place >= 1 && place <= n + 1)) {
            return luaL_error(L, "%s: the place must be from 1 to %d", insert ? "insert" : "remove",
                              (int)n + 1);
        }
    }
    return guarded_walk(L);
}

static int guarded_tonumber(lua_State *L) {
    if (lua_type(L, 1) == LUA_TSTRING) {
        script_guard_charge(guard_of(L), (int64_t)lua_objlen(L, 1) / 4);
    }
    int count = lua_gettop(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, count, 1);
    return 1;
}

// ---- the base library ----

static void remove_fields(lua_State *L, const char *table, const char *const *names) {
    lua_getglobal(L, table);
    for (; *names; names++) {
        lua_pushnil(L);
        lua_setfield(L, -2, *names);
    }
    lua_pop(L, 1);
}

static void wrap(lua_State *L, const char *table, const char *name, lua_CFunction guard,
                 double factor) {
    lua_getglobal(L, table);
    lua_getfield(L, -1, name);
    lua_pushnumber(L, factor);
    lua_pushcclosure(L, guard, 2);
    lua_setfield(L, -2, name);
    lua_pop(L, 1);
}

static int open_library(lua_State *L) {
    static const lua_CFunction libraries[] = {luaopen_base, luaopen_table, luaopen_string,
                                              luaopen_math, luaopen_bit};
    static const char *const base[] = {
        "dofile",   "loadfile", "load",    "loadstring", "require", "module", "collectgarbage",
        "gcinfo",   "newproxy", "getfenv", "setfenv",    "xpcall",  "rawget", "rawset",
        "rawequal", "rawlen",   "package", "io",         "os",      "debug",  "jit",
        "ffi",      "print",    NULL};
    static const char *const strings[] = {"dump", "gfind", NULL};
    static const char *const tables[] = {"foreach", "foreachi", "getn", "maxn", "setn", NULL};
    for (size_t i = 0; i < CORE_COUNT_OF(libraries); i++) {
        lua_pushcfunction(L, libraries[i]);
        lua_call(L, 0, 0);
    }
    lua_pushvalue(L, LUA_GLOBALSINDEX);
    lua_setglobal(L, "_G");
    remove_fields(L, "_G", base);
    remove_fields(L, "string", strings);
    remove_fields(L, "table", tables);
    wrap(L, "string", "find", guarded_find, 0);
    wrap(L, "string", "match", guarded_match, 0);
    wrap(L, "string", "gmatch", guarded_match, 0);
    wrap(L, "string", "gsub", guarded_match, 0);
    wrap(L, "string", "rep", guarded_rep, 0);
    wrap(L, "table", "sort", guarded_walk, 2);
    wrap(L, "table", "concat", guarded_walk, 1);
    wrap(L, "table", "insert", guarded_place, 1);
    wrap(L, "table", "remove", guarded_place, 0);
    wrap(L, "_G", "tonumber", guarded_tonumber, 0);
    lua_pushcfunction(L, guarded_pcall);
    lua_setglobal(L, "pcall");
    lua_pushliteral(L, "");
    lua_getmetatable(L, -1);
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_pop(L, 2);
    return 0;
}

lua_State *script_guard_state(script_guard *g) {
    *g = (script_guard){0};
    // A fixed seed keeps budgets equal in every run; a flood of colliding strings pays by the byte
    // and meets the clock's backstop.
    script_libc_fixed_seed(true);
    lua_State *L = lua_newstate(guard_alloc, g);
    script_libc_fixed_seed(false);
    if (!L) {
        core_fail("mod: no memory for its Lua state");
        return NULL;
    }
    g->L = L;
    if (lua_cpcall(L, open_library, NULL) != 0) {
        core_fail("mod: %s", lua_tostring(L, -1));
        lua_close(L);
        return NULL;
    }
    luaJIT_setmode(L, 0, LUAJIT_MODE_ENGINE | LUAJIT_MODE_OFF);
    return L;
}
