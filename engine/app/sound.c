#include "app/sound.h"

#include <errno.h>
#include <string.h>

#include "core/log.h"

#define HEADER_BYTES 58
#define FRAME_BYTES  (2 * sizeof(float))

static void put(uint8_t **at, const void *data, size_t size) {
    memcpy(*at, data, size);
    *at += size;
}
static void put_u16(uint8_t **at, uint16_t value) { put(at, &value, sizeof value); }
static void put_u32(uint8_t **at, uint32_t value) { put(at, &value, sizeof value); }

// RIFF WAVE with IEEE float samples (format 3), which needs an extension size and a fact chunk.
static bool write_header(app_sound *a) {
    uint8_t header[HEADER_BYTES], *at = header;
    uint32_t bytes = (uint32_t)CORE_MIN(a->frames * FRAME_BYTES, (uint64_t)UINT32_MAX - 64);
    put(&at, "RIFF", 4);
    put_u32(&at, HEADER_BYTES - 8 + bytes);
    put(&at, "WAVEfmt ", 8);
    put_u32(&at, 18);
    put_u16(&at, 3);
    put_u16(&at, 2);
    put_u32(&at, APP_SOUND_RATE);
    put_u32(&at, APP_SOUND_RATE * FRAME_BYTES);
    put_u16(&at, FRAME_BYTES);
    put_u16(&at, 32);
    put_u16(&at, 0);
    put(&at, "fact", 4);
    put_u32(&at, 4);
    put_u32(&at, (uint32_t)a->frames);
    put(&at, "data", 4);
    put_u32(&at, bytes);
    return fseek(a->wav, 0, SEEK_SET) == 0 &&
           fwrite(header, 1, sizeof header, a->wav) == sizeof header;
}

bool app_sound_open_file(app_sound *a, const char *path) {
    a->wav = fopen(path, "wb");
    if (!a->wav || !write_header(a)) {
        return core_fail("cannot write '%s': %s", path, strerror(errno));
    }
    return true;
}

static bool make_device(app_sound *a) {
    if (a->device || (a->tried && !a->wav)) {
        return a->device != NULL;
    }
    audio_device_desc desc = audio_device_desc_default();
    desc.capture = a->wav != NULL;
    desc.rate = APP_SOUND_RATE;
    a->device = audio_device_create(&desc);
    if (!a->device && !a->wav) {
        core_log(CORE_LOG_WARN, "%s; the run is silent", core_last_error());
    }
    a->tried = true;
    return a->device != NULL;
}

static bool render(app_sound *a, const scene *s, uint32_t frames) {
    if (frames > a->buffer_frames) {
        core_free(a->buffer);
        a->buffer = core_alloc(frames * FRAME_BYTES);
        a->buffer_frames = frames;
    }
    if (!scene_audio_if(s)) {
        memset(a->buffer, 0, frames * FRAME_BYTES);
    } else if (!make_device(a)) {
        return core_fail("--audio: %s", core_last_error());
    } else {
        audio_device_update(a->device, scene_audio_if(s));
        if (!audio_device_render(a->device, a->buffer, frames)) {
            return false;
        }
    }
    a->frames += frames;
    return fwrite(a->buffer, FRAME_BYTES, frames, a->wav) == frames ||
           core_fail("cannot write sound: %s", strerror(errno));
}

bool app_sound_step(app_sound *a, const scene *s, double seconds, bool window) {
    if (!a->wav && !(window && scene_audio_if(s))) {
        return true;
    }
    bool ok = true;
    core_stage_begin(scene_metrics(s), CORE_STAGE_AUDIO);
    if (a->wav) {
        // Frames of the run so far, rounded once: steps of any length add up to the right time.
        uint64_t due = (uint64_t)(seconds * APP_SOUND_RATE + 0.5);
        ok = due <= a->frames || render(a, s, (uint32_t)(due - a->frames));
    } else if (make_device(a)) {
        audio_device_update(a->device, scene_audio_if(s));
    }
    core_stage_end(scene_metrics(s), CORE_STAGE_AUDIO);
    return ok;
}

void app_sound_leave_scene(app_sound *a) {
    audio_device_destroy(a->device);
    a->device = NULL;
    a->tried = false;
}

bool app_sound_close(app_sound *a) {
    bool ok = true;
    app_sound_leave_scene(a);
    if (a->wav) {
        ok = write_header(a);
        ok = fclose(a->wav) == 0 && ok;
        a->wav = NULL;
    }
    core_free(a->buffer);
    return ok || core_fail("cannot write the sound file: %s", strerror(errno));
}
