// Private to core/math_*.c: doubles carried as unevaluated sums high + low, |low| <= ulp(high)/2.
// Sums after Knuth (TAOCP 2, 4.2.2), products after Dekker (1971), who needs no FMA.
#ifndef CORE_MATH_DOUBLE_INTERNAL_H
#define CORE_MATH_DOUBLE_INTERNAL_H

#include <string.h>

#include "core/math.h"
#include "core/math_tables_internal.h"

typedef struct core_dd {
    double hi, lo;
} core_dd;

static inline uint64_t core_bits64(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
static inline double core_from_bits64(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
static inline double core_abs64(double x) { return core_from_bits64(core_bits64(x) & INT64_MAX); }
static inline bool core_sign64(double x) { return core_bits64(x) >> 63; }
static inline double core_copysign64(double size, double sign) {
    return core_from_bits64((core_bits64(size) & INT64_MAX) | (core_bits64(sign) & 1ull << 63));
}
// 2^k for -1022 <= k <= 1023.
static inline double core_two_to(int k) { return core_from_bits64((uint64_t)(k + 1023) << 52); }

static inline core_dd core_dd_sum(double a, double b) {
    double s = a + b, b_part = s - a;
    return (core_dd){s, (a - (s - b_part)) + (b - b_part)};
}
// For |a| >= |b| or a = 0.
static inline core_dd core_dd_fast_sum(double a, double b) {
    double s = a + b;
    return (core_dd){s, b - (s - a)};
}
// Exact when nothing over- or underflows: |a|, |b| < 2^995.
static inline core_dd core_dd_product(double a, double b) {
    const double splitter = 0x1p27 + 1.0;
    double p = a * b;
    double ta = splitter * a, a_hi = ta - (ta - a), a_lo = a - a_hi;
    double tb = splitter * b, b_hi = tb - (tb - b), b_lo = b - b_hi;
    return (core_dd){p, ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
}
static inline core_dd core_dd_mul(core_dd a, core_dd b) {
    core_dd p = core_dd_product(a.hi, b.hi);
    return core_dd_fast_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
static inline core_dd core_dd_add(core_dd a, core_dd b) {
    core_dd s = core_dd_sum(a.hi, b.hi);
    return core_dd_fast_sum(s.hi, s.lo + (a.lo + b.lo));
}
static inline core_dd core_dd_div(core_dd a, core_dd b) {
    double q = a.hi / b.hi;
    core_dd p = core_dd_product(q, b.hi);
    return core_dd_fast_sum(q, (((a.hi - p.hi) - p.lo) + (a.lo - q * b.lo)) / b.hi);
}

static inline double core_poly64(const double *c, int count, double u) {
    double sum = c[count - 1];
    for (int i = count - 2; i >= 0; i--) {
        sum = sum * u + c[i];
    }
    return sum;
}
#define CORE_POLY64(c, u) core_poly64(c, (int)CORE_COUNT_OF(c), u)

// log(x) to about 2^-67 relative, for finite x > 0 (math_exp.c). *exponent and the result are
// log(x) = *exponent ln 2 + result, result in [-0.35, 0.35].
core_dd core_log_parts(double x, int *exponent);
// e^(hi + lo) = 2^*k (result), to about 2^-60 relative; |hi| <= 1100.
core_dd core_exp_parts(double hi, double lo, int *k);
// x 2^k with one rounding, for x in [1/4, 4] and any k in [-1200, 1200].
double core_scale64(double x, int k);

#endif
