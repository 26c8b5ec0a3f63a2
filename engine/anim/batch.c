// Sorts visible instances into blocks that kernels pose together: by skeleton, then by the clips
// they sample. Raw clips, frozen poses and bind poses are evaluated one by one and laid into their
// lane; the model pass is shared all the same.
#include "anim/batch.h"

#include <string.h>

typedef struct group { // instances that one kernel call can sample
    const anim_skeleton_res *skeleton;
    const anim_clip_res *now, *from; // NULL: plain
    bool fading, whole;    // whole: layers, goals or blend trees, evaluated instance by instance
    uint32_t count, first; // place in the order
} group;

#define GROUPS_MAX 1024u
#define TABLE_SIZE 4096u // open addressing, at most a quarter full

typedef struct batch {
    anim_world *w;
    group *group;
    uint32_t group_count;
    uint16_t *table;                   // group + 1
    uint16_t *group_of;                // [rows]
    uint32_t *order;                   // rows by group
    uint32_t *block_row, *block_group; // first place and group of each block
    uint32_t blocks;
} batch;

static uint32_t lanes(void) {
    return core_simd_active() == CORE_SIMD_AVX512 ? 16
           : core_simd_active() == CORE_SIMD_AVX2 ? 8
                                                  : 4;
}

static const anim_clip_res *packed_clip(const anim_world *w, core_handle h) {
    uint32_t row = core_columns_row(&w->clips.set, h);
    const anim_clip_res *c = row == CORE_NO_ROW ? NULL : w->clips.item[row];
    return c && c->pack ? c : NULL;
}

static bool is_tree(const anim_world *w, uint32_t p, const anim_slot *slot) {
    return slot->state >= 0 &&
           anim_get_machine(w, w->players.machine[p])->state[slot->state].point_count > 0;
}

static group describe(const anim_world *w, uint32_t row) {
    uint32_t p = core_columns_row(&w->players.set, w->instances.player[row]);
    uint32_t s = core_columns_row(&w->skeletons.set, w->instances.skeleton[row]);
    group g = {.skeleton = w->skeletons.item[s]};
    g.whole = w->instances.layered[row] || w->instances.goal_count[row] ||
              w->instances.external_weight[row] > 0 || is_tree(w, p, &w->players.now[p]) ||
              is_tree(w, p, &w->players.from[p]);
    if (g.whole) {
        return g;
    }
    g.now = packed_clip(w, w->players.now[p].clip);
    g.fading = (w->players.flags[p] & ANIM_FADING) != 0;
    if (g.fading && core_handle_is_null(w->players.snapshot[p])) {
        g.from = packed_clip(w, w->players.from[p].clip);
    }
    return g;
}

static uint32_t find_group(batch *b, const group *g) {
    uint64_t hash = (uint64_t)(uintptr_t)g->now * 0x9e3779b97f4a7c15u ^
                    (uint64_t)(uintptr_t)g->from * 0xc2b2ae3d27d4eb4fu ^
                    (uint64_t)(uintptr_t)g->skeleton * 0x165667b19e3779f9u ^
                    (g->fading | (uint32_t)g->whole << 1);
    // The place in the table depends on addresses; the number of the group only on the order of
    // rows.
    for (uint32_t i = (uint32_t)(hash >> 40);; i++) {
        uint16_t *entry = &b->table[i % TABLE_SIZE];
        if (*entry == 0) {
            if (b->group_count == GROUPS_MAX) {
                return GROUPS_MAX;
            }
            b->group[b->group_count] = *g;
            *entry = (uint16_t)++b->group_count;
        }
        const group *known = &b->group[*entry - 1];
        if (known->skeleton == g->skeleton && known->now == g->now && known->from == g->from &&
            known->fading == g->fading && known->whole == g->whole) {
            return *entry - 1u;
        }
    }
}

#define UNSEEN UINT16_MAX
#define SINGLE (UINT16_MAX - 1) // more kinds than the table holds: by itself

