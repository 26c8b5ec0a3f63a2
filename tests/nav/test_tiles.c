// Surfaces in tiles: after any changes the same bits as a surface built in one go, whatever the
// number of threads; areas, and what changes mean for paths.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/jobs.h"
#include "core/rng.h"
#include "nav/nav.h"
#include "support/nav_boxes.h"
#include "unity.h"

static nav_world *world;

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
}
void tearDown(void) {
    nav_world_destroy(world);
    core_clear_error();
}

static nav_mesh_desc tiled(float side) {
    nav_mesh_desc d = nav_mesh_desc_default();
    d.cell_size = 0.25f;
    d.tile_cells = 16;
    d.bounds = (core_aabb){{0, 0, 0}, {side, 0, side}};
    return d;
}
static nav_mesh flat(nav_world *w, float side) {
    nav_box b;
    nav_mesh_desc d = tiled(side);
    return nav_mesh_build(w, nav_box_soup(&b, core_v3(0, -1, 0), core_v3(side, 0, side)), &d);
}

typedef struct change {
    uint64_t key;
    core_vec3 low, high;
    bool remove, mark;
    uint8_t area;
} change;
enum { CHANGES = 60, KEYS = 24 };

static change random_change(core_rng *rng) {
    change c = {.key = 1 + core_rng_below(rng, KEYS)};
    float x = 28.0f * core_rng_float(rng), z = 28.0f * core_rng_float(rng);
    float y = core_rng_below(rng, 3) ? 0.0f : 2.5f; // on the ground, or a roof
    float wide = 0.1f + 4.0f * core_rng_float(rng), deep = 0.1f + 4.0f * core_rng_float(rng);
    c.low = core_v3(x, y, z);
    c.high = core_v3(x + wide, y + 0.2f + core_rng_float(rng), z + deep);
    c.remove = core_rng_below(rng, 4) == 0;
    c.mark = core_rng_below(rng, 5) == 0;
    c.area =
        core_rng_below(rng, 3) ? (uint8_t)(1u + core_rng_below(rng, 3)) : (uint8_t)NAV_AREA_CLOSED;
    return c;
}
static void apply(nav_world *w, nav_mesh m, const change *c) {
    nav_box b;
    core_aabb aabb = {c->low, c->high};
    bool good = c->remove ? nav_mesh_put(w, m, c->key, NULL)
                : c->mark ? nav_mesh_mark(w, m, c->key, &aabb, c->area)
                          : nav_mesh_put(w, m, c->key, nav_box_soup(&b, c->low, c->high));
    TEST_ASSERT_TRUE(good);
}

// The pieces as they are after all changes, put at once.
static uint64_t hash_of_whole(const change *all, int count) {
    nav_mesh m = flat(world, 32);
    for (uint64_t key = 1; key <= KEYS; key++) {
        const change *last = NULL;
        for (int i = 0; i < count; i++) {
            last = all[i].key == key ? &all[i] : last;
        }
        if (last) {
            apply(world, m, last);
        }
    }
    TEST_ASSERT_TRUE(nav_mesh_update(world, m));
    uint64_t hash = nav_mesh_hash(world, m);
    nav_mesh_destroy(world, m);
    return hash;
}

static void changes_give_the_bits_of_a_full_build(void) {
    core_rng rng = core_rng_make(5, 1);
    change all[CHANGES];
    nav_mesh m = flat(world, 32);
    uint64_t bare = nav_mesh_hash(world, m);
    for (int i = 0; i < CHANGES; i++) {
        all[i] = random_change(&rng);
        apply(world, m, &all[i]);
        for (uint32_t step = core_rng_below(&rng, 4); step > 0; step--) {
            nav_world_step(world, 1.0f / 60.0f); // some tiles lag behind
        }
        if (i % 6 == 5) {
            for (int step = 0; step < 200 && nav_mesh_waiting(world, m); step++) {
                nav_world_step(world, 1.0f / 60.0f);
            }
            TEST_ASSERT_EQUAL_UINT32(0, nav_mesh_waiting(world, m));
            TEST_ASSERT_EQUAL_HEX64(hash_of_whole(all, i + 1), nav_mesh_hash(world, m));
        }
    }
    TEST_ASSERT_TRUE(bare != nav_mesh_hash(world, m));
    for (uint64_t key = 1; key <= KEYS; key++) {
        nav_mesh_put(world, m, key, NULL);
    }
    nav_mesh_update(world, m);
    TEST_ASSERT_EQUAL_HEX64(bare, nav_mesh_hash(world, m));
}

