// Walkable surfaces as objects: making them from a flat map, finding points on them, searching
// them.
#include <string.h>

#include "core/hash.h"
#include "nav/nav_field.h"

CORE_COLUMNS_DEFINE(nav_meshes, NAV_MESH_COLUMNS)

#define NAV_MESH_COOKIE 0x4e41560fu
#define MOST_FLAT_CELLS (1u << 26)

nav_mesh nav_mesh_adopt(nav_world *w, nav_mesh_data *m, uint64_t content) {
    nav_mesh handle = core_columns_add(&w->mesh.set);
    uint32_t row = core_columns_row(&w->mesh.set, handle);
    if (row == CORE_NO_ROW) {
        nav_mesh_free(m);
        return handle;
    }
    w->mesh.data[row] = m;
    w->mesh.head[row].content = content;
    return handle;
}

void nav_spans_release(nav_spans *s) {
    core_free(s->cell);
    core_free(s->x);
    core_free(s->z);
    core_free(s->y);
    core_free(s->link);
    *s = (nav_spans){0};
}

void nav_mesh_free(nav_mesh_data *m) {
    nav_spans_release(&m->span);
    core_free(m->polygon);
    core_free(m->edge_first);
    core_free(m->edge);
    core_free(m->turn_y);
    core_free(m->turn_closed);
    core_free(m);
}

void nav_spans_make(nav_spans *s, uint32_t width, uint32_t depth, uint32_t count) {
    s->width = width, s->depth = depth, s->count = count;
    s->cell = core_alloc(((size_t)width * depth + 1) * sizeof *s->cell);
    s->x = core_alloc((count + 1) * sizeof *s->x);
    s->z = core_alloc((count + 1) * sizeof *s->z);
    s->y = core_alloc((count + 1) * sizeof *s->y);
    s->link = core_alloc((count + 1) * sizeof *s->link);
}

static void link_flat(nav_spans *s) {
    static const int32_t dx[4] = {1, 0, -1, 0}, dz[4] = {0, 1, 0, -1};
    for (uint32_t i = 0; i < s->count; i++) {
        for (int d = 0; d < 4; d++) {
            uint32_t x = s->x[i] + (uint32_t)dx[d], z = s->z[i] + (uint32_t)dz[d];
            bool inside = x < s->width && z < s->depth;
            size_t cell = (size_t)z * s->width + x;
            bool open = inside && s->cell[cell + 1] > s->cell[cell];
            s->link[i][d] = open ? s->cell[cell] : NAV_NONE;
        }
    }
}

nav_mesh nav_mesh_from_cells(nav_world *w, uint32_t width, uint32_t height, const uint8_t *blocked,
                             float cell_size) {
    if (width - 1 >= NAV_GRID_MOST || height - 1 >= NAV_GRID_MOST ||
        (uint64_t)width * height > MOST_FLAT_CELLS || !(cell_size > 0.0f && cell_size <= 1e6f)) {
        core_fail(
            "nav_mesh_from_cells: %u by %u cells of %g m, expected 1 to %u along a side and a "
            "size > 0",
            width, height, (double)cell_size, NAV_GRID_MOST);
        return CORE_NULL_HANDLE;
    }
    uint32_t cells = width * height, count = 0;
    for (uint32_t i = 0; i < cells; i++) {
        count += !blocked || !blocked[i];
    }
    nav_mesh_data *m = core_alloc(sizeof *m);
    nav_spans_make(&m->span, width, height, count);
    m->cell_size = cell_size;
    count = 0;
    for (uint32_t i = 0; i < cells; i++) {
        m->span.cell[i] = count;
        if (!blocked || !blocked[i]) {
            m->span.x[count] = i % width;
            m->span.z[count++] = i / width;
        }
    }
    m->span.cell[cells] = count;
    link_flat(&m->span);
    nav_mesh_assemble(m);
    return nav_mesh_adopt(w, m, core_hash(m->span.cell, (cells + 1) * sizeof(uint32_t), width));
}

