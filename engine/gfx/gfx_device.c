// The device: context, targets, GL errors, pictures out.
#include "gfx/gfx_device_internal.h"

#include "core/log.h"

#include <stdio.h>
#include <string.h>

enum { MAX_SIZE = 16384 };

gfx_device_desc gfx_device_desc_default(void) {
    return (gfx_device_desc){.width = 1280, .height = 720, .vsync = true, .cookie = GFX_COOKIE};
}

// Errors fail the call during which they happen; the rest is for the log.
static void GLAD_API_PTR on_gl_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                       GLsizei length, const GLchar *message, const void *user) {
    (void)id, (void)length;
    gfx_device *device = (gfx_device *)user;
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) {
        return; // gfx_shader.c reports these with file and line
    }
    if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) {
        device->gl_errors++;
        core_fail("OpenGL: %s", message);
    } else if (severity == GL_DEBUG_SEVERITY_HIGH) {
        core_log(CORE_LOG_WARN, "OpenGL: %s", message);
    }
}

bool gfx_device_check(gfx_device *device, const char *what, uint32_t errors_before) {
    return device->gl_errors == errors_before ||
           core_fail("%s: %u OpenGL error(s), the last: %s", what,
                     device->gl_errors - errors_before, core_last_error());
}

static bool make_targets(gfx_device *d, uint32_t width, uint32_t height) {
    d->width = width, d->height = height;
    return gfx_targets_resize(d, &d->targets, width, height);
}

static bool check_size(const char *call, uint32_t width, uint32_t height) {
    return (width >= 1 && height >= 1 && width <= MAX_SIZE && height <= MAX_SIZE) ||
           core_fail("%s: size is %ux%u, expected 1..%d each", call, width, height, MAX_SIZE);
}

static void set_up_context(gfx_device *d) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_gl_message, d);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glClearDepth(0.0); // reversed: infinity
    glDisable(GL_DITHER);
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    glCreateVertexArrays(1, &d->empty_vao);
    snprintf(d->name, sizeof d->name, "%s", (const char *)glGetString(GL_RENDERER));
    d->software = strstr(d->name, "llvmpipe") || strstr(d->name, "softpipe");
    glGetIntegerv(GL_MAX_SAMPLES, &d->most_samples);
    d->draw_parameters = GLAD_GL_ARB_shader_draw_parameters;
}

gfx_device *gfx_device_create(const gfx_device_desc *desc) {
    if (!desc || desc->cookie != GFX_COOKIE) {
        core_fail("gfx_device_create: start from gfx_device_desc_default()");
        return NULL;
    }
    if (!check_size("gfx_device_create", desc->width, desc->height)) {
        return NULL;
    }
    gfx_context *context = desc->window ? gfx_context_glfw(desc) : gfx_context_egl(desc);
    if (!context) {
        return NULL;
    }
    gfx_device *d = core_alloc(sizeof *d);
    d->context = context;
    d->vfs = d->shaders.vfs = desc->vfs;
    d->metrics = desc->metrics;
    d->float_target = desc->float_target;
    d->background = desc->background;
    set_up_context(d);
    if (!make_targets(d, desc->width, desc->height)) {
        gfx_device_destroy(d);
        return NULL;
    }
    return d;
}

