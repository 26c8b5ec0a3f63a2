// corsac.phys: questions to the world, which change nothing: rays, sweeps, overlaps, closest
// points.
#include "script/bind_body.h"
#include "script/bind_region.h"
#include "script/internal.h"

enum { ASK_BODIES_MAX = 256 };

typedef struct ask_options {
    const char *layer;
    core_handle skip;
} ask_options;
typedef struct ask_args {
    double x, y, z, dx, dy, dz, radius;
    ask_options options;
} ask_args;

static phys_filter make_filter(script *s, lua_State *L, const ask_options *o) {
    phys_filter f = phys_filter_default();
    f.layers = o->layer ? 1u << bind_layer(s, L, o->layer) : 0;
    f.skip = o->skip;
    return f;
}

static core_vec3 at_of(const ask_args *a) { return core_v3((float)a->x, (float)a->y, (float)a->z); }
static core_vec3 way_of(const ask_args *a) {
    return core_v3((float)a->dx, (float)a->dy, (float)a->dz);
}

static int push_hit(script *s, lua_State *L, const phys_hit *h) {
    if (!h->hit) {
        lua_pushnil(L);
        return 1;
    }
    const float v[7] = {h->point.x,  h->point.y,  h->point.z, h->normal.x,
                        h->normal.y, h->normal.z, h->fraction};
    bind_push(s, L, &bind_body_type, h->body);
    for (int i = 0; i < 7; i++) {
        lua_pushnumber(L, (lua_Number)v[i]);
    }
    return 8;
}

static int ray_cast(script *s, lua_State *L, void *args) {
    const ask_args *a = args;
    phys_world *w = scene_phys_if(s->scene);
    phys_filter f = make_filter(s, L, &a->options);
    phys_hit hit = {0};
    if (w != NULL) {
        phys_world_ray(w, at_of(a), way_of(a), &f, &hit);
    }
    return push_hit(s, L, &hit);
}

static phys_shape_desc ball_of(const ask_args *a) {
    phys_shape_desc d = phys_shape_desc_default(PHYS_SPHERE);
    d.radius = (float)a->radius;
    return d;
}

static int sphere_cast(script *s, lua_State *L, void *args) {
    const ask_args *a = args;
    phys_world *w = scene_phys_if(s->scene);
    phys_filter f = make_filter(s, L, &a->options);
    phys_shape_desc ball = ball_of(a);
    phys_hit hit = {0};
    if (w != NULL) {
        phys_world_cast(w, &ball, at_of(a), core_quat_identity(), way_of(a), &f, &hit);
    }
    return push_hit(s, L, &hit);
}

static int closest(script *s, lua_State *L, void *args) {
    const ask_args *a = args;
    phys_world *w = scene_phys_if(s->scene);
    phys_filter f = make_filter(s, L, &a->options);
    phys_hit hit = {0};
    if (w != NULL) {
        phys_world_closest(w, at_of(a), (float)a->radius, &f, &hit);
    }
    return push_hit(s, L, &hit);
}

static int overlap_sphere(script *s, lua_State *L, void *args) {
    const ask_args *a = args;
    phys_world *w = scene_phys_if(s->scene);
    phys_filter f = make_filter(s, L, &a->options);
    phys_shape_desc ball = ball_of(a);
    phys_body found[ASK_BODIES_MAX];
    uint32_t n = 0;
    if (w != NULL) {
        n = phys_world_overlap(w, &ball, at_of(a), core_quat_identity(), &f, found, ASK_BODIES_MAX);
    }
    n = CORE_MIN(n, ASK_BODIES_MAX);
    lua_createtable(L, (int)n, 0);
    for (uint32_t i = 0; i < n; i++) {
        bind_push(s, L, &bind_body_type, found[i]);
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 1;
}

static const bind_arg ask_fields[] = {
    {"layer", BIND_STRING, BIND_AT(ask_options, layer),
     "sees only bodies of this layer; without, all", .optional = true},
    {"skip", BIND_OBJECT, BIND_AT(ask_options, skip), "a body that is not seen", .optional = true,
     .def_text = "none", .type = &bind_body_type},
    {0}};

#define FROM                                                                                       \
    {"x", BIND_NUMBER, BIND_AT(ask_args, x), "from here", "m"},                                    \
        {"y", BIND_NUMBER, BIND_AT(ask_args, y), "", "m"}, {                                       \
        "z", BIND_NUMBER, BIND_AT(ask_args, z), "", "m"                                            \
    }
#define WAY                                                                                        \
    {"dx", BIND_NUMBER, BIND_AT(ask_args, dx), "as far as this", "m"},                             \
        {"dy", BIND_NUMBER, BIND_AT(ask_args, dy), "", "m"}, {                                     \
        "dz", BIND_NUMBER, BIND_AT(ask_args, dz), "", "m"                                          \
    }
#define RADIUS(what)                                                                               \
    { "radius", BIND_NUMBER, BIND_AT(ask_args, radius), what, "m", BIND_POSITIVE }
#define OPTIONS                                                                                    \
    {                                                                                              \
        "options", BIND_OPTIONS, BIND_AT(ask_args, options), "what is seen",                       \
            .optional = true, .def_text = "everything", .fields = ask_fields                       \
    }
#define HIT(last, unit)                                                                            \
    BIND_RETURNS({"body", "corsac.Body?", NULL}, {"x", "number", "m"}, {"y", "number", "m"},       \
                 {"z", "number", "m"}, {"nx", "number", NULL}, {"ny", "number", NULL},             \
                 {"nz", "number", NULL}, {last, "number", unit})

const bind_fn bind_ask_functions[] = {
    {"rayCast",
     "Nearest body on the way, where it is hit, its normal there, and the part of the way.",
     BIND_ARGS(FROM, WAY, OPTIONS), HIT("fraction", NULL), sizeof(ask_args), BIND_RUNNING,
     .mod = true, .cost = 300, .run = ray_cast},
    {"sphereCast", "As rayCast, with a ball that is carried along the way.",
     BIND_ARGS(FROM, RADIUS("of the ball"), WAY, OPTIONS), HIT("fraction", NULL), sizeof(ask_args),
     BIND_RUNNING, .mod = true, .cost = 1000, .run = sphere_cast},
    {"closest", "Closest point of any body within a distance.",
     BIND_ARGS(FROM, RADIUS("farthest distance"), OPTIONS), HIT("distance", "m"), sizeof(ask_args),
     BIND_RUNNING, .mod = true, .cost = 1000, .run = closest},
    {"overlapSphere", "The bodies that a ball overlaps, at most 256 of them.",
     BIND_ARGS(FROM, RADIUS("of the ball"), OPTIONS),
     BIND_RETURNS({"bodies", "corsac.Body[]", NULL}), sizeof(ask_args), BIND_RUNNING, .mod = true,
     .cost = 2000, .run = overlap_sphere},
    {0}};
