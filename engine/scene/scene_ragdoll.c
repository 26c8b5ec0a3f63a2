// Ragdolls: an animated skeleton handed to physics and back. Going down, each body gets the place
// and the speed that its bone has; while it falls, bodies give the pose; getting up, the pose that
// it fell into fades into the animation's.
#include <math.h>
#include <string.h>

#include "scene/scene_internal.h"

enum { STARTING = 1, FALLING, RETURNING };

static void make_ragdolls(scene *s) {
    s->falls = s->falls || scene_ragdolls_init(&s->ragdoll, "scene.ragdolls", 1u << 12);
}

static uint32_t ragdoll_of(const scene *s, scene_entity e) {
    for (uint32_t i = 0; s->falls && i < core_columns_count(&s->ragdoll.set); i++) {
        if (core_handle_equal(s->ragdoll.entity[i], e)) {
            return i;
        }
    }
    return CORE_NO_ROW;
}

typedef struct frame { // of an entity or bone
    core_vec3 position;
    core_quat rotation;
    float scale;
} frame;

static frame frame_of(const scene *s, uint32_t row) {
    const scene_entities *e = &s->entity;
    return (frame){{e->wpx[row], e->wpy[row], e->wpz[row]},
                   {e->wqx[row], e->wqy[row], e->wqz[row], e->wqw[row]},
                   e->wsy[row]};
}

static frame inside(frame outer, core_vec3 t, core_quat q) {
    core_vec3 way = core_quat_rotate(outer.rotation, core_v3_scale(t, outer.scale));
    return (frame){core_v3_add(outer.position, way),
                   core_quat_normalize(core_quat_mul(outer.rotation, q)), outer.scale};
}

// Local poses of a whole skeleton, on the stack of a step.
typedef struct local_pose {
    core_vec3 translation[ANIM_MAX_BONES], scale[ANIM_MAX_BONES];
    core_quat rotation[ANIM_MAX_BONES];
} local_pose;

static anim_pose view_of(local_pose *p) {
    return (anim_pose){.translation = p->translation, .rotation = p->rotation, .scale = p->scale};
}

static void bind_of(const scene *s, anim_skeleton skeleton, local_pose *out) {
    for (uint32_t b = 0; b < anim_skeleton_bone_count(s->anim, skeleton); b++) {
        core_key key;
        anim_skeleton_bind(s->anim, skeleton, b, &key);
        out->translation[b] = key.translation;
        out->rotation[b] = key.rotation;
        out->scale[b] = key.scale;
    }
}

// Frames in the world of the bones that have bodies.
static void world_of(const scene *s, anim_skeleton skeleton, frame entity, const local_pose *p,
                     const scene_ragdoll_parts *parts, frame *out) {
    frame model[ANIM_MAX_BONES];
    uint32_t next = 0;
    for (uint32_t b = 0; b < anim_skeleton_bone_count(s->anim, skeleton); b++) {
        int32_t parent = anim_skeleton_parent(s->anim, skeleton, b);
        model[b] = inside(parent < 0 ? entity : model[parent], p->translation[b], p->rotation[b]);
        if (next < parts->count && parts->bone[next] == b) {
            out[next++] = model[b];
        }
    }
}

// Bones in the bind pose where the entity stands. Returns how many get a body.
static uint32_t rest_bones(const scene *s, anim_skeleton skeleton, frame entity,
                           const scene_ragdoll_how *how, phys_ragdoll_bone *out) {
    local_pose bind;
    int32_t parent[ANIM_MAX_BONES];
    bind_of(s, skeleton, &bind);
    uint32_t count = anim_skeleton_bone_count(s->anim, skeleton);
    for (uint32_t b = 0; b < count; b++) {
        parent[b] = anim_skeleton_parent(s->anim, skeleton, b);
    }
    core_skeleton_data data = {.bone_count = count,
                               .parent = parent,
                               .translation = bind.translation,
                               .rotation = bind.rotation,
                               .scale = bind.scale};
    return phys_ragdoll_bones(&data, entity.position, entity.rotation, entity.scale, how->mass,
                              how->least, out, SCENE_RAGDOLL_BONES);
}

static bool good_number(float x) { return x >= 0 && isfinite(x); }

