// Which pairs of shapes are near each other: the pair map, and the birth and death of contacts.
#include "phys/world.h"

#include <string.h>

CORE_COLUMNS_DEFINE(phys_balls, PHYS_BALL_COLUMNS)
CORE_COLUMNS_DEFINE(phys_contacts, PHYS_CONTACT_COLUMNS)

void phys_pair_push(phys_pair_list *list, uint32_t a, uint32_t b) {
    if (list->count == list->capacity) {
        uint32_t grown = CORE_MAX(list->capacity / 4 * 5, 256u);
        list->pair =
            core_realloc(list->pair, list->capacity * sizeof(phys_pair), grown * sizeof(phys_pair));
        list->capacity = grown;
    }
    list->pair[list->count++] = (phys_pair){a, b};
}

static bool boxes_meet(const phys_shapes *s, uint32_t i, uint32_t j) {
    return s->x0[i] <= s->x1[j] && s->x0[j] <= s->x1[i] && s->y0[i] <= s->y1[j] &&
           s->y0[j] <= s->y1[i] && s->z0[i] <= s->z1[j] && s->z0[j] <= s->z1[i];
}

// Whether two balls can meet inside of their bounds. Their centres keep within bounds less the
// radius: a third of the boxes that meet, at an edge or a corner, hold balls that cannot. r: sum
// of the radii.
static bool balls_meet(const phys_shapes *s, uint32_t i, uint32_t j, float r) {
    float x = CORE_MAX(s->x0[i] - s->x1[j], s->x0[j] - s->x1[i]) + r;
    float y = CORE_MAX(s->y0[i] - s->y1[j], s->y0[j] - s->y1[i]) + r;
    float z = CORE_MAX(s->z0[i] - s->z1[j], s->z0[j] - s->z1[i]) + r;
    x = CORE_MAX(x, 0.0f);
    y = CORE_MAX(y, 0.0f);
    z = CORE_MAX(z, 0.0f);
    return x * x + y * y + z * z <= r * r;
}

static bool in_reach(const phys_shapes *s, uint32_t i, uint32_t j) {
    bool balls = s->type[i] == PHYS_SPHERE && s->type[j] == PHYS_SPHERE;
    return balls ? balls_meet(s, i, j, s->radius[i] + s->radius[j]) : boxes_meet(s, i, j);
}

void phys_layers_update(phys_world *w) {
    w->layers = 0;
    for (uint32_t i = 0; i < core_columns_count(&w->bodies.set); i++) {
        w->layers |= w->bodies.shape[i] != 0 ? 1u << w->bodies.layer[i] : 0;
    }
}

bool phys_pair_wanted(const phys_world *w, uint32_t a, uint32_t b) {
    uint32_t ra = w->shapes.row[a], rb = w->shapes.row[b];
    const uint8_t *type = w->bodies.type, *layer = w->bodies.layer;
    return ra != rb && (type[ra] == PHYS_DYNAMIC || type[rb] == PHYS_DYNAMIC) &&
           (w->rule[layer[ra]] >> layer[rb] & 1u) != 0 && !phys_joints_part(w, ra, rb);
}

static uint64_t pair_key(uint32_t slot_a, uint32_t slot_b) {
    return slot_a < slot_b ? (uint64_t)slot_a << 32 | slot_b : (uint64_t)slot_b << 32 | slot_a;
}

static uint32_t home(const phys_pair_map *m, uint64_t key) {
    uint64_t x = key * 0x9e3779b97f4a7c15u;
    return (uint32_t)(x >> 32) & (m->capacity - 1);
}

// Index of the key, or of the empty place where it would go.
static uint32_t map_find(const phys_pair_map *m, uint64_t key) {
    uint32_t i = home(m, key);
    while (m->key[i] != 0 && m->key[i] != key) {
        i = (i + 1) & (m->capacity - 1);
    }
    return i;
}

static void map_grow(phys_pair_map *m) {
    phys_pair_map old = *m;
    m->capacity = old.capacity ? old.capacity * 2 : 1024;
    m->key = core_alloc(m->capacity * sizeof(uint64_t));
    m->value = core_alloc(m->capacity * sizeof(uint32_t));
    for (uint32_t i = 0; i < old.capacity; i++) {
        if (old.key[i] != 0) {
            uint32_t at = map_find(m, old.key[i]);
            m->key[at] = old.key[i];
            m->value[at] = old.value[i];
        }
    }
    core_free(old.key);
    core_free(old.value);
}

