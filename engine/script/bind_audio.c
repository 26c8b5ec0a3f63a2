// corsac.audio: sounds, sources, groups, the listener.
#include "script/internal.h"

#include <string.h>

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

extern const bind_type bind_entity_type, bind_sound_type, bind_source_type;

// ---- sounds ----

typedef struct path_args {
    const char *path;
} path_args;
static int new_sound(script *s, lua_State *L, void *args) {
    audio_sound sound = scene_sound_load(s->scene, ((path_args *)args)->path);
    if (core_handle_is_null(sound)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_sound_type, sound);
    return 1;
}

static bool sound_alive(script *s, core_handle h) {
    audio_world *world = scene_audio_if(s->scene);
    return world && audio_sound_alive(world, h);
}

static int sound_duration(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, audio_sound_duration(scene_audio(s->scene), *(core_handle *)args));
    return 1;
}

static const bind_fn sound_methods[] = {
    {"getDuration", "Its length.", NULL, BIND_RETURNS({"duration", "number", "s"}),
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 4, .run = sound_duration},
    {0}};
const bind_type bind_sound_type = {"Sound", "Samples that sources play.", sound_alive,
                                   sound_methods};

// ---- making sources ----

typedef struct source_options {
    core_handle sound, entity;
    core_vec3 position, velocity, direction;
    float gain, pitch, reference, max_distance, rolloff, inner, outer, cone_gain;
    bool loop, flat, paused;
    const char *group;
} source_options;
typedef struct source_call {
    source_options options;
} source_call;

static int new_source(script *s, lua_State *L, void *args) {
    const source_options *o = &((source_call *)args)->options;
    audio_world *world = scene_audio(s->scene);
    audio_source_desc desc = audio_source_desc_default();
    desc.sound = o->sound;
    desc.position = o->position;
    desc.velocity = o->velocity;
    desc.direction = o->direction;
    desc.gain = o->gain;
    desc.pitch = o->pitch;
    desc.reference = o->reference;
    desc.max_distance = o->max_distance;
    desc.rolloff = o->rolloff;
    desc.inner = o->inner;
    desc.outer = o->outer;
    desc.cone_gain = o->cone_gain;
    desc.loop = o->loop;
    desc.flat = o->flat;
    desc.paused = o->paused;
    desc.group = o->group;
    audio_source source = audio_source_create(world, &desc);
    if (core_handle_is_null(source)) {
        bind_fail(L);
    }
    if (!core_handle_is_null(o->entity) && !scene_set_sound(s->scene, o->entity, source)) {
        audio_source_destroy(world, source);
        bind_fail(L);
    }
    bind_push(s, L, &bind_source_type, source);
    return 1;
}

// ---- sources ----

static bool source_alive(script *s, core_handle h) {
    audio_world *world = scene_audio_if(s->scene);
    return world && audio_source_alive(world, h);
}

typedef struct vector_args {
    core_handle self;
    double x, y, z;
} vector_args;
typedef struct number_args {
    core_handle self;
    double value;
} number_args;
typedef struct fade_args {
    core_handle self;
    double gain, seconds;
    bool stop;
} fade_args;

