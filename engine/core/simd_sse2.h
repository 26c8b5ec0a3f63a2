// core/simd_ops.h on SSE2 alone, the floor of x86-64: what later sets have as one instruction
// (blend, round, 32-bit multiply, gather, masked store) is built here with equal results.
#ifndef CORE_SIMD_SSE2_H
#define CORE_SIMD_SSE2_H

typedef __m128 vf;
typedef __m128i vi;
typedef struct vm {
    __m128 v; // all ones or all zeros a lane
} vm;

static inline vi vi_bits(vf a) { return _mm_castps_si128(a); }
static inline vf vf_from_bits(vi a) { return _mm_castsi128_ps(a); }
static inline vm vm_make_(vf v) { return (vm){v}; }

static inline vf vf_load(const float *p) { return _mm_load_ps(p); }
static inline vf vf_loadu(const float *p) { return _mm_loadu_ps(p); }
static inline void vf_store(float *p, vf a) { _mm_store_ps(p, a); }
static inline void vf_storeu(float *p, vf a) { _mm_storeu_ps(p, a); }
static inline vi vi_load(const int32_t *p) { return _mm_load_si128((const __m128i *)p); }
static inline vi vi_loadu(const int32_t *p) { return _mm_loadu_si128((const __m128i *)p); }
static inline void vi_store(int32_t *p, vi a) { _mm_store_si128((__m128i *)p, a); }
static inline void vi_storeu(int32_t *p, vi a) { _mm_storeu_si128((__m128i *)p, a); }

static inline vf vf_set1(float x) { return _mm_set1_ps(x); }
static inline vi vi_set1(int32_t x) { return _mm_set1_epi32(x); }
static inline vf vf_zero(void) { return _mm_setzero_ps(); }
static inline vi vi_zero(void) { return _mm_setzero_si128(); }
static inline vi vi_iota(void) { return _mm_setr_epi32(0, 1, 2, 3); }

static inline vm vm_and(vm a, vm b) { return vm_make_(_mm_and_ps(a.v, b.v)); }
static inline vm vm_or(vm a, vm b) { return vm_make_(_mm_or_ps(a.v, b.v)); }
static inline vm vm_xor(vm a, vm b) { return vm_make_(_mm_xor_ps(a.v, b.v)); }
static inline vm vm_andnot(vm a, vm b) { return vm_make_(_mm_andnot_ps(b.v, a.v)); }
static inline vm vm_not(vm a) {
    return vm_make_(_mm_xor_ps(a.v, _mm_castsi128_ps(_mm_set1_epi32(-1))));
}
static inline uint32_t vm_bits(vm m) { return (uint32_t)_mm_movemask_ps(m.v); }
static inline vm vm_from_bits(uint32_t bits) {
    const __m128i lane = _mm_setr_epi32(1, 2, 4, 8);
    __m128i on = _mm_and_si128(_mm_set1_epi32((int)bits), lane);
    return vm_make_(_mm_castsi128_ps(_mm_cmpeq_epi32(on, lane)));
}
static inline vf vf_select(vm m, vf a, vf b) {
    return _mm_or_ps(_mm_and_ps(m.v, a), _mm_andnot_ps(m.v, b));
}
static inline vi vi_select(vm m, vi a, vi b) {
    return vi_bits(vf_select(m, vf_from_bits(a), vf_from_bits(b)));
}
static inline vf vf_keep(vm m, vf a) { return _mm_and_ps(m.v, a); }
static inline vi vi_keep(vm m, vi a) { return _mm_and_si128(vi_bits(m.v), a); }

static inline vi vi_gather(const int32_t *base, vi index) {
    int32_t i[4];
    vi_storeu(i, index);
    return _mm_setr_epi32(base[i[0]], base[i[1]], base[i[2]], base[i[3]]);
}
static inline vf vf_gather(const float *base, vi index) {
    int32_t i[4];
    vi_storeu(i, index);
    return _mm_setr_ps(base[i[0]], base[i[1]], base[i[2]], base[i[3]]);
}
static inline vi vi_gather_mask(vm m, const int32_t *base, vi index) {
    int32_t i[4], out[4] = {0};
    vi_storeu(i, index);
    for (uint32_t bits = vm_bits(m); bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        out[lane] = base[i[lane]];
    }
    return vi_loadu(out);
}
static inline vf vf_gather_mask(vm m, const float *base, vi index) {
    int32_t i[4];
    float out[4] = {0};
    vi_storeu(i, index);
    for (uint32_t bits = vm_bits(m); bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        out[lane] = base[i[lane]];
    }
    return vf_loadu(out);
}
static inline void vi_scatter_mask(vm m, int32_t *base, vi index, vi a) {
    int32_t i[4], in[4];
    vi_storeu(i, index);
    vi_storeu(in, a);
    for (uint32_t bits = vm_bits(m); bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        base[i[lane]] = in[lane];
    }
}
static inline void vf_scatter_mask(vm m, float *base, vi index, vf a) {
    int32_t i[4];
    float in[4];
    vi_storeu(i, index);
    vf_storeu(in, a);
    for (uint32_t bits = vm_bits(m); bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        base[i[lane]] = in[lane];
    }
}
static inline vf vf_load_mask(const float *p, vm m) { return vf_gather_mask(m, p, vi_iota()); }
static inline vi vi_load_mask(const int32_t *p, vm m) { return vi_gather_mask(m, p, vi_iota()); }
static inline void vf_store_mask(float *p, vm m, vf a) { vf_scatter_mask(m, p, vi_iota(), a); }
static inline void vi_store_mask(int32_t *p, vm m, vi a) { vi_scatter_mask(m, p, vi_iota(), a); }

