// Every shape rests on every ground where its geometry says, compounds balance, contacts of general
// convex shapes agree with closed forms, and hulls that cannot be are refused.
#include "core/log.h"
#include "phys/world.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static const float tetra[12] = {0, 1, 0, -1, -0.5f, -1, 1, -0.5f, -1, 0, -0.5f, 1};
static const float cube[24] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1,
                               -1, -1, 1,  1, -1, 1,  -1, 1, 1,  1, 1, 1};

static phys_shape_desc shape(phys_shape_type type) {
    phys_shape_desc s = phys_shape_desc_default(type);
    s.half = core_v3(0.5f, 0.25f, 0.4f);
    s.radius = 0.3f;
    s.half_height = 0.5f;
    s.points = cube;
    s.point_count = 8;
    return s;
}
static phys_body add(const phys_shape_desc *s, uint32_t n, phys_body_type type, core_vec3 at,
                     core_quat q) {
    phys_body_desc d = phys_body_desc_default();
    d.type = type;
    d.position = at;
    d.rotation = q;
    return phys_body_create(world, &d, s, n);
}
static core_vec3 at(phys_body b) {
    core_vec3 p = {0, 0, 0};
    phys_body_position(world, b, &p);
    return p;
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, 1.0f / 60.0f));
    }
}

static void test_each_shape_rests_on_each_ground(void) {
    const core_quat up = {0, 0, 0, 1}, lying = {0, 0, 0.70710678f, 0.70710678f};
    const struct {
        phys_shape_type type;
        core_quat q;
        float height; // of the centre above the ground
    } kind[] = {{PHYS_SPHERE, up, 0.3f},      {PHYS_BOX, up, 0.25f},
                {PHYS_CAPSULE, lying, 0.3f},  {PHYS_CYLINDER, up, 0.5f},
                {PHYS_CYLINDER, lying, 0.3f}, {PHYS_HULL, up, 1.0f}};
    phys_shape_desc ground[3] = {phys_shape_desc_default(PHYS_PLANE), shape(PHYS_BOX),
                                 shape(PHYS_HULL)};
    ground[1].half = core_v3(3, 1, 3);
    for (int g = 0; g < 3; g++) {
        for (size_t k = 0; k < CORE_COUNT_OF(kind); k++) {
            core_vec3 c = {20.0f * (float)g, 0, 10.0f * (float)k};
            core_vec3 low = core_v3(c.x, g == 0 ? 0.0f : -1.0f, c.z);
            add(&ground[g], 1, PHYS_STATIC, low, up);
            phys_shape_desc s = shape(kind[k].type);
            c.y = kind[k].height + 0.05f;
            phys_body b = add(&s, 1, PHYS_DYNAMIC, c, kind[k].q);
            run(90);
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.001f, kind[k].height, at(b).y, "height at rest");
            phys_body_destroy(world, b);
        }
    }
    phys_accuracy a;
    phys_world_accuracy(world, &a);
    TEST_ASSERT_EQUAL_UINT32(0, a.nan);
}

static void test_capsule_pair_against_closed_form(void) {
    phys_geom a = phys_geom_make(PHYS_CAPSULE, core_v3(0, 0, 0), core_quat_identity(),
                                 core_v3(0, 1, 0), 0.25f);
    core_quat turned = core_quat_axis_angle(core_v3(0, 0, 1), 1.0f);
    phys_geom b = phys_geom_make(PHYS_CAPSULE, core_v3(0, 0, 0.7f), turned, core_v3(0, 1, 0), 0.5f);
    phys_manifold m = {0};
    phys_collide(&a, &b, 0.1f, &m);
    TEST_ASSERT_EQUAL_UINT32(1, m.count); // crossed lines 0.7 apart, radii 0.75 together
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -0.05f, m.point[0].separation);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f, m.normal.z);
    b.axes = a.axes;
    b.rotation = a.rotation;
    phys_collide(&a, &b, 0.1f, &m);
    TEST_ASSERT_EQUAL_UINT32(2, m.count); // side by side: both ends
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -0.05f, m.point[1].separation);
}

