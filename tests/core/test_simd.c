// Every operation of the vector layer gives the scalar operation's bits on every instruction set
// that this processor has.
#include "core/simd.h"

#include <stdio.h>
#include <string.h>

#include "core/math.h"
#include "core/rng.h"
#include "support/simd_check.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {
    core_simd_use(core_simd_best());
    core_clear_error();
}

static float float_of(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static const float edges[] = {0.0f,
                              -0.0f,
                              0.5f,
                              -0.5f,
                              1.5f,
                              2.5f,
                              -2.5f,
                              0.99999994f,
                              -1.0f,
                              1.0f,
                              8388607.5f,
                              8388608.0f,
                              -8388609,
                              2147483520.0f,
                              2147483648.0f,
                              -2147483648.0f,
                              3e9f,
                              -3e9f,
                              1e-40f,
                              -1e-45f,
                              3.4e38f,
                              -3.4e38f,
                              1e30f,
                              400.0f,
                              401.5f,
                              1e10f,
                              88.8f,
                              -103.9f,
                              0.70710677f,
                              3.1415927f,
                              __builtin_inff(),
                              -__builtin_inff(),
                              __builtin_nanf(""),
                              -__builtin_nanf("")};

static float pick_float(core_rng *rng) {
    switch (core_rng_below(rng, 4)) {
    case 0:
        return edges[core_rng_below(rng, CORE_COUNT_OF(edges))];
    case 1:
        return float_of((uint32_t)core_rng_u64(rng));
    case 2:
        return 2.0f * core_rng_float(rng) - 1.0f;
    default:
        return 1000.0f * (core_rng_float(rng) - 0.5f);
    }
}

static int32_t pick_int(core_rng *rng) {
    static const int32_t special[] = {0, 1, -1, INT32_MAX, INT32_MIN, 65536, -65537};
    return core_rng_below(rng, 3) ? (int32_t)(uint32_t)core_rng_u64(rng)
                                  : special[core_rng_below(rng, CORE_COUNT_OF(special))];
}

static simd_check_in input(core_rng *rng) {
    simd_check_in in;
    for (int k = 0; k < SIMD_CHECK_LANES; k++) {
        in.a[k] = pick_float(rng), in.b[k] = pick_float(rng), in.c[k] = pick_float(rng);
        in.i[k] = pick_int(rng), in.j[k] = core_rng_below(rng, 5) ? pick_int(rng) : in.i[k];
        in.index[k] = (int32_t)core_rng_below(rng, SIMD_CHECK_LANES);
    }
    in.mask = (uint32_t)core_rng_u64(rng) & 0xffff;
    return in;
}

static bool same(uint32_t got, uint32_t expected, bool arithmetic) {
    float g = float_of(got), e = float_of(expected);
    return got == expected || (arithmetic && g != g && e != e);
}

static void compare(simd_check_fn *kernel) {
    static simd_check_out expected, got;
    core_rng rng = core_rng_make(2, 1);
    for (int round = 0; round < 3000; round++) {
        simd_check_in in = input(&rng);
        simd_check_scalar(&in, &expected);
        kernel(&in, &got);
        TEST_ASSERT_EQUAL_INT(expected.rows, got.rows);
        for (int row = 0; row < got.rows; row++) {
            for (int k = 0; k < SIMD_CHECK_LANES; k++) {
                if (!same(got.bits[row][k], expected.bits[row][k], expected.arithmetic[row])) {
                    char text[200];
                    snprintf(text, sizeof text, "%s lane %d: a %a b %a c %a i %d j %d",
                             got.name[row], k, (double)in.a[k], (double)in.b[k], (double)in.c[k],
                             in.i[k], in.j[k]);
                    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected.bits[row][k], got.bits[row][k], text);
                }
            }
        }
    }
}

