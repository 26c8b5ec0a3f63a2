// Cameras: matrices, frustum planes, and the camera of a world that was given none.
#include "gfx/gfx_internal.h"

#include <math.h>

static core_mat4 view_matrix(const gfx_camera *c) {
    core_quat inverse = core_quat_conjugate(core_quat_normalize(c->rotation));
    core_vec3 t = core_quat_rotate(inverse, c->position);
    return core_mat4_trs(core_v3(-t.x, -t.y, -t.z), inverse, core_v3(1.0f, 1.0f, 1.0f));
}

static float or_default(float x, float fallback) { return x > 0.0f && isfinite(x) ? x : fallback; }

// Gribb and Hartmann (2001): planes are sums of the rows of the view-projection matrix. Depth runs
// from 1 at the near plane to 0, so near is w - z and far is z; the far plane at infinity has no
// normal and is left as one that holds everything.
static void frustum_planes(gfx_view *v) {
    const float *m = v->view_projection.m;
    for (int k = 0; k < 4; ++k) {
        float x = m[4 * k], y = m[4 * k + 1], z = m[4 * k + 2], w = m[4 * k + 3];
        v->plane[0][k] = w + x, v->plane[1][k] = w - x;
        v->plane[2][k] = w + y, v->plane[3][k] = w - y;
        v->plane[4][k] = w - z, v->plane[5][k] = z;
    }
    for (int i = 0; i < GFX_PLANES; ++i) {
        float *p = v->plane[i];
        float length = core_sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        if (length < 1e-12f) {
            p[0] = p[1] = p[2] = 0.0f;
            p[3] = 1.0f;
            continue;
        }
        for (int k = 0; k < 4; ++k) {
            p[k] /= length;
        }
    }
}

void gfx_view_make(const gfx_camera *camera, float aspect, gfx_view *out) {
    float fovy = camera->fovy > 0.0f && camera->fovy < CORE_PI_F ? camera->fovy : CORE_PI_F / 3.0f;
    out->near_plane = or_default(camera->near_plane, 0.1f);
    out->virtual_far = or_default(camera->virtual_far, 100.0f);
    out->virtual_far = CORE_MAX(out->virtual_far, out->near_plane * 1.01f);
    out->position = camera->position;
    out->view = view_matrix(camera);
    out->orthographic = camera->ortho_height > 0.0f && isfinite(camera->ortho_height);
    out->tan_y = out->orthographic ? 0.5f * camera->ortho_height : core_tanf(0.5f * fovy);
    out->tan_x = out->tan_y * aspect;
    out->projection = out->orthographic
                          ? core_mat4_ortho(-out->tan_x, out->tan_x, -out->tan_y, out->tan_y,
                                            out->near_plane, out->virtual_far)
                          : core_mat4_perspective(fovy, aspect, out->near_plane);
    gfx_view_finish(out);
}

void gfx_view_finish(gfx_view *v) {
    v->view_projection = core_mat4_mul(&v->projection, &v->view);
    frustum_planes(v);
}

void gfx_camera_view(gfx_view *v, core_vec3 eye, core_vec3 target, core_vec3 up) {
    *v = (gfx_view){.view = core_mat4_look_at(eye, target, up), .position = eye};
}

// Looks at the sphere round all instances from a corner above, far enough to see it whole.
static gfx_camera overview(const gfx_world *world) {
    const gfx_instances *s = &world->instances;
    core_vec3 lo = {0}, hi = {0};
    uint32_t n = core_columns_count(&s->set);
    for (uint32_t i = 0; i < n; ++i) {
        float r = s->cr[i];
        core_vec3 a = {s->cx[i] - r, s->cy[i] - r, s->cz[i] - r};
        core_vec3 b = {s->cx[i] + r, s->cy[i] + r, s->cz[i] + r};
        lo = i ? core_v3(CORE_MIN(lo.x, a.x), CORE_MIN(lo.y, a.y), CORE_MIN(lo.z, a.z)) : a;
        hi = i ? core_v3(CORE_MAX(hi.x, b.x), CORE_MAX(hi.y, b.y), CORE_MAX(hi.z, b.z)) : b;
    }
    core_vec3 center = core_v3_scale(core_v3_add(lo, hi), 0.5f);
    float radius = 0.5f;
    for (uint32_t i = 0; i < n; ++i) {
        core_vec3 d = core_v3_sub(core_v3(s->cx[i], s->cy[i], s->cz[i]), center);
        float reach = core_v3_length(d) + s->cr[i];
        radius = CORE_MAX(radius, reach);
    }
    core_vec3 away = core_v3_normalize(core_v3(0.55f, 0.5f, 1.0f), core_v3(0.0f, 0.0f, 1.0f));
    const float yaw = core_atan2f(0.55f, 1.0f), pitch = -core_asinf(away.y);
    gfx_camera c = {.position = core_v3_mad(center, away, radius * 1.8f)};
    c.rotation = core_quat_mul(core_quat_axis_angle(core_v3(0.0f, 1.0f, 0.0f), yaw),
                               core_quat_axis_angle(core_v3(1.0f, 0.0f, 0.0f), pitch));
    return c;
}

gfx_camera gfx_world_camera_or_default(const gfx_world *world) {
    gfx_camera c = world->camera_set ? world->camera : overview(world);
    c.fovy = or_default(c.fovy, CORE_PI_F / 3.0f);
    c.near_plane = or_default(c.near_plane, 0.1f);
    c.virtual_far = or_default(c.virtual_far, 100.0f);
    return c;
}

void gfx_camera_ray(const gfx_camera *camera, float width, float height, float x, float y,
                    core_vec3 *origin, core_vec3 *direction) {
    gfx_view v;
    gfx_view_make(camera, width / height, &v);
    core_quat turn = core_quat_normalize(camera->rotation);
    float right = (2.0f * x / width - 1.0f) * v.tan_x, up = (1.0f - 2.0f * y / height) * v.tan_y;
    if (v.orthographic) {
        core_vec3 aside = core_quat_rotate(turn, core_v3(right, up, 0.0f));
        *origin = core_v3_add(v.position, aside);
        *direction = core_quat_rotate(turn, core_v3(0.0f, 0.0f, -1.0f));
        return;
    }
    *origin = v.position;
    core_vec3 ahead = core_quat_rotate(turn, core_v3(right, up, -1.0f));
    *direction = core_v3_normalize(ahead, core_v3(0.0f, 0.0f, -1.0f));
}

core_vec3 gfx_camera_project(const gfx_camera *camera, float width, float height, core_vec3 point) {
    gfx_view v;
    gfx_view_make(camera, width / height, &v);
    core_quat inverse = core_quat_conjugate(core_quat_normalize(camera->rotation));
    core_vec3 p = core_quat_rotate(inverse, core_v3_sub(point, camera->position));
    float depth = -p.z, at = v.orthographic ? 1.0f : CORE_MAX(depth, 1e-6f);
    return core_v3(0.5f * width * (1.0f + p.x / (at * v.tan_x)),
                   0.5f * height * (1.0f - p.y / (at * v.tan_y)), depth);
}
