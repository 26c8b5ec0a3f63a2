// A triangle mesh's storage: places made equal, neighbours found, a box tree built (binned surface
// area heuristic; Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007).
#include "phys/mesh_internal.h"

#include <string.h>

#define BINS       12
#define TREE_DEPTH 60u  // of the tree, after which leaves grow instead
#define FLAT       1e-7 // height over longest edge of triangles that count as lines

static core_vec3 soup_at(const core_soup_data *s, uint32_t v) {
    // -0 becomes 0: equal places have equal bits.
    return core_v3(s->position[3 * (size_t)v] + 0.0f, s->position[3 * (size_t)v + 1] + 0.0f,
                   s->position[3 * (size_t)v + 2] + 0.0f);
}

static bool check_materials(const phys_shape_desc *d) {
    for (uint32_t i = 0; i < d->material_count; i++) {
        if (!phys_material_check("mesh", &d->materials[i])) {
            return false;
        }
    }
    return true;
}

bool phys_mesh_check(const phys_shape_desc *d) {
    if (d->heights != NULL) {
        return phys_heights_check(d) && check_materials(d);
    }
    const core_soup_data *s = d->mesh;
    if (s == NULL || s->triangle_count == 0 || s->position == NULL || s->index == NULL) {
        return core_fail("phys shape mesh: no triangles given, expected at least one");
    }
    if (s->triangle_count > PHYS_MESH_TRIANGLES) {
        return core_fail("phys shape mesh: %u triangles, expected at most %u: split it into "
                         "several bodies",
                         s->triangle_count, PHYS_MESH_TRIANGLES);
    }
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        core_vec3 p = soup_at(s, v), a = phys_abs3(p);
        if (!(a.x <= PHYS_FAR && a.y <= PHYS_FAR && a.z <= PHYS_FAR)) {
            return core_fail("phys shape mesh: vertex %u is at (%g, %g, %g), expected finite "
                             "places within 1e6 m",
                             v, (double)p.x, (double)p.y, (double)p.z);
        }
    }
    for (size_t i = 0; i < 3 * (size_t)s->triangle_count; i++) {
        if (s->index[i] >= s->vertex_count) {
            return core_fail("phys shape mesh: triangle %zu names vertex %u, expected less than %u",
                             i / 3, s->index[i], s->vertex_count);
        }
    }
    return check_materials(d);
}

static bool has_area(core_vec3 a, core_vec3 b, core_vec3 c) {
    double u[3] = {(double)b.x - a.x, (double)b.y - a.y, (double)b.z - a.z};
    double v[3] = {(double)c.x - a.x, (double)c.y - a.y, (double)c.z - a.z};
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double w[3] = {v[0] - u[0], v[1] - u[1], v[2] - u[2]};
    double n2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    double u2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    double v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    double w2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], most = CORE_MAX(u2, CORE_MAX(v2, w2));
    return n2 > FLAT * FLAT * most * most && n2 > 1e-30;
}

// ---- equal places, equal edges: open addressing on the bits ----
static uint32_t mix(uint64_t key, uint32_t mask) {
    key *= 0x9e3779b97f4a7c15u;
    key ^= key >> 29;
    key *= 0xbf58476d1ce4e5b9u;
    return (uint32_t)(key >> 32) & mask;
}

static uint64_t place_key(core_vec3 p) {
    uint32_t b[3];
    memcpy(b, &p, sizeof b);
    return ((uint64_t)b[0] << 32 | b[1]) ^ (uint64_t)b[2] * 0xd6e8feb86659fd93u;
}

static uint32_t table_size(size_t entries) {
    uint32_t size = 16;
    while (size < 2 * entries) {
        size *= 2;
    }
    return size;
}

// Fills mesh->vertex with the places in use; where[v]: the vertex that soup vertex v became.
static void weld(phys_mesh *m, const core_soup_data *s, uint32_t *where) {
    uint32_t size = table_size(s->vertex_count), *slot = core_alloc(size * sizeof(uint32_t));
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        core_vec3 p = soup_at(s, v);
        uint32_t i = mix(place_key(p), size - 1);
        while (slot[i] != 0 && memcmp(&m->vertex[slot[i] - 1], &p, sizeof p) != 0) {
            i = (i + 1) & (size - 1);
        }
        if (slot[i] == 0) {
            m->vertex[m->vertex_count++] = p;
            slot[i] = m->vertex_count;
        }
        where[v] = slot[i] - 1;
    }
    core_free(slot);
}

