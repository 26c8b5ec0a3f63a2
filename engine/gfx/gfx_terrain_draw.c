// Terrain on the GPU: heights and normals as textures, one instanced draw a view and terrain.
#include "gfx/gfx_device_internal.h"
#include "gfx/gfx_terrain.h"

#include "core/hash.h"

#include <string.h>

enum { TILE = GFX_TERRAIN_TILE, INDICES = TILE * TILE * 6 };

// ---- textures ----

static void free_entries(gfx_terrain_gpu *g) {
    gfx_terrain_maps *m = g->maps.data;
    for (size_t i = 0; i < g->maps.count; ++i) {
        glDeleteTextures(2, m[i].texture);
    }
    g->maps.count = 0;
}

void gfx_terrain_gpu_release(gfx_terrain_gpu *g) {
    free_entries(g);
    glDeleteVertexArrays(1, &g->grid);
    glDeleteBuffers(1, &g->index);
    gfx_stream_release(&g->tile_stream);
    gfx_stream_release(&g->block);
    gfx_growing *const arrays[] = {&g->maps, &g->levels, &g->tiles, &g->runs};
    for (size_t i = 0; i < CORE_COUNT_OF(arrays); ++i) {
        gfx_growing_release(arrays[i]);
    }
    *g = (gfx_terrain_gpu){0};
}

static int16_t snorm16(float x) { return (int16_t)(x * 32767.0f + (x < 0.0f ? -0.5f : 0.5f)); }

// By central differences, one-sided at the border.
static void write_normals(const core_heights_data *h, int16_t *out) {
    for (uint32_t z = 0; z < h->rows; ++z) {
        uint32_t up = z > 0 ? z - 1 : 0, down = CORE_MIN(z + 1, h->rows - 1);
        for (uint32_t x = 0; x < h->columns; ++x, out += 2) {
            uint32_t left = x > 0 ? x - 1 : 0, right = CORE_MIN(x + 1, h->columns - 1);
            const float *row = h->height + (size_t)z * h->columns;
            float dx = (row[right] - row[left]) / ((float)(right - left) * h->step_x);
            float dz = (h->height[(size_t)down * h->columns + x] -
                        h->height[(size_t)up * h->columns + x]) /
                       ((float)(down - up) * h->step_z);
            float length = core_sqrtf(dx * dx + 1.0f + dz * dz);
            out[0] = snorm16(-dx / length), out[1] = snorm16(-dz / length);
        }
    }
}

