#include "core/rng.h"

#include <math.h>

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

// First word of Philox-2x64-10 for a zero key and counter: the known answer of the paper's own
// library (Random123, kat_vectors).
static void the_known_answer(void) {
    TEST_ASSERT_EQUAL_HEX64(0xca00a0459843d731u, core_rng_at(0, 0, 0));
}

static void a_value_depends_on_seed_stream_and_place_alone(void) {
    core_rng a = core_rng_make(42, CORE_RNG_SIM), b = core_rng_make(42, CORE_RNG_SIM);
    for (uint64_t i = 0; i < 1000; ++i) {
        uint64_t value = core_rng_u64(&a);
        TEST_ASSERT_EQUAL_HEX64(core_rng_at(42, CORE_RNG_SIM, i), value);
        TEST_ASSERT_TRUE(value != core_rng_at(43, CORE_RNG_SIM, i));
        TEST_ASSERT_TRUE(value != core_rng_at(42, CORE_RNG_VIEW, i));
    }
    TEST_ASSERT_EQUAL_UINT64(1000, a.counter);
    b.counter = 999; // a jump is an assignment
    TEST_ASSERT_EQUAL_HEX64(core_rng_at(42, CORE_RNG_SIM, 999), core_rng_u64(&b));
}

// 2^20 values: each bit set half of the time; 5 standard deviations are 5 * 512.
static void every_bit_is_fair(void) {
    core_rng rng = core_rng_make(1, 1);
    int set[64] = {0};
    for (int i = 0; i < 1 << 20; ++i) {
        uint64_t value = core_rng_u64(&rng);
        for (int bit = 0; bit < 64; ++bit) {
            set[bit] += value >> bit & 1;
        }
    }
    for (int bit = 0; bit < 64; ++bit) {
        TEST_ASSERT_INT_WITHIN(5 * 512, 1 << 19, set[bit]);
    }
}

static void moments_of_the_unit_interval(void) {
    enum { N = 1 << 20 };
    core_rng rng = core_rng_make(2, 1);
    double sum = 0, squares = 0, lag = 0, former = 0.5, least = 1, most = 0;
    for (int i = 0; i < N; ++i) {
        double x = core_rng_double(&rng);
        sum += x;
        squares += x * x;
        lag += (x - 0.5) * (former - 0.5);
        former = x;
        least = fmin(least, x);
        most = fmax(most, x);
    }
    // 5 standard deviations of the mean (1/sqrt(12 N)), of the second moment (sqrt(4/45/N)) and of
    // the lag-1 covariance (1/12/sqrt(N)).
    TEST_ASSERT_DOUBLE_WITHIN(5 * sqrt(1.0 / 12 / N), 0.5, sum / N);
    TEST_ASSERT_DOUBLE_WITHIN(5 * sqrt(4.0 / 45 / N), 1.0 / 3, squares / N);
    TEST_ASSERT_DOUBLE_WITHIN(5.0 / 12 / sqrt(N), 0.0, lag / N);
    TEST_ASSERT_TRUE(least >= 0 && least < 1e-4 && most < 1 && most > 1 - 1e-4);
}

static void floats_stay_below_one(void) {
    core_rng rng = core_rng_make(3, 1);
    float most = 0;
    for (int i = 0; i < 1 << 20; ++i) {
        float x = core_rng_float(&rng);
        TEST_ASSERT_TRUE(x >= 0.0f && x < 1.0f);
        most = x > most ? x : most;
    }
    TEST_ASSERT_TRUE(most > 1 - 1e-4f);
}

// Pairs of neighbours and of two streams fill a 64 x 64 grid evenly: chi-square with 4095 degrees
// of freedom within 5 standard deviations (90.5).
static void expect_even_pairs(uint64_t stream_a, uint64_t stream_b, uint64_t shift) {
    static uint32_t cell[64][64];
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j) {
            cell[i][j] = 0;
        }
    }
    for (uint64_t i = 0; i < 1u << 19; ++i) {
        uint64_t x = core_rng_at(7, stream_a, i), y = core_rng_at(7, stream_b, i + shift);
        cell[x >> 58][y >> 58]++;
    }
    double chi2 = 0, expected = (1u << 19) / 4096.0;
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j) {
            chi2 += (cell[i][j] - expected) * (cell[i][j] - expected) / expected;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(5 * 90.5, 4095, chi2);
}

static void pairs_are_independent(void) {
    expect_even_pairs(1, 1, 1);
    expect_even_pairs(1, 2, 0);
    expect_even_pairs(1, 2, 1);
    expect_even_pairs(0, 1u << 31, 0);
}

// Counts of below(n) for an n that does not divide 2^32: chi-square with n - 1 degrees of freedom.
static void below_is_unbiased(void) {
    static const uint32_t bounds[] = {1, 2, 3, 6, 10, 1000};
    for (size_t k = 0; k < CORE_COUNT_OF(bounds); ++k) {
        uint32_t n = bounds[k], counts[1000] = {0};
        core_rng rng = core_rng_make(4, k);
        for (int i = 0; i < 300000; ++i) {
            uint32_t value = core_rng_below(&rng, n);
            TEST_ASSERT_TRUE(value < n);
            counts[value]++;
        }
        double chi2 = 0, expected = 300000.0 / n;
        for (uint32_t i = 0; i < n; ++i) {
            chi2 += (counts[i] - expected) * (counts[i] - expected) / expected;
        }
        TEST_ASSERT_DOUBLE_WITHIN(5 * sqrt(2.0 * n) + 1e-9, n - 1, chi2);
    }
}

// 3/4 of 2^32: multiply-and-shift alone would give every third value twice as often.
static void below_is_unbiased_for_large_bounds(void) {
    core_rng rng = core_rng_make(5, 1);
    uint32_t n = 3u << 30, thirds[3] = {0};
    for (int i = 0; i < 300000; ++i) {
        thirds[core_rng_below(&rng, n) % 3]++;
    }
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_INT_WITHIN(1300, 100000, thirds[i]); // 5 * sqrt(300000 * 2/9)
    }
    TEST_ASSERT_TRUE(rng.counter > 390000 && rng.counter < 410000); // 4/3 draws a value
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_known_answer);
    RUN_TEST(a_value_depends_on_seed_stream_and_place_alone);
    RUN_TEST(every_bit_is_fair);
    RUN_TEST(moments_of_the_unit_interval);
    RUN_TEST(floats_stay_below_one);
    RUN_TEST(pairs_are_independent);
    RUN_TEST(below_is_unbiased);
    RUN_TEST(below_is_unbiased_for_large_bounds);
    return UNITY_END();
}
