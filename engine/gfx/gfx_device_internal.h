// What the files behind gfx_device share. GL from here on.
#ifndef GFX_DEVICE_INTERNAL_H
#define GFX_DEVICE_INTERNAL_H

#include "gfx/gfx_cluster.h"
#include "gfx/gfx_context.h"
#include "gfx/gfx_internal.h"
#include "gfx/gfx_mips.h"
#include "gfx/gfx_shader.h"

enum { GFX_FRAMES = 3 }; // frames that the processor may be ahead of the GPU, and itself

// ---- buffers (gfx_buffers.c) ----

// A buffer written once a frame through a persistent mapping, in GFX_FRAMES turns.
typedef struct gfx_stream {
    GLuint name;
    uint8_t *map;
    size_t segment;            // bytes a frame may use
    GLuint texels[GFX_FRAMES]; // views of the segments as texel buffers, 0: none yet
} gfx_stream;
// Pointer to this frame's `bytes`, write-only; grows when too small.
void *gfx_stream_begin(gfx_stream *stream, size_t bytes, uint32_t frame);
void gfx_stream_bind(const gfx_stream *stream, GLenum target, GLuint binding, size_t bytes,
                     uint32_t frame);
// The same as a texel buffer.
void gfx_stream_bind_texels(gfx_stream *stream, GLuint unit, GLenum format, size_t bytes,
                            uint32_t frame);
void gfx_stream_release(gfx_stream *stream);