static void map_add(phys_pair_map *m, uint64_t key, uint32_t value) {
    if (m->count + 1 > m->capacity / 4 * 3) {
        map_grow(m);
    }
    uint32_t i = map_find(m, key);
    m->key[i] = key;
    m->value[i] = value;
    m->count++;
}

// Backward-shift deletion (Knuth, TAOCP 3, 6.4, algorithm R): no tombstones.
static void map_remove(phys_pair_map *m, uint64_t key) {
    uint32_t mask = m->capacity - 1, hole = map_find(m, key);
    for (uint32_t i = (hole + 1) & mask; m->key[i] != 0; i = (i + 1) & mask) {
        uint32_t h = home(m, m->key[i]);
        if (((i - h) & mask) >= ((i - hole) & mask)) {
            m->key[hole] = m->key[i];
            m->value[hole] = m->value[i];
            hole = i;
        }
    }
    m->key[hole] = 0;
    m->count--;
}

// A ball: round about its centre of mass, so that contacts have no arm but the radius.
static bool is_ball(const phys_world *w, uint32_t shape) {
    const phys_shapes *s = &w->shapes;
    return s->type[shape] == PHYS_SPHERE && s->next[shape] == 0 &&
           w->bodies.locks[s->row[shape]] == 0 &&
           (w->bodies.flags[s->row[shape]] & PHYS_BODY_ISOTROPIC) != 0 &&
           w->bodies.shape[s->row[shape]] == phys_row_slot(&s->set, shape);
}

uint32_t phys_ball_row_add(phys_world *w, uint32_t sa, uint32_t sb) {
    const phys_shapes *s = &w->shapes;
    uint32_t first = phys_slot_row(&s->set, sa), second = phys_slot_row(&s->set, sb);
    core_handle h = core_columns_add(&w->balls.set);
    uint32_t i = core_columns_count(&w->balls.set) - 1;
    bool fixed = w->bodies.type[s->row[second]] != PHYS_DYNAMIC;
    w->balls.fixed[i] = fixed;
    w->balls.reach[i] = fixed ? PHYS_APART : s->radius[first] + s->radius[second];
    w->balls.a[i] = s->row[first];
    w->balls.b[i] = s->row[second];
    w->balls.sa[i] = sa;
    w->balls.sb[i] = sb;
    w->balls.stamp[i] = w->stamp;
    phys_material m =
        phys_mix_materials(w, phys_shape_material(s, first), phys_shape_material(s, second));
    w->balls.friction[i] = m.friction;
    w->balls.restitution[i] = m.restitution;
    w->balls.rolling[i] = m.rolling;
    return h.index;
}

uint32_t phys_contact_row_add(phys_world *w, uint32_t sa, uint32_t sb) {
    const phys_shapes *s = &w->shapes;
    uint32_t first = phys_slot_row(&s->set, sa), second = phys_slot_row(&s->set, sb);
    core_handle h = core_columns_add(&w->contacts.set);
    uint32_t i = core_columns_count(&w->contacts.set) - 1;
    w->contacts.a[i] = s->row[first];
    w->contacts.b[i] = s->row[second];
    w->contacts.sa[i] = sa;
    w->contacts.sb[i] = sb;
    w->contacts.stamp[i] = w->stamp;
    phys_material m =
        phys_mix_materials(w, phys_shape_material(s, first), phys_shape_material(s, second));
    w->contacts.friction[i] = m.friction;
    w->contacts.restitution[i] = m.restitution;
    return h.index;
}

enum { KIND_POINTS, KIND_BALL, KIND_MESH };

static void contact_add(phys_world *w, uint32_t slot_a, uint32_t slot_b) {
    const phys_shapes *s = &w->shapes;
    uint32_t a = phys_slot_row(&s->set, slot_a), b = phys_slot_row(&s->set, slot_b);
    bool swap = s->type[a] > s->type[b] ||
                (s->type[a] == s->type[b] && w->bodies.type[s->row[a]] != PHYS_DYNAMIC);
    uint32_t first = swap ? b : a, second = swap ? a : b;
    uint32_t sa = phys_row_slot(&s->set, first), sb = phys_row_slot(&s->set, second);
    bool ball = w->bodies.type[s->row[first]] == PHYS_DYNAMIC && is_ball(w, first) &&
                (w->bodies.type[s->row[second]] == PHYS_STATIC || is_ball(w, second));
    uint32_t value = s->type[second] == PHYS_MESH
                         ? phys_mesh_pair_add(w, sa, sb, ball) << 2 | KIND_MESH
                     : ball ? phys_ball_row_add(w, sa, sb) << 2 | KIND_BALL
                            : phys_contact_row_add(w, sa, sb) << 2 | KIND_POINTS;
    map_add(&w->map, pair_key(slot_a, slot_b), value);
}

