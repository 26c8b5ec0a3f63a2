// The scene room: entities, hierarchy, lazily made rooms, settings, sync, hash.
#include "scene/scene.h"

#include <math.h>
#include <string.h>

#include "core/log.h"
#include "unity.h"

static scene *s;
static core_metrics *metrics;

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    metrics = core_metrics_create();
    scene_desc desc = scene_desc_default();
    desc.metrics = metrics;
    desc.seed = 1;
    s = scene_create(&desc);
}

void tearDown(void) {
    scene_destroy(s);
    core_metrics_destroy(metrics);
}

static scene_entity spawn_at(float x, float y, float z, scene_entity parent) {
    scene_spawn_desc d = scene_spawn_desc_default();
    d.position = core_v3(x, y, z);
    d.parent = parent;
    return scene_spawn(s, &d);
}

static scene_entity spawn_ball(float y, const char *name) {
    phys_body_desc body = phys_body_desc_default();
    phys_shape_desc shape = phys_shape_desc_default(PHYS_SPHERE);
    shape.radius = 0.5f;
    scene_spawn_desc d = scene_spawn_desc_default();
    d.position = core_v3(0, y, 0);
    d.body = &body;
    d.shapes = &shape;
    d.shape_count = 1;
    d.name = name;
    return scene_spawn(s, &d);
}

static void assert_at(scene_entity e, float x, float y, float z) {
    core_vec3 p;
    TEST_ASSERT_TRUE(scene_position(s, e, &p));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, x, p.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, y, p.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, z, p.z);
}

static void rooms_are_made_at_first_touch(void) {
    TEST_ASSERT_NULL(scene_phys_if(s));
    TEST_ASSERT_NULL(scene_gfx_if(s));
    TEST_ASSERT_TRUE(scene_step(s));
    scene_sync_draw(s, 0.5f);
    scene_memory m = scene_memory_use(s);
    TEST_ASSERT_EQUAL_UINT64(0, m.phys + m.gfx + m.anim + m.nav + m.audio);
    phys_world *world = scene_phys(s);
    TEST_ASSERT_NOT_NULL(world);
    TEST_ASSERT_EQUAL_PTR(world, scene_phys(s));
    TEST_ASSERT_EQUAL_PTR(world, scene_phys_if(s));
    TEST_ASSERT_GREATER_THAN_UINT64(0, scene_memory_use(s).phys);
}

static void settings_are_kept_for_later_and_checked_at_once(void) {
    TEST_ASSERT_TRUE(scene_setting(s, "phys.substeps", "3"));
    TEST_ASSERT_NULL(scene_phys_if(s));
    TEST_ASSERT_FALSE(scene_setting(s, "phys.substepz", "3"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "substeps"));
    TEST_ASSERT_FALSE(scene_setting(s, "phys.substeps", "many"));
    TEST_ASSERT_FALSE(scene_setting(s, "kitchen.sink", "1"));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "kitchen"));
    TEST_ASSERT_FALSE(scene_setting(s, "substeps", "3"));
    TEST_ASSERT_NULL(scene_phys_if(s));
    TEST_ASSERT_NOT_NULL(scene_phys(s));
    TEST_ASSERT_TRUE(scene_setting(s, "phys.substeps", "2"));
}

static void handles_go_stale_and_are_caught(void) {
    scene_entity e = spawn_at(1, 2, 3, CORE_NULL_HANDLE);
    TEST_ASSERT_TRUE(scene_alive(s, e));
    TEST_ASSERT_TRUE(scene_despawn(s, e));
    TEST_ASSERT_FALSE(scene_alive(s, e));
    scene_entity again = spawn_at(0, 0, 0, CORE_NULL_HANDLE);
    TEST_ASSERT_EQUAL_UINT32(e.index, again.index);
    TEST_ASSERT_FALSE(core_handle_equal(e, again));
    core_vec3 p;
    TEST_ASSERT_FALSE(scene_position(s, e, &p));
    TEST_ASSERT_FALSE(scene_despawn(s, e));
    TEST_ASSERT_FALSE(scene_set_position(s, e, core_v3(0, 0, 0)));
    TEST_ASSERT_FALSE(scene_set_position(s, again, core_v3(NAN, 0, 0)));
    TEST_ASSERT_TRUE(core_handle_is_null(scene_entity_body(s, e)));
    TEST_ASSERT_EQUAL_STRING("", scene_entity_name(s, e));
}

