// Lines in the world, some pixels wide: a quad of two triangles along each.
#include "common.glsl"

layout(std430, binding = GFX_SSBO_QUADS) readonly buffer LineBlock { gfx_line_block lines[]; };
flat out vec4 v_color;
flat out float v_half;              // of the width, pixels
noperspective out float v_distance; // from the middle, pixels

void main() {
    gfx_line_block line = lines[gl_VertexID / 6];
    int corner = int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
    vec4 a = u_view.view_proj * vec4(line.from.xyz, 1.0);
    vec4 b = u_view.view_proj * vec4(line.to.xyz, 1.0);
    // Both ends in front of the near plane, w = z: a point behind the eye has no place in the frame.
    float da = a.w - a.z, db = b.w - b.z;
    if (da < 0.0 && db < 0.0) {
        gl_Position = vec4(0.0, 0.0, -1.0, 1.0);
        return;
    }
    vec4 from = da < 0.0 ? mix(a, b, da / (da - db)) : a;
    vec4 to = db < 0.0 ? mix(b, a, db / (db - da)) : b;
    vec2 along = (to.xy / to.w - from.xy / from.w) * u_view.viewport.xy;
    along = dot(along, along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
    v_half = 0.5 * line.from.w;
    v_color = line.color;
    float side = (corner & 1) == 0 ? -1.0 : 1.0, reach = v_half + 1.0;
    vec4 p = corner < 2 ? from : to;
    v_distance = side * reach;
    vec2 offset = vec2(-along.y, along.x) * side * reach;
    p.xy += offset * 2.0 * u_view.viewport.zw * p.w;
    // A little nearer than the surface that it lies on; on top: as near as can be.
    p.z = line.to.w > 0.5 ? p.w : min(p.w, p.z * 1.0004);
    gl_Position = p;
}
