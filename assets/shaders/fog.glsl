// Fog whose density falls exponentially with height: density * exp(-falloff * (y - base)). Its
// depth along a ray has a closed form (Wenzel 2006, "Real-time atmospheric effects in games").

float fogDensity(float y) {
    return u_view.fog.x * exp(min(-u_view.fog.y * (y - u_view.fog.z), 80.0));
}

// Part of the light that passes from `from` to a point `d` away.
float fogPasses(vec3 from, vec3 d) {
    float fall = u_view.fog.y * d.y;
    // (1 - exp(-x)) / x, by its series where the difference would cancel.
    float mean = abs(fall) > 1e-3 ? (1.0 - exp(min(-fall, 80.0))) / fall
                                  : 1.0 - fall * (0.5 - fall / 6.0);
    return exp(-fogDensity(from.y) * length(d) * mean);
}

// The same without end along a unit direction.
float fogPassesForever(vec3 from, vec3 d) {
    float fall = u_view.fog.y * d.y;
    return fall > 1e-6 ? exp(-fogDensity(from.y) / fall) : 0.0;
}
