// Ground-truth ambient occlusion (Jimenez, Wu, Pesce, Jarabo 2016): the cosine-weighted part of the
// half sphere that is open within a radius, from horizons of the depth buffer in a few slices
// through the view direction. Slices turn and steps shift over 4 x 4 pixels; ao_smooth.frag gathers.
#include "common.glsl"
#include "ao.glsl"

layout(location = 0) out float o_visibility;

// Of the two neighbours along an axis the one that lies on the same surface: the nearer in depth.
vec3 slope(ivec2 at, ivec2 step, vec3 p) {
    vec3 a = p - viewPosition(at - step), b = viewPosition(at + step) - p;
    bool first = any(lessThan(at - step, ivec2(0)));
    bool last = any(greaterThanEqual(at + step, ivec2(u_view.viewport.xy)));
    return last || (!first && abs(a.z) < abs(b.z)) ? a : b;
}

float pixelsPerMetre(float depth) {
    float scale = 0.5 * u_view.viewport.y / u_view.lens.y;
    return u_view.camera.w > 0.0 ? scale / depth : scale;
}

// Cosine of the horizon along `along` (pixels to the radius), at least `low`.
float horizon(vec3 p, vec3 v, vec3 normal, vec2 along, float low, float shift) {
    float steps = u_view.ao.w, radius = u_view.ao.y, found = low;
    for (float i = 0.0; i < steps; i += 1.0) {
        float s = (i + shift) / steps;
        vec2 offset = along * (s * s); // near occluders count most
        // A pixel away at least: the difference of a point from itself need not be zero.
        offset = sign(offset) * max(abs(offset), normalize(abs(along)));
        ivec2 at = ivec2(floor(gl_FragCoord.xy + offset));
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(u_view.viewport.xy)))) {
            continue;
        }
        float depth = texelFetch(u_depth, at, 0).r;
        if (depth <= 0.0) {
            continue;
        }
        vec3 d = viewPosition(at) - p;
        float far = length(d);
        // Texels lie a little beside the slice: only what rises above the surface can occlude it.
        if (dot(d, normal) <= 0.01 * far) {
            continue;
        }
        // What leaves the radius fades from 0.75 of it on, and no step shows at its end.
        float weight = clamp((radius - far) / (0.25 * radius), 0.0, 1.0);
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
    float shift = 0.125 + 0.25 * float((at.y - at.x) & 3), seen = 0.0, open = 0.0;
    vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), v)), up = cross(v, right);
    for (float i = 0.0; i < u_view.ao.z; i += 1.0) {
        float angle = (i + turn) * 3.14159265 / u_view.ao.z;
        vec3 tangent = cos(angle) * right + sin(angle) * up; // of the slice, across the view
        vec2 w = u_view.camera.w > 0.0 ? tangent.xy - tangent.z * p.xy / p.z : tangent.xy;
        vec3 across = cross(tangent, v);
        vec3 within = normal - across * dot(normal, across);
        float size = max(length(within), 1e-5);
        float cosN = clamp(dot(within, v) / size, -1.0, 1.0);
        float n = sign(dot(tangent, within)) * acos(cosN);
        w = normalize(w) * reach;
        float h1 = acos(horizon(p, v, normal, w, cos(n + 1.57079633), shift));
        float h0 = -acos(horizon(p, v, normal, -w, cos(n - 1.57079633), shift));
        h1 = min(h1, n + 1.57079633);
        h0 = max(h0, n - 1.57079633);
        seen += size * 0.25 * (arc(h0, n, cosN) + arc(h1, n, cosN));
        open += size * (cosN + n * sin(n)); // the same without any horizon
    }
    return clamp(seen / open, 0.0, 1.0);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    o_visibility = 1.0;
    if (texelFetch(u_depth, at, 0).r > 0.0) {
        o_visibility = visibilityOf(at, viewPosition(at));
    }
}
