// A GLFW window and its events.
#include "gfx/gfx_context.h"

#include <glad/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <stdatomic.h>

enum { QUEUE = 256 }; // events between two polls; the oldest are dropped beyond

typedef struct glfw_context {
    gfx_context base;
    GLFWwindow *window;
    gfx_event event[QUEUE];
    uint32_t head, count;
    int pad; // joystick that is the gamepad, -1: none
    GLFWgamepadstate pad_state;
} glfw_context;

// GLFW is one per process: the last window to close ends it.
static atomic_int open_windows;

static void push(GLFWwindow *window, gfx_event e) {
    glfw_context *c = glfwGetWindowUserPointer(window);
    if (c->count == QUEUE) {
        c->head = (c->head + 1) % QUEUE;
        c->count--;
    }
    c->event[(c->head + c->count++) % QUEUE] = e;
}

static void on_key(GLFWwindow *w, int key, int scancode, int action, int mods) {
    (void)scancode, (void)mods;
    push(w, (gfx_event){.type = GFX_EVENT_KEY, .code = key, .pressed = action});
}

static void on_text(GLFWwindow *w, unsigned codepoint) {
    push(w, (gfx_event){.type = GFX_EVENT_TEXT, .code = (int32_t)codepoint, .pressed = 1});
}

static void on_button(GLFWwindow *w, int button, int action, int mods) {
    (void)mods;
    double x, y;
    glfwGetCursorPos(w, &x, &y);
    push(w, (gfx_event){GFX_EVENT_MOUSE_BUTTON, button, action, (float)x, (float)y});
}

static void on_move(GLFWwindow *w, double x, double y) {
    push(w, (gfx_event){.type = GFX_EVENT_MOUSE_MOVE, .x = (float)x, .y = (float)y});
}

static void on_scroll(GLFWwindow *w, double x, double y) {
    push(w, (gfx_event){.type = GFX_EVENT_SCROLL, .x = (float)x, .y = (float)y});
}

static void on_resize(GLFWwindow *w, int width, int height) {
    push(w, (gfx_event){.type = GFX_EVENT_RESIZE, .x = (float)width, .y = (float)height});
}

static void on_focus(GLFWwindow *w, int focused) {
    push(w, (gfx_event){.type = GFX_EVENT_FOCUS, .pressed = focused});
}

static void on_close(GLFWwindow *w) { push(w, (gfx_event){.type = GFX_EVENT_CLOSE}); }

static void release_glfw(void) {
    if (atomic_fetch_sub(&open_windows, 1) == 1) {
        glfwTerminate();
    }
}

static void glfw_destroy(gfx_context *context) {
    glfw_context *c = (glfw_context *)context;
    glfwDestroyWindow(c->window);
    release_glfw();
    core_free(c);
}

static bool glfw_make_current(gfx_context *context) {
    glfwMakeContextCurrent(((glfw_context *)context)->window);
    return true;
}

static void glfw_size(gfx_context *context, uint32_t *width, uint32_t *height) {
    glfw_context *c = (glfw_context *)context;
    int w, h;
    glfwGetFramebufferSize(c->window, &w, &h);
    bool hidden = glfwGetWindowAttrib(c->window, GLFW_ICONIFIED) || w <= 0 || h <= 0;
    *width = hidden ? 0 : (uint32_t)w;
    *height = hidden ? 0 : (uint32_t)h;
}

static void glfw_resize(gfx_context *context, uint32_t width, uint32_t height) {
    glfwSetWindowSize(((glfw_context *)context)->window, (int)width, (int)height);
}

static void glfw_present(gfx_context *context) {
    glfwSwapBuffers(((glfw_context *)context)->window);
}