static core_vec3 vector_of(const vector_args *a) {
    return core_v3((float)a->x, (float)a->y, (float)a->z);
}
static int play(script *s, lua_State *L, void *args) {
    return done(L, audio_source_play(scene_audio(s->scene), *(core_handle *)args));
}
static int pause(script *s, lua_State *L, void *args) {
    return done(L, audio_source_pause(scene_audio(s->scene), *(core_handle *)args));
}
static int stop(script *s, lua_State *L, void *args) {
    return done(L, audio_source_stop(scene_audio(s->scene), *(core_handle *)args));
}
static int is_playing(script *s, lua_State *L, void *args) {
    lua_pushboolean(L, audio_source_playing(scene_audio(s->scene), *(core_handle *)args));
    return 1;
}
static int get_time(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, audio_source_time(scene_audio(s->scene), *(core_handle *)args));
    return 1;
}
static int seek(script *s, lua_State *L, void *args) {
    const number_args *a = args;
    return done(L, audio_source_seek(scene_audio(s->scene), a->self, a->value));
}
static int set_position(script *s, lua_State *L, void *args) {
    const vector_args *a = args;
    return done(L, audio_source_set_position(scene_audio(s->scene), a->self, vector_of(a)));
}
static int set_velocity(script *s, lua_State *L, void *args) {
    const vector_args *a = args;
    return done(L, audio_source_set_velocity(scene_audio(s->scene), a->self, vector_of(a)));
}
static int set_direction(script *s, lua_State *L, void *args) {
    const vector_args *a = args;
    return done(L, audio_source_set_direction(scene_audio(s->scene), a->self, vector_of(a)));
}
static int set_gain(script *s, lua_State *L, void *args) {
    const number_args *a = args;
    return done(L, audio_source_set_gain(scene_audio(s->scene), a->self, (float)a->value));
}
static int set_pitch(script *s, lua_State *L, void *args) {
    const number_args *a = args;
    return done(L, audio_source_set_pitch(scene_audio(s->scene), a->self, (float)a->value));
}
static int fade(script *s, lua_State *L, void *args) {
    const fade_args *a = args;
    return done(L, audio_source_fade(scene_audio(s->scene), a->self, (float)a->gain,
                                     (float)a->seconds, a->stop));
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, audio_source_destroy(scene_audio(s->scene), *(core_handle *)args));
}

#define XYZ_ARGS(unit_text)                                                                        \
    BIND_ARGS({"x", BIND_NUMBER, BIND_AT(vector_args, x), "", unit_text},                          \
              {"y", BIND_NUMBER, BIND_AT(vector_args, y), "", unit_text},                          \
              {"z", BIND_NUMBER, BIND_AT(vector_args, z), "", unit_text})
#define ON_SELF(name, doc, handler)                                                                \
    {                                                                                              \
        name, doc, NULL, NULL, sizeof(core_handle), BIND_SIM, .mod = true, .cost = 10,             \
                                                              .run = handler                       \
    }

