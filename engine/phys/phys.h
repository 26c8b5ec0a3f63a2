// Rigid-body physics. SI units: metres, kilograms, seconds, radians, newtons; right-handed, +Y up.
// Worlds are independent; one thread at a time may call into a world. No allocation in a step after
// warm-up. Same build and inputs give the same bits for any thread count and instruction set.
#ifndef PHYS_PHYS_H
#define PHYS_PHYS_H

#include "core/columns.h"
#include "core/data.h"
#include "core/jobs.h"
#include "core/metrics.h"
#include "core/stream.h"

typedef struct phys_world phys_world;
typedef core_handle phys_body;
typedef core_handle phys_shape;
typedef core_handle phys_trigger;
typedef core_handle phys_field;
typedef core_handle phys_joint;
typedef core_handle phys_mover;
typedef core_handle phys_cloth;

typedef enum phys_body_type { PHYS_DYNAMIC, PHYS_STATIC, PHYS_KINEMATIC } phys_body_type;
typedef enum phys_shape_type {
    PHYS_SPHERE,
    PHYS_BOX,
    PHYS_PLANE,
    PHYS_CAPSULE,
    PHYS_CYLINDER,
    PHYS_HULL,
    PHYS_MESH
} phys_shape_type;

// Zero means default everywhere; start from phys_world_desc_default() and edit.
typedef struct phys_world_desc {
    core_jobs *jobs;       // NULL: serial. Borrowed, must outlive the world
    core_metrics *metrics; // NULL: unmeasured. Borrowed
    core_vec3 gravity;     // m/s^2, default (0, -9.81, 0); set `zero_gravity` for none
    bool zero_gravity;
    uint32_t max_bodies; // default 1 << 20 (address space only)
    int substeps;        // 0: default of the solver; 1..64
    int iterations;      // sequential solver's velocity iterations, 0: default
    const char *solver;  // NULL: default; see phys_method_names("solver")
    const char *broad;   // NULL: "auto"; "brute", "sap", ...
    uint32_t cookie;     // set by phys_world_desc_default; other values are refused
} phys_world_desc;
phys_world_desc phys_world_desc_default(void);

// NULL + core_fail for bad descriptions (names the field, its value and the range).
phys_world *phys_world_create(const phys_world_desc *desc);
void phys_world_destroy(phys_world *world);
// Advances by dt seconds, finite, > 0, <= 1. False + core_fail otherwise.
bool phys_world_step(phys_world *world, float dt);
void phys_world_set_gravity(phys_world *world, core_vec3 g);
core_vec3 phys_world_gravity(const phys_world *world);
// Settings by name ("solver", "broad", "substeps", "iterations", ...): what --set phys.NAME=VALUE
// reaches. "friction", "restitution": how two materials become one: product, geometric (the default
// of friction), average, least, most (the default of restitution). "integrator": of bodies that
// touch nothing and hang on nothing; "auto" takes, body by body, the exact term under constant
// forces and rk4 where there are fields, functions or drag. "joints": chains and trees by "direct"
// solution (default) or, as a baseline, "iterate" as nets are. False + core_fail naming the nearest
// name or the allowed values.
bool phys_world_set(phys_world *world, const char *name, const char *value);
// NULL-terminated list of names for a method kind: "solver", "broad", "narrow", "integrator".
const char *const *phys_method_names(const char *kind);
// State column sets for hashing, saving and divergence reports. Returns how many; out may be NULL.
int phys_world_state(const phys_world *world, const core_columns **out, int capacity);
size_t phys_world_bytes(const phys_world *world);
// Fills counts bodies, awake, shapes, pairs, contacts, joints, islands, triggers.
void phys_world_counts(const phys_world *world, core_metrics *metrics);

typedef struct phys_material {
    float friction;    // >= 0
    float restitution; // [0, 1]
    float rolling;     // of balls: rolling resistance over radius, >= 0
} phys_material;

