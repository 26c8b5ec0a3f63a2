// Object types of corsac.nav.
#ifndef SCRIPT_BIND_NAV_H
#define SCRIPT_BIND_NAV_H

#include "script/bind.h"

extern const bind_type bind_graph_type, bind_path_type, bind_agent_type;
// Declared in bind_agent.c: newAgent's handler, its arguments and the methods of Agent.
typedef struct bind_agent_options {
    core_vec3 position;
    float radius, max_speed, acceleration, turn_rate, arrive, heading, offset;
    core_handle entity;
    bool has_position, has_entity;
} bind_agent_options;
typedef struct bind_agent_call {
    bind_agent_options options;
} bind_agent_call;
extern const bind_arg bind_agent_fields[];
extern const bind_fn bind_agent_methods[];
bind_handler bind_agent_new;
bool bind_agent_alive(script *s, core_handle h);

#endif
