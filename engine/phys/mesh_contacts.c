// Meshes against convex shapes: contacts within a step, distance, sweeps and rays. Everything is
// done in the mesh's frame, where its triangles stay as they were given.
#include "phys/mesh_internal.h"

phys_geom phys_geom_seen_from(const phys_geom *g, const phys_geom *frame) {
    phys_geom o = *g;
    o.position = phys_mat_tmul(&frame->axes, core_v3_sub(g->position, frame->position));
    o.rotation = phys_quat_unit(phys_quat_mul(phys_conj(frame->rotation), g->rotation));
    o.axes = phys_quat_mat(o.rotation);
    return o;
}

phys_moving phys_moving_seen_from(const phys_moving *m, const phys_geom *frame) {
    phys_moving o = *m;
    o.geom = phys_geom_seen_from(&m->geom, frame);
    o.center = phys_mat_tmul(&frame->axes, core_v3_sub(m->center, frame->position));
    o.v = phys_mat_tmul(&frame->axes, m->v);
    o.w = phys_mat_tmul(&frame->axes, m->w);
    return o;
}

static core_vec3 triangle_normal(const phys_mesh *m, uint32_t t) {
    core_vec3 a = phys_mesh_corner(m, t, 0), b = phys_mesh_corner(m, t, 1),
              c = phys_mesh_corner(m, t, 2);
    double u[3] = {(double)b.x - a.x, (double)b.y - a.y, (double)b.z - a.z};
    double v[3] = {(double)c.x - a.x, (double)c.y - a.y, (double)c.z - a.z};
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2];
    double z = u[0] * v[1] - u[1] * v[0], l = core_sqrt(x * x + y * y + z * z);
    return core_v3((float)(x / l), (float)(y / l), (float)(z / l));
}

// Normal of the triangle over edge k, turned so that its front goes on where t's ends.
static core_vec3 normal_over(const phys_mesh *m, uint32_t t, uint32_t k) {
    uint32_t other =
        m->height != NULL ? phys_heights_beyond(m, t, k) : m->beyond[3 * (size_t)t + k];
    if (other == PHYS_MESH_NONE) {
        return core_v3(0, 0, 0);
    }
    core_vec3 n = triangle_normal(m, other);
    if (m->height != NULL) { // all look up
        return n;
    }
    uint32_t a = m->index[3 * (size_t)t + k];
    uint32_t b = m->index[3 * (size_t)t + (k == 2 ? 0 : k + 1)];
    const uint32_t *i = m->index + 3 * (size_t)other;
    bool same_way =
        (i[0] == a && i[1] == b) || (i[1] == a && i[2] == b) || (i[2] == a && i[0] == b);
    return same_way ? core_v3_scale(n, -1.0f) : n;
}

bool phys_mesh_patch(const phys_mesh *m, uint32_t t, core_vec3 center, float reach,
                     phys_patch *out) {
    core_vec3 corner[3], over[3];
    if (!phys_mesh_there(m, t)) {
        return false;
    }
    for (uint32_t k = 0; k < 3; k++) {
        corner[k] = phys_mesh_corner(m, t, k);
        over[k] = normal_over(m, t, k);
    }
    out->id = t;
    out->one_sided = m->one_sided;
    return phys_patch_make(corner, over, center, reach, out);
}

// Farthest point of a shape from its position.
static float reach_of(const phys_geom *g) {
    core_aabb b = phys_geom_bounds(g);
    core_vec3 lo = phys_abs3(core_v3_sub(b.min, g->position));
    core_vec3 hi = phys_abs3(core_v3_sub(b.max, g->position));
    return core_v3_length(
        core_v3(CORE_MAX(lo.x, hi.x), CORE_MAX(lo.y, hi.y), CORE_MAX(lo.z, hi.z)));
}

static phys_box grown(core_aabb b, core_vec3 way, float by) {
    return (phys_box){{b.min.x + CORE_MIN(way.x, 0.0f) - by, b.min.y + CORE_MIN(way.y, 0.0f) - by,
                       b.min.z + CORE_MIN(way.z, 0.0f) - by},
                      {b.max.x + CORE_MAX(way.x, 0.0f) + by, b.max.y + CORE_MAX(way.y, 0.0f) + by,
                       b.max.z + CORE_MAX(way.z, 0.0f) + by}};
}

// The shape about its own position: what patches are seen from.
static phys_moving about_itself(const phys_moving *m) {
    phys_moving o = *m;
    o.center = core_v3_sub(m->center, m->geom.position);
    o.geom.position = core_v3(0, 0, 0);
    return o;
}