bool scene_ragdoll_start(scene *s, scene_entity e, const scene_ragdoll_desc *d) {
    uint32_t row = scene_row(s, e);
    anim_instance instance = row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.anim[row];
    if (row == CORE_NO_ROW || !s->anim || !anim_instance_alive(s->anim, instance)) {
        return core_fail("ragdoll: the entity has no animation");
    }
    if (ragdoll_of(s, e) != CORE_NO_ROW) {
        return core_fail("ragdoll: the entity is one already, or is getting up");
    }
    if (!good_number(d->mass) || !good_number(d->least) || d->layer > 31) {
        return core_fail("ragdoll: mass %g kg, least %g m, layer %u: expected >= 0, >= 0, 0..31",
                         (double)d->mass, (double)d->least, d->layer);
    }
    scene_ragdoll_how how = {d->mass > 0 ? d->mass : 70, d->least > 0 ? d->least : 0.02f, d->layer};
    phys_ragdoll_bone rest[SCENE_RAGDOLL_BONES];
    anim_skeleton skeleton = anim_instance_skeleton(s->anim, instance);
    uint32_t count = rest_bones(s, skeleton, frame_of(s, row), &how, rest);
    if (count == 0) {
        return core_fail("ragdoll: no bone of the skeleton is as long as %g m", (double)how.least);
    }
    make_ragdolls(s);
    core_handle h = s->falls ? core_columns_add(&s->ragdoll.set) : CORE_NULL_HANDLE;
    if (core_handle_is_null(h)) {
        return false;
    }
    uint32_t i = core_columns_row(&s->ragdoll.set, h);
    scene_ragdoll_parts *parts = &s->ragdoll.parts[i];
    s->ragdoll.entity[i] = e;
    s->ragdoll.how[i] = how;
    s->ragdoll.phase[i] = STARTING;
    s->ragdoll.weight[i] = 1;
    parts->count = CORE_MIN(count, (uint32_t)SCENE_RAGDOLL_BONES);
    for (uint32_t k = 0; k < parts->count; k++) {
        parts->bone[k] = rest[k].bone;
    }
    // The speed of a bone is what it moves from now to the pose of this step.
    local_pose now;
    frame at[SCENE_RAGDOLL_BONES];
    anim_pose view = view_of(&now);
    anim_instance_pose(s->anim, instance, view);
    world_of(s, skeleton, frame_of(s, row), &now, parts, at);
    for (uint32_t k = 0; k < parts->count; k++) {
        s->ragdoll.was[i].position[k] = at[k].position;
        s->ragdoll.was[i].rotation[k] = at[k].rotation;
    }
    return true;
}

bool scene_ragdoll_stop(scene *s, scene_entity e, float length) {
    uint32_t i = ragdoll_of(s, e);
    if (i == CORE_NO_ROW || s->ragdoll.phase[i] == RETURNING || !good_number(length)) {
        return core_fail(i == CORE_NO_ROW || s->ragdoll.phase[i] == RETURNING
                             ? "ragdoll: the entity is none"
                             : "ragdoll: a length of getting up must be >= 0");
    }
    for (uint32_t k = 0; k < s->ragdoll.parts[i].count; k++) {
        if (phys_body_alive(s->phys, s->ragdoll.parts[i].body[k])) {
            phys_body_destroy(s->phys, s->ragdoll.parts[i].body[k]);
        }
        s->ragdoll.parts[i].body[k] = CORE_NULL_HANDLE;
    }
    s->ragdoll.phase[i] = RETURNING;
    s->ragdoll.length[i] = length;
    return true;
}

uint32_t scene_ragdoll_bodies(const scene *s, scene_entity e, phys_body *out, uint32_t capacity) {
    uint32_t i = ragdoll_of(s, e), n = 0;
    for (uint32_t k = 0; i != CORE_NO_ROW && k < s->ragdoll.parts[i].count; k++) {
        if (s->phys && phys_body_alive(s->phys, s->ragdoll.parts[i].body[k])) {
            if (n < capacity) {
                out[n] = s->ragdoll.parts[i].body[k];
            }
            n++;
        }
    }
    return n;
}

