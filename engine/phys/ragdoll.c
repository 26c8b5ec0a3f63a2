// Ragdolls: bodies and joints from a description of bones, and that from a skeleton.
#include "phys/world.h"

enum { RAGDOLL_COOKIE = 0x70726731, RAGDOLL_BONES = 256 };
#define LENGTH_MIN 1e-3f // m

phys_ragdoll_desc phys_ragdoll_desc_default(void) {
    return (phys_ragdoll_desc){.friction = 0.6f,
                               .linear_damping = 0.05f,
                               .angular_damping = 1.0f,
                               .cookie = RAGDOLL_COOKIE};
}

static bool check_bone(const phys_ragdoll_bone *b, uint32_t i) {
    float length = core_v3_length(core_v3_sub(b->tail, b->head));
    if (b->parent < -1 || b->parent >= (int32_t)i) {
        return core_fail("phys ragdoll: bone %u has parent %d, expected -1 or an earlier bone", i,
                         (int)b->parent);
    }
    if (!(length >= LENGTH_MIN && length <= PHYS_FAR) || !phys_finite3(b->head)) {
        return core_fail("phys ragdoll: bone %u is %g m long, expected finite places at least 1 mm "
                         "apart",
                         i, (double)length);
    }
    if (!(b->radius >= 0.0f && b->radius <= 1e3f && b->mass >= 0.0f && b->mass <= 1e9f)) {
        return core_fail("phys ragdoll: bone %u has radius %g m and mass %g kg, expected 0 or more",
                         i, (double)b->radius, (double)b->mass);
    }
    if (!(b->cone >= 0.0f && b->cone < CORE_PI_F && b->twist >= 0.0f && b->twist < CORE_PI_F)) {
        return core_fail("phys ragdoll: bone %u has cone %g and twist %g, expected 0..pi", i,
                         (double)b->cone, (double)b->twist);
    }
    return true;
}

static bool check_desc(const phys_ragdoll_desc *d) {
    if (d->cookie != RAGDOLL_COOKIE) {
        return core_fail("phys ragdoll: description was not made by phys_ragdoll_desc_default");
    }
    if (d->bones == NULL || d->bone_count == 0 || d->bone_count > RAGDOLL_BONES) {
        return core_fail("phys ragdoll: %u bones, expected 1..%d", d->bone_count, RAGDOLL_BONES);
    }
    for (uint32_t i = 0; i < d->bone_count; i++) {
        if (!check_bone(&d->bones[i], i)) {
            return false;
        }
    }
    return true;
}

// The rotation that takes +y to a unit direction, the short way.
static core_quat from_y(core_vec3 d) {
    core_quat q = {d.z, 0.0f, -d.x, 1.0f + d.y};
    return d.y < -0.9999f ? (core_quat){1, 0, 0, 0} : core_quat_normalize(q);
}

static phys_body make_body(phys_world *w, const phys_ragdoll_desc *d, uint32_t i) {
    const phys_ragdoll_bone *bone = &d->bones[i];
    core_quat rotation = core_quat_normalize(bone->rotation);
    core_vec3 way = phys_unrotate(rotation, core_v3_sub(bone->tail, bone->head));
    float length = core_v3_length(way);
    phys_shape_desc s = phys_shape_desc_default(PHYS_CAPSULE);
    s.radius = bone->radius > 0.0f ? bone->radius : 0.15f * length;
    s.half_height = CORE_MAX(0.5f * length - s.radius, LENGTH_MIN);
    s.position = core_v3_scale(way, 0.5f);
    s.rotation = from_y(core_v3_scale(way, 1.0f / length));
    s.friction = d->friction;
    if (bone->mass > 0.0f) {
        s.density = bone->mass / phys_geom_volume_capsule(s.half_height, s.radius);
    }
    phys_body_desc b = phys_body_desc_default();
    b.position = bone->head;
    b.rotation = rotation;
    b.linear_damping = d->linear_damping;
    b.angular_damping = d->angular_damping;
    b.layer = d->layer;
    b.user = d->user;
    return phys_body_create(w, &b, &s, 1);
}

static phys_joint make_joint(phys_world *w, const phys_ragdoll_bone *bone, phys_body parent,
                             phys_body body) {
    phys_joint_desc j =
        phys_joint_desc_default(bone->hinge ? PHYS_JOINT_REVOLUTE : PHYS_JOINT_BALL);
    j.a = parent;
    j.b = body;
    j.anchor = bone->head;
    j.limit = true;
    if (bone->hinge) {
        j.axis = bone->axis;
        j.lower = bone->lower;
        j.upper = bone->upper;
    } else {
        float twist = bone->twist > 0.0f ? bone->twist : 0.5f;
        j.axis = core_v3_sub(bone->tail, bone->head);
        j.cone = bone->cone > 0.0f ? bone->cone : 0.8f;
        j.lower = -twist;
        j.upper = twist;
    }
    return phys_joint_create(w, &j);
}

static bool make_parts(phys_world *w, const phys_ragdoll_desc *d, phys_body *bodies,
                       phys_joint *joints) {
    for (uint32_t i = 0; i < d->bone_count; i++) {
        bodies[i] = make_body(w, d, i);
        if (core_handle_is_null(bodies[i])) {
            return false;
        }
        int32_t parent = d->bones[i].parent;
        if (parent >= 0) {
            joints[i] = make_joint(w, &d->bones[i], bodies[parent], bodies[i]);
            if (core_handle_is_null(joints[i])) {
                return false;
            }
        }
    }
    return true;
}

