#include "support/simd_check.h"

#include <string.h>

#include "core/simd_math.h"

typedef struct lanes { // what an operation may use
    vf a, b, c;
    vi i, j, index;
    vm m, n;
    const simd_check_in *in;
    int first;
} lanes;

static lanes load(const simd_check_in *in, int first) {
    lanes l;
    l.a = vf_load(in->a + first), l.b = vf_load(in->b + first), l.c = vf_load(in->c + first);
    l.i = vi_load(in->i + first), l.j = vi_load(in->j + first);
    l.index = vi_loadu(in->index + first);
    l.m = vm_from_bits(in->mask >> first & ((1u << CORE_SIMD_WIDTH) - 1));
    l.n = vf_lt(l.b, l.c);
    l.in = in;
    l.first = first;
    return l;
}

static void put_f(uint32_t *out, vf value) {
    float lane[CORE_SIMD_WIDTH];
    vf_storeu(lane, value);
    memcpy(out, lane, sizeof lane);
}
static void put_i(uint32_t *out, vi value) {
    int32_t lane[CORE_SIMD_WIDTH];
    vi_storeu(lane, value);
    memcpy(out, lane, sizeof lane);
}
static void put_m(uint32_t *out, vm value) {
    for (int k = 0; k < CORE_SIMD_WIDTH; k++) {
        out[k] = vm_bits(value) >> k & 1u;
    }
}

#define FLOAT_ARITHMETIC(X)                                                                        \
    X(vf_add(l.a, l.b))                                                                            \
    X(vf_sub(l.a, l.b))                                                                            \
    X(vf_mul(l.a, l.b))                                                                            \
    X(vf_div(l.a, l.b))                                                                            \
    X(vf_sqrt(l.a))                                                                                \
    X(vf_mad(l.a, l.b, l.c))                                                                       \
    X(vf_floor(l.a))                                                                               \
    X(vf_round(l.a))                                                                               \
    X(vf_sin(l.a))                                                                                 \
    X(vf_cos(l.a))                                                                                 \
    X(vf_tan(l.a))                                                                                 \
    X(vf_asin(l.a))                                                                                \
    X(vf_acos(l.a))                                                                                \
    X(vf_atan2(l.a, l.b))                                                                          \
    X(vf_exp(l.a))                                                                                 \
    X(vf_log(l.a))
#define FLOAT_EXACT(X)                                                                             \
    X(vf_min(l.a, l.b))                                                                            \
    X(vf_max(l.a, l.b))                                                                            \
    X(vf_neg(l.a))                                                                                 \
    X(vf_abs(l.a))                                                                                 \
    X(vf_copysign(l.a, l.b))                                                                       \
    X(vf_select(l.m, l.a, l.b))                                                                    \
    X(vf_select(l.n, l.a, l.b))                                                                    \
    X(vf_keep(l.m, l.a))                                                                           \
    X(vf_from_i(l.i))                                                                              \
    X(vf_from_bits(l.i))                                                                           \
    X(vf_set1(1.5f))                                                                               \
    X(vf_zero())                                                                                   \
    X(vf_loadu(l.in->a + l.first))                                                                 \
    X(vf_load_mask(l.in->a + l.first, l.m))                                                        \
    X(vf_gather(l.in->a, l.index))                                                                 \
    X(vf_gather_mask(l.m, l.in->a, l.index))
#define INTEGERS(X)                                                                                \
    X(vi_add(l.i, l.j))                                                                            \
    X(vi_sub(l.i, l.j))                                                                            \
    X(vi_mul(l.i, l.j))                                                                            \
    X(vi_min(l.i, l.j))                                                                            \
    X(vi_max(l.i, l.j))                                                                            \
    X(vi_and(l.i, l.j))                                                                            \
    X(vi_or(l.i, l.j))                                                                             \
    X(vi_xor(l.i, l.j))                                                                            \
    X(vi_andnot(l.i, l.j))                                                                         \
    X(vi_shl(l.i, 0))                                                                              \
    X(vi_shl(l.i, 7))                                                                              \
    X(vi_shr(l.i, 31))                                                                             \
    X(vi_shr(l.i, 3))                                                                              \
    X(vi_sar(l.i, 3))                                                                              \
    X(vi_sar(l.i, 31))                                                                             \
    X(vi_select(l.m, l.i, l.j))                                                                    \
    X(vi_keep(l.m, l.i))                                                                           \
    X(vi_round(l.a))                                                                               \
    X(vi_trunc(l.a))                                                                               \
    X(vi_bits(l.a))                                                                                \
    X(vi_set1(-7))                                                                                 \
    X(vi_zero())                                                                                   \
    X(vi_add(vi_iota(), vi_set1(l.first)))                                                         \
    X(vi_loadu(l.in->i + l.first))                                                                 \
    X(vi_load_mask(l.in->i + l.first, l.m))                                                        \
    X(vi_gather(l.in->i, l.index))                                                                 \
    X(vi_gather_mask(l.m, l.in->i, l.index))
