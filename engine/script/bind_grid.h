// Grids and flows of corsac.nav (bind_grid.c).
#ifndef SCRIPT_BIND_GRID_H
#define SCRIPT_BIND_GRID_H

#include "script/bind_nav.h"

extern const bind_type bind_grid_type, bind_flow_type;
typedef struct bind_grid_args {
    int64_t width, height;
} bind_grid_args;
typedef struct bind_flow_args {
    core_handle surface;
    core_vec3 goal;
} bind_flow_args;
bind_handler bind_grid_new, bind_flow_new;

#endif
