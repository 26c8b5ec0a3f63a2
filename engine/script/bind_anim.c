// corsac.anim: models, skeletons, clips, state machines; what moves them is an Animator.
#include "script/bind_anim.h"
#include "script/internal.h"

#include <stdio.h>
#include <string.h>

static anim_world *world_of(script *s) { return scene_anim(s->scene); }

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

// ---- making things ----

typedef struct path_args {
    const char *path;
} path_args;
static int load_model(script *s, lua_State *L, void *args) {
    scene_model model = scene_model_load(s->scene, ((path_args *)args)->path);
    if (core_handle_is_null(model)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_model_type, model);
    return 1;
}

typedef struct bone_options {
    const char *name, *parent;
    core_vec3 position, scale;
    core_quat rotation;
} bone_options;
typedef struct skeleton_args {
    bind_list bones;
} skeleton_args;

typedef struct bone_arrays {
    char name[ANIM_MAX_BONES][CORE_NAME_MAX];
    int32_t parent[ANIM_MAX_BONES];
    core_vec3 translation[ANIM_MAX_BONES], scale[ANIM_MAX_BONES];
    core_quat rotation[ANIM_MAX_BONES];
    core_mat4 model[ANIM_MAX_BONES], inverse_bind[ANIM_MAX_BONES];
} bone_arrays;

static int32_t parent_of(lua_State *L, const bone_arrays *a, const bone_options *o, uint32_t b) {
    if (!o->parent) {
        return -1;
    }
    for (uint32_t i = 0; i < b; i++) {
        if (strcmp(a->name[i], o->parent) == 0) {
            return (int32_t)i;
        }
    }
    bind_error(L,
               "corsac.anim.newSkeleton: bone \"%s\" hangs on \"%s\", which is not listed before "
               "it",
               o->name, o->parent);
}

static void read_bone(lua_State *L, bone_arrays *a, const bone_options *o, uint32_t b) {
    snprintf(a->name[b], CORE_NAME_MAX, "%s", o->name);
    a->parent[b] = parent_of(L, a, o, b);
    a->translation[b] = o->position;
    a->rotation[b] = core_quat_normalize(o->rotation);
    a->scale[b] = o->scale;
    core_mat4 local = core_mat4_trs(a->translation[b], a->rotation[b], a->scale[b]);
    a->model[b] = a->parent[b] < 0 ? local : core_mat4_mul(&a->model[a->parent[b]], &local);
    if (!core_mat4_inverse(&a->model[b], &a->inverse_bind[b])) {
        bind_error(L, "corsac.anim.newSkeleton: bone \"%s\" is flat (a scale of 0)", o->name);
    }
}

static int new_skeleton(script *s, lua_State *L, void *args) {
    const bind_list *list = &((skeleton_args *)args)->bones;
    if (list->count == 0 || list->count > ANIM_MAX_BONES) {
        bind_error(L, "corsac.anim.newSkeleton: %u bones, expected 1 to %u", list->count,
                   ANIM_MAX_BONES);
    }
    bone_arrays *a =
        lua_newuserdata(L, sizeof *a); // collected by Lua, also when an error is raised
    for (uint32_t b = 0; b < list->count; b++) {
        read_bone(L, a, (const bone_options *)list->items + b, b);
    }
    core_skeleton_data data = {list->count,    (const char(*)[CORE_NAME_MAX])a->name,
                               a->parent,      a->translation,
                               a->rotation,    a->scale,
                               a->inverse_bind};
    anim_skeleton skeleton = anim_skeleton_create(world_of(s), &data);
    if (core_handle_is_null(skeleton)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_skeleton_type, skeleton);
    return 1;
}

typedef struct key_options {
    const char *bone;
    float time;
    core_vec3 position, scale;
    core_quat rotation;
    bool has_position, has_rotation, has_scale;
} key_options;
typedef struct event_options {
    float time;
    const char *name;
} event_options;
typedef struct clip_options {
    core_handle skeleton;
    const char *name, *root;
    float duration;
    bind_list keys, events;
    int interpolation;
    bool root_motion;
} clip_options;
typedef struct clip_call {
    clip_options options;
} clip_call;

