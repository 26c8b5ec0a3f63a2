// Rigid-body physics. SI units: metres, kilograms, seconds, radians, newtons; right-handed, +Y up.
// Worlds are independent; one thread at a time may call into a world. No allocation in a step after
// warm-up. Same build and inputs give the same bits for any thread count and instruction set.
#ifndef PHYS_PHYS_H
#define PHYS_PHYS_H

#include "core/columns.h"
#include "core/data.h"
#include "core/jobs.h"
#include "core/metrics.h"

typedef struct phys_world phys_world;
typedef core_handle phys_body;
typedef core_handle phys_shape;

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
// reaches. False + core_fail naming the nearest name or the allowed values.
bool phys_world_set(phys_world *world, const char *name, const char *value);
// NULL-terminated list of names for a method kind: "solver", "broad", "narrow", "integrator".
const char *const *phys_method_names(const char *kind);
// State column sets for hashing, saving and divergence reports. Returns how many; out may be NULL.
int phys_world_state(const phys_world *world, const core_columns **out, int capacity);
size_t phys_world_bytes(const phys_world *world);
// Fills counts bodies, awake, shapes, pairs, contacts, joints, islands, triggers.
void phys_world_counts(const phys_world *world, core_metrics *metrics);

typedef struct phys_shape_desc {
    phys_shape_type type;
    core_vec3 half;      // box: half extents > 0 (m)
    float radius;        // sphere, capsule, cylinder: > 0 (m)
    float half_height;   // capsule (of the segment), cylinder: > 0 (m)
    core_vec3 normal;    // plane: unit normal, plane through the body's origin
    const float *points; // hull: [point_count*3] (m), copied
    uint32_t point_count;
    const core_soup_data *mesh; // static bodies only, copied
    core_vec3 position;         // in the body's frame
    core_quat rotation;
    float density;     // kg/m^3, > 0; 0 = 1000
    float friction;    // >= 0, default 0.5; set by phys_shape_desc_default
    float restitution; // [0, 1], default 0
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
    uint32_t layer;                        // 0..31
    uint64_t user;                         // the caller's own, never read
    uint32_t cookie;
} phys_body_desc;
phys_body_desc phys_body_desc_default(void);

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
