// How far joints are from what they promise, from poses alone, in double precision. Shares no code
// with the solver. Angles count as the way of a point 1 m away.
#include "phys/world.h"

typedef struct v3 {
    double x, y, z;
} v3;

static v3 sub(v3 a, v3 b) { return (v3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static v3 add(v3 a, v3 b) { return (v3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static double dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static double len(v3 a) { return core_sqrt(dot(a, a)); }
static double mag(double x) { return x < 0 ? -x : x; }
static v3 cross(v3 a, v3 b) {
    return (v3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static v3 turn(core_quat q, v3 v) {
    double n =
        core_sqrt((double)q.x * q.x + (double)q.y * q.y + (double)q.z * q.z + (double)q.w * q.w);
    v3 u = {q.x / n, q.y / n, q.z / n}, c = cross(u, v), cc = cross(u, c);
    double w = 2.0 * q.w / n;
    return (v3){v.x + w * c.x + 2 * cc.x, v.y + w * c.y + 2 * cc.y, v.z + w * c.z + 2 * cc.z};
}

typedef struct side {
    v3 anchor, axis[3];
} side;

static side make_side(const phys_world *w, uint32_t slot, core_vec3 local, core_quat frame) {
    uint32_t i = phys_joint_body(&w->bodies.set, slot);
    const phys_bodies *b = &w->bodies;
    core_quat q = i == CORE_NO_ROW ? core_quat_identity() : phys_body_quat(b, i);
    v3 at = turn(q, (v3){local.x, local.y, local.z});
    side s = {.anchor = at};
    if (i != CORE_NO_ROW) {
        s.anchor = add(at, (v3){b->cx[i], b->cy[i], b->cz[i]});
    }
    s.axis[0] = turn(q, turn(frame, (v3){1, 0, 0}));
    s.axis[1] = turn(q, turn(frame, (v3){0, 1, 0}));
    s.axis[2] = turn(q, turn(frame, (v3){0, 0, 1}));
    return s;
}

static double beyond(double x, double lower, double upper) {
    return x < lower ? lower - x : x > upper ? x - upper : 0;
}

// Sine of the angle by which frames differ, at most.
static double twist(const side *a, const side *b) {
    double worst = 0;
    for (int i = 0; i < 3; i++) {
        worst = CORE_MAX(worst, len(cross(a->axis[i], b->axis[i])));
    }
    return worst;
}

static double distance_error(const phys_joints *j, uint32_t i, double length) {
    if (j->flags[i] & PHYS_JOINT_LIMITED) {
        return beyond(length, j->lower[i], j->upper[i]);
    }
    bool rod = j->hertz[i] == 0 && j->damping[i] == 0 && !(j->flags[i] & PHYS_JOINT_DRIVEN);
    return rod ? mag(length - j->rest[i]) : 0;
}

static double pulley_error(const phys_joints *j, uint32_t i, const side *a, const side *b) {
    core_vec3 ga = j->ground_a[i], gb = j->ground_b[i];
    return mag(len(sub(a->anchor, (v3){ga.x, ga.y, ga.z})) +
               j->ratio[i] * len(sub(b->anchor, (v3){gb.x, gb.y, gb.z})) - j->rest[i]);
}

static double slide_error(const phys_joints *j, uint32_t i, const side *a, const side *b, v3 gap) {
    double x = dot(gap, a->axis[0]);
    v3 aside = sub(gap, (v3){a->axis[0].x * x, a->axis[0].y * x, a->axis[0].z * x});
    double over = j->flags[i] & PHYS_JOINT_LIMITED ? beyond(x, j->lower[i], j->upper[i]) : 0;
    return CORE_MAX(CORE_MAX(len(aside), twist(a, b)), over);
}

static double hinge_error(const phys_joints *j, uint32_t i, const side *a, const side *b) {
    double lean = len(cross(a->axis[0], b->axis[0])), over = 0;
    if (j->flags[i] & PHYS_JOINT_LIMITED) {
        float s = (float)dot(b->axis[1], a->axis[2]), c = (float)dot(b->axis[1], a->axis[1]);
        over = beyond((double)core_atan2f(s, c), j->lower[i], j->upper[i]);
    }
    return CORE_MAX(lean, over);
}

static double joint_error(const phys_world *w, uint32_t i) {
    const phys_joints *j = &w->joints;
    side a = make_side(w, j->a[i], j->la[i], j->qa[i]);
    side b = make_side(w, j->b[i], j->lb[i], j->qb[i]);
    v3 gap = sub(b.anchor, a.anchor);
    switch (j->type[i]) {
    case PHYS_JOINT_FIXED:
        return CORE_MAX(len(gap), twist(&a, &b));
    case PHYS_JOINT_DISTANCE:
        return distance_error(j, i, len(gap));
    case PHYS_JOINT_REVOLUTE:
        return CORE_MAX(len(gap), hinge_error(j, i, &a, &b));
    case PHYS_JOINT_PRISMATIC:
        return slide_error(j, i, &a, &b, gap);
    case PHYS_JOINT_UNIVERSAL:
        return CORE_MAX(len(gap), mag(dot(a.axis[0], b.axis[0])));
    case PHYS_JOINT_PIVOT:
        return mag(j->phase[i]);
    case PHYS_JOINT_PULLEY:
        return pulley_error(j, i, &a, &b);
    default:
        return len(gap);
    }
}

double phys_joints_error(const phys_world *w) {
    double worst = 0;
    for (uint32_t i = 0; i < core_columns_count(&w->joints.set); i++) {
        double e = joint_error(w, i);
        worst = CORE_MAX(worst, e);
    }
    return worst;
}
