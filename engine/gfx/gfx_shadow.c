// Shadow maps. Every light that casts shadows gets views: a sun one a cascade, a spot one, a point
// light six. Each view is a layer of one depth array, drawn again only when its matrix or a caster
// changed.
#include "gfx/gfx_device_internal.h"
#include "gfx/gfx_terrain.h"

#include "core/hash.h"

#include <string.h>

// Texels round the picture of a cube face that neighbours cover too, so that filters find them.
enum { FACE_BORDER = 4 };
// Metres towards a sun within which casters keep their depth (for soft shadows).
static const float FAR_CASTERS = 200.0f;

// ---- views ----

static gfx_shadow_view *add_view(gfx_shadows *s) { return &s->view[s->count++]; }

// Clip space to map coordinates; depth is in 0..1 already.
static void set_matrix(gfx_shadow_view *v) {
    static const core_mat4 half = {
        {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 1.0f, 0, 0.5f, 0.5f, 0, 1.0f}};
    core_mat4 m = core_mat4_mul(&half, &v->view.view_projection);
    memcpy(v->block.matrix, m.m, sizeof v->block.matrix);
}

static void add_perspective(gfx_shadows *s, core_vec3 eye, core_vec3 along, core_vec3 up,
                            float tangent, float near_plane, float source) {
    gfx_shadow_view *v = add_view(s);
    gfx_camera_view(&v->view, eye, core_v3_add(eye, along), up);
    v->view.projection = core_mat4_perspective(2.0f * core_atan2f(tangent, 1.0f), 1.0f, near_plane);
    gfx_view_finish(&v->view);
    set_matrix(v);
    const float texel[4] = {2.0f * tangent / (float)s->size, 0.0f, (float)s->size, source};
    const float depth[4] = {near_plane, 1.0f, 0.0f, (float)(s->count - 1)};
    memcpy(v->block.texel, texel, sizeof texel);
    memcpy(v->block.depth, depth, sizeof depth);
}

static core_vec3 any_up(core_vec3 direction) {
    return core_absf(direction.y) > 0.99f ? core_v3(0.0f, 0.0f, 1.0f) : core_v3(0.0f, 1.0f, 0.0f);
}

static void add_spot(gfx_shadows *s, const gfx_lights *l, uint32_t i) {
    core_vec3 eye = {l->px[i], l->py[i], l->pz[i]}, along = {l->dx[i], l->dy[i], l->dz[i]};
    float tangent = core_tanf(l->outer[i]) * (1.0f + 2.0f * FACE_BORDER / (float)s->size);
    add_perspective(s, eye, along, any_up(along), tangent, 0.01f * l->radius[i], l->source[i]);
}

static void add_point(gfx_shadows *s, const gfx_lights *l, uint32_t i) {
    core_vec3 eye = {l->px[i], l->py[i], l->pz[i]};
    float tangent = 1.0f + 2.0f * FACE_BORDER / (float)s->size;
    for (int face = 0; face < 6; ++face) {
        float d[3] = {0};
        d[face / 2] = face & 1 ? -1.0f : 1.0f;
        core_vec3 along = {d[0], d[1], d[2]};
        add_perspective(s, eye, along, any_up(along), tangent, 0.005f * l->radius[i], l->source[i]);
    }
}

// ---- cascades ----

typedef struct interval {
    float lo, hi;
} interval;

// Extent of all casters along a direction.
static interval extent(const gfx_instances *s, core_vec3 along) {
    interval e = {1e30f, -1e30f};
    for (uint32_t i = 0; i < core_columns_count(&s->set); ++i) {
        float at = s->cx[i] * along.x + s->cy[i] * along.y + s->cz[i] * along.z;
        if (!(core_absf(at) + s->cr[i] < 1e30f)) {
            continue; // a transform that is no number hides no other shadow
        }
        e.lo = CORE_MIN(e.lo, at - s->cr[i]);
        e.hi = CORE_MAX(e.hi, at + s->cr[i]);
    }
    return e;
}

// Sphere round the part of the view between two depths: its centre lies on the axis where both
// corners are equally far, or at the far end for wide views. It does not change as the camera
// turns.
static void view_sphere(const gfx_view *v, float from, float to, core_vec3 *center, float *radius) {
    float t2 = v->tan_x * v->tan_x + v->tan_y * v->tan_y;
    float at =
        v->orthographic ? 0.5f * (from + to) : CORE_MIN(0.5f * (from + to) * (1.0f + t2), to);
    float corner2 = v->orthographic ? t2 : t2 * to * to;
    *radius = core_sqrtf(corner2 + (to - at) * (to - at));
    const float *m = v->view.m;
    core_vec3 ahead = {-m[2], -m[6], -m[10]};
    *center = core_v3_mad(v->position, ahead, at);
}

// Steps of whole texels, so that edges do not crawl as the camera moves.
static float snap(float x, float step) { return (float)core_floor((double)(x / step)) * step; }

