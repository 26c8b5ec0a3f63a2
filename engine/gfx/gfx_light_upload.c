// Lights of a frame: the light block, and the lists of the cluster grid.
#include "gfx/gfx_device_internal.h"

#include <string.h>

// From this many point and spot lights on, `auto` draws clustered: where the frames of the lab's
// gfx_auto cross.
enum { AUTO_CLUSTERED = 2 };

static void write_light(const gfx_device *d, const gfx_lights *l, uint32_t i,
                        struct gfx_light_block *out) {
    float r2 = CORE_CLAMP(l->radius[i] * l->radius[i], 1e-37f, 1e37f); // so is its inverse
    // The cone falls from 1 at cos(inner) to 0 at cos(outer); others have none.
    float scale = 0.0f, offset = 1.0f;
    if (l->type[i] == GFX_SPOT) {
        float outer = core_cosf(l->outer[i]), inner = core_cosf(l->inner[i]);
        scale = 1.0f / CORE_MAX(inner - outer, 1e-4f);
        offset = -outer * scale;
    }
    *out = (struct gfx_light_block){
        .position = {l->px[i], l->py[i], l->pz[i], 1.0f / r2},
        .color = {l->r[i] * l->intensity[i], l->g[i] * l->intensity[i], l->b[i] * l->intensity[i],
                  gfx_shadow_code(d, i, l->type[i])},
        .cone = {-l->dx[i] * scale, -l->dy[i] * scale, -l->dz[i] * scale, offset},
    };
    if (l->type[i] == GFX_DIRECTIONAL) {
        const gfx_glsl_vec4 towards = {-l->dx[i], -l->dy[i], -l->dz[i], 0.0f};
        memcpy(out->position, towards, sizeof towards);
    }
}

const struct gfx_light_block gfx_default_sun = {
    .position = {0.4082f, 0.8165f, 0.4082f, 0.0f},
    .color = {3.0f, 2.9f, 2.7f, 0.0f},
    .cone = {0.0f, 0.0f, 0.0f, 1.0f},
};

// Directional lights first, then the others, each in the order of their rows.
static void write_lights(gfx_device *d, const gfx_world *world, gfx_light_upload *out) {
    const gfx_lights *l = &world->lights;
    uint32_t n = core_columns_count(&l->set), at = 0;
    struct gfx_light_block *block =
        gfx_stream_begin(&d->light_block, (n + 1) * sizeof *block, d->frame);
    if (gfx_world_has_default_sun(world)) {
        block[at] = gfx_default_sun;
        block[at++].color[3] = gfx_shadow_code(d, 0, GFX_DIRECTIONAL);
    }
    for (uint32_t i = 0; i < n; ++i) {
        if (l->type[i] == GFX_DIRECTIONAL) {
            write_light(d, l, i, &block[at++]);
        }
    }
    out->directional = at;
    for (uint32_t i = 0; i < n; ++i) {
        if (l->type[i] != GFX_DIRECTIONAL) {
            write_light(d, l, i, &block[at++]);
        }
    }
    out->local = at - out->directional;
    gfx_stream_bind(&d->light_block, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_LIGHTS, at * sizeof *block,
                    d->frame);
    gfx_stream_bind_texels(&d->light_block, GFX_TEX_LIGHTS, GL_RGBA32F, at * sizeof *block,
                           d->frame);
}

// Sphere round what a light reaches: its own, or for a spot the one round its spherical sector,
// through apex and rim for narrow cones, on the rim's plane for wide ones.
static core_vec3 light_sphere(const gfx_lights *l, uint32_t i, float *radius) {
    core_vec3 p = {l->px[i], l->py[i], l->pz[i]};
    *radius = l->radius[i];
    if (l->type[i] != GFX_SPOT) {
        return p;
    }
    float cosine = core_cosf(l->outer[i]), along = *radius * cosine;
    if (cosine > 0.70710678f) {
        along = *radius / (2.0f * cosine);
        *radius = along;
    } else {
        *radius *= core_sinf(l->outer[i]);
    }
    return core_v3_mad(p, core_v3(l->dx[i], l->dy[i], l->dz[i]), along);
}

