// Sources, sounds, groups, listener, settings.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "audio/audio_internal.h"
#include "core/nearest.h"

#define WORLD_COOKIE  0xa0d10001u
#define SOURCE_COOKIE 0xa0d10002u
#define MAX_FRAMES    (1u << 30)

CORE_COLUMNS_DEFINE(audio_sources, AUDIO_SOURCE_COLUMNS)
CORE_COLUMNS_DEFINE(audio_sounds, AUDIO_SOUND_COLUMNS)

audio_world_desc audio_world_desc_default(void) {
    return (audio_world_desc){.max_sources = 1u << 17, .cookie = WORLD_COOKIE};
}

audio_world *audio_world_create(const audio_world_desc *desc) {
    if (!desc || desc->cookie != WORLD_COOKIE) {
        core_fail("audio: description was not made by audio_world_desc_default()");
        return NULL;
    }
    audio_world *w = core_alloc(sizeof *w);
    uint32_t most = desc->max_sources ? desc->max_sources : 1u << 17;
    if (!audio_sources_init(&w->source, "audio.sources", most) ||
        !audio_sounds_init(&w->sound, "audio.sounds", 1u << 14)) {
        audio_world_destroy(w);
        return NULL;
    }
    w->metrics = desc->metrics;
    w->listener.rotation = core_quat_identity();
    w->voices = 32;
    w->volume = w->doppler = 1.0f;
    w->sound_speed = 343.3f;
    audio_world_set_group(w, "effects", 1.0f);
    audio_world_set_group(w, "music", 1.0f);
    return w;
}

void audio_world_destroy(audio_world *w) {
    if (!w) {
        return;
    }
    for (uint32_t row = 0; row < core_columns_count(&w->sound.set); row++) {
        core_free(w->sound.sample[row]);
    }
    core_columns_release(&w->source.set);
    core_columns_release(&w->sound.set);
    core_free(w);
}

size_t audio_world_bytes(const audio_world *w) {
    return sizeof *w + core_columns_bytes(&w->source.set) + core_columns_bytes(&w->sound.set) +
           w->sample_bytes;
}

void audio_world_counts(const audio_world *w, core_metrics *metrics) {
    core_metrics_set(metrics, CORE_COUNT_VOICES, w->voice_count);
}

int audio_world_state(const audio_world *w, const core_columns **out, int capacity) {
    const core_columns *own[] = {&w->source.set, &w->sound.set};
    int count = (int)CORE_COUNT_OF(own);
    for (int i = 0; out && i < CORE_MIN(count, capacity); i++) {
        out[i] = own[i];
    }
    return count;
}

// ---- settings ----

static bool number_setting(const char *name, const char *value, double low, double high,
                           float *out) {
    char *end;
    double number = strtod(value, &end);
    if (end == value || *end || !(number >= low && number <= high)) {
        return core_fail("audio setting %s is '%s', expected a number from %g to %g", name, value,
                         low, high);
    }
    *out = (float)number;
    return true;
}

bool audio_world_set(audio_world *w, const char *name, const char *value) {
    static const char *const names[] = {"voices",  "volume",      "hrtf",
                                        "doppler", "sound_speed", "occlusion"};
    float number;
    if (strcmp(name, "voices") == 0) {
        if (!number_setting(name, value, 1, AUDIO_MAX_VOICES, &number)) {
            return false;
        }
        w->voices = (uint32_t)number;
        return true;
    }
    bool *toggle = strcmp(name, "hrtf") == 0        ? &w->hrtf
                   : strcmp(name, "occlusion") == 0 ? &w->occlusion
                                                    : NULL;
    if (toggle) {
        *toggle = strcmp(value, "on") == 0;
        return *toggle || strcmp(value, "off") == 0 ||
               core_fail("audio setting %s is '%s', expected on or off", name, value);
    }
    if (strcmp(name, "volume") == 0) {
        return number_setting(name, value, 0, 4, &w->volume);
    }
    if (strcmp(name, "doppler") == 0) {
        return number_setting(name, value, 0, 10, &w->doppler);
    }
    if (strcmp(name, "sound_speed") == 0) {
        return number_setting(name, value, 1, 10000, &w->sound_speed);
    }
    const char *near = core_nearest(name, names, CORE_COUNT_OF(names));
    return near ? core_fail("audio setting '%s' is unknown, did you mean %s", name, near)
                : core_fail(
                      "audio setting '%s' is unknown; there are voices, volume, hrtf, doppler, "
                      "sound_speed",
                      name);
}