enum { PHYS_HOLE = 255 }; // area of a cell of heights that is not there
typedef struct phys_shape_desc {
    phys_shape_type type;
    core_vec3 half;      // box: half extents > 0 (m)
    float radius;        // sphere, capsule, cylinder: > 0 (m)
    float half_height;   // capsule (of the segment), cylinder: > 0 (m)
    core_vec3 normal;    // plane: unit normal, plane through the body's origin
    const float *points; // hull: [point_count*3] (m), copied
    uint32_t point_count;
    // Mesh: of static bodies only, copied; at most 2^24 triangles, places within 1e6 m. Neighbours
    // are found by equal corners. Triangles without an area are left out.
    const core_soup_data *mesh;
    // Mesh: a field of heights instead, copied: at most 2^14 points along a side. cells: area of
    // each cell, row by row [(rows - 1) * (columns - 1)], or PHYS_HOLE where there is none; NULL:
    // all 0.
    const core_heights_data *heights;
    const uint8_t *cells;
    bool one_sided;                 // mesh: what comes from behind passes; default: both sides stop
    const phys_material *materials; // mesh: [material_count] by the soup's area; areas beyond, or
    uint32_t material_count;        // without one, have the material below
    core_vec3 position;             // in the body's frame
    core_quat rotation;
    float density;     // kg/m^3, > 0; 0 = 1000
    float friction;    // >= 0, default 0.5; set by phys_shape_desc_default
    float restitution; // [0, 1], default 0
    float rolling;     // balls: rolling resistance over radius, >= 0, default 0
    uint32_t cookie;
} phys_shape_desc;
phys_shape_desc phys_shape_desc_default(phys_shape_type type);

typedef struct phys_body_desc {
    phys_body_type type;
    core_vec3 position;
    core_quat rotation;                    // zero: identity; normalised
    core_vec3 velocity;                    // m/s
    core_vec3 angular_velocity;            // rad/s, world frame
    float linear_damping, angular_damping; // 1/s, >= 0
    float gravity_scale;                   // default 1
    uint32_t locks;                        // PHYS_LOCK_*: directions in which it never moves
    uint32_t layer;                        // 0..31
    bool contact_events;                   // report touches of this body (phys_world_events)
    uint64_t user;                         // the caller's own, never read
    uint32_t cookie;
} phys_body_desc;
phys_body_desc phys_body_desc_default(void);

enum { // world axes: of motion, of turning
    PHYS_LOCK_X = 1u,
    PHYS_LOCK_Y = 2u,
    PHYS_LOCK_Z = 4u,
    PHYS_LOCK_TURN_X = 8u,
    PHYS_LOCK_TURN_Y = 16u,
    PHYS_LOCK_TURN_Z = 32u,
    PHYS_LOCK_TURN = 56u
};

// A body with one or more shapes. Null + core_fail for bad input (NaN, sizes <= 0, far positions).
phys_body phys_body_create(phys_world *world, const phys_body_desc *desc,
                           const phys_shape_desc *shapes, uint32_t shape_count);
// False for stale handles (as every function below: they then change nothing and core_fail).
bool phys_body_destroy(phys_world *world, phys_body body);
bool phys_body_alive(const phys_world *world, phys_body body);
uint64_t phys_body_user(const phys_world *world, phys_body body);

bool phys_body_position(const phys_world *world, phys_body body, core_vec3 *out);
bool phys_body_rotation(const phys_world *world, phys_body body, core_quat *out);
bool phys_body_velocity(const phys_world *world, phys_body body, core_vec3 *out);
bool phys_body_angular_velocity(const phys_world *world, phys_body body, core_vec3 *out);
float phys_body_mass(const phys_world *world, phys_body body); // kg; 0 for static
bool phys_body_set_position(phys_world *world, phys_body body, core_vec3 position);
bool phys_body_set_rotation(phys_world *world, phys_body body, core_quat rotation);
bool phys_body_set_velocity(phys_world *world, phys_body body, core_vec3 velocity);
bool phys_body_set_angular_velocity(phys_world *world, phys_body body, core_vec3 velocity);
bool phys_body_apply_force(phys_world *world, phys_body body, core_vec3 force); // N, next step only
bool phys_body_apply_impulse(phys_world *world, phys_body body, core_vec3 impulse,
                             core_vec3 at); // N s, world point

bool phys_body_apply_torque(phys_world *world, phys_body body, core_vec3 torque); // N m, next step

// What a body was made with and may change; read, edit, write. Ranges as in phys_body_desc.
typedef struct phys_body_settings {
    phys_body_type type; // read only
    float linear_damping, angular_damping, gravity_scale;
    uint32_t locks, layer;
    bool contact_events;
    uint32_t shape_count; // read only
} phys_body_settings;
bool phys_body_read(const phys_world *world, phys_body body, phys_body_settings *out);
bool phys_body_write(phys_world *world, phys_body body, const phys_body_settings *in);
// Of shape number `shape`, 0 .. shape_count - 1 in the order of creation; write: of all of them.
// Contacts that exist take the new material at once; the surface of a mesh keeps its own.
bool phys_body_shape(const phys_world *world, phys_body body, uint32_t shape, phys_shape_type *type,
                     phys_material *material);
