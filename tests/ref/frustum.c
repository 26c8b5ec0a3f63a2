#include "ref/frustum.h"

#include <math.h>

typedef struct v3 {
    double x, y, z;
} v3;

static v3 sub(v3 a, v3 b) { return (v3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static double dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static v3 cross(v3 a, v3 b) {
    return (v3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static double segment_distance(v3 p, v3 a, v3 b) {
    v3 ab = sub(b, a), ap = sub(p, a);
    double t = dot(ap, ab) / dot(ab, ab);
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    v3 d = {ap.x - t * ab.x, ap.y - t * ab.y, ap.z - t * ab.z};
    return sqrt(dot(d, d));
}

// Distance to a convex quad; *outside is set when the point is on its outer side.
static double quad_distance(v3 p, const v3 q[4], v3 inner, int *outside) {
    v3 n = cross(sub(q[2], q[0]), sub(q[3], q[1]));
    double side = dot(sub(inner, q[0]), n), h = dot(sub(p, q[0]), n);
    *outside |= side * h < 0.0;
    int within = 1;
    double nearest = INFINITY;
    for (int i = 0; i < 4; ++i) {
        v3 a = q[i], b = q[(i + 1) % 4];
        double d = segment_distance(p, a, b);
        nearest = d < nearest ? d : nearest;
        within &= dot(cross(sub(b, a), sub(p, a)), n) >= 0.0;
    }
    return within ? fabs(h) / sqrt(dot(n, n)) : nearest;
}

double ref_hexahedron_distance(const double corner[8][3], const double point[3]) {
    static const int face[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                   {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
    v3 c[8], middle = {0.0, 0.0, 0.0}, p = {point[0], point[1], point[2]};
    for (int i = 0; i < 8; ++i) {
        c[i] = (v3){corner[i][0], corner[i][1], corner[i][2]};
        middle.x += c[i].x / 8.0, middle.y += c[i].y / 8.0, middle.z += c[i].z / 8.0;
    }
    int outside = 0;
    double nearest = INFINITY;
    for (int f = 0; f < 6; ++f) {
        v3 q[4] = {c[face[f][0]], c[face[f][1]], c[face[f][2]], c[face[f][3]]};
        double d = quad_distance(p, q, middle, &outside);
        nearest = d < nearest ? d : nearest;
    }
    return outside ? nearest : 0.0;
}
