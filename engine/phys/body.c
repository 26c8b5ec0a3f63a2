// Bodies: creation, destruction, and the getters and setters of their state.
#include "phys/mesh_internal.h"

CORE_COLUMNS_DEFINE(phys_bodies, PHYS_BODY_COLUMNS)

phys_body_desc phys_body_desc_default(void) {
    return (phys_body_desc){
        .rotation = core_quat_identity(), .gravity_scale = 1.0f, .cookie = PHYS_BODY_COOKIE};
}

static bool check_vec(const char *field, core_vec3 v, float limit) {
    core_vec3 a = phys_abs3(v);
    if (a.x <= limit && a.y <= limit && a.z <= limit) {
        return true;
    }
    return core_fail("phys body: %s (%g, %g, %g) is not finite or beyond %g", field, (double)v.x,
                     (double)v.y, (double)v.z, (double)limit);
}

bool phys_body_check(const phys_body_desc *d) {
    if (d->cookie != PHYS_BODY_COOKIE) {
        return core_fail("phys body: description was not made by phys_body_desc_default");
    }
    if ((unsigned)d->type > PHYS_KINEMATIC) {
        return core_fail("phys body: type %d, expected dynamic, static or kinematic", (int)d->type);
    }
    if (!check_vec("position", d->position, PHYS_FAR) ||
        !check_vec("velocity", d->velocity, PHYS_FAR) ||
        !check_vec("angular velocity", d->angular_velocity, PHYS_FAR)) {
        return false;
    }
    const core_quat q = d->rotation;
    if (!phys_finite(q.x) || !phys_finite(q.y) || !phys_finite(q.z) || !phys_finite(q.w)) {
        return core_fail("phys body: rotation (%g, %g, %g, %g) is not finite", (double)q.x,
                         (double)q.y, (double)q.z, (double)q.w);
    }
    if (!(d->linear_damping >= 0.0f && d->linear_damping <= 1e6f) ||
        !(d->angular_damping >= 0.0f && d->angular_damping <= 1e6f)) {
        return core_fail("phys body: damping (%g linear, %g angular), expected 0..1e6 per second",
                         (double)d->linear_damping, (double)d->angular_damping);
    }
    if (!(core_absf(d->gravity_scale) <= 1e6f)) {
        return core_fail("phys body: gravity_scale is %g, expected a finite number",
                         (double)d->gravity_scale);
    }
    if (d->layer > 31) {
        return core_fail("phys body: layer is %u, expected 0..31", d->layer);
    }
    if (d->locks > 63) {
        return core_fail("phys body: locks is %u, expected PHYS_LOCK_ flags", d->locks);
    }
    return true;
}

static bool check_desc(const phys_body_desc *d, const phys_shape_desc *shapes, uint32_t count) {
    if (!phys_body_check(d)) {
        return false;
    }
    if (count == 0 || shapes == NULL) {
        return core_fail("phys body: no shapes given, expected at least one");
    }
    for (uint32_t i = 0; i < count; i++) {
        if (!phys_shape_check(&shapes[i], d->type)) {
            return false;
        }
    }
    return true;
}

// Adds inertia of mass m at offset d (parallel axis theorem).
static void shift_inertia(phys_mat3 *i, float m, core_vec3 d) {
    float dd = core_v3_dot(d, d);
    core_vec3 *row = &i->x;
    row[0] = core_v3_add(row[0], core_v3(m * (dd - d.x * d.x), -m * d.x * d.y, -m * d.x * d.z));
    row[1] = core_v3_add(row[1], core_v3(-m * d.y * d.x, m * (dd - d.y * d.y), -m * d.y * d.z));
    row[2] = core_v3_add(row[2], core_v3(-m * d.z * d.x, -m * d.z * d.y, m * (dd - d.z * d.z)));
}

