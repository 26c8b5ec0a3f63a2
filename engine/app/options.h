// The command line of `corsac run`: one table drives parsing, --help and the errors.
#ifndef APP_OPTIONS_H
#define APP_OPTIONS_H

#include "core/base.h"

#define APP_MAX_SETS  128
#define APP_MAX_SHOTS 32
#define APP_MAX_MODS  32

typedef struct app_set {
    char name[64], value[64];
} app_set;

typedef struct app_shot {
    const char *path;
    uint64_t path_length; // bytes of path before "@STEP"
    uint64_t step;        // 0: the last one
    char pass[16];        // of the frame, "": the picture
} app_shot;

typedef struct app_options {
    const char *scene;
    bool headless, hash, receipt, watch, keep_going, quiet, help;
    bool has_seed, has_steps, has_threads;
    uint64_t steps, seed, threads, substeps; // 0: not given (but see has_*)
    double seconds, dt;                      // s, 0: not given
    const char *simd, *render;
    uint32_t size[2]; // pixels, 0: not given
    app_set set[APP_MAX_SETS];
    uint32_t set_count;
    app_shot shot[APP_MAX_SHOTS];
    uint32_t shot_count;
    const char *mod[APP_MAX_MODS];
    uint32_t mod_count;
    const char *video, *audio, *metrics, *metrics_csv, *trace, *record, *replay;
    int argc; // after "--"
    const char *const *argv;
} app_options;

// argv[0] is the first word after `run`. False + core_fail: bad usage. Strings are borrowed.
bool app_options_parse(app_options *o, int argc, const char *const *argv);
// The text of --help, to stdout.
void app_options_help(void);

#endif
