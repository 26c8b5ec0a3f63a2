// Lab kernels of this room.
#ifndef NAV_LAB_H
#define NAV_LAB_H

#include "core/lab.h"

// "nav_search": us for one query against the length of its way, over the exact Euclidean one.
extern const core_lab_kernel nav_lab_search;
// "nav_build": ms for a walkable surface against the share of the ground that it misses.
extern const core_lab_kernel nav_lab_build;

#endif
