// From open spans to rectangles with edges. Each rectangle is grown greedily along x first or z
// first, whichever gives the larger one; its border is cut where the neighbour changes, so that
// every edge has one polygon, or a wall, on its other side.
#include <string.h>

#include "nav/nav_internal.h"

enum { EAST, NORTH, WEST, SOUTH }; // +x, +z, -x, -z: order of nav_spans.link

typedef struct cutting {
    nav_mesh_data *m;
    nav_block own; // spans of the tile
    uint8_t area;  // of the rectangle that is grown
} cutting;

static bool is_free(const cutting *c, uint32_t span) {
    return span - c->own.first < c->own.count && c->m->span.polygon[span] == NAV_NONE &&
           c->m->span.area[span] == c->area;
}

// Free spans in a row from `span` on in one direction, at most `most`.
static uint32_t row_length(const cutting *c, uint32_t span, int direction, uint32_t most) {
    uint32_t n = 0;
    while (n < most && is_free(c, span)) {
        n++;
        span = c->m->span.link[span][direction];
    }
    return n;
}

// Rows of `wide` spans along `direction` that can be stacked sideways: each linked to the one
// before at every place.
static uint32_t rows_that_fit(const cutting *c, uint32_t span, int direction, int sideways,
                              uint32_t wide) {
    const nav_mesh_data *m = c->m;
    uint32_t rows = 1;
    for (;; rows++) {
        uint32_t next = m->span.link[span][sideways];
        uint32_t below = span, above = next;
        if (!is_free(c, next) || row_length(c, next, direction, wide) < wide) {
            return rows;
        }
        for (uint32_t i = 0; i < wide; i++) {
            if (m->span.link[below][sideways] != above) {
                return rows;
            }
            below = m->span.link[below][direction];
            above = m->span.link[above][direction];
        }
        span = next;
    }
}

static nav_rectangle grow(const cutting *c, uint32_t span) {
    nav_rectangle a = {.span = span}, b = {.span = span};
    a.across = row_length(c, span, EAST, UINT32_MAX);
    a.along = rows_that_fit(c, span, EAST, NORTH, a.across);
    b.along = row_length(c, span, NORTH, UINT32_MAX);
    b.across = rows_that_fit(c, span, NORTH, EAST, b.along);
    return (uint64_t)a.across * a.along >= (uint64_t)b.across * b.along ? a : b;
}

// `polygon` is counted from the first of the tile until all are known.
static void claim(nav_mesh_data *m, nav_rectangle r, uint32_t polygon) {
    uint32_t span = r.span;
    for (uint32_t j = 0; j < r.along; j++) {
        uint32_t at = span;
        for (uint32_t i = 0; i < r.across; i++) {
            m->span.polygon[at] = polygon;
            at = m->span.link[at][EAST];
        }
        span = m->span.link[span][NORTH];
    }
}

static void fit_polygons(nav_polygons *p) {
    if (p->blocks.end <= p->room) {
        return;
    }
    uint32_t wanted = CORE_MAX(p->blocks.end, p->room + p->room / 4);
    p->shape = core_realloc(p->shape, p->room * sizeof *p->shape, wanted * sizeof *p->shape);
    p->edges = core_realloc(p->edges, p->room * sizeof *p->edges, wanted * sizeof *p->edges);
    p->component =
        core_realloc(p->component, p->room * sizeof *p->component, wanted * sizeof *p->component);
    p->room = wanted;
}