// Joints know the rest pose by now; the bodies go to the pose in which they start.
static bool take_pose(phys_world *w, phys_body body, const phys_ragdoll_pose *p) {
    return phys_body_set_position(w, body, p->position) &&
           phys_body_set_rotation(w, body, p->rotation) &&
           phys_body_set_velocity(w, body, p->velocity) &&
           phys_body_set_angular_velocity(w, body, p->angular_velocity);
}

bool phys_ragdoll_create(phys_world *w, const phys_ragdoll_desc *d, phys_body *bodies,
                         phys_joint *joints) {
    if (!check_desc(d)) {
        return false;
    }
    for (uint32_t i = 0; i < d->bone_count; i++) {
        bodies[i] = CORE_NULL_HANDLE;
        joints[i] = CORE_NULL_HANDLE;
    }
    bool good = make_parts(w, d, bodies, joints);
    for (uint32_t i = 0; good && d->pose != NULL && i < d->bone_count; i++) {
        good = take_pose(w, bodies[i], &d->pose[i]);
    }
    for (uint32_t i = 0; !good && i < d->bone_count; i++) {
        if (!core_handle_is_null(bodies[i])) {
            phys_body_destroy(w, bodies[i]);
            bodies[i] = joints[i] = CORE_NULL_HANDLE;
        }
    }
    return good;
}

// ---- from a skeleton ----
typedef struct placed {
    core_vec3 head, tail;
    core_quat rotation;
    int32_t kept; // number among those written; -1: left to the parent
} placed;

static placed place_bone(const core_skeleton_data *s, const placed *all, uint32_t i,
                         core_vec3 position, core_quat rotation, float scale) {
    core_vec3 move = core_v3_scale(s->translation[i], scale);
    core_quat turn = core_quat_normalize(s->rotation[i]);
    int32_t parent = s->parent[i];
    core_vec3 base = parent < 0 ? position : all[parent].head;
    core_quat frame = parent < 0 ? rotation : all[parent].rotation;
    placed p = {.kept = -1};
    p.head = core_v3_add(base, phys_rotate(frame, move));
    p.rotation = phys_quat_unit(phys_quat_mul(frame, turn));
    return p;
}

static void find_tail(const core_skeleton_data *s, placed *all, uint32_t i) {
    core_vec3 sum = {0, 0, 0};
    uint32_t children = 0;
    for (uint32_t k = i + 1; k < s->bone_count; k++) {
        if (s->parent[k] == (int32_t)i) {
            sum = core_v3_add(sum, all[k].head);
            children++;
        }
    }
    if (children != 0) {
        all[i].tail = core_v3_scale(sum, 1.0f / (float)children);
    } else if (s->parent[i] >= 0) {
        const placed *up = &all[s->parent[i]];
        all[i].tail = core_v3_mad(all[i].head, core_v3_sub(up->tail, up->head), 0.5f);
    } else {
        all[i].tail = all[i].head;
    }
}

// A bone left out hands its children to the one above.
static int32_t kept_above(const core_skeleton_data *s, const placed *all, uint32_t i) {
    int32_t parent = s->parent[i];
    while (parent >= 0 && all[parent].kept < 0) {
        parent = s->parent[parent];
    }
    return parent < 0 ? -1 : all[parent].kept;
}

uint32_t phys_ragdoll_bones(const core_skeleton_data *s, core_vec3 position, core_quat rotation,
                            float scale, float mass, float least, phys_ragdoll_bone *out,
                            uint32_t capacity) {
    if (s->bone_count == 0 || s->bone_count > RAGDOLL_BONES) {
        core_fail("phys ragdoll: a skeleton of %u bones, expected 1..%d", s->bone_count,
                  RAGDOLL_BONES);
        return 0;
    }
    placed all[RAGDOLL_BONES];
    uint32_t count = 0;
    float volume = 0.0f;
    for (uint32_t i = 0; i < s->bone_count; i++) {
        all[i] = place_bone(s, all, i, position, core_quat_normalize(rotation), scale);
    }
    for (uint32_t i = 0; i < s->bone_count; i++) {
        find_tail(s, all, i);
        core_vec3 way = core_v3_sub(all[i].tail, all[i].head);
        float length = core_v3_length(way), radius = 0.15f * length;
        if (length < CORE_MAX(least, LENGTH_MIN)) {
            continue;
        }
        all[i].kept = (int32_t)count;
        float size = phys_geom_volume_capsule(0.5f * length - radius, radius);
        if (count < capacity) {
            out[count] = (phys_ragdoll_bone){.parent = kept_above(s, all, i),
                                             .bone = i,
                                             .head = all[i].head,
                                             .tail = all[i].tail,
                                             .rotation = all[i].rotation,
                                             .radius = radius,
                                             .mass = size};
            volume += size;
        }
        count++;
    }
    for (uint32_t i = 0; i < CORE_MIN(count, capacity) && volume > 0.0f; i++) {
        out[i].mass *= mass / volume;
    }
    return count;
}
