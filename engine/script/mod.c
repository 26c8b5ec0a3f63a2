// Mods: loading, calls under the guard, and what happens to what they did (mod.h).
#include "script/mod.h"

#include "core/clock.h"
#include "core/log.h"
#include "script/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

core_rng *script_mod_stream(script_mod *m) { return &m->rng; }

// ---- one call ----

typedef struct mod_call {
    script_mod *mod;
    const char *part; // scripts/corsac part, or NULL
    int function;     // registry reference
    const script_pack *args;
    script_pack *results; // NULL: dropped
} mod_call;

// Under lua_cpcall: everything that may raise an error in the mod's state happens here.
static int run_call(lua_State *L) {
    mod_call *c = lua_touserdata(L, 1);
    lua_settop(L, 0);
    lua_rawgeti(L, LUA_REGISTRYINDEX, c->function);
    int argc = c->args ? script_unpack(c->mod->view, L, c->args) : 0;
    lua_call(L, argc, c->results ? LUA_MULTRET : 0);
    if (c->results) {
        int count = lua_gettop(L);
        c->results->size = 0;
        c->results->values = 0;
        for (int i = 1; i <= count; i++) {
            script_pack_value(c->mod->view, L, i, c->results);
        }
    }
    return 0;
}

static int apply_changes(lua_State *L) {
    script_mod *m = lua_touserdata(L, 1);
    for (int i = 0; i < m->journal_count; i++) {
        mod_change *c = &m->journal[i];
        if (c->type && !c->type->alive(m->view, c->self)) {
            continue; // destroyed by an earlier change of the same call
        }
        if (c->fn->numbers) {
            if (!c->fn->numbers(m->view, c->self, (double *)(void *)c->args)) {
                bind_fail(L);
            }
        } else {
            c->fn->run(m->view, L, c->args);
        }
        lua_settop(L, 1);
    }
    return 0;
}

static const bind_fn *method_of(const bind_type *type, const char *name) {
    for (const bind_fn *fn = type->methods; fn->name; fn++) {
        if (strcmp(fn->name, name) == 0) {
            return fn;
        }
    }
    return NULL;
}

static int unmake(lua_State *L) {
    script_mod *m = lua_touserdata(L, 1);
    while (m->made_count > 0) {
        mod_made made = m->made[--m->made_count];
        const bind_fn *destroy = method_of(made.type, "destroy");
        if (destroy && made.type->alive(m->view, made.handle)) {
            destroy->run(m->view, L, &made.handle);
        }
    }
    while (m->extended_count > 0) {
        mod_extended *e = &m->extended[--m->extended_count];
        anim_machine_trim(scene_anim(m->view->scene), e->machine, e->states, e->transitions);
    }
    return 0;
}

void script_mod_extends(script *s, lua_State *L, const mod_extended *before, uint32_t parts) {
    script_mod *m = s->as_mod;
    if (m->extended_count == MOD_EXTENDED || m->fsm_parts + parts > MOD_FSM_PARTS) {
        bind_error(L, "a mod adds at most %d states and transitions to machines, to %d in one call",
                   MOD_FSM_PARTS, MOD_EXTENDED);
    }
    m->fsm_parts += parts;
    m->extended[m->extended_count++] = *before;
}

static void log_mod(const script_mod *m, core_log_level level, const char *text) {
    core_log(level, "mod %s: %s", m->name, text);
}

void script_mod_report(script *s, lua_State *L) {
    const char *text = lua_tostring(L, -1);
    s->as_mod->errors++;
    log_mod(s->as_mod, CORE_LOG_WARN, text ? text : "error without a text");
    lua_pop(L, 1);
}

static void strike(script_mod *m) {
    if (m->guard.overtime && m->game->host.warning) {
        char text[160];
        snprintf(text, sizeof text, "nondeterministic: mod %s was stopped by the clock", m->name);
        m->game->host.warning(m->game->host.ctx, text);
    }
    if (m->guard.killed && ++m->strikes >= MOD_STRIKES) {
        m->enabled = false;
        log_mod(m, CORE_LOG_WARN, "switched off: it went over its budget again and again");
    }
}