bool phys_body_set_material(phys_world *world, phys_body body, const phys_material *material);

// Layers: two layers collide unless a rule says otherwise. Symmetric; takes effect at the next
// step. Names are kept by the caller. False + core_fail for layers above 31.
bool phys_world_set_rule(phys_world *world, uint32_t layer_a, uint32_t layer_b, bool collide);
bool phys_world_rule(const phys_world *world, uint32_t layer_a, uint32_t layer_b);
bool phys_body_set_layer(phys_world *world, phys_body body, uint32_t layer);
uint32_t phys_body_layer(const phys_world *world, phys_body body); // 0 when stale

// Regions that report the dynamic and kinematic bodies inside them and push nothing.
typedef struct phys_trigger_desc {
    phys_shape_type type; // sphere, box, capsule or cylinder
    core_vec3 half;       // box: half extents (m); capsule, cylinder: y is the half height
    float radius;         // sphere, capsule, cylinder (m)
    core_vec3 position;
    core_quat rotation;
    uint32_t layers; // bit per body layer that is seen; 0: all
    uint64_t user;
    uint32_t cookie;
} phys_trigger_desc;
phys_trigger_desc phys_trigger_desc_default(phys_shape_type type);
phys_trigger phys_trigger_create(phys_world *world, const phys_trigger_desc *desc);
// Bodies inside get their exit event in the next step.
bool phys_trigger_destroy(phys_world *world, phys_trigger trigger);
bool phys_trigger_alive(const phys_world *world, phys_trigger trigger);
bool phys_trigger_set_position(phys_world *world, phys_trigger trigger, core_vec3 position);
bool phys_trigger_set_rotation(phys_world *world, phys_trigger trigger, core_quat rotation);
uint64_t phys_trigger_user(const phys_world *world, phys_trigger trigger);

// What happened in the last step, ordered by trigger and body, then contacts by their age. Exactly
// one ENTER and one EXIT a visit, STAY in every step between; likewise BEGIN and END.
typedef enum phys_event_kind {
    PHYS_TRIGGER_ENTER,
    PHYS_TRIGGER_STAY,
    PHYS_TRIGGER_EXIT,
    PHYS_CONTACT_BEGIN, // of bodies made with contact_events
    PHYS_CONTACT_END,
    PHYS_JOINT_BREAK, // the load was beyond break_force or break_torque; or a body was destroyed
    PHYS_CONTACT_HIT  // struck again at more than 1 m/s while in touch; as BEGIN
} phys_event_kind;
typedef struct phys_event {
    phys_event_kind kind;
    phys_trigger trigger; // null for contacts; stale after its destruction
    phys_body a, b;       // trigger: a is the body, b null. Either may be stale in EXIT and END
    core_vec3 normal;     // BEGIN: unit, from a to b
    float speed;          // BEGIN: approach speed along the normal (m/s)
    phys_joint joint;     // JOINT_BREAK: stale by now; else null
} phys_event;
// Valid until the next step. *count may be 0 with a NULL result.
const phys_event *phys_world_events(const phys_world *world, uint32_t *count);

// Accelerations that act on dynamic bodies, everywhere or inside a region. Several fields add up.
typedef enum phys_field_type {
    PHYS_FIELD_UNIFORM,
    PHYS_FIELD_POINT,
    PHYS_FIELD_WIND // moves air, which drags cloth along; bodies do not feel it
} phys_field_type;
typedef struct phys_field_desc {
    phys_field_type type;
    core_vec3 acceleration; // uniform (m/s^2)
    core_vec3 velocity;     // wind (m/s)
    core_vec3 center;       // point
    float strength;        // point: towards the centre, strength / distance^2 (m^3/s^2); < 0 repels
    float core;            // point: > 0; inside this distance the pull falls linearly to 0 (m)
    bool bounded;          // acts only on bodies whose centre of mass is inside the region below
    phys_shape_type shape; // as in triggers, with the same sizes
    core_vec3 position, half;
    core_quat rotation;
    float radius;
    uint32_t layers; // as in triggers
    uint32_t cookie;
} phys_field_desc;
phys_field_desc phys_field_desc_default(phys_field_type type);
phys_field phys_field_create(phys_world *world, const phys_field_desc *desc);
bool phys_field_destroy(phys_world *world, phys_field field);
bool phys_field_alive(const phys_world *world, phys_field field);
// Acceleration (m/s^2) of dynamic bodies beside gravity and fields: a function of the centre of
// mass's place and velocity, and of the time since the world was made (s). Called several times a
// step, from several threads at once: it must give the same for the same arguments. NULL: none.
typedef core_vec3 phys_force_fn(void *ctx, core_vec3 position, core_vec3 velocity, float time);
void phys_world_set_force(phys_world *world, phys_force_fn *force, void *ctx);

