// The lab kernels of all rooms, NULL-terminated.
#ifndef APP_LAB_KERNELS_H
#define APP_LAB_KERNELS_H

#include "core/lab.h"

extern const core_lab_kernel *const app_lab_kernels[];

#endif
