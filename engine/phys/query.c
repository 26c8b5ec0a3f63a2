// Questions to the world between steps: rays, shape casts, overlaps, closest points. They change
// nothing and see bodies where they are now.
#include "phys/mesh_internal.h"

#include <string.h>

phys_filter phys_filter_default(void) { return (phys_filter){.layers = UINT32_MAX}; }

static bool wanted(const phys_world *w, const phys_filter *f, uint32_t row) {
    if (f == NULL) {
        return true;
    }
    uint32_t layers = f->layers ? f->layers : UINT32_MAX;
    return (layers >> w->bodies.layer[row] & 1u) != 0 &&
           !core_handle_equal(f->skip, core_columns_handle(&w->bodies.set, row));
}

// The trees hold what the last step saw; after an edit every shape is looked at.
typedef struct candidates {
    uint32_t *row, count;
} candidates;

static candidates find_candidates(phys_world *w, const phys_box *box) {
    uint32_t n = core_columns_count(&w->shapes.set);
    candidates c = {CORE_ARENA_ARRAY(&w->scratch, uint32_t, 2 * (size_t)n + 1), 0};
    if (w->edited || w->trees_stale || !w->broad->partial) {
        for (; c.count < n; c.count++) {
            c.row[c.count] = c.count;
        }
        return c;
    }
    c.count = phys_tree_query(w, &w->fixed_tree, box, c.row, n);
    c.count += phys_tree_query(w, &w->moving_tree, box, c.row + c.count, n);
    return c;
}

static phys_box box_of(core_vec3 a, core_vec3 b, float grow) {
    return (phys_box){
        {CORE_MIN(a.x, b.x) - grow, CORE_MIN(a.y, b.y) - grow, CORE_MIN(a.z, b.z) - grow},
        {CORE_MAX(a.x, b.x) + grow, CORE_MAX(a.y, b.y) + grow, CORE_MAX(a.z, b.z) + grow}};
}

static phys_geom_ray_hit ray_plane(const phys_geom *g, core_vec3 o, core_vec3 d, float t_max) {
    core_vec3 up = phys_mat_col(&g->axes, 1);
    float height = core_v3_dot(core_v3_sub(o, g->position), up), fall = -core_v3_dot(d, up);
    phys_geom_ray_hit hit = phys_geom_ray_miss();
    if (height <= 0.0f) {
        hit = (phys_geom_ray_hit){true, o, up, 0.0f};
    } else if (fall > 0.0f && height <= fall * t_max) {
        float t = height / fall;
        hit = (phys_geom_ray_hit){true, core_v3_mad(o, d, t), up, t};
    }
    return hit;
}

static phys_geom_ray_hit ray_shape(const phys_geom *g, core_vec3 o, core_vec3 d, float t_max,
                                   uint32_t *triangle) {
    core_vec3 arm = core_v3_scale(phys_mat_col(&g->axes, 1), g->half_height);
    switch (g->type) {
    case PHYS_SPHERE:
        return phys_geom_ray_sphere(o, d, t_max, g->position, g->radius);
    case PHYS_BOX:
        return phys_geom_ray_box(o, d, t_max, g->half, g->position, g->rotation);
    case PHYS_PLANE:
        return ray_plane(g, o, d, t_max);
    case PHYS_MESH:
        return phys_mesh_ray(g, o, d, t_max, triangle);
    case PHYS_CAPSULE:
        return phys_geom_ray_capsule(o, d, t_max, core_v3_sub(g->position, arm),
                                     core_v3_add(g->position, arm), g->radius);
    case PHYS_CYLINDER:
        return phys_geom_ray_cylinder(o, d, t_max, g->half_height, g->radius, g->position,
                                      g->rotation);
    default: {
        core_vec3 lo = phys_mat_tmul(&g->axes, core_v3_sub(o, g->position));
        core_vec3 ld = phys_mat_tmul(&g->axes, d);
        phys_geom_ray_hit h =
            phys_geom_ray_convex(lo, ld, t_max, g->hull->vertex, g->hull->vertex_count);
        h.point = core_v3_mad(o, d, h.t);
        h.normal = phys_mat_mul(&g->axes, h.normal);
        return h;
    }
    }
}

