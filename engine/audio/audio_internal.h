// What the files of this room share.
#ifndef AUDIO_AUDIO_INTERNAL_H
#define AUDIO_AUDIO_INTERNAL_H

#include "audio/audio.h"

// Flags of a source.
// AUDIO_JUMP: playback was started or moved since the last step; a device must follow.
enum {
    AUDIO_PLAYING = 1u,
    AUDIO_LOOP = 2u,
    AUDIO_FLAT = 4u,
    AUDIO_FADE_STOP = 8u,
    AUDIO_JUMP = 16u
};

#define AUDIO_SOURCE_COLUMNS(X)                                                                    \
    X(float, px, CORE_COLUMN_STATE)                                                                \
    X(float, py, CORE_COLUMN_STATE)                                                                \
    X(float, pz, CORE_COLUMN_STATE)                                                                \
    X(float, vx, CORE_COLUMN_STATE)                                                                \
    X(float, vy, CORE_COLUMN_STATE)                                                                \
    X(float, vz, CORE_COLUMN_STATE)                                                                \
    X(float, dx, CORE_COLUMN_STATE)                                                                \
    X(float, dy, CORE_COLUMN_STATE)                                                                \
    X(float, dz, CORE_COLUMN_STATE)                                                                \
    X(float, gain, CORE_COLUMN_STATE)                                                              \
    X(float, pitch, CORE_COLUMN_STATE)                                                             \
    X(float, fade_to, CORE_COLUMN_STATE)                                                           \
    X(float, fade_rate, CORE_COLUMN_STATE) /* gain per second, 0: no fade */                       \
    X(float, reference, CORE_COLUMN_STATE)                                                         \
    X(float, max_distance, CORE_COLUMN_STATE)                                                      \
    X(float, rolloff, CORE_COLUMN_STATE)                                                           \
    X(float, inner, CORE_COLUMN_STATE)                                                             \
    X(float, outer, CORE_COLUMN_STATE)                                                             \
    X(float, cone_gain, CORE_COLUMN_STATE)                                                         \
    X(float, clear, 0)                                                                             \
    X(double, frame, CORE_COLUMN_STATE) /* of the sound, where playback is */                      \
    X(uint64_t, user, CORE_COLUMN_STATE)                                                           \
    X(core_handle, sound, CORE_COLUMN_STATE)                                                       \
    X(uint32_t, group, CORE_COLUMN_STATE)                                                          \
    X(uint32_t, flags, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(audio_sources, AUDIO_SOURCE_COLUMNS)

// Samples are resources, not state: a saved scene loads them again.
#define AUDIO_SOUND_COLUMNS(X)                                                                     \
    X(int16_t *, sample, 0)                                                                        \
    X(uint32_t, frames, CORE_COLUMN_STATE)                                                         \
    X(uint32_t, channels, CORE_COLUMN_STATE)                                                       \
    X(uint32_t, rate, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(audio_sounds, AUDIO_SOUND_COLUMNS)

typedef struct audio_group {
    char name[AUDIO_GROUP_NAME];
    float gain;
} audio_group;

struct audio_world {
    core_metrics *metrics;
    audio_sources source;
    audio_sounds sound;
    audio_listener listener;
    audio_group group[AUDIO_MAX_GROUPS];
    uint32_t groups;
    uint32_t voices; // most at once
    float volume, doppler, sound_speed;
    bool hrtf, occlusion;
    size_t sample_bytes;
    audio_voice voice[AUDIO_MAX_VOICES];
    uint32_t voice_count;
};

#endif
