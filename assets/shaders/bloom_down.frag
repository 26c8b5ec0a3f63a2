// Half the size by the quadratic B-spline mask 1 3 3 1: the sum stays, and repeated halving tends
// to a smooth, nearly round kernel. A texel of the half covers two by two texels exactly, whatever
// the sizes. USE_BLOOM: from the picture itself, whose bright part is taken texel by texel.
#include "common.glsl"
#include "bloom.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_source;
layout(location = 0) out vec4 o_color;

#ifdef USE_BLOOM
void main() {
    ivec2 size = textureSize(u_source, 0), first = 2 * ivec2(gl_FragCoord.xy) - 1;
    vec3 sum = vec3(0.0);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
            ivec2 at = clamp(first + ivec2(x, y), ivec2(0), size - 1);
            float weight = (x == 0 || x == 3 ? 0.125 : 0.375) * (y == 0 || y == 3 ? 0.125 : 0.375);
            sum += brightPart(texelFetch(u_source, at, 0).rgb) * weight;
        }
    }
    o_color = vec4(sum, 1.0);
}
#else
void main() {
    vec2 texel = 1.0 / vec2(textureSize(u_source, 0)), at = 2.0 * gl_FragCoord.xy;
    // Between an outer texel and an inner one, a quarter and three quarters.
    vec4 o = vec4(-0.75, -0.75, 0.75, 0.75);
    o_color = 0.25 * (texture(u_source, (at + o.xy) * texel) + texture(u_source, (at + o.zy) * texel) +
                      texture(u_source, (at + o.xw) * texel) + texture(u_source, (at + o.zw) * texel));
}
#endif
