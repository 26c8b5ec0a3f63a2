// corsac.scene: entities.
#include "script/bind_anim.h"
#include "script/bind_body.h"
#include "script/bind_gfx.h"
#include "script/bind_query.h"
#include "script/internal.h"
#include "script/scene_file.h"

#include <string.h>

typedef struct spawn_options {
    int tags;
    core_vec3 position, scale;
    core_quat rotation;
    core_handle parent;
    bind_body_options body;
    const char *mesh, *name;
    core_handle model, machine, clip, material;
    float color[4];
    bool has_body, has_scale;
} spawn_options;
typedef struct spawn_call {
    spawn_options options;
} spawn_call;

static bool entity_alive(script *s, core_handle h) { return scene_alive(s->scene, h); }

static int spawn(script *s, lua_State *L, void *args) {
    const spawn_options *o = &((spawn_call *)args)->options;
    scene_spawn_desc desc = scene_spawn_desc_default();
    phys_body_desc body = phys_body_desc_default();
    phys_shape_desc shapes[BIND_SHAPES_MAX];
    gfx_instance_desc draw = {0};
    desc.position = o->position;
    desc.rotation = o->rotation;
    desc.scale = o->scale;
    desc.parent = o->parent;
    desc.name = o->name;
    desc.tags = bind_tags(s, L, o->tags, "corsac.scene.spawn");
    if (o->has_body) {
        desc.body = &body;
        desc.shapes = shapes;
        desc.shape_count =
            bind_body_read(s, L, "corsac.scene.spawn: body", &o->body, &body, shapes);
        desc.draw_scale = bind_body_mesh_scale(&o->body);
    }
    desc.model = o->model;
    desc.machine = o->machine;
    desc.clip = o->clip;
    if (o->mesh) {
        draw.mesh = gfx_mesh_builtin(scene_gfx(s->scene), o->mesh);
        if (core_handle_is_null(draw.mesh)) {
            bind_fail(L);
        }
        memcpy(draw.color, o->color, sizeof draw.color);
        draw.material = o->material;
        desc.draw = &draw;
    }
    scene_entity e = scene_spawn(s->scene, &desc);
    if (core_handle_is_null(e)) {
        bind_fail(L);
    }
    if (o->has_body) {
        bind_body_callbacks(s, L, &o->body, scene_entity_body(s->scene, e));
    }
    bind_push(s, L, &bind_entity_type, e);
    return 1;
}

typedef struct find_args {
    const char *name;
} find_args;
static int find(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_entity_type, scene_find(s->scene, ((find_args *)args)->name));
    return 1;
}

static int get_count(script *s, lua_State *L, void *args) {
    (void)args;
    lua_pushnumber(L, (double)scene_entity_count(s->scene));
    return 1;
}

// ---- entities ----

typedef struct color_args {
    core_handle self;
    double r, g, b, a;
} color_args;
typedef struct parent_args {
    core_handle self, parent;
} parent_args;

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}
static core_vec3 vector_of(const double *v) {
    return core_v3((float)v[0], (float)v[1], (float)v[2]);
}

static bool get_position(script *s, core_handle self, double *v) {
    core_vec3 p;
    if (!scene_position(s->scene, self, &p)) {
        return false;
    }
    v[0] = (double)p.x, v[1] = (double)p.y, v[2] = (double)p.z;
    return true;
}
static bool set_position(script *s, core_handle self, double *v) {
    return scene_set_position(s->scene, self, vector_of(v));
}
static bool get_rotation(script *s, core_handle self, double *v) {
    core_quat q;
    if (!scene_rotation(s->scene, self, &q)) {
        return false;
    }
    v[0] = (double)q.x, v[1] = (double)q.y, v[2] = (double)q.z, v[3] = (double)q.w;
    return true;
}
static bool set_rotation(script *s, core_handle self, double *v) {
    core_quat q = {(float)v[0], (float)v[1], (float)v[2], (float)v[3]};
    return scene_set_rotation(s->scene, self, core_quat_normalize(q));
}
static bool set_scale(script *s, core_handle self, double *v) {
    return scene_set_scale(s->scene, self, vector_of(v));
}
static int set_color(script *s, lua_State *L, void *args) {
    const color_args *a = args;
    gfx_instance instance = scene_entity_instance(s->scene, a->self);
    if (core_handle_is_null(instance)) {
        bind_error(L, "Entity:setColor: this entity has no mesh");
    }
    return done(L, gfx_instance_set_color(scene_gfx(s->scene), instance, (float)a->r, (float)a->g,
                                          (float)a->b, (float)a->a));
}
static int get_body(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_body_type, scene_entity_body(s->scene, *(core_handle *)args));
    return 1;
}
static int get_animator(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_animator_type, scene_entity_anim(s->scene, *(core_handle *)args));
    return 1;
}
static int get_name(script *s, lua_State *L, void *args) {
    lua_pushstring(L, scene_entity_name(s->scene, *(core_handle *)args));
    return 1;
}
static int get_parent(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_entity_type, scene_parent(s->scene, *(core_handle *)args));
    return 1;
}
static int set_parent(script *s, lua_State *L, void *args) {
    const parent_args *a = args;
    return done(L, scene_set_parent(s->scene, a->self, a->parent));
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, scene_despawn(s->scene, *(core_handle *)args));
}
static int is_destroyed(script *s, lua_State *L, void *args) {
    (void)s;
    (void)args;
    lua_pushboolean(L, 0); // the caller answers for dead ones
    return 1;
}

