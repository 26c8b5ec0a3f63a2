// Grids and flows of corsac.nav. Cells are counted from 1.
#include "script/bind_grid.h"

#include "script/internal.h"

static nav_world *world_of(script *s) { return scene_nav(s->scene); }

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

static bool grid_alive(script *s, core_handle h) {
    nav_world *w = scene_nav_if(s->scene);
    return w && nav_grid_alive(w, h);
}
static bool flow_alive(script *s, core_handle h) {
    nav_world *w = scene_nav_if(s->scene);
    return w && nav_flow_alive(w, h);
}

// ---- grids ----

int bind_grid_new(script *s, lua_State *L, void *args) {
    const bind_grid_args *a = args;
    nav_grid_desc desc = nav_grid_desc_default();
    desc.width = (uint32_t)a->width, desc.height = (uint32_t)a->height;
    nav_grid grid = nav_grid_create(world_of(s), &desc);
    if (core_handle_is_null(grid)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_grid_type, grid);
    return 1;
}

typedef struct cell_args {
    core_handle self;
    int64_t x, y;
    bool blocked;
} cell_args;
static int set_blocked(script *s, lua_State *L, void *args) {
    const cell_args *a = args;
    return done(L, nav_grid_set_blocked(world_of(s), a->self, (uint32_t)a->x - 1,
                                        (uint32_t)a->y - 1, a->blocked));
}
static int is_blocked(script *s, lua_State *L, void *args) {
    const cell_args *a = args;
    lua_pushboolean(L,
                    nav_grid_blocked(world_of(s), a->self, (uint32_t)a->x - 1, (uint32_t)a->y - 1));
    return 1;
}
static int get_size(script *s, lua_State *L, void *args) {
    uint32_t width = 0, height = 0;
    nav_grid_size(world_of(s), *(core_handle *)args, &width, &height);
    lua_pushnumber(L, width);
    lua_pushnumber(L, height);
    return 2;
}

typedef struct way_options {
    int method;
} way_options;
typedef struct way_args {
    core_handle self;
    int64_t x0, y0, x1, y1;
    way_options options;
} way_args;

static void push_cells(lua_State *L, const nav_cell *cell, uint32_t count) {
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        lua_createtable(L, 2, 0);
        lua_pushnumber(L, cell[i].x + 1);
        lua_rawseti(L, -2, 1);
        lua_pushnumber(L, cell[i].y + 1);
        lua_rawseti(L, -2, 2);
        lua_rawseti(L, -2, (int)i + 1);
    }
}

static int find_path(script *s, lua_State *L, void *args) {
    const way_args *a = args;
    nav_world *w = world_of(s);
    nav_cell start = {(uint32_t)a->x0 - 1, (uint32_t)a->y0 - 1};
    nav_cell goal = {(uint32_t)a->x1 - 1, (uint32_t)a->y1 - 1};
    nav_grid_method method = (nav_grid_method)a->options.method;
    nav_result result;
    done(L, nav_grid_search(w, a->self, method, start, goal, &result, NULL, 0));
    if (result.count == 0) {
        lua_pushnil(L);
    } else {
        nav_cell *cell = lua_newuserdata(L, result.count * sizeof *cell);
        nav_grid_search(w, a->self, method, start, goal, &result, cell, result.count);
        push_cells(L, cell, result.count);
    }
    lua_pushnumber(L, result.cost);
    return 2;
}
static int grid_destroy(script *s, lua_State *L, void *args) {
    return done(L, nav_grid_destroy(world_of(s), *(core_handle *)args));
}

// ---- flows ----

int bind_flow_new(script *s, lua_State *L, void *args) {
    const bind_flow_args *a = args;
    nav_flow flow = nav_flow_create(world_of(s), a->surface, a->goal);
    if (core_handle_is_null(flow)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_flow_type, flow);
    return 1;
}

