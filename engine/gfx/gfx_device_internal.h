// What the files behind gfx_device share. GL from here on.
#ifndef GFX_DEVICE_INTERNAL_H
#define GFX_DEVICE_INTERNAL_H

#include "gfx/gfx_cluster.h"
#include "gfx/gfx_context.h"
#include "gfx/gfx_internal.h"
#include "gfx/gfx_shader.h"

enum { GFX_FRAMES = 3 }; // frames that the processor may be ahead of the GPU, and itself

// A buffer written once a frame through a persistent mapping, in GFX_FRAMES turns.
typedef struct gfx_stream {
    GLuint name;
    uint8_t *map;
    size_t segment; // bytes a frame may use
} gfx_stream;
// Pointer to this frame's `bytes`, write-only; grows when too small.
void *gfx_stream_begin(gfx_stream *stream, size_t bytes, uint32_t frame);
void gfx_stream_bind(const gfx_stream *stream, GLenum target, GLuint binding, size_t bytes,
                     uint32_t frame);
void gfx_stream_release(gfx_stream *stream);

// Where a mesh lies in the device's vertex and index buffers.
typedef struct gfx_mesh_place {
    uint32_t generation; // of the mesh's handle; 0: not there
    uint32_t first_index, index_count, base_vertex;
    bool skinned;
} gfx_mesh_place;

typedef struct gfx_geometry { // all meshes of one world in common buffers
    GLuint vao[2];            // plain, skinned
    GLuint position, shade, skin, index;
    gfx_mesh_place *place; // by index of the mesh's handle
    uint32_t places;
    uint64_t world, version; // what the buffers hold
} gfx_geometry;
// Makes the buffers hold the world's meshes.
bool gfx_geometry_update(gfx_geometry *g, const gfx_world *world);
void gfx_geometry_release(gfx_geometry *g);

// ---- lights (gfx_light_upload.c) ----
typedef struct gfx_light_upload {
    uint32_t directional, local; // in the light block, in this order
    bool clustered;
    gfx_cluster_grid grid; // when clustered
} gfx_light_upload;
// View-space bounding spheres of all point and spot lights, in the order of the light block.
void gfx_cluster_lights_fill(gfx_cluster_lights *out, const gfx_lights *lights,
                             const gfx_view *view);
// Fills and binds the light block and, when the view is drawn clustered, its lists.
void gfx_lights_upload(gfx_device *device, gfx_world *world, const gfx_view *view,
                       gfx_light_upload *out);

// ---- screen-space quads (gfx_quads.c, gfx_font.c) ----
typedef struct gfx_font gfx_font;
gfx_font *gfx_font_create(core_vfs *vfs); // NULL: no font found, a warning is logged
void gfx_font_release(gfx_font *font);
GLuint gfx_font_texture(const gfx_font *font);
void gfx_font_begin_frame(gfx_font *font);
// Appends the quads (struct gfx_quad_block) of a text.
void gfx_font_layout(gfx_font *font, const char *text, size_t length, float x, float y, float size,
                     const gfx_rgba *color, gfx_growing *quads);

typedef struct gfx_quad_run { // quads that share a texture
    uint32_t first, count;
    GLuint texture;
    uint32_t features;
} gfx_quad_run;
enum { GFX_IMAGES = 256 };
typedef struct gfx_image_entry {
    char path[CORE_NAME_MAX];
    GLuint texture; // 0: it could not be read
    uint32_t width, height;
} gfx_image_entry;
typedef struct gfx_quads {
    gfx_stream stream;
    gfx_growing quads, runs;
    gfx_font *font;
    bool font_tried;
    gfx_image_entry image[GFX_IMAGES];
    uint32_t images;
} gfx_quads;
bool gfx_quads_draw(gfx_device *device, const gfx_world *world);
void gfx_quads_release(gfx_quads *quads);

// One entry of a GL_DRAW_INDIRECT_BUFFER.
typedef struct gfx_draw_command {
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
} gfx_draw_command;
typedef struct gfx_batch { // consecutive commands with one state
    uint32_t features;
    uint32_t first, count;
} gfx_batch;

struct gfx_device {
    gfx_context *context;
    core_vfs *vfs;
    core_metrics *metrics;
    gfx_shaders shaders;
    bool float_target, software, draw_parameters;
    char name[128];
    uint32_t gl_errors;
    uint32_t passes;        // of the last frame
    uint32_t width, height; // of the targets
    GLuint hdr_texture, depth_texture, hdr_target, ldr_texture, ldr_target;
    GLuint empty_vao;
    gfx_geometry geometry;
    gfx_stream cluster_offsets, cluster_lists;
    gfx_clusters clusters;
    gfx_cluster_lights cluster_lights;
    gfx_stream view_block, light_block, instance_block, bone_block, draw_block;
    GLuint material_buffer, dfg_texture;
    uint64_t material_world, material_version;
    GLsync fence[GFX_FRAMES];
    uint32_t frame; // turn of the streams
    gfx_quads quads;
    gfx_growing visible, keys, scratch, commands, batches; // of the draw list
};

// False + core_fail when GL complained since `errors_before` was read from device->gl_errors.
bool gfx_device_check(gfx_device *device, const char *what, uint32_t errors_before);
// Makes the targets as large as the window is now.
bool gfx_device_follow_window(gfx_device *device);

// ---- draw list (gfx_draw_list.c) ----
typedef struct gfx_sort_key {
    uint64_t key;
    uint32_t row, pad;
} gfx_sort_key;
// Sorts by key, equal keys in the order they stand in. scratch holds as many.
void gfx_sort_keys(gfx_sort_key *keys, gfx_sort_key *scratch, uint32_t count);
// Fills device->visible, the instance, bone and command streams and device->batches for a view.
bool gfx_draw_list_build(gfx_device *device, gfx_world *world, const gfx_view *view);
// Draws the list; `features` are added to each batch's own.
bool gfx_draw_list_submit(gfx_device *device, gfx_world *world, const char *fragment,
                          uint32_t features);

#endif
