// Bones: nodes that skin a mesh or are animated, with all their ancestors, so that the root's own
// rotation and unit scale are kept. Pivot nodes that assimp makes of FBX files are folded into the
// node they belong to.
#include "convert.h"

#include "asset/bytes.h"

#include <stdio.h>
#include <string.h>

bool cv_is_helper(const struct aiNode *node) {
    return strstr(node->mName.data, "_$AssimpFbx$_") != NULL;
}

static const struct aiNode *real_parent(const struct aiNode *node) {
    const struct aiNode *p = node->mParent;
    while (p && cv_is_helper(p)) {
        p = p->mParent;
    }
    return p;
}

int cv_bone_of_node(const cv_model *m, const struct aiNode *node) {
    for (uint32_t i = 0; i < m->bone_count; i++) {
        if (m->bone[i].node == node && node) {
            return (int)i;
        }
    }
    return -1;
}

int cv_bone_above(const cv_model *m, const struct aiNode *node) {
    int bone = -1;
    for (; node && bone < 0; node = node->mParent) {
        bone = cv_bone_of_node(m, node);
    }
    return bone;
}

// Transform of the node with its pivots, relative to the nearest real ancestor.
static cv_mat folded_local(const struct aiNode *node) {
    cv_mat local = cv_from_ai(&node->mTransformation);
    for (const struct aiNode *p = node->mParent; p && cv_is_helper(p); p = p->mParent) {
        cv_mat pivot = cv_from_ai(&p->mTransformation);
        local = cv_mul(&pivot, &local);
    }
    return local;
}

cv_mat cv_node_global(const cv_model *m, const struct aiNode *node) {
    cv_mat global = cv_identity();
    for (; node; node = node->mParent) {
        cv_mat local = cv_from_ai(&node->mTransformation);
        global = cv_mul(&local, &global);
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 4; c++) {
            global.m[r][c] *= m->scale;
        }
    }
    return global;
}

static uint32_t count_nodes(const struct aiNode *node) {
    uint32_t n = 1;
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        n += count_nodes(node->mChildren[i]);
    }
    return n;
}

// Fills order[] with nodes, parents first, in the file's order.
static uint32_t list_nodes(const struct aiNode *node, const struct aiNode **order, uint32_t n) {
    order[n++] = node;
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        n = list_nodes(node->mChildren[i], order, n);
    }
    return n;
}

static bool skins_a_mesh(const struct aiScene *scene, const struct aiNode *node) {
    for (unsigned i = 0; i < scene->mNumMeshes; i++) {
        for (unsigned b = 0; b < scene->mMeshes[i]->mNumBones; b++) {
            if (strcmp(scene->mMeshes[i]->mBones[b]->mName.data, node->mName.data) == 0) {
                return true;
            }
        }
    }
    return false;
}

static bool is_animated(const cv_model *m, const struct aiNode *node) {
    for (uint32_t c = 0; c < m->clip_count; c++) {
        for (uint32_t i = 0; i < m->clip[c].channel_count; i++) {
            const struct aiNode *target = m->clip[c].channel[i].node;
            while (target && cv_is_helper(target)) { // a pivot moves the node below it
                target = target->mNumChildren ? target->mChildren[0] : NULL;
            }
            if (target == node) {
                return true;
            }
        }
    }
    return false;
}

