// Convex hull: Quickhull (Barber, Dobkin, Huhdanpaa 1996) on integers. Points are snapped to a grid
// of 2^-24 of the extent; orientation is then an exact 128-bit determinant, so the surface is a
// closed convex one by construction whatever the input. Faces that are coplanar within the
// tolerance of the caller's floats are merged into polygons afterwards.
#include "phys/geom.h"
#include "phys/geom_d.h"

#include <math.h>
#include <string.h>

#define NONE UINT32_MAX
#define GRID 16777216.0

typedef __int128 wide;

typedef struct grid_point {
    int64_t x, y, z;
} grid_point;

typedef struct triangle {
    uint32_t v[3];    // counter-clockwise from outside
    uint32_t next[3]; // neighbour across edge v[i] -> v[i+1]
    uint32_t outside; // first point of the conflict list
    bool alive, seen;
} triangle;

typedef struct builder {
    const core_vec3 *points;
    grid_point *grid;
    uint32_t *link; // next point in a conflict list
    triangle *tri;
    uint32_t tri_count, tri_capacity;
    uint32_t *stack, *horizon; // horizon: pairs (triangle, edge)
} builder;

// Twice six times the signed volume of (a, b, c, d): positive when d is on the outer side of abc.
static wide orient(const builder *b, const uint32_t v[3], uint32_t d) {
    const grid_point *p = b->grid;
    grid_point o = p[v[0]];
    int64_t ux = p[v[1]].x - o.x, uy = p[v[1]].y - o.y, uz = p[v[1]].z - o.z;
    int64_t vx = p[v[2]].x - o.x, vy = p[v[2]].y - o.y, vz = p[v[2]].z - o.z;
    int64_t wx = p[d].x - o.x, wy = p[d].y - o.y, wz = p[d].z - o.z;
    wide nx = (wide)uy * vz - (wide)uz * vy;
    wide ny = (wide)uz * vx - (wide)ux * vz;
    wide nz = (wide)ux * vy - (wide)uy * vx;
    return nx * wx + ny * wy + nz * wz;
}

static uint32_t add_triangle(builder *b, uint32_t x, uint32_t y, uint32_t z) {
    if (b->tri_count == b->tri_capacity) {
        uint32_t wider = b->tri_capacity * 2;
        b->tri = core_realloc(b->tri, sizeof(triangle) * b->tri_capacity, sizeof(triangle) * wider);
        b->stack = core_realloc(b->stack, 4 * (size_t)b->tri_capacity, 4 * (size_t)wider);
        b->horizon = core_realloc(b->horizon, 8 * (size_t)b->tri_capacity, 8 * (size_t)wider);
        b->tri_capacity = wider;
    }
    b->tri[b->tri_count] = (triangle){{x, y, z}, {NONE, NONE, NONE}, NONE, true, false};
    return b->tri_count++;
}

// Snaps points; false when any is not finite or the set has no extent.
static bool make_grid(builder *b, uint32_t count, double *extent) {
    dvec lo = d_of(b->points[0]), hi = lo;
    for (uint32_t i = 0; i < count; i++) {
        dvec p = d_of(b->points[i]);
        if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z)) {
            return core_fail("convex hull: point %u is (%g, %g, %g); finite coordinates expected",
                             i, p.x, p.y, p.z);
        }
        lo = (dvec){CORE_MIN(lo.x, p.x), CORE_MIN(lo.y, p.y), CORE_MIN(lo.z, p.z)};
        hi = (dvec){CORE_MAX(hi.x, p.x), CORE_MAX(hi.y, p.y), CORE_MAX(hi.z, p.z)};
    }
    *extent = CORE_MAX(CORE_MAX(hi.x - lo.x, hi.y - lo.y), hi.z - lo.z);
    if (!(*extent > 0)) {
        return core_fail("convex hull: all %u points coincide; at least 4 points that span a "
                         "volume expected",
                         count);
    }
    double scale = GRID / *extent;
    for (uint32_t i = 0; i < count; i++) {
        dvec p = d_sub(d_of(b->points[i]), lo);
        b->grid[i] = (grid_point){(int64_t)(p.x * scale + 0.5), (int64_t)(p.y * scale + 0.5),
                                  (int64_t)(p.z * scale + 0.5)};
    }
    return true;
}

