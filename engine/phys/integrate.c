// Free motion between constraint solves.
#include "phys/world.h"

// sin and cos of a small half angle, then normalised: a pure rotation whose angle is right to x^6.
static void half_turn(float x, float *s, float *c) {
    x = CORE_CLAMP(x, -1.5f, 1.5f);
    float x2 = x * x;
    float sn = x * (1.0f - x2 * (1.0f / 6.0f - x2 * (1.0f / 120.0f)));
    float cs = 1.0f - x2 * (0.5f - x2 * (1.0f / 24.0f - x2 * (1.0f / 720.0f)));
    float k = 1.0f / core_sqrtf(sn * sn + cs * cs);
    *s = sn * k;
    *c = cs * k;
}

// Damping v / (1 + c h) never reverses a velocity, whatever c and h.
void phys_integrate_velocity(phys_world *w, float h) {
    phys_bodies *b = &w->bodies;
    uint32_t n = core_columns_count(&b->set);
    bool fields = phys_pulled(w);
    for (uint32_t i = 0; i < n; i++) {
        if (b->type[i] != PHYS_DYNAMIC) {
            continue;
        }
        core_vec3 a = core_v3_scale(w->gravity, b->gravity_scale[i]);
        a = core_v3_mad(a, b->force[i], b->im[i]);
        if (fields) { // of the present place: with the new velocity this stays symplectic
            core_vec3 at = phys_get3(b->cx, b->cy, b->cz, i);
            core_vec3 v = phys_get3(b->vx, b->vy, b->vz, i);
            a = core_v3_add(a, phys_pull(w, at, v, (float)w->time, i));
        }
        core_vec3 v = core_v3_mad(phys_get3(b->vx, b->vy, b->vz, i), a, h);
        core_vec3 o = phys_get3(b->wx, b->wy, b->wz, i);
        core_vec3 t = b->torque[i];
        if (t.x != 0.0f || t.y != 0.0f || t.z != 0.0f) {
            o = core_v3_mad(o, phys_body_inverse_inertia(b, i, t), h);
        }
        v = core_v3_scale(v, 1.0f / (1.0f + b->linear_damping[i] * h));
        o = core_v3_scale(o, 1.0f / (1.0f + b->angular_damping[i] * h));
        phys_put3(b->vx, b->vy, b->vz, i, phys_lock_motion(b->locks[i], v));
        phys_put3(b->wx, b->wy, b->wz, i, phys_lock_turn(b->locks[i], o));
    }
}

void phys_put_quat(phys_bodies *b, uint32_t i, core_quat q) {
    q = phys_quat_unit(q);
    b->qx[i] = q.x;
    b->qy[i] = q.y;
    b->qz[i] = q.z;
    b->qw[i] = q.w;
}

static void turn_isotropic(phys_bodies *b, uint32_t i, float h) {
    core_vec3 o = phys_get3(b->wx, b->wy, b->wz, i);
    float speed = core_v3_length(o);
    if (speed == 0.0f) {
        return;
    }
    float s, c;
    half_turn(0.5f * h * speed, &s, &c);
    core_vec3 u = core_v3_scale(o, s / speed);
    phys_put_quat(b, i, phys_quat_mul((core_quat){u.x, u.y, u.z, c}, phys_body_quat(b, i)));
}

// Turns the frame about one of its own axes by h L / I and the momentum, seen from the frame, back.
static void turn_about(core_quat *q, core_vec3 *l, int axis, float angle) {
    float s, c;
    half_turn(0.5f * angle, &s, &c);
    float cos = c * c - s * s, sin = 2.0f * s * c;
    core_quat turn = {0, 0, 0, c};
    core_vec3 m = *l;
    if (axis == 0) {
        turn.x = s;
        *l = core_v3(m.x, cos * m.y + sin * m.z, cos * m.z - sin * m.y);
    } else if (axis == 1) {
        turn.y = s;
        *l = core_v3(cos * m.x - sin * m.z, m.y, cos * m.z + sin * m.x);
    } else {
        turn.z = s;
        *l = core_v3(cos * m.x + sin * m.y, cos * m.y - sin * m.x, m.z);
    }
    *q = phys_quat_mul(*q, turn);
}

