// Meshes: checked and packed copies of mesh data, their levels of detail, and the built-in unit
// shapes.
#include "gfx/gfx_internal.h"
#include "gfx/gfx_simplify.h"

#include <math.h>
#include <string.h>

void gfx_mesh_store_release(gfx_mesh_store *store) {
    core_free(store->position);
    core_free(store->shade);
    core_free(store->skin);
    core_free(store->index);
    *store = (gfx_mesh_store){0};
}

static size_t store_bytes(const gfx_mesh_store *s) {
    size_t vertex = 3 * sizeof(float) + sizeof(gfx_vertex_shade);
    return s->vertex_count * (vertex + (s->skin ? sizeof(gfx_vertex_skin) : 0)) +
           s->index_count * sizeof(uint32_t);
}

static int16_t snorm16(float x) {
    float v = CORE_CLAMP(x, -1.0f, 1.0f) * 32767.0f;
    return (int16_t)(v < 0.0f ? v - 0.5f : v + 0.5f);
}

static uint8_t unorm8(float x) { return (uint8_t)(CORE_CLAMP(x, 0.0f, 1.0f) * 255.0f + 0.5f); }

static bool check_mesh(const core_mesh_data *d) {
    if (!d || !d->position || !d->index || d->vertex_count == 0 || d->index_count == 0) {
        return core_fail("gfx_mesh_create: a mesh needs positions and indices");
    }
    if (d->index_count % 3 != 0) {
        return core_fail("gfx_mesh_create: %u indices are no whole number of triangles",
                         d->index_count);
    }
    for (uint32_t i = 0; i < d->index_count; ++i) {
        if (d->index[i] >= d->vertex_count) {
            return core_fail("gfx_mesh_create: index %u is %u, the mesh has %u vertices", i,
                             d->index[i], d->vertex_count);
        }
    }
    for (uint32_t i = 0; i < d->vertex_count * 3; ++i) {
        if (!isfinite(d->position[i])) {
            return core_fail("gfx_mesh_create: vertex %u is not a finite number", i / 3);
        }
    }
    return true;
}

// Area-weighted vertex normals, for data without any.
static void smooth_normals(const core_mesh_data *d, float *normal) {
    for (uint32_t t = 0; t < d->index_count; t += 3) {
        core_vec3 p[3];
        for (int k = 0; k < 3; ++k) {
            const float *q = d->position + 3 * (size_t)d->index[t + k];
            p[k] = core_v3(q[0], q[1], q[2]);
        }
        core_vec3 n = core_v3_cross(core_v3_sub(p[1], p[0]), core_v3_sub(p[2], p[0]));
        for (int k = 0; k < 3; ++k) {
            float *q = normal + 3 * (size_t)d->index[t + k];
            q[0] += n.x, q[1] += n.y, q[2] += n.z;
        }
    }
}

static void pack_shade(const core_mesh_data *d, const float *normal, gfx_vertex_shade *out) {
    for (uint32_t i = 0; i < d->vertex_count; ++i) {
        const float *q = normal + 3 * (size_t)i;
        core_vec3 n = core_v3_normalize(core_v3(q[0], q[1], q[2]), core_v3(0.0f, 1.0f, 0.0f));
        out[i] = (gfx_vertex_shade){.normal = {snorm16(n.x), snorm16(n.y), snorm16(n.z), 0},
                                    .color = {255, 255, 255, 255}};
        if (d->tangent) {
            for (int k = 0; k < 4; ++k) {
                out[i].tangent[k] = snorm16(d->tangent[4 * (size_t)i + k]);
            }
        }
        if (d->uv) {
            memcpy(out[i].uv, d->uv + 2 * (size_t)i, sizeof out[i].uv);
        }
        if (d->color) {
            for (int k = 0; k < 4; ++k) {
                out[i].color[k] = unorm8(d->color[4 * (size_t)i + k]);
            }
        }
    }
}

static void pack_skin(const core_mesh_data *d, gfx_mesh_store *store) {
    for (uint32_t i = 0; i < d->vertex_count; ++i) {
        const float *w = d->weight + 4 * (size_t)i;
        float sum = w[0] + w[1] + w[2] + w[3];
        for (int k = 0; k < 4; ++k) {
            float share = sum > 0.0f ? CORE_MAX(w[k], 0.0f) / sum : k == 0;
            uint16_t joint = share > 0.0f ? d->joint[4 * (size_t)i + k] : 0; // in files: any
            store->skin[i].weight[k] = share;
            store->skin[i].joint[k] = joint;
            store->bones = CORE_MAX(store->bones, joint + 1u);
        }
    }
    store->bones = CORE_MAX(store->bones, 1u);
}

