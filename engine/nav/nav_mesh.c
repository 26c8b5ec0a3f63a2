// Walkable surfaces as objects: making them from triangles and from flat maps.
#include <string.h>

#include "core/hash.h"
#include "nav/nav_internal.h"

CORE_COLUMNS_DEFINE(nav_meshes, NAV_MESH_COLUMNS)

#define NAV_MESH_COOKIE 0x4e41560fu
#define MOST_CELLS      (1u << 26)
#define STEP_TILES      4u

nav_mesh nav_mesh_adopt(nav_world *w, nav_mesh_data *m) {
    nav_mesh handle = core_columns_add(&w->mesh.set);
    uint32_t row = core_columns_row(&w->mesh.set, handle);
    if (row == CORE_NO_ROW) {
        nav_mesh_free(m);
        return handle;
    }
    w->mesh.data[row] = m;
    return handle;
}

void nav_mesh_free(nav_mesh_data *m) {
    for (uint32_t i = 0; i < m->piece_count; i++) {
        nav_piece_free(m->piece[i]);
    }
    if (m->spare) {
        nav_piece_free(m->spare);
    }
    void *own[] = {m->tile,
                   m->piece,
                   m->span.first,
                   m->span.stack,
                   m->span.x,
                   m->span.z,
                   m->span.y,
                   m->span.area,
                   m->span.link,
                   m->span.polygon,
                   m->polygon.shape,
                   m->polygon.edges,
                   m->polygon.component,
                   m->edge,
                   m->turn_y,
                   m->turn_closed,
                   m->component_queue.data,
                   m->gates.of_span.data,
                   m->gates.gates.data,
                   m->gates.length.data,
                   m->gates.stack.data,
                   m->edge_owner,
                   m->link};
    for (size_t i = 0; i < CORE_COUNT_OF(own); i++) {
        core_free(own[i]);
    }
    nav_blocks_release(&m->span.blocks);
    nav_blocks_release(&m->polygon.blocks);
    nav_blocks_release(&m->edge_blocks);
    nav_blocks_release(&m->turn_blocks);
    core_free(m);
}

size_t nav_mesh_bytes(const nav_mesh_data *m) {
    size_t bytes = sizeof *m + (size_t)m->width * m->depth * 6 +
                   (size_t)m->tiles_x * m->tiles_z * sizeof *m->tile +
                   (size_t)m->span.room * (8 * sizeof(uint32_t) + 1) +
                   m->polygon.room * (sizeof(nav_rectangle) + 3 * sizeof(uint32_t)) +
                   m->edge_room * (sizeof(nav_edge) + sizeof(uint32_t)) +
                   m->link_room * sizeof(nav_mesh_link) + m->turn_room * (sizeof(float) + 1);
    for (uint32_t i = 0; i < m->piece_count; i++) {
        const nav_piece *p = m->piece[i];
        bytes += sizeof *p + p->triangles.bytes + p->first.bytes + p->item.bytes;
    }
    return bytes;
}

// ---- from a flat map ----

static void flat_spans(nav_mesh_data *m, const uint8_t *blocked) {
    uint32_t cells = m->width * m->depth, n = 0;
    for (uint32_t i = 0; i < cells; i++) {
        m->span.first[i] = n;
        m->span.stack[i] = !blocked || !blocked[i];
        n += m->span.stack[i];
    }
    nav_mesh_take_spans(m, 0, n);
    n = 0;
    for (uint32_t i = 0; i < cells; i++) {
        if (m->span.stack[i]) {
            m->span.x[n] = i % m->width;
            m->span.z[n++] = i / m->width;
        }
    }
}

static void link_flat(nav_mesh_data *m) {
    static const int32_t dx[4] = {1, 0, -1, 0}, dz[4] = {0, 1, 0, -1};
    nav_spans *s = &m->span;
    for (uint32_t i = 0; i < s->blocks.count; i++) {
        for (int d = 0; d < 4; d++) {
            uint32_t x = s->x[i] + (uint32_t)dx[d], z = s->z[i] + (uint32_t)dz[d];
            bool inside = x < m->width && z < m->depth;
            size_t cell = (size_t)z * m->width + x;
            s->link[i][d] = inside && s->stack[cell] ? s->first[cell] : NAV_NONE;
        }
    }
}

// ---- from triangles ----

