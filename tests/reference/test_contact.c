// The contact reference against closed forms and invariants, then the engine against the reference.
#include "phys/phys.h"
#include "ref/contact.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static ref_world world;

void setUp(void) { world = (ref_world){.gravity = {0, -9.81, 0}}; }
void tearDown(void) {}

static int ground(double friction, double restitution) {
    return ref_world_add(
        &world, (ref_body){.shape = REF_PLANE, .friction = friction, .restitution = restitution});
}

static int ball(double x, double y, double speed, double friction, double restitution) {
    return ref_world_add(&world, (ref_body){.shape = REF_SPHERE,
                                            .radius = 0.5,
                                            .mass = 2,
                                            .friction = friction,
                                            .restitution = restitution,
                                            .p = {x, y, 0},
                                            .v = {speed, 0, 0}});
}

static int box(double x, double y, double speed, double friction) {
    return ref_world_add(&world, (ref_body){.shape = REF_BOX,
                                            .half = {0.5, 0.5, 0.5},
                                            .mass = 3,
                                            .friction = friction,
                                            .p = {x, y, 0},
                                            .v = {speed, 0, 0}});
}

static void test_rest_is_exact(void) {
    ground(0.5, 0);
    int a = ball(0, 0.5, 0, 0.5, 0), b = box(3, 0.5, 0, 0.5);
    ref_world_run(&world, 1, 1000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, world.body[a].p.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, world.body[b].p.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3, world.body[b].p.x);
}

static void test_a_block_slides_v2_over_2_mu_g(void) {
    ground(0.3, 0);
    int a = box(0, 0.5, 3, 0.3);
    ref_world_run(&world, 2, 4000);
    double want = 9.0 / (2 * 0.3 * 9.81);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * want, want, world.body[a].p.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, world.body[a].v.x);
}

static void test_a_sliding_ball_ends_rolling_at_five_sevenths(void) {
    ground(0.4, 0);
    int a = ball(0, 0.5, 7, 0.4, 0);
    ref_world_run(&world, 1, 2000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 5, world.body[a].v.x);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, -10, world.body[a].w.z);
}

static void test_a_ball_rolls_down_a_slope(void) {
    const double slope = 0.3;
    world.gravity = (ref_vec){9.81 * sin(slope), -9.81 * cos(slope), 0};
    ground(0.8, 0);
    int a = ball(0, 0.5, 0, 0.8, 0);
    ref_world_run(&world, 1, 4000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 5.0 / 7 * 9.81 * sin(slope), world.body[a].v.x);
}

static void test_a_block_slides_on_a_slope_above_the_angle_of_friction_only(void) {
    for (int above = 0; above < 2; above++) {
        double slope = atan(0.5) + (above ? 0.005 : -0.005);
        world = (ref_world){.gravity = {9.81 * sin(slope), -9.81 * cos(slope), 0}};
        ground(0.5, 0);
        int a = box(0, 0.5, 0, 0.5);
        ref_world_run(&world, 0.5, 1000);
        double pull = 9.81 * (sin(slope) - 0.5 * cos(slope));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, above ? 0.5 * pull : 0, world.body[a].v.x);
    }
}

static void test_a_bounce_keeps_the_share_it_should(void) {
    ground(0, 0.5);
    int a = ball(0, 1.5, 0, 0, 0.5);
    ref_world_run(&world, sqrt(2 / 9.81) * 1.5, 6000); // to the top of the first bounce
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.75, world.body[a].p.y);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0, world.body[a].v.y);
}

static void test_a_head_on_collision(void) {
    world.gravity = (ref_vec){0, 0, 0};
    int a = ball(0, 0, 3, 0, 0.8), b = ball(2, 0, -1, 0, 0.8);
    world.body[b].mass = 5;
    double energy = ref_world_energy(&world);
    ref_world_run(&world, 1, 2000);
    double va = world.body[a].v.x, vb = world.body[b].v.x;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2 * 3 - 5, 2 * va + 5 * vb);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.8 * 4, vb - va);
    TEST_ASSERT_TRUE(ref_world_energy(&world) < energy);
}

static void test_crooked_boxes_keep_momentum_and_do_not_sink(void) {
    world.gravity = (ref_vec){0, 0, 0};
    int a = box(0, 0, 2, 0.4), b = box(1.6, 0.4, -1, 0.4);
    world.body[b].q = (ref_quat){0.2, 0.3, 0.1, sqrt(1 - 0.14)};
    world.body[a].w = (ref_vec){0.5, -1, 0.7};
    ref_vec before = ref_world_momentum(&world);
    double energy = ref_world_energy(&world);
    int seen = 0;
    for (int i = 0; i < 100; i++) {
        ref_world_run(&world, 0.01, 20);
        seen += world.contacts;
    }
    ref_vec after = ref_world_momentum(&world);
    TEST_ASSERT_TRUE(seen > 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, before.x, after.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, before.y, after.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, before.z, after.z);
    TEST_ASSERT_TRUE(ref_world_energy(&world) < energy);
    TEST_ASSERT_TRUE(world.body[b].p.x > world.body[a].p.x);
}

