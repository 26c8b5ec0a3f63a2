// LuaJIT's view of the C library (libc.c).
#ifndef SCRIPT_LIBC_H
#define SCRIPT_LIBC_H

#include "core/base.h"

// true: states made on this thread get the same string-hash seed in every run; false: a random one.
void script_libc_fixed_seed(bool fixed);

#endif
