// A pass over the picture that a script wrote: its file defines vec3 effect(vec2 uv), the colour at
// 0..1 from the lower left corner: linear before the tone map, encoded after it.
#include "common.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_picture;
layout(binding = GFX_TEX_DEPTH) uniform sampler2D u_depth;
layout(location = GFX_U_PARAMETERS) uniform vec4 u_parameters[GFX_PARAMETERS / 4];
layout(location = 0) out vec4 o_color;

// What was there before this pass.
vec3 picture(vec2 uv) { return textureLod(u_picture, uv, 0.0).rgb; }
// Metres ahead of the camera; infinite where nothing is.
float depth(vec2 uv) { return viewDepth(textureLod(u_depth, uv, 0.0).r); }
// Pixels of the view.
vec2 size() { return u_view.viewport.xy; }
float parameter(int i) { return u_parameters[i / 4][i % 4]; }

#include "HOOK"

void main() { o_color = vec4(effect(gl_FragCoord.xy * u_view.viewport.zw), 1.0); }