static void bound(gfx_mesh_store *store) {
    core_vec3 lo, hi;
    memcpy(&lo, store->position, sizeof lo);
    hi = lo;
    for (uint32_t i = 0; i < store->vertex_count; ++i) {
        const float *p = store->position + 3 * (size_t)i;
        lo = core_v3(CORE_MIN(lo.x, p[0]), CORE_MIN(lo.y, p[1]), CORE_MIN(lo.z, p[2]));
        hi = core_v3(CORE_MAX(hi.x, p[0]), CORE_MAX(hi.y, p[1]), CORE_MAX(hi.z, p[2]));
    }
    store->center = core_v3_scale(core_v3_add(lo, hi), 0.5f);
    float r2 = 0.0f;
    for (uint32_t i = 0; i < store->vertex_count; ++i) {
        const float *p = store->position + 3 * (size_t)i;
        core_vec3 d = core_v3_sub(core_v3(p[0], p[1], p[2]), store->center);
        r2 = CORE_MAX(r2, core_v3_dot(d, d));
    }
    store->radius = core_sqrtf(r2) * 1.000001f; // the square root rounds
}

static gfx_mesh make_mesh(gfx_world *world, const core_mesh_data *data) {
    gfx_mesh mesh = core_columns_add(&world->meshes.set);
    uint32_t row = core_columns_row(&world->meshes.set, mesh);
    if (row == CORE_NO_ROW) {
        return mesh;
    }
    gfx_mesh_store *s = &world->meshes.store[row];
    uint32_t n = data->vertex_count;
    *s = (gfx_mesh_store){.vertex_count = n, .index_count = data->index_count};
    s->position = core_alloc((size_t)n * 3 * sizeof(float));
    s->shade = core_alloc((size_t)n * sizeof *s->shade);
    s->index = core_alloc((size_t)data->index_count * sizeof *s->index);
    memcpy(s->position, data->position, (size_t)n * 3 * sizeof(float));
    memcpy(s->index, data->index, (size_t)data->index_count * sizeof *s->index);
    if (data->normal) {
        pack_shade(data, data->normal, s->shade);
    } else {
        float *normal = core_alloc((size_t)n * 3 * sizeof(float));
        smooth_normals(data, normal);
        pack_shade(data, normal, s->shade);
        core_free(normal);
    }
    if (data->joint && data->weight) {
        s->skin = core_alloc((size_t)n * sizeof *s->skin);
        pack_skin(data, s);
    }
    bound(s);
    world->heap_bytes += store_bytes(s);
    world->mesh_version++;
    return mesh;
}

static gfx_mesh_store *store_of(gfx_world *world, gfx_mesh mesh) {
    uint32_t row = core_columns_row(&world->meshes.set, mesh);
    return row == CORE_NO_ROW ? NULL : &world->meshes.store[row];
}

bool gfx_mesh_destroy(gfx_world *world, gfx_mesh mesh) {
    gfx_mesh_store *s = store_of(world, mesh);
    if (!s) {
        return core_fail("gfx_mesh_destroy: the handle is stale or null");
    }
    if (s->builtin) {
        return core_fail("gfx_mesh_destroy: built-in meshes stay for the life of their world");
    }
    while (s) { // and its coarser levels
        gfx_mesh coarser = s->coarser;
        world->heap_bytes -= store_bytes(s);
        gfx_mesh_store_release(s);
        core_columns_remove(&world->meshes.set, mesh, NULL, NULL);
        mesh = coarser;
        s = store_of(world, mesh);
    }
    world->mesh_version++;
    return true;
}

// ---- levels of detail ----

enum { LEVELS_FROM = 512, LEAST_TRIANGLES = 32, MESH_LEVELS = 6 };

// The vertices that some triangles use, in order of their first use; map[vertex]: scratch.
typedef struct part {
    core_mesh_data data;
    float *memory;
    uint16_t *joint;
    uint32_t *index;
} part;

