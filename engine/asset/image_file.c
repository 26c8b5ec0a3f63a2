// Images through stb_image, with the size looked at before anything is decoded.
#include "asset/asset.h"
#include "asset/bytes.h"
#include "core/radiance.h"

#include <limits.h>
#include <stb_image.h>
#include <string.h>

#define IMAGE_MAX_SIDE   16384
#define IMAGE_MAX_PIXELS (1 << 27)
#define HEIGHTS_MAX_SIDE 8193

static bool check_size(const void *bytes, size_t size, const char *path) {
    int w = 0, h = 0, channels = 0;
    if (size > INT_MAX || !stbi_info_from_memory(bytes, (int)size, &w, &h, &channels)) {
        return core_fail("%s: not an image that can be read (%s); expected PNG, JPEG, TGA, BMP or "
                         "HDR",
                         path, stbi_failure_reason() ? stbi_failure_reason() : "unknown");
    }
    if (w < 1 || h < 1 || w > IMAGE_MAX_SIDE || h > IMAGE_MAX_SIDE ||
        (int64_t)w * h > IMAGE_MAX_PIXELS) {
        return core_fail("%s: image of %d x %d pixels; expected sides of 1..%d and at most %d "
                         "pixels",
                         path, w, h, IMAGE_MAX_SIDE, IMAGE_MAX_PIXELS);
    }
    return !stbi_is_hdr_from_memory(bytes, (int)size) ||
           core_radiance_complete(bytes, size, (uint32_t)w, (uint32_t)h) ||
           core_fail("%s: image is corrupt: rows are missing", path);
}

core_image_data *asset_image_decode(const void *bytes, size_t size, const char *path,
                                    core_image_format format) {
    const char *name = path ? path : "(memory)";
    if (!check_size(bytes, size, name)) {
        return NULL;
    }
    int w = 0, h = 0, channels = 0;
    bool wide = format == CORE_IMAGE_RGBA32F;
    void *pixels = wide ? (void *)stbi_loadf_from_memory(bytes, (int)size, &w, &h, &channels, 4)
                        : (void *)stbi_load_from_memory(bytes, (int)size, &w, &h, &channels, 4);
    if (!pixels) {
        core_fail("%s: image is corrupt: %s", name, stbi_failure_reason());
        return NULL;
    }
    size_t length = (size_t)w * (size_t)h * (wide ? 16u : 4u);
    asset_block block =
        asset_block_make(asset_round(sizeof(core_image_data)) + asset_round(length));
    core_image_data *image = asset_block_take(&block, sizeof *image);
    void *copy = asset_block_take(&block, length);
    memcpy(copy, pixels, length);
    stbi_image_free(pixels);
    *image = (core_image_data){(uint32_t)w, (uint32_t)h, format, copy};
    return image;
}

core_image_data *asset_image_load(core_vfs *vfs, const char *path, core_image_format format) {
    size_t size = 0;
    void *bytes = core_vfs_read(vfs, path, &size);
    core_image_data *image = bytes ? asset_image_decode(bytes, size, path, format) : NULL;
    core_free(bytes);
    return image;
}

// ---- heights ----

core_heights_data *asset_heights_decode(const void *bytes, size_t size, const char *path, float low,
                                        float high) {
    const char *name = path ? path : "(memory)";
    int w = 0, h = 0, channels = 0;
    if (!check_size(bytes, size, name)) {
        return NULL;
    }
    uint16_t *grey = stbi_load_16_from_memory(bytes, (int)size, &w, &h, &channels, 1);
    if (!grey) {
        core_fail("%s: image is corrupt: %s", name, stbi_failure_reason());
        return NULL;
    }
    if (w < 2 || h < 2 || w > HEIGHTS_MAX_SIDE || h > HEIGHTS_MAX_SIDE) {
        core_fail("%s: %d x %d pixels; expected 2 to %d heights a side", name, w, h,
                  HEIGHTS_MAX_SIDE);
        stbi_image_free(grey);
        return NULL;
    }
    size_t count = (size_t)w * (size_t)h;
    asset_block block = asset_block_make(asset_round(sizeof(core_heights_data)) +
                                         asset_round(count * sizeof(float)));
    core_heights_data *heights = asset_block_take(&block, sizeof *heights);
    float *height = asset_block_take(&block, count * sizeof *height);
    for (size_t i = 0; i < count; ++i) {
        height[i] = low + (high - low) * ((float)grey[i] / 65535.0f);
    }
    stbi_image_free(grey);
    *heights = (core_heights_data){.columns = (uint32_t)w,
                                   .rows = (uint32_t)h,
                                   .step_x = 1.0f,
                                   .step_z = 1.0f,
                                   .height = height};
    return heights;
}

core_heights_data *asset_heights_load(core_vfs *vfs, const char *path, float low, float high) {
    size_t size = 0;
    void *bytes = core_vfs_read(vfs, path, &size);
    core_heights_data *heights = bytes ? asset_heights_decode(bytes, size, path, low, high) : NULL;
    core_free(bytes);
    return heights;
}
