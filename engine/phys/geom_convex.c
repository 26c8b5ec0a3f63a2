// Supports of convex sets, contact polygons, triangulation and tetrahedralisation.
#include "phys/geom.h"
#include "phys/geom_d.h"

#include <stdlib.h>

uint32_t phys_geom_support_point(const core_vec3 *points, uint32_t count, core_vec3 d) {
    uint32_t best = 0;
    float far = count ? core_v3_dot(points[0], d) : 0;
    for (uint32_t i = 1; i < count; i++) {
        float along = core_v3_dot(points[i], d);
        if (along > far) {
            far = along, best = i;
        }
    }
    return best;
}

void phys_geom_support_triangle(const core_vec3 *points, uint32_t count, core_vec3 d,
                                uint32_t out[3]) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) { // insertion into the best three, ties keep lower indices
        float along = core_v3_dot(points[i], d);
        uint32_t at = found < 3 ? found : 3;
        while (at > 0 && along > core_v3_dot(points[out[at - 1]], d)) {
            if (at < 3) {
                out[at] = out[at - 1];
            }
            at--;
        }
        if (at < 3) {
            out[at] = i;
            found += found < 3;
        }
    }
}

typedef struct sweep_key {
    float along;
    uint32_t index;
} sweep_key;

static int sweep_compare(const void *a, const void *b) {
    const sweep_key *x = a, *y = b;
    if (x->along < y->along || x->along > y->along) {
        return x->along < y->along ? -1 : 1;
    }
    return x->index < y->index ? -1 : x->index > y->index;
}

void phys_geom_sweep_sort(const core_vec3 *points, uint32_t count, core_vec3 direction,
                          uint32_t *order) {
    sweep_key *key = core_alloc(sizeof(sweep_key) * (count + 1));
    for (uint32_t i = 0; i < count; i++) {
        key[i] = (sweep_key){core_v3_dot(points[i], direction), i};
    }
    qsort(key, count, sizeof(sweep_key), sweep_compare);
    for (uint32_t i = 0; i < count; i++) {
        order[i] = key[i].index;
    }
    core_free(key);
}

// A frame (u, v) of the plane across d, right-handed: u x v = d.
static void plane_frame(core_vec3 d, dvec *u, dvec *v) {
    dvec n = d_normalize(d_of(d), (dvec){0, 1, 0});
    *u = d_of(phys_geom_orthogonal(d));
    *v = d_cross(n, *u);
}

typedef struct flat_point {
    double x, y;
    uint32_t index;
} flat_point;

static int flat_compare(const void *a, const void *b) {
    const flat_point *p = a, *q = b;
    if (p->x < q->x || p->x > q->x) {
        return p->x < q->x ? -1 : 1;
    }
    if (p->y < q->y || p->y > q->y) {
        return p->y < q->y ? -1 : 1;
    }
    return p->index < q->index ? -1 : p->index > q->index;
}

static double turn(const flat_point *a, const flat_point *b, const flat_point *c) {
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

// Andrew's monotone chain; `flat` is sorted in place, hull (2 * count entries) receives the loop.
static uint32_t flat_hull(flat_point *flat, uint32_t count, flat_point *hull) {
    qsort(flat, count, sizeof(flat_point), flat_compare);
    if (count < 3) {
        for (uint32_t i = 0; i < count; i++) {
            hull[i] = flat[i];
        }
        return count;
    }
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++) {
        while (n >= 2 && turn(&hull[n - 2], &hull[n - 1], &flat[i]) <= 0) {
            n--;
        }
        hull[n++] = flat[i];
    }
    for (uint32_t i = count - 1, lower = n + 1; i-- > 0;) {
        while (n >= lower && turn(&hull[n - 2], &hull[n - 1], &flat[i]) <= 0) {
            n--;
        }
        hull[n++] = flat[i];
    }
    return n - 1; // the first point closes the loop
}

