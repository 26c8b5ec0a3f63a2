// Sound files. Ogg Vorbis is in a file of its own; RIFF WAVE here: PCM 8 to 32 bit and 32-bit float
// to 16-bit samples.
#include "asset/asset.h"
#include "asset/bytes.h"
#include "asset/ogg_file.h"

#include <string.h>

enum { FORMAT_PCM = 1, FORMAT_FLOAT = 3, FORMAT_EXTENSIBLE = 0xfffe };

typedef struct wav_format {
    uint32_t tag, channels, rate, bits;
} wav_format;

static uint32_t u16_at(const uint8_t *p) { return (uint32_t)p[0] | (uint32_t)p[1] << 8; }
static uint32_t u32_at(const uint8_t *p) { return u16_at(p) | u16_at(p + 2) << 16; }

static bool read_format(const uint8_t *p, uint32_t size, wav_format *f, const char *path) {
    if (size < 16) {
        return core_fail("%s: WAV: format chunk of %u bytes, expected 16 or more", path, size);
    }
    *f = (wav_format){u16_at(p), u16_at(p + 2), u32_at(p + 4), u16_at(p + 14)};
    if (f->tag == FORMAT_EXTENSIBLE && size >= 26) {
        f->tag = u16_at(p + 24); // first field of the sub-format GUID
    }
    bool pcm =
        f->tag == FORMAT_PCM && (f->bits == 8 || f->bits == 16 || f->bits == 24 || f->bits == 32);
    if (!pcm && !(f->tag == FORMAT_FLOAT && f->bits == 32)) {
        return core_fail("%s: WAV: encoding %u with %u bits; expected PCM of 8, 16, 24 or 32 bits "
                         "or 32-bit float",
                         path, f->tag, f->bits);
    }
    if (f->channels < 1 || f->channels > 2 || f->rate < 1000 || f->rate > 192000) {
        return core_fail("%s: WAV: %u channels at %u Hz; expected 1 or 2 at 1000..192000 Hz", path,
                         f->channels, f->rate);
    }
    return true;
}

static int16_t float_sample(const uint8_t *p) {
    uint32_t bits = u32_at(p);
    float v;
    memcpy(&v, &bits, 4);
    // Written so that a NaN becomes silence.
    float clamped = v > -1.0f ? (v < 1.0f ? v : 1.0f) : (v <= -1.0f ? -1.0f : 0.0f);
    float scaled = clamped * 32767.0f;
    return (int16_t)(scaled + (scaled < 0 ? -0.5f : 0.5f));
}

static int16_t convert_sample(const uint8_t *p, const wav_format *f) {
    if (f->tag == FORMAT_FLOAT) {
        return float_sample(p);
    }
    if (f->bits == 8) {
        return (int16_t)(((int)p[0] - 128) * 256);
    }
    return (int16_t)u16_at(p + f->bits / 8 - 2); // the upper 16 bits
}

static core_sound_data *convert(const uint8_t *data, uint32_t size, const wav_format *f,
                                const char *path) {
    uint32_t stride = f->bits / 8, frames = size / (stride * f->channels);
    if (frames == 0) {
        core_fail("%s: WAV: no samples", path);
        return NULL;
    }
    size_t samples = (size_t)frames * f->channels;
    asset_block block =
        asset_block_make(asset_round(sizeof(core_sound_data)) + asset_round(samples * 2));
    core_sound_data *s = asset_block_take(&block, sizeof *s);
    int16_t *out = asset_block_take(&block, samples * 2);
    for (size_t i = 0; i < samples; i++) {
        out[i] = convert_sample(data + i * stride, f);
    }
    *s = (core_sound_data){f->channels, f->rate, frames, out};
    return s;
}

core_sound_data *asset_sound_decode(const void *bytes, size_t size, const char *path) {
    asset_reader r = asset_reader_make(bytes, size, path);
    if (size >= 4 && memcmp(bytes, "OggS", 4) == 0) {
        return asset_ogg_decode(bytes, size, r.path);
    }
    const uint8_t *head = asset_read_bytes(&r, 12);
    if (!head || memcmp(head, "RIFF", 4) != 0 || memcmp(head + 8, "WAVE", 4) != 0) {
        core_fail("%s: not a WAV or Ogg file: expected RIFF and WAVE or OggS at its start", r.path);
        return NULL;
    }
    wav_format format = {0};
    for (;;) {
        const uint8_t *chunk = asset_read_bytes(&r, 8);
        if (!chunk) {
            core_fail("%s: WAV: no %s chunk", r.path, format.tag ? "data" : "format");
            return NULL;
        }
        uint32_t length = u32_at(chunk + 4);
        bool is_data = memcmp(chunk, "data", 4) == 0;
        const uint8_t *body = asset_read_bytes(&r, length);
        if (!body) {
            core_fail("%s: WAV: a chunk of %u bytes is cut off", r.path, length);
            return NULL;
        }
        if (is_data && format.tag) {
            return convert(body, length, &format, r.path);
        }
        if (memcmp(chunk, "fmt ", 4) == 0 && !read_format(body, length, &format, r.path)) {
            return NULL;
        }
        if (length & 1) {
            asset_read_bytes(&r, 1); // chunks are padded to even lengths
        }
    }
}

static void *decode_any(const void *bytes, size_t size, const char *path) {
    return asset_sound_decode(bytes, size, path);
}

core_sound_data *asset_sound_load(core_vfs *vfs, const char *path) {
    return asset_load(vfs, path, decode_any);
}

void *asset_sound_encode(const core_sound_data *s, size_t *size) {
    uint32_t bytes = s->frame_count * s->channels * 2;
    asset_writer w = {0};
    asset_write(&w, "RIFF", 4);
    asset_write_u32(&w, 36 + bytes);
    asset_write(&w, "WAVEfmt ", 8);
    asset_write_u32(&w, 16);
    asset_write_u32(&w, FORMAT_PCM | s->channels << 16);
    asset_write_u32(&w, s->rate);
    asset_write_u32(&w, s->rate * s->channels * 2);
    asset_write_u32(&w, s->channels * 2 | 16u << 16);
    asset_write(&w, "data", 4);
    asset_write_u32(&w, bytes);
    for (size_t i = 0; i < (size_t)s->frame_count * s->channels; i++) {
        uint8_t b[2] = {(uint8_t)s->sample[i], (uint8_t)((uint16_t)s->sample[i] >> 8)};
        asset_write(&w, b, 2);
    }
    *size = w.size;
    return w.data;
}