static void make_maps(gfx_terrain_maps *m, const gfx_terrain_store *t) {
    const core_heights_data *h = &t->desc.heights;
    GLsizei w = (GLsizei)h->columns, n = (GLsizei)h->rows;
    int levels = 1;
    while ((w | n) >> levels) {
        levels++;
    }
    int16_t *normals = core_alloc((size_t)h->columns * h->rows * 2 * sizeof *normals);
    write_normals(h, normals);
    glCreateTextures(GL_TEXTURE_2D, 2, m->texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureStorage2D(m->texture[0], 1, GL_R32F, w, n);
    glTextureSubImage2D(m->texture[0], 0, 0, 0, w, n, GL_RED, GL_FLOAT, h->height);
    glTextureParameteri(m->texture[0], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureStorage2D(m->texture[1], levels, GL_RG16_SNORM, w, n);
    glTextureSubImage2D(m->texture[1], 0, 0, 0, w, n, GL_RG, GL_SHORT, normals);
    glGenerateTextureMipmap(m->texture[1]);
    glTextureParameteri(m->texture[1], GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(m->texture[1], GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(m->texture[1], GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    core_free(normals);
}

static void make_grid(gfx_terrain_gpu *g) {
    uint16_t index[INDICES], *at = index;
    for (int z = 0; z < TILE; ++z) {
        for (int x = 0; x < TILE; ++x, at += 6) {
            uint16_t a = (uint16_t)(z * (TILE + 1) + x), c = (uint16_t)(a + TILE + 1);
            const uint16_t quad[6] = {
                a, c, (uint16_t)(c + 1), a, (uint16_t)(c + 1), (uint16_t)(a + 1)};
            memcpy(at, quad, sizeof quad);
        }
    }
    glCreateBuffers(1, &g->index);
    glNamedBufferStorage(g->index, sizeof index, index, 0);
    glCreateVertexArrays(1, &g->grid);
    glVertexArrayElementBuffer(g->grid, g->index);
}

static void update(gfx_terrain_gpu *g, const gfx_world *world) {
    const gfx_terrains *all = world->terrains;
    if (g->world == world->id && g->version == all->version) {
        return;
    }
    free_entries(g);
    uint32_t count = core_columns_count(&all->rows.set);
    gfx_terrain_maps *m = gfx_grow(&g->maps, sizeof *m, count);
    for (uint32_t i = 0; i < count; ++i) {
        make_maps(&m[i], &all->rows.store[i]);
    }
    if (!g->grid) {
        make_grid(g);
    }
    g->world = world->id, g->version = all->version;
}

// ---- a frame ----

bool gfx_terrains_wanted(const gfx_world *world) {
    return world->terrains && core_columns_count(&world->terrains->rows.set) > 0;
}

void gfx_terrains_begin(gfx_device *d, const gfx_world *world, const gfx_view *view) {
    gfx_terrain_gpu *g = &d->terrain;
    g->tiles.count = g->runs.count = g->levels.count = 0;
    if (!gfx_terrains_wanted(world)) {
        return;
    }
    update(g, world);
    uint32_t count = core_columns_count(&world->terrains->rows.set);
    gfx_terrain_levels *levels = gfx_grow(&g->levels, sizeof *levels, count);
    float error = world->settings.levels ? world->settings.terrain_error : 0.0f;
    for (uint32_t i = 0; i < count; ++i) {
        gfx_terrain_choose(&world->terrains->rows.store[i], view, (float)d->height, error,
                           &levels[i]);
    }
    // Shadow maps must hold the surface that receives them.
    d->levels_hash = core_hash(levels, count * sizeof *levels, d->levels_hash);
}

void gfx_terrains_add_view(gfx_device *d, const gfx_world *world, const gfx_view *view,
                           gfx_terrain_list *list) {
    gfx_terrain_gpu *g = &d->terrain;
    *list = (gfx_terrain_list){.first = (uint32_t)g->runs.count};
    for (uint32_t i = 0; i < (uint32_t)g->levels.count; ++i) {
        gfx_terrain_run run = {.terrain = i, .first = (uint32_t)g->tiles.count};
        run.count =
            gfx_terrain_select(&world->terrains->rows.store[i],
                               (const gfx_terrain_levels *)g->levels.data + i, view, &g->tiles);
        *(gfx_terrain_run *)gfx_grow(&g->runs, sizeof run, 1) = run;
        list->count++;
        list->triangles += run.count * TILE * TILE * 2;
    }
}

static float over(float from, float to) { return to > from ? 1.0f / (to - from) : 1e6f; }

static void write_block(const gfx_terrain_store *t, const gfx_terrain_levels *l,
                        struct gfx_terrain_block *out) {
    const gfx_terrain_desc *d = &t->desc;
    const core_heights_data *h = &d->heights;
    *out = (struct gfx_terrain_block){
        .origin = {h->origin.x, h->origin.y, h->origin.z, t->image[0] ? 1.0f : 0.0f},
        .eye = {l->eye.x, l->eye.y, l->eye.z, 0.0f},
        .grid = {h->step_x, h->step_z, (float)(h->columns - 1), (float)(h->rows - 1)},
        .low = {d->low[0], d->low[1], d->low[2], d->roughness},
        .high = {d->high[0], d->high[1], d->high[2]},
        .steep = {d->steep[0], d->steep[1], d->steep[2]},
        .blend = {d->heights_blend[0], over(d->heights_blend[0], d->heights_blend[1]),
                  d->slopes_blend[0], over(d->slopes_blend[0], d->slopes_blend[1])},
    };
    for (uint32_t i = 0; i < GFX_TERRAIN_LEVELS; ++i) {
        out->morph[i][0] = l->start[i];
        out->morph[i][1] = 1.0f / CORE_MAX(l->end[i] - l->start[i], 1e-6f);
    }
}

enum { BLOCK_STRIDE = (sizeof(struct gfx_terrain_block) + 255) / 256 * 256 };

void gfx_terrains_upload(gfx_device *d, const gfx_world *world) {
    gfx_terrain_gpu *g = &d->terrain;
    if (g->levels.count == 0) {
        return;
    }
    size_t bytes = g->tiles.count * sizeof(gfx_tile);
    void *tiles = gfx_stream_begin(&g->tile_stream, bytes, d->frame);
    if (bytes) {
        memcpy(tiles, g->tiles.data, bytes);
    }
    uint8_t *blocks = gfx_stream_begin(&g->block, g->levels.count * BLOCK_STRIDE, d->frame);
    for (size_t i = 0; i < g->levels.count; ++i) {
        write_block(&world->terrains->rows.store[i], (const gfx_terrain_levels *)g->levels.data + i,
                    (struct gfx_terrain_block *)(void *)(blocks + i * BLOCK_STRIDE));
    }
}

static void bind_terrain(gfx_device *d, const gfx_world *world, uint32_t i) {
    gfx_terrain_gpu *g = &d->terrain;
    const gfx_terrain_maps *m = (const gfx_terrain_maps *)g->maps.data + i;
    const char *image = world->terrains->rows.store[i].image;
    glBindBufferRange(GL_UNIFORM_BUFFER, GFX_UBO_TERRAIN, g->block.name,
                      (GLintptr)(g->block.segment * d->frame + i * BLOCK_STRIDE),
                      sizeof(struct gfx_terrain_block));
    glBindTextureUnit(GFX_TEX_TERRAIN_HEIGHT, m->texture[0]);
    glBindTextureUnit(GFX_TEX_TERRAIN_NORMAL, m->texture[1]);
    const gfx_texture *t = image[0] ? gfx_texture_get(d, image, true) : NULL;
    glBindTextureUnit(GFX_TEX_TERRAIN_IMAGE, t ? t->name : 0);
}

bool gfx_terrains_submit(gfx_device *d, gfx_world *world, const gfx_terrain_list *list,
                         const char *fragment, uint32_t features) {
    gfx_terrain_gpu *g = &d->terrain;
    if (list->triangles == 0) {
        return true;
    }
    features |= features & GFX_FEATURE_DEPTH_ONLY ? 0 : GFX_FEATURE_TERRAIN;
    GLuint program = gfx_shaders_get(&d->shaders, "terrain.vert", fragment, features);
    if (!program) {
        return false;
    }
    glUseProgram(program);
    glBindVertexArray(g->grid);
    gfx_stream_bind(&g->tile_stream, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_QUADS,
                    g->tiles.count * sizeof(gfx_tile), d->frame);
    for (uint32_t i = list->first; i < list->first + list->count; ++i) {
        const gfx_terrain_run *run = (const gfx_terrain_run *)g->runs.data + i;
        if (run->count) {
            bind_terrain(d, world, run->terrain);
            glUniform1ui(GFX_U_INSTANCE, run->first);
            glDrawElementsInstanced(GL_TRIANGLES, INDICES, GL_UNSIGNED_SHORT, NULL,
                                    (GLsizei)run->count);
            world->stats.draws++;
        }
    }
    return true;
}
