// Values from one state to another (pack.h).
#include "script/pack.h"

#include "script/internal.h"

#include <string.h>

enum { TAG_NIL, TAG_FALSE, TAG_TRUE, TAG_NUMBER, TAG_STRING, TAG_TABLE, TAG_END, TAG_OBJECT };

static int collect(lua_State *L) {
    script_pack_release(lua_touserdata(L, 1));
    return 0;
}

script_pack *script_pack_new(lua_State *L) {
    script_pack *p = lua_newuserdata(L, sizeof *p);
    *p = (script_pack){0};
    if (luaL_newmetatable(L, "corsac.pack")) {
        lua_pushcfunction(L, collect);
        lua_setfield(L, -2, "__gc");
    }
    lua_setmetatable(L, -2);
    return p;
}

static void append(lua_State *L, script_pack *p, const void *data, size_t size) {
    if (p->size + size > PACK_BYTES_MAX) {
        bind_error(L, "data that crosses between game and mod is at most %d KiB",
                   PACK_BYTES_MAX >> 10);
    }
    if (p->size + size > (p->heap ? p->capacity : sizeof p->small)) {
        size_t capacity = CORE_MAX(256, 2 * (p->size + size));
        unsigned char *heap = core_realloc(p->heap, p->heap ? p->capacity : 0, capacity);
        if (!p->heap) {
            memcpy(heap, p->small, p->size);
        }
        p->heap = heap;
        p->capacity = capacity;
    }
    memcpy((p->heap ? p->heap : p->small) + p->size, data, size);
    p->size += size;
}

static const unsigned char *bytes_of(const script_pack *p) { return p->heap ? p->heap : p->small; }

static void append_tag(lua_State *L, script_pack *p, int tag) {
    unsigned char byte = (unsigned char)tag;
    append(L, p, &byte, 1);
}

static void pack(script *s, lua_State *L, int index, script_pack *p, int depth);

static void pack_table(script *s, lua_State *L, int index, script_pack *p, int depth) {
    if (depth == PACK_DEPTH_MAX) {
        bind_error(L,
                   "data that crosses between game and mod nests at most %d deep (does it "
                   "contain itself?)",
                   PACK_DEPTH_MAX);
    }
    luaL_checkstack(L, 8, "data nests too deeply");
    append_tag(L, p, TAG_TABLE);
    lua_pushnil(L);
    while (lua_next(L, index)) {
        int type = lua_type(L, -2);
        if (type != LUA_TSTRING && type != LUA_TNUMBER && type != LUA_TBOOLEAN) {
            bind_error(L, "a %s as key does not cross between game and mod", luaL_typename(L, -2));
        }
        int top = lua_gettop(L);
        pack(s, L, top - 1, p, depth + 1);
        pack(s, L, top, p, depth + 1);
        lua_pop(L, 1);
    }
    append_tag(L, p, TAG_END);
}

static void pack(script *s, lua_State *L, int index, script_pack *p, int depth) {
    switch (lua_type(L, index)) {
    case LUA_TNONE:
    case LUA_TNIL:
        append_tag(L, p, TAG_NIL);
        return;
    case LUA_TBOOLEAN:
        append_tag(L, p, lua_toboolean(L, index) ? TAG_TRUE : TAG_FALSE);
        return;
    case LUA_TNUMBER: {
        double v = lua_tonumber(L, index);
        append_tag(L, p, TAG_NUMBER);
        append(L, p, &v, sizeof v);
        return;
    }
    case LUA_TSTRING: {
        size_t length;
        const char *text = lua_tolstring(L, index, &length);
        append_tag(L, p, TAG_STRING);
        append(L, p, &length, sizeof length);
        append(L, p, text, length);
        return;
    }
    case LUA_TTABLE:
        pack_table(s, L, index, p, depth);
        return;
    case LUA_TUSERDATA:
        for (int i = 0; i < s->type_count; i++) {
            core_handle h = bind_object_handle(s, L, index, s->type[i].type);
            if (!core_handle_is_null(h)) {
                append_tag(L, p, TAG_OBJECT);
                append(L, p, &s->type[i].type, sizeof s->type[i].type);
                append(L, p, &h, sizeof h);
                return;
            }
        }
        break;
    default:
        break;
    }
    bind_error(L, "a %s does not cross between game and mod; plain data and objects do",
               luaL_typename(L, index));
}

void script_pack_value(script *s, lua_State *L, int index, script_pack *out) {
    pack(s, L, index < 0 ? lua_gettop(L) + 1 + index : index, out, 0);
    out->values++;
}

static void take(const script_pack *p, size_t *at, void *out, size_t size) {
    memcpy(out, bytes_of(p) + *at, size);
    *at += size;
}

static void unpack(script *s, lua_State *L, const script_pack *p, size_t *at) {
    unsigned char tag;
    take(p, at, &tag, 1);
    luaL_checkstack(L, 8, "data nests too deeply");
    switch (tag) {
    case TAG_NIL:
        lua_pushnil(L);
        return;
    case TAG_FALSE:
    case TAG_TRUE:
        lua_pushboolean(L, tag == TAG_TRUE);
        return;
    case TAG_NUMBER: {
        double v;
        take(p, at, &v, sizeof v);
        lua_pushnumber(L, v);
        return;
    }
    case TAG_STRING: {
        size_t length;
        take(p, at, &length, sizeof length);
        lua_pushlstring(L, (const char *)bytes_of(p) + *at, length);
        *at += length;
        return;
    }
    case TAG_OBJECT: {
        const bind_type *type;
        core_handle h;
        take(p, at, &type, sizeof type);
        take(p, at, &h, sizeof h);
        bind_push(s, L, type, h);
        return;
    }
    default:
        lua_newtable(L);
        while (bytes_of(p)[*at] != TAG_END) {
            unpack(s, L, p, at);
            unpack(s, L, p, at);
            lua_rawset(L, -3);
        }
        ++*at;
    }
}

int script_unpack(script *s, lua_State *L, const script_pack *in) {
    size_t at = 0;
    luaL_checkstack(L, in->values + 8, "too many values");
    for (int i = 0; i < in->values; i++) {
        unpack(s, L, in, &at);
    }
    return in->values;
}

void script_pack_release(script_pack *p) {
    core_free(p->heap);
    *p = (script_pack){0};
}
