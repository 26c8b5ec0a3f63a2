// Draw lists: the visible instances of each view of a frame, sorted by state and merged into
// instanced commands. Views share one upload of instances; each has its own list of their rows.
#include "gfx/gfx_device_internal.h"

#include <string.h>

// LSD radix sort on bytes; passes whose byte is the same everywhere are skipped.
void gfx_sort_keys(gfx_sort_key *keys, gfx_sort_key *scratch, uint32_t count) {
    uint64_t all = 0, any = ~0ull;
    for (uint32_t i = 0; i < count; ++i) {
        all |= keys[i].key;
        any &= keys[i].key;
    }
    gfx_sort_key *from = keys, *to = scratch;
    for (int shift = 0; shift < 64; shift += 8) {
        if (((all ^ any) >> shift & 0xff) == 0) {
            continue;
        }
        uint32_t start[256] = {0};
        for (uint32_t i = 0; i < count; ++i) {
            start[from[i].key >> shift & 0xff]++;
        }
        for (uint32_t i = 0, sum = 0; i < 256; ++i) {
            uint32_t n = start[i];
            start[i] = sum;
            sum += n;
        }
        for (uint32_t i = 0; i < count; ++i) {
            to[start[from[i].key >> shift & 0xff]++] = from[i];
        }
        gfx_sort_key *swap = from;
        from = to, to = swap;
    }
    if (from != keys) {
        memcpy(keys, from, count * sizeof *keys);
    }
}

// Key: program features 16 | mesh 24 | unused; instances of a mesh keep the order of their rows.
static uint64_t sort_key(uint32_t features, uint32_t mesh) {
    return (uint64_t)features << 48 | (uint64_t)(mesh & 0xffffffu) << 24;
}

static const gfx_mesh_place *place_of(const gfx_geometry *g, gfx_mesh mesh) {
    if (mesh.index >= g->places || g->place[mesh.index].generation != mesh.generation) {
        return NULL; // destroyed
    }
    return &g->place[mesh.index];
}

void gfx_draws_begin(gfx_device *d) { d->rows.count = d->commands.count = d->batches.count = 0; }

// Keys of the rows that are in the view and have a mesh.
static uint32_t make_keys(gfx_device *d, const gfx_world *world, const gfx_view *view) {
    const gfx_instances *s = &world->instances;
    uint32_t total = core_columns_count(&s->set), kept = 0;
    d->visible.count = d->keys.count = d->scratch.count = 0;
    uint32_t *rows = gfx_grow(&d->visible, sizeof *rows, total), count = total;
    if (world->settings.culling) {
        count = gfx_cull(s, view, rows);
    } else {
        for (uint32_t i = 0; i < total; ++i) {
            rows[i] = i;
        }
    }
    gfx_sort_key *keys = gfx_grow(&d->keys, sizeof *keys, count);
    gfx_sort_key *scratch = gfx_grow(&d->scratch, sizeof *scratch, count);
    for (uint32_t i = 0; i < count; ++i) {
        const gfx_mesh_place *place = place_of(&d->geometry, s->mesh[rows[i]]);
        if (place) {
            uint32_t features = place->skinned && s->palette[rows[i]] ? GFX_FEATURE_SKINNING : 0;
            keys[kept++] = (gfx_sort_key){sort_key(features, s->mesh[rows[i]].index), rows[i], 0};
        }
    }
    gfx_sort_keys(keys, scratch, kept);
    return kept;
}

static gfx_batch *last_batch(gfx_device *d, const gfx_draw_list *list, uint32_t features) {
    gfx_batch *batch = (gfx_batch *)d->batches.data + d->batches.count - 1;
    if (list->batches == 0 || batch->features != features) {
        batch = gfx_grow(&d->batches, sizeof *batch, 1);
        *batch = (gfx_batch){.features = features, .first = (uint32_t)d->commands.count};
    }
    return batch;
}

void gfx_draws_add_view(gfx_device *d, const gfx_world *world, const gfx_view *view,
                        gfx_draw_list *list) {
    uint32_t count = make_keys(d, world, view), first_row = (uint32_t)d->rows.count;
    const gfx_sort_key *keys = d->keys.data;
    uint32_t *rows = gfx_grow(&d->rows, sizeof *rows, count);
    bool merge = world->settings.instancing && d->draw_parameters;
    gfx_draw_command *command = NULL;
    *list = (gfx_draw_list){.first_batch = (uint32_t)d->batches.count};
    for (uint32_t i = 0; i < count; ++i) {
        const gfx_mesh_place *place = place_of(&d->geometry, world->instances.mesh[keys[i].row]);
        rows[i] = keys[i].row;
        list->triangles += place->index_count / 3;
        if (merge && i && keys[i].key == keys[i - 1].key) {
            command->instances++;
            continue;
        }
        gfx_batch *batch = last_batch(d, list, (uint32_t)(keys[i].key >> 48));
        list->batches = (uint32_t)d->batches.count - list->first_batch;
        batch->count++;
        command = gfx_grow(&d->commands, sizeof *command, 1);
        *command = (gfx_draw_command){.count = place->index_count,
                                      .instances = 1,
                                      .first_index = place->first_index,
                                      .base_vertex = (int32_t)place->base_vertex,
                                      .base_instance = first_row + i};
    }
}

