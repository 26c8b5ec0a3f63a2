// The default solver: soft contact constraints in substeps with a relax pass (after Catto,
// "Solver2D" 2024, and Macklin et al., "Small steps in physics simulation", 2019), on
// graph-coloured wide lanes. What differs: ball contacts have their own small kernel; the warm
// start of a substep is what contacts gave a body in the one before, taken from the body itself, so
// that only two passes over the contacts remain per substep; contact stiffness follows the substep
// rate.
#include "phys/soft.h"
#include "phys/joint_solve.h"

#include <string.h>

#define SOFT_COLORS 64u // colour 64: more contacts on one body than colours, solved one by one
// Contact frequency over substep frequency; islands with more substeps are those that tremble when
// stiff: heavy on light, slender towers.
#define STIFFNESS      0.16f
#define STIFFNESS_HARD 0.125f
#define DAMPING        10.0f
// Rolling resistance, as a part of the radius, of balls that touch more than one thing: without it
// a heap never comes to rest. A lone ball on a floor has none but its material's.
#define PILE_ROLLING       0.02f
#define FIRST_TOUCH_MOST   64u
#define FIRST_TOUCH_PASSES 6
#define PUSH_MAX           3.0f // m/s
#define TOP_TURN           0.1f // rad a step
#define TOP_RATIO          4.0f // of the greatest moment of inertia to the least

enum { GROUP_BALLS, GROUP_MANIFOLDS, GROUP_FIXED_BALLS, GROUP_FIXED_MANIFOLDS, GROUPS };

typedef struct soft_group {
    uint32_t lanes[SOFT_COLORS + 1]; // contacts by colour
    uint32_t first[SOFT_COLORS + 2]; // first block of each colour
    ball_block *balls;
    manifold_block *manifolds;
} soft_group;

// Where a contact went: its group (GROUPS: not in reach), colour and lane of that colour.
typedef struct soft_place {
    uint8_t group, color;
    uint32_t lane;
} soft_place;

typedef struct soft_top {
    uint32_t place;
    core_quat at;       // its rotation, composed of the turns so far
    core_vec3 turn;     // their sum
    core_vec3 spin;     // angular velocity as it was left
    core_vec3 momentum; // what belongs to it
} soft_top;

typedef struct soft {
    phys_world *world;
    // What this level of substeps is about: rows of bodies and contacts, and each body row's place.
    uint32_t *body, *ball, *contact, *index;
    uint32_t ball_count, contact_count;
    uint32_t *locked, locked_count; // places of bodies with locked axes
    soft_top *tops;                 // bodies that spin fast while they are held
    uint32_t top_count;
    bool *top; // by place
    soft_bodies bodies;
    soft_spring spring, spring_fixed;
    soft_group group[GROUPS];
    soft_place *ball_place, *contact_place;
    soft_joints *joints; // NULL: none
    soft_balls_fn *run_balls;
    soft_manifolds_fn *run_manifolds;
    soft_flat_fn *push, *move;
    bool bounces;
    uint32_t level;
    int substeps;
    float dt, h, now; // now: time of the substep
} soft;

static soft_spring make_spring(float h, float stiffness) {
    float omega_h = 2.0f * CORE_PI_F * stiffness;
    float a1 = 2.0f * DAMPING + omega_h, a2 = omega_h * a1, a3 = 1.0f / (1.0f + a2);
    return (soft_spring){omega_h / (a1 * h), a2 * a3, a3, PUSH_MAX, h, 1.0f / h};
}

static void fill_inertia(const phys_bodies *b, uint32_t i, float *out) {
    if (b->flags[i] & PHYS_BODY_ISOTROPIC) {
        out[0] = out[1] = out[2] = b->ix[i];
        return;
    }
    core_quat q = phys_body_quat(b, i);
    q = b->flags[i] & PHYS_BODY_FRAME ? phys_quat_mul(q, b->iq[i]) : q;
    phys_mat3 m = phys_quat_mat(q);
    core_vec3 inv = phys_get3(b->ix, b->iy, b->iz, i);
    core_vec3 x = core_v3(m.x.x * inv.x, m.x.y * inv.y, m.x.z * inv.z);
    core_vec3 y = core_v3(m.y.x * inv.x, m.y.y * inv.y, m.y.z * inv.z);
    core_vec3 z = core_v3(m.z.x * inv.x, m.z.y * inv.y, m.z.z * inv.z);
    out[0] = core_v3_dot(x, m.x);
    out[1] = core_v3_dot(y, m.y);
    out[2] = core_v3_dot(z, m.z);
    out[4] = core_v3_dot(x, m.y);
    out[5] = core_v3_dot(x, m.z);
    out[6] = core_v3_dot(y, m.z);
}

