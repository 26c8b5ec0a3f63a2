// Shadow maps: cascades of suns, spots, faces of point lights, all layers of one array.
layout(std430, binding = GFX_SSBO_SHADOWS) readonly buffer ShadowBlock {
    gfx_shadow_block shadowViews[];
};
layout(binding = GFX_TEX_SHADOW) uniform sampler2DArray u_shadow; // nearest, border at infinity

#ifdef USE_SOFT_SHADOWS
const float MAX_REACH = 24.0; // texels
#endif

// The view of a light that a point falls into.
uint shadowViewOf(gfx_light_block light, vec3 position) {
    uint code = uint(light.color.w), unit = uint(GFX_SHADOW_COUNT_UNIT);
    uint first = code % unit - 1u, count = code / unit;
    if (light.position.w == 0.0) { // a sun
        float depth = viewDepth(gl_FragCoord.z);
        uint i = 0u;
        while (i + 1u < count && depth > shadowViews[first + i].depth.z) {
            ++i;
        }
        return first + i;
    }
    if (count == 1u) {
        return first;
    }
    vec3 d = position - light.position.xyz, a = abs(d); // faces +x -x +y -y +z -z
    uint face = a.x >= a.y && a.x >= a.z ? (d.x > 0.0 ? 0u : 1u)
              : a.y >= a.z               ? (d.y > 0.0 ? 2u : 3u)
                                         : (d.z > 0.0 ? 4u : 5u);
    return first + face;
}

// Metres from the light (orthographic: from the map's near end) by stored depth.
float shadowDistance(gfx_shadow_block v, float z) {
    return v.depth.y > 0.0 ? v.depth.x / max(z, 1e-9) : (1.0 - z) * v.depth.x;
}

// The receiver in a map: its coordinates there, and the plane through it. Every texel of the filter
// is compared with the plane's depth at the centre of that texel, where the map was sampled too, so
// that a plane does not shadow itself under any angle and no edge is moved.
struct Receiver {
    vec3 at;     // map coordinates, reversed depth
    vec2 slope;  // of the plane's depth by map coordinate
    float grace; // for rounding and for what is not quite plane
};

vec3 shadowCoordinates(gfx_shadow_block v, vec3 position) {
    vec4 p = v.matrix * vec4(position, 1.0);
    return p.xyz / p.w;
}

// Depth is an affine function of map coordinates on a plane, with perspective too: three points of
// it give the slope.
Receiver receiverOf(gfx_shadow_block v, Surface s, float texel) {
    vec3 n = s.flatNormal;
    vec3 side = normalize(abs(n.y) < 0.9 ? vec3(n.z, 0.0, -n.x) : vec3(0.0, -n.z, n.y));
    Receiver r;
    vec3 at = s.position + n * (u_view.lens.w * texel);
    r.at = shadowCoordinates(v, at);
    vec3 a = shadowCoordinates(v, at + side * (8.0 * texel)) - r.at;
    vec3 b = shadowCoordinates(v, at + cross(n, side) * (8.0 * texel)) - r.at;
    float area = a.x * b.y - a.y * b.x;
    r.slope = abs(area) > 1e-20
                  ? vec2(a.z * b.y - b.z * a.y, b.z * a.x - a.z * b.x) / area : vec2(0.0);
    r.grace = (abs(r.slope.x) + abs(r.slope.y)) * 0.25 / v.texel.z + r.at.z * 4e-6 + 2e-7;
#ifdef USE_TERRAIN
    // Small facets bend away within a texel: as far as slopes of neighbours differ by about a half.
    r.grace += 0.75 * texel / v.depth.x * (v.depth.y > 0.0 ? r.at.z * r.at.z : 1.0);
#endif
    return r;
}

// Centre of the texel that a point of the map falls into.
vec2 texelCentre(gfx_shadow_block v, vec2 at) { return (floor(at * v.texel.z) + 0.5) / v.texel.z; }

float storedDepth(gfx_shadow_block v, vec2 centre) {
    return textureLod(u_shadow, vec3(centre, v.depth.w), 0.0).r;
}

