// Kernels of the wide cluster assignment. Bounds of a sphere in a slice: Mara, McGuire (2013), as
// in gfx_cluster.c. Refinement by row: Persson, "Practical Clustered Shading" (2013): a sphere cut
// by a plane beyond its centre lies in the sphere round the cut circle, so centre and radius shrink
// onto the slice's plane, then onto the row's, before the columns are tested.
#include "gfx/gfx_cluster_wide.h"

#if CORE_SIMD_WIDTH > 4
#include <immintrin.h>
#endif

#define NAME(name) CORE_SIMD_NAME(name)

// Writes the lanes of a that `bits` keeps to p, packed; may write CORE_SIMD_WIDTH elements. Returns
// how many were kept.
static inline uint32_t compress(const gfx_cluster_wide *w, uint32_t *p, uint32_t bits, vi a) {
#if CORE_SIMD_WIDTH == 16
    (void)w;
    _mm512_storeu_si512(p, _mm512_maskz_compress_epi32((__mmask16)bits, a));
    return (uint32_t)__builtin_popcount(bits);
#elif CORE_SIMD_WIDTH == 8
    __m256i lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const void *)w->kept[bits]));
    _mm256_storeu_si256((void *)p, _mm256_permutevar8x32_epi32(a, lanes));
    return (uint32_t)__builtin_popcount(bits);
#else
    (void)w;
    int32_t lane[CORE_SIMD_WIDTH];
    uint32_t n = 0;
    vi_storeu(lane, a);
    for (int i = 0; i < CORE_SIMD_WIDTH; ++i) {
        p[n] = (uint32_t)lane[i];
        n += bits >> i & 1u;
    }
    return n;
#endif
}

static inline void compress_float(const gfx_cluster_wide *w, float *p, uint32_t bits, vf a) {
    compress(w, (uint32_t *)(void *)p, bits, vi_bits(a));
}

// Tangents from the eye to the disk of radius r round (s, d): slope and depth of the point of touch
// on the side of lesser (sign -1) or greater s.
static inline void tangent(vf s, vf d, vf r, float sign, vf *slope, vf *at) {
    vf q = vf_mad(s, s, vf_mul(d, d));
    vf l = vf_sqrt(vf_max(vf_sub(q, vf_mul(r, r)), vf_zero()));
    vf rs = vf_mul(r, vf_set1(sign));
    vf run = vf_sub(vf_mul(d, l), vf_mul(s, rs));
    *slope = vf_div(vf_mad(d, rs, vf_mul(s, l)), run);
    *at = vf_div(vf_mul(l, run), q);
    vm none = vm_or(vf_le(l, vf_zero()), vf_le(run, vf_zero()));
    *slope = vf_select(none, vf_zero(), *slope);
    *at = vf_select(none, vf_set1(-1.0f), *at);
}

// Distance to the left-, right-, lower- and uppermost plane decides whether a light is in view.
static inline vm outside(const gfx_cluster_planes *p, uint32_t last, vf s, vf d, vf r) {
    vf lo = vf_mad(vf_set1(p->ns[0]), s, vf_mad(vf_set1(p->nd[0]), d, vf_set1(p->nc[0])));
    vf hi = vf_mad(vf_set1(p->ns[last]), s, vf_mad(vf_set1(p->nd[last]), d, vf_set1(p->nc[last])));
    return vm_or(vf_lt(lo, vf_neg(r)), vf_gt(hi, r));
}

