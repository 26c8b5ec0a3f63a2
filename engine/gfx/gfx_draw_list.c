// Draw lists: the visible instances of each view of a frame, sorted by state and merged into
// instanced commands. Views share one upload of instances; each has its own list of their rows.
#include "gfx/gfx_cull.h"
#include "gfx/gfx_device_internal.h"

#include "core/hash.h"

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

static const gfx_mesh_place *place_of(const gfx_geometry *g, gfx_mesh mesh) {
    if (mesh.index >= g->places || g->place[mesh.index].generation != mesh.generation) {
        return NULL; // destroyed
    }
    return &g->place[mesh.index];
}

// The coarsest level of a mesh whose surface lies within half a pixel of the true one.
static const gfx_mesh_place *level_of(const gfx_device *d, const gfx_world *world, gfx_mesh mesh,
                                      float radius_pixels) {
    uint32_t row = core_columns_row(&world->meshes.set, mesh);
    while (row != CORE_NO_ROW && world->settings.levels) {
        gfx_mesh coarser = world->meshes.store[row].coarser;
        uint32_t next = core_columns_row(&world->meshes.set, coarser);
        if (next == CORE_NO_ROW || world->meshes.store[next].deviation * radius_pixels > 0.5f) {
            break;
        }
        mesh = coarser;
        row = next;
    }
    return place_of(&d->geometry, mesh);
}

// Levels are chosen by the camera alone: shadow maps must hold the surface that receives them.
void gfx_draws_begin(gfx_device *d, const gfx_world *world, const gfx_view *view) {
    const gfx_instances *s = &world->instances;
    uint32_t n = core_columns_count(&s->set);
    float scale = 0.5f * (float)d->height / view->tan_y;
    d->rows.count = d->commands.count = d->batches.count = d->places.count = 0;
    const gfx_mesh_place **place = gfx_grow(&d->places, sizeof *place, n);
    d->levels_hash = 0;
    for (uint32_t i = 0; i < n; ++i) {
        core_vec3 to = core_v3_sub(core_v3(s->cx[i], s->cy[i], s->cz[i]), view->position);
        float distance = view->orthographic ? 1.0f : core_v3_length(to) - s->cr[i];
        float pixels = s->cr[i] * scale / CORE_MAX(distance, view->near_plane);
        place[i] = level_of(d, world, s->mesh[i], pixels);
        d->levels_hash = core_hash_mix(d->levels_hash, place[i] ? place[i]->first_index : 0);
    }
}

static const gfx_material_state *material_state(const gfx_device *d, uint32_t material) {
    return (const gfx_material_state *)d->materials.state.data + material;
}

// Whether a transform turns left hands into right ones.
static bool is_mirrored(const gfx_rows *rows) {
    const float *m = rows->m;
    core_vec3 a = {m[0], m[1], m[2]}, b = {m[4], m[5], m[6]}, c = {m[8], m[9], m[10]};
    return core_v3_dot(core_v3_cross(a, b), c) < 0.0f;
}

// What a draw call needs of an instance besides its mesh.
static gfx_batch state_of(const gfx_device *d, const gfx_world *world, const gfx_sort_key *key) {
    const gfx_material_state *m = material_state(d, key->material);
    bool skinned = key->place->skinned && world->instances.palette[key->row];
    return (gfx_batch){.features = m->features | (skinned ? GFX_FEATURE_SKINNING : 0),
                       .material = m->features & GFX_FEATURE_TEXTURES ? key->material : 0,
                       .double_sided = m->double_sided,
                       .mirrored = is_mirrored(&world->instances.rows[key->row])};
}

static bool same_state(const gfx_batch *a, const gfx_batch *b) {
    return a->features == b->features && a->material == b->material &&
           a->double_sided == b->double_sided && a->mirrored == b->mirrored;
}

