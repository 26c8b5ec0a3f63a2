// Goals applied to the finished local pose: two-bone limbs that reach a point, bones that look at
// one. Scales along the chain are taken as uniform.
#include "anim/anim_internal.h"

#include <math.h>

anim_goal_desc anim_goal_desc_default(anim_goal_kind kind) {
    return (anim_goal_desc){.kind = kind, .axis = {0, 0, 1}, .weight = 1, .cookie = ANIM_COOKIE};
}

static bool finite3(core_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static bool check_goal(const anim_skeleton_res *s, uint32_t goal, const anim_goal_desc *d) {
    if (goal >= ANIM_MAX_GOALS || d->cookie != ANIM_COOKIE || d->bone >= s->bones) {
        return core_fail("animation goal %u: expected 0..%u, a description made by "
                         "anim_goal_desc_default() and a bone below %u",
                         goal, ANIM_MAX_GOALS - 1, s->bones);
    }
    bool limb = s->parent[d->bone] >= 0 && s->parent[s->parent[d->bone]] >= 0;
    bool bends = d->kind == ANIM_GOAL_REACH || d->kind == ANIM_GOAL_SHIFT;
    if (bends && !limb) {
        return core_fail("animation goal %u: bone %s needs two bones above it", goal,
                         s->name[d->bone]);
    }
    if (!finite3(d->target) || !finite3(d->pole) || !finite3(d->axis) || !isfinite(d->limit) ||
        !(d->weight >= 0 && d->weight <= 1) || d->kind > ANIM_GOAL_MOVE) {
        return core_fail("animation goal %u: numbers must be finite and the weight (%g) in 0..1",
                         goal, d->weight);
    }
    return true;
}

bool anim_instance_set_goal(anim_world *w, anim_instance h, uint32_t goal,
                            const anim_goal_desc *d) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW ||
        !check_goal(anim_get_skeleton(w, w->instances.skeleton[row]), goal, d)) {
        return false;
    }
    w->instances.goals[row].goal[goal] = (anim_goal){(uint32_t)d->kind,
                                                     d->bone,
                                                     d->target,
                                                     d->pole,
                                                     core_v3_normalize(d->axis, core_v3(0, 0, 1)),
                                                     d->limit,
                                                     d->weight,
                                                     d->keep_rotation};
    uint32_t active = 0;
    for (uint32_t i = 0; i < ANIM_MAX_GOALS; i++) {
        active += w->instances.goals[row].goal[i].weight > 0;
    }
    w->instances.goal_count[row] = active;
    return true;
}

typedef struct joint { // in model space
    core_vec3 position;
    core_quat rotation;
    core_vec3 scale;
} joint;

static joint local_of(const anim_skeleton_res *s, const float *pose, uint32_t b) {
    const uint32_t n = s->stride;
    const float *v = pose + b;
    return (joint){{v[ANIM_TX * n], v[ANIM_TY * n], v[ANIM_TZ * n]},
                   {v[ANIM_RX * n], v[ANIM_RY * n], v[ANIM_RZ * n], v[ANIM_RW * n]},
                   {v[ANIM_SX * n], v[ANIM_SY * n], v[ANIM_SZ * n]}};
}

static joint below(joint a, joint b) {
    core_vec3 scaled = {b.position.x * a.scale.x, b.position.y * a.scale.y,
                        b.position.z * a.scale.z};
    return (joint){core_v3_add(a.position, core_quat_rotate(a.rotation, scaled)),
                   core_quat_mul(a.rotation, b.rotation),
                   {a.scale.x * b.scale.x, a.scale.y * b.scale.y, a.scale.z * b.scale.z}};
}

static joint global_of(const anim_skeleton_res *s, const float *pose, int32_t b) {
    joint out = local_of(s, pose, (uint32_t)b);
    for (b = s->parent[b]; b >= 0; b = s->parent[b]) {
        out = below(local_of(s, pose, (uint32_t)b), out);
    }
    return out;
}

