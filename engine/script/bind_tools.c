// Tools for games that change no room themselves: tasks of the step, events, containers, prefabs,
// JSON, saved data. Their work is done in scripts/corsac/*.lua; the declarations check the calls.
#include "script/internal.h"
#include "script/json.h"

#include <stdio.h>
#include <string.h>

enum { TOOLS_ANY = BIND_ANY & ~(unsigned)BIND_CONF };

// ---- corsac.wait: the only ones that yield ----

typedef struct wait_args {
    double seconds;
    const char *event;
} wait_args;

static int yield(script *s, lua_State *L, const char *owner, const char *what) {
    if (s->task != L) {
        bind_error(L, "%s works inside corsac.spawn(function() ... end)", owner);
    }
    lua_pushstring(L, what);
    lua_insert(L, -2);
    return lua_yield(L, 2);
}
static int wait(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, ((wait_args *)args)->seconds);
    return yield(s, L, "corsac.wait", "wait");
}
static int wait_for(script *s, lua_State *L, void *args) {
    lua_pushstring(L, ((wait_args *)args)->event);
    return yield(s, L, "corsac.waitFor", "event");
}

// ---- JSON and files ----

typedef struct value_args {
    int value;
} value_args;
typedef struct text_args {
    const char *text;
} text_args;

static int json_encode(script *s, lua_State *L, void *args) {
    (void)s;
    char *text = script_json_write(L, ((value_args *)args)->value, "corsac.json.encode: value");
    lua_pushstring(L, text);
    core_free(text);
    return 1;
}
static int json_decode(script *s, lua_State *L, void *args) {
    (void)s;
    const char *text = ((text_args *)args)->text;
    if (!script_json_read(L, text, strlen(text))) {
        bind_error(L, "corsac.json.decode: %s", core_last_error());
    }
    return 1;
}
static int read_file(script *s, lua_State *L, void *args) {
    size_t size;
    char path[420];
    snprintf(path, sizeof path, "%s%s", s->root, ((text_args *)args)->text);
    char *text = core_vfs_read(scene_vfs(s->scene), path, &size);
    if (!text) {
        bind_fail(L);
    }
    lua_pushlstring(L, text, size);
    core_free(text);
    return 1;
}
static int get_run_data(script *s, lua_State *L, void *args) {
    (void)args;
    if (!s->given_data) {
        return 0;
    }
    if (!script_json_read(L, s->given_data, strlen(s->given_data))) {
        bind_fail(L);
    }
    return 1;
}

// ---- declarations ----

// Arguments of functions written in Lua are checked here and read there.
typedef struct lua_args {
    double number[4];
    const char *text;
    int index[4];
    int64_t whole;
} lua_args;
#define NUMBER(i) BIND_NUMBER, BIND_AT(lua_args, number[i])
#define INDEX(i)  BIND_AT(lua_args, index[i])

typedef struct tween_options {
    double length, from, to;
    int target, goals, step, done, ease;
} tween_options;
typedef struct tween_call {
    tween_options options;
} tween_call;
static const bind_arg tween_fields[] = {
    {"length", BIND_NUMBER, BIND_AT(tween_options, length), "how long it takes", "s",
     BIND_POSITIVE},
    {"target", BIND_TABLE, BIND_AT(tween_options, target), "table whose numbers move",
     .optional = true, .def_text = "none"},
    {"goals", BIND_TABLE, BIND_AT(tween_options, goals), "names in target and where they go",
     .optional = true, .def_text = "none"},
    {"from", BIND_NUMBER, BIND_AT(tween_options, from), "first value for step", .optional = true},
    {"to", BIND_NUMBER, BIND_AT(tween_options, to), "last value for step", .optional = true,
     .def = 1},
    {"step", BIND_FUNCTION, BIND_AT(tween_options, step), "called each step with the value",
     .optional = true, .def_text = "none"},
    {"done", BIND_FUNCTION, BIND_AT(tween_options, done), "called at the end", .optional = true,
     .def_text = "none"},
    {"ease", BIND_ENUM, BIND_AT(tween_options, ease), "how it moves", .optional = true, .def = 1,
     .values = "linear|smooth|in|out|bounce"},
    {0}};

