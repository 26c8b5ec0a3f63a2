#include "core/radiance.h"

#include <string.h>

static bool rows_complete(const uint8_t *at, const uint8_t *end, uint32_t width, uint32_t height) {
    bool packed = width >= 8 && width < 32768;
    for (uint32_t y = 0; y < height; ++y) {
        packed = packed && end - at >= 4 && at[0] == 2 && at[1] == 2 && at[2] < 128;
        if (!packed) { // from the first plain row on all are plain
            return (uint64_t)(end - at) >= (uint64_t)width * (height - y) * 4;
        }
        at += 4;
        for (uint32_t left = 4 * width; left > 0;) {
            uint32_t part = left % width ? left % width : width; // runs end with their channel
            if (at == end || *at == 0) {
                return false;
            }
            uint32_t run = *at > 128 ? *at - 128u : *at, bytes = *at > 128 ? 2 : 1 + run;
            if (run > part || (size_t)(end - at) < bytes) {
                return false;
            }
            at += bytes;
            left -= run;
        }
    }
    return true;
}

bool core_radiance_complete(const void *data, size_t size, uint32_t width, uint32_t height) {
    const uint8_t *file = data;
    for (size_t i = 0; i + 3 < size; ++i) { // the line of the size follows an empty one
        if (memcmp(file + i, "\n\n-Y", 4) == 0) {
            const uint8_t *line = memchr(file + i + 2, '\n', size - i - 2);
            return line && rows_complete(line + 1, file + size, width, height);
        }
    }
    return false;
}
