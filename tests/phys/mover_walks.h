// Random walks of movers through a heap of bodies of every kind: none may get into a body, through
// a wall, or stay where it cannot leave. Twenty walkers, walks of 20 steps, each from where the
// last one ended, so that bad places are found and left.
#ifndef TESTS_PHYS_MOVER_WALKS_H
#define TESTS_PHYS_MOVER_WALKS_H

#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

enum { WALKERS = 20, WALK_STEPS = 20 };
static uint64_t mess_seed;

static float random_in(float lo, float hi) {
    mess_seed = mess_seed * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * ((float)(mess_seed >> 40) / 16777216.0f);
}

static void add_wall(phys_world *w, core_vec3 at, core_vec3 half) {
    phys_body_desc b = phys_body_desc_default();
    b.type = PHYS_STATIC;
    b.position = at;
    phys_shape_desc s = phys_shape_desc_default(PHYS_BOX);
    s.half = half;
    phys_body_create(w, &b, &s, 1);
}

static void build_mess(phys_world *w) {
    add_wall(w, core_v3(0, -0.5f, 0), core_v3(50, 0.5f, 50));
    for (int i = 0; i < 120; i++) {
        phys_body_desc b = phys_body_desc_default();
        b.type = PHYS_STATIC;
        b.rotation =
            (core_quat){random_in(-1, 1), random_in(-1, 1), random_in(-1, 1), random_in(-1, 1)};
        b.position = core_v3(random_in(-9, 9), random_in(-0.3f, 1.5f), random_in(-9, 9));
        phys_shape_desc s = phys_shape_desc_default((phys_shape_type)(i % 5 == 2 ? 0 : i % 5));
        s.radius = random_in(0.1f, 0.8f);
        s.half_height = random_in(0.1f, 0.8f);
        s.half = core_v3(random_in(0.05f, 1), random_in(0.05f, 1), random_in(0.05f, 1));
        phys_body_create(w, &b, &s, 1);
    }
    for (int i = 0; i < 4; i++) {
        float s = i % 2 ? 10.5f : -10.5f;
        add_wall(w, i < 2 ? core_v3(s, 2, 0) : core_v3(0, 2, s),
                 i < 2 ? core_v3(0.5f, 3, 11) : core_v3(11, 3, 0.5f));
    }
}

static phys_mover_state walker_state(phys_world *w, phys_mover walker) {
    phys_mover_state s;
    TEST_ASSERT_TRUE(phys_mover_read(w, walker, &s));
    return s;
}

static float deepest_of(phys_world *w, phys_mover walker) {
    phys_shape_desc capsule = phys_shape_desc_default(PHYS_CAPSULE);
    capsule.radius = 0.3f;
    capsule.half_height = 0.6f;
    phys_touch t[8];
    float deepest = 0;
    uint32_t n = phys_world_touch(w, &capsule, walker_state(w, walker).position,
                                  core_quat_identity(), 0.0f, NULL, t, 8);
    for (uint32_t i = 0; i < n && i < 8; i++) {
        deepest = fmaxf(deepest, -t[i].gap);
    }
    return deepest;
}

static void set_out(phys_world *w, phys_mover walker) {
    phys_mover_walk(w, walker, core_v3(random_in(-6, 6), 0, random_in(-6, 6)));
    bool stands = walker_state(w, walker).ground == PHYS_MOVER_GROUND;
    if (random_in(0, 1) < 0.2f && stands) {
        phys_mover_jump(w, walker, random_in(1, 5));
    }
}

static void random_walks(phys_world *w, int walks) {
    mess_seed = 11;
    build_mess(w);
    phys_mover walker[WALKERS];
    core_vec3 from[WALKERS];
    int idle[WALKERS] = {0}, longest = 0;
    float deepest = 0;
    for (int i = 0; i < WALKERS; i++) {
        phys_mover_desc d = phys_mover_desc_default();
        d.position = core_v3(random_in(-9, 9), 4.0f, random_in(-9, 9));
        walker[i] = phys_mover_create(w, &d);
    }
    for (int s = 0; s < 120; s++) {
        TEST_ASSERT_TRUE(phys_world_step(w, 1.0f / 60.0f));
    }
    for (int k = 0; k < walks; k++) {
        for (int i = 0; i < WALKERS; i++) {
            from[i] = walker_state(w, walker[i]).position;
            set_out(w, walker[i]);
        }
        for (int s = 0; s < WALK_STEPS; s++) {
            TEST_ASSERT_TRUE(phys_world_step(w, 1.0f / 60.0f));
            for (int i = 0; i < WALKERS && s % 5 == 4; i++) {
                deepest = fmaxf(deepest, deepest_of(w, walker[i]));
            }
        }
        for (int i = 0; i < WALKERS; i++) {
            core_vec3 p = walker_state(w, walker[i]).position;
            bool moved = core_v3_length(core_v3_sub(p, from[i])) > 1e-3f;
            idle[i] = moved ? 0 : idle[i] + 1;
            longest = idle[i] > longest ? idle[i] : longest;
            TEST_ASSERT_TRUE(fabsf(p.x) < 9.8f && fabsf(p.z) < 9.8f && p.y > 0.85f && p.y < 8.0f);
        }
    }
    printf("%d walks: deepest %g m, most in a row that went nowhere %d\n", walks * WALKERS,
           (double)deepest, longest);
    TEST_ASSERT_TRUE(deepest <= 1e-3f);
    TEST_ASSERT_LESS_THAN_INT(10, longest);
}

#endif
