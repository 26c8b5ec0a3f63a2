// Radiance premultiplied by coverage; what is added covers nothing.
#include "bindings.h"

layout(binding = GFX_TEX_IMAGE) uniform sampler2D u_image;
in vec2 v_uv;
in vec2 v_place;
flat in vec4 v_color;
flat in float v_additive;
layout(location = 0) out vec4 o_color;

void main() {
    vec4 c = v_color;
#ifdef USE_TEXT
    c.a *= texture(u_image, v_uv).r;
#elif defined(USE_IMAGE)
    c *= texture(u_image, v_uv);
#else
    float fade = clamp(1.0 - dot(v_place, v_place), 0.0, 1.0); // a soft disc
    c.a *= fade * fade;
#endif
    o_color = vec4(c.rgb * c.a, c.a * (1.0 - v_additive));
}
