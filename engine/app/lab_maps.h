// Stability maps (assets/stability/*.json, made by the lab): where in a plane of two parameters a
// method fails.
#ifndef APP_LAB_MAPS_H
#define APP_LAB_MAPS_H

#include "core/vfs.h"

#define APP_MAP_SAMPLES 4096

typedef struct app_map_sample {
    double x, y;
    char verdict[16]; // "stable", or how it failed
} app_map_sample;

typedef struct app_map {
    double x_lo, x_hi, y_lo, y_hi;
    bool x_log, y_log;
    uint32_t count;
    app_map_sample sample[APP_MAP_SAMPLES];
} app_map;

// The map `name` of one method. NULL + core_fail: no such file or method. Free with core_free.
app_map *app_map_read(core_vfs *vfs, const char *name, const char *method);
// Verdict of the nearest sample; values beyond the map count as its edge.
const char *app_map_at(const app_map *map, double x, double y);
// The stable value of one axis nearest to the present one on the wanted side (`more`: larger), the
// other held; 0: none.
double app_map_mend_y(const app_map *map, double x, double y); // larger y
double app_map_mend_x(const app_map *map, double x, double y); // smaller x

#endif
