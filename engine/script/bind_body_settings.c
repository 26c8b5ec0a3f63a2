// corsac.phys: what a body was made with, read and changed later; snapshots of the world.
#include "script/bind_body_settings.h"
#include "script/bind_body.h"
#include "script/internal.h"

#include "core/hash.h"

#include <string.h>

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

int bind_body_get_type(script *s, lua_State *L, void *args) {
    static const char *const names[] = {"dynamic", "static", "kinematic"};
    phys_body_settings now;
    done(L, phys_body_read(scene_phys(s->scene), *(core_handle *)args, &now));
    lua_pushstring(L, names[now.type]);
    return 1;
}

int bind_body_get_shape(script *s, lua_State *L, void *args) {
    const bind_shape_args *a = args;
    phys_shape_type type;
    phys_material material;
    uint32_t number = a->number > UINT32_MAX ? UINT32_MAX : (uint32_t)a->number - 1;
    done(L, phys_body_shape(scene_phys(s->scene), a->self, number, &type, &material));
    lua_pushstring(L, bind_shape_name(type));
    return 1;
}

bool bind_body_get_shape_count(script *s, core_handle self, double *v) {
    phys_body_settings now;
    bool good = phys_body_read(scene_phys(s->scene), self, &now);
    v[0] = (double)now.shape_count;
    return good;
}

bool bind_body_set_damping(script *s, core_handle self, double *v) {
    phys_body_settings now;
    if (!phys_body_read(scene_phys(s->scene), self, &now)) {
        return false;
    }
    now.linear_damping = (float)v[0];
    now.angular_damping = (float)v[1];
    return phys_body_write(scene_phys(s->scene), self, &now);
}

bool bind_body_get_damping(script *s, core_handle self, double *v) {
    phys_body_settings now;
    bool good = phys_body_read(scene_phys(s->scene), self, &now);
    v[0] = (double)now.linear_damping;
    v[1] = (double)now.angular_damping;
    return good;
}

bool bind_body_set_gravity_scale(script *s, core_handle self, double *v) {
    phys_body_settings now;
    if (!phys_body_read(scene_phys(s->scene), self, &now)) {
        return false;
    }
    now.gravity_scale = (float)v[0];
    return phys_body_write(scene_phys(s->scene), self, &now);
}

bool bind_body_get_gravity_scale(script *s, core_handle self, double *v) {
    phys_body_settings now;
    bool good = phys_body_read(scene_phys(s->scene), self, &now);
    v[0] = (double)now.gravity_scale;
    return good;
}

int bind_body_set_locks(script *s, lua_State *L, void *args) {
    const bind_locks_args *a = args;
    phys_body_settings now;
    done(L, phys_body_read(scene_phys(s->scene), a->self, &now));
    now.locks = bind_locks(L, "Body:setLocks", a->words);
    return done(L, phys_body_write(scene_phys(s->scene), a->self, &now));
}

int bind_body_get_locks(script *s, lua_State *L, void *args) {
    static const char *const names[] = {"x", "y", "z", "turnX", "turnY", "turnZ"};
    char words[32] = "";
    phys_body_settings now;
    done(L, phys_body_read(scene_phys(s->scene), *(core_handle *)args, &now));
    for (uint32_t k = 0; k < CORE_COUNT_OF(names); k++) {
        if (now.locks >> k & 1u) {
            strcat(strcat(words, words[0] ? " " : ""), names[k]);
        }
    }
    lua_pushstring(L, words);
    return 1;
}

bool bind_body_set_material(script *s, core_handle self, double *v) {
    phys_material m = {(float)v[0], (float)v[1], (float)v[2]};
    return phys_body_set_material(scene_phys(s->scene), self, &m);
}

bool bind_body_get_material(script *s, core_handle self, double *v) {
    phys_shape_type type;
    phys_material m = {0};
    bool good = phys_body_shape(scene_phys(s->scene), self, 0, &type, &m);
    v[0] = (double)m.friction;
    v[1] = (double)m.restitution;
    v[2] = (double)m.rolling;
    return good;
}

// ---- snapshots ----

// A snapshot can only go back into a world of the same bodies, of which scripts and entities hold
// handles: who they are is hashed and put in front.
static uint64_t who_is_there(phys_world *world) {
    uint64_t h = phys_body_count(world);
    for (uint32_t i = 0; i < phys_body_count(world); i++) {
        core_handle body = phys_body_at(world, i);
        h = core_hash_mix(h, (uint64_t)body.generation << 32 | body.index);
    }
    return core_hash_mix(h, phys_joint_count(world));
}

static int save_state(script *s, lua_State *L, void *args) {
    (void)args;
    phys_world *world = scene_phys(s->scene);
    size_t size = phys_world_save_size(world);
    uint8_t *data = lua_newuserdata(L, sizeof(uint64_t) + size);
    uint64_t who = who_is_there(world);
    memcpy(data, &who, sizeof who);
    phys_world_save(world, data + sizeof who);
    lua_pushlstring(L, (const char *)data, sizeof who + size);
    return 1;
}

typedef struct restore_args {
    int state; // stack index
} restore_args;

static int restore_state(script *s, lua_State *L, void *args) {
    const restore_args *a = args;
    phys_world *world = scene_phys(s->scene);
    size_t size = 0;
    const char *data = lua_isstring(L, a->state) ? lua_tolstring(L, a->state, &size) : NULL;
    uint64_t who;
    if (data == NULL || size <= sizeof who) {
        bind_error(L, "corsac.phys.restoreState: expected what saveState gave");
    }
    memcpy(&who, data, sizeof who);
    if (who != who_is_there(world)) {
        bind_error(L, "corsac.phys.restoreState: bodies or joints were made or destroyed since; "
                      "only a world of the same ones goes back");
    }
    return done(L, phys_world_restore(world, data + sizeof who, size - sizeof who));
}

const bind_fn bind_state_functions[] = {
    {"saveState", "Where everything is and how it moves, as a string, for restoreState.", NULL,
     BIND_RETURNS({"state", "string", NULL}), 0, BIND_RUNNING, .cost = 20000, .run = save_state},
    {"restoreState",
     "Goes back to a saved state; the world then goes on with the same bits. The bodies must be "
     "those of then.",
     BIND_ARGS({"state", BIND_VALUE, BIND_AT(restore_args, state), "from saveState"}), NULL,
     sizeof(restore_args), BIND_SIM, .cost = 20000, .run = restore_state},
    {0}};