static void write_instance(const gfx_world *world, uint32_t row, uint32_t bone,
                           struct gfx_instance_block *out) {
    const gfx_instances *s = &world->instances;
    memcpy(out->row0, s->rows[row].m, sizeof s->rows[row]);
    memcpy(out->color, &s->color[row], sizeof out->color);
    uint32_t material = core_columns_row(&world->materials.set, s->material[row]);
    out->index[0] = material == CORE_NO_ROW ? 0 : material + 1; // 0: the default
    out->index[1] = bone;
    out->index[2] = out->index[3] = 0;
}

static void copy_stream(gfx_device *d, gfx_stream *stream, const gfx_growing *from, size_t size) {
    size_t bytes = from->count * size;
    void *to = gfx_stream_begin(stream, bytes, d->frame);
    if (bytes) {
        memcpy(to, from->data, bytes);
    }
}

void gfx_draws_upload(gfx_device *d, const gfx_world *world) {
    const gfx_instances *s = &world->instances;
    uint32_t count = core_columns_count(&s->set), bones = 0;
    for (uint32_t i = 0; i < count; ++i) {
        bones += s->palette[i] ? s->palette_bones[i] : 0;
    }
    struct gfx_instance_block *instance =
        gfx_stream_begin(&d->instance_block, count * sizeof *instance, d->frame);
    gfx_rows *bone = gfx_stream_begin(&d->bone_block, bones * sizeof *bone, d->frame);
    uint32_t at = 0;
    for (uint32_t i = 0; i < count; ++i) {
        write_instance(world, i, at, &instance[i]);
        if (s->palette[i]) {
            memcpy(bone + at, s->palette[i], s->palette_bones[i] * sizeof *bone);
            at += s->palette_bones[i];
        }
    }
    copy_stream(d, &d->row_block, &d->rows, sizeof(uint32_t));
    copy_stream(d, &d->draw_block, &d->commands, sizeof(gfx_draw_command));
    gfx_stream_bind(&d->instance_block, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_INSTANCES,
                    count * sizeof *instance, d->frame);
    gfx_stream_bind(&d->bone_block, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_BONES, bones * sizeof *bone,
                    d->frame);
    gfx_stream_bind(&d->row_block, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_ROWS,
                    d->rows.count * sizeof(uint32_t), d->frame);
}

static void submit_batch(gfx_device *d, const gfx_batch *batch, bool instanced) {
    size_t start = d->draw_block.segment * d->frame;
    if (instanced) {
        const void *offset = (const void *)(start + batch->first * sizeof(gfx_draw_command));
        glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, offset, (GLsizei)batch->count,
                                    0);
        return;
    }
    const gfx_draw_command *c = (const gfx_draw_command *)d->commands.data + batch->first;
    for (uint32_t i = 0; i < batch->count; ++i, ++c) {
        glUniform1ui(GFX_U_INSTANCE, c->base_instance);
        glDrawElementsBaseVertex(GL_TRIANGLES, (GLsizei)c->count, GL_UNSIGNED_INT,
                                 (const void *)(c->first_index * sizeof(uint32_t)), c->base_vertex);
    }
}

bool gfx_draws_submit(gfx_device *d, gfx_world *world, const gfx_draw_list *list,
                      const char *fragment, uint32_t features) {
    bool instanced = world->settings.instancing && d->draw_parameters;
    features |= instanced ? GFX_FEATURE_INSTANCING : 0;
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, d->draw_block.name);
    const gfx_batch *batch = (const gfx_batch *)d->batches.data + list->first_batch;
    for (uint32_t i = 0; i < list->batches; ++i, ++batch) {
        GLuint program =
            gfx_shaders_get(&d->shaders, "scene.vert", fragment, features | batch->features);
        if (!program) {
            return false;
        }
        glUseProgram(program);
        glBindVertexArray(d->geometry.vao[batch->features & GFX_FEATURE_SKINNING ? 1 : 0]);
        submit_batch(d, batch, instanced);
        world->stats.draws += batch->count;
    }
    return true;
}