static void set_rotation(const anim_skeleton_res *s, float *pose, uint32_t b, core_quat q) {
    const uint32_t n = s->stride;
    q = core_quat_normalize(q);
    pose[ANIM_RX * n + b] = q.x;
    pose[ANIM_RY * n + b] = q.y;
    pose[ANIM_RZ * n + b] = q.z;
    pose[ANIM_RW * n + b] = q.w;
}

// Turns a bone by a rotation given in model space.
static void turn(const anim_skeleton_res *s, float *pose, uint32_t b, core_quat q) {
    core_quat parent =
        s->parent[b] < 0 ? core_quat_identity() : global_of(s, pose, s->parent[b]).rotation;
    core_quat inside = core_quat_mul(core_quat_conjugate(parent), core_quat_mul(q, parent));
    set_rotation(s, pose, b, core_quat_mul(inside, local_of(s, pose, b).rotation));
}

static core_vec3 any_across(core_vec3 v) {
    core_vec3 other =
        core_absf(v.x) < 0.7f * core_v3_length(v) ? core_v3(1, 0, 0) : core_v3(0, 1, 0);
    return core_v3_normalize(core_v3_cross(v, other), core_v3(0, 0, 1));
}

// Shortest rotation of one direction onto another; half a turn goes round any axis across.
static core_quat arc(core_vec3 from, core_vec3 to) {
    core_vec3 a = core_v3_normalize(from, core_v3(0, 0, 1));
    core_vec3 b = core_v3_normalize(to, a), axis = core_v3_cross(a, b);
    float d = core_v3_dot(a, b);
    if (d < -0.999999f) {
        return core_quat_axis_angle(any_across(a), CORE_PI_F);
    }
    return core_quat_normalize((core_quat){axis.x, axis.y, axis.z, 1 + d});
}

static float angle_between(core_vec3 a, core_vec3 b) {
    return core_atan2f(core_v3_length(core_v3_cross(a, b)), core_v3_dot(a, b));
}

// Interior angle of a triangle opposite `side` (law of cosines).
static float opposite(float side, float p, float q) {
    float c = (p * p + q * q - side * side) / (2 * p * q);
    return core_acosf(CORE_CLAMP(c, -1.0f, 1.0f));
}

// Bends the middle joint until the tip is as far from the limb's root as the target is.
static void bend(const anim_skeleton_res *s, float *pose, const uint32_t bone[3],
                 core_vec3 target) {
    core_vec3 a = global_of(s, pose, (int32_t)bone[0]).position;
    core_vec3 b = global_of(s, pose, (int32_t)bone[1]).position;
    core_vec3 c = global_of(s, pose, (int32_t)bone[2]).position;
    core_vec3 upper = core_v3_sub(a, b), lower = core_v3_sub(c, b);
    float p = core_v3_length(upper), q = core_v3_length(lower);
    if (!(p > 0 && q > 0)) {
        return;
    }
    float far = core_v3_length(core_v3_sub(target, a));
    float reach = CORE_CLAMP(far, core_absf(p - q) + 1e-5f * p, (p + q) * 0.99999f);
    core_vec3 across = core_v3_cross(upper, lower);
    core_vec3 axis = core_v3_length(across) > 1e-6f * p * q
                         ? core_v3_normalize(across, core_v3(1, 0, 0))
                         : any_across(upper);
    float change = opposite(reach, p, q) - angle_between(upper, lower);
    turn(s, pose, bone[1], core_quat_axis_angle(axis, change));
}