static bool set_mass(phys_bodies *b, uint32_t row, const phys_shape_desc *shapes, uint32_t count) {
    phys_mass total = {0};
    for (uint32_t i = 0; i < count; i++) {
        phys_mass m;
        if (!phys_shape_mass(&shapes[i], &m)) {
            return false;
        }
        total.mass += m.mass;
        total.center = core_v3_mad(total.center, m.center, m.mass);
    }
    if (!(total.mass > 0.0f && total.mass <= 1e18f)) {
        return core_fail("phys body: mass is %g kg, expected more than 0 and at most 1e18",
                         (double)total.mass);
    }
    total.center = core_v3_scale(total.center, 1.0f / total.mass);
    for (uint32_t i = 0; i < count; i++) {
        phys_mass m;
        phys_shape_mass(&shapes[i], &m);
        shift_inertia(&m.inertia, m.mass, core_v3_sub(m.center, total.center));
        total.inertia.x = core_v3_add(total.inertia.x, m.inertia.x);
        total.inertia.y = core_v3_add(total.inertia.y, m.inertia.y);
        total.inertia.z = core_v3_add(total.inertia.z, m.inertia.z);
    }
    core_quat frame;
    core_vec3 moment = phys_principal(&total.inertia, &frame);
    if (!(moment.x > 0.0f && moment.y > 0.0f && moment.z > 0.0f)) {
        return core_fail("phys body: moments of inertia (%g, %g, %g) are not all above 0",
                         (double)moment.x, (double)moment.y, (double)moment.z);
    }
    b->im[row] = 1.0f / total.mass;
    phys_put3(b->ix, b->iy, b->iz, row, core_v3(1.0f / moment.x, 1.0f / moment.y, 1.0f / moment.z));
    b->iq[row] = frame;
    phys_put3(b->lcx, b->lcy, b->lcz, row, total.center);
    if (moment.x == moment.y && moment.y == moment.z) {
        b->flags[row] |= PHYS_BODY_ISOTROPIC;
    } else if (frame.w != 1.0f) {
        b->flags[row] |= PHYS_BODY_FRAME;
    }
    return true;
}

static void add_shape(phys_world *w, uint32_t body_slot, uint32_t body_row,
                      const phys_shape_desc *d, uint32_t hull) {
    phys_shapes *s = &w->shapes;
    core_handle h = core_columns_add(&s->set);
    uint32_t i = core_columns_count(&s->set) - 1;
    s->body[i] = body_slot;
    s->row[i] = body_row;
    s->next[i] = w->bodies.shape[body_row];
    w->bodies.shape[body_row] = h.index;
    s->type[i] = d->type;
    bool round = d->type == PHYS_SPHERE || d->type == PHYS_CAPSULE || d->type == PHYS_CYLINDER;
    bool tall = d->type == PHYS_CAPSULE || d->type == PHYS_CYLINDER;
    s->hull[i] = hull; // or mesh
    s->half[i] = tall ? core_v3(0, d->half_height, 0) : d->half;
    s->radius[i] = round ? d->radius : 0.0f;
    if (d->type == PHYS_MESH) {
        core_aabb box = phys_mesh_bounds(phys_mesh_at(w, hull));
        s->half[i] = core_v3_scale(core_v3_sub(box.max, box.min), 0.5f);
    } else if (hull != 0) {
        const phys_geom_hull *made = &w->hulls[hull - 1].hull;
        core_aabb box = phys_geom_bounds_convex(made->vertex, made->vertex_count, core_v3(0, 0, 0),
                                                core_quat_identity());
        s->half[i] = core_v3_scale(core_v3_sub(box.max, box.min), 0.5f);
    }
    s->position[i] = d->position;
    s->rotation[i] = core_quat_normalize(d->rotation);
    if (d->type == PHYS_PLANE) { // a plane's axis is its y
        s->half[i] = core_v3(0, 0, 0);
        core_vec3 n = d->normal;
        core_quat q = {n.z, 0.0f, -n.x, 1.0f + n.y};
        s->rotation[i] = n.y < -0.9999f ? (core_quat){1, 0, 0, 0} : core_quat_normalize(q);
    }
    s->friction[i] = d->friction;
    s->restitution[i] = d->restitution;
    s->rolling[i] = d->rolling;
}

// The shared part of a shape: the number of its hull or mesh.
static void leave_part(phys_world *w, uint32_t type, uint32_t number) {
    if (type == PHYS_MESH) {
        phys_mesh_leave(w, number);
    } else {
        phys_hull_leave(w, number);
    }
}

static void leave_parts(phys_world *w, const phys_shape_desc *shapes, const uint32_t *number,
                        uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        leave_part(w, shapes[k].type, number[k]);
    }
}

// False: some shape has none that can be made; nothing is held then.
static bool share_parts(phys_world *w, const phys_shape_desc *shapes, uint32_t *number,
                        uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        bool hull = shapes[k].type == PHYS_HULL, mesh = shapes[k].type == PHYS_MESH;
        number[k] = hull   ? phys_hull_share(w, &shapes[k])
                    : mesh ? phys_mesh_share(w, &shapes[k])
                           : 0;
        if ((hull || mesh) && number[k] == 0) {
            leave_parts(w, shapes, number, k);
            return false;
        }
    }
    return true;
}