static void sort_rows(batch *b, uint32_t rows) {
    for (uint32_t row = 0; row < rows; row++) {
        b->group_of[row] = UNSEEN;
        if (!anim_pose_due(b->w, row)) {
            continue;
        }
        group g = describe(b->w, row);
        uint32_t n = find_group(b, &g);
        b->group_of[row] = n == GROUPS_MAX ? SINGLE : (uint16_t)n;
        if (n != GROUPS_MAX) {
            b->group[n].count++;
        }
    }
    uint32_t place = 0;
    for (uint32_t i = 0; i < b->group_count; i++) {
        b->group[i].first = place;
        place += b->group[i].count;
        b->group[i].count = 0;
    }
    for (uint32_t row = 0; row < rows; row++) {
        if (b->group_of[row] == SINGLE) {
            anim_pose_plain(b->w, row, &b->w->scratch[0]);
        } else if (b->group_of[row] != UNSEEN) {
            group *g = &b->group[b->group_of[row]];
            b->order[g->first + g->count++] = row;
        }
    }
}

static void cut_blocks(batch *b) {
    uint32_t width = lanes();
    for (uint32_t i = 0; i < b->group_count; i++) {
        for (uint32_t k = 0; k < b->group[i].count; k += width) {
            b->block_row[b->blocks] = b->group[i].first + k;
            b->block_group[b->blocks++] = i;
        }
    }
}

// ---- one block ----

static void put_lane(const float *columns, const anim_skeleton_res *s, uint32_t lane,
                     uint32_t width, float *pose) {
    for (uint32_t b = 0; b < s->bones; b++) {
        for (uint32_t c = 0; c < ANIM_COMPONENTS; c++) {
            pose[(b * ANIM_COMPONENTS + c) * width + lane] = columns[c * s->stride + b];
        }
    }
}

typedef struct block {
    anim_world *w;
    const group *g;
    const uint32_t *rows;
    uint32_t count, width;
    core_arena *arena;
} block;

static uint32_t player_of(const block *k, uint32_t lane) {
    uint32_t row = k->rows[lane < k->count ? lane : 0];
    return core_columns_row(&k->w->players.set, k->w->instances.player[row]);
}

static void sample_packed(const block *k, const anim_clip_res *c, bool from, float *pose) {
    float time[CORE_LANES];
    for (uint32_t i = 0; i < k->width; i++) {
        uint32_t p = player_of(k, i);
        const anim_slot *slot = from ? &k->w->players.from[p] : &k->w->players.now[p];
        anim_motion m = {.loop = slot->loop, .length = c->duration};
        time[i] = anim_motion_time(&m, slot->time);
    }
    const anim_skeleton_res *s = k->g->skeleton;
    anim_sample_args a = {c->pack, c->rest, c->moved, s->bones, s->stride, time, pose};
    CORE_SIMD_SELECT(anim_kernel_sample)(&a);
    if (c->root_motion) {
        for (uint32_t i = 0; i < k->width; i++) {
            float *x = pose + (size_t)c->root_bone * ANIM_COMPONENTS * k->width + i;
            anim_root_pin(c, x, x + k->width, x + 2 * k->width);
        }
    }
}

static void plain_columns(const block *k, uint32_t lane, bool from, float *columns) {
    const anim_skeleton_res *s = k->g->skeleton;
    uint32_t p = player_of(k, lane);
    const anim_slot *slot = from ? &k->w->players.from[p] : &k->w->players.now[p];
    if (k->g->whole) {
        anim_evaluate(k->w, k->rows[lane], k->arena, columns);
    } else if (from && !core_handle_is_null(k->w->players.snapshot[p])) {
        anim_snapshot_read(k->w, k->w->players.snapshot[p], s, columns);
    } else if (core_handle_is_null(slot->clip)) {
        memcpy(columns, s->bind, ANIM_COMPONENTS * s->stride * sizeof *columns);
    } else {
        anim_clip_sample_columns(s, anim_get_clip(k->w, slot->clip),
                                 anim_slot_clip_time(k->w, p, slot), columns);
    }
}

