// The environment seen through a GGX lobe of one roughness, for view and normal along the lobe's
// axis (Karis 2013). Samples follow the distribution; each reads the mip level whose texels cover as
// much of the sphere as the sample stands for (Krivanek, Colbert 2008).
#include "bindings.h"
#include "cube.glsl"

layout(binding = GFX_TEX_ENVIRONMENT) uniform samplerCube u_source;
layout(location = GFX_U_ROUGHNESS) uniform float u_roughness;
layout(location = 0) out vec4 o_color;

layout(location = GFX_U_SAMPLES) uniform int u_samples;
const float PI = 3.14159265358979;

// Point i of the Hammersley set: its second coordinate is i with its bits turned round.
vec2 hammersley(uint i) {
    return vec2((float(i) + 0.5) / float(u_samples), float(bitfieldReverse(i)) * 2.3283064e-10);
}

void main() {
    vec3 n = faceDirection();
    float a2 = pow(u_roughness, 4.0);
    vec3 side = normalize(cross(abs(n.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0), n));
    vec3 up = cross(n, side);
    float texels = float(textureSize(u_source, 0).x);
    float texel = 4.0 * PI / (6.0 * texels * texels); // solid angle
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < uint(u_samples); ++i) {
        vec2 u = hammersley(i);
        float cosine = sqrt((1.0 - u.y) / (1.0 + (a2 - 1.0) * u.y)), sine = sqrt(1.0 - cosine * cosine);
        float noL = 2.0 * cosine * cosine - 1.0; // view and normal are one
        if (noL > 0.0) {
            float phi = 2.0 * PI * u.x;
            vec3 h = side * (sine * cos(phi)) + up * (sine * sin(phi)) + n * cosine;
            float d = cosine * cosine * (a2 - 1.0) + 1.0;
            float density = a2 / (PI * d * d) * 0.25; // of directions
            float lod = 0.5 * log2(1.0 / (float(u_samples) * density) / texel) + 1.0;
            sum += noL * vec4(textureLod(u_source, 2.0 * cosine * h - n, max(lod, 0.0)).rgb, 1.0);
        }
    }
    o_color = vec4(sum.rgb / sum.w, 1.0);
}