static bool check_line(const char *what, core_vec3 from, core_vec3 way) {
    if (phys_finite3(from) && phys_finite3(way)) {
        return true;
    }
    return core_fail("phys %s: from (%g, %g, %g) along (%g, %g, %g) is not finite", what,
                     (double)from.x, (double)from.y, (double)from.z, (double)way.x, (double)way.y,
                     (double)way.z);
}

// Nearer, or as near with the lower body slot: the answer does not depend on the order of search.
static bool nearer(const phys_world *w, float t, uint32_t row, const phys_hit *best) {
    uint32_t slot = phys_row_slot(&w->bodies.set, row);
    return !best->hit || t < best->fraction || (t == best->fraction && slot < best->body.index);
}

bool phys_world_ray(phys_world *w, core_vec3 from, core_vec3 way, const phys_filter *filter,
                    phys_hit *out) {
    *out = (phys_hit){0};
    if (!check_line("ray", from, way)) {
        return false;
    }
    size_t mark = core_arena_mark(&w->scratch);
    phys_box box = box_of(from, core_v3_add(from, way), 0.0f);
    candidates c = find_candidates(w, &box);
    for (uint32_t k = 0; k < c.count; k++) {
        uint32_t row = phys_slot_row(&w->bodies.set, w->shapes.body[c.row[k]]);
        if (!wanted(w, filter, row)) {
            continue;
        }
        phys_geom g = phys_shape_geom(w, c.row[k]);
        uint32_t triangle = 0;
        phys_geom_ray_hit h = ray_shape(&g, from, way, 1.0f, &triangle);
        if (h.hit && nearer(w, h.t, row, out)) {
            *out = (phys_hit){
                true,    core_columns_handle(&w->bodies.set, row),
                h.point, h.normal,
                h.t,     g.mesh != NULL ? phys_mesh_origin(g.mesh, triangle) : UINT32_MAX};
        }
    }
    core_arena_rewind(&w->scratch, mark);
    return out->hit;
}

// A shape of a question: any but plane, hull and mesh.
static bool probe_geom(const char *what, const phys_shape_desc *s, core_vec3 position,
                       core_quat rotation, phys_geom *out) {
    if (s->type == PHYS_PLANE || s->type == PHYS_HULL || s->type == PHYS_MESH) {
        return core_fail("phys %s: shape %d, expected sphere, box, capsule or cylinder", what,
                         (int)s->type);
    }
    bool tall = s->type == PHYS_CAPSULE || s->type == PHYS_CYLINDER;
    core_vec3 half = tall ? core_v3(0, s->half_height, 0) : s->half;
    *out = phys_geom_make(s->type, position, core_quat_normalize(rotation),
                          s->type == PHYS_SPHERE ? core_v3(0, 0, 0) : half,
                          s->type == PHYS_BOX ? 0.0f : s->radius);
    return phys_shape_check(s, PHYS_DYNAMIC) && check_line(what, position, core_v3(0, 0, 0));
}