phys_body phys_body_create(phys_world *w, const phys_body_desc *d, const phys_shape_desc *shapes,
                           uint32_t count) {
    if (!check_desc(d, shapes, count)) {
        return CORE_NULL_HANDLE;
    }
    phys_bodies *b = &w->bodies;
    if ((uint64_t)core_columns_count(&w->shapes.set) + count > w->shapes.set.pool.capacity) {
        core_fail("phys body: the world has no room for %u more shapes (max %u)", count,
                  w->shapes.set.pool.capacity);
        return CORE_NULL_HANDLE;
    }
    size_t mark = core_arena_mark(&w->scratch);
    uint32_t *hull = CORE_ARENA_ARRAY(&w->scratch, uint32_t, count);
    if (!share_parts(w, shapes, hull, count)) {
        core_arena_rewind(&w->scratch, mark);
        return CORE_NULL_HANDLE;
    }
    core_handle h = core_columns_add(&b->set);
    if (core_handle_is_null(h)) {
        leave_parts(w, shapes, hull, count);
        core_arena_rewind(&w->scratch, mark);
        return h;
    }
    uint32_t i = core_columns_count(&b->set) - 1;
    b->iq[i] = core_quat_identity();
    if (d->type == PHYS_DYNAMIC && !set_mass(b, i, shapes, count)) {
        core_columns_remove(&b->set, h, NULL, NULL);
        leave_parts(w, shapes, hull, count);
        core_arena_rewind(&w->scratch, mark);
        return CORE_NULL_HANDLE;
    }
    core_quat q = core_quat_normalize(d->rotation);
    phys_put3(b->px, b->py, b->pz, i, d->position);
    b->qx[i] = q.x;
    b->qy[i] = q.y;
    b->qz[i] = q.z;
    b->qw[i] = q.w;
    phys_body_sync_center(b, i);
    if (d->type != PHYS_STATIC) {
        phys_put3(b->vx, b->vy, b->vz, i, d->velocity);
        phys_put3(b->wx, b->wy, b->wz, i, d->angular_velocity);
    }
    b->linear_damping[i] = d->linear_damping;
    b->angular_damping[i] = d->angular_damping;
    b->gravity_scale[i] = d->gravity_scale;
    b->type[i] = (uint8_t)d->type;
    b->layer[i] = (uint8_t)d->layer;
    b->locks[i] = (uint8_t)d->locks;
    b->user[i] = d->user;
    b->flags[i] |= d->contact_events ? PHYS_BODY_EVENTS : 0u;
    b->rest_turn[i] = q;
    b->rest_place[i] = phys_get3(b->cx, b->cy, b->cz, i);
    b->seen[i] = phys_get3(b->cx, b->cy, b->cz, i);
    for (uint32_t k = count; k-- > 0;) {
        add_shape(w, h.index, i, &shapes[k], hull[k]);
    }
    core_arena_rewind(&w->scratch, mark);
    phys_static_note(w, i);
    w->measured = false;
    w->edited = true;
    w->trees_stale = w->shapes_changed = true;
    return h;
}

bool phys_body_destroy(phys_world *w, phys_body body) {
    uint32_t row = phys_body_row(w, body);
    if (row == CORE_NO_ROW) {
        return core_fail("phys body: destroy of a stale or null handle (%u:%u)", body.index,
                         body.generation);
    }
    phys_static_note(w, row);
    for (uint32_t slot = w->bodies.shape[row]; slot != 0;) {
        uint32_t i = phys_slot_row(&w->shapes.set, slot), next = w->shapes.next[i];
        phys_pairs_drop_shape(w, slot);
        leave_part(w, w->shapes.type[i], w->shapes.hull[i]);
        core_columns_remove(&w->shapes.set, core_columns_handle(&w->shapes.set, i), NULL, NULL);
        slot = next;
    }
    phys_joints_drop_body(w, body.index);
    w->order_count = 0;
    w->trees_stale = w->rows_stale = w->shapes_changed = true;
    w->measured = false;
    w->edited = true;
    return core_columns_remove(&w->bodies.set, body, NULL, NULL);
}

bool phys_body_alive(const phys_world *w, phys_body body) {
    return core_columns_row(&w->bodies.set, body) != CORE_NO_ROW;
}

