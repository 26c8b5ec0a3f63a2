// Layers by name, triggers and fields: the part of corsac.phys that bind_region.c declares.
#ifndef SCRIPT_BIND_REGION_H
#define SCRIPT_BIND_REGION_H

#include "script/bind.h"

extern const bind_fn bind_region_functions[];
extern const bind_fn bind_ask_functions[]; // bind_ask.c: rays, overlaps, closest points
extern const bind_type bind_trigger_type, bind_field_type;

// Number of a layer by name, made when it is new; raises a Lua error when there are 32.
uint32_t bind_layer(script *s, lua_State *L, const char *name);
// Bits of layers named in the array at a stack index (0: none); 0 when there is none.
uint32_t bind_layer_bits(script *s, lua_State *L, int list);

#endif
