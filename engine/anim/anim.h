// Skeletons, clips and state machines. A pose is a pure function of an instance's state (which
// clip, at what time, under which cross-fade): the state is kept in columns and hashed, poses are
// computed for the instances that are seen. SI units, seconds, radians; right-handed, +Y up.
//
// A step is two passes (design page 3): anim_world_update before physics advances time, evaluates
// transitions and calls back; anim_world_pose after it computes skinning palettes.
#ifndef ANIM_ANIM_H
#define ANIM_ANIM_H

#include "core/columns.h"
#include "core/data.h"
#include "core/jobs.h"
#include "core/metrics.h"
#include "core/stream.h"

#define ANIM_MAX_BONES      1024u
#define ANIM_MAX_STATES     256u
#define ANIM_MAX_PARAMETERS 16u // per machine
#define ANIM_MAX_EVENTS     32u // names that transitions of one machine listen to
#define ANIM_MAX_GOALS      6u
#define ANIM_MAX_LAYERS     3u  // above the base
#define ANIM_PALETTE_FLOATS 12u // 3x4 row-major: row r is {m[r][0], m[r][1], m[r][2], m[r][3]}

typedef struct anim_world anim_world;
typedef core_handle anim_skeleton; // resource
typedef core_handle anim_clip;     // resource, made for one skeleton
typedef core_handle anim_machine;  // resource: states and transitions, shared by instances
typedef core_handle anim_instance; // one animated thing
typedef core_handle anim_mask;     // resource: a weight for each bone of a skeleton

typedef struct anim_world_desc {
    core_jobs *jobs;        // NULL: serial. Borrowed
    core_metrics *metrics;  // NULL: unmeasured. Borrowed
    uint32_t max_instances; // default 1 << 16 (address space only)
    uint32_t max_bones;     // of all instances together, default 1 << 22
    uint32_t cookie;
} anim_world_desc;
anim_world_desc anim_world_desc_default(void);
anim_world *anim_world_create(const anim_world_desc *desc);
void anim_world_destroy(anim_world *world);

// Advances every instance by dt >= 0 seconds, in row order: time, transitions, callbacks, root
// motion. Callbacks may call any anim function; instances they destroy go at the end of the pass.
bool anim_world_update(anim_world *world, float dt);
// Computes the palettes of visible instances from their present state. No state changes.
void anim_world_pose(anim_world *world);
// Settings by name: "pack" = metres (0: keep clips as keys), "lod" = pixels of a picture 1,080 high
// that palettes may be behind (0: none), "batch" = on|off (off: one instance at
// a time by plain C, the baseline).
bool anim_world_set(anim_world *world, const char *name, const char *value);
int anim_world_state(const anim_world *world, const core_columns **out, int capacity);
// Fields of a saved scene (core/stream.h); what points elsewhere is checked. Skeletons, clips,
// machines and masks are not in it: the world must hold those of the one that was saved.
// When it returns false nothing of what was there is left.
bool anim_world_stream(anim_world *w, core_stream *s);
size_t anim_world_bytes(const anim_world *world);
void anim_world_counts(const anim_world *world, core_metrics *metrics); // skeletons, bones
// Largest distance (m) between the palettes last computed and a double-precision evaluation of the
// same state that shares no code with them: joint origins and points 0.1 m from them along each
// axis. Instances with layers or goals are left out. At most `sample`
// instances are looked at (0 = all). 0 when nothing is posed.
double anim_world_error_max(anim_world *world, uint32_t sample);

// ---- skeletons ----
// Copies. Refuses parents that do not come first, non-finite numbers, zero quaternions, more than
// ANIM_MAX_BONES bones.
anim_skeleton anim_skeleton_create(anim_world *world, const core_skeleton_data *data);
// False while clips or instances use it.
bool anim_skeleton_destroy(anim_world *world, anim_skeleton skeleton);
bool anim_skeleton_alive(const anim_world *world, anim_skeleton skeleton);
// Bind pose of one bone; time is 0.
bool anim_skeleton_bind(const anim_world *world, anim_skeleton skeleton, uint32_t bone,
                        core_key *out);
uint32_t anim_skeleton_bone_count(const anim_world *world, anim_skeleton skeleton); // 0: stale
// Bone by name, -1 when there is none.
int32_t anim_skeleton_find(const anim_world *world, anim_skeleton skeleton, const char *name);
const char *anim_skeleton_bone_name(const anim_world *world, anim_skeleton skeleton, uint32_t bone);
int32_t anim_skeleton_parent(const anim_world *world, anim_skeleton skeleton, uint32_t bone);
// Writes up to `capacity` children of a bone, ascending; returns how many there are.
uint32_t anim_skeleton_children(const anim_world *world, anim_skeleton skeleton, uint32_t bone,
                                uint32_t *out, uint32_t capacity);

