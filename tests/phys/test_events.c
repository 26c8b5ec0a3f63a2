// Layers, triggers, contact events and fields: each visit told once, orbits that close.
#include "core/log.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>

#define DT (1.0f / 60.0f)

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static phys_body add_ball(core_vec3 at, float r, uint32_t layer, bool events) {
    phys_body_desc d = phys_body_desc_default();
    d.position = at;
    d.layer = layer;
    d.contact_events = events;
    phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
    s.radius = r;
    return phys_body_create(world, &d, &s, 1);
}
static phys_body add_floor(uint32_t layer) {
    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    d.position = core_v3(0, -1, 0);
    d.layer = layer;
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = core_v3(50, 1, 50);
    return phys_body_create(world, &d, &s, 1);
}
static phys_trigger add_trigger(float y, uint32_t layers) {
    phys_trigger_desc d = phys_trigger_desc_default(PHYS_BOX);
    d.position = core_v3(0, y, 0);
    d.half = core_v3(1, 1, 1);
    d.layers = layers;
    return phys_trigger_create(world, &d);
}
static core_vec3 at(phys_body b) {
    core_vec3 p = {0, 0, 0};
    phys_body_position(world, b, &p);
    return p;
}

static int seen[5];
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, DT));
        uint32_t n;
        const phys_event *e = phys_world_events(world, &n);
        for (uint32_t k = 0; k < n; k++) {
            seen[e[k].kind]++;
        }
    }
}
static void forget(void) {
    for (int i = 0; i < 5; i++) {
        seen[i] = 0;
    }
}

static void test_rules_are_symmetric_and_open_a_floor(void) {
    add_floor(3);
    phys_body b = add_ball(core_v3(0, 0.5f, 0), 0.5f, 5, false);
    run(30);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 0.5f, at(b).y);
    TEST_ASSERT_TRUE(phys_world_set_rule(world, 5, 3, false));
    TEST_ASSERT_FALSE(phys_world_rule(world, 3, 5));
    TEST_ASSERT_TRUE(phys_world_rule(world, 3, 4));
    run(30);
    TEST_ASSERT_TRUE(at(b).y < -0.5f);
    TEST_ASSERT_FALSE(phys_world_set_rule(world, 5, 32, true));
}

static void test_each_visit_is_told_once(void) {
    forget();
    add_trigger(5, 0);
    add_trigger(5, 1u << 7); // sees another layer: stays silent
    phys_body b = add_ball(core_v3(0, 9, 0), 0.25f, 0, false);
    int inside = 0;
    for (int i = 0; i < 180; i++) {
        run(1);
        float y = at(b).y;
        inside += y < 6.25f && y > 3.75f;
    }
    TEST_ASSERT_EQUAL_INT(1, seen[PHYS_TRIGGER_ENTER]);
    TEST_ASSERT_EQUAL_INT(1, seen[PHYS_TRIGGER_EXIT]);
    TEST_ASSERT_EQUAL_INT(inside - 1, seen[PHYS_TRIGGER_STAY]);
}

static void test_exit_is_told_when_either_side_is_destroyed(void) {
    forget();
    phys_trigger t = add_trigger(0, 0);
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_body a = add_ball(core_v3(0, 0, 0), 0.1f, 0, false);
    add_ball(core_v3(0.5f, 0, 0), 0.1f, 0, false);
    run(3);
    TEST_ASSERT_EQUAL_INT(2, seen[PHYS_TRIGGER_ENTER]);
    phys_body_destroy(world, a);
    run(2);
    TEST_ASSERT_EQUAL_INT(1, seen[PHYS_TRIGGER_EXIT]);
    add_ball(core_v3(0, 0, 0), 0.1f, 0, false); // takes over the slot: a visit of its own
    run(2);
    TEST_ASSERT_EQUAL_INT(3, seen[PHYS_TRIGGER_ENTER]);
    TEST_ASSERT_TRUE(phys_trigger_destroy(world, t));
    run(2);
    TEST_ASSERT_EQUAL_INT(3, seen[PHYS_TRIGGER_EXIT]);
    TEST_ASSERT_FALSE(phys_trigger_destroy(world, t));
}

static void test_contacts_begin_and_end_once(void) {
    forget();
    add_floor(0);
    phys_body b = add_ball(core_v3(0, 2, 0), 0.5f, 0, true);
    add_ball(core_v3(5, 2, 0), 0.5f, 0, false); // asked for no events
    run(120);
    TEST_ASSERT_EQUAL_INT(1, seen[PHYS_CONTACT_BEGIN]);
    TEST_ASSERT_EQUAL_INT(0, seen[PHYS_CONTACT_END]);
    phys_body_destroy(world, b);
    run(2);
    TEST_ASSERT_EQUAL_INT(1, seen[PHYS_CONTACT_END]);
}

static void test_orbit_in_a_point_field_closes(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_field_desc f = phys_field_desc_default(PHYS_FIELD_POINT);
    f.strength = 100.0f; // radius 4 m, speed 5 m/s: one turn in 2 pi 4 / 5 s
    TEST_ASSERT_TRUE(phys_field_alive(world, phys_field_create(world, &f)));
    phys_body b = add_ball(core_v3(4, 0, 0), 0.1f, 0, false);
    phys_body_set_velocity(world, b, core_v3(0, 5, 0));
    double low = 1e9, high = 0, turn = 2 * CORE_PI * 4 / 5;
    int steps = (int)(10 * turn * 60 + 0.5);
    for (int i = 0; i < steps; i++) {
        run(1);
        double r = hypot(at(b).x, at(b).y);
        low = fmin(low, r);
        high = fmax(high, r);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 4.0, low);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 4.0, high);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 4.0, at(b).x);
}

static void test_fields_add_and_keep_to_their_region(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_field_desc f = phys_field_desc_default(PHYS_FIELD_UNIFORM);
    f.acceleration = core_v3(1, 0, 0);
    phys_field everywhere = phys_field_create(world, &f);
    f.acceleration = core_v3(0, 2, 0);
    f.bounded = true;
    f.shape = PHYS_SPHERE;
    f.radius = 3;
    phys_field_create(world, &f);
    phys_body in = add_ball(core_v3(0, 0, 0), 0.1f, 0, false);
    phys_body out = add_ball(core_v3(0, 0, 9), 0.1f, 0, false);
    run(60);
    core_vec3 v, u;
    phys_body_velocity(world, in, &v);
    phys_body_velocity(world, out, &u);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f, v.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 2.0f, v.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f, u.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0f, u.y);
    TEST_ASSERT_TRUE(phys_field_destroy(world, everywhere));
    run(60);
    phys_body_velocity(world, out, &u);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f, u.x);
    f.cookie = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_field_create(world, &f)));
}

int main(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    UNITY_BEGIN();
    RUN_TEST(test_rules_are_symmetric_and_open_a_floor);
    RUN_TEST(test_each_visit_is_told_once);
    RUN_TEST(test_exit_is_told_when_either_side_is_destroyed);
    RUN_TEST(test_contacts_begin_and_end_once);
    RUN_TEST(test_orbit_in_a_point_field_closes);
    RUN_TEST(test_fields_add_and_keep_to_their_region);
    return UNITY_END();
}
