// Light assignment on the GPU: one group a cell, the cell's box against every light, 64 lights at a
// time. COUNT writes the length of each list, FILL the lists in ascending order; SUM, one group,
// turns lengths into offsets in between.
#include "bindings.h"

layout(local_size_x = GFX_CLUSTER_GROUP) in;
layout(std430, binding = GFX_SSBO_CLUSTER_GRID) readonly buffer GridBlock {
    gfx_cluster_block grid;
    gfx_cluster_light_block lights[];
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
// How far the nearest corner of a cell is ahead of a point, along n. As gfx_cluster_ahead.
float ahead(vec3 lo, vec3 hi, vec3 n, vec3 from) {
    vec2 least = min(n.xy * lo.xy, n.xy * hi.xy);
    float side = least.x + least.y;
    bool perspective = grid.lens.z > 0.0;
    float rise = perspective ? side + n.z : n.z;
    return min(rise * lo.z, rise * hi.z) + (perspective ? 0.0 : side) - dot(n, from);
}

// Whether a plane parts a cell from a cone. As gfx_cluster_cone_misses.
bool coneMisses(gfx_cluster_light_block l, vec3 lo, vec3 hi) {
    vec3 centre = 0.5 * (lo + hi), axis = l.axis.xyz;
    centre.xy *= grid.lens.z > 0.0 ? centre.z : 1.0;
    vec3 way = centre - l.apex.xyz;
    float along = dot(way, axis), sine = l.apex.w, cosine = l.axis.w;
    vec3 away = way - along * axis;
    float off = length(away), size = sqrt(dot(away, away) + along * along);
    float reach = along >= size * cosine ? size : max(along * cosine + off * sine, 0.0);
    return cosine > 0.0 &&
           (ahead(lo, hi, cosine * away - sine * off * axis, l.apex.xyz) > 0.0 ||
            ahead(lo, hi, way, l.apex.xyz) > l.range.x * reach);
}

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
    float thick = grid.margin.z * (b - a);
    vec3 coneLo = vec3(lo - grid.margin.xy, max(a - thick, grid.margin.w));
    vec3 coneHi = vec3(hi + grid.margin.xy, b + thick);
    uint count = grid.size.w, found = 0u, total;
#ifdef PASS_FILL
    found = offsets[cell];
#endif
    for (uint i = 0u; i < count; i += uint(GFX_CLUSTER_GROUP)) {
        bool touches = false;
        if (i + me < count) {
            gfx_cluster_light_block l = lights[i + me];
            vec3 d = max(max(boxLo - l.sphere.xyz, l.sphere.xyz - boxHi), vec3(0.0));
            touches = dot(d, d) <= l.sphere.w * l.sphere.w && !coneMisses(l, coneLo, coneHi);
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
