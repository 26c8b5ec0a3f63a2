// Lab kernel "nav_build": walkable surfaces of a yard full of boxes at any place and angle, made
// with a cell size, in one or in tiles. The ground an agent's middle may stand on is known exactly
// (further than its radius from every box and edge): the error is the share of it that the surface
// does not cover. What is covered though it is too near is counted apart.
#include <string.h>

#include "core/rng.h"
#include "nav/lab.h"
#include "nav/nav.h"

#define SIDE         40.0f // m
#define MOST_BOXES   400u
#define SAMPLES      20000u
#define MOST_QUERIES 200u

typedef struct yard_box {
    float x, z, half_x, half_z, sine, cosine;
} yard_box;

typedef struct workload {
    nav_world *world;
    nav_mesh_desc desc;
    core_soup_data soup;
    float vertex[24 * (MOST_BOXES + 1)];
    uint32_t index[36 * (MOST_BOXES + 1)];
    yard_box box[MOST_BOXES];
    uint32_t boxes, queries;
    core_vec3 from[MOST_QUERIES], to[MOST_QUERIES];
    nav_mesh mesh;
} workload;

// ---- the yard ----

static void add_box(workload *w, const yard_box *b, float low, float high) {
    static const uint8_t face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    uint32_t first = w->soup.vertex_count;
    for (uint32_t k = 0; k < 8; k++) {
        float x = k & 1 ? b->half_x : -b->half_x, z = k & 4 ? b->half_z : -b->half_z;
        float *v = w->vertex + 3 * (first + k);
        v[0] = b->x + b->cosine * x + b->sine * z;
        v[1] = k & 2 ? high : low;
        v[2] = b->z - b->sine * x + b->cosine * z;
    }
    for (int f = 0; f < 6; f++) {
        const uint32_t corner[6] = {face[f][0], face[f][1], face[f][2],
                                    face[f][0], face[f][2], face[f][3]};
        for (int i = 0; i < 6; i++) {
            w->index[3 * w->soup.triangle_count + (uint32_t)(6 * f + i)] = first + corner[i];
        }
    }
    w->soup.vertex_count += 8;
    w->soup.triangle_count += 12;
}

static void fill_yard(workload *w, core_rng *rng) {
    yard_box ground = {0.5f * SIDE, 0.5f * SIDE, 0.5f * SIDE, 0.5f * SIDE, 0, 1};
    w->soup.position = w->vertex, w->soup.index = w->index;
    add_box(w, &ground, -1, 0);
    for (uint32_t i = 0; i < w->boxes; i++) {
        yard_box *b = &w->box[i];
        b->x = SIDE * core_rng_float(rng), b->z = SIDE * core_rng_float(rng);
        b->half_x = 0.1f + 1.2f * core_rng_float(rng),
        b->half_z = 0.1f + 1.2f * core_rng_float(rng);
        core_sincosf(6.2831853f * core_rng_float(rng), &b->sine, &b->cosine);
        add_box(w, b, 0, 2);
    }
}

static float distance_to(const yard_box *b, float x, float z) {
    float dx = x - b->x, dz = z - b->z;
    float along = core_absf(b->cosine * dx - b->sine * dz) - b->half_x;
    float across = core_absf(b->sine * dx + b->cosine * dz) - b->half_z;
    along = CORE_MAX(along, 0.0f), across = CORE_MAX(across, 0.0f);
    return core_sqrtf(along * along + across * across);
}

static float to_edge(float x, float z) {
    return CORE_MIN(CORE_MIN(x, SIDE - x), CORE_MIN(z, SIDE - z));
}
static float to_boxes(const workload *w, float x, float z) {
    float nearest = SIDE;
    for (uint32_t i = 0; i < w->boxes; i++) {
        nearest = CORE_MIN(nearest, distance_to(&w->box[i], x, z));
    }
    return nearest;
}

// ---- figures ----

static void build(void *ctx) {
    workload *w = ctx;
    if (nav_mesh_alive(w->world, w->mesh)) {
        nav_mesh_destroy(w->world, w->mesh);
    }
    w->mesh = nav_mesh_build(w->world, &w->soup, &w->desc);
}
static void search(void *ctx) {
    workload *w = ctx;
    for (uint32_t i = 0; i < w->queries; i++) {
        nav_result r;
        nav_mesh_search(w->world, w->mesh, w->from[i], w->to[i], &r, NULL, 0);
    }
}

