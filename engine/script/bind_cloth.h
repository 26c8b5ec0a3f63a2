// Ropes and cloth: the part of corsac.phys that bind_cloth.c declares.
#ifndef SCRIPT_BIND_CLOTH_H
#define SCRIPT_BIND_CLOTH_H

#include "script/bind.h"

extern const bind_fn bind_cloth_functions[];
extern const bind_fn bind_ragdoll_functions[]; // bind_ragdoll.c
extern const bind_type bind_cloth_type;

#endif