static void lock_inertia(uint8_t locks, float *out) {
    float x = locks & PHYS_LOCK_TURN_X ? 0.0f : 1.0f, y = locks & PHYS_LOCK_TURN_Y ? 0.0f : 1.0f;
    float z = locks & PHYS_LOCK_TURN_Z ? 0.0f : 1.0f;
    float mask[8] = {x, y, z, 0, x * y, x * z, y * z, 0};
    for (int k = 0; k < 8; k++) {
        out[k] *= mask[k];
    }
}

static core_vec3 pull_on(const soft *s, uint32_t k) {
    const phys_world *w = s->world;
    const phys_bodies *b = &w->bodies;
    uint32_t i = s->body[k];
    core_vec3 a = core_v3_scale(w->gravity, b->gravity_scale[i]);
    a = core_v3_mad(a, b->force[i], b->im[i]);
    if (phys_pulled(w)) {
        const float *moved = s->bodies.moved + (size_t)k * 8;
        const float *v = s->bodies.velocity + (size_t)k * 8;
        core_vec3 at = core_v3(b->cx[i] + moved[0], b->cy[i] + moved[1], b->cz[i] + moved[2]);
        a = core_v3_add(a, phys_pull(w, at, core_v3(v[0], v[1], v[2]), s->now, i));
    }
    return a;
}

static void fill_body(soft *s, uint32_t k) {
    const phys_bodies *b = &s->world->bodies;
    uint32_t i = s->body[k];
    float *v = s->bodies.velocity + (size_t)k * 8, *p = s->bodies.push + (size_t)k * 8;
    memset(s->bodies.moved + (size_t)k * 8, 0, 8 * sizeof(float));
    memset(s->bodies.inertia + (size_t)k * 8, 0, 8 * sizeof(float));
    memset(p, 0, 8 * sizeof(float));
    float row[8] = {b->vx[i], b->vy[i], b->vz[i], 0, b->wx[i], b->wy[i], b->wz[i], 0};
    memcpy(v, row, sizeof row);
    memcpy(s->bodies.mark + (size_t)k * 8, row, sizeof row);
    if (b->type[i] != PHYS_DYNAMIC) {
        return;
    }
    fill_inertia(b, i, s->bodies.inertia + (size_t)k * 8);
    lock_inertia(b->locks[i], s->bodies.inertia + (size_t)k * 8);
    core_vec3 a = core_v3_scale(pull_on(s, k), s->h);
    memcpy(p, &a, sizeof a);
    core_vec3 t = b->torque[i];
    if (t.x != 0.0f || t.y != 0.0f || t.z != 0.0f) {
        t = core_v3_scale(phys_body_inverse_inertia(b, i, t), s->h);
        memcpy(p + 4, &t, sizeof t);
    }
}

static void fill_bodies_job(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk,
                            uint32_t worker) {
    (void)chunk;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        fill_body(ctx, i);
    }
}

static void make_damping(soft *s, core_arena *arena, uint32_t n) {
    const phys_bodies *b = &s->world->bodies;
    bool any = false;
    for (uint32_t i = 0; i < n; i++) {
        any |= b->linear_damping[s->body[i]] != 0.0f || b->angular_damping[s->body[i]] != 0.0f;
    }
    if (!any) {
        return;
    }
    float *keep = s->bodies.keep = CORE_ARENA_ARRAY(arena, float, ((size_t)n + 2) * 8);
    for (uint32_t i = 0; i < n + 2; i++) {
        uint32_t row = i < n ? s->body[i] : 0;
        bool dynamic = i < n && b->type[row] == PHYS_DYNAMIC;
        float l = dynamic ? 1.0f / (1.0f + b->linear_damping[row] * s->h) : 1.0f;
        float a = dynamic ? 1.0f / (1.0f + b->angular_damping[row] * s->h) : 1.0f;
        for (int k = 0; k < 4; k++) {
            keep[(size_t)i * 8 + (size_t)k] = l;
            keep[(size_t)i * 8 + 4 + (size_t)k] = a;
        }
    }
}

