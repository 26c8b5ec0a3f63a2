// Slow, exact geometry of cluster cells, in double precision.
#ifndef REF_FRUSTUM_H
#define REF_FRUSTUM_H

// Distance from a point to a hexahedron with plane faces, 0 inside. Corner number bits: 1 = right,
// 2 = up, 4 = far.
double ref_hexahedron_distance(const double corner[8][3], const double point[3]);

#endif
