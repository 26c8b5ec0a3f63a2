// Last guard against tunnelling, after the solver. Speculative contacts hold a body at the point
// where it will touch, but a body that is spun by such a blow, or deflected, may go on through
// something. So every body that went far is swept once more along the way it really took, and stays
// where its core (the shape less half of its thinnest half width) first meets something. What rests
// or slides never has its core in anything, and slow bodies are not looked at.
#include "phys/mesh_internal.h"

#define CORE_PART 0.5f    // of the thinnest half width is taken off
#define HULL_PART 0.6f    // a hull's core is the hull at this scale about its middle
#define MIDDLE    1e-3f   // m
#define CLEAR     1.2e-3f // m: cores nearer than this at the start go no nearer
#define DEEP      4e-3f   // m
#define SLOW_TURN 0.001f  // rad, half of the angle
#define SLOW_WAY  5e-4f   // m
#define ROUNDS    4

typedef struct guard {
    phys_world *world;
    const core_quat *before; // rotations at the start of the step, by row
    float *stop;             // by row: s into the step; dt: went all the way
    core_vec3 *way;          // by row: m in the step
    float *turn;             // by row: rad in the step, at least
    float dt;
} guard;

static core_vec3 start_center(const guard *g, uint32_t row) {
    const phys_bodies *b = &g->world->bodies;
    core_vec3 lc = phys_get3(b->lcx, b->lcy, b->lcz, row);
    core_vec3 origin = phys_get3(b->px, b->py, b->pz, row);
    if (lc.x == 0.0f && lc.y == 0.0f && lc.z == 0.0f) {
        return origin;
    }
    return core_v3_add(origin, phys_rotate(g->before[row], lc));
}

static core_vec3 way_of(const guard *g, uint32_t row) {
    const phys_bodies *b = &g->world->bodies;
    return core_v3_sub(phys_get3(b->cx, b->cy, b->cz, row), start_center(g, row));
}

// Rotation vector of the step (rad), by the short way round.
static core_vec3 turn_of(const guard *g, uint32_t row) {
    core_quat d = phys_quat_mul(phys_body_quat(&g->world->bodies, row), phys_conj(g->before[row]));
    float sign = d.w < 0.0f ? -1.0f : 1.0f;
    core_vec3 v = core_v3_scale(core_v3(d.x, d.y, d.z), sign);
    float s = core_v3_length(v);
    return s < 1e-6f ? core_v3_scale(v, 2.0f)
                     : core_v3_scale(v, 2.0f * core_atan2f(s, sign * d.w) / s);
}

// Half, but for what is so thin that a sweep, which ends 1 mm short, could not tell.
static float depth_of_core(float half) {
    return CORE_MAX(CORE_PART * half, CORE_MIN(DEEP, 0.99f * half));
}

static float thinnest(const phys_shapes *s, uint32_t i) {
    core_vec3 h = s->half[i];
    float flat = CORE_MIN(h.x, CORE_MIN(h.y, h.z));
    switch (s->type[i]) {
    case PHYS_CYLINDER:
        return CORE_MIN(s->radius[i], h.y);
    case PHYS_BOX:
    case PHYS_HULL:
        return flat;
    default:
        return s->radius[i];
    }
}

static float turning_arm(const phys_shapes *s, uint32_t i) {
    return s->type[i] == PHYS_SPHERE ? core_v3_length(s->position[i]) : phys_shape_extent(s, i);
}

// A way (m) longer than its core is deep.
static bool is_far(const phys_shapes *s, uint32_t i, float way) {
    return way > depth_of_core(thinnest(s, i));
}

// Cheap: asked of every body.
static bool went_far(const guard *g, uint32_t row) {
    const phys_world *w = g->world;
    core_quat p = g->before[row], q = phys_body_quat(&w->bodies, row);
    core_vec3 way = g->way[row] = way_of(g, row);
    float dot = p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w;
    float way2 = core_v3_dot(way, way), sine2 = CORE_MAX(1.0f - dot * dot, 0.0f);
    float turn = g->turn[row] = CORE_PI_F * core_sqrtf(sine2); // at least the angle
    if (!phys_mobile(&w->bodies, row) || !phys_meets_some(w, row) ||
        (way2 < SLOW_WAY * SLOW_WAY && sine2 < SLOW_TURN * SLOW_TURN)) {
        return false;
    }
    for (uint32_t slot = w->bodies.shape[row]; slot != 0;) {
        uint32_t i = phys_slot_row(&w->shapes.set, slot);
        if (is_far(&w->shapes, i, core_sqrtf(way2) + turn * turning_arm(&w->shapes, i))) {
            return true;
        }
        slot = w->shapes.next[i];
    }
    return false;
}

// Whether two shapes went far against each other: what falls side by side did not.
static bool went_apart(const guard *g, uint32_t i, uint32_t row, uint32_t j, uint32_t other) {
    const phys_shapes *s = &g->world->shapes;
    float way = core_v3_length(core_v3_sub(g->way[row], g->way[other]));
    float turns = g->turn[row] * turning_arm(s, i);
    turns += g->turn[other] != 0.0f ? g->turn[other] * turning_arm(s, j) : 0.0f;
    return is_far(s, i, way + turns);
}

