// What the files of engine/nav share.
#ifndef NAV_NAV_INTERNAL_H
#define NAV_NAV_INTERNAL_H

#include "nav/nav.h"

// Paths planned anew in one step, where their ground has changed.
#define NAV_PLANS_A_STEP 256u

#define NAV_WORLD_COOKIE 0x4e41560au
#define NAV_GRAPH_COOKIE 0x4e41560bu
#define NAV_QUERY_COOKIE 0x4e41560cu
#define NAV_AGENT_COOKIE 0x4e41560du

// A node's links lie in one block of the link set, `links` of them in use, in order of creation.
#define NAV_NODE_COLUMNS(X)                                                                        \
    X(float, px, CORE_COLUMN_STATE)                                                                \
    X(float, py, CORE_COLUMN_STATE)                                                                \
    X(float, pz, CORE_COLUMN_STATE)                                                                \
    X(uint32_t, first, CORE_COLUMN_STATE)                                                          \
    X(uint32_t, links, CORE_COLUMN_STATE)                                                          \
    X(uint32_t, room, CORE_COLUMN_STATE) /* size of the block, 0 or a power of two */              \
    X(uint32_t, exists, CORE_COLUMN_STATE)                                                         \
    X(uint32_t, next, 0) /* in its cell of the grid for nav_graph_nearest */
CORE_COLUMNS_DECLARE(nav_nodes, NAV_NODE_COLUMNS)