bool phys_world_cast(phys_world *w, const phys_shape_desc *shape, core_vec3 from,
                     core_quat rotation, core_vec3 way, const phys_filter *filter, phys_hit *out) {
    phys_moving probe = {.center = from, .v = way};
    *out = (phys_hit){0};
    if (!probe_geom("cast", shape, from, rotation, &probe.geom) || !check_line("cast", from, way)) {
        return false;
    }
    size_t mark = core_arena_mark(&w->scratch);
    core_aabb b = phys_geom_bounds(&probe.geom);
    float grow = core_v3_length(core_v3_sub(b.max, b.min));
    phys_box box = box_of(from, core_v3_add(from, way), grow);
    candidates c = find_candidates(w, &box);
    for (uint32_t k = 0; k < c.count; k++) {
        uint32_t row = phys_slot_row(&w->bodies.set, w->shapes.body[c.row[k]]);
        phys_moving still = {.geom = phys_shape_geom(w, c.row[k])};
        still.center = still.geom.position;
        float t;
        if (!wanted(w, filter, row) || !phys_sweep(&probe, &still, 1.0f, &t) ||
            !nearer(w, t, row, out)) {
            continue;
        }
        phys_geom at = phys_moving_at(&probe, t);
        core_vec3 n;
        float gap = phys_separation(&at, &still.geom, &n);
        phys_manifold m = {0};
        phys_collide(&at, &still.geom, PHYS_MARGIN + gap, &m);
        core_vec3 point = m.count ? m.point[0].ra : at.position;
        *out = (phys_hit){true,  core_columns_handle(&w->bodies.set, row),
                          point, core_v3_scale(n, -1.0f),
                          t,     UINT32_MAX};
    }
    core_arena_rewind(&w->scratch, mark);
    return out->hit;
}

