// Sequential impulses (Catto, "Iterative dynamics with temporal coherence", GDC 2005): scalar, one
// contact point after the other, warm started, in substeps with a relax pass that takes back the
// velocity which position correction added. The simple baseline beside the wide solver.
#include "phys/world.h"

#define STIFFNESS 0.25f // contact frequency over substep frequency
#define DAMPING   10.0f // ratio to critical: overlap creeps out instead of springing
#define PUSH_MAX  4.0f  // m/s, fastest removal of overlap

// A damped spring as a constraint, by implicit Euler (Catto, "Soft constraints", GDC 2011).
typedef struct soft {
    float bias_rate, mass_scale, impulse_scale;
} soft;

static soft make_soft(float h) {
    float omega_h = 2.0f * CORE_PI_F * STIFFNESS;
    float a1 = 2.0f * DAMPING + omega_h, a2 = omega_h * a1, a3 = 1.0f / (1.0f + a2);
    return (soft){omega_h / (a1 * h), a2 * a3, a3};
}

typedef struct row {
    uint32_t a, b;
    core_vec3 n, t[2], ra, rb;
    float separation, approach; // at the start of the step
    float mass_n, mass_t[2];
    float jn, jt[2], jn_max;
    float friction, restitution;
} row;

typedef struct solve {
    phys_bodies *bodies;
    core_vec3 *dp, *dr; // way and turn of each body since the start of the step
    row *rows;
    uint32_t count;
} solve;

static core_vec3 velocity_at(const phys_bodies *b, uint32_t i, core_vec3 r) {
    return core_v3_add(phys_get3(b->vx, b->vy, b->vz, i),
                       core_v3_cross(phys_get3(b->wx, b->wy, b->wz, i), r));
}

static float effective_mass(const phys_bodies *b, const row *r, core_vec3 axis) {
    core_vec3 ca = core_v3_cross(r->ra, axis), cb = core_v3_cross(r->rb, axis);
    float k = b->im[r->a] + b->im[r->b];
    k += core_v3_dot(ca, phys_body_inverse_inertia(b, r->a, ca));
    k += core_v3_dot(cb, phys_body_inverse_inertia(b, r->b, cb));
    return k > 0.0f ? 1.0f / k : 0.0f;
}

static void apply(phys_bodies *b, const row *r, core_vec3 j) {
    core_vec3 wa = phys_body_inverse_inertia(b, r->a, core_v3_cross(r->ra, j));
    core_vec3 wb = phys_body_inverse_inertia(b, r->b, core_v3_cross(r->rb, j));
    uint32_t a = r->a, c = r->b;
    phys_put3(b->vx, b->vy, b->vz, a, core_v3_mad(phys_get3(b->vx, b->vy, b->vz, a), j, -b->im[a]));
    phys_put3(b->wx, b->wy, b->wz, a, core_v3_sub(phys_get3(b->wx, b->wy, b->wz, a), wa));
    phys_put3(b->vx, b->vy, b->vz, c, core_v3_mad(phys_get3(b->vx, b->vy, b->vz, c), j, b->im[c]));
    phys_put3(b->wx, b->wy, b->wz, c, core_v3_add(phys_get3(b->wx, b->wy, b->wz, c), wb));
}

static void finish_row(const phys_world *w, row *r, core_vec3 rub) {
    const phys_bodies *b = &w->bodies;
    phys_basis(r->n, &r->t[0], &r->t[1]);
    r->jt[0] = core_v3_dot(rub, r->t[0]);
    r->jt[1] = core_v3_dot(rub, r->t[1]);
    r->mass_n = effective_mass(b, r, r->n);
    r->mass_t[0] = effective_mass(b, r, r->t[0]);
    r->mass_t[1] = effective_mass(b, r, r->t[1]);
    core_vec3 dv = core_v3_sub(velocity_at(b, r->b, r->rb), velocity_at(b, r->a, r->ra));
    r->approach = core_v3_dot(dv, r->n);
}

