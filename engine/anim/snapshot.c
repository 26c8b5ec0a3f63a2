// Frozen poses for interrupted fades, in rows of 16 bones linked by handles: they are state, so
// they live in a column set and are hashed and saved with everything else.
#include "anim/anim_internal.h"

#include <string.h>

core_handle anim_snapshot_take(anim_world *w, const anim_skeleton_res *s, const float *pose) {
    core_handle next = CORE_NULL_HANDLE;
    for (uint32_t first = s->stride; first > 0; first -= CORE_LANES) {
        core_handle h = core_columns_add(&w->chunks.set);
        if (core_handle_is_null(h)) {
            anim_snapshot_drop(w, next);
            return h;
        }
        uint32_t row = core_columns_row(&w->chunks.set, h);
        for (uint32_t c = 0; c < ANIM_COMPONENTS; c++) {
            memcpy(w->chunks.pose[row].value[c], pose + c * s->stride + first - CORE_LANES,
                   CORE_LANES * sizeof(float));
        }
        w->chunks.next[row] = next;
        next = h;
    }
    return next;
}

void anim_snapshot_read(const anim_world *w, core_handle h, const anim_skeleton_res *s,
                        float *out) {
    for (uint32_t first = 0; first < s->stride; first += CORE_LANES) {
        uint32_t row = core_columns_row(&w->chunks.set, h);
        for (uint32_t c = 0; c < ANIM_COMPONENTS; c++) {
            memcpy(out + c * s->stride + first, w->chunks.pose[row].value[c],
                   CORE_LANES * sizeof(float));
        }
        h = w->chunks.next[row];
    }
}

void anim_snapshot_drop(anim_world *w, core_handle h) {
    while (!core_handle_is_null(h)) {
        uint32_t row = core_columns_row(&w->chunks.set, h);
        core_handle next = w->chunks.next[row];
        core_columns_remove(&w->chunks.set, h, NULL, NULL);
        h = next;
    }
}
