// Entities: made whole or not at all, removed with everything below them.
#include <math.h>
#include <string.h>

#include "scene/scene_internal.h"

#define SCENE_SPAWN_COOKIE 0x5ce7e002u

scene_spawn_desc scene_spawn_desc_default(void) {
    return (scene_spawn_desc){.cookie = SCENE_SPAWN_COOKIE};
}

uint32_t scene_row(const scene *s, scene_entity e) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    if (row == CORE_NO_ROW) {
        core_fail("scene: entity %u:%u does not exist (despawned, or from another scene)", e.index,
                  e.generation);
    }
    return row;
}

static bool finite3(core_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static core_vec3 or_one(core_vec3 v) {
    return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f ? core_v3(1, 1, 1) : v;
}

static bool spawn_desc_ok(const scene *s, const scene_spawn_desc *d) {
    if (!d || d->cookie != SCENE_SPAWN_COOKIE) {
        return core_fail("spawn: description was not made by scene_spawn_desc_default()");
    }
    const char *name = d->name ? d->name : "";
    if (!finite3(d->position) || !finite3(d->scale) || !finite3(d->draw_scale)) {
        return core_fail("spawn '%s': position, scale and draw_scale must be finite numbers", name);
    }
    if (strlen(name) >= SCENE_NAME_MAX) {
        return core_fail("spawn '%.32s...': name is %zu bytes long, at most %d", name, strlen(name),
                         SCENE_NAME_MAX - 1);
    }
    if (!core_handle_is_null(d->parent) && !scene_alive(s, d->parent)) {
        return core_fail("spawn '%s': its parent does not exist (despawned)", name);
    }
    if (d->body && !d->shape_count) {
        return core_fail("spawn '%s': a body needs at least one shape", name);
    }
    return true;
}

static bool add_body(scene *s, uint32_t row, const scene_spawn_desc *d) {
    scene_entities *e = &s->entity;
    phys_world *world = scene_phys(s);
    if (!world) {
        return false;
    }
    phys_body_desc body = *d->body;
    body.position = (core_vec3){e->wpx[row], e->wpy[row], e->wpz[row]};
    body.rotation = (core_quat){e->wqx[row], e->wqy[row], e->wqz[row], e->wqw[row]};
    body.user = core_handle_bits(core_columns_handle(&e->set, row));
    e->body[row] = phys_body_create(world, &body, d->shapes, d->shape_count);
    return !core_handle_is_null(e->body[row]);
}

static bool add_draw(scene *s, uint32_t row, const scene_spawn_desc *d) {
    scene_entities *e = &s->entity;
    core_vec3 size = or_one(d->draw_scale);
    gfx_world *world = scene_gfx(s);
    if (!world) {
        return false;
    }
    e->dx[row] = size.x;
    e->dy[row] = size.y;
    e->dz[row] = size.z;
    e->instance[row] = gfx_instance_create(world, d->draw);
    return !core_handle_is_null(e->instance[row]);
}

static bool add_name(scene *s, uint32_t row, const char *text) {
    core_handle h = core_columns_add(&s->name.set);
    if (core_handle_is_null(h)) {
        return false;
    }
    uint32_t n = core_columns_row(&s->name.set, h);
    strcpy(s->name.text[n].text, text);
    s->name.entity[n] = core_columns_handle(&s->entity.set, row);
    s->entity.name[row] = h;
    return true;
}

// Gives back what the entity owns in other sets, then its row.
static void remove_entity(scene *s, scene_entity self) {
    scene_entities *e = &s->entity;
    uint32_t row = core_columns_row(&e->set, self);
    if (s->phys && phys_body_alive(s->phys, e->body[row])) {
        phys_body_destroy(s->phys, e->body[row]);
    }
    scene_anim_leave(s, row);
    scene_nav_leave(s, row);
    scene_audio_leave(s, row);
    if (!core_handle_is_null(e->instance[row])) {
        gfx_instance_destroy(s->gfx, e->instance[row]);
    }
    if (!core_handle_is_null(e->name[row])) {
        core_columns_remove(&s->name.set, e->name[row], NULL, NULL);
    }
    if (e->depth[row] || s->order_count) {
        scene_unlink(s, row);
    }
    core_columns_remove(&e->set, self, NULL, NULL);
}

scene_entity scene_spawn(scene *s, const scene_spawn_desc *d) {
    if (!spawn_desc_ok(s, d)) {
        return CORE_NULL_HANDLE;
    }
    scene_entities *e = &s->entity;
    scene_entity self = core_columns_add(&e->set);
    if (core_handle_is_null(self)) {
        return self;
    }
    uint32_t row = core_columns_row(&e->set, self);
    core_quat q = core_quat_normalize(d->rotation);
    core_vec3 scale = or_one(d->scale);
    e->px[row] = d->position.x;
    e->py[row] = d->position.y;
    e->pz[row] = d->position.z;
    e->qx[row] = q.x;
    e->qy[row] = q.y;
    e->qz[row] = q.z;
    e->qw[row] = q.w;
    e->sx[row] = scale.x;
    e->sy[row] = scale.y;
    e->sz[row] = scale.z;
    e->tags[row] = d->tags;
    scene_link(s, row, d->parent);
    scene_world_of(s, row);
    scene_interpolation_reset(s, row);
    if ((d->body && !add_body(s, row, d)) || (d->draw && !add_draw(s, row, d)) ||
        (d->name && d->name[0] && !add_name(s, row, d->name)) || !scene_add_model(s, row, d)) {
        scene_despawn(s, self);
        return CORE_NULL_HANDLE;
    }
    return self;
}

bool scene_despawn(scene *s, scene_entity root) {
    if (scene_row(s, root) == CORE_NO_ROW) {
        return false;
    }
    for (scene_entity at = root;;) {
        uint32_t row = core_columns_row(&s->entity.set, at);
        if (!core_handle_is_null(s->entity.first_child[row])) {
            at = s->entity.first_child[row];
            continue;
        }
        scene_entity parent = s->entity.parent[row];
        bool last = core_handle_equal(at, root);
        remove_entity(s, at);
        if (last) {
            return true;
        }
        at = parent;
    }
}

bool scene_alive(const scene *s, scene_entity e) {
    return core_columns_row(&s->entity.set, e) != CORE_NO_ROW;
}

uint32_t scene_entity_count(const scene *s) { return core_columns_count(&s->entity.set); }

scene_entity scene_entity_at(const scene *s, uint32_t row) {
    return row < core_columns_count(&s->entity.set) ? core_columns_handle(&s->entity.set, row)
                                                    : CORE_NULL_HANDLE;
}

phys_body scene_entity_body(const scene *s, scene_entity e) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    return row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.body[row];
}

