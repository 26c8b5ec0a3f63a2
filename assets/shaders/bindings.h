// Binding points and block layouts, read by both C and GLSL: the only place where either is written
// down. Every block is std140/std430 compatible as it stands: 16-byte members only.
#ifndef GFX_BINDINGS_H
#define GFX_BINDINGS_H

#ifdef __STDC_VERSION__
#include <stdint.h>
typedef float gfx_glsl_vec4[4];
#define GFX_VEC4(name)  gfx_glsl_vec4 name
#define GFX_UVEC4(name) uint32_t name[4]
#define GFX_MAT4(name)  float name[16]
#else
#define GFX_VEC4(name)  vec4 name
#define GFX_UVEC4(name) uvec4 name
#define GFX_MAT4(name)  mat4 name
#endif

// Uniform blocks.
#define GFX_UBO_VIEW    0
#define GFX_UBO_TERRAIN 1

// Storage blocks.
#define GFX_SSBO_LIGHTS          0
#define GFX_SSBO_CLUSTER_OFFSETS 1
#define GFX_SSBO_CLUSTER_LIGHTS  2
#define GFX_SSBO_INSTANCES       3
#define GFX_SSBO_MATERIALS       4
#define GFX_SSBO_BONES           5
#define GFX_SSBO_QUADS           6
#define GFX_SSBO_ROWS            7
#define GFX_SSBO_SHADOWS         8
#define GFX_SSBO_CLUSTER_GRID    9
#define GFX_SSBO_EXPOSURE        10

// Texture units.
#define GFX_TEX_BASE_COLOR         0
#define GFX_TEX_NORMAL             1
#define GFX_TEX_METALLIC_ROUGHNESS 2
#define GFX_TEX_OCCLUSION          3
#define GFX_TEX_EMISSIVE           4
// Terrain has the units of material maps, which it does not use.
#define GFX_TEX_TERRAIN_IMAGE  0
#define GFX_TEX_TERRAIN_NORMAL 1
#define GFX_TEX_TERRAIN_HEIGHT 2
#define GFX_TEX_DFG            5
#define GFX_TEX_SHADOW         6
#define GFX_TEX_HDR            8
#define GFX_TEX_IMAGE          9
#define GFX_TEX_ENVIRONMENT    10
#define GFX_TEX_PANORAMA       11
#define GFX_TEX_AO             12
#define GFX_TEX_BLOOM          13
#define GFX_TEX_DEPTH          14
#define GFX_TEX_LIGHTS         15

#define GFX_DFG_SIZE           64 // texels a side
#define GFX_ENVIRONMENT_SIZE   64 // texels a side of a face of the first level
#define GFX_ENVIRONMENT_LEVELS 6  // roughness 0, 0.2, .. 1

// Vertex attributes.
#define GFX_ATTR_POSITION 0
#define GFX_ATTR_NORMAL   1
#define GFX_ATTR_TANGENT  2
#define GFX_ATTR_UV       3
#define GFX_ATTR_COLOR    4
#define GFX_ATTR_JOINT    5
#define GFX_ATTR_WEIGHT   6

// Plain uniforms (glUniform locations).
#define GFX_U_INSTANCE   0
#define GFX_U_FACE       1
#define GFX_U_SIZE       2
#define GFX_U_ROUGHNESS  3
#define GFX_U_SAMPLES    4
#define GFX_U_PARAMETERS 8 // of a script's shader: four vec4, up to 11
#define GFX_PARAMETERS   16

#define GFX_LIGHT_POINT       0
#define GFX_LIGHT_SPOT        1
#define GFX_LIGHT_DIRECTIONAL 2

#define GFX_TONEMAP_NEUTRAL 0
#define GFX_TONEMAP_LINEAR  1

#define GFX_DEBUG_OFF      0
#define GFX_DEBUG_NORMALS  1
#define GFX_DEBUG_DEPTH    2
#define GFX_DEBUG_LIGHTS   3 // in each cell, 32 are red
#define GFX_DEBUG_CLUSTERS 4
#define GFX_DEBUG_OVERDRAW 5

struct gfx_view_block {
    GFX_MAT4(view_proj);
    GFX_MAT4(view);
    GFX_VEC4(camera);         // xyz position, w near plane (perspective) or 0 (orthographic)
    GFX_VEC4(viewport);       // width, height, 1/width, 1/height (pixels)
    GFX_VEC4(ambient_sky);    // rgb radiance from above, w exposure
    GFX_VEC4(ambient_ground); // rgb radiance from below
    GFX_VEC4(cluster_scale);  // tiles per pixel x, y; slices per log2(depth), or per metre; bias
    GFX_VEC4(depth_range);    // orthographic: near, far; z = virtual far (m)
    GFX_UVEC4(cluster_grid);  // cells x, y, z; 1 when slices are linear
    GFX_UVEC4(light_count);   // directional, point and spot, tone map, debug view
    GFX_VEC4(lens);           // half extents of the view at depth 1; taps and bias of shadows
    GFX_VEC4(sky_zenith);     // rgb radiance; w: factor of the environment
    GFX_VEC4(sky_horizon);
    GFX_VEC4(sky_ground);
    GFX_VEC4(sky_glow); // rgb radiance round the sun
    GFX_VEC4(sky_sun);  // unit direction to it; exponent of the glow
    GFX_VEC4(harmonics[9]);
    GFX_VEC4(ao);        // strength, radius (m), slices, steps a side
    GFX_VEC4(fog);       // density at the base height (1/m), its falloff (1/m), base height (m)
    GFX_VEC4(fog_color); // rgb radiance
    GFX_VEC4(bloom);     // strength, threshold
    GFX_VEC4(grade);     // contrast, saturation; key and adaptation of the automatic exposure
    GFX_VEC4(lift);
    GFX_VEC4(gain);
};

