// Working set of joints in the soft solver. Every joint is rows of a Jacobian: hard ones, solved
// together as a block, and soft ones (limit, motor, spring), one by one between bounds. Joints that
// form trees have their hard rows solved exactly by joint_tree.c; all other rows live in coloured
// blocks of 16 lanes, worked on by joint_blocks.simd.c.
#ifndef PHYS_JOINT_SOLVE_H
#define PHYS_JOINT_SOLVE_H

#include "phys/joint_chain.h"

#define JOINT_NONE UINT32_MAX
// Hard rows in loops, in the pass that corrects: part of the error that a substep takes back, and
// the scale of mass and of the impulse so far, as a soft constraint of about 1/18 of the substep
// rate has them. Without that give a stretched net feeds what one sweep leaves over into the next
// and explodes.
#define JOINT_LOOP_RATE 0.35f
#define JOINT_LOOP_MASS 0.93f
#define JOINT_LOOP_GIVE 0.07f

// A body that joints hold. Entry 0 is the world.
typedef struct joint_body {
    uint32_t row, place;   // place: in soft_bodies
    bool mobile, placed;   // placed: has a velocity (mobile or kinematic)
    bool chained, general; // general: some joint of it has rows
    float im;
    core_vec3 center; // now
    core_quat q, q0;  // now, at the start of the step
    core_vec3 center0;
    float before[8]; // velocity before a pass
} joint_body;

// Jacobian of a row: linear and angular part of a, then of b. Speed = sum of products.
typedef struct joint_row {
    float j[12];
    float error;       // m or rad
    float bias, relax; // target speed with and without correction, negated
    float gamma;       // softness: 1 / (h (c + h k)), 1/kg
    float lo, hi;      // bounds of the impulse
    float impulse;
} joint_row;

typedef enum joint_lane_kind {
    JOINT_LANES_BLOCK, // any rows
    JOINT_LANES_POINT, // ball joints that need no more than a point held
    JOINT_LANES_ROD,   // hard distances
    JOINT_LANE_KINDS,
    JOINT_LANES_NONE = JOINT_LANE_KINDS
} joint_lane_kind;
#define JOINT_COLORS 64u // one more for bodies with more joints than colours, one joint a block

typedef struct joint_work {
    uint32_t joint; // row of the columns
    uint32_t a, b;  // joint_body
    uint8_t type, hard, soft, lanes;
    bool direct;  // hard rows belong to a tree
    bool chained; // joint of a chain
    bool upper;   // side of the limit in this step
    uint32_t block, lane;
    core_vec3 force, torque; // impulses on b, sum over the substeps so far, N s and N m s
    core_vec3 arm_b;         // from the centre of b to its anchor
    joint_row *row;          // hard ones, then soft ones; NULL: points, rods and chains have none
} joint_work;

// What all kinds of lanes begin with. Lanes whose body stays write to the row of empty lanes; poses
// are by joint_body.
typedef struct joint_head {
    _Alignas(CORE_ALIGN) int32_t a[SOFT_LANES];
    int32_t b[SOFT_LANES], to_a[SOFT_LANES], to_b[SOFT_LANES];
    int32_t pose_a[SOFT_LANES], pose_b[SOFT_LANES];
    LANES ima[SOFT_LANES], imb[SOFT_LANES];
} joint_head;

typedef struct joint_lanes {
    LANES j[12][SOFT_LANES];
    LANES ia[3][SOFT_LANES], ib[3][SOFT_LANES]; // inverse inertia times angular parts
    LANES bias[SOFT_LANES], relax[SOFT_LANES], gamma[SOFT_LANES];
    LANES lo[SOFT_LANES], hi[SOFT_LANES], mass[SOFT_LANES], impulse[SOFT_LANES];
} joint_lanes;

typedef struct joint_block {
    joint_head head;
    LANES inverse[PHYS_JOINT_HARD][PHYS_JOINT_HARD][SOFT_LANES]; // of the hard rows' matrix
    joint_lanes hard[PHYS_JOINT_HARD], soft[PHYS_JOINT_SOFT];
    uint32_t hard_count, soft_count; // most of any lane
} joint_block;

// la, lb: arms in the bodies' axes. diagonal, off: of the inverse matrix.
typedef struct joint_points {
    joint_head head;
    LANES la[3][SOFT_LANES], lb[3][SOFT_LANES], ra[3][SOFT_LANES], rb[3][SOFT_LANES];
    LANES gap[3][SOFT_LANES], diagonal[3][SOFT_LANES], off[3][SOFT_LANES];
    LANES impulse[3][SOFT_LANES], load[3][SOFT_LANES]; // load: sum over the substeps
    LANES ia[SOFT_LANES], ib[SOFT_LANES];
    bool round; // all bodies have equal moments: ia and ib are their inverses
} joint_points;

