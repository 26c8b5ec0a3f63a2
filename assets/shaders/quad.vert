// Screen-space quads: six vertices each, corners from the vertex number.
#include "common.glsl"

layout(std430, binding = GFX_SSBO_QUADS) readonly buffer QuadBlock { gfx_quad_block quads[]; };
out vec2 v_uv;
flat out vec4 v_color;
#ifdef USE_SMOOTH
out vec2 v_place;      // pixels from the middle, along the edges
flat out vec4 v_shape; // half lengths of the edges, radius, border
#endif

void main() {
    gfx_quad_block q = quads[gl_VertexID / 6];
    int corner = int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
    vec2 at = vec2(corner & 1, corner >> 1);
#ifdef USE_SMOOTH
    vec2 size = max(vec2(length(q.axes.xy), length(q.axes.zw)), 1e-3);
    at += (at * 2.0 - 1.0) / size; // a pixel more on every side, for the edge to fade in
    v_place = (at - 0.5) * size;
    v_shape = vec4(0.5 * size, min(q.place.z, 0.5 * min(size.x, size.y)), q.place.w);
#endif
    vec2 p = q.place.xy + at.x * q.axes.xy + at.y * q.axes.zw;
    gl_ClipDistance[0] = p.x - q.clip.x;
    gl_ClipDistance[1] = p.y - q.clip.y;
    gl_ClipDistance[2] = q.clip.z - p.x;
    gl_ClipDistance[3] = q.clip.w - p.y;
    p *= u_view.viewport.zw;
    gl_Position = vec4(p.x * 2.0 - 1.0, 1.0 - p.y * 2.0, 0.0, 1.0);
    v_uv = mix(q.uv.xy, q.uv.zw, at);
    v_color = q.color;
}
