// The loop: fixed steps, with or without a window.
#include <string.h>

#include "app/lab_ghost.h"
#include "app/overlay.h"
#include "core/clock.h"
#include "core/log.h"

#define ACCURACY_EVERY 30 // steps
#define CATCH_UP_STEPS 5  // most steps in one frame of a window
#define KEY_ESCAPE     256
#define KEY_F1         290

static void send_event(app_run *r, const gfx_event *e) {
    char letter[8], text[5] = "";
    const double key[] = {e->pressed}, button[] = {e->pressed, (double)e->x, (double)e->y};
    const double at[] = {(double)e->x, (double)e->y};
    switch (e->type) {
    case GFX_EVENT_KEY:
        script_event(r->script, "key", app_key_name(e->code, letter), key, 1);
        break;
    case GFX_EVENT_MOUSE_BUTTON:
        script_event(r->script, "mouse", app_key_name(e->code + APP_MOUSE_CODE, letter), button, 3);
        break;
    case GFX_EVENT_MOUSE_MOVE:
        script_event(r->script, "move", NULL, at, 2);
        break;
    case GFX_EVENT_SCROLL:
        script_event(r->script, "scroll", NULL, at, 2);
        break;
    case GFX_EVENT_TEXT:
        app_utf8(e->code, text);
        script_event(r->script, "text", text, NULL, 0);
        break;
    case GFX_EVENT_RESIZE:
        r->width = (uint32_t)CORE_MAX(e->x, 1.0f), r->height = (uint32_t)CORE_MAX(e->y, 1.0f);
        script_event(r->script, "resize", NULL, at, 2);
        break;
    case GFX_EVENT_FOCUS:
        script_event(r->script, "focus", NULL, key, 1);
        break;
    case GFX_EVENT_PAD:
        script_event(r->script, "pad", NULL, key, 1);
        break;
    case GFX_EVENT_PAD_BUTTON:
        script_event(r->script, "button", app_key_name(e->code + APP_PAD_CODE, letter), key, 1);
        break;
    case GFX_EVENT_PAD_AXIS: // getAxis has it, without the dead zone
    case GFX_EVENT_CLOSE:
        break;
    }
}

// The step's input: from the recording, or what the window has queued.
static uint32_t take_events(app_run *r, gfx_event out[APP_MAX_EVENTS]) {
    if (r->replay) {
        r->input.queued = 0;
        return app_replay_events(r->replay, out);
    }
    uint32_t count = r->input.queued;
    memcpy(out, r->input.queue, count * sizeof *out);
    r->input.queued = 0;
    return count;
}

static void headless_frame(app_run *r, uint64_t step) {
    if (!app_frame_wanted(r, step)) {
        return;
    }
    uint64_t begin = core_clock_ns();
    if (app_device_open(r, false) && app_frame(r, 1.0f)) {
        app_frame_files(r, step);
    }
    core_metrics_step_exclude_ns(r->metrics, core_clock_ns() - begin);
}

// Last of a step: nothing here is part of what it cost.
static void close_step(app_run *r, const gfx_event *event, uint32_t events, uint64_t allocations) {
    app_report_step(&r->report, allocations);
    if (r->report.csv) {
        app_report_finish(&r->report, r->scene, r->script);
        app_report_csv_line(&r->report);
    }
    if (r->recorder) {
        app_recorder_step(r->recorder, event, events, r->scene);
    }
    if (r->replay && !app_replay_check(r->replay, r->scene)) {
        app_fail(r, APP_EXIT_DIVERGED);
    }
}

