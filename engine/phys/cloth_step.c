// One step of all ropes and cloths: the working set of each is packed, solved (in parallel), and
// its motion, tears and pushes are taken over, in the order of rows.
#include "phys/world.h"

#include <string.h>

#define REST_SPEED    0.02f // m/s: below for REST_TIME, a cloth falls asleep
#define REST_TIME     0.5f  // s
#define WAKE_SPEED    0.05f // m/s that a push would give a sleeping body: less does not wake it
#define SWING         1.2f  // rad of the fastest sideways swing of a line that a sub-step may hold
#define SURGE         1.5f  // how much more than its load a rope may carry for a moment
#define ROPE_SUBSTEPS 64u
#define FOLLOW        0.5f // part of the way between a body and its particle that a step mends
#define AIR           1.2f // kg/m^3

// What holds a particle in this step: its row of the working set, and what it does to the body.
typedef struct grip {
    uint32_t at, body;       // body: row, CORE_NO_ROW for none or one without mass
    core_vec3 arm, start, n; // start: velocity; n: where the cloth pulls to
} grip;
typedef struct job_item {
    phys_cloth_work work;
    grip *grip;
    uint32_t grips;
} job_item;

static uint32_t round_up(uint32_t n) { return (n + 15u) / 16u * 16u; }

static float *take(phys_world *w, size_t count) { // zero, with room for loads beyond the end
    float *p = CORE_ARENA_ARRAY(&w->scratch, float, count + 32);
    memset(p, 0, sizeof(float) * (count + 32));
    return p;
}

static void take3(phys_world *w, float *out[3], size_t count) {
    for (int i = 0; i < 3; i++) {
        out[i] = take(w, count);
    }
}

static void make_room(phys_world *w, phys_cloth_work *k) {
    size_t n = (size_t)k->rows * k->stride, t = (size_t)k->columns * k->turned_stride;
    size_t most = CORE_MAX(n, t);
    take3(w, k->x, n);
    take3(w, k->q, n);
    take3(w, k->v, n);
    take3(w, k->a, n);
    take3(w, k->t, t);
    take3(w, k->n, most);
    k->w = take(w, n);
    k->tw = take(w, t);
    k->held = take(w, n);
    k->down = take(w, n);
    k->cell = take(w, n);
    k->across = take(w, t);
    k->pull_down = take(w, n);
    k->pull_across = take(w, t);
    k->off = take(w, most);
    k->inv = take(w, most);
    k->y = take(w, most);
    for (int c = 0; c < PHYS_CLOTH_CONTACTS; c++) {
        phys_cloth_contact *s = &k->contact[c];
        take3(w, s->n, n);
        take3(w, s->u, n);
        take3(w, s->push, n);
        s->d = take(w, n);
        s->dv = take(w, n);
        s->grip = take(w, n);
        s->gap = take(w, n);
        s->body = (uint32_t *)(void *)take(w, n);
        for (size_t i = 0; i < n; i++) {
            s->gap[i] = PHYS_APART;
            s->d[i] = -PHYS_APART;
        }
    }
}

// The square of the fastest sideways swing of a rope under tension, 4 T / (m l), when it carries
// what it holds and itself: a thread under a weight swings fast.
static float swing_rate(const phys_world *w, uint32_t cloth) {
    const phys_cloths *c = &w->cloths;
    uint32_t slot = phys_row_slot(&w->cloths.set, cloth);
    uint32_t count = c->columns[cloth] * c->rows[cloth];
    float load = c->mass[cloth] * (float)count;
    for (uint32_t k = 0; k < core_columns_count(&w->holds.set); k++) {
        uint32_t row = phys_body_row(w, w->holds.body[k]);
        if (w->holds.cloth[k] == slot && row != CORE_NO_ROW && w->bodies.im[row] > 0.0f) {
            load += 1.0f / w->bodies.im[row];
        }
    }
    float rest = CORE_MAX(c->rest_across[cloth], c->rest_down[cloth]);
    return 4.0f * SURGE * load * core_v3_length(w->gravity) / (c->mass[cloth] * rest);
}