uint32_t NAME(gfx_cluster_pack)(const gfx_cluster_wide *w, const gfx_cluster_lights *l) {
    const gfx_cluster_grid *g = w->grid;
    const gfx_cluster_packed *p = &w->packed;
    vf first = vf_set1(w->slice_lo[0]), last = vf_set1(w->slice_hi[g->slices - 1]);
    uint32_t n = 0;
    for (uint32_t i = 0; i < l->count; i += CORE_SIMD_WIDTH) {
        vf x = vf_load(l->x + i), y = vf_load(l->y + i), d = vf_load(l->depth + i);
        vf r = vf_load(l->radius + i), lo = vf_sub(d, r), hi = vf_add(d, r);
        vm keep = vm_and(vf_ge(hi, first), vf_le(lo, last));
        keep = vm_andnot(keep, outside(&w->column, g->columns, x, d, r));
        keep = vm_andnot(keep, outside(&w->row, g->rows, y, d, r));
        keep = vm_and(keep, vm_first((int)(l->count - i)));
        if (!vm_any(keep)) {
            continue;
        }
        uint32_t bits = vm_bits(keep);
        vf one = vf_set1(1.0f), slope[4], at[4];
        for (int k = 0; k < 4; ++k) {
            tangent(k < 2 ? x : y, d, r, k & 1 ? 1.0f : -1.0f, &slope[k], &at[k]);
            compress_float(w, p->slope[k] + n, bits, slope[k]);
            compress_float(w, p->at[k] + n, bits, at[k]);
        }
        vf inv_lo = vf_select(vf_gt(lo, vf_zero()), vf_div(one, lo), vf_set1(1e30f));
        compress_float(w, p->x + n, bits, x);
        compress_float(w, p->y + n, bits, y);
        compress_float(w, p->depth + n, bits, d);
        compress_float(w, p->radius + n, bits, r);
        compress_float(w, p->lo + n, bits, lo);
        compress_float(w, p->hi + n, bits, hi);
        compress_float(w, p->inv_lo + n, bits, inv_lo);
        compress_float(w, p->inv_hi + n, bits, vf_div(one, hi));
        n += compress(w, p->id + n, bits, vi_add(vi_set1((int32_t)i), vi_iota()));
    }
    for (uint32_t i = n; i < n + CORE_LANES; ++i) { // lanes beyond the end are in no slice
        p->lo[i] = 1e30f, p->hi[i] = -1e30f;
    }
    return n;
}

// ---- one slice ----

typedef struct slab { // of one slice, for a vector of lights
    vf a, b;          // depths of the part of the sphere in it
    vf inv_a, inv_b;
    vf half_a, half_b; // half chords at a and b
} slab;

static inline slab slab_of(const gfx_cluster_packed *p, uint32_t i, float lo, float hi,
                           float inv_lo, float inv_hi) {
    vf d = vf_load(p->depth + i), r = vf_load(p->radius + i), r2 = vf_mul(r, r);
    slab s = {.a = vf_max(vf_set1(lo), vf_load(p->lo + i)),
              .b = vf_min(vf_set1(hi), vf_load(p->hi + i)),
              .inv_a = vf_min(vf_set1(inv_lo), vf_load(p->inv_lo + i)),
              .inv_b = vf_max(vf_set1(inv_hi), vf_load(p->inv_hi + i))};
    vf da = vf_sub(s.a, d), db = vf_sub(s.b, d);
    s.half_a = vf_sqrt(vf_max(vf_sub(r2, vf_mul(da, da)), vf_zero()));
    s.half_b = vf_sqrt(vf_max(vf_sub(r2, vf_mul(db, db)), vf_zero()));
    return s;
}

// Least and greatest s/depth of the sphere's part in the slab.
static inline void slopes(const gfx_cluster_packed *p, uint32_t i, int side, const slab *s, vf c,
                          vf *lo, vf *hi) {
    vf lo_a = vf_mul(vf_sub(c, s->half_a), s->inv_a), lo_b = vf_mul(vf_sub(c, s->half_b), s->inv_b);
    vf hi_a = vf_mul(vf_add(c, s->half_a), s->inv_a), hi_b = vf_mul(vf_add(c, s->half_b), s->inv_b);
    *lo = vf_min(lo_a, lo_b);
    *hi = vf_max(hi_a, hi_b);
    for (int k = 0; k < 2; ++k) {
        vf at = vf_load(p->at[side + k] + i), slope = vf_load(p->slope[side + k] + i);
        vm inside = vm_and(vf_gt(at, s->a), vf_lt(at, s->b));
        vf *bound = k ? hi : lo;
        vf wider = k ? vf_max(*bound, slope) : vf_min(*bound, slope);
        *bound = vf_select(inside, wider, *bound);
    }
}

// The same without perspective.
static inline void spans(vf c, vf d, vf r, const slab *s, vf *lo, vf *hi) {
    vf off = vf_sub(vf_max(s->a, vf_min(d, s->b)), d);
    vf half = vf_sqrt(vf_max(vf_sub(vf_mul(r, r), vf_mul(off, off)), vf_zero()));
    *lo = vf_sub(c, half);
    *hi = vf_add(c, half);
}

typedef struct tiles {
    vi first, last;
    vm any;
} tiles;

