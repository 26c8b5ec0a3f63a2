// Screen-space quads: six vertices each, corners from the vertex number.
#include "common.glsl"

layout(std430, binding = GFX_SSBO_QUADS) readonly buffer QuadBlock { gfx_quad_block quads[]; };
out vec2 v_uv;
flat out vec4 v_color;

void main() {
    gfx_quad_block q = quads[gl_VertexID / 6];
    int corner = int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
    vec2 at = vec2(corner & 1, corner >> 1);
    vec2 p = (q.rect.xy + at * q.rect.zw) * u_view.viewport.zw;
    gl_Position = vec4(p.x * 2.0 - 1.0, 1.0 - p.y * 2.0, 0.0, 1.0);
    v_uv = mix(q.uv.xy, q.uv.zw, at);
    v_color = q.color;
}
