// The order of the stages, files in and out, notes.
#include "convert.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void cv_note_add(cv_model *m, const char *kind, const char *fmt, ...) {
    if (m->note_count == m->note_capacity) {
        uint32_t capacity = m->note_capacity ? m->note_capacity * 2 : 32;
        m->note =
            core_realloc(m->note, m->note_capacity * sizeof *m->note, capacity * sizeof *m->note);
        m->note_capacity = capacity;
    }
    cv_note *n = &m->note[m->note_count++];
    snprintf(n->kind, sizeof n->kind, "%s", kind);
    va_list args;
    va_start(args, fmt);
    vsnprintf(n->text, sizeof n->text, fmt, args);
    va_end(args);
}

bool cv_fail(cv_model *m, const char *fmt, ...) {
    char text[512];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    m->failed = true;
    return core_fail("convert %s: %s", m->options->in, text);
}

void cv_progress(const cv_model *m, const char *what, uint32_t done, uint32_t total) {
    if (!m->options->quiet && isatty(2)) {
        fprintf(stderr, "\r%-10s %3u%%%s", what, total ? done * 100 / total : 0,
                done + 1 >= total ? "\r                \r" : "");
    }
}

void *cv_read_file(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    struct stat s;
    if (!f || fstat(fileno(f), &s) != 0 || !S_ISREG(s.st_mode)) {
        if (f) {
            fclose(f);
        }
        return NULL;
    }
    *size = (size_t)s.st_size;
    void *data = core_alloc(*size + 1);
    if (fread(data, 1, *size, f) != *size) {
        core_free(data);
        data = NULL;
    }
    fclose(f);
    return data;
}

bool cv_write(cv_model *m, const char *name, const void *data, size_t size) {
    char path[1024];
    m->bytes += size;
    if (m->options->dry_run) {
        return true;
    }
    snprintf(path, sizeof path, "%s/%s", m->options->out_dir, name);
    FILE *f = fopen(path, "wb");
    bool good = f && fwrite(data, 1, size, f) == size;
    good = (!f || fclose(f) == 0) && good;
    return good || cv_fail(m, "cannot write %s: %s", path, strerror(errno));
}

void cv_clean_name(const char *in, char *out, size_t size) {
    size_t n = 0;
    for (; *in && n + 1 < size; in++) {
        bool plain = isalnum((unsigned char)*in) || *in == '-' || *in == '_';
        if (plain || (n > 0 && out[n - 1] != '_')) {
            out[n++] = plain ? *in : '_';
        }
    }
    while (n > 1 && out[n - 1] == '_') {
        n--;
    }
    out[n] = 0;
    if (n == 0) {
        snprintf(out, size, "unnamed");
    }
}

void cv_unique_name(char *name, size_t size, bool (*taken)(const void *ctx, const char *name),
                    const void *ctx) {
    char base[CORE_NAME_MAX];
    snprintf(base, sizeof base, "%.*s", (int)CORE_MIN(size - 12, sizeof base - 12), name);
    for (uint32_t i = 2; taken(ctx, name); i++) {
        snprintf(name, size, "%s_%u", base, i);
    }
}

// Centimetres are FBX's own unit; every other format assimp reads is taken as metres.
static double unit_of(const struct aiScene *scene, const char *path) {
    const char *dot = strrchr(path, '.');
    double scale = 1;
    if (!dot || (strcmp(dot, ".fbx") != 0 && strcmp(dot, ".FBX") != 0) || !scene->mMetaData) {
        return scale;
    }
    for (unsigned i = 0; i < scene->mMetaData->mNumProperties; i++) {
        const struct aiMetadataEntry *e = &scene->mMetaData->mValues[i];
        if (strcmp(scene->mMetaData->mKeys[i].data, "UnitScaleFactor") == 0) {
            scale = e->mType == AI_DOUBLE  ? *(double *)e->mData / 100
                    : e->mType == AI_FLOAT ? (double)*(float *)e->mData / 100
                                           : scale;
        }
    }
    return scale;
}

