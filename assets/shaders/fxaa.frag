// Fast approximate anti-aliasing, after Lottes 2009 ("FXAA", NVIDIA white paper): finds an edge by
// contrast of luma, its direction, walks to both of its ends, and reads the picture shifted across
// it by how near the nearer end is. Pixels below the contrast threshold stay as they are.
#include "common.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_picture; // encoded
layout(location = 0) out vec4 o_color;

const float leastContrast = 0.0312, relativeContrast = 0.125, blendWeight = 0.75;
const int steps = 12;

float luma(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }

float lumaAt(ivec2 at) {
    return luma(texelFetch(u_picture, clamp(at, ivec2(0), textureSize(u_picture, 0) - 1), 0).rgb);
}

struct Neighbours {
    float m, n, s, e, w, ne, nw, se, sw;
};

Neighbours read(ivec2 p) {
    return Neighbours(lumaAt(p), lumaAt(p + ivec2(0, 1)), lumaAt(p - ivec2(0, 1)),
                      lumaAt(p + ivec2(1, 0)), lumaAt(p - ivec2(1, 0)), lumaAt(p + ivec2(1, 1)),
                      lumaAt(p + ivec2(-1, 1)), lumaAt(p + ivec2(1, -1)), lumaAt(p - ivec2(1, 1)));
}

// Distance (pixels) along `step` to where the mean luma of the edge's two sides is no longer that of
// the edge; *over: how far off it is there.
float walk(vec2 at, vec2 step, float edge, float gradient, out float over) {
    vec2 texel = 1.0 / vec2(textureSize(u_picture, 0));
    float far = 0.0;
    over = 0.0;
    for (int i = 0; i < steps && abs(over) < 0.25 * gradient; ++i) {
        far += i < 5 ? 1.0 : 2.0;
        over = luma(textureLod(u_picture, (at + step * far) * texel, 0.0).rgb) - edge;
    }
    return far;
}

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    Neighbours l = read(p);
    float most = max(l.m, max(max(l.n, l.s), max(l.e, l.w)));
    float least = min(l.m, min(min(l.n, l.s), min(l.e, l.w)));
    o_color = texelFetch(u_picture, p, 0);
    if (most - least < max(leastContrast, most * relativeContrast)) {
        return;
    }
    // Second differences tell whether the edge runs along x or along y.
    float alongX = abs(l.nw + l.sw - 2.0 * l.w) + 2.0 * abs(l.n + l.s - 2.0 * l.m) +
                   abs(l.ne + l.se - 2.0 * l.e);
    float alongY = abs(l.nw + l.ne - 2.0 * l.n) + 2.0 * abs(l.w + l.e - 2.0 * l.m) +
                   abs(l.sw + l.se - 2.0 * l.s);
    bool horizontal = alongX >= alongY;
    float up = horizontal ? l.n : l.e, down = horizontal ? l.s : l.w;
    bool higher = abs(up - l.m) >= abs(down - l.m);
    vec2 across = (horizontal ? vec2(0.0, 1.0) : vec2(1.0, 0.0)) * (higher ? 1.0 : -1.0);
    float gradient = abs((higher ? up : down) - l.m), edge = 0.5 * ((higher ? up : down) + l.m);
    vec2 along = horizontal ? vec2(1.0, 0.0) : vec2(0.0, 1.0), side = gl_FragCoord.xy + 0.5 * across;
    float overA, overB;
    float a = walk(side, -along, edge, gradient, overA), b = walk(side, along, edge, gradient, overB);
    // Only an end whose side changes in this pixel's sense moves this pixel.
    float over = a < b ? overA : overB;
    float shift = (over < 0.0) != (l.m < edge) ? 0.5 - min(a, b) / (a + b) : 0.0;
    // Single pixels and thin lines: by contrast with the mean of the neighbourhood.
    float mean = (2.0 * (l.n + l.s + l.e + l.w) + l.ne + l.nw + l.se + l.sw) / 12.0;
    float alone = smoothstep(0.0, 1.0, clamp(abs(mean - l.m) / (most - least), 0.0, 1.0));
    shift = max(shift, alone * alone * blendWeight);
    vec2 texel = 1.0 / vec2(textureSize(u_picture, 0));
    o_color = textureLod(u_picture, (gl_FragCoord.xy + across * shift) * texel, 0.0);
}