// Row n is the one that empty lanes point to; one more pads the flat passes to 16 floats.
static void make_bodies(soft *s) {
    core_arena *arena = &s->world->scratch;
    uint32_t n = s->bodies.count;
    size_t floats = ((size_t)n + 2) * 8;
    s->bodies.velocity = CORE_ARENA_ARRAY(arena, float, floats);
    s->bodies.moved = CORE_ARENA_ARRAY(arena, float, floats);
    s->bodies.push = CORE_ARENA_ARRAY(arena, float, floats);
    s->bodies.mark = CORE_ARENA_ARRAY(arena, float, floats);
    s->bodies.inertia = CORE_ARENA_ARRAY(arena, float, floats);
    size_t tail = 16 * sizeof(float), at = (size_t)n * 8;
    memset(s->bodies.velocity + at, 0, tail);
    memset(s->bodies.moved + at, 0, tail);
    memset(s->bodies.push + at, 0, tail);
    memset(s->bodies.mark + at, 0, tail);
    memset(s->bodies.inertia + at, 0, tail);
    core_jobs_for(s->world->jobs, n, 512, fill_bodies_job, s);
    make_damping(s, arena, n);
}

// First free colour of both bodies; first fit keeps the number of colours small.
static soft_place place(soft_group *group, uint64_t (*used)[GROUPS], uint8_t g, uint32_t a,
                        uint32_t b, bool fixed) {
    uint64_t taken = used[a][g] | (fixed ? 0 : used[b][g]);
    uint8_t color = taken == UINT64_MAX ? (uint8_t)SOFT_COLORS : (uint8_t)__builtin_ctzll(~taken);
    if (color < SOFT_COLORS) {
        used[a][g] |= (uint64_t)1 << color;
        used[b][g] |= fixed ? 0 : (uint64_t)1 << color;
    }
    return (soft_place){g, color, group[g].lanes[color]++};
}

// A level's contacts are all in reach; a is the one that moves.
static void color_contacts(soft *s) {
    phys_world *w = s->world;
    uint32_t n = s->bodies.count;
    uint64_t(*used)[GROUPS] = core_arena_alloc(&w->scratch, sizeof *used * (n + 1), "colours");
    memset(used, 0, sizeof *used * (n + 1));
    s->ball_place = CORE_ARENA_ARRAY(&w->scratch, soft_place, s->ball_count + 1);
    s->contact_place = CORE_ARENA_ARRAY(&w->scratch, soft_place, s->contact_count + 1);
    for (uint32_t k = 0; k < s->ball_count; k++) {
        uint32_t i = s->ball[k], a = w->balls.a[i], b = w->balls.b[i];
        bool flip = !phys_mobile(&w->bodies, a), fixed = flip || !phys_mobile(&w->bodies, b);
        s->bounces |= w->balls.restitution[i] > 0.0f;
        s->ball_place[k] = place(s->group, used, fixed ? GROUP_FIXED_BALLS : GROUP_BALLS,
                                 s->index[flip ? b : a], s->index[flip ? a : b], fixed);
    }
    for (uint32_t k = 0; k < s->contact_count; k++) {
        uint32_t i = s->contact[k], a = w->contacts.a[i], b = w->contacts.b[i];
        bool flip = !phys_mobile(&w->bodies, a), fixed = flip || !phys_mobile(&w->bodies, b);
        s->bounces |= w->contacts.restitution[i] > 0.0f;
        s->contact_place[k] = place(s->group, used, fixed ? GROUP_FIXED_MANIFOLDS : GROUP_MANIFOLDS,
                                    s->index[flip ? b : a], s->index[flip ? a : b], fixed);
    }
}

// Blocks of each colour; the contacts of the last colour get a block each.
static void make_blocks(soft *s) {
    core_arena *arena = &s->world->scratch;
    for (int g = 0; g < GROUPS; g++) {
        soft_group *group = &s->group[g];
        uint32_t blocks = 0;
        for (uint32_t c = 0; c < SOFT_COLORS; c++) {
            group->first[c] = blocks;
            blocks += (group->lanes[c] + SOFT_LANES - 1) / SOFT_LANES;
        }
        group->first[SOFT_COLORS] = blocks;
        blocks += group->lanes[SOFT_COLORS];
        group->first[SOFT_COLORS + 1] = blocks;
        bool balls = g == GROUP_BALLS || g == GROUP_FIXED_BALLS;
        size_t size = balls ? sizeof(ball_block) : sizeof(manifold_block);
        uint8_t *data = core_arena_alloc(arena, size * blocks + 1, "contact blocks");
        group->balls = balls ? (ball_block *)data : NULL;
        group->manifolds = balls ? NULL : (manifold_block *)data;
        for (uint32_t c = 0; c <= SOFT_COLORS; c++) { // lanes that stay empty
            bool full = c < SOFT_COLORS && group->lanes[c] % SOFT_LANES == 0;
            uint32_t from = c < SOFT_COLORS ? group->first[c + 1] - 1 : group->first[c];
            for (uint32_t k = from; !full && k < group->first[c + 1]; k++) {
                int32_t *index = (int32_t *)(data + size * k);
                memset(index, 0, size);
                for (int i = 0; i < 2 * SOFT_LANES; i++) { // a, then b
                    index[i] = (int32_t)s->bodies.count;
                }
            }
        }
    }
}

