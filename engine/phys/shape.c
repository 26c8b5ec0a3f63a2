// Shapes: what a description must fulfil, mass and inertia, bounds.
#include "phys/mesh_internal.h"

CORE_COLUMNS_DEFINE(phys_shapes, PHYS_SHAPE_COLUMNS)

static const char *const shape_names[] = {"sphere",   "box",  "plane", "capsule",
                                          "cylinder", "hull", "mesh"};

phys_shape_desc phys_shape_desc_default(phys_shape_type type) {
    return (phys_shape_desc){.type = type,
                             .rotation = core_quat_identity(),
                             .normal = {0, 1, 0},
                             .density = 1000.0f,
                             .friction = 0.5f,
                             .cookie = PHYS_SHAPE_COOKIE};
}

static bool check_size(const char *shape, const char *field, float value) {
    if (value >= 1e-4f && value <= 1e5f) {
        return true;
    }
    return core_fail("phys shape %s: %s is %g, expected 0.0001..100000 m", shape, field,
                     (double)value);
}

bool phys_material_check(const char *name, const phys_material *m) {
    if (!(m->friction >= 0.0f && m->friction <= 1e6f)) {
        return core_fail("phys shape %s: friction is %g, expected 0 or more", name,
                         (double)m->friction);
    }
    if (!(m->restitution >= 0.0f && m->restitution <= 1.0f)) {
        return core_fail("phys shape %s: restitution is %g, expected 0..1", name,
                         (double)m->restitution);
    }
    if (!(m->rolling >= 0.0f && m->rolling <= 1e3f)) {
        return core_fail("phys shape %s: rolling is %g, expected 0 or more", name,
                         (double)m->rolling);
    }
    return true;
}

static bool check_material(const phys_shape_desc *s, const char *name) {
    if (!(s->density >= 0.0f && s->density <= 1e9f)) {
        return core_fail("phys shape %s: density is %g, expected 0 (default) or up to 1e9 kg/m^3",
                         name, (double)s->density);
    }
    return phys_material_check(name, &(phys_material){s->friction, s->restitution, s->rolling});
}

bool phys_shape_check(const phys_shape_desc *s, phys_body_type body) {
    if (s->cookie != PHYS_SHAPE_COOKIE) {
        return core_fail("phys shape: description was not made by phys_shape_desc_default");
    }
    if ((unsigned)s->type > PHYS_MESH) {
        return core_fail("phys shape: type %d, expected sphere, box, plane, capsule, cylinder, "
                         "hull or mesh",
                         (int)s->type);
    }
    const char *name = shape_names[s->type];
    if (!phys_finite3(s->position) || core_v3_length(s->position) > PHYS_FAR) {
        return core_fail("phys shape %s: position (%g, %g, %g) is not finite or too far", name,
                         (double)s->position.x, (double)s->position.y, (double)s->position.z);
    }
    switch (s->type) {
    case PHYS_SPHERE:
        if (!check_size(name, "radius", s->radius)) {
            return false;
        }
        break;
    case PHYS_BOX:
        if (!check_size(name, "half.x", s->half.x) || !check_size(name, "half.y", s->half.y) ||
            !check_size(name, "half.z", s->half.z)) {
            return false;
        }
        break;
    case PHYS_CAPSULE:
    case PHYS_CYLINDER:
        if (!check_size(name, "radius", s->radius) ||
            !check_size(name, "half_height", s->half_height)) {
            return false;
        }
        break;
    case PHYS_HULL:
        if (s->points == NULL || s->point_count < 4 || s->point_count > PHYS_HULL_POINTS) {
            return core_fail("phys shape hull: %u points, expected 4..%u", s->point_count,
                             PHYS_HULL_POINTS);
        }
        break;
    case PHYS_MESH: // the triangles are checked when they are taken over
        if (body != PHYS_STATIC) {
            return core_fail("phys shape mesh: only static bodies can have one; use hulls");
        }
        break;
    default:
        if (!(core_absf(core_v3_length(s->normal) - 1.0f) < 1e-3f)) {
            return core_fail("phys shape plane: normal (%g, %g, %g) is not of length 1",
                             (double)s->normal.x, (double)s->normal.y, (double)s->normal.z);
        }
        if (body != PHYS_STATIC) {
            return core_fail("phys shape plane: only static bodies can have one");
        }
    }
    return check_material(s, name);
}

