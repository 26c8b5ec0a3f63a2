// Arguments of the methods of Surface that change it; bind_surface.c declares them, bind_ground.c
// runs them.
#ifndef SCRIPT_BIND_SURFACE_H
#define SCRIPT_BIND_SURFACE_H

#include "script/bind_nav.h"

typedef struct bind_ground_box {
    core_vec3 position, size;
    int64_t area;
} bind_ground_box;
// Triangles and boxes, as newSurface and Surface:put take them.
typedef struct bind_ground {
    bind_numbers vertices, triangles, areas;
    bind_list boxes;
} bind_ground;
// The soup's arrays are userdata on Lua's stack: collected by Lua, also when an error is raised.
void bind_read_ground(lua_State *L, const bind_ground *ground, core_soup_data *out);

typedef struct bind_surface_options {
    bind_ground ground;
    float cell_size, radius, height, climb, slope, max_error, tolerance;
    int64_t tile_cells, tiles_per_step;
    core_vec3 low, high;
    bool has_low, has_high, kinematic;
    int from, layers;
} bind_surface_options;
typedef struct bind_surface_call {
    bind_surface_options options;
} bind_surface_call;
typedef struct bind_load_call {
    const char *path;
} bind_load_call;
extern const bind_arg bind_surface_fields[];
bind_handler bind_surface_new, bind_surface_load;

typedef struct bind_put_args {
    core_handle self;
    int64_t key;
    bind_ground ground;
} bind_put_args;
typedef struct bind_key_args {
    core_handle self;
    int64_t key;
} bind_key_args;
typedef struct bind_mark_args {
    core_handle self;
    int64_t key;
    bind_ground_box box;
} bind_mark_args;
typedef struct bind_link_options {
    core_vec3 from, to;
    float cost;
    bool both_ways, closed;
    int kind;
} bind_link_options;
typedef struct bind_add_link_args {
    core_handle self;
    bind_link_options options;
} bind_add_link_args;
typedef struct bind_open_args {
    core_handle self;
    int64_t link;
    bool open;
} bind_open_args;
bind_handler bind_surface_put, bind_surface_remove, bind_surface_mark, bind_surface_update,
    bind_surface_get_waiting, bind_surface_add_link, bind_surface_remove_link,
    bind_surface_set_link_open, bind_surface_get_link;

#endif
