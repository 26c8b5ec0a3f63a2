// Eight independent lanes take one 64-bit word each per 64-byte stripe; a lane's round is a folded
// multiply: lane = lo ^ hi of the 128-bit product (lane ^ word) * odd constant. The high half
// carries every input bit down as well as up, so no sparse difference of two words cancels (a plain
// 64-bit multiply leaves a flipped top bit alone). Idea of the folded product: Makarov, "MUM hash"
// (2016), after the NH family of UMAC (Black, Halevi, Krawczyk, Krovetz, Rogaway 1999). Not meant
// against an adversary who knows the constants.
#include "core/hash.h"

#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "words are read as they lie in memory");

#define LANES        8
#define STRIPE_BYTES (LANES * sizeof(uint64_t))

// Odd, without pattern: fractional parts of square roots of primes (2, 3, 5, ...), last bit set.
static const uint64_t lane_factor[LANES] = {
    0x6a09e667f3bcc909u, 0xbb67ae8584caa73bu, 0x3c6ef372fe94f82bu, 0xa54ff53a5f1d36f1u,
    0x510e527fade682d1u, 0x9b05688c2b3e6c1fu, 0x1f83d9abfb41bd6bu, 0x5be0cd19137e2179u,
};

__extension__ typedef unsigned __int128 wide;

static inline uint64_t fold(uint64_t a, uint64_t b) {
    wide product = (wide)a * b;
    return (uint64_t)product ^ (uint64_t)(product >> 64);
}

static inline uint64_t load_word(const uint8_t *at) {
    uint64_t word;
    memcpy(&word, at, sizeof word);
    return word;
}

static const uint8_t *hash_stripes(const uint8_t *at, size_t stripes, uint64_t *state) {
    uint64_t lane[LANES];
    for (int i = 0; i < LANES; ++i) {
        lane[i] = *state + lane_factor[i];
    }
    for (; stripes; --stripes, at += STRIPE_BYTES) {
        for (int i = 0; i < LANES; ++i) {
            lane[i] = fold(lane[i] ^ load_word(at + (size_t)i * 8), lane_factor[i]);
        }
    }
    for (int i = 0; i < LANES; ++i) {
        *state = fold(*state ^ lane[i], lane_factor[LANES - 1 - i]);
    }
    return at;
}

uint64_t core_hash(const void *data, size_t bytes, uint64_t seed) {
    const uint8_t *at = data;
    // The length goes in first: texts that differ in trailing zeros only differ here.
    uint64_t state = core_hash_mix(seed, bytes);
    size_t rest = bytes;
    if (rest >= STRIPE_BYTES) {
        at = hash_stripes(at, rest / STRIPE_BYTES, &state);
        rest %= STRIPE_BYTES;
    }
    for (; rest >= 8; rest -= 8, at += 8) {
        state = fold(state ^ load_word(at), lane_factor[0]);
    }
    if (rest) {
        uint64_t word = 0;
        memcpy(&word, at, rest);
        state = fold(state ^ word, lane_factor[1]);
    }
    return core_hash_mix(state, seed);
}

uint64_t core_hash_string(const char *text) { return core_hash(text, strlen(text), 0); }
