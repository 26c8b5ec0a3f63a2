// Ground-truth ambient occlusion (Jimenez, Wu, Pesce, Jarabo 2016): the cosine-weighted part of the
// half sphere that is open within a radius, from horizons of the depth buffer in a few slices
// through the view direction. Slices turn and steps shift over 4 x 4 pixels; ao_smooth.frag gathers.
#include "common.glsl"
#include "ao.glsl"

layout(location = 0) out float o_visibility;

// Of the two neighbours along an axis the one that lies on the same surface: the nearer in depth.
vec3 slope(ivec2 at, ivec2 step, vec3 p) {
    vec3 a = p - viewPosition(at - step), b = viewPosition(at + step) - p;
    return abs(a.z) < abs(b.z) ? a : b;
}

float pixelsPerMetre(float depth) {
    float scale = 0.5 * u_view.viewport.y / u_view.lens.y;
    return u_view.camera.w > 0.0 ? scale / depth : scale;
}

// Cosine of the horizon along `along` (pixels to the radius), at least `low`.
float horizon(vec3 p, vec3 v, vec2 along, float low, float shift) {
    float steps = u_view.ao.w, radius = u_view.ao.y, found = low;
    for (float i = 0.0; i < steps; i += 1.0) {
        float s = (i + shift) / steps;
        vec2 offset = along * (s * s); // near occluders count most
        ivec2 at = ivec2(gl_FragCoord.xy + sign(offset) * max(abs(offset), normalize(abs(along))));
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(u_view.viewport.xy)))) {
            continue;
        }
        float depth = texelFetch(u_depth, at, 0).r;
        if (depth <= 0.0) {
            continue;
        }
        vec3 d = viewPosition(at) - p;
        float far = length(d);
        // What leaves the radius fades from 0.6 of it on, and no step shows at its end.
        float weight = clamp((radius - far) / (0.4 * radius), 0.0, 1.0);
        found = max(found, mix(low, dot(d, v) / max(far, 1e-6), weight));
    }
    return found;
}

// Visibility of one slice: integral of the cosine between two horizons about the normal's angle n.
float arc(float h, float n, float cosN) { return cosN + 2.0 * h * sin(n) - cos(2.0 * h - n); }

float visibilityOf(ivec2 at, vec3 p) {
    vec3 v = u_view.camera.w > 0.0 ? -normalize(p) : vec3(0.0, 0.0, 1.0);
    vec3 normal = normalize(cross(slope(at, ivec2(1, 0), p), slope(at, ivec2(0, 1), p)));
    float reach = u_view.ao.y * pixelsPerMetre(-p.z);
    reach = min(reach, 0.25 * u_view.viewport.y); // very near surfaces: bounded cost
    if (reach < 1.5) {
        return 1.0;
    }
    float turn = float(((at.x + at.y) & 3) * 4 + (at.x & 3)) / 16.0;
    float shift = 0.125 + 0.25 * float((at.y - at.x) & 3), sum = 0.0;
    for (float i = 0.0; i < u_view.ao.z; i += 1.0) {
        float angle = (i + turn) * 3.14159265 / u_view.ao.z;
        vec2 w = vec2(cos(angle), sin(angle));
        vec3 across = normalize(cross(vec3(w, 0.0), v));
        vec3 flat_ = normal - across * dot(normal, across); // the normal within the slice
        float size = max(length(flat_), 1e-5);
        float cosN = clamp(dot(flat_, v) / size, -1.0, 1.0);
        vec3 tangent = vec3(w, 0.0) - v * dot(vec3(w, 0.0), v);
        float n = sign(dot(tangent, flat_)) * acos(cosN);
        float right = acos(horizon(p, v, w * reach, cos(n + 1.57079633), shift));
        float left = -acos(horizon(p, v, -w * reach, cos(n - 1.57079633), shift));
        right = n + clamp(right - n, -1.57079633, 1.57079633);
        left = n + clamp(left - n, -1.57079633, 1.57079633);
        sum += size * 0.25 * (arc(left, n, cosN) + arc(right, n, cosN));
    }
    return clamp(sum / u_view.ao.z, 0.0, 1.0);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    o_visibility = 1.0;
    if (texelFetch(u_depth, at, 0).r > 0.0) {
        o_visibility = visibilityOf(at, viewPosition(at));
    }
}