static float *copy_part(float *to, const float *from, uint32_t width, const uint32_t *used,
                        uint32_t count) {
    for (uint32_t i = 0; from && i < count; ++i) {
        memcpy(to + (size_t)width * i, from + (size_t)width * used[i], width * sizeof *to);
    }
    return from ? to : NULL;
}

static part make_part(const core_mesh_data *d, const uint32_t *index, uint32_t indices,
                      uint32_t *map, uint32_t *used) {
    part p = {.data = {.index_count = indices}};
    p.index = core_alloc(indices * sizeof *p.index);
    memset(map, 0xff, d->vertex_count * sizeof *map);
    uint32_t n = 0;
    for (uint32_t i = 0; i < indices; ++i) {
        if (map[index[i]] == UINT32_MAX) {
            used[n] = index[i];
            map[index[i]] = n++;
        }
        p.index[i] = map[index[i]];
    }
    p.memory = core_alloc((size_t)n * 20 * sizeof *p.memory);
    p.joint = core_alloc((size_t)n * 4 * sizeof *p.joint);
    float *at = p.memory;
    p.data.position = copy_part(at, d->position, 3, used, n);
    p.data.normal = copy_part(at + 3 * (size_t)n, d->normal, 3, used, n);
    p.data.tangent = copy_part(at + 6 * (size_t)n, d->tangent, 4, used, n);
    p.data.uv = copy_part(at + 10 * (size_t)n, d->uv, 2, used, n);
    p.data.color = copy_part(at + 12 * (size_t)n, d->color, 4, used, n);
    p.data.weight = copy_part(at + 16 * (size_t)n, d->weight, 4, used, n);
    for (uint32_t i = 0; d->joint && i < n; ++i) {
        memcpy(p.joint + 4 * (size_t)i, d->joint + 4 * (size_t)used[i], 4 * sizeof *p.joint);
    }
    p.data.joint = d->joint ? p.joint : NULL;
    p.data.vertex_count = n;
    p.data.index = p.index;
    return p;
}

static void free_part(part *p) {
    core_free(p->memory);
    core_free(p->joint);
    core_free(p->index);
}

// Each level has half of the triangles of the one before, as long as that is worth a level.
static void make_levels(gfx_world *world, gfx_mesh finest, const core_mesh_data *data) {
    gfx_simplifier *s = gfx_simplifier_create(data);
    uint32_t *map = core_alloc(data->vertex_count * sizeof *map);
    uint32_t *used = core_alloc(data->vertex_count * sizeof *used);
    uint32_t triangles = data->index_count / 3;
    float radius = store_of(world, finest)->radius;
    gfx_mesh last = finest;
    for (int level = 0; level < MESH_LEVELS && triangles >= 2 * LEAST_TRIANGLES; ++level) {
        uint32_t left = gfx_simplify(s, triangles / 2, 0.1f * radius);
        if (left > triangles * 3 / 4 || left == 0) {
            break;
        }
        part p = make_part(data, gfx_simplifier_index(s), 3 * left, map, used);
        gfx_mesh mesh = make_mesh(world, &p.data);
        free_part(&p);
        gfx_mesh_store *store = store_of(world, mesh);
        if (!store) {
            break;
        }
        store->deviation = gfx_simplifier_error(s) / CORE_MAX(radius, 1e-12f);
        store_of(world, last)->coarser = mesh;
        last = mesh;
        triangles = left;
    }
    core_free(map);
    core_free(used);
    gfx_simplifier_destroy(s);
}

gfx_mesh gfx_mesh_create(gfx_world *world, const core_mesh_data *data) {
    if (!check_mesh(data)) {
        return CORE_NULL_HANDLE;
    }
    gfx_mesh mesh = make_mesh(world, data);
    if (!core_handle_is_null(mesh) && data->index_count / 3 >= LEVELS_FROM) {
        make_levels(world, mesh, data);
    }
    return mesh;
}

uint32_t gfx_mesh_levels(const gfx_world *world, gfx_mesh mesh, gfx_mesh_level *out,
                         uint32_t capacity) {
    uint32_t count = 0, row = core_columns_row(&world->meshes.set, mesh);
    float radius = row == CORE_NO_ROW ? 0.0f : world->meshes.store[row].radius;
    while (row != CORE_NO_ROW) {
        const gfx_mesh_store *s = &world->meshes.store[row];
        if (out && count < capacity) {
            out[count] = (gfx_mesh_level){s->index_count / 3, s->deviation * radius};
        }
        count++;
        row = core_columns_row(&world->meshes.set, s->coarser);
    }
    return count;
}