void nav_mesh_cut_rectangles(nav_mesh_data *m, uint32_t tile, nav_edge_scratch *scratch) {
    nav_tile *t = &m->tile[tile];
    cutting c = {.m = m, .own = t->span};
    uint32_t end = t->span.first + t->span.count, count = 0;
    for (uint32_t s = t->span.first; s < end; s++) {
        m->span.polygon[s] = NAV_NONE;
    }
    nav_rectangle *shape = scratch->shape.data;
    for (uint32_t s = t->span.first; s < end; s++) {
        if (m->span.polygon[s] != NAV_NONE) {
            continue;
        }
        if ((count + 1) * sizeof *shape > scratch->shape.bytes) {
            shape = nav_buffer_fit(&scratch->shape, (count + 256) * sizeof *shape);
        }
        c.area = m->span.area[s];
        shape[count] = grow(&c, s);
        claim(m, shape[count], count);
        count++;
    }
    nav_block_fit(&m->polygon.blocks, &t->polygon, count, m->tiles_x * m->tiles_z > 1);
    fit_polygons(&m->polygon);
    for (uint32_t s = t->span.first; s < end; s++) {
        m->span.polygon[s] += t->polygon.first;
    }
    if (count) {
        memcpy(m->polygon.shape + t->polygon.first, shape, count * sizeof *shape);
    }
}

// ---- turning points ----

// At the corner of span s between two directions a quarter turn apart: a shortest way bends only
// where exactly one of the four cells around is closed. Gives the span opposite to the closed one,
// times four, plus the first of its two directions to the corner: one number from all three sides.
static uint32_t corner_key(const nav_mesh_data *m, uint32_t s, int first) {
    int second = (first + 1) % 4;
    uint32_t a = m->span.link[s][first], b = m->span.link[s][second];
    uint32_t over_a = a == NAV_NONE ? NAV_NONE : m->span.link[a][second];
    uint32_t over_b = b == NAV_NONE ? NAV_NONE : m->span.link[b][first];
    if (a != NAV_NONE && b != NAV_NONE) {
        return over_a == NAV_NONE || over_b == NAV_NONE ? s * 4 + (uint32_t)first : NAV_NONE;
    }
    if (over_a != NAV_NONE) { // b is closed, a stands opposite to it
        return a * 4 + (uint32_t)second;
    }
    if (over_b != NAV_NONE) {
        return b * 4 + (uint32_t)((first + 3) % 4);
    }
    return NAV_NONE;
}

typedef struct assembly {
    nav_mesh_data *mesh;
    nav_edge_scratch *scratch;
    uint32_t edges, turns;
} assembly;

// Edges are collected first; `turn` holds the key of the corner until all are known.
static void add_edge(assembly *as, nav_edge edge) {
    nav_buffer *b = &as->scratch->edge;
    if ((as->edges + 1) * sizeof edge > b->bytes) {
        nav_buffer_fit(b, (as->edges + 1024) * sizeof edge);
    }
    ((nav_edge *)b->data)[as->edges++] = edge;
}

// One side of a rectangle: `count` spans from `span` in direction `along`; what lies beyond them is
// towards `outside`. The corner at the begin of a span is the one between outside and -along.
static uint32_t add_side(assembly *as, uint32_t span, int along, int outside, uint32_t count) {
    const nav_mesh_data *m = as->mesh;
    static const int32_t step_x[4] = {1, 0, -1, 0}, step_z[4] = {0, 1, 0, -1};
    uint32_t last_beyond = NAV_NONE, end = span;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t over = m->span.link[span][outside];
        uint32_t beyond = over == NAV_NONE ? NAV_NONE : m->span.polygon[over];
        if (i == 0 || beyond != last_beyond) {
            // Middle of the cell, half a cell back and half a cell out.
            int32_t x = (int32_t)m->span.x[span] + (1 - step_x[along] + step_x[outside]) / 2;
            int32_t z = (int32_t)m->span.z[span] + (1 - step_z[along] + step_z[outside]) / 2;
            // Sides run counter-clockwise, so outside is along - 1 and the corner's directions are
            // along + 2 and, a quarter turn on, along + 3 = outside.
            add_edge(as, (nav_edge){x, z, beyond, corner_key(m, span, (along + 2) % 4)});
            last_beyond = beyond;
        }
        end = span;
        span = m->span.link[span][along];
    }
    return end;
}

static void add_border(assembly *as, nav_rectangle r) {
    uint32_t span = add_side(as, r.span, EAST, SOUTH, r.across);
    span = add_side(as, span, NORTH, EAST, r.along);
    span = add_side(as, span, WEST, NORTH, r.across);
    add_side(as, span, SOUTH, WEST, r.along);
}

