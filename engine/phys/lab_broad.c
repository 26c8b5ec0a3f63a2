// Lab kernel "broad": a broad phase on laid-out boxes. Gives the number of pairs, those that it
// missed and those that it found beyond the brute-force set, and the time of one search after a
// small move of every body (what a step costs, not the first sort).
#include "core/rng.h"
#include "phys/lab.h"
#include "phys/world.h"

#include <stdlib.h>
#include <string.h>

typedef core_vec3 place_fn(core_rng *rng, uint32_t i, uint32_t n);

static float symmetric(core_rng *rng, float a) { return a * (2.0f * core_rng_float(rng) - 1.0f); }

static core_vec3 in_cube(core_rng *rng, float half) {
    float x = symmetric(rng, half), y = symmetric(rng, half), z = symmetric(rng, half);
    return core_v3(x, y, z);
}

// Half the edge of a cube in which n unit spheres have 27 m^3 each.
static float half_edge(uint32_t n) {
    float edge = 3.0f;
    for (uint32_t k = 1; k * k * k < n; k++) {
        edge += 3.0f;
    }
    return 0.5f * edge;
}

static core_vec3 uniform(core_rng *rng, uint32_t i, uint32_t n) {
    (void)i;
    return in_cube(rng, half_edge(n));
}

// Heaps of 64 far from each other.
static core_vec3 clustered(core_rng *rng, uint32_t i, uint32_t n) {
    core_rng heap = core_rng_make(i / 64 + 7, CORE_RNG_ENGINE);
    return core_v3_add(in_cube(&heap, 3.0f * half_edge(n)), in_cube(rng, 3.0f));
}

// A row along x: the worst sweep axes are the other two.
static core_vec3 line(core_rng *rng, uint32_t i, uint32_t n) {
    core_vec3 p = core_v3(1.5f * ((float)i - 0.5f * (float)n), 0, 0);
    return core_v3_add(p, in_cube(rng, 0.4f));
}

// Five floors: every body of a floor overlaps every other along y.
static core_vec3 layered(core_rng *rng, uint32_t i, uint32_t n) {
    float half = 2.5f * half_edge(n);
    float z = symmetric(rng, half); // one by one: arguments have no order
    core_vec3 p = core_v3(symmetric(rng, half), 20.0f * (float)(i % 5), z);
    return core_v3(p.x, p.y + symmetric(rng, 0.05f), p.z);
}

static const struct layout {
    const char *name;
    place_fn *place;
} layouts[] = {
    {"uniform", uniform}, {"clustered", clustered}, {"line", line}, {"layered", layered}};

typedef struct broad_run {
    phys_world *world;
    core_rng rng;
} broad_run;

// The scene is turned so that the sweep, which runs along x, meets another axis of the layout.
static core_vec3 turned(core_vec3 p, const char *axis) {
    return axis[0] == 'y' ? core_v3(p.y, p.z, p.x) : axis[0] == 'z' ? core_v3(p.z, p.x, p.y) : p;
}

static bool fill(broad_run *r, const struct layout *l, uint32_t n, const char *axis) {
    for (uint32_t i = 0; i < n; i++) {
        phys_body_desc body = phys_body_desc_default();
        phys_shape_desc shape = phys_shape_desc_default(PHYS_SPHERE);
        shape.radius = 0.5f;
        body.position = turned(l->place(&r->rng, i, n), axis);
        if (phys_body_create(r->world, &body, &shape, 1).index == 0) {
            return false;
        }
    }
    return true;
}

static void nudge(void *ctx) {
    broad_run *r = ctx;
    phys_bodies *b = &r->world->bodies;
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        core_vec3 p = phys_get3(b->px, b->py, b->pz, i);
        phys_put3(b->px, b->py, b->pz, i, core_v3_add(p, in_cube(&r->rng, 0.01f)));
        phys_body_sync_center(b, i);
    }
    phys_shapes_update_bounds(r->world, 1.0f / 60.0f);
}

static void search(void *ctx) {
    broad_run *r = ctx;
    nudge(r);
    phys_layers_update(r->world);
    r->world->broad->find(r->world);
}

static int by_key(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

// Pairs as sorted keys; the caller frees.
static uint64_t *keys_of(const phys_world *w, uint32_t *count) {
    uint64_t *key = core_alloc((w->pairs.count + 1) * sizeof *key);
    *count = w->pairs.count;
    for (uint32_t i = 0; i < *count; i++) {
        uint32_t a = w->pairs.pair[i].a, b = w->pairs.pair[i].b;
        key[i] = (uint64_t)CORE_MIN(a, b) << 32 | CORE_MAX(a, b);
    }
    qsort(key, *count, sizeof *key, by_key);
    return key;
}

static void compare(broad_run *r, const phys_broad_method *method, core_json *out) {
    uint32_t found, known, both = 0;
    method->find(r->world);
    uint64_t *mine = keys_of(r->world, &found);
    phys_broad_brute.find(r->world);
    uint64_t *all = keys_of(r->world, &known);
    for (uint32_t i = 0, j = 0; i < found && j < known;) {
        both += mine[i] == all[j];
        i += mine[i] <= all[j] ? (mine[i] == all[j] ? j++ : 0, 1) : 0;
        j += i < found && j < known && mine[i] > all[j];
    }
    core_json_int(out, "pairs", known);
    core_json_int(out, "missed", known - both);
    core_json_int(out, "extra", found - both);
    core_free(mine);
    core_free(all);
}

static bool run(const core_lab_case *c, core_json *out) {
    const char *name = core_lab_text(c, "layout", "uniform");
    const char *axis = core_lab_text(c, "axis", "x");
    const struct layout *l = NULL;
    for (size_t i = 0; i < CORE_COUNT_OF(layouts); i++) {
        l = strcmp(layouts[i].name, name) == 0 ? &layouts[i] : l;
    }
    double n = core_lab_number(c, "n", 1000);
    if (!l || !(n >= 2 && n <= 1e6) || !strchr("xyz", axis[0])) {
        return core_fail(
            "lab kernel broad: layout uniform, clustered, line or layered, axis x, y or "
            "z, 2 <= n <= 1e6 expected; got '%s', '%s', %g",
            name, axis, n);
    }
    phys_world_desc desc = phys_world_desc_default();
    desc.broad = core_lab_text(c, "method", "sap");
    broad_run r = {phys_world_create(&desc),
                   core_rng_make((uint64_t)core_lab_number(c, "seed", 1), CORE_RNG_ENGINE)};
    bool fine = r.world && fill(&r, l, (uint32_t)n, axis);
    if (fine) {
        search(&r);
        nudge(&r);
        compare(&r, r.world->broad, out);
        if (core_lab_number(c, "timed", 0) > 0) {
            double moving = core_lab_time(nudge, &r, 2e7), all = core_lab_time(search, &r, 5e7);
            core_json_number(out, "cost_ms", CORE_MAX(all - moving, 1.0) * 1e-6);
        }
    }
    phys_world_destroy(r.world);
    return fine;
}

const core_lab_kernel phys_lab_broad = {
    "broad", "a broad phase: pairs, missed and extra ones against brute force, time of one search",
    "method: a name of the setting phys.broad; layout: uniform|clustered|line|layered; axis: x|y|z "
    "of the layout along the sweep; n, seed, timed",
    run};
