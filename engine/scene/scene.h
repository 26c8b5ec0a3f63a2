// Joins the rooms: entities with SoA transforms, components as handles into the rooms, and the
// order of a step (design page 3). Rooms are made at first touch: an untouched room costs nothing.
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "anim/anim.h"
#include "audio/audio.h"
#include "core/columns.h"
#include "core/jobs.h"
#include "core/metrics.h"
#include "core/rng.h"
#include "core/stream.h"
#include "core/vfs.h"
#include "gfx/gfx.h"
#include "nav/nav.h"
#include "phys/phys.h"

#define SCENE_NAME_MAX 64 // bytes with the terminating zero; longer names are refused

typedef struct scene scene;
typedef core_handle scene_entity;

// What script (or a C program) hears of a step. Any may be NULL.
typedef struct scene_hooks {
    void *ctx;
    void (*fixed)(void *ctx, float dt);
    void (*events)(void *ctx); // after physics: trigger and contact events may be read
} scene_hooks;

typedef struct scene_desc {
    core_jobs *jobs;
    core_metrics *metrics;
    core_vfs *vfs;
    uint64_t seed;
    float dt;              // s, default 1/60
    uint32_t max_entities; // default 1 << 20
    uint32_t cookie;
} scene_desc;
scene_desc scene_desc_default(void);
scene *scene_create(const scene_desc *desc);
void scene_destroy(scene *s);
void scene_set_hooks(scene *s, const scene_hooks *hooks);
// What conf may still change: workers (borrowed), seed and step length (s, finite, > 0, <= 1).
// False + core_fail once a room, an entity or a step exists.
bool scene_configure(scene *s, core_jobs *jobs, uint64_t seed, float dt);

// The rooms. `scene_phys` makes the world on first call; `_if` gives NULL when untouched. Settings
// kept by scene_setting are applied when the room is made.
phys_world *scene_phys(scene *s);
phys_world *scene_phys_if(const scene *s);
gfx_world *scene_gfx(scene *s);
gfx_world *scene_gfx_if(const scene *s);
anim_world *scene_anim(scene *s);
anim_world *scene_anim_if(const scene *s);
nav_world *scene_nav(scene *s);
nav_world *scene_nav_if(const scene *s);
audio_world *scene_audio(scene *s);
audio_world *scene_audio_if(const scene *s);
core_metrics *scene_metrics(const scene *s);
core_vfs *scene_vfs(const scene *s);
core_rng *scene_rng(scene *s, uint64_t stream); // CORE_RNG_SIM, CORE_RNG_VIEW

// "phys.solver=soft" and the like: room prefix, dot, name. Applies now when the room exists and to
// rooms made later. False + core_fail for unknown rooms, names or values.
bool scene_setting(scene *s, const char *name, const char *value);

// Rooms that this build has: "scene", "script", "phys", "gfx", ... false for others.
bool scene_room_built(const char *room);

// One fixed step: hooks.fixed, navigation and state machines, physics, hooks.events, poses, audio.
bool scene_step(scene *s);
uint64_t scene_step_index(const scene *s); // steps done
float scene_dt(const scene *s);

// Number of a collision layer by name, 0..31; "default" is 0, a new name takes the next. -1 +
// core_fail when all are taken or the name is empty or too long.
int scene_layer(scene *s, const char *name);
const char *scene_layer_name(const scene *s, uint32_t layer); // "" when it has none

// ---- feet on the ground ----
// Each step, before the poses, a ray down finds the ground under each foot; the foot then stands as
// high above it as the animation has it above the model's origin, and the root sinks as far as the
// lowest foot needs. Takes the animation's goals 0..count-1 for the feet and `count` for the root.
typedef struct scene_feet_desc {
    uint32_t bone[4]; // ends of limbs of two bones
    uint32_t count;   // 1..4
    uint32_t root;    // bone that carries the body: hips
    float up, down;   // m above and below the entity in which ground counts, default 0.5
    float speed;      // m/s at which a foot follows the ground, default 2
    uint32_t layers;  // bit per layer that is ground, 0: all; the entity's own body is not
} scene_feet_desc;
// NULL: the animation has its feet to itself again.
bool scene_set_feet(scene *s, scene_entity e, const scene_feet_desc *desc);

// ---- ragdolls ----
// Hands an animated entity to physics: in the step that follows, each bone that is long enough
// becomes a body with the place and speed that the animation gave it. While it falls the bodies
// give the pose and the entity follows them. A body of the entity's own should be in a layer that
// does not meet theirs.
typedef struct scene_ragdoll_desc {
    float mass;     // kg in all, default 70
    float least;    // m: shorter bones move with the one above, default 0.02
    uint32_t layer; // of the bodies
} scene_ragdoll_desc;
bool scene_ragdoll_start(scene *s, scene_entity e, const scene_ragdoll_desc *desc);
// Ends it: the bodies go, and the pose that it fell into turns into the animation's over `length`
// s.
bool scene_ragdoll_stop(scene *s, scene_entity e, float length);
// Its bodies, parents first; returns how many there are: none before its first step.
uint32_t scene_ragdoll_bodies(const scene *s, scene_entity e, phys_body *out, uint32_t capacity);

