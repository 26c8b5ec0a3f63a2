// corsac.phys.newJoint and the methods of joints.
#include "script/bind_joint.h"

#include "script/bind_body.h"
#include "script/events.h"

#define JOINT_TYPES "fixed|ball|distance|revolute|prismatic|universal|pivot|pulley"

typedef struct joint_options {
    int type;
    core_handle a, b;
    core_vec3 anchor, anchor_b, axis, axis_b, ground_a, ground_b;
    float lower, upper, cone, motor_speed, motor_max, hertz, rest, damping_ratio, damping, ratio;
    float break_force, break_torque;
    bool collide, has_anchor_b, has_axis_b, has_lower, has_upper, has_motor;
    int on_break;
} joint_options;
typedef struct joint_call {
    joint_options options;
} joint_call;

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

static int new_joint(script *s, lua_State *L, void *args) {
    const joint_options *o = &((joint_call *)args)->options;
    phys_joint_desc d = phys_joint_desc_default((phys_joint_type)o->type);
    d.a = o->a;
    d.b = o->b;
    d.anchor = d.anchor_a = o->anchor;
    d.anchor_b = o->has_anchor_b ? o->anchor_b : o->anchor;
    d.axis = o->axis;
    d.axis_b = o->has_axis_b ? o->axis_b : d.axis_b;
    d.ground_a = o->ground_a;
    d.ground_b = o->ground_b;
    if (o->has_lower != o->has_upper && o->type != PHYS_JOINT_DISTANCE) {
        bind_error(L, "corsac.phys.newJoint: give both lower and upper, or neither");
    }
    d.limit = o->has_lower || o->has_upper;
    d.lower = o->lower;
    d.upper = d.limit && !o->has_upper ? 1e6f : o->upper;
    d.cone = o->cone;
    d.motor = o->has_motor;
    d.motor_speed = o->motor_speed;
    d.motor_max = o->motor_max;
    d.hertz = o->hertz;
    d.rest = o->rest;
    d.damping_ratio = o->damping_ratio;
    d.damping = o->damping;
    d.ratio = o->ratio;
    d.break_force = o->break_force;
    d.break_torque = o->break_torque;
    d.collide_connected = o->collide;
    phys_joint joint = phys_joint_create(scene_phys(s->scene), &d);
    if (core_handle_is_null(joint)) {
        bind_fail(L);
    }
    if (o->on_break) {
        script_keep_callbacks(s, L, SCRIPT_ON_BREAK, joint, (const int[]){o->on_break, 0, 0});
    }
    bind_push(s, L, &bind_joint_type, joint);
    return 1;
}

static bool joint_alive(script *s, core_handle h) {
    phys_world *world = scene_phys_if(s->scene);
    return world && phys_joint_alive(world, h);
}

static int push_load(script *s, lua_State *L, core_handle self, bool torque) {
    core_vec3 load[2];
    if (!phys_joint_force(scene_phys(s->scene), self, &load[0], &load[1])) {
        bind_fail(L);
    }
    bind_push_vec3(L, load[torque]);
    return 3;
}
static int get_force(script *s, lua_State *L, void *args) {
    return push_load(s, L, *(core_handle *)args, false);
}
static int get_torque(script *s, lua_State *L, void *args) {
    return push_load(s, L, *(core_handle *)args, true);
}

static int get_value(script *s, lua_State *L, void *args) {
    float value;
    if (!phys_joint_coordinate(scene_phys(s->scene), *(core_handle *)args, &value)) {
        bind_fail(L);
    }
    lua_pushnumber(L, (double)value);
    return 1;
}

typedef struct motor_args {
    core_handle self;
    float speed, max;
} motor_args;
static int set_motor(script *s, lua_State *L, void *args) {
    const motor_args *a = args;
    return done(
        L, phys_joint_set_motor(scene_phys(s->scene), a->self, a->max > 0.0f, a->speed, a->max));
}

typedef struct limit_args {
    core_handle self;
    float lower, upper;
} limit_args;
static int set_limits(script *s, lua_State *L, void *args) {
    const limit_args *a = args;
    return done(L, phys_joint_set_limits(scene_phys(s->scene), a->self, true, a->lower, a->upper));
}

