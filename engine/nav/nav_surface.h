// Walkable surfaces from inside. A surface is cut into square tiles; spans (places to stand),
// polygons (rectangles of spans), edges and turning points of a tile lie in one block each of the
// surface's arrays, so that a search runs over plain arrays and a tile can be made anew alone.
#ifndef NAV_NAV_SURFACE_H
#define NAV_NAV_SURFACE_H

#include "nav/nav.h"

#define NAV_NONE UINT32_MAX

// ---- blocks of a growing array ----
typedef struct nav_block {
    uint32_t first, count, room;
} nav_block;
typedef struct nav_blocks {
    nav_block *free; // [free_count]
    uint32_t free_count, free_room;
    uint32_t end;   // of the array
    uint32_t count; // items in use
} nav_blocks;
// Gives the block room for `count` items, which need not stay where they were. `spare`: for
// arrays whose blocks will change.
void nav_block_fit(nav_blocks *blocks, nav_block *block, uint32_t count, bool spare);
void nav_blocks_release(nav_blocks *blocks);

typedef struct nav_buffer { // grows, is used again
    void *data;
    size_t bytes;
} nav_buffer;
void *nav_buffer_fit(nav_buffer *buffer, size_t bytes); // contents stay

// ---- what a surface is made from ----
typedef struct nav_triangle {
    core_vec3 corner[3];
    uint8_t area;
} nav_triangle;
typedef struct nav_tiles {   // a range of tiles
    uint32_t x0, z0, x1, z1; // last ones included
} nav_tiles;
// Triangles, or a box that marks an area; with the tiles it reaches, margins included.
typedef struct nav_piece {
    uint64_t key;
    uint32_t count;
    nav_buffer triangles; // nav_triangle [count]
    nav_buffer first;     // uint32_t [tiles reached + 1] into `item`
    nav_buffer item;      // uint32_t, numbers of triangles, ascending in each tile
    core_aabb box;        // of a mark
    bool mark;
    uint8_t area;
    nav_tiles reach;
} nav_piece;

// ---- the surface ----

// A corner of an edge in cells. An edge runs from its corner to the next one's, counter-clockwise
// with x to the right and z up.
typedef struct nav_edge {
    int32_t x, z;
    uint32_t beyond; // polygon on its other side, NAV_NONE: wall
    uint32_t turn;   // number of the turning point here, NAV_NONE: no shortest way bends here
} nav_edge;

typedef struct nav_rectangle {
    uint32_t span;          // at its corner towards -x, -z
    uint32_t across, along; // cells along x and z
} nav_rectangle;

// Places to stand: one for each cell and storey, by tile; in a tile in order of cell (z, then x),
// then height.
typedef struct nav_spans {
    nav_blocks blocks;
    uint32_t *first; // [width*depth] first span of a cell
    uint16_t *stack; // [width*depth] how many
    uint32_t *x, *z; // cell
    float *y;        // m
    uint8_t *area;
    uint32_t (*link)[4]; // neighbour towards +x, +z, -x, -z; NAV_NONE
    uint32_t *polygon;
    uint32_t room;
} nav_spans;

typedef struct nav_range { // of numbers, `end` is one beyond the last
    uint32_t first, end;
} nav_range;
typedef struct nav_polygons {
    nav_blocks blocks;
    nav_rectangle *shape;
    nav_range *edges;
    uint32_t *component; // of polygons joined by edges; valid while `components` is the version
    uint32_t room;
} nav_polygons;

typedef struct nav_tile {
    nav_block span, polygon, edge, turn;
    uint64_t hash; // of its spans
    bool dirty;    // a change waits for it to be made anew
    bool fresh;    // made anew in this round
    bool edges;    // its edges must be
} nav_tile;

