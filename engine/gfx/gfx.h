// Rendering. Two halves: gfx_world is plain data (lights, instances, materials, camera; no GL) and
// exists headless at no cost; gfx_device owns GL and draws worlds. Conventions: design page 8.
#ifndef GFX_GFX_H
#define GFX_GFX_H

#include "core/columns.h"
#include "core/data.h"
#include "core/jobs.h"
#include "core/metrics.h"
#include "core/stream.h"
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
    core_vfs *vfs;                      // fonts; borrowed, may be NULL
    uint32_t max_instances, max_lights; // default 1 << 20, 1 << 17
    uint32_t cookie;
} gfx_world_desc;
gfx_world_desc gfx_world_desc_default(void);
gfx_world *gfx_world_create(const gfx_world_desc *desc);
void gfx_world_destroy(gfx_world *world);
// Fields of a saved scene (core/stream.h): instances, lights, camera. Meshes and materials are not
// in it: the world must hold those of the one that was saved. When it returns false nothing of what
// was there is left.
bool gfx_world_stream(gfx_world *world, core_stream *stream);
size_t gfx_world_bytes(const gfx_world *world);
// Sets lights, clusters, light_refs, draws, triangles.
void gfx_world_counts(const gfx_world *world, core_metrics *metrics);
typedef struct gfx_stats { // of the last frame
    uint32_t clusters, light_refs;
    uint32_t capped; // cells with more lights than cell_cap
    uint32_t draws, programs, triangles;
    uint32_t uploads; // instances whose data went to the GPU: those that changed
} gfx_stats;
gfx_stats gfx_world_stats(const gfx_world *world);
// Settings by name, as --set gfx.NAME=VALUE reaches them. False + core_fail naming the nearest name
// or the allowed values.
//   render       auto (clustered from 2 point and spot lights on) | forward | clustered | none
//   clusters     cells as XxYxZ, each 1..64, default 16x9x24
//   slices       exponential | linear
//   first_slice  m, end of the first exponential slice, default 5; 0: none, all from near on
//   assign       naive | per_light | simd | gpu: how lights are assigned to cells
//   cell_cap     most lights in a cell's list, default 0: any number. Cells beyond are lit by
//                all lights, rightly and slowly, and counted in gfx_stats; gpu has no cap
//   exposure     factor before the tone map, > 0, default 1
//   tonemap      neutral (Khronos PBR Neutral) | linear
//   msaa         off | 2 | 4 | 8 samples a pixel; as many as the device has, with a warning
//   fxaa         off | on: edges smoothed in the encoded picture (Lottes 2009)
//   ao           0..1, strength of ambient occlusion (GTAO: Jimenez and others 2016); 0: off. It
//                darkens ambient light alone, of opaque surfaces
//   ao_radius    m, > 0, default 0.5: nothing farther occludes
//   ao_slices, ao_steps  1..16, 1..32: directions, and samples to each side; default 2, 4
//   bloom        0..1: share of bright light that scatters in the lens; 0: off. What scatters is
//                taken from where it came
//   bloom_threshold  radiance, default 0: only what exceeds it scatters
//   bloom_levels, bloom_spread  halvings, 1..8, default 6; 0..1, default 0.7: share that each level
//                hands to the wider one below
//   auto_exposure  off | on: the mean log luminance between the darkest and the brightest twentieth
//                comes to `key`; exposure stays a factor on top
//   key          default 0.18
//   adapt        0..1, default 1: share of the way to the wanted exposure (in log2) a frame
//   contrast, saturation  default 1; about middle grey in log2, about the luminance
//   lift, gain   added, multiplied before those: a number or R,G,B; default 0, 1
//   fog          density (1/m) at height fog_base (m, default 0); 0: off
//   fog_falloff  1/m, default 0: the density falls as exp(-fog_falloff * (y - fog_base))
//   fog_color    R,G,B radiance, default 0.5,0.55,0.6
//   shadows      off | pcf (filtered over 3 x 3 texels) | soft (wider the farther the blocker)
//   shadow_size  texels of a map's side, 16..8192, default 1024
//   shadow_distance  m of view depth that a sun's cascades cover, default 80
//   cascades     of a sun, 1..4, default 3
//   upload_budget  MiB of images read in the background that go to the GPU a frame, default 4
//   shadow_taps  texels that a soft shadow is filtered over, 2..256, default 32; half as many find
//                what casts it
//   shadow_bias  texels by which a receiver is lifted off its surface, -16..16, default 0: planes
//                need none
//   ibl_samples  of an environment's reflections, 1..4096, default 128
//   debug        off | normals | depth | lights (in each cell: blue none, red 32) | clusters |
//                overdraw
//   prepass      on | off: depth first, so that no hidden fragment is shaded
//   levels       on | off: coarser built-in meshes where half a pixel does not tell
//   terrain_error  pixels that terrain may be off its finest form, 0..100, default 1
//   culling      on | off: skip what is outside the view
//   instancing   on | off (off: one draw call per instance, the baseline of the draw counts)
bool gfx_world_set(gfx_world *world, const char *name, const char *value);
// For lists of settings: i < count gives the name, and the value as text. clusters is not listed.
uint32_t gfx_world_setting_count(void);
const char *gfx_world_setting(const gfx_world *world, uint32_t i, char *value, size_t size);
// The next or former choice; a number goes up or down by a quarter, within its range.
void gfx_world_nudge(gfx_world *world, uint32_t i, int direction);

