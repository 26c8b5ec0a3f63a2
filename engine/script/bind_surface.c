// Walkable surfaces of corsac.nav.
#include "script/bind_nav.h"
#include "script/internal.h"

#include <string.h>

static nav_world *world_of(script *s) { return scene_nav(s->scene); }

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

static bool surface_alive(script *s, core_handle h) {
    nav_world *w = scene_nav_if(s->scene);
    return w && nav_mesh_alive(w, h);
}

// ---- making ----

typedef struct box_options {
    core_vec3 position, size;
} box_options;

// The triangles given, then twelve for each box. Lua counts vertices from 1.
static void read_triangles(lua_State *L, const bind_surface_options *o, uint32_t *index) {
    uint32_t vertices = o->vertices.count / 3;
    if (o->vertices.count % 3 || o->triangles.count % 3) {
        bind_error(L,
                   "corsac.nav.newSurface: %u vertex and %u triangle numbers, expected three for "
                   "each",
                   o->vertices.count, o->triangles.count);
    }
    for (uint32_t i = 0; i < o->triangles.count; i++) {
        double number = (double)o->triangles.items[i];
        if (!(number >= 1.0 && number <= vertices) || number != core_floor(number)) {
            bind_error(L,
                       "corsac.nav.newSurface: triangles[%u] is %g, expected a whole number from "
                       "1 to %u",
                       i + 1, number, vertices);
        }
        index[i] = (uint32_t)number - 1;
    }
}

static void add_box(const box_options *b, float *vertex, uint32_t *index, uint32_t first) {
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

int bind_surface_new(script *s, lua_State *L, void *args) {
    const bind_surface_options *o = &((bind_surface_call *)args)->options;
    uint32_t given = o->vertices.count / 3;
    core_soup_data soup = {.vertex_count = given + 8 * o->boxes.count,
                           .triangle_count = o->triangles.count / 3 + 12 * o->boxes.count};
    // Collected by Lua, also when an error is raised.
    float *vertex = lua_newuserdata(L, (3 * (size_t)soup.vertex_count + 1) * sizeof *vertex);
    uint32_t *index = lua_newuserdata(L, (3 * (size_t)soup.triangle_count + 1) * sizeof *index);
    read_triangles(L, o, index);
    if (given) {
        memcpy(vertex, o->vertices.items, 3 * given * sizeof *vertex);
    }
    for (uint32_t b = 0; b < o->boxes.count; b++) {
        add_box((const box_options *)o->boxes.items + b, vertex + 3 * (given + 8 * b),
                index + o->triangles.count + 36 * b, given + 8 * b);
    }
    soup.position = vertex;
    soup.index = index;
    nav_mesh_desc desc = nav_mesh_desc_default();
    desc.cell_size = o->cell_size;
    desc.agent_radius = o->radius;
    desc.agent_height = o->height;
    desc.max_climb = o->climb;
    desc.max_slope = o->slope;
    nav_mesh mesh = nav_mesh_build(world_of(s), &soup, &desc);
    if (core_handle_is_null(mesh)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_surface_type, mesh);
    return 1;
}

// ---- methods ----

typedef struct point_args {
    core_handle self;
    float x, y, z, limit;
} point_args;
static int nearest(script *s, lua_State *L, void *args) {
    const point_args *a = args;
    core_vec3 p;
    if (!nav_mesh_nearest(world_of(s), a->self, core_v3(a->x, a->y, a->z), a->limit, &p)) {
        return 0;
    }
    bind_push_vec3(L, p);
    return 3;
}

typedef struct way_args {
    core_handle self;
    core_vec3 start, goal;
} way_args;
static int find_path(script *s, lua_State *L, void *args) {
    const way_args *a = args;
    nav_result result;
    done(L, nav_mesh_search(world_of(s), a->self, a->start, a->goal, &result, NULL, 0));
    if (result.count == 0) {
        lua_pushnil(L);
    } else {
        core_vec3 *point = lua_newuserdata(L, result.count * sizeof *point);
        nav_mesh_search(world_of(s), a->self, a->start, a->goal, &result, point, result.count);
        lua_createtable(L, (int)result.count, 0);
        for (uint32_t i = 0; i < result.count; i++) {
            bind_push_point(L, point[i]);
            lua_rawseti(L, -2, (int)i + 1);
        }
    }
    lua_pushnumber(L, result.cost);
    return 2;
}
static int new_path(script *s, lua_State *L, void *args) {
    const way_args *a = args;
    nav_path path = nav_path_create_on_mesh(world_of(s), a->self, a->start, a->goal);
    if (core_handle_is_null(path)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_path_type, path);
    return 1;
}
static int get_area(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, nav_mesh_area(world_of(s), *(core_handle *)args));
    return 1;
}
static int get_polygon_count(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, nav_mesh_polygons(world_of(s), *(core_handle *)args));
    return 1;
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, nav_mesh_destroy(world_of(s), *(core_handle *)args));
}

