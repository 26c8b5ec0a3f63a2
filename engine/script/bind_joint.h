// Joints: the part of corsac.phys that bind_joint.c declares.
#ifndef SCRIPT_BIND_JOINT_H
#define SCRIPT_BIND_JOINT_H

#include "script/bind.h"

extern const bind_fn bind_joint_functions[];
extern const bind_type bind_joint_type;

#endif
