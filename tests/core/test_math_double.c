// The double functions against libm in long double, at the bounds that core_math_table states, and
// at the ends of the range as C17 Annex F wants them.
#include "core/math.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/hash.h"
#include "core/math_table.h"
#include "support/ulp.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
static void equal(double expected, double got) { // to the bit; any NaN for a NaN
    if (isnan(expected)) {
        TEST_ASSERT_TRUE(isnan(got));
    } else {
        TEST_ASSERT_EQUAL_HEX64(bits_of(expected), bits_of(got));
    }
}

static void one_argument(void) {
    core_rng rng = core_rng_make(4, 1);
    int tested = 0;
    for (int f = 0; f < core_math_table_count; f++) {
        const core_math_entry *entry = &core_math_table[f];
        if (entry->f64) {
            double where = 0.0, worst = ulp_worst(entry, 12000, &rng, &where);
            char text[100];
            snprintf(text, sizeof text, "%s: %.4f ULP at %a", entry->name, worst, where);
            TEST_ASSERT_TRUE_MESSAGE(worst <= entry->ulp64, text);
            TEST_ASSERT_TRUE_MESSAGE(worst >= 0.4, text); // it was measured at all
            tested++;
        }
    }
    TEST_ASSERT_EQUAL_INT(13, tested);
}

static void bound_2(const char *name, double x, double y, double got, long double exact) {
    double bound = 0.0;
    for (int f = 0; f < core_math_table_count; f++) {
        bound = strcmp(core_math_table[f].name, name) ? bound : core_math_table[f].ulp64;
    }
    double error = ulp64(got, exact);
    if (!(error <= bound)) {
        char text[120];
        snprintf(text, sizeof text, "%s(%a, %a): %.4f ULP", name, x, y, error);
        TEST_FAIL_MESSAGE(text);
    }
}

