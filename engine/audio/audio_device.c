// Plays the voices that a world has picked through OpenAL Soft. Distance, cone and Doppler are the
// world's work; OpenAL places each voice by its direction, filters and mixes.
#include <string.h>

#include "audio/audio_internal.h"
#include "audio/audio_library.h"
#include "core/log.h"

#define DEVICE_COOKIE 0xa0d10003u
#define RETRY_UPDATES 120 // between attempts to find a lost device again

// A voice that starts in the middle of a sound, or stops there, fades for one update: a jump in the
// samples is heard as a click.
typedef enum slot_state { SLOT_FREE, SLOT_STARTING, SLOT_ON, SLOT_STOPPING } slot_state;

typedef struct slot {
    ALuint source, filter;
    slot_state state;
    audio_source playing;
    bool seen;
} slot;

typedef struct buffer_entry { // of one sound, by the index of its handle
    uint32_t generation;
    ALuint whole, mono; // as it is; mixed to one channel for sources with a place
} buffer_entry;

struct audio_device {
    audio_library al;
    ALCdevice *device;
    ALCcontext *context;
    audio_device_desc desc;
    bool hrtf, lost;
    uint32_t updates;
    slot slots[AUDIO_MAX_VOICES];
    uint32_t slot_count;
    buffer_entry *buffer; // [buffer_count]
    uint32_t buffer_count;
};

audio_device_desc audio_device_desc_default(void) {
    return (audio_device_desc){.rate = 48000, .cookie = DEVICE_COOKIE};
}

// ---- opening ----

static void attributes(const audio_device *d, bool hrtf, ALCint out[16]) {
    const ALCint list[] = {ALC_FREQUENCY,
                           (ALCint)d->desc.rate,
                           ALC_MONO_SOURCES,
                           AUDIO_MAX_VOICES,
                           ALC_HRTF_SOFT,
                           hrtf,
                           ALC_OUTPUT_LIMITER_SOFT,
                           !d->desc.capture,
                           d->desc.capture ? ALC_FORMAT_CHANNELS_SOFT : 0,
                           ALC_STEREO_SOFT,
                           ALC_FORMAT_TYPE_SOFT,
                           ALC_FLOAT_SOFT,
                           0};
    memcpy(out, list, sizeof list);
}

static bool open_device(audio_device *d) {
    ALCint attribute[16];
    if (d->desc.capture && !(d->al.alcLoopbackOpenDeviceSOFT && d->al.alcRenderSamplesSOFT)) {
        return core_fail_quiet("audio: this OpenAL cannot capture (ALC_SOFT_loopback is missing)");
    }
    d->device = d->desc.capture ? d->al.alcLoopbackOpenDeviceSOFT(NULL) : d->al.alcOpenDevice(NULL);
    if (!d->device) {
        return core_fail_quiet("audio: no sound card that OpenAL can open");
    }
    attributes(d, d->hrtf, attribute);
    d->context = d->al.alcCreateContext(d->device, attribute);
    if (!d->context || !d->al.alcSetThreadContext(d->context)) {
        return core_fail_quiet("audio: OpenAL could not start the device");
    }
    d->al.alDistanceModel(AL_NONE);
    return true;
}

static void close_device(audio_device *d) {
    if (d->context) {
        d->al.alcSetThreadContext(d->context);
        for (uint32_t i = 0; i < d->slot_count; i++) {
            d->al.alSourceStop(d->slots[i].source);
            d->al.alDeleteSources(1, &d->slots[i].source);
            if (d->slots[i].filter) {
                d->al.alDeleteFilters(1, &d->slots[i].filter);
            }
        }
        for (uint32_t i = 0; i < d->buffer_count; i++) {
            d->al.alDeleteBuffers(2, (const ALuint[]){d->buffer[i].whole, d->buffer[i].mono});
        }
        d->al.alcSetThreadContext(NULL);
        d->al.alcDestroyContext(d->context);
    }
    if (d->device) {
        d->al.alcCloseDevice(d->device);
    }
    core_free(d->buffer);
    d->buffer = NULL;
    d->buffer_count = d->slot_count = 0;
    d->context = NULL;
    d->device = NULL;
}

audio_device *audio_device_create(const audio_device_desc *desc) {
    if (!desc || desc->cookie != DEVICE_COOKIE || desc->rate < 8000 || desc->rate > 192000) {
        core_fail("audio: device description must come from audio_device_desc_default(), with a "
                  "rate of 8000 to 192000 Hz");
        return NULL;
    }
    audio_device *d = core_alloc(sizeof *d);
    d->desc = *desc;
    if (!audio_library_open(&d->al) || !open_device(d)) {
        audio_device_destroy(d);
        return NULL;
    }
    return d;
}

