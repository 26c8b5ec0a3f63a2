// .cmodel: the parts of one model and their materials, as JSON. Paths in the file are file names
// next to it; in the struct they are virtual paths.
#include "asset/asset.h"
#include "asset/bytes.h"
#include "core/json.h"

#include <cJSON.h>
#include <stdio.h>
#include <string.h>

#define MODEL_MAX_PARTS 4096

typedef struct model_reader {
    const char *path;
    char folder[CORE_NAME_MAX];
    bool failed;
} model_reader;

static void fail(model_reader *r, const char *what, const char *expected) {
    if (!r->failed) {
        core_fail("%s: model: %s: expected %s", r->path, what, expected);
    }
    r->failed = true;
}

static bool fits(char out[CORE_NAME_MAX], const char *folder, const char *name) {
    int n = snprintf(out, CORE_NAME_MAX, "%s%s", folder, name);
    return n >= 0 && n < CORE_NAME_MAX;
}

// A file name next to the model; separators and ".." would leave its folder.
static void read_path(model_reader *r, const cJSON *object, const char *key,
                      char out[CORE_NAME_MAX]) {
    const cJSON *v = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!v || cJSON_IsNull(v)) {
        return;
    }
    if (!cJSON_IsString(v) || strstr(v->valuestring, "..") || strchr(v->valuestring, '\\') ||
        v->valuestring[0] == '/' ||
        !fits(out, v->valuestring[0] ? r->folder : "", v->valuestring)) {
        fail(r, key, "a short file name inside the model's folder");
    }
}

static void read_text(model_reader *r, const cJSON *object, const char *key,
                      char out[CORE_NAME_MAX]) {
    const cJSON *v = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!cJSON_IsString(v) || !fits(out, "", v->valuestring)) {
        fail(r, key, "a text of at most 127 bytes");
    }
}

static float read_number(model_reader *r, const cJSON *object, const char *key, float fallback) {
    const cJSON *v = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!v) {
        return fallback;
    }
    if (!cJSON_IsNumber(v) || !(v->valuedouble > -1e9 && v->valuedouble < 1e9)) {
        fail(r, key, "a number");
        return fallback;
    }
    return (float)v->valuedouble;
}

static void read_color(model_reader *r, const cJSON *object, const char *key, float *out, int n) {
    const cJSON *v = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!v) {
        return;
    }
    if (!cJSON_IsArray(v) || cJSON_GetArraySize(v) != n) {
        fail(r, key, n == 4 ? "4 numbers" : "3 numbers");
        return;
    }
    for (int i = 0; i < n; i++) {
        const cJSON *item = cJSON_GetArrayItem(v, i);
        if (!cJSON_IsNumber(item) || !(item->valuedouble > -1e9 && item->valuedouble < 1e9)) {
            fail(r, key, "numbers");
            return;
        }
        out[i] = (float)item->valuedouble;
    }
}

static const cJSON *read_list(model_reader *r, const cJSON *root, const char *key, uint32_t *n) {
    const cJSON *v = cJSON_GetObjectItemCaseSensitive(root, key);
    *n = 0;
    if (!v) {
        return NULL;
    }
    if (!cJSON_IsArray(v) || cJSON_GetArraySize(v) > MODEL_MAX_PARTS) {
        fail(r, key, "a list of at most 4096 parts");
        return NULL;
    }
    *n = (uint32_t)cJSON_GetArraySize(v);
    return v;
}

static void read_material(model_reader *r, const cJSON *o, core_material_data *m) {
    static const char *const modes[] = {"opaque", "mask", "blend"};
    *m = (core_material_data){.base_color = {1, 1, 1, 1}};
    read_text(r, o, "name", m->name);
    read_color(r, o, "baseColor", m->base_color, 4);
    read_color(r, o, "emissive", m->emissive, 3);
    m->metallic = read_number(r, o, "metallic", 0);
    m->roughness = read_number(r, o, "roughness", 1);
    m->normal_scale = read_number(r, o, "normalScale", 1);
    m->occlusion_strength = read_number(r, o, "occlusionStrength", 1);
    m->alpha_cutoff = read_number(r, o, "alphaCutoff", 0.5f);
    const cJSON *mode = cJSON_GetObjectItemCaseSensitive(o, "alphaMode");
    for (int i = 0; i < 3 && cJSON_IsString(mode); i++) {
        m->alpha_mode = strcmp(mode->valuestring, modes[i]) == 0 ? i : m->alpha_mode;
    }
    m->double_sided = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(o, "doubleSided"));
    read_path(r, o, "baseColorImage", m->base_color_image);
    read_path(r, o, "normalImage", m->normal_image);
    read_path(r, o, "metallicRoughnessImage", m->metallic_roughness_image);
    read_path(r, o, "occlusionImage", m->occlusion_image);
    read_path(r, o, "emissiveImage", m->emissive_image);
}

static void read_mesh(model_reader *r, const cJSON *o, asset_model *model, uint32_t i) {
    asset_model_mesh *m = &model->mesh[i];
    read_path(r, o, "file", m->path);
    if (!m->path[0]) {
        fail(r, "mesh file", "a file name");
    }
    float material = read_number(r, o, "material", -1);
    if (!(material >= -1 && material < (float)model->material_count)) {
        fail(r, "mesh material", "-1 or the number of a material");
        material = -1;
    }
    m->material = (int32_t)material;
    m->skinned = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(o, "skinned"));
}

