// core/simd_ops.h on AVX-512 F/DQ/BW/VL, 16 lanes; masks live in mask registers.
#ifndef CORE_SIMD_AVX512_H
#define CORE_SIMD_AVX512_H

typedef __m512 vf;
typedef __m512i vi;
typedef struct vm {
    __mmask16 v; // bit i: lane i
} vm;

static inline vi vi_bits(vf a) { return _mm512_castps_si512(a); }
static inline vf vf_from_bits(vi a) { return _mm512_castsi512_ps(a); }
static inline vm vm_make_(unsigned bits) { return (vm){(__mmask16)bits}; }

static inline vf vf_load(const float *p) { return _mm512_load_ps(p); }
static inline vf vf_loadu(const float *p) { return _mm512_loadu_ps(p); }
static inline void vf_store(float *p, vf a) { _mm512_store_ps(p, a); }
static inline void vf_storeu(float *p, vf a) { _mm512_storeu_ps(p, a); }
static inline vi vi_load(const int32_t *p) { return _mm512_load_si512(p); }
static inline vi vi_loadu(const int32_t *p) { return _mm512_loadu_si512(p); }
static inline void vi_store(int32_t *p, vi a) { _mm512_store_si512(p, a); }
static inline void vi_storeu(int32_t *p, vi a) { _mm512_storeu_si512(p, a); }

