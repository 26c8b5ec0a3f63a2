// Joints: creation, settings and reports.
#include "phys/world.h"

#include <string.h>

CORE_COLUMNS_DEFINE(phys_joints, PHYS_JOINT_COLUMNS)

// What the types offer.
enum { HAS_LIMIT = 1u, HAS_SPRING = 2u, HAS_TWO_ANCHORS = 4u, HAS_MOTOR = 8u };
#define HAS_DRIVE (HAS_SPRING | HAS_MOTOR)
static const struct {
    const char *name;
    unsigned has;
} kinds[] = {
    [PHYS_JOINT_FIXED] = {"fixed", 0},
    [PHYS_JOINT_BALL] = {"ball", HAS_LIMIT},
    [PHYS_JOINT_DISTANCE] = {"distance", HAS_LIMIT | HAS_DRIVE | HAS_TWO_ANCHORS},
    [PHYS_JOINT_REVOLUTE] = {"revolute", HAS_LIMIT | HAS_DRIVE},
    [PHYS_JOINT_PRISMATIC] = {"prismatic", HAS_LIMIT | HAS_DRIVE},
    [PHYS_JOINT_UNIVERSAL] = {"universal", HAS_LIMIT | HAS_MOTOR},
    [PHYS_JOINT_PIVOT] = {"pivot", HAS_MOTOR},
    [PHYS_JOINT_PULLEY] = {"pulley", HAS_LIMIT | HAS_MOTOR | HAS_TWO_ANCHORS},
};

phys_joint_desc phys_joint_desc_default(phys_joint_type type) {
    return (phys_joint_desc){.type = type,
                             .axis = {0.0f, 1.0f, 0.0f},
                             .axis_b = type == PHYS_JOINT_UNIVERSAL ? (core_vec3){1.0f, 0.0f, 0.0f}
                                                                    : (core_vec3){0},
                             .damping_ratio = 1.0f,
                             .ratio = 1.0f,
                             .cookie = PHYS_JOINT_COOKIE};
}

static bool check_number(const char *type, const char *what, float value, float lo, float hi) {
    return (value >= lo && value <= hi) ||
           core_fail("phys joint: %s of a %s joint is %g, expected %g..%g", what, type,
                     (double)value, (double)lo, (double)hi);
}

static bool check_vector(const char *type, const char *what, core_vec3 v) {
    float far = CORE_MAX(core_absf(v.x), CORE_MAX(core_absf(v.y), core_absf(v.z)));
    return (phys_finite3(v) && far <= PHYS_FAR) ||
           core_fail("phys joint: %s of a %s joint is (%g, %g, %g), expected finite numbers up to "
                     "%g",
                     what, type, (double)v.x, (double)v.y, (double)v.z, (double)PHYS_FAR);
}

static bool check_axis(const char *type, const char *what, core_vec3 v) {
    return check_vector(type, what, v) &&
           (core_v3_dot(v, v) > 1e-12f ||
            core_fail("phys joint: %s of a %s joint has no direction, expected a length above 0",
                      what, type));
}

static bool check_limits(phys_joint_type type, float lower, float upper) {
    const char *name = kinds[type].name;
    if (!(kinds[type].has & HAS_LIMIT)) {
        return core_fail("phys joint: a %s joint has no limits, leave them off", name);
    }
    bool angle =
        type == PHYS_JOINT_REVOLUTE || type == PHYS_JOINT_BALL || type == PHYS_JOINT_UNIVERSAL;
    bool length = type == PHYS_JOINT_DISTANCE || type == PHYS_JOINT_PULLEY;
    float lo = angle ? -CORE_PI_F : length ? 0.0f : -PHYS_FAR;
    float hi = angle ? CORE_PI_F : PHYS_FAR;
    return check_number(name, "lower", lower, lo, hi) &&
           check_number(name, "upper", upper, lo, hi) &&
           (lower <= upper || core_fail("phys joint: limits of a %s joint are %g..%g, expected "
                                        "lower <= upper",
                                        name, (double)lower, (double)upper));
}