static void add_cascade(gfx_shadows *s, core_vec3 along, interval casters, core_vec3 center,
                        float radius, float end, float source) {
    gfx_shadow_view *v = add_view(s);
    core_vec3 right = core_v3_normalize(core_v3_cross(any_up(along), along), core_v3(1, 0, 0));
    core_vec3 up = core_v3_cross(along, right);
    // The radius in steps, too: rounding of the camera must not change the scale.
    radius = (snap(radius, radius / 64.0f) + radius / 64.0f) * (1.0f + 4.0f / (float)s->size);
    float texel = 2.0f * radius / (float)s->size;
    float x = snap(core_v3_dot(center, right), texel), y = snap(core_v3_dot(center, up), texel);
    // From the first caster to the last receiver, but not so far that depth loses its digits: what
    // lies before is clamped to the near end and casts its shadow all the same.
    float middle = core_v3_dot(center, along), first = middle - radius - FAR_CASTERS;
    float last = middle + radius;
    float from = CORE_MAX(casters.lo, first) - 1.0f, to = CORE_MIN(casters.hi, last) + 1.0f;
    float range = CORE_MAX(to - from, 1.0f);
    core_vec3 eye = core_v3_add(core_v3_add(core_v3_scale(right, x), core_v3_scale(up, y)),
                                core_v3_scale(along, from));
    gfx_camera_view(&v->view, eye, core_v3_add(eye, along), up);
    v->view.orthographic = true;
    v->view.projection = core_mat4_ortho(-radius, radius, -radius, radius, 0.0f, range);
    gfx_view_finish(&v->view);
    const float anywhere[4] = {0.0f, 0.0f, 0.0f, 1.0f}; // casters before the near end stay
    memcpy(v->view.plane[4], anywhere, sizeof anywhere);
    set_matrix(v);
    const float texels[4] = {texel, 0.0f, (float)s->size, source};
    const float depth[4] = {range, 0.0f, end, (float)(s->count - 1)};
    memcpy(v->block.texel, texels, sizeof texels);
    memcpy(v->block.depth, depth, sizeof depth);
}

// Ends of the cascades: half way between equal and growing by a constant factor (Zhang et al.,
// "Parallel-split shadow maps for large-scale virtual environments", 2006).
static void add_sun(gfx_shadows *s, const gfx_world *world, const gfx_view *view, core_vec3 along,
                    float source) {
    float far = CORE_MIN(world->settings.shadow_distance, view->virtual_far),
          from = view->near_plane;
    float base = CORE_MAX(view->near_plane, 1.0f);
    int n = (int)(world->settings.cascades + 0.5f);
    interval casters = extent(&world->instances, along);
    gfx_terrains_extent(world, along, &casters.lo, &casters.hi);
    for (int k = 1; k <= n; ++k) {
        float t = (float)k / (float)n;
        float grown = base * core_powf(far / base, t), equal = base + (far - base) * t;
        float to = 0.5f * (grown + equal), radius;
        core_vec3 center;
        view_sphere(view, from, to, &center, &radius);
        add_cascade(s, along, casters, center, radius, to, source);
        from = to;
    }
}

// ---- plan ----

