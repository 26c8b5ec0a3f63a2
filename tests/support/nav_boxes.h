// Boxes as triangle soups, for tests of walkable surfaces.
#ifndef SUPPORT_NAV_BOXES_H
#define SUPPORT_NAV_BOXES_H

#include <string.h>

#include "core/data.h"

typedef struct nav_box {
    float vertex[24];
    uint32_t index[36];
    core_soup_data soup;
} nav_box;
// Twelve triangles, seen from outside counter-clockwise. Valid as long as b is.
static inline const core_soup_data *nav_box_soup(nav_box *b, core_vec3 low, core_vec3 high) {
    static const uint8_t face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (uint32_t k = 0; k < 8; k++) {
        b->vertex[3 * k] = k & 1 ? high.x : low.x;
        b->vertex[3 * k + 1] = k & 2 ? high.y : low.y;
        b->vertex[3 * k + 2] = k & 4 ? high.z : low.z;
    }
    for (int f = 0; f < 6; f++) {
        const uint32_t corner[6] = {face[f][0], face[f][1], face[f][2],
                                    face[f][0], face[f][2], face[f][3]};
        memcpy(b->index + 6 * f, corner, sizeof corner);
    }
    b->soup = (core_soup_data){8, 12, b->vertex, b->index, NULL};
    return &b->soup;
}

#endif
