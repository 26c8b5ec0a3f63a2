// Normal and colour of terrain: of the finest level at every distance, so that levels do not show in
// the light.
#include "terrain.glsl"

layout(binding = GFX_TEX_TERRAIN_NORMAL) uniform sampler2D u_ground;
layout(binding = GFX_TEX_TERRAIN_IMAGE) uniform sampler2D u_groundImage;

// Middle of the first texel at the first point.
vec2 groundPlace(vec3 world) {
    vec2 at = (world.xz - u_terrain.origin.xz) / u_terrain.grid.xy;
    return (at + 0.5) / (u_terrain.grid.zw + 1.0);
}

vec3 groundNormal(vec3 world) {
    vec2 n = texture(u_ground, groundPlace(world)).rg;
    return vec3(n.x, sqrt(max(1.0 - dot(n, n), 0.0)), n.y);
}

vec4 groundColor(vec3 world) {
    float y = groundNormal(world).y;
    float slope = sqrt(max(1.0 - y * y, 0.0)) / max(y, 1e-3);
    float height = clamp((world.y - u_terrain.blend.x) * u_terrain.blend.y, 0.0, 1.0);
    float steep = clamp((slope - u_terrain.blend.z) * u_terrain.blend.w, 0.0, 1.0);
    vec3 c = mix(mix(u_terrain.low.rgb, u_terrain.high.rgb, height), u_terrain.steep.rgb, steep);
    if (u_terrain.origin.w > 0.0) {
        c *= texture(u_groundImage, (world.xz - u_terrain.origin.xz) /
                                        (u_terrain.grid.xy * u_terrain.grid.zw)).rgb;
    }
    return vec4(c, 1.0);
}