// ---- questions between steps: they change nothing ----
typedef struct phys_filter {
    uint32_t layers; // bit per body layer that is seen; 0: all
    phys_body skip;  // not seen; null: none
} phys_filter;
phys_filter phys_filter_default(void);
typedef struct phys_hit {
    bool hit;
    phys_body body;
    core_vec3 point, normal; // world; the normal leaves the body
    float fraction;          // of the way in [0, 1]; closest: distance (m)
    uint32_t triangle;       // ray on a mesh: its number in the soup; else UINT32_MAX
} phys_hit;
// Nearest body on the way from `from` to `from + way`. A ray that starts inside hits at 0. filter
// may be NULL. False: nothing, out->hit false (also for bad input, with core_fail).
bool phys_world_ray(phys_world *world, core_vec3 from, core_vec3 way, const phys_filter *filter,
                    phys_hit *out);
// As a ray with a shape (sphere, box, capsule, cylinder) that does not turn.
bool phys_world_cast(phys_world *world, const phys_shape_desc *shape, core_vec3 from,
                     core_quat rotation, core_vec3 way, const phys_filter *filter, phys_hit *out);
// Bodies that a shape overlaps, by row. Returns how many; at most `capacity` are written.
uint32_t phys_world_overlap(phys_world *world, const phys_shape_desc *shape, core_vec3 position,
                            core_quat rotation, const phys_filter *filter, phys_body *out,
                            uint32_t capacity);
// Closest surface point within `reach` metres; a point inside a body is its own closest.
bool phys_world_closest(phys_world *world, core_vec3 point, float reach, const phys_filter *filter,
                        phys_hit *out);

// ---- the world as geometry: for navigation, debug drawing, export ----
// One shape of one body, in the world's frame. Pointers belong to the world and stay valid until a
// body is made or destroyed or a snapshot restored.
typedef struct phys_shape_view {
    phys_body body;
    phys_body_type body_type; // navigation usually takes PHYS_STATIC alone
    uint32_t layer;           // of the body
    phys_shape_type type;
    core_vec3 position; // of the shape's own frame; sphere, capsule, cylinder, box: its centre
    core_quat rotation; // capsule, cylinder: axis along the frame's y; plane: its normal is y
    core_vec3 half;     // box: half extents (m)
    float radius;       // sphere, capsule, cylinder (m)
    float half_height;  // capsule (of the segment), cylinder (m)
    core_aabb bounds;   // world; of a plane +-1e9 m
    // Hull: convex polygons, face f has loop[face_begin[f] .. face_begin[f + 1]), counter-clockwise
    // from outside; mesh: triangles. In the shape's own frame.
    uint32_t vertex_count, face_count, triangle_count;
    const core_vec3 *vertex;    // [vertex_count] hull, mesh
    const uint32_t *face_begin; // [face_count + 1] hull
    const uint32_t *loop;       // [face_begin[face_count]] hull
    const uint32_t *index;      // [3 * triangle_count] mesh; NULL: a field of heights, the next two
    const core_heights_data *heights;
    const uint8_t *cells; // as in the description, may be NULL
} phys_shape_view;
// Shapes of all bodies; rows 0 .. count - 1, in an order that only edits of the world change.
uint32_t phys_world_shape_count(const phys_world *world);
// False + core_fail for rows out of range.
bool phys_world_shape(const phys_world *world, uint32_t row, phys_shape_view *out);
// The shape's surface as triangles in the world's frame, three corners each, counter-clockwise from
// outside. Round shapes are cut into flat pieces that lie at most `tolerance` m (> 0) inside; a
// plane becomes a square of half side `plane_half` m about the body's origin. Writes as many whole
// triangles as fit into `capacity` (counted in triangles; out may be NULL when 0) and returns how
// many there are.
uint32_t phys_shape_triangles(const phys_shape_view *shape, float tolerance, float plane_half,
                              core_vec3 *out, uint32_t capacity);
