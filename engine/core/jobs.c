#include "core/jobs.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#include "core/clock.h"

#define SPIN_NS         20000u
#define SPINS_PER_CLOCK 32

#if defined(__x86_64__) || defined(__i386__)
#define CPU_RELAX() __builtin_ia32_pause()
#else
#define CPU_RELAX() ((void)0)
#endif

// A job is published by `ticket` = epoch << 32 | chunks not yet claimed. Claiming is a
// compare-and-swap that counts down, so it succeeds only while that very job has chunks left; the
// job cannot end before the claimed chunk has run, so the fields read before the swap were this
// job's. A worker that wakes late finds an older epoch or no chunks, and touches nothing. The gaps
// keep what different threads write on different cache lines.
struct core_jobs {
    _Atomic uint64_t ticket;
    char gap_a[CORE_ALIGN];
    _Atomic uint32_t unfinished; // chunks that have not run to their end
    char gap_b[CORE_ALIGN];
    _Atomic(core_job_fn *) fn;
    _Atomic(void *) ctx;
    _Atomic uint32_t count, grain, chunks;
    uint32_t epoch; // the caller's

    char gap_c[CORE_ALIGN];
    pthread_mutex_t lock;
    pthread_cond_t work; // workers wait here for a new ticket
    pthread_cond_t done; // the caller waits here for the last chunk
    _Atomic uint32_t sleeping;
    _Atomic bool caller_sleeps, stop;

    int threads; // the caller included
    bool spins;
    struct worker {
        core_jobs *jobs;
        uint32_t index;
        pthread_t thread;
    } workers[CORE_JOBS_MAX_THREADS];
};

// Whose job this thread runs just now, and as which worker: a nested call runs serially under the
// same index, so that per-worker scratch stays its own.
static _Thread_local struct {
    const core_jobs *jobs;
    uint32_t worker;
} running;

static uint32_t chunks_left(uint64_t ticket) { return (uint32_t)ticket; }

static void run_chunk(core_job_fn *fn, void *ctx, uint32_t count, uint32_t grain, uint32_t chunk,
                      uint32_t worker) {
    uint32_t begin = chunk * grain;
    uint32_t end = count - begin < grain ? count : begin + grain;
    fn(ctx, begin, end, chunk, worker);
}

static void finish_chunk(core_jobs *jobs) {
    if (atomic_fetch_sub(&jobs->unfinished, 1) == 1 && atomic_load(&jobs->caller_sleeps)) {
        pthread_mutex_lock(&jobs->lock);
        pthread_cond_signal(&jobs->done);
        pthread_mutex_unlock(&jobs->lock);
    }
}

// Claims and runs chunks until none is left.
static void work(core_jobs *jobs, uint32_t worker) {
    uint64_t ticket = atomic_load_explicit(&jobs->ticket, memory_order_acquire);
    while (chunks_left(ticket)) {
        core_job_fn *fn = atomic_load_explicit(&jobs->fn, memory_order_relaxed);
        void *ctx = atomic_load_explicit(&jobs->ctx, memory_order_relaxed);
        uint32_t count = atomic_load_explicit(&jobs->count, memory_order_relaxed);
        uint32_t grain = atomic_load_explicit(&jobs->grain, memory_order_relaxed);
        uint32_t chunks = atomic_load_explicit(&jobs->chunks, memory_order_relaxed);
        if (atomic_compare_exchange_weak_explicit(&jobs->ticket, &ticket, ticket - 1,
                                                  memory_order_acq_rel, memory_order_acquire)) {
            run_chunk(fn, ctx, count, grain, chunks - chunks_left(ticket), worker);
            finish_chunk(jobs);
            ticket = atomic_load_explicit(&jobs->ticket, memory_order_acquire);
        }
    }
}

static bool has_work(core_jobs *jobs) {
    return chunks_left(atomic_load(&jobs->ticket)) || atomic_load(&jobs->stop);
}

static bool is_done(core_jobs *jobs) { return atomic_load(&jobs->unfinished) == 0; }

static bool spin_until(core_jobs *jobs, bool (*ready)(core_jobs *)) {
    if (!jobs->spins) {
        return ready(jobs);
    }
    uint64_t start = core_clock_ns();
    do {
        for (int i = 0; i < SPINS_PER_CLOCK; ++i) {
            if (ready(jobs)) {
                return true;
            }
            CPU_RELAX();
        }
    } while (core_clock_ns() - start < SPIN_NS);
    return false;
}

// The sleeper announces itself, then looks once more; the other side changes the state, then looks
// for sleepers. With sequentially consistent order one of the two sees the other.
static void wait_for_work(core_jobs *jobs) {
    if (spin_until(jobs, has_work)) {
        return;
    }
    pthread_mutex_lock(&jobs->lock);
    atomic_fetch_add(&jobs->sleeping, 1);
    while (!has_work(jobs)) {
        pthread_cond_wait(&jobs->work, &jobs->lock);
    }
    atomic_fetch_sub(&jobs->sleeping, 1);
    pthread_mutex_unlock(&jobs->lock);
}

