// The references themselves against closed forms, invariants and one another.
#include "ref/motion.h"

#include <math.h>

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void near(double want, double got, double tolerance) {
    TEST_ASSERT_TRUE_MESSAGE(fabs(want - got) <= tolerance, "outside the tolerance");
}

static void drag(void *ctx, double t, const double *y, double *dy) {
    const double *k = ctx;
    (void)t;
    dy[0] = y[1], dy[1] = -9.81 - *k * y[1];
}

static void test_projectile(void) {
    ref_state s = {{0, 0, 0}, {10, 20, 0}};
    ref_vec g = {0, -9.81, 0};
    near(20 * 5 - 0.5 * 9.81 * 25, ref_projectile(s, g, 0, 5).p.y, 1e-12);
    double k = 0.3, y[2] = {0, 20};
    ref_rk4(drag, &k, y, 2, 0, 5, 5000);
    near(y[0], ref_projectile(s, g, k, 5).p.y, 1e-9);
    near(y[1], ref_projectile(s, g, k, 5).v.y, 1e-9);
    near(ref_projectile(s, g, 0, 5).p.x, ref_projectile(s, g, 1e-9, 5).p.x, 1e-6);
    near(sqrt(9.81 / 0.01), ref_fall_speed(9.81, 0.01, 100), 1e-6);
    near(9.81 * 0.01, ref_fall_speed(9.81, 0.01, 0.01), 1e-6);
}

static void spring(void *ctx, double t, const double *y, double *dy) {
    const double *c = ctx;
    (void)t;
    dy[0] = y[1], dy[1] = -c[0] * c[0] * y[0] - 2 * c[1] * c[0] * y[1];
}

static void test_oscillator(void) {
    double x, v, c[2] = {7, 0.15}, y[2] = {1, -2};
    ref_oscillator(7, 0.15, 1, -2, 3, &x, &v);
    ref_rk4(spring, c, y, 2, 0, 3, 20000);
    near(y[0], x, 1e-10);
    near(y[1], v, 1e-10);
    ref_oscillator(2 * M_PI, 0, 0.5, 0, 10, &x, &v); // ten whole periods
    near(0.5, x, 1e-12);
}

static void gravity(void *ctx, double t, const double *y, double *dy) {
    (void)ctx, (void)t;
    double r = sqrt(y[0] * y[0] + y[1] * y[1]), f = -1 / (r * r * r);
    dy[0] = y[2], dy[1] = y[3], dy[2] = f * y[0], dy[3] = f * y[1];
}

static void test_kepler(void) {
    for (double e = 0; e < 0.95; e += 0.3) {
        ref_state s = ref_kepler(1, 1, e, 0);
        near(1 - e, s.p.x, 1e-14);
        near(sqrt((1 + e) / (1 - e)), s.v.y, 1e-12);
        double y[4] = {s.p.x, s.p.y, s.v.x, s.v.y};
        ref_rk4(gravity, NULL, y, 4, 0, 5, 200000);
        s = ref_kepler(1, 1, e, 5);
        near(y[0], s.p.x, 1e-9);
        near(y[1], s.p.y, 1e-9);
        near(-0.5, 0.5 * (s.v.x * s.v.x + s.v.y * s.v.y) - 1 / hypot(s.p.x, s.p.y), 1e-12);
        s = ref_kepler(1, 1, e, 2 * M_PI); // closed
        near(1 - e, s.p.x, 1e-12);
    }
}

static void swing(void *ctx, double t, const double *y, double *dy) {
    (void)ctx, (void)t;
    dy[0] = y[1], dy[1] = -9.81 * sin(y[0]);
}

static void test_pendulum(void) {
    near(2 * M_PI / sqrt(9.81), ref_pendulum_period(1, 9.81, 1e-6), 1e-9);
    double quarter = ref_pendulum_period(1, 9.81, M_PI / 2) / 4, y[2] = {M_PI / 2, 0};
    ref_rk4(swing, NULL, y, 2, 0, quarter, 20000);
    near(0, y[0], 1e-10); // at the bottom after a quarter
    near(-sqrt(2 * 9.81), y[1], 1e-10);
}

static void test_top(void) {
    ref_vec i = {1, 2, 3.5}, w = {0.7, 0, 1.9};
    for (double t = 0.5; t < 20; t += 3.1) {
        ref_quat q = {0, 0, 0, 1};
        ref_vec now = w;
        ref_top(i, &q, &now, t, 20000);
        ref_vec l = ref_top_body_rates(i, w.x, w.z, t);
        double energy = i.x * w.x * w.x + i.z * w.z * w.z;
        near(energy, i.x * l.x * l.x + i.y * l.y * l.y + i.z * l.z * l.z, 1e-10);
        // The same speed seen from the world; momentum held by construction.
        near(sqrt(l.x * l.x + l.y * l.y + l.z * l.z),
             sqrt(now.x * now.x + now.y * now.y + now.z * now.z), 1e-9);
    }
}

// The middle-axis brick of scene S10a turns over 12 times in 60 s.
static void test_tumbling_brick(void) {
    ref_vec i = {(0.36 + 0.04) / 12, (1 + 0.04) / 12, (1 + 0.36) / 12}, w = {0, 5, 0.01};
    ref_vec s = {0.04 + 0.36, 1.0 + 0.04, 1.0 + 0.36};
    near(s.x / 12, i.x, 1e-12);
    w.x = 0.01;
    ref_quat q = {0, 0, 0, 1};
    int flips = 0, side = 1;
    for (int k = 0; k < 6000; k++) {
        ref_top(i, &q, &w, 0.01, 4);
        double up = 1 - 2 * (q.x * q.x + q.z * q.z); // the y axis against the world's
        if (up * side < -0.5) {
            side = -side, flips++;
        }
    }
    TEST_ASSERT_EQUAL_INT(12, flips);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_projectile);
    RUN_TEST(test_oscillator);
    RUN_TEST(test_kepler);
    RUN_TEST(test_pendulum);
    RUN_TEST(test_top);
    RUN_TEST(test_tumbling_brick);
    return UNITY_END();
}
