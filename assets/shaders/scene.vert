// Vertices of every mesh: instance transform, optional skinning.
#include "common.glsl"

layout(location = GFX_ATTR_POSITION) in vec3 a_position;
layout(location = GFX_ATTR_NORMAL) in vec3 a_normal;
layout(location = GFX_ATTR_TANGENT) in vec4 a_tangent;
layout(location = GFX_ATTR_UV) in vec2 a_uv;
layout(location = GFX_ATTR_COLOR) in vec4 a_color;

layout(std430, binding = GFX_SSBO_INSTANCES) readonly buffer InstanceBlock {
    gfx_instance_block instances[];
};
// Instances of this view, by draw.
layout(std430, binding = GFX_SSBO_ROWS) readonly buffer RowBlock { uint rowOf[]; };
#ifdef USE_SKINNING
layout(location = GFX_ATTR_JOINT) in uvec4 a_joint;
layout(location = GFX_ATTR_WEIGHT) in vec4 a_weight;
layout(std430, binding = GFX_SSBO_BONES) readonly buffer BoneBlock { vec4 boneRows[]; };
#endif

#ifdef USE_INSTANCING
#define INSTANCE uint(gl_BaseInstanceARB + gl_InstanceID)
#else
layout(location = GFX_U_INSTANCE) uniform uint u_instance;
#define INSTANCE u_instance
#endif

// The depth prepass and the shading pass must land on the same depth bits (GL_EQUAL).
invariant gl_Position;

#if !defined(DEPTH_ONLY) || defined(USE_ALPHA_MASK)
#define WITH_MATERIAL
out vec4 v_color;
// Read once a vertex, not once a fragment.
flat out gfx_material_block v_material;
layout(std430, binding = GFX_SSBO_MATERIALS) readonly buffer MaterialBlock {
    gfx_material_block materials[];
};
#ifdef USE_TEXTURES
out vec2 v_uv;
#endif
#endif
#ifndef DEPTH_ONLY
out vec3 v_world;
out vec3 v_normal;
#ifdef USE_TEXTURES
out vec4 v_tangent; // zero when the mesh has none
#endif
#endif

mat3x4 rowsOf(gfx_instance_block instance) {
    return mat3x4(instance.row0, instance.row1, instance.row2);
}

#ifdef USE_SKINNING
// Linear blend skinning: the weighted sum of the bones' 3x4 matrices (bind inverse included).
mat3x4 skinRows(uint first) {
    mat3x4 rows = mat3x4(0.0);
    for (int i = 0; i < 4; ++i) {
        uint at = (first + a_joint[i]) * 3u;
        rows += a_weight[i] * mat3x4(boneRows[at], boneRows[at + 1u], boneRows[at + 2u]);
    }
    return rows;
}
#endif

// -1 where a transform mirrors.
float handedness(mat3x4 rows) {
    return dot(cross(rows[0].xyz, rows[1].xyz), rows[2].xyz) < 0.0 ? -1.0 : 1.0;
}

// Normals go with the cofactors of the matrix, right under any scale; mirroring turns them inside
// out.
vec3 transformNormal(mat3x4 rows, vec3 n) {
    vec3 a = rows[0].xyz, b = rows[1].xyz, c = rows[2].xyz;
    return vec3(dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n));
}

void main() {
    gfx_instance_block instance = instances[rowOf[INSTANCE]];
    mat3x4 world = rowsOf(instance);
    vec4 position = vec4(a_position, 1.0);
#ifdef USE_SKINNING
    mat3x4 skin = skinRows(instance.index.y);
    position = vec4(position * skin, 1.0);
#endif
    vec3 p = position * world;
    gl_Position = u_view.view_proj * vec4(p, 1.0);
#ifdef WITH_MATERIAL
#ifdef USE_TEXTURES
    v_uv = a_uv;
#endif
    v_color = a_color * instance.color;
    v_material = materials[instance.index.x];
#endif
#ifndef DEPTH_ONLY
    vec3 normal = a_normal;
#ifdef USE_SKINNING
    normal = transformNormal(skin, normal);
#endif
    v_world = p;
    float hand = handedness(world);
    v_normal = transformNormal(world, normal) * hand;
#ifdef USE_TEXTURES
    vec3 tangent = a_tangent.xyz;
#ifdef USE_SKINNING
    tangent = vec4(tangent, 0.0) * skin;
#endif
    v_tangent = vec4(vec4(tangent, 0.0) * world, a_tangent.w * hand);
#endif
#endif
}
