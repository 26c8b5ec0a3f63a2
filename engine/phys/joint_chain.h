// Chains: paths of ball joints that no other joint touches (ropes, pendulums). Joint i of a chain
// holds node i against node i + 1, so that its matrix is block tridiagonal and every wide load is a
// shifted one. The gap that turning leaves in a substep is taken back as speed in the next one and
// that speed given up again, which bends the way into a chord and keeps the energy; the last
// substep of a step takes it back at once along its own directions, as SHAKE does (Ryckaert et al.,
// J. Comput. Phys. 23, 1977), and what then is left in place only, so that poses at rest between
// steps have no gap.
#ifndef PHYS_JOINT_CHAIN_H
#define PHYS_JOINT_CHAIN_H

#include "phys/soft.h"

// Columns of floats by slot, one for each component. A slot is a node and the joint after it; slots
// beyond a chain's last node are zero.
enum {
    CHAIN_P = 0,   // centre, m
    CHAIN_Q = 3,   // rotation
    CHAIN_V = 7,   // velocity, then angular velocity
    CHAIN_IM = 13, // inverse mass
    CHAIN_I = 14,  // world inverse inertia: xx yy zz xy xz yz
    CHAIN_LA = 20, // arm of the joint on its node, body axes
    CHAIN_LB = 23, // and on the next node
    CHAIN_RA = 26,
    CHAIN_RB = 29, // both in world axes
    CHAIN_D = 32,  // block of the joint: xx yy zz xy xz yz
    CHAIN_E = 38,  // block of the joint with the next one, by columns
    CHAIN_RHS = 47,
    CHAIN_X = 50,    // what is missing, m/s; the impulse on the next node, N s
    CHAIN_LOAD = 53, // sum of impulses in the step, N s
    CHAIN_COLUMNS = 56
};

typedef struct joint_chain {
    uint32_t first, joints; // slot of node 0
} joint_chain;

typedef struct joint_factor { // of one joint in the elimination
    double inverse[6], spread[9], y[3];
} joint_factor;

typedef struct joint_chains {
    joint_chain *chain;
    uint32_t count, slots;
    float *data;         // [CHAIN_COLUMNS][slots]
    int32_t *place, *to; // by slot: row of soft_bodies to read; to write, the empty one if it stays
    uint32_t *work;      // by slot: joint_work
    joint_factor *factor;
} joint_chains;

typedef enum chain_pass {
    CHAIN_BEGIN, // matrix of the present pose
    CHAIN_SOLVE, // speeds that close the gap in this substep
    CHAIN_RELAX, // speeds that keep it
    CHAIN_MOVE,  // after the bodies moved: follows them, then as CHAIN_BEGIN
    CHAIN_LAST   // the same at the end of a step: takes the gap back
} chain_pass;

CORE_SIMD_DECLARE(void, phys_joint_chain,
                  (joint_chains * chains, uint32_t index, soft_bodies *bodies, chain_pass pass,
                   float h))

#endif
