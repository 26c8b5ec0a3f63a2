// Crowds on flat maps: how many arrive, when, how deep they overlap, how they jerk.
#ifndef SUPPORT_NAV_CROWD_H
#define SUPPORT_NAV_CROWD_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "nav/nav.h"

#define CROWD_MOST   1024
#define CROWD_RADIUS 0.3f

typedef struct crowd {
    nav_world *world;
    nav_mesh mesh;
    nav_agent agent[CROWD_MOST];
    int count;
    float overlap; // deepest, of the radius
    int arrived;   // at the end
    float time;    // s, of the last arrival
    double jerk;   // m/s^3, root of the mean square
} crowd;

// width by depth metres in cells of 0.2 m, a wall from x = w0 to w1 m with a gap `gap` m wide for
// bodies (their middles have gap - 2 radii).
static inline void crowd_room(crowd *c, float width, float depth, float w0, float w1, float gap) {
    uint32_t across = (uint32_t)(width / 0.2f + 0.5f), along = (uint32_t)(depth / 0.2f + 0.5f);
    uint32_t open = (uint32_t)((gap - 2 * CROWD_RADIUS) / 0.2f + 0.5f), first = (along - open) / 2;
    uint8_t *blocked = calloc(across, along);
    for (uint32_t z = 0; z < along; z++) {
        for (uint32_t x = (uint32_t)(w0 / 0.2f + 0.5f); x < (uint32_t)(w1 / 0.2f + 0.5f); x++) {
            blocked[z * across + x] = z < first || z >= first + open;
        }
    }
    nav_world_desc desc = nav_world_desc_default();
    *c = (crowd){.world = nav_world_create(&desc)};
    c->mesh = nav_mesh_from_cells(c->world, across, along, blocked, 0.2f);
    free(blocked);
}

static inline void crowd_send(crowd *c, float x, float z, float gx, float gz) {
    nav_agent_desc d = nav_agent_desc_default();
    d.radius = CROWD_RADIUS;
    d.position = core_v3(x, 0, z);
    c->agent[c->count] = nav_agent_create(c->world, &d);
    nav_agent_go_on_mesh(c->world, c->agent[c->count++], c->mesh, core_v3(gx, 0, gz));
}

static inline void crowd_measure(crowd *c) {
    static core_vec3 p[CROWD_MOST];
    c->arrived = 0;
    for (int i = 0; i < c->count; i++) {
        nav_agent_position(c->world, c->agent[i], &p[i]);
        c->arrived += nav_agent_status(c->world, c->agent[i]) == NAV_AGENT_ARRIVED;
        for (int k = 0; k < i; k++) {
            float dx = p[i].x - p[k].x, dz = p[i].z - p[k].z, square = dx * dx + dz * dz;
            if (square < 4 * CROWD_RADIUS * CROWD_RADIUS) {
                c->overlap = fmaxf(c->overlap, (2 * CROWD_RADIUS - sqrtf(square)) / CROWD_RADIUS);
            }
        }
    }
}

// Until all have arrived, or `seconds` are over; overlaps are looked for every `every` steps.
static inline void crowd_walk(crowd *c, float seconds, int every) {
    static core_vec3 velocity[CROWD_MOST], acceleration[CROWD_MOST];
    const float rate = 60.0f;
    double square = 0;
    long samples = 0;
    for (int step = 0; step < (int)(seconds * rate) && c->arrived < c->count; step++) {
        nav_world_step(c->world, 1.0f / rate);
        int before = c->arrived;
        if (step % every == 0) {
            crowd_measure(c);
        }
        c->time = c->arrived > before ? (float)step / rate : c->time;
        for (int i = 0; i < c->count; i++) {
            core_vec3 v, a, j;
            nav_agent_velocity(c->world, c->agent[i], &v);
            a = core_v3_scale(core_v3_sub(v, velocity[i]), rate);
            j = core_v3_scale(core_v3_sub(a, acceleration[i]), rate);
            square += step > 1 ? (double)core_v3_dot(j, j) : 0.0;
            samples += step > 1;
            velocity[i] = v, acceleration[i] = a;
        }
    }
    c->jerk = samples ? sqrt(square / (double)samples) : 0.0;
}

static inline void crowd_report(const crowd *c, const char *name) {
    printf("%s: %d of %d arrived, the last after %.1f s; overlap %.2f %% of the radius; jerk %.0f "
           "m/s^3\n",
           name, c->arrived, c->count, (double)c->time, 100.0 * (double)c->overlap, c->jerk);
}

#endif
