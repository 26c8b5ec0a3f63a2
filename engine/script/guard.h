// What keeps a mod's Lua state from harming the game: memory cap, instruction budget, C stack
// limit, and a base library without doors.
#ifndef SCRIPT_GUARD_H
#define SCRIPT_GUARD_H

#include "script/bind.h"

enum {
    GUARD_MEMORY = 32 << 20,   // bytes of a mod's Lua heap
    GUARD_BLOCK = 256 << 10,   // bytes of its largest string or table part
    GUARD_CALL = 300000,       // instructions of one call
    GUARD_START = 3000000,     // instructions of its main.lua
    GUARD_STACK = 384 << 10,   // bytes of C stack below a call
    GUARD_BYTES_PER_UNIT = 32, // allocated bytes that cost one instruction
    GUARD_PATTERN = 20000000,  // most steps that a pattern could take
#ifdef CORE_DEBUG
    GUARD_WALL_MS = 20000 // debug builds and sanitizers run many times slower
#else
    GUARD_WALL_MS = 2000 // backstop by the clock; a run it touches is marked
#endif
};

typedef struct script_guard {
    size_t bytes, peak;
    int64_t left;    // instructions of the running call
    int64_t granted; // what it began with
    bool running, killed, overtime;
    const char *why;   // why it was killed
    const char *stack; // C stack at the call's start
    uint64_t deadline; // ns
    lua_State *L;
} script_guard;

// A state with base, table, string, math and bit, cut down and guarded; scripts/corsac/mod.lua has
// not run yet. NULL + core_fail. `guard` must outlive it; lua_close ends it.
lua_State *script_guard_state(script_guard *guard);
// Brackets a call into the state. end gives the instructions it used.
void script_guard_begin(script_guard *guard, int64_t budget);
int64_t script_guard_end(script_guard *guard);
// Charges work done in C; the call is stopped at its next instruction when nothing is left.
void script_guard_charge(script_guard *guard, int64_t units);
// Stops the call for another reason.
void script_guard_kill(script_guard *guard, const char *why);

#endif
