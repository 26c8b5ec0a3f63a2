// Ropes and cloth against closed forms: the catenary, the pendulum, the force that tears; stretch
// of a hanging cloth, cloth on a sphere, wind, bodies that hang on ropes, sleep, snapshots, and the
// same bits for any number of threads and lanes.
#include "core/hash.h"
#include "core/log.h"
#include "core/simd.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEP (1.0f / 60.0f)

static phys_world *w;
static phys_cloth cloth;

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    w = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(w); }

static void below(double limit, double value) {
    if (!(value < limit)) {
        printf("%g is not below %g\n", value, limit);
    }
    TEST_ASSERT_TRUE(value < limit);
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(w, STEP));
    }
}
static phys_cloth_view view(void) {
    phys_cloth_view v;
    TEST_ASSERT_TRUE(phys_cloth_read(w, cloth, &v));
    return v;
}
static core_vec3 place(uint32_t column, uint32_t row) {
    phys_cloth_view v = view();
    uint32_t i = row * v.columns + column;
    return core_v3(v.x[i], v.y[i], v.z[i]);
}
static double length_of(core_vec3 a) { return (double)core_v3_length(a); }

static phys_cloth_desc rope_desc(uint32_t count, core_vec3 from, core_vec3 way, float mass) {
    phys_cloth_desc d = phys_cloth_desc_default();
    d.columns = 1;
    d.rows = count;
    d.origin = from;
    d.down = way;
    d.mass = mass;
    return d;
}
static phys_cloth_desc sheet_desc(uint32_t n, core_vec3 from, core_vec3 across, core_vec3 down) {
    phys_cloth_desc d = phys_cloth_desc_default();
    d.columns = d.rows = n;
    d.origin = from;
    d.across = across;
    d.down = down;
    return d;
}
static void make(const phys_cloth_desc *d) {
    cloth = phys_cloth_create(w, d);
    TEST_ASSERT_FALSE(core_handle_is_null(cloth));
}
static void pin(uint32_t column, uint32_t row) {
    TEST_ASSERT_TRUE(phys_cloth_hold(w, cloth, column, row, CORE_NULL_HANDLE, place(column, row)));
}
static phys_body add(phys_shape_desc s, core_vec3 at, phys_body_type type) {
    phys_body_desc b = phys_body_desc_default();
    b.type = type;
    b.position = at;
    return phys_body_create(w, &b, &s, 1);
}
static phys_body ball(core_vec3 at, float radius, float mass, phys_body_type type) {
    phys_shape_desc s = phys_shape_desc_default(PHYS_SPHERE);
    s.radius = radius;
    s.density = mass / (4.0f / 3.0f * CORE_PI_F * radius * radius * radius);
    return add(s, at, type);
}
static core_vec3 at(phys_body b) {
    core_vec3 p = {0, 0, 0};
    phys_body_position(w, b, &p);
    return p;
}

// Rope of 2.5 m between points 2 m apart: y = a cosh(x/a), where 2 a sinh(D/2a) = L.
static void test_a_hanging_rope_is_a_catenary(void) {
    double span = 2.0, length = 2.5, lo = 0.1, hi = 10;
    for (int i = 0; i < 80; i++) {
        double a = 0.5 * (lo + hi);
        lo = 2 * a * sinh(span / 2 / a) > length ? a : lo;
        hi = 2 * a * sinh(span / 2 / a) > length ? hi : a;
    }
    phys_cloth_desc d = rope_desc(101, core_v3(-1, 0, 0), core_v3(2.5f, 0, 0), 1.0f);
    d.damping = 2.0f;
    d.drag = 0.0f;
    make(&d);
    pin(0, 0);
    for (int i = 0; i <= 60; i++) { // its far end comes nearer
        core_vec3 to = core_v3(1.5f - 0.5f * (float)i / 60.0f, 0, 0);
        phys_cloth_hold(w, cloth, 0, 100, CORE_NULL_HANDLE, to);
        run(1);
    }
    run(900);
    double worst = 0;
    for (uint32_t i = 0; i <= 100; i++) {
        core_vec3 p = place(0, i);
        double y = lo * cosh((double)p.x / lo) - lo * cosh(1.0 / lo);
        worst = fmax(worst, fabs(y - (double)p.y));
    }
    printf("catenary: sag %.4f m, worst error %.2f mm\n", lo * (cosh(1.0 / lo) - 1), worst * 1e3);
    below(0.002, worst);
}

