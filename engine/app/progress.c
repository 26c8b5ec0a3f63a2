// A progress bar for long runs: on a terminal only, never in a pipe.
#include <string.h>
#include <unistd.h>

#include "app/run.h"

#define WIDTH 30

static bool shown(const app_run *r) {
    return !r->opt->quiet && r->last_step != APP_OPEN_END && r->last_step > 0 &&
           isatty(STDERR_FILENO);
}

void app_progress(const app_run *r) {
    // Every hundredth of the run: no clock needed, and a short run is not slowed by its terminal.
    uint64_t part = CORE_MAX(r->last_step / 100, 1u);
    if (r->report.steps % part != 0 || !shown(r)) {
        return;
    }
    char bar[WIDTH + 1];
    size_t full = (size_t)((double)WIDTH * (double)r->report.steps / (double)r->last_step);
    memset(bar, '.', WIDTH);
    memset(bar, '#', CORE_MIN(full, (size_t)WIDTH));
    bar[WIDTH] = 0;
    fprintf(stderr, "\r[%s] step %llu of %llu, %.2f ms", bar, (unsigned long long)r->report.steps,
            (unsigned long long)r->last_step, core_metrics_step_last(r->metrics));
}

void app_progress_end(const app_run *r) {
    if (shown(r)) {
        fprintf(stderr, "\r%*s\r", WIDTH + 50, "");
    }
}