// Where static geometry changed: counts up when a static body is made, destroyed, moved, turned or
// given another layer, and when a snapshot is restored.
uint64_t phys_world_static_version(const phys_world *world);
// Bounds (world, before and after) of the changes later than version `since`, oldest first. Writes
// at most `capacity`, returns how many there are. False in *complete: too long ago (only the last
// 256 are kept) or a restore: anything may have changed.
uint32_t phys_world_static_changes(const phys_world *world, uint64_t since, core_aabb *out,
                                   uint32_t capacity, bool *complete);

// Everything a shape (as in a cast) is within `reach` metres of, by body row. As long as the shape
// moves by a way with dot(normal, way) >= -gap it stays clear of that convex part of the body
// (separating planes), whatever the way's length. Returns how many; at most `capacity` are written.
typedef struct phys_touch {
    phys_body body;
    core_vec3 point;  // on the body's surface, world
    core_vec3 normal; // unit, from the body to the shape
    float gap;        // m; < 0: depth
} phys_touch;
uint32_t phys_world_touch(phys_world *world, const phys_shape_desc *shape, core_vec3 position,
                          core_quat rotation, float reach, const phys_filter *filter,
                          phys_touch *out, uint32_t capacity);

// ---- character movers ----
// An upright capsule that goes where it wishes as far as the world lets it: it slides along what
// it meets, climbs slopes and steps up to its limits, keeps to the ground downhill, rides on
// bodies that move or turn, pushes dynamic bodies with a limited force. It moves at the end of a
// step, bodies in their new places; bodies do not feel it but for its push and weight. Between two
// convex shapes there is a plane that the mover never crosses, so that no speed takes it through
// (method: sliding planes, solved as a projection; Dykstra 1983).
typedef enum phys_mover_ground {
    PHYS_MOVER_AIR,
    PHYS_MOVER_STEEP, // touches only what is too steep to stand on
    PHYS_MOVER_GROUND
} phys_mover_ground;
typedef struct phys_mover_desc {
    core_vec3 position;  // of the capsule's centre
    float radius;        // m, default 0.3
    float half_height;   // of the capsule's segment (m), default 0.6
    float slope_limit;   // rad, (0, pi/2), default 50 degrees
    float step_height;   // m, >= 0, default 0.3; set by phys_mover_desc_default
    float push_force;    // N, >= 0, default 200
    float mass;          // kg, > 0: its weight on what it stands on, default 70
    float gravity_scale; // default 1; 0: flies, the wish's y counts
    uint32_t layers;     // bit per body layer that is in its way; 0: all
    uint64_t user;       // the caller's own, never read
    uint32_t cookie;
} phys_mover_desc;
phys_mover_desc phys_mover_desc_default(void);
// Null + core_fail for bad input. A mover that starts inside a body is pushed out.
phys_mover phys_mover_create(phys_world *world, const phys_mover_desc *desc);
// False + core_fail for stale handles, as below.
bool phys_mover_destroy(phys_world *world, phys_mover mover);
bool phys_mover_alive(const phys_world *world, phys_mover mover);
uint32_t phys_mover_count(const phys_world *world);
uint64_t phys_mover_user(const phys_world *world, phys_mover mover);
// The velocity to walk at (m/s), seen from the ground, until it is changed. On the ground it turns
// into the ground's plane and keeps its length.
bool phys_mover_walk(phys_world *world, phys_mover mover, core_vec3 velocity);
// Leaves the ground in the next step with this speed upwards (m/s, > 0) and the ground's velocity.
// Also in the air: whether that is allowed is the caller's rule.
bool phys_mover_jump(phys_world *world, phys_mover mover, float speed);
bool phys_mover_set_position(phys_world *world, phys_mover mover, core_vec3 position);
// New sizes (m), the feet stay. *fits false and nothing changed where a body is in the way.
bool phys_mover_resize(phys_world *world, phys_mover mover, float radius, float half_height,
                       bool *fits);
