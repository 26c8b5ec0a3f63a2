// Transcendental functions of a vector, with the bits of their scalar namesakes in core/math.h:
// vf_sin(x) is core_sinf of every lane. Both come from this source; core/math_float.c compiles it
// one lane wide. + - * / sqrt only. Bounds in ULP stand in core/math.h.
//
// Polynomials are minimax fits of our own (tools/math/generate.py). Where a reduced argument or a
// quotient is rounded, the part that was lost is carried beside it and added at the end
// (Dekker, "A floating-point technique for extending the available precision", 1971).
#ifndef CORE_SIMD_MATH_H
#define CORE_SIMD_MATH_H

#include "core/math_tables_internal.h"
#include "core/simd.h"

// Arguments beyond this go one by one through the double functions.
#define CORE_SINF_NEAR 400.0f
float core_sinf_far(float x);
float core_cosf_far(float x);
float core_tanf_far(float x);

static inline vf vf_poly_(const float *c, int count, vf u) {
    vf sum = vf_set1(c[count - 1]);
    for (int i = count - 2; i >= 0; i--) {
        sum = vf_mad(sum, u, vf_set1(c[i]));
    }
    return sum;
}
#define VF_POLY_(c, u) vf_poly_(c, (int)CORE_COUNT_OF(c), u)

// What a - b lost when it was rounded to `difference` (Knuth's two-sum, for a and -b).
static inline vf vf_lost_(vf a, vf b, vf difference) {
    vf b_part = vf_sub(a, difference), a_part = vf_add(difference, b_part);
    return vf_add(vf_sub(a, a_part), vf_sub(b_part, b));
}

static inline vf vf_each_(vm m, vf x, vf others, float (*f)(float)) {
    float in[CORE_SIMD_WIDTH], out[CORE_SIMD_WIDTH];
    vf_storeu(in, x);
    vf_storeu(out, others);
    for (uint32_t bits = vm_bits(m); bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        out[lane] = f(in[lane]);
    }
    return vf_loadu(out);
}

// x = k pi/2 + r + tail with |r| <= pi/4, for |x| <= CORE_SINF_NEAR (Cody and Waite, "Software
// Manual for the Elementary Functions", 1980).
static inline vi vf_reduce_(vf x, vf *r, vf *tail) {
    vi k = vi_round(vf_mul(x, vf_set1(TWO_OVER_PIF)));
    vf kf = vf_from_i(k);
    vf first = vf_sub(x, vf_mul(kf, vf_set1(HALF_PIF_1)));
    vf second = vf_mul(kf, vf_set1(HALF_PIF_2));
    vf high = vf_sub(first, second);
    vf low = vf_lost_(first, second, high);
    low = vf_sub(low, vf_mul(kf, vf_set1(HALF_PIF_3)));
    low = vf_sub(low, vf_mul(kf, vf_set1(HALF_PIF_4)));
    *r = vf_add(high, low);
    *tail = vf_add(vf_sub(high, *r), low);
    return k;
}

// sin and cos of r + tail, |r| <= pi/4.
static inline void vf_sincos_reduced_(vf r, vf tail, vf *s, vf *c) {
    const vf one = vf_set1(1.0f);
    vf z = vf_mul(r, r), half_z = vf_mul(vf_set1(0.5f), z);
    vf correction = vf_sub(tail, vf_mul(half_z, tail)); // tail * cos r
    *s = vf_add(r, vf_mad(vf_mul(r, z), VF_POLY_(poly_sinf, z), correction));
    vf rest = vf_sub(vf_mul(vf_mul(z, z), VF_POLY_(poly_cosf, z)), vf_mul(r, tail));
    vf w = vf_sub(one, half_z);
    *c = vf_add(w, vf_add(vf_sub(vf_sub(one, w), half_z), rest));
}

static inline void vf_sincos(vf x, vf *s, vf *c) {
    vf r, tail, sin_r, cos_r;
    vi k = vf_reduce_(x, &r, &tail);
    vf_sincos_reduced_(r, tail, &sin_r, &cos_r);
    vm odd = vi_eq(vi_and(k, vi_set1(1)), vi_set1(1));
    vi sin_sign = vi_shl(vi_and(k, vi_set1(2)), 30);
    vi cos_sign = vi_shl(vi_and(vi_add(k, vi_set1(1)), vi_set1(2)), 30);
    vf sine = vf_from_bits(vi_xor(vi_bits(vf_select(odd, cos_r, sin_r)), sin_sign));
    vf cosine = vf_from_bits(vi_xor(vi_bits(vf_select(odd, sin_r, cos_r)), cos_sign));
    vf size = vf_abs(x);
    sine = vf_select(vf_lt(size, vf_set1(0x1p-12f)), x, sine); // keeps -0 and subnormals
    vm far = vm_not(vf_le(size, vf_set1(CORE_SINF_NEAR)));
    if (vm_any(far)) {
        sine = vf_each_(far, x, sine, core_sinf_far);
        cosine = vf_each_(far, x, cosine, core_cosf_far);
    }
    *s = sine;
    *c = cosine;
}
static inline vf vf_sin(vf x) {
    vf s, c;
    vf_sincos(x, &s, &c);
    return s;
}
static inline vf vf_cos(vf x) {
    vf s, c;
    vf_sincos(x, &s, &c);
    return c;
}

