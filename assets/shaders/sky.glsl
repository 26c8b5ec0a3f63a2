// Radiance of the environment from a direction: an equirectangular picture or a procedural sky.
#include "common.glsl"

#ifdef USE_PANORAMA
layout(binding = GFX_TEX_PANORAMA) uniform sampler2D u_panorama;
#endif

vec3 environmentRadiance(vec3 d, float lod) {
#ifdef USE_PANORAMA
    // The middle of the picture is -Z, its top is up.
    vec2 uv = vec2(atan(d.x, -d.z) * 0.15915494 + 0.5, acos(clamp(d.y, -1.0, 1.0)) * 0.31830989);
    return textureLod(u_panorama, uv, lod).rgb * u_view.sky_zenith.w;
#else
    float up = max(d.y, 0.0);
    vec3 sky = mix(u_view.sky_horizon.rgb, u_view.sky_zenith.rgb, 1.0 - pow(1.0 - up, 4.0));
    vec3 ground = u_view.sky_ground.rgb;
    float glow = pow(max(dot(d, u_view.sky_sun.xyz), 0.0), u_view.sky_sun.w);
    // The horizon is a few degrees wide, so that no map has to hold a step.
    return (mix(ground, sky, smoothstep(-0.03, 0.03, d.y)) + u_view.sky_glow.rgb * glow) *
           u_view.sky_zenith.w;
#endif
}