// Every way into a mod lies between begin and finish. What the call changed is made real when it
// ended well and dropped when it did not. False: the mod is inside a call of its own, and does not
// hear what that call set off.
static bool begin_call(script_mod *m, int64_t budget) {
    if (m->guard.running) {
        return false;
    }
    m->journal_count = m->made_count = m->extended_count = 0;
    m->text_used = 0;
    m->view->phase = m->game->phase;
    m->began = core_clock_ns();
    script_guard_begin(&m->guard, budget);
    return true;
}

// The error text of a call that failed is on top of the stack, and popped.
static bool finish_call(script_mod *m, bool good) {
    lua_State *L = m->view->L;
    m->instructions += (uint64_t)script_guard_end(&m->guard);
    m->calls++;
    m->ns += core_clock_ns() - m->began;
    if (!good) {
        script_mod_report(m->view, L);
    }
    good = good && !m->guard.killed;
    if (!good) {
        lua_cpcall(L, unmake, m);
    } else if (lua_cpcall(L, apply_changes, m) != 0) {
        script_mod_report(m->view, L);
    }
    strike(m);
    return good;
}

static bool call_mod(script_mod *m, mod_call *c, int64_t budget) {
    if (!begin_call(m, budget)) {
        return false;
    }
    bool good = finish_call(m, lua_cpcall(m->view->L, run_call, c) == 0);
    lua_settop(m->view->L, 0);
    return good;
}

bool script_mod_callback(script_mod *m, uint32_t phase, int argc, int results) {
    lua_State *L = m->view->L;
    if (!m->enabled || !begin_call(m, GUARD_CALL)) {
        lua_pop(L, argc + 1);
        return false;
    }
    m->view->phase = phase;
    return finish_call(m, lua_pcall(L, argc, results, 0) == 0);
}

// ---- the gate of its bindings ----

void script_mod_size(script *s, lua_State *L, const char *what, double size, double most) {
    if (!s->as_mod) {
        return;
    }
    if (!(size <= most)) {
        bind_error(L, "a mod asks for %.0f %s at once; at most %.0f", size, what, most);
    }
    script_guard_charge(&s->as_mod->guard, (int64_t)size * 4);
}

static bool makes_object(const bind_fn *fn) {
    return fn->returns && strncmp(fn->returns->type, "corsac.", 7) == 0 &&
           (strncmp(fn->name, "new", 3) == 0 || strcmp(fn->name, "spawn") == 0);
}

static uint32_t quota_of(const char *type) {
    return strcmp(type, "Entity") == 0 || strcmp(type, "Body") == 0 ? 1000
           : strcmp(type, "Source") == 0                            ? 32
           : strcmp(type, "Cloth") == 0                             ? 8
                                                                    : 64;
}

static void append_made(mod_made **list, int *count, int *capacity, mod_made made) {
    if (*count == *capacity) {
        int more = CORE_MAX(16, 2 * *capacity);
        *list = core_realloc(*list, (size_t)*capacity * sizeof made, (size_t)more * sizeof made);
        *capacity = more;
    }
    (*list)[(*count)++] = made;
}

// Forgets what has been destroyed since: a quota is of living objects.
static void count_living(script_mod *m) {
    int living = 0;
    memset(m->owned, 0, sizeof m->owned);
    for (int i = 0; i < m->kept_count; i++) {
        const mod_made *made = &m->kept[i];
        if (made->type->alive(m->view, made->handle)) {
            m->kept[living++] = *made;
            for (int t = 0; t < m->view->type_count; t++) {
                m->owned[t] += m->view->type[t].type == made->type;
            }
        }
    }
    m->kept_count = living;
}

void script_mod_charge(script *s, lua_State *L, const bind_fn *fn) {
    script_mod *m = s->as_mod;
    script_guard_charge(&m->guard, fn->cost + 10);
    if (m->guard.killed) {
        luaL_error(L, "%s", m->guard.why);
    }
    bool line = strcmp(fn->name, "log") == 0 || strcmp(fn->name, "warn") == 0;
    if (line && ++m->log_lines > MOD_LOG_LINES) {
        bind_error(L, "a mod writes at most %d lines to the log", MOD_LOG_LINES);
    }
    for (int i = 0; makes_object(fn) && i < s->type_count; i++) {
        const char *type = s->type[i].type->name;
        if (strcmp(fn->returns->type + 7, type) != 0 || m->owned[i] < quota_of(type)) {
            continue;
        }
        count_living(m);
        if (m->owned[i] >= quota_of(type)) {
            bind_error(L, "a mod has at most %u objects of class %s at a time",
                       (unsigned)quota_of(type), type);
        }
    }
}