static inline vf vf_tan(vf x) {
    vf r, tail, s, c;
    vi k = vf_reduce_(x, &r, &tail);
    vf_sincos_reduced_(r, tail, &s, &c);
    vm odd = vi_eq(vi_and(k, vi_set1(1)), vi_set1(1));
    vf t = vf_div(vf_select(odd, vf_neg(c), s), vf_select(odd, s, c));
    vf size = vf_abs(x);
    t = vf_select(vf_lt(size, vf_set1(0x1p-12f)), x, t);
    vm far = vm_not(vf_le(size, vf_set1(CORE_SINF_NEAR)));
    return vm_any(far) ? vf_each_(far, x, t, core_tanf_far) : t;
}

// For |x| > 1/2 both go through sqrt((1 - |x|)/2), the sine of half the complement.
static inline vf vf_asin(vf x) {
    vf size = vf_abs(x);
    vm outer = vf_gt(size, vf_set1(0.5f));
    vf z = vf_select(outer, vf_mul(vf_sub(vf_set1(1.0f), size), vf_set1(0.5f)), vf_mul(x, x));
    vf s = vf_select(outer, vf_sqrt(z), size);
    vf p = vf_mul(vf_mul(s, z), VF_POLY_(poly_asinf, z));
    vf base = vf_set1(2.0f * QUARTER_PIF_1), twice = vf_add(s, s);
    vf high = vf_sub(base, twice);
    vf low = vf_sub(vf_set1(2.0f * QUARTER_PIF_2), vf_add(p, p));
    vf complement = vf_add(high, vf_add(vf_sub(vf_sub(base, high), twice), low));
    return vf_copysign(vf_select(outer, complement, vf_add(s, p)), x);
}

static inline vf vf_acos(vf x) {
    vf size = vf_abs(x);
    vm outer = vf_gt(size, vf_set1(0.5f));
    vm negative = vf_lt(x, vf_zero());
    vf z = vf_select(outer, vf_mul(vf_sub(vf_set1(1.0f), size), vf_set1(0.5f)), vf_mul(x, x));
    vf s = vf_select(outer, vf_sqrt(z), size);
    vf p = vf_mul(vf_mul(s, z), VF_POLY_(poly_asinf, z));
    // The angle is base + a + rest with base 0, pi/2 or pi and a = 2s, -s, s or -2s.
    vf quarters = vf_select(outer, vf_keep(negative, vf_set1(4.0f)), vf_set1(2.0f));
    vf a = vf_select(outer, vf_add(s, s), s);
    vf rest = vf_select(outer, vf_add(p, p), p);
    vm plus = vm_xor(outer, negative);
    a = vf_select(plus, a, vf_neg(a));
    rest = vf_mad(quarters, vf_set1(QUARTER_PIF_2), vf_select(plus, rest, vf_neg(rest)));
    vf base = vf_mul(quarters, vf_set1(QUARTER_PIF_1));
    vf sum = vf_add(base, a);
    vf lost = vf_add(vf_sub(base, sum), a);
    return vf_add(sum, vf_add(lost, rest));
}