static const bind_fn source_methods[] = {
    ON_SELF("play", "Starts it, or goes on after a pause.", play),
    ON_SELF("pause", "Holds it where it is.", pause),
    ON_SELF("stop", "Stops it; play begins at the start again.", stop),
    {"isPlaying", "Whether it plays, heard or not.", NULL,
     BIND_RETURNS({"playing", "boolean", NULL}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 4, .run = is_playing},
    {"getTime", "Where it is in its sound.", NULL, BIND_RETURNS({"time", "number", "s"}),
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 4, .run = get_time},
    {"seek", "Moves to a place in its sound.",
     BIND_ARGS({"time", BIND_NUMBER, BIND_AT(number_args, value), "from the start", "s",
                BIND_NOT_NEGATIVE}),
     NULL, sizeof(number_args), BIND_SIM, .mod = true, .cost = 10, .run = seek},
    {"setPosition", "Moves it; one that hangs on an entity follows that instead.", XYZ_ARGS("m"),
     NULL, sizeof(vector_args), BIND_SIM, .mod = true, .cost = 8, .run = set_position},
    {"setVelocity", "Velocity for the Doppler effect.", XYZ_ARGS("m/s"), NULL, sizeof(vector_args),
     BIND_SIM, .mod = true, .cost = 8, .run = set_velocity},
    {"setDirection", "Axis of its cone.", XYZ_ARGS(NULL), NULL, sizeof(vector_args), BIND_SIM,
     .mod = true, .cost = 8, .run = set_direction},
    {"setGain", "Loudness; ends a fade.",
     BIND_ARGS({"gain", BIND_NUMBER, BIND_AT(number_args, value), "factor of amplitude", NULL,
                BIND_BETWEEN, .max = 16}),
     NULL, sizeof(number_args), BIND_SIM, .mod = true, .cost = 8, .run = set_gain},
    {"setPitch", "Speed of playback.",
     BIND_ARGS({"pitch", BIND_NUMBER, BIND_AT(number_args, value), "factor", NULL, BIND_BETWEEN,
                .min = 0.0625, .max = 16}),
     NULL, sizeof(number_args), BIND_SIM, .mod = true, .cost = 8, .run = set_pitch},
    {"fade", "Moves its gain over a time.",
     BIND_ARGS({"gain", BIND_NUMBER, BIND_AT(fade_args, gain), "at the end", NULL, BIND_BETWEEN,
                .max = 16},
               {"seconds", BIND_NUMBER, BIND_AT(fade_args, seconds), "of step time", "s",
                BIND_BETWEEN, .min = 0.001, .max = 3600},
               {"stop", BIND_BOOL, BIND_AT(fade_args, stop), "and then stops", .optional = true}),
     NULL, sizeof(fade_args), BIND_SIM, .mod = true, .cost = 10, .run = fade},
    ON_SELF("destroy", "Removes it.", destroy),
    {0}};
const bind_type bind_source_type = {"Source", "One thing that sounds.", source_alive,
                                    source_methods};

// ---- listener and groups ----

typedef struct listener_options {
    core_vec3 position, velocity;
    core_quat rotation;
    core_handle entity;
    bool has_entity, has_position;
} listener_options;
typedef struct listener_call {
    listener_options options;
} listener_call;

static int set_listener(script *s, lua_State *L, void *args) {
    const listener_options *o = &((listener_call *)args)->options;
    if (o->has_entity == o->has_position) {
        bind_error(L, "corsac.audio.setListener: give either entity or position");
    }
    if (o->has_entity) {
        return done(L, scene_set_listener(s->scene, o->entity));
    }
    audio_listener l = {.position = o->position, .velocity = o->velocity, .rotation = o->rotation};
    scene_place_listener(s->scene, &l);
    return 0;
}

typedef struct group_args {
    const char *name;
    double gain;
} group_args;
static int set_group(script *s, lua_State *L, void *args) {
    const group_args *a = args;
    return done(L, audio_world_set_group(scene_audio(s->scene), a->name, (float)a->gain));
}
static int get_group(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, (double)audio_world_group(scene_audio(s->scene), ((group_args *)args)->name));
    return 1;
}

// ---- declarations ----

static const bind_arg source_fields[] = {
    {"sound", BIND_OBJECT, BIND_AT(source_options, sound), "what it plays",
     .type = &bind_sound_type},
    {"entity", BIND_OBJECT, BIND_AT(source_options, entity), "that it follows and ends with",
     .optional = true, .def_text = "nil", .type = &bind_entity_type},
    {"position", BIND_VEC3, BIND_AT(source_options, position), "", "m", .optional = true},
    {"velocity", BIND_VEC3, BIND_AT(source_options, velocity), "for the Doppler effect", "m/s",
     .optional = true},
    {"direction", BIND_VEC3, BIND_AT(source_options, direction),
     "axis of the cone; zero: the same all around", .optional = true},
    {"gain", BIND_FLOAT, BIND_AT(source_options, gain), "factor of amplitude", NULL, BIND_BETWEEN,
     .max = 16, .optional = true, .def = 1},
    {"pitch", BIND_FLOAT, BIND_AT(source_options, pitch), "factor of speed", NULL, BIND_BETWEEN,
     .min = 0.0625, .max = 16, .optional = true, .def = 1},
    {"reference", BIND_FLOAT, BIND_AT(source_options, reference), "distance of full loudness", "m",
     BIND_POSITIVE, .optional = true, .def = 1},
    {"maxDistance", BIND_FLOAT, BIND_AT(source_options, max_distance),
     "beyond it the loudness stays", "m", BIND_POSITIVE, .optional = true, .def = 10000},
    {"rolloff", BIND_FLOAT, BIND_AT(source_options, rolloff), "0: distance does not matter", NULL,
     BIND_NOT_NEGATIVE, .optional = true, .def = 1},
    {"inner", BIND_FLOAT, BIND_AT(source_options, inner), "full angle of full loudness", "rad",
     BIND_BETWEEN, .max = 6.2831855, .optional = true, .def = 6.2831853},
    {"outer", BIND_FLOAT, BIND_AT(source_options, outer), "full angle of the cone", "rad",
     BIND_BETWEEN, .max = 6.2831855, .optional = true, .def = 6.2831853},
    {"coneGain", BIND_FLOAT, BIND_AT(source_options, cone_gain), "factor outside the cone", NULL,
     BIND_BETWEEN, .max = 1, .optional = true},
    {"loop", BIND_BOOL, BIND_AT(source_options, loop), "again and again, without a gap",
     .optional = true},
    {"flat", BIND_BOOL, BIND_AT(source_options, flat), "without a place: music, menus",
     .optional = true},
    {"paused", BIND_BOOL, BIND_AT(source_options, paused), "waits for play", .optional = true},
    {"group", BIND_STRING, BIND_AT(source_options, group), "whose loudness it shares",
     .optional = true, .def_text = "effects"},
    {0}};

