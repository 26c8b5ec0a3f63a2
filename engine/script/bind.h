// How C functions reach Lua. Every function is declared once, in a table; argument checks, error
// texts, docs/api.md, the editor stubs and the wrong-argument test all come from that table.
//
// To add a function to a room:
//   1. In bind_ROOM.c write its arguments as a struct (methods: first member `core_handle self`),
//      the handler `static int name(script *s, lua_State *L, void *args)` (returns how many values
//      it pushed) and a bind_fn row: name, doc, args, returns, phases.
//   2. `make docs`, and use it in a scene or test.
// To add a room: a file bind_ROOM.c with a `const bind_room bind_ROOM_room`, and one line in the
// list `bind_rooms` of bind_rooms.c. To add a class of objects: a bind_type beside its methods.
//
// Handlers run only with checked arguments: kinds, ranges, names, liveness and phase are done. They
// report failures of the engine with bind_fail (text of core_fail) and their own with bind_error.
#ifndef SCRIPT_BIND_H
#define SCRIPT_BIND_H

#include "script/script.h"

#include <lua.h>

// When a binding may be called. Changing the simulation is BIND_SIM.
typedef enum bind_phase {
    BIND_TOP = 1u << 0,    // the file's own code, before worlds are made
    BIND_CONF = 1u << 1,   // corsac.conf
    BIND_LOAD = 1u << 2,   // corsac.load
    BIND_FIXED = 1u << 3,  // corsac.fixed, timers and coroutines of the step
    BIND_STEP = 1u << 4,   // callbacks of the step: contacts, triggers
    BIND_UPDATE = 1u << 5, // corsac.update
    BIND_DRAW = 1u << 6,   // corsac.draw
    BIND_EVENT = 1u << 7,  // corsac.event
    BIND_QUIT = 1u << 8    // corsac.quit
} bind_phase;
enum {
    BIND_SIM = BIND_LOAD | BIND_FIXED | BIND_STEP,
    BIND_VIEW = BIND_UPDATE | BIND_DRAW | BIND_EVENT,
    BIND_RUNNING = BIND_SIM | BIND_VIEW | BIND_QUIT, // worlds exist
    BIND_ANY = BIND_RUNNING | BIND_TOP | BIND_CONF
};

typedef enum bind_kind { // what Lua gives            -> member of the args struct
    BIND_NUMBER = 1,     // finite number             -> double
    BIND_FLOAT,          // finite number             -> float
    BIND_INT,            // whole number              -> int64_t
    BIND_BOOL,           // true, false               -> bool
    BIND_STRING,         // string                    -> const char * (lives as long as the call)
    BIND_ENUM,           // one of `values`           -> int (its place in `values`)
    BIND_VEC3,           // {x, y, z}                 -> core_vec3
    BIND_QUAT,           // {x, y, z, w} or {axis = {x, y, z}, angle = r} -> core_quat
    BIND_COLOR,          // {r, g, b} or {r, g, b, a} -> float[4]
    BIND_OBJECT,         // object of `type`          -> core_handle
    BIND_OPTIONS,        // table with `fields`       -> struct with its own members
    BIND_LIST,           // array of such tables      -> bind_list of structs of `size` bytes
    BIND_NUMBERS,        // array of numbers          -> bind_numbers
    BIND_FUNCTION,       // function                  -> int (stack index)
    BIND_TABLE,          // any table                 -> int (stack index)
    BIND_VALUE,          // anything but nil          -> int (stack index)
    BIND_REST            // all further arguments     -> int (index of the first)
} bind_kind;

typedef enum bind_range {
    BIND_ANY_NUMBER,
    BIND_POSITIVE,     // > 0
    BIND_NOT_NEGATIVE, // >= 0
    BIND_BETWEEN       // min <= x <= max
} bind_range;

typedef struct bind_type bind_type;
typedef struct bind_arg bind_arg;
struct bind_arg {
    const char *name; // NULL ends the list
    bind_kind kind;
    size_t at; // offset of the member in the args struct
    const char *doc;
    const char *unit; // "m", "kg/m^3"; NULL: none
    bind_range range;
    double min, max;        // BIND_BETWEEN
    bool optional;          // may be nil; then the default below (zero, NULL, null handle)
    double def;             // number, float, int, bool, enum
    const char *def_text;   // default of a string; for others how the docs describe the default
    core_vec3 def_vec;      // vec3; first three of a colour
    bool uniform;           // vec3: one number means {n, n, n}
    size_t given;           // offset of a bool that says whether it was given; 0: none
    const char *values;     // enum: "dynamic|static"
    const bind_type *type;  // object
    const bind_arg *fields; // options, list
    size_t size;            // list: bytes of one struct
};

typedef struct bind_list {
    void *items; // [count] structs; belongs to Lua, valid during the call
    uint32_t count;
} bind_list;
typedef struct bind_numbers {
    float *items; // [count]; belongs to Lua, valid during the call
    uint32_t count;
} bind_numbers;

