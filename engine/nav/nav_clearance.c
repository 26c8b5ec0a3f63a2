// From triangles to places to stand, second half: tops of columns with headroom become spans, spans
// that one step joins are linked, and those nearer to a border than the agent's radius are dropped.
// A tile is looked at with a margin as wide as borders reach, so that what is kept of it does not
// depend on where tiles end.
#include <string.h>

#include "nav/nav_internal.h"

typedef struct work {
    const nav_mesh_data *mesh;
    const nav_field *field;
    nav_draft *d;
    nav_tile_scratch *scratch;
} work;

static const int32_t step_x[4] = {1, 0, -1, 0}, step_z[4] = {0, 1, 0, -1};

// ---- places ----

static void fit_spans(nav_draft *d, uint32_t count) {
    size_t n = (size_t)count + 1;
    uint8_t *at = nav_buffer_fit(&d->spans, n * (9 * sizeof(uint32_t) + 2));
    d->link = (uint32_t(*)[4])at, at += n * sizeof *d->link;
    d->x = (uint32_t *)at, at += n * sizeof *d->x;
    d->z = (uint32_t *)at, at += n * sizeof *d->z;
    d->number = (uint32_t *)at, at += n * sizeof *d->number;
    d->y = (float *)at, at += n * sizeof *d->y;
    d->ceiling = (float *)at, at += n * sizeof *d->ceiling;
    d->area = at, at += n;
    d->drop = at;
}

// Area of a place: that of the last mark it lies in, or of the ground.
static uint8_t area_at(const work *k, uint32_t x, uint32_t z, float y, uint8_t ground) {
    const nav_mesh_data *m = k->mesh;
    float px = m->origin.x + ((float)(k->d->window.x + x) + 0.5f) * m->cell_size;
    float pz = m->origin.z + ((float)(k->d->window.z + z) + 0.5f) * m->cell_size;
    uint8_t area = ground;
    for (uint32_t i = 0; i < m->piece_count; i++) {
        const nav_piece *p = m->piece[i];
        if (p->mark && px >= p->box.min.x && px <= p->box.max.x && pz >= p->box.min.z &&
            pz <= p->box.max.z && y >= p->box.min.y && y <= p->box.max.y) {
            area = p->area;
        }
    }
    return area;
}

static bool has_marks(const nav_mesh_data *m) {
    for (uint32_t i = 0; i < m->piece_count; i++) {
        if (m->piece[i]->mark) {
            return true;
        }
    }
    return false;
}

// Tops that are level enough, have room above and are not closed by a mark.
static void collect(work *k) {
    const nav_field *f = k->field;
    nav_draft *d = k->d;
    uint32_t cells = d->window.width * d->window.depth;
    bool marks = has_marks(k->mesh);
    d->cell = nav_buffer_fit(&d->cells, ((size_t)cells + 1) * sizeof *d->cell);
    fit_spans(d, f->first[cells]);
    d->count = 0;
    for (uint32_t cell = 0; cell < cells; cell++) {
        d->cell[cell] = d->count;
        uint32_t x = cell % d->window.width, z = cell / d->window.width;
        for (uint32_t i = f->first[cell]; i < f->first[cell + 1]; i++) {
            const nav_solid *top = &f->solid[i];
            float ceiling = i + 1 < f->first[cell + 1] ? top[1].low : __FLT_MAX__;
            bool many = d->count - d->cell[cell] >= UINT16_MAX;
            if (!top->walkable || many || ceiling - top->stand < k->mesh->desc.agent_height) {
                continue;
            }
            uint8_t area = marks ? area_at(k, x, z, top->stand, top->area) : top->area;
            if (area == NAV_AREA_CLOSED) {
                continue;
            }
            uint32_t n = d->count++;
            d->x[n] = x, d->z[n] = z, d->y[n] = top->stand;
            d->ceiling[n] = ceiling;
            d->area[n] = area;
            d->drop[n] = 0;
        }
    }
    d->cell[cells] = d->count;
}

