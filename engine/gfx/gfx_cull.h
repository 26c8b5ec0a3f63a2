// Frustum culling.
#ifndef GFX_CULL_H
#define GFX_CULL_H

#include "core/simd.h"
#include "gfx/gfx_internal.h"

// Rows whose bounding sphere touches the view, ascending. out[count]; returns how many. Spheres
// that are not finite are outside.
CORE_SIMD_DECLARE(uint32_t, gfx_cull,
                  (const gfx_instances *instances, const gfx_view *view, uint32_t *out))

#endif