static void gather(phys_world *w, solve *s) {
    const phys_bodies *b = &w->bodies;
    const phys_balls *balls = &w->balls;
    uint32_t ball_count = core_columns_count(&balls->set);
    uint32_t contacts = core_columns_count(&w->contacts.set);
    s->rows = CORE_ARENA_ARRAY(&w->scratch, row, ball_count + 4u * contacts + 1u);
    for (uint32_t i = 0; i < ball_count; i++) {
        if (balls->separation[i] >= PHYS_APART) {
            continue;
        }
        row *r = &s->rows[s->count++];
        uint32_t a = balls->a[i], c = balls->b[i];
        *r = (row){.a = a,
                   .b = c,
                   .n = phys_get3(balls->nx, balls->ny, balls->nz, i),
                   .separation = balls->separation[i],
                   .jn = balls->jn[i],
                   .friction = balls->friction[i],
                   .restitution = balls->restitution[i]};
        uint32_t shape = phys_slot_row(&w->shapes.set, balls->sa[i]);
        r->ra = core_v3_scale(r->n, w->shapes.radius[shape] + 0.5f * r->separation);
        core_vec3 d =
            core_v3_sub(phys_get3(b->cx, b->cy, b->cz, a), phys_get3(b->cx, b->cy, b->cz, c));
        r->rb = core_v3_add(d, r->ra);
        finish_row(w, r, phys_get3(balls->jx, balls->jy, balls->jz, i));
    }
    for (uint32_t i = 0; i < contacts; i++) {
        const phys_manifold *m = &w->contacts.manifold[i];
        for (uint32_t k = 0; k < m->count; k++) {
            const phys_point *p = &m->point[k];
            row *r = &s->rows[s->count++];
            *r = (row){.a = w->contacts.a[i],
                       .b = w->contacts.b[i],
                       .n = m->normal,
                       .ra = p->ra,
                       .rb = p->rb,
                       .separation = p->separation,
                       .jn = p->normal_impulse,
                       .friction = w->contacts.friction[i],
                       .restitution = w->contacts.restitution[i]};
            finish_row(w, r, core_v3_scale(m->friction, 1.0f / (float)m->count));
        }
    }
}

static core_vec3 rub_of(const row *r) {
    return core_v3_add(core_v3_scale(r->t[0], r->jt[0]), core_v3_scale(r->t[1], r->jt[1]));
}

// Writes the impulses back in the order in which gather read them.
static void scatter(phys_world *w, const solve *s) {
    const row *r = s->rows;
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        if (w->balls.separation[i] < PHYS_APART) {
            w->balls.jn[i] = r->jn;
            phys_put3(w->balls.jx, w->balls.jy, w->balls.jz, i, rub_of(r));
            r++;
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        phys_manifold *m = &w->contacts.manifold[i];
        m->friction = core_v3(0, 0, 0);
        for (uint32_t k = 0; k < m->count; k++, r++) {
            m->point[k].normal_impulse = r->jn;
            m->friction = core_v3_add(m->friction, rub_of(r));
        }
    }
}

static void warm_start(solve *s) {
    for (uint32_t i = 0; i < s->count; i++) {
        const row *r = &s->rows[i];
        core_vec3 j = core_v3_scale(r->n, r->jn);
        j = core_v3_mad(core_v3_mad(j, r->t[0], r->jt[0]), r->t[1], r->jt[1]);
        apply(s->bodies, r, j);
    }
}

static void solve_row(solve *s, row *r, float h, const soft *correct) {
    phys_bodies *b = s->bodies;
    core_vec3 pa = core_v3_add(s->dp[r->a], core_v3_cross(s->dr[r->a], r->ra));
    core_vec3 pb = core_v3_add(s->dp[r->b], core_v3_cross(s->dr[r->b], r->rb));
    float separation = r->separation + core_v3_dot(core_v3_sub(pb, pa), r->n);
    float bias = 0.0f, mass_scale = 1.0f, impulse_scale = 0.0f;
    if (separation > 0.0f) {
        bias = separation / h; // may close the gap in this substep, no faster
    } else if (correct) {
        bias = CORE_MAX(separation * correct->bias_rate, -PUSH_MAX);
        mass_scale = correct->mass_scale;
        impulse_scale = correct->impulse_scale;
    }
    core_vec3 dv = core_v3_sub(velocity_at(b, r->b, r->rb), velocity_at(b, r->a, r->ra));
    float old = r->jn;
    float pull = r->mass_n * mass_scale * (core_v3_dot(dv, r->n) + bias) + impulse_scale * old;
    r->jn = CORE_MAX(old - pull, 0.0f);
    r->jn_max = CORE_MAX(r->jn_max, r->jn);
    apply(b, r, core_v3_scale(r->n, r->jn - old));
    dv = core_v3_sub(velocity_at(b, r->b, r->rb), velocity_at(b, r->a, r->ra));
    float limit = r->friction * r->jn;
    for (int k = 0; k < 2; k++) {
        float was = r->jt[k];
        r->jt[k] = CORE_CLAMP(was - r->mass_t[k] * core_v3_dot(dv, r->t[k]), -limit, limit);
        apply(b, r, core_v3_scale(r->t[k], r->jt[k] - was));
    }
}