static bool check_drive(phys_joint_type type, const char *what) {
    return (kinds[type].has & HAS_SPRING) ||
           core_fail("phys joint: a %s joint has no %s, expected distance, revolute or prismatic",
                     kinds[type].name, what);
}

static bool check_spring(phys_joint_type type, float hertz, float damping_ratio, float rest) {
    const char *name = kinds[type].name;
    return (hertz == 0.0f || check_drive(type, "spring")) &&
           check_number(name, "hertz", hertz, 0.0f, 1e4f) &&
           check_number(name, "damping_ratio", damping_ratio, 0.0f, 1e4f) &&
           check_number(name, "rest", rest, -PHYS_FAR, PHYS_FAR);
}

static bool check_motor(phys_joint_type type, float speed, float max) {
    return ((kinds[type].has & HAS_MOTOR) ||
            core_fail("phys joint: a %s joint has no motor, expected another than fixed and ball",
                      kinds[type].name)) &&
           check_number(kinds[type].name, "motor_speed", speed, -PHYS_FAR, PHYS_FAR) &&
           check_number(kinds[type].name, "motor_max", max, 0.0f, 1e30f);
}

static bool check_bodies(const phys_world *w, const phys_joint_desc *d) {
    bool dynamic = false;
    const phys_body body[2] = {d->a, d->b};
    for (int i = 0; i < 2; i++) {
        uint32_t row = phys_body_row(w, body[i]);
        if (row == CORE_NO_ROW && !core_handle_is_null(body[i])) {
            return core_fail("phys joint: body %c is stale (%u:%u), expected a living body or null "
                             "for the world",
                             i ? 'b' : 'a', body[i].index, body[i].generation);
        }
        dynamic |= row != CORE_NO_ROW && w->bodies.type[row] == PHYS_DYNAMIC;
    }
    if (d->a.index == d->b.index) {
        return core_fail("phys joint: a and b are the same body, expected two");
    }
    return dynamic || core_fail("phys joint: neither body is dynamic, expected at least one");
}

static bool check_geometry(const phys_joint_desc *d) {
    const char *name = kinds[d->type].name;
    bool two = (kinds[d->type].has & HAS_TWO_ANCHORS) != 0;
    bool second = d->type == PHYS_JOINT_UNIVERSAL;
    if (!check_axis(name, "axis", d->axis) || !check_vector(name, "axis_b", d->axis_b) ||
        (second && !check_axis(name, "axis_b", d->axis_b))) {
        return false;
    }
    if (second) {
        float c = core_v3_dot(phys_unit(d->axis, d->axis), phys_unit(d->axis_b, d->axis_b));
        if (core_absf(c) > 1e-3f) {
            return core_fail("phys joint: axis and axis_b of a universal joint meet at a cosine of "
                             "%g, expected a right angle",
                             (double)c);
        }
    }
    if (!two) {
        return check_vector(name, "anchor", d->anchor);
    }
    return check_vector(name, "anchor_a", d->anchor_a) &&
           check_vector(name, "anchor_b", d->anchor_b) &&
           check_vector(name, "ground_a", d->ground_a) &&
           check_vector(name, "ground_b", d->ground_b);
}

// Limits and motors of a pulley are those of a's side, a pivot's motor turns b.
static bool check_driven(const phys_world *w, const phys_joint_desc *d) {
    bool pulley = d->type == PHYS_JOINT_PULLEY;
    if (!(d->limit || d->motor) || !(pulley || d->type == PHYS_JOINT_PIVOT)) {
        return true;
    }
    uint32_t row = phys_body_row(w, pulley ? d->a : d->b);
    return (row != CORE_NO_ROW && w->bodies.type[row] == PHYS_DYNAMIC) ||
           core_fail("phys joint: body %c of a %s joint with limits or a motor is not dynamic",
                     pulley ? 'a' : 'b', kinds[d->type].name);
}