// ---- declarations ----

#define XYZ(unit_text)                                                                             \
    BIND_RETURNS({"x", "number", unit_text}, {"y", "number", unit_text}, {"z", "number", unit_text})
#define XYZ_ARGS(unit_text)                                                                        \
    BIND_ARGS({"x", BIND_NUMBER, .unit = unit_text}, {"y", BIND_NUMBER, .unit = unit_text},        \
              {"z", BIND_NUMBER, .unit = unit_text})
#define QUAT_ARGS                                                                                  \
    BIND_ARGS({"x", BIND_NUMBER, .unit = NULL}, {"y", BIND_NUMBER, .unit = NULL},                  \
              {"z", BIND_NUMBER, .unit = NULL}, {"w", BIND_NUMBER, .unit = NULL})

#define TAG_ARGS BIND_ARGS({"name", BIND_STRING, BIND_AT(bind_tag_args, name), "of the tag"})

static const bind_fn entity_methods[] = {
    {"getPosition", "Where it is in the world.", NULL, XYZ("m"), .phases = BIND_RUNNING,
     .mod = true, .cost = 4, .numbers = get_position},
    {"setPosition", "Teleports it, its body and its children.", XYZ_ARGS("m"), .phases = BIND_SIM,
     .mod = true, .cost = 8, .numbers = set_position},
    {"getRotation", "Its rotation in the world as a quaternion.", NULL,
     BIND_RETURNS({"x", "number", NULL}, {"y", "number", NULL}, {"z", "number", NULL},
                  {"w", "number", NULL}),
     .phases = BIND_RUNNING, .mod = true, .cost = 4, .numbers = get_rotation},
    {"setRotation", "Turns it; the quaternion is normalised.", QUAT_ARGS, .phases = BIND_SIM,
     .mod = true, .cost = 8, .numbers = set_rotation},
    {"setScale", "Scales its mesh and its children, never its body.", XYZ_ARGS(NULL),
     .phases = BIND_SIM, .mod = true, .cost = 8, .numbers = set_scale},
    {"setColor", "Colour that multiplies its material's.",
     BIND_ARGS({"r", BIND_NUMBER, BIND_AT(color_args, r), "", NULL, BIND_NOT_NEGATIVE},
               {"g", BIND_NUMBER, BIND_AT(color_args, g), "", NULL, BIND_NOT_NEGATIVE},
               {"b", BIND_NUMBER, BIND_AT(color_args, b), "", NULL, BIND_NOT_NEGATIVE},
               {"a", BIND_NUMBER, BIND_AT(color_args, a), "", NULL, BIND_BETWEEN, .max = 1,
                .optional = true, .def = 1}),
     NULL, sizeof(color_args), BIND_RUNNING, .mod = true, .cost = 8, .run = set_color},
    {"getBody", "Its body, or nil.", NULL, BIND_RETURNS({"body", "corsac.Body?", NULL}),
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 4, .run = get_body},
    {"getAnimator", "What moves its model, or nil.", NULL,
     BIND_RETURNS({"animator", "corsac.Animator?", NULL}), sizeof(core_handle), BIND_RUNNING,
     .mod = true, .cost = 4, .run = get_animator},
    {"getName", "The name it was given, \"\" without.", NULL,
     BIND_RETURNS({"name", "string", NULL}), sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 4, .run = get_name},
    {"getParent", "The entity it hangs on, or nil.", NULL,
     BIND_RETURNS({"parent", "corsac.Entity?", NULL}), sizeof(core_handle), BIND_RUNNING,
     .mod = true, .cost = 4, .run = get_parent},
    {"setParent", "Hangs it on another entity (nil: on none); it stays where it is.",
     BIND_ARGS({"parent", BIND_OBJECT, BIND_AT(parent_args, parent), "new parent", .optional = true,
                .def_text = "nil", .type = &bind_entity_type}),
     NULL, sizeof(parent_args), BIND_SIM, .mod = true, .cost = 20, .run = set_parent},
    {"addTag", "Gives it a tag; a new name makes one (at most 64).", TAG_ARGS, NULL,
     sizeof(bind_tag_args), BIND_SIM, .mod = true, .cost = 10, .run = bind_add_tag},
    {"removeTag", "Takes a tag from it.", TAG_ARGS, NULL, sizeof(bind_tag_args), BIND_SIM,
     .mod = true, .cost = 10, .run = bind_remove_tag},
    {"hasTag", "Whether it has a tag.", TAG_ARGS, BIND_RETURNS({"has", "boolean", NULL}),
     sizeof(bind_tag_args), BIND_RUNNING, .mod = true, .cost = 10, .run = bind_has_tag},
    {"isDestroyed", "Whether it was destroyed; every other method then raises an error.", NULL,
     BIND_RETURNS({"destroyed", "boolean", NULL}), sizeof(core_handle), BIND_ANY, .mod = true,
     .cost = 2, .run = is_destroyed},
    {"destroy", "Removes it, its body, its mesh and its children.", NULL, NULL, sizeof(core_handle),
     BIND_SIM, .mod = true, .cost = 100, .run = destroy},
    {0}};