static inline vf vf_add(vf a, vf b) { return _mm_add_ps(a, b); }
static inline vf vf_sub(vf a, vf b) { return _mm_sub_ps(a, b); }
static inline vf vf_mul(vf a, vf b) { return _mm_mul_ps(a, b); }
static inline vf vf_div(vf a, vf b) { return _mm_div_ps(a, b); }
static inline vf vf_sqrt(vf a) { return _mm_sqrt_ps(a); }
static inline vf vf_min(vf a, vf b) { return _mm_min_ps(a, b); }
static inline vf vf_max(vf a, vf b) { return _mm_max_ps(a, b); }

static inline vm vf_lt(vf a, vf b) { return vm_make_(_mm_cmplt_ps(a, b)); }
static inline vm vf_le(vf a, vf b) { return vm_make_(_mm_cmple_ps(a, b)); }
static inline vm vf_gt(vf a, vf b) { return vm_make_(_mm_cmplt_ps(b, a)); }
static inline vm vf_ge(vf a, vf b) { return vm_make_(_mm_cmple_ps(b, a)); }
static inline vm vf_eq(vf a, vf b) { return vm_make_(_mm_cmpeq_ps(a, b)); }
static inline vm vf_ne(vf a, vf b) { return vm_make_(_mm_cmpneq_ps(a, b)); }
static inline vm vi_eq(vi a, vi b) { return vm_make_(vf_from_bits(_mm_cmpeq_epi32(a, b))); }
static inline vm vi_lt(vi a, vi b) { return vm_make_(vf_from_bits(_mm_cmplt_epi32(a, b))); }
static inline vm vi_gt(vi a, vi b) { return vm_make_(vf_from_bits(_mm_cmpgt_epi32(a, b))); }

static inline vi vi_add(vi a, vi b) { return _mm_add_epi32(a, b); }
static inline vi vi_sub(vi a, vi b) { return _mm_sub_epi32(a, b); }
static inline vi vi_mul(vi a, vi b) {
    // The low halves of unsigned products are those of signed ones: even lanes, then odd lanes.
    __m128i even = _mm_mul_epu32(a, b);
    __m128i odd = _mm_mul_epu32(_mm_srli_epi64(a, 32), _mm_srli_epi64(b, 32));
    return _mm_unpacklo_epi32(_mm_shuffle_epi32(even, _MM_SHUFFLE(0, 0, 2, 0)),
                              _mm_shuffle_epi32(odd, _MM_SHUFFLE(0, 0, 2, 0)));
}
static inline vi vi_min(vi a, vi b) { return vi_select(vi_lt(a, b), a, b); }
static inline vi vi_max(vi a, vi b) { return vi_select(vi_gt(a, b), a, b); }
static inline vi vi_and(vi a, vi b) { return _mm_and_si128(a, b); }
static inline vi vi_or(vi a, vi b) { return _mm_or_si128(a, b); }
static inline vi vi_xor(vi a, vi b) { return _mm_xor_si128(a, b); }
static inline vi vi_andnot(vi a, vi b) { return _mm_andnot_si128(b, a); }
static inline vi vi_shl(vi a, int n) { return _mm_sll_epi32(a, _mm_cvtsi32_si128(n)); }
static inline vi vi_shr(vi a, int n) { return _mm_srl_epi32(a, _mm_cvtsi32_si128(n)); }
static inline vi vi_sar(vi a, int n) { return _mm_sra_epi32(a, _mm_cvtsi32_si128(n)); }

static inline vf vf_from_i(vi a) { return _mm_cvtepi32_ps(a); }
static inline vi vi_round(vf a) { return _mm_cvtps_epi32(a); }
static inline vi vi_trunc(vf a) { return _mm_cvttps_epi32(a); }

// Puts the sign of a on `whole` (keeps -0) and leaves values alone that are whole by size.
static inline vf vf_whole_(vf a, vf whole) {
    const __m128 sign = _mm_set1_ps(-0.0f);
    vm small = vf_lt(_mm_andnot_ps(sign, a), _mm_set1_ps(8388608.0f));
    whole = _mm_or_ps(whole, _mm_and_ps(sign, a));
    return vf_select(small, whole, _mm_add_ps(a, _mm_setzero_ps()));
}
static inline vf vf_round(vf a) { return vf_whole_(a, vf_from_i(vi_round(a))); }
static inline vf vf_floor(vf a) {
    vf whole = vf_from_i(vi_trunc(a));
    whole = _mm_sub_ps(whole, _mm_and_ps(_mm_cmplt_ps(a, whole), _mm_set1_ps(1.0f)));
    return vf_whole_(a, whole);
}

#endif
