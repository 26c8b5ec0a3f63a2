// Fast paths of trusted code: number methods, random numbers and column views without Lua's stack.
#include "script/fast.h"

#include "script/bind_body.h"
#include "script/internal.h"

static double fast_random(script *s) { return core_rng_double(script_stream(s)); }

static void fast_columns(script *s, script_columns *out) {
    phys_world *world = scene_phys(s->scene);
    phys_pose_view v = phys_world_poses(world);
    *out = (script_columns){.n = v.count,
                            .px = v.px,
                            .py = v.py,
                            .pz = v.pz,
                            .qx = v.qx,
                            .qy = v.qy,
                            .qz = v.qz,
                            .qw = v.qw};
    // The velocities are the world's columns of record; writing them is what this view is for.
    out->vx = (float *)(uintptr_t)v.vx;
    out->vy = (float *)(uintptr_t)v.vy;
    out->vz = (float *)(uintptr_t)v.vz;
    out->wx = (float *)(uintptr_t)v.wx;
    out->wy = (float *)(uintptr_t)v.wy;
    out->wz = (float *)(uintptr_t)v.wz;
}

static uint32_t fast_row(script *s, uint32_t index, uint32_t generation) {
    phys_world *world = scene_phys_if(s->scene);
    return world ? phys_body_row(world, (core_handle){index, generation}) : CORE_NO_ROW;
}

// Sets the row's velocities to what stands in the columns: that checks them and wakes the body.
static bool fast_touch(script *s, uint32_t row) {
    phys_world *world = scene_phys_if(s->scene);
    if (!world || row >= phys_body_count(world)) {
        return core_fail_quiet("touch: row %u, expected less than n", (unsigned)row);
    }
    phys_pose_view v = phys_world_poses(world);
    phys_body body = phys_body_at(world, row);
    core_vec3 velocity = {v.vx[row], v.vy[row], v.vz[row]};
    core_vec3 angular = {v.wx[row], v.wy[row], v.wz[row]};
    return (s->phase & BIND_SIM) && phys_body_set_velocity(world, body, velocity) &&
           phys_body_set_angular_velocity(world, body, angular);
}

script_fast script_fast_table(script *s) {
    return (script_fast){s, bind_call_numbers, fast_random, fast_columns, fast_row, fast_touch};
}

static int count_args(const bind_fn *fn) {
    int n = 0;
    while (fn->args && fn->args[n].name) {
        n++;
    }
    return n;
}
static int count_returns(const bind_fn *fn) {
    int n = 0;
    while (fn->returns && fn->returns[n].name) {
        n++;
    }
    return n;
}

int script_fast_methods(lua_State *L) {
    const script *s = lua_touserdata(L, lua_upvalueindex(1));
    int count = 0;
    lua_newtable(L);
    for (int i = 0; i < s->type_count; i++) {
        const bind_type *type = s->type[i].type;
        for (const bind_fn *fn = type->methods; fn->name; fn++) {
            if (!fn->numbers) {
                continue;
            }
            lua_newtable(L);
            lua_rawgeti(L, LUA_REGISTRYINDEX, s->type[i].metatable_ref);
            lua_getfield(L, -1, "__index");
            lua_setfield(L, -3, "methods");
            lua_pop(L, 1);
            lua_pushstring(L, fn->name);
            lua_setfield(L, -2, "name");
            lua_pushlightuserdata(L, (void *)(uintptr_t)fn);
            lua_setfield(L, -2, "fn");
            lua_pushlightuserdata(L, (void *)(uintptr_t)type);
            lua_setfield(L, -2, "type");
            lua_pushnumber(L, count_args(fn));
            lua_setfield(L, -2, "args");
            lua_pushnumber(L, count_returns(fn));
            lua_setfield(L, -2, "returns");
            lua_rawseti(L, -2, ++count);
        }
    }
    return 1;
}
