// Normals of waves that run over the plane: parameter(0) seconds, parameter(1) steepness.
vec2 wave(vec2 at, vec2 along, float speed) {
    return along * cos(dot(at, along) - speed * parameter(0));
}

void surface(inout Look look) {
    vec2 at = look.position.xz;
    vec2 slope = wave(at, vec2(3.0, 1.2), 2.1) + wave(at, vec2(-1.7, 3.1), 2.6) +
                 wave(at, vec2(5.3, -4.1), 3.7);
    look.normal = normalize(vec3(-0.3 * parameter(1) * slope.x, 1.0, -0.3 * parameter(1) * slope.y));
}