// The span of the next cell that one step reaches with headroom on the way; of several the nearest
// in height.
static uint32_t step_to(const work *k, uint32_t s, int direction) {
    const nav_draft *d = k->d;
    uint32_t x = d->x[s] + (uint32_t)step_x[direction], z = d->z[s] + (uint32_t)step_z[direction];
    if (x >= d->window.width || z >= d->window.depth) {
        return NAV_NONE;
    }
    size_t cell = (size_t)z * d->window.width + x;
    uint32_t best = NAV_NONE;
    float least = k->mesh->desc.max_climb;
    for (uint32_t t = d->cell[cell]; t < d->cell[cell + 1]; t++) {
        float rise = core_absf(d->y[t] - d->y[s]);
        float room = CORE_MIN(d->ceiling[s], d->ceiling[t]) - CORE_MAX(d->y[s], d->y[t]);
        if (rise <= least && room >= k->mesh->desc.agent_height) {
            least = rise;
            best = t;
        }
    }
    return best;
}

static void link_spans(work *k) {
    nav_draft *d = k->d;
    for (uint32_t s = 0; s < d->count; s++) {
        for (int dir = 0; dir < 4; dir++) {
            d->link[s][dir] = step_to(k, s, dir);
        }
    }
    for (uint32_t s = 0; s < d->count; s++) { // only where both sides agree
        for (int dir = 0; dir < 4; dir++) {
            uint32_t t = d->link[s][dir];
            if (t != NAV_NONE && step_to(k, t, (dir + 2) % 4) != s) {
                d->link[s][dir] = NAV_NONE;
            }
        }
    }
}

// ---- clearance ----

// Distance between two cells as squares, in cells, squared.
static double gap_square(uint32_t x, uint32_t z, int64_t ox, int64_t oz) {
    int64_t dx = (int64_t)x > ox ? (int64_t)x - ox : ox - (int64_t)x;
    int64_t dz = (int64_t)z > oz ? (int64_t)z - oz : oz - (int64_t)z;
    double gx = dx > 1 ? (double)(dx - 1) : 0.0, gz = dz > 1 ? (double)(dz - 1) : 0.0;
    return gx * gx + gz * gz;
}

// Drops what lies nearer than the radius to the closed cell (ox, oz), as far as one can walk there
// from span s beside it: a wall on another storey is none of its business.
static void drop_around(work *k, uint32_t s, int64_t ox, int64_t oz) {
    nav_draft *d = k->d;
    double radius = (double)k->mesh->desc.agent_radius / (double)k->mesh->cell_size;
    uint32_t *queue = k->scratch->queue.data, *seen = k->scratch->seen.data;
    uint32_t head = 0, tail = 0, flood = ++k->scratch->flood;
    queue[tail++] = s;
    seen[s] = flood;
    while (head < tail) {
        uint32_t at = queue[head++];
        d->drop[at] = 1;
        for (int dir = 0; dir < 4; dir++) {
            uint32_t next = d->link[at][dir];
            if (next != NAV_NONE && seen[next] != flood &&
                gap_square(d->x[next], d->z[next], ox, oz) < radius * radius - 1e-9) {
                seen[next] = flood;
                queue[tail++] = next;
            }
        }
    }
}

static void drop_near_borders(work *k) {
    nav_draft *d = k->d;
    size_t bytes = ((size_t)d->count + 1) * sizeof(uint32_t);
    nav_buffer_fit(&k->scratch->queue, bytes);
    memset(nav_buffer_fit(&k->scratch->seen, bytes), 0, bytes);
    k->scratch->flood = 0;
    for (uint32_t s = 0; s < d->count; s++) {
        int64_t x = d->x[s], z = d->z[s];
        for (int dir = 0; dir < 4; dir++) {
            int next = (dir + 1) % 4;
            uint32_t a = d->link[s][dir], b = d->link[s][next];
            if (a == NAV_NONE) {
                drop_around(k, s, x + step_x[dir], z + step_z[dir]);
            } else if (b != NAV_NONE &&
                       (d->link[a][next] == NAV_NONE || d->link[b][dir] == NAV_NONE)) {
                drop_around(k, s, x + step_x[dir] + step_x[next], z + step_z[dir] + step_z[next]);
            }
        }
    }
}