// ---- clips ----
typedef struct anim_clip_event {
    float time;    // seconds, [0, duration]
    char name[32]; // reported by anim_world_events
} anim_clip_event;
typedef struct anim_clip_desc {
    const core_clip_data *data; // copied; keys of any spacing
    // In place of data: a compressed clip ("CAN2", see anim_clip_pack), copied.
    const void *packed;
    size_t packed_size;
    anim_skeleton skeleton; // bones without a track keep its bind pose
    // Root motion: the horizontal translation (and `root_vertical`, the vertical one) of bone
    // `root_bone` leaves the pose and is reported by anim_instance_root_motion.
    bool root_motion, root_vertical;
    uint32_t root_bone;
    const anim_clip_event *event; // any order, copied
    uint32_t event_count;
    uint32_t cookie;
} anim_clip_desc;
anim_clip_desc anim_clip_desc_default(void);
// With anim_world_set "pack" = BOUND metres, clips given as keys are compressed here.
// Refuses clips whose bone count differs from the skeleton's, unsorted or equal times, non-finite
// numbers, zero quaternions and durations that are not > 0.
anim_clip anim_clip_create(anim_world *world, const anim_clip_desc *desc);
bool anim_clip_destroy(anim_world *world, anim_clip clip);
bool anim_clip_alive(const anim_world *world, anim_clip clip);
const char *anim_clip_name(const anim_world *world, anim_clip clip);
float anim_clip_duration(const anim_world *world, anim_clip clip); // seconds; 0: stale
anim_clip anim_clip_find(const anim_world *world, anim_skeleton skeleton, const char *name);
// Keys of one bone; *count 0 when the bone has no track or the clip is compressed. Valid while the
// clip lives.
const core_key *anim_clip_keys(const anim_world *world, anim_clip clip, uint32_t bone,
                               uint32_t *count);

// Compresses a clip: uniform keys, each track within its own range in 8 or 16 bits at the clip's
// rate or less, so that every joint and every point `shell` metres from one along its axes stays
// within `bound` metres of the source. Sampling then costs the same at any time and runs in
// vectors. core_free the result, the bytes of a "CAN2" file. NULL + core_fail when the bound cannot
// be kept.
void *anim_clip_pack(const core_skeleton_data *skeleton, const core_clip_data *clip, float bound,
                     float shell, size_t *size);
// Stated error (m) and bytes of a compressed clip; false when it is kept as keys.
bool anim_clip_packed(const anim_world *world, anim_clip clip, float *error, size_t *bytes);
#define ANIM_SHELL_M 0.1f // the usual shell distance

// A local pose: arrays of bone_count elements, the caller's.
typedef struct anim_pose {
    core_vec3 *translation;
    core_quat *rotation;
    core_vec3 *scale;
} anim_pose;
// Linear interpolation between keys (rotation: slerp the short way); times outside are clamped to
// the first and last key.
bool anim_clip_sample(const anim_world *world, anim_clip clip, float time, anim_pose out);
// out = a + (b - a) * alpha for every bone, rotation nlerp the short way; alpha is clamped to
// [0, 1]; 0 and 1 give the ends bit for bit. out may be a or b.
void anim_pose_blend(anim_pose a, anim_pose b, float alpha, uint32_t bone_count, anim_pose out);
// Interpolation of two keys at alpha in [0, 1] (the report's interpolateKeyframes).
core_key anim_key_interpolate(const core_key *a, const core_key *b, float alpha);
// Model-space matrices of a local pose, [bone_count].
bool anim_pose_to_model(const anim_world *world, anim_skeleton skeleton, anim_pose pose,
                        core_mat4 *model);
// palette[bone] = model * inverse bind, ANIM_PALETTE_FLOATS each.
bool anim_model_to_palette(const anim_world *world, anim_skeleton skeleton, const core_mat4 *model,
                           float *palette);
// Linear blend skinning on the processor, the reference for the GPU. normal may be NULL. Each
// output is [vertex_count*3].
bool anim_skin(const core_mesh_data *mesh, const float *palette, uint32_t bone_count,
               float *position, float *normal);