static inline vf vf_set1(float x) { return _mm512_set1_ps(x); }
static inline vi vi_set1(int32_t x) { return _mm512_set1_epi32(x); }
static inline vf vf_zero(void) { return _mm512_setzero_ps(); }
static inline vi vi_zero(void) { return _mm512_setzero_si512(); }
static inline vi vi_iota(void) {
    return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

static inline vm vm_and(vm a, vm b) { return vm_make_((unsigned)a.v & b.v); }
static inline vm vm_or(vm a, vm b) { return vm_make_((unsigned)a.v | b.v); }
static inline vm vm_xor(vm a, vm b) { return vm_make_((unsigned)a.v ^ b.v); }
static inline vm vm_andnot(vm a, vm b) { return vm_make_((unsigned)a.v & ~(unsigned)b.v); }
static inline vm vm_not(vm a) { return vm_make_(~(unsigned)a.v); }
static inline uint32_t vm_bits(vm m) { return m.v; }
static inline vm vm_from_bits(uint32_t bits) { return vm_make_(bits); }
static inline vf vf_select(vm m, vf a, vf b) { return _mm512_mask_blend_ps(m.v, b, a); }
static inline vi vi_select(vm m, vi a, vi b) { return _mm512_mask_blend_epi32(m.v, b, a); }
static inline vf vf_keep(vm m, vf a) { return _mm512_maskz_mov_ps(m.v, a); }
static inline vi vi_keep(vm m, vi a) { return _mm512_maskz_mov_epi32(m.v, a); }

static inline vf vf_gather(const float *base, vi index) {
    return _mm512_i32gather_ps(index, base, 4);
}
static inline vi vi_gather(const int32_t *base, vi index) {
    return _mm512_i32gather_epi32(index, base, 4);
}
static inline vf vf_gather_mask(vm m, const float *base, vi index) {
    return _mm512_mask_i32gather_ps(vf_zero(), m.v, index, base, 4);
}
static inline vi vi_gather_mask(vm m, const int32_t *base, vi index) {
    return _mm512_mask_i32gather_epi32(vi_zero(), m.v, index, base, 4);
}
static inline void vf_scatter_mask(vm m, float *base, vi index, vf a) {
    _mm512_mask_i32scatter_ps(base, m.v, index, a, 4);
}
static inline void vi_scatter_mask(vm m, int32_t *base, vi index, vi a) {
    _mm512_mask_i32scatter_epi32(base, m.v, index, a, 4);
}
static inline vf vf_load_mask(const float *p, vm m) { return _mm512_maskz_loadu_ps(m.v, p); }
static inline vi vi_load_mask(const int32_t *p, vm m) { return _mm512_maskz_loadu_epi32(m.v, p); }
static inline void vf_store_mask(float *p, vm m, vf a) { _mm512_mask_storeu_ps(p, m.v, a); }
static inline void vi_store_mask(int32_t *p, vm m, vi a) { _mm512_mask_storeu_epi32(p, m.v, a); }

static inline vf vf_add(vf a, vf b) { return _mm512_add_ps(a, b); }
static inline vf vf_sub(vf a, vf b) { return _mm512_sub_ps(a, b); }
static inline vf vf_mul(vf a, vf b) { return _mm512_mul_ps(a, b); }
static inline vf vf_div(vf a, vf b) { return _mm512_div_ps(a, b); }
static inline vf vf_sqrt(vf a) { return _mm512_sqrt_ps(a); }
static inline vf vf_min(vf a, vf b) { return _mm512_min_ps(a, b); }
static inline vf vf_max(vf a, vf b) { return _mm512_max_ps(a, b); }
static inline vf vf_round(vf a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
static inline vf vf_floor(vf a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}

static inline vm vf_lt(vf a, vf b) { return vm_make_(_mm512_cmp_ps_mask(a, b, _CMP_LT_OQ)); }
static inline vm vf_le(vf a, vf b) { return vm_make_(_mm512_cmp_ps_mask(a, b, _CMP_LE_OQ)); }
static inline vm vf_gt(vf a, vf b) { return vm_make_(_mm512_cmp_ps_mask(a, b, _CMP_GT_OQ)); }
static inline vm vf_ge(vf a, vf b) { return vm_make_(_mm512_cmp_ps_mask(a, b, _CMP_GE_OQ)); }
static inline vm vf_eq(vf a, vf b) { return vm_make_(_mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ)); }
static inline vm vf_ne(vf a, vf b) { return vm_make_(_mm512_cmp_ps_mask(a, b, _CMP_NEQ_UQ)); }
static inline vm vi_eq(vi a, vi b) { return vm_make_(_mm512_cmpeq_epi32_mask(a, b)); }
static inline vm vi_lt(vi a, vi b) { return vm_make_(_mm512_cmplt_epi32_mask(a, b)); }
static inline vm vi_gt(vi a, vi b) { return vm_make_(_mm512_cmpgt_epi32_mask(a, b)); }

static inline vi vi_add(vi a, vi b) { return _mm512_add_epi32(a, b); }
static inline vi vi_sub(vi a, vi b) { return _mm512_sub_epi32(a, b); }
static inline vi vi_mul(vi a, vi b) { return _mm512_mullo_epi32(a, b); }
static inline vi vi_min(vi a, vi b) { return _mm512_min_epi32(a, b); }
static inline vi vi_max(vi a, vi b) { return _mm512_max_epi32(a, b); }
static inline vi vi_and(vi a, vi b) { return _mm512_and_si512(a, b); }
static inline vi vi_or(vi a, vi b) { return _mm512_or_si512(a, b); }
static inline vi vi_xor(vi a, vi b) { return _mm512_xor_si512(a, b); }
static inline vi vi_andnot(vi a, vi b) { return _mm512_andnot_si512(b, a); }
static inline vi vi_shl(vi a, int n) { return _mm512_sll_epi32(a, _mm_cvtsi32_si128(n)); }
static inline vi vi_shr(vi a, int n) { return _mm512_srl_epi32(a, _mm_cvtsi32_si128(n)); }
static inline vi vi_sar(vi a, int n) { return _mm512_sra_epi32(a, _mm_cvtsi32_si128(n)); }

static inline vf vf_from_i(vi a) { return _mm512_cvtepi32_ps(a); }
static inline vi vi_round(vf a) { return _mm512_cvtps_epi32(a); }
static inline vi vi_trunc(vf a) { return _mm512_cvttps_epi32(a); }

#endif
