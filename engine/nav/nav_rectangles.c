// From open spans to rectangles with edges. Each rectangle is grown greedily along x first or z
// first, whichever gives the larger one; its border is cut where the neighbour changes, so that
// every edge has one polygon, or a wall, on its other side.
#include "nav/nav_internal.h"

enum { EAST, NORTH, WEST, SOUTH }; // +x, +z, -x, -z: order of nav_spans.link

typedef struct rectangle {
    uint32_t across, along; // cells along x and z
} rectangle;

static bool is_free(const nav_mesh_data *m, uint32_t span) {
    return span != NAV_NONE && m->polygon[span] == NAV_NONE;
}

// Free spans in a row from `span` on in one direction, at most `most`.
static uint32_t row_length(const nav_mesh_data *m, uint32_t span, int direction, uint32_t most) {
    uint32_t n = 0;
    while (n < most && is_free(m, span)) {
        n++;
        span = m->span.link[span][direction];
    }
    return n;
}

// Rows of `wide` spans along `direction` that can be stacked sideways: each linked to the one
// before at every place.
static uint32_t rows_that_fit(const nav_mesh_data *m, uint32_t span, int direction, int sideways,
                              uint32_t wide) {
    uint32_t rows = 1;
    for (;; rows++) {
        uint32_t next = m->span.link[span][sideways];
        uint32_t below = span, above = next;
        if (!is_free(m, next) || row_length(m, next, direction, wide) < wide) {
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

static rectangle grow(const nav_mesh_data *m, uint32_t span) {
    rectangle a, b;
    a.across = row_length(m, span, EAST, UINT32_MAX);
    a.along = rows_that_fit(m, span, EAST, NORTH, a.across);
    b.along = row_length(m, span, NORTH, UINT32_MAX);
    b.across = rows_that_fit(m, span, NORTH, EAST, b.along);
    return (uint64_t)a.across * a.along >= (uint64_t)b.across * b.along ? a : b;
}

static void claim(nav_mesh_data *m, uint32_t span, rectangle r, uint32_t polygon) {
    for (uint32_t j = 0; j < r.along; j++) {
        uint32_t at = span;
        for (uint32_t i = 0; i < r.across; i++) {
            m->polygon[at] = polygon;
            at = m->span.link[at][EAST];
        }
        span = m->span.link[span][NORTH];
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
    uint32_t *turn_of; // [span*4] number of a turning point by its key
    uint32_t edges_room, turns_room;
} assembly;

static uint32_t turn_number(assembly *as, uint32_t span, int first) {
    uint32_t key = corner_key(as->mesh, span, first);
    if (key == NAV_NONE) {
        return NAV_NONE;
    }
    nav_mesh_data *m = as->mesh;
    if (as->turn_of[key] == NAV_NONE) {
        if (m->turn_count == as->turns_room) {
            uint32_t wanted = CORE_MAX(as->turns_room * 2, 64u);
            m->turn_y = core_realloc(m->turn_y, as->turns_room * sizeof *m->turn_y,
                                     wanted * sizeof *m->turn_y);
            m->turn_closed = core_realloc(m->turn_closed, as->turns_room, wanted);
            as->turns_room = wanted;
        }
        m->turn_y[m->turn_count] = m->span.y[key / 4];
        m->turn_closed[m->turn_count] = key % 4;
        as->turn_of[key] = m->turn_count++;
    }
    return as->turn_of[key];
}

static void add_edge(assembly *as, int32_t x, int32_t z, uint32_t beyond, uint32_t turn) {
    nav_mesh_data *m = as->mesh;
    if (m->edge_count == as->edges_room) {
        uint32_t wanted = CORE_MAX(as->edges_room * 2, 256u);
        m->edge = core_realloc(m->edge, as->edges_room * sizeof *m->edge, wanted * sizeof *m->edge);
        as->edges_room = wanted;
    }
    m->edge[m->edge_count++] = (nav_edge){x, z, beyond, turn};
}

// One side of a rectangle: `count` spans from `span` in direction `along`; what lies beyond them is
// towards `outside`. The corner at the begin of a span is the one between outside and -along.
static uint32_t add_side(assembly *as, uint32_t span, int along, int outside, uint32_t count) {
    const nav_mesh_data *m = as->mesh;
    static const int32_t step_x[4] = {1, 0, -1, 0}, step_z[4] = {0, 1, 0, -1};
    uint32_t last_beyond = NAV_NONE, end = span;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t over = m->span.link[span][outside];
        uint32_t beyond = over == NAV_NONE ? NAV_NONE : m->polygon[over];
        if (i == 0 || beyond != last_beyond) {
            // Middle of the cell, half a cell back and half a cell out.
            int32_t x = (int32_t)m->span.x[span] + (1 - step_x[along] + step_x[outside]) / 2;
            int32_t z = (int32_t)m->span.z[span] + (1 - step_z[along] + step_z[outside]) / 2;
            // Sides run counter-clockwise, so outside is along - 1 and the corner's directions are
            // along + 2 and, a quarter turn on, along + 3 = outside.
            add_edge(as, x, z, beyond, turn_number(as, span, (along + 2) % 4));
            last_beyond = beyond;
        }
        end = span;
        span = m->span.link[span][along];
    }
    return end;
}

static void add_border(assembly *as, uint32_t span, rectangle r) {
    span = add_side(as, span, EAST, SOUTH, r.across);
    span = add_side(as, span, NORTH, EAST, r.along);
    span = add_side(as, span, WEST, NORTH, r.across);
    add_side(as, span, SOUTH, WEST, r.along);
}

void nav_mesh_assemble(nav_mesh_data *m) {
    uint32_t count = m->span.count, room = 0;
    rectangle *shape = NULL;
    uint32_t *origin = NULL;
    m->polygon = core_alloc((count + 1) * sizeof *m->polygon);
    for (uint32_t s = 0; s < count; s++) {
        m->polygon[s] = NAV_NONE;
    }
    for (uint32_t s = 0; s < count; s++) {
        if (m->polygon[s] != NAV_NONE) {
            continue;
        }
        if (m->polygon_count == room) {
            uint32_t wanted = CORE_MAX(room * 2, 64u);
            shape = core_realloc(shape, room * sizeof *shape, wanted * sizeof *shape);
            origin = core_realloc(origin, room * sizeof *origin, wanted * sizeof *origin);
            room = wanted;
        }
        shape[m->polygon_count] = grow(m, s);
        origin[m->polygon_count] = s;
        claim(m, s, shape[m->polygon_count], m->polygon_count);
        m->polygon_count++;
    }
    assembly as = {.mesh = m, .turn_of = core_alloc(((size_t)count * 4 + 1) * sizeof(uint32_t))};
    for (size_t i = 0; i < (size_t)count * 4; i++) {
        as.turn_of[i] = NAV_NONE;
    }
    m->edge_first = core_alloc((m->polygon_count + 1) * sizeof *m->edge_first);
    for (uint32_t p = 0; p < m->polygon_count; p++) {
        m->edge_first[p] = m->edge_count;
        add_border(&as, origin[p], shape[p]);
    }
    m->edge_first[m->polygon_count] = m->edge_count;
    core_free(as.turn_of);
    core_free(shape);
    core_free(origin);
}
