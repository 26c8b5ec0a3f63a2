// corsac.nav: waypoint graphs and paths; who walks is an Agent (bind_agent.c).
#include "script/bind_body.h"
#include "script/bind_grid.h"
#include "script/bind_surface.h"
#include "script/internal.h"

static nav_world *world_of(script *s) { return scene_nav(s->scene); }

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

static bool graph_alive(script *s, core_handle h) {
    nav_world *w = scene_nav_if(s->scene);
    return w && nav_graph_alive(w, h);
}
static bool path_alive(script *s, core_handle h) {
    nav_world *w = scene_nav_if(s->scene);
    return w && nav_path_alive(w, h);
}

// ---- making things ----

typedef struct graph_options {
    const char *name;
    int64_t max_links;
} graph_options;
typedef struct graph_call {
    graph_options options;
} graph_call;
static int new_graph(script *s, lua_State *L, void *args) {
    const graph_options *o = &((graph_call *)args)->options;
    nav_graph_desc desc = nav_graph_desc_default();
    desc.name = o->name;
    desc.max_links = (uint32_t)o->max_links;
    nav_graph graph = nav_graph_create(world_of(s), &desc);
    if (core_handle_is_null(graph)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_graph_type, graph);
    return 1;
}

typedef struct path_args {
    core_handle graph;
    core_vec3 start, goal;
} path_args;
static int new_path(script *s, lua_State *L, void *args) {
    const path_args *a = args;
    nav_path path = nav_path_create(world_of(s), a->graph, a->start, a->goal);
    if (core_handle_is_null(path)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_path_type, path);
    return 1;
}

// ---- graphs ----

typedef struct point_args {
    core_handle self;
    float x, y, z, limit;
} point_args;
typedef struct node_args {
    core_handle self;
    int64_t node;
} node_args;
typedef struct move_args {
    core_handle self;
    int64_t node;
    float x, y, z;
} move_args;
typedef struct pair_args {
    core_handle self;
    int64_t a, b;
} pair_args;
typedef struct cost_args {
    core_handle self;
    int64_t a, b;
    float cost;
} cost_args;
typedef struct open_args {
    core_handle self;
    int64_t a, b;
    bool open;
} open_args;

