// The animation room in a scene: instances on entities, root motion, palettes to drawn meshes.
#include <math.h>
#include <string.h>

#include "scene/scene_internal.h"

anim_world *scene_anim(scene *s) {
    if (!s->anim) {
        anim_world_desc desc = anim_world_desc_default();
        desc.jobs = s->jobs;
        desc.metrics = s->metrics;
        s->anim = anim_world_create(&desc);
        for (uint32_t i = 0; s->anim && i < s->setting_count; i++) {
            if (strcmp(s->setting[i].room, "anim") == 0) {
                anim_world_set(s->anim, s->setting[i].name, s->setting[i].value);
            }
        }
        scene_settings_apply(s, "anim", s->anim);
    }
    return s->anim;
}
anim_world *scene_anim_if(const scene *s) { return s->anim; }

anim_instance scene_entity_anim(const scene *s, scene_entity e) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    return row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.anim[row];
}

scene_entity scene_entity_of_anim(const scene *s, anim_instance instance) {
    if (!s->anim || !anim_instance_alive(s->anim, instance)) {
        return CORE_NULL_HANDLE;
    }
    uint64_t bits = anim_instance_user(s->anim, instance);
    scene_entity e = {(uint32_t)bits, (uint32_t)(bits >> 32)};
    return core_handle_equal(scene_entity_anim(s, e), instance) ? e : CORE_NULL_HANDLE;
}

bool scene_set_anim(scene *s, scene_entity e, anim_instance instance) {
    uint32_t row = scene_row(s, e);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!s->anim || !anim_instance_alive(s->anim, instance)) {
        return core_fail("scene_set_anim: the animation instance does not exist");
    }
    scene_anim_leave(s, row);
    s->entity.anim[row] = instance;
    s->entity.skin[row] = instance;
    return anim_instance_set_user(s->anim, instance, core_handle_bits(e));
}

void scene_anim_leave(scene *s, uint32_t row) {
    if (s->anim && anim_instance_alive(s->anim, s->entity.anim[row])) {
        anim_instance_destroy(s->anim, s->entity.anim[row]);
    }
    s->entity.anim[row] = CORE_NULL_HANDLE;
    s->entity.skin[row] = CORE_NULL_HANDLE;
}

// One mesh of a model on an entity's row.
static bool draw_part(scene *s, uint32_t row, const scene_model_view *model, uint32_t part,
                      anim_instance instance) {
    scene_entities *e = &s->entity;
    gfx_instance_desc draw = {.mesh = model->mesh[part], .material = model->material[part]};
    e->dx[row] = e->dy[row] = e->dz[row] = 1;
    e->instance[row] = gfx_instance_create(scene_gfx(s), &draw);
    e->skin[row] = model->skinned[part] ? instance : CORE_NULL_HANDLE;
    return !core_handle_is_null(e->instance[row]);
}

static bool draw_parts(scene *s, scene_entity self, const scene_model_view *model,
                       anim_instance instance) {
    for (uint32_t part = 0; part < model->mesh_count; part++) {
        scene_entity e = self;
        if (part > 0) {
            scene_spawn_desc child = scene_spawn_desc_default();
            child.parent = self;
            e = scene_spawn(s, &child);
        }
        uint32_t row = core_columns_row(&s->entity.set, e);
        if (row == CORE_NO_ROW || !draw_part(s, row, model, part, instance)) {
            return false;
        }
    }
    return true;
}

bool scene_add_model(scene *s, uint32_t row, const scene_spawn_desc *d) {
    bool content = !core_handle_is_null(d->machine) || !core_handle_is_null(d->clip);
    if (core_handle_is_null(d->model)) {
        return !content || core_fail("spawn: a machine or clip needs a model to move");
    }
    scene_model_view model;
    if (!scene_model_look(s, d->model, &model)) {
        return false;
    }
    if (d->draw) {
        return core_fail("spawn: give either a mesh or a model");
    }
    scene_entity self = core_columns_handle(&s->entity.set, row);
    anim_instance instance = CORE_NULL_HANDLE;
    if (!core_handle_is_null(model.skeleton)) {
        anim_instance_desc desc = anim_instance_desc_default();
        desc.skeleton = model.skeleton;
        desc.machine = d->machine;
        desc.clip = d->clip;
        instance = anim_instance_create(scene_anim(s), &desc);
        if (core_handle_is_null(instance)) {
            return false;
        }
        scene_set_anim(s, self, instance);
    } else if (content) {
        return core_fail("spawn: this model has no skeleton for a machine or clip");
    }
    return draw_parts(s, self, &model, instance);
}

