#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/hash.h"
#include "scene/scene_internal.h"

#define SCENE_COOKIE   0x5ce7e001u
#define SCENE_MAX_SETS 256

CORE_COLUMNS_DEFINE(scene_entities, SCENE_ENTITY_COLUMNS)
CORE_COLUMNS_DEFINE(scene_names, SCENE_NAME_COLUMNS)
CORE_COLUMNS_DEFINE(scene_clock, SCENE_CLOCK_COLUMNS)
CORE_COLUMNS_DEFINE(scene_feet, SCENE_FEET_COLUMNS)
CORE_COLUMNS_DEFINE(scene_ragdolls, SCENE_RAGDOLL_COLUMNS)

static const char *const rooms[] = {"scene", "script", "phys", "gfx", "anim", "nav", "audio"};

scene_desc scene_desc_default(void) {
    return (scene_desc){.dt = 1.0f / 60.0f, .max_entities = 1u << 20, .cookie = SCENE_COOKIE};
}

static bool good_dt(float dt) { return isfinite(dt) && dt > 0.0f && dt <= 1.0f; }

static void seed_streams(scene *s, uint64_t seed) {
    s->seed = seed;
    s->clock.sim[0] = core_rng_make(seed, CORE_RNG_SIM);
    s->view_rng = core_rng_make(seed, CORE_RNG_VIEW);
}

scene *scene_create(const scene_desc *desc) {
    if (!desc || desc->cookie != SCENE_COOKIE) {
        core_fail("scene: description was not made by scene_desc_default()");
        return NULL;
    }
    float dt = desc->dt == 0.0f ? 1.0f / 60.0f : desc->dt;
    if (!good_dt(dt)) {
        core_fail("scene: dt is %g s, expected 0 < dt <= 1", (double)dt);
        return NULL;
    }
    scene *s = core_alloc(sizeof *s);
    s->moves = 1;
    uint32_t most = desc->max_entities ? desc->max_entities : 1u << 20;
    s->jobs = desc->jobs;
    s->metrics = desc->metrics;
    s->vfs = desc->vfs;
    s->dt = dt;
    if (!scene_entities_init(&s->entity, "scene.entities", most) ||
        !scene_names_init(&s->name, "scene.names", most) ||
        !scene_clock_init(&s->clock, "scene.clock", 1)) {
        scene_destroy(s);
        return NULL;
    }
    core_columns_add(&s->clock.set);
    seed_streams(s, desc->seed);
    return s;
}

void scene_destroy(scene *s) {
    if (!s) {
        return;
    }
    scene_models_destroy(s);
    anim_world_destroy(s->anim);
    scene_surfaces_release(s);
    nav_world_destroy(s->nav);
    scene_audio_destroy(s);
    if (s->phys) {
        phys_world_destroy(s->phys);
    }
    if (s->gfx) {
        gfx_world_destroy(s->gfx);
    }
    core_columns_release(&s->feet.set);
    core_columns_release(&s->ragdoll.set);
    core_columns_release(&s->entity.set);
    core_columns_release(&s->name.set);
    core_columns_release(&s->clock.set);
    core_free(s->setting);
    core_free(s->tag);
    core_free(s->order);
    core_free(s->depth_start);
    core_free(s);
}

void scene_set_hooks(scene *s, const scene_hooks *hooks) {
    s->hooks = hooks ? *hooks : (scene_hooks){0};
}

bool scene_configure(scene *s, core_jobs *jobs, uint64_t seed, float dt) {
    if (s->phys || s->gfx || s->anim || s->nav || s->audio || scene_step_index(s) ||
        scene_entity_count(s)) {
        return core_fail("scene: workers, seed and dt are fixed once the scene has begun; set them "
                         "in corsac.conf or on the command line");
    }
    if (!good_dt(dt)) {
        return core_fail("scene: dt is %g s, expected 0 < dt <= 1", (double)dt);
    }
    s->jobs = jobs;
    s->dt = dt;
    seed_streams(s, seed);
    return true;
}

// ---- rooms ----

bool scene_room_built(const char *room) {
    for (size_t i = 0; i < CORE_COUNT_OF(rooms); i++) {
        if (strcmp(room, rooms[i]) == 0) {
            return true;
        }
    }
    return false;
}

