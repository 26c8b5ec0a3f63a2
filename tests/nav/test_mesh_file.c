// .cnav: what is saved comes back with the same bits and can be changed on; what is cut off,
// longer, or altered is refused or harmless.
#include <stdlib.h>
#include <string.h>

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

static void put(nav_mesh m, uint64_t key, core_vec3 low, core_vec3 high) {
    nav_box b;
    TEST_ASSERT_TRUE(nav_mesh_put(world, m, key, nav_box_soup(&b, low, high)));
}
// Two storeys with a ramp of steps, a mark and a link, in tiles.
static nav_mesh house(void) {
    nav_mesh_desc d = nav_mesh_desc_default();
    d.cell_size = 0.25f;
    d.tile_cells = 16;
    d.bounds = (core_aabb){{0, 0, 0}, {12, 0, 12}};
    nav_mesh m = nav_mesh_build(world, NULL, &d);
    put(m, 1, core_v3(0, -1, 0), core_v3(12, 0, 12));
    put(m, 2, core_v3(6, 3, 0), core_v3(12, 3.2f, 12));
    for (uint64_t i = 0; i < 10; i++) {
        float x = 2.0f + 0.4f * (float)i;
        put(m, 3 + i, core_v3(x, 0, 4), core_v3(x + 0.4f, 0.32f * (float)(i + 1), 6));
    }
    core_aabb box = {{8, -1, 8}, {10, 1, 10}};
    nav_mesh_mark(world, m, 99, &box, 7);
    nav_mesh_link_desc l = nav_mesh_link_desc_default();
    l.start = core_v3(7, 3.2f, 8), l.end = core_v3(4, 0, 8);
    l.user = 5;
    nav_mesh_add_link(world, m, &l);
    nav_mesh_update(world, m);
    return m;
}

static uint8_t *save(nav_mesh m, size_t *size) {
    *size = nav_mesh_save(world, m, NULL, 0);
    TEST_ASSERT_TRUE(*size > 1000);
    uint8_t *data = malloc(*size);
    TEST_ASSERT_EQUAL_UINT64(*size, nav_mesh_save(world, m, data, *size));
    return data;
}
static nav_result search(nav_mesh m, core_vec3 a, core_vec3 b) {
    nav_result r;
    TEST_ASSERT_TRUE(nav_mesh_search(world, m, a, b, &r, NULL, 0));
    return r;
}

static void comes_back_as_it_was(void) {
    nav_mesh m = house();
    size_t size;
    uint8_t *data = save(m, &size);
    nav_mesh back = nav_mesh_load(world, data, size);
    TEST_ASSERT_FALSE(core_handle_is_null(back));
    TEST_ASSERT_EQUAL_HEX64(nav_mesh_hash(world, m), nav_mesh_hash(world, back));
    TEST_ASSERT_EQUAL_UINT32(nav_mesh_polygons(world, m), nav_mesh_polygons(world, back));
    core_vec3 a = {1, 0, 1}, b = {11, 3.2f, 10};
    nav_result r1 = search(m, a, b), r2 = search(back, a, b);
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, r1.status);
    TEST_ASSERT_EQUAL_DOUBLE(r1.cost, r2.cost);
    nav_mesh_link_desc l;
    TEST_ASSERT_TRUE(nav_mesh_get_link(world, back, 0, &l));
    TEST_ASSERT_EQUAL_UINT64(5, l.user);
    put(m, 4, core_v3(1, 0, 8), core_v3(3, 2, 9)); // both change alike
    put(back, 4, core_v3(1, 0, 8), core_v3(3, 2, 9));
    nav_mesh_update(world, m);
    nav_mesh_update(world, back);
    TEST_ASSERT_EQUAL_HEX64(nav_mesh_hash(world, m), nav_mesh_hash(world, back));
    size_t again;
    uint8_t *second = save(back, &again);
    uint8_t *first = save(m, &size);
    TEST_ASSERT_EQUAL_UINT64(size, again);
    TEST_ASSERT_EQUAL_MEMORY(first, second, size);
    free(first);
    free(second);
    free(data);
    nav_mesh flat = nav_mesh_from_cells(world, 30, 20, NULL, 0.5f);
    data = save(flat, &size);
    back = nav_mesh_load(world, data, size);
    TEST_ASSERT_EQUAL_HEX64(nav_mesh_hash(world, flat), nav_mesh_hash(world, back));
    free(data);
}

static void cut_off_data_is_refused(void) {
    size_t size;
    uint8_t *data = save(house(), &size);
    for (size_t n = 0; n < size; n += n < 200 ? 1 : 97) {
        uint8_t *part = malloc(n + 1); // of its size, so that reading further is caught
        memcpy(part, data, n);
        TEST_ASSERT_TRUE(core_handle_is_null(nav_mesh_load(world, part, n)));
        free(part);
    }
    uint8_t *longer = calloc(size + 1, 1);
    memcpy(longer, data, size);
    TEST_ASSERT_TRUE(core_handle_is_null(nav_mesh_load(world, longer, size + 1)));
    free(longer);
    free(data);
    TEST_ASSERT_TRUE(core_handle_is_null(nav_mesh_load(world, NULL, 99)));
}

// Altered bytes: refused, or a surface that can be searched, changed and saved.
static void altered_data_is_harmless(void) {
    size_t size;
    uint8_t *data = save(house(), &size), *wrong = malloc(size);
    core_rng rng = core_rng_make(12, 1);
    int refused = 0, loaded = 0;
    for (int i = 0; i < 600; i++) {
        memcpy(wrong, data, size);
        uint32_t range = i % 3 ? (uint32_t)size : 72; // often in the head
        for (uint32_t k = 1 + core_rng_below(&rng, 3); k > 0; k--) {
            uint32_t at = core_rng_below(&rng, range);
            wrong[at] = (uint8_t)(i % 2 ? wrong[at] ^ 1u << core_rng_below(&rng, 8)
                                        : core_rng_below(&rng, 256));
        }
        if (i % 50 == 0) {
            memset(wrong + 4 + 4 * (i / 50), 0xff, 4); // huge counts, NaN
        }
        nav_mesh m = nav_mesh_load(world, wrong, size);
        refused += core_handle_is_null(m);
        if (!core_handle_is_null(m)) {
            loaded++;
            search(m, core_v3(1, 0, 1), core_v3(11, 3.2f, 10));
            if (nav_mesh_put(world, m, 4, NULL)) {
                nav_mesh_update(world, m);
            }
            nav_mesh_destroy(world, m);
        }
    }
    TEST_ASSERT_TRUE(refused > 100 && loaded > 20);
    free(wrong);
    free(data);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(comes_back_as_it_was);
    RUN_TEST(cut_off_data_is_refused);
    RUN_TEST(altered_data_is_harmless);
    return UNITY_END();
}
