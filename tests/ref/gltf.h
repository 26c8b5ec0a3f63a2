// A small, slow glTF 2.0 evaluator in double precision, written from the specification: the judge
// of the converter and of skinning. Reads what the models of ../shared/data/models use.
#ifndef TESTS_REF_GLTF_H
#define TESTS_REF_GLTF_H

#include <stddef.h>

typedef struct gltf gltf;
gltf *gltf_open(const char *path); // NULL: cannot be read
void gltf_close(gltf *g);
int gltf_animation_count(const gltf *g);
double gltf_animation_end(gltf *g, int animation); // s, last key
// Positions of all triangle corners of the scene, nodes depth first, primitives and indices in
// order, at a time of an animation (-1: the nodes' own transforms). Returns the number of corners;
// out may be NULL, else holds 3 doubles for each.
size_t gltf_corners(gltf *g, int animation, double time, double *out);

#endif
