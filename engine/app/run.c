// `corsac run`: from the command line to the exit code.
#include "app/run.h"
#include "app/commands.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/hash.h"
#include "core/log.h"
#include "core/nearest.h"
#include "core/simd.h"

#define DEFAULT_SEED  12345u
#define DEFAULT_STEPS 600u

// The two things of a process that C hands to handlers without a context.
static volatile sig_atomic_t interrupted;
static app_report *assert_report;

static void on_interrupt(int signal_number) {
    (void)signal_number;
    interrupted = 1;
}

static void on_assert(const char *expr, const char *file, int line) {
    char text[256];
    snprintf(text, sizeof text, "%s:%d: %s", file, line, expr);
    core_log(CORE_LOG_ERROR, "assert failed: %s", text);
    app_text_list_add(&assert_report->asserts, text);
}

static void on_log(void *ctx, core_log_level level, const char *text) {
    if (level == CORE_LOG_WARN) {
        app_text_list_add(&((app_report *)ctx)->warnings, text);
    }
}

bool app_interrupted(void) { return interrupted != 0; }

bool app_fail(app_run *r, app_exit why) {
    if (r->failed == APP_EXIT_FINE) {
        r->failed = why;
    }
    return false;
}

// ---- before the run ----

static bool outputs_ready(const app_options *o) {
    const char *files[] = {strcmp(o->metrics ? o->metrics : "-", "-") ? o->metrics : NULL,
                           o->metrics_csv, o->trace, o->record, o->audio};
    char path[APP_PATH_MAX];
    for (size_t i = 0; i < CORE_COUNT_OF(files); i++) {
        if (files[i] && !app_output_ready(files[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < o->shot_count; i++) {
        snprintf(path, sizeof path, "%.*s", (int)o->shot[i].path_length, o->shot[i].path);
        if (!app_output_ready(path)) {
            return false;
        }
    }
    snprintf(path, sizeof path, "%s/frame-000001.png", o->video ? o->video : "");
    return !o->video || app_output_ready(path);
}

static bool choose_simd(app_run *r) {
    const char *name = r->opt->simd;
    for (int set = 0; name && set < CORE_SIMD_SETS; set++) {
        if (strcmp(name, core_simd_name((core_simd_set)set)) == 0) {
            return core_simd_use((core_simd_set)set) || app_fail(r, APP_EXIT_ENVIRONMENT);
        }
    }
    return true;
}

static bool mount_files(app_run *r) {
    char home[APP_PATH_MAX], assets[APP_PATH_MAX + 16];
    r->vfs = core_vfs_create();
    if (app_home(home, sizeof home)) {
        snprintf(assets, sizeof assets, "%s/assets", home);
        if (!core_vfs_mount(r->vfs, assets, "", false)) {
            return app_fail(r, APP_EXIT_ENVIRONMENT);
        }
    }
    return core_vfs_mount(r->vfs, r->path.folder, "", false) || app_fail(r, APP_EXIT_USAGE);
}

// What the run starts with: from the recording, else from the command line.
static bool start_of(app_run *r) {
    const app_options *o = r->opt;
    if (o->replay) {
        r->replay = app_replay_open(o->replay);
        if (!r->replay) {
            return app_fail(r, APP_EXIT_USAGE);
        }
        r->start = *app_replay_header(r->replay);
        return true;
    }
    app_journal_header *h = &r->start;
    snprintf(h->scene, sizeof h->scene, "%s", o->scene);
    h->seed = o->seed;
    h->dt = o->dt;
    h->width = o->size[0];
    h->height = o->size[1];
    h->headless = o->headless;
    memcpy(h->set, o->set, sizeof h->set);
    h->set_count = o->set_count;
    for (int i = 0; i < o->argc; i++) {
        if (h->argument_count == CORE_COUNT_OF(h->argument) ||
            strlen(o->argv[i]) >= sizeof h->argument[0]) {
            core_fail("corsac run: at most %zu words of %zu bytes after --",
                      CORE_COUNT_OF(h->argument), sizeof h->argument[0] - 1);
            return app_fail(r, APP_EXIT_USAGE);
        }
        strcpy(h->argument[h->argument_count++], o->argv[i]);
    }
    return true;
}

// ---- a scene ----

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

static void end_of_run(app_run *r) {
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
    bool first = strcmp(r->entry, r->path.entry) == 0;
    bool loaded = !(first && r->path.has_conf) || script_load_file(r->script, "conf.lua", &r->conf);
    loaded = loaded && script_load_file(r->script, r->entry, &r->conf);
    if (!loaded && !script_failed(r)) {
        return false;
    }
    if (!configure(r) || !apply_settings(r)) {
        return false;
    }
    for (uint32_t i = 0; i < r->opt->mod_count; i++) {
        if (!script_add_mod(r->script, r->opt->mod[i])) {
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

void app_scene_close(app_run *r) {
    if (r->script) {
        script_quit(r->script);
        keep_run_data(r);
        if (r->sampled_at != r->report.steps) {
            app_report_sample(&r->report, r->scene);
            r->sampled_at = r->report.steps;
        }
        app_report_finish(&r->report, r->scene, script_bytes(r->script));
        if (r->failed == APP_EXIT_FINE && !script_error_count(r->script)) {
            r->expectations_missed += script_check_expectations(r->script);
        }
        if (script_error_count(r->script)) {
            app_fail(r, APP_EXIT_SCRIPT);
        }
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

// ---- files of the run ----

static void note_file(app_run *r, const char *name, const void *text, size_t size) {
    if (r->start.file_count < APP_MAX_FILES) {
        app_file_hash *f = &r->start.file[r->start.file_count++];
        snprintf(f->name, sizeof f->name, "%s", name);
        f->hash = core_hash(text, size, 0);
    }
}

static void hash_scene_file(app_run *r, const char *name) {
    size_t size;
    void *text = core_vfs_exists(r->vfs, name) ? core_vfs_read(r->vfs, name, &size) : NULL;
    if (text) {
        note_file(r, name, text, size);
    }
    core_free(text);
}

// A mod is known by its folder's name: where it lies is no matter of a recording.
static void hash_mod(app_run *r, const char *folder) {
    static const char *const names[] = {"mod.lua", "main.lua"};
    size_t end = strlen(folder), begin;
    while (end > 1 && folder[end - 1] == '/') {
        end--;
    }
    for (begin = end; begin > 0 && folder[begin - 1] != '/';) {
        begin--;
    }
    for (size_t i = 0; i < CORE_COUNT_OF(names); i++) {
        char path[APP_PATH_MAX], name[128];
        size_t size;
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        snprintf(name, sizeof name, "mod %.*s/%s", (int)(end - begin), folder + begin, names[i]);
        void *text = core_file_read(path, &size);
        if (text) {
            note_file(r, name, text, size);
        }
        core_free(text);
    }
}

static bool has_file(const app_journal_header *h, const app_file_hash *f) {
    for (uint32_t i = 0; i < h->file_count; i++) {
        if (strcmp(h->file[i].name, f->name) == 0 && h->file[i].hash == f->hash) {
            return true;
        }
    }
    return false;
}

// A recording of other files will most likely diverge: say so first, the check will name where.
static void compare_files(app_run *r) {
    app_journal_header was = r->start;
    r->start.file_count = 0;
    hash_scene_file(r, r->path.entry);
    hash_scene_file(r, "conf.lua");
    for (uint32_t i = 0; i < r->opt->mod_count; i++) {
        hash_mod(r, r->opt->mod[i]);
    }
    for (uint32_t i = 0; r->replay && i < was.file_count; i++) {
        if (!has_file(&r->start, &was.file[i])) {
            core_log(CORE_LOG_WARN, "replay: '%s' is not the file that was recorded, or missing",
                     was.file[i].name);
        }
    }
    for (uint32_t i = 0; r->replay && i < r->start.file_count; i++) {
        if (!has_file(&was, &r->start.file[i])) {
            core_log(CORE_LOG_WARN, "replay: '%s' was not there when it was recorded",
                     r->start.file[i].name);
        }
    }
}

static bool open_outputs(app_run *r) {
    const app_options *o = r->opt;
    if (o->trace && !core_metrics_trace(r->metrics, o->trace)) {
        return app_fail(r, APP_EXIT_USAGE);
    }
    if (o->metrics_csv && !app_report_open_csv(&r->report, o->metrics_csv)) {
        return app_fail(r, APP_EXIT_USAGE);
    }
    if (o->audio && !app_sound_open_file(&r->sound, o->audio)) {
        return app_fail(r, APP_EXIT_USAGE);
    }
    compare_files(r);
    if (o->record) {
        r->recorder = app_recorder_open(o->record, &r->start);
        return r->recorder || app_fail(r, APP_EXIT_USAGE);
    }
    return true;
}

static void write_results(app_run *r) {
    const app_options *o = r->opt;
    bool silent = o->hash || (o->metrics && strcmp(o->metrics, "-") == 0);
    FILE *people = silent ? stderr : stdout;
    if (r->recorder && !app_recorder_close(r->recorder, r->report.hash)) {
        app_fail(r, APP_EXIT_USAGE);
    }
    if (!app_sound_close(&r->sound)) {
        app_fail(r, APP_EXIT_USAGE);
    }
    if (!o->quiet && core_metrics_steps(r->metrics) > 0) { // else an error stands alone
        app_report_table(&r->report, people);
    }
    if (o->receipt) {
        app_report_receipt(&r->report, people);
    }
    if (o->metrics && !app_report_write_json(&r->report, o->metrics)) {
        app_fail(r, APP_EXIT_USAGE);
    }
    if (o->hash) {
        printf("%016llx\n", (unsigned long long)r->report.hash);
        fflush(stdout);
    }
}

static int exit_code(const app_run *r) {
    if (app_interrupted()) {
        return APP_EXIT_INTERRUPTED;
    }
    if (r->failed != APP_EXIT_FINE) {
        return (int)r->failed;
    }
    if (r->report.asserts.count) {
        return APP_EXIT_SCRIPT;
    }
    return r->expectations_missed ? APP_EXIT_EXPECTATION : r->exit_code;
}

bool app_run_open(app_run *r) {
    if (r->failed != APP_EXIT_FINE || !mount_files(r)) {
        return false;
    }
    bool begun = app_scene_open(r);
    if (begun) {
        end_of_run(r);
        begun = open_outputs(r);
    }
    return begun;
}

app_run *app_run_create(const app_options *opt) {
    app_run *r = core_alloc(sizeof *r);
    r->opt = opt;
    r->time_scale = 1.0f;
    app_input_init(&r->input);
    r->last_step = APP_OPEN_END;
    app_report_init(&r->report);
    r->report.scene_name = opt->scene;
    core_log_add_sink(on_log, &r->report);
    assert_report = &r->report;
    core_set_assert_hook(on_assert);
    core_log_set_level(opt->quiet ? CORE_LOG_WARN : CORE_LOG_INFO);
    struct sigaction action = {.sa_handler = on_interrupt};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    r->metrics = r->report.metrics = core_metrics_create();
    if (!r->metrics) {
        app_fail(r, APP_EXIT_ENVIRONMENT);
    } else if (!app_find_scene(opt->scene, &r->path) || !outputs_ready(opt)) {
        app_fail(r, APP_EXIT_USAGE);
    } else if (choose_simd(r) && start_of(r)) {
        strcpy(r->entry, r->path.entry);
    }
    return r;
}

int app_run_destroy(app_run *r) {
    int code = exit_code(r);
    if (r->device) {
        gfx_device_destroy(r->device);
    }
    app_replay_close(r->replay);
    core_log_remove_sink(on_log, &r->report);
    core_metrics_destroy(r->metrics);
    core_jobs_destroy(r->jobs);
    core_vfs_destroy(r->vfs);
    app_report_release(&r->report);
    core_free(r->run_data);
    core_free(r);
    return code;
}

static int run_main(const app_options *opt) {
    app_run *r = app_run_create(opt);
    bool begun = app_run_open(r);
    if (begun) {
        app_loop(r);
    }
    begun = begun || (r->scene && r->failed == APP_EXIT_SCRIPT);
    app_scene_close(r);
    if (begun) {
        write_results(r);
    }
    return app_run_destroy(r);
}

int app_command_run(int argc, const char *const *argv) {
    app_options *o = core_alloc(sizeof *o);
    int code = APP_EXIT_USAGE;
    if (app_options_parse(o, argc, argv)) {
        if (o->help) {
            app_options_help();
            code = APP_EXIT_FINE;
        } else {
            code = run_main(o);
        }
    }
    core_free(o);
    return code;
}
