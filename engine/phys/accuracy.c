// How right the present state is, computed from poses in double precision. Shares no code with the
// narrow phase or the solver on purpose: it judges them.
#include "phys/mesh_internal.h"

typedef struct v3 {
    double x, y, z;
} v3;
typedef struct solid {
    v3 p, axis[3], half;   // axis: unit, world
    double radius, lo, hi; // lo, hi: extent along x
    const phys_geom_hull *hull;
    const phys_mesh *mesh;
    uint32_t body, type;
    bool fixed;
} solid;

static v3 sub(v3 a, v3 b) { return (v3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static v3 cross(v3 a, v3 b) {
    return (v3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static double dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static double len(v3 a) { return core_sqrt(dot(a, a)); }
static double mag(double x) { return x < 0 ? -x : x; }

static v3 turn(core_quat q, v3 v) {
    double n =
        core_sqrt((double)q.x * q.x + (double)q.y * q.y + (double)q.z * q.z + (double)q.w * q.w);
    v3 u = {q.x / n, q.y / n, q.z / n}, c = cross(u, v), cc = cross(u, c);
    double w = 2.0 * q.w / n;
    return (v3){v.x + w * c.x + 2 * cc.x, v.y + w * c.y + 2 * cc.y, v.z + w * c.z + 2 * cc.z};
}

// How far a shape reaches along a unit direction from its position.
static double support(const solid *s, v3 n) {
    v3 l = {dot(n, s->axis[0]), dot(n, s->axis[1]), dot(n, s->axis[2])};
    double far = -1e300;
    switch (s->type) {
    case PHYS_SPHERE:
        return s->radius;
    case PHYS_BOX:
        return mag(l.x) * s->half.x + mag(l.y) * s->half.y + mag(l.z) * s->half.z;
    case PHYS_CAPSULE:
        return mag(l.y) * s->half.y + s->radius;
    case PHYS_CYLINDER:
        return mag(l.y) * s->half.y + s->radius * core_sqrt(l.x * l.x + l.z * l.z);
    default:
        for (uint32_t i = 0; i < s->hull->vertex_count; i++) {
            core_vec3 v = s->hull->vertex[i];
            far = CORE_MAX(far, l.x * v.x + l.y * v.y + l.z * v.z);
        }
        return far;
    }
}

static solid make_solid(const phys_world *w, uint32_t i) {
    const phys_shapes *s = &w->shapes;
    const phys_bodies *b = &w->bodies;
    uint32_t row = phys_slot_row(&b->set, s->body[i]);
    core_quat q = phys_body_quat(b, row), l = s->rotation[i];
    v3 at = turn(q, (v3){s->position[i].x, s->position[i].y, s->position[i].z});
    solid o = {.p = {b->px[row] + at.x, b->py[row] + at.y, b->pz[row] + at.z},
               .half = {s->half[i].x, s->half[i].y, s->half[i].z},
               .radius = s->radius[i],
               .body = row,
               .type = s->type[i],
               .fixed = b->type[row] != PHYS_DYNAMIC};
    o.axis[0] = turn(q, turn(l, (v3){1, 0, 0}));
    o.axis[1] = turn(q, turn(l, (v3){0, 1, 0}));
    o.axis[2] = turn(q, turn(l, (v3){0, 0, 1}));
    if (o.type == PHYS_MESH) {
        phys_geom g = phys_shape_geom(w, i);
        core_aabb box = phys_geom_bounds(&g);
        o.mesh = g.mesh;
        o.lo = box.min.x;
        o.hi = box.max.x;
        return o;
    }
    o.hull = s->hull[i] ? &w->hulls[s->hull[i] - 1].hull : NULL;
    if (o.type == PHYS_PLANE) {
        o.lo = -1e30;
        o.hi = 1e30;
        return o;
    }
    double e = CORE_MAX(support(&o, (v3){1, 0, 0}), support(&o, (v3){-1, 0, 0}));
    o.lo = o.p.x - e;
    o.hi = o.p.x + e;
    return o;
}

static v3 into(const solid *box, v3 p) {
    v3 d = sub(p, box->p);
    return (v3){dot(d, box->axis[0]), dot(d, box->axis[1]), dot(d, box->axis[2])};
}

static double depth_sphere_box(const solid *s, const solid *b) {
    v3 c = into(b, s->p), h = b->half;
    v3 q = {CORE_CLAMP(c.x, -h.x, h.x), CORE_CLAMP(c.y, -h.y, h.y), CORE_CLAMP(c.z, -h.z, h.z)};
    double d = len(sub(c, q));
    if (d > 0) {
        return s->radius - d;
    }
    double gx = h.x - mag(c.x), gy = h.y - mag(c.y), gz = h.z - mag(c.z);
    return s->radius + CORE_MIN(gx, CORE_MIN(gy, gz));
}

// The least overlap found so far, and its direction.
typedef struct least_axis {
    double overlap;
    v3 n;
} least_axis;

// Overlap along an axis from a to b. False: they are apart.
static bool try_axis(const solid *a, const solid *b, v3 n, least_axis *least) {
    double l = len(n);
    if (l < 1e-8) {
        return true;
    }
    n = (v3){n.x / l, n.y / l, n.z / l};
    v3 back = {-n.x, -n.y, -n.z};
    double d = dot(sub(b->p, a->p), n);
    double forward = support(a, n) + support(b, back) - d;
    double backward = support(a, back) + support(b, n) + d;
    double overlap = CORE_MIN(forward, backward);
    if (overlap < least->overlap) {
        *least = (least_axis){overlap, n};
    }
    return least->overlap > 0;
}

static uint32_t direction_count(const solid *s, bool faces) {
    switch (s->type) {
    case PHYS_BOX:
        return 3;
    case PHYS_CYLINDER:
        return 1;
    case PHYS_CAPSULE:
        return faces ? 0 : 1;
    case PHYS_HULL:
        return faces ? s->hull->face_count : s->hull->loop_count;
    default:
        return 0;
    }
}

// Direction i of the faces, or of the edges.
static v3 direction(const solid *s, uint32_t i, bool faces) {
    if (s->type != PHYS_HULL) {
        return s->type == PHYS_BOX ? s->axis[i] : s->axis[1];
    }
    core_vec3 l = faces ? s->hull->normal[i] : core_v3(0, 0, 0);
    if (!faces) { // edge i of the loops; each edge is met twice, once a side
        uint32_t f = 0;
        while (i >= s->hull->face_begin[f + 1]) {
            f++;
        }
        uint32_t next = i + 1 == s->hull->face_begin[f + 1] ? s->hull->face_begin[f] : i + 1;
        core_vec3 p = s->hull->vertex[s->hull->loop[i]], q = s->hull->vertex[s->hull->loop[next]];
        l = s->hull->loop[i] < s->hull->loop[next] ? core_v3_sub(q, p) : core_v3(0, 0, 0);
    }
    v3 x = s->axis[0], y = s->axis[1], z = s->axis[2];
    return (v3){x.x * l.x + y.x * l.y + z.x * l.z, x.y * l.x + y.y * l.y + z.y * l.z,
                x.z * l.x + y.z * l.y + z.z * l.z};
}

static v3 add_scaled(v3 a, v3 b, double s) {
    return (v3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

static bool curved(const solid *s) {
    return s->type == PHYS_SPHERE || s->type == PHYS_CAPSULE || s->type == PHYS_CYLINDER;
}

// Round sides have endless axes: goes downhill from the best of the others (Hooke, Jeeves, "Direct
// search", 1961).
static void try_around(const solid *a, const solid *b, least_axis *least) {
    for (double step = 0.5; step > 1e-5;) {
        v3 n = least->n, side = mag(n.x) < 0.7 ? (v3){1, 0, 0} : (v3){0, 1, 0};
        v3 t = cross(n, side), u = cross(n, t);
        double before = least->overlap;
        for (int k = 0; k < 8; k++) {
            static const int x[] = {1, 1, 0, -1, -1, -1, 0, 1}, y[] = {0, 1, 1, 1, 0, -1, -1, -1};
            v3 way = add_scaled(add_scaled(n, t, step * x[k]), u, step * y[k]);
            if (!try_axis(a, b, way, least)) {
                return;
            }
        }
        step *= least->overlap < before ? 1.0 : 0.5;
    }
}

// Separating axes: face normals, edge pairs, and the line of centres for round shapes.
static double depth_axes(const solid *a, const solid *b) {
    least_axis least = {1e300, {0, 1, 0}};
    if (!try_axis(a, b, sub(b->p, a->p), &least)) {
        return least.overlap;
    }
    for (int side = 0; side < 2; side++) {
        const solid *s = side ? b : a;
        for (uint32_t i = 0; i < direction_count(s, true); i++) {
            if (!try_axis(a, b, direction(s, i, true), &least)) {
                return least.overlap;
            }
        }
    }
    for (uint32_t i = 0; i < direction_count(a, false); i++) {
        v3 u = direction(a, i, false);
        for (uint32_t j = 0; j < direction_count(b, false) && dot(u, u) > 0; j++) {
            if (!try_axis(a, b, cross(u, direction(b, j, false)), &least)) {
                return least.overlap;
            }
        }
    }
    if (curved(a) || curved(b)) {
        try_around(a, b, &least);
    }
    return least.overlap;
}

static double line_distance(v3 p, v3 a, v3 b) {
    v3 ab = sub(b, a);
    double l2 = dot(ab, ab), t = l2 > 0 ? dot(sub(p, a), ab) / l2 : 0;
    return len(sub(p, add_scaled(a, ab, CORE_CLAMP(t, 0.0, 1.0))));
}

// Radius less the distance from the triangle.
static double depth_sphere_triangle(const solid *s, const solid *t) {
    v3 p[3];
    for (int k = 0; k < 3; k++) {
        core_vec3 l = t->hull->vertex[k];
        p[k] = add_scaled(t->p, t->axis[0], l.x);
        p[k] = add_scaled(add_scaled(p[k], t->axis[1], l.y), t->axis[2], l.z);
    }
    v3 n = cross(sub(p[1], p[0]), sub(p[2], p[0]));
    bool over = true;
    double least = 1e300;
    for (int k = 0; k < 3; k++) {
        v3 a = p[k], b = p[(k + 1) % 3];
        over = over && dot(cross(n, sub(b, a)), sub(s->p, a)) >= 0;
        least = CORE_MIN(least, line_distance(s->p, a, b));
    }
    return s->radius - (over ? mag(dot(n, sub(s->p, p[0]))) / len(n) : least);
}

// How deep a shape is in the triangles of a mesh: in the one that it is deepest in. Each is a flat
// hull whose directions are its normal and its edges.
static double depth_mesh(const solid *a, const solid *mesh) {
    core_vec3 corner[3], normal[2];
    uint32_t begin[] = {0, 3, 6}, loop[] = {0, 1, 2, 2, 1, 0};
    phys_geom_hull hull = {3, 2, 6, corner, normal, NULL, begin, loop};
    solid t = {.p = mesh->p, .type = PHYS_HULL, .hull = &hull};
    phys_box box;
    double most = -1.0;
    for (int k = 0; k < 3; k++) {
        t.axis[k] = mesh->axis[k];
        double at = dot(sub(a->p, mesh->p), mesh->axis[k]);
        v3 n = mesh->axis[k], back = {-n.x, -n.y, -n.z};
        box.lo[k] = (float)(at - support(a, back)) - 1e-3f;
        box.hi[k] = (float)(at + support(a, n)) + 1e-3f;
    }
    phys_mesh_walk walk;
    phys_mesh_walk_begin(&walk, mesh->mesh, &box);
    for (uint32_t i; (i = phys_mesh_walk_next(&walk)) != PHYS_MESH_NONE;) {
        for (uint32_t k = 0; k < 3; k++) {
            corner[k] = phys_mesh_corner(mesh->mesh, i, k);
        }
        normal[0] =
            core_v3_cross(core_v3_sub(corner[1], corner[0]), core_v3_sub(corner[2], corner[0]));
        normal[1] = core_v3_scale(normal[0], -1.0f);
        double d = a->type == PHYS_SPHERE ? depth_sphere_triangle(a, &t) : depth_axes(a, &t);
        most = CORE_MAX(most, d);
    }
    return most;
}

// > 0: the two overlap by so many metres.
static double depth(const solid *a, const solid *b) {
    if (a->type > b->type) {
        const solid *t = a;
        a = b;
        b = t;
    }
    if (b->type == PHYS_MESH) {
        return depth_mesh(a, b);
    }
    if (a->type == PHYS_PLANE || b->type == PHYS_PLANE) {
        const solid *plane = a->type == PHYS_PLANE ? a : b, *s = plane == a ? b : a;
        v3 down = {-plane->axis[1].x, -plane->axis[1].y, -plane->axis[1].z};
        return support(s, down) - dot(sub(s->p, plane->p), plane->axis[1]);
    }
    if (a->type == PHYS_SPHERE && b->type == PHYS_SPHERE) {
        return a->radius + b->radius - len(sub(a->p, b->p));
    }
    if (a->type == PHYS_SPHERE && b->type == PHYS_BOX) {
        return depth_sphere_box(a, b);
    }
    return depth_axes(a, b);
}

static void sort_by_low(solid **s, solid **tmp, uint32_t n) {
    for (uint32_t width = 1; width < n; width *= 2) {
        for (uint32_t lo = 0; lo < n; lo += 2 * width) {
            uint32_t mid = CORE_MIN(lo + width, n), hi = CORE_MIN(lo + 2 * width, n);
            uint32_t i = lo, j = mid;
            for (uint32_t k = lo; k < hi; k++) {
                tmp[k] = i < mid && (j >= hi || s[i]->lo <= s[j]->lo) ? s[i++] : s[j++];
            }
        }
        for (uint32_t k = 0; k < n; k++) {
            s[k] = tmp[k];
        }
    }
}

// Bodies of layers that do not collide may be in one another.
static bool meet(const phys_world *w, uint32_t a, uint32_t b) {
    return (w->rule[w->bodies.layer[a]] >> w->bodies.layer[b] & 1u) != 0;
}

static void measure_overlap(phys_world *w, phys_accuracy *out) {
    uint32_t n = core_columns_count(&w->shapes.set), used = 0, pairs = 0;
    solid *all = CORE_ARENA_ARRAY(&w->scratch, solid, n + 1);
    solid **order = CORE_ARENA_ARRAY(&w->scratch, solid *, n + 1);
    solid **tmp = CORE_ARENA_ARRAY(&w->scratch, solid *, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        all[i] = make_solid(w, i);
        if (all[i].lo <= all[i].hi) { // not NaN
            order[used++] = &all[i];
        }
    }
    sort_by_low(order, tmp, used);
    double sum = 0, most = 0;
    for (uint32_t i = 0; i < used; i++) {
        const solid *a = order[i];
        for (uint32_t j = i + 1; j < used && order[j]->lo < a->hi; j++) {
            const solid *b = order[j];
            if (a->body == b->body || (a->fixed && b->fixed) || !meet(w, a->body, b->body)) {
                continue;
            }
            double d = depth(a, b);
            if (d > 0) {
                sum += d;
                pairs++;
                most = CORE_MAX(most, d);
            }
        }
    }
    out->penetration_max_m = most;
    out->penetration_mean_m = pairs ? sum / pairs : 0;
}

// Kinetic and potential energy, momentum, and how many bodies are not finite.
static void measure_motion(const phys_world *w, phys_accuracy *out, v3 *momentum, double *mass,
                           bool *anchored) {
    const phys_bodies *b = &w->bodies;
    uint32_t n = core_columns_count(&b->set);
    for (uint32_t i = 0; i < n; i++) {
        double sum = (double)b->px[i] + b->py[i] + b->pz[i] + b->qx[i] + b->qy[i] + b->qz[i] +
                     b->qw[i] + b->vx[i] + b->vy[i] + b->vz[i] + b->wx[i] + b->wy[i] + b->wz[i];
        if (!(sum - sum == 0) || (b->flags[i] & PHYS_BODY_LOST)) {
            out->nan++;
            continue;
        }
        if (b->type[i] != PHYS_DYNAMIC) {
            *anchored = true;
            continue;
        }
        double m = 1.0 / b->im[i];
        v3 v = {b->vx[i], b->vy[i], b->vz[i]}, o = {b->wx[i], b->wy[i], b->wz[i]};
        core_quat q = phys_body_quat(b, i), f = b->iq[i];
        v3 ax = turn(q, turn(f, (v3){1, 0, 0})), ay = turn(q, turn(f, (v3){0, 1, 0}));
        v3 az = cross(ax, ay);
        double sx = dot(o, ax), sy = dot(o, ay), sz = dot(o, az);
        out->energy_j += 0.5 * m * dot(v, v) +
                         0.5 * (sx * sx / b->ix[i] + sy * sy / b->iy[i] + sz * sz / b->iz[i]);
        v3 g = {w->gravity.x, w->gravity.y, w->gravity.z}, c = {b->cx[i], b->cy[i], b->cz[i]};
        out->energy_j -= m * b->gravity_scale[i] * dot(g, c);
        *momentum = (v3){momentum->x + m * v.x, momentum->y + m * v.y, momentum->z + m * v.z};
        *mass += m * b->gravity_scale[i];
    }
}

// A body whose way since the last sample goes through a slab (a static box much thinner than wide)
// from face to face has tunnelled.
static bool crossed(const solid *slab, v3 from, v3 to, double size) {
    double h[3] = {slab->half.x, slab->half.y, slab->half.z};
    int thin = h[0] <= h[1] ? (h[0] <= h[2] ? 0 : 2) : (h[1] <= h[2] ? 1 : 2);
    int u = (thin + 1) % 3, v = (thin + 2) % 3;
    if (h[thin] * 4 > h[u] || h[thin] * 4 > h[v]) {
        return false;
    }
    v3 a = into(slab, from), b = into(slab, to);
    double fa[3] = {a.x, a.y, a.z}, fb[3] = {b.x, b.y, b.z};
    if (!((fa[thin] > h[thin] && fb[thin] < -h[thin]) ||
          (fa[thin] < -h[thin] && fb[thin] > h[thin]))) {
        return false;
    }
    double t = fa[thin] / (fa[thin] - fb[thin]);
    return mag(fa[u] + t * (fb[u] - fa[u])) < h[u] - size &&
           mag(fa[v] + t * (fb[v] - fa[v])) < h[v] - size;
}

static void measure_tunnelling(phys_world *w) {
    const phys_shapes *s = &w->shapes;
    phys_bodies *b = &w->bodies;
    for (uint32_t i = 0; i < core_columns_count(&s->set); i++) {
        uint32_t row = phys_slot_row(&b->set, s->body[i]);
        if (s->type[i] != PHYS_BOX || b->type[row] != PHYS_STATIC) {
            continue;
        }
        solid slab = make_solid(w, i);
        for (uint32_t k = 0; k < core_columns_count(&b->set); k++) {
            core_vec3 from = b->seen[k];
            if (b->type[k] == PHYS_DYNAMIC && !b->through[k] && meet(w, k, row) &&
                crossed(&slab, (v3){from.x, from.y, from.z}, (v3){b->cx[k], b->cy[k], b->cz[k]},
                        0.1)) {
                b->through[k] = 1;
                w->tunnelled++;
            }
        }
    }
    for (uint32_t k = 0; k < core_columns_count(&b->set); k++) {
        b->seen[k] = phys_get3(b->cx, b->cy, b->cz, k);
    }
}

void phys_world_accuracy(phys_world *w, phys_accuracy *out) {
    size_t mark = core_arena_mark(&w->scratch);
    *out = (phys_accuracy){0};
    v3 p = {0};
    double mass = 0;
    bool anchored = false;
    measure_motion(w, out, &p, &mass, &anchored);
    measure_overlap(w, out);
    measure_tunnelling(w);
    out->joint_error_max_m = phys_joints_error(w);
    out->tunnelled = w->tunnelled;
    if (!w->measured) {
        w->measured = true;
        w->first_energy = out->energy_j;
        w->energy_scale = mag(out->energy_j);
        w->first_momentum[0] = p.x;
        w->first_momentum[1] = p.y;
        w->first_momentum[2] = p.z;
        w->first_time = w->time;
    }
    w->energy_scale = CORE_MAX(w->energy_scale, mag(out->energy_j));
    double gain = out->energy_j - w->first_energy - w->work;
    out->energy_drift = gain > 0 && w->energy_scale > 0 ? gain / w->energy_scale : 0;
    double t = w->time - w->first_time;
    v3 want = {w->first_momentum[0] + mass * w->gravity.x * t,
               w->first_momentum[1] + mass * w->gravity.y * t,
               w->first_momentum[2] + mass * w->gravity.z * t};
    double scale = CORE_MAX(len(p), len(want));
    out->momentum_drift = anchored || w->work != 0 ? __builtin_nan("")
                          : scale > 0              ? len(sub(p, want)) / scale
                                                   : 0;
    core_arena_rewind(&w->scratch, mark);
}
