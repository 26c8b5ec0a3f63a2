// The order in which pairs and next walk a table (order.c).
#ifndef SCRIPT_ORDER_H
#define SCRIPT_ORDER_H

#include <lua.h>

// keys(t) -> list, n: all keys in order. nil, n when they are just 1..n.
int script_order_keys(lua_State *L);
// next(t, k) -> key, value: the first key after k (nil: the first of all); one pass over t.
int script_order_next(lua_State *L);

#endif