static int graph_add(script *s, lua_State *L, void *args) {
    const point_args *a = args;
    uint32_t node = nav_graph_add_node(world_of(s), a->self, core_v3(a->x, a->y, a->z));
    if (node == NAV_NO_NODE) {
        bind_fail(L);
    }
    lua_pushnumber(L, node);
    return 1;
}
static int graph_remove(script *s, lua_State *L, void *args) {
    const node_args *a = args;
    return done(L, nav_graph_remove_node(world_of(s), a->self, (uint32_t)a->node));
}
static int graph_move(script *s, lua_State *L, void *args) {
    const move_args *a = args;
    return done(
        L, nav_graph_move_node(world_of(s), a->self, (uint32_t)a->node, core_v3(a->x, a->y, a->z)));
}
static int graph_connect(script *s, lua_State *L, void *args) {
    const pair_args *a = args;
    return done(L, nav_graph_connect(world_of(s), a->self, (uint32_t)a->a, (uint32_t)a->b));
}
static int graph_disconnect(script *s, lua_State *L, void *args) {
    const pair_args *a = args;
    return done(L, nav_graph_disconnect(world_of(s), a->self, (uint32_t)a->a, (uint32_t)a->b));
}
static int graph_link(script *s, lua_State *L, void *args) {
    const cost_args *a = args;
    return done(L, nav_graph_link(world_of(s), a->self, (uint32_t)a->a, (uint32_t)a->b, a->cost));
}
static int graph_unlink(script *s, lua_State *L, void *args) {
    const pair_args *a = args;
    return done(L, nav_graph_unlink(world_of(s), a->self, (uint32_t)a->a, (uint32_t)a->b));
}
static int graph_set_cost(script *s, lua_State *L, void *args) {
    const cost_args *a = args;
    return done(L,
                nav_graph_set_cost(world_of(s), a->self, (uint32_t)a->a, (uint32_t)a->b, a->cost));
}
static int graph_set_open(script *s, lua_State *L, void *args) {
    const open_args *a = args;
    return done(L,
                nav_graph_set_open(world_of(s), a->self, (uint32_t)a->a, (uint32_t)a->b, a->open));
}
static int graph_nearest(script *s, lua_State *L, void *args) {
    const point_args *a = args;
    uint32_t node = nav_graph_nearest(world_of(s), a->self, core_v3(a->x, a->y, a->z), a->limit);
    if (node == NAV_NO_NODE) {
        lua_pushnil(L);
    } else {
        lua_pushnumber(L, node);
    }
    return 1;
}
static int graph_get_position(script *s, lua_State *L, void *args) {
    const node_args *a = args;
    core_vec3 p = {0, 0, 0};
    done(L, nav_graph_position(world_of(s), a->self, (uint32_t)a->node, &p));
    bind_push_vec3(L, p);
    return 3;
}
static int graph_get_count(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, nav_graph_node_count(world_of(s), *(core_handle *)args));
    return 1;
}
static int graph_get_nodes(script *s, lua_State *L, void *args) {
    core_handle self = *(core_handle *)args;
    lua_createtable(L, (int)nav_graph_node_count(world_of(s), self), 0);
    int n = 0;
    for (uint32_t node = 0; node < nav_graph_id_end(world_of(s), self); node++) {
        if (nav_graph_node_exists(world_of(s), self, node)) {
            lua_pushnumber(L, node);
            lua_rawseti(L, -2, ++n);
        }
    }
    return 1;
}
static int graph_get_links(script *s, lua_State *L, void *args) {
    const node_args *a = args;
    uint32_t node = (uint32_t)a->node;
    core_vec3 p;
    done(L, nav_graph_position(world_of(s), a->self, node, &p)); // the node exists
    uint32_t count = nav_graph_link_count(world_of(s), a->self, node);
    lua_createtable(L, (int)count, 0);
    for (uint32_t n = 0; n < count; n++) {
        nav_link link = {0};
        nav_graph_link_at(world_of(s), a->self, node, n, &link);
        lua_createtable(L, 0, 3);
        lua_pushnumber(L, link.to);
        lua_setfield(L, -2, "to");
        lua_pushnumber(L, (double)link.cost);
        lua_setfield(L, -2, "cost");
        lua_pushboolean(L, link.open);
        lua_setfield(L, -2, "open");
        lua_rawseti(L, -2, (int)n + 1);
    }
    return 1;
}
static int graph_get_text(script *s, lua_State *L, void *args) {
    core_handle self = *(core_handle *)args;
    size_t size = nav_graph_print(world_of(s), self, NULL, 0) + 1;
    char *text = lua_newuserdata(L, size);
    nav_graph_print(world_of(s), self, text, size);
    lua_pushstring(L, text);
    return 1;
}
static int graph_destroy(script *s, lua_State *L, void *args) {
    return done(L, nav_graph_destroy(world_of(s), *(core_handle *)args));
}

static int graph_draw(script *s, lua_State *L, void *args) {
    (void)L;
    const bind_draw_args *a = args;
    scene_draw_graph(s->scene, a->self, a->search);
    return 0;
}
static int draw_agents(script *s, lua_State *L, void *args) {
    (void)L, (void)args;
    scene_draw_agents(s->scene);
    return 0;
}

typedef struct search_options {
    int heuristic;
    float weight;
    bool partial;
    int64_t limit;
} search_options;
typedef struct search_args {
    core_handle self;
    int64_t start, goal;
    search_options options;
} search_args;
static int graph_find_path(script *s, lua_State *L, void *args) {
    const search_args *a = args;
    nav_query query = nav_query_default();
    query.graph = a->self;
    query.start = (uint32_t)a->start, query.goal = (uint32_t)a->goal;
    query.heuristic = (nav_heuristic)a->options.heuristic;
    query.weight = a->options.weight;
    query.partial = a->options.partial;
    query.max_expansions = (uint32_t)a->options.limit;
    nav_result result;
    done(L, nav_graph_search(world_of(s), &query, &result, NULL, 0));
    if (result.count == 0) {
        lua_pushnil(L);
    } else {
        uint32_t *nodes = lua_newuserdata(L, result.count * sizeof *nodes);
        nav_last_path(world_of(s), &result, nodes, result.count);
        lua_createtable(L, (int)result.count, 0);
        for (uint32_t i = 0; i < result.count; i++) {
            lua_pushnumber(L, nodes[i]);
            lua_rawseti(L, -2, (int)i + 1);
        }
    }
    lua_pushnumber(L, result.cost);
    lua_pushstring(L, nav_status_name(result.status));
    return 3;
}

// ---- paths ----

