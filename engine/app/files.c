#include "app/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file.h"
#include "core/nearest.h"

static bool is_folder(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

static bool is_file(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 && S_ISREG(st.st_mode);
}

bool app_output_ready(const char *path) {
    if (!core_make_parents(path)) {
        return false;
    }
    bool existed = access(path, F_OK) == 0;
    int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0) {
        return core_fail("cannot write '%s': %s", path, strerror(errno));
    }
    close(fd);
    if (!existed) {
        unlink(path);
    }
    return true;
}

static bool is_scene_name(const char *folder, const struct dirent *entry) {
    size_t length = strlen(entry->d_name);
    char path[APP_PATH_MAX * 2];
    if (length > 4 && strcmp(entry->d_name + length - 4, ".lua") == 0) {
        return true;
    }
    snprintf(path, sizeof path, "%s/%s/main.lua", folder, entry->d_name);
    return is_file(path);
}

static bool no_such_scene(const char *given, const char *folder, const char *name) {
    char best[256] = "";
    uint32_t least = 0;
    DIR *d = opendir(folder);
    for (struct dirent *entry = d ? readdir(d) : NULL; entry; entry = readdir(d)) {
        uint32_t distance = core_name_distance(name, entry->d_name);
        if (is_scene_name(folder, entry) &&
            (!best[0] || distance < least ||
             (distance == least && strcmp(entry->d_name, best) < 0))) {
            least = distance;
            snprintf(best, sizeof best, "%s", entry->d_name);
        }
    }
    if (d) {
        closedir(d);
    }
    if (best[0] && least <= 3) {
        return core_fail("no scene '%s'; did you mean '%s' in '%s'?", given, best, folder);
    }
    return core_fail("no scene '%s': expected a .lua file or a folder with main.lua", given);
}

bool app_find_scene(const char *given, app_scene_path *out) {
    *out = (app_scene_path){0};
    size_t length = strlen(given);
    while (length > 1 && given[length - 1] == '/') {
        length--;
    }
    if (length == 0 || length >= sizeof out->folder - 16) {
        return core_fail("no scene '%.60s': expected a .lua file or a folder with main.lua", given);
    }
    memcpy(out->folder, given, length);
    char path[APP_PATH_MAX + 16];
    if (is_folder(out->folder)) {
        snprintf(path, sizeof path, "%s/main.lua", out->folder);
        if (!is_file(path)) {
            return core_fail("folder '%s' has no main.lua; `corsac new DIR` makes a project",
                             out->folder);
        }
        strcpy(out->entry, "main.lua");
        out->is_game = true;
        snprintf(path, sizeof path, "%s/conf.lua", out->folder);
        out->has_conf = is_file(path);
        return true;
    }
    char *slash = strrchr(out->folder, '/');
    const char *name = slash ? slash + 1 : out->folder;
    if (strlen(name) >= sizeof out->entry) {
        return core_fail("scene '%s': file name is too long", given);
    }
    strcpy(out->entry, name);
    if (!slash) {
        strcpy(out->folder, ".");
    } else if (slash == out->folder) {
        slash[1] = 0;
    } else {
        *slash = 0;
    }
    return is_file(given) || no_such_scene(given, out->folder, out->entry);
}

static bool holds_assets(const char *folder, const char *below, char *out, size_t size) {
    char path[APP_PATH_MAX];
    if ((size_t)snprintf(path, sizeof path, "%s%s/assets/shaders", folder, below) >= sizeof path ||
        !is_folder(path)) {
        return false;
    }
    return (size_t)snprintf(out, size, "%s%s", folder, below) < size;
}

bool app_home(char *out, size_t size) {
    const char *given = getenv("CORSAC_HOME");
    if (given && given[0]) {
        return holds_assets(given, "", out, size);
    }
    static const char *const places[] = {"", "/..", "/../..", "/../share/corsac"};
    char self[APP_PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length <= 0) {
        return false;
    }
    self[length] = 0;
    *strrchr(self, '/') = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(places); i++) {
        if (holds_assets(self, places[i], out, size)) {
            return true;
        }
    }
    return false;
}
