// Files with which a mod hides the game's: what they may be, and who wins where two mods have one.
#include "core/log.h"
#include "script/internal.h"
#include "script/mod.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum { DEPTH = 16, PATH = 1024 };

// Called for each file with its path below the assets; false ends the walk.
typedef bool asset_visit(const script_mod *m, const char *below);

// Code comes from main.lua alone: names that trusted code could load or run are refused, and links.
static bool allowed(const char *path, const char *name, int depth, struct stat *info) {
    size_t length = strlen(name);
    bool code = length > 4 && strcasecmp(name + length - 4, ".lua") == 0;
    bool shaders = depth == 0 && (strcmp(name, "shaders") == 0 || strcmp(name, "corsac") == 0);
    return (depth < DEPTH && !code && !shaders && lstat(path, info) == 0 &&
            !S_ISLNK(info->st_mode)) ||
           core_fail("mod: %s: assets hold no .lua files, links, or folders shaders and corsac",
                     path);
}

static bool walk(const script_mod *m, const char *below, int depth, asset_visit *visit) {
    char folder[PATH];
    snprintf(folder, sizeof folder, "%s/assets%s", m->dir, below);
    DIR *entries = opendir(folder);
    bool good = true;
    for (struct dirent *entry; good && entries && (entry = readdir(entries));) {
        const char *name = entry->d_name;
        char path[PATH + 256], inside[PATH];
        struct stat info;
        if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0) {
            continue;
        }
        snprintf(path, sizeof path, "%s/%s", folder, name);
        if ((size_t)snprintf(inside, sizeof inside, "%s/%s", below, name) >= sizeof inside) {
            good = core_fail("mod: %s: the path is too long", path);
        } else if (allowed(path, name, depth, &info)) {
            good = S_ISDIR(info.st_mode) ? walk(m, inside, depth + 1, visit) : visit(m, inside);
        } else {
            good = false;
        }
    }
    if (entries) {
        closedir(entries);
    }
    return good;
}

static bool accept(const script_mod *m, const char *below) {
    (void)m;
    (void)below;
    return true;
}

// The nearest mod before this one that has the file too loses it, and is named.
static bool tell_conflict(const script_mod *m, const char *below) {
    for (int i = m->index - 1; i >= 0; i--) {
        const script_mod *other = m->game->mods[i];
        char path[PATH * 2];
        struct stat info;
        snprintf(path, sizeof path, "%s/assets%s", other->dir, below);
        if (stat(path, &info) == 0) {
            core_log(CORE_LOG_WARN, "mods %s and %s both have assets%s; %s wins", other->name,
                     m->name, below, m->name);
            break;
        }
    }
    return true;
}

bool script_mod_check_assets(const script_mod *m) { return walk(m, "", 0, accept); }

bool script_mod_mount_assets(script_mod *m) {
    char assets[600];
    struct stat info;
    snprintf(assets, sizeof assets, "%s/assets", m->dir);
    return stat(assets, &info) != 0 ||
           (walk(m, "", 0, tell_conflict) &&
            core_vfs_mount(scene_vfs(m->game->scene), assets, "", false));
}