// A rope takes as many sub-steps as that asks for. Where even the most are too long, its particles
// are heavier than they should be.
static uint32_t rope_substeps(phys_world *w, phys_cloth_work *k, float dt) {
    const phys_cloths *c = &w->cloths;
    uint32_t own = c->substeps[k->cloth];
    k->heavier = 1.0f;
    if (k->columns > 1 && k->rows > 1) {
        return own;
    }
    float asked = dt * core_sqrtf(swing_rate(w, k->cloth)) / SWING;
    if (asked > (float)ROPE_SUBSTEPS) {
        k->heavier = asked * asked / (float)(ROPE_SUBSTEPS * ROPE_SUBSTEPS);
        return ROPE_SUBSTEPS;
    }
    return CORE_MAX(own, (uint32_t)asked + 1);
}

static void set_constants(phys_world *w, phys_cloth_work *k, float dt) {
    const phys_cloths *c = &w->cloths;
    uint32_t i = k->cloth;
    k->columns = c->columns[i];
    k->rows = c->rows[i];
    k->stride = round_up(k->columns);
    k->turned_stride = round_up(k->rows);
    k->substeps = rope_substeps(w, k, dt);
    k->h = dt / (float)k->substeps;
    k->rest_across = c->rest_across[i];
    k->rest_down = c->rest_down[i];
    k->rest_diagonal = core_sqrtf(k->rest_across * k->rest_across + k->rest_down * k->rest_down);
    float rate = 1.0f / (k->h * k->h);
    k->stretch = c->stretch[i] * rate;
    k->shear = c->shear[i] * rate;
    k->bend = c->bend[i] > 0.0f ? rate / c->bend[i] : -1.0f;
    k->keep = 1.0f / (1.0f + c->damping[i] * k->h);
    k->direct = !w->cloth_iterates;
}

static void pack(phys_world *w, phys_cloth_work *k) {
    const phys_particles *p = &w->particles;
    float inverse = 1.0f / (w->cloths.mass[k->cloth] * k->heavier);
    for (uint32_t r = 0; r < k->rows; r++) {
        for (uint32_t c = 0; c < k->columns; c++) {
            uint32_t from = w->cloths.first[k->cloth] + r * k->columns + c;
            uint32_t i = r * k->stride + c, t = c * k->turned_stride + r;
            phys_put3(k->x[0], k->x[1], k->x[2], i, phys_get3(p->x, p->y, p->z, from));
            phys_put3(k->v[0], k->v[1], k->v[2], i, phys_get3(p->vx, p->vy, p->vz, from));
            k->w[i] = inverse;
            uint8_t torn = p->torn[from];
            bool right = c + 1 < k->columns, below = r + 1 < k->rows;
            k->across[t] = right && !(torn & PHYS_CLOTH_TORN_ACROSS) ? 1.0f : 0.0f;
            k->down[i] = below && !(torn & PHYS_CLOTH_TORN_DOWN) ? 1.0f : 0.0f;
            // A cell whose frame is torn has lost its diagonals as well.
            bool whole = right && below && torn == 0 &&
                         !(p->torn[from + 1] & PHYS_CLOTH_TORN_DOWN) &&
                         !(p->torn[from + k->columns] & PHYS_CLOTH_TORN_ACROSS);
            k->cell[i] = whole ? 1.0f : 0.0f;
        }
    }
}

static core_vec3 at(const phys_cloth_work *k, uint32_t i) {
    return phys_get3(k->x[0], k->x[1], k->x[2], i);
}

// The direction in which the cloth pulls at a particle: towards its neighbours.
static core_vec3 pull_direction(const phys_cloth_work *k, uint32_t i) {
    uint32_t r = i / k->stride, c = i % k->stride;
    core_vec3 sum = {0, 0, 0}, here = at(k, i);
    const uint32_t near[4] = {i - k->stride, i + k->stride, i - 1, i + 1};
    const bool is[4] = {r > 0, r + 1 < k->rows, c > 0, c + 1 < k->columns};
    for (int j = 0; j < 4; j++) {
        if (is[j]) {
            core_vec3 d = core_v3_sub(at(k, near[j]), here);
            sum = core_v3_add(sum, phys_unit(d, core_v3(0, 0, 0)));
        }
    }
    return phys_unit(sum, core_v3(0, 1, 0));
}

