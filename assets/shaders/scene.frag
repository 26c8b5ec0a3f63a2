// Shading of every mesh: direct light, ambient light, emission. Linear radiance out; alpha is
// coverage, and the radiance of blended surfaces is premultiplied by it.
#include "material.glsl"
#include "brdf.glsl"
#include "lights.glsl"
#include "ambient.glsl"
#ifdef USE_DEBUG
#include "debug.glsl"
#endif
#ifdef USE_FOG
#include "fog.glsl"
#endif
#ifdef USE_TERRAIN
#include "ground.glsl"
#endif
#ifdef USE_AO
layout(binding = GFX_TEX_AO) uniform sampler2D u_ao;
#endif

in vec3 v_world;
in vec3 v_normal;
#ifdef USE_TEXTURES
in vec4 v_tangent;
#endif
layout(location = 0) out vec4 o_color;

#ifdef USE_TEXTURES
// Tangent frame of the mesh, or from the derivatives of position and texture coordinate where the
// mesh has none (Schueler, "Normal mapping without precomputed tangents", 2013).
mat3 tangentFrame(vec3 n) {
    vec3 t = v_tangent.xyz, b;
    if (dot(t, t) > 1e-8) {
        t = normalize(t - n * dot(n, t));
        return mat3(t, cross(n, t) * v_tangent.w, n);
    }
    vec3 px = dFdx(v_world), py = dFdy(v_world);
    vec2 ux = dFdx(v_uv), uy = dFdy(v_uv);
    vec3 a = cross(py, n), c = cross(n, px);
    t = a * ux.x + c * uy.x;
    b = a * ux.y + c * uy.y;
    float scale = inversesqrt(max(max(dot(t, t), dot(b, b)), 1e-20));
    return mat3(t * scale, b * scale, n);
}
#endif

vec3 shadingNormal(gfx_material_block m) {
#ifdef USE_TERRAIN
    vec3 n = groundNormal(v_world);
#else
    vec3 n = normalize(v_normal);
#endif
#ifdef USE_TEXTURES
    vec3 texel = texture(u_normal, v_uv).xyz * (255.0 / 127.0) - 128.0 / 127.0;
    texel.xy *= m.params.y;
    n = normalize(tangentFrame(n) * texel);
#endif
    return gl_FrontFacing ? n : -n;
}

#ifdef USE_HOOK
// A material that a script wrote: its file defines void surface(inout Look look), which changes what
// the factors and maps gave. Linear colours, metres, the world's axes.
struct Look {
    vec3 baseColor;
    float alpha;
    float metallic, roughness;
    vec3 emission;
    vec3 normal;   // unit, towards the viewer's side
    vec3 position; // of the fragment; to read
    vec2 uv;
};
layout(location = GFX_U_PARAMETERS) uniform vec4 u_parameters[GFX_PARAMETERS / 4];
float parameter(int i) { return u_parameters[i / 4][i % 4]; }
#include "HOOK"
#endif

Surface surfaceOf(gfx_material_block m, inout vec4 base, inout vec3 emission) {
    Surface s;
    float metallic = m.emissive_metallic.w, roughness = m.params.x;
#ifdef USE_TEXTURES
    vec4 maps = texture(u_metallicRoughness, v_uv);
    metallic *= maps.b;
    roughness *= maps.g;
#endif
    s.position = v_world;
    s.view = viewDirection(v_world);
    s.normal = shadingNormal(m);
#ifdef USE_HOOK
    Look look = Look(base.rgb, base.a, metallic, roughness, emission, s.normal, v_world, v_uv);
    surface(look);
    base = vec4(look.baseColor, clamp(look.alpha, 0.0, 1.0));
    emission = look.emission;
    metallic = clamp(look.metallic, 0.0, 1.0);
    roughness = clamp(look.roughness, 0.0, 1.0);
    s.normal = normalize(look.normal);
#endif
#ifdef USE_SHADOWS
    s.flatNormal = normalize(cross(dFdx(v_world), dFdy(v_world)));
    s.flatNormal *= dot(s.flatNormal, s.view) < 0.0 ? -1.0 : 1.0;
#endif
    s.noV = clamp(dot(s.normal, s.view), 1e-4, 1.0);
    setMaterial(s, base.rgb, metallic, roughness);
    return s;
}

void main() {
    gfx_material_block m = v_material;
#ifdef USE_TERRAIN
    vec4 base = groundColor(v_world);
#else
    vec4 base = baseColor(m);
#endif
#ifdef USE_ALPHA_MASK
    if (base.a < m.params.w) {
        discard;
    }
    base.a = 1.0;
#endif
    vec3 emission = m.emissive_metallic.rgb;
#ifdef USE_TEXTURES
    emission *= texture(u_emissive, v_uv).rgb;
#endif
    Surface s = surfaceOf(m, base, emission);
#ifdef USE_DEBUG
    o_color = vec4(debugColor(s), 1.0);
    return;
#endif
    float ambient = 1.0;
#ifdef USE_TEXTURES
    ambient = 1.0 + m.params.z * (texture(u_occlusion, v_uv).r - 1.0);
#endif
#ifdef USE_AO
    ambient = min(ambient, texelFetch(u_ao, ivec2(gl_FragCoord.xy), 0).r);
#endif
    vec3 radiance = directLight(s) + ambientLight(s) * ambient + emission;
#ifdef USE_FOG
    vec3 eye = u_view.camera.w > 0.0 ? u_view.camera.xyz
                                     : v_world + s.view * viewDepth(gl_FragCoord.z);
    float passes = fogPasses(eye, v_world - eye);
    radiance = radiance * passes + u_view.fog_color.rgb * (1.0 - passes);
#endif
#ifdef USE_BLEND
    o_color = vec4(radiance * base.a, base.a);
#else
    o_color = vec4(radiance, 1.0);
#endif
}
