// Every kind of joint: error after 10 s under load, what stays free, limits, motors, springs,
// ratios, and the speed ripple of a Cardan shaft.
#include "phys/phys.h"

#include <math.h>
#include <unity.h>

static phys_world *w;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    w = phys_world_create(&d);
    phys_world_set(w, "sleep", "off");
}
void tearDown(void) { phys_world_destroy(w); }

static void run(float seconds) {
    int n = (int)lroundf(seconds * 60.0f);
    for (int i = 0; i < n; i++) {
        TEST_ASSERT_TRUE(phys_world_step(w, 1.0f / 60.0f));
    }
}

static phys_body box(core_vec3 at, core_vec3 half, bool fixed) {
    phys_body_desc b = phys_body_desc_default();
    b.type = fixed ? PHYS_STATIC : PHYS_DYNAMIC;
    b.position = at;
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = half;
    return phys_body_create(w, &b, &s, 1);
}

static phys_joint_desc desc(phys_joint_type type, phys_body a, phys_body b, core_vec3 anchor) {
    phys_joint_desc d = phys_joint_desc_default(type);
    d.a = a;
    d.b = b;
    d.anchor = d.anchor_a = anchor;
    return d;
}

static phys_joint make(const phys_joint_desc *d) {
    phys_joint j = phys_joint_create(w, d);
    TEST_ASSERT_TRUE_MESSAGE(phys_joint_alive(w, j), core_last_error());
    return j;
}

static double error(void) {
    phys_accuracy a;
    phys_world_accuracy(w, &a);
    return a.joint_error_max_m;
}

static core_vec3 position(phys_body b) {
    core_vec3 p;
    phys_body_position(w, b, &p);
    return p;
}
static float value_of(phys_joint j) {
    float value = NAN;
    TEST_ASSERT_TRUE(phys_joint_coordinate(w, j, &value));
    return value;
}
static core_vec3 spin(phys_body b) {
    core_vec3 v;
    phys_body_angular_velocity(w, b, &v);
    return v;
}

// Two boxes, the first held by the world, the second by the first, 10 s under gravity.
static void load_two(phys_joint_type type) {
    phys_body a = box(core_v3(0.5f, 0, 0), core_v3(0.5f, 0.1f, 0.2f), false);
    phys_body b = box(core_v3(1.5f, 0, 0), core_v3(0.5f, 0.1f, 0.2f), false);
    phys_joint_desc d = desc(type, CORE_NULL_HANDLE, a, core_v3(0, 0, 0));
    d.anchor_b = core_v3(0.2f, 0, 0);
    d.axis = core_v3(0, 0.3f, 1);
    d.axis_b = core_v3(1, 0, 0);
    d.ground_a = core_v3(-1, 2, 0);
    d.ground_b = core_v3(0.2f, 2, 0);
    make(&d);
    d.a = a;
    d.b = b;
    d.anchor = d.anchor_a = core_v3(1, 0, 0);
    d.anchor_b = core_v3(1.2f, 0, 0);
    d.ground_b = core_v3(1.2f, 2, 0);
    make(&d);
    double worst = 0;
    for (int i = 0; i < 600; i++) {
        run(1.0f / 60.0f);
        worst = fmax(worst, error());
    }
    TEST_ASSERT_TRUE_MESSAGE(error() < 1e-3, "error after 10 s");
    TEST_ASSERT_TRUE_MESSAGE(worst < 5e-3, "worst error on the way");
}
static void test_load_fixed(void) { load_two(PHYS_JOINT_FIXED); }
static void test_load_ball(void) { load_two(PHYS_JOINT_BALL); }
static void test_load_distance(void) { load_two(PHYS_JOINT_DISTANCE); }
static void test_load_revolute(void) { load_two(PHYS_JOINT_REVOLUTE); }
static void test_load_universal(void) { load_two(PHYS_JOINT_UNIVERSAL); }
static void test_load_prismatic(void) {
    phys_body a = box(core_v3(0, 0, 0), core_v3(0.5f, 0.1f, 0.2f), false);
    phys_body b = box(core_v3(2, 0, 0), core_v3(0.5f, 0.1f, 0.2f), false);
    phys_joint_desc d = desc(PHYS_JOINT_PRISMATIC, CORE_NULL_HANDLE, a, core_v3(0, 0, 0));
    d.axis = core_v3(1, -0.2f, 0);
    d.limit = true;
    d.lower = -1;
    d.upper = 3;
    make(&d);
    d.a = a;
    d.b = b;
    d.axis = core_v3(0, 0.1f, 1);
    d.lower = d.upper = 0;
    d.anchor = core_v3(1, 0, 0);
    make(&d);
    run(10);
    TEST_ASSERT_TRUE(error() < 1e-3);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 3.0f * 0.98058f, position(a).x);
}

