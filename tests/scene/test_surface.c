// Surfaces made from the bodies of the physics world: no way touches a body for the agent's
// capsule, and changes of bodies give the surface that a new one would have.
#include <math.h>

#include "core/rng.h"
#include "scene/scene.h"
#include "unity.h"

static scene *world;

void setUp(void) {
    scene_desc d = scene_desc_default();
    world = scene_create(&d);
}
void tearDown(void) {
    scene_destroy(world);
    core_clear_error();
}

static phys_body add(phys_body_type type, const phys_shape_desc *shape, core_vec3 at, core_quat q) {
    phys_body_desc b = phys_body_desc_default();
    b.type = type;
    b.position = at;
    b.rotation = q;
    phys_body body = phys_body_create(scene_phys(world), &b, shape, 1);
    TEST_ASSERT_FALSE(core_handle_is_null(body));
    return body;
}
static phys_body add_box(phys_body_type type, core_vec3 at, core_vec3 half, core_quat q) {
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = half;
    return add(type, &s, at, q);
}
static phys_body ground(void) {
    return add_box(PHYS_STATIC, core_v3(0, -0.5f, 0), core_v3(15, 0.5f, 15),
                   (core_quat){0, 0, 0, 1});
}

// Boxes at any angle, cylinders, spheres and leaning capsules, all too high to step on.
static phys_body obstacle(core_rng *rng) {
    core_vec3 at = {24 * core_rng_float(rng) - 12, 1, 24 * core_rng_float(rng) - 12};
    core_quat turn = core_quat_axis_angle(core_v3(0, 1, 0), 6.28f * core_rng_float(rng));
    switch (core_rng_below(rng, 4)) {
    case 0: {
        phys_shape_desc s = phys_shape_desc_default(PHYS_CYLINDER);
        s.radius = 0.3f + core_rng_float(rng), s.half_height = 1;
        return add(PHYS_STATIC, &s, at, turn);
    }
    case 1: {
        phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
        s.radius = 0.5f + core_rng_float(rng);
        return add(PHYS_STATIC, &s, at, turn);
    }
    case 2: {
        phys_shape_desc s = phys_shape_desc_default(PHYS_CAPSULE);
        s.radius = 0.3f, s.half_height = 1.5f;
        core_quat lean = core_quat_axis_angle(core_v3(1, 0, 0), 0.6f);
        return add(PHYS_STATIC, &s, at, core_quat_mul(turn, lean));
    }
    default: {
        float z = 0.1f + core_rng_float(rng); // one by one: arguments have no order
        return add_box(PHYS_STATIC, at, core_v3(0.2f + 2 * core_rng_float(rng), 1, z), turn);
    }
    }
}

// The agent's capsule, from above the highest step to its full height.
static bool touches(const scene_surface_desc *d, core_vec3 a, core_vec3 b) {
    phys_shape_desc capsule = phys_shape_desc_default(PHYS_CAPSULE);
    capsule.radius = d->nav.agent_radius - d->tolerance;
    float low = d->nav.max_climb + 0.01f, height = d->nav.agent_height;
    capsule.half_height = 0.5f * (height - low) - capsule.radius;
    core_vec3 from = {a.x, a.y + 0.5f * (low + height), a.z};
    phys_hit hit;
    phys_world_cast(scene_phys(world), &capsule, from, (core_quat){0, 0, 0, 1}, core_v3_sub(b, a),
                    NULL, &hit);
    return hit.hit;
}

