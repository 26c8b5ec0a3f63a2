// Ropes and cloth: storage, the working set of a step, and what the world calls. Not public.
#ifndef PHYS_CLOTH_H
#define PHYS_CLOTH_H

#include "core/columns.h"
#include "core/simd.h"
#include "phys/phys.h"

enum { PHYS_CLOTH_COOKIE = 0x70636c31, PHYS_CLOTH_PARTICLES = 1 << 20 };

// first: row of the first particle; a cloth's particles are consecutive, in the order of creation.
#define PHYS_CLOTH_COLUMNS(X)                                                                      \
    X(uint32_t, columns, CORE_COLUMN_STATE)                                                        \
    X(uint32_t, rows, CORE_COLUMN_STATE)                                                           \
    X(uint32_t, first, CORE_COLUMN_STATE)                                                          \
    X(float, rest_across, CORE_COLUMN_STATE)                                                       \
    X(float, rest_down, CORE_COLUMN_STATE)                                                         \
    X(float, mass, CORE_COLUMN_STATE) /* of a particle */                                          \
    X(float, radius, CORE_COLUMN_STATE)                                                            \
    X(float, stretch, CORE_COLUMN_STATE)                                                           \
    X(float, shear, CORE_COLUMN_STATE)                                                             \
    X(float, bend, CORE_COLUMN_STATE)                                                              \
    X(float, friction, CORE_COLUMN_STATE)                                                          \
    X(float, damping, CORE_COLUMN_STATE)                                                           \
    X(float, drag, CORE_COLUMN_STATE)                                                              \
    X(float, gravity_scale, CORE_COLUMN_STATE)                                                     \
    X(float, tear_force, CORE_COLUMN_STATE)                                                        \
    X(uint32_t, substeps, CORE_COLUMN_STATE)                                                       \
    X(uint32_t, layer, CORE_COLUMN_STATE)                                                          \
    X(uint64_t, user, CORE_COLUMN_STATE)                                                           \
    X(uint32_t, torn_count, CORE_COLUMN_STATE)                                                     \
    X(uint8_t, asleep, CORE_COLUMN_STATE)                                                          \
    X(float, still, CORE_COLUMN_STATE) /* s at rest */
CORE_COLUMNS_DECLARE(phys_cloths, PHYS_CLOTH_COLUMNS)

#define PHYS_PARTICLE_COLUMNS(X)                                                                   \
    X(float, x, CORE_COLUMN_STATE)                                                                 \
    X(float, y, CORE_COLUMN_STATE)                                                                 \
    X(float, z, CORE_COLUMN_STATE)                                                                 \
    X(float, vx, CORE_COLUMN_STATE)                                                                \
    X(float, vy, CORE_COLUMN_STATE)                                                                \
    X(float, vz, CORE_COLUMN_STATE)                                                                \
    X(uint8_t, torn, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(phys_particles, PHYS_PARTICLE_COLUMNS)

// What holds a particle. place: in the body's frame, or the world's without a body.
#define PHYS_HOLD_COLUMNS(X)                                                                       \
    X(uint32_t, cloth, CORE_COLUMN_STATE) /* slot */                                               \
    X(uint32_t, index, CORE_COLUMN_STATE) /* in the cloth */                                       \
    X(core_handle, body, CORE_COLUMN_STATE)                                                        \
    X(core_vec3, place, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(phys_holds, PHYS_HOLD_COLUMNS)

// Planes that keep particles out of bodies in this step: dot(n, p) >= d + dv * t. normal 0: none.
enum { PHYS_CLOTH_CONTACTS = 2 };
typedef struct phys_cloth_contact {
    float *n[3], *d, *dv;
    float *u[3];    // velocity of the surface
    float *grip;    // friction
    float *push[3]; // sum of the ways by which particles were moved
    uint32_t *body; // row; CORE_NO_ROW: none
    float *gap;     // m, while they are looked for
} phys_cloth_contact;

// The working set of one cloth in one step: rows of particles padded to 16 lanes, and the same
// transposed, so that both directions of the matrix run along lanes.
typedef struct phys_cloth_work {
    uint32_t cloth; // row
    uint32_t columns, rows, stride, turned_stride;
    uint32_t substeps;
    float h, rest_across, rest_down, rest_diagonal;
    float stretch, shear, bend; // compliance / h^2; bend < 0: none
    float keep;                 // part of the velocity that damping leaves a substep
    float heavier;              // particles than they should be
    bool direct, touches;
    float *x[3], *q[3], *v[3], *a[3], *w; // [rows * stride]: place, before, velocity, acceleration
    float *t[3], *tw;                     // [columns * turned_stride]
    float *down, *across, *cell;          // 1 where whole; across is transposed
    float *pull_down, *pull_across;       // sums of -lambda; across is transposed
    float *n[3], *off, *inv, *y;          // of the lines
    float *held;                          // 1: goes with what holds it, touches nothing
    phys_cloth_contact contact[PHYS_CLOTH_CONTACTS];
} phys_cloth_work;

// All substeps. Reads and writes the working set only.
CORE_SIMD_DECLARE(void, phys_cloth_solve, (phys_cloth_work * work))

// Before the solver: bodies where the last step left them. stale: shapes came or went.
void phys_cloths_update(phys_world *world, float dt, bool stale);
void phys_cloths_wake(phys_world *world);
// cloth_contact.c: fills the planes of the working set.
void phys_cloth_find_contacts(phys_world *world, phys_cloth_work *work, float dt);
// Bounds of what a cloth may touch within dt.
core_aabb phys_cloth_reach(const phys_world *world, uint32_t cloth, float dt);

#endif