// ---- groups and listener ----

static uint32_t find_group(const audio_world *w, const char *name) {
    uint32_t i = 0;
    while (i < w->groups && strcmp(w->group[i].name, name) != 0) {
        i++;
    }
    return i;
}

// Index of a group that is made if it is new; AUDIO_MAX_GROUPS + core_fail when it cannot be.
static uint32_t group_for(audio_world *w, const char *name) {
    size_t length = strlen(name);
    uint32_t i = find_group(w, name);
    if (length == 0 || length >= AUDIO_GROUP_NAME) {
        core_fail("audio group '%.40s': its name must have 1 to %d bytes", name,
                  AUDIO_GROUP_NAME - 1);
        return AUDIO_MAX_GROUPS;
    }
    if (i == AUDIO_MAX_GROUPS) {
        core_fail("audio group '%s': more than %d groups", name, AUDIO_MAX_GROUPS);
    } else if (i == w->groups) {
        strcpy(w->group[i].name, name);
        w->group[i].gain = 1.0f;
        w->groups++;
    }
    return i;
}

bool audio_world_set_group(audio_world *w, const char *name, float gain) {
    if (!(gain >= 0.0f && gain <= 16.0f)) {
        return core_fail("audio group '%.40s': gain is %g, expected 0 to 16", name, (double)gain);
    }
    uint32_t i = group_for(w, name);
    if (i == AUDIO_MAX_GROUPS) {
        return false;
    }
    w->group[i].gain = gain;
    return true;
}

float audio_world_group(const audio_world *w, const char *name) {
    uint32_t i = find_group(w, name);
    return i < w->groups ? w->group[i].gain : 1.0f;
}

void audio_world_set_listener(audio_world *w, const audio_listener *listener) {
    w->listener = *listener;
    w->listener.rotation = core_quat_normalize(listener->rotation);
}

bool audio_world_occlusion(const audio_world *w) { return w->occlusion; }

audio_listener audio_world_listener(const audio_world *w) { return w->listener; }

// ---- sounds ----

audio_sound audio_sound_create(audio_world *w, const core_sound_data *data) {
    if (!data || !data->sample || data->channels < 1 || data->channels > 2 || data->rate < 1000 ||
        data->rate > 192000 || data->frame_count < 1 || data->frame_count > MAX_FRAMES) {
        core_fail("audio: a sound needs 1 or 2 channels, 1000 to 192000 Hz and at least one frame");
        return CORE_NULL_HANDLE;
    }
    audio_sound sound = core_columns_add(&w->sound.set);
    if (core_handle_is_null(sound)) {
        return sound;
    }
    uint32_t row = core_columns_row(&w->sound.set, sound);
    size_t bytes = (size_t)data->frame_count * data->channels * sizeof(int16_t);
    w->sound.sample[row] = core_alloc(bytes);
    memcpy(w->sound.sample[row], data->sample, bytes);
    w->sound.frames[row] = data->frame_count;
    w->sound.channels[row] = data->channels;
    w->sound.rate[row] = data->rate;
    w->sample_bytes += bytes;
    return sound;
}

static uint32_t sound_row(const audio_world *w, audio_sound sound) {
    uint32_t row = core_columns_row(&w->sound.set, sound);
    if (row == CORE_NO_ROW) {
        core_fail("audio: sound %u:%u does not exist (destroyed)", sound.index, sound.generation);
    }
    return row;
}

bool audio_sound_destroy(audio_world *w, audio_sound sound) {
    uint32_t row = sound_row(w, sound);
    if (row == CORE_NO_ROW) {
        return false;
    }
    w->sample_bytes -= (size_t)w->sound.frames[row] * w->sound.channels[row] * sizeof(int16_t);
    core_free(w->sound.sample[row]);
    core_columns_remove(&w->sound.set, sound, NULL, NULL);
    return true;
}

bool audio_sound_alive(const audio_world *w, audio_sound sound) {
    return core_columns_row(&w->sound.set, sound) != CORE_NO_ROW;
}

double audio_sound_duration(const audio_world *w, audio_sound sound) {
    uint32_t row = core_columns_row(&w->sound.set, sound);
    return row == CORE_NO_ROW ? 0.0 : (double)w->sound.frames[row] / w->sound.rate[row];
}

// ---- sources ----

