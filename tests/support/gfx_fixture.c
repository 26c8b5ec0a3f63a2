#include "support/gfx_fixture.h"

#include "unity.h"

#include <math.h>

gfx_fixture gfx_fixture_open(uint32_t width, uint32_t height, bool float_target) {
    gfx_fixture f = {.vfs = core_vfs_create(), .width = width, .height = height};
    TEST_ASSERT_TRUE_MESSAGE(core_vfs_mount(f.vfs, "assets", "", false), core_last_error());
    gfx_device_desc desc = gfx_device_desc_default();
    desc.width = width, desc.height = height;
    desc.vfs = f.vfs;
    desc.float_target = float_target;
    f.device = gfx_device_create(&desc);
    TEST_ASSERT_NOT_NULL_MESSAGE(f.device, core_last_error());
    gfx_world_desc world = gfx_world_desc_default();
    f.world = gfx_world_create(&world);
    TEST_ASSERT_NOT_NULL_MESSAGE(f.world, core_last_error());
    return f;
}

void gfx_fixture_close(gfx_fixture *f) {
    gfx_device_destroy(f->device);
    gfx_world_destroy(f->world);
    core_vfs_destroy(f->vfs);
}

float *gfx_fixture_hdr(gfx_fixture *f) {
    float *rgba = core_alloc((size_t)f->width * f->height * 4 * sizeof *rgba);
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f->device, f->world), core_last_error());
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_read_float(f->device, rgba), core_last_error());
    return rgba;
}

uint8_t *gfx_fixture_ldr(gfx_fixture *f) {
    uint8_t *rgba = core_alloc((size_t)f->width * f->height * 4);
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f->device, f->world), core_last_error());
    TEST_ASSERT_TRUE_MESSAGE(gfx_device_read(f->device, rgba), core_last_error());
    return rgba;
}

float gfx_max_difference(const float *a, const float *b, size_t n) {
    float worst = 0.0f;
    for (size_t i = 0; i < n; ++i) {
        float d = fabsf(a[i] - b[i]);
        worst = d <= worst ? worst : isnan(d) ? INFINITY : d;
    }
    return worst;
}

gfx_instance gfx_add(gfx_world *world, const char *mesh, core_vec3 position, core_vec3 scale,
                     float r, float g, float b) {
    gfx_instance_desc desc = {.mesh = gfx_mesh_builtin(world, mesh), .color = {r, g, b, 1.0f}};
    gfx_instance i = gfx_instance_create(world, &desc);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(i), core_last_error());
    gfx_instance_set_transform(world, i, position, core_quat_identity(), scale);
    return i;
}

gfx_light gfx_add_point(gfx_world *world, core_vec3 position, float radius, float intensity) {
    gfx_light_desc desc = gfx_light_desc_default(GFX_POINT);
    desc.position = position;
    desc.radius = radius;
    desc.intensity = intensity;
    return gfx_light_create(world, &desc);
}

gfx_light gfx_add_sun(gfx_world *world, core_vec3 direction, float irradiance) {
    gfx_light_desc desc = gfx_light_desc_default(GFX_DIRECTIONAL);
    desc.direction = direction;
    desc.intensity = irradiance;
    return gfx_light_create(world, &desc);
}

// Turns a camera from -Z to the target: yaw, then pitch.
void gfx_look(gfx_world *world, core_vec3 eye, core_vec3 target) {
    core_vec3 d = core_v3_normalize(core_v3_sub(target, eye), core_v3(0.0f, 0.0f, -1.0f));
    float yaw = atan2f(-d.x, -d.z), pitch = asinf(d.y);
    gfx_camera c = gfx_world_camera(world);
    c.position = eye;
    c.rotation = core_quat_mul(core_quat_axis_angle(core_v3(0.0f, 1.0f, 0.0f), yaw),
                               core_quat_axis_angle(core_v3(1.0f, 0.0f, 0.0f), pitch));
    gfx_world_set_camera(world, &c);
}