typedef enum gfx_light_type { GFX_POINT, GFX_SPOT, GFX_DIRECTIONAL } gfx_light_type;
// A point or spot light of radiant intensity I gives the irradiance I / d^2 at distance d, times a
// window (1 - (d/radius)^4)^2 that reaches zero at its radius. A white surface under a directional
// light of irradiance pi, facing it, has radiance 1. A world without any light is lit by a default
// sun, until its ambient light is set.
typedef struct gfx_light_desc {
    gfx_light_type type;
    core_vec3 position, direction; // direction: where the light goes; need not be unit
    float color[3];                // linear, >= 0; zero: white
    float intensity;               // >= 0. Point, spot: radiant intensity; directional: irradiance
    float radius;                  // m, > 0: the light is zero beyond. Default 10
    float inner, outer;            // spot: half angles, radians, 0 <= inner < outer < pi/2
    float source; // >= 0, for soft shadows: radius of the source (m), or of a sun's disk (tangent
                  // of its angular radius, default 0.00465)
    bool shadows; // default: directional lights only. 64 maps at most: one a cascade of a sun, one
                  // of a spot, six of a point light; lights beyond cast none
    uint32_t cookie;
} gfx_light_desc;
gfx_light_desc gfx_light_desc_default(gfx_light_type type);
gfx_light gfx_light_create(gfx_world *world, const gfx_light_desc *desc);
bool gfx_light_destroy(gfx_world *world, gfx_light light);
bool gfx_light_alive(const gfx_world *world, gfx_light light);
bool gfx_light_set_position(gfx_world *world, gfx_light light, core_vec3 position);
bool gfx_light_set_direction(gfx_world *world, gfx_light light, core_vec3 direction);
bool gfx_light_set_color(gfx_world *world, gfx_light light, float r, float g, float b,
                         float intensity);
// Ambient light: linear radiance of the upper hemisphere; the lower one gives 0.4 of it.
void gfx_world_set_ambient(gfx_world *world, float r, float g, float b);
// Light from everywhere that is seen behind things too, in place of ambient light and background:
// a procedural sky, or a picture. Irradiance goes by spherical harmonics, reflections by a
// prefiltered cube map; both are made when the next frame is drawn, at some cost.
typedef struct gfx_environment {
    const char *panorama; // virtual path of an equirectangular picture (.hdr, .png, .jpg), copied.
                          // NULL: the procedural sky
    float intensity;      // factor, > 0, default 1
    float zenith[3], horizon[3], ground[3]; // sky: linear radiance
    float glow[3];                          // added round the sun
    float glow_exponent;                    // the larger the narrower, 1..4096
    core_vec3 sun;                          // towards it; need not be unit
    uint32_t cookie;
} gfx_environment;
gfx_environment gfx_environment_default(void);                                        // a clear day
bool gfx_world_set_environment(gfx_world *world, const gfx_environment *environment); // NULL: none
// Linear radiance where nothing is drawn.
void gfx_world_set_background(gfx_world *world, float r, float g, float b);

