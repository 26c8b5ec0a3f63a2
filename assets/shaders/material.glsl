// Material of a fragment: factors times maps, with the meaning of glTF 2.0.
#include "common.glsl"

in vec4 v_color;
flat in gfx_material_block v_material;
#ifdef USE_TEXTURES
in vec2 v_uv;
layout(binding = GFX_TEX_BASE_COLOR) uniform sampler2D u_baseColor;
layout(binding = GFX_TEX_NORMAL) uniform sampler2D u_normal;
layout(binding = GFX_TEX_METALLIC_ROUGHNESS) uniform sampler2D u_metallicRoughness;
layout(binding = GFX_TEX_OCCLUSION) uniform sampler2D u_occlusion;
layout(binding = GFX_TEX_EMISSIVE) uniform sampler2D u_emissive;
#endif

vec4 baseColor(gfx_material_block m) {
    vec4 c = m.base_color * v_color;
#ifdef USE_TEXTURES
    c *= texture(u_baseColor, v_uv);
#endif
    return c;
}
