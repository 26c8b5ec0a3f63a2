// Errors in units in the last place against a wider reference, and arguments worth trying.
#ifndef ULP_H
#define ULP_H

#include "core/math_table.h"
#include "core/rng.h"

// |got - exact| in ULP of the exact value rounded to double (float). Two NaNs, and an infinity
// where the rounded value overflows to it, are 0; a NaN or infinity on one side only is 1e30.
double ulp64(double got, long double exact);
double ulp32(float got, double exact);

// libm's long double function of this name; aborts for unknown names.
long double (*ulp_reference(const char *name))(long double);

// Where arguments come from: kinds 0..ULP_KINDS-1.
#define ULP_KINDS 8
double ulp_argument(core_rng *rng, const core_math_entry *entry, int kind);

// Largest error of entry->f64 over `count` arguments of each kind, with the argument it was at.
double ulp_worst(const core_math_entry *entry, int count, core_rng *rng, double *where);

#endif
