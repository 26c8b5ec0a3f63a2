// corsac.phys: bodies.
#include "script/bind_body.h"
#include "script/bind_body_settings.h"
#include "script/bind_cloth.h"
#include "script/bind_joint.h"
#include "script/bind_mover.h"
#include "script/bind_region.h"
#include "script/events.h"
#include "script/internal.h"

#include <stdio.h>
#include <string.h>

// ---- options ----

#define BODY_TYPES  "dynamic|static|kinematic"
#define SHAPE_TYPES "sphere|box|plane|capsule|cylinder|hull|mesh"
static const char *const shape_names[] = {"sphere",   "box",  "plane", "capsule",
                                          "cylinder", "hull", "mesh"};

#define SHAPE_FIELDS                                                                               \
    {"shape",                                                                                      \
     BIND_ENUM,                                                                                    \
     BIND_AT(bind_shape_options, shape),                                                           \
     "geometry",                                                                                   \
     .optional = true,                                                                             \
     .def = PHYS_SPHERE,                                                                           \
     .values = SHAPE_TYPES,                                                                        \
     BIND_GIVEN(bind_shape_options, has_shape)},                                                   \
        {"size",                                                                                   \
         BIND_VEC3,                                                                                \
         BIND_AT(bind_shape_options, size),                                                        \
         "box: lengths of its edges",                                                              \
         "m",                                                                                      \
         BIND_POSITIVE,                                                                            \
         .optional = true,                                                                         \
         .def_vec = {1, 1, 1},                                                                     \
         .uniform = true,                                                                          \
         BIND_GIVEN(bind_shape_options, has_size)},                                                \
        {"radius",                                                                                 \
         BIND_FLOAT,                                                                               \
         BIND_AT(bind_shape_options, radius),                                                      \
         "sphere, capsule, cylinder",                                                              \
         "m",                                                                                      \
         BIND_POSITIVE,                                                                            \
         .optional = true,                                                                         \
         .def = 0.5,                                                                               \
         BIND_GIVEN(bind_shape_options, has_radius)},                                              \
        {"height",                                                                                 \
         BIND_FLOAT,                                                                               \
         BIND_AT(bind_shape_options, height),                                                      \
         "cylinder: whole; capsule: its straight part",                                            \
         "m",                                                                                      \
         BIND_POSITIVE,                                                                            \
         .optional = true,                                                                         \
         .def = 1,                                                                                 \
         BIND_GIVEN(bind_shape_options, has_height)},                                              \
        {"normal",                                                                                 \
         BIND_VEC3,                                                                                \
         BIND_AT(bind_shape_options, normal),                                                      \
         "plane: direction of its free side",                                                      \
         .optional = true,                                                                         \
         .def_vec = {0, 1, 0},                                                                     \
         BIND_GIVEN(bind_shape_options, has_normal)},                                              \
        {"points",                                                                                 \
         BIND_NUMBERS,                                                                             \
         BIND_AT(bind_shape_options, points),                                                      \
         "hull, mesh: its corners, x y z after x y z",                                             \
         "m",                                                                                      \
         .optional = true,                                                                         \
         BIND_GIVEN(bind_shape_options, has_points)},                                              \
        {"triangles",                                                                              \
         BIND_NUMBERS,                                                                             \
         BIND_AT(bind_shape_options, triangles),                                                   \
         "mesh: three corners each, counted from 1, counter-clockwise from the front",             \
         .optional = true,                                                                         \
         BIND_GIVEN(bind_shape_options, has_triangles)},                                           \
        {"heights",                                                                                \
         BIND_NUMBERS,                                                                             \
         BIND_AT(bind_shape_options, heights),                                                     \
         "mesh: a field of heights instead, row by row along +Z from its own place",               \
         "m",                                                                                      \
         .optional = true,                                                                         \
         BIND_GIVEN(bind_shape_options, has_heights)},                                             \
        {"columns", BIND_INT, BIND_AT(bind_shape_options, columns), "heights in a row, along +X",  \
         .optional = true},                                                                        \
        {"step",                                                                                   \
         BIND_NUMBERS,                                                                             \
         BIND_AT(bind_shape_options, step),                                                        \
         "of heights: from point to point along x and z",                                          \
         "m",                                                                                      \
         .optional = true,                                                                         \
         .def_text = "1"},                                                                         \
        {"cells",                                                                                  \
         BIND_NUMBERS,                                                                             \
         BIND_AT(bind_shape_options, cells),                                                       \
         "of heights: 0 for each cell that is a hole, row by row",                                 \
         .optional = true,                                                                         \
         .def_text = "no holes"},                                                                  \
        {"oneSided", BIND_BOOL, BIND_AT(bind_shape_options, one_sided),                            \
         "mesh: what comes from behind passes", .optional = true},                                 \
        {"density",         BIND_FLOAT, BIND_AT(bind_shape_options, density),                      \
         "mass per volume", "kg/m^3",   BIND_POSITIVE,                                             \
         .optional = true,  .def = 1000},                                                          \
        {"friction",                                                                               \
         BIND_FLOAT,                                                                               \
         BIND_AT(bind_shape_options, friction),                                                    \
         "Coulomb's coefficient",                                                                  \
         NULL,                                                                                     \
         BIND_NOT_NEGATIVE,                                                                        \
         .optional = true,                                                                         \
         .def = 0.5},                                                                              \
        {"restitution",                                                                            \
         BIND_FLOAT,                                                                               \
         BIND_AT(bind_shape_options, restitution),                                                 \
         "share of the speed kept in a bounce",                                                    \
         NULL,                                                                                     \
         BIND_BETWEEN,                                                                             \
         .max = 1,                                                                                 \
         .optional = true},                                                                        \
    {                                                                                              \
        "rolling", BIND_FLOAT, BIND_AT(bind_shape_options, rolling),                               \
            "sphere: rolling resistance over the radius", NULL, BIND_NOT_NEGATIVE,                 \
            .optional = true                                                                       \
    }