static void ways_touch_nothing(void) {
    core_rng rng = core_rng_make(17, 1);
    ground();
    for (int i = 0; i < 60; i++) {
        obstacle(&rng);
    }
    scene_surface_desc d = scene_surface_desc_default();
    d.nav.cell_size = 0.1f;
    d.nav.agent_radius = 0.4f;
    nav_mesh m = scene_surface_create(world, &d);
    TEST_ASSERT_FALSE(core_handle_is_null(m));
    int found = 0, pieces = 0;
    for (int i = 0; i < 300; i++) {
        core_vec3 a = {28 * core_rng_float(&rng) - 14, 0, 28 * core_rng_float(&rng) - 14}, p[64];
        core_vec3 b = {28 * core_rng_float(&rng) - 14, 0, 28 * core_rng_float(&rng) - 14};
        nav_result r;
        nav_mesh_search(scene_nav(world), m, a, b, &r, p, 64);
        if (r.status != NAV_FOUND || p[0].y > 0.1f) {
            continue; // inside a body, or on its top
        }
        found++;
        for (uint32_t k = 1; k < r.count && k < 64; k++) {
            TEST_ASSERT_FALSE(touches(&d, p[k - 1], p[k]));
            pieces++;
        }
    }
    TEST_ASSERT_TRUE(found > 150 && pieces > 500);
}

static uint64_t fresh_hash(const scene_surface_desc *d) {
    nav_mesh m = scene_surface_create(world, d);
    uint64_t hash = nav_mesh_hash(scene_nav(world), m);
    nav_mesh_destroy(scene_nav(world), m);
    return hash;
}

static void surfaces_follow_bodies(void) {
    core_rng rng = core_rng_make(23, 1);
    ground();
    phys_body body[12];
    for (int i = 0; i < 12; i++) {
        body[i] = obstacle(&rng);
    }
    scene_surface_desc d = scene_surface_desc_default();
    d.nav.bounds = (core_aabb){{-15, 0, -15}, {15, 0, 15}};
    nav_mesh m = scene_surface_create(world, &d);
    uint64_t last = nav_mesh_hash(scene_nav(world), m);
    TEST_ASSERT_EQUAL_HEX64(last, fresh_hash(&d));
    for (int round = 0; round < 8; round++) {
        uint32_t i = core_rng_below(&rng, 12);
        if (round % 3 == 0) {
            phys_body_destroy(scene_phys(world), body[i]);
            body[i] = obstacle(&rng);
        } else {
            core_vec3 to = {20 * core_rng_float(&rng) - 10, 1, 20 * core_rng_float(&rng) - 10};
            phys_body_set_position(scene_phys(world), body[i], to);
        }
        for (int step = 0; step < 20; step++) {
            scene_step(world);
        }
        TEST_ASSERT_EQUAL_UINT32(0, nav_mesh_waiting(scene_nav(world), m));
        uint64_t now = nav_mesh_hash(scene_nav(world), m);
        TEST_ASSERT_TRUE(now != last);
        TEST_ASSERT_EQUAL_HEX64(fresh_hash(&d), now);
        last = now;
    }
}

// A kinematic door counts once it rests; a dynamic body never does.
static void doors_count_at_rest(void) {
    ground();
    add_box(PHYS_STATIC, core_v3(0, 1, -8), core_v3(0.2f, 1, 7), (core_quat){0, 0, 0, 1});
    add_box(PHYS_STATIC, core_v3(0, 1, 8), core_v3(0.2f, 1, 7), (core_quat){0, 0, 0, 1});
    phys_body door =
        add_box(PHYS_KINEMATIC, core_v3(0, 1, 0), core_v3(0.2f, 1, 1), (core_quat){0, 0, 0, 1});
    add_box(PHYS_DYNAMIC, core_v3(5, 1, 0), core_v3(1, 1, 1), (core_quat){0, 0, 0, 1});
    scene_surface_desc d = scene_surface_desc_default();
    d.kinematic = true;
    nav_mesh m = scene_surface_create(world, &d);
    nav_result r;
    core_vec3 a = {-8, 0, 0}, b = {8, 0, 0};
    nav_mesh_search(scene_nav(world), m, a, b, &r, NULL, 0);
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status);
    phys_body_set_velocity(scene_phys(world), door, core_v3(0, 0, 2)); // slides aside
    for (int i = 0; i < 60; i++) {
        scene_step(world);
    }
    nav_mesh_search(scene_nav(world), m, a, b, &r, NULL, 0);
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status); // where it last rested
    phys_body_set_velocity(scene_phys(world), door, core_v3(0, 0, 0));
    for (int i = 0; i < 30; i++) {
        scene_step(world);
    }
    nav_mesh_search(scene_nav(world), m, a, b, &r, NULL, 0);
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 16.0, r.cost);
}

