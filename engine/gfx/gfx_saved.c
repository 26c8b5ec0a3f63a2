// What a saved scene shows: instances, lights, materials, camera. Meshes are the scene's own.
#include <math.h>
#include <string.h>

#include "gfx/gfx_internal.h"

static void drop_palettes(gfx_world *w) {
    for (uint32_t i = 0; i < core_columns_count(&w->instances.set); i++) {
        core_free(w->instances.palette[i]);
        w->heap_bytes -= w->instances.palette_bones[i] * sizeof(gfx_rows);
    }
    core_columns_clear(&w->instances.set);
}

static bool check(gfx_world *w, core_stream *s) {
    for (uint32_t i = 0; i < core_columns_count(&w->instances.set); i++) {
        core_handle m = w->instances.material[i];
        if (core_columns_row(&w->meshes.set, w->instances.mesh[i]) == CORE_NO_ROW ||
            (!core_handle_is_null(m) && core_columns_row(&w->materials.set, m) == CORE_NO_ROW)) {
            return core_stream_fail(s, "gfx.instances", "row %u shows what the scene has not", i);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->lights.set); i++) {
        const gfx_lights *l = &w->lights;
        float sum = l->px[i] + l->py[i] + l->pz[i] + l->dx[i] + l->dy[i] + l->dz[i] + l->r[i] +
                    l->g[i] + l->b[i] + l->intensity[i] + l->inner[i] + l->outer[i] + l->source[i];
        if (l->type[i] > GFX_DIRECTIONAL || !isfinite(sum) || !(l->radius[i] >= 0)) {
            return core_stream_fail(s, "gfx.lights", "row %u is no light", i);
        }
    }
    return true;
}

// Built-in meshes are made when first asked for: those that the saved world had are made now, in
// the order in which it made them, so that they get the handles they had.
static bool stream_builtin(gfx_world *w, core_stream *s) {
    core_handle saved[GFX_BUILTIN_MESHES];
    memcpy(saved, w->builtin, sizeof saved);
    if (!core_stream_list(s, "builtin", 'u', saved, sizeof saved)) {
        return false;
    }
    for (;;) {
        int next = -1;
        for (int i = 0; i < GFX_BUILTIN_MESHES; i++) {
            bool missing = core_handle_is_null(w->builtin[i]) && !core_handle_is_null(saved[i]);
            next = missing && (next < 0 || saved[i].index < saved[next].index) ? i : next;
        }
        if (next < 0) {
            return true;
        }
        gfx_mesh_builtin(w, gfx_builtin_names[next]);
    }
}

// Every mesh that the saved world had must be here under its handle, of the same size. More may be.
static bool same_meshes(gfx_world *w, core_stream *s) {
    uint32_t count = core_columns_count(&w->meshes.set);
    bool good = core_stream_count(s, "meshes", &count, 1u << 24);
    for (uint32_t i = 0; good && i < count; i++) {
        uint32_t mesh[4] = {0};
        if (s->writing) {
            core_handle h = core_columns_handle(&w->meshes.set, i);
            const gfx_mesh_store *store = &w->meshes.store[i];
            memcpy(mesh,
                   (uint32_t[]){h.index, h.generation, store->vertex_count, store->index_count},
                   sizeof mesh);
        }
        good = core_stream_list(s, "mesh", 'u', mesh, sizeof mesh);
        core_handle h = {mesh[0], mesh[1]};
        uint32_t row = core_columns_row(&w->meshes.set, h);
        if (good && (row == CORE_NO_ROW || w->meshes.store[row].vertex_count != mesh[2] ||
                     w->meshes.store[row].index_count != mesh[3])) {
            good = core_stream_fail(s, "mesh", "the scene has not the mesh %u:%u of %u vertices",
                                    h.index, h.generation, mesh[2]);
        }
    }
    return good;
}

bool gfx_world_stream(gfx_world *w, core_stream *s) {
    if (!s->writing) {
        drop_palettes(w);
    }
    bool good = core_stream_open(s, "gfx") && stream_builtin(w, s) && same_meshes(w, s) &&
                core_stream_same(s, "materials", core_pool_hash(&w->materials.set.pool),
                                 "the scene has other materials") &&
                core_stream_list(s, "camera", 'x', &w->camera, sizeof w->camera) &&
                core_stream_list(s, "ambient", 'f', w->ambient, sizeof w->ambient) &&
                core_stream_list(s, "background", 'f', w->background, sizeof w->background) &&
                core_stream_columns(s, &w->instances.set) &&
                core_stream_columns(s, &w->lights.set) && core_stream_close(s) &&
                (s->writing || check(w, s));
    if (!good && !s->writing) {
        drop_palettes(w);
        core_columns_clear(&w->lights.set);
    }
    if (!s->writing) { // every copy of a row is old
        w->instance_version++;
        w->row_version++;
        for (uint32_t i = 0; i < core_columns_count(&w->instances.set); i++) {
            w->instances.changed[i] = w->row_version;
        }
    }
    return good;
}
