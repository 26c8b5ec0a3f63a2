// corsac.gfx: cameras, and the views of a picture or a texture. None of it changes the simulation.
#include "script/bind_gfx.h"
#include "script/internal.h"

#include <string.h>

typedef struct camera_options {
    core_vec3 position, target;
    core_quat rotation;
    float fov, near_plane, far, height;
    bool has_position, has_target, has_rotation;
} camera_options;
typedef struct camera_call {
    camera_options options;
} camera_call;

// Rotation whose -Z looks from eye to target, +Y up (or +Z when looking straight up or down).
static core_quat look_rotation(core_vec3 eye, core_vec3 target) {
    core_vec3 back = core_v3_normalize(core_v3_sub(eye, target), core_v3(0, 0, 1));
    core_vec3 up = back.y > 0.9999f || back.y < -0.9999f ? core_v3(0, 0, -1) : core_v3(0, 1, 0);
    core_vec3 right = core_v3_normalize(core_v3_cross(up, back), core_v3(1, 0, 0));
    up = core_v3_cross(back, right);
    // Quaternion of the matrix (right, up, back): largest of the four squares first (Shepperd
    // 1978).
    float m00 = right.x, m11 = up.y, m22 = back.z, trace = m00 + m11 + m22;
    core_quat q;
    if (trace > 0) {
        float s = 2 * core_sqrtf(trace + 1);
        q = (core_quat){(up.z - back.y) / s, (back.x - right.z) / s, (right.y - up.x) / s, s / 4};
    } else if (m00 > m11 && m00 > m22) {
        float s = 2 * core_sqrtf(1 + m00 - m11 - m22);
        q = (core_quat){s / 4, (up.x + right.y) / s, (back.x + right.z) / s, (up.z - back.y) / s};
    } else if (m11 > m22) {
        float s = 2 * core_sqrtf(1 + m11 - m00 - m22);
        q = (core_quat){(up.x + right.y) / s, s / 4, (back.y + up.z) / s, (back.x - right.z) / s};
    } else {
        float s = 2 * core_sqrtf(1 + m22 - m00 - m11);
        q = (core_quat){(back.x + right.z) / s, (back.y + up.z) / s, s / 4, (right.y - up.x) / s};
    }
    return core_quat_normalize(q);
}

static gfx_camera camera_of(lua_State *L, const char *call, const camera_options *o,
                            gfx_camera camera) {
    if (o->has_target && o->has_rotation) {
        bind_error(L, "%s: give either target or rotation", call);
    }
    if (o->has_position) {
        camera.position = o->position;
    }
    if (o->has_target) {
        camera.rotation = look_rotation(camera.position, o->target);
    } else if (o->has_rotation) {
        camera.rotation = o->rotation;
    }
    camera.fovy = o->fov;
    camera.near_plane = o->near_plane;
    camera.virtual_far = o->far;
    camera.ortho_height = o->height;
    return camera;
}

static int set_camera(script *s, lua_State *L, void *args) {
    gfx_world *world = scene_gfx(s->scene);
    gfx_camera camera = camera_of(L, "corsac.gfx.setCamera", &((camera_call *)args)->options,
                                  gfx_world_camera(world));
    gfx_world_set_camera(world, &camera);
    return 0;
}

typedef struct look_args {
    double x, y, z, tx, ty, tz;
} look_args;
static int look_at(script *s, lua_State *L, void *args) {
    const look_args *a = args;
    (void)L;
    gfx_world *world = scene_gfx(s->scene);
    gfx_camera camera = gfx_world_camera(world);
    camera.position = core_v3((float)a->x, (float)a->y, (float)a->z);
    camera.rotation =
        look_rotation(camera.position, core_v3((float)a->tx, (float)a->ty, (float)a->tz));
    gfx_world_set_camera(world, &camera);
    return 0;
}

static int get_camera(script *s, lua_State *L, void *args) {
    (void)args;
    gfx_camera camera = gfx_world_camera(scene_gfx(s->scene));
    bind_push_vec3(L, camera.position);
    bind_push_quat(L, camera.rotation);
    return 7;
}

// ---- views ----

typedef struct view_options {
    camera_options camera;
    bind_numbers rect;
    const char *texture;
    bind_numbers size;
} view_options;
typedef struct view_call {
    view_options options;
} view_call;

static bool view_alive(script *s, core_handle h) {
    return scene_gfx_if(s->scene) && gfx_viewport_alive(scene_gfx_if(s->scene), h);
}

static int new_view(script *s, lua_State *L, void *args) {
    const view_options *o = &((view_call *)args)->options;
    gfx_viewport_desc desc = gfx_viewport_desc_default();
    if (o->rect.count && (o->rect.count != 4 || o->texture)) {
        bind_error(L, "corsac.gfx.newView: options.rect: expected {x, y, width, height}, and no "
                      "texture beside it");
    }
    memcpy(desc.rect, o->rect.count ? o->rect.items : desc.rect, sizeof desc.rect);
    desc.camera = camera_of(L, "corsac.gfx.newView", &o->camera, desc.camera);
    desc.target = o->texture;
    desc.width = desc.height = 512;
    if (o->size.count) {
        if (o->size.count != 2 || !(o->size.items[0] >= 1.0f && o->size.items[0] <= 16384.0f) ||
            !(o->size.items[1] >= 1.0f && o->size.items[1] <= 16384.0f)) {
            bind_error(L, "corsac.gfx.newView: options.size: expected {width, height}, each in "
                          "1..16384 pixels");
        }
        desc.width = (uint32_t)o->size.items[0];
        desc.height = (uint32_t)o->size.items[1];
    }
    gfx_viewport view = gfx_viewport_create(scene_gfx(s->scene), &desc);
    if (core_handle_is_null(view)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_view_type, view);
    return 1;
}