// Opaque: program and cull state, textures, mesh; a mesh's instances keep the order of their rows.
// Blended ones come after, from far to near: bits of a positive float order as the float does.
static uint64_t sort_key(const gfx_batch *state, const gfx_world *world, const gfx_view *view,
                         const gfx_sort_key *of) {
    const gfx_instances *s = &world->instances;
    uint32_t row = of->row;
    if (state->features & GFX_FEATURE_BLEND) {
        core_vec3 d = core_v3_sub(core_v3(s->cx[row], s->cy[row], s->cz[row]), view->position);
        float d2 = core_v3_dot(d, d);
        uint32_t bits;
        memcpy(&bits, &d2, sizeof bits);
        return 1ull << 63 | (uint64_t)~bits << 16;
    }
    uint32_t sides = (uint32_t)state->double_sided << 1 | state->mirrored;
    uint64_t program = (uint64_t)(state->features << 2 | sides) & 0x7fff;
    return program << 48 | (uint64_t)(state->material & 0xffffff) << 24 |
           (of->place->number & 0xffffff);
}

// Keys of the rows that are in the view and have a mesh.
static uint32_t make_keys(gfx_device *d, const gfx_world *world, const gfx_view *view) {
    const gfx_instances *s = &world->instances;
    uint32_t total = core_columns_count(&s->set), kept = 0;
    d->visible.count = d->keys.count = d->scratch.count = 0;
    uint32_t *rows = gfx_grow(&d->visible, sizeof *rows, total), count = total;
    if (world->settings.culling) {
        count = CORE_SIMD_SELECT(gfx_cull)(s, view, rows);
    } else {
        for (uint32_t i = 0; i < total; ++i) {
            rows[i] = i;
        }
    }
    gfx_sort_key *keys = gfx_grow(&d->keys, sizeof *keys, count);
    gfx_sort_key *scratch = gfx_grow(&d->scratch, sizeof *scratch, count);
    for (uint32_t i = 0; i < count; ++i) {
        const gfx_mesh_place *place = ((const gfx_mesh_place **)d->places.data)[rows[i]];
        if (place) {
            uint32_t material = core_columns_row(&world->materials.set, s->material[rows[i]]);
            gfx_sort_key *k = &keys[kept++];
            *k = (gfx_sort_key){.row = rows[i],
                                .place = place,
                                .material = material == CORE_NO_ROW ? 0 : material + 1};
            gfx_batch state = state_of(d, world, k);
            k->key = sort_key(&state, world, view, k);
        }
    }
    gfx_sort_keys(keys, scratch, kept);
    return kept;
}