nav_mesh_desc nav_mesh_desc_default(void) {
    return (nav_mesh_desc){.cell_size = 0.3f,
                           .agent_radius = 0.3f,
                           .agent_height = 1.8f,
                           .max_climb = 0.4f,
                           .max_slope = 0.79f,
                           .cookie = NAV_MESH_COOKIE};
}

static bool need(const char *field, float value, float low, float high) {
    return (value >= low && value <= high) ||
           core_fail("nav_mesh_build: %s is %g, expected %g to %g", field, (double)value,
                     (double)low, (double)high);
}

static bool check(nav_mesh_desc *d) {
    nav_mesh_desc def = nav_mesh_desc_default();
    d->cell_size = d->cell_size == 0.0f ? def.cell_size : d->cell_size;
    d->agent_height = d->agent_height == 0.0f ? def.agent_height : d->agent_height;
    d->max_slope = d->max_slope == 0.0f ? def.max_slope : d->max_slope;
    return need("cell_size (m)", d->cell_size, 1e-3f, 1e3f) &&
           need("agent_radius (m)", d->agent_radius, 0.0f, 100.0f * d->cell_size) &&
           need("agent_height (m)", d->agent_height, 1e-3f, 1e3f) &&
           need("max_climb (m)", d->max_climb, 0.0f, d->agent_height) &&
           need("max_slope (rad)", d->max_slope, 1e-3f, 1.5f);
}

nav_mesh nav_mesh_build(nav_world *w, const core_soup_data *soup, const nav_mesh_desc *given) {
    if (!given || given->cookie != NAV_MESH_COOKIE) {
        core_fail("nav_mesh_build: the description was not made by nav_mesh_desc_default()");
        return CORE_NULL_HANDLE;
    }
    nav_mesh_desc desc = *given;
    nav_field field;
    if (!soup || !check(&desc) || !nav_field_make(&field, soup, desc.cell_size, desc.max_slope)) {
        return CORE_NULL_HANDLE;
    }
    nav_mesh_data *m = core_alloc(sizeof *m);
    nav_field_spans(&field, &desc, &m->span);
    m->origin = field.origin;
    m->cell_size = field.cell_size;
    nav_field_release(&field);
    nav_mesh_assemble(m);
    uint64_t content = core_hash(m->span.y, m->span.count * sizeof *m->span.y, m->span.width);
    content = core_hash_mix(
        content, core_hash(m->span.link, m->span.count * sizeof *m->span.link, m->span.depth));
    return nav_mesh_adopt(w, m, content);
}

static nav_mesh_data *find(const nav_world *w, nav_mesh mesh) {
    uint32_t row = core_columns_row(&w->mesh.set, mesh);
    if (row == CORE_NO_ROW) {
        core_fail("this nav mesh does not exist (index %u, generation %u): it is null or was "
                  "destroyed",
                  mesh.index, mesh.generation);
        return NULL;
    }
    return w->mesh.data[row];
}

bool nav_mesh_destroy(nav_world *w, nav_mesh mesh) {
    nav_mesh_data *m = find(w, mesh);
    if (!m) {
        return false;
    }
    nav_mesh_free(m);
    return core_columns_remove(&w->mesh.set, mesh, NULL, NULL);
}
bool nav_mesh_alive(const nav_world *w, nav_mesh mesh) {
    return core_columns_row(&w->mesh.set, mesh) != CORE_NO_ROW;
}
uint32_t nav_mesh_polygons(const nav_world *w, nav_mesh mesh) {
    const nav_mesh_data *m = find(w, mesh);
    return m ? m->polygon_count : 0;
}
double nav_mesh_area(const nav_world *w, nav_mesh mesh) {
    const nav_mesh_data *m = find(w, mesh);
    return m ? m->span.count * (double)m->cell_size * (double)m->cell_size : 0.0;
}

// ---- points on the surface ----

typedef struct place {
    uint32_t span; // NAV_NONE: none
    nav_point at;  // in cells, within the span's cell
    double square; // of the distance moved sideways, cells
    double height; // moved up or down, m
} place;

static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

