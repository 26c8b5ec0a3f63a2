// corsac.*: parameters, expectations, metrics, log, the loop.
#include "core/log.h"
#include "script/internal.h"
#include "script/json.h"
#include "script/mod.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- parameters and settings ----

typedef struct param_args {
    const char *name;
    int value;
} param_args;

static void declare_param(script *s, lua_State *L, const char *name) {
    if (script_param_declared(s, name)) {
        return;
    }
    if (s->param_count == SCRIPT_PARAM_MAX || strlen(name) >= sizeof s->param[0]) {
        bind_error(L, "corsac.param: at most %d parameters with names of at most %d characters",
                   SCRIPT_PARAM_MAX, (int)sizeof s->param[0] - 1);
    }
    snprintf(s->param[s->param_count++], sizeof s->param[0], "%s", name);
}

static int param(script *s, lua_State *L, void *args) {
    const param_args *a = args;
    if (strchr(a->name, '.')) {
        bind_error(L,
                   "corsac.param: \"%s\" has a dot, which is how settings are named (corsac.set)",
                   a->name);
    }
    declare_param(s, L, a->name);
    const char *text = s->host.param ? s->host.param(s->host.ctx, a->name) : NULL;
    if (!text) {
        lua_pushvalue(L, a->value);
        return 1;
    }
    switch (lua_type(L, a->value)) {
    case LUA_TNUMBER: {
        char *end;
        double v = strtod(text, &end);
        if (*text == 0 || *end != 0 || !isfinite(v)) {
            bind_error(L, "--set %s=%s: expected a number, as the default %.14g is", a->name, text,
                       lua_tonumber(L, a->value));
        }
        lua_pushnumber(L, v);
        return 1;
    }
    case LUA_TBOOLEAN:
        if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0) {
            bind_error(L, "--set %s=%s: expected true or false", a->name, text);
        }
        lua_pushboolean(L, text[0] == 't');
        return 1;
    case LUA_TSTRING:
        lua_pushstring(L, text);
        return 1;
    default:
        bind_error(L,
                   "corsac.param: the default of \"%s\" is a %s; expected a number, true or "
                   "false, or a string",
                   a->name, luaL_typename(L, a->value));
    }
}

typedef struct set_args {
    const char *name;
    int value;
} set_args;

static int set(script *s, lua_State *L, void *args) {
    const set_args *a = args;
    int type = lua_type(L, a->value);
    if (type == LUA_TBOOLEAN) {
        lua_pushstring(L, lua_toboolean(L, a->value) ? "true" : "false");
    } else if (type == LUA_TNUMBER || type == LUA_TSTRING) {
        lua_pushvalue(L, a->value);
    } else {
        bind_error(L,
                   "corsac.set: the value of \"%s\" is a %s; expected a number, string, true or "
                   "false",
                   a->name, luaL_typename(L, a->value));
    }
    if (!scene_setting(s->scene, a->name, lua_tostring(L, -1))) {
        bind_fail(L);
    }
    return 0;
}

// ---- expectations and metrics ----

typedef struct expect_args {
    const char *metric;
    int op;
    double value;
} expect_args;

static double read_metric(script *s, lua_State *L, const char *owner, const char *name) {
    bool known = false;
    double value = s->host.metric ? s->host.metric(s->host.ctx, name, &known) : 0;
    if (!known) {
        bind_error(L,
                   "%s: no metric \"%s\" (names are those of the metrics file, with dots: "
                   "\"accuracy.nan\", \"user.score\")",
                   owner, name);
    }
    return value;
}

static int expect(script *s, lua_State *L, void *args) {
    const expect_args *a = args;
    script_expect *e = &s->expect[s->expect_count];
    if (s->expect_count == SCRIPT_EXPECT_MAX || strlen(a->metric) >= sizeof e->metric) {
        bind_error(L, "corsac.expect: at most %d expectations with names of at most %d characters",
                   SCRIPT_EXPECT_MAX, (int)sizeof e->metric - 1);
    }
    if (strncmp(a->metric, "user.", 5) != 0) {
        read_metric(s, L, "corsac.expect", a->metric);
    }
    *e = (script_expect){.op = (script_op)a->op, .value = a->value};
    snprintf(e->metric, sizeof e->metric, "%s", a->metric);
    bind_push_where(L);
    snprintf(e->where, sizeof e->where, "%s", lua_tostring(L, -1));
    s->expect_count++;
    return 0;
}

static int expect_now(script *s, lua_State *L, void *args) {
    const expect_args *a = args;
    double value = read_metric(s, L, "corsac.expect.now", a->metric);
    if (!script_compare(value, (script_op)a->op, a->value)) {
        // Recorded as one that cannot come true any more: the run ends with exit code 3.
        bool room = s->expect_count < SCRIPT_EXPECT_MAX;
        if (room) {
            script_expect *e = &s->expect[s->expect_count++];
            *e = (script_expect){
                .op = (script_op)a->op, .value = a->value, .missed = true, .found = value};
            snprintf(e->metric, sizeof e->metric, "%s", a->metric);
            bind_push_where(L);
            snprintf(e->where, sizeof e->where, "%sstep %u: ", lua_tostring(L, -1),
                     (unsigned)scene_step_index(s->scene));
        }
    }
    return 0;
}

