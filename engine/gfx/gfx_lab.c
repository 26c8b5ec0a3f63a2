// Lab kernels: light assignment alone, and whole frames, on the report's test: lights of equal
// radius in a box of 100 x 10 x 100 m, the camera at one edge, 60 degrees, 16:9.
#include "gfx/gfx_lab.h"

#include "core/clock.h"
#include "core/rng.h"
#include "gfx/gfx_cluster.h"
#include "gfx/gfx_device_internal.h"

#include <string.h>

static const core_vec3 eye = {0.0f, 3.0f, 50.0f};

static core_vec3 light_position(core_rng *rng) {
    float x = core_rng_float(rng), y = core_rng_float(rng), z = core_rng_float(rng);
    return core_v3(100.0f * x - 50.0f, 10.0f * y, 100.0f * z - 50.0f);
}

// Spots of 30 degrees, pointing anywhere, make up a part of them.
static void add_lights(gfx_world *world, uint32_t n, float radius, float spots) {
    core_rng rng = core_rng_make(1, CORE_RNG_ENGINE), kinds = core_rng_make(3, CORE_RNG_ENGINE);
    for (uint32_t i = 0; i < n; ++i) {
        bool spot = core_rng_float(&kinds) < spots;
        gfx_light_desc d = gfx_light_desc_default(spot ? GFX_SPOT : GFX_POINT);
        d.direction = core_v3_sub(light_position(&kinds), core_v3(0.0f, 5.0f, 0.0f));
        d.inner = 0.3f, d.outer = CORE_PI_F / 6.0f;
        d.position = light_position(&rng);
        d.radius = radius;
        d.intensity = 4.0f;
        for (int k = 0; k < 3; ++k) {
            d.color[k] = 0.2f + 0.8f * core_rng_float(&rng);
        }
        gfx_light_create(world, &d);
    }
}

static gfx_world *lab_world(const core_lab_case *c) {
    gfx_world_desc desc = gfx_world_desc_default();
    gfx_world *world = gfx_world_create(&desc);
    if (!world) {
        return NULL;
    }
    add_lights(world, (uint32_t)core_lab_number(c, "n", 1024),
               (float)core_lab_number(c, "radius", 5), (float)core_lab_number(c, "spots", 0));
    gfx_camera camera = {.position = eye};
    gfx_world_set_camera(world, &camera);
    return world;
}

// Least time of a few runs by a clock.
static double best_ns(uint64_t (*clock)(void), core_lab_body *body, void *ctx, int runs) {
    double best = 0;
    for (int i = 0; i < runs; ++i) {
        uint64_t start = clock();
        body(ctx);
        double ns = (double)(clock() - start);
        best = i == 0 || ns < best ? ns : best;
    }
    return best;
}

// ---- assignment ----

typedef struct cluster_run {
    gfx_clusters clusters;
    gfx_cluster_grid grid;
    gfx_cluster_lights lights;
    gfx_cluster_method method;
    core_jobs *jobs;
} cluster_run;

// What a fragment on the ground under the lights costs: references of its cell's list, and how many
// of them are of lights that do not reach it.
typedef struct list_use {
    double refs, wasted;
} list_use;

static list_use use_of_lists(const cluster_run *r, const gfx_lights *l) {
    core_rng rng = core_rng_make(4, CORE_RNG_ENGINE);
    uint64_t refs = 0, wasted = 0, fragments = 0;
    while (fragments < 20000) {
        float u = core_rng_float(&rng), v = 0.5f * core_rng_float(&rng);
        float fall = (1.0f - 2.0f * v) * r->grid.tan_y,
              depth = eye.y / fall; // metres to the ground
        float x = (2.0f * u - 1.0f) * r->grid.tan_x * depth;
        if (!(depth <= r->grid.far) || core_absf(x) > 50.0f) {
            continue;
        }
        uint32_t cell = gfx_cluster_cell(&r->grid, u, v, depth);
        core_vec3 p = core_v3(eye.x + x, 0.0f, eye.z - depth);
        for (uint32_t i = r->clusters.offset[cell]; i < r->clusters.offset[cell + 1]; ++i) {
            uint32_t n = r->clusters.light[i];
            core_vec3 d = core_v3_sub(p, core_v3(l->px[n], l->py[n], l->pz[n]));
            refs++;
            wasted += core_v3_dot(d, d) > l->radius[n] * l->radius[n];
        }
        fragments++;
    }
    return (list_use){(double)refs / (double)fragments, (double)wasted / (double)fragments};
}

static bool grid_of(const core_lab_case *c, gfx_world *world) {
    return gfx_world_set(world, "clusters", core_lab_text(c, "grid", "16x9x24")) &&
           gfx_world_set(world, "slices", core_lab_text(c, "slices", "exponential"));
}

static void assign(void *ctx) {
    cluster_run *r = ctx;
    gfx_clusters_assign(&r->clusters, &r->grid, &r->lights, r->method, r->jobs);
}