uint32_t phys_body_count(const phys_world *w) { return core_columns_count(&w->bodies.set); }
uint32_t phys_body_row(const phys_world *w, phys_body body) {
    return core_columns_row(&w->bodies.set, body);
}
phys_body phys_body_at(const phys_world *w, uint32_t row) {
    return row < phys_body_count(w) ? core_columns_handle(&w->bodies.set, row) : CORE_NULL_HANDLE;
}

void phys_body_sync_center(phys_bodies *b, uint32_t i) {
    core_vec3 lc = phys_get3(b->lcx, b->lcy, b->lcz, i);
    core_vec3 o = phys_get3(b->px, b->py, b->pz, i);
    phys_put3(b->cx, b->cy, b->cz, i, core_v3_add(o, phys_rotate(phys_body_quat(b, i), lc)));
}

void phys_body_sync_origin(phys_bodies *b, uint32_t i) {
    core_vec3 lc = phys_get3(b->lcx, b->lcy, b->lcz, i);
    core_vec3 c = phys_get3(b->cx, b->cy, b->cz, i);
    phys_put3(b->px, b->py, b->pz, i, core_v3_sub(c, phys_rotate(phys_body_quat(b, i), lc)));
}

// World-frame inverse inertia times v; locked axes take and give nothing.
core_vec3 phys_body_inverse_inertia(const phys_bodies *b, uint32_t i, core_vec3 v) {
    v = phys_lock_turn(b->locks[i], v);
    if (b->flags[i] & PHYS_BODY_ISOTROPIC) {
        return core_v3_scale(v, b->ix[i]);
    }
    core_quat q = phys_body_quat(b, i);
    if (b->flags[i] & PHYS_BODY_FRAME) {
        q = phys_quat_mul(q, b->iq[i]);
    }
    core_vec3 l = phys_unrotate(q, v);
    l = phys_rotate(q, core_v3(l.x * b->ix[i], l.y * b->iy[i], l.z * b->iz[i]));
    return phys_lock_turn(b->locks[i], l);
}

// Row of a live handle; reports a stale one under the caller's name.
static uint32_t live_row(const phys_world *w, phys_body body, const char *what) {
    uint32_t row = core_columns_row(&w->bodies.set, body);
    if (row == CORE_NO_ROW) {
        core_fail("phys body: %s of a stale or null handle (%u:%u)", what, body.index,
                  body.generation);
    }
    return row;
}

uint64_t phys_body_user(const phys_world *w, phys_body body) {
    uint32_t i = live_row(w, body, "user");
    return i == CORE_NO_ROW ? 0 : w->bodies.user[i];
}

uint32_t phys_body_layer(const phys_world *w, phys_body body) {
    uint32_t i = live_row(w, body, "layer");
    return i == CORE_NO_ROW ? 0 : w->bodies.layer[i];
}

bool phys_body_set_layer(phys_world *w, phys_body body, uint32_t layer) {
    uint32_t i = live_row(w, body, "set layer");
    if (i == CORE_NO_ROW || layer > 31) {
        return i != CORE_NO_ROW && core_fail("phys body: layer is %u, expected 0..31", layer);
    }
    w->bodies.layer[i] = (uint8_t)layer;
    phys_static_note(w, i);
    w->pairs_stale = true;
    phys_wake_row(w, i);
    return true;
}

float phys_body_mass(const phys_world *w, phys_body body) {
    uint32_t i = live_row(w, body, "mass");
    return i == CORE_NO_ROW || w->bodies.im[i] == 0.0f ? 0.0f : 1.0f / w->bodies.im[i];
}

bool phys_body_position(const phys_world *w, phys_body body, core_vec3 *out) {
    uint32_t i = live_row(w, body, "position");
    if (i == CORE_NO_ROW) {
        return false;
    }
    *out = phys_get3(w->bodies.px, w->bodies.py, w->bodies.pz, i);
    return true;
}

bool phys_body_rotation(const phys_world *w, phys_body body, core_quat *out) {
    uint32_t i = live_row(w, body, "rotation");
    if (i == CORE_NO_ROW) {
        return false;
    }
    *out = phys_body_quat(&w->bodies, i);
    return true;
}

bool phys_body_velocity(const phys_world *w, phys_body body, core_vec3 *out) {
    uint32_t i = live_row(w, body, "velocity");
    if (i == CORE_NO_ROW) {
        return false;
    }
    *out = phys_get3(w->bodies.vx, w->bodies.vy, w->bodies.vz, i);
    return true;
}

bool phys_body_angular_velocity(const phys_world *w, phys_body body, core_vec3 *out) {
    uint32_t i = live_row(w, body, "angular velocity");
    if (i == CORE_NO_ROW) {
        return false;
    }
    *out = phys_get3(w->bodies.wx, w->bodies.wy, w->bodies.wz, i);
    return true;
}

