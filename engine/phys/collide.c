// Narrow phase of round and flat shapes: closed forms. Normals point from a to b; anchors are left
// relative to the world origin (narrow.c moves them to the centres of mass).
#include "phys/mesh_internal.h"

// One point half way between the two surfaces.
static void one_point(phys_manifold *m, core_vec3 on_a, core_vec3 on_b, core_vec3 normal,
                      float separation, uint32_t feature) {
    core_vec3 mid = core_v3_scale(core_v3_add(on_a, on_b), 0.5f);
    m->normal = normal;
    m->count = 1;
    m->point[0] = (phys_point){.ra = mid, .rb = mid, .separation = separation, .feature = feature};
}

static void sphere_sphere(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m) {
    core_vec3 d = core_v3_sub(b->position, a->position);
    float l = core_v3_length(d), sep = l - (a->radius + b->radius);
    if (!(sep < margin)) {
        return;
    }
    // Equal centres have no direction: any one serves, upwards parts a pile soonest.
    core_vec3 n = l > 1e-9f ? core_v3_scale(d, 1.0f / l) : core_v3(0, 1, 0);
    one_point(m, core_v3_mad(a->position, n, a->radius), core_v3_mad(b->position, n, -b->radius), n,
              sep, 0);
}

static void sphere_box(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m) {
    core_vec3 c = phys_mat_tmul(&b->axes, core_v3_sub(a->position, b->position));
    core_vec3 h = b->half;
    core_vec3 q =
        core_v3(CORE_CLAMP(c.x, -h.x, h.x), CORE_CLAMP(c.y, -h.y, h.y), CORE_CLAMP(c.z, -h.z, h.z));
    core_vec3 d = core_v3_sub(q, c); // towards the box
    float l2 = core_v3_dot(d, d);
    core_vec3 n, on_b;
    float sep;
    if (l2 > 1e-14f) {
        float l = core_sqrtf(l2);
        sep = l - a->radius;
        n = core_v3_scale(d, 1.0f / l);
        on_b = q;
    } else { // centre inside: leave through the nearest face
        core_vec3 gap = core_v3_sub(h, phys_abs3(c));
        int axis = gap.x <= gap.y ? (gap.x <= gap.z ? 0 : 2) : (gap.y <= gap.z ? 1 : 2);
        float s = phys_comp(c, axis) < 0.0f ? 1.0f : -1.0f;
        n = core_v3(axis == 0 ? s : 0.0f, axis == 1 ? s : 0.0f, axis == 2 ? s : 0.0f);
        sep = -phys_comp(gap, axis) - a->radius;
        on_b = core_v3_mad(c, n, -phys_comp(gap, axis));
    }
    if (!(sep < margin)) {
        return;
    }
    n = phys_mat_mul(&b->axes, n);
    on_b = core_v3_add(b->position, phys_mat_mul(&b->axes, on_b));
    one_point(m, core_v3_mad(a->position, n, a->radius), on_b, n, sep, 0);
}

static void sphere_plane(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m) {
    core_vec3 up = phys_mat_col(&b->axes, 1);
    float height = core_v3_dot(core_v3_sub(a->position, b->position), up);
    float sep = height - a->radius;
    if (sep < margin) {
        one_point(m, core_v3_mad(a->position, up, -a->radius),
                  core_v3_mad(a->position, up, -height), core_v3_scale(up, -1.0f), sep, 0);
    }
}

typedef void collide_fn(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m);

// a.type <= b.type. The rest of the table goes through GJK.
void phys_collide(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *out) {
    out->count = 0;
    bool swap = a->type > b->type;
    const phys_geom *first = swap ? b : a, *second = swap ? a : b;
    collide_fn *fn = phys_collide_convex;
    if (second->type == PHYS_MESH) {
        phys_mesh_collide(first, second, margin, out);
    } else if (second->type == PHYS_PLANE || first->type == PHYS_PLANE) {
        bool plane_first = first->type == PHYS_PLANE;
        swap = swap != plane_first;
        const phys_geom *shape = plane_first ? second : first;
        const phys_geom *plane = plane_first ? first : second;
        fn = shape->type == PHYS_SPHERE ? sphere_plane : phys_collide_plane;
        fn(shape, plane, margin, out);
    } else {
        if (second->type == PHYS_SPHERE) {
            fn = sphere_sphere;
        } else if (second->type == PHYS_BOX) {
            fn = first->type == PHYS_SPHERE ? sphere_box : phys_collide_box_box;
        }
        fn(first, second, margin, out);
    }
    if (swap) {
        out->normal = core_v3_scale(out->normal, -1.0f);
    }
}
