// Character movers: slope and step limits, sliding, platforms, pushing, room to stand up, and
// random walks that never get into a body.
#include "core/hash.h"
#include "core/log.h"
#include "phys/mover_walks.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEP (1.0f / 60.0f)

static phys_world *w;
static phys_mover hero;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    w = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(w); }

static void less_than(float limit, float value) {
    if (!(value < limit)) {
        printf("%g is not below %g\n", (double)value, (double)limit);
    }
    TEST_ASSERT_TRUE(value < limit);
}
static void more_than(float limit, float value) { less_than(-limit, -value); }

static phys_body add_box(core_vec3 at, core_vec3 half, core_quat turn, phys_body_type type,
                         float density) {
    phys_body_desc b = phys_body_desc_default();
    b.type = type;
    b.position = at;
    b.rotation = turn;
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = half;
    s.density = density;
    return phys_body_create(w, &b, &s, 1);
}
static phys_body add_static(core_vec3 at, core_vec3 half) {
    return add_box(at, half, core_quat_identity(), PHYS_STATIC, 0);
}
static void add_floor(void) { add_static(core_v3(0, -0.5f, 0), core_v3(50, 0.5f, 50)); }

static phys_mover add_mover(core_vec3 soles, float slope, float step) {
    phys_mover_desc d = phys_mover_desc_default();
    d.position = core_v3(soles.x, soles.y + d.half_height + d.radius + 0.01f, soles.z);
    d.slope_limit = slope > 0 ? slope : d.slope_limit;
    d.step_height = step >= 0 ? step : d.step_height;
    return hero = phys_mover_create(w, &d);
}
static phys_mover_state state(void) {
    phys_mover_state s;
    TEST_ASSERT_TRUE(phys_mover_read(w, hero, &s));
    return s;
}
static core_vec3 feet(void) {
    core_vec3 p = state().position;
    p.y -= 0.9f;
    return p;
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(w, STEP));
    }
}
static void walk(float x, float y, float z, int steps) {
    TEST_ASSERT_TRUE(phys_mover_walk(w, hero, core_v3(x, y, z)));
    run(steps);
}

static void test_stands_and_walks_at_its_wish(void) {
    add_floor();
    add_mover(core_v3(0, 0.5f, 0), 0, -1);
    run(60);
    TEST_ASSERT_EQUAL_INT(PHYS_MOVER_GROUND, state().ground);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 0.0f, feet().y);
    float x = feet().x;
    walk(3, 0, 0, 120);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, x + 6.0f, feet().x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 3.0f, state().velocity.x);
    walk(0, 0, 0, 60);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, x + 6.0f, feet().x);
}

// Uphill along +x from the origin, degrees.
static float climb(float slope, float limit) {
    tearDown();
    setUp();
    add_floor();
    float a = slope * CORE_PI_F / 180.0f;
    core_quat turn = core_quat_axis_angle(core_v3(0, 0, 1), a);
    core_vec3 up = core_quat_rotate(turn, core_v3(0, 1, 0));
    core_vec3 along = core_quat_rotate(turn, core_v3(1, 0, 0));
    core_vec3 at = core_v3_mad(core_v3_scale(along, 10.0f), up, -0.5f);
    add_box(at, core_v3(12, 0.5f, 5), turn, PHYS_STATIC, 0);
    add_mover(core_v3(-2, 0, 0), limit * CORE_PI_F / 180.0f, 0.3f);
    run(5);
    walk(3, 0, 0, 180);
    return feet().y;
}
static void test_slope_limit_within_a_degree(void) {
    for (float limit = 30; limit <= 60; limit += 15) {
        // 9 m of way, of which 2 lead to the foot of the slope.
        float rise = 6.5f * sinf((limit - 1) * CORE_PI_F / 180.0f);
        more_than(rise, climb(limit - 1, limit));
        less_than(0.2f, climb(limit + 1, limit));
    }
}

