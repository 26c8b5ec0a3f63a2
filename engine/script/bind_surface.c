// Walkable surfaces of corsac.nav.
#include "script/bind_surface.h"

#include <math.h>

#include "script/bind_region.h"
#include "script/files.h"
#include "script/internal.h"

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

#define SOURCES "geometry|physics"
enum { FROM_GEOMETRY, FROM_PHYSICS };

static nav_mesh_desc read_desc(lua_State *L, const bind_surface_options *o) {
    nav_mesh_desc desc = nav_mesh_desc_default();
    desc.cell_size = o->cell_size;
    desc.agent_radius = o->radius;
    desc.agent_height = o->height;
    desc.max_climb = o->climb;
    desc.max_slope = o->slope;
    desc.max_error = o->max_error;
    desc.tile_cells = (uint32_t)o->tile_cells;
    desc.tiles_per_step = (uint32_t)o->tiles_per_step;
    if (o->has_low != o->has_high) {
        bind_error(L, "corsac.nav.newSurface: give both `low` and `high`, or neither");
    }
    desc.bounds = (core_aabb){o->low, o->high};
    return desc;
}

static nav_mesh from_physics(script *s, lua_State *L, const bind_surface_options *o) {
    if (o->ground.vertices.count || o->ground.boxes.count) {
        bind_error(L, "corsac.nav.newSurface: from = \"physics\" takes its ground from bodies; "
                      "leave out vertices and boxes");
    }
    scene_surface_desc desc = scene_surface_desc_default();
    uint32_t tiles = desc.nav.tile_cells;
    desc.nav = read_desc(L, o);
    desc.nav.tile_cells = desc.nav.tile_cells ? desc.nav.tile_cells : tiles;
    desc.layers = bind_layer_bits(s, L, o->layers);
    desc.kinematic = o->kinematic;
    desc.tolerance = o->tolerance;
    return scene_surface_create(s->scene, &desc);
}

int bind_surface_new(script *s, lua_State *L, void *args) {
    const bind_surface_options *o = &((bind_surface_call *)args)->options;
    nav_mesh mesh;
    if (o->from == FROM_PHYSICS) {
        mesh = from_physics(s, L, o);
    } else {
        core_soup_data soup;
        nav_mesh_desc desc = read_desc(L, o);
        bind_read_ground(L, &o->ground, &soup);
        mesh = nav_mesh_build(world_of(s), &soup, &desc);
    }
    if (core_handle_is_null(mesh)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_surface_type, mesh);
    return 1;
}

int bind_surface_load(script *s, lua_State *L, void *args) {
    const char *path = ((bind_load_call *)args)->path;
    size_t size = 0;
    bool own = core_vfs_exists(scene_vfs(s->scene), path);
    core_vfs *files = own ? scene_vfs(s->scene) : script_player_files(s);
    void *data = files ? core_vfs_read(files, path, &size) : NULL;
    nav_mesh mesh = data ? nav_mesh_load(world_of(s), data, size) : CORE_NULL_HANDLE;
    core_free(data);
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
typedef struct way_options {
    bind_numbers costs;
    bool partial;
} way_options;
typedef struct find_args {
    way_args way;
    way_options options;
} find_args;

static void push_way(lua_State *L, const core_vec3 *point, const uint32_t *link, uint32_t count) {
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        bind_push_point(L, point[i]);
        if (link[i] != NAV_NO_LINK) {
            lua_pushnumber(L, link[i]);
            lua_setfield(L, -2, "link");
        }
        lua_rawseti(L, -2, (int)i + 1);
    }
}

