// Navigation: waypoint graphs and uniform grids, searches on them, paths that follow changes, and
// agents that walk. SI units: metres, seconds, radians; +Y up, agents turn about +Y. The same
// build, graph and calls give the same bits: ties go to the smaller id, costs are sums in double.
//
// No function allocates once graphs, paths and agents have reached their size.
#ifndef NAV_NAV_H
#define NAV_NAV_H

#include "core/columns.h"
#include "core/data.h"
#include "core/jobs.h"
#include "core/math.h"
#include "core/metrics.h"
#include "core/stream.h"

#define NAV_NO_NODE      UINT32_MAX
#define NAV_REPORT_LINKS 8u // the cap on neighbours of the report's graph (4.2), as a mode
#define NAV_MAX_LINKS    65535u

typedef struct nav_world nav_world;
typedef core_handle nav_graph;
typedef core_handle nav_grid;
typedef core_handle nav_path;
typedef core_handle nav_agent;

typedef struct nav_world_desc {
    core_jobs *jobs;       // NULL: serial. Borrowed
    core_metrics *metrics; // NULL: unmeasured. Borrowed
    uint32_t max_agents;   // default 1 << 16 (address space only)
    uint32_t cookie;
} nav_world_desc;
nav_world_desc nav_world_desc_default(void);
nav_world *nav_world_create(const nav_world_desc *desc); // NULL + core_fail
void nav_world_destroy(nav_world *world);
// Plans paths whose graph changed, then moves agents by dt seconds, finite, > 0, <= 1.
bool nav_world_step(nav_world *world, float dt);
// Settings: "heuristic" (euclid, octile, zero), "weight" (1..10), "avoidance" (orca, none),
// "bodies" (on, off: whether a scene makes moving bodies obstacles), "slice" (views that paths
// across surfaces may expand in a step, all together; 0: at once).
bool nav_world_set(nav_world *world, const char *name, const char *value);
// NULL-terminated names of a method kind: "heuristic", "grid", "avoidance".
const char *const *nav_method_names(const char *kind);
int nav_world_state(const nav_world *world, const core_columns **out, int capacity);
// The worst length of a live path over that of the shortest way between its ends, for at most
// `most` paths spread evenly (0: all); 0 where there is none. Those with links do not count.
double nav_world_path_ratio_max(nav_world *world, uint32_t most);
// Fields of a saved scene (core/stream.h); what points elsewhere is checked. Surfaces and grids
// are not in it: the world must hold those of the one that was saved.
// When it returns false nothing of what was there is left.
bool nav_world_stream(nav_world *w, core_stream *s);
size_t nav_world_bytes(const nav_world *world);
void nav_world_counts(const nav_world *world, core_metrics *metrics); // nav_nodes, agents, paths

// ---- graphs ----
// A node's id is its number in order of creation; it stays the same for the graph's life and is
// never given again. Links are directed, ordered by creation, and cost at least 0.
typedef struct nav_graph_desc {
    const char *name;   // for print and errors; cut to 31 bytes
    uint32_t max_nodes; // default 1 << 20 (address space only)
    uint32_t max_links; // links of one node: default NAV_MAX_LINKS; NAV_REPORT_LINKS as the report
    uint32_t cookie;
} nav_graph_desc;
nav_graph_desc nav_graph_desc_default(void);
nav_graph nav_graph_create(nav_world *world, const nav_graph_desc *desc); // null + core_fail
// Paths of the graph are left without one (NAV_INVALID).
bool nav_graph_destroy(nav_world *world, nav_graph graph);
bool nav_graph_alive(const nav_world *world, nav_graph graph);

// NAV_NO_NODE + core_fail for positions that are not finite and full graphs.
uint32_t nav_graph_add_node(nav_world *world, nav_graph graph, core_vec3 position);
// Removes the node with all links to and from it; its id becomes invalid. Visits every link.
bool nav_graph_remove_node(nav_world *world, nav_graph graph, uint32_t node);
bool nav_graph_move_node(nav_world *world, nav_graph graph, uint32_t node, core_vec3 position);
// Links a and b both ways at the cost of their distance. All or nothing: false + core_fail when
// either is no node, a = b, one is linked to the other already, or has no room (max_links).
bool nav_graph_connect(nav_world *world, nav_graph graph, uint32_t a, uint32_t b);
// Removes the links between a and b in both directions; false + core_fail when there was none.
bool nav_graph_disconnect(nav_world *world, nav_graph graph, uint32_t a, uint32_t b);
// One way, cost finite and >= 0. A cost below the distance is allowed (a lift, a portal): searches
// then weaken their heuristic for the whole graph, so that results stay optimal.
bool nav_graph_link(nav_world *world, nav_graph graph, uint32_t from, uint32_t to, float cost);
bool nav_graph_unlink(nav_world *world, nav_graph graph, uint32_t from, uint32_t to);
bool nav_graph_set_cost(nav_world *world, nav_graph graph, uint32_t from, uint32_t to, float cost);
// A closed link (a door) stays in its place but is not walked.
bool nav_graph_set_open(nav_world *world, nav_graph graph, uint32_t from, uint32_t to, bool open);

