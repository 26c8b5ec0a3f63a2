// Geometry of points, lines, triangles and convex sets: pure functions, no world, no state. The set
// is that of the report's section 5.8.2, each in its right form. Metres and radians; normals are
// unit; results are deterministic. Functions that need precision compute in double and round once
// at the end.
//
// A *line* argument pair (a, b) means the infinite line through both when `segment` is false, else
// the segment. A *convex set* is the hull of `count` points (any order, interior points allowed).
#ifndef PHYS_GEOM_H
#define PHYS_GEOM_H

#include "core/math.h"

// ---- points inside ----
// Boundary counts as inside. `tolerance` in metres widens the set.
bool phys_geom_point_in_tetrahedron(core_vec3 p, const core_vec3 t[4], float tolerance);
bool phys_geom_point_in_convex(core_vec3 p, const core_vec3 *points, uint32_t count,
                               float tolerance);

// ---- closest points (Ericson, Real-Time Collision Detection, chapter 5) ----
typedef struct phys_geom_closest {
    core_vec3 a, b; // closest points: a on the first argument, b on the second
    float distance; // |b - a|
} phys_geom_closest;
core_vec3 phys_geom_closest_point_line(core_vec3 p, core_vec3 a, core_vec3 b, bool segment);
// Parallel and zero-length lines give one of the closest pairs.
phys_geom_closest phys_geom_closest_points_lines(core_vec3 a0, core_vec3 a1, bool a_segment,
                                                 core_vec3 b0, core_vec3 b1, bool b_segment);
core_vec3 phys_geom_closest_point_triangle(core_vec3 p, core_vec3 a, core_vec3 b, core_vec3 c);
phys_geom_closest phys_geom_closest_points_line_triangle(core_vec3 a, core_vec3 b, bool segment,
                                                         const core_vec3 t[3]);
// Convex planar polygon of count >= 1 points in order.
core_vec3 phys_geom_closest_point_polygon(core_vec3 p, const core_vec3 *polygon, uint32_t count);
// Plane dot(normal, x) = offset.
core_vec3 phys_geom_closest_point_plane(core_vec3 p, core_vec3 normal, float offset);
core_vec3 phys_geom_closest_point_tetrahedron(core_vec3 p, const core_vec3 t[4]);
phys_geom_closest phys_geom_closest_points_line_tetrahedron(core_vec3 a, core_vec3 b, bool segment,
                                                            const core_vec3 t[4]);
core_vec3 phys_geom_closest_point_convex(core_vec3 p, const core_vec3 *points, uint32_t count);
phys_geom_closest phys_geom_closest_points_line_convex(core_vec3 a, core_vec3 b, bool segment,
                                                       const core_vec3 *points, uint32_t count);

// ---- rays: origin o, direction d (any length > 0), hit at p = o + t*d with 0 <= t <= t_max ----
// A ray that starts inside a solid hits at t = 0 with normal -d/|d|. Triangles are two-sided; the
// normal faces the origin. d = 0 or NaN misses.
typedef struct phys_geom_ray_hit {
    bool hit;
    core_vec3 point, normal;
    float t;
} phys_geom_ray_hit;
phys_geom_ray_hit phys_geom_ray_miss(void);
phys_geom_ray_hit phys_geom_ray_triangle(core_vec3 o, core_vec3 d, float t_max,
                                         const core_vec3 t[3]);
phys_geom_ray_hit phys_geom_ray_sphere(core_vec3 o, core_vec3 d, float t_max, core_vec3 center,
                                       float radius);
// Box of half extents `half` at (position, rotation).
phys_geom_ray_hit phys_geom_ray_box(core_vec3 o, core_vec3 d, float t_max, core_vec3 half,
                                    core_vec3 position, core_quat rotation);
phys_geom_ray_hit phys_geom_ray_capsule(core_vec3 o, core_vec3 d, float t_max, core_vec3 a,
                                        core_vec3 b, float radius);
// Cylinder along local y, centred.
phys_geom_ray_hit phys_geom_ray_cylinder(core_vec3 o, core_vec3 d, float t_max, float half_height,
                                         float radius, core_vec3 position, core_quat rotation);
phys_geom_ray_hit phys_geom_ray_tetrahedron(core_vec3 o, core_vec3 d, float t_max,
                                            const core_vec3 t[4]);
// GJK ray cast (van den Bergen 2004): no faces needed.
phys_geom_ray_hit phys_geom_ray_convex(core_vec3 o, core_vec3 d, float t_max,
                                       const core_vec3 *points, uint32_t count);

// ---- bounds ----
core_aabb phys_geom_bounds_sphere(core_vec3 center, float radius);
core_aabb phys_geom_bounds_capsule(core_vec3 a, core_vec3 b, float radius);
core_aabb phys_geom_bounds_box(core_vec3 half, core_vec3 position, core_quat rotation);
core_aabb phys_geom_bounds_convex(const core_vec3 *points, uint32_t count, core_vec3 position,
                                  core_quat rotation);