static bool run_cluster(const core_lab_case *c, core_json *out) {
    const char *name = core_lab_text(c, "method", "simd");
    cluster_run r = {.method = GFX_CLUSTER_METHODS};
    for (int m = 0; m < GFX_CLUSTER_METHODS; ++m) {
        if (strcmp(name, gfx_cluster_method_name((gfx_cluster_method)m)) == 0) {
            r.method = (gfx_cluster_method)m;
        }
    }
    if (r.method == GFX_CLUSTER_METHODS) {
        return core_fail("lab kernel gfx.cluster: method naive, per_light or simd expected");
    }
    gfx_world *world = lab_world(c);
    r.jobs = core_jobs_create((int)core_lab_number(c, "threads", 1));
    if (!world || !r.jobs || !grid_of(c, world)) {
        return false;
    }
    gfx_view view;
    gfx_camera camera = gfx_world_camera(world);
    gfx_view_make(&camera, 16.0f / 9.0f, &view);
    gfx_cluster_grid_make(&r.grid, world->settings.grid, world->settings.linear_slices,
                          world->settings.first_slice, false, view.tan_x, view.tan_y,
                          view.near_plane, view.virtual_far);
    gfx_cluster_lights_fill(&r.lights, &world->lights, &view);
    assign(&r);
    core_json_int(out, "refs", r.clusters.total);
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ns", core_lab_time(assign, &r, 5e7));
        core_json_number(out, "wall_ns", best_ns(core_clock_ns, assign, &r, 15));
    }
    list_use use = use_of_lists(&r, &world->lights);
    core_json_number(out, "refs_per_fragment", use.refs);
    core_json_number(out, "wasted_per_fragment", use.wasted);
    uint32_t cap = (uint32_t)core_lab_number(c, "cap", 0);
    uint32_t cells = gfx_cluster_cells(&r.grid);
    core_json_number(
        out, "capped_share",
        cap ? (double)gfx_clusters_cap(&r.clusters, cells, cap, GFX_CLUSTER_ALL) / cells : 0.0);
    gfx_clusters_release(&r.clusters);
    gfx_cluster_lights_release(&r.lights);
    core_jobs_destroy(r.jobs);
    gfx_world_destroy(world);
    return true;
}

const core_lab_kernel gfx_lab_cluster = {
    "gfx.cluster", "light assignment: list entries, CPU and wall time of one assignment",
    "method: naive|per_light|simd; n, radius, spots: part of n, grid: XxYxZ, slices: "
    "exponential|linear, cap: of a list, threads, timed",
    run_cluster};

// ---- whole frames ----

typedef struct frame_run {
    gfx_device *device;
    gfx_world *world;
    bool ok;
} frame_run;

static void add_boxes(gfx_world *world) {
    core_rng rng = core_rng_make(2, CORE_RNG_ENGINE);
    gfx_instance_desc desc = {.mesh = gfx_mesh_builtin(world, "box")};
    for (int i = 0; i <= 400; ++i) {
        gfx_instance box = gfx_instance_create(world, &desc);
        core_vec3 p = light_position(&rng);
        float side = 0.5f + 2.5f * core_rng_float(&rng);
        core_vec3 size = i ? core_v3(side, 2.0f * side, side) : core_v3(100.0f, 1.0f, 100.0f);
        p = i ? core_v3(p.x, side, p.z) : core_v3(0.0f, -0.5f, 0.0f);
        gfx_instance_set_transform(world, box, p, core_quat_identity(), size);
    }
}

// Timer queries of software renderers are wrong by factors, so the clock runs round glFinish.
static void draw(void *ctx) {
    frame_run *r = ctx;
    r->ok = gfx_device_render(r->device, r->world) && r->ok;
    glFinish();
}

// Pixels that geometry covers: what plain forward shades, once a light.
static uint32_t covered_pixels(gfx_device *device) {
    uint32_t width, height, covered = 0;
    gfx_device_size(device, &width, &height);
    float *depth = core_alloc((size_t)width * height * sizeof *depth);
    if (gfx_device_read_depth(device, depth)) {
        for (size_t i = 0; i < (size_t)width * height; ++i) {
            covered += depth[i] > 0.0f;
        }
    }
    core_free(depth);
    return covered;
}

static bool run_frame(const core_lab_case *c, core_json *out) {
    core_vfs *vfs = core_vfs_create();
    gfx_device_desc desc = gfx_device_desc_default();
    desc.width = (uint32_t)core_lab_number(c, "width", 640);
    desc.height = (uint32_t)core_lab_number(c, "height", 360);
    desc.vfs = vfs;
    frame_run r = {.ok = core_vfs_mount(vfs, core_lab_text(c, "assets", "assets"), "", false)};
    r.device = r.ok ? gfx_device_create(&desc) : NULL;
    r.world = r.device ? lab_world(c) : NULL;
    if (r.world && gfx_world_set(r.world, "render", core_lab_text(c, "method", "clustered")) &&
        gfx_world_set(r.world, "assign", core_lab_text(c, "assign", "simd"))) {
        add_boxes(r.world);
        draw(&r); // compiles
        if (r.ok && core_lab_number(c, "timed", 0) > 0) {
            int runs = (int)core_lab_number(c, "runs", 5);
            core_json_number(out, "wall_ns", best_ns(core_clock_ns, draw, &r, runs));
            core_json_number(out, "cost_ns", best_ns(core_clock_cpu_ns, draw, &r, runs));
        }
        core_json_string(out, "device", gfx_device_name(r.device));
        core_json_int(out, "light_refs", r.world->stats.light_refs);
        core_json_int(out, "covered_pixels", covered_pixels(r.device));
    } else {
        r.ok = false;
    }
    gfx_world_destroy(r.world);
    gfx_device_destroy(r.device);
    core_vfs_destroy(vfs);
    return r.ok;
}

const core_lab_kernel gfx_lab_frame = {"gfx.frame",
                                       "wall time of one frame, plain forward or clustered",
                                       "method: forward|clustered; assign: naive|per_light|simd; "
                                       "n, radius, width, height, runs, assets, timed",
                                       run_frame};