typedef struct nav_link {
    uint32_t to;
    float cost;
    bool open;
} nav_link;
uint32_t nav_graph_node_count(const nav_world *world, nav_graph graph); // that exist now
uint32_t nav_graph_id_end(const nav_world *world, nav_graph graph);     // ids are below this
bool nav_graph_node_exists(const nav_world *world, nav_graph graph, uint32_t node);
bool nav_graph_position(const nav_world *world, nav_graph graph, uint32_t node, core_vec3 *out);
uint32_t nav_graph_link_count(const nav_world *world, nav_graph graph, uint32_t node);
// Link number n of a node in order of creation; false + core_fail when there is none.
bool nav_graph_link_at(const nav_world *world, nav_graph graph, uint32_t node, uint32_t n,
                       nav_link *out);
// Node nearest to a point (Euclidean; the smaller id when equal), within max_distance (0: any).
// NAV_NO_NODE when there is none, without an error.
uint32_t nav_graph_nearest(const nav_world *world, nav_graph graph, core_vec3 point,
                           float max_distance);
// Changes with every change of the graph; paths compare it.
uint64_t nav_graph_version(const nav_world *world, nav_graph graph);
// Name, nodes, positions, links and costs as text, one node a line. Returns the bytes the whole
// text takes without its terminating zero, as snprintf does.
size_t nav_graph_print(const nav_world *world, nav_graph graph, char *out, size_t size);

// ---- search ----
typedef enum nav_status {
    NAV_INVALID, // a bad description, or the graph is gone
    NAV_FOUND,
    NAV_PARTIAL, // no way to the goal: the path leads to the reachable node nearest to it
    NAV_NO_PATH,
    NAV_LIMIT,  // max_expansions were not enough; a partial path if asked for
    NAV_PENDING // a path whose search goes on (setting "slice"); it has the points it had
} nav_status;
const char *nav_status_name(nav_status status);

typedef enum nav_heuristic { NAV_EUCLID, NAV_OCTILE, NAV_ZERO } nav_heuristic;

typedef struct nav_query {
    nav_graph graph;
    uint32_t start, goal;
    nav_heuristic heuristic;
    float weight;            // >= 1; 0: 1. The cost is at most weight times the optimum
    bool partial;            // give a way to the nearest reachable node when there is no way
    uint32_t max_expansions; // 0: no limit
    uint32_t cookie;
} nav_query;
nav_query nav_query_default(void); // with the world's "euclid" and weight 1

typedef struct nav_result {
    nav_status status;
    double cost;    // of the path found
    uint32_t count; // nodes of the path, start and end included
    uint32_t expanded;
    uint32_t reached; // its last node
} nav_result;

// A* (Hart, Nilsson, Raphael, "A formal basis for the heuristic determination of minimum cost
// paths", IEEE TSSC 4, 1968) with an indexed 4-ary heap, no recursion. Writes the first `capacity`
// nodes of the path into out (may be NULL). False + core_fail only for bad queries (NAV_INVALID).
// One query at a time in a world.
bool nav_graph_search(nav_world *world, const nav_query *query, nav_result *result, uint32_t *out,
                      uint32_t capacity);

// Nodes of the path that the last search gave, the first `capacity` of result->count: for callers
// who want to know the length first. Valid until the next search or step.
void nav_last_path(const nav_world *world, const nav_result *result, uint32_t *out,
                   uint32_t capacity);

// ---- uniform grids ----
// Cells of one size on the ground plane, each free or blocked; moves to the eight neighbours, a
// diagonal one only where both cells beside it are free. Steps cost 1 and sqrt(2) cell sizes. Costs
// are compared as whole numbers 408 and 577, whose ratio is sqrt(2) to 1.5e-6: a path is longer
// than the shortest by at most that share.
#define NAV_GRID_MOST 8192u // cells along a side

