#include "app/report_names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/clock.h"

const app_accuracy_name app_accuracy_names[APP_ACCURACY_COUNT] = {
    [APP_PENETRATION_MAX] = {"penetration_max_m", "phys", true},
    [APP_PENETRATION_MEAN] = {"penetration_mean_m", "phys", true},
    [APP_ENERGY] = {"energy_j", "phys", false},
    [APP_ENERGY_DRIFT] = {"energy_drift", "phys", true},
    [APP_MOMENTUM_DRIFT] = {"momentum_drift", "phys", true},
    [APP_JOINT_ERROR] = {"joint_error_max_m", "phys", true},
    [APP_TUNNELLED] = {"tunnelled", "phys", true},
    [APP_NAN] = {"nan", "phys", true},
    [APP_ANIM_ERROR] = {"anim_error_max_m", "anim", true},
    [APP_PATH_RATIO] = {"path_ratio_max", "nav", true},
};

const char *const app_count_rooms[CORE_COUNT_TOTAL] = {
    [CORE_COUNT_BODIES] = "phys",         [CORE_COUNT_AWAKE] = "phys",
    [CORE_COUNT_SHAPES] = "phys",         [CORE_COUNT_PAIRS] = "phys",
    [CORE_COUNT_CONTACTS] = "phys",       [CORE_COUNT_JOINTS] = "phys",
    [CORE_COUNT_ISLANDS_COARSE] = "phys", [CORE_COUNT_ISLANDS_FINE] = "phys",
    [CORE_COUNT_SUBSTEPS_MAX] = "phys",   [CORE_COUNT_ISLANDS] = "phys",
    [CORE_COUNT_TRIGGERS] = "phys",       [CORE_COUNT_LIGHTS] = "gfx",
    [CORE_COUNT_CLUSTERS] = "gfx",        [CORE_COUNT_LIGHT_REFS] = "gfx",
    [CORE_COUNT_DRAWS] = "gfx",           [CORE_COUNT_TRIANGLES] = "gfx",
    [CORE_COUNT_SKELETONS] = "anim",      [CORE_COUNT_BONES] = "anim",
    [CORE_COUNT_NAV_NODES] = "nav",       [CORE_COUNT_AGENTS] = "nav",
    [CORE_COUNT_PATHS] = "nav",           [CORE_COUNT_VOICES] = "audio",
    [CORE_COUNT_ENTITIES] = "scene",      [CORE_COUNT_LUA_KB] = "script",
};

// The word before the first dot; "metrics" is the program's own and always there.
const char *app_stage_room(core_stage stage) {
    static const char *const rooms[] = {"script", "scene", "phys", "anim", "nav", "audio", "gfx"};
    const char *name = core_stage_name(stage);
    for (size_t i = 0; i < CORE_COUNT_OF(rooms); i++) {
        if (strncmp(name, rooms[i], strlen(rooms[i])) == 0) {
            return rooms[i];
        }
    }
    return "scene";
}

void app_memory_lines(const app_report *r, app_memory_line line[APP_MEMORY_LINES]) {
    const app_memory_line all[APP_MEMORY_LINES] = {
        {"peak_rss_kb", "scene", (double)core_peak_rss_kb()},
        {"core", "scene", (double)r->memory.core},
        {"phys", "phys", (double)r->memory.phys},
        {"gfx", "gfx", (double)r->memory.gfx},
        {"anim", "anim", (double)r->memory.anim},
        {"nav", "nav", (double)r->memory.nav},
        {"audio", "audio", (double)r->memory.audio},
        {"script", "script", (double)r->script_bytes},
    };
    for (size_t i = 0; i < APP_MEMORY_LINES; i++) {
        line[i] = all[i];
        if (!scene_room_built(all[i].room)) {
            line[i].value = NAN;
        }
    }
}
