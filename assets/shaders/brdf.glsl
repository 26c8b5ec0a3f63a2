// Metallic-roughness BRDF: GGX distribution (Walter et al. 2007), height-correlated Smith
// visibility (Heitz 2014), Schlick Fresnel, Lambert diffuse.
const float PI = 3.14159265358979;

struct Surface {
    vec3 position; // world
    vec3 normal;   // unit, towards the viewer
    vec3 view;     // unit, towards the viewer
    float noV;
    vec3 diffuse; // albedo of the diffuse lobe
    vec3 f0;
    float alpha; // roughness squared
};

float distributionGgx(float noH, float alpha) {
    // 1 - noH^2 loses all digits near 1 for small alpha; a fragment is never smoother than
    // the clamp on alpha allows, so this form stays exact enough (see surfaceOf).
    float a2 = alpha * alpha;
    float d = (noH * a2 - noH) * noH + 1.0;
    return a2 / (PI * d * d);
}

float visibilitySmith(float noV, float noL, float alpha) {
    float a2 = alpha * alpha;
    float v = noL * sqrt((noV - noV * a2) * noV + a2);
    float l = noV * sqrt((noL - noL * a2) * noL + a2);
    return 0.5 / (v + l);
}

vec3 fresnelSchlick(vec3 f0, float u) {
    float f90 = min(50.0 * f0.g, 1.0); // below 2 % reflectance nothing physical remains
    float x = 1.0 - u, x2 = x * x;
    return f0 + (f90 - f0) * (x2 * x2 * x);
}

// Outgoing radiance for unit irradiance on a plane facing the light, cosine included.
vec3 shade(Surface s, vec3 l) {
    float noL = clamp(dot(s.normal, l), 0.0, 1.0);
    vec3 h = normalize(s.view + l);
    float noH = clamp(dot(s.normal, h), 0.0, 1.0);
    float loH = clamp(dot(l, h), 0.0, 1.0);
    vec3 f = fresnelSchlick(s.f0, loH);
    float specular = distributionGgx(noH, s.alpha) * visibilitySmith(s.noV, noL, s.alpha);
    return (s.diffuse * (1.0 / PI) + specular * f) * noL;
}
