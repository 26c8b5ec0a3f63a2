// Kernels that rendering offers to the lab.
#ifndef GFX_LAB_H
#define GFX_LAB_H

#include "core/lab.h"

extern const core_lab_kernel gfx_lab_cluster, gfx_lab_frame, gfx_lab_shadow, gfx_lab_depth,
    gfx_lab_reflection, gfx_lab_post, gfx_lab_terrain, gfx_lab_particles;

#endif
