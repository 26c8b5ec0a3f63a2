#include "core/hash.h"

#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static int popcount(uint64_t x) { return __builtin_popcountll(x); }

// Golden values: the hash is part of saves and replays. A change here breaks them on purpose only.
static void values_are_pinned(void) {
    uint8_t bytes[200];
    for (int i = 0; i < 200; ++i) {
        bytes[i] = (uint8_t)(i * 7);
    }
    TEST_ASSERT_EQUAL_HEX64(0x15a37c8e4fd0588au, core_hash(bytes, 0, 0));
    TEST_ASSERT_EQUAL_HEX64(0xa348e753224ae94eu, core_hash(bytes, 3, 0));
    TEST_ASSERT_EQUAL_HEX64(0xe7eb96fda40a1ce3u, core_hash(bytes, 200, 0));
    TEST_ASSERT_EQUAL_HEX64(0x975ceb712cf29f5fu, core_hash(bytes, 200, 1));
    TEST_ASSERT_EQUAL_HEX64(0xa41b9dce406b0336u, core_hash_string("phys.bodies"));
    TEST_ASSERT_EQUAL_HEX64(0x3706970b052f16b1u, core_hash_mix(1, 2));
}

static void alignment_does_not_matter(void) {
    uint8_t bytes[256 + 8];
    for (size_t shift = 0; shift < 8; ++shift) {
        for (int i = 0; i < 256; ++i) {
            bytes[shift + (size_t)i] = (uint8_t)(i ^ 0x5a);
        }
        static uint64_t first;
        uint64_t h = core_hash(bytes + shift, 256, 9);
        first = shift ? first : h;
        TEST_ASSERT_EQUAL_HEX64(first, h);
    }
}

// Strict avalanche: flipping any input bit flips each output bit with probability 1/2. 800 trials:
// 5.6 standard deviations are 0.1.
static void expect_avalanche(size_t bytes) {
    enum { TRIALS = 800 };
    core_rng rng = core_rng_make(bytes, 0);
    uint8_t data[256];
    for (size_t bit = 0; bit < bytes * 8; bit += 1 + bytes / 24) {
        int flips[64] = {0};
        for (int trial = 0; trial < TRIALS; ++trial) {
            for (size_t i = 0; i < bytes; ++i) {
                data[i] = (uint8_t)core_rng_u64(&rng);
            }
            uint64_t seed = core_rng_u64(&rng); // a short text has few values of its own
            uint64_t before = core_hash(data, bytes, seed);
            data[bit / 8] ^= (uint8_t)(1u << bit % 8);
            uint64_t changed = before ^ core_hash(data, bytes, seed);
            for (int out = 0; out < 64; ++out) {
                flips[out] += changed >> out & 1;
            }
        }
        for (int out = 0; out < 64; ++out) {
            double p = (double)flips[out] / TRIALS;
            TEST_ASSERT_TRUE_MESSAGE(p > 0.4 && p < 0.6, "biased output bit");
        }
    }
}

static void any_bit_avalanches(void) {
    static const size_t lengths[] = {1, 4, 8, 12, 16, 40, 64, 71, 128, 200};
    for (size_t i = 0; i < CORE_COUNT_OF(lengths); ++i) {
        expect_avalanche(lengths[i]);
    }
}

static int compare_u64(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static size_t collisions(uint64_t *hashes, size_t count) {
    size_t same = 0;
    qsort(hashes, count, sizeof *hashes, compare_u64);
    for (size_t i = 1; i < count; ++i) {
        same += hashes[i] == hashes[i - 1];
    }
    return same;
}

// All inputs of 256 zero bytes with one or two bits flipped: differences as sparse as they come,
// such as the signs of two floats.
static void sparse_inputs_do_not_collide(void) {
    enum { BITS = 256 * 8, STEP = 3 };
    size_t capacity = (size_t)BITS * BITS / 2 / STEP + BITS * 2, count = 0;
    uint64_t *hashes = malloc(capacity * sizeof *hashes);
    uint8_t data[256] = {0};
    for (size_t a = 0; a < BITS; a += STEP) {
        data[a / 8] ^= (uint8_t)(1u << a % 8);
        hashes[count++] = core_hash(data, sizeof data, 0);
        for (size_t b = a + 1; b < BITS; ++b) {
            data[b / 8] ^= (uint8_t)(1u << b % 8);
            hashes[count++] = core_hash(data, sizeof data, 0);
            data[b / 8] ^= (uint8_t)(1u << b % 8);
        }
        data[a / 8] ^= (uint8_t)(1u << a % 8);
    }
    TEST_ASSERT_TRUE(count > 690000 && count <= capacity);
    TEST_ASSERT_EQUAL_UINT64(0, collisions(hashes, count));
    free(hashes);
}

// Zeros of every length, and seeds 0.. on one text.
static void lengths_and_seeds_count(void) {
    static uint8_t zeros[4096];
    static uint64_t hashes[8192];
    for (size_t i = 0; i < 4096; ++i) {
        hashes[i] = core_hash(zeros, i, 0);
        hashes[4096 + i] = core_hash("text", 4, i);
    }
    TEST_ASSERT_EQUAL_UINT64(0, collisions(hashes, 8192));
}

// Swapping two words of a long input, in any pair of places, changes the hash.
static void order_counts(void) {
    uint64_t words[40], swapped[40];
    for (uint64_t i = 0; i < 40; ++i) {
        words[i] = i * i + 1;
    }
    uint64_t before = core_hash(words, sizeof words, 0);
    for (int a = 0; a < 40; ++a) {
        for (int b = a + 1; b < 40; ++b) {
            memcpy(swapped, words, sizeof words);
            swapped[a] = words[b];
            swapped[b] = words[a];
            TEST_ASSERT_TRUE(core_hash(swapped, sizeof swapped, 0) != before);
        }
    }
}

// Counters fill 2^16 buckets evenly: chi-square of 2^20 hashes, 65535 degrees of freedom, within 5
// standard deviations (362), for the low, middle and high bits.
static void counters_spread_evenly(void) {
    static uint32_t buckets[3][65536];
    for (uint64_t i = 0; i < 1u << 20; ++i) {
        uint64_t h = core_hash(&i, sizeof i, 0);
        buckets[0][h & 0xffff]++;
        buckets[1][h >> 24 & 0xffff]++;
        buckets[2][h >> 48]++;
    }
    for (int k = 0; k < 3; ++k) {
        double chi2 = 0;
        for (int i = 0; i < 65536; ++i) {
            double d = buckets[k][i] - 16.0;
            chi2 += d * d / 16.0;
        }
        TEST_ASSERT_DOUBLE_WITHIN(5 * 362, 65535, chi2);
    }
}

static void mixing_is_not_symmetric(void) {
    TEST_ASSERT_TRUE(core_hash_mix(1, 2) != core_hash_mix(2, 1));
    TEST_ASSERT_INT_WITHIN(16, 32, popcount(core_hash_mix(0, 0) ^ core_hash_mix(0, 1)));
    TEST_ASSERT_INT_WITHIN(16, 32, popcount(core_hash_mix(0, 0) ^ core_hash_mix(1, 0)));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(values_are_pinned);
    RUN_TEST(alignment_does_not_matter);
    RUN_TEST(any_bit_avalanches);
    RUN_TEST(sparse_inputs_do_not_collide);
    RUN_TEST(lengths_and_seeds_count);
    RUN_TEST(order_counts);
    RUN_TEST(counters_spread_evenly);
    RUN_TEST(mixing_is_not_symmetric);
    return UNITY_END();
}