// ---- models ----
// Any other model file (.glb, .fbx, ...) is first converted into the user's cache by
// libcorsac-convert.so, where that is installed.
// Reads a .cmodel and what it names (meshes, materials, skeleton, clips) into the rooms; the same
// path gives the same model again. Null + core_fail when any part is missing or bad: then nothing
// stays loaded.
typedef core_handle scene_model;
scene_model scene_model_load(scene *s, const char *path);
bool scene_model_alive(const scene *s, scene_model model);
anim_skeleton scene_model_skeleton(const scene *s, scene_model model); // null without one
uint32_t scene_model_clip_count(const scene *s, scene_model model);
anim_clip scene_model_clip(const scene *s, scene_model model, uint32_t i);
// By name; null + core_fail naming the nearest.
anim_clip scene_model_find_clip(const scene *s, scene_model model, const char *name);

// ---- sound ----
// Reads a WAV or Ogg Vorbis file; the same path gives the same sound again. Null + core_fail.
audio_sound scene_sound_load(scene *s, const char *path);
// The source follows the entity from now on (position, and velocity for Doppler), is destroyed with
// it, and takes the place of the one it had.
bool scene_set_sound(scene *s, scene_entity e, audio_source source);
// Who hears: an entity (its -Z looks ahead), or the camera when null (so it is at the start).
bool scene_set_listener(scene *s, scene_entity e);
// A fixed place instead.
void scene_place_listener(scene *s, const audio_listener *listener);

typedef struct scene_spawn_desc {
    core_vec3 position; // m; relative to the parent
    core_quat rotation; // zero: identity; relative to the parent
    core_vec3 scale;    // zero: 1; acts on the mesh and on children, never on the body
    // null: none. Children are despawned with it. An entity with a body is placed by its parent
    // once, then the body leads.
    scene_entity parent;
    const phys_body_desc *body; // NULL: none; position and rotation are the entity's
    const phys_shape_desc *shapes;
    uint32_t shape_count;
    gfx_instance_desc *draw; // NULL: not drawn
    core_vec3 draw_scale;    // size of the unit mesh; zero: 1
    const char *name;        // NULL: none; need not be unique
    uint64_t tags;           // bits of scene_tag
    // A model made by scene_model_load: its first mesh on the entity, further ones on children.
    // With a skeleton the entity gets an animation instance that plays machine, clip or the bind
    // pose. Excludes `draw`.
    scene_model model;
    anim_machine machine;
    anim_clip clip;
    uint32_t cookie;
} scene_spawn_desc;
scene_spawn_desc scene_spawn_desc_default(void);
scene_entity scene_spawn(scene *s, const scene_spawn_desc *desc);
bool scene_despawn(scene *s, scene_entity e);
bool scene_alive(const scene *s, scene_entity e);
uint32_t scene_entity_count(const scene *s);
phys_body scene_entity_body(const scene *s, scene_entity e);
gfx_instance scene_entity_instance(const scene *s, scene_entity e);
scene_entity scene_entity_of_body(const scene *s, phys_body body);
anim_instance scene_entity_anim(const scene *s, scene_entity e); // null: not animated
// Gives the entity an agent (destroyed with it). Without a body the entity goes where the agent
// goes and looks along its heading; a body is given the agent's velocity on the ground, and the
// agent is where the body is. offset: height of the entity's origin above the agent's point, m.
bool scene_set_agent(scene *s, scene_entity e, nav_agent agent, float offset);
// The agent is where the mover is (its centre `offset` m above the agent's point), and says where
// the mover walks.
bool scene_lead_mover(scene *s, nav_agent agent, phys_mover mover, float offset);
nav_agent scene_entity_agent(const scene *s, scene_entity e); // null: none
scene_entity scene_entity_of_agent(const scene *s, nav_agent agent);
scene_entity scene_entity_of_anim(const scene *s, anim_instance instance);
// A walkable surface (nav.h) made from the bodies of the physics world. Bodies that are made, moved
// or destroyed later change it from the next step on.
typedef struct scene_surface_desc {
    nav_mesh_desc nav; // default: in tiles of 64 cells; bounds equal: those of the bodies
    uint32_t layers;   // bit per body layer that counts; 0: all
    bool kinematic;    // kinematic bodies count where they have rested for six steps
    float tolerance;   // m by which round shapes may be cut flat, default 0.02
    uint32_t cookie;
} scene_surface_desc;
scene_surface_desc scene_surface_desc_default(void);
// Debug lines for the next frame; search: what the last one looked at, too.
void scene_draw_surface(scene *s, nav_mesh mesh, bool search);
void scene_draw_graph(scene *s, nav_graph graph, bool search);
void scene_draw_agents(scene *s);                                        // and all paths
nav_mesh scene_surface_create(scene *s, const scene_surface_desc *desc); // null + core_fail
// Gives the entity an animation instance (destroyed with it). Its meshes follow the palette; root
// motion moves the entity, or sets the horizontal velocity of its body.
bool scene_set_anim(scene *s, scene_entity e, anim_instance instance);
const char *scene_entity_name(const scene *s, scene_entity e); // "" when it has none or is stale
scene_entity scene_find(const scene *s, const char *name);     // oldest with that name, or null
scene_entity scene_parent(const scene *s, scene_entity e);
scene_entity scene_entity_at(const scene *s, uint32_t row); // row < scene_entity_count
// Keeps the world pose. Null parent: a root. False + core_fail for stale handles and cycles.
bool scene_set_parent(scene *s, scene_entity e, scene_entity parent);

