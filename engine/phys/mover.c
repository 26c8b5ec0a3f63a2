// Movers: creation, wishes and reports. How they move is in mover_move.c.
#include "phys/world.h"

CORE_COLUMNS_DEFINE(phys_movers, PHYS_MOVER_COLUMNS)

#define MOVER_FAST 1e3f // m/s: wishes beyond are refused

phys_mover_desc phys_mover_desc_default(void) {
    return (phys_mover_desc){.radius = 0.3f,
                             .half_height = 0.6f,
                             .slope_limit = 50.0f * CORE_PI_F / 180.0f,
                             .step_height = 0.3f,
                             .push_force = 200.0f,
                             .mass = 70.0f,
                             .gravity_scale = 1.0f,
                             .cookie = PHYS_MOVER_COOKIE};
}

static bool check(const char *what, float value, float lo, float hi, const char *unit) {
    return (value >= lo && value <= hi) ||
           core_fail("phys mover: %s is %g, expected %g..%g %s", what, (double)value, (double)lo,
                     (double)hi, unit);
}

static bool check_vector(const char *what, core_vec3 v, float far) {
    core_vec3 a = phys_abs3(v);
    return (a.x <= far && a.y <= far && a.z <= far) ||
           core_fail("phys mover: %s (%g, %g, %g) is not finite or beyond %g", what, (double)v.x,
                     (double)v.y, (double)v.z, (double)far);
}

static bool check_size(float radius, float half_height) {
    return check("radius", radius, 0.01f, 100.0f, "m") &&
           check("half_height", half_height, 1e-3f, 100.0f, "m");
}

static bool check_desc(const phys_mover_desc *d) {
    if (d->cookie != PHYS_MOVER_COOKIE) {
        return core_fail("phys mover: description was not made by phys_mover_desc_default");
    }
    return check_vector("position", d->position, PHYS_FAR) &&
           check_size(d->radius, d->half_height) &&
           check("slope_limit", d->slope_limit, 0.01f, 1.56f, "rad") &&
           check("step_height", d->step_height, 0.0f, 2.0f * d->half_height, "m (its segment)") &&
           check("push_force", d->push_force, 0.0f, 1e9f, "N") &&
           check("mass", d->mass, 1e-3f, 1e9f, "kg") &&
           check("gravity_scale", d->gravity_scale, -1e3f, 1e3f, "");
}

phys_mover phys_mover_create(phys_world *w, const phys_mover_desc *d) {
    if (!check_desc(d)) {
        return CORE_NULL_HANDLE;
    }
    phys_movers *m = &w->movers;
    core_handle h = core_columns_add(&m->set);
    if (core_handle_is_null(h)) {
        return h;
    }
    uint32_t i = core_columns_count(&m->set) - 1;
    m->position[i] = d->position;
    m->radius[i] = d->radius;
    m->half_height[i] = d->half_height;
    m->slope_cos[i] = core_cosf(d->slope_limit);
    m->step[i] = d->step_height;
    m->push[i] = d->push_force;
    m->mass[i] = d->mass;
    m->gravity_scale[i] = d->gravity_scale;
    m->layers[i] = d->layers ? d->layers : UINT32_MAX;
    m->user[i] = d->user;
    m->normal[i] = core_v3(0, 1, 0);
    return h;
}

static uint32_t live_row(const phys_world *w, phys_mover mover, const char *what) {
    uint32_t row = core_columns_row(&w->movers.set, mover);
    if (row == CORE_NO_ROW) {
        core_fail("phys mover: %s of a stale or null handle (%u:%u)", what, mover.index,
                  mover.generation);
    }
    return row;
}

bool phys_mover_destroy(phys_world *w, phys_mover mover) {
    return live_row(w, mover, "destroy") != CORE_NO_ROW &&
           core_columns_remove(&w->movers.set, mover, NULL, NULL);
}

bool phys_mover_alive(const phys_world *w, phys_mover mover) {
    return core_columns_row(&w->movers.set, mover) != CORE_NO_ROW;
}

uint32_t phys_mover_count(const phys_world *w) { return core_columns_count(&w->movers.set); }