// Narrow places (nav_gate.c).
typedef struct nav_gate {
    float entry_x, entry_z;          // where its users came in
    float axis_x, axis_z;            // unit, out of it there
    float since;                     // s since they began
    uint32_t users, waiting, waited; // waiting: those from other sides; waited: in the last step
    bool ever;
} nav_gate;
typedef struct nav_gates {
    uint64_t version; // of the surface, + 1
    float radius;
    uint32_t count;
    nav_buffer of_span, gates, length, stack;
} nav_gates;

typedef struct nav_mesh_link {
    nav_mesh_link_desc desc;
    bool exists;
} nav_mesh_link;

typedef struct nav_mesh_data {
    nav_mesh_desc desc;
    core_vec3 origin;
    float cell_size;
    uint32_t width, depth; // cells
    uint32_t tile_cells, tiles_x, tiles_z;
    nav_tile *tile;
    uint32_t dirty;    // tiles
    uint32_t next;     // tile to look at first when the next are made
    nav_piece **piece; // ascending key
    uint32_t piece_count, piece_room;
    nav_piece *spare;
    nav_spans span;
    nav_polygons polygon;
    nav_blocks edge_blocks, turn_blocks;
    nav_edge *edge;
    uint32_t *edge_owner; // polygon
    uint32_t edge_room;
    float *turn_y;        // m
    uint8_t *turn_closed; // d: the closed cell there lies between directions d and d + 1
    uint32_t turn_room;
    nav_gates gates;
    uint64_t components; // version + 1 for which they were found
    nav_buffer component_queue;
    nav_mesh_link *link; // [links]
    uint32_t links, link_room;
} nav_mesh_data;

// Records of the coarse search: points on edges, ends of links, the goal.
#define NAV_SAMPLES 5u // on an edge: its ends and between
typedef struct nav_coarse_record {
    double g;
    uint32_t parent, stamp;
    uint32_t done, unused;
} nav_coarse_record;
typedef struct nav_coarse_scratch {
    nav_coarse_record *record; // [capacity]
    nav_buffer heap;           // nav_heap_entry
    uint32_t capacity, open, stamp;
    nav_buffer links; // those that are open, by direction
    nav_buffer way;   // nav_waypoint, from start to goal
    uint32_t count;
} nav_coarse_scratch;

typedef struct nav_mesh_head {
    uint64_t content; // hash of spans and links, whatever the order in which tiles were made
    uint64_t version; // grows with every change
} nav_mesh_head;
#define NAV_MESH_COLUMNS(X)                                                                        \
    X(nav_mesh_head, head, CORE_COLUMN_STATE)                                                      \
    X(nav_mesh_data *, data, 0)
CORE_COLUMNS_DECLARE(nav_meshes, NAV_MESH_COLUMNS)

// ---- from pieces to spans ----

typedef struct nav_window { // of cells: a tile and its margin
    uint32_t x, z, width, depth;
} nav_window;
typedef struct nav_solid {
    float low, high; // m
    float stand;     // height of the top over the middle of the cell, m
    bool walkable;   // its top is level enough
    uint8_t area;
} nav_solid;
// A window as columns of solid intervals.
typedef struct nav_field {
    nav_window window;
    float cell_size;  // m
    core_vec3 origin; // of cell (0, 0) of the surface
    float least_normal_y;
    uint32_t fragments;
    uint32_t piece;  // to which triangles belong
    uint32_t *first; // [cells + 1] first interval of a column, lowest first
    nav_solid *solid;
    nav_buffer fragment, sorted, start, first_buffer, solid_buffer;
} nav_field;
void nav_field_begin(nav_field *field, const nav_mesh_data *mesh, nav_window window);
// False + core_fail when there are too many fragments.
bool nav_field_add(nav_field *field, const nav_triangle *triangle);
void nav_field_finish(nav_field *field);
void nav_field_release(nav_field *field);

