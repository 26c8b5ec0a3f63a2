// Triangles as collision geometry: the tree over a mesh's triangles, and the contact of a convex
// shape with one of them. A height field makes the same patches from its cells. Not public.
#ifndef PHYS_MESH_INTERNAL_H
#define PHYS_MESH_INTERNAL_H

#include "phys/world.h"

#define PHYS_MESH_TRIANGLES (1u << 24)
#define PHYS_MESH_NONE      UINT32_MAX
#define PHYS_MESH_LEAF      4u // triangles

// Boxes of triangles, parents before children: count != 0 is a leaf of triangles [first, first +
// count), else the children are first and first + 1.
typedef struct phys_mesh_node {
    float lo[3];
    uint32_t first;
    float hi[3];
    uint32_t count;
} phys_mesh_node;

// Triangles in the tree's order; equal places are one vertex.
typedef struct phys_mesh {
    uint32_t vertex_count, triangle_count, node_count, material_count;
    core_vec3 *vertex;       // [vertex_count]
    uint32_t *index;         // [3 * triangle_count]
    uint32_t *beyond;        // [3 * triangle_count] triangle over edge k, k + 1; none: a border
    uint32_t *origin;        // [triangle_count] its number in the soup
    uint8_t *area;           // [triangle_count] the soup's, or NULL
    phys_material *material; // [material_count] by area
    phys_mesh_node *node;    // [node_count]
    bool one_sided;
    // A field of heights has these instead of vertex, index, beyond, origin and area; numbers of
    // triangles that are not there belong to the border and to holes.
    core_heights_data heights;
    float *height; // [columns * rows], NULL: a mesh of triangles
    uint8_t *cell; // [(columns - 1) * (rows - 1)] area or PHYS_HOLE, or NULL
} phys_mesh;

// False + core_fail for no triangles, indices out of range, places that are not finite or beyond
// 1e6 m.
bool phys_mesh_check(const phys_shape_desc *desc);
// Of a description that passed the check. False + core_fail when no triangle has an area.
bool phys_mesh_build(phys_mesh *mesh, const phys_shape_desc *desc);
void phys_mesh_release(phys_mesh *mesh);
size_t phys_mesh_bytes(const phys_mesh *mesh);
core_aabb phys_mesh_bounds(const phys_mesh *mesh); // own frame

// heights.c
bool phys_heights_check(const phys_shape_desc *desc);
uint64_t phys_heights_hash(const phys_shape_desc *desc);
void phys_heights_build(phys_mesh *mesh, const phys_shape_desc *desc); // of one that passed
size_t phys_heights_bytes(const phys_mesh *mesh);
bool phys_heights_there(const phys_mesh *mesh, uint32_t triangle);
core_vec3 phys_heights_corner(const phys_mesh *mesh, uint32_t triangle, uint32_t k);
uint32_t phys_heights_beyond(const phys_mesh *mesh, uint32_t triangle, uint32_t k);
uint8_t phys_heights_area(const phys_mesh *mesh, uint32_t triangle);
uint32_t phys_heights_origin(const phys_mesh *mesh, uint32_t triangle); // cell * 2 + half

static inline bool phys_mesh_there(const phys_mesh *m, uint32_t t) {
    return m->height == NULL || phys_heights_there(m, t);
}
static inline core_vec3 phys_mesh_corner(const phys_mesh *m, uint32_t t, uint32_t k) {
    return m->height != NULL ? phys_heights_corner(m, t, k)
                             : m->vertex[m->index[3 * (size_t)t + k]];
}
static inline uint8_t phys_mesh_area(const phys_mesh *m, uint32_t t) {
    return m->height != NULL ? phys_heights_area(m, t) : m->area != NULL ? m->area[t] : 0;
}
static inline uint32_t phys_mesh_origin(const phys_mesh *m, uint32_t t) {
    return m->height != NULL ? phys_heights_origin(m, t) : m->origin[t];
}

// Walks the leaves whose box meets the one asked for, grown by nothing, in the tree's order.
typedef struct phys_mesh_walk {
    const phys_mesh *mesh;
    phys_box box;
    uint32_t stack[64], depth, triangle, end;
} phys_mesh_walk;
void phys_mesh_walk_begin(phys_mesh_walk *walk, const phys_mesh *mesh, const phys_box *box);
uint32_t phys_mesh_walk_next(phys_mesh_walk *walk); // a triangle, or PHYS_MESH_NONE