static void solve_all(solve *s, float h, const soft *correct) {
    for (uint32_t i = 0; i < s->count; i++) {
        solve_row(s, &s->rows[i], h, correct);
    }
}

// Bodies without contacts get the exact term of a constant force: v is that at the end of h.
static void move(phys_world *w, solve *s, float h) {
    phys_bodies *b = s->bodies;
    uint32_t n = core_columns_count(&b->set);
    for (uint32_t i = 0; i < n; i++) {
        if (b->type[i] == PHYS_STATIC) {
            continue;
        }
        core_vec3 v = phys_lock_motion(b->locks[i], phys_get3(b->vx, b->vy, b->vz, i));
        phys_put3(b->vx, b->vy, b->vz, i, v);
        core_vec3 step = core_v3_scale(v, h);
        if (b->touching[i] == 0 && b->type[i] == PHYS_DYNAMIC && b->locks[i] == 0) {
            core_vec3 a = core_v3_scale(w->gravity, b->gravity_scale[i]);
            step = core_v3_mad(step, core_v3_mad(a, b->force[i], b->im[i]), -0.5f * h * h);
        }
        s->dp[i] = core_v3_add(s->dp[i], step);
        s->dr[i] = core_v3_mad(s->dr[i], phys_get3(b->wx, b->wy, b->wz, i), h);
        phys_put3(b->cx, b->cy, b->cz, i, core_v3_add(phys_get3(b->cx, b->cy, b->cz, i), step));
        phys_integrate_rotation(b, i, h);
    }
}

// Points that pushed and came in fast leave with the restitution's share of that speed.
static void restitute(solve *s) {
    for (uint32_t i = 0; i < s->count; i++) {
        row *r = &s->rows[i];
        if (r->restitution == 0.0f || r->approach > -PHYS_BOUNCE_MIN || r->jn_max == 0.0f) {
            continue;
        }
        core_vec3 dv =
            core_v3_sub(velocity_at(s->bodies, r->b, r->rb), velocity_at(s->bodies, r->a, r->ra));
        float old = r->jn;
        float want = core_v3_dot(dv, r->n) + r->restitution * r->approach;
        r->jn = CORE_MAX(old - r->mass_n * want, 0.0f);
        apply(s->bodies, r, core_v3_scale(r->n, r->jn - old));
    }
}

static void step_sequential(phys_world *w, float dt) {
    size_t mark = core_arena_mark(&w->scratch);
    uint32_t n = core_columns_count(&w->bodies.set);
    int substeps = w->substeps ? w->substeps : w->solver->substeps;
    int iterations = w->iterations ? w->iterations : w->solver->iterations;
    float h = dt / (float)substeps;
    solve s = {.bodies = &w->bodies};
    soft spring = make_soft(h);
    s.dp = CORE_ARENA_ARRAY(&w->scratch, core_vec3, n + 1);
    s.dr = CORE_ARENA_ARRAY(&w->scratch, core_vec3, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        s.dp[i] = s.dr[i] = core_v3(0, 0, 0);
    }
    gather(w, &s);
    for (int k = 0; k < substeps; k++) {
        phys_integrate_velocity(w, h);
        warm_start(&s);
        for (int i = 0; i < iterations; i++) {
            solve_all(&s, h, &spring);
        }
        move(w, &s, h);
        solve_all(&s, h, NULL);
    }
    restitute(&s);
    scatter(w, &s);
    core_arena_rewind(&w->scratch, mark);
}

const phys_solver_method phys_solver_sequential = {"sequential", 4, 2, false, step_sequential};
