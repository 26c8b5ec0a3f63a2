// Private to the room: resources, columns of state, and the passes over them.
#ifndef ANIM_INTERNAL_H
#define ANIM_INTERNAL_H

#include "anim/anim.h"
#include "anim/pack.h"
#include "core/memory.h"

#define ANIM_COOKIE 0x616e696du // "anim"

// A local pose as columns: component c of bone b is at value[c * stride + b]; stride is the bone
// count padded to CORE_LANES.
enum { ANIM_TX, ANIM_TY, ANIM_TZ, ANIM_RX, ANIM_RY, ANIM_RZ, ANIM_RW, ANIM_SX, ANIM_SY, ANIM_SZ };
#define ANIM_COMPONENTS 10u

enum { ANIM_PROBES = 8 };

typedef struct anim_skeleton_res {
    uint32_t bones, stride;
    char (*name)[CORE_NAME_MAX];
    int32_t *parent;
    float *bind;         // [ANIM_COMPONENTS * stride]
    float *inverse_bind; // [bones * 12] rows of 3x4
    uint32_t users;      // clips and instances
    // Points that tell how fast the skin moves (detail.c): the joints farthest from the root.
    uint32_t probe[ANIM_PROBES], probe_count;
    core_vec3 probe_place[ANIM_PROBES]; // in the bind pose
    // Palette places given back by destroyed instances, last in first out.
    uint32_t *free_place;
    uint32_t free_count, free_capacity;
} anim_skeleton_res;

typedef struct anim_clip_res {
    char name[CORE_NAME_MAX];
    float duration;
    anim_skeleton skeleton;
    uint32_t bones, track_count;
    core_clip_track *track;
    core_key *key, *tangent;
    int32_t *track_of_bone; // [bones] -1 none
    anim_pack *pack;        // compressed: no keys; NULL: raw
    float *rest;            // with pack: [ANIM_COMPONENTS * stride] what no group of it gives
    uint8_t *moved;         // with pack: [bones] bit per anim_pack_kind that a group gives
    anim_clip_event *event; // ascending time
    uint32_t event_count;
    bool root_motion;
    uint32_t root_bone;
    // Root motion in the frame of the root's parent and of the model: see root_motion.c.
    float root_remove[9], root_report[9];
    uint32_t users; // states and players
} anim_clip_res;

typedef struct anim_state {
    char name[CORE_NAME_MAX];
    int32_t parent; // state that holds it, -1: none
    int32_t entry;  // state that plays when this is entered: itself unless it holds others
    anim_clip clip; // of a blend tree: its first; null when it holds others
    uint32_t first_point, point_count, blend_parameter;
    anim_loop loop;
    float speed;
    anim_state_fn *on_enter, *on_exit;
    anim_tick_fn *on_tick;
    anim_speed_fn *speed_fn;
    void *ctx;
} anim_state;

typedef struct anim_transition {
    int32_t from, to; // from -1: any state but `to`
    anim_when when;
    anim_condition_fn *condition;
    void *ctx;
    uint32_t event, parameter; // numbers in the machine
    anim_compare compare;
    float value, length;
    anim_fade fade;
    bool uninterruptible, sync;
    bool last; // of a state that holds others, when they are finished: after all other transitions
} anim_transition;

typedef struct anim_machine_res {
    anim_skeleton skeleton;
    anim_state *state;
    anim_transition *transition;
    anim_blend_point *point;
    uint32_t state_count, transition_count, point_count, initial;
    char event[ANIM_MAX_EVENTS][CORE_NAME_MAX];
    char parameter[ANIM_MAX_PARAMETERS][CORE_NAME_MAX];
    float start_value[ANIM_MAX_PARAMETERS];
    uint32_t event_count, parameter_count;
    bool nested; // some states hold others
    uint32_t users;
} anim_machine_res;

