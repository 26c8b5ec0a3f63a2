// Parallel-for over chunks whose bounds depend on count and grain only, never on the number of
// threads: results that are combined per chunk are the same with any --threads.
#ifndef CORE_JOBS_H
#define CORE_JOBS_H

#include "core/base.h"

#define CORE_JOBS_MAX_THREADS 64

// Serves one calling thread at a time; worlds on several threads have one each.
typedef struct core_jobs core_jobs;

// threads: workers including the caller, 1..64; 0 = number of processors. Idle workers spin at
// most about 20 us, then sleep. NULL + core_fail when a thread cannot be made.
core_jobs *core_jobs_create(int threads);
void core_jobs_destroy(core_jobs *jobs);
int core_jobs_threads(const core_jobs *jobs); // NULL: 1

// begin/end: the chunk; chunk: its number; worker: 0..threads-1 (index for per-worker scratch).
typedef void core_job_fn(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker);
static inline uint32_t core_jobs_chunks(uint32_t count, uint32_t grain) {
    return grain ? count / grain + (count % grain != 0) : 0;
}
// Runs fn over ceil(count/grain) chunks; returns when all are done. The caller works too. jobs NULL
// or one chunk: serial, in order, on the caller. Calls do not nest: one from inside a job runs
// serially.
void core_jobs_for(core_jobs *jobs, uint32_t count, uint32_t grain, core_job_fn *fn, void *ctx);

#endif
