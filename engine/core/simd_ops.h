// The operations of one instruction set: vf (CORE_SIMD_WIDTH floats), vi (as many 32-bit integers),
// vm (one truth value a lane). Included through core/simd.h by files that define CORE_SIMD_WIDTH:
// 4, 8 and 16 in *.simd.c; 1 gives the same operations on plain floats, so that a function written
// once on top (core/simd_math.h) has a scalar form with the same bits.
//
//   memory     vf_load vf_store (aligned to the vector), vf_loadu vf_storeu (any float address);
//              vf_load_mask (lanes off: 0, not read), vf_store_mask (lanes off: not written);
//              vf_gather(base, index), vf_gather_mask(m, base, index) (lanes off: 0, not read),
//              vf_scatter_mask(m, base, index, a) (equal indices: the highest lane wins);
//              the same for vi
//   constants  vf_set1 vi_set1 vf_zero vi_zero; vi_iota = 0, 1, 2, ...
//   float      vf_add sub mul div sqrt neg abs; vf_mad(a, b, c) = a*b + c, rounded twice;
//              vf_min(a, b) = a < b ? a : b, vf_max(a, b) = a > b ? a : b (second wins for NaN and
//              for two zeros); vf_floor, vf_round (to nearest, ties to even);
//              vf_copysign(a, s) = magnitude of a, sign of s
//   compare    vf_lt le gt ge eq (false for NaN), vf_ne (true for NaN); vi_eq vi_lt vi_gt (signed)
//   mask       vm_and or xor not, vm_andnot(a, b) = a and not b; vm_any vm_all vm_bits (lane i in
//              bit i), vm_from_bits, vm_first(n) (lanes below n)
//   select     vf_select(m, a, b) = m ? a : b, vi_select; vf_keep(m, a) = m ? a : +0, vi_keep
//   integer    vi_add sub mul (low 32 bits), vi_min vi_max (signed); vi_and or xor,
//              vi_andnot(a, b) = a & ~b; vi_shl vi_shr (zeros in) vi_sar (sign in), count 0..31
//   convert    vf_from_i; vi_round (nearest even) and vi_trunc: outside int32 and NaN give
//              INT32_MIN; vi_bits and vf_from_bits reinterpret
#ifndef CORE_SIMD_OPS_H
#define CORE_SIMD_OPS_H

#include <immintrin.h>

#include "core/base.h"

#define CORE_SIMD_PASTE_(name, suffix)  name##_##suffix
#define CORE_SIMD_EXPAND_(name, suffix) CORE_SIMD_PASTE_(name, suffix)
// name -> name_sse2, name_avx2, name_avx512 (name_scalar for width 1).
#define CORE_SIMD_NAME(name) CORE_SIMD_EXPAND_(name, CORE_SIMD_SUFFIX)

#if CORE_SIMD_WIDTH == 1
#define CORE_SIMD_SUFFIX scalar
#include "core/simd_scalar.h"
#elif CORE_SIMD_WIDTH == 4
#define CORE_SIMD_SUFFIX sse2
#include "core/simd_sse2.h"
#elif CORE_SIMD_WIDTH == 8
#define CORE_SIMD_SUFFIX avx2
#include "core/simd_avx2.h"
#elif CORE_SIMD_WIDTH == 16
#define CORE_SIMD_SUFFIX avx512
#include "core/simd_avx512.h"
#else
#error "CORE_SIMD_WIDTH must be 1, 4, 8 or 16"
#endif

static inline vf vf_mad(vf a, vf b, vf c) { return vf_add(vf_mul(a, b), c); }
static inline vf vf_neg(vf a) { return vf_from_bits(vi_xor(vi_bits(a), vi_set1(INT32_MIN))); }
static inline vf vf_abs(vf a) { return vf_from_bits(vi_and(vi_bits(a), vi_set1(INT32_MAX))); }
static inline vf vf_copysign(vf a, vf s) {
    return vf_from_bits(
        vi_or(vi_and(vi_bits(a), vi_set1(INT32_MAX)), vi_and(vi_bits(s), vi_set1(INT32_MIN))));
}
static inline vm vm_first(int n) {
    return vm_from_bits(n >= CORE_SIMD_WIDTH ? (1u << CORE_SIMD_WIDTH) - 1
                        : n > 0              ? (1u << n) - 1
                                             : 0);
}
static inline bool vm_all(vm m) { return vm_bits(m) == (1u << CORE_SIMD_WIDTH) - 1; }
static inline bool vm_any(vm m) { return vm_bits(m) != 0; }

#endif