nav_mesh_desc nav_mesh_desc_default(void) {
    return (nav_mesh_desc){.cell_size = 0.3f,
                           .agent_radius = 0.3f,
                           .agent_height = 1.8f,
                           .max_climb = 0.4f,
                           .max_slope = 0.79f,
                           .tiles_per_step = STEP_TILES,
                           .cookie = NAV_MESH_COOKIE};
}

static bool need(const char *field, float value, float low, float high) {
    return (value >= low && value <= high) ||
           core_fail("nav_mesh_build: %s is %g, expected %g to %g", field, (double)value,
                     (double)low, (double)high);
}

// A cell is dropped when it is nearer than the radius to one that holds a border: a point of it is
// at most a diagonal further off, and the border a diagonal from where its cell begins.
static float cell_for_error(float error) { return error / (2.0f * 1.41421357f); }

bool nav_mesh_check_desc(nav_mesh_desc *d) {
    nav_mesh_desc def = nav_mesh_desc_default();
    if (d->max_error != 0.0f) {
        if (!need("max_error (m)", d->max_error, 3e-3f, 1e3f)) {
            return false;
        }
        d->cell_size = cell_for_error(d->max_error);
    }
    d->cell_size = d->cell_size == 0.0f ? def.cell_size : d->cell_size;
    d->agent_height = d->agent_height == 0.0f ? def.agent_height : d->agent_height;
    d->max_slope = d->max_slope == 0.0f ? def.max_slope : d->max_slope;
    d->tiles_per_step = d->tiles_per_step ? d->tiles_per_step : STEP_TILES;
    if (d->tile_cells && (d->tile_cells < 8 || d->tile_cells > 1024)) {
        return core_fail("nav_mesh_build: tile_cells is %u, expected 0 or 8 to 1024",
                         d->tile_cells);
    }
    return need("cell_size (m)", d->cell_size, 1e-3f, 1e3f) &&
           need("agent_radius (m)", d->agent_radius, 0.0f, 100.0f * d->cell_size) &&
           need("agent_height (m)", d->agent_height, 1e-3f, 1e3f) &&
           need("max_climb (m)", d->max_climb, 0.0f, d->agent_height) &&
           need("max_slope (rad)", d->max_slope, 1e-3f, 1.5f);
}

nav_mesh nav_mesh_from_cells(nav_world *w, uint32_t width, uint32_t height, const uint8_t *blocked,
                             float cell_size) {
    if (width - 1 >= NAV_GRID_MOST || height - 1 >= NAV_GRID_MOST ||
        (uint64_t)width * height > MOST_CELLS || !(cell_size > 0.0f && cell_size <= 1e6f)) {
        core_fail(
            "nav_mesh_from_cells: %u by %u cells of %g m, expected 1 to %u along a side and a "
            "size > 0",
            width, height, (double)cell_size, NAV_GRID_MOST);
        return CORE_NULL_HANDLE;
    }
    nav_mesh_data *m = core_alloc(sizeof *m);
    m->desc = nav_mesh_desc_default();
    m->desc.agent_radius = 0.0f;
    m->cell_size = m->desc.cell_size = cell_size;
    m->width = width, m->depth = height;
    m->tile_cells = CORE_MAX(width, height);
    nav_mesh_lay_out(m);
    flat_spans(m, blocked);
    link_flat(m);
    m->tile[0].fresh = true;
    nav_mesh mesh = nav_mesh_adopt(w, m);
    if (!core_handle_is_null(mesh)) {
        nav_mesh_settle(w, core_columns_row(&w->mesh.set, mesh));
    }
    return mesh;
}

static core_aabb bounds_of(const core_soup_data *soup) {
    core_aabb b = {{__FLT_MAX__, 0, __FLT_MAX__}, {-__FLT_MAX__, 0, -__FLT_MAX__}};
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        const float *p = soup->position + 3 * (size_t)v;
        b.min.x = CORE_MIN(b.min.x, p[0]), b.max.x = CORE_MAX(b.max.x, p[0]);
        b.min.z = CORE_MIN(b.min.z, p[2]), b.max.z = CORE_MAX(b.max.z, p[2]);
    }
    return soup->vertex_count ? b : (core_aabb){{0, 0, 0}, {0, 0, 0}};
}