static float over_step(float height, float limit, float speed) {
    tearDown();
    setUp();
    add_floor();
    add_static(core_v3(5, height - 1, 0), core_v3(4, 1, 5));
    add_mover(core_v3(0, 0, 0), 0, limit);
    run(5);
    walk(speed, 0, 0, (int)(180.0f / speed));
    return feet().y;
}
static void test_step_limit_within_a_centimetre(void) {
    static const float limits[] = {0.05f, 0.2f, 0.3f, 0.45f};
    static const float speeds[] = {0.5f, 1.0f, 4.0f};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            float limit = limits[i];
            TEST_ASSERT_FLOAT_WITHIN(0.01f, limit - 0.01f,
                                     over_step(limit - 0.01f, limit, speeds[k]));
            TEST_ASSERT_FLOAT_WITHIN(0.01f, 0.0f, over_step(limit + 0.01f, limit, speeds[k]));
        }
    }
}

static void test_stairs_up_and_down_without_flight(void) {
    add_floor();
    for (int i = 0; i < 10; i++) { // up along +x, down again
        float h = 0.2f * (float)(i < 5 ? i + 1 : 10 - i);
        add_static(core_v3(2.0f + 0.4f * (float)i, h - 1, 0), core_v3(0.2f, 1, 3));
    }
    add_mover(core_v3(0, 0, 0), 0, 0.3f);
    run(5);
    phys_mover_walk(w, hero, core_v3(2, 0, 0));
    float top = 0;
    for (int i = 0; i < 240; i++) {
        run(1);
        TEST_ASSERT_EQUAL_INT(PHYS_MOVER_GROUND, state().ground);
        top = fmaxf(top, feet().y);
    }
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 1.0f, top);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 0.0f, feet().y);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 8.0f, feet().x);
}

static void test_slides_along_walls_and_stops_in_corners(void) {
    add_floor();
    add_static(core_v3(3, 1, 0), core_v3(0.5f, 1, 20));
    add_mover(core_v3(0, 0, 0), 0, -1);
    run(5);
    walk(2, 0, 2, 240); // 45 degrees into the wall: its part along the wall stays
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 2.2f, feet().x);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 8.0f, feet().z);
    add_static(core_v3(0, 1, 12), core_v3(20, 1, 0.5f));
    walk(2, 0, 2, 240);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 2.2f, feet().x);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 11.2f, feet().z);
    core_vec3 stuck = feet();
    walk(2, 0, 2, 60);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, stuck.x, feet().x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, stuck.z, feet().z);
    walk(-2, 0, -2, 60);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, stuck.x - 2.0f, feet().x);
}

static void test_no_speed_takes_it_through_a_thin_wall(void) {
    add_floor();
    add_static(core_v3(5, 2, 0), core_v3(0.005f, 2, 20));
    for (float speed = 1; speed <= 1000; speed *= 10) {
        add_mover(core_v3(0, 0, 0), 0, -1);
        run(2);
        walk(speed, 0, 0, speed > 9 ? 60 : 400);
        TEST_ASSERT_FLOAT_WITHIN(0.01f, 4.695f, feet().x);
        phys_mover_destroy(w, hero);
    }
}

static void test_rides_a_platform_that_moves_and_turns(void) {
    phys_body lift = add_box(core_v3(0, -0.25f, 0), core_v3(4, 0.25f, 4), core_quat_identity(),
                             PHYS_KINEMATIC, 0);
    add_mover(core_v3(2, 0, 0), 0, -1);
    run(30);
    core_vec3 start = feet();
    phys_body_set_velocity(w, lift, core_v3(1, 0.5f, -2));
    run(600);
    core_vec3 p;
    phys_body_position(w, lift, &p);
    TEST_ASSERT_FLOAT_WITHIN(0.001f, start.x + p.x, feet().x);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, start.y + p.y + 0.25f, feet().y);
    TEST_ASSERT_FLOAT_WITHIN(0.001f, start.z + p.z, feet().z);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 1.0f, state().velocity.x);
    // A turn of 2 pi brings it back to where it stood.
    phys_body_set_velocity(w, lift, core_v3(0, 0, 0));
    run(1);
    start = feet();
    float turned = 0;
    phys_body_set_angular_velocity(w, lift, core_v3(0, 2.0f * CORE_PI_F / 5.0f, 0));
    for (int i = 0; i < 300; i++) {
        run(1);
        turned += state().turn;
    }
    TEST_ASSERT_FLOAT_WITHIN(0.002f, 2.0f * CORE_PI_F, turned);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, start.x, feet().x);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, start.z, feet().z);
}

