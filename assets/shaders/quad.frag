// Text (coverage in the red channel), images and plain rectangles, over the encoded picture.
#include "bindings.h"

layout(binding = GFX_TEX_IMAGE) uniform sampler2D u_image;
in vec2 v_uv;
flat in vec4 v_color;
layout(location = 0) out vec4 o_color;

void main() {
#ifdef USE_TEXT
    o_color = vec4(v_color.rgb, v_color.a * texture(u_image, v_uv).r);
#elif defined(USE_IMAGE)
    o_color = v_color * texture(u_image, v_uv);
#else
    o_color = v_color;
#endif
}