// Lua may free a string before the change is made.
static void keep_text(script_mod *m, lua_State *L, const char **text) {
    size_t size = *text ? strlen(*text) + 1 : 0;
    if (m->text_used + size > MOD_TEXT_BYTES) {
        bind_error(L, "one call of a mod gives at most %d KiB of text", MOD_TEXT_BYTES >> 10);
    }
    if (size > 0) {
        *text = memcpy(m->text + m->text_used, *text, size);
        m->text_used += size;
    }
}

// Arguments without pointers into the state, but for strings.
static bool stands_alone(const bind_arg *arg) {
    for (; arg && arg->name; arg++) {
        bool inside = arg->kind == BIND_OPTIONS && stands_alone(arg->fields);
        if (arg->kind >= BIND_OPTIONS && !inside) {
            return false;
        }
    }
    return true;
}

static void keep_texts(script_mod *m, lua_State *L, const bind_arg *arg, unsigned char *args) {
    for (; arg && arg->name; arg++) {
        if (arg->kind == BIND_STRING) {
            keep_text(m, L, (const char **)(void *)(args + arg->at));
        } else if (arg->kind == BIND_OPTIONS) {
            keep_texts(m, L, arg->fields, args + arg->at);
        }
    }
}

bool script_mod_defer(script *s, lua_State *L, const bind_fn *fn, const bind_type *type,
                      core_handle self, const void *args, size_t size) {
    script_mod *m = s->as_mod;
    bool simulation = (fn->phases & BIND_SIM) && !(fn->phases & (BIND_VIEW | BIND_TOP));
    if (!simulation || fn->returns || fn->immediate || size > MOD_ARGS_BYTES) {
        return false;
    }
    if (!stands_alone(fn->args)) {
        return false;
    }
    if (m->journal_count == MOD_JOURNAL_MAX) {
        bind_error(L, "one call of a mod makes at most %d changes", MOD_JOURNAL_MAX);
    }
    mod_change *c = &m->journal[m->journal_count++];
    *c = (mod_change){.fn = fn, .type = type, .self = self};
    memcpy(c->args, args, size);
    if (!fn->numbers) {
        keep_texts(m, L, fn->args, c->args);
    }
    return true;
}

void script_mod_made(script *s, lua_State *L, const bind_fn *fn) {
    script_mod *m = s->as_mod;
    if (!makes_object(fn)) {
        return;
    }
    for (int i = 0; i < s->type_count; i++) {
        core_handle h = bind_object_handle(s, L, -1, s->type[i].type);
        if (core_handle_is_null(h)) {
            continue;
        }
        mod_made made = {s->type[i].type, h};
        append_made(&m->made, &m->made_count, &m->made_capacity, made);
        append_made(&m->kept, &m->kept_count, &m->kept_capacity, made);
        m->owned[i]++;
    }
}

// ---- events ----

// Pushes hooks[when][name] of the mod, an array of functions; false when there is none.
static bool push_hooks(lua_State *L, const char *when, const char *name) {
    lua_getfield(L, LUA_REGISTRYINDEX, "corsac.hooks");
    lua_getfield(L, -1, when);
    lua_pushstring(L, name);
    lua_rawget(L, -2);
    return lua_istable(L, -1);
}

// References to the hooks are taken one by one: a hook may add hooks.
static void call_hooks(script_mod *m, const char *when, const char *name, const script_pack *args,
                       script_pack *results) {
    lua_State *L = m->view->L;
    for (int i = 1; m->enabled; i++) {
        bool found = push_hooks(L, when, name);
        if (found) {
            lua_rawgeti(L, -1, i);
            found = lua_isfunction(L, -1);
        }
        if (!found) {
            lua_settop(L, 0);
            return;
        }
        mod_call call = {m, NULL, luaL_ref(L, LUA_REGISTRYINDEX), args, results};
        lua_settop(L, 0);
        script_pack before = {0};
        if (results) { // a filter's failed call leaves the value as it was
            before = *results;
            *results = (script_pack){0};
            call.args = &before;
        }
        bool good = call_mod(m, &call, GUARD_CALL);
        luaL_unref(L, LUA_REGISTRYINDEX, call.function);
        if (results) {
            bool keep = good && results->values > 0;
            script_pack_release(keep ? &before : results);
            *results = keep ? *results : before;
        }
    }
}

