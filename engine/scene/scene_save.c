// A whole scene in one file. What load() makes of code and files (models, sounds, surfaces, the
// functions of a script) is not in it: a save is loaded into the scene that wrote it, which may by
// then have lived on, or just begun.
#include <stdio.h>
#include <string.h>

#include "core/hash.h"
#include "scene/scene_internal.h"

#define SAVE_VERSION    1u
#define SAVE_SCRIPT_MAX (16u << 20) // bytes

typedef struct save_header {
    char magic[4]; // "CSV1"
    uint32_t unused;
    uint64_t size, hash; // of what follows
} save_header;

enum { ROOM_PHYS = 1, ROOM_ANIM = 2, ROOM_NAV = 4, ROOM_AUDIO = 8, ROOM_GFX = 16 };

static uint32_t rooms_of(const scene *s) {
    return (s->phys ? ROOM_PHYS : 0u) | (s->anim ? ROOM_ANIM : 0u) | (s->nav ? ROOM_NAV : 0u) |
           (s->audio ? ROOM_AUDIO : 0u) | (s->gfx ? ROOM_GFX : 0u);
}

static bool alive_or_null(const core_columns *set, core_handle h) {
    return core_handle_is_null(h) || core_columns_row(set, h) != CORE_NO_ROW;
}

// Parents are one step nearer to the root, so that no chain of them goes in a circle; siblings
// point at each other.
static bool links_stand(const scene *s, uint32_t row) {
    const scene_entities *e = &s->entity;
    scene_entity self = core_columns_handle(&e->set, row);
    uint32_t up = core_columns_row(&e->set, e->parent[row]);
    uint32_t first = core_columns_row(&e->set, e->first_child[row]);
    uint32_t next = core_columns_row(&e->set, e->next_sibling[row]);
    uint32_t last = core_columns_row(&e->set, e->prev_sibling[row]);
    bool parent = up == CORE_NO_ROW ? core_handle_is_null(e->parent[row]) && e->depth[row] == 0
                                    : e->depth[row] == e->depth[up] + 1;
    return parent && alive_or_null(&e->set, e->first_child[row]) &&
           alive_or_null(&e->set, e->next_sibling[row]) &&
           alive_or_null(&e->set, e->prev_sibling[row]) &&
           (first == CORE_NO_ROW || core_handle_equal(e->parent[first], self)) &&
           (next == CORE_NO_ROW || core_handle_equal(e->prev_sibling[next], self)) &&
           (last == CORE_NO_ROW || core_handle_equal(e->next_sibling[last], self)) &&
           (last != CORE_NO_ROW || up == CORE_NO_ROW ||
            core_handle_equal(e->first_child[up], self));
}

static bool parts_stand(const scene *s, uint32_t row) {
    const scene_entities *e = &s->entity;
    core_handle null = CORE_NULL_HANDLE;
    bool body = s->phys
                    ? core_handle_is_null(e->body[row]) || phys_body_alive(s->phys, e->body[row])
                    : core_handle_equal(e->body[row], null);
    bool anim =
        s->anim ? core_handle_is_null(e->anim[row]) || anim_instance_alive(s->anim, e->anim[row])
                : core_handle_equal(e->anim[row], null);
    bool skin =
        s->anim ? core_handle_is_null(e->skin[row]) || anim_instance_alive(s->anim, e->skin[row])
                : core_handle_equal(e->skin[row], null);
    bool shown = s->gfx ? core_handle_is_null(e->instance[row]) ||
                              gfx_instance_alive(s->gfx, e->instance[row])
                        : core_handle_equal(e->instance[row], null);
    return body && anim && skin && shown && alive_or_null(&s->name.set, e->name[row]);
}

