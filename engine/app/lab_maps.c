#include "app/lab_maps.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static double number_of(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    return cJSON_IsNumber(item) ? item->valuedouble : 0;
}

static bool read_axis(const cJSON *root, const char *key, double *lo, double *hi, bool *log) {
    const cJSON *axis = cJSON_GetObjectItemCaseSensitive(root, key);
    *lo = number_of(axis, "lo");
    *hi = number_of(axis, "hi");
    *log = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(axis, "log"));
    return *hi > *lo && (!*log || *lo > 0);
}

static bool read_samples(const cJSON *samples, app_map *map) {
    const cJSON *entry;
    cJSON_ArrayForEach(entry, samples) {
        const cJSON *x = cJSON_GetArrayItem(entry, 0), *y = cJSON_GetArrayItem(entry, 1);
        const cJSON *verdict = cJSON_GetArrayItem(entry, 2);
        if (!cJSON_IsNumber(x) || !cJSON_IsNumber(y) || !cJSON_IsString(verdict) ||
            map->count == APP_MAP_SAMPLES) {
            return false;
        }
        app_map_sample *s = &map->sample[map->count++];
        s->x = x->valuedouble;
        s->y = y->valuedouble;
        snprintf(s->verdict, sizeof s->verdict, "%s", verdict->valuestring);
    }
    return map->count != 0;
}

app_map *app_map_read(core_vfs *vfs, const char *name, const char *method) {
    char path[128];
    size_t size;
    snprintf(path, sizeof path, "stability/%s.json", name);
    char *text = core_vfs_read(vfs, path, &size);
    if (!text) {
        return NULL;
    }
    cJSON *root = cJSON_ParseWithLength(text, size);
    const cJSON *methods = cJSON_GetObjectItemCaseSensitive(root, "methods");
    const cJSON *own = cJSON_GetObjectItemCaseSensitive(methods, method);
    app_map *map = core_alloc(sizeof *map);
    bool fine = own && read_axis(root, "x", &map->x_lo, &map->x_hi, &map->x_log) &&
                read_axis(root, "y", &map->y_lo, &map->y_hi, &map->y_log) &&
                read_samples(cJSON_GetObjectItemCaseSensitive(own, "samples"), map);
    if (!fine) {
        core_fail(
            "%s: no stability map of the method '%s' in it; `corsac lab %s`, then `make docs`, "
            "makes it",
            path, method, name);
        core_free(map);
        map = NULL;
    }
    cJSON_Delete(root);
    core_free(text);
    return map;
}

static double place(double value, double lo, double hi, bool log_scale) {
    value = CORE_CLAMP(value, lo, hi);
    return log_scale ? log(value / lo) / log(hi / lo) : (value - lo) / (hi - lo);
}

const char *app_map_at(const app_map *m, double x, double y) {
    double px = place(x, m->x_lo, m->x_hi, m->x_log), py = place(y, m->y_lo, m->y_hi, m->y_log);
    double best = INFINITY;
    const char *verdict = "stable";
    for (uint32_t i = 0; i < m->count; i++) {
        double dx = place(m->sample[i].x, m->x_lo, m->x_hi, m->x_log) - px;
        double dy = place(m->sample[i].y, m->y_lo, m->y_hi, m->y_log) - py;
        if (dx * dx + dy * dy < best) {
            best = dx * dx + dy * dy;
            verdict = m->sample[i].verdict;
        }
    }
    return verdict;
}

double app_map_mend_y(const app_map *m, double x, double y) {
    double best = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        double value = m->sample[i].y;
        if (value > y && (best == 0 || value < best) &&
            strcmp(app_map_at(m, x, value), "stable") == 0) {
            best = value;
        }
    }
    return best;
}

double app_map_mend_x(const app_map *m, double x, double y) {
    double best = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        double value = m->sample[i].x;
        if (value < x && value > best && strcmp(app_map_at(m, value, y), "stable") == 0) {
            best = value;
        }
    }
    return best;
}
