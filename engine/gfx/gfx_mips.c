#include "gfx/gfx_mips.h"

#include "core/math.h"
#include "core/memory.h"
#include "core/radiance.h"

#include <stb_image.h>

#include <limits.h>
#include <string.h>

static size_t texel_bytes(const gfx_mips *image) { return image->hdr ? 16 : 4; }

uint32_t gfx_mips_level_size(uint32_t size, uint32_t level) { return CORE_MAX(size >> level, 1u); }

size_t gfx_mips_bytes(const gfx_mips *image) {
    uint32_t last = image->levels - 1;
    return image->first[last] + texel_bytes(image) * gfx_mips_level_size(image->width, last) *
                                    gfx_mips_level_size(image->height, last);
}

static void allocate(gfx_mips *image) {
    size_t at = 0;
    image->levels = 0;
    do {
        uint32_t level = image->levels++;
        image->first[level] = at;
        at += texel_bytes(image) * gfx_mips_level_size(image->width, level) *
              gfx_mips_level_size(image->height, level);
    } while ((image->width | image->height) >> image->levels);
    image->texels = core_alloc(at);
}

// ---- light of a byte and back ----

typedef struct curve {
    float light[256]; // of a byte
    float least[256]; // light from which on a byte is the nearest one
} curve;

static void make_curve(bool srgb, curve *c) {
    for (int i = 0; i < 256; ++i) {
        double x = i / 255.0;
        c->light[i] = (float)(!srgb          ? x
                              : x <= 0.04045 ? x / 12.92
                                             : core_pow((x + 0.055) / 1.055, 2.4));
    }
    c->least[0] = -1.0f;
    for (int i = 1; i < 256; ++i) {
        c->least[i] = 0.5f * (c->light[i - 1] + c->light[i]);
    }
}

static uint8_t nearest_byte(const curve *c, float light) {
    int low = 0;
    for (int step = 128; step; step /= 2) {
        low += low + step < 256 && c->least[low + step] <= light ? step : 0;
    }
    return (uint8_t)low;
}

// ---- levels ----

// Texels of the finer level under one of the coarser, and the weight of each: two, or three where
// an odd size is halved.
typedef struct span {
    uint32_t first, count;
    float weight[4];
} span;

static span span_of(uint32_t at, uint32_t coarse, uint32_t fine) {
    double begin = (double)at * fine / coarse, end = (double)(at + 1) * fine / coarse;
    span s = {.first = (uint32_t)begin};
    while (s.count < 4 && (double)(s.first + s.count) < end - 1e-9) {
        double low = (double)(s.first + s.count);
        double part = CORE_MIN(end, low + 1.0) - CORE_MAX(begin, low);
        s.weight[s.count++] = (float)(part / (end - begin));
    }
    return s;
}

static void read_texel(const gfx_mips *image, const curve *colors, const curve *alphas,
                       const uint8_t *at, float out[4]) {
    if (image->hdr) {
        memcpy(out, at, 16);
        return;
    }
    for (int c = 0; c < 3; ++c) {
        out[c] = colors->light[at[c]];
    }
    out[3] = alphas->light[at[3]];
}

static void write_texel(const gfx_mips *image, const curve *colors, const curve *alphas,
                        const float in[4], uint8_t *at) {
    if (image->hdr) {
        memcpy(at, in, 16);
        return;
    }
    for (int c = 0; c < 3; ++c) {
        at[c] = nearest_byte(colors, in[c]);
    }
    at[3] = nearest_byte(alphas, in[3]);
}

static void make_level(gfx_mips *image, uint32_t level, const curve *colors, const curve *alphas) {
    uint32_t fw = gfx_mips_level_size(image->width, level - 1);
    uint32_t fh = gfx_mips_level_size(image->height, level - 1);
    uint32_t w = gfx_mips_level_size(image->width, level);
    uint32_t h = gfx_mips_level_size(image->height, level);
    size_t texel = texel_bytes(image);
    const uint8_t *fine = image->texels + image->first[level - 1];
    uint8_t *out = image->texels + image->first[level];
    for (uint32_t y = 0; y < h; ++y) {
        span rows = span_of(y, h, fh);
        for (uint32_t x = 0; x < w; ++x, out += texel) {
            span columns = span_of(x, w, fw);
            float sum[4] = {0.0f};
            for (uint32_t i = 0; i < rows.count * columns.count; ++i) {
                uint32_t r = i / columns.count, c = i % columns.count;
                float t[4], weight = rows.weight[r] * columns.weight[c];
                size_t at = (size_t)(rows.first + r) * fw + columns.first + c;
                read_texel(image, colors, alphas, fine + at * texel, t);
                for (int k = 0; k < 4; ++k) {
                    sum[k] += weight * t[k];
                }
            }
            write_texel(image, colors, alphas, sum, out);
        }
    }
}