static void sample_plain(const block *k, bool from, float *pose) {
    float *columns = anim_scratch_pose(k->arena, k->g->skeleton);
    for (uint32_t i = 0; i < k->width; i++) {
        if (i < k->count) {
            plain_columns(k, i, from, columns);
        }
        put_lane(columns, k->g->skeleton, i, k->width, pose);
    }
}

static void sample(const block *k, bool from, float *pose) {
    const anim_clip_res *c = from ? k->g->from : k->g->now;
    if (c) {
        sample_packed(k, c, from, pose);
    } else {
        sample_plain(k, from, pose);
    }
}

static void pose_block(const block *k) {
    const anim_skeleton_res *s = k->g->skeleton;
    size_t floats = (size_t)s->bones * k->width;
    float *pose = CORE_ARENA_ARRAY(k->arena, float, floats *ANIM_COMPONENTS);
    float *model = CORE_ARENA_ARRAY(k->arena, float, floats * 12);
    sample(k, false, pose);
    if (k->g->fading) {
        float weight[CORE_LANES];
        float *from = CORE_ARENA_ARRAY(k->arena, float, floats *ANIM_COMPONENTS);
        sample(k, true, from);
        for (uint32_t i = 0; i < k->width; i++) {
            weight[i] = anim_fade_weight(k->w, player_of(k, i));
        }
        anim_mix_args mix = {s->bones, weight, from, pose};
        CORE_SIMD_SELECT(anim_kernel_mix)(&mix);
    }
    float *palette[CORE_LANES];
    for (uint32_t i = 0; i < k->width; i++) {
        palette[i] = i < k->count ? anim_palette_of(k->w, k->rows[i]) : NULL;
        if (i < k->count) {
            k->w->instances.posed[k->rows[i]] = 1;
        }
    }
    anim_finish_args finish = {s, pose, model, palette};
    CORE_SIMD_SELECT(anim_kernel_finish)(&finish);
}

static void pose_blocks(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    const batch *b = ctx;
    core_arena *arena = &b->w->scratch[worker];
    (void)chunk;
    for (uint32_t i = begin; i < end; i++) {
        const group *g = &b->group[b->block_group[i]];
        uint32_t left = g->first + g->count - b->block_row[i], width = lanes();
        block k = {b->w, g, b->order + b->block_row[i], CORE_MIN(left, width), width, arena};
        size_t mark = core_arena_mark(arena);
        pose_block(&k);
        core_arena_rewind(arena, mark);
    }
}

#define BLOCK_GRAIN 4

void anim_batch_pose(anim_world *w) {
    uint32_t rows = core_columns_count(&w->instances.set);
    core_arena *arena = &w->scratch[0];
    size_t mark = core_arena_mark(arena);
    batch b = {.w = w};
    b.group = CORE_ARENA_ARRAY(arena, group, GROUPS_MAX);
    b.table = CORE_ARENA_ARRAY(arena, uint16_t, TABLE_SIZE);
    b.group_of = CORE_ARENA_ARRAY(arena, uint16_t, rows + 1);
    b.order = CORE_ARENA_ARRAY(arena, uint32_t, rows + 1);
    b.block_row = CORE_ARENA_ARRAY(arena, uint32_t, rows + 1);
    b.block_group = CORE_ARENA_ARRAY(arena, uint32_t, rows + 1);
    memset(b.table, 0, TABLE_SIZE * sizeof *b.table);
    sort_rows(&b, rows);
    cut_blocks(&b);
    core_jobs_for(w->jobs, b.blocks, BLOCK_GRAIN, pose_blocks, &b);
    core_arena_rewind(arena, mark);
}