static void test_a_hanging_cloth_hardly_stretches(void) {
    phys_cloth_desc d = sheet_desc(40, core_v3(-2, 0, 0), core_v3(4, 0, 0), core_v3(0, 0, 4));
    make(&d);
    pin(0, 0);
    pin(39, 0);
    double worst_mean = 0, worst_most = 0, mean, most;
    for (int i = 0; i < 600; i++) {
        run(1);
        phys_cloth_stretch(w, cloth, &mean, &most);
        worst_mean = fmax(worst_mean, mean);
        worst_most = fmax(worst_most, most);
    }
    printf("hanging 40x40: mean %.3f %%, most %.2f %%; while falling mean %.3f %%, most %.2f %%\n",
           mean * 100, most * 100, worst_mean * 100, worst_most * 100);
    below(0.01, mean);
    below(0.10, most);
}

static void test_cloth_lies_on_a_sphere(void) {
    phys_shape_desc plane = phys_shape_desc_default(PHYS_PLANE);
    add(plane, core_v3(0, -0.5f, 0), PHYS_STATIC);
    ball(core_v3(0, 0, 0), 0.5f, 1, PHYS_STATIC);
    phys_cloth_desc d = sheet_desc(40, core_v3(-1, 0.7f, -1), core_v3(2, 0, 0), core_v3(0, 0, 2));
    make(&d);
    double deepest = 0, floor = 0;
    for (int i = 0; i < 300; i++) {
        run(1);
        phys_cloth_view v = view();
        for (uint32_t k = 0; k < v.count; k++) {
            double r = length_of(core_v3(v.x[k], v.y[k], v.z[k]));
            deepest = fmax(deepest, 0.51 - r);
            floor = fmax(floor, -0.49 - (double)v.y[k]);
        }
    }
    core_vec3 top = place(20, 20);
    printf("on a sphere: deepest %.2f mm of 10, floor %.2f mm, centre at %.3f\n", deepest * 1e3,
           floor * 1e3, (double)top.y);
    below(0.002, deepest);
    below(0.002, floor);
    TEST_ASSERT_FLOAT_WITHIN(0.03f, 0.51f, top.y);
}

// Weights of 1 g to 100 kg on a rope of 100 g: the rope keeps its length.
static void test_a_rope_carries_any_weight(void) {
    for (float mass = 0.001f; mass < 200.0f; mass *= 10.0f) {
        tearDown();
        setUp();
        phys_body b = ball(core_v3(0, -2.1f, 0), 0.1f, mass, PHYS_DYNAMIC);
        phys_cloth_desc d = rope_desc(41, core_v3(0, 0, 0), core_v3(0, -2, 0), 0.1f);
        make(&d);
        pin(0, 0);
        phys_cloth_hold(w, cloth, 0, 40, b, place(0, 40));
        run(240);
        double mean, most;
        phys_cloth_stretch(w, cloth, &mean, &most);
        printf("weight %g kg: at %.5f, mean stretch %.4f %%, most %.4f %%\n", (double)mass,
               (double)at(b).y, mean * 100, most * 100);
        TEST_ASSERT_FLOAT_WITHIN(0.005f, -2.1f, at(b).y);
        below(0.003, most);
    }
}

