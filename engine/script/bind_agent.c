// Agents of corsac.nav.
#include "script/bind_body.h"
#include "script/bind_grid.h"
#include "script/bind_mover.h"
#include "script/bind_nav.h"
#include "script/internal.h"

static nav_world *world_of(script *s) { return scene_nav(s->scene); }

static int done(lua_State *L, bool good) {
    if (!good) {
        bind_fail(L);
    }
    return 0;
}

bool bind_agent_alive(script *s, core_handle h) {
    nav_world *w = scene_nav_if(s->scene);
    return w && nav_agent_alive(w, h);
}

int bind_agent_new(script *s, lua_State *L, void *args) {
    const bind_agent_options *o = &((bind_agent_call *)args)->options;
    if (o->has_entity + o->has_position + o->has_mover != 1) {
        bind_error(L, "corsac.nav.newAgent: give an entity or a mover (which say where it is), or "
                      "a position");
    }
    nav_agent_desc desc = nav_agent_desc_default();
    desc.position = o->position;
    desc.radius = o->radius;
    desc.max_speed = o->max_speed;
    desc.acceleration = o->acceleration;
    desc.turn_rate = o->turn_rate;
    desc.arrive = o->arrive;
    desc.heading = o->heading;
    nav_agent agent = nav_agent_create(world_of(s), &desc);
    if (core_handle_is_null(agent) ||
        (o->has_entity && !scene_set_agent(s->scene, o->entity, agent, o->offset)) ||
        (o->has_mover && !scene_lead_mover(s->scene, agent, o->mover, o->offset))) {
        bind_fail(L);
    }
    bind_push(s, L, &bind_agent_type, agent);
    return 1;
}

typedef struct go_args {
    core_handle self, graph;
    float x, y, z;
} go_args;
static int go(script *s, lua_State *L, void *args) {
    const go_args *a = args;
    return done(L, nav_agent_go(world_of(s), a->self, a->graph, core_v3(a->x, a->y, a->z)));
}
static int cross(script *s, lua_State *L, void *args) {
    const go_args *a = args;
    return done(L, nav_agent_go_on_mesh(world_of(s), a->self, a->graph, core_v3(a->x, a->y, a->z)));
}
typedef struct flow_args {
    core_handle self, flow;
} flow_args;
static int follow(script *s, lua_State *L, void *args) {
    const flow_args *a = args;
    return done(L, nav_agent_go_with_flow(world_of(s), a->self, a->flow));
}
static int stop(script *s, lua_State *L, void *args) {
    return done(L, nav_agent_stop(world_of(s), *(core_handle *)args));
}
static int get_state(script *s, lua_State *L, void *args) {
    nav_agent_state state = nav_agent_status(world_of(s), *(core_handle *)args);
    lua_pushstring(L, nav_agent_state_name(state));
    return 1;
}
static int get_position(script *s, lua_State *L, void *args) {
    core_vec3 p = {0, 0, 0};
    done(L, nav_agent_position(world_of(s), *(core_handle *)args, &p));
    bind_push_vec3(L, p);
    return 3;
}
typedef struct place_args {
    core_handle self;
    float x, y, z;
} place_args;
static int set_position(script *s, lua_State *L, void *args) {
    const place_args *a = args;
    scene_entity e = scene_entity_of_agent(s->scene, a->self);
    if (!core_handle_is_null(e)) {
        bind_error(L, "Agent:setPosition: this agent is where its entity is; move that");
    }
    return done(L, nav_agent_set_position(world_of(s), a->self, core_v3(a->x, a->y, a->z)));
}
static int get_velocity(script *s, lua_State *L, void *args) {
    core_vec3 v = {0, 0, 0};
    done(L, nav_agent_velocity(world_of(s), *(core_handle *)args, &v));
    bind_push_vec3(L, v);
    return 3;
}
static int get_heading(script *s, lua_State *L, void *args) {
    float heading = 0.0f;
    done(L, nav_agent_heading(world_of(s), *(core_handle *)args, &heading));
    lua_pushnumber(L, (double)heading);
    return 1;
}
typedef struct speed_args {
    core_handle self;
    float speed;
} speed_args;
static int set_max_speed(script *s, lua_State *L, void *args) {
    const speed_args *a = args;
    return done(L, nav_agent_set_max_speed(world_of(s), a->self, a->speed));
}
static int get_link(script *s, lua_State *L, void *args) {
    uint32_t link = nav_agent_link(world_of(s), *(core_handle *)args);
    if (link == NAV_NO_LINK) {
        return 0;
    }
    lua_pushnumber(L, link);
    return 1;
}
static int get_entity(script *s, lua_State *L, void *args) {
    bind_push(s, L, &bind_entity_type, scene_entity_of_agent(s->scene, *(core_handle *)args));
    return 1;
}
static int destroy(script *s, lua_State *L, void *args) {
    return done(L, nav_agent_destroy(world_of(s), *(core_handle *)args));
}

#define POINT(type)                                                                                \
    {"x", BIND_FLOAT, BIND_AT(type, x), "", "m"}, {"y", BIND_FLOAT, BIND_AT(type, y), "", "m"}, {  \
        "z", BIND_FLOAT, BIND_AT(type, z), "", "m"                                                 \
    }