static const bind_fn root_functions[] = {
    {"after", "Calls a function once, after a time rounded up to whole steps.",
     BIND_ARGS({"seconds", NUMBER(0), "", "s", BIND_NOT_NEGATIVE},
               {"fn", BIND_FUNCTION, INDEX(0), "called in the step"}),
     BIND_RETURNS({"task", "corsac.Task", NULL}), sizeof(lua_args), BIND_SIM, .mod = true,
     .cost = 50},
    {"every", "Calls a function again and again.",
     BIND_ARGS({"seconds", NUMBER(0), "between calls", "s", BIND_POSITIVE},
               {"fn", BIND_FUNCTION, INDEX(0), "called in the step"},
               {"times", BIND_INT, BIND_AT(lua_args, whole), "how often", NULL, BIND_POSITIVE,
                .optional = true, .def_text = "for ever"}),
     BIND_RETURNS({"task", "corsac.Task", NULL}), sizeof(lua_args), BIND_SIM, .mod = true,
     .cost = 50},
    {"tween", "Moves numbers from where they are to where they should be.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(tween_call, options), "what moves, how and when",
                .fields = tween_fields}),
     BIND_RETURNS({"task", "corsac.Task", NULL}), sizeof(tween_call), BIND_SIM, .mod = true,
     .cost = 100},
    {"spawn", "Starts a coroutine that lives in the step: it may call corsac.wait.",
     BIND_ARGS({"fn", BIND_FUNCTION, INDEX(0), "the coroutine's function"},
               {"...", BIND_REST, INDEX(1), "its arguments"}),
     BIND_RETURNS({"task", "corsac.Task", NULL}), sizeof(lua_args), BIND_SIM, .mod = true,
     .cost = 100},
    {"wait", "Inside corsac.spawn: goes on after a time (at least one step).",
     BIND_ARGS({"seconds", BIND_NUMBER, BIND_AT(wait_args, seconds), "", "s", BIND_NOT_NEGATIVE,
                .optional = true, .def_text = "one step"}),
     NULL, sizeof(wait_args), BIND_SIM, .mod = true, .cost = 10, .immediate = true, .run = wait},
    {"waitFor", "Inside corsac.spawn: goes on in the step after an event and gives its arguments.",
     BIND_ARGS({"event", BIND_STRING, BIND_AT(wait_args, event), "name, as given to corsac.emit"}),
     BIND_RETURNS({"...", "any", NULL}), sizeof(wait_args), BIND_SIM, .mod = true, .cost = 10,
     .run = wait_for},
    {"cancel", "Ends a timer, tween or coroutine; false when it was over.",
     BIND_ARGS({"task", BIND_TABLE, INDEX(0), "what after, every, tween or spawn gave"}),
     BIND_RETURNS({"cancelled", "boolean", NULL}), sizeof(lua_args), BIND_SIM, .mod = true,
     .cost = 10},
    {"on", "Listens to an event; a listener that returns false is not called again.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(lua_args, text), "of the event"},
               {"fn", BIND_FUNCTION, INDEX(0), "called with the event's arguments"}),
     NULL, sizeof(lua_args), TOOLS_ANY, .mod = true, .cost = 20},
    {"off", "Ends listening; false when it did not listen.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(lua_args, text), "of the event"},
               {"fn", BIND_FUNCTION, INDEX(0), "the listener"}),
     BIND_RETURNS({"found", "boolean", NULL}), sizeof(lua_args), TOOLS_ANY, .mod = true,
     .cost = 20},
    {"emit", "Calls an event's listeners now, in the order in which they began to listen.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(lua_args, text), "of the event"},
               {"...", BIND_REST, INDEX(0), "given to the listeners"}),
     BIND_RETURNS({"heard", "integer", NULL}), sizeof(lua_args), TOOLS_ANY, .mod = true,
     .cost = 20},
    {"newMap", "A map with any keys, walked in order of insertion: set, get, has, count, each.",
     NULL, BIND_RETURNS({"map", "corsac.Map", NULL}), 0, BIND_ANY, .mod = true, .cost = 20},
    {"newQueue", "A queue: push, pop, peek, count.", NULL,
     BIND_RETURNS({"queue", "corsac.Queue", NULL}), 0, BIND_ANY, .mod = true, .cost = 20},
    {"newHeap", "A priority queue, lowest first, oldest among equals: push, pop, count.", NULL,
     BIND_RETURNS({"heap", "corsac.Heap", NULL}), 0, BIND_ANY, .mod = true, .cost = 20},
    {"inspect", "Text of a value for people: tables with their fields, sorted, at most 6 deep.",
     BIND_ARGS({"value", BIND_VALUE, INDEX(0), "anything"}), BIND_RETURNS({"text", "string", NULL}),
     sizeof(lua_args), BIND_ANY, .run = NULL},
    {"persist", "A table that survives hot reloads; made from the default at first.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(lua_args, text), "of the table"},
               {"default", BIND_TABLE, INDEX(0), "its first contents"}),
     BIND_RETURNS({"state", "table", NULL}), sizeof(lua_args), TOOLS_ANY, .run = NULL},
    {"readFile", "Text of a file in the game's folder.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(text_args, text), "relative, with /"}),
     BIND_RETURNS({"text", "string", NULL}), sizeof(text_args), TOOLS_ANY, .run = read_file},
    {"getRunData", "What the former scene gave to corsac.run, or nil.", NULL,
     BIND_RETURNS({"data", "table?", NULL}), 0, TOOLS_ANY, .run = get_run_data},
    {0}};