// Turning points get numbers: a table of keys finds those that were met before. A corner on the
// border of two tiles has a number in each, which costs a search little and keeps tiles apart.
static void number_turns(assembly *as) {
    nav_edge *edge = as->scratch->edge.data;
    uint32_t size = 64;
    while (size < 2 * as->edges) {
        size *= 2;
    }
    uint32_t *table = nav_buffer_fit(&as->scratch->table, size * sizeof *table);
    uint32_t *key = nav_buffer_fit(&as->scratch->key, (as->edges + 1) * sizeof *key);
    memset(table, 0xff, size * sizeof *table);
    for (uint32_t e = 0; e < as->edges; e++) {
        if (edge[e].turn == NAV_NONE) {
            continue;
        }
        uint32_t at = edge[e].turn * 0x9e3779b1u;
        at = (at ^ at >> 15) & (size - 1);
        while (table[at] != NAV_NONE && key[table[at]] != edge[e].turn) {
            at = (at + 1) & (size - 1);
        }
        if (table[at] == NAV_NONE) {
            table[at] = as->turns;
            key[as->turns++] = edge[e].turn;
        }
        edge[e].turn = table[at];
    }
}

static void fit_edges(nav_mesh_data *m) {
    if (m->edge_blocks.end > m->edge_room) {
        uint32_t wanted = CORE_MAX(m->edge_blocks.end, m->edge_room + m->edge_room / 4);
        m->edge = core_realloc(m->edge, m->edge_room * sizeof *m->edge, wanted * sizeof *m->edge);
        m->edge_owner = core_realloc(m->edge_owner, m->edge_room * sizeof *m->edge_owner,
                                     wanted * sizeof *m->edge_owner);
        m->edge_room = wanted;
    }
    if (m->turn_blocks.end > m->turn_room) {
        uint32_t wanted = CORE_MAX(m->turn_blocks.end, m->turn_room + m->turn_room / 4);
        m->turn_y =
            core_realloc(m->turn_y, m->turn_room * sizeof *m->turn_y, wanted * sizeof *m->turn_y);
        m->turn_closed = core_realloc(m->turn_closed, m->turn_room, wanted);
        m->turn_room = wanted;
    }
}

void nav_mesh_find_edges(nav_mesh_data *m, uint32_t tile, nav_edge_scratch *scratch) {
    nav_tile *t = &m->tile[tile];
    assembly as = {.mesh = m, .scratch = scratch};
    bool spare = m->tiles_x * m->tiles_z > 1;
    for (uint32_t p = t->polygon.first; p < t->polygon.first + t->polygon.count; p++) {
        m->polygon.edges[p].first = as.edges;
        add_border(&as, m->polygon.shape[p]);
        m->polygon.edges[p].end = as.edges;
    }
    number_turns(&as);
    nav_block_fit(&m->edge_blocks, &t->edge, as.edges, spare);
    nav_block_fit(&m->turn_blocks, &t->turn, as.turns, spare);
    fit_edges(m);
    for (uint32_t p = t->polygon.first; p < t->polygon.first + t->polygon.count; p++) {
        m->polygon.edges[p].first += t->edge.first;
        m->polygon.edges[p].end += t->edge.first;
        for (uint32_t e = m->polygon.edges[p].first; e < m->polygon.edges[p].end; e++) {
            m->edge_owner[e] = p;
        }
    }
    const nav_edge *edge = scratch->edge.data;
    for (uint32_t e = 0; e < as.edges; e++) {
        nav_edge *out = &m->edge[t->edge.first + e];
        *out = edge[e];
        out->turn += edge[e].turn == NAV_NONE ? 0 : t->turn.first;
    }
    const uint32_t *key = scratch->key.data;
    for (uint32_t i = 0; i < as.turns; i++) {
        m->turn_y[t->turn.first + i] = m->span.y[key[i] / 4];
        m->turn_closed[t->turn.first + i] = key[i] % 4;
    }
}
