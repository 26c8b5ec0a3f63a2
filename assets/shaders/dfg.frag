// Directional albedo of the GGX lobe, split by Schlick's Fresnel: albedo = f0 * x + f90 * y (Karis
// 2013), over the cosine of the view angle (right) and perceptual roughness (up). Visible normals
// are sampled (Heitz 2018; by spherical caps: Dupuy, Benyoub 2023) on a midpoint grid.
#include "bindings.h"

layout(location = 0) out vec2 o_dfg;

const int RINGS = 32, ANGLES = 32; // over half the circle: the other half mirrors it
const float PI = 3.14159265358979;

// Masking and shadowing over masking alone: the weight that sampling visible normals leaves.
float shadowing(float noV, float noL, float a2) {
    float v = sqrt(a2 + (1.0 - a2) * noV * noV), l = sqrt(a2 + (1.0 - a2) * noL * noL);
    return noL * (noV + v) / (noV * l + noL * v);
}

void main() {
    // Texel centres lie on roughness 0 and 1, but not on cosine 0, where the albedo has a kink.
    float noV = gl_FragCoord.x / float(GFX_DFG_SIZE);
    float roughness = (gl_FragCoord.y - 0.5) / float(GFX_DFG_SIZE - 1);
    float alpha = max(roughness * roughness, 1e-3);
    vec3 view = vec3(sqrt(1.0 - noV * noV), 0.0, noV);
    vec3 w = normalize(vec3(alpha * view.x, 0.0, view.z));
    vec2 sum = vec2(0.0);
    for (int i = 0; i < ANGLES; ++i) {
        float phi = PI * (float(i) + 0.5) / float(ANGLES);
        for (int j = 0; j < RINGS; ++j) {
            // Most of the change lies at the rim of the cap (u near 1): points are put there.
            float t = 1.0 - (float(j) + 0.5) / float(RINGS), u = 1.0 - t * t * t;
            float z = (1.0 - u) * (1.0 + w.z) - w.z, r = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
            vec3 h = vec3(r * cos(phi), r * sin(phi), z) + w;
            h = normalize(vec3(alpha * h.xy, h.z));
            float voH = max(dot(view, h), 0.0), noL = 2.0 * voH * h.z - noV;
            if (noL > 0.0) {
                float fresnel = pow(1.0 - voH, 5.0);
                float weight = 3.0 * t * t * shadowing(noV, noL, alpha * alpha);
                sum += weight * vec2(1.0 - fresnel, fresnel);
            }
        }
    }
    o_dfg = sum / float(RINGS * ANGLES);
}