typedef struct nav_grid_desc {
    uint32_t width, height; // cells, 1..NAV_GRID_MOST
    const uint8_t *blocked; // [width*height] row after row, 0 free; NULL: all free
    uint32_t cookie;
} nav_grid_desc;
nav_grid_desc nav_grid_desc_default(void);
nav_grid nav_grid_create(nav_world *world, const nav_grid_desc *desc); // null + core_fail
bool nav_grid_destroy(nav_world *world, nav_grid grid);
bool nav_grid_alive(const nav_world *world, nav_grid grid);
bool nav_grid_size(const nav_world *world, nav_grid grid, uint32_t *width, uint32_t *height);
bool nav_grid_set_blocked(nav_world *world, nav_grid grid, uint32_t x, uint32_t y, bool blocked);
bool nav_grid_blocked(const nav_world *world, nav_grid grid, uint32_t x,
                      uint32_t y); // outside: yes

typedef struct nav_cell {
    uint32_t x, y;
} nav_cell;
typedef enum nav_grid_method {
    NAV_GRID_JUMP, // jump point search; the default, far faster but on random scatter
    NAV_GRID_ASTAR // A* with a bucket queue, the baseline
} nav_grid_method;

// Shortest path from cell to cell. Writes the first `capacity` cells of it, every step of the way,
// into out (may be NULL). result->cost is in cell sizes; result->reached is y*width + x of the last
// cell. False + core_fail for cells outside. A blocked start or goal is NAV_NO_PATH.
//
// A*: buckets after Dial, "Algorithm 360", CACM 12 (1969), one for each value of f. Jump points:
// Harabor and Grastien, "Improving jump point search", ICAPS 2014: scans of 64 cells at a time (B)
// without queueing diagonal turning points (P), for the rule that forbids to cut corners.
bool nav_grid_search(nav_world *world, nav_grid grid, nav_grid_method method, nav_cell start,
                     nav_cell goal, nav_result *result, nav_cell *out, uint32_t capacity);

// ---- walkable surfaces ----
// The ground an upright agent can stand on, cut into axis-aligned rectangles of cells; several
// storeys may lie above one another. Searches give the shortest way for the middle of the agent,
// measured on the ground plane, straight across the surface from corner to corner.
typedef core_handle nav_mesh;
#define NAV_AREAS       32u  // kinds of ground; area[] of a soup, 0 where it has none
#define NAV_AREA_CLOSED 255u // nobody walks there

typedef struct nav_mesh_desc {
    float cell_size;    // m, default 0.3: the surface is this exact sideways, and exact in height
    float agent_radius; // m, default 0.3: kept clear of walls and ledges, rounded up to cells
    float agent_height; // m, default 1.8: headroom
    float max_climb;    // m, default 0.4: the highest step
    float max_slope;    // rad from level, default 0.79 (45 degrees); 0..1.5
    // m; 0: none. Instead of cell_size: all level ground further than agent_radius + max_error from
    // walls and ledges belongs to the surface; nothing nearer than agent_radius to walls does, nor
    // nearer by more than a cell to ledges.
    float max_error;
    // Side of a tile in cells, 8..1024; 0: one tile, that no later change can renew. A change makes
    // only its tiles anew; they cost searches over wide ground some time (docs/navigation.md).
    uint32_t tile_cells;
    // With tiles: what the surface may ever cover (height does not count); equal: the soup's
    // bounds.
    core_aabb bounds;
    uint32_t tiles_per_step; // made anew in a step at most, default 4
    uint32_t cookie;
} nav_mesh_desc;
nav_mesh_desc nav_mesh_desc_default(void);
// From a triangle soup (copied, counter-clockwise seen from above is up). Null + core_fail for bad
// descriptions, vertices that are not finite, indices out of range, and more than 2^26 cells.
// Degenerate triangles are left out. A soup without walkable ground gives an empty mesh. The inside
// of closed shapes is solid; ground without a lower side is a sheet.
nav_mesh nav_mesh_build(nav_world *world, const core_soup_data *soup, const nav_mesh_desc *desc);
// ---- changes of a surface with tiles ----
// It is made from pieces: triangles under a key. nav_mesh_build's soup is piece 0. A change is seen
// at once by nav_mesh_update, else nav_world_step makes tiles_per_step tiles anew in each step:
// which ones does not depend on time or threads, and when none waits the surface has the same bits
// as one that was built in a single go. Paths are planned anew.

