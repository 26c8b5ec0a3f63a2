// Nearest node by a hashed uniform grid over x and z (height counts in the distance only). Rings of
// cells around the point are looked at until no nearer node can follow. The grid follows from the
// nodes; it is sized anew when their number has doubled.
#include "nav/nav_internal.h"

#define MOST_RINGS 12u // then a scan over all nodes is cheaper than more empty cells

static int32_t cell_of(const nav_cells *c, float x) {
    double cell = core_floor((double)x / (double)c->cell);
    return (int32_t)CORE_CLAMP(cell, -1e9, 1e9);
}

static uint32_t bucket(const nav_cells *c, int32_t x, int32_t z) {
    uint32_t h = (uint32_t)x * 0x9e3779b1u ^ (uint32_t)z * 0x85ebca77u;
    h ^= h >> 15;
    return (h * 0x2c1b3c6du >> 7) & (c->size - 1);
}

static uint32_t bucket_of(const nav_graph_data *g, uint32_t node) {
    const nav_cells *c = &g->cells;
    return bucket(c, cell_of(c, g->node.px[node]), cell_of(c, g->node.pz[node]));
}

static void insert(nav_graph_data *g, uint32_t node) {
    uint32_t b = bucket_of(g, node);
    g->node.next[node] = g->cells.head[b];
    g->cells.head[b] = node + 1;
}

// Cells of about two nodes each, were they spread evenly over their bounds.
static void size_cells(nav_graph_data *g, uint32_t count) {
    float low[2] = {__FLT_MAX__, __FLT_MAX__}, high[2] = {-__FLT_MAX__, -__FLT_MAX__};
    for (uint32_t i = 0; i < count; i++) {
        low[0] = CORE_MIN(low[0], g->node.px[i]), high[0] = CORE_MAX(high[0], g->node.px[i]);
        low[1] = CORE_MIN(low[1], g->node.pz[i]), high[1] = CORE_MAX(high[1], g->node.pz[i]);
    }
    double wide = (double)high[0] - low[0], deep = (double)high[1] - low[1];
    double cell = core_sqrt(2.0 * wide * deep / count);
    if (!(cell > 0.0)) { // all on a line along an axis, or on one point
        cell = 2.0 * CORE_MAX(wide, deep) / count;
    }
    nav_cells *c = &g->cells;
    c->cell = cell > 1e-6 ? (float)CORE_MIN(cell, 1e30) : 1.0f;
    uint32_t size = 64;
    while (size < count) {
        size *= 2;
    }
    c->head = core_realloc(c->head, c->size * sizeof *c->head, size * sizeof *c->head);
    c->size = size;
    for (uint32_t i = 0; i < size; i++) {
        c->head[i] = 0;
    }
    c->planned_for = CORE_MAX(count * 2, 32u);
    for (uint32_t i = 0; i < count; i++) {
        if (g->node.exists[i]) {
            insert(g, i);
        }
    }
}

void nav_cells_add(nav_graph_data *g, uint32_t node) {
    uint32_t count = core_columns_count(&g->node.set);
    if (count > g->cells.planned_for || g->cells.size == 0) {
        size_cells(g, count);
    } else {
        insert(g, node);
    }
}

void nav_cells_remove(nav_graph_data *g, uint32_t node) {
    uint32_t *at = &g->cells.head[bucket_of(g, node)];
    while (*at && *at != node + 1) {
        at = &g->node.next[*at - 1];
    }
    if (*at) {
        *at = g->node.next[node];
    }
}

void nav_cells_release(nav_cells *cells) {
    core_free(cells->head);
    *cells = (nav_cells){0};
}

typedef struct best {
    double square;
    uint32_t node;
} best;

static void consider(const nav_graph_data *g, uint32_t node, core_vec3 p, best *b) {
    double dx = (double)g->node.px[node] - p.x, dy = (double)g->node.py[node] - p.y;
    double dz = (double)g->node.pz[node] - p.z;
    double square = dx * dx + dy * dy + dz * dz;
    if (square < b->square || (square == b->square && node < b->node)) {
        *b = (best){square, node};
    }
}

static void consider_cell(const nav_graph_data *g, int32_t x, int32_t z, core_vec3 p, best *b) {
    for (uint32_t n = g->cells.head[bucket(&g->cells, x, z)]; n; n = g->node.next[n - 1]) {
        consider(g, n - 1, p, b); // other cells' nodes in this bucket do no harm
    }
}

static void consider_ring(const nav_graph_data *g, int32_t x, int32_t z, int32_t ring, core_vec3 p,
                          best *b) {
    for (int32_t dx = -ring; dx <= ring; dx++) {
        bool edge = dx == -ring || dx == ring;
        for (int32_t dz = -ring; dz <= ring; dz += edge || ring == 0 ? 1 : 2 * ring) {
            consider_cell(g, x + dx, z + dz, p, b);
        }
    }
}

uint32_t nav_graph_nearest(const nav_world *w, nav_graph graph, core_vec3 p, float max_distance) {
    uint32_t row = nav_graph_row(w, graph);
    if (row == CORE_NO_ROW || p.x - p.x != 0.0f || p.y - p.y != 0.0f || p.z - p.z != 0.0f) {
        return NAV_NO_NODE;
    }
    const nav_graph_data *g = w->graph.data[row];
    uint32_t count = core_columns_count(&g->node.set);
    double limit = max_distance > 0.0f ? (double)max_distance * (double)max_distance : __DBL_MAX__;
    best b = {__DBL_MAX__, NAV_NO_NODE};
    if (w->graph.head[row].nodes == 0) {
        return NAV_NO_NODE;
    }
    int32_t x = cell_of(&g->cells, p.x), z = cell_of(&g->cells, p.z);
    double cell = (double)g->cells.cell;
    for (uint32_t ring = 0; ring <= MOST_RINGS; ring++) {
        consider_ring(g, x, z, (int32_t)ring, p, &b);
        double reach = ring * cell; // all nodes nearer than this have been seen
        if (b.square <= reach * reach || limit <= reach * reach) {
            return b.square <= limit ? b.node : NAV_NO_NODE;
        }
    }
    for (uint32_t node = 0; node < count; node++) {
        if (g->node.exists[node]) {
            consider(g, node, p, &b);
        }
    }
    return b.square <= limit ? b.node : NAV_NO_NODE;
}
