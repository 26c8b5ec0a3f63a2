// Several views of a world: parts of the picture, and textures that materials show.
#include "gfx/gfx_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_VIEWPORTS = 64, MAX_SIDE = 16384 };

CORE_COLUMNS_DEFINE(gfx_viewports, GFX_VIEWPORT_COLUMNS)

gfx_viewport_desc gfx_viewport_desc_default(void) {
    return (gfx_viewport_desc){
        .camera = {.rotation = core_quat_identity()}, .rect = {0, 0, 1, 1}, .cookie = GFX_COOKIE};
}

static bool check(const gfx_viewport_desc *desc) {
    const float *r = desc->rect;
    if (desc->target) {
        size_t length = strlen(desc->target);
        return (length > 0 && length < sizeof((gfx_viewport_store *)0)->target &&
                desc->width >= 1 && desc->height >= 1 && desc->width <= MAX_SIDE &&
                desc->height <= MAX_SIDE) ||
               core_fail("gfx_viewport_create: the target \"%.64s\" of %ux%u pixels, expected a "
                         "name of 1..63 bytes and a size of 1..%d each",
                         desc->target, desc->width, desc->height, MAX_SIDE);
    }
    bool inside = r[0] >= 0.0f && r[1] >= 0.0f && r[2] > 0.0f && r[3] > 0.0f &&
                  r[0] + r[2] <= 1.0001f && r[1] + r[3] <= 1.0001f;
    return inside || core_fail("gfx_viewport_create: the rectangle %g, %g, %g, %g, expected x, y, "
                               "width, height as shares of the picture within 0..1",
                               (double)r[0], (double)r[1], (double)r[2], (double)r[3]);
}

static bool taken(const gfx_world *world, const char *target) {
    for (uint32_t i = 0; i < core_columns_count(&world->viewports.set); ++i) {
        if (strcmp(world->viewports.store[i].target, target) == 0) {
            return true;
        }
    }
    return false;
}

gfx_viewport gfx_viewport_create(gfx_world *world, const gfx_viewport_desc *desc) {
    if (!desc || desc->cookie != GFX_COOKIE) {
        core_fail("gfx_viewport_create: start from gfx_viewport_desc_default()");
        return CORE_NULL_HANDLE;
    }
    if (!check(desc)) {
        return CORE_NULL_HANDLE;
    }
    if (desc->target && taken(world, desc->target)) {
        core_fail("gfx_viewport_create: another view draws to the target \"%s\" already",
                  desc->target);
        return CORE_NULL_HANDLE;
    }
    if (!world->viewports_made) {
        world->viewports_made =
            gfx_viewports_init(&world->viewports, "gfx.viewports", MAX_VIEWPORTS);
    }
    gfx_viewport viewport = core_columns_add(&world->viewports.set);
    uint32_t i = core_columns_row(&world->viewports.set, viewport);
    if (i != CORE_NO_ROW) {
        gfx_viewport_store *s = &world->viewports.store[i];
        *s = (gfx_viewport_store){
            .camera = desc->camera, .width = desc->width, .height = desc->height};
        memcpy(s->rect, desc->rect, sizeof s->rect);
        if (desc->target) {
            memcpy(s->target, desc->target, strlen(desc->target) + 1);
        }
    }
    return viewport;
}

bool gfx_viewport_destroy(gfx_world *world, gfx_viewport viewport) {
    return (world->viewports_made &&
            core_columns_remove(&world->viewports.set, viewport, NULL, NULL)) ||
           core_fail("gfx_viewport_destroy: the handle is stale or null");
}

static gfx_viewport_store *store_of(const gfx_world *world, gfx_viewport viewport) {
    uint32_t i =
        world->viewports_made ? core_columns_row(&world->viewports.set, viewport) : CORE_NO_ROW;
    return i == CORE_NO_ROW ? NULL : &world->viewports.store[i];
}

bool gfx_viewport_alive(const gfx_world *world, gfx_viewport viewport) {
    return store_of(world, viewport) != NULL;
}

bool gfx_viewport_set_camera(gfx_world *world, gfx_viewport viewport, const gfx_camera *camera) {
    gfx_viewport_store *s = store_of(world, viewport);
    if (!s) {
        return core_fail("gfx_viewport_set_camera: the handle is stale or null");
    }
    s->camera = *camera;
    return true;
}

bool gfx_viewport_camera(const gfx_world *world, gfx_viewport viewport, gfx_camera *out) {
    const gfx_viewport_store *s = store_of(world, viewport);
    if (!s) {
        return core_fail("gfx_viewport_camera: the handle is stale or null");
    }
    *out = s->camera;
    return true;
}
