// How a mover gets through a step: carried by its ground, then its own way along the planes that
// part it from the bodies around, a step up where that ends early, and down to the ground again.
#include "phys/world.h"

#define SKIN       PHYS_MOVER_SKIN
#define TOUCHES    64u     // bodies around at once; with more the way is halved
#define SOLVE      200     // rounds of the projection at most
#define SOLVED     1e-6f   // m
#define SLIDES     5       // planes are looked for anew this often in a way
#define FLAT       0.9995f // normals above lean by less than 2 degrees
#define SAME_SLOPE 0.9995f // cosine: a contact that leans like the surface behind it is no edge
#define WEDGED     0.3f    // sine of the steepest way down that holds between slopes
#define CAST_GAP   7.5e-4f // m: where a cast ends before what it hits, on the mean

typedef struct plane { // allows ways d with dot(normal, d) >= least
    core_vec3 normal;
    float least, push;
} plane;

typedef struct mover_step {
    phys_world *world;
    uint32_t row;
    phys_shape_desc capsule;
    phys_filter filter;
    float dt, base; // base: height of the soles before the step (m)
    bool stood;     // on the ground before the step
    phys_touch touch[TOUCHES];
    plane plane[2 * TOUCHES];
    uint32_t touches, planes;
} mover_step;

static core_vec3 level(core_vec3 v) { return core_v3(v.x, 0.0f, v.z); }

static float soles(const mover_step *m, core_vec3 at) {
    return at.y - m->capsule.half_height - m->capsule.radius - SKIN;
}

static bool look_around(mover_step *m, core_vec3 at, float reach) {
    uint32_t found = phys_world_touch(m->world, &m->capsule, at, core_quat_identity(), reach,
                                      &m->filter, m->touch, TOUCHES);
    m->touches = CORE_MIN(found, TOUCHES);
    return found <= TOUCHES;
}

// The surface just behind a contact: at an edge it leans otherwise than the contact does.
static bool surface_behind(const mover_step *m, const phys_touch *t, phys_hit *out) {
    core_vec3 in = phys_unit(level(t->normal), core_v3(0, 0, 0));
    core_vec3 from = core_v3_mad(t->point, in, -0.01f);
    from.y += 0.12f;
    return phys_world_ray(m->world, from, core_v3(0, -0.24f, 0), &m->filter, out) &&
           out->fraction > 0.0f;
}

// Whether one can walk over a contact that does not lean too far: a slope, or an edge that is no
// higher than a step. A low edge leans little against a round foot, however steep the wall below.
static bool passable(const mover_step *m, const phys_touch *t) {
    const phys_movers *all = &m->world->movers;
    if (t->normal.y > FLAT || t->point.y - m->base <= all->step[m->row]) {
        return true;
    }
    phys_hit behind;
    return surface_behind(m, t, &behind) && core_v3_dot(behind.normal, t->normal) > SAME_SLOPE;
}

static void add_plane(mover_step *m, core_vec3 normal, float least) {
    m->plane[m->planes++] = (plane){normal, least, 0.0f};
}

// Each touch parts by its own plane; what is too steep to climb is an upright wall besides. Walls
// come first: where they stop a way, the slanted plane behind has nothing to turn upwards.
static void make_planes(mover_step *m, bool walks) {
    float limit = m->world->movers.slope_cos[m->row];
    m->planes = 0;
    for (uint32_t i = 0; walks && i < m->touches; i++) {
        const phys_touch *t = &m->touch[i];
        core_vec3 side = level(t->normal);
        float lean = core_v3_length(side);
        if (t->normal.y > 0.0f && lean > 1e-3f && !(t->normal.y >= limit && passable(m, t))) {
            add_plane(m, core_v3_scale(side, 1.0f / lean), CORE_MIN(SKIN - t->gap, 0.0f) / lean);
        }
    }
    for (uint32_t i = 0; i < m->touches; i++) {
        add_plane(m, m->touch[i].normal, SKIN - m->touch[i].gap);
    }
}