// Keys of one bone in time order; parts that a key leaves out keep the bind pose.
static uint32_t gather_keys(script *s, const clip_options *o, uint32_t bone, core_key *out) {
    const char *name = anim_skeleton_bone_name(world_of(s), o->skeleton, bone);
    core_key bind;
    anim_skeleton_bind(world_of(s), o->skeleton, bone, &bind);
    uint32_t count = 0;
    for (uint32_t i = 0; i < o->keys.count; i++) {
        const key_options *k = (const key_options *)o->keys.items + i;
        if (strcmp(k->bone, name) == 0) {
            out[count++] =
                (core_key){k->time, k->has_position ? k->position : bind.translation,
                           k->has_rotation ? core_quat_normalize(k->rotation) : bind.rotation,
                           k->has_scale ? k->scale : bind.scale};
        }
    }
    return count;
}

static void check_bones(script *s, lua_State *L, const clip_options *o) {
    for (uint32_t i = 0; i < o->keys.count; i++) {
        const char *bone = ((const key_options *)o->keys.items + i)->bone;
        if (anim_skeleton_find(world_of(s), o->skeleton, bone) < 0) {
            bind_error(L,
                       "corsac.anim.newClip: key %u is for bone \"%s\", which the skeleton does "
                       "not have",
                       i + 1, bone);
        }
    }
}

static int new_clip(script *s, lua_State *L, void *args) {
    const clip_options *o = &((clip_call *)args)->options;
    anim_world *w = world_of(s);
    uint32_t bones = anim_skeleton_bone_count(w, o->skeleton);
    check_bones(s, L, o);
    core_key *key = lua_newuserdata(L, (o->keys.count + 1) * sizeof *key);
    core_clip_track *track = lua_newuserdata(L, bones * sizeof *track);
    core_clip_data data = {.duration = o->duration, .bone_count = bones, .track = track};
    snprintf(data.name, sizeof data.name, "%s", o->name);
    for (uint32_t b = 0; b < bones; b++) {
        uint32_t count = gather_keys(s, o, b, key);
        if (count > 0) {
            track[data.track_count++] = (core_clip_track){
                .bone = b, .key_count = count, .key = key, .mode = (core_key_mode)o->interpolation};
            key += count;
        }
    }
    anim_clip_event *event = lua_newuserdata(L, (o->events.count + 1) * sizeof *event);
    for (uint32_t i = 0; i < o->events.count; i++) {
        const event_options *e = (const event_options *)o->events.items + i;
        event[i].time = e->time;
        snprintf(event[i].name, sizeof event[i].name, "%s", e->name);
    }
    int32_t root = o->root ? anim_skeleton_find(w, o->skeleton, o->root) : 0;
    if (root < 0) {
        bind_error(L, "corsac.anim.newClip: the skeleton has no bone \"%s\"", o->root);
    }
    anim_clip_desc desc = anim_clip_desc_default();
    desc.data = &data;
    desc.skeleton = o->skeleton;
    desc.root_motion = o->root_motion;
    desc.root_bone = (uint32_t)root;
    desc.event = event;
    desc.event_count = o->events.count;
    anim_clip clip = anim_clip_create(w, &desc);
    if (core_handle_is_null(clip)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_clip_type, clip);
    return 1;
}

typedef struct mask_args {
    core_handle skeleton;
    int bones;
    float weight;
} mask_args;

// Gives the weight to a bone and all below it.
static void weigh(anim_world *w, anim_skeleton skeleton, uint32_t bone, float weight, float *out) {
    uint32_t count = anim_skeleton_bone_count(w, skeleton);
    for (uint32_t b = bone; b < count; b++) {
        int32_t above = (int32_t)b;
        while (above > (int32_t)bone) {
            above = anim_skeleton_parent(w, skeleton, (uint32_t)above);
        }
        out[b] = above == (int32_t)bone ? weight : out[b];
    }
}

