// Twice the size: bilinear at a quarter and three quarters is the subdivision of the quadratic
// B-spline (Chaikin 1974); a tent of one texel on top of it makes the kernel round.
#include "common.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_source;
layout(location = 0) out vec4 o_color;

void main() {
    vec2 texel = 1.0 / vec2(textureSize(u_source, 0)), at = 0.5 * gl_FragCoord.xy;
    vec4 sum = vec4(0.0);
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            float weight = (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25);
            sum += texture(u_source, (at + vec2(x, y)) * texel) * weight;
        }
    }
    o_color = sum;
}