static void test_a_stack_stands_and_its_impulses_converge(void) {
    ground(0.5, 0);
    for (int i = 0; i < 5; i++) {
        box(0, 0.5 + i, 0, 0.5);
    }
    ref_world_run(&world, 0.2, 200);
    TEST_ASSERT_TRUE(world.residual < 1e-11);
    for (int i = 1; i <= 5; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, i - 0.5, world.body[i].p.y);
    }
}

static void test_halving_the_step_halves_the_error(void) {
    double error[2];
    for (int k = 0; k < 2; k++) {
        setUp();
        ground(0.4, 0);
        int a = ball(0, 0.5, 7, 0.4, 0);
        ref_world_run(&world, 0.3, k ? 600 : 300); // still sliding: x = 7 t - mu g t^2 / 2
        error[k] = fabs(world.body[a].p.x - (7 * 0.3 - 0.5 * 0.4 * 9.81 * 0.09));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 2, error[0] / error[1]);
}

// ---- the engine against the reference ----

static phys_body add_body(phys_world *w, phys_shape_type type, core_vec3 at, core_vec3 speed,
                          phys_body_type kind) {
    phys_body_desc body = phys_body_desc_default();
    phys_shape_desc shape = phys_shape_desc_default(type);
    body.type = kind;
    body.position = at;
    body.velocity = speed;
    shape.radius = 0.5f;
    shape.half = kind == PHYS_STATIC ? core_v3(50, 1, 50) : core_v3(0.5f, 0.5f, 0.5f);
    shape.density = type == PHYS_SPHERE ? (float)(2 / (4.0 / 3 * 3.14159265 * 0.125)) : 3;
    shape.friction = 0.4f;
    return phys_body_create(w, &body, &shape, 1);
}

// A ball is rolled into a box that slides to rest: both for 1 s.
static void test_the_engine_follows_the_reference(void) {
    ground(0.4, 0);
    int ra = ball(0, 0.5, 6, 0.4, 0), rb = box(2.5, 0.5, 0, 0.4);
    ref_world_run(&world, 1, 8000);
    const char *const *names = phys_method_names("solver");
    for (; *names; names++) {
        phys_world_desc desc = phys_world_desc_default();
        desc.solver = *names;
        phys_world *w = phys_world_create(&desc);
        add_body(w, PHYS_BOX, core_v3(0, -1, 0), core_v3(0, 0, 0), PHYS_STATIC);
        phys_body a = add_body(w, PHYS_SPHERE, core_v3(0, 0.5f, 0), core_v3(6, 0, 0), PHYS_DYNAMIC);
        phys_body b = add_body(w, PHYS_BOX, core_v3(2.5f, 0.5f, 0), core_v3(0, 0, 0), PHYS_DYNAMIC);
        for (int i = 0; i < 480; i++) {
            phys_world_step(w, 1.0f / 480);
        }
        core_vec3 p, q;
        TEST_ASSERT_TRUE(phys_body_position(w, a, &p) && phys_body_position(w, b, &q));
        double near = strcmp(*names, "impulse") == 0 ? 0.15 : 0.05; // the report's: a baseline
        TEST_ASSERT_DOUBLE_WITHIN(near, world.body[ra].p.x, (double)p.x);
        TEST_ASSERT_DOUBLE_WITHIN(near, world.body[rb].p.x, (double)q.x);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, world.body[rb].p.y, (double)q.y);
        phys_world_destroy(w);
    }
    TEST_ASSERT_TRUE(world.body[rb].p.x > 2.6); // they met
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_rest_is_exact);
    RUN_TEST(test_a_block_slides_v2_over_2_mu_g);
    RUN_TEST(test_a_sliding_ball_ends_rolling_at_five_sevenths);
    RUN_TEST(test_a_ball_rolls_down_a_slope);
    RUN_TEST(test_a_block_slides_on_a_slope_above_the_angle_of_friction_only);
    RUN_TEST(test_a_bounce_keeps_the_share_it_should);
    RUN_TEST(test_a_head_on_collision);
    RUN_TEST(test_crooked_boxes_keep_momentum_and_do_not_sink);
    RUN_TEST(test_a_stack_stands_and_its_impulses_converge);
    RUN_TEST(test_halving_the_step_halves_the_error);
    RUN_TEST(test_the_engine_follows_the_reference);
    return UNITY_END();
}
