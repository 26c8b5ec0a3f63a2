// Bounds, volumes, inertia tensors and small point utilities.
#include "phys/geom.h"
#include "phys/geom_d.h"

core_aabb phys_geom_bounds_sphere(core_vec3 c, float r) {
    return (core_aabb){{c.x - r, c.y - r, c.z - r}, {c.x + r, c.y + r, c.z + r}};
}

core_aabb phys_geom_bounds_capsule(core_vec3 a, core_vec3 b, float r) {
    return (core_aabb){{CORE_MIN(a.x, b.x) - r, CORE_MIN(a.y, b.y) - r, CORE_MIN(a.z, b.z) - r},
                       {CORE_MAX(a.x, b.x) + r, CORE_MAX(a.y, b.y) + r, CORE_MAX(a.z, b.z) + r}};
}

core_aabb phys_geom_bounds_box(core_vec3 half, core_vec3 p, core_quat q) {
    core_vec3 x = core_quat_rotate(q, core_v3(half.x, 0, 0));
    core_vec3 y = core_quat_rotate(q, core_v3(0, half.y, 0));
    core_vec3 z = core_quat_rotate(q, core_v3(0, 0, half.z));
    core_vec3 e = {core_absf(x.x) + core_absf(y.x) + core_absf(z.x),
                   core_absf(x.y) + core_absf(y.y) + core_absf(z.y),
                   core_absf(x.z) + core_absf(y.z) + core_absf(z.z)};
    return (core_aabb){core_v3_sub(p, e), core_v3_add(p, e)};
}

core_aabb phys_geom_bounds_convex(const core_vec3 *points, uint32_t count, core_vec3 p,
                                  core_quat q) {
    core_aabb box = {p, p};
    for (uint32_t i = 0; i < count; i++) {
        core_vec3 v = core_v3_add(p, core_quat_rotate(q, points[i]));
        core_aabb one = {v, v};
        box.min = i ? core_v3(CORE_MIN(box.min.x, v.x), CORE_MIN(box.min.y, v.y),
                              CORE_MIN(box.min.z, v.z))
                    : one.min;
        box.max = i ? core_v3(CORE_MAX(box.max.x, v.x), CORE_MAX(box.max.y, v.y),
                              CORE_MAX(box.max.z, v.z))
                    : one.max;
    }
    return box;
}

static double tetrahedron_volume(const dvec t[4]) {
    return d_dot(d_sub(t[1], t[0]), d_cross(d_sub(t[2], t[0]), d_sub(t[3], t[0]))) / 6;
}

float phys_geom_volume_tetrahedron(const core_vec3 t[4]) {
    const dvec d[4] = {d_of(t[0]), d_of(t[1]), d_of(t[2]), d_of(t[3])};
    double v = tetrahedron_volume(d);
    return (float)(v < 0 ? -v : v);
}

float phys_geom_volume_sphere(float r) { return (float)(4.0 / 3.0 * CORE_PI) * r * r * r; }
float phys_geom_volume_box(core_vec3 half) { return 8.0f * half.x * half.y * half.z; }
float phys_geom_volume_cylinder(float h, float r) { return 2.0f * CORE_PI_F * r * r * h; }
float phys_geom_volume_capsule(float h, float r) {
    return phys_geom_volume_cylinder(h, r) + phys_geom_volume_sphere(r);
}

phys_geom_inertia phys_geom_inertia_shift(phys_geom_inertia i, float m, core_vec3 o) {
    return (phys_geom_inertia){i.xx + m * (o.y * o.y + o.z * o.z),
                               i.yy + m * (o.x * o.x + o.z * o.z),
                               i.zz + m * (o.x * o.x + o.y * o.y),
                               i.xy - m * o.x * o.y,
                               i.xz - m * o.x * o.z,
                               i.yz - m * o.y * o.z};
}

phys_geom_inertia phys_geom_inertia_rotate(phys_geom_inertia i, core_quat q) {
    const dvec r[3] = {d_rotate(q, (dvec){1, 0, 0}), d_rotate(q, (dvec){0, 1, 0}),
                       d_rotate(q, (dvec){0, 0, 1})}; // columns of R
    const double in[3][3] = {{(double)i.xx, (double)i.xy, (double)i.xz},
                             {(double)i.xy, (double)i.yy, (double)i.yz},
                             {(double)i.xz, (double)i.yz, (double)i.zz}};
    const double rows[3][3] = {
        {r[0].x, r[1].x, r[2].x}, {r[0].y, r[1].y, r[2].y}, {r[0].z, r[1].z, r[2].z}};
    double out[3][3] = {{0}};
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) {
            for (int c = 0; c < 3; c++) {
                for (int d = 0; d < 3; d++) {
                    out[a][b] += rows[a][c] * in[c][d] * rows[b][d];
                }
            }
        }
    }
    return (phys_geom_inertia){(float)out[0][0], (float)out[1][1], (float)out[2][2],
                               (float)out[0][1], (float)out[0][2], (float)out[1][2]};
}