void script_mods_event(script *game, const char *name, bool before, const script_pack *args) {
    for (int i = 0; i < game->mod_count; i++) {
        if (game->mods[i]->started && game->mods[i]->enabled) {
            call_hooks(game->mods[i], before ? "before" : "after", name, args, NULL);
        }
    }
}

void script_mods_filter(script *game, const char *name, script_pack *value) {
    for (int i = 0; i < game->mod_count; i++) {
        if (game->mods[i]->started && game->mods[i]->enabled) {
            call_hooks(game->mods[i], "filter", name, NULL, value);
        }
    }
}

void script_mods_tick(script *game) {
    for (int i = 0; i < game->mod_count; i++) {
        script_mod *m = game->mods[i];
        if (m->started && m->enabled && m->view->awake) {
            mod_call call = {m, NULL, m->view->tick_ref, NULL, NULL};
            call_mod(m, &call, GUARD_CALL);
        }
    }
}

// ---- life ----

static int open_mod(lua_State *L) { // the API and the prelude
    script_mod *m = lua_touserdata(L, 1);
    static const char *const parts[] = {"modbase", "tasks", "events", "containers"};
    lua_settop(L, 0);
    script_make_handler(m->view, L);
    script_push_engine(m->view, L);
    lua_setfield(L, LUA_REGISTRYINDEX, "corsac.engine");
    for (size_t i = 0; i < CORE_COUNT_OF(parts); i++) {
        if (!script_run_part(m->view, L, parts[i])) {
            lua_pushstring(L, core_last_error());
            return lua_error(L);
        }
    }
    bind_install(m->view, L, true);
    lua_getfield(L, LUA_REGISTRYINDEX, "corsac.engine");
    lua_getfield(L, -1, "tick");
    m->view->tick_ref = luaL_ref(L, LUA_REGISTRYINDEX);
    lua_pushnil(L);
    lua_setglobal(L, "coroutine");
    lua_newtable(L);
    static const char *const kinds[] = {"before", "after", "filter"};
    for (size_t i = 0; i < CORE_COUNT_OF(kinds); i++) {
        lua_newtable(L);
        lua_setfield(L, -2, kinds[i]);
    }
    lua_setfield(L, LUA_REGISTRYINDEX, "corsac.hooks");
    return 0;
}

static int load_text(lua_State *L) { // (mod, text, chunk name) -> registry reference in mod_call
    mod_call *c = lua_touserdata(L, 1);
    const char *text = lua_touserdata(L, 2), *chunk = lua_touserdata(L, 3);
    if (luaL_loadbufferx(L, text, strlen(text), chunk, "t") != 0) {
        return lua_error(L);
    }
    c->function = luaL_ref(L, LUA_REGISTRYINDEX);
    return 0;
}

// Compiles a file of the mod's folder; false with the reason logged.
static bool load_file(script_mod *m, core_vfs *files, const char *name, mod_call *out) {
    size_t size;
    char chunk[80];
    char *text = core_vfs_read(files, name, &size);
    lua_State *L = m->view->L;
    if (!text) {
        return false;
    }
    snprintf(chunk, sizeof chunk, "@%s/%s", m->name[0] ? m->name : "mod", name);
    lua_pushcfunction(L, load_text);
    lua_pushlightuserdata(L, out);
    lua_pushlightuserdata(L, text);
    lua_pushlightuserdata(L, chunk);
    bool good = lua_pcall(L, 3, 0, 0) == 0;
    core_free(text);
    if (!good) {
        core_fail("mod %s: %s", m->dir, lua_tostring(L, -1));
        lua_settop(L, 0);
    }
    out->mod = m;
    return good;
}

static bool good_name(const char *name) {
    size_t n = strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_-");
    return n > 0 && n < 48 && name[n] == 0;
}

