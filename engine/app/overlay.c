#include "app/overlay.h"

#include "core/log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PAGE_NONE, PAGE_STAGES, PAGE_SETTINGS, PAGE_CONSOLE, PAGE_COUNT };
enum { VIEWS = 2 }; // that the settings switch: physics, state machine
enum { HISTORY = 180, LOG_LINES = 16, LOG_WIDTH = 160, CODE_MAX = 256 };
enum {
    KEY_ENTER = 257,
    KEY_BACKSPACE = 259,
    KEY_RIGHT = 262,
    KEY_LEFT,
    KEY_DOWN,
    KEY_UP,
    KEY_F1 = 290
};
enum { LINE = 16, LEFT = 10, WIDTH = 460, GRAPH = 90 }; // pixels

struct app_overlay {
    int page;
    bool physics;  // shapes of bodies as lines
    bool machines; // the state machine nearest to the camera
    float step_ms[HISTORY], stage_ms[CORE_STAGE_TOTAL][HISTORY];
    uint32_t steps; // remembered so far
    uint32_t row;   // of the settings: the overlay's own views, then those of gfx
    char log[LOG_LINES][LOG_WIDTH];
    uint32_t lines;
    char code[CODE_MAX], wanted[CODE_MAX]; // being typed; to be run by the next step
};

static const float ink[4] = {0.92f, 0.94f, 0.96f, 1.0f}, faint[4] = {0.6f, 0.64f, 0.68f, 1.0f};
static const float bright[4] = {1.0f, 0.78f, 0.35f, 1.0f}, back[4] = {0.05f, 0.06f, 0.08f, 0.82f};

// ---- life ----

static void keep_line(void *ctx, core_log_level level, const char *text) {
    app_overlay *o = ctx;
    if (level >= CORE_LOG_INFO) {
        snprintf(o->log[o->lines++ % LOG_LINES], LOG_WIDTH, "%s%.140s",
                 level >= CORE_LOG_ERROR  ? "error: "
                 : level >= CORE_LOG_WARN ? "warning: "
                                          : "",
                 text);
    }
}

void app_overlay_turn(app_run *r) {
    if (!r->overlay) {
        r->overlay = core_alloc(sizeof *r->overlay);
        core_log_add_sink(keep_line, r->overlay);
    }
    r->overlay->page = (r->overlay->page + 1) % PAGE_COUNT;
}

void app_overlay_destroy(app_overlay *o) {
    if (o) {
        core_log_remove_sink(keep_line, o);
        core_free(o);
    }
}

void app_overlay_step(app_run *r) {
    app_overlay *o = r->overlay;
    if (!o || o->page == PAGE_NONE) {
        return;
    }
    uint32_t at = o->steps++ % HISTORY;
    o->step_ms[at] = (float)core_metrics_step_last(r->metrics);
    for (int i = 0; i < CORE_STAGE_TOTAL; ++i) {
        o->stage_ms[i][at] = (float)core_metrics_stage_last(r->metrics, (core_stage)i);
    }
    if (o->wanted[0]) {
        char result[LOG_WIDTH];
        bool fine = script_console(r->script, o->wanted, result, sizeof result);
        core_log(fine ? CORE_LOG_INFO : CORE_LOG_WARN, "> %s", o->wanted);
        core_log(fine ? CORE_LOG_INFO : CORE_LOG_WARN, "%s", result);
        o->wanted[0] = 0;
    }
}

// ---- keys ----

static void change_setting(app_run *r, int direction) {
    app_overlay *o = r->overlay;
    gfx_world *world = scene_gfx_if(r->scene);
    if (o->row < VIEWS) {
        bool *view = o->row == 0 ? &o->physics : &o->machines;
        *view = !*view;
    } else if (world) {
        gfx_world_nudge(world, o->row - VIEWS, direction);
    }
}

static bool settings_key(app_run *r, int code) {
    app_overlay *o = r->overlay;
    uint32_t rows = VIEWS + gfx_world_setting_count();
    if (code == KEY_UP || code == KEY_DOWN) {
        o->row = (o->row + (code == KEY_DOWN ? 1 : rows - 1)) % rows;
    } else if (code == KEY_LEFT || code == KEY_RIGHT) {
        change_setting(r, code == KEY_RIGHT ? 1 : -1);
    } else {
        return false;
    }
    return true;
}

// What the console runs is in no recording.
static void enter_code(app_run *r) {
    app_overlay *o = r->overlay;
    if (r->recorder || r->replay) {
        core_log(CORE_LOG_WARN, "the console is closed while a run is recorded or replayed");
    } else {
        memcpy(o->wanted, o->code, sizeof o->wanted);
    }
    o->code[0] = 0;
}

static void type_text(app_overlay *o, int codepoint) {
    size_t length = strlen(o->code);
    char text[5] = "";
    app_utf8(codepoint, text);
    if (length + strlen(text) < sizeof o->code) {
        strcat(o->code, text);
    }
}

