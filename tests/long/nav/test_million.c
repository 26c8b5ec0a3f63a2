// A graph of a million nodes: searched from corner to corner, bounded memory, Dijkstra's cost; and
// five million triangles.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "unity.h"

enum { SIDE = 1000 };
static nav_world *world;

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
}
void tearDown(void) { nav_world_destroy(world); }

static void a_million_nodes(void) {
    nav_graph_desc desc = nav_graph_desc_default();
    nav_graph graph = nav_graph_create(world, &desc);
    core_rng rng = core_rng_make(1, 1);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        nav_graph_add_node(world, graph, core_v3((float)(i % SIDE), 0, (float)(i / SIDE)));
    }
    for (uint32_t i = 0; i < SIDE * SIDE; i++) { // a fifth of the links is missing
        if (i % SIDE + 1 < SIDE && core_rng_below(&rng, 5)) {
            nav_graph_connect(world, graph, i, i + 1);
        }
        if (i + SIDE < SIDE * SIDE && core_rng_below(&rng, 5)) {
            nav_graph_connect(world, graph, i, i + SIDE);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(SIDE * SIDE, nav_graph_node_count(world, graph));
    nav_query q = nav_query_default();
    nav_result a, dijkstra;
    q.graph = graph, q.goal = SIDE * SIDE - 1;
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &a, NULL, 0));
    uint64_t allocations = core_alloc_count();
    q.heuristic = NAV_ZERO;
    TEST_ASSERT_TRUE(nav_graph_search(world, &q, &dijkstra, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64(allocations, core_alloc_count());
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, a.status);
    TEST_ASSERT_EQUAL_DOUBLE(dijkstra.cost, a.cost);
    TEST_ASSERT_TRUE(a.cost >= 2 * (SIDE - 1) && a.expanded < dijkstra.expanded);
    printf("%u of %u nodes expanded, %.0f MB\n", a.expanded, dijkstra.expanded,
           (double)nav_world_bytes(world) / 1e6);
    TEST_ASSERT_TRUE(nav_world_bytes(world) < 400u << 20);
}

static void five_million_triangles(void) {
    const uint32_t quads = 1582; // squared, two triangles each
    uint32_t points = quads + 1;
    float *vertex = malloc(sizeof *vertex * 3 * points * points);
    uint32_t *index = malloc(sizeof *index * 6 * quads * quads), n = 0;
    for (uint32_t i = 0; i < points * points; i++) {
        vertex[3 * i] = 0.1f * (float)(i % points), vertex[3 * i + 2] = 0.1f * (float)(i / points);
        vertex[3 * i + 1] = 0.5f * core_sinf(vertex[3 * i]);
    }
    for (uint32_t i = 0; i < quads * quads; i++) {
        uint32_t a = i / quads * points + i % quads, b = a + 1, c = a + points, d = c + 1;
        const uint32_t two[6] = {a, c, d, a, d, b};
        for (int k = 0; k < 6; k++) {
            index[n++] = two[k];
        }
    }
    core_soup_data soup = {points * points, 2 * quads * quads, vertex, index, NULL};
    nav_mesh_desc desc = nav_mesh_desc_default();
    nav_mesh mesh = nav_mesh_build(world, &soup, &desc);
    TEST_ASSERT_FALSE(core_handle_is_null(mesh));
    TEST_ASSERT_DOUBLE_WITHIN(300, 158.2 * 158.2, nav_mesh_area(world, mesh));
    nav_result r;
    nav_mesh_search(world, mesh, core_v3(1, 0, 1), core_v3(157, 0, 157), &r, NULL, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 156 * sqrt(2), r.cost);
    free(vertex);
    free(index);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_million_nodes);
    RUN_TEST(five_million_triangles);
    return UNITY_END();
}