// Built-in unit meshes: "box" (edge 1), "sphere" (radius 0.5), "capsule" (radius 0.5, segment 1),
// "cylinder" (radius 0.5, height 1), "plane" (1 x 1, +Y). Null + core_fail names the nearest.
gfx_mesh gfx_mesh_builtin(gfx_world *world, const char *name);
// Copies. From 512 triangles on it gets coarser levels of detail (quadric error metrics), each
// drawn where its surface is within half a pixel of the finest; `gfx.levels` = off draws the finest
// alone.
gfx_mesh gfx_mesh_create(gfx_world *world, const core_mesh_data *data);
typedef struct gfx_mesh_level {
    uint32_t triangles;
    float error; // m that its surface may be off the finest one
} gfx_mesh_level;
// Levels from fine to coarse; out[capacity] gets the first, may be NULL. 0 for a stale handle.
uint32_t gfx_mesh_levels(const gfx_world *world, gfx_mesh mesh, gfx_mesh_level *out,
                         uint32_t capacity);
// Instances of a destroyed mesh are no longer drawn. Built-in meshes stay: false.
bool gfx_mesh_destroy(gfx_world *world, gfx_mesh mesh);

typedef struct gfx_material_desc {
    core_material_data data;
    const char *fragment; // virtual path, 1..63 bytes, of a shader's part that changes what factors
                          // and maps give (assets/shaders/scene.frag: Look); NULL: none. Copied
    float parameters[16]; // parameter(0) .. parameter(15) there
    uint32_t cookie;
} gfx_material_desc;
gfx_material_desc gfx_material_desc_default(void); // white, rough 0.5, not metallic
gfx_material gfx_material_create(gfx_world *world, const gfx_material_desc *desc);
// Instances of a destroyed material are drawn in the default one.
bool gfx_material_destroy(gfx_world *world, gfx_material material);
bool gfx_material_alive(const gfx_world *world, gfx_material material);
bool gfx_material_set_parameters(gfx_world *world, gfx_material material,
                                 const float parameters[16]);

// A pass over each view's picture, by a file that defines vec3 effect(vec2 uv)
// (assets/shaders/effect.frag): on linear light before bloom and exposure, or on the encoded
// picture before 2D. Passes run in order of creation. One that does not compile is logged with file
// and line and left out.
typedef core_handle gfx_effect;
typedef struct gfx_effect_desc {
    const char *fragment; // virtual path, 1..63 bytes, copied
    bool encoded;         // false: linear light
    float parameters[16];
    uint32_t cookie;
} gfx_effect_desc;
gfx_effect_desc gfx_effect_desc_default(void);
gfx_effect gfx_effect_create(gfx_world *world, const gfx_effect_desc *desc); // 32 at most
bool gfx_effect_destroy(gfx_world *world, gfx_effect effect);
bool gfx_effect_alive(const gfx_world *world, gfx_effect effect);
bool gfx_effect_set_parameters(gfx_world *world, gfx_effect effect, const float parameters[16]);

typedef struct gfx_instance_desc {
    gfx_mesh mesh;
    gfx_material material; // null: default grey
    float color[4];        // multiplies the base colour; zero = white
    uint32_t cookie;
} gfx_instance_desc;
gfx_instance gfx_instance_create(gfx_world *world, const gfx_instance_desc *desc);
bool gfx_instance_destroy(gfx_world *world, gfx_instance instance);
bool gfx_instance_alive(const gfx_world *world, gfx_instance instance);
bool gfx_instance_set_color(gfx_world *world, gfx_instance instance, float r, float g, float b,
                            float a);
// World transform used by the next frames. Scene writes these once per drawn frame, interpolated.
bool gfx_instance_set_transform(gfx_world *world, gfx_instance instance, core_vec3 t, core_quat r,
                                core_vec3 s);

// Pose of a skinned instance: rows3x4[count*12], one 3x4 row-major matrix a bone that takes a
// vertex from bind pose to model space (inverse bind included). Copied. count must reach the mesh's
// largest joint; an instance of a skinned mesh without a palette is drawn in bind pose.
bool gfx_instance_set_palette(gfx_world *world, gfx_instance instance, const float *rows3x4,
                              uint32_t count);