typedef struct spring_args {
    core_handle self;
    float hertz, damping_ratio, rest;
} spring_args;
static int set_spring(script *s, lua_State *L, void *args) {
    const spring_args *a = args;
    return done(L, phys_joint_set_spring(scene_phys(s->scene), a->self, a->hertz, a->damping_ratio,
                                         a->rest));
}

static int get_joint_count(script *s, lua_State *L, void *args) {
    (void)args;
    phys_world *world = scene_phys_if(s->scene);
    lua_pushinteger(L, world ? (lua_Integer)phys_joint_count(world) : 0);
    return 1;
}

static int is_destroyed(script *s, lua_State *L, void *args) {
    lua_pushboolean(L, !joint_alive(s, *(core_handle *)args));
    return 1;
}

static int destroy(script *s, lua_State *L, void *args) {
    return done(L, phys_joint_destroy(scene_phys(s->scene), *(core_handle *)args));
}

// ---- declarations ----

#define XYZ(unit) BIND_RETURNS({"x", "number", unit}, {"y", "number", unit}, {"z", "number", unit})

static const bind_fn methods[] = {
    {"getForce", "What it did to body b at the anchor, mean over the last step.", NULL, XYZ("N"),
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 8, .run = get_force},
    {"getTorque", "The same about the anchor.", NULL, XYZ("N m"), sizeof(core_handle), BIND_RUNNING,
     .mod = true, .cost = 8, .run = get_torque},
    {"getValue",
     "Angle in rad (revolute; ball: twist; universal: of axisB about axis), way in m (prismatic) "
     "or "
     "length in m (distance; pulley: a's side).",
     NULL, BIND_RETURNS({"value", "number", NULL}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 20, .run = get_value},
    {"setMotor", "Drives all but fixed and ball joints; a pivot's turns b.",
     BIND_ARGS({"speed", BIND_FLOAT, BIND_AT(motor_args, speed), "of b against a", "m/s or rad/s"},
               {"max", BIND_FLOAT, BIND_AT(motor_args, max), "most it gives; 0 turns it off",
                "N or N m", BIND_NOT_NEGATIVE}),
     NULL, sizeof(motor_args), BIND_SIM, .mod = true, .cost = 8, .run = set_motor},
    {"setLimits", "Range of getValue.",
     BIND_ARGS({"lower", BIND_FLOAT, BIND_AT(limit_args, lower), "", "m or rad"},
               {"upper", BIND_FLOAT, BIND_AT(limit_args, upper), "", "m or rad"}),
     NULL, sizeof(limit_args), BIND_SIM, .mod = true, .cost = 8, .run = set_limits},
    {"setSpring", "Spring towards a value of getValue.",
     BIND_ARGS({"hertz", BIND_FLOAT, BIND_AT(spring_args, hertz), "0 turns it off", "Hz",
                BIND_NOT_NEGATIVE},
               {"dampingRatio", BIND_FLOAT, BIND_AT(spring_args, damping_ratio),
                "1 comes to rest soonest", NULL, BIND_NOT_NEGATIVE, .optional = true, .def = 1},
               {"rest", BIND_FLOAT, BIND_AT(spring_args, rest), "where it comes to rest",
                "m or rad", .optional = true}),
     NULL, sizeof(spring_args), BIND_SIM, .mod = true, .cost = 8, .run = set_spring},
    {"isDestroyed", "Whether it broke or was destroyed; every other method then raises an error.",
     NULL, BIND_RETURNS({"destroyed", "boolean", NULL}), sizeof(core_handle), BIND_ANY, .mod = true,
     .cost = 2, .run = is_destroyed},
    {"destroy", "Removes it; onBreak is not called.", NULL, NULL, sizeof(core_handle), BIND_SIM,
     .mod = true, .cost = 20, .run = destroy},
    {0}};
const bind_type bind_joint_type = {"Joint", "What holds two bodies, or a body and the world.",
                                   joint_alive, methods};

#define OPTION(name, kind, member, ...)                                                            \
    { name, kind, BIND_AT(joint_options, member), __VA_ARGS__ }

static const bind_arg fields[] = {
    OPTION("type", BIND_ENUM, type, "kind of joint", .values = JOINT_TYPES),
    OPTION("a", BIND_OBJECT, a, "without, the world", .optional = true, .type = &bind_body_type),
    OPTION("b", BIND_OBJECT, b, "without, the world", .optional = true, .type = &bind_body_type),
    OPTION("anchor", BIND_VEC3, anchor, "place in the world; distance, pulley: on a", "m",
           .optional = true),
    OPTION("anchorB", BIND_VEC3, anchor_b, "distance, pulley: on b", "m", .optional = true,
           .def_text = "anchor", BIND_GIVEN(joint_options, has_anchor_b)),
    OPTION("axis", BIND_VEC3, axis, "direction in the world", .optional = true,
           .def_vec = {0, 1, 0}),
    OPTION("axisB", BIND_VEC3, axis_b, "universal (+x), pivot (axis): that of b", .optional = true,
           .def_text = "by type", BIND_GIVEN(joint_options, has_axis_b)),
    OPTION("lower", BIND_FLOAT, lower,
           "ball (twist), distance, revolute, prismatic, universal, pulley (a's side)", "m or rad",
           .optional = true, BIND_GIVEN(joint_options, has_lower)),
    OPTION("upper", BIND_FLOAT, upper, "with lower; alone for a rope", "m or rad", .optional = true,
           BIND_GIVEN(joint_options, has_upper)),
    OPTION("cone", BIND_FLOAT, cone,
           "ball: largest lean of the axis; universal: turn about axisB to either side; 0 for none",
           "rad", BIND_NOT_NEGATIVE, .optional = true),
    OPTION("motorSpeed", BIND_FLOAT, motor_speed, "of b against a", "m/s or rad/s",
           .optional = true),
    OPTION("motorMax", BIND_FLOAT, motor_max, "most the motor gives", "N or N m", BIND_NOT_NEGATIVE,
           .optional = true, BIND_GIVEN(joint_options, has_motor)),
    OPTION("hertz", BIND_FLOAT, hertz, "spring; 0 for none", "Hz", BIND_NOT_NEGATIVE,
           .optional = true),
    OPTION("rest", BIND_FLOAT, rest, "of the spring; distance: 0 is the present one", "m or rad",
           .optional = true),
    OPTION("dampingRatio", BIND_FLOAT, damping_ratio, "of the spring", NULL, BIND_NOT_NEGATIVE,
           .optional = true, .def = 1),
    OPTION("damping", BIND_FLOAT, damping, "without a spring as well", "N s/m or N m s/rad",
           BIND_NOT_NEGATIVE, .optional = true),
    OPTION("ratio", BIND_FLOAT, ratio, "pivot: turns of a for one of b; pulley: pull on b over a",
           .optional = true, .def = 1),
    OPTION("groundA", BIND_VEC3, ground_a, "pulley: wheel above a", "m", .optional = true),
    OPTION("groundB", BIND_VEC3, ground_b, "pulley: wheel above b", "m", .optional = true),
    OPTION("breakForce", BIND_FLOAT, break_force, "breaks beyond; 0 for never", "N",
           BIND_NOT_NEGATIVE, .optional = true),
    OPTION("breakTorque", BIND_FLOAT, break_torque, "breaks beyond; 0 for never", "N m",
           BIND_NOT_NEGATIVE, .optional = true),
    OPTION("collide", BIND_BOOL, collide, "a and b touch as if not joined", .optional = true),
    OPTION("onBreak", BIND_FUNCTION, on_break,
           "called with a and b (nil: the world or destroyed) when it breaks or one is destroyed",
           .optional = true, .def_text = "none"),
    {0}};

const bind_fn bind_joint_functions[] = {
    {"newJoint", "Joins two bodies, or a body and the world.",
     BIND_ARGS(
         {"options", BIND_OPTIONS, BIND_AT(joint_call, options), "the joint", .fields = fields}),
     BIND_RETURNS({"joint", "corsac.Joint", NULL}), sizeof(joint_call), BIND_SIM, .mod = true,
     .cost = 500, .run = new_joint},
    {"getJointCount", "How many joints the world has.", NULL,
     BIND_RETURNS({"count", "integer", NULL}), 0, BIND_RUNNING, .mod = true, .cost = 4,
     .run = get_joint_count},
    {0}};
