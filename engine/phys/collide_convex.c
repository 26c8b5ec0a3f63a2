// Contacts of convex shapes in general: GJK and EPA (geom.h) give the normal and the depth, then
// the faces that look along it are clipped against each other (Gregorius, "Robust contact creation
// for physics simulations", GDC 2015). A face is preferred to an edge pair of nearly the same
// separation, so that what rests on a face keeps several points.
#include "phys/geom.h"
#include "phys/mesh_internal.h"

#define FACE_BIAS   5e-4f // m: how much worse a face may separate and still be chosen
#define TOUCHING    1e-4f // m
#define FEATURE_MAX 40    // corners of a face after clipping
#define CAP_CORNERS 12u   // of a cylinder's end, as a polygon

// The part of a shape that looks in a direction: a face, an edge or a corner, world space.
typedef struct feature {
    core_vec3 p[FEATURE_MAX];
    uint32_t id[FEATURE_MAX];
    uint32_t count;
    core_vec3 normal; // of a face: unit, outward
    bool face;
} feature;

static core_vec3 to_world(const phys_geom *g, core_vec3 v) {
    return core_v3_add(g->position, phys_mat_mul(&g->axes, v));
}

static float round_radius(const phys_geom *g) {
    return g->type == PHYS_SPHERE || g->type == PHYS_CAPSULE ? g->radius : 0.0f;
}

static void add_corner(feature *f, core_vec3 p, uint32_t id) {
    if (f->count < FEATURE_MAX) {
        f->p[f->count] = p;
        f->id[f->count++] = id;
    }
}

static void box_feature(const phys_geom *g, core_vec3 l, feature *f) {
    core_vec3 size = phys_abs3(l);
    int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    float s = phys_comp(l, axis) > 0.0f ? 1.0f : -1.0f;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    f->face = true;
    f->normal = core_v3_scale(phys_mat_col(&g->axes, axis), s);
    static const float su[4] = {-1, 1, 1, -1}, sv[4] = {-1, -1, 1, 1};
    core_vec3 c = core_v3_mad(g->position, f->normal, phys_comp(g->half, axis));
    for (uint32_t i = 0; i < 4; i++) { // counter-clockwise from outside
        uint32_t k = s > 0.0f ? i : 3 - i;
        core_vec3 p = core_v3_mad(c, phys_mat_col(&g->axes, u), su[k] * phys_comp(g->half, u));
        p = core_v3_mad(p, phys_mat_col(&g->axes, v), sv[k] * phys_comp(g->half, v));
        add_corner(f, p, k);
    }
}

static void hull_feature(const phys_geom *g, core_vec3 l, feature *f) {
    const phys_geom_hull *h = g->hull;
    uint32_t best = 0;
    float most = -2.0f;
    for (uint32_t i = 0; i < h->face_count; i++) {
        float d = core_v3_dot(h->normal[i], l);
        if (d > most) {
            most = d;
            best = i;
        }
    }
    f->face = true;
    f->normal = phys_mat_mul(&g->axes, h->normal[best]);
    for (uint32_t k = h->face_begin[best]; k < h->face_begin[best + 1]; k++) {
        add_corner(f, to_world(g, h->vertex[h->loop[k]]), h->loop[k]);
    }
}

// A cylinder shows its end when the direction is closer to its axis than its side's line is.
static void cylinder_feature(const phys_geom *g, core_vec3 l, feature *f) {
    float side = core_sqrtf(l.x * l.x + l.z * l.z), s = l.y > 0.0f ? 1.0f : -1.0f;
    if (core_absf(l.y) > side) {
        f->face = true;
        f->normal = core_v3_scale(phys_mat_col(&g->axes, 1), s);
        for (uint32_t i = 0; i < CAP_CORNERS; i++) {
            uint32_t k = s < 0.0f ? i : CAP_CORNERS - 1 - i;
            float sn, cs;
            core_sincosf((float)k * (2.0f * CORE_PI_F / (float)CAP_CORNERS), &sn, &cs);
            add_corner(f, to_world(g, core_v3(cs * g->radius, s * g->half_height, sn * g->radius)),
                       k);
        }
        return;
    }
    float x = l.x / side * g->radius, z = l.z / side * g->radius;
    add_corner(f, to_world(g, core_v3(x, g->half_height, z)), 0);
    add_corner(f, to_world(g, core_v3(x, -g->half_height, z)), 1);
}