static bool name_taken(const void *ctx, const char *name) {
    const cv_model *m = ctx;
    for (uint32_t i = 0; i < m->bone_count; i++) {
        if (strcmp(m->bone[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

static void add_bone(cv_model *m, const struct aiNode *node) {
    cv_bone *b = &m->bone[m->bone_count];
    memset(b, 0, sizeof *b);
    snprintf(b->name, sizeof b->name, "%.127s", node->mName.length ? node->mName.data : "bone");
    cv_unique_name(b->name, sizeof b->name, name_taken, m);
    if (node->mName.length && strncmp(b->name, node->mName.data, CORE_NAME_MAX - 1) != 0) {
        cv_note_add(m, "changed", "bone \"%s\" is there more than once: this one is now \"%s\"",
                    node->mName.data, b->name);
    }
    b->node = node;
    const struct aiNode *parent = real_parent(node);
    b->parent = parent ? cv_bone_of_node(m, parent) : -1;
    cv_mat local = folded_local(node);
    double shear;
    b->local = cv_decompose(&local, &shear);
    if (shear > 1e-3) {
        cv_note_add(m, "warning", "bone \"%s\": its bind transform has shear (%.3g), which is lost",
                    b->name, shear);
    }
    if (b->parent < 0) { // the unit of the file
        for (int i = 0; i < 3; i++) {
            b->local.t[i] *= m->scale;
            b->local.s[i] *= m->scale;
        }
    }
    cv_mat trs = cv_compose(&b->local);
    b->model = b->parent < 0 ? trs : cv_mul(&m->bone[b->parent].model, &trs);
    m->bone_count++;
}

bool cv_skeleton_make(cv_model *m) {
    uint32_t nodes = count_nodes(m->scene->mRootNode);
    const struct aiNode **order = core_alloc(nodes * sizeof(void *));
    bool *wanted = core_alloc(nodes * sizeof *wanted);
    list_nodes(m->scene->mRootNode, order, 0);
    uint32_t count = 0;
    for (uint32_t i = nodes; i > 0; i--) { // children come after parents: mark upwards
        const struct aiNode *node = order[i - 1];
        wanted[i - 1] = wanted[i - 1] || skins_a_mesh(m->scene, node) || is_animated(m, node);
        for (uint32_t p = 0; wanted[i - 1] && p < i - 1; p++) {
            wanted[p] = wanted[p] || order[p] == node->mParent;
        }
        count += wanted[i - 1];
    }
    m->bone_capacity = count * 2 + 1;
    m->bone = core_alloc(m->bone_capacity * sizeof *m->bone);
    uint32_t helpers = 0;
    for (uint32_t i = 0; i < nodes; i++) {
        if (wanted[i] && cv_is_helper(order[i])) {
            helpers++;
        } else if (wanted[i]) {
            add_bone(m, order[i]);
        }
    }
    if (helpers) {
        cv_note_add(m, "changed", "%u FBX pivot nodes were folded into their bones", helpers);
    }
    core_free(order);
    core_free(wanted);
    return m->bone_count <= ASSET_MAX_BONES ||
           cv_fail(m, "%u bones, at most %u", m->bone_count, ASSET_MAX_BONES);
}

core_skeleton_data *cv_skeleton_data(const cv_model *m) {
    size_t n = m->bone_count;
    asset_block block =
        asset_block_make(asset_round(sizeof(core_skeleton_data)) + asset_round(n * CORE_NAME_MAX) +
                         asset_round(n * 4) + 2 * asset_round(n * sizeof(core_vec3)) +
                         asset_round(n * sizeof(core_quat)) + asset_round(n * sizeof(core_mat4)));
    core_skeleton_data *data = asset_block_take(&block, sizeof *data);
    char(*name)[CORE_NAME_MAX] = asset_block_take(&block, n * sizeof *name);
    int32_t *parent = asset_block_take(&block, n * sizeof *parent);
    core_vec3 *t = asset_block_take(&block, n * sizeof *t);
    core_vec3 *s = asset_block_take(&block, n * sizeof *s);
    core_quat *r = asset_block_take(&block, n * sizeof *r);
    core_mat4 *inverse = asset_block_take(&block, n * sizeof *inverse);
    for (size_t b = 0; b < n; b++) {
        const cv_bone *bone = &m->bone[b];
        const cv_trs *p = &bone->local;
        memcpy(name[b], bone->name, CORE_NAME_MAX);
        parent[b] = bone->parent;
        t[b] = core_v3((float)p->t[0], (float)p->t[1], (float)p->t[2]);
        r[b] = (core_quat){(float)p->r[0], (float)p->r[1], (float)p->r[2], (float)p->r[3]};
        s[b] = core_v3((float)p->s[0], (float)p->s[1], (float)p->s[2]);
        for (int i = 0; i < 16; i++) {
            inverse[b].m[i] = (float)bone->inverse_bind.m[i % 4][i / 4];
        }
    }
    *data = (core_skeleton_data){(uint32_t)n, (const char(*)[CORE_NAME_MAX])name, parent, t, r, s,
                                 inverse};
    return data;
}

bool cv_skeleton_write(cv_model *m) {
    if (m->bone_count == 0) {
        return true;
    }
    core_skeleton_data *data = cv_skeleton_data(m);
    size_t size = 0;
    void *bytes = asset_skeleton_encode(data, &size);
    snprintf(m->out.skeleton, sizeof m->out.skeleton, "%s.cskel", m->name);
    bool good =
        bytes ? cv_write(m, m->out.skeleton, bytes, size) : cv_fail(m, "%s", core_last_error());
    core_free(bytes);
    core_free(data);
    return good;
}