static bool on_mesh(const phys_world *w, uint32_t shape_slot) {
    return w->shapes.type[phys_slot_row(&w->shapes.set, shape_slot)] == PHYS_MESH;
}

static void ball_remove(phys_world *w, uint32_t row, phys_event_list *events) {
    phys_balls *c = &w->balls;
    if (c->touch[row]) {
        phys_events_contact_end(w, events, c->sa[row], c->sb[row]);
    }
    map_remove(&w->map, pair_key(c->sa[row], c->sb[row]));
    core_columns_remove(&c->set, core_columns_handle(&c->set, row), NULL, NULL);
}

static void manifold_remove(phys_world *w, uint32_t row, phys_event_list *events) {
    phys_contacts *c = &w->contacts;
    if (c->touch[row]) {
        phys_events_contact_end(w, events, c->sa[row], c->sb[row]);
    }
    map_remove(&w->map, pair_key(c->sa[row], c->sb[row]));
    core_columns_remove(&c->set, core_columns_handle(&c->set, row), NULL, NULL);
}

static void mesh_pair_remove(phys_world *w, uint32_t row, phys_event_list *events) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    if (p->touch[row]) {
        phys_events_contact_end(w, events, p->sa[row], p->sb[row]);
    }
    map_remove(&w->map, pair_key(p->sa[row], p->sb[row]));
    phys_mesh_pair_remove(w, row);
}

// Bottom-up merge sort of keys: no allocation, one order.
static void sort_keys(uint64_t *key, uint64_t *tmp, uint32_t n) {
    for (uint32_t width = 1; width < n; width *= 2) {
        for (uint32_t lo = 0; lo < n; lo += 2 * width) {
            uint32_t mid = CORE_MIN(lo + width, n), hi = CORE_MIN(lo + 2 * width, n);
            uint32_t i = lo, j = mid;
            for (uint32_t k = lo; k < hi; k++) {
                tmp[k] = i < mid && (j >= hi || key[i] <= key[j]) ? key[i++] : key[j++];
            }
        }
        memcpy(key, tmp, n * sizeof *key);
    }
}

// reach: of balls, PHYS_APART: neither. Whether a pair lives on: named by a full broad phase, or,
// for a partial one, not parted.
static bool pair_lives(const phys_world *w, uint32_t sa, uint32_t sb, uint32_t stamp, float reach) {
    const phys_shapes *s = &w->shapes;
    if (!w->broad->partial) {
        return stamp == w->stamp &&
               in_reach(s, phys_slot_row(&s->set, sa), phys_slot_row(&s->set, sb));
    }
    uint32_t i = phys_slot_row(&s->set, sa), j = phys_slot_row(&s->set, sb);
    if (w->pairs_stale && !phys_pair_wanted(w, i, j)) {
        return false;
    }
    return reach < PHYS_APART ? balls_meet(s, i, j, reach) : boxes_meet(s, i, j);
}

static void remove_parted(phys_world *w) {
    for (uint32_t i = core_columns_count(&w->mesh_pairs.set); i-- > 0;) {
        if (!pair_lives(w, w->mesh_pairs.sa[i], w->mesh_pairs.sb[i], w->mesh_pairs.stamp[i],
                        PHYS_APART)) {
            mesh_pair_remove(w, i, &w->events);
        }
    }
    for (uint32_t i = core_columns_count(&w->balls.set); i-- > 0;) {
        if (!pair_lives(w, w->balls.sa[i], w->balls.sb[i], w->balls.stamp[i], w->balls.reach[i]) &&
            !on_mesh(w, w->balls.sb[i])) {
            ball_remove(w, i, &w->events);
        }
    }
    for (uint32_t i = core_columns_count(&w->contacts.set); i-- > 0;) {
        if (!pair_lives(w, w->contacts.sa[i], w->contacts.sb[i], w->contacts.stamp[i],
                        PHYS_APART) &&
            !on_mesh(w, w->contacts.sb[i])) {
            manifold_remove(w, i, &w->events);
        }
    }
}