static void bad_descriptions_make_nothing(void) {
    scene_spawn_desc d = {0};
    TEST_ASSERT_TRUE(core_handle_is_null(scene_spawn(s, &d)));
    d = scene_spawn_desc_default();
    d.position.x = INFINITY;
    TEST_ASSERT_TRUE(core_handle_is_null(scene_spawn(s, &d)));
    d = scene_spawn_desc_default();
    d.parent = (scene_entity){5, 5};
    TEST_ASSERT_TRUE(core_handle_is_null(scene_spawn(s, &d)));
    phys_body_desc body = phys_body_desc_default();
    phys_shape_desc shape = phys_shape_desc_default(PHYS_SPHERE);
    shape.radius = -1.0f;
    d = scene_spawn_desc_default();
    d.body = &body;
    d.shapes = &shape;
    d.shape_count = 1;
    d.name = "half";
    TEST_ASSERT_TRUE(core_handle_is_null(scene_spawn(s, &d)));
    TEST_ASSERT_EQUAL_UINT32(0, scene_entity_count(s));
    TEST_ASSERT_TRUE(core_handle_is_null(scene_find(s, "half")));
}

static void children_follow_turn_and_scale(void) {
    scene_entity a = spawn_at(10, 0, 0, CORE_NULL_HANDLE);
    scene_entity b = spawn_at(1, 0, 0, a);
    scene_entity c = spawn_at(0, 0, 2, b);
    assert_at(c, 11, 0, 2);
    // A quarter turn about +Y takes +X to -Z and +Z to +X.
    core_quat quarter = core_quat_axis_angle(core_v3(0, 1, 0), CORE_PI_F / 2);
    TEST_ASSERT_TRUE(scene_set_rotation(s, a, quarter));
    assert_at(b, 10, 0, -1);
    assert_at(c, 12, 0, -1);
    TEST_ASSERT_TRUE(scene_set_scale(s, a, core_v3(2, 2, 2)));
    assert_at(c, 14, 0, -2);
    TEST_ASSERT_TRUE(scene_set_position(s, a, core_v3(0, 5, 0)));
    assert_at(c, 4, 5, -2);
    TEST_ASSERT_TRUE(scene_step(s));
    assert_at(c, 4, 5, -2);
}

static void a_new_parent_keeps_the_world_pose(void) {
    scene_entity a = spawn_at(3, 0, 0, CORE_NULL_HANDLE);
    scene_set_rotation(s, a, core_quat_axis_angle(core_v3(0, 0, 1), 0.7f));
    scene_entity b = spawn_at(1, 2, 3, CORE_NULL_HANDLE);
    scene_entity c = spawn_at(0, 1, 0, b);
    TEST_ASSERT_TRUE(scene_set_parent(s, b, a));
    assert_at(b, 1, 2, 3);
    assert_at(c, 1, 3, 3);
    scene_step(s);
    assert_at(c, 1, 3, 3);
    TEST_ASSERT_FALSE(scene_set_parent(s, a, c));
    TEST_ASSERT_FALSE(scene_set_parent(s, a, a));
    TEST_ASSERT_TRUE(scene_set_parent(s, b, CORE_NULL_HANDLE));
    TEST_ASSERT_TRUE(scene_despawn(s, a));
    assert_at(c, 1, 3, 3);
}