// Small swings of a ball on a light rope: T = 2 pi sqrt(l / g) and height is kept.
static void test_a_ball_on_a_rope_is_a_pendulum(void) {
    float l = 2.0f, angle = 0.1f;
    core_vec3 end = core_v3(l * sinf(angle), -l * cosf(angle), 0);
    phys_cloth_desc d = rope_desc(21, core_v3(0, 0, 0), core_v3_scale(end, 1.9f / l), 0.01f);
    d.damping = 0;
    d.drag = 0;
    make(&d);
    phys_body b = ball(end, 0.1f, 10, PHYS_DYNAMIC);
    pin(0, 0);
    phys_cloth_hold(w, cloth, 0, 20, b, place(0, 20));
    int crossings = 0;
    double first = 0, last = 0, before = (double)at(b).x, highest = 0;
    for (int i = 1; i <= 1200; i++) {
        run(1);
        double x = (double)at(b).x;
        if ((x < 0) != (before < 0)) {
            last = (i - x / (x - before)) / 60.0;
            first = crossings++ == 0 ? last : first;
        }
        highest = i > 1000 ? fmax(highest, fabs(x)) : 0;
        before = x;
    }
    double period = 2 * (last - first) / (crossings - 1);
    double r2 = 0.4 * 0.1 * 0.1 / (double)(l * l); // own inertia of the ball
    double exact = 2 * M_PI * sqrt((double)l / 9.81 * (1 + r2)) * (1 + 0.01 / 16);
    printf("pendulum: period %.4f s, exact %.4f s, swing after 20 s %.1f %%\n", period, exact,
           100 * highest / (double)(l * sinf(angle)));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * exact, exact, period);
    below(1.01, highest / (double)(l * sinf(angle)));
    below(highest / (double)(l * sinf(angle)), 0.9);
}

// A weight that grows by 1 N each 12 steps tears the rope at its force.
static void test_a_rope_tears_at_its_force(void) {
    static const float limits[] = {20, 100, 2000};
    for (int k = 0; k < 3; k++) {
        tearDown();
        setUp();
        float limit = limits[k];
        phys_body b = ball(core_v3(0, -1.1f, 0), 0.1f, 1, PHYS_DYNAMIC);
        phys_cloth_desc d = rope_desc(21, core_v3(0, 0, 0), core_v3(0, -1, 0), 0.02f);
        d.tear_force = limit;
        make(&d);
        pin(0, 0);
        phys_cloth_hold(w, cloth, 0, 20, b, place(0, 20));
        run(60);
        float load = 9.81f;
        for (int i = 0; i < 2000 && view().torn_count == 0; i++, load += limit / 1500) {
            phys_body_apply_force(w, b, core_v3(0, 9.81f - load, 0));
            run(1);
        }
        printf("torn at %.1f N of %.1f\n", (double)load, (double)limit);
        TEST_ASSERT_FLOAT_WITHIN(0.05f * limit, limit, load);
        run(60);
        below(-1.5, (double)at(b).y);
    }
}

static void test_a_flag_flies_with_the_wind(void) {
    phys_cloth_desc d = sheet_desc(24, core_v3(0, 0, 0), core_v3(0, 0, 1.5f), core_v3(0, -1, 0));
    d.mass = 0.3f;
    make(&d);
    for (uint32_t r = 0; r < 24; r++) {
        pin(0, r);
    }
    phys_field_desc f = phys_field_desc_default(PHYS_FIELD_WIND);
    f.velocity = core_v3(12, 0, 0);
    TEST_ASSERT_FALSE(core_handle_is_null(phys_field_create(w, &f)));
    double x = 0, swing = 0, mean, most;
    for (int i = 0; i < 600; i++) {
        run(1);
        core_vec3 p = place(23, 12);
        x += i >= 300 ? (double)p.x / 300 : 0;
        swing = i >= 300 ? fmax(swing, fabs((double)p.z)) : 0;
        phys_cloth_stretch(w, cloth, &mean, &most);
    }
    printf("flag: free edge at %.2f m downwind on the mean, swings %.2f m, stretch %.2f %%\n", x,
           swing, most * 100);
    below(x, 1.0);
    below(0.15, most);
}