typedef struct manifest {
    const char *name, *version;
    double order;
    int dependencies;
} manifest;
static const bind_arg manifest_fields[] = {
    {"name", BIND_STRING, BIND_AT(manifest, name), "lower-case letters, digits, - and _"},
    {"version", BIND_STRING, BIND_AT(manifest, version), "", .optional = true, .def_text = "0"},
    {"order", BIND_NUMBER, BIND_AT(manifest, order), "lower ones first", .optional = true},
    {"dependencies", BIND_TABLE, BIND_AT(manifest, dependencies), "names", .optional = true},
    {0}};

typedef struct manifest_call {
    script_mod *mod;
    const script_pack *result;
} manifest_call;

// Reads what mod.lua returned.
static int read_manifest(lua_State *L) {
    const manifest_call *c = lua_touserdata(L, 1);
    script_mod *m = c->mod;
    lua_settop(L, 0);
    script_unpack(m->view, L, c->result);
    if (!lua_istable(L, 1)) {
        return luaL_error(L, "mod.lua: expected to return a table with a name");
    }
    manifest v = {0};
    bind_check_table(m->view, L, 1, "mod.lua", "table", manifest_fields, &v);
    if (!good_name(v.name) || strlen(v.version) >= sizeof m->version) {
        return luaL_error(L,
                          "mod.lua: name \"%s\": lower-case letters, digits, - and _ (at most 47), "
                          "and a version of at most 23 characters",
                          v.name);
    }
    snprintf(m->name, sizeof m->name, "%s", v.name);
    snprintf(m->version, sizeof m->version, "%s", v.version);
    m->order = v.order;
    for (int i = 1; v.dependencies && i <= (int)lua_objlen(L, v.dependencies); i++) {
        lua_rawgeti(L, v.dependencies, i);
        const char *name = lua_tostring(L, -1);
        if (!name || !good_name(name) || m->dependency_count == 8) {
            return luaL_error(L, "mod.lua: dependencies: expected at most 8 names of mods");
        }
        snprintf(m->dependency[m->dependency_count++], 48, "%s", name);
        lua_pop(L, 1);
    }
    return 0;
}

static bool run_manifest(script_mod *m, core_vfs *files) {
    mod_call call = {0};
    script_pack result = {0};
    call.results = &result;
    if (!load_file(m, files, "mod.lua", &call)) {
        return false;
    }
    lua_State *L = m->view->L;
    bool good = call_mod(m, &call, GUARD_START);
    luaL_unref(L, LUA_REGISTRYINDEX, call.function);
    if (good) {
        manifest_call read = {m, &result};
        good = lua_cpcall(L, read_manifest, &read) == 0 ||
               core_fail("mod %s: %s", m->dir, lua_tostring(L, -1));
    }
    lua_settop(L, 0);
    script_pack_release(&result);
    return good;
}

static void destroy_mod(script_mod *m) {
    if (m->view) {
        if (m->view->L) {
            lua_close(m->view->L);
        }
        core_free(m->view);
    }
    core_free(m->journal);
    core_free(m->text);
    core_free(m->made);
    core_free(m->kept);
    core_free(m);
}

bool script_add_mod(script *game, const char *dir) {
    if (game->mod_count == SCRIPT_MODS_MAX) {
        return core_fail("mod %s: at most %d mods", dir, SCRIPT_MODS_MAX);
    }
    core_vfs *files = core_vfs_create();
    script_mod *m = core_alloc(sizeof *m);
    m->game = game;
    m->index = game->mod_count;
    m->enabled = true;
    snprintf(m->dir, sizeof m->dir, "%s", dir);
    m->journal = core_alloc(MOD_JOURNAL_MAX * sizeof *m->journal);
    m->text = core_alloc(MOD_TEXT_BYTES);
    m->view = core_alloc(sizeof *m->view);
    m->view->scene = game->scene;
    m->view->as_mod = m;
    m->view->headless = game->headless;
    m->view->keep_going = true; // strikes switch a mod off, single errors do not
    m->view->phase = BIND_TOP;
    bool good = core_vfs_mount(files, dir, "", false);
    m->view->L = good ? script_guard_state(&m->guard) : NULL;
    good = m->view->L && (lua_cpcall(m->view->L, open_mod, m) == 0 ||
                          core_fail("mod %s: %s", dir, lua_tostring(m->view->L, -1)));
    good = good && run_manifest(m, files);
    for (int i = 0; good && i < game->mod_count; i++) {
        good = strcmp(game->mods[i]->name, m->name) != 0 ||
               core_fail("mod %s: another mod is named \"%s\"", dir, m->name);
    }
    good = good && script_mod_check_assets(m);
    core_vfs_destroy(files);
    if (!good) {
        destroy_mod(m);
        return false;
    }
    game->mods[game->mod_count++] = m;
    return true;
}

