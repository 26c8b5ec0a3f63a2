// The world as geometry: shapes one by one, their surfaces as triangles, and where static ones
// changed, so that others (navigation) can follow without knowing this room's storage.
#include "phys/mesh_internal.h"

static void note_shape(phys_static_log *log, const phys_geom *g) {
    core_aabb box = phys_geom_bounds(g);
    log->version++;
    log->change[log->version % PHYS_STATIC_LOG] = box;
    if (log->version - log->oldest > PHYS_STATIC_LOG) {
        log->oldest = log->version - PHYS_STATIC_LOG;
    }
}

void phys_static_note(phys_world *w, uint32_t row) {
    if (w->bodies.type[row] != PHYS_STATIC) {
        return;
    }
    for (uint32_t slot = w->bodies.shape[row]; slot != 0;) {
        uint32_t i = phys_slot_row(&w->shapes.set, slot);
        phys_geom g = phys_shape_geom(w, i);
        note_shape(&w->statics, &g);
        slot = w->shapes.next[i];
    }
}

void phys_static_forget(phys_world *w) {
    w->statics.version++;
    w->statics.oldest = w->statics.version;
}

uint64_t phys_world_static_version(const phys_world *w) { return w->statics.version; }

uint32_t phys_world_static_changes(const phys_world *w, uint64_t since, core_aabb *out,
                                   uint32_t capacity, bool *complete) {
    const phys_static_log *log = &w->statics;
    uint32_t count = 0;
    *complete = since >= log->oldest && since <= log->version;
    for (uint64_t v = CORE_MAX(since, log->oldest) + 1; v <= log->version; v++) {
        if (count < capacity) {
            out[count] = log->change[v % PHYS_STATIC_LOG];
        }
        count++;
    }
    return count;
}

uint32_t phys_world_shape_count(const phys_world *w) { return core_columns_count(&w->shapes.set); }

bool phys_world_shape(const phys_world *w, uint32_t row, phys_shape_view *out) {
    *out = (phys_shape_view){0};
    if (row >= phys_world_shape_count(w)) {
        return core_fail("phys shape: row %u, expected less than %u", row,
                         phys_world_shape_count(w));
    }
    uint32_t body = phys_slot_row(&w->bodies.set, w->shapes.body[row]);
    phys_geom g = phys_shape_geom(w, row);
    out->body = core_columns_handle(&w->bodies.set, body);
    out->body_type = (phys_body_type)w->bodies.type[body];
    out->layer = w->bodies.layer[body];
    out->type = g.type;
    out->position = g.position;
    out->rotation = g.rotation;
    out->half = g.type == PHYS_BOX ? g.half : core_v3(0, 0, 0);
    out->radius = g.radius;
    out->half_height = g.type == PHYS_CAPSULE || g.type == PHYS_CYLINDER ? g.half_height : 0.0f;
    out->bounds = phys_geom_bounds(&g);
    if (g.mesh != NULL && g.mesh->height != NULL) {
        out->heights = &g.mesh->heights;
        out->cells = g.mesh->cell;
    } else if (g.mesh != NULL) {
        out->vertex_count = g.mesh->vertex_count;
        out->triangle_count = g.mesh->triangle_count;
        out->vertex = g.mesh->vertex;
        out->index = g.mesh->index;
    } else if (g.hull != NULL) {
        out->vertex_count = g.hull->vertex_count;
        out->face_count = g.hull->face_count;
        out->vertex = g.hull->vertex;
        out->face_begin = g.hull->face_begin;
        out->loop = g.hull->loop;
    }
    return true;
}

// Collects triangles in the shape's frame, writes them in the world's.
typedef struct sink {
    const phys_shape_view *shape;
    core_vec3 *out;
    uint32_t count, capacity;
} sink;

static void emit(sink *s, core_vec3 a, core_vec3 b, core_vec3 c) {
    if (s->count < s->capacity) {
        core_vec3 p[3] = {a, b, c};
        for (int k = 0; k < 3; k++) {
            s->out[3 * (size_t)s->count + (size_t)k] =
                core_v3_add(s->shape->position, phys_rotate(s->shape->rotation, p[k]));
        }
    }
    s->count++;
}

static void emit_quad(sink *s, core_vec3 a, core_vec3 b, core_vec3 c, core_vec3 d) {
    emit(s, a, b, c);
    emit(s, a, c, d);
}

static void box_triangles(sink *s) {
    core_vec3 h = s->shape->half;
    for (int axis = 0; axis < 3; axis++) {
        for (int side = -1; side <= 1; side += 2) {
            core_vec3 e[3] = {{h.x, 0, 0}, {0, h.y, 0}, {0, 0, h.z}};
            core_vec3 c = core_v3_scale(e[axis], (float)side);
            core_vec3 u = e[(axis + 1) % 3], v = core_v3_scale(e[(axis + 2) % 3], (float)side);
            core_vec3 low = core_v3_sub(c, u), high = core_v3_add(c, u);
            emit_quad(s, core_v3_sub(low, v), core_v3_sub(high, v), core_v3_add(high, v),
                      core_v3_add(low, v));
        }
    }
}

#define ROUND_MOST 256 // pieces about an axis