bool phys_body_set_position(phys_world *w, phys_body body, core_vec3 p) {
    uint32_t i = live_row(w, body, "set position");
    if (i == CORE_NO_ROW || !check_vec("position", p, PHYS_FAR)) {
        return false;
    }
    phys_static_note(w, i);
    phys_put3(w->bodies.px, w->bodies.py, w->bodies.pz, i, p);
    phys_static_note(w, i);
    phys_body_sync_center(&w->bodies, i);
    w->bodies.seen[i] = phys_get3(w->bodies.cx, w->bodies.cy, w->bodies.cz, i);
    w->measured = false;
    w->edited = true;
    phys_wake_row(w, i);
    return true;
}

bool phys_body_set_rotation(phys_world *w, phys_body body, core_quat q) {
    uint32_t i = live_row(w, body, "set rotation");
    if (i == CORE_NO_ROW) {
        return false;
    }
    float n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (!(n > 1e-12f && n < 1e12f)) {
        return core_fail("phys body: rotation (%g, %g, %g, %g) has no direction", (double)q.x,
                         (double)q.y, (double)q.z, (double)q.w);
    }
    phys_static_note(w, i);
    q = phys_quat_unit(q);
    w->bodies.qx[i] = q.x;
    w->bodies.qy[i] = q.y;
    w->bodies.qz[i] = q.z;
    w->bodies.qw[i] = q.w;
    phys_static_note(w, i);
    phys_body_sync_center(&w->bodies, i);
    w->edited = true;
    phys_wake_row(w, i);
    return true;
}

// Static bodies have no velocity: setting one is refused, not ignored.
static bool moving(const phys_world *w, uint32_t i, const char *what) {
    return w->bodies.type[i] != PHYS_STATIC || core_fail("phys body: %s of a static body", what);
}

bool phys_body_set_velocity(phys_world *w, phys_body body, core_vec3 v) {
    uint32_t i = live_row(w, body, "set velocity");
    if (i == CORE_NO_ROW || !moving(w, i, "set velocity") || !check_vec("velocity", v, PHYS_FAR)) {
        return false;
    }
    phys_put3(w->bodies.vx, w->bodies.vy, w->bodies.vz, i, v);
    w->measured = false;
    w->edited = true;
    phys_wake_row(w, i);
    return true;
}

bool phys_body_set_angular_velocity(phys_world *w, phys_body body, core_vec3 v) {
    uint32_t i = live_row(w, body, "set angular velocity");
    if (i == CORE_NO_ROW || !moving(w, i, "set angular velocity") ||
        !check_vec("angular velocity", v, PHYS_FAR)) {
        return false;
    }
    phys_put3(w->bodies.wx, w->bodies.wy, w->bodies.wz, i, v);
    w->measured = false;
    w->edited = true;
    phys_wake_row(w, i);
    return true;
}

bool phys_body_apply_force(phys_world *w, phys_body body, core_vec3 f) {
    uint32_t i = live_row(w, body, "apply force");
    if (i == CORE_NO_ROW || !check_vec("force", f, 1e30f)) {
        return false;
    }
    w->bodies.force[i] = core_v3_add(w->bodies.force[i], f);
    phys_wake_row(w, i);
    return true;
}

bool phys_body_apply_impulse(phys_world *w, phys_body body, core_vec3 j, core_vec3 at) {
    phys_bodies *b = &w->bodies;
    uint32_t i = live_row(w, body, "apply impulse");
    if (i == CORE_NO_ROW || !check_vec("impulse", j, 1e30f) || !check_vec("point", at, PHYS_FAR)) {
        return false;
    }
    if (b->type[i] != PHYS_DYNAMIC) {
        return true;
    }
    core_vec3 r = core_v3_sub(at, phys_get3(b->cx, b->cy, b->cz, i));
    core_vec3 dw = phys_body_inverse_inertia(b, i, core_v3_cross(r, j));
    core_vec3 v = phys_get3(b->vx, b->vy, b->vz, i), o = phys_get3(b->wx, b->wy, b->wz, i);
    phys_put3(b->vx, b->vy, b->vz, i, core_v3_mad(v, j, b->im[i]));
    phys_put3(b->wx, b->wy, b->wz, i, core_v3_add(o, dw));
    w->measured = false;
    w->edited = true;
    phys_wake_row(w, i);
    return true;
}
