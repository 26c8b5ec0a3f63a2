#include "core/lab.h"

#include <string.h>

#include "core/clock.h"

static const core_lab_param *find(const core_lab_case *c, const char *name) {
    for (uint32_t i = 0; i < c->count; i++) {
        if (strcmp(c->param[i].name, name) == 0) {
            return &c->param[i];
        }
    }
    return NULL;
}

double core_lab_number(const core_lab_case *c, const char *name, double fallback) {
    const core_lab_param *p = find(c, name);
    return p && !p->text ? p->number : fallback;
}

const char *core_lab_text(const core_lab_case *c, const char *name, const char *fallback) {
    const core_lab_param *p = find(c, name);
    return p && p->text ? p->text : fallback;
}

static double one_sample(core_lab_body *body, void *ctx, double target_ns) {
    uint64_t start = core_clock_cpu_ns(), now = start;
    uint32_t runs = 0;
    for (uint32_t batch = 1; (double)(now - start) < target_ns; batch *= 2) {
        for (uint32_t i = 0; i < batch; i++) {
            body(ctx);
        }
        runs += batch;
        now = core_clock_cpu_ns();
    }
    return (double)(now - start) / runs;
}

double core_lab_time(core_lab_body *body, void *ctx, double target_ns) {
    body(ctx);
    double a = one_sample(body, ctx, target_ns), b = one_sample(body, ctx, target_ns);
    double c = one_sample(body, ctx, target_ns);
    double lo = CORE_MIN(a, b), hi = CORE_MAX(a, b);
    return CORE_CLAMP(c, lo, hi);
}
