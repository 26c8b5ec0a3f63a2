// Lab kernels: small C programs that a room offers to the lab (`corsac lab-run NAME --case JSON`).
// A kernel reads its case by name, does its work, and writes its figures into one JSON object:
// `error` values and, when asked to time itself (`timed` in the case), `cost_ns` by process CPU
// time. What a case holds and what the figures mean stands in the experiment files (scripts/lab/).
#ifndef CORE_LAB_H
#define CORE_LAB_H

#include "core/json.h"

typedef struct core_lab_param {
    const char *name;
    const char *text; // NULL: a number
    double number;
} core_lab_param;

typedef struct core_lab_case {
    const core_lab_param *param;
    uint32_t count;
} core_lab_case;

// Value of a parameter, `fallback` when the case does not give it or gives the other type.
double core_lab_number(const core_lab_case *c, const char *name, double fallback);
const char *core_lab_text(const core_lab_case *c, const char *name, const char *fallback);

typedef struct core_lab_kernel {
    const char *name;
    const char *what;   // one line: what is computed against which reference
    const char *params; // "method: sin|cos|...; n: count" for --list
    // Writes keys into the open object of `out`. False + core_fail for a bad case.
    bool (*run)(const core_lab_case *c, core_json *out);
} core_lab_kernel;

// Kernels of core: "math" (ULP against ns), "layout" (AoS, SoA, AoSoA: ns per element).
extern const core_lab_kernel core_lab_math, core_lab_layout;

// Runs `body` until at least `target_ns` of CPU time have passed, three times, and gives the median
// time of one run in ns. The first run warms up and is not counted.
typedef void core_lab_body(void *ctx);
double core_lab_time(core_lab_body *body, void *ctx, double target_ns);

#endif
