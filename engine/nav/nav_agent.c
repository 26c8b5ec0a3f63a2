// Agents: each walks the corners of its path, slows down for turns and the goal, keeps to its
// limits of speed, acceleration and turn.
#include "nav/nav_internal.h"

CORE_COLUMNS_DEFINE(nav_agents, NAV_AGENT_COLUMNS)

#define STUCK_AFTER 2.0f  // s without progress
#define CROWD_AFTER 1.2f  // s, beside others at the goal
#define OFF_WAY     3.0f  // radii from its way, then it is planned anew
#define OFF_PLACE   0.2f  // m by which who has arrived may be pushed aside
#define STEP_HEIGHT 0.5f  // m by which a driven agent may stand off its way
#define SLOW_TURN   0.25f // share of the speed kept through the sharpest corner
#define SLOWEST     0.05f // share of it kept up to the goal
#define CREEP       0.01f // share of it wanted while the target lies behind

const char *nav_agent_state_name(nav_agent_state state) {
    static const char *const names[] = {"idle", "walking", "arrived", "stuck"};
    return (unsigned)state < CORE_COUNT_OF(names) ? names[state] : "unknown";
}

nav_agent_desc nav_agent_desc_default(void) {
    return (nav_agent_desc){.radius = 0.3f,
                            .max_speed = 1.5f,
                            .acceleration = 8.0f,
                            .arrive = 0.1f,
                            .cookie = NAV_AGENT_COOKIE};
}

static bool finite_point(core_vec3 p) {
    return p.x - p.x == 0.0f && p.y - p.y == 0.0f && p.z - p.z == 0.0f;
}

static bool need(const char *field, float value, float low, float high) {
    return (value >= low && value <= high) ||
           core_fail("nav agent: %s is %g, expected %g to %g", field, (double)value, (double)low,
                     (double)high);
}

static uint32_t agent_row(const nav_world *w, nav_agent agent) {
    uint32_t row = core_columns_row(&w->agent.set, agent);
    if (row == CORE_NO_ROW) {
        core_fail("this nav agent does not exist (index %u, generation %u): it is null or was "
                  "destroyed",
                  agent.index, agent.generation);
    }
    return row;
}

nav_agent nav_agent_create(nav_world *w, const nav_agent_desc *given) {
    if (!given || given->cookie != NAV_AGENT_COOKIE) {
        core_fail("nav_agent_create: the description was not made by nav_agent_desc_default()");
        return CORE_NULL_HANDLE;
    }
    nav_agent_desc d = *given, def = nav_agent_desc_default();
    d.radius = d.radius == 0.0f ? def.radius : d.radius;
    d.max_speed = d.max_speed == 0.0f ? def.max_speed : d.max_speed;
    d.acceleration = d.acceleration == 0.0f ? def.acceleration : d.acceleration;
    d.arrive = d.arrive == 0.0f ? def.arrive : d.arrive;
    if (!need("radius (m)", d.radius, 1e-3f, 1e3f) ||
        !need("max_speed (m/s)", d.max_speed, 1e-3f, 1e4f) ||
        !need("acceleration (m/s^2)", d.acceleration, 1e-3f, 1e6f) ||
        !need("turn_rate (rad/s)", d.turn_rate, 0.0f, 1e4f) ||
        !need("arrive (m)", d.arrive, 1e-4f, 1e3f) ||
        !need("heading (rad)", d.heading, -1e4f, 1e4f)) {
        return CORE_NULL_HANDLE;
    }
    if (!finite_point(d.position)) {
        core_fail("nav agent: position (%g, %g, %g), expected finite numbers", (double)d.position.x,
                  (double)d.position.y, (double)d.position.z);
        return CORE_NULL_HANDLE;
    }
    nav_agent agent = core_columns_add(&w->agent.set);
    uint32_t row = core_columns_row(&w->agent.set, agent);
    if (row == CORE_NO_ROW) {
        return agent;
    }
    nav_agents *a = &w->agent;
    float s, c;
    core_sincosf(d.heading, &s, &c);
    a->px[row] = d.position.x, a->py[row] = d.position.y, a->pz[row] = d.position.z;
    a->hx[row] = -s, a->hz[row] = -c; // 0 looks along -Z, turning about +Y
    a->radius[row] = d.radius, a->max_speed[row] = d.max_speed;
    a->acceleration[row] = d.acceleration, a->turn_rate[row] = d.turn_rate;
    a->arrive[row] = d.arrive, a->driven[row] = d.driven;
    a->user[row] = d.user;
    return agent;
}

