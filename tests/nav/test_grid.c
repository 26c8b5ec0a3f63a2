// Searches on uniform grids: both methods against each other and a plain Dijkstra on random grids
// of every density, and against the published optima of the Moving AI scenarios (Sturtevant,
// "Benchmarks for grid-based pathfinding", TCIAIG 2012), a sample here and all of them in the long
// test.
#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "support/moving_ai.h"
#include "unity.h"

enum { SIDE = 90 };

static nav_world *world;

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
}
void tearDown(void) {
    nav_world_destroy(world);
    core_clear_error();
}

static nav_grid grid_of(uint32_t width, uint32_t height, const uint8_t *blocked) {
    nav_grid_desc desc = nav_grid_desc_default();
    desc.width = width, desc.height = height;
    desc.blocked = blocked;
    return nav_grid_create(world, &desc);
}

// The written path makes only allowed steps and costs what the result says.
static void check_walk(const uint8_t *blocked, uint32_t width, const nav_result *r,
                       const nav_cell *cells, nav_cell start, nav_cell goal) {
    double sum = 0.0;
    TEST_ASSERT_TRUE(cells[0].x == start.x && cells[0].y == start.y);
    TEST_ASSERT_TRUE(cells[r->count - 1].x == goal.x && cells[r->count - 1].y == goal.y);
    for (uint32_t i = 1; i < r->count; i++) {
        nav_cell a = cells[i - 1], b = cells[i];
        int dx = (int)b.x - (int)a.x, dy = (int)b.y - (int)a.y;
        TEST_ASSERT_TRUE(dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1 && (dx || dy));
        TEST_ASSERT_FALSE(blocked[b.y * width + b.x] || blocked[a.y * width + b.x] ||
                          blocked[b.y * width + a.x]);
        sum += dx && dy ? M_SQRT2 : 1.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * (1.0 + sum), sum, r->cost);
}

// Cost in whole numbers from start to every cell by relaxing until nothing changes.
static void relax_all(const uint8_t *blocked, uint32_t w, uint32_t h, uint32_t start,
                      uint32_t *cost) {
    memset(cost, 0xff, sizeof *cost * w * h);
    cost[start] = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t i = 0; i < w * h; i++) {
            for (int d = 0; d < 9 && cost[i] != UINT32_MAX; d++) {
                uint32_t x = i % w + (uint32_t)(d % 3 - 1), y = i / w + (uint32_t)(d / 3 - 1);
                if (x >= w || y >= h || blocked[y * w + x] || blocked[y * w + i % w] ||
                    blocked[i / w * w + x]) {
                    continue;
                }
                uint32_t c = cost[i] + (d % 2 ? 408u : 577u);
                if (d != 4 && c < cost[y * w + x]) {
                    cost[y * w + x] = c;
                    changed = true;
                }
            }
        }
    }
}

static uint32_t whole_cost(const nav_result *r) {
    uint32_t steps = r->count - 1;
    uint32_t diagonal = (uint32_t)lround((r->cost - steps) / (M_SQRT2 - 1.0));
    return (steps - diagonal) * 408 + diagonal * 577;
}

static void random_grids(void) {
    static uint8_t blocked[SIDE * SIDE];
    static uint32_t cost[SIDE * SIDE];
    static nav_cell cells[SIDE * SIDE];
    core_rng rng = core_rng_make(61, 1);
    int found = 0, none = 0;
    for (int round = 0; round < 400; round++) {
        // Narrow ones, and some wider than a word of bits.
        uint32_t w = 1 + core_rng_below(&rng, round % 8 ? 14 : SIDE);
        uint32_t h = 1 + core_rng_below(&rng, round % 8 == 1 ? SIDE : 14);
        uint32_t density = core_rng_below(&rng, 50);
        for (uint32_t i = 0; i < w * h; i++) {
            blocked[i] = core_rng_below(&rng, 100) < density;
        }
        nav_grid grid = grid_of(w, h, blocked);
        uint32_t from = core_rng_below(&rng, w * h);
        blocked[from] = 0;
        nav_grid_set_blocked(world, grid, from % w, from / w, false);
        relax_all(blocked, w, h, from, cost);
        for (int k = 0; k < 60; k++) {
            uint32_t to = core_rng_below(&rng, w * h);
            nav_cell start = {from % w, from / w}, goal = {to % w, to / w};
            for (int method = NAV_GRID_JUMP; method <= NAV_GRID_ASTAR; method++) {
                nav_result r;
                TEST_ASSERT_TRUE(nav_grid_search(world, grid, (nav_grid_method)method, start, goal,
                                                 &r, cells, SIDE * SIDE));
                if (cost[to] == UINT32_MAX) {
                    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status);
                    none++;
                    continue;
                }
                TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
                TEST_ASSERT_EQUAL_UINT32(to, r.reached);
                TEST_ASSERT_EQUAL_UINT32(cost[to], whole_cost(&r));
                check_walk(blocked, w, &r, cells, start, goal);
                found++;
            }
        }
        nav_grid_destroy(world, grid);
    }
    TEST_ASSERT_TRUE(found > 20000 && none > 2000);
}

