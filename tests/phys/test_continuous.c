// Nothing passes through free plates, at rest or turning, whatever is shot at them (scene S5d).
// Passing is judged from poses: a middle that changes the side of a plate within its outline. (The
// peers' harness judges by the place along the shot alone, and so counts what slid over the edge.)
#include "core/rng.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>

static phys_world *world;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    d.zero_gravity = true;
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static float pick(core_rng *rng, float lo, float hi) {
    return lo + (hi - lo) * core_rng_float(rng);
}

static phys_body add(phys_shape_type type, core_vec3 half, core_vec3 at, core_vec3 v,
                     core_vec3 spin, float density) {
    phys_body_desc d = phys_body_desc_default();
    d.position = at;
    d.velocity = v;
    d.angular_velocity = spin;
    phys_shape_desc s = phys_shape_desc_default(type);
    s.half = half;
    s.radius = half.x;
    s.half_height = half.y;
    s.density = density;
    return phys_body_create(world, &d, &s, 1);
}

// Where body b is, seen from body a.
static core_vec3 seen(phys_body a, phys_body b) {
    core_vec3 pa, pb;
    core_quat q;
    phys_body_position(world, a, &pa);
    phys_body_position(world, b, &pb);
    phys_body_rotation(world, a, &q);
    return core_quat_rotate((core_quat){-q.x, -q.y, -q.z, q.w}, core_v3_sub(pb, pa));
}

// From side to side of a plate (thin along its x) between two steps, over its face all the while:
// aside is how far it is from the middle now, across the shot, in the world, where a plate that
// turns does not carry what left it sideways to its other side.
static bool passed(core_vec3 from, core_vec3 to, float aside, float half) {
    if ((from.x > 0) == (to.x > 0) || aside > half) {
        return false;
    }
    float t = from.x / (from.x - to.x);
    float y = from.y + t * (to.y - from.y), z = from.z + t * (to.z - from.z);
    return fabsf(y) < half && fabsf(z) < half && fabsf(to.y) < half && fabsf(to.z) < half;
}

static float aside(phys_body a, phys_body b) {
    core_vec3 pa, pb;
    phys_body_position(world, a, &pa);
    phys_body_position(world, b, &pb);
    return fmaxf(fabsf(pb.y - pa.y), fabsf(pb.z - pa.z));
}

// 64 shots of 5 cm against as many free plates of 1 m, at every phase of the step.
static int shoot_plates(phys_shape_type type, float thick, float v, float spin) {
    phys_body plate[64], ball[64];
    core_vec3 last[64];
    core_rng rng = core_rng_make(9, 1);
    int through = 0;
    for (int k = 0; k < 64; k++) {
        core_vec3 at = {0, (float)(k / 8) * 2 - 7, (float)(k % 8) * 2 - 7};
        float way = 0.1f + thick + v / 60 * (1 + ((float)k + pick(&rng, 0, 1)) / 64);
        core_vec3 u = {1, pick(&rng, -0.05f, 0.05f), pick(&rng, -0.05f, 0.05f)};
        u = core_v3_scale(u, 1.0f / core_v3_length(u));
        plate[k] = add(PHYS_BOX, core_v3(thick / 2, 0.5f, 0.5f), at, core_v3(0, 0, 0),
                       core_v3(0, pick(&rng, -spin, spin), pick(&rng, -spin, spin)), 1000);
        ball[k] = add(type, core_v3(0.05f, 0.05f, 0.05f), core_v3_mad(at, u, -way),
                      core_v3_scale(u, v), core_v3(spin, 2 * spin, 0), 7800);
        last[k] = seen(plate[k], ball[k]);
    }
    for (int i = 0; i < 12; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, 1.0f / 60.0f));
        for (int k = 0; k < 64; k++) {
            core_vec3 now = seen(plate[k], ball[k]);
            if (fabsf(now.x) < thick / 2 && fabsf(now.y) < 0.5f && fabsf(now.z) < 0.5f) {
                continue; // sunk in: which side does it come out on?
            }
            through += passed(last[k], now, aside(plate[k], ball[k]), 0.5f);
            last[k] = now;
        }
    }
    return through;
}

static void plates(phys_shape_type type, float spin) {
    static const float thick[] = {0.02f, 0.05f, 0.1f};
    static const float speed[] = {50, 200, 500, 1000, 2000};
    for (int t = 0; t < 3; t++) {
        for (int v = 0; v < 5; v++) {
            tearDown();
            setUp();
            TEST_ASSERT_EQUAL_INT(0, shoot_plates(type, thick[t], speed[v], spin));
        }
    }
}
static void test_plates_hold_balls(void) { plates(PHYS_SPHERE, 0.0f); }
static void test_turning_plates_hold_balls(void) { plates(PHYS_SPHERE, 6.0f); }
static void test_turning_plates_hold_boxes(void) { plates(PHYS_BOX, 6.0f); }
static void test_turning_plates_hold_capsules(void) { plates(PHYS_CAPSULE, 12.0f); }
static void test_turning_plates_hold_cylinders(void) { plates(PHYS_CYLINDER, 12.0f); }

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_plates_hold_balls);
    RUN_TEST(test_turning_plates_hold_balls);
    RUN_TEST(test_turning_plates_hold_boxes);
    RUN_TEST(test_turning_plates_hold_capsules);
    RUN_TEST(test_turning_plates_hold_cylinders);
    return UNITY_END();
}
