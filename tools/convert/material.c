// Materials to the metallic-roughness model, and the images they name: embedded ones are written
// out, files are copied.
#include "convert.h"

#include "asset/bytes.h"

#include <assimp/GltfMaterial.h>
#include <stb_image_write.h>
#include <stdio.h>
#include <string.h>

static void append(void *to, void *data, int size) { asset_write(to, data, (size_t)size); }

// A texture kept inside the model: compressed bytes as they are, pixels as PNG.
static bool write_embedded(cv_model *m, const struct aiTexture *t, unsigned number, char *file) {
    if (t->mHeight == 0) {
        const char *hint = strcmp(t->achFormatHint, "jpeg") == 0 ? "jpg" : t->achFormatHint;
        snprintf(file, CORE_NAME_MAX, "%s_texture%u.%.8s", m->name, number, hint[0] ? hint : "png");
        return cv_write(m, file, t->pcData, t->mWidth);
    }
    snprintf(file, CORE_NAME_MAX, "%s_texture%u.png", m->name, number);
    size_t n = (size_t)t->mWidth * t->mHeight;
    uint8_t *rgba = core_alloc(n * 4);
    for (size_t i = 0; i < n; i++) {
        const struct aiTexel *p = &t->pcData[i];
        memcpy(rgba + 4 * i, (uint8_t[]){p->r, p->g, p->b, p->a}, 4);
    }
    asset_writer png = {0};
    bool good = stbi_write_png_to_func(append, &png, (int)t->mWidth, (int)t->mHeight, 4, rgba,
                                       (int)t->mWidth * 4) &&
                cv_write(m, file, png.data, png.size);
    core_free(png.data);
    core_free(rgba);
    return good;
}

static bool copy_file(cv_model *m, const char *source, char *file) {
    char path[1024];
    const char *in = m->options->in, *slash = strrchr(in, '/');
    const char *base = strrchr(source, '/'), *back = strrchr(source, '\\');
    base = back > base ? back : base;
    base = base ? base + 1 : source;
    int folder = slash ? (int)(slash - in) + 1 : 0;
    size_t size = 0;
    void *data = NULL;
    for (int attempt = 0; attempt < 2 && !data; attempt++) { // as named, then next to the model
        snprintf(path, sizeof path, "%.*s%s", folder, in, attempt ? base : source);
        data = cv_read_file(path, &size);
    }
    if (!data) {
        return false;
    }
    snprintf(file, CORE_NAME_MAX, "%.40s_%.80s", m->name, base);
    bool good = cv_write(m, file, data, size);
    core_free(data);
    return good;
}

static unsigned embedded_number(const cv_model *m, const char *source) {
    unsigned number = 0;
    if (source[0] == '*' && sscanf(source + 1, "%u", &number) == 1) {
        return number;
    }
    for (unsigned i = 0; i < m->scene->mNumTextures; i++) { // FBX names them by path
        if (m->scene->mTextures[i]->mFilename.length &&
            strcmp(m->scene->mTextures[i]->mFilename.data, source) == 0) {
            return i;
        }
    }
    return UINT32_MAX;
}

// File of a texture, written at its first use; "" when it is not to be had.
static void take_texture(cv_model *m, const char *source, char *file) {
    for (uint32_t i = 0; i < m->texture_count; i++) {
        if (strcmp(m->texture[i].source, source) == 0) {
            memcpy(file, m->texture[i].file, CORE_NAME_MAX);
            return;
        }
    }
    unsigned number = embedded_number(m, source);
    bool good = number < m->scene->mNumTextures
                    ? write_embedded(m, m->scene->mTextures[number], number, file)
                    : copy_file(m, source, file);
    if (!good) {
        file[0] = 0;
        cv_note_add(m, "dropped", "texture \"%s\": the file is not there", source);
    }
    m->texture = core_realloc(m->texture, m->texture_count * sizeof *m->texture,
                              (m->texture_count + 1) * sizeof *m->texture);
    cv_texture *t = &m->texture[m->texture_count++];
    snprintf(t->source, sizeof t->source, "%s", source);
    memcpy(t->file, file, CORE_NAME_MAX);
}

