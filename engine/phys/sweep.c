// Continuous collision: when do two moving convex shapes meet within a step? Conservative
// advancement (Mirtich 1996): the distance, divided by the fastest possible closing along its
// direction, is always safe to go; for pure translation that direction's own speed is exact, so
// that a few rounds do.
#include "phys/world.h"

#define SWEEP_ROUNDS 32
#define SWEEP_TARGET 1e-3f // m: near enough to be called touching

static core_quat turned(core_quat q, core_vec3 w, float t) {
    float speed = core_v3_length(w), angle = 0.5f * speed * t;
    if (angle < 1e-7f) {
        return q;
    }
    float s, c;
    core_sincosf(angle, &s, &c);
    core_vec3 u = core_v3_scale(w, s / speed);
    return phys_quat_unit(phys_quat_mul((core_quat){u.x, u.y, u.z, c}, q));
}

phys_geom phys_moving_at(const phys_moving *m, float t) {
    core_quat turn = turned(core_quat_identity(), m->w, t);
    core_vec3 center = core_v3_mad(m->center, m->v, t);
    core_vec3 arm = phys_rotate(turn, core_v3_sub(m->geom.position, m->center));
    phys_geom g = m->geom;
    g.position = core_v3_add(center, arm);
    g.rotation = phys_quat_unit(phys_quat_mul(turn, m->geom.rotation));
    g.axes = phys_quat_mat(g.rotation);
    return g;
}

bool phys_sweep(const phys_moving *a, const phys_moving *b, float dt, float *time) {
    core_vec3 v = core_v3_sub(a->v, b->v);
    float spin = core_v3_length(a->w) * a->extent + core_v3_length(b->w) * b->extent, t = 0.0f;
    for (int i = 0; i < SWEEP_ROUNDS; i++) {
        phys_geom ga = phys_moving_at(a, t), gb = phys_moving_at(b, t);
        core_vec3 n;
        float gap = phys_separation(&ga, &gb, &n);
        if (gap < SWEEP_TARGET) {
            *time = t;
            return true;
        }
        float closing = core_v3_dot(v, n) + spin;
        if (!(closing > 0.0f)) {
            return false;
        }
        t += (gap - 0.5f * SWEEP_TARGET) / closing;
        if (t > dt) {
            return false;
        }
    }
    *time = t; // a graze that takes long to decide: touching is the safe answer
    return true;
}
