// Settings of bodies: each read back as written, each out of range refused whole; materials and
// their rules; hits.
#include "core/log.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static phys_body add(phys_body_type type, phys_shape_type shape, core_vec3 at, float friction,
                     float restitution) {
    phys_body_desc d = phys_body_desc_default();
    d.type = type;
    d.position = at;
    phys_shape_desc s = phys_shape_desc_default(shape);
    s.half = type == PHYS_STATIC ? core_v3(50, 1, 50) : core_v3(0.5f, 0.25f, 0.5f);
    s.radius = 0.5f;
    s.friction = friction;
    s.restitution = restitution;
    return phys_body_create(world, &d, &s, 1);
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, 1.0f / 60.0f));
    }
}

static void test_settings_are_read_back(void) {
    phys_body b = add(PHYS_DYNAMIC, PHYS_BOX, core_v3(0, 5, 0), 0.5f, 0);
    phys_body_settings s, back;
    TEST_ASSERT_TRUE(phys_body_read(world, b, &s));
    TEST_ASSERT_EQUAL_INT(PHYS_DYNAMIC, s.type);
    TEST_ASSERT_EQUAL_UINT32(1, s.shape_count);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, s.gravity_scale);
    s.linear_damping = 0.25f;
    s.angular_damping = 0.5f;
    s.gravity_scale = -2.0f;
    s.locks = PHYS_LOCK_X | PHYS_LOCK_TURN_Y;
    s.layer = 7;
    s.contact_events = true;
    TEST_ASSERT_TRUE(phys_body_write(world, b, &s));
    TEST_ASSERT_TRUE(phys_body_read(world, b, &back));
    TEST_ASSERT_EQUAL_FLOAT(0.25f, back.linear_damping);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, back.angular_damping);
    TEST_ASSERT_EQUAL_FLOAT(-2.0f, back.gravity_scale);
    TEST_ASSERT_EQUAL_UINT32(PHYS_LOCK_X | PHYS_LOCK_TURN_Y, back.locks);
    TEST_ASSERT_EQUAL_UINT32(7, back.layer);
    TEST_ASSERT_TRUE(back.contact_events);
    back.linear_damping = -1.0f;
    back.layer = 3;
    TEST_ASSERT_FALSE(phys_body_write(world, b, &back));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "damping (-1 linear"));
    TEST_ASSERT_EQUAL_UINT32(7, phys_body_layer(world, b)); // nothing was changed
    phys_body_destroy(world, b);
    TEST_ASSERT_FALSE(phys_body_read(world, b, &back));
    TEST_ASSERT_FALSE(phys_body_write(world, b, &s));
}

// v' = -c v has the limit e^(-c t), and no damping ever turns a velocity round (report, P5).
static void test_damping_follows_its_law(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_body b = add(PHYS_DYNAMIC, PHYS_BOX, core_v3(0, 5, 0), 0.5f, 0);
    phys_body_settings s;
    phys_body_read(world, b, &s);
    s.linear_damping = s.angular_damping = 1.5f;
    phys_body_write(world, b, &s);
    phys_body_set_velocity(world, b, core_v3(10, 0, 0));
    phys_body_set_angular_velocity(world, b, core_v3(0, 3, 0));
    run(60);
    core_vec3 v, w;
    phys_body_velocity(world, b, &v);
    phys_body_angular_velocity(world, b, &w);
    TEST_ASSERT_FLOAT_WITHIN(0.03f, 10.0f * expf(-1.5f), v.x);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 3.0f * expf(-1.5f), w.y);
    s.linear_damping = 1e6f;
    phys_body_write(world, b, &s);
    run(1);
    phys_body_velocity(world, b, &v);
    TEST_ASSERT_TRUE(v.x >= 0.0f && v.x < 1e-3f);
}

static void test_locked_axes_stay_exactly(void) {
    add(PHYS_STATIC, PHYS_BOX, core_v3(0, -1, 0), 0.5f, 0);
    phys_body b = add(PHYS_DYNAMIC, PHYS_BOX, core_v3(1, 2, 3), 0.5f, 0);
    phys_body_settings s;
    phys_body_read(world, b, &s);
    s.locks = PHYS_LOCK_X | PHYS_LOCK_TURN;
    phys_body_write(world, b, &s);
    phys_body_apply_impulse(world, b, core_v3(300, 0, 200), core_v3(1.3f, 2.2f, 3.4f));
    run(200);
    core_vec3 p, w;
    core_quat q;
    phys_body_position(world, b, &p);
    phys_body_rotation(world, b, &q);
    phys_body_angular_velocity(world, b, &w);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, p.x);
    TEST_ASSERT_TRUE(p.z > 3.05f);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, q.w);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, core_v3_length(w));
}