// ---- the tile itself ----

static bool in_core(const nav_draft *d, uint32_t s) {
    uint32_t x = d->window.x + d->x[s] - d->core.x, z = d->window.z + d->z[s] - d->core.z;
    return x < d->core.width && z < d->core.depth;
}

// Numbers what is kept of the tile, and notes links that leave it.
static void number_spans(nav_draft *d) {
    d->kept = d->crossings = 0;
    for (uint32_t s = 0; s < d->count; s++) {
        d->number[s] = d->drop[s] || !in_core(d, s) ? NAV_NONE : d->kept++;
    }
    for (uint32_t s = 0; s < d->count; s++) {
        for (uint32_t dir = 0; dir < 4 && d->number[s] != NAV_NONE; dir++) {
            uint32_t t = d->link[s][dir];
            if (t != NAV_NONE && !in_core(d, t)) {
                d->crossing = nav_buffer_fit(&d->crossing_buffer,
                                             ((size_t)d->crossings + 1) * sizeof *d->crossing);
                d->crossing[d->crossings++] = (nav_crossing){d->number[s], dir, d->y[t]};
            }
        }
    }
}

static nav_window core_of(const nav_mesh_data *m, uint32_t tile) {
    uint32_t x = tile % m->tiles_x * m->tile_cells, z = tile / m->tiles_x * m->tile_cells;
    return (nav_window){x, z, CORE_MIN(m->tile_cells, m->width - x),
                        CORE_MIN(m->tile_cells, m->depth - z)};
}

static nav_window with_margin(const nav_mesh_data *m, nav_window core) {
    uint32_t margin = nav_mesh_margin(m);
    uint32_t x = core.x > margin ? core.x - margin : 0, z = core.z > margin ? core.z - margin : 0;
    uint32_t x1 = CORE_MIN(core.x + core.width + margin, m->width);
    uint32_t z1 = CORE_MIN(core.z + core.depth + margin, m->depth);
    return (nav_window){x, z, x1 - x, z1 - z};
}

void nav_draft_make(nav_draft *d, const nav_mesh_data *m, uint32_t tile,
                    nav_tile_scratch *scratch) {
    work k = {m, &scratch->field, d, scratch};
    d->core = core_of(m, tile);
    d->window = with_margin(m, d->core);
    nav_field_begin(&scratch->field, m, d->window);
    d->good = nav_pieces_fill(m, tile, &scratch->field);
    nav_field_finish(&scratch->field);
    collect(&k);
    link_spans(&k);
    if (m->desc.agent_radius > 0.0f) {
        drop_near_borders(&k);
    }
    number_spans(d);
}

void nav_draft_write(nav_draft *d, nav_mesh_data *m, uint32_t tile) {
    nav_spans *sp = &m->span;
    uint32_t base = m->tile[tile].span.first;
    for (uint32_t s = 0; s < d->count; s++) {
        uint32_t n = d->number[s];
        if (n == NAV_NONE) {
            continue;
        }
        n += base;
        sp->x[n] = d->window.x + d->x[s], sp->z[n] = d->window.z + d->z[s];
        sp->y[n] = d->y[s], sp->area[n] = d->area[s];
        for (int dir = 0; dir < 4; dir++) {
            uint32_t t = d->link[s][dir];
            bool inside = t != NAV_NONE && d->number[t] != NAV_NONE;
            sp->link[n][dir] = inside ? base + d->number[t] : NAV_NONE;
        }
        uint32_t cell = sp->z[n] * m->width + sp->x[n];
        sp->first[cell] = sp->stack[cell] ? sp->first[cell] : n;
        sp->stack[cell]++;
    }
}

void nav_draft_release(nav_draft *d) {
    core_free(d->cells.data);
    core_free(d->spans.data);
    core_free(d->crossing_buffer.data);
}
