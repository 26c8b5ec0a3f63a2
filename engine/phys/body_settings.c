// What may be changed of a body after it was made, but for its pose and velocity.
#include "phys/world.h"

static uint32_t live_row(const phys_world *w, phys_body body, const char *what) {
    uint32_t row = core_columns_row(&w->bodies.set, body);
    if (row == CORE_NO_ROW) {
        core_fail("phys body: %s of a stale or null handle (%u:%u)", what, body.index,
                  body.generation);
    }
    return row;
}

bool phys_body_apply_torque(phys_world *w, phys_body body, core_vec3 t) {
    uint32_t i = live_row(w, body, "apply torque");
    if (i == CORE_NO_ROW) {
        return false;
    }
    if (!phys_finite3(t)) {
        return core_fail("phys body: torque (%g, %g, %g) is not finite", (double)t.x, (double)t.y,
                         (double)t.z);
    }
    w->bodies.torque[i] = core_v3_add(w->bodies.torque[i], t);
    phys_wake_row(w, i);
    return true;
}

static uint32_t count_shapes(const phys_world *w, uint32_t row) {
    uint32_t n = 0;
    for (uint32_t slot = w->bodies.shape[row]; slot != 0; n++) {
        slot = w->shapes.next[phys_slot_row(&w->shapes.set, slot)];
    }
    return n;
}

bool phys_body_read(const phys_world *w, phys_body body, phys_body_settings *out) {
    const phys_bodies *b = &w->bodies;
    uint32_t i = live_row(w, body, "read");
    *out = (phys_body_settings){0};
    if (i == CORE_NO_ROW) {
        return false;
    }
    *out = (phys_body_settings){.type = (phys_body_type)b->type[i],
                                .linear_damping = b->linear_damping[i],
                                .angular_damping = b->angular_damping[i],
                                .gravity_scale = b->gravity_scale[i],
                                .locks = b->locks[i],
                                .layer = b->layer[i],
                                .contact_events = (b->flags[i] & PHYS_BODY_EVENTS) != 0,
                                .shape_count = count_shapes(w, i)};
    return true;
}

bool phys_body_write(phys_world *w, phys_body body, const phys_body_settings *in) {
    phys_bodies *b = &w->bodies;
    uint32_t i = live_row(w, body, "write");
    if (i == CORE_NO_ROW) {
        return false;
    }
    phys_body_desc d = phys_body_desc_default();
    d.linear_damping = in->linear_damping;
    d.angular_damping = in->angular_damping;
    d.gravity_scale = in->gravity_scale;
    d.locks = in->locks;
    d.layer = in->layer;
    if (!phys_body_check(&d) ||
        (in->layer != b->layer[i] && !phys_body_set_layer(w, body, in->layer))) {
        return false;
    }
    b->linear_damping[i] = in->linear_damping;
    b->angular_damping[i] = in->angular_damping;
    b->gravity_scale[i] = in->gravity_scale;
    b->locks[i] = (uint8_t)in->locks;
    b->flags[i] = (uint16_t)((b->flags[i] & ~(unsigned)PHYS_BODY_EVENTS) |
                             (in->contact_events ? PHYS_BODY_EVENTS : 0u));
    core_vec3 v = phys_get3(b->vx, b->vy, b->vz, i), o = phys_get3(b->wx, b->wy, b->wz, i);
    phys_put3(b->vx, b->vy, b->vz, i, phys_lock_motion(b->locks[i], v));
    phys_put3(b->wx, b->wy, b->wz, i, phys_lock_turn(b->locks[i], o));
    w->measured = false;
    w->edited = true;
    phys_wake_row(w, i);
    return true;
}

bool phys_body_shape(const phys_world *w, phys_body body, uint32_t shape, phys_shape_type *type,
                     phys_material *material) {
    uint32_t i = live_row(w, body, "shape");
    if (i == CORE_NO_ROW) {
        return false;
    }
    uint32_t slot = w->bodies.shape[i];
    for (uint32_t k = 0; slot != 0 && k < shape; k++) {
        slot = w->shapes.next[phys_slot_row(&w->shapes.set, slot)];
    }
    if (slot == 0) {
        return core_fail("phys body: shape %u, expected less than %u", shape, count_shapes(w, i));
    }
    uint32_t row = phys_slot_row(&w->shapes.set, slot);
    *type = (phys_shape_type)w->shapes.type[row];
    *material = phys_shape_material(&w->shapes, row);
    return true;
}

bool phys_body_set_material(phys_world *w, phys_body body, const phys_material *m) {
    phys_shapes *s = &w->shapes;
    uint32_t i = live_row(w, body, "set material");
    if (i == CORE_NO_ROW || !phys_material_check("body", m)) {
        return false;
    }
    for (uint32_t slot = w->bodies.shape[i]; slot != 0;) {
        uint32_t row = phys_slot_row(&s->set, slot);
        s->friction[row] = m->friction;
        s->restitution[row] = m->restitution;
        s->rolling[row] = m->rolling;
        slot = s->next[row];
    }
    phys_remix_contacts(w);
    phys_wake_row(w, i);
    return true;
}