// Points keep a little off the borders of their cell: on a border or corner it would be open which
// polygon they belong to.
static void consider(const nav_mesh_data *m, int64_t x, int64_t z, nav_point p, double y,
                     place *best) {
    if (x < 0 || z < 0 || x >= m->span.width || z >= m->span.depth) {
        return;
    }
    size_t cell = (size_t)z * m->span.width + (size_t)x;
    const double inset = 1e-4;
    nav_point at = {clamp(p.x, (double)x + inset, (double)x + 1 - inset),
                    clamp(p.z, (double)z + inset, (double)z + 1 - inset)};
    double dx = at.x - p.x, dz = at.z - p.z, square = dx * dx + dz * dz;
    for (uint32_t s = m->span.cell[cell]; s < m->span.cell[cell + 1]; s++) {
        double height = y - (double)m->span.y[s];
        height = height < 0.0 ? -height : height;
        bool nearer = square < best->square - 1e-3 ||
                      (square <= best->square + 1e-3 && height < best->height);
        if (best->span == NAV_NONE || nearer) {
            *best = (place){s, at, square, height};
        }
    }
}

static place locate(const nav_mesh_data *m, core_vec3 p, double reach) {
    double size = (double)m->cell_size;
    nav_point at = {((double)p.x - m->origin.x) / size, ((double)p.z - m->origin.z) / size};
    place best = {.span = NAV_NONE};
    if (!(at.x > -1e6 && at.x < 1e6 && at.z > -1e6 && at.z < 1e6) || p.y - p.y != 0.0f) {
        return best;
    }
    int64_t x = (int64_t)core_floor(at.x), z = (int64_t)core_floor(at.z);
    int64_t most = (int64_t)CORE_MIN(core_ceil(reach), (double)(m->span.width + m->span.depth));
    for (int64_t ring = 0; ring <= most; ring++) {
        for (int64_t dx = -ring; dx <= ring; dx++) {
            bool edge = dx == -ring || dx == ring;
            for (int64_t dz = -ring; dz <= ring; dz += edge || ring == 0 ? 1 : 2 * ring) {
                consider(m, x + dx, z + dz, at, (double)p.y, &best);
            }
        }
        if (best.span != NAV_NONE && best.square <= (double)(ring * ring)) {
            break; // cells of further rings are further away
        }
    }
    if (best.span != NAV_NONE && best.square > reach * reach + 1e-3) {
        best.span = NAV_NONE;
    }
    return best;
}

static core_vec3 world_point(const nav_mesh_data *m, nav_point p, float y) {
    return (core_vec3){(float)(m->origin.x + p.x * (double)m->cell_size), y,
                       (float)(m->origin.z + p.z * (double)m->cell_size)};
}

bool nav_mesh_nearest(const nav_world *w, nav_mesh mesh, core_vec3 p, float max_distance,
                      core_vec3 *out) {
    const nav_mesh_data *m = find(w, mesh);
    if (!m) {
        return false;
    }
    double reach = max_distance > 0.0f ? (double)max_distance / (double)m->cell_size : 1e6;
    place found = locate(m, p, reach);
    if (found.span != NAV_NONE) {
        *out = world_point(m, found.at, m->span.y[found.span]);
    }
    return found.span != NAV_NONE;
}

bool nav_mesh_hold(const nav_world *w, nav_mesh mesh, core_vec3 *p) {
    uint32_t row = core_columns_row(&w->mesh.set, mesh);
    if (row == CORE_NO_ROW) {
        return false;
    }
    const nav_mesh_data *m = w->mesh.data[row];
    place found = locate(m, *p, 2.0);
    if (found.span != NAV_NONE) {
        *p = found.square > 0.0 ? world_point(m, found.at, m->span.y[found.span])
                                : (core_vec3){p->x, m->span.y[found.span], p->z};
    }
    return found.span != NAV_NONE;
}