static uint32_t block_of(const soft_group *group, soft_place p, uint32_t *lane) {
    *lane = p.color < SOFT_COLORS ? p.lane % SOFT_LANES : 0;
    return group->first[p.color] + (p.color < SOFT_COLORS ? p.lane / SOFT_LANES : p.lane);
}

static void fill_ball(soft *s, uint32_t j) {
    const phys_world *w = s->world;
    const phys_balls *p = &w->balls;
    const phys_bodies *b = &w->bodies;
    uint32_t k, i = s->ball[j];
    soft_group *group = &s->group[s->ball_place[j].group];
    ball_block *c = &group->balls[block_of(group, s->ball_place[j], &k)];
    bool fixed = s->ball_place[j].group == GROUP_FIXED_BALLS, flip = !phys_mobile(b, p->a[i]);
    uint32_t a = flip ? p->b[i] : p->a[i], o = flip ? p->a[i] : p->b[i];
    uint32_t sa = flip ? p->sb[i] : p->sa[i], so = flip ? p->sa[i] : p->sb[i];
    float ra = w->shapes.radius[phys_slot_row(&w->shapes.set, sa)];
    float rb = fixed ? 0.0f : w->shapes.radius[phys_slot_row(&w->shapes.set, so)];
    float sign = flip ? -1.0f : 1.0f;
    c->a[k] = (int32_t)s->index[a];
    c->b[k] = (int32_t)(fixed ? s->bodies.count : s->index[o]);
    c->nx[k] = sign * p->nx[i];
    c->ny[k] = sign * p->ny[i];
    c->nz[k] = sign * p->nz[i];
    c->gap[k] = p->separation[i];
    c->jn[k] = p->jn[i];
    c->jx[k] = sign * p->jx[i];
    c->jy[k] = sign * p->jy[i];
    c->jz[k] = sign * p->jz[i];
    c->rx[k] = sign * p->rx[i];
    c->ry[k] = sign * p->ry[i];
    c->rz[k] = sign * p->rz[i];
    c->ima[k] = b->im[a];
    c->imb[k] = fixed ? 0.0f : b->im[o];
    c->ra[k] = ra;
    c->rb[k] = rb;
    c->ia[k] = b->ix[a];
    c->ib[k] = fixed ? 0.0f : b->ix[o];
    bool pile = b->touching[a] > 1 && (fixed || b->touching[o] > 1);
    c->roll[k] = ra * (p->rolling[i] + (pile ? PILE_ROLLING : 0.0f));
    c->friction[k] = p->friction[i];
    c->restitution[k] = p->restitution[i];
}

static void fill_manifold(soft *s, uint32_t l) {
    const phys_world *w = s->world;
    const phys_bodies *b = &w->bodies;
    uint32_t k, i = s->contact[l], a = w->contacts.a[i], o = w->contacts.b[i];
    soft_group *group = &s->group[s->contact_place[l].group];
    manifold_block *c = &group->manifolds[block_of(group, s->contact_place[l], &k)];
    const phys_manifold *m = &w->contacts.manifold[i];
    bool flip = !phys_mobile(b, a);
    float sign = flip ? -1.0f : 1.0f;
    core_vec3 n = core_v3_scale(m->normal, sign), rub = core_v3_scale(m->friction, sign), t1, t2;
    uint32_t first = flip ? o : a, second = flip ? a : o;
    c->a[k] = (int32_t)s->index[first];
    c->b[k] = (int32_t)s->index[second];
    c->nx[k] = n.x;
    c->ny[k] = n.y;
    c->nz[k] = n.z;
    c->ima[k] = b->im[first];
    c->imb[k] = phys_mobile(b, second) ? b->im[second] : 0.0f;
    c->count[k] = (float)m->count;
    c->friction[k] = w->contacts.friction[i];
    c->restitution[k] = w->contacts.restitution[i];
    c->twist[k] = m->twist;
    phys_basis(n, &t1, &t2);
    c->tangent[0].impulse[k] = core_v3_dot(rub, t1);
    c->tangent[1].impulse[k] = core_v3_dot(rub, t2);
    for (uint32_t j = 0; j < 4; j++) {
        const phys_point *p = &m->point[j];
        soft_arm *r = &c->point[j];
        core_vec3 ra = flip ? p->rb : p->ra, rb = flip ? p->ra : p->rb;
        r->ax[k] = ra.x;
        r->ay[k] = ra.y;
        r->az[k] = ra.z;
        r->bx[k] = rb.x;
        r->by[k] = rb.y;
        r->bz[k] = rb.z;
        r->impulse[k] = p->normal_impulse;
        c->gap[j][k] = p->separation;
    }
}