void audio_device_destroy(audio_device *d) {
    if (!d) {
        return;
    }
    if (d->al.handle) {
        close_device(d);
    }
    audio_library_close(&d->al);
    core_free(d);
}

const char *audio_device_name(const audio_device *d) {
    if (d->desc.capture) {
        return "capture";
    }
    return d->device ? d->al.alcGetString(d->device, ALC_DEVICE_SPECIFIER) : "";
}

bool audio_device_hrtf(const audio_device *d) {
    ALCint on = 0;
    if (d->device) {
        d->al.alcGetIntegerv(d->device, ALC_HRTF_SOFT, 1, &on);
    }
    return on != 0;
}

// A device that was unplugged stays lost until OpenAL can open one again; the world goes on.
static bool connected(audio_device *d) {
    ALCint yes = 1;
    if (d->device && !d->desc.capture &&
        d->al.alcIsExtensionPresent(d->device, "ALC_EXT_disconnect")) {
        d->al.alcGetIntegerv(d->device, ALC_CONNECTED, 1, &yes);
    }
    if (d->device && yes) {
        return true;
    }
    if (!d->lost) {
        core_log(CORE_LOG_WARN, "audio: the sound card is gone; looking for another");
        close_device(d);
        d->lost = true;
    }
    if (d->updates % RETRY_UPDATES != 0) {
        return false;
    }
    if (!open_device(d)) {
        close_device(d);
        return false;
    }
    d->lost = false;
    return true;
}

static void follow_hrtf(audio_device *d, bool wanted) {
    if (d->hrtf == wanted || !d->al.alcResetDeviceSOFT) {
        return;
    }
    ALCint attribute[16];
    attributes(d, wanted, attribute);
    d->al.alcResetDeviceSOFT(d->device, attribute);
    d->hrtf = wanted;
}

// ---- buffers ----

static void make_mono(audio_device *d, ALuint name, const int16_t *stereo, uint32_t frames,
                      uint32_t rate) {
    int16_t *mono = core_alloc(frames * sizeof *mono);
    for (uint32_t i = 0; i < frames; i++) {
        mono[i] = (int16_t)((stereo[2 * i] + stereo[2 * i + 1]) / 2);
    }
    d->al.alBufferData(name, AL_FORMAT_MONO16, mono, (ALsizei)(frames * sizeof *mono),
                       (ALsizei)rate);
    core_free(mono);
}

// The buffer of a voice's sound; 0 when the sound was destroyed.
static ALuint buffer_of(audio_device *d, const audio_world *w, const audio_voice *v) {
    uint32_t row = core_columns_row(&w->sound.set, v->sound);
    if (row == CORE_NO_ROW) {
        return 0;
    }
    if (v->sound.index >= d->buffer_count) {
        uint32_t grown = CORE_MAX(v->sound.index + 1, d->buffer_count * 2);
        d->buffer =
            core_realloc(d->buffer, d->buffer_count * sizeof *d->buffer, grown * sizeof *d->buffer);
        d->buffer_count = grown;
    }
    buffer_entry *e = &d->buffer[v->sound.index];
    if (e->generation != v->sound.generation) {
        d->al.alDeleteBuffers(2, (const ALuint[]){e->whole, e->mono});
        *e = (buffer_entry){.generation = v->sound.generation};
    }
    uint32_t frames = w->sound.frames[row], channels = w->sound.channels[row];
    ALsizei rate = (ALsizei)w->sound.rate[row];
    if (channels == 2 && !v->flat) {
        if (!e->mono) {
            d->al.alGenBuffers(1, &e->mono);
            make_mono(d, e->mono, w->sound.sample[row], frames, (uint32_t)rate);
        }
        return e->mono;
    }
    if (!e->whole) {
        d->al.alGenBuffers(1, &e->whole);
        d->al.alBufferData(e->whole, channels == 2 ? AL_FORMAT_STEREO16 : AL_FORMAT_MONO16,
                           w->sound.sample[row], (ALsizei)(frames * channels * sizeof(int16_t)),
                           rate);
    }
    return e->whole;
}

// ---- voices ----

static slot *slot_of(audio_device *d, audio_source source) {
    for (uint32_t i = 0; i < d->slot_count; i++) {
        slot *s = &d->slots[i];
        if ((s->state == SLOT_ON || s->state == SLOT_STARTING) &&
            core_handle_equal(s->playing, source)) {
            return s;
        }
    }
    return NULL;
}