// Each step makes at most so many tiles anew; how many are left is the same on any thread count.
static uint64_t run_on_threads(int threads, uint32_t *waiting) {
    core_jobs *jobs = core_jobs_create(threads);
    nav_world_desc desc = nav_world_desc_default();
    desc.jobs = jobs;
    nav_world *w = nav_world_create(&desc);
    core_rng rng = core_rng_make(9, 1);
    nav_mesh m = flat(w, 32);
    for (int i = 0; i < 40; i++) {
        change c = random_change(&rng);
        apply(w, m, &c);
        nav_world_step(w, 1.0f / 60.0f);
    }
    *waiting = nav_mesh_waiting(w, m);
    uint64_t hash = nav_mesh_hash(w, m);
    nav_world_destroy(w);
    core_jobs_destroy(jobs);
    return hash;
}
static void threads_do_not_matter(void) {
    uint32_t one, four;
    uint64_t a = run_on_threads(1, &one), b = run_on_threads(4, &four);
    TEST_ASSERT_EQUAL_HEX64(a, b);
    TEST_ASSERT_EQUAL_UINT32(one, four);
    TEST_ASSERT_TRUE(one > 0);
}

static void only_its_tiles_wait(void) {
    nav_mesh m = flat(world, 64); // 16 by 16 tiles of 4 m, and a last row
    nav_box b;
    nav_mesh_put(world, m, 7, nav_box_soup(&b, core_v3(30, 0, 30), core_v3(31, 2, 31)));
    uint32_t waiting = nav_mesh_waiting(world, m);
    TEST_ASSERT_TRUE(waiting >= 1 && waiting <= 4);
    nav_mesh_put(world, m, 7, nav_box_soup(&b, core_v3(30, 0, 30), core_v3(31, 2, 31)));
    TEST_ASSERT_EQUAL_UINT32(waiting, nav_mesh_waiting(world, m));
    nav_mesh_update(world, m);
    nav_mesh_put(world, m, 7, nav_box_soup(&b, core_v3(30, 0, 30), core_v3(31, 2, 31))); // the same
    TEST_ASSERT_EQUAL_UINT32(0, nav_mesh_waiting(world, m));
    nav_mesh_put(world, m, 7,
                 nav_box_soup(&b, core_v3(-90, 0, 30), core_v3(-80, 2, 31))); // outside
    nav_mesh_update(world, m);
    TEST_ASSERT_EQUAL_HEX64(nav_mesh_hash(world, flat(world, 64)), nav_mesh_hash(world, m));
}

// The cut into tiles does not change what is walkable, nor how long ways are.
static void tiles_change_no_way(void) {
    core_rng rng = core_rng_make(31, 1);
    float vertex[24 * 40];
    uint32_t index[36 * 40], n = 0;
    for (; n < 40; n++) {
        nav_box b;
        change c = random_change(&rng);
        core_vec3 low = n ? c.low : core_v3(0, -1, 0), high = n ? c.high : core_v3(32, 0, 32);
        nav_box_soup(&b, low, high);
        memcpy(vertex + 24 * n, b.vertex, sizeof b.vertex);
        for (uint32_t i = 0; i < 36; i++) {
            index[36 * n + i] = b.index[i] + 8 * n;
        }
    }
    core_soup_data soup = {8 * n, 12 * n, vertex, index, NULL};
    nav_mesh_desc d = tiled(32);
    nav_mesh in_tiles = nav_mesh_build(world, &soup, &d);
    d.tile_cells = 0;
    nav_mesh whole = nav_mesh_build(world, &soup, &d);
    TEST_ASSERT_EQUAL_DOUBLE(nav_mesh_area(world, whole), nav_mesh_area(world, in_tiles));
    TEST_ASSERT_TRUE(nav_mesh_polygons(world, in_tiles) > nav_mesh_polygons(world, whole));
    int found = 0;
    for (int i = 0; i < 300; i++) {
        core_vec3 a = {32 * core_rng_float(&rng), 3 * core_rng_float(&rng),
                       32 * core_rng_float(&rng)};
        core_vec3 b = {32 * core_rng_float(&rng), 3 * core_rng_float(&rng),
                       32 * core_rng_float(&rng)};
        nav_result r1, r2;
        nav_mesh_search(world, whole, a, b, &r1, NULL, 0);
        nav_mesh_search(world, in_tiles, a, b, &r2, NULL, 0);
        TEST_ASSERT_EQUAL_INT(r1.status, r2.status);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * (1 + r1.cost), r1.cost, r2.cost);
        found += r1.status == NAV_FOUND;
    }
    TEST_ASSERT_TRUE(found > 100);
}