static void store_ball(soft *s, uint32_t j) {
    phys_balls *p = &s->world->balls;
    uint32_t k, i = s->ball[j];
    const soft_group *group = &s->group[s->ball_place[j].group];
    const ball_block *c = &group->balls[block_of(group, s->ball_place[j], &k)];
    float sign = phys_mobile(&s->world->bodies, p->a[i]) ? 1.0f : -1.0f;
    p->jn[i] = c->jn[k];
    p->jx[i] = sign * c->jx[k];
    p->jy[i] = sign * c->jy[k];
    p->jz[i] = sign * c->jz[k];
    p->rx[i] = sign * c->rx[k];
    p->ry[i] = sign * c->ry[k];
    p->rz[i] = sign * c->rz[k];
}

static void store_manifold(soft *s, uint32_t l) {
    uint32_t k, i = s->contact[l];
    phys_manifold *m = &s->world->contacts.manifold[i];
    const soft_group *group = &s->group[s->contact_place[l].group];
    const manifold_block *c = &group->manifolds[block_of(group, s->contact_place[l], &k)];
    float sign = phys_mobile(&s->world->bodies, s->world->contacts.a[i]) ? 1.0f : -1.0f;
    float j1 = sign * c->tangent[0].impulse[k], j2 = sign * c->tangent[1].impulse[k];
    m->friction = core_v3(c->tx[0][k] * j1 + c->tx[1][k] * j2, c->ty[0][k] * j1 + c->ty[1][k] * j2,
                          c->tz[0][k] * j1 + c->tz[1][k] * j2);
    m->twist = c->twist[k];
    for (uint32_t j = 0; j < m->count; j++) {
        m->point[j].normal_impulse = c->point[j].impulse[k];
    }
}

typedef void each_fn(soft *s, uint32_t i);
typedef struct each_job {
    soft *s;
    each_fn *fn;
} each_job;
static void run_each(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const each_job *job = ctx;
    for (uint32_t i = begin; i < end; i++) {
        job->fn(job->s, i);
    }
}
static void each(soft *s, uint32_t count, each_fn *fn) {
    core_jobs_for(s->world->jobs, count, 256, run_each, &(each_job){s, fn});
}

typedef struct pass_job {
    soft *s;
    soft_pass pass;
    int group;
    uint32_t first;
} pass_job;

static void run_blocks(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const pass_job *job = ctx;
    soft *s = job->s;
    const soft_group *g = &s->group[job->group];
    bool fixed = job->group >= GROUP_FIXED_BALLS;
    const soft_spring *spring = fixed ? &s->spring_fixed : &s->spring;
    uint32_t from = job->first + begin, count = end - begin;
    if (g->balls != NULL) {
        s->run_balls(g->balls + from, count, &s->bodies, spring, job->pass, fixed);
    } else {
        s->run_manifolds(g->manifolds + from, count, &s->bodies, spring, job->pass, fixed);
    }
}

// Colour after colour; contacts with what cannot move come last and so have the last word.
static void run_pass(soft *s, soft_pass pass) {
    for (int g = 0; g < GROUPS; g++) {
        const soft_group *group = &s->group[g];
        for (uint32_t c = 0; c < SOFT_COLORS && group->lanes[c] != 0; c++) {
            uint32_t count = group->first[c + 1] - group->first[c];
            pass_job job = {s, pass, g, group->first[c]};
            core_jobs_for(s->world->jobs, count, 8, run_blocks, &job);
        }
        pass_job job = {s, pass, g, group->first[SOFT_COLORS]};
        run_blocks(&job, 0, group->lanes[SOFT_COLORS], 0, 0);
    }
}

static void pass_with_joints(soft *s, soft_pass pass, bool last) {
    if (s->joints != NULL) {
        phys_soft_joints_pass(s->joints, pass, last);
    }
    run_pass(s, pass);
}

