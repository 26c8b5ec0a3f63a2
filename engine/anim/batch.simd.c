#include "anim/batch.h"

#define W CORE_SIMD_WIDTH

// gcc keeps small arrays of vectors in registers only when the loops over them are unrolled, which
// -O2 does not do by itself.
#if defined(__clang__)
#define UNROLL _Pragma("unroll")
#else
#define UNROLL _Pragma("GCC unroll 16")
#endif

// ---- loads and turns of this width ----

#if W == 4
static inline vi widen_u8(const uint8_t *p) {
    int32_t four;
    __builtin_memcpy(&four, p, 4);
    __m128i v = _mm_unpacklo_epi8(_mm_cvtsi32_si128(four), _mm_setzero_si128());
    return _mm_unpacklo_epi16(v, _mm_setzero_si128());
}
static inline vi widen_u16(const uint16_t *p) {
    return _mm_unpacklo_epi16(_mm_loadl_epi64((const __m128i *)p), _mm_setzero_si128());
}
static inline void turn(vf r[W]) {
    __m128 a = _mm_unpacklo_ps(r[0], r[1]), b = _mm_unpackhi_ps(r[0], r[1]);
    __m128 c = _mm_unpacklo_ps(r[2], r[3]), d = _mm_unpackhi_ps(r[2], r[3]);
    r[0] = _mm_movelh_ps(a, c);
    r[1] = _mm_movehl_ps(c, a);
    r[2] = _mm_movelh_ps(b, d);
    r[3] = _mm_movehl_ps(d, b);
}
#elif W == 8
static inline vi widen_u8(const uint8_t *p) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)p));
}
static inline vi widen_u16(const uint16_t *p) {
    return _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)p));
}
static inline void turn(vf r[W]) {
    __m256 t[8], u[8];
    UNROLL
    for (int i = 0; i < 4; i++) {
        t[2 * i] = _mm256_unpacklo_ps(r[2 * i], r[2 * i + 1]);
        t[2 * i + 1] = _mm256_unpackhi_ps(r[2 * i], r[2 * i + 1]);
    }
    UNROLL
    for (int i = 0; i < 2; i++) {
        u[4 * i] = _mm256_shuffle_ps(t[4 * i], t[4 * i + 2], 0x44);
        u[4 * i + 1] = _mm256_shuffle_ps(t[4 * i], t[4 * i + 2], 0xee);
        u[4 * i + 2] = _mm256_shuffle_ps(t[4 * i + 1], t[4 * i + 3], 0x44);
        u[4 * i + 3] = _mm256_shuffle_ps(t[4 * i + 1], t[4 * i + 3], 0xee);
    }
    UNROLL
    for (int i = 0; i < 4; i++) {
        r[i] = _mm256_permute2f128_ps(u[i], u[i + 4], 0x20);
        r[i + 4] = _mm256_permute2f128_ps(u[i], u[i + 4], 0x31);
    }
}
#else
static inline vi widen_u8(const uint8_t *p) {
    return _mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)p));
}
static inline vi widen_u16(const uint16_t *p) {
    return _mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)p));
}
static inline void turn(vf r[W]) {
    __m512 t[16], u[16];
    UNROLL
    for (int i = 0; i < 8; i++) {
        t[2 * i] = _mm512_unpacklo_ps(r[2 * i], r[2 * i + 1]);
        t[2 * i + 1] = _mm512_unpackhi_ps(r[2 * i], r[2 * i + 1]);
    }
    UNROLL
    for (int i = 0; i < 4; i++) { // u[4 i + k]: column k of each quarter, rows 4 i .. 4 i + 3
        u[4 * i] = _mm512_shuffle_ps(t[4 * i], t[4 * i + 2], 0x44);
        u[4 * i + 1] = _mm512_shuffle_ps(t[4 * i], t[4 * i + 2], 0xee);
        u[4 * i + 2] = _mm512_shuffle_ps(t[4 * i + 1], t[4 * i + 3], 0x44);
        u[4 * i + 3] = _mm512_shuffle_ps(t[4 * i + 1], t[4 * i + 3], 0xee);
    }
    UNROLL
    for (int k = 0; k < 4; k++) {
        __m512 a = _mm512_shuffle_f32x4(u[k], u[4 + k], 0x88);
        __m512 b = _mm512_shuffle_f32x4(u[8 + k], u[12 + k], 0x88);
        __m512 c = _mm512_shuffle_f32x4(u[k], u[4 + k], 0xdd);
        __m512 d = _mm512_shuffle_f32x4(u[8 + k], u[12 + k], 0xdd);
        r[k] = _mm512_shuffle_f32x4(a, b, 0x88);
        r[4 + k] = _mm512_shuffle_f32x4(c, d, 0x88);
        r[8 + k] = _mm512_shuffle_f32x4(a, b, 0xdd);
        r[12 + k] = _mm512_shuffle_f32x4(c, d, 0xdd);
    }
}
#endif

