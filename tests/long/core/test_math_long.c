// As tests/core/test_math_double.c and test_math_float.c, over millions of arguments; prints the
// largest error of each function, which is what the bounds in core/math_table.c were taken from.
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/math.h"
#include "core/math_table.h"
#include "support/ulp.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void doubles(void) {
    core_rng rng = core_rng_make(11, 1);
    for (int f = 0; f < core_math_table_count; f++) {
        const core_math_entry *entry = &core_math_table[f];
        if (entry->f64) {
            double where = 0.0, worst = ulp_worst(entry, 400000, &rng, &where);
            printf("%-6s double %.4f ULP at %a\n", entry->name, worst, where);
            TEST_ASSERT_TRUE_MESSAGE(worst <= entry->ulp64, entry->name);
        }
    }
}

static void powers(void) {
    core_rng rng = core_rng_make(12, 1);
    double worst = 0.0, worst_x = 0.0, worst_y = 0.0;
    for (int i = 0; i < 4000000; i++) {
        double x = exp2(80.0 * (core_rng_double(&rng) - 0.5));
        double y = 40.0 * (core_rng_double(&rng) - 0.5);
        if (i & 1) {
            x = 1.0 + exp2(-50.0 * core_rng_double(&rng)), y = exp2(58.0 * core_rng_double(&rng));
        }
        double error = ulp64(core_pow(x, y), powl(x, y));
        if (error > worst) {
            worst = error, worst_x = x, worst_y = y;
        }
    }
    printf("pow    double %.4f ULP at %a, %a\n", worst, worst_x, worst_y);
    TEST_ASSERT_TRUE(worst <= 0.80);
}

static void floats(void) {
    for (int f = 0; f < core_math_table_count; f++) {
        const core_math_entry *entry = &core_math_table[f];
        if (!entry->f32) {
            continue;
        }
        long double (*reference)(long double) = ulp_reference(entry->name);
        double worst = 0.0;
        float where = 0.0f;
        for (uint64_t bits = 0; bits <= UINT32_MAX; bits += 331) {
            uint32_t word = (uint32_t)bits;
            float x;
            memcpy(&x, &word, sizeof x);
            double error = ulp32(entry->f32(x), (double)reference((long double)x));
            if (error > worst) {
                worst = error, where = x;
            }
        }
        printf("%-6s float  %.4f ULP at %a\n", entry->name, worst, (double)where);
        TEST_ASSERT_TRUE_MESSAGE(worst <= entry->ulp32, entry->name);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(doubles);
    RUN_TEST(powers);
    RUN_TEST(floats);
    return UNITY_END();
}