static void test_no_speed_takes_it_through_a_wall(void) {
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = core_v3(0.01f, 5, 5);
    add(s, core_v3(1, 0, 0), PHYS_STATIC);
    phys_cloth_desc d =
        sheet_desc(10, core_v3(0, -0.5f, -0.5f), core_v3(0, 1, 0), core_v3(0, 0, 1));
    d.gravity_scale = 0;
    make(&d);
    for (uint32_t i = 0; i < 100; i++) {
        phys_cloth_push(w, cloth, i % 10, i / 10, core_v3(3.0f, 0, 0)); // 300 m/s
    }
    run(60);
    phys_cloth_view v = view();
    for (uint32_t i = 0; i < v.count; i++) {
        below(0.985, (double)v.x[i]);
    }
}

static void test_cloth_pushes_bodies(void) {
    phys_body b = ball(core_v3(0, 0.5f, 0), 0.2f, 0.2f, PHYS_DYNAMIC);
    phys_cloth_desc d = sheet_desc(12, core_v3(-1, 0, -1), core_v3(2, 0, 0), core_v3(0, 0, 2));
    make(&d);
    for (uint32_t i = 0; i < 12; i++) { // a hammock
        pin(0, i);
        pin(11, i);
    }
    run(300);
    printf("ball in a hammock at %.3f\n", (double)at(b).y);
    below(0.35, (double)at(b).y);
    below((double)at(b).y, -0.5); // the cloth bears it
}

static void test_sleeps_and_wakes(void) {
    phys_shape_desc plane = phys_shape_desc_default(PHYS_PLANE);
    add(plane, core_v3(0, 0, 0), PHYS_STATIC);
    phys_cloth_desc d = sheet_desc(12, core_v3(-1, 0.3f, -1), core_v3(2, 0, 0), core_v3(0, 0, 2));
    make(&d);
    run(300);
    TEST_ASSERT_TRUE(view().asleep);
    core_vec3 p = place(3, 3);
    run(60);
    TEST_ASSERT_EQUAL_FLOAT(p.y, place(3, 3).y);
    ball(core_v3(0, 1, 0), 0.1f, 1, PHYS_DYNAMIC);
    run(1);
    TEST_ASSERT_FALSE(view().asleep); // shapes came: it looks around
    run(400);
    TEST_ASSERT_TRUE(view().asleep);
    phys_cloth_push(w, cloth, 5, 5, core_v3(0, 0.01f, 0));
    TEST_ASSERT_FALSE(view().asleep);
}

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

static void build_busy(void) {
    ball(core_v3(0, -1, 0), 0.5f, 1, PHYS_STATIC);
    phys_body b = ball(core_v3(2, -1, 0), 0.2f, 5, PHYS_DYNAMIC);
    phys_field_desc f = phys_field_desc_default(PHYS_FIELD_WIND);
    f.velocity = core_v3(3, 0, 1);
    phys_field_create(w, &f);
    for (uint32_t i = 0; i < 3; i++) {
        phys_cloth_desc d = sheet_desc(13 + i, core_v3(-1, 0.3f * (float)i, -1), core_v3(2, 0, 0),
                                       core_v3(0, 0, 2));
        d.bend = 10;
        d.tear_force = 3;
        make(&d);
        pin(0, 0);
    }
    phys_cloth_desc d = rope_desc(17, core_v3(2, 0, 0), core_v3(0, -0.8f, 0), 0.1f);
    make(&d);
    pin(0, 0);
    phys_cloth_hold(w, cloth, 0, 16, b, place(0, 16));
}

static void test_one_hash_for_threads_and_lanes(void) {
    core_simd_set best = core_simd_active();
    uint64_t expected = 0;
    for (int set = 0; set <= (int)core_simd_best(); set++) {
        for (int threads = 1; threads <= 2; threads++) {
            core_simd_use((core_simd_set)set);
            tearDown();
            core_jobs *jobs = core_jobs_create(threads);
            phys_world_desc d = phys_world_desc_default();
            d.jobs = jobs;
            w = phys_world_create(&d);
            build_busy();
            run(120);
            expected = expected ? expected : state_hash();
            TEST_ASSERT_EQUAL_HEX64(expected, state_hash());
            phys_world_destroy(w);
            core_jobs_destroy(jobs);
            setUp();
        }
    }
    core_simd_use(best);
}