static const bind_arg shape_fields[] = {
    SHAPE_FIELDS,
    {"position", BIND_VEC3, BIND_AT(bind_shape_options, position), "in the body's frame", "m",
     .optional = true},
    {"rotation", BIND_QUAT, BIND_AT(bind_shape_options, rotation), "in the body's frame",
     .optional = true, .def_text = "none"},
    {0}};

// bind_body_options begins with its single shape, so both share these offsets.
#define BODY_FIELDS                                                                                \
    SHAPE_FIELDS,                                                                                  \
        {"shapes",                                                                                 \
         BIND_LIST,                                                                                \
         BIND_AT(bind_body_options, shapes),                                                       \
         "several shapes in place of one",                                                         \
         .optional = true,                                                                         \
         .fields = shape_fields,                                                                   \
         .size = sizeof(bind_shape_options)},                                                      \
        {"type",                                                                                   \
         BIND_ENUM,                                                                                \
         BIND_AT(bind_body_options, type),                                                         \
         "how it moves",                                                                           \
         .optional = true,                                                                         \
         .def = PHYS_DYNAMIC,                                                                      \
         .values = BODY_TYPES},                                                                    \
        {"velocity",     BIND_VEC3, BIND_AT(bind_body_options, velocity),                          \
         "at the start", "m/s",     .optional = true},                                             \
        {"angularVelocity", BIND_VEC3, BIND_AT(bind_body_options, angular_velocity),               \
         "at the start",    "rad/s",   .optional = true},                                          \
        {"linearDamping",    BIND_FLOAT, BIND_AT(bind_body_options, linear_damping),               \
         "loss of velocity", "1/s",      BIND_NOT_NEGATIVE,                                        \
         .optional = true},                                                                        \
        {"angularDamping",                                                                         \
         BIND_FLOAT,                                                                               \
         BIND_AT(bind_body_options, angular_damping),                                              \
         "loss of angular velocity",                                                               \
         "1/s",                                                                                    \
         BIND_NOT_NEGATIVE,                                                                        \
         .optional = true},                                                                        \
        {"gravityScale",      BIND_FLOAT,       BIND_AT(bind_body_options, gravity_scale),         \
         "factor on gravity", .optional = true, .def = 1},                                         \
        {"locks", BIND_STRING, BIND_AT(bind_body_options, locks),                                  \
         "world axes along and about which it never moves: any of x y z turnX turnY turnZ, "       \
         "spaces between",                                                                         \
         .optional = true},                                                                        \
        {"layer",                                                                                  \
         BIND_STRING,                                                                              \
         BIND_AT(bind_body_options, layer),                                                        \
         "name of its collision layer",                                                            \
         .optional = true,                                                                         \
         .def_text = "default"},                                                                   \
        {"onContact",                                                                              \
         BIND_FUNCTION,                                                                            \
         BIND_AT(bind_body_options, on_contact),                                                   \
         "called when it begins to touch: itself, the other body, speed of approach (m/s), "       \
         "normal "                                                                                 \
         "x, y, z towards the other",                                                              \
         .optional = true,                                                                         \
         .def_text = "none"},                                                                      \
        {"onContactEnd",                                                                           \
         BIND_FUNCTION,                                                                            \
         BIND_AT(bind_body_options, on_contact_end),                                               \
         "called when it touches no longer: itself, the other body (nil when it was "              \
         "destroyed)",                                                                             \
         .optional = true,                                                                         \
         .def_text = "none"},                                                                      \
    {                                                                                              \
        "onHit", BIND_FUNCTION, BIND_AT(bind_body_options, on_hit),                                \
            "called when it is struck again, at more than 1 m/s, while in touch: as onContact",    \
            .optional = true, .def_text = "none"                                                   \
    }

