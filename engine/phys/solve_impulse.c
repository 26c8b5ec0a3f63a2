// The report's way (after Mirtich 1996), in its right form: one pass, one point a contact (the
// middle of its points), an impulse that is not accumulated, Coulomb friction, and overlap taken
// out by moving both bodies by their inverse masses. Kept as a baseline: it does not come to rest.
#include "phys/world.h"

typedef struct touch {
    uint32_t a, b;
    core_vec3 n, ra, rb;
    float depth, friction, restitution;
} touch;

static core_vec3 velocity_at(const phys_bodies *b, uint32_t i, core_vec3 r) {
    return core_v3_add(phys_get3(b->vx, b->vy, b->vz, i),
                       core_v3_cross(phys_get3(b->wx, b->wy, b->wz, i), r));
}

static float mass_along(const phys_bodies *b, const touch *t, core_vec3 axis) {
    core_vec3 ca = core_v3_cross(t->ra, axis), cb = core_v3_cross(t->rb, axis);
    float k = b->im[t->a] + b->im[t->b];
    k += core_v3_dot(ca, phys_body_inverse_inertia(b, t->a, ca));
    k += core_v3_dot(cb, phys_body_inverse_inertia(b, t->b, cb));
    return k > 0.0f ? 1.0f / k : 0.0f;
}

static void push(phys_bodies *b, uint32_t i, core_vec3 r, core_vec3 j) {
    core_vec3 w = phys_body_inverse_inertia(b, i, core_v3_cross(r, j));
    phys_put3(b->vx, b->vy, b->vz, i, core_v3_mad(phys_get3(b->vx, b->vy, b->vz, i), j, b->im[i]));
    phys_put3(b->wx, b->wy, b->wz, i, core_v3_add(phys_get3(b->wx, b->wy, b->wz, i), w));
}

static void collide(phys_bodies *b, const touch *t) {
    core_vec3 dv = core_v3_sub(velocity_at(b, t->b, t->rb), velocity_at(b, t->a, t->ra));
    float vn = core_v3_dot(dv, t->n);
    if (vn < 0.0f) {
        float jn = -(1.0f + t->restitution) * vn * mass_along(b, t, t->n);
        core_vec3 slip = core_v3_mad(dv, t->n, -vn);
        float speed = core_v3_length(slip);
        core_vec3 j = core_v3_scale(t->n, jn);
        if (speed > 1e-6f) { // at rest there is no direction to slide in
            core_vec3 u = core_v3_scale(slip, 1.0f / speed);
            float jt = CORE_MIN(speed * mass_along(b, t, u), t->friction * jn);
            j = core_v3_mad(j, u, -jt);
        }
        push(b, t->a, t->ra, core_v3_scale(j, -1.0f));
        push(b, t->b, t->rb, j);
    }
    float sum = b->im[t->a] + b->im[t->b];
    core_vec3 out = core_v3_scale(t->n, t->depth / sum);
    core_vec3 ca = phys_get3(b->cx, b->cy, b->cz, t->a), cb = phys_get3(b->cx, b->cy, b->cz, t->b);
    phys_put3(b->cx, b->cy, b->cz, t->a, core_v3_mad(ca, out, -b->im[t->a]));
    phys_put3(b->cx, b->cy, b->cz, t->b, core_v3_mad(cb, out, b->im[t->b]));
}

static void collide_balls(phys_world *w) {
    phys_bodies *b = &w->bodies;
    const phys_balls *c = &w->balls;
    for (uint32_t i = 0; i < core_columns_count(&c->set); i++) {
        if (!(c->separation[i] < 0.0f)) {
            continue;
        }
        touch t = {.a = c->a[i],
                   .b = c->b[i],
                   .n = phys_get3(c->nx, c->ny, c->nz, i),
                   .depth = -c->separation[i],
                   .friction = c->friction[i],
                   .restitution = c->restitution[i]};
        uint32_t shape = phys_slot_row(&w->shapes.set, c->sa[i]);
        t.ra = core_v3_scale(t.n, w->shapes.radius[shape]);
        core_vec3 d =
            core_v3_sub(phys_get3(b->cx, b->cy, b->cz, t.a), phys_get3(b->cx, b->cy, b->cz, t.b));
        t.rb = core_v3_add(d, t.ra);
        collide(b, &t);
    }
}

static void collide_manifolds(phys_world *w) {
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        const phys_manifold *m = &w->contacts.manifold[i];
        touch t = {.a = w->contacts.a[i],
                   .b = w->contacts.b[i],
                   .n = m->normal,
                   .friction = w->contacts.friction[i],
                   .restitution = w->contacts.restitution[i]};
        float count = 0.0f;
        for (uint32_t k = 0; k < m->count; k++) {
            if (m->point[k].separation < 0.0f) {
                t.ra = core_v3_add(t.ra, m->point[k].ra);
                t.rb = core_v3_add(t.rb, m->point[k].rb);
                t.depth = CORE_MAX(t.depth, -m->point[k].separation);
                count += 1.0f;
            }
        }
        if (count > 0.0f) {
            t.ra = core_v3_scale(t.ra, 1.0f / count);
            t.rb = core_v3_scale(t.rb, 1.0f / count);
            collide(&w->bodies, &t);
        }
    }
}

static void step_impulse(phys_world *w, float dt) {
    phys_bodies *b = &w->bodies;
    phys_integrate_velocity(w, dt);
    collide_balls(w);
    collide_manifolds(w);
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        if (b->type[i] != PHYS_STATIC) {
            core_vec3 v = phys_lock_motion(b->locks[i], phys_get3(b->vx, b->vy, b->vz, i));
            core_vec3 c = phys_get3(b->cx, b->cy, b->cz, i);
            phys_put3(b->cx, b->cy, b->cz, i, core_v3_mad(c, v, dt));
            phys_integrate_rotation(b, i, dt);
        }
    }
}

const phys_solver_method phys_solver_impulse = {"impulse", 1, 0, false, step_impulse};