// Puts triangles in the place of those under `key`; NULL or none: removes them. False + core_fail
// for surfaces without tiles and soups that nav_mesh_build would refuse.
bool nav_mesh_put(nav_world *world, nav_mesh mesh, uint64_t key, const core_soup_data *soup);
// Ground inside a box gets an area (0..NAV_AREAS-1, NAV_AREA_CLOSED: nobody walks there); where
// marks overlap, that of the largest key. NULL: removes the mark. Keys are those of pieces, too.
bool nav_mesh_mark(nav_world *world, nav_mesh mesh, uint64_t key, const core_aabb *box,
                   uint8_t area);
bool nav_mesh_update(nav_world *world, nav_mesh mesh);            // all that waits, now
uint32_t nav_mesh_waiting(const nav_world *world, nav_mesh mesh); // tiles to be made anew
// Of the spans, their heights, areas and links: equal for equal surfaces.
uint64_t nav_mesh_hash(const nav_world *world, nav_mesh mesh);

// The surface with its pieces and links as bytes (".cnav"), after all that waits has been made. As
// snprintf: returns how many bytes it takes, writes them when they fit; 0 + core_fail.
size_t nav_mesh_save(nav_world *world, nav_mesh mesh, void *out, size_t size);
// Checks everything: truncated, oversized or corrupt data gives a null handle and core_fail.
nav_mesh nav_mesh_load(nav_world *world, const void *data, size_t size);

// From free cells of a flat map: cell (x, y) covers [x, x+1] by [y, y+1] times cell_size on the
// ground plane (x, z). blocked[width*height], 0 free.
nav_mesh nav_mesh_from_cells(nav_world *world, uint32_t width, uint32_t height,
                             const uint8_t *blocked, float cell_size);
bool nav_mesh_destroy(nav_world *world, nav_mesh mesh);
bool nav_mesh_alive(const nav_world *world, nav_mesh mesh);
uint32_t nav_mesh_polygons(const nav_world *world, nav_mesh mesh);
double nav_mesh_area(const nav_world *world, nav_mesh mesh); // m^2 on the ground plane
// Point of the surface nearest to p sideways, at most max_distance away, on the storey nearest in
// height. False when there is none.
bool nav_mesh_nearest(const nav_world *world, nav_mesh mesh, core_vec3 p, float max_distance,
                      core_vec3 *out);

// ---- links that leave the surface: jumps, ladders, doors ----
#define NAV_NO_LINK UINT32_MAX
typedef enum nav_link_kind { NAV_LINK_JUMP, NAV_LINK_LADDER, NAV_LINK_DOOR } nav_link_kind;
typedef struct nav_mesh_link_desc {
    core_vec3 start, end; // walked while each is at most two cells from the surface
    float cost;           // as so many metres of plain ground; 0: its length
    bool both_ways;       // else from start to end
    bool closed;
    nav_link_kind kind; // for whoever moves the agent
    uint64_t user;      // the owner's, kept as it is
    uint32_t cookie;
} nav_mesh_link_desc;
nav_mesh_link_desc nav_mesh_link_desc_default(void);
// A link's id is never given again. NAV_NO_LINK + core_fail for positions that are not finite and
// costs below 0.
uint32_t nav_mesh_add_link(nav_world *world, nav_mesh mesh, const nav_mesh_link_desc *desc);
bool nav_mesh_remove_link(nav_world *world, nav_mesh mesh, uint32_t link);
bool nav_mesh_set_link_open(nav_world *world, nav_mesh mesh, uint32_t link, bool open);
bool nav_mesh_get_link(const nav_world *world, nav_mesh mesh, uint32_t link,
                       nav_mesh_link_desc *out);
uint32_t nav_mesh_link_end(const nav_world *world, nav_mesh mesh); // ids are below this