const bind_arg bind_body_fields[] = {BODY_FIELDS, {0}};

// Which size fields a shape takes; others are an error that says so.
static void check_fit(lua_State *L, const char *owner, const bind_shape_options *o) {
    const char *shape = shape_names[o->shape], *wrong = NULL;
    bool round = o->shape == PHYS_SPHERE || o->shape == PHYS_CAPSULE || o->shape == PHYS_CYLINDER;
    wrong = o->has_size && o->shape != PHYS_BOX ? "size" : wrong;
    wrong = o->has_radius && !round ? "radius" : wrong;
    wrong = o->has_height && (!round || o->shape == PHYS_SPHERE) ? "height" : wrong;
    wrong = o->has_normal && o->shape != PHYS_PLANE ? "normal" : wrong;
    wrong = o->has_points && o->shape != PHYS_HULL && o->shape != PHYS_MESH ? "points" : wrong;
    wrong = o->has_triangles && o->shape != PHYS_MESH ? "triangles" : wrong;
    wrong = o->has_heights && o->shape != PHYS_MESH ? "heights" : wrong;
    if (!o->has_shape) {
        bind_error(L,
                   "%s: the body has no shape; expected shape = \"sphere\", \"box\", \"plane\", "
                   "\"capsule\", \"cylinder\", \"hull\" or \"mesh\"",
                   owner);
    }
    if (wrong) {
        static const char *const takes[] = {"radius",
                                            "size",
                                            "normal",
                                            "radius and height",
                                            "radius and height",
                                            "points",
                                            "points and triangles, or heights"};
        bind_error(L, "%s: a %s has no \"%s\"; it takes %s", owner, shape, wrong, takes[o->shape]);
    }
    if (o->shape == PHYS_HULL && (o->points.count < 12 || o->points.count % 3 != 0)) {
        bind_error(L,
                   "%s: a hull needs at least four corners, three numbers each; points has %u "
                   "numbers",
                   owner, (unsigned)o->points.count);
    }
}

// Of a mesh, on the stack as long as the call; Lua counts corners from 1.
static const core_soup_data *read_mesh(lua_State *L, const char *owner,
                                       const bind_shape_options *o) {
    const bind_numbers *t = &o->triangles;
    if (o->points.count % 3 != 0 || t->count % 3 != 0 || t->count == 0) {
        bind_error(L,
                   "%s: a mesh takes three numbers a corner and three corners a triangle; points "
                   "has %u numbers, triangles %u",
                   owner, (unsigned)o->points.count, (unsigned)t->count);
    }
    luaL_checkstack(L, 1, "mesh");
    core_soup_data *soup = lua_newuserdata(L, sizeof *soup + t->count * sizeof(uint32_t));
    uint32_t *index = (uint32_t *)(soup + 1);
    for (uint32_t i = 0; i < t->count; i++) {
        double number = (double)t->items[i];
        if (!(number >= 1 && number <= o->points.count / 3) || number != (double)(uint32_t)number) {
            bind_error(L, "%s: triangles[%u] is %g, expected a whole number from 1 to %u", owner,
                       (unsigned)i + 1, number, (unsigned)o->points.count / 3);
        }
        index[i] = (uint32_t)number - 1;
    }
    *soup = (core_soup_data){.vertex_count = o->points.count / 3,
                             .triangle_count = t->count / 3,
                             .position = o->points.items,
                             .index = index};
    return soup;
}