// A held particle goes where its body goes. One of a dynamic body is as heavy as the body is
// there, so that the solver finds what both do; the body gets the difference.
static void take_hold(phys_world *w, job_item *item, uint32_t hold, float dt) {
    phys_cloth_work *k = &item->work;
    const phys_bodies *b = &w->bodies;
    const phys_holds *holds = &w->holds;
    uint32_t index = holds->index[hold], row = phys_body_row(w, holds->body[hold]);
    grip *g = &item->grip[item->grips++];
    *g = (grip){.at = index / k->columns * k->stride + index % k->columns, .body = CORE_NO_ROW};
    core_vec3 here = at(k, g->at), v;
    if (row == CORE_NO_ROW) {
        v = core_v3_scale(core_v3_sub(holds->place[hold], here), 1.0f / dt);
    } else {
        core_quat q = phys_body_quat(b, row);
        core_vec3 anchor =
            core_v3_add(phys_get3(b->px, b->py, b->pz, row), phys_rotate(q, holds->place[hold]));
        g->arm = core_v3_sub(anchor, phys_get3(b->cx, b->cy, b->cz, row));
        v = core_v3_add(phys_get3(b->vx, b->vy, b->vz, row),
                        core_v3_cross(phys_get3(b->wx, b->wy, b->wz, row), g->arm));
        // Not at once: what parts them is made up for on the way, or it would be a blow.
        v = core_v3_mad(v, core_v3_sub(anchor, here), FOLLOW / dt);
    }
    phys_put3(k->v[0], k->v[1], k->v[2], g->at, v);
    k->w[g->at] = 0.0f;
    k->held[g->at] = 1.0f;
    if (row != CORE_NO_ROW && b->type[row] == PHYS_DYNAMIC) {
        g->n = pull_direction(k, g->at);
        core_vec3 turn = phys_body_inverse_inertia(b, row, core_v3_cross(g->arm, g->n));
        k->w[g->at] = b->im[row] + core_v3_dot(core_v3_cross(turn, g->arm), g->n);
        g->body = row;
        g->start = v;
    }
}

static core_vec3 normal_of(const phys_cloth_work *k, uint32_t r, uint32_t c) {
    uint32_t c0 = c > 0 ? c - 1 : c, c1 = c + 1 < k->columns ? c + 1 : c;
    uint32_t r0 = r > 0 ? r - 1 : r, r1 = r + 1 < k->rows ? r + 1 : r;
    core_vec3 u = core_v3_sub(at(k, r * k->stride + c1), at(k, r * k->stride + c0));
    core_vec3 v = core_v3_sub(at(k, r1 * k->stride + c), at(k, r0 * k->stride + c));
    return phys_unit(core_v3_cross(u, v), core_v3(0, 0, 0));
}

// Acceleration by the air that passes: the pressure on the face for cloth, drag of a thread for
// rope. Divided by what it would do within the step, so that light cloth does not overshoot.
static core_vec3 air_drag(const phys_world *w, const phys_cloth_work *k, uint32_t r, uint32_t c,
                          core_vec3 wind, float dt) {
    const phys_cloths *all = &w->cloths;
    uint32_t i = r * k->stride + c;
    core_vec3 u = core_v3_sub(wind, phys_get3(k->v[0], k->v[1], k->v[2], i));
    float area = k->rest_across * k->rest_down;
    if (k->columns > 1 && k->rows > 1) {
        core_vec3 n = normal_of(k, r, c);
        u = core_v3_scale(n, core_v3_dot(u, n));
    } else {
        area = 2.0f * all->radius[k->cloth] * CORE_MAX(k->rest_across, k->rest_down);
    }
    float rate = 0.5f * AIR * all->drag[k->cloth] * area * core_v3_length(u) / all->mass[k->cloth];
    return core_v3_scale(u, rate / (1.0f + rate * dt));
}

