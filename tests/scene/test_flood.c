// The surface covers what the character mover can reach and nothing else: at the limits of slope,
// step and headroom, on thin floors, in storeys above one another.
#include <math.h>
#include <stdio.h>

#include "core/rng.h"
#include "scene/scene.h"
#include "unity.h"

static scene *world;
#define RADIUS 0.3f
#define HEIGHT 1.8f
#define STEP   0.3f
#define SLOPE  0.7853982f // 45 degrees

void setUp(void) {
    scene_desc d = scene_desc_default();
    world = scene_create(&d);
}
void tearDown(void) {
    scene_destroy(world);
    core_clear_error();
}

static void add(core_vec3 low, core_vec3 high) {
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = core_v3_scale(core_v3_sub(high, low), 0.5f);
    phys_body_desc b = phys_body_desc_default();
    b.type = PHYS_STATIC;
    b.position = core_v3_scale(core_v3_add(low, high), 0.5f);
    TEST_ASSERT_FALSE(core_handle_is_null(phys_body_create(scene_phys(world), &b, &s, 1)));
}
// A plank whose upper side rises along x from (x, y) by `rise` over `run`.
static void ramp(float x, float y, float z0, float z1, float run, float rise) {
    float length = hypotf(run, rise), angle = core_atan2f(rise, run), thick = 0.1f;
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = core_v3(0.5f * length, 0.5f * thick, 0.5f * (z1 - z0));
    phys_body_desc b = phys_body_desc_default();
    b.type = PHYS_STATIC;
    b.rotation = core_quat_axis_angle(core_v3(0, 0, 1), angle);
    float sine, cosine;
    core_sincosf(angle, &sine, &cosine);
    b.position = core_v3(x + 0.5f * run + 0.5f * thick * sine,
                         y + 0.5f * rise - 0.5f * thick * cosine, 0.5f * (z0 + z1));
    phys_body_create(scene_phys(world), &b, &s, 1);
}

static nav_mesh surface(void) {
    scene_surface_desc d = scene_surface_desc_default();
    d.nav.cell_size = 0.1f;
    d.nav.agent_radius = RADIUS, d.nav.agent_height = HEIGHT;
    d.nav.max_climb = STEP, d.nav.max_slope = SLOPE;
    nav_mesh m = scene_surface_create(world, &d);
    TEST_ASSERT_FALSE(core_handle_is_null(m));
    return m;
}
static phys_mover mover_at(core_vec3 feet) {
    phys_mover_desc d = phys_mover_desc_default();
    d.position = core_v3(feet.x, feet.y + 0.5f * HEIGHT, feet.z);
    d.radius = RADIUS, d.half_height = 0.5f * HEIGHT - RADIUS;
    d.step_height = STEP, d.slope_limit = SLOPE;
    phys_mover m = phys_mover_create(scene_phys(world), &d);
    TEST_ASSERT_FALSE(core_handle_is_null(m));
    return m;
}
static core_vec3 feet_of(phys_mover m, phys_mover_state *s) {
    phys_mover_read(scene_phys(world), m, s);
    return core_v3(s->position.x, s->position.y - 0.5f * HEIGHT, s->position.z);
}

// Whether the surface joins a to b, and whether a mover that walks along +x from a gets there.
static void compare(core_vec3 a, core_vec3 b, bool expected) {
    nav_result r;
    nav_mesh_search(scene_nav(world), surface(), a, b, &r, NULL, 0);
    TEST_ASSERT_EQUAL_INT(expected ? NAV_FOUND : NAV_NO_PATH, r.status);
    phys_mover m = mover_at(a);
    phys_mover_state s;
    core_vec3 p = a;
    phys_mover_walk(scene_phys(world), m, core_v3(1.5f, 0, 0));
    for (int i = 0; i < 60 * 12 && p.x < b.x; i++) {
        scene_step(world);
        p = feet_of(m, &s);
    }
    bool reached = p.x >= b.x && core_absf(p.y - b.y) < 0.1f;
    TEST_ASSERT_EQUAL_INT(expected, reached);
}

static void ground(void) { add(core_v3(-10, -1, -5), core_v3(10, 0, 5)); }