// An agent leads a mover up steps and through a gap to its goal.
static void agents_lead_movers(void) {
    ground();
    core_quat level = {0, 0, 0, 1};
    for (int i = 0; i < 6; i++) {
        float top = 0.25f * (float)(i + 1);
        add_box(PHYS_STATIC, core_v3(2.0f + 0.5f * (float)i, 0.5f * top, 0),
                core_v3(0.25f, 0.5f * top, 2), level);
    }
    add_box(PHYS_STATIC, core_v3(8, 0.75f, 0), core_v3(3.25f, 0.75f, 2), level);
    phys_mover_desc md = phys_mover_desc_default();
    md.position = core_v3(-8, 0.9f, 1);
    phys_mover mover = phys_mover_create(scene_phys(world), &md);
    scene_surface_desc d = scene_surface_desc_default();
    d.nav.cell_size = 0.1f;
    d.nav.max_climb = 0.3f;
    nav_mesh m = scene_surface_create(world, &d);
    nav_agent_desc ad = nav_agent_desc_default();
    ad.position = core_v3(-8, 0, 1);
    nav_agent agent = nav_agent_create(scene_nav(world), &ad);
    TEST_ASSERT_TRUE(scene_lead_mover(world, agent, mover, 0.9f));
    TEST_ASSERT_TRUE(nav_agent_go_on_mesh(scene_nav(world), agent, m, core_v3(9, 1.5f, 1)));
    for (int i = 0; i < 60 * 15; i++) {
        scene_step(world);
    }
    phys_mover_state state;
    phys_mover_read(scene_phys(world), mover, &state);
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(scene_nav(world), agent));
    TEST_ASSERT_FLOAT_WITHIN(0.15f, 9, state.position.x);
    TEST_ASSERT_FLOAT_WITHIN(0.15f, 1, state.position.z);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 2.4f, state.position.y);
    TEST_ASSERT_EQUAL_INT(PHYS_MOVER_GROUND, state.ground);
    TEST_ASSERT_TRUE(phys_mover_destroy(scene_phys(world), mover));
    TEST_ASSERT_TRUE(scene_step(world));
    TEST_ASSERT_FALSE(scene_lead_mover(world, agent, mover, 0.9f));
}

static void bad_surfaces(void) {
    scene_surface_desc raw = {0}, d = scene_surface_desc_default();
    TEST_ASSERT_TRUE(core_handle_is_null(scene_surface_create(world, &raw)));
    d.tolerance = -1;
    TEST_ASSERT_TRUE(core_handle_is_null(scene_surface_create(world, &d)));
    d = scene_surface_desc_default();
    d.nav.cell_size = 1e-3f;
    d.nav.bounds = (core_aabb){{-1e5f, 0, -1e5f}, {1e5f, 0, 1e5f}};
    TEST_ASSERT_TRUE(core_handle_is_null(scene_surface_create(world, &d)));
    d = scene_surface_desc_default();
    nav_mesh m = scene_surface_create(world, &d); // no bodies
    TEST_ASSERT_EQUAL_DOUBLE(0.0, nav_mesh_area(scene_nav(world), m));
    TEST_ASSERT_TRUE(nav_mesh_destroy(scene_nav(world), m));
    ground();
    TEST_ASSERT_TRUE(scene_step(world));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(ways_touch_nothing);
    RUN_TEST(surfaces_follow_bodies);
    RUN_TEST(doors_count_at_rest);
    RUN_TEST(agents_lead_movers);
    RUN_TEST(bad_surfaces);
    return UNITY_END();
}
