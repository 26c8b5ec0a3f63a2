// Drawing: the device, a frame with overlay, pictures that were asked for. The error screen is the
// script room's: script_draw shows it.
#include <stdio.h>
#include <string.h>

#include "app/lab_ghost.h"
#include "app/overlay.h"
#include "core/file.h"

bool app_device_open(app_run *r, bool window) {
    if (r->device) {
        return true;
    }
    gfx_device_desc desc = gfx_device_desc_default();
    desc.window = window;
    // A picture that is asked for shows its images, however slowly they are read.
    desc.background = window && !r->opt->shot_count && !r->opt->video;
    desc.width = r->width;
    desc.height = r->height;
    desc.title = r->conf.title[0] ? r->conf.title : "corsac";
    desc.vsync = true;
    desc.vfs = r->vfs;
    desc.metrics = r->metrics;
    r->device = gfx_device_create(&desc);
    if (!r->device) {
        return app_fail(r, APP_EXIT_ENVIRONMENT);
    }
    snprintf(r->report.device, sizeof r->report.device, "%s", gfx_device_name(r->device));
    return true;
}

bool app_frame(app_run *r, float alpha) {
    gfx_world *world = scene_gfx(r->scene);
    if (!world) {
        return app_fail(r, APP_EXIT_ENVIRONMENT);
    }
    gfx_world_begin_frame(world);
    core_stage_begin(r->metrics, CORE_STAGE_SCRIPT);
    script_draw(r->script);
    core_stage_end(r->metrics, CORE_STAGE_SCRIPT);
    scene_sync_draw(r->scene, alpha);
    if (r->ghost) {
        r->caption = app_ghost_draw(r->ghost);
    }
    if (r->caption) {
        const float ink[4] = {1.0f, 1.0f, 1.0f, 1.0f}, back[4] = {0, 0, 0, 0.6f};
        gfx_rect(world, 0, 0, (float)r->width, 62.0f, back);
        gfx_print(world, 10, 6, 17.0f, ink, r->caption);
    }
    if (r->overlay) {
        scene_counts(r->scene);
        app_overlay_draw(r);
    }
    r->report.frames++;
    bool ok = gfx_device_render(r->device, world);
    gfx_device_use use = gfx_device_used(r->device);
    r->report.passes = use.passes;
    r->report.shader_variants = use.shader_variants;
    const gfx_pass_use *pass = gfx_device_passes(r->device, &r->report.pass_count);
    memcpy(r->report.pass, pass, r->report.pass_count * sizeof *pass);
    return ok || app_fail(r, APP_EXIT_SCRIPT); // a shader or picture of the game
}

static bool shot_due(const app_run *r, const app_shot *shot, uint64_t step) {
    return step == (shot->step ? shot->step : r->last_step);
}

bool app_frame_wanted(const app_run *r, uint64_t step) {
    bool wanted = r->opt->video != NULL;
    for (uint32_t i = 0; i < r->opt->shot_count; i++) {
        wanted |= shot_due(r, &r->opt->shot[i], step);
    }
    return wanted;
}

bool app_frame_files(app_run *r, uint64_t step) {
    char path[APP_PATH_MAX];
    for (uint32_t i = 0; i < r->opt->shot_count; i++) {
        const app_shot *shot = &r->opt->shot[i];
        snprintf(path, sizeof path, "%.*s", (int)shot->path_length, shot->path);
        if (!shot_due(r, shot, step)) {
            continue;
        }
        if (shot->pass[0] ? !gfx_device_shot_pass(r->device, shot->pass, path)
                          : !gfx_device_shot(r->device, path)) {
            return app_fail(r, APP_EXIT_USAGE);
        }
    }
    if (r->opt->video) {
        snprintf(path, sizeof path, "%s/frame-%06llu.png", r->opt->video, (unsigned long long)step);
        if (!gfx_device_shot(r->device, path)) {
            return app_fail(r, APP_EXIT_USAGE);
        }
    }
    return true;
}