// Freedoms: from six random pushes, the rank of the velocities a body keeps after the joint's
// solve.
static int freedoms(phys_joint_type type) {
    double rows[6][6];
    int rank = 0;
    for (int k = 0; k < 6; k++) {
        phys_world_set_gravity(w, core_v3(0, 0, 0));
        phys_body b = box(core_v3(0.3f, 0.2f, 0.1f), core_v3(0.5f, 0.1f, 0.2f), false);
        phys_joint_desc d = desc(type, CORE_NULL_HANDLE, b, core_v3(0, 0, 0));
        d.anchor_b = core_v3(0.3f, 0.2f, 0.1f);
        d.ground_b = core_v3(0, 2, 0);
        d.ground_a = core_v3(0, 3, 0);
        make(&d);
        float v[6] = {0};
        v[k] = 0.01f;
        phys_body_set_velocity(w, b, core_v3(v[0], v[1], v[2]));
        phys_body_set_angular_velocity(w, b, core_v3(v[3], v[4], v[5]));
        run(1.0f / 60.0f);
        core_vec3 l, a = spin(b);
        phys_body_velocity(w, b, &l);
        const double got[6] = {l.x, l.y, l.z, a.x, a.y, a.z};
        for (int i = 0; i < 6; i++) {
            rows[k][i] = got[i] / 0.01;
        }
        phys_body_destroy(w, b);
    }
    for (int c = 0; c < 6; c++) {
        int best = rank;
        for (int r = rank; r < 6; r++) {
            best = fabs(rows[r][c]) > fabs(rows[best][c]) ? r : best;
        }
        if (rank == 6 || fabs(rows[best][c]) < 0.01) {
            continue;
        }
        for (int i = 0; i < 6; i++) {
            double t = rows[best][i];
            rows[best][i] = rows[rank][i];
            rows[rank][i] = t;
        }
        for (int r = rank + 1; r < 6; r++) {
            double f = rows[r][c] / rows[rank][c];
            for (int i = 0; i < 6; i++) {
                rows[r][i] -= f * rows[rank][i];
            }
        }
        rank++;
    }
    return rank;
}
static void test_freedoms(void) {
    TEST_ASSERT_EQUAL_INT(0, freedoms(PHYS_JOINT_FIXED));
    TEST_ASSERT_EQUAL_INT(3, freedoms(PHYS_JOINT_BALL));
    TEST_ASSERT_EQUAL_INT(5, freedoms(PHYS_JOINT_DISTANCE));
    TEST_ASSERT_EQUAL_INT(1, freedoms(PHYS_JOINT_REVOLUTE));
    TEST_ASSERT_EQUAL_INT(1, freedoms(PHYS_JOINT_PRISMATIC));
    TEST_ASSERT_EQUAL_INT(2, freedoms(PHYS_JOINT_UNIVERSAL));
    TEST_ASSERT_EQUAL_INT(5, freedoms(PHYS_JOINT_PIVOT));
    TEST_ASSERT_EQUAL_INT(5, freedoms(PHYS_JOINT_PULLEY));
}

static void test_revolute_limit(void) {
    phys_body b = box(core_v3(0.5f, 0, 0), core_v3(0.5f, 0.05f, 0.1f), false);
    phys_joint_desc d = desc(PHYS_JOINT_REVOLUTE, CORE_NULL_HANDLE, b, core_v3(0, 0, 0));
    d.axis = core_v3(0, 0, 1);
    d.limit = true;
    d.lower = -0.7f;
    d.upper = 0.2f;
    phys_joint j = make(&d);
    float lowest = 0;
    for (int i = 0; i < 600; i++) {
        run(1.0f / 60.0f);
        lowest = fminf(lowest, value_of(j));
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -0.7f, lowest);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -0.7f, value_of(j));
    TEST_ASSERT_TRUE(error() < 1e-3);
}

