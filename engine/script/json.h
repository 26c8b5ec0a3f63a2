// Plain Lua data (nil, booleans, finite numbers, strings, arrays, tables with string keys) as JSON.
#ifndef SCRIPT_JSON_H
#define SCRIPT_JSON_H

#include <lua.h>
#include <stdbool.h>
#include <stddef.h>

// JSON text of the value at an index (keys sorted); core_free it. Raises a Lua error that names the
// place inside the data ("corsac.run: data.player.body is a userdata") for anything else.
char *script_json_write(lua_State *L, int index, const char *what);
// Pushes the value of JSON text; false + core_fail_quiet (with the place) when it is malformed or
// nested more than 200 deep.
bool script_json_read(lua_State *L, const char *text, size_t size);

#endif
