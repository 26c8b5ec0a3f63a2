// Frustum culling of bounding spheres, a vector of them at a time.
#include "gfx/gfx_cull.h"

uint32_t CORE_SIMD_NAME(gfx_cull)(const gfx_instances *s, const gfx_view *view, uint32_t *out) {
    uint32_t n = core_columns_count(&s->set), kept = 0;
    for (uint32_t i = 0; i < n; i += CORE_SIMD_WIDTH) {
        vf x = vf_load(s->cx + i), y = vf_load(s->cy + i), z = vf_load(s->cz + i);
        vf out_of_reach = vf_neg(vf_load(s->cr + i));
        vm inside = vm_first((int)(n - i));
        for (int k = 0; k < GFX_PLANES; ++k) {
            const float *p = view->plane[k];
            vf d = vf_mad(vf_set1(p[0]), x,
                          vf_mad(vf_set1(p[1]), y, vf_mad(vf_set1(p[2]), z, vf_set1(p[3]))));
            inside = vm_and(inside, vf_ge(d, out_of_reach));
        }
        for (uint32_t bits = vm_bits(inside); bits; bits &= bits - 1) {
            out[kept++] = i + (uint32_t)__builtin_ctz(bits);
        }
    }
    return kept;
}