static bool make_folder(cv_model *m) {
    char path[1024];
    int n = snprintf(path, sizeof path, "%s", m->options->out_dir);
    for (int i = 1; i <= n && n < (int)sizeof path; i++) {
        if (path[i] == '/' || path[i] == 0) {
            char kept = path[i];
            path[i] = 0;
            if (mkdir(path, 0777) != 0 && errno != EEXIST) {
                return cv_fail(m, "cannot make the folder %s: %s", path, strerror(errno));
            }
            path[i] = kept;
        }
    }
    return true;
}

static void name_output(cv_model *m) {
    char base[256];
    const char *in = m->options->in, *slash = strrchr(in, '/');
    snprintf(base, sizeof base, "%s", slash ? slash + 1 : in);
    char *dot = strrchr(base, '.');
    if (dot && dot != base) {
        *dot = 0;
    }
    cv_clean_name(base, m->name, sizeof m->name);
}

static bool run_stages(cv_model *m) {
    return cv_clips_read(m) && cv_skeleton_make(m) && cv_materials_read(m) && cv_meshes_write(m) &&
           cv_skeleton_write(m) && cv_clips_write(m) && cv_finish(m);
}

static void show_report(const cv_model *m) {
    if (m->options->quiet) {
        return;
    }
    printf("%s: %u meshes, %llu vertices, %llu triangles, %u bones, %u clips, %u materials, %u "
           "textures%s\n",
           m->options->in, m->out.mesh_count, (unsigned long long)m->vertices,
           (unsigned long long)m->triangles, m->bone_count, m->out.clip_count,
           m->out.material_count, m->texture_count,
           m->options->dry_run ? " (dry run: nothing written)" : "");
    for (uint32_t i = 0; i < m->note_count; i++) {
        printf("  %s: %s\n", m->note[i].kind, m->note[i].text);
    }
    if (!m->options->dry_run) {
        printf("  %llu bytes in %s; show it with: corsac run %s/%s.lua\n",
               (unsigned long long)m->bytes, m->options->out_dir, m->options->out_dir, m->name);
    }
}

static void free_model(cv_model *m) {
    for (uint32_t i = 0; i < m->clip_count; i++) {
        for (uint32_t k = 0; k < m->clip[i].channel_count; k++) {
            for (int c = 0; c < 3; c++) {
                core_free(m->clip[i].channel[k].curve[c].time);
                core_free(m->clip[i].channel[k].curve[c].value);
            }
        }
        core_free(m->clip[i].channel);
    }
    core_free(m->clip);
    core_free(m->bone);
    core_free(m->note);
    core_free(m->texture);
    core_free(m->out.mesh);
    core_free(m->out.material);
    core_free(m->out.clip);
}

int corsac_convert(const convert_options *o) {
    cv_model m = {.options = o};
    if (access(o->in, R_OK) != 0) {
        core_fail("convert: cannot read %s: %s", o->in, strerror(errno));
        return 2;
    }
    name_output(&m);
    if (!o->dry_run && !make_folder(&m)) {
        return 2;
    }
    m.scene = aiImportFile(o->in, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                      aiProcess_GenSmoothNormals | aiProcess_CalcTangentSpace |
                                      aiProcess_SortByPType);
    if (!m.scene || !m.scene->mRootNode) {
        core_fail("convert %s: %s", o->in, aiGetErrorString());
        return 1;
    }
    m.scale = o->scale > 0 ? o->scale : unit_of(m.scene, o->in);
    if (m.scale != 1) {
        cv_note_add(&m, "changed", "lengths scaled by %g to metres (--scale)", m.scale);
    }
    bool good = run_stages(&m);
    if (good) {
        show_report(&m);
    }
    aiReleaseImport(m.scene);
    free_model(&m);
    return good ? 0 : 1;
}

int corsac_convert_file(const char *in, const char *out_dir) {
    return corsac_convert(&(convert_options){.in = in, .out_dir = out_dir, .quiet = true});
}