static phys_mat3 inertia_matrix(phys_geom_inertia i, float mass) {
    return (phys_mat3){{i.xx * mass, i.xy * mass, i.xz * mass},
                       {i.xy * mass, i.yy * mass, i.yz * mass},
                       {i.xz * mass, i.yz * mass, i.zz * mass}};
}

// In the shape's own frame.
static bool own_mass(const phys_shape_desc *s, phys_mass *m) {
    float density = s->density > 0.0f ? s->density : 1000.0f;
    *m = (phys_mass){0};
    phys_geom_inertia i = {0};
    switch (s->type) {
    case PHYS_SPHERE:
        m->mass = density * phys_geom_volume_sphere(s->radius);
        i = phys_geom_inertia_sphere(s->radius);
        break;
    case PHYS_BOX:
        m->mass = density * phys_geom_volume_box(s->half);
        i = phys_geom_inertia_box(s->half);
        break;
    case PHYS_CAPSULE:
        m->mass = density * phys_geom_volume_capsule(s->half_height, s->radius);
        i = phys_geom_inertia_capsule(s->half_height, s->radius);
        break;
    case PHYS_CYLINDER:
        m->mass = density * phys_geom_volume_cylinder(s->half_height, s->radius);
        i = phys_geom_inertia_cylinder(s->half_height, s->radius);
        break;
    case PHYS_HULL: {
        const core_vec3 *p = (const core_vec3 *)(const void *)s->points;
        float volume = phys_geom_volume_convex(p, s->point_count);
        m->mass = density * volume;
        if (volume == 0.0f || !phys_geom_inertia_convex(p, s->point_count, &i, &m->center)) {
            return false;
        }
        break;
    }
    default:
        break;
    }
    m->inertia = inertia_matrix(i, m->mass);
    return true;
}

bool phys_shape_mass(const phys_shape_desc *s, phys_mass *m) {
    if (!own_mass(s, m)) {
        return false;
    }
    core_quat q = core_quat_normalize(s->rotation);
    phys_mat3 r = phys_quat_mat(q);
    // R I R^T, row by row.
    const core_vec3 *row = &r.x, *in = &m->inertia.x;
    phys_mat3 out;
    core_vec3 *o = &out.x;
    for (int i = 0; i < 3; i++) {
        core_vec3 t = core_v3_scale(in[0], row[i].x);
        t = core_v3_mad(core_v3_mad(t, in[1], row[i].y), in[2], row[i].z);
        o[i] = core_v3(core_v3_dot(t, r.x), core_v3_dot(t, r.y), core_v3_dot(t, r.z));
    }
    m->inertia = out;
    m->center = core_v3_add(s->position, phys_rotate(q, m->center));
    return true;
}

// Cyclic Jacobi (Golub, Van Loan, Matrix Computations, 8.5) on doubles.
core_vec3 phys_principal(const phys_mat3 *inertia, core_quat *frame) {
    double a[3][3] = {{inertia->x.x, inertia->x.y, inertia->x.z},
                      {inertia->y.x, inertia->y.y, inertia->y.z},
                      {inertia->z.x, inertia->z.y, inertia->z.z}};
    double limit = 1e-12 * (a[0][0] + a[1][1] + a[2][2]);
    core_quat q = core_quat_identity();
    for (int sweep = 0; sweep < 24; sweep++) {
        for (int p = 0; p < 2; p++) {
            for (int r = p + 1; r < 3; r++) {
                if (!(a[p][r] > limit || a[p][r] < -limit)) {
                    continue;
                }
                double theta = (a[r][r] - a[p][p]) / (2.0 * a[p][r]);
                double at = theta < 0 ? -theta : theta;
                double t = 1.0 / (at + core_sqrt(theta * theta + 1.0));
                t = theta < 0 ? -t : t;
                double c = 1.0 / core_sqrt(t * t + 1.0), s = t * c;
                for (int k = 0; k < 3; k++) {
                    double kp = a[k][p], kr = a[k][r];
                    a[k][p] = c * kp - s * kr;
                    a[k][r] = s * kp + c * kr;
                }
                for (int k = 0; k < 3; k++) {
                    double pk = a[p][k], rk = a[r][k];
                    a[p][k] = c * pk - s * rk;
                    a[r][k] = s * pk + c * rk;
                }
                // The rotation's axis is the third one; its sign follows the order of p and r.
                float half_c = (float)core_sqrt(0.5 * (1.0 + c));
                float half_s = (float)(0.5 * s) / half_c;
                core_quat turn = {0, 0, 0, half_c};
                if (p == 0 && r == 1) {
                    turn.z = -half_s;
                } else if (p == 0) {
                    turn.y = half_s;
                } else {
                    turn.x = -half_s;
                }
                q = phys_quat_unit(phys_quat_mul(q, turn));
            }
        }
    }
    *frame = q;
    return core_v3((float)a[0][0], (float)a[1][1], (float)a[2][2]);
}