static int find_path(script *s, lua_State *L, void *args) {
    const find_args *a = args;
    if (a->options.costs.count > NAV_AREAS) {
        bind_error(L, "Surface:findPath: costs of %u areas, there are %u", a->options.costs.count,
                   NAV_AREAS);
    }
    float cost[NAV_AREAS] = {0};                            // 0: 1
    for (uint32_t i = 0; i < a->options.costs.count; i++) { // < 0: not walked
        cost[i] = a->options.costs.items[i] < 0.0f ? INFINITY : a->options.costs.items[i];
    }
    nav_mesh_query query = nav_mesh_query_default();
    query.mesh = a->way.self;
    query.start = a->way.start, query.goal = a->way.goal;
    query.partial = a->options.partial;
    query.area_cost = cost;
    nav_result result;
    done(L, nav_mesh_find_way(world_of(s), &query, &result, NULL, NULL, 0));
    if (result.count == 0) {
        lua_pushnil(L);
    } else {
        core_vec3 *point = lua_newuserdata(L, result.count * sizeof *point);
        uint32_t *link = lua_newuserdata(L, result.count * sizeof *link);
        nav_mesh_last_way(world_of(s), point, link, result.count);
        push_way(L, point, link, result.count);
    }
    lua_pushnumber(L, result.cost);
    lua_pushstring(L, nav_status_name(result.status));
    return 3;
}

