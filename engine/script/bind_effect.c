// corsac.gfx: passes over the picture by shaders of the game.
#include "script/bind_gfx.h"
#include "script/internal.h"

#include <string.h>

void bind_shader_parameters(lua_State *L, const char *call, const bind_numbers *numbers,
                            float out[16]) {
    memset(out, 0, 16 * sizeof *out);
    if (numbers->count > 16) {
        bind_error(L, "%s: %d parameters, expected at most 16", call, (int)numbers->count);
    }
    if (numbers->count) {
        memcpy(out, numbers->items, numbers->count * sizeof *out);
    }
}

typedef struct effect_options {
    const char *fragment;
    bool encoded;
    bind_numbers parameters;
} effect_options;
typedef struct effect_call {
    effect_options options;
} effect_call;

static bool effect_alive(script *s, core_handle h) {
    return scene_gfx_if(s->scene) && gfx_effect_alive(scene_gfx_if(s->scene), h);
}

static int new_effect(script *s, lua_State *L, void *args) {
    const effect_options *o = &((effect_call *)args)->options;
    gfx_effect_desc desc = gfx_effect_desc_default();
    desc.fragment = o->fragment;
    desc.encoded = o->encoded;
    bind_shader_parameters(L, "corsac.gfx.newEffect", &o->parameters, desc.parameters);
    gfx_effect effect = gfx_effect_create(scene_gfx(s->scene), &desc);
    if (core_handle_is_null(effect)) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_effect_type, effect);
    return 1;
}

typedef struct parameters_args {
    core_handle self;
    bind_numbers parameters;
} parameters_args;
static int set_parameters(script *s, lua_State *L, void *args) {
    const parameters_args *a = args;
    float parameters[16];
    bind_shader_parameters(L, "Effect:setParameters", &a->parameters, parameters);
    if (!gfx_effect_set_parameters(scene_gfx(s->scene), a->self, parameters)) {
        bind_fail(L);
    }
    return 0;
}

static int destroy(script *s, lua_State *L, void *args) {
    if (!gfx_effect_destroy(scene_gfx(s->scene), *(core_handle *)args)) {
        bind_fail(L);
    }
    return 0;
}

static const bind_arg effect_fields[] = {
    {"fragment", BIND_STRING, BIND_AT(effect_options, fragment),
     "shader file with vec3 effect(vec2 uv), which may call picture(uv), depth(uv), size(), "
     "parameter(i)"},
    {"encoded", BIND_BOOL, BIND_AT(effect_options, encoded),
     "on the picture after the tone map, not on linear light before it", .optional = true},
    {"parameters", BIND_NUMBERS, BIND_AT(effect_options, parameters),
     "parameter(0) to parameter(15) of the shader", .optional = true},
    {0}};

static const bind_fn methods[] = {
    {"setParameters", "Changes what parameter(i) gives in the shader.",
     BIND_ARGS({"parameters", BIND_NUMBERS, BIND_AT(parameters_args, parameters),
                "up to 16 numbers; the others become 0"}),
     NULL, sizeof(parameters_args), BIND_RUNNING, .run = set_parameters},
    {"destroy", "Takes the pass away.", NULL, NULL, sizeof(core_handle), BIND_RUNNING,
     .run = destroy},
    {0}};

const bind_type bind_effect_type = {"Effect", "A pass over the picture by a shader of the game.",
                                    effect_alive, methods};

static const bind_fn functions[] = {
    {"newEffect", "Adds a pass over each view's picture by a shader of the game.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(effect_call, options), "the pass",
                .fields = effect_fields}),
     BIND_RETURNS({"effect", "corsac.Effect", NULL}), sizeof(effect_call), BIND_RUNNING,
     .run = new_effect},
    {0}};

static const bind_module modules[] = {{"corsac.gfx", "Passes over the picture.", functions}, {0}};
static const bind_type *const types[] = {&bind_effect_type, NULL};

const bind_room bind_effect_room = {"gfx", modules, types};
