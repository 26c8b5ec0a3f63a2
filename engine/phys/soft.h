// Working set of the soft solver: bodies as rows of four floats, contacts in blocks of 16 lanes of
// one colour (no two lanes of a colour share a moving body). Filled by soft.c, worked on by
// soft.simd.c in 4, 8 or 16 lanes with the same bits.
#ifndef PHYS_SOFT_H
#define PHYS_SOFT_H

#include "core/simd.h"
#include "phys/world.h"

// Bodies, 8 floats each: linear part, 0, angular part, 0.
typedef struct soft_bodies {
    float *velocity;
    float *moved;   // way and turn since the start of the step
    float *push;    // velocity added in a substep by gravity, forces, fields
    float *mark;    // velocity after push, before contacts: what contacts gave last is warm start
    float *keep;    // factor of damping, NULL: none
    float *inertia; // world inverse inertia: xx yy zz 0 xy xz yz 0
    uint32_t count;
} soft_bodies;

// Contact spring of a substep: bias rate (1/s), mass and impulse scale (solve_sequential.c),
// largest push-out speed, substep length and its inverse.
typedef struct soft_spring {
    float bias_rate, mass_scale, impulse_scale, push_max, h, inv_h;
} soft_spring;

#define SOFT_LANES CORE_LANES
#define LANES      _Alignas(CORE_ALIGN) float

// Ball on ball, ball on static: one point, no arm but the radius. Static b: imb = ib = rb = 0.
typedef struct ball_block {
    _Alignas(CORE_ALIGN) int32_t a[SOFT_LANES];
    int32_t b[SOFT_LANES];
    LANES nx[SOFT_LANES], ny[SOFT_LANES], nz[SOFT_LANES];
    LANES gap[SOFT_LANES];                                // at the start of the step, m
    LANES jn[SOFT_LANES];                                 // normal impulse of the substep
    LANES jx[SOFT_LANES], jy[SOFT_LANES], jz[SOFT_LANES]; // friction impulse, world axes
    LANES rx[SOFT_LANES], ry[SOFT_LANES], rz[SOFT_LANES]; // rolling impulse on b, N m s
    LANES ima[SOFT_LANES], imb[SOFT_LANES];               // inverse masses
    LANES ra[SOFT_LANES], rb[SOFT_LANES];                 // radii
    LANES ia[SOFT_LANES], ib[SOFT_LANES];                 // inverse moments of inertia
    LANES roll[SOFT_LANES];                               // rolling resistance as a length, m
    LANES mn[SOFT_LANES], mt[SOFT_LANES];                 // effective masses
    LANES friction[SOFT_LANES], restitution[SOFT_LANES];
    LANES approach[SOFT_LANES]; // fastest approach in this step (m/s, <= 0)
} ball_block;

// One direction of a manifold: torque arms of a and b and what they turn into. Until SOFT_WARM has
// run, a and b of points hold the anchors.
typedef struct soft_arm {
    LANES ax[SOFT_LANES], ay[SOFT_LANES], az[SOFT_LANES];
    LANES bx[SOFT_LANES], by[SOFT_LANES], bz[SOFT_LANES];
    LANES iax[SOFT_LANES], iay[SOFT_LANES], iaz[SOFT_LANES];
    LANES ibx[SOFT_LANES], iby[SOFT_LANES], ibz[SOFT_LANES];
    LANES mass[SOFT_LANES], impulse[SOFT_LANES];
} soft_arm;

// Up to four points; friction and twist act once, at their centre.
typedef struct manifold_block {
    _Alignas(CORE_ALIGN) int32_t a[SOFT_LANES];
    int32_t b[SOFT_LANES];
    int32_t row[SOFT_LANES];
    LANES nx[SOFT_LANES], ny[SOFT_LANES], nz[SOFT_LANES];
    LANES ima[SOFT_LANES], imb[SOFT_LANES];
    soft_arm point[4];
    LANES gap[4][SOFT_LANES], approach[4][SOFT_LANES], lever[4][SOFT_LANES];
    LANES tx[2][SOFT_LANES], ty[2][SOFT_LANES], tz[2][SOFT_LANES];
    soft_arm tangent[2];
    LANES wax[SOFT_LANES], way[SOFT_LANES], waz[SOFT_LANES]; // inverse inertia of a times n
    LANES wbx[SOFT_LANES], wby[SOFT_LANES], wbz[SOFT_LANES];
    LANES cross[SOFT_LANES]; // off-diagonal of the inverse tangent matrix
    LANES count[SOFT_LANES]; // points
    LANES twist_mass[SOFT_LANES], twist[SOFT_LANES];
    LANES friction[SOFT_LANES], restitution[SOFT_LANES];
} manifold_block;

// What a pass does over blocks.
typedef enum soft_pass {
    SOFT_WARM,  // prepare masses, apply last step's impulses
    SOFT_SOLVE, // normal impulses with bias
    SOFT_RELAX, // without bias, then friction
    SOFT_RESTITUTE
} soft_pass;

typedef void soft_balls_fn(ball_block *block, uint32_t count, soft_bodies *bodies,
                           const soft_spring *spring, soft_pass pass, bool fixed);
typedef void soft_manifolds_fn(manifold_block *block, uint32_t count, soft_bodies *bodies,
                               const soft_spring *spring, soft_pass pass, bool fixed);
// Flat updates of floats [begin, end): velocity += push + what contacts gave; moved += h velocity.
typedef void soft_flat_fn(soft_bodies *bodies, uint32_t begin, uint32_t end, float h);

CORE_SIMD_DECLARE(void, phys_soft_balls,
                  (ball_block * block, uint32_t count, soft_bodies *bodies,
                   const soft_spring *spring, soft_pass pass, bool fixed))
CORE_SIMD_DECLARE(void, phys_soft_manifolds,
                  (manifold_block * block, uint32_t count, soft_bodies *bodies,
                   const soft_spring *spring, soft_pass pass, bool fixed))
CORE_SIMD_DECLARE(void, phys_soft_push,
                  (soft_bodies * bodies, uint32_t begin, uint32_t end, float h))
CORE_SIMD_DECLARE(void, phys_soft_move,
                  (soft_bodies * bodies, uint32_t begin, uint32_t end, float h))

#endif