// ---- sampling ----

static inline vf numbers(const uint8_t *row, size_t i, uint32_t bytes) {
    return vf_from_i(bytes == 1 ? widen_u8(row + i)
                                : widen_u16((const uint16_t *)(const void *)row + i));
}

static inline vf rest_w(const vf v[3]) {
    vf n = vf_add(vf_add(vf_mul(v[0], v[0]), vf_mul(v[1], v[1])), vf_mul(v[2], v[2]));
    vf rest = vf_sub(vf_set1(1), n);
    return vf_sqrt(vf_keep(vf_gt(rest, vf_zero()), rest));
}

static inline void normalize_near(vf q[4]) {
    vf n = vf_add(vf_add(vf_mul(q[0], q[0]), vf_mul(q[1], q[1])),
                  vf_add(vf_mul(q[2], q[2]), vf_mul(q[3], q[3])));
    vf rest = vf_sub(vf_set1(1), n);
    vf series = vf_mad(rest, vf_set1(ANIM_PACK_SERIES_4), vf_set1(ANIM_PACK_SERIES_3));
    series = vf_mad(rest, series, vf_set1(ANIM_PACK_SERIES_2));
    series = vf_mad(rest, series, vf_set1(ANIM_PACK_SERIES_1));
    vf scale = vf_mad(rest, series, vf_set1(1));
    UNROLL
    for (int k = 0; k < 4; k++) {
        q[k] = vf_mul(q[k], scale);
    }
}

typedef struct group_times { // where each lane reads
    const uint8_t *row[W];
    float fraction[W];
} group_times;

static inline void locate(const anim_sample_args *a, const anim_pack_group *g, group_times *out) {
    size_t row_bytes = (size_t)3 * g->stride * g->bytes;
    UNROLL
    for (int i = 0; i < W; i++) {
        uint32_t row = anim_pack_row(g, a->pack->duration, a->time[i], &out->fraction[i]);
        out->row[i] = g->rows + row * row_bytes;
    }
}

static inline void store_tracks(const anim_pack_group *g, uint32_t t, uint32_t component, vf v[W],
                                float *pose) {
    uint32_t n = g->tracks - t < W ? g->tracks - t : W;
    turn(v);
    for (uint32_t j = 0; j < n; j++) {
        vf_store(pose + ((size_t)g->bone[t + j] * ANIM_COMPONENTS + component) * W, v[j]);
    }
}

static inline void sample_vectors(const anim_sample_args *a, const anim_pack_group *g,
                                  const group_times *at, uint32_t t, uint32_t bytes) {
    const uint32_t first = g->kind == ANIM_PACK_T ? ANIM_TX : ANIM_SX;
    const size_t next = (size_t)3 * g->stride;
    UNROLL
    for (uint32_t k = 0; k < 3; k++) {
        vf out[W], low = vf_load(g->low + k * g->stride + t);
        vf step = vf_load(g->step + k * g->stride + t);
        UNROLL
        for (int i = 0; i < W; i++) {
            size_t n = k * g->stride + t;
            vf p = vf_mad(numbers(at->row[i], n, bytes), step, low);
            vf q = vf_mad(numbers(at->row[i], next + n, bytes), step, low);
            out[i] = vf_mad(vf_sub(q, p), vf_set1(at->fraction[i]), p);
        }
        store_tracks(g, t, first + k, out, a->pose);
    }
}