bool nav_agent_destroy(nav_world *w, nav_agent agent) {
    uint32_t row = agent_row(w, agent);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!core_handle_is_null(w->agent.path[row])) {
        nav_path_destroy(w, w->agent.path[row]);
    }
    return core_columns_remove(&w->agent.set, agent, NULL, NULL);
}

bool nav_agent_alive(const nav_world *w, nav_agent agent) {
    return core_columns_row(&w->agent.set, agent) != CORE_NO_ROW;
}

static core_vec3 place(const nav_agents *a, uint32_t row) {
    return (core_vec3){a->px[row], a->py[row], a->pz[row]};
}
static core_vec3 goal_of(const nav_agents *a, uint32_t row) {
    return (core_vec3){a->gx[row], a->gy[row], a->gz[row]};
}

static void anchor(nav_agents *a, uint32_t row) {
    a->ax[row] = a->px[row], a->ay[row] = a->py[row], a->az[row] = a->pz[row];
    a->stalled[row] = 0.0f;
}

static bool check_goal(core_vec3 goal) {
    return finite_point(goal) ||
           core_fail("nav agent: sent to (%g, %g, %g), expected finite numbers", (double)goal.x,
                     (double)goal.y, (double)goal.z);
}

// Sets out on the path that was just planned.
static bool set_out(nav_world *w, uint32_t row, nav_path path, core_vec3 goal) {
    nav_agents *a = &w->agent;
    if (core_handle_is_null(path)) {
        return false;
    }
    a->path[row] = path;
    w->path.head[core_columns_row(&w->path.set, path)].led = true;
    a->gx[row] = goal.x, a->gy[row] = goal.y, a->gz[row] = goal.z;
    a->plans[row] = 0; // corners are set in the next step
    anchor(a, row);
    a->state[row] = NAV_AGENT_WALKING;
    return true;
}

bool nav_agent_go(nav_world *w, nav_agent agent, nav_graph graph, core_vec3 goal) {
    uint32_t row = agent_row(w, agent);
    if (row == CORE_NO_ROW || nav_graph_row(w, graph) == CORE_NO_ROW || !check_goal(goal)) {
        return false;
    }
    nav_path_head head = {.graph = graph, .start = place(&w->agent, row), .goal = goal};
    return set_out(w, row, nav_path_renew(w, w->agent.path[row], head), goal);
}

static bool cross_mesh(nav_world *w, uint32_t row, nav_path_head head) {
    head.start = place(&w->agent, row);
    nav_path path = nav_path_renew(w, w->agent.path[row], head);
    uint32_t count = nav_path_count(w, path);
    core_vec3 goal = head.goal;
    if (count && nav_path_status(w, path) == NAV_FOUND) {
        nav_path_point(w, path, count - 1, &goal); // on the surface
    }
    return set_out(w, row, path, goal);
}

bool nav_agent_go_on_mesh(nav_world *w, nav_agent agent, nav_mesh mesh, core_vec3 goal) {
    uint32_t row = agent_row(w, agent);
    if (row == CORE_NO_ROW || !check_goal(goal)) {
        return false;
    }
    if (!nav_mesh_alive(w, mesh)) {
        return core_fail("nav agent: the surface to cross does not exist");
    }
    return cross_mesh(w, row, (nav_path_head){.mesh = mesh, .goal = goal});
}

bool nav_agent_go_with_flow(nav_world *w, nav_agent agent, nav_flow flow) {
    uint32_t row = agent_row(w, agent), at = core_columns_row(&w->flow.set, flow);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (at == CORE_NO_ROW || !nav_mesh_alive(w, w->flow.head[at].mesh)) {
        return core_fail("nav agent: the flow to walk with, or its surface, does not exist");
    }
    nav_flow_head f = w->flow.head[at];
    return cross_mesh(w, row, (nav_path_head){.mesh = f.mesh, .goal = f.goal, .flow = flow});
}

bool nav_agent_stop(nav_world *w, nav_agent agent) {
    uint32_t row = agent_row(w, agent);
    if (row != CORE_NO_ROW) {
        w->agent.state[row] = NAV_AGENT_IDLE;
    }
    return row != CORE_NO_ROW;
}