phys_geom phys_geom_make(phys_shape_type type, core_vec3 position, core_quat rotation,
                         core_vec3 half, float radius) {
    phys_geom g = {
        .type = type, .position = position, .rotation = rotation, .half = half, .radius = radius};
    g.half_height = half.y;
    g.axes = phys_quat_mat(rotation);
    return g;
}

phys_geom phys_shape_geom(const phys_world *w, uint32_t i) {
    const phys_shapes *s = &w->shapes;
    const phys_bodies *b = &w->bodies;
    uint32_t row = phys_slot_row(&b->set, s->body[i]);
    core_quat q = phys_body_quat(b, row);
    core_vec3 o = phys_get3(b->px, b->py, b->pz, row);
    phys_geom g =
        phys_geom_make((phys_shape_type)s->type[i], core_v3_add(o, phys_rotate(q, s->position[i])),
                       phys_quat_mul(q, s->rotation[i]), s->half[i], s->radius[i]);
    if (s->type[i] == PHYS_MESH) {
        g.mesh = phys_mesh_at(w, s->hull[i]);
    } else if (s->hull[i] != 0) {
        g.hull = &w->hulls[s->hull[i] - 1].hull;
    }
    return g;
}

bool phys_geom_contains(const phys_geom *g, core_vec3 point) {
    core_vec3 d = core_v3_sub(point, g->position);
    if (g->type == PHYS_SPHERE) {
        return core_v3_dot(d, d) <= g->radius * g->radius;
    }
    core_vec3 l = phys_abs3(phys_mat_tmul(&g->axes, d));
    if (g->type == PHYS_CYLINDER) {
        return l.y <= g->half_height && l.x * l.x + l.z * l.z <= g->radius * g->radius;
    }
    if (g->type == PHYS_CAPSULE) {
        float y = CORE_MAX(l.y - g->half_height, 0.0f);
        return l.x * l.x + y * y + l.z * l.z <= g->radius * g->radius;
    }
    return l.x <= g->half.x && l.y <= g->half.y && l.z <= g->half.z;
}

core_aabb phys_geom_bounds(const phys_geom *g) {
    core_vec3 e = core_v3(g->radius, g->radius, g->radius);
    core_vec3 up = phys_abs3(phys_mat_col(&g->axes, 1));
    switch (g->type) {
    case PHYS_BOX:
        e = core_v3(core_v3_dot(phys_abs3(g->axes.x), g->half),
                    core_v3_dot(phys_abs3(g->axes.y), g->half),
                    core_v3_dot(phys_abs3(g->axes.z), g->half));
        break;
    case PHYS_PLANE:
        e = core_v3(1e9f, 1e9f, 1e9f);
        break;
    case PHYS_CAPSULE:
        e = core_v3_mad(e, up, g->half_height);
        break;
    case PHYS_CYLINDER:
        e = core_v3(up.x * g->half_height + g->radius * core_sqrtf(CORE_MAX(1 - up.x * up.x, 0)),
                    up.y * g->half_height + g->radius * core_sqrtf(CORE_MAX(1 - up.y * up.y, 0)),
                    up.z * g->half_height + g->radius * core_sqrtf(CORE_MAX(1 - up.z * up.z, 0)));
        break;
    case PHYS_HULL:
        return phys_geom_bounds_convex(g->hull->vertex, g->hull->vertex_count, g->position,
                                       g->rotation);
    case PHYS_MESH: {
        core_aabb box = phys_mesh_bounds(g->mesh);
        core_vec3 half = core_v3_scale(core_v3_sub(box.max, box.min), 0.5f);
        core_vec3 middle = core_v3_scale(core_v3_add(box.max, box.min), 0.5f);
        return phys_geom_bounds_box(half, core_v3_add(g->position, phys_mat_mul(&g->axes, middle)),
                                    g->rotation);
    }
    default:
        break;
    }
    return (core_aabb){core_v3_sub(g->position, e), core_v3_add(g->position, e)};
}

