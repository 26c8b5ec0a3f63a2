// The float functions against libm in double, over floats spread through all bit patterns, at the
// bounds that core_math_table states.
#include "core/math.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/math_table.h"
#include "support/ulp.h"
#include "unity.h"

#ifndef FLOAT_STRIDE
#define FLOAT_STRIDE 9973u // prime: every exponent, all parts of the fraction
#endif

void setUp(void) {}
void tearDown(void) {}

static float float_of(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void one_argument(void) {
    int tested = 0;
    for (int f = 0; f < core_math_table_count; f++) {
        const core_math_entry *entry = &core_math_table[f];
        if (!entry->f32) {
            continue;
        }
        long double (*reference)(long double) = ulp_reference(entry->name);
        double worst = 0.0;
        float where = 0.0f;
        for (uint64_t bits = 0; bits <= UINT32_MAX; bits += FLOAT_STRIDE) {
            float x = float_of((uint32_t)bits);
            double error = ulp32(entry->f32(x), (double)reference((long double)x));
            if (error > worst) {
                worst = error;
                where = x;
            }
        }
        char text[100];
        snprintf(text, sizeof text, "%sf: %.4f ULP at %a", entry->name, worst, (double)where);
        TEST_ASSERT_TRUE_MESSAGE(worst <= entry->ulp32 && worst >= 0.4, text);
        tested++;
    }
    TEST_ASSERT_EQUAL_INT(7, tested);
}

static double bound(const char *name) {
    for (int f = 0; f < core_math_table_count; f++) {
        if (!strcmp(core_math_table[f].name, name)) {
            return core_math_table[f].ulp32;
        }
    }
    return 0.0;
}

static void two_arguments(void) {
    core_rng rng = core_rng_make(8, 1);
    double worst_atan2 = 0.0, worst_pow = 0.0;
    for (int i = 0; i < 300000; i++) {
        float x = float_of((uint32_t)core_rng_u64(&rng)),
              y = float_of((uint32_t)core_rng_u64(&rng));
        if (i & 1) {
            x = core_rng_float(&rng) - 0.5f, y = core_rng_float(&rng) - 0.5f;
        }
        worst_atan2 = fmax(worst_atan2, ulp32(core_atan2f(y, x), atan2((double)y, (double)x)));
        float base = 40.0f * core_rng_float(&rng), power = 60.0f * (core_rng_float(&rng) - 0.5f);
        worst_pow =
            fmax(worst_pow, ulp32(core_powf(base, power), pow((double)base, (double)power)));
    }
    TEST_ASSERT_TRUE(worst_atan2 <= bound("atan2") && worst_atan2 > 0.5);
    TEST_ASSERT_TRUE(worst_pow <= bound("pow") && worst_pow > 0.4);
}

static void special_values(void) {
    const float values[] = {0.0f, -0.0f, 1.0f, -1.0f, INFINITY, -INFINITY, 1e-45f, 3e38f};
    for (size_t i = 0; i < CORE_COUNT_OF(values); i++) {
        for (size_t j = 0; j < CORE_COUNT_OF(values); j++) {
            float got = core_atan2f(values[i], values[j]);
            float exact = (float)atan2((double)values[i], (double)values[j]);
            TEST_ASSERT_TRUE(ulp32(got, (double)exact) <= 1.0);
            TEST_ASSERT_EQUAL_INT(!!signbit(exact), !!signbit(got));
        }
    }
    TEST_ASSERT_TRUE(isnan(core_atan2f(NAN, 1.0f)) && isnan(core_atan2f(1.0f, NAN)));
    TEST_ASSERT_TRUE(isnan(core_sinf(INFINITY)) && isnan(core_cosf(-INFINITY)));
    TEST_ASSERT_TRUE(isnan(core_asinf(1.0001f)) && isnan(core_acosf(-1.0001f)));
    TEST_ASSERT_TRUE(isnan(core_lnf(-1.0f)) && isnan(core_expf(NAN)) && isnan(core_lnf(NAN)));
    TEST_ASSERT_TRUE(core_lnf(0.0f) == -INFINITY && core_lnf(-0.0f) == -INFINITY);
    TEST_ASSERT_TRUE(core_expf(INFINITY) == INFINITY && core_expf(-INFINITY) == 0.0f);
    TEST_ASSERT_TRUE(core_lnf(INFINITY) == INFINITY && core_lnf(1.0f) == 0.0f);
    TEST_ASSERT_TRUE(signbit(core_sinf(-0.0f)) && signbit(core_tanf(-0.0f)));
    TEST_ASSERT_TRUE(signbit(core_asinf(-0.0f)) && core_acosf(1.0f) == 0.0f);
    TEST_ASSERT_TRUE(core_cosf(0.0f) == 1.0f && core_expf(-0.0f) == 1.0f);
}

static void sine_and_cosine_together(void) {
    core_rng rng = core_rng_make(9, 1);
    for (int i = 0; i < 20000; i++) {
        float x = 2000.0f * (core_rng_float(&rng) - 0.5f), s, c;
        core_sincosf(x, &s, &c);
        float separate_s = core_sinf(x), separate_c = core_cosf(x);
        TEST_ASSERT_EQUAL_MEMORY(&separate_s, &s, sizeof s);
        TEST_ASSERT_EQUAL_MEMORY(&separate_c, &c, sizeof c);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(one_argument);
    RUN_TEST(two_arguments);
    RUN_TEST(special_values);
    RUN_TEST(sine_and_cosine_together);
    return UNITY_END();
}
