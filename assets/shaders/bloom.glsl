// The part of a radiance that scatters in the lens: what exceeds the threshold, in its own hue.
vec3 brightPart(vec3 c) {
    c = min(c, vec3(65504.0));
    float peak = max(c.r, max(c.g, c.b));
    return peak > u_view.bloom.y ? c * (1.0 - u_view.bloom.y / max(peak, 1e-20)) : vec3(0.0);
}
