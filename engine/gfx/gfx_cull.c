// Frustum culling of bounding spheres.
#include "gfx/gfx_internal.h"

uint32_t gfx_cull(const gfx_instances *instances, const gfx_view *view, uint32_t *out) {
    uint32_t n = core_columns_count(&instances->set), kept = 0;
    const float *cx = instances->cx, *cy = instances->cy, *cz = instances->cz, *cr = instances->cr;
    for (uint32_t i = 0; i < n; ++i) {
        bool inside = true;
        for (int k = 0; k < GFX_PLANES; ++k) {
            const float *p = view->plane[k];
            inside &= p[0] * cx[i] + p[1] * cy[i] + p[2] * cz[i] + p[3] >= -cr[i];
        }
        out[kept] = i;
        kept += inside;
    }
    return kept;
}