static void test_a_jump_keeps_the_platforms_speed_and_its_height(void) {
    phys_body cart = add_box(core_v3(0, -0.25f, 0), core_v3(40, 0.25f, 4), core_quat_identity(),
                             PHYS_KINEMATIC, 0);
    phys_body_set_velocity(w, cart, core_v3(3, 0, 0));
    add_mover(core_v3(0, 0, 0), 0, -1);
    run(30);
    core_vec3 start = feet(), p;
    phys_body_position(w, cart, &p);
    float seat = start.x - p.x, top = 0;
    TEST_ASSERT_TRUE(phys_mover_jump(w, hero, 4.0f));
    for (int i = 0; i < 60; i++) {
        run(1);
        top = fmaxf(top, feet().y);
    }
    phys_body_position(w, cart, &p);
    TEST_ASSERT_EQUAL_INT(PHYS_MOVER_GROUND, state().ground);
    TEST_ASSERT_FLOAT_WITHIN(0.04f, 4.0f * 4.0f / 2 / 9.81f, top); // v^2 / 2g
    TEST_ASSERT_FLOAT_WITHIN(0.02f, seat, feet().x - p.x);
}

// A box of 1 m on a floor of friction 0.5: it starts to slide at 0.5 m g.
static float push(float force, float mass) {
    tearDown();
    setUp();
    add_floor();
    phys_body b = add_box(core_v3(2, 0.5f, 0), core_v3(0.5f, 0.5f, 0.5f), core_quat_identity(),
                          PHYS_DYNAMIC, mass);
    phys_mover_desc d = phys_mover_desc_default();
    d.position = core_v3(0, 0.91f, 0);
    d.push_force = force;
    hero = phys_mover_create(w, &d);
    run(30);
    walk(1, 0, 0, 300);
    core_vec3 p;
    phys_body_position(w, b, &p);
    less_than(p.x - 0.795f, feet().x);
    return p.x - 2.0f;
}
static void test_pushes_with_its_force_and_no_more(void) {
    float need = 0.5f * 40.0f * 9.81f;
    less_than(0.02f, push(0.8f * need, 40.0f));
    float way = push(1.3f * need, 40.0f); // 3.8 s of walking at 1 m/s
    more_than(2.5f, way);
    less_than(4.0f, way);
    less_than(0.02f, push(500.0f, 1000.0f));
}

static void test_its_weight_tips_a_plank(void) {
    phys_body plank = add_box(core_v3(0, 1, 0), core_v3(3, 0.05f, 0.5f), core_quat_identity(),
                              PHYS_DYNAMIC, 100.0f); // 60 kg
    phys_joint_desc j = phys_joint_desc_default(PHYS_JOINT_REVOLUTE);
    j.a = plank;
    j.anchor = core_v3(0, 1, 0);
    j.axis = core_v3(0, 0, 1);
    phys_joint_create(w, &j);
    add_mover(core_v3(1, 1.05f, 0), 0, -1);
    run(40);
    core_quat q;
    phys_body_rotation(w, plank, &q);
    less_than(-0.02f, q.z); // its end goes down
}

static void test_stands_up_only_where_there_is_room(void) {
    add_floor();
    add_static(core_v3(0, 1.8f, 0), core_v3(2, 0.5f, 2)); // ceiling at 1.3 m
    phys_mover_desc d = phys_mover_desc_default();
    d.position = core_v3(0, 0.61f, 0);
    d.half_height = 0.3f;
    hero = phys_mover_create(w, &d);
    run(10);
    bool fits = true;
    TEST_ASSERT_TRUE(phys_mover_resize(w, hero, 0.3f, 0.6f, &fits));
    TEST_ASSERT_FALSE(fits);
    walk(3, 0, 0, 60);
    TEST_ASSERT_TRUE(phys_mover_resize(w, hero, 0.3f, 0.6f, &fits));
    TEST_ASSERT_TRUE(fits);
    run(1);
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 0.0f, feet().y);
    TEST_ASSERT_FALSE(phys_mover_resize(w, hero, -1.0f, 0.6f, &fits));
    walk(-3, 0, 0, 60); // and does not get under it standing
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 2.3f, feet().x);
}

