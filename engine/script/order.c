// One order for walking a table, the same in every run: numbers ascending, then strings by bytes,
// false, true, then the engine's objects by class and handle. LuaJIT's own order depends on
// addresses and on which strings were made before.
#include "script/order.h"
#include "script/internal.h"

#include <stdlib.h>
#include <string.h>

typedef struct order_key {
    int rank; // 0 number, 1 string, 2 boolean, 3 object
    double number;
    const char *text;
    size_t length;
    core_handle handle;
} order_key;

static bool is_object(lua_State *L, int index) {
    if (!lua_getmetatable(L, index)) {
        return false;
    }
    lua_getfield(L, -1, "__metatable");
    bool object = lua_type(L, -1) == LUA_TSTRING && lua_objlen(L, index) == sizeof(bind_object);
    lua_pop(L, 2);
    return object;
}

static void read_key(lua_State *L, int index, order_key *out) {
    *out = (order_key){0};
    switch (lua_type(L, index)) {
    case LUA_TNUMBER:
        out->number = lua_tonumber(L, index);
        return;
    case LUA_TSTRING:
        out->rank = 1;
        out->text = lua_tolstring(L, index, &out->length);
        return;
    case LUA_TBOOLEAN:
        out->rank = 2;
        out->number = lua_toboolean(L, index);
        return;
    case LUA_TUSERDATA:
        if (is_object(L, index)) {
            const bind_object *object = lua_touserdata(L, index);
            out->rank = 3;
            out->text = object->type->name;
            out->length = strlen(out->text);
            out->handle = object->handle;
            return;
        }
        break;
    default:
        break;
    }
    bind_error(L,
               "this table has a %s as key; such keys have no order that is the same in every "
               "run, so they cannot be walked with pairs or next. Use corsac.newMap() (ordered "
               "by insertion) or an array",
               luaL_typename(L, index));
}

static int compare_keys(const void *pa, const void *pb) {
    const order_key *a = pa, *b = pb;
    if (a->rank != b->rank) {
        return a->rank < b->rank ? -1 : 1;
    }
    if (a->number != b->number) {
        return a->number < b->number ? -1 : 1;
    }
    if (a->text) {
        int c = memcmp(a->text, b->text, CORE_MIN(a->length, b->length));
        if (c != 0) {
            return c;
        }
        if (a->length != b->length) {
            return a->length < b->length ? -1 : 1;
        }
    }
    if (a->handle.index != b->handle.index) {
        return a->handle.index < b->handle.index ? -1 : 1;
    }
    return (a->handle.generation > b->handle.generation) -
           (a->handle.generation < b->handle.generation);
}

static void push_plain_key(lua_State *L, const order_key *key) {
    if (key->rank == 2) {
        lua_pushboolean(L, key->number != 0);
    } else if (key->rank == 1) {
        lua_pushlstring(L, key->text, key->length);
    } else {
        lua_pushnumber(L, key->number);
    }
}

int script_order_keys(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    size_t count = 0;
    bool array = true;
    lua_pushnil(L);
    while (lua_next(L, 1)) {
        lua_pop(L, 1);
        count++;
        array = array && lua_type(L, -1) == LUA_TNUMBER && lua_tonumber(L, -1) == (double)count;
    }
    if (array) { // 1..count and nothing else: the caller counts
        lua_pushnil(L);
        lua_pushnumber(L, (double)count);
        return 2;
    }
    order_key *keys = lua_newuserdata(L, count * sizeof *keys);
    size_t objects = 0, n = 0;
    lua_pushnil(L);
    while (lua_next(L, 1)) {
        lua_pop(L, 1);
        read_key(L, lua_gettop(L), &keys[n]);
        objects += keys[n++].rank == 3;
    }
    qsort(keys, count, sizeof *keys, compare_keys);
    lua_createtable(L, (int)count, 0);
    int list = lua_gettop(L);
    for (size_t i = 0; i < count - objects; i++) {
        push_plain_key(L, &keys[i]);
        lua_rawseti(L, list, (int)i + 1);
    }
    lua_pushnil(L);
    while (objects > 0 && lua_next(L, 1)) {
        lua_pop(L, 1);
        if (lua_type(L, -1) != LUA_TUSERDATA) {
            continue;
        }
        order_key key;
        read_key(L, lua_gettop(L), &key);
        const order_key *place = bsearch(&key, keys, count, sizeof *keys, compare_keys);
        lua_pushvalue(L, -1);
        lua_rawseti(L, list, (int)(place - keys) + 1);
    }
    lua_pushvalue(L, list);
    lua_pushnumber(L, (double)count);
    return 2;
}

int script_order_next(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 2);
    bool start = lua_isnil(L, 2), found = false;
    order_key after = {0}, best = {0}, key;
    if (!start) {
        read_key(L, 2, &after);
    }
    lua_pushnil(L); // 3: the best key so far
    lua_pushnil(L);
    while (lua_next(L, 1)) {
        lua_pop(L, 1);
        read_key(L, 4, &key);
        if ((start || compare_keys(&key, &after) > 0) &&
            (!found || compare_keys(&key, &best) < 0)) {
            best = key;
            found = true;
            lua_pushvalue(L, 4);
            lua_replace(L, 3);
        }
    }
    lua_settop(L, 3);
    if (!found) {
        return 1;
    }
    lua_pushvalue(L, 3);
    lua_rawget(L, 1);
    return 2;
}
