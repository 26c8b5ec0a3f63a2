// Points on walkable surfaces.
#include "nav/nav_internal.h"

static const nav_mesh_data *find(const nav_world *w, nav_mesh mesh) {
    uint32_t row;
    return nav_mesh_find(w, mesh, &row);
}

// ---- points on the surface ----

static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

// Points keep a little off the borders of their cell: on a border or corner it would be open which
// polygon they belong to.
static void consider(const nav_mesh_data *m, int64_t x, int64_t z, nav_point p, double y,
                     nav_place *best) {
    if (x < 0 || z < 0 || x >= m->width || z >= m->depth) {
        return;
    }
    size_t cell = (size_t)z * m->width + (size_t)x;
    uint32_t end = m->span.first[cell] + m->span.stack[cell];
    const double inset = 1e-4;
    nav_point at = {clamp(p.x, (double)x + inset, (double)x + 1 - inset),
                    clamp(p.z, (double)z + inset, (double)z + 1 - inset)};
    double dx = at.x - p.x, dz = at.z - p.z, square = dx * dx + dz * dz;
    for (uint32_t s = m->span.first[cell]; s < end; s++) {
        double height = y - (double)m->span.y[s];
        height = height < 0.0 ? -height : height;
        bool nearer = square < best->square - 1e-3 ||
                      (square <= best->square + 1e-3 && height < best->height);
        if (best->span == NAV_NONE || nearer) {
            *best = (nav_place){s, at, square, height};
        }
    }
}

nav_place nav_mesh_locate(const nav_mesh_data *m, core_vec3 p, double reach) {
    double size = (double)m->cell_size;
    nav_point at = {((double)p.x - m->origin.x) / size, ((double)p.z - m->origin.z) / size};
    nav_place best = {.span = NAV_NONE};
    if (!(at.x > -1e6 && at.x < 1e6 && at.z > -1e6 && at.z < 1e6) || p.y - p.y != 0.0f) {
        return best;
    }
    // Rings around the nearest point of the surface's box: the box is convex, so what is a ring
    // away from there is that and the way to the box away from p.
    nav_point inside = {clamp(at.x, 0.0, m->width - 0.5), clamp(at.z, 0.0, m->depth - 0.5)};
    double ox = at.x - inside.x, oz = at.z - inside.z, outside = ox * ox + oz * oz;
    int64_t x = (int64_t)core_floor(inside.x), z = (int64_t)core_floor(inside.z);
    int64_t most = (int64_t)CORE_MIN(core_ceil(reach), (double)CORE_MAX(m->width, m->depth));
    for (int64_t ring = 0; ring <= most; ring++) {
        for (int64_t dx = -ring; dx <= ring; dx++) {
            bool edge = dx == -ring || dx == ring;
            for (int64_t dz = -ring; dz <= ring; dz += edge || ring == 0 ? 1 : 2 * ring) {
                consider(m, x + dx, z + dz, at, (double)p.y, &best);
            }
        }
        if (best.span != NAV_NONE && best.square <= outside + (double)(ring * ring)) {
            break; // cells of further rings are further away
        }
    }
    if (best.span != NAV_NONE && best.square > (reach + 2e-4) * (reach + 2e-4)) {
        best.span = NAV_NONE;
    }
    return best;
}

core_vec3 nav_mesh_world_point(const nav_mesh_data *m, nav_point p, float y) {
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
    nav_place found = nav_mesh_locate(m, p, reach);
    if (found.span != NAV_NONE) {
        *out = nav_mesh_world_point(m, found.at, m->span.y[found.span]);
    }
    return found.span != NAV_NONE;
}

bool nav_mesh_hold(const nav_world *w, nav_mesh mesh, core_vec3 *p) {
    uint32_t row = core_columns_row(&w->mesh.set, mesh);
    if (row == CORE_NO_ROW) {
        return false;
    }
    const nav_mesh_data *m = w->mesh.data[row];
    nav_place found = nav_mesh_locate(m, *p, 2.0);
    if (found.span != NAV_NONE) {
        *p = found.square > 0.0 ? nav_mesh_world_point(m, found.at, m->span.y[found.span])
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
    nav_place at = m ? nav_mesh_locate(m, p, 2.0) : (nav_place){.span = NAV_NONE};
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
