// Reads a scene's file and what corsac.conf(t) says before worlds are made.
#include "script/internal.h"

#include <stdio.h>
#include <string.h>

typedef struct conf_values {
    int64_t steps, seed, threads;
    double dt;
    const char *title;
    int render, size, phys, gfx, anim, nav, audio, actions;
    bool has_seed, has_render;
} conf_values;

#define RENDERS "auto|forward|clustered|none"
static const char *const renders[] = {"auto", "forward", "clustered", "none"};

static const bind_arg conf_fields[] = {
    {"steps", BIND_INT, BIND_AT(conf_values, steps), "steps of a headless run", .optional = true,
     .range = BIND_POSITIVE},
    {"dt", BIND_NUMBER, BIND_AT(conf_values, dt), "length of a step", "s", .optional = true,
     .range = BIND_BETWEEN, .min = 1e-5, .max = 1},
    {"seed", BIND_INT, BIND_AT(conf_values, seed), "seed of the run", .optional = true,
     .range = BIND_NOT_NEGATIVE, BIND_GIVEN(conf_values, has_seed)},
    {"threads", BIND_INT, BIND_AT(conf_values, threads), "worker threads", .optional = true,
     .range = BIND_BETWEEN, .min = 1, .max = 64},
    {"size", BIND_TABLE, BIND_AT(conf_values, size), "{width, height}", "pixels", .optional = true},
    {"render", BIND_ENUM, BIND_AT(conf_values, render), "how lights are assigned", .optional = true,
     .values = RENDERS, BIND_GIVEN(conf_values, has_render)},
    {"title", BIND_STRING, BIND_AT(conf_values, title), "title of the window", .optional = true},
    {"phys", BIND_TABLE, BIND_AT(conf_values, phys), "settings", .optional = true},
    {"gfx", BIND_TABLE, BIND_AT(conf_values, gfx), "settings", .optional = true},
    {"anim", BIND_TABLE, BIND_AT(conf_values, anim), "settings", .optional = true},
    {"nav", BIND_TABLE, BIND_AT(conf_values, nav), "settings", .optional = true},
    {"audio", BIND_TABLE, BIND_AT(conf_values, audio), "settings", .optional = true},
    {"actions", BIND_TABLE, BIND_AT(conf_values, actions), "name = key", .optional = true},
    {0}};

static void read_pair(lua_State *L, int index, script_conf *conf) {
    int v[2];
    for (int i = 0; i < 2; i++) {
        lua_rawgeti(L, index, i + 1);
        v[i] = (int)lua_tonumber(L, -1);
        if (lua_type(L, -1) != LUA_TNUMBER || v[i] < 1 || v[i] > 16384) {
            bind_error(L, "corsac.conf: size: expected {width, height}, each 1 to 16384 pixels");
        }
        lua_pop(L, 1);
    }
    conf->width = (uint32_t)v[0];
    conf->height = (uint32_t)v[1];
}

// t.phys = {solver = "soft"} becomes the setting "phys.solver" = "soft"; t.actions likewise.
static void read_settings(lua_State *L, int index, const char *room, script_conf *conf) {
    lua_pushnil(L);
    while (lua_next(L, index)) {
        uint32_t n = conf->setting_count;
        if (n == CORE_COUNT_OF(conf->setting_name)) {
            bind_error(L, "corsac.conf: more than %d settings", (int)n);
        }
        if (lua_type(L, -2) != LUA_TSTRING || lua_istable(L, -1)) {
            bind_error(L, "corsac.conf: %s: expected fields like name = value", room);
        }
        if (lua_type(L, -1) == LUA_TBOOLEAN) {
            lua_pushstring(L, lua_toboolean(L, -1) ? "true" : "false");
            lua_replace(L, -2);
        }
        const char *value = lua_tostring(L, -1);
        int length = snprintf(conf->setting_name[n], sizeof conf->setting_name[n], "%s.%s", room,
                              lua_tostring(L, -2));
        if (!value || strlen(value) >= sizeof conf->setting_value[n] ||
            length >= (int)sizeof conf->setting_name[n]) {
            bind_error(L, "corsac.conf: %s.%s: expected a number, true, false or a short string",
                       room, lua_tostring(L, -2));
        }
        snprintf(conf->setting_value[n], sizeof conf->setting_value[n], "%s", value);
        conf->setting_count++;
        lua_pop(L, 1);
    }
}

