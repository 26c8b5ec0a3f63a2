// Lab kernel: two planes at a distance, a little apart. Is the nearer one seen, whichever is drawn
// first? `reversed` is drawn; `fixed` is what 24-bit integers between 0.1 m and 1,000 km would
// hold.
#include "gfx/gfx_lab.h"
#include "gfx/gfx_lab_picture.h"

#include <string.h>

enum { SIDE = 9 };

// Part of the pixels, over both orders, that show the farther plane.
static bool wrong_when_drawn(const core_lab_case *c, float near_z, float far_z, double *wrong) {
    uint32_t count = 0;
    for (int first = 0; first < 2; ++first) {
        gfx_lab_picture p;
        bool ok = gfx_lab_picture_open(&p, c, SIDE, SIDE);
        for (int k = 0; k < 2 && ok; ++k) {
            bool nearer = k == first;
            float z = nearer ? near_z : far_z;
            gfx_instance_desc d = {.mesh = gfx_mesh_builtin(p.world, "plane"),
                                   .color = {nearer, !nearer, 0.0f, 1.0f}};
            gfx_instance_set_transform(
                p.world, gfx_instance_create(p.world, &d), core_v3(0.0f, 0.0f, -z),
                core_quat_axis_angle(core_v3(1, 0, 0), 0.5f * CORE_PI_F), core_v3(4 * z, 1, 4 * z));
        }
        if (ok) {
            gfx_camera camera = {.near_plane = 0.1f};
            gfx_world_set_camera(p.world, &camera);
            gfx_world_set_ambient(p.world, 1, 1, 1);
            ok = gfx_lab_picture_draw(&p);
        }
        for (int i = 0; i < SIDE * SIDE && ok; ++i) {
            count += p.rgba[4 * i] < 2.0f * p.rgba[4 * i + 1];
        }
        gfx_lab_picture_close(&p);
        if (!ok) {
            return false;
        }
    }
    *wrong = (double)count / (2.0 * SIDE * SIDE);
    return true;
}

static uint32_t fixed_depth(double z) {
    const double near_plane = 0.1, far = 1e6;
    return (uint32_t)(far / (far - near_plane) * (1.0 - near_plane / z) * 16777215.0 + 0.5);
}

static bool run_depth(const core_lab_case *c, core_json *out) {
    double distance = core_lab_number(c, "distance", 1000);
    float near_z = (float)distance, far_z = (float)(distance + core_lab_number(c, "separation", 1));
    double wrong = 0.0;
    if (strcmp(core_lab_text(c, "method", "reversed"), "fixed") == 0) {
        wrong = fixed_depth((double)near_z) < fixed_depth((double)far_z) ? 0.0 : 0.5;
    } else if (!wrong_when_drawn(c, near_z, far_z, &wrong)) {
        return false;
    }
    core_json_number(out, "wrong", wrong);
    return true;
}

const core_lab_kernel gfx_lab_depth = {
    "gfx.depth", "two planes apart: part of the pixels that show the farther one",
    "method: reversed|fixed; distance, separation (m)", run_depth};