typedef struct edge_slot {
    uint64_t key;           // lower vertex << 32 | higher
    uint32_t first, second; // triangle * 3 + edge, of the first two users
    uint32_t users;         // 0: empty
} edge_slot;

static edge_slot *edge_find(edge_slot *slot, uint32_t size, uint32_t a, uint32_t b) {
    uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    uint32_t i = mix(key, size - 1);
    while (slot[i].users != 0 && slot[i].key != key) {
        i = (i + 1) & (size - 1);
    }
    slot[i].key = key;
    return &slot[i];
}

// Two triangles at an edge are neighbours; at edges of three and more every one ends by itself.
static void find_neighbours(phys_mesh *m) {
    size_t edges = 3 * (size_t)m->triangle_count;
    uint32_t size = table_size(edges);
    edge_slot *slot = core_alloc(size * sizeof *slot);
    for (size_t i = 0; i < edges; i++) {
        uint32_t a = m->index[i], b = m->index[i % 3 == 2 ? i - 2 : i + 1];
        edge_slot *e = edge_find(slot, size, a, b);
        m->beyond[i] = PHYS_MESH_NONE;
        if (e->users == 0) {
            e->first = (uint32_t)i;
        } else if (e->users == 1) {
            e->second = (uint32_t)i;
            m->beyond[i] = e->first / 3;
            m->beyond[e->first] = (uint32_t)(i / 3);
        } else {
            m->beyond[e->first] = m->beyond[e->second] = PHYS_MESH_NONE;
        }
        e->users++;
    }
    core_free(slot);
}

// ---- the tree ----
typedef struct builder {
    phys_mesh *mesh;
    phys_box *box;   // of triangles, by number
    uint32_t *order; // triangles, in the order of the leaves
} builder;

static void box_clear(phys_box *b) {
    *b = (phys_box){{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}};
}
static void box_join(phys_box *b, const phys_box *o) {
    for (int k = 0; k < 3; k++) {
        b->lo[k] = CORE_MIN(b->lo[k], o->lo[k]);
        b->hi[k] = CORE_MAX(b->hi[k], o->hi[k]);
    }
}
static double box_area(const phys_box *b) {
    double x = (double)b->hi[0] - b->lo[0], y = (double)b->hi[1] - b->lo[1];
    double z = (double)b->hi[2] - b->lo[2];
    return x * y + y * z + z * x;
}
static float middle(const phys_box *b, int k) { return 0.5f * (b->lo[k] + b->hi[k]); }

typedef struct cut {
    int axis, bin; // axis < 0: none found
    float lo, scale;
} cut;

static int bin_of(const cut *c, const phys_box *b) {
    int k = (int)((middle(b, c->axis) - c->lo) * c->scale);
    return CORE_CLAMP(k, 0, BINS - 1);
}

// The cheapest of BINS - 1 places to cut along each axis.
static cut find_cut(const builder *b, uint32_t first, uint32_t count) {
    phys_box mid;
    box_clear(&mid);
    for (uint32_t i = first; i < first + count; i++) {
        for (int k = 0; k < 3; k++) {
            float at = middle(&b->box[b->order[i]], k);
            mid.lo[k] = CORE_MIN(mid.lo[k], at);
            mid.hi[k] = CORE_MAX(mid.hi[k], at);
        }
    }
    cut best = {.axis = -1};
    double least = 1e300;
    for (int axis = 0; axis < 3; axis++) {
        cut c = {axis, 0, mid.lo[axis], 0.0f};
        if (!(mid.hi[axis] > mid.lo[axis])) {
            continue;
        }
        c.scale = (float)BINS / (mid.hi[axis] - mid.lo[axis]);
        phys_box bin[BINS], sum;
        uint32_t n[BINS] = {0}, left = 0;
        double right_cost[BINS];
        for (int k = 0; k < BINS; k++) {
            box_clear(&bin[k]);
        }
        for (uint32_t i = first; i < first + count; i++) {
            int k = bin_of(&c, &b->box[b->order[i]]);
            box_join(&bin[k], &b->box[b->order[i]]);
            n[k]++;
        }
        box_clear(&sum);
        uint32_t right = 0;
        for (int k = BINS - 1; k > 0; k--) {
            box_join(&sum, &bin[k]);
            right += n[k];
            right_cost[k] = right ? box_area(&sum) * right : 0.0;
        }
        box_clear(&sum);
        for (int k = 0; k < BINS - 1; k++) {
            box_join(&sum, &bin[k]);
            left += n[k];
            if (left == 0 || left == count) {
                continue;
            }
            double cost = box_area(&sum) * left + right_cost[k + 1];
            if (cost < least) {
                least = cost;
                best = c;
                best.bin = k;
            }
        }
    }
    return best;
}