// ---- intersections ----
typedef struct phys_geom_overlap {
    bool hit;
    core_vec3 point; // in the middle of the overlap
    core_vec3
        normal;  // unit, from the first to the second: moving the second by depth*normal parts them
    float depth; // >= 0; touching counts as a hit of depth 0
} phys_geom_overlap;
phys_geom_overlap phys_geom_overlap_miss(void);

// A convex set with a pose, inflated by a radius: a sphere is one point, a capsule two.
// half_height > 0 makes it a cylinder along local y instead (points unused, radius its own).
typedef struct phys_geom_convex {
    const core_vec3 *point;
    uint32_t count;
    float radius;
    float half_height;
    core_vec3 position;
    core_quat rotation; // unit
} phys_geom_convex;

phys_geom_overlap phys_geom_intersect_aabb_aabb(core_aabb a, core_aabb b);
phys_geom_overlap phys_geom_intersect_box_box(core_vec3 half_a, core_vec3 pa, core_quat qa,
                                              core_vec3 half_b, core_vec3 pb, core_quat qb);
phys_geom_overlap phys_geom_intersect_box_sphere(core_vec3 half, core_vec3 p, core_quat q,
                                                 core_vec3 center, float radius);
phys_geom_overlap phys_geom_intersect_box_capsule(core_vec3 half, core_vec3 p, core_quat q,
                                                  core_vec3 a, core_vec3 b, float radius);
phys_geom_overlap phys_geom_intersect_point_sphere(core_vec3 p, core_vec3 center, float radius);
phys_geom_overlap phys_geom_intersect_sphere_sphere(core_vec3 pa, float ra, core_vec3 pb, float rb);
phys_geom_overlap phys_geom_intersect_sphere_capsule(core_vec3 p, float r, core_vec3 a, core_vec3 b,
                                                     float radius);
phys_geom_overlap phys_geom_intersect_sphere_convex(core_vec3 p, float r,
                                                    const phys_geom_convex *convex);
phys_geom_overlap phys_geom_intersect_capsule_capsule(core_vec3 a0, core_vec3 a1, float ra,
                                                      core_vec3 b0, core_vec3 b1, float rb);
phys_geom_overlap phys_geom_intersect_capsule_convex(core_vec3 a, core_vec3 b, float radius,
                                                     const phys_geom_convex *convex);
phys_geom_overlap phys_geom_intersect_convex_convex(const phys_geom_convex *a,
                                                    const phys_geom_convex *b);
// Contact polygon: overlap of two coplanar convex polygons (supports of two touching sets) seen
// along `normal`. Writes at most `capacity` points (count_a + count_b suffices); returns how many.
uint32_t phys_geom_intersect_supports(const core_vec3 *a, uint32_t count_a, const core_vec3 *b,
                                      uint32_t count_b, core_vec3 normal, core_vec3 *out,
                                      uint32_t capacity);

// ---- volumes (m^3) ----
float phys_geom_volume_tetrahedron(const core_vec3 t[4]); // never negative
float phys_geom_volume_sphere(float radius);
float phys_geom_volume_box(core_vec3 half);
float phys_geom_volume_cylinder(float half_height, float radius);
float phys_geom_volume_capsule(float half_height, float radius); // half of the segment
// 0 + core_fail when the points span no volume.
float phys_geom_volume_convex(const core_vec3 *points, uint32_t count);

// ---- inertia of mass 1 (kg m^2 per kg), symmetric: xx yy zz xy xz yz ----
typedef struct phys_geom_inertia {
    float xx, yy, zz, xy, xz, yz;
} phys_geom_inertia;
// From the centre of mass to a point `offset` away (parallel axes), for mass `mass`.
phys_geom_inertia phys_geom_inertia_shift(phys_geom_inertia i, float mass, core_vec3 offset);
// R I R^T for R body -> world.
phys_geom_inertia phys_geom_inertia_rotate(phys_geom_inertia i, core_quat rotation);
// About the tetrahedron's centre of mass (Tonon 2005).
phys_geom_inertia phys_geom_inertia_tetrahedron(const core_vec3 t[4]);
phys_geom_inertia phys_geom_inertia_sphere(float radius);
phys_geom_inertia phys_geom_inertia_box(core_vec3 half);
phys_geom_inertia phys_geom_inertia_cylinder(float half_height, float radius); // axis y
phys_geom_inertia phys_geom_inertia_capsule(float half_height, float radius);  // axis y
// About the centre of mass, which goes to *center (may be NULL). False + core_fail without volume.
bool phys_geom_inertia_convex(const core_vec3 *points, uint32_t count, phys_geom_inertia *out,
                              core_vec3 *center);