// Of heights, on the stack as long as the call.
static void read_heights(lua_State *L, const char *owner, const bind_shape_options *o,
                         phys_shape_desc *d) {
    uint32_t columns = o->columns > 0 && o->columns < 1 << 20 ? (uint32_t)o->columns : 0;
    uint32_t rows = columns ? o->heights.count / columns : 0;
    if (columns < 2 || rows < 2 || o->heights.count % columns != 0) {
        bind_error(L, "%s: %u heights in rows of %d (columns), expected whole rows, two at least",
                   owner, (unsigned)o->heights.count, (int)o->columns);
    }
    uint32_t cells = (columns - 1) * (rows - 1);
    if (o->has_points || o->has_triangles || (o->step.count != 0 && o->step.count != 2) ||
        (o->cells.count != 0 && o->cells.count != cells)) {
        bind_error(L,
                   "%s: heights go without points and triangles, with a step {x, z} and with %u "
                   "cells",
                   owner, (unsigned)cells);
    }
    luaL_checkstack(L, 1, "heights");
    core_heights_data *h = lua_newuserdata(L, sizeof *h + cells);
    uint8_t *area = (uint8_t *)(h + 1);
    for (uint32_t i = 0; i < o->cells.count; i++) {
        area[i] = o->cells.items[i] == 0.0f ? PHYS_HOLE : 0;
    }
    bool even = o->step.count == 0;
    *h = (core_heights_data){.columns = columns,
                             .rows = rows,
                             .step_x = even ? 1.0f : o->step.items[0],
                             .step_z = even ? 1.0f : o->step.items[1],
                             .height = o->heights.items};
    d->heights = h;
    d->cells = o->cells.count != 0 ? area : NULL;
}

static phys_shape_desc read_shape(lua_State *L, const char *owner, const bind_shape_options *o) {
    check_fit(L, owner, o);
    phys_shape_desc d = phys_shape_desc_default((phys_shape_type)o->shape);
    d.half = core_v3_scale(o->size, 0.5f);
    d.radius = o->radius;
    d.half_height = 0.5f * o->height;
    d.normal = core_v3_normalize(o->normal, core_v3(0, 1, 0));
    d.points = o->points.items;
    d.point_count = o->points.count / 3;
    d.position = o->position;
    d.rotation = o->rotation;
    d.density = o->density;
    d.friction = o->friction;
    d.restitution = o->restitution;
    d.rolling = o->rolling;
    d.one_sided = o->one_sided;
    if (o->has_heights) {
        read_heights(L, owner, o, &d);
    } else if (o->shape == PHYS_MESH) {
        d.mesh = read_mesh(L, owner, o);
    }
    return d;
}

const char *bind_shape_name(phys_shape_type type) { return shape_names[type]; }

uint32_t bind_locks(lua_State *L, const char *owner, const char *words) {
    static const char *const names[] = {"x", "y", "z", "turnX", "turnY", "turnZ"};
    uint32_t locks = 0;
    for (const char *at = words; at != NULL && *(at += strspn(at, " ")) != '\0';) {
        size_t length = strcspn(at, " "), k = 0;
        while (k < CORE_COUNT_OF(names) &&
               (strlen(names[k]) != length || memcmp(names[k], at, length) != 0)) {
            k++;
        }
        if (k == CORE_COUNT_OF(names)) {
            bind_error(L, "%s: locks are \"%s\", expected words of x y z turnX turnY turnZ", owner,
                       words);
        }
        locks |= 1u << k;
        at += length;
    }
    return locks;
}

uint32_t bind_body_read(script *s, lua_State *L, const char *owner, const bind_body_options *o,
                        phys_body_desc *out, phys_shape_desc *shapes) {
    out->type = (phys_body_type)o->type;
    out->velocity = o->velocity;
    out->angular_velocity = o->angular_velocity;
    out->linear_damping = o->linear_damping;
    out->angular_damping = o->angular_damping;
    out->gravity_scale = o->gravity_scale;
    out->contact_events = o->on_contact || o->on_contact_end || o->on_hit;
    out->locks = bind_locks(L, owner, o->locks);
    out->layer = o->layer ? bind_layer(s, L, o->layer) : 0;
    if (o->shapes.count == 0) {
        shapes[0] = read_shape(L, owner, &o->shape);
        return 1;
    }
    if (o->shape.has_shape || o->shapes.count > BIND_SHAPES_MAX) {
        bind_error(L, "%s: give either shape or shapes (at most %d)", owner, BIND_SHAPES_MAX);
    }
    const bind_shape_options *list = o->shapes.items;
    for (uint32_t i = 0; i < o->shapes.count; i++) {
        shapes[i] = read_shape(L, owner, &list[i]);
    }
    return o->shapes.count;
}

void bind_body_callbacks(script *s, lua_State *L, const bind_body_options *o, phys_body body) {
    if (o->on_contact || o->on_contact_end || o->on_hit) {
        script_keep_callbacks(s, L, SCRIPT_ON_CONTACT, body,
                              (const int[]){o->on_contact, o->on_contact_end, o->on_hit});
    }
}

