// Broad phase over two box trees: one of what stands still, one of what moves. A tree is a complete
// binary tree over blocks of shapes in Morton order (Lauterbach et al., "Fast BVH construction on
// GPUs", 2009): sorted now and then, refitted otherwise. Only shapes that left their grown bounds
// ask for new partners; pairs live until the grown bounds part.
#include "phys/world.h"

#include <string.h>

#define TREE_BLOCK  4u  // shapes a leaf
#define TREE_RESORT 64u // refits after which the order is made anew

static void node_empty(phys_box *b) {
    *b = (phys_box){{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}};
}

static phys_box shape_box(const phys_shapes *s, uint32_t i) {
    return (phys_box){{s->x0[i], s->y0[i], s->z0[i]}, {s->x1[i], s->y1[i], s->z1[i]}};
}

static void box_add(phys_box *b, const phys_box *o) {
    for (int k = 0; k < 3; k++) {
        b->lo[k] = CORE_MIN(b->lo[k], o->lo[k]);
        b->hi[k] = CORE_MAX(b->hi[k], o->hi[k]);
    }
}

static bool box_meets(const phys_box *a, const phys_box *b) {
    return !((a->lo[0] > b->hi[0]) | (b->lo[0] > a->hi[0]) | (a->lo[1] > b->hi[1]) |
             (b->lo[1] > a->hi[1]) | (a->lo[2] > b->hi[2]) | (b->lo[2] > a->hi[2]));
}