static bool check_desc(const phys_world *w, const phys_joint_desc *d) {
    if (d->cookie != PHYS_JOINT_COOKIE) {
        return core_fail("phys joint: description was not made by phys_joint_desc_default");
    }
    if ((unsigned)d->type >= CORE_COUNT_OF(kinds)) {
        return core_fail("phys joint: type %d is unknown, expected 0..%d", (int)d->type,
                         (int)CORE_COUNT_OF(kinds) - 1);
    }
    if (w->solver != &phys_solver_soft) {
        return core_fail("phys joint: solver '%s' has no joints, set solver to soft",
                         w->solver->name);
    }
    const char *name = kinds[d->type].name;
    bool pulley = d->type == PHYS_JOINT_PULLEY;
    return check_bodies(w, d) && check_geometry(d) &&
           (!d->limit || check_limits(d->type, d->lower, d->upper)) &&
           (!d->motor || check_motor(d->type, d->motor_speed, d->motor_max)) &&
           check_spring(d->type, d->hertz, d->damping_ratio, d->rest) &&
           (d->damping == 0.0f || check_drive(d->type, "damping")) &&
           check_number(name, "damping", d->damping, 0.0f, 1e30f) && check_driven(w, d) &&
           (d->cone == 0.0f || d->type == PHYS_JOINT_BALL || d->type == PHYS_JOINT_UNIVERSAL ||
            core_fail("phys joint: a %s joint has no cone, expected ball or universal", name)) &&
           check_number(name, "cone", d->cone, 0.0f, CORE_PI_F) &&
           check_number(name, "ratio", d->ratio, pulley ? 1e-6f : -1e6f, 1e6f) &&
           (d->ratio != 0.0f || core_fail("phys joint: ratio of a %s joint is 0", name)) &&
           check_number(name, "break_force", d->break_force, 0.0f, 1e30f) &&
           check_number(name, "break_torque", d->break_torque, 0.0f, 1e30f);
}

// Frame whose x is the axis and whose y is as near as may be to `side`.
static core_quat frame_of(core_vec3 axis, core_vec3 side) {
    core_vec3 x = phys_unit(axis, core_v3(1, 0, 0)), y, z;
    y = core_v3_mad(side, x, -core_v3_dot(side, x));
    if (core_v3_dot(y, y) < 1e-8f) {
        phys_basis(x, &y, &z);
    }
    y = phys_unit(y, core_v3(0, 1, 0));
    z = core_v3_cross(x, y);
    float m[9] = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
    // Shepperd, J. Guidance and Control 1, 1978: divides by the largest component.
    float t = m[0] + m[4] + m[8];
    core_quat q;
    if (t > 0.0f) {
        q = (core_quat){m[7] - m[5], m[2] - m[6], m[3] - m[1], 1.0f + t};
    } else if (m[0] >= m[4] && m[0] >= m[8]) {
        q = (core_quat){1.0f + m[0] - m[4] - m[8], m[1] + m[3], m[2] + m[6], m[7] - m[5]};
    } else if (m[4] >= m[8]) {
        q = (core_quat){m[1] + m[3], 1.0f + m[4] - m[0] - m[8], m[5] + m[7], m[2] - m[6]};
    } else {
        q = (core_quat){m[2] + m[6], m[5] + m[7], 1.0f + m[8] - m[0] - m[4], m[3] - m[1]};
    }
    return phys_quat_unit(q);
}

static void attach(const phys_world *w, phys_body body, core_vec3 anchor, core_quat frame,
                   core_vec3 *local, core_quat *turn) {
    uint32_t i = phys_body_row(w, body);
    if (i == CORE_NO_ROW) {
        *local = anchor;
        *turn = frame;
        return;
    }
    core_quat q = phys_body_quat(&w->bodies, i);
    core_vec3 c = phys_get3(w->bodies.cx, w->bodies.cy, w->bodies.cz, i);
    *local = phys_unrotate(q, core_v3_sub(anchor, c));
    *turn = phys_quat_unit(phys_quat_mul(phys_conj(q), frame));
}