// GLFW has no events for gamepads: what changed since the last poll becomes events. One gamepad is
// heard, the first that is plugged in.
static void poll_pad(glfw_context *c) {
    GLFWgamepadstate now = {0};
    if (c->pad >= 0 && !glfwGetGamepadState(c->pad, &now)) {
        c->pad = -1;
        push(c->window, (gfx_event){.type = GFX_EVENT_PAD, .pressed = 0});
    }
    for (int i = GLFW_JOYSTICK_1; c->pad < 0 && i <= GLFW_JOYSTICK_LAST; i++) {
        if (glfwJoystickIsGamepad(i) && glfwGetGamepadState(i, &now)) {
            c->pad = i;
            c->pad_state = (GLFWgamepadstate){0};
            push(c->window, (gfx_event){.type = GFX_EVENT_PAD, .pressed = 1});
        }
    }
    if (c->pad < 0) {
        return;
    }
    for (int i = 0; i <= GLFW_GAMEPAD_BUTTON_LAST; i++) {
        if (now.buttons[i] != c->pad_state.buttons[i]) {
            push(c->window, (gfx_event){GFX_EVENT_PAD_BUTTON, i, now.buttons[i], 0, 0});
        }
    }
    for (int i = 0; i <= GLFW_GAMEPAD_AXIS_LAST; i++) {
        if (now.axes[i] != c->pad_state.axes[i]) {
            push(c->window, (gfx_event){GFX_EVENT_PAD_AXIS, i, 0, now.axes[i], 0});
        }
    }
    c->pad_state = now;
}

static void glfw_set_cursor(gfx_context *context, gfx_cursor cursor) {
    static const int modes[] = {GLFW_CURSOR_NORMAL, GLFW_CURSOR_HIDDEN, GLFW_CURSOR_DISABLED};
    glfwSetInputMode(((glfw_context *)context)->window, GLFW_CURSOR, modes[cursor]);
}

static bool glfw_poll(gfx_context *context, gfx_event *out) {
    glfw_context *c = (glfw_context *)context;
    if (c->count == 0) {
        glfwPollEvents();
        poll_pad(c);
    }
    if (c->count == 0) {
        return false;
    }
    *out = c->event[c->head];
    c->head = (c->head + 1) % QUEUE;
    c->count--;
    return true;
}

static const gfx_context_table glfw_table = {.destroy = glfw_destroy,
                                             .make_current = glfw_make_current,
                                             .size = glfw_size,
                                             .resize = glfw_resize,
                                             .present = glfw_present,
                                             .poll = glfw_poll,
                                             .set_cursor = glfw_set_cursor,
                                             .window = true};

static GLFWwindow *open_window(const gfx_device_desc *desc) {
    glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0); // the picture is drawn elsewhere and copied
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    return glfwCreateWindow((int)desc->width, (int)desc->height,
                            desc->title ? desc->title : "corsac", NULL, NULL);
}

gfx_context *gfx_context_glfw(const gfx_device_desc *desc) {
    const char *why = "no display";
    if (!glfwInit()) {
        glfwGetError(&why);
        core_fail("environment: no window can be opened (%s); set DISPLAY, run under xvfb-run, or "
                  "use --headless",
                  why);
        return NULL;
    }
    atomic_fetch_add(&open_windows, 1);
    GLFWwindow *window = open_window(desc);
    if (!window) {
        glfwGetError(&why);
        core_fail("environment: no OpenGL 4.5 core window (%s); install libgl1-mesa-dri", why);
        release_glfw();
        return NULL;
    }
    glfw_context *c = core_alloc(sizeof *c);
    c->base.table = &glfw_table;
    c->window = window;
    c->pad = -1;
    glfwSetWindowUserPointer(window, c);
    glfwSetKeyCallback(window, on_key);
    glfwSetCharCallback(window, on_text);
    glfwSetMouseButtonCallback(window, on_button);
    glfwSetCursorPosCallback(window, on_move);
    glfwSetScrollCallback(window, on_scroll);
    glfwSetFramebufferSizeCallback(window, on_resize);
    glfwSetWindowFocusCallback(window, on_focus);
    glfwSetWindowCloseCallback(window, on_close);
    glfwMakeContextCurrent(window);
    if (!gladLoadGL((GLADloadfunc)glfwGetProcAddress)) {
        core_fail("environment: the OpenGL 4.5 functions could not be loaded");
        glfw_destroy(&c->base);
        return NULL;
    }
    glfwSwapInterval(desc->vsync ? 1 : 0);
    return &c->base;
}
