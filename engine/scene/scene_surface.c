// Walkable surfaces made from the physics world: every static body is a piece under its handle;
// what is made, moved or destroyed later is put anew before the next navigation. Kinematic bodies
// (doors, lifts) count where they have come to rest, so that a swinging door does not renew its
// tiles in every step.
#include "core/hash.h"
#include "scene/scene_internal.h"

#define SURFACE_COOKIE 0x53435375u
#define REST_STEPS     6u // without motion, then a kinematic body counts as ground

typedef struct scene_ground { // a body as a piece
    phys_body body;
    uint64_t pose; // hash of where it was put, or is on its way
    uint32_t rested;
    bool put, seen;
} scene_ground;

struct scene_surface {
    nav_mesh mesh;
    scene_surface_desc desc;
    uint64_t version; // of the static bodies
    bool any;         // has been filled once
    scene_ground *ground;
    uint32_t count, room;
};

scene_surface_desc scene_surface_desc_default(void) {
    scene_surface_desc d = {.tolerance = 0.02f, .cookie = SURFACE_COOKIE};
    d.nav = nav_mesh_desc_default();
    d.nav.tile_cells = 64;
    return d;
}

static bool counts(const scene_surface_desc *d, const phys_shape_view *v) {
    bool type = v->body_type == PHYS_STATIC || (d->kinematic && v->body_type == PHYS_KINEMATIC);
    return type && (d->layers == 0 || (d->layers >> v->layer & 1u));
}

// ---- triangles of one body ----

static void fit_soup(scene *s, uint32_t triangles) {
    if (triangles <= s->soup_room) {
        return;
    }
    uint32_t wanted = CORE_MAX(triangles, s->soup_room * 2);
    s->soup_corner = core_realloc(s->soup_corner, 3 * s->soup_room * sizeof *s->soup_corner,
                                  3 * (size_t)wanted * sizeof *s->soup_corner);
    s->soup_index = core_realloc(s->soup_index, 3 * s->soup_room * sizeof *s->soup_index,
                                 3 * (size_t)wanted * sizeof *s->soup_index);
    for (uint32_t i = 3 * s->soup_room; i < 3 * wanted; i++) {
        s->soup_index[i] = i;
    }
    s->soup_room = wanted;
}

// A plane reaches beyond the surface on all sides.
static float plane_half(const scene_surface_desc *d, core_vec3 at) {
    core_vec3 low = d->nav.bounds.min, high = d->nav.bounds.max;
    float x = CORE_MAX(core_absf(at.x - low.x), core_absf(high.x - at.x));
    float z = CORE_MAX(core_absf(at.z - low.z), core_absf(high.z - at.z));
    return 1.5f * (x + z) + 1.0f;
}

// Shapes first to end - 1 belong to one body.
static bool put_body(scene *s, scene_surface *f, uint32_t first, uint32_t end) {
    phys_shape_view v = {0};
    uint32_t n = 0;
    for (uint32_t row = first; row < end; row++) {
        phys_world_shape(s->phys, row, &v);
        float half = plane_half(&f->desc, v.position);
        uint32_t more = phys_shape_triangles(&v, f->desc.tolerance, half, NULL, 0);
        fit_soup(s, n + more);
        n +=
            phys_shape_triangles(&v, f->desc.tolerance, half, s->soup_corner + 3 * (size_t)n, more);
    }
    core_soup_data soup = {3 * n, n, &s->soup_corner[0].x, s->soup_index, NULL};
    return nav_mesh_put(s->nav, f->mesh, core_handle_bits(v.body), n ? &soup : NULL);
}

// ---- keeping up with the world ----

static scene_ground *ground_of(scene_surface *f, phys_body body) {
    for (uint32_t i = 0; i < f->count; i++) {
        if (core_handle_equal(f->ground[i].body, body)) {
            return &f->ground[i];
        }
    }
    if (f->count == f->room) {
        uint32_t wanted = CORE_MAX(f->room * 2, 64u);
        f->ground =
            core_realloc(f->ground, f->room * sizeof *f->ground, wanted * sizeof *f->ground);
        f->room = wanted;
    }
    f->ground[f->count] = (scene_ground){.body = body};
    return &f->ground[f->count++];
}