// The places to stand in a window, on their way into a surface.
typedef struct nav_crossing { // the neighbour of a span lies in another tile
    uint32_t span;            // number in the tile
    uint32_t direction;
    float y; // of the neighbour
} nav_crossing;
typedef struct nav_draft {
    nav_window window, core; // the core is the tile
    uint32_t count, kept;
    uint32_t *cell;  // [cells + 1] first span
    uint32_t *x, *z; // of the window
    float *y, *ceiling;
    uint8_t *area, *drop;
    uint32_t (*link)[4];
    uint32_t *number; // in the tile, NAV_NONE: not kept
    uint32_t crossings;
    nav_crossing *crossing;
    bool good;
    nav_buffer cells, spans, crossing_buffer;
} nav_draft;
// Scratch for one thread.
typedef struct nav_tile_scratch {
    nav_field field;
    nav_buffer queue, seen;
    uint32_t flood;
} nav_tile_scratch;
void nav_draft_make(nav_draft *draft, const nav_mesh_data *mesh, uint32_t tile,
                    nav_tile_scratch *scratch);
// Writes the spans that are kept to the tile's block.
void nav_draft_write(nav_draft *draft, nav_mesh_data *mesh, uint32_t tile);
void nav_draft_release(nav_draft *draft);

typedef struct nav_edge_scratch {
    nav_buffer shape, edge, key, table;
} nav_edge_scratch;
#define NAV_TILES_AT_ONCE 16u
typedef struct nav_builder {
    nav_draft draft[NAV_TILES_AT_ONCE];
    nav_tile_scratch *scratch; // [threads]
    uint32_t threads;
    nav_edge_scratch edges;
} nav_builder;
void nav_builder_release(nav_world *world);

// ---- what the files do for each other ----

nav_mesh_data *nav_mesh_find(const nav_world *world, nav_mesh mesh, uint32_t *row); // or NULL
void nav_mesh_free(nav_mesh_data *mesh);
nav_mesh nav_mesh_adopt(nav_world *world, nav_mesh_data *mesh);
size_t nav_mesh_bytes(const nav_mesh_data *mesh);
bool nav_mesh_check_desc(nav_mesh_desc *desc); // puts in defaults; false + core_fail
void nav_mesh_append_link(nav_mesh_data *mesh, const nav_mesh_link_desc *desc, bool exists);
// Lays out a surface with these bounds. False + core_fail.
bool nav_mesh_measure(nav_mesh_data *mesh, core_aabb bounds);
static inline uint32_t nav_mesh_tile_of(const nav_mesh_data *m, uint32_t x, uint32_t z) {
    return z / m->tile_cells * m->tiles_x + x / m->tile_cells;
}
// Arrays for `cells`, tiles and no spans. desc, cell_size, width, depth and tile_cells are set.
void nav_mesh_lay_out(nav_mesh_data *mesh);
// Gives a tile room for so many spans; the links of others to what it had are cut.
void nav_mesh_take_spans(nav_mesh_data *mesh, uint32_t tile, uint32_t count);
// nav_rectangles.c: rectangles of fresh tiles, then edges and turning points of tiles whose `edges`
// is set.
void nav_mesh_cut_rectangles(nav_mesh_data *mesh, uint32_t tile, nav_edge_scratch *scratch);
void nav_mesh_find_edges(nav_mesh_data *mesh, uint32_t tile, nav_edge_scratch *scratch);
// nav_pieces.c
// Cells around a tile that decide what is kept in it.
uint32_t nav_mesh_margin(const nav_mesh_data *mesh);
// Copies the soup into a piece. False + core_fail for vertices and indices that are no good.
bool nav_piece_set(nav_piece *piece, const nav_mesh_data *mesh, const core_soup_data *soup);
bool nav_pieces_fill(const nav_mesh_data *mesh, uint32_t tile, nav_field *field);
void nav_piece_sort(nav_piece *piece, const nav_mesh_data *mesh); // its triangles or box are set
bool nav_soup_vertex_good(const core_soup_data *soup, uint32_t vertex); // or core_fail
void nav_piece_free(nav_piece *piece);
void nav_mesh_drop_pieces(nav_mesh_data *mesh);
nav_piece *nav_mesh_add_piece(nav_mesh_data *mesh, uint64_t key); // that with the key, or new
// nav_tiles.c
// Makes up to `most` of the tiles that wait anew (0: all).
bool nav_mesh_renew(nav_world *world, uint32_t row, uint32_t most); // false: too many fragments
// The spans of fresh tiles are in place: finds rectangles, edges, content, version.
void nav_mesh_settle(nav_world *world, uint32_t row);
void nav_mesh_dirty(nav_mesh_data *mesh, nav_tiles range);