static void test_ball_cone_and_twist(void) {
    phys_body b = box(core_v3(0.5f, 0, 0), core_v3(0.5f, 0.05f, 0.1f), false);
    phys_joint_desc d = desc(PHYS_JOINT_BALL, CORE_NULL_HANDLE, b, core_v3(0, 0, 0));
    d.axis = core_v3(1, 0, 0);
    d.cone = 0.5f;
    d.limit = true;
    d.lower = -0.3f;
    d.upper = 0.4f;
    phys_joint j = make(&d);
    phys_body_set_angular_velocity(w, b, core_v3(3, 0, 0));
    float most = 0, lean = 0;
    for (int i = 0; i < 600; i++) {
        run(1.0f / 60.0f);
        core_vec3 p = position(b);
        most = fmaxf(most, value_of(j));
        lean = fmaxf(lean, atan2f(sqrtf(p.y * p.y + p.z * p.z), p.x));
    }
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 0.4f, most);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 0.5f, lean);
    core_vec3 p = position(b);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.5f, atan2f(sqrtf(p.y * p.y + p.z * p.z), p.x));
}

static void test_rope_length(void) {
    phys_body b = box(core_v3(0.5f, 0, 0), core_v3(0.1f, 0.1f, 0.1f), false);
    phys_joint_desc d = desc(PHYS_JOINT_DISTANCE, CORE_NULL_HANDLE, b, core_v3(0, 0, 0));
    d.anchor_b = core_v3(0.5f, 0, 0);
    d.limit = true;
    d.upper = 2;
    phys_joint j = make(&d);
    run(0.3f);
    TEST_ASSERT_TRUE(value_of(j) < 1.0f); // slack: falls freely
    TEST_ASSERT_FLOAT_WITHIN(0.02f, -0.5f * 9.81f * 0.09f, position(b).y);
    float longest = 0;
    for (int i = 0; i < 600; i++) {
        run(1.0f / 60.0f);
        longest = fmaxf(longest, value_of(j));
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 2.0f, longest);
}

static void test_motor_against_load(void) {
    phys_body b = box(core_v3(0, 0, 0), core_v3(0.1f, 0.1f, 0.1f), false); // 8 kg
    phys_joint_desc d = desc(PHYS_JOINT_PRISMATIC, CORE_NULL_HANDLE, b, core_v3(0, 0, 0));
    d.motor = true;
    d.motor_speed = 0.5f;
    d.motor_max = 2 * 8 * 9.81f;
    phys_joint j = make(&d);
    run(2);
    TEST_ASSERT_FLOAT_WITHIN(0.03f, 1.0f, value_of(j));
    core_vec3 force, torque, v;
    TEST_ASSERT_TRUE(phys_joint_force(w, j, &force, &torque));
    TEST_ASSERT_FLOAT_WITHIN(0.5f, 8 * 9.81f, force.y);
    // Half the weight: falls with half of g.
    TEST_ASSERT_TRUE(phys_joint_set_motor(w, j, true, 0.5f, 4 * 9.81f));
    phys_body_set_velocity(w, b, core_v3(0, 0, 0));
    run(1);
    phys_body_velocity(w, b, &v);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, -0.5f * 9.81f, v.y);
    // A hinge turns at its motor's speed.
    phys_body wheel = box(core_v3(3, 0, 0), core_v3(0.2f, 0.2f, 0.1f), false);
    d = desc(PHYS_JOINT_REVOLUTE, CORE_NULL_HANDLE, wheel, core_v3(3, 0, 0));
    d.axis = core_v3(0, 0, 1);
    d.motor = true;
    d.motor_speed = 4;
    d.motor_max = 50;
    make(&d);
    run(2);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 4, spin(wheel).z);
}

static void test_spring_frequency(void) {
    phys_world_set_gravity(w, core_v3(0, 0, 0));
    phys_body b = box(core_v3(0, 0.3f, 0), core_v3(0.1f, 0.1f, 0.1f), false);
    phys_joint_desc d = desc(PHYS_JOINT_PRISMATIC, CORE_NULL_HANDLE, b, core_v3(0, 0, 0));
    d.hertz = 2;
    d.damping_ratio = 0;
    d.rest = -0.3f;
    make(&d);
    int crossings = 0, first = 0, last = 0;
    float before = 0.3f;
    for (int i = 1; i <= 300; i++) {
        run(1.0f / 60.0f);
        float y = position(b).y;
        if (before > 0 && y <= 0) {
            crossings++;
            first = first ? first : i;
            last = i;
        }
        before = y;
    }
    float hertz = (float)(crossings - 1) / ((float)(last - first) / 60.0f);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 2.0f, hertz);
}