float receiverDepth(Receiver r, vec2 centre) { return r.at.z + dot(r.slope, centre - r.at.xy); }

float litTexel(gfx_shadow_block v, Receiver r, vec2 centre) {
    return receiverDepth(r, centre) + r.grace >= storedDepth(v, centre) ? 1.0 : 0.0;
}

// 3 x 3 texels, weighted as by two bilinear taps half a texel out on each axis.
float shadowTent(gfx_shadow_block v, Receiver r) {
    vec2 base = r.at.xy * v.texel.z - 1.0, first = floor(base), f = base - first;
    vec3 wx = vec3(1.0 - f.x, 1.0, f.x) * 0.5, wy = vec3(1.0 - f.y, 1.0, f.y) * 0.5;
    float sum = 0.0;
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 3; ++x) {
            vec2 centre = (first + vec2(x, y) + 0.5) / v.texel.z;
            sum += wx[x] * wy[y] * litTexel(v, r, centre);
        }
    }
    return sum;
}

#ifdef USE_SOFT_SHADOWS
// Points of a unit disk by the golden angle (Vogel 1979), turned by the pixel.
vec2 diskPoint(int i, int count, float turn) {
    float r = sqrt((float(i) + 0.5) / float(count)), a = float(i) * 2.39996323 + turn;
    return r * vec2(cos(a), sin(a));
}

// Interleaved gradient noise (Jimenez 2014).
float pixelTurn() {
    return 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
}

// Percentage-closer soft shadows (Fernando 2005): the mean distance of what blocks the light gives
// the width of the penumbra, in texels; 0 where nothing does. texel: metres at the receiver.
float penumbraWidth(gfx_shadow_block v, Receiver r, float texel, float turn) {
    bool parallel = v.depth.y == 0.0;
    float receiver = shadowDistance(v, r.at.z);
    // No blocker is farther away than the light, or than the map is deep.
    float widest = v.texel.w * (parallel ? receiver : 1.0) / texel;
    float search = clamp(widest, 1.0, MAX_REACH), sum = 0.0, blockers = 0.0;
    int taps = int(u_view.lens.z) / 2;
    for (int i = 0; i < taps; ++i) {
        vec2 centre = texelCentre(v, r.at.xy + diskPoint(i, taps, turn) * search / v.texel.z);
        float z = storedDepth(v, centre);
        if (z > receiverDepth(r, centre) + r.grace) {
            sum += shadowDistance(v, z);
            blockers += 1.0;
        }
    }
    if (blockers == 0.0) {
        return 0.0;
    }
    float blocker = sum / blockers, gap = max(receiver - blocker, 0.0);
    float metres = gap * v.texel.w * (parallel ? 1.0 : 1.0 / blocker);
    return clamp(metres / texel, 0.5, MAX_REACH);
}
#endif

// 1 where light reaches, 0 in full shadow.
float shadowTerm(gfx_light_block light, Surface s, vec3 l) {
    if (light.color.w == 0.0) {
        return 1.0;
    }
    if (dot(s.flatNormal, l) <= 0.0) {
#ifdef USE_TERRAIN
        return 0.0; // facets are large, and a valley's lie deep in the shadow of its side
#else
        return 1.0; // the shading normal fades the light out over small facets
#endif
    }
    gfx_shadow_block v = shadowViews[shadowViewOf(light, s.position)];
    float texel = v.texel.x;
    if (v.depth.y > 0.0) {
        vec4 p = v.matrix * vec4(s.position, 1.0);
        texel *= p.w;
    }
    Receiver r = receiverOf(v, s, texel);
#ifdef USE_SOFT_SHADOWS
    if (v.texel.w > 0.0) {
        float turn = pixelTurn(), width = penumbraWidth(v, r, texel, turn);
        if (width == 0.0) {
            return 1.0;
        }
        int taps = int(u_view.lens.z);
        float sum = 0.0;
        for (int i = 0; i < taps; ++i) {
            vec2 at = r.at.xy + diskPoint(i, taps, turn) * width / v.texel.z;
            sum += litTexel(v, r, texelCentre(v, at));
        }
        return sum / float(taps);
    }
#endif
    return shadowTent(v, r);
}