// Pieces of a full turn whose middle lies at most `tolerance` inside: r (1 - cos(pi / n)), with
// 1 - cos x <= x^2 / 2.
static int pieces(float radius, float tolerance) {
    for (int n = 8; n < ROUND_MOST; n += 4) {
        float half = CORE_PI_F / (float)n;
        if (0.5f * radius * half * half <= tolerance) {
            return n;
        }
    }
    return ROUND_MOST;
}

// A point of a ring about y: turn of n pieces, height, distance from the axis.
static core_vec3 on_ring(int k, int n, float y, float r) {
    float sn, cs;
    core_sincosf((float)(k % n) * (2.0f * CORE_PI_F / (float)n), &sn, &cs);
    return core_v3(r * cs, y, r * sn);
}

// Bands between rings of a surface of revolution, from the bottom up.
static void band(sink *s, int n, float y0, float r0, float y1, float r1) {
    for (int k = 0; k < n; k++) {
        core_vec3 a = on_ring(k, n, y0, r0), b = on_ring(k + 1, n, y0, r0);
        core_vec3 c = on_ring(k + 1, n, y1, r1), d = on_ring(k, n, y1, r1);
        if (r0 > 0.0f) {
            emit(s, a, c, b);
        }
        if (r1 > 0.0f) {
            emit(s, a, d, c);
        }
    }
}

// Sphere (half height 0) and capsule: half rings of n / 2 bands, parted in the middle.
static void round_triangles(sink *s, float tolerance) {
    float r = s->shape->radius, h = s->shape->half_height, y0 = -h - r, r0 = 0.0f;
    int n = pieces(r, tolerance), bands = n / 2;
    for (int k = 1; k <= bands; k++) {
        float sn, cs;
        core_sincosf(CORE_PI_F * (float)k / (float)bands, &sn, &cs);
        float y1 = -r * cs + (2 * k > bands ? h : -h), r1 = k == bands ? 0.0f : r * sn;
        if (2 * k == bands && h > 0.0f) { // the straight part begins at the equator
            band(s, n, y0, r0, -h, r);
            band(s, n, -h, r, h, r);
            y0 = h;
            r0 = r;
            continue;
        }
        band(s, n, y0, r0, y1, r1);
        y0 = y1;
        r0 = r1;
    }
}

static void cylinder_triangles(sink *s, float tolerance) {
    float r = s->shape->radius, h = s->shape->half_height;
    int n = pieces(r, tolerance);
    band(s, n, -h, 0.0f, -h, r);
    band(s, n, -h, r, h, r);
    band(s, n, h, r, h, 0.0f);
}

static void hull_triangles(sink *s) {
    const phys_shape_view *v = s->shape;
    for (uint32_t f = 0; f < v->face_count; f++) {
        const uint32_t *loop = v->loop + v->face_begin[f];
        for (uint32_t k = 2; k < v->face_begin[f + 1] - v->face_begin[f]; k++) {
            emit(s, v->vertex[loop[0]], v->vertex[loop[k - 1]], v->vertex[loop[k]]);
        }
    }
}

static void heights_triangles(sink *s) {
    const core_heights_data *h = s->shape->heights;
    for (uint32_t z = 0; z + 1 < h->rows; z++) {
        for (uint32_t x = 0; x + 1 < h->columns; x++) {
            core_vec3 p[4];
            for (uint32_t k = 0; k < 4; k++) {
                uint32_t i = x + (k & 1u), j = z + (k >> 1);
                p[k] = core_v3_add(h->origin, core_v3(h->step_x * (float)i,
                                                      h->height[(size_t)j * h->columns + i],
                                                      h->step_z * (float)j));
            }
            const uint8_t *cells = s->shape->cells;
            if (cells == NULL || cells[(size_t)z * (h->columns - 1) + x] != PHYS_HOLE) {
                emit(s, p[0], p[2], p[3]);
                emit(s, p[0], p[3], p[1]);
            }
        }
    }
}

static void mesh_triangles(sink *s) {
    if (s->shape->heights != NULL) {
        heights_triangles(s);
        return;
    }
    const phys_shape_view *v = s->shape;
    for (uint32_t t = 0; t < v->triangle_count; t++) {
        const uint32_t *i = v->index + 3 * (size_t)t;
        emit(s, v->vertex[i[0]], v->vertex[i[1]], v->vertex[i[2]]);
    }
}

uint32_t phys_shape_triangles(const phys_shape_view *shape, float tolerance, float plane_half,
                              core_vec3 *out, uint32_t capacity) {
    sink s = {shape, out, 0, out != NULL ? capacity : 0};
    float fine = tolerance > 0.0f ? tolerance : 0.01f, e = plane_half;
    switch (shape->type) {
    case PHYS_BOX:
        box_triangles(&s);
        break;
    case PHYS_PLANE:
        emit_quad(&s, core_v3(-e, 0, -e), core_v3(-e, 0, e), core_v3(e, 0, e), core_v3(e, 0, -e));
        break;
    case PHYS_CYLINDER:
        cylinder_triangles(&s, fine);
        break;
    case PHYS_HULL:
        hull_triangles(&s);
        break;
    case PHYS_MESH:
        mesh_triangles(&s);
        break;
    default:
        round_triangles(&s, fine);
    }
    return s.count;
}
