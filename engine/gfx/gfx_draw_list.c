// The draw list of a view: visible instances, sorted by state, merged into instanced commands.
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

static uint32_t make_keys(gfx_device *d, const gfx_world *world, const uint32_t *rows,
                          uint32_t count, uint32_t *bones) {
    d->keys.count = d->scratch.count = 0;
    gfx_sort_key *keys = gfx_grow(&d->keys, sizeof *keys, count);
    gfx_sort_key *scratch = gfx_grow(&d->scratch, sizeof *scratch, count);
    const gfx_instances *s = &world->instances;
    uint32_t kept = 0;
    *bones = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t row = rows[i];
        const gfx_mesh_place *place = place_of(&d->geometry, s->mesh[row]);
        if (!place) {
            continue;
        }
        uint32_t features = place->skinned && s->palette[row] ? GFX_FEATURE_SKINNING : 0;
        *bones += features ? s->palette_bones[row] : 0;
        keys[kept++] = (gfx_sort_key){sort_key(features, s->mesh[row].index), row, 0};
    }
    gfx_sort_keys(keys, scratch, kept);
    return kept;
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

typedef struct list_writer {
    gfx_draw_command *command;
    struct gfx_instance_block *instance;
    gfx_rows *bone;
    uint32_t commands, instances, bones;
    uint64_t last_key;
} list_writer;

// Starts a command when the state differs from the last one's, or always without instancing.
static void write_command(gfx_device *d, list_writer *w, const gfx_mesh_place *place, uint64_t key,
                          bool merge) {
    if (merge && w->commands && key == w->last_key) {
        w->command[w->commands - 1].instances++;
        return;
    }
    uint32_t features = (uint32_t)(key >> 48);
    gfx_batch *batch =
        d->batches.count ? (gfx_batch *)d->batches.data + d->batches.count - 1 : NULL;
    if (!batch || batch->features != features) {
        batch = gfx_grow(&d->batches, sizeof *batch, 1);
        *batch = (gfx_batch){.features = features, .first = w->commands};
    }
    batch->count++;
    w->command[w->commands++] = (gfx_draw_command){.count = place->index_count,
                                                   .instances = 1,
                                                   .first_index = place->first_index,
                                                   .base_vertex = (int32_t)place->base_vertex,
                                                   .base_instance = w->instances};
    w->last_key = key;
}

bool gfx_draw_list_build(gfx_device *d, gfx_world *world, const gfx_view *view) {
    uint32_t total = core_columns_count(&world->instances.set);
    d->visible.count = d->batches.count = 0;
    uint32_t *rows = gfx_grow(&d->visible, sizeof *rows, total);
    uint32_t bones, visible = total;
    if (world->settings.culling) {
        visible = gfx_cull(&world->instances, view, rows);
    } else {
        for (uint32_t i = 0; i < total; ++i) {
            rows[i] = i;
        }
    }
    uint32_t count = make_keys(d, world, rows, visible, &bones);
    const gfx_sort_key *keys = d->keys.data;
    list_writer w = {
        .command = gfx_stream_begin(&d->draw_block, count * sizeof *w.command, d->frame),
        .instance = gfx_stream_begin(&d->instance_block, count * sizeof *w.instance, d->frame),
        .bone = gfx_stream_begin(&d->bone_block, bones * sizeof *w.bone, d->frame),
    };
    d->commands.count = 0;
    gfx_draw_command *command = gfx_grow(&d->commands, sizeof *command, count);
    gfx_draw_command *stream = w.command;
    w.command = command; // merged in ordinary memory: the mapping is for writing only
    uint32_t triangles = 0;
    bool merge = world->settings.instancing && d->draw_parameters;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t row = keys[i].row;
        const gfx_mesh_place *place = place_of(&d->geometry, world->instances.mesh[row]);
        write_command(d, &w, place, keys[i].key, merge);
        write_instance(world, row, w.bones, &w.instance[w.instances++]);
        if (keys[i].key >> 48 & GFX_FEATURE_SKINNING) {
            uint32_t n = world->instances.palette_bones[row];
            memcpy(w.bone + w.bones, world->instances.palette[row], n * sizeof *w.bone);
            w.bones += n;
        }
        triangles += place->index_count / 3;
    }
    memcpy(stream, command, w.commands * sizeof *command);
    gfx_stream_bind(&d->instance_block, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_INSTANCES,
                    count * sizeof *w.instance, d->frame);
    gfx_stream_bind(&d->bone_block, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_BONES,
                    bones * sizeof *w.bone, d->frame);
    world->stats.visible = count;
    world->stats.triangles = triangles;
    return true;
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

bool gfx_draw_list_submit(gfx_device *d, gfx_world *world, const char *fragment,
                          uint32_t features) {
    bool instanced = world->settings.instancing && d->draw_parameters;
    features |= instanced ? GFX_FEATURE_INSTANCING : 0;
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, d->draw_block.name);
    const gfx_batch *batch = d->batches.data;
    for (size_t i = 0; i < d->batches.count; ++i, ++batch) {
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
