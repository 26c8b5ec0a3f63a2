#ifdef USE_SHADOWS
#include "shadow.glsl"
#endif

// Light loops. Plain forward walks all lights; clustered walks the ascending list of the fragment's
// cell, so both add the same terms in the same order and the sums are equal bit for bit.
layout(std430, binding = GFX_SSBO_LIGHTS) readonly buffer LightBlock { gfx_light_block lights[]; };
#ifdef USE_CLUSTERED_RENDERING
layout(std430, binding = GFX_SSBO_CLUSTER_OFFSETS) readonly buffer OffsetBlock {
    uint clusterOffset[]; // cells + 1
};
layout(std430, binding = GFX_SSBO_CLUSTER_LIGHTS) readonly buffer ListBlock {
    uint clusterLight[];
};

// Cell of this fragment. The C twin is gfx_cluster_cell.
uint clusterCell() {
    float depth = viewDepth(gl_FragCoord.z);
    float along = u_view.cluster_grid.w != 0u ? depth : log2(depth);
    uvec3 last = u_view.cluster_grid.xyz - 1u;
    float slice = along * u_view.cluster_scale.z + u_view.cluster_scale.w;
    uvec3 cell = uvec3(clamp(vec3(gl_FragCoord.xy * u_view.cluster_scale.xy, slice), vec3(0.0),
                             vec3(last)));
    return (cell.z * u_view.cluster_grid.y + cell.y) * u_view.cluster_grid.x + cell.x;
}
#endif

// Radiance that a point or spot light adds: inverse square, windowed to zero at its radius (Karis
// 2013; as glTF KHR_lights_punctual).
vec3 localLight(gfx_light_block light, Surface s) {
    vec3 toLight = light.position_radius.xyz - s.position;
    float d2 = dot(toLight, toLight);
    float x = d2 * light.spot.z; // (d/radius)^2
    if (x >= 1.0) {
        return vec3(0.0);
    }
    vec3 l = toLight * inversesqrt(max(d2, 1e-12));
    float window = 1.0 - x * x;
    float falloff = window * window / max(d2, 1e-4);
    float cone = clamp(dot(-light.direction.xyz, l) * light.spot.x + light.spot.y, 0.0, 1.0);
    float reach = falloff * cone * cone;
#ifdef USE_SHADOWS
    if (reach > 0.0) {
        reach *= shadowTerm(light, s, l);
    }
#endif
    return shade(s, l) * light.color_type.rgb * reach;
}

vec3 directLight(Surface s) {
    vec3 sum = vec3(0.0);
    uint directional = u_view.light_count.x;
    for (uint i = 0u; i < directional; ++i) {
        vec3 l = -lights[i].direction.xyz;
        vec3 light = shade(s, l) * lights[i].color_type.rgb;
#ifdef USE_SHADOWS
        light *= shadowTerm(lights[i], s, l);
#endif
        sum += light;
    }
    // Beyond the virtual far plane no point or spot light reaches, in either renderer.
    if (viewDepth(gl_FragCoord.z) > u_view.depth_range.z) {
        return sum;
    }
#ifdef USE_CLUSTERED_RENDERING
    uint cell = clusterCell();
    uint first = clusterOffset[cell], end = clusterOffset[cell + 1u] & ~GFX_CLUSTER_ALL;
    bool all = (first & GFX_CLUSTER_ALL) != 0u; // the list was longer than the cap
    end = all ? u_view.light_count.y : end;
    for (uint i = all ? 0u : first; i < end; ++i) {
        sum += localLight(lights[directional + (all ? i : clusterLight[i])], s);
    }
#else
    uint end = directional + u_view.light_count.y;
    for (uint i = directional; i < end; ++i) {
        sum += localLight(lights[i], s);
    }
#endif
    return sum;
}
