// Many ways to one goal: a flood of views from the goal (the search of nav_any_angle.c without an
// aim) is kept by polygon. From any point the shortest of the views into its polygon gives the
// exact way: its root is the first corner, its parents are the next ones.
#include <math.h>
#include <string.h>

#include "nav/nav_internal.h"

CORE_COLUMNS_DEFINE(nav_flows, NAV_FLOW_COLUMNS)

#define REACH 2.0 // cells by which ends may be off the surface

static uint32_t flow_row(const nav_world *w, nav_flow flow) {
    uint32_t row = core_columns_row(&w->flow.set, flow);
    if (row == CORE_NO_ROW) {
        core_fail("this nav flow does not exist (index %u, generation %u): it is null or was "
                  "destroyed",
                  flow.index, flow.generation);
    }
    return row;
}

nav_flow nav_flow_create(nav_world *w, nav_mesh mesh, core_vec3 goal) {
    uint32_t row;
    if (!nav_mesh_find(w, mesh, &row)) {
        return CORE_NULL_HANDLE;
    }
    if (!(goal.x - goal.x == 0.0f && goal.y - goal.y == 0.0f && goal.z - goal.z == 0.0f)) {
        core_fail("nav flow: to (%g, %g, %g), expected finite numbers", (double)goal.x,
                  (double)goal.y, (double)goal.z);
        return CORE_NULL_HANDLE;
    }
    nav_flow flow = core_columns_add(&w->flow.set);
    row = core_columns_row(&w->flow.set, flow);
    if (row != CORE_NO_ROW) {
        w->flow.head[row] = (nav_flow_head){.mesh = mesh, .goal = goal};
        w->flow.data[row] = core_alloc(sizeof *w->flow.data[row]);
    }
    return flow;
}

void nav_flow_release(nav_flow_data *f) {
    core_free(f->views.data);
    core_free(f->first.data);
    core_free(f->next.data);
    core_free(f);
}

bool nav_flow_destroy(nav_world *w, nav_flow flow) {
    uint32_t row = flow_row(w, flow);
    if (row == CORE_NO_ROW) {
        return false;
    }
    nav_flow_release(w->flow.data[row]);
    return core_columns_remove(&w->flow.set, flow, NULL, NULL);
}
bool nav_flow_alive(const nav_world *w, nav_flow flow) {
    return core_columns_row(&w->flow.set, flow) != CORE_NO_ROW;
}

// ---- the flood ----

static void fill(nav_world *w, const nav_mesh_data *m, nav_flow_data *f, core_vec3 goal) {
    f->count = 0;
    f->goal = nav_mesh_locate(m, goal, REACH);
    uint32_t *first = nav_buffer_fit(&f->first, (m->polygon.room + 1) * sizeof *first);
    memset(first, 0xff, m->polygon.room * sizeof *first);
    if (f->goal.span == NAV_NONE) {
        return;
    }
    nav_mesh_flood(m, &w->views, f->goal.at, m->span.polygon[f->goal.span]);
    f->count = w->views.count;
    nav_view *view = nav_buffer_fit(&f->views, ((size_t)f->count + 1) * sizeof *view);
    uint32_t *next = nav_buffer_fit(&f->next, ((size_t)f->count + 1) * sizeof *next);
    if (f->count > 0) {
        memcpy(view, w->views.view, f->count * sizeof *view);
    }
    for (uint32_t i = f->count; i-- > 0;) { // nearest first
        next[i] = first[view[i].polygon];
        first[view[i].polygon] = i;
    }
}

static nav_flow_data *refresh(nav_world *w, uint32_t row, const nav_mesh_data **mesh) {
    uint32_t at = core_columns_row(&w->mesh.set, w->flow.head[row].mesh);
    nav_flow_data *f = w->flow.data[row];
    if (at == CORE_NO_ROW) {
        core_fail("nav flow: its surface was destroyed");
        return NULL;
    }
    *mesh = w->mesh.data[at];
    if (f->version != w->mesh.head[at].version + 1) {
        f->version = w->mesh.head[at].version + 1;
        fill(w, *mesh, f, w->flow.head[row].goal);
    }
    return f;
}

// ---- ways ----

