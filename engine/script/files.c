// The player's folder: where corsac.save keeps its files.
#include "script/files.h"

#include "script/internal.h"
#include "script/json.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { SAVE_BYTES_MAX = 16 << 20 };

static bool make_folders(char *path) {
    for (char *c = path + 1;; c++) {
        if (*c == '/' || *c == 0) {
            char keep = *c;
            *c = 0;
            if (mkdir(path, 0777) != 0 && errno != EEXIST) {
                return core_fail("save: cannot make the folder %s: %s", path, strerror(errno));
            }
            *c = keep;
            if (keep == 0) {
                return true;
            }
        }
    }
}

// $CORSAC_SAVE, or $XDG_DATA_HOME/corsac/GAME, or ~/.local/share/corsac/GAME; mounted on first use
// in a file tree of its own, so that no scene file can be overwritten.
core_vfs *script_player_files(script *s) {
    if (s->save) {
        return s->save;
    }
    const char *own = getenv("CORSAC_SAVE"), *data = getenv("XDG_DATA_HOME"),
               *home = getenv("HOME");
    char path[600];
    const char *game = s->game[0] ? s->game : "game";
    if (own && *own) {
        snprintf(path, sizeof path, "%s", own);
    } else if (data && *data) {
        snprintf(path, sizeof path, "%s/corsac/%s", data, game);
    } else if (home && *home) {
        snprintf(path, sizeof path, "%s/.local/share/corsac/%s", home, game);
    } else {
        core_fail("save: neither CORSAC_SAVE, XDG_DATA_HOME nor HOME names a folder");
        return NULL;
    }
    if (!make_folders(path)) {
        return NULL;
    }
    core_vfs *files = core_vfs_create();
    if (!core_vfs_mount(files, path, "", true)) {
        core_vfs_destroy(files);
        return NULL;
    }
    s->save = files;
    return files;
}

void script_check_save_name(lua_State *L, const char *name) {
    size_t length = strlen(name);
    bool good = length > 0 && length <= 64;
    for (const char *c = name; *c; c++) {
        good = good && (isalnum((unsigned char)*c) || *c == '-' || *c == '_');
    }
    if (!good) {
        bind_error(L, "the name of a save, \"%.80s\": a name has 1 to 64 letters, digits, - or _",
                   name);
    }
}

static void push_file_name(lua_State *L, const char *name) {
    script_check_save_name(L, name);
    lua_pushfstring(L, "%s.json", name);
}

bool script_player_write(script *s, const char *name, const void *data, size_t size) {
    if (s->host.replays && s->host.replays(s->host.ctx)) {
        return true;
    }
    core_vfs *files = script_player_files(s);
    return files && core_vfs_write(files, name, data, size);
}

int script_save_write(lua_State *L) {
    script *s = lua_touserdata(L, lua_upvalueindex(1));
    push_file_name(L, luaL_checkstring(L, 1));
    char *text = script_json_write(L, 2, "corsac.save.write: data");
    bool good = script_player_write(s, lua_tostring(L, -1), text, strlen(text));
    core_free(text);
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// The file's text; NULL when there is none. Raises an error when it cannot be read.
static char *read_player_file(script *s, lua_State *L, const char *name, size_t *size) {
    core_vfs *files = script_player_files(s);
    if (!files) {
        bind_fail(L);
    }
    if (!core_vfs_exists(files, name)) {
        return NULL;
    }
    char *text = core_vfs_read(files, name, size);
    bool large = text && *size > SAVE_BYTES_MAX;
    if (!text || large) {
        core_free(text);
        bind_error(L, "corsac.save.read: %s: %s", name,
                   large ? "larger than 16 MiB" : core_last_error());
    }
    return text;
}

char *script_player_read(script *s, lua_State *L, const char *name, size_t *size) {
    const script_host *host = &s->host;
    if (host->replays && host->replays(host->ctx)) {
        const char *recorded = host->saved(host->ctx, name, size);
        char *copy = recorded ? core_alloc(*size + 1) : NULL;
        if (copy) {
            memcpy(copy, recorded, *size);
        }
        return copy;
    }
    char *text = read_player_file(s, L, name, size);
    if (host->note_saved) {
        host->note_saved(host->ctx, name, text, text ? *size : 0);
    }
    return text;
}

int script_save_read(lua_State *L) {
    script *s = lua_touserdata(L, lua_upvalueindex(1));
    push_file_name(L, luaL_checkstring(L, 1));
    const char *name = lua_tostring(L, -1);
    size_t size = 0;
    char *text = script_player_read(s, L, name, &size);
    if (!text) {
        return 0;
    }
    bool good = script_json_read(L, text, size);
    core_free(text);
    if (!good) {
        bind_error(L, "corsac.save.read: %s: %s", name, core_last_error());
    }
    return 1;
}