static void test_slides_down_what_is_too_steep(void) {
    core_quat turn = core_quat_axis_angle(core_v3(0, 0, 1), CORE_PI_F / 3);
    add_box(core_v3(0, 0, 0), core_v3(20, 0.5f, 5), turn, PHYS_STATIC, 0);
    core_vec3 up = core_quat_rotate(turn, core_v3(0, 1, 0));
    phys_mover_desc d = phys_mover_desc_default();
    d.position = core_v3_mad(core_v3(0, 0.6f, 0), up, 0.81f);
    hero = phys_mover_create(w, &d);
    core_vec3 from = d.position;
    run(60);
    TEST_ASSERT_EQUAL_INT(PHYS_MOVER_STEEP, state().ground);
    // 1 s of g sin 60 without friction: 4.25 m along the slope.
    float way = core_v3_length(core_v3_sub(state().position, from));
    TEST_ASSERT_FLOAT_WITHIN(0.25f, 4.25f, way);
}

static void test_random_walks_never_get_into_a_body(void) { random_walks(w, 100); }

static uint64_t state_hash(void) {
    const core_columns *set[16];
    uint64_t h = 0, column[CORE_COLUMNS_MAX];
    int n = phys_world_state(w, set, 16);
    for (int i = 0; i < n; i++) {
        core_columns_hash(set[i], column);
        for (uint32_t k = 0; k < set[i]->column_count; k++) {
            h = core_hash_mix(h, column[k]);
        }
    }
    return h;
}

static void test_a_snapshot_goes_on_with_the_same_bits(void) {
    mess_seed = 3;
    build_mess(w);
    add_box(core_v3(0, 4, 0), core_v3(0.4f, 0.4f, 0.4f), core_quat_identity(), PHYS_DYNAMIC, 50);
    add_mover(core_v3(1, 3, 1), 0, -1);
    run(60);
    phys_mover_walk(w, hero, core_v3(2, 0, 1));
    run(10);
    size_t size = phys_world_save_size(w);
    void *data = malloc(size);
    phys_world_save(w, data);
    run(60);
    uint64_t went = state_hash();
    core_vec3 there = state().position;
    TEST_ASSERT_TRUE(phys_world_restore(w, data, size));
    run(60);
    TEST_ASSERT_EQUAL_HEX64(went, state_hash());
    TEST_ASSERT_EQUAL_FLOAT(there.x, state().position.x);
    free(data);
}

static void test_bad_input_is_refused(void) {
    phys_mover_desc d = phys_mover_desc_default();
    d.radius = -1;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_mover_create(w, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "radius is -1"));
    d = phys_mover_desc_default();
    d.position.x = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_mover_create(w, &d)));
    d = phys_mover_desc_default();
    d.cookie = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_mover_create(w, &d)));
    add_mover(core_v3(0, 0, 0), 0, -1);
    TEST_ASSERT_FALSE(phys_mover_walk(w, hero, core_v3(0, INFINITY, 0)));
    TEST_ASSERT_FALSE(phys_mover_jump(w, hero, 0));
    TEST_ASSERT_TRUE(phys_mover_destroy(w, hero));
    phys_mover_state s;
    TEST_ASSERT_FALSE(phys_mover_read(w, hero, &s));
    TEST_ASSERT_FALSE(phys_mover_destroy(w, hero));
    TEST_ASSERT_EQUAL_UINT32(0, phys_mover_count(w));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_stands_and_walks_at_its_wish);
    RUN_TEST(test_slope_limit_within_a_degree);
    RUN_TEST(test_step_limit_within_a_centimetre);
    RUN_TEST(test_stairs_up_and_down_without_flight);
    RUN_TEST(test_slides_along_walls_and_stops_in_corners);
    RUN_TEST(test_no_speed_takes_it_through_a_thin_wall);
    RUN_TEST(test_rides_a_platform_that_moves_and_turns);
    RUN_TEST(test_a_jump_keeps_the_platforms_speed_and_its_height);
    RUN_TEST(test_pushes_with_its_force_and_no_more);
    RUN_TEST(test_its_weight_tips_a_plank);
    RUN_TEST(test_stands_up_only_where_there_is_room);
    RUN_TEST(test_slides_down_what_is_too_steep);
    RUN_TEST(test_random_walks_never_get_into_a_body);
    RUN_TEST(test_a_snapshot_goes_on_with_the_same_bits);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