phys_geom_inertia phys_geom_inertia_sphere(float r) {
    float i = 0.4f * r * r;
    return (phys_geom_inertia){i, i, i, 0, 0, 0};
}

phys_geom_inertia phys_geom_inertia_box(core_vec3 h) {
    float xx = h.x * h.x, yy = h.y * h.y, zz = h.z * h.z;
    return (phys_geom_inertia){(yy + zz) / 3, (xx + zz) / 3, (xx + yy) / 3, 0, 0, 0};
}

phys_geom_inertia phys_geom_inertia_cylinder(float h, float r) {
    float side = h * h / 3 + r * r / 4;
    return (phys_geom_inertia){side, r * r / 2, side, 0, 0, 0};
}

// Cylinder part and two hemispheres weighted by volume; a hemisphere's centroid is 3/8 r from its
// flat face, which is what the cross term 3 H r / 8 comes from (H = 2 h is the full segment).
phys_geom_inertia phys_geom_inertia_capsule(float h, float r) {
    double hh = (double)h, rr = (double)r, full = 2 * hh;
    double vc = full * rr * rr, vs = 4.0 / 3.0 * rr * rr * rr; // both over pi
    double mc = vc / (vc + vs), ms = vs / (vc + vs);
    double axis = mc * rr * rr / 2 + ms * 0.4 * rr * rr;
    double side = mc * (full * full / 12 + rr * rr / 4) +
                  ms * (0.4 * rr * rr + full * full / 4 + 3 * full * rr / 8);
    return (phys_geom_inertia){(float)side, (float)axis, (float)side, 0, 0, 0};
}

// Covariance integral of a mass-1 tetrahedron about the origin: C = (sum_i v_i v_i^T + s s^T) / 20
// with s the sum of the vertices. Tonon's closed form, written as matrices.
typedef struct covariance {
    double xx, yy, zz, xy, xz, yz;
} covariance;

static void covariance_add(covariance *c, dvec v, double w) {
    c->xx += w * v.x * v.x, c->yy += w * v.y * v.y, c->zz += w * v.z * v.z;
    c->xy += w * v.x * v.y, c->xz += w * v.x * v.z, c->yz += w * v.y * v.z;
}

static void covariance_tetrahedron(covariance *c, const dvec t[4], double mass) {
    dvec sum = d_add(d_add(t[0], t[1]), d_add(t[2], t[3]));
    for (int i = 0; i < 4; i++) {
        covariance_add(c, t[i], mass / 20);
    }
    covariance_add(c, sum, mass / 20);
}

static phys_geom_inertia inertia_of(covariance c) {
    return (phys_geom_inertia){(float)(c.yy + c.zz), (float)(c.xx + c.zz), (float)(c.xx + c.yy),
                               (float)-c.xy,         (float)-c.xz,         (float)-c.yz};
}

phys_geom_inertia phys_geom_inertia_tetrahedron(const core_vec3 t[4]) {
    dvec d[4] = {d_of(t[0]), d_of(t[1]), d_of(t[2]), d_of(t[3])};
    dvec center = d_scale(d_add(d_add(d[0], d[1]), d_add(d[2], d[3])), 0.25);
    for (int i = 0; i < 4; i++) {
        d[i] = d_sub(d[i], center);
    }
    covariance c = {0};
    covariance_tetrahedron(&c, d, 1);
    return inertia_of(c);
}

// Sums tetrahedra (origin at vertex 0, so that far-away sets lose no digits).
static double hull_mass(const phys_geom_hull *hull, dvec *center, covariance *about) {
    double volume = 0;
    dvec first = {0, 0, 0}, base = d_of(hull->vertex[0]);
    covariance c = {0};
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const uint32_t *loop = hull->loop + hull->face_begin[f];
        uint32_t n = hull->face_begin[f + 1] - hull->face_begin[f];
        for (uint32_t i = 1; i + 1 < n; i++) {
            const dvec t[4] = {{0, 0, 0},
                               d_sub(d_of(hull->vertex[loop[0]]), base),
                               d_sub(d_of(hull->vertex[loop[i]]), base),
                               d_sub(d_of(hull->vertex[loop[i + 1]]), base)};
            double v = tetrahedron_volume(t);
            volume += v;
            first = d_mad(first, d_add(d_add(t[1], t[2]), t[3]), v / 4);
            covariance_tetrahedron(&c, t, v);
        }
    }
    dvec mean = d_scale(first, 1 / volume);
    covariance_add(&c, mean, -volume);
    *center = d_add(base, mean);
    *about = (covariance){c.xx / volume, c.yy / volume, c.zz / volume,
                          c.xy / volume, c.xz / volume, c.yz / volume};
    return volume;
}