// ---- state machines ----
// Callbacks get the ctx of their state or transition. A condition returns whether to go.
typedef bool anim_condition_fn(void *ctx, anim_world *world, anim_instance instance);
typedef void anim_state_fn(void *ctx, anim_world *world, anim_instance instance);
typedef void anim_tick_fn(void *ctx, anim_world *world, anim_instance instance, float dt);
// Factor on the playing speed; `phase` in [0, 1] is the place in the clip. Non-finite results
// count as 1.
typedef float anim_speed_fn(void *ctx, anim_world *world, anim_instance instance, float phase);

typedef enum anim_loop { ANIM_LOOP, ANIM_ONCE, ANIM_PING_PONG } anim_loop;
// A point of a 1D blend tree: below the first and beyond the last value that end plays alone,
// between two points both play at the same phase, weighted, with their durations blended likewise.
typedef struct anim_blend_point {
    anim_clip clip;
    float value;
} anim_blend_point;
// A state with neither clip nor blend tree holds a machine within: the states that name it, of
// which the first is where it is entered. Transitions from it leave any of them.
typedef struct anim_state_desc {
    const char *name;   // unique in the machine
    const char *within; // state listed before it that holds this one; NULL: none
    anim_clip clip;
    const anim_blend_point *blend; // in place of clip: ascending values, looping clips
    uint32_t blend_count;
    const char *blend_parameter; // of the machine
    anim_loop loop;
    float speed; // 0: 1; negative plays backwards
    anim_state_fn *on_enter, *on_exit;
    anim_tick_fn *on_tick;
    anim_speed_fn *speed_fn;
    void *ctx;
} anim_state_desc;

typedef enum anim_when {
    ANIM_WHEN_FINISHED,  // time + length >= duration: the fade ends as the clip (or its cycle) does
    ANIM_WHEN_CONDITION, // `condition` returns true
    ANIM_WHEN_EVENT,     // anim_instance_send of `event` since the last update
    ANIM_WHEN_PARAMETER  // parameter OP value
} anim_when;
typedef enum anim_compare {
    ANIM_GREATER,
    ANIM_LESS,
    ANIM_GREATER_EQUAL,
    ANIM_LESS_EQUAL,
    ANIM_EQUAL,
    ANIM_NOT_EQUAL
} anim_compare;
typedef enum anim_fade {
    ANIM_FADE_LINEAR,
    ANIM_FADE_SMOOTH // 3s^2 - 2s^3: cubic Hermite with zero end slopes
} anim_fade;
typedef struct anim_transition_desc {
    const char *from, *to; // from NULL: any state but `to` and those in it
    anim_when when;
    anim_condition_fn *condition;
    void *ctx;
    const char *event;
    const char *parameter;
    anim_compare compare;
    float value;
    float length; // seconds of the cross-fade, >= 0; 0 cuts
    anim_fade fade;
    bool uninterruptible; // no other transition starts before this one ends
    bool sync;            // the target starts at the phase of the state left
} anim_transition_desc;
typedef struct anim_parameter_desc {
    const char *name;
    float value; // at the start
} anim_parameter_desc;
typedef struct anim_machine_desc {
    const char *initial; // NULL: the first state
    const anim_state_desc *state;
    uint32_t state_count;                   // 1..ANIM_MAX_STATES
    const anim_transition_desc *transition; // the first that matches goes, in this order
    uint32_t transition_count;
    const anim_parameter_desc *parameter;
    uint32_t parameter_count;
    uint32_t cookie;
} anim_machine_desc;
anim_machine_desc anim_machine_desc_default(void);
// All clips must be of one skeleton. Errors name the state or transition and the nearest name.
anim_machine anim_machine_create(anim_world *world, const anim_machine_desc *desc);
// Adds states and transitions to a machine that may be in use: all of them, or none (false). They
// come after those it has and may name them; `initial` and parameters stay empty. Not to be called
// from callbacks of a machine.
bool anim_machine_extend(anim_world *world, anim_machine machine, const anim_machine_desc *more);
// Takes such additions back: keeps the first states and transitions. False while one of the others
// plays, or leads from or to.
bool anim_machine_trim(anim_world *world, anim_machine machine, uint32_t states,
                       uint32_t transitions);
void anim_machine_size(const anim_world *world, anim_machine machine, uint32_t *states,
                       uint32_t *transitions);
// One state and one transition, for those who draw the machine: false beyond the last. Names live
// as long as the machine; `within` and `from` are "" without one.
bool anim_machine_state_at(const anim_world *world, anim_machine machine, uint32_t i,
                           const char **name, const char **within);
bool anim_machine_transition_at(const anim_world *world, anim_machine machine, uint32_t i,
                                const char **from, const char **to);
