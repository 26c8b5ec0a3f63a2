// Textures by virtual path, and the materials that use them.
#include "gfx/gfx_device_internal.h"

#include <stb_image.h>

#include <stdio.h>
#include <string.h>

// ---- textures ----

void gfx_textures_release(gfx_textures *t) {
    gfx_texture *all = t->all.data;
    for (size_t i = 0; i < t->all.count; ++i) {
        glDeleteTextures(1, &all[i].name);
    }
    gfx_growing_release(&t->all);
}

static GLuint upload(const uint8_t *rgba, int width, int height, bool srgb) {
    GLuint name;
    int levels = 1;
    while ((width | height) >> levels) {
        levels++;
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    glTextureStorage2D(name, levels, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, width, height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(name, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    glGenerateTextureMipmap(name);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameterf(name, GL_TEXTURE_MAX_ANISOTROPY_EXT, 8.0f);
    return name;
}

static GLuint read_image(core_vfs *vfs, gfx_texture *t) {
    size_t size;
    void *file = vfs ? core_vfs_read(vfs, t->path, &size) : NULL;
    if (!file) {
        return 0;
    }
    int channels, width, height;
    uint8_t *rgba = stbi_load_from_memory(file, (int)size, &width, &height, &channels, 4);
    GLuint name = rgba ? upload(rgba, width, height, t->srgb) : 0;
    if (!rgba) {
        core_fail("%s: no picture that can be read (%s)", t->path, stbi_failure_reason());
    }
    t->width = (uint32_t)width, t->height = (uint32_t)height;
    stbi_image_free(rgba);
    core_free(file);
    return name;
}

const gfx_texture *gfx_texture_get(gfx_device *d, const char *path, bool srgb) {
    gfx_growing *all = &d->textures.all;
    gfx_texture *t = all->data;
    for (size_t i = 0; i < all->count; ++i) {
        if (t[i].srgb == srgb && strcmp(t[i].path, path) == 0) {
            return t[i].name ? &t[i] : NULL;
        }
    }
    t = gfx_grow(all, sizeof *t, 1);
    *t = (gfx_texture){.srgb = srgb};
    snprintf(t->path, sizeof t->path, "%s", path);
    t->name = read_image(d->vfs, t);
    return t->name ? t : NULL;
}

// ---- materials ----

static void write_block(const core_material_data *m, struct gfx_material_block *out) {
    *out = (struct gfx_material_block){
        .emissive_metallic = {m->emissive[0], m->emissive[1], m->emissive[2], m->metallic},
        .params = {m->roughness, m->normal_scale, m->occlusion_strength, m->alpha_cutoff},
    };
    memcpy(out->base_color, m->base_color, sizeof out->base_color);
}

// Maps that are absent are white, and a normal map that is absent is flat.
static GLuint texture_or(gfx_device *d, const char *path, bool srgb, const char *fallback) {
    const gfx_texture *t = path[0] ? gfx_texture_get(d, path, srgb) : NULL;
    if (!t) {
        t = gfx_texture_get(d, fallback, srgb);
    }
    return t ? t->name : 0;
}

// One texel each, entered under names that no file can have.
static void add_plain_textures(gfx_device *d) {
    static const uint8_t white[4] = {255, 255, 255, 255}, flat[4] = {128, 128, 255, 255};
    const struct {
        const char *path;
        const uint8_t *texel;
        bool srgb;
    } plain[] = {{"//white", white, true}, {"//white", white, false}, {"//flat", flat, false}};
    for (size_t i = 0; i < CORE_COUNT_OF(plain) && d->textures.all.count < 3; ++i) {
        gfx_texture *t = gfx_grow(&d->textures.all, sizeof *t, 1);
        *t = (gfx_texture){.srgb = plain[i].srgb, .width = 1, .height = 1};
        snprintf(t->path, sizeof t->path, "%s", plain[i].path);
        t->name = upload(plain[i].texel, 1, 1, plain[i].srgb);
    }
}

static gfx_material_state state_of(gfx_device *d, const core_material_data *m) {
    gfx_material_state s = {.double_sided = m->double_sided};
    s.features |= m->alpha_mode == 1 ? GFX_FEATURE_ALPHA_MASK : 0;
    s.features |= m->alpha_mode == 2 ? GFX_FEATURE_BLEND : 0;
    if (m->base_color_image[0] || m->normal_image[0] || m->metallic_roughness_image[0] ||
        m->occlusion_image[0] || m->emissive_image[0]) {
        add_plain_textures(d);
        s.features |= GFX_FEATURE_TEXTURES;
        s.texture[GFX_TEX_BASE_COLOR] = texture_or(d, m->base_color_image, true, "//white");
        s.texture[GFX_TEX_NORMAL] = texture_or(d, m->normal_image, false, "//flat");
        s.texture[GFX_TEX_METALLIC_ROUGHNESS] =
            texture_or(d, m->metallic_roughness_image, false, "//white");
        s.texture[GFX_TEX_OCCLUSION] = texture_or(d, m->occlusion_image, false, "//white");
        s.texture[GFX_TEX_EMISSIVE] = texture_or(d, m->emissive_image, true, "//white");
    }
    return s;
}

// Materials change rarely: everything is made anew when one did. Entry 0 is the default.
void gfx_materials_update(gfx_device *d, const gfx_world *world) {
    gfx_material_cache *c = &d->materials;
    if (c->buffer && c->world == world->id && c->version == world->material_version) {
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
        state[i + 1] = state_of(d, &world->materials.data[i]);
    }
    glDeleteBuffers(1, &c->buffer);
    glCreateBuffers(1, &c->buffer);
    glNamedBufferStorage(c->buffer, (GLsizeiptr)((n + 1) * sizeof *block), block, 0);
    core_free(block);
    c->world = world->id;
    c->version = world->material_version;
}

void gfx_materials_release(gfx_material_cache *c) {
    glDeleteBuffers(1, &c->buffer);
    gfx_growing_release(&c->state);
}
