// Double sine, cosine, tangent and their inverses. Method of each function: reduce exactly or as
// high + low, one minimax polynomial (tools/math/generate.py), add the parts from small to large.
#include "core/math_double_internal.h"

// The bits of 2/pi from bit `first` on (bit 0: weight 1/2), 64 of them.
static uint64_t two_over_pi_bits(int first) {
    int word = first >> 6, shift = first & 63;
    if (shift == 0) {
        return table_two_over_pi[word];
    }
    return table_two_over_pi[word] << shift | table_two_over_pi[word + 1] >> (64 - shift);
}

// Payne and Hanek, "Radian reduction for trigonometric functions", SIGNUM 18 (1983): of the product
// x 2/pi only the bits around the point matter; higher ones are multiples of four quadrants. For
// x >= 2^19.
static int reduce_huge(double x, core_dd *r) {
    uint64_t bits = core_bits64(x);
    int exponent = (int)(bits >> 52) - 1075; // x = m 2^exponent
    uint64_t m = (bits & ((1ull << 52) - 1)) | 1ull << 52;
    // Skip bits of 2/pi whose product with x is a multiple of 4 (weight >= 2^2 after scaling).
    int first = exponent - 3;
    first = first < 0 ? 0 : first;
    uint64_t w[4];
    for (int i = 0; i < 4; i++) {
        w[i] = two_over_pi_bits(first + 64 * i);
    }
    // m * (w0 w1 w2 w3), 320 bits: p[0] is the most significant word.
    uint64_t p[5];
    unsigned __int128 carry = 0;
    for (int i = 3; i >= 0; i--) {
        carry += (unsigned __int128)m * w[i];
        p[i + 1] = (uint64_t)carry;
        carry >>= 64;
    }
    p[0] = (uint64_t)carry;
    // The point stands so many bits below the top of p[0].
    int point = 64 + exponent - first;
    int word = point >> 6, shift = point & 63;
    uint64_t fraction[3];
    for (int i = 0; i < 3; i++) {
        uint64_t high = p[word + i], low = word + i + 1 < 5 ? p[word + i + 1] : 0;
        fraction[i] = shift ? high << shift | low >> (64 - shift) : high;
    }
    // Of the whole part its last two bits matter; at least three bits of it were kept.
    uint64_t whole = shift ? p[word] >> (64 - shift) : 0;
    whole |= word ? p[word - 1] << shift : 0;
    // Round to the nearest quadrant: the fraction becomes signed.
    bool negative = fraction[0] >> 63;
    if (negative) {
        whole++;
        unsigned __int128 borrow = 1;
        for (int i = 2; i >= 0; i--) {
            borrow += (uint64_t)~fraction[i];
            fraction[i] = (uint64_t)borrow;
            borrow >>= 64;
        }
    }
    // Normalise so that high + low keep over 100 bits even next to a multiple of pi/2.
    int lead = 0;
    while (fraction[0] == 0 && lead < 128) {
        fraction[0] = fraction[1], fraction[1] = fraction[2], fraction[2] = 0;
        lead += 64;
    }
    if (fraction[0] != 0) {
        int zeros = __builtin_clzll(fraction[0]);
        if (zeros) {
            fraction[0] = fraction[0] << zeros | fraction[1] >> (64 - zeros);
            fraction[1] = fraction[1] << zeros | fraction[2] >> (64 - zeros);
        }
        lead += zeros;
    }
    double scale = core_two_to(-lead);
    core_dd f =
        core_dd_fast_sum((double)(fraction[0] >> 11) * 0x1p-53,
                         (double)((fraction[0] << 53 | fraction[1] >> 11) >> 11) * 0x1p-106);
    core_dd angle = core_dd_mul(f, (core_dd){HALF_PI_HI, HALF_PI_LO});
    scale = negative ? -scale : scale;
    *r = (core_dd){angle.hi * scale, angle.lo * scale};
    return (int)(whole & 3);
}

// x = k pi/2 + r.hi + r.lo, |r| <= pi/4 (and a little); returns k mod 4. Finite x.
static int reduce(double x, core_dd *r) {
    double size = core_abs64(x);
    if (size <= 0.78539816339744828) {
        *r = (core_dd){x, 0.0};
        return 0;
    }
    if (size >= 0x1p19) {
        int k = reduce_huge(size, r);
        if (x < 0.0) {
            *r = (core_dd){-r->hi, -r->lo};
            k = -k & 3;
        }
        return k;
    }
    // Cody and Waite: k has at most 20 bits, so its products with the first three parts are exact.
    double kf = core_floor(x * TWO_OVER_PI + 0.5);
    core_dd high = core_dd_sum(x - kf * HALF_PI_1, -(kf * HALF_PI_2));
    double low = (high.lo - kf * HALF_PI_3) - kf * HALF_PI_4;
    *r = core_dd_sum(high.hi, low);
    return (int)((int64_t)kf & 3);
}

// sin(r) and cos(r) as head + tail. The square of r is taken as a pair: its rounding would be the
// largest error left.
static core_dd sin_reduced(core_dd r) {
    core_dd z = core_dd_product(r.hi, r.hi);
    double tail = r.lo - (0.5 * z.hi * r.lo + r.hi * z.lo * (1.0 / 6.0));
    return core_dd_fast_sum(r.hi, tail + r.hi * (z.hi * CORE_POLY64(poly_sin, z.hi)));
}

static core_dd cos_reduced(core_dd r) {
    core_dd z = core_dd_product(r.hi, r.hi);
    double half_z = 0.5 * z.hi;
    double rest = z.hi * z.hi * CORE_POLY64(poly_cos, z.hi) - (r.hi * r.lo + 0.5 * z.lo);
    core_dd head = core_dd_fast_sum(1.0, -half_z);
    return core_dd_fast_sum(head.hi, head.lo + rest);
}

