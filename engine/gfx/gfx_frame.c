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
    gfx_passes_begin_turn(d);
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
    d->timing = true;
}

static void end_turn(gfx_device *d) {
    gfx_passes_end_turn(d);
    if (d->timing) {
        glEndQuery(GL_TIME_ELAPSED);
        d->timing = false;
    }
    d->fence[d->frame] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

// ---- blocks ----

static void write_post(const gfx_settings *s, struct gfx_view_block *b) {
    const gfx_glsl_vec4 ao = {s->ao, s->ao_radius, (float)(int)s->ao_slices,
                              (float)(int)s->ao_steps};
    const gfx_glsl_vec4 fog = {s->fog, s->fog_falloff, s->fog_base};
    const gfx_glsl_vec4 bloom = {s->bloom, s->bloom_threshold};
    const gfx_glsl_vec4 grade = {s->contrast, s->saturation, s->key, s->adapt};
    memcpy(b->ao, ao, sizeof ao);
    memcpy(b->fog, fog, sizeof fog);
    memcpy(b->bloom, bloom, sizeof bloom);
    memcpy(b->grade, grade, sizeof grade);
    memcpy(b->fog_color, s->fog_color, sizeof s->fog_color);
    memcpy(b->lift, s->lift, sizeof s->lift);
    memcpy(b->gain, s->gain, sizeof s->gain);
}

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
    b->lens[2] = (float)(int)s->shadow_taps, b->lens[3] = s->shadow_bias;
    write_post(s, b);
    gfx_environment_write(d, world, b);
    gfx_stream_bind(&d->view_block, GL_UNIFORM_BUFFER, GFX_UBO_VIEW, sizeof *b, d->frame);
}

// For what knows pixels only.
static void upload_screen(gfx_device *d) {
    struct gfx_view_block *b = gfx_stream_begin(&d->view_block, sizeof *b, d->frame);
    float w = (float)d->width, h = (float)d->height;
    *b = (struct gfx_view_block){.viewport = {w, h, 1.0f / w, 1.0f / h}};
    gfx_stream_bind(&d->view_block, GL_UNIFORM_BUFFER, GFX_UBO_VIEW, sizeof *b, d->frame);
}

// ---- passes ----

typedef struct frame { // one view that is drawn
    gfx_device *device;
    gfx_world *world;
    gfx_targets *targets;
    gfx_view view;
    gfx_draw_list list;
    gfx_terrain_list terrain;
    gfx_light_upload lights;
    uint32_t features; // of scene.frag
} frame;

static uint32_t scene_features(const frame *f) {
    const gfx_settings *s = &f->world->settings;
    uint32_t features = f->lights.clustered ? GFX_FEATURE_CLUSTERED : 0;
    features |= f->world->environment_set ? GFX_FEATURE_IBL : 0;
    if (f->device->shadows.count) {
        features |= GFX_FEATURE_SHADOWS;
        features |= s->shadows == GFX_SHADOWS_SOFT ? GFX_FEATURE_SOFT_SHADOWS : 0;
    }
    if (s->debug) {
        return features | GFX_FEATURE_DEBUG;
    }
    features |= f->targets->ao.name ? GFX_FEATURE_AO : 0;
    features |= s->fog > 0.0f ? GFX_FEATURE_FOG : 0;
    return features;
}

static bool wants_overdraw(const frame *f) {
    return f->world->settings.debug == GFX_DEBUG_OVERDRAW;
}
static bool wants_depth(const frame *f) { // ambient occlusion reads it before anything is shaded
    return (f->world->settings.prepass && !wants_overdraw(f)) || f->targets->ao.name;
}
static bool wants_ambient(const frame *f) { return f->targets->ao.name != 0; }
static bool wants_sky(const frame *f) {
    return f->world->environment_set && !f->world->settings.debug;
}
static bool wants_fog(const frame *f) { return f->features & GFX_FEATURE_FOG; }
static bool wants_blended(const frame *f) { return f->list.batches > f->list.opaque; }
static bool wants_resolve(const frame *f) { return f->targets->samples.name != 0; }
static bool always(const frame *f) {
    (void)f;
    return true;
}

static const gfx_target *scene_target(const frame *f) {
    return wants_resolve(f) ? &f->targets->samples : &f->targets->hdr;
}