// A shape as it moves from time t0 on; once stopped, it stands.
static phys_moving motion(const guard *g, uint32_t shape, uint32_t row, float t0, float stop) {
    const phys_world *w = g->world;
    const phys_shapes *s = &w->shapes;
    bool moves = w->bodies.type[row] != PHYS_STATIC && !(w->bodies.flags[row] & PHYS_BODY_ASLEEP);
    phys_moving m = {.extent = moves ? phys_shape_extent(s, shape) : 0.0f};
    if (!moves) {
        m.geom = phys_shape_geom(w, shape);
        m.center = m.geom.position;
        return m;
    }
    m.center = start_center(g, row);
    m.v = core_v3_scale(way_of(g, row), 1.0f / g->dt);
    m.w = core_v3_scale(turn_of(g, row), 1.0f / g->dt);
    core_vec3 origin = phys_get3(w->bodies.px, w->bodies.py, w->bodies.pz, row);
    core_quat q = g->before[row];
    m.geom = phys_geom_make((phys_shape_type)s->type[shape],
                            core_v3_add(origin, phys_rotate(q, s->position[shape])),
                            phys_quat_mul(q, s->rotation[shape]), s->half[shape], s->radius[shape]);
    if (s->type[shape] == PHYS_HULL) {
        m.geom.hull = &w->hulls[s->hull[shape] - 1].hull;
    }
    float at = CORE_MIN(t0, stop);
    m.geom = phys_moving_at(&m, at);
    m.center = core_v3_mad(m.center, m.v, at);
    if (stop <= t0) {
        m.v = m.w = core_v3(0, 0, 0);
    }
    return m;
}

// Takes the outer half of a shape off. A hull's corners are put on the scratch arena.
static void shrink(const guard *g, phys_geom *geom, phys_geom_hull *room) {
    float thin;
    switch (geom->type) {
    case PHYS_BOX:
        thin = depth_of_core(CORE_MIN(geom->half.x, CORE_MIN(geom->half.y, geom->half.z)));
        geom->half = core_v3_sub(geom->half, core_v3(thin, thin, thin));
        break;
    case PHYS_CYLINDER:
        thin = depth_of_core(CORE_MIN(geom->radius, geom->half_height));
        geom->radius -= thin;
        geom->half_height -= thin;
        break;
    case PHYS_HULL: {
        const phys_geom_hull *h = geom->hull;
        core_vec3 middle = phys_geom_average(h->vertex, h->vertex_count);
        *room = *h;
        room->vertex = CORE_ARENA_ARRAY(&g->world->scratch, core_vec3, h->vertex_count);
        for (uint32_t i = 0; i < h->vertex_count; i++) {
            core_vec3 arm = core_v3_sub(h->vertex[i], middle);
            room->vertex[i] = core_v3_mad(middle, arm, HULL_PART);
        }
        geom->hull = room;
        break;
    }
    default:
        geom->radius -= depth_of_core(geom->radius);
    }
}

static phys_geom middle_ball(const phys_geom *g) {
    core_vec3 at = g->position;
    if (g->type == PHYS_HULL) {
        core_vec3 mean = phys_geom_average(g->hull->vertex, g->hull->vertex_count);
        at = core_v3_add(at, phys_mat_mul(&g->axes, mean));
    }
    return phys_geom_make(PHYS_SPHERE, at, core_quat_identity(), core_v3(0, 0, 0), MIDDLE);
}

// Earliest time in [t0, *best) at which the core of shape i meets shape j.
static bool meets(const guard *g, uint32_t i, uint32_t row, uint32_t j, uint32_t other, float t0,
                  float *best) {
    phys_geom_hull room;
    phys_moving a = motion(g, i, row, t0, g->dt), b = motion(g, j, other, t0, g->stop[other]);
    core_vec3 n;
    float t;
    shrink(g, &a.geom, &room);
    bool far = b.geom.type == PHYS_MESH && !phys_mesh_near(&a.geom, &b.geom, CLEAR);
    float gap = far ? PHYS_APART : phys_separation(&a.geom, &b.geom, &n);
    if (gap <= 0.0f) { // sunk deep: at least its middle stays on its side
        a.geom = middle_ball(&a.geom);
        gap = phys_separation(&a.geom, &b.geom, &n);
    }
    if (gap < CLEAR) { // stopped here before: it may leave, turn, or wait to be pushed out
        core_vec3 arm = core_v3_sub(a.geom.position, a.center);
        core_vec3 v = core_v3_add(core_v3_sub(a.v, b.v), core_v3_cross(a.w, arm));
        bool held = gap > 0.0f && core_v3_dot(v, n) > 0.0f && t0 < *best;
        *best = held ? t0 : *best;
        return held;
    }
    float until = CORE_MIN(*best, g->stop[other] > t0 ? g->stop[other] : g->dt) - t0;
    if (until > 0.0f && phys_sweep(&a, &b, until, &t) && t0 + t < *best) {
        *best = t0 + t;
        return true;
    }
    return false;
}

