// Instances and bones on the GPU. Each turn's segment of the streams keeps what it was given, so
// that only rows changed since then are written: a scene at rest writes none.
#include "gfx/gfx_device_internal.h"

#include "core/hash.h"

#include <string.h>

void gfx_instance_gpu_release(gfx_instance_gpu *g) {
    gfx_stream_release(&g->instances);
    gfx_stream_release(&g->bones);
    gfx_growing_release(&g->first_bone);
    *g = (gfx_instance_gpu){0};
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

// Where each row's bones begin; returns how many there are.
static uint32_t place_bones(gfx_instance_gpu *g, const gfx_instances *s, uint32_t count) {
    uint32_t bones = 0;
    g->first_bone.count = 0;
    uint32_t *first = gfx_grow(&g->first_bone, sizeof *first, count);
    for (uint32_t i = 0; i < count; ++i) {
        first[i] = bones;
        bones += s->palette[i] ? s->palette_bones[i] : 0;
    }
    return bones;
}

void gfx_instances_upload(gfx_device *d, gfx_world *world) {
    gfx_instance_gpu *g = &d->instances;
    const gfx_instances *s = &world->instances;
    uint32_t count = core_columns_count(&s->set), turn = d->frame;
    uint64_t layout = core_hash_mix(world->id, world->palette_layout);
    if (g->layout != layout) {
        g->bone_count = place_bones(g, s, count);
        g->layout = layout;
    }
    size_t bytes = count * sizeof(struct gfx_instance_block);
    size_t bone_bytes = g->bone_count * sizeof(gfx_rows);
    struct gfx_instance_block *instance = gfx_stream_begin(&g->instances, bytes, turn);
    gfx_rows *bone = gfx_stream_begin(&g->bones, bone_bytes, turn);
    // What rows hold beside their own columns; a stream that grew is empty.
    uint64_t key = core_hash_mix(layout, world->material_version);
    key = core_hash_mix(key, g->instances.segment ^ (uint64_t)g->bones.segment << 32);
    uint64_t since = g->key[turn] == key ? g->version[turn] : 0;
    g->key[turn] = key, g->version[turn] = world->row_version;
    const uint32_t *first = g->first_bone.data;
    for (uint32_t i = 0; i < count && since < world->row_version; ++i) {
        if (s->changed[i] <= since) {
            continue;
        }
        write_instance(world, i, first[i], &instance[i]);
        if (s->palette[i]) {
            memcpy(bone + first[i], s->palette[i], s->palette_bones[i] * sizeof *bone);
        }
        world->stats.uploads++;
    }
    gfx_stream_bind(&g->instances, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_INSTANCES, bytes, turn);
    gfx_stream_bind(&g->bones, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_BONES, bone_bytes, turn);
}
