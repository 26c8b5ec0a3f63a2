// Surfaces as bytes (".cnav", little-endian): description, spans with their links, pieces, links
// that leave the ground. Rectangles and edges follow from the spans. Nothing in the bytes is
// believed: every count is held against what is left, every link against its other end.
#include <string.h>

#include "nav/nav_internal.h"

#define MAGIC      0x31564e43u // "CNV1"
#define NO_STEP    255u        // a span without a neighbour in that direction
#define MOST_STACK 254u
#define TRIANGLE   37u // bytes: nine floats and the area
#define PIECE_HEAD 38u
#define LINK_BYTES 48u

// ---- writing ----

typedef struct writer {
    uint8_t *out;
    size_t size, length;
} writer;

static void put(writer *w, const void *data, size_t bytes) {
    if (w->length + bytes <= w->size && bytes) {
        memcpy(w->out + w->length, data, bytes);
    }
    w->length += bytes;
}
static void put_u8(writer *w, uint8_t v) { put(w, &v, sizeof v); }
static void put_u32(writer *w, uint32_t v) { put(w, &v, sizeof v); }
static void put_u64(writer *w, uint64_t v) { put(w, &v, sizeof v); }
static void put_float(writer *w, float v) { put(w, &v, sizeof v); }
static void put_vec3(writer *w, core_vec3 v) {
    put_float(w, v.x);
    put_float(w, v.y);
    put_float(w, v.z);
}

static void put_head(writer *w, const nav_mesh_data *m) {
    put_u32(w, MAGIC);
    const float number[6] = {m->desc.cell_size, m->desc.agent_radius, m->desc.agent_height,
                             m->desc.max_climb, m->desc.max_slope,    m->desc.max_error};
    put(w, number, sizeof number);
    const uint32_t count[7] = {m->desc.tile_cells,   m->desc.tiles_per_step, m->width, m->depth,
                               m->span.blocks.count, m->piece_count,         m->links};
    put(w, count, sizeof count);
    put_vec3(w, m->origin);
}

static void put_spans(writer *w, const nav_mesh_data *m) {
    const nav_spans *s = &m->span;
    size_t cells = (size_t)m->width * m->depth;
    put(w, s->stack, cells * sizeof *s->stack);
    for (size_t c = 0; c < cells; c++) {
        for (uint32_t i = s->first[c]; i < s->first[c] + s->stack[c]; i++) {
            put_float(w, s->y[i]);
            put_u8(w, s->area[i]);
            for (int d = 0; d < 4; d++) {
                uint32_t t = s->link[i][d];
                uint32_t first = t == NAV_NONE ? 0 : s->first[s->z[t] * m->width + s->x[t]];
                put_u8(w, (uint8_t)(t == NAV_NONE ? NO_STEP : t - first));
            }
        }
    }
}

static void put_pieces(writer *w, const nav_mesh_data *m) {
    for (uint32_t i = 0; i < m->piece_count; i++) {
        const nav_piece *p = m->piece[i];
        put_u64(w, p->key);
        put_u8(w, p->mark);
        put_u8(w, p->area);
        put_vec3(w, p->box.min);
        put_vec3(w, p->box.max);
        put_u32(w, p->count);
        const nav_triangle *t = p->triangles.data;
        for (uint32_t k = 0; k < p->count; k++) {
            put(w, t[k].corner, sizeof t[k].corner);
            put_u8(w, t[k].area);
        }
    }
}

static void put_links(writer *w, const nav_mesh_data *m) {
    for (uint32_t i = 0; i < m->links; i++) {
        const nav_mesh_link_desc *d = &m->link[i].desc;
        put_vec3(w, d->start);
        put_vec3(w, d->end);
        put_float(w, d->cost);
        put_u64(w, d->user);
        const uint32_t bits[3] = {
            (uint32_t)d->kind, (d->both_ways ? 1u : 0u) | (d->closed ? 2u : 0u), m->link[i].exists};
        put(w, bits, sizeof bits);
    }
}

size_t nav_mesh_save(nav_world *world, nav_mesh mesh, void *out, size_t size) {
    uint32_t row;
    const nav_mesh_data *m = nav_mesh_find(world, mesh, &row);
    if (!m || (m->dirty && !nav_mesh_renew(world, row, 0))) {
        return 0;
    }
    for (size_t c = 0; c < (size_t)m->width * m->depth; c++) {
        if (m->span.stack[c] > MOST_STACK) {
            core_fail("nav_mesh_save: a cell has %u storeys, a file holds at most %u",
                      m->span.stack[c], MOST_STACK);
            return 0;
        }
    }
    writer w = {out, out ? size : 0, 0};
    put_head(&w, m);
    put_spans(&w, m);
    put_pieces(&w, m);
    put_links(&w, m);
    return w.length;
}

// ---- reading ----

typedef struct reader {
    const uint8_t *at;
    size_t left;
    bool good;
} reader;

