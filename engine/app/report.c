// Collecting a run's figures and finding them by name. Writers: report_write.c.
#include "app/report.h"

#include <math.h>
#include <string.h>

#include "app/report_names.h"
#include "core/log.h"

void app_report_init(app_report *r) {
    *r = (app_report){0};
    app_report_new_scene(r);
    memcpy(r->peak, r->accuracy, sizeof r->peak);
}

void app_report_new_scene(app_report *r) {
    for (int i = 0; i < APP_ACCURACY_COUNT; i++) {
        r->accuracy[i] = scene_room_built(app_accuracy_names[i].room) ? 0.0 : NAN;
    }
}

static void release_list(app_text_list *list) {
    for (uint32_t i = 0; i < list->count; i++) {
        core_free(list->text[i]);
    }
}

void app_report_release(app_report *r) {
    release_list(&r->warnings);
    release_list(&r->asserts);
    core_free(r->step_allocations);
    core_free(r->user);
    if (r->csv) {
        fclose(r->csv);
    }
}

void app_text_list_add(app_text_list *list, const char *text) {
    for (uint32_t i = 0; i < list->count; i++) {
        if (strcmp(list->text[i], text) == 0) {
            return;
        }
    }
    if (list->count == APP_MAX_WARNINGS) {
        list->more++;
        return;
    }
    size_t size = strlen(text) + 1;
    list->text[list->count] = core_alloc(size);
    memcpy(list->text[list->count++], text, size);
}

void app_report_user(app_report *r, const char *name, double value) {
    if (!r->user) {
        r->user = core_alloc(sizeof *r->user * APP_MAX_USER);
    }
    uint32_t i = 0;
    while (i < r->user_count && strcmp(r->user[i].name, name) != 0) {
        i++;
    }
    if (strlen(name) >= sizeof r->user->name || i == APP_MAX_USER) {
        core_log(CORE_LOG_WARN, "metrics: '%.63s' is left out: at most %d names of 63 bytes", name,
                 APP_MAX_USER);
        return;
    }
    strcpy(r->user[i].name, name);
    r->user[i].value = value;
    r->user_count = CORE_MAX(r->user_count, i + 1);
}

#define APP_PATH_SAMPLE 32 // paths searched again at each sample
#define APP_ANIM_SAMPLE 8  // instances judged in double precision at each sample

static void note(app_report *r, app_accuracy_id id, double value) {
    r->accuracy[id] = value;
    if (!r->sampled || isnan(r->peak[id]) || value > r->peak[id]) {
        r->peak[id] = value;
    }
}

void app_report_sample(app_report *r, scene *s) {
    phys_world *world = scene_phys_if(s);
    anim_world *anim = scene_anim_if(s);
    nav_world *nav = scene_nav_if(s);
    if ((!world && !anim && !nav) || r->accuracy_off) {
        return;
    }
    core_stage_begin(r->metrics, CORE_STAGE_METRICS);
    if (anim) {
        note(r, APP_ANIM_ERROR, anim_world_error_max(anim, APP_ANIM_SAMPLE));
    }
    if (nav) {
        note(r, APP_PATH_RATIO, nav_world_path_ratio_max(nav, APP_PATH_SAMPLE));
    }
    if (!world) {
        core_stage_end(r->metrics, CORE_STAGE_METRICS);
        r->sampled = true;
        return;
    }
    phys_accuracy a = {0};
    phys_world_accuracy(world, &a);
    core_stage_end(r->metrics, CORE_STAGE_METRICS);
    note(r, APP_PENETRATION_MAX, a.penetration_max_m);
    note(r, APP_PENETRATION_MEAN, a.penetration_mean_m);
    note(r, APP_ENERGY, a.energy_j);
    note(r, APP_ENERGY_DRIFT, a.energy_drift);
    note(r, APP_MOMENTUM_DRIFT, a.momentum_drift);
    note(r, APP_JOINT_ERROR, a.joint_error_max_m);
    note(r, APP_TUNNELLED, a.tunnelled);
    note(r, APP_NAN, a.nan);
    r->sampled = true;
}

void app_report_step(app_report *r, uint64_t allocations) {
    if (r->steps == r->step_allocations_capacity) {
        uint64_t grown = CORE_MAX(1024u, r->step_allocations_capacity * 2);
        size_t item = sizeof *r->step_allocations;
        r->step_allocations = core_realloc(
            r->step_allocations, (size_t)r->step_allocations_capacity * item, (size_t)grown * item);
        r->step_allocations_capacity = grown;
    }
    r->step_allocations[r->steps++] = (uint32_t)CORE_MIN(allocations, UINT32_MAX);
    r->simulated_s += r->dt;
}

uint64_t app_report_steady_allocations(const app_report *r) {
    uint64_t sum = 0;
    for (uint64_t i = (r->steps + 1) / 2; i < r->steps; i++) {
        sum += r->step_allocations[i];
    }
    return sum;
}