static int new_mask(script *s, lua_State *L, void *args) {
    const mask_args *a = args;
    anim_world *w = world_of(s);
    float *weight = lua_newuserdata(L, ANIM_MAX_BONES * sizeof *weight);
    memset(weight, 0, ANIM_MAX_BONES * sizeof *weight);
    for (int i = 1;; i++) {
        lua_rawgeti(L, a->bones, i);
        if (lua_isnil(L, -1)) {
            break;
        }
        const char *name = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        int32_t bone = anim_skeleton_find(w, a->skeleton, name);
        if (bone < 0) {
            bind_error(L, "corsac.anim.newMask: bones[%d]: the skeleton has no bone \"%s\"", i,
                       name);
        }
        weigh(w, a->skeleton, (uint32_t)bone, a->weight, weight);
        lua_pop(L, 1);
    }
    anim_mask mask = anim_mask_create(w, a->skeleton, weight);
    if (core_handle_is_null(mask)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_mask_type, mask);
    return 1;
}
static int mask_destroy(script *s, lua_State *L, void *args) {
    return done(L, anim_mask_destroy(world_of(s), *(core_handle *)args));
}

typedef struct animator_args {
    core_handle skeleton, machine, clip;
} animator_args;
static int new_animator(script *s, lua_State *L, void *args) {
    const animator_args *a = args;
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = a->skeleton;
    desc.machine = a->machine;
    desc.clip = a->clip;
    anim_instance instance = anim_instance_create(world_of(s), &desc);
    if (core_handle_is_null(instance)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_animator_type, instance);
    return 1;
}

static int get_events(script *s, lua_State *L, void *args) {
    (void)args;
    const anim_event *event;
    uint32_t count = anim_world_events(world_of(s), &event);
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        lua_createtable(L, 0, 3);
        bind_push(s, L, &bind_animator_type, event[i].instance);
        lua_setfield(L, -2, "animator");
        lua_pushstring(L, event[i].name);
        lua_setfield(L, -2, "name");
        lua_pushnumber(L, event[i].time);
        lua_setfield(L, -2, "time");
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}

// ---- models, skeletons, clips, machines ----

static bool model_alive(script *s, core_handle h) { return scene_model_alive(s->scene, h); }
static bool skeleton_alive(script *s, core_handle h) {
    return scene_anim_if(s->scene) && anim_skeleton_alive(scene_anim_if(s->scene), h);
}
static bool clip_alive(script *s, core_handle h) {
    return scene_anim_if(s->scene) && anim_clip_alive(scene_anim_if(s->scene), h);
}
static bool machine_alive(script *s, core_handle h) {
    return scene_anim_if(s->scene) && anim_machine_alive(scene_anim_if(s->scene), h);
}
static bool mask_alive(script *s, core_handle h) {
    return scene_anim_if(s->scene) && anim_mask_alive(scene_anim_if(s->scene), h);
}
static bool animator_alive(script *s, core_handle h) {
    return scene_anim_if(s->scene) && anim_instance_alive(scene_anim_if(s->scene), h);
}

typedef struct name_args {
    core_handle self;
    const char *name;
} name_args;

