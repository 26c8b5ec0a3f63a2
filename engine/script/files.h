// The player's saved data (files.c). C functions of scripts/corsac/save.lua; upvalue: the script.
#ifndef SCRIPT_FILES_H
#define SCRIPT_FILES_H

#include <lua.h>

int script_save_write(lua_State *L); // (name, data)
int script_save_read(lua_State *L);  // (name) -> data or nothing

#endif