typedef struct view_camera_args {
    core_handle self;
    camera_options options;
} view_camera_args;
static int view_set_camera(script *s, lua_State *L, void *args) {
    const view_camera_args *a = args;
    gfx_world *world = scene_gfx(s->scene);
    gfx_camera camera;
    if (!gfx_viewport_camera(world, a->self, &camera)) {
        bind_fail(L);
    }
    camera = camera_of(L, "View:setCamera", &a->options, camera);
    gfx_viewport_set_camera(world, a->self, &camera);
    return 0;
}

static int view_destroy(script *s, lua_State *L, void *args) {
    if (!gfx_viewport_destroy(scene_gfx(s->scene), *(core_handle *)args)) {
        bind_fail(L);
    }
    return 0;
}

// ---- declarations ----

#define CAMERA_FIELDS(T, in)                                                                         \
    {"position", BIND_VEC3,        BIND_AT(T, in position), "of the eye",                            \
     "m",        .optional = true, .def_text = "as before", BIND_GIVEN(T, in has_position)},         \
        {"target", BIND_VEC3,        BIND_AT(T, in target),   "point it looks at",                   \
         "m",      .optional = true, .def_text = "as before", BIND_GIVEN(T, in has_target)},         \
        {"rotation",                                                                                 \
         BIND_QUAT,                                                                                  \
         BIND_AT(T, in rotation),                                                                    \
         "in place of target; looks along -Z",                                                       \
         .optional = true,                                                                           \
         .def_text = "as before",                                                                    \
         BIND_GIVEN(T, in has_rotation)},                                                            \
        {"fov",       BIND_FLOAT, BIND_AT(T, in fov), "vertical field of view", "rad", BIND_BETWEEN, \
         .min = 0.01, .max = 3,   .optional = true,   .def = 1.0471975511965976},                    \
        {"near", BIND_FLOAT,    BIND_AT(T, in near_plane), "nearest visible distance",               \
         "m",    BIND_POSITIVE, .optional = true,          .def = 0.1},                              \
        {"far", BIND_FLOAT,    BIND_AT(T, in far), "no point or spot light is seen beyond",          \
         "m",   BIND_POSITIVE, .optional = true,   .def = 100},                                      \
    {                                                                                                \
        "height", BIND_FLOAT, BIND_AT(T, in height),                                                 \
            "of what is seen without perspective; 0: with perspective", "m", BIND_NOT_NEGATIVE,      \
            .optional = true                                                                         \
    }

static const bind_arg camera_fields[] = {CAMERA_FIELDS(camera_options, ), {0}};
static const bind_arg view_fields[] = {
    CAMERA_FIELDS(view_options, camera.),
    {"rect", BIND_NUMBERS, BIND_AT(view_options, rect),
     "x, y, width, height: shares of the picture, origin top left", .optional = true,
     .def_text = "the whole picture"},
    {"texture", BIND_STRING, BIND_AT(view_options, texture),
     "name of a texture in place of the picture: maps and images have it as \"target:NAME\"",
     .optional = true},
    {"size", BIND_NUMBERS, BIND_AT(view_options, size), "width, height of the texture", "pixels",
     .optional = true, .def_text = "{512, 512}"},
    {0}};

static const bind_fn view_methods[] = {
    {"setCamera", "Moves the view's camera.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(view_camera_args, options), "the camera",
                .fields = camera_fields}),
     NULL, sizeof(view_camera_args), BIND_RUNNING, .run = view_set_camera},
    {"destroy", "Removes the view; who shows its texture shows a checker then.", NULL, NULL,
     sizeof(core_handle), BIND_RUNNING, .run = view_destroy},
    {0}};

const bind_type bind_view_type = {"View", "A part of the picture, or a texture, with a camera.",
                                  view_alive, view_methods};

static const bind_fn functions[] = {
    {"setCamera", "Places the camera.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(camera_call, options), "the camera",
                .fields = camera_fields}),
     NULL, sizeof(camera_call), BIND_RUNNING, .run = set_camera},
    {"lookAt", "Puts the camera at x, y, z, looking at tx, ty, tz.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(look_args, x), "", "m"},
               {"y", BIND_NUMBER, BIND_AT(look_args, y), "", "m"},
               {"z", BIND_NUMBER, BIND_AT(look_args, z), "", "m"},
               {"tx", BIND_NUMBER, BIND_AT(look_args, tx), "", "m"},
               {"ty", BIND_NUMBER, BIND_AT(look_args, ty), "", "m"},
               {"tz", BIND_NUMBER, BIND_AT(look_args, tz), "", "m"}),
     NULL, sizeof(look_args), BIND_RUNNING, .run = look_at},
    {"getCamera", "Position and rotation of the camera.", NULL,
     BIND_RETURNS({"x", "number", "m"}, {"y", "number", "m"}, {"z", "number", "m"},
                  {"qx", "number", NULL}, {"qy", "number", NULL}, {"qz", "number", NULL},
                  {"qw", "number", NULL}),
     0, BIND_VIEW, .run = get_camera},
    {"newView",
     "Makes a view: a part of the picture, in place of what the camera sees, or a texture.",
     BIND_ARGS(
         {"options", BIND_OPTIONS, BIND_AT(view_call, options), "the view", .fields = view_fields}),
     BIND_RETURNS({"view", "corsac.View", NULL}), sizeof(view_call), BIND_RUNNING, .run = new_view},
    {0}};

static const bind_module modules[] = {{"corsac.gfx", "Cameras and views.", functions}, {0}};
static const bind_type *const types[] = {&bind_view_type, NULL};

const bind_room bind_camera_room = {"gfx", modules, types};