#define NAV_LINK_COLUMNS(X)                                                                        \
    X(uint32_t, to, CORE_COLUMN_STATE)                                                             \
    X(float, cost, CORE_COLUMN_STATE)                                                              \
    X(uint32_t, open, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(nav_links, NAV_LINK_COLUMNS)

#define NAV_BLOCK_SIZES 17 // blocks of 1, 2, 4, ... 65536 links

typedef struct nav_graph_head {
    uint64_t version;
    double ratio[2]; // least cost / distance over the links there ever were, by heuristic
    uint32_t nodes;  // that exist
    uint32_t max_links;
    uint32_t free_block[NAV_BLOCK_SIZES]; // first link of a free block, + 1
    uint32_t unused;
} nav_graph_head;

typedef struct nav_cells { // uniform grid over x and z, hashed; follows from the nodes
    uint32_t *head;        // [size] first node of a bucket, + 1
    uint32_t size;         // power of two, 0: not built
    uint32_t planned_for;  // nodes it was sized for
    float cell;            // m
} nav_cells;

typedef struct nav_graph_data {
    char name[32];
    nav_nodes node;
    nav_links link;
    nav_cells cells;
} nav_graph_data;

#define NAV_GRAPH_COLUMNS(X)                                                                       \
    X(nav_graph_head, head, CORE_COLUMN_STATE)                                                     \
    X(nav_graph_data *, data, 0)
CORE_COLUMNS_DECLARE(nav_graphs, NAV_GRAPH_COLUMNS)

typedef struct nav_path_head {
    core_handle graph, mesh; // one of them
    core_handle flow;        // on a mesh: that leads to the goal, or null
    uint64_t version;        // of the graph when it was planned
    double cost;
    core_vec3 start, goal;
    uint32_t status, count, plans;
    uint32_t points_hash; // of the points below, which are no column
    uint32_t led;         // an agent walks it, and plans it from where it is
    uint32_t unused;
} nav_path_head;
typedef struct nav_path_points {
    core_vec3 *point;
    uint32_t *node; // of a graph; on a surface the link to the next point
    uint32_t capacity;
} nav_path_points;
#define NAV_PATH_COLUMNS(X)                                                                        \
    X(nav_path_head, head, CORE_COLUMN_STATE)                                                      \
    X(nav_path_points, points, 0)
CORE_COLUMNS_DECLARE(nav_paths, NAV_PATH_COLUMNS)

#define NAV_AGENT_COLUMNS(X)                                                                       \
    X(float, px, CORE_COLUMN_STATE)                                                                \
    X(float, py, CORE_COLUMN_STATE)                                                                \
    X(float, pz, CORE_COLUMN_STATE)                                                                \
    X(float, vx, CORE_COLUMN_STATE)                                                                \
    X(float, vy, CORE_COLUMN_STATE)                                                                \
    X(float, vz, CORE_COLUMN_STATE)                                                                \
    X(float, hx, CORE_COLUMN_STATE) /* heading, unit */                                            \
    X(float, hz, CORE_COLUMN_STATE)                                                                \
    X(float, radius, CORE_COLUMN_STATE)                                                            \
    X(float, max_speed, CORE_COLUMN_STATE)                                                         \
    X(float, acceleration, CORE_COLUMN_STATE)                                                      \
    X(float, turn_rate, CORE_COLUMN_STATE)                                                         \
    X(float, arrive, CORE_COLUMN_STATE)                                                            \
    X(float, gx, CORE_COLUMN_STATE) /* goal */                                                     \
    X(float, gy, CORE_COLUMN_STATE)                                                                \
    X(float, gz, CORE_COLUMN_STATE)                                                                \
    X(float, ax, CORE_COLUMN_STATE) /* where it was when it last made progress */                  \
    X(float, ay, CORE_COLUMN_STATE)                                                                \
    X(float, az, CORE_COLUMN_STATE)                                                                \
    X(float, beside, CORE_COLUMN_STATE)  /* s beside others that have arrived at its goal */       \
    X(float, stalled, CORE_COLUMN_STATE) /* s since then */                                        \
    X(uint32_t, state, CORE_COLUMN_STATE)                                                          \
    X(uint32_t, corner, CORE_COLUMN_STATE)  /* number of the path's node it walks to */            \
    X(uint32_t, corners, CORE_COLUMN_STATE) /* nodes of the path that it uses */                   \
    X(uint32_t, plans, CORE_COLUMN_STATE)   /* of the path when `corner` was set */                \
    X(uint32_t, driven, CORE_COLUMN_STATE)                                                         \
    X(uint64_t, user, CORE_COLUMN_STATE)                                                           \
    X(core_handle, path, CORE_COLUMN_STATE)                                                        \
    X(uint32_t, gate, CORE_COLUMN_STATE) /* that it may use, + 1 */                                \
    X(float, wx, 0)                      /* velocity wanted in this step */                        \
    X(float, wz, 0)                                                                                \
    X(float, slope, 0) /* height for ground covered */                                             \
    X(float, lift, 0)  /* m/s straight up */                                                       \
    X(float, nx, 0)    /* velocity after avoidance */                                              \
    X(float, nz, 0)
CORE_COLUMNS_DECLARE(nav_agents, NAV_AGENT_COLUMNS)

// Search scratch: one record a node, valid where `stamp` is the query's.
typedef struct nav_record {
    double g, h;
    uint32_t parent;
    uint32_t stamp;
    uint32_t place; // in the heap; NAV_NO_NODE when expanded
    uint32_t unused;
} nav_record;
typedef struct nav_heap_entry {
    double f;
    uint32_t node;
    uint32_t unused;
} nav_heap_entry;
typedef struct nav_scratch {
    nav_record *record; // [capacity]
    nav_heap_entry *heap;
    uint32_t capacity;
    uint32_t stamp; // of the last query; records are cleared when it wraps
} nav_scratch;

#define NAV_NEIGHBOURS 10u
// Agents sorted by cell for avoidance; rebuilt each step, grows with the number of agents.
typedef struct nav_crowd {
    void *block; // all arrays below
    float *px, *py, *pz, *vx, *vz, *radius;
    int32_t *cell_x, *cell_z;
    uint32_t *row;               // of the agent
    uint32_t *key;               // [row] its bucket
    uint32_t *near_count, *near; // [row], [row*10] neighbours in this step
    uint32_t *start;             // [buckets + 1]
    uint32_t capacity, buckets;
    uint32_t agents;       // rows from there on are obstacles
    float range, per_cell; // m within which neighbours count; cells per m
} nav_crowd;

// ---- uniform grids ----

// Padded by a blocked cell on every side: cell (x, y) is number (y + 1) * stride + x + 1.
typedef struct nav_grid_data {
    uint32_t width, height, stride;
    uint8_t *moves; // [cells] bit d: the step in direction d is allowed; 0 where blocked
    // Blocked cells as bits, by row and by column, both padded to whole words.
    uint64_t *row, *column;
    uint32_t row_words, column_words;
} nav_grid_data;
typedef struct nav_grid_head {
    uint64_t version; // counts changes, and `content` sums them up
    uint64_t content;
} nav_grid_head;
#define NAV_GRID_COLUMNS(X)                                                                        \
    X(nav_grid_head, head, CORE_COLUMN_STATE)                                                      \
    X(nav_grid_data *, data, 0)
CORE_COLUMNS_DECLARE(nav_grids, NAV_GRID_COLUMNS)

// Directions 0..7: +x, +x+y, +y, -x+y, -x, -x-y, -y, +x-y. Odd ones are diagonal.
#define NAV_STRAIGHT   408u
#define NAV_DIAGONAL   577u
#define NAV_DIRECTIONS 8
extern const int8_t nav_dir_x[NAV_DIRECTIONS], nav_dir_y[NAV_DIRECTIONS];

typedef struct nav_grid_record {
    uint32_t g;
    uint32_t next; // A*: in its bucket; jumps: place in the heap
    uint32_t back; // A*: before it in its bucket; jumps: the cell it was reached from
    uint32_t mark; // query number * 16 + direction it was reached in (8: none)
} nav_grid_record;

#define NAV_BUCKETS 2048u // f grows by at most 2 * NAV_DIAGONAL in one step
typedef struct nav_grid_scratch {
    nav_grid_record *record; // [capacity]
    uint64_t *heap;          // [capacity] f << 32 | cell
    uint32_t capacity;
    uint32_t query;                    // < 2^28
    uint32_t bucket[NAV_BUCKETS];      // first cell, 0: empty (cell 0 is padding)
    uint64_t filled[NAV_BUCKETS / 64]; // bit: the bucket is not empty
} nav_grid_scratch;

typedef struct nav_grid_search_args {
    const nav_grid_data *g;
    nav_grid_scratch *s;
    uint32_t start, goal;    // cell numbers
    uint32_t goal_x, goal_y; // padded
    uint32_t expanded;
} nav_grid_search_args;
// Both leave records from which nav_grid.c reads the path; true when the goal was reached.
bool nav_grid_astar(nav_grid_search_args *q);
bool nav_grid_jump(nav_grid_search_args *q);

static inline uint32_t nav_grid_octile(uint32_t x, uint32_t y, uint32_t gx, uint32_t gy) {
    uint32_t dx = x > gx ? x - gx : gx - x, dy = y > gy ? y - gy : gy - y;
    uint32_t longer = CORE_MAX(dx, dy), shorter = CORE_MIN(dx, dy);
    return NAV_STRAIGHT * longer + (NAV_DIAGONAL - NAV_STRAIGHT) * shorter;
}

// ---- walkable surfaces ----
#include "nav/nav_surface.h"

struct nav_world {
    core_jobs *jobs;
    core_metrics *metrics;
    nav_graphs graph;
    nav_paths path;
    nav_agents agent;
    nav_grids grid;
    nav_meshes mesh;
    nav_flows flow;
    nav_view_scratch views;
    nav_buffer encounters; // of agents with gates
    nav_way way;
    nav_coarse_scratch coarse;
    nav_builder *builder; // made with the first surface
    nav_scratch scratch;
    nav_crowd crowd;
    nav_grid_scratch *grid_scratch; // made with the first grid
    nav_heuristic heuristic;        // of paths
    uint32_t plans_left;            // in this step
    uint32_t slice_budget;          // views expanded in a step; 0: searches end at once
    uint32_t next_slice;            // path
    nav_slice slice;
    uint32_t next_path, next_agent; // whose turn it is
    float weight;
    bool no_avoidance, no_bodies;
    nav_buffer obstacles; // nav_obstacle
    uint32_t obstacle_count;
};

// Row of a live graph, CORE_NO_ROW + core_fail for others.
uint32_t nav_graph_row(const nav_world *world, nav_graph graph);
// nav_nearest.c
void nav_cells_add(nav_graph_data *g, uint32_t node);
void nav_cells_remove(nav_graph_data *g, uint32_t node);
void nav_cells_release(nav_cells *cells);
// nav_search.c
void nav_scratch_fit(nav_scratch *scratch, uint32_t nodes);
void nav_scratch_release(nav_scratch *scratch);
double nav_octile(double dx, double dy, double dz);
// nav_grid.c
void nav_grid_scratch_release(nav_world *world);
// nav_path.c
// Plans a path on a live graph or mesh (the other null), in the place of `old` when that lives.
nav_path nav_path_renew(nav_world *world, nav_path old, nav_path_head head);
bool nav_path_outdated(const nav_world *world, uint32_t row); // its ground has changed
void nav_path_check(nav_world *world, uint32_t row);          // invalid when its ground is gone
void nav_paths_refresh(nav_world *world); // plans those whose ground has changed, but agents'
void nav_path_plan_now(nav_world *world, uint32_t row);
// A search in pieces has ended (NULL: there is no way).
void nav_path_found(nav_world *world, uint32_t row, const nav_any_angle *search,
                    const nav_ends *ends);
// nav_slice.c
void nav_slices_step(nav_world *world);
// nav_gate.c
void nav_gates_step(nav_world *world, float radius, float dt); // may change wanted velocities
// nav_avoid.c
void nav_crowd_avoid(nav_world *world, float dt); // wanted velocities to safe ones
void nav_crowd_part(nav_world *world);            // moves apart who overlaps
void nav_crowd_release(nav_crowd *crowd);
// nav_agent.c
void nav_agents_step(nav_world *world, float dt);
void nav_agent_keep_on_surface(nav_world *world, uint32_t row);
uint32_t nav_agent_row_link(const nav_world *world, uint32_t row);

#endif
