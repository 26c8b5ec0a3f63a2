// Double exponentials, logarithms, powers and hyperbolic functions. Logarithm and exponential are
// each computed once, as high + low; the rest is made of these two.
#include "core/math_double_internal.h"

double core_scale64(double x, int k) {
    if (k >= -1020 && k <= 1020) {
        return x * core_two_to(k);
    }
    int half = k / 2;
    return x * core_two_to(half) * core_two_to(k - half);
}

core_dd core_exp_parts(double hi, double lo, int *k) {
    double kf = core_floor(hi * ONE_OVER_LN2 + 0.5);
    *k = (int)kf;
    core_dd r = core_dd_sum(hi - kf * LN2_1, lo - kf * LN2_2);
    double rest = r.lo + r.hi * r.lo + r.hi * r.hi * CORE_POLY64(poly_exp, r.hi);
    core_dd sum = core_dd_fast_sum(1.0, r.hi);
    return core_dd_fast_sum(sum.hi, sum.lo + rest);
}

double core_exp(double x) {
    if (!(x > -746.0)) {
        return x != x ? x + x : 0.0;
    }
    if (x > 710.0) {
        return x > __DBL_MAX__ ? x : __builtin_inf();
    }
    int k;
    core_dd e = core_exp_parts(x, 0.0, &k);
    return core_scale64(e.hi, k);
}

// With c near 1/m from a table, log(m) = -log(c) + log(1 + r), r = m c - 1 exactly as a pair.
core_dd core_log_parts(double x, int *exponent) {
    uint64_t bits = core_bits64(x);
    int k = 0;
    if (bits >> 52 == 0) {
        bits = core_bits64(x * 0x1p54);
        k = -54;
    }
    const uint64_t root_half = 0x3fe6a09e667f3bcdu;
    uint64_t shifted = bits - root_half;
    *exponent = k + (int)((int64_t)shifted >> 52);
    double m = core_from_bits64((shifted & ((1ull << 52) - 1)) + root_half);
    const double *entry = table_log[(int)(m * 128.0 + 0.5) - 90];
    // c has 11 bits, so its products with the upper and the lower part of m are exact.
    double m_hi = core_from_bits64(core_bits64(m) & ~((1ull << 21) - 1));
    core_dd r = core_dd_sum(m_hi * entry[0] - 1.0, (m - m_hi) * entry[0]);
    core_dd square = core_dd_product(r.hi, r.hi);
    double cube = r.hi * square.hi * CORE_POLY64(poly_log1p, r.hi);
    core_dd y = core_dd_sum(entry[1], r.hi);
    core_dd z = core_dd_sum(y.hi, -0.5 * square.hi);
    double low = ((entry[2] + r.lo) - 0.5 * square.lo) - r.hi * r.lo;
    return core_dd_sum(z.hi, (y.lo + z.lo) + (low + cube));
}

// What log, log2 and log10 share: NaN and the ends of the range. False when x is ordinary.
static bool log_special(double x, double *result) {
    if (x != x || x > __DBL_MAX__) {
        *result = x + x;
        return true;
    }
    if (x < 0.0) {
        *result = (x - x) / 0.0;
        return true;
    }
    if (x == 0.0) {
        *result = -__builtin_inf();
        return true;
    }
    return false;
}

static core_dd log_full(double x) {
    int k;
    core_dd y = core_log_parts(x, &k);
    core_dd base = core_dd_sum(k * LN2_1, y.hi); // LN2_1 has so few bits that the product is exact
    return core_dd_sum(base.hi, base.lo + (k * LN2_2 + y.lo));
}

double core_ln(double x) {
    double result;
    return log_special(x, &result) ? result : log_full(x).hi;
}

double core_log2(double x) {
    double result;
    if (log_special(x, &result)) {
        return result;
    }
    int k;
    core_dd y = core_dd_mul(core_log_parts(x, &k), (core_dd){LOG2_E_HI, LOG2_E_LO});
    return core_dd_add((core_dd){k, 0.0}, y).hi;
}

double core_log10(double x) {
    double result;
    if (log_special(x, &result)) {
        return result;
    }
    int k;
    core_dd y = core_dd_mul(core_log_parts(x, &k), (core_dd){LOG10_E_HI, LOG10_E_LO});
    core_dd base = core_dd_mul((core_dd){k, 0.0}, (core_dd){LOG10_2_HI, LOG10_2_LO});
    return core_dd_add(base, y).hi;
}

// 0: not a whole number, 1: odd, 2: even. Doubles from 2^53 on are even.
static int whole_kind(double y) {
    double size = core_abs64(y);
    if (size >= 0x1p53) {
        return 2;
    }
    if (core_floor(y) != y) {
        return 0;
    }
    return (int64_t)y & 1 ? 1 : 2;
}