#define GFX_SHADOW_COUNT_UNIT 128 // above the number of any shadow view

struct gfx_light_block {
    GFX_VEC4(position); // world, m; 1/radius^2. Directional: unit, towards the light; 0
    GFX_VEC4(color);    // linear intensity; 0 without shadow, else 1 + first shadow view + their
                        // number * GFX_SHADOW_COUNT_UNIT
    GFX_VEC4(cone);     // squared smooth falloff: scale against the light's way, offset
};

// One depth map: a cascade of a sun, a spot, or one of six faces of a point light.
struct gfx_shadow_block {
    GFX_MAT4(matrix); // world to map coordinates 0..1 and reversed depth
    GFX_VEC4(texel);  // metres a texel: across (orthographic), or at 1 m (perspective); texels a
                      // side; size of the source: metres, or tangent of its angular radius
    GFX_VEC4(depth);  // orthographic: depth range (m), 0; perspective: near plane (m), 1; end of
                      // the cascade (view depth, m); layer
};

#define GFX_CLUSTER_GROUP 64          // threads of a group of cluster.comp
#define GFX_CLUSTER_ALL   0x80000000u // of a cell's offset: the cell is lit by all lights

struct gfx_cluster_block { // what cluster.comp knows of the grid
    GFX_UVEC4(size);       // columns, rows, slices; lights
    GFX_VEC4(lens);        // half extents at depth 1; 1 with perspective
    GFX_VEC4(margin);      // of a column, a row; of a slice as part of its depth; least depth (m)
    GFX_VEC4(depth[17]);   // bounds of the slices
};

struct gfx_cluster_light_block { // view space: x right, y up, depth ahead
    GFX_VEC4(sphere);            // w: radius
    GFX_VEC4(apex);              // of its cone; w: sine of the half angle
    GFX_VEC4(axis);              // w: cosine, 0 without a cone
    GFX_VEC4(range);             // x: m from the apex
};

#define GFX_EXPOSURE_BINS  128   // of log2 luminance
#define GFX_EXPOSURE_RANGE 16.0f // the histogram spans 2^-16 to 2^16

struct gfx_instance_block {
    GFX_VEC4(row0); // world transform, rows of a 3x4 matrix
    GFX_VEC4(row1);
    GFX_VEC4(row2);
    GFX_VEC4(color);
    GFX_UVEC4(index); // material, first bone row
};

struct gfx_material_block {
    GFX_VEC4(base_color);
    GFX_VEC4(emissive_metallic); // rgb, metallic
    GFX_VEC4(params);            // roughness, normal scale, occlusion strength, alpha cut-off
};

#define GFX_TERRAIN_LEVELS 16
#define GFX_TERRAIN_TILE   8 // squares along an edge of a tile

struct gfx_terrain_block {
    GFX_VEC4(origin); // of the first point, m; 1 with an image
    GFX_VEC4(eye);    // that distances are taken from
    GFX_VEC4(grid);   // m from point to point along x, z; last column, last row
    GFX_VEC4(low);    // linear base colours; roughness
    GFX_VEC4(high);
    GFX_VEC4(steep);
    GFX_VEC4(blend); // height from which high begins, 1 over its span; slope of steep, the same
    GFX_VEC4(morph[GFX_TERRAIN_LEVELS]); // distance at which a level turns, 1 over the way
};

struct gfx_line_block {
    GFX_VEC4(from);  // world, m; width in pixels
    GFX_VEC4(to);    // world, m; 1: not hidden by anything
    GFX_VEC4(color); // linear, straight alpha
};

struct gfx_board_block {
    GFX_VEC4(place); // middle, world, m; 1: added to what is behind
    GFX_VEC4(right); // half edges, m
    GFX_VEC4(up);
    GFX_VEC4(uv);    // u0, v0, u1, v1
    GFX_VEC4(color); // linear, straight alpha
};

struct gfx_quad_block {
    GFX_VEC4(place); // xy: first corner in pixels, origin top left; radius of the corners; border
    GFX_VEC4(axes);  // its two edges, pixels
    GFX_VEC4(uv);    // u0, v0, u1, v1
    GFX_VEC4(color); // sRGB-encoded, straight alpha
    GFX_VEC4(clip);  // left, top, right, bottom, pixels
};

#endif
