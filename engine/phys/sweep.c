// Continuous collision: when do two moving convex shapes meet within a step? Conservative
// advancement (Mirtich 1996): the distance, divided by the fastest possible closing along its
// direction, is always safe to go; for pure translation that direction's own speed is exact, so
// that a few rounds do.
#include "phys/mesh_internal.h"

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

// One point in the middle instead of several: a blow through the middle stops a body in one go,
// while four at its corners would first set it spinning.
static void merge_points(phys_manifold *m) {
    phys_point p = m->point[0];
    for (uint32_t k = 1; k < m->count; k++) {
        p.ra = core_v3_add(p.ra, m->point[k].ra);
        p.separation = CORE_MIN(p.separation, m->point[k].separation);
    }
    p.rb = p.ra = core_v3_scale(p.ra, 1.0f / (float)m->count);
    p.feature = 1u << 30;
    m->point[0] = p;
    m->count = 1;
}

void phys_swept_points(const phys_moving *a, const phys_moving *b, float t, phys_manifold *m) {
    if (m->count > 1) {
        merge_points(m);
    }
    core_vec3 way_a = core_v3_scale(a->v, t), way_b = core_v3_scale(b->v, t);
    for (uint32_t k = 0; k < m->count; k++) {
        phys_point *p = &m->point[k];
        p->ra = core_v3_sub(p->ra, way_a);
        p->rb = core_v3_sub(p->rb, way_b);
        core_vec3 va = core_v3_cross(a->w, core_v3_sub(p->ra, a->center));
        core_vec3 vb = core_v3_cross(b->w, core_v3_sub(p->rb, b->center));
        core_vec3 v = core_v3_sub(core_v3_add(b->v, vb), core_v3_add(a->v, va));
        p->separation -= t * core_v3_dot(v, m->normal);
    }
}

bool phys_sweep(const phys_moving *a, const phys_moving *b, float dt, float *time) {
    if (b->geom.type == PHYS_MESH) {
        return phys_mesh_sweep(a, &b->geom, dt, time);
    }
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