static void attach_both(phys_world *w, uint32_t i, const phys_joint_desc *d) {
    bool two = (kinds[d->type].has & HAS_TWO_ANCHORS) != 0;
    bool own = d->type == PHYS_JOINT_UNIVERSAL ||
               (d->type == PHYS_JOINT_PIVOT && core_v3_dot(d->axis_b, d->axis_b) > 1e-12f);
    core_vec3 side = own ? d->axis_b : core_v3(0, 0, 0);
    core_quat fa = frame_of(d->axis, side), fb = own ? frame_of(d->axis_b, d->axis) : fa;
    core_vec3 pa = two ? d->anchor_a : d->anchor, pb = two ? d->anchor_b : d->anchor;
    attach(w, d->a, pa, fa, &w->joints.la[i], &w->joints.qa[i]);
    attach(w, d->b, pb, fb, &w->joints.lb[i], &w->joints.qb[i]);
    float length = core_v3_length(core_v3_sub(pb, pa));
    w->joints.rest[i] = d->rest;
    if (d->type == PHYS_JOINT_DISTANCE && d->rest == 0.0f) {
        w->joints.rest[i] = length;
    } else if (d->type == PHYS_JOINT_PULLEY) {
        w->joints.rest[i] = core_v3_length(core_v3_sub(pa, d->ground_a)) +
                            d->ratio * core_v3_length(core_v3_sub(pb, d->ground_b));
    }
}

static void wake_both(phys_world *w, uint32_t i) {
    const uint32_t slot[2] = {w->joints.a[i], w->joints.b[i]};
    for (int k = 0; k < 2; k++) {
        uint32_t row = phys_joint_body(&w->bodies.set, slot[k]);
        if (row != CORE_NO_ROW) {
            phys_wake_row(w, row);
        }
    }
}

phys_joint phys_joint_create(phys_world *w, const phys_joint_desc *d) {
    if (!check_desc(w, d)) {
        return CORE_NULL_HANDLE;
    }
    phys_joints *j = &w->joints;
    phys_joint h = core_columns_add(&j->set);
    if (core_handle_is_null(h)) {
        return h;
    }
    uint32_t i = core_columns_count(&j->set) - 1;
    j->a[i] = core_handle_is_null(d->a) ? 0 : d->a.index;
    j->b[i] = core_handle_is_null(d->b) ? 0 : d->b.index;
    j->type[i] = (uint8_t)d->type;
    j->flags[i] =
        (uint8_t)((d->limit ? PHYS_JOINT_LIMITED : 0u) | (d->motor ? PHYS_JOINT_DRIVEN : 0u) |
                  (d->collide_connected ? PHYS_JOINT_COLLIDE : 0u));
    attach_both(w, i, d);
    j->ground_a[i] = d->ground_a;
    j->ground_b[i] = d->ground_b;
    j->lower[i] = d->lower;
    j->upper[i] = d->upper;
    j->cone[i] = d->cone;
    j->motor_speed[i] = d->motor_speed;
    j->motor_max[i] = d->motor_max;
    j->hertz[i] = d->hertz;
    j->damping_ratio[i] = d->damping_ratio;
    j->damping[i] = d->damping;
    j->ratio[i] = d->ratio;
    j->break_force[i] = d->break_force;
    j->break_torque[i] = d->break_torque;
    j->user[i] = d->user;
    w->measured = false;
    w->pairs_stale = w->joint_pairs.stale = true;
    wake_both(w, i);
    return h;
}

static void remove_row(phys_world *w, uint32_t i) {
    wake_both(w, i);
    w->pairs_stale = w->joint_pairs.stale = true;
    core_columns_remove(&w->joints.set, core_columns_handle(&w->joints.set, i), NULL, NULL);
}

