// What particles of a cloth may touch in a step: for each the planes of the two nearest bodies,
// which move with them. A particle that is outside of a convex shape stays on its side of the plane
// through the closest point, so that no speed takes it through.
#include "phys/mesh_internal.h"

#define SHAPES 256u  // around one cloth; farther ones of a heap beyond that are not felt
#define SLACK  0.02f // m: particles look this far beyond their way

// Distance of a point to a surface, < 0 inside, and the direction away from it.
static float box_distance(const phys_geom *g, core_vec3 l, core_vec3 *n) {
    core_vec3 a = core_v3_sub(phys_abs3(l), g->half);
    core_vec3 out = core_v3(CORE_MAX(a.x, 0.0f), CORE_MAX(a.y, 0.0f), CORE_MAX(a.z, 0.0f));
    float d = core_v3_length(out);
    core_vec3 sign =
        core_v3(l.x < 0 ? -1.0f : 1.0f, l.y < 0 ? -1.0f : 1.0f, l.z < 0 ? -1.0f : 1.0f);
    if (d <= 1e-7f) {
        d = CORE_MAX(a.x, CORE_MAX(a.y, a.z));
        out = core_v3(a.x == d ? 1.0f : 0.0f, a.x != d && a.y == d ? 1.0f : 0.0f,
                      a.x != d && a.y != d ? 1.0f : 0.0f);
        *n = core_v3(out.x * sign.x, out.y * sign.y, out.z * sign.z);
        return d;
    }
    *n = core_v3(out.x * sign.x / d, out.y * sign.y / d, out.z * sign.z / d);
    return d;
}

static float cylinder_distance(const phys_geom *g, core_vec3 l, core_vec3 *n) {
    float side = core_sqrtf(l.x * l.x + l.z * l.z), s = l.y < 0.0f ? -1.0f : 1.0f;
    float r = side - g->radius, y = core_absf(l.y) - g->half_height;
    core_vec3 radial = side > 1e-9f ? core_v3(l.x / side, 0, l.z / side) : core_v3(1, 0, 0);
    if (r <= 0.0f || y <= 0.0f) {
        *n = r > y ? radial : core_v3(0, s, 0);
        return CORE_MAX(r, y);
    }
    float d = core_sqrtf(r * r + y * y);
    *n = core_v3(radial.x * r / d, s * y / d, radial.z * r / d);
    return d;
}

static float hull_distance(const phys_geom *g, core_vec3 l, core_vec3 *n) {
    const phys_geom_hull *h = g->hull;
    float most = -PHYS_APART;
    for (uint32_t i = 0; i < h->face_count; i++) {
        float d = core_v3_dot(h->normal[i], l) - h->offset[i];
        if (d > most) {
            most = d;
            *n = h->normal[i];
        }
    }
    return most;
}

static float distance(const phys_geom *g, core_vec3 p, core_vec3 *n) {
    core_vec3 local = phys_mat_tmul(&g->axes, core_v3_sub(p, g->position)), d = local;
    float size = 0.0f;
    switch (g->type) {
    case PHYS_PLANE:
        *n = phys_mat_col(&g->axes, 1);
        return local.y;
    case PHYS_BOX:
        size = box_distance(g, local, n);
        break;
    case PHYS_CYLINDER:
        size = cylinder_distance(g, local, n);
        break;
    case PHYS_HULL:
        size = hull_distance(g, local, n);
        break;
    default:
        if (g->type == PHYS_CAPSULE) {
            d.y -= CORE_CLAMP(d.y, -g->half_height, g->half_height);
        }
        size = core_v3_length(d);
        *n = size > 1e-9f ? core_v3_scale(d, 1.0f / size) : core_v3(0, 1, 0);
        size -= g->radius;
    }
    *n = phys_mat_mul(&g->axes, *n);
    return size;
}

core_aabb phys_cloth_reach(const phys_world *w, uint32_t i, float dt) {
    const phys_cloths *c = &w->cloths;
    const phys_particles *p = &w->particles;
    uint32_t first = c->first[i], end = first + c->columns[i] * c->rows[i];
    core_aabb box = {core_v3(PHYS_APART, PHYS_APART, PHYS_APART),
                     core_v3(-PHYS_APART, -PHYS_APART, -PHYS_APART)};
    float fall = core_v3_length(w->gravity) * dt * dt;
    for (uint32_t k = first; k < end; k++) {
        core_vec3 at = phys_get3(p->x, p->y, p->z, k);
        core_vec3 way = phys_abs3(core_v3_scale(phys_get3(p->vx, p->vy, p->vz, k), dt));
        core_vec3 lo = core_v3_sub(at, way), hi = core_v3_add(at, way);
        box.min = core_v3(CORE_MIN(box.min.x, lo.x), CORE_MIN(box.min.y, lo.y),
                          CORE_MIN(box.min.z, lo.z));
        box.max = core_v3(CORE_MAX(box.max.x, hi.x), CORE_MAX(box.max.y, hi.y),
                          CORE_MAX(box.max.z, hi.z));
    }
    float grow = c->radius[i] + SLACK + fall;
    core_vec3 e = core_v3(grow, grow, grow);
    return (core_aabb){core_v3_sub(box.min, e), core_v3_add(box.max, e)};
}