// ---- built-in shapes: surfaces of revolution round Y and quads, written into fixed arrays ----

// Segments of the built-in round shapes, from fine to coarse: multiples of four.
enum { LEVELS = 3, MAX_SEGMENTS = 40, MAX_VERTICES = 2048, MAX_INDICES = 12288 };
static const int level_segments[LEVELS] = {MAX_SEGMENTS, 20, 12};

typedef struct shape {
    float position[MAX_VERTICES * 3], normal[MAX_VERTICES * 3], tangent[MAX_VERTICES * 4];
    float uv[MAX_VERTICES * 2];
    uint32_t index[MAX_INDICES];
    uint32_t vertices, indices;
    int segments;
} shape;

static uint32_t shape_vertex(shape *s, core_vec3 p, core_vec3 n, core_vec3 t, float u, float v) {
    uint32_t i = s->vertices++;
    memcpy(s->position + 3 * i, &p, sizeof p);
    memcpy(s->normal + 3 * i, &n, sizeof n);
    memcpy(s->tangent + 4 * i, &t, sizeof t);
    s->tangent[4 * i + 3] = 1.0f;
    s->uv[2 * i] = u, s->uv[2 * i + 1] = v;
    return i;
}

static void shape_triangle(shape *s, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *at = s->index + s->indices;
    at[0] = a, at[1] = b, at[2] = c;
    s->indices += 3;
}

// Square of edge 1 at distance d along n.
static void shape_quad(shape *s, core_vec3 n, core_vec3 t, float d) {
    core_vec3 b = core_v3_cross(n, t);
    uint32_t first = s->vertices;
    for (int i = 0; i < 4; ++i) {
        float u = (float)(i & 1), v = (float)(i >> 1);
        core_vec3 p = core_v3_scale(n, d);
        p = core_v3_mad(core_v3_mad(p, t, u - 0.5f), b, v - 0.5f);
        shape_vertex(s, p, n, t, u, 1.0f - v);
    }
    shape_triangle(s, first, first + 1, first + 2);
    shape_triangle(s, first + 2, first + 1, first + 3);
}

static void shape_box(shape *s) {
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = -1; side <= 1; side += 2) {
            float n[3] = {0}, t[3] = {0};
            n[axis] = (float)side;
            t[(axis + 1) % 3] = (float)side;
            shape_quad(s, core_v3(n[0], n[1], n[2]), core_v3(t[0], t[1], t[2]), 0.5f);
        }
    }
}

// A ring of a surface of revolution: radius and height, normal's radial and vertical part.
typedef struct ring {
    float radius, y, nr, ny, v;
} ring;

// Rings from bottom to top; consecutive rings are joined when `joined`.
static void shape_revolve(shape *s, const ring *rings, int count) {
    uint32_t first = s->vertices;
    for (int k = 0; k < count; ++k) {
        for (int i = 0; i <= s->segments; ++i) {
            float u = (float)i / (float)s->segments, sine, cosine;
            float turn = (float)(i % s->segments) / (float)s->segments;
            core_sincosf(2.0f * CORE_PI_F * turn, &sine, &cosine);
            const ring *r = &rings[k];
            shape_vertex(s, core_v3(r->radius * cosine, r->y, -r->radius * sine),
                         core_v3(r->nr * cosine, r->ny, -r->nr * sine),
                         core_v3(-sine, 0.0f, -cosine), u, r->v);
        }
    }
    for (int k = 0; k + 1 < count; ++k) {
        uint32_t segments = (uint32_t)s->segments, row = first + (uint32_t)k * (segments + 1);
        for (uint32_t i = row; i < row + segments; ++i) {
            uint32_t above = i + segments + 1;
            if (rings[k].radius > 0.0f) {
                shape_triangle(s, i, i + 1, above);
            }
            if (rings[k + 1].radius > 0.0f) {
                shape_triangle(s, above, i + 1, above + 1);
            }
        }
    }
}