static void find_feature(const phys_geom *g, core_vec3 direction, feature *f) {
    core_vec3 l = phys_mat_tmul(&g->axes, direction);
    f->count = 0;
    f->face = false;
    switch (g->type) {
    case PHYS_BOX:
        box_feature(g, l, f);
        break;
    case PHYS_HULL:
        hull_feature(g, l, f);
        break;
    case PHYS_CYLINDER:
        cylinder_feature(g, l, f);
        break;
    case PHYS_CAPSULE:
        add_corner(f, to_world(g, core_v3(0, g->half_height, 0)), 0);
        add_corner(f, to_world(g, core_v3(0, -g->half_height, 0)), 1);
        break;
    default:
        add_corner(f, g->position, 0);
    }
}

// Lowest point of a shape's core along a direction.
static float lowest(const phys_geom *g, core_vec3 n) {
    core_vec3 l = phys_mat_tmul(&g->axes, n);
    float at = core_v3_dot(g->position, n);
    switch (g->type) {
    case PHYS_BOX:
        return at - core_v3_dot(phys_abs3(l), g->half);
    case PHYS_HULL: {
        float low = 1e30f;
        for (uint32_t i = 0; i < g->hull->vertex_count; i++) {
            low = CORE_MIN(low, core_v3_dot(g->hull->vertex[i], l));
        }
        return at + low;
    }
    case PHYS_CYLINDER:
        return at - core_absf(l.y) * g->half_height - core_sqrtf(l.x * l.x + l.z * l.z) * g->radius;
    case PHYS_CAPSULE:
        return at - core_absf(l.y) * g->half_height;
    default:
        return at;
    }
}

static phys_geom_convex make_convex(const phys_geom *g, core_vec3 corner[8]) {
    phys_geom_convex c = {.radius = round_radius(g),
                          .position = g->position,
                          .rotation = g->rotation,
                          .point = corner};
    switch (g->type) {
    case PHYS_BOX:
        phys_geom_box_vertices(g->half, corner);
        c.count = 8;
        break;
    case PHYS_HULL:
        c.point = g->hull->vertex;
        c.count = g->hull->vertex_count;
        break;
    case PHYS_CYLINDER:
        c.half_height = g->half_height;
        c.radius = g->radius;
        break;
    case PHYS_CAPSULE:
        corner[0] = core_v3(0, g->half_height, 0);
        corner[1] = core_v3(0, -g->half_height, 0);
        c.count = 2;
        break;
    default:
        corner[0] = core_v3(0, 0, 0);
        c.count = 1;
    }
    return c;
}

// Keeps what lies behind the plane through a with the normal. Ids of cut corners name the side.
static void clip_by(feature *f, core_vec3 a, core_vec3 normal, uint32_t side) {
    feature in = *f;
    f->count = 0;
    uint32_t edges = in.count > 2 ? in.count : in.count - 1;
    if (in.count == 1) {
        return;
    }
    for (uint32_t i = 0; i < in.count; i++) {
        uint32_t j = (i + 1) % in.count;
        float di = core_v3_dot(core_v3_sub(in.p[i], a), normal);
        float dj = core_v3_dot(core_v3_sub(in.p[j], a), normal);
        bool in_i = di <= 1e-4f, in_j = dj <= 1e-4f;
        if (in_i) {
            add_corner(f, in.p[i], in.id[i]);
        }
        if (in_i != in_j && i < edges) {
            float t = CORE_CLAMP(di / (di - dj), 0.0f, 1.0f);
            core_vec3 p = core_v3_mad(in.p[i], core_v3_sub(in.p[j], in.p[i]), t);
            uint32_t outer = in_i ? in.id[j] : in.id[i];
            add_corner(f, p, (outer & 255u) << 8 | (side + 1) << 16 | (in_i ? 0u : 1u << 24));
        }
    }
}