typedef struct path_set_args {
    core_handle self;
    core_vec3 start, goal;
} path_set_args;
static int path_set(script *s, lua_State *L, void *args) {
    const path_set_args *a = args;
    return done(L, nav_path_set(world_of(s), a->self, a->start, a->goal));
}
static int path_update(script *s, lua_State *L, void *args) {
    lua_pushstring(L, nav_status_name(nav_path_update(world_of(s), *(core_handle *)args)));
    return 1;
}
static int path_get_status(script *s, lua_State *L, void *args) {
    lua_pushstring(L, nav_status_name(nav_path_status(world_of(s), *(core_handle *)args)));
    return 1;
}
static int path_get_cost(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, nav_path_cost(world_of(s), *(core_handle *)args));
    return 1;
}
static int path_get_nodes(script *s, lua_State *L, void *args) {
    core_handle self = *(core_handle *)args;
    uint32_t count = nav_path_count(world_of(s), self);
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        lua_pushnumber(L, nav_path_node(world_of(s), self, i));
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}
static int path_get_points(script *s, lua_State *L, void *args) {
    core_handle self = *(core_handle *)args;
    uint32_t count = nav_path_count(world_of(s), self);
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        core_vec3 p = {0, 0, 0};
        nav_path_point(world_of(s), self, i, &p);
        bind_push_point(L, p);
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}
static int path_destroy(script *s, lua_State *L, void *args) {
    return done(L, nav_path_destroy(world_of(s), *(core_handle *)args));
}

// ---- declarations ----

