// Character movers: the part of corsac.phys that bind_mover.c declares.
#ifndef SCRIPT_BIND_MOVER_H
#define SCRIPT_BIND_MOVER_H

#include "script/bind.h"

extern const bind_fn bind_mover_functions[];
extern const bind_type bind_mover_type;

#endif
