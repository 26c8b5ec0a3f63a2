// Real paths: output files, the scene's folder, the engine's own data.
#ifndef APP_FILES_H
#define APP_FILES_H

#include "core/vfs.h"

#define APP_PATH_MAX 1024

// Makes the parent folders of `path` and finds out, without keeping a new file, whether it can be
// written. False + core_fail (path and system's reason).
bool app_output_ready(const char *path);
typedef struct app_scene_path {
    char folder[APP_PATH_MAX]; // to be mounted
    char entry[256];           // virtual path in it
    bool is_game;              // the scene is a folder: it may have conf.lua and mods
    bool has_conf;
} app_scene_path;
// False + core_fail when there is no such scene (names the nearest file there).
bool app_find_scene(const char *given, app_scene_path *out);

// Folder that holds assets/: $CORSAC_HOME, else beside or above the program, else
// ../share/corsac. False when there is none.
bool app_home(char *out, size_t size);

// Whether a model, its parts or a sound changed since it was read, and the new file can be read. A
// broken one is logged; the old goes on.
bool app_assets_changed(core_vfs *vfs);

#endif