typedef struct metric_args {
    const char *name;
    double value;
} metric_args;

static int metrics_set(script *s, lua_State *L, void *args) {
    const metric_args *a = args;
    (void)L;
    if (s->host.user_metric) {
        s->host.user_metric(s->host.ctx, a->name, a->value);
    }
    return 0;
}

static int metrics_get(script *s, lua_State *L, void *args) {
    const metric_args *a = args;
    lua_pushnumber(L, read_metric(s, L, "corsac.metrics.get", a->name));
    return 1;
}

// ---- log ----

typedef struct rest_args {
    int first;
} rest_args;

static const char *join(lua_State *L, int first) {
    int last = lua_gettop(L);
    luaL_Buffer text;
    lua_getglobal(L, "tostring");
    int to_string = lua_gettop(L);
    luaL_buffinit(L, &text);
    for (int i = first; i <= last; i++) {
        lua_pushvalue(L, to_string);
        lua_pushvalue(L, i);
        lua_call(L, 1, 1);
        luaL_addvalue(&text);
        if (i < last) {
            luaL_addlstring(&text, " ", 1);
        }
    }
    luaL_pushresult(&text);
    return lua_tostring(L, -1);
}

static int log_line(script *s, lua_State *L, void *args) {
    const char *text = join(L, ((rest_args *)args)->first);
    if (s->as_mod) {
        core_log(CORE_LOG_INFO, "mod %s: %s", s->as_mod->name, text);
    } else {
        core_log(CORE_LOG_INFO, "%s", text);
    }
    return 0;
}

static int warn(script *s, lua_State *L, void *args) {
    const char *text = join(L, ((rest_args *)args)->first);
    if (s->as_mod) {
        core_log(CORE_LOG_WARN, "mod %s: %s", s->as_mod->name, text);
        return 0;
    }
    core_log(CORE_LOG_WARN, "%s", text);
    if (s->host.warning) {
        s->host.warning(s->host.ctx, text);
    }
    return 0;
}

// ---- the loop ----

typedef struct exit_args {
    int64_t code;
} exit_args;
static int quit_run(script *s, lua_State *L, void *args) {
    (void)L;
    if (s->host.exit) {
        s->host.exit(s->host.ctx, (int)((exit_args *)args)->code);
    }
    return 0;
}

typedef struct run_args {
    const char *path;
    int data;
} run_args;
static int run(script *s, lua_State *L, void *args) {
    const run_args *a = args;
    core_free(s->run_data);
    s->run_data = NULL;
    if (a->data) {
        s->run_data = script_json_write(L, a->data, "corsac.run: data");
    }
    if (!s->host.run || !s->host.run(s->host.ctx, a->path)) {
        bind_fail(L);
    }
    return 0;
}

typedef struct pause_args {
    bool on;
} pause_args;
static int set_paused(script *s, lua_State *L, void *args) {
    (void)L;
    if (s->host.pause) {
        s->host.pause(s->host.ctx, ((pause_args *)args)->on);
    }
    return 0;
}

typedef struct scale_args {
    float scale;
} scale_args;
static int set_time_scale(script *s, lua_State *L, void *args) {
    (void)L;
    if (s->host.time_scale) {
        s->host.time_scale(s->host.ctx, ((scale_args *)args)->scale);
    }
    return 0;
}

static int get_time(script *s, lua_State *L, void *args) {
    (void)args;
    lua_pushnumber(L, s->time);
    return 1;
}
static int get_step(script *s, lua_State *L, void *args) {
    (void)args;
    lua_pushnumber(L, (double)scene_step_index(s->scene));
    return 1;
}
static int get_dt(script *s, lua_State *L, void *args) {
    (void)args;
    lua_pushnumber(L, (double)scene_dt(s->scene));
    return 1;
}
static int get_seed(script *s, lua_State *L, void *args) {
    (void)args;
    lua_pushnumber(L, (double)s->seed);
    return 1;
}
static int is_headless(script *s, lua_State *L, void *args) {
    (void)args;
    lua_pushboolean(L, s->headless);
    return 1;
}

#define EXPECT_ARGS                                                                                \
    BIND_ARGS({"metric", BIND_STRING, BIND_AT(expect_args, metric),                                \
               "name in the metrics file, with dots"},                                             \
              {"op", BIND_ENUM, BIND_AT(expect_args, op), "comparison", .values = SCRIPT_OPS},     \
              {"value", BIND_NUMBER, BIND_AT(expect_args, value), "bound"})

