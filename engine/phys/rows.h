// Rows of four floats at scattered places, turned into one vector per component and back. Only
// moves bits: results do not depend on the width. For *.simd.c files.
#ifndef PHYS_ROWS_H
#define PHYS_ROWS_H

#include "core/simd.h"

// Vectors in structures are passed in registers only when the call is gone.
#define ROWS_INLINE static inline __attribute__((always_inline))

typedef struct rows3 {
    vf x, y, z;
} rows3;

#if CORE_SIMD_WIDTH == 4
ROWS_INLINE rows3 rows_gather(const float *base, const int32_t *i, int offset) {
    __m128 a = _mm_load_ps(base + (size_t)i[0] * 8 + offset);
    __m128 b = _mm_load_ps(base + (size_t)i[1] * 8 + offset);
    __m128 c = _mm_load_ps(base + (size_t)i[2] * 8 + offset);
    __m128 d = _mm_load_ps(base + (size_t)i[3] * 8 + offset);
    __m128 ab = _mm_unpacklo_ps(a, b), cd = _mm_unpacklo_ps(c, d);
    __m128 ab_z = _mm_unpackhi_ps(a, b), cd_z = _mm_unpackhi_ps(c, d);
    return (rows3){_mm_movelh_ps(ab, cd), _mm_movehl_ps(cd, ab), _mm_movelh_ps(ab_z, cd_z)};
}
ROWS_INLINE void rows_scatter(float *base, const int32_t *i, int offset, rows3 v) {
    __m128 o = _mm_setzero_ps();
    __m128 xy = _mm_unpacklo_ps(v.x, v.y), zo = _mm_unpacklo_ps(v.z, o);
    __m128 xy_h = _mm_unpackhi_ps(v.x, v.y), zo_h = _mm_unpackhi_ps(v.z, o);
    _mm_store_ps(base + (size_t)i[0] * 8 + offset, _mm_movelh_ps(xy, zo));
    _mm_store_ps(base + (size_t)i[1] * 8 + offset, _mm_movehl_ps(zo, xy));
    _mm_store_ps(base + (size_t)i[2] * 8 + offset, _mm_movelh_ps(xy_h, zo_h));
    _mm_store_ps(base + (size_t)i[3] * 8 + offset, _mm_movehl_ps(zo_h, xy_h));
}
#elif CORE_SIMD_WIDTH == 8
ROWS_INLINE __m256 rows_pair_(const float *base, int32_t lo, int32_t hi, int offset) {
    __m256 v = _mm256_castps128_ps256(_mm_load_ps(base + (size_t)lo * 8 + offset));
    return _mm256_insertf128_ps(v, _mm_load_ps(base + (size_t)hi * 8 + offset), 1);
}
ROWS_INLINE void rows_store_pair_(float *base, int32_t lo, int32_t hi, int offset, __m256 v) {
    _mm_store_ps(base + (size_t)lo * 8 + offset, _mm256_castps256_ps128(v));
    _mm_store_ps(base + (size_t)hi * 8 + offset, _mm256_extractf128_ps(v, 1));
}
ROWS_INLINE rows3 rows_gather(const float *base, const int32_t *i, int offset) {
    __m256 a = rows_pair_(base, i[0], i[4], offset), b = rows_pair_(base, i[1], i[5], offset);
    __m256 c = rows_pair_(base, i[2], i[6], offset), d = rows_pair_(base, i[3], i[7], offset);
    __m256 ab = _mm256_unpacklo_ps(a, b), cd = _mm256_unpacklo_ps(c, d);
    __m256 ab_z = _mm256_unpackhi_ps(a, b), cd_z = _mm256_unpackhi_ps(c, d);
    return (rows3){_mm256_shuffle_ps(ab, cd, 0x44), _mm256_shuffle_ps(ab, cd, 0xee),
                   _mm256_shuffle_ps(ab_z, cd_z, 0x44)};
}
ROWS_INLINE void rows_scatter(float *base, const int32_t *i, int offset, rows3 v) {
    __m256 o = _mm256_setzero_ps();
    __m256 xy = _mm256_unpacklo_ps(v.x, v.y), zo = _mm256_unpacklo_ps(v.z, o);
    __m256 xy_h = _mm256_unpackhi_ps(v.x, v.y), zo_h = _mm256_unpackhi_ps(v.z, o);
    rows_store_pair_(base, i[0], i[4], offset, _mm256_shuffle_ps(xy, zo, 0x44));
    rows_store_pair_(base, i[1], i[5], offset, _mm256_shuffle_ps(xy, zo, 0xee));
    rows_store_pair_(base, i[2], i[6], offset, _mm256_shuffle_ps(xy_h, zo_h, 0x44));
    rows_store_pair_(base, i[3], i[7], offset, _mm256_shuffle_ps(xy_h, zo_h, 0xee));
}
#else
ROWS_INLINE __m512 rows_quad_(const float *base, const int32_t *i, int offset) {
    __m512 v = _mm512_castps128_ps512(_mm_load_ps(base + (size_t)i[0] * 8 + offset));
    v = _mm512_insertf32x4(v, _mm_load_ps(base + (size_t)i[4] * 8 + offset), 1);
    v = _mm512_insertf32x4(v, _mm_load_ps(base + (size_t)i[8] * 8 + offset), 2);
    return _mm512_insertf32x4(v, _mm_load_ps(base + (size_t)i[12] * 8 + offset), 3);
}
ROWS_INLINE void rows_store_quad_(float *base, const int32_t *i, int offset, __m512 v) {
    _mm_store_ps(base + (size_t)i[0] * 8 + offset, _mm512_castps512_ps128(v));
    _mm_store_ps(base + (size_t)i[4] * 8 + offset, _mm512_extractf32x4_ps(v, 1));
    _mm_store_ps(base + (size_t)i[8] * 8 + offset, _mm512_extractf32x4_ps(v, 2));
    _mm_store_ps(base + (size_t)i[12] * 8 + offset, _mm512_extractf32x4_ps(v, 3));
}
ROWS_INLINE rows3 rows_gather(const float *base, const int32_t *i, int offset) {
    __m512 a = rows_quad_(base, i, offset), b = rows_quad_(base, i + 1, offset);
    __m512 c = rows_quad_(base, i + 2, offset), d = rows_quad_(base, i + 3, offset);
    __m512 ab = _mm512_unpacklo_ps(a, b), cd = _mm512_unpacklo_ps(c, d);
    __m512 ab_z = _mm512_unpackhi_ps(a, b), cd_z = _mm512_unpackhi_ps(c, d);
    return (rows3){_mm512_shuffle_ps(ab, cd, 0x44), _mm512_shuffle_ps(ab, cd, 0xee),
                   _mm512_shuffle_ps(ab_z, cd_z, 0x44)};
}
ROWS_INLINE void rows_scatter(float *base, const int32_t *i, int offset, rows3 v) {
    __m512 o = _mm512_setzero_ps();
    __m512 xy = _mm512_unpacklo_ps(v.x, v.y), zo = _mm512_unpacklo_ps(v.z, o);
    __m512 xy_h = _mm512_unpackhi_ps(v.x, v.y), zo_h = _mm512_unpackhi_ps(v.z, o);
    rows_store_quad_(base, i, offset, _mm512_shuffle_ps(xy, zo, 0x44));
    rows_store_quad_(base, i + 1, offset, _mm512_shuffle_ps(xy, zo, 0xee));
    rows_store_quad_(base, i + 2, offset, _mm512_shuffle_ps(xy_h, zo_h, 0x44));
    rows_store_quad_(base, i + 3, offset, _mm512_shuffle_ps(xy_h, zo_h, 0xee));
}
#endif

