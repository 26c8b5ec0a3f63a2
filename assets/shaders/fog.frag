// Fog before what is infinitely far: blended over the background.
#include "common.glsl"
#include "fog.glsl"

in vec3 v_direction;
layout(location = 0) out vec4 o_color;

void main() {
    float fog = 1.0 - fogPassesForever(u_view.camera.xyz, normalize(v_direction));
    o_color = vec4(u_view.fog_color.rgb * fog, fog);
}