static inline void sample_rotations(const anim_sample_args *a, const anim_pack_group *g,
                                    const group_times *at, uint32_t t, uint32_t bytes) {
    const size_t next = (size_t)3 * g->stride;
    vf low[3], step[3], base[4], x[W], y[W], z[W], w[W];
    UNROLL
    for (uint32_t k = 0; k < 4; k++) {
        base[k] = vf_load(g->base + k * g->stride + t);
        if (k < 3) {
            low[k] = vf_load(g->low + k * g->stride + t);
            step[k] = vf_load(g->step + k * g->stride + t);
        }
    }
    UNROLL
    for (int i = 0; i < W; i++) {
        vf p[3], q[3], d[4], fraction = vf_set1(at->fraction[i]);
        UNROLL
        for (uint32_t k = 0; k < 3; k++) {
            size_t n = k * g->stride + t;
            p[k] = vf_mad(numbers(at->row[i], n, bytes), step[k], low[k]);
            q[k] = vf_mad(numbers(at->row[i], next + n, bytes), step[k], low[k]);
            d[k] = vf_mad(vf_sub(q[k], p[k]), fraction, p[k]);
        }
        vf pw = rest_w(p);
        d[3] = vf_mad(vf_sub(rest_w(q), pw), fraction, pw);
        normalize_near(d);
        x[i] = vf_add(vf_add(vf_mul(base[3], d[0]), vf_mul(base[0], d[3])),
                      vf_sub(vf_mul(base[1], d[2]), vf_mul(base[2], d[1])));
        y[i] = vf_add(vf_add(vf_mul(base[3], d[1]), vf_mul(base[1], d[3])),
                      vf_sub(vf_mul(base[2], d[0]), vf_mul(base[0], d[2])));
        z[i] = vf_add(vf_add(vf_mul(base[3], d[2]), vf_mul(base[2], d[3])),
                      vf_sub(vf_mul(base[0], d[1]), vf_mul(base[1], d[0])));
        w[i] = vf_sub(vf_sub(vf_mul(base[3], d[3]), vf_mul(base[0], d[0])),
                      vf_add(vf_mul(base[1], d[1]), vf_mul(base[2], d[2])));
    }
    store_tracks(g, t, ANIM_RX, x, a->pose);
    store_tracks(g, t, ANIM_RY, y, a->pose);
    store_tracks(g, t, ANIM_RZ, z, a->pose);
    store_tracks(g, t, ANIM_RW, w, a->pose);
}

static inline void sample_group(const anim_sample_args *a, const anim_pack_group *g,
                                uint32_t bytes) {
    group_times at;
    locate(a, g, &at);
    for (uint32_t t = 0; t < g->tracks; t += W) {
        if (g->kind == ANIM_PACK_R) {
            sample_rotations(a, g, &at, t, bytes);
        } else {
            sample_vectors(a, g, &at, t, bytes);
        }
    }
}

// What no group gives: the same for all lanes.
static inline void fill_rest(const anim_sample_args *a) {
    for (uint32_t b = 0; b < a->bones; b++) {
        float *to = a->pose + (size_t)b * ANIM_COMPONENTS * W;
        const float *from = a->rest + b;
        uint32_t moved = a->moved[b];
        for (uint32_t c = ANIM_TX; c < ANIM_RX && !(moved & 1u << ANIM_PACK_T); c++) {
            vf_store(to + c * W, vf_set1(from[c * a->stride]));
        }
        for (uint32_t c = ANIM_RX; c < ANIM_SX && !(moved & 1u << ANIM_PACK_R); c++) {
            vf_store(to + c * W, vf_set1(from[c * a->stride]));
        }
        for (uint32_t c = ANIM_SX; c < ANIM_COMPONENTS && !(moved & 1u << ANIM_PACK_S); c++) {
            vf_store(to + c * W, vf_set1(from[c * a->stride]));
        }
    }
}

void CORE_SIMD_NAME(anim_kernel_sample)(const anim_sample_args *a) {
    fill_rest(a);
    for (uint32_t i = 0; i < a->pack->group_count; i++) {
        const anim_pack_group *g = &a->pack->group[i];
        if (g->bytes == 1) {
            sample_group(a, g, 1);
        } else {
            sample_group(a, g, 2);
        }
    }
}

// ---- blending ----

typedef struct mix_weights {
    vf left, right;
    vm none, whole; // the ends are kept bit for bit
} mix_weights;