// The way closest to the wish that all planes allow: Dykstra's projections. What they leave is then
// cut so that no plane is crossed that the mover is outside of.
static core_vec3 solve(mover_step *m, core_vec3 wish) {
    core_vec3 d = wish;
    for (uint32_t i = 0; i < m->planes; i++) {
        m->plane[i].push = 0.0f;
    }
    for (int round = 0; round < SOLVE; round++) {
        float moved = 0.0f;
        for (uint32_t i = 0; i < m->planes; i++) {
            plane *p = &m->plane[i];
            float push = CORE_MAX(p->push + p->least - core_v3_dot(p->normal, d), 0.0f);
            d = core_v3_mad(d, p->normal, push - p->push);
            moved = CORE_MAX(moved, core_absf(push - p->push));
            p->push = push;
        }
        if (moved < SOLVED) {
            break;
        }
    }
    float part = 1.0f;
    for (uint32_t i = 0; i < m->planes; i++) {
        const plane *p = &m->plane[i];
        float along = core_v3_dot(p->normal, d), least = CORE_MIN(p->least, 0.0f);
        if (along < least - SOLVED) {
            part = CORE_MIN(part, least / along);
        }
    }
    return core_v3_scale(d, part);
}

// Goes a way as far and as near to it as the planes allow; returns what was gone.
static core_vec3 slide(mover_step *m, core_vec3 *at, core_vec3 way, bool walks) {
    core_vec3 start = *at, rest = way;
    float piece = 0.9f * m->capsule.radius, length = core_v3_length(way);
    int rounds = SLIDES + (int)CORE_MIN(length / piece, 1000.0f);
    for (int i = 0; i < rounds; i++) {
        length = core_v3_length(rest);
        core_vec3 now = length > piece ? core_v3_scale(rest, piece / length) : rest;
        float reach = CORE_MIN(length, piece) + SKIN;
        while (!look_around(m, *at, reach) && reach > SKIN) {
            reach = CORE_MAX(0.5f * reach, SKIN);
            now = core_v3_scale(now, 0.5f);
        }
        make_planes(m, walks);
        core_vec3 d = solve(m, now);
        *at = core_v3_add(*at, d);
        rest = core_v3_sub(rest, d);
        if (core_v3_dot(rest, way) <= 0.0f || core_v3_dot(d, d) < 1e-10f) {
            break;
        }
    }
    return core_v3_sub(*at, start);
}

// Straight down by at most `depth`, to a skin above what is there.
static bool drop(mover_step *m, core_vec3 *at, float depth) {
    phys_hit hit;
    core_vec3 way = {0, -depth, 0};
    if (!phys_world_cast(m->world, &m->capsule, *at, core_quat_identity(), way, &m->filter, &hit)) {
        return false;
    }
    float back = (SKIN - CAST_GAP) / CORE_MAX(hit.normal.y, 0.25f);
    at->y += CORE_MIN(back - depth * hit.fraction, 0.0f);
    return true;
}

// Whether a touch can be stood on; the surface's normal.
static bool bears(const mover_step *m, const phys_touch *t, core_vec3 *normal) {
    const phys_movers *all = &m->world->movers;
    float limit = all->slope_cos[m->row];
    phys_hit behind;
    *normal = t->normal;
    if (t->normal.y > FLAT || t->normal.y <= 0.05f) {
        return t->normal.y > FLAT;
    }
    if (surface_behind(m, t, &behind) && behind.normal.y >= limit &&
        core_v3_dot(behind.normal, t->normal) <= SAME_SLOPE) {
        *normal = behind.normal;
        return (!m->stood && t->normal.y >= limit) ||
               behind.point.y - m->base <= all->step[m->row] + 0.5f * SKIN;
    }
    return t->normal.y >= limit;
}