// One tile made anew: a box put in and taken out by turns.
typedef struct change {
    workload *w;
    bool in;
} change;
static void renew(void *ctx) {
    change *c = ctx;
    core_soup_data box = c->w->soup; // the ground's box: its first twelve triangles, far too large
    box.vertex_count = 16, box.triangle_count = 12, box.index += 36;
    c->in = !c->in;
    nav_mesh_put(c->w->world, c->w->mesh, 1, c->in ? &box : NULL);
    nav_mesh_update(c->w->world, c->w->mesh);
}

static void measure_coverage(workload *w, core_rng *rng, core_json *out) {
    uint32_t free = 0, missed = 0, wrong = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        core_vec3 p = {SIDE * core_rng_float(rng), 0, SIDE * core_rng_float(rng)}, q;
        float radius = w->desc.agent_radius, edge = to_edge(p.x, p.z), box = to_boxes(w, p.x, p.z);
        bool stands = edge >= radius && box >= radius;
        bool on = nav_mesh_nearest(w->world, w->mesh, p, 1e-4f, &q) && q.y < 0.5f;
        free += stands;
        missed += stands && !on;
        // A cell with some ground in it counts as ground: ledges may be a cell nearer.
        wrong += on && (box < radius - 0.01f || edge < radius - w->desc.cell_size - 0.01f);
    }
    core_json_number(out, "error_mean", free ? (double)missed / free : 0.0);
    core_json_int(out, "wrong", wrong);
}

static void pick_queries(workload *w, core_rng *rng) {
    for (uint32_t i = 0; i < w->queries; i++) {
        w->from[i] = (core_vec3){SIDE * core_rng_float(rng), 0, SIDE * core_rng_float(rng)};
        w->to[i] = (core_vec3){SIDE * core_rng_float(rng), 0, SIDE * core_rng_float(rng)};
    }
}

static void report(workload *w, const core_lab_case *c, core_rng *rng, core_json *out) {
    build(w);
    measure_coverage(w, rng, out);
    pick_queries(w, rng);
    core_json_int(out, "polygons", nav_mesh_polygons(w->world, w->mesh));
    core_json_number(out, "bytes", (double)nav_world_bytes(w->world));
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ms", core_lab_time(build, w, 5e7) / 1e6);
        core_json_number(out, "query_us", core_lab_time(search, w, 5e7) / 1e3 / w->queries);
        change ch = {w, false};
        bool tiled = w->desc.tile_cells != 0;
        core_json_number(out, "change_ms", tiled ? core_lab_time(renew, &ch, 5e7) / 1e6 : 0.0);
    }
}

static bool run(const core_lab_case *c, core_json *out) {
    double cell = core_lab_number(c, "cell", 0.3), radius = core_lab_number(c, "radius", 0.3);
    double tile = core_lab_number(c, "tile", 0), boxes = core_lab_number(c, "boxes", 150);
    if (!(cell >= 0.02 && cell <= 2) || !(radius >= 0 && radius <= 2) ||
        !(tile == 0 || (tile >= 8 && tile <= 1024)) || !(boxes >= 1 && boxes <= MOST_BOXES)) {
        return core_fail("lab kernel nav_build: cell %g, radius %g, tile %g, boxes %g; expected "
                         "0.02 to 2 m, 0 to 2 m, 0 or 8 to 1024, 1 to %u",
                         cell, radius, tile, boxes, MOST_BOXES);
    }
    nav_world_desc world = nav_world_desc_default();
    workload *w = core_alloc(sizeof *w);
    w->world = nav_world_create(&world);
    w->desc = nav_mesh_desc_default();
    w->desc.cell_size = (float)cell, w->desc.agent_radius = (float)radius;
    w->desc.tile_cells = (uint32_t)tile;
    w->boxes = (uint32_t)boxes, w->queries = MOST_QUERIES;
    core_rng rng = core_rng_make((uint64_t)core_lab_number(c, "seed", 1), CORE_RNG_ENGINE);
    fill_yard(w, &rng);
    report(w, c, &rng, out);
    nav_world_destroy(w->world);
    core_free(w);
    return true;
}

const core_lab_kernel nav_lab_build = {
    "nav_build", "share of the ground that a surface misses, against the time to make it",
    "cell: m; radius: m; tile: cells a side, 0 for one tile; boxes; seed", run};
