// Simplification of triangle meshes by quadric error metrics (Garland, Heckbert, "Surface
// Simplification Using Quadric Error Metrics", SIGGRAPH 1997). Vertices are only left out, never
// moved: what is left keeps its normals, texture coordinates and weights.
#ifndef GFX_SIMPLIFY_H
#define GFX_SIMPLIFY_H

#include "core/data.h"

typedef struct gfx_simplifier gfx_simplifier;
gfx_simplifier *gfx_simplifier_create(const core_mesh_data *mesh); // borrowed
void gfx_simplifier_destroy(gfx_simplifier *s);
// Goes on until at most `triangles` are left, or nothing can be left out without a quadric error
// (root of the summed squares of distances from planes) beyond `most` metres. Returns how many are
// left.
uint32_t gfx_simplify(gfx_simplifier *s, uint32_t triangles, float most);
const uint32_t *gfx_simplifier_index(const gfx_simplifier *s); // three a triangle
// Farthest that a vertex or the middle of a face of the whole mesh lies from what is left, m.
float gfx_simplifier_error(const gfx_simplifier *s);

#endif
