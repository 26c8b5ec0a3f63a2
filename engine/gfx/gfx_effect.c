// Parts of shaders that scripts write: passes over the picture, and of materials.
#include "gfx/gfx_internal.h"

#include <string.h>

enum { MAX_EFFECTS = 32 };

CORE_COLUMNS_DEFINE(gfx_effects, GFX_EFFECT_COLUMNS)

bool gfx_hook_make(const gfx_world *world, const char *what, const char *path,
                   const float parameters[GFX_PARAMETERS], gfx_hook *out) {
    size_t length = path ? strlen(path) : 0;
    *out = (gfx_hook){0};
    if (length == 0 || length >= sizeof out->path) {
        return core_fail("%s: the shader's path has %zu bytes, expected 1..%zu", what, length,
                         sizeof out->path - 1);
    }
    if (world->vfs && !core_vfs_exists(world->vfs, path)) {
        return core_fail("%s: there is no file \"%s\"", what, path);
    }
    memcpy(out->path, path, length + 1);
    memcpy(out->parameters, parameters, sizeof out->parameters);
    return true;
}

gfx_effect_desc gfx_effect_desc_default(void) { return (gfx_effect_desc){.cookie = GFX_COOKIE}; }

gfx_effect gfx_effect_create(gfx_world *world, const gfx_effect_desc *desc) {
    gfx_hook hook;
    if (!desc || desc->cookie != GFX_COOKIE) {
        core_fail("gfx_effect_create: start from gfx_effect_desc_default()");
        return CORE_NULL_HANDLE;
    }
    if (!gfx_hook_make(world, "gfx_effect_create", desc->fragment, desc->parameters, &hook)) {
        return CORE_NULL_HANDLE;
    }
    hook.encoded = desc->encoded;
    if (!world->effects_made) {
        world->effects_made = gfx_effects_init(&world->effects, "gfx.effects", MAX_EFFECTS);
    }
    gfx_effect effect = core_columns_add(&world->effects.set);
    uint32_t i = core_columns_row(&world->effects.set, effect);
    if (i != CORE_NO_ROW) {
        hook.order = ++world->effect_order;
        world->effects.hook[i] = hook;
    }
    return effect;
}

bool gfx_effect_destroy(gfx_world *world, gfx_effect effect) {
    return (world->effects_made && core_columns_remove(&world->effects.set, effect, NULL, NULL)) ||
           core_fail("gfx_effect_destroy: the handle is stale or null");
}

bool gfx_effect_alive(const gfx_world *world, gfx_effect effect) {
    return world->effects_made && core_columns_row(&world->effects.set, effect) != CORE_NO_ROW;
}

bool gfx_effect_set_parameters(gfx_world *world, gfx_effect effect, const float parameters[16]) {
    if (!gfx_effect_alive(world, effect)) {
        return core_fail("gfx_effect_set_parameters: the handle is stale or null");
    }
    gfx_hook *hook = &world->effects.hook[core_columns_row(&world->effects.set, effect)];
    memcpy(hook->parameters, parameters, sizeof hook->parameters);
    return true;
}
