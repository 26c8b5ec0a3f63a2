#include "phys/motion.h"

#include <string.h>

#include "core/nearest.h"

static core_quat quat_add(core_quat a, core_quat b, float s) {
    return (core_quat){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s, a.w + b.w * s};
}

static core_quat quat_rate(core_quat q, core_vec3 w) { // q' = w q / 2
    core_quat o = {0.5f * w.x, 0.5f * w.y, 0.5f * w.z, 0};
    return core_quat_mul(o, q);
}

static core_vec3 momentum(const phys_motion *m) {
    core_vec3 l = core_quat_unrotate(m->q, m->w);
    return core_quat_rotate(m->q,
                            core_v3(l.x * m->inertia.x, l.y * m->inertia.y, l.z * m->inertia.z));
}

static core_vec3 rate_of(const phys_motion *m, core_quat q, core_vec3 momentum_world) {
    q = core_quat_normalize(q);
    core_vec3 l = core_quat_unrotate(q, momentum_world);
    return core_quat_rotate(q, core_v3(l.x / m->inertia.x, l.y / m->inertia.y, l.z / m->inertia.z));
}

// Turn by w for dt: exact for constant w.
static core_quat turned(core_quat q, core_vec3 w, float dt) {
    float speed = core_v3_length(w), s, c;
    core_sincosf(0.5f * speed * dt, &s, &c);
    float k = speed > 0 ? s / speed : 0;
    return core_quat_normalize(core_quat_mul((core_quat){w.x * k, w.y * k, w.z * k, c}, q));
}

// Everything from the old state; Euler's equations for the spin. Energy grows.
static void step_euler(phys_motion *m, phys_acceleration *f, void *ctx, float t, float dt) {
    core_vec3 a = f(ctx, m->p, m->v, t);
    core_vec3 l = momentum(m), torque = core_v3_scale(core_v3_cross(m->w, l), -1);
    core_vec3 b = core_quat_unrotate(m->q, torque);
    core_vec3 dw =
        core_quat_rotate(m->q, core_v3(b.x / m->inertia.x, b.y / m->inertia.y, b.z / m->inertia.z));
    m->p = core_v3_mad(m->p, m->v, dt);
    m->v = core_v3_mad(m->v, a, dt);
    m->q = core_quat_normalize(quat_add(m->q, quat_rate(m->q, m->w), dt));
    m->w = core_v3_mad(m->w, dw, dt);
}

// The new velocity moves the body: first order, but symplectic, so that energy stays bounded. The
// spin keeps its angular momentum.
static void step_semi(phys_motion *m, phys_acceleration *f, void *ctx, float t, float dt) {
    m->v = core_v3_mad(m->v, f(ctx, m->p, m->v, t), dt);
    m->p = core_v3_mad(m->p, m->v, dt);
    core_vec3 l = momentum(m);
    m->q = turned(m->q, m->w, dt);
    m->w = rate_of(m, m->q, l);
}

// Velocity Verlet (Swope, Andersen, Berens, Wilson 1982): second order and symplectic. For forces
// that depend on velocity the second half uses the predicted one. The spin by the midpoint rule.
static void step_verlet(phys_motion *m, phys_acceleration *f, void *ctx, float t, float dt) {
    core_vec3 a = f(ctx, m->p, m->v, t);
    m->p = core_v3_mad(core_v3_mad(m->p, m->v, dt), a, 0.5f * dt * dt);
    core_vec3 guess = core_v3_mad(m->v, a, dt);
    core_vec3 b = f(ctx, m->p, guess, t + dt);
    m->v = core_v3_mad(m->v, core_v3_add(a, b), 0.5f * dt);
    core_vec3 l = momentum(m);
    core_vec3 half = rate_of(m, turned(m->q, m->w, 0.5f * dt), l);
    m->q = turned(m->q, half, dt);
    m->w = rate_of(m, m->q, l);
}

typedef struct slope {
    core_vec3 dp, dv;
    core_quat dq;
} slope;

static slope slope_at(const phys_motion *m, const slope *s, float h, core_vec3 l,
                      phys_acceleration *f, void *ctx, float t) {
    core_vec3 p = core_v3_mad(m->p, s->dp, h), v = core_v3_mad(m->v, s->dv, h);
    core_quat q = quat_add(m->q, s->dq, h);
    return (slope){v, f(ctx, p, v, t), quat_rate(q, rate_of(m, q, l))};
}

// Classical fourth-order Runge-Kutta: accurate while dt is small, not symplectic.
static void step_rk4(phys_motion *m, phys_acceleration *f, void *ctx, float t, float dt) {
    const slope none = {0};
    core_vec3 l = momentum(m);
    slope a = slope_at(m, &none, 0, l, f, ctx, t);
    slope b = slope_at(m, &a, 0.5f * dt, l, f, ctx, t + 0.5f * dt);
    slope c = slope_at(m, &b, 0.5f * dt, l, f, ctx, t + 0.5f * dt);
    slope d = slope_at(m, &c, dt, l, f, ctx, t + dt);
    core_vec3 dp = core_v3_add(core_v3_add(a.dp, d.dp), core_v3_scale(core_v3_add(b.dp, c.dp), 2));
    core_vec3 dv = core_v3_add(core_v3_add(a.dv, d.dv), core_v3_scale(core_v3_add(b.dv, c.dv), 2));
    core_quat dq = quat_add(quat_add(quat_add(a.dq, b.dq, 2), c.dq, 2), d.dq, 1);
    m->p = core_v3_mad(m->p, dp, dt / 6);
    m->v = core_v3_mad(m->v, dv, dt / 6);
    m->q = core_quat_normalize(quat_add(m->q, dq, dt / 6));
    m->w = rate_of(m, m->q, l);
}

const phys_integrator phys_integrators[] = {
    {"euler", 1, 1, step_euler}, {"semi", 1, 1, step_semi}, {"verlet", 2, 2, step_verlet},
    {"rk4", 4, 4, step_rk4},     {NULL, 0, 0, NULL},
};

const phys_integrator *phys_integrator_find(const char *name) {
    const char *names[CORE_COUNT_OF(phys_integrators)];
    size_t n = 0;
    for (; phys_integrators[n].name; n++) {
        if (strcmp(phys_integrators[n].name, name) == 0) {
            return &phys_integrators[n];
        }
        names[n] = phys_integrators[n].name;
    }
    const char *near = core_nearest(name, names, n);
    core_fail("integrator '%s' is not known; euler, semi, verlet or rk4 expected%s%s", name,
              near ? "; nearest: " : "", near ? near : "");
    return NULL;
}
