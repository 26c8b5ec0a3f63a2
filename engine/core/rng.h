// Counter-based random numbers: value i of a stream is a pure function of (seed, stream, i), so
// results do not depend on who asked first, and state is one counter to save.
#ifndef CORE_RNG_H
#define CORE_RNG_H

#include "core/base.h"

typedef struct core_rng {
    uint64_t seed, stream, counter;
} core_rng;

// Streams in use, so that scene setup, simulation, and presentation never disturb one another.
enum { CORE_RNG_SIM = 1, CORE_RNG_VIEW = 2, CORE_RNG_ENGINE = 3, CORE_RNG_MOD = 16 };

core_rng core_rng_make(uint64_t seed, uint64_t stream);
// Value `index` of a stream, without state.
uint64_t core_rng_at(uint64_t seed, uint64_t stream, uint64_t index);
uint64_t core_rng_u64(core_rng *rng);
double core_rng_double(core_rng *rng);              // [0, 1), 53 bits
float core_rng_float(core_rng *rng);                // [0, 1), 24 bits
uint32_t core_rng_below(core_rng *rng, uint32_t n); // unbiased, n > 0

#endif