static void wait_for_end(core_jobs *jobs) {
    if (spin_until(jobs, is_done)) {
        return;
    }
    pthread_mutex_lock(&jobs->lock);
    atomic_store(&jobs->caller_sleeps, true);
    while (!is_done(jobs)) {
        pthread_cond_wait(&jobs->done, &jobs->lock);
    }
    atomic_store(&jobs->caller_sleeps, false);
    pthread_mutex_unlock(&jobs->lock);
}

static void *worker_main(void *arg) {
    struct worker *self = arg;
    core_jobs *jobs = self->jobs;
    running.jobs = jobs;
    running.worker = self->index;
    while (!atomic_load(&jobs->stop)) {
        work(jobs, self->index);
        wait_for_work(jobs);
    }
    return NULL;
}

// Signals stay with the threads of the program: workers start with all of them blocked.
static bool start_worker(core_jobs *jobs, int index) {
    struct worker *worker = &jobs->workers[index];
    *worker = (struct worker){.jobs = jobs, .index = (uint32_t)index};
    sigset_t all, former;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &former);
    int error = pthread_create(&worker->thread, NULL, worker_main, worker);
    pthread_sigmask(SIG_SETMASK, &former, NULL);
    if (error) {
        return core_fail("jobs: cannot start worker %d: %s; ask for fewer threads", index,
                         strerror(error));
    }
    jobs->threads = index + 1;
    return true;
}

core_jobs *core_jobs_create(int threads) {
    int processors = (int)sysconf(_SC_NPROCESSORS_ONLN);
    int wanted = threads == 0 ? CORE_CLAMP(processors, 1, CORE_JOBS_MAX_THREADS) : threads;
    if (wanted < 1 || wanted > CORE_JOBS_MAX_THREADS) {
        core_fail("jobs: %d threads, expected 0 to %d", threads, CORE_JOBS_MAX_THREADS);
        return NULL;
    }
    core_jobs *jobs = core_alloc(sizeof *jobs);
    pthread_mutex_init(&jobs->lock, NULL);
    pthread_cond_init(&jobs->work, NULL);
    pthread_cond_init(&jobs->done, NULL);
    jobs->threads = 1;
    jobs->spins = wanted <= processors; // spinning would take the processor from who has the work
    for (int i = 1; i < wanted; ++i) {
        if (!start_worker(jobs, i)) {
            core_jobs_destroy(jobs);
            return NULL;
        }
    }
    return jobs;
}

void core_jobs_destroy(core_jobs *jobs) {
    if (!jobs) {
        return;
    }
    pthread_mutex_lock(&jobs->lock);
    atomic_store(&jobs->stop, true);
    pthread_cond_broadcast(&jobs->work);
    pthread_mutex_unlock(&jobs->lock);
    for (int i = 1; i < jobs->threads; ++i) {
        pthread_join(jobs->workers[i].thread, NULL);
    }
    pthread_cond_destroy(&jobs->done);
    pthread_cond_destroy(&jobs->work);
    pthread_mutex_destroy(&jobs->lock);
    core_free(jobs);
}

int core_jobs_threads(const core_jobs *jobs) { return jobs ? jobs->threads : 1; }

static void publish(core_jobs *jobs, uint32_t count, uint32_t grain, uint32_t chunks,
                    core_job_fn *fn, void *ctx) {
    atomic_store_explicit(&jobs->fn, fn, memory_order_relaxed);
    atomic_store_explicit(&jobs->ctx, ctx, memory_order_relaxed);
    atomic_store_explicit(&jobs->count, count, memory_order_relaxed);
    atomic_store_explicit(&jobs->grain, grain, memory_order_relaxed);
    atomic_store_explicit(&jobs->chunks, chunks, memory_order_relaxed);
    atomic_store_explicit(&jobs->unfinished, chunks, memory_order_relaxed);
    atomic_store(&jobs->ticket, (uint64_t)++jobs->epoch << 32 | chunks);
    uint32_t wake = CORE_MIN(atomic_load(&jobs->sleeping), chunks - 1);
    if (wake) {
        pthread_mutex_lock(&jobs->lock);
        for (uint32_t i = 0; i < wake; ++i) {
            pthread_cond_signal(&jobs->work);
        }
        pthread_mutex_unlock(&jobs->lock);
    }
}

void core_jobs_for(core_jobs *jobs, uint32_t count, uint32_t grain, core_job_fn *fn, void *ctx) {
    CORE_ASSERT(grain > 0);
    uint32_t chunks = core_jobs_chunks(count, grain);
    bool nested = jobs && running.jobs == jobs;
    if (core_jobs_threads(jobs) == 1 || chunks <= 1 || nested) {
        uint32_t worker = nested ? running.worker : 0;
        for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
            run_chunk(fn, ctx, count, grain, chunk, worker);
        }
        return;
    }
    publish(jobs, count, grain, chunks, fn, ctx);
    const core_jobs *outer = running.jobs;
    uint32_t outer_worker = running.worker;
    running.jobs = jobs;
    running.worker = 0;
    work(jobs, 0);
    running.jobs = outer;
    running.worker = outer_worker;
    wait_for_end(jobs);
}
