// Reference motions in double precision: closed forms where there are any, a small-step Runge-Kutta
// where not. Slow, scalar and obviously right; libm is allowed here. SI units.
#ifndef TESTS_REF_MOTION_H
#define TESTS_REF_MOTION_H

typedef struct ref_vec {
    double x, y, z;
} ref_vec;
typedef struct ref_quat {
    double x, y, z, w;
} ref_quat;
typedef struct ref_state {
    ref_vec p, v;
} ref_state;

// Thrown in gravity g with acceleration -k v of linear drag (k in 1/s; 0 = none).
ref_state ref_projectile(ref_state start, ref_vec g, double k, double t);
// Speed of a body that falls from rest with acceleration g - c v^2 (c in 1/m).
double ref_fall_speed(double g, double c, double t);
// x'' = -w^2 x - 2 z w x' from (x0, v0): undamped to underdamped, 0 <= z < 1.
void ref_oscillator(double w, double z, double x0, double v0, double t, double *x, double *v);
// Kepler orbit in the plane z = 0 about the origin: semi-major axis a, eccentricity 0 <= e < 1,
// gravitational parameter mu (m^3/s^2), at time t after the periapsis on +x.
ref_state ref_kepler(double mu, double a, double e, double t);
// Exact period of a pendulum of length l let go at angle `theta` (arithmetic-geometric mean).
double ref_pendulum_period(double l, double g, double theta);

// Torque-free body with principal moments `inertia`, attitude q and angular velocity w (world),
// after t: fourth-order Runge-Kutta on the attitude with the angular momentum held, `steps` steps.
void ref_top(ref_vec inertia, ref_quat *q, ref_vec *w, double t, int steps);
// Angular velocity in the body's frame after t by Jacobi's elliptic functions (Landau and Lifshitz,
// Mechanics, section 37), for inertia.x < inertia.y < inertia.z and 2 E I_y < L^2, starting at
// (w1, 0, w3).
ref_vec ref_top_body_rates(ref_vec inertia, double w1, double w3, double t);

// Any system y' = f(t, y) of n <= 16 numbers by classical fourth-order Runge-Kutta.
typedef void ref_derivative(void *ctx, double t, const double *y, double *dy);
void ref_rk4(ref_derivative *f, void *ctx, double *y, int n, double t0, double t1, int steps);

#endif