// ---- ways across a surface ----
// Ends are taken to the surface when they are at most two cells off it. Without links and costs the
// way is the shortest there is: Cui, Harabor, Grastien, "Compromise-free pathfinding on a
// navigation mesh" (Polyanya), IJCAI 2017. With links, points on the borders of polygons choose
// them (after Lanthier, Maheshwari, Sack, "Approximating weighted shortest paths on polyhedral
// surfaces", SoCG 1997) and the ways between them are again the shortest; where areas differ in
// cost, its crossings of borders are moved to their best places.
typedef struct nav_mesh_query {
    nav_mesh mesh;
    core_vec3 start, goal;
    // [NAV_AREAS] of a metre, finite and > 0; 0: 1; INFINITY: not walked. NULL: 1 everywhere
    const float *area_cost;
    bool partial; // else to the reachable point nearest to the goal (NAV_PARTIAL)
    uint32_t cookie;
} nav_mesh_query;
nav_mesh_query nav_mesh_query_default(void);
// Writes the first `capacity` of result->count points: start, bends, goal; link[i] is the link that
// leads from point i to the next, NAV_NO_LINK: the ground does. Both may be NULL. result->cost is
// the length on the ground plane in m times the cost of areas, and that of links.
bool nav_mesh_find_way(nav_world *world, const nav_mesh_query *query, nav_result *result,
                       core_vec3 *point, uint32_t *link, uint32_t capacity);
// The first `capacity` points and links of the last way across a surface: for callers who want to
// know the length first. Valid until the next search or step.
void nav_mesh_last_way(const nav_world *world, core_vec3 *point, uint32_t *link, uint32_t capacity);
// With the default query.
bool nav_mesh_search(nav_world *world, nav_mesh mesh, core_vec3 start, core_vec3 goal,
                     nav_result *result, core_vec3 *out, uint32_t capacity);

// ---- many ways to one goal ----
// A flow knows the shortest way to its goal from everywhere (without links and area costs): one
// flood of the surface, then a way costs as little as its bends. It keeps up with the surface.
typedef core_handle nav_flow;
nav_flow nav_flow_create(nav_world *world, nav_mesh mesh, core_vec3 goal); // null + core_fail
bool nav_flow_destroy(nav_world *world, nav_flow flow);
bool nav_flow_alive(const nav_world *world, nav_flow flow);
// As nav_mesh_search from a point to the flow's goal.
bool nav_flow_way(nav_world *world, nav_flow flow, core_vec3 from, nav_result *result,
                  core_vec3 *point, uint32_t capacity);
// Status and length of the ways from count points to one goal.
bool nav_mesh_search_many(nav_world *world, nav_mesh mesh, const core_vec3 *start, uint32_t count,
                          core_vec3 goal, nav_result *result);

// ---- paths ----
// A way between two points by way of the nodes nearest to them. nav_world_step plans it anew when
// its graph has changed; nav_path_update does so at once.
nav_path nav_path_create(nav_world *world, nav_graph graph, core_vec3 start, core_vec3 goal);
// The same across a walkable surface, its bends half a cell off the corners.
nav_path nav_path_create_on_mesh(nav_world *world, nav_mesh mesh, core_vec3 start, core_vec3 goal);
bool nav_path_destroy(nav_world *world, nav_path path);
bool nav_path_alive(const nav_world *world, nav_path path);
bool nav_path_set(nav_world *world, nav_path path, core_vec3 start, core_vec3 goal);
nav_status nav_path_update(nav_world *world, nav_path path);
nav_status nav_path_status(const nav_world *world, nav_path path);
double nav_path_cost(const nav_world *world, nav_path path); // of its links; length in m
// Points of the way: positions of the graph's nodes, or start, corners and goal on a surface.
uint32_t nav_path_count(const nav_world *world, nav_path path);
bool nav_path_point(const nav_world *world, nav_path path, uint32_t i, core_vec3 *out);
uint32_t nav_path_node(const nav_world *world, nav_path path, uint32_t i); // NAV_NO_NODE: none
// On a surface: the link from point i to the next, NAV_NO_LINK: none.
uint32_t nav_path_link(const nav_world *world, nav_path path, uint32_t i);
// Times it has been planned: changes when the nodes may have.
uint32_t nav_path_plans(const nav_world *world, nav_path path);

