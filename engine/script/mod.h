// Mods: folders of untrusted Lua. Each has a state of its own behind the guard; it hears named
// events, calls services of the game, patches the game's data. See docs/guide/mods.md.
#ifndef SCRIPT_MOD_H
#define SCRIPT_MOD_H

#include "core/rng.h"
#include "script/guard.h"
#include "script/pack.h"

enum {
    MOD_STRIKES = 3,
    MOD_LOG_LINES = 200,
    MOD_JOURNAL_MAX = 4096,
    MOD_ARGS_BYTES = 128,
    MOD_TEXT_BYTES = 32 << 10,
    MOD_FSM_PARTS = 256, // states and transitions that a mod adds to machines
    MOD_EXTENDED = 16    // machines that one call extends
};

// A change of the simulation that waits for the end of the mod's call.
typedef struct mod_change {
    const bind_fn *fn;
    const bind_type *type; // NULL: no object
    core_handle self;
    _Alignas(16) unsigned char args[MOD_ARGS_BYTES];
} mod_change;

typedef struct mod_extended { // a machine as it was before the running call added to it
    core_handle machine;
    uint32_t states, transitions;
} mod_extended;

typedef struct mod_made { // an object that the running call made
    const bind_type *type;
    core_handle handle;
} mod_made;

typedef struct script_mod {
    char name[48], version[24], dir[512];
    char dependency[8][48];
    int dependency_count;
    double order;
    int index;
    script *game, *view; // view: the script of the mod's own state
    script_guard guard;
    core_rng rng;
    bool started, enabled;
    int strikes, errors, log_lines;
    uint64_t instructions, calls, ns; // all calls so far
    uint64_t began;                   // clock at the running call's start: for the figures alone
    mod_change *journal;
    int journal_count;
    char *text; // [MOD_TEXT_BYTES] strings of the journal
    size_t text_used;
    mod_made *made;
    int made_count, made_capacity;
    mod_made *kept; // what all its calls made and may still live
    int kept_count, kept_capacity;
    uint32_t owned[32]; // entries of `kept` by class
    mod_extended extended[MOD_EXTENDED];
    int extended_count;
    uint32_t fsm_parts;
} script_mod;

// mod_assets.c: files in assets/ hide the game's. What may not be there is refused (core_fail)
// before anything is mounted; files of two mods are told when the later one is mounted.
bool script_mod_check_assets(const script_mod *m);
bool script_mod_mount_assets(script_mod *m);

core_rng *script_mod_stream(script_mod *m);
void script_mods_destroy(script *game);
// Orders the mods that were added and runs their main.lua.
void script_mods_start(script *game);
// Calls what mods hooked before or after an event, with packed arguments (NULL: none). results
// (NULL: dropped) gets the values of each call that ended well.
void script_mods_event(script *game, const char *name, bool before, const script_pack *args);
// Passes the packed value through the mods' filters of that name; value is replaced.
void script_mods_filter(script *game, const char *name, script_pack *value);
void script_mods_tick(script *game); // tasks of mods

// Calls the function of a mod's state under `argc` arguments behind the guard: how rooms call back.
bool script_mod_callback(script_mod *m, uint32_t phase, int argc, int results);

// Gate of every binding that a mod calls: charges it, checks quotas. Raises Lua errors.
void script_mod_charge(script *s, lua_State *L, const bind_fn *fn);
// True when the call was put off to the end of the mod's call.
bool script_mod_defer(script *s, lua_State *L, const bind_fn *fn, const bind_type *type,
                      core_handle self, const void *args, size_t size);
// Notes what a function made (top of the stack).
void script_mod_made(script *s, lua_State *L, const bind_fn *fn);
// Before a mod adds to a machine of so many states and transitions: raises a Lua error over its
// quota, else notes how the machine was, should the call fail.
void script_mod_extends(script *s, lua_State *L, const mod_extended *before, uint32_t parts);
// Before a function does work, or makes an object that does, in proportion to `size`: raises a Lua
// error above what mods may ask for, else charges. Does nothing for the game itself.
void script_mod_size(script *s, lua_State *L, const char *what, double size, double most);
// An error text of a mod that did not end its call (top of the stack, popped).
void script_mod_report(script *s, lua_State *L);

#endif