nav_agent_state nav_agent_status(const nav_world *w, nav_agent agent) {
    uint32_t row = agent_row(w, agent);
    return row == CORE_NO_ROW ? NAV_AGENT_IDLE : (nav_agent_state)w->agent.state[row];
}
bool nav_agent_position(const nav_world *w, nav_agent agent, core_vec3 *out) {
    uint32_t row = agent_row(w, agent);
    if (row != CORE_NO_ROW) {
        *out = place(&w->agent, row);
    }
    return row != CORE_NO_ROW;
}
bool nav_agent_set_position(nav_world *w, nav_agent agent, core_vec3 p) {
    uint32_t row = agent_row(w, agent);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!finite_point(p)) {
        return core_fail("nav agent: moved to (%g, %g, %g), expected finite numbers", (double)p.x,
                         (double)p.y, (double)p.z);
    }
    w->agent.px[row] = p.x, w->agent.py[row] = p.y, w->agent.pz[row] = p.z;
    return true;
}
bool nav_agent_velocity(const nav_world *w, nav_agent agent, core_vec3 *out) {
    uint32_t row = agent_row(w, agent);
    if (row != CORE_NO_ROW) {
        *out = (core_vec3){w->agent.vx[row], w->agent.vy[row], w->agent.vz[row]};
    }
    return row != CORE_NO_ROW;
}
bool nav_agent_heading(const nav_world *w, nav_agent agent, float *out) {
    uint32_t row = agent_row(w, agent);
    if (row != CORE_NO_ROW) {
        *out = core_atan2f(-w->agent.hx[row], -w->agent.hz[row]);
    }
    return row != CORE_NO_ROW;
}
bool nav_agent_set_max_speed(nav_world *w, nav_agent agent, float speed) {
    uint32_t row = agent_row(w, agent);
    if (row == CORE_NO_ROW || !need("max_speed (m/s)", speed, 1e-3f, 1e4f)) {
        return false;
    }
    w->agent.max_speed[row] = speed;
    return true;
}
nav_path nav_agent_path(const nav_world *w, nav_agent agent) {
    uint32_t row = agent_row(w, agent);
    return row == CORE_NO_ROW ? CORE_NULL_HANDLE : w->agent.path[row];
}
uint32_t nav_agent_count(const nav_world *w) { return core_columns_count(&w->agent.set); }

nav_agent nav_agent_at(const nav_world *w, uint32_t row) {
    return row < core_columns_count(&w->agent.set) ? core_columns_handle(&w->agent.set, row)
                                                   : CORE_NULL_HANDLE;
}
uint64_t nav_agent_user(const nav_world *w, nav_agent agent) {
    uint32_t row = agent_row(w, agent);
    return row == CORE_NO_ROW ? 0 : w->agent.user[row];
}
bool nav_agent_set_user(nav_world *w, nav_agent agent, uint64_t user) {
    uint32_t row = agent_row(w, agent);
    if (row != CORE_NO_ROW) {
        w->agent.user[row] = user;
    }
    return row != CORE_NO_ROW;
}
bool nav_agent_set_driven(nav_world *w, nav_agent agent, bool driven) {
    uint32_t row = agent_row(w, agent);
    if (row != CORE_NO_ROW) {
        w->agent.driven[row] = driven;
    }
    return row != CORE_NO_ROW;
}

// ---- following ----

// Whether p lies beside the inside of the segment from a to b.
static bool between(core_vec3 a, core_vec3 b, core_vec3 p) {
    core_vec3 way = core_v3_sub(b, a);
    float along = core_v3_dot(core_v3_sub(p, a), way);
    return along > 0.0f && along < core_v3_dot(way, way);
}

// Whether p has passed a towards b: clearly in that direction from a, and not far from it.
static bool passed(core_vec3 a, core_vec3 b, core_vec3 p, float far) {
    core_vec3 from = core_v3_sub(p, a), way = core_v3_sub(b, a);
    float along = core_v3_dot(from, way), square = core_v3_dot(from, from);
    return square < far * far && along > 0.0f &&
           along * along > 0.5f * square * core_v3_dot(way, way);
}

