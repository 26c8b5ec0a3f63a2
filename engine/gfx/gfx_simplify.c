// In passes: all collapses of an edge that may be done are listed with their error, sorted, and
// done from the least on, each where no neighbour was touched in the same pass.
#include "gfx/gfx_simplify.h"

#include "core/hash.h"

#include <stdlib.h>
#include <string.h>

// Sum of squared distances from planes: a 4 x 4 symmetric matrix.
typedef struct quadric {
    double xx, xy, xz, xw, yy, yz, yw, zz, zw, ww;
} quadric;

typedef struct collapse {
    double cost;
    uint32_t from, to; // points
} collapse;

struct gfx_simplifier {
    const core_mesh_data *mesh;
    uint32_t *point; // [vertices] of equal position: the first vertex there
    quadric *q;      // [vertices], used where a point is
    uint32_t *index;
    uint32_t triangles;
    uint32_t *first, *around; // triangles round each point: around[first[p] .. first[p + 1]]
    uint8_t *border;          // [vertices] 1: on an open edge, 2: on one with three faces or more
    uint8_t *touched;
    collapse *list;
    uint32_t *into; // [vertices] the point that took a point's place, itself where it stands
};

static core_vec3 position(const gfx_simplifier *s, uint32_t v) {
    const float *p = s->mesh->position + 3 * (size_t)v;
    return core_v3(p[0], p[1], p[2]);
}

// ---- quadrics ----

static void add_plane(quadric *q, core_vec3 n, core_vec3 at) {
    double x = (double)n.x, y = (double)n.y, z = (double)n.z;
    double w = -(x * (double)at.x + y * (double)at.y + z * (double)at.z);
    q->xx += x * x, q->xy += x * y, q->xz += x * z, q->xw += x * w;
    q->yy += y * y, q->yz += y * z, q->yw += y * w;
    q->zz += z * z, q->zw += z * w, q->ww += w * w;
}

static void add_quadric(quadric *q, const quadric *o) {
    q->xx += o->xx, q->xy += o->xy, q->xz += o->xz, q->xw += o->xw;
    q->yy += o->yy, q->yz += o->yz, q->yw += o->yw;
    q->zz += o->zz, q->zw += o->zw, q->ww += o->ww;
}

static double squared_error(const quadric *q, core_vec3 p) {
    double x = (double)p.x, y = (double)p.y, z = (double)p.z;
    double e =
        q->xx * x * x + q->yy * y * y + q->zz * z * z + q->ww +
        2 * (q->xy * x * y + q->xz * x * z + q->yz * y * z + q->xw * x + q->yw * y + q->zw * z);
    return CORE_MAX(e, 0.0);
}

static core_vec3 face(const gfx_simplifier *s, const uint32_t v[3]) {
    core_vec3 a = position(s, v[0]);
    return core_v3_cross(core_v3_sub(position(s, v[1]), a), core_v3_sub(position(s, v[2]), a));
}

// ---- making ----

static uint64_t place_hash(const float *p) {
    float clean[3] = {p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f}; // -0 is 0
    return core_hash(clean, sizeof clean, 0);
}

// First vertex of each position, by a table of twice as many slots.
static void find_points(gfx_simplifier *s) {
    uint32_t n = s->mesh->vertex_count, slots = 16;
    while (slots < 2 * n) {
        slots *= 2;
    }
    uint32_t *slot = core_alloc(slots * sizeof *slot); // 1 + vertex
    memset(slot, 0, slots * sizeof *slot);
    for (uint32_t v = 0; v < n; ++v) {
        const float *p = s->mesh->position + 3 * (size_t)v;
        uint32_t at = (uint32_t)place_hash(p) & (slots - 1);
        while (slot[at]) {
            const float *o = s->mesh->position + 3 * (size_t)(slot[at] - 1);
            if (o[0] == p[0] && o[1] == p[1] && o[2] == p[2]) {
                break;
            }
            at = (at + 1) & (slots - 1);
        }
        slot[at] = slot[at] ? slot[at] : v + 1;
        s->point[v] = slot[at] - 1;
    }
    core_free(slot);
}

static bool flat(const gfx_simplifier *s, const uint32_t v[3]) {
    uint32_t a = s->point[v[0]], b = s->point[v[1]], c = s->point[v[2]];
    return a == b || b == c || c == a;
}

static void list_triangles(gfx_simplifier *s) {
    uint32_t n = s->mesh->vertex_count;
    memset(s->first, 0, (n + 1) * sizeof *s->first);
    for (uint32_t i = 0; i < 3 * s->triangles; ++i) {
        s->first[s->point[s->index[i]] + 1]++;
    }
    for (uint32_t v = 0; v < n; ++v) {
        s->first[v + 1] += s->first[v];
    }
    for (uint32_t i = 0; i < 3 * s->triangles; ++i) { // first[p] moves to the end of p's list
        s->around[s->first[s->point[s->index[i]]]++] = i / 3;
    }
    for (uint32_t v = n; v > 0; --v) {
        s->first[v] = s->first[v - 1];
    }
    s->first[0] = 0;
}

