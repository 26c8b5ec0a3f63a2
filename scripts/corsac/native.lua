-- What the engine offers to compiled code (engine/script/fast.h): the same structs, for FFI.
local engine = ...
local ffi = require("ffi")

ffi.cdef [[
typedef struct { uint32_t index, generation; const void *type; } corsac_object;
typedef struct {
    uint32_t n;
    const float *px, *py, *pz, *qx, *qy, *qz, *qw;
    float *vx, *vy, *vz, *wx, *wy, *wz;
} corsac_columns;
typedef struct {
    void *self;
    bool (*numbers)(void *s, const void *fn, const void *type, uint32_t index,
                    uint32_t generation, double *v);
    double (*random)(void *s);
    void (*columns)(void *s, corsac_columns *out);
    uint32_t (*row)(void *s, uint32_t index, uint32_t generation);
    bool (*touch)(void *s, uint32_t row);
} corsac_fast;
]]

local fast = ffi.cast("corsac_fast *", engine.fast)
engine.ffi, engine.native = ffi, fast

function engine.random() return fast.random(fast.self) end