static void a_chain_of_ten_thousand_does_not_recurse(void) {
    scene_entity first = spawn_at(0, 1, 0, CORE_NULL_HANDLE), last = first;
    for (int i = 1; i < 10000; i++) {
        last = spawn_at(0, 1, 0, last);
    }
    assert_at(last, 0, 10000, 0);
    scene_set_position(s, first, core_v3(7, 1, 0));
    assert_at(last, 7, 10000, 0);
    TEST_ASSERT_TRUE(scene_step(s));
    TEST_ASSERT_TRUE(scene_despawn(s, first));
    TEST_ASSERT_EQUAL_UINT32(0, scene_entity_count(s));
    TEST_ASSERT_FALSE(scene_alive(s, last));
}

// A thousand children of things at rest, ten below a ball that falls: ten are placed a step.
static void only_what_moved_moves_its_children(void) {
    scene_entity still = spawn_at(1, 0, 0, CORE_NULL_HANDLE), ball = spawn_ball(9, "ball");
    scene_entity child[1000], below[10];
    for (int i = 0; i < 1000; i++) {
        child[i] = spawn_at(0, 1, 0, i % 100 ? child[i - 1] : still);
    }
    for (int i = 0; i < 10; i++) {
        below[i] = spawn_at(0, 0.1f, 0, i ? below[i - 1] : ball);
    }
    scene_step(s);
    scene_step(s);
    TEST_ASSERT_EQUAL_UINT32(10, scene_moved(s));
    core_vec3 top, p;
    TEST_ASSERT_TRUE(scene_position(s, ball, &top) && scene_position(s, below[9], &p));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f, p.y - top.y); // the ball does not turn
    TEST_ASSERT_TRUE(top.y < 9.0f);
    scene_set_position(s, still, core_v3(5, 0, 0));
    assert_at(child[999], 5, 100, 0);
    scene_step(s);
    TEST_ASSERT_EQUAL_UINT32(1010, scene_moved(s));
    TEST_ASSERT_TRUE(scene_set_parent(s, child[100], ball));
    scene_step(s);
    TEST_ASSERT_EQUAL_UINT32(110, scene_moved(s));
    // Stopped in the air, it rests.
    phys_world_set_gravity(scene_phys(s), core_v3(0, 0, 0));
    phys_body_set_velocity(scene_phys(s), scene_entity_body(s, ball), core_v3(0, 0, 0));
    scene_step(s);
    scene_step(s);
    TEST_ASSERT_EQUAL_UINT32(0, scene_moved(s));
}

static void despawn_takes_the_subtree_and_nothing_else(void) {
    scene_entity root = spawn_at(0, 0, 0, CORE_NULL_HANDLE), kept = spawn_at(1, 0, 0, root);
    scene_entity gone = spawn_at(2, 0, 0, root), below[20];
    for (int i = 0; i < 20; i++) {
        below[i] = spawn_at(0, (float)i, 0, i % 3 ? below[i - 1] : gone);
    }
    scene_entity ball = spawn_ball(9, "ball");
    TEST_ASSERT_TRUE(scene_set_parent(s, ball, below[7]));
    phys_body body = scene_entity_body(s, ball);
    TEST_ASSERT_TRUE(scene_despawn(s, gone));
    TEST_ASSERT_EQUAL_UINT32(2, scene_entity_count(s));
    TEST_ASSERT_TRUE(scene_alive(s, root) && scene_alive(s, kept));
    TEST_ASSERT_FALSE(phys_body_alive(scene_phys(s), body));
    assert_at(kept, 1, 0, 0);
    scene_step(s);
    assert_at(kept, 1, 0, 0);
}

