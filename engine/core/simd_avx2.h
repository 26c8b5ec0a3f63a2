// core/simd_ops.h on AVX2, 8 lanes. No FMA: its results differ from a multiply and an add.
#ifndef CORE_SIMD_AVX2_H
#define CORE_SIMD_AVX2_H

typedef __m256 vf;
typedef __m256i vi;
typedef struct vm {
    __m256 v; // all ones or all zeros a lane
} vm;

static inline vi vi_bits(vf a) { return _mm256_castps_si256(a); }
static inline vf vf_from_bits(vi a) { return _mm256_castsi256_ps(a); }
static inline vm vm_make_(vf v) { return (vm){v}; }

static inline vf vf_load(const float *p) { return _mm256_load_ps(p); }
static inline vf vf_loadu(const float *p) { return _mm256_loadu_ps(p); }
static inline void vf_store(float *p, vf a) { _mm256_store_ps(p, a); }
static inline void vf_storeu(float *p, vf a) { _mm256_storeu_ps(p, a); }
static inline vi vi_load(const int32_t *p) { return _mm256_load_si256((const __m256i *)p); }
static inline vi vi_loadu(const int32_t *p) { return _mm256_loadu_si256((const __m256i *)p); }
static inline void vi_store(int32_t *p, vi a) { _mm256_store_si256((__m256i *)p, a); }
static inline void vi_storeu(int32_t *p, vi a) { _mm256_storeu_si256((__m256i *)p, a); }

static inline vf vf_set1(float x) { return _mm256_set1_ps(x); }
static inline vi vi_set1(int32_t x) { return _mm256_set1_epi32(x); }
static inline vf vf_zero(void) { return _mm256_setzero_ps(); }
static inline vi vi_zero(void) { return _mm256_setzero_si256(); }
static inline vi vi_iota(void) { return _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7); }

static inline vm vm_and(vm a, vm b) { return vm_make_(_mm256_and_ps(a.v, b.v)); }
static inline vm vm_or(vm a, vm b) { return vm_make_(_mm256_or_ps(a.v, b.v)); }
static inline vm vm_xor(vm a, vm b) { return vm_make_(_mm256_xor_ps(a.v, b.v)); }
static inline vm vm_andnot(vm a, vm b) { return vm_make_(_mm256_andnot_ps(b.v, a.v)); }
static inline vm vm_not(vm a) {
    return vm_make_(_mm256_xor_ps(a.v, _mm256_castsi256_ps(_mm256_set1_epi32(-1))));
}
static inline uint32_t vm_bits(vm m) { return (uint32_t)_mm256_movemask_ps(m.v); }
static inline vm vm_from_bits(uint32_t bits) {
    const __m256i lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    __m256i on = _mm256_and_si256(_mm256_set1_epi32((int)bits), lane);
    return vm_make_(_mm256_castsi256_ps(_mm256_cmpeq_epi32(on, lane)));
}
static inline vf vf_select(vm m, vf a, vf b) { return _mm256_blendv_ps(b, a, m.v); }
static inline vi vi_select(vm m, vi a, vi b) { return _mm256_blendv_epi8(b, a, vi_bits(m.v)); }
static inline vf vf_keep(vm m, vf a) { return _mm256_and_ps(m.v, a); }
static inline vi vi_keep(vm m, vi a) { return _mm256_and_si256(vi_bits(m.v), a); }

static inline vf vf_gather(const float *base, vi index) {
    return _mm256_i32gather_ps(base, index, 4);
}
static inline vi vi_gather(const int32_t *base, vi index) {
    return _mm256_i32gather_epi32(base, index, 4);
}
static inline vf vf_gather_mask(vm m, const float *base, vi index) {
    return _mm256_mask_i32gather_ps(vf_zero(), base, index, m.v, 4);
}
static inline vi vi_gather_mask(vm m, const int32_t *base, vi index) {
    return _mm256_mask_i32gather_epi32(vi_zero(), base, index, vi_bits(m.v), 4);
}
static inline void vi_scatter_mask(vm m, int32_t *base, vi index, vi a) {
    int32_t i[8], in[8];
    vi_storeu(i, index);
    vi_storeu(in, a);
    for (uint32_t bits = vm_bits(m); bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        base[i[lane]] = in[lane];
    }
}
static inline void vf_scatter_mask(vm m, float *base, vi index, vf a) {
    int32_t i[8];
    float in[8];
    vi_storeu(i, index);
    vf_storeu(in, a);
    for (uint32_t bits = vm_bits(m); bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        base[i[lane]] = in[lane];
    }
}
static inline vf vf_load_mask(const float *p, vm m) { return _mm256_maskload_ps(p, vi_bits(m.v)); }
static inline vi vi_load_mask(const int32_t *p, vm m) {
    return _mm256_maskload_epi32(p, vi_bits(m.v));
}
static inline void vf_store_mask(float *p, vm m, vf a) { _mm256_maskstore_ps(p, vi_bits(m.v), a); }
static inline void vi_store_mask(int32_t *p, vm m, vi a) {
    _mm256_maskstore_epi32(p, vi_bits(m.v), a);
}

