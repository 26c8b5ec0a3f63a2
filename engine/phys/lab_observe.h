// Observers: what of a world lies near the edge of what its methods can do. They measure; the
// stability maps (assets/stability, made by the lab) say where a method fails.
#ifndef PHYS_LAB_OBSERVE_H
#define PHYS_LAB_OBSERVE_H

#include "phys/phys.h"

typedef struct phys_observed {
    double value; // largest seen, 0: none
    phys_body body, other;
    double time; // s since the world's start
} phys_observed;

typedef struct phys_observation {
    phys_observed mass;      // ratio of a body to a lighter one that carries it
    phys_observed stack;     // bodies in a tower: each rests on one other alone
    phys_observed spin;      // rad/s, of bodies whose principal moments differ
    phys_observed speed;     // m/s
    phys_observed stiffness; // 1/s^2, of force fields at the place of a body
    double thickness;        // m, thinnest static box, 0: none
} phys_observation;

// Adds the present state to `o` (zeroed before the first call): motion is cheap enough for every
// step, contacts for one step in tens. After a step, not during one.
void phys_observe_motion(phys_world *world, phys_observation *o);
void phys_observe_contacts(phys_world *world, phys_observation *o);

// Geometry of a body's first shape, for showing it: its type, and half of its extents in its own
// frame (m). False for others than balls and boxes.
bool phys_observe_shape(const phys_world *world, uint32_t row, phys_shape_type *type,
                        core_vec3 *half);

// The method that solves contacts, and what it spends a step: sub-steps and iterations.
typedef struct phys_effort {
    const char *solver;
    int substeps, iterations;
} phys_effort;
phys_effort phys_observe_effort(const phys_world *world);

#endif
