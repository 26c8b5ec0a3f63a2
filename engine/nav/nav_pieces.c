// What a surface is made from: pieces of triangles and marks of areas, each sorted into the tiles
// that it reaches.
#include <string.h>

#include "nav/nav_internal.h"

uint32_t nav_mesh_margin(const nav_mesh_data *m) {
    // Borders reach as far as the radius; a border is where one of two linked cells is missing, and
    // links need the cells beside both.
    bool whole = m->tiles_x * m->tiles_z == 1;
    return whole ? 0 : (uint32_t)core_ceil((double)(m->desc.agent_radius / m->cell_size)) + 3;
}

static int64_t cell_of(const nav_mesh_data *m, float at, float origin) {
    return (int64_t)core_floor(((double)at - (double)origin) / (double)m->cell_size);
}

// Tiles whose spans depend on a box; none when x0 > x1.
static nav_tiles reach_of(const nav_mesh_data *m, core_vec3 low, core_vec3 high) {
    int64_t margin = nav_mesh_margin(m) + 1, size = m->tile_cells;
    int64_t x0 = cell_of(m, low.x, m->origin.x) - margin;
    int64_t z0 = cell_of(m, low.z, m->origin.z) - margin;
    int64_t x1 = cell_of(m, high.x, m->origin.x) + margin;
    int64_t z1 = cell_of(m, high.z, m->origin.z) + margin;
    if (x1 < 0 || z1 < 0 || x0 >= m->width || z0 >= m->depth) {
        return (nav_tiles){.x0 = 1};
    }
    return (nav_tiles){(uint32_t)(CORE_MAX(x0, 0) / size), (uint32_t)(CORE_MAX(z0, 0) / size),
                       (uint32_t)(CORE_MIN(x1, (int64_t)m->width - 1) / size),
                       (uint32_t)(CORE_MIN(z1, (int64_t)m->depth - 1) / size)};
}

static nav_tiles reach_of_triangle(const nav_mesh_data *m, const nav_triangle *t) {
    core_vec3 low = t->corner[0], high = t->corner[0];
    for (int i = 1; i < 3; i++) {
        low.x = CORE_MIN(low.x, t->corner[i].x), high.x = CORE_MAX(high.x, t->corner[i].x);
        low.z = CORE_MIN(low.z, t->corner[i].z), high.z = CORE_MAX(high.z, t->corner[i].z);
    }
    return reach_of(m, low, high);
}

static bool empty(nav_tiles r) { return r.x0 > r.x1; }
static nav_tiles join(nav_tiles a, nav_tiles b) {
    if (empty(a) || empty(b)) {
        return empty(a) ? b : a;
    }
    return (nav_tiles){CORE_MIN(a.x0, b.x0), CORE_MIN(a.z0, b.z0), CORE_MAX(a.x1, b.x1),
                       CORE_MAX(a.z1, b.z1)};
}
static uint32_t tiles_in(nav_tiles r) {
    return empty(r) ? 0 : (r.x1 - r.x0 + 1) * (r.z1 - r.z0 + 1);
}
static uint32_t place_in(nav_tiles r, uint32_t x, uint32_t z) {
    return (z - r.z0) * (r.x1 - r.x0 + 1) + x - r.x0;
}

// Counts, then fills: two passes over the same tiles of every triangle.
static void sort_into_tiles(nav_piece *p, const nav_mesh_data *m) {
    const nav_triangle *t = p->triangles.data;
    uint32_t tiles = tiles_in(p->reach);
    uint32_t *first = nav_buffer_fit(&p->first, (tiles + 1) * sizeof *first);
    memset(first, 0, (tiles + 1) * sizeof *first);
    for (int pass = 0; pass < 2; pass++) {
        uint32_t *item = p->item.data;
        for (uint32_t i = p->count; i-- > 0;) {
            nav_tiles r = reach_of_triangle(m, &t[i]);
            for (uint32_t z = r.z0; !empty(r) && z <= r.z1; z++) {
                for (uint32_t x = r.x0; x <= r.x1; x++) {
                    uint32_t at = place_in(p->reach, x, z);
                    if (pass == 0) {
                        first[at]++;
                    } else {
                        item[--first[at]] = i; // from the end: ascending
                    }
                }
            }
        }
        for (uint32_t k = 0; pass == 0 && k < tiles; k++) {
            first[k + 1] += first[k]; // the end of each; filling turns it into the begin
        }
        if (pass == 0) {
            first[tiles] = tiles ? first[tiles - 1] : 0;
            nav_buffer_fit(&p->item, ((size_t)first[tiles] + 1) * sizeof *item);
        }
    }
}

