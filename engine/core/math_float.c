// The float functions: core/simd_math.h one lane wide, so that kernels and scalar code agree.
#define CORE_SIMD_WIDTH 1
#include "core/simd_math.h"

#include "core/math.h"

// Far from zero a float's remainder needs more digits than float arithmetic has; double has them.
float core_sinf_far(float x) { return (float)core_sin((double)x); }
float core_cosf_far(float x) { return (float)core_cos((double)x); }
float core_tanf_far(float x) { return (float)core_tan((double)x); }

float core_sinf(float x) { return vf_sin(x); }
float core_cosf(float x) { return vf_cos(x); }
void core_sincosf(float x, float *s, float *c) { vf_sincos(x, s, c); }
float core_tanf(float x) { return vf_tan(x); }
float core_asinf(float x) { return vf_asin(x); }
float core_acosf(float x) { return vf_acos(x); }
float core_atan2f(float y, float x) { return vf_atan2(y, x); }
float core_expf(float x) { return vf_exp(x); }
float core_lnf(float x) { return vf_log(x); }
float core_powf(float x, float y) { return (float)core_pow((double)x, (double)y); }
