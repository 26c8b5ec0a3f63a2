// Sound in space. Two halves, as in rendering: audio_world is plain data (sources, listener,
// groups; no sound library) and runs headless at no cost; audio_device owns OpenAL Soft, which is
// loaded when the first device is made, and plays what the world has picked.
//
// SI units, right-handed, +Y up. Gains are linear factors of amplitude: 0.5 is -6.02 dB.
#ifndef AUDIO_AUDIO_H
#define AUDIO_AUDIO_H

#include "core/columns.h"
#include "core/data.h"
#include "core/metrics.h"
#include "core/stream.h"

typedef struct audio_world audio_world;
typedef struct audio_device audio_device;
typedef core_handle audio_sound;  // samples, shared by sources
typedef core_handle audio_source; // one thing that sounds

#define AUDIO_MAX_VOICES 256
#define AUDIO_MAX_GROUPS 16
#define AUDIO_GROUP_NAME 32 // bytes with the terminating zero

typedef struct audio_world_desc {
    core_metrics *metrics; // NULL: unmeasured. Borrowed
    uint32_t max_sources;  // default 1 << 17 (address space only)
    uint32_t cookie;
} audio_world_desc;
audio_world_desc audio_world_desc_default(void);
audio_world *audio_world_create(const audio_world_desc *desc);
void audio_world_destroy(audio_world *world);
size_t audio_world_bytes(const audio_world *world);
void audio_world_counts(const audio_world *world, core_metrics *metrics); // voices
// State column sets, for hash, save and divergence reports (as phys_world_state).
int audio_world_state(const audio_world *world, const core_columns **out, int capacity);
// Fields of a saved scene (core/stream.h); what points elsewhere is checked. Sounds are not in
// it: the world must hold those of the one that was saved.
// When it returns false nothing of what was there is left.
bool audio_world_stream(audio_world *w, core_stream *s);
// Settings by name, as --set audio.NAME=VALUE reaches them. False + core_fail naming the nearest
// name or the allowed values.
//   voices   most sources heard at once, 1..256, default 32
//   volume   factor on everything, 0..4, default 1
//   hrtf     on | off: binaural filtering for headphones, default off
//   doppler  factor on velocities, 0..10, default 1
//   sound_speed  m/s, 1..10000, default 343.3
//   occlusion  on | off: whether the owner is to look for what is in the way, default off
bool audio_world_set(audio_world *world, const char *name, const char *value);

// Copies the samples. Null + core_fail for bad data.
audio_sound audio_sound_create(audio_world *world, const core_sound_data *data);
// Sources that play it stop. False when stale.
bool audio_sound_destroy(audio_world *world, audio_sound sound);
bool audio_sound_alive(const audio_world *world, audio_sound sound);
double audio_sound_duration(const audio_world *world, audio_sound sound); // s; 0 when stale

typedef struct audio_source_desc {
    audio_sound sound;
    core_vec3 position, velocity; // m, m/s
    core_vec3 direction;          // axis of the cone; zero: sounds the same all around
    float gain;                   // [0, 16], default 1
    float pitch;                  // factor on the rate, [1/16, 16], default 1
    // Inverse distance, clamped (OpenAL 1.1 specification, 3.4.2): gain is
    // reference / (reference + rolloff * (d - reference)) with d held in [reference, max_distance].
    float reference, max_distance; // m, > 0, default 1 and 10000
    float rolloff;                 // >= 0, default 1; 0: distance does not matter
    // Full gain within `inner` of the axis, cone_gain beyond `outer`, linear between (same
    // specification, 3.4.3.10). Full angles, radians, 0 <= inner <= outer <= 2 pi.
    float inner, outer, cone_gain;
    bool loop;
    bool flat;         // no place: both channels as they are (music, menus)
    bool paused;       // does not start at once
    const char *group; // NULL: "effects"
    uint32_t cookie;
} audio_source_desc;
audio_source_desc audio_source_desc_default(void);
// Null + core_fail for bad input.
audio_source audio_source_create(audio_world *world, const audio_source_desc *desc);
// False for stale handles (as every function below: they then change nothing and core_fail).
bool audio_source_destroy(audio_world *world, audio_source source);
bool audio_source_alive(const audio_world *world, audio_source source);
bool audio_source_play(audio_world *world, audio_source source); // from the start when it has ended
bool audio_source_pause(audio_world *world, audio_source source);
bool audio_source_stop(audio_world *world, audio_source source); // and back to the start
bool audio_source_playing(const audio_world *world, audio_source source);
double audio_source_time(const audio_world *world, audio_source source); // s since its start
bool audio_source_seek(audio_world *world, audio_source source, double seconds);
bool audio_source_set_position(audio_world *world, audio_source source, core_vec3 position);
bool audio_source_set_velocity(audio_world *world, audio_source source, core_vec3 velocity);
bool audio_source_set_direction(audio_world *world, audio_source source, core_vec3 direction);
bool audio_source_set_gain(audio_world *world, audio_source source, float gain);
bool audio_source_set_pitch(audio_world *world, audio_source source, float pitch);
// Gain moves to `gain` in `seconds` of step time, then the source stops if `stop`.
bool audio_source_fade(audio_world *world, audio_source source, float gain, float seconds,
                       bool stop);