static double spread(core_rng *rng, double low, double high) {
    double size = exp2(low + (high - low) * core_rng_double(rng));
    return core_rng_below(rng, 2) ? -size : size;
}
static double any_bits(core_rng *rng) {
    uint64_t bits = core_rng_u64(rng);
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void two_arguments(void) {
    core_rng rng = core_rng_make(5, 1);
    for (int i = 0; i < 150000; i++) {
        double x = spread(&rng, -20, 20), y = spread(&rng, -20, 20);
        if (i % 3 == 0) {
            x = any_bits(&rng), y = any_bits(&rng);
        }
        bound_2("atan2", y, x, core_atan2(y, x), atan2l(y, x));
        switch (i % 4) {
        case 0:
            x = fabs(spread(&rng, -10, 10)), y = 40.0 * (core_rng_double(&rng) - 0.5);
            break;
        case 1: // near one, to great powers
            x = 1.0 + spread(&rng, -50, -2), y = spread(&rng, 0, 58);
            break;
        case 2: // whole powers, of negative numbers too
            x = spread(&rng, -3, 3), y = (double)core_rng_below(&rng, 200) - 100.0;
            break;
        default:
            x = any_bits(&rng), y = spread(&rng, -12, 12);
        }
        bound_2("pow", x, y, core_pow(x, y), powl(x, y));
    }
}

static void powers_that_are_doubles(void) {
    core_rng rng = core_rng_make(6, 1);
    for (int i = 0; i < 20000; i++) {
        double x = any_bits(&rng);
        equal(x * x, core_pow(x, 2.0));
        equal(isnan(x) ? x : 1.0 / x, core_pow(x, -1.0));
        equal(x, core_pow(x, 1.0));
        double root = fabs(spread(&rng, -1000, 1000));
        equal(sqrt(root), core_pow(root, 0.5));
    }
    for (int base = -50; base <= 50; base++) {
        double power = 1.0;
        for (int n = 0; fabs(power) < 0x1p53; n++) {
            equal(power, core_pow(base, n));
            power *= base;
            if (base >= -1 && base <= 1 && n > 60) {
                break;
            }
        }
    }
    for (int k = -1074; k <= 1023; k++) {
        equal(ldexp(1.0, k), core_pow(2.0, k));
        equal(k, core_log2(ldexp(1.0, k)));
    }
    double ten = 1.0;
    for (int k = 0; k <= 22; k++, ten *= 10.0) {
        equal(ten, core_pow(10.0, k));
        equal(k, core_log10(ten));
    }
}

static void powers_at_the_ends(void) {
    const double values[] = {0.0,       -0.0,
                             1.0,       -1.0,
                             0.5,       -0.5,
                             2.0,       3.0,
                             -3.0,      4.5,
                             1e300,     -1e300,
                             1e-300,    INFINITY,
                             -INFINITY, NAN,
                             5e-324,    -5e-324,
                             DBL_MAX,   0x1p53,
                             -0x1.8p53, 0x1.fffffffffffffp52,
                             7.0,       -8.0,
                             0.99999999};
    for (size_t i = 0; i < CORE_COUNT_OF(values); i++) {
        for (size_t j = 0; j < CORE_COUNT_OF(values); j++) {
            double x = values[i], y = values[j], expected = pow(x, y);
            if (isnan(expected) || isinf(expected) || expected == 0.0 || fabs(expected) == 1.0) {
                equal(expected, core_pow(x, y));
            }
        }
    }
}

static void ends_of_the_range(void) {
    for (int f = 0; f < core_math_table_count; f++) {
        if (core_math_table[f].f64) {
            equal(NAN, core_math_table[f].f64(NAN));
        }
    }
    double (*const odd[])(double) = {core_sin,  core_tan,  core_asin,  core_atan,
                                     core_sinh, core_tanh, core_floor, core_ceil};
    for (size_t i = 0; i < CORE_COUNT_OF(odd); i++) {
        equal(0.0, odd[i](0.0));
        equal(-0.0, odd[i](-0.0));
    }
    for (size_t i = 0; i < 6; i++) {
        equal(5e-324, odd[i](5e-324));
    }
    const double infinities[] = {INFINITY, -INFINITY};
    for (int i = 0; i < 2; i++) {
        double inf = infinities[i];
        equal(NAN, core_sin(inf)), equal(NAN, core_cos(inf)), equal(NAN, core_tan(inf));
        equal(NAN, core_asin(inf)), equal(NAN, core_acos(inf));
        equal(atan(inf), core_atan(inf)), equal(tanh(inf), core_tanh(inf));
        equal(inf, core_sinh(inf)), equal(INFINITY, core_cosh(inf));
        equal(i ? 0.0 : INFINITY, core_exp(inf));
        equal(inf, core_floor(inf)), equal(inf, core_ceil(inf));
    }
    double (*const logs[])(double) = {core_ln, core_log2, core_log10};
    for (size_t i = 0; i < 3; i++) {
        equal(-INFINITY, logs[i](0.0)), equal(-INFINITY, logs[i](-0.0));
        equal(NAN, logs[i](-1.0)), equal(NAN, logs[i](-INFINITY)), equal(0.0, logs[i](1.0));
        equal(INFINITY, logs[i](INFINITY));
    }
    equal(1.0, core_cos(0.0)), equal(1.0, core_exp(-0.0)), equal(0.0, core_acos(1.0));
    equal(NAN, core_asin(1.0000000000000002)), equal(NAN, core_acos(-1.0000000000000002));
    equal(asin(1.0), core_asin(1.0)), equal(acos(-1.0), core_acos(-1.0));
    equal(INFINITY, core_exp(709.79)), equal(0.0, core_exp(-745.2));
    equal(-1.0, core_floor(-0.5)), equal(-0.0, core_ceil(-0.5)), equal(1.0, core_ceil(0.5));
}

static void arctangent_of_zeros_and_infinities(void) {
    const double values[] = {0.0, -0.0, INFINITY, -INFINITY, 1.0, -1.0, 5e-324, DBL_MAX, NAN};
    for (size_t i = 0; i < CORE_COUNT_OF(values); i++) {
        for (size_t j = 0; j < CORE_COUNT_OF(values); j++) {
            equal(atan2(values[i], values[j]), core_atan2(values[i], values[j]));
        }
    }
}

static void exact_functions(void) {
    core_rng rng = core_rng_make(7, 1);
    for (int i = 0; i < 100000; i++) {
        double x = any_bits(&rng), y = any_bits(&rng);
        if (i & 1) {
            x = spread(&rng, -2, 60), y = spread(&rng, -12, 6);
        }
        equal(fmod(x, y), core_fmod(x, y));
        equal(floor(x), core_floor(x));
        equal(ceil(x), core_ceil(x));
    }
    equal(fmod(DBL_MAX, 5e-324), core_fmod(DBL_MAX, 5e-324));
    equal(fmod(-1e308, 3e-310), core_fmod(-1e308, 3e-310));
    equal(NAN, core_fmod(1.0, 0.0)), equal(NAN, core_fmod(INFINITY, 1.0));
    equal(5.0, core_fmod(5.0, INFINITY)), equal(-0.0, core_fmod(-6.0, 3.0));
}

// The logarithms are rounded from a wider value, so growing arguments never give falling results;
// tried in steps of one ULP where the method changes: at one, at table borders, at binade ends.
static void logarithms_are_monotonic(void) {
    double (*const logs[])(double) = {core_ln, core_log2, core_log10};
    const double places[] = {1.0,         M_SQRT1_2, M_SQRT2, 129.5 / 128,
                             127.5 / 128, 0.75,      2.0,     0x1p-1022};
    for (size_t f = 0; f < CORE_COUNT_OF(logs); f++) {
        for (size_t i = 0; i < CORE_COUNT_OF(places); i++) {
            double x = places[i];
            for (int k = 0; k < 1000; k++) {
                x = nextafter(x, -INFINITY);
            }
            double last = logs[f](x);
            for (int k = 0; k < 2000; k++) {
                x = nextafter(x, INFINITY);
                double y = logs[f](x);
                TEST_ASSERT_TRUE(y >= last);
                last = y;
            }
        }
    }
}

// One hash of many results, the same with every compiler and optimisation. It changes only when a
// function's method does.
static void same_bits_everywhere(void) {
    core_rng rng = core_rng_make(13, 1);
    uint64_t hash = 0;
    for (int f = 0; f < core_math_table_count; f++) {
        const core_math_entry *entry = &core_math_table[f];
        for (int i = 0; i < 4000; i++) {
            double x = ulp_argument(&rng, entry, i % ULP_KINDS), y = 10.0 * core_rng_double(&rng);
            double wide = entry->f64 ? entry->f64(x) : entry->f64_2(x, y);
            float narrow = entry->f32     ? entry->f32((float)x)
                           : entry->f32_2 ? entry->f32_2((float)x, (float)y)
                                          : 0.0f;
            uint64_t bits = isnan(wide) ? 1 : bits_of(wide);
            uint64_t narrow_bits = isnan(narrow) ? 1 : bits_of((double)narrow);
            hash = core_hash_mix(core_hash_mix(hash, bits), narrow_bits);
        }
    }
    TEST_ASSERT_EQUAL_HEX64(0x4F1078081736FA96, hash);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(one_argument);
    RUN_TEST(two_arguments);
    RUN_TEST(powers_that_are_doubles);
    RUN_TEST(powers_at_the_ends);
    RUN_TEST(ends_of_the_range);
    RUN_TEST(arctangent_of_zeros_and_infinities);
    RUN_TEST(exact_functions);
    RUN_TEST(logarithms_are_monotonic);
    RUN_TEST(same_bits_everywhere);
    return UNITY_END();
}
