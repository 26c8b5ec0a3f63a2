// Agents in a scene: who leads whom. An entity without a body follows its agent; a body is pushed
// along by it, and says where the agent is.
#include <string.h>

#include "scene/scene_internal.h"

nav_world *scene_nav(scene *s) {
    if (!s->nav) {
        nav_world_desc desc = nav_world_desc_default();
        desc.jobs = s->jobs;
        desc.metrics = s->metrics;
        s->nav = nav_world_create(&desc);
        scene_settings_apply(s, "nav", s->nav);
    }
    return s->nav;
}
nav_world *scene_nav_if(const scene *s) { return s->nav; }

nav_agent scene_entity_agent(const scene *s, scene_entity e) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    return row == CORE_NO_ROW ? CORE_NULL_HANDLE : s->entity.agent[row];
}

scene_entity scene_entity_of_agent(const scene *s, nav_agent agent) {
    if (!s->nav || !nav_agent_alive(s->nav, agent)) {
        return CORE_NULL_HANDLE;
    }
    uint64_t bits = nav_agent_user(s->nav, agent);
    scene_entity e = {(uint32_t)bits, (uint32_t)(bits >> 32)};
    return core_handle_equal(scene_entity_agent(s, e), agent) ? e : CORE_NULL_HANDLE;
}

static bool has_body(const scene *s, uint32_t row) {
    return s->phys && phys_body_alive(s->phys, s->entity.body[row]);
}

static core_vec3 feet(const scene *s, uint32_t row) {
    core_vec3 p = {0, 0, 0};
    scene_position(s, core_columns_handle(&s->entity.set, row), &p);
    p.y -= s->entity.agent_offset[row];
    return p;
}

bool scene_set_agent(scene *s, scene_entity e, nav_agent agent, float offset) {
    uint32_t row = scene_row(s, e);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!s->nav || !nav_agent_alive(s->nav, agent)) {
        return core_fail("scene_set_agent: the agent does not exist");
    }
    if (!(offset - offset == 0.0f)) {
        return core_fail("scene_set_agent: offset is %g m, expected a finite number",
                         (double)offset);
    }
    if (!core_handle_equal(s->entity.agent[row], agent)) {
        scene_nav_leave(s, row);
    }
    s->entity.agent[row] = agent;
    s->entity.agent_offset[row] = offset;
    nav_agent_set_user(s->nav, agent, core_handle_bits(e));
    nav_agent_set_driven(s->nav, agent, has_body(s, row));
    return nav_agent_set_position(s->nav, agent, feet(s, row));
}

bool scene_lead_mover(scene *s, nav_agent agent, phys_mover mover, float offset) {
    if (!s->nav || !nav_agent_alive(s->nav, agent)) {
        return core_fail("scene_lead_mover: the agent does not exist");
    }
    if (!s->phys || !phys_mover_alive(s->phys, mover)) {
        return core_fail("scene_lead_mover: the mover does not exist");
    }
    if (!(offset - offset == 0.0f)) {
        return core_fail("scene_lead_mover: offset is %g m, expected a finite number",
                         (double)offset);
    }
    s->led =
        core_realloc(s->led, s->led_count * sizeof *s->led, (s->led_count + 1) * sizeof *s->led);
    s->led[s->led_count++] = (scene_led){agent, mover, offset};
    return nav_agent_set_driven(s->nav, agent, true);
}

static bool led_alive(const scene *s, const scene_led *l) {
    return s->phys && nav_agent_alive(s->nav, l->agent) && phys_mover_alive(s->phys, l->mover);
}

// Agents are where their movers are.
static void place_led(scene *s) {
    for (uint32_t i = 0; i < s->led_count;) {
        scene_led *l = &s->led[i];
        if (!led_alive(s, l)) {
            s->led[i] = s->led[--s->led_count];
            continue;
        }
        phys_mover_state m;
        phys_mover_read(s->phys, l->mover, &m);
        m.position.y -= l->offset;
        nav_agent_set_position(s->nav, l->agent, m.position);
        i++;
    }
}

static void lead_movers(scene *s) {
    for (uint32_t i = 0; i < s->led_count; i++) {
        core_vec3 v = {0, 0, 0};
        scene_led *l = &s->led[i];
        if (nav_agent_status(s->nav, l->agent) != NAV_AGENT_IDLE) {
            nav_agent_velocity(s->nav, l->agent, &v);
            phys_mover_walk(s->phys, l->mover, core_v3(v.x, 0.0f, v.z));
        }
    }
}

void scene_nav_leave(scene *s, uint32_t row) {
    if (s->nav && nav_agent_alive(s->nav, s->entity.agent[row])) {
        nav_agent_destroy(s->nav, s->entity.agent[row]);
    }
    s->entity.agent[row] = CORE_NULL_HANDLE;
}

// What the script has moved, and what bodies have, since the last step.
static void place_agents(scene *s) {
    for (uint32_t i = 0; i < nav_agent_count(s->nav); i++) {
        nav_agent agent = nav_agent_at(s->nav, i);
        uint32_t row = core_columns_row(&s->entity.set, scene_entity_of_agent(s, agent));
        if (row != CORE_NO_ROW) {
            nav_agent_set_driven(s->nav, agent, has_body(s, row));
            nav_agent_set_position(s->nav, agent, feet(s, row));
        }
    }
}

