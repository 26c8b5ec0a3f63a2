#include "motion.h"

#include <math.h>
#include <string.h>

ref_state ref_projectile(ref_state s, ref_vec g, double k, double t) {
    const double p[3] = {s.p.x, s.p.y, s.p.z}, v[3] = {s.v.x, s.v.y, s.v.z}, a[3] = {g.x, g.y, g.z};
    double out_p[3], out_v[3];
    for (int i = 0; i < 3; i++) {
        if (k > 0) {
            double end = a[i] / k, decay = exp(-k * t);
            out_v[i] = end + (v[i] - end) * decay;
            out_p[i] = p[i] + end * t + (v[i] - end) * -expm1(-k * t) / k;
        } else {
            out_v[i] = v[i] + a[i] * t;
            out_p[i] = p[i] + v[i] * t + 0.5 * a[i] * t * t;
        }
    }
    return (ref_state){{out_p[0], out_p[1], out_p[2]}, {out_v[0], out_v[1], out_v[2]}};
}

double ref_fall_speed(double g, double c, double t) {
    return c > 0 ? sqrt(g / c) * tanh(sqrt(g * c) * t) : g * t;
}

void ref_oscillator(double w, double z, double x0, double v0, double t, double *x, double *v) {
    double wd = w * sqrt(1 - z * z), decay = exp(-z * w * t);
    double b = (v0 + z * w * x0) / wd, c = cos(wd * t), s = sin(wd * t);
    *x = decay * (x0 * c + b * s);
    *v = decay * ((b * wd - z * w * x0) * c - (x0 * wd + z * w * b) * s);
}

ref_state ref_kepler(double mu, double a, double e, double t) {
    double n = sqrt(mu / (a * a * a)), mean = fmod(n * t, 2 * M_PI), anomaly = mean + e * sin(mean);
    for (int i = 0; i < 60; i++) { // Newton on Kepler's equation
        double step = (anomaly - e * sin(anomaly) - mean) / (1 - e * cos(anomaly));
        anomaly -= step;
        if (fabs(step) < 1e-15) {
            break;
        }
    }
    double c = cos(anomaly), s = sin(anomaly), b = a * sqrt(1 - e * e), rate = n / (1 - e * c);
    return (ref_state){{a * (c - e), b * s, 0}, {-a * s * rate, b * c * rate, 0}};
}

static double agm(double a, double b) {
    for (int i = 0; i < 40 && fabs(a - b) > 1e-16 * a; i++) {
        double mean = 0.5 * (a + b);
        b = sqrt(a * b);
        a = mean;
    }
    return a;
}

double ref_pendulum_period(double l, double g, double theta) {
    return 2 * M_PI * sqrt(l / g) / agm(1, cos(0.5 * theta));
}

void ref_rk4(ref_derivative *f, void *ctx, double *y, int n, double t0, double t1, int steps) {
    double h = (t1 - t0) / steps, k[4][16], mid[16];
    static const double at[4] = {0, 0.5, 0.5, 1};
    for (int s = 0; s < steps; s++) {
        double t = t0 + h * s;
        for (int stage = 0; stage < 4; stage++) {
            for (int i = 0; i < n; i++) {
                mid[i] = y[i] + (stage ? h * at[stage] * k[stage - 1][i] : 0);
            }
            f(ctx, t + h * at[stage], mid, k[stage]);
        }
        for (int i = 0; i < n; i++) {
            y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
        }
    }
}

// ---- torque-free rotation ----

static ref_vec cross(ref_vec a, ref_vec b) {
    return (ref_vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static ref_vec rotate(ref_quat q, ref_vec v, double sign) {
    ref_vec u = {sign * q.x, sign * q.y, sign * q.z}, t = cross(u, v);
    t = (ref_vec){2 * t.x, 2 * t.y, 2 * t.z};
    ref_vec c = cross(u, t);
    return (ref_vec){v.x + q.w * t.x + c.x, v.y + q.w * t.y + c.y, v.z + q.w * t.z + c.z};
}

typedef struct top {
    ref_vec inertia, momentum; // momentum in the world
} top;

static ref_vec rates(const top *s, ref_quat q) {
    double n = 1 / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    q = (ref_quat){q.x * n, q.y * n, q.z * n, q.w * n};
    ref_vec l = rotate(q, s->momentum, -1);
    return rotate(q, (ref_vec){l.x / s->inertia.x, l.y / s->inertia.y, l.z / s->inertia.z}, 1);
}

static void top_derivative(void *ctx, double t, const double *y, double *dy) { // q' = w q / 2
    (void)t;
    ref_quat q = {y[0], y[1], y[2], y[3]};
    ref_vec w = rates(ctx, q), v = {q.x, q.y, q.z}, c = cross(w, v);
    dy[0] = 0.5 * (w.x * q.w + c.x);
    dy[1] = 0.5 * (w.y * q.w + c.y);
    dy[2] = 0.5 * (w.z * q.w + c.z);
    dy[3] = -0.5 * (w.x * q.x + w.y * q.y + w.z * q.z);
}

void ref_top(ref_vec inertia, ref_quat *q, ref_vec *w, double t, int steps) {
    ref_vec l = rotate(*q, *w, -1);
    top s = {inertia, rotate(*q, (ref_vec){l.x * inertia.x, l.y * inertia.y, l.z * inertia.z}, 1)};
    double y[4] = {q->x, q->y, q->z, q->w};
    ref_rk4(top_derivative, &s, y, 4, 0, t, steps);
    double n = 1 / sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3]);
    *q = (ref_quat){y[0] * n, y[1] * n, y[2] * n, y[3] * n};
    *w = rates(&s, *q);
}

// sn, cn, dn of u with parameter m by descending Landen steps (Abramowitz and Stegun 16.4).
static void jacobi(double u, double m, double *sn, double *cn, double *dn) {
    double a[16], c[16];
    int n = 0;
    a[0] = 1, c[0] = sqrt(m);
    double b = sqrt(1 - m);
    while (fabs(c[n]) > 1e-16 && n < 15) {
        a[n + 1] = 0.5 * (a[n] + b);
        c[n + 1] = 0.5 * (a[n] - b);
        b = sqrt(a[n] * b);
        n++;
    }
    double phi = ldexp(a[n] * u, n), next = phi;
    for (; n > 0; n--) {
        next = phi;
        phi = 0.5 * (phi + asin(c[n] / a[n] * sin(phi)));
    }
    *sn = sin(phi), *cn = cos(phi);
    *dn = m > 0 ? *cn / cos(next - phi) : 1;
}

ref_vec ref_top_body_rates(ref_vec i, double w1, double w3, double t) {
    double e2 = i.x * w1 * w1 + i.z * w3 * w3, l2 = i.x * i.x * w1 * w1 + i.z * i.z * w3 * w3;
    double speed = sqrt((i.z - i.y) * (l2 - e2 * i.x) / (i.x * i.y * i.z));
    double m = (i.y - i.x) * (e2 * i.z - l2) / ((i.z - i.y) * (l2 - e2 * i.x));
    double sn, cn, dn, amplitude = sqrt((e2 * i.z - l2) / (i.y * (i.z - i.y)));
    jacobi(speed * t, m, &sn, &cn, &dn);
    // Euler's equations fix the sign: w2' = (I3 - I1) w3 w1 / I2.
    return (ref_vec){w1 * cn, (w1 * w3 < 0 ? -amplitude : amplitude) * sn, w3 * dn};
}
