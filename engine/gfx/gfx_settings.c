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

bool gfx_world_set(gfx_world *world, const char *name, const char *value) {
    static const char *const settings[] = {"render",   "clusters", "slices",
                                           "exposure", "tonemap",  "instancing"};
    static const char *const modes[] = {"auto", "forward", "clustered", "none"};
    static const char *const slices[] = {"exponential", "linear"};
    static const char *const tonemaps[] = {"neutral", "linear"};
    static const char *const switches[] = {"off", "on"};
    if (!name || !value) {
        return core_fail("gfx_world_set: name and value are needed");
    }
    gfx_settings *s = &world->settings;
    int choice = 0;
    bool ok;
    switch (gfx_find_name(name, settings, (int)CORE_COUNT_OF(settings))) {
    case 0:
        ok = set_choice(name, value, modes, 4, &choice);
        s->render = ok ? (gfx_render_mode)choice : s->render;
        return ok;
    case 1:
        return set_grid(s, value);
    case 2:
        ok = set_choice(name, value, slices, 2, &choice);
        s->linear_slices = ok ? choice == 1 : s->linear_slices;
        return ok;
    case 3:
        return set_number(name, value, 1e-6f, 1e6f, &s->exposure);
    case 4:
        return set_choice(name, value, tonemaps, 2, &s->tonemap);
    case 5:
        ok = set_choice(name, value, switches, 2, &choice);
        s->instancing = ok ? choice == 1 : s->instancing;
        return ok;
    default:
        return gfx_fail_name("setting", name, settings, (int)CORE_COUNT_OF(settings));
    }
}