static void keep_plane(phys_cloth_contact *c, uint32_t i, core_vec3 n, float d, float gap,
                       core_vec3 u, float grip, uint32_t body) {
    phys_put3(c->n[0], c->n[1], c->n[2], i, n);
    phys_put3(c->u[0], c->u[1], c->u[2], i, u);
    c->d[i] = d;
    c->dv[i] = core_v3_dot(n, u);
    c->gap[i] = gap;
    c->grip[i] = grip;
    c->body[i] = body;
}

static void copy_plane(phys_cloth_contact *to, const phys_cloth_contact *from, uint32_t i) {
    keep_plane(to, i, phys_get3(from->n[0], from->n[1], from->n[2], i), from->d[i], from->gap[i],
               phys_get3(from->u[0], from->u[1], from->u[2], i), from->grip[i], from->body[i]);
}

// The nearer of the two comes first; equal gaps keep the shape that was found first.
static void offer_plane(phys_cloth_work *k, uint32_t i, core_vec3 n, float d, float gap,
                        core_vec3 u, float grip, uint32_t body) {
    phys_cloth_contact *near = &k->contact[0], *next = &k->contact[1];
    if (gap < near->gap[i]) {
        copy_plane(next, near, i);
        keep_plane(near, i, n, d, gap, u, grip, body);
    } else if (gap < next->gap[i]) {
        keep_plane(next, i, n, d, gap, u, grip, body);
    }
    k->touches = true;
}

static bool meets(const core_aabb *b, core_vec3 p, float reach) {
    return p.x >= b->min.x - reach && p.x <= b->max.x + reach && p.y >= b->min.y - reach &&
           p.y <= b->max.y + reach && p.z >= b->min.z - reach && p.z <= b->max.z + reach;
}

// A body as the particles of one cloth see it in this step.
typedef struct touched {
    phys_geom geom;
    core_aabb bounds;
    core_vec3 v, spin, center;
    float radius, grip; // of the particles; friction of both
    uint32_t row;
} touched;

static void offer(phys_cloth_work *k, uint32_t i, const touched *t, core_vec3 p, core_vec3 n,
                  float gap) {
    core_vec3 foot = core_v3_mad(p, n, -(gap + t->radius));
    core_vec3 u = core_v3_add(t->v, core_v3_cross(t->spin, core_v3_sub(foot, t->center)));
    offer_plane(k, i, n, core_v3_dot(n, p) - gap, gap, u, t->grip, t->row);
}

static void touch_particle(phys_cloth_work *k, uint32_t i, const touched *t, float dt) {
    core_vec3 p = phys_get3(k->x[0], k->x[1], k->x[2], i), n;
    core_vec3 pv = phys_get3(k->v[0], k->v[1], k->v[2], i);
    float reach = SLACK + core_v3_length(core_v3_sub(pv, t->v)) * dt;
    if (k->held[i] != 0.0f || !meets(&t->bounds, p, t->radius + reach)) {
        return;
    }
    if (t->geom.type != PHYS_MESH) {
        float gap = distance(&t->geom, p, &n) - t->radius;
        if (gap <= reach) {
            offer(k, i, t, p, n, gap);
        }
        return;
    }
    phys_geom ball =
        phys_geom_make(PHYS_SPHERE, p, core_quat_identity(), core_v3(0, 0, 0), t->radius);
    core_vec3 to[PHYS_PARTS], on[PHYS_PARTS];
    float gap[PHYS_PARTS];
    uint32_t count = phys_mesh_touches(&ball, &t->geom, reach, to, on, gap);
    for (uint32_t j = 0; j < count; j++) {
        offer(k, i, t, p, core_v3_scale(to[j], -1.0f), gap[j]);
    }
}

static void touch_shape(phys_world *w, phys_cloth_work *k, uint32_t shape, float dt) {
    const phys_bodies *b = &w->bodies;
    const phys_cloths *all = &w->cloths;
    touched t = {.geom = phys_shape_geom(w, shape), .radius = all->radius[k->cloth]};
    t.bounds = phys_geom_bounds(&t.geom);
    t.row = phys_slot_row(&b->set, w->shapes.body[shape]);
    t.center = phys_get3(b->cx, b->cy, b->cz, t.row);
    t.grip = core_sqrtf(all->friction[k->cloth] * w->shapes.friction[shape]);
    if (phys_moves(b, t.row)) {
        t.v = phys_get3(b->vx, b->vy, b->vz, t.row);
        t.spin = phys_get3(b->wx, b->wy, b->wz, t.row);
    }
    for (uint32_t r = 0; r < k->rows; r++) {
        for (uint32_t c = 0; c < k->columns; c++) {
            touch_particle(k, r * k->stride + c, &t, dt);
        }
    }
}

void phys_cloth_find_contacts(phys_world *w, phys_cloth_work *k, float dt) {
    core_aabb reach = phys_cloth_reach(w, k->cloth, dt);
    phys_box box = {{reach.min.x, reach.min.y, reach.min.z},
                    {reach.max.x, reach.max.y, reach.max.z}};
    uint32_t shape[SHAPES], found = phys_query_shapes(w, &box, shape, SHAPES);
    uint32_t rule = w->rule[w->cloths.layer[k->cloth]];
    for (uint32_t i = 0; i < CORE_MIN(found, SHAPES); i++) {
        uint32_t row = phys_slot_row(&w->bodies.set, w->shapes.body[shape[i]]);
        if (rule >> w->bodies.layer[row] & 1u) {
            touch_shape(w, k, shape[i], dt);
        }
    }
}
