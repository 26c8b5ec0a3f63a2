#ifdef USE_SHADOWS
#include "shadow.glsl"
#endif

// Light loops. Plain forward walks all lights; clustered walks the ascending list of the fragment's
// cell, so both add the same terms in the same order and the sums are equal bit for bit.
#ifdef USE_CLUSTERED_RENDERING
// Fragments side by side read different lights: texels are fetched four floats at a time, where a
// software renderer would take each float of a storage block by itself.
layout(binding = GFX_TEX_LIGHTS) uniform samplerBuffer u_lights;
gfx_light_block lightAt(uint n) {
    int at = int(n) * 3;
    return gfx_light_block(texelFetch(u_lights, at), texelFetch(u_lights, at + 1),
                           texelFetch(u_lights, at + 2));
}

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
#else
// Fragments side by side read the same light.
layout(std430, binding = GFX_SSBO_LIGHTS) readonly buffer LightBlock { gfx_light_block lights[]; };
gfx_light_block lightAt(uint n) { return lights[n]; }
#endif

// Radiance that a light adds: inverse square, windowed to zero at the radius (Karis 2013; as glTF
// KHR_lights_punctual). A sun is a light at distance 1, whose window is 1.
vec3 lightTerm(gfx_light_block light, Surface s) {
    vec3 toLight = light.position.xyz - (light.position.w > 0.0 ? s.position : vec3(0.0));
    float d2 = dot(toLight, toLight);
    float x = min(d2 * light.position.w, 1.0); // (d/radius)^2
    vec3 l = toLight * inversesqrt(max(d2, 1e-12));
    float window = 1.0 - x * x;
    float cone = clamp(dot(light.cone.xyz, l) + light.cone.w, 0.0, 1.0);
    float reach = window * window * cone * cone / max(d2, 1e-4);
#ifdef USE_SHADOWS
    if (reach > 0.0) {
        reach *= shadowTerm(light, s, l);
    }
#endif
    return shade(s, l) * light.color.rgb * reach;
}

// Suns first, then point and spot lights: all of them, or those that the cell's list names.
vec3 directLight(Surface s) {
    uint suns = u_view.light_count.x, count = suns + u_view.light_count.y;
#ifdef USE_CLUSTERED_RENDERING
    uint cell = clusterCell(), first = clusterOffset[cell] - suns, listed = suns;
    if ((first + suns & GFX_CLUSTER_ALL) != 0u) { // the list was longer than the cap
        listed = count;
    } else {
        count = (clusterOffset[cell + 1u] & ~GFX_CLUSTER_ALL) - first;
    }
#endif
    // Beyond the virtual far plane no point or spot light reaches, in either renderer.
    if (viewDepth(gl_FragCoord.z) > u_view.depth_range.z) {
        count = suns;
    }
    vec3 sum = vec3(0.0);
    if (count > 0u) {
        uint i = 0u;
        do { // a test before the body would make software renderers run it once more
#ifdef USE_CLUSTERED_RENDERING
            uint n = i < listed ? i : suns + clusterLight[first + i];
#else
            uint n = i;
#endif
            sum += lightTerm(lightAt(n), s);
        } while (++i < count);
    }
    return sum;
}
