// Runs every operation of core/simd_ops.h and core/simd_math.h on 16 lanes; one build for each
// instruction set and one on plain floats, which the others are compared with.
#ifndef SIMD_CHECK_H
#define SIMD_CHECK_H

#include "core/simd.h"

#define SIMD_CHECK_LANES 16
#define SIMD_CHECK_ROWS  128

typedef struct simd_check_in {
    _Alignas(64) float a[SIMD_CHECK_LANES], b[SIMD_CHECK_LANES], c[SIMD_CHECK_LANES];
    _Alignas(64) int32_t i[SIMD_CHECK_LANES], j[SIMD_CHECK_LANES];
    int32_t index[SIMD_CHECK_LANES]; // 0..15, repeats allowed
    uint32_t mask;                   // a bit for each lane
} simd_check_in;

typedef struct simd_check_out {
    int rows;
    const char *name[SIMD_CHECK_ROWS];
    bool arithmetic[SIMD_CHECK_ROWS]; // which NaN comes out is the compiler's choice of operand
    uint32_t bits[SIMD_CHECK_ROWS][SIMD_CHECK_LANES];
} simd_check_out;

typedef void simd_check_fn(const simd_check_in *in, simd_check_out *out);
CORE_SIMD_DECLARE(void, simd_check, (const simd_check_in *in, simd_check_out *out))
void simd_check_scalar(const simd_check_in *in, simd_check_out *out);

#endif
