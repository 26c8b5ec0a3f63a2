// Private to engine/nav: the world as columns of solid intervals.
#ifndef NAV_NAV_FIELD_H
#define NAV_NAV_FIELD_H

#include "nav/nav_internal.h"

typedef struct nav_solid {
    float low, high; // m
    float stand;     // height of the top over the middle of the cell, m
    bool walkable;   // its top is level enough
} nav_solid;

typedef struct nav_field {
    uint32_t width, depth; // cells
    float cell_size;       // m
    core_vec3 origin;      // corner of the first cell; y is 0
    uint32_t *first;       // [width*depth + 1] first interval of a column, lowest first
    nav_solid *solid;
} nav_field;

// False + core_fail for vertices and indices that are no good, and for too many cells.
bool nav_field_make(nav_field *field, const core_soup_data *soup, float cell_size, float max_slope);
void nav_field_release(nav_field *field);
// The places where an agent can stand, linked and kept clear of borders by its radius.
void nav_field_spans(const nav_field *field, const nav_mesh_desc *desc, nav_spans *out);

#endif