// ---- searches ----

// Moves a point to the surface when it is at most two cells off. False when there is none so near.
bool nav_mesh_hold(const nav_world *world, nav_mesh mesh, core_vec3 *point);

// Distances from a point to the surface's border towards +x, +z, -x, -z, m; FLT_MAX where it is
// further than `range` or the point is off the surface.
void nav_mesh_room(const nav_world *world, nav_mesh mesh, core_vec3 point, float range,
                   float out[4]);

typedef struct nav_point { // on the ground plane, in cells
    double x, z;
} nav_point;
typedef struct nav_place {
    uint32_t span; // NAV_NONE: none
    nav_point at;  // in cells, within the span's cell
    double square; // of the distance moved sideways, cells
    double height; // moved up or down, m
} nav_place;
// The place nearest to p, at most `reach` cells away.
nav_place nav_mesh_locate(const nav_mesh_data *mesh, core_vec3 p, double reach);
core_vec3 nav_mesh_world_point(const nav_mesh_data *mesh, nav_point p, float y);

// A ray's view: from `root` through the interval left..right of an edge into a polygon.
typedef struct nav_view {
    nav_point root, left, right;
    double g, f; // cost to the root; estimate of the whole
    uint32_t root_turn, left_turn, right_turn;
    uint32_t polygon, entered; // edge of the polygon that the interval lies on
    uint32_t parent;
} nav_view;
typedef struct nav_view_scratch {
    nav_view *view; // [capacity]
    uint32_t *heap; // [capacity] numbers of views
    uint32_t capacity, count, open;
    double *best; // [turns] least cost to a turning point, valid where stamp is the query's
    uint32_t *stamp;
    uint32_t turns, query;
} nav_view_scratch;
// Views from which the way can be read, last first; NAV_NONE when there is no way.
uint32_t nav_mesh_any_angle(const nav_mesh_data *mesh, nav_view_scratch *scratch, nav_point start,
                            uint32_t start_polygon, nav_point goal, uint32_t goal_polygon,
                            uint32_t *expanded);
typedef struct nav_ends {
    nav_place start, goal;
    core_vec3 wanted; // the goal asked for
} nav_ends;
// The same in pieces.
typedef struct nav_any_angle {
    const nav_mesh_data *mesh;
    nav_view_scratch *scratch;
    nav_point goal;
    uint32_t goal_polygon, expanded;
    uint32_t last; // view, when it is found
} nav_any_angle;
typedef enum nav_progress { NAV_GOES_ON, NAV_IS_FOUND, NAV_IS_NOT_THERE } nav_progress;
void nav_mesh_any_angle_begin(nav_any_angle *search, nav_point start, uint32_t start_polygon);
nav_progress nav_mesh_any_angle_run(nav_any_angle *search, uint32_t most);
// A search that goes on from step to step (nav_slice.c).
typedef struct nav_slice {
    core_handle path; // null: none
    uint64_t version; // of the surface
    uint32_t mesh;    // its row
    nav_ends ends;
    nav_any_angle search;
    nav_view_scratch views;
} nav_slice;
// All views from a point, nearest first: scratch->view[scratch->count].
void nav_mesh_flood(const nav_mesh_data *mesh, nav_view_scratch *scratch, nav_point start,
                    uint32_t polygon);
