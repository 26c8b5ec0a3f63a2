// Maps and scenarios of the Moving AI benchmark under ../shared/data/nav.
#ifndef MOVING_AI_H
#define MOVING_AI_H

#include "nav/nav.h"

extern const char *const moving_ai_maps[7];

typedef struct moving_ai_map {
    uint32_t width, height;
    uint8_t *blocked; // [width*height], core_free
} moving_ai_map;
typedef struct moving_ai_query {
    nav_cell start, goal;
    double optimum; // octile length
} moving_ai_query;

// False when the file is absent or not such a map.
bool moving_ai_load(const char *name, moving_ai_map *out);
// All queries of a map's scenario; core_free the result. NULL when absent.
moving_ai_query *moving_ai_scenario(const char *name, uint32_t *count);

// Every `step`-th query by both methods: fails the test where a length is not the published one.
// Returns how many were tried, 0 when the data is absent.
int moving_ai_check(nav_world *world, const char *name, uint32_t step);

// Every `step`-th query whose true Euclidean length is known, on the surface of the map's free
// cells: fails the test where the ratio to it is off by more than 2 %, or 0.2 % on the mean.
int moving_ai_check_euclid(nav_world *world, const char *name, uint32_t step);

#endif
