// Twice the size: bilinear at a quarter and three quarters is the subdivision of the quadratic
// B-spline (Chaikin 1974).
#include "common.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_source;
layout(location = 0) out vec4 o_color;

void main() {
    o_color = texture(u_source, 0.5 * gl_FragCoord.xy / vec2(textureSize(u_source, 0)));
}