static bool has_point(const gfx_simplifier *s, uint32_t triangle, uint32_t point) {
    const uint32_t *v = s->index + 3 * (size_t)triangle;
    return s->point[v[0]] == point || s->point[v[1]] == point || s->point[v[2]] == point;
}

static uint32_t faces_of_edge(const gfx_simplifier *s, uint32_t a, uint32_t b) {
    uint32_t count = 0;
    for (uint32_t i = s->first[a]; i < s->first[a + 1]; ++i) {
        count += has_point(s, s->around[i], b);
    }
    return count;
}

// Open edges get a plane across their face, so that outlines stay.
static void make_quadrics(gfx_simplifier *s) {
    for (uint32_t t = 0; t < s->triangles; ++t) {
        const uint32_t *v = s->index + 3 * (size_t)t;
        core_vec3 n = core_v3_normalize(face(s, v), core_v3(0, 0, 0));
        for (int k = 0; k < 3; ++k) {
            uint32_t a = s->point[v[k]], b = s->point[v[(k + 1) % 3]];
            add_plane(&s->q[a], n, position(s, a));
            uint32_t faces = faces_of_edge(s, a, b);
            if (faces == 1) {
                core_vec3 along = core_v3_sub(position(s, b), position(s, a));
                core_vec3 side = core_v3_normalize(core_v3_cross(along, n), core_v3(0, 0, 0));
                add_plane(&s->q[a], side, position(s, a));
                add_plane(&s->q[b], side, position(s, a));
            }
            uint8_t kind = faces == 1 ? 1 : faces > 2 ? 2 : 0;
            s->border[a] = CORE_MAX(s->border[a], kind);
            s->border[b] = CORE_MAX(s->border[b], kind);
        }
    }
}

gfx_simplifier *gfx_simplifier_create(const core_mesh_data *mesh) {
    gfx_simplifier *s = core_alloc(sizeof *s);
    uint32_t n = mesh->vertex_count;
    *s = (gfx_simplifier){.mesh = mesh};
    s->point = core_alloc(n * sizeof *s->point);
    s->q = core_alloc(n * sizeof *s->q);
    s->index = core_alloc(mesh->index_count * sizeof *s->index);
    s->first = core_alloc((n + 1) * sizeof *s->first);
    s->around = core_alloc(mesh->index_count * sizeof *s->around);
    s->border = core_alloc(n);
    s->touched = core_alloc(n);
    s->list = core_alloc(mesh->index_count * 2 * sizeof *s->list);
    s->into = core_alloc(n * sizeof *s->into);
    for (uint32_t v = 0; v < n; ++v) {
        s->into[v] = v;
    }
    memset(s->q, 0, n * sizeof *s->q);
    memset(s->border, 0, n);
    find_points(s);
    for (uint32_t i = 0; i < mesh->index_count; i += 3) {
        if (!flat(s, mesh->index + i)) {
            memcpy(s->index + 3 * (size_t)s->triangles++, mesh->index + i, 3 * sizeof *s->index);
        }
    }
    list_triangles(s);
    make_quadrics(s);
    return s;
}

void gfx_simplifier_destroy(gfx_simplifier *s) {
    void *const blocks[] = {s->into,   s->point,  s->q,       s->index, s->first,
                            s->around, s->border, s->touched, s->list,  s};
    for (size_t i = 0; i < CORE_COUNT_OF(blocks); ++i) {
        core_free(blocks[i]);
    }
}

const uint32_t *gfx_simplifier_index(const gfx_simplifier *s) { return s->index; }

// ---- collapses ----

// The vertex at point `to` that a vertex at another point turns into: one that shares a face with
// it. UINT32_MAX: none, it lies on the other side of a seam.
static uint32_t partner(const gfx_simplifier *s, uint32_t from, uint32_t vertex, uint32_t to) {
    for (uint32_t i = s->first[from]; i < s->first[from + 1]; ++i) {
        const uint32_t *v = s->index + 3 * (size_t)s->around[i];
        bool holds = v[0] == vertex || v[1] == vertex || v[2] == vertex;
        for (int k = 0; k < 3 && holds; ++k) {
            if (s->point[v[k]] == to) {
                return v[k];
            }
        }
    }
    return UINT32_MAX;
}