// Births are sorted by pair, so that rows do not depend on which broad phase found them.
void phys_pairs_update(phys_world *w) {
    size_t mark = core_arena_mark(&w->scratch);
    uint64_t *fresh = CORE_ARENA_ARRAY(&w->scratch, uint64_t, w->pairs.count + 1);
    uint64_t *tmp = CORE_ARENA_ARRAY(&w->scratch, uint64_t, w->pairs.count + 1);
    uint32_t fresh_count = 0;
    w->stamp++;
    if (w->map.capacity == 0) {
        map_grow(&w->map);
    }
    for (uint32_t i = 0; i < w->pairs.count; i++) {
        uint64_t key = pair_key(phys_row_slot(&w->shapes.set, w->pairs.pair[i].a),
                                phys_row_slot(&w->shapes.set, w->pairs.pair[i].b));
        uint32_t at = map_find(&w->map, key);
        if (w->map.key[at] == 0) {
            fresh[fresh_count] = key;
            fresh_count += in_reach(&w->shapes, w->pairs.pair[i].a, w->pairs.pair[i].b);
            continue;
        }
        uint32_t value = w->map.value[at];
        uint32_t *stamp = (value & 3u) == KIND_BALL   ? w->balls.stamp
                          : (value & 3u) == KIND_MESH ? w->mesh_pairs.stamp
                                                      : w->contacts.stamp;
        const core_columns *set = (value & 3u) == KIND_BALL   ? &w->balls.set
                                  : (value & 3u) == KIND_MESH ? &w->mesh_pairs.set
                                                              : &w->contacts.set;
        stamp[phys_slot_row(set, value >> 2)] = w->stamp;
    }
    if (w->any_moved || !w->broad->partial) {
        remove_parted(w);
    }
    w->pairs_stale = false;
    sort_keys(fresh, tmp, fresh_count);
    for (uint32_t i = 0; i < fresh_count; i++) {
        contact_add(w, (uint32_t)(fresh[i] >> 32), (uint32_t)fresh[i]);
    }
    core_arena_rewind(&w->scratch, mark);
}

static void wake_partners(phys_world *w, uint32_t sa, uint32_t sb) {
    const phys_shapes *s = &w->shapes;
    phys_wake_row(w, phys_slot_row(&w->bodies.set, s->body[phys_slot_row(&s->set, sa)]));
    phys_wake_row(w, phys_slot_row(&w->bodies.set, s->body[phys_slot_row(&s->set, sb)]));
}

void phys_pairs_drop_shape(phys_world *w, uint32_t slot) {
    for (uint32_t i = core_columns_count(&w->mesh_pairs.set); i-- > 0;) {
        if (w->mesh_pairs.sa[i] == slot || w->mesh_pairs.sb[i] == slot) {
            wake_partners(w, w->mesh_pairs.sa[i], w->mesh_pairs.sb[i]);
            mesh_pair_remove(w, i, &w->pending);
        }
    }
    for (uint32_t i = core_columns_count(&w->balls.set); i-- > 0;) {
        if (w->balls.sa[i] == slot || w->balls.sb[i] == slot) {
            wake_partners(w, w->balls.sa[i], w->balls.sb[i]);
            ball_remove(w, i, &w->pending);
        }
    }
    for (uint32_t i = core_columns_count(&w->contacts.set); i-- > 0;) {
        if (w->contacts.sa[i] == slot || w->contacts.sb[i] == slot) {
            wake_partners(w, w->contacts.sa[i], w->contacts.sb[i]);
            manifold_remove(w, i, &w->pending);
        }
    }
}

void phys_pairs_rebuild_map(phys_world *w) {
    w->map.count = 0;
    if (w->map.capacity != 0) {
        memset(w->map.key, 0, w->map.capacity * sizeof(uint64_t));
    }
    for (uint32_t i = 0; i < core_columns_count(&w->mesh_pairs.set); i++) {
        map_add(&w->map, pair_key(w->mesh_pairs.sa[i], w->mesh_pairs.sb[i]),
                phys_row_slot(&w->mesh_pairs.set, i) << 2 | KIND_MESH);
    }
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        if (!on_mesh(w, w->balls.sb[i])) {
            map_add(&w->map, pair_key(w->balls.sa[i], w->balls.sb[i]),
                    phys_row_slot(&w->balls.set, i) << 2 | KIND_BALL);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        if (!on_mesh(w, w->contacts.sb[i])) {
            map_add(&w->map, pair_key(w->contacts.sa[i], w->contacts.sb[i]),
                    phys_row_slot(&w->contacts.set, i) << 2 | KIND_POINTS);
        }
    }
}

void phys_pairs_release(phys_world *w) {
    core_free(w->map.key);
    core_free(w->map.value);
    core_free(w->pairs.pair);
    core_free(w->order);
    core_free(w->events.event);
    core_free(w->pending.event);
}
