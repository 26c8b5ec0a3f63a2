// Feet that stand on the ground: rays of physics, goals of animation.
#include <math.h>

#include "scene/scene_internal.h"

static uint32_t feet_of(const scene *s, scene_entity e) {
    for (uint32_t i = 0; s->stands && i < core_columns_count(&s->feet.set); i++) {
        if (core_handle_equal(s->feet.entity[i], e)) {
            return i;
        }
    }
    return CORE_NO_ROW;
}

static bool set_goal(scene *s, anim_instance instance, uint32_t goal, anim_goal_kind kind,
                     uint32_t bone, core_vec3 by, float weight) {
    anim_goal_desc d = anim_goal_desc_default(kind);
    d.bone = bone;
    d.target = by;
    d.weight = weight;
    d.keep_rotation = true;
    return anim_instance_set_goal(s->anim, instance, goal, &d);
}

static void release_goals(scene *s, anim_instance instance, const scene_feet_set *how) {
    for (uint32_t i = 0; i < how->count; i++) {
        set_goal(s, instance, i, ANIM_GOAL_SHIFT, how->bone[i], core_v3(0, 0, 0), 0);
    }
    set_goal(s, instance, how->count, ANIM_GOAL_MOVE, how->root, core_v3(0, 0, 0), 0);
}

static void forget(scene *s, uint32_t i) {
    core_columns_remove(&s->feet.set, core_columns_handle(&s->feet.set, i), NULL, NULL);
}

static void make_feet(scene *s) {
    s->stands = s->stands || scene_feet_init(&s->feet, "scene.feet", 1u << 16);
}

// Goals are set once with weight 1: what they cannot be is told now, not in a step.
static bool check(scene *s, anim_instance instance, const scene_feet_desc *d) {
    if (d->count < 1 || d->count > SCENE_MAX_FEET || !(d->up >= 0) || !(d->down >= 0) ||
        !(d->speed >= 0) || !isfinite(d->up + d->down + d->speed)) {
        return core_fail("scene_set_feet: expected 1..%d feet and up, down, speed >= 0",
                         SCENE_MAX_FEET);
    }
    for (uint32_t i = 0; i < d->count; i++) {
        if (!set_goal(s, instance, i, ANIM_GOAL_SHIFT, d->bone[i], core_v3(0, 0, 0), 1)) {
            return false;
        }
    }
    return set_goal(s, instance, d->count, ANIM_GOAL_MOVE, d->root, core_v3(0, 0, 0), 1);
}

bool scene_set_feet(scene *s, scene_entity e, const scene_feet_desc *d) {
    uint32_t row = scene_row(s, e), i = feet_of(s, e);
    anim_instance instance = row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.anim[row];
    if (row == CORE_NO_ROW || !s->anim || !anim_instance_alive(s->anim, instance)) {
        return core_fail("scene_set_feet: the entity has no animation");
    }
    if (i != CORE_NO_ROW) {
        release_goals(s, instance, &s->feet.how[i]);
        forget(s, i);
    }
    if (!d) {
        return true;
    }
    if (!check(s, instance, d)) {
        return false;
    }
    make_feet(s);
    core_handle h = s->stands ? core_columns_add(&s->feet.set) : CORE_NULL_HANDLE;
    if (core_handle_is_null(h)) {
        return false;
    }
    i = core_columns_row(&s->feet.set, h);
    s->feet.entity[i] = e;
    scene_feet_set *how = &s->feet.how[i];
    for (uint32_t k = 0; k < d->count; k++) {
        how->bone[k] = d->bone[k];
    }
    how->count = d->count;
    how->root = d->root;
    how->layers = d->layers;
    how->up = d->up > 0 ? d->up : 0.5f;
    how->down = d->down > 0 ? d->down : 0.5f;
    how->speed = d->speed > 0 ? d->speed : 2.0f;
    return true;
}