static inline vf vf_add(vf a, vf b) { return _mm256_add_ps(a, b); }
static inline vf vf_sub(vf a, vf b) { return _mm256_sub_ps(a, b); }
static inline vf vf_mul(vf a, vf b) { return _mm256_mul_ps(a, b); }
static inline vf vf_div(vf a, vf b) { return _mm256_div_ps(a, b); }
static inline vf vf_sqrt(vf a) { return _mm256_sqrt_ps(a); }
static inline vf vf_min(vf a, vf b) { return _mm256_min_ps(a, b); }
static inline vf vf_max(vf a, vf b) { return _mm256_max_ps(a, b); }
static inline vf vf_round(vf a) {
    return _mm256_round_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
static inline vf vf_floor(vf a) {
    return _mm256_round_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}

static inline vm vf_lt(vf a, vf b) { return vm_make_(_mm256_cmp_ps(a, b, _CMP_LT_OQ)); }
static inline vm vf_le(vf a, vf b) { return vm_make_(_mm256_cmp_ps(a, b, _CMP_LE_OQ)); }
static inline vm vf_gt(vf a, vf b) { return vm_make_(_mm256_cmp_ps(a, b, _CMP_GT_OQ)); }
static inline vm vf_ge(vf a, vf b) { return vm_make_(_mm256_cmp_ps(a, b, _CMP_GE_OQ)); }
static inline vm vf_eq(vf a, vf b) { return vm_make_(_mm256_cmp_ps(a, b, _CMP_EQ_OQ)); }
static inline vm vf_ne(vf a, vf b) { return vm_make_(_mm256_cmp_ps(a, b, _CMP_NEQ_UQ)); }
static inline vm vi_eq(vi a, vi b) { return vm_make_(vf_from_bits(_mm256_cmpeq_epi32(a, b))); }
static inline vm vi_lt(vi a, vi b) { return vm_make_(vf_from_bits(_mm256_cmpgt_epi32(b, a))); }
static inline vm vi_gt(vi a, vi b) { return vm_make_(vf_from_bits(_mm256_cmpgt_epi32(a, b))); }

static inline vi vi_add(vi a, vi b) { return _mm256_add_epi32(a, b); }
static inline vi vi_sub(vi a, vi b) { return _mm256_sub_epi32(a, b); }
static inline vi vi_mul(vi a, vi b) { return _mm256_mullo_epi32(a, b); }
static inline vi vi_min(vi a, vi b) { return _mm256_min_epi32(a, b); }
static inline vi vi_max(vi a, vi b) { return _mm256_max_epi32(a, b); }
static inline vi vi_and(vi a, vi b) { return _mm256_and_si256(a, b); }
static inline vi vi_or(vi a, vi b) { return _mm256_or_si256(a, b); }
static inline vi vi_xor(vi a, vi b) { return _mm256_xor_si256(a, b); }
static inline vi vi_andnot(vi a, vi b) { return _mm256_andnot_si256(b, a); }
static inline vi vi_shl(vi a, int n) { return _mm256_sll_epi32(a, _mm_cvtsi32_si128(n)); }
static inline vi vi_shr(vi a, int n) { return _mm256_srl_epi32(a, _mm_cvtsi32_si128(n)); }
static inline vi vi_sar(vi a, int n) { return _mm256_sra_epi32(a, _mm_cvtsi32_si128(n)); }

static inline vf vf_from_i(vi a) { return _mm256_cvtepi32_ps(a); }
static inline vi vi_round(vf a) { return _mm256_cvtps_epi32(a); }
static inline vi vi_trunc(vf a) { return _mm256_cvttps_epi32(a); }

#endif
