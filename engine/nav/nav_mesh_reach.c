// What can be reached over the ground: polygons that edges join, and the place nearest to a goal
// among them. Links that leave the surface: jumps, ladders, doors.
#include <string.h>

#include "nav/nav_internal.h"

#define NAV_LINK_COOKIE 0x4e415611u
#define MOST_LINKS      (1u << 20)

static void flood(nav_mesh_data *m, uint32_t first, uint32_t number) {
    nav_polygons *p = &m->polygon;
    uint32_t *stack = m->component_queue.data, open = 0;
    stack[open++] = first;
    p->component[first] = number;
    while (open) {
        uint32_t at = stack[--open];
        for (uint32_t e = p->edges[at].first; e < p->edges[at].end; e++) {
            uint32_t next = m->edge[e].beyond;
            if (next != NAV_NONE && p->component[next] == NAV_NONE) {
                p->component[next] = number;
                stack[open++] = next;
            }
        }
    }
}

void nav_mesh_find_components(nav_mesh_data *m, uint64_t version) {
    if (m->components == version + 1) {
        return;
    }
    m->components = version + 1;
    nav_polygons *p = &m->polygon;
    nav_buffer_fit(&m->component_queue, ((size_t)p->room + 1) * sizeof(uint32_t));
    memset(p->component, 0xff, p->room * sizeof *p->component);
    uint32_t number = 0;
    for (uint32_t t = 0; t < m->tiles_x * m->tiles_z; t++) {
        nav_block own = m->tile[t].polygon;
        for (uint32_t i = own.first; i < own.first + own.count; i++) {
            if (p->component[i] == NAV_NONE) {
                flood(m, i, number++);
            }
        }
    }
}

static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

nav_place nav_mesh_nearest_in(const nav_mesh_data *m, uint32_t polygon, core_vec3 goal) {
    const double inset = 1e-4;
    nav_rectangle r = m->polygon.shape[polygon];
    double x0 = m->span.x[r.span], z0 = m->span.z[r.span], size = (double)m->cell_size;
    double gx = ((double)goal.x - m->origin.x) / size, gz = ((double)goal.z - m->origin.z) / size;
    nav_place at = {.span = r.span,
                    .at = {clamp(gx, x0 + inset, x0 + r.across - inset),
                           clamp(gz, z0 + inset, z0 + r.along - inset)}};
    double dx = at.at.x - gx, dz = at.at.z - gz;
    at.square = dx * dx + dz * dz;
    for (double x = x0 + 1.0; x < at.at.x; x += 1.0) {
        at.span = m->span.link[at.span][0];
    }
    for (double z = z0 + 1.0; z < at.at.z; z += 1.0) {
        at.span = m->span.link[at.span][1];
    }
    double dy = (double)goal.y - (double)m->span.y[at.span];
    at.height = dy < 0.0 ? -dy : dy;
    return at;
}

// Nearest in space; of equals the first towards -z, then -x: not by number, which depends on the
// order in which tiles were made.
static bool nearer(const nav_mesh_data *m, const nav_place *a, const nav_place *b) {
    double up_a = a->height / (double)m->cell_size, up_b = b->height / (double)m->cell_size;
    double da = a->square + up_a * up_a, db = b->square + up_b * up_b;
    if (da != db) {
        return da < db;
    }
    return a->at.z != b->at.z ? a->at.z < b->at.z : a->at.x < b->at.x;
}

nav_place nav_mesh_nearest_joined(const nav_mesh_data *m, nav_place start, core_vec3 goal) {
    uint32_t component = m->polygon.component[m->span.polygon[start.span]];
    nav_place best = start;
    bool any = false;
    for (uint32_t t = 0; t < m->tiles_x * m->tiles_z; t++) {
        nav_block own = m->tile[t].polygon;
        for (uint32_t i = own.first; i < own.first + own.count; i++) {
            if (m->polygon.component[i] == component) {
                nav_place at = nav_mesh_nearest_in(m, i, goal);
                best = !any || nearer(m, &at, &best) ? at : best;
                any = true;
            }
        }
    }
    return best;
}