static bool check_entities(const scene *s, core_stream *stream) {
    for (uint32_t row = 0; row < core_columns_count(&s->entity.set); row++) {
        if (!links_stand(s, row)) {
            return core_stream_fail(stream, "scene.entities.parent",
                                    "row %u hangs on entities that are not", row);
        }
        if (!parts_stand(s, row)) {
            return core_stream_fail(stream, "scene.entities", "row %u has parts that are not", row);
        }
    }
    for (uint32_t n = 0; n < core_columns_count(&s->name.set); n++) {
        if (core_columns_row(&s->entity.set, s->name.entity[n]) == CORE_NO_ROW ||
            s->name.text[n].text[SCENE_NAME_MAX - 1]) {
            return core_stream_fail(stream, "scene.names", "row %u names no entity", n);
        }
    }
    return true;
}

// What follows from state: poses in the world, the order of parents, what was drawn.
static void refresh(scene *s) {
    scene_entities *e = &s->entity;
    uint32_t count = core_columns_count(&e->set);
    s->order_stale = true;
    s->sounding = false;
    for (uint32_t row = 0; row < count; row++) {
        e->changed[row] = s->moves;
        if (core_handle_is_null(e->parent[row])) {
            scene_world_of(s, row);
        }
        s->sounding |= !core_handle_is_null(e->source[row]);
        e->drawn[row] = (scene_drawn){0};
    }
    scene_pull_bodies(s);
    scene_world_of_children(s);
    for (uint32_t row = 0; row < count; row++) {
        scene_interpolation_reset(s, row);
    }
}

static bool stream_names(core_stream *stream, const char *list, char *text, size_t size,
                         uint32_t *count, uint32_t most) {
    bool good = core_stream_open(stream, list) && core_stream_count(stream, "count", count, most);
    for (uint32_t i = 0; good && i < *count; i++) {
        good = core_stream_string(stream, "name", text + i * size, size);
    }
    return good && core_stream_close(stream);
}

// What no hash sees: what shows each entity, the view's random numbers, who hears.
static bool stream_view(scene *s, core_stream *stream) {
    scene_entities *e = &s->entity;
    uint32_t placed = s->listener_placed, n = core_columns_count(&e->set);
    size_t handles = n * sizeof(core_handle), floats = n * sizeof(float);
    bool good = core_stream_open(stream, "view") &&
                core_stream_list(stream, "random", 'x', &s->view_rng, sizeof s->view_rng) &&
                core_stream_list(stream, "listener", 'u', &s->listener, sizeof s->listener) &&
                core_stream_count(stream, "listener_placed", &placed, 1) &&
                core_stream_list(stream, "instance", 'u', e->instance, handles) &&
                core_stream_list(stream, "skin", 'u', e->skin, handles) &&
                core_stream_list(stream, "size_x", 'f', e->dx, floats) &&
                core_stream_list(stream, "size_y", 'f', e->dy, floats) &&
                core_stream_list(stream, "size_z", 'f', e->dz, floats) && core_stream_close(stream);
    s->listener_placed = placed;
    return good && (stream->writing || alive_or_null(&e->set, s->listener) ||
                    core_stream_fail(stream, "listener", "hears as no entity"));
}

static bool stream_rooms(scene *s, core_stream *stream) {
    return (!s->phys || phys_world_stream(s->phys, stream)) &&
           (!s->anim || anim_world_stream(s->anim, stream)) &&
           (!s->nav || nav_world_stream(s->nav, stream)) &&
           (!s->audio || audio_world_stream(s->audio, stream)) &&
           (!s->gfx || gfx_world_stream(s->gfx, stream));
}

// The script's part: text of its own. Reading gives a new block.
static bool stream_script(core_stream *stream, char **text) {
    uint32_t length = *text ? (uint32_t)strlen(*text) : 0;
    if (!core_stream_count(stream, "script_bytes", &length, SAVE_SCRIPT_MAX)) {
        return false;
    }
    if (!stream->writing && length > stream->size - stream->at) {
        return core_stream_fail(stream, "script", "%u bytes expected", length);
    }
    char *block = stream->writing ? *text : core_alloc(length + 1u);
    char none[1] = "";
    bool good = core_stream_string(stream, "script", block ? block : none, length + 1u);
    *text = block;
    return good;
}