#define BOUNDS_GROWTH 0.03f // m, beyond the margin
#define BOUNDS_STEPS  3.0f  // steps that a shape can go on before it leaves its bounds

// What a shape may touch within the step: its bounds, the margin, and the way it goes.
static phys_box reach_box(const phys_world *w, uint32_t i, uint32_t row, float dt, core_vec3 *way) {
    const phys_shapes *s = &w->shapes;
    const phys_bodies *b = &w->bodies;
    core_aabb box;
    core_vec3 local = s->position[i];
    if (s->type[i] == PHYS_SPHERE && local.x == 0.0f && local.y == 0.0f && local.z == 0.0f) {
        core_vec3 p = phys_get3(b->px, b->py, b->pz, row);
        core_vec3 e = core_v3(s->radius[i], s->radius[i], s->radius[i]);
        box = (core_aabb){core_v3_sub(p, e), core_v3_add(p, e)};
    } else {
        phys_geom g = phys_shape_geom(w, i);
        box = phys_geom_bounds(&g);
    }
    core_vec3 v = phys_get3(b->vx, b->vy, b->vz, row);
    *way = b->type[row] == PHYS_STATIC ? core_v3(0, 0, 0) : core_v3_scale(v, dt);
    core_vec3 spin = phys_get3(b->wx, b->wy, b->wz, row);
    float turn = PHYS_MARGIN;
    if (s->type[i] != PHYS_SPHERE && b->type[row] != PHYS_STATIC) {
        float extent = core_v3_length(s->half[i]) + s->radius[i];
        turn += CORE_MIN(core_v3_length(spin) * dt, 1.0f) * extent;
    }
    core_vec3 grow = core_v3_add(phys_abs3(*way), core_v3(turn, turn, turn));
    return (phys_box){{box.min.x - grow.x, box.min.y - grow.y, box.min.z - grow.z},
                      {box.max.x + grow.x, box.max.y + grow.y, box.max.z + grow.z}};
}

static void update_bounds(phys_world *w, uint32_t i, float dt) {
    phys_shapes *s = &w->shapes;
    uint32_t row = s->row[i];
    core_vec3 way;
    s->moved[i] = 0;
    if (w->bodies.flags[row] & PHYS_BODY_ASLEEP) {
        return;
    }
    phys_box box = reach_box(w, i, row, dt, &way);
    bool inside = box.lo[0] >= s->x0[i] && box.lo[1] >= s->y0[i] && box.lo[2] >= s->z0[i] &&
                  box.hi[0] <= s->x1[i] && box.hi[1] <= s->y1[i] && box.hi[2] <= s->z1[i];
    s->moved[i] = !inside;
    if (inside) {
        return;
    }
    bool fixed = w->bodies.type[row] == PHYS_STATIC;
    float grow = fixed ? 0.0f : BOUNDS_GROWTH;
    core_vec3 ahead = core_v3_scale(way, BOUNDS_STEPS);
    s->x0[i] = box.lo[0] - grow + CORE_MIN(ahead.x, 0.0f);
    s->y0[i] = box.lo[1] - grow + CORE_MIN(ahead.y, 0.0f);
    s->z0[i] = box.lo[2] - grow + CORE_MIN(ahead.z, 0.0f);
    s->x1[i] = box.hi[0] + grow + CORE_MAX(ahead.x, 0.0f);
    s->y1[i] = box.hi[1] + grow + CORE_MAX(ahead.y, 0.0f);
    s->z1[i] = box.hi[2] + grow + CORE_MAX(ahead.z, 0.0f);
}

typedef struct bounds_job {
    phys_world *world;
    float dt;
} bounds_job;

static void bounds_chunk(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const bounds_job *job = ctx;
    for (uint32_t i = begin; i < end; i++) {
        update_bounds(job->world, i, job->dt);
    }
}

void phys_shapes_update_bounds(phys_world *w, float dt) {
    phys_shapes *s = &w->shapes;
    uint32_t n = core_columns_count(&s->set);
    if (w->rows_stale) {
        for (uint32_t i = 0; i < n; i++) {
            s->row[i] = phys_slot_row(&w->bodies.set, s->body[i]);
        }
    }
    core_jobs_for(w->jobs, n, 512, bounds_chunk, &(bounds_job){w, dt});
    w->any_moved = false;
    for (uint32_t i = 0; i < n; i++) {
        s->moved[i] |= w->pairs_stale;
        w->any_moved |= s->moved[i];
    }
}
