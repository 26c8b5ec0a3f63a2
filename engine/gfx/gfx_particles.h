// Particles: what is kept of each since its birth, and where all of an emitter are at a moment.
// A particle's way is a closed function of its age, so nothing is done for it between birth and the
// frame that shows it, and pictures do not depend on how many frames were drawn.
#ifndef GFX_PARTICLES_H
#define GFX_PARTICLES_H

#include "core/simd.h"
#include "gfx/gfx_internal.h"

typedef struct gfx_emitter_store {
    gfx_emitter_desc desc;
    char image[CORE_NAME_MAX];
    uint32_t capacity, used, next; // rows; a full store takes the oldest
    uint64_t number;               // births so far: index of the random numbers
    int32_t last;                  // step in which the youngest was born
    float owed;                    // births, < 1
    core_vec3 was_position;        // a step ago
    core_quat was_rotation;
    bool moved;
    uint64_t user;
    void *memory;                       // of the columns below, each [capacity], 64-byte aligned
    float *px, *py, *pz, *vx, *vy, *vz; // at birth: m, m/s
    float *life, *scale, *angle, *spin; // s, factor, rad, rad/s
    float *share;                       // of the step at which it was born
    int32_t *born;                      // step
} gfx_emitter_store;

// Where those alive are, in order of rows. Each array holds `capacity`.
typedef struct gfx_particle_view {
    float *x, *y, *z;
    float *u; // age over life, [0, 1)
    float *angle;
    uint32_t *row;
} gfx_particle_view;
// The moment is `step` steps and `part` of one, dt seconds each. Returns how many are alive.
CORE_SIMD_DECLARE(uint32_t, gfx_particles_at,
                  (const gfx_emitter_store *e, int32_t step, float part, float dt,
                   const gfx_particle_view *out))

#define GFX_EMITTER_COLUMNS(X) X(gfx_emitter_store, store, 0)
CORE_COLUMNS_DECLARE(gfx_emitters, GFX_EMITTER_COLUMNS)

typedef struct gfx_particles { // of a world; made with its first emitter
    gfx_emitters emitters;
    int32_t step; // steps so far
    float dt, part;
    gfx_growing scratch; // of gfx_particle_view
} gfx_particles;
void gfx_particles_destroy(gfx_particles *p);
// Memory for the particles of one emitter at a time; valid until the next call.
gfx_particle_view gfx_particles_scratch(gfx_particles *p, uint32_t capacity);

#endif
