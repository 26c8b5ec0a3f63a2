// Sound: sources that follow entities, a listener that follows the camera or an entity.
#include <string.h>

#include "asset/asset.h"
#include "core/hash.h"
#include "scene/scene_internal.h"

typedef struct loaded_sound {
    uint64_t path;
    audio_sound sound;
} loaded_sound;

// Sounds already read, by path: many sources share one.
struct scene_sounds {
    loaded_sound *item; // [capacity]
    uint32_t count, capacity;
};

audio_world *scene_audio(scene *s) {
    if (!s->audio) {
        audio_world_desc desc = audio_world_desc_default();
        desc.metrics = s->metrics;
        s->audio = audio_world_create(&desc);
        scene_settings_apply(s, "audio", s->audio);
    }
    return s->audio;
}

audio_world *scene_audio_if(const scene *s) { return s->audio; }

void scene_audio_destroy(scene *s) {
    audio_world_destroy(s->audio);
    if (s->sounds) {
        core_free(s->sounds->item);
        core_free(s->sounds);
    }
}

audio_sound scene_sound_load(scene *s, const char *path) {
    uint64_t key = core_hash_string(path);
    if (!s->sounds) {
        s->sounds = core_alloc(sizeof *s->sounds);
    }
    scene_sounds *all = s->sounds;
    for (uint32_t i = 0; i < all->count; i++) {
        if (all->item[i].path == key && audio_sound_alive(s->audio, all->item[i].sound)) {
            return all->item[i].sound;
        }
    }
    core_sound_data *data = asset_sound_load(s->vfs, path);
    if (!data || !scene_audio(s)) {
        return CORE_NULL_HANDLE;
    }
    audio_sound sound = audio_sound_create(s->audio, data);
    core_free(data);
    if (all->count == all->capacity) {
        uint32_t grown = CORE_MAX(16u, all->capacity * 2);
        all->item =
            core_realloc(all->item, all->capacity * sizeof *all->item, grown * sizeof *all->item);
        all->capacity = grown;
    }
    all->item[all->count++] = (loaded_sound){key, sound};
    return sound;
}

bool scene_set_sound(scene *s, scene_entity e, audio_source source) {
    uint32_t row = scene_row(s, e);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!s->audio || !audio_source_alive(s->audio, source)) {
        return core_fail("scene: entity '%s' cannot sound: the source was destroyed",
                         scene_entity_name(s, e));
    }
    scene_audio_leave(s, row);
    s->entity.source[row] = source;
    s->sounding = true;
    audio_source_set_user(s->audio, source, core_handle_bits(e));
    return audio_source_set_position(
        s->audio, source, (core_vec3){s->entity.wpx[row], s->entity.wpy[row], s->entity.wpz[row]});
}

void scene_audio_leave(scene *s, uint32_t row) {
    if (s->audio && audio_source_alive(s->audio, s->entity.source[row])) {
        audio_source_destroy(s->audio, s->entity.source[row]);
    }
    s->entity.source[row] = CORE_NULL_HANDLE;
}

bool scene_set_listener(scene *s, scene_entity e) {
    if (!core_handle_is_null(e) && scene_row(s, e) == CORE_NO_ROW) {
        return false;
    }
    s->listener = e;
    s->listener_placed = false;
    return true;
}

void scene_place_listener(scene *s, const audio_listener *listener) {
    s->listener = CORE_NULL_HANDLE;
    s->listener_placed = true;
    audio_world_set_listener(scene_audio(s), listener);
}

// Velocity for Doppler is how far a thing moved in the step; more than the speed of sound is a
// teleport and no motion.
static core_vec3 step_velocity(const scene *s, core_vec3 old, core_vec3 now) {
    core_vec3 v = core_v3_scale(core_v3_sub(now, old), 1.0f / s->dt);
    return core_v3_dot(v, v) < 340.0f * 340.0f ? v : core_v3(0, 0, 0);
}

static void move_listener(scene *s) {
    audio_listener l = audio_world_listener(s->audio);
    core_vec3 old = l.position;
    uint32_t row = core_columns_row(&s->entity.set, s->listener);
    if (row != CORE_NO_ROW) {
        l.position = (core_vec3){s->entity.wpx[row], s->entity.wpy[row], s->entity.wpz[row]};
        l.rotation = (core_quat){s->entity.wqx[row], s->entity.wqy[row], s->entity.wqz[row],
                                 s->entity.wqw[row]};
    } else if (s->gfx && !s->listener_placed) {
        gfx_camera camera = gfx_world_camera(s->gfx);
        l.position = camera.position;
        l.rotation = camera.rotation;
    } else {
        return;
    }
    l.velocity = step_velocity(s, old, l.position);
    audio_world_set_listener(s->audio, &l);
}

static void move_sources(scene *s) {
    scene_entities *e = &s->entity;
    for (uint32_t row = 0; row < core_columns_count(&e->set); row++) {
        audio_source source = e->source[row];
        if (core_handle_is_null(source)) {
            continue;
        }
        if (!audio_source_alive(s->audio, source)) {
            e->source[row] = CORE_NULL_HANDLE;
            continue;
        }
        core_vec3 now = {e->wpx[row], e->wpy[row], e->wpz[row]};
        core_vec3 v = step_velocity(s, audio_source_position(s->audio, source), now);
        audio_source_set_velocity(s->audio, source, v);
        audio_source_set_position(s->audio, source, now);
    }
}

// What a voice of the last step loses on its straight way to the listener: nothing, or most of it
// when a body is between that belongs to neither. Goes over in a sixth of a second, so that a
// corner does not click.
static void look_for_obstacles(scene *s) {
    const float muffled = 0.3f, speed = 6.0f * s->dt;
    uint32_t count;
    const audio_voice *voice = audio_world_voices(s->audio, &count);
    core_vec3 ear = audio_world_listener(s->audio).position;
    phys_filter filter = phys_filter_default();
    filter.skip = scene_entity_body(s, s->listener);
    for (uint32_t i = 0; i < count; i++) {
        if (voice[i].flat || !audio_source_alive(s->audio, voice[i].source)) {
            continue;
        }
        scene_entity owner = {(uint32_t)voice[i].user, (uint32_t)(voice[i].user >> 32)};
        core_vec3 way = core_v3_sub(audio_source_position(s->audio, voice[i].source), ear);
        phys_hit hit = {0};
        bool blocked = core_v3_dot(way, way) > 1e-4f &&
                       phys_world_ray(s->phys, ear, way, &filter, &hit) &&
                       !core_handle_equal(hit.body, scene_entity_body(s, owner));
        float target = blocked ? muffled : 1.0f, now = voice[i].clear;
        now = now < target ? CORE_MIN(now + speed, target) : CORE_MAX(now - speed, target);
        audio_source_set_clear(s->audio, voice[i].source, now);
    }
}

void scene_audio_step(scene *s) {
    if (!s->audio) {
        return;
    }
    core_stage_begin(s->metrics, CORE_STAGE_AUDIO);
    move_listener(s);
    if (s->sounding) {
        move_sources(s);
    }
    if (s->phys && audio_world_occlusion(s->audio)) {
        look_for_obstacles(s);
    }
    audio_world_step(s->audio, s->dt);
    core_stage_end(s->metrics, CORE_STAGE_AUDIO);
}
