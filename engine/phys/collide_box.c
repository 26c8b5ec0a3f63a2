// Box against box: 15 separating axes (Gottschalk, Lin, Manocha, OBBTree, 1996), then the incident
// face clipped by the reference face's sides (Sutherland, Hodgman 1974), or the closest points of
// two edges. At most 4 points are kept. Feature ids name the edges and corners that made a point.
#include "phys/world.h"

typedef struct clip_vertex {
    core_vec3 p;
    uint32_t id; // incident corner, or corner and clipping side for cut edges
} clip_vertex;

// Best axis so far. Faces win ties against edges, so that resting boxes keep four points.
typedef struct axis_pick {
    float separation;
    int kind; // 0..2 face of a, 3..5 face of b, 6..14 edges
    core_vec3 normal;
} axis_pick;

static float support_extent(const phys_geom *g, core_vec3 axis) {
    core_vec3 l = phys_abs3(phys_mat_tmul(&g->axes, axis));
    return core_v3_dot(l, g->half);
}

static bool try_axis(const phys_geom *a, const phys_geom *b, core_vec3 d, core_vec3 axis, int kind,
                     float bias, float margin, axis_pick *best) {
    float at = core_v3_dot(d, axis);
    core_vec3 n = at < 0.0f ? core_v3_scale(axis, -1.0f) : axis;
    float sep = core_absf(at) - support_extent(a, axis) - support_extent(b, axis);
    if (sep > margin) {
        best->separation = sep;
        return false;
    }
    if (sep > best->separation + bias) {
        *best = (axis_pick){sep, kind, n};
    }
    return true;
}

static bool find_axis(const phys_geom *a, const phys_geom *b, float margin, axis_pick *best) {
    core_vec3 d = core_v3_sub(b->position, a->position);
    *best = (axis_pick){-1e30f, -1, {0, 1, 0}};
    for (int i = 0; i < 3; i++) {
        if (!try_axis(a, b, d, phys_mat_col(&a->axes, i), i, 0.0f, margin, best)) {
            return false;
        }
    }
    for (int i = 0; i < 3; i++) {
        if (!try_axis(a, b, d, phys_mat_col(&b->axes, i), 3 + i, 1e-4f, margin, best)) {
            return false;
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            core_vec3 c = core_v3_cross(phys_mat_col(&a->axes, i), phys_mat_col(&b->axes, j));
            float l2 = core_v3_dot(c, c);
            if (l2 < 1e-6f) { // parallel edges: a face axis says the same
                continue;
            }
            c = core_v3_scale(c, 1.0f / core_sqrtf(l2));
            if (!try_axis(a, b, d, c, 6 + i * 3 + j, 5e-4f, margin, best)) {
                return false;
            }
        }
    }
    return true;
}

// The corner furthest along n, world space.
static core_vec3 corner(const phys_geom *g, core_vec3 n) {
    core_vec3 l = phys_mat_tmul(&g->axes, n);
    core_vec3 c = core_v3(l.x >= 0 ? g->half.x : -g->half.x, l.y >= 0 ? g->half.y : -g->half.y,
                          l.z >= 0 ? g->half.z : -g->half.z);
    return core_v3_add(g->position, phys_mat_mul(&g->axes, c));
}

static void edge_contact(const phys_geom *a, const phys_geom *b, const axis_pick *pick,
                         phys_manifold *m) {
    int k = pick->kind - 6;
    core_vec3 ua = phys_mat_col(&a->axes, k / 3), ub = phys_mat_col(&b->axes, k % 3);
    core_vec3 pa = corner(a, pick->normal), pb = corner(b, core_v3_scale(pick->normal, -1.0f));
    // Closest points of two lines (Ericson, Real-Time Collision Detection, 5.1.8).
    core_vec3 r = core_v3_sub(pa, pb);
    float e = core_v3_dot(ua, ub), c = core_v3_dot(ua, r), f = core_v3_dot(ub, r);
    float den = 1.0f - e * e;
    float s = (e * f - c) / den, t = (f - e * c) / den;
    core_vec3 qa = core_v3_mad(pa, ua, s), qb = core_v3_mad(pb, ub, t);
    core_vec3 mid = core_v3_scale(core_v3_add(qa, qb), 0.5f);
    m->normal = pick->normal;
    m->count = 1;
    m->point[0] = (phys_point){
        .ra = mid, .rb = mid, .separation = pick->separation, .feature = 0x10000u + (uint32_t)k};
}

// Corners outside by less than this stay whole: equal boxes on top of each other then keep their
// corners, and with them their feature ids, whichever way rounding goes.
#define CLIP_TOLERANCE 1e-4f

// Cuts the polygon by s * p[axis] <= limit. Returns the new count (at most n + 1).
static int clip(const clip_vertex *in, int n, int axis, float s, float limit, uint32_t side,
                clip_vertex *out) {
    int count = 0;
    for (int i = 0; i < n; i++) {
        const clip_vertex *v = &in[i], *w = &in[(i + 1) % n];
        float dv = s * phys_comp(v->p, axis) - limit, dw = s * phys_comp(w->p, axis) - limit;
        bool in_v = dv <= CLIP_TOLERANCE, in_w = dw <= CLIP_TOLERANCE;
        if (in_v) {
            out[count++] = *v;
        }
        if (in_v != in_w) {
            float t = CORE_CLAMP(dv / (dv - dw), 0.0f, 1.0f);
            uint32_t outside = in_v ? w->id : v->id;
            out[count++] = (clip_vertex){core_v3_mad(v->p, core_v3_sub(w->p, v->p), t),
                                         (outside & 15u) << 4 | side << 8 | (in_v ? 0u : 8u)};
        }
    }
    return count;
}

