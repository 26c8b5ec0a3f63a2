/* scenes.c - the scene set S1..S12, the same code for every engine, and its measures.
 * One run prints one JSON line.  Everything measured comes from the poses the engine reports;
 * no engine's own idea of penetration, energy or sleep is trusted (sleep counts excepted). */
#define _GNU_SOURCE
#include "pe.h"
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DT (1.0 / 60.0)
#define G  9.81
enum { MAXB = 16384, MAXJ = 16384, HULLS = 32, MAXV = 32, MAXF = 60, MAXE = 90 };

typedef struct {
    double x, y, z;
} V;
static V v3(double x, double y, double z) { return (V){x, y, z}; }
static V add(V a, V b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static V sub(V a, V b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static V mul(V a, double s) { return v3(a.x * s, a.y * s, a.z * s); }
static double dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static V cross(V a, V b) {
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static double len(V a) { return sqrt(dot(a, a)); }
static V rot(const double q[4], V v) {
    V u = v3(q[0], q[1], q[2]), t = mul(cross(u, v), 2);
    return add(v, add(mul(t, q[3]), cross(u, t)));
}
static V irot(const double q[4], V v) {
    double c[4] = {-q[0], -q[1], -q[2], q[3]};
    return rot(c, v);
}

static uint64_t seed;
static double rnd(void) { /* [0,1): the same numbers for every engine */
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(seed >> 40) / 16777216.0;
}
static double sym(double s) { return (2 * rnd() - 1) * s; }

static double clock_ms(clockid_t c) {
    struct timespec t;
    clock_gettime(c, &t);
    return t.tv_sec * 1e3 + t.tv_nsec * 1e-6;
}

/* ---- convex shapes, for the penetration measure -------------------------------------------- */
typedef struct {
    int nv, nf, ne;
    V v[MAXV], f[MAXF]; /* corners, face normals */
    double fd[MAXF], rad;
    struct {
        int v, w, f, g;
    } e[MAXE]; /* an edge: its two corners, its two faces */
} Hull;
static Hull hull[HULLS];
static double hull_pts[HULLS][MAXV * 3];
static int hull_made;

static void hull_faces(Hull *h) { /* brute force: at most 32 points */
    h->nf = h->ne = 0;
    h->rad = 0;
    for (int i = 0; i < h->nv; i++)
        h->rad = fmax(h->rad, len(h->v[i]));
    for (int i = 0; i < h->nv; i++)
        for (int j = i + 1; j < h->nv; j++)
            for (int k = j + 1; k < h->nv; k++) {
                V n = cross(sub(h->v[j], h->v[i]), sub(h->v[k], h->v[i]));
                double l = len(n);
                if (l < 1e-12)
                    continue;
                n = mul(n, 1 / l);
                double d = dot(n, h->v[i]);
                int pos = 0, neg = 0;
                for (int m = 0; m < h->nv; m++) {
                    double s = dot(n, h->v[m]) - d;
                    pos += s > 1e-9;
                    neg += s < -1e-9;
                }
                if (pos && neg)
                    continue;
                if (pos)
                    n = mul(n, -1), d = -d;
                int dup = 0;
                for (int m = 0; m < h->nf; m++)
                    dup |= dot(h->f[m], n) > 1 - 1e-9;
                if (!dup && h->nf < MAXF)
                    h->f[h->nf] = n, h->fd[h->nf++] = d;
            }
    for (int a = 0; a < h->nf; a++) /* an edge lies on two faces */
        for (int b = a + 1; b < h->nf; b++) {
            int on[MAXV], n = 0;
            for (int m = 0; m < h->nv; m++)
                if (fabs(dot(h->f[a], h->v[m]) - h->fd[a]) < 1e-9 &&
                    fabs(dot(h->f[b], h->v[m]) - h->fd[b]) < 1e-9)
                    on[n++] = m;
            if (n < 2 || h->ne >= MAXE)
                continue;
            h->e[h->ne].v = on[0], h->e[h->ne].w = on[1], h->e[h->ne].f = a, h->e[h->ne++].g = b;
        }
}
static void make_hulls(void) {
    if (hull_made)
        return;
    hull_made = 1;
    seed = 77;
    for (int i = 0; i < HULLS; i++) { /* 8..32 points on a squashed sphere: all are corners */
        Hull *h = &hull[i];
        h->nv = 8 + (i * 24) / (HULLS - 1);
        V s = v3(0.35 + 0.15 * rnd(), 0.35 + 0.15 * rnd(), 0.35 + 0.15 * rnd());
        V c = {0, 0, 0};
        for (int k = 0; k < h->nv; k++) { /* spread points: golden spiral, jittered */
            double t = (k + 0.5) / h->nv, y = 1 - 2 * t, r = sqrt(1 - y * y),
                   a = 2.399963 * k + sym(0.35);
            h->v[k] = v3(s.x * r * cos(a), s.y * y, s.z * r * sin(a));
            c = add(c, mul(h->v[k], 1.0 / h->nv));
        }
        for (int k = 0; k < h->nv; k++) {
            h->v[k] = sub(h->v[k], c);
            hull_pts[i][k * 3] = h->v[k].x, hull_pts[i][k * 3 + 1] = h->v[k].y,
                            hull_pts[i][k * 3 + 2] = h->v[k].z;
        }
        hull_faces(h);
    }
}

/* ---- the run ------------------------------------------------------------------------------- */
static struct {
    const char *scene;
    int n, threads, preset, sleep, steps, bullet;
    double arg;
} o = {"s1", 1000, 1, 0, 0, 0, 0, 0};
static pe_world *w;
static struct {
    pe_body_def d;
    Hull h;
    double pos[3], rot[4], vel[3], ang[3];
} * B;
static int nb;
static struct {
    int a, b;
    V la, lb;
    double l;
} * J;
static int nj, unsupported;
static double *ms, *wall; /* per step; ms is CPU time when there is one thread */
static int nms;

static void world(double gx, double gy, double gz, int bodies) {
    pe_world_def d = {{gx, gy, gz}, o.threads, o.preset, bodies + 16, o.sleep};
    w = pe_create(&d);
    nb = nj = nms = 0;
    make_hulls();
}
static pe_body_def body(int dynamic, int kind) {
    pe_body_def d = {0};
    d.dynamic = dynamic, d.kind = kind, d.rot[3] = 1, d.density = 1000, d.friction = 0.5,
    d.hull_id = -1;
    return d;
}
static int put(pe_body_def d) {
    if (nb >= MAXB)
        exit(3);
    int i = pe_add(w, &d);
    if (i != nb) {
        unsupported = 1;
        if (i < 0)
            return -1;
    }
    memset(&B[nb], 0, sizeof B[nb]);
    B[nb].d = d;
    memcpy(B[nb].pos, d.pos, sizeof d.pos);
    memcpy(B[nb].rot, d.rot, sizeof d.rot);
    if (d.kind == PE_BOX) {
        Hull *h = &B[nb].h;
        h->nv = 8;
        for (int k = 0; k < 8; k++)
            h->v[k] =
                v3(k & 1 ? d.h[0] : -d.h[0], k & 2 ? d.h[1] : -d.h[1], k & 4 ? d.h[2] : -d.h[2]);
        hull_faces(h);
    } else if (d.kind == PE_HULL)
        B[nb].h = hull[d.hull_id];
    else
        B[nb].h.rad = d.r;
    return nb++;
}
static int box(int dynamic, V p, V h) {
    pe_body_def d = body(dynamic, PE_BOX);
    d.pos[0] = p.x, d.pos[1] = p.y, d.pos[2] = p.z, d.h[0] = h.x, d.h[1] = h.y, d.h[2] = h.z;
    return put(d);
}
static V P(int i) { return v3(B[i].pos[0], B[i].pos[1], B[i].pos[2]); }
static V W(int i) { return v3(B[i].ang[0], B[i].ang[1], B[i].ang[2]); }
static V U(int i) { return v3(B[i].vel[0], B[i].vel[1], B[i].vel[2]); }
static V toworld(int i, V l) { return add(P(i), rot(B[i].rot, l)); }
static void ball(int a, int b, V at) {
    double p[3] = {at.x, at.y, at.z};
    if (!pe_ball(w, a, b, p))
        unsupported = 1;
    J[nj].a = a, J[nj].b = b, J[nj].l = 0;
    J[nj].la = irot(B[a].rot, sub(at, P(a)));
    J[nj].lb = b < 0 ? at : irot(B[b].rot, sub(at, P(b)));
    nj++;
}
static void rod(int a, int b) {
    V pa = P(a), pb = P(b);
    double x[3] = {pa.x, pa.y, pa.z}, y[3] = {pb.x, pb.y, pb.z};
    if (!pe_dist(w, a, b, x, y))
        unsupported = 1;
    J[nj].a = a, J[nj].b = b, J[nj].l = len(sub(pa, pb)), J[nj].la = J[nj].lb = v3(0, 0, 0);
    nj++;
}
static int nan_seen;
static void pull(void) {
    for (int i = 0; i < nb; i++) {
        pe_get(w, i, B[i].pos, B[i].rot, B[i].vel, B[i].ang);
        double s = B[i].pos[0] + B[i].pos[1] + B[i].pos[2] + B[i].rot[0] + B[i].rot[3] +
                   B[i].vel[0] + B[i].ang[0];
        if (!(fabs(s) < 1e12))
            nan_seen = 1;
    }
}
static void step(void) {
    double t = clock_ms(CLOCK_MONOTONIC), c = clock_ms(CLOCK_PROCESS_CPUTIME_ID);
    pe_step(w, DT);
    c = clock_ms(CLOCK_PROCESS_CPUTIME_ID) - c;
    wall[nms] = clock_ms(CLOCK_MONOTONIC) - t;
    ms[nms] = o.threads == 1 ? c : wall[nms]; /* one thread: other programs do not count */
    nms++;
}
static int cmpd(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}
static double quant_of(const double *a, int from, int to, double q) {
    if (from < 0)
        from = 0;
    if (to > nms)
        to = nms;
    if (to <= from)
        return 0;
    int n = to - from;
    double *c = malloc(n * sizeof *c);
    memcpy(c, a + from, n * sizeof *c);
    qsort(c, n, sizeof *c, cmpd);
    double r = c[(int)(q * (n - 1) + 0.5)];
    free(c);
    return r;
}
static double quant(int from, int to, double q) { return quant_of(ms, from, to, q); }
static int first_out = 1;
static void key(const char *k) {
    printf("%s\"%s\":", first_out ? "{" : ",", k);
    first_out = 0;
}
static void num(const char *k, double v) {
    key(k);
    if (isfinite(v))
        printf("%.6g", v);
    else
        printf("null");
}
static void str(const char *k, const char *v) {
    key(k);
    printf("\"%s\"", v);
}
static void head(void) {
    str("engine", pe_name()), str("scene", o.scene), num("n", o.n), num("threads", o.threads),
        num("preset", o.preset);
    if (o.sleep)
        num("sleep", 1);
    if (o.arg != 0)
        num("arg", o.arg);
}
static void tail(void) {
    num("nan", nan_seen);
    if (unsupported)
        num("unsupported", 1);
    printf("}\n");
    fflush(stdout);
}
static void ready(void) { /* a scene an engine cannot build says so, and no more */
    pe_ready(w);
    if (!unsupported)
        return;
    head(), tail();
    exit(0);
}
static void times(int fall_from, int fall_to, int set_from) {
    num("ms_fall", quant(fall_from, fall_to, 0.5)), num("ms_settled", quant(set_from, nms, 0.5));
    num("ms_p99", quant(1, nms, 0.99)), num("ms_max", quant(1, nms, 1));
    double s = 0;
    for (int i = 0; i < nms; i++)
        s += ms[i];
    num("ms_total", s), num("ms_p25_settled", quant(set_from, nms, 0.25));
    num("wall_settled", quant_of(wall, set_from, nms, 0.5));
}

/* ---- penetration: exact depth for every pair (sphere, box, hull) by the separating axes ---- */
static double face_gap(const Hull *x, const Hull *y, V d, const double qx[4], const double qy[4]) {
    double best = -1e30; /* the best of x's faces as an axis; d: from x to y */
    V c = irot(qx, d);
    double rel[4] = {-qx[0], -qx[1], -qx[2], qx[3]};
    V t[MAXV];
    for (int k = 0; k < y->nv; k++)
        t[k] = add(c, rot(rel, rot(qy, y->v[k])));
    for (int f = 0; f < x->nf; f++) {
        double lo = 1e30;
        for (int k = 0; k < y->nv; k++) {
            double s = dot(x->f[f], t[k]);
            lo = s < lo ? s : lo;
        }
        if (lo - x->fd[f] > best)
            best = lo - x->fd[f];
        if (best > 0)
            break;
    }
    return best;
}
static double edge_gap(int i, int j) { /* edge pairs that make a face of the Minkowski sum */
    const Hull *x = &B[i].h, *y = &B[j].h;
    double best = -1e30;
    V xv[MAXV], yv[MAXV], xf[MAXF], yf[MAXF];
    for (int k = 0; k < x->nv; k++)
        xv[k] = add(P(i), rot(B[i].rot, x->v[k]));
    for (int k = 0; k < y->nv; k++)
        yv[k] = add(P(j), rot(B[j].rot, y->v[k]));
    for (int k = 0; k < x->nf; k++)
        xf[k] = rot(B[i].rot, x->f[k]);
    for (int k = 0; k < y->nf; k++)
        yf[k] = mul(rot(B[j].rot, y->f[k]), -1);
    for (int a = 0; a < x->ne; a++) {
        V p = xf[x->e[a].f], q = xf[x->e[a].g], qp = cross(q, p),
          ea = sub(xv[x->e[a].w], xv[x->e[a].v]);
        for (int b = 0; b < y->ne; b++) {
            V c = yf[y->e[b].f], d = yf[y->e[b].g], dc = cross(d, c);
            double cba = dot(c, qp), dba = dot(d, qp), adc = dot(p, dc), bdc = dot(q, dc);
            if (cba * dba >= 0 || adc * bdc >= 0 || cba * bdc <= 0)
                continue;
            V n = cross(ea, sub(yv[y->e[b].w], yv[y->e[b].v]));
            double l = len(n);
            if (l < 1e-9)
                continue;
            n = mul(n, (dot(n, sub(xv[x->e[a].v], P(i))) < 0 ? -1 : 1) / l);
            double g = dot(n, sub(yv[y->e[b].v], xv[x->e[a].v]));
            if (g > best)
                best = g;
            if (best > 0)
                return best;
        }
    }
    return best;
}
static double depth(int i, int j) { /* > 0: they overlap */
    if (B[i].d.kind == PE_SPHERE && B[j].d.kind == PE_SPHERE)
        return B[i].d.r + B[j].d.r - len(sub(P(i), P(j)));
    if (B[i].d.kind == PE_SPHERE || B[j].d.kind == PE_SPHERE) {
        int s = B[i].d.kind == PE_SPHERE ? i : j, b = s == i ? j : i;
        if (B[b].d.kind != PE_BOX)
            return -1; /* no scene has sphere against hull */
        V c = irot(B[b].rot, sub(P(s), P(b)));
        double *h = B[b].d.h;
        V q = v3(fmax(-h[0], fmin(h[0], c.x)), fmax(-h[1], fmin(h[1], c.y)),
                 fmax(-h[2], fmin(h[2], c.z)));
        double d = len(sub(c, q));
        if (d > 0)
            return B[s].d.r - d;
        return B[s].d.r + fmin(h[0] - fabs(c.x), fmin(h[1] - fabs(c.y), h[2] - fabs(c.z)));
    }
    V d = sub(P(j), P(i));
    double best = face_gap(&B[i].h, &B[j].h, d, B[i].rot, B[j].rot);
    if (best > 0)
        return -best;
    best = fmax(best, face_gap(&B[j].h, &B[i].h, mul(d, -1), B[j].rot, B[i].rot));
    if (best > 0)
        return -best;
    return -fmax(best, edge_gap(i, j));
}
static int by_x(const void *a, const void *b) {
    int i = *(const int *)a, j = *(const int *)b;
    double x = B[i].pos[0] - B[i].h.rad, y = B[j].pos[0] - B[j].h.rad;
    return (x > y) - (x < y);
}
static double pen_max, pen_sum;
static int pen_n;
static void penetration(void) { /* over all overlapping pairs, statics included */
    static int idx[MAXB], st[64];
    int n = 0, ns = 0;
    double mx = 0, sm = 0;
    int c = 0;
    for (int i = 0; i < nb; i++) {
        if (B[i].d.dynamic)
            idx[n++] = i;
        else if (ns < 64)
            st[ns++] = i;
    }
    qsort(idx, n, sizeof *idx, by_x);
    for (int a = 0; a < n; a++) {
        int i = idx[a];
        for (int b = a + 1; b < n; b++) {
            int j = idx[b];
            double r = B[i].h.rad + B[j].h.rad;
            if (B[j].pos[0] - B[j].h.rad > B[i].pos[0] + B[i].h.rad)
                break;
            if (B[i].d.group && B[i].d.group == B[j].d.group)
                continue;
            V d = sub(P(i), P(j));
            if (dot(d, d) > r * r)
                continue;
            double p = depth(i, j);
            if (p > 0) {
                sm += p;
                c++;
                if (p > mx)
                    mx = p;
            }
        }
        for (int b = 0; b < ns; b++) {
            double p = depth(i, st[b]);
            if (p > 0) {
                sm += p;
                c++;
                if (p > mx)
                    mx = p;
            }
        }
    }
    if (mx > pen_max)
        pen_max = mx;
    pen_sum += sm, pen_n += c;
}
static double joint_err(double *mean) {
    double mx = 0, s = 0;
    for (int k = 0; k < nj; k++) {
        V a = toworld(J[k].a, J[k].la), b = J[k].b < 0 ? J[k].lb : toworld(J[k].b, J[k].lb);
        double e = fabs(len(sub(a, b)) - J[k].l);
        if (!(e < 1e9))
            e = 1e9;
        s += e;
        if (e > mx)
            mx = e;
    }
    *mean = nj ? s / nj : 0;
    return mx;
}
static double speed_max(void) {
    double m = 0;
    for (int i = 0; i < nb; i++)
        if (B[i].d.dynamic)
            m = fmax(m, len(U(i)));
    return m;
}

/* ---- scenes -------------------------------------------------------------------------------- */
static void bin(int m, double pitch) { /* floor top at y = 0, four walls */
    double half = m * pitch / 2 + 0.5;
    box(0, v3(0, -1, 0), v3(half + 2, 1, half + 2));
    for (int k = 0; k < 4; k++) {
        double s = k & 1 ? 1 : -1;
        if (k < 2)
            box(0, v3(s * (half + 0.5), 20, 0), v3(0.5, 20, half + 1));
        else
            box(0, v3(0, 20, s * (half + 0.5)), v3(half + 1, 20, 0.5));
    }
}
static void pile(int hulls) { /* S1 spheres, S6 hulls */
    int steps = o.steps ? o.steps : 600, m = (int)ceil(cbrt(o.n) * 1.25);
    world(0, -G, 0, o.n);
    bin(m, 1.1);
    seed = 12345;
    for (int i = 0; i < o.n; i++) {
        int l = i / (m * m), r = i % (m * m);
        pe_body_def d = body(1, hulls ? PE_HULL : PE_SPHERE);
        d.r = 0.5;
        d.pos[0] = (r % m - (m - 1) * 0.5) * 1.1 + sym(0.04);
        d.pos[1] = 1.0 + 1.1 * l;
        d.pos[2] = (r / m - (m - 1) * 0.5) * 1.1 + sym(0.04);
        if (hulls) {
            d.hull_id = i % HULLS, d.pts = hull_pts[d.hull_id], d.npts = hull[d.hull_id].nv;
            double q[4] = {sym(1), sym(1), sym(1), sym(1)},
                   s = 1 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            for (int k = 0; k < 4; k++)
                d.rot[k] = q[k] * s;
        }
        put(d);
    }
    ready();
    pen_max = pen_sum = 0, pen_n = 0;
    int asleep = -1;
    for (int s = 0; s < steps; s++) {
        step();
        if (o.sleep && asleep < 0 && pe_awake(w) == 0)
            asleep = s;
        if (s % 20 == 19 && s < steps - 120 && !o.sleep)
            pull(), penetration();
    }
    double fall_max = pen_max, fall_mean = pen_n ? pen_sum / pen_n : 0;
    pull();
    pen_max = pen_sum = 0, pen_n = 0;
    penetration();
    int out = 0;
    double e = 0;
    for (int i = 0; i < nb; i++)
        if (B[i].d.dynamic)
            out += B[i].pos[1] < -0.5 || fabs(B[i].pos[0]) > m || fabs(B[i].pos[2]) > m,
                e += dot(U(i), U(i));
    head();
    times(1, 120, steps - 120);
    num("pen_max_move", fall_max), num("pen_mean_move", fall_mean), num("pen_max_end", pen_max);
    num("pen_mean_end", pen_n ? pen_sum / pen_n : 0), num("contacts_end", pen_n),
        num("escaped", out);
    num("rms_speed_end", sqrt(e / o.n)), num("max_speed_end", speed_max());
    if (o.sleep)
        num("asleep_at_step", asleep), num("awake_end", pe_awake(w));
    tail();
}
static void s2(void) { /* n = boxes in the base row */
    int steps = o.steps ? o.steps : 400;
    world(0, -G, 0, o.n * (o.n + 1) / 2);
    box(0, v3(0, -1, 0), v3(200, 1, 200));
    for (int i = 0; i < o.n; i++)
        for (int j = 0; j < o.n - i; j++)
            box(1, v3(j - (o.n - i - 1) * 0.5, 0.5 + i, 0), v3(0.5, 0.5, 0.5));
    ready();
    int asleep = -1;
    for (int s = 0; s < steps; s++) {
        step();
        if (o.sleep && asleep < 0 && pe_awake(w) == 0)
            asleep = s;
    }
    pull();
    pen_max = pen_sum = 0, pen_n = 0;
    penetration();
    double moved = 0;
    for (int i = 0; i < nb; i++) {
        V d = sub(P(i), v3(B[i].d.pos[0], B[i].d.pos[1], B[i].d.pos[2]));
        moved = fmax(moved, len(d));
    }
    head();
    num("bodies", nb - 1), times(1, steps / 2, steps / 2);
    num("top_sag", o.n - 0.5 - B[nb - 1].pos[1]), num("moved_max", moved),
        num("fell", B[nb - 1].pos[1] < 0.9 * (o.n - 0.5));
    num("pen_max_end", pen_max), num("pen_mean_end", pen_n ? pen_sum / pen_n : 0),
        num("max_speed_end", speed_max());
    if (o.sleep)
        num("asleep_at_step", asleep);
    tail();
}
static void s3(void) { /* n boxes, 60 s; arg: offset of each box, metres */
    int steps = o.steps ? o.steps : 3600, fell_at = -1;
    world(0, -G, 0, o.n);
    box(0, v3(0, -1, 0), v3(50, 1, 50));
    seed = 5;
    for (int i = 0; i < o.n; i++)
        box(1, v3(sym(o.arg), 0.5 + i, sym(o.arg)), v3(0.5, 0.5, 0.5));
    ready();
    int asleep = -1;
    for (int s = 0; s < steps; s++) {
        step();
        if (o.sleep && asleep < 0 && pe_awake(w) == 0)
            asleep = s;
        if (s % 30 == 29) {
            pull();
            if (fell_at < 0 && B[nb - 1].pos[1] < 0.9 * (o.n - 0.5))
                fell_at = s;
        }
    }
    double drift = 0, tilt = 0;
    for (int i = 1; i < nb; i++) {
        drift = fmax(drift, hypot(B[i].pos[0] - B[i].d.pos[0], B[i].pos[2] - B[i].d.pos[2]));
        tilt = fmax(tilt, acos(fmin(1, rot(B[i].rot, v3(0, 1, 0)).y)));
    }
    head();
    times(1, 60, steps - 120);
    num("fell_at_s", fell_at < 0 ? -1 : fell_at * DT), num("drift_max", drift),
        num("tilt_max_rad", tilt);
    num("top_sag", o.n - 0.5 - B[nb - 1].pos[1]), num("max_speed_end", speed_max());
    if (o.sleep)
        num("asleep_at_step", asleep);
    tail();
}
static void s4(void) { /* arg: mass ratio; n light boxes under the heavy one */
    int steps = o.steps ? o.steps : 1200;
    world(0, -G, 0, 16);
    box(0, v3(0, -1, 0), v3(50, 1, 50));
    for (int i = 0; i < o.n; i++)
        box(1, v3(0, 0.5 + i, 0), v3(0.5, 0.5, 0.5));
    pe_body_def d = body(1, PE_BOX);
    d.h[0] = d.h[1] = d.h[2] = 0.5, d.pos[1] = 0.5 + o.n, d.density = 1000 * o.arg;
    put(d);
    ready();
    double worst = 0, top = o.n + 0.5, late = 0;
    for (int s = 0; s < steps; s++) {
        step();
        pull();
        pen_max = pen_sum = 0, pen_n = 0;
        penetration();
        worst = fmax(worst, pen_max);
        if (s >= steps - 600)
            late = fmax(late, fabs(B[nb - 1].pos[1] - top));
        if (s == steps - 601)
            top = B[nb - 1].pos[1];
    }
    head();
    times(1, steps / 2, steps / 2);
    num("pen_worst", worst), num("pen_end", pen_max), num("top_sag", o.n + 0.5 - B[nb - 1].pos[1]);
    num("jitter_last10s", late), num("fell", B[nb - 1].pos[1] < o.n),
        num("max_speed_end", speed_max());
    tail();
}
static void s5(void) { /* n: wall thickness in mm; arg: speed; --bullet asks for CCD */
    enum { K = 64 };
    int plate = strcmp(o.scene, "s5d") == 0;
    double t = o.n * 1e-3, v = o.arg, far = fmax(2.0, 0.25 * v);
    world(0, 0, 0, 2 * K);
    if (!plate)
        box(0, v3(t / 2, 0, 0), v3(t / 2, 20, 20));
    else
        for (int k = 0; k < K; k++) {
            pe_body_def d = body(1, PE_BOX);
            d.h[0] = t / 2, d.h[1] = d.h[2] = 0.5, d.pos[0] = t / 2, d.pos[1] = (k / 8 - 3.5) * 2,
            d.pos[2] = (k % 8 - 3.5) * 2;
            put(d);
        }
    seed = 9;
    int first = nb;
    for (int k = 0; k < K; k++) { /* a different phase and a small angle for each */
        pe_body_def d = body(1, PE_SPHERE);
        d.r = 0.05, d.density = 7800, d.bullet = o.bullet, d.restitution = 0;
        double dist = 0.1 + v * DT * (1 + (k + rnd()) / K);
        V dir = v3(1, sym(0.05), sym(0.05));
        dir = mul(dir, 1 / len(dir));
        d.pos[0] = -dir.x * dist, d.pos[1] = (k / 8 - 3.5) * 2 - dir.y * dist,
        d.pos[2] = (k % 8 - 3.5) * 2 - dir.z * dist;
        d.vel[0] = dir.x * v, d.vel[1] = dir.y * v, d.vel[2] = dir.z * v;
        put(d);
    }
    ready();
    int through[64] = {0}, steps = o.steps ? o.steps : 30, cnt = 0, missed = 0;
    for (int s = 0; s < steps; s++) {
        step();
        pull();
        for (int k = 0; k < K; k++) {
            double wall = plate ? B[k].pos[0] + t / 2 + 0.05 : t + 0.05;
            if (B[first + k].pos[0] > wall)
                through[k] = 1;
        }
    }
    for (int k = 0; k < K; k++)
        cnt += through[k], missed += B[first + k].pos[0] < -far;
    head();
    num("bullet", o.bullet), num("through", (double)cnt / K),
        num("rebound_far", (double)missed / K);
    num("max_speed_end", speed_max());
    tail();
}
static void s7(void) { /* n links; arg: end mass over link mass */
    int steps = o.steps ? o.steps : 1200, prev = -1;
    world(0, -G, 0, o.n + 4);
    pe_body_def d = body(1, PE_BOX);
    d.h[0] = 0.2, d.h[1] = d.h[2] = 0.05, d.group = 1;
    for (int i = 0; i < o.n; i++) {
        d.pos[0] = 0.2 + 0.4 * i, d.pos[1] = 0;
        int b = put(d);
        ball(b, prev, v3(0.4 * i, 0, 0));
        prev = b;
    }
    pe_body_def e = body(1, PE_SPHERE);
    e.r = 0.3, e.group = 1, e.pos[0] = 0.4 * o.n + 0.3;
    e.density = o.arg * 1000 * 0.4 * 0.1 * 0.1 / (4.0 / 3 * M_PI * 0.027);
    ball(put(e), prev, v3(0.4 * o.n, 0, 0));
    ready();
    double worst = 0, mean_worst = 0, m, vmax = 0, last = 0;
    for (int s = 0; s < steps; s++) {
        step();
        pull();
        double x = joint_err(&m);
        if (s > 10)
            worst = fmax(worst, x), mean_worst = fmax(mean_worst, m);
        if (s >= steps - 60)
            last = fmax(last, x);
        vmax = fmax(vmax, speed_max());
    }
    head();
    num("ms_med", quant(10, nms, 0.5)), num("ms_p25", quant(10, nms, 0.25)),
        num("joint_err_max", worst), num("joint_err_mean_worst", mean_worst);
    num("joint_err_last_s", last), num("stretch_end", -B[nb - 1].pos[1] / (0.4 * o.n + 0.3)),
        num("speed_max", vmax);
    tail();
}
static void s8(void) { /* n x n grid of ball joints; top row is static */
    int steps = o.steps ? o.steps : 300, n = o.n;
    world(0, -G, 0, n * n);
    for (int k = 0; k < n; k++)
        for (int i = 0; i < n; i++) {
            pe_body_def d = body(i > 0, PE_SPHERE);
            d.r = 0.4, d.group = 1, d.pos[0] = k, d.pos[1] = -i;
            int b = put(d);
            if (i > 0)
                ball(b, b - 1, v3(k, -i + 0.5, 0));
            if (k > 0 && i > 0)
                ball(b, b - n, v3(k - 0.5, -i, 0));
        }
    ready();
    double worst = 0, mw = 0, m = 0, x = 0;
    for (int s = 0; s < steps; s++) {
        step();
        if (s % 5 == 4) {
            pull();
            x = joint_err(&m);
            worst = fmax(worst, x), mw = fmax(mw, m);
        }
    }
    head();
    num("joints", nj), num("ms_med", quant(10, nms, 0.5)), num("ms_p25", quant(10, nms, 0.25)),
        num("ms_p99", quant(1, nms, 0.99));
    num("joint_err_max", worst), num("joint_err_mean_worst", mw), num("joint_err_end", x),
        num("joint_err_mean_end", m);
    tail();
}
static void s9(void) { /* cloth: n x n balls, rods along warp, weft and diagonals */
    int steps = o.steps ? o.steps : 600, n = o.n;
    world(0, -G, 0, n * n);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) {
            int pin = i == 0 && (k == 0 || k == n - 1);
            pe_body_def d = body(!pin, PE_SPHERE);
            d.r = 0.04, d.group = 1, d.pos[0] = k * 0.1, d.pos[2] = i * 0.1;
            int b = put(d);
            if (k > 0)
                rod(b, b - 1);
            if (i > 0)
                rod(b, b - n);
            if (i > 0 && k > 0)
                rod(b, b - n - 1);
            if (i > 0 && k < n - 1)
                rod(b, b - n + 1);
        }
    ready();
    double worst = 0, mw = 0, m = 0, x = 0;
    for (int s = 0; s < steps; s++) {
        step();
        if (s % 10 == 9) {
            pull();
            x = joint_err(&m);
            worst = fmax(worst, x), mw = fmax(mw, m);
        }
    }
    head();
    num("joints", nj), num("ms_med", quant(10, nms, 0.5)), num("ms_p25", quant(10, nms, 0.25)),
        num("ms_p99", quant(1, nms, 0.99));
    num("rod_err_max", worst / 0.1), num("rod_err_mean_worst", mw / 0.1),
        num("rod_err_end", x / 0.1), num("max_speed_end", speed_max());
    tail();
}
/* rigid-body reference: RK4 on Euler's equations, 1e-4 s */
static int flips_ref(V I, V w0, double T) {
    V x = w0;
    int n = 0;
    double h = 1e-4, s = x.y;
#define F(q)                                                                                       \
    v3((I.y - I.z) / I.x * (q).y * (q).z, (I.z - I.x) / I.y * (q).z * (q).x,                       \
       (I.x - I.y) / I.z * (q).x * (q).y)
    for (int i = 0; i < (int)(T / h); i++) {
        V a = F(x), q = add(x, mul(a, h / 2)), b = F(q);
        q = add(x, mul(b, h / 2));
        V c = F(q);
        q = add(x, mul(c, h));
        V d = F(q);
        x = add(x, mul(add(add(a, mul(b, 2)), add(mul(c, 2), d)), h / 6));
        if (x.y * s < 0)
            n++, s = x.y;
    }
#undef F
    return n;
}
static void s10a(void) { /* the tumbling brick, 60 s, no torque */
    int steps = o.steps ? o.steps : 3600, flips = 0;
    world(0, 0, 0, 4);
    pe_body_def d = body(1, PE_BOX);
    d.h[0] = 0.5, d.h[1] = 0.3, d.h[2] = 0.1;
    double mass = 8 * d.h[0] * d.h[1] * d.h[2] * 1000, X
    = d.h[0] * d.h[0], Y = d.h[1] * d.h[1], Z = d.h[2] * d.h[2];
    V I = v3(mass / 3 * (Y + Z), mass / 3 * (X + Z),
             mass / 3 * (X + Y)); /* Ix < Iy < Iz: y is the middle axis */
    d.ang[0] = 0.01, d.ang[1] = 5, d.ang[2] = 0.01;
    put(d);
    ready();
    V w0 = v3(0.01, 5, 0.01);
    double E0 = I.x * w0.x * w0.x + I.y * w0.y * w0.y + I.z * w0.z * w0.z, sg = 1;
    V L0 = v3(I.x * w0.x, I.y * w0.y, I.z * w0.z);
    double emax = 0, lmax = 0, dmax = 0, E = E0, L = 0;
    for (int s = 0; s < steps; s++) {
        step();
        pull();
        V wl = irot(B[0].rot, W(0)), l = rot(B[0].rot, v3(I.x * wl.x, I.y * wl.y, I.z * wl.z));
        E = I.x * wl.x * wl.x + I.y * wl.y * wl.y + I.z * wl.z * wl.z;
        L = len(l);
        emax = fmax(emax, fabs(E / E0 - 1)), lmax = fmax(lmax, fabs(L / len(L0) - 1));
        dmax = fmax(dmax, acos(fmax(-1, fmin(1, dot(l, L0) / (L * len(L0))))));
        if (wl.y * sg < -0.5)
            flips++, sg = -sg;
    }
    head();
    num("energy_drift_max", emax), num("energy_end", E / E0 - 1), num("angmom_drift_max", lmax),
        num("angmom_end", L / len(L0) - 1);
    num("angmom_dir_max_rad", dmax), num("flips", flips),
        num("flips_ref", flips_ref(I, w0, steps * DT));
    tail();
}
static void s10b(void) { /* pendulum on a ball joint, let go at 90 degrees, 60 s */
    int steps = o.steps ? o.steps : 3600;
    world(0, -G, 0, 4);
    pe_body_def d = body(1, PE_SPHERE);
    d.r = 0.1, d.pos[0] = 1;
    put(d);
    ball(0, -1, v3(0, 0, 0));
    ready();
    double mass = 4.0 / 3 * M_PI * 1e-3 * 1000, I = 0.4 * mass * 0.01, E0 = 0, lo = 0, hi = 0,
           E = 0, em, jm = 0, amp = 0;
    for (int s = 0; s < steps; s++) {
        step();
        pull();
        E = 0.5 * mass * dot(U(0), U(0)) + 0.5 * I * dot(W(0), W(0)) + mass * G * B[0].pos[1] - E0;
        E /= mass * G; /* in pendulum heights */
        lo = fmin(lo, E), hi = fmax(hi, E);
        jm = fmax(jm, joint_err(&em));
        if (s >= steps - 240)
            amp = fmax(amp, B[0].pos[1] + 1);
    }
    head();
    num("energy_end", E), num("energy_min", lo), num("energy_max", hi), num("height_last4s", amp),
        num("joint_err_max", jm);
    tail();
}
static void s10c(void) { /* thrown ball, 5 s, against the parabola */
    int steps = o.steps ? o.steps : 300;
    world(0, -G, 0, 4);
    pe_body_def d = body(1, PE_SPHERE);
    d.r = 0.1, d.vel[0] = 10, d.vel[1] = 20;
    put(d);
    ready();
    double e = 0;
    for (int s = 0; s < steps; s++) {
        step();
        pull();
        double t = (s + 1) * DT;
        e = fmax(e, len(sub(P(0), v3(10 * t, 20 * t - 0.5 * G * t * t, 0))));
    }
    head();
    num("pos_err_max", e), num("vel_err_end", len(sub(U(0), v3(10, 20 - G * steps * DT, 0))));
    tail();
}
static void s11(void) { /* arg: slope in degrees; block, or ball for s11b; mu = 0.5 */
    int ballp = strcmp(o.scene, "s11b") == 0, steps = o.steps ? o.steps : ballp ? 180 : 600;
    double a = o.arg * M_PI / 180;
    world(G * sin(a), -G * cos(a), 0, 4); /* gravity tilts, the floor stays: same slope */
    box(0, v3(0, -1, 0), v3(400, 1, 400));
    pe_body_def d = body(1, ballp ? PE_SPHERE : PE_BOX);
    d.r = 0.5, d.h[0] = 0.5, d.h[1] = 0.25, d.h[2] = 0.5, d.pos[1] = ballp ? 0.5 : 0.25;
    put(d);
    ready();
    double x1 = 0;
    for (int s = 0; s < steps; s++) {
        step();
        if (s == steps / 2)
            pull(), x1 = B[1].pos[0];
    }
    pull();
    double T = steps * DT, acc = ballp ? 5.0 / 7 * G * sin(a) : G * (sin(a) - 0.5 * cos(a));
    if (acc < 0)
        acc = 0;
    head();
    num("moved", B[1].pos[0]), num("expected", 0.5 * acc * T * T),
        num("creep_mm_s", acc == 0 ? (B[1].pos[0] - x1) / (T / 2) * 1000 : 0);
    num("rel_err", acc > 0 ? B[1].pos[0] / (0.5 * acc * T * T) - 1 : 0);
    tail();
}
static void s12(void) { /* arg: restitution; ball dropped with its underside at 5 m */
    int steps = o.steps ? o.steps : 600;
    world(0, -G, 0, 4);
    box(0, v3(0, -1, 0), v3(50, 1, 50));
    B[0].d.restitution = o.arg;
    pe_destroy(w);
    world(0, -G, 0, 4);
    pe_body_def f = body(0, PE_BOX);
    f.pos[1] = -1, f.h[0] = f.h[2] = 50, f.h[1] = 1, f.restitution = o.arg;
    put(f);
    pe_body_def d = body(1, PE_SPHERE);
    d.r = 0.5, d.pos[1] = 5.5, d.restitution = o.arg;
    put(d);
    ready();
    double top[8] = {0}, prev = 0;
    int k = 0, up = 0;
    double low = 1;
    for (int s = 0; s < steps; s++) {
        step();
        pull();
        double v = B[1].vel[1];
        low = fmin(low, B[1].pos[1] - 0.5);
        if (prev <= 0.05 && v > 0.05)
            up = 1;
        if (up && v <= 0 && k < 8)
            top[k++] = B[1].pos[1] - 0.5, up = 0;
        prev = v;
    }
    head();
    num("bounce1", top[0] / 5), num("expected1", o.arg * o.arg), num("bounce2", top[1] / 5),
        num("expected2", pow(o.arg, 4));
    num("bounce3", top[2] / 5), num("lowest", low), num("bounces", k);
    tail();
}

int phys_main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(void);
        int hulls;
    } T[] = {{"s2", s2, 0},     {"s3", s3, 0},     {"s4", s4, 0},     {"s5", s5, 0},
             {"s5d", s5, 0},    {"s7", s7, 0},     {"s8", s8, 0},     {"s9", s9, 0},
             {"s10a", s10a, 0}, {"s10b", s10b, 0}, {"s10c", s10c, 0}, {"s11", s11, 0},
             {"s11b", s11, 0},  {"s12", s12, 0}};
    for (int i = 1; i < argc; i++) {
        char *v = strchr(argv[i], '=');
        double x = v ? atof(v + 1) : 1;
        if (!strncmp(argv[i], "--n=", 4))
            o.n = (int)x;
        else if (!strncmp(argv[i], "--threads=", 10))
            o.threads = (int)x;
        else if (!strncmp(argv[i], "--preset=", 9))
            o.preset = (int)x;
        else if (!strncmp(argv[i], "--steps=", 8))
            o.steps = (int)x;
        else if (!strncmp(argv[i], "--arg=", 6))
            o.arg = x;
        else if (!strcmp(argv[i], "--sleep"))
            o.sleep = 1;
        else if (!strcmp(argv[i], "--bullet"))
            o.bullet = 1;
        else
            o.scene = argv[i];
    }
    B = calloc(MAXB, sizeof *B);
    J = calloc(MAXJ, sizeof *J);
    ms = calloc(1 << 16, sizeof *ms);
    wall = calloc(1 << 16, sizeof *wall);
    if (!strcmp(o.scene, "s1") || !strcmp(o.scene, "s6")) {
        pile(o.scene[1] == '6');
        return 0;
    }
    for (unsigned i = 0; i < sizeof T / sizeof *T; i++)
        if (!strcmp(T[i].name, o.scene)) {
            T[i].run();
            return 0;
        }
    fprintf(stderr,
            "usage: %s s1..s12 [--n=] [--threads=] [--preset=] [--steps=] [--arg=] [--sleep] "
            "[--bullet]\n",
            argv[0]);
    return 2;
}
#ifndef PE_NO_MAIN
int main(int argc, char **argv) { return phys_main(argc, argv); }
#endif