static void image_of(cv_model *m, const struct aiMaterial *a, enum aiTextureType type,
                     char file[CORE_NAME_MAX]) {
    struct aiString path;
    if (!file[0] && aiGetMaterialTexture(a, type, 0, &path, NULL, NULL, NULL, NULL, NULL, NULL) ==
                        aiReturn_SUCCESS) {
        take_texture(m, path.data, file);
    }
}

static float number_of(const struct aiMaterial *a, const char *key, unsigned type, unsigned index,
                       float fallback) {
    ai_real v = fallback;
    return aiGetMaterialFloatArray(a, key, type, index, &v, NULL) == aiReturn_SUCCESS ? v
                                                                                      : fallback;
}

static void alpha_of(const struct aiMaterial *a, core_material_data *out) {
    struct aiString mode;
    if (aiGetMaterialString(a, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS) {
        out->alpha_mode = strcmp(mode.data, "MASK") == 0    ? 1
                          : strcmp(mode.data, "BLEND") == 0 ? 2
                                                            : 0;
    } else if (out->base_color[3] < 1) {
        out->alpha_mode = 2;
    }
    out->alpha_cutoff = number_of(a, AI_MATKEY_GLTF_ALPHACUTOFF, 0.5f);
}

static void read_material(cv_model *m, const struct aiMaterial *a, core_material_data *out) {
    struct aiString name;
    struct aiColor4D c;
    *out = (core_material_data){
        .base_color = {1, 1, 1, 1}, .normal_scale = 1, .occlusion_strength = 1};
    snprintf(out->name, sizeof out->name, "%.127s",
             aiGetMaterialString(a, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS ? name.data : "");
    if (aiGetMaterialColor(a, AI_MATKEY_BASE_COLOR, &c) == aiReturn_SUCCESS ||
        aiGetMaterialColor(a, AI_MATKEY_COLOR_DIFFUSE, &c) == aiReturn_SUCCESS) {
        memcpy(out->base_color, (float[]){c.r, c.g, c.b, c.a}, sizeof out->base_color);
    }
    if (aiGetMaterialColor(a, AI_MATKEY_COLOR_EMISSIVE, &c) == aiReturn_SUCCESS) {
        memcpy(out->emissive, (float[]){c.r, c.g, c.b}, sizeof out->emissive);
    }
    out->base_color[3] *= number_of(a, AI_MATKEY_OPACITY, 1);
    out->metallic = number_of(a, AI_MATKEY_METALLIC_FACTOR, 0);
    out->roughness = number_of(a, AI_MATKEY_ROUGHNESS_FACTOR, 0.8f);
    int two_sided = 0;
    aiGetMaterialIntegerArray(a, AI_MATKEY_TWOSIDED, &two_sided, NULL);
    out->double_sided = two_sided != 0;
    alpha_of(a, out);
    image_of(m, a, aiTextureType_BASE_COLOR, out->base_color_image);
    image_of(m, a, aiTextureType_DIFFUSE, out->base_color_image);
    image_of(m, a, aiTextureType_NORMALS, out->normal_image);
    image_of(m, a, aiTextureType_UNKNOWN, out->metallic_roughness_image); // where glTF's goes
    image_of(m, a, aiTextureType_LIGHTMAP, out->occlusion_image);
    image_of(m, a, aiTextureType_EMISSIVE, out->emissive_image);
}

bool cv_materials_read(cv_model *m) {
    uint32_t n = m->scene->mNumMaterials;
    m->out.material = core_alloc((n + 1) * sizeof *m->out.material);
    m->out.material_count = n;
    for (uint32_t i = 0; i < n && !m->failed; i++) {
        cv_progress(m, "materials", i, n);
        read_material(m, m->scene->mMaterials[i], &m->out.material[i]);
    }
    return !m->failed;
}
