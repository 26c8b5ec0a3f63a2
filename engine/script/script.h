// Lua for a scene. Several states may be bound to one scene; no static per-state data.
#ifndef SCRIPT_SCRIPT_H
#define SCRIPT_SCRIPT_H

#include "scene/scene.h"

typedef struct script script;

// What app tells and hears. Strings are borrowed for the call only.
typedef struct script_host {
    void *ctx;
    // `value` receives the --set text for a parameter, NULL when not given.
    const char *(*param)(void *ctx, const char *name);
    void (*exit)(void *ctx, int code);
    bool (*run)(void *ctx, const char *path); // change scene at the next step boundary
    void (*user_metric)(void *ctx, const char *name, double value);
    // Value of a metric by its dotted JSON path ("accuracy.penetration_max_m"); NaN when unknown.
    double (*metric)(void *ctx, const char *path, bool *known);
    void (*warning)(void *ctx, const char *text);
    // Input of this step; action or key by name ("space", "fire").
    bool (*input_down)(void *ctx, const char *name, bool *known);
    float (*input_axis)(void *ctx, const char *name, bool *known);
    // What a person would do, queued for the next step; ignored during a replay. False: no such
    // name.
    bool (*send_key)(void *ctx, const char *name, bool pressed);
    bool (*send_axis)(void *ctx, const char *name, float value);
    bool (*send_text)(void *ctx, const char *utf8);
    void (*send_move)(void *ctx, float x, float y);                // pointer, pixels
    bool (*bind)(void *ctx, const char *action, const char *keys); // false + core_fail_quiet
    bool (*binding)(void *ctx, const char *action, char *keys, size_t size);
    void (*cursor)(void *ctx, int mode); // 0 normal, 1 hidden, 2 locked
    // Saved data is the player's, no part of the game: a recording notes what was read (NULL: there
    // was none), a replay gives it back and writes none.
    bool (*replays)(void *ctx);
    const char *(*saved)(void *ctx, const char *name, size_t *size); // NULL: there was none
    void (*note_saved)(void *ctx, const char *name, const char *text, size_t size);
    void (*size)(void *ctx, uint32_t *width, uint32_t *height); // of the frame, pixels
    void (*pause)(void *ctx, bool paused);
    void (*time_scale)(void *ctx, float scale);
} script_host;

typedef struct script_desc {
    struct scene *scene;
    const script_host *host;
    bool headless;
    bool keep_going;
    int argc; // after `--`
    const char *const *argv;
    const char *data; // JSON from the former scene's script_run_data; NULL: none. Borrowed
    uint32_t cookie;
} script_desc;
script_desc script_desc_default(void);
script *script_create(const script_desc *desc);
void script_destroy(script *s);

// conf.lua / corsac.conf: what a scene may set before worlds are made. Zero: not set.
typedef struct script_conf {
    uint64_t steps, seed;
    bool has_seed;
    double dt;
    int threads;
    uint32_t width, height;
    char render[16];
    char title[128];
    uint32_t setting_count; // conf.phys = {...} and the like: "phys.solver" = "soft"
    char setting_name[32][64];
    char setting_value[32][64];
} script_conf;

// Adds a mod from its folder (mod.lua, main.lua, assets/): before script_load, which orders them
// and runs their code. False + core_fail: it is left out and the game goes on.
bool script_add_mod(script *s, const char *real_dir);

// What the mods used so far, in their order.
typedef struct script_mod_info {
    char name[48], version[24];
    bool enabled;
    uint64_t calls, instructions; // work in C is counted in instructions too
    uint32_t errors;
    size_t bytes; // Lua heap
    double ms;    // time of its calls
} script_mod_info;
// Fills out[capacity]; returns how many mods there are.
int script_mods_info(const script *s, script_mod_info *out, int capacity);

// Runs the file at top level (defining callbacks), then corsac.conf(t). False: error already shown.
bool script_load_file(script *s, const char *virtual_path, script_conf *conf);
bool script_load(script *s);              // corsac.load(args)
void script_fixed(script *s, float dt);   // corsac.fixed
void script_step_events(script *s);       // callbacks of triggers, after physics
void script_update(script *s, double dt); // corsac.update
// Last of a step: saves or loads the scene when the script has asked for it.
void script_end_step(script *s);
void script_draw(script *s); // corsac.draw
void script_event(script *s, const char *name, const char *text, const double *values, int count);
void script_quit(script *s); // corsac.quit
// When a Lua file of the game changed since it was loaded: runs the files' own code anew and calls
// corsac.reload(state) (tables of corsac.persist by name); the world stays. A file that fails
// leaves the old code in place. True: new code runs. For every frame of --watch.
bool script_reload_changed(script *s);
// Errors so far in this run; the last one's text with file:line, reason and traceback.
// Runs a line of a console between two steps, where corsac.fixed may do what it does: an expression
// or statements. out: the values or the error, cut to size. No error of it counts as the script's.
bool script_console(script *s, const char *code, char *out, size_t size);
int script_error_count(const script *s);
const char *script_last_error(const script *s);
// corsac.expect: evaluates registered checks. Returns how many fell short; each is logged.
int script_check_expectations(script *s);
size_t script_bytes(const script *s); // Lua heap
// JSON text of the data that corsac.run(path, data) handed over, NULL when there is none. Valid
// until the script is destroyed: copy it into the next script's desc.data.
const char *script_run_data(const script *s);
// Names given with --set that no corsac.param declared; NULL-terminated by count.
bool script_param_declared(const script *s, const char *name);

#endif
