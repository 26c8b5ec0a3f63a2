// The physics scenes S1, S2 and S6 as C functions: tests and benches build the same worlds.
#ifndef SUPPORT_PHYS_SCENES_H
#define SUPPORT_PHYS_SCENES_H

#include "phys/phys.h"

// S1: n balls of radius 0.5 m over a bin; S6 (hulls): n convex hulls of 8..32 corners, turned.
void phys_scene_pile(phys_world *world, int n, bool hulls);
// S2: a pyramid of unit cubes, n in the lowest row. Returns the top cube.
phys_body phys_scene_pyramid(phys_world *world, int n);
// Static box.
phys_body phys_scene_wall(phys_world *world, core_vec3 at, core_vec3 half);

#endif
