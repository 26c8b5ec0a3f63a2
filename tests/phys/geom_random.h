// Random geometry with fixed seeds for the geometry tests.
#ifndef TESTS_PHYS_GEOM_RANDOM_H
#define TESTS_PHYS_GEOM_RANDOM_H

#include "core/math.h"

static uint64_t random_state = 1;

static inline void random_seed(uint64_t seed) { random_state = seed; }
static inline float random_unit(void) { // [0, 1)
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (float)(random_state >> 40) / 16777216.0f;
}
static inline float random_sym(float a) { return (2.0f * random_unit() - 1.0f) * a; }
static inline core_vec3 random_vec(float a) {
    float x = random_sym(a), y = random_sym(a), z = random_sym(a);
    return core_v3(x, y, z);
}
static inline core_quat random_quat(void) {
    core_quat q = {random_sym(1), random_sym(1), random_sym(1), random_sym(1)};
    return core_quat_normalize(q);
}
static inline float distance(core_vec3 a, core_vec3 b) { return core_v3_length(core_v3_sub(a, b)); }

#endif