double core_sin(double x) {
    double size = core_abs64(x);
    if (size < 0x1p-27) {
        return x; // keeps -0; the next term is below half an ULP
    }
    if (!(size <= __DBL_MAX__)) {
        return x - x;
    }
    core_dd r;
    int k = reduce(x, &r);
    double s = k & 1 ? cos_reduced(r).hi : sin_reduced(r).hi;
    return k & 2 ? -s : s;
}

double core_cos(double x) {
    if (!(core_abs64(x) <= __DBL_MAX__)) {
        return x - x;
    }
    core_dd r;
    int k = reduce(x, &r);
    double c = k & 1 ? sin_reduced(r).hi : cos_reduced(r).hi;
    return (k + 1) & 2 ? -c : c;
}

double core_tan(double x) {
    double size = core_abs64(x);
    if (size < 0x1p-27) {
        return x;
    }
    if (!(size <= __DBL_MAX__)) {
        return x - x;
    }
    core_dd r;
    int k = reduce(x, &r);
    core_dd s = sin_reduced(r), c = cos_reduced(r);
    return k & 1 ? -core_dd_div(c, s).hi : core_dd_div(s, c).hi;
}

// asin of the square root of z <= 1/4, given that root: what is to be added to it.
static double asin_rest(double root, double z) { return root * z * CORE_POLY64(poly_asin, z); }

// The sine of half the complement of x in (1/2, 1]: sqrt((1 - x)/2), with what rounding took.
static core_dd half_complement(double x) {
    double z = 0.5 * (1.0 - x);
    double root = core_sqrt(z);
    if (root == 0.0) {
        return (core_dd){0.0, 0.0};
    }
    core_dd square = core_dd_product(root, root);
    return (core_dd){root, ((z - square.hi) - square.lo) / (2.0 * root)};
}

double core_asin(double x) {
    double size = core_abs64(x);
    if (!(size <= 1.0)) {
        return (x - x) / (x - x);
    }
    if (size <= 0.5) {
        return size < 0x1p-27 ? x : x + asin_rest(x, x * x);
    }
    core_dd s = half_complement(size);
    double rest = s.lo + asin_rest(s.hi, s.hi * s.hi);
    core_dd angle = core_dd_fast_sum(HALF_PI_HI, -2.0 * s.hi);
    return core_copysign64(angle.hi + (angle.lo + (HALF_PI_LO - 2.0 * rest)), x);
}

double core_acos(double x) {
    double size = core_abs64(x);
    if (!(size <= 1.0)) {
        return (x - x) / (x - x);
    }
    if (size <= 0.5) {
        core_dd angle = core_dd_fast_sum(HALF_PI_HI, -x);
        return angle.hi + (angle.lo + (HALF_PI_LO - asin_rest(x, x * x)));
    }
    core_dd s = half_complement(size);
    double rest = s.lo + asin_rest(s.hi, s.hi * s.hi);
    if (x > 0.0) {
        return 2.0 * (s.hi + rest);
    }
    core_dd angle = core_dd_fast_sum(PI_HI, -2.0 * s.hi);
    return angle.hi + (angle.lo + (PI_LO - 2.0 * rest));
}

// atan of a quotient q in [0, 1]: near sixteenths i/16 the angle is atan(i/16) from a table plus
// the arctangent of (q - i/16) / (1 + q i/16), which is at most 1/32.
static core_dd atan_quotient(core_dd q) {
    if (q.hi < 0.21875) {
        double z = q.hi * q.hi;
        double rest = q.hi * z * CORE_POLY64(poly_atan, z);
        return core_dd_fast_sum(q.hi, q.lo + rest);
    }
    int i = (int)(q.hi * 16.0 + 0.5);
    double c = i * 0.0625;
    double t = ((q.hi - c) + q.lo) / (1.0 + c * q.hi);
    double z = t * t;
    double rest = t * z * CORE_POLY64(poly_atan, z);
    core_dd angle = core_dd_fast_sum(table_atan[i][0], t);
    return core_dd_fast_sum(angle.hi, angle.lo + (table_atan[i][1] + rest));
}

double core_atan2(double y, double x) {
    double ay = core_abs64(y), ax = core_abs64(x);
    if (ay != ay || ax != ax) {
        return x + y;
    }
    bool steep = ay > ax, left = core_sign64(x);
    double n = steep ? ax : ay, d = steep ? ay : ax;
    core_dd angle = {0.0, 0.0};
    if (n == d) { // both infinite too
        angle = n > 0.0 ? (core_dd){0.5 * HALF_PI_HI, 0.5 * HALF_PI_LO} : angle;
    } else if (n < d * 0x1p-60 || d > __DBL_MAX__) {
        if (!steep && !left) { // nothing to add it to: the quotient is the angle
            return core_copysign64(n / d, y);
        }
    } else {
        // Away from the ends of the range, where products would lose their low part.
        double scale = d > 0x1p900 ? 0x1p-200 : d < 0x1p-800 ? 0x1p600 : 1.0;
        core_dd top = {n * scale, 0.0}, bottom = {d * scale, 0.0};
        angle = atan_quotient(core_dd_div(top, bottom));
    }
    if (steep) {
        angle = core_dd_add((core_dd){HALF_PI_HI, HALF_PI_LO}, (core_dd){-angle.hi, -angle.lo});
    }
    if (left) {
        angle = core_dd_add((core_dd){PI_HI, PI_LO}, (core_dd){-angle.hi, -angle.lo});
    }
    return core_copysign64(angle.hi, y);
}

double core_atan(double x) { return core_atan2(x, 1.0); }