static void test_pulley(void) {
    phys_body a = box(core_v3(0, 0, 0), core_v3(0.1f, 0.1f, 0.1f), false);  // 8 kg
    phys_body b = box(core_v3(1, 0, 0), core_v3(0.1f, 0.1f, 0.05f), false); // 4 kg
    phys_joint_desc d = desc(PHYS_JOINT_PULLEY, a, b, core_v3(0, 0, 0));
    d.anchor_b = core_v3(1, 0, 0);
    d.ground_a = core_v3(0, 5, 0);
    d.ground_b = core_v3(1, 5, 0);
    phys_joint j = make(&d);
    run(1);
    // Atwood: a = g (m1 - m2) / (m1 + m2); tension 2 m1 m2 g / (m1 + m2).
    TEST_ASSERT_FLOAT_WITHIN(0.03f, -0.5f * 9.81f / 3, position(a).y);
    core_vec3 force, torque;
    phys_joint_force(w, j, &force, &torque);
    TEST_ASSERT_FLOAT_WITHIN(0.3f, 2 * 8 * 4 * 9.81f / 12, force.y);
    TEST_ASSERT_TRUE(error() < 1e-3);
}

// Two wheels on hinges, joined by a pivot.
static void test_pivot_ratio(void) {
    phys_body a = box(core_v3(0, 0, 0), core_v3(0.2f, 0.2f, 0.1f), false);
    phys_body b = box(core_v3(1, 0, 0), core_v3(0.1f, 0.1f, 0.1f), false);
    phys_joint_desc d = desc(PHYS_JOINT_REVOLUTE, CORE_NULL_HANDLE, a, core_v3(0, 0, 0));
    d.axis = core_v3(0, 0, 1);
    make(&d);
    d.b = b;
    d.anchor = core_v3(1, 0, 0);
    d.motor = true;
    d.motor_speed = 3;
    d.motor_max = 100;
    make(&d);
    d = desc(PHYS_JOINT_PIVOT, a, b, core_v3(0, 0, 0));
    d.axis = core_v3(0, 0, 1);
    d.ratio = -0.5f;
    make(&d);
    run(10);
    TEST_ASSERT_FLOAT_WITHIN(3e-3f, 3, spin(b).z);
    TEST_ASSERT_FLOAT_WITHIN(3e-3f, -1.5f, spin(a).z);
    TEST_ASSERT_TRUE(error() < 1e-3);
}

// A box held at its side by a cross falls about one of the two axes to the end of its range.
static void test_universal_limits(void) {
    phys_body a = box(core_v3(0, 0, 0), core_v3(0.5f, 0.2f, 0.2f), true);
    phys_body b = box(core_v3(1, 0, 0), core_v3(0.5f, 0.2f, 0.2f), false);
    phys_body c = box(core_v3(1, 0, 3), core_v3(0.5f, 0.2f, 0.2f), false);
    phys_joint_desc d = desc(PHYS_JOINT_UNIVERSAL, a, b, core_v3(0.5f, 0, 0));
    d.axis = core_v3(0, 0, 1);
    d.axis_b = core_v3(0, 1, 0);
    d.limit = true;
    d.lower = -0.5f;
    d.upper = 0.3f;
    phys_joint j = make(&d);
    d = desc(PHYS_JOINT_UNIVERSAL, CORE_NULL_HANDLE, c, core_v3(0.5f, 0, 3));
    d.axis = core_v3(0, 1, 0);
    d.axis_b = core_v3(0, 0, 1);
    d.cone = 0.4f;
    make(&d);
    float lowest = 0;
    for (int i = 0; i < 600; i++) {
        run(1.0f / 60.0f);
        lowest = fminf(lowest, value_of(j));
    }
    core_quat q;
    phys_body_rotation(w, c, &q);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -0.5f, value_of(j));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -0.4f, 2.0f * asinf(q.z));
    TEST_ASSERT_TRUE(lowest > -0.501f);
    TEST_ASSERT_TRUE(error() < 1e-3);
}

static void test_universal_motor(void) {
    phys_world_set_gravity(w, core_v3(0, 0, 0));
    phys_body b = box(core_v3(1, 0, 0), core_v3(0.5f, 0.2f, 0.2f), false);
    phys_joint_desc d = desc(PHYS_JOINT_UNIVERSAL, CORE_NULL_HANDLE, b, core_v3(0.5f, 0, 0));
    d.axis = core_v3(0, 0, 1);
    d.motor = true;
    d.motor_speed = 1.5f;
    d.motor_max = 1e4f;
    phys_joint j = make(&d);
    run(1);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 1.5f, spin(b).z);
    TEST_ASSERT_FLOAT_WITHIN(5e-3f, 1.5f, value_of(j));
    TEST_ASSERT_TRUE(error() < 1e-3);
}

