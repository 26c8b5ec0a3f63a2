// Text (coverage in the red channel), images, rectangles and lines, over the encoded picture.
#include "bindings.h"

layout(binding = GFX_TEX_IMAGE) uniform sampler2D u_image;
in vec2 v_uv;
flat in vec4 v_color;
#ifdef USE_SMOOTH
in vec2 v_place;
flat in vec4 v_shape;
#endif
layout(location = 0) out vec4 o_color;

#ifdef USE_SMOOTH
// Share of the pixel inside a rounded rectangle, by the distance of its centre from the edge.
float coverage() {
    vec2 q = abs(v_place) - v_shape.xy + v_shape.z;
    float outside = length(max(q, 0.0)) + min(max(q.x, q.y), 0.0) - v_shape.z;
    float share = clamp(0.5 - outside, 0.0, 1.0);
    return v_shape.w > 0.0 ? share * clamp(0.5 + outside + v_shape.w, 0.0, 1.0) : share;
}
#endif

void main() {
#ifdef USE_TEXT
    o_color = vec4(v_color.rgb, v_color.a * texture(u_image, v_uv).r);
#elif defined(USE_IMAGE)
    o_color = v_color * texture(u_image, v_uv);
#elif defined(USE_SMOOTH)
    o_color = vec4(v_color.rgb, v_color.a * coverage());
#else
    o_color = v_color;
#endif
}
