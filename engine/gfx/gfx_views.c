// Targets of a world's further views.
#include "gfx/gfx_device_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void path_of(const gfx_viewport_store *s, char out[CORE_NAME_MAX]) {
    snprintf(out, CORE_NAME_MAX, "target:%s", s->target);
}

// Pixels of a rectangle: its edges are rounded, so that neighbours neither overlap nor leave a gap.
static void pixels_of(const gfx_device *d, const gfx_viewport_store *s, int out[4]) {
    float w = (float)d->targets.width, h = (float)d->targets.height;
    out[0] = (int)lrintf(s->rect[0] * w);
    out[1] = (int)lrintf(s->rect[1] * h);
    out[2] = CORE_MAX((int)lrintf((s->rect[0] + s->rect[2]) * w) - out[0], 1);
    out[3] = CORE_MAX((int)lrintf((s->rect[1] + s->rect[3]) * h) - out[1], 1);
}

static void drop_stale(gfx_device *d, const gfx_world *world) {
    gfx_extra_view *v = d->extra.data;
    for (size_t i = 0; i < d->extra.count; ++i) {
        if (!core_handle_is_null(v[i].viewport) &&
            (v[i].world != world->id || !gfx_viewport_alive(world, v[i].viewport))) {
            if (v[i].path[0]) {
                gfx_texture_enter(d, v[i].path, true, 0, 0, 0);
                gfx_texture_enter(d, v[i].path, false, 0, 0, 0);
            }
            gfx_targets_release(&v[i].targets);
            v[i] = (gfx_extra_view){0};
        }
    }
}

static gfx_extra_view *find(gfx_device *d, gfx_viewport viewport) {
    gfx_extra_view *v = d->extra.data;
    for (size_t i = 0; i < d->extra.count; ++i) {
        if (core_handle_equal(v[i].viewport, viewport)) {
            return &v[i];
        }
    }
    return NULL;
}

static bool fit(gfx_device *d, const gfx_world *world, uint32_t row) {
    const gfx_viewport_store *s = &world->viewports.store[row];
    gfx_viewport viewport = core_columns_handle(&world->viewports.set, row);
    gfx_extra_view *v = find(d, viewport);
    if (!v) {
        v = find(d, CORE_NULL_HANDLE);
        v = v ? v : gfx_grow(&d->extra, sizeof *v, 1);
        *v = (gfx_extra_view){.viewport = viewport, .world = world->id};
    }
    int at[4];
    pixels_of(d, s, at);
    uint32_t w = s->target[0] ? s->width : (uint32_t)at[2];
    uint32_t h = s->target[0] ? s->height : (uint32_t)at[3];
    if (v->targets.width == w && v->targets.height == h && v->targets.picture.name) {
        return true;
    }
    if (!gfx_targets_resize(d, &v->targets, w, h)) {
        return false;
    }
    if (s->target[0]) {
        gfx_targets_add_image(&v->targets);
        path_of(s, v->path);
        gfx_texture_enter(d, v->path, true, v->targets.light, w, h);
        gfx_texture_enter(d, v->path, false, v->targets.image.texture, w, h);
    }
    return true;
}

bool gfx_views_fit(gfx_device *d, const gfx_world *world) {
    uint32_t count = world->viewports_made ? core_columns_count(&world->viewports.set) : 0;
    bool ok = true;
    drop_stale(d, world);
    for (uint32_t row = 0; row < count && ok; ++row) {
        ok = fit(d, world, row);
    }
    return ok;
}

gfx_targets *gfx_views_targets(gfx_device *d, const gfx_world *world, uint32_t row) {
    return &find(d, core_columns_handle(&world->viewports.set, row))->targets;
}

void gfx_views_place(gfx_device *d, const gfx_world *world, uint32_t row) {
    const gfx_targets *t = gfx_views_targets(d, world, row);
    int at[4], w = (int)t->width, h = (int)t->height;
    if (t->image.name) { // files have their top row first
        glBlitNamedFramebuffer(t->picture.name, t->image.name, 0, 0, w, h, 0, h, w, 0,
                               GL_COLOR_BUFFER_BIT, GL_NEAREST);
        return;
    }
    pixels_of(d, &world->viewports.store[row], at);
    int low = (int)d->targets.height - at[1] - at[3]; // GL counts from below
    glBlitNamedFramebuffer(t->picture.name, d->targets.picture.name, 0, 0, w, h, at[0], low,
                           at[0] + w, low + h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void gfx_views_release(gfx_device *d) {
    gfx_extra_view *v = d->extra.data;
    for (size_t i = 0; i < d->extra.count; ++i) {
        gfx_targets_release(&v[i].targets);
    }
    gfx_growing_release(&d->extra);
}