typedef struct entry { // how the way leaves a point's polygon
    double length;     // in cells, INFINITY: no way
    uint32_t view;     // NAV_NONE: straight to the goal
    uint32_t turn;     // at which it bends before the view's root, NAV_NONE
    nav_point bend;
} entry;

static entry best_entry(const nav_mesh_data *m, const nav_flow_data *f, nav_place at) {
    entry best = {.length = (double)INFINITY, .view = NAV_NONE, .turn = NAV_NONE};
    uint32_t polygon = m->span.polygon[at.span];
    if (f->goal.span == NAV_NONE) {
        return best;
    }
    if (polygon == m->span.polygon[f->goal.span]) {
        double dx = at.at.x - f->goal.at.x, dz = at.at.z - f->goal.at.z;
        best.length = core_sqrt(dx * dx + dz * dz);
        return best;
    }
    const nav_view *view = f->views.data;
    const uint32_t *next = f->next.data;
    for (uint32_t v = ((const uint32_t *)f->first.data)[polygon]; v != NAV_NONE; v = next[v]) {
        entry e = {.view = v};
        e.length = nav_view_reach(&view[v], at.at, &e.bend, &e.turn);
        best = e.length < best.length ? e : best;
    }
    return best;
}

static void add_turn(nav_world *w, const nav_mesh_data *m, nav_point at, uint32_t turn,
                     double clearance) {
    nav_way_add(&w->way,
                nav_mesh_world_point(m, nav_mesh_clear_of(m, at, turn, clearance), m->turn_y[turn]),
                NAV_NO_LINK);
}

static void write_way(nav_world *w, const nav_mesh_data *m, const nav_flow_data *f, nav_place start,
                      const entry *e, double clearance) {
    const nav_view *view = f->views.data;
    nav_way_add(&w->way, nav_mesh_world_point(m, start.at, m->span.y[start.span]), NAV_NO_LINK);
    if (e->turn != NAV_NONE) {
        add_turn(w, m, e->bend, e->turn, clearance);
    }
    uint32_t last = NAV_NONE;
    for (uint32_t v = e->view; v != NAV_NONE; v = view[v].parent) {
        if (view[v].root_turn != NAV_NONE && view[v].root_turn != last) {
            add_turn(w, m, view[v].root, view[v].root_turn, clearance);
        }
        last = view[v].root_turn;
    }
    nav_way_add(&w->way, nav_mesh_world_point(m, f->goal.at, m->span.y[f->goal.span]), NAV_NO_LINK);
}

bool nav_flow_plan(nav_world *w, nav_flow flow, core_vec3 from, double clearance,
                   nav_result *result) {
    *result = (nav_result){.status = NAV_INVALID, .reached = NAV_NO_NODE};
    w->way.count = 0;
    uint32_t row = flow_row(w, flow);
    const nav_mesh_data *m;
    const nav_flow_data *f = row == CORE_NO_ROW ? NULL : refresh(w, row, &m);
    if (!f) {
        return false;
    }
    nav_place start = nav_mesh_locate(m, from, REACH);
    result->status = NAV_NO_PATH;
    entry e = {.length = (double)INFINITY};
    if (start.span != NAV_NONE) {
        e = best_entry(m, f, start);
    }
    if (e.length < (double)INFINITY) {
        write_way(w, m, f, start, &e, clearance);
        result->status = NAV_FOUND;
        result->cost = e.length * (double)m->cell_size;
        result->count = w->way.count;
        result->reached = m->span.polygon[f->goal.span];
    }
    return true;
}

bool nav_flow_way(nav_world *w, nav_flow flow, core_vec3 from, nav_result *result, core_vec3 *point,
                  uint32_t capacity) {
    if (!nav_flow_plan(w, flow, from, 0.0, result)) {
        return false;
    }
    nav_mesh_last_way(w, point, NULL, capacity);
    return true;
}

bool nav_mesh_search_many(nav_world *w, nav_mesh mesh, const core_vec3 *start, uint32_t count,
                          core_vec3 goal, nav_result *result) {
    nav_flow flow = nav_flow_create(w, mesh, goal);
    bool good = !core_handle_is_null(flow);
    for (uint32_t i = 0; good && i < count; i++) {
        good = nav_flow_plan(w, flow, start[i], 0.0, &result[i]);
    }
    if (!core_handle_is_null(flow)) {
        nav_flow_destroy(w, flow);
    }
    return good;
}