bool anim_machine_destroy(anim_world *world, anim_machine machine); // false while in use
bool anim_machine_alive(const anim_world *world, anim_machine machine);
// Graphviz text of the machine; core_free it. `instance` (null: none) marks its present state.
char *anim_machine_dot(const anim_world *world, anim_machine machine, anim_instance instance);

// Callback order. A transition starting from A to B: (when another was running, onExit of the state
// it was leaving), onEnter(B). At its end: onExit(A). Zero length does both at once: onExit(A)
// comes first. onTick(current state) follows each update's transitions. B is the current state from
// the start of the transition on; a later transition interrupts it from a snapshot of the blended
// pose. A state that holds others is entered before the first of them and left after the last; a
// step from one of its states to another does neither. Its onTick comes before theirs, its speed is
// a factor on theirs. It is finished when the state played in it is and no transition leads on: its
// own ANIM_WHEN_FINISHED come after all others, whatever the order.

// ---- instances ----
typedef struct anim_instance_desc {
    anim_skeleton skeleton;
    anim_machine machine; // null: `clip` is played, or the bind pose
    anim_clip clip;
    anim_loop loop; // of clip
    float time;     // start, seconds
    float speed;    // 0: 1; use anim_instance_set_speed to stop
    uint64_t user;  // the caller's own, never read
    uint32_t cookie;
} anim_instance_desc;
anim_instance_desc anim_instance_desc_default(void);
anim_instance anim_instance_create(anim_world *world, const anim_instance_desc *desc);
bool anim_instance_destroy(anim_world *world, anim_instance instance);
bool anim_instance_alive(const anim_world *world, anim_instance instance);
uint64_t anim_instance_user(const anim_world *world, anim_instance instance);
bool anim_instance_set_user(anim_world *world, anim_instance instance, uint64_t user);
uint32_t anim_instance_bone_count(const anim_world *world, anim_instance instance);
anim_skeleton anim_instance_skeleton(const anim_world *world, anim_instance instance);

// Layers above the base, 1..ANIM_MAX_LAYERS, applied in order: each bone goes from the pose below
// to the layer's by weight * mask. An additive layer adds its clip's difference from that clip's
// first pose instead. Setting a layer replaces it; one with neither machine nor clip removes it.
// Not from callbacks.
typedef struct anim_layer_desc {
    anim_machine machine; // null: `clip`
    anim_clip clip;
    anim_loop loop; // of clip
    anim_mask mask; // null: all bones
    float weight;   // [0, 1]; 0: 1, use anim_instance_set_layer_weight to hide it
    bool additive;
    uint32_t cookie;
} anim_layer_desc;
anim_layer_desc anim_layer_desc_default(void);
bool anim_instance_set_layer(anim_world *world, anim_instance instance, uint32_t layer,
                             const anim_layer_desc *desc);
bool anim_instance_set_layer_weight(anim_world *world, anim_instance instance, uint32_t layer,
                                    float weight);
// weight[bone_count] in [0, 1], copied.
anim_mask anim_mask_create(anim_world *world, anim_skeleton skeleton, const float *weight);
bool anim_mask_destroy(anim_world *world, anim_mask mask); // false while in use
bool anim_mask_alive(const anim_world *world, anim_mask mask);

// Leaves the machine's choice for `clip` (or plays on an instance without one), fading over
// `length` seconds from the pose of this moment.
bool anim_instance_play(anim_world *world, anim_instance instance, anim_clip clip, anim_loop loop,
                        float length, anim_fade fade);
// Forces a state of the machine, as a transition would.
bool anim_instance_go(anim_world *world, anim_instance instance, const char *state, float length,
                      anim_fade fade);
bool anim_instance_set_time(anim_world *world, anim_instance instance, float time);
float anim_instance_time(const anim_world *world, anim_instance instance); // current clip, seconds
bool anim_instance_set_speed(anim_world *world, anim_instance instance, float speed);
bool anim_instance_finished(const anim_world *world, anim_instance instance); // time >= duration
// Parameters and events reach the machines of all its layers that know the name.
bool anim_instance_set_parameter(anim_world *world, anim_instance instance, const char *name,
                                 float value);
bool anim_instance_parameter(const anim_world *world, anim_instance instance, const char *name,
                             float *out);
bool anim_instance_send(anim_world *world, anim_instance instance, const char *event);
anim_machine anim_instance_machine(const anim_world *world, anim_instance instance); // null: none
// Whether the named state is the current one or holds it.
bool anim_instance_in(const anim_world *world, anim_instance instance, const char *state);
const char *anim_instance_state(const anim_world *world, anim_instance instance); // "" without one
// Progress [0, 1) of a running cross-fade and the state left; 1 when none runs.
float anim_instance_fade(const anim_world *world, anim_instance instance, const char **from);
// Transitions that could start from the current state, in order: their target names. Returns how
// many there are.
uint32_t anim_instance_transitions(const anim_world *world, anim_instance instance, const char **to,
                                   uint32_t capacity);
