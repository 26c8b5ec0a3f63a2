// A world in a saved scene: instances, players, frozen poses. Skeletons, clips and machines are the
// scene's own, so every name of one is looked up, and who uses what is counted anew.
#include "anim/anim_internal.h"

#include <string.h>

static void count_player(anim_world *w, uint32_t p, uint32_t by) {
    const anim_slot *slot[2] = {&w->players.now[p], &w->players.from[p]};
    for (int i = 0; i < 2; i++) {
        if (!core_handle_is_null(slot[i]->clip)) {
            anim_get_clip(w, slot[i]->clip)->users += by;
        }
    }
    if (!core_handle_is_null(w->players.machine[p])) {
        anim_get_machine(w, w->players.machine[p])->users += by;
    }
    if (!core_handle_is_null(w->players.mask[p])) {
        anim_get_mask(w, w->players.mask[p])->users += by;
    }
}

static void leave(anim_world *w) {
    for (uint32_t p = 0; p < core_columns_count(&w->players.set); p++) {
        count_player(w, p, UINT32_MAX);
    }
    for (uint32_t i = 0; i < core_columns_count(&w->instances.set); i++) {
        anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[i]);
        anim_give_place(s, w->instances.place[i]);
        s->users--;
        w->bones_live -= s->bones;
    }
    core_columns_clear(&w->instances.set);
    core_columns_clear(&w->players.set);
    core_columns_clear(&w->chunks.set);
}

static bool null_or_row(const core_columns *set, core_handle h) {
    return core_handle_is_null(h) || core_columns_row(set, h) != CORE_NO_ROW;
}

static bool slot_stands(const anim_world *w, const anim_machine_res *m, const anim_slot *slot) {
    bool state = slot->state < 0 || (m && (uint32_t)slot->state < m->state_count);
    return state && null_or_row(&w->clips.set, slot->clip);
}

static bool player_stands(const anim_world *w, uint32_t p) {
    const anim_players *c = &w->players;
    if (!null_or_row(&w->machines.set, c->machine[p]) || !null_or_row(&w->masks.set, c->mask[p]) ||
        !null_or_row(&w->chunks.set, c->snapshot[p])) {
        return false;
    }
    const anim_machine_res *m =
        core_handle_is_null(c->machine[p]) ? NULL : anim_get_machine(w, c->machine[p]);
    return slot_stands(w, m, &c->now[p]) && slot_stands(w, m, &c->from[p]);
}

// A frozen pose is as many rows as its skeleton needs, and no chain of rows goes in a circle.
static bool chunks_stand(const anim_world *w, core_handle h, const anim_skeleton_res *s) {
    bool none = core_handle_is_null(h);
    uint32_t rows = s->stride / CORE_LANES;
    for (; !core_handle_is_null(h) && rows > 0; rows--) {
        uint32_t row = core_columns_row(&w->chunks.set, h);
        if (row == CORE_NO_ROW) {
            return false;
        }
        h = w->chunks.next[row];
    }
    return core_handle_is_null(h) && (none || rows == 0);
}

static bool goal_stands(const anim_skeleton_res *s, const anim_goal *g) {
    bool limb = g->kind == ANIM_GOAL_REACH || g->kind == ANIM_GOAL_SHIFT;
    return g->kind <= ANIM_GOAL_MOVE && g->bone < s->bones &&
           (!limb || (s->parent[g->bone] >= 0 && s->parent[s->parent[g->bone]] >= 0));
}

static bool instance_stands(const anim_world *w, uint32_t i) {
    const anim_instances *c = &w->instances;
    if (core_columns_row(&w->skeletons.set, c->skeleton[i]) == CORE_NO_ROW ||
        c->goal_count[i] > ANIM_MAX_GOALS) {
        return false;
    }
    const anim_skeleton_res *s = anim_get_skeleton(w, c->skeleton[i]);
    for (uint32_t k = 0; k <= ANIM_MAX_LAYERS; k++) {
        core_handle h = k ? c->layer[i].player[k - 1] : c->player[i];
        uint32_t p = core_columns_row(&w->players.set, h);
        if (p == CORE_NO_ROW) {
            if (k == 0 || !core_handle_is_null(h)) {
                return false;
            }
            continue;
        }
        core_handle clip = w->players.now[p].clip;
        if (!chunks_stand(w, w->players.snapshot[p], s) ||
            (!core_handle_is_null(clip) &&
             !core_handle_equal(anim_get_clip(w, clip)->skeleton, c->skeleton[i]))) {
            return false;
        }
    }
    for (uint32_t g = 0; g < ANIM_MAX_GOALS; g++) {
        if (c->goals[i].goal[g].weight > 0 && !goal_stands(s, &c->goals[i].goal[g])) {
            return false;
        }
    }
    bool external = !core_handle_is_null(c->external[i]);
    return chunks_stand(w, c->external[i], s) && (external || !(c->external_weight[i] > 0));
}

static bool enter(anim_world *w, core_stream *s) {
    for (uint32_t p = 0; p < core_columns_count(&w->players.set); p++) {
        if (!player_stands(w, p)) {
            return core_stream_fail(s, "anim.players", "row %u plays what the scene has not", p);
        }
    }
    uint32_t count = core_columns_count(&w->instances.set);
    for (uint32_t i = 0; i < count; i++) {
        if (!instance_stands(w, i)) {
            return core_stream_fail(s, "anim.instances", "row %u moves what the scene has not", i);
        }
    }
    for (uint32_t p = 0; p < core_columns_count(&w->players.set); p++) {
        count_player(w, p, 1);
    }
    for (uint32_t i = 0; i < count; i++) {
        anim_skeleton_res *skeleton = anim_get_skeleton(w, w->instances.skeleton[i]);
        if (!anim_take_place(w, skeleton, &w->instances.place[i])) {
            return core_stream_fail(s, "anim.instances", "no room for %u skeletons", count);
        }
        skeleton->users++;
        w->bones_live += skeleton->bones;
        w->instances.posed[i] = 0;
    }
    return true;
}

// Shows what was loaded at once; how often each was posed stays as it was saved.
static void pose_all(anim_world *w) {
    size_t bytes = core_columns_count(&w->instances.set) * sizeof *w->instances.age;
    uint32_t *age = core_alloc(bytes + 1);
    memcpy(age, w->instances.age, bytes);
    anim_world_pose(w);
    memcpy(w->instances.age, age, bytes);
    core_free(age);
}

bool anim_world_stream(anim_world *w, core_stream *s) {
    if (!s->writing) {
        leave(w);
        w->event_count = 0;
    }
    bool good = core_stream_open(s, "anim") && core_stream_columns(s, &w->instances.set) &&
                core_stream_columns(s, &w->players.set) && core_stream_columns(s, &w->chunks.set) &&
                core_stream_list(s, "users", 'x', w->instances.user,
                                 core_columns_count(&w->instances.set) * sizeof(uint64_t)) &&
                core_stream_close(s) && (s->writing || enter(w, s));
    if (!good && !s->writing) {
        core_columns_clear(&w->instances.set);
        core_columns_clear(&w->players.set);
        core_columns_clear(&w->chunks.set);
    } else if (!s->writing) {
        pose_all(w);
    }
    return good;
}