// What a shape that goes far meets on its way through one triangle.
static void sweep_patch(const phys_moving *shape, const phys_patch *p, float dt, phys_manifold *m) {
    float t;
    m->count = 0;
    if (!phys_patch_sweep(shape, p, dt, &t)) {
        return;
    }
    phys_geom at = phys_moving_at(shape, t);
    phys_patch then = *p; // patches are seen from the shape
    for (uint32_t k = 0; k < then.count; k++) {
        then.corner[k] = core_v3_sub(p->corner[k], at.position);
    }
    core_vec3 place = at.position;
    at.position = core_v3(0, 0, 0);
    phys_patch_collide(&at, &then, PHYS_MARGIN, m);
    for (uint32_t k = 0; k < m->count; k++) {
        m->point[k].ra = core_v3_add(m->point[k].ra, place);
        m->point[k].rb = core_v3_add(m->point[k].rb, place);
    }
    phys_swept_points(shape, &(phys_moving){0}, t, m);
}

static bool touches(const phys_manifold *m) {
    for (uint32_t k = 0; k < m->count; k++) {
        if (m->point[k].separation < PHYS_NEAR) {
            return true;
        }
    }
    return false;
}

void phys_mesh_contacts(const phys_mesh *mesh, const phys_moving *shape, float margin, bool fast,
                        float dt, phys_parts *out) {
    core_vec3 way = core_v3_scale(shape->v, fast ? dt : 0.0f);
    float turn = fast ? core_v3_length(shape->w) * shape->extent * dt : 0.0f;
    float reach = reach_of(&shape->geom) + margin + core_v3_length(way) + turn;
    phys_box box = grown(phys_geom_bounds(&shape->geom), way, margin + turn);
    phys_moving near = about_itself(shape);
    phys_mesh_walk walk;
    phys_mesh_walk_begin(&walk, mesh, &box);
    out->count = 0;
    for (uint32_t t; (t = phys_mesh_walk_next(&walk)) != PHYS_MESH_NONE;) {
        phys_patch p;
        phys_manifold m = {0};
        if (!phys_mesh_patch(mesh, t, shape->geom.position, reach, &p)) {
            continue;
        }
        phys_patch_collide(&near.geom, &p, margin, &m);
        if (fast && !touches(&m)) {
            sweep_patch(&near, &p, dt, &m);
        }
        phys_parts_add(out, &m, phys_mesh_area(mesh, t));
    }
    for (uint32_t k = 0; k < out->count; k++) {
        for (uint32_t i = 0; i < out->m[k].count; i++) {
            phys_point *p = &out->m[k].point[i];
            p->ra = core_v3_add(p->ra, shape->geom.position);
            p->rb = core_v3_add(p->rb, shape->geom.position);
        }
    }
}

void phys_mesh_collide(const phys_geom *shape, const phys_geom *mesh, float margin,
                       phys_manifold *out) {
    phys_moving still = {.geom = phys_geom_seen_from(shape, mesh)};
    phys_parts parts;
    phys_mesh_contacts(mesh->mesh, &still, margin, false, 0.0f, &parts);
    uint32_t best = 0;
    float least = PHYS_APART;
    for (uint32_t k = 0; k < parts.count; k++) {
        for (uint32_t i = 0; i < parts.m[k].count; i++) {
            if (parts.m[k].point[i].separation < least) {
                least = parts.m[k].point[i].separation;
                best = k;
            }
        }
    }
    out->count = 0;
    if (parts.count == 0) {
        return;
    }
    *out = parts.m[best];
    phys_manifold_place(out, mesh);
}

uint32_t phys_mesh_touches(const phys_geom *shape, const phys_geom *mesh, float reach,
                           core_vec3 normal[PHYS_PARTS], core_vec3 on_mesh[PHYS_PARTS],
                           float gap[PHYS_PARTS]) {
    phys_moving still = {.geom = phys_geom_seen_from(shape, mesh)};
    phys_parts parts;
    phys_mesh_contacts(mesh->mesh, &still, reach, false, 0.0f, &parts);
    for (uint32_t k = 0; k < parts.count; k++) {
        phys_manifold *m = &parts.m[k];
        phys_manifold_place(m, mesh);
        uint32_t best = 0;
        for (uint32_t i = 1; i < m->count; i++) {
            best = m->point[i].separation < m->point[best].separation ? i : best;
        }
        normal[k] = m->normal;
        gap[k] = m->point[best].separation;
        on_mesh[k] = core_v3_mad(m->point[best].rb, m->normal, 0.5f * gap[k]);
    }
    return parts.count;
}

void phys_manifold_place(phys_manifold *m, const phys_geom *frame) {
    m->normal = phys_mat_mul(&frame->axes, m->normal);
    for (uint32_t i = 0; i < m->count; i++) {
        phys_point *p = &m->point[i];
        p->ra = core_v3_add(frame->position, phys_mat_mul(&frame->axes, p->ra));
        p->rb = core_v3_add(frame->position, phys_mat_mul(&frame->axes, p->rb));
    }
}

