// What a run tells about itself: metrics JSON (design page 5), CSV, the readable table, the
// receipt.
#ifndef APP_REPORT_H
#define APP_REPORT_H

#include <stdio.h>

#include "app/options.h"
#include "scene/scene.h"
#include "script/script.h"

#define APP_VERSION "0.1.0"

typedef enum app_accuracy_id {
    APP_PENETRATION_MAX,
    APP_PENETRATION_MEAN,
    APP_ENERGY,
    APP_ENERGY_DRIFT,
    APP_MOMENTUM_DRIFT,
    APP_JOINT_ERROR,
    APP_TUNNELLED,
    APP_NAN,
    APP_ANIM_ERROR,
    APP_PATH_RATIO,
    APP_ACCURACY_COUNT
} app_accuracy_id;

typedef struct app_user_metric {
    char name[64];
    double value;
} app_user_metric;

#define APP_MAX_USER     256
#define APP_MAX_WARNINGS 64
typedef struct app_text_list {
    char *text[APP_MAX_WARNINGS]; // core_alloc'd
    uint32_t count, more;         // more: those left out
} app_text_list;

typedef struct app_report {
    // Fixed for the run.
    const char *scene_name;
    uint64_t seed;
    int threads;
    double dt; // s
    core_metrics *metrics;
    // Grows with it.
    uint64_t steps, hash;
    double wall_s, simulated_s;
    double accuracy[APP_ACCURACY_COUNT], peak[APP_ACCURACY_COUNT]; // NaN: does not apply
    bool accuracy_off, sampled;
    scene_memory memory; // bytes
    size_t script_bytes;
    uint32_t *step_allocations; // [steps] engine heap allocations inside each step
    uint64_t step_allocations_capacity;
    uint64_t frames, capped_frames; // frames whose catch-up was cut
    double dropped_s;               // time that they gave up
    app_user_metric *user;          // [APP_MAX_USER], made with the first one
    uint32_t user_count;
    script_mod_info mod[APP_MAX_MODS]; // of the last scene
    int mod_count;
    app_text_list warnings, asserts;
    char device[128];                 // GL renderer, "" when none was made
    uint32_t passes, shader_variants; // of the last frame
    gfx_pass_use pass[32];            // of all frames
    uint32_t pass_count;
    FILE *csv;
} app_report;

void app_report_init(app_report *r);
void app_report_new_scene(app_report *r); // figures of the last step start anew, peaks stay
void app_report_release(app_report *r);
void app_text_list_add(app_text_list *list, const char *text); // repeated texts count once
void app_report_user(app_report *r, const char *name, double value);
// Reads the accuracy of the scene's present state (stage "metrics").
void app_report_sample(app_report *r, scene *s);
// Closes a step in which the engine made so many heap allocations.
void app_report_step(app_report *r, uint64_t allocations);
// Counts, memory; before the writers below.
void app_report_finish(app_report *r, const scene *s, const script *code);

uint64_t app_report_steady_allocations(const app_report *r);
// Value by dotted path as in the JSON ("accuracy.nan", "stages.phys.p95"); NaN for null.
double app_report_value(const app_report *r, const char *path, bool *known);

// path "-": stdout. False + core_fail.
bool app_report_write_json(const app_report *r, const char *path);
bool app_report_open_csv(app_report *r, const char *path);
void app_report_csv_line(app_report *r); // of the step just closed
void app_report_table(const app_report *r, FILE *out);
void app_report_receipt(const app_report *r, FILE *out);

#endif
