#include "anim/anim_internal.h"

#include <math.h>
#include <string.h>

static bool finite_all(const float *v, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        if (!isfinite(v[i])) {
            return false;
        }
    }
    return true;
}

static bool check_bone(const core_skeleton_data *d, uint32_t b) {
    const char *name = d->name ? d->name[b] : "";
    if (d->parent[b] < -1 || d->parent[b] >= (int32_t)b) {
        return core_fail("skeleton: bone %u (%s) has parent %d; parents must come before their "
                         "children, -1 for roots",
                         b, name, d->parent[b]);
    }
    if (!finite_all(&d->translation[b].x, 3) || !finite_all(&d->rotation[b].x, 4) ||
        !finite_all(&d->scale[b].x, 3) || !finite_all(d->inverse_bind[b].m, 16)) {
        return core_fail("skeleton: bone %u (%s) has a number that is not finite", b, name);
    }
    core_quat q = d->rotation[b];
    if (!(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w > 1e-12f)) {
        return core_fail("skeleton: bone %u (%s) has a zero rotation; expected a unit quaternion",
                         b, name);
    }
    return true;
}

static bool check(const core_skeleton_data *d) {
    if (!d || d->bone_count == 0 || d->bone_count > ANIM_MAX_BONES) {
        return core_fail("skeleton: %u bones; expected 1..%u", d ? d->bone_count : 0,
                         ANIM_MAX_BONES);
    }
    for (uint32_t b = 0; b < d->bone_count; b++) {
        if (!check_bone(d, b)) {
            return false;
        }
    }
    return true;
}

static anim_skeleton_res *allocate(uint32_t bones) {
    uint32_t stride = (bones + CORE_LANES - 1) / CORE_LANES * CORE_LANES;
    size_t head = (sizeof(anim_skeleton_res) + 63) & ~(size_t)63;
    size_t size = head + stride * (ANIM_COMPONENTS * 4u + 12u * 4u + 4u + CORE_NAME_MAX);
    uint8_t *block = core_alloc(size);
    anim_skeleton_res *s = (anim_skeleton_res *)block;
    s->bones = bones;
    s->stride = stride;
    s->bind = (float *)(block + head);
    s->inverse_bind = s->bind + ANIM_COMPONENTS * stride;
    s->parent = (int32_t *)(s->inverse_bind + 12u * stride);
    s->name = (char(*)[CORE_NAME_MAX])(s->parent + stride);
    return s;
}

static void copy_bones(anim_skeleton_res *s, const core_skeleton_data *d) {
    for (uint32_t b = 0; b < s->bones; b++) {
        s->parent[b] = d->parent[b];
        for (uint32_t i = 0; d->name && d->name[b][i] && i + 1 < CORE_NAME_MAX; i++) {
            s->name[b][i] = d->name[b][i];
        }
        core_quat q = core_quat_normalize(d->rotation[b]);
        core_vec3 t = d->translation[b], k = d->scale[b];
        const float v[ANIM_COMPONENTS] = {t.x, t.y, t.z, q.x, q.y, q.z, q.w, k.x, k.y, k.z};
        for (uint32_t c = 0; c < ANIM_COMPONENTS; c++) {
            s->bind[c * s->stride + b] = v[c];
        }
        for (uint32_t r = 0; r < 3; r++) {
            for (uint32_t c = 0; c < 4; c++) {
                s->inverse_bind[b * 12 + r * 4 + c] = d->inverse_bind[b].m[c * 4 + r];
            }
        }
    }
    // Lanes past the last bone hold the identity, so that kernels may run over them.
    for (uint32_t b = s->bones; b < s->stride; b++) {
        s->bind[ANIM_RW * s->stride + b] = 1;
        s->bind[ANIM_SX * s->stride + b] = 1;
        s->bind[ANIM_SY * s->stride + b] = 1;
        s->bind[ANIM_SZ * s->stride + b] = 1;
    }
}

anim_skeleton anim_skeleton_create(anim_world *w, const core_skeleton_data *data) {
    if (!check(data)) {
        return CORE_NULL_HANDLE;
    }
    anim_skeleton_res *s = allocate(data->bone_count);
    copy_bones(s, data);
    anim_detail_choose_probes(s);
    core_handle h = anim_resource_add(&w->skeletons, s);
    if (core_handle_is_null(h)) {
        core_free(s);
    }
    return h;
}

bool anim_skeleton_destroy(anim_world *w, anim_skeleton h) {
    anim_skeleton_res *s = anim_get_skeleton(w, h);
    if (!s) {
        return false;
    }
    if (s->users) {
        return core_fail("skeleton: %u clips and instances still use it; destroy them first",
                         s->users);
    }
    core_free(s->free_place);
    core_free(s);
    return core_columns_remove(&w->skeletons.set, h, NULL, NULL);
}

uint32_t anim_skeleton_bone_count(const anim_world *w, anim_skeleton h) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    return s ? s->bones : 0;
}

int32_t anim_skeleton_find(const anim_world *w, anim_skeleton h, const char *name) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    for (uint32_t b = 0; s && b < s->bones; b++) {
        if (strcmp(s->name[b], name) == 0) {
            return (int32_t)b;
        }
    }
    return -1;
}

const char *anim_skeleton_bone_name(const anim_world *w, anim_skeleton h, uint32_t bone) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    return s && bone < s->bones ? s->name[bone] : "";
}

int32_t anim_skeleton_parent(const anim_world *w, anim_skeleton h, uint32_t bone) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    return s && bone < s->bones ? s->parent[bone] : -1;
}

uint32_t anim_skeleton_children(const anim_world *w, anim_skeleton h, uint32_t bone, uint32_t *out,
                                uint32_t capacity) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    uint32_t n = 0;
    for (uint32_t b = 0; s && b < s->bones; b++) {
        if (s->parent[b] == (int32_t)bone) {
            if (n < capacity) {
                out[n] = b;
            }
            n++;
        }
    }
    return n;
}

bool anim_skeleton_bind(const anim_world *w, anim_skeleton h, uint32_t bone, core_key *out) {
    const anim_skeleton_res *s = anim_get_skeleton(w, h);
    if (!s || bone >= s->bones) {
        return s && core_fail("anim_skeleton_bind: bone %u of %u", bone, s->bones);
    }
    const float *v = s->bind + bone;
    const uint32_t n = s->stride;
    *out = (core_key){0,
                      {v[ANIM_TX * n], v[ANIM_TY * n], v[ANIM_TZ * n]},
                      {v[ANIM_RX * n], v[ANIM_RY * n], v[ANIM_RZ * n], v[ANIM_RW * n]},
                      {v[ANIM_SX * n], v[ANIM_SY * n], v[ANIM_SZ * n]}};
    return true;
}
