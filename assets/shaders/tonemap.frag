// The one step from linear HDR to display values: bloom, exposure, correction, tone curve, encoding.
#include "common.glsl"
#include "color.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_hdr;
layout(location = 0) out vec4 o_color;

#ifdef USE_BLOOM
#include "bloom.glsl"
layout(binding = GFX_TEX_BLOOM) uniform sampler2D u_bloom;

// What scatters is taken from where it came: the sum over the picture stays.
vec3 addBloom(vec3 c) {
    vec2 at = 0.5 * gl_FragCoord.xy / vec2(textureSize(u_bloom, 0));
    return c + u_view.bloom.x * (texture(u_bloom, at).rgb - brightPart(c));
}
#endif
#ifdef USE_AUTO_EXPOSURE
#include "exposure.glsl"
#endif
#ifdef USE_GRADE
// Gain and lift, saturation about the luminance, contrast about middle grey in log2.
vec3 correct(vec3 c) {
    c = max(c * u_view.gain.rgb + u_view.lift.rgb, vec3(0.0));
    c = max(mix(vec3(dot(c, vec3(0.2126, 0.7152, 0.0722))), c, u_view.grade.y), vec3(0.0));
    return 0.18 * pow(c / 0.18, vec3(u_view.grade.x));
}
#endif

void main() {
    vec3 c = texelFetch(u_hdr, ivec2(gl_FragCoord.xy), 0).rgb;
#ifdef USE_BLOOM
    c = addBloom(c);
#endif
    c *= u_view.ambient_sky.w;
#ifdef USE_AUTO_EXPOSURE
    c *= u_exposure.exposure;
#endif
#ifdef USE_GRADE
    c = correct(c);
#endif
    if (u_view.light_count.z == GFX_TONEMAP_NEUTRAL) {
        c = tonemapNeutral(c);
    }
    o_color = vec4(srgbEncode(c), 1.0);
}
