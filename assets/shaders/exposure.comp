// Exposure that brings the mean log luminance (Reinhard and others 2002) to the key. PASS_COUNT
// fills a histogram in integers, so the result does not depend on the order of threads; PASS_SUM
// takes the mean of what lies between the darkest and the brightest twentieth. Black counts not.
#include "common.glsl"
#include "exposure.glsl"

layout(binding = GFX_TEX_HDR) uniform sampler2D u_hdr;

#ifdef PASS_COUNT
layout(local_size_x = 16, local_size_y = 16) in;
shared uint s_count[GFX_EXPOSURE_BINS], s_part[GFX_EXPOSURE_BINS];

void main() {
    uint i = gl_LocalInvocationIndex;
    if (i < uint(GFX_EXPOSURE_BINS)) {
        s_count[i] = s_part[i] = 0u;
    }
    barrier();
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(at, textureSize(u_hdr, 0)))) {
        float luminance = dot(texelFetch(u_hdr, at, 0).rgb, vec3(0.2126, 0.7152, 0.0722));
        float along = (log2(luminance) / GFX_EXPOSURE_RANGE * 0.5 + 0.5) * float(GFX_EXPOSURE_BINS);
        if (luminance > 0.0 && along >= 0.0) {
            uint fine = uint(min(along, float(GFX_EXPOSURE_BINS) - 0.02) * 64.0);
            atomicAdd(s_count[fine / 64u], 1u);
            atomicAdd(s_part[fine / 64u], fine % 64u);
        }
    }
    barrier();
    if (i < uint(GFX_EXPOSURE_BINS) && s_count[i] > 0u) {
        atomicAdd(u_exposure.count[i], s_count[i]);
        atomicAdd(u_exposure.part[i], s_part[i]);
    }
}
#else
layout(local_size_x = 1) in;

void main() {
    float total = 0.0;
    for (int i = 0; i < GFX_EXPOSURE_BINS; ++i) {
        total += float(u_exposure.count[i]);
    }
    float low = 0.05 * total, high = 0.95 * total, before = 0.0, sum = 0.0, weight = 0.0;
    for (int i = 0; i < GFX_EXPOSURE_BINS; ++i) {
        float n = float(u_exposure.count[i]);
        float inside = max(min(before + n, high) - max(before, low), 0.0);
        before += n;
        if (inside > 0.0) {
            float middle = float(i) + (float(u_exposure.part[i]) / n + 0.5) / 64.0;
            sum += inside * middle;
            weight += inside;
        }
        u_exposure.count[i] = u_exposure.part[i] = 0u;
    }
    if (weight > 0.0) {
        float mean = (sum / weight / float(GFX_EXPOSURE_BINS) * 2.0 - 1.0) * GFX_EXPOSURE_RANGE;
        float wanted = log2(u_view.grade.z) - mean;
        float last = u_exposure.exposure;
        u_exposure.exposure = exp2(last > 0.0 ? mix(log2(last), wanted, u_view.grade.w) : wanted);
    } else if (u_exposure.exposure <= 0.0) {
        u_exposure.exposure = 1.0;
    }
}
#endif
