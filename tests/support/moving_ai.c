#include "support/moving_ai.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

const char *const moving_ai_maps[7] = {"arena2",       "brc202d",        "AR0011SR",    "orz900d",
                                       "Berlin_0_512", "random512-20-0", "maze512-32-0"};

static FILE *open_data(const char *name, const char *suffix) {
    char path[200];
    snprintf(path, sizeof path, "../shared/data/nav/%s%s", name, suffix);
    return fopen(path, "r");
}

bool moving_ai_load(const char *name, moving_ai_map *out) {
    FILE *file = open_data(name, ".map");
    if (!file) {
        return false;
    }
    bool good = fscanf(file, "type octile height %u width %u map ", &out->height, &out->width) == 2;
    size_t cells = (size_t)out->width * out->height;
    out->blocked = core_alloc(cells + 1);
    for (size_t i = 0; good && i < cells; i++) {
        int c = fgetc(file);
        while (c == '\n' || c == '\r') {
            c = fgetc(file);
        }
        good = c != EOF;
        out->blocked[i] = strchr(".GS", c) == NULL;
    }
    fclose(file);
    return good;
}

moving_ai_query *moving_ai_scenario(const char *name, uint32_t *count) {
    FILE *file = open_data(name, ".map.scen");
    if (!file) {
        return NULL;
    }
    uint32_t capacity = 20000;
    moving_ai_query *list = core_alloc(capacity * sizeof *list);
    char line[400];
    *count = 0;
    while (*count < capacity && fgets(line, sizeof line, file)) {
        moving_ai_query *q = &list[*count];
        *count += sscanf(line, "%*d %*s %*u %*u %u %u %u %u %lf", &q->start.x, &q->start.y,
                         &q->goal.x, &q->goal.y, &q->optimum) == 5;
    }
    fclose(file);
    return list;
}

int moving_ai_check(nav_world *world, const char *name, uint32_t step) {
    moving_ai_map map;
    uint32_t count;
    moving_ai_query *list = moving_ai_scenario(name, &count);
    if (!list || !moving_ai_load(name, &map)) {
        core_free(list);
        return 0;
    }
    nav_grid_desc desc = nav_grid_desc_default();
    desc.width = map.width, desc.height = map.height;
    desc.blocked = map.blocked;
    nav_grid grid = nav_grid_create(world, &desc);
    int tested = 0;
    for (uint32_t i = 0; i < count; i += step, tested++) {
        double lengths[2];
        for (int method = NAV_GRID_JUMP; method <= NAV_GRID_ASTAR; method++) {
            nav_result r;
            nav_grid_search(world, grid, (nav_grid_method)method, list[i].start, list[i].goal, &r,
                            NULL, 0);
            lengths[method] = r.status == NAV_FOUND ? r.cost : -1.0;
            if (!(fabs(lengths[method] - list[i].optimum) <= 5e-3)) { // some are stored rounded
                char text[160];
                snprintf(text, sizeof text, "%s query %u method %d: %.5f, published %.5f", name, i,
                         method, lengths[method], list[i].optimum);
                TEST_FAIL_MESSAGE(text);
            }
        }
    }
    nav_grid_destroy(world, grid);
    core_free(map.blocked);
    core_free(list);
    return tested;
}

int moving_ai_check_euclid(nav_world *world, const char *name, uint32_t step) {
    moving_ai_map map;
    uint32_t count;
    FILE *file = open_data(name, ".euclid.txt");
    moving_ai_query *list = moving_ai_scenario(name, &count);
    if (!file || !list || !moving_ai_load(name, &map)) {
        return 0;
    }
    nav_mesh mesh = nav_mesh_from_cells(world, map.width, map.height, map.blocked, 1.0f);
    char line[100];
    int tested = 0;
    double sum = 0.0;
    while (fgets(line, sizeof line, file)) {
        uint32_t i;
        double exact;
        if (sscanf(line, "%u %lf", &i, &exact) != 2 || i >= count || i % step || exact <= 0.0) {
            continue;
        }
        core_vec3 start = {(float)list[i].start.x + 0.5f, 0, (float)list[i].start.y + 0.5f};
        core_vec3 goal = {(float)list[i].goal.x + 0.5f, 0, (float)list[i].goal.y + 0.5f};
        nav_result r;
        nav_mesh_search(world, mesh, start, goal, &r, NULL, 0);
        double ratio = r.status == NAV_FOUND ? r.cost / exact : 0.0;
        if (!(ratio > 0.9999 && ratio <= 1.02)) {
            char text[160];
            snprintf(text, sizeof text, "%s query %u: %.5f, exact %.5f", name, i, r.cost, exact);
            TEST_FAIL_MESSAGE(text);
        }
        sum += ratio;
        tested++;
    }
    TEST_ASSERT_TRUE(sum / tested <= 1.002);
    nav_mesh_destroy(world, mesh);
    core_free(map.blocked);
    core_free(list);
    fclose(file);
    return tested;
}