void app_report_finish(app_report *r, const scene *s, const script *code) {
    r->script_bytes = script_bytes(code);
    r->mod_count = CORE_MIN(script_mods_info(code, r->mod, APP_MAX_MODS), APP_MAX_MODS);
    core_metrics_set(r->metrics, CORE_COUNT_LUA_KB, (double)r->script_bytes / 1024.0);
    scene_counts(s);
    r->memory = scene_memory_use(s);
}

// ---- by name ----

double app_count_value(const app_report *r, core_count count) {
    return scene_room_built(app_count_rooms[count]) ? core_metrics_get(r->metrics, count) : NAN;
}

static double summary_value(core_summary s, const char *key, bool *known) {
    const struct {
        const char *name;
        double value;
    } field[] = {{"mean", s.mean}, {"p50", s.p50}, {"p95", s.p95},
                 {"p99", s.p99},   {"max", s.max}, {"total", s.total}};
    for (size_t i = 0; i < CORE_COUNT_OF(field); i++) {
        if (strcmp(field[i].name, key) == 0) {
            return field[i].value;
        }
    }
    *known = false;
    return NAN;
}

// "stages.phys.broad.p95": the stage's name itself holds dots, the figure is the last word.
static double stage_value(const app_report *r, const char *rest, bool *known) {
    const char *dot = strrchr(rest, '.');
    for (int i = 0; dot && i < CORE_STAGE_TOTAL; i++) {
        const char *name = core_stage_name((core_stage)i);
        if (strlen(name) == (size_t)(dot - rest) && strncmp(name, rest, strlen(name)) == 0) {
            return summary_value(core_metrics_stage(r->metrics, (core_stage)i), dot + 1, known);
        }
    }
    *known = false;
    return NAN;
}

static double accuracy_value(const app_report *r, const char *name, bool *known) {
    for (int i = 0; i < APP_ACCURACY_COUNT; i++) {
        size_t length = strlen(app_accuracy_names[i].name);
        if (strncmp(name, app_accuracy_names[i].name, length) != 0) {
            continue;
        }
        if (name[length] == 0) {
            return r->accuracy[i];
        }
        if (app_accuracy_names[i].peak && strcmp(name + length, "_peak") == 0) {
            return r->peak[i];
        }
    }
    *known = false;
    return NAN;
}

static double count_value(const app_report *r, const char *name, bool *known) {
    for (int i = 0; i < CORE_COUNT_TOTAL; i++) {
        if (strcmp(core_count_name((core_count)i), name) == 0) {
            return app_count_value(r, (core_count)i);
        }
    }
    *known = false;
    return NAN;
}

static double user_value(const app_report *r, const char *name, bool *known) {
    for (uint32_t i = 0; i < r->user_count; i++) {
        if (strcmp(r->user[i].name, name) == 0) {
            return r->user[i].value;
        }
    }
    *known = false;
    return NAN;
}

static double top_value(const app_report *r, const char *name, bool *known) {
    const struct {
        const char *name;
        double value;
    } top[] = {{"seed", (double)r->seed},
               {"threads", r->threads},
               {"dt", r->dt},
               {"steps", (double)r->steps},
               {"wall_s", r->wall_s},
               {"realtime_factor", r->wall_s > 0 ? r->simulated_s / r->wall_s : NAN},
               {"steady_allocations", (double)app_report_steady_allocations(r)},
               {"warnings", r->warnings.count + r->warnings.more},
               {"asserts", r->asserts.count + r->asserts.more}};
    for (size_t i = 0; i < CORE_COUNT_OF(top); i++) {
        if (strcmp(top[i].name, name) == 0) {
            return top[i].value;
        }
    }
    *known = false;
    return NAN;
}

static double memory_value(const app_report *r, const char *name, bool *known) {
    app_memory_line line[APP_MEMORY_LINES];
    app_memory_lines(r, line);
    for (size_t i = 0; i < APP_MEMORY_LINES; i++) {
        if (strcmp(line[i].name, name) == 0) {
            return line[i].value;
        }
    }
    *known = false;
    return NAN;
}

double app_report_value(const app_report *r, const char *path, bool *known) {
    static const struct {
        const char *prefix;
        double (*value)(const app_report *, const char *, bool *);
    } section[] = {{"accuracy.", accuracy_value},
                   {"counts.", count_value},
                   {"stages.", stage_value},
                   {"memory.", memory_value},
                   {"user.", user_value}};
    *known = true;
    for (size_t i = 0; i < CORE_COUNT_OF(section); i++) {
        size_t length = strlen(section[i].prefix);
        if (strncmp(path, section[i].prefix, length) == 0) {
            return section[i].value(r, path + length, known);
        }
    }
    if (strncmp(path, "step_ms.", 8) == 0) {
        return summary_value(core_metrics_step(r->metrics), path + 8, known);
    }
    return top_value(r, path, known);
}
