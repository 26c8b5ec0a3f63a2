#include "app/lab_kernels.h"

#include "anim/lab.h"
#include "gfx/gfx_lab.h"
#include "nav/lab.h"
#include "phys/lab.h"
#include "script/lab.h"

const core_lab_kernel *const app_lab_kernels[] = {
    &core_lab_math,     &core_lab_layout, &phys_lab_motion,
    &phys_lab_broad,    &gfx_lab_cluster, &gfx_lab_frame,
    &gfx_lab_shadow,    &gfx_lab_depth,   &gfx_lab_reflection,
    &gfx_lab_post,      &gfx_lab_terrain, &gfx_lab_particles,
    &script_lab_access, &anim_lab_pose,   &anim_lab_pack,
    &anim_lab_keys,     &anim_lab_lod,    &anim_lab_fade,
    &nav_lab_search,    &nav_lab_build,   NULL,
};
