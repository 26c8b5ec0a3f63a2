// The environment behind everything.
#include "sky.glsl"

in vec3 v_direction;
layout(location = 0) out vec4 o_color;

void main() { o_color = vec4(environmentRadiance(normalize(v_direction), 0.0), 1.0); }
