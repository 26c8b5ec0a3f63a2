// A scene of the run: made, configured, loaded; closed with its expectations.
#include "app/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/nearest.h"

#define DEFAULT_SEED  12345u
#define DEFAULT_STEPS 600u

static bool script_failed(app_run *r) {
    // In a window the error screen shows it and a key loads the scene again.
    return r->opt->headless && !r->opt->keep_going ? app_fail(r, APP_EXIT_SCRIPT) : true;
}

// Command line > conf > default.
static bool configure(app_run *r) {
    const script_conf *conf = &r->conf;
    bool given = r->opt->has_seed || r->replay;
    uint64_t seed = given ? r->start.seed : conf->has_seed ? conf->seed : DEFAULT_SEED;
    double dt = r->start.dt > 0 ? r->start.dt : conf->dt > 0 ? conf->dt : 1.0 / 60.0;
    uint64_t threads = r->opt->has_threads ? r->opt->threads : (uint64_t)CORE_MAX(conf->threads, 0);
    if (threads > CORE_JOBS_MAX_THREADS) {
        core_fail("conf: threads is %llu, expected at most %d", (unsigned long long)threads,
                  CORE_JOBS_MAX_THREADS);
        return app_fail(r, APP_EXIT_SCRIPT);
    }
    if (!r->jobs) {
        r->jobs = core_jobs_create((int)threads);
        if (!r->jobs) {
            return app_fail(r, APP_EXIT_ENVIRONMENT);
        }
    }
    if (!scene_configure(r->scene, r->jobs, seed, (float)dt)) {
        return app_fail(r, r->opt->dt > 0 ? APP_EXIT_USAGE : APP_EXIT_SCRIPT);
    }
    r->width = r->start.width ? r->start.width : conf->width ? conf->width : 1280;
    r->height = r->start.height ? r->start.height : conf->height ? conf->height : 720;
    r->start.seed = r->report.seed = seed;
    r->start.dt = dt;
    r->report.dt = dt;
    r->report.threads = core_jobs_threads(r->jobs);
    return true;
}

void app_end_of_run(app_run *r) {
    const app_options *o = r->opt;
    uint64_t limit = o->headless ? (r->conf.steps ? r->conf.steps : DEFAULT_STEPS) : APP_OPEN_END;
    if (o->has_steps) {
        limit = o->steps;
    } else if (o->seconds > 0) {
        limit = (uint64_t)ceil(o->seconds / r->start.dt - 1e-9);
    } else if (r->replay) {
        limit = APP_OPEN_END;
    }
    r->last_step = r->replay ? CORE_MIN(limit, app_replay_steps(r->replay)) : limit;
}

static bool apply_setting(app_run *r, const char *name, const char *value) {
    if (strcmp(name, "metrics.accuracy") == 0) {
        r->report.accuracy_off = strcmp(value, "off") == 0;
        return r->report.accuracy_off || strcmp(value, "on") == 0 ||
               core_fail("setting metrics.accuracy is '%s', expected on or off", value);
    }
    if (strncmp(name, "actions.", 8) == 0) {
        return app_input_bind(&r->input, name + 8, value) || core_fail("%s", core_last_error());
    }
    if (strcmp(name, "input.dead_zone") == 0) {
        char *end;
        r->input.dead_zone = strtof(value, &end);
        return (end != value && !*end && r->input.dead_zone >= 0 && r->input.dead_zone <= 0.9f) ||
               core_fail("setting input.dead_zone is '%s', expected 0 to 0.9", value);
    }
    return scene_setting(r->scene, name, value);
}

static bool apply_settings(app_run *r) {
    for (uint32_t i = 0; i < r->conf.setting_count; i++) {
        if (!apply_setting(r, r->conf.setting_name[i], r->conf.setting_value[i])) {
            return app_fail(r, APP_EXIT_SCRIPT);
        }
    }
    if (r->conf.render[0] && !scene_setting(r->scene, "gfx.render", r->conf.render)) {
        return app_fail(r, APP_EXIT_SCRIPT);
    }
    if (r->opt->render && !scene_setting(r->scene, "gfx.render", r->opt->render)) {
        return app_fail(r, APP_EXIT_USAGE);
    }
    for (uint32_t i = 0; i < r->start.set_count; i++) {
        const app_set *set = &r->start.set[i];
        if (strchr(set->name, '.') && !apply_setting(r, set->name, set->value)) {
            return app_fail(r, APP_EXIT_USAGE);
        }
    }
    return true;
}

