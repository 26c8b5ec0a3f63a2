// Settings by name, and names in error messages.
#include "gfx/gfx_internal.h"

#include "core/nearest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gfx_settings_default(gfx_settings *s) {
    *s = (gfx_settings){
        .grid = {16, 9, 24},
        .first_slice = 5.0f,
        .assign = 2, // simd
        .exposure = 1.0f,
        .instancing = 1,
        .culling = 1,
        .prepass = 1,
        .levels = 1,
        .shadows = GFX_SHADOWS_PCF,
        .shadow_size = 1024.0f,
        .shadow_distance = 80.0f,
        .cascades = 3.0f,
        .terrain_error = 1.0f,
        .upload_budget = 4.0f,
        .shadow_taps = 32.0f,
        .ibl_samples = 128.0f,
        .ao_radius = 0.5f,
        .ao_slices = 2.0f,
        .ao_steps = 4.0f,
        .bloom_levels = 6.0f,
        .bloom_spread = 0.7f,
        .key = 0.18f,
        .adapt = 1.0f,
        .contrast = 1.0f,
        .saturation = 1.0f,
        .gain = {1.0f, 1.0f, 1.0f},
        .fog_color = {0.5f, 0.55f, 0.6f},
    };
}

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
    char list[1024] = "";
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

// One number for all channels, or three.
static bool set_color(const char *setting, const char *value, float least, float most,
                      float out[3]) {
    float c[3];
    char rest;
    int n = sscanf(value, "%f,%f,%f%c", &c[0], &c[1], &c[2], &rest);
    if (n == 1 && !strchr(value, ',')) {
        return set_number(setting, value, least, most, &c[0]) &&
               (out[0] = out[1] = out[2] = c[0], true);
    }
    bool ok = n == 3;
    for (int i = 0; i < 3 && ok; ++i) {
        ok = c[i] >= least && c[i] <= most;
    }
    if (!ok) {
        return core_fail("gfx.%s: \"%s\", expected a number in %g..%g or three as R,G,B", setting,
                         value, (double)least, (double)most);
    }
    memcpy(out, c, sizeof c);
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

// Every setting: a choice of names (an int in gfx_settings), a number in a range (a float) or three
// (a colour). The grid, whose value has a form of its own, is apart.
typedef struct setting {
    const char *name;
    size_t offset;
    const char *choice[7]; // empty: a number
    float least, most;
    bool color;
} setting;
#define NUMBER(name, least, most)                                                                  \
    { #name, offsetof(gfx_settings, name), {NULL }, least, most, false }
#define COLOR(name, least, most)                                                                   \
    { #name, offsetof(gfx_settings, name), {NULL }, least, most, true }
#define CHOICE(name, member, ...)                                                                  \
    { name, offsetof(gfx_settings, member), {__VA_ARGS__}, 0, 0, false }

static const setting table[] = {
    CHOICE("render", render, "auto", "forward", "clustered", "none"),
    CHOICE("slices", linear_slices, "exponential", "linear"),
    CHOICE("assign", assign, "naive", "per_light", "simd", "gpu"),
    NUMBER(first_slice, 0.0f, 1e6f),
    NUMBER(cell_cap, 0.0f, 65536.0f),
    NUMBER(exposure, 1e-6f, 1e6f),
    CHOICE("tonemap", tonemap, "neutral", "linear"),
    CHOICE("instancing", instancing, "off", "on"),
    CHOICE("shadows", shadows, "off", "pcf", "soft"),
    NUMBER(shadow_size, 16.0f, 8192.0f),
    NUMBER(shadow_distance, 1.0f, 1e6f),
    NUMBER(cascades, 1.0f, 4.0f),
    NUMBER(shadow_taps, 2.0f, 256.0f),
    NUMBER(shadow_bias, -16.0f, 16.0f),
    NUMBER(ibl_samples, 1.0f, 4096.0f),
    CHOICE("debug", debug, "off", "normals", "depth", "lights", "clusters", "overdraw"),
    CHOICE("prepass", prepass, "off", "on"),
    CHOICE("levels", levels, "off", "on"),
    NUMBER(terrain_error, 0.0f, 100.0f),
    CHOICE("culling", culling, "off", "on"),
    CHOICE("msaa", msaa, "off", "2", "4", "8"),
    CHOICE("fxaa", fxaa, "off", "on"),
    NUMBER(ao, 0.0f, 1.0f),
    NUMBER(ao_radius, 0.001f, 1e4f),
    NUMBER(ao_slices, 1.0f, 16.0f),
    NUMBER(ao_steps, 1.0f, 32.0f),
    NUMBER(bloom, 0.0f, 1.0f),
    NUMBER(bloom_threshold, 0.0f, 1e6f),
    NUMBER(bloom_levels, 1.0f, 8.0f),
    NUMBER(bloom_spread, 0.0f, 1.0f),
    CHOICE("auto_exposure", auto_exposure, "off", "on"),
    NUMBER(key, 1e-4f, 1e4f),
    NUMBER(adapt, 1e-3f, 1.0f),
    NUMBER(contrast, 0.0f, 4.0f),
    NUMBER(saturation, 0.0f, 4.0f),
    COLOR(lift, -1.0f, 1.0f),
    COLOR(gain, 0.0f, 16.0f),
    NUMBER(upload_budget, 0.01f, 1024.0f),
    NUMBER(fog, 0.0f, 1e3f),
    NUMBER(fog_falloff, 0.0f, 1e3f),
    NUMBER(fog_base, -1e6f, 1e6f),
    COLOR(fog_color, 0.0f, 1e6f),
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
    if (choices) {
        return set_choice(name, value, s->choice, choices, field);
    }
    return s->color ? set_color(name, value, s->least, s->most, field)
                    : set_number(name, value, s->least, s->most, field);
}

uint32_t gfx_world_setting_count(void) { return CORE_COUNT_OF(table); }

const char *gfx_world_setting(const gfx_world *world, uint32_t i, char *value, size_t size) {
    const setting *s = &table[i];
    const void *field = (const char *)&world->settings + s->offset;
    if (s->choice[0]) {
        snprintf(value, size, "%s", s->choice[*(const int *)field]);
    } else {
        const float *x = field;
        if (s->color) {
            snprintf(value, size, "%g,%g,%g", (double)x[0], (double)x[1], (double)x[2]);
        } else {
            snprintf(value, size, "%g", (double)x[0]);
        }
    }
    return s->name;
}

void gfx_world_nudge(gfx_world *world, uint32_t i, int direction) {
    const setting *s = &table[i];
    void *field = (char *)&world->settings + s->offset;
    int choices = 0;
    while (choices < (int)CORE_COUNT_OF(s->choice) && s->choice[choices]) {
        choices++;
    }
    if (choices) {
        int *choice = field;
        *choice = (*choice + (direction > 0 ? 1 : choices - 1)) % choices;
        return;
    }
    float *x = field;
    for (int k = 0; k < (s->color ? 3 : 1); ++k) {
        float least_step = 0.01f; // below it a factor gets nowhere
        float wide = x[k] < 0.0f ? -x[k] : x[k];
        float step = CORE_MAX(0.25f * wide, least_step);
        x[k] = CORE_CLAMP(x[k] + (direction > 0 ? step : -step), s->least, s->most);
    }
}
