// Lab kernel "math": the largest and mean error of a function in ULP against libm in long double,
// and its time, beside libm's own double or float function.
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/lab.h"
#include "core/math.h"
#include "core/rng.h"

typedef struct function {
    const char *name;
    double (*ours)(double);
    long double (*exact)(long double);
    float (*ours_f)(float);
    double lo, hi; // default range
} function;

static const function functions[] = {
    {"sin", core_sin, sinl, core_sinf, -10, 10},   {"cos", core_cos, cosl, core_cosf, -10, 10},
    {"tan", core_tan, tanl, core_tanf, -1.5, 1.5}, {"asin", core_asin, asinl, core_asinf, -1, 1},
    {"acos", core_acos, acosl, core_acosf, -1, 1}, {"atan", core_atan, atanl, NULL, -10, 10},
    {"exp", core_exp, expl, core_expf, -20, 20},   {"log", core_ln, logl, core_lnf, 1e-3, 1e3},
    {"log2", core_log2, log2l, NULL, 1e-3, 1e3},   {"log10", core_log10, log10l, NULL, 1e-3, 1e3},
    {"sinh", core_sinh, sinhl, NULL, -10, 10},     {"cosh", core_cosh, coshl, NULL, -10, 10},
    {"tanh", core_tanh, tanhl, NULL, -10, 10},
};

#define POINTS 4096

typedef struct workload {
    double (*f)(double); // one of the two is called
    float (*f_single)(float);
    double x[POINTS], y[POINTS];
} workload;

static void evaluate(void *ctx) {
    workload *w = ctx;
    for (int i = 0; i < POINTS && w->f_single; i++) {
        w->y[i] = (double)w->f_single((float)w->x[i]);
    }
    for (int i = 0; i < POINTS && w->f; i++) {
        w->y[i] = w->f(w->x[i]);
    }
}

static double ulp_error(double got, long double want, bool single) {
    long double size = want < 0 ? -want : want;
    int e;
    frexpl(size, &e);
    int digits = single ? 24 : 53, lowest = single ? -149 : -1074;
    long double ulp = ldexpl(1, CORE_MAX(e - digits, lowest));
    long double d = (long double)got - want;
    return (double)((d < 0 ? -d : d) / ulp);
}

static const function *find_function(const char *name) {
    for (size_t i = 0; i < CORE_COUNT_OF(functions); i++) {
        if (strcmp(functions[i].name, name) == 0) {
            return &functions[i];
        }
    }
    return NULL;
}

static void choose(workload *w, const function *f, bool single, bool libm) {
    char symbol[32];
    snprintf(symbol, sizeof symbol, "%s%s", f->name, single ? "f" : "");
    void *found = libm ? dlsym(RTLD_DEFAULT, symbol) : NULL;
    if (single) {
        memcpy(&w->f_single, libm ? (void *)&found : (void *)&f->ours_f, sizeof w->f_single);
    } else {
        memcpy(&w->f, libm ? (void *)&found : (void *)&f->ours, sizeof w->f);
    }
}

static bool run(const core_lab_case *c, core_json *out) {
    const char *name = core_lab_text(c, "function", "sin");
    const char *method = core_lab_text(c, "method", "corsac");
    bool single = strstr(method, "float") != NULL, libm = strstr(method, "libm") != NULL;
    const function *f = find_function(name);
    workload *w = core_alloc(sizeof *w);
    if (f) {
        choose(w, f, single, libm);
    }
    if (!w->f && !w->f_single) {
        core_free(w);
        return core_fail("lab kernel math: no function '%s' for method '%s'", name, method);
    }
    double lo = core_lab_number(c, "lo", f->lo), hi = core_lab_number(c, "hi", f->hi);
    core_rng rng = core_rng_make((uint64_t)core_lab_number(c, "seed", 1), CORE_RNG_ENGINE);
    int rounds = (int)CORE_CLAMP(core_lab_number(c, "n", 1e5) / POINTS + 1, 1.0, 1e5);
    double worst = 0, sum = 0, worst_at = 0;
    for (int k = 0; k < rounds; k++) {
        for (int i = 0; i < POINTS; i++) {
            w->x[i] = lo + (hi - lo) * core_rng_double(&rng);
            w->x[i] = single ? (double)(float)w->x[i] : w->x[i];
        }
        evaluate(w);
        for (int i = 0; i < POINTS; i++) {
            double e = ulp_error(w->y[i], f->exact((long double)w->x[i]), single);
            sum += e;
            worst_at = e > worst ? w->x[i] : worst_at;
            worst = e > worst ? e : worst;
        }
    }
    core_json_number(out, "error_max_ulp", worst);
    core_json_number(out, "error_mean_ulp", sum / ((double)rounds * POINTS));
    core_json_number(out, "worst_at", worst_at);
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ns", core_lab_time(evaluate, w, 2e7) / POINTS);
    }
    core_free(w);
    return true;
}

const core_lab_kernel core_lab_math = {
    "math", "error of a function in ULP against libm in long double, and its time",
    "function: sin|cos|...; method: corsac|corsac float|libm|libm float; lo, hi, n, seed, timed",
    run};