static double grid_distance2(grid_point a, grid_point b) {
    double x = (double)(a.x - b.x), y = (double)(a.y - b.y), z = (double)(a.z - b.z);
    return x * x + y * y + z * z;
}

// Four points far apart: farthest from point 0, then from the line, then from the plane.
static bool first_simplex(const builder *b, uint32_t count, uint32_t s[4]) {
    const grid_point *g = b->grid;
    double best = -1;
    s[0] = 0;
    for (uint32_t i = 0; i < count; i++) { // an extreme point to start from
        if (g[i].x < g[s[0]].x) {
            s[0] = i;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (grid_distance2(g[i], g[s[0]]) > best) {
            best = grid_distance2(g[i], g[s[0]]), s[1] = i;
        }
    }
    double length2 = best;
    grid_point o = g[s[0]];
    dvec u = {(double)(g[s[1]].x - o.x), (double)(g[s[1]].y - o.y), (double)(g[s[1]].z - o.z)};
    dvec normal = {0, 0, 0};
    best = -1;
    for (uint32_t i = 0; i < count; i++) {
        dvec w = {(double)(g[i].x - o.x), (double)(g[i].y - o.y), (double)(g[i].z - o.z)};
        dvec c = d_cross(u, w);
        if (d_dot(c, c) > best) {
            best = d_dot(c, c), s[2] = i, normal = c;
        }
    }
    double width = __builtin_sqrt(best / length2);
    double height = -1, n = d_length(normal);
    for (uint32_t i = 0; i < count; i++) {
        dvec w = {(double)(g[i].x - o.x), (double)(g[i].y - o.y), (double)(g[i].z - o.z)};
        double h = n > 0 ? d_dot(normal, w) / n : 0;
        if ((h < 0 ? -h : h) > height) {
            height = h < 0 ? -h : h, s[3] = i;
        }
    }
    return width > GRID * 1e-5 && height > GRID * 1e-5;
}

// Puts p on the list of a face that sees it among tri[from..]; interior points are dropped.
static void assign(builder *b, uint32_t p, uint32_t from) {
    for (uint32_t t = from; t < b->tri_count; t++) {
        if (b->tri[t].alive && orient(b, b->tri[t].v, p) > 0) {
            b->link[p] = b->tri[t].outside;
            b->tri[t].outside = p;
            return;
        }
    }
}

static void join(builder *b, uint32_t t, int edge, uint32_t u) {
    uint32_t from = b->tri[t].v[edge], to = b->tri[t].v[(edge + 1) % 3];
    for (int i = 0; i < 3; i++) {
        if (b->tri[u].v[i] == to && b->tri[u].v[(i + 1) % 3] == from) {
            b->tri[t].next[edge] = u;
            b->tri[u].next[i] = t;
        }
    }
}

static void start(builder *b, uint32_t count, uint32_t s[4]) {
    const uint32_t base[3] = {s[0], s[1], s[2]};
    if (orient(b, base, s[3]) > 0) { // the fourth point must lie below the first face
        uint32_t swap = s[1];
        s[1] = s[2], s[2] = swap;
    }
    add_triangle(b, s[0], s[1], s[2]);
    add_triangle(b, s[0], s[3], s[1]);
    add_triangle(b, s[1], s[3], s[2]);
    add_triangle(b, s[2], s[3], s[0]);
    for (uint32_t t = 0; t < 4; t++) {
        for (int e = 0; e < 3; e++) {
            for (uint32_t u = 0; u < 4; u++) {
                if (u != t) {
                    join(b, t, e, u);
                }
            }
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        assign(b, i, 0);
    }
}

static uint32_t farthest(const builder *b, uint32_t t) {
    uint32_t best = b->tri[t].outside;
    wide far = orient(b, b->tri[t].v, best);
    for (uint32_t p = b->link[best]; p != NONE; p = b->link[p]) {
        wide d = orient(b, b->tri[t].v, p);
        if (d > far || (d == far && p < best)) {
            far = d, best = p;
        }
    }
    return best;
}

// Marks every face that sees p (connected from `first`) dead; collects the edges of the hole in
// `horizon` as (outer triangle, its edge). Returns the number of edges.
static uint32_t open_hole(builder *b, uint32_t first, uint32_t p) {
    uint32_t top = 0, edges = 0;
    b->stack[top++] = first;
    b->tri[first].seen = true;
    while (top) {
        uint32_t t = b->stack[--top];
        b->tri[t].alive = false;
        for (int e = 0; e < 3; e++) {
            uint32_t u = b->tri[t].next[e];
            if (b->tri[u].seen) {
                continue;
            }
            if (orient(b, b->tri[u].v, p) > 0) {
                b->tri[u].seen = true;
                b->stack[top++] = u;
            }
        }
    }
    for (uint32_t t = 0; t < b->tri_count; t++) {
        for (int e = 0; b->tri[t].alive && e < 3; e++) {
            if (!b->tri[b->tri[t].next[e]].alive) {
                b->horizon[2 * edges] = t, b->horizon[2 * edges + 1] = (uint32_t)e, edges++;
            }
        }
    }
    return edges;
}

static void insert(builder *b, uint32_t face, uint32_t p) {
    uint32_t dead_from = b->tri_count;
    uint32_t edges = open_hole(b, face, p);
    uint32_t first_new = b->tri_count;
    for (uint32_t i = 0; i < edges; i++) {
        uint32_t outer = b->horizon[2 * i], e = b->horizon[2 * i + 1];
        uint32_t from = b->tri[outer].v[e], to = b->tri[outer].v[(e + 1) % 3];
        uint32_t t = add_triangle(b, to, from, p);
        b->tri[t].next[0] = outer;
        b->tri[outer].next[e] = t;
    }
    for (uint32_t t = first_new; t < b->tri_count; t++) {
        for (uint32_t u = first_new; u < b->tri_count; u++) {
            if (b->tri[t].v[1] == b->tri[u].v[0]) {
                b->tri[t].next[1] = u;
                b->tri[u].next[2] = t;
            }
        }
    }
    for (uint32_t t = 0; t < dead_from; t++) {
        if (b->tri[t].alive) {
            continue;
        }
        for (uint32_t q = b->tri[t].outside; q != NONE;) {
            uint32_t next = b->link[q];
            if (q != p) {
                assign(b, q, first_new);
            }
            q = next;
        }
        b->tri[t].outside = NONE;
    }
}

// Moves the living faces to the front so that scans stay as long as the surface is large.
static void compact(builder *b) {
    uint32_t *to = b->stack, n = 0;
    for (uint32_t t = 0; t < b->tri_count; t++) {
        to[t] = b->tri[t].alive ? n++ : NONE;
    }
    for (uint32_t t = 0; t < b->tri_count; t++) {
        if (b->tri[t].alive) {
            triangle moved = b->tri[t];
            for (int e = 0; e < 3; e++) {
                moved.next[e] = to[moved.next[e]];
            }
            b->tri[to[t]] = moved;
        }
    }
    b->tri_count = n;
}

static void grow(builder *b) {
    for (uint32_t t = 0; t < b->tri_count;) {
        if (!b->tri[t].alive || b->tri[t].outside == NONE) {
            t++;
            continue;
        }
        insert(b, t, farthest(b, t));
        compact(b);
        t = 0;
    }
}

// ---- merging into polygons ----

typedef struct merger {
    const builder *b;
    double tolerance;
    uint32_t *region; // [triangle] face number
    uint32_t *loop;   // scratch of one face
    dvec *normal;     // [triangle] unit
} merger;

static dvec triangle_normal(const builder *b, uint32_t t) {
    const uint32_t *v = b->tri[t].v;
    dvec a = d_of(b->points[v[0]]);
    return d_cross(d_sub(d_of(b->points[v[1]]), a), d_sub(d_of(b->points[v[2]]), a));
}

static bool flat_with(const merger *m, dvec n, dvec at, uint32_t t) {
    for (int i = 0; i < 3; i++) {
        double h = d_dot(n, d_sub(d_of(m->b->points[m->b->tri[t].v[i]]), at));
        if (h > m->tolerance || h < -m->tolerance) {
            return false;
        }
    }
    return d_dot(n, m->normal[t]) > 0 || !(d_dot(m->normal[t], m->normal[t]) > 0);
}

// Grows face `id` from its largest triangle over neighbours that lie in its plane.
static void flood(merger *m, uint32_t seed, uint32_t id) {
    const builder *b = m->b;
    dvec n = m->normal[seed], at = d_of(b->points[b->tri[seed].v[0]]);
    uint32_t *stack = b->stack, top = 0;
    stack[top++] = seed;
    m->region[seed] = id;
    while (top) {
        uint32_t t = stack[--top];
        for (int e = 0; e < 3; e++) {
            uint32_t u = b->tri[t].next[e];
            if (m->region[u] == NONE && flat_with(m, n, at, u)) {
                m->region[u] = id;
                stack[top++] = u;
            }
        }
    }
}

// Walks the border of face `id` once around; 0 when the border is not one simple loop.
static uint32_t walk(const merger *m, uint32_t id, uint32_t *loop) {
    const builder *b = m->b;
    uint32_t border = 0, t0 = NONE, e0 = 0;
    for (uint32_t t = 0; t < b->tri_count; t++) {
        for (uint32_t e = 0; m->region[t] == id && e < 3; e++) {
            if (m->region[b->tri[t].next[e]] != id) {
                border++, t0 = t, e0 = e;
            }
        }
    }
    uint32_t n = 0, t = t0, e = e0;
    do {
        loop[n++] = b->tri[t].v[e];
        e = (e + 1) % 3;
        while (m->region[b->tri[t].next[e]] == id) { // turn about the vertex inside the face
            uint32_t u = b->tri[t].next[e], at = b->tri[t].v[e];
            t = u;
            for (e = 0; b->tri[u].v[e] != at; e++) {
            }
        }
    } while ((t != t0 || e != e0) && n <= border);
    return n == border ? n : 0;
}

static uint32_t find_faces(merger *m) {
    const builder *b = m->b;
    uint32_t faces = 0;
    for (uint32_t t = 0; t < b->tri_count; t++) {
        m->normal[t] = triangle_normal(b, t);
        m->region[t] = NONE;
    }
    for (;;) { // largest free triangle first, so that slivers join a face whose plane is sound
        uint32_t seed = NONE;
        double area = -1;
        for (uint32_t t = 0; t < b->tri_count; t++) {
            double a = d_dot(m->normal[t], m->normal[t]);
            if (m->region[t] == NONE && a > area) {
                area = a, seed = t;
            }
        }
        if (seed == NONE) {
            return faces;
        }
        m->normal[seed] = d_normalize(m->normal[seed], (dvec){0, 1, 0});
        flood(m, seed, faces);
        if (!walk(m, faces, m->loop)) { // not a disc: leave its triangles single
            for (uint32_t t = 0; t < b->tri_count; t++) {
                m->region[t] = m->region[t] == faces ? NONE : m->region[t];
            }
            m->region[seed] = faces;
        }
        faces++;
    }
}

// Drops vertices in the middle of an edge: those that only two faces share.
static uint32_t thin_loop(uint32_t *loop, uint32_t n, const uint32_t *uses) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (uses[loop[i]] > 2) {
            loop[kept++] = loop[i];
        }
    }
    return kept;
}

