// Lab kernel "motion": an integrator on a problem whose answer is known elsewhere. Gives the state
// at the end and what should have been kept; the lab's references (tools/lab/references.py) judge
// it.
#include "core/lab.h"
#include "phys/lab.h"
#include "phys/motion.h"

#include <string.h>

typedef struct problem {
    const char *name;
    phys_acceleration *f;
    phys_motion start;
} problem;

typedef struct medium {
    float k; // drag (1/s), stiffness (1/s^2), or gravitational parameter (m^3/s^2)
} medium;

static core_vec3 drag(void *ctx, core_vec3 p, core_vec3 v, float t) {
    const medium *m = ctx;
    (void)p, (void)t;
    return core_v3(-m->k * v.x, -9.81f - m->k * v.y, -m->k * v.z);
}

static core_vec3 spring(void *ctx, core_vec3 p, core_vec3 v, float t) {
    const medium *m = ctx;
    (void)v, (void)t;
    return core_v3_scale(p, -m->k);
}

static core_vec3 point_field(void *ctx, core_vec3 p, core_vec3 v, float t) {
    const medium *m = ctx;
    (void)v, (void)t;
    float r2 = core_v3_dot(p, p);
    return core_v3_scale(p, -m->k / (r2 * core_sqrtf(r2)));
}

static core_vec3 nothing(void *ctx, core_vec3 p, core_vec3 v, float t) {
    (void)ctx, (void)p, (void)v, (void)t;
    return core_v3(0, 0, 0);
}

// orbit: a = 1, e = 0.5 from the periapsis; top: a brick in general motion.
static const problem problems[] = {
    {"projectile", drag, {{0, 0, 0}, {10, 20, 0}, {0, 0, 0, 1}, {0, 0, 0}, {1, 1, 1}}},
    {"spring", spring, {{1, 0, 0}, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, {1, 1, 1}}},
    {"orbit", point_field, {{0.5f, 0, 0}, {0, 1.7320508f, 0}, {0, 0, 0, 1}, {0, 0, 0}, {1, 1, 1}}},
    {"top",
     nothing,
     {{0, 0, 0}, {0, 0, 0}, {0, 0, 0, 1}, {2, 1, 3}, {0.033333333f, 0.086666667f, 0.113333333f}}},
};

typedef struct motion_run {
    const problem *problem;
    const phys_integrator *integrator;
    medium m;
    float dt;
    uint32_t steps;
    phys_motion state;
} motion_run;

static void advance(void *ctx) {
    motion_run *r = ctx;
    r->state = r->problem->start;
    for (uint32_t i = 0; i < r->steps; i++) {
        r->integrator->step(&r->state, r->problem->f, &r->m, (float)i * r->dt, r->dt);
    }
}

static double spin_energy(const phys_motion *m) {
    core_vec3 l = core_quat_unrotate(m->q, m->w);
    return 0.5 * ((double)m->inertia.x * (double)l.x * (double)l.x +
                  (double)m->inertia.y * (double)l.y * (double)l.y +
                  (double)m->inertia.z * (double)l.z * (double)l.z);
}

static void write_state(const motion_run *r, core_json *out) {
    const phys_motion *m = &r->state;
    const char *const key[13] = {"px", "py", "pz", "vx", "vy", "vz", "qx",
                                 "qy", "qz", "qw", "wx", "wy", "wz"};
    const float value[13] = {m->p.x, m->p.y, m->p.z, m->v.x, m->v.y, m->v.z, m->q.x,
                             m->q.y, m->q.z, m->q.w, m->w.x, m->w.y, m->w.z};
    for (int i = 0; i < 13; i++) {
        core_json_number(out, key[i], (double)value[i]);
    }
    core_json_number(out, "spin_energy_ratio", spin_energy(m) / spin_energy(&r->problem->start));
    core_json_number(out, "time", (double)r->dt * r->steps);
}

static bool run(const core_lab_case *c, core_json *out) {
    const char *name = core_lab_text(c, "problem", "spring");
    motion_run r = {.integrator = phys_integrator_find(core_lab_text(c, "method", "semi"))};
    for (size_t i = 0; i < CORE_COUNT_OF(problems); i++) {
        r.problem = strcmp(problems[i].name, name) == 0 ? &problems[i] : r.problem;
    }
    double dt = core_lab_number(c, "dt", 1.0 / 60), time = core_lab_number(c, "time", 5);
    if (!r.integrator) {
        return false;
    }
    if (!r.problem || !(dt > 1e-7) || !(time >= dt) || time / dt > 1e8) {
        return core_fail(
            "lab kernel motion: problem projectile, spring, orbit or top, 1e-7 < dt <= "
            "time expected; got '%s', dt %g, time %g",
            name, dt, time);
    }
    r.steps = (uint32_t)(time / dt + 0.5);
    r.dt = (float)(time / r.steps);
    r.m.k = (float)core_lab_number(c, "k", 1);
    advance(&r);
    write_state(&r, out);
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ns", core_lab_time(advance, &r, 2e7) / r.steps);
        core_json_number(out, "cost_ms", core_lab_time(advance, &r, 2e7) * 1e-6);
    }
    return true;
}

const core_lab_kernel phys_lab_motion = {
    "motion", "an integrator on a problem with a known answer: state at the end",
    "method: euler|semi|verlet|rk4; problem: projectile|spring|orbit|top; dt, time, k, timed", run};