// Corners of a new path. The node nearest to a point may lie behind it: who stands between the
// first two nodes goes to the second, and a goal between the last two is not overshot.
static void take_path(nav_world *w, uint32_t row, uint32_t path) {
    nav_agents *a = &w->agent;
    const nav_path_head *p = &w->path.head[path];
    const core_vec3 *point = w->path.points[path].point;
    a->corner[row] = 0;
    a->corners[row] = p->count;
    a->plans[row] = p->plans;
    if (p->count >= 2) {
        a->corner[row] = between(point[0], point[1], place(a, row));
        if (p->status == NAV_FOUND && !core_handle_is_null(p->mesh)) {
            a->corners[row]--; // its last point is the goal
        } else if (p->status == NAV_FOUND) {
            a->corners[row] -= between(point[p->count - 2], point[p->count - 1], goal_of(a, row));
        }
    }
}

// Point number i of an agent's way: its corners, then the goal (when the path gets there).
static bool way_point(const nav_world *w, uint32_t row, uint32_t path, uint32_t i, core_vec3 *out) {
    const nav_agents *a = &w->agent;
    if (i < a->corners[row]) {
        *out = w->path.points[path].point[i];
        return true;
    }
    *out = goal_of(a, row);
    return i == a->corners[row] && w->path.head[path].status == NAV_FOUND;
}

typedef struct flat { // a vector on the ground
    float x, z;
} flat;
static float flat_length(flat v) { return core_sqrtf(v.x * v.x + v.z * v.z); }

// Speed that lets it brake in time for all that comes: the end of the way, where it stops (short of
// the goal by half of what counts as there, so that it comes to rest on it), and corners, where it
// keeps what the turn allows.
static float speed_for_way(const nav_world *w, uint32_t row, uint32_t path, core_vec3 target,
                           core_vec3 to, float distance) {
    const nav_agents *a = &w->agent;
    float full = a->max_speed[row], brake = 2.0f * a->acceleration[row];
    float limit = full, size = distance;
    for (uint32_t i = a->corner[row] + 1; brake * distance < full * full; i++) {
        core_vec3 next;
        if (!way_point(w, row, path, i, &next)) {
            float left = CORE_MAX(distance - 0.5f * a->arrive[row], 0.0f);
            limit = CORE_MIN(limit, core_sqrtf(brake * left));
            break;
        }
        core_vec3 on = core_v3_sub(next, target);
        float length = core_v3_length(on);
        if (length > 0.0f) {
            float through = full * CORE_MAX(core_v3_dot(on, to) / (length * size), SLOW_TURN);
            limit = CORE_MIN(limit, core_sqrtf(through * through + brake * distance));
            target = next, to = on, size = length;
            distance += length;
        }
    }
    return CORE_MAX(limit, SLOWEST * full);
}

// Who can turn only so fast must be slow enough for a circle through the target: its radius is
// v / rate, and a target at distance d, the angle t off the heading, needs d / (2 sin t).
static float turning_limit(const nav_agents *a, uint32_t row, flat to, float distance) {
    float rate = a->turn_rate[row];
    if (rate == 0.0f || distance <= 0.0f) {
        return a->max_speed[row];
    }
    float ahead = (a->hx[row] * to.x + a->hz[row] * to.z) / distance;
    float aside = (a->hx[row] * to.z - a->hz[row] * to.x) / distance;
    if (ahead <= 0.0f) {
        return CREEP * a->max_speed[row]; // turn first, all but on the spot
    }
    aside = core_absf(aside);
    return aside > 1e-4f ? CORE_MIN(a->max_speed[row], 0.5f * rate * distance / aside)
                         : a->max_speed[row];
}

static void stop(nav_agents *a, uint32_t row) {
    a->wx[row] = a->wz[row] = 0.0f;
    a->slope[row] = a->lift[row] = 0.0f;
}

// Steps over way points that are reached. False when the way has ended.
static bool advance(nav_world *w, uint32_t row, uint32_t path, float dt, core_vec3 *target) {
    nav_agents *a = &w->agent;
    core_vec3 here = place(a, row);
    // Bends of a surface keep half a cell off their corners: nearer the way on is free.
    uint32_t mesh = core_columns_row(&w->mesh.set, w->path.head[path].mesh);
    float slack = mesh == CORE_NO_ROW
                      ? 0.5f * a->radius[row]
                      : CORE_MIN(0.5f * w->mesh.data[mesh]->cell_size, 0.5f * a->radius[row]);
    while (way_point(w, row, path, a->corner[row], target)) {
        core_vec3 next;
        bool last = !way_point(w, row, path, a->corner[row] + 1, &next);
        float v = core_sqrtf(a->vx[row] * a->vx[row] + a->vz[row] * a->vz[row]);
        float near = last ? a->arrive[row] : CORE_MAX(slack, 1.5f * v * dt);
        core_vec3 to = core_v3_sub(*target, here);
        if (a->driven[row] && core_absf(to.y) <= STEP_HEIGHT) {
            to.y = 0.0f; // physics decides how high it stands
        }
        // A crowd may have pushed it past a corner.
        bool beyond = !last && nav_agent_row_link(w, row) == NAV_NO_LINK &&
                      passed(*target, next, here, 4.0f * a->radius[row]);
        if (core_v3_dot(to, to) > near * near && !beyond) {
            return true;
        }
        a->corner[row]++;
    }
    return false;
}

