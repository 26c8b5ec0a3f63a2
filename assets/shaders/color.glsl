// Exposure, tone curve and display encoding.

// IEC 61966-2-1, piecewise. 1.055 x^(1/2.4) - 0.055 is t^(5/3) of the fourth root t: a polynomial of
// fourth degree meets it within 3.5e-5 (minimax) at a third of the cost of a power.
vec3 srgbEncode(vec3 c) {
    c = clamp(c, 0.0, 1.0);
    vec3 t = sqrt(sqrt(c));
    vec3 curve = (((0.08132991 * t - 0.33550145) * t + 1.12268159) * t + 0.19613586) * t - 0.06461153;
    return mix(curve, c * 12.92, lessThanEqual(c, vec3(0.0031308)));
}

// Khronos PBR Neutral tone mapper (specification 1.0, 2024): keeps base colours up to 0.76, rolls
// highlights off and desaturates them.
vec3 tonemapNeutral(vec3 c) {
    const float startCompression = 0.8 - 0.04;
    const float desaturation = 0.15;
    float x = min(c.r, min(c.g, c.b));
    float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
    c -= offset;
    float peak = max(c.r, max(c.g, c.b));
    if (peak < startCompression) {
        return c;
    }
    const float d = 1.0 - startCompression;
    float newPeak = 1.0 - d * d / (peak + d - startCompression);
    c *= newPeak / peak;
    float g = 1.0 - 1.0 / (desaturation * (peak - newPeak) + 1.0);
    return mix(c, vec3(newPeak), g);
}