uint64_t phys_mover_user(const phys_world *w, phys_mover mover) {
    uint32_t i = live_row(w, mover, "user");
    return i == CORE_NO_ROW ? 0 : w->movers.user[i];
}

bool phys_mover_walk(phys_world *w, phys_mover mover, core_vec3 velocity) {
    uint32_t i = live_row(w, mover, "walk");
    if (i == CORE_NO_ROW || !check_vector("walking velocity", velocity, MOVER_FAST)) {
        return false;
    }
    w->movers.wish[i] = velocity;
    return true;
}

bool phys_mover_jump(phys_world *w, phys_mover mover, float speed) {
    uint32_t i = live_row(w, mover, "jump");
    if (i == CORE_NO_ROW || !check("jump speed", speed, 1e-3f, MOVER_FAST, "m/s")) {
        return false;
    }
    phys_movers *m = &w->movers;
    core_vec3 ground = {0, 0, 0};
    uint32_t row = phys_body_row(w, m->body[i]);
    if (m->ground[i] == PHYS_MOVER_GROUND && row != CORE_NO_ROW) {
        const phys_bodies *b = &w->bodies;
        core_vec3 arm = core_v3_sub(m->position[i], phys_get3(b->cx, b->cy, b->cz, row));
        ground = core_v3_add(phys_get3(b->vx, b->vy, b->vz, row),
                             core_v3_cross(phys_get3(b->wx, b->wy, b->wz, row), arm));
        m->drift[i] = core_v3(ground.x, 0.0f, ground.z);
    }
    m->drift[i].y = speed + CORE_MAX(ground.y, 0.0f);
    m->ground[i] = PHYS_MOVER_AIR;
    m->body[i] = CORE_NULL_HANDLE;
    return true;
}

bool phys_mover_set_position(phys_world *w, phys_mover mover, core_vec3 position) {
    uint32_t i = live_row(w, mover, "set position");
    if (i == CORE_NO_ROW || !check_vector("position", position, PHYS_FAR)) {
        return false;
    }
    phys_movers *m = &w->movers;
    m->position[i] = position;
    m->drift[i] = m->velocity[i] = core_v3(0, 0, 0);
    m->ground[i] = PHYS_MOVER_AIR;
    m->body[i] = CORE_NULL_HANDLE;
    return true;
}

bool phys_mover_resize(phys_world *w, phys_mover mover, float radius, float half_height,
                       bool *fits) {
    uint32_t i = live_row(w, mover, "resize");
    *fits = false;
    if (i == CORE_NO_ROW || !check_size(radius, half_height)) {
        return false;
    }
    phys_movers *m = &w->movers;
    phys_shape_desc capsule = phys_shape_desc_default(PHYS_CAPSULE);
    capsule.radius = radius;
    capsule.half_height = half_height;
    core_vec3 at = m->position[i];
    at.y += radius + half_height - m->radius[i] - m->half_height[i];
    phys_filter seen = {.layers = m->layers[i]};
    phys_touch touch;
    *fits = phys_world_touch(w, &capsule, at, core_quat_identity(), 0.0f, &seen, &touch, 1) == 0;
    if (*fits) {
        // Its seat on the body below moves with the centre.
        uint32_t row = phys_body_row(w, m->body[i]);
        if (row != CORE_NO_ROW) {
            core_vec3 rise = core_v3_sub(at, m->position[i]);
            m->place[i] =
                core_v3_add(m->place[i], phys_unrotate(phys_body_quat(&w->bodies, row), rise));
        }
        m->position[i] = at;
        m->radius[i] = radius;
        m->half_height[i] = half_height;
    }
    return true;
}

bool phys_mover_read(const phys_world *w, phys_mover mover, phys_mover_state *out) {
    uint32_t i = live_row(w, mover, "read");
    *out = (phys_mover_state){.normal = {0, 1, 0}};
    if (i == CORE_NO_ROW) {
        return false;
    }
    const phys_movers *m = &w->movers;
    *out = (phys_mover_state){.position = m->position[i],
                              .velocity = m->velocity[i],
                              .ground = (phys_mover_ground)m->ground[i],
                              .body = m->body[i],
                              .point = m->point[i],
                              .normal = m->normal[i],
                              .turn = m->turn[i]};
    return true;
}