// The best of what is touched to stand on: most upright, the first among equals.
static const phys_touch *find_ground(mover_step *m, core_vec3 at, core_vec3 *normal) {
    const phys_touch *best = NULL;
    look_around(m, at, 2.0f * SKIN);
    for (uint32_t i = 0; i < m->touches; i++) {
        core_vec3 n;
        if (m->touch[i].normal.y > 0.05f && bears(m, &m->touch[i], &n) &&
            (best == NULL || m->touch[i].normal.y > best->normal.y)) {
            best = &m->touch[i];
            *normal = n;
        }
    }
    return best;
}

// Up, on, and down again; kept when it gets farther than `got` and ends on ground no higher than a
// step.
static void step_up(mover_step *m, core_vec3 from, core_vec3 way, float got, core_vec3 *at) {
    float height = m->world->movers.step[m->row];
    core_vec3 there = from, normal;
    phys_hit hit;
    float up = height + 1e-3f;
    if (phys_world_cast(m->world, &m->capsule, there, core_quat_identity(),
                        core_v3(0, up + SKIN, 0), &m->filter, &hit)) {
        up = (up + SKIN) * hit.fraction - SKIN;
    }
    if (up < 0.01f) {
        return;
    }
    there.y += up;
    core_vec3 gone = slide(m, &there, way, true);
    if (core_v3_dot(gone, way) > got + 0.02f * core_v3_dot(way, way) &&
        drop(m, &there, up + 2.0f * SKIN) && soles(m, there) - m->base <= height + 2.0f * SKIN &&
        find_ground(m, there, &normal)) {
        *at = there;
    }
}

// On the ground a wish keeps its length and follows the surface.
static core_vec3 along_ground(core_vec3 wish, core_vec3 normal) {
    core_vec3 d = level(wish);
    float speed = core_v3_length(d);
    d.y = -core_v3_dot(d, normal) / CORE_MAX(normal.y, 0.1f);
    return core_v3_scale(phys_unit(d, core_v3(0, 0, 0)), speed);
}

static void walk(mover_step *m, core_vec3 *at) {
    phys_movers *all = &m->world->movers;
    core_vec3 way = core_v3_scale(along_ground(all->wish[m->row], all->normal[m->row]), m->dt);
    core_vec3 from = *at, gone = slide(m, at, way, true), flat = level(way);
    float want = core_v3_dot(flat, flat), got = core_v3_dot(gone, flat);
    if (want > 0.0f && got < 0.95f * want && all->step[m->row] > 0.0f) {
        step_up(m, from, flat, got, at);
    }
}

// Falls and jumps: the drift loses what the planes take from it.
static void fly(mover_step *m, core_vec3 *at) {
    phys_movers *all = &m->world->movers;
    uint32_t i = m->row;
    bool falls = all->gravity_scale[i] != 0.0f;
    core_vec3 wish = falls ? level(all->wish[i]) : all->wish[i];
    all->drift[i] = core_v3_mad(all->drift[i], m->world->gravity, all->gravity_scale[i] * m->dt);
    slide(m, at, core_v3_scale(core_v3_add(all->drift[i], wish), m->dt), falls);
    look_around(m, *at, 2.0f * SKIN);
    m->planes = 0;
    for (uint32_t k = 0; k < m->touches; k++) {
        add_plane(m, m->touch[k].normal, 0.0f);
    }
    all->drift[i] = solve(m, all->drift[i]);
}

// Where the ground has taken the place on which the mover stood.
static core_vec3 carried(mover_step *m) {
    phys_movers *all = &m->world->movers;
    const phys_bodies *b = &m->world->bodies;
    uint32_t i = m->row, row = phys_body_row(m->world, all->body[i]);
    all->turn[i] = 0.0f;
    if (row == CORE_NO_ROW || all->ground[i] != PHYS_MOVER_GROUND) {
        return core_v3(0, 0, 0);
    }
    core_quat q = phys_body_quat(b, row);
    core_quat turn = phys_quat_mul(q, phys_conj(all->turn_from[i]));
    float s = turn.w < 0.0f ? -1.0f : 1.0f;
    all->turn[i] = 2.0f * core_atan2f(s * turn.y, s * turn.w);
    core_vec3 now = core_v3_add(phys_get3(b->px, b->py, b->pz, row), phys_rotate(q, all->place[i]));
    return core_v3_sub(now, all->position[i]);
}