static void get(reader *r, void *out, size_t bytes) {
    if (!r->good || bytes > r->left) {
        r->good = false;
        memset(out, 0, bytes);
        return;
    }
    memcpy(out, r->at, bytes);
    r->at += bytes, r->left -= bytes;
}
static uint8_t get_u8(reader *r) {
    uint8_t v;
    get(r, &v, sizeof v);
    return v;
}
static uint32_t get_u32(reader *r) {
    uint32_t v;
    get(r, &v, sizeof v);
    return v;
}
static uint64_t get_u64(reader *r) {
    uint64_t v;
    get(r, &v, sizeof v);
    return v;
}
static float get_float(reader *r) {
    float v;
    get(r, &v, sizeof v);
    return v;
}
static core_vec3 get_vec3(reader *r) {
    float v[3];
    get(r, v, sizeof v);
    return core_v3(v[0], v[1], v[2]);
}
static bool near_by(core_vec3 p) {
    return core_absf(p.x) <= 1e6f && core_absf(p.y) <= 1e6f && core_absf(p.z) <= 1e6f;
}
static bool bad(const char *what) {
    return core_fail("nav_mesh_load: %s; expected a .cnav file that nav_mesh_save wrote", what);
}

typedef struct counts {
    uint32_t spans, pieces, links;
} counts;

static bool get_head(reader *r, nav_mesh_data *m, counts *n) {
    if (get_u32(r) != MAGIC) {
        return bad("the data does not begin with CNV1");
    }
    m->desc = nav_mesh_desc_default();
    float *number[6] = {&m->desc.cell_size, &m->desc.agent_radius, &m->desc.agent_height,
                        &m->desc.max_climb, &m->desc.max_slope,    &m->desc.max_error};
    for (int i = 0; i < 6; i++) {
        *number[i] = get_float(r);
    }
    float cell = m->desc.cell_size;
    m->desc.tile_cells = get_u32(r);
    m->desc.tiles_per_step = get_u32(r);
    m->width = get_u32(r), m->depth = get_u32(r);
    n->spans = get_u32(r), n->pieces = get_u32(r), n->links = get_u32(r);
    m->origin = get_vec3(r);
    uint64_t cells = (uint64_t)m->width * m->depth;
    if (!r->good || !(cell > 0.0f) || !near_by(m->origin)) {
        return bad("the head is cut off or holds no numbers");
    }
    if (!nav_mesh_check_desc(&m->desc)) {
        return false;
    }
    if (cells == 0 || cells * sizeof(uint16_t) > r->left || n->spans > r->left / 9 ||
        n->pieces > r->left / PIECE_HEAD || n->links > r->left / LINK_BYTES) {
        return bad("it counts more than there are bytes");
    }
    m->cell_size = m->desc.cell_size = cell; // not what an error wish would give
    m->tile_cells = m->desc.tile_cells ? m->desc.tile_cells : CORE_MAX(m->width, m->depth);
    return true;
}

// Which span of a cell is which is known once every tile has its block.
static bool place_spans(nav_mesh_data *m, uint32_t spans, const uint16_t *stack) {
    uint64_t sum = 0;
    for (size_t c = 0; c < (size_t)m->width * m->depth; c++) {
        sum += stack[c];
        if (stack[c] > MOST_STACK) {
            return bad("a cell has too many storeys");
        }
    }
    if (sum != spans) {
        return bad("its cells hold another number of spans than its head says");
    }
    for (uint32_t t = 0; t < m->tiles_x * m->tiles_z; t++) {
        uint32_t x0 = t % m->tiles_x * m->tile_cells, z0 = t / m->tiles_x * m->tile_cells;
        uint32_t x1 = CORE_MIN(x0 + m->tile_cells, m->width);
        uint32_t z1 = CORE_MIN(z0 + m->tile_cells, m->depth), count = 0;
        for (int pass = 0; pass < 2; pass++) {
            uint32_t at = m->tile[t].span.first;
            for (uint32_t z = z0; z < z1; z++) {
                for (uint32_t x = x0; x < x1; x++) {
                    uint32_t c = z * m->width + x;
                    count += pass ? 0 : stack[c];
                    for (uint32_t k = 0; pass && k < stack[c]; k++) {
                        m->span.x[at + k] = x, m->span.z[at + k] = z;
                    }
                    m->span.first[c] = at;
                    at += stack[c];
                }
            }
            if (pass == 0) {
                nav_mesh_take_spans(m, t, count);
            }
        }
    }
    memcpy(m->span.stack, stack, (size_t)m->width * m->depth * sizeof *stack);
    return true;
}