// The smaller of |y|, |x| over the larger, once more reduced at tan(pi/8); then the angle is a
// multiple of pi/4 plus or minus a small arc.
static inline vf vf_atan2(vf y, vf x) {
    const vf one = vf_set1(1.0f);
    vf ay = vf_abs(y), ax = vf_abs(x);
    vm steep = vf_gt(ay, ax);
    vf n = vf_select(steep, ax, ay), d = vf_select(steep, ay, ax);
    // Keep n + d finite, and n / d precise for subnormals.
    vf scale = vf_select(vf_gt(d, vf_set1(0x1p126f)), vf_set1(0x1p-4f), one);
    scale = vf_select(vf_lt(d, vf_set1(0x1p-90f)), vf_set1(0x1p60f), scale);
    n = vf_mul(n, scale);
    d = vf_mul(d, scale);
    vm same = vf_eq(n, d); // also both infinite; both zero is an angle of 0
    n = vf_select(same, vf_keep(vf_gt(n, vf_zero()), one), n);
    d = vf_select(same, one, d);
    vm upper = vf_gt(n, vf_mul(d, vf_set1(TAN_PI_8F)));
    vf t = vf_div(vf_select(upper, vf_sub(n, d), n), vf_select(upper, vf_add(n, d), d));
    vf z = vf_mul(t, t);
    vf p = vf_mul(vf_mul(t, z), VF_POLY_(poly_atanf, z));

    vm left = vi_lt(vi_bits(x), vi_zero());
    vf quarters = vf_keep(upper, one);
    quarters = vf_select(steep, vf_sub(vf_set1(2.0f), quarters), quarters);
    quarters = vf_select(left, vf_sub(vf_set1(4.0f), quarters), quarters);
    vm down = vm_xor(steep, left);
    t = vf_select(down, vf_neg(t), t);
    p = vf_select(down, vf_neg(p), p);
    vf base = vf_mul(quarters, vf_set1(QUARTER_PIF_1));
    vf sum = vf_add(base, t);
    vf lost = vf_add(vf_sub(base, sum), t);
    vf angle = vf_add(sum, vf_add(lost, vf_mad(quarters, vf_set1(QUARTER_PIF_2), p)));
    vm nan = vm_or(vf_ne(x, x), vf_ne(y, y));
    return vf_select(nan, vf_add(x, y), vf_copysign(angle, y));
}

static inline vf vf_power_of_two_(vi k) { // -126 <= k <= 127
    return vf_from_bits(vi_shl(vi_add(k, vi_set1(127)), 23));
}

static inline vf vf_exp(vf x) {
    vf clamped = vf_max(vf_set1(-104.0f), vf_min(vf_set1(89.0f), x)); // NaN passes
    vi k = vi_round(vf_mul(clamped, vf_set1(ONE_OVER_LN2F)));
    vf kf = vf_from_i(k);
    vf high = vf_sub(clamped, vf_mul(kf, vf_set1(LN2F_1)));
    vf low = vf_mul(kf, vf_set1(LN2F_2));
    vf r = vf_sub(high, low);
    vf tail = vf_sub(vf_sub(high, r), low);
    vf p = vf_mad(vf_mul(r, r), VF_POLY_(poly_expf, r), tail);
    vf sum = vf_add(vf_set1(1.0f), r);
    vf lost = vf_sub(r, vf_sub(sum, vf_set1(1.0f)));
    vf y = vf_add(sum, vf_add(lost, p));
    vi k1 = vi_sar(k, 1); // in two steps: 2^k itself may leave the range when y 2^k does not
    y = vf_mul(y, vf_power_of_two_(k1));
    return vf_mul(y, vf_power_of_two_(vi_sub(k, k1)));
}

// log(2^k m) with m in [sqrt(1/2), sqrt(2)), f = m - 1, s = f / (2 + f). The identity
// 2 s = f - (f^2/2 - s f^2/2) lets f, which is exact, carry the leading part.
static inline vf vf_log(vf x) {
    const vi root_half = vi_set1(0x3f3504f3);
    vm tiny = vf_lt(x, vf_set1(0x1p-126f));
    vi bits = vi_bits(vf_select(tiny, vf_mul(x, vf_set1(0x1p23f)), x));
    vi shifted = vi_sub(bits, root_half);
    vf k = vf_from_i(vi_sub(vi_sar(shifted, 23), vi_keep(tiny, vi_set1(23))));
    vf m = vf_from_bits(vi_add(vi_and(shifted, vi_set1(0x7fffff)), root_half));
    vf f = vf_sub(m, vf_set1(1.0f));
    vf s = vf_div(f, vf_add(vf_set1(2.0f), f)), z = vf_mul(s, s);
    vf half_square = vf_mul(vf_set1(0.5f), vf_mul(f, f));
    vf inner = vf_mul(s, vf_mad(z, VF_POLY_(poly_logf, z), half_square));
    inner = vf_mad(k, vf_set1(LN2F_2), inner);
    vf base = vf_mul(k, vf_set1(LN2F_1));
    vf sum = vf_add(base, f);
    vf lost = vf_lost_(base, vf_neg(f), sum);
    vf y = vf_sub(sum, vf_sub(vf_sub(half_square, inner), lost));
    const vf infinity = vf_set1(__builtin_inff());
    y = vf_select(vf_eq(x, infinity), infinity, y);
    y = vf_select(vf_eq(x, vf_zero()), vf_neg(infinity), y);
    vm bad = vm_not(vf_ge(x, vf_zero()));
    return vf_select(bad, vf_div(vf_sub(x, x), vf_zero()), y);
}

#endif