static inline tiles tiles_of(vf lo, vf hi, float scale, float mid, float margin, uint32_t count) {
    vf end = vf_set1((float)count), most = vf_set1((float)(count - 1));
    vf from = vf_mad(lo, vf_set1(scale), vf_set1(mid - margin));
    vf to = vf_mad(hi, vf_set1(scale), vf_set1(mid + margin));
    tiles t = {.any = vm_and(vf_ge(to, vf_zero()), vf_lt(from, end))};
    t.first = vi_trunc(vf_min(vf_max(from, vf_zero()), most));
    t.last = vi_trunc(vf_min(vf_max(to, vf_zero()), most));
    return t;
}

typedef struct rows { // centre and radius shrunk onto each row, for one light in one slice
    float depth[GFX_CLUSTER_SIDE + CORE_LANES], radius[GFX_CLUSTER_SIDE + CORE_LANES];
} rows;

// Radius -1 where the row is not touched.
static inline void refine_rows(const gfx_cluster_wide *w, float y, float d, float r2,
                               uint32_t first, uint32_t last, rows *out) {
    const gfx_cluster_planes *p = &w->row;
    for (uint32_t j = first; j <= last; j += CORE_SIMD_WIDTH) {
        vf ys = vf_set1(y), ds = vf_set1(d);
        vf below =
            vf_mad(vf_loadu(p->ns + j), ys, vf_mad(vf_loadu(p->nd + j), ds, vf_loadu(p->nc + j)));
        vf above = vf_mad(vf_loadu(p->ns + j + 1), ys,
                          vf_mad(vf_loadu(p->nd + j + 1), ds, vf_loadu(p->nc + j + 1)));
        // Negative distance to the lower plane or positive to the upper one: outside.
        vf off_low = vf_min(below, vf_zero()), off_high = vf_max(above, vf_zero());
        vf depth = vf_sub(vf_sub(ds, vf_mul(vf_loadu(p->nd + j), off_low)),
                          vf_mul(vf_loadu(p->nd + j + 1), off_high));
        vf left = vf_sub(vf_sub(vf_set1(r2), vf_mul(off_low, off_low)), vf_mul(off_high, off_high));
        vf radius =
            vf_select(vf_ge(left, vf_zero()), vf_sqrt(vf_max(left, vf_zero())), vf_set1(-1.0f));
        vf_storeu(out->depth + j, depth);
        vf_storeu(out->radius + j, radius);
    }
}

// Columns of a group of 16 that the sphere (x, d, r) touches: it reaches beyond the column's left
// plane, and back over the next one's. The last column's right plane is left to the rectangle.
static inline uint32_t column_mask(const gfx_cluster_planes *p, uint32_t first, float x, float d,
                                   float r) {
    vf xs = vf_set1(x), ds = vf_set1(d), rs = vf_set1(r), minus = vf_set1(-r);
    uint32_t starts = 0, ends = 0;
    for (uint32_t i = 0; i < 16; i += CORE_SIMD_WIDTH) {
        uint32_t k = first + i;
        vf left =
            vf_mad(vf_loadu(p->ns + k), xs, vf_mad(vf_loadu(p->nd + k), ds, vf_loadu(p->nc + k)));
        starts |= vm_bits(vf_ge(left, minus)) << i;
        ends |= vm_bits(vf_le(left, rs)) << i;
    }
    return starts & (ends >> 1 | 0x8000u);
}

typedef struct corners { // of a vector of cells of one row and slice
    vf x[2];
    float y[2], depth[2];
    bool orthographic;
} corners;

// gfx_cluster_ahead for a vector of cells.
static inline vf ahead(const corners *b, const vf n[3], const float from[3]) {
    vf side = vf_add(vf_min(vf_mul(n[0], b->x[0]), vf_mul(n[0], b->x[1])),
                     vf_min(vf_mul(n[1], vf_set1(b->y[0])), vf_mul(n[1], vf_set1(b->y[1]))));
    vf rise = b->orthographic ? n[2] : vf_add(side, n[2]);
    vf least = vf_min(vf_mul(rise, vf_set1(b->depth[0])), vf_mul(rise, vf_set1(b->depth[1])));
    least = b->orthographic ? vf_add(least, side) : least;
    vf start = vf_add(vf_add(vf_mul(n[0], vf_set1(from[0])), vf_mul(n[1], vf_set1(from[1]))),
                      vf_mul(n[2], vf_set1(from[2])));
    return vf_sub(least, start);
}