gfx_instance scene_entity_instance(const scene *s, scene_entity e) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    return row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.instance[row];
}

scene_entity scene_parent(const scene *s, scene_entity e) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    return row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.parent[row];
}

scene_entity scene_entity_of_body(const scene *s, phys_body body) {
    if (!s->phys || !phys_body_alive(s->phys, body)) {
        return CORE_NULL_HANDLE;
    }
    uint64_t bits = phys_body_user(s->phys, body);
    scene_entity e = {(uint32_t)bits, (uint32_t)(bits >> 32)};
    uint32_t row = core_columns_row(&s->entity.set, e);
    bool owns = row != CORE_NO_ROW && core_handle_equal(s->entity.body[row], body);
    return owns ? e : CORE_NULL_HANDLE;
}

const char *scene_entity_name(const scene *s, scene_entity e) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    uint32_t n =
        row == CORE_NO_ROW ? CORE_NO_ROW : core_columns_row(&s->name.set, s->entity.name[row]);
    return n == CORE_NO_ROW ? "" : s->name.text[n].text;
}

// Oldest by handle index: rows move on removal, handles do not.
scene_entity scene_find(const scene *s, const char *name) {
    scene_entity best = CORE_NULL_HANDLE;
    for (uint32_t n = 0; n < core_columns_count(&s->name.set); n++) {
        scene_entity e = s->name.entity[n];
        if (strcmp(s->name.text[n].text, name) == 0 &&
            (core_handle_is_null(best) || e.index < best.index)) {
            best = e;
        }
    }
    return best;
}

