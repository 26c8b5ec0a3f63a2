// Plain data and object handles on their way from one Lua state to another. Closures, metatables
// and shared tables do not cross: what arrives is a copy.
#ifndef SCRIPT_PACK_H
#define SCRIPT_PACK_H

#include "script/bind.h"

enum { PACK_BYTES_MAX = 1 << 20, PACK_DEPTH_MAX = 16 };

typedef struct script_pack {
    unsigned char *heap; // NULL: all bytes are in `small`
    size_t size, capacity;
    int values; // how many values follow one another
    unsigned char small[64];
} script_pack;

// An empty pack that L frees, also when an error leaves the function that filled it. Pushes one
// value that must stay on the stack as long as the pack is used.
script_pack *script_pack_new(lua_State *L);

// Appends the value at an index. Raises a Lua error in L for functions, coroutines, depth or size.
void script_pack_value(script *s, lua_State *L, int index, script_pack *out);
// Pushes all values onto L (objects become this state's own); returns how many.
int script_unpack(script *s, lua_State *L, const script_pack *in);
void script_pack_release(script_pack *p);

#endif