// The heavier side sinks until its rope is at its longest; a winch then lifts it.
static void test_pulley_limit_and_winch(void) {
    phys_body a = box(core_v3(0, 0, 0), core_v3(0.1f, 0.1f, 0.1f), false);
    phys_body b = box(core_v3(1, 0, 0), core_v3(0.1f, 0.1f, 0.05f), false);
    phys_joint_desc d = desc(PHYS_JOINT_PULLEY, a, b, core_v3(0, 0, 0));
    d.anchor_b = core_v3(1, 0, 0);
    d.ground_a = core_v3(0, 5, 0);
    d.ground_b = core_v3(1, 5, 0);
    d.limit = true;
    d.lower = 3.0f;
    d.upper = 5.5f;
    phys_joint j = make(&d);
    run(10);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 5.5f, value_of(j));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -0.5f, position(a).y);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.5f, position(b).y);
    phys_joint_set_motor(w, j, true, -0.4f, 1e4f);
    run(2);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 4.7f, value_of(j));
    run(8);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 3.0f, value_of(j));
    TEST_ASSERT_TRUE(error() < 1e-3);
}

static void test_pivot_motor(void) {
    phys_body a = box(core_v3(0, 0, 0), core_v3(0.2f, 0.2f, 0.1f), false);
    phys_body b = box(core_v3(1, 0, 0), core_v3(0.1f, 0.1f, 0.1f), false);
    phys_joint_desc d = desc(PHYS_JOINT_REVOLUTE, CORE_NULL_HANDLE, a, core_v3(0, 0, 0));
    d.axis = core_v3(0, 0, 1);
    make(&d);
    d.b = b;
    d.anchor = core_v3(1, 0, 0);
    make(&d);
    d = desc(PHYS_JOINT_PIVOT, a, b, core_v3(0, 0, 0));
    d.axis = core_v3(0, 0, 1);
    d.ratio = -0.5f;
    d.motor = true;
    d.motor_speed = 4;
    d.motor_max = 100;
    make(&d);
    run(5);
    TEST_ASSERT_FLOAT_WITHIN(5e-3f, 4, spin(b).z);
    TEST_ASSERT_FLOAT_WITHIN(5e-3f, -2, spin(a).z);
    TEST_ASSERT_TRUE(error() < 1e-3);
    d = desc(PHYS_JOINT_PIVOT, b, CORE_NULL_HANDLE, core_v3(0, 0, 0));
    d.motor = true;
    TEST_ASSERT_FALSE(phys_joint_alive(w, phys_joint_create(w, &d)));
}

// A weight on each kind of joint: what the joint says it bears is what statics say, it holds at a
// tenth more than that and breaks at a tenth less.
static const phys_joint_type bearing[] = {PHYS_JOINT_FIXED,     PHYS_JOINT_BALL,
                                          PHYS_JOINT_DISTANCE,  PHYS_JOINT_REVOLUTE,
                                          PHYS_JOINT_PRISMATIC, PHYS_JOINT_UNIVERSAL};
static phys_joint hang(phys_joint_type type, float x, float break_force) {
    phys_body b = box(core_v3(x, -1, 0), core_v3(0.1f, 0.5f, 0.1f), false); // 40 kg
    phys_joint_desc d = desc(type, CORE_NULL_HANDLE, b, core_v3(x, -0.5f, 0));
    d.anchor_a = core_v3(x, 0, 0);
    d.anchor_b = core_v3(x, -0.5f, 0);
    d.axis = core_v3(0, 0, 1); // prismatic: across the load
    d.axis_b = core_v3(1, 0, 0);
    d.break_force = break_force;
    return make(&d);
}
static void test_reported_loads_and_breaking(void) {
    const float weight = 40 * 9.81f;
    for (size_t i = 0; i < CORE_COUNT_OF(bearing); i++) {
        phys_joint free = hang(bearing[i], 0, 0);
        phys_joint strong = hang(bearing[i], 1, 1.1f * weight);
        phys_joint weak = hang(bearing[i], 2, 0.9f * weight);
        run(3);
        core_vec3 force, torque;
        TEST_ASSERT_TRUE(phys_joint_force(w, free, &force, &torque));
        TEST_ASSERT_FLOAT_WITHIN(0.01f * weight, weight, force.y);
        TEST_ASSERT_FLOAT_WITHIN(0.01f * weight, 0, force.x);
        TEST_ASSERT_TRUE(phys_joint_alive(w, strong));
        TEST_ASSERT_FALSE(phys_joint_alive(w, weak));
        tearDown();
        setUp();
    }
}

