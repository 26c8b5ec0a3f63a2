// The hash against finer sieves than the everyday test: bias of every pair (input bit, output bit)
// and collisions among many millions of close inputs.
#include <stdlib.h>
#include <string.h>

#include "core/hash.h"
#include "core/rng.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

// 20,000 trials: 5.7 standard deviations are 0.02.
static void expect_avalanche(size_t bytes) {
    enum { TRIALS = 20000 };
    core_rng rng = core_rng_make(bytes, 2);
    uint8_t data[256];
    for (size_t bit = 0; bit < bytes * 8; bit += 1 + bytes / 16) {
        int flips[64] = {0};
        for (int trial = 0; trial < TRIALS; ++trial) {
            for (size_t i = 0; i < bytes; i += 8) {
                uint64_t word = core_rng_u64(&rng);
                memcpy(data + i, &word, 8);
            }
            uint64_t before = core_hash(data, bytes, 0);
            data[bit / 8] ^= (uint8_t)(1u << bit % 8);
            uint64_t changed = before ^ core_hash(data, bytes, 0);
            for (int out = 0; out < 64; ++out) {
                flips[out] += changed >> out & 1;
            }
        }
        for (int out = 0; out < 64; ++out) {
            double p = (double)flips[out] / TRIALS;
            TEST_ASSERT_TRUE_MESSAGE(p > 0.48 && p < 0.52, "biased output bit");
        }
    }
}

static void any_bit_avalanches(void) {
    static const size_t lengths[] = {8, 24, 64, 80, 136, 200};
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

// 4 million states of a column of floats that differ in one or two values by a few units in the
// last place: what two diverging simulations look like.
static void close_states_do_not_collide(void) {
    enum { FLOATS = 64, STATES = 1 << 22 };
    uint64_t *hashes = malloc(STATES * sizeof *hashes);
    float base[FLOATS];
    for (int i = 0; i < FLOATS; ++i) {
        base[i] = 0.1f * (float)i - 2.0f;
    }
    for (uint32_t k = 0; k < STATES; ++k) {
        uint32_t state[FLOATS];
        memcpy(state, base, sizeof state);
        state[k % FLOATS] += 1 + k / FLOATS % 64;
        state[(k / FLOATS / 64 + k) % FLOATS] ^= (k / FLOATS / 64) << 8;
        uint32_t unique = k; // states may repeat: make each its own
        state[63] ^= unique << 9;
        hashes[k] = core_hash(state, sizeof state, 0);
    }
    size_t same = collisions(hashes, STATES);
    TEST_ASSERT_EQUAL_UINT64(0, same);
    free(hashes);
}

// 8 million counters: no two 64-bit hashes alike, and upper 32 bits alike as often as chance has
// it: n^2 / 2^33 = 8192 pairs, within 5 standard deviations (453).
static void counters_collide_like_chance(void) {
    enum { N = 1 << 23 };
    uint64_t *hashes = malloc(N * sizeof *hashes);
    for (uint64_t i = 0; i < N; ++i) {
        hashes[i] = core_hash(&i, sizeof i, 0);
    }
    TEST_ASSERT_EQUAL_UINT64(0, collisions(hashes, N));
    for (size_t i = 0; i < N; ++i) {
        hashes[i] >>= 32;
    }
    TEST_ASSERT_DOUBLE_WITHIN(453, 8192 - 5, (double)collisions(hashes, N));
    free(hashes);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(any_bit_avalanches);
    RUN_TEST(close_states_do_not_collide);
    RUN_TEST(counters_collide_like_chance);
    return UNITY_END();
}