// Share of the sound that something in the way lets through, [0, 1]; 1: nothing is in the way.
bool audio_source_set_clear(audio_world *world, audio_source source, float clear);
// The caller's own number, given back with each voice.
bool audio_source_set_user(audio_world *world, audio_source source, uint64_t user);
core_vec3 audio_source_position(const audio_world *world, audio_source source);

typedef struct audio_listener {
    core_vec3 position, velocity;
    core_quat rotation; // looks along -Z
} audio_listener;
void audio_world_set_listener(audio_world *world, const audio_listener *listener);
audio_listener audio_world_listener(const audio_world *world);
bool audio_world_occlusion(const audio_world *world); // the setting
// Factor on all sources of a group, [0, 16]; the group is made if it is new. False + core_fail for
// bad names and when there are AUDIO_MAX_GROUPS.
bool audio_world_set_group(audio_world *world, const char *name, float gain);
float audio_world_group(const audio_world *world, const char *name); // 1 for unknown ones

// Moves playback on by dt seconds of step time, ends what has ended, and picks the voices: the
// sources with the greatest gain at the listener (ties: older handles), at most `voices`, none
// below -72 dB. Others stay virtual: they keep their place in time and cost no mixing.
void audio_world_step(audio_world *world, float dt);

typedef struct audio_voice { // what a device plays, after audio_world_step
    audio_source source;
    audio_sound sound;
    core_vec3 toward; // unit, in the listener's frame (x right, y up, -z ahead); zero: centre
    float gain;       // with distance, cone, group, fade, way
    float pitch;      // with Doppler
    double frame;     // of the sound
    bool loop, flat;
    bool jump; // playback did not come from the last step: it began, or was moved
    float clear;
    uint64_t user;
} audio_voice;
// voice[count], loudest first; valid until the next change of the world.
const audio_voice *audio_world_voices(const audio_world *world, uint32_t *count);

// ---- device ----
typedef struct audio_device_desc {
    bool capture;  // no sound card: audio_device_render gives the samples
    uint32_t rate; // Hz, 8000..192000, default 48000; a sound card may choose its own
    uint32_t cookie;
} audio_device_desc;
audio_device_desc audio_device_desc_default(void);
// NULL + core_fail_quiet when there is no OpenAL or no sound card: run on without, say so once.
audio_device *audio_device_create(const audio_device_desc *desc);
void audio_device_destroy(audio_device *device);
// Plays the world's voices from now on. A device that was unplugged is looked for again.
void audio_device_update(audio_device *device, const audio_world *world);
// Capture only: the next `frames` of stereo, out[frames * 2] in [-1, 1] (louder is not cut).
bool audio_device_render(audio_device *device, float *out, uint32_t frames);
const char *audio_device_name(const audio_device *device);
bool audio_device_hrtf(const audio_device *device); // whether it is on now

#endif