static float box_distance2(const phys_mesh_node *n, const core_aabb *b) {
    float lo[3] = {b->min.x, b->min.y, b->min.z}, hi[3] = {b->max.x, b->max.y, b->max.z}, d2 = 0;
    for (int k = 0; k < 3; k++) {
        float d = CORE_MAX(CORE_MAX(n->lo[k] - hi[k], lo[k] - n->hi[k]), 0.0f);
        d2 += d * d;
    }
    return d2;
}

bool phys_mesh_near(const phys_geom *shape, const phys_geom *mesh, float reach) {
    phys_geom g = phys_geom_seen_from(shape, mesh);
    phys_box box = grown(phys_geom_bounds(&g), core_v3(0, 0, 0), reach);
    phys_mesh_walk walk;
    phys_mesh_walk_begin(&walk, mesh->mesh, &box);
    return phys_mesh_walk_next(&walk) != PHYS_MESH_NONE;
}

// Nearest triangle, branch and bound by the distance of boxes.
float phys_mesh_separation(const phys_geom *shape, const phys_geom *mesh, core_vec3 *normal,
                           core_vec3 *on_mesh) {
    const phys_mesh *m = mesh->mesh;
    phys_geom g = phys_geom_seen_from(shape, mesh);
    core_aabb box = phys_geom_bounds(&g);
    core_vec3 center = g.position;
    float reach = reach_of(&g), best = PHYS_APART;
    g.position = core_v3(0, 0, 0);
    uint32_t stack[64], depth = 0;
    stack[depth++] = 0;
    *normal = core_v3(0, 1, 0);
    *on_mesh = core_v3(0, 0, 0);
    while (depth != 0) {
        const phys_mesh_node *n = &m->node[stack[--depth]];
        float bound = CORE_MAX(best, 0.0f);
        if (best < PHYS_APART && box_distance2(n, &box) > bound * bound) {
            continue;
        }
        if (n->count == 0) {
            bool left = box_distance2(&m->node[n->first], &box) <=
                        box_distance2(&m->node[n->first + 1], &box);
            stack[depth++] = left ? n->first + 1 : n->first;
            stack[depth++] = left ? n->first : n->first + 1;
            continue;
        }
        for (uint32_t t = n->first; t < n->first + n->count; t++) {
            phys_patch p;
            core_vec3 u, q;
            float far = best < PHYS_APART ? best : PHYS_FAR;
            if (!phys_mesh_patch(m, t, center, reach + CORE_MAX(far, 0.0f), &p)) {
                continue;
            }
            float gap = phys_patch_separation(&g, &p, &u, &q);
            if (gap < best) {
                best = gap;
                *normal = u;
                *on_mesh = q;
            }
        }
    }
    *normal = phys_mat_mul(&mesh->axes, *normal);
    *on_mesh =
        core_v3_add(mesh->position, phys_mat_mul(&mesh->axes, core_v3_add(center, *on_mesh)));
    return best;
}

// Whether a ball of radius r on the way from o to o + d meets the node's box before time t_max.
static bool line_meets(const phys_mesh_node *n, core_vec3 o, core_vec3 d, float r, float t_max) {
    float from[3] = {o.x, o.y, o.z}, way[3] = {d.x, d.y, d.z}, t0 = 0.0f, t1 = t_max;
    for (int k = 0; k < 3; k++) {
        float lo = n->lo[k] - r - from[k], hi = n->hi[k] + r - from[k];
        if (way[k] == 0.0f) {
            if (lo > 0.0f || hi < 0.0f) {
                return false;
            }
            continue;
        }
        float a = lo / way[k], b = hi / way[k];
        t0 = CORE_MAX(t0, CORE_MIN(a, b));
        t1 = CORE_MIN(t1, CORE_MAX(a, b));
    }
    return t0 <= t1 * (1.0f + 1e-5f) + 1e-6f;
}

// Descends along a line; the caller looks at leaves. Nodes beyond *limit are passed over.
typedef struct line_walk {
    const phys_mesh *mesh;
    core_vec3 o, d;
    float r;
    uint32_t stack[64], depth;
} line_walk;

static const phys_mesh_node *line_next(line_walk *w, float limit) {
    while (w->depth != 0) {
        const phys_mesh_node *n = &w->mesh->node[w->stack[--w->depth]];
        if (!line_meets(n, w->o, w->d, w->r, limit)) {
            continue;
        }
        if (n->count != 0) {
            return n;
        }
        // The child whose middle lies further back along the way first.
        const phys_mesh_node *a = &w->mesh->node[n->first], *b = a + 1;
        float ahead = (a->lo[0] + a->hi[0] - b->lo[0] - b->hi[0]) * w->d.x +
                      (a->lo[1] + a->hi[1] - b->lo[1] - b->hi[1]) * w->d.y +
                      (a->lo[2] + a->hi[2] - b->lo[2] - b->hi[2]) * w->d.z;
        w->stack[w->depth++] = ahead > 0.0f ? n->first : n->first + 1;
        w->stack[w->depth++] = ahead > 0.0f ? n->first + 1 : n->first;
    }
    return NULL;
}

