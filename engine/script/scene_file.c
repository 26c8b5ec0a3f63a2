// corsac.scene.save and load: asked for in a step, done at its end, when no callback runs that
// could hold what a load replaces.
#include "script/scene_file.h"

#include "script/files.h"
#include "script/internal.h"
#include "script/json.h"

#include <stdio.h>
#include <string.h>

enum { ASK_NOTHING, ASK_BINARY, ASK_TEXT, ASK_LOAD };

typedef struct name_args {
    const char *name;
    int form;
} name_args;

static void file_name(script *s, lua_State *L, const char *name, int ask) {
    script_check_save_name(L, name);
    snprintf(s->scene_file, sizeof s->scene_file, "%s.%s", name, ask == ASK_TEXT ? "lua" : "csave");
}

static int ask_save(script *s, lua_State *L, void *args) {
    const name_args *a = args;
    s->scene_ask = a->form == 0 ? ASK_BINARY : ASK_TEXT;
    file_name(s, L, a->name, s->scene_ask);
    return 0;
}

static void forget(script *s) {
    core_free(s->scene_data);
    s->scene_data = NULL;
    s->scene_ask = ASK_NOTHING;
}

// The file is read now, so that a recording notes it where it was asked for.
static int ask_load(script *s, lua_State *L, void *args) {
    const name_args *a = args;
    forget(s);
    for (int ask = ASK_BINARY; ask <= ASK_TEXT && !s->scene_data; ask++) {
        file_name(s, L, a->name, ask);
        s->scene_data = script_player_read(s, L, s->scene_file, &s->scene_size);
    }
    s->scene_ask = s->scene_data ? ASK_LOAD : ASK_NOTHING;
    lua_pushboolean(L, s->scene_data != NULL);
    return 1;
}

static script *self(lua_State *L) { return lua_touserdata(L, lua_upvalueindex(1)); }

// What the script adds to a save: its time, and the tables of corsac.persist.
static char *own_part(script *s, lua_State *L) {
    lua_newtable(L);
    lua_pushnumber(L, s->time);
    lua_setfield(L, -2, "time");
    lua_rawgeti(L, LUA_REGISTRYINDEX, s->kept_ref);
    lua_setfield(L, -2, "persist");
    char *text = script_json_write(L, lua_gettop(L), "corsac.scene.save: tables of corsac.persist");
    lua_pop(L, 1);
    return text;
}

static int do_save(lua_State *L) {
    script *s = self(L);
    char *mine = own_part(s, L);
    size_t size;
    void *data = scene_save(
        s->scene, s->scene_ask == ASK_TEXT ? CORE_STREAM_TEXT : CORE_STREAM_BINARY, mine, &size);
    core_free(mine);
    bool good = script_player_write(s, s->scene_file, data, size);
    core_free(data);
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// Persisted tables stay the tables they are, with other contents; then the game is told.
static int do_load(lua_State *L) {
    script *s = self(L);
    char *mine;
    if (!scene_load(s->scene, s->scene_file, s->scene_data, s->scene_size, &mine)) {
        bind_fail(L);
    }
    bool good = script_json_read(L, mine, strlen(mine));
    core_free(mine);
    if (!good || !lua_istable(L, -1)) {
        bind_error(L, "%s: script: %s", s->scene_file,
                   good ? "a table expected" : core_last_error());
    }
    lua_getfield(L, -1, "time");
    s->time = lua_tonumber(L, -1);
    lua_pop(L, 1);
    lua_getfield(L, LUA_REGISTRYINDEX, "corsac.engine");
    lua_getfield(L, -1, "restoreKept");
    lua_getfield(L, -3, "persist");
    lua_pushstring(L, s->scene_file);
    lua_call(L, 2, 0);
    return 0;
}

void script_end_step(script *s) {
    if (s->scene_ask == ASK_NOTHING) {
        return;
    }
    lua_pushlightuserdata(s->L, s);
    lua_pushcclosure(s->L, s->scene_ask == ASK_LOAD ? do_load : do_save, 1);
    script_call(s, BIND_STEP, 0, 0);
    forget(s);
}

void script_scene_file_release(script *s) { forget(s); }

const bind_fn bind_scene_file_functions[] = {
    {"save",
     "Saves the whole scene at the end of this step in the player's folder: bodies, contacts, "
     "animations, agents, sources, lights, the tables of corsac.persist. Models, sounds, surfaces, "
     "machines and functions are not in it: they are what the scene's own code makes again.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(name_args, name), "letters, digits, - and _"},
               {"form", BIND_ENUM, BIND_AT(name_args, form), "packed, or text a person can read",
                .optional = true, .values = "binary|lua"}),
     NULL, sizeof(name_args), BIND_SIM, .run = ask_save},
    {"load",
     "Makes the scene what it was when it was saved, at the end of this step, then emits "
     "\"loaded\" with the name. To be called in the scene that wrote it, after load. A file that "
     "is "
     "damaged or of another scene is an error, and changes nothing.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(name_args, name), "as given to save"}),
     BIND_RETURNS({"found", "boolean", NULL}), sizeof(name_args), BIND_SIM, .run = ask_load},
    {0}};
