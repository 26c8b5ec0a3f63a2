// Lab kernel of the script room.
#ifndef SCRIPT_LAB_H
#define SCRIPT_LAB_H

#include "core/lab.h"

// "script_access": one pass over n bodies by each way that Lua has, against the same loop in C.
extern const core_lab_kernel script_lab_access;

#endif
