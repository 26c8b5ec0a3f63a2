// The functions of core/math.h as data: tests and experiments walk this table instead of naming
// each one.
#ifndef CORE_MATH_TABLE_H
#define CORE_MATH_TABLE_H

#include "core/base.h"

typedef struct core_math_entry {
    const char *name;      // as libm calls the double function: "sin", "pow", ...
    double (*f64)(double); // functions of one argument, else NULL
    double (*f64_2)(double, double);
    float (*f32)(float); // NULL when there is no float version
    float (*f32_2)(float, float);
    double low, high;    // arguments (the first of two) that give ordinary results
    double ulp64, ulp32; // stated bounds on the error, in units of the result's last place
} core_math_entry;

extern const core_math_entry core_math_table[];
extern const int core_math_table_count;

#endif
