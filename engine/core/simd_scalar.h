// One lane of core/simd_ops.h on plain floats: the meaning of every operation, and the form from
// which core/math_float.c compiles its functions.
#ifndef CORE_SIMD_SCALAR_H
#define CORE_SIMD_SCALAR_H

#include <string.h>

typedef float vf;
typedef int32_t vi;
typedef struct vm {
    bool on;
} vm;

static inline vi vi_bits(vf a) {
    vi bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}
static inline vf vf_from_bits(vi a) {
    vf value;
    memcpy(&value, &a, sizeof value);
    return value;
}

static inline vf vf_load(const float *p) { return *p; }
static inline vf vf_loadu(const float *p) { return *p; }
static inline void vf_store(float *p, vf a) { *p = a; }
static inline void vf_storeu(float *p, vf a) { *p = a; }
static inline vi vi_load(const int32_t *p) { return *p; }
static inline vi vi_loadu(const int32_t *p) { return *p; }
static inline void vi_store(int32_t *p, vi a) { *p = a; }
static inline void vi_storeu(int32_t *p, vi a) { *p = a; }
static inline vf vf_load_mask(const float *p, vm m) { return m.on ? *p : 0.0f; }
static inline vi vi_load_mask(const int32_t *p, vm m) { return m.on ? *p : 0; }
static inline void vf_store_mask(float *p, vm m, vf a) {
    if (m.on) {
        *p = a;
    }
}
static inline void vi_store_mask(int32_t *p, vm m, vi a) {
    if (m.on) {
        *p = a;
    }
}
static inline vf vf_gather(const float *base, vi index) { return base[index]; }
static inline vi vi_gather(const int32_t *base, vi index) { return base[index]; }
static inline vf vf_gather_mask(vm m, const float *base, vi index) {
    return m.on ? base[index] : 0.0f;
}
static inline vi vi_gather_mask(vm m, const int32_t *base, vi index) {
    return m.on ? base[index] : 0;
}
static inline void vf_scatter_mask(vm m, float *base, vi index, vf a) {
    if (m.on) {
        base[index] = a;
    }
}
static inline void vi_scatter_mask(vm m, int32_t *base, vi index, vi a) {
    if (m.on) {
        base[index] = a;
    }
}

static inline vf vf_set1(float x) { return x; }
static inline vi vi_set1(int32_t x) { return x; }
static inline vf vf_zero(void) { return 0.0f; }
static inline vi vi_zero(void) { return 0; }
static inline vi vi_iota(void) { return 0; }

static inline vf vf_add(vf a, vf b) { return a + b; }
static inline vf vf_sub(vf a, vf b) { return a - b; }
static inline vf vf_mul(vf a, vf b) { return a * b; }
static inline vf vf_div(vf a, vf b) { return a / b; }
static inline vf vf_sqrt(vf a) { return __builtin_sqrtf(a); }
static inline vf vf_min(vf a, vf b) { return a < b ? a : b; }
static inline vf vf_max(vf a, vf b) { return a > b ? a : b; }

static inline vm vf_lt(vf a, vf b) { return (vm){a < b}; }
static inline vm vf_le(vf a, vf b) { return (vm){a <= b}; }
static inline vm vf_gt(vf a, vf b) { return (vm){a > b}; }
static inline vm vf_ge(vf a, vf b) { return (vm){a >= b}; }
static inline vm vf_eq(vf a, vf b) { return (vm){a == b}; }
static inline vm vf_ne(vf a, vf b) { return (vm){a != b}; }
static inline vm vi_eq(vi a, vi b) { return (vm){a == b}; }
static inline vm vi_lt(vi a, vi b) { return (vm){a < b}; }
static inline vm vi_gt(vi a, vi b) { return (vm){a > b}; }

static inline vm vm_and(vm a, vm b) { return (vm){a.on && b.on}; }
static inline vm vm_or(vm a, vm b) { return (vm){a.on || b.on}; }
static inline vm vm_xor(vm a, vm b) { return (vm){a.on != b.on}; }
static inline vm vm_andnot(vm a, vm b) { return (vm){a.on && !b.on}; }
static inline vm vm_not(vm a) { return (vm){!a.on}; }
static inline uint32_t vm_bits(vm m) { return m.on ? 1u : 0u; }
static inline vm vm_from_bits(uint32_t bits) { return (vm){(bits & 1u) != 0}; }
static inline vf vf_select(vm m, vf a, vf b) { return m.on ? a : b; }
static inline vi vi_select(vm m, vi a, vi b) { return m.on ? a : b; }
static inline vf vf_keep(vm m, vf a) { return m.on ? a : 0.0f; }
static inline vi vi_keep(vm m, vi a) { return m.on ? a : 0; }

static inline vi vi_add(vi a, vi b) { return (vi)((uint32_t)a + (uint32_t)b); }
static inline vi vi_sub(vi a, vi b) { return (vi)((uint32_t)a - (uint32_t)b); }
static inline vi vi_mul(vi a, vi b) { return (vi)((uint32_t)a * (uint32_t)b); }
static inline vi vi_min(vi a, vi b) { return a < b ? a : b; }
static inline vi vi_max(vi a, vi b) { return a > b ? a : b; }
static inline vi vi_and(vi a, vi b) { return a & b; }
static inline vi vi_or(vi a, vi b) { return a | b; }
static inline vi vi_xor(vi a, vi b) { return a ^ b; }
static inline vi vi_andnot(vi a, vi b) { return a & ~b; }
static inline vi vi_shl(vi a, int n) { return (vi)((uint32_t)a << n); }
static inline vi vi_shr(vi a, int n) { return (vi)((uint32_t)a >> n); }
static inline vi vi_sar(vi a, int n) { return a >> n; }

static inline vf vf_from_i(vi a) { return (float)a; }
// The conversion instructions themselves: C leaves values outside int32 undefined.
static inline vi vi_round(vf a) { return _mm_cvtss_si32(_mm_set_ss(a)); }
static inline vi vi_trunc(vf a) { return _mm_cvttss_si32(_mm_set_ss(a)); }
static inline vf vf_round(vf a) {
    float magnitude = a < 0.0f ? -a : a;
    if (!(magnitude < 8388608.0f)) {
        return a + 0.0f; // already whole, infinite or NaN
    }
    float whole = (float)vi_round(a);
    return vf_from_bits(vi_bits(whole) | (vi_bits(a) & INT32_MIN)); // keeps -0
}
static inline vf vf_floor(vf a) {
    float magnitude = a < 0.0f ? -a : a;
    if (!(magnitude < 8388608.0f)) {
        return a + 0.0f;
    }
    float whole = (float)vi_trunc(a);
    whole = whole > a ? whole - 1.0f : whole;
    return vf_from_bits(vi_bits(whole) | (vi_bits(a) & INT32_MIN));
}

#endif
