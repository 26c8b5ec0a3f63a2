// A script with a scene and a host of its own, for the tests of this room. Each test program
// includes it once.
#ifndef TESTS_SCRIPT_WORLD_H
#define TESTS_SCRIPT_WORLD_H

#include "core/log.h"
#include "script/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct world {
    core_vfs *vfs;
    core_metrics *metrics;
    scene *scene;
    script *script;
    lua_State *L;
    double user; // last value of corsac.metrics.set
    int exit_code;
    char run_path[64];
} world;

static const char *param(void *ctx, const char *name) {
    (void)ctx;
    return strcmp(name, "given") == 0 ? "7.5" : strcmp(name, "wrong") == 0 ? "7x" : NULL;
}
static void exit_run(void *ctx, int code) { ((world *)ctx)->exit_code = code; }
static bool run(void *ctx, const char *path) {
    world *w = ctx;
    snprintf(w->run_path, sizeof w->run_path, "%s", path);
    return true;
}
static void user_metric(void *ctx, const char *name, double value) {
    (void)name;
    ((world *)ctx)->user = value;
}
static double metric(void *ctx, const char *path, bool *known) {
    *known = strcmp(path, "accuracy.nan") == 0 || strcmp(path, "user.score") == 0;
    return strcmp(path, "user.score") == 0 ? ((world *)ctx)->user : 0;
}
static bool input_down(void *ctx, const char *name, bool *known) {
    (void)ctx;
    *known = strcmp(name, "space") == 0;
    return *known;
}
static float input_axis(void *ctx, const char *name, bool *known) {
    (void)ctx;
    *known = strcmp(name, "mousex") == 0;
    return 0.5f;
}

static const char folder[] = "build/test-tmp/script";

// Its files are those of a folder under build/.
__attribute__((unused)) static void world_open(world *w) {
    *w = (world){.exit_code = -1};
    core_log_set_level(CORE_LOG_ERROR + 1);
    mkdir("build", 0777);
    mkdir("build/test-tmp", 0777);
    mkdir(folder, 0777);
    w->vfs = core_vfs_create();
    core_vfs_mount(w->vfs, folder, "", true);
    w->metrics = core_metrics_create();
    scene_desc scene_options = scene_desc_default();
    scene_options.vfs = w->vfs;
    scene_options.metrics = w->metrics;
    scene_options.seed = 12345;
    w->scene = scene_create(&scene_options);
    script_host host = {.ctx = w,
                        .param = param,
                        .exit = exit_run,
                        .run = run,
                        .user_metric = user_metric,
                        .metric = metric,
                        .input_down = input_down,
                        .input_axis = input_axis};
    script_desc options = script_desc_default();
    options.scene = w->scene;
    options.host = &host;
    options.headless = true;
    w->script = script_create(&options);
    if (!w->script) {
        fprintf(stderr, "%s\n", core_last_error());
        abort();
    }
    w->L = w->script->L;
}

__attribute__((unused)) static void world_close(world *w) {
    script_destroy(w->script);
    scene_destroy(w->scene);
    core_metrics_destroy(w->metrics);
    core_vfs_destroy(w->vfs);
}

// Runs a text as the scene's file, then corsac.load.
__attribute__((unused)) static bool world_run(world *w, const char *text) {
    script_conf conf;
    core_vfs_write(w->vfs, "scene.lua", text, strlen(text));
    return script_load_file(w->script, "scene.lua", &conf) && script_load(w->script);
}

// Runs a text in a phase and gives its error text, "" when it went well. Valid until the next call.
__attribute__((unused)) static const char *world_error(world *w, unsigned phase, const char *text) {
    static char error[2048];
    unsigned before = w->script->phase;
    error[0] = 0;
    w->script->phase = phase;
    if (luaL_loadbuffer(w->L, text, strlen(text), "@test.lua") || lua_pcall(w->L, 0, 0, 0)) {
        snprintf(error, sizeof error, "%s", lua_tostring(w->L, -1));
        lua_pop(w->L, 1);
    }
    w->script->phase = before;
    return error;
}

#endif
