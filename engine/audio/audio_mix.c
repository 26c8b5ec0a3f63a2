// A step of the audio world: time, fades, what the listener hears of each source, which are voices.
#include <string.h>

#include "audio/audio_internal.h"

#define INAUDIBLE 2.5e-4f // -72 dB: below the noise of a quiet room behind any playback

// ---- time ----

static void move_fade(audio_sources *s, uint32_t row, float dt) {
    float rate = s->fade_rate[row], next = s->gain[row] + rate * dt;
    bool there = rate > 0.0f ? next >= s->fade_to[row] : next <= s->fade_to[row];
    s->gain[row] = there ? s->fade_to[row] : next;
    if (there) {
        s->fade_rate[row] = 0.0f;
        if (s->flags[row] & AUDIO_FADE_STOP) {
            s->flags[row] &= ~(uint32_t)(AUDIO_PLAYING | AUDIO_FADE_STOP);
            s->frame[row] = 0.0;
        }
    }
}

// The listener may follow a camera that only a window has, so Doppler does not move the place in
// the sound: what a script can ask for is the same in every run.
static void move_playback(audio_world *w, uint32_t row, float dt) {
    audio_sources *s = &w->source;
    uint32_t sound = core_columns_row(&w->sound.set, s->sound[row]);
    if (sound == CORE_NO_ROW) { // destroyed under it
        s->flags[row] &= ~(uint32_t)AUDIO_PLAYING;
        return;
    }
    double frames = w->sound.frames[sound];
    s->frame[row] += (double)dt * (double)s->pitch[row] * w->sound.rate[sound];
    if (s->frame[row] < frames) {
        return;
    }
    if (s->flags[row] & AUDIO_LOOP) {
        s->frame[row] = core_fmod(s->frame[row], frames);
    } else {
        s->flags[row] &= ~(uint32_t)AUDIO_PLAYING;
        s->frame[row] = 0.0;
    }
}

// ---- what the listener hears ----

// OpenAL 1.1 specification, 3.4.2: inverse distance, clamped.
static float distance_gain(const audio_sources *s, uint32_t row, float distance) {
    float reference = s->reference[row];
    float d = CORE_CLAMP(distance, reference, s->max_distance[row]);
    return reference / (reference + s->rolloff[row] * (d - reference));
}

// Same, 3.4.3.10: the angle between the axis and the way to the listener.
static float cone_gain(const audio_sources *s, uint32_t row, core_vec3 to_listener) {
    core_vec3 axis = {s->dx[row], s->dy[row], s->dz[row]};
    float half_inner = 0.5f * s->inner[row], half_outer = 0.5f * s->outer[row];
    if (half_inner >= CORE_PI_F || core_v3_dot(axis, axis) == 0.0f) {
        return 1.0f;
    }
    float angle = core_acosf(CORE_CLAMP(core_v3_dot(axis, to_listener), -1.0f, 1.0f));
    if (angle <= half_inner) {
        return 1.0f;
    }
    if (angle >= half_outer) {
        return s->cone_gain[row];
    }
    float t = (angle - half_inner) / (half_outer - half_inner);
    return 1.0f + t * (s->cone_gain[row] - 1.0f);
}

// Same, 3.5.2, with speeds held below 95 % of the sound's.
static float doppler_pitch(const audio_world *w, uint32_t row, core_vec3 to_listener) {
    const audio_sources *s = &w->source;
    float c = w->sound_speed, most = 0.95f * c;
    core_vec3 v = {s->vx[row], s->vy[row], s->vz[row]};
    float source = w->doppler * core_v3_dot(v, to_listener);
    float listener = w->doppler * core_v3_dot(w->listener.velocity, to_listener);
    return (c - CORE_CLAMP(listener, -most, most)) / (c - CORE_CLAMP(source, -most, most));
}

static audio_voice hear(const audio_world *w, uint32_t row) {
    const audio_sources *s = &w->source;
    audio_voice v = {.source = core_columns_handle(&s->set, row),
                     .sound = s->sound[row],
                     .gain = s->gain[row] * w->group[s->group[row]].gain * w->volume,
                     .pitch = s->pitch[row],
                     .frame = s->frame[row],
                     .loop = (s->flags[row] & AUDIO_LOOP) != 0,
                     .flat = (s->flags[row] & AUDIO_FLAT) != 0,
                     .jump = (s->flags[row] & AUDIO_JUMP) != 0,
                     .clear = s->clear[row],
                     .user = s->user[row]};
    if (v.flat) {
        return v;
    }
    core_vec3 p = {s->px[row], s->py[row], s->pz[row]};
    core_vec3 away = core_v3_sub(p, w->listener.position);
    float distance = core_v3_length(away);
    core_vec3 unit = core_v3_normalize(away, core_v3(0, 0, 0));
    core_vec3 back = core_v3_scale(unit, -1.0f);
    v.toward = core_quat_unrotate(w->listener.rotation, unit);
    v.gain *= distance_gain(s, row, distance) * cone_gain(s, row, back) * s->clear[row];
    v.pitch *= doppler_pitch(w, row, back);
    return v;
}

// ---- the loudest ----

static bool louder(const audio_voice *a, const audio_voice *b) {
    return a->gain > b->gain || (a->gain == b->gain && a->source.index < b->source.index);
}

// Keeps voice[] sorted, loudest first: `voices` is small against the number of sources, most of
// which fail the first comparison.
static void offer(audio_world *w, const audio_voice *v) {
    uint32_t n = w->voice_count;
    if (n == w->voices && !louder(v, &w->voice[n - 1])) {
        return;
    }
    uint32_t at = n < w->voices ? n : n - 1;
    while (at > 0 && louder(v, &w->voice[at - 1])) {
        at--;
    }
    uint32_t moved = (n < w->voices ? n : n - 1) - at;
    memmove(&w->voice[at + 1], &w->voice[at], moved * sizeof *v);
    w->voice[at] = *v;
    w->voice_count = n < w->voices ? n + 1 : n;
}

// Voices are picked before time moves on: a device starts them where playback was at the beginning
// of the step, and renders the step from there.
void audio_world_step(audio_world *w, float dt) {
    audio_sources *s = &w->source;
    core_stage_begin(w->metrics, CORE_STAGE_AUDIO);
    w->voice_count = 0;
    for (uint32_t row = 0; row < core_columns_count(&s->set); row++) {
        if (!(s->flags[row] & AUDIO_PLAYING)) {
            continue;
        }
        audio_voice v = hear(w, row);
        if (v.gain > INAUDIBLE) {
            offer(w, &v);
        }
        s->flags[row] &= ~(uint32_t)AUDIO_JUMP;
        if (s->fade_rate[row] != 0.0f) {
            move_fade(s, row, dt);
        }
        if (s->flags[row] & AUDIO_PLAYING) {
            move_playback(w, row, dt);
        }
    }
    core_stage_end(w->metrics, CORE_STAGE_AUDIO);
}

const audio_voice *audio_world_voices(const audio_world *w, uint32_t *count) {
    *count = w->voice_count;
    return w->voice;
}
