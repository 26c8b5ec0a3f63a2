// Lines with smooth edges; radiance premultiplied by coverage.
#include "bindings.h"

flat in vec4 v_color;
flat in float v_half;
noperspective in float v_distance;
layout(location = 0) out vec4 o_color;

void main() {
    float a = v_color.a * clamp(v_half + 0.5 - abs(v_distance), 0.0, 1.0);
    o_color = vec4(v_color.rgb * a, a);
}