bool nav_soup_vertex_good(const core_soup_data *soup, uint32_t v) {
    const float *p = soup->position + 3 * (size_t)v;
    return (core_absf(p[0]) <= 1e6f && core_absf(p[1]) <= 1e6f && core_absf(p[2]) <= 1e6f) ||
           core_fail("nav_mesh_build: vertex %u is (%g, %g, %g), expected numbers up to a million",
                     v, (double)p[0], (double)p[1], (double)p[2]);
}

void nav_piece_sort(nav_piece *p, const nav_mesh_data *m) {
    const nav_triangle *t = p->triangles.data;
    p->reach = p->mark ? reach_of(m, p->box.min, p->box.max) : (nav_tiles){.x0 = 1};
    for (uint32_t i = 0; i < p->count; i++) {
        p->reach = join(p->reach, reach_of_triangle(m, &t[i]));
    }
    if (!p->mark) {
        sort_into_tiles(p, m);
    }
}

bool nav_piece_set(nav_piece *p, const nav_mesh_data *m, const core_soup_data *soup) {
    p->mark = false;
    p->count = soup->triangle_count;
    nav_triangle *t = nav_buffer_fit(&p->triangles, ((size_t)p->count + 1) * sizeof *t);
    memset(t, 0, p->count * sizeof *t); // padding, too: pieces are compared by their bytes
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        if (!nav_soup_vertex_good(soup, v)) {
            return false;
        }
    }
    for (uint32_t i = 0; i < p->count; i++) {
        for (int k = 0; k < 3; k++) {
            uint32_t v = soup->index[3 * (size_t)i + (size_t)k];
            if (v >= soup->vertex_count) {
                return core_fail("nav_mesh_build: triangle %u names vertex %u of %u", i, v,
                                 soup->vertex_count);
            }
            memcpy(&t[i].corner[k], soup->position + 3 * (size_t)v, sizeof t[i].corner[k]);
        }
        t[i].area = soup->area ? soup->area[i] : 0;
        if (t[i].area >= NAV_AREAS && t[i].area != NAV_AREA_CLOSED) {
            return core_fail("nav_mesh_build: triangle %u is of area %u, expected 0 to %u or %u", i,
                             t[i].area, NAV_AREAS - 1, NAV_AREA_CLOSED);
        }
    }
    nav_piece_sort(p, m);
    return true;
}

void nav_piece_free(nav_piece *p) {
    core_free(p->triangles.data);
    core_free(p->first.data);
    core_free(p->item.data);
    core_free(p);
}

bool nav_pieces_fill(const nav_mesh_data *m, uint32_t tile, nav_field *field) {
    uint32_t x = tile % m->tiles_x, z = tile / m->tiles_x;
    for (uint32_t i = 0; i < m->piece_count; i++) {
        const nav_piece *p = m->piece[i];
        if (p->mark || x < p->reach.x0 || x > p->reach.x1 || z < p->reach.z0 || z > p->reach.z1) {
            continue;
        }
        const nav_triangle *t = p->triangles.data;
        const uint32_t *first = p->first.data, *item = p->item.data;
        uint32_t at = place_in(p->reach, x, z);
        field->piece = i;
        for (uint32_t k = first[at]; k < first[at + 1]; k++) {
            if (!nav_field_add(field, &t[item[k]])) {
                return false;
            }
        }
    }
    return true;
}

// ---- pieces of a surface, by key ----