core_vec3 bind_body_mesh_scale(const bind_body_options *options) {
    const bind_shape_options *o = options->shapes.count ? options->shapes.items : &options->shape;
    float d = 2 * o->radius;
    switch (o->shape) {
    case PHYS_SPHERE:
        return core_v3(d, d, d);
    case PHYS_BOX:
        return o->size;
    case PHYS_CAPSULE:
    case PHYS_CYLINDER:
        return core_v3(d, o->height, d);
    case PHYS_PLANE:
        return core_v3(200, 1, 200);
    default:
        return core_v3(1, 1, 1);
    }
}

// ---- bodies ----

static bool body_alive(script *s, core_handle h) {
    phys_world *world = scene_phys_if(s->scene);
    return world && phys_body_alive(world, h);
}

typedef struct layer_args {
    core_handle self;
    const char *name;
} layer_args;
static int set_layer(script *s, lua_State *L, void *args) {
    const layer_args *a = args;
    if (!phys_body_set_layer(scene_phys(s->scene), a->self, bind_layer(s, L, a->name))) {
        bind_fail(L);
    }
    return 0;
}
static int get_layer(script *s, lua_State *L, void *args) {
    uint32_t layer = phys_body_layer(scene_phys(s->scene), *(core_handle *)args);
    lua_pushstring(L, scene_layer_name(s->scene, layer));
    return 1;
}

typedef struct impulse_args {
    core_handle self;
    double x, y, z;
    double px, py, pz;
    bool has_point;
} impulse_args;

static core_vec3 vector_of(const double *v) {
    return core_v3((float)v[0], (float)v[1], (float)v[2]);
}
static void give(double *v, core_vec3 value) {
    v[0] = (double)value.x;
    v[1] = (double)value.y;
    v[2] = (double)value.z;
}
static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

#define BODY_GETTER(name, read)                                                                    \
    static bool name(script *s, core_handle self, double *v) {                                     \
        core_vec3 value;                                                                           \
        if (!read(scene_phys(s->scene), self, &value)) {                                           \
            return false;                                                                          \
        }                                                                                          \
        give(v, value);                                                                            \
        return true;                                                                               \
    }
#define BODY_SETTER(name, write)                                                                   \
    static bool name(script *s, core_handle self, double *v) {                                     \
        return write(scene_phys(s->scene), self, vector_of(v));                                    \
    }
BODY_GETTER(get_velocity, phys_body_velocity)
BODY_GETTER(get_angular_velocity, phys_body_angular_velocity)
BODY_GETTER(get_position, phys_body_position)
BODY_SETTER(set_velocity, phys_body_set_velocity)
BODY_SETTER(set_angular_velocity, phys_body_set_angular_velocity)
BODY_SETTER(apply_force, phys_body_apply_force)
BODY_SETTER(apply_torque, phys_body_apply_torque)

// A body that belongs to an entity is moved through it, so that interpolation starts anew.
static bool set_position(script *s, core_handle self, double *v) {
    scene_entity e = scene_entity_of_body(s->scene, self);
    return core_handle_is_null(e) ? phys_body_set_position(scene_phys(s->scene), self, vector_of(v))
                                  : scene_set_position(s->scene, e, vector_of(v));
}

static bool get_rotation(script *s, core_handle self, double *v) {
    core_quat q;
    if (!phys_body_rotation(scene_phys(s->scene), self, &q)) {
        return false;
    }
    v[0] = (double)q.x, v[1] = (double)q.y, v[2] = (double)q.z, v[3] = (double)q.w;
    return true;
}

static bool set_rotation(script *s, core_handle self, double *v) {
    core_quat q =
        core_quat_normalize((core_quat){(float)v[0], (float)v[1], (float)v[2], (float)v[3]});
    scene_entity e = scene_entity_of_body(s->scene, self);
    return core_handle_is_null(e) ? phys_body_set_rotation(scene_phys(s->scene), self, q)
                                  : scene_set_rotation(s->scene, e, q);
}

static int apply_impulse(script *s, lua_State *L, void *args) {
    const impulse_args *a = args;
    phys_world *world = scene_phys(s->scene);
    core_vec3 at;
    if (a->has_point) {
        at = core_v3((float)a->px, (float)a->py, (float)a->pz);
    } else {
        done(L, phys_body_position(world, a->self, &at));
    }
    core_vec3 impulse = core_v3((float)a->x, (float)a->y, (float)a->z);
    return done(L, phys_body_apply_impulse(world, a->self, impulse, at));
}