static void test_a_snapshot_goes_on_with_the_same_bits(void) {
    build_busy();
    run(60);
    size_t size = phys_world_save_size(w);
    void *data = malloc(size);
    phys_world_save(w, data);
    run(60);
    uint64_t went = state_hash();
    TEST_ASSERT_TRUE(phys_world_restore(w, data, size));
    run(60);
    TEST_ASSERT_EQUAL_HEX64(went, state_hash());
    free(data);
}

static void test_others_stay_when_one_goes(void) {
    phys_cloth_desc d = sheet_desc(5, core_v3(0, 0, 0), core_v3(1, 0, 0), core_v3(0, 0, 1));
    phys_cloth a = phys_cloth_create(w, &d);
    d.origin = core_v3(10, 0, 0);
    make(&d);
    pin(2, 2);
    TEST_ASSERT_TRUE(phys_cloth_destroy(w, a));
    TEST_ASSERT_EQUAL_FLOAT(10.5f, place(2, 2).x);
    TEST_ASSERT_FALSE(phys_cloth_destroy(w, a));
    run(30);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 10.5f, place(2, 2).x);
    below(-0.01, (double)place(0, 0).y);
}

static void test_bad_input_is_refused(void) {
    phys_cloth_desc d = sheet_desc(5, core_v3(0, 0, 0), core_v3(1, 0, 0), core_v3(0, 0, 1));
    d.columns = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_cloth_create(w, &d)));
    d.columns = 1u << 20;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_cloth_create(w, &d)));
    d.columns = 5;
    d.mass = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_cloth_create(w, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "mass"));
    d.mass = 1;
    d.down = core_v3(0, 0, 0);
    TEST_ASSERT_TRUE(core_handle_is_null(phys_cloth_create(w, &d)));
    d.down = core_v3(0, 0, 1);
    make(&d);
    TEST_ASSERT_FALSE(phys_cloth_hold(w, cloth, 5, 0, CORE_NULL_HANDLE, core_v3(0, 0, 0)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "columns 0..4"));
    TEST_ASSERT_FALSE(phys_cloth_hold(w, cloth, 0, 0, CORE_NULL_HANDLE, core_v3(NAN, 0, 0)));
    TEST_ASSERT_FALSE(phys_world_set(w, "cloth", "best"));
    TEST_ASSERT_TRUE(phys_world_set(w, "cloth", "iterate"));
}

static void test_a_hold_on_a_body_that_goes_lets_go(void) {
    phys_body b = ball(core_v3(0, 0, 0), 0.1f, 1, PHYS_STATIC);
    phys_cloth_desc d = rope_desc(5, core_v3(0, -0.2f, 0), core_v3(0, -1, 0), 1);
    make(&d);
    phys_cloth_hold(w, cloth, 0, 0, b, place(0, 0));
    run(60);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, -0.2f, place(0, 0).y);
    phys_body_destroy(w, b);
    run(60);
    below(-2.0, (double)place(0, 0).y);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_hanging_rope_is_a_catenary);
    RUN_TEST(test_a_hanging_cloth_hardly_stretches);
    RUN_TEST(test_cloth_lies_on_a_sphere);
    RUN_TEST(test_a_rope_carries_any_weight);
    RUN_TEST(test_a_ball_on_a_rope_is_a_pendulum);
    RUN_TEST(test_a_rope_tears_at_its_force);
    RUN_TEST(test_a_flag_flies_with_the_wind);
    RUN_TEST(test_no_speed_takes_it_through_a_wall);
    RUN_TEST(test_cloth_pushes_bodies);
    RUN_TEST(test_sleeps_and_wakes);
    RUN_TEST(test_one_hash_for_threads_and_lanes);
    RUN_TEST(test_a_snapshot_goes_on_with_the_same_bits);
    RUN_TEST(test_others_stay_when_one_goes);
    RUN_TEST(test_bad_input_is_refused);
    RUN_TEST(test_a_hold_on_a_body_that_goes_lets_go);
    return UNITY_END();
}