static int model_get_skeleton(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_skeleton_type, scene_model_skeleton(s->scene, *(core_handle *)args));
    return 1;
}
static int model_get_clip(script *s, lua_State *L, void *args) {
    const name_args *a = args;
    anim_clip clip = scene_model_find_clip(s->scene, a->self, a->name);
    if (core_handle_is_null(clip)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_clip_type, clip);
    return 1;
}
static int model_get_clips(script *s, lua_State *L, void *args) {
    core_handle self = *(core_handle *)args;
    uint32_t count = scene_model_clip_count(s->scene, self);
    lua_createtable(L, (int)count, 0);
    for (uint32_t i = 0; i < count; i++) {
        bind_push(s, L, &bind_clip_type, scene_model_clip(s->scene, self, i));
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}
static int skeleton_get_count(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, anim_skeleton_bone_count(world_of(s), *(core_handle *)args));
    return 1;
}
static int skeleton_get_bones(script *s, lua_State *L, void *args) {
    core_handle self = *(core_handle *)args;
    uint32_t count = anim_skeleton_bone_count(world_of(s), self);
    lua_createtable(L, (int)count, 0);
    for (uint32_t b = 0; b < count; b++) {
        lua_pushstring(L, anim_skeleton_bone_name(world_of(s), self, b));
        lua_rawseti(L, -2, (int)b + 1);
    }
    return 1;
}
static int skeleton_destroy(script *s, lua_State *L, void *args) {
    return done(L, anim_skeleton_destroy(world_of(s), *(core_handle *)args));
}
static int clip_get_name(script *s, lua_State *L, void *args) {
    lua_pushstring(L, anim_clip_name(world_of(s), *(core_handle *)args));
    return 1;
}
static int clip_get_duration(script *s, lua_State *L, void *args) {
    lua_pushnumber(L, (double)anim_clip_duration(world_of(s), *(core_handle *)args));
    return 1;
}
static int clip_destroy(script *s, lua_State *L, void *args) {
    return done(L, anim_clip_destroy(world_of(s), *(core_handle *)args));
}
static int machine_get_dot(script *s, lua_State *L, void *args) {
    char *text = anim_machine_dot(world_of(s), *(core_handle *)args, CORE_NULL_HANDLE);
    if (!text) {
        bind_fail(L);
    }
    lua_pushstring(L, text);
    core_free(text);
    return 1;
}
static int machine_destroy(script *s, lua_State *L, void *args) {
    return done(L, anim_machine_destroy(world_of(s), *(core_handle *)args));
}

// ---- declarations ----

#define SELF sizeof(core_handle)

static const bind_fn model_methods[] = {
    {"getSkeleton", "Its skeleton, or nil.", NULL,
     BIND_RETURNS({"skeleton", "corsac.Skeleton?", NULL}), SELF, BIND_RUNNING,
     .run = model_get_skeleton},
    {"getClip", "Its clip of that name.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(name_args, name), "as in the model's file"}),
     BIND_RETURNS({"clip", "corsac.Clip", NULL}), sizeof(name_args), BIND_RUNNING,
     .run = model_get_clip},
    {"getClips", "All its clips.", NULL, BIND_RETURNS({"clips", "corsac.Clip[]", NULL}), SELF,
     BIND_RUNNING, .run = model_get_clips},
    {0}};
static const bind_fn skeleton_methods[] = {
    {"getBoneCount", "How many bones it has.", NULL, BIND_RETURNS({"count", "integer", NULL}), SELF,
     BIND_RUNNING, .run = skeleton_get_count},
    {"getBones", "Names of its bones, parents first.", NULL,
     BIND_RETURNS({"names", "string[]", NULL}), SELF, BIND_RUNNING, .run = skeleton_get_bones},
    {"destroy", "Removes it; clips and animators that use it must go first.", NULL, NULL, SELF,
     BIND_SIM, .run = skeleton_destroy},
    {0}};
static const bind_fn clip_methods[] = {
    {"getName", "Its name.", NULL, BIND_RETURNS({"name", "string", NULL}), SELF, BIND_RUNNING,
     .run = clip_get_name},
    {"getDuration", "How long it is.", NULL, BIND_RETURNS({"duration", "number", "s"}), SELF,
     BIND_RUNNING, .run = clip_get_duration},
    {"destroy", "Removes it; what plays it must go first.", NULL, NULL, SELF, BIND_SIM,
     .run = clip_destroy},
    {0}};