void gfx_device_destroy(gfx_device *device) {
    if (!device) {
        return;
    }
    gfx_device *d = device;
    d->context->table->make_current(d->context);
    for (int i = 0; i < GFX_FRAMES; ++i) {
        glDeleteSync(d->fence[i]);
    }
    glDeleteQueries(GFX_FRAMES, d->timer);
    gfx_quads_release(&d->quads);
    gfx_marks_release(&d->marks);
    gfx_boards_release(&d->boards);
    gfx_terrain_gpu_release(&d->terrain);
    gfx_instance_gpu_release(&d->instances);
    gfx_geometry_release(&d->geometry);
    gfx_shaders_release(&d->shaders);
    gfx_stream *const streams[] = {&d->view_block,      &d->light_block,   &d->draw_block,
                                   &d->cluster_offsets, &d->cluster_lists, &d->cluster_grid};
    for (size_t i = 0; i < CORE_COUNT_OF(streams); ++i) {
        gfx_stream_release(streams[i]);
    }
    gfx_shadows_release(&d->shadows);
    gfx_environment_release(&d->environment);
    gfx_cluster_gpu_release(&d->cluster_gpu);
    gfx_clusters_release(&d->clusters);
    gfx_cluster_lights_release(&d->cluster_lights);
    gfx_materials_release(&d->materials);
    gfx_textures_release(&d->textures);
    glDeleteTextures(1, &d->dfg_texture);
    glDeleteVertexArrays(1, &d->empty_vao);
    gfx_targets_release(&d->targets);
    gfx_views_release(d);
    gfx_passes_release(d);
    gfx_growing *const arrays[] = {&d->places, &d->visible,  &d->keys,   &d->scratch,
                                   &d->rows,   &d->commands, &d->batches};
    for (size_t i = 0; i < CORE_COUNT_OF(arrays); ++i) {
        gfx_growing_release(arrays[i]);
    }
    d->context->table->destroy(d->context);
    core_free(d);
}

bool gfx_device_resize(gfx_device *device, uint32_t width, uint32_t height) {
    if (!check_size("gfx_device_resize", width, height)) {
        return false;
    }
    if (!device->context->table->make_current(device->context)) {
        return false;
    }
    device->context->table->resize(device->context, width, height);
    return make_targets(device, width, height);
}

bool gfx_device_follow_window(gfx_device *device) {
    uint32_t width, height;
    device->context->table->size(device->context, &width, &height);
    if (width == 0 || height == 0 || (width == device->width && height == device->height)) {
        return true; // minimised, or nothing changed
    }
    return make_targets(device, width, height);
}

void gfx_device_size(const gfx_device *device, uint32_t *width, uint32_t *height) {
    *width = device->width, *height = device->height;
}

void gfx_device_present(gfx_device *device) {
    gfx_device *d = device;
    uint32_t width, height;
    d->context->table->size(d->context, &width, &height);
    if (!d->context->table->window || width == 0 || height == 0) {
        return;
    }
    d->context->table->make_current(d->context);
    glBlitNamedFramebuffer(d->targets.picture.name, 0, 0, 0, (GLint)d->width, (GLint)d->height, 0,
                           0, (GLint)width, (GLint)height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    d->context->table->present(d->context);
}

bool gfx_device_poll(gfx_device *device, gfx_event *out) {
    return device->context->table->poll(device->context, out);
}

void gfx_device_set_cursor(gfx_device *device, gfx_cursor cursor) {
    if (device->context->table->set_cursor) {
        device->context->table->set_cursor(device->context, cursor);
    }
}

bool gfx_device_reload(gfx_device *device) {
    return device->context->table->make_current(device->context) &&
           (int)gfx_shaders_reload(&device->shaders) + (int)gfx_textures_reload(device) == 2;
}

const char *gfx_device_name(const gfx_device *device) { return device->name; }
static size_t target_bytes(const gfx_device *d) {
    const gfx_extra_view *extra = d->extra.data;
    size_t bytes = gfx_targets_bytes(d, &d->targets);
    for (size_t i = 0; i < d->extra.count; ++i) {
        bytes += gfx_targets_bytes(d, &extra[i].targets);
    }
    return bytes;
}

gfx_device_use gfx_device_used(const gfx_device *device) {
    return (gfx_device_use){.passes = device->passes,
                            .shader_variants = device->shaders.count,
                            .target_bytes = target_bytes(device),
                            .loading = gfx_textures_loading(&device->textures),
                            .uploaded_bytes = device->textures.uploaded};
}
bool gfx_device_software(const gfx_device *device) { return device->software; }
