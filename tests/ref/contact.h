// Reference contacts in double precision: spheres and boxes with Coulomb friction and restitution,
// on static boxes or planes, in small steps whose contact impulses are solved to convergence. Slow,
// scalar and meant to be obviously right; libm is allowed here. SI units.
#ifndef TESTS_REF_CONTACT_H
#define TESTS_REF_CONTACT_H

#include "ref/motion.h"

#define REF_BODIES   64
#define REF_CONTACTS 1024

typedef enum ref_shape { REF_SPHERE, REF_BOX, REF_PLANE } ref_shape; // plane: y <= 0 of its frame

typedef struct ref_body {
    ref_shape shape;
    double radius;      // sphere
    ref_vec half;       // box
    double mass;        // 0: static
    double friction;    // of a pair: root of the product
    double restitution; // of a pair: the larger
    ref_vec p, v, w;    // w: world
    ref_quat q;         // zero: identity
    ref_vec inertia;    // principal moments; zero: those of the shape, solid
} ref_body;

typedef struct ref_world {
    ref_vec gravity;
    ref_body body[REF_BODIES];
    int count;
    double residual; // largest change of an impulse in the last sweep of the last step (N s)
    int contacts;    // of the last step
} ref_world;

// Adds a body and fills what it left zero. Returns its index.
int ref_world_add(ref_world *world, ref_body body);
// Advances by t in `steps` equal steps.
void ref_world_run(ref_world *world, double t, int steps);
double ref_world_energy(const ref_world *world);
ref_vec ref_world_momentum(const ref_world *world);

#endif
