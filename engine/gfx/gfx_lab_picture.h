// A device and a world for lab kernels that judge pictures.
#ifndef GFX_LAB_PICTURE_H
#define GFX_LAB_PICTURE_H

#include "core/lab.h"
#include "gfx/gfx.h"

typedef struct gfx_lab_picture {
    core_vfs *vfs;
    gfx_device *device;
    gfx_world *world;
    float *rgba; // of the last frame, linear, rows top to bottom
    uint32_t width, height;
} gfx_lab_picture;

// False + core_fail; close in any case. Shaders are read from the folder `assets` of the case.
bool gfx_lab_picture_open(gfx_lab_picture *p, const core_lab_case *c, uint32_t width,
                          uint32_t height);
bool gfx_lab_picture_draw(gfx_lab_picture *p);
// CPU time of one frame, and the least of seven, ns.
double gfx_lab_picture_once(gfx_lab_picture *p);
double gfx_lab_picture_time(gfx_lab_picture *p);
void gfx_lab_picture_close(gfx_lab_picture *p);

#endif