// A beam clamped at one end: m g l / 2 at the clamp.
static void test_reported_torque(void) {
    phys_body b = box(core_v3(1, 0, 0), core_v3(1, 0.05f, 0.1f), false); // 40 kg
    phys_joint_desc d = desc(PHYS_JOINT_FIXED, CORE_NULL_HANDLE, b, core_v3(0, 0, 0));
    phys_joint j = make(&d);
    d.break_torque = 0.9f * 40 * 9.81f;
    run(3);
    core_vec3 force, torque;
    phys_joint_force(w, j, &force, &torque);
    TEST_ASSERT_FLOAT_WITHIN(4.0f, 40 * 9.81f, force.y);
    TEST_ASSERT_FLOAT_WITHIN(4.0f, 40 * 9.81f, core_v3_length(torque));
    phys_joint weak = make(&d); // shares the load at first, then bears what is left
    phys_joint_destroy(w, j);
    run(3);
    TEST_ASSERT_FALSE(phys_joint_alive(w, weak));
}

// A shaft bent by beta: out / in = cos beta / (1 - sin^2 beta cos^2 angle) at least and most
// cos beta and 1 / cos beta.
static void test_cardan_ripple(void) {
    phys_world_set_gravity(w, core_v3(0, 0, 0));
    const float beta = 0.5f;
    core_vec3 out = core_v3(cosf(beta), sinf(beta), 0);
    phys_body a = box(core_v3(-0.5f, 0, 0), core_v3(0.5f, 0.1f, 0.1f), false);
    phys_body_desc bd = phys_body_desc_default();
    bd.position = core_v3(0.5f * out.x, 0.5f * out.y, 0);
    bd.rotation = (core_quat){0, 0, sinf(beta / 2), cosf(beta / 2)};
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = core_v3(0.5f, 0.1f, 0.1f);
    phys_body b = phys_body_create(w, &bd, &s, 1);
    phys_joint_desc d = desc(PHYS_JOINT_REVOLUTE, CORE_NULL_HANDLE, a, core_v3(-1, 0, 0));
    d.axis = core_v3(1, 0, 0);
    d.motor = true;
    d.motor_speed = 2;
    d.motor_max = 1e4f;
    make(&d);
    d = desc(PHYS_JOINT_REVOLUTE, CORE_NULL_HANDLE, b, core_v3(out.x, out.y, 0));
    d.axis = out;
    make(&d);
    // The cross: at a right angle to the shaft on either side. Position is held by the hinges.
    d = desc(PHYS_JOINT_UNIVERSAL, a, b, core_v3(0, 0, 0));
    d.axis = core_v3(0, 0, 1);
    d.axis_b = core_v3(-out.y, out.x, 0);
    make(&d);
    run(1);
    float least = 1e9f, most = 0;
    for (int i = 0; i < 400; i++) {
        run(1.0f / 60.0f);
        float ratio = core_v3_dot(spin(b), out) / spin(a).x;
        least = fminf(least, ratio);
        most = fmaxf(most, ratio);
    }
    TEST_ASSERT_FLOAT_WITHIN(0.005f, cosf(beta), least);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 1 / cosf(beta), most);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_load_fixed);
    RUN_TEST(test_load_ball);
    RUN_TEST(test_load_distance);
    RUN_TEST(test_load_revolute);
    RUN_TEST(test_load_universal);
    RUN_TEST(test_load_prismatic);
    RUN_TEST(test_freedoms);
    RUN_TEST(test_revolute_limit);
    RUN_TEST(test_ball_cone_and_twist);
    RUN_TEST(test_rope_length);
    RUN_TEST(test_motor_against_load);
    RUN_TEST(test_spring_frequency);
    RUN_TEST(test_pulley);
    RUN_TEST(test_pivot_ratio);
    RUN_TEST(test_universal_limits);
    RUN_TEST(test_universal_motor);
    RUN_TEST(test_pulley_limit_and_winch);
    RUN_TEST(test_pivot_motor);
    RUN_TEST(test_reported_loads_and_breaking);
    RUN_TEST(test_reported_torque);
    RUN_TEST(test_cardan_ripple);
    return UNITY_END();
}
