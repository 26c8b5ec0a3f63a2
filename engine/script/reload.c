// Hot reload: when a file of the game changed, its code runs anew while the world stays as it is.
#include "core/log.h"
#include "script/internal.h"

#include <stdio.h>
#include <string.h>

void script_watch_file(script *s, const char *path) {
    uint64_t stamp = core_vfs_stamp(scene_vfs(s->scene), path);
    for (int i = 0; i < s->watched_count; i++) {
        if (strcmp(s->watched[i].path, path) == 0) {
            s->watched[i].stamp = stamp;
            return;
        }
    }
    if (s->watched_count < SCRIPT_WATCH_MAX && strlen(path) < sizeof s->watched[0].path) {
        script_watched *w = &s->watched[s->watched_count++];
        snprintf(w->path, sizeof w->path, "%s", path);
        w->stamp = stamp;
    }
}

// A file that is gone (an editor writes it anew) counts once it is back.
static const char *changed_file(script *s) {
    const char *changed = NULL;
    for (int i = 0; i < s->watched_count; i++) {
        script_watched *w = &s->watched[i];
        uint64_t stamp = core_vfs_stamp(scene_vfs(s->scene), w->path);
        if (stamp != 0 && stamp != w->stamp) {
            w->stamp = stamp;
            changed = changed ? changed : w->path;
        }
    }
    return changed;
}

static bool run_again(script *s) {
    lua_State *L = s->L;
    lua_rawgeti(L, LUA_REGISTRYINDEX, s->reload_ref);
    lua_pushstring(L, s->path);
    if (!script_call(s, BIND_TOP, 1, 2)) {
        return false;
    }
    bool good = lua_toboolean(L, -2);
    if (!good) { // the text says why; the old code goes on
        const char *why = lua_tostring(L, -1);
        core_log(CORE_LOG_ERROR, "%s", why ? why : "reload failed");
        lua_pop(L, 2);
        return false;
    }
    lua_pop(L, 2);
    s->stopped = 0;
    lua_rawgeti(L, LUA_REGISTRYINDEX, s->corsac_ref);
    lua_pushliteral(L, "reload");
    lua_rawget(L, -2);
    lua_remove(L, -2);
    if (!lua_isfunction(L, -1)) {
        lua_pop(L, 1);
        return true;
    }
    lua_rawgeti(L, LUA_REGISTRYINDEX, s->kept_ref);
    return script_call(s, BIND_LOAD, 1, 0);
}

bool script_reload_changed(script *s) {
    const char *changed = changed_file(s);
    if (!changed) {
        return false;
    }
    bool good = run_again(s);
    core_log(good ? CORE_LOG_INFO : CORE_LOG_WARN, "%s changed: %s", changed,
             good ? "loaded again" : "the old code stays");
    return good;
}