static uint32_t spread(uint32_t x) { // ten bits to every third place
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

static uint32_t cell(float at, float lo, float scale) {
    float c = (at - lo) * scale;
    return (uint32_t)CORE_CLAMP(c, 0.0f, 1023.0f);
}

static void tree_room(phys_tree *t, uint32_t n) {
    if (n <= t->capacity) {
        return;
    }
    uint32_t grown = CORE_MAX(n, t->capacity * 2), leaves = 1;
    while (leaves * TREE_BLOCK < grown) {
        leaves *= 2;
    }
    core_free(t->order);
    core_free(t->node);
    t->capacity = leaves * TREE_BLOCK;
    t->order = core_alloc(t->capacity * sizeof(uint32_t));
    t->node = core_alloc(2 * (size_t)leaves * sizeof(phys_box));
}

typedef struct keyed {
    uint32_t key, row;
} keyed;

static void sort_keyed(keyed *a, keyed *b, uint32_t n) { // stable, by 3 rounds of 10 bits
    for (int shift = 0; shift < 30; shift += 10) {
        uint32_t count[1025] = {0};
        for (uint32_t i = 0; i < n; i++) {
            count[(a[i].key >> shift & 1023u) + 1]++;
        }
        for (int k = 0; k < 1024; k++) {
            count[k + 1] += count[k];
        }
        for (uint32_t i = 0; i < n; i++) {
            b[count[a[i].key >> shift & 1023u]++] = a[i];
        }
        keyed *swap = a;
        a = b;
        b = swap;
    }
}

// Sorts the tree's rows (in t->order) along the Morton curve of their centres.
static void tree_sort(phys_world *w, phys_tree *t) {
    const phys_shapes *s = &w->shapes;
    size_t mark = core_arena_mark(&w->scratch);
    keyed *a = CORE_ARENA_ARRAY(&w->scratch, keyed, t->count + 1);
    keyed *b = CORE_ARENA_ARRAY(&w->scratch, keyed, t->count + 1);
    phys_box all;
    node_empty(&all);
    for (uint32_t k = 0; k < t->count; k++) {
        phys_box box = shape_box(s, t->order[k]);
        for (int i = 0; i < 3; i++) {
            box.lo[i] = box.hi[i] = 0.5f * (box.lo[i] + box.hi[i]);
        }
        box_add(&all, &box);
    }
    float scale[3];
    for (int i = 0; i < 3; i++) {
        scale[i] = 1023.0f / CORE_MAX(all.hi[i] - all.lo[i], 1e-6f);
    }
    for (uint32_t k = 0; k < t->count; k++) {
        phys_box box = shape_box(s, t->order[k]);
        uint32_t c[3];
        for (int i = 0; i < 3; i++) {
            c[i] = cell(0.5f * (box.lo[i] + box.hi[i]), all.lo[i], scale[i]);
        }
        a[k] = (keyed){spread(c[0]) << 2 | spread(c[1]) << 1 | spread(c[2]), t->order[k]};
    }
    sort_keyed(a, b, t->count);
    for (uint32_t k = 0; k < t->count; k++) {
        t->order[k] = b[k].row;
    }
    core_arena_rewind(&w->scratch, mark);
}

// Node 1 is the root, nodes [leaves, 2 leaves) hold TREE_BLOCK rows each.
static void tree_refit(const phys_world *w, phys_tree *t) {
    t->leaves = 1;
    while (t->leaves * TREE_BLOCK < t->count) {
        t->leaves *= 2;
    }
    for (uint32_t k = 0; k < t->leaves; k++) {
        phys_box *node = &t->node[t->leaves + k];
        node_empty(node);
        uint32_t end = CORE_MIN((k + 1) * TREE_BLOCK, t->count);
        for (uint32_t i = k * TREE_BLOCK; i < end; i++) {
            phys_box box = shape_box(&w->shapes, t->order[i]);
            box_add(node, &box);
        }
    }
    for (uint32_t k = t->leaves; k-- > 1;) {
        t->node[k] = t->node[2 * k];
        box_add(&t->node[k], &t->node[2 * k + 1]);
    }
}

static void tree_fill(phys_world *w, phys_tree *t, bool fixed) {
    uint32_t n = core_columns_count(&w->shapes.set);
    tree_room(t, n + 1);
    t->count = 0;
    for (uint32_t i = 0; i < n; i++) {
        if ((w->bodies.type[w->shapes.row[i]] == PHYS_STATIC) == fixed) {
            t->order[t->count++] = i;
        }
    }
    tree_sort(w, t);
    t->age = 0;
}

// Brings both trees up to date with the shapes' bounds.
void phys_tree_update(phys_world *w) {
    bool moved_fixed = false, moved_any = false;
    for (uint32_t i = 0; i < core_columns_count(&w->shapes.set); i++) {
        bool fixed = w->bodies.type[w->shapes.row[i]] == PHYS_STATIC;
        moved_fixed |= w->shapes.moved[i] && fixed;
        moved_any |= w->shapes.moved[i] && !fixed;
    }
    if (w->trees_stale || moved_fixed) {
        tree_fill(w, &w->fixed_tree, true);
        tree_refit(w, &w->fixed_tree);
    }
    if (w->trees_stale || w->moving_tree.age >= TREE_RESORT) {
        tree_fill(w, &w->moving_tree, false);
        moved_any = true;
    }
    if (moved_any) {
        tree_refit(w, &w->moving_tree);
        w->moving_tree.age++;
    }
    w->trees_stale = false;
}

uint32_t phys_tree_query(const phys_world *w, const phys_tree *t, const phys_box *box,
                         uint32_t *out, uint32_t capacity) {
    uint32_t stack[64], depth = 0, n = 0;
    if (t->count == 0) {
        return 0;
    }
    stack[depth++] = 1;
    while (depth != 0) {
        uint32_t k = stack[--depth];
        if (!box_meets(&t->node[k], box)) {
            continue;
        }
        if (k < t->leaves) {
            stack[depth++] = 2 * k + 1;
            stack[depth++] = 2 * k;
            continue;
        }
        uint32_t first = (k - t->leaves) * TREE_BLOCK;
        uint32_t end = CORE_MIN(first + TREE_BLOCK, t->count);
        for (uint32_t i = first; i < end; i++) {
            phys_box other = shape_box(&w->shapes, t->order[i]);
            if (box_meets(&other, box)) {
                if (n < capacity) {
                    out[n] = t->order[i];
                }
                n++;
            }
        }
    }
    return n;
}

// Partners of row i. Both of a pair may have moved: the lower row then tells.
static void find_partners(phys_world *w, const phys_tree *t, uint32_t i, uint32_t *found,
                          uint32_t room) {
    const phys_shapes *s = &w->shapes;
    phys_box box = shape_box(s, i);
    uint32_t n = phys_tree_query(w, t, &box, found, room);
    for (uint32_t k = 0; k < n; k++) {
        uint32_t j = found[k];
        if (j != i && !(s->moved[j] && j < i) && phys_pair_wanted(w, i, j)) {
            phys_pair_push(&w->pairs, CORE_MIN(i, j), CORE_MAX(i, j));
        }
    }
}

static void tree_find(phys_world *w) {
    const phys_shapes *s = &w->shapes;
    uint32_t n = core_columns_count(&s->set);
    size_t mark = core_arena_mark(&w->scratch);
    uint32_t *found = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n + 1);
    phys_tree_update(w);
    w->pairs.count = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!s->moved[i] || !phys_meets_some(w, s->row[i])) {
            continue;
        }
        find_partners(w, &w->moving_tree, i, found, n);
        if (w->bodies.type[s->row[i]] != PHYS_STATIC) {
            find_partners(w, &w->fixed_tree, i, found, n);
        }
    }
    core_arena_rewind(&w->scratch, mark);
}

void phys_trees_release(phys_world *w) {
    core_free(w->fixed_tree.order);
    core_free(w->fixed_tree.node);
    core_free(w->moving_tree.order);
    core_free(w->moving_tree.node);
}

const phys_broad_method phys_broad_tree = {"tree", tree_find, true};