static bool moved(const scene *s, scene_ground *g) {
    core_vec3 p;
    core_quat q;
    phys_body_position(s->phys, g->body, &p);
    phys_body_rotation(s->phys, g->body, &q);
    const float pose[7] = {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
    uint64_t hash = core_hash(pose, sizeof pose, 1);
    bool other = hash != g->pose;
    g->pose = hash;
    return other;
}

static bool keep_ground(scene *s, scene_surface *f, const phys_shape_view *v, uint32_t first,
                        uint32_t end) {
    scene_ground *g = ground_of(f, v->body);
    g->seen = true;
    if (moved(s, g)) {
        g->rested = 0;
        g->put = false;
    }
    bool still = v->body_type == PHYS_STATIC || !f->any || ++g->rested >= REST_STEPS;
    if (g->put || !still) {
        return true;
    }
    g->put = true;
    return put_body(s, f, first, end);
}

static void drop_gone(scene *s, scene_surface *f) {
    for (uint32_t i = f->count; i-- > 0;) {
        if (!f->ground[i].seen) {
            nav_mesh_put(s->nav, f->mesh, core_handle_bits(f->ground[i].body), NULL);
            f->ground[i] = f->ground[--f->count];
        }
    }
}

static bool keep_up(scene *s, scene_surface *f) {
    uint64_t version = phys_world_static_version(s->phys);
    bool same = f->any && version == f->version;
    if (same && !f->desc.kinematic) {
        return true;
    }
    f->version = version;
    for (uint32_t i = 0; i < f->count; i++) {
        f->ground[i].seen = false;
    }
    bool good = true;
    uint32_t shapes = phys_world_shape_count(s->phys);
    for (uint32_t row = 0, end; row < shapes; row = end) {
        phys_shape_view v, next;
        phys_world_shape(s->phys, row, &v);
        for (end = row + 1; end < shapes; end++) { // the shapes of a body follow each other
            phys_world_shape(s->phys, end, &next);
            if (!core_handle_equal(v.body, next.body)) {
                break;
            }
        }
        good = !counts(&f->desc, &v) || keep_ground(s, f, &v, row, end) ? good : false;
    }
    drop_gone(s, f);
    f->any = true;
    return good;
}

// ---- surfaces ----

static void measure(scene *s, scene_surface_desc *d) {
    core_vec3 size = core_v3_sub(d->nav.bounds.max, d->nav.bounds.min);
    if (size.x != 0.0f || size.z != 0.0f) {
        return;
    }
    core_aabb all = {{__FLT_MAX__, 0, __FLT_MAX__}, {-__FLT_MAX__, 0, -__FLT_MAX__}};
    for (uint32_t row = 0; row < phys_world_shape_count(s->phys); row++) {
        phys_shape_view v;
        phys_world_shape(s->phys, row, &v);
        if (counts(d, &v) && v.type != PHYS_PLANE) {
            all.min.x = CORE_MIN(all.min.x, v.bounds.min.x);
            all.min.z = CORE_MIN(all.min.z, v.bounds.min.z);
            all.max.x = CORE_MAX(all.max.x, v.bounds.max.x);
            all.max.z = CORE_MAX(all.max.z, v.bounds.max.z);
        }
    }
    d->nav.bounds = all.min.x <= all.max.x ? all : (core_aabb){{-50, 0, -50}, {50, 0, 50}};
}

static void forget(scene *s, uint32_t i) {
    core_free(s->surface[i].ground);
    s->surface[i] = s->surface[--s->surface_count];
}

nav_mesh scene_surface_create(scene *s, const scene_surface_desc *given) {
    if (!given || given->cookie != SURFACE_COOKIE) {
        core_fail("scene_surface_create: the description was not made by "
                  "scene_surface_desc_default()");
        return CORE_NULL_HANDLE;
    }
    scene_surface_desc d = *given;
    if (!(d.tolerance > 0.0f && d.tolerance <= 10.0f) || d.nav.tile_cells == 0) {
        core_fail("scene_surface_create: tolerance is %g m, tile_cells %u; expected more than 0 up "
                  "to 10, and tiles",
                  (double)d.tolerance, d.nav.tile_cells);
        return CORE_NULL_HANDLE;
    }
    scene_phys(s);
    measure(s, &d);
    nav_mesh mesh = nav_mesh_build(scene_nav(s), NULL, &d.nav);
    if (core_handle_is_null(mesh)) {
        return mesh;
    }
    s->surface = core_realloc(s->surface, s->surface_count * sizeof *s->surface,
                              (s->surface_count + 1) * sizeof *s->surface);
    s->surface[s->surface_count++] = (scene_surface){.mesh = mesh, .desc = d};
    if (!keep_up(s, &s->surface[s->surface_count - 1]) || !nav_mesh_update(s->nav, mesh)) {
        nav_mesh_destroy(s->nav, mesh);
        forget(s, s->surface_count - 1);
        return CORE_NULL_HANDLE;
    }
    return mesh;
}

void scene_surfaces_keep_up(scene *s) {
    for (uint32_t i = s->surface_count; i-- > 0;) {
        if (!nav_mesh_alive(s->nav, s->surface[i].mesh)) {
            forget(s, i);
        } else if (s->phys) {
            keep_up(s, &s->surface[i]);
        }
    }
}

void scene_surfaces_release(scene *s) {
    while (s->surface_count) {
        forget(s, s->surface_count - 1);
    }
    core_free(s->surface);
    core_free(s->led);
    core_free(s->obstacle);
    core_free(s->soup_corner);
    core_free(s->soup_index);
}
