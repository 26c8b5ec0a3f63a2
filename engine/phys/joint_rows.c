// What each kind of joint asks of two bodies in their present pose: errors and Jacobians.
#include "phys/joint_solve.h"

#include <string.h>

// Part of the error that a substep takes back: trees answer exactly, so all of it.
#define RATE_DIRECT 1.0f
#define RATE_LIMIT  0.5f
#define SPEED_MAX   30.0f // m/s or rad/s of correction

typedef struct pose {
    core_vec3 ra, rb, d; // arms in world axes, anchor of b - anchor of a
    core_quat fa, fb;    // joint frames
    core_vec3 xa, xb;    // their axes
    core_quat relative;  // fb seen from fa, w >= 0
} pose;

static core_vec3 axis_of(core_quat q, int i) {
    return phys_rotate(q, core_v3(i == 0, i == 1, i == 2));
}

static pose make_pose(const soft_joints *s, const joint_work *k) {
    const phys_joints *j = &s->world->joints;
    const joint_body *a = &s->body[k->a], *b = &s->body[k->b];
    pose p;
    p.ra = phys_rotate(a->q, j->la[k->joint]);
    p.rb = phys_rotate(b->q, j->lb[k->joint]);
    p.d = core_v3_sub(b->center, a->center);
    p.d = core_v3_add(p.d, core_v3_sub(p.rb, p.ra));
    p.fa = phys_quat_mul(a->q, j->qa[k->joint]);
    p.fb = phys_quat_mul(b->q, j->qb[k->joint]);
    p.xa = axis_of(p.fa, 0);
    p.xb = axis_of(p.fb, 0);
    p.relative = phys_quat_mul(phys_conj(p.fa), p.fb);
    if (p.relative.w < 0.0f) {
        p.relative = (core_quat){-p.relative.x, -p.relative.y, -p.relative.z, -p.relative.w};
    }
    return p;
}

