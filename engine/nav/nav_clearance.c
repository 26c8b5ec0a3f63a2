// From triangles to places to stand, second half: tops of columns with headroom become spans, spans
// that one step joins are linked, and those nearer to a border than the agent's radius are dropped.
#include "nav/nav_field.h"

typedef struct draft {
    const nav_field *field;
    const nav_mesh_desc *desc;
    nav_spans span;
    float *ceiling; // [count] m
    uint8_t *drop;  // [count]
} draft;

static const int32_t step_x[4] = {1, 0, -1, 0}, step_z[4] = {0, 1, 0, -1};

// Tops that are level enough and have room above. Counts only when `write` is false.
static uint32_t collect(draft *d, bool write) {
    const nav_field *f = d->field;
    uint32_t n = 0;
    for (uint32_t cell = 0; cell < f->width * f->depth; cell++) {
        if (write) {
            d->span.cell[cell] = n;
        }
        for (uint32_t i = f->first[cell]; i < f->first[cell + 1]; i++) {
            float ceiling = i + 1 < f->first[cell + 1] ? f->solid[i + 1].low : __FLT_MAX__;
            if (!f->solid[i].walkable || ceiling - f->solid[i].stand < d->desc->agent_height) {
                continue;
            }
            if (write) {
                d->span.x[n] = cell % f->width, d->span.z[n] = cell / f->width;
                d->span.y[n] = f->solid[i].stand;
                d->ceiling[n] = ceiling;
            }
            n++;
        }
    }
    if (write) {
        d->span.cell[f->width * f->depth] = n;
    }
    return n;
}

// The span of the next cell that one step reaches with headroom on the way; of several the nearest
// in height.
static uint32_t step_to(const draft *d, uint32_t s, int direction) {
    const nav_spans *sp = &d->span;
    uint32_t x = sp->x[s] + (uint32_t)step_x[direction], z = sp->z[s] + (uint32_t)step_z[direction];
    if (x >= sp->width || z >= sp->depth) {
        return NAV_NONE;
    }
    size_t cell = (size_t)z * sp->width + x;
    uint32_t best = NAV_NONE;
    float least = d->desc->max_climb;
    for (uint32_t t = sp->cell[cell]; t < sp->cell[cell + 1]; t++) {
        float rise = core_absf(sp->y[t] - sp->y[s]);
        float room = CORE_MIN(d->ceiling[s], d->ceiling[t]) - CORE_MAX(sp->y[s], sp->y[t]);
        if (rise <= least && room >= d->desc->agent_height) {
            least = rise;
            best = t;
        }
    }
    return best;
}

static void link_spans(draft *d) {
    nav_spans *sp = &d->span;
    for (uint32_t s = 0; s < sp->count; s++) {
        for (int k = 0; k < 4; k++) {
            sp->link[s][k] = step_to(d, s, k);
        }
    }
    for (uint32_t s = 0; s < sp->count; s++) { // only where both sides agree
        for (int k = 0; k < 4; k++) {
            uint32_t t = sp->link[s][k];
            if (t != NAV_NONE && step_to(d, t, (k + 2) % 4) != s) {
                sp->link[s][k] = NAV_NONE;
            }
        }
    }
}

// ---- clearance ----

typedef struct flood {
    uint32_t *queue; // spans
    uint32_t *seen;  // [count] number of the flood that saw a span
    uint32_t number;
} flood;

// Distance between two cells as squares, in cells, squared.
static double gap_square(uint32_t x, uint32_t z, int64_t ox, int64_t oz) {
    int64_t dx = (int64_t)x > ox ? (int64_t)x - ox : ox - (int64_t)x;
    int64_t dz = (int64_t)z > oz ? (int64_t)z - oz : oz - (int64_t)z;
    double gx = dx > 1 ? (double)(dx - 1) : 0.0, gz = dz > 1 ? (double)(dz - 1) : 0.0;
    return gx * gx + gz * gz;
}

// Drops what lies nearer than the radius to the closed cell (ox, oz), as far as one can walk there
// from span s beside it: a wall on another storey is none of its business.
static void drop_around(draft *d, flood *f, uint32_t s, int64_t ox, int64_t oz) {
    const nav_spans *sp = &d->span;
    double radius = (double)d->desc->agent_radius / (double)d->field->cell_size;
    uint32_t head = 0, tail = 0;
    f->number++;
    f->queue[tail++] = s;
    f->seen[s] = f->number;
    while (head < tail) {
        uint32_t at = f->queue[head++];
        d->drop[at] = 1;
        for (int k = 0; k < 4; k++) {
            uint32_t next = sp->link[at][k];
            if (next != NAV_NONE && f->seen[next] != f->number &&
                gap_square(sp->x[next], sp->z[next], ox, oz) < radius * radius - 1e-9) {
                f->seen[next] = f->number;
                f->queue[tail++] = next;
            }
        }
    }
}

static void drop_near_borders(draft *d) {
    const nav_spans *sp = &d->span;
    flood f = {.queue = core_alloc((sp->count + 1) * sizeof *f.queue),
               .seen = core_alloc((sp->count + 1) * sizeof *f.seen)};
    for (uint32_t s = 0; s < sp->count; s++) {
        int64_t x = sp->x[s], z = sp->z[s];
        for (int k = 0; k < 4; k++) {
            int next = (k + 1) % 4;
            uint32_t a = sp->link[s][k], b = sp->link[s][next];
            if (a == NAV_NONE) {
                drop_around(d, &f, s, x + step_x[k], z + step_z[k]);
            } else if (b != NAV_NONE &&
                       (sp->link[a][next] == NAV_NONE || sp->link[b][k] == NAV_NONE)) {
                drop_around(d, &f, s, x + step_x[k] + step_x[next], z + step_z[k] + step_z[next]);
            }
        }
    }
    core_free(f.queue);
    core_free(f.seen);
}

// What is left, numbered anew in the same order.
static void keep(const draft *d, nav_spans *out) {
    const nav_spans *sp = &d->span;
    uint32_t *number = core_alloc((sp->count + 1) * sizeof *number), n = 0;
    for (uint32_t s = 0; s < sp->count; s++) {
        number[s] = d->drop[s] ? NAV_NONE : n++;
    }
    nav_spans_make(out, sp->width, sp->depth, n);
    uint32_t s = 0, kept = 0;
    for (uint32_t cell = 0; cell < sp->width * sp->depth; cell++) {
        out->cell[cell] = kept;
        for (; s < sp->cell[cell + 1]; s++) {
            if (d->drop[s]) {
                continue;
            }
            out->x[kept] = sp->x[s], out->z[kept] = sp->z[s], out->y[kept] = sp->y[s];
            for (int k = 0; k < 4; k++) {
                uint32_t t = sp->link[s][k];
                out->link[kept][k] = t == NAV_NONE ? NAV_NONE : number[t];
            }
            kept++;
        }
    }
    out->cell[sp->width * sp->depth] = kept;
    core_free(number);
}

void nav_field_spans(const nav_field *field, const nav_mesh_desc *desc, nav_spans *out) {
    draft d = {.field = field, .desc = desc};
    uint32_t count = collect(&d, false);
    nav_spans_make(&d.span, field->width, field->depth, count);
    d.ceiling = core_alloc((count + 1) * sizeof *d.ceiling);
    d.drop = core_alloc(count + 1);
    collect(&d, true);
    link_spans(&d);
    if (desc->agent_radius > 0.0f) {
        drop_near_borders(&d);
    }
    keep(&d, out);
    nav_spans_release(&d.span);
    core_free(d.ceiling);
    core_free(d.drop);
}