// Progress is to be elsewhere than some time ago: a tenth of what its speed allows, or its radius.
static void note_progress(nav_world *w, uint32_t row, float dt) {
    nav_agents *a = &w->agent;
    core_vec3 moved = {a->px[row] - a->ax[row], a->py[row] - a->ay[row], a->pz[row] - a->az[row]};
    float enough = CORE_MIN(a->radius[row], 0.1f * STUCK_AFTER * a->max_speed[row]);
    if (core_v3_dot(moved, moved) > enough * enough) {
        anchor(a, row);
        a->state[row] = NAV_AGENT_WALKING;
        return;
    }
    a->stalled[row] += dt;
    if (a->stalled[row] >= STUCK_AFTER) {
        a->state[row] = NAV_AGENT_STUCK;
        anchor(a, row);
        nav_path_set(w, a->path[row], place(a, row), goal_of(a, row));
    }
}

// Whether others have pushed it so far from the piece of way it is on that a corner may lie
// between.
static bool off_its_way(const nav_world *w, uint32_t row, uint32_t path) {
    const nav_agents *a = &w->agent;
    const nav_path_head *p = &w->path.head[path];
    uint32_t i = a->corner[row];
    bool walks = a->state[row] == NAV_AGENT_WALKING || a->state[row] == NAV_AGENT_STUCK;
    if (!walks || core_handle_is_null(p->mesh) || p->status != NAV_FOUND || i == 0 ||
        i >= p->count || a->plans[row] != p->plans || nav_agent_row_link(w, row) != NAV_NO_LINK) {
        return false;
    }
    core_vec3 from = w->path.points[path].point[i - 1], to = w->path.points[path].point[i];
    flat way = {to.x - from.x, to.z - from.z};
    flat off = {a->px[row] - from.x, a->pz[row] - from.z};
    float square = way.x * way.x + way.z * way.z;
    float t = square > 0.0f ? (off.x * way.x + off.z * way.z) / square : 0.0f;
    t = CORE_CLAMP(t, 0.0f, 1.0f);
    flat aside = {off.x - t * way.x, off.z - t * way.z};
    return flat_length(aside) > OFF_WAY * a->radius[row];
}

// Plans the ways of those whose ground has changed or who are off their way, from where they are
// now: a fixed number in a step, in turns.
static void plan_anew(nav_world *w) {
    nav_agents *a = &w->agent;
    uint32_t count = core_columns_count(&a->set);
    uint32_t first = w->next_agent < count ? w->next_agent : 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t row = (first + i) % count;
        uint32_t path = core_columns_row(&w->path.set, a->path[row]);
        if (path != CORE_NO_ROW && (nav_path_outdated(w, path) || off_its_way(w, row, path))) {
            w->next_agent = row;
            if (w->plans_left == 0) {
                return;
            }
            w->plans_left--;
            nav_path_set(w, a->path[row], place(a, row), goal_of(a, row));
        }
    }
}

// Brings the path up to date with its ground. False when there is none to walk.
static bool keep_path(nav_world *w, uint32_t row, uint32_t path) {
    nav_agents *a = &w->agent;
    nav_path_head *p = &w->path.head[path];
    nav_path_check(w, path);
    if (a->plans[row] != p->plans) {
        take_path(w, row, path);
    }
    return p->count > 0;
}

// Others may have pushed it off the place at which it arrived: back, slowly, when it is clearly
// off.
static void come_back(nav_agents *a, uint32_t row, float dt) {
    flat to = {a->ax[row] - a->px[row], a->az[row] - a->pz[row]};
    float distance = flat_length(to);
    if (distance > OFF_PLACE) {
        float speed = CORE_MIN(0.5f * a->max_speed[row], distance / dt);
        a->wx[row] = to.x / distance * speed, a->wz[row] = to.z / distance * speed;
    }
}