static void move_by_root(scene *s, uint32_t row, core_vec3 d) {
    scene_entities *e = &s->entity;
    core_vec3 scaled = {d.x * e->wsx[row], d.y * e->wsy[row], d.z * e->wsz[row]};
    core_vec3 moved =
        core_quat_rotate((core_quat){e->wqx[row], e->wqy[row], e->wqz[row], e->wqw[row]}, scaled);
    if (s->phys && phys_body_alive(s->phys, e->body[row])) {
        core_vec3 v;
        phys_body_velocity(s->phys, e->body[row], &v);
        phys_body_set_velocity(s->phys, e->body[row],
                               core_v3(moved.x / s->dt, v.y, moved.z / s->dt));
        return;
    }
    // The parent's frame is left alone: root motion of a child moves it in its own local frame.
    core_vec3 local =
        core_quat_rotate((core_quat){e->qx[row], e->qy[row], e->qz[row], e->qw[row]},
                         core_v3(d.x * e->sx[row], d.y * e->sy[row], d.z * e->sz[row]));
    e->px[row] += local.x;
    e->py[row] += local.y;
    e->pz[row] += local.z;
    scene_world_of(s, row);
}

void scene_anim_update(scene *s) {
    if (!s->anim) {
        return;
    }
    anim_world_update(s->anim, s->dt);
    core_stage_begin(s->metrics, CORE_STAGE_ANIM);
    for (uint32_t i = 0; i < anim_instance_count(s->anim); i++) {
        anim_instance instance = anim_instance_at(s->anim, i);
        core_vec3 d = {0, 0, 0};
        anim_instance_root_motion(s->anim, instance, &d);
        if (d.x != 0 || d.y != 0 || d.z != 0) {
            uint32_t row = core_columns_row(&s->entity.set, scene_entity_of_anim(s, instance));
            if (row != CORE_NO_ROW) {
                move_by_root(s, row, d);
            }
        }
    }
    core_stage_end(s->metrics, CORE_STAGE_ANIM);
}

void scene_anim_pose(scene *s) {
    if (s->anim) {
        anim_world_pose(s->anim);
    }
}

// Pixels of a picture 1,080 high that a metre at a place takes; 0: it is not in the picture, nor
// within a margin of it that may throw a shadow in. Wide pictures are reckoned with.
static float pixels_of(const gfx_camera *c, core_vec3 place, float radius) {
    enum { HEIGHT = 1080 };
    const float widest = 2.4f, margin = 2;
    float reach = core_tanf((c->fovy > 0 ? c->fovy : 1.0472f) * 0.5f);
    core_vec3 to = core_v3_sub(place, c->position);
    core_vec3 local = core_quat_rotate(core_quat_conjugate(c->rotation), to);
    float ahead = -local.z + radius + margin;
    if (c->ortho_height > 0) {
        return HEIGHT / c->ortho_height;
    }
    if (ahead <= 0 || fabsf(local.y) > reach * ahead + radius + margin ||
        fabsf(local.x) > widest * reach * ahead + radius + margin) {
        return 0;
    }
    return HEIGHT / (2 * reach * CORE_MAX(-local.z - radius, 0.1f));
}

// How far behind the palette of each drawn skeleton may be: so many pixels of the picture.
static void set_tolerances(scene *s, float pixels) {
    const scene_entities *e = &s->entity;
    gfx_camera camera = gfx_world_camera(s->gfx);
    for (uint32_t i = 0; i < anim_instance_count(s->anim); i++) {
        anim_instance instance = anim_instance_at(s->anim, i);
        uint32_t row = core_columns_row(&e->set, scene_entity_of_anim(s, instance));
        if (row == CORE_NO_ROW) {
            continue;
        }
        float scale = CORE_MAX(e->wsx[row], CORE_MAX(e->wsy[row], e->wsz[row]));
        core_vec3 place = {e->wpx[row], e->wpy[row], e->wpz[row]};
        float seen = pixels_of(&camera, place, scale * anim_instance_radius(s->anim, instance));
        anim_instance_set_tolerance(s->anim, instance,
                                    seen > 0 && scale > 0 ? pixels / (seen * scale) : INFINITY);
    }
}

void scene_anim_sync(scene *s) {
    const scene_entities *e = &s->entity;
    if (s->anim && anim_world_lod(s->anim) > 0) {
        set_tolerances(s, anim_world_lod(s->anim));
    }
    for (uint32_t row = 0; s->anim && row < core_columns_count(&e->set); row++) {
        if (core_handle_is_null(e->skin[row]) || core_handle_is_null(e->instance[row])) {
            continue;
        }
        uint32_t bones;
        const float *palette = anim_instance_palette(s->anim, e->skin[row], &bones);
        if (palette) {
            gfx_instance_set_palette(s->gfx, e->instance[row], palette, bones);
        }
    }
}