// Where a mesh lies in the device's vertex and index buffers.
typedef struct gfx_mesh_place {
    uint32_t generation; // of the mesh's handle; 0: not there
    uint32_t number;     // the handle's index
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

// ---- textures (gfx_textures.c) ----

enum { GFX_TEXTURE_LOADING, GFX_TEXTURE_READY, GFX_TEXTURE_MISSING };
typedef struct gfx_texture {
    char path[CORE_NAME_MAX];
    bool srgb;
    int state;
    GLuint name, own; // what is bound: its own, grey while it loads, a checker when it is missing
    uint32_t width, height;
    uint64_t stamp; // of the file
} gfx_texture;
typedef struct gfx_upload { // an image on its way to the GPU
    gfx_mips image;
    GLuint name;
    uint32_t level, row; // next
} gfx_upload;
typedef struct gfx_loader gfx_loader;
typedef struct gfx_textures {
    gfx_growing all; // gfx_texture
    gfx_loader *loader;
    gfx_upload upload;
    uint32_t uploading; // texture of the upload
    size_t uploaded;    // bytes, last frame
    uint64_t version;   // raised when a texture becomes another
} gfx_textures;
// Textures that are always there.
#define GFX_TEXTURE_WHITE   "//white"
#define GFX_TEXTURE_FLAT    "//flat" // as a normal map
#define GFX_TEXTURE_GREY    "//grey"
#define GFX_TEXTURE_CHECKER "//checker"
// The texture of an image file, read once; a checker when it cannot be read, logged at the first
// try. Valid until the next call.
const gfx_texture *gfx_texture_get(gfx_device *device, const char *path, bool srgb);
// Enters a texture that is drawn here; name 0 takes it away: a checker.
void gfx_texture_enter(gfx_device *device, const char *path, bool srgb, GLuint name, uint32_t width,
                       uint32_t height);
// Uploads what the loader has read, as much as a frame may.
void gfx_textures_update(gfx_device *device, const gfx_world *world);
// Reads again what changed on disk; false when one is broken, whose last good picture stays.
bool gfx_textures_reload(gfx_device *device);
uint32_t gfx_textures_loading(const gfx_textures *textures);
void gfx_textures_release(gfx_textures *textures);

// ---- materials (gfx_materials.c) ----

enum { GFX_MATERIAL_TEXTURES = 5 }; // units GFX_TEX_BASE_COLOR to GFX_TEX_EMISSIVE
typedef struct gfx_material_state { // what drawing with a material needs
    uint32_t features;
    bool double_sided, hooked;
    GLuint texture[GFX_MATERIAL_TEXTURES];
} gfx_material_state;
typedef struct gfx_material_cache {
    GLuint buffer;
    gfx_growing state;                 // gfx_material_state: the default, then one a row
    uint64_t world, version, textures; // versions that it was made from
} gfx_material_cache;
void gfx_materials_update(gfx_device *device, const gfx_world *world);
void gfx_materials_release(gfx_material_cache *cache);

// ---- draw lists (gfx_draw_list.c) ----

typedef struct gfx_sort_key {
    uint64_t key;
    const gfx_mesh_place *place;
    uint32_t row, material; // 0: the default, else 1 + its row
} gfx_sort_key;
// Sorts by key, equal keys in the order they stand in. scratch holds as many.
void gfx_sort_keys(gfx_sort_key *keys, gfx_sort_key *scratch, uint32_t count);

typedef struct gfx_draw_command { // one entry of a GL_DRAW_INDIRECT_BUFFER
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
} gfx_draw_command;
typedef struct gfx_batch { // consecutive commands with one state
    uint32_t features;
    uint32_t material;           // 0 when it has no textures
    bool double_sided, mirrored; // mirrored: triangles turn the other way
    uint32_t first, count;
} gfx_batch;
typedef struct gfx_draw_list { // one view's part of the frame's batches: opaque ones, then blended
    uint32_t first_batch, opaque, batches, triangles;
} gfx_draw_list;

// A frame: begin, one list a view, upload once, submit batches with `features` added to their own.
void gfx_draws_begin(gfx_device *device, const gfx_world *world, const gfx_view *view);
void gfx_draws_add_view(gfx_device *device, const gfx_world *world, const gfx_view *view,
                        gfx_draw_list *list);
void gfx_draws_upload(gfx_device *device, gfx_world *world);
bool gfx_draws_submit(gfx_device *device, gfx_world *world, const gfx_draw_list *list,
                      const char *fragment, uint32_t features);
bool gfx_draws_submit_blended(gfx_device *device, gfx_world *world, const gfx_draw_list *list,
                              uint32_t features);

// ---- instances (gfx_instance_upload.c) ----

typedef struct gfx_instance_gpu {
    gfx_stream instances, bones;
    uint64_t key[GFX_FRAMES], version[GFX_FRAMES]; // what each turn's segment holds
    uint64_t layout;                               // that first_bone was made for
    gfx_growing first_bone;                        // u32 a row
    uint32_t bone_count;
} gfx_instance_gpu;
void gfx_instances_upload(gfx_device *device, gfx_world *world);
void gfx_instance_gpu_release(gfx_instance_gpu *gpu);

// ---- terrain (gfx_terrain_draw.c) ----

typedef struct gfx_terrain_maps { // of one terrain: heights, normals
    GLuint texture[2];
} gfx_terrain_maps;
typedef struct gfx_terrain_run { // tiles of one terrain in one view
    uint32_t terrain, first, count;
} gfx_terrain_run;
typedef struct gfx_terrain_list { // one view's runs
    uint32_t first, count, triangles;
} gfx_terrain_list;
typedef struct gfx_terrain_gpu {
    gfx_growing maps;                // gfx_terrain_maps, in the order of rows
    gfx_growing levels, tiles, runs; // of the frame: gfx_terrain_levels, gfx_tile, gfx_terrain_run
    gfx_stream tile_stream, block;
    GLuint grid, index; // one tile
    uint64_t world, version;
} gfx_terrain_gpu;
// A frame: begin with the camera, one list a view, upload once, submit.
bool gfx_terrains_wanted(const gfx_world *world);
void gfx_terrains_begin(gfx_device *device, const gfx_world *world, const gfx_view *view);
void gfx_terrains_add_view(gfx_device *device, const gfx_world *world, const gfx_view *view,
                           gfx_terrain_list *list);
void gfx_terrains_upload(gfx_device *device, const gfx_world *world);
bool gfx_terrains_submit(gfx_device *device, gfx_world *world, const gfx_terrain_list *list,
                         const char *fragment, uint32_t features);
void gfx_terrain_gpu_release(gfx_terrain_gpu *gpu);

// ---- shadows (gfx_shadow.c) ----

enum { GFX_SHADOW_VIEWS = 64 };
typedef struct gfx_shadow_view {
    gfx_view view;
    gfx_draw_list list;
    gfx_terrain_list terrain;
    struct gfx_shadow_block block;
    uint64_t key; // of what the layer should hold: matrix and casters
    bool current; // it holds that already
} gfx_shadow_view;
typedef struct gfx_shadows {
    gfx_shadow_view view[GFX_SHADOW_VIEWS];
    uint32_t count;
    GLuint texture, target, sampler;         // array; framebuffer
    uint32_t size, layers, views_of_type[3]; // by gfx_light_type
    uint64_t drawn[GFX_SHADOW_VIEWS];        // key of each layer, 0: none
    gfx_growing first;                       // u16 a light row: 1 + its first view, 0 none
    gfx_stream block, views;
} gfx_shadows;
// Plans the maps of this frame's lights: views, blocks, draw lists of layers that are out of date.
void gfx_shadows_plan(gfx_device *device, const gfx_world *world, const gfx_view *view);
bool gfx_shadows_draw(gfx_device *device, gfx_world *world);
// What gfx_light_block.color.w holds for a light of this row and type.
float gfx_shadow_code(const gfx_device *device, uint32_t row, uint32_t type);
void gfx_shadows_release(gfx_shadows *shadows);

// ---- environment (gfx_environment.c) ----

typedef struct gfx_environment_maps {
    GLuint source, filtered,
        panorama; // cube with all levels; cube with a roughness a level; picture
    uint64_t key; // of the environment they were made from
    float harmonics[9][4];
} gfx_environment_maps;
// The environment's part of the view block; harmonics are those of the maps.
void gfx_environment_write(const gfx_device *device, const gfx_world *world,
                           struct gfx_view_block *out);
// Makes the maps when the world's environment changed.
bool gfx_environment_update(gfx_device *device, const gfx_world *world);
bool gfx_environment_draw(gfx_device *device, const gfx_world *world); // behind everything
// rgba[6*size*size*4]: faces of a cube, to nine coefficients of irradiance over pi.
void gfx_environment_project(const float *rgba, uint32_t size, float out[9][4]);
void gfx_environment_release(gfx_environment_maps *maps);

// ---- lights (gfx_light_upload.c) ----

extern const struct gfx_light_block gfx_default_sun;
typedef struct gfx_light_upload {
    uint32_t directional, local; // in the light block, in this order
    bool clustered;
    gfx_cluster_grid grid; // when clustered
} gfx_light_upload;
// View-space bounding spheres of all point and spot lights, in the order of the light block.
void gfx_cluster_lights_fill(gfx_cluster_lights *out, const gfx_lights *lights,
                             const gfx_view *view);
typedef struct gfx_cluster_gpu {
    GLuint offsets, lists;
    size_t offset_bytes, list_bytes;
} gfx_cluster_gpu;
// Assigns on the GPU and binds the lists; *refs: their entries.
bool gfx_clusters_assign_gpu(gfx_device *device, const gfx_cluster_grid *grid,
                             const gfx_cluster_lights *lights, uint32_t *refs);
void gfx_cluster_gpu_release(gfx_cluster_gpu *c);
// Fills and binds the light block and, when the view is drawn clustered, its lists.
bool gfx_lights_upload(gfx_device *device, gfx_world *world, const gfx_view *view,
                       gfx_light_upload *out);

// ---- screen-space quads (gfx_quads.c, gfx_font.c) ----

typedef struct gfx_font gfx_font; // an atlas of glyphs, of any face and size
struct gfx_face;
gfx_font *gfx_font_create(void);
void gfx_font_release(gfx_font *font);
GLuint gfx_font_texture(const gfx_font *font);
void gfx_font_begin_frame(gfx_font *font);
// Appends the quads (struct gfx_quad_block) of a text.
void gfx_font_quads(gfx_font *font, const struct gfx_face *face, const char *text,
                    const gfx_command *command, gfx_growing *quads);

typedef struct gfx_quad_run { // quads that share a texture
    uint32_t first, count;
    GLuint texture;
    uint32_t features;
} gfx_quad_run;
typedef struct gfx_quads {
    gfx_stream stream;
    gfx_growing quads, runs;
    gfx_font *font; // NULL until the first text
} gfx_quads;
bool gfx_quads_draw(gfx_device *device, gfx_world *world);
void gfx_quads_release(gfx_quads *quads);

// ---- targets of a view (gfx_targets.c) ----

enum { GFX_BLOOM_LEVELS = 8 };
typedef struct gfx_target { // a texture and the framebuffer that draws to it
    GLuint texture, name;
    uint32_t width, height;
} gfx_target;
typedef struct gfx_targets {
    uint32_t width, height;
    gfx_target hdr;     // linear radiance; its framebuffer has `depth` too
    gfx_target picture; // encoded for display
    gfx_target samples; // several samples a pixel, resolved into hdr; 0 without
    GLuint depth, sample_depth, sample_count;
    gfx_target ao, ao_smooth;           // visibility of ambient light
    gfx_target bloom[GFX_BLOOM_LEVELS]; // halves of halves of the bright part
    gfx_target encoded;                 // what FXAA reads
    gfx_target spare_hdr, spare;        // what scripts' passes draw to
    GLuint exposure;                    // buffer of exposure.comp, 0: the exposure is fixed
    gfx_target image; // of a view that is a texture: the picture, rows as in files
    GLuint light;     // the same texels as sRGB
} gfx_targets;
// Makes the targets that the world's settings ask for and drops those that they do not.
bool gfx_targets_fit(gfx_device *device, const gfx_world *world, gfx_targets *t);
// Main targets of a size; all others are dropped.
bool gfx_targets_resize(gfx_device *device, gfx_targets *t, uint32_t width, uint32_t height);
void gfx_targets_add_image(gfx_targets *t);
void gfx_targets_release(gfx_targets *t);
size_t gfx_targets_bytes(const gfx_device *device, const gfx_targets *t);

// ---- further views (gfx_views.c) ----

typedef struct gfx_extra_view {
    gfx_viewport viewport; // null: free
    uint64_t world;
    char path[CORE_NAME_MAX]; // of the texture, "": part of the picture
    gfx_targets targets;
} gfx_extra_view;
// Makes targets for the world's viewports, drops those of viewports that are gone, and enters those
// that are textures under their names.
bool gfx_views_fit(gfx_device *device, const gfx_world *world);
gfx_targets *gfx_views_targets(gfx_device *device, const gfx_world *world, uint32_t row);
// Copies what was drawn to its rectangle of the picture, or to its texture.
void gfx_views_place(gfx_device *device, const gfx_world *world, uint32_t row);
void gfx_views_release(gfx_device *device);

// ---- names and times of passes (gfx_passes.c) ----

enum { GFX_PASSES = 32 };
typedef struct gfx_pass_turn { // passes of one turn of the streams
    const char *name[GFX_PASSES];
    GLuint query[GFX_PASSES + 1]; // when each began, and the end
    uint32_t count;
} gfx_pass_turn;
void gfx_pass_begin(gfx_device *device, const char *name); // a literal; ends the one before
void gfx_passes_begin_turn(gfx_device *device);
void gfx_passes_end_turn(gfx_device *device);
void gfx_passes_release(gfx_device *device);

// ---- passes over the whole picture (gfx_post.c) ----

bool gfx_post_ambient(gfx_device *device, const gfx_world *world, gfx_targets *t);
// Everything from the HDR target to the picture.
bool gfx_post_finish(gfx_device *device, const gfx_world *world, gfx_targets *t);
// Covers the target by one triangle; blend and depth state stay as they are.
bool gfx_post_fill(gfx_device *device, const char *fragment, uint32_t features);
// Binds a target for a pass that replaces all of it.
void gfx_post_begin(gfx_device *device, const gfx_target *target);

// ---- lines in the world (gfx_marks.c); pictures, texts, particles (gfx_boards.c) ----

typedef struct gfx_marks {
    gfx_stream lines;
} gfx_marks;
bool gfx_marks_wanted(const gfx_world *world);
bool gfx_marks_draw(gfx_device *device, gfx_world *world);
void gfx_marks_release(gfx_marks *marks);

typedef struct gfx_boards {
    gfx_stream stream;
    GLuint sampler;
    gfx_growing blocks, runs;          // gfx_board_block, gfx_quad_run
    gfx_growing order, inner, scratch; // gfx_sort_key
    gfx_growing glyphs;                // gfx_quad_block of the text at hand
} gfx_boards;
bool gfx_boards_wanted(const gfx_world *world);
bool gfx_boards_draw(gfx_device *device, gfx_world *world, const gfx_view *view);
void gfx_boards_release(gfx_boards *boards);

// ---- the device (gfx_device.c, gfx_frame.c) ----

struct gfx_device {
    gfx_context *context;
    core_vfs *vfs;
    core_metrics *metrics;
    gfx_shaders shaders;
    bool float_target, software, draw_parameters, background;
    char name[128];
    uint32_t gl_errors;
    uint32_t passes; // of the last frame
    gfx_pass_use pass[GFX_PASSES];
    uint32_t pass_count;
    gfx_pass_turn pass_turn[GFX_FRAMES];
    uint32_t width, height; // of the view that is drawn
    gfx_targets targets;
    gfx_growing extra; // gfx_extra_view, of the world's viewports
    GLint most_samples;
    bool samples_warned;
    GLuint empty_vao, dfg_texture;
    gfx_geometry geometry;
    gfx_stream view_block, light_block, draw_block, row_block;
    gfx_stream cluster_offsets, cluster_lists, cluster_grid;
    gfx_cluster_gpu cluster_gpu;
    gfx_clusters clusters;
    gfx_cluster_lights cluster_lights;
    gfx_shadows shadows;
    gfx_environment_maps environment;
    gfx_textures textures;
    gfx_material_cache materials;
    GLsync fence[GFX_FRAMES];
    GLuint timer[GFX_FRAMES];
    bool timing;    // a timer runs
    uint32_t frame; // turn of the streams
    gfx_quads quads;
    gfx_marks marks;
    gfx_boards boards;
    gfx_terrain_gpu terrain;
    gfx_instance_gpu instances;
    gfx_growing places; // of each row's mesh at its level of detail, NULL: not drawn
    uint64_t levels_hash;
    gfx_growing visible, keys, scratch, rows, commands, batches; // of the draw lists
};

// False + core_fail when GL complained since `errors_before` was read from device->gl_errors.
bool gfx_device_check(gfx_device *device, const char *what, uint32_t errors_before);
// Makes the targets as large as the window is now.
bool gfx_device_follow_window(gfx_device *device);

#endif