static bool get_mass(script *s, core_handle self, double *v) {
    v[0] = (double)phys_body_mass(scene_phys(s->scene), self);
    return true;
}

static int get_entity(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_entity_type, scene_entity_of_body(s->scene, *(core_handle *)args));
    return 1;
}

static int destroy(script *s, lua_State *L, void *args) {
    core_handle body = *(core_handle *)args;
    if (!core_handle_is_null(scene_entity_of_body(s->scene, body))) {
        bind_error(L, "Body:destroy: this body belongs to an entity; destroy the entity");
    }
    return done(L, phys_body_destroy(scene_phys(s->scene), body));
}

static int is_destroyed(script *s, lua_State *L, void *args) {
    (void)s;
    (void)args;
    lua_pushboolean(L, 0); // the caller answers for dead ones
    return 1;
}

#define XYZ_ARGS(unit_text)                                                                        \
    BIND_ARGS({"x", BIND_NUMBER, .unit = unit_text}, {"y", BIND_NUMBER, .unit = unit_text},        \
              {"z", BIND_NUMBER, .unit = unit_text})
#define XYZ(unit_text)                                                                             \
    BIND_RETURNS({"x", "number", unit_text}, {"y", "number", unit_text}, {"z", "number", unit_text})
#define GETTER(fn_name, text, unit_text, method)                                                   \
    {                                                                                              \
        fn_name, text, NULL, XYZ(unit_text), .phases = BIND_RUNNING, .mod = true, .cost = 4,       \
                                             .numbers = method                                     \
    }
#define SETTER(fn_name, text, unit_text, method)                                                   \
    {                                                                                              \
        fn_name, text, XYZ_ARGS(unit_text), .phases = BIND_SIM, .mod = true, .cost = 8,            \
                                            .numbers = method                                      \
    }