typedef struct save_args {
    core_handle self;
    const char *path;
} save_args;
static int save(script *s, lua_State *L, void *args) {
    const save_args *a = args;
    size_t size = nav_mesh_save(world_of(s), a->self, NULL, 0);
    void *data = lua_newuserdata(L, size + 1);
    nav_mesh_save(world_of(s), a->self, data, size);
    core_vfs *files = script_player_files(s);
    return done(L, size && files && core_vfs_write(files, a->path, data, size));
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
static int draw(script *s, lua_State *L, void *args) {
    (void)L;
    const bind_draw_args *a = args;
    scene_draw_surface(s->scene, a->self, a->search);
    return 0;
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

static const bind_arg box_fields[] = {{"position", BIND_VEC3, BIND_AT(bind_ground_box, position),
                                       "its middle", "m", .optional = true},
                                      {"size", BIND_VEC3, BIND_AT(bind_ground_box, size),
                                       "lengths of its edges", "m", BIND_POSITIVE, .uniform = true},
                                      {"area", BIND_INT, BIND_AT(bind_ground_box, area),
                                       "0 to 31, or 255 where nobody walks", NULL, BIND_BETWEEN, 0,
                                       255, .optional = true},
                                      {0}};
#define GROUND(type, in)                                                                           \
    {"vertices",          BIND_NUMBERS, BIND_AT(type, in vertices),                                \
     "x y z after x y z", "m",          .optional = true},                                         \
        {"triangles", BIND_NUMBERS, BIND_AT(type, in triangles),                                   \
         "three vertices each, counted from 1, counter-clockwise seen from above",                 \
         .optional = true},                                                                        \
        {"areas", BIND_NUMBERS, BIND_AT(type, in areas),                                           \
         "of each triangle: 0 to 31, or 255 where nobody walks", .optional = true},                \
    {                                                                                              \
        "boxes", BIND_LIST, BIND_AT(type, in boxes), "upright boxes",                              \
            .optional = true, .fields = box_fields, .size = sizeof(bind_ground_box)                \
    }

const bind_arg bind_surface_fields[] = {
    {"from", BIND_ENUM, BIND_AT(bind_surface_options, from),
     "physics: static bodies, also those made, moved or destroyed later", .optional = true,
     .def = FROM_GEOMETRY, .values = SOURCES},
    GROUND(bind_surface_options, ground.),
    OPTION("cellSize", cell_size, "how exact it is sideways", "m", BIND_POSITIVE, 0.3),
    OPTION("maxError", max_error,
           "in place of cellSize: ground further than radius + maxError from walls is covered", "m",
           BIND_POSITIVE, 0),
    OPTION("radius", radius, "of the agent; kept clear of walls and ledges", "m", BIND_NOT_NEGATIVE,
           0.3),
    OPTION("height", height, "of the agent", "m", BIND_POSITIVE, 1.8),
    OPTION("climb", climb, "highest step", "m", BIND_NOT_NEGATIVE, 0.4),
    OPTION("slope", slope, "steepest ground", "rad", BIND_POSITIVE, 0.79),
    {"tileCells", BIND_INT, BIND_AT(bind_surface_options, tile_cells),
     "side of a tile in cells: a change makes only its tiles anew; 0: one that cannot change", NULL,
     BIND_BETWEEN, 0, 1024, .optional = true, .def_text = "0; from physics 64"},
    {"tilesPerStep", BIND_INT, BIND_AT(bind_surface_options, tiles_per_step),
     "made anew in a step at most", NULL, BIND_BETWEEN, 1, 65536, .optional = true, .def = 4},
    {"low", BIND_VEC3, BIND_AT(bind_surface_options, low),
     "with tiles: corner of what it may ever cover", "m", .optional = true,
     .def_text = "of the ground", BIND_GIVEN(bind_surface_options, has_low)},
    {"high", BIND_VEC3, BIND_AT(bind_surface_options, high), "the opposite corner", "m",
     .optional = true, .def_text = "of the ground", BIND_GIVEN(bind_surface_options, has_high)},
    {"layers", BIND_TABLE, BIND_AT(bind_surface_options, layers),
     "from physics: names of collision layers that count", .optional = true, .def_text = "all"},
    {"kinematic", BIND_BOOL, BIND_AT(bind_surface_options, kinematic),
     "from physics: kinematic bodies count where they have rested for six steps", .optional = true},
    OPTION("tolerance", tolerance, "from physics: by which round shapes may be cut flat", "m",
           BIND_POSITIVE, 0.02),
    {0}};

static const bind_arg way_fields[] = {
    {"costs", BIND_NUMBERS, BIND_AT(way_options, costs),
     "of a metre in area 0, 1, 2 ...; 0: 1; below 0: not walked", .optional = true},
    {"partial", BIND_BOOL, BIND_AT(way_options, partial),
     "without a way: to the reachable point nearest to the goal", .optional = true},
    {0}};
static const bind_arg link_fields[] = {
    {"from", BIND_VEC3, BIND_AT(bind_link_options, from), "on the surface", "m"},
    {"to", BIND_VEC3, BIND_AT(bind_link_options, to), "on the surface", "m"},
    {"cost", BIND_FLOAT, BIND_AT(bind_link_options, cost), "as metres of ground; 0: its length",
     "m", BIND_NOT_NEGATIVE, .optional = true},
    {"bothWays", BIND_BOOL, BIND_AT(bind_link_options, both_ways), "", .optional = true},
    {"closed", BIND_BOOL, BIND_AT(bind_link_options, closed), "not walked until it is opened",
     .optional = true},
    {"kind", BIND_ENUM, BIND_AT(bind_link_options, kind), "for whoever moves the agent",
     .optional = true, .def = NAV_LINK_JUMP, .values = "jump|ladder|door"},
    {0}};
#define MOST_KEY 9007199254740992.0 // 2^53
#define KEY(type)                                                                                  \
    {                                                                                              \
        "key", BIND_INT, BIND_AT(type, key), "a number of its own; 0 is what it was made from",    \
            NULL, BIND_BETWEEN, 0, MOST_KEY                                                        \
    }
#define LINK(type, member)                                                                         \
    { "link", BIND_INT, BIND_AT(type, member), "which", NULL, BIND_BETWEEN, 0, 4294967294.0 }

static const bind_arg ground_fields[] = {GROUND(bind_ground, ), {0}};

static const bind_fn methods[] = {
    {"nearest", "The point of it nearest to a point sideways, nothing when there is none.",
     BIND_ARGS({"x", BIND_FLOAT, BIND_AT(point_args, x), "", "m"},
               {"y", BIND_FLOAT, BIND_AT(point_args, y), "chooses the storey", "m"},
               {"z", BIND_FLOAT, BIND_AT(point_args, z), "", "m"},
               {"limit", BIND_FLOAT, BIND_AT(point_args, limit), "largest distance; 0: any", "m",
                BIND_NOT_NEGATIVE, .optional = true}),
     BIND_RETURNS({"x", "number?", "m"}, {"y", "number?", "m"}, {"z", "number?", "m"}),
     sizeof(point_args), BIND_RUNNING, .run = nearest},
    {"findPath",
     "Shortest way: points {x, y, z, link = id of the link to the next} (nil without one), its "
     "cost, and the status.",
     BIND_ARGS({"start", BIND_VEC3, BIND_AT(find_args, way.start), "where it begins", "m"},
               {"goal", BIND_VEC3, BIND_AT(find_args, way.goal), "where it ends", "m"},
               {"options", BIND_OPTIONS, BIND_AT(find_args, options), "how to search",
                .optional = true, .fields = way_fields}),
     BIND_RETURNS({"points", "number[][]?", NULL}, {"length", "number", "m"},
                  {"status", "string", NULL}),
     sizeof(find_args), BIND_SIM, .run = find_path},
    {"put", "Puts triangles and boxes in the place of those under a key.",
     BIND_ARGS(KEY(bind_put_args), {"ground", BIND_OPTIONS, BIND_AT(bind_put_args, ground), "",
                                    .fields = ground_fields}),
     NULL, sizeof(bind_put_args), BIND_SIM, .run = bind_surface_put},
    {"remove", "Removes what is under a key.", BIND_ARGS(KEY(bind_key_args)), NULL,
     sizeof(bind_key_args), BIND_SIM, .run = bind_surface_remove},
    {"mark", "Gives the ground inside a box an area.",
     BIND_ARGS(KEY(bind_mark_args),
               {"box", BIND_OPTIONS, BIND_AT(bind_mark_args, box), "", .fields = box_fields}),
     NULL, sizeof(bind_mark_args), BIND_SIM, .run = bind_surface_mark},
    {"update", "Makes all tiles anew that wait for it; steps do so a few at a time.", NULL, NULL,
     SELF, BIND_SIM, .run = bind_surface_update},
    {"getWaiting", "How many tiles wait to be made anew.", NULL,
     BIND_RETURNS({"tiles", "integer", NULL}), SELF, BIND_RUNNING, .run = bind_surface_get_waiting},
    {"addLink", "Adds a way that leaves the surface: a jump, a ladder, a door. Returns its id.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(bind_add_link_args, options), "the link",
                .fields = link_fields}),
     BIND_RETURNS({"link", "integer", NULL}), sizeof(bind_add_link_args), BIND_SIM,
     .run = bind_surface_add_link},
    {"removeLink", "Removes a link.", BIND_ARGS(LINK(bind_key_args, key)), NULL,
     sizeof(bind_key_args), BIND_SIM, .run = bind_surface_remove_link},
    {"setLinkOpen", "Opens or closes a link.",
     BIND_ARGS(LINK(bind_open_args, link),
               {"open", BIND_BOOL, BIND_AT(bind_open_args, open), "may be walked"}),
     NULL, sizeof(bind_open_args), BIND_SIM, .run = bind_surface_set_link_open},
    {"getLink", "A link as a table {from, to, cost, bothWays, open, kind}.",
     BIND_ARGS(LINK(bind_key_args, key)), BIND_RETURNS({"link", "table", NULL}),
     sizeof(bind_key_args), BIND_RUNNING, .run = bind_surface_get_link},
    {"save", "Writes it to a file (.cnav), pieces and links included.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(save_args, path),
                "in the player's folder, where corsac.save writes"}),
     NULL, sizeof(save_args), BIND_SIM, .run = save},
    {"newPath", "The same as a Path.", ENDS, BIND_RETURNS({"path", "corsac.Path", NULL}),
     sizeof(way_args), BIND_SIM, .run = new_path},
    {"getArea", "Area on the ground plane.", NULL, BIND_RETURNS({"area", "number", "m^2"}), SELF,
     BIND_RUNNING, .run = get_area},
    {"getPolygonCount", "How many polygons it has.", NULL, BIND_RETURNS({"count", "integer", NULL}),
     SELF, BIND_RUNNING, .run = get_polygon_count},
    {"draw", "Draws its borders, seams and links for one frame.",
     BIND_ARGS({"search", BIND_BOOL, BIND_AT(bind_draw_args, search),
                "also what the last search across it looked at", .optional = true}),
     NULL, sizeof(bind_draw_args), BIND_UPDATE | BIND_DRAW, .run = draw},
    {"destroy", "Removes it; its paths and agents are left without a way.", NULL, NULL, SELF,
     BIND_SIM, .run = destroy},
    {0}};

const bind_type bind_surface_type = {"Surface", "Ground on which an agent can walk.", surface_alive,
                                     methods};
