#include "anim/anim_internal.h"

#include "core/nearest.h"

#include <stdlib.h>
#include <string.h>

CORE_COLUMNS_DEFINE(anim_players, ANIM_PLAYER_COLUMNS)
CORE_COLUMNS_DEFINE(anim_instances, ANIM_INSTANCE_COLUMNS)
CORE_COLUMNS_DEFINE(anim_chunks, ANIM_CHUNK_COLUMNS)
CORE_COLUMNS_DEFINE(anim_resources, ANIM_RESOURCE_COLUMNS)

#define DEFAULT_INSTANCES (1u << 16)
#define DEFAULT_BONES     (1u << 22)
#define MAX_RESOURCES     (1u << 16)
#define SCRATCH_BYTES     ((size_t)64 << 20)

anim_world_desc anim_world_desc_default(void) {
    return (anim_world_desc){
        .max_instances = DEFAULT_INSTANCES, .max_bones = DEFAULT_BONES, .cookie = ANIM_COOKIE};
}

static bool init_sets(anim_world *w, uint32_t instances) {
    uint32_t chunks = w->max_bones / CORE_LANES + instances;
    return anim_resources_init(&w->skeletons, "anim.skeletons", MAX_RESOURCES) &&
           anim_resources_init(&w->clips, "anim.clips", MAX_RESOURCES) &&
           anim_resources_init(&w->machines, "anim.machines", MAX_RESOURCES) &&
           anim_resources_init(&w->masks, "anim.masks", MAX_RESOURCES) &&
           anim_instances_init(&w->instances, "anim.instances", instances) &&
           anim_players_init(&w->players, "anim.players", instances * (1 + ANIM_MAX_LAYERS)) &&
           anim_chunks_init(&w->chunks, "anim.snapshots", chunks);
}

anim_world *anim_world_create(const anim_world_desc *desc) {
    if (!desc || desc->cookie != ANIM_COOKIE) {
        core_fail("anim_world_create: the description was not made by anim_world_desc_default()");
        return NULL;
    }
    anim_world *w = core_alloc(sizeof *w);
    w->jobs = desc->jobs;
    w->metrics = desc->metrics;
    w->max_bones = desc->max_bones ? desc->max_bones : DEFAULT_BONES;
    uint32_t instances = desc->max_instances ? desc->max_instances : DEFAULT_INSTANCES;
    size_t palette = (size_t)w->max_bones * ANIM_PALETTE_FLOATS * sizeof(float);
    w->palette = core_reserve(palette);
    if (!w->palette || !init_sets(w, instances)) {
        anim_world_destroy(w);
        return NULL;
    }
    return w;
}

static void free_skeleton(void *item) {
    anim_skeleton_res *s = item;
    core_free(s->free_place);
    core_free(s);
}

static void free_items(anim_resources *set, void (*release)(void *)) {
    for (uint32_t row = 0; row < core_columns_count(&set->set); row++) {
        release(set->item[row]);
    }
    core_columns_release(&set->set);
}

void anim_world_destroy(anim_world *w) {
    if (!w) {
        return;
    }
    free_items(&w->skeletons, free_skeleton);
    free_items(&w->clips, anim_clip_free);
    free_items(&w->machines, core_free);
    free_items(&w->masks, core_free);
    core_columns_release(&w->instances.set);
    core_columns_release(&w->players.set);
    core_columns_release(&w->chunks.set);
    if (w->palette) {
        core_unreserve(w->palette, (size_t)w->max_bones * ANIM_PALETTE_FLOATS * sizeof(float));
    }
    for (uint32_t i = 0; i < w->scratch_count; i++) {
        core_arena_release(&w->scratch[i]);
    }
    core_free(w->event);
    core_free(w);
}

// w NULL: only whether the setting is good (the room is made later).
bool anim_world_set(anim_world *w, const char *name, const char *value) {
    static const char *const names[] = {"pack", "batch", "lod"};
    anim_world unused, *to = w ? w : &unused;
    char *end = NULL;
    if (strcmp(name, "pack") == 0) {
        float bound = strtof(value, &end);
        if (end == value || *end || !(bound >= 0 && bound <= 1)) {
            return core_fail("anim.pack=%s: expected metres from 0 (keep keys) to 1", value);
        }
        to->pack_bound = bound;
        return true;
    }
    if (strcmp(name, "lod") == 0) {
        float pixels = strtof(value, &end);
        if (end == value || *end || !(pixels >= 0 && pixels <= 100)) {
            return core_fail("anim.lod=%s: expected pixels from 0 (every palette is new) to 100",
                             value);
        }
        to->lod = pixels;
        return true;
    }
    if (strcmp(name, "batch") == 0) {
        bool off = strcmp(value, "off") == 0;
        if (!off && strcmp(value, "on") != 0) {
            return core_fail("anim.batch=%s: expected on or off", value);
        }
        to->unbatched = off;
        return true;
    }
    const char *near = core_nearest(name, names, CORE_COUNT_OF(names));
    return core_fail("anim.%s: no such setting%s%s%s", name, near ? "; did you mean anim." : "",
                     near ? near : "", near ? "?" : "");
}

