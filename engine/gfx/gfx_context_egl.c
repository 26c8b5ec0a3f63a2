// EGL without surface, window system or display server: for headless runs and tests.
#include "gfx/gfx_context.h"

#include <glad/egl.h>
#include <glad/gl.h>

#include <string.h>

typedef struct egl_context {
    gfx_context base;
    EGLDisplay display;
    EGLContext context;
    uint32_t width, height;
} egl_context;

static void egl_destroy(gfx_context *context) {
    egl_context *c = (egl_context *)context;
    eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(c->display, c->context);
    core_free(c);
}

static bool egl_make_current(gfx_context *context) {
    egl_context *c = (egl_context *)context;
    return eglMakeCurrent(c->display, EGL_NO_SURFACE, EGL_NO_SURFACE, c->context) ||
           core_fail("environment: EGL refuses its context (0x%x)", (unsigned)eglGetError());
}

static void egl_size(gfx_context *context, uint32_t *width, uint32_t *height) {
    egl_context *c = (egl_context *)context;
    *width = c->width, *height = c->height;
}

static void egl_resize(gfx_context *context, uint32_t width, uint32_t height) {
    egl_context *c = (egl_context *)context;
    c->width = width, c->height = height;
}

static void egl_present(gfx_context *context) { (void)context; }

static bool egl_poll(gfx_context *context, gfx_event *out) {
    (void)context, (void)out;
    return false;
}

static const gfx_context_table egl_table = {.destroy = egl_destroy,
                                            .make_current = egl_make_current,
                                            .size = egl_size,
                                            .resize = egl_resize,
                                            .present = egl_present,
                                            .poll = egl_poll};

static bool client_has(const char *extension) {
    const char *all = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    return all && strstr(all, extension);
}

static EGLDisplay surfaceless_display(void) {
    if (!client_has("EGL_MESA_platform_surfaceless") || !eglGetPlatformDisplayEXT) {
        return EGL_NO_DISPLAY;
    }
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, (void *)EGL_DEFAULT_DISPLAY,
                                    NULL);
}

static bool open_display(egl_context *c) {
    // The first call finds the library and the client functions, the second those of the display.
    if (!gladLoaderLoadEGL(EGL_NO_DISPLAY)) {
        return core_fail("environment: libEGL is missing; install libegl1 and libegl-mesa0");
    }
    c->display = surfaceless_display();
    if (c->display == EGL_NO_DISPLAY || !eglInitialize(c->display, NULL, NULL)) {
        return core_fail("environment: EGL has no surfaceless platform; install libegl-mesa0 and "
                         "libgl1-mesa-dri");
    }
    return gladLoaderLoadEGL(c->display) && eglBindAPI(EGL_OPENGL_API);
}

gfx_context *gfx_context_egl(const gfx_device_desc *desc) {
    egl_context *c = core_alloc(sizeof *c);
    c->base.table = &egl_table;
    c->width = desc->width, c->height = desc->height;
    if (!open_display(c)) {
        core_free(c);
        return NULL;
    }
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 EGL_TRUE,
                                 EGL_NONE};
    c->context = eglCreateContext(c->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (c->context == EGL_NO_CONTEXT) {
        core_fail("environment: EGL gives no OpenGL 4.5 core context (0x%x); install "
                  "libgl1-mesa-dri",
                  (unsigned)eglGetError());
        core_free(c);
        return NULL;
    }
    if (!egl_make_current(&c->base) || !gladLoadGL((GLADloadfunc)eglGetProcAddress)) {
        core_fail("environment: the OpenGL 4.5 functions could not be loaded");
        egl_destroy(&c->base);
        return NULL;
    }
    return &c->base;
}