static const bind_fn body_methods[] = {
    GETTER("getPosition", "Where its origin is.", "m", get_position),
    SETTER("setPosition", "Teleports it.", "m", set_position),
    {"getRotation", "Its rotation as a quaternion.", NULL,
     BIND_RETURNS({"x", "number", NULL}, {"y", "number", NULL}, {"z", "number", NULL},
                  {"w", "number", NULL}),
     .phases = BIND_RUNNING, .mod = true, .cost = 4, .numbers = get_rotation},
    {"setRotation", "Turns it; the quaternion is normalised.",
     BIND_ARGS({"x", BIND_NUMBER, .unit = NULL}, {"y", BIND_NUMBER, .unit = NULL},
               {"z", BIND_NUMBER, .unit = NULL}, {"w", BIND_NUMBER, .unit = NULL}),
     .phases = BIND_SIM, .mod = true, .cost = 8, .numbers = set_rotation},
    GETTER("getVelocity", "Velocity of its centre of mass.", "m/s", get_velocity),
    SETTER("setVelocity", "Sets the velocity of its centre of mass.", "m/s", set_velocity),
    GETTER("getAngularVelocity", "Angular velocity in the world's frame.", "rad/s",
           get_angular_velocity),
    SETTER("setAngularVelocity", "Sets the angular velocity.", "rad/s", set_angular_velocity),
    {"setLayer", "Moves it to another collision layer.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(layer_args, name), "a new name makes a layer"}), NULL,
     sizeof(layer_args), BIND_SIM, .mod = true, .cost = 10, .run = set_layer},
    {"getLayer", "Name of its collision layer.", NULL, BIND_RETURNS({"name", "string", NULL}),
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 4, .run = get_layer},
    SETTER("applyForce", "Pushes at its centre of mass during the next step.", "N", apply_force),
    {"applyImpulse", "Changes its momentum at once.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(impulse_args, x), "", "N s"},
               {"y", BIND_NUMBER, BIND_AT(impulse_args, y), "", "N s"},
               {"z", BIND_NUMBER, BIND_AT(impulse_args, z), "", "N s"},
               {"px", BIND_NUMBER, BIND_AT(impulse_args, px), "where, in the world", "m",
                .optional = true, .def_text = "its origin", BIND_GIVEN(impulse_args, has_point)},
               {"py", BIND_NUMBER, BIND_AT(impulse_args, py), "", "m", .optional = true},
               {"pz", BIND_NUMBER, BIND_AT(impulse_args, pz), "", "m", .optional = true}),
     NULL, sizeof(impulse_args), BIND_SIM, .mod = true, .cost = 8, .run = apply_impulse},
    SETTER("applyTorque", "Turns it about its centre of mass during the next step.", "N m",
           apply_torque),
    {"getType", "How it moves: \"dynamic\", \"static\" or \"kinematic\".", NULL,
     BIND_RETURNS({"type", "string", NULL}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 4, .run = bind_body_get_type},
    {"getShape", "Geometry of one of its shapes, as in newBody.",
     BIND_ARGS({"number", BIND_INT, BIND_AT(bind_shape_args, number), "from 1", NULL, BIND_POSITIVE,
                .optional = true, .def = 1}),
     BIND_RETURNS({"shape", "string", NULL}), sizeof(bind_shape_args), BIND_RUNNING, .mod = true,
     .cost = 4, .run = bind_body_get_shape},
    {"getShapeCount", "How many shapes it has.", NULL, BIND_RETURNS({"count", "integer", NULL}),
     .phases = BIND_RUNNING, .mod = true, .cost = 4, .numbers = bind_body_get_shape_count},
    {"setDamping", "Sets the losses of its velocities.",
     BIND_ARGS({"linear", BIND_NUMBER, .unit = "1/s"}, {"angular", BIND_NUMBER, .unit = "1/s"}),
     .phases = BIND_SIM, .mod = true, .cost = 8, .numbers = bind_body_set_damping},
    {"getDamping", "The losses of its velocities.", NULL,
     BIND_RETURNS({"linear", "number", "1/s"}, {"angular", "number", "1/s"}),
     .phases = BIND_RUNNING, .mod = true, .cost = 4, .numbers = bind_body_get_damping},
    {"setGravityScale", "Sets the factor on gravity.",
     BIND_ARGS({"factor", BIND_NUMBER, .unit = NULL}), .phases = BIND_SIM, .mod = true, .cost = 8,
     .numbers = bind_body_set_gravity_scale},
    {"getGravityScale", "The factor on gravity.", NULL, BIND_RETURNS({"factor", "number", NULL}),
     .phases = BIND_RUNNING, .mod = true, .cost = 4, .numbers = bind_body_get_gravity_scale},
    {"setLocks", "Sets the world axes along and about which it never moves.",
     BIND_ARGS({"axes", BIND_STRING, BIND_AT(bind_locks_args, words),
                "any of x y z turnX turnY turnZ, spaces between"}),
     NULL, sizeof(bind_locks_args), BIND_SIM, .mod = true, .cost = 10, .run = bind_body_set_locks},
    {"getLocks", "The axes along and about which it never moves, as in setLocks.", NULL,
     BIND_RETURNS({"axes", "string", NULL}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 4, .run = bind_body_get_locks},
    {"setMaterial", "Sets the material of all its shapes.",
     BIND_ARGS({"friction", BIND_NUMBER, .unit = NULL}, {"restitution", BIND_NUMBER, .unit = NULL},
               {"rolling", BIND_NUMBER, .unit = NULL}),
     .phases = BIND_SIM, .mod = true, .cost = 20, .numbers = bind_body_set_material},
    {"getMaterial", "The material of its first shape.", NULL,
     BIND_RETURNS({"friction", "number", NULL}, {"restitution", "number", NULL},
                  {"rolling", "number", NULL}),
     .phases = BIND_RUNNING, .mod = true, .cost = 4, .numbers = bind_body_get_material},
    {"getMass", "Its mass; 0 for static bodies.", NULL, BIND_RETURNS({"mass", "number", "kg"}),
     .phases = BIND_RUNNING, .mod = true, .cost = 4, .numbers = get_mass},
    {"getEntity", "The entity it belongs to, or nil.", NULL,
     BIND_RETURNS({"entity", "corsac.Entity?", NULL}), sizeof(core_handle), BIND_RUNNING,
     .mod = true, .cost = 4, .run = get_entity},
    {"isDestroyed", "Whether it was destroyed; every other method then raises an error.", NULL,
     BIND_RETURNS({"destroyed", "boolean", NULL}), sizeof(core_handle), BIND_ANY, .mod = true,
     .cost = 2, .run = is_destroyed},
    {"destroy", "Removes it from the world.", NULL, NULL, sizeof(core_handle), BIND_SIM,
     .mod = true, .cost = 50, .run = destroy},
    {0}};

const bind_type bind_body_type = {"Body", "A rigid body.", body_alive, body_methods};

// ---- corsac.phys ----

typedef struct gravity_args {
    double x, y, z;
} gravity_args;
static int set_gravity(script *s, lua_State *L, void *args) {
    const gravity_args *a = args;
    (void)L;
    phys_world_set_gravity(scene_phys(s->scene), core_v3((float)a->x, (float)a->y, (float)a->z));
    return 0;
}
static int get_gravity(script *s, lua_State *L, void *args) {
    (void)args;
    bind_push_vec3(L, phys_world_gravity(scene_phys(s->scene)));
    return 3;
}

typedef struct new_body_args {
    bind_body_options body;
    core_vec3 position;
    core_quat rotation;
} new_body_args;
typedef struct new_body_call {
    new_body_args options;
} new_body_call;

static int new_body(script *s, lua_State *L, void *args) {
    const new_body_args *a = &((new_body_call *)args)->options;
    phys_body_desc desc = phys_body_desc_default();
    phys_shape_desc shapes[BIND_SHAPES_MAX];
    uint32_t count = bind_body_read(s, L, "corsac.phys.newBody", &a->body, &desc, shapes);
    desc.position = a->position;
    desc.rotation = a->rotation;
    phys_body body = phys_body_create(scene_phys(s->scene), &desc, shapes, count);
    if (core_handle_is_null(body)) {
        bind_fail(L);
    }
    bind_body_callbacks(s, L, &a->body, body);
    bind_push(s, L, &bind_body_type, body);
    return 1;
}

static int get_body_count(script *s, lua_State *L, void *args) {
    (void)args;
    phys_world *world = scene_phys_if(s->scene);
    lua_pushnumber(L, world ? (double)phys_body_count(world) : 0);
    return 1;
}

typedef struct columns_options {
    bool checked;
} columns_options;
typedef struct columns_call {
    columns_options options;
} columns_call;
static const bind_arg columns_fields[] = {{"checked", BIND_BOOL, BIND_AT(columns_options, checked),
                                           "checks every index and the view's age; slow",
                                           .optional = true},
                                          {0}};

static const bind_arg new_body_fields[] = {
    BODY_FIELDS,
    {"position", BIND_VEC3, BIND_AT(new_body_args, position), "origin", "m", .optional = true},
    {"rotation", BIND_QUAT, BIND_AT(new_body_args, rotation), "", .optional = true,
     .def_text = "none"},
    {0}};

static const bind_fn functions[] = {
    {"setGravity", "Sets the acceleration of every body.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(gravity_args, x), "", "m/s^2"},
               {"y", BIND_NUMBER, BIND_AT(gravity_args, y), "", "m/s^2"},
               {"z", BIND_NUMBER, BIND_AT(gravity_args, z), "", "m/s^2"}),
     NULL, sizeof(gravity_args), BIND_SIM, .mod = true, .cost = 10, .run = set_gravity},
    {"getGravity", "The acceleration of every body.", NULL, XYZ("m/s^2"), 0, BIND_RUNNING,
     .mod = true, .cost = 4, .run = get_gravity},
    {"newBody", "Makes a body without an entity: it is drawn as a debug shape only.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(new_body_call, options), "the body",
                .fields = new_body_fields}),
     BIND_RETURNS({"body", "corsac.Body", NULL}), sizeof(new_body_call), BIND_SIM, .mod = true,
     .cost = 2000, .run = new_body},
    {"columns",
     "All bodies as 0-based arrays px..pz, qx..qw, vx..vz, wx..wz of `n` rows, with row(body), "
     "handle(row) and touch(row); valid until the callback ends. Velocities may be written, "
     "followed by touch(row). A row out of range is not caught without `checked`.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(columns_call, options), "", .optional = true,
                .def_text = "none", .fields = columns_fields}),
     BIND_RETURNS({"columns", "corsac.Columns", NULL}), sizeof(columns_call), BIND_RUNNING,
     .mod = false},
    {"getBodyCount", "How many bodies the world has.", NULL,
     BIND_RETURNS({"count", "integer", NULL}), 0, BIND_RUNNING, .mod = true, .cost = 4,
     .run = get_body_count},
    {0}};

static const bind_module modules[] = {
    {"corsac.phys", "Rigid bodies: metres, kilograms, seconds, radians.", functions},
    {"corsac.phys", "", bind_region_functions},
    {"corsac.phys", "", bind_ask_functions},
    {"corsac.phys", "", bind_joint_functions},
    {"corsac.phys", "", bind_mover_functions},
    {"corsac.phys", "", bind_state_functions},
    {"corsac.phys", "", bind_cloth_functions},
    {"corsac.phys", "", bind_ragdoll_functions},
    {0}};
static const bind_type *const types[] = {&bind_body_type,
                                         &bind_trigger_type,
                                         &bind_field_type,
                                         &bind_joint_type,
                                         &bind_mover_type,
                                         &bind_cloth_type,
                                         NULL};

const bind_room bind_phys_room = {"phys", modules, types};
