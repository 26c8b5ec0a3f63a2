// Lab kernel "script_access": the ways from Lua to the bodies. Each reads every position, adds to
// every velocity, and must leave the same bits as the loop in C. Also the cost of a callback that
// does nothing, and of a mod's call behind the guard.
#include "script/lab.h"

#include "core/math.h"
#include "script/bind_body.h"
#include "script/guard.h"
#include "script/internal.h"

#include <string.h>

typedef struct access_method {
    const char *name;
    const char *code; // Lua that returns the function of one pass; NULL: C, or the guard
} access_method;

static const access_method methods[] = {
    {"c", NULL},
    {"columns", "local phys = corsac.phys return function() local c = phys.columns() "
                "for i = 0, c.n - 1 do "
                "c.vy[i] = c.vy[i] + 0.001 * (c.px[i] + c.py[i] + c.pz[i]) end end"},
    {"checked", "local phys = corsac.phys return function() local c = phys.columns{checked = true} "
                "for i = 0, c.n - 1 do "
                "c.vy[i] = c.vy[i] + 0.001 * (c.px[i] + c.py[i] + c.pz[i]) end end"},
    {"methods", "local bodies = ... return function() for i = 1, #bodies do local b = bodies[i] "
                "local x, y, z = b:getPosition() local vx, vy, vz = b:getVelocity() "
                "b:setVelocity(vx, vy + 0.001 * (x + y + z), vz) end end"},
    {"interpreted", "local bodies = ... local function pass() for i = 1, #bodies do "
                    "local b = bodies[i] local x, y, z = b:getPosition() "
                    "local vx, vy, vz = b:getVelocity() "
                    "b:setVelocity(vx, vy + 0.001 * (x + y + z), vz) end end "
                    "jit.off(pass, true) return pass"},
    {"empty", "return function() end"},
    {"lua", "return function() local s = 0 for i = 1, 10000 do s = s + i * 0.5 end return s end"},
    {"guarded", NULL},
};

typedef struct access_run {
    scene *scene;
    script *script;
    script_guard guard;
    lua_State *mod;
    int function; // reference in the registry of its state
} access_run;

static void pass_in_c(void *ctx) {
    access_run *r = ctx;
    phys_pose_view v = phys_world_poses(scene_phys(r->scene));
    float *vy = (float *)(uintptr_t)v.vy;
    for (uint32_t i = 0; i < v.count; i++) {
        double sum = (double)v.px[i] + (double)v.py[i] + (double)v.pz[i];
        vy[i] = (float)((double)vy[i] + 0.001 * sum);
    }
}

static void pass_in_lua(void *ctx) {
    access_run *r = ctx;
    lua_rawgeti(r->script->L, LUA_REGISTRYINDEX, r->function);
    script_call(r->script, BIND_FIXED, 0, 0);
}

static void pass_in_mod(void *ctx) {
    access_run *r = ctx;
    lua_rawgeti(r->mod, LUA_REGISTRYINDEX, r->function);
    script_guard_begin(&r->guard, INT64_MAX / 2);
    lua_pcall(r->mod, 0, 0, 0);
    script_guard_end(&r->guard);
    lua_settop(r->mod, 0);
}

static void add_bodies(scene *s, uint32_t n) {
    phys_world *world = scene_phys(s);
    for (uint32_t i = 0; i < n; i++) {
        phys_body_desc body = phys_body_desc_default();
        phys_shape_desc shape = phys_shape_desc_default(PHYS_SPHERE);
        shape.radius = 0.2f;
        body.position = core_v3((float)(i % 100), (float)(i / 10000), (float)(i / 100 % 100));
        phys_body_create(world, &body, &shape, 1);
    }
}

