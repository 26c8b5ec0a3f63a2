// corsac.gfx: camera, lights, drawing on the screen. None of it changes the simulation.
#include "script/internal.h"

#include <string.h>

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

typedef struct rgb_args {
    double r, g, b;
} rgb_args;
static int set_background(script *s, lua_State *L, void *args) {
    const rgb_args *a = args;
    (void)L;
    gfx_world_set_background(scene_gfx(s->scene), (float)a->r, (float)a->g, (float)a->b);
    return 0;
}
static int set_ambient(script *s, lua_State *L, void *args) {
    const rgb_args *a = args;
    (void)L;
    gfx_world_set_ambient(scene_gfx(s->scene), (float)a->r, (float)a->g, (float)a->b);
    return 0;
}

// ---- camera ----

typedef struct camera_options {
    core_vec3 position, target;
    core_quat rotation;
    float fov, near_plane, far;
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

static int set_camera(script *s, lua_State *L, void *args) {
    const camera_options *o = &((camera_call *)args)->options;
    gfx_world *world = scene_gfx(s->scene);
    gfx_camera camera = gfx_world_camera(world);
    if (o->has_target && o->has_rotation) {
        bind_error(L, "corsac.gfx.setCamera: give either target or rotation");
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

// ---- lights ----

#define LIGHT_TYPES "point|spot|directional"
typedef struct light_options {
    int type;
    core_vec3 position, direction;
    float color[4], intensity, radius, inner, outer;
} light_options;
typedef struct light_call {
    light_options options;
} light_call;

extern const bind_type bind_light_type;

static int new_light(script *s, lua_State *L, void *args) {
    const light_options *o = &((light_call *)args)->options;
    gfx_light_desc desc = gfx_light_desc_default((gfx_light_type)o->type);
    desc.position = o->position;
    desc.direction = core_v3_normalize(o->direction, core_v3(0, -1, 0));
    memcpy(desc.color, o->color, sizeof desc.color);
    desc.intensity = o->intensity;
    desc.radius = o->radius;
    desc.inner = o->inner;
    desc.outer = o->outer;
    gfx_light light = gfx_light_create(scene_gfx(s->scene), &desc);
    if (core_handle_is_null(light)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_light_type, light);
    return 1;
}

// Stale lights are caught by the room itself: every function of it checks its handle.
static bool light_alive(script *s, core_handle h) {
    (void)h;
    return scene_gfx_if(s->scene) != NULL;
}

typedef struct light_vector_args {
    core_handle self;
    double x, y, z;
} light_vector_args;
typedef struct light_color_args {
    core_handle self;
    double r, g, b, intensity;
} light_color_args;

static int light_set_position(script *s, lua_State *L, void *args) {
    const light_vector_args *a = args;
    return done(L, gfx_light_set_position(scene_gfx(s->scene), a->self,
                                          core_v3((float)a->x, (float)a->y, (float)a->z)));
}
static int light_set_color(script *s, lua_State *L, void *args) {
    const light_color_args *a = args;
    return done(L, gfx_light_set_color(scene_gfx(s->scene), a->self, (float)a->r, (float)a->g,
                                       (float)a->b, (float)a->intensity));
}
static int light_destroy(script *s, lua_State *L, void *args) {
    return done(L, gfx_light_destroy(scene_gfx(s->scene), *(core_handle *)args));
}

#define COLOR_ARG(T, member)                                                                       \
    { #member, BIND_NUMBER, BIND_AT(T, member), "linear", NULL, BIND_NOT_NEGATIVE }

static const bind_fn light_methods[] = {
    {"setPosition", "Moves a point or spot light.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(light_vector_args, x), "", "m"},
               {"y", BIND_NUMBER, BIND_AT(light_vector_args, y), "", "m"},
               {"z", BIND_NUMBER, BIND_AT(light_vector_args, z), "", "m"}),
     NULL, sizeof(light_vector_args), BIND_RUNNING, .mod = true, .cost = 8,
     .run = light_set_position},
    {"setColor", "Changes colour and intensity.",
     BIND_ARGS(COLOR_ARG(light_color_args, r), COLOR_ARG(light_color_args, g),
               COLOR_ARG(light_color_args, b),
               {"intensity", BIND_NUMBER, BIND_AT(light_color_args, intensity),
                "point, spot: radiant intensity; directional: irradiance", NULL,
                BIND_NOT_NEGATIVE}),
     NULL, sizeof(light_color_args), BIND_RUNNING, .mod = true, .cost = 8, .run = light_set_color},
    {"destroy", "Removes the light.", NULL, NULL, sizeof(core_handle), BIND_RUNNING, .mod = true,
     .cost = 20, .run = light_destroy},
    {0}};

const bind_type bind_light_type = {"Light", "A source of light.", light_alive, light_methods};

// ---- the screen ----

typedef struct print_args {
    const char *text;
    double x, y, size;
    float color[4];
} print_args;
static int print(script *s, lua_State *L, void *args) {
    const print_args *a = args;
    (void)L;
    gfx_print(scene_gfx(s->scene), (float)a->x, (float)a->y, (float)a->size, a->color, a->text);
    return 0;
}

typedef struct rect_args {
    double x, y, w, h;
    float color[4];
} rect_args;
static int rect(script *s, lua_State *L, void *args) {
    const rect_args *a = args;
    (void)L;
    gfx_rect(scene_gfx(s->scene), (float)a->x, (float)a->y, (float)a->w, (float)a->h, a->color);
    return 0;
}

typedef struct image_args {
    const char *path;
    double x, y, w, h;
} image_args;
static int image(script *s, lua_State *L, void *args) {
    const image_args *a = args;
    (void)L;
    gfx_image(scene_gfx(s->scene), a->path, (float)a->x, (float)a->y, (float)a->w, (float)a->h);
    return 0;
}

#define RENDERS "auto|forward|clustered|none"
static const char *const renders[] = {"auto", "forward", "clustered", "none"};
typedef struct render_args {
    int method;
} render_args;
static int set_render(script *s, lua_State *L, void *args) {
    return done(
        L, gfx_world_set(scene_gfx(s->scene), "render", renders[((render_args *)args)->method]));
}

// ---- declarations ----

static const bind_arg camera_fields[] = {
    {"position", BIND_VEC3, BIND_AT(camera_options, position), "of the eye", "m", .optional = true,
     .def_text = "as before", BIND_GIVEN(camera_options, has_position)},
    {"target", BIND_VEC3, BIND_AT(camera_options, target), "point it looks at", "m",
     .optional = true, .def_text = "as before", BIND_GIVEN(camera_options, has_target)},
    {"rotation", BIND_QUAT, BIND_AT(camera_options, rotation), "in place of target; looks along -Z",
     .optional = true, .def_text = "as before", BIND_GIVEN(camera_options, has_rotation)},
    {"fov", BIND_FLOAT, BIND_AT(camera_options, fov), "vertical field of view", "rad", BIND_BETWEEN,
     .min = 0.01, .max = 3, .optional = true, .def = 1.0471975511965976},
    {"near", BIND_FLOAT, BIND_AT(camera_options, near_plane), "nearest visible distance", "m",
     BIND_POSITIVE, .optional = true, .def = 0.1},
    {"far", BIND_FLOAT, BIND_AT(camera_options, far), "no point or spot light is seen beyond", "m",
     BIND_POSITIVE, .optional = true, .def = 100},
    {0}};

static const bind_arg light_fields[] = {
    {"type", BIND_ENUM, BIND_AT(light_options, type), "kind of source", .optional = true,
     .values = LIGHT_TYPES},
    {"position", BIND_VEC3, BIND_AT(light_options, position), "point, spot", "m", .optional = true},
    {"direction", BIND_VEC3, BIND_AT(light_options, direction),
     "spot, directional: where the light goes", .optional = true, .def_vec = {0, -1, 0}},
    {"color", BIND_COLOR, BIND_AT(light_options, color), "linear", .optional = true,
     .def_vec = {1, 1, 1}},
    {"intensity", BIND_FLOAT, BIND_AT(light_options, intensity),
     "point, spot: radiant intensity; directional: irradiance", NULL, BIND_NOT_NEGATIVE,
     .optional = true, .def = 1},
    {"radius", BIND_FLOAT, BIND_AT(light_options, radius), "point, spot: no light beyond", "m",
     BIND_POSITIVE, .optional = true, .def = 10},
    {"inner", BIND_FLOAT, BIND_AT(light_options, inner), "spot: half angle of full light", "rad",
     BIND_BETWEEN, .max = 1.55, .optional = true, .def = 0.4},
    {"outer", BIND_FLOAT, BIND_AT(light_options, outer), "spot: half angle of any light", "rad",
     BIND_BETWEEN, .max = 1.57, .optional = true, .def = 0.5},
    {0}};

#define RGB_ARGS BIND_ARGS(COLOR_ARG(rgb_args, r), COLOR_ARG(rgb_args, g), COLOR_ARG(rgb_args, b))
#define PIXELS(T, member, what)                                                                    \
    { #member, BIND_NUMBER, BIND_AT(T, member), what, "pixels" }

static const bind_fn functions[] = {
    {"setBackground", "Colour where nothing is drawn.", RGB_ARGS, NULL, sizeof(rgb_args),
     BIND_RUNNING, .mod = true, .cost = 8, .run = set_background},
    {"setAmbient", "Light that comes from everywhere.", RGB_ARGS, NULL, sizeof(rgb_args),
     BIND_RUNNING, .mod = true, .cost = 8, .run = set_ambient},
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
    {"newLight", "Makes a light.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(light_call, options), "the light",
                .fields = light_fields}),
     BIND_RETURNS({"light", "corsac.Light", NULL}), sizeof(light_call), BIND_RUNNING, .mod = true,
     .cost = 500, .run = new_light},
    {"setRender", "How lights are assigned to what they light.",
     BIND_ARGS({"method", BIND_ENUM, BIND_AT(render_args, method), "", .values = RENDERS}), NULL,
     sizeof(render_args), BIND_RUNNING, .run = set_render},
    {"print", "Writes text over the frame; the origin is its top left corner.",
     BIND_ARGS({"text", BIND_STRING, BIND_AT(print_args, text), "UTF-8"},
               PIXELS(print_args, x, "left"), PIXELS(print_args, y, "top"),
               {"size", BIND_NUMBER, BIND_AT(print_args, size), "height of a line", "pixels",
                BIND_POSITIVE, .optional = true, .def = 18},
               {"color", BIND_COLOR, BIND_AT(print_args, color), "sRGB", .optional = true,
                .def_vec = {1, 1, 1}}),
     NULL, sizeof(print_args), BIND_DRAW, .mod = true, .cost = 200, .run = print},
    {"rect", "Fills a rectangle over the frame.",
     BIND_ARGS(PIXELS(rect_args, x, "left"), PIXELS(rect_args, y, "top"),
               PIXELS(rect_args, w, "width"), PIXELS(rect_args, h, "height"),
               {"color", BIND_COLOR, BIND_AT(rect_args, color), "sRGB", .optional = true,
                .def_vec = {1, 1, 1}}),
     NULL, sizeof(rect_args), BIND_DRAW, .mod = true, .cost = 50, .run = rect},
    {"image", "Draws an image file over the frame.",
     BIND_ARGS({"path", BIND_STRING, BIND_AT(image_args, path), "in the game's folder"},
               PIXELS(image_args, x, "left"), PIXELS(image_args, y, "top"),
               PIXELS(image_args, w, "width"), PIXELS(image_args, h, "height")),
     NULL, sizeof(image_args), BIND_DRAW, .mod = true, .cost = 200, .run = image},
    {0}};

static const bind_module modules[] = {
    {"corsac.gfx", "Camera, lights and what is drawn over the frame.", functions}, {0}};
static const bind_type *const types[] = {&bind_light_type, NULL};

const bind_room bind_gfx_room = {"gfx", modules, types};
