// One frame: cull, light, draw, tone map, screen-space quads.
#include "gfx/gfx_device_internal.h"

#include "core/clock.h"

#include <string.h>

// Waits until the GPU is done with this turn's stream segments.
static void begin_turn(gfx_device *d) {
    d->frame = (d->frame + 1) % GFX_FRAMES;
    if (d->fence[d->frame]) {
        glClientWaitSync(d->fence[d->frame], GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
        glDeleteSync(d->fence[d->frame]);
        d->fence[d->frame] = NULL;
    }
}

// GPU time of the frame that used this turn before. Timer queries of software renderers are wrong
// by factors of 5 to 7: their figure stays 0.
static void begin_timer(gfx_device *d) {
    if (d->software || !d->metrics) {
        return;
    }
    if (!d->timer[d->frame]) {
        glCreateQueries(GL_TIME_ELAPSED, 1, &d->timer[d->frame]);
    } else {
        GLuint64 ns = 0;
        glGetQueryObjectui64v(d->timer[d->frame], GL_QUERY_RESULT, &ns);
        core_stage_add_ns(d->metrics, CORE_STAGE_GFX_GPU, ns);
    }
    glBeginQuery(GL_TIME_ELAPSED, d->timer[d->frame]);
}

static void end_turn(gfx_device *d) {
    if (d->timer[d->frame]) {
        glEndQuery(GL_TIME_ELAPSED);
    }
    d->fence[d->frame] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

// ---- blocks ----

static void upload_view(gfx_device *d, const gfx_world *world, const gfx_view *v,
                        const gfx_light_upload *lights) {
    struct gfx_view_block *b = gfx_stream_begin(&d->view_block, sizeof *b, d->frame);
    const gfx_settings *s = &world->settings;
    const gfx_cluster_grid *g = &lights->grid;
    const float *a = world->ambient;
    float w = (float)d->width, h = (float)d->height;
    *b = (struct gfx_view_block){
        .camera = {v->position.x, v->position.y, v->position.z,
                   v->orthographic ? 0.0f : v->near_plane},
        .viewport = {w, h, 1.0f / w, 1.0f / h},
        .ambient_sky = {a[0], a[1], a[2], s->debug ? 1.0f : s->exposure},
        .ambient_ground = {0.4f * a[0], 0.4f * a[1], 0.4f * a[2], 0.0f},
        .depth_range = {v->near_plane, v->virtual_far, v->virtual_far, 0.0f},
        .light_count = {lights->directional, lights->local,
                        (uint32_t)(s->debug ? GFX_TONEMAP_LINEAR : s->tonemap), (uint32_t)s->debug},
        .cluster_grid = {g->columns, g->rows, g->slices, g->linear},
        .cluster_scale = {(float)g->columns / w, (float)g->rows / h, g->scale, g->bias},
    };
    memcpy(b->view_proj, v->view_projection.m, sizeof b->view_proj);
    memcpy(b->view, v->view.m, sizeof b->view);
    b->lens[0] = v->tan_x, b->lens[1] = v->tan_y;
    gfx_environment_write(d, world, b);
    gfx_stream_bind(&d->view_block, GL_UNIFORM_BUFFER, GFX_UBO_VIEW, sizeof *b, d->frame);
}

// ---- passes ----

static uint32_t scene_features(const gfx_device *d, const gfx_world *world, bool clustered) {
    uint32_t features = clustered ? GFX_FEATURE_CLUSTERED : 0;
    features |= world->environment_set ? GFX_FEATURE_IBL : 0;
    features |= world->settings.debug ? GFX_FEATURE_DEBUG : 0;
    if (d->shadows.count) {
        features |= GFX_FEATURE_SHADOWS;
        features |= world->settings.shadows == GFX_SHADOWS_SOFT ? GFX_FEATURE_SOFT_SHADOWS : 0;
    }
    return features;
}

// Over what is there, from far to near, reading depth and leaving it.
static bool pass_blended(gfx_device *d, gfx_world *world, const gfx_draw_list *list,
                         uint32_t features) {
    d->passes++;
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA); // premultiplied: highlights stay on clear glass
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    bool ok = gfx_draws_submit_blended(d, world, list, features);
    glDisable(GL_BLEND);
    return ok;
}

static bool pass_scene(gfx_device *d, gfx_world *world, const gfx_draw_list *list,
                       uint32_t features) {
    const float *c = world->background;
    const float clear[4] = {c[0], c[1], c[2], 1.0f}, depth = 0.0f;
    glBindTextureUnit(GFX_TEX_DFG, d->dfg_texture);
    glBindTextureUnit(GFX_TEX_ENVIRONMENT, d->environment.filtered);
    glBindFramebuffer(GL_FRAMEBUFFER, d->hdr_target);
    glViewport(0, 0, (GLsizei)d->width, (GLsizei)d->height);
    glDisable(GL_BLEND);
    glEnable(GL_CULL_FACE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(d->hdr_target, GL_COLOR, 0, clear);
    glClearNamedFramebufferfv(d->hdr_target, GL_DEPTH, 0, &depth);
    d->passes++;
    if (world->settings.debug == GFX_DEBUG_OVERDRAW) { // every fragment adds its share
        glDisable(GL_DEPTH_TEST);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
    } else if (world->settings.prepass) {
        d->passes++;
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        bool ok = gfx_draws_submit(d, world, list, "depth.frag", GFX_FEATURE_DEPTH_ONLY);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDepthFunc(GL_EQUAL);
        glDepthMask(GL_FALSE);
        if (!ok) {
            return false;
        }
    }
    bool ok = gfx_draws_submit(d, world, list, "scene.frag", features);
    if (world->environment_set && !world->settings.debug) {
        ok = ok && gfx_environment_draw(d, world);
    }
    if (ok && list->batches > list->opaque) {
        ok = pass_blended(d, world, list, features);
    }
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    return ok;
}

static bool pass_tonemap(gfx_device *d) {
    d->passes++;
    GLuint program = gfx_shaders_get(&d->shaders, "fullscreen.vert", "tonemap.frag", 0);
    if (!program) {
        return false;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, d->ldr_target);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(program);
    glBindVertexArray(d->empty_vao);
    glBindTextureUnit(GFX_TEX_HDR, d->hdr_texture);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return true;
}

// The albedo table of brdf.glsl, made once.
static bool make_dfg(gfx_device *d) {
    GLuint program = gfx_shaders_get(&d->shaders, "fullscreen.vert", "dfg.frag", 0), target;
    if (!program) {
        return false;
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &d->dfg_texture);
    glTextureStorage2D(d->dfg_texture, 1, GL_RG16F, GFX_DFG_SIZE, GFX_DFG_SIZE);
    glTextureParameteri(d->dfg_texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(d->dfg_texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(d->dfg_texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glCreateFramebuffers(1, &target);
    glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, d->dfg_texture, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, GFX_DFG_SIZE, GFX_DFG_SIZE);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(program);
    glBindVertexArray(d->empty_vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDeleteFramebuffers(1, &target);
    return true;
}

static bool draw_world(gfx_device *d, gfx_world *world) {
    gfx_view view;
    gfx_camera camera = gfx_world_camera_or_default(world);
    gfx_view_make(&camera, (float)d->width / (float)d->height, &view);
    gfx_light_upload lights;
    gfx_draw_list list;
    core_stage_begin(d->metrics, CORE_STAGE_GFX_CULL);
    bool ok = gfx_geometry_update(&d->geometry, world);
    if (ok) {
        gfx_materials_update(d, world);
        gfx_draws_begin(d, world, &view);
        gfx_draws_add_view(d, world, &view, &list);
        gfx_shadows_plan(d, world, &view);
        gfx_draws_upload(d, world);
        world->stats.triangles = list.triangles;
    }
    core_stage_end(d->metrics, CORE_STAGE_GFX_CULL);
    if (!ok) {
        return false;
    }
    core_stage_begin(d->metrics, CORE_STAGE_GFX_CLUSTER);
    ok = gfx_lights_upload(d, world, &view, &lights);
    core_stage_end(d->metrics, CORE_STAGE_GFX_CLUSTER);
    core_stage_begin(d->metrics, CORE_STAGE_GFX_DRAW);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GFX_SSBO_MATERIALS, d->materials.buffer);
    ok = ok && gfx_shadows_draw(d, world) && gfx_environment_update(d, world);
    upload_view(d, world, &view, &lights);
    ok = ok && pass_scene(d, world, &list, scene_features(d, world, lights.clustered)) &&
         pass_tonemap(d) && gfx_quads_draw(d, world);
    core_stage_end(d->metrics, CORE_STAGE_GFX_DRAW);
    return ok;
}

bool gfx_device_render(gfx_device *device, gfx_world *world) {
    gfx_device *d = device;
    uint32_t errors = d->gl_errors;
    world->stats = (gfx_stats){0};
    d->passes = 0;
    if (world->settings.render == GFX_RENDER_NONE) {
        return true;
    }
    if (!d->context->table->make_current(d->context) || !gfx_device_follow_window(d)) {
        return false;
    }
    begin_turn(d);
    begin_timer(d);
    bool ok = (d->dfg_texture || make_dfg(d)) && draw_world(d, world);
    end_turn(d);
    return ok && gfx_device_check(d, "gfx_device_render", errors);
}