static void slope_of(float degrees, bool walked) {
    float rise = 3.0f * tanf(degrees * CORE_PI_F / 180.0f);
    ground();
    ramp(0, 0, -2, 2, 3, rise);
    add(core_v3(3, rise - 0.2f, -2), core_v3(9, rise, 2));
    compare(core_v3(-4, 0, 0), core_v3(6, rise, 0), walked);
}
static void slopes_below_the_limit(void) { slope_of(44, true); }
static void slopes_above_the_limit(void) { slope_of(46, false); }

static void step_of(float height, bool walked) {
    ground();
    add(core_v3(0, 0, -5), core_v3(9, height, 5));
    compare(core_v3(-4, 0, 0), core_v3(5, height, 0), walked);
}
static void steps_below_the_limit(void) { step_of(STEP - 0.01f, true); }
static void steps_above_the_limit(void) { step_of(STEP + 0.01f, false); }

static void ceiling_of(float height, bool walked) {
    ground();
    add(core_v3(0, height, -5), core_v3(3, height + 0.3f, 5));
    compare(core_v3(-4, 0, 0), core_v3(6, 0, 0), walked);
}
static void headroom_enough(void) { ceiling_of(HEIGHT + 0.02f, true); }
static void headroom_too_low(void) { ceiling_of(HEIGHT - 0.02f, false); }

static void gap_of(float wide, bool walked) {
    ground();
    add(core_v3(0, 0, -5), core_v3(1, 3, -0.5f * wide));
    add(core_v3(0, 0, 0.5f * wide), core_v3(1, 3, 5));
    compare(core_v3(-4, 0, 0), core_v3(6, 0, 0), walked);
}
// Where max_error is 2 sqrt(2) cells, the surface may lose a gap that the mover fits through by
// twice that, never the reverse.
static void gaps_wide_enough(void) { gap_of(2 * RADIUS + 0.57f, true); }
static void gaps_too_narrow(void) { gap_of(2 * RADIUS - 0.02f, false); }

// ---- a level with all of it ----

static void house(void) {
    add(core_v3(-10, -0.02f, -10), core_v3(10, 0, 10)); // floors of 2 cm
    add(core_v3(0, 2.6f, -10), core_v3(10, 2.62f, 2));
    for (int i = 0; i < 10; i++) { // stairs up to the storey
        float x = -2.6f + 0.26f * (float)i, top = 0.262f * (float)(i + 1);
        add(core_v3(x, 0, -9), core_v3(x + 0.26f, top, -6));
    }
    add(core_v3(4, 0, -4), core_v3(6, 1.2f, -2)); // a table under it
    add(core_v3(4, 2.62f, -4), core_v3(6, 3.8f, -2));
    add(core_v3(-8, 1.7f, 3), core_v3(-4, 2, 7)); // too low to pass under
    ramp(-3, 0, 4, 6, 5, 1.5f);
    add(core_v3(2, 1.4f, 4), core_v3(6, 1.5f, 6));    // ends in a ledge
    add(core_v3(-6, 0, -3), core_v3(-5.9f, 2.2f, 3)); // a thin wall
}