// Height of the ground under a point over the entity's own; 0 where there is none to stand on.
static float ground_under(scene *s, const scene_feet_set *how, uint32_t row, core_vec3 foot) {
    const scene_entities *e = &s->entity;
    phys_filter filter = phys_filter_default();
    filter.layers = how->layers;
    filter.skip = e->body[row];
    core_vec3 from = {foot.x, e->wpy[row] + how->up, foot.z};
    phys_hit hit;
    bool found =
        phys_world_ray(s->phys, from, core_v3(0, -(how->up + how->down), 0), &filter, &hit);
    return found && hit.normal.y > 0.3f ? hit.point.y - e->wpy[row] : 0;
}

static float toward(float now, float wanted, float most) {
    return now + CORE_CLAMP(wanted - now, -most, most);
}

static void place(scene *s, uint32_t i, uint32_t row, anim_instance instance) {
    const scene_entities *e = &s->entity;
    const scene_feet_set *how = &s->feet.how[i];
    scene_feet_now *now = &s->feet.now[i];
    core_quat q = {e->wqx[row], e->wqy[row], e->wqz[row], e->wqw[row]};
    core_vec3 at = {e->wpx[row], e->wpy[row], e->wpz[row]};
    float scale = e->wsy[row], lowest = 0;
    core_vec3 up =
        core_v3_scale(core_quat_rotate(core_quat_conjugate(q), core_v3(0, 1, 0)), 1 / scale);
    for (uint32_t k = 0; k < how->count; k++) {
        core_mat4 m;
        if (!anim_instance_bone(s->anim, instance, how->bone[k], &m)) {
            continue;
        }
        core_vec3 in_model = core_v3_scale(core_v3(m.m[12], m.m[13], m.m[14]), scale);
        core_vec3 foot = core_v3_add(at, core_quat_rotate(q, in_model));
        float ground = s->phys ? ground_under(s, how, row, foot) : 0;
        now->offset[k] = toward(now->offset[k], ground, how->speed * s->dt);
        lowest = CORE_MIN(lowest, now->offset[k]);
        set_goal(s, instance, k, ANIM_GOAL_SHIFT, how->bone[k], core_v3_scale(up, now->offset[k]),
                 1);
    }
    now->lowered = toward(now->lowered, lowest, how->speed * s->dt);
    set_goal(s, instance, how->count, ANIM_GOAL_MOVE, how->root, core_v3_scale(up, now->lowered),
             1);
}

void scene_feet_step(scene *s) {
    if (!s->stands) {
        return;
    }
    core_stage_begin(s->metrics, CORE_STAGE_ANIM);
    for (uint32_t i = core_columns_count(&s->feet.set); i-- > 0;) {
        uint32_t row = core_columns_row(&s->entity.set, s->feet.entity[i]);
        anim_instance instance = row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.anim[row];
        if (row == CORE_NO_ROW || !anim_instance_alive(s->anim, instance)) {
            forget(s, i);
        } else if (s->entity.wsy[row] > 0) {
            place(s, i, row, instance);
        }
    }
    core_stage_end(s->metrics, CORE_STAGE_ANIM);
}

static bool stands_well(const scene *s, uint32_t i) {
    const scene_feet_set *how = &s->feet.how[i];
    bool good = how->count >= 1 && how->count <= SCENE_MAX_FEET && isfinite(how->up) &&
                isfinite(how->down) && isfinite(how->speed) && isfinite(s->feet.now[i].lowered);
    for (uint32_t k = 0; good && k < how->count; k++) {
        good = isfinite(s->feet.now[i].offset[k]);
    }
    return good;
}

bool scene_feet_stream(scene *s, core_stream *stream) {
    uint32_t stands = s->stands;
    if (!core_stream_count(stream, "feet", &stands, 1)) {
        return false;
    }
    if (!stands) { // a save from before the first feet
        if (s->stands && !stream->writing) {
            core_columns_release(&s->feet.set);
            s->feet = (scene_feet){0};
            s->stands = false;
        }
        return true;
    }
    make_feet(s);
    if (!s->stands || !core_stream_columns(stream, &s->feet.set)) {
        return false;
    }
    for (uint32_t i = 0; i < core_columns_count(&s->feet.set); i++) {
        if (!stands_well(s, i)) {
            return core_stream_fail(stream, "scene.feet", "row %u: feet that cannot be", i);
        }
    }
    return true;
}
