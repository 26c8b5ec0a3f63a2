// One run of `corsac run`: what its files share.
#ifndef APP_RUN_H
#define APP_RUN_H

#include "app/files.h"
#include "app/input.h"
#include "app/journal.h"
#include "app/options.h"
#include "app/report.h"
#include "app/sound.h"
#include "script/script.h"

typedef enum app_exit { // design page 4
    APP_EXIT_FINE = 0,
    APP_EXIT_SCRIPT = 1,
    APP_EXIT_USAGE = 2,
    APP_EXIT_EXPECTATION = 3,
    APP_EXIT_DIVERGED = 4,
    APP_EXIT_ENVIRONMENT = 5,
    APP_EXIT_INTERRUPTED = 130
} app_exit;

#define APP_OPEN_END   UINT64_MAX
#define APP_MAX_PARAMS 256

typedef struct app_run {
    const app_options *opt;
    app_scene_path path;
    char entry[256]; // virtual path of the present scene
    core_vfs *vfs;
    core_jobs *jobs;
    core_metrics *metrics;
    scene *scene;
    script *script;
    script_host host;
    script_conf conf;
    gfx_device *device;
    app_input input;
    app_sound sound;
    app_report report;
    app_recorder *recorder;
    app_replay *replay;
    app_journal_header start; // what the run was started with: given, or read from a recording
    const char *argument[16];
    char mod[APP_MAX_MODS][APP_PATH_MAX]; // folders
    uint32_t mod_count;
    char param[APP_MAX_PARAMS][64]; // names that the script asked for
    uint32_t param_count;
    uint64_t last_step;  // APP_OPEN_END: until told
    uint64_t sampled_at; // report.steps of the last accuracy sample
    uint64_t filed_at;   // report.steps of the last frame written to a file
    uint32_t heard;      // queued events that the script heard during a pause
    uint32_t width, height;
    int expectations_missed;
    // asked for by keys or the script, done between steps
    bool paused, single_step, quit, reload;
    struct app_overlay *overlay; // F1, NULL: never shown
    float time_scale;
    int exit_code;
    char next_scene[256];    // "": stay
    char *run_data;          // JSON from the former scene to the next, NULL: none
    const char *caption;     // drawn over every frame, NULL: none
    struct app_ghost *ghost; // F2: the reference beside the live run, NULL: none
    bool ghost_wanted;       // from the next reload on
    app_exit failed;         // first reason that ended the run, APP_EXIT_FINE: none
} app_run;

// run.c: create never gives NULL; r->failed says why it cannot be opened. destroy gives the exit
// code and closes no scene: call app_scene_close before.
app_run *app_run_create(const app_options *opt);
bool app_run_open(app_run *r); // files, scene, outputs
int app_run_destroy(app_run *r);
bool app_interrupted(void);
bool app_fail(app_run *r, app_exit why); // keeps the first; false
// start.c
bool app_start_read(app_run *r);          // into r->start; false: r->failed says why
void app_start_compare_files(app_run *r); // hashes them; warns where a recording has others
// mods.c
bool app_mods_find(app_run *r); // into r->mod; false + core_fail
// session.c
bool app_scene_open(app_run *r);  // false: r->failed says why
void app_scene_close(app_run *r); // quit callback, expectations
void app_end_of_run(app_run *r);  // sets r->last_step
// host.c
script_host app_host(app_run *r);
// loop.c
void app_loop(app_run *r);
bool app_step(app_run *r); // one step; false when the run is over
// frame.c
bool app_device_open(app_run *r, bool window);
bool app_frame(app_run *r, float alpha); // draws the scene and the overlay
bool app_frame_wanted(const app_run *r, uint64_t step);
bool app_frame_files(app_run *r, uint64_t step); // shots and video of this step
// progress.c
void app_progress(const app_run *r);
void app_progress_end(const app_run *r);

#endif
