#include "support/phys_scenes.h"

#include <math.h>

enum { HULLS = 32, CORNERS = 32 };

static double draw(uint64_t *seed) { // [0, 1), as the peers' harness draws
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 40) / 16777216.0;
}
static double draw_around(uint64_t *seed, double a) { return (2.0 * draw(seed) - 1.0) * a; }

phys_body phys_scene_wall(phys_world *world, core_vec3 at, core_vec3 half) {
    phys_body_desc d = phys_body_desc_default();
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    d.type = PHYS_STATIC;
    d.position = at;
    s.half = half;
    return phys_body_create(world, &d, &s, 1);
}

static void add_bin(phys_world *world, float half) {
    phys_scene_wall(world, core_v3(0, -1, 0), core_v3(half + 2, 1, half + 2));
    for (int k = 0; k < 4; k++) {
        float s = k & 1 ? half + 0.5f : -half - 0.5f;
        phys_scene_wall(world, k < 2 ? core_v3(s, 20, 0) : core_v3(0, 20, s),
                        k < 2 ? core_v3(0.5f, 20, half + 1) : core_v3(half + 1, 20, 0.5f));
    }
}

// Corners spread by a golden spiral on a squashed sphere, about their mean.
static int make_hull(uint64_t *seed, int i, float out[CORNERS * 3]) {
    int n = 8 + i * 24 / (HULLS - 1);
    double s[3], mean[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        s[k] = 0.35 + 0.15 * draw(seed);
    }
    double p[CORNERS][3];
    for (int k = 0; k < n; k++) {
        double y = 1 - 2 * (k + 0.5) / n, r = sqrt(1 - y * y);
        double a = 2.399963 * k + draw_around(seed, 0.35);
        const double at[3] = {s[0] * r * cos(a), s[1] * y, s[2] * r * sin(a)};
        for (int c = 0; c < 3; c++) {
            p[k][c] = at[c];
            mean[c] += at[c] / n;
        }
    }
    for (int k = 0; k < n; k++) {
        for (int c = 0; c < 3; c++) {
            out[3 * k + c] = (float)(p[k][c] - mean[c]);
        }
    }
    return n;
}

void phys_scene_pile(phys_world *world, int n, bool hulls) {
    static const double pitch = 1.1;
    int m = (int)ceil(cbrt(n) * 1.25), corners[HULLS];
    float hull[HULLS][CORNERS * 3];
    uint64_t seed = 77;
    for (int i = 0; i < HULLS && hulls; i++) {
        corners[i] = make_hull(&seed, i, hull[i]);
    }
    add_bin(world, (float)(m * pitch / 2 + 0.5));
    seed = 12345;
    for (int i = 0; i < n; i++) {
        int layer = i / (m * m), cell = i % (m * m);
        phys_body_desc d = phys_body_desc_default();
        phys_shape_desc s = phys_shape_desc_default(hulls ? PHYS_HULL : PHYS_SPHERE);
        d.position.x = (float)((cell % m - (m - 1) * 0.5) * pitch + draw_around(&seed, 0.04));
        d.position.y = (float)(1.0 + pitch * layer);
        d.position.z = (float)((cell / m - (m - 1) * 0.5) * pitch + draw_around(&seed, 0.04));
        s.radius = 0.5f;
        if (hulls) {
            float q[4];
            for (int k = 0; k < 4; k++) {
                q[k] = (float)draw_around(&seed, 1);
            }
            d.rotation = (core_quat){q[0], q[1], q[2], q[3]};
            s.points = hull[i % HULLS];
            s.point_count = (uint32_t)corners[i % HULLS];
        }
        phys_body_create(world, &d, &s, 1);
    }
}

phys_body phys_scene_pyramid(phys_world *world, int n) {
    phys_body top = CORE_NULL_HANDLE;
    phys_scene_wall(world, core_v3(0, -1, 0), core_v3(200, 1, 200));
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n - i; j++) {
            phys_body_desc d = phys_body_desc_default();
            phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
            d.position = core_v3((float)j - (float)(n - i - 1) * 0.5f, 0.5f + (float)i, 0);
            s.half = core_v3(0.5f, 0.5f, 0.5f);
            top = phys_body_create(world, &d, &s, 1);
        }
    }
    return top;
}
