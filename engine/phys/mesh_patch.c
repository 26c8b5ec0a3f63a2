// Contact of a convex shape with one triangle of a surface.
#include "phys/mesh_internal.h"

#define CUT_BEYOND   4.0f  // reaches: corners farther away are cut off
#define SNAP         0.02f // sine: up to here a direction that is not allowed becomes the normal
#define ALLOW_SPHERE 1e-5f // sine by which a direction may lean over a neighbour; less is none
#define ALLOW        1e-3f
#define DEEPER       0.01f // m: how much deeper than the way out a face may be, and count

typedef struct dvec {
    double x, y, z;
} dvec;
static dvec d_sub(core_vec3 a, core_vec3 b) {
    return (dvec){(double)a.x - b.x, (double)a.y - b.y, (double)a.z - b.z};
}
static dvec d_cross(dvec a, dvec b) {
    return (dvec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

typedef struct cut_corner {
    dvec p;
    uint32_t edge; // 0..2: of the triangle, towards the next corner; 3: made by a cut
} cut_corner;

static double axis_of(const dvec *p, int k) { return k == 0 ? p->x : k == 1 ? p->y : p->z; }

// Cuts the polygon to sign * p[axis] <= limit (Sutherland, Hodgman 1974).
static uint32_t cut_side(cut_corner *c, uint32_t n, int axis, double sign, double limit) {
    cut_corner out[PHYS_PATCH_CORNERS + 1];
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++) {
        const cut_corner *a = &c[i], *b = &c[(i + 1) % n];
        double da = sign * axis_of(&a->p, axis) - limit, db = sign * axis_of(&b->p, axis) - limit;
        if (da <= 0.0) {
            out[count++] = *a;
        }
        if ((da <= 0.0) != (db <= 0.0)) {
            double t = da / (da - db);
            dvec p = {a->p.x + (b->p.x - a->p.x) * t, a->p.y + (b->p.y - a->p.y) * t,
                      a->p.z + (b->p.z - a->p.z) * t};
            out[count++] = (cut_corner){p, da <= 0.0 ? 3 : a->edge};
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        c[i] = out[i];
    }
    return count;
}

bool phys_patch_make(const core_vec3 corner[3], const core_vec3 over[3], core_vec3 center,
                     float reach, phys_patch *out) {
    cut_corner c[PHYS_PATCH_CORNERS + 1];
    dvec n = d_cross(d_sub(corner[1], corner[0]), d_sub(corner[2], corner[0]));
    double length = core_sqrt(n.x * n.x + n.y * n.y + n.z * n.z), limit = CUT_BEYOND * reach;
    if (!(length > 0.0)) {
        return false;
    }
    bool large = false;
    for (uint32_t k = 0; k < 3; k++) {
        c[k] = (cut_corner){d_sub(corner[k], center), k};
        for (int a = 0; a < 3; a++) {
            double at = axis_of(&c[k].p, a);
            large |= at > limit || at < -limit;
        }
    }
    uint32_t count = 3;
    for (int side = 0; large && side < 6 && count != 0; side++) {
        count = cut_side(c, count, side / 2, side % 2 ? -1.0 : 1.0, limit);
    }
    if (count < 3) {
        return false;
    }
    core_vec3 normal = core_v3((float)(n.x / length), (float)(n.y / length), (float)(n.z / length));
    out->normal = normal;
    out->count = count;
    for (uint32_t k = 0; k < count; k++) {
        out->corner[k] = core_v3((float)c[k].p.x, (float)c[k].p.y, (float)c[k].p.z);
        uint32_t e = c[k].edge, next = e == 2 ? 0 : e + 1;
        core_vec3 a = e == 3 ? out->corner[k] : corner[e], other = e == 3 ? normal : over[e];
        core_vec3 b = e == 3 ? core_v3((float)c[(k + 1) % count].p.x, (float)c[(k + 1) % count].p.y,
                                       (float)c[(k + 1) % count].p.z)
                             : corner[next];
        core_vec3 along = phys_unit(core_v3_sub(b, a), core_v3(0, 0, 0));
        out->across[k] = core_v3_cross(other, along);
    }
    return true;
}

// Direction of edge k, and its outward direction in the patch's plane.
static core_vec3 edge_along(const phys_patch *p, uint32_t k) {
    return phys_unit(core_v3_sub(p->corner[(k + 1) % p->count], p->corner[k]), core_v3(0, 0, 0));
}

// Whether a direction that leans over edge k keeps clear of what lies there.
static bool clear_of(const phys_patch *p, uint32_t k, core_vec3 u, float allow) {
    return core_v3_dot(u, p->across[k]) >= -allow;
}

// Whether u (unit, from the surface to the shape) can be the direction of a contact: it lies in the
// Voronoi region of the face, edge or corner that it points away from.
static bool direction_allowed(const phys_patch *p, core_vec3 u, float allow) {
    core_vec3 in_plane = core_v3_mad(u, p->normal, -core_v3_dot(u, p->normal));
    float lean = core_v3_length(in_plane);
    if (lean < allow) {
        return true;
    }
    uint32_t top = 0;
    for (uint32_t k = 1; k < p->count; k++) {
        top = core_v3_dot(p->corner[k], in_plane) > core_v3_dot(p->corner[top], in_plane) ? k : top;
    }
    uint32_t before = (top + p->count - 1) % p->count;
    bool on_next = core_absf(core_v3_dot(in_plane, edge_along(p, top))) < 0.02f * lean;
    bool on_before = core_absf(core_v3_dot(in_plane, edge_along(p, before))) < 0.02f * lean;
    if (on_next != on_before) {
        return clear_of(p, on_next ? top : before, u, allow);
    }
    return clear_of(p, top, u, allow) && clear_of(p, before, u, allow);
}

static void one_point(phys_manifold *m, core_vec3 normal, core_vec3 at, float separation,
                      uint32_t feature) {
    m->normal = normal;
    m->count = 1;
    m->point[0] = (phys_point){.ra = at, .rb = at, .separation = separation, .feature = feature};
}

// A ball about the origin: the closest point says all.
static void sphere_patch(float radius, const phys_patch *p, float margin, phys_manifold *m) {
    core_vec3 q = phys_geom_closest_point_polygon(core_v3(0, 0, 0), p->corner, p->count);
    float height = -core_v3_dot(p->corner[0], p->normal); // of the centre over the plane
    float distance = core_v3_length(q);
    core_vec3 face = height < 0.0f ? core_v3_scale(p->normal, -1.0f) : p->normal;
    core_vec3 u = distance > 1e-6f * radius ? core_v3_scale(q, -1.0f / distance) : face;
    if (distance - radius >= margin || (p->one_sided && height < 0.0f)) {
        return;
    }
    if (core_v3_dot(u, face) > 1.0f - 0.5f * ALLOW_SPHERE * ALLOW_SPHERE) {
        u = face;
    } else if (!direction_allowed(p, u, ALLOW_SPHERE)) {
        return; // nearer to a neighbour
    }
    float separation = distance - radius;
    one_point(m, core_v3_scale(u, -1.0f), core_v3_mad(q, u, 0.5f * separation), separation, 0);
}

// The patch as a flat hull: a front and a back.
typedef struct flat_hull {
    phys_geom_hull hull;
    core_vec3 normal[2];
    float offset[2];
    uint32_t begin[3], loop[2 * PHYS_PATCH_CORNERS];
} flat_hull;

static phys_geom patch_geom(const phys_patch *p, flat_hull *f) {
    f->normal[0] = p->normal;
    f->normal[1] = core_v3_scale(p->normal, -1.0f);
    f->offset[0] = core_v3_dot(p->corner[0], p->normal);
    f->offset[1] = -f->offset[0];
    f->begin[0] = 0;
    f->begin[1] = p->count;
    f->begin[2] = 2 * p->count;
    for (uint32_t k = 0; k < p->count; k++) {
        f->loop[k] = k;
        f->loop[p->count + k] = p->count - 1 - k;
    }
    f->hull = (phys_geom_hull){.vertex_count = p->count,
                               .face_count = 2,
                               .loop_count = 2 * p->count,
                               .vertex = (core_vec3 *)(uintptr_t)p->corner,
                               .normal = f->normal,
                               .offset = f->offset,
                               .face_begin = f->begin,
                               .loop = f->loop};
    phys_geom g =
        phys_geom_make(PHYS_HULL, core_v3(0, 0, 0), core_quat_identity(), core_v3(0, 0, 0), 0);
    g.hull = &f->hull;
    return g;
}

static void flip(phys_manifold *m) { m->normal = core_v3_scale(m->normal, -1.0f); }

static float least_gap(const phys_manifold *m) {
    float least = PHYS_APART;
    for (uint32_t k = 0; k < m->count; k++) {
        least = CORE_MIN(least, m->point[k].separation);
    }
    return least;
}

// Side of the patch on which the shape's middle lies.
static float middle_height(const phys_geom *g, const phys_patch *p) {
    core_vec3 c = g->position;
    if (g->type == PHYS_HULL) {
        core_vec3 mean = phys_geom_average(g->hull->vertex, g->hull->vertex_count);
        c = core_v3_add(c, phys_mat_mul(&g->axes, mean));
    }
    return core_v3_dot(core_v3_sub(c, p->corner[0]), p->normal);
}

static void convex_patch(const phys_geom *shape, const phys_patch *p, float margin,
                         phys_manifold *m) {
    flat_hull flat;
    phys_geom patch = patch_geom(p, &flat);
    float height = middle_height(shape, p);
    *m = (phys_manifold){0};
    phys_collide_convex(&patch, shape, margin, m); // the patch first: its face is preferred
    if (m->count == 0) {
        return;
    }
    core_vec3 u = m->normal;
    float up = core_v3_dot(u, p->normal),
          side = up < -0.1f || (up < 0.1f && height < 0.0f) ? -1 : 1;
    float lean = core_v3_length(core_v3_mad(u, p->normal, -up));
    if (p->one_sided && side < 0.0f) {
        if (height < 0.0f) {
            m->count = 0;
            return;
        }
        side = 1.0f;
    }
    bool right_side = up * side >= -ALLOW;
    if (right_side && direction_allowed(p, u, ALLOW)) {
        flip(m);
        return;
    }
    float gap = least_gap(m);
    m->count = 0;
    if (gap > 0.0f && lean > SNAP) { // a neighbour is nearer
        return;
    }
    phys_collide_face(&patch, shape, core_v3_scale(p->normal, side), margin, m);
    float deep = least_gap(m);
    if (m->count != 0 && -deep > 2.0f * CORE_MAX(-gap, 0.0f) + DEEPER) {
        m->count = 0;
    }
    flip(m);
}

void phys_patch_collide(const phys_geom *shape, const phys_patch *p, float margin,
                        phys_manifold *m) {
    m->count = 0;
    if (shape->type == PHYS_SPHERE) {
        sphere_patch(shape->radius, p, margin, m);
    } else {
        convex_patch(shape, p, margin, m);
    }
    uint32_t salt = p->id * 0x9e3779b1u;
    for (uint32_t k = 0; k < m->count; k++) {
        bool corner = (m->point[k].feature & 0x7fffff00u) == 0; // of the shape: the same on any
        m->point[k].feature = corner ? m->point[k].feature : m->point[k].feature ^ salt;
    }
}

float phys_patch_separation(const phys_geom *shape, const phys_patch *p, core_vec3 *normal,
                            core_vec3 *on_patch) {
    flat_hull flat;
    phys_geom patch = patch_geom(p, &flat);
    return phys_closest_on(shape, &patch, normal, on_patch);
}

bool phys_patch_sweep(const phys_moving *shape, const phys_patch *p, float dt, float *time) {
    flat_hull flat;
    phys_moving still = {.geom = patch_geom(p, &flat)};
    return phys_sweep(shape, &still, dt, time);
}

// ---- gathering ----
#define SAME_DIRECTION 0.998f // cosine
#define SAME_PLACE     1e-3f  // m

static bool known(const phys_manifold *m, const phys_point *p) {
    for (uint32_t k = 0; k < m->count; k++) {
        core_vec3 d = core_v3_sub(m->point[k].ra, p->ra);
        if (core_v3_dot(d, d) < SAME_PLACE * SAME_PLACE) {
            return true;
        }
    }
    return false;
}

// Joins the points of two manifolds of one direction, that of the deeper one.
static void join(phys_manifold *m, const phys_manifold *add) {
    core_vec3 p[8];
    float gap[8];
    phys_point all[8];
    int n = 0, keep[4] = {0, 1, 2, 3};
    bool deeper = least_gap(add) < least_gap(m) - 1e-5f;
    const phys_manifold *one = deeper ? add : m, *two = deeper ? m : add;
    phys_manifold out = {.normal = one->normal, .apart = m->apart};
    for (uint32_t k = 0; k < one->count; k++) {
        all[n++] = one->point[k];
    }
    for (uint32_t k = 0; k < two->count; k++) {
        if (!known(one, &two->point[k])) {
            all[n++] = two->point[k];
        }
    }
    for (int i = 0; i < n; i++) {
        p[i] = all[i].ra;
        gap[i] = all[i].separation;
    }
    if (n > 4) {
        phys_manifold_reduce(p, gap, n, out.normal, keep);
    }
    for (int i = 0; i < 4 && i < n; i++) {
        if (keep[i] >= 0) {
            out.point[out.count++] = all[keep[i]];
        }
    }
    *m = out;
}

void phys_parts_add(phys_parts *parts, const phys_manifold *m, uint8_t area) {
    if (m->count == 0) {
        return;
    }
    uint32_t best = PHYS_PARTS;
    float most = SAME_DIRECTION;
    for (uint32_t k = 0; k < parts->count; k++) {
        float d = core_v3_dot(parts->m[k].normal, m->normal);
        if (d > most && parts->area[k] == area) {
            most = d;
            best = k;
        }
    }
    if (best < PHYS_PARTS) {
        join(&parts->m[best], m);
    } else if (parts->count < PHYS_PARTS) {
        parts->area[parts->count] = area;
        parts->m[parts->count++] = *m;
    } else { // too many directions: the shallowest gives way
        uint32_t least = 0;
        for (uint32_t k = 1; k < PHYS_PARTS; k++) {
            least = least_gap(&parts->m[k]) > least_gap(&parts->m[least]) ? k : least;
        }
        if (least_gap(m) < least_gap(&parts->m[least])) {
            parts->m[least] = *m;
            parts->area[least] = area;
        }
    }
}