// Zero fields mean default. A world whose camera was never set is seen as a whole, from a corner.
typedef struct gfx_camera {
    core_vec3 position;
    core_quat rotation; // looks along -Z
    float fovy;         // radians, default 60 degrees
    float near_plane;   // m, default 0.1
    float virtual_far;  // m, default 100: no point or spot light is seen beyond
    float ortho_height; // m seen from bottom to top: orthographic when > 0 (far = virtual_far)
} gfx_camera;
void gfx_world_set_camera(gfx_world *world, const gfx_camera *camera);
gfx_camera gfx_world_camera(const gfx_world *world);

// Views besides that of the world's camera. One with a target draws to a texture, before all others
// of its frame: materials and images have it under the path "target:NAME". Others share the
// picture, in order of creation; when there is one, the world's own camera draws nothing.
typedef core_handle gfx_viewport;
typedef struct gfx_viewport_desc {
    gfx_camera camera;
    float rect[4];          // x, y, width, height: shares of the picture, origin top left
    const char *target;     // name of a texture, 1..63 bytes, copied; NULL: the picture
    uint32_t width, height; // of the texture, pixels, 1..16384
    uint32_t cookie;
} gfx_viewport_desc;
gfx_viewport_desc gfx_viewport_desc_default(void); // the whole picture
// Null + core_fail: a bad rectangle, name or size, a target that another view has, or more than 64.
gfx_viewport gfx_viewport_create(gfx_world *world, const gfx_viewport_desc *desc);
bool gfx_viewport_destroy(gfx_world *world, gfx_viewport viewport);
bool gfx_viewport_alive(const gfx_world *world, gfx_viewport viewport);
bool gfx_viewport_set_camera(gfx_world *world, gfx_viewport viewport, const gfx_camera *camera);
bool gfx_viewport_camera(const gfx_world *world, gfx_viewport viewport, gfx_camera *out);
// The ray through a pixel of a picture (origin top left) of a camera: where it starts, unit
// direction.
void gfx_camera_ray(const gfx_camera *camera, float width, float height, float x, float y,
                    core_vec3 *origin, core_vec3 *direction);
// Where a point is in the picture: pixels, and its distance along the view (m, negative behind).
core_vec3 gfx_camera_project(const gfx_camera *camera, float width, float height, core_vec3 point);

// ---- terrain ----
// The surface of a field of heights, drawn by tiles that are as fine as they need to be to look
// true within gfx.terrain_error pixels; levels turn into one another without a jump or a crack.
typedef core_handle gfx_terrain;
typedef struct gfx_terrain_desc {
    core_heights_data heights;       // copied; at most 8193 points a side
    float low[3], high[3], steep[3]; // base colours, linear
    float heights_blend[2];          // m: from low to high, default none
    float slopes_blend[2];           // rise over run: from flat to steep, default 0.5 to 0.9
    const char *image;               // multiplies them, stretched over the whole; NULL: none
    float roughness;                 // default 0.9
    uint32_t cookie;
} gfx_terrain_desc;
gfx_terrain_desc gfx_terrain_desc_default(void); // grass and rock
gfx_terrain gfx_terrain_create(gfx_world *world, const gfx_terrain_desc *desc);
bool gfx_terrain_destroy(gfx_world *world, gfx_terrain terrain);
bool gfx_terrain_alive(const gfx_world *world, gfx_terrain terrain);
// Height of its finest surface at x, z (m); false beside it.
bool gfx_terrain_height(const gfx_world *world, gfx_terrain terrain, float x, float z,
                        float *height);

