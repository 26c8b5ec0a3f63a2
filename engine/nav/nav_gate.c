// Places so narrow that two agents cannot pass: gates. A gate is used in one direction at a time.
// Who comes to it from where the present users came follows them; who comes from elsewhere waits
// beside the way out until the gate is empty. While somebody waits, those who come from the users'
// side are let in for a short time only, so both sides get their turn.
//
// Agents ask in the order of rows, and all that is decided follows from places: no threads, no
// clocks.
#include <string.h>

#include "nav/nav_internal.h"

#define LOOK_AHEAD  2.5f // m of the way within which a gate is asked for
#define LOOK_STEP   0.25f
#define SAME_SIDE   1.5f // m between points of entry that count as one side
#define TURN_TIME   3.0f // s for which a side goes on while the other waits
#define CLEAR_SIDE  1.1f // m beside the way out that those who wait keep free
#define CLEAR_AHEAD 2.5f // m before the gate within which they do
#define NO_GATE     UINT32_MAX

typedef struct flat {
    float x, z;
} flat;

// ---- where gates are ----

// Spans in a row along one axis get the row's length.
static void measure_rows(const nav_mesh_data *m, int forth, int back, uint16_t *length) {
    for (uint32_t t = 0; t < m->tiles_x * m->tiles_z; t++) {
        nav_block own = m->tile[t].span;
        for (uint32_t s = own.first; s < own.first + own.count; s++) {
            if (m->span.link[s][back] != NAV_NONE) {
                continue;
            }
            uint32_t n = 0;
            for (uint32_t at = s; at != NAV_NONE && n < UINT16_MAX; at = m->span.link[at][forth]) {
                n++;
            }
            for (uint32_t at = s, k = 0; k < n; k++, at = m->span.link[at][forth]) {
                length[at] = CORE_MIN(length[at], (uint16_t)n);
            }
        }
    }
}

static void flood(const nav_mesh_data *m, nav_gates *g, uint32_t first, uint32_t gate) {
    uint32_t *stack = g->stack.data, open = 0, *of = g->of_span.data;
    stack[open++] = first;
    of[first] = gate;
    while (open) {
        uint32_t at = stack[--open];
        for (int d = 0; d < 4; d++) {
            uint32_t next = m->span.link[at][d];
            if (next != NAV_NONE && of[next] == NO_GATE - 1) {
                of[next] = gate;
                stack[open++] = next;
            }
        }
    }
}

// Numbers the gates anew when the surface has changed; who is in one asks again.
static bool find_gates(nav_mesh_data *m, uint64_t version, float radius) {
    nav_gates *g = &m->gates;
    if (g->version == version + 1 && g->radius == radius) {
        return false;
    }
    g->version = version + 1;
    g->radius = radius;
    g->count = 0;
    size_t room = (size_t)m->span.room + 1;
    uint16_t *length = nav_buffer_fit(&g->length, room * sizeof *length);
    uint32_t *of = nav_buffer_fit(&g->of_span, room * sizeof *of);
    nav_buffer_fit(&g->stack, room * sizeof *of);
    memset(length, 0xff, room * sizeof *length);
    memset(of, 0xff, room * sizeof *of);
    measure_rows(m, 0, 2, length);
    measure_rows(m, 1, 3, length);
    for (uint32_t t = 0; t < m->tiles_x * m->tiles_z; t++) {
        nav_block own = m->tile[t].span;
        for (uint32_t s = own.first; s < own.first + own.count; s++) {
            bool narrow = (float)length[s] * m->cell_size < 4.0f * radius;
            of[s] = narrow ? NO_GATE - 1 : NO_GATE;
        }
    }
    for (uint32_t t = 0; t < m->tiles_x * m->tiles_z; t++) {
        nav_block own = m->tile[t].span;
        for (uint32_t s = own.first; s < own.first + own.count; s++) {
            if (of[s] == NO_GATE - 1) {
                flood(m, g, s, g->count++);
            }
        }
    }
    nav_gate *gate = nav_buffer_fit(&g->gates, ((size_t)g->count + 1) * sizeof *gate);
    memset(gate, 0, g->count * sizeof *gate);
    return true;
}

// ---- the next gate on an agent's way ----

typedef struct encounter {
    uint32_t gate;
    flat entry; // where the way enters it, or where the agent is in it
    flat axis;  // unit, out of the gate there
    bool inside;
} encounter;

static uint32_t gate_at(const nav_mesh_data *m, core_vec3 p) {
    nav_place at = nav_mesh_locate(m, p, 1.0);
    return at.span == NAV_NONE ? NO_GATE : ((const uint32_t *)m->gates.of_span.data)[at.span];
}

static encounter next_gate(const nav_world *w, const nav_mesh_data *m, uint32_t row,
                           uint32_t path) {
    const nav_agents *a = &w->agent;
    core_vec3 p = {a->px[row], a->py[row], a->pz[row]};
    encounter e = {.gate = gate_at(m, p), .entry = {p.x, p.z}};
    e.inside = e.gate != NO_GATE;
    float left = LOOK_AHEAD;
    const nav_path_head *head = &w->path.head[path];
    for (uint32_t i = a->corner[row]; e.gate == NO_GATE && i < head->count && left > 0.0f; i++) {
        core_vec3 to = w->path.points[path].point[i], way = core_v3_sub(to, p);
        float length = core_v3_length(way);
        for (float t = LOOK_STEP; t < length && left > 0.0f && e.gate == NO_GATE; t += LOOK_STEP) {
            core_vec3 at = core_v3_mad(p, way, t / length);
            e.gate = gate_at(m, at);
            e.entry = (flat){at.x, at.z};
            e.axis = (flat){-way.x / length, -way.z / length};
            left -= LOOK_STEP;
        }
        p = to;
    }
    return e;
}

