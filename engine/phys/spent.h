// Time of work that runs in parts inside other stages, on any worker: it is gathered in the world
// and told to the metrics at the end of the step. Unmeasured worlds read no clock.
#ifndef PHYS_SPENT_H
#define PHYS_SPENT_H

#include <stdatomic.h>

#include "core/clock.h"
#include "core/metrics.h"

typedef struct phys_spent {
    _Atomic uint64_t fields, ccd; // ns in this step
} phys_spent;

static inline uint64_t phys_spent_begin(const core_metrics *metrics) {
    return metrics ? core_clock_ns() : 0;
}

// `share`: how many calls this one stands for, where only some are timed.
static inline void phys_spent_end(_Atomic uint64_t *sum, uint64_t begin, uint64_t share) {
    if (begin) {
        atomic_fetch_add_explicit(sum, share * (core_clock_ns() - begin), memory_order_relaxed);
    }
}

static inline void phys_spent_tell(phys_spent *spent, core_metrics *metrics) {
    uint64_t fields = atomic_exchange(&spent->fields, 0), ccd = atomic_exchange(&spent->ccd, 0);
    if (fields) {
        core_stage_add_ns(metrics, CORE_STAGE_PHYS_FIELDS, fields);
    }
    if (ccd) {
        core_stage_add_ns(metrics, CORE_STAGE_PHYS_CCD, ccd);
    }
}

#endif