// ---- particles ----
// Small squares that face the viewer. Born at the emitter's rate in every step, at times between
// steps too; from then on a particle's place is a closed function of its age (constant
// acceleration, linear drag towards the wind): pictures depend neither on how many frames were
// drawn nor on the instruction set, and the simulation does not know of them.
typedef core_handle gfx_emitter;
typedef enum gfx_emit_shape { GFX_EMIT_POINT, GFX_EMIT_SPHERE, GFX_EMIT_BOX } gfx_emit_shape;
#define GFX_EMITTER_KEYS 8
typedef struct gfx_emitter_desc {
    core_vec3 position;
    core_quat rotation; // takes +Y to where particles fly; zero: identity
    gfx_emit_shape shape;
    core_vec3 extent;       // half, of a sphere (may be flat) or box, m
    float rate;             // births a second, default 20
    uint32_t burst;         // births at once
    uint32_t capacity;      // alive at once, <= 2^20; default: what rate, life and burst need. The
                            // oldest make room
    float life[2];          // s, least and most, > 0, default 1
    float speed[2];         // m/s, least and most
    float spread;           // half angle round the direction, radians; pi: everywhere
    core_vec3 acceleration; // m/s^2
    core_vec3 wind;         // m/s: speed that drag leads to
    float drag;             // 1/s
    float spin[2];          // radians a second, least and most; then the first angle is random
    // Over life, evenly spaced, linear in between.
    float size[GFX_EMITTER_KEYS];     // edge, m
    uint32_t size_keys;               // default one: 0.1 m
    float size_vary;                  // part by which sizes of particles differ, 0..1
    float color[GFX_EMITTER_KEYS][4]; // linear, may exceed 1; straight alpha
    uint32_t color_keys;              // default one: white
    const char *image;                // NULL: a soft disc
    uint32_t frames[2];               // columns and rows of the image that are shown over life
    bool additive;                    // light that is added, as of fire; else it covers, as smoke
    uint64_t seed;
    uint32_t cookie;
} gfx_emitter_desc;
gfx_emitter_desc gfx_emitter_desc_default(void);
gfx_emitter gfx_emitter_create(gfx_world *world, const gfx_emitter_desc *desc);
bool gfx_emitter_destroy(gfx_world *world, gfx_emitter emitter); // and its particles
bool gfx_emitter_alive(const gfx_world *world, gfx_emitter emitter);
// Where it is at the end of the next step: births in between are spread over the way there.
bool gfx_emitter_set_pose(gfx_world *world, gfx_emitter emitter, core_vec3 position,
                          core_quat rotation);
bool gfx_emitter_set_rate(gfx_world *world, gfx_emitter emitter, float rate);
bool gfx_emitter_burst(gfx_world *world, gfx_emitter emitter, uint32_t count);
bool gfx_emitter_set_user(gfx_world *world, gfx_emitter emitter, uint64_t user);
uint64_t gfx_emitter_user(const gfx_world *world, gfx_emitter emitter);
uint32_t gfx_emitters_count(const gfx_world *world);
gfx_emitter gfx_emitter_at(const gfx_world *world, uint32_t row); // row < gfx_emitters_count
// How many are alive at the moment that is drawn; places of the first, out may be NULL.
uint32_t gfx_emitter_particles(gfx_world *world, gfx_emitter emitter, core_vec3 *out,
                               uint32_t capacity);
// One step of dt seconds: births. Called once a step; dt must not change.
void gfx_world_step(gfx_world *world, float dt);
// The moment that frames show: 0 the end of the step before, 1 (so after a step) that of the last.
void gfx_world_set_moment(gfx_world *world, float alpha);

// ---- sprites and text in the world, for the next frame ----
typedef enum gfx_facing {
    GFX_FACE_VIEWER,  // turns wholly
    GFX_FACE_UPRIGHT, // turns about +Y
    GFX_FACE_FIXED    // stands as rotation says: its front is +Z, its top +Y
} gfx_facing;
typedef struct gfx_board_desc { // a picture or a text
    core_vec3 position;         // of its middle
    core_quat rotation;         // fixed only
    gfx_facing facing;
    float width, height; // m; width 0: as the picture has it. Text: height of a line, m
    const char *image;   // or
    const char *text;    // UTF-8, lines at '\n', middled
    const char *font;    // as gfx_text_desc
    float source[4];     // as gfx_sprite_desc
    float color[4];      // linear; zero: white
    bool additive;
    uint32_t cookie;
} gfx_board_desc;
gfx_board_desc gfx_board_desc_default(void);
bool gfx_draw_board(gfx_world *world, const gfx_board_desc *desc);

