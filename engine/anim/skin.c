#include "anim/anim_internal.h"

static core_vec3 transform(const float *m, core_vec3 p, float w) {
    return (core_vec3){m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3] * w,
                       m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7] * w,
                       m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11] * w};
}

static void blend_matrix(const core_mesh_data *mesh, uint32_t v, const float *palette,
                         float out[12]) {
    for (int i = 0; i < 12; i++) {
        out[i] = 0;
    }
    for (int k = 0; k < 4; k++) {
        float weight = mesh->weight[4 * v + (uint32_t)k];
        const float *m = palette + 12 * (size_t)mesh->joint[4 * v + (uint32_t)k];
        for (int i = 0; i < 12; i++) {
            out[i] += weight * m[i];
        }
    }
}

bool anim_skin(const core_mesh_data *mesh, const float *palette, uint32_t bone_count,
               float *position, float *normal) {
    if (!mesh->joint || !mesh->weight) {
        return core_fail("anim_skin: the mesh has no bone indices or weights");
    }
    for (uint32_t i = 0; i < mesh->vertex_count * 4; i++) {
        if (mesh->joint[i] >= bone_count) {
            return core_fail("anim_skin: vertex %u uses bone %u of %u", i / 4, mesh->joint[i],
                             bone_count);
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        float m[12];
        blend_matrix(mesh, v, palette, m);
        const float *p = mesh->position + 3 * v;
        core_vec3 out = transform(m, core_v3(p[0], p[1], p[2]), 1);
        position[3 * v] = out.x;
        position[3 * v + 1] = out.y;
        position[3 * v + 2] = out.z;
        if (normal && mesh->normal) {
            const float *n = mesh->normal + 3 * v;
            core_vec3 unit = core_v3_normalize(transform(m, core_v3(n[0], n[1], n[2]), 0),
                                               core_v3(n[0], n[1], n[2]));
            normal[3 * v] = unit.x;
            normal[3 * v + 1] = unit.y;
            normal[3 * v + 2] = unit.z;
        }
    }
    return true;
}
