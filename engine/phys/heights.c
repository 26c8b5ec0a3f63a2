// A field of heights as a mesh that stores no triangles: they follow from the grid. Blocks of 4 x 4
// cells have consecutive numbers and are the leaves of the box tree, so that contacts, sweeps, rays
// and distances find their way as in any mesh; a point costs about 8 bytes.
#include "phys/mesh_internal.h"

#include "core/hash.h"

#include <string.h>

#define SIDE        4u // cells of a block
#define BLOCK       (2u * SIDE * SIDE)
#define POINTS_MOST (1u << 14) // along a side

static uint32_t cells_x(const phys_mesh *m) { return m->heights.columns - 1; }
static uint32_t cells_z(const phys_mesh *m) { return m->heights.rows - 1; }
static uint32_t blocks_x(const phys_mesh *m) { return (cells_x(m) + SIDE - 1) / SIDE; }
static uint32_t blocks_z(const phys_mesh *m) { return (cells_z(m) + SIDE - 1) / SIDE; }

bool phys_heights_check(const phys_shape_desc *d) {
    const core_heights_data *h = d->heights;
    if (h->columns < 2 || h->rows < 2 || h->columns > POINTS_MOST || h->rows > POINTS_MOST ||
        h->height == NULL) {
        return core_fail(
            "phys shape heights: %u x %u points, expected 2..%u each and their heights", h->columns,
            h->rows, POINTS_MOST);
    }
    if (!(h->step_x >= 1e-4f && h->step_x <= 1e5f && h->step_z >= 1e-4f && h->step_z <= 1e5f)) {
        return core_fail("phys shape heights: steps are %g and %g m, expected 0.0001..100000",
                         (double)h->step_x, (double)h->step_z);
    }
    core_vec3 end = core_v3_add(
        h->origin, core_v3(h->step_x * (float)h->columns, 0, h->step_z * (float)h->rows));
    core_vec3 a = phys_abs3(h->origin), b = phys_abs3(end);
    if (!(CORE_MAX(a.x, b.x) <= PHYS_FAR && a.y <= PHYS_FAR && CORE_MAX(a.z, b.z) <= PHYS_FAR)) {
        return core_fail("phys shape heights: from (%g, %g, %g) to x %g, z %g, expected finite "
                         "places within 1e6 m",
                         (double)h->origin.x, (double)h->origin.y, (double)h->origin.z,
                         (double)end.x, (double)end.z);
    }
    for (uint32_t i = 0; i < h->columns * h->rows; i++) {
        if (!(core_absf(h->height[i]) <= PHYS_FAR)) {
            return core_fail(
                "phys shape heights: point (%u, %u) is %g m high, expected at most 1e6",
                i % h->columns, i / h->columns, (double)h->height[i]);
        }
    }
    return true;
}

uint64_t phys_heights_hash(const phys_shape_desc *d) {
    const core_heights_data *h = d->heights;
    uint64_t hash = core_hash(h->height, (size_t)h->columns * h->rows * sizeof(float),
                              (uint64_t)h->columns << 1 | d->one_sided);
    const float frame[5] = {h->step_x, h->step_z, h->origin.x, h->origin.y, h->origin.z};
    hash = core_hash(frame, sizeof frame, hash);
    return d->cells != NULL ? core_hash(d->cells, (size_t)(h->columns - 1) * (h->rows - 1), hash)
                            : hash;
}

// Cell and half of a triangle's number; false where there is none: beyond the border, or a hole.
static bool place_of(const phys_mesh *m, uint32_t t, uint32_t *x, uint32_t *z) {
    uint32_t block = t / BLOCK, cell = t % BLOCK / 2;
    *x = block % blocks_x(m) * SIDE + cell % SIDE;
    *z = block / blocks_x(m) * SIDE + cell / SIDE;
    return *x < cells_x(m) && *z < cells_z(m) &&
           (m->cell == NULL || m->cell[*z * cells_x(m) + *x] != PHYS_HOLE);
}

static uint32_t number_of(const phys_mesh *m, uint32_t x, uint32_t z, uint32_t half) {
    uint32_t block = z / SIDE * blocks_x(m) + x / SIDE;
    return block * BLOCK + (z % SIDE * SIDE + x % SIDE) * 2 + half;
}

bool phys_heights_there(const phys_mesh *m, uint32_t t) {
    uint32_t x, z;
    return place_of(m, t, &x, &z);
}

static core_vec3 point_at(const phys_mesh *m, uint32_t x, uint32_t z) {
    const core_heights_data *h = &m->heights;
    return core_v3(h->origin.x + h->step_x * (float)x,
                   h->origin.y + h->height[(size_t)z * h->columns + x],
                   h->origin.z + h->step_z * (float)z);
}

// The lower half has the corners (x, z), (x, z + 1), (x + 1, z + 1); the other closes the cell.
core_vec3 phys_heights_corner(const phys_mesh *m, uint32_t t, uint32_t k) {
    static const uint8_t dx[2][3] = {{0, 0, 1}, {0, 1, 1}}, dz[2][3] = {{0, 1, 1}, {0, 1, 0}};
    uint32_t x, z, half = t & 1u;
    place_of(m, t, &x, &z);
    return point_at(m, x + dx[half][k], z + dz[half][k]);
}

