// Rendering. Two halves: gfx_world is plain data (lights, instances, materials, camera; no GL) and
// exists headless at no cost; gfx_device owns GL and draws worlds. Conventions: design page 8.
#ifndef GFX_GFX_H
#define GFX_GFX_H

#include "core/columns.h"
#include "core/data.h"
#include "core/jobs.h"
#include "core/metrics.h"
#include "core/vfs.h"

typedef struct gfx_world gfx_world;
typedef struct gfx_device gfx_device;
typedef core_handle gfx_light;
typedef core_handle gfx_mesh;     // geometry, shared by instances
typedef core_handle gfx_instance; // one drawn thing
typedef core_handle gfx_material;

typedef struct gfx_world_desc {
    core_jobs *jobs;
    core_metrics *metrics;
    uint32_t max_instances, max_lights; // default 1 << 20, 1 << 17
    uint32_t cookie;
} gfx_world_desc;
gfx_world_desc gfx_world_desc_default(void);
gfx_world *gfx_world_create(const gfx_world_desc *desc);
void gfx_world_destroy(gfx_world *world);
size_t gfx_world_bytes(const gfx_world *world);
void gfx_world_counts(const gfx_world *world,
                      core_metrics *metrics); // lights, clusters, light_refs, draws, triangles
// Settings by name ("render", "clusters", "exposure", ...): --set gfx.NAME=VALUE.
bool gfx_world_set(gfx_world *world, const char *name, const char *value);

typedef enum gfx_light_type { GFX_POINT, GFX_SPOT, GFX_DIRECTIONAL } gfx_light_type;
typedef struct gfx_light_desc {
    gfx_light_type type;
    core_vec3 position, direction; // direction: unit, where the light goes
    float color[3];                // linear
    float intensity;    // point, spot: W/sr-like radiant intensity; directional: irradiance
    float radius;       // m, > 0: the light is zero beyond
    float inner, outer; // spot: half angles, radians
    uint32_t cookie;
} gfx_light_desc;
gfx_light_desc gfx_light_desc_default(gfx_light_type type);
gfx_light gfx_light_create(gfx_world *world, const gfx_light_desc *desc);
bool gfx_light_destroy(gfx_world *world, gfx_light light);
bool gfx_light_set_position(gfx_world *world, gfx_light light, core_vec3 position);
bool gfx_light_set_color(gfx_world *world, gfx_light light, float r, float g, float b,
                         float intensity);
void gfx_world_set_ambient(gfx_world *world, float r, float g, float b);
void gfx_world_set_background(gfx_world *world, float r, float g, float b);

// Built-in unit meshes: "box" (edge 1), "sphere" (radius 0.5), "capsule" (radius 0.5, segment 1),
// "cylinder" (radius 0.5, height 1), "plane" (1 x 1, +Y). Null + core_fail names the nearest.
gfx_mesh gfx_mesh_builtin(gfx_world *world, const char *name);
gfx_mesh gfx_mesh_create(gfx_world *world, const core_mesh_data *data); // copies
bool gfx_mesh_destroy(gfx_world *world, gfx_mesh mesh);

typedef struct gfx_material_desc {
    core_material_data data;
    uint32_t cookie;
} gfx_material_desc;
gfx_material gfx_material_create(gfx_world *world, const gfx_material_desc *desc);

typedef struct gfx_instance_desc {
    gfx_mesh mesh;
    gfx_material material; // null: default grey
    float color[4];        // multiplies the base colour; zero = white
    uint32_t cookie;
} gfx_instance_desc;
gfx_instance gfx_instance_create(gfx_world *world, const gfx_instance_desc *desc);
bool gfx_instance_destroy(gfx_world *world, gfx_instance instance);
bool gfx_instance_set_color(gfx_world *world, gfx_instance instance, float r, float g, float b,
                            float a);
// World transform used by the next frames. Scene writes these once per drawn frame, interpolated.
bool gfx_instance_set_transform(gfx_world *world, gfx_instance instance, core_vec3 t, core_quat r,
                                core_vec3 s);

typedef struct gfx_camera {
    core_vec3 position;
    core_quat rotation; // looks along -Z
    float fovy;         // radians
    float near_plane;   // m
    float virtual_far;  // m: no clustered light beyond
} gfx_camera;
void gfx_world_set_camera(gfx_world *world, const gfx_camera *camera);
gfx_camera gfx_world_camera(const gfx_world *world);

// Screen-space 2D, drawn over the next frame in call order; pixels, origin top left.
void gfx_print(gfx_world *world, float x, float y, float size, const float color[4],
               const char *text);
void gfx_rect(gfx_world *world, float x, float y, float w, float h, const float color[4]);
void gfx_image(gfx_world *world, const char *path, float x, float y, float w, float h);
// Forgets the 2D commands and debug shapes of the last frame; called before a draw callback.
void gfx_world_begin_frame(gfx_world *world);

// ---- device: GL from here on ----
typedef struct gfx_device_desc {
    bool window; // GLFW window; otherwise EGL surfaceless
    uint32_t width, height;
    const char *title;
    bool vsync;
    core_vfs *vfs; // shaders are read from "shaders/"; borrowed
    core_metrics *metrics;
    bool float_target; // RGBA32F HDR target (tests)
    uint32_t cookie;
} gfx_device_desc;
gfx_device_desc gfx_device_desc_default(void);
// NULL + core_fail ("environment": what is missing and what to install).
gfx_device *gfx_device_create(const gfx_device_desc *desc);
void gfx_device_destroy(gfx_device *device);
// Draws the world; false + core_fail on shader or GL errors (file and line).
bool gfx_device_render(gfx_device *device, gfx_world *world);
// Bottom line of the frame last rendered: RGBA8 sRGB, rows top to bottom, width*height*4 bytes.
bool gfx_device_read(gfx_device *device, uint8_t *rgba);
bool gfx_device_read_float(gfx_device *device, float *rgba); // the HDR target before tone mapping
bool gfx_device_shot(gfx_device *device, const char *real_path); // PNG, makes parent folders
bool gfx_device_resize(gfx_device *device, uint32_t width, uint32_t height);
void gfx_device_size(const gfx_device *device, uint32_t *width, uint32_t *height);
void gfx_device_present(gfx_device *device); // window only

typedef enum gfx_event_type {
    GFX_EVENT_KEY,
    GFX_EVENT_MOUSE_BUTTON,
    GFX_EVENT_MOUSE_MOVE,
    GFX_EVENT_SCROLL,
    GFX_EVENT_TEXT,
    GFX_EVENT_RESIZE,
    GFX_EVENT_CLOSE,
    GFX_EVENT_FOCUS
} gfx_event_type;
typedef struct gfx_event {
    gfx_event_type type;
    int32_t code;    // key (GLFW codes), button, codepoint
    int32_t pressed; // 1 press, 0 release, 2 repeat
    float x, y;      // position, scroll, size
} gfx_event;
// Next pending window event; false when none.
bool gfx_device_poll(gfx_device *device, gfx_event *out);
const char *gfx_device_name(const gfx_device *device); // GL_RENDERER
bool gfx_device_software(const gfx_device *device);

#endif
