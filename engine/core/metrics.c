#include "core/metrics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/clock.h"
#include "core/file.h"
#include "core/memory.h"

// Steps of which every sample is kept: more than 19 hours at 60 Hz. Beyond, totals, means and
// maxima stay exact and percentiles are of the first ones.
#define SAMPLES_MAX   ((size_t)1 << 22)
#define SAMPLES_FIRST ((size_t)4096)
#define DEPTH_MAX     32
#define NS_PER_MS     1e6

// One series of samples. The memory of a series that stays zero is never touched.
typedef struct series {
    uint64_t *samples; // ns, one per step, in a reserved range
    uint64_t current;  // ns so far in this step
    uint64_t last, max, total;
} series;

enum { SERIES_STEP = CORE_STAGE_TOTAL, SERIES_SCRATCH, SERIES_COUNT };

struct core_metrics {
    series series[SERIES_COUNT]; // stages, the step itself, room for selecting percentiles
    uint64_t steps;
    size_t committed; // samples per series
    uint64_t step_start;
    struct {
        core_stage stage;
        uint64_t start;
    } stack[DEPTH_MAX];
    int depth;
    int open[CORE_STAGE_TOTAL]; // a stage inside itself counts once
    double counts[CORE_COUNT_TOTAL];
    FILE *trace;
    uint64_t trace_start;
};

#define STAGE_NAME_(id, name) name,
static const char *const stage_names[] = {CORE_STAGES(STAGE_NAME_)};
static const char *const count_names[] = {CORE_COUNTS(STAGE_NAME_)};

const char *core_stage_name(core_stage stage) { return stage_names[stage]; }
const char *core_count_name(core_count count) { return count_names[count]; }

static bool commit_samples(core_metrics *m, size_t samples) {
    if (samples <= m->committed) {
        return true;
    }
    size_t wanted = CORE_MIN(CORE_MAX(m->committed * 2, SAMPLES_FIRST), SAMPLES_MAX);
    for (int i = 0; i < SERIES_COUNT; ++i) {
        if (!core_commit(m->series[i].samples, wanted * sizeof(uint64_t))) {
            return false;
        }
    }
    m->committed = wanted;
    return true;
}

core_metrics *core_metrics_create(void) {
    uint64_t *samples = core_reserve(SERIES_COUNT * SAMPLES_MAX * sizeof(uint64_t));
    if (!samples) {
        return NULL;
    }
    core_metrics *m = core_alloc(sizeof *m);
    for (int i = 0; i < SERIES_COUNT; ++i) {
        m->series[i].samples = samples + (size_t)i * SAMPLES_MAX;
    }
    if (!commit_samples(m, 1)) {
        core_metrics_destroy(m);
        return NULL;
    }
    return m;
}

void core_metrics_destroy(core_metrics *m) {
    if (m) {
        core_metrics_trace(m, NULL);
        core_unreserve(m->series[0].samples, SERIES_COUNT * SAMPLES_MAX * sizeof(uint64_t));
        core_free(m);
    }
}

static void trace_event(core_metrics *m, const char *name, uint64_t start, uint64_t ns) {
    if (m->trace) {
        fprintf(m->trace,
                ",\n{\"name\":\"%s\",\"ph\":\"X\",\"pid\":1,\"tid\":1,\"ts\":%.3f,\"dur\":%.3f}",
                name, (double)(int64_t)(start - m->trace_start) / 1e3, (double)ns / 1e3);
    }
}

// A step's samples are written when it ends; zeros are there already.
static void close_sample(core_metrics *m, series *s, bool keep) {
    if (keep && s->current) {
        s->samples[m->steps] = s->current;
    }
    s->last = s->current;
    s->max = CORE_MAX(s->max, s->current);
    s->current = 0;
}

void core_metrics_step_begin(core_metrics *m) {
    if (m) {
        m->step_start = core_clock_ns();
    }
}

void core_metrics_step_exclude_ns(core_metrics *m, uint64_t ns) {
    if (m) {
        m->step_start += ns;
    }
}

void core_metrics_step_end(core_metrics *m) {
    if (!m) {
        return;
    }
    CORE_ASSERT(m->depth == 0);
    uint64_t ns = core_clock_ns() - m->step_start;
    m->series[SERIES_STEP].current = ns;
    m->series[SERIES_STEP].total += ns;
    bool keep = m->steps < SAMPLES_MAX && commit_samples(m, m->steps + 1);
    for (int i = 0; i <= SERIES_STEP; ++i) {
        close_sample(m, &m->series[i], keep);
    }
    m->steps++;
    trace_event(m, "step", m->step_start, ns);
}

void core_stage_begin(core_metrics *m, core_stage stage) {
    if (!m) {
        return;
    }
    CORE_ASSERT(m->depth < DEPTH_MAX);
    if (m->depth < DEPTH_MAX) {
        m->open[stage]++;
        m->stack[m->depth].stage = stage;
        m->stack[m->depth].start = core_clock_ns();
    }
    m->depth++;
}

