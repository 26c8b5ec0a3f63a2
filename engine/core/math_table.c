#include "core/math_table.h"

#include "core/math.h"

#define ONE(name, libm, low, high, u64)                                                            \
    { libm, name, NULL, NULL, NULL, low, high, u64, 0.0 }
#define ONE_F(name, libm, low, high, u64, u32)                                                     \
    { libm, name, NULL, name##f, NULL, low, high, u64, u32 }

const core_math_entry core_math_table[] = {
    ONE_F(core_sin, "sin", -__DBL_MAX__, __DBL_MAX__, 0.80, 0.80),
    ONE_F(core_cos, "cos", -__DBL_MAX__, __DBL_MAX__, 0.80, 0.80),
    ONE_F(core_tan, "tan", -__DBL_MAX__, __DBL_MAX__, 0.90, 2.30),
    ONE_F(core_asin, "asin", -1.0, 1.0, 0.75, 1.25),
    ONE_F(core_acos, "acos", -1.0, 1.0, 0.75, 1.15),
    ONE(core_atan, "atan", -__DBL_MAX__, __DBL_MAX__, 0.75),
    ONE_F(core_exp, "exp", -745.0, 709.0, 0.80, 0.80),
    ONE_F(core_ln, "log", 0.0, __DBL_MAX__, 0.51, 0.80),
    ONE(core_log2, "log2", 0.0, __DBL_MAX__, 0.51),
    ONE(core_log10, "log10", 0.0, __DBL_MAX__, 0.51),
    ONE(core_sinh, "sinh", -710.0, 710.0, 0.85),
    ONE(core_cosh, "cosh", -710.0, 710.0, 0.75),
    ONE(core_tanh, "tanh", -__DBL_MAX__, __DBL_MAX__, 0.80),
    {"atan2", NULL, core_atan2, NULL, core_atan2f, -__DBL_MAX__, __DBL_MAX__, 0.75, 1.75},
    {"pow", NULL, core_pow, NULL, core_powf, 0.0, __DBL_MAX__, 0.80, 0.51},
    {"fmod", NULL, core_fmod, NULL, NULL, -__DBL_MAX__, __DBL_MAX__, 0.0, 0.0},
};
const int core_math_table_count = (int)CORE_COUNT_OF(core_math_table);
