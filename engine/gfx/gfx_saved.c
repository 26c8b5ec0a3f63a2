// What a saved scene shows: instances, lights, materials, camera. Meshes are the scene's own.
#include <math.h>

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

bool gfx_world_stream(gfx_world *w, core_stream *s) {
    if (!s->writing) {
        drop_palettes(w);
    }
    bool good = core_stream_open(s, "gfx") &&
                core_stream_same(s, "meshes", core_pool_hash(&w->meshes.set.pool),
                                 "the scene has other meshes") &&
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