// ---- declarations ----

#define SELF sizeof(core_handle)
#define ENDS                                                                                       \
    BIND_ARGS({"start", BIND_VEC3, BIND_AT(way_args, start), "where it begins", "m"},              \
              {"goal", BIND_VEC3, BIND_AT(way_args, goal), "where it ends", "m"})
#define OPTION(name, member, about, unit, range, value)                                            \
    {                                                                                              \
        name, BIND_FLOAT, BIND_AT(bind_surface_options, member), about, unit, range,               \
            .optional = true, .def = value                                                         \
    }

static const bind_arg box_fields[] = {
    {"position", BIND_VEC3, BIND_AT(box_options, position), "its middle", "m", .optional = true},
    {"size", BIND_VEC3, BIND_AT(box_options, size), "lengths of its edges", "m", BIND_POSITIVE,
     .uniform = true},
    {0}};

const bind_arg bind_surface_fields[] = {
    {"vertices", BIND_NUMBERS, BIND_AT(bind_surface_options, vertices), "x y z after x y z", "m",
     .optional = true},
    {"triangles", BIND_NUMBERS, BIND_AT(bind_surface_options, triangles),
     "three vertices each, counted from 1, counter-clockwise seen from above", .optional = true},
    {"boxes", BIND_LIST, BIND_AT(bind_surface_options, boxes), "upright boxes", .optional = true,
     .fields = box_fields, .size = sizeof(box_options)},
    OPTION("cellSize", cell_size, "how exact it is sideways", "m", BIND_POSITIVE, 0.3),
    OPTION("radius", radius, "of the agent; kept clear of walls and ledges", "m", BIND_NOT_NEGATIVE,
           0.3),
    OPTION("height", height, "of the agent", "m", BIND_POSITIVE, 1.8),
    OPTION("climb", climb, "highest step", "m", BIND_NOT_NEGATIVE, 0.4),
    OPTION("slope", slope, "steepest ground", "rad", BIND_POSITIVE, 0.79),
    {0}};

static const bind_fn methods[] = {
    {"nearest", "The point of it nearest to a point sideways, nothing when there is none.",
     BIND_ARGS({"x", BIND_FLOAT, BIND_AT(point_args, x), "", "m"},
               {"y", BIND_FLOAT, BIND_AT(point_args, y), "chooses the storey", "m"},
               {"z", BIND_FLOAT, BIND_AT(point_args, z), "", "m"},
               {"limit", BIND_FLOAT, BIND_AT(point_args, limit), "largest distance; 0: any", "m",
                BIND_NOT_NEGATIVE, .optional = true}),
     BIND_RETURNS({"x", "number?", "m"}, {"y", "number?", "m"}, {"z", "number?", "m"}),
     sizeof(point_args), BIND_RUNNING, .run = nearest},
    {"findPath", "Shortest way: points {x, y, z} (nil without one) and its length.", ENDS,
     BIND_RETURNS({"points", "number[][]?", NULL}, {"length", "number", "m"}), sizeof(way_args),
     BIND_SIM, .run = find_path},
    {"newPath", "The same as a Path.", ENDS, BIND_RETURNS({"path", "corsac.Path", NULL}),
     sizeof(way_args), BIND_SIM, .run = new_path},
    {"getArea", "Area on the ground plane.", NULL, BIND_RETURNS({"area", "number", "m^2"}), SELF,
     BIND_RUNNING, .run = get_area},
    {"getPolygonCount", "How many polygons it has.", NULL, BIND_RETURNS({"count", "integer", NULL}),
     SELF, BIND_RUNNING, .run = get_polygon_count},
    {"destroy", "Removes it; its paths and agents are left without a way.", NULL, NULL, SELF,
     BIND_SIM, .run = destroy},
    {0}};

const bind_type bind_surface_type = {"Surface", "Ground on which an agent can walk.", surface_alive,
                                     methods};