static void test_box_hull_agrees_with_box(void) {
    for (int i = 0; i < 200; i++) {
        float t = 0.1f * (float)i;
        core_quat qa = core_quat_axis_angle(core_v3(0.6f, 0.8f, 0), t);
        core_quat qb = core_quat_axis_angle(core_v3(0, 0.6f, 0.8f), 0.37f * t);
        core_vec3 to = {1.7f * sinf(t), 1.3f * cosf(1.3f * t), 0.9f};
        phys_geom a = phys_geom_make(PHYS_BOX, core_v3(0, 0, 0), qa, core_v3(1, 0.5f, 0.75f), 0);
        phys_geom b = phys_geom_make(PHYS_BOX, to, qb, core_v3(0.8f, 0.4f, 0.6f), 0);
        phys_manifold exact = {0}, general = {0};
        phys_collide(&a, &b, 0.02f, &exact);
        phys_collide_convex(&a, &b, 0.02f, &general);
        float d = 1e9f, e = 1e9f;
        for (uint32_t k = 0; k < exact.count; k++) {
            d = fminf(d, exact.point[k].separation);
        }
        for (uint32_t k = 0; k < general.count; k++) {
            e = fminf(e, general.point[k].separation);
        }
        if (d < 0.0f) { // apart, the two measure differently
            TEST_ASSERT_TRUE(general.count != 0);
            TEST_ASSERT_FLOAT_WITHIN(2e-3f, d, e);
        }
    }
}

static void test_compound_balances_on_its_centre_of_mass(void) {
    phys_shape_desc plane = phys_shape_desc_default(PHYS_PLANE);
    add(&plane, 1, PHYS_STATIC, core_v3(0, 0, 0), core_quat_identity());
    phys_shape_desc part[2] = {shape(PHYS_BOX), shape(PHYS_SPHERE)};
    part[0].half = core_v3(0.5f, 0.5f, 0.5f);
    part[0].position = core_v3(-1, 0, 0);
    part[1].radius = 0.5f;
    part[1].position = core_v3(1, 0, 0);
    phys_body b = add(part, 2, PHYS_DYNAMIC, core_v3(0, 0.6f, 0), core_quat_identity());
    float mass = 1000.0f * (1.0f + 4.0f / 3.0f * CORE_PI_F * 0.125f);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, mass, phys_body_mass(world, b));
    run(180);
    core_quat q;
    phys_body_rotation(world, b, &q);
    TEST_ASSERT_FLOAT_WITHIN(0.002f, 0.5f, at(b).y);
    TEST_ASSERT_FLOAT_WITHIN(0.002f, 1.0f, core_absf(q.w));
}

static void test_uneven_hull_finds_its_centre(void) {
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    phys_shape_desc s = shape(PHYS_HULL);
    s.points = tetra;
    s.point_count = 4;
    phys_body b = add(&s, 1, PHYS_DYNAMIC, core_v3(0, 0, 0), core_quat_identity());
    // Pushed through the centre of a tetrahedron, the mean of its corners, it does not turn.
    phys_body_apply_impulse(world, b, core_v3(0, 0, 500), core_v3(0, -0.125f, 0.5f));
    core_vec3 w;
    phys_body_angular_velocity(world, b, &w);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.0f, core_v3_length(w));
}

static void test_impossible_hulls_are_refused(void) {
    static const float flat[12] = {0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1};
    phys_shape_desc s = shape(PHYS_HULL);
    for (uint32_t n = 1; n <= 3; n++) {
        s.point_count = n;
        TEST_ASSERT_TRUE(
            core_handle_is_null(add(&s, 1, PHYS_DYNAMIC, core_v3(0, 0, 0), core_quat_identity())));
        TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "points"));
    }
    s.points = flat;
    s.point_count = 4;
    TEST_ASSERT_TRUE(
        core_handle_is_null(add(&s, 1, PHYS_DYNAMIC, core_v3(0, 0, 0), core_quat_identity())));
    TEST_ASSERT_EQUAL_UINT32(0, phys_body_count(world));
    s = shape(PHYS_CYLINDER);
    s.half_height = 0;
    TEST_ASSERT_TRUE(
        core_handle_is_null(add(&s, 1, PHYS_DYNAMIC, core_v3(0, 0, 0), core_quat_identity())));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "half_height"));
}

int main(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    UNITY_BEGIN();
    RUN_TEST(test_each_shape_rests_on_each_ground);
    RUN_TEST(test_capsule_pair_against_closed_form);
    RUN_TEST(test_box_hull_agrees_with_box);
    RUN_TEST(test_compound_balances_on_its_centre_of_mass);
    RUN_TEST(test_uneven_hull_finds_its_centre);
    RUN_TEST(test_impossible_hulls_are_refused);
    return UNITY_END();
}
