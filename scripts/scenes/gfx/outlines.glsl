// Lines of strength parameter(0) where the distance bends: its second difference over a pixel.
vec3 effect(vec2 uv) {
    vec2 step = 1.0 / size();
    float here = min(depth(uv), 1000.0), bend = 0.0;
    for (int i = 0; i < 4; ++i) {
        vec2 off = vec2(i < 2 ? 1.0 : -1.0, i % 2 == 0 ? 1.0 : -1.0) * step;
        bend += min(depth(uv + off), 1000.0) - here;
    }
    return picture(uv) * (1.0 - parameter(0) * smoothstep(0.03, 0.12, abs(bend) / here));
}