static void bodies_lead_their_entities(void) {
    scene_entity ball = spawn_ball(100, "ball");
    scene_entity rider = spawn_at(0, 1, 0, ball);
    for (int i = 0; i < 60; i++) {
        TEST_ASSERT_TRUE(scene_step(s));
    }
    core_vec3 p, b;
    scene_position(s, ball, &p);
    phys_body_position(scene_phys(s), scene_entity_body(s, ball), &b);
    TEST_ASSERT_EQUAL_FLOAT(b.y, p.y);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 100.0f - 0.5f * 9.81f, p.y);
    assert_at(rider, p.x, p.y + 1, p.z);
    TEST_ASSERT_TRUE(core_handle_equal(ball, scene_entity_of_body(s, scene_entity_body(s, ball))));
    TEST_ASSERT_TRUE(scene_set_position(s, ball, core_v3(5, 5, 5)));
    phys_body_position(scene_phys(s), scene_entity_body(s, ball), &b);
    TEST_ASSERT_EQUAL_FLOAT(5, b.x);
    assert_at(rider, 5, 6, 5);
    phys_body_destroy(scene_phys(s), scene_entity_body(s, ball));
    TEST_ASSERT_TRUE(scene_step(s));
    assert_at(ball, 5, 5, 5);
    TEST_ASSERT_TRUE(core_handle_is_null(scene_entity_body(s, ball)));
}

static void names(void) {
    scene_entity a = spawn_ball(1, "twin");
    spawn_ball(3, "twin");
    TEST_ASSERT_EQUAL_STRING("twin", scene_entity_name(s, a));
    TEST_ASSERT_TRUE(core_handle_equal(a, scene_find(s, "twin")));
    TEST_ASSERT_TRUE(core_handle_is_null(scene_find(s, "nobody")));
    scene_despawn(s, a);
    TEST_ASSERT_FALSE(core_handle_is_null(scene_find(s, "twin")));
    char text[128];
    const core_columns *set[64];
    int count = scene_state(s, set, 64);
    for (int i = 0; i < count; i++) {
        if (strcmp(set[i]->name, "phys.bodies") == 0) {
            scene_describe_row(s, set[i], 0, text, sizeof text);
            TEST_ASSERT_EQUAL_STRING("phys.bodies row 0 (entity 'twin', handle 2:1)", text);
            scene_describe_row(s, set[i], 99, text, sizeof text);
            TEST_ASSERT_EQUAL_STRING("phys.bodies (no single row)", text);
        }
    }
}

static void the_hash_hears_every_change(void) {
    uint64_t h0 = scene_hash(s);
    scene_entity a = spawn_at(1, 0, 0, CORE_NULL_HANDLE);
    uint64_t h1 = scene_hash(s);
    TEST_ASSERT_TRUE(h1 != h0);
    TEST_ASSERT_EQUAL_UINT64(h1, scene_hash(s));
    scene_set_position(s, a, core_v3(1, 0, 1e-6f));
    TEST_ASSERT_TRUE(scene_hash(s) != h1);
    scene_set_position(s, a, core_v3(1, 0, 0));
    TEST_ASSERT_EQUAL_UINT64(h1, scene_hash(s));
    core_rng_u64(scene_rng(s, CORE_RNG_VIEW));
    TEST_ASSERT_EQUAL_UINT64(h1, scene_hash(s));
    core_rng_u64(scene_rng(s, CORE_RNG_SIM));
    TEST_ASSERT_TRUE(scene_hash(s) != h1);
    uint64_t h2 = scene_hash(s);
    scene_step(s);
    TEST_ASSERT_TRUE(scene_hash(s) != h2);
}

static void steps_allocate_nothing_after_warm_up(void) {
    for (int i = 0; i < 30; i++) {
        scene_entity ball = spawn_ball(2.0f + 1.1f * (float)i, NULL);
        spawn_at(0, 1, 0, ball);
    }
    for (int i = 0; i < 60; i++) { // until all have met
        scene_step(s);
    }
    uint64_t before = core_alloc_count();
    for (int i = 0; i < 20; i++) {
        scene_step(s);
    }
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
}