static slot *free_slot(audio_device *d) {
    for (uint32_t i = 0; i < d->slot_count; i++) {
        if (d->slots[i].state == SLOT_FREE) {
            return &d->slots[i];
        }
    }
    if (d->slot_count == AUDIO_MAX_VOICES) {
        return NULL;
    }
    slot *s = &d->slots[d->slot_count++];
    *s = (slot){0};
    d->al.alGenSources(1, &s->source);
    d->al.alSourcei(s->source, AL_SOURCE_RELATIVE, AL_TRUE);
    d->al.alSourcef(s->source, AL_MAX_GAIN, 1.0f);
    if (d->al.alGenFilters && d->al.alFilteri && d->al.alFilterf) {
        d->al.alGenFilters(1, &s->filter);
        d->al.alFilteri(s->filter, AL_FILTER_TYPE, AL_FILTER_LOWPASS);
    }
    return s;
}

static void place(const audio_device *d, const slot *s, const audio_voice *v, float gain) {
    d->al.alSource3f(s->source, AL_POSITION, v->toward.x, v->toward.y, v->toward.z);
    d->al.alSourcef(s->source, AL_PITCH, v->pitch);
    d->al.alSourcef(s->source, AL_MAX_GAIN, CORE_MAX(gain, 1.0f));
    d->al.alSourcef(s->source, AL_GAIN, gain);
    if (s->filter) { // what is in the way takes the high notes first
        d->al.alFilterf(s->filter, AL_LOWPASS_GAINHF, v->clear);
        d->al.alSourcei(s->source, AL_DIRECT_FILTER,
                        v->clear < 1.0f ? (ALint)s->filter : AL_FILTER_NULL);
    }
}

static void start(audio_device *d, const audio_world *w, const audio_voice *v) {
    ALuint buffer = buffer_of(d, w, v);
    slot *s = buffer ? free_slot(d) : NULL;
    if (!s) {
        return;
    }
    s->playing = v->source;
    s->state = v->frame > 0.0 ? SLOT_STARTING : SLOT_ON;
    s->seen = true;
    d->al.alSourcei(s->source, AL_BUFFER, (ALint)buffer);
    d->al.alSourcei(s->source, AL_LOOPING, v->loop);
    d->al.alSourcei(s->source, AL_SAMPLE_OFFSET, (ALint)v->frame);
    place(d, s, v, s->state == SLOT_STARTING ? 0.0f : v->gain);
    d->al.alSourcePlay(s->source);
}

static void keep(audio_device *d, slot *s, const audio_voice *v) {
    s->state = SLOT_ON;
    s->seen = true;
    place(d, s, v, v->gain);
    if (v->jump) {
        d->al.alSourcei(s->source, AL_SAMPLE_OFFSET, (ALint)v->frame);
        d->al.alSourcePlay(s->source);
    }
}

// Slots whose source is no voice any more: those that have ended are free, others fade first.
static void let_go(audio_device *d, slot *s) {
    ALint state = AL_STOPPED;
    d->al.alGetSourcei(s->source, AL_SOURCE_STATE, &state);
    if (s->state == SLOT_STOPPING || state != AL_PLAYING) {
        d->al.alSourceStop(s->source);
        d->al.alSourcei(s->source, AL_BUFFER, 0);
        s->state = SLOT_FREE;
    } else {
        d->al.alSourcef(s->source, AL_GAIN, 0.0f);
        s->state = SLOT_STOPPING;
    }
}

void audio_device_update(audio_device *d, const audio_world *w) {
    d->updates++;
    if (!connected(d)) {
        return;
    }
    d->al.alcSetThreadContext(d->context);
    follow_hrtf(d, w->hrtf);
    for (uint32_t i = 0; i < d->slot_count; i++) {
        d->slots[i].seen = false;
    }
    for (uint32_t i = 0; i < w->voice_count; i++) {
        slot *s = slot_of(d, w->voice[i].source);
        if (s) {
            keep(d, s, &w->voice[i]);
        }
    }
    for (uint32_t i = 0; i < d->slot_count; i++) {
        if (!d->slots[i].seen && d->slots[i].state != SLOT_FREE) {
            let_go(d, &d->slots[i]);
        }
    }
    for (uint32_t i = 0; i < w->voice_count; i++) {
        if (!slot_of(d, w->voice[i].source)) {
            start(d, w, &w->voice[i]);
        }
    }
}

bool audio_device_render(audio_device *d, float *out, uint32_t frames) {
    if (!d->desc.capture) {
        return core_fail("audio: only a capture device renders; make it with desc.capture");
    }
    d->al.alcSetThreadContext(d->context);
    d->al.alcRenderSamplesSOFT(d->device, out, (ALCsizei)frames);
    return true;
}