// Parameters that nobody asked for are misspelt: saying so beats running the default.
static bool params_declared(app_run *r) {
    const char *names[APP_MAX_PARAMS];
    for (uint32_t i = 0; i < r->param_count; i++) {
        names[i] = r->param[i];
    }
    for (uint32_t i = 0; i < r->start.set_count; i++) {
        const char *name = r->start.set[i].name;
        if (strchr(name, '.') || script_param_declared(r->script, name)) {
            continue;
        }
        const char *near = core_nearest(name, names, r->param_count);
        core_fail("%s has no parameter '%s' (--set %s=%s)%s%s%s", r->entry, name, name,
                  r->start.set[i].value, near ? ", did you mean '" : "", near ? near : "",
                  near ? "'?" : "");
        return app_fail(r, APP_EXIT_USAGE);
    }
    return true;
}

static void hook_fixed(void *ctx, float dt) { script_fixed(((app_run *)ctx)->script, dt); }

static void hook_events(void *ctx) { script_step_events(((app_run *)ctx)->script); }

static bool make_scene(app_run *r) {
    scene_desc desc = scene_desc_default();
    desc.metrics = r->metrics;
    desc.vfs = r->vfs;
    r->scene = scene_create(&desc);
    if (!r->scene) {
        return app_fail(r, APP_EXIT_ENVIRONMENT);
    }
    scene_set_hooks(r->scene, &(scene_hooks){.ctx = r, .fixed = hook_fixed, .events = hook_events});
    for (uint32_t i = 0; i < r->start.argument_count; i++) {
        r->argument[i] = r->start.argument[i];
    }
    script_desc made = script_desc_default();
    r->host = app_host(r);
    made.scene = r->scene;
    made.host = &r->host;
    made.headless = r->start.headless;
    made.keep_going = r->opt->keep_going;
    made.argc = (int)r->start.argument_count;
    made.argv = r->argument;
    made.data = r->run_data;
    r->script = script_create(&made);
    return r->script || app_fail(r, APP_EXIT_ENVIRONMENT);
}

bool app_scene_open(app_run *r) {
    if (!make_scene(r)) {
        return false;
    }
    r->conf = (script_conf){0};
    app_report_new_scene(&r->report);
    bool first = strcmp(r->entry, r->path.entry) == 0;
    bool loaded = !(first && r->path.has_conf) || script_load_file(r->script, "conf.lua", &r->conf);
    loaded = loaded && script_load_file(r->script, r->entry, &r->conf);
    if (!loaded && !script_failed(r)) {
        return false;
    }
    if (!configure(r) || !apply_settings(r)) {
        return false;
    }
    for (uint32_t i = 0; i < r->mod_count; i++) {
        if (!script_add_mod(r->script, r->mod[i])) {
            return app_fail(r, APP_EXIT_USAGE);
        }
    }
    if (loaded && !script_load(r->script) && !script_failed(r)) {
        return false;
    }
    return !loaded || script_error_count(r->script) || params_declared(r);
}

static void keep_run_data(app_run *r) {
    const char *data = script_run_data(r->script);
    core_free(r->run_data);
    r->run_data = data ? core_alloc(strlen(data) + 1) : NULL;
    if (data) {
        strcpy(r->run_data, data);
    }
}

// What the scene leaves in the exit code. One that is loaded again has another chance.
static void judge(app_run *r) {
    if (r->reload) {
        return;
    }
    if (script_error_count(r->script)) {
        app_fail(r, APP_EXIT_SCRIPT);
    } else if (r->failed == APP_EXIT_FINE) {
        r->expectations_missed += script_check_expectations(r->script);
    }
}

void app_scene_close(app_run *r) {
    if (r->script) {
        script_quit(r->script);
        keep_run_data(r);
        if (r->sampled_at != r->report.steps) {
            app_report_sample(&r->report, r->scene);
            r->sampled_at = r->report.steps;
        }
        app_report_finish(&r->report, r->scene, r->script);
        judge(r);
        script_destroy(r->script);
    }
    app_sound_leave_scene(&r->sound);
    if (r->scene) {
        r->report.hash = scene_hash(r->scene);
        scene_destroy(r->scene);
    }
    r->script = NULL;
    r->scene = NULL;
}
