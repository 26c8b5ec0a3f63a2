// Tiles of a surface, made anew a few at a time. Drafts are made on all threads; they take their
// places in the surface one after another in the order of tiles, so threads do not matter, and a
// link between two tiles is set by the heights that both have, whichever was made first.
#include <string.h>

#include "core/hash.h"
#include "nav/nav_internal.h"

void nav_mesh_lay_out(nav_mesh_data *m) {
    size_t cells = (size_t)m->width * m->depth;
    m->tiles_x = (m->width + m->tile_cells - 1) / m->tile_cells;
    m->tiles_z = (m->depth + m->tile_cells - 1) / m->tile_cells;
    m->tile = core_alloc((size_t)m->tiles_x * m->tiles_z * sizeof *m->tile);
    m->span.first = core_alloc((cells + 1) * sizeof *m->span.first);
    m->span.stack = core_alloc((cells + 1) * sizeof *m->span.stack);
}

void nav_mesh_dirty(nav_mesh_data *m, nav_tiles r) {
    for (uint32_t z = r.z0; r.x0 <= r.x1 && z <= r.z1; z++) {
        for (uint32_t x = r.x0; x <= r.x1; x++) {
            nav_tile *t = &m->tile[z * m->tiles_x + x];
            m->dirty += !t->dirty;
            t->dirty = true;
        }
    }
}

// ---- spans ----

static void grow(void *array, size_t item, uint32_t old, uint32_t wanted) {
    void **at = array;
    *at = core_realloc(*at, old * item, wanted * item);
}

static void fit_span_arrays(nav_spans *sp) {
    if (sp->blocks.end <= sp->room) {
        return;
    }
    uint32_t wanted = CORE_MAX(sp->blocks.end, sp->room + sp->room / 4);
    grow(&sp->x, sizeof *sp->x, sp->room, wanted);
    grow(&sp->z, sizeof *sp->z, sp->room, wanted);
    grow(&sp->y, sizeof *sp->y, sp->room, wanted);
    grow(&sp->area, sizeof *sp->area, sp->room, wanted);
    grow(&sp->link, sizeof *sp->link, sp->room, wanted);
    grow(&sp->polygon, sizeof *sp->polygon, sp->room, wanted);
    sp->room = wanted;
}

static bool inside(nav_block b, uint32_t i) { return i - b.first < b.count; }

void nav_mesh_take_spans(nav_mesh_data *m, uint32_t tile, uint32_t count) {
    nav_spans *sp = &m->span;
    nav_block *own = &m->tile[tile].span;
    for (uint32_t s = own->first; s < own->first + own->count; s++) {
        sp->stack[sp->z[s] * m->width + sp->x[s]] = 0;
        for (uint32_t d = 0; d < 4; d++) {
            uint32_t t = sp->link[s][d];
            if (t != NAV_NONE && !inside(*own, t)) {
                sp->link[t][(d + 2) % 4] = NAV_NONE;
            }
        }
    }
    nav_block_fit(&sp->blocks, own, count, m->tiles_x * m->tiles_z > 1);
    fit_span_arrays(sp);
}

static void link_crossings(nav_mesh_data *m, uint32_t tile, const nav_draft *d) {
    static const int32_t step_x[4] = {1, 0, -1, 0}, step_z[4] = {0, 1, 0, -1};
    nav_spans *sp = &m->span;
    for (uint32_t i = 0; i < d->crossings; i++) {
        const nav_crossing *c = &d->crossing[i];
        uint32_t s = m->tile[tile].span.first + c->span, back = (c->direction + 2) % 4;
        uint32_t cell = (sp->z[s] + (uint32_t)step_z[c->direction]) * m->width + sp->x[s] +
                        (uint32_t)step_x[c->direction];
        for (uint32_t t = sp->first[cell]; t < sp->first[cell] + sp->stack[cell]; t++) {
            bool open = sp->link[s][c->direction] == NAV_NONE && sp->link[t][back] == NAV_NONE;
            if (open && sp->y[t] == c->y) {
                sp->link[s][c->direction] = t;
                sp->link[t][back] = s;
            }
        }
    }
}

// ---- rounds ----

typedef struct round {
    nav_world *world;
    nav_mesh_data *mesh;
    uint32_t tile[NAV_TILES_AT_ONCE], count;
} round;

static nav_builder *builder_of(nav_world *w) {
    if (!w->builder) {
        w->builder = core_alloc(sizeof *w->builder);
        w->builder->threads = (uint32_t)core_jobs_threads(w->jobs);
        w->builder->scratch = core_alloc(w->builder->threads * sizeof *w->builder->scratch);
    }
    return w->builder;
}

void nav_builder_release(nav_world *w) {
    nav_builder *b = w->builder;
    if (!b) {
        return;
    }
    for (uint32_t i = 0; i < NAV_TILES_AT_ONCE; i++) {
        nav_draft_release(&b->draft[i]);
    }
    for (uint32_t i = 0; i < b->threads; i++) {
        nav_field_release(&b->scratch[i].field);
        core_free(b->scratch[i].queue.data);
        core_free(b->scratch[i].seen.data);
    }
    core_free(b->scratch);
    core_free(b->edges.shape.data);
    core_free(b->edges.edge.data);
    core_free(b->edges.key.data);
    core_free(b->edges.table.data);
    core_free(b);
}