// Ball of radius 0.5 cut at the equator and pulled apart by `segment` (0: a sphere).
static void shape_capsule(shape *s, float segment) {
    const int half_rings = s->segments / 4;
    ring rings[MAX_SEGMENTS / 2 + 2];
    int n = 0;
    for (int k = 0; k <= 2 * half_rings; ++k) {
        float sine, cosine, half = 0.5f * segment;
        core_sincosf(CORE_PI_F * ((float)k / (float)(2 * half_rings) - 0.5f), &sine, &cosine);
        cosine = k == 0 || k == 2 * half_rings ? 0.0f : cosine;
        ring r = {0.5f * cosine, 0.5f * sine, cosine, sine, 0.0f};
        if (k <= half_rings) {
            rings[n] = r;
            rings[n++].y -= half;
        }
        if (k > half_rings || (k == half_rings && segment > 0.0f)) {
            rings[n] = r;
            rings[n++].y += half;
        }
    }
    for (int k = 0; k < n; ++k) {
        rings[k].v = 0.5f - rings[k].y / (1.0f + segment);
    }
    shape_revolve(s, rings, n);
}

static void shape_cylinder(shape *s) {
    const ring side[] = {{0.5f, -0.5f, 1.0f, 0.0f, 1.0f}, {0.5f, 0.5f, 1.0f, 0.0f, 0.0f}};
    const ring bottom[] = {{0.0f, -0.5f, 0.0f, -1.0f, 1.0f}, {0.5f, -0.5f, 0.0f, -1.0f, 0.0f}};
    const ring top[] = {{0.5f, 0.5f, 0.0f, 1.0f, 1.0f}, {0.0f, 0.5f, 0.0f, 1.0f, 0.0f}};
    shape_revolve(s, bottom, 2);
    shape_revolve(s, side, 2);
    shape_revolve(s, top, 2);
}

static void shape_build(shape *s, int which) {
    switch (which) {
    case 0:
        shape_box(s);
        break;
    case 1:
        shape_capsule(s, 0.0f);
        break;
    case 2:
        shape_capsule(s, 1.0f);
        break;
    case 3:
        shape_cylinder(s);
        break;
    default:
        shape_quad(s, core_v3(0.0f, 1.0f, 0.0f), core_v3(1.0f, 0.0f, 0.0f), 0.0f);
        break;
    }
}

static gfx_mesh make_level(gfx_world *world, int which, int level, gfx_mesh coarser) {
    shape *s = core_alloc(sizeof *s);
    s->segments = level_segments[level];
    shape_build(s, which);
    core_mesh_data data = {.vertex_count = s->vertices,
                           .index_count = s->indices,
                           .position = s->position,
                           .normal = s->normal,
                           .tangent = s->tangent,
                           .uv = s->uv,
                           .index = s->index};
    gfx_mesh mesh = make_mesh(world, &data);
    uint32_t row = core_columns_row(&world->meshes.set, mesh);
    if (row != CORE_NO_ROW) {
        gfx_mesh_store *store = &world->meshes.store[row];
        store->builtin = which + 1;
        store->coarser = coarser;
        // Sagitta of a chord, round the axis and along the meridian.
        store->deviation = 2.0f * (1.0f - core_cosf(CORE_PI_F / (float)s->segments));
    }
    core_free(s);
    return mesh;
}

const char *const gfx_builtin_names[GFX_BUILTIN_MESHES] = {"box", "sphere", "capsule", "cylinder",
                                                           "plane"};

gfx_mesh gfx_mesh_builtin(gfx_world *world, const char *name) {
    const char *const *names = gfx_builtin_names;
    int which = gfx_find_name(name, names, GFX_BUILTIN_MESHES);
    if (which < 0) {
        gfx_fail_name("mesh", name, names, GFX_BUILTIN_MESHES);
        return CORE_NULL_HANDLE;
    }
    if (!core_handle_is_null(world->builtin[which])) {
        return world->builtin[which];
    }
    // Coarse levels first, so that each finer one can name the next coarser.
    bool round = which >= 1 && which <= 3;
    gfx_mesh mesh = CORE_NULL_HANDLE;
    for (int level = round ? LEVELS - 1 : 0; level >= 0; --level) {
        mesh = make_level(world, which, level, mesh);
    }
    world->builtin[which] = mesh;
    return mesh;
}