typedef struct flat_job {
    soft *s;
    soft_flat_fn *fn;
} flat_job;
static void run_flat(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const flat_job *job = ctx;
    job->fn(&job->s->bodies, begin * 16, end * 16, job->s->h);
}
static void flat(soft *s, soft_flat_fn *fn) { // two bodies at a time: 16 floats
    core_jobs_for(s->world->jobs, (s->bodies.count + 1) / 2, 1024, run_flat, &(flat_job){s, fn});
}

// Axes along which a body must not move: its share of each pass is taken back at once.
static void hold_locks(soft *s) {
    const phys_bodies *b = &s->world->bodies;
    for (uint32_t n = 0; n < s->locked_count; n++) {
        float *v = s->bodies.velocity + (size_t)s->locked[n] * 8;
        uint8_t locks = b->locks[s->body[s->locked[n]]];
        core_vec3 l = phys_lock_motion(locks, core_v3(v[0], v[1], v[2]));
        core_vec3 a = phys_lock_turn(locks, core_v3(v[4], v[5], v[6]));
        memcpy(v, &l, sizeof l);
        memcpy(v + 4, &a, sizeof a);
    }
}

// What spins fast while it is held (a top, a wheel on a shaft that turns): its angular momentum,
// not its velocity, is kept from substep to substep, with the inertia of each. For the others once
// a step is enough.
static bool is_top(const soft *s, uint32_t k) {
    const phys_bodies *b = &s->world->bodies;
    uint32_t i = s->body[k];
    core_vec3 w = phys_get3(b->wx, b->wy, b->wz, i);
    // A rod that tumbles would turn a little momentum across it into a lot of spin about it.
    float least = CORE_MIN(b->ix[i], CORE_MIN(b->iy[i], b->iz[i]));
    float most = CORE_MAX(b->ix[i], CORE_MAX(b->iy[i], b->iz[i]));
    if (most > TOP_RATIO * least) {
        return false;
    }
    bool held = b->touching[i] != 0 || (s->joints != NULL && s->joints->jointed[k]);
    return held && b->type[i] == PHYS_DYNAMIC && (b->flags[i] & PHYS_BODY_ISOTROPIC) == 0 &&
           (b->locks[i] & PHYS_LOCK_TURN) == 0 &&
           core_v3_dot(w, w) * s->dt * s->dt > TOP_TURN * TOP_TURN;
}

static void find_tops(soft *s) {
    s->tops = CORE_ARENA_ARRAY(&s->world->scratch, soft_top, s->bodies.count + 1);
    s->top = CORE_ARENA_ARRAY(&s->world->scratch, bool, s->bodies.count + 1);
    const phys_bodies *b = &s->world->bodies;
    for (uint32_t k = 0; k < s->bodies.count; k++) {
        uint32_t i = s->body[k];
        s->top[k] = is_top(s, k);
        if (s->top[k]) {
            core_quat q = phys_body_quat(b, i);
            core_vec3 w = phys_get3(b->wx, b->wy, b->wz, i);
            s->tops[s->top_count++] = (soft_top){
                .place = k, .at = q, .spin = w, .momentum = phys_momentum_of(b, i, q, w)};
        }
    }
}

static void turn_tops(soft *s) {
    const phys_bodies *b = &s->world->bodies;
    for (uint32_t n = 0; n < s->top_count; n++) {
        soft_top *top = &s->tops[n];
        size_t at = (size_t)top->place * 8;
        uint32_t i = s->body[top->place];
        float *v = s->bodies.velocity + at, *p = s->bodies.moved + at, *mark = s->bodies.mark + at;
        core_vec3 turn = core_v3(p[4], p[5], p[6]);
        core_quat q = phys_quat_unit(phys_turned(top->at, core_v3_sub(turn, top->turn)));
        core_vec3 given = core_v3_sub(core_v3(v[4], v[5], v[6]), top->spin);
        given = phys_momentum_of(b, i, phys_body_quat(b, i), given);
        top->momentum = core_v3_add(top->momentum, given);
        core_vec3 w = phys_spin_of(b, i, q, top->momentum);
        float to[3] = {w.x, w.y, w.z};
        for (int a = 0; a < 3; a++) {
            mark[4 + a] += to[a] - v[4 + a]; // not given by a contact
            v[4 + a] = to[a];
        }
        top->at = q;
        top->turn = turn;
        top->spin = w;
    }
}