static void put(float *out, core_vec3 v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

// Speed of b's anchor against a's along u; the arm of a reaches to b's anchor, so that directions
// that turn with a are right.
static void linear(joint_row *r, const pose *p, core_vec3 u, bool turns) {
    core_vec3 arm = turns ? core_v3_add(p->ra, p->d) : p->ra;
    put(r->j, core_v3_scale(u, -1.0f));
    put(r->j + 3, core_v3_cross(u, arm));
    put(r->j + 6, u);
    put(r->j + 9, core_v3_cross(p->rb, u));
}
static void angular(joint_row *r, core_vec3 a, core_vec3 b) {
    put(r->j, core_v3(0, 0, 0));
    put(r->j + 3, a);
    put(r->j + 6, core_v3(0, 0, 0));
    put(r->j + 9, b);
}

static joint_row *point_rows(joint_row *r, const pose *p) {
    for (int i = 0; i < 3; i++, r++) {
        linear(r, p, core_v3(i == 0, i == 1, i == 2), false);
        r->error = phys_comp(p->d, i);
    }
    return r;
}

// All turning, about the axes of a's frame.
static joint_row *lock_rows(joint_row *r, const pose *p) {
    const float e[3] = {p->relative.x, p->relative.y, p->relative.z};
    for (int i = 0; i < 3; i++, r++) {
        core_vec3 u = axis_of(p->fa, i);
        angular(r, core_v3_scale(u, -1.0f), u);
        r->error = 2.0f * e[i];
    }
    return r;
}

static joint_row *hinge_rows(joint_row *r, const pose *p) {
    core_vec3 lean = core_v3_cross(p->xa, p->xb);
    for (int i = 1; i < 3; i++, r++) {
        core_vec3 u = axis_of(p->fa, i);
        angular(r, core_v3_scale(u, -1.0f), u);
        r->error = core_v3_dot(lean, u);
    }
    return r;
}

static joint_row *slide_rows(joint_row *r, const pose *p) {
    for (int i = 1; i < 3; i++, r++) {
        core_vec3 u = axis_of(p->fa, i);
        linear(r, p, u, true);
        r->error = core_v3_dot(u, p->d);
    }
    return r;
}

static void pulley_row(const soft_joints *s, const joint_work *k, joint_row *r, const pose *p) {
    const phys_joints *j = &s->world->joints;
    float ratio = j->ratio[k->joint];
    core_vec3 da = core_v3_sub(core_v3_add(s->body[k->a].center, p->ra), j->ground_a[k->joint]);
    core_vec3 db = core_v3_sub(core_v3_add(s->body[k->b].center, p->rb), j->ground_b[k->joint]);
    core_vec3 ua = phys_unit(da, core_v3(0, -1, 0)), ub = phys_unit(db, core_v3(0, -1, 0));
    put(r->j, ua);
    put(r->j + 3, core_v3_cross(p->ra, ua));
    put(r->j + 6, core_v3_scale(ub, ratio));
    put(r->j + 9, core_v3_scale(core_v3_cross(p->rb, ub), ratio));
    r->error = core_v3_length(da) + ratio * core_v3_length(db) - j->rest[k->joint];
}

// Length of a's side of the rope.
static float pulley_side(const soft_joints *s, const joint_work *k, joint_row *r, const pose *p) {
    core_vec3 at = core_v3_add(s->body[k->a].center, p->ra);
    core_vec3 d = core_v3_sub(at, s->world->joints.ground_a[k->joint]);
    core_vec3 u = phys_unit(d, core_v3(0, -1, 0));
    memset(r->j, 0, sizeof r->j);
    put(r->j, u);
    put(r->j + 3, core_v3_cross(p->ra, u));
    return core_v3_length(d);
}

// The angle of one axis of a Cardan joint about the other, which `frame` starts with; 0 at rest.
static float cardan_angle(core_quat frame, core_vec3 other) {
    return core_atan2f(core_v3_dot(other, axis_of(frame, 2)),
                       core_v3_dot(other, axis_of(frame, 1)));
}

// The free coordinate and its row.
static float coordinate(const soft_joints *s, const joint_work *k, joint_row *r, const pose *p) {
    uint8_t type = k->type;
    if (type == PHYS_JOINT_PULLEY) {
        return pulley_side(s, k, r, p);
    }
    if (type == PHYS_JOINT_UNIVERSAL) {
        angular(r, core_v3_scale(p->xa, -1.0f), p->xa);
        return cardan_angle(p->fa, p->xb);
    }
    if (type == PHYS_JOINT_PIVOT) { // has a speed, that of b, but no angle
        angular(r, core_v3(0, 0, 0), p->xb);
        return 0.0f;
    }
    if (type == PHYS_JOINT_PRISMATIC) {
        linear(r, p, p->xa, true);
        return core_v3_dot(p->xa, p->d);
    }
    if (type == PHYS_JOINT_DISTANCE) {
        linear(r, p, phys_unit(p->d, core_v3(0, 1, 0)), false);
        return core_v3_length(p->d);
    }
    // Rate of the twist: (wb - wa) . (xa + xb) / (1 + xa . xb).
    float lean = CORE_MAX(1.0f + core_v3_dot(p->xa, p->xb), 0.1f);
    core_vec3 u = core_v3_scale(core_v3_add(p->xa, p->xb), 1.0f / lean);
    angular(r, core_v3_scale(u, -1.0f), u);
    return 2.0f * core_atan2f(p->relative.x, p->relative.w);
}

static bool is_rod(const phys_joints *j, uint32_t i) {
    return j->type[i] == PHYS_JOINT_DISTANCE && j->hertz[i] == 0.0f && j->damping[i] == 0.0f &&
           (j->flags[i] & (PHYS_JOINT_LIMITED | PHYS_JOINT_DRIVEN)) == 0;
}

void joint_rows_count(const phys_joints *j, uint32_t i, uint8_t *hard, uint8_t *soft) {
    static const uint8_t rows[] = {
        [PHYS_JOINT_FIXED] = 6,    [PHYS_JOINT_BALL] = 3,      [PHYS_JOINT_DISTANCE] = 0,
        [PHYS_JOINT_REVOLUTE] = 5, [PHYS_JOINT_PRISMATIC] = 5, [PHYS_JOINT_UNIVERSAL] = 4,
        [PHYS_JOINT_PIVOT] = 1,    [PHYS_JOINT_PULLEY] = 1,
    };
    *hard = is_rod(j, i) ? 1 : rows[j->type[i]];
    *soft = (uint8_t)(((j->flags[i] & PHYS_JOINT_LIMITED) != 0) +
                      ((j->flags[i] & PHYS_JOINT_DRIVEN) != 0) + (j->cone[i] > 0.0f) +
                      (j->hertz[i] > 0.0f || j->damping[i] > 0.0f));
}

static void hard_rows(const soft_joints *s, joint_work *k, const pose *p) {
    joint_row *r = k->row;
    switch (k->type) {
    case PHYS_JOINT_FIXED:
        lock_rows(point_rows(r, p), p);
        break;
    case PHYS_JOINT_REVOLUTE:
        hinge_rows(point_rows(r, p), p);
        break;
    case PHYS_JOINT_PRISMATIC:
        lock_rows(slide_rows(r, p), p);
        break;
    case PHYS_JOINT_UNIVERSAL: {
        r = point_rows(r, p);
        core_vec3 n = core_v3_cross(p->xa, p->xb);
        angular(r, n, core_v3_scale(n, -1.0f));
        r->error = core_v3_dot(p->xa, p->xb);
        break;
    }
    case PHYS_JOINT_PIVOT: {
        float ratio = s->world->joints.ratio[k->joint];
        angular(r, p->xa, core_v3_scale(p->xb, -ratio));
        r->error = s->world->joints.phase[k->joint];
        break;
    }
    case PHYS_JOINT_PULLEY:
        pulley_row(s, k, r, p);
        break;
    case PHYS_JOINT_DISTANCE:
        if (k->hard != 0) {
            r->error = coordinate(s, k, r, p) - s->world->joints.rest[k->joint];
        }
        break;
    default:
        point_rows(r, p);
    }
    float rate = (k->direct ? RATE_DIRECT : JOINT_LOOP_RATE) / s->h;
    for (uint32_t i = 0; i < k->hard; i++) {
        joint_row *row = &k->row[i];
        row->bias = CORE_CLAMP(row->error * rate, -SPEED_MAX, SPEED_MAX);
        row->relax = 0.0f;
    }
}

static void answer(const soft_joints *s, const joint_work *k, const float *j, float out[12]) {
    memset(out, 0, 12 * sizeof *out);
    for (int side = 0; side < 2; side++) {
        const joint_body *b = &s->body[side ? k->b : k->a];
        const float *l = j + side * 6, *t = l + 3;
        float *o = out + side * 6;
        if (b->mobile) {
            const float *m = s->bodies->inertia + (size_t)b->place * 8;
            o[0] = b->im * l[0];
            o[1] = b->im * l[1];
            o[2] = b->im * l[2];
            o[3] = m[0] * t[0] + m[4] * t[1] + m[5] * t[2];
            o[4] = m[4] * t[0] + m[1] * t[1] + m[6] * t[2];
            o[5] = m[5] * t[0] + m[6] * t[1] + m[2] * t[2];
        }
    }
}

static float product(const float *a, const float *b) {
    float sum = 0.0f;
    for (int i = 0; i < 12; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// 1 / mass along a row.
static float inverse_mass(const soft_joints *s, const joint_work *k, const joint_row *r) {
    float out[12];
    answer(s, k, r->j, out);
    return product(r->j, out);
}

// Makes an impulse along a row leave the joint's hard rows as they are: the row with their reaction
// to it. Limits and motors then work against the mass that really turns or slides, and the hard
// rows solved after them take nothing back.
static void clear_of_hard(const soft_joints *s, const joint_work *k, float *row) {
    float out[PHYS_JOINT_HARD][12];
    double m[6][6], mixed[6];
    for (uint32_t r = 0; r < k->hard; r++) {
        answer(s, k, k->row[r].j, out[r]);
        for (uint32_t c = 0; c <= r; c++) {
            m[r][c] = m[c][r] = (double)product(k->row[c].j, out[r]);
        }
        m[r][r] *= 1.0 + 1e-6;
        mixed[r] = (double)product(row, out[r]);
    }
    joint_invert(m, k->hard);
    for (uint32_t r = 0; r < k->hard; r++) {
        double share = 0.0;
        for (uint32_t c = 0; c < k->hard; c++) {
            share += m[r][c] * mixed[c];
        }
        for (int i = 0; i < 12; i++) {
            row[i] -= (float)share * k->row[r].j[i];
        }
    }
}

// Keeps `room` from falling below 0: near the end only what is left may be used up.
static void limit_row(const soft_joints *s, joint_row *r, float room) {
    r->error = room;
    r->lo = 0.0f;
    r->hi = 1e30f;
    r->gamma = 0.0f;
    bool over = room < 0.0f;
    r->bias = over ? CORE_MAX(room * RATE_LIMIT / s->h, -SPEED_MAX) : room / s->h;
    r->relax = over ? 0.0f : room / s->h;
}

static void negate(joint_row *r) {
    for (int i = 0; i < 12; i++) {
        r->j[i] = -r->j[i];
    }
}

static joint_row *range_row(const soft_joints *s, const joint_work *k, joint_row *r,
                            const joint_row *free, float x) {
    const phys_joints *j = &s->world->joints;
    float lower = j->lower[k->joint], upper = j->upper[k->joint];
    memcpy(r->j, free->j, sizeof r->j);
    if (k->upper) {
        negate(r);
    }
    limit_row(s, r, k->upper ? upper - x : x - lower);
    if (upper - lower < 1e-6f) { // one place: pulls as well
        r->lo = -1e30f;
        r->bias = r->error * RATE_LIMIT / s->h;
        r->relax = 0.0f;
    }
    return r + 1;
}

static joint_row *motor_row(const soft_joints *s, const joint_work *k, joint_row *r,
                            const joint_row *free) {
    const phys_joints *j = &s->world->joints;
    memcpy(r->j, free->j, sizeof r->j);
    r->bias = r->relax = -j->motor_speed[k->joint];
    r->gamma = 0.0f;
    r->hi = j->motor_max[k->joint] * s->h;
    r->lo = -r->hi;
    return r + 1;
}

// Implicit spring of a substep: J v + k h / (c + k h) error / h + gamma impulse = 0.
static void spring_row(const soft_joints *s, const joint_work *k, joint_row *r,
                       const joint_row *free, float x) {
    const phys_joints *j = &s->world->joints;
    uint32_t i = k->joint;
    memcpy(r->j, free->j, sizeof r->j);
    float inv = inverse_mass(s, k, r), omega = 2.0f * CORE_PI_F * j->hertz[i];
    float mass = inv > 0.0f ? 1.0f / inv : 0.0f, stiff = mass * omega * omega;
    float damp = 2.0f * mass * j->damping_ratio[i] * omega + j->damping[i];
    float soft = damp + s->h * stiff;
    r->error = x - j->rest[i];
    r->gamma = soft > 0.0f ? 1.0f / (s->h * soft) : 0.0f;
    r->bias = r->relax = soft > 0.0f ? r->error * stiff / soft : 0.0f;
    r->lo = soft > 0.0f ? -1e30f : 0.0f;
    r->hi = -r->lo;
}

// Of a Cardan joint: the turn about b's axis, to either side.
static joint_row *side_row(const soft_joints *s, const joint_work *k, joint_row *r, const pose *p) {
    float angle = -cardan_angle(p->fb, p->xa), sign = angle < 0.0f ? -1.0f : 1.0f;
    core_vec3 n = core_v3_scale(p->xb, sign);
    angular(r, n, core_v3_scale(n, -1.0f));
    clear_of_hard(s, k, r->j);
    limit_row(s, r, s->world->joints.cone[k->joint] - sign * angle);
    return r + 1;
}

static joint_row *cone_row(const soft_joints *s, const joint_work *k, joint_row *r, const pose *p) {
    if (k->type == PHYS_JOINT_UNIVERSAL) {
        return side_row(s, k, r, p);
    }
    core_vec3 n = core_v3_cross(p->xa, p->xb);
    float sine = core_v3_length(n), angle = core_atan2f(sine, core_v3_dot(p->xa, p->xb));
    n = phys_unit(n, axis_of(p->fa, 1));
    angular(r, n, core_v3_scale(n, -1.0f));
    clear_of_hard(s, k, r->j);
    limit_row(s, r, s->world->joints.cone[k->joint] - angle);
    return r + 1;
}

static void soft_rows(const soft_joints *s, joint_work *k, const pose *p) {
    const phys_joints *j = &s->world->joints;
    uint32_t i = k->joint;
    joint_row free, *r = k->row + k->hard;
    if (k->soft == 0) {
        return;
    }
    float x = coordinate(s, k, &free, p);
    clear_of_hard(s, k, free.j);
    if (j->flags[i] & PHYS_JOINT_LIMITED) {
        r = range_row(s, k, r, &free, x);
    }
    if (j->cone[i] > 0.0f) {
        r = cone_row(s, k, r, p);
    }
    if (j->flags[i] & PHYS_JOINT_DRIVEN) {
        r = motor_row(s, k, r, &free);
    }
    if (j->hertz[i] > 0.0f || j->damping[i] > 0.0f) {
        spring_row(s, k, r, &free, x);
    }
}

void joint_rows_make(const soft_joints *s, joint_work *k) {
    pose p = make_pose(s, k);
    k->arm_b = p.rb;
    hard_rows(s, k, &p);
    soft_rows(s, k, &p);
}

bool joint_rows_upper(const soft_joints *s, const joint_work *k) {
    const phys_joints *j = &s->world->joints;
    joint_row free;
    pose p = make_pose(s, k);
    float x = coordinate(s, k, &free, &p);
    return x - j->lower[k->joint] > j->upper[k->joint] - x;
}

bool phys_joint_coordinate(const phys_world *w, phys_joint joint, float *out) {
    uint32_t i = core_columns_row(&w->joints.set, joint);
    if (i == CORE_NO_ROW) {
        return core_fail("phys joint: value of a stale or null handle (%u:%u)", joint.index,
                         joint.generation);
    }
    uint8_t type = w->joints.type[i];
    if (type != PHYS_JOINT_DISTANCE && type != PHYS_JOINT_REVOLUTE &&
        type != PHYS_JOINT_PRISMATIC && type != PHYS_JOINT_BALL && type != PHYS_JOINT_UNIVERSAL &&
        type != PHYS_JOINT_PULLEY) {
        return core_fail("phys joint: type %d has no value, expected ball, distance, revolute, "
                         "prismatic, universal or pulley",
                         (int)type);
    }
    joint_body body[2];
    for (int k = 0; k < 2; k++) {
        uint32_t row = phys_joint_body(&w->bodies.set, k ? w->joints.b[i] : w->joints.a[i]);
        bool none = row == CORE_NO_ROW;
        body[k].center =
            none ? core_v3(0, 0, 0) : phys_get3(w->bodies.cx, w->bodies.cy, w->bodies.cz, row);
        body[k].q = none ? core_quat_identity() : phys_body_quat(&w->bodies, row);
    }
    soft_joints s = {.world = (phys_world *)(uintptr_t)w, .body = body};
    joint_work k = {.joint = i, .a = 0, .b = 1, .type = type};
    pose p = make_pose(&s, &k);
    joint_row free;
    *out = coordinate(&s, &k, &free, &p);
    return true;
}