static uint32_t live(const phys_world *w, phys_joint joint, const char *what) {
    uint32_t row = core_columns_row(&w->joints.set, joint);
    if (row == CORE_NO_ROW) {
        core_fail("phys joint: %s of a stale or null handle (%u:%u)", what, joint.index,
                  joint.generation);
    }
    return row;
}

bool phys_joint_destroy(phys_world *w, phys_joint joint) {
    uint32_t i = live(w, joint, "destroy");
    if (i == CORE_NO_ROW) {
        return false;
    }
    remove_row(w, i);
    return true;
}

bool phys_joint_alive(const phys_world *w, phys_joint joint) {
    return core_columns_row(&w->joints.set, joint) != CORE_NO_ROW;
}
uint32_t phys_joint_count(const phys_world *w) { return core_columns_count(&w->joints.set); }
uint64_t phys_joint_user(const phys_world *w, phys_joint joint) {
    uint32_t i = live(w, joint, "user");
    return i == CORE_NO_ROW ? 0 : w->joints.user[i];
}

bool phys_joint_force(const phys_world *w, phys_joint joint, core_vec3 *force, core_vec3 *torque) {
    uint32_t i = live(w, joint, "force");
    if (i == CORE_NO_ROW) {
        return false;
    }
    *force = w->joints.force[i];
    *torque = w->joints.torque[i];
    return true;
}

bool phys_joint_set_motor(phys_world *w, phys_joint joint, bool on, float speed, float max) {
    uint32_t i = live(w, joint, "set motor");
    if (i == CORE_NO_ROW || !check_motor((phys_joint_type)w->joints.type[i], speed, max)) {
        return false;
    }
    uint8_t rest = w->joints.flags[i] & (uint8_t)~PHYS_JOINT_DRIVEN;
    w->joints.flags[i] = (uint8_t)(rest | (on ? PHYS_JOINT_DRIVEN : 0u));
    w->joints.motor_speed[i] = speed;
    w->joints.motor_max[i] = max;
    wake_both(w, i);
    return true;
}

bool phys_joint_set_limits(phys_world *w, phys_joint joint, bool on, float lower, float upper) {
    uint32_t i = live(w, joint, "set limits");
    if (i == CORE_NO_ROW || !check_limits((phys_joint_type)w->joints.type[i], lower, upper)) {
        return false;
    }
    uint8_t rest = w->joints.flags[i] & (uint8_t)~PHYS_JOINT_LIMITED;
    w->joints.flags[i] = (uint8_t)(rest | (on ? PHYS_JOINT_LIMITED : 0u));
    w->joints.lower[i] = lower;
    w->joints.upper[i] = upper;
    wake_both(w, i);
    return true;
}

bool phys_joint_set_spring(phys_world *w, phys_joint joint, float hertz, float damping_ratio,
                           float rest) {
    uint32_t i = live(w, joint, "set spring");
    phys_joints *j = &w->joints;
    if (i == CORE_NO_ROW ||
        !check_spring((phys_joint_type)j->type[i], hertz, damping_ratio, rest)) {
        return false;
    }
    j->hertz[i] = hertz;
    j->damping_ratio[i] = damping_ratio;
    j->rest[i] = rest;
    wake_both(w, i);
    return true;
}

// A joint that goes by itself is heard of.
static void report_break(phys_world *w, uint32_t i, phys_event_list *events) {
    const core_columns *bodies = &w->bodies.set;
    uint32_t a = phys_joint_body(bodies, w->joints.a[i]),
             b = phys_joint_body(bodies, w->joints.b[i]);
    phys_event e = {.kind = PHYS_JOINT_BREAK, .joint = core_columns_handle(&w->joints.set, i)};
    e.a = a == CORE_NO_ROW ? CORE_NULL_HANDLE : core_columns_handle(bodies, a);
    e.b = b == CORE_NO_ROW ? CORE_NULL_HANDLE : core_columns_handle(bodies, b);
    phys_event_push(events, &e);
}