static void finish_tops(soft *s) {
    for (uint32_t n = 0; n < s->top_count; n++) {
        uint32_t k = s->tops[n].place;
        bool chained = s->joints != NULL && s->joints->jointed[k] == PHYS_CHAINED;
        if (!chained) {
            phys_put_quat(&s->world->bodies, s->body[k], s->tops[n].at);
        }
    }
}

static void refresh_fields(soft *s) {
    const phys_bodies *b = &s->world->bodies;
    for (uint32_t k = 0; k < s->bodies.count; k++) {
        if (b->type[s->body[k]] == PHYS_DYNAMIC) {
            core_vec3 a = pull_on(s, k);
            a = core_v3_scale(a, s->h);
            memcpy(s->bodies.push + (size_t)k * 8, &a, sizeof a);
        }
    }
}

// Writes a body back. Where nothing was touched the way gets the exact term of the constant part of
// the pull, and the turn follows the free rigid body; elsewhere it is the sum of the substeps.
static void finish_body(soft *s, uint32_t k) {
    phys_world *w = s->world;
    phys_bodies *b = &w->bodies;
    uint32_t i = s->body[k];
    if (s->level != 0 && b->type[i] != PHYS_DYNAMIC) {
        return; // every level carries the kinematic bodies along; one moves them
    }
    bool free = b->touching[i] == 0 && (s->joints == NULL || !s->joints->jointed[k]);
    if (free && b->type[i] == PHYS_DYNAMIC && phys_integrator_of(w, i) != NULL &&
        b->locks[i] == 0) {
        phys_integrate_free(w, i, s->dt, s->substeps);
        return;
    }
    const float *v = s->bodies.velocity + (size_t)k * 8, *p = s->bodies.moved + (size_t)k * 8;
    core_vec3 way = core_v3(p[0], p[1], p[2]), turn = core_v3(p[4], p[5], p[6]);
    phys_put3(b->vx, b->vy, b->vz, i, core_v3(v[0], v[1], v[2]));
    phys_put3(b->wx, b->wy, b->wz, i, core_v3(v[4], v[5], v[6]));
    if (free && b->type[i] == PHYS_DYNAMIC && b->locks[i] == 0) {
        core_vec3 a = core_v3_scale(w->gravity, b->gravity_scale[i]);
        a = core_v3_mad(a, b->force[i], b->im[i]);
        way = core_v3_mad(way, a, -0.5f * s->h * s->dt);
    }
    phys_put3(b->cx, b->cy, b->cz, i, core_v3_add(phys_get3(b->cx, b->cy, b->cz, i), way));
    if (s->joints != NULL && s->joints->jointed[k] == PHYS_CHAINED) {
        if (!s->top[k]) {
            phys_finish_precession(b, i, s->dt);
        }
        phys_put_quat(b, i, s->joints->rotation[k]);
        return;
    }
    if (s->top[k]) {
        return; // finish_tops
    }
    phys_finish_rotation(b, i, turn, s->dt, free);
}

// A first touch has no impulses to start from: where there are few contacts, some more passes find
// them at once, or a block on a slope would slip by some millimetres a second while they grow.
static bool first_touch(const soft *s) {
    if (s->contact_count > FIRST_TOUCH_MOST) {
        return false;
    }
    for (uint32_t k = 0; k < s->contact_count; k++) {
        const phys_manifold *m = &s->world->contacts.manifold[s->contact[k]];
        float sum = 0.0f;
        for (uint32_t i = 0; i < m->count; i++) {
            sum += m->point[i].normal_impulse;
        }
        if (sum == 0.0f) {
            return true;
        }
    }
    return false;
}

static void solve_substeps(soft *s, int substeps) {
    int extra = first_touch(s) ? FIRST_TOUCH_PASSES : 0;
    bool fields = phys_pulled(s->world);
    for (int k = 0; k < substeps; k++) {
        if (fields && k > 0) {
            s->now = (float)s->world->time + (float)k * s->h;
            refresh_fields(s);
        }
        turn_tops(s);
        flat(s, s->push);
        hold_locks(s);
        if (k == 0) {
            run_pass(s, SOFT_WARM);
        }
        bool last = k + 1 == substeps;
        pass_with_joints(s, SOFT_SOLVE, last);
        hold_locks(s);
        flat(s, s->move);
        if (s->joints != NULL) {
            phys_soft_joints_move(s->joints, last);
        }
        pass_with_joints(s, SOFT_RELAX, last);
        for (; extra > 0; extra--) {
            pass_with_joints(s, SOFT_RELAX, last);
        }
        hold_locks(s);
    }
    turn_tops(s);
    if (s->bounces) {
        run_pass(s, SOFT_RESTITUTE);
        hold_locks(s);
    }
}

