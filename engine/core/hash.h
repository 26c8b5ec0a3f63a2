// 64-bit hashing of bytes: same value on every platform and instruction set (little-endian reads).
#ifndef CORE_HASH_H
#define CORE_HASH_H

#include "core/base.h"

uint64_t core_hash(const void *data, size_t bytes, uint64_t seed);
static inline uint64_t core_hash_mix(uint64_t a, uint64_t b) {
    // Finaliser of splitmix64 (Steele, Lea, Flood 2014) over the combined words.
    uint64_t x = a ^ (b + 0x9e3779b97f4a7c15u + (a << 6) + (a >> 2));
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}
uint64_t core_hash_string(const char *text);

#endif
