// Classes of corsac.gfx that other rooms' bindings take as arguments.
#ifndef SCRIPT_BIND_GFX_H
#define SCRIPT_BIND_GFX_H

#include "script/bind.h"

extern const bind_type bind_light_type, bind_material_type, bind_emitter_type, bind_terrain_type,
    bind_view_type, bind_effect_type;
// Up to 16 numbers for a shader of the script; the rest is 0. More is an error.
void bind_shader_parameters(lua_State *L, const char *call, const bind_numbers *numbers,
                            float out[16]);

#endif
