// What the files of this room share: the world's storage, and the state of one frame that the
// device draws from it. No GL here.
#ifndef GFX_INTERNAL_H
#define GFX_INTERNAL_H

#include "core/memory.h"
#include "gfx/gfx.h"

#include "../../assets/shaders/bindings.h"

#define GFX_COOKIE 0x67667831u

// Transform of an instance: rows of a 3x4 matrix, translation in the fourth column.
typedef struct gfx_rows {
    float m[12];
} gfx_rows;
typedef struct gfx_rgba {
    float r, g, b, a;
} gfx_rgba;

// State here is what a saved scene keeps; nothing of it is hashed.
#define GFX_LIGHT_COLUMNS(X)                                                                       \
    X(uint32_t, type, CORE_COLUMN_STATE)                                                           \
    X(float, px, CORE_COLUMN_STATE)                                                                \
    X(float, py, CORE_COLUMN_STATE)                                                                \
    X(float, pz, CORE_COLUMN_STATE)                                                                \
    X(float, dx, CORE_COLUMN_STATE)                                                                \
    X(float, dy, CORE_COLUMN_STATE)                                                                \
    X(float, dz, CORE_COLUMN_STATE)                                                                \
    X(float, r, CORE_COLUMN_STATE)                                                                 \
    X(float, g, CORE_COLUMN_STATE)                                                                 \
    X(float, b, CORE_COLUMN_STATE)                                                                 \
    X(float, intensity, CORE_COLUMN_STATE)                                                         \
    X(float, radius, CORE_COLUMN_STATE)                                                            \
    X(float, inner, CORE_COLUMN_STATE)                                                             \
    X(float, outer, CORE_COLUMN_STATE)                                                             \
    X(float, source, CORE_COLUMN_STATE)                                                            \
    X(uint32_t, shadows, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(gfx_lights, GFX_LIGHT_COLUMNS)

#define GFX_INSTANCE_COLUMNS(X)                                                                    \
    X(gfx_rows, rows, CORE_COLUMN_STATE)                                                           \
    X(float, cx, CORE_COLUMN_STATE)                                                                \
    X(float, cy, CORE_COLUMN_STATE)                                                                \
    X(float, cz, CORE_COLUMN_STATE)                                                                \
    X(float, cr, CORE_COLUMN_STATE) /* bounding sphere, world */                                   \
    X(uint64_t, changed, 0)         /* row_version of the last change */                           \
    X(gfx_rgba, color, CORE_COLUMN_STATE)                                                          \
    X(gfx_mesh, mesh, CORE_COLUMN_STATE)                                                           \
    X(gfx_material, material, CORE_COLUMN_STATE)                                                   \
    X(float *, palette, 0)                                                                         \
    X(uint32_t, palette_bones, 0)
CORE_COLUMNS_DECLARE(gfx_instances, GFX_INSTANCE_COLUMNS)

// Vertex streams: positions alone for depth-only passes, then shading, then skinning.
typedef struct gfx_vertex_shade {
    int16_t normal[4]; // snorm
    int16_t tangent[4];
    float uv[2];
    uint8_t color[4]; // unorm, linear
} gfx_vertex_shade;
typedef struct gfx_vertex_skin {
    uint16_t joint[4];
    float weight[4]; // sums to one; 16 bits would be 3e-5 of a character off
} gfx_vertex_skin;

typedef struct gfx_mesh_store {
    uint32_t vertex_count, index_count;
    float *position;         // [vertex_count*3]
    gfx_vertex_shade *shade; // [vertex_count]
    gfx_vertex_skin *skin;   // [vertex_count] or NULL
    uint32_t *index;
    core_vec3 center; // bounding sphere, model space
    float radius;
    uint32_t bones;   // 1 + largest joint, 0 without skin
    int builtin;      // 1 + number of the built-in mesh, 0 for others
    gfx_mesh coarser; // next level of detail, null: none
    float deviation;  // of this level from the true surface, part of the radius
} gfx_mesh_store;

#define GFX_MESH_COLUMNS(X) X(gfx_mesh_store, store, 0)
CORE_COLUMNS_DECLARE(gfx_meshes, GFX_MESH_COLUMNS)
typedef struct gfx_hook { // part of a shader that a script wrote
    char path[64];        // "": none
    float parameters[GFX_PARAMETERS];
    bool encoded;   // of an effect
    uint64_t order; // of its creation
} gfx_hook;
#define GFX_MATERIAL_COLUMNS(X)                                                                    \
    X(core_material_data, data, 0)                                                                 \
    X(gfx_hook, hook, 0)
CORE_COLUMNS_DECLARE(gfx_materials, GFX_MATERIAL_COLUMNS)

typedef struct gfx_viewport_store {
    gfx_camera camera;
    float rect[4];
    char target[64]; // "": the picture
    uint32_t width, height;
} gfx_viewport_store;
#define GFX_EFFECT_COLUMNS(X) X(gfx_hook, hook, 0)
CORE_COLUMNS_DECLARE(gfx_effects, GFX_EFFECT_COLUMNS)
#define GFX_VIEWPORT_COLUMNS(X) X(gfx_viewport_store, store, 0)
CORE_COLUMNS_DECLARE(gfx_viewports, GFX_VIEWPORT_COLUMNS)

#define GFX_BUILTIN_MESHES 5
extern const char *const gfx_builtin_names[GFX_BUILTIN_MESHES];

typedef enum gfx_command_type { GFX_CMD_RECT, GFX_CMD_TEXT, GFX_CMD_IMAGE } gfx_command_type;
typedef struct gfx_command { // one 2D call; text lies in the world's frame text
    gfx_command_type type;
    float x, y, w, h; // text: size and width of its lines in h and w
    float pivot[2], angle, source[4];
    float radius, border;
    bool smooth; // edges
    gfx_rgba color;
    float align;
    float clip[4]; // left, top, right, bottom
    uint32_t text, text_length;
    uint32_t font; // place of the font's name in the frame text, GFX_NO_TEXT: default
} gfx_command;
#define GFX_NO_TEXT UINT32_MAX

typedef struct gfx_board {      // a picture or text in the world; texts lie in the frame text
    gfx_board_desc desc;        // image, text, font: not set
    uint32_t image, text, font; // GFX_NO_TEXT: none
} gfx_board;
// Place of a copy in the frame's text (gfx_canvas.c).
uint32_t gfx_keep_text(gfx_world *world, const char *text);

typedef struct gfx_growing { // array that keeps its memory between frames
    void *data;
    size_t count; // elements in use
    size_t bytes; // allocated
} gfx_growing;
// Adds `extra` elements of `element` bytes, not initialised; returns the first of them.
void *gfx_grow(gfx_growing *array, size_t element, size_t extra);
void gfx_growing_release(gfx_growing *array);

enum { GFX_SHADOWS_OFF, GFX_SHADOWS_PCF, GFX_SHADOWS_SOFT };
enum { GFX_RENDER_AUTO, GFX_RENDER_FORWARD, GFX_RENDER_CLUSTERED, GFX_RENDER_NONE };

typedef struct gfx_settings { // choices are ints: gfx_settings.c sets them by offset
    int render;               // GFX_RENDER_*
    uint32_t grid[3];
    int linear_slices, assign; // assign: gfx_cluster_method
    float first_slice;         // m
    float cell_cap;            // lights, 0: none
    float exposure;
    int tonemap;                              // GFX_TONEMAP_*
    int instancing, culling, prepass, levels; // switches
    int debug;                                // GFX_DEBUG_*
    int shadows;                              // GFX_SHADOWS_*
    float terrain_error;                      // pixels
    int msaa, fxaa;                           // msaa: samples are 1 << msaa
    float shadow_size, shadow_distance, cascades, shadow_taps, shadow_bias;
    float ibl_samples;
    float ao, ao_radius, ao_slices, ao_steps;
    float bloom, bloom_threshold, bloom_levels, bloom_spread;
    int auto_exposure;
    float key, adapt;
    float contrast, saturation, lift[3], gain[3];
    float upload_budget; // MiB
    float fog, fog_falloff, fog_base, fog_color[3];
} gfx_settings;
void gfx_settings_default(gfx_settings *settings);

struct gfx_world {
    uint64_t id; // no two worlds of a process share it: devices key their copies by it
    core_jobs *jobs;
    core_metrics *metrics;
    gfx_lights lights;
    gfx_instances instances;
    gfx_meshes meshes;
    gfx_materials materials;
    gfx_viewports viewports; // made by the first one
    gfx_effects effects;     // made by the first one
    bool viewports_made, effects_made;
    uint64_t effect_order; // of the last one
    gfx_mesh builtin[GFX_BUILTIN_MESHES];
    uint64_t mesh_version, material_version, instance_version; // raised by every change
    uint64_t row_version;    // of instances: by every change of any column
    uint64_t palette_layout; // by every change of how many bones a row has
    gfx_settings settings;
    gfx_camera camera;
    bool camera_set;
    float ambient[3], background[3];
    bool ambient_set, environment_set;
    gfx_environment environment; // panorama: points to panorama_path
    char panorama_path[CORE_NAME_MAX];
    gfx_growing commands, text;
    gfx_growing lines;               // struct gfx_line_block
    gfx_growing boards;              // gfx_board
    struct gfx_particles *particles; // NULL until the first emitter
    struct gfx_terrains *terrains;   // NULL until the first terrain
    gfx_growing faces;               // gfx_face
    float clip[GFX_CLIPS + 1][4];
    uint32_t clips;
    core_vfs *vfs;
    size_t heap_bytes; // of meshes and palettes
    gfx_stats stats;
};

// A world that was given no light of any kind is lit by a sun of our own.
static inline bool gfx_world_has_default_sun(const gfx_world *world) {
    return core_columns_count(&world->lights.set) == 0 && !world->ambient_set &&
           !world->environment_set;
}

// ---- names (gfx_settings.c) ----
int gfx_find_name(const char *name, const char *const *names, int count); // -1: none
// core_fail with the nearest name and the whole list.
bool gfx_fail_name(const char *what, const char *name, const char *const *names, int count);

// ---- shaders of scripts (gfx_effect.c) ----
// Fills the hook; false + core_fail when there is no such file. what: of the error.
bool gfx_hook_make(const gfx_world *world, const char *what, const char *path,
                   const float parameters[GFX_PARAMETERS], gfx_hook *out);
static inline uint32_t gfx_effect_count(const gfx_world *world) {
    return world->effects_made ? core_columns_count(&world->effects.set) : 0;
}

// ---- meshes (gfx_mesh.c) ----
void gfx_mesh_store_release(gfx_mesh_store *store);

// ---- text (gfx_text.c) ----
void gfx_faces_release(gfx_growing *faces);
static inline float gfx_text_size(float size) {
    return (float)(int)(CORE_CLAMP(size, 4.0f, 256.0f) + 0.5f);
}

// ---- view (gfx_view.c) ----
#define GFX_PLANES 6
typedef struct gfx_view {
    core_mat4 view, projection, view_projection;
    core_vec3 position;
    float tan_x, tan_y; // half extents at depth 1 (perspective), or in metres (orthographic)
    float near_plane, virtual_far;
    bool orthographic;
    float plane[GFX_PLANES][4]; // unit normals inwards: n.p + d >= 0 inside
} gfx_view;
void gfx_view_make(const gfx_camera *camera, float aspect, gfx_view *out);
// By hand: camera_view, then the projection, then finish (product and planes).
void gfx_camera_view(gfx_view *view, core_vec3 eye, core_vec3 target, core_vec3 up);
void gfx_view_finish(gfx_view *view);
// Camera of a world, or one that sees all its instances when none was set.
gfx_camera gfx_world_camera_or_default(const gfx_world *world);

#endif
