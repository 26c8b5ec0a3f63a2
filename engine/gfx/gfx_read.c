// Pictures out: any pass of the last frame, as numbers or as a PNG.
#include "gfx/gfx_device_internal.h"

#include <stb_image_write.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

// Turns the picture upside down in place: GL's first row is the lowest.
static void flip_rows(uint8_t *data, size_t stride, uint32_t height) {
    for (uint32_t y = 0; y < height / 2; ++y) {
        uint8_t *a = data + y * stride, *b = data + (height - 1 - y) * stride;
        for (size_t i = 0; i < stride; ++i) {
            uint8_t t = a[i];
            a[i] = b[i];
            b[i] = t;
        }
    }
}

static bool read_texture(gfx_device *d, const gfx_target *from, GLenum format, GLenum type,
                         size_t pixel, void *out) {
    if (!out || !d->context->table->make_current(d->context)) {
        return false;
    }
    uint32_t before = d->gl_errors;
    size_t stride = from->width * pixel;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(from->texture, 0, format, type, (GLsizei)(stride * from->height), out);
    flip_rows(out, stride, from->height);
    return gfx_device_check(d, "gfx_device_read", before);
}

bool gfx_device_read(gfx_device *device, uint8_t *rgba) {
    return read_texture(device, &device->targets.picture, GL_RGBA, GL_UNSIGNED_BYTE, 4, rgba);
}

bool gfx_device_read_float(gfx_device *device, float *rgba) {
    return read_texture(device, &device->targets.hdr, GL_RGBA, GL_FLOAT, 16, rgba);
}

static gfx_target depth_target(const gfx_device *d) {
    return (gfx_target){
        .texture = d->targets.depth, .width = d->targets.width, .height = d->targets.height};
}

bool gfx_device_read_depth(gfx_device *device, float *depth) {
    gfx_target from = depth_target(device);
    return read_texture(device, &from, GL_DEPTH_COMPONENT, GL_FLOAT, 4, depth);
}

// ---- passes by name ----

enum { PASS_HDR, PASS_DEPTH, PASS_AO, PASS_BLOOM, PASS_PICTURE, PASS_COUNT };
static const char *const names[PASS_COUNT] = {"hdr", "depth", "ao", "bloom", "picture"};

static bool find_pass(const gfx_device *d, const char *pass, int *number, gfx_target *out) {
    const gfx_targets *t = &d->targets;
    const gfx_target all[PASS_COUNT] = {t->hdr, depth_target(d), t->ao_smooth, t->bloom[0],
                                        t->picture};
    *number = gfx_find_name(pass, names, PASS_COUNT);
    if (*number < 0) {
        return gfx_fail_name("pass", pass, names, PASS_COUNT);
    }
    *out = all[*number];
    return out->texture != 0 ||
           core_fail("gfx: the pass \"%s\" did not run in the last frame; set gfx.%s", pass, pass);
}

bool gfx_device_read_pass(gfx_device *d, const char *pass, float *rgba, uint32_t *width,
                          uint32_t *height) {
    gfx_target from;
    int number;
    if (!find_pass(d, pass, &number, &from)) {
        return false;
    }
    *width = from.width, *height = from.height;
    if (!rgba) {
        return true;
    }
    bool depth = number == PASS_DEPTH;
    size_t pixels = (size_t)from.width * from.height;
    if (!read_texture(d, &from, depth ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, depth ? 4 : 16,
                      rgba)) {
        return false;
    }
    for (size_t i = pixels; i-- > 0 && (depth || number == PASS_AO);) { // from the end, in place
        float value = rgba[depth ? i : 4 * i];
        float *p = rgba + 4 * i;
        p[0] = p[1] = p[2] = value;
        p[3] = 1.0f;
    }
    return true;
}

// ---- files ----

static bool make_parents(const char *path) {
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", path);
    for (char *at = strchr(folder + 1, '/'); at; at = strchr(at + 1, '/')) {
        *at = '\0';
        if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
            return core_fail("%s: the folder %s cannot be made (%s)", path, folder,
                             strerror(errno));
        }
        *at = '/';
    }
    return true;
}

static bool write_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height) {
    return make_parents(path) &&
           (stbi_write_png(path, (int)width, (int)height, 4, rgba, (int)width * 4) ||
            core_fail("%s: the picture cannot be written (%s)", path, strerror(errno)));
}

bool gfx_device_shot(gfx_device *device, const char *real_path) {
    uint8_t *rgba = core_alloc((size_t)device->width * device->height * 4);
    bool ok =
        gfx_device_read(device, rgba) && write_png(real_path, rgba, device->width, device->height);
    core_free(rgba);
    return ok;
}

static uint8_t to_byte(float x, bool encode) {
    x = x > 0.0f ? CORE_MIN(x, 1.0f) : 0.0f; // NaN is black
    if (encode) {
        x = x <= 0.0031308f ? 12.92f * x : 1.055f * (float)core_pow((double)x, 1.0 / 2.4) - 0.055f;
    }
    return (uint8_t)(x * 255.0f + 0.5f);
}

bool gfx_device_shot_pass(gfx_device *d, const char *pass, const char *real_path) {
    gfx_target from;
    int number;
    if (!find_pass(d, pass, &number, &from)) {
        return false;
    }
    size_t values = (size_t)from.width * from.height * 4;
    float *rgba = core_alloc(values * sizeof *rgba);
    uint8_t *bytes = core_alloc(values);
    bool encode = number == PASS_HDR || number == PASS_BLOOM;
    bool ok = gfx_device_read_pass(d, pass, rgba, &from.width, &from.height);
    for (size_t i = 0; i < values && ok; ++i) {
        bytes[i] = i % 4 == 3 ? 255 : to_byte(rgba[i], encode);
    }
    ok = ok && write_png(real_path, bytes, from.width, from.height);
    core_free(rgba);
    core_free(bytes);
    return ok;
}
