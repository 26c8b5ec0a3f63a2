#include "app/lab_ghost.h"

#include <stdio.h>
#include <string.h>

#include "app/lab_gap.h"
#include "core/clock.h"
#include "phys/lab_observe.h"

#define REFERENCE_SUBSTEPS "64"
#define INSIDE             0.995f // a ghost without error hides inside the live body

struct app_ghost {
    const app_run *live;
    app_options options;
    app_run *run;
    gfx_instance *instance; // [count] in the live scene's drawing, a body's row each
    uint32_t count;
    double live_ms, ghost_ms; // of a step, smoothed
    char caption[256];
};

static void add_setting(app_options *o, const char *name, const char *value) {
    if (o->set_count < APP_MAX_SETS) {
        app_set *set = &o->set[o->set_count++];
        snprintf(set->name, sizeof set->name, "%s", name);
        snprintf(set->value, sizeof set->value, "%s", value);
    }
}

// The live run's options without its outputs, from the same seed.
static void reference_options(app_ghost *g) {
    app_options *o = &g->options;
    *o = *g->live->opt;
    o->headless = true;
    o->hash = o->receipt = o->watch = false;
    o->shot_count = 0;
    o->video = o->audio = o->metrics = o->metrics_csv = o->trace = o->record = o->replay = NULL;
    o->has_seed = true;
    o->seed = g->live->start.seed;
    o->dt = g->live->start.dt;
    add_setting(o, "phys.substeps", REFERENCE_SUBSTEPS);
    add_setting(o, "metrics.accuracy", "off");
}

app_ghost *app_ghost_create(const app_run *live) {
    app_ghost *g = core_alloc(sizeof *g);
    g->live = live;
    reference_options(g);
    g->run = app_run_create(&g->options);
    strcpy(g->run->entry, live->entry);
    if (!app_run_open(g->run)) {
        app_ghost_destroy(g);
        core_fail("F2: the reference world could not be made");
        return NULL;
    }
    g->run->last_step = APP_OPEN_END;
    return g;
}

static void forget_instances(app_ghost *g) {
    gfx_world *world = g->live->scene ? scene_gfx_if(g->live->scene) : NULL;
    for (uint32_t i = 0; world && i < g->count; i++) {
        if (!core_handle_is_null(g->instance[i])) {
            gfx_instance_destroy(world, g->instance[i]);
        }
    }
    core_free(g->instance);
    g->instance = NULL;
    g->count = 0;
}

void app_ghost_destroy(app_ghost *g) {
    if (g) {
        forget_instances(g);
        app_scene_close(g->run);
        app_run_destroy(g->run);
        core_free(g);
    }
}

void app_ghost_step(app_ghost *g, const gfx_event *event, uint32_t events, uint64_t live_ns) {
    memcpy(g->run->input.queue, event, events * sizeof *event);
    g->run->input.queued = events;
    uint64_t start = core_clock_ns();
    app_step(g->run);
    double ghost_ms = (double)(core_clock_ns() - start) * 1e-6, live_ms = (double)live_ns * 1e-6;
    double weight = g->ghost_ms > 0 ? 0.05 : 1;
    g->ghost_ms += weight * (ghost_ms - g->ghost_ms);
    g->live_ms += weight * (live_ms - g->live_ms);
}

static void make_instances(app_ghost *g, const phys_world *bodies, gfx_world *world) {
    forget_instances(g);
    g->count = phys_body_count(bodies);
    g->instance = core_alloc((g->count + 1) * sizeof *g->instance);
    for (uint32_t i = 0; i < g->count; i++) {
        phys_shape_type type;
        core_vec3 half;
        if (phys_body_mass(bodies, phys_body_at(bodies, i)) > 0 &&
            phys_observe_shape(bodies, i, &type, &half)) {
            gfx_instance_desc desc = {
                .mesh = gfx_mesh_builtin(world, type == PHYS_SPHERE ? "sphere" : "box"),
                .color = {0.1f, 0.3f, 1.0f, 1.0f}};
            g->instance[i] = gfx_instance_create(world, &desc);
        }
    }
}

const char *app_ghost_draw(app_ghost *g) {
    gfx_world *world = scene_gfx_if(g->live->scene);
    const phys_world *bodies = scene_phys_if(g->run->scene);
    if (!world || !bodies) {
        return NULL;
    }
    if (g->count != phys_body_count(bodies)) {
        make_instances(g, bodies, world);
    }
    phys_pose_view pose = phys_world_poses(bodies);
    for (uint32_t i = 0; i < g->count; i++) {
        phys_shape_type type;
        core_vec3 half;
        if (!core_handle_is_null(g->instance[i]) && phys_observe_shape(bodies, i, &type, &half)) {
            core_quat q = {pose.qx[i], pose.qy[i], pose.qz[i], pose.qw[i]};
            gfx_instance_set_transform(world, g->instance[i],
                                       core_v3(pose.px[i], pose.py[i], pose.pz[i]), q,
                                       core_v3_scale(half, 2 * INSIDE));
        }
    }
    app_gap gap = app_gap_measure(g->live->scene, g->run->scene);
    snprintf(g->caption, sizeof g->caption,
             "live %.3g ms a step\nghost (blue): " REFERENCE_SUBSTEPS
             " sub-steps, %.3g ms\napart: mean %.3g mm, max %.3g mm",
             g->live_ms, g->ghost_ms, gap.mean_mm, gap.max_mm);
    return g->caption;
}
