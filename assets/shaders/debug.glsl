// Pictures of what the renderer does, in place of light.

// Blue over green and yellow to red for 0..1, white beyond.
vec3 heat(float x) {
    vec3 c = clamp(vec3(4.0 * x - 1.5, min(4.0 * x, 3.5 - 4.0 * x), 1.5 - 4.0 * abs(x - 0.25)), 0.0,
                   1.0);
    return x > 1.0 ? vec3(1.0) : c;
}

vec3 debugColor(Surface s) {
    uint view = u_view.light_count.w;
    if (view == uint(GFX_DEBUG_NORMALS)) {
        return 0.5 + 0.5 * s.normal;
    }
    if (view == uint(GFX_DEBUG_DEPTH)) { // a band of grey for each doubling of the distance
        return vec3(fract(log2(viewDepth(gl_FragCoord.z)) * 0.5));
    }
    if (view == uint(GFX_DEBUG_OVERDRAW)) {
        return vec3(0.1, 0.04, 0.01);
    }
#ifdef USE_CLUSTERED_RENDERING
    uint cell = clusterCell();
    if (view == uint(GFX_DEBUG_LIGHTS)) {
        uint first = clusterOffset[cell], end = clusterOffset[cell + 1u] & ~GFX_CLUSTER_ALL;
        return (first & GFX_CLUSTER_ALL) != 0u ? vec3(1.0, 0.0, 1.0) : heat(float(end - first) / 32.0);
    }
    uint h = cell * 2654435761u; // a colour of its own for each cell
    return vec3(h >> 8 & 255u, h >> 16 & 255u, h >> 24) / 255.0;
#else
    return heat(float(u_view.light_count.y) / 32.0);
#endif
}