static void take_ground(mover_step *m, core_vec3 at, const phys_touch *t, core_vec3 normal) {
    phys_movers *all = &m->world->movers;
    const phys_bodies *b = &m->world->bodies;
    uint32_t i = m->row, row = phys_body_row(m->world, t->body);
    core_quat q = phys_body_quat(b, row);
    all->ground[i] = PHYS_MOVER_GROUND;
    all->body[i] = t->body;
    all->normal[i] = normal;
    all->point[i] = t->point;
    all->place[i] = phys_unrotate(q, core_v3_sub(at, phys_get3(b->px, b->py, b->pz, row)));
    all->turn_from[i] = q;
    all->drift[i] = core_v3(0, 0, 0);
}

static void leave_ground(mover_step *m, core_vec3 carry) {
    phys_movers *all = &m->world->movers;
    uint32_t i = m->row;
    bool steep = false;
    for (uint32_t k = 0; k < m->touches; k++) {
        steep |= m->touch[k].normal.y > 0.05f;
    }
    if (all->ground[i] == PHYS_MOVER_GROUND) {
        all->drift[i] = core_v3_scale(level(carry), 1.0f / m->dt);
    }
    all->ground[i] = steep ? PHYS_MOVER_STEEP : PHYS_MOVER_AIR;
    all->body[i] = CORE_NULL_HANDLE;
    all->normal[i] = core_v3(0, 1, 0);
    all->point[i] = core_v3(0, 0, 0);
}

// Held between slopes that are each too steep: together they leave no steep way down.
static bool wedged(mover_step *m) {
    m->planes = 0;
    for (uint32_t i = 0; i < m->touches; i++) {
        add_plane(m, m->touch[i].normal, 0.0f);
    }
    core_vec3 down = phys_unit(m->world->gravity, core_v3(0, -1, 0)), d = solve(m, down);
    return m->touches > 1 && core_v3_dot(d, d) < WEDGED * WEDGED;
}

// What walks keeps to the ground a step below; what falls lands where it touches.
static void settle(mover_step *m, core_vec3 *at, core_vec3 carry) {
    phys_movers *all = &m->world->movers;
    uint32_t i = m->row;
    bool stood = m->stood;
    core_vec3 normal, low = *at;
    const phys_touch *t = NULL;
    if (stood || all->drift[i].y <= 0.0f) {
        bool down = drop(m, &low, stood ? all->step[i] + 0.05f : 2.0f * SKIN);
        t = find_ground(m, down ? low : *at, &normal);
        *at = t != NULL && down ? low : *at;
    }
    if (t == NULL && (stood || all->drift[i].y <= 0.05f) && wedged(m)) {
        t = &m->touch[0];
        normal = core_v3(0, 1, 0);
    }
    if (t != NULL) {
        take_ground(m, *at, t, normal);
    } else {
        leave_ground(m, carry);
    }
}

// Forces, not impulses: friction stands up to them evenly through the step.
static void push_body(phys_world *w, uint32_t row, core_vec3 arm, core_vec3 force) {
    phys_bodies *b = &w->bodies;
    b->force[row] = core_v3_add(b->force[row], force);
    b->torque[row] = core_v3_add(b->torque[row], core_v3_cross(arm, force));
    phys_wake_row(w, row);
}