static void accelerate(phys_world *w, phys_cloth_work *k, float dt) {
    const phys_cloths *all = &w->cloths;
    uint32_t i = k->cloth, layer = all->layer[i];
    core_vec3 g = core_v3_scale(w->gravity, all->gravity_scale[i]);
    bool fields = core_columns_count(&w->fields.set) != 0;
    for (uint32_t r = 0; r < k->rows; r++) {
        for (uint32_t c = 0; c < k->columns; c++) {
            uint32_t j = r * k->stride + c;
            if (k->w[j] == 0.0f) {
                continue;
            }
            core_vec3 a = g, here = at(k, j);
            if (fields) {
                a = core_v3_add(a, phys_field_acceleration(w, here, layer));
            }
            if (all->drag[i] > 0.0f) {
                core_vec3 wind = fields ? phys_field_wind(w, here, layer) : core_v3(0, 0, 0);
                a = core_v3_add(a, air_drag(w, k, r, c, wind, dt));
            }
            phys_put3(k->a[0], k->a[1], k->a[2], j, a);
        }
    }
}

// Bodies feel their own gravity and fields, not the cloth's.
static void accelerate_held(phys_world *w, job_item *item) {
    const phys_bodies *b = &w->bodies;
    for (uint32_t j = 0; j < item->grips; j++) {
        const grip *g = &item->grip[j];
        if (g->body != CORE_NO_ROW) {
            core_vec3 a = core_v3_scale(w->gravity, b->gravity_scale[g->body]);
            phys_put3(item->work.a[0], item->work.a[1], item->work.a[2], g->at, a);
        }
    }
}

static void turn_weights(phys_cloth_work *k) {
    for (uint32_t r = 0; r < k->rows; r++) {
        for (uint32_t c = 0; c < k->columns; c++) {
            k->tw[c * k->turned_stride + r] = k->w[r * k->stride + c];
        }
    }
}

static void prepare(phys_world *w, job_item *item, uint32_t cloth, float dt) {
    phys_cloth_work *k = &item->work;
    uint32_t slot = phys_row_slot(&w->cloths.set, cloth);
    *item = (job_item){.work = {.cloth = cloth}};
    set_constants(w, k, dt);
    make_room(w, k);
    pack(w, k);
    uint32_t holds = core_columns_count(&w->holds.set);
    item->grip = CORE_ARENA_ARRAY(&w->scratch, grip, holds + 1);
    for (uint32_t j = 0; j < holds; j++) {
        if (w->holds.cloth[j] == slot) {
            take_hold(w, item, j, dt);
        }
    }
    turn_weights(k);
    accelerate(w, k, dt);
    accelerate_held(w, item);
    phys_cloth_find_contacts(w, k, dt);
}

// An impulse on a body at its centre plus arm, as a force over the step, like gravity: its
// sub-steps then balance both. Too small a one leaves a sleeper asleep.
static void nudge(phys_world *w, uint32_t row, core_vec3 impulse, core_vec3 arm, float dt) {
    phys_bodies *b = &w->bodies;
    if (b->type[row] != PHYS_DYNAMIC) {
        return;
    }
    if (b->flags[row] & PHYS_BODY_ASLEEP) {
        if (core_v3_length(impulse) * b->im[row] < WAKE_SPEED) {
            return;
        }
        phys_wake_row(w, row);
    }
    core_vec3 force = core_v3_scale(impulse, 1.0f / dt);
    b->force[row] = core_v3_add(b->force[row], force);
    b->torque[row] = core_v3_add(b->torque[row], core_v3_cross(arm, force));
}

// The pull of a cloth on the body that holds it. What carries the body's weight is a force over
// the step, as gravity is; the rest and all of the turning an impulse before it, so that a body
// swings without gain (symplectic Euler).
static void pull_body(phys_world *w, const grip *g, core_vec3 impulse, float dt) {
    phys_bodies *b = &w->bodies;
    uint32_t row = g->body;
    core_vec3 weight = core_v3_scale(w->gravity, b->gravity_scale[row] * dt / b->im[row]);
    float whole = core_v3_dot(weight, weight), carries = -core_v3_dot(impulse, weight);
    float part = whole > 0.0f ? CORE_CLAMP(carries / whole, 0.0f, 1.0f) : 0.0f;
    core_vec3 kick = core_v3_mad(impulse, weight, part);
    if (b->flags[row] & PHYS_BODY_ASLEEP) {
        core_vec3 change = core_v3_scale(core_v3_add(impulse, weight), b->im[row]);
        if (core_v3_length(change) < WAKE_SPEED) {
            return;
        }
        phys_wake_row(w, row);
    }
    core_vec3 v = phys_get3(b->vx, b->vy, b->vz, row), s = phys_get3(b->wx, b->wy, b->wz, row);
    core_vec3 turn = phys_body_inverse_inertia(b, row, core_v3_cross(g->arm, impulse));
    v = core_v3_add(v, phys_lock_motion(b->locks[row], core_v3_scale(kick, b->im[row])));
    phys_put3(b->vx, b->vy, b->vz, row, v);
    phys_put3(b->wx, b->wy, b->wz, row, core_v3_add(s, turn));
    b->force[row] = core_v3_mad(b->force[row], weight, -part / dt);
    w->measured = false;
}