phys_world *scene_phys(scene *s) {
    if (!s->phys) {
        phys_world_desc desc = phys_world_desc_default();
        desc.jobs = s->jobs;
        desc.metrics = s->metrics;
        s->phys = phys_world_create(&desc);
        scene_settings_apply(s, "phys", s->phys);
    }
    return s->phys;
}

gfx_world *scene_gfx(scene *s) {
    if (!s->gfx) {
        gfx_world_desc desc = gfx_world_desc_default();
        desc.jobs = s->jobs;
        desc.metrics = s->metrics;
        desc.vfs = s->vfs;
        s->gfx = gfx_world_create(&desc);
        scene_settings_apply(s, "gfx", s->gfx);
    }
    return s->gfx;
}

phys_world *scene_phys_if(const scene *s) { return s->phys; }
gfx_world *scene_gfx_if(const scene *s) { return s->gfx; }
core_metrics *scene_metrics(const scene *s) { return s->metrics; }
core_vfs *scene_vfs(const scene *s) { return s->vfs; }

int scene_layer(scene *s, const char *name) {
    if (!s->layer_count) {
        strcpy(s->layer[s->layer_count++], "default");
    }
    for (uint32_t i = 0; i < s->layer_count; i++) {
        if (strcmp(s->layer[i], name) == 0) {
            return (int)i;
        }
    }
    if (!name[0] || strlen(name) >= SCENE_LAYER_NAME || s->layer_count == CORE_COUNT_OF(s->layer)) {
        core_fail("layer '%.40s': at most %zu layers, with names of 1 to %d bytes", name,
                  CORE_COUNT_OF(s->layer), SCENE_LAYER_NAME - 1);
        return -1;
    }
    strcpy(s->layer[s->layer_count], name);
    return (int)s->layer_count++;
}

const char *scene_layer_name(const scene *s, uint32_t layer) {
    return layer < s->layer_count ? s->layer[layer] : layer == 0 ? "default" : "";
}

core_rng *scene_rng(scene *s, uint64_t stream) {
    return stream == CORE_RNG_VIEW ? &s->view_rng : &s->clock.sim[0];
}

// ---- the step ----

bool scene_step(scene *s) {
    core_stage_begin(s->metrics, CORE_STAGE_SCENE);
    scene_keep_previous(s);
    core_stage_end(s->metrics, CORE_STAGE_SCENE);
    if (s->hooks.fixed) {
        core_stage_begin(s->metrics, CORE_STAGE_SCRIPT);
        s->hooks.fixed(s->hooks.ctx, s->dt);
        core_stage_end(s->metrics, CORE_STAGE_SCRIPT);
    }
    bool ok = true;
    scene_nav_step(s);
    scene_anim_update(s);
    if (s->phys) {
        ok = phys_world_step(s->phys, s->dt);
    }
    core_stage_begin(s->metrics, CORE_STAGE_SCENE);
    scene_pull_bodies(s);
    scene_world_of_children(s);
    core_stage_end(s->metrics, CORE_STAGE_SCENE);
    if (s->hooks.events) {
        core_stage_begin(s->metrics, CORE_STAGE_SCRIPT);
        s->hooks.events(s->hooks.ctx);
        core_stage_end(s->metrics, CORE_STAGE_SCRIPT);
    }
    scene_ragdoll_step(s);
    scene_feet_step(s);
    scene_anim_pose(s);
    scene_audio_step(s);
    scene_emitters_step(s);
    s->clock.step[0]++;
    return ok;
}

uint64_t scene_step_index(const scene *s) { return s->clock.step[0]; }
float scene_dt(const scene *s) { return s->dt; }

// ---- state, counts, memory ----

