// corsac.scene: tags, and finding entities by tags, components and place.
#include "script/bind_query.h"
#include "script/bind_body.h"
#include "script/internal.h"

#include <string.h>

uint64_t bind_tags(script *s, lua_State *L, int list, const char *owner) {
    uint64_t bits = 0;
    for (int i = 1; list; i++) {
        lua_rawgeti(L, list, i);
        if (lua_isnil(L, -1)) {
            lua_pop(L, 1);
            break;
        }
        if (lua_type(L, -1) != LUA_TSTRING) {
            bind_error(L, "%s: tags must be names in an array: {\"enemy\", \"boss\"}", owner);
        }
        int tag = scene_tag(s->scene, lua_tostring(L, -1));
        if (tag < 0) {
            bind_fail(L);
        }
        bits |= (uint64_t)1 << tag;
        lua_pop(L, 1);
    }
    return bits;
}

// ---- methods of entities ----

int bind_add_tag(script *s, lua_State *L, void *args) {
    const bind_tag_args *a = args;
    if (!scene_set_tag(s->scene, a->self, a->name, true)) {
        bind_fail(L);
    }
    return 0;
}

int bind_remove_tag(script *s, lua_State *L, void *args) {
    const bind_tag_args *a = args;
    if (!scene_set_tag(s->scene, a->self, a->name, false)) {
        bind_fail(L);
    }
    return 0;
}

int bind_has_tag(script *s, lua_State *L, void *args) {
    const bind_tag_args *a = args;
    lua_pushboolean(L, scene_has_tag(s->scene, a->self, a->name));
    return 1;
}

// ---- queries ----

typedef struct query_options {
    int tags, without, has;
    core_vec3 min, max, center;
    float radius;
    bool has_min, has_max, has_radius;
} query_options;
typedef struct query_call {
    query_options options;
} query_call;

static uint32_t read_components(lua_State *L, int list) {
    static const char *const names[] = {"body", "mesh", "animator", "agent", "sound"};
    uint32_t bits = 0;
    for (int i = 1; list; i++) {
        lua_rawgeti(L, list, i);
        const char *name = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : NULL;
        bool end = lua_isnil(L, -1);
        lua_pop(L, 1);
        if (end) {
            break;
        }
        size_t n = 0;
        while (n < CORE_COUNT_OF(names) && !(name && strcmp(names[n], name) == 0)) {
            n++;
        }
        if (n == CORE_COUNT_OF(names)) {
            bind_error(L,
                       "corsac.scene.findAll: has: expected \"body\", \"mesh\", \"animator\", "
                       "\"agent\" or \"sound\", got %s",
                       name ? name : "something else");
        }
        bits |= 1u << n;
    }
    return bits;
}

static int find_all(script *s, lua_State *L, void *args) {
    const query_options *o = &((query_call *)args)->options;
    scene_query q = scene_query_default();
    q.tags = bind_tags(s, L, o->tags, "corsac.scene.findAll");
    q.without = bind_tags(s, L, o->without, "corsac.scene.findAll");
    q.has = read_components(L, o->has);
    q.min = o->has_min ? o->min : q.min;
    q.max = o->has_max ? o->max : q.max;
    q.center = o->center;
    q.radius = o->has_radius ? o->radius : q.radius;
    uint32_t count = scene_find_all(s->scene, &q, NULL, 0);
    scene_entity *found = lua_newuserdata(L, (count + 1) * sizeof *found);
    scene_find_all(s->scene, &q, found, count);
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        bind_push(s, L, &bind_entity_type, found[i]);
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}

static const bind_arg query_fields[] = {
    {"tags", BIND_TABLE, BIND_AT(query_options, tags), "names: has all of these", .optional = true,
     .def_text = "none"},
    {"without", BIND_TABLE, BIND_AT(query_options, without), "names: has none of these",
     .optional = true, .def_text = "none"},
    {"has", BIND_TABLE, BIND_AT(query_options, has),
     "has all of these: \"body\", \"mesh\", \"animator\", \"agent\", \"sound\"", .optional = true,
     .def_text = "none"},
    {"min", BIND_VEC3, BIND_AT(query_options, min), "corner of a box around its position", "m",
     .optional = true, .def_text = "none", BIND_GIVEN(query_options, has_min)},
    {"max", BIND_VEC3, BIND_AT(query_options, max), "the other corner", "m", .optional = true,
     .def_text = "none", BIND_GIVEN(query_options, has_max)},
    {"center", BIND_VEC3, BIND_AT(query_options, center), "of a ball around its position", "m",
     .optional = true},
    {"radius", BIND_FLOAT, BIND_AT(query_options, radius), "of that ball", "m", BIND_POSITIVE,
     .optional = true, .def_text = "everywhere", BIND_GIVEN(query_options, has_radius)},
    {0}};

const bind_fn bind_query_functions[] = {
    {"findAll", "Entities by tags, components and place, in an order that every run repeats.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(query_call, options), "what they must have",
                .fields = query_fields}),
     BIND_RETURNS({"entities", "corsac.Entity[]", NULL}), sizeof(query_call), BIND_RUNNING,
     .mod = true, .cost = 2000, .run = find_all},
    {0}};