static void begin_scene(frame *f) {
    const gfx_target *target = scene_target(f);
    glBindFramebuffer(GL_FRAMEBUFFER, target->name);
    glViewport(0, 0, (GLsizei)target->width, (GLsizei)target->height);
    glDisable(GL_BLEND);
    glEnable(GL_CULL_FACE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
}

static bool pass_clear(frame *f) {
    const float *c = f->world->background;
    const float clear[4] = {c[0], c[1], c[2], 1.0f}, depth = 0.0f;
    begin_scene(f);
    glClearNamedFramebufferfv(scene_target(f)->name, GL_COLOR, 0, clear);
    glClearNamedFramebufferfv(scene_target(f)->name, GL_DEPTH, 0, &depth);
    return true;
}

static bool pass_depth(frame *f) {
    f->device->passes++;
    glNamedFramebufferDrawBuffer(scene_target(f)->name, GL_NONE);
    const uint32_t features = GFX_FEATURE_DEPTH_ONLY;
    bool ok = gfx_draws_submit(f->device, f->world, &f->list, "depth.frag", features) &&
              gfx_terrains_submit(f->device, f->world, &f->terrain, "depth.frag", features);
    glNamedFramebufferDrawBuffer(scene_target(f)->name, GL_COLOR_ATTACHMENT0);
    return ok;
}

static void resolve(const frame *f, GLbitfield what) {
    GLint w = (GLint)f->targets->width, h = (GLint)f->targets->height;
    glBlitNamedFramebuffer(f->targets->samples.name, f->targets->hdr.name, 0, 0, w, h, 0, 0, w, h,
                           what, GL_NEAREST);
}

static bool pass_ambient(frame *f) {
    if (wants_resolve(f)) {
        resolve(f, GL_DEPTH_BUFFER_BIT);
    }
    return gfx_post_ambient(f->device, f->world, f->targets);
}

static bool pass_scene(frame *f) {
    gfx_device *d = f->device;
    d->passes++;
    begin_scene(f);
    glBindTextureUnit(GFX_TEX_DFG, d->dfg_texture);
    glBindTextureUnit(GFX_TEX_ENVIRONMENT, d->environment.filtered);
    if (wants_overdraw(f)) { // every fragment adds its share
        glDisable(GL_DEPTH_TEST);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
    } else if (wants_depth(f)) {
        glDepthFunc(GL_EQUAL);
        glDepthMask(GL_FALSE);
    }
    return gfx_draws_submit(d, f->world, &f->list, "scene.frag", f->features) &&
           gfx_terrains_submit(d, f->world, &f->terrain, "scene.frag", f->features);
}

static bool pass_sky(frame *f) { return gfx_environment_draw(f->device, f->world); }

// Over what is there, reading depth and leaving it; premultiplied, so that highlights stay on clear
// glass.
static void begin_blending(void) {
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
}

static bool pass_fog(frame *f) {
    gfx_device *d = f->device;
    GLuint program = gfx_shaders_get(&d->shaders, "sky.vert", "fog.frag", 0);
    if (!program) {
        return false;
    }
    d->passes++;
    begin_blending();
    glDepthFunc(GL_EQUAL); // where depth is still infinity
    glUseProgram(program);
    glBindVertexArray(d->empty_vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
    return true;
}

// From far to near. Occlusion is of the surfaces behind, not of these.
static bool pass_blended(frame *f) {
    f->device->passes++;
    begin_blending();
    glDepthFunc(GL_GREATER);
    return gfx_draws_submit_blended(f->device, f->world, &f->list,
                                    f->features & ~(uint32_t)GFX_FEATURE_AO);
}

static bool wants_boards(const frame *f) { return gfx_boards_wanted(f->world); }
static bool pass_boards(frame *f) {
    f->device->passes++;
    begin_blending();
    glDepthFunc(GL_GREATER);
    return gfx_boards_draw(f->device, f->world, &f->view);
}

static bool wants_marks(const frame *f) { return gfx_marks_wanted(f->world); }
static bool pass_marks(frame *f) {
    f->device->passes++;
    begin_blending();
    glDepthFunc(GL_GREATER);
    return gfx_marks_draw(f->device, f->world);
}

static bool pass_resolve(frame *f) {
    f->device->passes++;
    resolve(f, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    return true;
}

static bool pass_finish(frame *f) {
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    return gfx_post_finish(f->device, f->world, f->targets);
}

// A view is drawn by these, in this order, each if it is wanted.
static const struct {
    const char *name;
    bool (*wanted)(const frame *f);
    bool (*draw)(frame *f);
} passes[] = {
    {"clear", always, pass_clear},
    {"depth", wants_depth, pass_depth},
    {"occlusion", wants_ambient, pass_ambient},
    {"scene", always, pass_scene},
    {"sky", wants_sky, pass_sky},
    {"fog", wants_fog, pass_fog},
    {"blended", wants_blended, pass_blended},
    {"boards", wants_boards, pass_boards},
    {"lines", wants_marks, pass_marks},
    {"resolve", wants_resolve, pass_resolve},
    {NULL, always, pass_finish}, // which names its own
};

static bool draw_passes(frame *f) {
    bool ok = true;
    for (size_t i = 0; i < CORE_COUNT_OF(passes) && ok; ++i) {
        if (passes[i].wanted(f)) {
            if (passes[i].name) {
                gfx_pass_begin(f->device, passes[i].name);
            }
            ok = passes[i].draw(f);
        }
    }
    return ok;
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

static bool draw_view(gfx_device *d, gfx_world *world, const gfx_camera *camera,
                      gfx_targets *targets) {
    frame f = {.device = d, .world = world, .targets = targets};
    d->width = targets->width, d->height = targets->height;
    gfx_view_make(camera, (float)targets->width / (float)targets->height, &f.view);
    core_stage_begin(d->metrics, CORE_STAGE_GFX_CULL);
    bool ok = gfx_targets_fit(d, world, targets) && gfx_geometry_update(&d->geometry, world);
    if (ok) {
        gfx_textures_update(d, world);
        gfx_materials_update(d, world);
        gfx_draws_begin(d, world, &f.view);
        gfx_terrains_begin(d, world, &f.view);
        gfx_draws_add_view(d, world, &f.view, &f.list);
        gfx_terrains_add_view(d, world, &f.view, &f.terrain);
        gfx_shadows_plan(d, world, &f.view);
        gfx_draws_upload(d, world);
        gfx_terrains_upload(d, world);
        world->stats.triangles += f.list.triangles + f.terrain.triangles;
    }
    core_stage_end(d->metrics, CORE_STAGE_GFX_CULL);
    if (!ok) {
        return false;
    }
    core_stage_begin(d->metrics, CORE_STAGE_GFX_CLUSTER);
    ok = gfx_lights_upload(d, world, &f.view, &f.lights);
    core_stage_end(d->metrics, CORE_STAGE_GFX_CLUSTER);
    core_stage_begin(d->metrics, CORE_STAGE_GFX_DRAW);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GFX_SSBO_MATERIALS, d->materials.buffer);
    if (d->shadows.count) {
        gfx_pass_begin(d, "shadows");
    }
    ok = ok && gfx_shadows_draw(d, world) && gfx_environment_update(d, world);
    upload_view(d, world, &f.view, &f.lights);
    f.features = scene_features(&f);
    ok = ok && draw_passes(&f);
    core_stage_end(d->metrics, CORE_STAGE_GFX_DRAW);
    return ok;
}

static bool draw_screen(gfx_device *d, gfx_world *world) {
    if (world->commands.count) {
        gfx_pass_begin(d, "2d");
    }
    gfx_post_begin(d, &d->targets.picture);
    return gfx_quads_draw(d, world);
}

// Each view has a turn of the streams of its own.
static bool draw_in_turn(gfx_device *d, gfx_world *world, const gfx_camera *camera,
                         gfx_targets *targets, bool last) {
    begin_turn(d);
    begin_timer(d);
    bool ok = draw_view(d, world, camera, targets);
    d->width = d->targets.width, d->height = d->targets.height;
    if (last) {
        ok = ok && draw_screen(d, world);
    }
    end_turn(d);
    return ok;
}

static bool draw_extra(gfx_device *d, gfx_world *world, uint32_t row) {
    const gfx_viewport_store *s = &world->viewports.store[row];
    bool ok = draw_in_turn(d, world, &s->camera, gfx_views_targets(d, world, row), false);
    gfx_views_place(d, world, row);
    return ok;
}

// Views that are textures, then those of the picture: further ones in place of the world's camera.
static bool draw_views(gfx_device *d, gfx_world *world) {
    uint32_t count = world->viewports_made ? core_columns_count(&world->viewports.set) : 0;
    bool ok = gfx_views_fit(d, world), shared = false;
    for (uint32_t i = 0; i < count && ok; ++i) {
        bool texture = world->viewports.store[i].target[0] != 0;
        shared |= !texture;
        ok = !texture || draw_extra(d, world, i);
    }
    gfx_camera camera = gfx_world_camera_or_default(world);
    if (!shared || !ok) {
        return ok && draw_in_turn(d, world, &camera, &d->targets, true);
    }
    const float black[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    glClearNamedFramebufferfv(d->targets.picture.name, GL_COLOR, 0, black);
    for (uint32_t i = 0; i < count && ok; ++i) {
        if (!world->viewports.store[i].target[0]) {
            ok = draw_extra(d, world, i);
        }
    }
    begin_turn(d); // for what is drawn over all of them
    begin_timer(d);
    upload_screen(d);
    ok = ok && draw_screen(d, world);
    end_turn(d);
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
    bool ok = (d->dfg_texture || make_dfg(d)) && draw_views(d, world);
    return ok && gfx_device_check(d, "gfx_device_render", errors);
}