static void arrive(nav_agents *a, uint32_t row) {
    a->state[row] = NAV_AGENT_ARRIVED;
    anchor(a, row);
}

static bool beside_arrived(const nav_world *w, uint32_t row) {
    const nav_agents *a = &w->agent;
    const nav_crowd *c = &w->crowd;
    for (uint32_t i = 0; i < c->near_count[row]; i++) {
        uint32_t other = c->near[row * NAV_NEIGHBOURS + i];
        flat goals = {a->gx[row] - a->gx[other], a->gz[row] - a->gz[other]};
        flat apart = {a->px[row] - a->px[other], a->pz[row] - a->pz[other]};
        float touch = 1.3f * (a->radius[row] + a->radius[other]);
        bool same = flat_length(goals) <= a->arrive[row] && a->gy[row] == a->gy[other];
        if (a->state[other] == NAV_AGENT_ARRIVED && same && flat_length(apart) < touch) {
            return true;
        }
    }
    return false;
}

// Many go to one place: who stands beside others that have arrived there for some time has arrived,
// too.
static void arrive_in_crowd(nav_world *w, uint32_t row, float dt) {
    nav_agents *a = &w->agent;
    bool walks = a->state[row] == NAV_AGENT_WALKING || a->state[row] == NAV_AGENT_STUCK;
    a->beside[row] = walks && beside_arrived(w, row) ? a->beside[row] + dt : 0.0f;
    if (a->beside[row] > CROWD_AFTER) {
        arrive(a, row);
    }
}

// Velocity wanted: along the way as fast as limits, turns and the goal allow.
static void steer(nav_world *w, uint32_t row, float dt) {
    nav_agents *a = &w->agent;
    stop(a, row);
    uint32_t path = core_columns_row(&w->path.set, a->path[row]);
    if (a->state[row] == NAV_AGENT_ARRIVED) {
        come_back(a, row, dt);
        return;
    }
    bool walks = a->state[row] == NAV_AGENT_WALKING || a->state[row] == NAV_AGENT_STUCK;
    if (!walks || path == CORE_NO_ROW) {
        return;
    }
    core_vec3 target;
    if (!keep_path(w, row, path)) {
        bool waits = w->path.head[path].status == NAV_PENDING;
        a->state[row] = waits ? NAV_AGENT_WALKING : NAV_AGENT_STUCK;
        return;
    }
    if (!advance(w, row, path, dt, &target)) {
        if (w->path.head[path].status == NAV_PENDING) {
            return;
        }
        bool there = w->path.head[path].status == NAV_FOUND;
        a->state[row] = NAV_AGENT_STUCK;
        if (there) {
            arrive(a, row);
        }
        return;
    }
    core_vec3 to3 = core_v3_sub(target, place(a, row));
    flat to = {to3.x, to3.z};
    float ground = flat_length(to), distance = core_v3_length(to3);
    note_progress(w, row, dt);
    if (ground < 1e-3f) { // straight up or down
        float climb = CORE_MIN(a->max_speed[row], core_absf(to3.y) / dt);
        a->lift[row] = to3.y < 0.0f ? -climb : climb;
        return;
    }
    float speed = speed_for_way(w, row, path, target, to3, distance);
    speed = CORE_MIN(speed, turning_limit(a, row, to, ground)) * (ground / distance);
    speed = CORE_MIN(speed, ground / dt);
    a->wx[row] = to.x / ground * speed, a->wz[row] = to.z / ground * speed;
    a->slope[row] = to3.y / ground; // height follows the ground that is covered
}

// ---- moving ----

// Turns the heading towards a direction (unit) by at most `most` radians.
static void turn(nav_agents *a, uint32_t row, flat to, float most) {
    float hx = a->hx[row], hz = a->hz[row];
    float cosine = hx * to.x + hz * to.z, sine = hx * to.z - hz * to.x;
    float s, c;
    core_sincosf(most, &s, &c);
    if (most >= CORE_PI_F || (cosine >= c && cosine > 0.0f)) {
        a->hx[row] = to.x, a->hz[row] = to.z;
        return;
    }
    s = sine < 0.0f ? -s : s;
    float x = hx * c - hz * s, z = hx * s + hz * c, inv = 1.0f / core_sqrtf(x * x + z * z);
    a->hx[row] = x * inv, a->hz[row] = z * inv;
}