// ---- turns ----

// Ends of a short gate are near to each other, and look in opposite directions.
static bool same_side(const nav_gate *g, const encounter *e) {
    float dx = e->entry.x - g->entry_x, dz = e->entry.z - g->entry_z;
    return dx * dx + dz * dz < SAME_SIDE * SAME_SIDE &&
           e->axis.x * g->axis_x + e->axis.z * g->axis_z > 0.0f;
}

static bool admits(const nav_gate *g, const encounter *e) {
    bool same = same_side(g, e);
    if (g->users == 0) {
        return !(g->ever && same && g->waited && g->since >= TURN_TIME);
    }
    return same && !(g->waited && g->since >= TURN_TIME);
}

static void take(nav_gate *g, const encounter *e) {
    if (g->users == 0 && !(g->ever && same_side(g, e))) {
        g->entry_x = e->entry.x, g->entry_z = e->entry.z;
        g->axis_x = e->axis.x, g->axis_z = e->axis.z;
        g->since = 0.0f;
    }
    g->ever = true;
    g->users++;
}

// Those who wait leave the way out free: sideways from its axis, a little back.
static void stand_aside(nav_world *w, uint32_t row, const encounter *e) {
    nav_agents *a = &w->agent;
    flat from = {a->px[row] - e->entry.x, a->pz[row] - e->entry.z};
    flat axis = e->axis;
    float ahead = from.x * axis.x + from.z * axis.z;
    float side = from.z * axis.x - from.x * axis.z; // > 0: on the axis' right
    a->wx[row] = a->wz[row] = 0.0f;
    if (ahead > CLEAR_AHEAD || core_absf(side) > CLEAR_SIDE + a->radius[row]) {
        return;
    }
    float turn = side == 0.0f ? (row & 1u ? 1.0f : -1.0f) : side > 0.0f ? 1.0f : -1.0f;
    flat way = {-axis.z * turn + 0.4f * axis.x, axis.x * turn + 0.4f * axis.z};
    float speed = 0.6f * a->max_speed[row] / core_sqrtf(way.x * way.x + way.z * way.z);
    a->wx[row] = way.x * speed, a->wz[row] = way.z * speed;
}

// ---- a step ----

static bool asks(const nav_world *w, uint32_t row, uint32_t *path, uint32_t *mesh) {
    const nav_agents *a = &w->agent;
    *path = core_columns_row(&w->path.set, a->path[row]);
    if (*path == CORE_NO_ROW ||
        (a->state[row] != NAV_AGENT_WALKING && a->state[row] != NAV_AGENT_STUCK)) {
        return false;
    }
    *mesh = core_columns_row(&w->mesh.set, w->path.head[*path].mesh);
    return *mesh != CORE_NO_ROW && w->mesh.data[*mesh]->gates.count > 0;
}

static void prepare(nav_world *w, float radius, float dt) {
    for (uint32_t row = 0; row < core_columns_count(&w->mesh.set); row++) {
        nav_mesh_data *m = w->mesh.data[row];
        uint64_t version = w->mesh.head[row].version;
        if (find_gates(m, version, radius)) {
            for (uint32_t i = 0; i < core_columns_count(&w->agent.set); i++) {
                w->agent.gate[i] = 0;
            }
        }
        nav_gate *gate = m->gates.gates.data;
        for (uint32_t i = 0; i < m->gates.count; i++) {
            gate[i].waited = gate[i].waiting;
            gate[i].waiting = gate[i].users = 0;
            gate[i].since += dt;
        }
    }
}

void nav_gates_step(nav_world *w, float radius, float dt) {
    nav_agents *a = &w->agent;
    uint32_t count = core_columns_count(&a->set), path, mesh;
    prepare(w, radius, dt);
    encounter *met = nav_buffer_fit(&w->encounters, ((size_t)count + 1) * sizeof *met);
    for (uint32_t row = 0; row < count; row++) { // who uses them now
        met[row].gate = NO_GATE;
        if (!asks(w, row, &path, &mesh)) {
            a->gate[row] = 0;
            continue;
        }
        met[row] = next_gate(w, w->mesh.data[mesh], row, path);
        bool holds =
            met[row].gate != NO_GATE && (met[row].inside || a->gate[row] == met[row].gate + 1);
        a->gate[row] = holds ? met[row].gate + 1 : 0;
        if (holds) {
            nav_gate *g = (nav_gate *)w->mesh.data[mesh]->gates.gates.data + met[row].gate;
            g->users++;
        }
    }
    for (uint32_t row = 0; row < count; row++) { // who may come
        if (met[row].gate == NO_GATE || a->gate[row] || !asks(w, row, &path, &mesh)) {
            continue;
        }
        nav_gate *g = (nav_gate *)w->mesh.data[mesh]->gates.gates.data + met[row].gate;
        if (admits(g, &met[row])) {
            take(g, &met[row]);
            a->gate[row] = met[row].gate + 1;
        } else {
            g->waiting += !same_side(g, &met[row]);
            stand_aside(w, row, &met[row]);
            a->stalled[row] = 0.0f;
        }
    }
}
