// The wide method: storage, slices as parallel jobs, lists put together.
#include "gfx/gfx_cluster_wide.h"

#include <string.h>

typedef struct wide_state { // lives in gfx_clusters.wide between calls
    gfx_cluster_wide kernel;
    float *columns; // of the packed lights
    size_t columns_bytes;
    gfx_cluster_records records[CORE_JOBS_MAX_THREADS];
    size_t record_bytes[CORE_JOBS_MAX_THREADS];
    void *record_block[CORE_JOBS_MAX_THREADS];
    gfx_cluster_slice slice[GFX_CLUSTER_SIDE];
    uint32_t *out; // final lists, while they are put together
    uint32_t start[GFX_CLUSTER_SIDE];
} wide_state;

static void set_kept(gfx_cluster_wide *w) {
    for (uint32_t mask = 0; mask < 256; ++mask) {
        uint32_t n = 0;
        for (uint8_t lane = 0; lane < 8; ++lane) {
            w->kept[mask][n] = lane;
            n += mask >> lane & 1u;
        }
    }
}

static void set_planes(gfx_cluster_planes *p, const float *bound, uint32_t count,
                       bool orthographic) {
    for (uint32_t i = 0; i < GFX_CLUSTER_SIDE + CORE_LANES; ++i) {
        float s = bound[CORE_MIN(i, count)];
        float inv = 1.0f / core_sqrtf(1.0f + s * s);
        p->ns[i] = orthographic ? 1.0f : inv;
        p->nd[i] = orthographic ? 0.0f : -s * inv;
        p->nc[i] = orthographic ? -s : 0.0f;
    }
}

static void set_strips(const gfx_cluster_grid *g, gfx_cluster_strips *columns,
                       gfx_cluster_strips *rows) {
    for (uint32_t i = 0; i < GFX_CLUSTER_SIDE + CORE_LANES; ++i) {
        gfx_cluster_cell_bounds b;
        gfx_cluster_cell_bounds_of(g, CORE_MIN(i, g->columns - 1), CORE_MIN(i, g->rows - 1), 0, &b);
        columns->lo[i] = b.x[0], columns->hi[i] = b.x[1];
        columns->mid[i] = 0.5f * (b.x[0] + b.x[1]);
        rows->lo[i] = b.y[0], rows->hi[i] = b.y[1];
        rows->mid[i] = 0.5f * (b.y[0] + b.y[1]);
    }
}

static void set_grid(gfx_cluster_wide *w, const gfx_cluster_grid *g) {
    w->grid = g;
    set_planes(&w->column, g->x, g->columns, g->orthographic);
    set_planes(&w->row, g->y, g->rows, g->orthographic);
    for (uint32_t k = 0; k < g->slices; ++k) {
        gfx_cluster_slice_bounds(g, k, &w->slice_lo[k], &w->slice_hi[k]);
    }
    set_strips(g, &w->columns, &w->rows);
    w->margin = GFX_CLUSTER_TILE_MARGIN;
    w->mid_x = 0.5f * (float)g->columns, w->mid_y = 0.5f * (float)g->rows;
    w->scale_x = w->mid_x / g->tan_x, w->scale_y = w->mid_y / g->tan_y;
}

static void set_packed(wide_state *s, uint32_t lights) {
    size_t n = ((size_t)lights + 2 * CORE_LANES) / CORE_LANES * CORE_LANES;
    size_t bytes = n * GFX_CLUSTER_PACKED_COLUMNS * sizeof(float) + CORE_ALIGN;
    if (bytes > s->columns_bytes) {
        core_free(s->columns);
        s->columns_bytes = bytes + bytes / 2;
        s->columns = core_alloc(s->columns_bytes);
    }
    float *columns = gfx_cluster_align(s->columns);
    gfx_cluster_packed *p = &s->kernel.packed;
    float **const column[GFX_CLUSTER_PACKED_COLUMNS - 1] = {
        &p->x,      &p->y,      &p->depth,    &p->radius,   &p->lo,       &p->hi,
        &p->inv_lo, &p->inv_hi, &p->slope[0], &p->slope[1], &p->slope[2], &p->slope[3],
        &p->at[0],  &p->at[1],  &p->at[2],    &p->at[3]};
    for (int i = 0; i < GFX_CLUSTER_PACKED_COLUMNS - 1; ++i) {
        *column[i] = columns + (size_t)i * n;
    }
    p->id = (uint32_t *)(void *)(columns + (GFX_CLUSTER_PACKED_COLUMNS - 1) * n);
}

