// The player's saved data (files.c). C functions of scripts/corsac/save.lua; upvalue: the script.
#ifndef SCRIPT_FILES_H
#define SCRIPT_FILES_H

#include "script/script.h"

#include "script/bind.h"

core_vfs *script_player_files(script *s); // mounted on first use; NULL + core_fail
int script_save_write(lua_State *L);      // (name, data)
int script_save_read(lua_State *L);       // (name) -> data or nothing

// Raises an error unless it has 1 to 64 letters, digits, - or _.
void script_check_save_name(lua_State *L, const char *name);
// A file of the player's folder, core_free it; NULL: there is none. Recorded, and replayed.
char *script_player_read(script *s, lua_State *L, const char *name, size_t *size);
// Nothing is written in a replay. False + core_fail.
bool script_player_write(script *s, const char *name, const void *data, size_t size);

#endif