// Instances that are not visible keep their state machine running and are not posed.
bool anim_instance_set_visible(anim_world *world, anim_instance instance, bool visible);
// Level of detail: the pose is computed at every n-th anim_world_pose only, 1..64; between them the
// palette stays. Instances take turns. anim_world_error_max then shows what it costs in metres.
bool anim_instance_set_rate(anim_world *world, anim_instance instance, uint32_t every);
// Level of detail by what can be seen: the palette may be so many metres (of the model's own)
// behind the pose; 0: never; INFINITY: it is not seen and not posed. How fast it moves is measured
// at the joints farthest from the root, so that a calm crowd is posed seldom and a runner in front
// always. Fades are never behind, nor is an instance whose bones were asked for: the simulation
// sees no difference.
bool anim_instance_set_tolerance(anim_world *world, anim_instance instance, float tolerance);
// How far the palette is behind by that measure, m; 0 when it was posed last.
float anim_instance_behind(const anim_world *world, anim_instance instance);
uint32_t anim_world_posed(const anim_world *world); // instances posed by the last anim_world_pose
// Of a sphere about the model's origin that holds the bind pose, m, roughly.
float anim_instance_radius(const anim_world *world, anim_instance instance);
float anim_world_lod(const anim_world *world); // setting "lod": pixels, which scene turns to metres
// Displacement of the root in the last update, in the instance's own frame.
bool anim_instance_root_motion(const anim_world *world, anim_instance instance, core_vec3 *out);

// Goals bend the finished pose, in order of their number. ANIM_GOAL_REACH: the bone and the two
// above it are a limb whose tip goes to the target, as near as its length allows. ANIM_GOAL_LOOK:
// the bone's axis turns to the target. ANIM_GOAL_SHIFT: as reach, to where the pose without goals
// has the tip, plus the target. ANIM_GOAL_MOVE: the bone and all below it move by the target,
// before the other goals.
typedef enum anim_goal_kind {
    ANIM_GOAL_REACH,
    ANIM_GOAL_LOOK,
    ANIM_GOAL_SHIFT,
    ANIM_GOAL_MOVE
} anim_goal_kind;
typedef struct anim_goal_desc {
    anim_goal_kind kind;
    uint32_t bone;
    core_vec3 target;   // m, in the model's frame
    core_vec3 pole;     // reach: direction the middle joint points to; zero: as in the pose
    core_vec3 axis;     // look: the bone's own forward, default +Z
    float limit;        // look: most it turns, rad; 0: any
    float weight;       // [0, 1]; 0 removes the goal
    bool keep_rotation; // reach: the tip keeps its rotation in the model's frame
    uint32_t cookie;
} anim_goal_desc;
anim_goal_desc anim_goal_desc_default(anim_goal_kind kind);
bool anim_instance_set_goal(anim_world *world, anim_instance instance, uint32_t goal,
                            const anim_goal_desc *desc);

// A pose from outside (a ragdoll's) laid over everything else with a weight in [0, 1]. NULL: the
// pose given last, with another weight; weight 0 drops it.
bool anim_instance_set_external(anim_world *world, anim_instance instance, const anim_pose *pose,
                                float weight);

// Local pose of this moment, evaluated now.
bool anim_instance_pose(anim_world *world, anim_instance instance, anim_pose out);
// Palette of the last anim_world_pose: bone_count * ANIM_PALETTE_FLOATS floats, valid until the
// next create, destroy or pose. NULL before the first.
const float *anim_instance_palette(const anim_world *world, anim_instance instance,
                                   uint32_t *bone_count);
// Model-space matrix of a bone at the last anim_world_pose, or of this moment before the first
// (attachment points).
bool anim_instance_bone(anim_world *world, anim_instance instance, uint32_t bone, core_mat4 *out);
// Rows for loops over all instances, in creation order until something is destroyed.
uint32_t anim_instance_count(const anim_world *world);
anim_instance anim_instance_at(const anim_world *world, uint32_t row);

// Clip events passed in the last update, in row order then time order. Loops, backward play and
// steps longer than the clip report each passing.
typedef struct anim_event {
    anim_instance instance;
    anim_clip clip;
    const char *name; // valid while the clip lives
    float time;
} anim_event;
uint32_t anim_world_events(const anim_world *world, const anim_event **out);

#endif