static void storms_of_spawns_leave_no_trace(void) {
    for (int round = 0; round < 3; round++) {
        scene_entity made[5000];
        for (int i = 0; i < 5000; i++) {
            made[i] = spawn_at((float)i, 0, 0, i % 5 ? made[i - 1] : CORE_NULL_HANDLE);
        }
        scene_step(s);
        for (int i = 0; i < 5000; i += 5) {
            TEST_ASSERT_TRUE(scene_despawn(s, made[i]));
        }
        TEST_ASSERT_EQUAL_UINT32(0, scene_entity_count(s));
    }
    size_t bytes = scene_memory_use(s).core;
    spawn_at(0, 0, 0, CORE_NULL_HANDLE);
    TEST_ASSERT_EQUAL_UINT64(bytes, scene_memory_use(s).core);
}

static void configure_only_before_the_beginning(void) {
    TEST_ASSERT_TRUE(scene_configure(s, NULL, 9, 0.01f));
    TEST_ASSERT_EQUAL_FLOAT(0.01f, scene_dt(s));
    TEST_ASSERT_FALSE(scene_configure(s, NULL, 9, 0.0f));
    TEST_ASSERT_FALSE(scene_configure(s, NULL, 9, NAN));
    spawn_at(0, 0, 0, CORE_NULL_HANDLE);
    TEST_ASSERT_FALSE(scene_configure(s, NULL, 9, 0.02f));
}

static void interpolation_is_drawn_between_two_steps_and_reset_by_teleport(void) {
    gfx_instance_desc draw = {0};
    draw.mesh = gfx_mesh_builtin(scene_gfx(s), "box");
    phys_body_desc body = phys_body_desc_default();
    phys_shape_desc shape = phys_shape_desc_default(PHYS_SPHERE);
    body.velocity = core_v3(6, 0, 0);
    shape.radius = 0.5f;
    scene_spawn_desc d = scene_spawn_desc_default();
    d.body = &body;
    d.shapes = &shape;
    d.shape_count = 1;
    d.draw = &draw;
    phys_world_set_gravity(scene_phys(s), core_v3(0, 0, 0));
    scene_entity e = scene_spawn(s, &d);
    core_vec3 t;
    core_quat q;
    scene_step(s);
    scene_step(s);
    scene_sync_draw(s, 0.0f);
    TEST_ASSERT_TRUE(scene_draw_pose(s, e, 0.0f, &t, &q));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.1f, t.x);
    scene_sync_draw(s, 0.25f);
    TEST_ASSERT_TRUE(scene_draw_pose(s, e, 0.25f, &t, &q));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.125f, t.x);
    scene_set_position(s, e, core_v3(50, 0, 0));
    scene_sync_draw(s, 0.0f);
    TEST_ASSERT_TRUE(scene_draw_pose(s, e, 0.0f, &t, &q));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 50.0f, t.x);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(rooms_are_made_at_first_touch);
    RUN_TEST(settings_are_kept_for_later_and_checked_at_once);
    RUN_TEST(handles_go_stale_and_are_caught);
    RUN_TEST(bad_descriptions_make_nothing);
    RUN_TEST(children_follow_turn_and_scale);
    RUN_TEST(a_new_parent_keeps_the_world_pose);
    RUN_TEST(a_chain_of_ten_thousand_does_not_recurse);
    RUN_TEST(only_what_moved_moves_its_children);
    RUN_TEST(despawn_takes_the_subtree_and_nothing_else);
    RUN_TEST(bodies_lead_their_entities);
    RUN_TEST(names);
    RUN_TEST(the_hash_hears_every_change);
    RUN_TEST(steps_allocate_nothing_after_warm_up);
    RUN_TEST(storms_of_spawns_leave_no_trace);
    RUN_TEST(configure_only_before_the_beginning);
    RUN_TEST(interpolation_is_drawn_between_two_steps_and_reset_by_teleport);
    return UNITY_END();
}