audio_source_desc audio_source_desc_default(void) {
    return (audio_source_desc){.gain = 1,
                               .pitch = 1,
                               .reference = 1,
                               .max_distance = 10000,
                               .rolloff = 1,
                               .inner = 2 * CORE_PI_F,
                               .outer = 2 * CORE_PI_F,
                               .cookie = SOURCE_COOKIE};
}

static bool finite3(core_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static bool in_range(const char *name, float value, float low, float high) {
    return (value >= low && value <= high) ||
           core_fail("audio source: %s is %g, expected %g to %g", name, (double)value, (double)low,
                     (double)high);
}

static bool source_desc_ok(const audio_world *w, const audio_source_desc *d) {
    const float turn = 2 * CORE_PI_F;
    if (!d || d->cookie != SOURCE_COOKIE) {
        return core_fail("audio source: description was not made by audio_source_desc_default()");
    }
    if (!finite3(d->position) || !finite3(d->velocity) || !finite3(d->direction)) {
        return core_fail("audio source: position, velocity and direction must be finite numbers");
    }
    return sound_row(w, d->sound) != CORE_NO_ROW && in_range("gain", d->gain, 0, 16) &&
           in_range("pitch", d->pitch, 1.0f / 16, 16) &&
           in_range("reference", d->reference, 1e-3f, 1e6f) &&
           in_range("max_distance", d->max_distance, d->reference, 1e9f) &&
           in_range("rolloff", d->rolloff, 0, 1000) && in_range("inner", d->inner, 0, d->outer) &&
           in_range("outer", d->outer, 0, turn) && in_range("cone_gain", d->cone_gain, 0, 1);
}

audio_source audio_source_create(audio_world *w, const audio_source_desc *d) {
    uint32_t group =
        source_desc_ok(w, d) ? group_for(w, d->group ? d->group : "effects") : AUDIO_MAX_GROUPS;
    audio_source h = group < AUDIO_MAX_GROUPS ? core_columns_add(&w->source.set) : CORE_NULL_HANDLE;
    if (core_handle_is_null(h)) {
        return h;
    }
    audio_sources *s = &w->source;
    uint32_t row = core_columns_row(&s->set, h);
    core_vec3 axis = core_v3_normalize(d->direction, core_v3(0, 0, 0));
    s->px[row] = d->position.x;
    s->py[row] = d->position.y;
    s->pz[row] = d->position.z;
    s->vx[row] = d->velocity.x;
    s->vy[row] = d->velocity.y;
    s->vz[row] = d->velocity.z;
    s->dx[row] = axis.x;
    s->dy[row] = axis.y;
    s->dz[row] = axis.z;
    s->gain[row] = s->fade_to[row] = d->gain;
    s->pitch[row] = d->pitch;
    s->reference[row] = d->reference;
    s->max_distance[row] = d->max_distance;
    s->rolloff[row] = d->rolloff;
    s->inner[row] = d->inner;
    s->outer[row] = d->outer;
    s->cone_gain[row] = d->cone_gain;
    s->clear[row] = 1.0f;
    s->sound[row] = d->sound;
    s->group[row] = group;
    s->flags[row] = (d->paused ? 0 : AUDIO_PLAYING | AUDIO_JUMP) | (d->loop ? AUDIO_LOOP : 0) |
                    (d->flat ? AUDIO_FLAT : 0);
    return h;
}

static uint32_t source_row(const audio_world *w, audio_source source) {
    uint32_t row = core_columns_row(&w->source.set, source);
    if (row == CORE_NO_ROW) {
        core_fail("audio: source %u:%u does not exist (destroyed)", source.index,
                  source.generation);
    }
    return row;
}

bool audio_source_destroy(audio_world *w, audio_source source) {
    return source_row(w, source) != CORE_NO_ROW &&
           core_columns_remove(&w->source.set, source, NULL, NULL);
}

bool audio_source_alive(const audio_world *w, audio_source source) {
    return core_columns_row(&w->source.set, source) != CORE_NO_ROW;
}

bool audio_source_play(audio_world *w, audio_source source) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW || sound_row(w, w->source.sound[row]) == CORE_NO_ROW) {
        return false;
    }
    if (!(w->source.flags[row] & AUDIO_PLAYING)) {
        w->source.flags[row] |= AUDIO_PLAYING | AUDIO_JUMP;
    }
    return true;
}

bool audio_source_pause(audio_world *w, audio_source source) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW) {
        return false;
    }
    w->source.flags[row] &= ~(uint32_t)AUDIO_PLAYING;
    return true;
}

