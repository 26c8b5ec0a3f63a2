// Lua data to JSON and back. Also the form in which data crosses from one state to another.
#include "core/json.h"
#include "script/bind.h"
#include "script/json.h"
#include "script/order.h"

#include <cJSON.h>
#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { JSON_DEPTH_MAX = 200, JSON_PATH_MAX = 256 };

typedef struct json_writer {
    lua_State *L;
    core_json out;
    char path[JSON_PATH_MAX];
    int depth;
} json_writer;

static void write_value(json_writer *w, int index, const char *key);

CORE_NORETURN static void refuse(json_writer *w, const char *why) {
    core_json_release(&w->out);
    bind_error(w->L, "%s %s; plain data is numbers, strings, true, false and tables of these",
               w->path, why);
}

// Number of items when the keys are just 1..n, -1 otherwise.
static int array_length(lua_State *L, int index) {
    int count = 0;
    bool array = true;
    lua_pushnil(L);
    while (lua_next(L, index)) {
        lua_pop(L, 1);
        count++;
    }
    for (int i = 1; array && i <= count; i++) {
        lua_rawgeti(L, index, i);
        array = !lua_isnil(L, -1);
        lua_pop(L, 1);
    }
    return array ? count : -1;
}

static void write_object(json_writer *w, int index, const char *key) {
    lua_State *L = w->L;
    core_json_object(&w->out, key);
    size_t end = strlen(w->path);
    lua_pushcfunction(L, script_order_keys);
    lua_pushvalue(L, index);
    if (lua_pcall(L, 1, 2, 0) != 0) {
        refuse(w, "has a table or function as key");
    }
    int keys = lua_gettop(L) - 1, count = (int)lua_tonumber(L, -1);
    for (int i = 1; i <= count; i++) {
        lua_rawgeti(L, keys, i);
        if (lua_type(L, -1) != LUA_TSTRING) {
            refuse(w, "has a key that is no string beside others (use an array, or strings only)");
        }
        const char *name = lua_tostring(L, -1);
        snprintf(w->path + end, sizeof w->path - end, ".%s", name);
        lua_pushvalue(L, -1);
        lua_rawget(L, index);
        write_value(w, lua_gettop(L), name);
        lua_pop(L, 2);
        w->path[end] = 0;
    }
    lua_pop(L, 2);
    core_json_end_object(&w->out);
}

static void write_table(json_writer *w, int index, const char *key) {
    lua_State *L = w->L;
    if (++w->depth > JSON_DEPTH_MAX) {
        refuse(w, "is nested too deeply (does it contain itself?)");
    }
    luaL_checkstack(L, 8, "data nests too deeply");
    int count = array_length(L, index);
    if (count < 0) {
        write_object(w, index, key);
    } else {
        core_json_array(&w->out, key);
        size_t end = strlen(w->path);
        for (int i = 1; i <= count; i++) {
            snprintf(w->path + end, sizeof w->path - end, "[%d]", i);
            lua_rawgeti(L, index, i);
            write_value(w, lua_gettop(L), NULL);
            lua_pop(L, 1);
            w->path[end] = 0;
        }
        core_json_end_array(&w->out);
    }
    w->depth--;
}

static void write_value(json_writer *w, int index, const char *key) {
    lua_State *L = w->L;
    switch (lua_type(L, index)) {
    case LUA_TBOOLEAN:
        core_json_bool(&w->out, key, lua_toboolean(L, index));
        break;
    case LUA_TSTRING:
        if (strlen(lua_tostring(L, index)) != lua_objlen(L, index)) {
            refuse(w, "is a string with a zero byte");
        }
        core_json_string(&w->out, key, lua_tostring(L, index));
        break;
    case LUA_TNUMBER:
        if (!isfinite(lua_tonumber(L, index))) {
            refuse(w, "is not finite");
        }
        core_json_number(&w->out, key, lua_tonumber(L, index));
        break;
    case LUA_TTABLE:
        write_table(w, index, key);
        break;
    case LUA_TNIL:
        core_json_null(&w->out, key);
        break;
    default: {
        char why[64];
        snprintf(why, sizeof why, "is a %s", luaL_typename(L, index));
        refuse(w, why);
    }
    }
}

char *script_json_write(lua_State *L, int index, const char *what) {
    json_writer w = {.L = L};
    snprintf(w.path, sizeof w.path, "%s", what);
    core_json_init(&w.out, false);
    write_value(&w, index < 0 ? lua_gettop(L) + 1 + index : index, NULL);
    return w.out.text;
}

static void push_item(lua_State *L, const cJSON *item) {
    luaL_checkstack(L, 8, "JSON nests too deeply");
    if (cJSON_IsBool(item)) {
        lua_pushboolean(L, cJSON_IsTrue(item));
    } else if (cJSON_IsNumber(item)) {
        lua_pushnumber(L, item->valuedouble);
    } else if (cJSON_IsString(item)) {
        lua_pushstring(L, item->valuestring);
    } else if (cJSON_IsArray(item) || cJSON_IsObject(item)) {
        int i = 0;
        const cJSON *child;
        lua_newtable(L);
        cJSON_ArrayForEach(child, item) {
            push_item(L, child);
            if (cJSON_IsArray(item)) {
                lua_rawseti(L, -2, ++i);
            } else {
                lua_pushstring(L, child->string);
                lua_insert(L, -2);
                lua_rawset(L, -3);
            }
        }
    } else {
        lua_pushnil(L);
    }
}

// cJSON itself refuses more than 1000 levels; Lua's C stack wants fewer.
static bool too_deep(const char *text, size_t size) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < size; i++) {
        if (text[i] == '\\' && quoted) {
            i++;
        } else if (text[i] == '"') {
            quoted = !quoted;
        } else if (!quoted && (text[i] == '[' || text[i] == '{') && ++depth > JSON_DEPTH_MAX) {
            return true;
        } else if (!quoted && (text[i] == ']' || text[i] == '}')) {
            depth--;
        }
    }
    return false;
}

bool script_json_read(lua_State *L, const char *text, size_t size) {
    const char *end = NULL;
    if (too_deep(text, size)) {
        return core_fail_quiet("JSON: nested more than %d deep", JSON_DEPTH_MAX);
    }
    cJSON *root = cJSON_ParseWithLengthOpts(text, size, &end, false);
    if (root) {
        while (end < text + size && strchr(" \t\r\n", *end)) {
            end++;
        }
    }
    if (!root || end < text + size) {
        cJSON_Delete(root);
        int line = 1;
        for (const char *c = text; end && c < end && c < text + size; c++) {
            line += *c == '\n';
        }
        char near[21] = "the end";
        for (size_t i = 0; end && end + i < text + size && i < sizeof near - 1; i++) {
            near[i] = end[i] >= 32 && end[i] < 127 ? end[i] : '?'; // it goes to terminals
            near[i + 1] = 0;
        }
        return core_fail_quiet("JSON: line %d, near \"%s\": not valid JSON", line, near);
    }
    push_item(L, root);
    cJSON_Delete(root);
    return true;
}