bool phys_mesh_sweep(const phys_moving *shape, const phys_geom *mesh, float dt, float *time) {
    phys_moving local = phys_moving_seen_from(shape, mesh), near = about_itself(&local);
    float arm = core_v3_length(core_v3_sub(local.geom.position, local.center));
    float body = reach_of(&local.geom), reach = body + core_v3_length(local.v) * dt + 2.0f * arm;
    line_walk walk = {mesh->mesh, local.geom.position, local.v, body + 2.0f * arm, {0}, 1};
    float best = dt;
    bool hit = false;
    for (const phys_mesh_node *n; (n = line_next(&walk, best)) != NULL;) {
        for (uint32_t k = n->first; k < n->first + n->count; k++) {
            phys_patch p;
            float t;
            if (phys_mesh_patch(mesh->mesh, k, local.geom.position, reach, &p) &&
                (!p.one_sided || core_v3_dot(local.v, p.normal) <= 0.0f) &&
                phys_patch_sweep(&near, &p, best, &t) && (!hit || t < best)) {
                best = t;
                hit = true;
            }
        }
    }
    *time = best;
    return hit;
}

typedef struct dray {
    double o[3], d[3];
} dray;

// Moeller, Trumbore, "Fast, minimum storage ray/triangle intersection", 1997, on doubles; edges and
// corners belong to every triangle that has them, so that no ray slips between two.
static bool ray_triangle(const dray *r, core_vec3 pa, core_vec3 pb, core_vec3 pc, bool one_sided,
                         double *t) {
    double a[3] = {pa.x, pa.y, pa.z},
           e1[3] = {(double)pb.x - pa.x, (double)pb.y - pa.y, (double)pb.z - pa.z};
    double e2[3] = {(double)pc.x - pa.x, (double)pc.y - pa.y, (double)pc.z - pa.z};
    double s[3] = {r->o[0] - a[0], r->o[1] - a[1], r->o[2] - a[2]};
    double n[3] = {e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2],
                   e1[0] * e2[1] - e1[1] * e2[0]};
    double det = -(r->d[0] * n[0] + r->d[1] * n[1] + r->d[2] * n[2]);
    if (det == 0.0 || (one_sided && det < 0.0)) {
        return false;
    }
    double c[3] = {s[1] * r->d[2] - s[2] * r->d[1], s[2] * r->d[0] - s[0] * r->d[2],
                   s[0] * r->d[1] - s[1] * r->d[0]};
    double u = (e2[0] * c[0] + e2[1] * c[1] + e2[2] * c[2]) / det;
    double v = -(e1[0] * c[0] + e1[1] * c[1] + e1[2] * c[2]) / det;
    *t = (s[0] * n[0] + s[1] * n[1] + s[2] * n[2]) / det;
    const double slack = 1e-9;
    return u >= -slack && v >= -slack && u + v <= 1.0 + slack && *t >= 0.0;
}

phys_geom_ray_hit phys_mesh_ray(const phys_geom *mesh, core_vec3 o, core_vec3 d, float t_max,
                                uint32_t *triangle) {
    const phys_mesh *m = mesh->mesh;
    phys_geom_ray_hit hit = phys_geom_ray_miss();
    core_vec3 lo = phys_mat_tmul(&mesh->axes, core_v3_sub(o, mesh->position));
    core_vec3 ld = phys_mat_tmul(&mesh->axes, d);
    dray ray = {{lo.x, lo.y, lo.z}, {ld.x, ld.y, ld.z}};
    double best = t_max;
    line_walk walk = {m, lo, ld, 0.0f, {0}, 1};
    for (const phys_mesh_node *n; (n = line_next(&walk, (float)best)) != NULL;) {
        for (uint32_t k = n->first; k < n->first + n->count; k++) {
            double t;
            if (!phys_mesh_there(m, k) ||
                !ray_triangle(&ray, phys_mesh_corner(m, k, 0), phys_mesh_corner(m, k, 1),
                              phys_mesh_corner(m, k, 2), m->one_sided, &t) ||
                !(t < best || (t == best && (!hit.hit || k < *triangle)))) {
                continue;
            }
            best = t;
            hit.hit = true;
            *triangle = k;
        }
    }
    if (hit.hit) {
        core_vec3 normal = phys_mat_mul(&mesh->axes, triangle_normal(m, *triangle));
        hit.t = (float)best;
        hit.point = core_v3_mad(o, d, hit.t);
        hit.normal = core_v3_dot(normal, d) > 0.0f ? core_v3_scale(normal, -1.0f) : normal;
    }
    return hit;
}
