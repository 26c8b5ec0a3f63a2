// Object types of corsac.anim that other rooms' functions take.
#ifndef SCRIPT_BIND_ANIM_H
#define SCRIPT_BIND_ANIM_H

#include "script/bind.h"

extern const bind_type bind_model_type, bind_skeleton_type, bind_clip_type, bind_machine_type,
    bind_animator_type, bind_mask_type;

// Declared in bind_animator.c: the methods of Animator.
extern const bind_fn bind_animator_methods[];
// Handler and argument declarations of corsac.anim.newMachine, in bind_machine.c.
typedef struct bind_machine_options {
    const char *initial;
    bind_list states, transitions;
    int parameters; // stack index of the table
    bool has_parameters;
} bind_machine_options;
typedef struct bind_machine_call {
    bind_machine_options options;
} bind_machine_call;
extern const bind_arg bind_machine_fields[];
bind_handler bind_machine_new;
// Those of Machine:extend; the options stand behind self.
typedef struct bind_machine_more {
    bind_list states, transitions;
} bind_machine_more;
typedef struct bind_machine_extension {
    core_handle self;
    bind_machine_more more;
} bind_machine_extension;
extern const bind_arg bind_machine_more_fields[];
bind_handler bind_machine_extend;

#endif