static void make_levels(gfx_mips *image) {
    curve colors, alphas;
    make_curve(image->srgb, &colors);
    make_curve(false, &alphas);
    for (uint32_t level = 1; level < image->levels; ++level) {
        make_level(image, level, &colors, &alphas);
    }
}

// ---- files ----

void gfx_mips_from_bytes(const uint8_t *rgba, uint32_t width, uint32_t height, bool srgb,
                         gfx_mips *out) {
    *out = (gfx_mips){.width = width, .height = height, .srgb = srgb};
    allocate(out);
    memcpy(out->texels, rgba, (size_t)width * height * 4);
    make_levels(out);
}

bool gfx_mips_check(const char *path, const void *file, size_t size) {
    int width, height, channels;
    if (size > INT_MAX || !stbi_info_from_memory(file, (int)size, &width, &height, &channels)) {
        return core_fail("%s: no picture that can be read (%s)", path,
                         size > INT_MAX ? "too large" : stbi_failure_reason());
    }
    bool fits = width > 0 && height > 0 && width <= GFX_MIPS_MAX_SIDE &&
                height <= GFX_MIPS_MAX_SIDE &&
                (uint64_t)width * (uint64_t)height <= GFX_MIPS_MAX_PIXELS;
    if (!fits) {
        return core_fail("%s: the picture is %dx%d, expected at most %d a side and %u pixels; "
                         "scale it down",
                         path, width, height, GFX_MIPS_MAX_SIDE, GFX_MIPS_MAX_PIXELS);
    }
    return !stbi_is_hdr_from_memory(file, (int)size) ||
           core_radiance_complete(file, size, (uint32_t)width, (uint32_t)height) ||
           core_fail("%s: the picture is cut off or broken", path);
}

// Texels by stb_image, which allocates them.
static void *decode(const void *file, size_t size, gfx_mips *image) {
    int width = 0, height = 0, channels;
    void *texels;
    image->hdr = stbi_is_hdr_from_memory(file, (int)size) != 0;
    if (image->hdr) {
        texels = stbi_loadf_from_memory(file, (int)size, &width, &height, &channels, 4);
        image->srgb = false;
    } else {
        texels = stbi_load_from_memory(file, (int)size, &width, &height, &channels, 4);
    }
    image->width = (uint32_t)width, image->height = (uint32_t)height;
    return texels;
}

// To what half floats hold.
static void clamp_light(gfx_mips *image) {
    float *c = (float *)(void *)image->texels;
    for (size_t i = 0; image->hdr && i < (size_t)image->width * image->height * 4; ++i) {
        c[i] = c[i] > 0.0f ? CORE_MIN(c[i], 65504.0f) : 0.0f;
    }
}

bool gfx_mips_load(core_vfs *vfs, const char *path, bool srgb, gfx_mips *out) {
    *out = (gfx_mips){.srgb = srgb};
    size_t size;
    void *file = vfs ? core_vfs_read(vfs, path, &size) : NULL;
    if (!file) {
        return vfs ? false : core_fail("%s: there are no files here", path);
    }
    bool ok = gfx_mips_check(path, file, size);
    void *texels = ok ? decode(file, size, out) : NULL;
    if (ok && !texels) {
        ok = core_fail("%s: no picture that can be read (%s)", path, stbi_failure_reason());
    }
    core_free(file);
    if (ok) {
        allocate(out);
        memcpy(out->texels, texels, texel_bytes(out) * out->width * out->height);
        clamp_light(out);
        make_levels(out);
    }
    stbi_image_free(texels);
    return ok;
}

void gfx_mips_release(gfx_mips *image) {
    core_free(image->texels);
    *image = (gfx_mips){0};
}
