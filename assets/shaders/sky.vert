// The whole target at infinite distance (depth 0).
#include "common.glsl"

out vec3 v_direction;

void main() {
    vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    vec3 eye = u_view.camera.w > 0.0 ? vec3(p * u_view.lens.xy, -1.0) : vec3(0.0, 0.0, -1.0);
    v_direction = eye * mat3(u_view.view); // the transpose turns it to the world
    gl_Position = vec4(p, 0.0, 1.0);
}