static uint32_t find_near(const guard *g, const phys_box *box, uint32_t *out) {
    phys_world *w = g->world;
    uint32_t n = core_columns_count(&w->shapes.set);
    if (!w->broad->partial) {
        for (uint32_t i = 0; i < n; i++) {
            out[i] = i;
        }
        return n;
    }
    uint32_t count = phys_tree_query(w, &w->fixed_tree, box, out, n);
    return count + phys_tree_query(w, &w->moving_tree, box, out + count, n);
}

// When the body is stopped by something on its way, given who is stopped already.
static float first_stop(const guard *g, uint32_t row, uint32_t *found) {
    phys_world *w = g->world;
    const phys_shapes *s = &w->shapes;
    float best = g->dt;
    for (uint32_t slot = w->bodies.shape[row]; slot != 0;) {
        uint32_t i = phys_slot_row(&s->set, slot);
        size_t mark = core_arena_mark(&w->scratch);
        phys_moving m = motion(g, i, row, 0.0f, g->dt);
        float reach = 2.0f * phys_shape_extent(s, i);
        core_vec3 from = m.geom.position, to = core_v3_mad(from, m.v, g->dt);
        phys_box box = {{CORE_MIN(from.x, to.x) - reach, CORE_MIN(from.y, to.y) - reach,
                         CORE_MIN(from.z, to.z) - reach},
                        {CORE_MAX(from.x, to.x) + reach, CORE_MAX(from.y, to.y) + reach,
                         CORE_MAX(from.z, to.z) + reach}};
        uint32_t n = find_near(g, &box, found);
        for (uint32_t k = 0; k < n; k++) {
            uint32_t j = found[k], other = s->row[j];
            if (!phys_pair_wanted(w, i, j) || (w->bodies.flags[other] & PHYS_BODY_LOST) ||
                (g->stop[other] == g->dt && !went_apart(g, i, row, j, other))) {
                continue;
            }
            meets(g, i, row, j, other, 0.0f, &best);
            if (g->stop[other] < best) { // and once it stands
                meets(g, i, row, j, other, g->stop[other], &best);
            }
        }
        core_arena_rewind(&w->scratch, mark);
        slot = s->next[i];
    }
    return best;
}

static void put_back(const guard *g, uint32_t row, float t) {
    phys_bodies *b = &g->world->bodies;
    core_vec3 c = core_v3_mad(start_center(g, row), way_of(g, row), t / g->dt);
    core_quat q = phys_turned(g->before[row], core_v3_scale(turn_of(g, row), t / g->dt));
    q = phys_quat_unit(q);
    phys_put3(b->cx, b->cy, b->cz, row, c);
    b->qx[row] = q.x;
    b->qy[row] = q.y;
    b->qz[row] = q.z;
    b->qw[row] = q.w;
}

core_quat *phys_continuous_begin(phys_world *w) {
    uint32_t n = core_columns_count(&w->bodies.set);
    core_quat *q = CORE_ARENA_ARRAY(&w->scratch, core_quat, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        q[i] = phys_body_quat(&w->bodies, i);
    }
    return q;
}

void phys_continuous_end(phys_world *w, const core_quat *rotations, float dt) {
    uint32_t n = core_columns_count(&w->bodies.set), count = 0;
    guard g = {.world = w, .before = rotations, .dt = dt};
    g.stop = CORE_ARENA_ARRAY(&w->scratch, float, n + 1);
    g.way = CORE_ARENA_ARRAY(&w->scratch, core_vec3, n + 1);
    g.turn = CORE_ARENA_ARRAY(&w->scratch, float, n + 1);
    uint32_t *row = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        g.stop[i] = dt;
        g.way[i] = core_v3(0, 0, 0);
        g.turn[i] = 0.0f;
        if (w->bodies.type[i] != PHYS_STATIC && went_far(&g, i)) {
            row[count++] = i;
        }
    }
    if (count == 0) {
        return;
    }
    float *next = CORE_ARENA_ARRAY(&w->scratch, float, count);
    uint32_t *found =
        CORE_ARENA_ARRAY(&w->scratch, uint32_t, 2 * (size_t)core_columns_count(&w->shapes.set) + 1);
    // Who is stopped may then be in the way of others, or no longer: all are asked again.
    bool changed = true;
    for (int round = 0; round < ROUNDS && changed; round++) {
        changed = false;
        for (uint32_t k = 0; k < count; k++) {
            next[k] = first_stop(&g, row[k], found);
            changed |= next[k] != g.stop[row[k]];
        }
        for (uint32_t k = 0; k < count; k++) {
            g.stop[row[k]] = next[k];
        }
    }
    for (uint32_t k = 0; k < count; k++) {
        if (next[k] < dt) {
            put_back(&g, row[k], next[k]);
        }
    }
}
