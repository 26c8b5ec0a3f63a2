// Light assignment on the GPU: one group a cell, the cell's box against every light, 64 lights at a
// time. COUNT writes the length of each list, FILL the lists in ascending order; SUM, one group,
// turns lengths into offsets in between.
#include "bindings.h"

layout(local_size_x = GFX_CLUSTER_GROUP) in;
layout(std430, binding = GFX_SSBO_CLUSTER_GRID) readonly buffer GridBlock {
    gfx_cluster_block grid;
    vec4 sphere[]; // view space: x right, y up, depth ahead, radius
};
layout(std430, binding = GFX_SSBO_CLUSTER_OFFSETS) buffer OffsetBlock { uint offsets[]; };
layout(std430, binding = GFX_SSBO_CLUSTER_LIGHTS) buffer ListBlock { uint list[]; };

shared uint s_sum[GFX_CLUSTER_GROUP];

// Sum of all values before this thread's; total receives the sum of all.
uint exclusiveSum(uint value, out uint total) {
    uint me = gl_LocalInvocationIndex;
    s_sum[me] = value;
    barrier();
    for (uint step = 1u; step < uint(GFX_CLUSTER_GROUP); step *= 2u) {
        uint add = me >= step ? s_sum[me - step] : 0u;
        barrier();
        s_sum[me] += add;
        barrier();
    }
    total = s_sum[GFX_CLUSTER_GROUP - 1];
    uint before = s_sum[me] - value;
    barrier();
    return before;
}

#ifdef PASS_SUM
void main() {
    uint cells = grid.size.x * grid.size.y * grid.size.z, base = 0u;
    for (uint i = 0u; i < cells; i += uint(GFX_CLUSTER_GROUP)) {
        uint at = i + gl_LocalInvocationIndex, total;
        uint before = exclusiveSum(at < cells ? offsets[at] : 0u, total);
        if (at < cells) {
            offsets[at] = base + before;
        }
        base += total;
    }
    if (gl_LocalInvocationIndex == 0u) {
        offsets[cells] = base;
    }
}
#else
float sliceDepth(uint k) { return grid.depth[k / 4u][k % 4u]; }

void main() {
    uint cell = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint me = gl_LocalInvocationIndex;
    uvec3 at = uvec3(cell % grid.size.x, cell / grid.size.x % grid.size.y,
                     cell / (grid.size.x * grid.size.y));
    float a = sliceDepth(at.z), b = sliceDepth(at.z + 1u);
    vec2 lo = grid.lens.xy * (2.0 * vec2(at.xy) / vec2(grid.size.xy) - 1.0);
    vec2 hi = grid.lens.xy * (2.0 * vec2(at.xy + 1u) / vec2(grid.size.xy) - 1.0);
    float near = grid.lens.z > 0.0 ? a : 1.0, far = grid.lens.z > 0.0 ? b : 1.0;
    vec3 boxLo = vec3(min(lo * near, lo * far), a), boxHi = vec3(max(hi * near, hi * far), b);
    uint lights = grid.size.w, found = 0u, total;
#ifdef PASS_FILL
    found = offsets[cell];
#endif
    for (uint i = 0u; i < lights; i += uint(GFX_CLUSTER_GROUP)) {
        bool touches = false;
        if (i + me < lights) {
            vec4 s = sphere[i + me];
            vec3 d = max(max(boxLo - s.xyz, s.xyz - boxHi), vec3(0.0));
            touches = dot(d, d) <= s.w * s.w;
        }
        uint before = exclusiveSum(touches ? 1u : 0u, total);
#ifdef PASS_FILL
        if (touches) {
            list[found + before] = i + me;
        }
#endif
        found += total;
    }
#ifndef PASS_FILL
    if (me == 0u) {
        offsets[cell] = found;
    }
#endif
}
#endif
