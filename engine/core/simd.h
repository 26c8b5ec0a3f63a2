// One source per kernel, three instruction sets, the same bits. A kernel lives in a file named
// `*.simd.c`; the build compiles it once per set (-msse2; -mavx2; -mavx512f/dq/bw/vl; never -mfma,
// always -ffp-contract=off) with CORE_SIMD_WIDTH 4, 8 or 16. Names get the set's suffix by
// CORE_SIMD_NAME; the caller picks by core_simd_active() through a table (CORE_SIMD_SELECT).
//
// Types: vf (floats), vi (32-bit ints), vm (lane mask). Operations are exact IEEE: no FMA, no
// approximate reciprocals. vf_min(a,b) = a < b ? a : b and vf_max(a,b) = a > b ? a : b, as MINPS
// and MAXPS do. Reductions go through memory in lane order 0..15 of a 16-lane block, never by
// width.
#ifndef CORE_SIMD_H
#define CORE_SIMD_H

#include "core/base.h"

typedef enum core_simd_set {
    CORE_SIMD_SSE2,
    CORE_SIMD_AVX2,
    CORE_SIMD_AVX512,
    CORE_SIMD_SETS
} core_simd_set;

// Best set that this processor has.
core_simd_set core_simd_best(void);
// Chooses for the whole process before worlds are made (kernels give equal bits, so this is speed
// only). False + core_fail when the processor lacks it.
bool core_simd_use(core_simd_set set);
core_simd_set core_simd_active(void);          // default: best
const char *core_simd_name(core_simd_set set); // "sse2", "avx2", "avx512"

#define CORE_SIMD_DECLARE(ret, name, args)                                                         \
    ret name##_sse2 args;                                                                          \
    ret name##_avx2 args;                                                                          \
    ret name##_avx512 args;
// Expression: the function pointer for the active set.
#define CORE_SIMD_SELECT(name)                                                                     \
    (core_simd_active() == CORE_SIMD_AVX512 ? name##_avx512                                        \
     : core_simd_active() == CORE_SIMD_AVX2 ? name##_avx2                                          \
                                            : name##_sse2)

#ifdef CORE_SIMD_WIDTH
#include "core/simd_ops.h" // vf, vi, vm and their operations for this width
#endif

#endif
