#include "app/lab_kernels.h"

const core_lab_kernel *const app_lab_kernels[] = {&core_lab_math, &core_lab_layout, NULL};
