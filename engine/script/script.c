// The public side: a script's life, its callbacks, and what happens when one fails.
#include "script/script.h"

#include "core/log.h"
#include "script/internal.h"
#include "script/mod.h"
#include "script/scene_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCRIPT_COOKIE = 0x5c21b7 };

script_desc script_desc_default(void) { return (script_desc){.cookie = SCRIPT_COOKIE}; }

script *script_create(const script_desc *desc) {
    if (!desc || desc->cookie != SCRIPT_COOKIE) {
        core_fail("script_create: the description was not made by script_desc_default()");
        return NULL;
    }
    if (!desc->scene) {
        core_fail("script_create: desc.scene is NULL; a script belongs to a scene");
        return NULL;
    }
    script *s = core_alloc(sizeof *s);
    s->scene = desc->scene;
    s->host = desc->host ? *desc->host : (script_host){0};
    s->headless = desc->headless;
    s->keep_going = desc->keep_going;
    s->argc = desc->argc;
    s->argv = desc->argv;
    s->given_data = desc->data ? script_copy_text(desc->data) : NULL;
    s->expect = core_alloc(SCRIPT_EXPECT_MAX * sizeof *s->expect);
    s->watched = core_alloc(SCRIPT_WATCH_MAX * sizeof *s->watched);
    s->param = core_alloc(SCRIPT_PARAM_MAX * sizeof *s->param);
    s->phase = BIND_TOP;
    s->L = script_state_create(s);
    if (!s->L) {
        script_destroy(s);
        return NULL;
    }
    return s;
}

void script_destroy(script *s) {
    if (!s) {
        return;
    }
    script_mods_destroy(s);
    if (s->L) {
        lua_close(s->L);
    }
    core_free(s->watched);
    core_free(s->expect);
    core_free(s->param);
    core_free(s->last_error);
    core_free(s->run_data);
    core_free(s->given_data);
    script_scene_file_release(s);
    if (s->save) {
        core_vfs_destroy(s->save);
    }
    core_free(s);
}

// ---- callbacks ----

// Pushes corsac.NAME when it is a function and has not been stopped by an error.
static bool push_callback(script *s, const char *name, uint32_t phase) {
    lua_State *L = s->L;
    if (s->stopped & phase) {
        return false;
    }
    lua_rawgeti(L, LUA_REGISTRYINDEX, s->corsac_ref);
    lua_pushstring(L, name);
    lua_rawget(L, -2);
    lua_remove(L, -2);
    if (!lua_isfunction(L, -1)) {
        lua_pop(L, 1);
        return false;
    }
    return true;
}

// Mods hear of the engine's own events too, in its phase.
static void tell_mods(script *s, uint32_t phase, const char *name, bool before, const double *dt) {
    if (s->mod_count == 0) {
        return;
    }
    script_pack args = {0};
    uint32_t was = s->phase;
    if (dt) {
        lua_pushnumber(s->L, *dt);
        script_pack_value(s, s->L, -1, &args);
        lua_pop(s->L, 1);
    }
    s->phase = phase;
    script_mods_event(s, name, before, &args);
    s->phase = was;
    script_pack_release(&args);
}

static bool call_callback(script *s, uint32_t phase, int argc) {
    if (script_call(s, phase, argc, 0)) {
        return true;
    }
    if (!s->keep_going) {
        s->stopped |= phase;
    }
    return false;
}

static bool run_load(script *s) {
    if (!push_callback(s, "load", BIND_LOAD)) {
        return !(s->stopped & BIND_LOAD);
    }
    lua_createtable(s->L, s->argc, 0);
    for (int i = 0; i < s->argc; i++) {
        lua_pushstring(s->L, s->argv[i]);
        lua_rawseti(s->L, -2, i + 1);
    }
    return call_callback(s, BIND_LOAD, 1);
}

bool script_load(script *s) {
    s->seed = scene_rng(s->scene, CORE_RNG_SIM)->seed;
    script_mods_start(s);
    tell_mods(s, BIND_LOAD, "load", true, NULL);
    bool good = run_load(s);
    tell_mods(s, BIND_LOAD, "load", false, NULL);
    return good;
}

