// Settings by name, "phys.solver=soft": kept, so that a room that is made later gets them, and
// tried at once on a small world that is thrown away, so that a wrong name is an error where it was
// written and not when the room is made.
#include <string.h>

#include "core/nearest.h"
#include "scene/scene_internal.h"

typedef struct settable_room {
    const char *name;
    void *(*present)(const scene *s); // NULL: not made yet
    void *(*trial)(void);
    void (*discard)(void *world);
    bool (*set)(void *world, const char *name, const char *value);
} settable_room;

static void *phys_present(const scene *s) { return s->phys; }
static void *phys_trial(void) {
    phys_world_desc desc = phys_world_desc_default();
    desc.max_bodies = 64;
    return phys_world_create(&desc);
}
static void phys_discard(void *world) { phys_world_destroy(world); }
static bool phys_set(void *world, const char *name, const char *value) {
    return phys_world_set(world, name, value);
}

static void *gfx_present(const scene *s) { return s->gfx; }
static void *gfx_trial(void) {
    gfx_world_desc desc = gfx_world_desc_default();
    desc.max_instances = desc.max_lights = 64;
    return gfx_world_create(&desc);
}
static void gfx_discard(void *world) { gfx_world_destroy(world); }
static bool gfx_set(void *world, const char *name, const char *value) {
    return gfx_world_set(world, name, value);
}

static void *anim_present(const scene *s) { return s->anim; }
static void *anim_trial(void) {
    anim_world_desc desc = anim_world_desc_default();
    return anim_world_create(&desc);
}
static void anim_discard(void *world) { anim_world_destroy(world); }
static bool anim_set(void *world, const char *name, const char *value) {
    return anim_world_set(world, name, value);
}

static void *nav_present(const scene *s) { return s->nav; }
static void *nav_trial(void) {
    nav_world_desc desc = nav_world_desc_default();
    desc.max_agents = 64;
    return nav_world_create(&desc);
}
static void nav_discard(void *world) { nav_world_destroy(world); }
static bool nav_set(void *world, const char *name, const char *value) {
    return nav_world_set(world, name, value);
}

static void *audio_present(const scene *s) { return s->audio; }
static void *audio_trial(void) {
    audio_world_desc desc = audio_world_desc_default();
    desc.max_sources = 64;
    return audio_world_create(&desc);
}
static void audio_discard(void *world) { audio_world_destroy(world); }
static bool audio_set(void *world, const char *name, const char *value) {
    return audio_world_set(world, name, value);
}

static const settable_room rooms[] = {
    {"phys", phys_present, phys_trial, phys_discard, phys_set},
    {"gfx", gfx_present, gfx_trial, gfx_discard, gfx_set},
    {"anim", anim_present, anim_trial, anim_discard, anim_set},
    {"nav", nav_present, nav_trial, nav_discard, nav_set},
    {"audio", audio_present, audio_trial, audio_discard, audio_set},
};

static const settable_room *find_room(const char *name) {
    for (size_t i = 0; i < CORE_COUNT_OF(rooms); i++) {
        if (strcmp(rooms[i].name, name) == 0) {
            return &rooms[i];
        }
    }
    return NULL;
}

static bool unknown_room(const char *setting, const char *room) {
    const char *names[CORE_COUNT_OF(rooms)];
    char list[64] = "";
    for (size_t i = 0; i < CORE_COUNT_OF(rooms); i++) {
        names[i] = rooms[i].name;
        strcat(list, i ? ", " : "");
        strcat(list, rooms[i].name);
    }
    const char *near = core_nearest(room, names, CORE_COUNT_OF(rooms));
    return core_fail("setting '%s': no settings for '%s'%s%s%s; rooms with settings are %s",
                     setting, room, near ? ", did you mean '" : "", near ? near : "",
                     near ? "'?" : "", list);
}

static bool try_setting(const scene *s, const settable_room *room, const char *name,
                        const char *value) {
    void *present = room->present(s), *world = present ? present : room->trial();
    bool ok = world && room->set(world, name, value);
    if (!present && world) {
        room->discard(world);
    }
    return ok;
}

static bool keep_setting(scene *s, const scene_kept_setting *kept) {
    if (!s->setting) {
        s->setting = core_alloc(sizeof *s->setting * SCENE_MAX_SETTINGS);
    }
    for (uint32_t i = 0; i < s->setting_count; i++) {
        scene_kept_setting *old = &s->setting[i];
        if (strcmp(old->room, kept->room) == 0 && strcmp(old->name, kept->name) == 0) {
            *old = *kept;
            return true;
        }
    }
    if (s->setting_count == SCENE_MAX_SETTINGS) {
        return core_fail("setting '%s.%s': more than %d different settings", kept->room, kept->name,
                         SCENE_MAX_SETTINGS);
    }
    s->setting[s->setting_count++] = *kept;
    return true;
}

bool scene_setting(scene *s, const char *name, const char *value) {
    scene_kept_setting kept = {0};
    const char *dot = strchr(name, '.');
    size_t room_length = dot ? (size_t)(dot - name) : 0;
    if (!dot || room_length >= sizeof kept.room || strlen(dot + 1) >= sizeof kept.name ||
        strlen(value) >= sizeof kept.value) {
        return core_fail("setting '%s=%s': expected ROOM.NAME=VALUE, as phys.solver=soft", name,
                         value);
    }
    memcpy(kept.room, name, room_length);
    strcpy(kept.name, dot + 1);
    strcpy(kept.value, value);
    const settable_room *room = find_room(kept.room);
    if (!room) {
        return unknown_room(name, kept.room);
    }
    return try_setting(s, room, kept.name, kept.value) && keep_setting(s, &kept);
}

void scene_settings_apply(const scene *s, const char *name, void *world) {
    const settable_room *room = find_room(name);
    for (uint32_t i = 0; world && i < s->setting_count; i++) {
        if (strcmp(s->setting[i].room, name) == 0) {
            room->set(world, s->setting[i].name, s->setting[i].value);
        }
    }
}