static void reserve_layers(gfx_shadows *s, uint32_t size, uint32_t layers) {
    if (size == s->size && layers <= s->layers) {
        return;
    }
    glDeleteTextures(1, &s->texture);
    glDeleteFramebuffers(1, &s->target);
    s->size = size;
    s->layers = layers;
    memset(s->drawn, 0, sizeof s->drawn);
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &s->texture);
    glTextureStorage3D(s->texture, 1, GL_DEPTH_COMPONENT32F, (GLsizei)size, (GLsizei)size,
                       (GLsizei)layers);
    glCreateFramebuffers(1, &s->target);
    if (!s->sampler) {
        const float infinity[4] = {0.0f, 0.0f, 0.0f, 0.0f}; // beyond a map all is lit
        glCreateSamplers(1, &s->sampler);
        glSamplerParameteri(s->sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glSamplerParameteri(s->sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glSamplerParameteri(s->sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
        glSamplerParameteri(s->sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
        glSamplerParameterfv(s->sampler, GL_TEXTURE_BORDER_COLOR, infinity);
    }
}

static uint32_t views_of(const gfx_world *world, uint32_t type) {
    uint32_t cascades = (uint32_t)(world->settings.cascades + 0.5f);
    return type == GFX_DIRECTIONAL ? cascades : type == GFX_SPOT ? 1 : 6;
}

// Lights for which no views are left cast no shadow.
static uint32_t assign_views(const gfx_world *world, uint16_t *first) {
    const gfx_lights *l = &world->lights;
    uint32_t count = 0;
    for (uint32_t i = 0; i < core_columns_count(&l->set); ++i) {
        uint32_t views = views_of(world, l->type[i]);
        bool fits = l->shadows[i] && count + views <= GFX_SHADOW_VIEWS;
        first[i] = fits ? (uint16_t)(count + 1) : 0;
        count += fits ? views : 0;
    }
    return count;
}

void gfx_shadows_plan(gfx_device *d, const gfx_world *world, const gfx_view *view) {
    gfx_shadows *s = &d->shadows;
    const gfx_lights *l = &world->lights;
    uint32_t lights = core_columns_count(&l->set);
    s->first.count = 0;
    s->count = 0;
    uint16_t *first = gfx_grow(&s->first, sizeof *first, lights + 1);
    memset(first, 0, (lights + 1) * sizeof *first);
    for (uint32_t type = 0; type < 3; ++type) {
        s->views_of_type[type] = views_of(world, type);
    }
    bool sun = gfx_world_has_default_sun(world);
    if (!world->settings.shadows) {
        return;
    }
    uint32_t count = sun ? views_of(world, GFX_DIRECTIONAL) : assign_views(world, first);
    if (count == 0) {
        return;
    }
    reserve_layers(s, (uint32_t)world->settings.shadow_size, count);
    if (sun) {
        const float *to = gfx_default_sun.position;
        add_sun(s, world, view, core_v3(-to[0], -to[1], -to[2]), 0.02f);
        first[0] = 1;
    }
    for (uint32_t i = 0; i < lights; ++i) {
        if (first[i] && l->type[i] == GFX_DIRECTIONAL) {
            add_sun(s, world, view, core_v3(l->dx[i], l->dy[i], l->dz[i]), l->source[i]);
        } else if (first[i]) {
            (l->type[i] == GFX_SPOT ? add_spot : add_point)(s, l, i);
        }
    }
    for (uint32_t i = 0; i < s->count; ++i) {
        gfx_shadow_view *v = &s->view[i];
        uint64_t casters = core_hash_mix(world->id, world->instance_version + world->mesh_version);
        casters = core_hash_mix(casters, d->levels_hash);
        v->key = core_hash(&v->view.view_projection, sizeof v->view.view_projection, casters) | 1;
        v->current = s->drawn[i] == v->key;
        if (!v->current) {
            gfx_draws_add_view(d, world, &v->view, &v->list);
            gfx_terrains_add_view(d, world, &v->view, &v->terrain);
        }
    }
}

float gfx_shadow_code(const gfx_device *d, uint32_t row, uint32_t type) {
    uint32_t first = ((const uint16_t *)d->shadows.first.data)[row];
    return first ? (float)(first + d->shadows.views_of_type[type] * GFX_SHADOW_COUNT_UNIT) : 0.0f;
}

static bool draw_layer(gfx_device *d, gfx_world *world, uint32_t i, size_t stride) {
    gfx_shadows *s = &d->shadows;
    const float clear = 0.0f;
    glNamedFramebufferTextureLayer(s->target, GL_DEPTH_ATTACHMENT, s->texture, 0, (GLint)i);
    glClearNamedFramebufferfv(s->target, GL_DEPTH, 0, &clear);
    glBindBufferRange(GL_UNIFORM_BUFFER, GFX_UBO_VIEW, s->views.name,
                      (GLintptr)(s->views.segment * d->frame + i * stride),
                      sizeof(struct gfx_view_block));
    s->drawn[i] = s->view[i].key;
    d->passes++;
    const uint32_t features = GFX_FEATURE_DEPTH_ONLY;
    return gfx_terrains_submit(d, world, &s->view[i].terrain, "depth.frag", features) &&
           gfx_draws_submit(d, world, &s->view[i].list, "depth.frag", features);
}

bool gfx_shadows_draw(gfx_device *d, gfx_world *world) {
    gfx_shadows *s = &d->shadows;
    if (s->count == 0) {
        return true;
    }
    const size_t stride = (sizeof(struct gfx_view_block) + 255) / 256 * 256;
    struct gfx_shadow_block *block =
        gfx_stream_begin(&s->block, s->count * sizeof *block, d->frame);
    uint8_t *views = gfx_stream_begin(&s->views, s->count * stride, d->frame);
    for (uint32_t i = 0; i < s->count; ++i) {
        block[i] = s->view[i].block;
        memcpy(((struct gfx_view_block *)(void *)(views + i * stride))->view_proj,
               s->view[i].view.view_projection.m, sizeof(core_mat4));
    }
    glBindFramebuffer(GL_FRAMEBUFFER, s->target);
    glViewport(0, 0, (GLsizei)s->size, (GLsizei)s->size);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_CLAMP);
    bool ok = true;
    for (uint32_t i = 0; i < s->count && ok; ++i) {
        ok = s->view[i].current || draw_layer(d, world, i, stride);
    }
    glDisable(GL_DEPTH_CLAMP);
    gfx_stream_bind(&s->block, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_SHADOWS, s->count * sizeof *block,
                    d->frame);
    glBindTextureUnit(GFX_TEX_SHADOW, s->texture);
    glBindSampler(GFX_TEX_SHADOW, s->sampler);
    return ok;
}

void gfx_shadows_release(gfx_shadows *s) {
    glDeleteTextures(1, &s->texture);
    glDeleteFramebuffers(1, &s->target);
    glDeleteSamplers(1, &s->sampler);
    gfx_growing_release(&s->first);
    gfx_stream_release(&s->block);
    gfx_stream_release(&s->views);
}
