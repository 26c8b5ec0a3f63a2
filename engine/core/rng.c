// Philox-2x64 with ten rounds: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as
// 1, 2, 3", SC 2011, section 4. The seed is the key, (counter, stream) the block: the map of blocks
// is a bijection for each seed, so no two streams can overlap.
#include "core/rng.h"

#define PHILOX_ROUNDS     10
#define PHILOX_MULTIPLIER 0xd2b74407b1ce6e93u
#define PHILOX_KEY_STEP   0x9e3779b97f4a7c15u

__extension__ typedef unsigned __int128 wide;

core_rng core_rng_make(uint64_t seed, uint64_t stream) {
    return (core_rng){.seed = seed, .stream = stream};
}

uint64_t core_rng_at(uint64_t seed, uint64_t stream, uint64_t index) {
    uint64_t left = index, right = stream, key = seed;
    for (int round = 0; round < PHILOX_ROUNDS; ++round) {
        wide product = (wide)left * PHILOX_MULTIPLIER;
        left = (uint64_t)(product >> 64) ^ key ^ right;
        right = (uint64_t)product;
        key += PHILOX_KEY_STEP;
    }
    return left;
}

uint64_t core_rng_u64(core_rng *rng) { return core_rng_at(rng->seed, rng->stream, rng->counter++); }

double core_rng_double(core_rng *rng) { return (double)(core_rng_u64(rng) >> 11) * 0x1p-53; }
float core_rng_float(core_rng *rng) { return (float)(core_rng_u64(rng) >> 40) * 0x1p-24f; }

// Lemire, "Fast random integer generation in an interval", ACM TOMACS 2019: the high half of
// value * n, where the few values that would favour some results are drawn again.
uint32_t core_rng_below(core_rng *rng, uint32_t n) {
    CORE_ASSERT(n > 0);
    uint64_t product = (core_rng_u64(rng) >> 32) * n;
    if ((uint32_t)product < n) {
        uint32_t reject_below = n ? (0u - n) % n : 0;
        while ((uint32_t)product < reject_below) {
            product = (core_rng_u64(rng) >> 32) * n;
        }
    }
    return (uint32_t)(product >> 32);
}