// How far a block of 2 m/s slides says the friction of its contact: v^2 / 2 mu g.
static float slide(const char *rule, float mine, float ground) {
    tearDown();
    setUp();
    TEST_ASSERT_TRUE(phys_world_set(world, "friction", rule));
    add(PHYS_STATIC, PHYS_BOX, core_v3(0, -1, 0), ground, 0);
    phys_body b = add(PHYS_DYNAMIC, PHYS_BOX, core_v3(0, 0.25f, 0), mine, 0);
    phys_body_set_velocity(world, b, core_v3(2, 0, 0));
    core_vec3 p;
    run(240);
    phys_body_position(world, b, &p);
    return 4.0f / (2.0f * 9.81f * p.x);
}
static void test_friction_rules(void) {
    TEST_ASSERT_FLOAT_WITHIN(0.006f, 0.2f, slide("product", 0.8f, 0.25f)); // the report's
    TEST_ASSERT_FLOAT_WITHIN(0.01f, sqrtf(0.2f), slide("geometric", 0.8f, 0.25f));
    TEST_ASSERT_FLOAT_WITHIN(0.015f, 0.525f, slide("average", 0.8f, 0.25f));
    TEST_ASSERT_FLOAT_WITHIN(0.008f, 0.25f, slide("least", 0.8f, 0.25f));
    TEST_ASSERT_FLOAT_WITHIN(0.03f, 0.8f, slide("most", 0.8f, 0.25f));
    TEST_ASSERT_FALSE(phys_world_set(world, "restitution", "sum"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "expected default, product, geometric"));
}

// A block that rests on a slope slides off when the material of the contact changes.
static void test_material_changes_at_once(void) {
    add(PHYS_STATIC, PHYS_BOX, core_v3(0, -1, 0), 1, 0);
    phys_body b = add(PHYS_DYNAMIC, PHYS_BOX, core_v3(0, 0.25f, 0), 1, 0);
    phys_world_set_gravity(world, core_v3(4, -9, 0));
    run(120);
    core_vec3 p;
    phys_body_position(world, b, &p);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.0f, p.x);
    TEST_ASSERT_TRUE(phys_body_set_material(world, b, &(phys_material){0.0f, 0.5f, 0.25f}));
    run(60);
    phys_body_position(world, b, &p);
    TEST_ASSERT_FLOAT_WITHIN(0.06f, 2.0f, p.x); // 4 m/s^2 for 1 s
    phys_material m;
    phys_shape_type type;
    TEST_ASSERT_TRUE(phys_body_shape(world, b, 0, &type, &m));
    TEST_ASSERT_EQUAL_INT(PHYS_BOX, type);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, m.restitution);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, m.rolling);
    TEST_ASSERT_FALSE(phys_body_set_material(world, b, &(phys_material){0.5f, 1.5f, 0}));
    TEST_ASSERT_FALSE(phys_body_shape(world, b, 1, &type, &m));
    TEST_ASSERT_EQUAL_STRING("phys body: shape 1, expected less than 1", core_last_error());
}

static void test_impulse_at_the_middle_adds_no_spin(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_body b = add(PHYS_DYNAMIC, PHYS_BOX, core_v3(0, 5, 0), 0.5f, 0);
    float mass = phys_body_mass(world, b); // 1 x 0.5 x 1 m of water
    TEST_ASSERT_EQUAL_FLOAT(500.0f, mass);
    core_vec3 v, w;
    phys_body_apply_impulse(world, b, core_v3(1000, 0, 0), core_v3(0, 5, 0));
    phys_body_velocity(world, b, &v);
    phys_body_angular_velocity(world, b, &w);
    TEST_ASSERT_EQUAL_FLOAT(2.0f, v.x);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, core_v3_length(w));
    // At an arm: L = r x J, w = L / I with I = m (1 + 1) / 12 about y.
    phys_body_apply_impulse(world, b, core_v3(0, 0, -100), core_v3(0.5f, 5, 0));
    phys_body_angular_velocity(world, b, &w);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 50.0f / (500.0f / 6.0f), w.y);
    TEST_ASSERT_TRUE(phys_body_apply_torque(world, b, core_v3(0, -3000, 0)));
    run(1); // 3000 N m for a step
    phys_body_angular_velocity(world, b, &w);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.6f - 50.0f / (500.0f / 6.0f), w.y);
    TEST_ASSERT_FALSE(phys_body_apply_torque(world, b, core_v3(NAN, 0, 0)));
}

// A block at rest on the ground is thrown against it again: one hit, no second begin.
static void test_a_blow_in_touch_is_a_hit(void) {
    add(PHYS_STATIC, PHYS_BOX, core_v3(0, -1, 0), 0.5f, 0);
    phys_body b = add(PHYS_DYNAMIC, PHYS_BOX, core_v3(0, 0.25f, 0), 0.5f, 0);
    phys_body_settings s;
    phys_body_read(world, b, &s);
    s.contact_events = true;
    phys_body_write(world, b, &s);
    uint32_t begun = 0, hits = 0;
    for (int i = 0; i < 60; i++) {
        uint32_t n;
        if (i == 30) {
            phys_body_set_velocity(world, b, core_v3(0, -5, 0));
        }
        run(1);
        const phys_event *e = phys_world_events(world, &n);
        for (uint32_t k = 0; k < n; k++) {
            begun += e[k].kind == PHYS_CONTACT_BEGIN;
            if (e[k].kind == PHYS_CONTACT_HIT) {
                hits++;
                TEST_ASSERT_FLOAT_WITHIN(1e-3f, 5.0f, e[k].speed);
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, begun);
    TEST_ASSERT_EQUAL_UINT32(1, hits);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_settings_are_read_back);
    RUN_TEST(test_damping_follows_its_law);
    RUN_TEST(test_locked_axes_stay_exactly);
    RUN_TEST(test_friction_rules);
    RUN_TEST(test_material_changes_at_once);
    RUN_TEST(test_impulse_at_the_middle_adds_no_spin);
    RUN_TEST(test_a_blow_in_touch_is_a_hit);
    return UNITY_END();
}