// Takes the last character away, all bytes of it.
static void erase_text(app_overlay *o) {
    size_t length = strlen(o->code);
    while (length > 0 && ((unsigned char)o->code[--length] & 0xc0) == 0x80) {
    }
    o->code[length] = 0;
}

bool app_overlay_event(app_run *r, const gfx_event *e) {
    app_overlay *o = r->overlay;
    if (!o || o->page < PAGE_SETTINGS) {
        return false;
    }
    bool function = e->type == GFX_EVENT_KEY && e->code >= KEY_F1;
    if (o->page == PAGE_SETTINGS) {
        return e->type == GFX_EVENT_KEY && e->pressed && settings_key(r, e->code);
    }
    if (e->type == GFX_EVENT_TEXT) {
        type_text(o, e->code);
    } else if (e->type == GFX_EVENT_KEY && e->pressed && e->code == KEY_BACKSPACE) {
        erase_text(o);
    } else if (e->type == GFX_EVENT_KEY && e->pressed == 1 && e->code == KEY_ENTER) {
        enter_code(r);
    }
    return (e->type == GFX_EVENT_TEXT || e->type == GFX_EVENT_KEY) && !function;
}

// ---- drawing ----

static void text_line(gfx_world *world, float y, const float *color, const char *text) {
    gfx_print(world, LEFT, y, LINE - 2, color, text);
}

// Bars of the last steps, the newest at the right; `full` ms reach the top.
static void draw_graph(const app_overlay *o, gfx_world *world, float y) {
    const float bar[4] = {0.33f, 0.66f, 0.95f, 0.9f}, line[4] = {1.0f, 1.0f, 1.0f, 0.25f};
    uint32_t count = CORE_MIN(o->steps, (uint32_t)HISTORY);
    float full = 1.0f, w = (float)(WIDTH - 2 * LEFT) / HISTORY;
    for (uint32_t i = 0; i < count; ++i) {
        full = fmaxf(full, o->step_ms[i]);
    }
    for (uint32_t i = 0; i < count; ++i) {
        float ms = o->step_ms[(o->steps - 1 - i) % HISTORY], h = GRAPH * ms / full;
        gfx_rect(world, WIDTH - LEFT - (float)(i + 1) * w, y + GRAPH - h, w, h, bar);
    }
    char text[64];
    snprintf(text, sizeof text, "%.1f ms", (double)full);
    gfx_rect(world, LEFT, y, WIDTH - 2 * LEFT, 1.0f, line);
    gfx_print(world, LEFT + 2, y + 2, LINE - 3, faint, text);
}

static float stage_mean(const app_overlay *o, int stage, float *most) {
    uint32_t count = CORE_MIN(o->steps, (uint32_t)HISTORY);
    float sum = 0.0f;
    *most = 0.0f;
    for (uint32_t i = 0; i < count; ++i) {
        sum += o->stage_ms[stage][i];
        *most = fmaxf(*most, o->stage_ms[stage][i]);
    }
    return count ? sum / (float)count : 0.0f;
}

static float draw_stages(const app_run *r, gfx_world *world, float y) {
    const float bar[4] = {0.96f, 0.62f, 0.22f, 0.9f};
    const app_overlay *o = r->overlay;
    char text[96];
    draw_graph(o, world, y);
    y += GRAPH + 6;
    for (int i = 0; i < CORE_STAGE_TOTAL; ++i) {
        float most, mean = stage_mean(o, i, &most);
        if (most > 0.0005f) { // rooms that cost nothing are not listed
            snprintf(text, sizeof text, "%-13s%7.3f ms, at most %.3f",
                     core_stage_name((core_stage)i), (double)mean, (double)most);
            text_line(world, y, ink, text);
            gfx_rect(world, 305, y + 3, CORE_CLAMP(mean * 12.0f, 1.0f, 140.0f), LINE - 6, bar);
            y += LINE;
        }
    }
    return y + 6;
}

static float draw_counts(const app_run *r, gfx_world *world, float y) {
    char text[96];
    for (int i = 0, column = 0; i < CORE_COUNT_TOTAL; ++i) {
        double n = core_metrics_get(r->metrics, (core_count)i);
        if (n > 0.0) {
            snprintf(text, sizeof text, "%-12s%8.0f", core_count_name((core_count)i), n);
            gfx_print(world, LEFT + 220.0f * (float)column, y, LINE - 2, ink, text);
            y += column ? LINE : 0;
            column = !column;
        }
    }
    return y + LINE;
}

static void draw_mods(const app_run *r, gfx_world *world, float y) {
    static script_mod_info mod[APP_MAX_MODS];
    int count = CORE_MIN(script_mods_info(r->script, mod, APP_MAX_MODS), APP_MAX_MODS);
    double steps = (double)CORE_MAX(r->report.steps, UINT64_C(1));
    for (int i = 0; i < count; ++i, y += LINE) {
        char text[160];
        snprintf(text, sizeof text, "mod %-16s%s %7.0f instr/step %.3f ms/step %zu KiB %u errors",
                 mod[i].name, mod[i].enabled ? "" : " off", (double)mod[i].instructions / steps,
                 mod[i].ms / steps, mod[i].bytes >> 10, mod[i].errors);
        text_line(world, y, mod[i].errors || !mod[i].enabled ? bright : ink, text);
    }
}