// Wherever movers that wander at random stand, there is surface.
static void movers_stay_on_the_surface(void) {
    enum { MOVERS = 24 };
    house();
    nav_mesh m = surface();
    core_rng rng = core_rng_make(7, 1);
    phys_mover mover[MOVERS];
    for (int i = 0; i < MOVERS; i++) {
        float z = -9 + 4 * core_rng_float(&rng); // one by one: arguments have no order
        mover[i] = mover_at(core_v3(-9 + 6 * core_rng_float(&rng), 0, z));
    }
    int checked = 0, above = 0;
    for (int step = 0; step < 60 * 40; step++) {
        for (int i = 0; i < MOVERS && step % 45 == 0; i++) {
            float sine, cosine;
            core_sincosf(6.28f * core_rng_float(&rng), &sine, &cosine);
            phys_mover_walk(scene_phys(world), mover[i], core_v3(2 * cosine, 0, 2 * sine));
        }
        scene_step(world);
        for (int i = 0; i < MOVERS && step % 5 == 0; i++) {
            phys_mover_state s;
            core_vec3 p = feet_of(mover[i], &s), q;
            bool edge = core_absf(p.x) > 9.6f || core_absf(p.z) > 9.6f || p.y < -0.05f;
            if (s.ground != PHYS_MOVER_GROUND || edge) {
                continue; // falls, or leaves the world
            }
            // The capsule's middle may overhang a ledge by its radius, where the surface has ended
            // one radius before it.
            TEST_ASSERT_TRUE(nav_mesh_nearest(scene_nav(world), m, p, 2 * RADIUS + 0.25f, &q));
            float up = core_absf(q.y - p.y);
            if (up > STEP + 0.06f) { // another storey is nearer sideways: look for this one
                core_vec3 low = p;
                float sine, cosine;
                bool any = false;
                for (int k = 0; k < 64 && !any; k++) {
                    core_sincosf(0.0981748f * (float)k, &sine, &cosine);
                    for (float d = 0.1f; d <= 2 * RADIUS + 0.25f && !any; d += 0.1f) {
                        low.x = p.x + d * cosine, low.z = p.z + d * sine;
                        any = nav_mesh_nearest(scene_nav(world), m, low, 0.02f, &q) &&
                              core_absf(q.y - p.y) <= STEP + 0.06f;
                    }
                }
                TEST_ASSERT_TRUE(any);
            }
            checked++;
            above += p.y > 2.0f;
        }
    }
    printf("%d places looked at, %d of them upstairs\n", checked, above);
    TEST_ASSERT_TRUE(checked > 3000 && above > 50);
}

// Whatever the surface joins to the start, a mover led by an agent reaches.
static void movers_reach_all_of_the_surface(void) {
    house();
    nav_mesh m = surface();
    core_rng rng = core_rng_make(11, 1);
    nav_world *nav = scene_nav(world);
    phys_mover mover = mover_at(core_v3(-8, 0, -8));
    nav_agent_desc d = nav_agent_desc_default();
    d.max_speed = 4;
    d.position = core_v3(-8, 0, -8);
    nav_agent agent = nav_agent_create(nav, &d);
    TEST_ASSERT_TRUE(scene_lead_mover(world, agent, mover, 0.5f * HEIGHT));
    int reached = 0, upstairs = 0;
    for (int i = 0; i < 60; i++) {
        core_vec3 goal, p;
        phys_mover_state s;
        core_vec3 any = {19 * core_rng_float(&rng) - 9.5f, core_rng_below(&rng, 2) ? 2.62f : 0,
                         19 * core_rng_float(&rng) - 9.5f};
        nav_result r;
        p = feet_of(mover, &s);
        TEST_ASSERT_TRUE(nav_mesh_nearest(nav, m, any, 0, &goal));
        nav_mesh_search(nav, m, p, goal, &r, NULL, 0);
        if (r.status != NAV_FOUND) {
            continue; // tops of tables
        }
        nav_agent_go_on_mesh(nav, agent, m, goal);
        for (int step = 0; step < 60 * 30 && nav_agent_status(nav, agent) != NAV_AGENT_ARRIVED;
             step++) {
            scene_step(world);
        }
        p = feet_of(mover, &s);
        TEST_ASSERT_FLOAT_WITHIN(0.25f, goal.x, p.x);
        TEST_ASSERT_FLOAT_WITHIN(0.25f, goal.z, p.z);
        TEST_ASSERT_FLOAT_WITHIN(0.3f, goal.y, p.y);
        reached++;
        upstairs += goal.y > 2;
    }
    printf("%d goals reached, %d of them upstairs\n", reached, upstairs);
    TEST_ASSERT_TRUE(reached > 40 && upstairs > 5);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(slopes_below_the_limit);
    RUN_TEST(slopes_above_the_limit);
    RUN_TEST(steps_below_the_limit);
    RUN_TEST(steps_above_the_limit);
    RUN_TEST(headroom_enough);
    RUN_TEST(headroom_too_low);
    RUN_TEST(gaps_wide_enough);
    RUN_TEST(gaps_too_narrow);
    RUN_TEST(movers_stay_on_the_surface);
    RUN_TEST(movers_reach_all_of_the_surface);
    return UNITY_END();
}
