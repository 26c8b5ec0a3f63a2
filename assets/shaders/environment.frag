// One face of the environment as a cube map.
#include "sky.glsl"
#include "cube.glsl"

layout(location = 0) out vec4 o_color;

void main() { o_color = vec4(environmentRadiance(faceDirection(), 0.0), 1.0); }