static void sse2(void) { compare(simd_check_sse2); }
static void avx2(void) {
    if (!core_simd_use(CORE_SIMD_AVX2)) {
        TEST_IGNORE_MESSAGE("this processor has no AVX2");
    }
    compare(simd_check_avx2);
}
static void avx512(void) {
    if (!core_simd_use(CORE_SIMD_AVX512)) {
        TEST_IGNORE_MESSAGE("this processor has no AVX-512");
    }
    compare(simd_check_avx512);
}

// The one-lane form agrees with plain C where C defines the result.
static void scalar_is_c(void) {
    static simd_check_out out;
    core_rng rng = core_rng_make(3, 1);
    for (int round = 0; round < 2000; round++) {
        simd_check_in in = input(&rng);
        simd_check_scalar(&in, &out);
        for (int row = 0; row < out.rows; row++) {
            for (int k = 0; k < SIMD_CHECK_LANES; k++) {
                float a = in.a[k], b = in.b[k], expected;
                if (!strcmp(out.name[row], "vf_add(l.a, l.b)")) {
                    expected = a + b;
                } else if (!strcmp(out.name[row], "vf_min(l.a, l.b)")) {
                    expected = a < b ? a : b;
                } else if (!strcmp(out.name[row], "vf_floor(l.a)")) {
                    expected = (float)core_floor((double)a);
                } else if (!strcmp(out.name[row], "vf_sin(l.a)")) {
                    expected = core_sinf(a);
                } else if (!strcmp(out.name[row], "vf_atan2(l.a, l.b)")) {
                    expected = core_atan2f(a, b);
                } else {
                    continue;
                }
                uint32_t bits;
                memcpy(&bits, &expected, sizeof bits);
                TEST_ASSERT_TRUE_MESSAGE(same(out.bits[row][k], bits, true), out.name[row]);
            }
        }
    }
}

static void choice_of_set(void) {
    TEST_ASSERT_TRUE(core_simd_use(CORE_SIMD_SSE2));
    TEST_ASSERT_EQUAL_INT(CORE_SIMD_SSE2, core_simd_active());
    TEST_ASSERT_EQUAL_PTR(simd_check_sse2, CORE_SIMD_SELECT(simd_check));
    TEST_ASSERT_EQUAL_STRING("sse2", core_simd_name(CORE_SIMD_SSE2));
    TEST_ASSERT_EQUAL_STRING("avx2", core_simd_name(CORE_SIMD_AVX2));
    TEST_ASSERT_EQUAL_STRING("avx512", core_simd_name(CORE_SIMD_AVX512));
    TEST_ASSERT_EQUAL_STRING("unknown", core_simd_name((core_simd_set)9));
}

// A set is refused exactly when the processor lacks it, and the active one stays.
static void missing_sets_are_refused(void) {
    TEST_ASSERT_TRUE(core_simd_use(CORE_SIMD_SSE2));
    bool has[CORE_SIMD_SETS] = {
        true, __builtin_cpu_supports("avx2") != 0,
        __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
            __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512vl") != 0};
    for (int set = 0; set < CORE_SIMD_SETS; set++) {
        TEST_ASSERT_TRUE(core_simd_use(CORE_SIMD_SSE2));
        core_clear_error();
        TEST_ASSERT_EQUAL_INT(has[set], core_simd_use((core_simd_set)set));
        TEST_ASSERT_EQUAL_INT(has[set] ? set : CORE_SIMD_SSE2, (int)core_simd_active());
        TEST_ASSERT_EQUAL_INT(has[set], core_last_error()[0] == '\0');
    }
    TEST_ASSERT_FALSE(core_simd_use((core_simd_set)3));
    TEST_ASSERT_FALSE(core_simd_use((core_simd_set)-1));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "expected 0..2"));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(sse2);
    RUN_TEST(avx2);
    RUN_TEST(avx512);
    RUN_TEST(scalar_is_c);
    RUN_TEST(choice_of_set);
    RUN_TEST(missing_sets_are_refused);
    return UNITY_END();
}
