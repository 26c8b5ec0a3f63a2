// Methods of bodies about what they were made with; declared in the table of bind_phys.c.
#ifndef SCRIPT_BIND_BODY_SETTINGS_H
#define SCRIPT_BIND_BODY_SETTINGS_H

#include "script/bind.h"

typedef struct bind_shape_args {
    core_handle self;
    int64_t number; // from 1
} bind_shape_args;
typedef struct bind_locks_args {
    core_handle self;
    const char *words;
} bind_locks_args;

bind_handler bind_body_get_type, bind_body_get_shape, bind_body_set_locks, bind_body_get_locks;
bind_number_method bind_body_get_shape_count, bind_body_set_damping, bind_body_get_damping;
bind_number_method bind_body_set_gravity_scale, bind_body_get_gravity_scale;
bind_number_method bind_body_set_material, bind_body_get_material;

extern const bind_fn bind_state_functions[]; // snapshots, in corsac.phys

#endif
