// Image files to texels with all their mip levels. No GL here: it runs on any thread.
#ifndef GFX_MIPS_H
#define GFX_MIPS_H

#include "core/vfs.h"

enum { GFX_MIPS_LEVELS = 15, GFX_MIPS_MAX_SIDE = 16384 };
#define GFX_MIPS_MAX_PIXELS (1u << 26)

typedef struct gfx_mips {
    uint32_t width, height, levels;
    bool srgb;                     // colour channels are sRGB-encoded
    bool hdr;                      // texels are 4 linear floats, else 4 bytes
    uint8_t *texels;               // all levels, rows from top to bottom
    size_t first[GFX_MIPS_LEVELS]; // byte at which a level starts
} gfx_mips;

// PNG, JPEG, BMP, TGA or Radiance HDR. False + core_fail naming the file: absent, broken, or larger
// than GFX_MIPS_MAX_SIDE a side or GFX_MIPS_MAX_PIXELS. Each level is the mean by area of the one
// above, of light and not of its encoding. srgb: how an image of bytes is meant.
bool gfx_mips_load(core_vfs *vfs, const char *path, bool srgb, gfx_mips *out);
// What stb_image may be given: a known kind, a sane size, and of Radiance files whole rows. False +
// core_fail.
bool gfx_mips_check(const char *path, const void *file, size_t size);
// The same from w*h*4 bytes, which are copied.
void gfx_mips_from_bytes(const uint8_t *rgba, uint32_t width, uint32_t height, bool srgb,
                         gfx_mips *out);
void gfx_mips_release(gfx_mips *image);
size_t gfx_mips_bytes(const gfx_mips *image);
uint32_t gfx_mips_level_size(uint32_t size, uint32_t level);

#endif