static const bind_fn machine_methods[] = {
    {"extend", "Adds states and transitions, for all animators that use the machine.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(bind_machine_extension, more), "what to add",
                .fields = bind_machine_more_fields}),
     NULL, sizeof(bind_machine_extension), BIND_LOAD | BIND_FIXED, .mod = true, .cost = 500,
     .run = bind_machine_extend},
    {"getDot", "The machine as Graphviz text.", NULL, BIND_RETURNS({"text", "string", NULL}), SELF,
     BIND_RUNNING, .run = machine_get_dot},
    {"destroy", "Removes it; animators that use it must go first.", NULL, NULL, SELF, BIND_SIM,
     .run = machine_destroy},
    {0}};

static const bind_fn mask_methods[] = {{"destroy", "Removes it; layers that use it must go first.",
                                        NULL, NULL, SELF, BIND_SIM, .run = mask_destroy},
                                       {0}};

const bind_type bind_mask_type = {"Mask", "Which bones a layer moves, and how much.", mask_alive,
                                  mask_methods};
const bind_type bind_model_type = {"Model", "Meshes, skeleton and clips read from a file.",
                                   model_alive, model_methods};
const bind_type bind_skeleton_type = {"Skeleton", "Bones with a bind pose.", skeleton_alive,
                                      skeleton_methods};
const bind_type bind_clip_type = {"Clip", "Keys of bones over time.", clip_alive, clip_methods};
const bind_type bind_machine_type = {"Machine", "States with clips and transitions between them.",
                                     machine_alive, machine_methods};
const bind_type bind_animator_type = {"Animator", "One animated skeleton.", animator_alive,
                                      bind_animator_methods};

static const bind_arg bone_fields[] = {
    {"name", BIND_STRING, BIND_AT(bone_options, name), "of the bone"},
    {"parent", BIND_STRING, BIND_AT(bone_options, parent), "a bone listed before it",
     .optional = true, .def_text = NULL},
    {"position", BIND_VEC3, BIND_AT(bone_options, position), "in its parent's frame", "m",
     .optional = true},
    {"rotation", BIND_QUAT, BIND_AT(bone_options, rotation), "in its parent's frame",
     .optional = true, .def_text = "none"},
    {"scale", BIND_VEC3, BIND_AT(bone_options, scale), "", NULL, BIND_POSITIVE, .optional = true,
     .def_vec = {1, 1, 1}, .uniform = true},
    {0}};

static const bind_arg key_fields[] = {
    {"bone", BIND_STRING, BIND_AT(key_options, bone), "which bone it moves"},
    {"time", BIND_FLOAT, BIND_AT(key_options, time), "place in the clip; ascending for each bone",
     "s", BIND_NOT_NEGATIVE},
    {"position", BIND_VEC3, BIND_AT(key_options, position), "in its parent's frame", "m",
     .optional = true, .def_text = "bind pose", BIND_GIVEN(key_options, has_position)},
    {"rotation", BIND_QUAT, BIND_AT(key_options, rotation), "in its parent's frame",
     .optional = true, .def_text = "bind pose", BIND_GIVEN(key_options, has_rotation)},
    {"scale", BIND_VEC3, BIND_AT(key_options, scale), "", NULL, BIND_POSITIVE, .optional = true,
     .def_text = "bind pose", .uniform = true, BIND_GIVEN(key_options, has_scale)},
    {0}};

static const bind_arg event_fields[] = {
    {"time", BIND_FLOAT, BIND_AT(event_options, time), "place in the clip", "s", BIND_NOT_NEGATIVE},
    {"name", BIND_STRING, BIND_AT(event_options, name), "told by corsac.anim.getEvents"},
    {0}};

static const bind_arg clip_fields[] = {
    {"skeleton", BIND_OBJECT, BIND_AT(clip_options, skeleton), "whose bones it moves",
     .type = &bind_skeleton_type},
    {"name", BIND_STRING, BIND_AT(clip_options, name), "", .optional = true, .def_text = "clip"},
    {"duration", BIND_FLOAT, BIND_AT(clip_options, duration), "its length", "s", BIND_POSITIVE},
    {"keys", BIND_LIST, BIND_AT(clip_options, keys), "keys of its bones", .fields = key_fields,
     .size = sizeof(key_options)},
    {"interpolation", BIND_ENUM, BIND_AT(clip_options, interpolation),
     "between keys; cubic is smooth through all of them", .optional = true,
     .values = "linear|step|cubic"},
    {"events", BIND_LIST, BIND_AT(clip_options, events), "names told at times", .optional = true,
     .fields = event_fields, .size = sizeof(event_options)},
    {"rootMotion", BIND_BOOL, BIND_AT(clip_options, root_motion),
     "the root's horizontal movement moves the entity", .optional = true},
    {"root", BIND_STRING, BIND_AT(clip_options, root), "bone of the root motion", .optional = true,
     .def_text = NULL},
    {0}};

