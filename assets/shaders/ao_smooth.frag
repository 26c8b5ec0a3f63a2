// Gathers the 4 x 4 pixels over which ao.frag spreads its samples, of the same surface only. Depth
// of a plane is affine on the screen, so a neighbour belongs when it lies where this pixel's
// gradient says.
#include "common.glsl"
#include "ao.glsl"

layout(binding = GFX_TEX_AO) uniform sampler2D u_ao;
layout(location = 0) out float o_visibility;

bool inside(ivec2 at) {
    return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(u_view.viewport.xy)));
}

float slope(ivec2 at, ivec2 step, float depth) {
    float a = depth - texelFetch(u_depth, at - step, 0).r;
    float b = texelFetch(u_depth, at + step, 0).r - depth;
    return !inside(at + step) || (inside(at - step) && abs(a) < abs(b)) ? a : b;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(u_depth, at, 0).r;
    float sum = 0.0, weights = 0.0;
    vec2 gradient = vec2(slope(at, ivec2(1, 0), depth), slope(at, ivec2(0, 1), depth));
    for (int y = -2; y <= 2; ++y) {
        for (int x = -2; x <= 2; ++x) {
            ivec2 p = at + ivec2(x, y);
            if (!inside(p)) {
                continue;
            }
            // Five wide with halves at the ends: each phase of the pattern of four counts the same.
            float weight = (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0);
            float off = texelFetch(u_depth, p, 0).r - depth - dot(gradient, vec2(x, y));
            weight *= max(1.0 - 50.0 * abs(off) / max(depth, 1e-20), x == 0 && y == 0 ? 1.0 : 0.0);
            sum += texelFetch(u_ao, p, 0).r * weight;
            weights += weight;
        }
    }
    o_visibility = mix(1.0, sum / weights, u_view.ao.x);
}
