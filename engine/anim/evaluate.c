// From state to pose to palette.
#include "anim/anim_internal.h"

#include <string.h>

static void sample_slot(const anim_world *w, const anim_skeleton_res *s, const anim_slot *slot,
                        float *out) {
    if (core_handle_is_null(slot->clip)) {
        memcpy(out, s->bind, ANIM_COMPONENTS * s->stride * sizeof(float));
        return;
    }
    const anim_clip_res *c = anim_get_clip(w, slot->clip);
    anim_clip_sample_columns(s, c, anim_slot_clip_time(c, slot), out);
}

void anim_evaluate(anim_world *w, uint32_t row, core_arena *arena, float *out) {
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    uint32_t p = core_columns_row(&w->players.set, w->instances.player[row]);
    sample_slot(w, s, &w->players.now[p], out);
    if (!(w->players.flags[p] & ANIM_FADING)) {
        return;
    }
    size_t mark = core_arena_mark(arena);
    float *from = anim_scratch_pose(arena, s);
    if (core_handle_is_null(w->players.snapshot[p])) {
        sample_slot(w, s, &w->players.from[p], from);
    } else {
        anim_snapshot_read(w, w->players.snapshot[p], s, from);
    }
    anim_columns_blend(from, out, anim_fade_weight(w, p), s->stride, out);
    core_arena_rewind(arena, mark);
}

float *anim_palette_of(const anim_world *w, uint32_t row) {
    return w->palette + (size_t)w->instances.place[row] * ANIM_PALETTE_FLOATS;
}

void anim_pose_plain(anim_world *w, uint32_t row, core_arena *arena) {
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    size_t mark = core_arena_mark(arena);
    float *pose = anim_scratch_pose(arena, s);
    float *model = CORE_ARENA_ARRAY(arena, float, 12u * s->bones);
    anim_evaluate(w, row, arena, pose);
    anim_columns_to_model(s, pose, model);
    anim_model_palette(s, model, anim_palette_of(w, row));
    w->instances.posed[row] = 1;
    core_arena_rewind(arena, mark);
}

static void pose_rows(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    anim_world *w = ctx;
    (void)chunk;
    for (uint32_t row = begin; row < end; row++) {
        if (!(w->instances.flags[row] & ANIM_HIDDEN)) {
            anim_pose_plain(w, row, &w->scratch[worker]);
        }
    }
}

#define POSE_GRAIN 32

void anim_world_pose(anim_world *w) {
    core_stage_begin(w->metrics, CORE_STAGE_ANIM);
    if (!anim_scratch(w, (uint32_t)core_jobs_threads(w->jobs) - 1)) {
        core_stage_end(w->metrics, CORE_STAGE_ANIM);
        return;
    }
    if (!w->unbatched) {
        anim_batch_pose(w);
    } else {
        core_jobs_for(w->jobs, core_columns_count(&w->instances.set), POSE_GRAIN, pose_rows, w);
    }
    core_stage_end(w->metrics, CORE_STAGE_ANIM);
}

bool anim_instance_pose(anim_world *w, anim_instance h, anim_pose out) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    core_arena *arena = anim_scratch(w, 0);
    size_t mark = core_arena_mark(arena);
    float *pose = anim_scratch_pose(arena, s);
    anim_evaluate(w, row, arena, pose);
    anim_columns_to_pose(pose, s->bones, s->stride, out);
    core_arena_rewind(arena, mark);
    return true;
}

const float *anim_instance_palette(const anim_world *w, anim_instance h, uint32_t *bone_count) {
    uint32_t row = anim_get_instance(w, h);
    *bone_count = 0;
    if (row == CORE_NO_ROW || !w->instances.posed[row]) {
        return NULL;
    }
    *bone_count = anim_get_skeleton(w, w->instances.skeleton[row])->bones;
    return anim_palette_of(w, row);
}

// The palette holds model * inverse bind; undoing the latter costs one product and saves a second
// array for every bone of every instance.
bool anim_instance_bone(const anim_world *w, anim_instance h, uint32_t bone, core_mat4 *out) {
    uint32_t bones;
    const float *palette = anim_instance_palette(w, h, &bones);
    if (!palette || bone >= bones) {
        return core_fail("anim_instance_bone: bone %u of %u; the instance must have been posed",
                         bone, bones);
    }
    const anim_skeleton_res *s = anim_get_skeleton(w, anim_instance_skeleton(w, h));
    core_mat4 skin = core_mat4_identity(), inverse = core_mat4_identity(), bind;
    for (uint32_t i = 0; i < 12; i++) {
        skin.m[i % 4 * 4 + i / 4] = palette[12 * bone + i];
        inverse.m[i % 4 * 4 + i / 4] = s->inverse_bind[12 * bone + i];
    }
    if (!core_mat4_inverse(&inverse, &bind)) {
        return core_fail("bone %s: its inverse bind matrix is singular", s->name[bone]);
    }
    *out = core_mat4_mul(&skin, &bind);
    return true;
}