static const bind_fn root_functions[] = {
    {"param", "A parameter of the scene: its default, or what --set NAME=VALUE gave.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(param_args, name), "without a dot"},
               {"default", BIND_VALUE, BIND_AT(param_args, value),
                "number, boolean or string; decides the type"}),
     BIND_RETURNS({"value", "any", NULL}), sizeof(param_args), BIND_TOP | BIND_CONF | BIND_LOAD,
     .run = param},
    {"set", "Changes a setting of a room, as --set ROOM.NAME=VALUE does.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(set_args, name), "room, dot, name: \"phys.solver\""},
               {"value", BIND_VALUE, BIND_AT(set_args, value), "number, boolean or string"}),
     NULL, sizeof(set_args), BIND_SIM, .run = set},
    {"log", "Writes a line to the log (stderr); arguments are joined by spaces.",
     BIND_ARGS({"...", BIND_REST, BIND_AT(rest_args, first), "any values"}), NULL,
     sizeof(rest_args), BIND_ANY, .mod = true, .cost = 200, .run = log_line},
    {"warn", "As log, and the line stands in `warnings` of the metrics.",
     BIND_ARGS({"...", BIND_REST, BIND_AT(rest_args, first), "any values"}), NULL,
     sizeof(rest_args), BIND_ANY, .mod = true, .cost = 200, .run = warn},
    {"exit", "Ends the run after this callback.",
     BIND_ARGS({"code", BIND_INT, BIND_AT(exit_args, code), "exit code", .range = BIND_BETWEEN,
                .max = 125, .optional = true}),
     NULL, sizeof(exit_args), BIND_ANY, .run = quit_run},
    {"run", "Changes to another scene at the next step boundary.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(run_args, path), "scene file or game folder"},
               {"data", BIND_TABLE, BIND_AT(run_args, data),
                "plain data; the next scene finds it in corsac.getRunData()", .optional = true}),
     NULL, sizeof(run_args), BIND_RUNNING, .run = run},
    {"setPaused", "Stops or resumes the steps; update and draw go on.",
     BIND_ARGS({"paused", BIND_BOOL, BIND_AT(pause_args, on), "true: no more steps"}), NULL,
     sizeof(pause_args), BIND_RUNNING, .run = set_paused},
    {"setTimeScale", "Speed of the loop against real time; the step itself keeps its length.",
     BIND_ARGS({"scale", BIND_FLOAT, BIND_AT(scale_args, scale), "1: real time",
                .range = BIND_BETWEEN, .max = 100}),
     NULL, sizeof(scale_args), BIND_RUNNING, .run = set_time_scale},
    {"getTime", "Simulated time since the start.", NULL, BIND_RETURNS({"time", "number", "s"}), 0,
     BIND_ANY, .mod = true, .cost = 2, .run = get_time},
    {"getStep", "Steps done since the start.", NULL, BIND_RETURNS({"step", "integer", NULL}), 0,
     BIND_ANY, .mod = true, .cost = 2, .run = get_step},
    {"getDt", "Length of a step.", NULL, BIND_RETURNS({"dt", "number", "s"}), 0, BIND_ANY,
     .mod = true, .cost = 2, .run = get_dt},
    {"getSeed", "Seed of the run (--seed).", NULL, BIND_RETURNS({"seed", "integer", NULL}), 0,
     BIND_RUNNING, .run = get_seed},
    {"isHeadless", "Whether the run has no window.", NULL,
     BIND_RETURNS({"headless", "boolean", NULL}), 0, BIND_VIEW | BIND_QUIT, .run = is_headless},
    {0}};

static const bind_fn expect_functions[] = {
    {"", "Registers a check for the end of the run; one that falls short makes exit code 3.",
     EXPECT_ARGS, NULL, sizeof(expect_args), BIND_ANY & ~(unsigned)BIND_CONF, .run = expect},
    {"now", "Checks a metric of the present step; if it falls short the run ends with exit code 3.",
     EXPECT_ARGS, NULL, sizeof(expect_args), BIND_RUNNING, .run = expect_now},
    {0}};

static const bind_fn metrics_functions[] = {
    {"set", "Sets a figure of your own: `user.NAME` in the metrics.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(metric_args, name), "letters, digits, _"},
               {"value", BIND_NUMBER, BIND_AT(metric_args, value), "the figure"}),
     NULL, sizeof(metric_args), BIND_ANY, .run = metrics_set},
    {"get", "A figure of the metrics by its name with dots, \"counts.bodies\".",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(metric_args, name), "name in the metrics file"}),
     BIND_RETURNS({"value", "number", NULL}), sizeof(metric_args), BIND_VIEW | BIND_QUIT,
     .run = metrics_get},
    {0}};

static const bind_module modules[] = {
    {"corsac", "The run: parameters, time, log.", root_functions},
    {"corsac.expect", "Checks that make a scene a test.", expect_functions},
    {"corsac.metrics", "The run's figures.", metrics_functions},
    {0}};

const bind_room bind_core_room = {"core", modules, NULL};
