// Double functions that are exact: rounding to whole numbers and the remainder.
#include "core/math_double_internal.h"

double core_floor(double x) {
    if (!(core_abs64(x) < 0x1p52)) {
        return x + 0.0; // already whole, infinite or NaN
    }
    double whole = (double)(int64_t)x;
    whole = whole > x ? whole - 1.0 : whole;
    return core_copysign64(whole, x);
}

double core_ceil(double x) {
    if (!(core_abs64(x) < 0x1p52)) {
        return x + 0.0;
    }
    double whole = (double)(int64_t)x;
    whole = whole < x ? whole + 1.0 : whole;
    return core_copysign64(whole, x);
}

// Whole significand and exponent of a finite x > 0: x = m 2^e, and m < 2^53.
static uint64_t split(double x, int *e) {
    uint64_t bits = core_bits64(x), m = bits & ((1ull << 52) - 1);
    int field = (int)(bits >> 52);
    if (field == 0) {
        *e = -1074;
        return m;
    }
    *e = field - 1075;
    return m | 1ull << 52;
}

// Long division of the significands, 11 bits of quotient at a time: a remainder below 2^53 leaves
// so much room in a 64-bit word.
double core_fmod(double x, double y) {
    double ax = core_abs64(x), ay = core_abs64(y);
    if (!(ax <= __DBL_MAX__) || !(ay > 0.0)) {
        return (x * y) / (x * y); // NaN, or no remainder
    }
    if (ax < ay) {
        return x;
    }
    int ex, ey;
    uint64_t mx = split(ax, &ex), my = split(ay, &ey);
    uint64_t rest = mx % my;
    for (int shift = ex - ey; shift > 0 && rest;) {
        int step = shift < 11 ? shift : 11;
        rest = (rest << step) % my;
        shift -= step;
    }
    if (rest == 0) {
        return core_copysign64(0.0, x);
    }
    // rest 2^ey is a double: below y, and a multiple of y's unit.
    int up = __builtin_clzll(rest) - 11;
    if (ey - up < -1074) {
        up = ey + 1074;
    }
    rest <<= up;
    uint64_t bits =
        rest >> 52 ? (rest & ((1ull << 52) - 1)) | (uint64_t)(ey - up + 1075) << 52 : rest;
    return core_copysign64(core_from_bits64(bits), x);
}
