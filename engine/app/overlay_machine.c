// A state machine as it runs: states on a circle, transitions between them, what plays and what
// fades.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/overlay.h"
#include "core/math.h"

enum { MOST = 24, EDGES = 96 }; // states and transitions that are drawn: it is for people

typedef struct graph {
    const char *name[MOST];
    float x[MOST], y[MOST];
    int count;
} graph;

static anim_instance nearest(const app_run *r, anim_world *anim, core_vec3 eye) {
    anim_instance best = CORE_NULL_HANDLE;
    float least = INFINITY;
    for (uint32_t i = 0; i < anim_instance_count(anim); i++) {
        anim_instance h = anim_instance_at(anim, i);
        core_vec3 p = {0, 0, 0};
        scene_position(r->scene, scene_entity_of_anim(r->scene, h), &p);
        float far = core_v3_length(core_v3_sub(p, eye));
        if (!core_handle_is_null(anim_instance_machine(anim, h)) && far < least) {
            best = h;
            least = far;
        }
    }
    return best;
}

static int find(const graph *g, const char *name) {
    int i = 0;
    while (i < g->count && strcmp(g->name[i], name) != 0) {
        i++;
    }
    return i < g->count ? i : -1;
}

static void lay_out(const anim_world *anim, anim_machine machine, float cx, float cy, graph *g) {
    const char *name, *within;
    g->count = 0;
    while (g->count < MOST &&
           anim_machine_state_at(anim, machine, (uint32_t)g->count, &name, &within)) {
        g->name[g->count++] = name;
    }
    for (int i = 0; i < g->count; i++) {
        double angle = 2 * CORE_PI * i / g->count - CORE_PI / 2;
        g->x[i] = cx + 150 * (float)core_cos(angle);
        g->y[i] = cy + 110 * (float)core_sin(angle);
    }
}

// A line that stops short of both ends, with a dot where it arrives.
static void arrow(gfx_world *world, const graph *g, int from, int to, float width,
                  const float color[4]) {
    float dx = g->x[to] - g->x[from], dy = g->y[to] - g->y[from];
    float length = sqrtf(dx * dx + dy * dy);
    if (length < 60) {
        return;
    }
    dx /= length;
    dy /= length;
    float ax = g->x[from] + 26 * dx + 4 * dy, ay = g->y[from] + 14 * dy - 4 * dx;
    float bx = g->x[to] - 30 * dx + 4 * dy, by = g->y[to] - 16 * dy - 4 * dx;
    gfx_line(world, ax, ay, bx, by, width, color);
    gfx_round_rect(world, bx - 3, by - 3, 6, 6, 3, 0, color);
}

void app_overlay_machine(app_run *r) {
    const float faint[4] = {0.7f, 0.74f, 0.8f, 0.35f}, ink[4] = {0.92f, 0.94f, 0.96f, 1};
    const float live[4] = {1, 0.78f, 0.35f, 1}, back[4] = {0.05f, 0.06f, 0.08f, 0.82f};
    const float box[4] = {0.2f, 0.23f, 0.28f, 1};
    gfx_world *world = scene_gfx_if(r->scene);
    anim_world *anim = scene_anim_if(r->scene);
    anim_instance who =
        anim ? nearest(r, anim, gfx_world_camera(world).position) : CORE_NULL_HANDLE;
    if (core_handle_is_null(who)) {
        return;
    }
    graph g;
    anim_machine machine = anim_instance_machine(anim, who);
    float w = 430, h = 300, x = (float)r->width - w - 10, y = (float)r->height - h - 10;
    lay_out(anim, machine, x + w / 2, y + h / 2, &g);
    gfx_round_rect(world, x, y, w, h, 6, 0, back);
    const char *from, *to, *left, *now = anim_instance_state(anim, who);
    float progress = anim_instance_fade(anim, who, &left);
    for (uint32_t i = 0; i < EDGES && anim_machine_transition_at(anim, machine, i, &from, &to);
         i++) {
        int a = find(&g, from), b = find(&g, to);
        if (a >= 0 && b >= 0) {
            arrow(world, &g, a, b, 1, faint);
        }
    }
    if (progress < 1 && find(&g, left) >= 0 && find(&g, now) >= 0) {
        arrow(world, &g, find(&g, left), find(&g, now), 3, live);
    }
    for (int i = 0; i < g.count; i++) {
        bool plays = anim_instance_in(anim, who, g.name[i]);
        float share = !plays ? 0 : strcmp(g.name[i], now) == 0 ? progress : 1;
        gfx_round_rect(world, g.x[i] - 40, g.y[i] - 11, 80, 22, 4, 0, box);
        gfx_rect(world, g.x[i] - 40, g.y[i] + 8, 80 * share, 3, live);
        gfx_print(world, g.x[i] - 35, g.y[i] - 8, 13, plays ? live : ink, g.name[i]);
    }
}