// The way from one rotation to another as an angular velocity.
static core_vec3 spin(core_quat from, core_quat to, float dt) {
    core_quat q = core_quat_mul(to, core_quat_conjugate(from));
    float side = q.w < 0 ? -1.0f : 1.0f;
    core_vec3 v = {q.x * side, q.y * side, q.z * side};
    float sine = core_v3_length(v);
    float angle = 2 * core_atan2f(sine, q.w * side);
    return sine > 1e-6f ? core_v3_scale(v, angle / (sine * dt)) : core_v3(0, 0, 0);
}

static bool let_go(scene *s, uint32_t i, uint32_t row, anim_instance instance) {
    anim_skeleton skeleton = anim_instance_skeleton(s->anim, instance);
    scene_ragdoll_parts *parts = &s->ragdoll.parts[i];
    phys_ragdoll_bone rest[SCENE_RAGDOLL_BONES];
    phys_ragdoll_pose pose[SCENE_RAGDOLL_BONES];
    phys_joint joint[SCENE_RAGDOLL_BONES];
    frame at[SCENE_RAGDOLL_BONES];
    local_pose now;
    frame entity = frame_of(s, row);
    rest_bones(s, skeleton, entity, &s->ragdoll.how[i], rest);
    anim_instance_pose(s->anim, instance, view_of(&now));
    world_of(s, skeleton, entity, &now, parts, at);
    const scene_ragdoll_was *was = &s->ragdoll.was[i];
    for (uint32_t k = 0; k < parts->count; k++) {
        core_vec3 way = core_v3_sub(at[k].position, was->position[k]);
        pose[k] =
            (phys_ragdoll_pose){at[k].position, core_v3_scale(way, 1 / s->dt),
                                spin(was->rotation[k], at[k].rotation, s->dt), at[k].rotation};
    }
    phys_ragdoll_desc desc = phys_ragdoll_desc_default();
    desc.bones = rest;
    desc.bone_count = parts->count;
    desc.pose = pose;
    desc.layer = s->ragdoll.how[i].layer;
    s->ragdoll.phase[i] = FALLING;
    return phys_ragdoll_create(scene_phys(s), &desc, parts->body, joint);
}

// Bodies to local pose: rotations from bodies, lengths from the bind pose, so that a joint's gap
// never stretches the skin; the topmost bodies give places too. The entity follows the first.
static void follow(scene *s, uint32_t i, uint32_t row, anim_instance instance) {
    anim_skeleton skeleton = anim_instance_skeleton(s->anim, instance);
    const scene_ragdoll_parts *parts = &s->ragdoll.parts[i];
    local_pose pose;
    frame model[ANIM_MAX_BONES], entity = frame_of(s, row);
    core_vec3 hips;
    bool led[ANIM_MAX_BONES];
    bind_of(s, skeleton, &pose);
    phys_body_position(s->phys, parts->body[0], &hips);
    entity.position.x = hips.x;
    entity.position.z = hips.z;
    for (uint32_t k = 0; k < parts->count; k++) {
        core_vec3 p;
        phys_body_position(s->phys, parts->body[k], &p);
        entity.position.y = k == 0 ? p.y : CORE_MIN(entity.position.y, p.y);
    }
    uint32_t next = 0;
    for (uint32_t b = 0; b < anim_skeleton_bone_count(s->anim, skeleton); b++) {
        int32_t parent = anim_skeleton_parent(s->anim, skeleton, b);
        frame outer = parent < 0 ? entity : model[parent];
        led[b] = parent >= 0 && led[parent];
        if (next < parts->count && parts->bone[next] == b) {
            core_vec3 p;
            core_quat q;
            phys_body_position(s->phys, parts->body[next], &p);
            phys_body_rotation(s->phys, parts->body[next], &q);
            core_quat back = core_quat_conjugate(outer.rotation);
            pose.rotation[b] = core_quat_normalize(core_quat_mul(back, q));
            if (!led[b]) {
                core_vec3 way = core_quat_rotate(back, core_v3_sub(p, outer.position));
                pose.translation[b] = core_v3_scale(way, 1 / outer.scale);
            }
            led[b] = true;
            next++;
        }
        model[b] = inside(outer, pose.translation[b], pose.rotation[b]);
    }
    scene_set_position(s, s->ragdoll.entity[i], entity.position);
    anim_pose view = view_of(&pose);
    anim_instance_set_external(s->anim, instance, &view, 1);
}

