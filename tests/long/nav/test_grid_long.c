// Every query of the Moving AI scenarios, by jump points and by A*, and straight across the
// surface where the true length is known.
#include "support/moving_ai.h"
#include "unity.h"

static nav_world *world;

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
}
void tearDown(void) { nav_world_destroy(world); }

static void all_queries(void) {
    int tested = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(moving_ai_maps); i++) {
        tested += moving_ai_check(world, moving_ai_maps[i], 1);
    }
    if (tested == 0) {
        TEST_IGNORE_MESSAGE("../shared/data/nav is absent: no scenarios to compare with");
    }
    TEST_ASSERT_TRUE(tested > 10000);
}

static void all_euclidean_lengths(void) {
    int tested = moving_ai_check_euclid(world, "arena2", 1);
    tested += moving_ai_check_euclid(world, "brc202d", 1);
    if (tested == 0) {
        TEST_IGNORE_MESSAGE("../shared/data/nav is absent: no lengths to compare with");
    }
    TEST_ASSERT_TRUE(tested > 3000);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(all_queries);
    RUN_TEST(all_euclidean_lengths);
    return UNITY_END();
}
