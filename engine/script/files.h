// The player's saved data (files.c). C functions of scripts/corsac/save.lua; upvalue: the script.
#ifndef SCRIPT_FILES_H
#define SCRIPT_FILES_H

#include "script/script.h"

#include <lua.h>

core_vfs *script_player_files(script *s); // mounted on first use; NULL + core_fail
int script_save_write(lua_State *L);      // (name, data)
int script_save_read(lua_State *L);       // (name) -> data or nothing

#endif
