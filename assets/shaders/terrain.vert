// Vertices of terrain: a tile's grid, laid over the field of heights and turned into the grid of the
// next level with the distance from the eye (Strugar 2009).
#include "common.glsl"
#include "terrain.glsl"

layout(std430, binding = GFX_SSBO_QUADS) readonly buffer TileBlock { uvec4 tiles[]; };
layout(binding = GFX_TEX_TERRAIN_HEIGHT) uniform sampler2D u_height;
layout(location = GFX_U_INSTANCE) uniform uint u_first;

// The depth prepass and the shading pass must land on the same depth bits (GL_EQUAL).
invariant gl_Position;

#ifndef DEPTH_ONLY
out vec4 v_color;
flat out gfx_material_block v_material;
out vec3 v_world;
out vec3 v_normal;
#endif

vec3 pointAt(ivec2 at) {
    at = min(at, ivec2(u_terrain.grid.zw));
    float y = texelFetch(u_height, at, 0).r;
    return u_terrain.origin.xyz + vec3(vec2(at) * u_terrain.grid.xy, y).xzy;
}

void main() {
    uvec4 tile = tiles[u_first + uint(gl_InstanceID)];
    ivec2 corner = ivec2(tile.xy);
    ivec2 id = ivec2(gl_VertexID % (GFX_TERRAIN_TILE + 1), gl_VertexID / (GFX_TERRAIN_TILE + 1));
    int level = int(tile.z);
    vec3 fine = pointAt(corner + (id << level));
    vec3 coarse = pointAt(corner + ((id & ~1) << level));
    vec2 morph = u_terrain.morph[level].xy;
    float turn = clamp((distance(fine, u_terrain.eye.xyz) - morph.x) * morph.y, 0.0, 1.0);
    vec3 p = mix(fine, coarse, turn);
    gl_Position = u_view.view_proj * vec4(p, 1.0);
#ifndef DEPTH_ONLY
    v_world = p;
    v_normal = vec3(0.0, 1.0, 0.0);
    v_color = vec4(1.0);
    v_material.base_color = vec4(1.0);
    v_material.emissive_metallic = vec4(0.0);
    v_material.params = vec4(u_terrain.low.w, 1.0, 1.0, 0.0);
#endif
}
