// What compiled Lua reaches through FFI, in trusted states only: scripts/corsac/fast.lua and
// columns.lua declare the same structs.
#ifndef SCRIPT_FAST_H
#define SCRIPT_FAST_H

#include "script/bind.h"

typedef struct script_columns {
    uint32_t n;
    const float *px, *py, *pz, *qx, *qy, *qz, *qw;
    float *vx, *vy, *vz, *wx, *wy, *wz; // writable, followed by touch(row)
} script_columns;

typedef struct script_fast {
    script *self;
    bool (*numbers)(script *s, const bind_fn *fn, const bind_type *type, uint32_t index,
                    uint32_t generation, double *v);
    double (*random)(script *s);
    void (*columns)(script *s, script_columns *out);
    uint32_t (*row)(script *s, uint32_t index, uint32_t generation); // UINT32_MAX: none
    bool (*touch)(script *s, uint32_t row); // false: static, not finite, no such row
} script_fast;

script_fast script_fast_table(script *s);
// fast_methods() -> list of {type name, method name, declaration, type, arguments, returns}
int script_fast_methods(lua_State *L);

#endif