static void reach(const anim_skeleton_res *s, const anim_goal *g, float *pose) {
    uint32_t tip = g->bone, middle = (uint32_t)s->parent[tip];
    const uint32_t bone[3] = {(uint32_t)s->parent[middle], middle, tip};
    joint before = global_of(s, pose, (int32_t)tip);
    core_vec3 target =
        core_v3_mad(core_v3_scale(before.position, 1 - g->weight), g->target, g->weight);
    bend(s, pose, bone, target);
    core_vec3 root = global_of(s, pose, (int32_t)bone[0]).position;
    core_vec3 now = global_of(s, pose, (int32_t)tip).position;
    core_vec3 line = core_v3_sub(target, root);
    turn(s, pose, bone[0], arc(core_v3_sub(now, root), line));
    if (g->pole.x != 0 || g->pole.y != 0 || g->pole.z != 0) {
        core_vec3 unit = core_v3_normalize(line, core_v3(0, 1, 0));
        core_vec3 knee = core_v3_sub(global_of(s, pose, (int32_t)middle).position, root);
        core_vec3 from = core_v3_mad(knee, unit, -core_v3_dot(knee, unit));
        core_vec3 to = core_v3_mad(g->pole, unit, -core_v3_dot(g->pole, unit));
        float sign = core_v3_dot(core_v3_cross(from, to), unit) < 0 ? -1.0f : 1.0f;
        turn(s, pose, bone[0],
             core_quat_axis_angle(unit, sign * g->weight * angle_between(from, to)));
    }
    if (g->keep_rotation) {
        core_quat parent = global_of(s, pose, (int32_t)middle).rotation;
        set_rotation(s, pose, tip, core_quat_mul(core_quat_conjugate(parent), before.rotation));
    }
}

static void look(const anim_skeleton_res *s, const anim_goal *g, float *pose) {
    joint at = global_of(s, pose, (int32_t)g->bone);
    core_vec3 forward = core_quat_rotate(at.rotation, g->axis);
    core_vec3 wanted = core_v3_sub(g->target, at.position);
    float angle = angle_between(forward, wanted), allowed = g->limit > 0 ? g->limit : CORE_PI_F;
    float share = g->weight * (angle > allowed ? allowed / angle : 1);
    core_quat full = arc(forward, wanted);
    turn(s, pose, g->bone, core_quat_slerp(core_quat_identity(), full, share));
}

static void move(const anim_skeleton_res *s, const anim_goal *g, float *pose) {
    const uint32_t n = s->stride;
    int32_t parent = s->parent[g->bone];
    joint frame = {{0, 0, 0}, core_quat_identity(), {1, 1, 1}};
    frame = parent < 0 ? frame : global_of(s, pose, parent);
    core_vec3 by = core_quat_rotate(core_quat_conjugate(frame.rotation), g->target);
    pose[ANIM_TX * n + g->bone] += g->weight * by.x / frame.scale.x;
    pose[ANIM_TY * n + g->bone] += g->weight * by.y / frame.scale.y;
    pose[ANIM_TZ * n + g->bone] += g->weight * by.z / frame.scale.z;
}

void anim_goals_apply(const anim_skeleton_res *s, const anim_goals *goals, float *pose) {
    core_vec3 tip[ANIM_MAX_GOALS]; // without goals
    for (uint32_t i = 0; i < ANIM_MAX_GOALS; i++) {
        const anim_goal *g = &goals->goal[i];
        if (g->weight > 0 && g->kind == ANIM_GOAL_SHIFT) {
            tip[i] = global_of(s, pose, (int32_t)g->bone).position;
        }
    }
    for (uint32_t i = 0; i < ANIM_MAX_GOALS; i++) {
        const anim_goal *g = &goals->goal[i];
        if (g->weight > 0 && g->kind == ANIM_GOAL_MOVE) {
            move(s, g, pose);
        }
    }
    for (uint32_t i = 0; i < ANIM_MAX_GOALS; i++) {
        const anim_goal *g = &goals->goal[i];
        if (!(g->weight > 0)) {
            continue;
        }
        if (g->kind == ANIM_GOAL_REACH) {
            reach(s, g, pose);
        } else if (g->kind == ANIM_GOAL_SHIFT) {
            anim_goal there = *g;
            there.target = core_v3_add(tip[i], g->target);
            reach(s, &there, pose);
        } else if (g->kind == ANIM_GOAL_LOOK) {
            look(s, g, pose);
        }
    }
}