// ---- transforms (in place) ----
void phys_geom_translate_points(core_vec3 *points, uint32_t count, core_vec3 by);
void phys_geom_transform_points(core_vec3 *points, uint32_t count, core_vec3 position,
                                core_quat rotation);

// ---- supports ----
// Sorts indices 0..count-1 of points by dot(points[i], direction), ties by index (report:
// sweepSortingFunction).
void phys_geom_sweep_sort(const core_vec3 *points, uint32_t count, core_vec3 direction,
                          uint32_t *order);
// Index of the farthest point along d; the lowest index wins ties.
uint32_t phys_geom_support_point(const core_vec3 *points, uint32_t count, core_vec3 d);
// The three farthest points along d, farthest first; count >= 3.
void phys_geom_support_triangle(const core_vec3 *points, uint32_t count, core_vec3 d,
                                uint32_t out[3]);
// All points within `tolerance` of the support plane, as a convex polygon in order about d. Returns
// the number of indices written (<= capacity).
uint32_t phys_geom_support_polygon(const core_vec3 *points, uint32_t count, core_vec3 d,
                                   float tolerance, uint32_t *out, uint32_t capacity);

// ---- convex hulls ----
typedef struct phys_geom_hull {
    uint32_t vertex_count, face_count, loop_count; // loop_count = indices of all faces
    core_vec3 *vertex;                             // [vertex_count]
    core_vec3 *normal;                             // [face_count] unit, outward
    float *offset;        // [face_count] dot(normal, x) = offset on the face
    uint32_t *face_begin; // [face_count + 1] into loop
    uint32_t *loop;       // [loop_count] vertices of each face, counter-clockwise from outside
} phys_geom_hull;
// Quickhull (Barber, Dobkin, Huhdanpaa 1996) with exact predicates on a grid of 2^-24 of the
// extent, so that it cannot fail topologically; nearly coplanar triangles are merged into polygons.
// Duplicates and interior points are dropped. False + core_fail for < 4 points, NaN or infinite
// ones, and sets thinner than 1e-5 of their extent. count <= 65536. Release with
// phys_geom_hull_release.
bool phys_geom_hull_build(phys_geom_hull *hull, const core_vec3 *points, uint32_t count);
void phys_geom_hull_release(phys_geom_hull *hull);
// Triangles of a planar convex polygon (fan): 3*(count-2) indices to out.
uint32_t phys_geom_triangulate_polygon(uint32_t count, uint32_t *out);
// Surface triangles: 3*(loop_count - 2*face_count) vertex indices to out; returns that number.
uint32_t phys_geom_hull_triangles(const phys_geom_hull *hull, uint32_t *out);
// Tetrahedra from vertex 0 (no Steiner point is needed for a convex set): 4 vertex indices each;
// returns the number of tetrahedra; `out` needs 4 * (triangles not touching vertex 0); NULL counts.
uint32_t phys_geom_tetrahedralize(const phys_geom_hull *hull, uint32_t *out);

// ---- the two general tests ----
// Separating axes over hulls: face normals of both and crosses of their edge directions.
phys_geom_overlap phys_geom_sat(const phys_geom_hull *a, core_vec3 pa, core_quat qa,
                                const phys_geom_hull *b, core_vec3 pb, core_quat qb);
// GJK distance (Gilbert, Johnson, Keerthi 1988; van den Bergen 1999); when the cores overlap, EPA
// (van den Bergen 2001) gives depth and normal. distance >= 0 between surfaces when apart;
// `overlap.hit` when not.
typedef struct phys_geom_gjk_result {
    phys_geom_closest closest; // valid when not overlap.hit
    phys_geom_overlap overlap;
    uint32_t iterations;
} phys_geom_gjk_result;
phys_geom_gjk_result phys_geom_gjk(const phys_geom_convex *a, const phys_geom_convex *b);

// ---- the rest ----
core_vec3 phys_geom_orthogonal(core_vec3 v); // unit, dot with v is 0; any input gives a unit vector
core_vec3 phys_geom_average(const core_vec3 *points, uint32_t count);
core_vec3 phys_geom_weighted_average(const core_vec3 *points, const float *weights, uint32_t count);
// Weights of a, b, c for p's projection on the plane; they sum to 1. False for degenerate
// triangles.
bool phys_geom_barycentric(core_vec3 p, const core_vec3 t[3], float out[3]);
void phys_geom_box_vertices(core_vec3 half, core_vec3 out[8]);
// Centroids of a capsule's two hemispheres (axis y, half = half of the segment).
void phys_geom_capsule_hemispheres(float half_height, float radius, core_vec3 out[2]);
// Strictly on one side, or either on the plane.
bool phys_geom_same_side(core_vec3 a, core_vec3 b, core_vec3 plane_point, core_vec3 normal);

#endif
