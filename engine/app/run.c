// `corsac run`: from the command line to the exit code.
#include "app/run.h"
#include "app/commands.h"
#include "app/overlay.h"

#include <signal.h>
#include <string.h>

#include "core/log.h"
#include "core/simd.h"

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
    if (assert_report) {
        app_text_list_add(&assert_report->asserts, text);
    }
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
    if (r->opt->watch) {
        core_vfs_watch(r->vfs);
    }
    if (app_home(home, sizeof home)) {
        snprintf(assets, sizeof assets, "%s/assets", home);
        if (!core_vfs_mount(r->vfs, assets, "", false)) {
            return app_fail(r, APP_EXIT_ENVIRONMENT);
        }
    }
    return core_vfs_mount(r->vfs, r->path.folder, "", false) || app_fail(r, APP_EXIT_USAGE);
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
    app_start_compare_files(r);
    return !r->recorder || app_recorder_begin(r->recorder, o->record, &r->start) ||
           app_fail(r, APP_EXIT_USAGE);
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
    r->recorder = r->opt->record ? app_recorder_create() : NULL;
    bool begun = app_scene_open(r);
    if (begun) {
        app_end_of_run(r);
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
    } else if (!app_find_scene(opt->scene, &r->path) || !app_mods_find(r) || !outputs_ready(opt)) {
        app_fail(r, APP_EXIT_USAGE);
    } else if (choose_simd(r) && app_start_read(r)) {
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
    app_overlay_destroy(r->overlay);
    core_metrics_destroy(r->metrics);
    core_jobs_destroy(r->jobs);
    core_vfs_destroy(r->vfs);
    if (assert_report == &r->report) {
        assert_report = NULL;
    }
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
