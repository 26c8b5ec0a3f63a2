// What rendering tests share: a small EGL device that reads shaders from the source tree, pictures
// compared in numbers.
#ifndef SUPPORT_GFX_FIXTURE_H
#define SUPPORT_GFX_FIXTURE_H

#include "gfx/gfx.h"

typedef struct gfx_fixture {
    core_vfs *vfs;
    gfx_device *device;
    gfx_world *world;
    uint32_t width, height;
} gfx_fixture;

// Fails the running test when no device can be made.
gfx_fixture gfx_fixture_open(uint32_t width, uint32_t height, bool float_target);
void gfx_fixture_close(gfx_fixture *f);
// Renders and gives the HDR picture (width*height*4, core_free it).
float *gfx_fixture_hdr(gfx_fixture *f);
uint8_t *gfx_fixture_ldr(gfx_fixture *f);
// Largest absolute difference of n numbers; NaN counts as infinite.
float gfx_max_difference(const float *a, const float *b, size_t n);

gfx_instance gfx_add(gfx_world *world, const char *mesh, core_vec3 position, core_vec3 scale,
                     float r, float g, float b);
gfx_light gfx_add_point(gfx_world *world, core_vec3 position, float radius, float intensity);
gfx_light gfx_add_sun(gfx_world *world, core_vec3 direction, float irradiance);
void gfx_look(gfx_world *world, core_vec3 eye, core_vec3 target);

#endif