static uint32_t place_of_key(const nav_mesh_data *m, uint64_t key) {
    uint32_t low = 0, high = m->piece_count;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (m->piece[middle]->key < key) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static nav_piece *find_piece(const nav_mesh_data *m, uint64_t key) {
    uint32_t at = place_of_key(m, key);
    return at < m->piece_count && m->piece[at]->key == key ? m->piece[at] : NULL;
}

nav_piece *nav_mesh_add_piece(nav_mesh_data *m, uint64_t key) {
    nav_piece *old = find_piece(m, key);
    if (old) {
        return old;
    }
    if (m->piece_count == m->piece_room) {
        uint32_t wanted = CORE_MAX(m->piece_room * 2, 16u);
        m->piece =
            core_realloc(m->piece, m->piece_room * sizeof *m->piece, wanted * sizeof *m->piece);
        m->piece_room = wanted;
    }
    uint32_t at = place_of_key(m, key);
    memmove(m->piece + at + 1, m->piece + at, (m->piece_count - at) * sizeof *m->piece);
    m->piece_count++;
    nav_piece *p = core_alloc(sizeof *p);
    p->key = key;
    p->reach = (nav_tiles){.x0 = 1};
    m->piece[at] = p;
    return p;
}

// A spare piece is kept: what is put at every step (a door) must not allocate.
static nav_piece *take_spare(nav_mesh_data *m) {
    nav_piece *p = m->spare ? m->spare : core_alloc(sizeof *p);
    m->spare = NULL;
    return p;
}
static void give_spare(nav_mesh_data *m, nav_piece *p) {
    if (m->spare) {
        nav_piece_free(m->spare);
    }
    m->spare = p;
}

static void remove_piece(nav_mesh_data *m, uint64_t key) {
    uint32_t at = place_of_key(m, key);
    give_spare(m, m->piece[at]);
    memmove(m->piece + at, m->piece + at + 1, (m->piece_count - at - 1) * sizeof *m->piece);
    m->piece_count--;
}

void nav_mesh_drop_pieces(nav_mesh_data *m) {
    while (m->piece_count) {
        nav_piece_free(m->piece[--m->piece_count]);
    }
}

static nav_mesh_data *find_tiled(const nav_world *w, nav_mesh mesh) {
    uint32_t row;
    nav_mesh_data *m = nav_mesh_find(w, mesh, &row);
    if (m && m->desc.tile_cells == 0) {
        core_fail("this nav mesh was made in one: give tile_cells to change it later");
        return NULL;
    }
    return m;
}

// Takes the place of what the key had, unless it is the same.
static void replace(nav_mesh_data *m, uint64_t key, nav_piece *next) {
    nav_piece *old = find_piece(m, key);
    if (old && !old->mark && !next->mark && old->count == next->count &&
        memcmp(old->triangles.data, next->triangles.data, old->count * sizeof(nav_triangle)) == 0) {
        give_spare(m, next);
        return;
    }
    old = nav_mesh_add_piece(m, key);
    nav_mesh_dirty(m, old->reach);
    nav_piece was = *old;
    *old = *next;
    *next = was;
    old->key = key;
    nav_mesh_dirty(m, old->reach);
    give_spare(m, next);
}

static bool remove_key(nav_mesh_data *m, uint64_t key) {
    nav_piece *old = find_piece(m, key);
    if (old) {
        nav_mesh_dirty(m, old->reach);
        remove_piece(m, key);
    }
    return true;
}

bool nav_mesh_put(nav_world *w, nav_mesh mesh, uint64_t key, const core_soup_data *soup) {
    nav_mesh_data *m = find_tiled(w, mesh);
    if (!m) {
        return false;
    }
    if (!soup || soup->triangle_count == 0) {
        return remove_key(m, key);
    }
    nav_piece *next = take_spare(m);
    if (!nav_piece_set(next, m, soup)) {
        give_spare(m, next);
        return false;
    }
    replace(m, key, next);
    return true;
}

bool nav_mesh_mark(nav_world *w, nav_mesh mesh, uint64_t key, const core_aabb *box, uint8_t area) {
    nav_mesh_data *m = find_tiled(w, mesh);
    if (!m) {
        return false;
    }
    if (!box) {
        return remove_key(m, key);
    }
    core_vec3 size = core_v3_sub(box->max, box->min);
    if (!(size.x >= 0.0f && size.y >= 0.0f && size.z >= 0.0f) ||
        !(core_v3_dot(size, size) < 1e18f) || (area >= NAV_AREAS && area != NAV_AREA_CLOSED)) {
        return core_fail("nav_mesh_mark: a box of %g by %g by %g m, area %u; expected sizes >= 0 "
                         "and an area of 0 to %u or %u",
                         (double)size.x, (double)size.y, (double)size.z, area, NAV_AREAS - 1,
                         NAV_AREA_CLOSED);
    }
    nav_piece *next = take_spare(m);
    next->count = 0;
    next->mark = true;
    next->box = *box;
    next->area = area;
    nav_piece_sort(next, m);
    replace(m, key, next);
    return true;
}