typedef struct joint_rods {
    joint_head head;
    LANES la[3][SOFT_LANES], lb[3][SOFT_LANES], ra[3][SOFT_LANES], rb[3][SOFT_LANES];
    LANES n[3][SOFT_LANES], load[3][SOFT_LANES]; // n: unit, from a to b
    LANES rest[SOFT_LANES], gap[SOFT_LANES], mass[SOFT_LANES], impulse[SOFT_LANES];
    LANES bend[SOFT_LANES]; // half of one over the length
    bool arms;              // some anchor is off its body's centre
} joint_rods;

// Poses by joint_body, rows of 8: centre, 0, imaginary part of the rotation, 0; real part. start:
// at the start of the step. place: row of soft_bodies.
typedef struct joint_poses {
    float *start, *start_real, *pose, *real;
    int32_t *place;
    uint32_t count;
} joint_poses;

// One elimination: the joint of a body to its parent in the tree, or to what does not move.
typedef struct joint_op {
    uint32_t work, child, parent; // child: JOINT_NONE for joints to what does not move
    bool flip;                    // the parent is b
    double g[6][6], t[6][6], inverse[6][6], mu[6];
} joint_op;
typedef struct joint_state { // of a joint_body in the direct solve
    double phi[6][6];        // velocity answer to an impulse, joints so far included
    double u[6], f[6];
} joint_state;
typedef struct joint_tree {
    joint_op *op; // leaves first; trees one after the other
    joint_state *state;
    uint32_t *first; // [trees + 1] first op of each tree
    uint32_t *body;  // [trees + 1 ..] bodies in the order of the search
    uint32_t *first_body;
    uint32_t trees;
} joint_tree;

enum { PHYS_JOINTED = 1, PHYS_CHAINED = 2 }; // chains keep rotations themselves

typedef struct soft_joints {
    phys_world *world;
    soft_bodies *bodies;
    float h;       // s, of a substep
    float time;    // s, that loads of rows were summed over
    float elapsed; // s, in this step
    joint_body *body;
    uint32_t body_count;
    uint8_t *jointed;    // by place: PHYS_JOINTED or PHYS_CHAINED
    core_quat *rotation; // by place, of chained bodies at the end of the step
    bool alone;          // no contact on the level
    bool stale;          // lanes of points and rods are to be made anew
    joint_work *work;
    uint32_t count;
    uint32_t *general, general_count; // those with rows
    uint32_t others;                  // joints outside of chains
    joint_tree tree;
    joint_chains chains;
    joint_poses poses;
    joint_block *block;
    joint_points *point;
    joint_rods *rod;
    uint32_t first[JOINT_LANE_KINDS][JOINT_COLORS + 2]; // first block of each colour
} soft_joints;

// joint_rows.c
void joint_rows_count(const phys_joints *j, uint32_t row, uint8_t *hard, uint8_t *soft);
void joint_rows_make(const soft_joints *s, joint_work *k);
// Whether the upper limit is the nearer one.
bool joint_rows_upper(const soft_joints *s, const joint_work *k);

// joint_lanes.c
void joint_lanes_build(soft_joints *s);
void joint_lanes_refresh(soft_joints *s, uint32_t general);
void joint_lanes_exchange(soft_joints *s, bool to_lanes); // impulses of rows, to or from the lanes
void joint_lanes_end(soft_joints *s);

// joint_chain.c: after joint_tree_choose, takes its joints from the trees.
void joint_chains_build(soft_joints *s);
void joint_chains_end(soft_joints *s);

// joint_tree.c
void joint_tree_choose(soft_joints *s);
void joint_tree_build(soft_joints *s);
void joint_tree_factor(soft_joints *s, uint32_t tree);
void joint_tree_solve(soft_joints *s, uint32_t tree, bool correct);
// a := inverse of the symmetric positive matrix a, order n <= 6.
void joint_invert(double a[6][6], uint32_t n);

// joint_solve.c: NULL when no joint is on the level. Called by soft.c in this order: begin,
// per substep pass SOFT_SOLVE, move, pass SOFT_RELAX; then end. alone: no contact on the level.
soft_joints *phys_soft_joints_begin(phys_world *world, soft_bodies *bodies, const uint32_t *index,
                                    uint32_t level, float h, bool alone);
void phys_soft_joints_pass(soft_joints *s, soft_pass pass, bool last);
void phys_soft_joints_move(soft_joints *s, bool last);
void phys_soft_joints_end(soft_joints *s);

CORE_SIMD_DECLARE(void, phys_joint_blocks,
                  (joint_block * block, uint32_t count, soft_bodies *bodies, soft_pass pass))

// With poses: makes arms and matrices anew before.
CORE_SIMD_DECLARE(void, phys_joint_points,
                  (joint_points * block, uint32_t count, soft_bodies *bodies,
                   const joint_poses *poses, soft_pass pass, float h))
CORE_SIMD_DECLARE(void, phys_joint_rods,
                  (joint_rods * block, uint32_t count, soft_bodies *bodies,
                   const joint_poses *poses, soft_pass pass, float h))
// Rows [begin, end), multiples of 16.
CORE_SIMD_DECLARE(void, phys_joint_poses,
                  (joint_poses * poses, uint32_t begin, uint32_t end, const soft_bodies *bodies))

#endif