#define SELF   sizeof(core_handle)
#define VECTOR BIND_RETURNS({"x", "number", "m"}, {"y", "number", "m"}, {"z", "number", "m"})
#define OPTION(name, member, about, unit, range, ...)                                              \
    { name, BIND_FLOAT, BIND_AT(bind_agent_options, member), about, unit, range, __VA_ARGS__ }

const bind_arg bind_agent_fields[] = {
    {"entity", BIND_OBJECT, BIND_AT(bind_agent_options, entity),
     "whom it leads: without a body it goes where the agent goes, a body is pushed along",
     .optional = true, .def_text = "nil", .type = &bind_entity_type,
     BIND_GIVEN(bind_agent_options, has_entity)},
    {"mover", BIND_OBJECT, BIND_AT(bind_agent_options, mover), "whose walk it decides",
     .optional = true, .def_text = "nil", .type = &bind_mover_type,
     BIND_GIVEN(bind_agent_options, has_mover)},
    {"position", BIND_VEC3, BIND_AT(bind_agent_options, position),
     "where it stands, without entity or mover", "m", .optional = true, .def_text = "the entity's",
     BIND_GIVEN(bind_agent_options, has_position)},
    OPTION("offset", offset, "height of the origin of entity or mover above its feet", "m",
           BIND_ANY_NUMBER, .optional = true),
    OPTION("radius", radius, "room it needs", "m", BIND_POSITIVE, .optional = true, .def = 0.3),
    OPTION("maxSpeed", max_speed, "", "m/s", BIND_POSITIVE, .optional = true, .def = 1.5),
    OPTION("acceleration", acceleration, "braking too", "m/s^2", BIND_POSITIVE, .optional = true,
           .def = 8),
    OPTION("turnRate", turn_rate, "0: turns at once", "rad/s", BIND_NOT_NEGATIVE, .optional = true),
    OPTION("arrive", arrive, "how near to the goal it stops", "m", BIND_POSITIVE, .optional = true,
           .def = 0.1),
    OPTION("heading", heading, "about +Y, 0 looks along -Z", "rad", BIND_ANY_NUMBER,
           .optional = true),
    {0}};

const bind_fn bind_agent_methods[] = {
    {"go", "Walks on a graph to the node nearest to a point, then to the point.",
     BIND_ARGS(
         {"graph", BIND_OBJECT, BIND_AT(go_args, graph), "on which", .type = &bind_graph_type},
         POINT(go_args)),
     NULL, sizeof(go_args), BIND_SIM, .run = go},
    {"cross", "Walks across a surface to the point of it nearest to a point.",
     BIND_ARGS(
         {"surface", BIND_OBJECT, BIND_AT(go_args, graph), "on which", .type = &bind_surface_type},
         POINT(go_args)),
     NULL, sizeof(go_args), BIND_SIM, .run = cross},
    {"follow", "Walks with a flow to its goal.",
     BIND_ARGS(
         {"flow", BIND_OBJECT, BIND_AT(flow_args, flow), "where to", .type = &bind_flow_type}),
     NULL, sizeof(flow_args), BIND_SIM, .run = follow},
    {"stop", "Stands still.", NULL, NULL, SELF, BIND_SIM, .run = stop},
    {"getState", "\"idle\", \"walking\", \"arrived\" or \"stuck\".", NULL,
     BIND_RETURNS({"state", "string", NULL}), SELF, BIND_RUNNING, .run = get_state},
    {"getPosition", "Where it stands.", NULL, VECTOR, SELF, BIND_RUNNING, .run = get_position},
    {"setPosition", "Places it; not for agents of entities.", BIND_ARGS(POINT(place_args)), NULL,
     sizeof(place_args), BIND_SIM, .run = set_position},
    {"getVelocity", "How it moves.", NULL,
     BIND_RETURNS({"x", "number", "m/s"}, {"y", "number", "m/s"}, {"z", "number", "m/s"}), SELF,
     BIND_RUNNING, .run = get_velocity},
    {"getHeading", "Where it looks: about +Y, 0 along -Z.", NULL,
     BIND_RETURNS({"heading", "number", "rad"}), SELF, BIND_RUNNING, .run = get_heading},
    {"setMaxSpeed", "How fast it may go.",
     BIND_ARGS({"speed", BIND_FLOAT, BIND_AT(speed_args, speed), "", "m/s", BIND_POSITIVE}), NULL,
     sizeof(speed_args), BIND_SIM, .run = set_max_speed},
    {"getLink", "Id of the surface's link on which it is now, nothing on the ground.", NULL,
     BIND_RETURNS({"link", "integer?", NULL}), SELF, BIND_RUNNING, .run = get_link},
    {"getEntity", "Whom it leads, or nil.", NULL, BIND_RETURNS({"entity", "corsac.Entity?", NULL}),
     SELF, BIND_RUNNING, .run = get_entity},
    {"destroy", "Removes it; its entity stays.", NULL, NULL, SELF, BIND_SIM, .run = destroy},
    {0}};