float phys_geom_volume_convex(const core_vec3 *points, uint32_t count) {
    phys_geom_hull hull;
    if (!phys_geom_hull_build(&hull, points, count)) {
        return 0;
    }
    dvec center;
    covariance c;
    double volume = hull_mass(&hull, &center, &c);
    phys_geom_hull_release(&hull);
    return (float)volume;
}

bool phys_geom_inertia_convex(const core_vec3 *points, uint32_t count, phys_geom_inertia *out,
                              core_vec3 *center) {
    phys_geom_hull hull;
    if (!phys_geom_hull_build(&hull, points, count)) {
        return false;
    }
    dvec at;
    covariance c;
    hull_mass(&hull, &at, &c);
    phys_geom_hull_release(&hull);
    *out = inertia_of(c);
    if (center) {
        *center = d_to(at);
    }
    return true;
}

void phys_geom_translate_points(core_vec3 *points, uint32_t count, core_vec3 by) {
    for (uint32_t i = 0; i < count; i++) {
        points[i] = core_v3_add(points[i], by);
    }
}

void phys_geom_transform_points(core_vec3 *points, uint32_t count, core_vec3 p, core_quat q) {
    for (uint32_t i = 0; i < count; i++) {
        points[i] = core_v3_add(core_quat_rotate(q, points[i]), p);
    }
}

// Crossing with the axis of the smallest component keeps the result far from zero for any input.
core_vec3 phys_geom_orthogonal(core_vec3 v) {
    dvec d = d_normalize(d_of(v), (dvec){0, 1, 0});
    double ax = d.x < 0 ? -d.x : d.x, ay = d.y < 0 ? -d.y : d.y, az = d.z < 0 ? -d.z : d.z;
    dvec axis = {ax <= ay && ax <= az, ay < ax && ay <= az, az < ax && az < ay};
    return d_to(d_normalize(d_cross(d, axis), (dvec){1, 0, 0}));
}

core_vec3 phys_geom_average(const core_vec3 *points, uint32_t count) {
    dvec sum = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        sum = d_add(sum, d_of(points[i]));
    }
    return d_to(count ? d_scale(sum, 1.0 / count) : sum);
}

core_vec3 phys_geom_weighted_average(const core_vec3 *points, const float *weights,
                                     uint32_t count) {
    dvec sum = {0, 0, 0};
    double total = 0;
    for (uint32_t i = 0; i < count; i++) {
        sum = d_mad(sum, d_of(points[i]), (double)weights[i]);
        total += (double)weights[i];
    }
    return total < 0 || total > 0 ? d_to(d_scale(sum, 1 / total))
                                  : phys_geom_average(points, count);
}

bool phys_geom_barycentric(core_vec3 p, const core_vec3 t[3], float out[3]) {
    dvec a = d_of(t[0]), u = d_sub(d_of(t[1]), a), v = d_sub(d_of(t[2]), a), w = d_sub(d_of(p), a);
    double uu = d_dot(u, u), uv = d_dot(u, v), vv = d_dot(v, v), wu = d_dot(w, u), wv = d_dot(w, v);
    double det = uu * vv - uv * uv;
    if (!(det > 1e-14 * uu * vv)) {
        return false;
    }
    double b = (vv * wu - uv * wv) / det, c = (uu * wv - uv * wu) / det;
    out[0] = (float)(1 - b - c), out[1] = (float)b, out[2] = (float)c;
    return true;
}

void phys_geom_box_vertices(core_vec3 h, core_vec3 out[8]) {
    for (int i = 0; i < 8; i++) {
        out[i] = core_v3(i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z);
    }
}

void phys_geom_capsule_hemispheres(float half_height, float radius, core_vec3 out[2]) {
    float y = half_height + 0.375f * radius;
    out[0] = core_v3(0, -y, 0), out[1] = core_v3(0, y, 0);
}

bool phys_geom_same_side(core_vec3 a, core_vec3 b, core_vec3 plane_point, core_vec3 normal) {
    dvec n = d_of(normal), p = d_of(plane_point);
    double sa = d_dot(n, d_sub(d_of(a), p)), sb = d_dot(n, d_sub(d_of(b), p));
    return !((sa > 0 && sb < 0) || (sa < 0 && sb > 0));
}
