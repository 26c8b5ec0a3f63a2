#include "gfx/gfx_lab_picture.h"

#include "core/clock.h"
#include "gfx/gfx_device_internal.h"

bool gfx_lab_picture_open(gfx_lab_picture *p, const core_lab_case *c, uint32_t width,
                          uint32_t height) {
    gfx_device_desc desc = gfx_device_desc_default();
    gfx_world_desc world = gfx_world_desc_default();
    *p = (gfx_lab_picture){.vfs = core_vfs_create(), .width = width, .height = height};
    desc.width = width, desc.height = height;
    desc.vfs = p->vfs;
    desc.float_target = true;
    p->rgba = core_alloc((size_t)width * height * 4 * sizeof *p->rgba);
    p->device = core_vfs_mount(p->vfs, core_lab_text(c, "assets", "assets"), "", false)
                    ? gfx_device_create(&desc)
                    : NULL;
    p->world = p->device ? gfx_world_create(&world) : NULL;
    return p->world != NULL;
}

bool gfx_lab_picture_draw(gfx_lab_picture *p) {
    return gfx_device_render(p->device, p->world) && gfx_device_read_float(p->device, p->rgba);
}

double gfx_lab_picture_once(gfx_lab_picture *p) {
    uint64_t start = core_clock_cpu_ns();
    gfx_device_render(p->device, p->world);
    glFinish();
    return (double)(core_clock_cpu_ns() - start);
}

double gfx_lab_picture_time(gfx_lab_picture *p) {
    double best = gfx_lab_picture_once(p);
    for (int i = 1; i < 7; ++i) {
        double ns = gfx_lab_picture_once(p);
        best = CORE_MIN(best, ns);
    }
    return best;
}

void gfx_lab_picture_close(gfx_lab_picture *p) {
    core_free(p->rgba);
    gfx_world_destroy(p->world);
    gfx_device_destroy(p->device);
    core_vfs_destroy(p->vfs);
}
