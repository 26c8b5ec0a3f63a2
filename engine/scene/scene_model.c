// Models: the parts of a .cmodel loaded into the rooms, shared by every entity that shows them.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "asset/asset.h"
#include "core/hash.h"
#include "core/nearest.h"
#include "scene/scene_internal.h"

#define MODELS_MAX 4096u

typedef struct model_parts {
    char path[CORE_NAME_MAX];
    uint32_t mesh_count, material_count, clip_count;
    gfx_mesh *mesh;
    gfx_material *mesh_material; // [mesh_count]
    bool *skinned;
    gfx_material *material;
    anim_clip *clip;
    char (*clip_name)[CORE_NAME_MAX];
    anim_skeleton skeleton;
} model_parts;

#define SCENE_MODEL_COLUMNS(X) X(void *, parts, 0)
CORE_COLUMNS_DECLARE(model_columns, SCENE_MODEL_COLUMNS)
CORE_COLUMNS_DEFINE(model_columns, SCENE_MODEL_COLUMNS)
struct scene_models {
    model_columns columns;
};

static void free_parts(model_parts *p) {
    core_free(p->mesh);
    core_free(p->mesh_material);
    core_free(p->skinned);
    core_free(p->material);
    core_free(p->clip);
    core_free(p->clip_name);
    core_free(p);
}

// Takes back what a failed load had already put into the rooms.
static void unload(scene *s, model_parts *p) {
    for (uint32_t i = 0; i < p->mesh_count; i++) {
        if (!core_handle_is_null(p->mesh[i])) {
            gfx_mesh_destroy(s->gfx, p->mesh[i]);
        }
    }
    for (uint32_t i = 0; i < p->clip_count; i++) {
        if (!core_handle_is_null(p->clip[i])) {
            anim_clip_destroy(s->anim, p->clip[i]);
        }
    }
    if (!core_handle_is_null(p->skeleton)) {
        anim_skeleton_destroy(s->anim, p->skeleton);
    }
    free_parts(p);
}

static bool load_skeleton(scene *s, const char *path, model_parts *p) {
    core_skeleton_data *data = asset_skeleton_load(s->vfs, path);
    if (!data) {
        return false;
    }
    p->skeleton = anim_skeleton_create(scene_anim(s), data);
    core_free(data);
    return !core_handle_is_null(p->skeleton);
}

static bool load_clip(scene *s, const asset_model_clip *from, model_parts *p, uint32_t i) {
    size_t size = 0;
    void *bytes = core_vfs_read(s->vfs, from->path, &size);
    if (!bytes) {
        return false;
    }
    bool packed = size >= 4 && memcmp(bytes, "CAN2", 4) == 0;
    core_clip_data *data = packed ? NULL : asset_clip_decode(bytes, size, from->path);
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = data;
    desc.packed = packed ? bytes : NULL;
    desc.packed_size = size;
    desc.skeleton = p->skeleton;
    if (data || packed) {
        p->clip[i] = anim_clip_create(scene_anim(s), &desc);
    }
    core_free(bytes);
    memcpy(p->clip_name[i], from->name, CORE_NAME_MAX);
    core_free(data);
    return !core_handle_is_null(p->clip[i]);
}

static bool load_mesh(scene *s, const asset_model_mesh *from, model_parts *p, uint32_t i) {
    core_mesh_data *data = asset_mesh_load(s->vfs, from->path);
    if (!data) {
        return false;
    }
    p->mesh[i] = gfx_mesh_create(scene_gfx(s), data);
    p->skinned[i] = data->joint != NULL;
    p->mesh_material[i] = from->material < 0 ? CORE_NULL_HANDLE : p->material[from->material];
    core_free(data);
    return !core_handle_is_null(p->mesh[i]);
}