// Corners of the face of g that looks most against n, in the frame of `ref`.
static void incident_face(const phys_geom *g, const phys_geom *ref, core_vec3 n,
                          clip_vertex out[4]) {
    core_vec3 l = phys_mat_tmul(&g->axes, n), size = phys_abs3(l);
    int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    float s = phys_comp(l, axis) > 0.0f ? -1.0f : 1.0f;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    core_vec3 center =
        core_v3_mad(g->position, phys_mat_col(&g->axes, axis), s * phys_comp(g->half, axis));
    core_vec3 du = core_v3_scale(phys_mat_col(&g->axes, u), phys_comp(g->half, u));
    core_vec3 dv = core_v3_scale(phys_mat_col(&g->axes, v), phys_comp(g->half, v));
    static const float su[4] = {-1, 1, 1, -1}, sv[4] = {-1, -1, 1, 1};
    for (int i = 0; i < 4; i++) {
        core_vec3 p = core_v3_mad(core_v3_mad(center, du, su[i]), dv, sv[i]);
        out[i].p = phys_mat_tmul(&ref->axes, core_v3_sub(p, ref->position));
        out[i].id = (uint32_t)i + 1;
    }
}

void phys_manifold_reduce(const core_vec3 *p, const float *sep, int n, core_vec3 normal,
                          int keep[4]) {
    // Deepest point, the one furthest from it, then the two that span most area on either side.
    int first = 0, second = -1, left = -1, right = -1;
    for (int i = 1; i < n; i++) {
        first = sep[i] < sep[first] - 1e-4f ? i : first;
    }
    float best = -1.0f;
    for (int i = 0; i < n; i++) {
        core_vec3 d = core_v3_sub(p[i], p[first]);
        float l = core_v3_dot(d, d);
        if (i != first && l > best) {
            best = l;
            second = i;
        }
    }
    core_vec3 side = core_v3_cross(normal, core_v3_sub(p[second], p[first]));
    float most = -1e30f, least = 1e30f;
    for (int i = 0; i < n; i++) {
        if (i == first || i == second) {
            continue;
        }
        float area = core_v3_dot(side, core_v3_sub(p[i], p[first]));
        if (area > most) {
            most = area;
            left = i;
        }
        if (area < least) {
            least = area;
            right = i;
        }
    }
    keep[0] = first;
    keep[1] = second;
    keep[2] = left;
    keep[3] = left == right ? -1 : right;
}

static void face_contact(const phys_geom *a, const phys_geom *b, const axis_pick *pick,
                         float margin, phys_manifold *m) {
    bool flip = pick->kind >= 3;
    const phys_geom *ref = flip ? b : a, *inc = flip ? a : b;
    core_vec3 n = flip ? core_v3_scale(pick->normal, -1.0f) : pick->normal; // out of ref
    int axis = flip ? pick->kind - 3 : pick->kind;
    float s = core_v3_dot(phys_mat_col(&ref->axes, axis), n) > 0.0f ? 1.0f : -1.0f;
    clip_vertex poly[2][9];
    incident_face(inc, ref, n, poly[0]);
    int u = (axis + 1) % 3, v = (axis + 2) % 3, count = 4;
    float hu = phys_comp(ref->half, u), hv = phys_comp(ref->half, v);
    count = clip(poly[0], count, u, 1.0f, hu, 1, poly[1]);
    count = clip(poly[1], count, u, -1.0f, hu, 2, poly[0]);
    count = clip(poly[0], count, v, 1.0f, hv, 3, poly[1]);
    count = clip(poly[1], count, v, -1.0f, hv, 4, poly[0]);
    core_vec3 world[9];
    float sep[9];
    uint32_t id[9];
    int kept = 0;
    for (int i = 0; i < count; i++) {
        float gap = s * phys_comp(poly[0][i].p, axis) - phys_comp(ref->half, axis);
        if (gap < margin) {
            core_vec3 p = core_v3_add(ref->position, phys_mat_mul(&ref->axes, poly[0][i].p));
            world[kept] = core_v3_mad(p, n, -0.5f * gap);
            sep[kept] = gap;
            id[kept++] = poly[0][i].id | (uint32_t)pick->kind << 12;
        }
    }
    int keep[4] = {0, 1, 2, 3};
    if (kept > 4) {
        phys_manifold_reduce(world, sep, kept, n, keep);
    }
    m->normal = pick->normal;
    for (int i = 0; i < 4 && i < kept; i++) {
        if (keep[i] >= 0) {
            m->point[m->count++] = (phys_point){.ra = world[keep[i]],
                                                .rb = world[keep[i]],
                                                .separation = sep[keep[i]],
                                                .feature = id[keep[i]]};
        }
    }
}

void phys_collide_box_box(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m) {
    axis_pick pick;
    if (!find_axis(a, b, margin, &pick)) {
        m->apart = pick.separation;
        return;
    }
    if (pick.kind >= 6) {
        edge_contact(a, b, &pick, m);
    } else {
        face_contact(a, b, &pick, margin, m);
    }
}
