// Islands: bodies that touch each other, directly or through others. An island at rest sleeps as a
// whole; one that is hard to solve (heavy on light, a slender tower) gets more substeps than the
// rest of the world.
#include "phys/world.h"

#include <string.h>

// A body is at rest when it takes longer than 0.5 s to leave a place and direction by this much; an
// island of such bodies sleeps. A bound on the way, not on speed: 1 cm/s goes on, trembling does
// not count.
#define REST_DISTANCE 0.0015f   // m
#define REST_COSINE   0.999997f // of half an angle of 0.005 rad
#define REST_TIME     0.5f

// Substeps over the solver's default by level, and what leads there.
#define HEAVY_RATIO      30.0f // mass of one body over that of another it touches
#define VERY_HEAVY_RATIO 300.0f
#define SLENDER_RATIO    4.0f // height over width along gravity
#define SLENDER_BODIES   8u
#define CHAIN_JOINTS     16u // trees of at least as many joints: they swing and whip
// Substeps of a chain over the fastest turning that it has to follow, 1/(s/s). Its links tremble
// with the tension: a link under tension T, with arms r and a moment of inertia I, at the rate
// sqrt(2 T r / I); a substep longer than about 1 over that feeds the trembling.
#define CHAIN_SUBSTEPS 0.5f
#define CHAIN_MANY     8u // shorter ones cost too little to save substeps

// Joints of a body: how many, whether all are plain ball joints, tension times arm (N m).
typedef struct hold {
    uint32_t joints, count, anchors; // count: those on this body, `joints` those it comes first in
    float pull;
    bool other, bars; // some joint is no plain ball joint; is no rod
} hold;

typedef struct island {
    core_vec3 lo, hi;
    float ratio, rate; // rate: squared, 1/s^2
    uint32_t count, joints, anchors;
    bool restless, touched, branched, bars;
    uint8_t level;
} island;

static uint32_t find_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b) { // the lower row leads
    a = find_root(parent, a);
    b = find_root(parent, b);
    parent[CORE_MAX(a, b)] = CORE_MIN(a, b);
}

void phys_wake_row(phys_world *w, uint32_t row) {
    phys_bodies *b = &w->bodies;
    b->still[row] = 0.0f;
    b->flags[row] &= (uint16_t)~PHYS_BODY_CREEPS;
    if ((b->flags[row] & PHYS_BODY_ASLEEP) == 0) {
        return;
    }
    uint32_t id = b->sleep_island[row];
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        if ((b->flags[i] & PHYS_BODY_ASLEEP) && b->sleep_island[i] == id) {
            b->flags[i] &= (uint16_t) ~(PHYS_BODY_ASLEEP | PHYS_BODY_CREEPS);
            b->still[i] = 0.0f;
        }
    }
}

void phys_wake_all(phys_world *w) {
    phys_bodies *b = &w->bodies;
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        b->flags[i] &= (uint16_t) ~(PHYS_BODY_ASLEEP | PHYS_BODY_CREEPS);
        b->still[i] = 0.0f;
    }
    phys_cloths_wake(w);
}

// A touch by something that moves wakes.
static void wake_touched(phys_world *w, uint32_t a, uint32_t b) {
    if (phys_moves(&w->bodies, a) && (w->bodies.flags[b] & PHYS_BODY_ASLEEP)) {
        phys_wake_row(w, b);
    } else if (phys_moves(&w->bodies, b) && (w->bodies.flags[a] & PHYS_BODY_ASLEEP)) {
        phys_wake_row(w, a);
    }
}

static void wake_by_touch(phys_world *w) {
    phys_joints_wake(w);
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        if (w->balls.separation[i] < PHYS_APART) {
            wake_touched(w, w->balls.a[i], w->balls.b[i]);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        if (w->contacts.manifold[i].count != 0) {
            wake_touched(w, w->contacts.a[i], w->contacts.b[i]);
        }
    }
}

// Slow enough to be on its way for REST_TIME without leaving the place.
static bool creeps(const phys_bodies *b, uint32_t i) {
    core_vec3 v = phys_get3(b->vx, b->vy, b->vz, i);
    const float limit = 2.0f * REST_DISTANCE / REST_TIME;
    return core_v3_dot(v, v) < limit * limit;
}

static void watch_rest(phys_bodies *b, uint32_t i, float dt) {
    core_vec3 d = core_v3_sub(phys_get3(b->cx, b->cy, b->cz, i), b->rest_place[i]);
    core_quat q = phys_body_quat(b, i), r = b->rest_turn[i];
    float cosine = q.x * r.x + q.y * r.y + q.z * r.z + q.w * r.w;
    if (core_v3_dot(d, d) > REST_DISTANCE * REST_DISTANCE || core_absf(cosine) < REST_COSINE) {
        bool slow = b->still[i] >= REST_TIME && creeps(b, i);
        b->flags[i] =
            (uint16_t)((b->flags[i] & ~PHYS_BODY_CREEPS) | (slow ? PHYS_BODY_CREEPS : 0u));
        b->rest_place[i] = phys_get3(b->cx, b->cy, b->cz, i);
        b->rest_turn[i] = q;
        b->still[i] = 0.0f;
    } else {
        b->still[i] += dt;
    }
}

