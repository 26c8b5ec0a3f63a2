// What a script may ask of the program.
#include <math.h>
#include <string.h>

#include "app/run.h"
#include "core/log.h"

static const char *param(void *ctx, const char *name) {
    app_run *r = ctx;
    uint32_t i = 0;
    while (i < r->param_count && strcmp(r->param[i], name) != 0) {
        i++;
    }
    if (i == r->param_count && i < APP_MAX_PARAMS && strlen(name) < sizeof r->param[0]) {
        strcpy(r->param[r->param_count++], name);
    }
    for (i = 0; i < r->start.set_count; i++) {
        if (strcmp(r->start.set[i].name, name) == 0) {
            return r->start.set[i].value;
        }
    }
    return NULL;
}

static bool replays(void *ctx) { return ((app_run *)ctx)->replay != NULL; }

static const char *saved(void *ctx, const char *name, size_t *size) {
    return app_replay_saved(((app_run *)ctx)->replay, name, size);
}

static void note_saved(void *ctx, const char *name, const char *text, size_t size) {
    app_run *r = ctx;
    if (r->recorder) {
        app_recorder_saved(r->recorder, name, text, size);
    }
}

static void leave(void *ctx, int code) {
    app_run *r = ctx;
    r->quit = true;
    r->exit_code = code & 0xff;
}

static bool change_scene(void *ctx, const char *path) {
    app_run *r = ctx;
    char inside[sizeof r->next_scene + 16];
    if (strlen(path) >= sizeof r->next_scene - 16) {
        return core_fail_quiet("corsac.run: path '%.60s...' is too long", path);
    }
    snprintf(inside, sizeof inside, "%s/main.lua", path[0] ? path : "."); // of a game's folder
    bool folder = core_vfs_exists(r->vfs, inside);
    if (!folder && !core_vfs_exists(r->vfs, path)) {
        return core_fail_quiet("corsac.run: no file '%s' in the scene's folder", path);
    }
    strcpy(r->next_scene, folder ? inside : path);
    return true;
}

static void user_metric(void *ctx, const char *name, double value) {
    app_report_user(&((app_run *)ctx)->report, name, value);
}

static double metric(void *ctx, const char *path, bool *known) {
    app_run *r = ctx;
    if (r->sampled_at != r->report.steps && strncmp(path, "accuracy.", 9) == 0) {
        app_report_sample(&r->report, r->scene);
        r->sampled_at = r->report.steps;
    }
    if (strncmp(path, "counts.", 7) == 0 || strncmp(path, "memory.", 7) == 0) {
        app_report_finish(&r->report, r->scene, r->script);
    }
    return app_report_value(&r->report, path, known);
}

static void warning(void *ctx, const char *text) {
    app_text_list_add(&((app_run *)ctx)->report.warnings, text);
}

static bool input_down(void *ctx, const char *name, bool *known) {
    return app_input_down(&((app_run *)ctx)->input, name, known);
}

static float input_axis(void *ctx, const char *name, bool *known) {
    return app_input_axis(&((app_run *)ctx)->input, name, known);
}

// A recording holds what a bot sent; sent again, it would count twice.
static bool send_key(void *ctx, const char *name, bool pressed) {
    app_run *r = ctx;
    return r->replay ? app_key_code(name) >= 0 : app_input_send_key(&r->input, name, pressed);
}

static bool send_axis(void *ctx, const char *name, float value) {
    app_run *r = ctx;
    return r->replay ? app_key_code(name) >= 0 : app_input_send_axis(&r->input, name, value);
}

static bool send_text(void *ctx, const char *utf8) {
    app_run *r = ctx;
    return r->replay || app_input_send_text(&r->input, utf8);
}

static void send_move(void *ctx, float x, float y) {
    app_run *r = ctx;
    gfx_event e = {.type = GFX_EVENT_MOUSE_MOVE, .x = x, .y = y};
    if (!r->replay) {
        app_input_queue(&r->input, &e);
    }
}

static bool bind_action(void *ctx, const char *action, const char *keys) {
    return app_input_bind(&((app_run *)ctx)->input, action, keys);
}

static bool action_binding(void *ctx, const char *action, char *keys, size_t size) {
    return app_input_binding(&((app_run *)ctx)->input, action, keys, size);
}

static void frame_size(void *ctx, uint32_t *width, uint32_t *height) {
    const app_run *r = ctx;
    *width = r->width, *height = r->height;
}

static void set_cursor(void *ctx, int mode) {
    app_run *r = ctx;
    if (r->device) {
        gfx_device_set_cursor(r->device, (gfx_cursor)mode);
    }
}

static void set_pause(void *ctx, bool paused) { ((app_run *)ctx)->paused = paused; }

static void set_time_scale(void *ctx, float scale) {
    app_run *r = ctx;
    if (!isfinite(scale) || scale < 0.0f || scale > 100.0f) {
        core_log(CORE_LOG_WARN, "time scale %g is outside 0..100 and ignored", (double)scale);
        return;
    }
    r->time_scale = scale;
}

script_host app_host(app_run *r) {
    return (script_host){.ctx = r,
                         .param = param,
                         .exit = leave,
                         .run = change_scene,
                         .user_metric = user_metric,
                         .metric = metric,
                         .warning = warning,
                         .input_down = input_down,
                         .input_axis = input_axis,
                         .send_key = send_key,
                         .send_axis = send_axis,
                         .send_text = send_text,
                         .send_move = send_move,
                         .bind = bind_action,
                         .binding = action_binding,
                         .size = frame_size,
                         .cursor = set_cursor,
                         .replays = replays,
                         .saved = saved,
                         .note_saved = note_saved,
                         .pause = set_pause,
                         .time_scale = set_time_scale};
}