void script_fixed(script *s, float dt) {
    if (s->awake) {
        lua_rawgeti(s->L, LUA_REGISTRYINDEX, s->tick_ref);
        if (script_call(s, BIND_FIXED, 0, 1)) {
            s->awake = lua_toboolean(s->L, -1);
            lua_pop(s->L, 1);
        }
    }
    double length = (double)dt;
    uint32_t was = s->phase;
    s->phase = BIND_FIXED;
    script_mods_tick(s);
    s->phase = was;
    tell_mods(s, BIND_FIXED, "fixed", true, &length);
    if (push_callback(s, "fixed", BIND_FIXED)) {
        lua_pushnumber(s->L, length);
        call_callback(s, BIND_FIXED, 1);
    }
    tell_mods(s, BIND_FIXED, "fixed", false, &length);
    s->time += (double)dt;
}

void script_update(script *s, double dt) {
    tell_mods(s, BIND_UPDATE, "update", true, &dt);
    if (push_callback(s, "update", BIND_UPDATE)) {
        lua_pushnumber(s->L, dt);
        call_callback(s, BIND_UPDATE, 1);
    }
    tell_mods(s, BIND_UPDATE, "update", false, &dt);
}

void script_draw(script *s) {
    tell_mods(s, BIND_DRAW, "draw", true, NULL);
    if (push_callback(s, "draw", BIND_DRAW)) {
        call_callback(s, BIND_DRAW, 0);
    }
    tell_mods(s, BIND_DRAW, "draw", false, NULL);
    if (s->stopped && !s->headless) {
        lua_rawgeti(s->L, LUA_REGISTRYINDEX, s->error_screen_ref);
        lua_pushstring(s->L, s->last_error);
        script_call(s, BIND_DRAW, 1, 0);
    }
}

void script_event(script *s, const char *name, const char *text, const double *values, int count) {
    if (!push_callback(s, "event", BIND_EVENT)) {
        return;
    }
    lua_pushstring(s->L, name);
    int argc = 1;
    if (text) {
        lua_pushstring(s->L, text);
        argc++;
    }
    for (int i = 0; i < count; i++, argc++) {
        lua_pushnumber(s->L, values[i]);
    }
    call_callback(s, BIND_EVENT, argc);
}

void script_quit(script *s) {
    tell_mods(s, BIND_QUIT, "quit", true, NULL);
    if (push_callback(s, "quit", BIND_QUIT)) {
        call_callback(s, BIND_QUIT, 0);
    }
    tell_mods(s, BIND_QUIT, "quit", false, NULL);
}

// ---- what the app asks ----

int script_error_count(const script *s) { return s->error_count; }
const char *script_last_error(const script *s) { return s->last_error ? s->last_error : ""; }
size_t script_bytes(const script *s) {
    return (size_t)lua_gc(s->L, LUA_GCCOUNT, 0) * 1024 + (size_t)lua_gc(s->L, LUA_GCCOUNTB, 0);
}
const char *script_run_data(const script *s) { return s->run_data; }

bool script_param_declared(const script *s, const char *name) {
    for (int i = 0; i < s->param_count; i++) {
        if (strcmp(s->param[i], name) == 0) {
            return true;
        }
    }
    return false;
}

bool script_compare(double a, script_op op, double b) {
    switch (op) {
    case OP_LE:
        return a <= b;
    case OP_LT:
        return a < b;
    case OP_GE:
        return a >= b;
    case OP_GT:
        return a > b;
    case OP_EQ:
        return a == b;
    case OP_NE:
        return a != b;
    }
    return false;
}

int script_check_expectations(script *s) {
    static const char *const ops[] = {"<=", "<", ">=", ">", "==", "~="};
    int failed = 0;
    for (int i = 0; i < s->expect_count; i++) {
        const script_expect *e = &s->expect[i];
        bool known = e->missed;
        double value = e->missed        ? e->found
                       : s->host.metric ? s->host.metric(s->host.ctx, e->metric, &known)
                                        : 0;
        if (known && !e->missed && script_compare(value, e->op, e->value)) {
            continue;
        }
        failed++;
        if (known) {
            core_log(CORE_LOG_ERROR, "%sexpected %s %s %.9g, it is %.9g", e->where, e->metric,
                     ops[e->op], e->value, value);
        } else {
            core_log(CORE_LOG_ERROR, "%sexpected %s %s %.9g, but no such metric exists", e->where,
                     e->metric, ops[e->op], e->value);
        }
    }
    return failed;
}