static const bind_fn functions[] = {
    {"loadModel", "Reads a .cmodel with its meshes, skeleton and clips; once for each path.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(path_args, path), "virtual path"}),
     BIND_RETURNS({"model", "corsac.Model", NULL}), sizeof(path_args), BIND_SIM, .run = load_model},
    {"newSkeleton", "Makes a skeleton from its bones.",
     BIND_ARGS({"bones", BIND_LIST, BIND_AT(skeleton_args, bones), "parents before children",
                .fields = bone_fields, .size = sizeof(bone_options)}),
     BIND_RETURNS({"skeleton", "corsac.Skeleton", NULL}), sizeof(skeleton_args), BIND_SIM,
     .run = new_skeleton},
    {"newClip", "Makes a clip from keys.",
     BIND_ARGS(
         {"options", BIND_OPTIONS, BIND_AT(clip_call, options), "the clip", .fields = clip_fields}),
     BIND_RETURNS({"clip", "corsac.Clip", NULL}), sizeof(clip_call), BIND_SIM, .run = new_clip},
    {"newMachine", "Makes a state machine; many animators may share it.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(bind_machine_call, options), "the machine",
                .fields = bind_machine_fields}),
     BIND_RETURNS({"machine", "corsac.Machine", NULL}), sizeof(bind_machine_call), BIND_SIM,
     .run = bind_machine_new},
    {"newMask", "Which bones a layer moves: those named and all below them.",
     BIND_ARGS(
         {"skeleton", BIND_OBJECT, BIND_AT(mask_args, skeleton), "", .type = &bind_skeleton_type},
         {"bones", BIND_TABLE, BIND_AT(mask_args, bones), "list of names"},
         {"weight", BIND_FLOAT, BIND_AT(mask_args, weight), "", NULL, BIND_BETWEEN, .max = 1,
          .optional = true, .def = 1}),
     BIND_RETURNS({"mask", "corsac.Mask", NULL}), sizeof(mask_args), BIND_SIM, .run = new_mask},
    {"newAnimator", "Moves a skeleton without an entity.",
     BIND_ARGS({"skeleton", BIND_OBJECT, BIND_AT(animator_args, skeleton), "what it moves",
                .type = &bind_skeleton_type},
               {"machine", BIND_OBJECT, BIND_AT(animator_args, machine), "chooses its clips",
                .optional = true, .def_text = "nil", .type = &bind_machine_type},
               {"clip", BIND_OBJECT, BIND_AT(animator_args, clip), "played without a machine",
                .optional = true, .def_text = "nil", .type = &bind_clip_type}),
     BIND_RETURNS({"animator", "corsac.Animator", NULL}), sizeof(animator_args), BIND_SIM,
     .run = new_animator},
    {"getEvents", "Clip events passed in the last step: tables {animator, name, time}.", NULL,
     BIND_RETURNS({"events", "table[]", NULL}), 0, BIND_RUNNING, .run = get_events},
    {0}};

static const bind_module modules[] = {
    {"corsac.anim", "Skeletons, clips and state machines.", functions}, {0}};
static const bind_type *const types[] = {&bind_model_type,
                                         &bind_skeleton_type,
                                         &bind_clip_type,
                                         &bind_machine_type,
                                         &bind_animator_type,
                                         &bind_mask_type,
                                         NULL};

const bind_room bind_anim_room = {"anim", modules, types};
