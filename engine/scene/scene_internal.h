// What the files of engine/scene share.
#ifndef SCENE_SCENE_INTERNAL_H
#define SCENE_SCENE_INTERNAL_H

#include "scene/scene.h"

// Local transform and links are state; world and previous transforms follow from them and from the
// bodies, so they are neither hashed nor saved. An entity with a body takes its world pose from the
// body: its local columns then keep the pose it was spawned with.
#define SCENE_ENTITY_COLUMNS(X)                                                                    \
    X(float, px, CORE_COLUMN_STATE)                                                                \
    X(float, py, CORE_COLUMN_STATE)                                                                \
    X(float, pz, CORE_COLUMN_STATE)                                                                \
    X(float, qx, CORE_COLUMN_STATE)                                                                \
    X(float, qy, CORE_COLUMN_STATE)                                                                \
    X(float, qz, CORE_COLUMN_STATE)                                                                \
    X(float, qw, CORE_COLUMN_STATE)                                                                \
    X(float, sx, CORE_COLUMN_STATE)                                                                \
    X(float, sy, CORE_COLUMN_STATE)                                                                \
    X(float, sz, CORE_COLUMN_STATE)                                                                \
    X(core_handle, parent, CORE_COLUMN_STATE)                                                      \
    X(core_handle, first_child, CORE_COLUMN_STATE)                                                 \
    X(core_handle, next_sibling, CORE_COLUMN_STATE)                                                \
    X(core_handle, prev_sibling, CORE_COLUMN_STATE)                                                \
    X(uint32_t, depth, CORE_COLUMN_STATE)                                                          \
    X(core_handle, body, CORE_COLUMN_STATE)                                                        \
    X(uint64_t, tags, CORE_COLUMN_STATE)                                                           \
    X(core_handle, name, CORE_COLUMN_STATE)                                                        \
    X(core_handle, anim, CORE_COLUMN_STATE)   /* owned */                                          \
    X(core_handle, agent, CORE_COLUMN_STATE)  /* owned */                                          \
    X(float, agent_offset, CORE_COLUMN_STATE) /* of the entity above its agent, m */               \
    X(core_handle, source, CORE_COLUMN_STATE) /* of sound, owned */                                \
    X(core_handle, skin, 0)                   /* whose palette its mesh follows */                 \
    X(float, wpx, 0)                                                                               \
    X(float, wpy, 0)                                                                               \
    X(float, wpz, 0)                                                                               \
    X(float, wqx, 0)                                                                               \
    X(float, wqy, 0)                                                                               \
    X(float, wqz, 0)                                                                               \
    X(float, wqw, 0)                                                                               \
    X(float, wsx, 0)                                                                               \
    X(float, wsy, 0)                                                                               \
    X(float, wsz, 0)                                                                               \
    X(float, opx, 0)                                                                               \
    X(float, opy, 0)                                                                               \
    X(float, opz, 0)                                                                               \
    X(float, oqx, 0)                                                                               \
    X(float, oqy, 0)                                                                               \
    X(float, oqz, 0)                                                                               \
    X(float, oqw, 0)                                                                               \
    X(uint64_t, changed, 0) /* `moves` when its place or parent last changed */                    \
    X(scene_drawn, drawn, 0)                                                                       \
    X(core_handle, instance, 0)                                                                    \
    X(float, dx, 0)                                                                                \
    X(float, dy, 0)                                                                                \
    X(float, dz, 0)

typedef struct scene_drawn { // what an instance was last given
    core_vec3 position;
    core_quat rotation;
    core_vec3 size;
} scene_drawn;
CORE_COLUMNS_DECLARE(scene_entities, SCENE_ENTITY_COLUMNS)