typedef struct bind_return {
    const char *name; // NULL ends the list
    const char *type; // LuaLS type: "number", "string", "corsac.Body"
    const char *unit;
} bind_return;

typedef int bind_handler(script *s, lua_State *L, void *args);
// A method whose arguments and returns are plain numbers: reads its arguments from v and leaves
// its returns there (at most BIND_NUMBERS_MAX of each). False + core_fail. Compiled Lua calls it
// without the stack in between; everything else reaches it through the same checks as a handler.
enum { BIND_NUMBERS_MAX = 8 };
typedef bool bind_number_method(script *s, core_handle self, double *v);

typedef struct bind_fn {
    const char *name; // "setGravity"; NULL ends the list; "" makes the module itself callable
    const char *doc;  // one line, ends with a full stop
    const bind_arg *args;
    const bind_return *returns;
    size_t size;     // of the args struct
    unsigned phases; // bind_phase bits
    bool mod;        // mods may call it
    bool mod_only;   // only mods have it
    bool immediate;  // called by a mod it acts at once; other changes of the simulation wait until
                     // the mod's call has ended well
    uint32_t cost;   // instructions that a mod pays for one call, beside its own
    bind_handler *run; // NULL: `numbers`, or written in Lua (scripts/corsac), checked all the same
    bind_number_method
        *numbers; // in place of run; `size` is then free, BIND_NUMBER args without `at`
} bind_fn;

// A class of objects. Lua holds one userdata per object and state; it carries the handle only.
struct bind_type {
    const char *name; // "Body"
    const char *doc;
    bool (*alive)(script *s, core_handle h);
    const bind_fn *methods;
};

typedef struct bind_module {
    const char *path; // "corsac.phys"; NULL ends the list
    const char *doc;
    const bind_fn *functions;
} bind_module;

typedef struct bind_room {
    const char *name;
    const bind_module *modules;
    const bind_type *const *types; // NULL-terminated; NULL: none
} bind_room;

extern const bind_room *const bind_rooms[]; // NULL-terminated

#define BIND_ARGS(...)                                                                             \
    (const bind_arg[]) {                                                                           \
        __VA_ARGS__, { 0 }                                                                         \
    }
#define BIND_RETURNS(...)                                                                          \
    (const bind_return[]) {                                                                        \
        __VA_ARGS__, { 0 }                                                                         \
    }
#define BIND_AT(type, member)    .at = offsetof(type, member)
#define BIND_GIVEN(type, member) .given = offsetof(type, member)

// Installs every room's functions as globals under `corsac` into L.
void bind_install(script *s, lua_State *L, bool mod);

// The object of a live handle: always the same userdata. A null handle pushes nil.
void bind_push(script *s, lua_State *L, const bind_type *type, core_handle h);
void bind_push_vec3(lua_State *L, core_vec3 v); // three numbers
void bind_push_quat(lua_State *L, core_quat q); // four numbers
// Handle of the object at a stack index, null when it is not one of that type.
core_handle bind_object_handle(script *s, lua_State *L, int index, const bind_type *type);

// What compiled Lua calls for a bind_number_method: false when the phase is wrong, the object is
// dead or the method fails; the caller then goes the checked way, which words the error.
bool bind_call_numbers(script *s, const bind_fn *fn, const bind_type *type, uint32_t index,
                       uint32_t generation, double *v);

// Raise a Lua error at the place of the calling script. They do not return.
CORE_NORETURN void bind_error(lua_State *L, const char *fmt, ...) CORE_PRINTF(2, 3);
CORE_NORETURN void bind_fail(lua_State *L); // with core_last_error()
// Checks the table at an index against fields, as an argument named `what` of `owner`, and fills
// out. For tables that do not come as arguments (corsac.conf).
void bind_check_table(script *s, lua_State *L, int index, const char *owner, const char *what,
                      const bind_arg *fields, void *out);
// Pushes "file:line: " of the innermost frame that is not part of scripts/corsac.
void bind_push_where(lua_State *L);

// A list of candidates for core_nearest.
typedef struct bind_names {
    const char *name[256];
    size_t count;
} bind_names;
void bind_names_add(bind_names *names, const char *name);
// core_nearest over the list; among equals the first by name, whatever the order of adding.
const char *bind_nearest(const char *name, bind_names *names);

// Text of one argument's type with unit and range, "a number in m, > 0": errors and docs use it.
void bind_describe(const bind_arg *arg, char *out, size_t size);
// Name of the phase a single bit stands for, "corsac.update".
const char *bind_phase_name(unsigned phase);

// The reference page (Markdown) and the editor stubs (LuaLS), written from the tables.
// core_free the results.
char *bind_docs_markdown(void);
char *bind_docs_stubs(void);

#endif