// One triangle seen from a shape: corners relative to its centre, axes of the mesh. Triangles much
// larger than the shape are cut to its surroundings, which keeps every digit that counts.
#define PHYS_PATCH_CORNERS 9
typedef struct phys_patch {
    core_vec3 corner[PHYS_PATCH_CORNERS]; // counter-clockwise seen from the front
    // Direction in the plane of what lies over edge k (corner k, k + 1), away from it: points from
    // there across the edge. Zero: nothing lies there.
    core_vec3 across[PHYS_PATCH_CORNERS];
    uint32_t count, id;
    core_vec3 normal; // unit, to the front
    bool one_sided;
} phys_patch;

// corner: of the triangle; over: normals of the triangles over edges k, k + 1 (zero: none), front
// sides alike; center: of the shape, same frame; reach: how far from it anything matters. False:
// the triangle has no area, or nothing of it is in reach.
bool phys_patch_make(const core_vec3 corner[3], const core_vec3 over[3], core_vec3 center,
                     float reach, phys_patch *out);
bool phys_mesh_patch(const phys_mesh *mesh, uint32_t triangle, core_vec3 center, float reach,
                     phys_patch *out);

// Contact of a convex shape (frame of the patch) and a patch: as phys_collide, normals from the
// shape to the patch. Normals are those of the whole surface: an edge or corner counts only where
// the neighbours leave room for it (Voronoi regions; Ericson, Real-Time Collision
// Detection, 5.1.5), so that nothing stumbles over the inner edges of a smooth surface.
void phys_patch_collide(const phys_geom *shape, const phys_patch *patch, float margin,
                        phys_manifold *out);

float phys_patch_separation(const phys_geom *shape, const phys_patch *patch, core_vec3 *normal,
                            core_vec3 *on_patch);
bool phys_patch_sweep(const phys_moving *shape, const phys_patch *patch, float dt, float *time);

// Contacts of one shape with many triangles, gathered by direction: one manifold each.
#define PHYS_PARTS PHYS_MESH_PARTS
typedef struct phys_parts {
    phys_manifold m[PHYS_PARTS];
    uint8_t area[PHYS_PARTS];
    uint32_t count;
} phys_parts;
void phys_parts_add(phys_parts *parts, const phys_manifold *m, uint8_t area);

// A shape's motion seen from a mesh, in world or mesh axes alike: all contacts within the step.
// shape: frame of the mesh, moving relative to it.
void phys_mesh_contacts(const phys_mesh *mesh, const phys_moving *shape, float margin, bool fast,
                        float dt, phys_parts *out);
// Frame changes between the world and a mesh's.
phys_geom phys_geom_seen_from(const phys_geom *geom, const phys_geom *frame);
phys_moving phys_moving_seen_from(const phys_moving *m, const phys_geom *frame);

// From a frame to the world.
void phys_manifold_place(phys_manifold *m, const phys_geom *frame);

// Of meshes in phys_collide, phys_separation, phys_sweep and rays; the other shape is convex.
void phys_mesh_collide(const phys_geom *shape, const phys_geom *mesh, float margin,
                       phys_manifold *out);
float phys_mesh_separation(const phys_geom *shape, const phys_geom *mesh, core_vec3 *normal,
                           core_vec3 *on_mesh);
// False: no triangle is nearer than `reach` (m). True: one may be.
bool phys_mesh_near(const phys_geom *shape, const phys_geom *mesh, float reach);
// Every direction in which the surface comes nearer than `reach`: unit normals from the shape to
// the mesh, places on the mesh, gaps (m). Returns how many.
uint32_t phys_mesh_touches(const phys_geom *shape, const phys_geom *mesh, float reach,
                           core_vec3 normal[PHYS_PARTS], core_vec3 on_mesh[PHYS_PARTS],
                           float gap[PHYS_PARTS]);
bool phys_mesh_sweep(const phys_moving *shape, const phys_geom *mesh, float dt, float *time);
phys_geom_ray_hit phys_mesh_ray(const phys_geom *mesh, core_vec3 o, core_vec3 d, float t_max,
                                uint32_t *triangle);

#endif