void core_stage_end(core_metrics *m, core_stage stage) {
    if (!m) {
        return;
    }
    CORE_ASSERT(m->depth > 0);
    if (m->depth == 0 || --m->depth >= DEPTH_MAX) {
        return;
    }
    CORE_ASSERT(m->stack[m->depth].stage == stage);
    stage = m->stack[m->depth].stage;
    uint64_t start = m->stack[m->depth].start, ns = core_clock_ns() - start;
    if (--m->open[stage] == 0) {
        core_stage_add_ns(m, stage, ns);
    }
    trace_event(m, stage_names[stage], start, ns);
}

void core_stage_add_ns(core_metrics *m, core_stage stage, uint64_t ns) {
    if (m) {
        m->series[stage].current += ns;
        m->series[stage].total += ns;
    }
}

void core_metrics_set(core_metrics *m, core_count count, double value) {
    if (m) {
        m->counts[count] = value;
    }
}

double core_metrics_get(const core_metrics *m, core_count count) {
    return m ? m->counts[count] : 0.0;
}

// Moves the value of rank k (0-based) to a[k], smaller ones before it, larger ones after it.
// Hoare, "Algorithm 65: find", CACM 1961, with the median of three as pivot.
static uint64_t select_rank(uint64_t *a, size_t n, size_t k) {
    size_t low = 0, high = n - 1;
    while (low < high) {
        uint64_t x = a[low], y = a[low + (high - low) / 2], z = a[high];
        uint64_t pivot = CORE_MAX(CORE_MIN(x, y), CORE_MIN(CORE_MAX(x, y), z));
        size_t i = low, j = high;
        for (;;) {
            while (a[i] < pivot) {
                ++i;
            }
            while (a[j] > pivot) {
                --j;
            }
            if (i >= j) {
                break;
            }
            uint64_t swap = a[i];
            a[i++] = a[j];
            a[j--] = swap;
        }
        // [low, j] <= pivot <= [j + 1, high], and j < high: the median is no lone maximum.
        if (k <= j) {
            high = j;
        } else {
            low = j + 1;
        }
    }
    return a[k];
}

// Nearest rank: the smallest sample that at least `fraction` of all samples do not exceed.
static double percentile_ms(uint64_t *samples, size_t n, double fraction) {
    size_t rank = (size_t)ceil(fraction * (double)n);
    return (double)select_rank(samples, n, rank ? rank - 1 : 0) / NS_PER_MS;
}

static core_summary summarise(const core_metrics *m, const series *s) {
    // Time that has not become a sample yet (drawing after the last step) shows in max and total.
    core_summary summary = {
        .max = (double)CORE_MAX(s->max, s->current) / NS_PER_MS,
        .total = (double)s->total / NS_PER_MS,
        .samples = m->steps,
    };
    size_t kept = CORE_MIN(m->steps, m->committed);
    if (kept == 0) {
        return summary;
    }
    summary.mean = summary.total / (double)m->steps;
    if (s->max == 0) {
        return summary; // all samples are zero: leave their memory alone
    }
    uint64_t *scratch = m->series[SERIES_SCRATCH].samples;
    memcpy(scratch, s->samples, kept * sizeof *scratch);
    summary.p50 = percentile_ms(scratch, kept, 0.50);
    summary.p95 = percentile_ms(scratch, kept, 0.95);
    summary.p99 = percentile_ms(scratch, kept, 0.99);
    return summary;
}

core_summary core_metrics_step(const core_metrics *m) {
    return summarise(m, &m->series[SERIES_STEP]);
}

core_summary core_metrics_stage(const core_metrics *m, core_stage stage) {
    return summarise(m, &m->series[stage]);
}

double core_metrics_stage_last(const core_metrics *m, core_stage stage) {
    return (double)m->series[stage].last / NS_PER_MS;
}

double core_metrics_step_last(const core_metrics *m) {
    return (double)m->series[SERIES_STEP].last / NS_PER_MS;
}

uint64_t core_metrics_steps(const core_metrics *m) { return m->steps; }

static bool trace_close(core_metrics *m) {
    if (!m->trace) {
        return true;
    }
    fputs("\n]\n", m->trace);
    bool broken = ferror(m->trace) != 0;
    broken |= fclose(m->trace) != 0;
    m->trace = NULL;
    return broken ? core_fail("trace: not all events could be written; is the disk full?") : true;
}

bool core_metrics_trace(core_metrics *m, const char *path) {
    bool closed = trace_close(m);
    if (!path) {
        return closed;
    }
    if (!core_make_parents(path)) {
        return false;
    }
    m->trace = fopen(path, "we");
    if (!m->trace) {
        return core_fail("cannot write trace '%s': %m", path);
    }
    m->trace_start = core_clock_ns();
    fputs("[\n{\"name\":\"process_name\",\"ph\":\"M\",\"pid\":1,\"args\":{\"name\":\"corsac\"}}",
          m->trace);
    return true;
}