// gfx_cluster_cone_misses for a vector of cells; way: from the apex to their centres.
static inline vm cone_misses(const gfx_cluster_cone *c, const corners *b, const vf way[3]) {
    vf axis[3] = {vf_set1(c->axis[0]), vf_set1(c->axis[1]), vf_set1(c->axis[2])}, normal[3];
    vf along =
        vf_add(vf_add(vf_mul(way[0], axis[0]), vf_mul(way[1], axis[1])), vf_mul(way[2], axis[2]));
    vf off2 = vf_zero(), cosine = vf_set1(c->cosine), sine = vf_set1(c->sine);
    for (int k = 0; k < 3; ++k) {
        normal[k] = vf_sub(way[k], vf_mul(along, axis[k]));
        off2 = vf_add(off2, vf_mul(normal[k], normal[k]));
    }
    vf off = vf_sqrt(off2), length = vf_sqrt(vf_add(off2, vf_mul(along, along)));
    vf back = vf_mul(sine, off);
    for (int k = 0; k < 3; ++k) {
        normal[k] = vf_sub(vf_mul(cosine, normal[k]), vf_mul(back, axis[k]));
    }
    vf rim = vf_max(vf_add(vf_mul(along, cosine), back), vf_zero());
    vf reach = vf_select(vf_ge(along, vf_mul(length, cosine)), length, rim);
    return vm_or(vf_gt(ahead(b, normal, c->apex), vf_zero()),
                 vf_gt(ahead(b, way, c->apex), vf_mul(vf_set1(c->range), reach)));
}

// Columns of `mask` that a cone may touch in row j of slice k.
static inline uint32_t cone_mask(const gfx_cluster_wide *w, const gfx_cluster_cone *c, uint32_t k,
                                 uint32_t j, uint32_t first, uint32_t mask) {
    corners b = {.y = {w->rows.lo[j], w->rows.hi[j]},
                 .depth = {w->slice_lo[k], w->slice_hi[k]},
                 .orthographic = w->grid->orthographic};
    float middle = 0.5f * (b.depth[0] + b.depth[1]), scale = b.orthographic ? 1.0f : middle;
    vf way[3] = {vf_zero(), vf_set1(w->rows.mid[j] * scale - c->apex[1]),
                 vf_set1(middle - c->apex[2])};
    uint32_t missed = 0;
    for (uint32_t i = 0; i < 16; i += CORE_SIMD_WIDTH) {
        if (mask >> i & ((1u << CORE_SIMD_WIDTH) - 1u)) {
            b.x[0] = vf_loadu(w->columns.lo + first + i);
            b.x[1] = vf_loadu(w->columns.hi + first + i);
            vf centre = vf_mul(vf_loadu(w->columns.mid + first + i), vf_set1(scale));
            way[0] = vf_sub(centre, vf_set1(c->apex[0]));
            missed |= vm_bits(cone_misses(c, &b, way)) << i;
        }
    }
    return mask & ~missed;
}

typedef struct reach { // tiles of one light in one slice, inclusive
    uint32_t c0, c1, r0, r1;
} reach;

static inline uint32_t record_light(const gfx_cluster_wide *w, uint32_t i, uint32_t k,
                                    const reach *t, gfx_cluster_records *out) {
    const gfx_cluster_packed *p = &w->packed;
    const gfx_cluster_cone *cone = w->cone ? &w->cone[p->id[i]] : NULL;
    bool spot = cone && cone->cosine > 0.0f;
    uint32_t groups = (w->grid->columns + 15) / 16, pairs = 0;
    float x = p->x[i], d = p->depth[i], r = p->radius[i];
    float inside = CORE_CLAMP(d, w->slice_lo[k], w->slice_hi[k]),
          off = inside - d; // onto the slice's nearer plane
    rows row;
    refine_rows(w, p->y[i], inside, r * r - off * off, t->r0, t->r1, &row);
    for (uint32_t j = t->r0; j <= t->r1; ++j) {
        if (row.radius[j] < 0.0f) {
            continue;
        }
        for (uint32_t g = t->c0 / 16; g <= t->c1 / 16; ++g) {
            uint32_t from = t->c0 > 16 * g ? t->c0 - 16 * g : 0;
            uint32_t to = t->c1 < 16 * g + 15 ? t->c1 - 16 * g : 15;
            uint32_t mask = column_mask(&w->column, 16 * g, x, row.depth[j], row.radius[j]);
            mask &= (2u << to) - (1u << from);
            mask = spot ? cone_mask(w, cone, k, j, 16 * g, mask) : mask;
            uint32_t list = j * groups + g, n = out->count[list];
            out->id[list * out->stride + n] = p->id[i];
            out->mask[list * out->stride + n] = (uint16_t)mask;
            out->count[list] = n + (mask != 0);
            pairs += (uint32_t)__builtin_popcount(mask);
        }
    }
    return pairs;
}