static void step(app_run *r) {
    gfx_event event[APP_MAX_EVENTS];
    uint32_t events = take_events(r, event);
    uint64_t number = r->report.steps + 1, before = core_alloc_count(), begin = core_clock_ns();
    core_metrics_step_begin(r->metrics);
    app_input_step(&r->input, event, events);
    core_stage_begin(r->metrics, CORE_STAGE_SCRIPT);
    for (uint32_t i = r->heard; i < events; i++) {
        send_event(r, &event[i]);
    }
    r->heard = 0;
    core_stage_end(r->metrics, CORE_STAGE_SCRIPT);
    if (!scene_step(r->scene)) {
        app_fail(r, APP_EXIT_SCRIPT);
    }
    if (r->opt->headless) {
        core_stage_begin(r->metrics, CORE_STAGE_SCRIPT);
        script_update(r->script, (double)scene_dt(r->scene));
        core_stage_end(r->metrics, CORE_STAGE_SCRIPT);
    }
    if (number % ACCURACY_EVERY == 0 || number == r->last_step) {
        app_report_sample(&r->report, r->scene);
        r->sampled_at = number;
    }
    uint64_t allocations = core_alloc_count() - before;
    if (!app_sound_step(&r->sound, r->scene, (double)number * r->report.dt, !r->opt->headless)) {
        app_fail(r, APP_EXIT_ENVIRONMENT);
    }
    if (r->opt->headless) {
        headless_frame(r, number);
    }
    core_metrics_step_end(r->metrics);
    script_end_step(r->script);
    app_overlay_step(r);
    close_step(r, event, events, allocations);
    if (r->ghost) {
        app_ghost_step(r->ghost, event, events, core_clock_ns() - begin);
    }
}

static void drop_ghost(app_run *r) {
    if (r->ghost) {
        app_ghost_destroy(r->ghost);
        r->ghost = NULL;
        r->caption = NULL;
    }
}

// The ghost starts with the scene, so that both have lived the same.
static void ask_for_ghost(app_run *r) {
    if (r->ghost) {
        drop_ghost(r);
    } else if (!r->recorder && !r->replay) {
        r->ghost_wanted = r->reload = true;
    }
}

// Scripts not while a run is recorded or replayed: what changed is not in the recording. Shaders
// and images change nothing but the picture; their files are looked at every half second or so.
// Models and sounds are part of the simulation: with a new one that can be read, the scene starts
// anew.
static void watch(app_run *r) {
    bool live = r->opt->watch && !r->recorder && !r->replay;
    if (live) {
        script_reload_changed(r->script);
    }
    bool now = r->opt->headless || r->report.frames % 30 == 0;
    r->reload |= live && now && app_assets_changed(r->vfs);
    if (r->opt->watch && now && r->device) {
        gfx_device_reload(r->device); // a broken shader is logged and keeps its last form
    }
}

// Scene changes and reloads happen between steps. False: the run is over.
static bool between_steps(app_run *r) {
    if (r->quit || r->failed || app_interrupted() || r->report.steps >= r->last_step) {
        return false;
    }
    if (script_error_count(r->script) && r->opt->headless && !r->opt->keep_going) {
        return false;
    }
    if (r->next_scene[0] || r->reload) {
        if (r->next_scene[0]) {
            strcpy(r->entry, r->next_scene);
        }
        r->next_scene[0] = 0;
        drop_ghost(r);
        app_scene_close(r);
        r->reload = false;
        bool opened = app_scene_open(r);
        if (opened && r->ghost_wanted) {
            r->ghost = app_ghost_create(r);
        }
        r->ghost_wanted = false;
        return opened;
    }
    return true;
}

bool app_step(app_run *r) {
    bool more = between_steps(r);
    if (more) {
        step(r);
    }
    return more;
}

static void headless_loop(app_run *r) {
    while (app_step(r)) {
        app_progress(r);
        if (r->report.steps % 32 == 0) {
            watch(r);
        }
    }
}

static void program_key(app_run *r, const gfx_event *e) {
    if (e->type == GFX_EVENT_CLOSE) {
        r->quit = true;
    }
    if (e->type != GFX_EVENT_KEY || e->pressed != 1) {
        return;
    }
    bool failed = script_error_count(r->script) > 0;
    switch (e->code) {
    case KEY_ESCAPE:
        r->quit |= failed || !app_input_bound(&r->input, KEY_ESCAPE);
        break;
    case KEY_F1:
        app_overlay_turn(r);
        break;
    case KEY_F1 + 1:
        ask_for_ghost(r);
        break;
    case KEY_F1 + 3:
        r->paused = !r->paused;
        break;
    case KEY_F1 + 2:
        r->single_step = true;
        break;
    case KEY_F1 + 4:
        r->reload |= !r->recorder && !r->replay;
        r->ghost_wanted |= r->ghost != NULL;
        break;
    }
}

