// The one step from linear HDR to display values.
#include "common.glsl"
#include "color.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_hdr;
layout(location = 0) out vec4 o_color;

void main() {
    vec3 c = texelFetch(u_hdr, ivec2(gl_FragCoord.xy), 0).rgb * u_view.ambient_sky.w;
    if (u_view.light_count.z == GFX_TONEMAP_NEUTRAL) {
        c = tonemapNeutral(c);
    }
    o_color = vec4(srgbEncode(c), 1.0);
}
