// Shading of every mesh: direct light, ambient hemisphere, emission. Linear radiance out.
#include "common.glsl"
#include "brdf.glsl"
#include "lights.glsl"

in vec3 v_world;
in vec3 v_normal;
in vec2 v_uv;
in vec4 v_color;
flat in uint v_material;
layout(location = 0) out vec4 o_color;

layout(std430, binding = GFX_SSBO_MATERIALS) readonly buffer MaterialBlock {
    gfx_material_block materials[];
};

Surface surfaceOf(gfx_material_block m, vec4 base) {
    Surface s;
    s.position = v_world;
    s.view = viewDirection(v_world);
    s.normal = normalize(gl_FrontFacing ? v_normal : -v_normal);
    s.flatNormal = normalize(cross(dFdx(v_world), dFdy(v_world)));
    s.flatNormal *= dot(s.flatNormal, s.view) < 0.0 ? -1.0 : 1.0;
    s.noV = clamp(dot(s.normal, s.view), 1e-4, 1.0);
    setMaterial(s, base.rgb, m.emissive_metallic.w, m.params.x);
    return s;
}

// Hemisphere ambient: sky above, ground below; the specular lobe sees the half sphere round the
// mirrored view, the sharper the smoother.
vec3 ambientLight(Surface s) {
    vec3 sky = u_view.ambient_sky.rgb, ground = u_view.ambient_ground.rgb;
    vec3 irradiance = mix(ground, sky, 0.5 + 0.5 * s.normal.y);
    float up = reflect(-s.view, s.normal).y;
    vec3 mirror = mix(ground, sky, clamp(0.5 + mix(4.0, 0.5, s.alpha) * up, 0.0, 1.0));
    return s.diffuse * irradiance + s.specular * mirror;
}

void main() {
    gfx_material_block m = materials[v_material];
    vec4 base = m.base_color * v_color;
    Surface s = surfaceOf(m, base);
    o_color = vec4(directLight(s) + ambientLight(s) + m.emissive_metallic.rgb, base.a);
}