// Exact rotation by a quaternion whose length is only nearly 1: without the division the length
// error of q, always of one sign after rounding, would feed energy into a long spin.
static core_vec3 rotate_exact(core_quat q, core_vec3 v) {
    core_vec3 u = {q.x, q.y, q.z};
    float n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    core_vec3 t = core_v3_scale(core_v3_cross(u, v), 2.0f / n);
    return core_v3_add(core_v3_mad(v, t, q.w), core_v3_cross(u, t));
}

// Torque-free rotation by symmetric splitting into turns about the principal axes (Dullweber,
// Leimkuhler, McLachlan, J. Chem. Phys. 107, 1997): angular momentum is kept, energy stays bounded.
void phys_integrate_rotation(phys_bodies *b, uint32_t i, float h) {
    if (b->flags[i] & PHYS_BODY_ISOTROPIC) {
        turn_isotropic(b, i, h);
        return;
    }
    core_vec3 o = phys_get3(b->wx, b->wy, b->wz, i);
    if (o.x == 0.0f && o.y == 0.0f && o.z == 0.0f) {
        return;
    }
    bool framed = (b->flags[i] & PHYS_BODY_FRAME) != 0;
    core_quat q = phys_body_quat(b, i);
    q = framed ? phys_quat_mul(q, b->iq[i]) : q;
    core_vec3 inv = phys_get3(b->ix, b->iy, b->iz, i);
    core_vec3 l = rotate_exact(phys_conj(q), o);
    l = core_v3(l.x / inv.x, l.y / inv.y, l.z / inv.z);
    float before = core_v3_dot(l, l);
    turn_about(&q, &l, 0, 0.5f * h * l.x * inv.x);
    turn_about(&q, &l, 1, 0.5f * h * l.y * inv.y);
    turn_about(&q, &l, 2, h * l.z * inv.z);
    turn_about(&q, &l, 1, 0.5f * h * l.y * inv.y);
    turn_about(&q, &l, 0, 0.5f * h * l.x * inv.x);
    if (before > 1e-20f) { // takes back rounding only
        l = core_v3_scale(l, core_sqrtf(before / core_v3_dot(l, l)));
    }
    o = rotate_exact(q, core_v3(l.x * inv.x, l.y * inv.y, l.z * inv.z));
    phys_put3(b->wx, b->wy, b->wz, i, o);
    phys_put_quat(b, i, framed ? phys_quat_mul(q, phys_conj(b->iq[i])) : q);
}

core_vec3 phys_momentum_of(const phys_bodies *b, uint32_t i, core_quat q, core_vec3 w) {
    core_vec3 inv = phys_get3(b->ix, b->iy, b->iz, i);
    q = phys_quat_mul(q, b->iq[i]);
    core_vec3 l = rotate_exact(phys_conj(q), w);
    return rotate_exact(q, core_v3(l.x / inv.x, l.y / inv.y, l.z / inv.z));
}

core_vec3 phys_spin_of(const phys_bodies *b, uint32_t i, core_quat q, core_vec3 momentum) {
    core_vec3 inv = phys_get3(b->ix, b->iy, b->iz, i);
    q = phys_quat_mul(q, b->iq[i]);
    core_vec3 l = rotate_exact(phys_conj(q), momentum);
    return rotate_exact(q, core_v3(l.x * inv.x, l.y * inv.y, l.z * inv.z));
}

core_quat phys_turned(core_quat q, core_vec3 turn) {
    float angle = core_v3_length(turn), s, c;
    if (angle == 0.0f) {
        return q;
    }
    half_turn(0.5f * angle, &s, &c);
    core_vec3 u = core_v3_scale(turn, s / angle);
    return phys_quat_mul((core_quat){u.x, u.y, u.z, c}, q);
}

