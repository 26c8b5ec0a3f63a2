// Pictures, texts and particles in the world: six vertices each, corners from the vertex number.
#include "common.glsl"

layout(std430, binding = GFX_SSBO_QUADS) readonly buffer BoardBlock { gfx_board_block boards[]; };
out vec2 v_uv;
out vec2 v_place; // -1..1
flat out vec4 v_color;
flat out float v_additive;

void main() {
    gfx_board_block b = boards[gl_VertexID / 6];
    int corner = int[6](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
    vec2 at = vec2(corner & 1, corner >> 1);
    v_place = at * 2.0 - 1.0;
    vec3 p = b.place.xyz + b.right.xyz * v_place.x - b.up.xyz * v_place.y;
    gl_Position = u_view.view_proj * vec4(p, 1.0);
    v_uv = mix(b.uv.xy, b.uv.zw, at);
    v_color = b.color;
    v_additive = b.place.w;
}
