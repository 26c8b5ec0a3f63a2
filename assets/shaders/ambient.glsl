// Light from everywhere: an environment, or a hemisphere of sky over one of ground.
#ifdef USE_IBL
layout(binding = GFX_TEX_ENVIRONMENT) uniform samplerCube u_environment; // a roughness a level

// Irradiance over pi: nine spherical harmonics, convolved with the cosine lobe beforehand
// (Ramamoorthi, Hanrahan 2001).
vec3 environmentIrradiance(vec3 n) {
    vec3 c[9];
    for (int i = 0; i < 9; ++i) {
        c[i] = u_view.harmonics[i].rgb;
    }
    vec3 sum = c[0] + c[1] * n.y + c[2] * n.z + c[3] * n.x + c[4] * (n.x * n.y) +
               c[5] * (n.y * n.z) + c[6] * (3.0 * n.z * n.z - 1.0) + c[7] * (n.x * n.z) +
               c[8] * (n.x * n.x - n.y * n.y);
    return max(sum, vec3(0.0));
}

vec3 ambientLight(Surface s) {
    // Rough lobes lean from the mirror direction to the normal (Lagarde, de Rousiers 2014).
    vec3 r = mix(reflect(-s.view, s.normal), s.normal, s.alpha);
    float lod = s.roughness * float(GFX_ENVIRONMENT_LEVELS - 1);
    vec3 mirror = textureLod(u_environment, r, lod).rgb;
    return s.diffuse * environmentIrradiance(s.normal) + s.specular * mirror;
}
#else
// The specular lobe sees the half sphere round the mirrored view, the sharper the smoother.
vec3 ambientLight(Surface s) {
    vec3 sky = u_view.ambient_sky.rgb, ground = u_view.ambient_ground.rgb;
    vec3 irradiance = mix(ground, sky, 0.5 + 0.5 * s.normal.y);
    float up = reflect(-s.view, s.normal).y;
    vec3 mirror = mix(ground, sky, clamp(0.5 + mix(4.0, 0.5, s.alpha) * up, 0.0, 1.0));
    return s.diffuse * irradiance + s.specular * mirror;
}
#endif
