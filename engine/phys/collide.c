// Narrow phase of round and flat shapes: closed forms. Normals point from a to b; anchors are left
// relative to the world origin (narrow.c moves them to the centres of mass).
#include "phys/world.h"

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

// The four corners of the box that reach deepest: those of the face turned most to the plane.
static void box_plane(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m) {
    core_vec3 up = phys_mat_col(&b->axes, 1);
    core_vec3 local = phys_mat_tmul(&a->axes, up);
    core_vec3 size = phys_abs3(local);
    int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    m->normal = core_v3_scale(up, -1.0f);
    for (uint32_t i = 0; i < 8; i++) {
        core_vec3 c = core_v3(i & 1 ? a->half.x : -a->half.x, i & 2 ? a->half.y : -a->half.y,
                              i & 4 ? a->half.z : -a->half.z);
        if (phys_comp(c, axis) * phys_comp(local, axis) > 0.0f) {
            continue;
        }
        core_vec3 p = core_v3_add(a->position, phys_mat_mul(&a->axes, c));
        float sep = core_v3_dot(core_v3_sub(p, b->position), up);
        if (sep < margin) {
            core_vec3 mid = core_v3_mad(p, up, -0.5f * sep);
            m->point[m->count++] =
                (phys_point){.ra = mid, .rb = mid, .separation = sep, .feature = i};
        }
    }
}

typedef void collide_fn(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *m);

void phys_collide(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *out) {
    static collide_fn *const table[3][3] = {{sphere_sphere, sphere_box, sphere_plane},
                                            {NULL, phys_collide_box_box, box_plane},
                                            {NULL, NULL, NULL}};
    out->count = 0;
    collide_fn *fn = table[a->type][b->type];
    if (fn != NULL) {
        fn(a, b, margin, out);
    }
}