// ---- lines in the world, for the next frame ----
// Forgotten by gfx_world_begin_frame, as 2D is.
typedef struct gfx_pen {
    float color[4]; // linear, straight alpha
    float width;    // pixels, 0.5..64
    bool on_top;    // seen through everything
} gfx_pen;
gfx_pen gfx_pen_default(void); // white, 1.5 pixels
void gfx_draw_line(gfx_world *world, core_vec3 a, core_vec3 b, const gfx_pen *pen);
void gfx_draw_path(gfx_world *world, const core_vec3 *point, uint32_t count, const gfx_pen *pen);
// rotation zero: identity.
void gfx_draw_box(gfx_world *world, core_vec3 center, core_quat rotation, core_vec3 half,
                  const gfx_pen *pen);
void gfx_draw_sphere(gfx_world *world, core_vec3 center, float radius, const gfx_pen *pen);
// a, b: centres of the ends.
void gfx_draw_capsule(gfx_world *world, core_vec3 a, core_vec3 b, float radius, const gfx_pen *pen);
void gfx_draw_arrow(gfx_world *world, core_vec3 a, core_vec3 b, const gfx_pen *pen);
// Level square of size x size metres, in cells x cells.
void gfx_draw_grid(gfx_world *world, core_vec3 center, float size, uint32_t cells,
                   const gfx_pen *pen);

// ---- 2D: drawn over the next frame in call order ----
// Pixels, origin top left. Colours are sRGB-encoded with straight alpha. Text is UTF-8, y its top,
// size the height of a line; '\n' starts a line.
void gfx_print(gfx_world *world, float x, float y, float size, const float color[4],
               const char *text);
void gfx_rect(gfx_world *world, float x, float y, float w, float h, const float color[4]);
void gfx_image(gfx_world *world, const char *path, float x, float y, float w, float h);
// With smooth edges. radius: of the corners; border > 0: a frame that wide, on the inside.
void gfx_round_rect(gfx_world *world, float x, float y, float w, float h, float radius,
                    float border, const float color[4]);
void gfx_line(gfx_world *world, float x0, float y0, float x1, float y1, float width,
              const float color[4]);
typedef struct gfx_sprite_desc {
    const char *path; // of an image file
    float x, y;       // where the pivot lies
    float w, h;       // 0: of the source
    float source[4];  // x, y, width, height in the image, texels; width 0: all of it
    float pivot[2];   // of the sprite's width and height
    float angle;      // radians, clockwise about the pivot
    float color[4];   // multiplies the image; zero: white
    uint32_t cookie;
} gfx_sprite_desc;
gfx_sprite_desc gfx_sprite_desc_default(void);
bool gfx_sprite(gfx_world *world, const gfx_sprite_desc *desc);
// What follows is drawn only inside the rectangle, and inside those pushed before: at most
// GFX_CLIPS deep. False + core_fail beyond, and for a pop without its push.
#define GFX_CLIPS 16
bool gfx_clip_push(gfx_world *world, float x, float y, float w, float h);
bool gfx_clip_pop(gfx_world *world);
typedef struct gfx_text_desc {
    const char *text;
    const char *font; // "mono" (default; "fonts/default.ttf" of the game where it has one), "sans",
                      // or the virtual path of a TrueType file
    float x, y, size; // size: default 18, 4..256
    float width;      // lines break at spaces to stay within; 0: at '\n' alone
    float align;      // of lines in the width, or about x without one: 0 left, 0.5 middle, 1 right
    float color[4];
    uint32_t cookie;
} gfx_text_desc;
gfx_text_desc gfx_text_desc_default(void);
bool gfx_text(gfx_world *world, const gfx_text_desc *desc);
typedef struct gfx_text_box {
    float width, height; // pixels
    uint32_t lines;
} gfx_text_box;
// What a text will take; needs no device.
bool gfx_text_measure(gfx_world *world, const gfx_text_desc *desc, gfx_text_box *out);
// Forgets the 2D commands of the last frame; called before a draw callback.
void gfx_world_begin_frame(gfx_world *world);