typedef struct phys_mover_state {
    core_vec3 position;
    core_vec3 velocity; // of the last step, platform included (m/s)
    phys_mover_ground ground;
    phys_body body;          // stands on this one; null in the air
    core_vec3 point, normal; // of the ground; normal unit, of the surface (in the air 0, +y)
    float turn;              // about +y by which the ground turned in the last step (rad)
} phys_mover_state;
bool phys_mover_read(const phys_world *world, phys_mover mover, phys_mover_state *out);

// ---- ropes and cloth ----
// A matrix of particles, columns x rows; one column is a rope. Neighbours along columns and rows
// keep their distance, diagonals resist shear, the second neighbours bending. Small steps (Macklin
// et al., "Small Steps in Physics Simulation", SCA 2019) of extended position-based dynamics, in
// which every line of the matrix is solved exactly at once as a tridiagonal system; the setting
// "cloth" = "iterate" solves edge by edge instead. Particles collide with all shapes (their own
// cloth and other cloths excepted), push bodies and are held by them; fields and wind act on them.
typedef struct phys_cloth_desc {
    uint32_t columns, rows; // >= 1, at least 2 particles; at most 1 << 20
    core_vec3 origin;       // of particle (0, 0), m
    core_vec3 across;       // way from column 0 to the last: its length is the rest width
    core_vec3 down;         // way from row 0 to the last
    float mass;             // kg in all, > 0, default 1
    float radius;           // of the particles: half the thickness (m), > 0, default 0.01
    float stretch;          // compliance of edges (m/N), 0: none gives
    float shear;            // compliance of diagonals (m/N), default 1e-3
    float bend;             // stiffness against bending (N/m of shortening), 0: none
    float friction;         // >= 0, default 0.5
    float damping;          // 1/s, >= 0, default 0.1
    float drag;             // of the air across the face, >= 0, default 1; 0: no wind
    float gravity_scale;    // default 1
    float tear_force;       // N along an edge, 0: never
    uint32_t substeps;      // default 8, at most 64
    uint32_t layer;         // 0..31: collides by the rules of bodies
    uint64_t user;          // the caller's own, never read
    uint32_t cookie;
} phys_cloth_desc;
phys_cloth_desc phys_cloth_desc_default(void);
// Null + core_fail for bad input.
phys_cloth phys_cloth_create(phys_world *world, const phys_cloth_desc *desc);
// False + core_fail for stale handles and particles that do not exist, as below.
bool phys_cloth_destroy(phys_world *world, phys_cloth cloth);
bool phys_cloth_alive(const phys_world *world, phys_cloth cloth);
uint32_t phys_cloth_count(const phys_world *world);
uint64_t phys_cloth_user(const phys_world *world, phys_cloth cloth);
// Holds a particle to a body at its present place, or, with a null body, to a point of the world,
// to which it goes within the next step. A dynamic body feels the pull. Again: replaces.
bool phys_cloth_hold(phys_world *world, phys_cloth cloth, uint32_t column, uint32_t row,
                     phys_body body, core_vec3 at);
bool phys_cloth_release(phys_world *world, phys_cloth cloth, uint32_t column, uint32_t row);
bool phys_cloth_push(phys_world *world, phys_cloth cloth, uint32_t column, uint32_t row,
                     core_vec3 impulse); // N s
// What is there: valid until the next create, destroy or step. Particle (c, r) is at c + r*columns.
enum { PHYS_CLOTH_TORN_ACROSS = 1, PHYS_CLOTH_TORN_DOWN = 2 };
typedef struct phys_cloth_view {
    uint32_t columns, rows, count;
    const float *x, *y, *z, *vx, *vy, *vz;
    const uint8_t *torn; // bits: the edge to (c + 1, r), to (c, r + 1)
    uint32_t torn_count; // edges
    bool asleep;
} phys_cloth_view;
bool phys_cloth_read(const phys_world *world, phys_cloth cloth, phys_cloth_view *out);
// How far whole edges are from their rest length, relative: mean of the magnitudes, and the most.
bool phys_cloth_stretch(const phys_world *world, phys_cloth cloth, double *mean, double *most);

// ---- snapshot ----
// The whole state: bodies, contacts with their impulses, triggers, fields, rules. A world restored
// to it steps on with the same bits. Hulls are not in it: only worlds that still have the shapes
// they had can be restored (rollback). False + core_fail for data that does not fit.
size_t phys_world_save_size(phys_world *world);
void phys_world_save(phys_world *world, void *out);
bool phys_world_restore(phys_world *world, const void *data, size_t size);
// The same as fields of a saved scene (core/stream.h), for files: what points elsewhere is checked.
// Hulls and meshes are not in it: the world must hold those of the one that was saved. When it
// returns false the world must be restored or destroyed.
bool phys_world_stream(phys_world *world, core_stream *stream);

