// Meshes: vertices are moved into the model's space so that all meshes share one inverse bind per
// bone; a bone that two meshes bind differently gets a second, unmoving child bone. Influences are
// cut to the four largest and normalised.
#include "convert.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct mesh_ref { // one aiMesh at one node
    const struct aiMesh *mesh;
    const struct aiNode *node;
    cv_mat place; // vertices -> model space
    int rigid;    // bone that carries an unskinned mesh, -1 none
    int *bone;    // [mNumBones] bone of the skeleton for each of the mesh's
} mesh_ref;

typedef struct mesh_list {
    mesh_ref *ref;
    uint32_t count;
} mesh_list;

static uint32_t count_refs(const struct aiNode *node) {
    uint32_t n = node->mNumMeshes;
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        n += count_refs(node->mChildren[i]);
    }
    return n;
}

static void list_refs(const cv_model *m, const struct aiNode *node, mesh_list *l) {
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        l->ref[l->count++] =
            (mesh_ref){.mesh = m->scene->mMeshes[node->mMeshes[i]], .node = node, .rigid = -1};
    }
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        list_refs(m, node->mChildren[i], l);
    }
}

static int bone_named(const cv_model *m, const char *name) {
    for (uint32_t i = 0; i < m->bone_count; i++) {
        if (m->bone[i].node && strcmp(m->bone[i].node->mName.data, name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

// A second inverse bind of a bone: a child that never moves against it.
static int extra_bone(cv_model *m, int of, const cv_mat *inverse_bind) {
    for (uint32_t i = 0; i < m->bone_count; i++) {
        if (!m->bone[i].node && m->bone[i].parent == of &&
            cv_distance(&m->bone[i].inverse_bind, inverse_bind) < 1e-6) {
            return (int)i;
        }
    }
    if (m->bone_count == m->bone_capacity) {
        uint32_t capacity = m->bone_capacity * 2;
        m->bone =
            core_realloc(m->bone, m->bone_capacity * sizeof *m->bone, capacity * sizeof *m->bone);
        m->bone_capacity = capacity;
    }
    const cv_bone parent = m->bone[of];
    cv_bone *b = &m->bone[m->bone_count];
    *b = (cv_bone){.parent = of, .local = {.r = {0, 0, 0, 1}, .s = {1, 1, 1}}, .bound = true};
    snprintf(b->name, sizeof b->name, "%.100s.bind%u", parent.name, m->bone_count);
    b->model = parent.model;
    b->inverse_bind = *inverse_bind;
    cv_note_add(m, "changed", "bone \"%s\" is bound differently by two meshes: \"%s\" carries one",
                parent.name, b->name);
    return (int)m->bone_count++;
}

// Where the mesh's vertices go so that inverse_bind * place = its own offset matrix, by the first
// bone of it that is already bound, or else by the bind pose of its first bone.
static void choose_place(const cv_model *m, mesh_ref *r) {
    const struct aiMesh *mesh = r->mesh;
    for (int bound = 1; bound >= 0; bound--) {
        for (unsigned i = 0; i < mesh->mNumBones; i++) {
            const cv_bone *b = r->bone[i] < 0 ? NULL : &m->bone[r->bone[i]];
            if (!b || (bound && !b->bound)) {
                continue;
            }
            cv_mat offset = cv_from_ai(&mesh->mBones[i]->mOffsetMatrix), from = b->model;
            if ((!bound || cv_inverse(&b->inverse_bind, &from)) &&
                fabs(cv_determinant(&offset)) > 1e-20) {
                r->place = cv_mul(&from, &offset);
                return;
            }
        }
    }
    r->place = cv_node_global(m, r->node);
}

static bool bind_skin(cv_model *m, mesh_ref *r) {
    const struct aiMesh *mesh = r->mesh;
    r->bone = core_alloc((mesh->mNumBones + 1) * sizeof *r->bone);
    for (unsigned i = 0; i < mesh->mNumBones; i++) {
        r->bone[i] = bone_named(m, mesh->mBones[i]->mName.data);
        if (r->bone[i] < 0) {
            cv_note_add(m, "dropped", "mesh \"%s\": bone \"%s\" is no node of the scene",
                        mesh->mName.data, mesh->mBones[i]->mName.data);
        }
    }
    choose_place(m, r);
    cv_mat back;
    if (!cv_inverse(&r->place, &back)) {
        return cv_fail(m, "mesh \"%s\": its bind matrix is singular", mesh->mName.data);
    }
    for (unsigned i = 0; i < mesh->mNumBones; i++) {
        if (r->bone[i] < 0) {
            continue;
        }
        cv_mat offset = cv_from_ai(&mesh->mBones[i]->mOffsetMatrix);
        cv_mat inverse_bind = cv_mul(&offset, &back);
        cv_bone *b = &m->bone[r->bone[i]];
        double size = fmax(1, fabs(b->inverse_bind.m[0][0])) * 1e-4;
        if (!b->bound) {
            b->inverse_bind = inverse_bind;
            b->bound = true;
        } else if (cv_distance(&b->inverse_bind, &inverse_bind) > size) {
            r->bone[i] = extra_bone(m, r->bone[i], &inverse_bind);
        }
    }
    return true;
}

static void bind_rigid(cv_model *m, mesh_ref *r) {
    cv_mat global = cv_node_global(m, r->node), back, inverse;
    r->rigid = cv_bone_above(m, r->node);
    r->place = global;
    if (r->rigid >= 0) {
        const cv_bone *b = &m->bone[r->rigid];
        // place = inverse_bind^-1 * (bone's model)^-1 * global: equal to global in the bind pose.
        if (cv_inverse(&b->model, &back) && cv_inverse(&b->inverse_bind, &inverse)) {
            cv_mat relative = cv_mul(&back, &global);
            r->place = cv_mul(&inverse, &relative);
        }
    }
}

// Bones that no mesh binds: inverse of the bind pose.
static void bind_rest(cv_model *m) {
    for (uint32_t i = 0; i < m->bone_count; i++) {
        cv_bone *b = &m->bone[i];
        if (!b->bound && !cv_inverse(&b->model, &b->inverse_bind)) {
            cv_note_add(m, "warning", "bone \"%s\" is flat in its bind pose", b->name);
        }
        b->bound = true;
    }
}

// ---- weights ----

typedef struct influences {
    uint16_t joint[4];
    float weight[4];
    uint32_t found; // with weight > 0
    double sum, lost;
} influences;

static void add_influence(influences *v, int bone, float weight) {
    if (!(weight > 0)) {
        return; // assimp lists zero weights for unused bones
    }
    v->found++;
    v->sum += (double)weight;
    int at = 3;
    v->lost += (double)(weight < v->weight[3] ? weight : v->weight[3]);
    if (weight <= v->weight[3]) {
        return;
    }
    for (; at > 0 && v->weight[at - 1] < weight; at--) { // sorted, first come first among equals
        v->weight[at] = v->weight[at - 1];
        v->joint[at] = v->joint[at - 1];
    }
    v->weight[at] = weight;
    v->joint[at] = (uint16_t)bone;
}

static void gather(const mesh_ref *r, influences *v) {
    const struct aiMesh *mesh = r->mesh;
    for (unsigned b = 0; b < mesh->mNumBones; b++) {
        for (unsigned i = 0; r->bone[b] >= 0 && i < mesh->mBones[b]->mNumWeights; i++) {
            const struct aiVertexWeight *w = &mesh->mBones[b]->mWeights[i];
            if (w->mVertexId < mesh->mNumVertices) {
                add_influence(&v[w->mVertexId], r->bone[b], w->mWeight);
            }
        }
    }
}

static void report_weights(cv_model *m, const mesh_ref *r, const influences *v) {
    uint32_t many = 0, off = 0, none = 0, most = 0;
    double lost = 0, worst = 0;
    for (unsigned i = 0; i < r->mesh->mNumVertices; i++) {
        many += v[i].found > 4;
        most = v[i].found > most ? v[i].found : most;
        lost = fmax(lost, v[i].lost / fmax(v[i].sum, 1e-30));
        none += v[i].found == 0;
        if (v[i].found && fabs(v[i].sum - 1) > 1e-3) {
            off++;
            worst = fabs(v[i].sum - 1) > fabs(worst - 1) || worst == 0 ? v[i].sum : worst;
        }
    }
    const char *name = r->mesh->mName.data;
    if (many) {
        cv_note_add(
            m, "changed",
            "mesh \"%s\": %u vertices with up to %u influences: the 4 largest kept, at most "
            "%.2g of the weight lost",
            name, many, most, lost);
    }
    if (off) {
        cv_note_add(m, "changed", "mesh \"%s\": weights of %u vertices normalised (worst sum %.3f)",
                    name, off, worst);
    }
    if (none) {
        cv_note_add(m, "warning", "mesh \"%s\": %u vertices without weights follow its node", name,
                    none);
    }
}

static bool make_weights(cv_model *m, const mesh_ref *r, uint16_t *joint, float *weight) {
    uint32_t n = r->mesh->mNumVertices;
    influences *v = core_alloc((size_t)n * sizeof *v);
    if (r->bone) {
        gather(r, v);
        report_weights(m, r, v);
    }
    int fallback = r->rigid >= 0 ? r->rigid : cv_bone_above(m, r->node);
    fallback = fallback < 0 ? 0 : fallback;
    for (uint32_t i = 0; i < n; i++) {
        if (v[i].found == 0) {
            v[i].joint[0] = (uint16_t)fallback;
            v[i].weight[0] = 1;
        }
        double kept = 0;
        for (int k = 0; k < 4; k++) {
            kept += (double)v[i].weight[k];
        }
        for (uint32_t k = 0; k < 4; k++) {
            joint[4 * i + k] = v[i].joint[k];
            weight[4 * i + k] = (float)((double)v[i].weight[k] / kept);
        }
    }
    core_free(v);
    return true;
}

// ---- streams ----

static void transform(const cv_mat *a, const struct aiVector3D *v, double w, float *out,
                      bool unit) {
    double p[3], n = 0;
    for (int r = 0; r < 3; r++) {
        p[r] = a->m[r][0] * (double)v->x + a->m[r][1] * (double)v->y + a->m[r][2] * (double)v->z +
               a->m[r][3] * w;
        n += p[r] * p[r];
    }
    n = unit && n > 0 ? sqrt(n) : 1;
    for (int r = 0; r < 3; r++) {
        out[r] = (float)(p[r] / n);
    }
}

static void fill_geometry(const mesh_ref *r, float *position, float *normal, float *tangent,
                          float *uv, float *color) {
    const struct aiMesh *mesh = r->mesh;
    cv_mat back, turned = cv_identity(); // normals: inverse transpose
    if (cv_inverse(&r->place, &back)) {
        for (int i = 0; i < 9; i++) {
            turned.m[i / 3][i % 3] = back.m[i % 3][i / 3];
        }
    }
    double flip = cv_determinant(&r->place) < 0 ? -1 : 1;
    for (uint32_t i = 0; i < mesh->mNumVertices; i++) {
        transform(&r->place, &mesh->mVertices[i], 1, position + 3 * i, false);
        if (normal) {
            transform(&turned, &mesh->mNormals[i], 0, normal + 3 * i, true);
        }
        if (tangent) {
            transform(&r->place, &mesh->mTangents[i], 0, tangent + 4 * i, true);
            const struct aiVector3D *t = &mesh->mTangents[i], *b = &mesh->mBitangents[i],
                                    *n = &mesh->mNormals[i];
            double hand = (double)(n->y * t->z - n->z * t->y) * (double)b->x +
                          (double)(n->z * t->x - n->x * t->z) * (double)b->y +
                          (double)(n->x * t->y - n->y * t->x) * (double)b->z;
            tangent[4 * i + 3] = (float)(hand * flip < 0 ? -1 : 1);
        }
        if (uv) {
            uv[2 * i] = mesh->mTextureCoords[0][i].x;
            uv[2 * i + 1] = 1 - mesh->mTextureCoords[0][i].y; // rows of images go down
        }
        if (color) {
            memcpy(color + 4 * i, &mesh->mColors[0][i], 16);
        }
    }
}

static uint32_t fill_indices(const mesh_ref *r, uint32_t *index) {
    const struct aiMesh *mesh = r->mesh;
    bool mirrored = cv_determinant(&r->place) < 0;
    uint32_t n = 0;
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *f = &mesh->mFaces[i];
        if (f->mNumIndices == 3) {
            index[n++] = f->mIndices[0];
            index[n++] = f->mIndices[mirrored ? 2 : 1];
            index[n++] = f->mIndices[mirrored ? 1 : 2];
        }
    }
    return n;
}

static core_aabb bounds_of(const float *position, uint32_t n) {
    core_aabb box = {{position[0], position[1], position[2]},
                     {position[0], position[1], position[2]}};
    for (uint32_t i = 1; i < n; i++) {
        const float *p = position + 3 * i;
        box.min = core_v3(fminf(box.min.x, p[0]), fminf(box.min.y, p[1]), fminf(box.min.z, p[2]));
        box.max = core_v3(fmaxf(box.max.x, p[0]), fmaxf(box.max.y, p[1]), fmaxf(box.max.z, p[2]));
    }
    return box;
}

static void grow_bounds(cv_model *m, core_aabb b) {
    core_aabb *a = &m->bounds;
    if (m->vertices == 0) {
        *a = b;
    }
    a->min = core_v3(fminf(a->min.x, b.min.x), fminf(a->min.y, b.min.y), fminf(a->min.z, b.min.z));
    a->max = core_v3(fmaxf(a->max.x, b.max.x), fmaxf(a->max.y, b.max.y), fmaxf(a->max.z, b.max.z));
}

static void report_extras(cv_model *m, const struct aiMesh *mesh) {
    const char *name = mesh->mName.data;
    if (mesh->mNumAnimMeshes) {
        cv_note_add(m, "dropped", "mesh \"%s\": %u morph targets: not supported", name,
                    mesh->mNumAnimMeshes);
    }
    if (mesh->mTextureCoords[1]) {
        cv_note_add(m, "dropped", "mesh \"%s\": second set of texture coordinates", name);
    }
    if (mesh->mPrimitiveTypes & ~(unsigned)aiPrimitiveType_TRIANGLE) {
        cv_note_add(m, "dropped", "mesh \"%s\": its points and lines", name);
    }
}

static bool write_mesh(cv_model *m, const mesh_ref *r) {
    const struct aiMesh *mesh = r->mesh;
    size_t n = mesh->mNumVertices;
    bool skinned = m->bone_count > 0;
    float *position = core_alloc(n * 12 + 16);
    float *normal = mesh->mNormals ? core_alloc(n * 12 + 16) : NULL;
    float *tangent =
        mesh->mNormals && mesh->mTangents && mesh->mBitangents ? core_alloc(n * 16 + 16) : NULL;
    float *uv = mesh->mTextureCoords[0] ? core_alloc(n * 8 + 16) : NULL;
    float *color = mesh->mColors[0] ? core_alloc(n * 16 + 16) : NULL;
    uint16_t *joint = skinned ? core_alloc(n * 8 + 16) : NULL;
    float *weight = skinned ? core_alloc(n * 16 + 16) : NULL;
    uint32_t *index = core_alloc(mesh->mNumFaces * 12u + 16);
    fill_geometry(r, position, normal, tangent, uv, color);
    core_mesh_data data = {.vertex_count = mesh->mNumVertices,
                           .index_count = fill_indices(r, index),
                           .position = position,
                           .normal = normal,
                           .tangent = tangent,
                           .uv = uv,
                           .color = color,
                           .joint = joint,
                           .weight = weight,
                           .index = index};
    report_extras(m, mesh);
    bool good = !skinned || make_weights(m, r, joint, weight);
    data.bounds = bounds_of(position, data.vertex_count);
    size_t size = 0;
    void *bytes = good ? asset_mesh_encode(&data, m->bone_count, &size) : NULL;
    if (!bytes) {
        good = cv_fail(m, "mesh \"%s\": %s", mesh->mName.data, core_last_error());
    } else if (data.index_count == 0) {
        cv_note_add(m, "dropped", "mesh \"%s\": it has no triangles", mesh->mName.data);
    } else {
        asset_model_mesh *out = &m->out.mesh[m->out.mesh_count++];
        snprintf(out->path, sizeof out->path, "%s_%u.cmesh", m->name, m->out.mesh_count);
        out->material = (int32_t)mesh->mMaterialIndex;
        out->skinned = skinned;
        good = cv_write(m, out->path, bytes, size);
        grow_bounds(m, data.bounds);
        m->triangles += data.index_count / 3;
        m->vertices += n;
    }
    void *const blocks[] = {position, normal, tangent, uv, color, joint, weight, index, bytes};
    for (size_t i = 0; i < CORE_COUNT_OF(blocks); i++) {
        core_free(blocks[i]);
    }
    return good;
}

static bool bind_all(cv_model *m, mesh_list *l) {
    for (uint32_t i = 0; i < l->count; i++) {
        if (l->ref[i].mesh->mNumBones && !bind_skin(m, &l->ref[i])) {
            return false;
        }
    }
    bind_rest(m);
    for (uint32_t i = 0; i < l->count; i++) {
        if (!l->ref[i].bone) {
            bind_rigid(m, &l->ref[i]);
        }
    }
    return true;
}

bool cv_meshes_write(cv_model *m) {
    mesh_list l = {0};
    l.ref = core_alloc((count_refs(m->scene->mRootNode) + 1) * sizeof *l.ref);
    list_refs(m, m->scene->mRootNode, &l);
    m->out.mesh = core_alloc((l.count + 1) * sizeof *m->out.mesh);
    bool good = bind_all(m, &l);
    for (uint32_t i = 0; good && i < l.count; i++) {
        cv_progress(m, "meshes", i, l.count);
        good = write_mesh(m, &l.ref[i]);
    }
    for (uint32_t i = 0; i < l.count; i++) {
        core_free(l.ref[i].bone);
    }
    core_free(l.ref);
    return good;
}