// Settings came in table order; sorted, errors and records do not depend on it.
static void sort_settings(script_conf *conf) {
    for (uint32_t i = 1; i < conf->setting_count; i++) {
        for (uint32_t j = i; j > 0; j--) {
            char(*name)[64] = conf->setting_name, (*value)[64] = conf->setting_value, keep[64];
            if (strcmp(name[j - 1], name[j]) <= 0) {
                break;
            }
            memcpy(keep, name[j], sizeof keep);
            memcpy(name[j], name[j - 1], sizeof keep);
            memcpy(name[j - 1], keep, sizeof keep);
            memcpy(keep, value[j], sizeof keep);
            memcpy(value[j], value[j - 1], sizeof keep);
            memcpy(value[j - 1], keep, sizeof keep);
        }
    }
}

// Called protected with (script, conf, t).
static int read_conf(lua_State *L) {
    script *s = lua_touserdata(L, 1);
    script_conf *conf = lua_touserdata(L, 2);
    conf_values v = {0};
    bind_check_table(s, L, 3, "corsac.conf", "t", conf_fields, &v);
    conf->steps = (uint64_t)v.steps;
    conf->seed = (uint64_t)v.seed;
    conf->has_seed = v.has_seed;
    conf->dt = v.dt;
    conf->threads = (int)v.threads;
    if (v.has_render) {
        snprintf(conf->render, sizeof conf->render, "%s", renders[v.render]);
    }
    if (v.title) {
        snprintf(conf->title, sizeof conf->title, "%s", v.title);
    }
    if (v.size) {
        read_pair(L, v.size, conf);
    }
    const struct {
        const char *room;
        int table;
    } rooms[] = {{"phys", v.phys}, {"gfx", v.gfx},     {"anim", v.anim},
                 {"nav", v.nav},   {"audio", v.audio}, {"actions", v.actions}};
    for (size_t i = 0; i < CORE_COUNT_OF(rooms); i++) {
        if (rooms[i].table) {
            read_settings(L, rooms[i].table, rooms[i].room, conf);
        }
    }
    sort_settings(conf);
    return 0;
}

static bool run_file(script *s, const char *path) {
    if (!script_load_chunk(s, s->L, path)) {
        script_record_error(s, s->L);
        return false;
    }
    return script_call(s, BIND_TOP, 0, 0);
}

bool script_load_file(script *s, const char *path, script_conf *conf) {
    lua_State *L = s->L;
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0;
    if (folder >= sizeof s->root) {
        core_fail_quiet("%s: path longer than %d characters", path, (int)sizeof s->root - 1);
        lua_pushstring(L, core_last_error());
        script_record_error(s, s->L);
        return false;
    }
    snprintf(s->path, sizeof s->path, "%s", path);
    memcpy(s->root, path, folder);
    s->root[folder] = 0;
    snprintf(s->game, sizeof s->game, "%.*s", (int)strcspn(path + folder, "."), path + folder);
    if (!run_file(s, path)) {
        return false;
    }
    *conf = (script_conf){0};
    lua_rawgeti(L, LUA_REGISTRYINDEX, s->corsac_ref);
    lua_getfield(L, -1, "conf");
    lua_remove(L, -2);
    if (!lua_isfunction(L, -1)) {
        lua_pop(L, 1);
        return true;
    }
    lua_newtable(L);
    lua_pushvalue(L, -1);
    lua_insert(L, -3); // t, conf, t
    if (!script_call(s, BIND_CONF, 1, 0)) {
        lua_pop(L, 1);
        return false;
    }
    lua_pushcfunction(L, read_conf);
    lua_insert(L, -2);
    lua_pushlightuserdata(L, s);
    lua_insert(L, -2);
    lua_pushlightuserdata(L, conf);
    lua_insert(L, -2);
    return script_call(s, BIND_CONF, 3, 0);
}
