// Lab kernels of physics.
#ifndef PHYS_LAB_H
#define PHYS_LAB_H

#include "core/lab.h"

extern const core_lab_kernel phys_lab_motion, phys_lab_broad;

#endif