// ---- debug drawing: lines for whoever draws them ----
typedef enum nav_line_kind {
    NAV_LINE_WALL,     // border of a surface
    NAV_LINE_SEAM,     // border between its polygons
    NAV_LINE_LINK,     // of a graph, or one that leaves a surface
    NAV_LINE_SHUT,     // the same, closed
    NAV_LINE_PATH,     // of an agent, or a path alone
    NAV_LINE_SEARCHED, // what the last search looked at: tree of nodes, views over edges
    NAV_LINE_AGENT,    // its circle
    NAV_LINE_VELOCITY,
    NAV_LINE_WISH // velocity wanted before avoidance
} nav_line_kind;
typedef void nav_line_fn(void *ctx, nav_line_kind kind, core_vec3 a, core_vec3 b);
bool nav_mesh_lines(const nav_world *world, nav_mesh mesh, nav_line_fn *fn, void *ctx);
bool nav_graph_lines(const nav_world *world, nav_graph graph, nav_line_fn *fn, void *ctx);
void nav_path_lines(const nav_world *world, nav_line_fn *fn, void *ctx); // all paths
void nav_agent_lines(const nav_world *world, nav_line_fn *fn, void *ctx);
// Of the last search across this surface, or on this graph.
bool nav_mesh_search_lines(const nav_world *world, nav_mesh mesh, nav_line_fn *fn, void *ctx);
bool nav_graph_search_lines(const nav_world *world, nav_graph graph, nav_line_fn *fn, void *ctx);

// ---- agents ----
typedef enum nav_agent_state {
    NAV_AGENT_IDLE,
    NAV_AGENT_WALKING,
    // At its goal, or beside somebody who has arrived at the same one and it comes no further.
    // Makes room for others and comes back.
    NAV_AGENT_ARRIVED,
    // No way, or no progress for two seconds. It tries on: a change of the graph or room to move
    // makes it walk again.
    NAV_AGENT_STUCK
} nav_agent_state;
const char *nav_agent_state_name(nav_agent_state state);

typedef struct nav_agent_desc {
    core_vec3 position;
    float radius;       // m, default 0.3
    float max_speed;    // m/s, default 1.5
    float acceleration; // m/s^2, also braking; default 8
    float turn_rate;    // rad/s; 0: turns at once
    float arrive;       // m from the goal, default 0.1
    float heading;      // rad about +Y, 0 looks along -Z
    // Its position is written by its owner (a body) before each step; the agent gives a velocity.
    bool driven;
    uint64_t user; // the owner's, kept as it is
    uint32_t cookie;
} nav_agent_desc;
nav_agent_desc nav_agent_desc_default(void);
nav_agent nav_agent_create(nav_world *world, const nav_agent_desc *desc);
bool nav_agent_destroy(nav_world *world, nav_agent agent);
bool nav_agent_alive(const nav_world *world, nav_agent agent);
// Walks on a graph to a point: to the node nearest to it, then straight to it.
bool nav_agent_go(nav_world *world, nav_agent agent, nav_graph graph, core_vec3 goal);
// Walks across a surface to the point of it nearest to `goal`.
bool nav_agent_go_on_mesh(nav_world *world, nav_agent agent, nav_mesh mesh, core_vec3 goal);
// Walks with a flow to its goal.
bool nav_agent_go_with_flow(nav_world *world, nav_agent agent, nav_flow flow);
bool nav_agent_stop(nav_world *world, nav_agent agent);
nav_agent_state nav_agent_status(const nav_world *world, nav_agent agent);
bool nav_agent_position(const nav_world *world, nav_agent agent, core_vec3 *out);
bool nav_agent_set_position(nav_world *world, nav_agent agent, core_vec3 position);
bool nav_agent_velocity(const nav_world *world, nav_agent agent, core_vec3 *out);
bool nav_agent_heading(const nav_world *world, nav_agent agent, float *out);
bool nav_agent_set_max_speed(nav_world *world, nav_agent agent, float speed);
// The link (of the surface of its path) on which it is now, NAV_NO_LINK on the ground.
uint32_t nav_agent_link(const nav_world *world, nav_agent agent);
// What agents go round beside each other: upright cylinders that move (bodies, the player). Copied,
// kept until the next call. False + core_fail for numbers that are not finite and radii <= 0.
typedef struct nav_obstacle {
    core_vec3 position; // middle of its lower end
    core_vec3 velocity; // m/s
    float radius;       // m
} nav_obstacle;
bool nav_world_set_obstacles(nav_world *world, const nav_obstacle *obstacle, uint32_t count);
bool nav_world_minds_bodies(const nav_world *world); // setting "bodies": for who sets obstacles
// Its path, null when it never went anywhere.
nav_path nav_agent_path(const nav_world *world, nav_agent agent);
uint32_t nav_agent_count(const nav_world *world);
nav_agent nav_agent_at(const nav_world *world, uint32_t row); // row < nav_agent_count
uint64_t nav_agent_user(const nav_world *world, nav_agent agent);
bool nav_agent_set_user(nav_world *world, nav_agent agent, uint64_t user);
bool nav_agent_set_driven(nav_world *world, nav_agent agent, bool driven);

#endif
