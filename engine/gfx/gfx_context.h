// A current OpenGL 4.5 core context with or without a window: EGL surfaceless, or GLFW. Knows
// nothing of what is drawn.
#ifndef GFX_CONTEXT_H
#define GFX_CONTEXT_H

#include "gfx/gfx.h"

typedef struct gfx_context gfx_context;

typedef struct gfx_context_table { // one for each kind of context
    void (*destroy)(gfx_context *context);
    bool (*make_current)(gfx_context *context);
    void (*size)(gfx_context *context, uint32_t *width, uint32_t *height); // pixels; 0: minimised
    void (*resize)(gfx_context *context, uint32_t width, uint32_t height);
    void (*present)(gfx_context *context);
    bool (*poll)(gfx_context *context, gfx_event *out);
    void (*set_cursor)(gfx_context *context, gfx_cursor cursor); // NULL: no window
    bool window;
} gfx_context_table;

struct gfx_context {
    const gfx_context_table *table;
};

// NULL + core_fail that says what is missing and what to install.
gfx_context *gfx_context_egl(const gfx_device_desc *desc);
gfx_context *gfx_context_glfw(const gfx_device_desc *desc);

#endif
