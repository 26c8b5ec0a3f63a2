// Blocks that every scene shader reads.
#include "bindings.h"

layout(std140, binding = GFX_UBO_VIEW) uniform ViewBlock { gfx_view_block u_view; };

// View depth (m, positive ahead) of a fragment from its reversed-Z depth.
float viewDepth(float z) {
    // Perspective: z = near / depth. Orthographic: z falls from 1 at near to 0 at far.
    return u_view.camera.w > 0.0 ? u_view.camera.w / z
                                 : mix(u_view.depth_range.y, u_view.depth_range.x, z);
}

// Unit direction from a world point to the viewer.
vec3 viewDirection(vec3 world) {
    mat4 v = u_view.view;
    return u_view.camera.w > 0.0 ? normalize(u_view.camera.xyz - world)
                                 : vec3(v[0].z, v[1].z, v[2].z);
}