// Moves the triangles left of the cut to the front, keeping neither side's order; returns how many.
static uint32_t part(const builder *b, uint32_t first, uint32_t count, const cut *c) {
    uint32_t i = first, j = first + count;
    while (i < j) {
        if (bin_of(c, &b->box[b->order[i]]) <= c->bin) {
            i++;
        } else {
            uint32_t t = b->order[--j];
            b->order[j] = b->order[i];
            b->order[i] = t;
        }
    }
    return i - first;
}

typedef struct job {
    uint32_t node, first, count, depth;
} job;

static void build_tree(builder *b) {
    phys_mesh *m = b->mesh;
    job stack[2 * TREE_DEPTH + 2];
    uint32_t depth = 0;
    m->node_count = 1;
    stack[depth++] = (job){0, 0, m->triangle_count, 0};
    while (depth != 0) {
        job j = stack[--depth];
        phys_mesh_node *node = &m->node[j.node];
        phys_box all;
        box_clear(&all);
        for (uint32_t i = j.first; i < j.first + j.count; i++) {
            box_join(&all, &b->box[b->order[i]]);
        }
        memcpy(node->lo, all.lo, sizeof all.lo);
        memcpy(node->hi, all.hi, sizeof all.hi);
        node->first = j.first;
        node->count = j.count;
        if (j.count <= PHYS_MESH_LEAF || j.depth == TREE_DEPTH) {
            continue;
        }
        cut c = find_cut(b, j.first, j.count);
        uint32_t left = c.axis < 0 ? j.count / 2 : part(b, j.first, j.count, &c);
        node->first = m->node_count;
        node->count = 0;
        m->node_count += 2;
        stack[depth++] = (job){node->first + 1, j.first + left, j.count - left, j.depth + 1};
        stack[depth++] = (job){node->first, j.first, left, j.depth + 1};
    }
}

// The triangles that have an area, welded; returns how many were left out.
static void take_triangles(phys_mesh *m, const core_soup_data *s) {
    uint32_t *where = core_alloc((s->vertex_count + 1) * sizeof(uint32_t));
    weld(m, s, where);
    for (uint32_t t = 0; t < s->triangle_count; t++) {
        const uint32_t *i = s->index + 3 * (size_t)t;
        uint32_t v[3] = {where[i[0]], where[i[1]], where[i[2]]};
        if (has_area(m->vertex[v[0]], m->vertex[v[1]], m->vertex[v[2]])) {
            memcpy(m->index + 3 * (size_t)m->triangle_count, v, sizeof v);
            m->origin[m->triangle_count++] = t;
        }
    }
    core_free(where);
}

// Puts index and origin into the tree's order.
static void reorder(phys_mesh *m, const uint32_t *order) {
    uint32_t n = m->triangle_count, *index = core_alloc(3 * (size_t)n * sizeof *index);
    uint32_t *origin = core_alloc(n * sizeof *origin);
    for (uint32_t i = 0; i < n; i++) {
        memcpy(index + 3 * (size_t)i, m->index + 3 * (size_t)order[i], 3 * sizeof *index);
        origin[i] = m->origin[order[i]];
    }
    core_free(m->index);
    core_free(m->origin);
    m->index = index;
    m->origin = origin;
}

static void build_order(phys_mesh *m) {
    uint32_t n = m->triangle_count;
    builder b = {m, core_alloc(n * sizeof(phys_box)), core_alloc(n * sizeof(uint32_t))};
    m->node = core_alloc(2 * (size_t)n * sizeof *m->node);
    for (uint32_t t = 0; t < n; t++) {
        box_clear(&b.box[t]);
        for (int k = 0; k < 3; k++) {
            core_vec3 p = m->vertex[m->index[3 * (size_t)t + (size_t)k]];
            phys_box at = {{p.x, p.y, p.z}, {p.x, p.y, p.z}};
            box_join(&b.box[t], &at);
        }
        b.order[t] = t;
    }
    build_tree(&b);
    reorder(m, b.order);
    core_free(b.box);
    core_free(b.order);
    m->node =
        core_realloc(m->node, 2 * (size_t)n * sizeof *m->node, m->node_count * sizeof *m->node);
}