static bool rests(const phys_bodies *b, uint32_t i) {
    return b->still[i] >= REST_TIME || ((b->flags[i] & PHYS_BODY_CREEPS) && creeps(b, i));
}

static void note_pair(const phys_bodies *b, uint32_t *parent, float *ratio, uint32_t i,
                      uint32_t j) {
    if (!phys_mobile(b, i) || !phys_mobile(b, j)) {
        return;
    }
    join(parent, i, j);
    float r = b->im[i] > b->im[j] ? b->im[i] / b->im[j] : b->im[j] / b->im[i];
    ratio[i] = CORE_MAX(ratio[i], r);
}

static void note_hold(const phys_world *w, hold *h, uint32_t joint, bool on_b) {
    const phys_joints *j = &w->joints;
    core_vec3 arm = on_b ? j->lb[joint] : j->la[joint];
    bool plain = j->cone[joint] <= 0.0f && j->hertz[joint] <= 0.0f && j->damping[joint] <= 0.0f &&
                 (j->flags[joint] & (PHYS_JOINT_LIMITED | PHYS_JOINT_DRIVEN)) == 0;
    h->count++;
    h->pull += core_v3_length(j->force[joint]) * core_v3_length(arm);
    h->other |= j->type[joint] != PHYS_JOINT_BALL || !plain;
    h->bars |= j->type[joint] != PHYS_JOINT_DISTANCE || !plain;
}

static void gather_joints(phys_world *w, uint32_t *parent, hold *holds) {
    for (uint32_t i = 0; i < core_columns_count(&w->joints.set); i++) {
        uint32_t a = phys_joint_body(&w->bodies.set, w->joints.a[i]);
        uint32_t b = phys_joint_body(&w->bodies.set, w->joints.b[i]);
        bool ma = a != CORE_NO_ROW && phys_mobile(&w->bodies, a);
        bool mb = b != CORE_NO_ROW && phys_mobile(&w->bodies, b);
        if (ma) {
            note_hold(w, &holds[a], i, false);
        }
        if (mb) {
            note_hold(w, &holds[b], i, true);
        }
        if (ma && mb) {
            join(parent, a, b); // trees are exact at any ratio of masses
            holds[a].joints++;
        } else if (ma || mb) {
            holds[ma ? a : b].anchors++;
        }
    }
}

static void gather_pairs(phys_world *w, uint32_t *parent, float *ratio, hold *holds) {
    gather_joints(w, parent, holds);
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        if (!w->balls.fixed[i] && w->balls.separation[i] < PHYS_APART) {
            note_pair(&w->bodies, parent, ratio, w->balls.a[i], w->balls.b[i]);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        if (w->contacts.manifold[i].count != 0) {
            note_pair(&w->bodies, parent, ratio, w->contacts.a[i], w->contacts.b[i]);
        }
    }
}

// One path of ball joints, held by one end at most: solved as a chain.
static bool is_chain(const island *s) {
    return s->joints + s->anchors != 0 && !s->branched && s->joints < s->count && s->anchors <= 1;
}

// Rods with loops that touch nothing.
static bool is_net(const island *s) { return !s->bars && s->joints >= s->count && !s->touched; }

static uint8_t chain_level(const phys_world *w, const island *s, float dt) {
    float substeps = CHAIN_SUBSTEPS * dt * core_sqrtf(s->rate);
    float usual = (float)w->solver->substeps;
    if (substeps > usual) {
        return substeps <= 2.0f * usual ? PHYS_LEVEL_MORE : PHYS_LEVEL_MOST;
    }
    bool few = substeps <= 0.5f * usual && s->joints >= CHAIN_MANY;
    return few ? PHYS_LEVEL_FEW : PHYS_LEVEL_DEFAULT;
}

int phys_level_substeps(const phys_world *w, uint32_t level) {
    static const int halves[PHYS_LEVELS] = {2, 4, 8, 1, 3};
    return w->substeps ? w->substeps : CORE_MAX(w->solver->substeps * halves[level] / 2, 1);
}

static uint8_t island_level(const phys_world *w, const island *s, float dt) {
    if (is_chain(s) && !s->touched && !w->joints_iterate) {
        return chain_level(w, s, dt);
    }
    if (is_net(s)) {
        return PHYS_LEVEL_NET;
    }
    if (s->ratio > VERY_HEAVY_RATIO) {
        return PHYS_LEVEL_MOST;
    }
    core_vec3 size = core_v3_sub(s->hi, s->lo);
    core_vec3 up = phys_unit(w->gravity, core_v3(0, 0, 0));
    float height = core_absf(core_v3_dot(size, phys_abs3(up)));
    core_vec3 flat = core_v3_sub(size, core_v3_scale(phys_abs3(up), height));
    bool slender = s->count >= SLENDER_BODIES && height > SLENDER_RATIO * core_v3_length(flat);
    bool chain = s->joints >= CHAIN_JOINTS && s->joints < s->count;
    return s->ratio > HEAVY_RATIO || slender || chain ? PHYS_LEVEL_MORE : PHYS_LEVEL_DEFAULT;
}