// Along the pull only: across it a body that turns gives more than its weight there says.
static void pull_bodies(phys_world *w, const job_item *item, float dt) {
    const phys_cloth_work *k = &item->work;
    for (uint32_t j = 0; j < item->grips; j++) {
        const grip *g = &item->grip[j];
        if (g->body == CORE_NO_ROW) {
            continue;
        }
        core_vec3 a = phys_get3(k->a[0], k->a[1], k->a[2], g->at);
        core_vec3 end = phys_get3(k->v[0], k->v[1], k->v[2], g->at);
        core_vec3 got = core_v3_sub(end, core_v3_mad(g->start, a, dt));
        float pull = core_v3_dot(got, g->n) / k->w[g->at];
        pull_body(w, g, core_v3_scale(g->n, pull), dt);
    }
}

static void push_bodies(phys_world *w, const phys_cloth_work *k, float dt) {
    const phys_bodies *b = &w->bodies;
    for (int s = 0; k->touches && s < PHYS_CLOTH_CONTACTS; s++) {
        const phys_cloth_contact *c = &k->contact[s];
        for (uint32_t i = 0; i < k->rows * k->stride; i++) {
            core_vec3 push = phys_get3(c->push[0], c->push[1], c->push[2], i);
            if (push.x == 0.0f && push.y == 0.0f && push.z == 0.0f) {
                continue;
            }
            core_vec3 arm = core_v3_sub(at(k, i), phys_get3(b->cx, b->cy, b->cz, c->body[i]));
            nudge(w, c->body[i], core_v3_scale(push, -1.0f / (k->w[i] * k->h)), arm, dt);
        }
    }
}

static void tear_edges(phys_world *w, const phys_cloth_work *k) {
    phys_cloths *all = &w->cloths;
    uint32_t cloth = k->cloth;
    // Multipliers are impulses times h; the mean force over the step is their mean over h^2.
    float limit = all->tear_force[cloth] * k->h * k->h * (float)k->substeps;
    if (!(limit > 0.0f)) {
        return;
    }
    for (uint32_t r = 0; r < k->rows; r++) {
        for (uint32_t c = 0; c < k->columns; c++) {
            uint32_t i = r * k->stride + c, t = c * k->turned_stride + r;
            uint32_t to = all->first[cloth] + r * k->columns + c;
            if (k->pull_down[i] > limit) {
                w->particles.torn[to] |= PHYS_CLOTH_TORN_DOWN;
                all->torn_count[cloth]++;
            }
            if (k->pull_across[t] > limit) {
                w->particles.torn[to] |= PHYS_CLOTH_TORN_ACROSS;
                all->torn_count[cloth]++;
            }
        }
    }
}

static bool is_finite(const phys_cloth_work *k) {
    float sum = 0.0f;
    for (uint32_t i = 0; i < k->rows * k->stride; i++) {
        sum += k->x[0][i] + k->x[1][i] + k->x[2][i] + k->v[0][i] + k->v[1][i] + k->v[2][i];
    }
    return phys_finite(sum);
}

static void stop(phys_world *w, uint32_t cloth) {
    phys_particles *p = &w->particles;
    phys_cloths *all = &w->cloths;
    size_t bytes = sizeof(float) * all->rows[cloth] * all->columns[cloth];
    all->asleep[cloth] = 1;
    memset(p->vx + all->first[cloth], 0, bytes);
    memset(p->vy + all->first[cloth], 0, bytes);
    memset(p->vz + all->first[cloth], 0, bytes);
}

