#include "support/ulp.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

double ulp64(double got, long double exact) {
    double rounded = (double)exact;
    if (isnan(got) || isnan(exact)) {
        return isnan(got) && isnan(exact) ? 0.0 : 1e30;
    }
    if (isinf(got) || isinf(rounded)) {
        return got == rounded ? 0.0 : 1e30;
    }
    int e;
    frexp(rounded, &e);
    long double unit = ldexpl(1.0L, e - 53 < -1074 ? -1074 : e - 53);
    return (double)(fabsl((long double)got - exact) / unit);
}

double ulp32(float got, double exact) {
    float rounded = (float)exact;
    if (isnan(got) || isnan(exact)) {
        return isnan(got) && isnan(exact) ? 0.0 : 1e30;
    }
    if (isinf(got) || isinf(rounded)) {
        return got == rounded ? 0.0 : 1e30;
    }
    int e;
    frexp((double)rounded, &e);
    double unit = ldexp(1.0, e - 24 < -149 ? -149 : e - 24);
    return fabs((double)got - exact) / unit;
}

long double (*ulp_reference(const char *name))(long double) {
    static const struct {
        const char *name;
        long double (*f)(long double);
    } list[] = {{"sin", sinl},   {"cos", cosl},     {"tan", tanl},   {"asin", asinl},
                {"acos", acosl}, {"atan", atanl},   {"exp", expl},   {"log", logl},
                {"log2", log2l}, {"log10", log10l}, {"sinh", sinhl}, {"cosh", coshl},
                {"tanh", tanhl}};
    for (size_t i = 0; i < CORE_COUNT_OF(list); i++) {
        if (!strcmp(list[i].name, name)) {
            return list[i].f;
        }
    }
    abort();
}

// Sizes from 2^low to 2^high, every binade as likely. Exact operations only: a test keeps a hash of
// what these arguments give.
static double signed_power(core_rng *rng, double low, double high) {
    int binade = (int)(low + (high - low) * core_rng_double(rng));
    double size = ldexp(1.0 + core_rng_double(rng), binade);
    return core_rng_below(rng, 2) ? -size : size;
}

// A double within two steps of a multiple of pi/2, of any size up to 2^50.
static double near_quadrant(core_rng *rng) {
    uint64_t k = core_rng_u64(rng); // two statements: operands of >> have no order
    k >>= 14 + core_rng_below(rng, 50);
    double x = (double)((long double)k * 1.57079632679489661923132169163975144L);
    for (int steps = (int)core_rng_below(rng, 5) - 2; steps; steps += steps < 0 ? 1 : -1) {
        x = nextafter(x, steps < 0 ? -INFINITY : INFINITY);
    }
    return core_rng_below(rng, 2) ? -x : x;
}

double ulp_argument(core_rng *rng, const core_math_entry *entry, int kind) {
    double low = fmax(entry->low, -40.0), high = fmin(entry->high, 40.0);
    switch (kind) {
    case 0: // where ordinary arguments lie
        return low + (high - low) * core_rng_double(rng);
    case 1: // near one: zeros of the logarithms, ends of the arc functions
        return 1.0 + signed_power(rng, -53.0, -1.0);
    case 2: // small ones, down to nothing
        return signed_power(rng, -70.0, 0.0);
    case 3: // subnormals
        return signed_power(rng, -1074.0, -1020.0);
    case 4:
        return near_quadrant(rng);
    case 5: // huge ones
        return signed_power(rng, 10.0, 1023.0);
    case 6: // the whole interval that has results
        return entry->low / 2 + (entry->high / 2 - entry->low / 2) * 2 * core_rng_double(rng);
    default: { // any bit pattern: infinities and NaNs too
        uint64_t bits = core_rng_u64(rng);
        double x;
        memcpy(&x, &bits, sizeof x);
        return x;
    }
    }
}

double ulp_worst(const core_math_entry *entry, int count, core_rng *rng, double *where) {
    long double (*reference)(long double) = ulp_reference(entry->name);
    double worst = 0.0;
    for (int kind = 0; kind < ULP_KINDS; kind++) {
        for (int i = 0; i < count; i++) {
            double x = ulp_argument(rng, entry, kind);
            double error = ulp64(entry->f64(x), reference(x));
            if (error > worst) {
                worst = error;
                *where = x;
            }
        }
    }
    return worst;
}