// Points next to both ends: two of them inside a surface, one on its border; more would pinch it.
static uint32_t common_neighbours(const gfx_simplifier *s, uint32_t a, uint32_t b) {
    uint32_t count = 0, seen[64], known = 0;
    for (uint32_t i = s->first[a]; i < s->first[a + 1]; ++i) {
        const uint32_t *v = s->index + 3 * (size_t)s->around[i];
        for (int k = 0; k < 3; ++k) {
            uint32_t p = s->point[v[k]];
            bool old = p == a || p == b;
            for (uint32_t j = 0; j < known && !old; ++j) {
                old = seen[j] == p;
            }
            if (!old && known < 64) {
                seen[known++] = p;
                count += faces_of_edge(s, p, b) > 0;
            }
        }
    }
    return known < 64 ? count : UINT32_MAX;
}

// Every face that stays keeps its side, and does not become a sliver's edge; every vertex finds a
// partner.
static bool may_collapse(const gfx_simplifier *s, uint32_t from, uint32_t to) {
    for (uint32_t i = s->first[from]; i < s->first[from + 1]; ++i) {
        uint32_t t = s->around[i], v[3];
        memcpy(v, s->index + 3 * (size_t)t, sizeof v);
        int corner = s->point[v[0]] == from ? 0 : s->point[v[1]] == from ? 1 : 2;
        uint32_t next = partner(s, from, v[corner], to);
        if (next == UINT32_MAX) {
            return false;
        }
        if (has_point(s, t, to)) {
            continue;
        }
        core_vec3 before = face(s, v);
        v[corner] = next;
        core_vec3 after = face(s, v);
        float length = core_v3_length(before) * core_v3_length(after);
        if (!(core_v3_dot(before, after) > 0.25f * length)) {
            return false;
        }
    }
    uint32_t faces = faces_of_edge(s, from, to);
    return common_neighbours(s, from, to) == faces;
}

// Borders shrink along themselves alone.
static bool allowed(const gfx_simplifier *s, uint32_t from, uint32_t to) {
    if (s->border[from] == 2) {
        return false;
    }
    return s->border[from] == 0 || (s->border[to] && faces_of_edge(s, from, to) == 1);
}

static double cost_of(const gfx_simplifier *s, uint32_t from, uint32_t to) {
    quadric q = s->q[from];
    add_quadric(&q, &s->q[to]);
    return squared_error(&q, position(s, to));
}

// Of the two ways of each edge the one with less error; edges are met from both sides.
static uint32_t list_collapses(gfx_simplifier *s, double most) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < s->triangles; ++t) {
        const uint32_t *v = s->index + 3 * (size_t)t;
        for (int k = 0; k < 3; ++k) {
            uint32_t a = s->point[v[k]], b = s->point[v[(k + 1) % 3]];
            const collapse way[2] = {{cost_of(s, a, b), a, b}, {cost_of(s, b, a), b, a}};
            int best = way[1].cost < way[0].cost;
            for (int i = 0; i < 2; ++i, best = !best) {
                if (way[best].cost <= most && allowed(s, way[best].from, way[best].to)) {
                    s->list[count++] = way[best];
                    break;
                }
            }
        }
    }
    return count;
}

static int by_cost(const void *x, const void *y) {
    const collapse *a = x, *b = y;
    if (a->cost != b->cost) {
        return a->cost < b->cost ? -1 : 1;
    }
    if (a->from != b->from) {
        return a->from < b->from ? -1 : 1;
    }
    return a->to < b->to ? -1 : a->to > b->to;
}

static bool untouched(const gfx_simplifier *s, uint32_t point) {
    for (uint32_t i = s->first[point]; i < s->first[point + 1]; ++i) {
        const uint32_t *v = s->index + 3 * (size_t)s->around[i];
        for (int k = 0; k < 3; ++k) {
            if (s->touched[s->point[v[k]]]) {
                return false;
            }
        }
    }
    return true;
}

// Returns how many faces it takes away. Lists of faces stay as they were until the pass is over.
static uint32_t do_collapse(gfx_simplifier *s, const collapse *c) {
    uint32_t gone = faces_of_edge(s, c->from, c->to);
    uint32_t vertices[64], partners[64], count = 0;
    for (uint32_t i = s->first[c->from]; i < s->first[c->from + 1] && count < 64; ++i) {
        const uint32_t *v = s->index + 3 * (size_t)s->around[i];
        int corner = s->point[v[0]] == c->from ? 0 : s->point[v[1]] == c->from ? 1 : 2;
        vertices[count] = v[corner];
        partners[count++] = partner(s, c->from, v[corner], c->to);
    }
    for (uint32_t i = s->first[c->from], k = 0; i < s->first[c->from + 1] && k < count; ++i, ++k) {
        uint32_t *v = s->index + 3 * (size_t)s->around[i];
        for (int n = 0; n < 3; ++n) {
            v[n] = v[n] == vertices[k] ? partners[k] : v[n];
        }
    }
    add_quadric(&s->q[c->to], &s->q[c->from]);
    s->touched[c->from] = s->touched[c->to] = 1;
    s->into[c->from] = c->to;
    return gone;
}