static bool get_spans(reader *r, nav_mesh_data *m) {
    static const int32_t dx[4] = {1, 0, -1, 0}, dz[4] = {0, 1, 0, -1};
    nav_spans *s = &m->span;
    for (size_t c = 0; c < (size_t)m->width * m->depth; c++) {
        for (uint32_t i = s->first[c]; i < s->first[c] + s->stack[c]; i++) {
            s->y[i] = get_float(r);
            s->area[i] = get_u8(r);
            for (int d = 0; d < 4; d++) {
                uint8_t step = get_u8(r);
                uint32_t x = s->x[i] + (uint32_t)dx[d], z = s->z[i] + (uint32_t)dz[d];
                bool inside = x < m->width && z < m->depth;
                if (step != NO_STEP && (!inside || step >= s->stack[z * m->width + x])) {
                    return bad("a step leads to no span");
                }
                s->link[i][d] = step == NO_STEP ? NAV_NONE : s->first[z * m->width + x] + step;
            }
            if (!(core_absf(s->y[i]) <= 1e6f) || s->area[i] >= NAV_AREAS) {
                return bad("a span has no height or area");
            }
        }
    }
    for (size_t c = 0; r->good && c < (size_t)m->width * m->depth; c++) {
        for (uint32_t i = s->first[c]; i < s->first[c] + s->stack[c]; i++) {
            for (uint32_t d = 0; d < 4; d++) {
                uint32_t t = s->link[i][d];
                if (t != NAV_NONE && s->link[t][(d + 2) % 4] != i) {
                    return bad("a step does not lead back");
                }
            }
        }
    }
    return r->good || bad("the spans are cut off");
}

static bool get_piece(reader *r, nav_mesh_data *m, uint64_t *last) {
    uint64_t key = get_u64(r);
    bool mark = get_u8(r) != 0;
    uint8_t area = get_u8(r);
    core_aabb box = {get_vec3(r), get_vec3(r)};
    uint32_t count = get_u32(r);
    if (!r->good || count > r->left / TRIANGLE || (m->piece_count && key <= *last) ||
        !near_by(box.min) || !near_by(box.max) || (area >= NAV_AREAS && area != NAV_AREA_CLOSED)) {
        return bad("a piece is cut off, out of order or without a place");
    }
    *last = key;
    nav_piece *p = nav_mesh_add_piece(m, key);
    p->mark = mark, p->area = area, p->box = box;
    p->count = mark ? 0 : count;
    nav_triangle *t = nav_buffer_fit(&p->triangles, ((size_t)count + 1) * sizeof *t);
    for (uint32_t k = 0; k < count; k++) {
        get(r, t[k].corner, sizeof t[k].corner);
        t[k].area = get_u8(r);
        bool known = t[k].area < NAV_AREAS || t[k].area == NAV_AREA_CLOSED;
        if (!known || !near_by(t[k].corner[0]) || !near_by(t[k].corner[1]) ||
            !near_by(t[k].corner[2])) {
            return bad("a triangle has no place or area");
        }
    }
    nav_piece_sort(p, m);
    return true;
}

static bool get_link(reader *r, nav_mesh_data *m) {
    nav_mesh_link_desc d = nav_mesh_link_desc_default();
    d.start = get_vec3(r), d.end = get_vec3(r);
    d.cost = get_float(r);
    d.user = get_u64(r);
    uint32_t kind = get_u32(r), bits = get_u32(r), exists = get_u32(r);
    if (!r->good || !near_by(d.start) || !near_by(d.end) || !(d.cost >= 0.0f && d.cost <= 1e9f) ||
        kind > NAV_LINK_DOOR) {
        return bad("a link is cut off or leads nowhere");
    }
    d.kind = (nav_link_kind)kind;
    d.both_ways = bits & 1u, d.closed = bits & 2u;
    nav_mesh_append_link(m, &d, exists != 0);
    return true;
}

static bool get_all(reader *r, nav_mesh_data *m) {
    counts n = {0};
    if (!get_head(r, m, &n)) {
        return false;
    }
    nav_mesh_lay_out(m);
    size_t bytes = (size_t)m->width * m->depth * sizeof(uint16_t);
    uint16_t *stack = core_alloc(bytes);
    get(r, stack, bytes);
    bool good = place_spans(m, n.spans, stack) && get_spans(r, m);
    core_free(stack);
    uint64_t last = 0;
    for (uint32_t i = 0; good && i < n.pieces; i++) {
        good = get_piece(r, m, &last);
    }
    for (uint32_t i = 0; good && i < n.links; i++) {
        good = get_link(r, m);
    }
    return good && (r->left == 0 || bad("something follows the last link"));
}

nav_mesh nav_mesh_load(nav_world *w, const void *data, size_t size) {
    reader r = {data, data ? size : 0, true};
    nav_mesh_data *m = core_alloc(sizeof *m);
    if (!get_all(&r, m)) {
        nav_mesh_free(m);
        return CORE_NULL_HANDLE;
    }
    for (uint32_t t = 0; t < m->tiles_x * m->tiles_z; t++) {
        m->tile[t].fresh = true;
    }
    nav_mesh mesh = nav_mesh_adopt(w, m);
    if (!core_handle_is_null(mesh)) {
        nav_mesh_settle(w, core_columns_row(&w->mesh.set, mesh));
    }
    return mesh;
}