float anim_world_lod(const anim_world *w) { return w->lod; }

int anim_world_state(const anim_world *w, const core_columns **out, int capacity) {
    const core_columns *sets[] = {&w->instances.set, &w->players.set, &w->chunks.set};
    int n = (int)CORE_COUNT_OF(sets);
    for (int i = 0; out && i < n && i < capacity; i++) {
        out[i] = sets[i];
    }
    return n;
}

size_t anim_world_bytes(const anim_world *w) {
    size_t bytes = sizeof *w + core_columns_bytes(&w->skeletons.set) +
                   core_columns_bytes(&w->clips.set) + core_columns_bytes(&w->machines.set) +
                   core_columns_bytes(&w->masks.set) + core_columns_bytes(&w->instances.set) +
                   core_columns_bytes(&w->players.set) + core_columns_bytes(&w->chunks.set) +
                   (size_t)w->bones_committed * ANIM_PALETTE_FLOATS * sizeof(float) +
                   w->event_capacity * sizeof(anim_event);
    for (uint32_t i = 0; i < w->scratch_count; i++) {
        bytes += w->scratch[i].committed;
    }
    return bytes;
}

void anim_world_counts(const anim_world *w, core_metrics *metrics) {
    core_metrics_set(metrics, CORE_COUNT_SKELETONS, core_columns_count(&w->instances.set));
    core_metrics_set(metrics, CORE_COUNT_BONES, w->bones_live);
}

static void *get(const anim_resources *set, core_handle h, const char *kind) {
    uint32_t row = core_columns_row(&set->set, h);
    if (row == CORE_NO_ROW) {
        core_fail("this %s does not exist (index %u, generation %u): it is null or was destroyed",
                  kind, h.index, h.generation);
        return NULL;
    }
    return set->item[row];
}

anim_skeleton_res *anim_get_skeleton(const anim_world *w, anim_skeleton h) {
    return get(&w->skeletons, h, "skeleton");
}
anim_clip_res *anim_get_clip(const anim_world *w, anim_clip h) {
    return get(&w->clips, h, "animation clip");
}
anim_machine_res *anim_get_machine(const anim_world *w, anim_machine h) {
    return get(&w->machines, h, "state machine");
}

anim_mask_res *anim_get_mask(const anim_world *w, anim_mask h) {
    return get(&w->masks, h, "bone mask");
}

bool anim_mask_alive(const anim_world *w, anim_mask h) {
    return core_columns_row(&w->masks.set, h) != CORE_NO_ROW;
}
bool anim_skeleton_alive(const anim_world *w, anim_skeleton h) {
    return core_columns_row(&w->skeletons.set, h) != CORE_NO_ROW;
}
bool anim_clip_alive(const anim_world *w, anim_clip h) {
    return core_columns_row(&w->clips.set, h) != CORE_NO_ROW;
}
bool anim_machine_alive(const anim_world *w, anim_machine h) {
    return core_columns_row(&w->machines.set, h) != CORE_NO_ROW;
}

uint32_t anim_get_instance(const anim_world *w, anim_instance h) {
    uint32_t row = core_columns_row(&w->instances.set, h);
    if (row == CORE_NO_ROW || (w->instances.flags[row] & ANIM_DOOMED)) {
        core_fail("this animation instance does not exist (index %u, generation %u): it is null or "
                  "was destroyed",
                  h.index, h.generation);
        return CORE_NO_ROW;
    }
    return row;
}

core_handle anim_resource_add(anim_resources *set, void *item) {
    core_handle h = core_columns_add(&set->set);
    if (!core_handle_is_null(h)) {
        set->item[core_columns_row(&set->set, h)] = item;
    }
    return h;
}

core_arena *anim_scratch(anim_world *w, uint32_t worker) {
    while (w->scratch_count <= worker) {
        if (!core_arena_init(&w->scratch[w->scratch_count], "anim.scratch", SCRATCH_BYTES)) {
            return NULL;
        }
        w->scratch_count++;
    }
    return &w->scratch[worker];
}

float *anim_scratch_pose(core_arena *arena, const anim_skeleton_res *s) {
    return CORE_ARENA_ARRAY(arena, float, ANIM_COMPONENTS * s->stride);
}

bool anim_unknown(const char *what, const char *name, const void *names, size_t stride,
                  uint32_t count) {
    const char *list[ANIM_MAX_STATES];
    uint32_t n = CORE_MIN(count, ANIM_MAX_STATES);
    for (uint32_t i = 0; i < n; i++) {
        list[i] = (const char *)names + i * stride;
    }
    const char *near = core_nearest(name, list, n);
    return near ? core_fail("state machine: %s \"%s\"; nearest is \"%s\"", what, name, near)
                : core_fail("state machine: %s \"%s\"", what, name);
}