// C17 Annex F 10.4.4, for y and x that are zero, infinite or NaN. `kind` as in whole_kind.
static double pow_special(double x, double y, int kind) {
    if (x != x || y != y) {
        return x + y;
    }
    double size = core_abs64(x);
    if (core_abs64(y) > __DBL_MAX__) {
        if (size == 1.0) {
            return 1.0;
        }
        return (size > 1.0) == (y > 0.0) ? __builtin_inf() : 0.0;
    }
    double result = (size == 0.0) == (y > 0.0) ? 0.0 : __builtin_inf();
    return kind == 1 ? core_copysign64(result, x) : result;
}

double core_pow(double x, double y) {
    if (y == 0.0 || x == 1.0) {
        return 1.0;
    }
    if (y == 2.0) {
        return x * x; // what compiled Lua traces do
    }
    if (y == 1.0) {
        return x;
    }
    if (y == -1.0) {
        return 1.0 / x;
    }
    int kind = whole_kind(y);
    double size = core_abs64(x);
    if (!(size <= __DBL_MAX__) || size == 0.0 || !(core_abs64(y) <= __DBL_MAX__)) {
        return pow_special(x, y, kind);
    }
    if (x < 0.0 && kind == 0) {
        return (x - x) / 0.0;
    }
    if (y == 0.5) {
        return core_sqrt(x);
    }
    double sign = x < 0.0 && kind == 1 ? -1.0 : 1.0;
    core_dd log = log_full(size);
    double estimate = y * log.hi;
    if (!(core_abs64(estimate) < 800.0)) {
        return log.hi == 0.0 ? sign : sign * (estimate > 0.0 ? __builtin_inf() : 0.0);
    }
    if (core_abs64(y) > 0x1p900 || core_abs64(estimate) < 0x1p-60) {
        return sign; // log of a double other than 1 is over 2^-53, so the first means x = 1
    }
    core_dd power = core_dd_product(y, log.hi);
    int k;
    core_dd e = core_exp_parts(power.hi, power.lo + y * log.lo, &k);
    return sign * core_scale64(e.hi, k);
}

double core_sinh(double x) {
    double size = core_abs64(x);
    if (size <= 1.0) {
        double z = x * x;
        return size < 0x1p-27 ? x : x + x * z * CORE_POLY64(poly_sinh, z);
    }
    if (!(size < 711.0)) {
        return x != x ? x + x : core_copysign64(__builtin_inf(), x);
    }
    int k;
    core_dd e = core_exp_parts(size, 0.0, &k);
    if (size < 40.0) {
        double square = core_two_to(2 * k);
        core_dd inverse =
            core_dd_div((core_dd){-1.0, 0.0}, (core_dd){e.hi * square, e.lo * square});
        e = core_dd_add(e, inverse);
    }
    return core_copysign64(core_scale64(e.hi, k - 1), x);
}

double core_cosh(double x) {
    double size = core_abs64(x);
    if (!(size < 711.0)) {
        return x != x ? x + x : __builtin_inf();
    }
    int k;
    core_dd e = core_exp_parts(size, 0.0, &k);
    if (size < 40.0) {
        double square = core_two_to(2 * k);
        core_dd inverse = core_dd_div((core_dd){1.0, 0.0}, (core_dd){e.hi * square, e.lo * square});
        e = core_dd_add(e, inverse);
    }
    return core_scale64(e.hi, k - 1);
}

double core_tanh(double x) {
    double size = core_abs64(x);
    if (size < 0x1p-27) {
        return x;
    }
    if (size < 0.6) {
        double z = x * x;
        core_dd s = core_dd_fast_sum(x, x * z * CORE_POLY64(poly_sinh, z));
        core_dd c = core_dd_fast_sum(1.0, 0.5 * z + z * z * CORE_POLY64(poly_cosh, z));
        return core_dd_div(s, c).hi;
    }
    if (!(size < 22.0)) {
        return x != x ? x + x : core_copysign64(1.0, x);
    }
    int k; // tanh x = 1 - 2 / (e^2x + 1)
    core_dd e = core_exp_parts(2.0 * size, 0.0, &k);
    double scale = core_two_to(k);
    core_dd bottom = core_dd_add((core_dd){e.hi * scale, e.lo * scale}, (core_dd){1.0, 0.0});
    core_dd q = core_dd_div((core_dd){-2.0, 0.0}, bottom);
    return core_copysign64(core_dd_add((core_dd){1.0, 0.0}, q).hi, x);
}