bool scene_position(const scene *s, scene_entity e, core_vec3 *out); // world
bool scene_rotation(const scene *s, scene_entity e, core_quat *out); // world
bool scene_set_position(scene *s, scene_entity e,
                        core_vec3 p); // teleports the body, resets interpolation
bool scene_set_rotation(scene *s, scene_entity e, core_quat q);
bool scene_set_scale(scene *s, scene_entity e, core_vec3 v);

// The emitter follows the entity from now on, and gives no more particles once the entity is gone.
bool scene_set_emitter(scene *s, scene_entity e, gfx_emitter emitter);

// How many children without bodies the last step placed anew: those below something that moved.
uint32_t scene_moved(const scene *s);

// ---- tags and queries ----
#define SCENE_MAX_TAGS 64
// Number of a tag by name, 0..63; a new name takes the next. -1 + core_fail when all are taken or
// the name is empty or too long.
int scene_tag(scene *s, const char *name);
bool scene_set_tag(scene *s, scene_entity e, const char *name, bool on);
bool scene_has_tag(const scene *s, scene_entity e, const char *name); // false when stale

enum {
    SCENE_HAS_BODY = 1u,
    SCENE_HAS_MESH = 2u,
    SCENE_HAS_ANIM = 4u,
    SCENE_HAS_AGENT = 8u,
    SCENE_HAS_SOUND = 16u
};
typedef struct scene_query {
    uint64_t tags, without; // bits of scene_tag: all of these, none of those
    uint32_t has;           // SCENE_HAS_*: all of these
    core_vec3 min, max;     // origins in this box (m); default everywhere
    core_vec3 center;       // and at most `radius` from here
    float radius;           // m; default infinite
    uint32_t cookie;
} scene_query;
scene_query scene_query_default(void);
// Entities that match, in the order of rows: out[capacity] gets the first. Returns how many match.
uint32_t scene_find_all(const scene *s, const scene_query *query, scene_entity *out,
                        uint32_t capacity);

// Writes interpolated transforms into gfx: alpha 0 = previous step, 1 = current. Changes no
// simulation state. No-op without gfx.
void scene_sync_draw(scene *s, float alpha);

// The pose that scene_sync_draw shows: for cameras and listeners that follow an entity. False when
// stale. Previous poses are kept only once something is drawn (scene_gfx).
bool scene_draw_pose(const scene *s, scene_entity e, float alpha, core_vec3 *p, core_quat *q);

// Column sets of all rooms in a fixed order, for hash, save and divergence reports.
int scene_state(const scene *s, const core_columns **out, int capacity);
uint64_t scene_hash(const scene *s);
// "phys.bodies row 12 (entity 'ball', handle 13:1)": names one row of a set that scene_state gave;
// a row beyond the last gives "phys.bodies (no single row)".
void scene_describe_row(const scene *s, const core_columns *set, uint32_t row, char *out,
                        size_t size);
// ---- saved scenes ----
// The state of every room, what shows it, and `script` (text of the caller's, NULL: none) as one
// block, binary ("CSV1", with a checksum) or Lua text. core_free the result.
void *scene_save(scene *s, core_stream_form form, const char *script, size_t *size);
// Makes the scene what it was: the hash after a load is the one at the save. Models, sounds,
// surfaces and machines are not in a save; the scene must have those it had, as one has that ran
// the same code. *script: the text given to save, core_free it. False + core_fail naming file and
// field for data that is cut short, damaged or of another scene: the scene is then as before.
bool scene_load(scene *s, const char *name, const void *data, size_t size, char **script);

// counts, memory by room (bytes) for metrics.
void scene_counts(const scene *s);
typedef struct scene_memory {
    size_t core, phys, gfx, anim, nav, audio;
} scene_memory;
scene_memory scene_memory_use(const scene *s);

#endif
