// From state to pose to palette.
#include "anim/anim_internal.h"

#include <string.h>

static void sample_motion(const anim_skeleton_res *s, const anim_motion *m, float time,
                          core_arena *arena, float *out) {
    if (!m->clip[0]) {
        memcpy(out, s->bind, ANIM_COMPONENTS * s->stride * sizeof(float));
        return;
    }
    anim_clip_sample_columns(s, m->clip[0], time * m->scale[0], out);
    if (m->clip[1]) {
        size_t mark = core_arena_mark(arena);
        float *second = anim_scratch_pose(arena, s);
        anim_clip_sample_columns(s, m->clip[1], time * m->scale[1], second);
        anim_columns_blend(out, second, m->weight, s->stride, out);
        core_arena_rewind(arena, mark);
    }
}

// pose = what turns the reference into it: T - Tr, Rr^-1 R, S / Sr.
static void subtract_reference(const float *ref, uint32_t n, float *pose) {
    for (uint32_t i = 0; i < 3 * n; i++) {
        pose[ANIM_TX * n + i] -= ref[ANIM_TX * n + i];
        float base = ref[ANIM_SX * n + i];
        pose[ANIM_SX * n + i] = base != 0 ? pose[ANIM_SX * n + i] / base : 1;
    }
    for (uint32_t i = 0; i < n; i++) {
        const float *a = ref + ANIM_RX * n + i;
        float *b = pose + ANIM_RX * n + i;
        core_quat inverse = {-a[0], -a[n], -a[2 * n], a[3 * n]};
        core_quat d = core_quat_mul(inverse, (core_quat){b[0], b[n], b[2 * n], b[3 * n]});
        b[0] = d.x;
        b[n] = d.y;
        b[2 * n] = d.z;
        b[3 * n] = d.w;
    }
}

static void sample_slot(const anim_world *w, const anim_skeleton_res *s, uint32_t p,
                        const anim_slot *slot, core_arena *arena, float *out) {
    anim_motion m = anim_slot_motion(w, p, slot);
    sample_motion(s, &m, m.clip[0] ? anim_motion_time(&m, slot->time) : 0, arena, out);
    if (w->players.mode[p] & ANIM_ADDITIVE) {
        size_t mark = core_arena_mark(arena);
        float *ref = anim_scratch_pose(arena, s);
        sample_motion(s, &m, 0, arena, ref);
        subtract_reference(ref, s->stride, out);
        core_arena_rewind(arena, mark);
    }
}

void anim_evaluate_player(anim_world *w, const anim_skeleton_res *s, uint32_t p, core_arena *arena,
                          float *out) {
    sample_slot(w, s, p, &w->players.now[p], arena, out);
    if (!(w->players.flags[p] & ANIM_FADING)) {
        return;
    }
    size_t mark = core_arena_mark(arena);
    float *from = anim_scratch_pose(arena, s);
    if (core_handle_is_null(w->players.snapshot[p])) {
        sample_slot(w, s, p, &w->players.from[p], arena, from);
    } else {
        anim_snapshot_read(w, w->players.snapshot[p], s, from);
    }
    anim_columns_blend(from, out, anim_fade_weight(w, p), s->stride, out);
    core_arena_rewind(arena, mark);
}

// One bone of a layer over the pose below it.
static void lay_bone(const float *layer, uint32_t n, float weight, bool additive, float *pose) {
    float left = 1 - weight;
    for (uint32_t c = 0; c < 3; c++) {
        float *t = pose + (ANIM_TX + c) * n, *s = pose + (ANIM_SX + c) * n;
        float lt = layer[(ANIM_TX + c) * n], ls = layer[(ANIM_SX + c) * n];
        *t = additive ? *t + lt * weight : *t * left + lt * weight;
        *s = additive ? *s * (left + ls * weight) : *s * left + ls * weight;
    }
    const float *l = layer + ANIM_RX * n;
    float *q = pose + ANIM_RX * n;
    core_quat below = {q[0], q[n], q[2 * n], q[3 * n]};
    core_quat above = {l[0], l[n], l[2 * n], l[3 * n]};
    core_quat r = additive
                      ? core_quat_mul(below, core_quat_nlerp(core_quat_identity(), above, weight))
                      : core_quat_nlerp(below, above, weight);
    q[0] = r.x;
    q[n] = r.y;
    q[2 * n] = r.z;
    q[3 * n] = r.w;
}

