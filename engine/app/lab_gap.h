// How far two runs of one scene are apart.
#ifndef APP_LAB_GAP_H
#define APP_LAB_GAP_H

#include "scene/scene.h"

typedef struct app_gap { // of the entities' places at one moment
    double mean_mm, max_mm;
    scene_entity worst;      // null: no entity in both
    uint32_t shared, single; // entities alive in both, in one
} app_gap;

// Same scene, same order of spawning: an entity has the same handle in both.
app_gap app_gap_measure(const scene *a, const scene *b);

#endif