static bool stream_all(scene *s, core_stream *stream, char **script) {
    uint32_t dt;
    memcpy(&dt, &s->dt, sizeof dt);
    if (!s->tag) {
        s->tag = core_alloc(sizeof *s->tag * SCENE_MAX_TAGS);
    }
    return core_stream_open(stream, "A scene of Corsac, saved.") &&
           core_stream_same(stream, "version", SAVE_VERSION, "another version of saves") &&
           core_stream_same(stream, "rooms", rooms_of(s),
                            "saved when the scene had other rooms (sound, navigation, ...)") &&
           core_stream_same(stream, "dt", dt, "the scene steps by another time") &&
           core_stream_columns(stream, &s->clock.set) &&
           core_stream_columns(stream, &s->entity.set) &&
           core_stream_columns(stream, &s->name.set) && scene_feet_stream(s, stream) &&
           scene_ragdoll_stream(s, stream) &&
           stream_names(stream, "layers", s->layer[0], SCENE_LAYER_NAME, &s->layer_count, 32) &&
           stream_names(stream, "tags", s->tag[0], SCENE_TAG_NAME, &s->tag_count, SCENE_MAX_TAGS) &&
           stream_rooms(s, stream) && stream_view(s, stream) && stream_script(stream, script) &&
           core_stream_close(stream) &&
           (core_columns_count(&s->clock.set) == 1 ||
            core_stream_fail(stream, "scene.clock", "one row expected"));
}

void *scene_save(scene *s, core_stream_form form, const char *script, size_t *size) {
    core_stream stream = core_stream_writer("save", form);
    save_header header = {.magic = "CSV1"};
    if (form == CORE_STREAM_BINARY) { // the header's place
        core_stream_list(&stream, "header", 'x', &header, sizeof header);
    }
    char *text = (char *)(uintptr_t)script; // only read
    stream_all(s, &stream, &text);
    if (form == CORE_STREAM_BINARY) {
        header.size = stream.size - sizeof header;
        header.hash = core_hash(stream.data + sizeof header, (size_t)header.size, SAVE_VERSION);
        memcpy(stream.data, &header, sizeof header);
    }
    *size = stream.size;
    return stream.data;
}

static bool read_all(scene *s, core_stream *stream, char **script) {
    bool good = stream_all(s, stream, script) && check_entities(s, stream);
    if (good) {
        refresh(s);
    }
    return good;
}

static bool open_save(const char *name, const void *data, size_t size, core_stream *out) {
    save_header header;
    bool binary = size >= 4 && memcmp(data, "CSV1", 4) == 0;
    if (!binary) {
        *out = core_stream_reader(name, CORE_STREAM_TEXT, data, size);
        return (size > 2 && memcmp(data, "--", 2) == 0) ||
               core_fail("%s: no saved scene: expected \"CSV1\" or Lua text", name);
    }
    if (size < sizeof header) {
        return core_fail("%s: header: cut short", name);
    }
    memcpy(&header, data, sizeof header);
    const uint8_t *body = (const uint8_t *)data + sizeof header;
    if (header.size != size - sizeof header) {
        return core_fail("%s: header: %llu bytes expected, %zu follow", name,
                         (unsigned long long)header.size, size - sizeof header);
    }
    if (header.hash != core_hash(body, size - sizeof header, SAVE_VERSION)) {
        return core_fail("%s: header: the checksum is another; the file is damaged", name);
    }
    *out = core_stream_reader(name, CORE_STREAM_BINARY, body, size - sizeof header);
    return true;
}

bool scene_load(scene *s, const char *name, const void *data, size_t size, char **script) {
    core_stream stream;
    *script = NULL;
    if (!open_save(name, data, size, &stream)) {
        return false;
    }
    size_t before_size;
    void *before = scene_save(s, CORE_STREAM_BINARY, NULL, &before_size);
    bool good = read_all(s, &stream, script);
    if (!good) {
        char why[512], *nothing = NULL;
        snprintf(why, sizeof why, "%s", core_last_error());
        core_free(*script);
        *script = NULL;
        core_stream back;
        bool restored =
            open_save("before", before, before_size, &back) && read_all(s, &back, &nothing);
        CORE_ASSERT(restored);
        core_free(nothing);
        good = core_fail_quiet("%s", why);
    }
    core_free(before);
    return good;
}