#define MASKS(X)                                                                                   \
    X(vf_lt(l.a, l.b))                                                                             \
    X(vf_le(l.a, l.b))                                                                             \
    X(vf_gt(l.a, l.b))                                                                             \
    X(vf_ge(l.a, l.b))                                                                             \
    X(vf_eq(l.a, l.b))                                                                             \
    X(vf_ne(l.a, l.b))                                                                             \
    X(vi_eq(l.i, l.j))                                                                             \
    X(vi_lt(l.i, l.j))                                                                             \
    X(vi_gt(l.i, l.j))                                                                             \
    X(vm_and(l.m, l.n))                                                                            \
    X(vm_or(l.m, l.n))                                                                             \
    X(vm_xor(l.m, l.n))                                                                            \
    X(vm_andnot(l.m, l.n))                                                                         \
    X(vm_not(l.m))                                                                                 \
    X(vm_first(11 - l.first))

// Stores that may write less than a vector go to a block of known content.
static void stores(const simd_check_in *in, simd_check_out *out) {
    static const char *const name[6] = {"vf_store",      "vf_storeu",       "vf_store_mask",
                                        "vi_store_mask", "vf_scatter_mask", "vi_scatter_mask"};
    _Alignas(64) uint32_t block[6][SIMD_CHECK_LANES];
    memset(block, 0x3b, sizeof block);
    for (int first = 0; first < SIMD_CHECK_LANES; first += CORE_SIMD_WIDTH) {
        lanes l = load(in, first);
        vf_store((float *)block[0] + first, l.a);
        vf_storeu((float *)block[1] + first, l.b);
        vf_store_mask((float *)block[2] + first, l.m, l.a);
        vi_store_mask((int32_t *)block[3] + first, l.m, l.i);
        vf_scatter_mask(l.m, (float *)block[4], l.index, l.a);
        vi_scatter_mask(l.m, (int32_t *)block[5], l.index, l.i);
    }
    for (int k = 0; k < 6; k++, out->rows++) {
        out->name[out->rows] = name[k];
        out->arithmetic[out->rows] = false;
        memcpy(out->bits[out->rows], block[k], sizeof block[k]);
    }
}

static bool any_and_all(const simd_check_in *in) {
    bool good = true;
    for (int first = 0; first < SIMD_CHECK_LANES; first += CORE_SIMD_WIDTH) {
        vm m = load(in, first).m;
        uint32_t full = (1u << CORE_SIMD_WIDTH) - 1;
        good = good && vm_any(m) == (vm_bits(m) != 0) && vm_all(m) == (vm_bits(m) == full);
        good = good && vm_all(vm_first(CORE_SIMD_WIDTH)) && !vm_any(vm_first(0));
    }
    return good;
}

void CORE_SIMD_NAME(simd_check)(const simd_check_in *in, simd_check_out *out) {
    for (int first = 0; first < SIMD_CHECK_LANES; first += CORE_SIMD_WIDTH) {
        lanes l = load(in, first);
        out->rows = 0;
#define ROW(expression, put, is_arithmetic)                                                        \
    out->name[out->rows] = #expression;                                                            \
    out->arithmetic[out->rows] = is_arithmetic;                                                    \
    put(&out->bits[out->rows++][first], expression);
#define ROW_A(expression) ROW(expression, put_f, true)
#define ROW_F(expression) ROW(expression, put_f, false)
#define ROW_I(expression) ROW(expression, put_i, false)
#define ROW_M(expression) ROW(expression, put_m, false)
        FLOAT_ARITHMETIC(ROW_A)
        FLOAT_EXACT(ROW_F)
        INTEGERS(ROW_I)
        MASKS(ROW_M)
    }
    stores(in, out);
    out->name[out->rows] = "vm_any and vm_all";
    out->arithmetic[out->rows] = false;
    for (int k = 0; k < SIMD_CHECK_LANES; k++) {
        out->bits[out->rows][k] = any_and_all(in);
    }
    out->rows++;
}
