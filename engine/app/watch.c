// Hot reload of what scripts do not hold: which files matter, and whether the new ones are whole.
#include "app/files.h"
#include "asset/asset.h"
#include "core/log.h"

#include <string.h>

static bool ends_in(const char *path, const char *end) {
    size_t length = strlen(path), bytes = strlen(end);
    return length > bytes && strcmp(path + length - bytes, end) == 0;
}

// Decodes the file and drops the result. CAN2 clips are the anim room's own: their scene tells.
static bool is_whole(core_vfs *vfs, const char *path) {
    void *data = NULL;
    if (ends_in(path, ".cmodel")) {
        data = asset_model_load(vfs, path);
    } else if (ends_in(path, ".cmesh")) {
        data = asset_mesh_load(vfs, path);
    } else if (ends_in(path, ".cskel")) {
        data = asset_skeleton_load(vfs, path);
    } else if (ends_in(path, ".wav") || ends_in(path, ".ogg")) {
        data = asset_sound_load(vfs, path);
    } else {
        size_t size;
        data = core_vfs_read(vfs, path, &size);
    }
    core_free(data);
    return data != NULL;
}

static bool matters(const char *path) {
    static const char *const ends[] = {".cmodel", ".cmesh", ".cskel", ".canim", ".wav", ".ogg"};
    for (size_t i = 0; i < CORE_COUNT_OF(ends); i++) {
        if (ends_in(path, ends[i])) {
            return true;
        }
    }
    return false;
}

bool app_assets_changed(core_vfs *vfs) {
    char path[CORE_VFS_PATH_MAX];
    bool anew = false;
    while (core_vfs_changed(vfs, path)) {
        if (!matters(path)) {
            continue;
        }
        bool whole = is_whole(vfs, path);
        core_log(CORE_LOG_INFO,
                 whole ? "%s changed: the scene starts anew"
                       : "%s changed and cannot be read: the scene goes on as it is",
                 path);
        anew |= whole;
    }
    return anew;
}