static bool load_parts(scene *s, const asset_model *model, model_parts *p) {
    for (uint32_t i = 0; i < model->material_count; i++) {
        gfx_material_desc desc = gfx_material_desc_default();
        desc.data = model->material[i];
        p->material[i] = gfx_material_create(scene_gfx(s), &desc);
    }
    for (uint32_t i = 0; i < model->mesh_count; i++) {
        if (!load_mesh(s, &model->mesh[i], p, i)) {
            return false;
        }
    }
    if (model->skeleton[0] && !load_skeleton(s, model->skeleton, p)) {
        return false;
    }
    if (model->clip_count && !model->skeleton[0]) {
        return core_fail("%s: model: it has clips and no skeleton", p->path);
    }
    for (uint32_t i = 0; i < model->clip_count; i++) {
        if (!load_clip(s, &model->clip[i], p, i)) {
            return false;
        }
    }
    return true;
}

static model_parts *allocate(const asset_model *model, const char *path) {
    model_parts *p = core_alloc(sizeof *p);
    memcpy(p->path, path, strlen(path) + 1);
    p->mesh_count = model->mesh_count;
    p->material_count = model->material_count;
    p->clip_count = model->clip_count;
    p->mesh = core_alloc((p->mesh_count + 1) * sizeof *p->mesh);
    p->mesh_material = core_alloc((p->mesh_count + 1) * sizeof *p->mesh_material);
    p->skinned = core_alloc((p->mesh_count + 1) * sizeof *p->skinned);
    p->material = core_alloc((p->material_count + 1) * sizeof *p->material);
    p->clip = core_alloc((p->clip_count + 1) * sizeof *p->clip);
    p->clip_name = core_alloc((p->clip_count + 1) * sizeof *p->clip_name);
    return p;
}

static scene_model find_loaded(const scene *s, const char *path) {
    const model_columns *c = s->models ? &s->models->columns : NULL;
    for (uint32_t row = 0; c && row < core_columns_count(&c->set); row++) {
        if (strcmp(((const model_parts *)c->parts[row])->path, path) == 0) {
            return core_columns_handle(&c->set, row);
        }
    }
    return CORE_NULL_HANDLE;
}

static bool open_models(scene *s) {
    if (s->models) {
        return true;
    }
    s->models = core_alloc(sizeof *s->models);
    return model_columns_init(&s->models->columns, "scene.models", MODELS_MAX);
}

static bool is_model_file(const char *path) {
    size_t n = strlen(path);
    return n > 7 && strcmp(path + n - 7, ".cmodel") == 0;
}

// "walk cycle.v2.glb" -> "walk_cycle_v2", the name that the converter gives its files.
static void clean_stem(const char *path, char out[CORE_NAME_MAX]) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const char *dot = strrchr(name, '.');
    size_t length = dot && dot != name ? (size_t)(dot - name) : strlen(name), n = 0;
    for (size_t i = 0; i < length && n < 63; i++) {
        char c = name[i];
        bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                     c == '-' || c == '_';
        if (plain || (n > 0 && out[n - 1] != '_')) {
            out[n++] = plain ? c : '_';
        }
    }
    while (n > 1 && out[n - 1] == '_') {
        n--;
    }
    out[n] = 0;
}

// Any other model file is converted into the user's cache, by path and time stamp, and mounted.
static bool import_model(scene *s, const char *path, char converted[CORE_NAME_MAX]) {
    char source[4096], folder[4096], at[64], stem[CORE_NAME_MAX];
    if (!core_vfs_resolve(s->vfs, path, source, sizeof source)) {
        return core_fail("%s: no such model file", path);
    }
    uint64_t key = core_hash_mix(core_hash_string(source), core_vfs_stamp(s->vfs, path));
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    bool own = cache && cache[0] == '/';
    if (!own && !home) {
        return core_fail("%s: importing needs a cache: set XDG_CACHE_HOME or HOME", path);
    }
    snprintf(folder, sizeof folder, "%s%s/corsac/import/%016llx", own ? cache : home,
             own ? "" : "/.cache", (unsigned long long)key);
    snprintf(at, sizeof at, "import/%016llx", (unsigned long long)key);
    clean_stem(path, stem);
    snprintf(converted, CORE_NAME_MAX, "%s/%s.cmodel", at, stem);
    char file[4096 + CORE_NAME_MAX];
    snprintf(file, sizeof file, "%s/%s.cmodel", folder, stem);
    if (access(file, R_OK) != 0 && !asset_import(source, folder)) {
        return false;
    }
    return core_vfs_mount(s->vfs, folder, at, false);
}