int scene_state(const scene *s, const core_columns **out, int capacity) {
    const core_columns *own[] = {&s->clock.set, &s->entity.set, &s->name.set};
    int count = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(own); i++, count++) {
        if (out && count < capacity) {
            out[count] = own[i];
        }
    }
    if (s->stands) {
        if (out && count < capacity) {
            out[count] = &s->feet.set;
        }
        count++;
    }
    if (s->falls) {
        if (out && count < capacity) {
            out[count] = &s->ragdoll.set;
        }
        count++;
    }
    if (s->phys) {
        int room = capacity > count ? capacity - count : 0;
        count += phys_world_state(s->phys, out && room ? out + count : NULL, room);
    }
    if (s->anim) {
        int room = capacity > count ? capacity - count : 0;
        count += anim_world_state(s->anim, out && room ? out + count : NULL, room);
    }
    if (s->nav) {
        int room = capacity > count ? capacity - count : 0;
        count += nav_world_state(s->nav, out && room ? out + count : NULL, room);
    }
    if (s->audio) {
        int room = capacity > count ? capacity - count : 0;
        count += audio_world_state(s->audio, out && room ? out + count : NULL, room);
    }
    return count;
}

uint64_t scene_hash(const scene *s) {
    const core_columns *set[SCENE_MAX_SETS];
    int count = scene_state(s, set, SCENE_MAX_SETS);
    uint64_t hash = 0;
    for (int i = 0; i < CORE_MIN(count, SCENE_MAX_SETS); i++) {
        uint64_t column[CORE_COLUMNS_MAX];
        core_columns_hash(set[i], column);
        hash = core_hash_mix(hash, core_hash_string(set[i]->name));
        hash = core_hash_mix(hash, core_columns_count(set[i]));
        for (uint32_t c = 0; c < set[i]->column_count; c++) {
            hash = core_hash_mix(hash, column[c]);
        }
    }
    return hash;
}

void scene_describe_row(const scene *s, const core_columns *set, uint32_t row, char *out,
                        size_t size) {
    if (row >= core_columns_count(set)) {
        snprintf(out, size, "%s (no single row)", set->name);
        return;
    }
    core_handle h = core_columns_handle(set, row);
    scene_entity e = CORE_NULL_HANDLE;
    if (set == &s->entity.set) {
        e = h;
    } else if (set == &s->name.set) {
        e = s->name.entity[row];
    } else if (s->phys && strcmp(set->name, "phys.bodies") == 0) {
        e = scene_entity_of_body(s, h);
    }
    const char *name = core_handle_is_null(e) ? "" : scene_entity_name(s, e);
    if (name[0]) {
        snprintf(out, size, "%s row %u (entity '%s', handle %u:%u)", set->name, row, name, h.index,
                 h.generation);
    } else {
        snprintf(out, size, "%s row %u (handle %u:%u)", set->name, row, h.index, h.generation);
    }
}

void scene_counts(const scene *s) {
    // A former scene may have left counts of rooms that this one never made.
    for (int i = 0; i < CORE_COUNT_TOTAL; i++) {
        if (i != CORE_COUNT_LUA_KB) {
            core_metrics_set(s->metrics, (core_count)i, 0.0);
        }
    }
    core_metrics_set(s->metrics, CORE_COUNT_ENTITIES, core_columns_count(&s->entity.set));
    if (s->phys) {
        phys_world_counts(s->phys, s->metrics);
    }
    if (s->gfx) {
        gfx_world_counts(s->gfx, s->metrics);
    }
    if (s->anim) {
        anim_world_counts(s->anim, s->metrics);
    }
    if (s->nav) {
        nav_world_counts(s->nav, s->metrics);
    }
    if (s->audio) {
        audio_world_counts(s->audio, s->metrics);
    }
}

scene_memory scene_memory_use(const scene *s) {
    scene_memory m = {0};
    m.core = sizeof *s + core_columns_bytes(&s->entity.set) + core_columns_bytes(&s->name.set) +
             core_columns_bytes(&s->clock.set) +
             ((size_t)s->order_capacity + s->depth_capacity) * sizeof(uint32_t) +
             (s->setting ? sizeof *s->setting * SCENE_MAX_SETTINGS : 0);
    m.phys = s->phys ? phys_world_bytes(s->phys) : 0;
    m.gfx = s->gfx ? gfx_world_bytes(s->gfx) : 0;
    m.nav = s->nav ? nav_world_bytes(s->nav) : 0;
    m.audio = s->audio ? audio_world_bytes(s->audio) : 0;
    m.anim = s->anim ? anim_world_bytes(s->anim) : 0;
    return m;
}
