// What a run is started with: given on the command line or read from a recording, and the hashes of
// the files it is made from.
#include "app/run.h"

#include <stdio.h>
#include <string.h>

#include "core/file.h"
#include "core/hash.h"
#include "core/log.h"

// What the run starts with: from the recording, else from the command line.
bool app_start_read(app_run *r) {
    const app_options *o = r->opt;
    if (o->replay) {
        r->replay = app_replay_open(o->replay);
        if (!r->replay) {
            return app_fail(r, APP_EXIT_USAGE);
        }
        r->start = *app_replay_header(r->replay);
        return true;
    }
    app_journal_header *h = &r->start;
    snprintf(h->scene, sizeof h->scene, "%s", o->scene);
    h->seed = o->seed;
    h->dt = o->dt;
    h->width = o->size[0];
    h->height = o->size[1];
    h->headless = o->headless;
    memcpy(h->set, o->set, sizeof h->set);
    h->set_count = o->set_count;
    for (int i = 0; i < o->argc; i++) {
        if (h->argument_count == CORE_COUNT_OF(h->argument) ||
            strlen(o->argv[i]) >= sizeof h->argument[0]) {
            core_fail("corsac run: at most %zu words of %zu bytes after --",
                      CORE_COUNT_OF(h->argument), sizeof h->argument[0] - 1);
            return app_fail(r, APP_EXIT_USAGE);
        }
        strcpy(h->argument[h->argument_count++], o->argv[i]);
    }
    return true;
}

static void note_file(app_run *r, const char *name, const void *text, size_t size) {
    if (r->start.file_count < APP_MAX_FILES) {
        app_file_hash *f = &r->start.file[r->start.file_count++];
        snprintf(f->name, sizeof f->name, "%s", name);
        f->hash = core_hash(text, size, 0);
    }
}

static void hash_scene_file(app_run *r, const char *name) {
    size_t size;
    void *text = core_vfs_exists(r->vfs, name) ? core_vfs_read(r->vfs, name, &size) : NULL;
    if (text) {
        note_file(r, name, text, size);
    }
    core_free(text);
}

// A mod is known by its folder's name: where it lies is no matter of a recording.
static void hash_mod(app_run *r, const char *folder) {
    static const char *const names[] = {"mod.lua", "main.lua"};
    size_t end = strlen(folder), begin;
    while (end > 1 && folder[end - 1] == '/') {
        end--;
    }
    for (begin = end; begin > 0 && folder[begin - 1] != '/';) {
        begin--;
    }
    for (size_t i = 0; i < CORE_COUNT_OF(names); i++) {
        char path[APP_PATH_MAX], name[128];
        size_t size;
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        snprintf(name, sizeof name, "mod %.*s/%s", (int)(end - begin), folder + begin, names[i]);
        void *text = core_file_read(path, &size);
        if (text) {
            note_file(r, name, text, size);
        }
        core_free(text);
    }
}

static bool has_file(const app_journal_header *h, const app_file_hash *f) {
    for (uint32_t i = 0; i < h->file_count; i++) {
        if (strcmp(h->file[i].name, f->name) == 0 && h->file[i].hash == f->hash) {
            return true;
        }
    }
    return false;
}

// A recording of other files will most likely diverge: say so first, the check will name where.
void app_start_compare_files(app_run *r) {
    app_journal_header was = r->start;
    r->start.file_count = 0;
    hash_scene_file(r, r->path.entry);
    hash_scene_file(r, "conf.lua");
    for (uint32_t i = 0; i < r->mod_count; i++) {
        hash_mod(r, r->mod[i]);
    }
    for (uint32_t i = 0; r->replay && i < was.file_count; i++) {
        if (!has_file(&r->start, &was.file[i])) {
            core_log(CORE_LOG_WARN, "replay: '%s' is not the file that was recorded, or missing",
                     was.file[i].name);
        }
    }
    for (uint32_t i = 0; r->replay && i < r->start.file_count; i++) {
        if (!has_file(&was, &r->start.file[i])) {
            core_log(CORE_LOG_WARN, "replay: '%s' was not there when it was recorded",
                     r->start.file[i].name);
        }
    }
}