uint32_t phys_heights_beyond(const phys_mesh *m, uint32_t t, uint32_t k) {
    uint32_t x, z, half = t & 1u;
    place_of(m, t, &x, &z);
    // Over edge k: the cell's other half, or the cell to the side.
    static const int8_t dx[2][3] = {{-1, 0, 0}, {0, 1, 0}}, dz[2][3] = {{0, 1, 0}, {0, 0, -1}};
    uint32_t nx = x + (uint32_t)dx[half][k], nz = z + (uint32_t)dz[half][k];
    if (nx >= cells_x(m) || nz >= cells_z(m)) {
        return PHYS_MESH_NONE;
    }
    uint32_t other = number_of(m, nx, nz, 1u - half);
    return phys_heights_there(m, other) ? other : PHYS_MESH_NONE;
}

uint8_t phys_heights_area(const phys_mesh *m, uint32_t t) {
    uint32_t x, z;
    place_of(m, t, &x, &z);
    return m->cell != NULL ? m->cell[z * cells_x(m) + x] : 0;
}

uint32_t phys_heights_origin(const phys_mesh *m, uint32_t t) {
    uint32_t x, z;
    place_of(m, t, &x, &z);
    return (z * cells_x(m) + x) * 2 + (t & 1u);
}

// ---- the tree over blocks ----
typedef struct range {
    uint32_t node, x0, z0, x1, z1; // blocks
} range;

static void leaf_box(const phys_mesh *m, phys_mesh_node *n, const range *r) {
    uint32_t x0 = r->x0 * SIDE, x1 = CORE_MIN(x0 + SIDE, cells_x(m));
    uint32_t z0 = r->z0 * SIDE, z1 = CORE_MIN(z0 + SIDE, cells_z(m));
    core_vec3 a = point_at(m, x0, z0), b = point_at(m, x1, z1);
    float lo = a.y, hi = a.y;
    for (uint32_t z = z0; z <= z1; z++) {
        for (uint32_t x = x0; x <= x1; x++) {
            float y = point_at(m, x, z).y;
            lo = CORE_MIN(lo, y);
            hi = CORE_MAX(hi, y);
        }
    }
    *n = (phys_mesh_node){{a.x, lo, a.z}, 0, {b.x, hi, b.z}, BLOCK};
    n->first = (r->z0 * blocks_x(m) + r->x0) * BLOCK;
}

static void build_tree(phys_mesh *m) {
    range stack[64];
    uint32_t depth = 0;
    m->node_count = 1;
    stack[depth++] = (range){0, 0, 0, blocks_x(m), blocks_z(m)};
    while (depth != 0) {
        range r = stack[--depth], a = r, b = r;
        uint32_t wide = r.x1 - r.x0, deep = r.z1 - r.z0;
        if (wide == 1 && deep == 1) {
            leaf_box(m, &m->node[r.node], &r);
            continue;
        }
        if (wide >= deep) {
            a.x1 = b.x0 = r.x0 + wide / 2;
        } else {
            a.z1 = b.z0 = r.z0 + deep / 2;
        }
        a.node = m->node_count;
        b.node = m->node_count + 1;
        m->node[r.node] = (phys_mesh_node){.first = a.node};
        m->node_count += 2;
        stack[depth++] = b;
        stack[depth++] = a;
    }
    for (uint32_t i = m->node_count; i-- > 0;) { // children come after their parents
        phys_mesh_node *n = &m->node[i];
        for (int k = 0; n->count == 0 && k < 3; k++) {
            n->lo[k] = CORE_MIN(m->node[n->first].lo[k], m->node[n->first + 1].lo[k]);
            n->hi[k] = CORE_MAX(m->node[n->first].hi[k], m->node[n->first + 1].hi[k]);
        }
    }
}

void phys_heights_build(phys_mesh *m, const phys_shape_desc *d) {
    const core_heights_data *h = d->heights;
    *m = (phys_mesh){.one_sided = d->one_sided, .heights = *h};
    size_t points = (size_t)h->columns * h->rows, cells = (size_t)cells_x(m) * cells_z(m);
    float *height = core_alloc(points * sizeof(float));
    memcpy(height, h->height, points * sizeof(float));
    m->heights.height = m->height = height;
    if (d->cells != NULL) {
        m->cell = core_alloc(cells);
        memcpy(m->cell, d->cells, cells);
    }
    if (d->material_count != 0) {
        m->material_count = d->material_count;
        m->material = core_alloc(d->material_count * sizeof *m->material);
        memcpy(m->material, d->materials, d->material_count * sizeof *m->material);
    }
    uint32_t blocks = blocks_x(m) * blocks_z(m);
    m->triangle_count = blocks * BLOCK;
    m->node = core_alloc(2 * (size_t)blocks * sizeof *m->node);
    build_tree(m);
}

size_t phys_heights_bytes(const phys_mesh *m) {
    size_t points = (size_t)m->heights.columns * m->heights.rows;
    size_t cells = m->cell != NULL ? (size_t)cells_x(m) * cells_z(m) : 0;
    return points * sizeof(float) + cells +
           2 * (size_t)blocks_x(m) * blocks_z(m) * sizeof *m->node +
           m->material_count * sizeof *m->material;
}