bool audio_source_stop(audio_world *w, audio_source source) {
    if (!audio_source_pause(w, source)) {
        return false;
    }
    w->source.frame[core_columns_row(&w->source.set, source)] = 0.0;
    return true;
}

bool audio_source_playing(const audio_world *w, audio_source source) {
    uint32_t row = core_columns_row(&w->source.set, source);
    return row != CORE_NO_ROW && (w->source.flags[row] & AUDIO_PLAYING) != 0;
}

double audio_source_time(const audio_world *w, audio_source source) {
    uint32_t row = core_columns_row(&w->source.set, source);
    uint32_t sound =
        row == CORE_NO_ROW ? CORE_NO_ROW : core_columns_row(&w->sound.set, w->source.sound[row]);
    return sound == CORE_NO_ROW ? 0.0 : w->source.frame[row] / w->sound.rate[sound];
}

bool audio_source_seek(audio_world *w, audio_source source, double seconds) {
    uint32_t row = source_row(w, source);
    uint32_t sound = row == CORE_NO_ROW ? CORE_NO_ROW : sound_row(w, w->source.sound[row]);
    if (sound == CORE_NO_ROW) {
        return false;
    }
    double last = (double)w->sound.frames[sound] / w->sound.rate[sound];
    if (!(seconds >= 0.0 && seconds <= last)) {
        return core_fail("audio source: cannot seek to %g s of a sound of %g s", seconds, last);
    }
    w->source.frame[row] = seconds * w->sound.rate[sound];
    w->source.flags[row] |= AUDIO_JUMP;
    return true;
}

static bool set3(audio_world *w, audio_source source, const char *what, core_vec3 v, float *x,
                 float *y, float *z) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!finite3(v)) {
        return core_fail("audio source: %s (%g, %g, %g) is not finite", what, (double)v.x,
                         (double)v.y, (double)v.z);
    }
    x[row] = v.x;
    y[row] = v.y;
    z[row] = v.z;
    return true;
}

bool audio_source_set_position(audio_world *w, audio_source source, core_vec3 v) {
    return set3(w, source, "position", v, w->source.px, w->source.py, w->source.pz);
}
bool audio_source_set_velocity(audio_world *w, audio_source source, core_vec3 v) {
    return set3(w, source, "velocity", v, w->source.vx, w->source.vy, w->source.vz);
}
bool audio_source_set_direction(audio_world *w, audio_source source, core_vec3 v) {
    return set3(w, source, "direction", core_v3_normalize(v, core_v3(0, 0, 0)), w->source.dx,
                w->source.dy, w->source.dz);
}

bool audio_source_set_gain(audio_world *w, audio_source source, float gain) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW || !in_range("gain", gain, 0, 16)) {
        return false;
    }
    w->source.gain[row] = w->source.fade_to[row] = gain;
    w->source.fade_rate[row] = 0.0f;
    return true;
}

bool audio_source_set_pitch(audio_world *w, audio_source source, float pitch) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW || !in_range("pitch", pitch, 1.0f / 16, 16)) {
        return false;
    }
    w->source.pitch[row] = pitch;
    return true;
}

bool audio_source_fade(audio_world *w, audio_source source, float gain, float seconds, bool stop) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW || !in_range("gain", gain, 0, 16) ||
        !in_range("fade", seconds, 1e-3f, 3600)) {
        return false;
    }
    if (gain == w->source.gain[row]) {
        return !stop || audio_source_stop(w, source);
    }
    w->source.fade_to[row] = gain;
    w->source.fade_rate[row] = (gain - w->source.gain[row]) / seconds;
    w->source.flags[row] &= ~(uint32_t)AUDIO_FADE_STOP;
    w->source.flags[row] |= stop ? AUDIO_FADE_STOP : 0;
    return true;
}

bool audio_source_set_clear(audio_world *w, audio_source source, float clear) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW || !in_range("clear", clear, 0, 1)) {
        return false;
    }
    w->source.clear[row] = clear;
    return true;
}

bool audio_source_set_user(audio_world *w, audio_source source, uint64_t user) {
    uint32_t row = source_row(w, source);
    if (row == CORE_NO_ROW) {
        return false;
    }
    w->source.user[row] = user;
    return true;
}

core_vec3 audio_source_position(const audio_world *w, audio_source source) {
    uint32_t row = core_columns_row(&w->source.set, source);
    return row == CORE_NO_ROW
               ? core_v3(0, 0, 0)
               : (core_vec3){w->source.px[row], w->source.py[row], w->source.pz[row]};
}