static const bind_fn scene_functions[] = {
    {"newPrefab",
     "Keeps options of spawn for use again: prefab:spawn{...} with changes, prefab:with{...} for a "
     "variant; `children` lists prefab tables that hang on it.",
     BIND_ARGS({"options", BIND_TABLE, INDEX(0), "as for spawn, and children"}),
     BIND_RETURNS({"prefab", "corsac.Prefab", NULL}), sizeof(lua_args), TOOLS_ANY, .run = NULL},
    {0}};

static const bind_fn json_functions[] = {
    {"encode", "JSON text of plain data; keys are sorted.",
     BIND_ARGS({"value", BIND_VALUE, BIND_AT(value_args, value),
                "numbers, strings, booleans and tables of these"}),
     BIND_RETURNS({"text", "string", NULL}), sizeof(value_args), BIND_ANY, .mod = true, .cost = 500,
     .run = json_encode},
    {"decode", "Data from JSON text.",
     BIND_ARGS({"text", BIND_STRING, BIND_AT(text_args, text), "JSON"}),
     BIND_RETURNS({"value", "any", NULL}), sizeof(text_args), BIND_ANY, .mod = true, .cost = 500,
     .run = json_decode},
    {0}};

typedef struct read_options {
    int64_t version;
    int migrate;
} read_options;
typedef struct read_call {
    const char *name;
    read_options options;
} read_call;
static const bind_arg read_fields[] = {
    {"version", BIND_INT, BIND_AT(read_options, version), "that this code writes", NULL,
     BIND_POSITIVE, .optional = true, .def = 1},
    {"migrate", BIND_FUNCTION, BIND_AT(read_options, migrate),
     "called with older data and its version; gives data of this version", .optional = true,
     .def_text = "none"},
    {0}};

static const bind_fn save_functions[] = {
    {"write", "Writes plain data to the player's folder, whole or not at all.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(lua_args, text), "letters, digits, - and _"},
               {"data", BIND_TABLE, INDEX(0), "plain data"},
               {"version", BIND_INT, BIND_AT(lua_args, whole), "of its form", NULL, BIND_POSITIVE,
                .optional = true, .def = 1}),
     NULL, sizeof(lua_args), BIND_RUNNING, .run = NULL},
    {"read", "Data that was written under that name, or nil.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(read_call, name), "as given to write"},
               {"options", BIND_OPTIONS, BIND_AT(read_call, options), "", .optional = true,
                .def_text = "none", .fields = read_fields}),
     BIND_RETURNS({"data", "table?", NULL}), sizeof(read_call), BIND_TOP | BIND_LOAD, .run = NULL},
    {0}};

static const bind_module modules[] = {
    {"corsac", "Tasks of the step, events, containers.", root_functions},
    {"corsac.scene", "Prefabs.", scene_functions},
    {"corsac.json", "Plain data as JSON.", json_functions},
    {"corsac.save", "The player's saved data: JSON files in a folder of the game's own.",
     save_functions},
    {0}};

const bind_room bind_tools_room = {"tools", modules, NULL};