static void remove_flat(gfx_simplifier *s) {
    uint32_t kept = 0;
    for (uint32_t t = 0; t < s->triangles; ++t) {
        const uint32_t *v = s->index + 3 * (size_t)t;
        if (!flat(s, v)) {
            memmove(s->index + 3 * (size_t)kept++, v, 3 * sizeof *v);
        }
    }
    s->triangles = kept;
}

uint32_t gfx_simplify(gfx_simplifier *s, uint32_t triangles, float most) {
    double bound = (double)most * (double)most;
    for (bool going = true; going && s->triangles > triangles;) {
        uint32_t count = list_collapses(s, bound), left = s->triangles;
        qsort(s->list, count, sizeof *s->list, by_cost);
        memset(s->touched, 0, s->mesh->vertex_count);
        going = false;
        for (uint32_t i = 0; i < count && left > triangles; ++i) {
            const collapse *c = &s->list[i];
            bool few = s->first[c->from + 1] - s->first[c->from] < 64;
            if (few && untouched(s, c->from) && untouched(s, c->to) &&
                may_collapse(s, c->from, c->to)) {
                left -= do_collapse(s, c);
                going = true;
            }
        }
        remove_flat(s);
        list_triangles(s);
    }
    return s->triangles;
}

// ---- how far it is off ----

static float squared_to_edge(core_vec3 p, core_vec3 a, core_vec3 b) {
    core_vec3 ab = core_v3_sub(b, a), ap = core_v3_sub(p, a);
    float length2 = core_v3_dot(ab, ab);
    float t = length2 > 0.0f ? CORE_CLAMP(core_v3_dot(ap, ab) / length2, 0.0f, 1.0f) : 0.0f;
    core_vec3 d = core_v3_mad(ap, ab, -t);
    return core_v3_dot(d, d);
}

// To its plane where the point lies above the face, else to the nearest edge.
static float squared_to_face(const gfx_simplifier *s, core_vec3 p, const uint32_t v[3]) {
    core_vec3 n = face(s, v), corner[3];
    bool above = core_v3_dot(n, n) > 0.0f;
    for (int k = 0; k < 3; ++k) {
        corner[k] = position(s, v[k]);
    }
    float least = 1e30f;
    for (int k = 0; k < 3; ++k) {
        core_vec3 a = corner[k], b = corner[(k + 1) % 3];
        core_vec3 inward = core_v3_cross(n, core_v3_sub(b, a));
        above = above && core_v3_dot(inward, core_v3_sub(p, a)) >= 0.0f;
        float d = squared_to_edge(p, a, b);
        least = CORE_MIN(least, d);
    }
    if (above) {
        float d = core_v3_dot(core_v3_sub(p, corner[0]), n);
        return d * d / core_v3_dot(n, n);
    }
    return least;
}

static uint32_t place_of(const gfx_simplifier *s, uint32_t vertex) {
    uint32_t p = s->point[vertex];
    while (s->into[p] != p) {
        p = s->into[p];
    }
    return p;
}

// Least distance from the faces round three points.
static float squared_to_rings(const gfx_simplifier *s, core_vec3 p, const uint32_t ring[3]) {
    float least = 1e30f;
    for (int k = 0; k < 3; ++k) {
        for (uint32_t i = s->first[ring[k]]; i < s->first[ring[k] + 1]; ++i) {
            float d = squared_to_face(s, p, s->index + 3 * (size_t)s->around[i]);
            least = CORE_MIN(least, d);
        }
    }
    return least;
}

// Larger of `worst` and the squared distance of a point. The faces near where its own corners went
// bound it from above: all are looked at only when that bound would be the largest so far.
static float larger(const gfx_simplifier *s, core_vec3 p, const uint32_t ring[3], float worst) {
    float near = squared_to_rings(s, p, ring);
    for (uint32_t t = 0; t < s->triangles && near > worst; ++t) {
        float d = squared_to_face(s, p, s->index + 3 * (size_t)t);
        near = CORE_MIN(near, d);
    }
    return s->triangles ? CORE_MAX(worst, near) : worst;
}

float gfx_simplifier_error(const gfx_simplifier *s) {
    float worst = 0.0f;
    for (uint32_t i = 0; i < s->mesh->index_count; i += 3) {
        const uint32_t *v = s->mesh->index + i;
        uint32_t ring[3] = {place_of(s, v[0]), place_of(s, v[1]), place_of(s, v[2])};
        core_vec3 sum = {0};
        for (int k = 0; k < 3; ++k) {
            core_vec3 p = position(s, v[k]);
            sum = core_v3_add(sum, p);
            worst = larger(s, p, ring, worst);
        }
        worst = larger(s, core_v3_scale(sum, 1.0f / 3.0f), ring, worst);
    }
    return core_sqrtf(worst);
}