// Takes the velocity (nx, nz) as far as acceleration and turn rate allow, and moves.
static void move(nav_agents *a, uint32_t row, float dt) {
    flat want = {a->nx[row], a->nz[row]}, v = {a->vx[row], a->vz[row]};
    float speed = flat_length(want), most = a->acceleration[row] * dt;
    bool moving = speed > 1e-6f;
    flat direction = moving ? (flat){want.x / speed, want.z / speed} : (flat){0, 0};
    if (a->turn_rate[row] > 0.0f) {
        if (moving) {
            turn(a, row, direction, a->turn_rate[row] * dt);
        }
        float now = v.x * a->hx[row] + v.z * a->hz[row];
        float along = want.x * a->hx[row] + want.z * a->hz[row];
        along = CORE_CLAMP(CORE_MAX(along, 0.0f), now - most, now + most);
        v = (flat){a->hx[row] * along, a->hz[row] * along};
    } else {
        flat change = {want.x - v.x, want.z - v.z};
        float size = flat_length(change);
        float part = size > most ? most / size : 1.0f;
        v = (flat){v.x + change.x * part, v.z + change.z * part};
        if (moving) {
            a->hx[row] = direction.x, a->hz[row] = direction.z;
        }
    }
    a->vx[row] = v.x, a->vz[row] = v.z;
    float ground = flat_length(v), climb = a->lift[row] + a->slope[row] * ground;
    float room =
        core_sqrtf(CORE_MAX(a->max_speed[row] * a->max_speed[row] - ground * ground, 0.0f));
    a->vy[row] = CORE_CLAMP(climb, -room, room);
    if (!a->driven[row]) {
        a->px[row] += v.x * dt, a->py[row] += a->vy[row] * dt, a->pz[row] += v.z * dt;
    }
}

uint32_t nav_agent_row_link(const nav_world *w, uint32_t row) {
    const nav_agents *a = &w->agent;
    uint32_t path = core_columns_row(&w->path.set, a->path[row]);
    if (path == CORE_NO_ROW || a->state[row] != NAV_AGENT_WALKING || a->corner[row] == 0 ||
        a->corner[row] > w->path.head[path].count || core_handle_is_null(w->path.head[path].mesh)) {
        return NAV_NO_LINK;
    }
    return w->path.points[path].node[a->corner[row] - 1];
}

uint32_t nav_agent_link(const nav_world *w, nav_agent agent) {
    uint32_t row = agent_row(w, agent);
    return row == CORE_NO_ROW ? NAV_NO_LINK : nav_agent_row_link(w, row);
}

// Who crosses a surface stays on it, whatever others push: at its border it slides along, and its
// height is the ground's. Links lead off it.
void nav_agent_keep_on_surface(nav_world *w, uint32_t row) {
    nav_agents *a = &w->agent;
    if (nav_agent_row_link(w, row) != NAV_NO_LINK) {
        return;
    }
    uint32_t path = core_columns_row(&w->path.set, a->path[row]);
    core_vec3 p = place(a, row);
    if (path != CORE_NO_ROW && !a->driven[row] && nav_mesh_hold(w, w->path.head[path].mesh, &p)) {
        a->px[row] = p.x, a->py[row] = p.y, a->pz[row] = p.z;
    }
}

void nav_agents_step(nav_world *w, float dt) {
    nav_agents *a = &w->agent;
    uint32_t count = core_columns_count(&a->set);
    plan_anew(w);
    for (uint32_t row = 0; row < count; row++) {
        steer(w, row, dt);
    }
    for (uint32_t row = 0; w->no_avoidance && row < count; row++) {
        a->nx[row] = a->wx[row], a->nz[row] = a->wz[row];
    }
    if (!w->no_avoidance && count) {
        float radius = 0.0f;
        for (uint32_t row = 0; row < count; row++) {
            radius = CORE_MAX(radius, a->radius[row]);
        }
        nav_gates_step(w, radius, dt);
        nav_crowd_avoid(w, dt);
    }
    for (uint32_t row = 0; row < count; row++) {
        move(a, row, dt);
        nav_agent_keep_on_surface(w, row);
    }
    if (!w->no_avoidance && count) {
        nav_crowd_part(w);
    }
    for (uint32_t row = 0; !w->no_avoidance && row < count; row++) {
        arrive_in_crowd(w, row, dt);
    }
}