static inline vf mix_ends(const mix_weights *m, vf from, vf to, vf mixed) {
    return vf_select(m->whole, to, vf_select(m->none, from, mixed));
}

static inline void mix_linear(const float *from, float *pose, const mix_weights *m) {
    vf p = vf_load(pose), q = vf_load(from);
    vf_store(pose, mix_ends(m, q, p, vf_add(vf_mul(q, m->left), vf_mul(p, m->right))));
}

static inline void mix_rotation(const float *from, float *pose, const mix_weights *m) {
    vf a[4], b[4], q[4];
    UNROLL
    for (int k = 0; k < 4; k++) {
        a[k] = vf_load(from + k * W);
        b[k] = vf_load(pose + k * W);
    }
    vf dot = vf_add(vf_add(vf_add(vf_mul(a[0], b[0]), vf_mul(a[1], b[1])), vf_mul(a[2], b[2])),
                    vf_mul(a[3], b[3]));
    vf side = vf_select(vf_lt(dot, vf_zero()), vf_neg(m->right), m->right);
    UNROLL
    for (int k = 0; k < 4; k++) {
        q[k] = vf_add(vf_mul(a[k], m->left), vf_mul(b[k], side));
    }
    vf n = vf_add(vf_add(vf_add(vf_mul(q[0], q[0]), vf_mul(q[1], q[1])), vf_mul(q[2], q[2])),
                  vf_mul(q[3], q[3]));
    vf inverse = vf_div(vf_set1(1), vf_sqrt(n));
    UNROLL
    for (int k = 0; k < 4; k++) {
        vf_store(pose + k * W, mix_ends(m, a[k], b[k], vf_mul(q[k], inverse)));
    }
}

void CORE_SIMD_NAME(anim_kernel_mix)(const anim_mix_args *a) {
    vf weight = vf_loadu(a->weight), one = vf_set1(1);
    const mix_weights m = {vf_sub(one, weight), weight, vf_le(weight, vf_zero()),
                           vf_ge(weight, one)};
    for (uint32_t b = 0; b < a->bones; b++) {
        const float *from = a->from + (size_t)b * ANIM_COMPONENTS * W;
        float *pose = a->pose + (size_t)b * ANIM_COMPONENTS * W;
        for (int c = ANIM_TX; c < ANIM_RX; c++) {
            mix_linear(from + c * W, pose + c * W, &m);
        }
        mix_rotation(from + ANIM_RX * W, pose + ANIM_RX * W, &m);
        for (int c = ANIM_SX; c < (int)ANIM_COMPONENTS; c++) {
            mix_linear(from + c * W, pose + c * W, &m);
        }
    }
}

// ---- local to model to palette ----

static inline void local_rows(const float *pose, vf m[12]) {
    vf x = vf_load(pose + ANIM_RX * W), y = vf_load(pose + ANIM_RY * W);
    vf z = vf_load(pose + ANIM_RZ * W), w = vf_load(pose + ANIM_RW * W);
    vf sx = vf_load(pose + ANIM_SX * W), sy = vf_load(pose + ANIM_SY * W);
    vf sz = vf_load(pose + ANIM_SZ * W), one = vf_set1(1), two = vf_set1(2);
    vf xx = vf_mul(x, x), yy = vf_mul(y, y), zz = vf_mul(z, z), xy = vf_mul(x, y);
    vf xz = vf_mul(x, z), yz = vf_mul(y, z), wx = vf_mul(w, x), wy = vf_mul(w, y),
       wz = vf_mul(w, z);
    m[0] = vf_mul(vf_sub(one, vf_mul(two, vf_add(yy, zz))), sx);
    m[1] = vf_mul(vf_mul(two, vf_sub(xy, wz)), sy);
    m[2] = vf_mul(vf_mul(two, vf_add(xz, wy)), sz);
    m[3] = vf_load(pose + ANIM_TX * W);
    m[4] = vf_mul(vf_mul(two, vf_add(xy, wz)), sx);
    m[5] = vf_mul(vf_sub(one, vf_mul(two, vf_add(xx, zz))), sy);
    m[6] = vf_mul(vf_mul(two, vf_sub(yz, wx)), sz);
    m[7] = vf_load(pose + ANIM_TY * W);
    m[8] = vf_mul(vf_mul(two, vf_sub(xz, wy)), sx);
    m[9] = vf_mul(vf_mul(two, vf_add(yz, wx)), sy);
    m[10] = vf_mul(vf_sub(one, vf_mul(two, vf_add(xx, yy))), sz);
    m[11] = vf_load(pose + ANIM_TZ * W);
}