static bool whole(const scene *s, uint32_t i) {
    for (uint32_t k = 0; k < s->ragdoll.parts[i].count; k++) {
        if (!phys_body_alive(s->phys, s->ragdoll.parts[i].body[k])) {
            return false;
        }
    }
    return true;
}

static void forget(scene *s, uint32_t i) {
    core_columns_remove(&s->ragdoll.set, core_columns_handle(&s->ragdoll.set, i), NULL, NULL);
}

// The bodies of an entity that is gone go with it.
static void drop(scene *s, uint32_t i) {
    for (uint32_t k = 0; k < s->ragdoll.parts[i].count; k++) {
        if (s->phys && phys_body_alive(s->phys, s->ragdoll.parts[i].body[k])) {
            phys_body_destroy(s->phys, s->ragdoll.parts[i].body[k]);
        }
    }
    forget(s, i);
}

static void step_one(scene *s, uint32_t i, uint32_t row, anim_instance instance) {
    if (s->ragdoll.phase[i] == STARTING && !let_go(s, i, row, instance)) {
        forget(s, i); // core_fail has said why
        return;
    }
    if (s->ragdoll.phase[i] == FALLING) {
        if (whole(s, i)) {
            follow(s, i, row, instance);
        } else { // somebody destroyed a part
            scene_ragdoll_stop(s, s->ragdoll.entity[i], 0);
        }
        return;
    }
    float length = s->ragdoll.length[i];
    float left = s->ragdoll.weight[i] - (length > 0 ? s->dt / length : 1);
    s->ragdoll.weight[i] = CORE_MAX(left, 0.0f);
    float w = s->ragdoll.weight[i];
    anim_instance_set_external(s->anim, instance, NULL, w * w * (3 - 2 * w));
    if (!(w > 0)) {
        forget(s, i);
    }
}

void scene_ragdoll_step(scene *s) {
    if (!s->falls) {
        return;
    }
    core_stage_begin(s->metrics, CORE_STAGE_ANIM);
    for (uint32_t i = core_columns_count(&s->ragdoll.set); i-- > 0;) {
        uint32_t row = core_columns_row(&s->entity.set, s->ragdoll.entity[i]);
        anim_instance instance = row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.anim[row];
        if (row == CORE_NO_ROW || !anim_instance_alive(s->anim, instance)) {
            drop(s, i);
        } else if (s->entity.wsy[row] > 0) {
            step_one(s, i, row, instance);
        }
    }
    core_stage_end(s->metrics, CORE_STAGE_ANIM);
}

static bool stands(const scene *s, uint32_t i) {
    const scene_ragdoll_parts *parts = &s->ragdoll.parts[i];
    const scene_ragdoll_how *how = &s->ragdoll.how[i];
    bool good = parts->count >= 1 && parts->count <= SCENE_RAGDOLL_BONES &&
                s->ragdoll.phase[i] >= STARTING && s->ragdoll.phase[i] <= RETURNING &&
                good_number(how->mass) && good_number(how->least) && how->layer < 32 &&
                s->ragdoll.weight[i] >= 0 && s->ragdoll.weight[i] <= 1 &&
                good_number(s->ragdoll.length[i]);
    for (uint32_t k = 0; good && k < parts->count; k++) {
        good = parts->bone[k] < ANIM_MAX_BONES && (k == 0 || parts->bone[k] > parts->bone[k - 1]);
    }
    return good && (s->phys || s->ragdoll.phase[i] == STARTING);
}

bool scene_ragdoll_stream(scene *s, core_stream *stream) {
    uint32_t falls = s->falls;
    if (!core_stream_count(stream, "ragdolls", &falls, 1)) {
        return false;
    }
    if (!falls) { // a save from before the first one
        if (s->falls && !stream->writing) {
            core_columns_release(&s->ragdoll.set);
            s->ragdoll = (scene_ragdolls){0};
            s->falls = false;
        }
        return true;
    }
    make_ragdolls(s);
    if (!s->falls || !core_stream_columns(stream, &s->ragdoll.set)) {
        return false;
    }
    for (uint32_t i = 0; i < core_columns_count(&s->ragdoll.set); i++) {
        if (!stands(s, i)) {
            return core_stream_fail(stream, "scene.ragdolls", "row %u: a ragdoll that cannot be",
                                    i);
        }
    }
    return true;
}