typedef struct from_args {
    core_handle self;
    core_vec3 from;
} from_args;
static int flow_find_path(script *s, lua_State *L, void *args) {
    const from_args *a = args;
    nav_result result;
    done(L, nav_flow_way(world_of(s), a->self, a->from, &result, NULL, 0));
    if (result.count == 0) {
        lua_pushnil(L);
    } else {
        core_vec3 *point = lua_newuserdata(L, result.count * sizeof *point);
        nav_mesh_last_way(world_of(s), point, NULL, result.count);
        lua_createtable(L, (int)result.count, 0);
        for (uint32_t i = 0; i < result.count; i++) {
            bind_push_point(L, point[i]);
            lua_rawseti(L, -2, (int)i + 1);
        }
    }
    lua_pushnumber(L, result.cost);
    return 2;
}
static int flow_destroy(script *s, lua_State *L, void *args) {
    return done(L, nav_flow_destroy(world_of(s), *(core_handle *)args));
}

// ---- declarations ----

#define SELF sizeof(core_handle)
#define CELL(type, member, about)                                                                  \
    { #member, BIND_INT, BIND_AT(type, member), about, NULL, BIND_BETWEEN, 1, NAV_GRID_MOST }

static const bind_arg method_fields[] = {{"method", BIND_ENUM, BIND_AT(way_options, method),
                                          "jump point search, or A*", .optional = true,
                                          .def = NAV_GRID_JUMP, .values = "jump|astar"},
                                         {0}};

static const bind_fn grid_methods[] = {
    {"setBlocked", "Blocks or frees a cell.",
     BIND_ARGS(CELL(cell_args, x, "column"), CELL(cell_args, y, "row"),
               {"blocked", BIND_BOOL, BIND_AT(cell_args, blocked), "nobody steps there"}),
     NULL, sizeof(cell_args), BIND_SIM, .run = set_blocked},
    {"isBlocked", "Whether a cell is blocked; cells outside are.",
     BIND_ARGS(CELL(cell_args, x, "column"), CELL(cell_args, y, "row")),
     BIND_RETURNS({"blocked", "boolean", NULL}), sizeof(cell_args), BIND_RUNNING,
     .run = is_blocked},
    {"getSize", "How many cells it has along both sides.", NULL,
     BIND_RETURNS({"width", "integer", NULL}, {"height", "integer", NULL}), SELF, BIND_RUNNING,
     .run = get_size},
    {"findPath",
     "Shortest way in steps to the eight neighbours: cells {x, y} (nil without one) and its length "
     "in cells. No corners are cut.",
     BIND_ARGS(CELL(way_args, x0, "column of the start"), CELL(way_args, y0, "its row"),
               CELL(way_args, x1, "column of the goal"), CELL(way_args, y1, "its row"),
               {"options", BIND_OPTIONS, BIND_AT(way_args, options), "how to search",
                .optional = true, .fields = method_fields}),
     BIND_RETURNS({"cells", "integer[][]?", NULL}, {"length", "number", NULL}), sizeof(way_args),
     BIND_SIM, .run = find_path},
    {"destroy", "Removes it.", NULL, NULL, SELF, BIND_SIM, .run = grid_destroy},
    {0}};

static const bind_fn flow_methods[] = {
    {"findPath", "The way from a point: points {x, y, z} (nil without one) and its length.",
     BIND_ARGS({"from", BIND_VEC3, BIND_AT(from_args, from), "where it begins", "m"}),
     BIND_RETURNS({"points", "number[][]?", NULL}, {"length", "number", "m"}), sizeof(from_args),
     BIND_SIM, .run = flow_find_path},
    {"destroy", "Removes it; agents that walk with it search for themselves.", NULL, NULL, SELF,
     BIND_SIM, .run = flow_destroy},
    {0}};

const bind_type bind_grid_type = {"Grid", "Cells on which one steps.", grid_alive, grid_methods};
const bind_type bind_flow_type = {"Flow", "Ways to one goal from everywhere.", flow_alive,
                                  flow_methods};