// A wall across, then a door in it: paths and agents take notice.
static void paths_follow_changes(void) {
    nav_mesh m = flat(world, 32);
    core_vec3 a = {4, 0, 16}, b = {28, 0, 16};
    nav_path path = nav_path_create_on_mesh(world, m, a, b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 24.0, nav_path_cost(world, path));
    nav_box wall;
    nav_mesh_put(world, m, 1, nav_box_soup(&wall, core_v3(16, 0, 0), core_v3(16.5f, 3, 28)));
    for (int i = 0; i < 60; i++) {
        nav_world_step(world, 1.0f / 60.0f);
    }
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, nav_path_status(world, path));
    TEST_ASSERT_DOUBLE_WITHIN(0.8, 2 * hypot(11.7, 12.4) + 1.1, nav_path_cost(world, path));
    nav_mesh_put(world, m, 1, NULL);
    for (int i = 0; i < 60; i++) {
        nav_world_step(world, 1.0f / 60.0f);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 24.0, nav_path_cost(world, path));
}

// "max_error": all ground further than radius + error from walls is covered, none nearer than the
// radius.
static void error_wish_holds(void) {
    const float wishes[] = {0.8f, 0.4f, 0.15f};
    for (int k = 0; k < 3; k++) {
        nav_box wall, ground;
        nav_mesh_desc d = nav_mesh_desc_default();
        d.max_error = wishes[k];
        d.tile_cells = 64;
        d.agent_radius = 0.45f;
        d.bounds = (core_aabb){{0.013f, 0, 0.007f}, {20, 0, 20}};
        core_vec3 low = core_v3(7.21f, 0, 6.17f), high = core_v3(9.03f, 2, 13.77f);
        nav_mesh m =
            nav_mesh_build(world, nav_box_soup(&ground, core_v3(0, -1, 0), core_v3(20, 0, 20)), &d);
        nav_mesh_put(world, m, 1, nav_box_soup(&wall, low, high));
        nav_mesh_update(world, m);
        core_rng rng = core_rng_make(3, 1);
        int covered = 0, not = 0;
        for (int i = 0; i < 20000; i++) {
            core_vec3 p = {2 + 16 * core_rng_float(&rng), 0, 2 + 16 * core_rng_float(&rng)}, q;
            float dx = fmaxf(fmaxf(low.x - p.x, p.x - high.x), 0);
            float dz = fmaxf(fmaxf(low.z - p.z, p.z - high.z), 0), away = hypotf(dx, dz);
            bool on = nav_mesh_nearest(world, m, p, 2e-3f, &q) && q.y < 1; // not its roof
            TEST_ASSERT_FALSE(on && away < d.agent_radius - 3e-3f);
            TEST_ASSERT_FALSE(!on && away > d.agent_radius + d.max_error);
            covered += on, not += !on;
        }
        TEST_ASSERT_TRUE(covered > 1000 && not > 1000);
    }
}

static void bad_changes(void) {
    nav_mesh_desc d = nav_mesh_desc_default();
    nav_box b;
    const core_soup_data *soup = nav_box_soup(&b, core_v3(0, -1, 0), core_v3(8, 0, 8));
    nav_mesh whole = nav_mesh_build(world, soup, &d), m = flat(world, 8);
    TEST_ASSERT_FALSE(nav_mesh_put(world, whole, 1, soup));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "tile_cells"));
    b.vertex[4] = NAN;
    uint64_t before = nav_mesh_hash(world, m);
    TEST_ASSERT_FALSE(nav_mesh_put(world, m, 1, soup));
    TEST_ASSERT_EQUAL_UINT32(0, nav_mesh_waiting(world, m));
    core_aabb marked = {{1, 0, 1}, {0, 1, 2}};
    TEST_ASSERT_FALSE(nav_mesh_mark(world, m, 1, &marked, 1));
    marked.max.x = INFINITY;
    TEST_ASSERT_FALSE(nav_mesh_mark(world, m, 1, &marked, 1));
    marked.max.x = 3;
    TEST_ASSERT_FALSE(nav_mesh_mark(world, m, 1, &marked, NAV_AREAS));
    TEST_ASSERT_TRUE(nav_mesh_put(world, m, 99, NULL));
    TEST_ASSERT_EQUAL_HEX64(before, nav_mesh_hash(world, m));
    d.tile_cells = 4;
    TEST_ASSERT_TRUE(core_handle_is_null(nav_mesh_build(world, soup, &d)));
    d.tile_cells = 16;
    d.bounds.max = core_v3(9e5f, 0, 9e5f);
    TEST_ASSERT_TRUE(core_handle_is_null(nav_mesh_build(world, NULL, &d)));
    d.bounds.max = core_v3(8, 0, 8);
    nav_mesh empty = nav_mesh_build(world, NULL, &d);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, nav_mesh_area(world, empty));
    TEST_ASSERT_FALSE(nav_mesh_put(world, (nav_mesh){0}, 1, soup));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(changes_give_the_bits_of_a_full_build);
    RUN_TEST(threads_do_not_matter);
    RUN_TEST(only_its_tiles_wait);
    RUN_TEST(tiles_change_no_way);
    RUN_TEST(paths_follow_changes);
    RUN_TEST(error_wish_holds);
    RUN_TEST(bad_changes);
    return UNITY_END();
}