// Joints of two bodies, or of a body and the world (a null handle). Where the joints of a group of
// bodies form trees (any number of them to the world or to static bodies), each substep solves
// them exactly, whatever the masses (Baraff, "Linear-time dynamics using Lagrange multipliers",
// SIGGRAPH 1996); loops are left to iteration. Only for the solver "soft".
typedef enum phys_joint_type {
    PHYS_JOINT_FIXED,     // no freedom left
    PHYS_JOINT_BALL,      // turns about the anchor; cone and twist limits
    PHYS_JOINT_DISTANCE,  // keeps the anchors' distance, or within limits (a rope), or a spring
    PHYS_JOINT_REVOLUTE,  // turns about the axis
    PHYS_JOINT_PRISMATIC, // slides along the axis
    PHYS_JOINT_UNIVERSAL, // Cardan: the axis on a stays at a right angle to axis_b on b
    PHYS_JOINT_PIVOT,     // a turns about its axis `ratio` times as fast as b about axis_b
    PHYS_JOINT_PULLEY     // |anchor_a - ground_a| + ratio |anchor_b - ground_b| is constant
} phys_joint_type;

// Places and directions are the world's at the time of creation, which is the rest position: angle
// 0, slide 0. The coordinate of limits, motor and spring is the angle of b against a about the axis
// (revolute, rad, within +-pi; ball: twist), the way of b along it (prismatic, m), the distance of
// the anchors (distance, m), the angle of axis_b about axis (universal, rad), the length of a's
// side (pulley, m). A pivot's motor turns b about axis_b.
typedef struct phys_joint_desc {
    phys_joint_type type;
    phys_body a, b;
    core_vec3 anchor;       // m; both anchors unless the two below are used
    core_vec3 anchor_a;     // distance, pulley
    core_vec3 anchor_b;     // distance, pulley
    core_vec3 axis;         // any length > 0, default +y
    core_vec3 axis_b;       // universal, pivot; default: +x for universal, axis for pivot
    bool limit;             // ball (twist), distance, revolute, prismatic, universal, pulley
    float lower, upper;     // lower <= upper; revolute and twist within +-pi, distance >= 0
    float cone;             // ball: largest angle between the axes, (0, pi); 0: none
                            // universal: largest turn about axis_b to either side
    bool motor;             // all but fixed and ball
    float motor_speed;      // m/s or rad/s
    float motor_max;        // N or N m, >= 0
    float hertz;            // spring towards `rest`, 0: none; distance, revolute, prismatic
    float rest;             // m or rad; distance: 0 is the distance at creation
    float damping_ratio;    // of the spring, >= 0
    float damping;          // N s/m or N m s/rad, >= 0; distance, revolute, prismatic
    float ratio;            // pivot (may be negative: meshing gears), pulley (> 0); default 1
    core_vec3 ground_a;     // pulley
    core_vec3 ground_b;     // pulley
    float break_force;      // N, 0: never
    float break_torque;     // N m, 0: never
    bool collide_connected; // the two bodies touch each other as if they had no joint
    uint64_t user;          // the caller's own, never read
    uint32_t cookie;
} phys_joint_desc;
phys_joint_desc phys_joint_desc_default(phys_joint_type type);
// Null + core_fail for bad input: stale bodies, the same body twice, no dynamic body, NaN, zero
// axes, options that the type does not have.
phys_joint phys_joint_create(phys_world *world, const phys_joint_desc *desc);
// False + core_fail for stale handles, as below. A body's joints go with it.
bool phys_joint_destroy(phys_world *world, phys_joint joint);
bool phys_joint_alive(const phys_world *world, phys_joint joint);
uint32_t phys_joint_count(const phys_world *world);
uint64_t phys_joint_user(const phys_world *world, phys_joint joint);
// What the joint did to b, mean over the last step, force at the anchor (N, N m, world axes).
bool phys_joint_force(const phys_world *world, phys_joint joint, core_vec3 *force,
                      core_vec3 *torque);