void phys_joints_drop_body(phys_world *w, uint32_t slot) {
    for (uint32_t i = core_columns_count(&w->joints.set); i-- > 0;) {
        if (w->joints.a[i] == slot || w->joints.b[i] == slot) {
            report_break(w, i, &w->pending);
            remove_row(w, i);
        }
    }
}

void phys_joints_break(phys_world *w) {
    const phys_joints *j = &w->joints;
    for (uint32_t i = core_columns_count(&j->set); i-- > 0;) {
        bool torn = j->break_force[i] > 0.0f && core_v3_length(j->force[i]) > j->break_force[i];
        bool bent = j->break_torque[i] > 0.0f && core_v3_length(j->torque[i]) > j->break_torque[i];
        if (torn || bent) {
            report_break(w, i, &w->events);
            remove_row(w, i);
        }
    }
}

void phys_joints_wake(phys_world *w) {
    phys_bodies *b = &w->bodies;
    for (uint32_t i = 0; i < core_columns_count(&w->joints.set); i++) {
        uint32_t p = phys_joint_body(&b->set, w->joints.a[i]);
        uint32_t q = phys_joint_body(&b->set, w->joints.b[i]);
        if (p == CORE_NO_ROW || q == CORE_NO_ROW) {
            continue;
        }
        if (phys_moves(b, p) && (b->flags[q] & PHYS_BODY_ASLEEP)) {
            phys_wake_row(w, q);
        } else if (phys_moves(b, q) && (b->flags[p] & PHYS_BODY_ASLEEP)) {
            phys_wake_row(w, p);
        }
    }
}

static uint64_t pair_key(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static void sift(uint64_t *key, uint32_t root, uint32_t n) {
    for (uint32_t child; (child = 2 * root + 1) < n; root = child) {
        child += child + 1 < n && key[child] < key[child + 1];
        if (key[root] >= key[child]) {
            return;
        }
        uint64_t t = key[root];
        key[root] = key[child];
        key[child] = t;
    }
}

// Pairs of body slots that joints keep from touching, sorted: asked for every pair found.
void phys_joints_list_pairs(phys_world *w) {
    const phys_joints *j = &w->joints;
    phys_joint_pairs *list = &w->joint_pairs;
    uint32_t n = core_columns_count(&j->set);
    if (!list->stale) {
        return;
    }
    if (n > list->capacity) {
        uint32_t grown = CORE_MAX(n, list->capacity * 2);
        list->key =
            core_realloc(list->key, list->capacity * sizeof(uint64_t), grown * sizeof(uint64_t));
        list->capacity = grown;
    }
    list->stale = false;
    list->count = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (j->a[i] != 0 && j->b[i] != 0 && !(j->flags[i] & PHYS_JOINT_COLLIDE)) {
            list->key[list->count++] = pair_key(j->a[i], j->b[i]);
        }
    }
    for (uint32_t i = list->count / 2; i-- > 0;) {
        sift(list->key, i, list->count);
    }
    for (uint32_t i = list->count; i-- > 1;) {
        uint64_t t = list->key[0];
        list->key[0] = list->key[i];
        list->key[i] = t;
        sift(list->key, 0, i);
    }
}

bool phys_joints_part(const phys_world *w, uint32_t a, uint32_t b) {
    const phys_joint_pairs *list = &w->joint_pairs;
    if (list->count == 0) {
        return false;
    }
    uint64_t key = pair_key(phys_row_slot(&w->bodies.set, a), phys_row_slot(&w->bodies.set, b));
    uint32_t lo = 0, hi = list->count;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (list->key[mid] < key) {
            lo = mid + 1;
        } else {
            hi = mid;
        }
    }
    return lo < list->count && list->key[lo] == key;
}