// Whether the state is `outer` or held by it.
static inline bool anim_state_in(const anim_machine_res *m, int32_t state, int32_t outer) {
    while (state >= 0 && state != outer) {
        state = m->state[state].parent;
    }
    return state >= 0;
}
// Whether a transition may leave the state that plays.
static inline bool anim_transition_leaves(const anim_machine_res *m, const anim_transition *t,
                                          int32_t state) {
    if (t->from == state) {
        return true;
    }
    bool from = t->from < 0 || anim_state_in(m, state, t->from);
    return from && (t->to == t->from || !anim_state_in(m, state, t->to));
}

// What plays: a state of the player's machine (state >= 0) or a clip by itself.
typedef struct anim_slot {
    core_handle clip; // of the state too, so that sampling need not look it up
    int32_t state;
    uint32_t loop;   // anim_loop
    float time;      // seconds into the clip, ping-pong to twice the duration; blend trees: phase
    uint32_t unused; // keeps the bytes of the struct defined for hashing
} anim_slot;

typedef struct anim_values {
    float v[ANIM_MAX_PARAMETERS];
} anim_values;

enum { ANIM_ADDITIVE = 1 }; // mode
enum { ANIM_FADING = 1, ANIM_SMOOTH = 2, ANIM_LOCKED = 4 };
#define ANIM_PLAYER_COLUMNS(X)                                                                     \
    X(core_handle, machine, CORE_COLUMN_STATE)                                                     \
    X(anim_slot, now, CORE_COLUMN_STATE)        /* current state: the target of a running fade */  \
    X(anim_slot, from, CORE_COLUMN_STATE)       /* the state being left */                         \
    X(core_handle, snapshot, CORE_COLUMN_STATE) /* frozen pose instead of `from` */                \
    X(float, fade_time, CORE_COLUMN_STATE)                                                         \
    X(float, fade_length, CORE_COLUMN_STATE)                                                       \
    X(uint32_t, flags, CORE_COLUMN_STATE)                                                          \
    X(core_handle, mask, CORE_COLUMN_STATE)                                                        \
    X(float, weight, CORE_COLUMN_STATE)                                                            \
    X(uint32_t, mode, CORE_COLUMN_STATE)                                                           \
    X(uint32_t, events, CORE_COLUMN_STATE) /* bit per event name sent since the last update */     \
    X(anim_values, parameter, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(anim_players, ANIM_PLAYER_COLUMNS)

typedef struct anim_layers {
    core_handle player[ANIM_MAX_LAYERS];
} anim_layers;
typedef struct anim_mask_res {
    anim_skeleton skeleton;
    uint32_t users;
    float *weight; // [stride]
} anim_mask_res;

typedef struct anim_goal {
    uint32_t kind, bone;
    core_vec3 target, pole, axis;
    float limit, weight;
    uint32_t keep_rotation;
} anim_goal;
typedef struct anim_goals {
    anim_goal goal[ANIM_MAX_GOALS];
} anim_goals;

typedef struct anim_probe { // where the probes were when the instance was posed last
    core_vec3 at[ANIM_PROBES];
    uint32_t measured; // pose_count then, 0: never
} anim_probe;

enum { ANIM_HIDDEN = 1, ANIM_DOOMED = 2 };
#define ANIM_INSTANCE_COLUMNS(X)                                                                   \
    X(core_handle, skeleton, CORE_COLUMN_STATE)                                                    \
    X(core_handle, player, CORE_COLUMN_STATE)                                                      \
    X(anim_layers, layer, CORE_COLUMN_STATE) /* null: none */                                      \
    X(uint32_t, layered, CORE_COLUMN_STATE)  /* how many layers there are */                       \
    X(anim_goals, goals, CORE_COLUMN_STATE)                                                        \
    X(uint32_t, goal_count, CORE_COLUMN_STATE) /* with a weight */                                 \
    X(uint32_t, rate, CORE_COLUMN_STATE)       /* posed every rate-th time; 0: every */            \
    X(uint32_t, age, CORE_COLUMN_STATE)        /* poses asked for */                               \
    X(float, speed, CORE_COLUMN_STATE)                                                             \
    X(float, root_x, CORE_COLUMN_STATE)                                                            \
    X(float, root_y, CORE_COLUMN_STATE)                                                            \
    X(float, root_z, CORE_COLUMN_STATE)                                                            \
    X(uint32_t, flags, CORE_COLUMN_STATE)                                                          \
    X(core_handle, external, CORE_COLUMN_STATE) /* pose given from outside; null: none */          \
    X(float, external_weight, CORE_COLUMN_STATE)                                                   \
    X(uint64_t, user, 0)                                                                           \
    X(uint32_t, place, 0)    /* first bone in the palette range */                                 \
    X(uint32_t, posed, 0)    /* palette holds a pose */                                            \
    X(uint32_t, posed_at, 0) /* pose_count then */                                                 \
    X(uint32_t, read, 0)     /* somebody asks for its bones: never behind */                       \
    X(float, tolerance, 0)   /* m the palette may be behind */                                     \
    X(float, motion, 0)      /* m that its fastest probe moves in a step */                        \
    X(anim_probe, probe, 0)
CORE_COLUMNS_DECLARE(anim_instances, ANIM_INSTANCE_COLUMNS)

// Frozen poses, 16 bones a row, linked: pose columns of record for interrupted fades.
typedef struct anim_chunk {
    float value[ANIM_COMPONENTS][CORE_LANES];
} anim_chunk;
#define ANIM_CHUNK_COLUMNS(X)                                                                      \
    X(core_handle, next, CORE_COLUMN_STATE)                                                        \
    X(anim_chunk, pose, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(anim_chunks, ANIM_CHUNK_COLUMNS)

// Resources by handle; the rows hold pointers.
#define ANIM_RESOURCE_COLUMNS(X) X(void *, item, 0)
CORE_COLUMNS_DECLARE(anim_resources, ANIM_RESOURCE_COLUMNS)

struct anim_world {
    core_jobs *jobs;
    core_metrics *metrics;
    anim_resources skeletons, clips, machines, masks;
    anim_instances instances;
    anim_players players;
    anim_chunks chunks;
    bool unbatched;      // pose one instance at a time
    float lod;           // pixels that palettes may be behind; 0: none
    uint32_t pose_count; // calls of anim_world_pose
    float pack_bound;    // m: clips made from keys are compressed; 0: kept raw
    float *palette;      // [max_bones * 12] reserved
    uint32_t max_bones, bones_placed, bones_committed, bones_live;
    core_arena scratch[CORE_JOBS_MAX_THREADS]; // one a worker, made when first used
    uint32_t scratch_count;
    anim_event *event;
    uint32_t event_count, event_capacity;
    bool updating;
};

// NULL + core_fail for stale handles, naming the kind.
anim_skeleton_res *anim_get_skeleton(const anim_world *w, anim_skeleton h);
anim_clip_res *anim_get_clip(const anim_world *w, anim_clip h);
anim_machine_res *anim_get_machine(const anim_world *w, anim_machine h);
// Row of a live instance or CORE_NO_ROW + core_fail.
anim_mask_res *anim_get_mask(const anim_world *w, anim_mask h);
uint32_t anim_get_instance(const anim_world *w, anim_instance h);
core_handle anim_resource_add(anim_resources *set, void *item);
core_arena *anim_scratch(anim_world *w, uint32_t worker);
float *anim_scratch_pose(core_arena *arena, const anim_skeleton_res *s);

// Fails with `state machine: WHAT "name"` and the nearest of `count` names that begin `stride`
// bytes apart, when one is near.
bool anim_unknown(const char *what, const char *name, const void *names, size_t stride,
                  uint32_t count);

// ---- poses as columns ----
void anim_columns_from_pose(anim_pose in, uint32_t bones, uint32_t stride, float *out);
void anim_columns_to_pose(const float *in, uint32_t bones, uint32_t stride, anim_pose out);
void anim_columns_blend(const float *a, const float *b, float alpha, uint32_t stride, float *out);
// Model matrices (rows of 3x4, [bones * 12]) and palette of a column pose.
void anim_columns_to_model(const anim_skeleton_res *s, const float *pose, float *model);
void anim_model_palette(const anim_skeleton_res *s, const float *model, float *palette);
void anim_clip_free(void *clip);
void anim_clip_sample_columns(const anim_skeleton_res *s, const anim_clip_res *c, float time,
                              float *out);
// Palettes of all visible instances, by kernels (batch.c).
void anim_batch_pose(anim_world *w);
// Whether the row is to be posed now; counts the asking.
bool anim_pose_due(anim_world *w, uint32_t row);
// detail.c
bool anim_detail_skips(const anim_world *w, uint32_t row); // the palette is near enough
void anim_detail_measure(anim_world *w);                   // after a pose pass
void anim_detail_choose_probes(anim_skeleton_res *s);
// One instance by itself: the scalar reference.
void anim_pose_plain(anim_world *w, uint32_t row, core_arena *arena);
bool anim_palette_bone(const anim_world *w, uint32_t row, uint32_t bone, core_mat4 *out);
float *anim_palette_of(const anim_world *w, uint32_t row);
// The pose of an instance's present state.
void anim_evaluate(anim_world *w, uint32_t row, core_arena *arena, float *out);

// The pose of one player: of an additive layer, its difference from the clip's first pose.
void anim_evaluate_player(anim_world *w, const anim_skeleton_res *s, uint32_t player,
                          core_arena *arena, float *out);

void anim_goals_apply(const anim_skeleton_res *s, const anim_goals *goals, float *pose);

core_handle anim_snapshot_take(anim_world *w, const anim_skeleton_res *s, const float *pose);
void anim_snapshot_read(const anim_world *w, core_handle h, const anim_skeleton_res *s, float *out);
void anim_snapshot_drop(anim_world *w, core_handle h);

// ---- time ----
// What a slot plays: one clip, or two of a blend tree at one phase.
typedef struct anim_motion {
    const anim_clip_res *clip[2]; // [1] NULL: one
    core_handle handle[2];
    float weight;   // of the second
    float scale[2]; // clip seconds for a unit of the slot's time
    float length;   // of the clip in units of the slot's time
    uint32_t loop;
} anim_motion;
anim_motion anim_slot_motion(const anim_world *w, uint32_t player, const anim_slot *slot);
// The slot's time folded into [0, length] by its way of looping.
float anim_motion_time(const anim_motion *m, float time);
float anim_slot_clip_time(const anim_world *w, uint32_t player, const anim_slot *slot);
float anim_fade_weight(const anim_world *w, uint32_t player);
void anim_root_prepare(const anim_skeleton_res *s, anim_clip_res *c, bool vertical);
// Takes root motion out of the root bone's translation.
void anim_root_pin(const anim_clip_res *c, float *x, float *y, float *z);
// Displacement of the root between two clip times, model space.
core_vec3 anim_root_between(const anim_clip_res *c, float t0, float t1);
core_vec3 anim_root_translation(const anim_clip_res *c, float time);
core_key anim_track_sample(const core_clip_track *t, float time);

// Starts a fade of player `p` (row) to `to`; see the callback order in anim.h.
void anim_player_remove(anim_world *w, core_handle player);
void anim_player_start(anim_world *w, uint32_t row, uint32_t p, anim_slot to, float length,
                       anim_fade fade, bool locked);
void anim_instance_remove(anim_world *w, uint32_t row);
// Place in the palette range for one instance, reusing those given back.
bool anim_take_place(anim_world *w, anim_skeleton_res *s, uint32_t *place);
void anim_give_place(anim_skeleton_res *s, uint32_t place);

#endif
