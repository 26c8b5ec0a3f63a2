// Changes of walkable surfaces: pieces, marks, links.
#include "script/bind_surface.h"

#include <string.h>

#include "script/internal.h"

static nav_world *world_of(script *s) { return scene_nav(s->scene); }

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// ---- triangles and boxes ----

// Lua counts vertices from 1.
static void read_triangles(lua_State *L, const bind_ground *o, uint32_t *index, uint8_t *area) {
    uint32_t vertices = o->vertices.count / 3;
    if (o->vertices.count % 3 || o->triangles.count % 3) {
        bind_error(L, "surface: %u vertex and %u triangle numbers, expected three for each",
                   o->vertices.count, o->triangles.count);
    }
    if (o->areas.count && o->areas.count != o->triangles.count / 3) {
        bind_error(L, "surface: %u areas for %u triangles, expected one for each", o->areas.count,
                   o->triangles.count / 3);
    }
    for (uint32_t i = 0; i < o->triangles.count; i++) {
        double number = (double)o->triangles.items[i];
        if (!(number >= 1.0 && number <= vertices) || number != core_floor(number)) {
            bind_error(L, "surface: triangles[%u] is %g, expected a whole number from 1 to %u",
                       i + 1, number, vertices);
        }
        index[i] = (uint32_t)number - 1;
    }
    for (uint32_t i = 0; i < o->areas.count; i++) {
        double number = (double)o->areas.items[i];
        if (!(number >= 0.0 && number <= 255.0) || number != core_floor(number)) {
            bind_error(L, "surface: areas[%u] is %g, expected a whole number from 0 to 255", i + 1,
                       number);
        }
        area[i] = (uint8_t)number;
    }
}

static void add_box(const bind_ground_box *b, float *vertex, uint32_t *index, uint32_t first) {
    // Corner k: bit 0 x, bit 1 y, bit 2 z. Faces counter-clockwise seen from outside.
    static const uint8_t face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (uint32_t k = 0; k < 8; k++) {
        vertex[3 * k] = b->position.x + (k & 1 ? 0.5f : -0.5f) * b->size.x;
        vertex[3 * k + 1] = b->position.y + (k & 2 ? 0.5f : -0.5f) * b->size.y;
        vertex[3 * k + 2] = b->position.z + (k & 4 ? 0.5f : -0.5f) * b->size.z;
    }
    for (int f = 0; f < 6; f++) {
        const uint32_t corner[6] = {face[f][0], face[f][1], face[f][2],
                                    face[f][0], face[f][2], face[f][3]};
        for (int i = 0; i < 6; i++) {
            index[6 * f + i] = first + corner[i];
        }
    }
}

void bind_read_ground(lua_State *L, const bind_ground *o, core_soup_data *out) {
    uint32_t given = o->vertices.count / 3, own = o->triangles.count / 3;
    *out = (core_soup_data){.vertex_count = given + 8 * o->boxes.count,
                            .triangle_count = own + 12 * o->boxes.count};
    float *vertex = lua_newuserdata(L, (3 * (size_t)out->vertex_count + 1) * sizeof *vertex);
    uint32_t *index = lua_newuserdata(L, (3 * (size_t)out->triangle_count + 1) * sizeof *index);
    uint8_t *area = lua_newuserdata(L, (size_t)out->triangle_count + 1);
    memset(area, 0, out->triangle_count);
    read_triangles(L, o, index, area);
    if (given) {
        memcpy(vertex, o->vertices.items, 3 * (size_t)given * sizeof *vertex);
    }
    const bind_ground_box *box = o->boxes.items;
    for (uint32_t b = 0; b < o->boxes.count; b++) {
        add_box(&box[b], vertex + 3 * (given + 8 * b), index + 3 * own + 36 * b, given + 8 * b);
        memset(area + own + 12 * b, (int)box[b].area, 12);
    }
    out->position = vertex;
    out->index = index;
    out->area = area;
}

int bind_surface_put(script *s, lua_State *L, void *args) {
    const bind_put_args *a = args;
    core_soup_data soup;
    bind_read_ground(L, &a->ground, &soup);
    return done(L, nav_mesh_put(world_of(s), a->self, (uint64_t)a->key, &soup));
}
int bind_surface_remove(script *s, lua_State *L, void *args) {
    const bind_key_args *a = args;
    return done(L, nav_mesh_put(world_of(s), a->self, (uint64_t)a->key, NULL));
}
int bind_surface_mark(script *s, lua_State *L, void *args) {
    const bind_mark_args *a = args;
    core_vec3 half = core_v3_scale(a->box.size, 0.5f);
    core_aabb box = {core_v3_sub(a->box.position, half), core_v3_add(a->box.position, half)};
    return done(L,
                nav_mesh_mark(world_of(s), a->self, (uint64_t)a->key, &box, (uint8_t)a->box.area));
}
int bind_surface_update(script *s, lua_State *L, void *args) {
    return done(L, nav_mesh_update(world_of(s), *(core_handle *)args));
}
int bind_surface_get_waiting(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, nav_mesh_waiting(world_of(s), *(core_handle *)args));
    return 1;
}

// ---- links ----

int bind_surface_add_link(script *s, lua_State *L, void *args) {
    const bind_add_link_args *a = args;
    nav_mesh_link_desc d = nav_mesh_link_desc_default();
    d.start = a->options.from, d.end = a->options.to;
    d.cost = a->options.cost;
    d.both_ways = a->options.both_ways, d.closed = a->options.closed;
    d.kind = (nav_link_kind)a->options.kind;
    uint32_t link = nav_mesh_add_link(world_of(s), a->self, &d);
    if (link == NAV_NO_LINK) {
        bind_fail(L);
    }
    lua_pushnumber(L, link);
    return 1;
}
int bind_surface_remove_link(script *s, lua_State *L, void *args) {
    const bind_key_args *a = args;
    return done(L, nav_mesh_remove_link(world_of(s), a->self, (uint32_t)a->key));
}
int bind_surface_set_link_open(script *s, lua_State *L, void *args) {
    const bind_open_args *a = args;
    return done(L, nav_mesh_set_link_open(world_of(s), a->self, (uint32_t)a->link, a->open));
}
int bind_surface_get_link(script *s, lua_State *L, void *args) {
    static const char *const kinds[] = {"jump", "ladder", "door"};
    const bind_key_args *a = args;
    nav_mesh_link_desc d;
    done(L, nav_mesh_get_link(world_of(s), a->self, (uint32_t)a->key, &d));
    lua_createtable(L, 0, 6);
    bind_push_point(L, d.start);
    lua_setfield(L, -2, "from");
    bind_push_point(L, d.end);
    lua_setfield(L, -2, "to");
    lua_pushnumber(L, (double)d.cost);
    lua_setfield(L, -2, "cost");
    lua_pushboolean(L, d.both_ways);
    lua_setfield(L, -2, "bothWays");
    lua_pushboolean(L, !d.closed);
    lua_setfield(L, -2, "open");
    lua_pushstring(L, kinds[d.kind]);
    lua_setfield(L, -2, "kind");
    return 1;
}
