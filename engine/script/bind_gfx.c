// corsac.gfx: camera, lights, drawing on the screen. None of it changes the simulation.
#include "script/bind_gfx.h"
#include "script/internal.h"

#include <stdio.h>
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

// ---- lights ----

#define LIGHT_TYPES "point|spot|directional"
typedef struct light_options {
    int type;
    core_vec3 position, direction;
    float color[4], intensity, radius, inner, outer, source;
    bool shadows, has_shadows, has_source;
} light_options;
typedef struct light_call {
    light_options options;
} light_call;

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
    if (o->has_source) {
        desc.source = o->source;
    }
    if (o->has_shadows) {
        desc.shadows = o->shadows;
    }
    gfx_light light = gfx_light_create(scene_gfx(s->scene), &desc);
    if (core_handle_is_null(light)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_light_type, light);
    return 1;
}

static bool light_alive(script *s, core_handle h) {
    return scene_gfx_if(s->scene) && gfx_light_alive(scene_gfx_if(s->scene), h);
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
static int light_set_direction(script *s, lua_State *L, void *args) {
    const light_vector_args *a = args;
    return done(L, gfx_light_set_direction(scene_gfx(s->scene), a->self,
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
    {"setDirection", "Turns a spot or directional light: where its light goes.",
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(light_vector_args, x)},
               {"y", BIND_NUMBER, BIND_AT(light_vector_args, y)},
               {"z", BIND_NUMBER, BIND_AT(light_vector_args, z)}),
     NULL, sizeof(light_vector_args), BIND_RUNNING, .mod = true, .cost = 8,
     .run = light_set_direction},
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

// ---- materials ----

#define ALPHA_MODES "opaque|mask|blend"
typedef struct material_options {
    float base_color[4], emissive[4], metallic, roughness, normal_scale, occlusion, cutoff;
    int alpha;
    bool double_sided;
    const char *fragment;
    bind_numbers parameters;
    const char *base_color_map, *normal_map, *metallic_roughness_map, *occlusion_map, *emissive_map;
} material_options;
typedef struct material_call {
    material_options options;
} material_call;

static bool material_alive(script *s, core_handle h) {
    return scene_gfx_if(s->scene) && gfx_material_alive(scene_gfx_if(s->scene), h);
}

static void copy_path(lua_State *L, char out[CORE_NAME_MAX], const char *path) {
    if (path && strlen(path) >= CORE_NAME_MAX) {
        bind_error(L, "corsac.gfx.newMaterial: the path '%s' is longer than %d bytes", path,
                   CORE_NAME_MAX - 1);
    }
    if (path) {
        memcpy(out, path, strlen(path) + 1);
    }
}

static int new_material(script *s, lua_State *L, void *args) {
    const material_options *o = &((material_call *)args)->options;
    gfx_material_desc desc = gfx_material_desc_default();
    core_material_data *m = &desc.data;
    memcpy(m->base_color, o->base_color, sizeof m->base_color);
    memcpy(m->emissive, o->emissive, sizeof m->emissive);
    m->metallic = o->metallic, m->roughness = o->roughness;
    m->normal_scale = o->normal_scale, m->occlusion_strength = o->occlusion;
    m->alpha_mode = o->alpha, m->alpha_cutoff = o->cutoff;
    m->double_sided = o->double_sided;
    copy_path(L, m->base_color_image, o->base_color_map);
    copy_path(L, m->normal_image, o->normal_map);
    copy_path(L, m->metallic_roughness_image, o->metallic_roughness_map);
    copy_path(L, m->occlusion_image, o->occlusion_map);
    copy_path(L, m->emissive_image, o->emissive_map);
    if (o->fragment && s->as_mod) {
        bind_error(L, "corsac.gfx.newMaterial: options.fragment: mods may not bring shaders");
    }
    desc.fragment = o->fragment;
    bind_shader_parameters(L, "corsac.gfx.newMaterial", &o->parameters, desc.parameters);
    gfx_material material = gfx_material_create(scene_gfx(s->scene), &desc);
    if (core_handle_is_null(material)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_material_type, material);
    return 1;
}

static int material_destroy(script *s, lua_State *L, void *args) {
    return done(L, gfx_material_destroy(scene_gfx(s->scene), *(core_handle *)args));
}

typedef struct material_parameters_args {
    core_handle self;
    bind_numbers parameters;
} material_parameters_args;
static int material_set_parameters(script *s, lua_State *L, void *args) {
    const material_parameters_args *a = args;
    float parameters[16];
    bind_shader_parameters(L, "Material:setParameters", &a->parameters, parameters);
    return done(L, gfx_material_set_parameters(scene_gfx(s->scene), a->self, parameters));
}

static const bind_fn material_methods[] = {
    {"setParameters", "Changes what parameter(i) gives in the material's shader.",
     BIND_ARGS({"parameters", BIND_NUMBERS, BIND_AT(material_parameters_args, parameters),
                "up to 16 numbers; the others become 0"}),
     NULL, sizeof(material_parameters_args), BIND_RUNNING, .run = material_set_parameters},
    {"destroy", "Removes the material: what has it is drawn in the plain one.", NULL, NULL,
     sizeof(core_handle), BIND_RUNNING, .mod = true, .cost = 20, .run = material_destroy},
    {0}};

const bind_type bind_material_type = {"Material",
                                      "How a surface looks: metallic-roughness, as glTF.",
                                      material_alive, material_methods};

#define MAP(member, what) BIND_STRING, BIND_AT(material_options, member), what, .optional = true
static const bind_arg material_fields[] = {
    {"baseColor", BIND_COLOR, BIND_AT(material_options, base_color), "linear, and coverage",
     .optional = true, .def_vec = {1, 1, 1}},
    {"metallic", BIND_FLOAT, BIND_AT(material_options, metallic), "0 or 1 but where things mix",
     NULL, BIND_BETWEEN, .max = 1, .optional = true},
    {"roughness", BIND_FLOAT, BIND_AT(material_options, roughness), "0 is a mirror", NULL,
     BIND_BETWEEN, .max = 1, .optional = true, .def = 0.5},
    {"emissive", BIND_COLOR, BIND_AT(material_options, emissive), "radiance sent out",
     .optional = true},
    {"alpha", BIND_ENUM, BIND_AT(material_options, alpha), "what coverage means", .optional = true,
     .values = ALPHA_MODES},
    {"cutoff", BIND_FLOAT, BIND_AT(material_options, cutoff), "mask: least coverage that is drawn",
     NULL, BIND_BETWEEN, .max = 1, .optional = true, .def = 0.5},
    {"doubleSided", BIND_BOOL, BIND_AT(material_options, double_sided), "seen from behind too",
     .optional = true},
    {"normalScale", BIND_FLOAT, BIND_AT(material_options, normal_scale), "of the normal map",
     .optional = true, .def = 1},
    {"occlusion", BIND_FLOAT, BIND_AT(material_options, occlusion), "strength of the occlusion map",
     NULL, BIND_BETWEEN, .max = 1, .optional = true, .def = 1},
    {"baseColorMap", MAP(base_color_map, "image file, sRGB")},
    {"normalMap", MAP(normal_map, "image file, +Y up")},
    {"metallicRoughnessMap", MAP(metallic_roughness_map, "image file: green rough, blue metallic")},
    {"occlusionMap", MAP(occlusion_map, "image file: red")},
    {"emissiveMap", MAP(emissive_map, "image file, sRGB")},
    {"fragment", MAP(fragment, "shader file with void surface(inout Look look); not for mods")},
    {"parameters", BIND_NUMBERS, BIND_AT(material_options, parameters),
     "parameter(0) to parameter(15) of the shader", .optional = true},
    {0}};

// ---- environment and settings ----

typedef struct environment_options {
    const char *panorama;
    float intensity, zenith[4], horizon[4], ground[4], glow[4], exponent;
    core_vec3 sun;
} environment_options;
typedef struct environment_call {
    environment_options options;
} environment_call;

static int set_environment(script *s, lua_State *L, void *args) {
    const environment_options *o = &((environment_call *)args)->options;
    gfx_environment e = gfx_environment_default();
    e.panorama = o->panorama;
    e.intensity = o->intensity;
    memcpy(e.zenith, o->zenith, sizeof e.zenith);
    memcpy(e.horizon, o->horizon, sizeof e.horizon);
    memcpy(e.ground, o->ground, sizeof e.ground);
    memcpy(e.glow, o->glow, sizeof e.glow);
    e.glow_exponent = o->exponent;
    e.sun = o->sun;
    return done(L, gfx_world_set_environment(scene_gfx(s->scene), &e));
}

static const bind_arg environment_fields[] = {
    {"panorama", BIND_STRING, BIND_AT(environment_options, panorama),
     "equirectangular image file in place of the sky", .optional = true},
    {"intensity", BIND_FLOAT, BIND_AT(environment_options, intensity), "factor", NULL,
     BIND_POSITIVE, .optional = true, .def = 1},
    {"zenith", BIND_COLOR, BIND_AT(environment_options, zenith), "radiance from above",
     .optional = true, .def_vec = {0.16f, 0.32f, 0.72f}},
    {"horizon", BIND_COLOR, BIND_AT(environment_options, horizon), "radiance from the horizon",
     .optional = true, .def_vec = {0.75f, 0.86f, 1.0f}},
    {"ground", BIND_COLOR, BIND_AT(environment_options, ground), "radiance from below",
     .optional = true, .def_vec = {0.22f, 0.2f, 0.18f}},
    {"glow", BIND_COLOR, BIND_AT(environment_options, glow), "radiance round the sun",
     .optional = true, .def_vec = {2.2f, 1.8f, 1.2f}},
    {"glowExponent", BIND_FLOAT, BIND_AT(environment_options, exponent), "the larger the narrower",
     NULL, BIND_BETWEEN, .min = 1, .max = 4096, .optional = true, .def = 64},
    {"sun", BIND_VEC3, BIND_AT(environment_options, sun), "direction to the sun", .optional = true,
     .def_vec = {0.4f, 0.8f, 0.4f}},
    {0}};

typedef struct setting_args {
    const char *name;
    int value;
} setting_args;

// A setting's text of a Lua value: numbers and strings as they are, switches as on and off, a
// colour as its three numbers.
static void setting_text(lua_State *L, int value, char *out, size_t size) {
    if (lua_isboolean(L, value)) {
        snprintf(out, size, "%s", lua_toboolean(L, value) ? "on" : "off");
    } else if (lua_type(L, value) == LUA_TNUMBER) {
        snprintf(out, size, "%.9g", lua_tonumber(L, value));
    } else if (lua_istable(L, value)) {
        double c[3];
        for (int i = 0; i < 3; ++i) {
            lua_rawgeti(L, value, i + 1);
            c[i] = lua_tonumber(L, -1);
            lua_pop(L, 1);
        }
        snprintf(out, size, "%.9g,%.9g,%.9g", c[0], c[1], c[2]);
    } else if (lua_type(L, value) == LUA_TSTRING) {
        snprintf(out, size, "%s", lua_tostring(L, value));
    } else {
        bind_error(L,
                   "corsac.gfx.set: value: expected a string, a number, true, false or "
                   "{r, g, b}, got a %s",
                   luaL_typename(L, value));
    }
}

static int set_setting(script *s, lua_State *L, void *args) {
    const setting_args *a = args;
    char text[128];
    setting_text(L, a->value, text, sizeof text);
    return done(L, gfx_world_set(scene_gfx(s->scene), a->name, text));
}

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
    {"shadows", BIND_BOOL, BIND_AT(light_options, shadows), "casts shadows", .optional = true,
     .def_text = "directional lights only", BIND_GIVEN(light_options, has_shadows)},
    {"source", BIND_FLOAT, BIND_AT(light_options, source),
     "for soft shadows: radius of the source in m, of a sun the tangent of its angular radius",
     NULL, BIND_NOT_NEGATIVE, .optional = true, .def_text = "0.05, of a sun 0.00465",
     BIND_GIVEN(light_options, has_source)},
    {0}};

#define RGB_ARGS BIND_ARGS(COLOR_ARG(rgb_args, r), COLOR_ARG(rgb_args, g), COLOR_ARG(rgb_args, b))
#define PIXELS(T, member, what)                                                                    \
    { #member, BIND_NUMBER, BIND_AT(T, member), what, "pixels" }

static const bind_fn functions[] = {
    {"setBackground", "Colour where nothing is drawn.", RGB_ARGS, NULL, sizeof(rgb_args),
     BIND_RUNNING, .mod = true, .cost = 8, .run = set_background},
    {"setAmbient", "Light that comes from everywhere.", RGB_ARGS, NULL, sizeof(rgb_args),
     BIND_RUNNING, .mod = true, .cost = 8, .run = set_ambient},
    {"newLight", "Makes a light.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(light_call, options), "the light",
                .fields = light_fields}),
     BIND_RETURNS({"light", "corsac.Light", NULL}), sizeof(light_call), BIND_RUNNING, .mod = true,
     .cost = 500, .run = new_light},
    {"newMaterial", "Makes a material.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(material_call, options), "the material",
                .fields = material_fields}),
     BIND_RETURNS({"material", "corsac.Material", NULL}), sizeof(material_call), BIND_RUNNING,
     .mod = true, .cost = 500, .run = new_material},
    {"setEnvironment", "Lights the world by a sky or a panorama, seen behind everything.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(environment_call, options), "the environment",
                .fields = environment_fields}),
     NULL, sizeof(environment_call), BIND_RUNNING, .run = set_environment},
    {"set", "Changes a setting, as --set gfx.NAME=VALUE does.",
     BIND_ARGS({"name", BIND_STRING, BIND_AT(setting_args, name), "such as shadows, bloom, lift"},
               {"value", BIND_VALUE, BIND_AT(setting_args, value),
                "such as \"soft\", 0.2, true, {0.1, 0, 0}"}),
     NULL, sizeof(setting_args), BIND_RUNNING, .run = set_setting},
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
static const bind_type *const types[] = {&bind_light_type, &bind_material_type, NULL};

const bind_room bind_gfx_room = {"gfx", modules, types};