// Changing cells one by one ends in the same grid as making it at once.
static void edits(void) {
    static uint8_t blocked[40 * 40];
    core_rng rng = core_rng_make(62, 1);
    nav_grid grid = grid_of(40, 40, NULL);
    for (int i = 0; i < 3000; i++) {
        uint32_t x = core_rng_below(&rng, 40), y = core_rng_below(&rng, 40);
        bool on = core_rng_below(&rng, 3) == 0;
        blocked[y * 40 + x] = on;
        TEST_ASSERT_TRUE(nav_grid_set_blocked(world, grid, x, y, on));
    }
    nav_grid fresh = grid_of(40, 40, blocked);
    for (uint32_t i = 0; i < 1600; i++) {
        TEST_ASSERT_EQUAL_INT(blocked[i], nav_grid_blocked(world, grid, i % 40, i / 40));
    }
    for (int i = 0; i < 500; i++) {
        nav_cell a = {core_rng_below(&rng, 40), core_rng_below(&rng, 40)};
        nav_cell b = {core_rng_below(&rng, 40), core_rng_below(&rng, 40)};
        nav_result one, two;
        nav_grid_search(world, grid, NAV_GRID_JUMP, a, b, &one, NULL, 0);
        nav_grid_search(world, fresh, NAV_GRID_ASTAR, a, b, &two, NULL, 0);
        TEST_ASSERT_EQUAL_INT(two.status, one.status);
        TEST_ASSERT_EQUAL_DOUBLE(two.cost, one.cost);
    }
}

static void bad_input(void) {
    nav_grid_desc raw = {0}, desc = nav_grid_desc_default();
    TEST_ASSERT_TRUE(core_handle_is_null(nav_grid_create(world, &raw)));
    TEST_ASSERT_TRUE(core_handle_is_null(nav_grid_create(world, &desc)));
    desc.width = NAV_GRID_MOST + 1, desc.height = 1;
    TEST_ASSERT_TRUE(core_handle_is_null(nav_grid_create(world, &desc)));
    nav_grid grid = grid_of(3, 2, NULL);
    nav_result r;
    nav_cell cells[2] = {{9, 9}, {9, 9}};
    TEST_ASSERT_FALSE(nav_grid_search(world, grid, NAV_GRID_JUMP, (nav_cell){3, 0},
                                      (nav_cell){0, 0}, &r, NULL, 0));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "start cell (3, 0), the grid has 3 by 2"));
    TEST_ASSERT_FALSE(nav_grid_set_blocked(world, grid, 0, 2, true));
    TEST_ASSERT_TRUE(nav_grid_blocked(world, grid, 7, 7));
    TEST_ASSERT_TRUE(nav_grid_search(world, grid, NAV_GRID_JUMP, (nav_cell){1, 1}, (nav_cell){1, 1},
                                     &r, cells, 2)); // start is goal
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
    TEST_ASSERT_EQUAL_UINT32(1, r.count);
    TEST_ASSERT_TRUE(cells[0].x == 1 && cells[1].x == 9);
    TEST_ASSERT_TRUE(nav_grid_search(world, grid, NAV_GRID_JUMP, (nav_cell){0, 0}, (nav_cell){2, 1},
                                     &r, cells, 2)); // longer than the room for it
    TEST_ASSERT_EQUAL_UINT32(3, r.count);
    TEST_ASSERT_TRUE(cells[1].x == 1);
    nav_grid_set_blocked(world, grid, 2, 1, true);
    nav_grid_search(world, grid, NAV_GRID_ASTAR, (nav_cell){0, 0}, (nav_cell){2, 1}, &r, NULL, 0);
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status);
    TEST_ASSERT_TRUE(nav_grid_destroy(world, grid));
    TEST_ASSERT_FALSE(nav_grid_destroy(world, grid));
    TEST_ASSERT_FALSE(nav_grid_search(world, grid, NAV_GRID_JUMP, (nav_cell){0, 0},
                                      (nav_cell){0, 0}, &r, NULL, 0));
}

static void published_optima(void) {
    int tested = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(moving_ai_maps); i++) {
        tested += moving_ai_check(world, moving_ai_maps[i], 60);
    }
    if (tested == 0) {
        TEST_IGNORE_MESSAGE("../shared/data/nav is absent: no scenarios to compare with");
    }
    TEST_ASSERT_TRUE(tested > 300);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(random_grids);
    RUN_TEST(edits);
    RUN_TEST(bad_input);
    RUN_TEST(published_optima);
    return UNITY_END();
}