static bool prepare(access_run *r, const access_method *m) {
    lua_State *L = r->script->L;
    if (strcmp(m->name, "guarded") == 0) {
        const char *code = methods[CORE_COUNT_OF(methods) - 2].code;
        r->mod = script_guard_state(&r->guard);
        if (!r->mod || luaL_loadstring(r->mod, code) || lua_pcall(r->mod, 0, 1, 0)) {
            return core_fail("lab: the guarded state does not run");
        }
        r->function = luaL_ref(r->mod, LUA_REGISTRYINDEX);
        return true;
    }
    if (!m->code) {
        return true;
    }
    phys_world *world = scene_phys(r->scene);
    if (luaL_loadstring(L, m->code)) {
        return core_fail("lab: %s", lua_tostring(L, -1));
    }
    lua_newtable(L);
    for (uint32_t i = 0; i < phys_body_count(world); i++) {
        bind_push(r->script, L, &bind_body_type, phys_body_at(world, i));
        lua_rawseti(L, -2, (int)i + 1);
    }
    if (!script_call(r->script, BIND_FIXED, 1, 1)) {
        return core_fail("lab: %s", script_last_error(r->script));
    }
    r->function = luaL_ref(L, LUA_REGISTRYINDEX);
    return true;
}

static double largest_difference(const access_run *a, const access_run *b) {
    phys_pose_view va = phys_world_poses(scene_phys(a->scene));
    phys_pose_view vb = phys_world_poses(scene_phys(b->scene));
    double worst = 0;
    for (uint32_t i = 0; i < va.count; i++) {
        double d = (double)va.vy[i] - (double)vb.vy[i];
        worst = CORE_MAX(worst, d < 0 ? -d : d);
    }
    return worst;
}

static bool open_run(access_run *r, uint32_t n) {
    scene_desc options = scene_desc_default();
    script_desc made = script_desc_default();
    r->scene = scene_create(&options);
    made.scene = r->scene;
    r->script = r->scene ? script_create(&made) : NULL;
    if (!r->script) {
        return false;
    }
    add_bodies(r->scene, n);
    return true;
}

static void close_run(access_run *r) {
    if (r->mod) {
        lua_close(r->mod);
    }
    script_destroy(r->script);
    scene_destroy(r->scene);
}

static bool run(const core_lab_case *c, core_json *out) {
    const char *name = core_lab_text(c, "method", "columns");
    double count = core_lab_number(c, "n", 10000);
    const access_method *m = NULL;
    for (size_t i = 0; i < CORE_COUNT_OF(methods); i++) {
        m = strcmp(methods[i].name, name) == 0 ? &methods[i] : m;
    }
    if (!m || !(count >= 1 && count <= 100000)) {
        return core_fail(
            "lab script_access: method %s, n %g: expected c, columns, checked, methods, "
            "interpreted, empty, lua or guarded, and 1 to 100000 bodies",
            name, count);
    }
    access_run r = {0}, reference = {0};
    bool good =
        open_run(&r, (uint32_t)count) && open_run(&reference, (uint32_t)count) && prepare(&r, m);
    core_lab_body *body = r.mod ? pass_in_mod : m->code ? pass_in_lua : pass_in_c;
    bool bodies = strcmp(name, "empty") != 0 && strcmp(name, "lua") != 0 && !r.mod;
    if (good) {
        body(&r);
        if (bodies) {
            pass_in_c(&reference);
        }
        core_json_number(out, "error", largest_difference(&r, &reference));
        if (core_lab_number(c, "timed", 0) != 0) {
            double cost = core_lab_time(body, &r, 2e8);
            core_json_number(out, "cost_ns", bodies ? cost / count : cost);
        }
        good =
            script_error_count(r.script) == 0 || core_fail("lab: %s", script_last_error(r.script));
    }
    close_run(&r);
    close_run(&reference);
    return good;
}

const core_lab_kernel script_lab_access = {
    "script_access", "one pass over n bodies from Lua, against the same loop in C",
    "method: c|columns|checked|methods|interpreted|empty|lua|guarded; n: bodies", run};
