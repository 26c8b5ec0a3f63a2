// Settings by name, and names in error messages.
#include "gfx/gfx_internal.h"

#include "core/nearest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int gfx_find_name(const char *name, const char *const *names, int count) {
    for (int i = 0; name && i < count; ++i) {
        if (strcmp(name, names[i]) == 0) {
            return i;
        }
    }
    return -1;
}

bool gfx_fail_name(const char *what, const char *name, const char *const *names, int count) {
    if (!name) {
        return core_fail("gfx: no %s was named", what);
    }
    const char *nearest = core_nearest(name, names, (size_t)count);
    char list[256] = "";
    for (int i = 0; i < count; ++i) {
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", names[i]);
    }
    return core_fail("gfx: there is no %s \"%s\"%s%s%s; known: %s", what, name,
                     nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                     nearest ? "\"?" : "", list);
}

static bool set_choice(const char *setting, const char *value, const char *const *names, int count,
                       int *out) {
    int i = gfx_find_name(value, names, count);
    if (i < 0) {
        char what[64];
        snprintf(what, sizeof what, "value of gfx.%s", setting);
        return gfx_fail_name(what, value, names, count);
    }
    *out = i;
    return true;
}

static bool set_number(const char *setting, const char *value, float least, float most,
                       float *out) {
    char *end;
    float x = strtof(value, &end);
    if (end == value || *end || !(x >= least && x <= most)) {
        return core_fail("gfx.%s: \"%s\", expected a number in %g..%g", setting, value,
                         (double)least, (double)most);
    }
    *out = x;
    return true;
}

static bool set_grid(gfx_settings *s, const char *value) {
    unsigned x, y, z;
    char rest;
    if (sscanf(value, "%ux%ux%u%c", &x, &y, &z, &rest) != 3 || x < 1 || y < 1 || z < 1 || x > 64 ||
        y > 64 || z > 64) {
        return core_fail("gfx.clusters: \"%s\", expected XxYxZ with each in 1..64, as 16x9x24",
                         value);
    }
    s->grid[0] = x, s->grid[1] = y, s->grid[2] = z;
    return true;
}

// Every setting: a choice of names (an int in gfx_settings) or a number in a range (a float). The
// grid, whose value has a form of its own, is apart.
typedef struct setting {
    const char *name;
    size_t offset;
    const char *choice[7]; // empty: a number
    float least, most;
} setting;

static const setting table[] = {
    {"render", offsetof(gfx_settings, render), {"auto", "forward", "clustered", "none"}, 0, 0},
    {"slices", offsetof(gfx_settings, linear_slices), {"exponential", "linear"}, 0, 0},
    {"assign", offsetof(gfx_settings, assign), {"naive", "per_light", "simd", "gpu"}, 0, 0},
    {"first_slice", offsetof(gfx_settings, first_slice), {NULL}, 0.0f, 1e6f},
    {"cell_cap", offsetof(gfx_settings, cell_cap), {NULL}, 0.0f, 65536.0f},
    {"exposure", offsetof(gfx_settings, exposure), {NULL}, 1e-6f, 1e6f},
    {"tonemap", offsetof(gfx_settings, tonemap), {"neutral", "linear"}, 0, 0},
    {"instancing", offsetof(gfx_settings, instancing), {"off", "on"}, 0, 0},
    {"shadows", offsetof(gfx_settings, shadows), {"off", "pcf", "soft"}, 0, 0},
    {"shadow_size", offsetof(gfx_settings, shadow_size), {NULL}, 16.0f, 8192.0f},
    {"shadow_distance", offsetof(gfx_settings, shadow_distance), {NULL}, 1.0f, 1e6f},
    {"cascades", offsetof(gfx_settings, cascades), {NULL}, 1.0f, 4.0f},
    {"debug",
     offsetof(gfx_settings, debug),
     {"off", "normals", "depth", "lights", "clusters", "overdraw"},
     0,
     0},
    {"prepass", offsetof(gfx_settings, prepass), {"off", "on"}, 0, 0},
    {"levels", offsetof(gfx_settings, levels), {"off", "on"}, 0, 0},
    {"culling", offsetof(gfx_settings, culling), {"off", "on"}, 0, 0},
};

bool gfx_world_set(gfx_world *world, const char *name, const char *value) {
    enum { COUNT = CORE_COUNT_OF(table) };
    const char *names[COUNT + 1] = {[COUNT] = "clusters"};
    for (int i = 0; i < COUNT; ++i) {
        names[i] = table[i].name;
    }
    if (!value) {
        return core_fail("gfx_world_set: a value is needed");
    }
    int found = gfx_find_name(name, names, COUNT + 1);
    if (found < 0) {
        return gfx_fail_name("setting", name, names, COUNT + 1);
    }
    if (found == COUNT) {
        return set_grid(&world->settings, value);
    }
    const setting *s = &table[found];
    void *field = (char *)&world->settings + s->offset;
    int choices = 0;
    while (s->choice[choices]) {
        choices++;
    }
    return choices ? set_choice(name, value, s->choice, choices, field)
                   : set_number(name, value, s->least, s->most, field);
}