static void face_points(const feature *ref, feature *inc, float ref_round, float inc_round,
                        bool flip, float margin, phys_manifold *m) {
    for (uint32_t i = 0; i < ref->count && inc->count > 1; i++) {
        core_vec3 a = ref->p[i], b = ref->p[(i + 1) % ref->count];
        clip_by(inc, a, phys_unit(core_v3_cross(core_v3_sub(b, a), ref->normal), ref->normal), i);
    }
    core_vec3 p[FEATURE_MAX];
    float gap[FEATURE_MAX];
    uint32_t id[FEATURE_MAX];
    int n = 0, keep[4] = {0, 1, 2, 3};
    for (uint32_t i = 0; i < inc->count; i++) {
        float d = core_v3_dot(core_v3_sub(inc->p[i], ref->p[0]), ref->normal);
        float sep = d - ref_round - inc_round;
        if (sep < margin) { // half way between the two surfaces
            p[n] = core_v3_mad(inc->p[i], ref->normal, -inc_round - 0.5f * sep);
            gap[n] = sep;
            id[n++] = inc->id[i] | (flip ? 1u << 31 : 0u);
        }
    }
    if (n > 4) {
        phys_manifold_reduce(p, gap, n, ref->normal, keep);
    }
    m->normal = flip ? core_v3_scale(ref->normal, -1.0f) : ref->normal;
    for (int i = 0; i < 4 && i < n; i++) {
        if (keep[i] >= 0) {
            m->point[m->count++] = (phys_point){.ra = p[keep[i]],
                                                .rb = p[keep[i]],
                                                .separation = gap[keep[i]],
                                                .feature = id[keep[i]]};
        }
    }
}

static void add_point(phys_manifold *m, core_vec3 p, float separation, uint32_t id) {
    m->point[m->count++] = (phys_point){.ra = p, .rb = p, .separation = separation, .feature = id};
}

// Two nearly parallel lines: the ends of their common part.
static bool line_points(const feature *a, const feature *b, core_vec3 n, float ra, float rb,
                        float margin, phys_manifold *m) {
    core_vec3 da = core_v3_sub(a->p[1], a->p[0]), db = core_v3_sub(b->p[1], b->p[0]);
    float la = core_v3_length(da), lb = core_v3_length(db);
    core_vec3 u = core_v3_scale(da, 1.0f / la), c = core_v3_cross(u, db);
    if (core_v3_length(c) > 0.05f * lb) {
        return false;
    }
    float t0 = core_v3_dot(core_v3_sub(b->p[0], a->p[0]), u);
    float t1 = core_v3_dot(core_v3_sub(b->p[1], a->p[0]), u);
    float lo = CORE_MAX(CORE_MIN(t0, t1), 0.0f), hi = CORE_MIN(CORE_MAX(t0, t1), la);
    if (hi - lo < 1e-3f * la) {
        return false;
    }
    m->normal = n;
    for (uint32_t k = 0; k < 2; k++) {
        float t = k ? hi : lo, s = (t - t0) / (t1 - t0);
        core_vec3 pa = core_v3_mad(a->p[0], u, t), pb = core_v3_mad(b->p[0], db, s);
        float sep = core_v3_dot(core_v3_sub(pb, pa), n) - ra - rb;
        if (sep < margin) {
            add_point(m, core_v3_mad(pa, n, ra + 0.5f * sep), sep, k + 1);
        }
    }
    return m->count != 0;
}

static bool find_normal(const phys_geom *a, const phys_geom *b, float margin, core_vec3 *normal,
                        core_vec3 *point, float *separation) {
    core_vec3 ca[8], cb[8];
    phys_geom_convex va = make_convex(a, ca), vb = make_convex(b, cb);
    phys_geom_gjk_result r = phys_geom_gjk(&va, &vb);
    float skin = 0.0f;
    if (!r.overlap.hit && r.closest.distance < TOUCHING) { // too near for a direction: let EPA say
        skin = 2.0f * TOUCHING;
        va.radius += skin;
        r = phys_geom_gjk(&va, &vb);
    }
    if (r.overlap.hit) {
        *normal = r.overlap.normal;
        *point = r.overlap.point;
        *separation = skin - r.overlap.depth;
        return true;
    }
    *separation = r.closest.distance;
    core_vec3 d = core_v3_sub(b->position, a->position);
    *normal = phys_unit(core_v3_sub(r.closest.b, r.closest.a), phys_unit(d, core_v3(0, 1, 0)));
    *point = core_v3_scale(core_v3_add(r.closest.a, r.closest.b), 0.5f);
    if (!(r.closest.distance < margin)) {
        return false;
    }
    return true;
}