// Takes places and velocities over. A cloth that is no longer finite stays where it was.
static void unpack(phys_world *w, const phys_cloth_work *k, float dt) {
    phys_particles *p = &w->particles;
    phys_cloths *all = &w->cloths;
    uint32_t cloth = k->cloth, first = all->first[cloth];
    float fastest = 0.0f;
    if (!is_finite(k)) {
        core_handle h = core_columns_handle(&all->set, cloth);
        core_fail("phys cloth %u:%u is no longer finite: it is stopped", h.index, h.generation);
        stop(w, cloth);
        return;
    }
    for (uint32_t r = 0; r < k->rows; r++) {
        for (uint32_t c = 0; c < k->columns; c++) {
            uint32_t i = r * k->stride + c, to = first + r * k->columns + c;
            core_vec3 v = phys_get3(k->v[0], k->v[1], k->v[2], i);
            phys_put3(p->x, p->y, p->z, to, at(k, i));
            phys_put3(p->vx, p->vy, p->vz, to, v);
            fastest = CORE_MAX(fastest, core_v3_dot(v, v));
        }
    }
    all->still[cloth] = fastest < REST_SPEED * REST_SPEED ? all->still[cloth] + dt : 0.0f;
    if (w->sleep && all->still[cloth] > REST_TIME) {
        stop(w, cloth);
    }
}

// A hold on a body that is gone lets go; bodies that move wake the cloth that they hold or reach.
static void drop_dead_holds(phys_world *w) {
    phys_holds *h = &w->holds;
    for (uint32_t k = core_columns_count(&h->set); k-- > 0;) {
        if (core_handle_is_null(h->body[k])) {
            continue;
        }
        uint32_t row = phys_body_row(w, h->body[k]);
        uint32_t cloth = phys_slot_row(&w->cloths.set, h->cloth[k]);
        if (row == CORE_NO_ROW || phys_moves(&w->bodies, row)) {
            w->cloths.asleep[cloth] = 0;
        }
        if (row == CORE_NO_ROW) {
            core_columns_remove(&h->set, core_columns_handle(&h->set, k), NULL, NULL);
        }
    }
}

static void wake_by_reach(phys_world *w, uint32_t cloth, float dt) {
    core_aabb reach = phys_cloth_reach(w, cloth, dt);
    phys_box box = {{reach.min.x, reach.min.y, reach.min.z},
                    {reach.max.x, reach.max.y, reach.max.z}};
    uint32_t shape[64], found = phys_query_shapes(w, &box, shape, 64);
    uint32_t rule = w->rule[w->cloths.layer[cloth]];
    for (uint32_t i = 0; i < CORE_MIN(found, 64u); i++) {
        uint32_t row = phys_slot_row(&w->bodies.set, w->shapes.body[shape[i]]);
        bool moved = phys_moves(&w->bodies, row) || w->shapes.moved[shape[i]];
        if (moved && (rule >> w->bodies.layer[row] & 1u)) {
            w->cloths.asleep[cloth] = 0;
        }
    }
}

static void solve_chunk(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    job_item *items = ctx;
    for (uint32_t i = begin; i < end; i++) {
        CORE_SIMD_SELECT(phys_cloth_solve)(&items[i].work);
    }
}

void phys_cloths_update(phys_world *w, float dt, bool stale) {
    phys_cloths *c = &w->cloths;
    uint32_t n = core_columns_count(&c->set), awake = 0;
    if (n == 0) {
        return;
    }
    if (stale) {
        phys_cloths_wake(w);
    }
    drop_dead_holds(w);
    size_t mark = core_arena_mark(&w->scratch);
    job_item *items = CORE_ARENA_ARRAY(&w->scratch, job_item, n);
    for (uint32_t i = 0; i < n; i++) {
        if (c->asleep[i]) {
            wake_by_reach(w, i, dt);
        }
        if (!c->asleep[i]) {
            prepare(w, &items[awake++], i, dt);
        }
    }
    core_jobs_for(w->jobs, awake, 1, solve_chunk, items);
    for (uint32_t i = 0; i < awake; i++) {
        pull_bodies(w, &items[i], dt);
        push_bodies(w, &items[i].work, dt);
        tear_edges(w, &items[i].work);
        unpack(w, &items[i].work, dt);
    }
    core_arena_rewind(&w->scratch, mark);
}