#define SELF    sizeof(core_handle)
#define MOST_ID 4294967294.0
#define NODE(type, member, about)                                                                  \
    { #member, BIND_INT, BIND_AT(type, member), about, NULL, BIND_BETWEEN, 0, MOST_ID }
#define POINT(type)                                                                                \
    {"x", BIND_FLOAT, BIND_AT(type, x), "", "m"}, {"y", BIND_FLOAT, BIND_AT(type, y), "", "m"}, {  \
        "z", BIND_FLOAT, BIND_AT(type, z), "", "m"                                                 \
    }
#define BOTH(type)    NODE(type, a, "a node"), NODE(type, b, "another")
#define ONE_WAY(type) NODE(type, a, "from this node"), NODE(type, b, "to this")
#define HEURISTICS    "euclid|octile|zero"
#define VEC3(type, member, about)                                                                  \
    { #member, BIND_VEC3, BIND_AT(type, member), about, "m" }

static const bind_arg search_fields[] = {
    {"heuristic", BIND_ENUM, BIND_AT(search_options, heuristic), "of A*; zero is Dijkstra's way",
     .optional = true, .def = NAV_EUCLID, .values = HEURISTICS},
    {"weight", BIND_FLOAT, BIND_AT(search_options, weight),
     "how many times the least cost the path may cost", NULL, BIND_BETWEEN, 1, 1000,
     .optional = true, .def = 1},
    {"partial", BIND_BOOL, BIND_AT(search_options, partial),
     "without a way: go to the node nearest to the goal", .optional = true},
    {"limit", BIND_INT, BIND_AT(search_options, limit), "nodes to expand at most; 0: any number",
     NULL, BIND_BETWEEN, 0, MOST_ID, .optional = true},
    {0}};

static const bind_fn graph_methods[] = {
    {"add", "Adds a node; its id is the number of nodes made before it.",
     BIND_ARGS(POINT(point_args)), BIND_RETURNS({"id", "integer", NULL}), sizeof(point_args),
     BIND_SIM, .run = graph_add},
    {"remove", "Removes a node and all its links.", BIND_ARGS(NODE(node_args, node, "which")), NULL,
     sizeof(node_args), BIND_SIM, .run = graph_remove},
    {"move", "Moves a node; its links keep their costs.",
     BIND_ARGS(NODE(move_args, node, "which"), POINT(move_args)), NULL, sizeof(move_args), BIND_SIM,
     .run = graph_move},
    {"connect", "Links two nodes both ways at the cost of their distance.",
     BIND_ARGS(BOTH(pair_args)), NULL, sizeof(pair_args), BIND_SIM, .run = graph_connect},
    {"disconnect", "Removes the links between two nodes.", BIND_ARGS(BOTH(pair_args)), NULL,
     sizeof(pair_args), BIND_SIM, .run = graph_disconnect},
    {"link", "Links one way.",
     BIND_ARGS(ONE_WAY(cost_args), {"cost", BIND_FLOAT, BIND_AT(cost_args, cost), "of the way",
                                    NULL, BIND_NOT_NEGATIVE}),
     NULL, sizeof(cost_args), BIND_SIM, .run = graph_link},
    {"unlink", "Removes a link one way.", BIND_ARGS(ONE_WAY(pair_args)), NULL, sizeof(pair_args),
     BIND_SIM, .run = graph_unlink},
    {"setCost", "Sets what a link costs.",
     BIND_ARGS(ONE_WAY(cost_args), {"cost", BIND_FLOAT, BIND_AT(cost_args, cost), "of the way",
                                    NULL, BIND_NOT_NEGATIVE}),
     NULL, sizeof(cost_args), BIND_SIM, .run = graph_set_cost},
    {"setOpen", "Opens or closes a link, as a door.",
     BIND_ARGS(ONE_WAY(open_args), {"open", BIND_BOOL, BIND_AT(open_args, open), "may be walked"}),
     NULL, sizeof(open_args), BIND_SIM, .run = graph_set_open},
    {"nearest", "Id of the node nearest to a point, nil when there is none.",
     BIND_ARGS(POINT(point_args),
               {"limit", BIND_FLOAT, BIND_AT(point_args, limit), "largest distance; 0: any", "m",
                BIND_NOT_NEGATIVE, .optional = true}),
     BIND_RETURNS({"id", "integer?", NULL}), sizeof(point_args), BIND_RUNNING,
     .run = graph_nearest},
    {"getPosition", "Where a node is.", BIND_ARGS(NODE(node_args, node, "which")),
     BIND_RETURNS({"x", "number", "m"}, {"y", "number", "m"}, {"z", "number", "m"}),
     sizeof(node_args), BIND_RUNNING, .run = graph_get_position},
    {"getCount", "How many nodes it has.", NULL, BIND_RETURNS({"count", "integer", NULL}), SELF,
     BIND_RUNNING, .run = graph_get_count},
    {"getNodes", "Ids of its nodes, ascending.", NULL, BIND_RETURNS({"ids", "integer[]", NULL}),
     SELF, BIND_RUNNING, .run = graph_get_nodes},
    {"getLinks", "Links of a node in order of creation: tables {to, cost, open}.",
     BIND_ARGS(NODE(node_args, node, "which")), BIND_RETURNS({"links", "table[]", NULL}),
     sizeof(node_args), BIND_RUNNING, .run = graph_get_links},
    {"getText", "Nodes, positions, links and costs as text, one node a line.", NULL,
     BIND_RETURNS({"text", "string", NULL}), SELF, BIND_RUNNING, .run = graph_get_text},
    {"findPath", "Cheapest way: ids of its nodes (nil without one), its cost, and the status.",
     BIND_ARGS(NODE(search_args, start, "from this node"), NODE(search_args, goal, "to this"),
               {"options", BIND_OPTIONS, BIND_AT(search_args, options), "how to search",
                .optional = true, .fields = search_fields}),
     BIND_RETURNS({"ids", "integer[]?", NULL}, {"cost", "number", NULL},
                  {"status", "string", NULL}),
     sizeof(search_args), BIND_SIM, .run = graph_find_path},
    {"draw", "Draws its links for one frame.",
     BIND_ARGS({"search", BIND_BOOL, BIND_AT(bind_draw_args, search),
                "also what the last search on it reached", .optional = true}),
     NULL, sizeof(bind_draw_args), BIND_UPDATE | BIND_DRAW, .run = graph_draw},
    {"destroy", "Removes it; its paths and agents are left without a way.", NULL, NULL, SELF,
     BIND_SIM, .run = graph_destroy},
    {0}};

static const bind_fn path_methods[] = {
    {"set", "Gives it another start and goal and plans it.",
     BIND_ARGS(VEC3(path_set_args, start, "where it begins"),
               VEC3(path_set_args, goal, "where it ends")),
     NULL, sizeof(path_set_args), BIND_SIM, .run = path_set},
    {"update", "Plans it now; a step does so when the graph has changed.", NULL,
     BIND_RETURNS({"status", "string", NULL}), SELF, BIND_SIM, .run = path_update},
    {"getStatus", "\"found\", \"partial\", \"no path\" or \"invalid\" (its graph is gone).", NULL,
     BIND_RETURNS({"status", "string", NULL}), SELF, BIND_RUNNING, .run = path_get_status},
    {"getCost", "Sum of its links' costs.", NULL, BIND_RETURNS({"cost", "number", NULL}), SELF,
     BIND_RUNNING, .run = path_get_cost},
    {"getNodes", "Ids of its nodes from start to goal.", NULL,
     BIND_RETURNS({"ids", "integer[]", NULL}), SELF, BIND_RUNNING, .run = path_get_nodes},
    {"getPoints", "Points of the way from start to goal: tables {x, y, z}.", NULL,
     BIND_RETURNS({"points", "number[][]", NULL}), SELF, BIND_RUNNING, .run = path_get_points},
    {"destroy", "Removes it.", NULL, NULL, SELF, BIND_SIM, .run = path_destroy},
    {0}};

const bind_type bind_graph_type = {"Graph", "Waypoints and the links between them.", graph_alive,
                                   graph_methods};
const bind_type bind_path_type = {"Path", "A way between two points that follows its graph.",
                                  path_alive, path_methods};
const bind_type bind_agent_type = {"Agent", "Walks along paths.", bind_agent_alive,
                                   bind_agent_methods};

static const bind_arg graph_fields[] = {
    {"name", BIND_STRING, BIND_AT(graph_options, name), "for its text and errors", .optional = true,
     .def_text = "graph"},
    {"maxLinks", BIND_INT, BIND_AT(graph_options, max_links), "links one node may have", NULL,
     BIND_BETWEEN, 1, NAV_MAX_LINKS, .optional = true, .def = NAV_MAX_LINKS},
    {0}};

static const bind_fn functions[] = {
    {"newGraph", "Makes an empty waypoint graph.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(graph_call, options), "the graph",
                .optional = true, .fields = graph_fields}),
     BIND_RETURNS({"graph", "corsac.Graph", NULL}), sizeof(graph_call), BIND_SIM, .run = new_graph},
    {"newPath", "Plans a way between two points by way of the nodes nearest to them.",
     BIND_ARGS(
         {"graph", BIND_OBJECT, BIND_AT(path_args, graph), "on which", .type = &bind_graph_type},
         VEC3(path_args, start, "where it begins"), VEC3(path_args, goal, "where it ends")),
     BIND_RETURNS({"path", "corsac.Path", NULL}), sizeof(path_args), BIND_SIM, .run = new_path},
    {"newAgent", "Makes an agent; with an entity, it leads that entity or its body.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(bind_agent_call, options), "the agent",
                .fields = bind_agent_fields}),
     BIND_RETURNS({"agent", "corsac.Agent", NULL}), sizeof(bind_agent_call), BIND_SIM,
     .run = bind_agent_new},
    {"newSurface",
     "Finds the ground on which an agent can stand and step, from triangles and boxes.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(bind_surface_call, options), "world and agent",
                .fields = bind_surface_fields}),
     BIND_RETURNS({"surface", "corsac.Surface", NULL}), sizeof(bind_surface_call), BIND_SIM,
     .run = bind_surface_new},
    {"newGrid", "Makes a grid of cells, for searches that step from cell to cell.",
     BIND_ARGS({"width", BIND_INT, BIND_AT(bind_grid_args, width), "cells", NULL, BIND_BETWEEN, 1,
                NAV_GRID_MOST},
               {"height", BIND_INT, BIND_AT(bind_grid_args, height), "cells", NULL, BIND_BETWEEN, 1,
                NAV_GRID_MOST}),
     BIND_RETURNS({"grid", "corsac.Grid", NULL}), sizeof(bind_grid_args), BIND_SIM,
     .run = bind_grid_new},
    {"newFlow", "Finds the shortest ways from everywhere on a surface to one goal.",
     BIND_ARGS({"surface", BIND_OBJECT, BIND_AT(bind_flow_args, surface), "on which",
                .type = &bind_surface_type},
               {"goal", BIND_VEC3, BIND_AT(bind_flow_args, goal), "where they end", "m"}),
     BIND_RETURNS({"flow", "corsac.Flow", NULL}), sizeof(bind_flow_args), BIND_SIM,
     .run = bind_flow_new},
    {"drawAgents", "Draws agents, their velocities and wishes, and all paths for one frame.", NULL,
     NULL, 0, BIND_UPDATE | BIND_DRAW, .run = draw_agents},
    {"loadSurface", "Reads a surface that Surface:save wrote.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(bind_load_call, path),
                "a .cnav file of the scene or of the player's folder"}),
     BIND_RETURNS({"surface", "corsac.Surface", NULL}), sizeof(bind_load_call), BIND_SIM,
     .run = bind_surface_load},
    {0}};

static const bind_module modules[] = {
    {"corsac.nav", "Waypoint graphs, walkable surfaces, paths and agents.", functions}, {0}};
static const bind_type *const types[] = {&bind_graph_type,
                                         &bind_path_type,
                                         &bind_agent_type,
                                         &bind_surface_type,
                                         &bind_grid_type,
                                         &bind_flow_type,
                                         NULL};

const bind_room bind_nav_room = {"nav", modules, types};