static gfx_cluster_records *worker_records(wide_state *s, uint32_t worker) {
    const gfx_cluster_grid *g = s->kernel.grid;
    gfx_cluster_records *r = &s->records[worker];
    uint32_t lists = g->rows * ((g->columns + 15) / 16);
    // Masks of 16 records fill half a cache line: strides of 32 keep every list aligned.
    r->stride =
        ((size_t)s->kernel.packed.count + 2 * CORE_LANES) / (2 * CORE_LANES) * 2 * CORE_LANES;
    size_t bytes = lists * r->stride * (sizeof *r->id + sizeof *r->mask) + CORE_ALIGN;
    if (bytes > s->record_bytes[worker]) {
        core_free(s->record_block[worker]);
        s->record_bytes[worker] = bytes + bytes / 2;
        s->record_block[worker] = core_alloc(s->record_bytes[worker]);
    }
    r->id = gfx_cluster_align(s->record_block[worker]);
    r->mask = (uint16_t *)(void *)(r->id + lists * r->stride);
    memset(r->count, 0, lists * sizeof *r->count);
    return r;
}

static void slice_job(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    wide_state *s = ctx;
    (void)chunk;
    for (uint32_t i = begin; i < end; ++i) {
        uint32_t k = s->kernel.grid->slices - 1 - i; // the far ones, which hold most, come first
        gfx_cluster_records *r = worker_records(s, worker);
        gfx_cluster_slice *out = &s->slice[k];
        uint32_t pairs = CORE_SIMD_SELECT(gfx_cluster_record)(&s->kernel, k, r);
        size_t bytes =
            (pairs + CORE_LANES) * sizeof *out->light; // the last store may be a whole one
        if (bytes > out->bytes) {
            core_free(out->light);
            out->bytes = bytes + bytes / 2;
            out->light = core_alloc(out->bytes);
        }
        CORE_SIMD_SELECT(gfx_cluster_compact)(&s->kernel, r, out);
    }
}

static void gather_job(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    wide_state *s = ctx;
    (void)chunk, (void)worker;
    for (uint32_t k = begin; k < end; ++k) {
        if (s->slice[k].total) {
            memcpy(s->out + s->start[k], s->slice[k].light, s->slice[k].total * sizeof *s->out);
        }
    }
}

void gfx_clusters_assign_wide(gfx_clusters *c, const gfx_cluster_grid *g,
                              const gfx_cluster_lights *lights, core_jobs *jobs) {
    if (!c->wide) {
        c->wide = core_alloc(sizeof(wide_state));
        set_kept(&((wide_state *)c->wide)->kernel);
    }
    wide_state *s = c->wide;
    set_grid(&s->kernel, g);
    s->kernel.cone = lights->spots ? lights->cone : NULL;
    set_packed(s, lights->count);
    s->kernel.packed.count = CORE_SIMD_SELECT(gfx_cluster_pack)(&s->kernel, lights);
    core_jobs_for(jobs, g->slices, 1, slice_job, s);
    uint32_t per_slice = g->rows * g->columns, total = 0;
    gfx_clusters_reserve_offsets(c, g->slices * per_slice);
    for (uint32_t k = 0; k < g->slices; ++k) {
        s->start[k] = total;
        for (uint32_t i = 0; i < per_slice; ++i) {
            c->offset[k * per_slice + i + 1] = total + s->slice[k].end[i];
        }
        total += s->slice[k].total;
    }
    gfx_clusters_reserve_lights(c, total);
    s->out = c->light;
    core_jobs_for(jobs, g->slices, 1, gather_job, s);
}

void gfx_clusters_wide_release(gfx_clusters *c) {
    wide_state *s = c->wide;
    if (!s) {
        return;
    }
    for (int i = 0; i < CORE_JOBS_MAX_THREADS; ++i) {
        core_free(s->record_block[i]);
    }
    for (int k = 0; k < GFX_CLUSTER_SIDE; ++k) {
        core_free(s->slice[k].light);
    }
    core_free(s->columns);
    core_free(s);
    c->wide = NULL;
}