static int compare_mods(const void *pa, const void *pb) {
    const script_mod *a = *(script_mod *const *)pa, *b = *(script_mod *const *)pb;
    if (a->order != b->order) {
        return a->order < b->order ? -1 : 1;
    }
    return strcmp(a->name, b->name);
}

static script_mod *find_mod(script *game, const char *name) {
    for (int i = 0; i < game->mod_count; i++) {
        if (strcmp(game->mods[i]->name, name) == 0) {
            return game->mods[i];
        }
    }
    return NULL;
}

// The first mod from `at` on whose dependencies stand before it moves to `at`.
static bool place_next(script *game, int at) {
    for (int i = at; i < game->mod_count; i++) {
        script_mod *m = game->mods[i];
        bool ready = true;
        for (int d = 0; d < m->dependency_count; d++) {
            bool before = false;
            for (int k = 0; k < at; k++) {
                before = before || strcmp(game->mods[k]->name, m->dependency[d]) == 0;
            }
            ready = ready && before;
        }
        if (ready) {
            memmove(&game->mods[at + 1], &game->mods[at], (size_t)(i - at) * sizeof m);
            game->mods[at] = m;
            return true;
        }
    }
    return false;
}

static void drop_unplaced(script *game, int from) {
    for (int i = from; i < game->mod_count; i++) {
        script_mod *m = game->mods[i];
        const char *missing = m->dependency[0];
        for (int d = 0; d < m->dependency_count; d++) {
            missing = find_mod(game, m->dependency[d]) ? missing : m->dependency[d];
        }
        core_log(CORE_LOG_WARN, "mod %s: left out; it needs the mod \"%s\"", m->name, missing);
    }
    while (game->mod_count > from) {
        destroy_mod(game->mods[--game->mod_count]);
    }
}

void script_mods_start(script *game) {
    qsort(game->mods, (size_t)game->mod_count, sizeof game->mods[0], compare_mods);
    int placed = 0;
    while (placed < game->mod_count && place_next(game, placed)) {
        placed++;
    }
    drop_unplaced(game, placed);
    for (int i = 0; i < game->mod_count; i++) {
        script_mod *m = game->mods[i];
        mod_call call = {0};
        core_vfs *files = core_vfs_create();
        m->index = i;
        m->rng = core_rng_make(game->seed, CORE_RNG_MOD + (uint64_t)i);
        m->view->seed = game->seed;
        m->started = script_mod_mount_assets(m) && core_vfs_mount(files, m->dir, "", false) &&
                     load_file(m, files, "main.lua", &call);
        if (m->started) {
            call_mod(m, &call, GUARD_START);
            luaL_unref(m->view->L, LUA_REGISTRYINDEX, call.function);
        }
        core_vfs_destroy(files);
    }
}

void script_mods_destroy(script *game) {
    while (game->mod_count > 0) {
        destroy_mod(game->mods[--game->mod_count]);
    }
}

int script_mods_info(const script *game, script_mod_info *out, int capacity) {
    for (int i = 0; i < game->mod_count && i < capacity; i++) {
        const script_mod *m = game->mods[i];
        out[i] = (script_mod_info){.enabled = m->enabled,
                                   .calls = m->calls,
                                   .instructions = m->instructions,
                                   .errors = (uint32_t)m->errors,
                                   .bytes = m->guard.bytes,
                                   .ms = (double)m->ns * 1e-6};
        memcpy(out[i].name, m->name, sizeof m->name);
        memcpy(out[i].version, m->version, sizeof m->version);
    }
    return game->mod_count;
}