static void lead(scene *s, uint32_t row, nav_agent agent) {
    core_vec3 v = {0, 0, 0}, p = {0, 0, 0};
    float heading = 0.0f;
    scene_entities *e = &s->entity;
    nav_agent_velocity(s->nav, agent, &v);
    nav_agent_heading(s->nav, agent, &heading);
    if (has_body(s, row)) {
        if (nav_agent_status(s->nav, agent) != NAV_AGENT_IDLE) {
            core_vec3 now;
            phys_body_velocity(s->phys, e->body[row], &now);
            phys_body_set_velocity(s->phys, e->body[row], core_v3(v.x, now.y, v.z));
        }
        return;
    }
    nav_agent_position(s->nav, agent, &p);
    core_quat turn = core_quat_axis_angle((core_vec3){0, 1, 0}, heading);
    e->wpx[row] = p.x, e->wpy[row] = p.y + e->agent_offset[row], e->wpz[row] = p.z;
    e->wqx[row] = turn.x, e->wqy[row] = turn.y, e->wqz[row] = turn.z, e->wqw[row] = turn.w;
    scene_local_from_world(s, row);
    e->changed[row] = s->moves;
}

// ---- bodies in the way ----

#define LARGEST  3.0f // m of radius; what is larger is part of the world
#define LOWEST   0.3f // m of height; what is lower is stepped over
#define ROUNDEST 2.0f // a disc stands for shapes whose sides differ by no more
#define MOVING   0.1f // m/s

static bool is_led(const scene *s, phys_body body) {
    scene_entity e = scene_entity_of_body(s, body);
    return !core_handle_is_null(scene_entity_agent(s, e));
}

// A dynamic body, or a kinematic one that moves, as a disc.
static bool obstacle_of(const scene *s, const phys_shape_view *v, nav_obstacle *out) {
    core_vec3 size = core_v3_sub(v->bounds.max, v->bounds.min), velocity;
    float wide = CORE_MAX(size.x, size.z), narrow = CORE_MIN(size.x, size.z);
    if (v->body_type == PHYS_STATIC || wide > 2.0f * LARGEST || size.y < LOWEST ||
        wide > ROUNDEST * narrow || is_led(s, v->body)) {
        return false;
    }
    phys_body_velocity(s->phys, v->body, &velocity);
    if (v->body_type == PHYS_KINEMATIC && core_v3_dot(velocity, velocity) < MOVING * MOVING) {
        return false;
    }
    core_vec3 middle = core_v3_scale(core_v3_add(v->bounds.min, v->bounds.max), 0.5f);
    *out = (nav_obstacle){{middle.x, v->bounds.min.y, middle.z}, velocity, 0.5f * wide};
    return true;
}

static void find_obstacles(scene *s) {
    uint32_t count = 0, shapes = 0;
    if (s->phys && nav_agent_count(s->nav) && nav_world_minds_bodies(s->nav)) {
        shapes = phys_world_shape_count(s->phys);
    }
    if (shapes > s->obstacle_room) {
        s->obstacle = core_realloc(s->obstacle, s->obstacle_room * sizeof *s->obstacle,
                                   shapes * sizeof *s->obstacle);
        s->obstacle_room = shapes;
    }
    for (uint32_t row = 0; row < shapes; row++) {
        phys_shape_view v;
        count += phys_world_shape(s->phys, row, &v) && obstacle_of(s, &v, &s->obstacle[count]);
    }
    nav_world_set_obstacles(s->nav, s->obstacle, count);
}

void scene_nav_step(scene *s) {
    if (!s->nav) {
        return;
    }
    scene_surfaces_keep_up(s);
    place_agents(s);
    place_led(s);
    find_obstacles(s);
    nav_world_step(s->nav, s->dt);
    for (uint32_t i = 0; i < nav_agent_count(s->nav); i++) {
        nav_agent agent = nav_agent_at(s->nav, i);
        uint32_t row = core_columns_row(&s->entity.set, scene_entity_of_agent(s, agent));
        if (row != CORE_NO_ROW) {
            lead(s, row, agent);
        }
    }
    lead_movers(s);
}

// ---- drawing ----

static void draw_line(void *ctx, nav_line_kind kind, core_vec3 a, core_vec3 b) {
    static const float color[][4] = {
        [NAV_LINE_WALL] = {1.0f, 0.25f, 0.1f, 1.0f}, [NAV_LINE_SEAM] = {0.1f, 0.5f, 0.9f, 0.35f},
        [NAV_LINE_LINK] = {0.1f, 0.8f, 0.7f, 1.0f},  [NAV_LINE_SHUT] = {0.4f, 0.1f, 0.1f, 1.0f},
        [NAV_LINE_PATH] = {1.0f, 0.85f, 0.1f, 1.0f}, [NAV_LINE_SEARCHED] = {0.6f, 0.2f, 0.9f, 0.6f},
        [NAV_LINE_AGENT] = {0.1f, 0.9f, 0.2f, 1.0f}, [NAV_LINE_VELOCITY] = {0.1f, 0.9f, 0.2f, 1.0f},
        [NAV_LINE_WISH] = {0.9f, 0.9f, 0.9f, 0.8f},
    };
    const float lift = 0.05f; // above the ground
    gfx_pen pen = gfx_pen_default();
    memcpy(pen.color, color[kind], sizeof pen.color);
    a.y += lift, b.y += lift;
    gfx_draw_line(scene_gfx(ctx), a, b, &pen);
}

void scene_draw_surface(scene *s, nav_mesh mesh, bool search) {
    nav_world *w = scene_nav(s);
    if (nav_mesh_lines(w, mesh, draw_line, s) && search) {
        nav_mesh_search_lines(w, mesh, draw_line, s);
    }
}
void scene_draw_graph(scene *s, nav_graph graph, bool search) {
    nav_world *w = scene_nav(s);
    if (nav_graph_lines(w, graph, draw_line, s) && search) {
        nav_graph_search_lines(w, graph, draw_line, s);
    }
}
void scene_draw_agents(scene *s) {
    nav_path_lines(scene_nav(s), draw_line, s);
    nav_agent_lines(scene_nav(s), draw_line, s);
}
