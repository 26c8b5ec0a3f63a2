// Positions of the depth buffer.
layout(binding = GFX_TEX_DEPTH) uniform sampler2D u_depth;

// Of a pixel's centre in view space. Where nothing is, depth is finite all the same: infinity times
// zero is no number, and chips differ in what they make of it.
vec3 viewPosition(ivec2 at) {
    float z = texelFetch(u_depth, at, 0).r;
    float depth = z > 0.0 ? viewDepth(z) : 1e8;
    vec2 ndc = (vec2(at) + 0.5) * u_view.viewport.zw * 2.0 - 1.0;
    vec2 lens = u_view.lens.xy * (u_view.camera.w > 0.0 ? depth : 1.0);
    return vec3(ndc * lens, -depth);
}
