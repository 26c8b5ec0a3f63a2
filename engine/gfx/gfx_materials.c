// Materials as the shaders read them, and the textures that drawing with one binds.
#include "gfx/gfx_device_internal.h"

#include <string.h>

static void write_block(const core_material_data *m, struct gfx_material_block *out) {
    *out = (struct gfx_material_block){
        .emissive_metallic = {m->emissive[0], m->emissive[1], m->emissive[2], m->metallic},
        .params = {m->roughness, m->normal_scale, m->occlusion_strength, m->alpha_cutoff},
    };
    memcpy(out->base_color, m->base_color, sizeof out->base_color);
}

// A map that is not named does nothing. A colour that cannot be read is a checker; where another
// map cannot, the base colour is one.
static GLuint map_of(gfx_device *d, const char *path, bool srgb, const char *fallback,
                     bool *missing) {
    if (path[0]) {
        const gfx_texture *t = gfx_texture_get(d, path, srgb);
        if (srgb || t->state != GFX_TEXTURE_MISSING) {
            return t->name;
        }
        *missing = true;
    }
    return gfx_texture_get(d, fallback, srgb)->name;
}

static gfx_material_state state_of(gfx_device *d, const core_material_data *m, bool hooked) {
    gfx_material_state s = {.double_sided = m->double_sided, .hooked = hooked};
    s.features |= m->alpha_mode == 1 ? GFX_FEATURE_ALPHA_MASK : 0;
    s.features |= m->alpha_mode == 2 ? GFX_FEATURE_BLEND : 0;
    if (hooked || m->base_color_image[0] || m->normal_image[0] || m->metallic_roughness_image[0] ||
        m->occlusion_image[0] || m->emissive_image[0]) {
        bool missing = false;
        GLuint *t = s.texture;
        s.features |= GFX_FEATURE_TEXTURES;
        t[GFX_TEX_BASE_COLOR] = map_of(d, m->base_color_image, true, GFX_TEXTURE_WHITE, &missing);
        t[GFX_TEX_NORMAL] = map_of(d, m->normal_image, false, GFX_TEXTURE_FLAT, &missing);
        t[GFX_TEX_METALLIC_ROUGHNESS] =
            map_of(d, m->metallic_roughness_image, false, GFX_TEXTURE_WHITE, &missing);
        t[GFX_TEX_OCCLUSION] = map_of(d, m->occlusion_image, false, GFX_TEXTURE_WHITE, &missing);
        t[GFX_TEX_EMISSIVE] = map_of(d, m->emissive_image, true, GFX_TEXTURE_WHITE, &missing);
        if (missing) {
            t[GFX_TEX_BASE_COLOR] = gfx_texture_get(d, GFX_TEXTURE_CHECKER, true)->name;
        }
    }
    return s;
}

// Materials change rarely: everything is made anew when one did. Entry 0 is the default.
void gfx_materials_update(gfx_device *d, const gfx_world *world) {
    gfx_material_cache *c = &d->materials;
    if (c->buffer && c->world == world->id && c->version == world->material_version &&
        c->textures == d->textures.version) {
        return;
    }
    uint32_t n = core_columns_count(&world->materials.set);
    struct gfx_material_block *block = core_alloc((n + 1) * sizeof *block);
    gfx_material_desc plain = gfx_material_desc_default();
    c->state.count = 0;
    gfx_material_state *state = gfx_grow(&c->state, sizeof *state, n + 1);
    write_block(&plain.data, &block[0]);
    state[0] = (gfx_material_state){0};
    for (uint32_t i = 0; i < n; ++i) {
        write_block(&world->materials.data[i], &block[i + 1]);
        state[i + 1] =
            state_of(d, &world->materials.data[i], world->materials.hook[i].path[0] != 0);
    }
    glDeleteBuffers(1, &c->buffer);
    glCreateBuffers(1, &c->buffer);
    glNamedBufferStorage(c->buffer, (GLsizeiptr)((n + 1) * sizeof *block), block, 0);
    core_free(block);
    c->world = world->id;
    c->version = world->material_version;
    c->textures = d->textures.version;
}

void gfx_materials_release(gfx_material_cache *c) {
    glDeleteBuffers(1, &c->buffer);
    gfx_growing_release(&c->state);
}
