// The C library as LuaJIT sees it. Programs that run Lua are linked with -Wl,--wrap=NAME for each
// of these (wrap.mk), which routes LuaJIT's calls, from the interpreter, compiled traces and
// constant folding alike, to the engine's own functions: libm's results differ between processors.
#include "script/libc.h"

#include "core/math.h"

#include <stdarg.h>
#include <string.h>
#include <sys/syscall.h>

double __wrap_pow(double x, double y);
double __wrap_atan2(double y, double x);
double __wrap_fmod(double x, double y);
double __wrap_pow(double x, double y) { return core_pow(x, y); }
double __wrap_atan2(double y, double x) { return core_atan2(y, x); }
double __wrap_fmod(double x, double y) { return core_fmod(x, y); }

double __wrap_log(double x);
double __wrap_log(double x) { return core_ln(x); }

#define WRAP(name)                                                                                 \
    double __wrap_##name(double x);                                                                \
    double __wrap_##name(double x) { return core_##name(x); }
WRAP(sin)
WRAP(cos)
WRAP(tan)
WRAP(asin)
WRAP(acos)
WRAP(atan)
WRAP(exp)
WRAP(log2)
WRAP(log10)
WRAP(sinh)
WRAP(cosh)
WRAP(tanh)

// LuaJIT draws the seed of its string hashes when a state is made. Which kind the state wants is
// known to the caller of lua_newstate only, on the same thread.
static _Thread_local bool fixed_seed;

void script_libc_fixed_seed(bool fixed) { fixed_seed = fixed; }

long __real_syscall(long number, ...);
long __wrap_syscall(long number, ...);
long __wrap_syscall(long number, ...) {
    long a[6];
    va_list args;
    va_start(args, number);
    for (int i = 0; i < 6; i++) {
        a[i] = va_arg(args, long);
    }
    va_end(args);
    if (number == SYS_getrandom && fixed_seed) {
        memset((void *)a[0], 0x5c, (size_t)a[1]);
        return a[1];
    }
    return __real_syscall(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}