uint32_t NAME(gfx_cluster_record)(const gfx_cluster_wide *w, uint32_t k, gfx_cluster_records *out) {
    const gfx_cluster_grid *g = w->grid;
    const gfx_cluster_packed *p = &w->packed;
    float lo = w->slice_lo[k], hi = w->slice_hi[k], inv_lo = 1.0f / lo, inv_hi = 1.0f / hi;
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < p->count; i += CORE_SIMD_WIDTH) {
        vm in =
            vm_and(vf_le(vf_load(p->lo + i), vf_set1(hi)), vf_ge(vf_load(p->hi + i), vf_set1(lo)));
        if (!vm_any(in)) {
            continue;
        }
        vf x = vf_load(p->x + i), y = vf_load(p->y + i), x0, x1, y0, y1;
        slab s = slab_of(p, i, lo, hi, inv_lo, inv_hi);
        if (g->orthographic) {
            vf d = vf_load(p->depth + i), r = vf_load(p->radius + i);
            spans(x, d, r, &s, &x0, &x1);
            spans(y, d, r, &s, &y0, &y1);
        } else {
            slopes(p, i, 0, &s, x, &x0, &x1);
            slopes(p, i, 2, &s, y, &y0, &y1);
        }
        tiles c = tiles_of(x0, x1, w->scale_x, w->mid_x, w->margin, g->columns);
        tiles r = tiles_of(y0, y1, w->scale_y, w->mid_y, w->margin, g->rows);
        uint32_t bits = vm_bits(vm_and(in, vm_and(c.any, r.any)));
        int32_t c0[CORE_SIMD_WIDTH], c1[CORE_SIMD_WIDTH], r0[CORE_SIMD_WIDTH], r1[CORE_SIMD_WIDTH];
        vi_storeu(c0, c.first);
        vi_storeu(c1, c.last);
        vi_storeu(r0, r.first);
        vi_storeu(r1, r.last);
        for (; bits; bits &= bits - 1) {
            int lane = __builtin_ctz(bits);
            reach t = {(uint32_t)c0[lane], (uint32_t)c1[lane], (uint32_t)r0[lane],
                       (uint32_t)r1[lane]};
            pairs += record_light(w, i + (uint32_t)lane, k, &t, out);
        }
    }
    return pairs;
}

// Which of a vector of records from i on have a bit in their masks.
static inline uint32_t records_with(const uint16_t *mask, uint32_t i, uint32_t n, uint32_t bit) {
    uint32_t have = n - i < CORE_SIMD_WIDTH ? (1u << (n - i)) - 1u : (1u << CORE_SIMD_WIDTH) - 1u;
#if CORE_SIMD_WIDTH == 16
    __m256i m = _mm256_load_si256((const void *)(mask + i));
    return have & _mm256_test_epi16_mask(m, _mm256_set1_epi16((short)(1 << bit)));
#elif CORE_SIMD_WIDTH == 8
    __m128i m = _mm_load_si128((const void *)(mask + i));
    m = _mm_sll_epi16(m, _mm_cvtsi32_si128(15 - (int)bit)); // into the sign, which packing keeps
    return have & (uint32_t)_mm_movemask_epi8(_mm_packs_epi16(m, _mm_setzero_si128()));
#else
    uint32_t bits = 0;
    for (uint32_t lane = 0; lane < CORE_SIMD_WIDTH; ++lane) {
        bits |= (mask[i + lane] >> bit & 1u) << lane;
    }
    return have & bits;
#endif
}

void NAME(gfx_cluster_compact)(const gfx_cluster_wide *w, const gfx_cluster_records *r,
                               gfx_cluster_slice *out) {
    const gfx_cluster_grid *g = w->grid;
    uint32_t groups = (g->columns + 15) / 16, at = 0;
    for (uint32_t cell = 0; cell < g->rows * g->columns; ++cell) {
        uint32_t row = cell / g->columns, column = cell % g->columns;
        uint32_t list = row * groups + column / 16, n = r->count[list];
        const uint32_t *id = r->id + list * r->stride;
        const uint16_t *mask = r->mask + list * r->stride;
        for (uint32_t i = 0; i < n; i += CORE_SIMD_WIDTH) {
            uint32_t bits = records_with(mask, i, n, column % 16);
            at += compress(w, out->light + at, bits, vi_load((const int32_t *)id + i));
        }
        out->end[cell] = at;
    }
    out->total = at;
}