static asset_model *read_model(model_reader *r, const cJSON *root) {
    uint32_t meshes, materials, clips;
    const cJSON *mesh = read_list(r, root, "meshes", &meshes);
    const cJSON *material = read_list(r, root, "materials", &materials);
    const cJSON *clip = read_list(r, root, "clips", &clips);
    asset_block block = asset_block_make(asset_round(sizeof(asset_model)) +
                                         asset_round(meshes * sizeof(asset_model_mesh)) +
                                         asset_round(materials * sizeof(core_material_data)) +
                                         asset_round(clips * sizeof(asset_model_clip)));
    asset_model *m = asset_block_take(&block, sizeof *m);
    m->mesh_count = meshes;
    m->material_count = materials;
    m->clip_count = clips;
    m->mesh = asset_block_take(&block, meshes * sizeof *m->mesh);
    m->material = asset_block_take(&block, materials * sizeof *m->material);
    m->clip = asset_block_take(&block, clips * sizeof *m->clip);
    uint32_t i = 0;
    const cJSON *o;
    cJSON_ArrayForEach(o, material) { read_material(r, o, &m->material[i++]); }
    i = 0;
    cJSON_ArrayForEach(o, mesh) { read_mesh(r, o, m, i++); }
    i = 0;
    cJSON_ArrayForEach(o, clip) {
        read_text(r, o, "name", m->clip[i].name);
        read_path(r, o, "file", m->clip[i++].path);
    }
    read_path(r, root, "skeleton", m->skeleton);
    return m;
}

asset_model *asset_model_decode(const void *bytes, size_t size, const char *path) {
    model_reader r = {.path = path ? path : "(memory)"};
    const char *slash = strrchr(r.path, '/');
    size_t folder = slash ? (size_t)(slash - r.path) + 1 : 0;
    if (folder >= CORE_NAME_MAX) {
        core_fail("%s: model: its folder's path is longer than %d bytes", r.path, CORE_NAME_MAX);
        return NULL;
    }
    memcpy(r.folder, r.path, folder);
    cJSON *root = cJSON_ParseWithLength(bytes, size);
    if (!cJSON_IsObject(root)) {
        cJSON_Delete(root);
        core_fail("%s: model: not a JSON object", r.path);
        return NULL;
    }
    asset_model *m = read_model(&r, root);
    cJSON_Delete(root);
    if (r.failed) {
        core_free(m);
        return NULL;
    }
    return m;
}

static void *decode_any(const void *bytes, size_t size, const char *path) {
    return asset_model_decode(bytes, size, path);
}

asset_model *asset_model_load(core_vfs *vfs, const char *path) {
    return asset_load(vfs, path, decode_any);
}

static const char *file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void write_color(core_json *j, const char *key, const float *v, int n) {
    core_json_array(j, key);
    for (int i = 0; i < n; i++) {
        core_json_number(j, NULL, v[i]);
    }
    core_json_end_array(j);
}

static void write_image(core_json *j, const char *key, const char *path) {
    if (path[0]) {
        core_json_string(j, key, file_name(path));
    }
}

static void write_material(core_json *j, const core_material_data *m) {
    static const char *const modes[] = {"opaque", "mask", "blend"};
    core_json_object(j, NULL);
    core_json_string(j, "name", m->name);
    write_color(j, "baseColor", m->base_color, 4);
    write_color(j, "emissive", m->emissive, 3);
    core_json_number(j, "metallic", m->metallic);
    core_json_number(j, "roughness", m->roughness);
    core_json_number(j, "normalScale", m->normal_scale);
    core_json_number(j, "occlusionStrength", m->occlusion_strength);
    core_json_number(j, "alphaCutoff", m->alpha_cutoff);
    core_json_string(j, "alphaMode",
                     modes[m->alpha_mode >= 0 && m->alpha_mode < 3 ? m->alpha_mode : 0]);
    core_json_bool(j, "doubleSided", m->double_sided);
    write_image(j, "baseColorImage", m->base_color_image);
    write_image(j, "normalImage", m->normal_image);
    write_image(j, "metallicRoughnessImage", m->metallic_roughness_image);
    write_image(j, "occlusionImage", m->occlusion_image);
    write_image(j, "emissiveImage", m->emissive_image);
    core_json_end_object(j);
}

char *asset_model_encode(const asset_model *model, size_t *size) {
    core_json j;
    core_json_init(&j, true);
    core_json_object(&j, NULL);
    write_image(&j, "skeleton", model->skeleton);
    core_json_array(&j, "materials");
    for (uint32_t i = 0; i < model->material_count; i++) {
        write_material(&j, &model->material[i]);
    }
    core_json_end_array(&j);
    core_json_array(&j, "meshes");
    for (uint32_t i = 0; i < model->mesh_count; i++) {
        core_json_object(&j, NULL);
        core_json_string(&j, "file", file_name(model->mesh[i].path));
        core_json_int(&j, "material", model->mesh[i].material);
        core_json_bool(&j, "skinned", model->mesh[i].skinned);
        core_json_end_object(&j);
    }
    core_json_end_array(&j);
    core_json_array(&j, "clips");
    for (uint32_t i = 0; i < model->clip_count; i++) {
        core_json_object(&j, NULL);
        core_json_string(&j, "name", model->clip[i].name);
        core_json_string(&j, "file", file_name(model->clip[i].path));
        core_json_end_object(&j);
    }
    core_json_end_array(&j);
    core_json_end_object(&j);
    size_t length = strlen(j.text);
    char *text = core_alloc(length + 2);
    memcpy(text, j.text, length);
    text[length] = '\n';
    *size = length + 1;
    core_json_release(&j);
    return text;
}