typedef struct scene_name_text {
    char text[SCENE_NAME_MAX]; // zero-padded: the whole array is hashed
} scene_name_text;
#define SCENE_NAME_COLUMNS(X)                                                                      \
    X(scene_name_text, text, CORE_COLUMN_STATE)                                                    \
    X(core_handle, entity, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(scene_names, SCENE_NAME_COLUMNS)

// One row: what the scene itself remembers from step to step.
#define SCENE_CLOCK_COLUMNS(X)                                                                     \
    X(uint64_t, step, CORE_COLUMN_STATE)                                                           \
    X(core_rng, sim, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(scene_clock, SCENE_CLOCK_COLUMNS)

// Feet that stand on the ground: one row an entity (scene_feet.c).
#define SCENE_MAX_FEET 4
typedef struct scene_feet_set {
    uint32_t bone[SCENE_MAX_FEET], count, root, layers;
    float up, down, speed; // m, m, m/s
} scene_feet_set;
typedef struct scene_feet_now {
    float offset[SCENE_MAX_FEET], lowered; // m, of each foot and of the root
} scene_feet_now;
#define SCENE_FEET_COLUMNS(X)                                                                      \
    X(scene_entity, entity, CORE_COLUMN_STATE)                                                     \
    X(scene_feet_set, how, CORE_COLUMN_STATE)                                                      \
    X(scene_feet_now, now, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(scene_feet, SCENE_FEET_COLUMNS)

// Skeletons that physics moves: one row an entity (scene_ragdoll.c).
#define SCENE_RAGDOLL_BONES 48
typedef struct scene_ragdoll_how {
    float mass, least;
    uint32_t layer;
} scene_ragdoll_how;
typedef struct scene_ragdoll_parts {
    uint32_t count, bone[SCENE_RAGDOLL_BONES]; // ascending
    phys_body body[SCENE_RAGDOLL_BONES];
} scene_ragdoll_parts;
typedef struct scene_ragdoll_was { // bones a step before the bodies
    core_vec3 position[SCENE_RAGDOLL_BONES];
    core_quat rotation[SCENE_RAGDOLL_BONES];
} scene_ragdoll_was;
#define SCENE_RAGDOLL_COLUMNS(X)                                                                   \
    X(scene_entity, entity, CORE_COLUMN_STATE)                                                     \
    X(uint32_t, phase, CORE_COLUMN_STATE)                                                          \
    X(float, weight, CORE_COLUMN_STATE)                                                            \
    X(float, length, CORE_COLUMN_STATE)                                                            \
    X(scene_ragdoll_how, how, CORE_COLUMN_STATE)                                                   \
    X(scene_ragdoll_parts, parts, CORE_COLUMN_STATE)                                               \
    X(scene_ragdoll_was, was, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(scene_ragdolls, SCENE_RAGDOLL_COLUMNS)

typedef struct scene_kept_setting { // given before its room was made
    char room[16], name[48], value[64];
} scene_kept_setting;
#define SCENE_MAX_SETTINGS 128
#define SCENE_TAG_NAME     32
#define SCENE_LAYER_NAME   32 // bytes with the terminating zero

typedef struct scene_led { // a mover that an agent leads
    nav_agent agent;
    phys_mover mover;
    float offset; // of its centre above the agent, m
} scene_led;
typedef struct scene_surface scene_surface;
typedef struct scene_models scene_models;
typedef struct scene_sounds scene_sounds;

struct scene {
    uint64_t moves;       // raised by every step, once children have followed
    uint32_t moved_count; // of children in the last step
    core_jobs *jobs;
    core_metrics *metrics;
    core_vfs *vfs;
    uint64_t seed;
    float dt;
    scene_hooks hooks;
    scene_entities entity;
    scene_names name;
    scene_clock clock;
    scene_feet feet;
    bool stands; // some entity has, or had, feet
    scene_ragdolls ragdoll;
    bool falls; // some entity is, or was, a ragdoll
    core_rng view_rng;
    phys_world *phys;
    gfx_world *gfx;
    anim_world *anim;
    nav_world *nav;
    audio_world *audio;
    scene_led *led; // [led_count]
    uint32_t led_count;
    nav_obstacle *obstacle; // [obstacle_room] bodies that agents go round
    uint32_t obstacle_room;
    scene_surface *surface; // [surface_count] walkable surfaces made from bodies
    uint32_t surface_count;
    core_vec3 *soup_corner; // [3 * soup_room] triangles of one body
    uint32_t *soup_index;
    uint32_t soup_room;
    scene_sounds *sounds;  // made with the first one
    scene_entity listener; // null: the camera, unless listener_placed
    bool listener_placed;
    bool sounding;               // some entity has, or had, a source
    scene_models *models;        // made with the first one
    scene_kept_setting *setting; // [SCENE_MAX_SETTINGS], made with the first one
    uint32_t setting_count;
    char layer[32][SCENE_LAYER_NAME]; // names of collision layers
    uint32_t layer_count;
    char (*tag)[SCENE_TAG_NAME]; // [SCENE_MAX_TAGS] names, made with the first one
    uint32_t tag_count;
    uint32_t *order; // rows with a parent, parents before children; rebuilt when links change
    uint32_t order_count, order_capacity;
    uint32_t *depth_start; // [depth_capacity] counting sort's scratch
    uint32_t depth_capacity;
    bool order_stale;
};

uint32_t scene_row(const scene *s, scene_entity e); // CORE_NO_ROW + core_fail when stale
// scene_settings.c: gives a room that was just made what was set for it before
void scene_settings_apply(const scene *s, const char *room, void *world);
// scene_hierarchy.c
void scene_link(scene *s, uint32_t row, scene_entity parent);
void scene_unlink(scene *s, uint32_t row);
void scene_world_of(scene *s, uint32_t row);         // world from parent and local
void scene_local_from_world(scene *s, uint32_t row); // the inverse
void scene_world_of_children(scene *s);              // all rows with a parent, parents first
void scene_subtree_moved(scene *s, scene_entity e);  // worlds below e; interpolation reset
void scene_interpolation_reset(scene *s, uint32_t row);
// scene_anim.c
void scene_anim_update(scene *s); // state machines and root motion, before physics
void scene_anim_pose(scene *s);   // palettes, after physics
void scene_anim_sync(scene *s);   // palettes into gfx
void scene_anim_leave(scene *s, uint32_t row);
bool scene_add_model(scene *s, uint32_t row, const scene_spawn_desc *d);
// scene_surface.c
void scene_surfaces_keep_up(scene *s);
void scene_surfaces_release(scene *s);
// scene_nav.c
void scene_nav_step(scene *s); // agents, and the entities they lead; before physics
void scene_nav_leave(scene *s, uint32_t row);
// scene_audio.c
void scene_audio_step(scene *s);

// ---- scene_emitters.c ----
void scene_emitters_step(scene *s);
void scene_audio_leave(scene *s, uint32_t row);
void scene_audio_destroy(scene *s);
// scene_feet.c
void scene_feet_step(scene *s); // between physics and poses
bool scene_feet_stream(scene *s, core_stream *stream);
// scene_ragdoll.c
void scene_ragdoll_step(scene *s); // between physics and poses
bool scene_ragdoll_stream(scene *s, core_stream *stream);
// scene_model.c
void scene_models_destroy(scene *s);
typedef struct scene_model_view {
    uint32_t mesh_count;
    const gfx_mesh *mesh;
    const gfx_material *material; // [mesh_count] null: default
    const bool *skinned;
    anim_skeleton skeleton;
} scene_model_view;
bool scene_model_look(const scene *s, scene_model model, scene_model_view *out);
// scene_sync.c
void scene_keep_previous(scene *s);
void scene_pull_bodies(scene *s);

#endif
