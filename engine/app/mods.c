// Which mods a run has: those of the command line, then the folders in mods/ of the game's folder.
#include "app/run.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool add_mod(app_run *r, const char *folder) {
    struct stat mine, other;
    for (uint32_t i = 0; stat(folder, &mine) == 0 && i < r->mod_count; i++) {
        if (stat(r->mod[i], &other) == 0 && mine.st_dev == other.st_dev &&
            mine.st_ino == other.st_ino) {
            return true; // named twice
        }
    }
    if (r->mod_count == APP_MAX_MODS || strlen(folder) >= sizeof r->mod[0]) {
        return core_fail("mod %s: at most %d mods, with paths of at most %zu bytes", folder,
                         APP_MAX_MODS, sizeof r->mod[0] - 1);
    }
    strcpy(r->mod[r->mod_count++], folder);
    return true;
}

static int is_mod(const struct dirent *entry) { return entry->d_name[0] != '.'; }

static int by_name(const struct dirent **a, const struct dirent **b) {
    return strcmp((*a)->d_name, (*b)->d_name);
}

bool app_mods_find(app_run *r) {
    bool good = true;
    for (uint32_t i = 0; i < r->opt->mod_count; i++) {
        good = good && add_mod(r, r->opt->mod[i]);
    }
    char folder[APP_PATH_MAX + 8], path[APP_PATH_MAX + 280];
    struct dirent **entry = NULL;
    snprintf(folder, sizeof folder, "%s/mods", r->path.folder);
    int count = r->path.is_game ? scandir(folder, &entry, is_mod, by_name) : 0;
    for (int i = 0; i < count; i++) {
        struct stat info;
        snprintf(path, sizeof path, "%s/%s/mod.lua", folder, entry[i]->d_name);
        bool found = stat(path, &info) == 0;
        path[strlen(path) - strlen("/mod.lua")] = 0;
        good = good && (!found || add_mod(r, path));
        free(entry[i]);
    }
    free(entry);
    return good;
}