// Size in cells. False + core_fail for bounds that are no numbers or too far apart.
bool nav_mesh_measure(nav_mesh_data *m, core_aabb b) {
    double width = ((double)b.max.x - (double)b.min.x) / (double)m->cell_size + 1.0;
    double depth = ((double)b.max.z - (double)b.min.z) / (double)m->cell_size + 1.0;
    if (!(width >= 1.0 && depth >= 1.0 && width * depth <= MOST_CELLS && b.min.x >= -1e6f &&
          b.min.z >= -1e6f && b.max.x <= 1e6f && b.max.z <= 1e6f)) {
        return core_fail("nav_mesh_build: %.0f by %.0f cells of %g m, expected at most %u in all, "
                         "within a million metres; use larger cells",
                         width, depth, (double)m->cell_size, MOST_CELLS);
    }
    m->origin = (core_vec3){b.min.x, 0, b.min.z};
    m->width = (uint32_t)width, m->depth = (uint32_t)depth;
    m->tile_cells = m->desc.tile_cells ? m->desc.tile_cells : CORE_MAX(m->width, m->depth);
    nav_mesh_lay_out(m);
    return true;
}

static bool fill(nav_world *w, nav_mesh_data *m, const core_soup_data *soup, nav_mesh *out) {
    for (uint32_t v = 0; v < soup->vertex_count; v++) { // before bounds are made of them
        if (!nav_soup_vertex_good(soup, v)) {
            return false;
        }
    }
    core_vec3 size = core_v3_sub(m->desc.bounds.max, m->desc.bounds.min);
    bool given = m->desc.tile_cells && (size.x != 0.0f || size.z != 0.0f);
    if (!nav_mesh_measure(m, given ? m->desc.bounds : bounds_of(soup)) ||
        !nav_piece_set(nav_mesh_add_piece(m, 0), m, soup)) {
        return false;
    }
    nav_mesh_dirty(m, (nav_tiles){0, 0, m->tiles_x - 1, m->tiles_z - 1});
    *out = nav_mesh_adopt(w, m);
    return true;
}

nav_mesh nav_mesh_build(nav_world *w, const core_soup_data *soup, const nav_mesh_desc *given) {
    static const core_soup_data nothing = {0};
    if (!given || given->cookie != NAV_MESH_COOKIE) {
        core_fail("nav_mesh_build: the description was not made by nav_mesh_desc_default()");
        return CORE_NULL_HANDLE;
    }
    nav_mesh_desc desc = *given;
    if ((!soup && !desc.tile_cells) || !nav_mesh_check_desc(&desc)) {
        return CORE_NULL_HANDLE;
    }
    nav_mesh_data *m = core_alloc(sizeof *m);
    m->desc = desc;
    m->cell_size = desc.cell_size;
    nav_mesh mesh = CORE_NULL_HANDLE;
    if (!fill(w, m, soup ? soup : &nothing, &mesh)) {
        nav_mesh_free(m);
        return mesh;
    }
    uint32_t row = core_columns_row(&w->mesh.set, mesh);
    if (row != CORE_NO_ROW && !nav_mesh_renew(w, row, 0)) {
        nav_mesh_destroy(w, mesh);
        return CORE_NULL_HANDLE;
    }
    if (row != CORE_NO_ROW && !desc.tile_cells) {
        nav_mesh_drop_pieces(m);
    }
    return mesh;
}

nav_mesh_data *nav_mesh_find(const nav_world *w, nav_mesh mesh, uint32_t *row) {
    *row = core_columns_row(&w->mesh.set, mesh);
    if (*row == CORE_NO_ROW) {
        core_fail("this nav mesh does not exist (index %u, generation %u): it is null or was "
                  "destroyed",
                  mesh.index, mesh.generation);
        return NULL;
    }
    return w->mesh.data[*row];
}

static nav_mesh_data *find(const nav_world *w, nav_mesh mesh) {
    uint32_t row;
    return nav_mesh_find(w, mesh, &row);
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
    return m ? m->polygon.blocks.count : 0;
}
double nav_mesh_area(const nav_world *w, nav_mesh mesh) {
    const nav_mesh_data *m = find(w, mesh);
    return m ? m->span.blocks.count * (double)m->cell_size * (double)m->cell_size : 0.0;
}
uint32_t nav_mesh_waiting(const nav_world *w, nav_mesh mesh) {
    const nav_mesh_data *m = find(w, mesh);
    return m ? m->dirty : 0;
}
uint64_t nav_mesh_hash(const nav_world *w, nav_mesh mesh) {
    uint32_t row;
    return nav_mesh_find(w, mesh, &row) ? w->mesh.head[row].content : 0;
}
bool nav_mesh_update(nav_world *w, nav_mesh mesh) {
    uint32_t row;
    return nav_mesh_find(w, mesh, &row) && nav_mesh_renew(w, row, 0);
}
