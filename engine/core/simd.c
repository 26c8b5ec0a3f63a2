#include "core/simd.h"

#include <stdatomic.h>

// Which kernels run is a property of the process, not of a world: every set gives the same bits.
static atomic_int active_set = -1;

static bool supported(core_simd_set set) {
    switch (set) {
    case CORE_SIMD_SSE2:
        return true; // part of x86-64
    case CORE_SIMD_AVX2:
        return __builtin_cpu_supports("avx2") != 0;
    case CORE_SIMD_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    default:
        return false;
    }
}

core_simd_set core_simd_best(void) {
    __builtin_cpu_init();
    core_simd_set best = CORE_SIMD_SSE2;
    for (int set = CORE_SIMD_SSE2; set < CORE_SIMD_SETS; set++) {
        if (supported((core_simd_set)set)) {
            best = (core_simd_set)set;
        }
    }
    return best;
}

bool core_simd_use(core_simd_set set) {
    __builtin_cpu_init();
    if ((int)set < 0 || set >= CORE_SIMD_SETS) {
        return core_fail("core_simd_use: no instruction set number %d, expected 0..%d", (int)set,
                         CORE_SIMD_SETS - 1);
    }
    if (!supported(set)) {
        return core_fail("this processor lacks the instruction set %s; its best is %s",
                         core_simd_name(set), core_simd_name(core_simd_best()));
    }
    atomic_store_explicit(&active_set, (int)set, memory_order_relaxed);
    return true;
}

core_simd_set core_simd_active(void) {
    int set = atomic_load_explicit(&active_set, memory_order_relaxed);
    if (set < 0) {
        set = (int)core_simd_best();
        atomic_store_explicit(&active_set, set, memory_order_relaxed);
    }
    return (core_simd_set)set;
}

const char *core_simd_name(core_simd_set set) {
    static const char *const names[CORE_SIMD_SETS] = {"sse2", "avx2", "avx512"};
    return (int)set >= 0 && set < CORE_SIMD_SETS ? names[set] : "unknown";
}