// A contact belongs to the level of what moves in it; both bodies of an island have the same.
static bool on_level(const phys_bodies *b, uint32_t a, uint32_t o, uint32_t level) {
    bool ma = phys_mobile(b, a), mo = phys_mobile(b, o);
    return (ma || mo) && b->level[ma ? a : o] == level;
}

// Rows of a level. Static and sleeping bodies share the place of the empty lanes: all zeros.
static void collect(soft *s) {
    phys_world *w = s->world;
    const phys_bodies *b = &w->bodies;
    uint32_t n = core_columns_count(&b->set), balls = core_columns_count(&w->balls.set);
    uint32_t contacts = core_columns_count(&w->contacts.set), count = 0;
    s->body = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n + 1);
    s->index = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n + 1);
    s->ball = CORE_ARENA_ARRAY(&w->scratch, uint32_t, balls + 1);
    s->contact = CORE_ARENA_ARRAY(&w->scratch, uint32_t, contacts + 1);
    for (uint32_t i = 0; i < n; i++) {
        bool here = phys_mobile(b, i) ? b->level[i] == s->level : b->type[i] == PHYS_KINEMATIC;
        s->index[i] = here ? count : UINT32_MAX;
        s->body[count] = i;
        count += here;
    }
    s->bodies.count = count;
    s->locked = CORE_ARENA_ARRAY(&w->scratch, uint32_t, count + 1);
    for (uint32_t k = 0; k < count; k++) {
        s->locked[s->locked_count] = k;
        s->locked_count += b->locks[s->body[k]] != 0;
    }
    for (uint32_t i = 0; i < n; i++) {
        s->index[i] = CORE_MIN(s->index[i], count);
    }
    for (uint32_t i = 0; i < balls; i++) {
        s->ball[s->ball_count] = i;
        s->ball_count += w->balls.separation[i] < PHYS_APART &&
                         on_level(b, w->balls.a[i], w->balls.b[i], s->level);
    }
    for (uint32_t i = 0; i < contacts; i++) {
        s->contact[s->contact_count] = i;
        s->contact_count += w->contacts.manifold[i].count != 0 &&
                            on_level(b, w->contacts.a[i], w->contacts.b[i], s->level);
    }
}

static void step_level(phys_world *w, float dt, uint32_t level) {
    size_t mark = core_arena_mark(&w->scratch);
    int substeps = phys_level_substeps(w, level);
    soft s = {
        .world = w, .dt = dt, .h = dt / (float)substeps, .level = level, .substeps = substeps};
    float stiffness = level == PHYS_LEVEL_DEFAULT ? STIFFNESS : STIFFNESS_HARD;
    s.now = (float)w->time;
    s.spring = make_spring(s.h, stiffness);
    s.spring_fixed = make_spring(s.h, 2.0f * stiffness);
    s.run_balls = CORE_SIMD_SELECT(phys_soft_balls);
    s.run_manifolds = CORE_SIMD_SELECT(phys_soft_manifolds);
    s.push = CORE_SIMD_SELECT(phys_soft_push);
    s.move = CORE_SIMD_SELECT(phys_soft_move);
    collect(&s);
    if (s.bodies.count != 0) {
        make_bodies(&s);
        color_contacts(&s);
        make_blocks(&s);
        s.joints = phys_soft_joints_begin(w, &s.bodies, s.index, level, s.h,
                                          s.ball_count + s.contact_count == 0);
        each(&s, s.ball_count, fill_ball);
        each(&s, s.contact_count, fill_manifold);
        find_tops(&s);
        solve_substeps(&s, substeps);
        each(&s, s.ball_count, store_ball);
        each(&s, s.contact_count, store_manifold);
        if (s.joints != NULL) {
            phys_soft_joints_end(s.joints);
        }
        each(&s, s.bodies.count, finish_body);
        finish_tops(&s);
    }
    core_arena_rewind(&w->scratch, mark);
}

static void step_soft(phys_world *w, float dt) {
    bool used[PHYS_LEVELS] = {true};
    for (uint32_t i = 0; i < core_columns_count(&w->bodies.set); i++) {
        used[w->bodies.level[i]] = true;
    }
    for (uint32_t level = PHYS_LEVELS; level-- > 0;) {
        if (used[level]) {
            step_level(w, dt, level);
        }
    }
}

const phys_solver_method phys_solver_soft = {"soft", 8, 0, true, step_soft};