static inline void multiply_row(const float *a, const vf b[12], vf out[4]) {
    vf r0 = vf_load(a), r1 = vf_load(a + W), r2 = vf_load(a + 2 * W);
    UNROLL
    for (int c = 0; c < 4; c++) {
        out[c] = vf_add(vf_add(vf_mul(r0, b[c]), vf_mul(r1, b[4 + c])), vf_mul(r2, b[8 + c]));
    }
    out[3] = vf_add(out[3], vf_load(a + 3 * W));
}

static inline void multiply_bind(const float *a, const float *bind, vf out[4]) {
    vf r0 = vf_load(a), r1 = vf_load(a + W), r2 = vf_load(a + 2 * W);
    UNROLL
    for (int c = 0; c < 4; c++) {
        out[c] = vf_add(vf_add(vf_mul(r0, vf_set1(bind[c])), vf_mul(r1, vf_set1(bind[4 + c]))),
                        vf_mul(r2, vf_set1(bind[8 + c])));
    }
    out[3] = vf_add(out[3], vf_load(a + 3 * W));
}

// Twelve rows across W instances to twelve numbers of each.
static inline void store_palettes(vf m[16], float **palette, size_t at) {
#if W == 4
    UNROLL
    for (int part = 0; part < 3; part++) {
        turn(m + 4 * part);
        UNROLL
        for (int i = 0; i < W; i++) {
            if (palette[i]) {
                vf_storeu(palette[i] + at + 4 * part, m[4 * part + i]);
            }
        }
    }
#elif W == 8
    turn(m);
    UNROLL
    for (int i = 0; i < W; i++) {
        if (palette[i]) {
            vf_storeu(palette[i] + at, m[i]);
        }
    }
    UNROLL
    for (int half = 0; half < 2; half++) {
        __m128 r[4];
        UNROLL
        for (int k = 0; k < 4; k++) {
            r[k] = half ? _mm256_extractf128_ps(m[8 + k], 1) : _mm256_castps256_ps128(m[8 + k]);
        }
        _MM_TRANSPOSE4_PS(r[0], r[1], r[2], r[3]);
        UNROLL
        for (int i = 0; i < 4; i++) {
            if (palette[4 * half + i]) {
                _mm_storeu_ps(palette[4 * half + i] + at + 8, r[i]);
            }
        }
    }
#else
    m[12] = m[13] = m[14] = m[15] = vf_zero();
    turn(m);
    UNROLL
    for (int i = 0; i < W; i++) {
        if (palette[i]) {
            _mm512_mask_storeu_ps(palette[i] + at, 0x0fff, m[i]);
        }
    }
#endif
}

void CORE_SIMD_NAME(anim_kernel_finish)(const anim_finish_args *a) {
    const anim_skeleton_res *s = a->skeleton;
    for (uint32_t b = 0; b < s->bones; b++) {
        vf local[12], skin[16];
        float *model = a->model + (size_t)b * 12 * W;
        local_rows(a->pose + (size_t)b * ANIM_COMPONENTS * W, local);
        const float *parent = s->parent[b] < 0 ? NULL : a->model + (size_t)s->parent[b] * 12 * W;
        UNROLL
        for (int r = 0; r < 3; r++) {
            vf row[4] = {local[4 * r], local[4 * r + 1], local[4 * r + 2], local[4 * r + 3]};
            if (parent) {
                multiply_row(parent + 4 * r * W, local, row);
            }
            UNROLL
            for (int c = 0; c < 4; c++) {
                vf_store(model + (4 * r + c) * W, row[c]);
            }
        }
        UNROLL
        for (int r = 0; r < 3; r++) {
            multiply_bind(model + 4 * r * W, s->inverse_bind + 12 * b, skin + 4 * r);
        }
        store_palettes(skin, a->palette, (size_t)b * 12);
    }
}