static void draft_some(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    round *r = ctx;
    nav_builder *b = r->world->builder;
    for (uint32_t i = begin; i < end; i++) {
        nav_draft_make(&b->draft[i], r->mesh, r->tile[i], &b->scratch[worker]);
    }
}
static void write_some(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk, (void)worker;
    round *r = ctx;
    for (uint32_t i = begin; i < end; i++) {
        nav_draft_write(&r->world->builder->draft[i], r->mesh, r->tile[i]);
    }
}

static bool make_spans(round *r) {
    nav_builder *b = builder_of(r->world);
    bool good = true;
    core_jobs_for(r->world->jobs, r->count, 1, draft_some, r);
    for (uint32_t i = 0; i < r->count; i++) {
        nav_mesh_take_spans(r->mesh, r->tile[i], b->draft[i].kept);
        good = good && b->draft[i].good;
    }
    core_jobs_for(r->world->jobs, r->count, 1, write_some, r);
    for (uint32_t i = 0; i < r->count; i++) {
        link_crossings(r->mesh, r->tile[i], &b->draft[i]);
    }
    return good;
}

// The next dirty tiles from `next` on, ascending and around, so that none waits for ever.
static void pick(round *r, uint32_t most) {
    nav_mesh_data *m = r->mesh;
    uint32_t tiles = m->tiles_x * m->tiles_z;
    r->count = 0;
    for (uint32_t i = 0; i < tiles && r->count < most && m->dirty; i++) {
        uint32_t t = (m->next + i) % tiles;
        if (m->tile[t].dirty) {
            m->tile[t].dirty = false;
            m->tile[t].fresh = true;
            m->dirty--;
            r->tile[r->count++] = t;
        }
    }
    m->next = r->count ? (r->tile[r->count - 1] + 1) % tiles : m->next;
}

bool nav_mesh_renew(nav_world *w, uint32_t row, uint32_t most) {
    round r = {.world = w, .mesh = w->mesh.data[row]};
    uint32_t left = most ? most : UINT32_MAX;
    bool good = true, any = r.mesh->dirty > 0;
    while (left && r.mesh->dirty) {
        pick(&r, CORE_MIN(left, NAV_TILES_AT_ONCE));
        good = make_spans(&r) && good;
        left -= r.count;
    }
    if (any) {
        nav_mesh_settle(w, row);
    }
    return good;
}

// ---- from spans to polygons ----

// Edges change with what lies beyond them and with the cells around their corners: in fresh tiles
// and those around.
static void mark_edges(nav_mesh_data *m, uint32_t tile) {
    uint32_t x = tile % m->tiles_x, z = tile / m->tiles_x;
    for (uint32_t nz = z ? z - 1 : 0; nz <= CORE_MIN(z + 1, m->tiles_z - 1); nz++) {
        for (uint32_t nx = x ? x - 1 : 0; nx <= CORE_MIN(x + 1, m->tiles_x - 1); nx++) {
            m->tile[nz * m->tiles_x + nx].edges = true;
        }
    }
}

// Independent of where in the arrays a tile's spans lie: links count as places in the next cell.
static uint64_t hash_tile(const nav_mesh_data *m, uint32_t tile) {
    const nav_spans *sp = &m->span;
    nav_block own = m->tile[tile].span;
    uint64_t hash = core_hash_mix(tile, own.count);
    for (uint32_t s = own.first; s < own.first + own.count; s++) {
        uint64_t cell = sp->z[s] * m->width + sp->x[s], links = sp->area[s];
        uint32_t y;
        memcpy(&y, &sp->y[s], sizeof y);
        for (int d = 0; d < 4; d++) {
            uint32_t t = sp->link[s][d];
            uint32_t place = t == NAV_NONE ? 0 : 1 + t - sp->first[sp->z[t] * m->width + sp->x[t]];
            links = links << 14 ^ place;
        }
        hash = core_hash_mix(core_hash_mix(hash, cell << 32 | y), links);
    }
    return hash;
}

void nav_mesh_settle(nav_world *w, uint32_t row) {
    nav_mesh_data *m = w->mesh.data[row];
    uint32_t tiles = m->tiles_x * m->tiles_z;
    nav_builder *b = builder_of(w);
    for (uint32_t t = 0; t < tiles; t++) {
        if (m->tile[t].fresh) {
            nav_mesh_cut_rectangles(m, t, &b->edges);
            mark_edges(m, t);
            m->tile[t].fresh = false;
        }
    }
    for (uint32_t t = 0; t < tiles; t++) {
        if (m->tile[t].edges) {
            nav_mesh_find_edges(m, t, &b->edges);
            w->mesh.head[row].content -= m->tile[t].hash; // a sum: any order of changes
            m->tile[t].hash = hash_tile(m, t);
            w->mesh.head[row].content += m->tile[t].hash;
            m->tile[t].edges = false;
        }
    }
    w->mesh.head[row].version++;
}