static void lay_over(anim_world *w, const anim_skeleton_res *s, uint32_t p, core_arena *arena,
                     float *pose) {
    if (!(w->players.weight[p] > 0)) {
        return;
    }
    size_t mark = core_arena_mark(arena);
    float *layer = anim_scratch_pose(arena, s);
    anim_evaluate_player(w, s, p, arena, layer);
    const float *mask = core_handle_is_null(w->players.mask[p])
                            ? NULL
                            : anim_get_mask(w, w->players.mask[p])->weight;
    bool additive = (w->players.mode[p] & ANIM_ADDITIVE) != 0;
    for (uint32_t b = 0; b < s->bones; b++) {
        float weight = w->players.weight[p] * (mask ? mask[b] : 1);
        if (weight > 0) {
            lay_bone(layer + b, s->stride, weight, additive, pose + b);
        }
    }
    core_arena_rewind(arena, mark);
}

void anim_evaluate(anim_world *w, uint32_t row, core_arena *arena, float *out) {
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    anim_evaluate_player(w, s, core_columns_row(&w->players.set, w->instances.player[row]), arena,
                         out);
    for (uint32_t i = 0; w->instances.layered[row] && i < ANIM_MAX_LAYERS; i++) {
        uint32_t p = core_columns_row(&w->players.set, w->instances.layer[row].player[i]);
        if (p != CORE_NO_ROW) {
            lay_over(w, s, p, arena, out);
        }
    }
    if (w->instances.goal_count[row]) {
        anim_goals_apply(s, &w->instances.goals[row], out);
    }
    if (w->instances.external_weight[row] > 0) {
        size_t mark = core_arena_mark(arena);
        float *external = anim_scratch_pose(arena, s);
        anim_snapshot_read(w, w->instances.external[row], s, external);
        anim_columns_blend(out, external, w->instances.external_weight[row], s->stride, out);
        core_arena_rewind(arena, mark);
    }
}

bool anim_instance_set_external(anim_world *w, anim_instance h, const anim_pose *pose,
                                float weight) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!(weight >= 0 && weight <= 1)) {
        return core_fail("anim_instance_set_external: weight %g, expected 0..1", weight);
    }
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    if (pose || weight == 0) {
        anim_snapshot_drop(w, w->instances.external[row]);
        w->instances.external[row] = CORE_NULL_HANDLE;
    }
    if (pose && weight > 0) {
        core_arena *arena = anim_scratch(w, 0);
        size_t mark = core_arena_mark(arena);
        float *columns = anim_scratch_pose(arena, s);
        anim_columns_from_pose(*pose, s->bones, s->stride, columns);
        w->instances.external[row] = anim_snapshot_take(w, s, columns);
        core_arena_rewind(arena, mark);
    }
    bool there = !core_handle_is_null(w->instances.external[row]);
    w->instances.external_weight[row] = there ? weight : 0;
    return there || weight == 0;
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

bool anim_pose_due(anim_world *w, uint32_t row) {
    if (w->instances.flags[row] & ANIM_HIDDEN) {
        return false;
    }
    uint32_t age = w->instances.age[row]++, rate = w->instances.rate[row];
    bool due = rate < 2 || age % rate == 0 || !w->instances.posed[row];
    due = due && !anim_detail_skips(w, row);
    w->instances.posed_at[row] = due ? w->pose_count : w->instances.posed_at[row];
    return due;
}

static void pose_rows(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    anim_world *w = ctx;
    (void)chunk;
    for (uint32_t row = begin; row < end; row++) {
        if (anim_pose_due(w, row)) {
            anim_pose_plain(w, row, &w->scratch[worker]);
        }
    }
}

#define POSE_GRAIN 32

void anim_world_pose(anim_world *w) {
    core_stage_begin(w->metrics, CORE_STAGE_ANIM);
    w->pose_count++;
    if (!anim_scratch(w, (uint32_t)core_jobs_threads(w->jobs) - 1)) {
        core_stage_end(w->metrics, CORE_STAGE_ANIM);
        return;
    }
    if (!w->unbatched) {
        anim_batch_pose(w);
    } else {
        core_jobs_for(w->jobs, core_columns_count(&w->instances.set), POSE_GRAIN, pose_rows, w);
    }
    anim_detail_measure(w);
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
bool anim_palette_bone(const anim_world *w, uint32_t row, uint32_t bone, core_mat4 *out) {
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    const float *palette = anim_palette_of(w, row);
    if (bone >= s->bones) {
        return core_fail("anim_instance_bone: bone %u of %u", bone, s->bones);
    }
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

// What the simulation reads is never behind.
bool anim_instance_bone(anim_world *w, anim_instance h, uint32_t bone, core_mat4 *out) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    bool behind = w->instances.tolerance[row] > 0 && w->instances.posed_at[row] != w->pose_count;
    if (!w->instances.posed[row] || behind) {
        anim_pose_plain(w, row, anim_scratch(w, 0));
        w->instances.posed_at[row] = w->pose_count;
    }
    w->instances.read[row] = 1;
    return anim_palette_bone(w, row, bone, out);
}
