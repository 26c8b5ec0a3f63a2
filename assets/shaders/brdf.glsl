// Metallic-roughness BRDF: GGX distribution (Walter et al. 2007), height-correlated Smith
// visibility (Heitz 2014), Schlick Fresnel; energy lost to scattering between facets is given back
// (Turquin 2019, after Kulla, Conty 2017); the Lambert diffuse lobe takes what the specular one
// leaves.
const float PI = 3.14159265358979;

// Directional albedo of the specular lobe: f0 * x + f90 * y, by (cos of view angle, roughness).
layout(binding = GFX_TEX_DFG) uniform sampler2D u_dfg;

struct Surface {
    vec3 position; // world
    vec3 normal;     // unit, towards the viewer; from the normal map where there is one
#ifdef USE_SHADOWS
    vec3 flatNormal; // unit, of the geometry
#endif
    vec3 view;     // unit, towards the viewer
    float noV;
    float roughness; // perceptual
    float alpha;     // roughness squared
    vec3 f0;
    float f90;
    vec3 specularGain; // energy compensation of the specular lobe
    vec3 specular;     // directional albedo of the specular lobe, compensated
    vec3 diffuse;      // albedo of the diffuse lobe, reduced by the specular one
};

// Fills what follows from base colour, metalness, roughness and the geometry.
void setMaterial(inout Surface s, vec3 base, float metallic, float roughness) {
    // Below this roughness the lobe of a point light is narrower than 32-bit floats resolve.
    s.roughness = clamp(roughness, 0.045, 1.0);
    s.alpha = s.roughness * s.roughness;
    s.f0 = mix(vec3(0.04), base, metallic);
    s.f90 = clamp(50.0 * dot(s.f0, vec3(1.0 / 3.0)), 0.0, 1.0); // nothing physical below 2 %
    float texel = 0.5 / float(GFX_DFG_SIZE); // roughness 0 and 1 lie on texel centres
    vec2 dfg = textureLod(u_dfg, vec2(s.noV, mix(texel, 1.0 - texel, s.roughness)), 0.0).xy;
    s.specularGain = 1.0 + s.f0 * (1.0 / max(dfg.x + dfg.y, 1e-3) - 1.0);
    s.specular = (s.f0 * dfg.x + s.f90 * dfg.y) * s.specularGain;
    s.diffuse = base * (1.0 - metallic) * (1.0 - s.specular);
}

float distributionGgx(float noH, vec3 normal, vec3 h, float alpha) {
    // 1 - noH^2 as a cross product: the difference would lose its digits near the peak.
    vec3 c = cross(normal, h);
    float a = noH * alpha, k = alpha / (dot(c, c) + a * a);
    return k * k * (1.0 / PI);
}

float visibilitySmith(float noV, float noL, float alpha) {
    float a2 = alpha * alpha;
    float v = noL * sqrt((noV - noV * a2) * noV + a2);
    float l = noV * sqrt((noL - noL * a2) * noL + a2);
    return 0.5 / max(v + l, 1e-7);
}

vec3 fresnelSchlick(vec3 f0, float f90, float u) {
    float x = 1.0 - u, x2 = x * x;
    return f0 + (f90 - f0) * (x2 * x2 * x);
}

// Outgoing radiance for unit irradiance on a plane that faces the light, cosine included.
vec3 shade(Surface s, vec3 l) {
    float noL = clamp(dot(s.normal, l), 0.0, 1.0);
    vec3 h = normalize(s.view + l);
    float noH = clamp(dot(s.normal, h), 0.0, 1.0);
    float loH = clamp(dot(l, h), 0.0, 1.0);
    vec3 f = fresnelSchlick(s.f0, s.f90, loH) * s.specularGain;
    float specular =
        distributionGgx(noH, s.normal, h, s.alpha) * visibilitySmith(s.noV, noL, s.alpha);
    return (s.diffuse * (1.0 / PI) + specular * f) * noL;
}
