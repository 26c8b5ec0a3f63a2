// Broad phases over the shapes' bounds: all pairs (the reference), and sweep and prune along x
// (Baraff 1992; Cohen et al., I-COLLIDE, 1995) with the order kept between steps.
#include "phys/world.h"

static void brute_find(phys_world *w) {
    const phys_shapes *s = &w->shapes;
    uint32_t n = core_columns_count(&s->set);
    w->pairs.count = 0;
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = i + 1; j < n; j++) {
            if (s->x0[i] <= s->x1[j] && s->x0[j] <= s->x1[i] && s->y0[i] <= s->y1[j] &&
                s->y0[j] <= s->y1[i] && s->z0[i] <= s->z1[j] && s->z0[j] <= s->z1[i] &&
                phys_pair_wanted(w, i, j)) {
                phys_pair_push(&w->pairs, i, j);
            }
        }
    }
}

static void order_reset(phys_world *w, uint32_t n) {
    if (n > w->order_capacity) {
        uint32_t grown = CORE_MAX(n, w->order_capacity * 2);
        w->order =
            core_realloc(w->order, w->order_capacity * sizeof(uint32_t), grown * sizeof(uint32_t));
        w->order_capacity = grown;
    }
    for (uint32_t i = 0; i < n; i++) {
        w->order[i] = i;
    }
    w->order_count = n;
}

// Insertion sort: near linear when bodies moved little. A fresh order is merge sorted first, since
// insertion would cost n^2 / 4 there.
static void order_sort(phys_world *w, bool fresh) {
    const float *key = w->shapes.x0;
    uint32_t *order = w->order, n = w->order_count;
    if (fresh) {
        size_t mark = core_arena_mark(&w->scratch);
        uint32_t *from = order, *to = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n);
        for (uint32_t width = 1; width < n; width *= 2) {
            for (uint32_t lo = 0; lo < n; lo += 2 * width) {
                uint32_t mid = CORE_MIN(lo + width, n), hi = CORE_MIN(lo + 2 * width, n);
                uint32_t i = lo, j = mid;
                for (uint32_t k = lo; k < hi; k++) {
                    to[k] = i < mid && (j >= hi || key[from[i]] <= key[from[j]]) ? from[i++]
                                                                                 : from[j++];
                }
            }
            uint32_t *swap = from;
            from = to;
            to = swap;
        }
        for (uint32_t i = 0; i < n && from != order; i++) {
            order[i] = from[i];
        }
        core_arena_rewind(&w->scratch, mark);
    }
    for (uint32_t i = 1; i < n; i++) {
        uint32_t row = order[i], j = i;
        float x = key[row];
        for (; j > 0 && key[order[j - 1]] > x; j--) {
            order[j] = order[j - 1];
        }
        order[j] = row;
    }
}

typedef struct sweep_box {
    float x0, x1, y0, y1, z0, z1;
    uint32_t row, fixed;
} sweep_box;

static void sap_find(phys_world *w) {
    const phys_shapes *s = &w->shapes;
    uint32_t n = core_columns_count(&s->set);
    bool fresh = w->order_count != n;
    if (fresh) {
        order_reset(w, n);
    }
    order_sort(w, fresh);
    size_t mark = core_arena_mark(&w->scratch);
    sweep_box *box = CORE_ARENA_ARRAY(&w->scratch, sweep_box, n + 1);
    for (uint32_t k = 0; k < n; k++) {
        uint32_t i = w->order[k];
        bool fixed = w->bodies.type[s->row[i]] != PHYS_DYNAMIC;
        box[k] = (sweep_box){s->x0[i], s->x1[i], s->y0[i], s->y1[i], s->z0[i], s->z1[i], i, fixed};
    }
    w->pairs.count = 0;
    for (uint32_t i = 0; i < n; i++) {
        const sweep_box a = box[i];
        for (uint32_t j = i + 1; j < n && box[j].x0 <= a.x1; j++) {
            const sweep_box *b = &box[j];
            bool apart = (a.y0 > b->y1) | (b->y0 > a.y1) | (a.z0 > b->z1) | (b->z0 > a.z1);
            if (!apart && !(a.fixed & b->fixed) && phys_pair_wanted(w, a.row, b->row)) {
                phys_pair_push(&w->pairs, CORE_MIN(a.row, b->row), CORE_MAX(a.row, b->row));
            }
        }
    }
    core_arena_rewind(&w->scratch, mark);
}

const phys_broad_method phys_broad_brute = {"brute", brute_find, false};
const phys_broad_method phys_broad_sap = {"sap", sap_find, false};