uint32_t phys_world_overlap(phys_world *w, const phys_shape_desc *shape, core_vec3 position,
                            core_quat rotation, const phys_filter *filter, phys_body *out,
                            uint32_t capacity) {
    phys_geom probe;
    if (!probe_geom("overlap", shape, position, rotation, &probe)) {
        return 0;
    }
    size_t mark = core_arena_mark(&w->scratch);
    core_aabb b = phys_geom_bounds(&probe);
    phys_box box = box_of(b.min, b.max, 0.0f);
    candidates c = find_candidates(w, &box);
    uint32_t n = core_columns_count(&w->bodies.set), count = 0;
    bool *inside = CORE_ARENA_ARRAY(&w->scratch, bool, n + 1);
    memset(inside, 0, n + 1);
    for (uint32_t k = 0; k < c.count; k++) {
        uint32_t row = phys_slot_row(&w->bodies.set, w->shapes.body[c.row[k]]);
        phys_geom g = phys_shape_geom(w, c.row[k]);
        phys_manifold m = {0};
        if (!inside[row] && wanted(w, filter, row)) {
            phys_collide(&probe, &g, 0.0f, &m);
            inside[row] = m.count != 0;
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        if (inside[i]) {
            if (count < capacity) {
                out[count] = core_columns_handle(&w->bodies.set, i);
            }
            count++;
        }
    }
    core_arena_rewind(&w->scratch, mark);
    return count;
}

bool phys_world_closest(phys_world *w, core_vec3 point, float reach, const phys_filter *filter,
                        phys_hit *out) {
    *out = (phys_hit){0};
    if (!check_line("closest", point, core_v3(reach, 0, 0)) || reach < 0.0f) {
        return false;
    }
    size_t mark = core_arena_mark(&w->scratch);
    phys_box box = box_of(point, point, reach);
    candidates c = find_candidates(w, &box);
    phys_geom probe = phys_geom_make(PHYS_SPHERE, point, core_quat_identity(), core_v3(0, 0, 0), 0);
    for (uint32_t k = 0; k < c.count; k++) {
        uint32_t row = phys_slot_row(&w->bodies.set, w->shapes.body[c.row[k]]);
        if (!wanted(w, filter, row)) {
            continue;
        }
        phys_geom g = phys_shape_geom(w, c.row[k]);
        core_vec3 n;
        float d = CORE_MAX(phys_separation(&probe, &g, &n), 0.0f);
        if (d <= reach && nearer(w, d, row, out)) {
            *out = (phys_hit){true,
                              core_columns_handle(&w->bodies.set, row),
                              core_v3_mad(point, n, d),
                              core_v3_scale(n, -1.0f),
                              d,
                              UINT32_MAX};
        }
    }
    core_arena_rewind(&w->scratch, mark);
    return out->hit;
}

static uint32_t row_order(const phys_world *w, uint32_t shape) {
    return phys_slot_row(&w->bodies.set, w->shapes.body[shape]);
}

// Insertion sort by body row, then shape row: the answer does not depend on the order of search.
static void sort_candidates(const phys_world *w, candidates *c) {
    for (uint32_t i = 1; i < c->count; i++) {
        uint32_t shape = c->row[i], body = row_order(w, shape), k = i;
        for (; k > 0; k--) {
            uint32_t before = row_order(w, c->row[k - 1]);
            if (before < body || (before == body && c->row[k - 1] < shape)) {
                break;
            }
            c->row[k] = c->row[k - 1];
        }
        c->row[k] = shape;
    }
}

static bool boxes_meet(const phys_box *a, core_aabb b) {
    return a->lo[0] <= b.max.x && a->hi[0] >= b.min.x && a->lo[1] <= b.max.y &&
           a->hi[1] >= b.min.y && a->lo[2] <= b.max.z && a->hi[2] >= b.min.z;
}

uint32_t phys_world_touch(phys_world *w, const phys_shape_desc *shape, core_vec3 position,
                          core_quat rotation, float reach, const phys_filter *filter,
                          phys_touch *out, uint32_t capacity) {
    phys_geom probe;
    if (!probe_geom("touch", shape, position, rotation, &probe) ||
        !check_line("touch", position, core_v3(reach, 0, 0))) {
        return 0;
    }
    size_t mark = core_arena_mark(&w->scratch);
    core_aabb b = phys_geom_bounds(&probe);
    phys_box box = box_of(b.min, b.max, reach);
    candidates c = find_candidates(w, &box);
    uint32_t kept = 0;
    for (uint32_t k = 0; k < c.count; k++) {
        phys_geom g = phys_shape_geom(w, c.row[k]);
        if (wanted(w, filter, row_order(w, c.row[k])) && boxes_meet(&box, phys_geom_bounds(&g))) {
            c.row[kept++] = c.row[k];
        }
    }
    c.count = kept;
    sort_candidates(w, &c);
    uint32_t count = 0;
    for (uint32_t k = 0; k < c.count; k++) {
        phys_geom g = phys_shape_geom(w, c.row[k]);
        phys_body body = core_columns_handle(&w->bodies.set, row_order(w, c.row[k]));
        core_vec3 normal[PHYS_PARTS], point[PHYS_PARTS];
        float gap[PHYS_PARTS];
        uint32_t n = 1;
        if (g.type == PHYS_MESH) { // as many as there are sides to it
            n = phys_mesh_touches(&probe, &g, reach, normal, point, gap);
        } else {
            gap[0] = phys_closest_on(&probe, &g, &normal[0], &point[0]);
        }
        for (uint32_t i = 0; i < n; i++) {
            if (gap[i] > reach) {
                continue;
            }
            if (count < capacity) {
                out[count] = (phys_touch){.body = body,
                                          .point = point[i],
                                          .normal = core_v3_scale(normal[i], -1.0f),
                                          .gap = gap[i]};
            }
            count++;
        }
    }
    core_arena_rewind(&w->scratch, mark);
    return count;
}

uint32_t phys_query_shapes(phys_world *w, const phys_box *box, uint32_t *out, uint32_t capacity) {
    size_t mark = core_arena_mark(&w->scratch);
    candidates c = find_candidates(w, box);
    uint32_t count = 0;
    for (uint32_t k = 0; k < c.count; k++) {
        phys_geom g = phys_shape_geom(w, c.row[k]);
        if (boxes_meet(box, phys_geom_bounds(&g))) {
            c.row[count++] = c.row[k];
        }
    }
    c.count = count;
    sort_candidates(w, &c);
    for (uint32_t k = 0; k < CORE_MIN(count, capacity); k++) {
        out[k] = c.row[k];
    }
    core_arena_rewind(&w->scratch, mark);
    return count;
}
