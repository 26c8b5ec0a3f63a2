// Searches across surfaces in pieces: where "slice" is set, paths wait for their turn, and a step
// expands so many views in all. What is expanded when does not depend on time.
#include "nav/nav_internal.h"

static bool next_waiting(nav_world *w) {
    uint32_t count = core_columns_count(&w->path.set);
    uint32_t first = w->next_slice < count ? w->next_slice : 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t row = (first + i) % count;
        if (w->path.head[row].status == NAV_PENDING) {
            w->slice.path = core_columns_handle(&w->path.set, row);
            w->next_slice = row + 1;
            return true;
        }
    }
    w->slice.path = CORE_NULL_HANDLE;
    return false;
}

// False: the path needs no search in pieces, and has been planned.
static bool begin(nav_world *w, uint32_t row) {
    nav_slice *s = &w->slice;
    const nav_path_head *p = &w->path.head[row];
    nav_mesh_query query = nav_mesh_query_default();
    query.start = p->start, query.goal = p->goal;
    s->mesh = core_columns_row(&w->mesh.set, p->mesh);
    nav_mesh_data *m = w->mesh.data[s->mesh];
    s->version = w->mesh.head[s->mesh].version;
    nav_mesh_find_components(m, s->version);
    const uint32_t *component = m->polygon.component, *polygon = m->span.polygon;
    if (!nav_mesh_is_plain(m) || !nav_mesh_ends(m, &query, &s->ends) ||
        component[polygon[s->ends.start.span]] != component[polygon[s->ends.goal.span]]) {
        nav_path_plan_now(w, row);
        return false;
    }
    s->search = (nav_any_angle){.mesh = m,
                                .scratch = &s->views,
                                .goal = s->ends.goal.at,
                                .goal_polygon = polygon[s->ends.goal.span]};
    nav_mesh_any_angle_begin(&s->search, s->ends.start.at, polygon[s->ends.start.span]);
    return true;
}

static bool still_good(const nav_world *w, uint32_t row) {
    const nav_slice *s = &w->slice;
    const nav_path_head *p = &w->path.head[row];
    uint32_t mesh = core_columns_row(&w->mesh.set, p->mesh);
    return mesh == s->mesh && w->mesh.head[mesh].version == s->version &&
           w->mesh.data[mesh] == s->search.mesh;
}

void nav_slices_step(nav_world *w) {
    nav_slice *s = &w->slice;
    uint32_t left = w->slice_budget;
    while (left) {
        uint32_t row = core_columns_row(&w->path.set, s->path);
        bool waits = row != CORE_NO_ROW && w->path.head[row].status == NAV_PENDING;
        if (!waits || !s->search.mesh || !still_good(w, row)) {
            if (!waits && !next_waiting(w)) {
                return;
            }
            row = core_columns_row(&w->path.set, s->path);
            s->search.mesh = NULL;
            nav_path_check(w, row);
            if (w->path.head[row].status != NAV_PENDING || !begin(w, row)) {
                continue;
            }
        }
        uint32_t before = s->search.expanded;
        nav_progress progress = nav_mesh_any_angle_run(&s->search, left);
        left -= CORE_MIN(left, CORE_MAX(s->search.expanded - before, 1u));
        if (progress != NAV_GOES_ON) {
            nav_path_found(w, row, progress == NAV_IS_FOUND ? &s->search : NULL, &s->ends);
            s->search.mesh = NULL;
        }
    }
}