// The coordinate (see above) in the present pose. False + core_fail for types without one.
bool phys_joint_coordinate(const phys_world *world, phys_joint joint, float *out);
bool phys_joint_set_motor(phys_world *world, phys_joint joint, bool on, float speed, float max);
bool phys_joint_set_limits(phys_world *world, phys_joint joint, bool on, float lower, float upper);
bool phys_joint_set_spring(phys_world *world, phys_joint joint, float hertz, float damping_ratio,
                           float rest);

// ---- ragdolls ----
// A body a bone and a joint to the bone above it, from plain data. A body's origin is its bone's
// head and its rotation the bone's, so that poses pass both ways unchanged: hand over by `pose`
// (model space placed in the world), read back by phys_body_position and _rotation.
typedef struct phys_ragdoll_bone {
    int32_t parent;       // an earlier bone; -1: none
    uint32_t bone;        // the caller's own: number in the skeleton
    core_vec3 head, tail; // rest pose, world (m), at least 1 mm apart
    core_quat rotation;   // rest pose, world
    float radius;         // of the capsule (m); 0: 0.15 of the length
    float mass;           // kg; 0: of water
    float cone;           // largest lean against the parent from the rest pose, (0, pi); 0: 0.8 rad
    float twist;          // to either side; 0: 0.5 rad
    bool hinge;           // turns about `axis` only, by lower..upper (rad) from the rest pose
    core_vec3 axis;       // world, rest pose
    float lower, upper;
} phys_ragdoll_bone;
typedef struct phys_ragdoll_pose { // of a bone's head, world
    core_vec3 position, velocity, angular_velocity;
    core_quat rotation;
} phys_ragdoll_pose;
typedef struct phys_ragdoll_desc {
    const phys_ragdoll_bone *bones; // [bone_count]
    uint32_t bone_count;            // 1..256
    const phys_ragdoll_pose *pose;  // [bone_count] where it starts; NULL: at rest in the rest pose
    uint32_t layer;
    float friction;        // of its bodies, default 0.6
    float linear_damping;  // 1/s, default 0.05
    float angular_damping; // 1/s, default 1: joints of flesh
    uint64_t user;
    uint32_t cookie;
} phys_ragdoll_desc;
phys_ragdoll_desc phys_ragdoll_desc_default(void);
// Writes bone_count bodies and joints (null for bones without a parent). False + core_fail for bad
// input, nothing made then. They are bodies and joints like others: destroy the bodies to end it.
bool phys_ragdoll_create(phys_world *world, const phys_ragdoll_desc *desc, phys_body *bodies,
                         phys_joint *joints);
// Bones of a skeleton in its bind pose, placed in the world, `mass` kg in all, shared by volume.
// Bones shorter than `least` m are left to the one above. A tail is the mean of the children's
// heads; one without children goes on like the bone above, half as long. Returns how many; at most
// `capacity` are written.
uint32_t phys_ragdoll_bones(const core_skeleton_data *skeleton, core_vec3 position,
                            core_quat rotation, float scale, float mass, float least,
                            phys_ragdoll_bone *out, uint32_t capacity);

// The poses, for sync and columns(): arrays of phys_body_count rows, valid until the next create,
// destroy or step. COM positions equal origins for single centred shapes; these are body origins.
uint32_t phys_body_count(const phys_world *world);
uint32_t phys_body_row(const phys_world *world, phys_body body); // CORE_NO_ROW when stale
phys_body phys_body_at(const phys_world *world, uint32_t row);
typedef struct phys_pose_view {
    const float *px, *py, *pz, *qx, *qy, *qz, *qw, *vx, *vy, *vz, *wx, *wy, *wz;
    uint32_t count;
} phys_pose_view;
phys_pose_view phys_world_poses(const phys_world *world);

// Accuracy of the present state, computed from poses alone by a double-precision kernel that shares
// no code with the solver.
typedef struct phys_accuracy {
    double penetration_max_m, penetration_mean_m; // over overlapping pairs
    double energy_j;                              // kinetic + potential against height 0
    double
        energy_drift; // gain beyond the work done since the first sample, relative; losses count 0
    double momentum_drift; // change of total momentum beyond impulses of gravity and statics; NaN:
                           // does not apply
    double joint_error_max_m;
    uint32_t tunnelled; // bodies seen on the far side of a static one they started outside of
    uint32_t nan;       // bodies with a non-finite pose or velocity
} phys_accuracy;
void phys_world_accuracy(phys_world *world, phys_accuracy *out);

#endif