bool phys_mesh_build(phys_mesh *m, const phys_shape_desc *d) {
    if (d->heights != NULL) {
        phys_heights_build(m, d);
        return true;
    }
    *m = (phys_mesh){.one_sided = d->one_sided, .material_count = d->material_count};
    const core_soup_data *s = d->mesh;
    m->vertex = core_alloc((s->vertex_count + 1) * sizeof *m->vertex);
    m->index = core_alloc(3 * (size_t)s->triangle_count * sizeof *m->index);
    m->origin = core_alloc(s->triangle_count * sizeof *m->origin);
    take_triangles(m, s);
    if (m->triangle_count == 0) {
        phys_mesh_release(m);
        return core_fail("phys shape mesh: none of %u triangles has an area", s->triangle_count);
    }
    build_order(m);
    m->vertex = core_realloc(m->vertex, (s->vertex_count + 1) * sizeof *m->vertex,
                             m->vertex_count * sizeof *m->vertex);
    m->beyond = core_alloc(3 * (size_t)m->triangle_count * sizeof *m->beyond);
    find_neighbours(m);
    if (s->area != NULL && d->material_count != 0) {
        m->area = core_alloc(m->triangle_count);
        m->material = core_alloc(d->material_count * sizeof *m->material);
        memcpy(m->material, d->materials, d->material_count * sizeof *m->material);
        for (uint32_t t = 0; t < m->triangle_count; t++) {
            m->area[t] = s->area[m->origin[t]];
        }
    }
    return true;
}

void phys_mesh_release(phys_mesh *m) {
    core_free(m->vertex);
    core_free(m->index);
    core_free(m->beyond);
    core_free(m->origin);
    core_free(m->area);
    core_free(m->material);
    core_free(m->node);
    core_free(m->height);
    core_free(m->cell);
    *m = (phys_mesh){0};
}

size_t phys_mesh_bytes(const phys_mesh *m) {
    if (m->height != NULL) {
        return phys_heights_bytes(m);
    }
    size_t each = 7 * sizeof(uint32_t) + (m->area != NULL ? 1 : 0);
    return m->vertex_count * sizeof *m->vertex + m->triangle_count * each +
           m->node_count * sizeof *m->node + m->material_count * sizeof *m->material;
}

core_aabb phys_mesh_bounds(const phys_mesh *m) {
    const phys_mesh_node *n = &m->node[0];
    return (core_aabb){{n->lo[0], n->lo[1], n->lo[2]}, {n->hi[0], n->hi[1], n->hi[2]}};
}

// ---- walking it ----
void phys_mesh_walk_begin(phys_mesh_walk *w, const phys_mesh *mesh, const phys_box *box) {
    w->mesh = mesh;
    w->box = *box;
    w->stack[0] = 0;
    w->depth = 1;
    w->triangle = w->end = 0;
}

static bool node_meets(const phys_mesh_node *n, const phys_box *b) {
    return !((n->lo[0] > b->hi[0]) | (b->lo[0] > n->hi[0]) | (n->lo[1] > b->hi[1]) |
             (b->lo[1] > n->hi[1]) | (n->lo[2] > b->hi[2]) | (b->lo[2] > n->hi[2]));
}

uint32_t phys_mesh_walk_next(phys_mesh_walk *w) {
    for (;;) {
        while (w->triangle != w->end) {
            uint32_t t = w->triangle++;
            if (phys_mesh_there(w->mesh, t)) {
                return t;
            }
        }
        if (w->depth == 0) {
            return PHYS_MESH_NONE;
        }
        const phys_mesh_node *n = &w->mesh->node[w->stack[--w->depth]];
        if (!node_meets(n, &w->box)) {
            continue;
        }
        if (n->count != 0) {
            w->triangle = n->first;
            w->end = n->first + n->count;
        } else {
            w->stack[w->depth++] = n->first + 1;
            w->stack[w->depth++] = n->first;
        }
    }
}
