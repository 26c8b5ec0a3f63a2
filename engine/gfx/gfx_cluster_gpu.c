// The gpu method of light assignment: count, sum, fill, all in cluster.comp.
#include "gfx/gfx_device_internal.h"

#include <string.h>

static void reserve(GLuint *buffer, size_t *bytes, size_t need) {
    if (need <= *bytes) {
        return;
    }
    glDeleteBuffers(1, buffer);
    *bytes = need + need / 2;
    glCreateBuffers(1, buffer);
    glNamedBufferStorage(*buffer, (GLsizeiptr)*bytes, NULL, 0);
}

static void upload_grid(gfx_device *d, const gfx_cluster_grid *g, const gfx_cluster_lights *l) {
    size_t bytes =
        sizeof(struct gfx_cluster_block) + l->count * sizeof(struct gfx_cluster_light_block);
    struct gfx_cluster_block *block = gfx_stream_begin(&d->cluster_grid, bytes, d->frame);
    struct gfx_cluster_light_block *light = (struct gfx_cluster_light_block *)(block + 1);
    *block = (struct gfx_cluster_block){
        .size = {g->columns, g->rows, g->slices, l->count},
        .lens = {g->tan_x, g->tan_y, g->orthographic ? 0.0f : 1.0f, 0.0f},
        .margin = {GFX_CLUSTER_TILE_MARGIN * 2.0f * g->tan_x / (float)g->columns,
                   GFX_CLUSTER_TILE_MARGIN * 2.0f * g->tan_y / (float)g->rows,
                   GFX_CLUSTER_SLICE_MARGIN, 0.5f * g->near_plane},
    };
    memcpy(block->depth, g->depth, (g->slices + 1) * sizeof(float));
    for (uint32_t i = 0; i < l->count; ++i) {
        const gfx_cluster_cone *c = &l->cone[i];
        light[i] = (struct gfx_cluster_light_block){
            .sphere = {l->x[i], l->y[i], l->depth[i], l->radius[i]},
            .apex = {c->apex[0], c->apex[1], c->apex[2], c->sine},
            .axis = {c->axis[0], c->axis[1], c->axis[2], c->cosine},
            .range = {c->range},
        };
    }
    gfx_stream_bind(&d->cluster_grid, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_CLUSTER_GRID, bytes,
                    d->frame);
}

static bool dispatch(gfx_device *d, uint32_t feature, uint32_t x, uint32_t y) {
    GLuint program = gfx_shaders_compute(&d->shaders, "cluster.comp", feature);
    if (!program) {
        return false;
    }
    glUseProgram(program);
    glDispatchCompute(x, y, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    return true;
}

bool gfx_clusters_assign_gpu(gfx_device *d, const gfx_cluster_grid *g, const gfx_cluster_lights *l,
                             uint32_t *refs) {
    gfx_cluster_gpu *c = &d->cluster_gpu;
    uint32_t per_slice = g->columns * g->rows, cells = per_slice * g->slices, total = 0;
    reserve(&c->offsets, &c->offset_bytes, (cells + 1) * sizeof total);
    reserve(&c->lists, &c->list_bytes, 1024);
    upload_grid(d, g, l);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GFX_SSBO_CLUSTER_OFFSETS, c->offsets);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GFX_SSBO_CLUSTER_LIGHTS, c->lists);
    if (!dispatch(d, GFX_FEATURE_COUNT_LISTS, per_slice, g->slices) ||
        !dispatch(d, GFX_FEATURE_SUM_LISTS, 1, 1)) {
        return false;
    }
    // The lists' room must be known before they are written; nothing is ever dropped.
    glGetNamedBufferSubData(c->offsets, (GLintptr)(cells * sizeof total), sizeof total, &total);
    reserve(&c->lists, &c->list_bytes, total * sizeof total);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GFX_SSBO_CLUSTER_LIGHTS, c->lists);
    *refs = total;
    return dispatch(d, GFX_FEATURE_FILL_LISTS, per_slice, g->slices);
}

void gfx_cluster_gpu_release(gfx_cluster_gpu *c) {
    glDeleteBuffers(1, &c->offsets);
    glDeleteBuffers(1, &c->lists);
    *c = (gfx_cluster_gpu){0};
}