// Presses against what is in the way with at most its force, and on the ground with its weight.
static void press(mover_step *m, core_vec3 at, core_vec3 intended) {
    phys_world *w = m->world;
    const phys_movers *all = &w->movers;
    const phys_bodies *b = &w->bodies;
    uint32_t i = m->row;
    bool active = core_v3_dot(all->wish[i], all->wish[i]) > 0.0f;
    look_around(m, at, 3.0f * SKIN);
    for (uint32_t k = 0; k < m->touches; k++) {
        const phys_touch *t = &m->touch[k];
        uint32_t row = phys_body_row(w, t->body);
        if (b->type[row] != PHYS_DYNAMIC) {
            continue;
        }
        core_vec3 n = core_v3_scale(t->normal, -1.0f);
        core_vec3 arm = core_v3_sub(t->point, phys_get3(b->cx, b->cy, b->cz, row));
        bool below = core_handle_equal(t->body, all->body[i]) && t->normal.y > 0.0f;
        if (below && (active || (b->flags[row] & PHYS_BODY_ASLEEP) == 0)) {
            float weight = all->mass[i] * all->gravity_scale[i];
            push_body(w, row, arm, core_v3_scale(w->gravity, weight));
        } else if (!below) {
            core_vec3 spin = phys_get3(b->wx, b->wy, b->wz, row);
            core_vec3 v =
                core_v3_add(phys_get3(b->vx, b->vy, b->vz, row), core_v3_cross(spin, arm));
            float closing = core_v3_dot(core_v3_sub(intended, v), n);
            core_vec3 turn = phys_body_inverse_inertia(b, row, core_v3_cross(arm, n));
            float give =
                1.0f / all->mass[i] + b->im[row] + core_v3_dot(core_v3_cross(turn, arm), n);
            if (closing > 0.0f) {
                float force = CORE_MIN(all->push[i], closing / (give * m->dt));
                push_body(w, row, arm, core_v3_scale(n, force));
            }
        }
    }
}

// Stands still on what stands still.
static bool rests(const phys_world *w, uint32_t i, bool still) {
    const phys_movers *m = &w->movers;
    core_vec3 wish = m->wish[i];
    return still && m->ground[i] == PHYS_MOVER_GROUND && core_v3_dot(wish, wish) == 0.0f &&
           phys_body_row(w, m->body[i]) != CORE_NO_ROW;
}

static void move(phys_world *w, uint32_t i, float dt) {
    phys_movers *all = &w->movers;
    mover_step m = {.world = w, .row = i, .dt = dt, .filter = {.layers = all->layers[i]}};
    m.capsule = phys_shape_desc_default(PHYS_CAPSULE);
    m.capsule.radius = all->radius[i];
    m.capsule.half_height = all->half_height[i];
    core_vec3 at = all->position[i], carry = carried(&m);
    bool stood = m.stood = all->ground[i] == PHYS_MOVER_GROUND;
    m.base = soles(&m, at);
    if (core_v3_dot(carry, carry) > 0.0f) {
        slide(&m, &at, carry, false);
        m.base = soles(&m, at);
    }
    core_vec3 intended = stood ? along_ground(all->wish[i], all->normal[i])
                               : core_v3_add(all->drift[i], all->wish[i]);
    if (stood && all->gravity_scale[i] != 0.0f) {
        walk(&m, &at);
    } else {
        fly(&m, &at);
        m.base = soles(&m, at);
    }
    settle(&m, &at, carry);
    press(&m, at, core_v3_mad(intended, carry, 1.0f / dt));
    all->velocity[i] = core_v3_scale(core_v3_sub(at, all->position[i]), 1.0f / dt);
    all->position[i] = at;
}

void phys_movers_update(phys_world *w, float dt, bool still) {
    uint32_t n = core_columns_count(&w->movers.set);
    for (uint32_t i = 0; i < n; i++) {
        if (rests(w, i, still)) {
            w->movers.velocity[i] = core_v3(0, 0, 0);
            w->movers.turn[i] = 0.0f;
        } else {
            move(w, i, dt);
        }
    }
}
