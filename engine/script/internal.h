// What the files of this room share: the state behind `script`.
#ifndef SCRIPT_INTERNAL_H
#define SCRIPT_INTERNAL_H

#include "core/rng.h"
#include "script/bind.h"

#include <lauxlib.h>

enum {
    SCRIPT_TYPES_MAX = 32,
    SCRIPT_EXPECT_MAX = 256,
    SCRIPT_PARAM_MAX = 256,
    SCRIPT_MODS_MAX = 32,
    SCRIPT_WATCH_MAX = 256
};

typedef struct script_type_slot {
    const bind_type *type;
    const void *metatable; // identity only; Lua owns it
    int metatable_ref;
    int cache_ref; // weak-valued table: handle index -> userdata
} script_type_slot;

typedef enum script_op { OP_LE, OP_LT, OP_GE, OP_GT, OP_EQ, OP_NE } script_op;
#define SCRIPT_OPS "<=|<|>=|>|==|~="
typedef struct script_expect {
    char metric[96], where[160];
    script_op op;
    double value;
    bool missed; // corsac.expect.now fell short: `found` was the value
    double found;
} script_expect;

typedef struct script_watched { // a file whose change means a reload
    char path[240];
    uint64_t stamp;
} script_watched;

struct script_mod;
struct script {
    lua_State *L;
    scene *scene;
    script_host host;
    bool headless, keep_going, mod;
    uint32_t phase; // one bind_phase bit: what runs now
    script_type_slot type[SCRIPT_TYPES_MAX];
    int type_count;
    script_expect *expect;
    int expect_count;
    char (*param)[64];
    int param_count;
    const char *const *argv;
    int argc;
    int error_count;
    uint64_t callback_count;    // calls from C so far
    uint32_t contact_callbacks; // given to bodies so far
    char *last_error;
    uint32_t stopped;        // bind_phase bits of callbacks that an error has stopped
    char *run_data;          // JSON handed to the next scene by corsac.run
    double time;             // s of simulated time
    uint64_t seed;           // of the run
    script_watched *watched; // [SCRIPT_WATCH_MAX]
    int watched_count;
    char path[240];           // the scene\'s file
    int reload_ref, kept_ref; // scripts/corsac/reload.lua and save.lua
    int handler_ref;          // message handler of protected calls
    int corsac_ref;           // the table `corsac`
    int tick_ref;             // scripts/corsac/tasks.lua
    int error_screen_ref;     // scripts/corsac/error.lua
    char root[200];           // virtual folder of the game with its '/', "" for the tree's root
    lua_State *task;          // the coroutine of corsac.spawn that runs now; NULL: none
    lua_State *service;       // thread of L in which mods reach the game
    bool awake;               // tasks wait for a step
    struct script_mod *mods[SCRIPT_MODS_MAX]; // in order, of a game
    int mod_count;
    struct script_mod *as_mod; // of a mod's own state
    char game[64];             // folder name of the player's files
    core_vfs *save;            // the player's files, made on first use
    char *given_data;          // JSON from the former scene
    int scene_ask;             // what corsac.scene.save or load asked for (scene_file.c)
    char scene_file[80];       // its file
    void *scene_data;          // to be loaded
    size_t scene_size;
};

// Lua's userdata of an object.
typedef struct bind_object {
    core_handle handle;
    const bind_type *type;
} bind_object;

// The engine's C side of Lua's base library: ordered pairs, printable names, seeded random numbers,
// no clock, no files (state.c).
lua_State *script_state_create(script *s);
// The part that mods have too: pushes a table of the functions that scripts/corsac builds on.
void script_push_engine(script *s, lua_State *L);
// Runs scripts/corsac/NAME.lua with the engine table ("corsac.engine" of the registry).
bool script_run_part(script *s, lua_State *L, const char *name);
// The random stream of what runs now: the simulation's or the view's.
core_rng *script_stream(script *s);
// Embedded text of a file of scripts/corsac ("boot.lua"); NULL when there is none.
const char *script_embedded(const char *name, size_t *size);
// Loads a chunk from the mounted files, else from the embedded ones; leaves the function on the
// stack, or false with a message there.
bool script_load_chunk(script *s, lua_State *L, const char *virtual_path);
// Calls the function under `argc` arguments in a phase; an error is recorded with its traceback.
bool script_call(script *s, uint32_t phase, int argc, int results);
// The same on any thread of the state, in the phase that runs.
bool script_protected(script *s, lua_State *L, int argc, int results);
// Makes the message handler of a state, once: a call then leaves no garbage.
void script_make_handler(script *s, lua_State *L);
// Adds nearest name and traceback to the error text on top of the stack.
void script_push_report(const script *s, lua_State *L);
// Records an error text (top of the stack, popped) as the run's.
void script_record_error(script *s, lua_State *L);
// Remembers a file and its present stamp for script_reload_changed.
void script_watch_file(script *s, const char *virtual_path);
char *script_copy_text(const char *text); // core_free it
bool script_compare(double a, script_op op, double b);

#endif
