// Integrators of free motion behind one table: explicit Euler, semi-implicit Euler, velocity Verlet
// (the report's) and classical Runge-Kutta. For bodies without contacts or joints under an
// acceleration that may depend on position, velocity and time; rotation is torque-free.
#ifndef PHYS_MOTION_H
#define PHYS_MOTION_H

#include "core/math.h"

typedef struct phys_motion {
    core_vec3 p, v;    // m, m/s
    core_quat q;       // principal axes -> world
    core_vec3 w;       // rad/s, world
    core_vec3 inertia; // principal moments, kg m^2, > 0
} phys_motion;

// Acceleration in m/s^2 of a body at p with velocity v at time t.
typedef core_vec3 phys_acceleration(void *ctx, core_vec3 p, core_vec3 v, float t);

typedef struct phys_integrator {
    const char *name; // "euler", "semi", "verlet", "rk4"
    int order;        // of the error in position and velocity over a fixed time
    int evaluations;  // of the acceleration a step
    void (*step)(phys_motion *m, phys_acceleration *f, void *ctx, float t, float dt);
} phys_integrator;

// Ends with an entry without a name.
extern const phys_integrator phys_integrators[];
const phys_integrator *phys_integrator_find(const char *name); // NULL + core_fail when unknown

#endif