static void poll_window(app_run *r) {
    gfx_event e;
    while (gfx_device_poll(r->device, &e)) {
        program_key(r, &e);
        if (app_overlay_event(r, &e)) {
            continue;
        }
        app_input_queue(&r->input, &e);
        if (r->paused && !r->replay) { // a pause menu must hear what the next step will record
            for (; r->heard < r->input.queued; r->heard++) {
                send_event(r, &r->input.queue[r->heard]);
            }
        }
    }
}

// Runs the steps that this frame owes, at most CATCH_UP_STEPS: a machine that is too slow shows
// slow motion, and the time it gave up stands in the metrics.
static double run_steps(app_run *r, double owed) {
    double dt = (double)scene_dt(r->scene);
    for (int done = 0; owed >= dt; done++, owed -= dt) {
        if (done == CATCH_UP_STEPS) {
            r->report.capped_frames++;
            r->report.dropped_s += owed;
            return 0.0;
        }
        if (!between_steps(r)) {
            return 0.0;
        }
        step(r);
        if (app_frame_wanted(r, r->report.steps)) {
            return owed - dt;
        }
    }
    return owed;
}

// A picture that was asked for shows its step as a run without a window does: alpha 1.
static void window_frame(app_run *r, double passed, float alpha) {
    uint64_t at = r->report.steps;
    bool wanted = at != r->filed_at && app_frame_wanted(r, at);
    core_stage_begin(r->metrics, CORE_STAGE_SCRIPT);
    script_update(r->script, passed);
    core_stage_end(r->metrics, CORE_STAGE_SCRIPT);
    if (!app_frame(r, wanted || r->ghost ? 1.0f : alpha)) {
        return;
    }
    if (wanted) {
        app_frame_files(r, at);
        r->filed_at = at;
    }
    gfx_device_present(r->device);
}

static void window_loop(app_run *r) {
    double owed = 0.0;
    uint64_t last = core_clock_ns();
    while (between_steps(r)) {
        poll_window(r);
        uint64_t now = core_clock_ns();
        double passed = (double)(now - last) * 1e-9;
        last = now;
        bool stopped = r->paused || (script_error_count(r->script) && !r->opt->keep_going);
        if (r->single_step) {
            r->single_step = false;
            step(r);
        } else if (!stopped) {
            owed = run_steps(r, owed + passed * (double)r->time_scale);
        }
        if (!r->failed) {
            window_frame(r, passed, stopped ? 1.0f : (float)(owed / (double)scene_dt(r->scene)));
        }
        watch(r);
    }
}

// A run that ends before the step it was given (exit, Escape, an error) has its last picture too.
static void last_picture(app_run *r) {
    if (!r->scene || !r->report.steps || r->report.steps >= r->last_step || app_interrupted()) {
        return;
    }
    r->last_step = r->report.steps;
    bool wanted = false;
    for (uint32_t i = 0; i < r->opt->shot_count; i++) {
        wanted |= r->opt->shot[i].step == 0;
    }
    if (wanted && app_device_open(r, !r->opt->headless) && app_frame(r, 1.0f)) {
        app_frame_files(r, r->last_step);
    }
}

void app_loop(app_run *r) {
    uint64_t begin = core_clock_ns();
    if (r->opt->headless) {
        headless_loop(r);
    } else if (app_device_open(r, true)) {
        window_loop(r);
    }
    app_progress_end(r);
    last_picture(r);
    drop_ghost(r);
    r->report.wall_s = (double)(core_clock_ns() - begin) * 1e-9;
}