// The rim is widened by the rounding of the shader's cosine, and the apex drawn back by that of
// positions and of the test.
static gfx_cluster_cone light_cone(const gfx_lights *l, uint32_t i, const gfx_view *view,
                                   float slack) {
    const float *m = view->view.m;
    float cosine = core_cosf(l->outer[i]) - 1e-6f;
    if (l->type[i] != GFX_SPOT || cosine <= 0.0f) {
        return (gfx_cluster_cone){0};
    }
    float sine = core_sqrtf(1.0f - cosine * cosine), back = slack / sine;
    float x = l->px[i] - back * l->dx[i], y = l->py[i] - back * l->dy[i],
          z = l->pz[i] - back * l->dz[i];
    return (gfx_cluster_cone){
        .apex = {m[0] * x + m[4] * y + m[8] * z + m[12], m[1] * x + m[5] * y + m[9] * z + m[13],
                 -(m[2] * x + m[6] * y + m[10] * z + m[14])},
        .axis = {m[0] * l->dx[i] + m[4] * l->dy[i] + m[8] * l->dz[i],
                 m[1] * l->dx[i] + m[5] * l->dy[i] + m[9] * l->dz[i],
                 -(m[2] * l->dx[i] + m[6] * l->dy[i] + m[10] * l->dz[i])},
        .sine = sine,
        .range = l->radius[i] + back + slack,
        .cosine = cosine,
    };
}

void gfx_cluster_lights_fill(gfx_cluster_lights *out, const gfx_lights *l, const gfx_view *view) {
    const float *m = view->view.m;
    uint32_t n = core_columns_count(&l->set), at = 0;
    core_vec3 eye = view->position;
    float far_from_zero = core_absf(eye.x) + core_absf(eye.y) + core_absf(eye.z);
    gfx_cluster_lights_reserve(out, n);
    for (uint32_t i = 0; i < n; ++i) {
        if (l->type[i] == GFX_DIRECTIONAL) {
            continue;
        }
        float r;
        core_vec3 p = light_sphere(l, i, &r);
        float x = m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12];
        float y = m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13];
        float depth = -(m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]);
        // The shader works with positions rounded in world space, this with view space.
        float rounding = core_absf(x) + core_absf(y) + core_absf(depth) + far_from_zero;
        out->x[at] = x, out->y[at] = y, out->depth[at] = depth;
        out->radius[at] = r * 1.00001f + rounding * 2e-6f;
        out->cone[at] =
            light_cone(l, i, view, r * 1e-5f + (rounding + r + view->virtual_far) * 4e-6f);
        out->spots += out->cone[at++].cosine > 0.0f;
    }
    out->count = at;
}

static void upload_lists(gfx_device *d, const gfx_clusters *c, uint32_t cells) {
    size_t offsets = (cells + 1) * sizeof *c->offset, lists = c->total * sizeof *c->light;
    memcpy(gfx_stream_begin(&d->cluster_offsets, offsets, d->frame), c->offset, offsets);
    void *list = gfx_stream_begin(&d->cluster_lists, lists, d->frame);
    if (lists) {
        memcpy(list, c->light, lists);
    }
    gfx_stream_bind(&d->cluster_offsets, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_CLUSTER_OFFSETS,
                    offsets, d->frame);
    gfx_stream_bind(&d->cluster_lists, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_CLUSTER_LIGHTS, lists,
                    d->frame);
}

bool gfx_lights_upload(gfx_device *d, gfx_world *world, const gfx_view *view,
                       gfx_light_upload *out) {
    const gfx_settings *s = &world->settings;
    *out = (gfx_light_upload){0};
    write_lights(d, world, out);
    out->clustered = s->render == GFX_RENDER_CLUSTERED ||
                     (s->render == GFX_RENDER_AUTO && out->local >= AUTO_CLUSTERED);
    if (!out->clustered) {
        return true;
    }
    gfx_cluster_grid_make(&out->grid, s->grid, s->linear_slices, s->first_slice, view->orthographic,
                          view->tan_x, view->tan_y, view->near_plane, view->virtual_far);
    gfx_cluster_lights_fill(&d->cluster_lights, &world->lights, view);
    uint32_t cells = gfx_cluster_cells(&out->grid);
    world->stats.clusters = cells;
    if (s->assign == GFX_CLUSTER_GPU) {
        return gfx_clusters_assign_gpu(d, &out->grid, &d->cluster_lights, &world->stats.light_refs);
    }
    gfx_clusters_assign(&d->clusters, &out->grid, &d->cluster_lights, (gfx_cluster_method)s->assign,
                        world->jobs);
    if (s->cell_cap > 0.0f) {
        world->stats.capped =
            gfx_clusters_cap(&d->clusters, cells, (uint32_t)s->cell_cap, GFX_CLUSTER_ALL);
    }
    world->stats.light_refs = d->clusters.total;
    upload_lists(d, &d->clusters, cells);
    return true;
}