// ---- device: GL from here on ----
typedef struct gfx_device_desc {
    bool window; // GLFW window; otherwise EGL surfaceless
    uint32_t width, height;
    const char *title;
    bool vsync;
    core_vfs *vfs; // shaders are read from "shaders/", images from anywhere; borrowed
    core_metrics *metrics;
    bool float_target; // RGBA32F HDR target (tests)
    // Images are read by a thread of their own and uploaded in parts: grey until they are there. A
    // device without it reads at first use, so that a frame is the same whenever it is drawn.
    bool background;
    uint32_t cookie;
} gfx_device_desc;
gfx_device_desc gfx_device_desc_default(void);
// NULL + core_fail ("environment": what is missing and what to install).
gfx_device *gfx_device_create(const gfx_device_desc *desc);
void gfx_device_destroy(gfx_device *device);
// Draws the world; false + core_fail on shader or GL errors (file and line).
bool gfx_device_render(gfx_device *device, gfx_world *world);
// Builds shaders and reads images whose files changed since anew (cheap when none did). What fails
// keeps its old form: false + core_fail with its file, and a shader's line.
bool gfx_device_reload(gfx_device *device);
// The frame last rendered: RGBA8 sRGB, rows top to bottom, width*height*4 bytes.
bool gfx_device_read(gfx_device *device, uint8_t *rgba);
// The HDR target before tone mapping, linear, width*height*4 floats, rows top to bottom.
bool gfx_device_read_float(gfx_device *device, float *rgba);
// Reversed-Z depth, width*height floats, rows top to bottom.
bool gfx_device_read_depth(gfx_device *device, float *depth);
// What a pass of the frame last rendered left: hdr (as gfx_device_read_float), depth, ao
// (visibility of ambient light, 0..1), bloom (scattered radiance at half the size), picture
// (encoded, 0..1). rgba: width*height*4 floats, one-channel passes repeated in r, g and b, a 1;
// NULL asks for the size alone. False + core_fail when there is no such pass or it did not run.
bool gfx_device_read_pass(gfx_device *device, const char *pass, float *rgba, uint32_t *width,
                          uint32_t *height);
// The same as a PNG: ao and depth (near / distance) as grey, hdr and bloom clipped to 1 and
// encoded.
bool gfx_device_shot_pass(gfx_device *device, const char *pass, const char *real_path);
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
    GFX_EVENT_FOCUS,
    GFX_EVENT_PAD,        // a gamepad came (pressed 1) or went (0)
    GFX_EVENT_PAD_BUTTON, // code: GLFW gamepad buttons, 0..14
    GFX_EVENT_PAD_AXIS    // code: GLFW gamepad axes, 0..5; x: -1..1 (triggers too)
} gfx_event_type;
typedef struct gfx_event {
    gfx_event_type type;
    int32_t code;    // key (GLFW codes), button, codepoint
    int32_t pressed; // 1 press, 0 release, 2 repeat
    float x, y;      // position, scroll, size (pixels)
} gfx_event;
// Next pending window event; false when none.
bool gfx_device_poll(gfx_device *device, gfx_event *out);
typedef enum gfx_cursor { GFX_CURSOR_NORMAL, GFX_CURSOR_HIDDEN, GFX_CURSOR_LOCKED } gfx_cursor;
// Locked: hidden and held in the window, its motion goes on without bounds. No-op without a window.
void gfx_device_set_cursor(gfx_device *device, gfx_cursor cursor);
const char *gfx_device_name(const gfx_device *device); // GL_RENDERER
bool gfx_device_software(const gfx_device *device);
// What the receipt shows: passes of the last frame, shader variants made so far, bytes of targets.
typedef struct gfx_device_use {
    uint32_t passes, shader_variants;
    size_t target_bytes;
    uint32_t loading;      // images on their way
    size_t uploaded_bytes; // of images read in the background, last frame
} gfx_device_use;
gfx_device_use gfx_device_used(const gfx_device *device);
// Passes by name that frames had since the device was made, in order of their first use.
typedef struct gfx_pass_use {
    const char *name;
    uint64_t runs;
    double gpu_ms; // least of the runs; 0: not known, as with software renderers
} gfx_pass_use;
const gfx_pass_use *gfx_device_passes(const gfx_device *device, uint32_t *count);

#endif