// ---- links ----

nav_mesh_link_desc nav_mesh_link_desc_default(void) {
    return (nav_mesh_link_desc){.cookie = NAV_LINK_COOKIE};
}

static bool finite_point(core_vec3 p) {
    return core_absf(p.x) <= 1e6f && core_absf(p.y) <= 1e6f && core_absf(p.z) <= 1e6f;
}

void nav_mesh_append_link(nav_mesh_data *m, const nav_mesh_link_desc *d, bool exists) {
    if (m->links == m->link_room) {
        uint32_t wanted = CORE_MAX(m->link_room * 2, 8u);
        m->link = core_realloc(m->link, m->link_room * sizeof *m->link, wanted * sizeof *m->link);
        m->link_room = wanted;
    }
    m->link[m->links++] = (nav_mesh_link){*d, exists};
}

uint32_t nav_mesh_add_link(nav_world *w, nav_mesh mesh, const nav_mesh_link_desc *d) {
    uint32_t row;
    nav_mesh_data *m = nav_mesh_find(w, mesh, &row);
    if (!m) {
        return NAV_NO_LINK;
    }
    if (!d || d->cookie != NAV_LINK_COOKIE) {
        core_fail("nav_mesh_add_link: the description was not made by "
                  "nav_mesh_link_desc_default()");
        return NAV_NO_LINK;
    }
    if (!finite_point(d->start) || !finite_point(d->end) || !(d->cost >= 0.0f && d->cost <= 1e9f) ||
        m->links == MOST_LINKS) {
        core_fail("nav_mesh_add_link: link %u from (%g, %g, %g) to (%g, %g, %g) at a cost of %g; "
                  "expected finite numbers, a cost >= 0 and at most %u links",
                  m->links, (double)d->start.x, (double)d->start.y, (double)d->start.z,
                  (double)d->end.x, (double)d->end.y, (double)d->end.z, (double)d->cost,
                  MOST_LINKS);
        return NAV_NO_LINK;
    }
    nav_mesh_append_link(m, d, true);
    w->mesh.head[row].version++;
    return m->links - 1;
}

static nav_mesh_link *find_link(const nav_world *w, nav_mesh mesh, uint32_t link, uint32_t *row) {
    nav_mesh_data *m = nav_mesh_find(w, mesh, row);
    if (m && (link >= m->links || !m->link[link].exists)) {
        core_fail("this nav mesh has no link %u", link);
        return NULL;
    }
    return m ? &m->link[link] : NULL;
}

bool nav_mesh_remove_link(nav_world *w, nav_mesh mesh, uint32_t link) {
    uint32_t row;
    nav_mesh_link *l = find_link(w, mesh, link, &row);
    if (l) {
        l->exists = false;
        w->mesh.head[row].version++;
    }
    return l != NULL;
}

bool nav_mesh_set_link_open(nav_world *w, nav_mesh mesh, uint32_t link, bool open) {
    uint32_t row;
    nav_mesh_link *l = find_link(w, mesh, link, &row);
    if (l && l->desc.closed == open) {
        l->desc.closed = !open;
        w->mesh.head[row].version++;
    }
    return l != NULL;
}

bool nav_mesh_get_link(const nav_world *w, nav_mesh mesh, uint32_t link, nav_mesh_link_desc *out) {
    uint32_t row;
    const nav_mesh_link *l = find_link(w, mesh, link, &row);
    if (l) {
        *out = l->desc;
    }
    return l != NULL;
}

uint32_t nav_mesh_link_end(const nav_world *w, nav_mesh mesh) {
    uint32_t row;
    const nav_mesh_data *m = nav_mesh_find(w, mesh, &row);
    return m ? m->links : 0;
}

double nav_mesh_link_cost(const nav_mesh_data *m, uint32_t link) {
    const nav_mesh_link_desc *d = &m->link[link].desc;
    return d->cost > 0.0f ? (double)d->cost : (double)core_v3_length(core_v3_sub(d->end, d->start));
}