// ---- transforms ----

bool scene_position(const scene *s, scene_entity e, core_vec3 *out) {
    uint32_t row = scene_row(s, e);
    if (row == CORE_NO_ROW) {
        return false;
    }
    phys_body body = s->entity.body[row];
    if (s->phys && phys_body_alive(s->phys, body)) {
        return phys_body_position(s->phys, body, out);
    }
    *out = (core_vec3){s->entity.wpx[row], s->entity.wpy[row], s->entity.wpz[row]};
    return true;
}

bool scene_rotation(const scene *s, scene_entity e, core_quat *out) {
    uint32_t row = scene_row(s, e);
    if (row == CORE_NO_ROW) {
        return false;
    }
    phys_body body = s->entity.body[row];
    if (s->phys && phys_body_alive(s->phys, body)) {
        return phys_body_rotation(s->phys, body, out);
    }
    *out =
        (core_quat){s->entity.wqx[row], s->entity.wqy[row], s->entity.wqz[row], s->entity.wqw[row]};
    return true;
}

bool scene_set_position(scene *s, scene_entity self, core_vec3 p) {
    uint32_t row = scene_row(s, self);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!finite3(p)) {
        return core_fail("scene: position (%g, %g, %g) of '%s' is not finite", (double)p.x,
                         (double)p.y, (double)p.z, scene_entity_name(s, self));
    }
    scene_entities *e = &s->entity;
    bool led = s->phys && phys_body_alive(s->phys, e->body[row]);
    if (led && !phys_body_set_position(s->phys, e->body[row], p)) {
        return false;
    }
    e->wpx[row] = p.x;
    e->wpy[row] = p.y;
    e->wpz[row] = p.z;
    if (!led) {
        scene_local_from_world(s, row);
    }
    scene_subtree_moved(s, self);
    return true;
}

bool scene_set_rotation(scene *s, scene_entity self, core_quat q) {
    uint32_t row = scene_row(s, self);
    if (row == CORE_NO_ROW) {
        return false;
    }
    q = core_quat_normalize(q);
    scene_entities *e = &s->entity;
    bool led = s->phys && phys_body_alive(s->phys, e->body[row]);
    if (led && !phys_body_set_rotation(s->phys, e->body[row], q)) {
        return false;
    }
    e->wqx[row] = q.x;
    e->wqy[row] = q.y;
    e->wqz[row] = q.z;
    e->wqw[row] = q.w;
    if (!led) {
        scene_local_from_world(s, row);
    }
    scene_subtree_moved(s, self);
    return true;
}

bool scene_set_scale(scene *s, scene_entity self, core_vec3 v) {
    uint32_t row = scene_row(s, self);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!finite3(v)) {
        return core_fail("scene: scale (%g, %g, %g) of '%s' is not finite", (double)v.x,
                         (double)v.y, (double)v.z, scene_entity_name(s, self));
    }
    scene_entities *e = &s->entity;
    e->sx[row] = v.x;
    e->sy[row] = v.y;
    e->sz[row] = v.z;
    uint32_t above = core_columns_row(&e->set, e->parent[row]);
    e->wsx[row] = above == CORE_NO_ROW ? v.x : v.x * e->wsx[above];
    e->wsy[row] = above == CORE_NO_ROW ? v.y : v.y * e->wsy[above];
    e->wsz[row] = above == CORE_NO_ROW ? v.z : v.z * e->wsz[above];
    scene_subtree_moved(s, self);
    return true;
}