uint32_t phys_geom_support_polygon(const core_vec3 *points, uint32_t count, core_vec3 d,
                                   float tolerance, uint32_t *out, uint32_t capacity) {
    if (!count) {
        return 0;
    }
    core_vec3 n = core_v3_normalize(d, core_v3(0, 1, 0));
    float far = core_v3_dot(points[phys_geom_support_point(points, count, n)], n);
    flat_point *flat = core_alloc(sizeof(flat_point) * 3 * ((size_t)count + 1));
    dvec u, v;
    plane_frame(n, &u, &v);
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (core_v3_dot(points[i], n) >= far - tolerance) {
            dvec p = d_of(points[i]);
            flat[found++] = (flat_point){d_dot(p, u), d_dot(p, v), i};
        }
    }
    flat_point *hull = flat + count + 1;
    uint32_t size = CORE_MIN(flat_hull(flat, found, hull), capacity);
    for (uint32_t i = 0; i < size; i++) {
        out[i] = hull[i].index;
    }
    core_free(flat);
    return size;
}

// Keeps the part of the polygon on the inner side of the edge from->to (Sutherland and Hodgman
// 1974).
static uint32_t clip_by_edge(const dvec *in, uint32_t count, dvec from, dvec to, dvec normal,
                             dvec *out) {
    dvec inward = d_cross(normal, d_sub(to, from));
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++) {
        dvec a = in[i], b = in[(i + 1) % count];
        double da = d_dot(inward, d_sub(a, from)), db = d_dot(inward, d_sub(b, from));
        if (da >= 0) {
            out[n++] = a;
        }
        if ((da >= 0) != (db >= 0)) {
            out[n++] = d_mad(a, d_sub(b, a), da / (da - db));
        }
    }
    return n;
}

// True when the loop a runs counter-clockwise about normal.
static double loop_area(const core_vec3 *a, uint32_t count, dvec normal) {
    dvec sum = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < count; i++) {
        sum = d_add(sum, d_cross(d_sub(d_of(a[i]), d_of(a[0])), d_sub(d_of(a[i + 1]), d_of(a[0]))));
    }
    return d_dot(sum, normal);
}

uint32_t phys_geom_intersect_supports(const core_vec3 *a, uint32_t count_a, const core_vec3 *b,
                                      uint32_t count_b, core_vec3 normal, core_vec3 *out,
                                      uint32_t capacity) {
    if (!count_a || !count_b) {
        return 0;
    }
    dvec n = d_normalize(d_of(normal), (dvec){0, 1, 0});
    size_t room = 2 * ((size_t)count_a + count_b) + 2;
    dvec *now = core_alloc(sizeof(dvec) * 2 * room), *next = now + room;
    for (uint32_t i = 0; i < count_a; i++) {
        now[i] = d_of(a[i]);
    }
    bool flip = loop_area(b, count_b, n) < 0;
    uint32_t count = count_a;
    for (uint32_t i = 0; i < count_b && count && count_b >= 3; i++) {
        dvec from = d_of(b[i]), to = d_of(b[(i + 1) % count_b]);
        count = clip_by_edge(now, count, flip ? to : from, flip ? from : to, n, next);
        dvec *swap = now;
        now = next, next = swap;
    }
    count = CORE_MIN(count, capacity);
    for (uint32_t i = 0; i < count; i++) {
        out[i] = d_to(now[i]);
    }
    core_free(now < next ? now : next);
    return count;
}

uint32_t phys_geom_triangulate_polygon(uint32_t count, uint32_t *out) {
    uint32_t n = 0;
    for (uint32_t i = 1; i + 1 < count; i++) {
        out[n++] = 0, out[n++] = i, out[n++] = i + 1;
    }
    return n;
}

uint32_t phys_geom_hull_triangles(const phys_geom_hull *hull, uint32_t *out) {
    uint32_t n = 0;
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const uint32_t *loop = hull->loop + hull->face_begin[f];
        uint32_t size = hull->face_begin[f + 1] - hull->face_begin[f];
        for (uint32_t i = 1; i + 1 < size; i++) {
            out[n++] = loop[0], out[n++] = loop[i], out[n++] = loop[i + 1];
        }
    }
    return n;
}

uint32_t phys_geom_tetrahedralize(const phys_geom_hull *hull, uint32_t *out) {
    uint32_t n = 0;
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const uint32_t *loop = hull->loop + hull->face_begin[f];
        uint32_t size = hull->face_begin[f + 1] - hull->face_begin[f], touches = 0;
        for (uint32_t i = 0; i < size; i++) {
            touches |= loop[i] == 0;
        }
        for (uint32_t i = 1; i + 1 < size && !touches; i++, n++) {
            if (out) {
                out[4 * n] = 0, out[4 * n + 1] = loop[0];
                out[4 * n + 2] = loop[i], out[4 * n + 3] = loop[i + 1];
            }
        }
    }
    return n;
}