scene_model scene_model_load(scene *s, const char *path) {
    if (strlen(path) >= CORE_NAME_MAX || !s->vfs) {
        core_fail("%.64s: model: its path is too long, or the scene has no files", path);
        return CORE_NULL_HANDLE;
    }
    scene_model known = find_loaded(s, path);
    if (!core_handle_is_null(known) || !open_models(s)) {
        return known;
    }
    char converted[CORE_NAME_MAX];
    if (!is_model_file(path) && !import_model(s, path, converted)) {
        return CORE_NULL_HANDLE;
    }
    asset_model *model = asset_model_load(s->vfs, is_model_file(path) ? path : converted);
    if (!model) {
        return CORE_NULL_HANDLE;
    }
    model_parts *p = allocate(model, path);
    bool good = load_parts(s, model, p);
    core_free(model);
    core_handle h = good ? core_columns_add(&s->models->columns.set) : CORE_NULL_HANDLE;
    if (core_handle_is_null(h)) {
        unload(s, p);
        return h;
    }
    s->models->columns.parts[core_columns_row(&s->models->columns.set, h)] = p;
    return h;
}

void scene_models_destroy(scene *s) {
    if (!s->models) {
        return;
    }
    model_columns *c = &s->models->columns;
    for (uint32_t row = 0; row < core_columns_count(&c->set); row++) {
        free_parts(c->parts[row]);
    }
    core_columns_release(&c->set);
    core_free(s->models);
    s->models = NULL;
}

static const model_parts *look(const scene *s, scene_model model) {
    uint32_t row = s->models ? core_columns_row(&s->models->columns.set, model) : CORE_NO_ROW;
    if (row == CORE_NO_ROW) {
        core_fail("scene: this model does not exist");
        return NULL;
    }
    return s->models->columns.parts[row];
}

bool scene_model_look(const scene *s, scene_model model, scene_model_view *out) {
    const model_parts *p = look(s, model);
    if (!p) {
        return false;
    }
    *out = (scene_model_view){p->mesh_count, p->mesh, p->mesh_material, p->skinned, p->skeleton};
    return true;
}

bool scene_model_alive(const scene *s, scene_model model) {
    return s->models && core_columns_row(&s->models->columns.set, model) != CORE_NO_ROW;
}

anim_skeleton scene_model_skeleton(const scene *s, scene_model model) {
    const model_parts *p = look(s, model);
    return p ? p->skeleton : CORE_NULL_HANDLE;
}

uint32_t scene_model_clip_count(const scene *s, scene_model model) {
    const model_parts *p = look(s, model);
    return p ? p->clip_count : 0;
}

anim_clip scene_model_clip(const scene *s, scene_model model, uint32_t i) {
    const model_parts *p = look(s, model);
    return p && i < p->clip_count ? p->clip[i] : CORE_NULL_HANDLE;
}

anim_clip scene_model_find_clip(const scene *s, scene_model model, const char *name) {
    const model_parts *p = look(s, model);
    const char *names[256];
    uint32_t count = p ? CORE_MIN(p->clip_count, 256u) : 0;
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(p->clip_name[i], name) == 0) {
            return p->clip[i];
        }
        names[i] = p->clip_name[i];
    }
    if (p) {
        const char *near = core_nearest(name, names, count);
        core_fail("%s: no clip \"%s\"%s%s%s", p->path, name, near ? "; did you mean \"" : "",
                  near ? near : "", near ? "\"?" : "");
    }
    return CORE_NULL_HANDLE;
}