static const bind_arg listener_fields[] = {
    {"entity", BIND_OBJECT, BIND_AT(listener_options, entity), "who hears; looks along its -Z",
     .optional = true, .def_text = "nil", BIND_GIVEN(listener_options, has_entity),
     .type = &bind_entity_type},
    {"position", BIND_VEC3, BIND_AT(listener_options, position), "a fixed place instead", "m",
     .optional = true, BIND_GIVEN(listener_options, has_position)},
    {"rotation", BIND_QUAT, BIND_AT(listener_options, rotation), "at a fixed place",
     .optional = true, .def_text = "none"},
    {"velocity", BIND_VEC3, BIND_AT(listener_options, velocity), "at a fixed place", "m/s",
     .optional = true},
    {0}};

static const bind_fn functions[] = {
    {"newSound", "Reads a WAV or Ogg Vorbis file; the same path gives the same sound.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(path_args, path), "in the game's folder"}),
     BIND_RETURNS({"sound", "corsac.Sound", NULL}), sizeof(path_args), BIND_SIM, .mod = true,
     .cost = 20000, .run = new_sound},
    {"newSource", "Makes something that sounds, and starts it.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(source_call, options), "the source",
                .fields = source_fields}),
     BIND_RETURNS({"source", "corsac.Source", NULL}), sizeof(source_call), BIND_SIM, .mod = true,
     .cost = 500, .run = new_source},
    {"setListener", "Who hears; without it, the camera does.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(listener_call, options), "the listener",
                .fields = listener_fields}),
     NULL, sizeof(listener_call), BIND_SIM, .run = set_listener},
    {"setGroup", "Loudness of all sources of a group.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(group_args, name), "\"effects\", \"music\", your own"},
               {"gain", BIND_NUMBER, BIND_AT(group_args, gain), "factor of amplitude", NULL,
                BIND_BETWEEN, .max = 16}),
     NULL, sizeof(group_args), BIND_RUNNING, .run = set_group},
    {"getGroup", "Loudness of a group.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(group_args, name), "of the group"}),
     BIND_RETURNS({"gain", "number", NULL}), sizeof(group_args), BIND_RUNNING, .mod = true,
     .cost = 4, .run = get_group},
    {0}};

static const bind_module modules[] = {
    {"corsac.audio", "Sounds in space: sources, groups, a listener.", functions}, {0}};
static const bind_type *const types[] = {&bind_sound_type, &bind_source_type, NULL};

const bind_room bind_audio_room = {"audio", modules, types};
