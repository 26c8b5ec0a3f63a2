#include "anim/anim_internal.h"

anim_mask anim_mask_create(anim_world *w, anim_skeleton skeleton, const float *weight) {
    anim_skeleton_res *s = anim_get_skeleton(w, skeleton);
    for (uint32_t b = 0; s && b < s->bones; b++) {
        if (!(weight[b] >= 0 && weight[b] <= 1)) {
            core_fail("bone mask: bone %s has weight %g, expected 0..1", s->name[b], weight[b]);
            return CORE_NULL_HANDLE;
        }
    }
    if (!s) {
        return CORE_NULL_HANDLE;
    }
    anim_mask_res *m = core_alloc(sizeof *m + s->stride * sizeof(float));
    m->skeleton = skeleton;
    m->weight = (float *)(m + 1);
    for (uint32_t b = 0; b < s->bones; b++) {
        m->weight[b] = weight[b];
    }
    core_handle h = anim_resource_add(&w->masks, m);
    if (core_handle_is_null(h)) {
        core_free(m);
        return h;
    }
    s->users++;
    return h;
}

bool anim_mask_destroy(anim_world *w, anim_mask h) {
    anim_mask_res *m = anim_get_mask(w, h);
    if (!m) {
        return false;
    }
    if (m->users) {
        return core_fail("bone mask: %u layers still use it", m->users);
    }
    anim_get_skeleton(w, m->skeleton)->users--;
    core_free(m);
    return core_columns_remove(&w->masks.set, h, NULL, NULL);
}