static void put_to_sleep(phys_bodies *b, uint32_t i, uint32_t id) {
    b->flags[i] |= PHYS_BODY_ASLEEP;
    b->sleep_island[i] = id;
    phys_put3(b->vx, b->vy, b->vz, i, core_v3(0, 0, 0));
    phys_put3(b->wx, b->wy, b->wz, i, core_v3(0, 0, 0));
}

// The rate at which a body turns or could tremble.
static void note_turning(const phys_bodies *b, uint32_t i, const hold *h, island *s) {
    core_vec3 turn = phys_get3(b->wx, b->wy, b->wz, i);
    float inverse = CORE_MAX(CORE_MAX(b->ix[i], b->iy[i]), b->iz[i]);
    s->rate = CORE_MAX(s->rate, h->pull * inverse + core_v3_dot(turn, turn));
    s->joints += h->joints;
    s->anchors += h->anchors;
    s->branched |= h->count > 2 || h->other;
    s->bars |= h->bars;
}

// Sums up islands by their leading rows. Returns how many there are.
static uint32_t sum_islands(const phys_world *w, uint32_t *parent, const float *ratio,
                            const hold *holds, island *sum, uint32_t n) {
    const phys_bodies *b = &w->bodies;
    uint32_t islands = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!phys_mobile(b, i)) {
            continue;
        }
        uint32_t root = find_root(parent, i);
        core_vec3 p = phys_get3(b->cx, b->cy, b->cz, i);
        if (root == i) {
            sum[i] = (island){.lo = p, .hi = p};
            islands++;
        }
        island *s = &sum[root];
        s->lo = core_v3(CORE_MIN(s->lo.x, p.x), CORE_MIN(s->lo.y, p.y), CORE_MIN(s->lo.z, p.z));
        s->hi = core_v3(CORE_MAX(s->hi.x, p.x), CORE_MAX(s->hi.y, p.y), CORE_MAX(s->hi.z, p.z));
        s->ratio = CORE_MAX(s->ratio, ratio[i]);
        s->restless |= !rests(b, i);
        s->count++;
        s->touched |= b->touching[i] != 0;
        note_turning(b, i, &holds[i], s);
    }
    return islands;
}

// After the narrow phase: wakes, watches, puts to sleep, and sets each body's level of substeps.
void phys_islands_update(phys_world *w, float dt) {
    phys_bodies *b = &w->bodies;
    uint32_t n = core_columns_count(&b->set);
    bool sleeps = w->sleep && w->solver->sleeps, levels = w->substeps == 0 && w->solver->sleeps;
    w->islands = 0;
    memset(w->level_islands, 0, sizeof w->level_islands);
    if (!sleeps && !levels) {
        memset(b->level, 0, n);
        return;
    }
    if (sleeps) {
        wake_by_touch(w);
        for (uint32_t i = 0; i < n; i++) {
            if (phys_mobile(b, i)) {
                watch_rest(b, i, dt);
            }
        }
    }
    size_t mark = core_arena_mark(&w->scratch);
    uint32_t *parent = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n + 1);
    float *ratio = CORE_ARENA_ARRAY(&w->scratch, float, n + 1);
    hold *holds = CORE_ARENA_ARRAY(&w->scratch, hold, n + 1);
    island *sum = CORE_ARENA_ARRAY(&w->scratch, island, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        parent[i] = i;
        ratio[i] = 1.0f;
        holds[i] = (hold){0};
    }
    gather_pairs(w, parent, ratio, holds);
    w->islands = sum_islands(w, parent, ratio, holds, sum, n);
    for (uint32_t i = 0; i < n; i++) {
        if (!phys_mobile(b, i)) {
            continue;
        }
        uint32_t root = find_root(parent, i);
        island *s = &sum[root];
        if (root == i) { // before any other of the island: the lowest row leads
            bool rests = sleeps && !s->restless;
            s->level = rests    ? PHYS_LEVELS // marked: flags are read until all are looked at
                       : levels ? island_level(w, s, dt)
                                : PHYS_LEVEL_DEFAULT;
            if (!rests) {
                w->level_islands[s->level]++;
            }
        }
        b->level[i] = s->level;
    }
    for (uint32_t i = 0; i < n; i++) {
        if (b->level[i] == PHYS_LEVELS) {
            b->level[i] = 0;
            put_to_sleep(b, i, phys_row_slot(&b->set, find_root(parent, i)));
        }
    }
    core_arena_rewind(&w->scratch, mark);
}