// Length of the way from a view's first root to a point of its polygon, INFINITY: not by this view.
// *turn: the turning point at which it bends into the polygon, NAV_NONE: straight from the root.
double nav_view_reach(const nav_view *view, nav_point point, nav_point *bend, uint32_t *turn);
void nav_view_scratch_release(nav_view_scratch *scratch);

// nav_mesh_find_way with bends kept `clearance` cells (0..1) clear of the corners they go round.
// The way stays in world->way until the next search.
bool nav_mesh_plan(nav_world *world, const nav_mesh_query *query, double clearance,
                   nav_result *result);
// Ends of a query on the surface; status NAV_NO_PATH when one of them is off it.
bool nav_mesh_ends(const nav_mesh_data *mesh, const nav_mesh_query *query, nav_ends *ends);
// Fills world->way from a search that has found its goal; its length in m.
double nav_mesh_write_found(nav_world *world, const nav_any_angle *search, const nav_ends *ends,
                            double clearance);
bool nav_mesh_is_plain(const nav_mesh_data *mesh); // no link is open
typedef struct nav_way {
    core_vec3 *point;
    uint32_t *link; // to the next point
    uint32_t count, room;
} nav_way;

// nav_mesh_reach.c: polygons joined by edges have the same component.
void nav_mesh_find_components(nav_mesh_data *mesh, uint64_t version);
// The place nearest to the goal that edges join to `start`.
nav_place nav_mesh_nearest_joined(const nav_mesh_data *mesh, nav_place start, core_vec3 goal);
// Of a polygon; its height is that of the span there.
nav_place nav_mesh_nearest_in(const nav_mesh_data *mesh, uint32_t polygon, core_vec3 goal);

// Ways from anywhere to one goal (nav_flow.c).
typedef struct nav_flow_data {
    uint64_t version; // of the surface, + 1
    nav_place goal;
    nav_buffer views, first, next; // nav_view; by polygon: number of its first view, of the next
    uint32_t count;
} nav_flow_data;
typedef struct nav_flow_head {
    core_handle mesh;
    core_vec3 goal;
    uint32_t unused;
} nav_flow_head;
#define NAV_FLOW_COLUMNS(X)                                                                        \
    X(nav_flow_head, head, CORE_COLUMN_STATE)                                                      \
    X(nav_flow_data *, data, 0)
CORE_COLUMNS_DECLARE(nav_flows, NAV_FLOW_COLUMNS)
// Fills world->way from `start` to the flow's goal, bends kept clear as in nav_mesh_plan.
bool nav_flow_plan(nav_world *world, nav_flow flow, core_vec3 start, double clearance,
                   nav_result *result);
void nav_flow_release(nav_flow_data *flow);
void nav_way_add(nav_way *way, core_vec3 point, uint32_t link);
// A turning point, moved away from the closed cell that a way goes round there by so many cells.
nav_point nav_mesh_clear_of(const nav_mesh_data *mesh, nav_point corner, uint32_t turn,
                            double cells);

// A point of a coarse way.
typedef struct nav_waypoint {
    nav_point at;
    uint32_t span;    // on the ground there
    uint32_t edge;    // that it crosses here, NAV_NONE
    uint32_t polygon; // in which it goes on
    uint32_t link;    // that leads to the next, NAV_NO_LINK
} nav_waypoint;
// Fills world->coarse.way. With `partial`, ends->goal becomes the nearest reachable place.
nav_status nav_mesh_coarse(nav_world *world, const nav_mesh_data *mesh, nav_ends *ends,
                           const float *cost, bool partial, nav_result *result);
double nav_mesh_link_cost(const nav_mesh_data *mesh, uint32_t link); // m of plain ground
// The span of a polygon under a point of it, or of its border.
uint32_t nav_mesh_span_under(const nav_mesh_data *mesh, uint32_t polygon, nav_point at);
void nav_coarse_release(nav_coarse_scratch *scratch);

#endif