ROWS_INLINE rows3 rows_load(const float *x, const float *y, const float *z) {
    return (rows3){vf_load(x), vf_load(y), vf_load(z)};
}
ROWS_INLINE void rows_store(float *x, float *y, float *z, rows3 v) {
    vf_store(x, v.x);
    vf_store(y, v.y);
    vf_store(z, v.z);
}
ROWS_INLINE rows3 rows_zero(void) { return (rows3){vf_zero(), vf_zero(), vf_zero()}; }
ROWS_INLINE vf rows_dot(rows3 a, rows3 b) {
    return vf_add(vf_add(vf_mul(a.x, b.x), vf_mul(a.y, b.y)), vf_mul(a.z, b.z));
}
ROWS_INLINE rows3 rows_add(rows3 a, rows3 b) {
    return (rows3){vf_add(a.x, b.x), vf_add(a.y, b.y), vf_add(a.z, b.z)};
}
ROWS_INLINE rows3 rows_sub(rows3 a, rows3 b) {
    return (rows3){vf_sub(a.x, b.x), vf_sub(a.y, b.y), vf_sub(a.z, b.z)};
}
ROWS_INLINE rows3 rows_mul(rows3 a, vf s) {
    return (rows3){vf_mul(a.x, s), vf_mul(a.y, s), vf_mul(a.z, s)};
}
ROWS_INLINE rows3 rows_cross(rows3 a, rows3 b) {
    return (rows3){vf_sub(vf_mul(a.y, b.z), vf_mul(a.z, b.y)),
                   vf_sub(vf_mul(a.z, b.x), vf_mul(a.x, b.z)),
                   vf_sub(vf_mul(a.x, b.y), vf_mul(a.y, b.x))};
}
ROWS_INLINE rows3 rows_mad(rows3 a, rows3 b, vf s) { // a + b s
    return (rows3){vf_mad(b.x, s, a.x), vf_mad(b.y, s, a.y), vf_mad(b.z, s, a.z)};
}
ROWS_INLINE rows3 rows_msub(rows3 a, rows3 b, vf s) { // a - b s
    return (rows3){vf_sub(a.x, vf_mul(b.x, s)), vf_sub(a.y, vf_mul(b.y, s)),
                   vf_sub(a.z, vf_mul(b.z, s))};
}
// 1 / x where x > 0, else 0.
ROWS_INLINE vf rows_inverse(vf x) {
    vm some = vf_gt(x, vf_zero());
    return vf_keep(some, vf_div(vf_set1(1.0f), vf_select(some, x, vf_set1(1.0f))));
}

#endif
