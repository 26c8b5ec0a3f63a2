// Tags and queries: the part of corsac.scene that bind_query.c declares.
#ifndef SCRIPT_BIND_QUERY_H
#define SCRIPT_BIND_QUERY_H

#include "script/bind.h"

// Bits of the tags in the array at a stack index (0: none); raises a Lua error for bad ones.
uint64_t bind_tags(script *s, lua_State *L, int list, const char *owner);

extern const bind_fn bind_query_functions[];

// Handlers of Entity:addTag, removeTag and hasTag.
typedef struct bind_tag_args {
    core_handle self;
    const char *name;
} bind_tag_args;
bind_handler bind_add_tag, bind_remove_tag, bind_has_tag;

#endif
