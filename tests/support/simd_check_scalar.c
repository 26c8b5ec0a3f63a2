// The same checks one lane wide.
#define CORE_SIMD_WIDTH 1
#include "support/simd_check.simd.c"