const bind_type bind_entity_type = {"Entity", "A thing in the scene.", entity_alive,
                                    entity_methods};

static const bind_arg spawn_fields[] = {
    {"position", BIND_VEC3, BIND_AT(spawn_options, position), "in its parent's frame", "m",
     .optional = true},
    {"rotation", BIND_QUAT, BIND_AT(spawn_options, rotation), "in its parent's frame",
     .optional = true, .def_text = "none"},
    {"scale", BIND_VEC3, BIND_AT(spawn_options, scale), "of the mesh and of children", NULL,
     BIND_POSITIVE, .optional = true, .def_vec = {1, 1, 1}, .uniform = true},
    {"parent", BIND_OBJECT, BIND_AT(spawn_options, parent), "entity it hangs on", .optional = true,
     .def_text = "nil", .type = &bind_entity_type},
    {"body", BIND_OPTIONS, BIND_AT(spawn_options, body), "its rigid body", .optional = true,
     .def_text = "none", BIND_GIVEN(spawn_options, has_body), .fields = bind_body_fields},
    {"mesh", BIND_STRING, BIND_AT(spawn_options, mesh),
     "\"box\", \"sphere\", \"capsule\", \"cylinder\" or \"plane\"; takes the size of the body",
     .optional = true},
    {"color", BIND_COLOR, BIND_AT(spawn_options, color), "multiplies the material's",
     .optional = true, .def_vec = {1, 1, 1}},
    {"material", BIND_OBJECT, BIND_AT(spawn_options, material), "of its mesh", .optional = true,
     .def_text = "a plain white one", .type = &bind_material_type},
    {"model", BIND_OBJECT, BIND_AT(spawn_options, model), "shown in place of a mesh",
     .optional = true, .def_text = "nil", .type = &bind_model_type},
    {"machine", BIND_OBJECT, BIND_AT(spawn_options, machine), "state machine that moves the model",
     .optional = true, .def_text = "nil", .type = &bind_machine_type},
    {"clip", BIND_OBJECT, BIND_AT(spawn_options, clip), "clip the model plays, without a machine",
     .optional = true, .def_text = "nil", .type = &bind_clip_type},
    {"name", BIND_STRING, BIND_AT(spawn_options, name), "for corsac.scene.find", .optional = true},
    {"tags", BIND_TABLE, BIND_AT(spawn_options, tags), "names, for corsac.scene.findAll",
     .optional = true, .def_text = "none"},
    {0}};

static const bind_fn functions[] = {
    {"spawn", "Makes an entity: a place in the world with a body, a mesh, or both.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(spawn_call, options), "the entity",
                .fields = spawn_fields}),
     BIND_RETURNS({"entity", "corsac.Entity", NULL}), sizeof(spawn_call), BIND_SIM, .mod = true,
     .cost = 2000, .run = spawn},
    {"find", "The oldest entity of that name, or nil.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(find_args, name), "as given to spawn"}),
     BIND_RETURNS({"entity", "corsac.Entity?", NULL}), sizeof(find_args), BIND_RUNNING, .mod = true,
     .cost = 500, .run = find},
    {"getCount", "How many entities there are.", NULL, BIND_RETURNS({"count", "integer", NULL}), 0,
     BIND_RUNNING, .mod = true, .cost = 4, .run = get_count},
    {0}};

static const bind_module modules[] = {
    {"corsac.scene", "Entities: places in the world that carry bodies and meshes.", functions},
    {"corsac.scene", "", bind_query_functions},
    {"corsac.scene", "", bind_scene_file_functions},
    {0}};
static const bind_type *const types[] = {&bind_entity_type, NULL};

const bind_room bind_scene_room = {"scene", modules, types};