// Whether a body turns about anything but a principal axis: else its angular velocity stays.
static bool precesses(const phys_bodies *b, uint32_t i) {
    core_quat q = phys_body_quat(b, i);
    q = b->flags[i] & PHYS_BODY_FRAME ? phys_quat_mul(q, b->iq[i]) : q;
    core_vec3 w = phys_rotate(phys_conj(q), phys_get3(b->wx, b->wy, b->wz, i));
    core_vec3 l = core_v3(w.x / b->ix[i], w.y / b->iy[i], w.z / b->iz[i]), t = core_v3_cross(w, l);
    return core_v3_dot(t, t) > 1e-12f * core_v3_dot(w, w) * core_v3_dot(l, l);
}

static bool is_round(const phys_bodies *b, uint32_t i) {
    return (b->flags[i] & PHYS_BODY_ISOTROPIC) != 0 || b->type[i] != PHYS_DYNAMIC ||
           (b->locks[i] & PHYS_LOCK_TURN) != 0;
}

void phys_finish_precession(phys_bodies *b, uint32_t i, float dt) {
    if (!is_round(b, i) && precesses(b, i)) {
        core_quat q = phys_body_quat(b, i);
        phys_integrate_rotation(b, i, dt);
        phys_put_quat(b, i, q);
    }
}

// Ends a step: `turn` is the sum of the substeps' angular velocity times h. A free body turns by
// the splitting above in quarters of the step; a touched one by its turn, while its angular
// velocity follows the gyroscopic term.
void phys_finish_rotation(phys_bodies *b, uint32_t i, core_vec3 turn, float dt, bool free) {
    if (free && !is_round(b, i)) {
        for (int k = 0; k < 4; k++) {
            phys_integrate_rotation(b, i, 0.25f * dt);
        }
        return;
    }
    phys_finish_precession(b, i, dt);
    phys_put_quat(b, i, phys_turned(phys_body_quat(b, i), turn));
}

typedef struct pull {
    const phys_world *world;
    uint32_t row;
} pull;

static core_vec3 acceleration(void *ctx, core_vec3 p, core_vec3 v, float t) {
    const pull *f = ctx;
    const phys_bodies *b = &f->world->bodies;
    core_vec3 a = core_v3_scale(f->world->gravity, b->gravity_scale[f->row]);
    a = core_v3_mad(a, b->force[f->row], b->im[f->row]);
    a = core_v3_add(a, phys_pull(f->world, p, v, t, f->row));
    return core_v3_mad(a, v, -b->linear_damping[f->row]);
}

const phys_integrator *phys_integrator_of(const phys_world *w, uint32_t i) {
    bool constant = !phys_pulled(w) && w->bodies.linear_damping[i] == 0.0f;
    return w->auto_integrator && constant ? NULL : w->integrator;
}

void phys_integrate_free(phys_world *w, uint32_t i, float dt, int substeps) {
    phys_bodies *b = &w->bodies;
    pull f = {w, i};
    phys_motion m = {.p = phys_get3(b->cx, b->cy, b->cz, i),
                     .v = phys_get3(b->vx, b->vy, b->vz, i),
                     .q = phys_quat_mul(phys_body_quat(b, i), b->iq[i]),
                     .w = phys_get3(b->wx, b->wy, b->wz, i),
                     .inertia = {1.0f / b->ix[i], 1.0f / b->iy[i], 1.0f / b->iz[i]}};
    for (int k = 0; k < substeps; k++) {
        float h = dt / (float)substeps;
        w->integrator->step(&m, acceleration, &f, (float)w->time + (float)k * h, h);
    }
    phys_put3(b->cx, b->cy, b->cz, i, m.p);
    phys_put3(b->vx, b->vy, b->vz, i, m.v);
    phys_put3(b->wx, b->wy, b->wz, i,
              core_v3_scale(m.w, 1.0f / (1.0f + b->angular_damping[i] * dt)));
    phys_put_quat(b, i, phys_quat_mul(m.q, phys_conj(b->iq[i])));
}

void phys_clear_forces(phys_world *w) {
    phys_bodies *b = &w->bodies;
    uint32_t n = core_columns_count(&b->set);
    for (uint32_t i = 0; i < n; i++) {
        b->force[i] = b->torque[i] = core_v3(0, 0, 0);
    }
}