// m->normal may hold the axis that parted the pair last: most often it still does.
void phys_collide_convex(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m) {
    core_vec3 n = m->normal, point;
    float sep = 0.0f;
    if (n.x != 0.0f || n.y != 0.0f || n.z != 0.0f) {
        sep = lowest(b, n) + lowest(a, core_v3_scale(n, -1.0f)) - round_radius(a) - round_radius(b);
        if (sep > margin) {
            m->apart = sep;
            return;
        }
    }
    if (!find_normal(a, b, margin, &n, &point, &sep)) {
        m->apart = sep;
        m->normal = n;
        return;
    }
    feature fa, fb;
    find_feature(a, n, &fa);
    find_feature(b, core_v3_scale(n, -1.0f), &fb);
    float ra = round_radius(a), rb = round_radius(b), off_a = -1e30f, off_b = -1e30f;
    if (fa.face) {
        off_a = lowest(b, fa.normal) - core_v3_dot(fa.p[0], fa.normal) - ra - rb;
    }
    if (fb.face) {
        off_b = lowest(a, fb.normal) - core_v3_dot(fb.p[0], fb.normal) - ra - rb;
    }
    float best = CORE_MAX(off_a, off_b);
    if (best > sep - FACE_BIAS && fa.face && (off_a >= off_b - 1e-4f || !fb.face)) {
        face_points(&fa, &fb, ra, rb, false, margin, m);
    } else if (best > sep - FACE_BIAS) {
        face_points(&fb, &fa, rb, ra, true, margin, m);
    } else if (fa.count == 2 && fb.count == 2 && !fa.face && !fb.face) {
        line_points(&fa, &fb, n, ra, rb, margin, m);
    }
    if (m->count == 0) {
        m->normal = n;
        add_point(m, point, sep, 0);
    }
}

void phys_collide_face(const phys_geom *flat, const phys_geom *b, core_vec3 n, float margin,
                       phys_manifold *m) {
    feature fa, fb;
    find_feature(flat, n, &fa);
    find_feature(b, core_v3_scale(n, -1.0f), &fb);
    face_points(&fa, &fb, round_radius(flat), round_radius(b), false, margin, m);
}

// Against a plane: the corners of the feature that looks at it.
void phys_collide_plane(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m) {
    feature f;
    core_vec3 up = phys_mat_col(&b->axes, 1), p[FEATURE_MAX];
    find_feature(a, core_v3_scale(up, -1.0f), &f);
    float gap[FEATURE_MAX], r = round_radius(a);
    int n = 0, keep[4] = {0, 1, 2, 3};
    uint32_t id[FEATURE_MAX];
    for (uint32_t i = 0; i < f.count; i++) {
        float d = core_v3_dot(core_v3_sub(f.p[i], b->position), up) - r;
        if (d < margin) {
            p[n] = core_v3_mad(f.p[i], up, -r - 0.5f * d);
            gap[n] = d;
            id[n++] = f.id[i];
        }
    }
    if (n > 4) {
        phys_manifold_reduce(p, gap, n, up, keep);
    }
    m->normal = core_v3_scale(up, -1.0f);
    for (int i = 0; i < 4 && i < n; i++) {
        if (keep[i] >= 0) {
            add_point(m, p[keep[i]], gap[keep[i]], id[keep[i]]);
        }
    }
}

float phys_closest_on(const phys_geom *a, const phys_geom *b, core_vec3 *normal, core_vec3 *on_b) {
    if (b->type == PHYS_MESH) {
        return phys_mesh_separation(a, b, normal, on_b);
    }
    if (a->type == PHYS_PLANE || b->type == PHYS_PLANE) {
        const phys_geom *plane = a->type == PHYS_PLANE ? a : b, *shape = plane == a ? b : a;
        core_vec3 up = phys_mat_col(&plane->axes, 1);
        feature f;
        find_feature(shape, core_v3_scale(up, -1.0f), &f);
        float gap = lowest(shape, up) - core_v3_dot(plane->position, up) - round_radius(shape);
        *normal = plane == a ? up : core_v3_scale(up, -1.0f);
        *on_b = core_v3_mad(f.p[0], up, -round_radius(shape) - (plane == b ? gap : 0.0f));
        return gap;
    }
    core_vec3 middle;
    float gap;
    find_normal(a, b, PHYS_APART, normal, &middle, &gap);
    *on_b = core_v3_mad(middle, *normal, 0.5f * gap);
    return gap;
}

float phys_separation(const phys_geom *a, const phys_geom *b, core_vec3 *normal) {
    if (a->type == PHYS_PLANE || b->type == PHYS_PLANE || b->type == PHYS_MESH) {
        core_vec3 on_b;
        return phys_closest_on(a, b, normal, &on_b);
    }
    core_vec3 ca[8], cb[8], d = core_v3_sub(b->position, a->position);
    phys_geom_convex va = make_convex(a, ca), vb = make_convex(b, cb);
    phys_geom_gjk_result r = phys_geom_gjk(&va, &vb);
    *normal = phys_unit(core_v3_sub(r.closest.b, r.closest.a), phys_unit(d, core_v3(0, 1, 0)));
    return r.overlap.hit ? -r.overlap.depth : r.closest.distance;
}