// Continues the list's last batch when the state is the same, else starts one.
static gfx_batch *batch_for(gfx_device *d, gfx_draw_list *list, const gfx_batch *state) {
    gfx_batch *batch = d->batches.data; // null until the first batch of all
    if (list->batches) {
        batch += d->batches.count - 1;
    }
    if (list->batches == 0 || !same_state(batch, state)) {
        batch = gfx_grow(&d->batches, sizeof *batch, 1);
        *batch = *state;
        batch->first = (uint32_t)d->commands.count;
        list->batches++;
        list->opaque += !(state->features & GFX_FEATURE_BLEND);
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
    const gfx_mesh_place *last = NULL;
    *list = (gfx_draw_list){.first_batch = (uint32_t)d->batches.count};
    for (uint32_t i = 0; i < count; ++i) {
        const gfx_mesh_place *place = keys[i].place;
        gfx_batch state = state_of(d, world, &keys[i]);
        uint32_t batches = list->batches;
        gfx_batch *batch = batch_for(d, list, &state);
        rows[i] = keys[i].row;
        list->triangles += place->index_count / 3;
        if (merge && place == last && batches == list->batches) {
            command->instances++;
            continue;
        }
        last = place;
        batch->count++;
        command = gfx_grow(&d->commands, sizeof *command, 1);
        *command = (gfx_draw_command){.count = place->index_count,
                                      .instances = 1,
                                      .first_index = place->first_index,
                                      .base_vertex = (int32_t)place->base_vertex,
                                      .base_instance = first_row + i};
    }
}

static void copy_stream(gfx_device *d, gfx_stream *stream, const gfx_growing *from, size_t size) {
    size_t bytes = from->count * size;
    void *to = gfx_stream_begin(stream, bytes, d->frame);
    if (bytes) {
        memcpy(to, from->data, bytes);
    }
}

void gfx_draws_upload(gfx_device *d, gfx_world *world) {
    gfx_instances_upload(d, world);
    copy_stream(d, &d->row_block, &d->rows, sizeof(uint32_t));
    copy_stream(d, &d->draw_block, &d->commands, sizeof(gfx_draw_command));
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

// What a batch's material has from a script, NULL: nothing.
static const gfx_hook *hook_of(const gfx_device *d, const gfx_world *world, const gfx_batch *batch,
                               uint32_t features) {
    bool shaded = features & GFX_FEATURE_TEXTURES && !(features & GFX_FEATURE_DEPTH_ONLY);
    return shaded && material_state(d, batch->material)->hooked
               ? &world->materials.hook[batch->material - 1]
               : NULL;
}

// A script's shader that does not build is logged once, and its material drawn without it: then
// *hook becomes NULL.
static GLuint program_of(gfx_device *d, const char *fragment, uint32_t features,
                         const gfx_hook **hook) {
    GLuint program =
        *hook ? gfx_shaders_get_hooked(&d->shaders, "scene.vert", fragment, features, (*hook)->path)
              : 0;
    *hook = program ? *hook : NULL;
    return program ? program : gfx_shaders_get(&d->shaders, "scene.vert", fragment, features);
}

// The one place where programs, vertex arrays, textures and cull state change between draws.
static bool submit(gfx_device *d, gfx_world *world, uint32_t first, uint32_t end,
                   const char *fragment, uint32_t features) {
    bool instanced = world->settings.instancing && d->draw_parameters;
    features |= instanced ? GFX_FEATURE_INSTANCING : 0;
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, d->draw_block.name);
    const gfx_batch *batches = d->batches.data;
    GLuint used = 0;
    bool two_sided = false, mirrored = false, ok = true;
    for (uint32_t i = first; i < end; ++i) {
        const gfx_batch *batch = &batches[i];
        uint32_t own = batch->features;
        if (features & GFX_FEATURE_DEPTH_ONLY && !(own & GFX_FEATURE_ALPHA_MASK)) {
            own &= GFX_FEATURE_SKINNING; // depth needs no more of an opaque material
        }
        const gfx_hook *hook = hook_of(d, world, batch, features | own);
        GLuint program = program_of(d, fragment, features | own, &hook);
        if (!program) {
            ok = false;
            break;
        }
        if (program != used) {
            glUseProgram(program);
            glBindVertexArray(d->geometry.vao[own & GFX_FEATURE_SKINNING ? 1 : 0]);
            world->stats.programs++;
            used = program;
        }
        if (own & GFX_FEATURE_TEXTURES) {
            glBindTextures(0, GFX_MATERIAL_TEXTURES, material_state(d, batch->material)->texture);
        }
        if (hook) {
            glUniform4fv(GFX_U_PARAMETERS, GFX_PARAMETERS / 4, hook->parameters);
        }
        if (batch->double_sided != two_sided) {
            (batch->double_sided ? glDisable : glEnable)(GL_CULL_FACE);
            two_sided = batch->double_sided;
        }
        if (batch->mirrored != mirrored) {
            glFrontFace(batch->mirrored ? GL_CW : GL_CCW);
            mirrored = batch->mirrored;
        }
        submit_batch(d, batch, instanced);
        world->stats.draws += batch->count;
    }
    glEnable(GL_CULL_FACE);
    glFrontFace(GL_CCW);
    return ok;
}

bool gfx_draws_submit(gfx_device *d, gfx_world *world, const gfx_draw_list *list,
                      const char *fragment, uint32_t features) {
    return submit(d, world, list->first_batch, list->first_batch + list->opaque, fragment,
                  features);
}

bool gfx_draws_submit_blended(gfx_device *d, gfx_world *world, const gfx_draw_list *list,
                              uint32_t features) {
    return submit(d, world, list->first_batch + list->opaque, list->first_batch + list->batches,
                  "scene.frag", features);
}