static void write_plane(phys_geom_hull *h, uint32_t f) { // Newell's normal, exact for planar loops
    const uint32_t *loop = h->loop + h->face_begin[f];
    uint32_t n = h->face_begin[f + 1] - h->face_begin[f];
    dvec o = d_of(h->vertex[loop[0]]), sum = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < n; i++) {
        sum = d_add(sum, d_cross(d_sub(d_of(h->vertex[loop[i]]), o),
                                 d_sub(d_of(h->vertex[loop[i + 1]]), o)));
    }
    dvec normal = d_normalize(sum, (dvec){0, 1, 0});
    double far = d_dot(normal, o);
    for (uint32_t i = 1; i < n; i++) {
        double d = d_dot(normal, d_of(h->vertex[loop[i]]));
        far = d > far ? d : far;
    }
    h->normal[f] = d_to(normal);
    h->offset[f] = (float)far;
}

static void write_hull(merger *m, uint32_t faces, uint32_t count, phys_geom_hull *h) {
    const builder *b = m->b;
    uint32_t most = 3 * b->tri_count;
    *h = (phys_geom_hull){0};
    h->vertex = core_alloc(sizeof(core_vec3) * count);
    h->normal = core_alloc(sizeof(core_vec3) * faces);
    h->offset = core_alloc(sizeof(float) * faces);
    h->face_begin = core_alloc(4 * ((size_t)faces + 1));
    h->loop = core_alloc(4 * (size_t)most);
    uint32_t *uses = core_alloc(8 * (size_t)count), *to = uses + count;
    for (uint32_t f = 0; f < faces; f++) {
        uint32_t n = walk(m, f, m->loop);
        for (uint32_t i = 0; i < n; i++) {
            uses[m->loop[i]]++;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        to[i] = uses[i] > 2 ? h->vertex_count : NONE;
        if (uses[i] > 2) {
            h->vertex[h->vertex_count++] = b->points[i];
        }
    }
    for (uint32_t f = 0; f < faces; f++) {
        uint32_t n = thin_loop(m->loop, walk(m, f, m->loop), uses);
        if (n < 3) {
            continue; // a sliver that vanished into its edge
        }
        h->face_begin[h->face_count] = h->loop_count;
        for (uint32_t i = 0; i < n; i++) {
            h->loop[h->loop_count++] = to[m->loop[i]];
        }
        h->face_begin[h->face_count + 1] = h->loop_count;
        write_plane(h, h->face_count++);
    }
    core_free(uses);
}

static void merge(const builder *b, double extent, uint32_t count, phys_geom_hull *hull) {
    merger m = {.b = b, .tolerance = extent * 2e-6};
    m.region = core_alloc(4 * (size_t)b->tri_count);
    m.loop = core_alloc(4 * (3 * (size_t)b->tri_count + 1));
    m.normal = core_alloc(sizeof(dvec) * b->tri_count);
    write_hull(&m, find_faces(&m), count, hull);
    core_free(m.region);
    core_free(m.loop);
    core_free(m.normal);
}

bool phys_geom_hull_build(phys_geom_hull *hull, const core_vec3 *points, uint32_t count) {
    memset(hull, 0, sizeof *hull);
    if (count < 4 || count > 65536 || !points) {
        return core_fail("convex hull: %u points given; 4 to 65536 expected", count);
    }
    builder b = {.points = points, .tri_capacity = 64};
    b.grid = core_alloc(sizeof(grid_point) * count);
    b.link = core_alloc(4 * (size_t)count);
    b.tri = core_alloc(sizeof(triangle) * b.tri_capacity);
    b.stack = core_alloc(4 * (size_t)b.tri_capacity);
    b.horizon = core_alloc(8 * (size_t)b.tri_capacity);
    double extent = 0;
    uint32_t s[4] = {0, 0, 0, 0};
    bool fine = make_grid(&b, count, &extent);
    if (fine && !first_simplex(&b, count, s)) {
        fine =
            core_fail("convex hull: the %u points lie in a plane, on a line or nearly so (thinner "
                      "than 1e-5 of their extent of %g m); points that span a volume expected",
                      count, extent);
    }
    if (fine) {
        memset(b.link, 0xff, 4 * (size_t)count);
        start(&b, count, s);
        grow(&b);
        merge(&b, extent, count, hull);
    }
    core_free(b.grid);
    core_free(b.link);
    core_free(b.tri);
    core_free(b.stack);
    core_free(b.horizon);
    return fine;
}

void phys_geom_hull_release(phys_geom_hull *hull) {
    core_free(hull->vertex);
    core_free(hull->normal);
    core_free(hull->offset);
    core_free(hull->face_begin);
    core_free(hull->loop);
    memset(hull, 0, sizeof *hull);
}