static float draw_settings(const app_run *r, gfx_world *world, float y) {
    const app_overlay *o = r->overlay;
    uint32_t rows = VIEWS + gfx_world_setting_count();
    uint32_t seen = CORE_MAX(r->height / LINE, 5u) - 3,
             first = o->row < seen ? 0 : o->row - seen + 1;
    for (uint32_t i = first; i < rows && i < first + seen; ++i, y += LINE) {
        char text[128], value[64] = "";
        const char *name = i == 0 ? "physics" : "state machine";
        if (i < VIEWS) {
            snprintf(value, sizeof value, "%s", (i == 0 ? o->physics : o->machines) ? "on" : "off");
        } else {
            name = gfx_world_setting(world, i - VIEWS, value, sizeof value);
        }
        snprintf(text, sizeof text, "%s %-18s%s", i == o->row ? ">" : " ", name, value);
        text_line(world, y, i == o->row ? bright : ink, text);
    }
    return y;
}

static float draw_console(const app_run *r, gfx_world *world, float y) {
    const app_overlay *o = r->overlay;
    uint32_t first = o->lines > LOG_LINES ? o->lines - LOG_LINES : 0;
    for (uint32_t i = first; i < o->lines; ++i, y += LINE) {
        text_line(world, y, ink, o->log[i % LOG_LINES]);
    }
    char text[CODE_MAX + 8];
    snprintf(text, sizeof text, "> %s_", o->code);
    text_line(world, y, bright, text);
    return y + LINE;
}

// Shapes of bodies: still ones grey, moving ones by their kind; bounds for what has no simple form.
static void draw_shape(gfx_world *world, const phys_shape_view *v) {
    gfx_pen pen = gfx_pen_default();
    const float colors[3][4] = {{0.6f, 0.6f, 0.6f, 0.7f}, {0.3f, 0.6f, 1, 1}, {0.3f, 1, 0.4f, 1}};
    int kind = v->body_type == PHYS_STATIC ? 0 : v->body_type == PHYS_KINEMATIC ? 1 : 2;
    memcpy(pen.color, colors[kind], sizeof pen.color);
    pen.on_top = true;
    core_vec3 axis = core_quat_rotate(v->rotation, core_v3(0, v->half_height, 0));
    if (v->type == PHYS_SPHERE) {
        gfx_draw_sphere(world, v->position, v->radius, &pen);
    } else if (v->type == PHYS_CAPSULE || v->type == PHYS_CYLINDER) {
        gfx_draw_capsule(world, core_v3_sub(v->position, axis), core_v3_add(v->position, axis),
                         v->radius, &pen);
    } else if (v->type == PHYS_BOX) {
        gfx_draw_box(world, v->position, v->rotation, v->half, &pen);
    } else if (v->bounds.max.x < 1e8f) {
        core_vec3 half = core_v3_scale(core_v3_sub(v->bounds.max, v->bounds.min), 0.5f);
        gfx_draw_box(world, core_v3_add(v->bounds.min, half), core_quat_identity(), half, &pen);
    }
}

static void draw_physics(const app_run *r, gfx_world *world) {
    enum { MOST = 4000 }; // shapes: it is for people
    phys_world *phys = scene_phys_if(r->scene);
    uint32_t count = phys ? phys_world_shape_count(phys) : 0;
    for (uint32_t i = 0; i < count && i < MOST; ++i) {
        phys_shape_view view;
        if (phys_world_shape(phys, i, &view)) {
            draw_shape(world, &view);
        }
    }
}

void app_overlay_draw(app_run *r) {
    static const char *const titles[PAGE_COUNT] = {"", "stages and counts",
                                                   "settings: arrows choose and change",
                                                   "log and console: Lua, Enter"};
    app_overlay *o = r->overlay;
    gfx_world *world = scene_gfx_if(r->scene);
    if (!o || !world) {
        return;
    }
    if (o->physics) {
        draw_physics(r, world);
    }
    if (o->machines) {
        app_overlay_machine(r);
    }
    if (o->page == PAGE_NONE) {
        return;
    }
    char title[96];
    float y = LEFT;
    if (o->page == PAGE_CONSOLE) {
        gfx_rect(world, 0, 0, (float)r->width, (LOG_LINES + 4) * LINE, back);
    } else {
        gfx_rect(world, 0, 0, WIDTH, (float)r->height, back);
    }
    snprintf(title, sizeof title, "F1  %s", titles[o->page]);
    text_line(world, y, faint, title);
    y += LINE + 6;
    if (o->page == PAGE_STAGES) {
        y = draw_stages(r, world, y);
        y = draw_counts(r, world, y);
        draw_mods(r, world, y + 6);
    } else if (o->page == PAGE_SETTINGS) {
        draw_settings(r, world, y);
    } else {
        draw_console(r, world, y);
    }
}