void nav_mesh_room(const nav_world *w, nav_mesh mesh, core_vec3 p, float range, float out[4]) {
    uint32_t row = core_columns_row(&w->mesh.set, mesh);
    for (int d = 0; d < 4; d++) {
        out[d] = __FLT_MAX__;
    }
    const nav_mesh_data *m = row == CORE_NO_ROW ? NULL : w->mesh.data[row];
    place at = m ? locate(m, p, 2.0) : (place){.span = NAV_NONE};
    if (at.span == NAV_NONE) {
        return;
    }
    double fx = at.at.x - m->span.x[at.span], fz = at.at.z - m->span.z[at.span];
    const double ahead[4] = {1.0 - fx, 1.0 - fz, fx, fz};
    for (int d = 0; d < 4; d++) {
        double cells = ahead[d];
        uint32_t span = m->span.link[at.span][d];
        while (span != NAV_NONE && cells * (double)m->cell_size < (double)range) {
            span = m->span.link[span][d];
            cells += 1.0;
        }
        if (span == NAV_NONE) {
            out[d] = (float)(cells * (double)m->cell_size);
        }
    }
}

// ---- search ----

static bool same(nav_point a, nav_point b) { return a.x == b.x && a.z == b.z; }

// A bend, moved away from the closed cell that it goes round by so many cells along both axes.
static nav_point clear_of_corner(const nav_mesh_data *m, const nav_view *v, double cells) {
    static const double dir_x[4] = {1, 0, -1, 0}, dir_z[4] = {0, 1, 0, -1};
    int a = m->turn_closed[v->root_turn], b = (a + 1) % 4;
    return (nav_point){v->root.x - cells * (dir_x[a] + dir_x[b]),
                       v->root.z - cells * (dir_z[a] + dir_z[b])};
}

// Start, bends and goal from the chain of views. Two passes: the chain is read from its end.
static void write_way(const nav_world *w, const nav_mesh_data *m, uint32_t last, place start,
                      place goal, double clearance, nav_result *result, core_vec3 *out,
                      uint32_t capacity) {
    const nav_view *view = w->views.view;
    uint32_t count = 2;
    nav_point bend = start.at;
    for (uint32_t v = last; v != NAV_NONE; v = view[v].parent) {
        count += !same(view[v].root, bend) && view[v].root_turn != NAV_NONE;
        bend = view[v].root;
    }
    result->count = count;
    uint32_t i = count - 1;
    if (out && i < capacity) {
        out[i] = world_point(m, goal.at, m->span.y[goal.span]);
    }
    bend = start.at;
    for (uint32_t v = last; v != NAV_NONE; v = view[v].parent) {
        if (!same(view[v].root, bend) && view[v].root_turn != NAV_NONE && --i < capacity && out) {
            out[i] = world_point(m, clear_of_corner(m, &view[v], clearance),
                                 m->turn_y[view[v].root_turn]);
        }
        bend = view[v].root;
    }
    if (out && capacity > 0) {
        out[0] = world_point(m, start.at, m->span.y[start.span]);
    }
}

bool nav_mesh_way(nav_world *w, nav_mesh mesh, core_vec3 from, core_vec3 to, double clearance,
                  nav_result *result, core_vec3 *out, uint32_t capacity) {
    *result = (nav_result){.status = NAV_INVALID, .reached = NAV_NO_NODE};
    const nav_mesh_data *m = find(w, mesh);
    if (!m) {
        return false;
    }
    place start = locate(m, from, 2.0), goal = locate(m, to, 2.0);
    result->status = NAV_NO_PATH;
    if (start.span == NAV_NONE || goal.span == NAV_NONE) {
        return true;
    }
    uint32_t last = nav_mesh_any_angle(m, &w->views, start.at, m->polygon[start.span], goal.at,
                                       m->polygon[goal.span], &result->expanded);
    if (last != NAV_NONE) {
        const nav_view *v = &w->views.view[last];
        double dx = goal.at.x - v->root.x, dz = goal.at.z - v->root.z;
        result->status = NAV_FOUND;
        result->cost = (v->g + core_sqrt(dx * dx + dz * dz)) * (double)m->cell_size;
        result->reached = m->polygon[goal.span];
        write_way(w, m, last, start, goal, clearance, result, out, capacity);
    }
    return true;
}

bool nav_mesh_search(nav_world *w, nav_mesh mesh, core_vec3 from, core_vec3 to, nav_result *result,
                     core_vec3 *out, uint32_t capacity) {
    return nav_mesh_way(w, mesh, from, to, 0.0, result, out, capacity);
}
